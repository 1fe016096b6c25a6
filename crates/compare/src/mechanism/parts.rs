//! Elements of a source other than links and joints, each with the body that it refers to, and their poses expressed
//! independent of link frames.

use super::{Mechanism, PartPlace, PlacedElement, PlacedPart};
use denavit_model::nalgebra::{Point3, UnitVector3};
use denavit_model::posed::{self, Frame, Notation, Placed, Posed};
use denavit_model::se3::Pose;
use denavit_model::{Element, Item, PlacedRobot, Robot};
use std::collections::{BTreeMap, HashMap};

/// Bodies and frames by the names of links and joints.
struct Places<'a> {
    /// A joint's frame is that of its child link; where a link has the same name, that link's is meant.
    frames: HashMap<&'a str, (usize, Pose)>,
    /// The bodies of names; if a joint and a link have the same name, the name refers to the joint.
    bodies: HashMap<&'a str, usize>,
}

impl<'a> Places<'a> {
    fn of(placed: &PlacedRobot<'a>, body_of: &[usize]) -> Self {
        let robot: &'a Robot = placed.robot();
        let place = |link: usize| (body_of[placed.body(link)], *placed.pose(link));
        let joints = robot.joints.iter().map(|joint| (joint.name.as_str(), place(joint.child)));
        let links = robot.links.iter().enumerate().map(|(index, link)| (link.name.as_str(), place(index)));
        let bodies = links.clone().chain(joints.clone()).map(|(name, (body, _))| (name, body)).collect();
        Self { frames: joints.chain(links).collect(), bodies }
    }

    fn body(&self, name: &str) -> Option<usize> {
        self.bodies.get(name).copied()
    }

    /// Something placed, in the root frame; `None` where its frame is not known.
    fn part(&self, posed: &Posed, path: String) -> Option<PlacedPart> {
        let (body, root_from_frame) = match &posed.frame {
            Frame::Named(name) => *self.frames.get(name.as_str())?,
            _ => (0, Pose::identity()),
        };
        let place = match &posed.placed {
            Placed::Pose(pose) if posed.frame == Frame::Part => PartPlace::Inside(*pose),
            Placed::Pose(pose) => PartPlace::Pose(root_from_frame * pose),
            Placed::Point(point) => PartPlace::Point(root_from_frame * Point3::from(*point)),
            Placed::Direction(direction) => {
                let unit = UnitVector3::try_new(*direction, 0.0)?;
                PartPlace::Direction(root_from_frame.rotation * unit.into_inner())
            }
        };
        Some(PlacedPart { path, body, place })
    }
}

impl Mechanism {
    /// All other elements of the source; also, as texts, what its reader does not understand.
    pub(super) fn add_elements(&mut self, placed: &PlacedRobot, body_of: &[usize]) {
        let robot = placed.robot();
        let plain = robot.elements.is_empty() && robot.joints.iter().all(|joint| joint.elements.is_empty());
        let shapes_plain = robot
            .links
            .iter()
            .all(|link| link.elements.is_empty() && link.collisions.iter().all(|shape| shape.elements.is_empty()));
        if plain && shapes_plain && robot.read.items.is_empty() {
            return;
        }
        let places = Places::of(placed, body_of);
        for (index, link) in robot.links.iter().enumerate() {
            let body = body_of[placed.body(index)];
            let on_collisions = link.collisions.iter().flat_map(|shape| &shape.elements);
            for element in link.elements.iter().chain(on_collisions) {
                self.add_element(&places, Some(("link", &link.name)), element, body);
            }
        }
        for joint in &robot.joints {
            let body = body_of[placed.body(joint.child)];
            for element in joint.elements.iter().filter_map(|element| further_of_joint(element, joint.kind.moves())) {
                self.add_element(&places, Some(("joint", &joint.name)), &element, body);
            }
        }
        for element in &robot.elements {
            let mut names = element.nodes.iter().flat_map(|node| {
                let values = node.attributes.iter().map(|(_, value)| value.as_str());
                values.chain([node.text.as_str()])
            });
            let body = names.find_map(|name| places.body(name)).unwrap_or(0);
            self.add_element(&places, None, element, body);
        }
        self.elements.extend(not_understood(robot, &places));
        // The order of otherwise identical elements in the file has no meaning.
        self.elements.sort_by(|one, other| (&one.label, &one.entries).cmp(&(&other.label, &other.entries)));
        let mut seen: HashMap<String, usize> = HashMap::new();
        for element in &mut self.elements {
            let count = seen.entry(element.label.clone()).and_modify(|count| *count += 1).or_insert(1);
            if *count > 1 {
                element.label = format!("{} [{count}]", element.label);
            }
        }
    }

