//! ROS-Industrial: parameters of an ortho-parallel arm with a spherical wrist, as opw_kinematics and its MoveIt plugin take them.
//!
//! ```text
//! opw_kinematics_geometric_parameters: {a1, a2, b, c1, c2, c3, c4}        # m
//! opw_kinematics_joint_offsets: [0, deg(-90), …]                          # rad, six of them
//! opw_kinematics_joint_sign_corrections: [1, -1, …]
//! ```
//! **Source.** github.com/Jmeyer1292/opw_kinematics, `include/opw_kinematics/opw_io.h`, and the `opw_parameters_*.yaml` of
//! ROS-Industrial's support packages. The equation is at [`denavit_dh::opw::OrthoParallelWrist`].

use super::yaml::Scalars;
use crate::kinematics_yaml::KinematicsFileError;
use denavit_dh::opw::OrthoParallelWrist;
use denavit_model::{Chain, Quantity};

pub(crate) const GEOMETRY: &str = "opw_kinematics_geometric_parameters";
pub(crate) const OFFSETS: &str = "opw_kinematics_joint_offsets";
pub(crate) const SIGNS: &str = "opw_kinematics_joint_sign_corrections";

pub(super) fn read(scalars: &Scalars, robot: &str) -> Result<Chain, KinematicsFileError> {
    let refused =
        |what: String| KinematicsFileError::NotThisArm { file: scalars.file.clone(), form: "an OPW file", what };
    let above = scalars.above(GEOMETRY);
    let [above] = &above[..] else {
        let groups: Vec<String> = above.iter().map(|path| path.join(".")).collect();
        return Err(refused(format!(
            "the file has parameters of several groups ({}); keep one per file",
            groups.join(", ")
        )));
    };
    let above: Vec<&str> = above.iter().map(String::as_str).collect();
    let number = |keys: &[&str], quantity| {
        let path: Vec<&str> = above.iter().copied().chain(keys.iter().copied()).collect();
        let missing = || refused(format!("{} is missing", path.join(".")));
        scalars.number(&path, quantity)?.ok_or_else(missing)
    };
    let length = |key| number(&[GEOMETRY, key], Quantity::Length);
    let six = |list: &str, quantity| -> Result<[f64; 6], KinematicsFileError> {
        let mut values = [0.0; 6];
        for (value, index) in values.iter_mut().zip(["0", "1", "2", "3", "4", "5"]) {
            *value = number(&[list, index], quantity)?;
        }
        Ok(values)
    };
    // Signs are plain numbers, as angles in rad are.
    let (offsets, signs) = (six(OFFSETS, Quantity::Angle)?, six(SIGNS, Quantity::Angle)?);
    if let Some(sign) = signs.iter().find(|sign| sign.abs() != 1.0) {
        return Err(refused(format!("a sign correction is {sign}; write 1 or -1")));
    }
    let arm = OrthoParallelWrist {
        a1: length("a1")?,
        a2: length("a2")?,
        b: length("b")?,
        c1: length("c1")?,
        c2: length("c2")?,
        c3: length("c3")?,
        c4: length("c4")?,
        offsets,
        signs,
    };
    Ok(arm.chain(robot)?.within_reach()?)
}
