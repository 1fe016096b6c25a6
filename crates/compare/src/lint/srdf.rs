//! SRDF, MoveIt's companion of a URDF: the names in it must exist in the robot; what is not understood is reported.
//!
//! # Source
//! <https://wiki.ros.org/srdf> and the elements that srdfdom 2.0 reads.

use crate::lint::rules::dangling_reference::{self, Names, Target, label};
use crate::lint::rules::{not_understood, unreadable};
use crate::lint::{Config, Finding, Rule};
use denavit_model::robot::SourceText;
use denavit_model::{Inventory, Robot};
use roxmltree::{Document, Node, ParsingOptions};
use std::collections::HashSet;

/// An element of SRDF: its parent, its attributes, and which of them are names of what.
struct Known {
    tag: &'static str,
    parent: &'static str,
    attributes: &'static [&'static str],
    names: &'static [(&'static str, Named)],
}

/// What an attribute names.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Named {
    Link,
    /// A joint of the robot, or a virtual joint.
    Joint,
    Group,
}

const LINKS: &[(&str, Named)] = &[("link1", Named::Link), ("link2", Named::Link)];

static KNOWN: &[Known] = &[
    Known { tag: "robot", parent: "", attributes: &["name", "version"], names: &[] },
    Known {
        tag: "virtual_joint",
        parent: "robot",
        attributes: &["name", "type", "parent_frame", "child_link"],
        names: &[("child_link", Named::Link)],
    },
    Known { tag: "group", parent: "robot", attributes: &["name"], names: &[] },
    Known { tag: "group", parent: "group", attributes: &["name"], names: &[("name", Named::Group)] },
    Known { tag: "link", parent: "group", attributes: &["name"], names: &[("name", Named::Link)] },
    Known { tag: "joint", parent: "group", attributes: &["name"], names: &[("name", Named::Joint)] },
    Known { tag: "passive_joint", parent: "group", attributes: &["name"], names: &[("name", Named::Joint)] },
    Known {
        tag: "chain",
        parent: "group",
        attributes: &["base_link", "tip_link"],
        names: &[("base_link", Named::Link), ("tip_link", Named::Link)],
    },
    Known { tag: "group_state", parent: "robot", attributes: &["name", "group"], names: &[("group", Named::Group)] },
    Known { tag: "joint", parent: "group_state", attributes: &["name", "value"], names: &[("name", Named::Joint)] },
    Known {
        tag: "end_effector",
        parent: "robot",
        attributes: &["name", "group", "parent_link", "parent_group"],
        names: &[("group", Named::Group), ("parent_link", Named::Link), ("parent_group", Named::Group)],
    },
    Known { tag: "link_sphere_approximation", parent: "robot", attributes: &["link"], names: &[("link", Named::Link)] },
    Known { tag: "sphere", parent: "link_sphere_approximation", attributes: &["center", "radius"], names: &[] },
    Known { tag: "disable_collisions", parent: "robot", attributes: &["link1", "link2", "reason"], names: LINKS },
    Known { tag: "enable_collisions", parent: "robot", attributes: &["link1", "link2", "reason"], names: LINKS },
    Known {
        tag: "disable_default_collisions",
        parent: "robot",
        attributes: &["link"],
        names: &[("link", Named::Link)],
    },
    Known { tag: "passive_joint", parent: "robot", attributes: &["name"], names: &[("name", Named::Joint)] },
    Known {
        tag: "joint_property",
        parent: "robot",
        attributes: &["joint_name", "property_name", "value"],
        names: &[("joint_name", Named::Joint)],
    },
];

/// The allowed children of an SRDF element, by its tag.
pub fn children_of(parent: &str) -> Vec<&'static str> {
    KNOWN.iter().filter(|known| known.parent == parent).map(|known| known.tag).collect()
}

/// The attributes of an element of an SRDF, by its tag and that of the element around it.
pub fn attributes_of(tag: &str, parent: &str) -> &'static [&'static str] {
    KNOWN.iter().find(|known| known.tag == tag && known.parent == parent).map_or(&[], |known| known.attributes)
}

