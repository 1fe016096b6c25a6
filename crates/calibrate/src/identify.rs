//! From data to an arm: the nominal stage, then the axes.

pub mod dh_form;
pub(crate) mod gram;
pub mod identifiability;
pub mod initial_guess;
pub mod intervals;
mod jacobian_block;
pub mod lack_of_fit;
pub mod normal_equations;
pub mod proportion;
pub mod quantization;
pub mod redundancy;
pub mod residual;
pub mod residual_statistics;
mod simd_residuals;
pub mod solve;
pub mod stop;
pub mod threads;

use self::initial_guess::nominal_fit;
use crate::identify::solve::{Fit, FitOptions, fit};
use crate::observation::arm::Arm;
use crate::observation::measurements::Measurements;
use crate::observation::parameters::{Effects, Freedom, Layout, NoEffects, Tolerances};
use denavit_model::Chain;

/// What is to be identified, and what is held how firmly.
#[derive(Debug, Clone, PartialEq)]
pub struct IdentifyOptions {
    /// Which parts of the arm are free.
    pub freedom: Freedom,
    /// The prior.
    pub tolerances: Tolerances,
    /// Outliers and the end of the iteration.
    pub fit: FitOptions,
}

impl IdentifyOptions {
    /// Every axis, the default prior, robust.
    pub fn axes(chain: &Chain) -> Self {
        Self {
            freedom: Freedom::axes(chain.joints().len()),
            tolerances: Tolerances::default(),
            fit: FitOptions::default(),
        }
    }
}

/// The two stages that every calibration has.
#[derive(Debug, Clone)]
pub struct Identification {
    /// The robot as drawn, instrument and targets fitted to the rows that the geometric stage kept.
    pub nominal: Fit<NoEffects>,
    /// The axes fitted too.
    pub geometric: Fit<NoEffects>,
}

impl IdentifyOptions {
    /// The same, but joints that never move in these data keep their axes, scales and pitches.
    #[must_use]
    pub fn for_data(&self, chain: &Chain, data: &Measurements) -> Self {
        let mut options = self.clone();
        for (index, joint) in chain.joints().iter().enumerate() {
            if data.never_moves(joint.coordinate) {
                options.freedom.axes[index] = false;
                options.freedom.scales[index] = false;
                options.freedom.pitches[index] = false;
            }
        }
        options
    }
}

/// Fit the nominal stage, then the geometry; joints that never move keep their axes.
pub fn identify(chain: &Chain, data: &Measurements, options: &IdentifyOptions) -> Identification {
    let options = &options.for_data(chain, data);
    let weights = vec![1.0; data.observations()];
    let few = initial_guess::some_rows(data);
    let some = few.as_ref().unwrap_or(data);
    let all = vec![1.0; some.observations()];
    let first = nominal_fit(chain, some, &all, &FitOptions { robust: true, ..options.fit });
    let geometric = fit_stage(data, &first.arm, &NoEffects, &weights, options);
    let layout = &first.layout;
    let plain = FitOptions { robust: false, ..options.fit };
    let nominal = fit(data, layout, &first.arm, &NoEffects, &geometric.weights, &plain);
    Identification { nominal, geometric }
}

/// Fit axes, instrument, targets and the effects' numbers together, starting at `start`.
///
/// # Shape and units
/// `weights`: one per observation, 0 for what is to be left out.
pub fn fit_stage<E: Effects>(
    data: &Measurements,
    start: &Arm,
    effects: &E,
    weights: &[f64],
    options: &IdentifyOptions,
) -> Fit<E> {
    let layout = Layout::new(&start.nominal, &data.scene, &options.freedom, &options.tolerances, effects.parameters());
    fit(data, &layout, start, effects, weights, &options.fit)
}
