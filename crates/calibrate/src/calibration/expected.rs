//! Expected error of the averaged prediction: among the measured postures, and with a joint outside its measured range.

use denavit_identify::arm::Row;
use denavit_identify::averaging::Averaging;
use denavit_identify::effects::Conditions;
use denavit_identify::effects::averaged::Averaged;
use denavit_linear::threads::in_parallel;
use denavit_measurements::{Measurements, RecordedRow};
use serde::Serialize;
use std::fmt::Write as _;

/// Measured postures that are evaluated, and those of them for each end of a joint's limits.
const POSTURES: usize = 40;
const FOR_EACH_END: usize = 12;
/// A range that ends this near to the joint's own has no outside, rad or m.
const AT_THE_END: f64 = 0.02;
/// An error above this multiple of the usual one is reported.
const WORTH_SAYING: f64 = 1.5;

/// Expected errors of the averaged prediction, m: lengths of the error vector, root mean square, an instrument's noise not in it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Expected {
    /// At the measured postures: the median.
    pub inside_m: f64,
    /// Of plain geometry, each posture predicted from all others.
    pub geometric_m: f64,
    /// With one joint outside.
    pub outside: Vec<Outside>,
}

/// The expected error with one joint outside its measured range.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Outside {
    /// The joint.
    pub joint: String,
    /// Lowest and highest reading that was measured, rad or m.
    pub measured: [f64; 2],
    /// The reading, between its limits, at which the error was taken.
    pub at: f64,
    /// The largest expected error there, the other joints as measured.
    pub error_m: f64,
}

impl Expected {
    /// Of a result.
    pub fn of(averaging: &Averaging, data: &Measurements) -> Self {
        let root = (data.scene.channels.iter().map(|part| part.height).max().unwrap_or(1).min(3) as f64).sqrt();
        let averaged = &averaging.fit.effects;
        let rows = data.spread_by_posture(POSTURES.min(data.len()));
        let mut inside =
            in_parallel(&rows, |&row| root * averaged.expected_error(&Conditions::of(Row::new(data, row))));
        inside.sort_by(f64::total_cmp);
        let inside_m = inside.get(inside.len() / 2).copied().unwrap_or(f64::NAN);
        let joints: Vec<usize> = (0..data.joints.len()).collect();
        let outside = in_parallel(&joints, |&k| outside(averaged, data, k, root)).into_iter().flatten();
        Self { inside_m, geometric_m: root * averaging.left_out[0], outside: outside.collect() }
    }

    /// As lines of a report.
    pub fn in_words(&self) -> String {
        let mut text = format!(
            "expected error of the averaged prediction: {:.3} mm rms among the measured postures (geometry alone: {:.3} mm)\n",
            self.inside_m * 1e3,
            self.geometric_m * 1e3
        );
        for outside in self.outside.iter().filter(|outside| outside.error_m > WORTH_SAYING * self.inside_m) {
            let Outside { joint, measured: [low, high], error_m, at } = outside;
            let _ = writeln!(
                text,
                "  error outside the measured range of {joint} ({low:.2} to {high:.2}) may reach {:.3} mm, at {at:.2}",
                error_m * 1e3
            );
        }
        text
    }
}

/// The largest expected error with a coordinate at an end of its limits that was not measured.
fn outside(averaged: &Averaged, data: &Measurements, k: usize, root: f64) -> Option<Outside> {
    let chain = &averaged.mean().statics.chain;
    let (low, high) = averaged.known.ranges[k];
    let (lower, upper) = chain.coordinates()[k].range();
    let ends = [lower, upper].into_iter().filter(|end| *end < low - AT_THE_END || *end > high + AT_THE_END);
    let nothing = averaged.bound(&|name| RecordedRow::nothing().column(name));
    let own: Vec<usize> = (0..data.len()).filter(|&row| data.moves_its_tip(row, k)).collect();
    let count = FOR_EACH_END.min(own.len());
    let rows = (0..count).map(|at| own[at * own.len() / count]);
    let worst = ends.flat_map(|at| rows.clone().map(move |row| (at, row))).map(|(at, row)| {
        let mut reading = data.reading(row).to_vec();
        reading[k] = at;
        let conditions = Conditions { reading: &reading, recorded: RecordedRow::nothing(), tip: data.tip_of(row) };
        (at, root * nothing.expected_error(&conditions))
    });
    let (at, error_m) = worst.max_by(|a, b| a.1.total_cmp(&b.1))?;
    Some(Outside { joint: chain.coordinates()[k].name.clone(), measured: [low, high], at, error_m })
}
