//! Possible causes of rows that are out of line: a joint whose reading is wrong, a target that has moved on the tip, an instrument or
//! a base that has moved. Each has a few parameters; it explains the rows if the residual at the best parameters is no more than chance.

use super::out_of_line::{Prediction, quantile};
use denavit_identify::arm::Arm;
use denavit_identify::parameters::NoEffects;
use denavit_identify::residual::{ResidualModel, Scratch};
use denavit_identify::solve::Fit;
use denavit_measurements::Measurements;
use denavit_measurements::kinds::Frame;
use denavit_model::nalgebra::{Cholesky, DMatrix, DVector, Dyn, Rotation3, Vector3, Vector6};
use denavit_model::{Quantity, se3};

/// Largest number of rows used, the last that are out of line.
const ROWS: usize = 6;
/// Smallest probability of the residual by chance that is accepted.
const UNLIKELY: f64 = 1e-3;
/// Steps of the search: the rows are near to linear in what is searched.
const STEPS: usize = 8;
/// Step of the differences, rad and m.
const DIFFERENCE: f64 = 1e-6;

/// Something that may have changed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Suspect {
    /// A coordinate's reading.
    Reading(usize),
    /// The place of a target on the tip, and its orientation where that is seen.
    Target(usize, bool),
    /// The frame of a setup's instrument.
    Instrument(usize),
}

impl Suspect {
    fn numbers(self) -> usize {
        match self {
            Self::Reading(_) => 1,
            Self::Target(_, turned) => {
                if turned {
                    6
                } else {
                    3
                }
            }
            Self::Instrument(_) => 6,
        }
    }

    /// The arm and the rows after this change: shifts (m), then turns (rad).
    fn changed(self, arm: &Arm, rows: &Measurements, by: &[f64]) -> (Arm, Measurements) {
        let (mut arm, mut rows) = (arm.clone(), rows.clone());
        match self {
            Self::Reading(coordinate) => {
                let count = rows.joints.len();
                rows.readings.iter_mut().skip(coordinate).step_by(count).for_each(|reading| *reading += by[0]);
            }
            Self::Target(target, turned) => {
                let pose = &mut arm.targets[target];
                pose.translation.vector += Vector3::from_row_slice(&by[..3]);
                if turned {
                    pose.rotation = Rotation3::from_scaled_axis(Vector3::from_row_slice(&by[3..])) * pose.rotation;
                }
            }
            Self::Instrument(setup) => {
                let motion = se3::exp(&Vector6::new(by[3], by[4], by[5], by[0], by[1], by[2]));
                arm.instruments[setup] *= motion;
            }
        }
        (arm, rows)
    }

    fn in_words(self, fit: &Fit<NoEffects>, data: &Measurements, by: &[f64], centre: &Vector3<f64>) -> String {
        let length = |v: &[f64]| format!("{:.2} mm", Vector3::from_row_slice(v).norm() * 1e3);
        let angle = |v: &[f64]| format!("{:.3}°", Vector3::from_row_slice(v).norm().to_degrees());
        match self {
            Self::Reading(coordinate) => {
                let coordinate = &fit.arm.nominal.coordinates()[coordinate];
                let shift = match coordinate.quantity {
                    Quantity::Angle => format!("{:+.3}°", by[0].to_degrees()),
                    Quantity::Length => format!("{:+.3} mm", by[0] * 1e3),
                };
                format!("joint {} is {shift} away from its reading", coordinate.name)
            }
            Self::Target(target, turned) => {
                let name = &data.scene.targets[target];
                let called = if name.is_empty() { "the target".into() } else { format!("target {name}") };
                let turn = if turned { format!(" and turned by {}", angle(&by[3..])) } else { String::new() };
                format!(
                    "{called} has moved by {}{turn} on the tip: another reflector, or one that slipped",
                    length(&by[..3])
                )
            }
            Self::Instrument(_) => {
                // Where the rows are, not at the far origin of the base.
                let there = Vector3::from_row_slice(&by[..3]) + Vector3::from_row_slice(&by[3..]).cross(centre);
                format!(
                    "the instrument or the robot's base has moved by {} and {}",
                    length(there.as_slice()),
                    angle(&by[3..])
                )
            }
        }
    }
}

