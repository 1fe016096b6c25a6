//! Another robot on a link of this one, by a fixed joint.

use crate::claim::{Claim, Compared};
use crate::error::{self, EditError};
use crate::operations::rename::{claim as renamed_claim, renamed};
use crate::references::Names;
use crate::tally::Tally;
use crate::{Change, Text};
use denavit_export::urdf::text::{Edits, Numbers, escaped, parse};
use denavit_model::robot::{Robot, SourceText};
use denavit_model::se3::Pose;
use denavit_model::urdf;
use roxmltree::{Document, Node};
use std::collections::BTreeMap;

/// # Errors
/// No such link, clashing names or materials, or another file that is not a robot.
pub(crate) fn attach(
    robot: &Robot,
    srdf: Option<&SourceText>,
    other: &Text,
    at: &str,
    pose: &Pose,
    prefix: &str,
) -> Result<Change, EditError> {
    let link = error::link(robot, at)?;
    let original = urdf::read(&other.file, &other.text)?;
    let mut names = Names::default();
    if !prefix.is_empty() {
        let with = |name: &String| (name.clone(), format!("{prefix}{name}"));
        names.links = original.links.iter().map(|link| with(&link.name)).collect();
        names.joints = original.joints.iter().map(|joint| with(&joint.name)).collect();
    }
    let prefixed = if prefix.is_empty() { None } else { Some(renamed(&original, None, &names)?.urdf) };
    let prefixed = prefixed.map_or_else(|| Ok(original.clone()), |text| urdf::read(&other.file, &text))?;
    clashes(robot, &prefixed)?;
    let document = parse(robot)?;
    let (text, materials) = with_materials(&document, &prefixed, prefix)?;
    let guest = urdf::read(&other.file, &text)?;
    let guest_document = parse(&guest)?;
    let mut edits = Edits::default();
    let mut tally = Tally::default();
    let root = document.root_element();
    namespaces(robot, &mut edits, root, guest_document.root_element(), &guest)?;
    let guest_root = &guest.links[guest.root].name;
    let joint = format!("{at}_to_{guest_root}");
    if robot.joint_index(&joint).is_some() || guest.joint_index(&joint).is_some() {
        return Err(EditError::Words(format!("attach: the joint \"{joint}\" already exists; use another prefix")));
    }
    let numbers = Numbers::of(pose, pose.translation.vector.amax());
    let lines = [
        format!(
            "<joint name=\"{}\" type=\"fixed\">{}<parent link=\"{}\"/><child link=\"{}\"/></joint>",
            escaped(&joint),
            numbers.element(),
            escaped(at),
            escaped(guest_root)
        ),
        inside(&guest, guest_document.root_element()),
    ];
    edits.lines_at_end(&robot.source, root, &lines);
    let urdf = edits.apply(&robot.source)?;
    tally.say(format!("{} links and {} joints attached to {at} by \"{joint}\"", guest.links.len(), guest.joints.len()));
    if materials > 0 {
        tally.say(format!("{materials} materials adapted"));
    }
    let own = Claim { compared: Compared::No, foreign: true, ..Claim::same(robot) };
    let others = Claim { foreign: true, ..renamed_claim(&original, &names) };
    let _ = link;
    let notes = if robot.links[robot.root].name != "world" && guest_root.ends_with("world") {
        vec![format!(
            "the root of the attached robot is \"{guest_root}\", a world link; `extract` its arm first to omit it"
        )]
    } else {
        Vec::new()
    };
    Ok(Change {
        urdf,
        srdf: srdf.map(|srdf| srdf.text.clone()),
        claim: own,
        second: Some((original, others)),
        files: Vec::new(),
        tally,
        notes,
    })
}

fn clashes(robot: &Robot, other: &Robot) -> Result<(), EditError> {
    let links = other.links.iter().filter(|link| robot.link_index(&link.name).is_some()).map(|link| &link.name);
    let joints = other.joints.iter().filter(|joint| robot.joint_index(&joint.name).is_some()).map(|joint| &joint.name);
    let taken: Vec<&String> = links.chain(joints).collect();
    let Some(first) = taken.first() else { return Ok(()) };
    Err(EditError::Words(format!(
        "{}: {} name{}, such as \"{first}\", {} already in {}; give a prefix",
        other.source.file,
        taken.len(),
        if taken.len() == 1 { "" } else { "s" },
        if taken.len() == 1 { "is" } else { "are" },
        robot.source.file
    )))
}

