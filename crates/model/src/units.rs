//! Units of lengths and angles as people write them: one list for tables, measurements and the command line.

use crate::chain::Quantity;
use std::f64::consts::PI;
use std::fmt;

/// A unit of a length or of an angle.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Unit {
    /// m
    Metre,
    /// dm
    Decimetre,
    /// cm
    Centimetre,
    /// mm
    Millimetre,
    /// µm
    Micrometre,
    /// in, 25.4 mm
    Inch,
    /// mil (thou), a thousandth of an inch
    Mil,
    /// ft, 12 in
    Foot,
    /// km
    Kilometre,
    /// rad
    Radian,
    /// mrad
    Milliradian,
    /// deg, 360 to a turn
    Degree,
    /// grad (gon), 400 to a turn
    Gradian,
    /// rev
    Turn,
    /// arcmin, 60 to a degree
    Arcminute,
    /// arcsec, 60 to an arcminute
    Arcsecond,
}

/// A unit, rad or m in one of it, and its words; the first is the one that messages use.
type Entry = (Unit, f64, &'static [&'static str]);

const LENGTHS: &[Entry] = &[
    (Unit::Metre, 1.0, &["m", "metre", "metres", "meter", "meters"]),
    (Unit::Decimetre, 1e-1, &["dm", "decimetre", "decimetres", "decimeter", "decimeters"]),
    (Unit::Centimetre, 1e-2, &["cm", "centimetre", "centimetres", "centimeter", "centimeters"]),
    (Unit::Millimetre, 1e-3, &["mm", "millimetre", "millimetres", "millimeter", "millimeters"]),
    (
        Unit::Micrometre,
        1e-6,
        // The sign for micro and the Greek letter.
        &["um", "\u{b5}m", "\u{3bc}m", "micron", "microns", "micrometre", "micrometres", "micrometer", "micrometers"],
    ),
    (Unit::Inch, 0.0254, &["in", "inch", "inches"]),
    (Unit::Mil, 2.54e-5, &["mil", "mils", "thou"]),
    (Unit::Foot, 0.3048, &["ft", "foot", "feet"]),
    (Unit::Kilometre, 1e3, &["km", "kilometre", "kilometres", "kilometer", "kilometers"]),
];

const ANGLES: &[Entry] = &[
    (Unit::Radian, 1.0, &["rad", "rads", "radian", "radians"]),
    (Unit::Milliradian, 1e-3, &["mrad", "mrads", "milliradian", "milliradians"]),
    (Unit::Degree, PI / 180.0, &["deg", "degs", "degree", "degrees", "°", "º", "˚"]),
    (Unit::Arcminute, PI / 10_800.0, &["arcmin", "arcmins", "arcminute", "arcminutes"]),
    (Unit::Arcsecond, PI / 648_000.0, &["arcsec", "arcsecs", "arcsecond", "arcseconds"]),
    (Unit::Gradian, PI / 200.0, &["grad", "grads", "gradian", "gradians", "gon", "gons"]),
    (Unit::Turn, 2.0 * PI, &["rev", "revs", "revolution", "revolutions", "turn", "turns"]),
];

/// Prime marks after a number: inches and seconds, feet and minutes.
const TWO_STROKES: [&str; 5] = ["\"", "''", "″", "”", "′′"];
const ONE_STROKE: [&str; 3] = ["'", "′", "’"];

fn entries(quantity: Quantity) -> &'static [Entry] {
    match quantity {
        Quantity::Length => LENGTHS,
        Quantity::Angle => ANGLES,
    }
}

impl Unit {
    /// Every unit of this quantity.
    pub fn all(quantity: Quantity) -> impl Iterator<Item = Self> {
        entries(quantity).iter().map(|(unit, ..)| *unit)
    }

    /// The unit of this quantity that a word names, in capitals or not: `mm`, `Degrees`, `in.`, `"`.
    ///
    /// # Examples
    /// ```
    /// use denavit_model::chain::Quantity;
    /// use denavit_model::units::Unit;
    /// assert_eq!(Unit::of("in", Quantity::Length), Some(Unit::Inch));
    /// assert_eq!(Unit::of("\"", Quantity::Angle), Some(Unit::Arcsecond));
    /// assert_eq!(Unit::of("deg", Quantity::Length), None);
    /// ```
    pub fn of(word: &str, quantity: Quantity) -> Option<Self> {
        let word = word.trim().trim_end_matches('.').to_lowercase();
        let strokes = |known: &[&str]| known.contains(&word.as_str());
        match quantity {
            Quantity::Length if strokes(&TWO_STROKES) => return Some(Self::Inch),
            Quantity::Length if strokes(&ONE_STROKE) => return Some(Self::Foot),
            Quantity::Angle if strokes(&TWO_STROKES) => return Some(Self::Arcsecond),
            Quantity::Angle if strokes(&ONE_STROKE) => return Some(Self::Arcminute),
            _ => {}
        }
        entries(quantity).iter().find(|(.., words)| words.contains(&word.as_str())).map(|(unit, ..)| *unit)
    }

