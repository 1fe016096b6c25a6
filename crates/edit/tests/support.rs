//! Finding robots, and asking for operations in words.

#[path = "../../../tests/files.rs"]
mod files;
pub use files::{files, top};

use denavit_edit::{Done, EditError, Files, Operation, Words, apply};

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