/// A material's colour and texture, without white space.
fn appearance(node: Node) -> String {
    let parts = node.children().filter(Node::is_element).map(|part| {
        let mut attributes: Vec<String> = part.attributes().map(|of| format!("{}={}", of.name(), of.value())).collect();
        attributes.sort();
        format!("{} {}", part.tag_name().name(), attributes.join(" "))
    });
    parts.collect::<Vec<_>>().join(";")
}

fn is_material(node: &Node) -> bool {
    node.is_element() && node.tag_name().name() == "material" && node.has_attribute("name")
}

fn defined(document: &Document) -> BTreeMap<String, String> {
    let mut found = BTreeMap::new();
    for node in document.descendants().filter(is_material).filter(|node| node.first_element_child().is_some()) {
        found.entry(node.attribute("name").unwrap_or_default().to_owned()).or_insert_with(|| appearance(node));
    }
    found
}

/// The other robot's text without materials that this one already has; different materials of the same name are renamed.
fn with_materials(document: &Document, other: &Robot, prefix: &str) -> Result<(String, usize), EditError> {
    let own = defined(document);
    let others = parse(other)?;
    let theirs = defined(&others);
    let mut edits = Edits::default();
    let mut count = 0;
    for node in others.descendants().filter(is_material) {
        let name = node.attribute("name").unwrap_or_default();
        let Some(there) = own.get(name) else { continue };
        let same = theirs.get(name).is_none_or(|here| here == there);
        let is_top = node.parent().is_some_and(|above| above == others.root_element());
        if same && is_top {
            edits.remove(&other.source, node);
            count += 1;
        } else if !same && prefix.is_empty() {
            let place = other.source.place(node.range().start, format!("material \"{name}\""));
            let what = "the robot that it is attached to has a different material with this name; give a prefix";
            return Err(EditError::Refused { place, what: what.into() });
        } else if !same {
            edits.attribute(&other.source, node, "name", &format!("{prefix}{name}"));
            count += 1;
        }
    }
    Ok((edits.apply(&other.source)?, count))
}

/// Prefixes that the other text declares.
fn namespaces(robot: &Robot, edits: &mut Edits, root: Node, other: Node, guest: &Robot) -> Result<(), EditError> {
    let declared = guest.source.text.get(guest.source.declared.clone()).unwrap_or_default();
    for namespace in other.namespaces() {
        let Some(prefix) = namespace.name() else {
            if root.tag_name().namespace() == Some(namespace.uri()) {
                continue;
            }
            let what = "its elements use a default namespace that the robot it is attached to lacks".into();
            return Err(EditError::Refused { place: guest.source.place(other.range().start, "robot"), what });
        };
        // What was declared for the parser alone goes again.
        if prefix == "xml" || declared.contains(&format!("xmlns:{prefix}=")) {
            continue;
        }
        match root.lookup_namespace_uri(Some(prefix)) {
            Some(uri) if uri == namespace.uri() => {}
            Some(uri) if uri.starts_with("urn:unbound:") => {}
            Some(_) => {
                let what = format!("the prefix \"{prefix}\" means another namespace in {}", robot.source.file);
                return Err(EditError::Refused { place: guest.source.place(other.range().start, "robot"), what });
            }
            None => edits.attribute(&robot.source, root, &format!("xmlns:{prefix}"), namespace.uri()),
        }
    }
    Ok(())
}

/// The content between the tags of the other robot.
fn inside(guest: &Robot, root: Node) -> String {
    let children: Vec<Node> = root.children().filter(|node| !node.is_text()).collect();
    match (children.first(), children.last()) {
        (Some(first), Some(last)) => guest.source.text[first.range().start..last.range().end].to_owned(),
        _ => String::new(),
    }
}
