//! Moves the frames of links without changing the robot.

use crate::Change;
use crate::claim::{Claim, KeptLink};
use crate::error::{self, EditError, refused_at_joint};
use crate::tally::Tally;
use crate::values::child;
use denavit_export::urdf::text::{Edits, Moves, Nodes, Numbers, clean, joint_origin, parse, three};
use denavit_export::urdf::{Options, canonical as canonical_text};
use denavit_model::PlacedRobot;
use denavit_model::nalgebra::{Rotation3, Vector3};
use denavit_model::robot::{JointKind, Robot, SourceText};
use denavit_model::se3::{self, Pose};
use denavit_model::tree::Reading;
use denavit_model::urdf;

/// A frame displaced by less is unchanged, m and rad.
const STAYS: f64 = 1e-12;

/// Moves link frames to the D-H frames, as `denavit export` does; every number is read as written.
///
/// # Errors
/// As of the export.
pub(crate) fn canonical(robot: &Robot, srdf: Option<&SourceText>) -> Result<Change, EditError> {
    let made = canonical_text(robot, &Options { reading: Reading::AsWritten, ..Options::default() })?;
    let mut tally = Tally::default();
    tally.say("link frames moved to the D-H frames");
    let notes = made.notes.iter().map(ToString::to_string).collect();
    claim_of(robot, srdf, (made.value, Pose::identity()), tally, notes)
}

/// Moves a link's frame to `to`, given in its present frame.
///
/// # Errors
/// No such link, or a position off the link's joint axis.
pub(crate) fn origin(robot: &Robot, srdf: Option<&SourceText>, name: &str, to: &Pose) -> Result<Change, EditError> {
    let link = error::link(robot, name)?;
    let mut frames = vec![None; robot.links.len()];
    frames[link] = Some(*to);
    if let Some(index) = robot.joint_to(link) {
        let joint = &robot.joints[index];
        let off = to.translation.vector.cross(&joint.axis).norm();
        if turns(&joint.kind) && off > 1e-12 * to.translation.vector.amax() {
            let what = "a URDF needs the link's frame on this joint's axis; give a position on the axis, or attach a \
                        new link with `attach`";
            return Err(refused_at_joint(robot, index, what));
        }
        if several_values(&joint.kind) {
            let what = format!(
                "the values of a {} joint refer to its child link's frame, so they would change",
                joint.kind.word()
            );
            return Err(refused_at_joint(robot, index, what));
        }
    }
    let mut tally = Tally::default();
    tally.say(format!("the frame of {name} moved"));
    moved(robot, srdf, &frames, tally, Vec::new())
}

/// Moves link frames to the centre of mass, or, if a joint turns the link, to the nearest point of the joint's axis,
/// because a URDF joint turns about its child's origin. No frame turns.
///
/// # Errors
/// No such link, or one without mass.
pub(crate) fn recentre(robot: &Robot, srdf: Option<&SourceText>, names: &[String]) -> Result<Change, EditError> {
    let mut frames = vec![None; robot.links.len()];
    let mut notes = Vec::new();
    let mut tally = Tally::default();
    let named = names.iter().map(|name| error::link(robot, name)).collect::<Result<Vec<_>, _>>()?;
    for (index, link) in robot.links.iter().enumerate() {
        let asked = named.contains(&index);
        if !asked && !named.is_empty() {
            continue;
        }
        let Some(inertial) = link.inertial.as_ref().filter(|inertial| inertial.mass > 0.0) else {
            if asked {
                return Err(error::refused_at_link(robot, index, "it has no mass, so it has no centre of mass"));
            }
            continue;
        };
        let mut centre = Vector3::from(inertial.origin.xyz);
        if let Some(joint) = robot.joint_to(index).map(|joint| &robot.joints[joint]) {
            if several_values(&joint.kind) {
                let kind = joint.kind.word();
                notes.push(format!(
                    "link \"{}\" keeps its frame: the values of the {kind} joint \"{}\" refer to it",
                    link.name, joint.name
                ));
                continue;
            }
            if turns(&joint.kind) {
                centre = joint.axis.into_inner() * joint.axis.dot(&centre);
            }
        }
        let centre = centre.map(|x| clean(x, 1.0));
        if centre.norm() > 0.0 {
            frames[index] = Some(se3::pose(Rotation3::identity(), centre));
            tally.count("link frame", "link frames", "moved to the mass");
        }
    }
    if frames.iter().all(Option::is_none) {
        tally.say("every frame is already there");
    }
    moved(robot, srdf, &frames, tally, notes)
}

