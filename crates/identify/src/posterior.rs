//! A calibration's posterior of the axes, kept for the next one: mean, standard deviations and correlations of the joints'
//! parameters, and the drawn axes to which they refer.
//!
//! ```json
//! {"schema": "denavit.prior/1", "robot": "arm", "base": "base", "tip": "tool0",
//!  "parameters": [{"parameter": "j1.turn_x", "change": 1e-4, "std": 2e-5, "unit": "rad"}, …],
//!  "posterior": {"drawn": {"j1": [0, 0, 1, 0, 0, 0], …}, "correlations": [[], [0.3], [0.1, -0.2], …]}}
//! ```
//! A calibration's own JSON holds the same fields. `drawn`: twist `[omega; v]` of each axis as drawn, base frame, m and rad.
//! Row k of `correlations` holds those of parameter k with the parameters before it.

use crate::arm::AxisBasis;
use crate::effects_prior::EffectsPrior;
use crate::known_effects::{EffectsPosterior, KnownEffects};
use crate::parameters::{Freedom, Layout, Parameter, ParameterKind, Tolerances};
use crate::prior::KnownBefore;
use crate::solve::Fit;
use denavit_measurements::Scene;
use denavit_model::Chain;
use denavit_model::chain::{ChainError, ChainJoint};
use denavit_model::nalgebra::{DMatrix, DVector, Rotation3, Unit};
use denavit_model::screw::{AxisLine, Pitch, Screw};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::sync::Arc;
use thiserror::Error;

/// Version of a file that holds only this.
pub const SCHEMA: &str = "denavit.prior/1";
/// Version of a calibration's own JSON.
pub const CALIBRATION_SCHEMA: &str = "denavit.calibration/2";
/// Axes drawn this far apart, m and rad, belong to different drawings.
const SAME_DRAWING: f64 = 1e-6;
/// Upper bound of changes and standard deviations, in their units.
const LARGEST: f64 = 1e6;
/// Fraction of its tolerance below which a standard deviation is mostly rounding.
const KNOWN_EXACTLY: f64 = 1e-6;
/// Correlations rounded to six digits leave eigenvalues this far below 0, for each parameter.
const ROUNDED_CORRELATIONS: f64 = 1e-6;

/// A fit's knowledge of the axes, other than the parameters' values and standard deviations.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Posterior {
    /// Twist `[omega; v]` of each joint's axis as drawn, base frame.
    pub drawn: BTreeMap<String, [f64; 6]>,
    /// For each parameter its correlations with those before it.
    pub correlations: Vec<Vec<f64>>,
    /// The posterior of effects and error curves; left out where there are none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub effects: Option<EffectsPosterior>,
    /// Its parameters, if they differ from those of the file; left out otherwise.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub parameters: Vec<KnownParameter>,
}

/// A parameter as it was identified.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct KnownParameter {
    /// Its name, such as `elbow_joint.turn_x`.
    pub parameter: String,
    /// Deviation from the drawing, in the unit.
    pub change: f64,
    /// Standard deviation.
    pub std: f64,
    /// `rad`, `m`, `m/rad` or `1`.
    pub unit: String,
}

/// The axes of an earlier calibration.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Earlier {
    schema: String,
    /// The robot's name.
    pub robot: String,
    /// Name of the base link.
    pub base: String,
    /// Name of the tip link.
    pub tip: String,
    /// The joints' parameters.
    pub parameters: Vec<KnownParameter>,
    /// Their correlations.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub posterior: Option<Posterior>,
    /// Its weight, from 0 to 1.
    #[serde(skip, default = "in_full")]
    pub weight: f64,
    /// The effects and error curves, as they were read.
    #[serde(skip)]
    pub effects: Option<Arc<KnownEffects>>,
}

fn in_full() -> f64 {
    1.0
}

