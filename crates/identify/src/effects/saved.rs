//! Effects as JSON, to be used again: by forward kinematics, by compensation, by the simulator.
//!
//! ```json
//! {"schema": "denavit.effects/1", "robot": "arm", "joints": ["j1", "j2"], "drawn": {…},
//!  "effects": [{"kind": "joint_compliance", "carrier": {"joint": 1}, "driver": {"torque": 1}, "coupling": "each",
//!               "coefficients": [2e-5], "formula": "…", "units": "…", "source": "…"}]}
//! ```
//! Joints are counted from 0 in the order of `joints`. Coefficients: direction by direction of the carrier, within it value
//! by value of the driver. `drawn` is the robot that the effects were found on ([`ReferenceRobot`]); without it they are taken to be
//! those of the robot at hand.

use crate::effects::averaged::Averaged;
use crate::effects::averaged::written::WrittenAveraged;
use crate::effects::correction::Correction;
use crate::effects::curve::Curve;
use crate::effects::driver::{Driver, Statics};
use crate::effects::model::{Effect, EffectModel, Term};
use crate::effects::reference_robot::{ReferenceRobot, apart};
use crate::effects::written::{WrittenDriver, named};
use denavit_measurements::{Column, MissingColumn};
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// Version of the format.
pub const SCHEMA: &str = "denavit.effects/1";

#[derive(Debug, Serialize, Deserialize)]
struct Saved {
    schema: String,
    robot: String,
    joints: Vec<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    drawn: Option<ReferenceRobot>,
    effects: Vec<SavedEffect>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    curves: Vec<Curve>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    averaged: Option<WrittenAveraged>,
}

#[derive(Debug, Serialize, Deserialize)]
struct SavedEffect {
    #[serde(flatten)]
    effect: Effect<WrittenDriver>,
    #[serde(default)]
    formula: String,
    #[serde(default)]
    units: String,
    #[serde(default)]
    source: String,
}

/// Why a file's effects do not apply to this robot.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum SavedError {
    /// No JSON, or not of this form.
    #[error("{file}: not a file of effects ({why}); make one with denavit calibrate ‹effects-out›")]
    Form {
        /// The file.
        file: String,
        /// What the parser says.
        why: String,
    },
    /// Another version.
    #[error(
        "{file}: schema is \"{found}\", but this program reads \"{SCHEMA}\"; make one with denavit calibrate ‹effects-out›"
    )]
    Schema {
        /// The file.
        file: String,
        /// As written.
        found: String,
    },
    /// For another robot.
    #[error("{file}: the effects are for joints {found}, but the chain has {wanted}; choose ‹base› and ‹tip› to match")]
    OtherJoints {
        /// The file.
        file: String,
        /// As written.
        found: String,
        /// The chain's.
        wanted: String,
    },
    /// For another robot with joints of the same names.
    #[error(
        "{file}: the effects belong to robot \"{found}\", whose tip is {apart:.3} m away from this one's; give the \
         robot that they were found on, as drawn or as calibrated"
    )]
    OtherRobot {
        /// The file.
        file: String,
        /// Its robot.
        found: String,
        /// m.
        apart: f64,
    },
    /// The file's drawn robot is invalid.
    #[error("{file}: drawn: {why}; make the file again with denavit calibrate ‹effects-out›")]
    ReferenceRobot {
        /// The file.
        file: String,
        /// What is wrong.
        why: String,
    },
    /// A curve that the chain cannot have.
    #[error("{file}: curve {index}: {why}")]
    BadCurve {
        /// The file.
        file: String,
        /// Counted from 1.
        index: usize,
        /// What is wrong, and what to do.
        why: String,
    },
    /// An effect that the chain cannot have.
    #[error("{file}: effect {index} ({kind}): {why}")]
    BadEffect {
        /// The file.
        file: String,
        /// Counted from 1.
        index: usize,
        /// Its kind.
        kind: &'static str,
        /// What is wrong, and the fix.
        why: String,
    },
}

