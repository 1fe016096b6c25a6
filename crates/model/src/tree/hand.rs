//! Where an arm that carries a hand ends: its fingers do not belong to the arm.

use super::Step;
use crate::placed::PlacedRobot;
use crate::robot::Joint;

/// An arm has at least this many joints above its hand; with fewer, the robot itself branches.
const AN_ARM: usize = 3;

/// The moving joints on the longest way below each link.
struct Branches<'a> {
    placed: &'a PlacedRobot<'a>,
    depth: Vec<usize>,
}

impl<'a> Branches<'a> {
    fn of(placed: &'a PlacedRobot<'a>) -> Self {
        let mut branches = Self { placed, depth: vec![0; placed.robot().links.len()] };
        for link in placed.order().iter().rev() {
            let longest = placed.carried(*link).iter().map(|joint| branches.below(*joint)).max();
            branches.depth[*link] = longest.unwrap_or(0);
        }
        branches
    }

    fn joint(&self, index: usize) -> &Joint {
        &self.placed.robot().joints[index]
    }

    /// How many moving joints the longest way from a joint downwards has, itself counted.
    fn below(&self, joint: usize) -> usize {
        let joint = self.joint(joint);
        self.depth[joint.child] + usize::from(joint.kind.moves())
    }

    /// Whether two or more branches of a link are as deep as this joint's.
    fn fork_at(&self, joint: usize) -> bool {
        let depth = self.below(joint);
        let carried = self.placed.carried(self.joint(joint).parent);
        carried.iter().filter(|other| self.below(**other) == depth).nth(1).is_some()
    }

    /// A link without a body that ends a way of fixed joints below `link`: the farthest, then the first.
    fn frame_fixed_below(&self, link: usize) -> Option<usize> {
        let mut found = None;
        let mut level = vec![link];
        while !level.is_empty() {
            let joints = level.iter().flat_map(|link| self.placed.carried(*link)).map(|joint| self.joint(*joint));
            level = joints.filter(|joint| !joint.kind.moves()).map(|joint| joint.child).collect();
            found = level.iter().copied().find(|link| self.is_frame(*link)).or(found);
        }
        found
    }

    fn is_frame(&self, link: usize) -> bool {
        let link = &self.placed.robot().links[link];
        link.inertial.is_none() && link.visuals.is_empty() && link.collisions.is_empty()
    }
}

/// Where the arm ends on a chain to `leaf`, where that leaf is a finger of a hand that the arm carries.
///
/// A hand is a link that carries two or more moving branches of equal depth, at the end of a way with more moving
/// joints above than below, at least three. The arm ends at a frame without a body that is fixed below the hand (its
/// tool centre point); without one, at the last such frame between the arm's last joint and the hand (its flange);
/// without that, at the hand itself.
pub(super) fn tool_above_fingers(placed: &PlacedRobot, steps: &[Step]) -> Option<usize> {
    let joints = &placed.robot().joints;
    let moves = |step: &Step| joints[step.joint].kind.moves();
    if steps.iter().filter(|step| moves(step)).count() <= AN_ARM {
        return None;
    }
    let branches = Branches::of(placed);
    let mut above = 0;
    // The links that are rigidly one with the hand, from behind the last moving joint on.
    let mut body: Vec<usize> = Vec::new();
    for step in steps {
        let below = branches.below(step.joint);
        if above >= AN_ARM && (1..above).contains(&below) && branches.fork_at(step.joint) {
            let flange = body.iter().rev().copied().find(|link| branches.is_frame(*link));
            let hand = joints[step.joint].parent;
            return Some(branches.frame_fixed_below(hand).or(flange).unwrap_or(hand));
        }
        if moves(step) {
            above += 1;
            body.clear();
        }
        body.push(joints[step.joint].child);
    }
    None
}

#[cfg(test)]
mod tests {
    use crate::robot::Robot;
    use crate::tree::Reading;
    use crate::urdf;
    use std::fmt::Write as _;

    const BODY: &str = "<visual><geometry><sphere radius=\"1\"/></geometry></visual>";

    /// Links with bodies, but for those that end in `_frame`; joints as `parent child kind`.
    fn robot(joints: &[(&str, &str, &str)]) -> Robot {
        let link =
            |name: &str| format!("<link name=\"{name}\">{}</link>", if name.ends_with("_frame") { "" } else { BODY });
        let mut text = link("base");
        for (parent, child, kind) in joints {
            let _ = write!(
                text,
                "{}<joint name=\"to_{child}\" type=\"{kind}\"><parent link=\"{parent}\"/><child link=\"{child}\"/>\
                 <limit lower=\"-1\" upper=\"1\"/></joint>",
                link(child)
            );
        }
        urdf::read("test.urdf", &format!("<robot name=\"test\">{text}</robot>")).unwrap()
    }

    const ARM: &[(&str, &str, &str)] =
        &[("base", "a", "revolute"), ("a", "b", "revolute"), ("b", "c", "revolute"), ("c", "d", "revolute")];
    const HAND: &[(&str, &str, &str)] = &[("hand", "left", "prismatic"), ("hand", "right", "prismatic")];

    fn tip(parts: &[&[(&str, &str, &str)]]) -> String {
        let robot = robot(&parts.concat());
        let tip = robot.default_chain().tip;
        let read = robot.chain(None, None, Reading::Intended).unwrap();
        assert_eq!(read.value.tip(), tip);
        assert_eq!(robot.chain(Some("base"), None, Reading::Intended).unwrap().value.tip(), tip);
        assert_eq!(read.notes.iter().any(|note| note.to_string().contains("‹tip›")), tip != "left", "{:?}", read.notes);
        tip
    }

    #[test]
    fn an_arm_with_a_hand_ends_at_its_tool() {
        assert_eq!(tip(&[ARM, &[("d", "hand", "fixed")], HAND, &[("hand", "tcp_frame", "fixed")]]), "tcp_frame");
        assert_eq!(
            tip(&[ARM, &[("d", "flange_frame", "fixed"), ("flange_frame", "hand", "fixed")], HAND]),
            "flange_frame"
        );
        assert_eq!(tip(&[ARM, &[("d", "hand", "fixed")], HAND]), "hand");
    }

    #[test]
    fn what_is_no_hand_is_no_end() {
        // A hand alone, two arms on a body, and bars beside a forearm.
        assert_eq!(tip(&[&[("base", "wrist", "revolute"), ("wrist", "hand", "revolute")], HAND]), "left");
        let chest = [("base", "hips", "revolute"), ("hips", "waist", "revolute"), ("waist", "chest", "revolute")];
        let side =
            [("chest", "shoulder", "revolute"), ("shoulder", "elbow", "revolute"), ("elbow", "left", "revolute")];
        let other = [("chest", "one", "revolute"), ("one", "two", "revolute"), ("two", "three", "revolute")];
        assert_eq!(tip(&[&chest, &side, &other]), "left");
        let bars = [("d", "bar", "revolute"), ("d", "plate", "revolute"), ("plate", "left", "revolute")];
        assert_eq!(tip(&[ARM, &bars]), "left");
    }
}
