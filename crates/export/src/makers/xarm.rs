//! UFACTORY: joint origins of a single xArm, Lite 6 or 850.
//!
//! ```text
//! kinematics:
//!   joint1: {x, y, z, roll, pitch, yaw}     # base to the frame that joint 1 turns; m and rad
//!   joint2: …                               # 5, 6 or 7 of them
//! ```
//! **Source.** github.com/xArm-Developer/xarm_ros2, `xarm_description/config/kinematics/gen_kinematics_params.py`, which
//! reads the calibration of an arm (made after August 2023) from its controller, and the files in
//! `xarm_description/config/kinematics/default` of xarm_ros; the xacro files use them unchanged as joint origins, so
//! R = Rz(yaw) Ry(pitch) Rx(roll).

use super::origins::{Origins, other_chain};
use super::yaml::Scalars;
use super::{Calibrated, KEYS, Maker, MakerError, Written, chain_of, pose_of, six, tool_words, without_effects};
use crate::kinematics_yaml::KinematicsFileError;
use denavit_model::chain::Chain;
use denavit_model::se3::Pose;
use denavit_model::words::one_line;
use std::fmt::Write as _;

pub(super) const MAKER: Maker = Maker {
    name: "xarm",
    purpose: "xarm_description: config/kinematics/user/xarm6_kinematics_SUFFIX.yaml, with kinematics_suffix:=SUFFIX",
    render,
};

const WANTED: &str = "5 to 7 revolute joints";

fn render(calibrated: &Calibrated) -> Result<Written, MakerError> {
    let chain = calibrated.chain;
    let origins = Origins::of(calibrated, MAKER.name, WANTED)?;
    let count = origins.joints.len();
    if !(5..=7).contains(&count) {
        return Err(other_chain(chain, MAKER.name, WANTED, format!("{count} joints")));
    }
    let mut left_out = without_effects(calibrated);
    let mut text = format!(
        "# {}: {} to the last joint; made by denavit; m and rad\n",
        one_line(chain.name()),
        one_line(chain.base())
    );
    if let Some(tool) = tool_words(&origins.tool, chain.size()) {
        let _ = writeln!(text, "# from the frame of joint {count} to {}: {tool}", one_line(chain.tip()));
        left_out
            .push(format!("this format ends at the joint {count} frame; from there to {} it is {tool}", chain.tip()));
    }
    text.push_str("kinematics:\n");
    for (index, (_, origin)) in origins.joints.iter().enumerate() {
        let _ = writeln!(text, "  joint{}:", index + 1);
        for (key, value) in KEYS.iter().zip(six(origin)) {
            let _ = writeln!(text, "    {key}: {value:?}");
        }
    }
    Ok(Written { text, left_out })
}

pub(super) fn read(scalars: &Scalars, robot: &str) -> Result<Chain, KinematicsFileError> {
    let mut origins = Vec::new();
    while scalars.has(&["kinematics", &format!("joint{}", origins.len() + 1)]) {
        let name = format!("joint{}", origins.len() + 1);
        origins.push((name.clone(), pose_of(scalars.origin(&["kinematics", &name])?)));
    }
    let tip = format!("link{}", origins.len());
    Ok(chain_of((robot, "link_base", &tip), &origins, &Pose::identity())?)
}
