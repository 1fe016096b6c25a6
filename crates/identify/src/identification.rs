//! Identification from a run of measurements: the nominal stage, then the axes.

use crate::arm::Arm;
use crate::continued;
use crate::identify_options::{IdentifyOptions, fit_stage};
use crate::initial_guess::{self, nominal_fit};
use crate::parameters::{Freedom, Layout, NoEffects, Tolerances};
use crate::posterior::expecting;
use crate::solve::{Fit, FitOptions, fit};
use denavit_measurements::{Measurements, Scene};
use denavit_model::Chain;

/// An earlier calibration on new rows.
#[derive(Debug, Clone)]
pub struct EarlierFit {
    /// Its axes, with instrument and targets placed again.
    pub fit: Fit<NoEffects>,
    /// Its weight in the geometric stage, as the new rows support it: 1 in full, 0 not at all.
    pub weight: f64,
}

/// The two stages that every calibration has.
#[derive(Debug, Clone)]
pub struct Identification {
    /// The robot as drawn, instrument and targets fitted to the rows that the geometric stage kept.
    pub nominal: Fit<NoEffects>,
    /// The robot of an earlier calibration, with instrument and targets fitted to the same rows.
    pub earlier: Option<Box<EarlierFit>>,
    /// The axes fitted too.
    pub geometric: Fit<NoEffects>,
}

impl IdentifyOptions {
    /// The same, but joints that never move in these data keep their axes, scales and pitches, unless an earlier calibration
    /// knows them.
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
        if let Some(earlier) = &self.earlier {
            options.freedom = earlier.freed(chain, &options.freedom);
        }
        options
    }

    /// Every axis, no scale, no pitch of a revolute joint, no earlier calibration, within the drawing's tolerances: the default for any robot.
    #[must_use]
    pub fn plain(&self, chain: &Chain) -> Self {
        let freedom = Freedom::axes(chain.joints().len());
        let tolerances = if self.freedom.zeros_alone() { Tolerances::default() } else { self.tolerances };
        let fit = FitOptions { widen: false, ..self.fit };
        Self { freedom, tolerances, fit, earlier: None, start_zeros: Vec::new() }
    }
}

/// Fit the nominal stage, then the geometry; joints that never move keep their axes.
pub fn identify(chain: &Chain, data: &Measurements, options: &IdentifyOptions) -> Identification {
    let options = &options.for_data(chain, data);
    let weights = vec![1.0; data.observations()];
    let few = initial_guess::some_rows(data);
    let some = few.as_ref().unwrap_or(data);
    let all = vec![1.0; some.observations()];
    let mut first = nominal_fit(chain, some, &all, &FitOptions { robust: true, ..options.fit });
    let as_drawn = first.arm.clone();
    if !options.start_zeros.is_empty() {
        let started = zeros_shifted(chain, &options.start_zeros);
        let placed = nominal_fit(&started, some, &all, &FitOptions { robust: true, ..options.fit });
        first.arm = Arm { nominal: chain.clone(), ..placed.arm };
    }
    let (geometric, weight) = if options.earlier.is_some() {
        continued::continued(data, &first.arm, &weights, options)
    } else {
        let staged = |arm: &Arm| fit_stage(data, arm, &NoEffects, &weights, options);
        (initial_guess::with_plates_turned(data, staged(&first.arm), &staged), 0.0)
    };
    let layout = &first.layout;
    let plain = FitOptions { robust: false, ..options.fit };
    // Its plates have the side of the geometric fit, which distinguishes the two sides.
    let start = initial_guess::with_plates_of(data, &as_drawn, &geometric.arm);
    let nominal = fit(data, layout, &start, &NoEffects, &geometric.weights, &plain);
    let earlier = options.earlier.as_ref().map(|earlier| {
        let free = Layout::new(chain, &data.scene, &options.freedom, &options.tolerances, Vec::new());
        let arm = expected(&expecting(free, Some(&earlier.counted(1.0))), &start);
        Box::new(EarlierFit { fit: fit(data, layout, &arm, &NoEffects, &geometric.weights, &plain), weight })
    });
    Identification { nominal, earlier, geometric }
}

/// The chain with shifted zeros: `zeros` is added to each reading, rad or m.
fn zeros_shifted(chain: &Chain, zeros: &[f64]) -> Chain {
    let mut arm = Arm::new(chain, &Scene::default());
    for (index, joint) in chain.joints().iter().enumerate() {
        if chain.joints()[..index].iter().all(|other| other.coordinate != joint.coordinate) {
            arm.shift_zero(index, zeros[joint.coordinate]);
        }
    }
    arm.chain()
}

/// Newton steps to the arm that deviates from the drawing by given numbers: convergence is quadratic.
const STEPS_TO_EXPECTED: usize = 4;

/// The arm with its axes where the layout's prior expects them.
fn expected(layout: &Layout, arm: &Arm) -> Arm {
    let mut expected = arm.clone();
    for _ in 0..STEPS_TO_EXPECTED {
        let perturbation = layout.perturbation(&expected, arm);
        let mut step = vec![0.0; layout.len()];
        step.iter_mut().zip(perturbation.iter()).for_each(|(step, perturbation)| *step = -perturbation);
        expected = layout.stepped(&expected, &step);
    }
    expected
}
