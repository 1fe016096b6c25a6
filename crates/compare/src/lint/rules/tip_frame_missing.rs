//! An arm that ends in a joint.

use crate::lint::finding::Found;
use crate::lint::{Rule, Sheet};
use crate::report::Level;
use denavit_model::{PlacedRobot, Reading, Robot};

pub(super) const RULE: Rule = Rule {
    code: "D070",
    name: "tip-frame-missing",
    level: Level::Note,
    summary: "The longest arm ends at a moving link, without a frame for the flange or tool",
    why: "The tool pose is then undefined: planners use the last joint's frame, whose position along the axis is \
          arbitrary. Add an empty link `tool0` on a fixed joint at the flange.",
    bad: "<link name=\"base\"/>\n<link name=\"shoulder\"/>\n<link name=\"arm\"/>\n<link name=\"wrist\"/>\n<joint name=\"j1\" type=\"continuous\">\n  <axis xyz=\"0 0 1\"/>\n  <parent link=\"base\"/>\n  <child link=\"shoulder\"/>\n</joint>\n<joint name=\"j2\" type=\"continuous\">\n  <axis xyz=\"0 1 0\"/>\n  <parent link=\"shoulder\"/>\n  <child link=\"arm\"/>\n</joint>\n<joint name=\"j3\" type=\"continuous\">\n  <axis xyz=\"0 1 0\"/>\n  <parent link=\"arm\"/>\n  <child link=\"wrist\"/>\n</joint>",
    good: "<link name=\"base\"/>\n<link name=\"shoulder\"/>\n<link name=\"arm\"/>\n<link name=\"wrist\"/>\n<link name=\"tool0\"/>\n<joint name=\"j1\" type=\"continuous\">\n  <axis xyz=\"0 0 1\"/>\n  <parent link=\"base\"/>\n  <child link=\"shoulder\"/>\n</joint>\n<joint name=\"j2\" type=\"continuous\">\n  <axis xyz=\"0 1 0\"/>\n  <parent link=\"shoulder\"/>\n  <child link=\"arm\"/>\n</joint>\n<joint name=\"j3\" type=\"continuous\">\n  <axis xyz=\"0 1 0\"/>\n  <parent link=\"arm\"/>\n  <child link=\"wrist\"/>\n</joint>\n<joint name=\"flange\" type=\"fixed\">\n  <origin xyz=\"0 0 0.1\"/>\n  <parent link=\"wrist\"/>\n  <child link=\"tool0\"/>\n</joint>",
    fixable: false,
    check,
};

/// A chain with at least this many joints is an arm.
const AN_ARM: usize = 3;

fn check(sheet: &Sheet) -> Vec<Found> {
    let Some(robot) = sheet.robot() else { return Vec::new() };
    let chain = robot.default_chain();
    let Some(tip) = robot.link_index(&chain.tip).filter(|_| chain.coordinates.len() >= AN_ARM) else {
        return Vec::new();
    };
    let Some(joint) = robot.joint_to(tip).map(|joint| &robot.joints[joint]) else { return Vec::new() };
    if !joint.kind.moves() || joint.mimic.is_some() {
        return Vec::new();
    }
    if has_gripper(robot, tip) {
        return Vec::new();
    }
    let what = format!("the arm ends here, directly after joint \"{}\"; add a fixed frame at the flange", joint.name);
    vec![Found::at(robot.links[tip].at, format!("link \"{}\"", chain.tip), what)]
}

/// Words in the names of what a gripper moves.
const GRIPPER: [&str; 5] = ["grip", "finger", "jaw", "claw", "thumb"];

/// Whether the chain to `tip` ends in a gripper that is mounted on a fixed frame: fingers side by side on one
/// body after the arm, or a last joint with such a name.
fn has_gripper(robot: &Robot, tip: usize) -> bool {
    let placed = PlacedRobot::new(robot, Reading::AsWritten);
    let way: Vec<usize> =
        std::iter::successors(placed.carrier(tip), |joint| placed.carrier(robot.joints[*joint].parent)).collect();
    let moving: Vec<usize> = way.into_iter().rev().filter(|joint| robot.joints[*joint].kind.moves()).collect();
    // Links and moving joints of each rigid body.
    let (mut links, mut fingers) = (vec![0; robot.links.len()], vec![0; robot.links.len()]);
    for link in placed.order() {
        let body = placed.body(*link);
        links[body] += 1;
        fingers[body] += placed.carried(*link).iter().filter(|on| robot.joints[**on].kind.moves()).count();
    }
    moving.iter().skip(AN_ARM).any(|index| {
        let joint = &robot.joints[*index];
        let body = placed.body(joint.parent);
        let name = format!("{} {}", joint.name, robot.links[joint.child].name).to_lowercase();
        let is_finger = fingers[body] > 1 || GRIPPER.iter().any(|word| name.contains(word));
        is_finger && links[body] > 1
    })
}
