//! `denavit check`: URDF files against numbered rules.

use crate::args::CheckArguments;
use crate::failure::Failure;
use crate::output::{self, Status};
use crate::source;
use denavit_compare::lint;
use denavit_compare::report::{self, Report};
use denavit_load::{CheckOptions, Rules};
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
    let mut findings = Vec::new();
    for name in &arguments.files {
        let (file, text) = source::read_text(name)?;
        let rules = Rules::of(&file, &options)?;
        let mut found = rules.check(&file, &text);
        if arguments.fix && Path::new(name).is_file() {
            let (mended, made) = lint::fix(&text, &found);
            if made > 0 {
                output::write_file(Path::new(name), mended.as_bytes())?;
                output::mention(format!("{name}: {made} mended"));
                found = rules.check(&file, &mended);
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
