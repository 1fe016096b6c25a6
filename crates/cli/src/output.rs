//! Printing, colours and exit codes, and files that are never half-written.

#![expect(clippy::print_stderr, reason = "this module is where the program speaks")]

use crate::failure::Failure;
use denavit_compare::report::Colour;
use denavit_load::LoadError;
use denavit_model::notes::Note;
use std::io::{self, IsTerminal as _, Write as _};
use std::path::Path;
use tempfile::NamedTempFile;

/// Exit codes, as those of `diff`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum Status {
    /// Done; the same; nothing found.
    Same = 0,
    /// Different; something found.
    Different = 1,
    /// The work could not be done.
    Trouble = 2,
}

/// Writes text to standard output.
pub fn print(text: &str) -> Result<(), Failure> {
    let mut out = io::stdout().lock();
    out.write_all(text.as_bytes()).and_then(|()| out.flush()).map_err(|error| match error.kind() {
        io::ErrorKind::BrokenPipe => Failure::ClosedPipe,
        _ => Failure::Write { file: "standard output".into(), reason: error.to_string() },
    })
}

/// Says what went wrong.
pub fn complain(failure: &Failure) {
    let text = failure.to_string();
    let each_line = matches!(failure, Failure::Load(LoadError::Urdf(_)));
    for (index, line) in text.lines().enumerate() {
        // A URDF's problems stand a line each; other messages go on in their own lines.
        let mark = if each_line || index == 0 { "error: " } else { "" };
        eprintln!("{mark}{line}");
    }
}

/// Says on standard error what the output on standard output has no place for.
pub fn remark(notes: &[Note]) {
    for note in notes {
        eprintln!("note: {note}");
    }
}

/// Says on standard error what is no error, but may not be meant.
pub fn mention(text: impl std::fmt::Display) {
    eprintln!("note: {text}");
}

/// Whether text on standard output is coloured: on a terminal that has not been told otherwise.
pub fn colour(to_standard_output: bool) -> Colour {
    let plain = std::env::var_os("NO_COLOR").is_some_and(|value| !value.is_empty());
    if to_standard_output && !plain && io::stdout().is_terminal() { Colour::Ansi } else { Colour::None }
}

/// Writes a file as a whole or not at all: to a temporary file beside it, then renamed.
pub fn write_file(path: &Path, content: &[u8]) -> Result<(), Failure> {
    persist(written(path, content)?, path)
}

/// Writes several files: every temporary file is full before the first is renamed.
pub fn write_files(files: &[(&Path, String)]) -> Result<(), Failure> {
    for (index, (path, _)) in files.iter().enumerate() {
        if files[..index].iter().any(|(other, _)| other == path) {
            let message = format!("{}: two outputs have this name; give each a file of its own", path.display());
            return Err(Failure::Argument(message));
        }
        if path.is_dir() {
            let reason = "it is a folder".to_owned();
            return Err(Failure::Write { file: path.display().to_string(), reason });
        }
    }
    let full = files.iter().map(|(path, text)| written(path, text.as_bytes())).collect::<Result<Vec<_>, _>>()?;
    full.into_iter().zip(files).try_for_each(|(file, (path, _))| persist(file, path))
}

fn failed(path: &Path, error: &io::Error) -> Failure {
    Failure::Write { file: path.display().to_string(), reason: error.to_string() }
}

/// A temporary file beside `path` with this content.
fn written(path: &Path, content: &[u8]) -> Result<NamedTempFile, Failure> {
    let failed = |error: io::Error| failed(path, &error);
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    if !folder.is_dir() {
        let reason = format!("there is no folder {}", folder.display());
        return Err(Failure::Write { file: path.display().to_string(), reason });
    }
    let mut file = tempfile::Builder::new().prefix(".denavit-").tempfile_in(folder).map_err(failed)?;
    file.write_all(content).map_err(failed)?;
    if let Some(permissions) = permissions(path) {
        file.as_file().set_permissions(permissions).map_err(failed)?;
    }
    Ok(file)
}

fn persist(file: NamedTempFile, path: &Path) -> Result<(), Failure> {
    file.persist(path).map(drop).map_err(|error| failed(path, &error.error))
}

/// What the file has, or what one gets that is made in the usual way: temporary files are closed to others.
#[cfg(unix)]
fn permissions(path: &Path) -> Option<std::fs::Permissions> {
    use std::os::unix::fs::PermissionsExt as _;
    let existing = std::fs::metadata(path).map(|existing| existing.permissions());
    Some(existing.unwrap_or_else(|_| std::fs::Permissions::from_mode(0o644)))
}

/// Windows gives a new file the rights of its folder.
#[cfg(not(unix))]
fn permissions(_: &Path) -> Option<std::fs::Permissions> {
    None
}
