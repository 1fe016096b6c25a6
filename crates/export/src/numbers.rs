//! Numbers as people write them: 90, not 1.5707963267948966; 0.1625, not 0.16250000000000003; never -0.

use denavit_model::chain::Quantity;
use denavit_model::units::Unit;
use std::f64::consts::PI;
use thiserror::Error;

/// A word that is not a unit there.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("\"{word}\" is not a known unit, or the second one of its kind")]
#[non_exhaustive]
pub struct UnknownUnit {
    /// As written.
    pub word: String,
}

impl UnknownUnit {
    pub(crate) fn of(word: &str) -> Self {
        Self { word: word.to_owned() }
    }
}

/// Unit of lengths in a document.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum LengthUnit {
    /// m
    #[default]
    Metre,
    /// mm
    Millimetre,
}

/// Unit of angles in a document.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum AngleUnit {
    /// °
    #[default]
    Degree,
    /// rad
    Radian,
}

/// Units of a document; files that machines read are always in m and rad.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Units {
    /// Of lengths.
    pub length: LengthUnit,
    /// Of angles.
    pub angle: AngleUnit,
}

impl Units {
    /// From words such as `mm,deg`, in any order; units not named stay unchanged.
    ///
    /// # Errors
    /// The word that is not a unit.
    ///
    /// # Examples
    /// ```
    /// use denavit_export::{AngleUnit, LengthUnit, Units};
    /// let units = Units::default().with_words("mm,rad").unwrap();
    /// assert_eq!((units.length, units.angle), (LengthUnit::Millimetre, AngleUnit::Radian));
    /// assert_eq!(Units::default().with_words("inch").unwrap_err().word, "inch");
    /// ```
    pub fn with_words(mut self, words: &str) -> Result<Self, UnknownUnit> {
        for word in words.split(',').map(str::trim).filter(|word| !word.is_empty()) {
            match Unit::of_any(word) {
                Some(Unit::Metre) => self.length = LengthUnit::Metre,
                Some(Unit::Millimetre) => self.length = LengthUnit::Millimetre,
                Some(Unit::Degree) => self.angle = AngleUnit::Degree,
                Some(Unit::Radian) => self.angle = AngleUnit::Radian,
                _ => return Err(UnknownUnit::of(word)),
            }
        }
        Ok(self)
    }

    /// `m` or `mm`.
    pub fn length_word(self) -> &'static str {
        match self.length {
            LengthUnit::Metre => "m",
            LengthUnit::Millimetre => "mm",
        }
    }

    /// `°` or `rad`.
    pub fn angle_word(self) -> &'static str {
        match self.angle {
            AngleUnit::Degree => "°",
            AngleUnit::Radian => "rad",
        }
    }

    /// A length given in m, to 0.1 µm.
    pub fn length(self, metres: f64) -> String {
        match self.length {
            LengthUnit::Metre => decimal(metres, 7),
            LengthUnit::Millimetre => decimal(metres * 1e3, 4),
        }
    }

    /// An angle given in rad, to some 1e-8 rad.
    pub fn angle(self, radians: f64) -> String {
        match self.angle {
            AngleUnit::Degree => decimal(radians * (180.0 / PI), 6),
            AngleUnit::Radian => decimal(radians, 8),
        }
    }

    /// A joint value, in rad or m.
    pub fn value(self, value: f64, quantity: Quantity) -> String {
        match quantity {
            Quantity::Angle => self.angle(value),
            Quantity::Length => self.length(value),
        }
    }
}

/// `value` rounded to this many decimal places, trailing zeros and a lone minus left out.
///
/// # Examples
/// ```
/// use denavit_export::numbers::decimal;
/// assert_eq!(decimal(0.16250000000000003, 7), "0.1625");
/// assert_eq!(decimal(-1e-12, 7), "0");
/// assert_eq!(decimal(-90.00000000000001, 6), "-90");
/// ```
pub fn decimal(value: f64, places: usize) -> String {
    let fixed = format!("{value:.places$}");
    let trimmed = if fixed.contains('.') { fixed.trim_end_matches('0').trim_end_matches('.') } else { &fixed };
    if trimmed == "-0" { "0".to_owned() } else { trimmed.to_owned() }
}

/// The shortest decimal that reads back as the same f64; 0 for -0.
pub fn exact(value: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    // Far from 1 the positional form is a wall of zeros.
    if value.abs() < 1e-5 || value.abs() >= 1e16 { format!("{value:e}") } else { format!("{value}") }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn exact_reads_back(bits in any::<u64>()) {
            let value = f64::from_bits(bits);
            prop_assume!(value.is_finite());
            let again: f64 = exact(value).parse().unwrap();
            prop_assert!(again == value);
        }
    }

    #[test]
    fn units_print_as_engineers_write() {
        let units = Units::default();
        assert_eq!(units.angle(std::f64::consts::FRAC_PI_2), "90");
        assert_eq!(units.length(0.1 + 0.2), "0.3");
        assert_eq!(units.with_words("mm").unwrap().length(0.0333), "33.3");
        assert_eq!(exact(-0.0), "0");
    }
}
