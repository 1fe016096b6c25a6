//! The drawn robot on which effects were found, kept with them.
//!
//! Directions across an axis, gravity's moments and the points where links end are those of the drawn robot. A calibrated
//! robot's own would differ: where two base axes are equally perpendicular, a milliradian selects the other one.

use crate::effects::driver::Statics;
use crate::effects::gravity::{Masses, PointMass};
use denavit_export::poe::PoeFile;
use denavit_export::sources::{self, SourceError};
use denavit_model::nalgebra::{Point3, Vector3};
use denavit_model::{Chain, Tips};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// [`Statics`] as a file has them: m, rad, kg.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ReferenceRobot {
    /// Screw axes and home pose.
    chain: PoeFile,
    /// The masses that gravity acts on; joints are counted from 0.
    masses: Vec<Mass>,
    /// m/s², base frame.
    gravity: [f64; 3],
    /// Whether the masses are the URDF's.
    masses_from_inertials: bool,
    /// Where links begin and end: one per joint and the tip; m, base frame at home.
    points: Vec<[f64; 3]>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Mass {
    joint: usize,
    kilograms: f64,
    centre: [f64; 3],
}

/// Tips this far apart at one reading, relative to the robot's size, belong to different robots. An arm with badly set
/// zeros has 0.03, a UR5e and a UR10e 0.3.
const OTHER_ROBOT: f64 = 0.1;
/// Readings at which they are compared.
const COMPARED: usize = 20;

impl ReferenceRobot {
    /// The file form.
    pub fn of(statics: &Statics) -> Self {
        let masses = &statics.masses;
        let entry =
            |point: &PointMass| Mass { joint: point.joint, kilograms: point.mass, centre: point.centre.coords.into() };
        Self {
            chain: PoeFile::of(&statics.chain, &[]),
            masses: masses.points.iter().map(entry).collect(),
            gravity: masses.gravity.into(),
            masses_from_inertials: masses.from_inertials,
            points: statics.points.iter().map(|point| point.coords.into()).collect(),
        }
    }

    /// The chain and its masses.
    ///
    /// # Errors
    /// The chain is invalid, or a mass or a point does not belong to it.
    pub fn statics(&self, file: &str) -> Result<Statics, ReferenceRobotError> {
        let text = serde_json::to_string(&self.chain).map_err(|error| ReferenceRobotError::Parts(error.to_string()))?;
        let chain = sources::read(&format!("{file} (drawn.json)"), &text, sources::Stated::default())?;
        let chain = chain.chain().map_err(|error| ReferenceRobotError::Parts(error.to_string()))?;
        let joints = chain.joints().len();
        if let Some(mass) = self.masses.iter().find(|mass| mass.joint >= joints) {
            return Err(ReferenceRobotError::Parts(format!(
                "a mass is on joint {}, but there are {joints} joints",
                mass.joint
            )));
        }
        if self.points.len() != joints + 1 {
            return Err(ReferenceRobotError::Parts(format!("{} points instead of {}", self.points.len(), joints + 1)));
        }
        let point = |mass: &Mass| PointMass { joint: mass.joint, mass: mass.kilograms, centre: mass.centre.into() };
        let masses = Masses {
            points: self.masses.iter().map(point).collect(),
            gravity: Vector3::from(self.gravity),
            from_inertials: self.masses_from_inertials,
        };
        let points = self.points.iter().map(|point| Point3::from(*point)).collect();
        let tips = Arc::new(Tips::only(&chain));
        Ok(Statics::new(chain, tips, masses, points))
    }
}

/// Why the drawn robot of a file is invalid.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReferenceRobotError {
    /// Its chain.
    #[error(transparent)]
    Chain(#[from] SourceError),
    /// What belongs to it.
    #[error("{0}")]
    Parts(String),
}

/// Largest distance of the tips of two chains with the same joints over the joint range, m, where calibration of one robot cannot
/// explain it.
pub fn apart(drawn: &Chain, given: &Chain) -> Option<f64> {
    let value = |row: usize, (k, coordinate): (usize, &denavit_model::Coordinate)| {
        let (lower, upper) = coordinate.range();
        lower + (upper - lower) * (0.5 + row as f64 * 0.618_033_988_749_895 * (k as f64 + 1.0).sqrt()).fract()
    };
    let tips = |chain: &Chain, q: &[f64]| chain.fk(q).translation.vector;
    let largest = (0..COMPARED)
        .map(|row| {
            let q: Vec<f64> = drawn.coordinates().iter().enumerate().map(|pair| value(row, pair)).collect();
            (tips(drawn, &q) - tips(given, &q)).norm()
        })
        .fold(0.0, f64::max);
    (largest > OTHER_ROBOT * drawn.size()).then_some(largest)
}
