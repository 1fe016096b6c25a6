//! Whether a calibration found little more than zeros of joints: axes that turn by the same angles about the axes before.

use crate::calibration::contract::{Identified, JointZeros};
use denavit_identify::initial_guess::some_rows;
use denavit_identify::parameters::NoEffects;
use denavit_identify::solve::{Fit, FitOptions};
use denavit_identify::{Identification, IdentifyOptions, fit_stage};
use denavit_measurements::Measurements;
use denavit_model::Chain;

/// Smallest share of what fitted axes explain (sums of squares) that zeros must explain.
const NEARLY_ALL: f64 = 0.98;
/// The error of the robot as drawn must be this many times that with fitted axes.
const DRAWN_IS_WORSE: f64 = 2.0;
/// One of the zeros must be larger than this, rad and m, and than this many of its standard deviations.
const LARGE: f64 = 0.01;
const SURE: f64 = 5.0;

/// The zeros, if they explain nearly as much as fitted axes.
pub(super) fn joint_zeros(
    chain: &Chain,
    data: &Measurements,
    found: &Identification,
    options: &IdentifyOptions,
    identified: impl Fn(&Fit<NoEffects>) -> Vec<Identified>,
) -> Option<JointZeros> {
    if options.earlier.is_some() || !options.freedom.axes.contains(&true) {
        return None;
    }
    let level = |fit: &Fit<NoEffects>| fit.noise.levels.first().copied();
    let (drawn, left) = (level(&found.nominal)?, level(&found.geometric)?);
    let worse = drawn > DRAWN_IS_WORSE * left;
    if !worse {
        return None;
    }
    let few = some_rows(data);
    let rows = few.as_ref().unwrap_or(data);
    let asked = IdentifyOptions {
        fit: FitOptions { robust: true, ..options.fit },
        ..IdentifyOptions::zeros(chain, vec![true; chain.joints().len()])
    };
    let zeros = fit_stage(rows, &found.nominal.arm, &NoEffects, &vec![1.0; rows.observations()], &asked);
    let share = (drawn.powi(2) - level(&zeros)?.powi(2)) / (drawn.powi(2) - left.powi(2));
    let zeros = identified(&zeros);
    let large = |zero: &Identified| zero.is_determined() && zero.change.abs() > LARGE.max(SURE * zero.std);
    (share >= NEARLY_ALL && zeros.iter().any(large)).then(|| JointZeros { share: share.min(1.0), zeros })
}
