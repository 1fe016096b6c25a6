//! What the explorer's 3-D view shows in a document: the robot's shapes, and the frames of each chain's table.

use super::{ChainPart, Document};
use crate::drawing::far_from_scale;
use crate::sheet::Sheet;
use crate::{formats, shapes};
use denavit_dh::Convention;
use denavit_model::Reading;
use serde_json::{Value, json};
use std::collections::BTreeMap;

/// The explorer's 3-D view for a page.
#[derive(Debug, Clone)]
pub struct Solid<'a> {
    /// The view: JavaScript for a script element.
    pub script: &'a str,
    /// How the robot's angles are read.
    pub reading: Reading,
    /// Files of the robot's meshes in base64, by what the robot calls them.
    pub meshes: BTreeMap<String, String>,
}

impl Solid<'_> {
    /// What the view draws, safe inside a script element; empty for a robot without links, such as a table.
    pub(super) fn json(&self, document: &Document) -> Option<String> {
        let robot = document.robot.as_ref()?;
        let chains: Vec<Value> = document.parts_from_one_base().into_iter().map(|part| chain(part, document)).collect();
        let solid = json!({ "scene": shapes::scene(robot, self.reading), "chains": chains, "meshes": self.meshes });
        // A name may hold "</script>".
        Some(solid.to_string().replace('<', "\\u003c"))
    }
}

/// The chain's coordinates in its own order, and its table; none if its frames are far from the robot.
fn chain(part: &ChainPart, document: &Document) -> Value {
    let coordinates: Vec<&str> = part.chain.coordinates().iter().map(|own| own.name.as_str()).collect();
    let sheet = Sheet {
        table: &part.table,
        convention: Convention::Distal,
        units: document.units,
        notes: &part.notes,
        source: &document.source,
        gauge: &part.gauge,
    };
    let render = || (formats::named("json")?.render)(&sheet).ok();
    let table = if far_from_scale(&part.table) { None } else { render() };
    let table: Option<Value> = table.and_then(|text| serde_json::from_str(&text).ok());
    json!({ "coordinates": coordinates, "base": part.chain.base(), "table": table })
}
