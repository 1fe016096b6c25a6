//! Commands for a list of poses in the order in which the robot takes them.

use super::{Allowed, Command, Wanted, compensate};
use crate::effects::approach::{LEAST_MOVE, side_after};
use crate::effects::driver::{APPROACH, Conditions};
use crate::effects::{SavedEffects, recorded};
use crate::observation::measurements::covariates::PAYLOAD;
use crate::observation::measurements::poses::Poses;
use crate::observation::measurements::{Covariate, Covariates, MissingColumn};
use denavit_model::Chain;

/// One command per pose. A search starts at the row's joint values, else where the last one ended; sides of approach
/// that nobody gives are those that the nominal commands have in this order.
///
/// # Errors
/// An effect with a part in where the tip is follows what is neither a column of the poses nor given.
pub fn in_order(
    nominal: &Chain,
    calibrated: &Chain,
    effects: &SavedEffects,
    poses: &Poses,
    given: &[(String, f64)],
    allowed: Allowed,
) -> Result<Vec<Command>, MissingColumn> {
    let middle = |coordinate: &denavit_model::Coordinate| {
        let (lower, upper) = coordinate.range();
        0.0f64.clamp(lower, upper)
    };
    let mut near: Vec<f64> = nominal.coordinates().iter().map(middle).collect();
    let mut before: Option<Vec<f64>> = None;
    let mut sides = vec![0.0; near.len()];
    let effects = effects.of_the_tip();
    let (recorded, open) = followed(&effects, nominal, poses, given);
    let rows = poses.lines.len();
    let column = |name: &str| recorded.column("the poses", rows, name);
    let model = effects.bound(&column)?;
    let open = open.into_iter().map(|(name, joint)| Ok((column(&name)?, joint))).collect::<Result<Vec<_>, _>>()?;
    let mut commands = Vec::with_capacity(rows);
    for row in 0..rows {
        let start = poses.joints.get(row).unwrap_or(&near);
        let wanted = match poses.poses.get(row) {
            Some(pose) => Wanted::Pose(*pose),
            None => Wanted::Joints(start.clone()),
        };
        let actual = |q: &[f64]| {
            let conditions = |recorded: &Covariates| {
                model.fk(calibrated, &Conditions { reading: q, recorded: recorded.row(row), tip: 0 })
            };
            if open.is_empty() {
                return conditions(&recorded);
            }
            let mut with_sides = recorded.clone();
            for (column, joint) in &open {
                let side = before
                    .as_ref()
                    .map_or(0.0, |before| side_after(q[*joint] - before[*joint], LEAST_MOVE, sides[*joint]));
                with_sides.set(column, || side);
            }
            conditions(&with_sides)
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
    Ok(commands)
}

/// What the effects follow, pose by pose: as a column of the poses, else as given for all of them. The sides of approach that
/// are neither stand at 0; each of these with its coordinate.
fn followed(
    effects: &SavedEffects,
    chain: &Chain,
    poses: &Poses,
    given: &[(String, f64)],
) -> (Covariates, Vec<(String, usize)>) {
    let rows = poses.lines.len();
    let (mut recorded, mut open) = (Covariates::none(), Vec::new());
    for name in effects.needed().into_iter().chain([PAYLOAD.to_owned()]) {
        let plain = recorded::plain(&name);
        let column = poses.covariates.iter().find(|column| column.name == plain).map(|column| column.values.clone());
        let side = || {
            let joint = plain.strip_suffix(APPROACH)?;
            let index = chain.coordinates().iter().position(|coordinate| coordinate.name == joint)?;
            open.push((name.clone(), index));
            Some(vec![0.0; rows])
        };
        let values = column.or_else(|| Some(vec![recorded::given(given, &plain)?; rows])).or_else(side);
        if let Some(values) = values {
            recorded.push(Covariate { name, values });
        }
    }
    (recorded, open)
}