/// Why an earlier calibration does not apply to this robot.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum EarlierError {
    /// No JSON, or not of this form.
    #[error("{file}: not a calibration ({why}); give a file from denavit calibrate ‹json›")]
    Form {
        /// The file.
        file: String,
        /// What the parser says.
        why: String,
    },
    /// Another version.
    #[error("{file}: schema is \"{found}\", which holds no prior; give a file from denavit calibrate ‹json›")]
    Schema {
        /// The file.
        file: String,
        /// As written.
        found: String,
    },
    /// The file holds no correlations, or nothing was identified.
    #[error("{file}: {why}, so no calibration can continue from it; calibrate again with its rows")]
    Nothing {
        /// The file.
        file: String,
        /// What it lacks.
        why: String,
    },
    /// An impossible number.
    #[error("{file}: {parameter}: {why}; make the file again")]
    Number {
        /// The file.
        file: String,
        /// The parameter.
        parameter: String,
        /// What is wrong.
        why: String,
    },
    /// Effects that the chain cannot have.
    #[error("{0}")]
    Effects(String),
    /// A joint or a parameter that this chain does not have.
    #[error("{file}: the chain {base} → {tip} has no {name}; choose the robot, base and tip of the file ({then})")]
    OtherChain {
        /// The file.
        file: String,
        /// The joint or the parameter.
        name: String,
        /// The chain's base.
        base: String,
        /// The chain's tip.
        tip: String,
        /// Robot, base and tip of the file.
        then: String,
    },
    /// The same names, other axes.
    #[error(
        "{file}: the drawn {joint} differs by {apart:.3} mm and mrad from that of the earlier calibration; give the robot as it \
         was drawn then, not its calibrated URDF"
    )]
    OtherDrawing {
        /// The file.
        file: String,
        /// The joint.
        joint: String,
        /// mm and mrad.
        apart: f64,
    },
}

impl Posterior {
    /// Of a fit's joints; `None` where it has no free axes.
    pub fn of<E>(fit: &Fit<E>) -> Option<Self> {
        let joints = fit.layout.joints.clone();
        let correlation = |i: usize, k: usize| {
            let size = fit.deviation(i) * fit.deviation(k);
            if size > 0.0 { (fit.covariance[(i, k)] / size).clamp(-1.0, 1.0) } else { 0.0 }
        };
        let correlations = joints.clone().map(|i| (0..i).map(|k| correlation(i, k)).collect()).collect();
        (!joints.is_empty()).then(|| Self {
            drawn: drawn(&fit.arm.nominal),
            correlations,
            effects: None,
            parameters: Vec::new(),
        })
    }
}

/// The inverse of [`crate::arm::Arm::change`].
fn changed(screw: &Screw, [ta, tb]: [f64; 2], [ma, mb]: [f64; 2], pitch: f64) -> Screw {
    let basis = AxisBasis::of(screw);
    let drawn = screw.direction().into_inner();
    let turn = basis.a * ta + basis.b * tb;
    let direction = Unit::new_normalize(Rotation3::from_scaled_axis(turn) * drawn);
    let across = basis.a * ma + basis.b * mb;
    // The point of the line that is nearest to the centre: the connecting line is perpendicular.
    let along = -direction.dot(&across) / direction.dot(&drawn);
    let axis = AxisLine { direction, point: basis.centre + across + drawn * along };
    let pitch = screw.pitch().unwrap_or(0.0) + pitch;
    match screw {
        Screw::Prismatic(_) => Screw::Prismatic(direction),
        _ => Pitch::from_metres_per_radian(pitch).map_or(Screw::Revolute(axis), |pitch| Screw::Helical { axis, pitch }),
    }
}

fn drawn(chain: &Chain) -> BTreeMap<String, [f64; 6]> {
    chain.joints().iter().map(|joint| (joint.name.clone(), joint.screw.twist().into())).collect()
}

impl Earlier {
    /// Reads the output of `denavit calibrate --json`, or a file with a prior only, for this chain.
    ///
    /// # Errors
    /// Another form, another robot, or another drawing of the same robot.
    pub fn read(file: &str, text: &str, chain: &Chain) -> Result<Self, EarlierError> {
        let form = |error: serde_json::Error| EarlierError::Form { file: file.into(), why: error.to_string() };
        let any: serde_json::Value = serde_json::from_str(text).map_err(form)?;
        let found = any["schema"].as_str().unwrap_or("missing");
        if found != SCHEMA && found != CALIBRATION_SCHEMA {
            return Err(EarlierError::Schema { file: file.into(), found: found.into() });
        }
        let mut earlier: Self = serde_json::from_str(text).map_err(form)?;
        if let Some(posterior) = earlier.posterior.as_mut().filter(|posterior| !posterior.parameters.is_empty()) {
            earlier.parameters = std::mem::take(&mut posterior.parameters);
        }
        earlier.check(file, chain)?;
        let effects = earlier.posterior.as_ref().and_then(|posterior| posterior.effects.as_ref());
        let effects = effects.map(|effects| effects.read(file, chain, earlier.parameters.len())).transpose();
        earlier.effects = effects.map_err(EarlierError::Effects)?.map(Arc::new);
        earlier.check_correlations(file, chain)?;
        Ok(earlier)
    }

