//! From the tree to a chain: the possible chains, and the screw axes of one of them.

mod assembly;
mod hand;

use crate::chain::Chain;
use crate::notes::{Note, Noted, Place};
use crate::placed::PlacedRobot;
use crate::problems::nearest_name;
use crate::robot::{JointKind, Robot};
use assembly::Assembly;
use std::collections::{HashMap, HashSet};
use thiserror::Error;

/// How the decimal literals of angles are read.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Reading {
    /// A literal that clearly stands for a multiple of π is read as that, with a note.
    #[default]
    Intended,
    /// Every literal is read as written.
    AsWritten,
}

/// A chain from a base link to a leaf of the tree.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ChainListing {
    /// Base link.
    pub base: String,
    /// Tip link.
    pub tip: String,
    /// Names of the joints that move it, mimic joints by their driver's name, each once.
    pub coordinates: Vec<String>,
    /// How many links lie between base and tip, both counted.
    pub links: usize,
}

/// Why a tree does not have the chain.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum TreeError {
    /// No link of that name.
    #[error("{file}: the robot has no link \"{name}\"{}", .near.as_ref().map_or_else(|| "; `denavit chains` lists base and tip links".into(), |near| format!("; did you mean \"{near}\"?")))]
    NoSuchLink {
        /// The file.
        file: String,
        /// What was asked for.
        name: String,
        /// The nearest name that exists.
        near: Option<String>,
    },
    /// A joint of a kind that no chain can hold.
    #[error(
        "{place}: a {word} joint is in the chain; choose ‹base› \"{below}\" to start after it, or ‹tip› \"{above}\" to end before it"
    )]
    Unsupported {
        /// The joint.
        place: Place,
        /// Its kind.
        word: String,
        /// The link that it carries.
        below: String,
        /// The link that it is mounted on.
        above: String,
    },
    /// A mimic joint follows a joint that is not there.
    #[error("{place}: it mimics joint \"{driver}\", which does not exist{}", .near.as_ref().map_or_else(String::new, |near| format!("; did you mean \"{near}\"?")))]
    NoDriver {
        /// The mimic joint.
        place: Place,
        /// As written.
        driver: String,
        /// The nearest name that exists.
        near: Option<String>,
    },
    /// A mimic joint follows itself, or one that has several values.
    #[error("{place}: it cannot mimic joint \"{driver}\": {why}")]
    BadDriver {
        /// The mimic joint.
        place: Place,
        /// The joint that it follows.
        driver: String,
        /// What is wrong.
        why: &'static str,
    },
    /// The joints do not form a chain.
    #[error("{file}: {source}")]
    Chain {
        /// The file.
        file: String,
        /// Why.
        source: crate::chain::ChainError,
    },
}

/// What a planar joint's three parts are called, behind its name.
const PLANAR_PARTS: [&str; 3] = ["_x", "_y", "_yaw"];

/// A step on the path from base to tip: a joint, and whether it is passed from child to parent.
#[derive(Clone, Copy)]
struct Step {
    joint: usize,
    upwards: bool,
}

impl Robot {
    /// Every chain from the root (or from below the last floating joint on the way) to a leaf link, in file order.
    pub fn leaf_chains(&self) -> Vec<ChainListing> {
        let placed = PlacedRobot::new(self, Reading::AsWritten);
        self.leaves().into_iter().map(|leaf| listing(&placed, leaf)).collect()
    }

    /// The default chain: most coordinates, then most links, then first in the file; an arm that
    /// carries a hand ends at its tool frame or flange, not at a finger.
    pub fn default_chain(&self) -> ChainListing {
        let placed = PlacedRobot::new(self, Reading::AsWritten);
        listing(&placed, default_tip(&placed, None).0)
    }

    /// The chain with the most coordinates, then the most links, then first in the file; it ends at a finger where the arm carries a
    /// hand.
    pub fn longest_chain(&self) -> ChainListing {
        let placed = PlacedRobot::new(self, Reading::AsWritten);
        listing(&placed, longest_leaf(&placed))
    }

