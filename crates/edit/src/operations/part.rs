//! A part of a robot: the tree below a link, or all but that.

use crate::Change;
use crate::claim::{Claim, Compared};
use crate::error::{self, EditError, refused_at_joint};
use crate::references;
use crate::tally::Tally;
use denavit_export::urdf::text::{Edits, Nodes, parse};
use denavit_model::robot::{Robot, SourceText};
use roxmltree::Node;
use std::collections::BTreeSet;

/// Which part stays.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Side {
    /// The link and all that it carries.
    Below,
    /// Everything else.
    Above,
}

/// # Errors
/// No such link, nothing remains, or something connects both parts.
pub(crate) fn part(robot: &Robot, srdf: Option<&SourceText>, name: &str, side: Side) -> Result<Change, EditError> {
    let link = error::link(robot, name)?;
    if side == Side::Above && link == robot.root {
        return Err(error::refused_at_link(robot, link, "it is the root, so nothing would remain"));
    }
    let document = parse(robot)?;
    let nodes = Nodes::of(robot, &document)?;
    let stays = |link: usize, below: &[bool]| below[link] == (side == Side::Below);
    let below = below(robot, link);
    let (mut links, mut joints) = (BTreeSet::new(), BTreeSet::new());
    let mut edits = Edits::default();
    let mut tally = Tally::default();
    let mut notes = Vec::new();
    let mut claim = Claim { compared: Compared::No, ..Claim::same(robot) };
    for (index, of) in robot.links.iter().enumerate().filter(|(index, _)| !stays(*index, &below)) {
        links.insert(of.name.as_str());
        claim.links.remove(&of.name);
        if let Some(node) = nodes.link(index) {
            edits.remove(&robot.source, node);
        }
        tally.count("link", "links", "removed");
    }
    for (index, of) in robot.joints.iter().enumerate() {
        if stays(of.parent, &below) && stays(of.child, &below) {
            continue;
        }
        joints.insert(of.name.as_str());
        claim.joints.remove(&of.name);
        edits.remove(&robot.source, nodes.joint(index));
        tally.count("joint", "joints", "removed");
    }
    for (index, of) in robot.joints.iter().enumerate().filter(|(_, of)| !joints.contains(of.name.as_str())) {
        if let Some(driver) = of.mimic.as_ref().filter(|mimic| joints.contains(mimic.joint.as_str())) {
            let what = format!("it follows joint \"{}\", which is in the other part", driver.joint);
            return Err(refused_at_joint(robot, index, what));
        }
    }
    let all_links: BTreeSet<&str> = robot.links.iter().map(|of| of.name.as_str()).collect();
    let all_joints: BTreeSet<&str> = robot.joints.iter().map(|of| of.name.as_str()).collect();
    let used = references::uses(&document, &all_links, &all_joints);
    let own = |node: &Node| node.is_element() && !["link", "joint"].contains(&node.tag_name().name());
    for element in document.root_element().children().filter(own) {
        let within =
            |node: Node| node.range().start >= element.range().start && node.range().end <= element.range().end;
        let of: Vec<_> = used.iter().filter(|used| within(used.node)).collect();
        let gone = |name: &str| links.contains(name) || joints.contains(name);
        let lost = of.iter().filter(|used| gone(&used.name)).count();
        if lost == 0 {
            continue;
        }
        let tag = element.tag_name().name();
        if lost == of.len() {
            edits.remove(&robot.source, element);
            tally.count("element", "elements", "of the other part removed");
        } else if tag == "ros2_control" {
            control(robot, &mut edits, element, &gone)?;
            tally.count("system of ros2_control", "systems of ros2_control", "split");
        } else {
            let name = of.iter().find(|used| gone(&used.name)).map_or("", |used| used.name.as_str());
            let label =
                element.attribute("name").map_or_else(|| format!("<{tag}>"), |name| format!("{tag} \"{name}\""));
            let place = robot.source.place(element.range().start, label);
            let what =
                format!("it connects both parts (it names \"{name}\" and a part that stays); remove or split it first");
            return Err(EditError::Refused { place, what });
        }
    }
    claim.seen_from = match side {
        Side::Below => name.to_owned(),
        Side::Above => robot.links[robot.root].name.clone(),
    };
    if let Some(srdf) = srdf {
        notes.push(format!(
            "{}: groups and states of the whole robot are not split; write an SRDF for the part",
            srdf.file
        ));
    }
    let urdf = edits.apply(&robot.source)?;
    Ok(Change::of(urdf, srdf, claim, tally, notes))
}

/// For each link whether it is this one, or carried by it.
fn below(robot: &Robot, link: usize) -> Vec<bool> {
    let carried = robot.carried();
    let mut below = vec![false; robot.links.len()];
    let mut open = vec![link];
    while let Some(at) = open.pop() {
        below[at] = true;
        open.extend(carried[at].iter().map(|joint| robot.joints[*joint].child));
    }
    below
}

/// Removes the joints of the removed part from a system.
fn control(robot: &Robot, edits: &mut Edits, element: Node, gone: &dyn Fn(&str) -> bool) -> Result<(), EditError> {
    for part in element.children().filter(Node::is_element) {
        let named: Vec<&str> = part
            .descendants()
            .filter(|node| node.is_element() && ["joint", "link", "parent"].contains(&node.tag_name().name()))
            .filter_map(|node| node.attribute("name").or_else(|| node.attribute("link")))
            .collect();
        let lost = named.iter().filter(|name| gone(name)).count();
        if lost > 0 && lost == named.len() {
            edits.remove(&robot.source, part);
        } else if lost > 0 {
            let place = robot.source.place(part.range().start, format!("<{}>", part.tag_name().name()));
            return Err(EditError::Refused { place, what: "it connects both parts; remove or split it first".into() });
        }
    }
    Ok(())
}
