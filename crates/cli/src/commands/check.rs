//! `denavit check`: URDF files against numbered rules.

mod baseline;
mod fixed;

use crate::args::{CheckArguments, SourceArguments};
use crate::delivery::Delivery;
use crate::failure::Failure;
use crate::output::{self, Status};
use crate::source;
use baseline::{Known, Recorded};
use denavit_compare::lint::{self, srdf};
use denavit_compare::report::{FileInventory, Report};
use denavit_load::{CheckOptions, LoadError, Project, ProjectRobot, Rules, UrdfText};
use denavit_model::Robot;
use fixed::Fixed;
use std::fmt::Write as _;
use std::path::Path;

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
    let common = SourceArguments {
        package_path: arguments.package_path.clone(),
        allow_any_file: arguments.allow_any_file,
        ..SourceArguments::default()
    };
    let project = match &arguments.config {
        Some(path) => Some(Project::open(&path.to_string_lossy(), path.parent().unwrap_or(Path::new(".")))?),
        None => Project::of(Path::new("."))?,
    };
    let beside = source::srdf_files(&arguments.files)?;
    let asked = if arguments.files.is_empty() {
        named(project.as_ref(), &common)?
    } else {
        let mut source = common.clone();
        let mut names = source::sources(&arguments.files, &mut source)?;
        names.extend(beside.iter().cloned());
        names.into_iter().map(|name| NamedSource { name, source: source.clone() }).collect()
    };
    let source = asked.first().map_or_else(|| common.clone(), |asked| asked.source.clone());
    let names: Vec<String> = asked.iter().map(|asked| asked.name.clone()).collect();
    let known = project.and_then(|project| project.baseline).filter(|_| arguments.write_baseline.is_none());
    let known = arguments.baseline.clone().or(known);
    let baseline = known.as_deref().map(Known::read).transpose()?;
    let recorded = arguments.write_baseline.as_deref().map(|path| Recorded::to(path, &names)).transpose()?;
    let inputs = names.iter().map(String::as_str).chain(asked.iter().flat_map(|asked| asked.source.files()));
    let inputs = inputs.chain(known.as_deref().and_then(Path::to_str));
    refuse_to_replace_a_robot(arguments.json.place(), &source)?;
    let delivery = match recorded {
        Some(_) => None,
        None => Some(Delivery::of(arguments.output.as_deref(), &arguments.json, inputs)?),
    };
    let mut checked = Checked::new(arguments, &beside);
    checked.all(&asked)?;
    let Checked { files, fixed, any_is_xacro, unread, .. } = checked;
    if unread == names.len() {
        return Err(Failure::Argument(format!("none of the {unread} files can be read; nothing was checked")));
    }
    if !arguments.files.is_empty() {
        source.are_of_use(any_is_xacro)?;
    }
    fixed.write()?;
    let status = match (recorded, delivery) {
        (Some(recorded), _) => recorded.write(&files)?,
        (None, Some(delivery)) => report(&delivery, arguments, files, baseline.as_ref().zip(known.as_deref()))?,
        (None, None) => Status::Same,
    };
    if unread == 0 {
        return Ok(status);
    }
    output::mention(format!("{unread} of {} files could not be read; the others are checked", names.len()));
    Ok(Status::Error)
}

/// A source that is to be checked, and how it is read.
struct NamedSource {
    name: String,
    source: SourceArguments,
}

/// The robots that `denavit.toml` names.
fn named(project: Option<&Project>, common: &SourceArguments) -> Result<Vec<NamedSource>, Failure> {
    let robots = project.map(|project| &project.robots[..]).unwrap_or_default();
    if robots.is_empty() {
        return Err(Failure::Argument(
            "no robot is named, here or in a denavit.toml; name a file or a folder, or write [robots.NAME] \
             file = \"…\" into denavit.toml"
                .into(),
        ));
    }
    let here = Path::new(".").canonicalize().unwrap_or_default();
    let asked = |robot: &ProjectRobot| {
        let path = robot.file.strip_prefix(&here).unwrap_or(&robot.file);
        let mut source = common.clone();
        source.values = robot.arguments.iter().map(|(name, value)| format!("{name}:={value}")).collect();
        source.package_path.extend(project.into_iter().flat_map(|project| project.package_path.clone()));
        NamedSource { name: path.to_string_lossy().into_owned(), source }
    };
    Ok(robots.iter().map(asked).collect())
}

