//! An inertia tensor that no body has.

use crate::lint::finding::Found;
use crate::lint::{Rule, Sheet};
use crate::report::Level;
use denavit_model::nalgebra::SymmetricEigen;

pub(super) const RULE: Rule = Rule {
    code: "D031",
    name: "inertia-not-physical",
    level: Level::Error,
    summary: "An inertia tensor is not positive definite, or violates the triangle inequality",
    why: "The principal moments of any body are positive, and none exceeds the sum of the other two. With another \
          tensor a simulation gains energy from nothing. Usual causes: moments rounded to 0, products of inertia with \
          the wrong sign or frame, ixx and izz swapped.",
    bad: "<link name=\"base\">\n  <inertial>\n    <mass value=\"1\"/>\n    <inertia ixx=\"1\" ixy=\"0\" ixz=\"0\" iyy=\"1\" iyz=\"0\" izz=\"3\"/>\n  </inertial>\n</link>",
    good: "<link name=\"base\">\n  <inertial>\n    <mass value=\"1\"/>\n    <inertia ixx=\"1\" ixy=\"0\" ixz=\"0\" iyy=\"1\" iyz=\"0\" izz=\"1.5\"/>\n  </inertial>\n</link>",
    fixable: false,
    check,
};

/// Minimum precision of a file: flat plates are at the limit of the inequality, and rounding may exceed it.
const WRITTEN: f64 = 1e-3;

/// Relative rounding of eigenvalues, with room.
const ROUNDING: f64 = 1e-12;

fn check(sheet: &Sheet) -> Vec<Found> {
    let mut found = Vec::new();
    for link in sheet.links() {
        let Some(inertial) = link.inertial.as_ref().filter(|inertial| inertial.mass > 0.0) else { continue };
        let mut moments: Vec<f64> = SymmetricEigen::new(inertial.tensor).eigenvalues.iter().copied().collect();
        moments.sort_by(f64::total_cmp);
        let largest = moments.iter().fold(0.0f64, |most, moment| most.max(moment.abs()));
        // What is left of a moment of 0 after the rounding of an eigenvalue.
        moments.iter_mut().filter(|moment| moment.abs() < ROUNDING * largest).for_each(|moment| *moment = 0.0);
        let [small, middle, large] = moments[..] else { continue };
        let what = if small == 0.0 && large == 0.0 {
            // Not stated at all: another rule.
            continue;
        } else if small <= 0.0 {
            format!("principal moments {small:.4e}, {middle:.4e}, {large:.4e} kg·m²: not all are positive")
        } else if large > (small + middle) * (1.0 + WRITTEN) {
            format!(
                "principal moments {small:.4e}, {middle:.4e}, {large:.4e} kg·m²: the largest exceeds the sum of the \
                 others"
            )
        } else {
            continue;
        };
        found.push(Found::at(sheet.below(link.at, &["inertial", "inertia"]), format!("link \"{}\"", link.name), what));
    }
    found
}
