//! Reads a source by its name, and recognises its format.

use crate::revision::Home;
use crate::translate::{Translated, translated};
use crate::{LoadError, Loaded, Opened, Options};
use denavit_export::kinematics_yaml::AngleOrder;
use denavit_export::makers::{self, techman, ur_conf};
use denavit_export::sources::{self, Read, Source};
use denavit_model::Inventory;
use denavit_model::words::{one_line, quoted};
use denavit_xacro::{Environment, FileAccess, PackagePath, Source as Document, XacroError};
use std::io::Read as _;
use std::path::Path;

pub use denavit_xacro::Expanded;

/// What messages call standard input.
pub const STANDARD_INPUT: &str = "<stdin>";

/// Reads a robot by its name: a path, `-` for standard input, or `git:REVISION:PATH`.
///
/// # Errors
/// The source cannot be read, or is no robot.
pub fn load(name: &str, options: &Options) -> Result<Opened, LoadError> {
    let (file, text) = read_text(name)?;
    from_text(&file, &text, options)
}

/// Reads a robot from text; `file` is what messages call it, and its ending tells some formats apart.
///
/// # Errors
/// The text is no robot.
pub fn from_text(file: &str, text: &str, options: &Options) -> Result<Opened, LoadError> {
    let without_arguments = || match options.arguments.first() {
        Some((name, value)) if !options.arguments_for_another => {
            Err(LoadError::NoXacro { file: file.to_owned(), argument: format!("{name}:={value}") })
        }
        _ => Ok(()),
    };
    let plain = |robot| {
        without_arguments()?;
        Ok(Opened { robot, notes: Vec::new(), is_xacro: false, includes: Vec::new(), read: Inventory::default() })
    };
    let start = text.trim_start_matches('\u{feff}').trim_start();
    if ur_conf::is_one(start) {
        let model = options.arguments.iter().find(|(name, _)| name == ur_conf::MODEL_ARGUMENT);
        let read = ur_conf::read(file, &stem(file), text, model.map(|(_, value)| value.as_str()))?;
        // The argument is its own.
        return Ok(Opened { is_xacro: model.is_some(), ..opened(file, read)? });
    }
    if techman::is_one(start) {
        let read = techman::read(file, &stem(file), text)?;
        without_arguments()?;
        return opened(file, read);
    }
    if is_kinematics_file(file, start) {
        let order = if options.vendor_angles { AngleOrder::Vendor } else { AngleOrder::Urdf };
        let read = makers::read_whole(file, &stem(file), text, order, options.stated)?;
        without_arguments()?;
        return opened(file, read);
    }
    let is_table = [".csv", ".json", ".tsv"].iter().any(|end| file.to_ascii_lowercase().ends_with(end))
        || start.starts_with('{')
        || (!start.starts_with('<') && sources::holds_table(start));
    if is_table {
        let read = sources::read_whole(file, text, options.stated)?;
        without_arguments()?;
        return opened(file, read);
    }
    if !is_markup_by_name(file) && !start.starts_with('<') && !text.contains("<robot") && !start.is_empty() {
        let first = start.lines().next().unwrap_or_default();
        return Err(LoadError::NoRobot { file: file.to_owned(), begins: quoted(&one_line(first)).into_owned() });
    }
    if let Some(Translated { made, files }) = translated(file, text, options)? {
        let robot = made.robot(file)?;
        return Ok(Opened { includes: files, ..plain(Loaded::Robot(Box::new(robot)))? });
    }
    let is_xacro = denavit_xacro::is_xacro(text);
    let is_meant = is_xacro && (file.to_ascii_lowercase().ends_with(".xacro") || !options.arguments.is_empty());
    if !is_meant {
        match denavit_model::urdf::read(file, text) {
            // By another name it may hold xacro that a URDF reader cannot do without: plain URDFs often keep a stray
            // property or namespace.
            Err(_) if is_xacro => {}
            read => return plain(Loaded::Robot(Box::new(read?))),
        }
    }
    let Expanded { urdf, notes, files_read, .. } = expanded(file, text, options)?;
    let robot = denavit_model::urdf::read(&format!("{file} (expanded)"), &urdf)?;
    let notes = notes.iter().map(ToString::to_string).collect();
    let read = Inventory::default();
    Ok(Opened { robot: Loaded::Robot(Box::new(robot)), notes, is_xacro: true, includes: files_read, read })
}