/// Delivers what was found, less what a baseline knows.
fn report(
    delivery: &Delivery,
    arguments: &CheckArguments,
    files: Vec<File>,
    baseline: Option<(&Known, &Path)>,
) -> Result<Status, Failure> {
    let (mut names, mut findings, mut inventories) = (Vec::new(), Vec::new(), Vec::new());
    let (mut known, mut gone) = (0, 0);
    for File { name, findings: found, inventory } in files {
        match baseline {
            Some((baseline, _)) => {
                let (new, hidden) = baseline.new_among(&name, found);
                known += hidden;
                gone += baseline.known_of(&name) - hidden;
                findings.extend(new);
            }
            None => findings.extend(found),
        }
        inventories.extend(inventory.map(|inventory| FileInventory { file: name.clone(), inventory }));
        names.push(name);
    }
    let found = Report::Findings {
        files: &names,
        findings: &findings,
        inventories: &inventories,
        known: baseline.map(|_| known),
    };
    delivery.report(&arguments.format, &found)?;
    if let (Some((_, path)), true) = (baseline, gone > 0) {
        let path = path.display();
        output::mention(format!(
            "{path}: {gone} finding(s) of the baseline are fixed in these files; --write-baseline {path} removes them"
        ));
    }
    Ok(if lint::fails(&findings) { Status::Different } else { Status::Same })
}

/// A file that was checked.
pub struct File {
    /// As named.
    name: String,
    findings: Vec<lint::Finding>,
    /// Of what could be read.
    inventory: Option<denavit_model::Inventory>,
}

/// The work over all files.
struct Checked<'a> {
    arguments: &'a CheckArguments,
    /// SRDF files that nobody named: they were in a folder.
    beside: &'a [String],
    files: Vec<File>,
    robots: Vec<Robot>,
    fixed: Fixed,
    any_is_xacro: bool,
    /// How many files could not be read.
    unread: usize,
}

impl<'a> Checked<'a> {
    fn new(arguments: &'a CheckArguments, beside: &'a [String]) -> Self {
        let (files, robots) = (Vec::new(), Vec::new());
        Self { arguments, beside, files, robots, fixed: Fixed::new(), any_is_xacro: false, unread: 0 }
    }

    fn all(&mut self, asked: &[NamedSource]) -> Result<(), Failure> {
        let mut later = Vec::new();
        for NamedSource { name, source } in asked {
            let (file, written) = match source::read_text(name) {
                Ok(read) => read,
                Err(failure) => {
                    self.continue_without(failure, asked)?;
                    continue;
                }
            };
            if self.arguments.robots_only && is_part(&file, &written, source) {
                continue;
            }
            let rules = Rules::of(&file, &self.options())?;
            let urdf = match source::urdf_text(&file, written, source) {
                Ok(urdf) => urdf,
                // A model in another format is refused with all that is wrong with it, as a URDF is.
                Err(Failure::Load(LoadError::Format(error))) => {
                    let findings = rules.refused(&error.problems);
                    self.files.push(File { name: name.clone(), findings, inventory: None });
                    continue;
                }
                Err(failure) => {
                    self.any_is_xacro = true;
                    self.continue_without(failure, asked)?;
                    continue;
                }
            };
            self.any_is_xacro |= urdf.is_xacro;
            // An SRDF needs its robots, which may come later in the list.
            if srdf::is_srdf(&urdf.shown, &urdf.text) {
                later.push((name, urdf, rules));
            } else {
                self.robot(name, &file, &urdf, &rules)?;
            }
        }
        let robots = std::mem::take(&mut self.robots);
        for (name, urdf, rules) in later {
            // Variants of a robot have one name: an SRDF is for the one that has most of what it names.
            let robots = self.robots_of(name, &urdf.text, &robots)?;
            let checked = robots.iter().map(|robot| rules.check_srdf(&urdf.shown, &urdf.text, robot));
            if let Some((findings, inventory)) = checked.min_by_key(|(findings, _)| findings.len()) {
                self.files.push(File { name: name.clone(), findings, inventory: Some(inventory) });
            }
        }
        self.join_variants();
        Ok(())
    }

