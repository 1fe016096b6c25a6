//! SRDF, MoveIt's file beside a URDF: pairs with disabled contact and named states, which MJCF states itself.
//!
//! ```text
//! SRDF <disable_collisions> ◄──► MJCF <contact><exclude>        SRDF <group_state> ◄──► MJCF <keyframe><key>
//! ```
//! # Source
//! <https://wiki.ros.org/srdf>

use denavit_model::formats::{Format, FormatError, Loss, Written};
use denavit_model::notes::Place;
use denavit_model::robot::JointKind;
use denavit_model::write::escaped;
use denavit_model::{PlacedRobot, Robot};
use roxmltree::{Document, Node, ParsingOptions};
use std::collections::HashSet;
use std::fmt::Write as _;

/// The group of all joints, for states without a group.
const ALL: &str = "all";

/// A named state of a group.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct State {
    pub name: String,
    pub group: String,
    /// Joint, value in rad or m, place.
    pub values: Vec<(String, f64, Place)>,
    pub place: Place,
}

/// The contents of an SRDF that MJCF can also state.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Srdf {
    /// Two links, and where it says so.
    pub(crate) apart: Vec<(String, String, Place)>,
    pub(crate) states: Vec<State>,
    /// What MJCF cannot state.
    pub(crate) losses: Vec<Loss>,
}

impl Srdf {
    /// Reads an SRDF.
    ///
    /// # Errors
    /// The text is not XML, or its root is not `<robot>`.
    ///
    /// # Examples
    /// ```
    /// let text = r#"<robot name="r"><disable_collisions link1="a" link2="b" reason="Never"/></robot>"#;
    /// let srdf = denavit_mjcf::Srdf::read("r.srdf", text)?;
    /// let robot = denavit_model::urdf::read("r.urdf", r#"<robot name="r"><link name="a"/><link name="b"/>
    ///   <joint name="j" type="fixed"><parent link="a"/><child link="b"/></joint></robot>"#)?;
    /// let options = denavit_mjcf::WriteOptions { fix_inertia: false, mesh: &|_| None, srdf: Some(&srdf) };
    /// assert!(denavit_mjcf::write(&robot, &options)?.text.contains("<exclude body1=\"a\" body2=\"b\"/>"));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn read(file: &str, text: &str) -> Result<Self, FormatError> {
        let at = |line: usize, element: String| Place { file: file.to_owned(), line, element };
        let options = ParsingOptions { allow_dtd: true, ..ParsingOptions::default() };
        let document = Document::parse_with_options(text.trim_start_matches('\u{feff}'), options).map_err(|error| {
            let place = at(error.pos().row as usize, "file".into());
            FormatError::one(place, format!("not well-formed XML: {error}; correct it in this line"))
        })?;
        let place = |node: Node| {
            let tag = node.tag_name().name();
            let name = node.attribute("name").map_or_else(|| format!("<{tag}>"), |name| format!("{tag} \"{name}\""));
            at(document.text_pos_at(node.range().start).row as usize, name)
        };
        let root = document.root_element();
        if root.tag_name().name() != "robot" {
            let what = "this is not an SRDF, whose root element is <robot>; give the robot's SRDF";
            return Err(FormatError::one(place(root), what));
        }
        let mut srdf = Self::default();
        for node in root.children().filter(Node::is_element) {
            let word = |name: &str| node.attribute(name).unwrap_or_default().to_owned();
            match node.tag_name().name() {
                "disable_collisions" => srdf.apart.push((word("link1"), word("link2"), place(node))),
                "group_state" => {
                    let mut values = Vec::new();
                    for joint in node.children().filter(|child| child.tag_name().name() == "joint") {
                        let name = joint.attribute("name").unwrap_or_default();
                        match joint.attribute("value").and_then(|value| value.trim().parse::<f64>().ok()) {
                            Some(value) if value.is_finite() => values.push((name.to_owned(), value, place(joint))),
                            _ => srdf.losses.push(Loss {
                                place: place(joint),
                                what: format!("value of joint \"{name}\""),
                                why: "an MJCF key has one number for each joint; write one number".into(),
                            }),
                        }
                    }
                    let state = State { name: word("name"), group: word("group"), values, place: place(node) };
                    srdf.states.push(state);
                }
                tag => {
                    let why = "MJCF has no groups of joints and no planner settings; keep the SRDF".to_owned();
                    srdf.losses.push(Loss { place: place(node), what: format!("<{tag}>"), why });
                }
            }
        }
        Ok(srdf)
    }
}