    /// The unit that a word names, of whichever quantity; prime marks are ambiguous and give `None`.
    pub fn of_any(word: &str) -> Option<Self> {
        let of = |quantity| Self::of(word, quantity);
        match (of(Quantity::Length), of(Quantity::Angle)) {
            (Some(unit), None) | (None, Some(unit)) => Some(unit),
            _ => None,
        }
    }

    /// A number with its unit, such as `30mm` or `1.5 in`, in rad or m; `None` where either is missing or not finite.
    ///
    /// # Examples
    /// ```
    /// use denavit_model::chain::Quantity;
    /// use denavit_model::units::Unit;
    /// assert_eq!(Unit::value("162.5 mm", Quantity::Length), Some(0.1625));
    /// assert_eq!(Unit::value("90deg", Quantity::Length), None);
    /// ```
    pub fn value(text: &str, quantity: Quantity) -> Option<f64> {
        let text = text.trim();
        let end = text.rfind(|letter: char| letter.is_ascii_digit() || letter == '.')? + 1;
        let (number, word) = text.split_at(end);
        let number = number.trim().parse::<f64>().ok().filter(|number| number.is_finite())?;
        Some(Self::of(word, quantity)?.to_si(number)).filter(|value| value.is_finite())
    }

    fn entry(self) -> &'static Entry {
        let found = LENGTHS.iter().chain(ANGLES).find(|(unit, ..)| *unit == self);
        found.expect("every unit has an entry")
    }

    /// What it measures.
    pub fn quantity(self) -> Quantity {
        if LENGTHS.iter().any(|(unit, ..)| *unit == self) { Quantity::Length } else { Quantity::Angle }
    }

    /// The word that messages use: `mm`, `deg`.
    pub fn word(self) -> &'static str {
        self.entry().2[0]
    }

    /// rad or m in one of it.
    pub fn in_si(self) -> f64 {
        self.entry().1
    }

    /// A number of it in rad or m; 162.5 mm is the f64 0.1625.
    pub fn to_si(self, number: f64) -> f64 {
        match self {
            Self::Decimetre => number / 1e1,
            Self::Centimetre => number / 1e2,
            Self::Millimetre | Self::Milliradian => number / 1e3,
            Self::Micrometre => number / 1e6,
            _ => number * self.in_si(),
        }
    }

    /// The words of all units of a quantity, for messages.
    pub fn words(quantity: Quantity) -> String {
        let words: Vec<&str> = Self::all(quantity).map(Self::word).collect();
        words.join(", ")
    }
}

impl fmt::Display for Unit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.word())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_as_people_write_them() {
        for (word, quantity, number, si) in [
            ("in", Quantity::Length, 16.0, 0.4064),
            ("IN.", Quantity::Length, 16.0, 0.4064),
            ("\"", Quantity::Length, 16.0, 0.4064),
            ("ft", Quantity::Length, 1.0, 0.3048),
            ("'", Quantity::Length, 1.0, 0.3048),
            ("mils", Quantity::Length, 16.0, 4.064e-4),
            ("µm", Quantity::Length, 5.0, 5e-6),
            ("μm", Quantity::Length, 5.0, 5e-6),
            ("um", Quantity::Length, 5.0, 5e-6),
            ("dm", Quantity::Length, 5.0, 0.5),
            ("mrad", Quantity::Angle, 5.0, 5e-3),
            ("grad", Quantity::Angle, 100.0, PI / 2.0),
            ("rev", Quantity::Angle, 0.25, PI / 2.0),
            ("turns", Quantity::Angle, 0.25, PI / 2.0),
            ("arcmin", Quantity::Angle, 60.0, PI / 180.0),
            ("'", Quantity::Angle, 60.0, PI / 180.0),
            ("arcsec", Quantity::Angle, 3600.0, PI / 180.0),
            ("\"", Quantity::Angle, 3600.0, PI / 180.0),
        ] {
            let unit = Unit::of(word, quantity).unwrap_or_else(|| panic!("{word}"));
            assert!((unit.to_si(number) - si).abs() <= 1e-15 * si, "{word}");
            assert_eq!(unit.quantity(), quantity);
        }
        for word in ["furlong", "", "mmm", "deg/s", "m2"] {
            assert_eq!(Unit::of_any(word), None, "{word}");
        }
        assert_eq!(Unit::of_any("\""), None);
        assert_eq!(Unit::words(Quantity::Angle), "rad, mrad, deg, arcmin, arcsec, grad, rev");
    }
}
