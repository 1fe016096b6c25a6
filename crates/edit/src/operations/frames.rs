//! Other frames for links: the same robot, given in them.

use crate::Change;
use crate::claim::{Claim, KeptLink};
use crate::error::{self, EditError, refused_at_joint};
use crate::tally::Tally;
use crate::values::child;
use denavit_export::urdf::text::{Edits, Moves, Nodes, Numbers, clean, joint_origin, parse, three};
use denavit_export::urdf::{Options, canonical as canonical_text};
use denavit_model::PlacedRobot;
use denavit_model::robot::{JointKind, Robot, SourceText};
use denavit_model::se3::Pose;
use denavit_model::tree::Reading;
use denavit_model::urdf;

/// Link frames on the D-H frames, as `denavit export` puts them; every number as it is written.
///
/// # Errors
/// As of the export.
pub(crate) fn canonical(robot: &Robot, srdf: Option<&SourceText>) -> Result<Change, EditError> {
    let made = canonical_text(robot, &Options { reading: Reading::AsWritten, ..Options::default() })?;
    let mut tally = Tally::default();
    tally.say("link frames put on the D-H frames");
    let notes = made.notes.iter().map(ToString::to_string).collect();
    given_anew(robot, srdf, made.value, tally, notes)
}

/// A link's frame at `to`, given in the frame that it has.
///
/// # Errors
/// No such link, or a place off the axis that the link turns about.
pub(crate) fn origin(robot: &Robot, srdf: Option<&SourceText>, name: &str, to: &Pose) -> Result<Change, EditError> {
    let link = error::link(robot, name)?;
    let document = parse(robot)?;
    let nodes = Nodes::of(robot, &document)?;
    error::all_declared(robot, &nodes)?;
    let mut edits = Edits::default();
    let step = to.inverse();
    let scale = to.translation.vector.amax();
    if let Some(index) = robot.joint_to(link) {
        let joint = &robot.joints[index];
        let off = to.translation.vector.cross(&joint.axis).norm();
        let turns = matches!(joint.kind, JointKind::Revolute | JointKind::Continuous | JointKind::Screw(_));
        if turns && off > 1e-12 * scale {
            let what = "the link turns about this joint's axis, and in a URDF its frame lies on it; give a place on the axis, or \
                        attach a link to it with `attach`";
            return Err(refused_at_joint(robot, index, what));
        }
        if !joint.kind.has_one_value() && joint.kind.moves() {
            let what = format!(
                "the values of a {} joint are given in its child link's frame; they would change",
                joint.kind.word()
            );
            return Err(refused_at_joint(robot, index, what));
        }
        let pose = joint.origin.pose() * to;
        let length = scale + pose.translation.vector.amax();
        joint_origin(&robot.source, &mut edits, nodes.joint(index), &Numbers::of(&pose, length));
        if joint.kind.moves() {
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
    }
    for index in robot.joints_from(link) {
        let pose = step * robot.joints[index].origin.pose();
        let length = scale + pose.translation.vector.amax();
        joint_origin(&robot.source, &mut edits, nodes.joint(index), &Numbers::of(&pose, length));
    }
    let steps = (0..robot.links.len()).map(|index| (index == link).then_some(step)).collect();
    Moves::by_steps(robot, Reading::AsWritten, steps).contents(robot, &document, &nodes, &mut edits)?;
    let mut tally = Tally::default();
    tally.say(format!("the frame of {name} moved"));
    let urdf = edits.apply(&robot.source)?;
    given_anew(robot, srdf, urdf, tally, Vec::new())
}

/// The claim of a text in which frames differ: by how much at joint values 0, and so at all.
fn given_anew(
    robot: &Robot,
    srdf: Option<&SourceText>,
    text: String,
    tally: Tally,
    notes: Vec<String>,
) -> Result<Change, EditError> {
    let made = urdf::read(&robot.source.file, &text)?;
    let (before, after) = (PlacedRobot::new(robot, Reading::AsWritten), PlacedRobot::new(&made, Reading::AsWritten));
    let mut claim = Claim::same(robot);
    // Where the root's own frame moves, everything is seen from it.
    let root = robot.root;
    let seen = |link: usize| before.pose(root).inverse() * before.pose(link);
    for (index, link) in robot.links.iter().enumerate() {
        if let Some(twin) = made.link_index(&link.name) {
            let offset = after.pose(twin).inverse() * seen(index);
            claim.links.insert(link.name.clone(), KeptLink { name: link.name.clone(), offset, matter: None });
        }
    }
    if made.links[made.root].name == robot.links[root].name
        && claim.links[&robot.links[root].name].offset != Pose::identity()
    {
        claim.compared = crate::claim::Compared::No;
    }
    Ok(Change { urdf: text, srdf: srdf.map(|srdf| srdf.text.clone()), claim, second: None, tally, notes })
}
