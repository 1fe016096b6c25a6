//! Joint values in the states of an SRDF.

use super::{Sheet, mapped};
use crate::claim::JointMap;
use roxmltree::Node;

/// Rewrites the values of a joint in `<group_state>`.
pub(crate) fn edit(sheet: &mut Sheet, name: &str, map: JointMap) {
    let states = sheet.document.descendants().filter(|node| node.tag_name().name() == "group_state");
    let values: Vec<Node> = states
        .flat_map(|state| state.children())
        .filter(|node| node.is_element() && node.tag_name().name() == "joint" && node.attribute("name") == Some(name))
        .collect();
    for node in values {
        let Some(attribute) = node.attribute_node("value") else { continue };
        sheet.edits.replace(attribute.range_value(), mapped(attribute.value(), map));
        sheet.tally.count("SRDF state", "SRDF states", "rewritten");
    }
}