    fn add_element(&mut self, places: &Places, owner: Option<(&str, &str)>, element: &Element, body: usize) {
        if element.tag() == "material" {
            return;
        }
        let (label, kind) = match owner {
            Some((tag, name)) => (format!("{tag} \"{name}\"/{}", element.label()), format!("{tag}/{}", element.tag())),
            None => (element.label(), element.tag().to_owned()),
        };
        let link = owner.filter(|(tag, _)| *tag == "link").map(|(_, name)| name);
        let found = posed::in_element(element, link);
        let (mut parts, mut read) = (Vec::new(), Vec::new());
        if !found.is_empty() {
            let paths = element.paths();
            for posed in found {
                let path = path_of(&posed, &paths);
                if let Some(part) = places.part(&posed, path) {
                    parts.push(part);
                    read.push(posed);
                }
            }
        }
        let says = |node: usize, attribute: Option<&str>| read.iter().any(|posed| posed.says(node, attribute));
        let entries = element.entries_without(&says);
        self.elements.push(PlacedElement { label, kind, entries, parts, body, at: element.at });
    }
}

/// The path to a pose, the same whether it is written or omitted.
fn path_of(posed: &Posed, paths: &[String]) -> String {
    let own = paths.get(posed.node).map_or("", String::as_str);
    let below = |parent: &str, child: &str| if parent.is_empty() { child.into() } else { format!("{parent}/{child}") };
    match &posed.notation {
        Notation::Missing(child) => below(own, child),
        Notation::Offsets { .. } => below(own.rsplit_once('/').map_or("", |(parent, _)| parent), "offset"),
        _ => own.to_owned(),
    }
}

/// Attributes and texts that the reader does not understand, compared as texts: for each element that has some, one.
fn not_understood(robot: &Robot, places: &Places) -> Vec<PlacedElement> {
    let mut found: BTreeMap<String, PlacedElement> = BTreeMap::new();
    for item in robot.read.reported() {
        let Some((path, value, tag)) = text_of(item) else { continue };
        let owner = &item.place.element;
        let element = found.entry(format!("{owner}/{tag}")).or_insert_with(|| PlacedElement {
            label: format!("{owner}/{tag}"),
            kind: format!("not understood/{tag}"),
            entries: Vec::new(),
            parts: Vec::new(),
            body: owner.split('"').nth(1).and_then(|name| places.body(name)).unwrap_or(0),
            at: start_of_line(robot, item.place.line),
        });
        let before =
            element.entries.iter().filter(|(known, _)| known.split(" [").next() == Some(path.as_str())).count();
        let path = if before == 0 { path } else { format!("{path} [{}]", before + 1) };
        element.entries.push((path, value));
    }
    found.into_values().collect()
}

/// The path of something in its element, its value, and the element's tag. The content of an element that is not
/// understood is kept with that element.
fn text_of(item: &Item) -> Option<(String, String, &str)> {
    match item.what.split_once(' ')? {
        ("attribute", rest) => {
            let (name, rest) = rest.split_once("=\"")?;
            let (value, tag) = rest.rsplit_once("\" of ")?;
            Some((format!("@{name}"), value.to_owned(), tag))
        }
        ("text", rest) => {
            let (value, tag) = rest.strip_prefix('"')?.rsplit_once("\" in ")?;
            Some(("text".to_owned(), value.to_owned(), tag))
        }
        _ => None,
    }
}

/// Byte offset at which a line (counted from 1) starts.
fn start_of_line(robot: &Robot, line: usize) -> usize {
    let dropped = robot.source.dropped_before.matches('\n').count();
    let before = line.saturating_sub(1 + dropped);
    let breaks = robot.source.text.match_indices('\n');
    if before == 0 { 0 } else { breaks.map(|(at, _)| at + 1).nth(before - 1).unwrap_or(0) }
}

/// An element of a joint without what is read as numbers of its own.
fn further_of_joint(element: &Element, moves: bool) -> Option<Element> {
    let read: &[&str] = match element.tag() {
        "dynamics" => &["damping", "friction"],
        "safety_controller" => &["soft_lower_limit", "soft_upper_limit", "k_position", "k_velocity"],
        "calibration" if moves => &["rising", "falling", "reference_position"],
        _ => return Some(element.clone()),
    };
    let mut element = element.clone();
    let own = element.nodes.first_mut()?;
    own.attributes.retain(|(name, _)| !read.contains(&name.as_str()));
    (element.nodes.len() > 1 || !element.entries().is_empty()).then_some(element)
}

/// Parts of an element by their paths.
pub(crate) fn by_path(parts: &[PlacedPart]) -> BTreeMap<&str, &PlacedPart> {
    parts.iter().map(|part| (part.path.as_str(), part)).collect()
}