    /// The chain from `base` to `tip`; where they are not named, those of [`Robot::default_chain`].
    ///
    /// Fixed joints are folded in. A mimic joint (also of a mimic joint, also of one outside the chain) is moved by its
    /// driver's coordinate. A turn and a slide of one coordinate along one axis are one helical joint. A planar joint
    /// becomes two prismatic joints and a revolute joint. A chain may run up the tree and down again; joints passed from child to parent
    /// have scale -1. For many chains of one robot: [`PlacedRobot::chain`].
    ///
    /// # Errors
    /// A link or a mimic joint's driver does not exist, or a floating or unknown joint lies in between.
    pub fn chain(&self, base: Option<&str>, tip: Option<&str>, reading: Reading) -> Result<Noted<Chain>, TreeError> {
        PlacedRobot::new(self, reading).chain(base, tip)
    }

    fn named_link(&self, name: &str) -> Result<usize, TreeError> {
        self.link_index(name).ok_or_else(|| TreeError::NoSuchLink {
            file: self.source.file.clone(),
            name: name.to_owned(),
            near: nearest_name(name, self.links.iter().map(|link| link.name.as_str())).map(str::to_owned),
        })
    }
}

/// As [`Robot::chain`].
pub(crate) fn chain(placed: &PlacedRobot, base: Option<&str>, tip: Option<&str>) -> Result<Noted<Chain>, TreeError> {
    let robot = placed.robot();
    let base_link = base.map(|name| robot.named_link(name)).transpose()?;
    let (tip_link, finger) = match tip {
        Some(name) => (robot.named_link(name)?, None),
        None => default_tip(placed, base_link),
    };
    let base_link = base_link.unwrap_or_else(|| start_below_floating(placed, tip_link));
    let steps = way(placed, base_link, tip_link);
    let mut read = Assembly::new(placed).walk(base_link, tip_link, &steps)?;
    let name = |link: usize| robot.links[link].name.clone();
    read.notes.extend(finger.map(|finger| Note::EndsAtTool { tip: name(tip_link), finger: name(finger) }));
    Ok(read)
}

/// The tip of the default chain, and, where the arm carries a hand, the finger at which the longest chain would end.
fn default_tip(placed: &PlacedRobot, base: Option<usize>) -> (usize, Option<usize>) {
    let leaf = base.map_or_else(|| longest_leaf(placed), |base| farthest_below(placed, base));
    let start = base.unwrap_or_else(|| start_below_floating(placed, leaf));
    match hand::tool_above_fingers(placed, &way(placed, start, leaf)) {
        Some(tool) => (tool, Some(leaf)),
        None => (leaf, None),
    }
}

fn listing(placed: &PlacedRobot, leaf: usize) -> ChainListing {
    let robot = placed.robot();
    let base = start_below_floating(placed, leaf);
    let steps = way(placed, base, leaf);
    let mut coordinates: Vec<String> = Vec::new();
    let mut known: HashSet<String> = HashSet::new();
    for step in &steps {
        let name = &robot.joints[mover(placed, step.joint)].name;
        let names: Vec<String> = match robot.joints[step.joint].kind {
            JointKind::Fixed => Vec::new(),
            JointKind::Planar => PLANAR_PARTS.iter().map(|part| format!("{name}{part}")).collect(),
            _ => vec![name.clone()],
        };
        for name in names {
            if known.insert(name.clone()) {
                coordinates.push(name);
            }
        }
    }
    let name = |link: usize| robot.links[link].name.clone();
    ChainListing { base: name(base), tip: name(leaf), coordinates, links: steps.len() + 1 }
}

/// The joint whose value moves a joint; the joint itself where none does.
fn mover(placed: &PlacedRobot, joint: usize) -> usize {
    placed.driver(joint).unwrap_or(joint)
}

