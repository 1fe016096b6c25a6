//! Replaces angles and axes that clearly mean round values: `1.5708` becomes a quarter turn.
//!
//! `denavit_model::intended` finds the intended value, as for every other command: a literal that is a multiple of π
//! truncated or rounded at its last place. A calibrated angle has more digits and stays.

use crate::Change;
use crate::claim::{Claim, Compared};
use crate::error::EditError;
use crate::tally::Tally;
use crate::values::child;
use denavit_export::urdf::text::{Edits, Nodes, clean, parse, three, word};
use denavit_model::PlacedRobot;
use denavit_model::nalgebra::Vector3;
use denavit_model::robot::{JointKind, Origin, Robot, SourceText};
use denavit_model::tree::Reading;
use roxmltree::Node;

/// # Errors
/// The text cannot be edited.
pub(crate) fn snap(robot: &Robot, srdf: Option<&SourceText>) -> Result<Change, EditError> {
    let document = parse(robot)?;
    let nodes = Nodes::of(robot, &document)?;
    let mut snapped =
        Snapped { robot, edits: Edits::default(), tally: Tally::default(), notes: Vec::new(), moves: 0.0 };
    let reach = reach_below(robot);
    for (index, joint) in robot.joints.iter().enumerate() {
        let node = nodes.joint(index);
        let place = robot.joint_place(index).to_string();
        if let Some(origin) = child(node, "origin") {
            snapped.origin(origin, &joint.origin, reach[joint.child], &place);
        }
        let meant = joint.axis_meant.as_ref().filter(|_| joint.kind.has_one_value());
        if let (Some(meant), Some(axis)) = (meant, child(node, "axis")) {
            let text = three(meant.axis.map(|x| clean(x, 1.0)).into());
            snapped.edits.attribute(&robot.source, axis, "xyz", &text);
            snapped.found(&place, &meant.written, &text, 2.0 * meant.turned * reach[joint.child]);
        }
    }
    for (index, link) in robot.links.iter().enumerate() {
        let Some(node) = nodes.link(index) else { continue };
        let place = robot.source.place(link.at, format!("link \"{}\"", link.name)).to_string();
        let parts =
            |tag: &'static str| node.children().filter(move |part| part.is_element() && part.tag_name().name() == tag);
        let inertial = link.inertial.iter().map(|of| &of.origin);
        let pairs = parts("inertial").zip(inertial);
        let pairs = pairs.chain(parts("visual").zip(link.visuals.iter().map(|shape| &shape.origin)));
        let pairs = pairs.chain(parts("collision").zip(link.collisions.iter().map(|shape| &shape.origin)));
        for (part, origin) in pairs {
            if let Some(node) = child(part, "origin") {
                snapped.origin(node, origin, 0.0, &place);
            }
        }
    }
    let Snapped { edits, tally, notes, moves, .. } = snapped;
    let urdf = edits.apply(&robot.source)?;
    // Every other command reads both files as the same robot; as written they differ by what was listed.
    let claim = Claim {
        compared: Compared::AsMeant,
        moves: Some(moves),
        shapes: crate::claim::Shapes::Turned,
        masses: crate::claim::Masses::Free,
        ..Claim::same(robot)
    };
    Ok(Change::of(urdf, srdf, claim, tally, notes))
}

struct Snapped<'a> {
    robot: &'a Robot,
    edits: Edits,
    tally: Tally,
    notes: Vec<String>,
    /// The sum of all bounds, m.
    moves: f64,
}

impl Snapped<'_> {
    fn origin(&mut self, node: Node, origin: &Origin, reach: f64, place: &str) {
        let read = origin.read(Reading::Intended);
        let Some(written) = node.attribute("rpy").filter(|_| !read.reread.is_empty()) else { return };
        let mut text = String::new();
        for piece in written.split_inclusive(|c: char| c.is_whitespace() || c == ',') {
            let number = piece.trim_end_matches(|c: char| c.is_whitespace() || c == ',');
            match read.reread.iter().find(|(literal, _)| literal == number) {
                Some((_, meant)) => {
                    let new = word(meant.angle);
                    self.found(place, number, &new, meant.change.abs() * reach);
                    text.push_str(&new);
                }
                None => text.push_str(number),
            }
            text.push_str(&piece[number.len()..]);
        }
        self.edits.attribute(&self.robot.source, node, "rpy", &text);
    }

    fn found(&mut self, place: &str, old: &str, new: &str, bound: f64) {
        self.moves += bound;
        self.tally.count("number", "numbers", "replaced");
        self.notes.push(if bound > 0.0 {
            format!("{place}: {old} is {new}; this moves no tip by more than {bound:.1e} m")
        } else {
            format!("{place}: {old} is {new}")
        });
    }
}

/// For each link the longest way down from it, m: origins walked and slides passed.
fn reach_below(robot: &Robot) -> Vec<f64> {
    let placed = PlacedRobot::new(robot, Reading::AsWritten);
    let size = crate::proof::motion::size(robot);
    let mut reach = vec![0.0; robot.links.len()];
    for link in placed.order().iter().rev() {
        let Some(index) = placed.carrier(*link) else { continue };
        let joint = &robot.joints[index];
        let slide = match (&joint.kind, joint.limits.range) {
            // At least as far as the proof goes.
            (JointKind::Prismatic, Some((lower, upper))) => lower.abs().max(upper.abs()).max(size),
            (JointKind::Prismatic | JointKind::Planar | JointKind::Floating, _) => 2.0 * size,
            _ => 0.0,
        };
        let length: f64 = Vector3::from(joint.origin.xyz).norm() + slide + reach[*link];
        reach[joint.parent] = length.max(reach[joint.parent]);
    }
    reach
}
