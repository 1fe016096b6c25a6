//! Checks in one pass, separate from the reader, that everything in the file is understood.

use super::known::{self, Known};
use super::{DRAKE, element_of};
use crate::inventory::Inventory;
use crate::notes::{Note, Place};
use crate::problems::nearest_name;
use crate::robot::SourceText;
use roxmltree::{Attribute, Node, NodeType};
use std::collections::HashMap;

/// Counts what is understood and records the place of what is not.
#[derive(Default)]
pub(super) struct Account {
    understood: usize,
    unknown: Vec<Unknown>,
}

/// Something that the reader does not understand.
struct Unknown {
    at: usize,
    /// The link or joint that it is in.
    owner: String,
    /// What it is, with its value.
    what: String,
    /// What is done with it and what to do; `None` where a note of the reader already says so.
    note: Option<String>,
    /// What it is, without its value: there is one note for all that are of one kind.
    kind: String,
}

impl Account {
    /// Walks through a `<robot>`.
    pub fn of(root: Node) -> Self {
        let mut account = Self::default();
        let namespace = root.tag_name().namespace();
        let mut open = vec![(root, &known::ROBOT)];
        while let Some((node, known)) = open.pop() {
            account.understood += 1;
            for attribute in node.attributes() {
                let named = known.attributes.contains(&attribute.name()) || known.kept.contains(&attribute.name());
                if named && attribute.namespace().is_none_or(|namespace| namespace == DRAKE) {
                    account.understood += 1;
                } else {
                    account.attribute(node, known, &attribute);
                }
            }
            let first = open.len();
            for child in node.children() {
                match child.node_type() {
                    NodeType::Element => {
                        let found = child.tag_name().namespace();
                        let ours = found.is_none_or(|found| found == DRAKE) || found == namespace;
                        let tag = child.tag_name().name();
                        // In a link or joint the reader looks at the local name alone.
                        let understood = known.children.iter().find(|known| known.tag == tag);
                        match understood.filter(|_| ours || known.tag != "robot") {
                            Some(next) => {
                                let again = next.once && open[first..].iter().any(|(_, other)| other.tag == tag);
                                let other_shape = known.tag == "geometry" && open.len() > first;
                                if again || other_shape {
                                    account.again(child, known, again && known.tag != "geometry");
                                } else {
                                    open.push((child, next));
                                }
                            }
                            None if ours && known.carried.contains(&tag) => {}
                            None => account.element(child, known),
                        }
                    }
                    NodeType::Text if child.text().is_some_and(|text| !text.trim().is_empty()) => {
                        account.text(node, child.text().unwrap_or_default());
                    }
                    _ => {}
                }
            }
            open[first..].reverse();
        }
        account
    }

    fn attribute(&mut self, node: Node, known: &Known, attribute: &Attribute) {
        let (tag, name) = (known.tag, attribute.name());
        let near = nearest_name(name, known.attributes.iter().copied());
        let advice = match near {
            Some(near) => format!("did you mean {near}?"),
            None if known.places => format!(
                "it may state a pose or a motion that is missing here; write {} instead, or remove it",
                listed(known.attributes)
            ),
            None => "remove it, or correct its name".to_owned(),
        };
        self.unknown.push(Unknown {
            at: attribute.range().start,
            owner: owner_of(node),
            what: format!("attribute {name}=\"{}\" of <{tag}>", shortened(attribute.value(), KEPT)),
            note: Some(format!("is not understood and changes nothing here; {advice}")),
            kind: format!("attribute {name} of <{tag}>"),
        });
    }

