//! The URDF files at hand, and random numbers that are the same everywhere.

#![allow(dead_code, reason = "each test binary uses a part of this")]

use std::path::{Path, PathBuf};

#[path = "../../../../tests/seeded.rs"]
mod seeded;

/// The folder of the workspace.
pub fn workspace() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// Every URDF in robots/ and ../shared/vendor/robots, sorted; the latter only where it is there.
pub fn corpus() -> Vec<PathBuf> {
    let workspace = workspace();
    let mut found = Vec::new();
    let mut folders = vec![workspace.join("robots"), workspace.join("../shared/vendor/robots")];
    while let Some(folder) = folders.pop() {
        let Ok(entries) = std::fs::read_dir(&folder) else { continue };
        for entry in entries.flatten() {
            let path = entry.path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("urdf")) {
                found.push(path);
            }
        }
    }
    found.sort();
    found
}

/// Numbers in [0, 1).
pub fn random(seed: u64) -> impl FnMut() -> f64 {
    let mut random = seeded::Random(seed);
    move || random.part()
}
