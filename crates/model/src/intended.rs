//! Angles as written: which multiple of π a decimal literal was surely meant to be.
//!
//! "1.57" is π/2 to two places, "3.14158" is twice 1.57079; "1.570512345" is a calibrated value. A literal counts as
//! a multiple of π only if that multiple, rounded or cut off at the last place that is written (or at single
//! precision), is what stands there, and if enough digits are written that chance is no explanation:
//! three for multiples of π/4, four for multiples of π/6 and π/12.

use std::f64::consts::PI;

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

/// Above this many quarter turns nobody writes an angle out.
const MOST_TURNS: f64 = 4.0;

/// The multiple of π that `written` was meant for; `None` where it is none, or not surely, or exactly that already.
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
