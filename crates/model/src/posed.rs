//! Poses of everything that a file gives in a link's frame, other than visuals, collisions and inertials: sensors and
//! lights inside `<gazebo>`, offsets of plugins, `<sensor>` with an `<origin>`, frames, loop joints, friction directions.
//!
//! A link's frame can be chosen freely as long as everything in it is rewritten. Code that changes a frame, or
//! compares two robots, reads these poses by [`in_element`] and writes them by [`Posed::rewritten`], each in its own
//! notation.
//!
//! ```text
//! Element ──in_element──► Posed { node, frame, placed, notation }  ──rewritten──► Change { node, how, numbers }
//! ```

use crate::element::{Element, ElementNode};
use crate::se3::{self, Pose};
use nalgebra::{Quaternion, UnitQuaternion, Vector3};

/// Something that an element places.
#[derive(Debug, Clone, PartialEq)]
pub struct Posed {
    /// The node of [`Element::nodes`] that has the numbers; where there are none, the part that sits at its frame's origin.
    pub node: usize,
    /// Its reference frame.
    pub frame: Frame,
    /// Where it is.
    pub placed: Placed,
    /// How that is written.
    pub notation: Notation,
}

/// The reference frame of a pose.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Frame {
    /// The frame of a link, or of a joint (which is that of its child link), by name. The name may not exist.
    Named(String),
    /// The robot as a whole: the root link's frame.
    Root,
    /// The part of the element that it is in; independent of every link's frame.
    Part,
}

/// Where something is, in its frame; m, rad.
#[derive(Debug, Clone, PartialEq)]
pub enum Placed {
    /// `frame_from_part`.
    Pose(Pose),
    /// A point, m.
    Point(Vector3<f64>),
    /// A direction; its length does not matter.
    Direction(Vector3<f64>),
}

