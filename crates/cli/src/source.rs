//! Any source to a robot: URDF, xacro, D-H table in CSV, Markdown or JSON, screw axes in CSV or JSON, a maker's kinematics file, standard input, a
//! revision in git.

use crate::args::{ConventionName, RobotArguments, SourceArguments};
use crate::failure::Failure;
use crate::output;
use denavit_calibrate::effects::driver::Statics;
use denavit_compare::Subject;
use denavit_dh::{Convention, Table};
use denavit_export::kinematics_yaml::AngleOrder;
use denavit_export::makers;
use denavit_export::sources::{self, Source, Stated};
use denavit_model::notes::{Note, Noted};
use denavit_model::{Chain, Reading, Robot};
use denavit_xacro::{Environment, FileAccess, Options, PackagePath, Source as Document};
use std::io::Read as _;

/// A robot as its source gives it.
pub enum Loaded {
    /// A tree.
    Robot(Box<Robot>),
    /// Denavit-Hartenberg numbers.
    Table {
        /// The numbers.
        table: Table,
        /// How the file groups them.
        convention: Convention,
        /// What they stand for.
        chain: Chain,
    },
    /// Screw axes.
    Poe(Chain),
}

/// Reads a robot.
pub fn load(name: &str, arguments: &SourceArguments) -> Result<Loaded, Failure> {
    let (file, text) = read_text(name)?;
    let start = text.trim_start_matches('\u{feff}').trim_start();
    if is_kinematics_file(&file, start) {
        let order = if arguments.vendor_angles { AngleOrder::Vendor } else { AngleOrder::Urdf };
        return Ok(Loaded::Poe(makers::read(&file, &stem(&file), &text, order)?));
    }
    let is_table = [".csv", ".json", ".tsv"].iter().any(|end| file.to_ascii_lowercase().ends_with(end))
        || start.starts_with('{')
        || (file == STANDARD_INPUT && !start.is_empty() && !start.starts_with('<'))
        || (!start.starts_with('<') && sources::holds_table(start));
    if is_table {
        return Ok(match sources::read(&file, &text, stated(arguments)?)? {
            Source::Table { table, convention, assumed } => {
                assumed.iter().for_each(output::mention);
                let chain = table.chain().map_err(|source| Failure::Chain { file: file.clone(), source })?;
                Loaded::Table { table, convention, chain }
            }
            Source::Poe(chain) => Loaded::Poe(chain),
        });
    }
    let is_xacro = denavit_xacro::is_xacro(&text);
    let is_meant = is_xacro && (file.to_ascii_lowercase().ends_with(".xacro") || !arguments.values.is_empty());
    if !is_meant {
        match denavit_model::urdf::read(&file, &text) {
            // By another name it may hold xacro that a URDF reader cannot do without: plain URDFs often keep a stray
            // property or namespace.
            Err(_) if is_xacro => {}
            read => return Ok(Loaded::Robot(Box::new(read?))),
        }
    }
    let urdf = expanded(&file, &text, arguments)?;
    Ok(Loaded::Robot(Box::new(denavit_model::urdf::read(&format!("{file} (expanded)"), &urdf)?)))
}

/// What the options say of how a table's file is to be read.
pub fn stated(arguments: &SourceArguments) -> Result<Stated, Failure> {
    let convention = arguments.table_convention.map(ConventionName::convention);
    let stated = Stated { convention, ..Stated::default() };
    stated.with_units(arguments.table_units.as_deref().unwrap_or_default()).map_err(|word| {
        Failure::Argument(format!("--table-units: \"{word}\" is no unit; write m or mm, and deg or rad"))
    })
}

/// By its name, or by what it starts with where it has none.
fn is_kinematics_file(file: &str, start: &str) -> bool {
    let name = file.to_ascii_lowercase();
    let first = || start.lines().map(str::trim_end).find(|line| !line.is_empty() && !line.starts_with(['#', '-']));
    [".yaml", ".yml"].iter().any(|end| name.ends_with(end))
        || first().is_some_and(|line| ["kinematics:", "joint1:"].contains(&line))
}

/// The name of a file without folders and extension.
fn stem(file: &str) -> String {
    std::path::Path::new(file).file_stem().map_or_else(|| file.to_owned(), |stem| stem.to_string_lossy().into_owned())
}

