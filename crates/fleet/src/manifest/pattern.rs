//! A pattern of folders: `nights/{serial}/{date}.csv` with one robot for all.

use super::{Entry, Words, entry};
use crate::error::FleetError;
use std::path::{Path, PathBuf};

/// The files that match a pattern, as the data of entries; in the order of their names.
pub(super) fn entries(pattern: &str, defaults: &Words) -> Result<Vec<Entry>, FleetError> {
    let mut found = vec![(PathBuf::new(), Words::new())];
    let parts: Vec<_> = Path::new(pattern).components().collect();
    for (index, part) in parts.iter().enumerate() {
        let part = part.as_os_str().to_string_lossy().into_owned();
        if !part.contains(['{', '*']) {
            for (path, _) in &mut found {
                path.push(&part);
            }
            continue;
        }
        let is_last = index + 1 == parts.len();
        let mut next = Vec::new();
        for (folder, words) in found {
            let shown = if folder.as_os_str().is_empty() { Path::new(".") } else { &folder };
            let listed = std::fs::read_dir(shown).and_then(Iterator::collect::<Result<Vec<_>, _>>);
            let mut listed = listed.map_err(|error| {
                FleetError::manifest(pattern, format!("{} cannot be read: {error}", shown.display()))
            })?;
            listed.sort_by_key(std::fs::DirEntry::file_name);
            for entry in listed {
                let name = entry.file_name().to_string_lossy().into_owned();
                let fits = !name.starts_with('.') && entry.path().is_dir() != is_last;
                if let Some(new) = matched(&part, &name).filter(|_| fits) {
                    let mut words = words.clone();
                    words.extend(new);
                    next.push((folder.join(&name), words));
                }
            }
        }
        found = next;
    }
    found.retain(|(path, _)| path.is_file());
    if found.is_empty() {
        return Err(FleetError::manifest(pattern, "no file matches; write a pattern like nights/{serial}/{date}.csv"));
    }
    let of = |(path, words): (PathBuf, Words)| {
        let name = path.to_string_lossy().into_owned();
        let mut all = defaults.clone();
        all.extend(words);
        // Without a robot for all, the files are the robots.
        let word = if all.contains_key("robot") { "data" } else { "robot" };
        all.insert(word.into(), name.clone());
        entry(&all, Path::new(""), &name)
    };
    found.into_iter().map(of).collect()
}

/// The values of a pattern's placeholders in a name: each as short as possible, at least one character.
fn matched(pattern: &str, name: &str) -> Option<Words> {
    let Some(start) = pattern.find(['{', '*']) else { return (pattern == name).then(Words::new) };
    let rest = name.strip_prefix(&pattern[..start])?;
    let (word, after) = if let Some(after) = pattern[start..].strip_prefix('*') {
        (None, after)
    } else {
        let (word, after) = pattern[start + 1..].split_once('}')?;
        (Some(word), after)
    };
    let least = usize::from(word.is_some());
    rest.char_indices().map(|(at, _)| at).chain([rest.len()]).filter(|at| *at >= least).find_map(|at| {
        let mut words = matched(after, &rest[at..])?;
        if let Some(word) = word {
            words.insert(word.to_owned(), rest[..at].to_owned());
        }
        Some(words)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn placeholders_take_what_stands_there() {
        let words = matched("{serial}_{date}.csv", "SN-17_2026-11-22.csv").expect("it fits");
        assert_eq!((words["serial"].as_str(), words["date"].as_str()), ("SN-17", "2026-11-22"));
        assert!(matched("{serial}.csv", ".csv").is_none());
        assert!(matched("*.urdf", "a.csv").is_none());
        assert_eq!(matched("run*_{serial}.csv", "run_7.csv").expect("a star may be nothing")["serial"], "7");
    }
}
