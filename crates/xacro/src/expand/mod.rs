//! The public operation and its values.

mod directives;
mod expander;
mod glob;
mod include;
mod macros;
mod output;
mod property;
mod substitutions;
mod values;

use std::path::{Path, PathBuf};

use crate::access::FileAccess;
use crate::error::{ErrorKind, XacroError};
use crate::limits::Limits;
use crate::packages::{Environment, PackagePath};
use crate::place::Place;
use crate::trace::Trace;

/// What is to be expanded.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub enum Source {
    /// A file.
    Path(PathBuf),
    /// A text, from standard input for example.
    Text {
        /// Its name in messages.
        name: String,
        /// The XML.
        text: String,
        /// Where relative file names begin; without it in the working directory.
        folder: Option<PathBuf>,
    },
}

impl Source {
    /// A file.
    pub fn path(path: impl Into<PathBuf>) -> Self {
        Self::Path(path.into())
    }

    /// A text with the name that messages give it, and no folder.
    pub fn text(name: impl Into<String>, text: impl Into<String>) -> Self {
        Self::Text { name: name.into(), text: text.into(), folder: None }
    }
}

/// How to expand. The default reads only near the document, with the default [`Limits`].
#[derive(Debug, Clone, Default)]
pub struct Options {
    /// Where `$(find …)` looks; the surroundings of the document are added to it.
    pub packages: PackagePath,
    /// What `$(env …)` and `$(optenv …)` see.
    pub environment: Environment,
    /// Which files may be read.
    pub access: FileAccess,
    /// Bounds on the resources of the document.
    pub limits: Limits,
    /// Whether the result includes the source of everything in it.
    pub trace: bool,
}

/// The result of an expansion.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub struct Expanded {
    /// The URDF, as text.
    pub urdf: String,
    /// Notes for the user, in the order in which they were found.
    pub notes: Vec<Note>,
    /// Every file that was read, the document first, each once.
    pub files_read: Vec<PathBuf>,
    /// The arguments that the document declares, in order.
    pub arguments: Vec<Argument>,
    /// The source of everything in it, if requested.
    pub trace: Option<Trace>,
}

/// Something that is not an error, but may be unintended.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Note {
    /// Where.
    pub place: Option<Place>,
    /// What.
    pub message: String,
}

impl Note {
    /// A note on the whole.
    pub fn of(message: impl Into<String>) -> Self {
        Self { place: None, message: message.into() }
    }
}

impl std::fmt::Display for Note {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if let Some(place) = &self.place {
            write!(formatter, "{place}: ")?;
        }
        formatter.write_str(&self.message)
    }
}

/// An `<xacro:arg>`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Argument {
    /// Its name.
    pub name: String,
    /// Its default, as written.
    pub default: Option<String>,
    /// The value that was used: the given one, or the default evaluated.
    pub value: String,
}

/// The expander recurses over the document, to [`Limits::depth`]: this holds the default in a debug build.
const STACK: usize = 256 << 20;

/// Expands xacro into URDF.
///
/// `arguments` are the `name:=value` of the command line, taken apart. A document without any xacro comes back with the
/// same content.
///
/// # Errors
/// The first failure, with its place and the calls that led there; the result is all or nothing.
///
/// # Validation
/// Tests `vendors_files_expand_as_the_python_tool_does` and `tests/oracle/xacro`: see `docs/xacro.md` for the figures.
///
/// # Examples
/// ```
/// use denavit_xacro::{ErrorKind, Options, Source, expand};
///
/// let xml = "<robot xmlns:xacro='http://ros.org/wiki/xacro'>\n<a b='${1 + lenght}'/></robot>";
/// let error = expand(&Source::text("arm.xacro", xml), &[], &Options::default()).unwrap_err();
/// assert_eq!(error.kind, ErrorKind::UndefinedName);
/// assert_eq!(error.place.unwrap().to_string(), "arm.xacro:2:13");
/// ```
pub fn expand(source: &Source, arguments: &[(String, String)], options: &Options) -> Result<Expanded, XacroError> {
    let work = || expander::run(source, arguments, options).map_err(|error| *error);
    // No thread can be started in a browser's WebAssembly.
    if cfg!(target_family = "wasm") {
        return work();
    }
    let held = crate::files::held();
    let work = move || crate::files::with(held, work);
    std::thread::scope(|scope| {
        let worker =
            std::thread::Builder::new()
                .name("xacro".to_owned())
                .stack_size(STACK)
                .spawn_scoped(scope, work)
                .map_err(|error| *XacroError::new(ErrorKind::Limit, format!("no thread can be started: {error}")))?;
        match worker.join() {
            Ok(result) => result,
            Err(panic) => std::panic::resume_unwind(panic),
        }
    })
}

/// The folder that relative names in a file begin in.
fn folder_of(file: &Path) -> &Path {
    file.parent().unwrap_or(Path::new(""))
}
