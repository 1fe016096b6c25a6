//! What to identify, and the fit of a stage.

use crate::arm::Arm;
use crate::parameters::{Effects, Freedom, Layout, Tolerances};
use crate::posterior::{Earlier, expecting};
use crate::solve::{Fit, FitOptions, fit};
use denavit_measurements::Measurements;
use denavit_model::Chain;

/// What to identify, and how firmly to hold the rest.
#[derive(Debug, Clone, PartialEq)]
pub struct IdentifyOptions {
    /// Which parts of the arm are free.
    pub freedom: Freedom,
    /// The prior: how far the robot is expected to be from its drawing.
    pub tolerances: Tolerances,
    /// An earlier calibration's knowledge of the axes; it replaces the tolerances of its parameters.
    pub earlier: Option<Earlier>,
    /// Outliers and the stopping rule.
    pub fit: FitOptions,
    /// Start values of zeros, one per coordinate, rad or m; empty: the drawing's.
    pub start_zeros: Vec<f64>,
}

impl IdentifyOptions {
    /// Every axis, the default prior, robust.
    pub fn axes(chain: &Chain) -> Self {
        Self {
            freedom: Freedom::axes(chain.joints().len()),
            tolerances: Tolerances::default(),
            earlier: None,
            fit: FitOptions::default(),
            start_zeros: Vec::new(),
        }
    }

    /// The zeros of these joints and no axis: servos are mounted to a few degrees, slides to a centimetre.
    pub fn zeros(chain: &Chain, which: Vec<bool>) -> Self {
        let freedom = Freedom { zeros: which, ..Freedom::placement(chain.joints().len()) };
        let tolerances = Tolerances { zero_turn: LOOSE_ZERO[0], zero_slide: LOOSE_ZERO[1], ..Tolerances::default() };
        Self { freedom, tolerances, ..Self::axes(chain) }
    }
}

/// Standard deviation of a zero that was never set, rad and m.
const LOOSE_ZERO: [f64; 2] = [0.1, 0.02];

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
    let chain = &start.nominal;
    let layout = Layout::new(chain, &data.scene, &options.freedom, &options.tolerances, effects.parameters());
    let layout = expecting(layout, options.earlier.as_ref());
    fit(data, &layout, start, effects, weights, &options.fit)
}