    /// A robot's axes as expected from its siblings: means, standard deviations, and for each parameter its correlations
    /// with those before it.
    pub fn of_siblings(chain: &Chain, parameters: Vec<KnownParameter>, correlations: Vec<Vec<f64>>) -> Self {
        Self {
            schema: SCHEMA.into(),
            robot: chain.name().into(),
            base: chain.base().into(),
            tip: chain.tip().into(),
            parameters,
            posterior: Some(Posterior { drawn: drawn(chain), correlations, effects: None, parameters: Vec::new() }),
            weight: 1.0,
            effects: None,
        }
    }

    /// The chain with the axes of this calibration: exactly the changes that it reports.
    ///
    /// # Errors
    /// A number that makes the chain invalid.
    pub fn chain(&self, drawn: &Chain) -> Result<Chain, ChainError> {
        let joints = drawn.joints().iter().map(|joint| {
            let own = |word: &str| -> Vec<f64> {
                let start = format!("{}.{word}", joint.name);
                self.parameters.iter().filter(|of| of.parameter.starts_with(&start)).map(|of| of.change).collect()
            };
            let pair = |word: &str| match own(word)[..] {
                [one, other] => [one, other],
                _ => [0.0; 2],
            };
            let screw = changed(&joint.screw, pair("turn_"), pair("move_"), own("pitch").iter().sum());
            ChainJoint { screw, scale: joint.scale * (1.0 + own("scale").iter().sum::<f64>()), ..joint.clone() }
        });
        let names = (drawn.name(), drawn.base(), drawn.tip());
        Chain::new(names, drawn.coordinates().to_vec(), joints.collect(), *drawn.home())
    }

    /// As JSON text.
    pub fn to_json(&self) -> String {
        serde_json::to_string(self).expect("names are texts and numbers are numbers") + "\n"
    }

    fn check(&self, file: &str, chain: &Chain) -> Result<(), EarlierError> {
        let nothing = |why: &str| EarlierError::Nothing { file: file.into(), why: why.into() };
        let Some(posterior) = &self.posterior else {
            return Err(nothing(if self.parameters.is_empty() {
                "no axis was identified"
            } else {
                "it holds no correlations of the parameters"
            }));
        };
        let other_chain = |name: &str| EarlierError::OtherChain {
            file: file.into(),
            name: name.into(),
            base: chain.base().into(),
            tip: chain.tip().into(),
            then: format!("{}, {} → {}", self.robot, self.base, self.tip),
        };
        let number = |parameter: &str, why: &str| EarlierError::Number {
            file: file.into(),
            parameter: parameter.into(),
            why: why.into(),
        };
        if posterior.correlations.len() != self.parameters.len() {
            let why = format!("{} rows instead of {}", posterior.correlations.len(), self.parameters.len());
            return Err(number("posterior.correlations", &why));
        }
        if let Some(name) = posterior.drawn.keys().find(|name| axis_of(chain, name).is_none()) {
            return Err(other_chain(name));
        }
        for (name, then) in &posterior.drawn {
            let apart = drawn_apart(chain, name, then).unwrap_or(f64::NAN);
            if !apart.is_finite() || apart > SAME_DRAWING {
                return Err(EarlierError::OtherDrawing { file: file.into(), joint: name.clone(), apart: apart * 1e3 });
            }
        }
        let own = every_parameter(chain);
        for (index, (known, row)) in self.parameters.iter().zip(&posterior.correlations).enumerate() {
            let name = &known.parameter;
            let Some(parameter) = own.iter().find(|own| own.name == *name) else {
                return Err(other_chain(name));
            };
            if self.parameters[..index].iter().any(|before| before.parameter == *name) {
                return Err(number(name, "it appears twice"));
            }
            if parameter.unit != known.unit {
                return Err(number(name, &format!("its unit is \"{}\", not \"{}\"", parameter.unit, known.unit)));
            }
            if !(known.change.abs() < LARGEST && (0.0..LARGEST).contains(&known.std)) {
                return Err(number(name, "its change and std must be below 1e6, std not below 0"));
            }
            if row.len() != index || row.iter().any(|value| !(-1.0..=1.0).contains(value)) {
                return Err(number(name, &format!("it needs {index} correlations between -1 and 1")));
            }
        }
        Ok(())
    }

