//! `denavit check`: URDF files against numbered rules.

use crate::args::CheckArguments;
use crate::failure::Failure;
use crate::output::{self, Status};
use crate::source;
use denavit_compare::lint::config::FILE_NAME;
use denavit_compare::lint::{self, Config, Lookup};
use denavit_compare::report::{self, Report};
use denavit_xacro::{Environment, PackagePath};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// Runs the command.
pub fn run(arguments: &CheckArguments) -> Result<Status, Failure> {
    if arguments.rules {
        let mut text = String::new();
        for rule in lint::RULES {
            let _ = writeln!(text, "{}  {:<26} {}", rule.code, rule.name, rule.summary);
        }
        output::print(&text)?;
        return Ok(Status::Same);
    }
    if let Some(name) = &arguments.explain {
        let rule = lint::rule(name).ok_or_else(|| {
            Failure::Argument(format!("--explain: there is no rule \"{name}\"; `denavit check --rules` lists them"))
        })?;
        output::print(&lint::explain(rule))?;
        return Ok(Status::Same);
    }
    let mut findings = Vec::new();
    for name in &arguments.files {
        let (file, text) = source::read_text(name)?;
        let (config, folders) = config(arguments, Path::new(&file))?;
        let environment: Environment = std::env::vars().collect();
        let packages = PackagePath::new(&folders, &environment).near(Path::new(&file));
        let lookup = |mesh: &str| match packages.resolve(mesh, Some(Path::new(&file))) {
            Ok(path) if path.is_file() => Lookup::Found,
            Ok(path) => Lookup::NotFound(format!("there is no file {}", path.display())),
            Err(error) => Lookup::NotFound(error.to_string()),
        };
        let mut found = lint::check(&file, &text, &lookup, &config);
        if arguments.fix && Path::new(name).is_file() {
            let (mended, made) = lint::fix(&text, &found);
            if made > 0 {
                output::write_file(Path::new(name), mended.as_bytes())?;
                output::mention(format!("{name}: {made} mended"));
                found = lint::check(&file, &mended, &lookup, &config);
            }
        }
        findings.extend(found);
    }
    let found = Report::Findings { files: &arguments.files, findings: &findings };
    let text = match arguments.format.as_str() {
        "text" => report::text(&found, output::colour(arguments.output.is_none())),
        name => (report::format(name).expect("the argument parser knows the formats").render)(&found),
    };
    super::deliver(arguments.output.as_deref(), &text)?;
    Ok(if lint::fails(&findings) { Status::Different } else { Status::Same })
}

/// The configuration for a file, and the folders to look for packages in.
fn config(arguments: &CheckArguments, robot: &Path) -> Result<(Config, Vec<PathBuf>), Failure> {
    let mut folders = arguments.package_path.clone();
    let mut config = Config::default();
    if let Some(path) = arguments.config.clone().or_else(|| nearest_config(robot)) {
        let (file, text) = source::read_text(&path.to_string_lossy())?;
        config = Config::read(&file, &text)?;
        let beside = path.parent().unwrap_or(Path::new("."));
        folders.extend(config.package_path.iter().map(|folder| beside.join(folder)));
    }
    config.allow(&arguments.allow)?;
    config.deny(&arguments.deny)?;
    Ok((config, folders))
}

fn nearest_config(robot: &Path) -> Option<PathBuf> {
    let robot = robot.canonicalize().ok()?;
    robot.ancestors().skip(1).map(|folder| folder.join(FILE_NAME)).find(|path| path.is_file())
}
