//! Edits in a URDF: every value of joints and links, shapes, links and joints that are new or gone.

use super::{Edits, Merged, carrier, child, link, parsed};
use denavit_model::formats::Loss;
use denavit_model::robot::{Geometry, Joint, Link, Origin, Shape};
use denavit_model::write::{self, escaped};
use denavit_model::{Robot, urdf};
use roxmltree::{Document, Node};
use std::collections::HashSet;

/// Poses closer than this, m or rad, are the same but for rounding.
const SAME: f64 = 1e-9;

pub(super) fn merged(file: &str, text: &str, before: &Robot, after: &Robot) -> Option<Merged> {
    let source = urdf::read(file, text).ok()?;
    let document = parsed(&source.source.text)?;
    let edits = Edits::of(&source.source.text);
    let mut work = Work { source: &source, document: &document, before, after, edits, lost: Vec::new() };
    work.all();
    let Work { mut edits, lost, .. } = work;
    let changes = edits.pieces.len();
    // What was put in to declare namespace prefixes is not the file's.
    if !source.source.declared.is_empty() {
        edits.replace(source.source.declared.clone(), "");
    }
    let (text, _) = edits.finished()?;
    let text = source.source.dropped_before.clone() + &text;
    urdf::read(file, &text).ok()?;
    Some(Merged { text, changes, lost })
}

struct Work<'a> {
    source: &'a Robot,
    document: &'a Document<'a>,
    before: &'a Robot,
    after: &'a Robot,
    edits: Edits<'a>,
    lost: Vec<Loss>,
}

impl<'a> Work<'a> {
    fn node(&self, at: usize) -> Option<Node<'a, 'a>> {
        self.document.descendants().find(|node| node.is_element() && node.range().start == at)
    }

    fn lose(&mut self, at: usize, element: String, what: impl Into<String>, why: impl Into<String>) {
        let place = self.after.source.place(at, element);
        self.lost.push(Loss { place, what: what.into(), why: why.into() });
    }

    fn all(&mut self) {
        let (source, before, after) = (self.source, self.before, self.after);
        let mut gone: HashSet<&str> = HashSet::new();
        for own in &source.links {
            match (link(before, &own.name), link(after, &own.name)) {
                (Some(was), Some(is)) => self.link(own, was, is),
                (Some(_), None) => {
                    gone.insert(&own.name);
                    self.remove(own.at);
                    if let Some(joint) = carrier(source, &own.name) {
                        gone.insert(&joint.name);
                        self.remove(joint.at);
                    }
                }
                _ => {}
            }
        }
        for own in &source.joints {
            let child = source.links[own.child].name.as_str();
            if let (Some(was), Some(is)) = (carrier(before, child), carrier(after, child)) {
                self.joint(own, was, is);
            }
        }
        self.new_parts();
        // What names a link or joint that is gone is not taken out, since it may name others, too.
        for element in &source.elements {
            let words = element.nodes.iter().flat_map(|node| node.attributes.iter().map(|(_, value)| value.as_str()));
            if let Some(name) = words.into_iter().find(|word| gone.contains(word)) {
                let place = source.source.place(element.at, element.label());
                let why = format!("names \"{name}\", which no longer exists; remove it, or name another");
                self.lost.push(Loss { place, what: format!("<{}>", element.tag()), why });
            }
        }
    }

    fn remove(&mut self, at: usize) {
        if let Some(node) = self.node(at) {
            self.edits.replace(node.range(), "");
        }
    }

    /// Links and joints that only the edited description has, behind all others.
    fn new_parts(&mut self) {
        let (before, after) = (self.before, self.after);
        let mut text = String::new();
        for own in after.links.iter().filter(|own| link(before, &own.name).is_none()) {
            if link(self.source, &own.name).is_none() {
                text.push_str(&write::link(own));
            }
        }
        for own in &after.joints {
            let child = after.links[own.child].name.as_str();
            if carrier(before, child).is_none() && carrier(self.source, child).is_none() {
                text.push_str(&write::joint(after, own));
            }
        }
        let root = self.document.root_element();
        let end = root.range().end;
        let closes = self.source.source.text[..end].rfind("</").filter(|at| *at > root.range().start);
        if let (false, Some(at)) = (text.is_empty(), closes) {
            self.edits.replace(at..at, text);
        }
    }

