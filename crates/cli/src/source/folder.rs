//! The robots in a folder.

use crate::args::SourceArguments;
use crate::failure::Failure;
use crate::output;
use denavit_model::formats::{Format, root_element};
use std::path::{Path, PathBuf};

/// The sources that words of the command line name; arguments of xacro files among them go to `arguments`. A folder means all
/// robots below it, except in hidden folders: every URDF, MJCF and SDF, and each xacro file, table and list of screw axes that
/// is a robot.
pub fn sources(words: &[String], arguments: &mut SourceArguments) -> Result<Vec<String>, Failure> {
    let mut names = Vec::new();
    for word in words {
        if word.contains(":=") && !Path::new(word).exists() {
            arguments.values.push(word.clone());
        } else {
            names.push(word.clone());
        }
    }
    let mut found = Vec::new();
    for name in names {
        let folder = Path::new(&name);
        if !folder.is_dir() {
            found.push(name);
            continue;
        }
        let robots = robots_in(folder, arguments)?;
        if robots.is_empty() {
            return Err(Failure::Argument(format!("{name}: there is no robot in this folder; name a file")));
        }
        found.extend(robots);
    }
    if found.is_empty() {
        return Err(Failure::Argument("no robot is named; name a file or a folder".into()));
    }
    Ok(found)
}

fn robots_in(folder: &Path, arguments: &SourceArguments) -> Result<Vec<String>, Failure> {
    let mut robots = Vec::new();
    for path in files_below(folder)? {
        let name = path.to_string_lossy().into_owned();
        let extension = path.extension().map(|extension| extension.to_string_lossy().to_ascii_lowercase());
        match extension.as_deref() {
            Some("urdf") => robots.push(name),
            Some("xml" | "mjcf" | "sdf") if is_a_model(&path) => robots.push(name),
            Some("xacro") => match super::load_quietly(&name, arguments) {
                Ok(_) => robots.push(name),
                Err(failure) => {
                    let reason = failure.to_string();
                    let reason = reason.lines().next().unwrap_or_default();
                    output::mention(format!("{name}: left out, as it is not a robot by itself: {reason}"));
                }
            },
            // A world may be a building. Folders of robots hold measurements and settings in these formats, too.
            Some("csv" | "json" | "yaml" | "yml" | "world") if super::load_quietly(&name, arguments).is_ok() => {
                robots.push(name);
            }
            _ => {}
        }
    }
    Ok(robots)
}

/// Whether a file is MJCF or SDF by its root element. Parts that others include are none, and neither is a scene around an
/// included robot: it has no body of its own.
fn is_a_model(path: &Path) -> bool {
    let text = match std::fs::read(path) {
        Ok(bytes) => String::from_utf8_lossy(&bytes).into_owned(),
        // Whoever reads it says why it cannot be read.
        Err(_) => return true,
    };
    match (Format::of_text(&text), root_element(&text)) {
        (Some(Format::Mjcf), Some("mujoco")) => text.contains("<body"),
        (Some(Format::Sdf), _) => true,
        _ => false,
    }
}

/// The SRDF files in the folders among words of the command line.
pub fn srdf_files(words: &[String]) -> Result<Vec<String>, Failure> {
    let mut found = Vec::new();
    for folder in words.iter().map(Path::new).filter(|path| path.is_dir()) {
        let files = files_below(folder)?.into_iter();
        let files = files.filter(|path| path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("srdf")));
        found.extend(files.map(|path| path.to_string_lossy().into_owned()));
    }
    Ok(found)
}

/// Every file below a folder, sorted; links to folders are not followed.
fn files_below(folder: &Path) -> Result<Vec<PathBuf>, Failure> {
    let failed =
        |error: std::io::Error| Failure::Argument(format!("{}: the folder cannot be read: {error}", folder.display()));
    let mut files = Vec::new();
    let mut entries = std::fs::read_dir(folder).map_err(failed)?.collect::<Result<Vec<_>, _>>().map_err(failed)?;
    entries.sort_by_key(std::fs::DirEntry::file_name);
    for entry in entries {
        let kind = entry.file_type().map_err(failed)?;
        if entry.file_name().to_string_lossy().starts_with('.') {
            continue;
        }
        if kind.is_dir() {
            files.extend(files_below(&entry.path())?);
        } else {
            files.push(entry.path());
        }
    }
    Ok(files)
}
