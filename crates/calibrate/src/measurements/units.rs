//! Units that a measurement file may be written in.

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
            match word {
                "m" => units.length = 1.0,
                "mm" => units.length = 1e-3,
                "um" | "µm" => units.length = 1e-6,
                "in" => units.length = 0.0254,
                "rad" => units.angle = 1.0,
                "mrad" => units.angle = 1e-3,
                "deg" => units.angle = std::f64::consts::PI / 180.0,
                _ => return Err(UnitsError(text.into(), word.into())),
            }
        }
        Ok(units)
    }
}