/// A table or screw axes as a robot, with everything that must be said of the reading.
fn opened(file: &str, read: Read) -> Result<Opened, LoadError> {
    let refused = |source| LoadError::Chain { file: file.to_owned(), source };
    let chain = read.source.chain().map_err(refused)?;
    let robot = match read.source {
        Source::Table { table, convention } => Loaded::Table { table, convention, chain },
        Source::Poe(_) => Loaded::Poe(chain),
    };
    let notes = read.assumed.into_iter().chain(read.notes.iter().map(ToString::to_string)).collect();
    Ok(Opened { robot, notes, is_xacro: false, includes: Vec::new(), read: read.inventory })
}

/// By its name it is XML.
fn is_markup_by_name(file: &str) -> bool {
    let name = file.to_ascii_lowercase();
    [".urdf", ".xacro", ".xml", ".sdf", ".mjcf"].iter().any(|end| name.ends_with(end))
}

/// By its name, or by what it starts with where it has none.
fn is_kinematics_file(file: &str, start: &str) -> bool {
    let name = file.to_ascii_lowercase();
    let first = || start.lines().map(str::trim_end).find(|line| !line.is_empty() && !line.starts_with(['#', '-']));
    [".yaml", ".yml"].iter().any(|end| name.ends_with(end))
        || first().is_some_and(|line| {
            ["kinematics:", "joint1:"].contains(&line) || line.starts_with("opw_kinematics_geometric_parameters:")
        })
}

/// The name of a file without folders and extension.
fn stem(file: &str) -> String {
    Path::new(file).file_stem().map_or_else(|| file.to_owned(), |stem| stem.to_string_lossy().into_owned())
}

/// The URDF that a xacro document expands to.
///
/// Of a revision in git everything that the document includes comes from that revision; what is outside the repository is read
/// as it is now, with a note.
///
/// # Errors
/// The document does not expand.
pub fn expanded(file: &str, text: &str, options: &Options) -> Result<Expanded, LoadError> {
    expansion(file, text, options, false)
}

/// As [`expanded`], with the [trace](Expanded::trace) that says where everything comes from.
///
/// # Errors
/// The document does not expand.
pub fn expanded_with_trace(file: &str, text: &str, options: &Options) -> Result<Expanded, LoadError> {
    expansion(file, text, options, true)
}

fn expansion(file: &str, text: &str, options: &Options, trace: bool) -> Result<Expanded, LoadError> {
    let home = Home::of(file).map_err(|reason| LoadError::Read { file: file.to_owned(), reason })?;
    let mut expanded =
        home.within(|| expanded_on(file, &home, text, options, trace)).map_err(|error| home.error(error))?;
    if home.is_revision() {
        for note in &mut expanded.notes {
            note.message = home.shown_in(&note.message);
        }
        expanded.files_read.retain(|read| !home.holds(read));
        let outside = expanded.files_read.iter().map(|read| {
            denavit_xacro::Note::of(format!(
                "{file}: {} is outside the repository, so its present content was read, not that of the revision",
                read.display()
            ))
        });
        expanded.notes.extend(outside.collect::<Vec<_>>());
    }
    Ok(expanded)
}

fn expanded_on(file: &str, home: &Home, text: &str, options: &Options, trace: bool) -> Result<Expanded, XacroError> {
    let environment = environment();
    let settings = denavit_xacro::Options {
        packages: PackagePath::new(&options.package_path, &environment),
        environment,
        trace,
        access: if options.allow_any_file { FileAccess::Any } else { FileAccess::default() },
        ..denavit_xacro::Options::default()
    };
    let is_file = denavit_xacro::files::is_file(&home.path);
    let source = if is_file { Document::path(&home.path) } else { Document::text(file, text) };
    denavit_xacro::expand(&source, &options.arguments, &settings)
}

