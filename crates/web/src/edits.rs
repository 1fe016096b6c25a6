//! Edits of the current robot, each with its proof.

use crate::answers::words;
use crate::question::RobotText;
use denavit_edit::{Files, OPERATIONS, Operation, Text, Words, apply, unified_diff};
use serde_json::{Value, json};

/// Operations that need a maker's file or the contents of mesh files, which a page does not have.
const OF_FILES: [&str; 3] = ["set-calibration", "simplify-collision", "meshes"];

/// The operations that a page can do: `name`, `usage`, `purpose` of each.
pub fn possible() -> Value {
    let operations = OPERATIONS.iter().filter(|known| !OF_FILES.contains(&known.name));
    let operations: Vec<Value> =
        operations.map(|known| json!({ "name": known.name, "usage": known.usage, "purpose": known.purpose })).collect();
    json!({ "operations": operations })
}

/// The edited `text`, its proof in `said`, further notes in `notes`, and the changed lines in `diff`.
/// `other` is the robot that one of the arguments names.
pub fn edited(source: &RobotText, asked: &[String], other: Option<&RobotText>) -> Result<Value, String> {
    let text = |source: &RobotText| source.urdf().map(|(file, text)| Text { file, text });
    let before = text(source)?;
    let mut line = Words::of(asked.iter().cloned()).map_err(words)?;
    if line.takes_a_robot() {
        line.other = other.map(text).transpose()?;
    }
    let operation = Operation::of(&line).map_err(words)?;
    let done = apply(&Files::urdf(before.file.clone(), before.text.clone()), &[operation]).map_err(words)?;
    let said: Vec<String> = done.reports.iter().map(ToString::to_string).collect();
    let notes: Vec<&String> = done.reports.iter().flat_map(|report| &report.notes).collect();
    let diff = unified_diff(&before, &done.files.urdf);
    Ok(json!({ "text": done.files.urdf.text, "said": said, "notes": notes, "diff": diff }))
}
