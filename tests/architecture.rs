//! House rules: which crate or module may use which, and that the documents agree.

use crate::support::top;
use denavit_model::settings::SETTINGS;
use std::collections::{BTreeMap, BTreeSet};
use std::process::Command;

/// A crate may depend only on earlier crates that are listed here.
const ALLOWED: &[(&str, &[&str])] = &[
    ("denavit-model", &[]),
    ("denavit-dh", &["denavit-model"]),
    ("denavit-mjcf", &["denavit-model"]),
    ("denavit-code", &["denavit-model", "denavit-dh"]),
    ("denavit-hand-eye", &["denavit-model"]),
    ("denavit-ik", &["denavit-model"]),
    ("denavit-xacro", &[]),
    ("denavit-sdf", &["denavit-model"]),
    ("denavit-bag", &[]),
    ("denavit-export", &["denavit-model", "denavit-dh"]),
    ("denavit-compare", &["denavit-model", "denavit-dh", "denavit-export"]),
    ("denavit-edit", &["denavit-model", "denavit-dh", "denavit-export", "denavit-compare"]),
    ("denavit-linear", &[]),
    ("denavit-measurements", &["denavit-model"]),
    ("denavit-identify", &["denavit-model", "denavit-export", "denavit-linear", "denavit-measurements"]),
    ("denavit-trace", &["denavit-model", "denavit-linear", "denavit-measurements", "denavit-identify"]),
    (
        "denavit-calibrate",
        &[
            "denavit-model",
            "denavit-dh",
            "denavit-export",
            "denavit-linear",
            "denavit-ik",
            "denavit-measurements",
            "denavit-identify",
            "denavit-trace",
        ],
    ),
    (
        "denavit-load",
        &[
            "denavit-model",
            "denavit-mjcf",
            "denavit-dh",
            "denavit-export",
            "denavit-compare",
            "denavit-measurements",
            "denavit-identify",
            "denavit-trace",
            "denavit-calibrate",
            "denavit-sdf",
            "denavit-xacro",
        ],
    ),
    (
        "denavit-fleet",
        &[
            "denavit-model",
            "denavit-dh",
            "denavit-export",
            "denavit-compare",
            "denavit-linear",
            "denavit-measurements",
            "denavit-identify",
            "denavit-calibrate",
            "denavit-load",
        ],
    ),
    (
        "denavit-lsp",
        &[
            "denavit-model",
            "denavit-dh",
            "denavit-export",
            "denavit-compare",
            "denavit-edit",
            "denavit-xacro",
            "denavit-load",
        ],
    ),
    (
        "denavit-web",
        &[
            "denavit-model",
            "denavit-dh",
            "denavit-export",
            "denavit-compare",
            "denavit-measurements",
            "denavit-identify",
            "denavit-trace",
            "denavit-calibrate",
            "denavit-edit",
            "denavit-ik",
            "denavit-xacro",
            "denavit-load",
        ],
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
        let Some((_, allowed)) = ALLOWED.iter().find(|(known, _)| *known == name) else {
            continue;
        };
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
        let Ok(main) = std::fs::read_to_string(folder.join("main.rs")) else {
            continue;
        };
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

/// Modules in layers: each may use those of its own layer and of the layers before it.
const LAYERS: &[(&str, &[&[&str]])] = &[
    (
        "identify",
        &[
            &[
                "arm",
                "effects_prior",
                "frames",
                "gauge",
                "least_squares",
                "observe",
                "parameter",
                "parameters",
                "prior",
                "symmetric",
            ],
            &["effects"],
            &[
                "averaging",
                "carried",
                "continued",
                "dh_form",
                "identifiability",
                "identification",
                "identify_options",
                "information",
                "initial_guess",
                "intervals",
                "jacobian_block",
                "known_effects",
                "lack_of_fit",
                "noise",
                "normal_equations",
                "posterior",
                "proportion",
                "quantization",
                "redundancy",
                "residual",
                "residual_statistics",
                "siblings",
                "simd_residuals",
                "solve",
            ],
            &["simulate"],
        ],
    ),
    ("calibrate", &[&["apply"], &["calibration"], &["report"]]),
];

/// The modules that Rust code refers to by `crate::MODULE`.
fn modules_named<'a>(text: &str, modules: &[&'a str]) -> Vec<&'a str> {
    let named = |module: &&str| {
        text.match_indices("crate::").any(|(at, _)| {
            let rest = &text[at + "crate::".len()..];
            rest.strip_prefix(*module)
                .is_some_and(|after| !after.starts_with(|c: char| c.is_alphanumeric() || c == '_'))
        })
    };
    modules.iter().copied().filter(|module| named(module)).collect()
}

