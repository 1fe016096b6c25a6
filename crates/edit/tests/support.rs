//! Finding robots, and asking for operations in words.

use denavit_edit::{Done, EditError, Files, Operation, Words, apply};
use std::path::{Path, PathBuf};

/// The top folder of the project.
pub fn top() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").canonicalize().unwrap()
}

/// Operations, separated by `;`, done to a text.
pub fn edit(text: &str, operations: &str) -> Result<Done, EditError> {
    edit_files(&Files::urdf("robot.urdf", text), operations)
}

/// The same with an SRDF beside.
pub fn edit_files(files: &Files, operations: &str) -> Result<Done, EditError> {
    let operation = |words: &str| Operation::of(&words_of(words));
    apply(files, &operations.split(';').map(operation).collect::<Result<Vec<_>, _>>()?)
}

/// The words of an operation, and its options.
pub fn words_of(line: &str) -> Words {
    Words::of(line.split_whitespace().map(str::to_owned)).unwrap()
}

/// Every file below `folder` with this extension, sorted.
pub fn files(folder: &Path, extension: &str) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let Ok(entries) = std::fs::read_dir(folder) else { return found };
    for entry in entries {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(files(&path, extension));
        } else if path.extension().is_some_and(|known| known == extension) {
            found.push(path);
        }
    }
    found.sort();
    found
}
