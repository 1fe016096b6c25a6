//! A link's inertia as MuJoCo takes it: A + B ≥ C, every moment positive.

use super::numbers;
use crate::mass::is_possible;
use denavit_model::nalgebra::{Matrix3, SymmetricEigen, Vector3};
use denavit_model::robot::Inertial;
use denavit_model::se3;

/// MuJoCo holds A + B against C to the last digit, whatever its own finding of A, B, C rounds: so much of C more is safe.
const MARGIN: f64 = 1e-12;

/// The least moment of inertia that MuJoCo takes along axes that it finds itself, with room, kg·m².
const LEAST_MOMENT: f64 = 1e-13;

/// How an inertia is written.
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
    let is_safe = a >= LEAST_MOMENT && a + b >= c * (1.0 + MARGIN);
    // A diagonal is taken as it stands, with no finding of axes; one without inertia is left alone.
    let is_taken = is_diagonal(&inertial.tensor) && a >= 1e-14 && a + b >= c;
    if is_safe || is_taken || inertial.tensor.norm() == 0.0 {
        return Choice::AsItIs(attributes(inertial, &inertial.tensor));
    }
    let shown = format!("{a:.4e}, {b:.4e}, {c:.4e} kg·m²");
    if !is_possible([a, b, c]) && !fix {
        return Choice::Refused(format!(
            "no body can have the principal moments of inertia {shown}: the sum of the two smaller ones must be at least the largest; \
             correct the inertia, or write the nearest possible one with ‹fix-inertia›"
        ));
    }
    // The nearest: moments raised to the least, then the two smaller ones by the same until they reach the largest.
    let [mut low, mut middle, high] = [a, b, c].map(|moment| moment.max(LEAST_MOMENT));
    let missing = high * (1.0 + 2.0 * MARGIN) - low - middle;
    if missing > 0.0 {
        (low, middle) = (low + missing / 2.0, middle + missing / 2.0);
    }
    let mut moments = Vector3::zeros();
    for (index, moment) in order.into_iter().zip([low, middle, high]) {
        moments[index] = moment;
    }
    let tensor = eigen.eigenvectors * Matrix3::from_diagonal(&moments) * eigen.eigenvectors.transpose();
    let by = (tensor - inertial.tensor).norm() / inertial.tensor.norm();
    let why = format!(
        "MuJoCo refuses the principal moments {shown}; they are raised, a relative change of the tensor of {by:.0e}"
    );
    Choice::Changed(attributes(inertial, &((tensor + tensor.transpose()) / 2.0)), why)
}

fn is_diagonal(tensor: &Matrix3<f64>) -> bool {
    tensor[(0, 1)] == 0.0 && tensor[(0, 2)] == 0.0 && tensor[(1, 2)] == 0.0
}

/// A diagonal tensor stands along its own axes, another along the link's.
fn attributes(inertial: &Inertial, tensor: &Matrix3<f64>) -> String {
    let origin = &inertial.origin;
    let mut out = format!(" pos=\"{}\" mass=\"{}\"", numbers(&origin.xyz), inertial.mass);
    let turn = se3::rotation_from_rpy(origin.rpy);
    if is_diagonal(tensor) {
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
