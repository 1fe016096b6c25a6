//! Differences between a robot and its drawing far beyond tolerances, such as a link of another length.

use denavit_identify::prior::covariance_of;
use denavit_identify::solve::Fit;
use denavit_identify::symmetric;
use denavit_model::nalgebra::DVector;
use serde::Serialize;

/// A deviation of this many standard deviations of the prior is beyond tolerances; arms with hand-set wrists reach eleven.
const MANY_TOLERANCES: f64 = 15.0;
/// And this many of the fit's own, or it may be chance.
const SURE: f64 = 5.0;

/// An axis that deviates from its drawing, relative to the axes before it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DrawingDifference {
    /// The parameter, such as `elbow_joint.move_x`.
    pub parameter: String,
    /// Its joint.
    pub joint: String,
    /// Its deviation beyond that of the axes before it, in the unit.
    pub value: f64,
    /// `rad`, `m`, `m/rad` or `1`.
    pub unit: &'static str,
    /// The same in standard deviations of the prior.
    pub tolerances: f64,
}

/// Parameters that moved by many tolerances, the largest first.
///
/// With the prior's covariance C = L Lᵀ in the order of the chain, L⁻¹ η is what each number adds to those before it. The
/// base is free in the prior, so a common motion of all axes counts for nothing.
pub fn drawing_differences<E>(fit: &Fit<E>) -> Vec<DrawingDifference> {
    let count = fit.layout.joints.len();
    let own_parameters = &fit.layout.parameters[fit.layout.joints.clone()];
    let lower = symmetric::lower(&covariance_of(&fit.layout.prior.of_drawing, own_parameters), 0.0);
    let moved = DVector::from_vec(fit.layout.difference(&fit.arm, &fit.arm)[fit.layout.joints.clone()].to_vec());
    let solved = "the diagonal of a factor is not 0";
    let own = lower.solve_lower_triangular(&moved).expect(solved);
    let covariance = fit.covariance.view((0, 0), (count, count));
    let half = lower.solve_lower_triangular(&covariance).expect(solved);
    let spread = lower.solve_lower_triangular(&half.transpose()).expect(solved);
    let joints = fit.arm.nominal.joints();
    let mut found: Vec<DrawingDifference> = Vec::new();
    for index in 0..count {
        let sure = spread[(index, index)].max(0.0).sqrt();
        if own[index].abs() < MANY_TOLERANCES || own[index].abs() < SURE * sure {
            continue;
        }
        let parameter = &fit.layout.parameters[index];
        found.push(DrawingDifference {
            parameter: parameter.name.clone(),
            joint: parameter.kind.joint().map_or_else(String::new, |joint| joints[joint].name.clone()),
            value: own[index] * lower[(index, index)],
            unit: parameter.unit,
            tolerances: own[index].abs(),
        });
    }
    found.sort_by(|a, b| b.tolerances.total_cmp(&a.tolerances));
    found
}