    /// Sets attributes of an element of a joint, which is put there if it has none.
    fn set_values(&mut self, joint: Node<'a, 'a>, tag: &str, values: &[(&str, f64)]) {
        let Some(node) = child(joint, tag) else {
            let words = values.iter().map(|(name, value)| format!(" {name}=\"{value}\"")).collect::<Vec<_>>().concat();
            self.edits.append(joint, &format!("<{tag}{words}/>"));
            return;
        };
        for (name, value) in values {
            self.edits.set_attribute(node, name, &value.to_string());
        }
    }

    fn link(&mut self, own: &Link, was: &Link, is: &Link) {
        let Some(node) = self.node(own.at) else { return };
        match (&was.inertial, &is.inertial, child(node, "inertial")) {
            (Some(was), Some(is), Some(inertial)) => {
                self.place(inertial, &was.origin, &is.origin);
                if let (true, Some(mass)) = (was.mass != is.mass, child(inertial, "mass")) {
                    self.edits.set_attribute(mass, "value", &is.mass.to_string());
                }
                if was.tensor != is.tensor {
                    self.edits.set(inertial, "inertia", write::inertia(&is.tensor));
                }
            }
            (was, is, _) if was != is => {
                self.edits.set(node, "inertial", is.as_ref().map(write::inertial).unwrap_or_default());
            }
            _ => {}
        }
        self.shapes(node, "visual", [&own.visuals, &was.visuals, &is.visuals]);
        self.shapes(node, "collision", [&own.collisions, &was.collisions, &is.collisions]);
    }

    /// Of the `<origin>` in an element, the part that was edited.
    fn place(&mut self, node: Node<'a, 'a>, was: &Origin, is: &Origin) {
        let old = child(node, "origin").filter(|old| !old.has_attribute("quat_xyzw"));
        match old {
            Some(old) => {
                if was.xyz != is.xyz {
                    self.edits.set_attribute(old, "xyz", &write::numbers(&is.xyz));
                }
                if was.rpy != is.rpy {
                    self.edits.set_attribute(old, "rpy", &write::numbers(&is.rpy));
                }
            }
            None if was != is => self.edits.set(node, "origin", write::origin(is)),
            None => {}
        }
    }

    /// Shapes by their order, those left out that the other format does not have.
    fn shapes(&mut self, node: Node<'a, 'a>, tag: &str, [own, was, is]: [&[Shape]; 3]) {
        if was == is {
            return;
        }
        let nodes: Vec<Node> = node.children().filter(|node| node.tag_name().name() == tag).collect();
        // Of each shape as it was written, the one of the URDF.
        let mut first = 0;
        let sources: Vec<Option<usize>> = was
            .iter()
            .map(|shape| {
                let found = (first..own.len()).find(|index| is_made_of(shape, &own[*index]))?;
                first = found + 1;
                Some(found)
            })
            .collect();
        let kept = was.iter().zip(is).take_while(|(was, is)| was == is).count();
        for (index, shape) in is.iter().enumerate().skip(kept) {
            let (Some(was), Some(Some(source))) = (was.get(index), sources.get(index)) else {
                self.edits.append(node, &write::shape(tag, shape));
                continue;
            };
            let Some(place) = nodes.get(*source) else { continue };
            self.place(*place, &was.origin, &shape.origin);
            if was.geometry != shape.geometry {
                let new = format!("<geometry>{}</geometry>", write::geometry(&shape.geometry));
                self.edits.set(*place, "geometry", new);
            }
            if was.elements != shape.elements {
                let new: String = shape.elements.iter().filter(|e| e.tag() == "material").map(write::element).collect();
                self.edits.set(*place, "material", new);
            }
        }
        for place in sources.iter().skip(is.len()).flatten().filter_map(|source| nodes.get(*source)) {
            self.edits.replace(place.range(), "");
        }
    }

