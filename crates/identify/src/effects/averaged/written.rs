//! The file form of an averaged prediction.

use crate::arm::Arm;
use crate::effects::averaged::{Averaged, Known, KnownTip, Spread};
use crate::effects::curve::Curve;
use crate::effects::driver::{Driver, Statics};
use crate::effects::model::{Effect, EffectModel, Term};
use crate::effects::reference_robot::ReferenceRobot;
use crate::effects::written::WrittenDriver;
use denavit_measurements::Scene;
use denavit_model::nalgebra::{DMatrix, Vector3, Vector6};
use denavit_model::{Pose, se3};
use serde::{Deserialize, Serialize};

/// Means, covariance and further data; m, rad.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct WrittenAveraged {
    /// The robot with its geometry alone, which this corrects.
    geometric: ReferenceRobot,
    /// Everything that acts on the drawn robot, at its mean.
    effects: Vec<Effect<WrittenDriver>>,
    curves: Vec<Curve>,
    /// For each effect its driver's values where they are not recorded.
    averages: Vec<Vec<f64>>,
    /// Twists `[omega; v]` of the averaged robot's base and tip relative to the geometric one's.
    base: [f64; 6],
    tip: [f64; 6],
    target: [f64; 3],
    /// Twist of the instrument's frame, instrument_from_base, where there is one.
    instrument: Option<[f64; 6]>,
    /// Of all numbers: coefficients of the effects one after another, then waves.
    spread: WrittenSpread,
    /// Of the geometry numbers, for geometry alone.
    geometric_spread: WrittenSpread,
    /// Twists of the drawn robot's base and tip relative to the geometric one's, both placed by the rows.
    drawn_base: [f64; 6],
    drawn_tip: [f64; 6],
    drawn_variance_m2: f64,
    curve_variance: f64,
    geometric_variance_m2: f64,
    geometric_variance_among_rows_m2: f64,
    across: f64,
    calibrated: f64,
    noise_m2: f64,
    /// Lowest and highest reading of each coordinate among the fitted rows.
    ranges: Vec<(f64, f64)>,
}

/// Some numbers' covariance: row k holds those of number k with the ones before it and itself. After the numbers come the instrument's frame,
/// where there is one, and the target's position.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct WrittenSpread {
    kept: Vec<usize>,
    covariance: Vec<Vec<f64>>,
}

impl WrittenSpread {
    fn of(spread: &Spread) -> Self {
        let row = |row: usize| (0..=row).map(|column| spread.covariance[(row, column)]).collect();
        Self { kept: spread.kept.clone(), covariance: (0..spread.covariance.nrows()).map(row).collect() }
    }

    /// The covariance, if it matches this number of parameters.
    fn spread(self, numbers: usize, beside: usize) -> Option<Spread> {
        let size = self.kept.len() + beside;
        let rows = &self.covariance;
        let triangle = rows.len() == size && rows.iter().enumerate().all(|(k, row)| row.len() == k + 1);
        let good = triangle
            && self.kept.iter().all(|&number| number < numbers)
            && rows.iter().flatten().all(|cell| cell.is_finite());
        let covariance = || DMatrix::from_fn(size, size, |i, k| rows[i.max(k)][i.min(k)]);
        good.then(|| Spread { covariance: covariance(), kept: self.kept.clone() })
    }
}

fn twist(pose: &Pose) -> [f64; 6] {
    se3::log(pose).into()
}

impl WrittenAveraged {
    /// The file form; none for several tips: a file is for one tip, see [`Correction::to_tip`](crate::effects::Correction::to_tip).
    pub fn of(averaged: &Averaged) -> Option<Self> {
        let (known, mean) = (&averaged.known, averaged.mean());
        let [tip] = &known.tips[..] else { return None };
        let effect = |effect: &Effect<Driver<String>>| effect.with_driver(WrittenDriver::of(&effect.term.driver));
        let mut statics = mean.statics.clone();
        statics.chain = known.geometric.chain();
        Some(Self {
            geometric: ReferenceRobot::of(&statics),
            effects: averaged.effects.iter().map(effect).collect(),
            curves: mean.curves.clone(),
            averages: averaged.averages.clone(),
            base: twist(&known.base),
            tip: twist(&tip.averaged),
            target: tip.target.into(),
            instrument: known.instrument.as_ref().map(twist),
            spread: WrittenSpread::of(&known.spread),
            geometric_spread: WrittenSpread::of(&known.geometric_spread),
            drawn_base: twist(&known.drawn_base),
            drawn_tip: twist(&tip.drawn),
            drawn_variance_m2: known.of_drawing,
            curve_variance: known.of_curves,
            geometric_variance_m2: known.of_geometry,
            geometric_variance_among_rows_m2: known.geometry_among_rows,
            across: known.across,
            calibrated: known.calibrated,
            noise_m2: known.noise,
            ranges: known.ranges.clone(),
        })
    }

