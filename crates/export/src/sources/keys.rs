//! Keys of a JSON file that its reader does not know.

use super::place;
use denavit_model::Inventory;
use denavit_model::notes::Note;
use denavit_model::words::quoted;
use serde_json::Value;

/// What is known below a key.
pub(super) enum Shape {
    /// A value that is read, or that only states the origin of the file.
    Value,
    /// These keys.
    Object(&'static [(&'static str, Self)]),
    /// A list of alike things.
    List(&'static Self),
}

use Shape::{List, Object, Value as One};

const UNITS: Shape = Object(&[("length", One), ("angle", One)]);
const COORDINATES: Shape = List(&Object(&[
    ("name", One),
    ("quantity", One),
    ("continuous", One),
    ("limits", Object(&[("lower", One), ("upper", One), ("velocity", One), ("effort", One)])),
]));

/// `denavit.table/1`; notes and bounds describe the source of the file.
pub(super) const TABLE: Shape = Object(&[
    ("schema", One),
    ("robot", One),
    ("base", One),
    ("tip", One),
    ("source", One),
    ("convention", One),
    ("gauge", One),
    ("units", UNITS),
    ("coordinates", COORDINATES),
    ("joints", List(&Object(&[("name", One), ("kind", One), ("coordinate", One), ("pitch", One), ("scale", One)]))),
    ("rows", List(&Object(&[("row", One), ("theta", One), ("d", One), ("alpha", One), ("a", One), ("beta", One)]))),
    ("tip_moves_at_most", One),
    ("notes", One),
]);

/// `denavit.poe/1`.
pub(super) const POE: Shape = Object(&[
    ("schema", One),
    ("robot", One),
    ("base", One),
    ("tip", One),
    ("units", UNITS),
    ("coordinates", COORDINATES),
    (
        "joints",
        List(&Object(&[
            ("name", One),
            ("kind", One),
            ("coordinate", One),
            ("twist", One),
            ("pitch", One),
            ("scale", One),
            ("offset", One),
        ])),
    ),
    ("home", One),
    ("notes", One),
]);

/// A note for each key that is not known.
pub(super) fn unknown(file: &str, text: &str, value: &Value, shape: &Shape) -> (Vec<Note>, Inventory) {
    let mut found = Vec::new();
    let mut inventory = Inventory::default();
    walk("", value, shape, &mut found, &mut inventory);
    let mut notes = Vec::new();
    for (path, key) in found {
        let line = line_of(text, &key);
        let place = place(file, line, format!("key \"{}\"", quoted(&path)));
        let what = "the key is unknown and was ignored".to_owned();
        inventory.report(place.clone(), what.clone());
        notes.push(Note::NotUnderstood { place, what });
    }
    (notes, inventory)
}

fn walk(path: &str, value: &Value, shape: &Shape, found: &mut Vec<(String, String)>, inventory: &mut Inventory) {
    match (shape, value) {
        (Object(known), Value::Object(entries)) => {
            for (key, value) in entries {
                let path = if path.is_empty() { key.clone() } else { format!("{path}.{key}") };
                match known.iter().find(|(name, _)| name == key) {
                    Some((_, shape)) => walk(&path, value, shape, found, inventory),
                    None => found.push((path, key.clone())),
                }
            }
        }
        (List(shape), Value::Array(values)) => {
            for (index, value) in values.iter().enumerate() {
                walk(&format!("{path}[{index}]"), value, shape, found, inventory);
            }
        }
        _ => inventory.understand(),
    }
}

/// The first line that has this key, counted from 1.
pub(super) fn line_of(text: &str, key: &str) -> usize {
    let written = serde_json::to_string(key).unwrap_or_default();
    let at = text.find(&written).unwrap_or(0);
    1 + text[..at].matches('\n').count()
}
