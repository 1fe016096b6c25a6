//! Each feature against its golden file. `tests/oracle/xacro` holds the same files against the Python tool.

use std::path::PathBuf;

use denavit_xacro::{Source, expand};

use crate::support::{fixtures, packages_in, without_folders};
use crate::xml::difference;

fn documents() -> Vec<PathBuf> {
    let folder = fixtures().join("features");
    let mut files: Vec<PathBuf> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "xacro"))
        .collect();
    files.sort();
    files
}

#[test]
fn every_feature_expands_to_its_golden_file() {
    let files = documents();
    assert!(files.len() >= 14, "only {} files", files.len());
    for file in files {
        let options = packages_in(&fixtures().join("features/packages"));
        let expanded = expand(&Source::path(&file), &[], &options).unwrap_or_else(|error| panic!("{error}"));
        let notes: Vec<String> = expanded.notes.iter().map(|note| format!("note: {note}\n")).collect();
        let text = without_folders(&(expanded.urdf + &notes.concat()));
        let name = file.file_stem().unwrap().to_str().unwrap().to_owned();
        insta::with_settings!({
            snapshot_path => fixtures().join("features"), prepend_module_to_snapshot => false, omit_expression => true
        }, {
            insta::assert_snapshot!(name, text);
        });
    }
}

#[test]
fn expanding_an_expanded_document_changes_nothing() {
    for file in documents() {
        let options = packages_in(&fixtures().join("features/packages"));
        let once = expand(&Source::path(&file), &[], &options).unwrap();
        // Escapes are undone by the first expansion, and would be expressions in the second.
        if once.urdf.contains("${") || once.urdf.contains("$(") {
            continue;
        }
        let twice = expand(&Source::text("again", once.urdf.as_str()), &[], &options).unwrap();
        assert_eq!(difference(&once.urdf, &twice.urdf), None, "{}", file.display());
        assert_eq!(once.urdf, twice.urdf);
    }
}

#[test]
fn arguments_files_and_notes_are_reported() {
    let file = fixtures().join("features/substitutions.xacro");
    let given = [("count".to_owned(), "7".to_owned()), ("coutn".to_owned(), "8".to_owned())];
    let expanded = expand(&Source::path(&file), &given, &packages_in(&fixtures())).unwrap();
    assert!(expanded.urdf.contains("sum=\"8\""), "{}", expanded.urdf);
    let declared: Vec<(&str, Option<&str>, &str)> = expanded
        .arguments
        .iter()
        .map(|argument| (argument.name.as_str(), argument.default.as_deref(), argument.value.as_str()))
        .collect();
    assert_eq!(
        declared,
        [
            ("name", Some("given"), "given"),
            ("count", Some("${1 + 2}"), "7"),
            ("file", Some("config/limits.yaml"), "config/limits.yaml"),
        ]
    );
    let notes: Vec<String> = expanded.notes.iter().map(ToString::to_string).collect();
    assert_eq!(notes, ["the argument \"coutn\" is given, but the document does not declare it"]);

    let file = fixtures().join("features/includes.xacro");
    let expanded = expand(&Source::path(&file), &[], &packages_in(&fixtures().join("features/packages"))).unwrap();
    let read: Vec<String> =
        expanded.files_read.iter().map(|file| without_folders(&file.display().to_string())).collect();
    assert_eq!(
        read,
        [
            "features/includes.xacro",
            "features/parts/plain.xacro",
            "features/parts/named.xacro",
            "features/parts/many_1.xacro",
            "features/parts/many_2.xacro",
            "features/packages/arm_description/urdf/arm.xacro",
            "features/packages/arm_description/urdf/inner.xacro",
            "features/packages/arm_description/config/limits.yaml",
        ]
    );
}
