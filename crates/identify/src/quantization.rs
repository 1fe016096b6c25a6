//! Joint readings that were rounded: to tenths of a degree, to encoder counts. The rounding is an error of its own.

use crate::arm::{Arm, Perturbation, RowState};
use crate::observe::{Follows, Seen, model_of};
use denavit_measurements::Measurements;
use denavit_model::nalgebra::Vector3;
use denavit_model::{Chain, Quantity, se3};
use std::collections::BTreeSet;
use std::f64::consts::{PI, TAU};
use std::fmt;

/// Largest distance of readings from a grid, in steps; by chance one reading in twenty is this near.
const NEAR: f64 = 0.025;
/// Rounding error of text with nine decimals, rad or m.
const TEXT: f64 = 1.5e-9;
/// Fewest different readings: with fewer a grid may be chance.
const LEAST_READINGS: usize = 8;

/// A grid that a joint's readings lie on.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    /// The joint.
    pub joint: String,
    /// Index of its coordinate.
    pub coordinate: usize,
    /// Step, rad or m.
    pub step: f64,
    /// The step in its original unit, such as `0.1°` or `2^17 counts per turn`.
    pub name: String,
}

/// The effect of rounding on the measured value.
#[derive(Debug, Clone, PartialEq)]
pub struct Rounding {
    /// The grids, joint by joint.
    pub grids: Vec<Grid>,
    /// Root mean square position or distance error (3-D norm) due to rounding to these grids, m.
    pub error: f64,
}

impl fmt::Display for Rounding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut names: Vec<&str> = self.grids.iter().map(|grid| grid.name.as_str()).collect();
        names.dedup();
        let joints: Vec<&str> = self.grids.iter().map(|grid| grid.joint.as_str()).collect();
        write!(
            f,
            "readings of {} lie on a grid of {}; if they were rounded to it, this alone causes errors of {:.3} mm rms",
            joints.join(", "),
            names.join(", "),
            self.error * 1e3
        )
    }
}

fn candidates(quantity: Quantity) -> Vec<(f64, String)> {
    let mut grids = Vec::new();
    if quantity == Quantity::Length {
        for (step, name) in [(1e-2, "10 mm"), (1e-3, "1 mm"), (1e-4, "0.1 mm"), (1e-5, "0.01 mm"), (1e-6, "1 µm")] {
            grids.push((step, name.into()));
        }
        return grids;
    }
    for (degrees, name) in
        [(10.0, "10°"), (5.0, "5°"), (1.0, "1°"), (0.5, "0.5°"), (0.1, "0.1°"), (0.01, "0.01°"), (0.001, "0.001°")]
    {
        grids.push((degrees * PI / 180.0, name.into()));
    }
    for (step, name) in
        [(0.1, "0.1 rad"), (1e-2, "0.01 rad"), (1e-3, "1 mrad"), (1e-4, "0.1 mrad"), (1e-5, "0.01 mrad")]
    {
        grids.push((step, name.into()));
    }
    grids.extend((8..=20).map(|bits| (TAU / f64::from(1u32 << bits), format!("2^{bits} counts per turn"))));
    grids.sort_by(|a, b| b.0.total_cmp(&a.0));
    grids
}

/// The grids that joint readings lie on, the coarsest that fits for each joint.
pub fn grids(chain: &Chain, data: &Measurements) -> Vec<Grid> {
    let mut found = Vec::new();
    for (coordinate, of) in chain.coordinates().iter().enumerate() {
        let values = || (0..data.len()).map(|row| data.reading(row)[coordinate]);
        let different: BTreeSet<u64> = values().map(f64::to_bits).collect();
        if different.len() < LEAST_READINGS {
            continue;
        }
        let fits = |step: f64| {
            let near = (NEAR * step).min(TEXT + 1e-3 * step);
            TEXT < 0.01 * step && values().all(|value| (value - (value / step).round() * step).abs() < near)
        };
        if let Some((step, name)) = candidates(of.quantity).into_iter().find(|(step, _)| fits(*step)) {
            found.push(Grid { joint: of.name.clone(), coordinate, step, name });
        }
    }
    found
}

/// The error of the measured value due to rounding to these grids; `None` without grids.
///
/// The rounding error is uniform between -1/2 and 1/2 step: variance step²/12.
pub fn rounding(arm: &Arm, data: &Measurements) -> Option<Rounding> {
    let grids = grids(&arm.nominal, data);
    if grids.is_empty() || data.is_empty() {
        return None;
    }
    let (mut state, perturbation) = (RowState::default(), Perturbation::none(arm.joints.len()));
    let (mut sum, mut count) = (0.0, 0.0);
    for row in 0..data.len() {
        arm.state_into(data.reading(row), data.tip_of(row), None, &mut state);
        let on_the_way = &arm.tips[data.tip_of(row)].joints;
        let of_lengths = |&observation: &usize| data.series_of(observation).kind.place().unit == "m";
        for observation in data.of_row(row).filter(of_lengths) {
            let (series, values) = (data.series_of(observation), data.observed.values(observation));
            let seen = Seen::new(arm, &state.tip, &perturbation, series, values, false);
            let follows = model_of(series.kind).follows(&seen);
            let point = if let Follows::Lines { point, .. } = follows { point } else { seen.predicted };
            count += 1.0;
            for grid in &grids {
                let mut rate = Vector3::zeros();
                let moving = arm.joints.iter().zip(&state.before).zip(on_the_way);
                let moving = moving.filter(|((joint, _), on)| **on && joint.coordinate == grid.coordinate);
                for ((joint, before), _) in moving {
                    let twist = se3::adjoint_times(before, &joint.screw.twist()) * joint.scale;
                    rate += Vector3::new(twist[0], twist[1], twist[2]).cross(&point)
                        + Vector3::new(twist[3], twist[4], twist[5]);
                }
                let seen = match follows {
                    Follows::Whole => rate.norm_squared(),
                    Follows::Line(line) => line.dot(&rate).powi(2),
                    Follows::Turns(_) => 0.0,
                    Follows::Lines { lines, .. } => lines.iter().map(|line| line.dot(&rate).powi(2)).sum(),
                };
                sum += seen * grid.step * grid.step / 12.0;
            }
        }
    }
    (count > 0.0).then(|| Rounding { grids, error: f64::sqrt(sum / count) })
}
