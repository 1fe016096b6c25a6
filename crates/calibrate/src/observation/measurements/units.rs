//! Units that a measurement file may be written in.

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
        let word = |list: &[(&'static str, f64)], unit: f64| {
            list.iter().find(|(_, known)| *known == unit).map_or("other", |(word, _)| word)
        };
        [word(&LENGTHS, self.length), word(&ANGLES, self.angle)]
    }
}

impl fmt::Display for Units {
    /// As `--units` takes them.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.words().join(","))
    }
}

/// m per unit.
const LENGTHS: [(&str, f64); 4] = [("m", 1.0), ("mm", 1e-3), ("um", 1e-6), ("in", 0.0254)];
/// rad per unit.
const ANGLES: [(&str, f64); 3] = [("rad", 1.0), ("mrad", 1e-3), ("deg", std::f64::consts::PI / 180.0)];

/// A unit that is not known.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("units \"{0}\": \"{1}\" is none of m, mm, um, in, rad, deg, mrad; write for example mm,deg")]
pub struct UnitsError(String, String);

impl FromStr for Units {
    type Err = UnitsError;

    /// Reads words such as `mm,deg`; what is not named stays in metres or radians.
    fn from_str(text: &str) -> Result<Self, UnitsError> {
        let mut units = Self::default();
        for word in text.split(',').map(str::trim) {
            let known =
                |list: &[(&str, f64)], word: &str| list.iter().find(|(known, _)| *known == word).map(|(_, unit)| *unit);
            let word_of_micrometres = if word == "µm" { "um" } else { word };
            if let Some(length) = known(&LENGTHS, word_of_micrometres) {
                units.length = length;
            } else if let Some(angle) = known(&ANGLES, word) {
                units.angle = angle;
            } else {
                return Err(UnitsError(text.into(), word.into()));
            }
        }
        Ok(units)
    }
}
