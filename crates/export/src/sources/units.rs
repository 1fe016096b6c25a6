//! Units as they stand beside numbers and in headings.

use crate::numbers::{AngleUnit, LengthUnit};
use std::f64::consts::PI;

/// A unit of an angle or of a length.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Unit {
    Radian,
    Degree,
    Metre,
    Centimetre,
    Millimetre,
    Inch,
}

impl Unit {
    /// The unit of a word such as `deg`, `°` or `mm`.
    pub fn of(word: &str) -> Option<Self> {
        Some(match word.trim_end_matches('.') {
            "rad" | "rads" | "radian" | "radians" => Self::Radian,
            "deg" | "degs" | "degree" | "degrees" | "°" | "º" => Self::Degree,
            "m" | "metre" | "metres" | "meter" | "meters" => Self::Metre,
            "cm" | "centimetre" | "centimetres" | "centimeter" | "centimeters" => Self::Centimetre,
            "mm" | "millimetre" | "millimetres" | "millimeter" | "millimeters" => Self::Millimetre,
            "inch" | "inches" => Self::Inch,
            _ => return None,
        })
    }

    pub fn is_length(self) -> bool {
        !matches!(self, Self::Radian | Self::Degree)
    }

    /// One of it in rad or m.
    pub fn in_si(self) -> f64 {
        match self {
            Self::Radian | Self::Metre => 1.0,
            Self::Degree => PI / 180.0,
            Self::Centimetre => 1e-2,
            Self::Millimetre => 1e-3,
            Self::Inch => 0.0254,
        }
    }

    /// A number of it in rad or m: 162.5 mm is the f64 0.1625.
    pub fn to_si(self, number: f64) -> f64 {
        match self {
            Self::Centimetre => number / 1e2,
            Self::Millimetre => number / 1e3,
            _ => number * self.in_si(),
        }
    }
}

impl From<AngleUnit> for Unit {
    fn from(unit: AngleUnit) -> Self {
        match unit {
            AngleUnit::Degree => Self::Degree,
            AngleUnit::Radian => Self::Radian,
        }
    }
}

impl From<LengthUnit> for Unit {
    fn from(unit: LengthUnit) -> Self {
        match unit {
            LengthUnit::Metre => Self::Metre,
            LengthUnit::Millimetre => Self::Millimetre,
        }
    }
}
