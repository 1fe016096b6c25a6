//! The file of a baseline: paths in it count from its own folder, so that it means the same wherever a check is run.

use super::File;
use crate::failure::Failure;
use crate::output::{self, Outputs, Slot, Status};
use denavit_compare::Finding;
use denavit_compare::lint::Baseline;
use std::path::{Component, Path, PathBuf};

/// A baseline that was read.
pub(super) struct Known {
    baseline: Baseline,
    folder: PathBuf,
}

impl Known {
    pub fn read(path: &Path) -> Result<Self, Failure> {
        let (file, text) = crate::source::read_text(&path.to_string_lossy())?;
        let baseline = Baseline::read(&file, &text).map_err(|error| Failure::Argument(error.to_string()))?;
        Ok(Self { baseline, folder: folder_of(path) })
    }

    /// The findings of a file that are not known, and how many are.
    pub fn new_among(&self, name: &str, findings: Vec<Finding>) -> (Vec<Finding>, usize) {
        self.baseline.new_among(&named(name, &self.folder), findings)
    }

    /// How many findings are known of a file.
    pub fn known_of(&self, name: &str) -> usize {
        self.baseline.known_of(&named(name, &self.folder))
    }
}

/// A baseline that is to be written.
pub(super) struct Recorded {
    outputs: Outputs,
    slot: Slot,
    path: PathBuf,
}

impl Recorded {
    pub fn to(path: &Path, inputs: &[String]) -> Result<Self, Failure> {
        let mut outputs = Outputs::beside(inputs.iter().map(String::as_str));
        let slot = outputs.add("--write-baseline", path)?;
        Ok(Self { outputs, slot, path: path.to_owned() })
    }

    pub fn write(&self, files: &[File]) -> Result<Status, Failure> {
        let folder = folder_of(&self.path);
        let mut baseline = Baseline::default();
        for file in files {
            baseline.add(&named(&file.name, &folder), &file.findings);
        }
        self.outputs.write(&[(self.slot, baseline.text())])?;
        output::mention(format!(
            "{}: {} finding(s) of {} file(s) are now known",
            self.path.display(),
            baseline.len(),
            files.len()
        ));
        Ok(Status::Same)
    }
}

fn absolute(path: &Path) -> PathBuf {
    let path = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    // Links on the way to the working folder must not make two names of one file.
    let real = path.ancestors().find_map(|above| {
        let real = above.canonicalize().ok()?;
        Some(real.join(path.strip_prefix(above).ok()?))
    });
    real.unwrap_or(path)
}

fn folder_of(baseline: &Path) -> PathBuf {
    absolute(baseline).parent().map_or_else(PathBuf::new, Path::to_owned)
}

/// What a baseline in `folder` calls a source: its path from there with "/", or its name where it is no file.
fn named(name: &str, folder: &Path) -> String {
    if name == "-" || name.starts_with("git:") {
        return name.to_owned();
    }
    let file = absolute(Path::new(name));
    let common = file.components().zip(folder.components()).take_while(|(one, other)| one == other).count();
    let up = folder.components().skip(common).map(|_| "..".to_owned());
    let down = file.components().skip(common).filter_map(|component| match component {
        Component::Normal(name) => Some(name.to_string_lossy().into_owned()),
        _ => None,
    });
    up.chain(down).collect::<Vec<_>>().join("/")
}
