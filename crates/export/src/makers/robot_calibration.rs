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
use crate::kinematics_yaml::KinematicsFileError;
use crate::urdf::text::Numbers;
use denavit_model::Quantity;
use denavit_model::nalgebra::{Vector3, Vector6};
use denavit_model::robot::Robot;
use denavit_model::se3::{self, Pose};
use std::fmt::Write as _;

pub(super) const MAKER: Maker = Maker {
    name: "robot-calibration",
    purpose: "robot_calibration (ROS): offsets of joint origins, for loadOffsetYAML",
    render,
};

/// Place, and axis times angle.
const ENDS: [&str; 6] = ["x", "y", "z", "a", "b", "c"];

/// The origins of a robot's joints with the offsets of the file.
pub(super) fn read(scalars: &yaml::Scalars, robot: &Robot) -> Result<Vec<(usize, Numbers)>, KinematicsFileError> {
    let mut found = Vec::new();
    for (index, joint) in robot.joints.iter().enumerate() {
        let mut six = [0.0; 6];
        let mut is_named = false;
        for (at, end) in ENDS.iter().enumerate() {
            let quantity = if at < 3 { Quantity::Length } else { Quantity::Angle };
            if let Some(number) = scalars.number(&[&format!("{}_{end}", joint.name)], quantity)? {
                is_named = true;
                six[at] = number;
            }
        }
        if is_named {
            let [x, y, z, a, b, c] = six;
            let rotation = se3::exp(&Vector6::new(a, b, c, 0.0, 0.0, 0.0)).rotation;
            let offset = se3::pose(rotation, Vector3::new(x, y, z));
            found.push((index, Numbers::of(&(joint.origin.pose() * offset), 0.0)));
        }
    }
    Ok(found)
}

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
        for (end, number) in ENDS.iter().zip(numbers) {
            let _ = writeln!(text, "{}: {:?}", yaml::key(&format!("{}_{end}", new.name)), number + 0.0);
        }
    }
    Ok(Written { text, left_out })
}
