//! Number of measured values beyond the unknowns: without redundancy nothing can be tested.

use denavit_measurements::Measurements;
use serde::Serialize;
use std::collections::BTreeSet;

/// Fewest degrees of freedom per parameter for a search for effects: with fewer, the search over hundreds of candidates
/// names some in clean data (`tests/redundancy.rs`).
const DEGREES_PER_PARAMETER: f64 = 2.0;

/// Measured values and the parameters that they identify.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Redundancy {
    /// Different postures of the robot among the fitted rows.
    pub postures: usize,
    /// Numbers measured at them: six per pose, three per position, one per distance. A posture measured again shows the
    /// noise, but nothing more of the robot.
    pub values: usize,
    /// Parameters that they identify: the rank.
    pub parameters: usize,
    /// Values minus parameters.
    pub degrees_of_freedom: usize,
    /// Whether that is enough to search for effects.
    pub enough_for_effects: bool,
}

impl Redundancy {
    /// Counts the rows of `data`, which identify `rank` parameters. A point that only one posture sees, such as a contact of two tips,
    /// has as many unknowns as values: neither counts.
    pub fn of(data: &Measurements, rank: usize) -> Self {
        let (postures, values) = different(data);
        let touches = seen_once(data);
        let own = 3 * touches;
        let (values, rank) = (values.saturating_sub(own), rank.saturating_sub(own));
        let degrees = values.saturating_sub(rank);
        Self {
            postures,
            values,
            parameters: rank,
            degrees_of_freedom: degrees,
            // Both rows of a contact share one error: the search would count it twice.
            enough_for_effects: touches == 0 && degrees as f64 >= DEGREES_PER_PARAMETER * rank as f64,
        }
    }
}

/// Number of points that only one posture sees.
fn seen_once(data: &Measurements) -> usize {
    let mut postures_of = vec![0; data.scene.points.len()];
    for posture in data.postures().iter() {
        let points = posture.iter().flat_map(|&row| data.of_row(row)).filter_map(|at| data.series_of(at).point);
        points.collect::<BTreeSet<usize>>().into_iter().for_each(|point| postures_of[point] += 1);
    }
    postures_of.into_iter().filter(|&postures| postures == 1).count()
}

/// Different postures, and the numbers measured at them, each posture counted once.
pub fn different(data: &Measurements) -> (usize, usize) {
    let postures = data.postures();
    let seen = |rows: &[usize]| -> usize {
        let series = rows.iter().flat_map(|row| data.of_row(*row)).map(|observation| data.observed.series(observation));
        let series: BTreeSet<usize> = series.collect();
        series.into_iter().map(|series| data.scene.series[series].kind.height()).sum()
    };
    (postures.len(), postures.iter().map(seen).sum())
}
