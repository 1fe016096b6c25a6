//! The vendors' xacro files beside the project against what the Python tool made of them.

use std::path::{Path, PathBuf};

use denavit_xacro::{Limits, Options, Source, expand};

use crate::support::packages_in;
use crate::xml::{comments, difference};

struct Case {
    name: String,
    file: PathBuf,
    arguments: Vec<(String, String)>,
    packages: PathBuf,
    expected: PathBuf,
}

fn vendor() -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/vendor/xacro");
    if !folder.is_dir() {
        println!("skipped, because ../shared/vendor/xacro is not there");
        return None;
    }
    Some(folder.canonicalize().unwrap())
}

fn cases(folder: &Path) -> Vec<Case> {
    let table = std::fs::read_to_string(folder.join("cases.csv")).unwrap();
    let packages = folder.join("packages");
    table
        .lines()
        .skip(1)
        .map(|line| {
            let fields: Vec<&str> = line.split(',').collect();
            let arguments = fields[2].split_whitespace().map(|word| {
                let (name, value) = word.split_once(":=").unwrap();
                (name.to_owned(), value.to_owned())
            });
            Case {
                name: fields[0].to_owned(),
                file: packages.join(fields[1]),
                arguments: arguments.collect(),
                packages: packages.clone(),
                expected: folder.join("expected").join(format!("{}.urdf", fields[0])),
            }
        })
        .collect()
}

fn all_cases(folder: &Path) -> Vec<Case> {
    let mut found = cases(folder);
    let mut more: Vec<PathBuf> =
        std::fs::read_dir(folder.join("more")).unwrap().map(|entry| entry.unwrap().path()).collect();
    more.sort();
    for folder in more.iter().filter(|folder| folder.join("cases.csv").is_file()) {
        found.extend(cases(folder));
    }
    found
}

/// The expected files name packages where `$(find …)` gives folders, and have no doubled slashes after them.
fn with_package_names(text: &str, packages: &Path) -> String {
    let text = text.replace(&format!("{}/", packages.display()), "package://");
    let words = text.split_inclusive(['"', '<', '>', ' ']).map(|word| match word.split_once("package://") {
        Some((before, path)) => format!("{before}package://{}", path.replace("//", "/")),
        None => word.to_owned(),
    });
    words.collect()
}

#[test]
fn vendors_files_expand_as_the_python_tool_does() {
    let Some(folder) = vendor() else { return };
    let cases = all_cases(&folder);
    let mut wrong = Vec::new();
    for case in &cases {
        let expanded = match expand(&Source::path(&case.file), &case.arguments, &packages_in(&case.packages)) {
            Ok(expanded) => expanded,
            Err(error) => {
                wrong.push(format!("{}: {error}", case.name));
                continue;
            }
        };
        let ours = with_package_names(&expanded.urdf, &case.packages);
        let expected = with_package_names(&std::fs::read_to_string(&case.expected).unwrap(), &case.packages);
        if let Some(found) = difference(&ours, &expected) {
            wrong.push(format!("{}: {found}", case.name));
        } else if comments(&ours) != comments(&expected) {
            wrong.push(format!("{}: other comments", case.name));
        }
    }
    println!("{} of {} cases are the same, comments included", cases.len() - wrong.len(), cases.len());
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(cases.len() >= 38, "only {} cases", cases.len());
}

#[test]
fn packages_beside_a_vendors_file_are_found_without_any_path() {
    let Some(folder) = vendor() else { return };
    for case in cases(&folder).iter().filter(|case| case.name == "ur5e" || case.name == "irb2400") {
        let expanded = expand(&Source::path(&case.file), &case.arguments, &Options::default());
        assert!(expanded.is_ok(), "{}: {}", case.name, expanded.unwrap_err());
    }
}

#[test]
fn vendors_files_need_a_tenth_of_the_limits() {
    let Some(folder) = vendor() else { return };
    let full = Limits::default();
    let tenth = Limits {
        depth: full.depth / 10,
        includes: full.includes / 10,
        nodes: full.nodes / 10,
        bytes: full.bytes / 10,
        steps: full.steps / 10,
    };
    for case in all_cases(&folder) {
        let options = Options { limits: tenth.clone(), ..packages_in(&case.packages) };
        let expanded = expand(&Source::path(&case.file), &case.arguments, &options);
        assert!(expanded.is_ok(), "{}: {}", case.name, expanded.unwrap_err());
    }
}