/// Layout of a robot read from MJCF in `qpos`: each joint's name, how many numbers, in MuJoCo's order.
fn layout(robot: &Robot) -> Vec<(&str, usize)> {
    let moving = robot.joints.iter().filter_map(|joint| {
        let numbers = match &joint.kind {
            JointKind::Fixed => return None,
            JointKind::Floating => 7,
            JointKind::Unknown(_) => 4,
            _ => 1,
        };
        Some((joint.name.as_str(), numbers))
    });
    moving.collect()
}

/// What a model in MJCF states that a URDF cannot and an SRDF can: pairs with disabled contact, and keys as states
/// of the group before a `/` in the key's name, else of the group of all joints.
///
/// # Errors
/// The robot was read from another format.
pub fn srdf(robot: &Robot) -> Result<Written, FormatError> {
    if robot.source.format() != Format::Mjcf {
        let place = robot.source.place(0, "robot");
        return Err(FormatError::one(place, "an SRDF is made only from MJCF; give an MJCF model"));
    }
    let mut losses = Vec::new();
    let (mut states, mut apart) = (String::new(), String::new());
    let mut groups: Vec<String> = Vec::new();
    let layout = layout(robot);
    let total: usize = layout.iter().map(|(_, numbers)| numbers).sum();
    for kept in robot.source.kept() {
        let Ok(document) = Document::parse(&kept.text) else { continue };
        let root = document.root_element();
        let Some(node) = root.first_element_child() else { continue };
        let mut lose = |what: String, why: &str| {
            losses.push(Loss { place: kept.loss.place.clone(), what, why: why.to_owned() });
        };
        match (root.tag_name().name(), node.tag_name().name()) {
            ("contact", "exclude") => {
                let body = |name: &str| node.attribute(name).unwrap_or_default();
                let (one, other) = (body("body1"), body("body2"));
                if robot.link_index(one).is_some() && robot.link_index(other).is_some() {
                    let (one, other) = (escaped(one), escaped(other));
                    let _ =
                        writeln!(apart, "  <disable_collisions link1=\"{one}\" link2=\"{other}\" reason=\"User\"/>");
                } else {
                    lose("<exclude>".into(), "it names a body that is not a link of the robot; correct the name");
                }
            }
            ("contact", tag) => lose(format!("<{tag}>"), "an SRDF has no contact parameters"),
            ("keyframe", "key") => {
                let own = node.attribute("name").unwrap_or_default();
                let name = if own.is_empty() { format!("key_{}", kept.loss.place.line) } else { own.to_owned() };
                for (attribute, why) in [
                    ("qvel", "an SRDF states no speeds"),
                    ("act", "an SRDF states no actuators"),
                    ("ctrl", "an SRDF states no actuators"),
                    ("mpos", "an SRDF states no bodies that stand by themselves"),
                    ("mquat", "an SRDF states no bodies that stand by themselves"),
                    ("time", "an SRDF states no time"),
                ] {
                    if node.attribute(attribute).is_some() {
                        lose(format!("{attribute} of key \"{name}\""), why);
                    }
                }
                let Some(written) = node.attribute("qpos") else { continue };
                let values: Option<Vec<f64>> = written.split_whitespace().map(|word| word.parse().ok()).collect();
                let Some(values) = values.filter(|values| values.len() == total) else {
                    lose(format!("key \"{name}\""), "its qpos does not have as many numbers as the joints have");
                    continue;
                };
                let (group, state) = name.split_once('/').unwrap_or((ALL, &name));
                if !groups.iter().any(|known| known == group) {
                    groups.push(group.to_owned());
                }
                let _ = writeln!(states, "  <group_state name=\"{}\" group=\"{}\">", escaped(state), escaped(group));
                let mut first = 0;
                for (joint, numbers) in &layout {
                    let own = &values[first..first + numbers];
                    first += numbers;
                    if let [value] = own {
                        let _ = writeln!(states, "    <joint name=\"{}\" value=\"{value}\"/>", escaped(joint));
                    } else if own.first() != Some(&1.0) || own.iter().skip(1).any(|number| *number != 0.0) {
                        let what = format!("joint \"{joint}\" in key \"{name}\"");
                        lose(what, "a state of an SRDF has one number for each joint");
                    }
                }
                states.push_str("  </group_state>\n");
            }
            _ => {}
        }
    }
    let mut text = format!("<?xml version=\"1.0\"?>\n<robot name=\"{}\">\n", escaped(&robot.name));
    for group in &groups {
        let _ = writeln!(text, "  <group name=\"{}\">", escaped(group));
        for (joint, _) in layout.iter().filter(|(_, numbers)| *numbers == 1) {
            let _ = writeln!(text, "    <joint name=\"{}\"/>", escaped(joint));
        }
        text.push_str("  </group>\n");
    }
    text = text + &states + &apart + "</robot>\n";
    Ok(Written { text, losses, sidecar: None, proof: Vec::new() })
}