/// The leaf with the most coordinates on the way to it, then the most links, then first in the file.
fn longest_leaf(placed: &PlacedRobot) -> usize {
    /// The counts before a link was entered, restored when it is left.
    enum Visit {
        Enter(usize),
        Leave { counted: Option<usize>, coordinates: usize, links: usize },
    }
    let robot = placed.robot();
    let mut best: Option<((usize, usize), usize)> = None;
    // How often each joint moves something on the path to here, below the last floating joint: counts of an older
    // stretch are of another generation.
    let mut uses: Vec<HashMap<usize, usize>> = vec![HashMap::new()];
    let (mut coordinates, mut links) = (0, 1);
    let mut open = vec![Visit::Enter(robot.root)];
    while let Some(visit) = open.pop() {
        let link = match visit {
            Visit::Enter(link) => link,
            Visit::Leave { counted, coordinates: before, links: above } => {
                (coordinates, links) = (before, above);
                match counted {
                    Some(joint) if joint == usize::MAX => drop(uses.pop()),
                    Some(joint) => {
                        if let Some(count) = uses.last_mut().and_then(|uses| uses.get_mut(&joint)) {
                            *count -= 1;
                        }
                    }
                    None => {}
                }
                continue;
            }
        };
        let before = (coordinates, links);
        let mut counted = None;
        if let Some(index) = placed.carrier(link) {
            links += 1;
            match robot.joints[index].kind {
                JointKind::Floating => {
                    (coordinates, links) = (0, 1);
                    uses.push(HashMap::new());
                    counted = Some(usize::MAX);
                }
                JointKind::Fixed => {}
                ref kind => {
                    let joint = mover(placed, index);
                    let parts = if *kind == JointKind::Planar { PLANAR_PARTS.len() } else { 1 };
                    if let Some(uses) = uses.last_mut() {
                        let count = uses.entry(joint).or_insert(0);
                        coordinates += if *count == 0 { parts } else { 0 };
                        *count += 1;
                    }
                    counted = Some(joint);
                }
            }
        }
        if placed.carried(link).is_empty() {
            let found = ((coordinates, links), link);
            let better =
                |(length, first): ((usize, usize), usize)| found.0 > length || found.0 == length && link < first;
            if best.is_none_or(better) {
                best = Some(found);
            }
        }
        open.push(Visit::Leave { counted, coordinates: before.0, links: before.1 });
        open.extend(placed.carried(link).iter().map(|joint| Visit::Enter(robot.joints[*joint].child)));
    }
    best.map_or(robot.root, |(_, link)| link)
}

/// The link to start at on the way from the root to `tip`: below the last joint that no chain can hold.
fn start_below_floating(placed: &PlacedRobot, tip: usize) -> usize {
    let mut at = tip;
    while let Some(joint) = placed.carrier(at).map(|joint| &placed.robot().joints[joint]) {
        if joint.kind == JointKind::Floating {
            break;
        }
        at = joint.parent;
    }
    at
}

/// The link below `base` with the most moving joints on the way to it, then the most links, then first in the file.
fn farthest_below(placed: &PlacedRobot, base: usize) -> usize {
    let robot = placed.robot();
    let mut best = ((0, 0), base);
    let mut open = vec![(base, (0, 0))];
    while let Some((link, length)) = open.pop() {
        if length > best.0 || length == best.0 && link < best.1 {
            best = (length, link);
        }
        let below = placed.carried(link).iter().map(|joint| &robot.joints[*joint]);
        open.extend(below.map(|joint| (joint.child, (length.0 + usize::from(joint.kind.moves()), length.1 + 1))));
    }
    best.1
}

