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
use denavit_compare::report::{self, FileInventory, Report};
use denavit_load::{CheckOptions, LoadError, Rules, UrdfText};
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
    let mut source = SourceArguments {
        package_path: arguments.package_path.clone(),
        allow_any_file: arguments.allow_any_file,
        ..SourceArguments::default()
    };
    let mut names = source::sources(&arguments.files, &mut source)?;
    let beside = source::srdf_files(&arguments.files)?;
    names.extend(beside.iter().cloned());
    let baseline = arguments.baseline.as_deref().map(Known::read).transpose()?;
    let recorded = arguments.write_baseline.as_deref().map(|path| Recorded::to(path, &names)).transpose()?;
    let inputs = names.iter().map(String::as_str).chain(source.files());
    let inputs = inputs.chain(arguments.baseline.as_deref().and_then(Path::to_str));
    refuse_to_replace_a_robot(arguments.json.place(), &source)?;
    let delivery = match recorded {
        Some(_) => None,
        None => Some(Delivery::of(arguments.output.as_deref(), &arguments.json, inputs)?),
    };
    let mut checked = Checked::new(arguments, &source, &beside);
    checked.all(&names)?;
    let Checked { files, fixed, any_is_xacro, unread, .. } = checked;
    if unread == names.len() {
        return Err(Failure::Argument(format!("none of {unread} files can be read; nothing was checked")));
    }
    source.are_of_use(any_is_xacro)?;
    fixed.write()?;
    let status = match (recorded, delivery) {
        (Some(recorded), _) => recorded.write(&files)?,
        (None, Some(delivery)) => report(&delivery, arguments, files, baseline.as_ref())?,
        (None, None) => Status::Same,
    };
    if unread == 0 {
        return Ok(status);
    }
    output::mention(format!("{unread} of {} files could not be read; the others are checked", names.len()));
    Ok(Status::Error)
}

/// Delivers what was found, less what a baseline knows.
fn report(
    delivery: &Delivery,
    arguments: &CheckArguments,
    files: Vec<File>,
    baseline: Option<&Known>,
) -> Result<Status, Failure> {
    let (mut names, mut findings, mut inventories) = (Vec::new(), Vec::new(), Vec::new());
    let (mut known, mut gone) = (0, 0);
    for File { name, findings: found, inventory } in files {
        match baseline {
            Some(baseline) => {
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
    let rendered =
        |name: &str| Ok((report::format(name).expect("the argument parser knows the formats").render)(&found));
    let own = || match arguments.format.as_str() {
        "text" => Ok(report::text(&found, delivery.colour())),
        name => rendered(name),
    };
    delivery.deliver(own, || rendered("json"))?;
    if let (Some(path), true) = (&arguments.baseline, gone > 0) {
        let path = path.display();
        output::mention(format!(
            "{path}: {gone} finding(s) of the baseline are fixed in these files; --write-baseline {path} takes them out"
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
    source: &'a SourceArguments,
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
    fn new(arguments: &'a CheckArguments, source: &'a SourceArguments, beside: &'a [String]) -> Self {
        let (files, robots) = (Vec::new(), Vec::new());
        Self { arguments, source, beside, files, robots, fixed: Fixed::new(), any_is_xacro: false, unread: 0 }
    }

    fn all(&mut self, names: &[String]) -> Result<(), Failure> {
        let mut later = Vec::new();
        for name in names {
            let (file, written) = match source::read_text(name) {
                Ok(read) => read,
                Err(failure) => {
                    self.go_on_without(failure, names)?;
                    continue;
                }
            };
            if self.arguments.robots_only && self.is_part(&file, &written) {
                continue;
            }
            let rules = Rules::of(&file, &self.options())?;
            let urdf = match source::urdf_text(&file, written, self.source) {
                Ok(urdf) => urdf,
                // A model in another format is refused with all that is wrong with it, as a URDF is.
                Err(Failure::Load(LoadError::Format(error))) => {
                    let findings = rules.refused(&error.problems);
                    self.files.push(File { name: name.clone(), findings, inventory: None });
                    continue;
                }
                Err(failure) => {
                    self.any_is_xacro = true;
                    self.go_on_without(failure, names)?;
                    continue;
                }
            };
            self.any_is_xacro |= urdf.is_xacro;
            // What an SRDF names is in robots that may be named behind it.
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
        Ok(())
    }

    /// A file that cannot be read keeps nobody from the findings of the others.
    fn go_on_without(&mut self, failure: Failure, names: &[String]) -> Result<(), Failure> {
        if names.len() == 1 {
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

    /// Whether a xacro file is a part of robots and none by itself, which is then said.
    fn is_part(&self, file: &str, written: &str) -> bool {
        if !file.to_ascii_lowercase().ends_with(".xacro") {
            return false;
        }
        let why = source::why_a_part(file, written, self.source);
        if let Some(why) = &why {
            output::mention(format!("{file}: left out, as it is no robot by itself: {why}"));
        }
        why.is_some()
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
            output::mention(format!("{name}: left out, as no robot of its name \"{own}\" is checked with it"));
            return Ok(Vec::new());
        }
        Err(Failure::Argument(format!(
            "{name}: an SRDF is checked against its robot, and no robot \"{own}\" is named; name its URDF as well, as in \
             denavit check arm.urdf {name}"
        )))
    }
}

/// `check --json a.json b.json` may mean two tables to check; the first is not lost for that.
fn refuse_to_replace_a_robot(json: Option<&Path>, source: &SourceArguments) -> Result<(), Failure> {
    let robot = json.filter(|path| path.is_file() && source::load_quietly(&path.to_string_lossy(), source).is_ok());
    robot.map_or(Ok(()), |path| {
        Err(Failure::Argument(format!(
            "--json {0}: this file is a robot, and would be replaced; to check it write --json - {0}",
            path.display()
        )))
    })
}
