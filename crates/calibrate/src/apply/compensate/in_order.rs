//! Commands for a list of poses in the order in which the robot takes them.

use super::{Allowed, Command, Wanted, compensate};
use crate::effects::approach::{LEAST_MOVE, side_after};
use crate::effects::driver::{APPROACH, Conditions};
use crate::effects::{EffectModel, recorded};
use crate::observation::measurements::poses::Poses;
use denavit_model::Chain;

/// One command per pose. A search starts at the row's joint values, else where the last one ended; sides of approach
/// that nobody gives are those that the nominal commands have in this order.
pub fn in_order(
    nominal: &Chain,
    calibrated: &Chain,
    model: &EffectModel,
    poses: &Poses,
    given: &[(String, f64)],
    allowed: Allowed,
) -> Vec<Command> {
    let middle = |coordinate: &denavit_model::Coordinate| {
        let (lower, upper) = coordinate.range();
        0.0f64.clamp(lower, upper)
    };
    let mut near: Vec<f64> = nominal.coordinates().iter().map(middle).collect();
    let mut before: Option<Vec<f64>> = None;
    let mut sides = vec![0.0; near.len()];
    let mut commands = Vec::with_capacity(poses.lines.len());
    for row in 0..poses.lines.len() {
        let start = poses.joints.get(row).unwrap_or(&near);
        let wanted = match poses.poses.get(row) {
            Some(pose) => Wanted::Pose(*pose),
            None => Wanted::Joints(start.clone()),
        };
        let column = |name: &str| {
            let column = poses.covariates.iter().find(|column| column.name == name);
            column.map(|column| column.values[row])
        };
        let actual = |q: &[f64]| {
            let recorded = |name: &str| {
                let name = recorded::plain(name);
                let side = || side(&name, nominal, before.as_deref(), &sides, q);
                column(&name).or_else(|| recorded::given(given, &name)).or_else(side)
            };
            model.fk(calibrated, &Conditions { reading: q, covariate: &recorded })
        };
        let mut command = compensate(nominal, calibrated, &actual, &wanted, start);
        // The first pose has nothing to keep.
        command.keeps_configuration |= before.is_none() && poses.joints.is_empty();
        if allowed.reached_by(&command) {
            near.clone_from(&command.nominal);
        }
        if let Some(before) = &before {
            for (index, side) in sides.iter_mut().enumerate() {
                *side = side_after(command.nominal[index] - before[index], LEAST_MOVE, *side);
            }
        }
        before = Some(command.nominal.clone());
        commands.push(command);
    }
    commands
}

/// The side from which a joint comes to `q` from the command before, for the name of a column of sides; 0 where nothing was
/// before.
fn side(name: &str, chain: &Chain, before: Option<&[f64]>, sides: &[f64], q: &[f64]) -> Option<f64> {
    let joint = name.strip_suffix(APPROACH)?;
    let index = chain.coordinates().iter().position(|coordinate| coordinate.name == joint)?;
    Some(before.map_or(0.0, |before| side_after(q[index] - before[index], LEAST_MOVE, sides[index])))
}
