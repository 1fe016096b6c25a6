//! Transmissions, controllers' and simulators' settings that name a link or joint that does not exist.

use crate::lint::finding::Found;
use crate::lint::{Rule, Sheet};
use crate::report::Level;
use denavit_model::problems::nearest_name;
use roxmltree::Node;
use std::collections::HashSet;

pub(in crate::lint) const RULE: Rule = Rule {
    code: "D042",
    name: "dangling-reference",
    level: Level::Warning,
    summary: "A transmission, `<ros2_control>`, `<gazebo>`, a closed loop or an SRDF names a link or joint that does not exist",
    why: "Controllers then fail at start; simulators and planners silently ignore the setting. Often a joint was \
          renamed, or got a prefix, in only one of the two places. An SRDF is checked against the robot of the same \
          name that is checked with it: `denavit check arm.urdf arm.srdf`.",
    bad: "<link name=\"base\"/>\n<link name=\"arm\"/>\n<joint name=\"shoulder\" type=\"continuous\">\n  <axis xyz=\"0 0 1\"/>\n  <parent link=\"base\"/>\n  <child link=\"arm\"/>\n</joint>\n<transmission name=\"t\">\n  <joint name=\"sholder\"/>\n</transmission>",
    good: "<link name=\"base\"/>\n<link name=\"arm\"/>\n<joint name=\"shoulder\" type=\"continuous\">\n  <axis xyz=\"0 0 1\"/>\n  <parent link=\"base\"/>\n  <child link=\"arm\"/>\n</joint>\n<transmission name=\"t\">\n  <joint name=\"shoulder\"/>\n</transmission>",
    fixable: false,
    check,
};

/// What a reference is meant to name.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(in crate::lint) enum Target {
    Link,
    Joint,
    Either,
}

impl Target {
    fn word(self) -> &'static str {
        match self {
            Self::Link => "link",
            Self::Joint => "joint",
            Self::Either => "link or joint",
        }
    }
}

/// The names that a reference may have.
pub(in crate::lint) struct Names<'a> {
    links: HashSet<&'a str>,
    joints: HashSet<&'a str>,
}

impl<'a> Names<'a> {
    pub fn of(robot: &'a denavit_model::Robot) -> Self {
        Self {
            links: robot.links.iter().map(|link| link.name.as_str()).collect(),
            joints: robot.joints.iter().map(|joint| joint.name.as_str()).collect(),
        }
    }

    /// Links and joints that exist in a simulator only: those inside `<gazebo>`.
    fn add_simulated(&mut self, sheet: &'a Sheet) {
        let simulated = sheet.elements().filter(|node| within(*node, "gazebo"));
        for node in simulated {
            let Some(name) = node.attribute("name") else { continue };
            let has = |tag: &str| node.children().any(|child| child.tag_name().name() == tag);
            match node.tag_name().name() {
                "joint" if has("parent") && has("child") => drop(self.joints.insert(name)),
                "link" => drop(self.links.insert(name)),
                _ => {}
            }
        }
    }

    /// What is wrong with a reference, a clause; `None` where the robot has what it names, or where it is not yet expanded.
    pub fn dangling(&self, name: &str, target: Target) -> Option<String> {
        let name = name.trim();
        let (link, joint) = (self.links.contains(name), self.joints.contains(name));
        let known = match target {
            Target::Link => link,
            Target::Joint => joint,
            Target::Either => link || joint,
        };
        if known || name.contains("${") || name.contains("$(") {
            return None;
        }
        let word = target.word();
        if name.is_empty() {
            return Some(format!("names no {word}"));
        }
        let what = format!("{word} \"{name}\" does not exist");
        if link || joint {
            let other = if link { "link" } else { "joint" };
            return Some(format!("{what}; a {other} has that name"));
        }
        let mut candidates: Vec<&str> = match target {
            Target::Link => self.links.iter().copied().collect(),
            Target::Joint => self.joints.iter().copied().collect(),
            Target::Either => self.links.union(&self.joints).copied().collect(),
        };
        candidates.sort_unstable();
        // A prefix that only one of the two got.
        let with_prefix = || candidates.iter().copied().find(|other| other.ends_with(name) || name.ends_with(other));
        let near = nearest_name(name, candidates.iter().copied()).or_else(with_prefix);
        Some(near.map_or_else(|| what.clone(), |near| format!("{what}; did you mean \"{near}\"?")))
    }
}

fn check(sheet: &Sheet) -> Vec<Found> {
    let Some(robot) = sheet.robot() else { return Vec::new() };
    let mut names = Names::of(robot);
    names.add_simulated(sheet);
    let beside = sheet.root().into_iter().flat_map(|root| root.children().filter(Node::is_element));
    let mut found = Vec::new();
    for top in beside.filter(|node| !["link", "joint", "material"].contains(&node.tag_name().name())) {
        for node in top.descendants().filter(Node::is_element) {
            for (name, target) in references(top, node) {
                if let Some(what) = names.dangling(name, target) {
                    found.push(Found::at(node.range().start, label(top), what));
                }
            }
        }
    }
    found
}

/// The names that a part of an element other than link or joint refers to.
fn references<'a>(top: Node<'a, '_>, node: Node<'a, '_>) -> Vec<(&'a str, Target)> {
    let tag = node.tag_name().name();
    let named = |target| node.attribute("name").map(|name| (name, target)).into_iter().collect();
    let text = |target| {
        let text = node.text().map(str::trim).filter(|text| !text.is_empty() && !text.contains("::"));
        text.map(|text| (text, target)).into_iter().collect()
    };
    let parent = node.parent_element().map_or("", |parent| parent.tag_name().name());
    match top.tag_name().name() {
        "gazebo" if node == top => top.attribute("reference").map(|name| (name, Target::Either)).into_iter().collect(),
        // A plugin's own words are its own, but these mean a joint in all of them.
        "gazebo" if JOINT_WORDS.contains(&tag) && within(node, "plugin") => text(Target::Joint),
        "transmission" if node != top && tag.to_ascii_lowercase().ends_with("joint") => named(Target::Joint),
        "ros2_control" if tag == "joint" && ["ros2_control", "transmission"].contains(&parent) => named(Target::Joint),
        "ros2_control" if tag == "param" && parent == "joint" && node.attribute("name") == Some("mimic") => {
            text(Target::Joint)
        }
        "gazebo" | "mujoco" | "transmission" | "ros2_control" => Vec::new(),
        _ => {
            let attributes = node.attributes().filter(|attribute| attribute.value() != "world");
            let meant = attributes.filter_map(|attribute| match attribute.name() {
                "link" | "link1" | "link2" => Some((attribute.value(), Target::Link)),
                "joint" => Some((attribute.value(), Target::Joint)),
                _ => None,
            });
            meant.collect()
        }
    }
}

/// Elements whose text is the name of a joint in any simulator plugin.
const JOINT_WORDS: [&str; 8] =
    ["joint_name", "jointName", "left_joint", "right_joint", "leftJoint", "rightJoint", "mimicJoint", "mimic_joint"];

fn within(node: Node, tag: &str) -> bool {
    node.ancestors().skip(1).any(|above| above.tag_name().name() == tag)
}

/// `transmission "elbow"`, `gazebo of "forearm"`, or the tag alone.
pub(in crate::lint) fn label(node: Node) -> String {
    let tag = node.tag_name().name();
    match (node.attribute("name"), node.attribute("reference")) {
        (Some(name), _) => format!("{tag} \"{name}\""),
        (None, Some(link)) => format!("{tag} of \"{link}\""),
        (None, None) => tag.to_owned(),
    }
}
