//! Real files: the vendor corpus beside the workspace and the robots in it.

use denavit_model::{Robot, urdf};
use std::path::{Path, PathBuf};

fn workspace() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// Every URDF below a folder, sorted by path.
fn below(folder: &Path) -> Vec<PathBuf> {
    let mut open = vec![folder.to_owned()];
    let mut found = Vec::new();
    while let Some(folder) = open.pop() {
        let Ok(entries) = std::fs::read_dir(folder) else { continue };
        for entry in entries.flatten() {
            let path = entry.path();
            if path.is_dir() {
                open.push(path);
            } else if path.extension().is_some_and(|extension| extension == "urdf") {
                found.push(path);
            }
        }
    }
    found.sort();
    found
}

/// Name and text of every readable URDF of the corpus and of `robots/`.
pub fn texts() -> Vec<(String, String)> {
    let folders =
        ["../shared/vendor/robots", "../shared/vendor/quirky", "robots"].map(|folder| workspace().join(folder));
    let paths = folders.iter().flat_map(|folder| below(folder).into_iter().map(move |path| (folder.clone(), path)));
    let read = paths.filter_map(|(folder, path)| {
        let name = path.strip_prefix(&folder).ok()?.to_string_lossy().into_owned();
        Some((name, std::fs::read_to_string(&path).ok()?))
    });
    read.collect()
}

/// The robots that those texts describe; those that are no URDF are left out.
pub fn robots() -> Vec<Robot> {
    texts().iter().filter_map(|(name, text)| urdf::read(name, text).ok()).collect()
}

/// One robot of the corpus, where it is there.
pub fn robot(name: &str) -> Option<Robot> {
    let path = workspace().join("../shared/vendor").join(name);
    let text = std::fs::read_to_string(&path).ok()?;
    Some(urdf::read(name, &text).unwrap())
}
