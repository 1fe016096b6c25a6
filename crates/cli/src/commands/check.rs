//! `denavit check`: URDF files against numbered rules.

use crate::args::{CheckArguments, SourceArguments};
use crate::delivery::Delivery;
use crate::failure::Failure;
use crate::output::{self, Outputs, Slot, Status};
use crate::source;
use denavit_compare::lint;
use denavit_compare::report::{self, Report};
use denavit_load::{CheckOptions, Rules, UrdfText};
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
    let options = CheckOptions {
        allow: arguments.allow.clone(),
        deny: arguments.deny.clone(),
        config: arguments.config.clone(),
        package_path: arguments.package_path.clone(),
    };
    let mut source = SourceArguments {
        package_path: arguments.package_path.clone(),
        allow_any_file: arguments.allow_any_file,
        ..SourceArguments::default()
    };
    let names = source::sources(&arguments.files, &mut source)?;
    let inputs = names.iter().map(String::as_str).chain(source.files());
    refuse_to_replace_a_robot(arguments.json.place(), &source)?;
    let delivery = Delivery::of(arguments.output.as_deref(), &arguments.json, inputs)?;
    let mut mended = Mended { outputs: Outputs::in_place(), texts: Vec::new(), said: Vec::new() };
    let mut findings = Vec::new();
    let mut any_is_xacro = false;
    for name in &names {
        let (file, written) = source::read_text(name)?;
        let rules = Rules::of(&file, &options)?;
        let UrdfText { shown, text: urdf, is_xacro, .. } = source::urdf_text(&file, written, &source)?;
        any_is_xacro |= is_xacro;
        let mut found = rules.check(&shown, &urdf);
        if arguments.fix && Path::new(name).is_file() {
            if shown == file {
                let (text, made) = lint::fix(&urdf, &found);
                if made > 0 {
                    found = rules.check(&shown, &text);
                    mended.add(name, text, made)?;
                }
            } else if found.iter().any(|finding| !finding.fix.is_empty()) {
                output::mention(format!("{name}: --fix changes URDF files only"));
            }
        }
        findings.extend(found);
    }
    source.are_of_use(any_is_xacro)?;
    mended.write()?;
    let found = Report::Findings { files: &names, findings: &findings };
    let rendered =
        |name: &str| Ok((report::format(name).expect("the argument parser knows the formats").render)(&found));
    let own = || match arguments.format.as_str() {
        "text" => Ok(report::text(&found, delivery.colour())),
        name => rendered(name),
    };
    delivery.deliver(own, || rendered("json"))?;
    Ok(if lint::fails(&findings) { Status::Different } else { Status::Same })
}

/// Files that were mended: all are written, or none.
struct Mended {
    outputs: Outputs,
    texts: Vec<(Slot, String)>,
    said: Vec<String>,
}

impl Mended {
    fn add(&mut self, name: &str, text: String, made: usize) -> Result<(), Failure> {
        self.texts.push((self.outputs.add("--fix", Path::new(name))?, text));
        self.said.push(format!("{name}: {made} fixed"));
        Ok(())
    }

    fn write(&self) -> Result<(), Failure> {
        self.outputs.write(&self.texts)?;
        self.said.iter().for_each(output::mention);
        Ok(())
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
