//! Any source as URDF text, for what looks at the text and not at the robot alone.

use crate::read::{Expanded, expanded, from_text};
use crate::translate::{Translated, translated};
use crate::{LoadError, Options, canonical};
use denavit_export::urdf;
use denavit_model::{Problem, ProblemKind};
use std::path::PathBuf;

/// A source as URDF text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct UrdfText {
    /// What messages call it.
    pub shown: String,
    /// The text.
    pub text: String,
    /// Whether it was xacro.
    pub is_xacro: bool,
    /// What the expansion of a xacro file has to say.
    pub notes: Vec<String>,
    /// Files that the source includes: those of a xacro file, and its yaml.
    pub includes: Vec<PathBuf>,
}

/// A source as URDF text. URDF stays as it is, broken or not; xacro is expanded; another format is translated, with its places
/// inside; what a table or screw axes stand for is
/// made as `written` says.
///
/// # Errors
/// A xacro file that does not expand, or a source that is neither and no robot.
pub fn urdf_text(file: &str, text: String, options: &Options, written: &urdf::Options) -> Result<UrdfText, LoadError> {
    let plain = |shown: String, text: String| UrdfText {
        shown,
        text,
        is_xacro: false,
        notes: Vec::new(),
        includes: Vec::new(),
    };
    if !is_markup(file, &text) {
        let opened = from_text(file, &text, options)?;
        let urdf = canonical(&opened.robot, file, written)?.value;
        // Parts of a table that are not understood are noted, also for readers of its URDF.
        return Ok(UrdfText {
            notes: opened.notes,
            is_xacro: opened.is_xacro,
            ..plain(format!("{file} (as URDF)"), urdf)
        });
    }
    if let Some(Translated { made, files }) = translated(file, &text, options)? {
        return Ok(UrdfText { includes: files, ..plain(format!("{file} (as URDF)"), made.text()) });
    }
    let is_meant =
        || is_named(file, ".xacro") || !options.arguments.is_empty() || denavit_model::urdf::read(file, &text).is_err();
    if denavit_xacro::is_xacro(&text) && is_meant() {
        let Expanded { urdf, notes, files_read, .. } = expanded(file, &text, options)?;
        let notes = notes.iter().map(ToString::to_string).collect();
        return Ok(UrdfText {
            is_xacro: true,
            notes,
            includes: files_read,
            ..plain(format!("{file} (expanded)"), urdf)
        });
    }
    Ok(plain(file.to_owned(), text))
}

/// Why a xacro file is a part of robots and not a robot by itself; `None` if it is a robot, or is broken.
///
/// A part uses names that only the file that includes it defines, or defines macros and makes no link.
pub fn why_a_part(file: &str, text: &str, options: &Options) -> Option<String> {
    let first_line = |words: String| words.lines().next().unwrap_or_default().to_owned();
    match expanded(file, text, options) {
        Ok(Expanded { urdf, .. }) => {
            let error = denavit_model::urdf::read(file, &urdf).err()?;
            let is_part = |problem: &Problem| matches!(problem.kind, ProblemKind::NoLinks | ProblemKind::NoRobot(_));
            error.problems.iter().find(|problem| is_part(problem)).map(|problem| problem.kind.to_string())
        }
        Err(LoadError::Xacro(error)) => {
            use denavit_xacro::ErrorKind::{UndefinedArgument, UndefinedMacro, UndefinedName};
            let is_part = matches!(error.kind, UndefinedName | UndefinedMacro | UndefinedArgument);
            is_part.then(|| first_line(error.to_string()))
        }
        Err(_) => None,
    }
}

/// Whether a source is read as URDF or xacro, valid or broken, and not as a table or screw axes.
pub fn is_markup(file: &str, text: &str) -> bool {
    let start = text.trim_start_matches('\u{feff}').trim_start();
    is_named(file, ".urdf") || start.is_empty() || start.starts_with(['<', '\0'])
}

fn is_named(file: &str, end: &str) -> bool {
    file.to_ascii_lowercase().ends_with(end)
}
