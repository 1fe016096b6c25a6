//! Descriptions in other formats than URDF, by what they hold and not by their names, as URDF text.

use crate::revision::Home;
use crate::{LoadError, Options};
use denavit_model::formats::{Builder, Format, FormatError};
use denavit_xacro::files;
use std::cell::RefCell;
use std::path::{Path, PathBuf};

/// A description in another format as URDF text, which carries the places of its source, or as the robot that it says.
#[derive(Debug)]
pub(crate) struct Translated {
    pub made: Builder,
    /// Files that it made us read.
    pub files: Vec<PathBuf>,
}

/// What gives the files that a description names: the name, the file that it is in; the path and the content.
type Content<'a> = dyn FnMut(&str, &str) -> Result<(PathBuf, Vec<u8>), String> + 'a;

/// A reader of a format: the file's name, its text, and what gives the files that it names.
type Reader = fn(&str, &str, &mut Content) -> Result<Builder, FormatError>;

fn reader(format: Format) -> Option<Reader> {
    match format {
        Format::Mjcf => Some(|file, text, files| {
            denavit_mjcf::translated(file, text, &mut |name| files(name, file).map(|(_, bytes)| bytes))
        }),
        Format::Sdf => Some(|file, text, files| {
            denavit_sdf::translated(file, text, &mut |uri, from| {
                let (path, bytes) = files(uri, from)?;
                let text = String::from_utf8(bytes).map_err(|_| format!("{} is not UTF-8 text", path.display()))?;
                Ok((path.display().to_string(), text))
            })
        }),
        _ => None,
    }
}

/// Endings of files that a description may include without `allow_any_file`: nothing else is put before anybody's eyes.
const DESCRIPTIONS: [&str; 4] = ["xml", "mjcf", "sdf", "urdf"];

/// Endings of mesh files, whose volume may give a mass.
const MESHES: [&str; 3] = ["stl", "obj", "msh"];

/// A text as URDF, where it is in another format that is read here; `None` where it is in none.
pub(crate) fn translated(file: &str, text: &str, options: &Options) -> Result<Option<Translated>, LoadError> {
    let Some(read) = Format::of_text(text).and_then(reader) else { return Ok(None) };
    let home = Home::of(file).map_err(|reason| LoadError::Read { file: file.to_owned(), reason })?;
    let found = RefCell::new(Vec::new());
    let made = home.within(|| {
        read(file, text, &mut |name, from| {
            let from = if from == file { &home.path } else { Path::new(from) };
            let (path, bytes) = content(from, name, options)?;
            found.borrow_mut().push(path.clone());
            Ok((path, bytes))
        })
    });
    let made = made?;
    Ok(Some(Translated { made, files: found.into_inner().into_iter().filter(|path| !home.holds(path)).collect() }))
}

/// A file that a description names, beside the description or in a package.
fn content(from: &Path, name: &str, options: &Options) -> Result<(PathBuf, Vec<u8>), String> {
    let packages = denavit_xacro::PackagePath::new(&options.package_path, &crate::read::environment()).near(from);
    let path = model_in(packages.resolve(name, Some(from)).map_err(|error| error.to_string()), name, from)?;
    let real = files::canonical(&path).map_err(|_| format!("there is no file {}", path.display()))?;
    let ending = real.extension().map(|ending| ending.to_string_lossy().to_ascii_lowercase()).unwrap_or_default();
    if !options.allow_any_file && ![&DESCRIPTIONS[..], &MESHES[..]].concat().contains(&ending.as_str()) {
        return Err(format!("{} is neither a description nor a mesh; ‹allow-any-file› reads it", path.display()));
    }
    let bytes = files::read(&real).map_err(|error| format!("{}: {error}", path.display()))?;
    Ok((path, bytes))
}

/// A model's file where a name stands for its folder, as in SDF: `model.config` says which; models stand beside each other.
fn model_in(found: Result<PathBuf, String>, name: &str, from: &Path) -> Result<PathBuf, String> {
    let beside = || Some(from.parent()?.parent()?.join(name.strip_prefix("model://")?));
    let path = match found {
        Ok(path) if files::exists(&path) => path,
        found => beside().filter(|path| files::exists(path)).map_or(found, Ok)?,
    };
    if !files::is_folder(&path) {
        return Ok(path);
    }
    let config = files::read(&path.join("model.config")).ok().and_then(|bytes| String::from_utf8(bytes).ok());
    let named = config.and_then(|config| denavit_sdf::includes::model_file(&config));
    Ok(path.join(named.unwrap_or_else(|| "model.sdf".to_owned())))
}
