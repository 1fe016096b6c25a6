//! Commands for a list of poses in the order in which the robot takes them.

use super::{Allowed, Command, Wanted, compensate};
use denavit_identify::effects::approach::LEAST_MOVE;
use denavit_identify::effects::driver::{Conditions, TIME};
use denavit_identify::effects::history::{History, Move};
use denavit_identify::effects::{SavedEffects, recorded};
use denavit_ik::Solver;
use denavit_measurements::covariates::PAYLOAD;
use denavit_measurements::poses::Poses;
use denavit_measurements::{Covariate, Covariates, MissingColumn};
use denavit_model::Chain;

/// One command per pose. A search starts at the row's joint values, else where the last one ended. Sides of approach, windup of joints
/// and their warming since the first command follow from the order of the nominal commands unless they are given; warming uses the
/// column `time` of the poses, if there is one.
///
/// # Errors
/// An effect that moves the tip follows a quantity that is neither a column of the poses nor given.
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
    let solver = Solver::new(nominal);
    let mut before: Option<Vec<f64>> = None;
    let effects = effects.of_the_tip();
    let (recorded, open) = followed(&effects, nominal, poses, given);
    let rows = poses.lines.len();
    let column = |name: &str| recorded.column("the poses", rows, name);
    let model = effects.bound(&column)?;
    let open = open.into_iter().map(|(name, joint, history)| Ok((column(&name)?, joint, history)));
    let open = open.collect::<Result<Vec<_>, MissingColumn>>()?;
    let mut states = vec![0.0; open.len()];
    let times = poses.covariates.iter().find(|column| column.name == TIME).map(|column| &column.values);
    let mut commands = Vec::with_capacity(rows);
    for row in 0..rows {
        let start = poses.joints.get(row).unwrap_or(&near);
        let wanted = match poses.poses.get(row) {
            Some(pose) => Wanted::Pose(*pose),
            None => Wanted::Joints(start.clone()),
        };
        let seconds = times.filter(|_| row > 0).map(|times| times[row] - times[row - 1]);
        let step = |from: f64, to: f64| Move { moved: to - from, still: LEAST_MOVE, seconds };
        let actual = |q: &[f64]| {
            let conditions = |recorded: &Covariates| {
                model.fk(calibrated, &Conditions { reading: q, recorded: recorded.row(row), tip: 0 })
            };
            if open.is_empty() {
                return conditions(&recorded);
            }
            let mut with_sides = recorded.clone();
            for ((column, joint, history), state) in open.iter().zip(&states) {
                let now = before.as_ref().map_or(0.0, |before| history.after(step(before[*joint], q[*joint]), *state));
                with_sides.set(column, || now);
            }
            conditions(&with_sides)
        };
        let mut command = compensate(&solver, calibrated, &actual, &wanted, start);
        // The first pose has nothing to keep.
        command.keeps_configuration |= before.is_none() && poses.joints.is_empty();
        if allowed.reached_by(&command) {
            near.clone_from(&command.nominal);
        }
        if let Some(before) = &before {
            for ((_, joint, history), state) in open.iter().zip(&mut states) {
                *state = history.after(step(before[*joint], command.nominal[*joint]), *state);
            }
        }
        before = Some(command.nominal.clone());
        commands.push(command);
    }
    Ok(commands)
}

/// The quantities that effects follow, pose by pose: from a column of the poses, else as given for all of them. Quantities that follow
/// from the order and are neither are at 0; each of these with its coordinate.
fn followed(
    effects: &SavedEffects,
    chain: &Chain,
    poses: &Poses,
    given: &[(String, f64)],
) -> (Covariates, Vec<(String, usize, History)>) {
    let rows = poses.lines.len();
    let (mut recorded, mut open) = (Covariates::none(), Vec::new());
    for name in effects.needed().into_iter().chain([PAYLOAD.to_owned()]) {
        let plain = recorded::plain(&name);
        let column = poses.covariates.iter().find(|column| column.name == plain).map(|column| column.values.clone());
        let side = || {
            let (joint, history) = History::of_column(&plain)?;
            // Without a clock the value is unknown: the column is missing.
            if history.needs_a_clock() && !poses.covariates.iter().any(|column| column.name == TIME) {
                return None;
            }
            let index = chain.coordinates().iter().position(|coordinate| coordinate.name == joint)?;
            open.push((name.clone(), index, history));
            Some(vec![0.0; rows])
        };
        let values = column.or_else(|| Some(vec![recorded::given(given, &plain)?; rows])).or_else(side);
        if let Some(values) = values {
            recorded.push(Covariate { name, values });
        }
    }
    (recorded, open)
}