    /// Checks that these correlations are possible: no direction has a negative variance.
    ///
    /// Parameters that are known far better than their tolerance count less: their correlations are mostly rounding.
    fn check_correlations(&self, file: &str, chain: &Chain) -> Result<(), EarlierError> {
        let own = every_parameter(chain);
        let tolerance = |name: &str| own.iter().find(|own| own.name == name).and_then(|own| own.tolerance);
        let weight = |known: &KnownParameter| {
            let tolerance = tolerance(&known.parameter).unwrap_or(1.0);
            if known.std > 0.0 { known.std / (known.std + KNOWN_EXACTLY * tolerance) } else { 0.0 }
        };
        let mut weights: Vec<f64> = self.parameters.iter().map(weight).collect();
        let mut rows: Vec<&[f64]> = Vec::new();
        rows.extend(self.posterior.iter().flat_map(|posterior| &posterior.correlations).map(Vec::as_slice));
        if let Some(effects) = &self.effects {
            weights.extend(effects.std.iter().map(|std| if *std > 0.0 { 1.0 } else { 0.0 }));
            rows.extend(effects.correlations.iter().map(Vec::as_slice));
        }
        let count = rows.len();
        let cell = |i: usize, k: usize| match i.cmp(&k) {
            std::cmp::Ordering::Equal => 1.0,
            std::cmp::Ordering::Greater => rows[i][k],
            std::cmp::Ordering::Less => rows[k][i],
        };
        let matrix = DMatrix::from_fn(count, count, |i, k| cell(i, k) * weights[i] * weights[k]);
        let least = if count == 0 { 0.0 } else { matrix.symmetric_eigenvalues().min() };
        if least < -ROUNDED_CORRELATIONS * count as f64 {
            let why = format!(
                "these correlations are impossible: their matrix has the eigenvalue {least:.3}, and none may be below 0"
            );
            let parameter = "posterior.correlations".into();
            return Err(EarlierError::Number { file: file.into(), parameter, why });
        }
        Ok(())
    }

    /// The prior of some coefficients of effects by an earlier fit, given the axes: `first` is the index of the first among the numbers
    /// of all effects. `None` where the earlier fit has no effects.
    ///
    /// A collision may have changed the axes since, but not the effects: with C the earlier covariance of axes and coefficients and C_w that
    /// of the axes with their present weight w, the axes are η = η_then + k, k ~ N(0, C_w - C_ηη), so that
    /// c | η ~ N(m + A (η - μ), C_cc - A C_ηc), A = C_cη C_w⁻¹. With less knowledge of the axes, these say less of the coefficients,
    /// which keep their own m and C_cc.
    pub(crate) fn of_effects(
        &self,
        layout: &Layout,
        coefficients: &[usize],
        mean: Vec<f64>,
        first: usize,
    ) -> Option<EffectsPrior> {
        let effects = self.effects.as_ref().filter(|_| !coefficients.is_empty())?;
        let std: Vec<f64> = self.parameters.iter().map(|parameter| parameter.std).collect();
        let (own, by_parameter) = effects.covariance(coefficients, &std);
        // Both hold the common frame's motions, too.
        let axes = layout.with_effects(Vec::new());
        let joints = &layout.parameters[layout.joints.clone()];
        let expected = expecting(axes.clone(), Some(&self.counted(1.0))).prior.mean;
        let all = expecting(axes, Some(self)).prior.covariance(joints);
        let place = |known: &KnownParameter| joints.iter().position(|parameter| parameter.name == known.parameter);
        let kept: Vec<(usize, usize)> =
            self.parameters.iter().enumerate().filter_map(|(then, known)| Some((then, place(known)?))).collect();
        let (then, now): (Vec<usize>, Vec<usize>) = kept.into_iter().unzip();
        let known = (expected.select_rows(&now), all.select_rows(&now).select_columns(&now));
        let prior = EffectsPrior::new(first, DVector::from_vec(mean), &own, &by_parameter.select_columns(&then), known);
        Some(prior.spread_over(&now, joints.len()))
    }

