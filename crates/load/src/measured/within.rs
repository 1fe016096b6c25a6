//! What a robot and a plan must be within.

use super::MeasuredError;
use denavit_identify::proportion::within_proportion;
use denavit_model::Chain;
use denavit_model::nalgebra::Point3;

/// Refuses a chain that nothing can be measured of: without joints, or larger than any robot.
///
/// # Errors
/// The chain is such a one; `file` is what messages call the robot.
pub fn moving(file: &str, chain: &Chain) -> Result<(), MeasuredError> {
    if chain.joints().is_empty() {
        let (base, tip) = (chain.base(), chain.tip());
        return Err(MeasuredError::Option(format!(
            "{file}: nothing moves between \"{base}\" and \"{tip}\"; choose ‹base› and ‹tip›"
        )));
    }
    Ok(within_proportion(chain)?)
}

/// Lowest and highest corner of a box X0, X1, Y0, Y1, Z0, Z1 in m; `None` where nothing is written.
///
/// # Errors
/// Not six finite numbers, the lower of each pair first.
pub fn corners(written: &[f64]) -> Result<Option<[Point3<f64>; 2]>, MeasuredError> {
    let [x0, x1, y0, y1, z0, z1] = match *written {
        [] => return Ok(None),
        [x0, x1, y0, y1, z0, z1] => [x0, x1, y0, y1, z0, z1],
        _ => {
            let message = format!("‹box›: {} numbers; write six, X0,X1,Y0,Y1,Z0,Z1", written.len());
            return Err(MeasuredError::Option(message));
        }
    };
    for (axis, low, high) in [("X", x0, x1), ("Y", y0, y1), ("Z", z0, z1)] {
        let ordered = low < high;
        if !ordered {
            let message = format!("‹box›: {axis}0 = {low} is not below {axis}1 = {high}; the box is empty");
            return Err(MeasuredError::Option(message));
        }
        if !low.is_finite() || !high.is_finite() {
            return Err(MeasuredError::Option(format!(
                "‹box›: {axis}0 = {low}, {axis}1 = {high}; write finite numbers in m"
            )));
        }
    }
    Ok(Some([Point3::new(x0, y0, z0), Point3::new(x1, y1, z1)]))
}
