//! Differences, fingerprints, rules.

use crate::errors::{Class, Spot, argument, broken, error, load, said, tree};
use crate::robot::Robot;
use denavit_compare::report::{self, Colour, Report};
use denavit_compare::{Options, Range, Scope, Verdict, lint};
use denavit_load::CheckOptions;
use pyo3::prelude::*;
use std::path::PathBuf;

/// What a comparison found.
#[pyclass(frozen, module = "denavit._denavit")]
pub struct Comparison(denavit_compare::Comparison);

#[pymethods]
impl Comparison {
    /// Whether the robots are the same within the tolerances.
    #[getter]
    fn same(&self) -> bool {
        self.0.verdict == Verdict::Same
    }

    /// In one of the formats of `denavit diff`.
    fn render(&self, format: &str) -> PyResult<String> {
        render(&Report::Comparison(&self.0), format)
    }
}

/// What the rules found in files.
#[pyclass(frozen, module = "denavit._denavit")]
pub struct Findings {
    files: Vec<String>,
    #[expect(clippy::struct_field_names, reason = "that is what it holds")]
    findings: Vec<denavit_compare::Finding>,
    inventories: Vec<report::FileInventory>,
}

#[pymethods]
impl Findings {
    /// Whether a finding is an error.
    #[getter]
    fn fails(&self) -> bool {
        lint::fails(&self.findings)
    }

    /// In one of the formats of `denavit check`.
    fn render(&self, format: &str) -> PyResult<String> {
        let Self { files, findings, inventories } = self;
        render(&Report::Findings { files, findings, inventories, known: None }, format)
    }
}

fn render(report: &Report<'_>, format: &str) -> PyResult<String> {
    if format == "text" {
        return Ok(said(report::text(report, Colour::None)));
    }
    let known = || report::FORMATS.iter().map(|format| format.name).collect::<Vec<_>>().join(", ");
    let found = report::format(format);
    let found = found.ok_or_else(|| argument(format!("format is \"{format}\"; write one of {}", known())))?;
    Ok((found.render)(report))
}

/// How two robots differ.
#[pyfunction]
#[pyo3(signature = (a, b, tolerance_m, tolerance_rad, only_kinematics, up_to_base, up_to_zeros, count_names, q_range, samples, seed))]
#[expect(
    clippy::fn_params_excessive_bools,
    clippy::too_many_arguments,
    reason = "each is a keyword of the Python function"
)]
pub fn compare(
    py: Python<'_>,
    a: &Robot,
    b: &Robot,
    tolerance_m: f64,
    tolerance_rad: f64,
    only_kinematics: bool,
    up_to_base: bool,
    up_to_zeros: bool,
    count_names: bool,
    q_range: Vec<(Option<String>, f64, f64)>,
    samples: usize,
    seed: u64,
) -> PyResult<Comparison> {
    let range = |(joint, lower, upper): (Option<String>, f64, f64)| {
        let ordered = lower.is_finite() && upper.is_finite() && lower <= upper;
        let wrong = || {
            argument(format!("q_range: {lower} … {upper} is not a range; write two finite numbers, the lower first"))
        };
        if ordered { Ok(Range { joint, lower, upper }) } else { Err(wrong()) }
    };
    let options = Options {
        tolerance_m,
        tolerance_rad,
        scope: if only_kinematics { Scope::Kinematics } else { Scope::Everything },
        up_to_base,
        up_to_zeros,
        count_names,
        q_range: q_range.into_iter().map(range).collect::<PyResult<_>>()?,
        samples,
        seed,
        ..Options::default()
    };
    let found =
        py.detach(|| denavit_compare::compare(&a.loaded.subject(&a.file), &b.loaded.subject(&b.file), &options));
    found.map(Comparison).map_err(|failure| tree(&failure))
}

/// The fingerprint as JSON, and as `denavit fingerprint` prints it.
#[pyfunction]
pub fn fingerprint(py: Python<'_>, robot: &Robot, tolerance: f64) -> PyResult<(String, String)> {
    if !(tolerance > 0.0 && tolerance < 1.0) {
        return Err(argument(format!("tolerance is {tolerance}; write a number between 0 and 1")));
    }
    let found = py.detach(|| denavit_compare::fingerprint(&robot.loaded.subject(&robot.file), tolerance));
    let json = serde_json::to_string(&found).map_err(|failure| broken(&failure.to_string()))?;
    Ok((json, found.to_string()))
}

/// Whether a recorded fingerprint is that of a robot with these hashes.
#[pyfunction]
pub fn fingerprint_matches(
    tolerance: f64,
    motion: String,
    matter: String,
    other_motions: Vec<String>,
    other_matters: Vec<String>,
    written: &str,
    only_motion: bool,
) -> bool {
    let found = denavit_compare::Fingerprint { tolerance, motion, matter, other_motions, other_matters };
    if only_motion { found.moves_as(written) } else { found.matches(written) }
}

/// Checks a URDF's text against the rules.
#[pyfunction]
#[pyo3(signature = (file, text, allow, deny, config, package_path))]
pub fn check(
    py: Python<'_>,
    file: &str,
    text: &str,
    allow: Vec<String>,
    deny: Vec<String>,
    config: Option<PathBuf>,
    package_path: Vec<PathBuf>,
) -> PyResult<Findings> {
    let options = CheckOptions { allow, deny, config, package_path };
    let rules = denavit_load::Rules::of(file, &options).map_err(|failure| match failure {
        denavit_load::CheckError::Load(failure) => load(&failure),
        other => error(Class::Argument, &other.to_string(), Spot::default()),
    })?;
    let (findings, robot) = py.detach(|| rules.check_and_read(file, text));
    let inventories = robot.map(|robot| report::FileInventory { file: file.to_owned(), inventory: robot.inventory() });
    Ok(Findings { files: vec![file.to_owned()], findings, inventories: inventories.into_iter().collect() })
}