    fn joint(&mut self, own: &Joint, was: &Joint, is: &Joint) {
        let Some(node) = self.node(own.at) else { return };
        let element = || format!("joint \"{}\"", is.name);
        let parent = |robot: &Robot, joint: &Joint| robot.links[joint.parent].name.clone();
        let (old_parent, new_parent) = (parent(self.before, was), parent(self.after, is));
        let several = was.kind.word() != own.kind.word() && was.kind != is.kind
            || self.source.link_index(&new_parent).is_none() && link(self.before, &new_parent).is_some();
        if several && (was.kind != is.kind || was.origin != is.origin || was.axis != is.axis) {
            let why = format!("is \"{}\" of the URDF, which is written in another way; change it there", own.name);
            self.lose(is.at, element(), "its edit", why);
            return;
        }
        if was.name != is.name {
            let why =
                format!("the URDF's is still \"{}\": `denavit edit` renames it and every reference to it", own.name);
            self.lose(is.at, element(), "its new name", why);
        }
        if was.kind != is.kind {
            self.edits.set_attribute(node, "type", &escaped(is.kind.word()));
        }
        if old_parent != new_parent {
            self.edits.set(node, "parent", format!("<parent link=\"{}\"/>", escaped(&new_parent)));
        }
        self.place(node, &was.origin, &is.origin);
        if was.axis_written != is.axis_written {
            let axis = is.axis_written.unwrap_or([1.0, 0.0, 0.0]);
            self.edits.set(node, "axis", format!("<axis xyz=\"{}\"/>", write::numbers(&axis)));
        }
        self.limits(node, was, is);
        let (one, two) = (was.dynamics(), is.dynamics());
        let values = [("damping", one.damping, two.damping), ("friction", one.friction, two.friction)];
        let changed: Vec<(&str, f64)> =
            values.iter().filter(|(_, was, is)| was != is).map(|(name, _, is)| (*name, *is)).collect();
        if !changed.is_empty() {
            self.set_values(node, "dynamics", &changed);
        }
        if was.mimic != is.mimic {
            let mimic = is.mimic.as_ref().map_or_else(String::new, |mimic| {
                let (driver, factor, offset) = (escaped(&mimic.joint), mimic.multiplier, mimic.offset);
                format!("<mimic joint=\"{driver}\" multiplier=\"{factor}\" offset=\"{offset}\"/>")
            });
            self.edits.set(node, "mimic", mimic);
        }
    }

    fn limits(&mut self, node: Node<'a, 'a>, was: &Joint, is: &Joint) {
        let values = |joint: &Joint| {
            let range = joint.limits.range;
            [
                ("lower", range.map(|range| range.0)),
                ("upper", range.map(|range| range.1)),
                ("effort", joint.limits.effort),
                ("velocity", joint.limits.velocity),
            ]
        };
        let changed: Vec<(&str, f64)> = values(was)
            .into_iter()
            .zip(values(is))
            .filter(|(was, is)| was.1 != is.1)
            .filter_map(|(_, (name, value))| Some((name, value?)))
            .collect();
        if !changed.is_empty() {
            self.set_values(node, "limit", &changed);
        }
        // A limit that was taken out; a range of a joint that now turns without end has no effect and may stay.
        for ((name, had), (_, has)) in values(was).into_iter().zip(values(is)) {
            let idle = ["lower", "upper"].contains(&name) && was.kind != is.kind;
            if let (Some(_), None, false, Some(limit)) = (had, has, idle, child(node, "limit")) {
                self.edits.remove_attribute(limit, name);
            }
        }
    }
}

/// Whether a shape of the other format is the URDF's: its place and size, a mesh by the last part of its name.
fn is_made_of(shape: &Shape, own: &Shape) -> bool {
    let last = |name: &str| name.rsplit(['/', '\\']).next().unwrap_or_default().to_owned();
    let same = match (&shape.geometry, &own.geometry) {
        (Geometry::Mesh { filename, scale }, Geometry::Mesh { filename: other, scale: own }) => {
            last(filename) == last(other) && scale == own
        }
        (one, other) => one == other,
    };
    let (angle, distance) = denavit_model::se3::difference(&shape.origin.pose(), &own.origin.pose());
    same && angle < SAME && distance < SAME
}
