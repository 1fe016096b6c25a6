//! Angles as written: which multiple of π a decimal literal was surely meant to be.
//!
//! "1.57" is π/2 to two places, "3.14158" is twice 1.57079; "1.570512345" is a calibrated value. A literal counts as
//! a multiple of π only if that multiple, rounded or cut off at the last place that is written (or at single
//! precision), equals the literal, and if enough digits are written to rule out chance:
//! three for multiples of π/4, four for multiples of π/6 and π/12.
//!
//! Axes are read in the same way: "2.2e-08 -4.4e-08 -1.0" is 0 0 -1 with a CAD program's rounding errors, and
//! "0.9659258 0.258819 0" is 15°. A calibrated axis deviates far more than such rounding, or is written with all its digits.

use crate::se3;
use nalgebra::{Unit, Vector3};
use std::f64::consts::{FRAC_PI_2, PI};

/// A multiple of π that a literal was written for.
#[derive(Debug, Clone, PartialEq)]
pub struct IntendedAngle {
    /// The multiple, rad.
    pub angle: f64,
    /// In words: `π/2`, `-3π/4`, `2π`.
    pub read_as: String,
    /// `angle` less the literal, rad; not zero.
    pub change: f64,
}

/// Nobody writes out angles beyond this many quarter turns.
const MOST_TURNS: f64 = 4.0;

/// The multiple of π that `written` was meant for; `None` if it is not one, or not surely, or exactly that already.
///
/// # Examples
/// ```
/// use denavit_model::intended::read_as;
/// assert_eq!(read_as("1.57").unwrap().angle, std::f64::consts::FRAC_PI_2);
/// assert_eq!(read_as("3.14158").unwrap().read_as, "π");
/// assert_eq!(read_as("1.570512345"), None);
/// assert_eq!(read_as("1.5707963267948966"), None);
/// ```
pub fn read_as(written: &str) -> Option<IntendedAngle> {
    let value: f64 = written.trim().parse().ok()?;
    if value == 0.0 || !value.is_finite() || value.abs() > MOST_TURNS * 2.0 * PI + 1.0 {
        return None;
    }
    let literal = Literal::of(written.trim())?;
    // Quarters of π first, then sixths and twelfths: the simplest reading that fits.
    for (parts, digits_needed) in [(4.0, 3), (6.0, 4), (12.0, 4)] {
        if literal.significant_digits < digits_needed {
            continue;
        }
        let count = (value.abs() / (PI / parts)).round();
        if count == 0.0 {
            continue;
        }
        let multiple = count * (PI / parts);
        if literal.is_written_for(value.abs(), multiple, count / (parts / 2.0)) {
            let angle = multiple.copysign(value);
            let change = angle - value;
            return (change.abs() > 4.0 * f64::EPSILON * multiple).then(|| IntendedAngle {
                angle,
                read_as: in_words(count, parts, value < 0.0),
                change,
            });
        }
    }
    None
}

/// A pitch this near to ±π/2 (rad) is one: at gimbal lock the conversion from a matrix keeps half the digits.
const GIMBAL_DUST: f64 = 5e-6;

/// The quarter turn that a pitch (the second angle of `rpy`) was meant to be, where arithmetic at gimbal lock added an
/// error: "-1.5707927". `None` if it is not one, or is written with more digits than such files have, or where
/// [`read_as`] reads it already.
///
/// # Examples
/// ```
/// use denavit_model::intended::pitch_read_as;
/// assert_eq!(pitch_read_as("-1.5707927").unwrap().read_as, "-π/2");
/// assert_eq!(pitch_read_as("-1.57079271234"), None);
/// assert_eq!(pitch_read_as("-1.5708"), None);
/// ```
pub fn pitch_read_as(written: &str) -> Option<IntendedAngle> {
    let value: f64 = written.trim().parse().ok()?;
    let literal = Literal::of(written.trim())?;
    let angle = FRAC_PI_2.copysign(value);
    let change = angle - value;
    let dust = change.abs() <= GIMBAL_DUST && change != 0.0;
    let short = (6..=8).contains(&literal.significant_digits);
    (dust && short && read_as(written).is_none()).then(|| IntendedAngle {
        angle,
        read_as: in_words(1.0, 2.0, value < 0.0),
        change,
    })
}