fn rust_files(folder: &std::path::Path, files: &mut Vec<std::path::PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            rust_files(&path, files);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            files.push(path);
        }
    }
}

#[test]
fn modules_know_only_those_of_layers_before_them() {
    for (name, layers) in LAYERS {
        let source = top().join("crates").join(name).join("src");
        let modules: Vec<&str> = layers.concat();
        let layer_of = |module: &str| layers.iter().position(|layer| layer.contains(&module));
        let mut files = Vec::new();
        rust_files(&source, &mut files);
        let mut seen = BTreeSet::new();
        for file in files {
            let inside = file.strip_prefix(&source).unwrap().with_extension("");
            let first = inside.components().next().unwrap().as_os_str().to_str().unwrap().to_owned();
            if first == "lib" {
                continue;
            }
            let own = layer_of(&first).unwrap_or_else(|| panic!("{} is in no layer of this test", file.display()));
            let text = std::fs::read_to_string(&file).unwrap();
            let text = text.split("#[cfg(test)]").next().unwrap_or_default();
            for named in modules_named(text, &modules) {
                assert!(
                    layer_of(named).unwrap() <= own,
                    "{}: {first} knows {named}, which comes after it",
                    file.display()
                );
            }
            assert!(!text.contains("use crate::{"), "{}: name the module: use crate::MODULE::…", file.display());
            seen.insert(first);
        }
        assert_eq!(seen.len(), modules.len(), "a module of the list is gone from {name}");
    }
}

/// Paths that a `use` declaration imports, its braces resolved: `a::{b, c::d}` is `a::b` and `a::c::d`.
fn imported(tree: &str, before: &str, out: &mut Vec<String>) {
    let tree = tree.trim();
    let (head, list) = match tree.split_once('{') {
        Some((head, list)) => (head, list.trim_end().strip_suffix('}').unwrap_or(list)),
        None => return out.push(format!("{before}{}", tree.split(" as ").next().unwrap())),
    };
    let before = format!("{before}{head}");
    let (mut depth, mut start) = (0, 0);
    for (at, letter) in list.char_indices().chain([(list.len(), ',')]) {
        match letter {
            '{' => depth += 1,
            '}' => depth -= 1,
            ',' if depth == 0 => {
                let part = &list[start..at];
                start = at + 1;
                if !part.trim().is_empty() {
                    imported(part, &before, out);
                }
            }
            _ => {}
        }
    }
}

/// The modules of a crate, each with the modules that its code imports, without its tests; names that a module only passes on
/// (`pub use`) count for those who import them from there.
fn imports_of_modules(files: &[(String, String)]) -> BTreeMap<&str, BTreeSet<&str>> {
    let modules: Vec<&str> = files.iter().map(|(module, _)| module.as_str()).collect();
    let (mut own, mut passed_on) = (Vec::new(), BTreeMap::new());
    for (module, text) in files {
        let text = text.split("#[cfg(test)]").next().unwrap();
        let parent = module.rsplit_once("::").map_or("crate", |(parent, _)| parent);
        for (at, _) in text.match_indices("use ").filter(|(at, _)| *at == 0 || text[..*at].ends_with(['\n', ' ', ')']))
        {
            let line = text[..at].rsplit('\n').next().unwrap().trim_start();
            if !line.is_empty() && !line.starts_with("pub") {
                continue;
            }
            let mut paths = Vec::new();
            imported(text[at + "use ".len()..].split(';').next().unwrap(), "", &mut paths);
            for path in paths {
                let first = path.split("::").next().unwrap();
                let mut path = match first {
                    "self" | "super" => path.replacen(first, if first == "self" { module } else { parent }, 1),
                    _ if modules.contains(&format!("{module}::{first}").as_str()) => format!("{module}::{path}"),
                    _ => path,
                };
                while let Some((before, after)) = path.split_once("::super::") {
                    path = format!("{}::{after}", before.rsplit_once("::").unwrap().0);
                }
                if line.starts_with("pub") {
                    passed_on.insert(format!("{module}::{}", path.rsplit("::").next().unwrap()), path);
                } else {
                    own.push((module.as_str(), path));
                }
            }
        }
    }
    let mut edges: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
    for (module, path) in &own {
        let mut path = path;
        while let Some(next) = passed_on.get(path) {
            path = next;
        }
        let inside = |other: &&&str| path == **other || path.starts_with(&format!("{other}::"));
        if let Some(other) =
            modules.iter().filter(inside).max_by_key(|other| other.len()).filter(|other| *other != module)
        {
            edges.entry(module).or_default().insert(other);
        }
    }
    edges
}

