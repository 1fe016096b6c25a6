//! One file of a corpus: its mechanism and its rule violations.

use crate::error::FleetError;
use denavit_compare::report::Level;
use denavit_load::{CheckOptions, Loaded, Options, Rules, Selection};
use denavit_model::settings::plain;
use serde::Serialize;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};

/// A file of a corpus.
#[derive(Debug, Clone, Serialize)]
pub struct CorpusFile {
    /// As named.
    pub file: String,
    /// The name that it gives the robot.
    pub robot: String,
    /// Joints that move.
    pub joints: usize,
    /// The longest chain, base to tip, kinds of its joints: `6R`.
    pub chain: String,
    /// Its size, m.
    pub size_m: f64,
    /// Fingerprint of the whole robot.
    pub fingerprint: String,
    /// The motion part of the fingerprint.
    pub motion: String,
    /// Alternatives of that part on another computer.
    #[serde(skip)]
    pub other_motions: Vec<String>,
    /// Its rule violations.
    pub findings: Findings,
    /// Why it is not a robot; the rest is then empty.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error: Option<String>,
}

/// Findings of a file, counted.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize)]
pub struct Findings {
    /// Errors, which make a check fail.
    pub errors: usize,
    /// Warnings.
    pub warnings: usize,
    /// Codes of the rules, each once.
    pub rules: Vec<&'static str>,
}

/// The URDF and xacro files below a folder, sorted; hidden folders are left out, links to folders not followed.
///
/// # Errors
/// A folder cannot be read, or holds no such file.
pub fn robots_in(folder: &Path) -> Result<Vec<String>, FleetError> {
    let mut found = Vec::new();
    let mut open: Vec<PathBuf> = vec![folder.to_owned()];
    while let Some(folder) = open.pop() {
        let failed = |error: std::io::Error| {
            FleetError::manifest(folder.display().to_string(), format!("the folder cannot be read: {error}"))
        };
        for entry in std::fs::read_dir(&folder).map_err(failed)? {
            let entry = entry.map_err(failed)?;
            let kind = entry.file_type().map_err(failed)?;
            if entry.file_name().to_string_lossy().starts_with('.') {
                continue;
            }
            let path = entry.path();
            if kind.is_dir() {
                open.push(path);
            } else if path.extension().is_some_and(|end| end == "urdf" || end == "xacro") {
                found.push(path.to_string_lossy().into_owned());
            }
        }
    }
    found.sort();
    if found.is_empty() {
        let message = "this folder has no URDF or xacro file; name another";
        return Err(FleetError::manifest(folder.display().to_string(), message));
    }
    Ok(found)
}

/// Analyses a file, at a tolerance of its fingerprint.
pub(super) fn examine(name: &str, tolerance: f64) -> CorpusFile {
    let read = catch_unwind(AssertUnwindSafe(|| {
        let (file, text) = denavit_load::read_text(name).map_err(plain)?;
        look_at(&file, &text, tolerance)
    }));
    let read = read.unwrap_or_else(|_| Err("a bug in denavit; please report it with this file".into()));
    read.unwrap_or_else(|error| {
        let (empty, findings) = (String::new, Findings::default());
        let (robot, chain, fingerprint, motion) = (empty(), empty(), empty(), empty());
        let (file, error) = (name.to_owned(), Some(error));
        CorpusFile {
            file,
            robot,
            joints: 0,
            chain,
            size_m: 0.0,
            fingerprint,
            motion,
            other_motions: Vec::new(),
            findings,
            error,
        }
    })
}

/// The same of a text; `file` is what messages call it.
pub(super) fn look_at(file: &str, text: &str, tolerance: f64) -> Result<CorpusFile, String> {
    let opened = denavit_load::from_text(file, text, &Options::default()).map_err(plain)?;
    let loaded = opened.robot;
    let print = denavit_compare::fingerprint(&loaded.subject(file), tolerance);
    let chain = loaded.chain(&Selection { file, ..Selection::default() }).ok().map(|chain| chain.value);
    let mut findings = Findings::default();
    if !opened.is_xacro && matches!(loaded, Loaded::Robot(_)) {
        let rules = Rules::of(file, &CheckOptions::default()).map_err(plain)?;
        for finding in rules.check(file, text) {
            match finding.level {
                Level::Error => findings.errors += 1,
                Level::Warning => findings.warnings += 1,
                Level::Note => {}
            }
            if !findings.rules.contains(&finding.rule) {
                findings.rules.push(finding.rule);
            }
        }
        findings.rules.sort_unstable();
    }
    let mechanism = loaded.subject(file).mechanism(denavit_model::Reading::Intended);
    Ok(CorpusFile {
        file: file.to_owned(),
        robot: mechanism.name.clone(),
        joints: mechanism.joints.len(),
        chain: chain.as_ref().map_or_else(String::new, kinds),
        size_m: chain.as_ref().map_or(0.0, denavit_model::Chain::size),
        fingerprint: print.to_string(),
        motion: print.motion,
        other_motions: print.other_motions,
        findings,
        error: None,
    })
}

/// `6R`, `RRPR`: the kinds of a chain's joints.
fn kinds(chain: &denavit_model::Chain) -> String {
    let letter = |joint: &denavit_model::ChainJoint| match joint.screw {
        denavit_model::Screw::Revolute(_) => 'R',
        denavit_model::Screw::Prismatic(_) => 'P',
        denavit_model::Screw::Helical { .. } => 'H',
    };
    let letters: String = chain.joints().iter().map(letter).collect();
    if letters.len() > 1 && letters.bytes().all(|byte| byte == b'R') { format!("{}R", letters.len()) } else { letters }
}
