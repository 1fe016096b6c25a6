//! Words of an operation that are values: lengths and angles with a unit, poses, planes.

use crate::error::EditError;
use denavit_model::Quantity;
use denavit_model::nalgebra::Vector3;
use denavit_model::se3::{self, Pose};
use denavit_model::units::Unit;

/// A mirror plane through the root link's origin.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Plane {
    /// x changes its sign.
    Yz,
    /// y changes its sign: left and right of a robot that looks along x.
    Xz,
    /// z changes its sign.
    Xy,
}

impl Plane {
    /// The plane of this name: `xz`, or `y` for the coordinate that changes its sign.
    pub fn of(word: &str) -> Option<Self> {
        match word.to_lowercase().as_str() {
            "yz" | "zy" | "x" => Some(Self::Yz),
            "xz" | "zx" | "y" => Some(Self::Xz),
            "xy" | "yx" | "z" => Some(Self::Xy),
            _ => None,
        }
    }

    /// Index of the coordinate that changes its sign.
    pub fn index(self) -> usize {
        match self {
            Self::Yz => 0,
            Self::Xz => 1,
            Self::Xy => 2,
        }
    }

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Yz => "yz",
            Self::Xz => "xz",
            Self::Xy => "xy",
        }
    }
}

/// A number in rad or m, with or without a unit: `0.25`, `90deg`, `12.5 mm`.
///
/// # Errors
/// Not a number, or a unit of the other quantity.
pub(crate) fn number(word: &str, quantity: Quantity) -> Result<f64, EditError> {
    let word = word.trim();
    let end = word
        .char_indices()
        .find(|(at, c)| {
            let exponent = matches!(c, 'e' | 'E')
                && word[at + 1..].starts_with(|next: char| next.is_ascii_digit() || next == '-' || next == '+');
            !(c.is_ascii_digit() || matches!(c, '.' | '-' | '+') || exponent)
        })
        .map_or(word.len(), |(at, _)| at);
    let (digits, unit) = (&word[..end], word[end..].trim());
    let value = digits.parse::<f64>().ok().filter(|value| value.is_finite());
    let unit = if unit.is_empty() { Some(None) } else { Unit::of(unit, quantity).map(Some) };
    if let (Some(value), Some(unit)) = (value, unit) {
        return Ok(unit.map_or(value, |unit| unit.to_si(value)));
    }
    let units = match quantity {
        Quantity::Angle => "an angle, such as 0.5, 0.5rad or 90deg",
        Quantity::Length => "a length, such as 0.25, 0.25m or 250mm",
    };
    Err(EditError::Words(format!("\"{word}\" is not {units}")))
}

/// A pose `x,y,z` or `x,y,z,roll,pitch,yaw`, each number with or without a unit.
///
/// # Errors
/// A wrong count of numbers, or non-numbers.
pub(crate) fn pose(word: &str) -> Result<Pose, EditError> {
    let parts: Vec<&str> = word.split([',', ' ']).filter(|part| !part.is_empty()).collect();
    if parts.len() != 3 && parts.len() != 6 {
        return Err(EditError::Words(format!(
            "\"{word}\" is not a pose; write x,y,z or x,y,z,roll,pitch,yaw in m and rad, or with units"
        )));
    }
    let mut numbers = [0.0; 6];
    for (index, part) in parts.iter().enumerate() {
        numbers[index] = number(part, if index < 3 { Quantity::Length } else { Quantity::Angle })?;
    }
    let [x, y, z, roll, pitch, yaw] = numbers;
    Ok(se3::pose(se3::rotation_from_rpy([roll, pitch, yaw]), Vector3::new(x, y, z)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    #[test]
    fn values_have_units() {
        for (word, quantity, expected) in [
            ("90deg", Quantity::Angle, FRAC_PI_2),
            ("-0.25", Quantity::Angle, -0.25),
            ("1e-3", Quantity::Length, 1e-3),
            ("12.5 mm", Quantity::Length, 0.0125),
        ] {
            assert!((number(word, quantity).unwrap() - expected).abs() < 1e-15, "{word}");
        }
        assert!(number("90deg", Quantity::Length).is_err());
        assert!(number("x", Quantity::Angle).is_err());
        assert!(pose("1,2").is_err());
    }
}
