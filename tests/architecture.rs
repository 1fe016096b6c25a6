//! House rules: who may know whom, and what the documents say of it.

use crate::support::top;
use std::process::Command;

/// A crate may depend on those before it that are named here.
const ALLOWED: &[(&str, &[&str])] = &[
    ("denavit-model", &[]),
    ("denavit-dh", &["denavit-model"]),
    ("denavit-xacro", &[]),
    ("denavit-export", &["denavit-model", "denavit-dh"]),
    ("denavit-compare", &["denavit-model", "denavit-dh", "denavit-export"]),
    ("denavit-calibrate", &["denavit-model", "denavit-dh", "denavit-export"]),
    (
        "denavit-load",
        &["denavit-model", "denavit-dh", "denavit-export", "denavit-compare", "denavit-calibrate", "denavit-xacro"],
    ),
];

#[test]
fn crates_know_only_those_below_them() {
    let output = Command::new(env!("CARGO"))
        .args(["metadata", "--format-version", "1", "--no-deps", "--offline"])
        .current_dir(top())
        .output()
        .unwrap();
    let metadata: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let mut seen = 0;
    for package in metadata["packages"].as_array().unwrap() {
        let name = package["name"].as_str().unwrap();
        let Some((_, allowed)) = ALLOWED.iter().find(|(known, _)| *known == name) else { continue };
        seen += 1;
        for dependency in package["dependencies"].as_array().unwrap() {
            let other = dependency["name"].as_str().unwrap();
            let ours = other.starts_with("denavit");
            assert!(!ours || allowed.contains(&other) || dependency["kind"] == "dev", "{name} depends on {other}");
        }
    }
    assert_eq!(seen, ALLOWED.len(), "a crate is missing from the list or from the workspace");
}

#[test]
fn the_architecture_names_every_crate() {
    let text = std::fs::read_to_string(top().join("ARCHITECTURE.md")).unwrap();
    for entry in std::fs::read_dir(top().join("crates")).unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        assert!(text.contains(&format!("crates/{name}")), "ARCHITECTURE.md says nothing of crates/{name}");
    }
}

/// A crate whose tests are one binary runs only the modules that its `tests/main.rs` names.
#[test]
fn every_test_file_is_a_module_of_its_binary() {
    let mut seen = 0;
    for entry in std::fs::read_dir(top().join("crates")).unwrap() {
        let folder = entry.unwrap().path().join("tests");
        let Ok(main) = std::fs::read_to_string(folder.join("main.rs")) else { continue };
        for file in std::fs::read_dir(&folder).unwrap() {
            let path = file.unwrap().path();
            let name = path.file_stem().unwrap().to_str().unwrap();
            let is_module = path.extension().is_some_and(|extension| extension == "rs") || path.join("mod.rs").exists();
            if name != "main" && is_module {
                assert!(
                    main.contains(&format!("mod {name};")),
                    "{} never runs: tests/main.rs does not name it",
                    path.display()
                );
                seen += 1;
            }
        }
    }
    assert!(seen > 0, "no crate has its tests in one binary");
}