/// Whether a source is an SRDF: by its name, or as a `<robot>` without links but with groups and the like.
pub fn is_srdf(file: &str, text: &str) -> bool {
    let name = file.to_ascii_lowercase();
    let name = name.strip_suffix(" (expanded)").unwrap_or(&name);
    if [".srdf", ".srdf.xacro"].iter().any(|end| name.ends_with(end)) {
        return true;
    }
    // Most files can be distinguished from URDF without reading them.
    if !text.contains("<group") && !text.contains("collisions") && !text.contains("<virtual_joint") {
        return false;
    }
    let Ok(document) = parsed(text) else { return false };
    let root = document.root_element();
    let has = |tags: &[&str]| root.children().any(|node| tags.contains(&node.tag_name().name()));
    root.tag_name().name() == "robot"
        && !has(&["link", "joint"])
        && has(&["group", "group_state", "disable_collisions", "virtual_joint", "end_effector"])
}

fn parsed(text: &str) -> Result<Document<'_>, roxmltree::Error> {
    let options = ParsingOptions { allow_dtd: true, ..ParsingOptions::default() };
    Document::parse_with_options(text.trim_start_matches('\u{feff}'), options)
}

/// The name of the robot that an SRDF is for; `None` where it gives none.
pub fn robot_of(text: &str) -> Option<String> {
    Some(parsed(text).ok()?.root_element().attribute("name")?.to_owned())
}

/// The findings in an SRDF that belongs to `robot`, in the order of the lines, and its inventory.
///
/// # Examples
/// ```
/// use denavit_compare::lint::{Config, srdf};
/// let robot = denavit_model::urdf::read("arm.urdf", r#"<robot name="arm"><link name="base"/></robot>"#)?;
/// let text = r#"<robot name="arm"><group name="g"><link name="bsae"/></group></robot>"#;
/// let (findings, _) = srdf::check("arm.srdf", text, &robot, &Config::default());
/// assert_eq!(
///     findings[0].to_string(),
///     "arm.srdf:1: D042 group \"g\": link \"bsae\" does not exist; did you mean \"base\"?"
/// );
/// # Ok::<(), denavit_model::UrdfError>(())
/// ```
pub fn check(file: &str, text: &str, robot: &Robot, config: &Config) -> (Vec<Finding>, Inventory) {
    let text = text.trim_start_matches('\u{feff}');
    let source = SourceText::new(file, text);
    let mut findings = Findings { source: &source, config, found: Vec::new(), inventory: Inventory::default() };
    match parsed(text) {
        Ok(document) => findings.document(&document, robot),
        Err(error) => {
            let line = error.pos().row as usize;
            let at = text.match_indices('\n').nth(line.saturating_sub(2)).map_or(0, |(at, _)| at + 1);
            let at = if line <= 1 { 0 } else { at };
            findings.add(&unreadable::RULE, at, "file", format!("not well-formed XML: {error}"));
        }
    }
    let Findings { mut found, inventory, .. } = findings;
    found.sort_by_key(|finding| finding.place.line);
    (found, inventory)
}

struct Findings<'a> {
    source: &'a SourceText,
    config: &'a Config,
    found: Vec<Finding>,
    inventory: Inventory,
}