    /// Robots of one file with other arguments: what is found in several of them is said once.
    fn join_variants(&mut self) {
        let mut joined: Vec<File> = Vec::new();
        for file in std::mem::take(&mut self.files) {
            match joined.iter_mut().find(|known| known.name == file.name) {
                Some(known) => {
                    let new = file.findings.into_iter().filter(|finding| !known.findings.contains(finding));
                    let new: Vec<_> = new.collect();
                    known.findings.extend(new);
                }
                None => joined.push(file),
            }
        }
        self.files = joined;
    }

    /// If one of several files cannot be read, the others are still checked.
    fn continue_without(&mut self, failure: Failure, asked: &[NamedSource]) -> Result<(), Failure> {
        if asked.len() == 1 {
            return Err(failure);
        }
        self.unread += 1;
        output::complain(&failure);
        Ok(())
    }

    fn options(&self) -> CheckOptions {
        CheckOptions {
            allow: self.arguments.allow.clone(),
            deny: self.arguments.deny.clone(),
            config: self.arguments.config.clone(),
            package_path: self.arguments.package_path.clone(),
        }
    }

    fn robot(&mut self, name: &str, file: &str, urdf: &UrdfText, rules: &Rules) -> Result<(), Failure> {
        let UrdfText { shown, text, .. } = urdf;
        let (mut findings, mut robot) = rules.check_and_read(shown, text);
        if self.arguments.fix && Path::new(name).is_file() {
            if shown == file {
                let (text, made) = lint::fix(text, &findings);
                if made > 0 {
                    (findings, robot) = rules.check_and_read(shown, &text);
                    self.fixed.add(name, text, made)?;
                }
            } else if findings.iter().any(|finding| !finding.fix.is_empty()) {
                output::mention(format!("{name}: --fix changes URDF files only"));
            }
        }
        let inventory = robot.as_ref().map(Robot::inventory);
        self.robots.extend(robot);
        self.files.push(File { name: name.to_owned(), findings, inventory });
        Ok(())
    }

    /// The robots that an SRDF may be for: those of its name, or the only one.
    fn robots_of<'r>(&self, name: &str, text: &str, robots: &'r [Robot]) -> Result<Vec<&'r Robot>, Failure> {
        let own = srdf::robot_of(text).unwrap_or_default();
        let named: Vec<&Robot> = robots.iter().filter(|robot| robot.name == own).collect();
        if !named.is_empty() {
            return Ok(named);
        }
        let is_beside = self.beside.iter().any(|beside| beside == name);
        if let ([only], false) = (robots, is_beside) {
            return Ok(vec![only]);
        }
        if is_beside {
            output::mention(format!("{name}: left out, as no robot named \"{own}\" is checked with it"));
            return Ok(Vec::new());
        }
        Err(Failure::Argument(format!(
            "{name}: an SRDF is checked against its robot, and the robot \"{own}\" is not among the files; name its URDF, too: \
             denavit check arm.urdf {name}"
        )))
    }
}

/// Whether a xacro file is a part of robots and not a robot by itself; a note then says so.
fn is_part(file: &str, written: &str, source: &SourceArguments) -> bool {
    if !file.to_ascii_lowercase().ends_with(".xacro") {
        return false;
    }
    let why = source::why_a_part(file, written, source);
    if let Some(why) = &why {
        output::mention(format!("{file}: left out, as it is not a robot by itself: {why}"));
    }
    why.is_some()
}

/// `check --json a.json b.json` may mean two tables to check; the first must not be overwritten.
fn refuse_to_replace_a_robot(json: Option<&Path>, source: &SourceArguments) -> Result<(), Failure> {
    let robot = json.filter(|path| path.is_file() && source::load_quietly(&path.to_string_lossy(), source).is_ok());
    robot.map_or(Ok(()), |path| {
        Err(Failure::Argument(format!(
            "--json {0}: this file is a robot, and would be replaced; to check it write --json - {0}",
            path.display()
        )))
    })
}
