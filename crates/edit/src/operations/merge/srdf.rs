//! Updates an SRDF after links were merged: each name and each pair occurs once.

use crate::error::EditError;
use crate::operations::parse_srdf;
use crate::references::{self, Names};
use crate::tally::Tally;
use denavit_export::urdf::text::Edits;
use denavit_model::robot::SourceText;
use roxmltree::Node;
use std::collections::BTreeSet;

/// # Errors
/// The SRDF is no XML.
pub(super) fn merged(source: &SourceText, names: &Names, tally: &mut Tally) -> Result<String, EditError> {
    let document = parse_srdf(source)?;
    let mut edits = Edits::default();
    let new = |name: &str| names.links.get(name).cloned().unwrap_or_else(|| name.to_owned());
    let (mut seen, mut gone) = (BTreeSet::new(), Vec::new());
    for node in document.descendants().filter(Node::is_element) {
        let tag = node.tag_name().name();
        let key = match (tag, node.attribute("link1"), node.attribute("link2"), node.attribute("name")) {
            ("disable_collisions" | "enable_collisions", Some(one), Some(other), _) => {
                let mut pair = [new(one), new(other)];
                pair.sort();
                if pair[0] == pair[1] {
                    gone.push(node);
                    continue;
                }
                format!("{tag} {pair:?}")
            }
            ("link", _, _, Some(name)) => {
                format!("{:?} {}", node.parent().map(|above| above.range()), new(name))
            }
            _ => continue,
        };
        if !seen.insert(key) {
            gone.push(node);
        }
    }
    for node in &gone {
        edits.remove(source, *node);
        tally.count("entry of the SRDF", "entries of the SRDF", "removed");
    }
    references::rename_where(&document, names, &mut edits, &|node| !gone.contains(&node));
    Ok(edits.apply(source)?)
}