/// How a place is written.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Notation {
    /// SDF's `<pose>` in the text of `node`.
    Pose {
        /// `degrees="true"`.
        degrees: bool,
        /// `rotation_format="quat_xyzw"`: seven numbers.
        quaternion: bool,
    },
    /// The attributes `xyz` and `rpy`, or `quat_xyzw`, of `node`.
    Attributes {
        /// `quat_xyzw` stands there instead of `rpy`.
        quaternion: bool,
    },
    /// The texts of a plugin's elements, such as `<xyzOffset>` and `<rpyOffset>`; `node` is the first that is there.
    Offsets {
        /// Node of the translation.
        xyz: Option<usize>,
        /// Node of the rotation.
        rpy: Option<usize>,
    },
    /// Three numbers in the text of `node`.
    Text,
    /// Three numbers in an attribute of `node`.
    Attribute(&'static str),
    /// Not written: it is at the origin of its frame; this child of `node` would state another pose.
    Missing(&'static str),
}

/// A change of the text that puts something elsewhere.
#[derive(Debug, Clone, PartialEq)]
pub struct Change {
    /// The node of [`Element::nodes`]; nodes stand in the order of the text, so that this is the `node`-th descendant.
    pub node: usize,
    /// Where the numbers go.
    pub how: How,
    /// In the units of the file, separated by blanks.
    pub numbers: Vec<f64>,
}

/// Where numbers go.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum How {
    /// Into the node's text.
    Text,
    /// Into an attribute of the node.
    Attribute(&'static str),
    /// Into the text of a new first child `<pose>`.
    NewPose,
    /// Into the attributes `xyz` and `rpy` of a new first child `<origin>`: three numbers and three.
    NewOrigin,
    /// Into the text of a new element behind the node: a plugin's `<rpyOffset>` behind its `<xyzOffset>`, or the other way
    /// round, spelt alike.
    OtherOffset,
}

impl Posed {
    /// The nodes and attributes (`None`: the node's text, or its presence) that state only this.
    pub fn says(&self, node: usize, attribute: Option<&str>) -> bool {
        match &self.notation {
            Notation::Pose { .. } => {
                let own = ["relative_to", "frame", "degrees", "rotation_format"];
                node == self.node && attribute.is_none_or(|name| own.contains(&name))
            }
            // Frames by the attribute `link` keep it as a value: which link it is counts.
            Notation::Attributes { .. } => {
                node == self.node && attribute.is_none_or(|name| ["xyz", "rpy", "quat_xyzw"].contains(&name))
            }
            Notation::Offsets { xyz, rpy } => (*xyz == Some(node) || *rpy == Some(node)) && attribute.is_none(),
            Notation::Text => node == self.node && attribute.is_none(),
            Notation::Attribute(name) => node == self.node && attribute.is_none_or(|other| other == *name),
            Notation::Missing(_) => false,
        }
    }

    /// What to write so that it is at `placed`, in its own notation.
    pub fn rewritten(&self, placed: &Placed) -> Vec<Change> {
        let change = |node, how, numbers: &[f64]| Change { node, how, numbers: numbers.to_vec() };
        let three = |vector: &Vector3<f64>| [vector.x, vector.y, vector.z];
        let pose = match placed {
            Placed::Pose(pose) => *pose,
            Placed::Point(vector) | Placed::Direction(vector) => se3::translation(*vector),
        };
        let (xyz, rpy) = (three(&pose.translation.vector), se3::written_rpy(&pose.rotation));
        match &self.notation {
            Notation::Pose { degrees, quaternion } => {
                let turn = rotation_numbers(&pose, *degrees, *quaternion);
                vec![change(self.node, How::Text, &[&xyz[..], &turn].concat())]
            }
            Notation::Attributes { quaternion } => {
                let mut changes = vec![change(self.node, How::Attribute("xyz"), &xyz)];
                if matches!(placed, Placed::Pose(_)) {
                    let name = if *quaternion { "quat_xyzw" } else { "rpy" };
                    let turn = rotation_numbers(&pose, false, *quaternion);
                    changes.push(change(self.node, How::Attribute(name), &turn));
                }
                changes
            }
            Notation::Offsets { xyz: at, rpy: turned } => {
                let written = |node: Option<usize>, numbers: &[f64; 3]| match node {
                    Some(node) => Some(change(node, How::Text, numbers)),
                    None if *numbers == [0.0; 3] => None,
                    None => Some(change(self.node, How::OtherOffset, numbers)),
                };
                written(*at, &xyz).into_iter().chain(written(*turned, &rpy)).collect()
            }
            Notation::Text => vec![change(self.node, How::Text, &xyz)],
            Notation::Attribute(name) => vec![change(self.node, How::Attribute(name), &xyz)],
            Notation::Missing("origin") => vec![change(self.node, How::NewOrigin, &[xyz, rpy].concat())],
            Notation::Missing(_) => vec![change(self.node, How::NewPose, &[xyz, rpy].concat())],
        }
    }
}

fn rotation_numbers(pose: &Pose, degrees: bool, quaternion: bool) -> Vec<f64> {
    if quaternion {
        return se3::quaternion_xyzw(&pose.rotation).to_vec();
    }
    let rpy = se3::written_rpy(&pose.rotation);
    if degrees { rpy.map(f64::to_degrees).to_vec() } else { rpy.to_vec() }
}

/// Parts of `<gazebo reference="link">` that sit in the link's frame, with a `<pose>` or without.
const SITS: [&str; 4] = ["sensor", "light", "projector", "particle_emitter"];
/// Parts that replace what the link has unless they have a `<pose>`.
const MAY_SIT: [&str; 2] = ["visual", "collision"];
/// Elements without poses in the frames of links.
const WITHOUT_PLACES: [&str; 4] = ["transmission", "ros2_control", "material", "mujoco"];

/// No format places something deeper inside an element than this.
const DEEP: usize = 16;

/// Everything that an element places. `owner`: the link that it is in.
///
/// A malformed pose, such as a `<pose>` of five numbers, is not included and stays a text.
///
/// # Examples
/// ```
/// use denavit_model::{posed, urdf};
/// let text = r#"<robot name="r"><link name="a"/>
///   <gazebo reference="a"><sensor name="s"><pose degrees="true">1 0 0 0 0 90</pose></sensor></gazebo></robot>"#;
/// let robot = urdf::read("r.urdf", text)?;
/// let found = posed::in_element(&robot.elements[0], None);
/// assert_eq!(found[0].frame, posed::Frame::Named("a".into()));
/// assert_eq!(found[0].rewritten(&found[0].placed)[0].numbers, [1.0, 0.0, 0.0, 0.0, 0.0, 90.0]);
/// # Ok::<(), denavit_model::UrdfError>(())
/// ```
pub fn in_element(element: &Element, owner: Option<&str>) -> Vec<Posed> {
    let Some(top) = element.nodes.first() else { return Vec::new() };
    let parts = Parts { nodes: &element.nodes };
    match local(&top.tag) {
        "gazebo" => parts.in_gazebo(top.attribute("reference")),
        tag if WITHOUT_PLACES.contains(&tag) => Vec::new(),
        _ => parts.attached(owner),
    }
}

fn local(tag: &str) -> &str {
    tag.rsplit(':').next().unwrap_or(tag)
}

struct Parts<'a> {
    nodes: &'a [ElementNode],
}

