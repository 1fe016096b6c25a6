//! The URDF files at hand, and random numbers that are the same everywhere.

#![allow(dead_code, reason = "each test binary uses a part of this")]

use std::path::{Path, PathBuf};

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

/// Numbers in [0, 1), by splitmix64.
pub fn random(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed;
    move || {
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }
}
