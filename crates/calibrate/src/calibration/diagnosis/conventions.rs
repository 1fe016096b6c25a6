//! The convention of an orientation written as three angles.
//!
//! ```text
//! M = R_instrument T R_target     ⇒     |log(Mᵢ Mₖᵀ)| = |log(Tᵢ Tₖᵀ)|,   |log(Mᵢᵀ Mₖ)| = |log(Tᵢᵀ Tₖ)|
//! ```
//! How far the target turned between two rows does not depend on where instrument and target sit, so every convention is tried on
//! the angles as they are written, without any fit.

use denavit_measurements::Measurements;
use denavit_measurements::import::AngleConvention;
use denavit_model::Chain;
use denavit_model::nalgebra::{Rotation3, UnitQuaternion};
use std::f64::consts::PI;

/// Turns that differ by less than this are equal, rad.
const ROUNDING: f64 = 1e-9;
/// Number of conventions returned.
const BEST: usize = 4;
/// The file's angles may be in the other unit.
const FACTORS: [f64; 3] = [1.0, 180.0 / PI, PI / 180.0];

/// An interpretation of the angles: convention, inverse or not, and factor.
pub(super) type Meant = (AngleConvention, bool, f64);

/// The rotation of three written numbers.
pub(super) fn rotation((convention, inverse, factor): Meant, by_axis: bool, numbers: [f64; 3]) -> Rotation3<f64> {
    let rotation = convention.rotation(numbers.map(|number| number * factor), by_axis);
    if inverse { rotation.inverse() } else { rotation }
}

/// The conventions that agree best with how the drawn robot turns its tip, the best first.
pub(super) fn likely(chain: &Chain, data: &Measurements) -> Vec<Meant> {
    let Some(written) = &data.angles else { return Vec::new() };
    let tips = data.scene.tips_of(chain);
    let rows: Vec<usize> = (0..data.len()).filter(|&row| written.numbers[row].iter().all(|n| n.is_finite())).collect();
    let drawn: Vec<Rotation3<f64>> =
        rows.iter().map(|&row| tips[data.tip_of(row)].fk(chain, data.reading(row)).rotation).collect();
    let mut scored: Vec<(f64, Meant)> = Vec::new();
    for convention in AngleConvention::all() {
        for inverse in [false, true] {
            for factor in FACTORS {
                let meant = (convention, inverse, factor);
                let own = |row: &usize| rotation(meant, written.by_axis, written.numbers[*row]);
                let turned: Vec<Rotation3<f64>> = rows.iter().map(own).collect();
                scored.push((apart(&drawn, &turned), meant));
            }
        }
    }
    // One rotation has two names, XYZ and zyx; rounding does not choose between them.
    scored.sort_by(|a, b| (a.0 / ROUNDING).round().total_cmp(&(b.0 / ROUNDING).round()));
    scored
        .into_iter()
        .map(|(_, meant)| meant)
        .filter(|meant| *meant != (written.read_as, false, 1.0))
        .take(BEST)
        .collect()
}

fn angle(rotation: &Rotation3<f64>) -> f64 {
    UnitQuaternion::from_rotation_matrix(rotation).angle()
}

/// By how much turns between rows differ, rad rms.
fn apart(drawn: &[Rotation3<f64>], turned: &[Rotation3<f64>]) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for i in 0..drawn.len() {
        for k in 0..i {
            let outer = angle(&(drawn[i] * drawn[k].inverse())) - angle(&(turned[i] * turned[k].inverse()));
            let inner = angle(&(drawn[i].inverse() * drawn[k])) - angle(&(turned[i].inverse() * turned[k]));
            sum += outer * outer + inner * inner;
            count += 2.0;
        }
    }
    (sum / f64::max(count, 1.0)).sqrt()
}
