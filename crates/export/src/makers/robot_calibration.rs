//! The ROS package robot_calibration: offsets of joint origins, applied to a URDF.
//!
//! ```text
//! elbow_joint_x: 0.00012      # origin' = origin · offset, m
//! elbow_joint_a: 0.0003       # a, b, c: axis times angle of the offset's rotation, rad
//! ```
//! **Source.** github.com/mikeferguson/robot_calibration, `src/optimization/offsets.cpp`: `getOffsetYAML` writes the
//! file, `loadOffsetYAML` reads it, `updateURDF` applies it.

use super::origins::{Changes, NOTHING};
use super::{Calibrated, Maker, MakerError, Written, yaml};
use denavit_model::se3::{self, Pose};
use std::fmt::Write as _;

pub(super) const MAKER: Maker = Maker {
    name: "robot-calibration",
    purpose: "robot_calibration (ROS): offsets of joint origins, for loadOffsetYAML",
    render,
};

fn render(calibrated: &Calibrated) -> Result<Written, MakerError> {
    let Changes { joints, left_out } = Changes::of(calibrated, MAKER.name)?;
    let mut text = String::new();
    for (old, new) in &joints {
        let offset: Pose = old.origin.pose().inverse() * new.origin.pose();
        let twist = se3::log(&offset);
        let place = offset.translation.vector;
        let numbers = [place.x, place.y, place.z, twist[0], twist[1], twist[2]];
        if numbers.iter().all(|number| number.abs() < NOTHING) {
            continue;
        }
        for (end, number) in ["x", "y", "z", "a", "b", "c"].iter().zip(numbers) {
            let _ = writeln!(text, "{}: {:?}", yaml::key(&format!("{}_{end}", new.name)), number + 0.0);
        }
    }
    Ok(Written { text, left_out })
}
