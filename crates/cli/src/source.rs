//! Loads robots as the arguments say, through `denavit_load`, and prints the notes of reading.

mod folder;

use crate::args::{ConventionName, RobotArguments, SeveralTips, SourceArguments};
use crate::failure::Failure;
use crate::output;
use denavit_export::UnknownUnit;
use denavit_export::sources::Stated;
use denavit_load::{Options, Selection, UrdfText};
use denavit_model::Quantity;
use denavit_model::units::Unit;
use denavit_model::words::quoted;

pub use denavit_load::Loaded;
pub use folder::{sources, srdf_files};

/// Reads a robot.
pub fn load(name: &str, arguments: &SourceArguments) -> Result<Loaded, Failure> {
    Ok(load_all(&[name], arguments)?.remove(0))
}

/// Reads several robots, in this order; arguments of xacro must be used by one of them.
pub fn load_all(names: &[&str], arguments: &SourceArguments) -> Result<Vec<Loaded>, Failure> {
    load_each(names, arguments)?.into_iter().collect()
}

/// The same, each robot or why it cannot be read.
pub fn load_each(names: &[&str], arguments: &SourceArguments) -> Result<Vec<Result<Loaded, Failure>>, Failure> {
    let options = Options { arguments_for_another: names.len() > 1, ..options(arguments)? };
    let mut any_is_xacro = false;
    let mut robots = Vec::new();
    for name in names {
        match denavit_load::load(name, &options) {
            Ok(opened) => {
                output::reads(&opened.includes)?;
                for note in &opened.notes {
                    output::mention(note);
                }
                any_is_xacro |= opened.is_xacro;
                robots.push(Ok(opened.robot));
            }
            Err(error) => robots.push(Err(error.into())),
        }
    }
    if robots.iter().all(Result::is_ok) {
        arguments.are_of_use(any_is_xacro)?;
    }
    Ok(robots)
}

/// Reads a robot only to see whether it is one.
pub fn load_quietly(name: &str, arguments: &SourceArguments) -> Result<Loaded, Failure> {
    let options = Options { arguments_for_another: true, ..options(arguments)? };
    Ok(denavit_load::load(name, &options)?.robot)
}

/// A source as URDF text, for what looks at URDF text.
pub fn urdf_text(file: &str, text: String, arguments: &SourceArguments) -> Result<UrdfText, Failure> {
    let options = Options { arguments_for_another: true, ..options(arguments)? };
    let urdf = denavit_load::urdf_text(file, text, &options, &denavit_export::urdf::Options::default())?;
    output::reads(&urdf.includes)?;
    urdf.notes.iter().for_each(output::mention);
    Ok(urdf)
}

/// Why a xacro file is a part of robots and not a robot by itself; `None` if it is a robot, or is broken.
pub fn why_a_part(file: &str, text: &str, arguments: &SourceArguments) -> Option<String> {
    let options = Options { arguments_for_another: true, ..options(arguments).ok()? };
    denavit_load::why_a_part(file, text, &options)
}

/// The URDF that a xacro document expands to.
pub fn expanded(file: &str, text: &str, arguments: &SourceArguments) -> Result<String, Failure> {
    let expanded = denavit_load::expanded(file, text, &options(arguments)?)?;
    output::reads(&expanded.files_read)?;
    for note in &expanded.notes {
        output::mention(note);
    }
    Ok(expanded.urdf)
}

/// The text of a file, of standard input (`-`), or of a file in git (`git:REVISION:PATH`), and what to call it.
pub fn read_text(name: &str) -> Result<(String, String), Failure> {
    Ok(denavit_load::read_text(name)?)
}

/// As [`read_text`], of whatever content.
pub fn read_bytes(name: &str) -> Result<(String, Vec<u8>), Failure> {
    Ok(denavit_load::read_bytes(name)?)
}

/// What the options say of how a table's file is to be read.
pub fn stated(arguments: &SourceArguments) -> Result<Stated, Failure> {
    let convention = arguments.table_convention.map(ConventionName::convention);
    let stated = Stated { convention, ..Stated::default() };
    stated.with_units(arguments.table_units.as_deref().unwrap_or_default()).map_err(|UnknownUnit { word, .. }| {
        Failure::Argument(format!("--table-units: \"{}\" is not a known unit, or a second unit of the same kind; write one of {} and one of {}",
            quoted(&word),
            Unit::words(Quantity::Length),
            Unit::words(Quantity::Angle)))
    })
}

/// What the options say of how a source is read.
pub fn options(arguments: &SourceArguments) -> Result<Options, Failure> {
    let pair = |word: &String| {
        let split = word.split_once(":=").map(|(name, value)| (name.to_owned(), value.to_owned()));
        split.ok_or_else(|| {
            Failure::Argument(format!("\"{word}\" is not an argument of a xacro file; write NAME:=VALUE"))
        })
    };
    Ok(Options {
        arguments: arguments.values.iter().map(pair).collect::<Result<_, Failure>>()?,
        package_path: arguments.package_path.clone(),
        allow_any_file: arguments.allow_any_file,
        vendor_angles: arguments.vendor_angles,
        stated: stated(arguments)?,
        ..Options::default()
    })
}

impl SourceArguments {
    /// Arguments of xacro are not used where no source is xacro.
    pub fn are_of_use(&self, any_is_xacro: bool) -> Result<(), Failure> {
        match self.values.first() {
            Some(word) if !any_is_xacro => Err(Failure::Argument(format!(
                "no source is a xacro file, so the argument {word} has no use; leave it out, or name the xacro file that the \
                 robot is made from"
            ))),
            _ => Ok(()),
        }
    }
}

impl RobotArguments {
    /// Which chain is chosen, and how it is read.
    pub fn selection(&self) -> Selection<'_> {
        Selection {
            file: &self.robot,
            base: self.base.as_deref(),
            tip: self.tip.tip.as_deref(),
            reading: self.reading(),
        }
    }
}

impl RobotArguments<SeveralTips> {
    /// Which tree is chosen, its tips aside, and how it is read.
    pub fn selection(&self) -> Selection<'_> {
        Selection { file: &self.robot, base: self.base.as_deref(), tip: None, reading: self.reading() }
    }
}