fn way(placed: &PlacedRobot, base: usize, tip: usize) -> Vec<Step> {
    let upwards = |mut link: usize| {
        let mut way = Vec::new();
        while let Some(joint) = placed.carrier(link) {
            way.push(joint);
            link = placed.robot().joints[joint].parent;
        }
        way
    };
    let (mut up, mut down) = (upwards(base), upwards(tip));
    while let (Some(a), Some(b)) = (up.last(), down.last()) {
        if a != b {
            break;
        }
        up.pop();
        down.pop();
    }
    let up = up.into_iter().map(|joint| Step { joint, upwards: true });
    up.chain(down.into_iter().rev().map(|joint| Step { joint, upwards: false })).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::se3;
    use crate::urdf;
    use nalgebra::Vector3;

    fn robot(body: &str) -> Robot {
        urdf::read("test.urdf", &format!("<robot name=\"test\">{body}</robot>")).unwrap()
    }

    const SPLINE: &str = r#"<link name="base"/><link name="a"/><link name="b"/><link name="tip"/>
        <joint name="turn" type="revolute"><origin xyz="1 0 0"/><axis xyz="0 0 2"/><parent link="base"/><child link="a"/>
          <limit lower="-2" upper="2"/></joint>
        <joint name="slide" type="prismatic"><axis xyz="0 0 -1"/><parent link="a"/><child link="b"/>
          <mimic joint="turn" multiplier="0.25" offset="0.5"/></joint>
        <joint name="flange" type="fixed"><origin xyz="0 0 0.1"/><parent link="b"/><child link="tip"/></joint>"#;

    #[test]
    fn a_turn_and_its_slide_are_one_helical_joint() {
        let chain = robot(SPLINE).chain(None, None, Reading::Intended).unwrap().value;
        assert_eq!(chain.joints().len(), 1);
        assert_eq!(chain.joints()[0].screw.pitch(), Some(-0.25));
        let at = chain.fk(&[1.0]).translation.vector;
        assert!((at - Vector3::new(1.0, 0.0, 0.1 - 0.75)).norm() < 1e-15, "{at}");
    }

    #[test]
    fn a_chain_up_the_tree_is_the_inverse() {
        let robot = robot(SPLINE);
        let down = robot.chain(Some("base"), Some("tip"), Reading::Intended).unwrap().value;
        let up = robot.chain(Some("tip"), Some("base"), Reading::Intended).unwrap().value;
        let (turned, moved) = se3::difference(&up.fk(&[0.7]), &down.fk(&[0.7]).inverse());
        assert!(turned < 1e-15 && moved < 1e-15, "{turned} {moved}");
    }

    #[test]
    fn chained_mimic_joints_follow_the_free_one() {
        let robot = robot(
            r#"<link name="l0"/><link name="l1"/><link name="l2"/><link name="l3"/>
            <joint name="a" type="revolute"><axis xyz="0 0 1"/><parent link="l0"/><child link="l1"/></joint>
            <joint name="b" type="revolute"><axis xyz="0 0 1"/><parent link="l1"/><child link="l2"/><mimic joint="a" multiplier="2" offset="0.1"/></joint>
            <joint name="c" type="revolute"><axis xyz="0 0 1"/><parent link="l2"/><child link="l3"/><mimic joint="b" multiplier="-1"/></joint>"#,
        );
        let chain = robot.chain(None, None, Reading::Intended).unwrap().value;
        assert_eq!(chain.coordinates().len(), 1);
        let angle = se3::rotation_vector(&chain.fk(&[0.3]).rotation).z;
        assert!((angle - 0.3).abs() < 1e-15, "{angle}");
    }

    #[test]
    fn planar_joints_split_and_floating_ones_end_a_chain() {
        let robot = robot(
            r#"<link name="world"/><link name="body"/><link name="foot"/>
            <joint name="free" type="floating"><parent link="world"/><child link="body"/></joint>
            <joint name="skate" type="planar"><axis xyz="0 0 1"/><parent link="body"/><child link="foot"/></joint>"#,
        );
        let chain = robot.chain(None, None, Reading::Intended).unwrap();
        assert_eq!(chain.value.base(), "body");
        let at = chain.value.fk(&[0.1, 0.2, 0.3]).translation.vector;
        assert_eq!(at, Vector3::new(0.1, 0.2, 0.0));
        let error = robot.chain(Some("world"), Some("foot"), Reading::Intended).unwrap_err();
        assert_eq!(
            error.to_string(),
            "test.urdf:2: joint \"free\": a floating joint is in the chain; choose ‹base› \"body\" to start after it, \
             or ‹tip› \"world\" to end before it"
        );
    }

    #[test]
    fn intended_angles_are_read_and_noted() {
        let robot = robot(
            r#"<link name="base"/><link name="arm"/><link name="tip"/>
            <joint name="j" type="revolute"><origin xyz="0 0 1" rpy="1.57 0 0"/><axis xyz="0 0 1"/><parent link="base"/><child link="arm"/></joint>
            <joint name="k" type="fixed"><origin xyz="0.5 0 0"/><parent link="arm"/><child link="tip"/></joint>"#,
        );
        let read = robot.chain(None, None, Reading::Intended).unwrap();
        let [Note::IntendedAngle { tip_moves, .. }] = &read.notes[..] else { panic!("{:?}", read.notes) };
        let written = robot.chain(None, None, Reading::AsWritten).unwrap();
        let largest = (0..100u32)
            .map(|k| se3::difference(&read.value.fk(&[0.1 * f64::from(k)]), &written.value.fk(&[0.1 * f64::from(k)])).1)
            .fold(0.0, f64::max);
        assert!(largest <= *tip_moves && largest > 0.9 * tip_moves, "{largest} {tip_moves}");
        assert!(written.notes.is_empty());
    }

    /// Links one behind the other, every second joint turning, its angles as people write them, every fourth a mimic.
    fn deep_chain(links: usize) -> String {
        let joint = |k: usize| {
            let (kind, above) = (if k.is_multiple_of(2) { "revolute" } else { "fixed" }, k - 1);
            let mimic = if k.is_multiple_of(4) { "<mimic joint=\"j2\"/>" } else { "" };
            format!(
                "<link name=\"l{k}\"/><joint name=\"j{k}\" type=\"{kind}\"><origin xyz=\"0 0 0.001\" rpy=\"1.5708 0 0\"/>\
                 <parent link=\"l{above}\"/><child link=\"l{k}\"/><limit lower=\"-1\" upper=\"1\"/>{mimic}</joint>\n"
            )
        };
        let joints: String = (1..links).map(joint).collect();
        format!("<robot name=\"deep\">\n<link name=\"l0\"/>\n{joints}</robot>")
    }

    /// Looking up each link, joint, name or line among all of them would take 10^10 steps here, and never end in a debug build.
    #[test]
    fn a_chain_of_a_hundred_thousand_links_is_read() {
        let links = 100_000;
        let robot = urdf::read("deep.urdf", &deep_chain(links)).unwrap();
        let read = robot.chain(None, None, Reading::Intended).unwrap();
        assert_eq!(read.value.joints().len(), (links - 1) / 2);
        assert_eq!(read.value.coordinates().len(), links / 4);
        assert_eq!(read.notes.len(), links - 1);
        let Some(Note::IntendedAngle { place, .. }) = read.notes.last() else { panic!("{:?}", read.notes.last()) };
        assert_eq!(place.line, links + 1);
    }

    #[test]
    fn mimic_loops_and_unknown_drivers_are_named() {
        let looped = robot(
            r#"<link name="l0"/><link name="l1"/><link name="l2"/>
            <joint name="a" type="revolute"><parent link="l0"/><child link="l1"/><mimic joint="b"/></joint>
            <joint name="b" type="revolute"><parent link="l1"/><child link="l2"/><mimic joint="a"/></joint>"#,
        );
        let message = looped.chain(None, None, Reading::Intended).unwrap_err().to_string();
        assert_eq!(
            message,
            "test.urdf:2: joint \"a\": it cannot mimic joint \"b\": the two follow each other; free one of them"
        );
        let lost = robot(
            r#"<link name="l0"/><link name="l1"/><joint name="finger" type="revolute"><parent link="l0"/><child link="l1"/><mimic joint="fingr"/></joint>"#,
        );
        let message = lost.chain(None, None, Reading::Intended).unwrap_err().to_string();
        assert_eq!(
            message,
            "test.urdf:1: joint \"finger\": it mimics joint \"fingr\", which does not exist; did you mean \"finger\"?"
        );
    }
}
