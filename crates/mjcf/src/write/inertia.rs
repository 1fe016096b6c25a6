//! A link's inertia as MuJoCo takes it: A + B ≥ C, every moment positive.

use super::numbers;
use crate::mass::is_possible;
use denavit_model::nalgebra::{Matrix3, SymmetricEigen, Vector3};
use denavit_model::robot::Inertial;
use denavit_model::se3;

/// Moments that MuJoCo takes differ by less than this from what it refuses, kg·m².
const SLACK: f64 = 1e-14;

/// What becomes of an inertia.
pub enum Choice {
    /// Written as it is: attributes.
    AsItIs(String),
    /// Changed: attributes, and what was done.
    Changed(String, String),
    /// MuJoCo would refuse it: why, and what to do.
    Refused(String),
}

/// An inertia's attributes.
pub fn written(inertial: &Inertial, fix: bool) -> Choice {
    let eigen = SymmetricEigen::new(inertial.tensor);
    let mut order = [0, 1, 2];
    order.sort_by(|a, b| eigen.eigenvalues[*a].total_cmp(&eigen.eigenvalues[*b]));
    let [a, b, c] = order.map(|index| eigen.eigenvalues[index]);
    if a >= 0.0 && a + b >= c - SLACK / 2.0 {
        return Choice::AsItIs(attributes(inertial, &inertial.tensor));
    }
    let shown = format!("{a:.4e}, {b:.4e}, {c:.4e} kg·m²");
    if !is_possible([a, b, c]) && !fix {
        return Choice::Refused(format!(
            "no body has the principal moments of inertia {shown}: the two smaller ones together are to be at least the largest; \
             correct the inertia, or write the nearest possible one with ‹fix-inertia›"
        ));
    }
    // The nearest: moments raised to 0, then the two smaller ones by the same until they reach the largest.
    let (mut low, mut middle, high) = (a.max(0.0), b.max(0.0), c.max(0.0));
    let missing = high - low - middle;
    if missing > 0.0 {
        (low, middle) = (low + missing / 2.0, middle + missing / 2.0);
    }
    let mut moments = Vector3::zeros();
    for (index, moment) in order.into_iter().zip([low, middle, high]) {
        moments[index] = moment * (1.0 + f64::EPSILON);
    }
    let tensor = eigen.eigenvectors * Matrix3::from_diagonal(&moments) * eigen.eigenvectors.transpose();
    let why = format!("no body has the principal moments {shown}; written as {low:.4e}, {middle:.4e}, {high:.4e}");
    Choice::Changed(attributes(inertial, &((tensor + tensor.transpose()) / 2.0)), why)
}

/// A diagonal tensor stands along its own axes, another along the link's.
fn attributes(inertial: &Inertial, tensor: &Matrix3<f64>) -> String {
    let origin = &inertial.origin;
    let mut out = format!(" pos=\"{}\" mass=\"{}\"", numbers(&origin.xyz), inertial.mass);
    let is_diagonal = tensor[(0, 1)] == 0.0 && tensor[(0, 2)] == 0.0 && tensor[(1, 2)] == 0.0;
    let turn = se3::rotation_from_rpy(origin.rpy);
    if is_diagonal {
        if origin.rpy != [0.0; 3] {
            let [x, y, z, w] = se3::quaternion_xyzw(&turn);
            out.push_str(" quat=\"");
            out.push_str(&numbers(&[w, x, y, z]));
            out.push('"');
        }
        out.push_str(" diaginertia=\"");
        out.push_str(&numbers(&[tensor[(0, 0)], tensor[(1, 1)], tensor[(2, 2)]]));
    } else {
        let t = if origin.rpy == [0.0; 3] { *tensor } else { turn.matrix() * tensor * turn.matrix().transpose() };
        out.push_str(" fullinertia=\"");
        out.push_str(&numbers(&[t[(0, 0)], t[(1, 1)], t[(2, 2)], t[(0, 1)], t[(0, 2)], t[(1, 2)]]));
    }
    out.push('"');
    out
}