fn turns(kind: &JointKind) -> bool {
    matches!(kind, JointKind::Revolute | JointKind::Continuous | JointKind::Screw(_))
}

/// Whether the values of a joint refer to its child's frame.
fn several_values(kind: &JointKind) -> bool {
    !kind.has_one_value() && kind.moves()
}

/// The text with other link frames: old_from_new of each; `None` where the frame stays.
fn moved(
    robot: &Robot,
    srdf: Option<&SourceText>,
    frames: &[Option<Pose>],
    tally: Tally,
    mut notes: Vec<String>,
) -> Result<Change, EditError> {
    let document = parse(robot)?;
    let nodes = Nodes::of(robot, &document)?;
    error::all_declared(robot, &nodes)?;
    let mut edits = Edits::default();
    let steps: Vec<Option<Pose>> = frames.iter().map(|frame| frame.map(|frame| frame.inverse())).collect();
    for (index, joint) in robot.joints.iter().enumerate() {
        let (above, below) = (steps[joint.parent], frames[joint.child]);
        if above.is_none() && below.is_none() {
            continue;
        }
        let mut pose = joint.origin.pose();
        let mut length = pose.translation.vector.amax();
        if let Some(step) = above {
            pose = step * pose;
            length += step.translation.vector.amax();
        }
        if let Some(frame) = below {
            pose *= frame;
            length += frame.translation.vector.amax();
        }
        joint_origin(&robot.source, &mut edits, nodes.joint(index), &Numbers::of(&pose, length));
        let Some(step) = steps[joint.child].filter(|_| joint.kind.moves()) else { continue };
        let axis = (step.rotation * joint.axis.into_inner()).map(|x| clean(x, 1.0));
        let same = (axis - joint.axis.into_inner()).norm() <= 4.0 * f64::EPSILON;
        match child(nodes.joint(index), "axis") {
            _ if same => {}
            Some(node) => edits.attribute(&robot.source, node, "xyz", &three(axis.into())),
            None => {
                let element = format!("<axis xyz=\"{}\"/>", three(axis.into()));
                edits.behind_origin(&robot.source, nodes.joint(index), &element);
            }
        }
    }
    let root = steps[robot.root].unwrap_or_else(Pose::identity);
    let moves = Moves::by_steps(robot, Reading::AsWritten, steps);
    moves.contents(robot, &document, &nodes, &mut edits)?;
    notes.extend(moves.plugins_that_name(robot, &document).iter().map(ToString::to_string));
    let urdf = edits.apply(&robot.source)?;
    claim_of(robot, srdf, (urdf, root), tally, notes)
}

/// The claim of a text in which frames differ: their displacement at joint values 0, the same at all others.
fn claim_of(
    robot: &Robot,
    srdf: Option<&SourceText>,
    (text, root_step): (String, Pose),
    tally: Tally,
    notes: Vec<String>,
) -> Result<Change, EditError> {
    let made = urdf::read(&robot.source.file, &text)?;
    let (before, after) = (PlacedRobot::new(robot, Reading::AsWritten), PlacedRobot::new(&made, Reading::AsWritten));
    let mut claim = Claim::same(robot);
    // Where the root's own frame moves, everything is seen from it.
    let root = robot.root;
    let seen = |link: usize| root_step * before.pose(root).inverse() * before.pose(link);
    for (index, link) in robot.links.iter().enumerate() {
        if let Some(twin) = made.link_index(&link.name) {
            let offset = after.pose(twin).inverse() * seen(index);
            claim.links.insert(link.name.clone(), KeptLink { name: link.name.clone(), offset, matter: None });
        }
    }
    // The exact comparison looks at tips, from the root: where those frames are others it has nothing to say.
    let moves = |link: usize| {
        let offset = &claim.links[&robot.links[link].name].offset;
        let (turned, moved) = se3::difference(offset, &Pose::identity());
        turned > STAYS || moved > STAYS
    };
    let is_kept = made.links[made.root].name == robot.links[root].name;
    if is_kept && moves(root) || robot.leaves().into_iter().any(moves) {
        claim.compared = crate::claim::Compared::No;
    }
    Ok(Change::of(text, srdf, claim, tally, notes))
}