/// Effects as in a file: their recorded quantities are names, which are bound to columns before they act.
#[derive(Debug, Clone, PartialEq)]
pub struct SavedEffects {
    /// The nominal chain and its masses.
    pub statics: Statics,
    /// The effects.
    pub effects: Vec<Effect<Driver<String>>>,
    /// Error curves of joints, no cause claimed.
    pub curves: Vec<Curve>,
    /// A prediction averaged over everything that may act, a correction of the robot with its geometry alone.
    pub averaged: Option<Averaged>,
}

impl EffectModel {
    /// Its file form.
    pub fn saved(&self) -> SavedEffects {
        let effects = self.effects.iter().map(|effect| named(effect, &self.statics.chain)).collect();
        SavedEffects { effects, curves: self.curves.clone(), ..SavedEffects::none(self.statics.clone()) }
    }

    /// As JSON text, with the formula, units and source of each kind, too.
    pub fn to_json(&self) -> String {
        self.saved().to_json()
    }
}

impl Correction {
    /// As JSON text, with the formula, units and source of each kind, too.
    pub fn to_json(&self) -> String {
        SavedEffects { averaged: self.averaged.clone(), ..self.effects.saved() }.to_json()
    }
}

impl SavedEffects {
    /// No effects on this chain.
    pub fn none(statics: Statics) -> Self {
        Self { statics, effects: Vec::new(), curves: Vec::new(), averaged: None }
    }

    /// The effects, bound to their columns.
    ///
    /// # Errors
    /// Those of `column`, which is asked for each name.
    pub fn bound(self, column: &dyn Fn(&str) -> Result<Column, MissingColumn>) -> Result<Correction, MissingColumn> {
        let effects = self.effects.iter().map(|effect| self.bound_effect(effect, column)).collect::<Result<_, _>>()?;
        let averaged = self.averaged.as_ref().map(|averaged| averaged.bound(column));
        let Self { statics, curves, .. } = self;
        Ok(Correction { effects: EffectModel { curves, ..EffectModel::new(statics, effects) }, averaged })
    }

    /// One of the effects, bound to its columns.
    ///
    /// # Errors
    /// Those of `column`, which is asked for each name.
    pub fn bound_effect(
        &self,
        effect: &Effect<Driver<String>>,
        column: &dyn Fn(&str) -> Result<Column, MissingColumn>,
    ) -> Result<Effect, MissingColumn> {
        Ok(effect.with_driver(effect.term.driver.named_by(|name| column(name))?))
    }

    /// Those that move the tip.
    #[must_use]
    pub fn of_the_tip(&self) -> Self {
        let effects = self.effects.iter().filter(|effect| effect.term.moves_the_tip()).cloned().collect();
        Self { effects, ..self.clone() }
    }

    /// The names of all quantities that they depend on, each once.
    pub fn needed(&self) -> Vec<String> {
        let mut names: Vec<String> = Vec::new();
        for name in self.effects.iter().flat_map(|effect| effect.term.driver.columns()) {
            if !names.contains(name) {
                names.push(name.clone());
            }
        }
        names
    }

    /// The names of the optional quantities of an averaged prediction: without them it uses their means.
    pub fn may_follow(&self) -> Vec<String> {
        self.averaged.iter().flat_map(|averaged| averaged.follows().cloned()).collect()
    }

    /// As JSON text, with the formula, units and source of each kind.
    pub fn to_json(&self) -> String {
        format!("{:#}\n", self.to_value())
    }

    /// The same as a part of another file.
    pub fn to_value(&self) -> serde_json::Value {
        serde_json::to_value(self.written()).expect("names are texts and numbers are numbers")
    }

    fn written(&self) -> Saved {
        let effects = self.effects.iter().map(|effect| {
            let entry = effect.term.kind.entry();
            SavedEffect {
                effect: effect.with_driver(WrittenDriver::of(&effect.term.driver)),
                formula: entry.formula.into(),
                units: entry.units.into(),
                source: entry.source.into(),
            }
        });
        let chain = &self.statics.chain;
        Saved {
            schema: SCHEMA.into(),
            robot: chain.name().into(),
            joints: chain.joints().iter().map(|joint| joint.name.clone()).collect(),
            drawn: Some(ReferenceRobot::of(&self.statics)),
            effects: effects.collect(),
            curves: self.curves.clone(),
            averaged: self.averaged.as_ref().and_then(WrittenAveraged::of),
        }
    }