/// Modules that import one another, directly or through others.
fn import_circle<'a>(edges: &BTreeMap<&'a str, BTreeSet<&'a str>>) -> Option<Vec<&'a str>> {
    edges.keys().find_map(|start| {
        let mut ways = vec![vec![*start]];
        let mut seen = BTreeSet::new();
        while let Some(way) = ways.pop() {
            for next in edges.get(way.last().unwrap()).into_iter().flatten() {
                if next == start {
                    return Some(way);
                }
                if seen.insert(*next) {
                    ways.push([&way[..], &[next]].concat());
                }
            }
        }
        None
    })
}

#[test]
fn modules_of_the_calibration_crates_import_in_one_direction() {
    let mut imports = 0;
    for name in ["linear", "measurements", "identify", "trace", "calibrate"] {
        let source = top().join("crates").join(name).join("src");
        let mut files = Vec::new();
        rust_files(&source, &mut files);
        let module = |file: &std::path::PathBuf| {
            let inside = file.strip_prefix(&source).unwrap().with_extension("");
            let parts = inside.iter().map(|part| part.to_str().unwrap()).filter(|part| *part != "lib");
            (
                std::iter::once("crate").chain(parts).collect::<Vec<_>>().join("::"),
                std::fs::read_to_string(file).unwrap(),
            )
        };
        let files: Vec<(String, String)> = files.iter().map(module).collect();
        let edges = imports_of_modules(&files);
        imports += edges.values().map(BTreeSet::len).sum::<usize>();
        assert_eq!(import_circle(&edges), None, "modules of {name} that import one another");
    }
    assert!(imports > 500, "{imports} imports were seen");
    let file = |module: &str, text: &str| (module.to_owned(), text.to_owned());
    let circle = [
        file("crate::a", "pub use self::b::{B, C};\npub mod b;\n"),
        file("crate::a::b", "use crate::d::{self, D as Other};\n"),
        file("crate::d", "use crate::a::B;\n#[cfg(test)]\nuse crate::e::E;\n"),
    ];
    assert_eq!(import_circle(&imports_of_modules(&circle)), Some(vec!["crate::a::b", "crate::d"]));
    assert_eq!(import_circle(&imports_of_modules(&circle[..2])), None);
}

/// The public names at the root of `denavit-calibrate`, as its documentation shows them.
fn promised_by_calibrate(lib: &str) -> Vec<String> {
    let uses = lib.split("\npub use ").collect::<Vec<_>>();
    let is_hidden = |before: &str| before.trim_end().ends_with("#[doc(hidden)]");
    let promised = uses.windows(2).filter(|pair| !is_hidden(pair[0])).map(|pair| pair[1].split(';').next().unwrap());
    let names = promised.flat_map(|path| match path.split_once('{') {
        Some((_, list)) => list.trim_end_matches('}').split(',').map(str::trim).collect::<Vec<_>>(),
        None => vec![path.rsplit("::").next().unwrap()],
    });
    let last = |name: &str| name.rsplit(" as ").next().unwrap().to_owned();
    names.filter(|name| !name.is_empty()).map(last).collect()
}

