//! Errors found in real use, a sentence each: lost files, options read as files, meaningless numbers.

mod checks;
mod code;
mod commands;
mod edits;
mod fleet_nights;
mod git;
mod hand_eye;
mod ik;
mod json;
mod large;
#[cfg(feature = "calibrate")]
mod library;
mod measured_data;
mod numbers;
#[cfg(unix)]
mod outputs;
#[cfg(unix)]
mod packages;
mod priors;
mod program;
mod projects;
mod sources;
mod tables;
mod tips;

use crate::support::{self, Run, robot};
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// A folder with files in it, in which the program runs.
struct Trial(TempDir);

impl Trial {
    /// With `arm.urdf`, a UR5e.
    fn new() -> Self {
        let trial = Self(tempfile::tempdir().unwrap());
        std::fs::copy(robot("universal_robots/ur5e.urdf"), trial.path("arm.urdf")).unwrap();
        trial
    }

    fn with(self, name: &str, text: &str) -> Self {
        std::fs::write(self.path(name), text).unwrap();
        self
    }

    /// A file of the project's robots under a name of its own.
    fn with_robot(self, name: &str, of: &str) -> Self {
        std::fs::copy(robot(of), self.path(name)).unwrap();
        self
    }

    fn folder(&self) -> &Path {
        self.0.path()
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn text(&self, name: &str) -> String {
        std::fs::read_to_string(self.path(name)).unwrap()
    }

    /// Every name in the folder, hidden ones too.
    fn names(&self) -> Vec<String> {
        let entries = std::fs::read_dir(self.folder()).unwrap();
        let mut names: Vec<String> = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    /// Runs a command line with words separated by spaces.
    fn run(&self, line: &str) -> Run {
        support::denavit_in(self.folder(), &line.split_whitespace().collect::<Vec<_>>())
    }

    /// Runs a command line that must be refused: exit code 2, this message, no file changed or made.
    fn refuses(&self, line: &str, said: &str) {
        let before = self.content();
        let run = self.run(line);
        assert_eq!(run.code, 2, "{line}: {}{}", run.stdout, run.stderr);
        assert!(run.stderr.contains(said), "{line}: {}", run.stderr);
        assert!(self.content() == before, "{line} changed a file");
    }

    fn content(&self) -> Vec<(String, Vec<u8>)> {
        let read = |name: String| {
            let path = self.path(&name);
            let content = if path.is_file() { std::fs::read(path).unwrap() } else { Vec::new() };
            (name, content)
        };
        self.names().into_iter().map(read).collect()
    }
}