/// A direction that an axis was written for.
#[derive(Debug, Clone, PartialEq)]
pub struct IntendedAxis {
    /// The direction.
    pub axis: Unit<Vector3<f64>>,
    /// The literal in the file.
    pub written: String,
    /// As a file would write it: `0 0 -1`, or in words where it lies between two axes: `0 cos 15° sin 15°`.
    pub read_as: String,
    /// Angle between what is written and `axis`, rad; not zero.
    pub turned: f64,
}

/// A tilt (rad) up to this cannot be intended, however many digits it has: single precision.
const AXIS_DUST: f64 = 1e-7;
/// A tilt (rad) up to this is rounding if it has few digits. No arm calibration resolves less: 20 µm in a metre.
const SHORT_AXIS_DUST: f64 = 2e-5;
/// More digits than this in a tiny component mean a computed result, not rounding.
const SHORT: usize = 6;
/// The same where another component is written as 1.
const SHORT_SINGLE: usize = 9;
/// The same for the digits of a component next to a tiny one.
const SHORT_LARGE: usize = 8;

/// The direction that the three numbers of an axis were surely meant for, where it is not exactly what is written.
///
/// Components that are rounding errors become 0. If the two others are the sine and cosine of a multiple of
/// 15°, each to the digits that are written, they become that.
///
/// # Examples
/// ```
/// use denavit_model::intended::axis_read_as;
/// assert_eq!(axis_read_as("2.2e-08 -4.4e-08 -1.0").unwrap().read_as, "0 0 -1");
/// assert_eq!(axis_read_as("0.0012 0 0.9999993"), None);
/// assert_eq!(axis_read_as("0 0 1"), None);
/// ```
pub fn axis_read_as(written: &str) -> Option<IntendedAxis> {
    let mut words = written.split(|c: char| c.is_whitespace() || c == ',').filter(|word| !word.is_empty());
    let literals = [words.next()?, words.next()?, words.next()?];
    let mut values = [0.0; 3];
    for (value, literal) in values.iter_mut().zip(literals) {
        *value = literal.parse().ok()?;
    }
    let exact = |value: &f64| *value == 0.0 || value.abs() == 1.0;
    if values.iter().all(exact) || !values.iter().all(|value| value.is_finite()) {
        return None;
    }
    let own = Unit::try_new(Vector3::from(values), 0.0)?;
    let mut meant = values;
    // "… 0.99999999992": made of length 1 by a program that kept its digits, so that all of them count.
    let digits = |index: usize| Literal::of(literals[index]).map_or(usize::MAX, |literal| literal.significant_digits);
    let large = |index: &usize| own[*index].abs() > SHORT_AXIS_DUST && values[*index].abs() != 1.0;
    let rough = (0..3).filter(large).all(|index| digits(index) <= SHORT_LARGE);
    // "1.0 -1.9638742e-06 0": as a program of single precision prints.
    let short = if (0..3).any(|index| large(&index)) { SHORT } else { SHORT_SINGLE };
    for (index, meant) in meant.iter_mut().enumerate() {
        let tilt = own[index].abs();
        if tilt <= AXIS_DUST || rough && tilt <= SHORT_AXIS_DUST && digits(index) <= short {
            *meant = 0.0;
        }
    }
    let left: Vec<usize> = (0..3).filter(|index| meant[*index] != 0.0).collect();
    let mut words = meant.map(|value| value.to_string());
    match left[..] {
        [one] => {
            meant[one] = meant[one].signum();
            words[one] = meant[one].to_string();
        }
        [one, other] => {
            if let Some((angle, degrees)) = between_axes((literals[one], meant[one]), (literals[other], meant[other])) {
                (meant[one], meant[other]) = (angle.cos().copysign(meant[one]), angle.sin().copysign(meant[other]));
                let sign = |index: usize| if meant[index] < 0.0 { "-" } else { "" };
                words[one] = format!("{}cos {degrees}°", sign(one));
                words[other] = format!("{}sin {degrees}°", sign(other));
            }
        }
        _ => return None,
    }
    let axis = Unit::try_new(Vector3::from(meant), 0.0)?;
    let turned = se3::angle_between(&own, &axis);
    let changed = turned > 4.0 * f64::EPSILON;
    changed.then(|| IntendedAxis { axis, written: written.trim().to_owned(), read_as: words.join(" "), turned })
}