#[test]
fn calibrate_promises_some_sixty_names() {
    let folder = top().join("crates/calibrate");
    let read = |file: &str| std::fs::read_to_string(folder.join(file)).unwrap();
    let lib = read("src/lib.rs");
    for (at, _) in lib.match_indices(
        "
pub mod ",
    ) {
        assert!(lib[..at].ends_with("#[doc(hidden)]"), "a module of calibrate that its documentation shows");
    }
    let names = promised_by_calibrate(&lib);
    assert!((50..=70).contains(&names.len()), "{} names: {names:?}", names.len());
    assert!(!names.iter().any(|name| name == "*"), "{names:?}");
    let example = read("examples/calibrate_arm.rs");
    let used = example.split("use denavit_calibrate::{").nth(1).unwrap().split('}').next().unwrap();
    for name in used.split(',').map(str::trim) {
        assert!(names.iter().any(|promised| promised == name), "calibrate_arm.rs uses {name}, which is not promised");
    }
    assert_eq!(example.matches("denavit_calibrate").count(), 1, "calibrate_arm.rs reaches into a module");
}

/// Lines of code of the libraries without comments, each with its file.
fn library_lines() -> Vec<(std::path::PathBuf, String)> {
    let mut lines = Vec::new();
    for entry in std::fs::read_dir(top().join("crates")).unwrap() {
        let folder = entry.unwrap().path();
        if folder.ends_with("cli") {
            continue;
        }
        let mut files = Vec::new();
        rust_files(&folder.join("src"), &mut files);
        for file in files {
            let text = std::fs::read_to_string(&file).unwrap();
            let code = text.lines().filter(|line| !line.trim_start().starts_with("//"));
            lines.extend(code.map(|line| (file.clone(), line.to_owned())));
        }
    }
    lines
}

#[test]
fn libraries_name_no_flag_of_the_command_line() {
    // Words for git and for ROS, the words of operations (the same in Python), and the test of the forms themselves.
    let may = [
        "edit/src/operation.rs",
        "fleet/src/corpus/history.rs",
        "hand-eye/src/report.rs",
        "load/src/read.rs",
        "load/src/repository.rs",
        "load/src/revision.rs",
        "model/src/settings.rs",
    ];
    let flag = |line: &str| {
        line.match_indices("--").any(|(at, _)| {
            let before = line[..at].chars().next_back();
            let begins = before.is_none_or(|before| !before.is_alphanumeric() && before != '-');
            begins && line[at + 2..].starts_with(|c: char| c.is_ascii_lowercase())
        })
    };
    let lines = library_lines();
    assert!(lines.len() > 10_000, "{} lines were looked at", lines.len());
    let found: Vec<_> = lines
        .iter()
        .filter(|(file, line)| flag(line) && !may.iter().any(|known| file.ends_with(known)))
        .map(|(file, line)| format!("{}: {}", file.display(), line.trim()))
        .collect();
    assert!(found.is_empty(), "write a setting in its marks (see denavit_model::settings):\n{}", found.join("\n"));
    assert!(flag("say --units deg") && flag("\"--tip") && !flag("a---b") && !flag("x -- y"));
}

#[test]
fn settings_in_messages_are_flags_of_the_command_line() {
    let mut files = vec![top().join("crates/cli/src/args.rs")];
    rust_files(&top().join("crates/cli/src/args"), &mut files);
    let arguments: String = files.iter().map(|file| std::fs::read_to_string(file).unwrap()).collect();
    for setting in SETTINGS {
        let field = [" ", "r#"].map(|before| format!("{before}{}:", setting.replace('-', "_")));
        let is_flag =
            arguments.contains(&format!("long = \"{setting}\"")) || field.iter().any(|f| arguments.contains(f));
        assert!(is_flag, "no command has --{setting}");
    }
    let mut named = BTreeSet::new();
    for (file, line) in library_lines().into_iter().filter(|(file, _)| !file.ends_with("model/src/settings.rs")) {
        let settings: Vec<&str> = denavit_model::settings::named(&line).collect();
        assert_eq!(settings.len(), line.matches('‹').count(), "{}: no setting is called so: {line}", file.display());
        named.extend(settings);
    }
    assert_eq!(named.into_iter().collect::<Vec<_>>(), SETTINGS, "a setting that no message names");
}

