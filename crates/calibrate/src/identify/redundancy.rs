//! How many numbers were measured beyond those that are to be found: without any to spare nothing can be judged.

use crate::observation::measurements::Measurements;
use serde::Serialize;
use std::collections::BTreeSet;

/// Readings nearer than this are one posture, rad or m.
const SAME_POSTURE: f64 = 1e-6;
/// Effects are looked for when there are at least this many degrees of freedom per parameter: below that the search over
/// hundreds of candidates names some in clean data (`tests/redundancy.rs`).
const DEGREES_PER_PARAMETER: f64 = 2.0;

/// Measured numbers beside the parameters that they tell.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Redundancy {
    /// Different postures of the robot among the fitted rows.
    pub postures: usize,
    /// Numbers measured at them: six per pose, three per position, one per distance. A posture measured again tells the
    /// noise, but nothing more of the robot.
    pub values: usize,
    /// Numbers that they tell: the rank.
    pub parameters: usize,
    /// Values less parameters.
    pub degrees_of_freedom: usize,
    /// Whether that is enough to look for effects.
    pub enough_for_effects: bool,
}

impl Redundancy {
    /// Counts the rows of `data`, of which `rank` parameters are told.
    pub fn of(data: &Measurements, rank: usize) -> Self {
        let (postures, values) = different(data);
        let degrees = values.saturating_sub(rank);
        Self {
            postures,
            values,
            parameters: rank,
            degrees_of_freedom: degrees,
            enough_for_effects: degrees as f64 >= DEGREES_PER_PARAMETER * rank as f64,
        }
    }
}

/// Different postures, and the numbers measured at them, each posture counted once.
pub fn different(data: &Measurements) -> (usize, usize) {
    // Adding 0 makes one zero of two.
    let key =
        |row: usize| data.reading(row).iter().map(|value| (value / SAME_POSTURE).round() + 0.0).collect::<Vec<f64>>();
    let mut rows: Vec<(Vec<f64>, usize)> = (0..data.len()).map(|row| (key(row), row)).collect();
    let order = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a.total_cmp(b)).find(|o| o.is_ne());
    rows.sort_by(|a, b| order(&a.0, &b.0).unwrap_or(std::cmp::Ordering::Equal).then(a.1.cmp(&b.1)));
    let (mut postures, mut values) = (0, 0);
    for alike in rows.chunk_by(|a, b| a.0 == b.0) {
        postures += 1;
        let seen: BTreeSet<usize> = alike
            .iter()
            .flat_map(|(_, row)| data.of_row(*row))
            .map(|observation| data.observed.series(observation))
            .collect();
        values += seen.into_iter().map(|series| data.scene.series[series].kind.height()).sum::<usize>();
    }
    (postures, values)
}