/// The multiple of 15° of which two components are cosine and sine, as far as they are written; rad and degrees.
fn between_axes((one, x): (&str, f64), (other, y): (&str, f64)) -> Option<(f64, u32)> {
    /// With this many digits in both together, chance is ruled out.
    const DIGITS: usize = 6;
    for parts in 1..6_u32 {
        let angle = f64::from(parts) * PI / 12.0;
        let mut digits = 0;
        let mut fits = |literal: &str, value: f64, exact: f64| {
            let Some(literal) = Literal::of(literal.trim()) else { return false };
            let half = (exact - 0.5).abs() < 1e-12 && value.abs() == 0.5;
            digits += if half { 3 } else { literal.significant_digits };
            let last_place = 10f64.powi(-literal.places);
            (value.abs() - exact).abs() < last_place.max(4.0 * f64::EPSILON)
        };
        if fits(one, x, angle.cos()) && fits(other, y, angle.sin()) && digits >= DIGITS {
            return Some((angle, 15 * parts));
        }
    }
    None
}

/// How a literal is written.
struct Literal {
    /// Decimal places, trailing zeros of `%f` left out.
    places: i32,
    significant_digits: usize,
}

impl Literal {
    fn of(written: &str) -> Option<Self> {
        let (mantissa, exponent) = match written.split_once(['e', 'E']) {
            Some((mantissa, exponent)) => (mantissa, exponent.parse::<i32>().ok()?),
            None => (written, 0),
        };
        let mantissa = mantissa.trim_start_matches(['+', '-']);
        let (whole, fraction) = mantissa.split_once('.').unwrap_or((mantissa, ""));
        let padded = fraction.len() - fraction.trim_end_matches('0').len();
        // "1.570000" is 1.57 printed with six places; "1.570" may be measured to three.
        let fraction = if padded >= 2 { fraction.trim_end_matches('0') } else { fraction };
        let digits = format!("{whole}{fraction}");
        let places = i32::try_from(fraction.len()).ok()? - exponent;
        Some(Self { places, significant_digits: digits.trim_start_matches('0').len() })
    }

    /// Whether `multiple` (of π), written to this many places, gives `value`; `quarters` = multiple / (π/2).
    fn is_written_for(&self, value: f64, multiple: f64, quarters: f64) -> bool {
        if self.significant_digits >= 8 {
            let last_place = 10f64.powi(-self.places);
            #[expect(clippy::cast_possible_truncation, reason = "single precision is what is asked for")]
            let single = f64::from(multiple as f32);
            let near = |exact: f64| (value - exact).abs() < last_place.max(4.0 * f64::EPSILON * exact);
            if near(single) || near(multiple) {
                return true;
            }
            if self.significant_digits > 15 {
                return false;
            }
        }
        let scale = 10f64.powi(self.places);
        let written = (value * scale).round();
        let gives = |exact: f64| written == (exact * scale).round() || written == (exact * scale).floor();
        if gives(multiple) {
            return true;
        }
        if self.significant_digits < 5 || quarters.fract() != 0.0 {
            return false;
        }
        // A quarter turn cut off at this place, then doubled, tripled, …: 3.14158 = 2 × 1.57079.
        let cut = (PI / 2.0 * scale).floor();
        // A half turn cut off a place earlier, then halved: 1.570795 = 3.14159 / 2.
        let cut_earlier = (2.0 * multiple * scale / 10.0).floor() * 10.0;
        written == quarters * cut || 2.0 * written == cut_earlier
    }
}

