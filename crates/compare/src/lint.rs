//! Rules for defects of real URDF files: what is wrong, in which line, and the fix if it is certain.
//!
//! Each rule is a file in `lint/rules/` and a line in [`RULES`]; the documentation, `--explain` and the tests walk that
//! list.

mod baseline;
pub mod config;
mod finding;
mod page;
mod rules;
mod sheet;
pub mod srdf;

pub use baseline::{Baseline, BaselineError};
pub use config::{Config, ConfigError};
pub use finding::{Edit, Finding, fix};
pub use page::{explain, page};
pub use rules::RULES;
pub use sheet::Sheet;

use crate::report::Level;
use denavit_model::{Place, Robot, urdf};
use finding::Found;

/// A rule: what it looks for, why that matters, and an example.
#[derive(Clone, Copy)]
pub struct Rule {
    /// Its number, such as `D010`.
    pub code: &'static str,
    /// Its name, such as `rounded-pi`.
    pub name: &'static str,
    /// Its level unless the user changes it.
    pub level: Level,
    /// What it finds, a clause.
    pub summary: &'static str,
    /// Why that matters and what to do, a few sentences.
    pub why: &'static str,
    /// Content of a `<robot>` that violates it.
    pub bad: &'static str,
    /// The same, fixed.
    pub good: &'static str,
    /// Whether `--fix` fixes it.
    pub fixable: bool,
    check: fn(&Sheet) -> Vec<Found>,
}

impl std::fmt::Debug for Rule {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} {}", self.code, self.name)
    }
}

/// The result of looking up a mesh file.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub enum Lookup {
    /// It is there.
    Found,
    /// It is missing; where it was searched, or why the search was impossible.
    NotFound(String),
    /// Its package is missing.
    NoPackage {
        /// The package's name.
        package: String,
        /// Where it was searched, and what to do.
        why: String,
    },
    /// It was not looked up.
    Unknown,
}

/// The rule of this code or name.
pub fn rule(code_or_name: &str) -> Option<&'static Rule> {
    RULES.iter().find(|rule| rule.code.eq_ignore_ascii_case(code_or_name) || rule.name == code_or_name)
}

/// Checks a file's text with every rule that `config` does not allow; findings are in the order of the lines.
///
/// `lookup` returns whether a mesh's file name, as written, exists. A file that is not a URDF yields findings
/// that say so.
///
/// # Examples
/// ```
/// use denavit_compare::lint::{Config, Lookup, check};
/// let text = r#"<robot name="r"> <link name="a"/> <link name="b"/>
///   <joint name="j" type="continuous"> <axis xyz="0 0 2"/> <parent link="a"/> <child link="b"/> </joint> </robot>"#;
/// let findings = check("arm.urdf", text, &|_| Lookup::Unknown, &Config::default());
/// assert_eq!(findings[0].to_string(), "arm.urdf:2: D012 joint \"j\": axis \"0 0 2\" has length 2; write 0 0 1");
/// ```
pub fn check(file: &str, text: &str, lookup: &dyn Fn(&str) -> Lookup, config: &Config) -> Vec<Finding> {
    check_and_read(file, text, lookup, config).0
}

/// As [`check`], with the robot and its inventory of the file; `None` if the file is not a robot.
pub fn check_and_read(
    file: &str,
    text: &str,
    lookup: &dyn Fn(&str) -> Lookup,
    config: &Config,
) -> (Vec<Finding>, Option<Robot>) {
    let read = urdf::read(file, text);
    let sheet = Sheet::new(file, &read, lookup);
    let mut findings = Vec::new();
    for rule in RULES {
        let Some(level) = config.level_of(rule) else { continue };
        findings.extend((rule.check)(&sheet).into_iter().map(|found| found.finding(rule, level, &sheet)));
    }
    findings.sort_by(|one, other| (one.place.line, one.rule).cmp(&(other.place.line, other.rule)));
    (findings, read.ok())
}

/// Findings of [unreadable](RULES) for errors in a description in another format: places and sentences.
pub fn refused(problems: &[(Place, String)], config: &Config) -> Vec<Finding> {
    let rule = &rules::unreadable::RULE;
    let Some(level) = config.level_of(rule) else { return Vec::new() };
    let finding = |(place, message): &(Place, String)| Finding {
        rule: rule.code,
        level,
        place: place.clone(),
        message: message.clone(),
        fix: Vec::new(),
    };
    problems.iter().map(finding).collect()
}

/// Whether a check fails: at least one finding is an error.
pub fn fails(findings: &[Finding]) -> bool {
    findings.iter().any(|finding| finding.level == Level::Error)
}
