//! What the robot's motion does not determine.

use crate::Pair;
use crate::fit::{Normal, UNTOLD, scales};
use denavit_model::nalgebra::{Matrix3, Vector3};
use denavit_model::se3;
use serde::Serialize;

/// A direction is unknown where its standard deviation is more than this share of the rows' size, or this many rad.
const UNKNOWN: f64 = 0.1;
/// Rotations below this count as none, rad.
const NO_TURN: f64 = 1e-4;
/// Axes this close to one axis count as one, rad.
const ONE_AXIS: f64 = 0.02;

/// What the poses do not determine.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
#[non_exhaustive]
pub enum Unknown {
    /// The hand never turns: of both translations only one sum is known.
    NoTurn,
    /// The hand turns about one axis only: positions along it are not known.
    OneAxis {
        /// The axis in the base frame, unit length.
        axis: [f64; 3],
        /// How far axes are from it, root mean square, rad.
        within: f64,
    },
    /// This many directions are poorly determined, although the hand turns about several axes.
    Directions {
        /// How many of twelve.
        count: usize,
    },
}

impl std::fmt::Display for Unknown {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::NoTurn => f.write_str(
                "the hand never turns, so the translations cannot be determined; add poses that turn about two axes by 30° or more",
            ),
            Self::OneAxis { axis: [x, y, z], within } => write!(
                f,
                "the hand turns about one axis only ({x:.2} {y:.2} {z:.2} in the base frame, within {:.1}°), so positions along \
                 it cannot be determined; add poses that turn about another axis by 30° or more",
                within.to_degrees()
            ),
            Self::Directions { count } => write!(
                f,
                "{count} of 12 directions are poorly determined; add poses that turn about two axes by 30° or more"
            ),
        }
    }
}

/// What is not known, if anything.
pub(crate) fn unknown(pairs: &[Pair], normal: &Normal, size: f64) -> Option<Unknown> {
    let scale = scales(size);
    let scaled = Normal::from_fn(|row, column| normal[(row, column)] * scale[row] * scale[column]);
    let eigenvalues = scaled.symmetric_eigenvalues();
    let largest = eigenvalues.max();
    let is_unknown = |value: &&f64| **value <= UNTOLD * largest || value.sqrt().recip() > UNKNOWN;
    let count = eigenvalues.iter().filter(is_unknown).count();
    if count == 0 {
        return None;
    }
    let mut sum = Matrix3::zeros();
    let mut turns = 0.0;
    for (index, pair) in pairs.iter().enumerate() {
        for other in pairs.iter().skip(index + 1).take(MOST_PARTNERS) {
            let turn: Vector3<f64> = se3::rotation_vector(&(other.robot.rotation * pair.robot.rotation.inverse()));
            sum += turn * turn.transpose();
            turns += 1.0;
        }
    }
    let eigen = (sum / f64::max(turns, 1.0)).symmetric_eigen();
    let along = eigen.eigenvalues.imax();
    let most = eigen.eigenvalues[along];
    if most.sqrt() < NO_TURN {
        return Some(Unknown::NoTurn);
    }
    let within = ((eigen.eigenvalues.sum() - most).max(0.0) / most).sqrt().atan();
    if within < ONE_AXIS {
        let axis = eigen.eigenvectors.column(along);
        let sign = if axis[axis.iamax()] < 0.0 { -1.0 } else { 1.0 };
        return Some(Unknown::OneAxis { axis: [axis[0] * sign, axis[1] * sign, axis[2] * sign], within });
    }
    Some(Unknown::Directions { count })
}

/// Pairs of rows that are looked at, for each row.
const MOST_PARTNERS: usize = 20;
