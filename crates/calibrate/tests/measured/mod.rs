//! Real measurements, where they are at hand.

use std::path::PathBuf;

/// Where a file of them is; says that the test is skipped where it is not.
pub fn measured(name: &str) -> Option<PathBuf> {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared/measured").join(name);
    if path.exists() {
        return Some(path);
    }
    println!("skipped, because {} is not here", path.display());
    None
}