impl Findings<'_> {
    fn add(&mut self, rule: &Rule, at: usize, element: impl Into<String>, message: impl Into<String>) {
        let Some(level) = self.config.level_of(rule) else { return };
        let place = self.source.place(at, element);
        self.found.push(Finding { rule: rule.code, level, place, message: message.into(), fix: Vec::new() });
    }

    fn not_understood(&mut self, at: usize, element: String, what: &str) {
        let message = format!("{what} is not understood and was not checked; remove it, or correct its name");
        self.add(&not_understood::RULE, at, element.clone(), message);
        self.inventory.report(self.source.place(at, element), what);
    }

    fn document(&mut self, document: &Document, robot: &Robot) {
        let root = document.root_element();
        if root.tag_name().name() != "robot" {
            let message = format!("the root element is <{}>, not <robot>: this is not an SRDF", root.tag_name().name());
            self.add(&unreadable::RULE, root.range().start, "file", message);
            return;
        }
        let name = root.attribute("name").unwrap_or_default();
        if name != robot.name {
            let what = format!(
                "it is for robot \"{name}\", but the robot's name is \"{}\": planners refuse such a pair; write the \
                 robot's name",
                robot.name
            );
            self.add(&dangling_reference::RULE, root.range().start, "robot", what);
        }
        let names = Names::of(robot);
        let named = |tag: &str| -> HashSet<&str> {
            let found = root.children().filter(|node| node.tag_name().name() == tag);
            found.filter_map(|node| node.attribute("name")).collect()
        };
        let (groups, virtual_joints) = (named("group"), named("virtual_joint"));
        let mut open = vec![(root, "")];
        while let Some((node, parent)) = open.pop() {
            let tag = node.tag_name().name();
            let owner = owner(node);
            let Some(known) = KNOWN.iter().find(|known| known.tag == tag && known.parent == parent) else {
                self.not_understood(node.range().start, owner, &format!("<{tag}>"));
                continue;
            };
            self.inventory.understand();
            for attribute in node.attributes() {
                if known.attributes.contains(&attribute.name()) && attribute.namespace().is_none() {
                    self.inventory.understand();
                } else {
                    let what = format!("attribute {}=\"{}\" of <{tag}>", attribute.name(), attribute.value());
                    self.not_understood(attribute.range().start, owner.clone(), &what);
                }
            }
            for (attribute, target) in known.names {
                // Only chains, states and collisions need all of theirs; an end effector may leave out its parent group.
                let Some(name) = node.attribute(*attribute) else { continue };
                let dangling = match target {
                    Named::Link => names.dangling(name, Target::Link),
                    Named::Joint if virtual_joints.contains(name) => None,
                    Named::Joint => names.dangling(name, Target::Joint),
                    Named::Group if groups.contains(name) => None,
                    Named::Group => Some(format!("group \"{name}\" does not exist")),
                };
                if let Some(what) = dangling {
                    self.add(&dangling_reference::RULE, node.range().start, owner.clone(), what);
                }
            }
            for text in node.children().filter(Node::is_text) {
                let words = text.text().unwrap_or_default().trim();
                if !words.is_empty() {
                    let what = format!("text \"{}\" in <{tag}>", words.chars().take(60).collect::<String>());
                    self.not_understood(node.range().start, owner.clone(), &what);
                }
            }
            let children: Vec<Node> = node.children().filter(Node::is_element).collect();
            open.extend(children.into_iter().rev().map(|child| (child, known.tag)));
        }
    }
}