    /// From JSON text, for a robot, drawn or calibrated, whose joints have the same names in the same order.
    ///
    /// # Errors
    /// The text is of another form or for another robot, or an effect does not fit the chain.
    pub fn from_json(file: &str, text: &str, statics: &Statics) -> Result<Self, SavedError> {
        let file = || file.to_string();
        let form = |error: serde_json::Error| SavedError::Form { file: file(), why: error.to_string() };
        let any: serde_json::Value = serde_json::from_str(text).map_err(form)?;
        if let Some(found) = any["schema"].as_str().filter(|schema| *schema != SCHEMA) {
            return Err(SavedError::Schema { file: file(), found: found.into() });
        }
        Self::from_saved(&file(), serde_json::from_str(text).map_err(form)?, statics)
    }

    fn from_saved(file: &str, saved: Saved, statics: &Statics) -> Result<Self, SavedError> {
        let file = || file.to_string();
        let joints: Vec<String> = statics.chain.joints().iter().map(|joint| joint.name.clone()).collect();
        if joints != saved.joints {
            let (found, wanted) = (saved.joints.join(", "), joints.join(", "));
            return Err(SavedError::OtherJoints { file: file(), found, wanted });
        }
        let drawn = saved.drawn.as_ref().map(|drawn| drawn.statics(&file())).transpose();
        let drawn = drawn.map_err(|error| SavedError::ReferenceRobot { file: file(), why: error.to_string() })?;
        if let Some(apart) = drawn.as_ref().and_then(|drawn| apart(&drawn.chain, &statics.chain)) {
            return Err(SavedError::OtherRobot { file: file(), found: saved.robot, apart });
        }
        let statics = drawn.as_ref().unwrap_or(statics);
        let mut effects = Vec::with_capacity(saved.effects.len());
        for (index, SavedEffect { effect, .. }) in saved.effects.into_iter().enumerate() {
            let kind = effect.term.kind.name();
            let bad = |why: String| SavedError::BadEffect { file: file(), index: index + 1, kind, why };
            let highest = effect.term.carrier.joint().into_iter().chain(effect.term.driver.joints()).max();
            if highest.is_some_and(|joint| joint >= joints.len()) {
                let last = joints.len().saturating_sub(1);
                return Err(bad(format!("it names joint {}; joints are 0 to {last}", highest.unwrap_or(0))));
            }
            if let Some(why) = effect.term.driver.fault() {
                return Err(bad(why));
            }
            let Effect { term: Term { kind: of_kind, carrier, driver, coupling }, coefficients } = effect;
            let term = Term { kind: of_kind, carrier, driver: driver.named(&statics.chain), coupling };
            let effect = Effect { term, coefficients };
            let wanted = effect.term.coefficients_of(statics, effect.term.driver.len(statics));
            if effect.coefficients.len() != wanted {
                return Err(bad(format!("{} coefficients are given; give {wanted}", effect.coefficients.len())));
            }
            if let Some(value) = effect.coefficients.iter().find(|value| !value.is_finite()) {
                return Err(bad(format!("a coefficient is {value}; give a finite number")));
            }
            effects.push(effect);
        }
        for (index, curve) in saved.curves.iter().enumerate() {
            if let Some(why) = curve.fault(joints.len()) {
                return Err(SavedError::BadCurve { file: file(), index: index + 1, why });
            }
        }
        let averaged = saved.averaged.map(|written| written.averaged(&file(), statics)).transpose();
        let averaged = averaged.map_err(|why| SavedError::Form { file: file(), why })?;
        Ok(Self { statics: statics.clone(), effects, curves: saved.curves, averaged })
    }
}
