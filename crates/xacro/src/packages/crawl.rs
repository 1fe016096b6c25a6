//! Searches folders for packages.

use crate::files;
use std::path::{Path, PathBuf};

/// Larger trees are not a search path but probably a home folder.
const MOST_FOLDERS: usize = 20_000;

/// The name that a folder's `package.xml` gives; `None` where there is none, or it has no name.
pub fn package_name(folder: &Path) -> Option<String> {
    let manifest = String::from_utf8(files::read(&folder.join("package.xml")).ok()?).ok()?;
    let document = roxmltree::Document::parse(&manifest).ok()?;
    let name = document.root_element().children().find(|node| node.has_tag_name("name"))?;
    Some(name.text()?.trim().to_owned())
}

/// The packages at and below a folder, sorted by path; folders inside packages are not looked at.
pub(super) fn packages(folder: &Path, depth: usize) -> Vec<(String, PathBuf)> {
    let mut found = Vec::new();
    let mut seen = 0;
    walk(folder, depth, &mut seen, &mut found);
    found
}

fn walk(folder: &Path, depth: usize, seen: &mut usize, found: &mut Vec<(String, PathBuf)>) {
    *seen += 1;
    if *seen > MOST_FOLDERS {
        return;
    }
    if let Some(name) = package_name(folder) {
        found.push((name, folder.to_path_buf()));
        return;
    }
    let ignored = ["COLCON_IGNORE", "AMENT_IGNORE", "CATKIN_IGNORE"];
    if depth == 0 || ignored.iter().any(|marker| files::exists(&folder.join(marker))) {
        return;
    }
    let mut folders: Vec<PathBuf> = files::entries(folder)
        .into_iter()
        .filter(|path| files::is_folder(path))
        .filter(|path| !path.file_name().is_some_and(|name| name.to_string_lossy().starts_with('.')))
        .collect();
    folders.sort();
    for inner in folders {
        walk(&inner, depth - 1, seen, found);
    }
}