impl Parts<'_> {
    /// Indices of what stands directly in a node.
    fn children(&self, node: usize) -> impl Iterator<Item = usize> + '_ {
        let depth = self.nodes[node].depth;
        let inside = self.nodes[node + 1..].iter().take_while(move |next| next.depth > depth).enumerate();
        inside.filter(move |(_, next)| next.depth == depth + 1).map(move |(offset, _)| node + 1 + offset)
    }

    fn child(&self, node: usize, tag: &str) -> Option<usize> {
        self.children(node).find(|child| local(&self.nodes[*child].tag) == tag)
    }

    fn in_gazebo(&self, reference: Option<&str>) -> Vec<Posed> {
        let link = match reference {
            Some(reference) => Frame::Named(reference.to_owned()),
            None => Frame::Root,
        };
        let mut found: Vec<Posed> = Vec::new();
        for part in self.children(0) {
            let tag = local(&self.nodes[part].tag);
            // SDF gives a joint's pose in its child link.
            let child = self.child(part, "child").filter(|_| tag == "joint" && reference.is_none());
            let link = child.map_or_else(|| link.clone(), |child| Frame::Named(self.nodes[child].text.clone()));
            let sits = reference.is_some() && SITS.contains(&tag) || child.is_some();
            let pose = self.child(part, "pose");
            match pose {
                Some(pose) if sits || MAY_SIT.contains(&tag) || reference.is_none() && tag != "plugin" => {
                    found.extend(self.pose(pose, &link));
                }
                None if sits && self.children(part).next().is_some() => found.push(missing(part, &link, "pose")),
                _ => {}
            }
            if tag == "fdir1" && reference.is_some() {
                found.extend(self.direction(part, &link));
            }
        }
        let known: Vec<usize> = found.iter().map(|posed| posed.node).collect();
        for (index, node) in self.nodes.iter().enumerate().skip(1).filter(|(_, node)| node.depth <= DEEP) {
            match local(&node.tag) {
                "plugin" => found.extend(self.offsets(index, reference)),
                // Inside a sensor or a model: in the frame of what it is in.
                "pose" if node.depth > 1 && !known.contains(&index) => found.extend(self.pose(index, &Frame::Part)),
                _ => {}
            }
        }
        found
    }

    /// SDF's `<pose>`: three lengths, then fixed-axis angles or a quaternion.
    fn pose(&self, node: usize, within: &Frame) -> Option<Posed> {
        let own = &self.nodes[node];
        let named =
            ["relative_to", "frame"].iter().find_map(|name| own.attribute(name).filter(|name| !name.is_empty()));
        let frame = match named {
            Some("world" | "__model__") => Frame::Root,
            Some(name) => Frame::Named(name.to_owned()),
            None => within.clone(),
        };
        let degrees = own.attribute("degrees").is_some_and(|value| ["true", "1"].contains(&value.trim()));
        let quaternion = own.attribute("rotation_format") == Some("quat_xyzw");
        let numbers = numbers(&own.text)?;
        let (xyz, rotation) = match numbers[..] {
            [] => ([0.0; 3], Some(se3::rotation_from_rpy([0.0; 3]))),
            [x, y, z, a, b, c] if !quaternion => {
                let rpy = if degrees { [a, b, c].map(f64::to_radians) } else { [a, b, c] };
                ([x, y, z], Some(se3::rotation_from_rpy(rpy)))
            }
            [x, y, z, a, b, c, d] if quaternion => ([x, y, z], rotation_of([a, b, c, d])),
            _ => return None,
        };
        let placed = Placed::Pose(se3::pose(rotation?, Vector3::from(xyz)));
        Some(Posed { node, frame, placed, notation: Notation::Pose { degrees, quaternion } })
    }

    /// The attributes `xyz` and `rpy` or `quat_xyzw`.
    fn origin(&self, node: usize, frame: &Frame) -> Option<Posed> {
        let own = &self.nodes[node];
        let three = |name: &str| match own.attribute(name) {
            Some(value) => <[f64; 3]>::try_from(numbers(value)?).ok(),
            None => Some([0.0; 3]),
        };
        let quaternion = own.attribute("quat_xyzw").is_some();
        let rotation = match own.attribute("quat_xyzw") {
            Some(value) => rotation_of(<[f64; 4]>::try_from(numbers(value)?).ok()?)?,
            None => se3::rotation_from_rpy(three("rpy")?),
        };
        let placed = Placed::Pose(se3::pose(rotation, Vector3::from(three("xyz")?)));
        Some(Posed { node, frame: frame.clone(), placed, notation: Notation::Attributes { quaternion } })
    }

    /// Where a plugin measures, beside the link that it names.
    fn offsets(&self, plugin: usize, reference: Option<&str>) -> Option<Posed> {
        let find = |names: &[&str]| {
            self.children(plugin).find(|child| {
                let tag = local(&self.nodes[*child].tag).replace('_', "").to_lowercase();
                names.contains(&tag.as_str())
            })
        };
        let (xyz, rpy) = (find(&["xyzoffset", "xyzoffsets"]), find(&["rpyoffset", "rpyoffsets"]));
        let node = xyz.or(rpy)?;
        let body = find(&["bodyname", "linkname"]).map(|node| self.nodes[node].text.trim());
        let link = body.or(reference.filter(|_| self.nodes[plugin].depth == 1))?;
        // Older plugins name a link by `model::link`.
        let link = link.rsplit("::").next().unwrap_or(link);
        let three = |node: Option<usize>| match node {
            Some(node) => <[f64; 3]>::try_from(numbers(&self.nodes[node].text)?).ok(),
            None => Some([0.0; 3]),
        };
        let placed = Placed::Pose(se3::pose(se3::rotation_from_rpy(three(rpy)?), Vector3::from(three(xyz)?)));
        Some(Posed { node, frame: Frame::Named(link.to_owned()), placed, notation: Notation::Offsets { xyz, rpy } })
    }

    /// A direction in the text or in the attribute `value`.
    fn direction(&self, node: usize, frame: &Frame) -> Option<Posed> {
        let own = &self.nodes[node];
        let (text, notation) = match own.attribute("value") {
            Some(value) => (value, Notation::Attribute("value")),
            None => (own.text.as_str(), Notation::Text),
        };
        let direction = Vector3::from(<[f64; 3]>::try_from(numbers(text)?).ok()?);
        let stated = direction.norm() > 0.0;
        stated.then(|| Posed { node, frame: frame.clone(), placed: Placed::Direction(direction), notation })
    }

    /// What names a link and says where in it: `<origin>` beside `<parent link>`, `<frame link xyz rpy>`, `<link1 …>`; in a
    /// link, what has an `<origin>` or a `<geometry>`.
    fn attached(&self, owner: Option<&str>) -> Vec<Posed> {
        let mut found = Vec::new();
        for (index, node) in self.nodes.iter().enumerate().filter(|(_, node)| node.depth <= DEEP) {
            let link_of = |tag: &str| {
                let node = &self.nodes[self.child(index, tag)?];
                Some(Frame::Named(node.attribute("link").unwrap_or(&node.text).to_owned()))
            };
            for (end, tag) in [("parent", "parent_origin"), ("child", "child_origin")] {
                let (link, origin) = (link_of(end), self.child(index, tag));
                found.extend(link.zip(origin).and_then(|(link, origin)| self.origin(origin, &link)));
            }
            let own = if index == 0 { owner.map(|owner| Frame::Named(owner.to_owned())) } else { None };
            let in_link = own.or_else(|| link_of("parent"));
            let origin = self.child(index, "origin");
            match (in_link, origin) {
                (Some(link), Some(origin)) => found.extend(self.origin(origin, &link)),
                (Some(link), None) => {
                    let sits = local(&node.tag) == "sensor" || self.child(index, "geometry").is_some();
                    found.extend(sits.then(|| missing(index, &link, "origin")));
                }
                _ => {}
            }
            let Some(link) = node.attribute("link").map(|link| Frame::Named(link.to_owned())) else { continue };
            let frame = matches!(local(&node.tag), "frame" | "link1" | "link2");
            if frame || node.attribute("rpy").is_some() || node.attribute("quat_xyzw").is_some() {
                found.extend(self.origin(index, &link));
            } else if let Some(xyz) = node.attribute("xyz").and_then(numbers) {
                let point = <[f64; 3]>::try_from(xyz).ok().map(|xyz| Placed::Point(Vector3::from(xyz)));
                let notation = Notation::Attribute("xyz");
                found.extend(point.map(|placed| Posed { node: index, frame: link, placed, notation }));
            }
        }
        found
    }
}

