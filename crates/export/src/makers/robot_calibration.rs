//! The ROS package robot_calibration: offsets of joint origins, applied to a URDF.
//!
//! ```text
//! elbow_joint_x: 0.00012      # origin' = origin · offset, m
//! elbow_joint_a: 0.0003       # a, b, c: axis times angle of the offset's rotation, rad
//! ```
//! **Source.** github.com/mikeferguson/robot_calibration, `src/optimization/offsets.cpp`: `getOffsetYAML` writes the
//! file, `loadOffsetYAML` reads it, `updateURDF` applies it.

use super::origins::calibrated_tree;
use super::{Calibrated, Maker, MakerError, Written, without_effects};
use denavit_model::se3::{self, Pose};
use std::fmt::Write as _;

pub(super) const MAKER: Maker = Maker {
    name: "robot-calibration",
    purpose: "robot_calibration (ROS): offsets of joint origins, for loadOffsetYAML",
    render,
};

/// Changes below this, m and rad, are rounding.
const NOTHING: f64 = 1e-13;

fn render(calibrated: &Calibrated) -> Result<Written, MakerError> {
    let Some((drawn, reading)) = calibrated.drawn else {
        return Err(MakerError::NeedsTree { maker: MAKER.name });
    };
    let chain = calibrated.chain;
    let tree = calibrated_tree(drawn, chain, reading)?;
    let mut text = String::new();
    let mut left_out = without_effects(calibrated);
    for joint in &tree.joints {
        let Some(old) = drawn.joints.iter().find(|old| old.name == joint.name) else {
            left_out.push(format!("joint \"{}\" is new: the form has no place for it", joint.name));
            continue;
        };
        let offset: Pose = old.origin.pose().inverse() * joint.origin.pose();
        let twist = se3::log(&offset);
        let place = offset.translation.vector;
        let numbers = [place.x, place.y, place.z, twist[0], twist[1], twist[2]];
        if numbers.iter().all(|number| number.abs() < NOTHING) {
            continue;
        }
        for (end, number) in ["x", "y", "z", "a", "b", "c"].iter().zip(numbers) {
            let _ = writeln!(text, "{}_{end}: {:?}", joint.name, number + 0.0);
        }
    }
    Ok(Written { text, left_out })
}
