//! Running the binary, and finding robots.

#[path = "files.rs"]
mod files;
pub use files::{files, top};

use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

/// A robot of the project, by its path below `robots/`.
pub fn robot(path: &str) -> String {
    top().join("robots").join(path).to_str().unwrap().to_owned()
}

/// The folder of vendors' files beside the project, if it exists.
pub fn vendor() -> Option<PathBuf> {
    let folder = top().join("../shared/vendor");
    if !folder.is_dir() {
        println!("skipped, because the vendors' files (../shared/vendor) are not beside this clone");
    }
    folder.is_dir().then_some(folder)
}

/// Result of a run of the binary.
pub struct Run {
    pub code: i32,
    pub stdout: String,
    pub stderr: String,
}

fn outcome(output: &Output) -> Run {
    Run {
        code: output.status.code().unwrap_or(-1),
        stdout: String::from_utf8_lossy(&output.stdout).into_owned(),
        stderr: String::from_utf8_lossy(&output.stderr).into_owned(),
    }
}

/// Runs `denavit` with these arguments in the project's top folder.
pub fn denavit(arguments: &[&str]) -> Run {
    denavit_in(&top(), arguments)
}

/// The project's own files below `folder` with one of these endings, without folders of these names, built and hidden files.
pub fn own_files(folder: &Path, endings: &[&str], left_out: &[&str]) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_str().unwrap();
        if path.is_dir() {
            let passed_by = ["node_modules", "target", "dist"].contains(&name) || left_out.contains(&name);
            if !passed_by && !name.starts_with('.') {
                found.extend(own_files(&path, endings, left_out));
            }
        } else if endings.iter().any(|ending| name.ends_with(ending)) {
            found.push(path);
        }
    }
    found
}

/// Runs `denavit` with these arguments in a folder.
pub fn denavit_in(folder: &Path, arguments: &[&str]) -> Run {
    outcome(&program(folder).args(arguments).stdin(Stdio::null()).output().unwrap())
}

/// `denavit`, to be run in a folder.
pub fn program(folder: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_denavit"));
    command.current_dir(folder);
    // Results with a date always have the same one.
    command.env("SOURCE_DATE_EPOCH", "1772323200");
    command
}

/// Runs `denavit` with text on standard input.
pub fn denavit_with_input(arguments: &[&str], input: &str) -> Run {
    let mut child = Command::new(env!("CARGO_BIN_EXE_denavit"))
        .args(arguments)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    child.stdin.take().unwrap().write_all(input.as_bytes()).unwrap();
    outcome(&child.wait_with_output().unwrap())
}

impl Run {
    /// The standard output of a run that must have succeeded.
    pub fn succeeded(self) -> String {
        assert_eq!(self.code, 0, "{}", self.stderr);
        self.stdout
    }

    /// The message of a run that must have failed: exit code 2, nothing on standard output.
    pub fn failed(self) -> String {
        assert_eq!((self.code, self.stdout.as_str()), (2, ""), "{}", self.stderr);
        self.stderr
    }
}

/// Joint values in the coordinates' ranges, low-discrepancy and the same in every run.
pub fn configurations(ranges: &[(f64, f64)], count: usize) -> Vec<Vec<f64>> {
    // Roberts' sequence: the generalised golden ratio of the dimension.
    let mut phi = 2.0f64;
    for _ in 0..30 {
        phi = (1.0 + phi).powf(1.0 / (ranges.len() as f64 + 1.0));
    }
    let value = |sample: usize, k: usize| {
        let step = phi.powf(-(k as f64 + 1.0));
        let (lower, upper) = ranges[k];
        lower + (0.5 + step * (sample as f64 + 1.0)).fract() * (upper - lower)
    };
    (0..count).map(|sample| (0..ranges.len()).map(|k| value(sample, k)).collect()).collect()
}
