//! Joint values that reach a pose of the tip: moves the robot when its tip is dragged.

use crate::answers::words;
use crate::question::Reach;
use denavit_ik::Solver;
use denavit_model::nalgebra::{Matrix3, Rotation3, Vector3};
use denavit_model::{Pose, se3};
use serde_json::{Value, json};

/// A rotation's columns may be this far from orthonormal: products of rotations on a page have rounding errors only.
const NOT_A_ROTATION: f64 = 1e-6;

/// All solutions as `denavit ik` finds them, nearest to `near` first and those outside of limits last; where none reaches the pose
/// `reached` is false, and the one solution is the nearest that was found.
///
/// # Errors
/// The chain has no joints, a number is missing or not finite, or the pose is invalid.
pub fn reached(asked: &Reach) -> Result<Value, String> {
    let chain = asked.source.load()?.chain(&asked.source.selection()).map_err(words)?.value;
    let wanted = chain.coordinates().len();
    if wanted == 0 {
        return Err(format!(
            "nothing moves between \"{}\" and \"{}\"; choose another chain",
            chain.base(),
            chain.tip()
        ));
    }
    if asked.near.len() != wanted || !asked.near.iter().all(|value| value.is_finite()) {
        return Err(format!("{wanted} finite joint values are wanted"));
    }
    let target = pose(&asked.pose)?;
    let solver = Solver::new(&chain);
    let found = solver.solve(&target, &asked.near);
    let solutions = found.iter().map(|(joints, found)| {
        json!({
            "joints": joints,
            "branch": found.branch.map(|branch| branch.to_string()),
            "within_limits": found.within_limits,
            "position_error_m": found.position_error,
            "orientation_error_rad": found.orientation_error,
        })
    });
    Ok(json!({
        "method": solver.method().to_string(),
        "reached": found.reached(),
        "solutions": solutions.collect::<Vec<_>>(),
    }))
}

/// base_from_tip of 16 numbers, column by column.
fn pose(numbers: &[f64; 16]) -> Result<Pose, String> {
    let column = |at: usize| Vector3::new(numbers[4 * at], numbers[4 * at + 1], numbers[4 * at + 2]);
    let rotation = Matrix3::from_columns(&[column(0), column(1), column(2)]);
    let bent = (rotation.transpose() * rotation - Matrix3::identity()).amax();
    let last_row_is_plain = (0..4).all(|at| numbers[4 * at + 3] == if at == 3 { 1.0 } else { 0.0 });
    let finite = numbers.iter().all(|number| number.is_finite());
    if !finite || bent > NOT_A_ROTATION || rotation.determinant() < 0.0 || !last_row_is_plain {
        return Err("16 numbers of a pose are wanted, column by column".into());
    }
    Ok(se3::pose(se3::orthonormalised(&Rotation3::from_matrix_unchecked(rotation)), column(3)))
}
