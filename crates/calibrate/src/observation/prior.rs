//! What is known of a robot before it is measured: its links are machined to a tolerance, its zeros are set by hand.
//!
//! An axis stands on a link, that link on the axis before it. So errors add up along the chain: with δk the error of
//! link k, ok the error of joint k's zero, Sk its screw,
//!
//! ```text
//! departure of axis i = across_i( base + Σ_{k ≤ i} δk + Σ_{k < i} ok Sk )
//! ```
//! δk turns by `turn` about three axes through axis k's centre and shifts by `shift`; nothing is expected of the base.
//! The prior is normal with the covariance that follows. It weighs against the data by their noise: where the data
//! tell a direction well it changes nothing, where they tell it badly it keeps to the drawing, without noise it
//! vanishes. A prior on each axis by itself would not do: a zero that is off by 10 mrad turns all axes after it, which
//! is no news to anyone who masters robots.

use crate::observation::arm::AxisBasis;
use crate::observation::parameters::{Parameter, ParameterKind, Tolerances};
use denavit_model::nalgebra::{DMatrix, Vector3, Vector6};
use denavit_model::{Chain, Quantity};

/// Nothing is expected of the base: this many times the tolerances, rad and m alike.
const BASE: f64 = 1.0;

/// Coordinates of a twist `[omega; v]` (base frame) in the direction that a parameter changes; 0 for pitch and scale.
fn change_in_basis(parameter: &Parameter, bases: &[AxisBasis], twist: &Vector6<f64>) -> f64 {
    let omega = Vector3::new(twist[0], twist[1], twist[2]);
    match parameter.kind {
        ParameterKind::Turn { joint, direction } => {
            omega.dot(if direction == 0 { &bases[joint].a } else { &bases[joint].b })
        }
        ParameterKind::Move { joint, direction } => {
            let at_centre = Vector3::new(twist[3], twist[4], twist[5]) + omega.cross(&bases[joint].centre.coords);
            at_centre.dot(if direction == 0 { &bases[joint].a } else { &bases[joint].b })
        }
        _ => 0.0,
    }
}

fn about(point: &Vector3<f64>, omega: Vector3<f64>, shift: Vector3<f64>) -> Vector6<f64> {
    let v = point.cross(&omega) + shift;
    Vector6::new(omega.x, omega.y, omega.z, v.x, v.y, v.z)
}

/// Inverse covariance of the joints' parameters.
///
/// # Shape and units
/// Square, one row per parameter given, in units of 1 over the parameters' units.
pub fn precision(
    chain: &Chain,
    parameters: &[Parameter],
    bases: &[AxisBasis],
    tolerances: &Tolerances,
) -> DMatrix<f64> {
    let count = parameters.len();
    let expected: Vec<f64> = parameters.iter().map(|parameter| parameter.tolerance.unwrap_or(1.0)).collect();
    // Everything in units of the tolerances, so that rad and m mix well.
    let mut covariance = DMatrix::<f64>::zeros(count, count);
    for (i, parameter) in parameters.iter().enumerate() {
        if matches!(parameter.kind, ParameterKind::Pitch { .. } | ParameterKind::Scale { .. }) {
            covariance[(i, i)] = 1.0;
        }
    }
    let mut add = |twist: &Vector6<f64>, deviation: f64, from: usize| {
        let moved: Vec<f64> = parameters
            .iter()
            .zip(&expected)
            .map(|(parameter, expected)| {
                let after = parameter.kind.joint().is_some_and(|joint| joint >= from);
                if after { deviation * change_in_basis(parameter, bases, twist) / expected } else { 0.0 }
            })
            .collect();
        for i in 0..count {
            for k in 0..count {
                covariance[(i, k)] += moved[i] * moved[k];
            }
        }
    };
    for k in 0..3 {
        let e = Vector3::ith(k, 1.0);
        add(&about(&Vector3::zeros(), e, Vector3::zeros()), BASE, 0);
        add(&about(&Vector3::zeros(), Vector3::zeros(), e), BASE, 0);
    }
    for (index, joint) in chain.joints().iter().enumerate() {
        let centre = bases[index].centre.coords;
        for k in 0..3 {
            let e = Vector3::ith(k, 1.0);
            add(&about(&centre, e, Vector3::zeros()), tolerances.turn, index);
            add(&about(&centre, Vector3::zeros(), e), tolerances.shift, index);
        }
        let slides = chain.coordinates()[joint.coordinate].quantity == Quantity::Length;
        let zero = if slides { tolerances.zero_slide } else { tolerances.zero_turn };
        add(&joint.screw.twist(), zero, index + 1);
    }
    let mut precision =
        covariance.cholesky().map_or_else(|| DMatrix::identity(count, count), |factor| factor.inverse());
    for i in 0..count {
        for k in 0..count {
            precision[(i, k)] /= expected[i] * expected[k];
        }
    }
    precision
}