/// Files of the library crates that other code uses, each with its crate's folder; without the page's crate, which answers JavaScript.
fn published_files() -> Vec<(std::path::PathBuf, std::path::PathBuf)> {
    let mut all = Vec::new();
    for entry in std::fs::read_dir(top().join("crates")).unwrap() {
        let folder = entry.unwrap().path();
        if !folder.ends_with("cli") && !folder.ends_with("web") {
            let mut files = Vec::new();
            rust_files(&folder.join("src"), &mut files);
            all.extend(files.into_iter().map(|file| (folder.clone(), file)));
        }
    }
    all
}

/// Whether a file is in a private module of its crate.
fn is_private(folder: &std::path::Path, file: &std::path::Path) -> bool {
    let lib = std::fs::read_to_string(folder.join("src/lib.rs")).unwrap();
    let inside = file.strip_prefix(folder.join("src")).unwrap().with_extension("");
    let first = inside.components().next().unwrap().as_os_str().to_str().unwrap().to_owned();
    lib.contains(&format!("\nmod {first};")) && !lib.contains(&format!("\npub mod {first};"))
}

#[test]
fn no_public_function_fails_with_a_bare_text() {
    // A caller's function for fetching files fails with the caller's words; modules below the root of calibrate are not for other crates.
    let may = |folder: &std::path::Path, name: &str| {
        ["calibrate", "identify", "measurements", "trace"].iter().any(|own| folder.ends_with(own)) || name == "nothing"
    };
    let (mut found, mut seen) = (Vec::new(), 0);
    for (folder, file) in published_files() {
        let text = std::fs::read_to_string(&file).unwrap();
        for rest in text.split("pub fn ").skip(1) {
            seen += 1;
            let signature = rest.split(['{', ';']).next().unwrap();
            let name = signature.split(['(', '<']).next().unwrap();
            if signature.contains(", String>")
                && signature.contains("-> Result<")
                && !may(&folder, name)
                && !is_private(&folder, &file)
            {
                found.push(format!("{}: {name}", file.display()));
            }
        }
    }
    assert!(seen > 1000, "{seen} functions were looked at");
    assert!(found.is_empty(), "give the error a type:\n{}", found.join("\n"));
}

#[test]
fn public_errors_hold_no_types_of_other_crates() {
    const FOREIGN: &[&str] =
        &["calamine", "csv", "mcap", "parquet", "roxmltree", "rusqlite", "saphyr_parser", "serde_json", "toml"];
    let mut seen = 0;
    for (_, file) in published_files() {
        let text = std::fs::read_to_string(&file).unwrap();
        for rest in text.split("\npub enum ").skip(1) {
            let body = rest.split("\n}").next().unwrap();
            if !body.split_whitespace().next().unwrap_or_default().ends_with("Error") {
                continue;
            }
            seen += 1;
            let foreign = FOREIGN.iter().find(|name| body.contains(&format!("{name}::")));
            assert!(foreign.is_none(), "{}: a public error holds a type of {foreign:?}", file.display());
        }
    }
    assert!(seen > 20, "{seen} errors were looked at");
}

/// Public error types are non-exhaustive, because new reasons to refuse may be added.
#[test]
fn public_errors_may_grow() {
    let mut missing = Vec::new();
    for (folder, file) in published_files() {
        let text = std::fs::read_to_string(&file).unwrap();
        for (at, _) in text.match_indices("\npub enum ") {
            let name = text[at + "\npub enum ".len()..].split([' ', '<']).next().unwrap();
            let before = text[..at].rsplit("\n\n").next().unwrap();
            if name.ends_with("Error") && !before.contains("#[non_exhaustive]") && !is_private(&folder, &file) {
                missing.push(format!("{}: {name}", file.display()));
            }
        }
    }
    assert!(missing.is_empty(), "#[non_exhaustive] is missing:\n{}", missing.join("\n"));
}

#[test]
fn every_crate_says_what_a_registry_shows() {
    for entry in std::fs::read_dir(top().join("crates")).unwrap() {
        let folder = entry.unwrap().path();
        let manifest = std::fs::read_to_string(folder.join("Cargo.toml")).unwrap();
        for key in ["description = ", "repository.workspace", "documentation = ", "readme = ", "rust-version.workspace"]
        {
            assert!(manifest.contains(&format!("\n{key}")), "{}: no {key}", folder.display());
        }
        assert!(folder.join("README.md").is_file(), "{}: no README.md", folder.display());
    }
}
