//! The list of rules, a file each.

use crate::lint::finding::Found;
use crate::lint::{Rule, Sheet};
use denavit_model::nalgebra::Vector3;
use denavit_model::{PlacedRobot, ProblemKind, Reading, Robot};
use roxmltree::Node;

mod actuator_beyond_range;
mod angle_unit;
mod axis_missing;
mod axis_noise;
mod axis_not_unit;
mod bad_number;
mod calibration;
mod centre_of_mass;
mod closed_loop;
mod commas;
mod continuous_limits;
pub(in crate::lint) mod dangling_reference;
mod default_inertia;
mod degrees;
mod duplicate_name;
mod effort_or_velocity;
mod frame_twice;
mod inertia;
mod inertia_scale;
mod inertia_zero;
mod inertial_missing;
mod limits_empty;
mod limits_missing;
mod limits_reversed;
mod mass;
mod mesh_not_found;
mod mimic_loop;
mod mimic_unknown;
mod missing_part;
mod nearly_parallel;
mod not_a_tree;
pub(in crate::lint) mod not_understood;
mod origin_far;
mod range_without_effect;
mod root_inertia;
mod rounded_pi;
mod shared_name;
mod taken_as_meant;
mod tip_frame_missing;
mod unknown_kind;
mod unknown_link;
pub(in crate::lint) mod unreadable;
mod xacro_left;
mod zero_axis;
mod zero_outside_limits;

/// Every rule, by number.
pub const RULES: &[Rule] = &[
    unreadable::RULE,
    missing_part::RULE,
    bad_number::RULE,
    duplicate_name::RULE,
    unknown_link::RULE,
    not_a_tree::RULE,
    taken_as_meant::RULE,
    commas::RULE,
    not_understood::RULE,
    rounded_pi::RULE,
    nearly_parallel::RULE,
    axis_not_unit::RULE,
    zero_axis::RULE,
    axis_missing::RULE,
    unknown_kind::RULE,
    origin_far::RULE,
    degrees::RULE,
    axis_noise::RULE,
    limits_missing::RULE,
    limits_reversed::RULE,
    limits_empty::RULE,
    zero_outside_limits::RULE,
    effort_or_velocity::RULE,
    continuous_limits::RULE,
    mass::RULE,
    inertia::RULE,
    inertia_scale::RULE,
    centre_of_mass::RULE,
    inertial_missing::RULE,
    inertia_zero::RULE,
    mimic_unknown::RULE,
    mimic_loop::RULE,
    dangling_reference::RULE,
    mesh_not_found::RULE,
    shared_name::RULE,
    frame_twice::RULE,
    tip_frame_missing::RULE,
    root_inertia::RULE,
    xacro_left::RULE,
    closed_loop::RULE,
    calibration::RULE,
    angle_unit::RULE,
    range_without_effect::RULE,
    actuator_beyond_range::RULE,
    default_inertia::RULE,
];

/// The reading errors of the given kinds.
fn problems(sheet: &Sheet, wanted: impl Fn(&ProblemKind) -> bool) -> Vec<Found> {
    let found = sheet.problems().iter().filter(|problem| wanted(&problem.kind));
    found.map(|problem| Found::placed(problem.place.clone(), problem.kind.to_string())).collect()
}

/// What the reader of another format found of a rule.
fn of_reader(sheet: &Sheet, rule: &str) -> Vec<Found> {
    let translation = sheet.robot().and_then(|robot| robot.source.translation.as_ref());
    let findings = translation.iter().flat_map(|translation| &translation.findings);
    let own = findings.filter(|(name, ..)| name == rule);
    own.map(|(_, place, what)| Found::placed(place.clone(), what.clone())).collect()
}

/// The link or joint that an element is in, in words; the element itself where it is in none.
fn owner(node: Node) -> String {
    let named = node
        .ancestors()
        .find(|above| ["link", "joint"].contains(&above.tag_name().name()) && above.has_attribute("name"));
    let named = named.and_then(|owner| Some(format!("{} \"{}\"", owner.tag_name().name(), owner.attribute("name")?)));
    named.unwrap_or_else(|| format!("<{}>", node.tag_name().name()))
}

/// How large the robot is, m: the longest way of joint origins from the root to a leaf, at least 1 m.
fn size(robot: &Robot) -> f64 {
    let placed = PlacedRobot::new(robot, Reading::AsWritten);
    let mut lengths = vec![0.0; robot.links.len()];
    for link in placed.order() {
        if let Some(joint) = placed.carrier(*link).map(|joint| &robot.joints[joint]) {
            lengths[*link] = lengths[joint.parent] + Vector3::from(joint.origin.xyz).norm();
        }
    }
    lengths.into_iter().fold(1.0, f64::max)
}