/// What `$(env …)` and package paths see: the variables of the process, where files are those of its disk.
pub(crate) fn environment() -> Environment {
    if denavit_xacro::files::are_held() {
        return Environment::default();
    }
    // No document can write a name that is not UTF-8.
    let named = std::env::vars_os().filter_map(|(name, value)| Some((name.into_string().ok()?, value.into_string())));
    let (mut readable, mut unreadable) = (Vec::new(), Vec::new());
    for (name, value) in named {
        match value {
            Ok(value) => readable.push((name, value)),
            Err(_) => unreadable.push(name),
        }
    }
    readable.into_iter().collect::<Environment>().with_unreadable(unreadable)
}

/// The text of a file, of standard input (`-`), or of a file in git (`git:REVISION:PATH`), and what to call it.
///
/// # Errors
/// The file cannot be read, or is no UTF-8 text.
pub fn read_text(name: &str) -> Result<(String, String), LoadError> {
    let (file, bytes) = read_bytes(name)?;
    let text = String::from_utf8(bytes).map_err(|error| {
        let valid = &error.as_bytes()[..error.utf8_error().valid_up_to()];
        LoadError::NotText { file: file.clone(), line: 1 + String::from_utf8_lossy(valid).matches('\n').count() }
    })?;
    Ok((file, text))
}

/// As [`read_text`], of whatever content.
///
/// # Errors
/// The file cannot be read.
pub fn read_bytes(name: &str) -> Result<(String, Vec<u8>), LoadError> {
    let failed = |reason: String| LoadError::Read { file: name.to_owned(), reason };
    let (file, bytes) = if name == "-" {
        let mut bytes = Vec::new();
        std::io::stdin().lock().read_to_end(&mut bytes).map_err(|error| failed(error.to_string()))?;
        (STANDARD_INPUT.to_owned(), bytes)
    } else if let Some(object) = name.strip_prefix("git:") {
        (name.to_owned(), from_git(object).map_err(failed)?)
    } else {
        (name.to_owned(), denavit_xacro::files::read(Path::new(name)).map_err(|error| failed(error.to_string()))?)
    };
    Ok((file, bytes))
}

/// The content of REVISION:PATH as git has it, or why there is none. Nothing in the name reaches git as an option.
fn from_git(object: &str) -> Result<Vec<u8>, String> {
    let Some((revision, path)) = object.split_once(':') else {
        return Err("write git:REVISION:PATH, such as git:HEAD:arm.urdf".into());
    };
    if revision.starts_with('-') || path.starts_with('-') {
        return Err("neither a revision nor a path may begin with \"-\"; write ./-… for such a path".into());
    }
    if Path::new(path).is_absolute() {
        let home = Home::of(&format!("git:{object}"))?;
        return home.within(|| denavit_xacro::files::read(&home.path)).map_err(|error| error.to_string());
    }
    let shown = std::process::Command::new("git").args(["cat-file", "--end-of-options", "blob", object]).output();
    let shown = shown.map_err(|error| format!("git could not be run: {error}"))?;
    if !shown.status.success() {
        return Err(String::from_utf8_lossy(&shown.stderr).trim().to_owned());
    }
    // Git keeps a link as a file with the name that it leads to.
    if shown.stdout.len() < LONGEST_LINK && !shown.stdout.contains(&b'\n') {
        let home = Home::of(&format!("git:{object}"))?;
        return home.within(|| denavit_xacro::files::read(&home.path)).map_err(|error| error.to_string());
    }
    Ok(shown.stdout)
}

/// PATH_MAX of Linux, bytes.
const LONGEST_LINK: usize = 4096;