/// What would explain rows that do not fit (the last one first), in words, the likeliest first; and whether these rows
/// are too few to test every cause.
pub(super) fn explanations(fit: &Fit<NoEffects>, data: &Measurements, rows: &[usize]) -> (Vec<String>, bool) {
    let rows: Vec<usize> = rows.iter().copied().take(ROWS).collect();
    let found = Prediction::of(fit, data, &rows);
    let few = data.subset(&rows);
    let Some(factor) = found.covariance.clone().cholesky() else { return (Vec::new(), false) };
    let mut suspects: Vec<Suspect> = (0..data.joints.len()).map(Suspect::Reading).collect();
    for series in (0..few.observations()).map(|observation| few.series_of(observation)) {
        let target = Suspect::Target(series.target, data.scene.turns(series.target));
        let own = series.kind.unknowns().frame == Frame::Instrument;
        let instrument = own.then_some(Suspect::Instrument(series.setup));
        for suspect in std::iter::once(target).chain(instrument) {
            if !suspects.contains(&suspect) {
                suspects.push(suspect);
            }
        }
    }
    let centre = centre(fit, &few);
    let height = found.residual.len();
    let mut explained: Vec<(f64, String)> = Vec::new();
    let undecided = suspects.iter().any(|suspect| suspect.numbers() >= height);
    for suspect in suspects.into_iter().filter(|suspect| suspect.numbers() < height) {
        let Some((by, left)) = searched(fit, &few, &factor, suspect) else { continue };
        let degrees = (height - suspect.numbers()) as f64;
        let size = left / degrees;
        if size <= quantile(degrees, fit.degrees_of_freedom(), 1.0 - UNLIKELY) {
            explained.push((left + suspect.numbers() as f64, suspect.in_words(fit, data, &by, &centre)));
        }
    }
    explained.sort_by(|a, b| a.0.total_cmp(&b.0));
    (explained.into_iter().map(|(_, words)| words).collect(), undecided)
}

/// The middle of where the rows have their targets, base frame, m.
fn centre(fit: &Fit<NoEffects>, rows: &Measurements) -> Vector3<f64> {
    let problem = ResidualModel { data: rows, layout: &fit.layout, effects: &NoEffects };
    let mut scratch = Scratch::new(&fit.layout, &fit.arm);
    let mut sum = Vector3::zeros();
    for row in 0..rows.len() {
        problem.stand(&fit.arm, row, &mut scratch);
        let target = rows.of_row(row).next().map_or(0, |observation| rows.series_of(observation).target);
        let tip = scratch.state().tip;
        sum += tip.rotation * fit.arm.targets[target].translation.vector + tip.translation.vector;
    }
    sum / rows.len().max(1) as f64
}

/// The change with the least residual, and its rᵀ S⁻¹ r: Gauss-Newton with numerical derivatives.
fn searched(
    fit: &Fit<NoEffects>,
    rows: &Measurements,
    factor: &Cholesky<f64, Dyn>,
    suspect: Suspect,
) -> Option<(Vec<f64>, f64)> {
    let residual = |by: &[f64]| {
        let (arm, rows) = suspect.changed(&fit.arm, rows, by);
        let problem = ResidualModel { data: &rows, layout: &fit.layout, effects: &NoEffects };
        let mut scratch = Scratch::new(&fit.layout, &arm);
        let mut values = Vec::new();
        let mut own = vec![0.0; rows.tallest_row()];
        for row in 0..rows.len() {
            problem.row_into(&arm, row, &mut scratch, &mut own, None);
            values.extend_from_slice(&own[..problem.height_of(row)]);
        }
        // L⁻¹ r, whose square is rᵀ S⁻¹ r.
        factor.l().solve_lower_triangular(&DVector::from_vec(values))
    };
    let count = suspect.numbers();
    let mut by = vec![0.0; count];
    let mut now = residual(&by)?;
    for _ in 0..STEPS {
        let mut jacobian = DMatrix::zeros(now.len(), count);
        for k in 0..count {
            let mut moved = by.clone();
            moved[k] += DIFFERENCE;
            jacobian.set_column(k, &((residual(&moved)? - &now) / DIFFERENCE));
        }
        let step = jacobian.svd(true, true).solve(&now, 1e-9).expect("both sets of singular vectors were asked for");
        let next: Vec<f64> = by.iter().zip(step.iter()).map(|(by, step)| by - step).collect();
        let then = residual(&next)?;
        if then.norm_squared() >= now.norm_squared() {
            break;
        }
        (by, now) = (next, then);
    }
    Some((by, now.norm_squared()))
}