    fn element(&mut self, node: Node, known: &Known) {
        let tag = node.tag_name().name();
        let xacro = node.tag_name().namespace().is_some_and(|namespace| namespace.contains("xacro"));
        let near = nearest_name(tag, known.children.iter().map(|known| known.tag));
        let advice = match near {
            _ if xacro => "it is xacro that was not expanded".to_owned(),
            Some(near) => format!("did you mean <{near}>?"),
            None if tag == "origin" => {
                format!("<{}> has no pose of its own, so this moves nothing", known.tag)
            }
            None if known.tag == "geometry" => format!(
                "the shape is unknown here; known are {}",
                known.children.iter().map(|known| known.tag).collect::<Vec<_>>().join(", ")
            ),
            None if known.places => "if it says where something is or how it moves, that is missing here".to_owned(),
            None => "if it is more than a comment, what it states is missing here".to_owned(),
        };
        self.unknown.push(Unknown {
            at: node.range().start,
            owner: owner_of(node),
            what: format!("<{tag}> in <{}>", known.tag),
            note: Some(format!("is not understood: it is kept unchanged and has no effect here; {advice}")),
            kind: format!("<{tag}> in <{}>", known.tag),
        });
    }

    /// A second element where the first counts; `noted` where the reader says so.
    fn again(&mut self, node: Node, known: &Known, noted: bool) {
        let what = format!("a second <{}> in <{}>", node.tag_name().name(), known.tag);
        let note = (!noted).then(|| "is ignored; remove one of the two".to_owned());
        self.unknown.push(Unknown { at: node.range().start, owner: owner_of(node), kind: what.clone(), what, note });
    }

    fn text(&mut self, node: Node, text: &str) {
        let tag = node.tag_name().name();
        self.unknown.push(Unknown {
            at: node.range().start,
            owner: owner_of(node),
            what: format!("text \"{}\" in <{tag}>", shortened(text.trim(), KEPT)),
            note: Some("is not understood and changes nothing here; write attributes or a comment".to_owned()),
            kind: format!("text in <{tag}>"),
        });
    }

    /// One note for each kind of thing that is not understood, at the first of them, up to [`KINDS`] kinds.
    pub fn notes(&self, source: &SourceText) -> Vec<Note> {
        let mut kinds: Vec<(&Unknown, &String, usize)> = Vec::new();
        let mut known: HashMap<&str, usize> = HashMap::new();
        for unknown in &self.unknown {
            let Some(note) = &unknown.note else { continue };
            if let Some(kind) = known.get(unknown.kind.as_str()) {
                kinds[*kind].2 += 1;
            } else {
                known.insert(&unknown.kind, kinds.len());
                kinds.push((unknown, note, 1));
            }
        }
        let more_kinds = kinds.len().saturating_sub(KINDS);
        let first_left_out = kinds.get(KINDS).map(|(first, ..)| source.place(first.at, first.owner.as_str()));
        let note = |(first, note, count): (&Unknown, &String, usize)| {
            let more = if count > 1 { format!(" ({count} of this kind in the file)") } else { String::new() };
            let place = source.place(first.at, first.owner.as_str());
            Note::NotUnderstood { place, what: format!("{} {note}{more}", shortened(&first.what, SHOWN)) }
        };
        let left_out = first_left_out.map(|place| {
            let what = format!("{more_kinds} more kinds of things are not understood here and below");
            Note::NotUnderstood { place, what }
        });
        kinds.into_iter().take(KINDS).map(note).chain(left_out).collect()
    }

    /// What was understood and what was not.
    pub fn inventory(self, source: &SourceText) -> Inventory {
        let mut inventory = Inventory { understood: self.understood, items: Vec::new() };
        for Unknown { at, owner, what, .. } in self.unknown {
            let place: Place = source.place(at, owner);
            inventory.report(place, what);
        }
        inventory
    }
}

/// At most this many kinds of things get their own note.
const KINDS: usize = 20;
/// Longer ones are cut in notes.
const SHOWN: usize = 120;
/// Longer values are cut in the inventory.
const KEPT: usize = 1000;

fn shortened(value: &str, length: usize) -> String {
    match value.char_indices().nth(length) {
        Some((end, _)) => format!("{}…", &value[..end]),
        None => value.to_owned(),
    }
}

fn listed(names: &[&str]) -> String {
    match names {
        [] => "a known element".to_owned(),
        [one] => (*one).to_owned(),
        [start @ .., last] => format!("{} or {last}", start.join(", ")),
    }
}

/// The link or joint that something is in; the element itself where it is in none.
fn owner_of(node: Node) -> String {
    let owner = node.ancestors().find(|above| matches!(above.tag_name().name(), "link" | "joint"));
    element_of(owner.unwrap_or(node))
}