/// The meaning of a number in `qpos`.
pub(crate) enum Slot {
    /// The value of a joint (an index), times this.
    Joint(usize, f64),
    /// Always this.
    Still(f64),
}

/// The sections of MJCF for an SRDF, and what they cannot state. `bodies` gives a link's body.
pub(crate) fn sections(
    srdf: &Srdf,
    placed: &PlacedRobot,
    slots: &[Slot],
    body: &dyn Fn(&str) -> Option<String>,
) -> (String, Vec<Loss>) {
    let robot = placed.robot();
    let mut losses = srdf.losses.clone();
    let (mut contact, mut keys) = (String::new(), String::new());
    let mut known: HashSet<[String; 2]> = HashSet::new();
    for (one, other, place) in &srdf.apart {
        let (Some(first), Some(second)) = (body(one), body(other)) else {
            let missing = if body(one).is_none() { one } else { other };
            let why = format!("link \"{missing}\" is not in the robot; correct the name");
            losses.push(Loss { place: place.clone(), what: "<disable_collisions>".into(), why });
            continue;
        };
        let mut pair = [first.clone(), second.clone()];
        pair.sort();
        // MuJoCo takes each pair once, and no body against itself.
        if first != second && known.insert(pair) {
            let _ = writeln!(contact, "    <exclude body1=\"{}\" body2=\"{}\"/>", escaped(&first), escaped(&second));
        }
    }
    let mut names: HashSet<String> = HashSet::new();
    for State { name, group, values, place } in &srdf.states {
        let mut own = vec![None; robot.joints.len()];
        for (joint, value, place) in values {
            match robot.joint_index(joint) {
                Some(index) => own[index] = Some(*value),
                None => losses.push(Loss {
                    place: place.clone(),
                    what: format!("value of joint \"{joint}\""),
                    why: "there is no such joint in the robot; correct the name".into(),
                }),
            }
        }
        let value = |joint: usize| {
            own[joint].unwrap_or_else(|| {
                placed.drive(joint).map_or(0.0, |drive| {
                    let of_driver = drive.driver.map_or(0.0, |driver| own[driver].unwrap_or(0.0));
                    of_driver * drive.scale + drive.offset
                })
            })
        };
        let qpos = slots.iter().map(|slot| match slot {
            Slot::Joint(joint, factor) => value(*joint) * factor,
            Slot::Still(number) => *number,
        });
        let qpos = crate::write::numbers(&qpos.collect::<Vec<f64>>());
        let key = if group.is_empty() || group == ALL { name.clone() } else { format!("{group}/{name}") };
        if !names.insert(key.clone()) {
            let why = "an earlier state has this group and name; keep one of them".to_owned();
            losses.push(Loss { place: place.clone(), what: format!("state \"{name}\""), why });
            continue;
        }
        let _ = writeln!(keys, "    <key name=\"{}\" qpos=\"{qpos}\"/>", escaped(&key));
    }
    let mut text = String::new();
    for (tag, inside) in [("contact", contact), ("keyframe", keys)] {
        if !inside.is_empty() {
            let _ = write!(text, "  <{tag}>\n{inside}  </{tag}>\n");
        }
    }
    (text, losses)
}
