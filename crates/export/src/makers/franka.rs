//! Franka: `kinematics.yaml` of franka_description, the joint origins of an arm and its flange.
//!
//! ```text
//! joint1:
//!   kinematic: {x, y, z, roll, pitch, yaw}     # m and rad, as a URDF reads them
//! …
//! joint8:                                      # from the frame of joint 7 to the flange
//!   kinematic: …
//! ```
//! **Source.** github.com/frankaemika/franka_description, `robots/fer/kinematics.yaml` and `robots/fr3`, which the xacro
//! files load for joint origins. The controller has its own numbers: this file is only for computations in ROS.

use super::origins::{Origins, other_chain};
use super::yaml::Scalars;
use super::{Calibrated, KEYS, Maker, MakerError, Written, chain_of, pose_of, six, tool_words, without_effects};
use crate::kinematics_yaml::KinematicsFileError;
use denavit_model::chain::Chain;
use denavit_model::se3::Pose;
use denavit_model::words::one_line;
use std::fmt::Write as _;

pub(super) const MAKER: Maker =
    Maker { name: "franka", purpose: "franka_description: robots/fer/kinematics.yaml (or fr3)", render };

const WANTED: &str = "7 revolute joints";
const JOINTS: usize = 7;

fn render(calibrated: &Calibrated) -> Result<Written, MakerError> {
    let chain = calibrated.chain;
    let origins = Origins::of(calibrated, MAKER.name, WANTED)?;
    let count = origins.joints.len();
    if count != JOINTS {
        return Err(other_chain(chain, MAKER.name, WANTED, format!("{count} joints")));
    }
    let mut left_out = without_effects(calibrated);
    // The flange; tools on it are not part of the file.
    let flange = match origins.to_link(chain, "link8")? {
        Some(flange) => {
            if let Some(tool) = tool_words(&(flange.inverse() * origins.tool), chain.size()) {
                left_out.push(format!("this format ends at the flange; from there to {} it is {tool}", chain.tip()));
            }
            flange
        }
        None => origins.tool,
    };
    let mut text =
        format!("# {}: {} to the flange; made by denavit; m and rad\n", one_line(chain.name()), one_line(chain.base()));
    let poses = origins.joints.iter().map(|(_, origin)| *origin).chain([flange]);
    for (index, origin) in poses.enumerate() {
        let _ = writeln!(text, "joint{}:\n  kinematic:", index + 1);
        for (key, value) in KEYS.iter().zip(six(&origin)) {
            let _ = writeln!(text, "    {key}: {value:?}");
        }
    }
    Ok(Written { text, left_out })
}

/// Neighbouring axes of every Franka arm are at right angles, with a deviation below this, rad.
const SQUARE: f64 = 0.1;

pub(super) fn read(scalars: &Scalars, robot: &str) -> Result<Chain, KinematicsFileError> {
    let origin = |number: usize| scalars.origin(&[&format!("joint{number}"), "kinematic"]).map(pose_of);
    let origins = (1..=JOINTS).map(|number| Ok((format!("joint{number}"), origin(number)?)));
    let origins: Vec<(String, Pose)> = origins.collect::<Result<_, KinematicsFileError>>()?;
    let chain = chain_of((robot, "link0", "link8"), &origins, &origin(JOINTS + 1)?)?;
    let axes: Vec<_> = chain.joints().iter().map(|joint| joint.screw.direction()).collect();
    if let Some(at) = axes.windows(2).position(|pair| pair[0].dot(&pair[1]).abs() > SQUARE) {
        return Err(super::not_this_arm(
            scalars,
            "the joint origins of a Franka arm",
            format!(
                "axes {} and {} of a Franka arm are at right angles, but here they are not; if this arm's xacro \
                 defines the axes, give the URDF or xacro instead",
                at + 1,
                at + 2
            ),
        ));
    }
    Ok(chain)
}
