//! A failure of a computation or of the system is an error or a named state, never a neutral value.
//!
//! Every statement that replaces such a failure (`unwrap_or`, `ok()`, `let Ok(…) = … else`, …) is listed here with its reason.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Crates that compute, or read and write files.
const CRATES: [&str; 8] = ["measurements", "identify", "trace", "calibrate", "fleet", "bag", "load", "cli"];

/// Calls that can fail as a computation or because of the system.
const FAILS: [&str; 24] = [
    "cholesky(",
    "try_inverse(",
    "pseudo_inverse(",
    ".inverse(",
    "solve(",
    "solve_lower_triangular(",
    "symmetric_eigen(",
    "svd(",
    "Triangle::factor(",
    "fs::",
    "File::",
    "metadata(",
    "canonicalize(",
    "canonical(",
    "read_dir(",
    "read_to_string(",
    "read_text(",
    "read_bytes(",
    "load(",
    ".chain(Some",
    "compare(",
    "render)",
    "convert::table(",
    ".table(",
];

/// Code that replaces the failure.
const NEUTRAL: [&str; 7] =
    [".ok()", ".unwrap_or(", ".unwrap_or_default(", ".unwrap_or_else(", ".map_or(", ".map_or_else(", ".is_ok_and("];

/// Reviewed statements: file below `crates`, a part of the statement, why it is allowed.
const REVIEWED: &[(&str, &str, &str)] = &[
    (
        "calibrate/src/calibration/monitor/out_of_line.rs",
        "map_or(f64::INFINITY",
        "a covariance without an inverse makes the row stand out, which is reported",
    ),
    (
        "identify/src/noise.rs",
        "symmetric::inverse(&own, 0.0)",
        "a singular information is inverted by its eigenvalues: its direction is not known",
    ),
    ("identify/src/solve.rs", "map_or(f64::INFINITY, |full|", "equations without a solution never count as converged"),
    ("calibrate/src/report/rows.rs", "convert::table(chain", "a chain without a table has none in the report"),
    ("calibrate/src/report/rows.rs", "render)(&sheet).ok()", "a chain without a table has none in the report"),
    ("fleet/src/corpus/clusters.rs", "let Ok(found) = compare(", "robots that cannot be compared are not near"),
    (
        "fleet/src/key.rs",
        "let Ok((file, text))",
        "the hash is then that of the error's text; the task reports the error",
    ),
    (
        "fleet/src/tasks.rs",
        "load(entry, &entry.robot",
        "siblings are learned for it; the entry itself reports the error",
    ),
    (
        "load/src/measured/search.rs",
        "filter_map(|listing|",
        "other chains are offered where the data fit none; one that is none is no offer",
    ),
    ("load/src/project.rs", "canonical(place).ok()?", "a path that leads nowhere has no denavit.toml above it"),
    (
        "load/src/repository.rs",
        "canonicalize().unwrap_or(here)",
        "a folder whose links cannot be followed is taken as it is named",
    ),
    (
        "load/src/repository.rs",
        "let stands_alone",
        "a description that cannot be read counts as changed, and its reading reports the error",
    ),
    (
        "cli/src/commands/diff/robots.rs",
        "why_a_part",
        "a description that cannot be read is compared, and its reading reports the error",
    ),
    ("cli/src/commands/check.rs", "let here = Path::new", "robots are then named by their whole paths"),
    (
        "cli/src/commands/check/baseline.rs",
        "canonicalize().ok()?",
        "a path that leads nowhere is kept as it was written",
    ),
    ("load/src/measured/content.rs", "path.metadata().is_ok_and(", "whether to show a size; opening the file reports"),
    (
        "cli/src/output/destination.rs",
        "metadata(path).ok()",
        "what is no regular file has no identity; opening it reports",
    ),
    (
        "cli/src/output/destination.rs",
        "canonicalize().ok()",
        "what is no regular file has no identity; opening it reports",
    ),
    ("cli/src/output/staged.rs", "/proc/self/status", "systems without it have the usual mask"),
    (
        "load/src/convert.rs",
        "packages.resolve(uri",
        "a mesh that is not there keeps its name in the file that is written",
    ),
    ("load/src/convert.rs", "files::canonical(&path).ok()?", "the same"),
];

fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            sources(&path, found);
        } else if path.extension().is_some_and(|end| end == "rs") {
            found.push(path);
        }
    }
}

/// The statements of a file without tests and comments, with single blanks.
fn statements(text: &str) -> Vec<String> {
    let code = text.split("#[cfg(test)]").next().unwrap_or(text);
    let lines = code.lines().map(str::trim).filter(|line| !line.starts_with("//"));
    let code = lines.collect::<Vec<_>>().join(" ");
    code.split([';', '{', '}']).map(|part| part.split_whitespace().collect::<Vec<_>>().join(" ")).collect()
}

fn hides_a_failure(statement: &str) -> bool {
    let Some(first) = FAILS.iter().filter_map(|word| statement.find(word)).min() else { return false };
    statement.contains("let Ok(") || NEUTRAL.iter().any(|word| statement[first..].contains(word))
}

#[test]
fn no_failure_becomes_a_neutral_value() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("crates");
    let root = if root.is_dir() { root } else { Path::new(env!("CARGO_MANIFEST_DIR")).join("../../crates") };
    let mut used = BTreeMap::new();
    let mut hidden = Vec::new();
    for name in CRATES {
        let mut files = Vec::new();
        sources(&root.join(name).join("src"), &mut files);
        for path in files {
            let file = path.strip_prefix(&root).unwrap().to_string_lossy().replace('\\', "/");
            for statement in statements(&std::fs::read_to_string(&path).unwrap()) {
                if !hides_a_failure(&statement) {
                    continue;
                }
                match REVIEWED.iter().position(|(of, part, _)| *of == file && statement.contains(part)) {
                    Some(at) => *used.entry(at).or_insert(0) += 1,
                    None => hidden.push(format!("{file}: {statement}")),
                }
            }
        }
    }
    assert!(hidden.is_empty(), "make it an error or a state, or say here why not:\n{}", hidden.join("\n"));
    let stale: Vec<_> = (0..REVIEWED.len()).filter(|at| !used.contains_key(at)).map(|at| REVIEWED[at]).collect();
    assert!(stale.is_empty(), "these are gone from the sources, take them out: {stale:?}");
}

#[test]
fn the_search_sees_what_it_is_for() {
    assert!(hides_a_failure("let a = matrix.cholesky().map_or(0.0, |factor| factor.determinant())"));
    assert!(hides_a_failure("if let Ok(text) = std::fs::read_to_string(path)"));
    assert!(!hides_a_failure("let first = list.first().unwrap_or(&other)"));
    assert!(!hides_a_failure("let file = File::open(path).map_err(refused)?"));
}