fn in_words(count: f64, parts: f64, negative: bool) -> String {
    let mut numerator = count;
    let mut denominator = parts;
    for prime in [2.0, 3.0] {
        while numerator % prime == 0.0 && denominator % prime == 0.0 {
            numerator /= prime;
            denominator /= prime;
        }
    }
    let sign = if negative { "-" } else { "" };
    let factor = if numerator == 1.0 { String::new() } else { format!("{numerator:.0}") };
    let divisor = if denominator == 1.0 { String::new() } else { format!("/{denominator:.0}") };
    format!("{sign}{factor}π{divisor}")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(written: &str, expected: &str) {
        let found = read_as(written).map_or_else(|| "as written".to_owned(), |intended| intended.read_as);
        assert_eq!(found, expected, "{written}");
    }

    #[test]
    fn shortened_multiples_of_pi_are_recognised() {
        for (written, expected) in [
            ("1.57", "π/2"),
            ("-1.57", "-π/2"),
            ("1.571", "π/2"),
            ("1.570", "π/2"),
            ("1.5708", "π/2"),
            ("1.5707", "π/2"),
            ("1.57079", "π/2"),
            ("1.570796", "π/2"),
            ("1.570000", "π/2"),
            ("1.57080", "π/2"),
            ("1.5707963267", "π/2"),
            ("1.57079632679", "π/2"),
            ("1.57079637050628662109", "π/2"),
            ("157.0796e-2", "π/2"),
            ("1.570795", "π/2"),
            ("1.570796325", "π/2"),
            ("3.14", "π"),
            ("3.1415", "π"),
            ("3.1416", "π"),
            ("3.14158", "π"),
            ("-3.14159", "-π"),
            ("3.1415926", "π"),
            ("4.7123", "3π/2"),
            ("4.71239", "3π/2"),
            ("6.28", "2π"),
            ("6.28318", "2π"),
            ("0.785", "π/4"),
            ("0.7854", "π/4"),
            ("2.3562", "3π/4"),
            ("1.047", "π/3"),
            ("0.5236", "π/6"),
            ("2.0944", "2π/3"),
            ("0.2618", "π/12"),
        ] {
            check(written, expected);
        }
    }

    #[test]
    fn dust_beside_an_axis_is_recognised() {
        for (written, expected) in [
            ("2.2e-08 -4.4e-08 -1.0", "0 0 -1"),
            ("-8.8e-08 -1.0 4.4e-08", "0 -1 0"),
            ("-1.96e-6 2.3e-6 1.0", "0 0 1"),
            ("1e-05 0 1", "0 0 1"),
            ("1.0 -1.9638742e-06 0", "1 0 0"),
            ("0 -1.00000000000000 3.1415926535e-9", "0 -1 0"),
            ("-9.717e-13 0.9999999999999 0", "0 1 0"),
            ("1.6e-08 0.9659258 0.2588190", "0 cos 15° sin 15°"),
            ("0.866 -0.5 0", "cos 30° -sin 30° 0"),
            ("-0.7071 0.70711 0", "-cos 45° sin 45° 0"),
        ] {
            let found = axis_read_as(written);
            assert_eq!(found.map(|found| found.read_as).as_deref(), Some(expected), "{written}");
        }
    }

    #[test]
    fn other_axes_are_left_alone() {
        for written in [
            "0 0 1",
            "0 0 2",
            "0 1 1",
            "1 1 1",
            "0.577 0.577 0.577",
            "0.0012 0 0.9999993",
            "0.0001 0 1",
            "3e-5 0 1",
            "0 -1.96387421234e-06 1.0",
            "0.00000423178 -0.0000119083 0.99999999992",
            "0.3 0.4 0",
            "0.9 0.5 0",
            "0 0 0",
            "nan 0 1",
            "0 1",
        ] {
            assert_eq!(axis_read_as(written), None, "{written}");
        }
    }

    #[test]
    fn pitches_at_gimbal_lock_are_recognised_others_not() {
        for written in ["-1.5707927", "1.570793", "1.5707999"] {
            assert!(pitch_read_as(written).is_some(), "{written}");
        }
        for written in ["1.5704", "1.5707927123", "1.57", "0", "1.5707963267948966", "x", "1.5708"] {
            assert_eq!(pitch_read_as(written), None, "{written}");
        }
    }

    #[test]
    fn other_values_are_left_alone() {
        for written in [
            "1.570512345",
            "1.56",
            "1.58",
            "1.6",
            "3.1",
            "3",
            "0.8",
            "0.79",
            "0.52",
            "1.05",
            "1.5712",
            "1.5700963",
            "1.570785",
            "1.5707963705062966",
            "3.13",
            "3.15",
            "0",
            "0.0",
            "nan",
            "1e400",
            "100",
            "1.5707963267948966",
            "-3.141592653589793",
            "1.57079632679489661923",
        ] {
            check(written, "as written");
        }
    }
}
