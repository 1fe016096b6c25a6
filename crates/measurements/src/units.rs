//! Units that a measurement file may be written in.

use denavit_model::units::Unit;
use denavit_model::{Coordinate, chain::Quantity};
use std::fmt;
use std::str::FromStr;
use thiserror::Error;

/// Factors from the file's units to metres and radians.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Units {
    /// m per unit of length.
    pub length: f64,
    /// rad per unit of angle.
    pub angle: f64,
}

impl Default for Units {
    /// Metres and radians.
    fn default() -> Self {
        Self { length: 1.0, angle: 1.0 }
    }
}

impl Units {
    /// rad or m per unit of a coordinate.
    pub fn of(self, coordinate: &Coordinate) -> f64 {
        match coordinate.quantity {
            Quantity::Angle => self.angle,
            Quantity::Length => self.length,
        }
    }

    /// The words for lengths and angles.
    pub fn words(self) -> [&'static str; 2] {
        let word =
            |quantity, in_si: f64| Unit::all(quantity).find(|unit| unit.in_si() == in_si).map_or("other", Unit::word);
        [word(Quantity::Length, self.length), word(Quantity::Angle, self.angle)]
    }
}

impl fmt::Display for Units {
    /// As `--units` takes them.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.words().join(","))
    }
}

/// A unit that is not known.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error(
    "units \"{0}\": \"{1}\" is not one of {lengths}, {angles}; write for example mm,deg",
    lengths = Unit::words(Quantity::Length),
    angles = Unit::words(Quantity::Angle)
)]
pub struct UnitsError(String, String);

impl FromStr for Units {
    type Err = UnitsError;

    /// Reads words such as `mm,deg`; the default is metres and radians.
    fn from_str(text: &str) -> Result<Self, UnitsError> {
        let mut units = Self::default();
        for word in text.split(',').map(str::trim) {
            let unit = Unit::of_any(word).ok_or_else(|| UnitsError(text.into(), word.into()))?;
            match unit.quantity() {
                Quantity::Length => units.length = unit.in_si(),
                Quantity::Angle => units.angle = unit.in_si(),
            }
        }
        Ok(units)
    }
}