fn missing(node: usize, frame: &Frame, child: &'static str) -> Posed {
    let (frame, placed) = (frame.clone(), Placed::Pose(Pose::identity()));
    Posed { node, frame, placed, notation: Notation::Missing(child) }
}

fn rotation_of([x, y, z, w]: [f64; 4]) -> Option<nalgebra::Rotation3<f64>> {
    let quaternion = UnitQuaternion::try_new(Quaternion::new(w, x, y, z), f64::MIN_POSITIVE)?;
    Some(quaternion.to_rotation_matrix())
}

/// Finite numbers between blanks or commas; `None` if a word is not a number.
fn numbers(text: &str) -> Option<Vec<f64>> {
    let words = text.split(|c: char| c.is_whitespace() || c == ',').filter(|word| !word.is_empty());
    words.map(|word| word.parse().ok().filter(|number: &f64| number.is_finite())).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::urdf;
    use proptest::prelude::*;

    fn found(further: &str) -> Vec<Posed> {
        let text = format!("<robot name=\"r\"><link name=\"a\"/>{further}</robot>");
        in_element(&urdf::read("r.urdf", &text).unwrap().elements[0], None)
    }

    #[test]
    fn a_pose_is_the_same_in_every_notation_and_comes_back_in_its_own() {
        let quarter = std::f64::consts::FRAC_PI_2;
        let half = std::f64::consts::FRAC_1_SQRT_2;
        let sensor = |pose: &str| format!("<gazebo reference=\"a\"><sensor name=\"s\">{pose}</sensor></gazebo>");
        let offsets = "<body_name>a</body_name><xyz_offset>1 2 3</xyz_offset>";
        let cases = [
            sensor(&format!("<pose>1 2 3 0 0 {quarter}</pose>")),
            sensor("<pose degrees=\"true\">1 2 3 0 0 90</pose>"),
            sensor(&format!("<pose rotation_format=\"quat_xyzw\">1 2 3 0 0 {half} {half}</pose>")),
            sensor(&format!("<pose relative_to=\"a\">1 2 3 0 0 {quarter}</pose>")),
            format!("<gazebo><plugin name=\"p\">{offsets}<rpy_offset>0 0 {quarter}</rpy_offset></plugin></gazebo>"),
            format!("<sensor name=\"s\"><parent link=\"a\"/><origin xyz=\"1 2 3\" rpy=\"0 0 {quarter}\"/></sensor>"),
            format!(
                "<sensor name=\"s\"><parent link=\"a\"/><origin xyz=\"1 2 3\" quat_xyzw=\"0 0 {half} {half}\"/></sensor>"
            ),
            format!("<frame name=\"f\" link=\"a\" xyz=\"1 2 3\" rpy=\"0 0 {quarter}\"/>"),
        ];
        let expected = se3::pose(se3::rotation_from_rpy([0.0, 0.0, quarter]), Vector3::new(1.0, 2.0, 3.0));
        for case in cases {
            let found = found(&case);
            let [posed] = &found[..] else { panic!("{case}: {found:?}") };
            assert_eq!(posed.frame, Frame::Named("a".into()), "{case}");
            let Placed::Pose(pose) = &posed.placed else { panic!("{case}") };
            let (turned, moved) = se3::difference(pose, &expected);
            assert!(turned < 1e-15 && moved < 1e-15, "{case}: {turned} {moved}");
            let numbers: Vec<f64> =
                posed.rewritten(&posed.placed).into_iter().flat_map(|change| change.numbers).collect();
            assert!((numbers[0] - 1.0).abs() < 1e-15 && numbers.len() >= 6, "{case}: {numbers:?}");
            if case.contains("degrees") {
                assert!((numbers[5] - 90.0).abs() < 1e-13, "{numbers:?}");
            }
        }
    }

    /// The text with the numbers of `changes` in it, which has marks in their places.
    fn filled(marked: &str, changes: &[Change]) -> String {
        let mut text = marked.to_owned();
        for change in changes {
            let mark = match change.how {
                How::Attribute(name) => name.to_owned(),
                How::OtherOffset => "other".to_owned(),
                _ => "text".to_owned(),
            };
            let numbers: Vec<String> = change.numbers.iter().map(ToString::to_string).collect();
            text = text.replacen(&format!("[{mark}]"), &numbers.join(" "), 1);
        }
        text
    }

    proptest! {
        #[test]
        fn every_pose_comes_back_in_every_notation(
            xyz in prop::array::uniform3(-3.0..3.0f64),
            parts in prop::array::uniform4(-1.0..1.0f64),
        ) {
            prop_assume!(parts.iter().map(|part| part * part).sum::<f64>() > 1e-3);
            let rotation = rotation_of(parts).unwrap();
            let pose = se3::pose(rotation, Vector3::from(xyz));
            for (first, marked) in [
                (
                    "<gazebo reference=\"a\"><sensor><pose/></sensor></gazebo>",
                    "<gazebo reference=\"a\"><sensor><pose>[text]</pose></sensor></gazebo>",
                ),
                (
                    "<gazebo reference=\"a\"><light><pose degrees=\"1\"/></light></gazebo>",
                    "<gazebo reference=\"a\"><light><pose degrees=\"1\">[text]</pose></light></gazebo>",
                ),
                (
                    "<sensor><parent link=\"a\"/><origin/></sensor>",
                    "<sensor><parent link=\"a\"/><origin xyz=\"[xyz]\" rpy=\"[rpy]\"/></sensor>",
                ),
                (
                    "<sensor><parent link=\"a\"/><origin quat_xyzw=\"0 0 0 1\"/></sensor>",
                    "<sensor><parent link=\"a\"/><origin xyz=\"[xyz]\" quat_xyzw=\"[quat_xyzw]\"/></sensor>",
                ),
                (
                    "<gazebo><plugin><bodyName>a</bodyName><xyzOffset>0 0 0</xyzOffset><rpyOffset>0 0 0</rpyOffset></plugin></gazebo>",
                    "<gazebo><plugin><bodyName>a</bodyName><xyzOffset>[text]</xyzOffset><rpyOffset>[text]</rpyOffset></plugin></gazebo>",
                ),
                (
                    "<gazebo><plugin><bodyName>a</bodyName><xyz_offset>0 0 0</xyz_offset></plugin></gazebo>",
                    "<gazebo><plugin><bodyName>a</bodyName><xyz_offset>[text]</xyz_offset><rpy_offset>[other]</rpy_offset></plugin></gazebo>",
                ),
                (
                    "<gazebo><plugin><bodyName>a</bodyName><rpyOffset>0 0 0</rpyOffset></plugin></gazebo>",
                    "<gazebo><plugin><bodyName>a</bodyName><xyzOffset>[other]</xyzOffset><rpyOffset>[text]</rpyOffset></plugin></gazebo>",
                ),
            ] {
                let changes = found(first)[0].rewritten(&Placed::Pose(pose));
                let again = found(&filled(marked, &changes));
                let Placed::Pose(read) = &again[0].placed else { panic!("{again:?}") };
                let (turned, moved) = se3::difference(read, &pose);
                prop_assert!(turned < 2e-14 && moved < 1e-14, "{first}: {turned} {moved}");
            }
        }
    }

    #[test]
    fn what_states_no_pose_sits_at_its_link() {
        let at = found("<gazebo reference=\"a\"><sensor name=\"s\"><update_rate>1</update_rate></sensor></gazebo>");
        assert_eq!((at[0].node, &at[0].notation), (1, &Notation::Missing("pose")));
        let at = found("<sensor name=\"s\"><parent link=\"a\"/></sensor>");
        assert_eq!((at[0].node, &at[0].notation), (0, &Notation::Missing("origin")));
    }

    #[test]
    fn frames_are_distinguished() {
        let frame = |pose: &str| {
            let text = format!("<gazebo reference=\"a\"><sensor name=\"s\">{pose}</sensor></gazebo>");
            found(&text).iter().map(|posed| posed.frame.clone()).collect::<Vec<_>>()
        };
        assert_eq!(frame("<pose relative_to=\"tool\">0 0 0 0 0 0</pose>"), [Frame::Named("tool".into())]);
        assert_eq!(frame("<pose frame=\"world\">0 0 0 0 0 0</pose>"), [Frame::Root]);
        assert_eq!(frame("<pose frame=\"\">0 0 0 0 0 0</pose>"), [Frame::Named("a".into())]);
        let nested = frame("<pose>0 0 1 0 0 0</pose><camera><pose>0 0 2 0 0 0</pose></camera>");
        assert_eq!(nested, [Frame::Named("a".into()), Frame::Part]);
        assert_eq!(frame("<pose>1 2 3</pose>"), []);
    }

    #[test]
    fn directions_and_points_are_no_poses() {
        let direction = found("<gazebo reference=\"a\"><fdir1>0 1 0</fdir1></gazebo>");
        assert_eq!(direction[0].placed, Placed::Direction(Vector3::y()));
        let point = found("<cable name=\"c\"><terminator link=\"a\" xyz=\"0 0 1\"/></cable>");
        assert_eq!(point[0].placed, Placed::Point(Vector3::z()));
    }
}