/// The top-level element that contains something, in words.
fn owner(node: Node) -> String {
    let top = node
        .ancestors()
        .filter(Node::is_element)
        .nth(node.ancestors().filter(Node::is_element).count().saturating_sub(2));
    let top = top.unwrap_or(node);
    let links = [top.attribute("link1"), top.attribute("link2")];
    match links {
        [Some(one), Some(other)] => format!("{} \"{one}\" \"{other}\"", top.tag_name().name()),
        _ => label(top),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use denavit_model::{Outcome, urdf};

    const ROBOT: &str = r#"<robot name="arm"><link name="base"/><link name="tip"/>
        <joint name="j" type="continuous"><parent link="base"/><child link="tip"/></joint></robot>"#;

    /// Every element that is known.
    const WHOLE: &str = r#"<robot name="arm" version="1.0">
        <virtual_joint name="v" type="fixed" parent_frame="world" child_link="base"/>
        <group name="g"><link name="base"/><joint name="j"/><passive_joint name="j"/><chain base_link="base" tip_link="tip"/></group>
        <group name="h"><group name="g"/></group>
        <group_state name="s" group="g"><joint name="j" value="0"/></group_state>
        <end_effector name="e" group="h" parent_link="tip" parent_group="g"/>
        <link_sphere_approximation link="tip"><sphere center="0 0 0" radius="1"/></link_sphere_approximation>
        <disable_collisions link1="base" link2="tip" reason="Adjacent"/>
        <enable_collisions link1="base" link2="tip"/>
        <disable_default_collisions link="tip"/>
        <passive_joint name="v"/>
        <joint_property joint_name="j" property_name="p" value="1"/>
        </robot>"#;

    fn check(text: &str) -> (Vec<Finding>, Inventory) {
        super::check("arm.srdf", text, &urdf::read("arm.urdf", ROBOT).unwrap(), &Config::default())
    }

    #[test]
    fn everything_known_is_understood_and_something_unknown_in_every_position_is_said() {
        let (findings, inventory) = check(WHOLE);
        assert_eq!(findings, []);
        assert_eq!((inventory.understood, inventory.items.len()), (54, 0));
        let document = parsed(WHOLE).unwrap();
        for node in document.descendants().filter(Node::is_element) {
            let at = node.range().start + 1 + node.tag_name().name().len();
            let end = node.range().start + WHOLE[node.range()].find('>').unwrap();
            let attribute = format!("{} odd=\"1\"{}", &WHOLE[..at], &WHOLE[at..]);
            let tag = node.tag_name().name();
            let content = |inner: &str| match WHOLE[..end].strip_suffix('/') {
                Some(open) => format!("{open}>{inner}</{tag}>{}", &WHOLE[end + 1..]),
                None => format!("{}>{inner}{}", &WHOLE[..end], &WHOLE[end + 1..]),
            };
            for text in [attribute, content("<odd/>"), content("odd words")] {
                let (findings, inventory) = check(&text);
                assert!(findings.len() == 1 && findings[0].message.contains("odd"), "{findings:?}\n{text}");
                assert_eq!(inventory.count(Outcome::Reported), 1);
            }
        }
    }

    #[test]
    fn every_name_is_looked_up() {
        let document = parsed(WHOLE).unwrap();
        let mut tried = 0;
        for node in document.descendants().filter(Node::is_element) {
            let parent = node.parent_element().map_or("", |parent| parent.tag_name().name());
            let known =
                KNOWN.iter().find(|known| known.tag == node.tag_name().name() && known.parent == parent).unwrap();
            for (name, _) in known.names {
                let range = node.attribute_node(*name).unwrap().range_value();
                let text = format!("{}odd{}", &WHOLE[..range.start], &WHOLE[range.end..]);
                let (findings, _) = check(&text);
                assert!(findings.len() == 1 && findings[0].rule == "D042", "{findings:?}\n{text}");
                tried += 1;
            }
        }
        assert_eq!(tried, 20);
    }

    #[test]
    fn mutated_files_give_findings_and_no_crash() {
        let words = [
            "<",
            ">",
            "\"",
            "/",
            "<group name=\"",
            "</robot>",
            "&",
            "<!--",
            "]]>",
            "\u{e4}",
            "\0",
            "link1=\"base\"",
            "j",
            " ",
        ];
        let mut state = 34_u64;
        let mut below = |bound: usize| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            usize::try_from(state >> 33).unwrap() % bound.max(1)
        };
        let (mut read, rounds) = (0, 3000);
        for _ in 0..rounds {
            let mut bytes = WHOLE.as_bytes().to_vec();
            for _ in 0..=below(3) {
                let at = below(bytes.len());
                let length = below(12).min(bytes.len() - at);
                let word = words[below(words.len())];
                match below(3) {
                    0 => drop(bytes.drain(at..at + length)),
                    1 => drop(bytes.splice(at..at, word.bytes())),
                    _ => drop(bytes.splice(at..at + length, word.bytes())),
                }
            }
            let text = String::from_utf8_lossy(&bytes);
            let _ = (is_srdf("arm.xml", &text), robot_of(&text));
            let (findings, _) = check(&text);
            read += usize::from(findings.iter().all(|finding| finding.rule != "D001"));
            assert!(findings.iter().all(|finding| finding.place.line >= 1 && !finding.message.is_empty()));
        }
        assert!(read > rounds / 10, "{read}: only the XML reader is tested");
    }

    #[test]
    fn an_srdf_is_known_by_its_name_or_by_what_is_in_it() {
        assert!(is_srdf("a.srdf", "") && is_srdf("a.srdf.xacro (expanded)", "") && is_srdf("<stdin>", WHOLE));
        assert!(!is_srdf("a.urdf", ROBOT) && !is_srdf("a.urdf", "<robot name=\"a\"><link name=\"<group\"/></robot>"));
    }
}
