//! An instrument or a target that was moved before the test rows were measured: their error is then a motion, not that of the robot.

use denavit_identify::arm::Arm;
use denavit_identify::parameters::{Freedom, Layout, NoEffects, Tolerances};
use denavit_identify::residual_statistics::{Residual, placed, residuals};
use denavit_identify::solve::{Fit, FitOptions, fit};
use denavit_measurements::Measurements;
use denavit_model::Pose;
use denavit_model::nalgebra::{Point3, UnitQuaternion, Vector3};
use serde::Serialize;

/// The test rows' error must be this many times that of the fitted rows, and improve by this factor.
const ORDER: f64 = 10.0;
/// And then be as small as that of the fitted rows, within this factor.
const AS_GOOD: f64 = 3.0;
/// Below this share of the robot's size an error is an effect.
const SUSPICIOUS: f64 = 5e-4;
/// Numbers beyond those that place everything.
const SPARE: usize = 12;
/// A motion below this share of the largest one is not listed.
const STOOD: f64 = 0.1;

/// Moved instruments, targets and points, estimated from the test rows.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PlacedAnew {
    /// What moved, the farthest first.
    pub moved: Vec<Moved>,
    /// Median error of the test rows without the motions, m.
    pub before_m: f64,
    /// Median error of the test rows with the motions, m.
    pub after_m: f64,
    /// For each setup of the test rows instrument_from_instrument, for each target target_from_target, and the change of each point.
    #[serde(skip)]
    frames: (Vec<Pose>, Vec<Pose>, Vec<Vector3<f64>>),
}

/// One thing that moved.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Moved {
    /// `instrument`, `target`, or what a point is called.
    pub what: String,
    /// By how much at the place where it is seen, m.
    pub by_m: f64,
    /// And turned, rad.
    pub by_rad: f64,
}

impl PlacedAnew {
    /// Motions of the fitted arm's surroundings before the test rows; `None` if there are none, or the rows do not determine them.
    pub(super) fn find(fitted: &Fit<NoEffects>, train: &Measurements, test: &Measurements) -> Option<Self> {
        let arm = placed(fitted, train, test).ok()?;
        if test.values() < super::diagnosis::needed_to_place(&test.scene) + SPARE {
            return None;
        }
        let usual = median(&residuals(&fitted.arm, &NoEffects, train));
        let before = median(&residuals(&arm, &NoEffects, test));
        if !(before > ORDER * usual && before > SUSPICIOUS * arm.nominal.size()) {
            return None;
        }
        let joints = arm.joints.len();
        let layout =
            Layout::new(&arm.nominal, &test.scene, &Freedom::placement(joints), &Tolerances::default(), Vec::new());
        let weights = vec![1.0; test.observations()];
        let anew = fit(test, &layout, &arm, &NoEffects, &weights, &FitOptions::default()).arm;
        let after = median(&residuals(&anew, &NoEffects, test));
        if !(after * ORDER < before && after < AS_GOOD * usual.max(1e-9 * arm.nominal.size())) {
            return None;
        }
        let frames = (
            anew.instruments.iter().zip(&arm.instruments).map(|(new, old)| new * old.inverse()).collect(),
            anew.targets.iter().zip(&arm.targets).map(|(new, old)| old.inverse() * new).collect(),
            anew.points.iter().zip(&arm.points).map(|(new, old)| new - old).collect(),
        );
        let mut found = Self { moved: Vec::new(), before_m: before, after_m: after, frames };
        found.moved = found.named(&arm, test);
        Some(found)
    }

    /// The arm with the surroundings of the test rows.
    pub(super) fn apply(&self, arm: &mut Arm) {
        let (instruments, targets, points) = &self.frames;
        arm.instruments.iter_mut().zip(instruments).for_each(|(frame, change)| *frame = change * *frame);
        arm.targets.iter_mut().zip(targets).for_each(|(frame, change)| *frame *= change);
        arm.points.iter_mut().zip(points).for_each(|(point, change)| *point += change);
    }

    fn named(&self, arm: &Arm, test: &Measurements) -> Vec<Moved> {
        let (instruments, targets, points) = &self.frames;
        let scene = &test.scene;
        let called = |what: &str, name: &str| if name.is_empty() { what.to_owned() } else { format!("{what} {name}") };
        let angle = |pose: &Pose| UnitQuaternion::from_rotation_matrix(&pose.rotation).angle();
        let mut moved = Vec::new();
        for (setup, change) in instruments.iter().enumerate() {
            let rows = (0..test.observations()).filter(|&at| test.series_of(at).setup == setup);
            let seen: Vec<Vector3<f64>> =
                rows.filter_map(|at| test.series_of(at).kind.position(test.observed.values(at))).collect();
            let middle = Point3::from(seen.iter().sum::<Vector3<f64>>() / seen.len().max(1) as f64);
            let by_m = (change * middle - middle).norm();
            moved.push(Moved { what: called("instrument", &scene.setups[setup]), by_m, by_rad: angle(change) });
        }
        for (target, change) in targets.iter().enumerate() {
            let by_rad = if scene.turns(target) { angle(change) } else { 0.0 };
            let by_m = change.translation.vector.norm();
            moved.push(Moved { what: called("target", &scene.targets[target]), by_m, by_rad });
        }
        for (name, change) in scene.points.iter().zip(points) {
            moved.push(Moved { what: name.clone(), by_m: change.norm(), by_rad: 0.0 });
        }
        let size = |moved: &Moved| moved.by_m + moved.by_rad * arm.nominal.size();
        moved.sort_by(|a, b| size(b).total_cmp(&size(a)));
        let most = moved.first().map_or(0.0, size);
        moved.retain(|moved| size(moved) > STOOD * most);
        moved
    }

    /// In words.
    pub fn said(&self) -> String {
        let part = |moved: &Moved| {
            let turned =
                if moved.by_rad > 1e-4 { format!(" and {:.2}°", moved.by_rad.to_degrees()) } else { String::new() };
            format!("{} (by {:.2} mm{turned})", moved.what, moved.by_m * 1e3)
        };
        let parts: Vec<String> = self.moved.iter().map(part).collect();
        format!(
            "the test rows are evaluated as if this had been moved before them: {}; their error is then {:.3} mm instead of {:.3} mm \
             (medians). If nothing was moved, the robot has changed",
            parts.join(", "),
            self.after_m * 1e3,
            self.before_m * 1e3
        )
    }
}

fn median(residuals: &[Residual]) -> f64 {
    let mut sizes: Vec<f64> = residuals.iter().map(Residual::distance).collect();
    let middle = sizes.len() / 2;
    if sizes.is_empty() { 0.0 } else { *sizes.select_nth_unstable_by(middle, f64::total_cmp).1 }
}