/// The URDF that a xacro document stands for.
pub fn expanded(file: &str, text: &str, arguments: &SourceArguments) -> Result<String, Failure> {
    let mut pairs = Vec::new();
    for word in &arguments.values {
        let (name, value) = word.split_once(":=").ok_or_else(|| {
            Failure::Argument(format!("\"{word}\" is no argument of a xacro file; write NAME:=VALUE"))
        })?;
        pairs.push((name.to_owned(), value.to_owned()));
    }
    let environment: Environment = std::env::vars().collect();
    let options = Options {
        packages: PackagePath::new(&arguments.package_path, &environment),
        environment,
        access: if arguments.allow_any_file { FileAccess::Any } else { FileAccess::default() },
        ..Options::default()
    };
    let source = if std::path::Path::new(file).is_file() { Document::path(file) } else { Document::text(file, text) };
    let expanded = denavit_xacro::expand(&source, &pairs, &options)?;
    for note in &expanded.notes {
        output::mention(note);
    }
    Ok(expanded.urdf)
}

/// What messages call standard input.
const STANDARD_INPUT: &str = "<stdin>";

/// The text of a file, of standard input (`-`), or of a file in git (`git:REVISION:PATH`), and what to call it.
pub fn read_text(name: &str) -> Result<(String, String), Failure> {
    let failed = |reason: String| Failure::Read { file: name.to_owned(), reason };
    let (file, bytes) = if name == "-" {
        let mut bytes = Vec::new();
        std::io::stdin().lock().read_to_end(&mut bytes).map_err(|error| failed(error.to_string()))?;
        (STANDARD_INPUT.to_owned(), bytes)
    } else if let Some(object) = name.strip_prefix("git:") {
        let shown = std::process::Command::new("git").args(["show", object]).output();
        let shown = shown.map_err(|error| failed(format!("git could not be run: {error}")))?;
        if !shown.status.success() {
            return Err(failed(String::from_utf8_lossy(&shown.stderr).trim().to_owned()));
        }
        (name.to_owned(), shown.stdout)
    } else {
        (name.to_owned(), std::fs::read(name).map_err(|error| failed(error.to_string()))?)
    };
    let text = String::from_utf8(bytes).map_err(|error| {
        let valid = &error.as_bytes()[..error.utf8_error().valid_up_to()];
        Failure::NotText { file: file.clone(), line: 1 + String::from_utf8_lossy(valid).matches('\n').count() }
    })?;
    Ok((file, text))
}

impl Loaded {
    /// The chain that the arguments choose, with everything that must be said of it.
    pub fn chain(&self, arguments: &RobotArguments) -> Result<Noted<Chain>, Failure> {
        let file = || arguments.robot.clone();
        let chain = match self {
            Self::Robot(robot) => {
                let reading = if arguments.exact { Reading::AsWritten } else { Reading::Intended };
                let Noted { value, notes } =
                    robot.chain(arguments.base.as_deref(), arguments.tip.as_deref(), reading)?;
                let mut all: Vec<Note> = robot.notes.clone();
                all.extend(notes);
                return Ok(Noted { value, notes: all });
            }
            Self::Table { chain, .. } | Self::Poe(chain) => chain,
        };
        for (option, link, given) in [("--base", chain.base(), &arguments.base), ("--tip", chain.tip(), &arguments.tip)]
        {
            if given.as_ref().is_some_and(|given| given != link) {
                let message = format!(
                    "{}: {option} chooses a link of a URDF; this file has one chain, ending at \"{link}\"",
                    file()
                );
                return Err(Failure::Argument(message));
            }
        }
        Ok(Noted { value: chain.clone(), notes: Vec::new() })
    }

    /// The chain and what gravity acts on.
    pub fn statics(&self, chain: &Chain) -> Statics {
        match self {
            Self::Robot(robot) => Statics::of(robot, chain),
            Self::Table { .. } | Self::Poe(_) => Statics::of_chain(chain),
        }
    }

    /// What a comparison takes.
    pub fn subject<'a>(&'a self, file: &'a str) -> Subject<'a> {
        match self {
            Self::Robot(robot) => Subject::Robot(robot),
            Self::Table { chain, .. } | Self::Poe(chain) => Subject::Chain { file, chain },
        }
    }
}