    /// The prediction, with no columns bound yet.
    ///
    /// # Errors
    /// What does not match the robot, as text.
    pub fn averaged(self, file: &str, statics: &Statics) -> Result<Averaged, String> {
        let geometric = self.geometric.statics(file).map_err(|error| format!("averaged: {error}"))?.chain;
        let joints = statics.chain.joints().len();
        if geometric.joints().len() != joints {
            return Err("averaged: its geometric robot has other joints".into());
        }
        let mut effects = Vec::with_capacity(self.effects.len());
        for (index, Effect { term, coefficients }) in self.effects.into_iter().enumerate() {
            let bad = |why: &str| Err(format!("averaged: effect {}: {why}", index + 1));
            let Term { kind, carrier, driver, coupling } = term;
            if carrier.joint().into_iter().chain(driver.joints()).any(|joint| joint >= joints) {
                return bad("it names an unknown joint");
            }
            if driver.fault().is_some() {
                return bad("a number of its driver is out of range");
            }
            let term = Term { kind, carrier, driver: driver.named(&statics.chain), coupling };
            if coefficients.len() != term.coefficients_of(statics, term.driver.len(statics)) {
                return bad("it has the wrong number of coefficients");
            }
            if self.averages.get(index).is_none_or(|averages| averages.len() != term.driver.len(statics)) {
                return bad("its averages do not match its driver");
            }
            effects.push(Effect { term, coefficients });
        }
        let numbers = effects.iter().map(|effect| effect.coefficients.len()).sum::<usize>()
            + self.curves.iter().map(|curve| curve.waves.len()).sum::<usize>();
        let beside = if self.instrument.is_some() { 9 } else { 3 };
        let fits = || "averaged: covariance, kept numbers and ranges do not match the effects and the robot".to_owned();
        if self.ranges.len() != statics.chain.coordinates().len() {
            return Err(fits());
        }
        let spread = self.spread.spread(numbers, beside).ok_or_else(fits)?;
        let geometric_spread = self.geometric_spread.spread(numbers, beside).ok_or_else(fits)?;
        let twists = [&self.base, &self.tip, &self.drawn_base, &self.drawn_tip];
        let all = effects.iter().flat_map(|effect| &effect.coefficients).chain(twists.into_iter().flatten());
        let all = all
            .chain(self.curves.iter().flat_map(|curve| &curve.weights))
            .chain(&self.target)
            .chain(self.instrument.iter().flatten());
        let variances = [&self.curve_variance, &self.geometric_variance_m2, &self.noise_m2, &self.drawn_variance_m2];
        let variances =
            variances.into_iter().chain([&self.geometric_variance_among_rows_m2, &self.across, &self.calibrated]);
        if !all.chain(variances).all(|number| number.is_finite()) {
            return Err("averaged: a number is not finite".into());
        }
        let arm = |chain| Arm::new(chain, &Scene::default());
        let known = Known {
            drawn: arm(&statics.chain),
            geometric: Arm { joints: geometric.joints().to_vec(), ..arm(&statics.chain) },
            base: se3::exp(&Vector6::from(self.base)),
            tips: vec![KnownTip {
                averaged: se3::exp(&Vector6::from(self.tip)),
                drawn: se3::exp(&Vector6::from(self.drawn_tip)),
                target: Vector3::from(self.target),
            }],
            instrument: self.instrument.map(|twist| se3::exp(&Vector6::from(twist))),
            spread,
            geometric_spread,
            drawn_base: se3::exp(&Vector6::from(self.drawn_base)),
            of_drawing: self.drawn_variance_m2,
            of_curves: self.curve_variance,
            of_geometry: self.geometric_variance_m2,
            geometry_among_rows: self.geometric_variance_among_rows_m2,
            across: self.across,
            calibrated: self.calibrated,
            noise: self.noise_m2,
            ranges: self.ranges,
        };
        let unbound = EffectModel { curves: self.curves, ..EffectModel::new(statics.clone(), Vec::new()) };
        Ok(Averaged::unbound(unbound, effects, self.averages, known))
    }
}
