//! The toolkit for a web page: one call with a question and an answer in JSON.
//!
//! ```text
//! {"ask": "table", "source": {"file": "arm.urdf", "text": "<robot …"}, …} ──► answer() ──► {"text": "…"} or {"error": "…"}
//! ```
//! No file is opened or written, and nothing is sent or stored: a question contains the texts that it is about, and answers that the command
//! line also has are the same text as its `--json`. The documents of the answers are described in `docs/explorer.md`.

mod answers;
mod edits;
mod effects;
mod measured;
mod memory;
mod question;
mod reach;
mod twists;

pub use question::{Question, RobotText};

use denavit_model::settings::plain;
use denavit_xacro::files;
use std::sync::Arc;

/// Answers a question; both are JSON. An answer with `error` states in one sentence what is wrong and how to fix it.
pub fn answer(question: &str) -> String {
    let answered = serde_json::from_str::<Question>(question)
        .map_err(|error| format!("the page sent an unknown request: {error}"))
        .and_then(|question| files::with(Some(Arc::new(question.files())), || answers::of(&question)));
    let answer = answered.unwrap_or_else(|error| serde_json::json!({ "error": error }));
    plain(answer)
}
