//! Conversations over vendors' real xacro packages.

use crate::editor::Editor;
use crate::own::recorded;
use serde_json::{Value, json};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// The packages, where they are here.
fn packages() -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/vendor/xacro/packages");
    if folder.is_dir() {
        return Some(folder);
    }
    println!("skipped, because ../shared/vendor/xacro is not here");
    None
}

const UR: &str = "ur_description/urdf/ur.urdf.xacro";
const UR_MACRO: &str = "ur_description/urdf/ur_macro.xacro";

fn ur(folder: &Path) -> Editor {
    let arguments = json!({"xacroArguments": {"ur.urdf.xacro": "name:=ur5e ur_type:=ur5e"}});
    let mut editor = Editor::in_folder(folder, &arguments);
    editor.open(UR);
    editor.open(UR_MACRO);
    editor
}

#[test]
fn a_real_macro_is_hovered_followed_and_checked() {
    let Some(folder) = packages() else { return };
    let mut editor = ur(&folder);
    let mut said =
        format!("problems of {UR}:\n{}\nproblems of {UR_MACRO}:\n{}\n", editor.problems(UR), editor.problems(UR_MACRO));
    let places = [
        (UR, "<xacro:ur_|robot"),
        (UR, "$(arg |ur_type)"),
        (UR, "$(find |ur_description)"),
        (UR_MACRO, "<joint name=\"${tf_prefix}|shoulder_pan_joint\""),
        (UR_MACRO, "<link name=\"${tf_prefix}|forearm_link\""),
        (UR_MACRO, "${|shoulder_x}"),
    ];
    for (file, place) in places {
        let _ = writeln!(said, "{file} {place}\n{}\n", editor.hover(file, place));
    }
    for (file, place) in places {
        said.push_str(&editor.definition_and_references(file, place));
    }
    recorded!("vendor_ur", said);
}

#[test]
fn an_error_in_a_real_macro_is_in_its_file_with_the_calls() {
    let Some(folder) = packages() else { return };
    let mut editor = ur(&folder);
    editor.type_over(UR_MACRO, "${shoulder_x}", "${shouldr_x}");
    let mut said = editor.problems(UR_MACRO);
    editor.type_over(UR_MACRO, "${shouldr_x}", "${shoulder_x}");
    editor.type_over(UR_MACRO, "<axis xyz=\"0 0 1\"", "<axis xyz=\"0 0 0\"");
    let _ = write!(said, "\n\nan axis of length zero:\n{}", editor.problems(UR_MACRO));
    recorded!("vendor_ur_errors", said);
}

#[test]
fn a_rename_that_an_expression_makes_is_refused_and_a_plain_one_is_done() {
    let Some(folder) = packages() else { return };
    let mut editor = ur(&folder);
    let refused = editor.ask_at(
        "textDocument/rename",
        UR_MACRO,
        "<link name=\"${tf_prefix}|forearm_link\"",
        &json!({"newName": "x"}),
    );
    let mut said = refused.unwrap_err();
    let edit = editor
        .ask_at("textDocument/rename", UR, "<link name=\"|world\"", &json!({"newName": "cell"}))
        .map(|edit| editor.edited(&edit));
    match edit {
        Ok(edited) => {
            for (file, text) in edited {
                let before = std::fs::read_to_string(folder.join(&file)).unwrap();
                for (after, before) in text.lines().zip(before.lines()).filter(|(after, before)| after != before) {
                    let _ = write!(said, "\n{file}: {} -> {}", before.trim(), after.trim());
                }
            }
        }
        Err(why) => {
            let _ = write!(said, "\n{why}");
        }
    }
    recorded!("vendor_ur_rename", editor.shown(&said));
}

#[test]
fn every_package_opens_and_answers() {
    let Some(folder) = packages() else { return };
    let mut said = String::new();
    for file in [
        "fanuc_lrmate200id_support/urdf/lrmate200id.xacro",
        "franka_description/robots/panda/panda.urdf.xacro",
        "xarm_description/urdf/xarm_device.urdf.xacro",
        "abb_irb2400_support/urdf/irb2400_12_155.xacro",
    ] {
        if !folder.join(file).exists() {
            let _ = writeln!(said, "{file}: not here");
            continue;
        }
        let mut editor = Editor::in_folder(&folder, &Value::Null);
        editor.open(file);
        let mut of = |method: &str| {
            editor.ask_of(method, file, &json!({"options": {"tabSize": 2, "insertSpaces": true}})).unwrap()
        };
        let (folds, symbols, lenses, edits) = (
            of("textDocument/foldingRange"),
            of("textDocument/documentSymbol"),
            of("textDocument/codeLens"),
            of("textDocument/formatting"),
        );
        let count = |value: &Value| value.as_array().map_or(0, Vec::len);
        let title = match lenses.get(0) {
            Some(lens) => editor.ask("codeLens/resolve", lens.clone()).unwrap()["command"]["title"]
                .as_str()
                .unwrap()
                .split(", tip")
                .next()
                .unwrap()
                .replace(", same as HEAD", ""),
            None => "no lens".to_owned(),
        };
        let problems = editor.problems(file);
        let _ = writeln!(
            said,
            "{file}: {title}; {} problems in it, {} folds, {} symbols, {} edits to format",
            problems.lines().filter(|line| !line.starts_with(' ')).count(),
            count(&folds),
            count(&symbols),
            count(&edits)
        );
    }
    recorded!("vendor_packages", said);
}
