//! PAL: `master_calibration.yaml`, corrections of the joint origins of a URDF.
//!
//! ```text
//! robot_state_publisher:
//!   geometric_calibration:
//!     arm_right_3_dx: 0.0004         # added to x, y, z of the origin of arm_right_3_joint, m
//!     arm_right_3_droll: 0.0051      # added to its roll, pitch, yaw as the URDF writes them, rad
//! ```
//! **Source.** github.com/thanhndv212/figaroh-plus, `src/figaroh/tools/geometric_calibration_export.py`, which writes the file, and
//! figaroh-examples, `examples/tiago_pro/data/master_calibration_20260805.yaml`, written for a robot of PAL. PAL publishes nothing
//! itself: that the numbers are added to the origins is stated by that project.

use super::origins::{Changes, NOTHING};
use super::{Calibrated, KEYS, Maker, MakerError, Written, yaml};
use crate::kinematics_yaml::KinematicsFileError;
use crate::urdf::text::Numbers;
use denavit_model::Quantity;
use denavit_model::robot::{Joint, Robot};
use std::f64::consts::{PI, TAU};
use std::fmt::Write as _;

pub(super) const MAKER: Maker = Maker {
    name: "pal",
    purpose: "PAL (TIAGo, TALOS): /etc/calibration/master_calibration.yaml, as FIGAROH writes it",
    render,
};

/// The suffix of a joint's name that the keys omit.
const END: &str = "_joint";

/// The keys above the numbers.
pub(super) const BELOW: &str = "geometric_calibration";

/// The origins of a robot's joints with what the file adds to them.
pub(super) fn read(
    scalars: &yaml::Scalars,
    above: &[String],
    robot: &Robot,
) -> Result<Vec<(usize, Numbers)>, KinematicsFileError> {
    let mut found = Vec::new();
    for (index, joint) in robot.joints.iter().enumerate() {
        let mut numbers = Numbers { xyz: joint.origin.xyz, rpy: joint.origin.rpy };
        let mut is_named = false;
        for name in [joint.name.as_str()].into_iter().chain(joint.name.strip_suffix(END)) {
            for (at, key) in KEYS.iter().enumerate() {
                let key = format!("{name}_d{key}");
                let path: Vec<&str> = above.iter().map(String::as_str).chain([BELOW, &key]).collect();
                let quantity = if at < 3 { Quantity::Length } else { Quantity::Angle };
                if let Some(added) = scalars.number(&path, quantity)? {
                    is_named = true;
                    if at < 3 { numbers.xyz[at] += added } else { numbers.rpy[at - 3] += added }
                }
            }
        }
        if is_named {
            found.push((index, numbers));
        }
    }
    Ok(found)
}

fn render(calibrated: &Calibrated) -> Result<Written, MakerError> {
    let Changes { joints, left_out } = Changes::of(calibrated, MAKER.name)?;
    let mut lines = String::new();
    for (old, new) in &joints {
        let other = |short: &str| joints.iter().any(|(other, _)| other.name == short);
        let short = new.name.strip_suffix(END).filter(|short| !other(short));
        for (key, change) in KEYS.iter().zip(added(old, new)) {
            if change.abs() > NOTHING {
                let _ =
                    writeln!(lines, "    {}: {change:?}", yaml::key(&format!("{}_d{key}", short.unwrap_or(&new.name))));
            }
        }
    }
    // A map without entries is written as one.
    let empty = if lines.is_empty() { " {}" } else { "" };
    let text = format!("robot_state_publisher:\n  geometric_calibration:{empty}\n{lines}");
    Ok(Written { text, left_out })
}

/// The change from one origin to the other, number by number; of equivalent angles those nearest to the written ones.
fn added(old: &Joint, new: &Joint) -> [f64; 6] {
    let [roll, pitch, yaw] = new.origin.rpy;
    let nearest = |angles: [f64; 3]| -> [f64; 3] {
        std::array::from_fn(|k| {
            let change = angles[k] - old.origin.rpy[k];
            change - TAU * (change / TAU).round()
        })
    };
    let ways = [nearest([roll, pitch, yaw]), nearest([roll + PI, PI - pitch, yaw + PI])];
    let size = |way: &[f64; 3]| way.iter().map(|change| change.abs()).fold(0.0, f64::max);
    let turned = if size(&ways[1]) < size(&ways[0]) { ways[1] } else { ways[0] };
    let moved: [f64; 3] = std::array::from_fn(|k| new.origin.xyz[k] - old.origin.xyz[k]);
    [moved[0], moved[1], moved[2], turned[0], turned[1], turned[2]]
}
