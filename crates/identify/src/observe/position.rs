//! The position of a target in the instrument's frame.
//!
//! r = X⁻¹ m - p in the base frame, with X = instrument_from_base, m the measured position, p the target. The instrument is at the origin
//! of its frame, so m/|m| is its line of sight.

use super::{Discrepancy, Disturbance, Follows, Observe, Rows, Seen};
use crate::arm::AlongSight;
use crate::parameters::{Layout, Sensitivity};
use denavit_model::nalgebra::{Matrix3, Vector3};

#[derive(Debug)]
pub(super) struct Position;

fn read(seen: &Seen<'_>) -> Vector3<f64> {
    Vector3::new(seen.values[0], seen.values[1], seen.values[2])
}

/// The measured position, in the base frame.
pub(super) fn in_base(seen: &Seen<'_>) -> Vector3<f64> {
    let instrument = seen.instrument();
    let read = read(seen) / (1.0 + seen.perturbation.scale) - instrument.translation.vector;
    instrument.rotation.inverse() * read - beyond(seen, &seen.perturbation.sight)
}

/// Excess of the range along the line of sight, base frame.
fn beyond(seen: &Seen<'_>, sight: &AlongSight) -> Vector3<f64> {
    sight.beyond(&read(seen), seen.instrument(), seen.tip)
}

/// Effects of the instrument: its scale, and errors along its line of sight.
pub(super) fn by_instrument(seen: &Seen<'_>, effect: &Sensitivity) -> Vector3<f64> {
    let scale = effect.scale / (1.0 + seen.perturbation.scale).powi(2);
    -(seen.instrument().rotation.inverse() * read(seen) * scale) - beyond(seen, &effect.sight)
}

/// Columns of the instrument in the rows of the position.
pub(super) fn instrument_columns(seen: &Seen<'_>, layout: &Layout, rows: &mut Rows<'_>) {
    let Some(column) = layout.instruments[seen.series.setup] else { return };
    // In the instrument's own axes the residual is m - X p: its derivative by X is at the predicted target.
    let [x, y, z]: [f64; 3] = if seen.weighed { seen.predicted } else { in_base(seen) }.into();
    rows.put(0, column, &[0.0, -z, y, -1.0, 0.0, 0.0]);
    rows.put(1, column, &[z, 0.0, -x, 0.0, -1.0, 0.0]);
    rows.put(2, column, &[-y, x, 0.0, 0.0, 0.0, -1.0]);
}

/// The reading of a perfect instrument.
pub(super) fn predict(seen: &Seen<'_>, values: &mut Vec<f64>) {
    let instrument = seen.instrument();
    let there = instrument.rotation * seen.predicted + instrument.translation.vector;
    let beyond = instrument.rotation * seen.perturbation.sight.beyond(&there, instrument, seen.tip);
    values.extend((there * (1.0 + seen.perturbation.scale) + beyond).iter());
}

pub(super) fn disturb(values: &mut [f64], errors: &mut Disturbance<'_>) {
    let noise = errors.vector(errors.position);
    for k in 0..3 {
        values[k] = values[k] + errors.gross[k] + noise[k];
    }
}

impl Observe for Position {
    fn discrepancy(&self, seen: &Seen<'_>) -> Discrepancy {
        Discrepancy { place: in_base(seen) - seen.predicted, turn: Vector3::zeros() }
    }

    fn follows(&self, _seen: &Seen<'_>) -> Follows {
        Follows::Whole
    }

    fn by_effect(&self, seen: &Seen<'_>, effect: &Sensitivity) -> Vector3<f64> {
        by_instrument(seen, effect)
    }

    fn own_columns(&self, seen: &Seen<'_>, layout: &Layout, _left: &Matrix3<f64>, rows: &mut Rows<'_>) {
        instrument_columns(seen, layout, rows);
    }

    fn predict(&self, seen: &Seen<'_>, values: &mut Vec<f64>) {
        predict(seen, values);
    }

    fn disturb(&self, values: &mut [f64], errors: &mut Disturbance<'_>) {
        disturb(values, errors);
    }
}
