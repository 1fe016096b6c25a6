//! Updates the text after mesh files were copied to another folder.

use crate::Change;
use crate::claim::{Claim, Compared};
use crate::error::EditError;
use crate::tally::Tally;
use crate::values::child;
use denavit_export::urdf::text::{Edits, Nodes, parse};
use denavit_model::robot::{Robot, SourceText};
use roxmltree::Node;
use std::collections::BTreeMap;

/// `names`: the new name of each mesh by its old one, as the text writes them. Scales stay: the files are copies.
///
/// # Errors
/// A text out of reach of edits.
pub(crate) fn meshes(
    robot: &Robot,
    srdf: Option<&SourceText>,
    names: &BTreeMap<String, String>,
) -> Result<Change, EditError> {
    let document = parse(robot)?;
    let nodes = Nodes::of(robot, &document)?;
    let mut edits = Edits::default();
    let mut tally = Tally::default();
    let is_shape = |part: &Node| matches!(part.tag_name().name(), "visual" | "collision");
    for shape in nodes.links().flat_map(|link| link.children()).filter(is_shape) {
        let mesh = child(shape, "geometry").and_then(|geometry| child(geometry, "mesh"));
        let Some((mesh, written)) = mesh.and_then(|mesh| Some((mesh, mesh.attribute("filename")?))) else { continue };
        if let Some(name) = names.get(written.trim()).filter(|name| *name != written) {
            edits.attribute(&robot.source, mesh, "filename", name);
            tally.count("path", "paths", "rewritten");
        }
    }
    let texture =
        document.descendants().find(|node| node.tag_name().name() == "texture" && node.has_attribute("filename"));
    let notes = texture.map(|texture| {
        let line = robot.source.line(texture.range().start);
        format!("textures that materials name are not copied, such as that of line {line}")
    });
    let claim = Claim { files: names.clone(), compared: Compared::No, ..Claim::same(robot) };
    let urdf = edits.apply(&robot.source)?;
    Ok(Change::of(urdf, srdf, claim, tally, notes.into_iter().collect()))
}
