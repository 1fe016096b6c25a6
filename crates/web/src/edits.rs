//! Edits of the robot at hand, each with its proof.

use crate::answers::words;
use crate::question::RobotText;
use denavit_edit::{Files, OPERATIONS, Operation, Words, apply};
use serde_json::{Value, json};

/// Operations that take a second file, or what mesh files hold, which a page has not.
const OF_FILES: [&str; 4] = ["attach", "set-calibration", "simplify-collision", "meshes"];

/// The operations that a page can do: `name`, `usage`, `purpose` of each.
pub fn possible() -> Value {
    let operations = OPERATIONS.iter().filter(|known| !OF_FILES.contains(&known.name));
    let operations: Vec<Value> =
        operations.map(|known| json!({ "name": known.name, "usage": known.usage, "purpose": known.purpose })).collect();
    json!({ "operations": operations })
}

/// The edited `text`, what is proved of it in `said`, and what else is to be said in `notes`.
pub fn edited(source: &RobotText, asked: &[String]) -> Result<Value, String> {
    let (file, text) = source.urdf()?;
    let operation = Words::of(asked.iter().cloned()).and_then(|words| Operation::of(&words)).map_err(words)?;
    let done = apply(&Files::urdf(file, text), &[operation]).map_err(words)?;
    let said: Vec<String> = done.reports.iter().map(ToString::to_string).collect();
    let notes: Vec<&String> = done.reports.iter().flat_map(|report| &report.notes).collect();
    Ok(json!({ "text": done.files.urdf.text, "said": said, "notes": notes }))
}
