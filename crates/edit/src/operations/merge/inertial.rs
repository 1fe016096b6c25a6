//! Masses of several links, given in one frame, as one.

use crate::literal::short;
use denavit_export::urdf::text::{clean, three, word};
use denavit_model::nalgebra::{Matrix3, Vector3};
use denavit_model::robot::Robot;

/// `<inertial>` of all these links together, all in one frame; `None` where the first has the only one, or none has.
///
/// m = Σ m_i, c = Σ m_i c_i / m, I = Σ (R_i I_i R_iᵀ + m_i (|r_i|² 1 - r_i r_iᵀ)) with r_i = c_i - c.
pub(super) fn sum(robot: &Robot, links: &[usize]) -> Option<String> {
    let all: Vec<_> = links.iter().filter_map(|link| robot.links[*link].inertial.as_ref()).collect();
    let first_has = links.first().is_some_and(|link| robot.links[*link].inertial.is_some());
    if all.is_empty() || first_has && all.len() == 1 {
        return None;
    }
    let mass: f64 = all.iter().map(|of| of.mass).sum();
    let moment = all.iter().fold(Vector3::zeros(), |sum, of| sum + Vector3::from(of.origin.xyz) * of.mass);
    // Without mass the centre means nothing but the place of the tensor.
    let centre = if mass == 0.0 { Vector3::from(all[0].origin.xyz) } else { moment / mass };
    let mut tensor = Matrix3::zeros();
    for of in &all {
        let rotation = of.origin.pose().rotation.into_inner();
        let arm = Vector3::from(of.origin.xyz) - centre;
        let parallel = Matrix3::identity() * arm.norm_squared() - arm * arm.transpose();
        tensor += rotation * of.tensor * rotation.transpose() + parallel * of.mass;
    }
    let centre: [f64; 3] = centre.map(|x| clean(x, 1.0)).into();
    let entry = |row: usize, column: usize| word(short(f64::midpoint(tensor[(row, column)], tensor[(column, row)])));
    Some(format!(
        "<inertial><origin xyz=\"{}\" rpy=\"0 0 0\"/><mass value=\"{}\"/><inertia ixx=\"{}\" ixy=\"{}\" ixz=\"{}\" iyy=\"{}\" \
         iyz=\"{}\" izz=\"{}\"/></inertial>",
        three(centre),
        word(short(mass)),
        entry(0, 0),
        entry(0, 1),
        entry(0, 2),
        entry(1, 1),
        entry(1, 2),
        entry(2, 2)
    ))
}