    /// The earlier knowledge of the layout's joints; parameters that are held now are left out.
    fn known(&self, layout: &Layout) -> KnownBefore {
        let parameters = &layout.parameters[layout.joints.clone()];
        let at = |name: &str| parameters.iter().position(|parameter| parameter.name == name);
        let kept: Vec<(usize, usize)> = (0..self.parameters.len())
            .filter_map(|then| at(&self.parameters[then].parameter).map(|now| (then, now)))
            .collect();
        let correlation = |i: usize, k: usize| match (&self.posterior, i.cmp(&k)) {
            (_, std::cmp::Ordering::Equal) => 1.0,
            (Some(posterior), std::cmp::Ordering::Greater) => posterior.correlations[i][k],
            (Some(posterior), std::cmp::Ordering::Less) => posterior.correlations[k][i],
            (None, _) => 0.0,
        };
        let of = |i: usize| &self.parameters[kept[i].0];
        KnownBefore {
            indices: kept.iter().map(|(_, now)| *now).collect(),
            weight: self.weight,
            mean: DVector::from_fn(kept.len(), |i, _| of(i).change),
            covariance: DMatrix::from_fn(kept.len(), kept.len(), |i, k| {
                correlation(kept[i].0, kept[k].0) * of(i).std * of(k).std
            }),
        }
    }

    /// The same with another weight.
    #[must_use]
    pub fn counted(&self, weight: f64) -> Self {
        Self { weight, ..self.clone() }
    }

    /// The freedom, with all parameters of the earlier calibration free.
    #[must_use]
    pub fn freed(&self, chain: &Chain, freedom: &Freedom) -> Freedom {
        let mut freed = freedom.clone();
        for parameter in every_parameter(chain) {
            if !self.parameters.iter().any(|known| known.parameter == parameter.name) {
                continue;
            }
            match parameter.kind {
                ParameterKind::Turn { joint, .. } | ParameterKind::Move { joint, .. } => freed.axes[joint] = true,
                ParameterKind::Pitch { joint } => freed.pitches[joint] = true,
                ParameterKind::Scale { joint } => freed.scales[joint] = true,
                ParameterKind::Zero { joint } => freed.zeros[joint] = true,
                _ => {}
            }
        }
        freed
    }
}

/// Twist of a joint's axis as drawn.
fn axis_of(chain: &Chain, joint: &str) -> Option<[f64; 6]> {
    chain.joints().iter().find(|own| own.name == joint).map(|own| own.screw.twist().into())
}

/// Distance of a joint's drawn axis from an axis, m and rad; `None` where there is no such joint.
fn drawn_apart(chain: &Chain, joint: &str, axis: &[f64; 6]) -> Option<f64> {
    let now = axis_of(chain, joint)?;
    let apart = now.iter().zip(axis).map(|(a, b)| (a - b).abs());
    // NaN stays NaN.
    Some(apart.fold(0.0, |most, apart| if apart <= most { most } else { apart }))
}

/// Whether a chain has these axes and no others: twist `[omega; v]` of each joint.
pub fn same_drawing(chain: &Chain, axes: &BTreeMap<String, [f64; 6]>) -> bool {
    let near = |(joint, axis): (&String, &[f64; 6])| {
        drawn_apart(chain, joint, axis).is_some_and(|apart| apart <= SAME_DRAWING)
    };
    axes.len() == chain.joints().len() && axes.iter().all(near)
}

/// The layout with its joints expected at the result of an earlier calibration, if there is one.
pub fn expecting(layout: Layout, earlier: Option<&Earlier>) -> Layout {
    let Some(earlier) = earlier else { return layout };
    let known = earlier.known(&layout);
    layout.knowing(&known)
}

/// All parameters of a chain's joints that a fit can free.
fn every_parameter(chain: &Chain) -> Vec<Parameter> {
    let all = vec![true; chain.joints().len()];
    let freedom = Freedom { axes: all.clone(), scales: all.clone(), pitches: all.clone(), zeros: all };
    let mut layout = Layout::new(chain, &Scene::default(), &freedom, &Tolerances::default(), Vec::new());
    layout.parameters.truncate(layout.joints.end);
    layout.parameters
}
