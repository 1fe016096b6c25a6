//! Conversations over small files of our own.

use crate::editor::{Editor, with_edits};
use denavit_edit::{Files, Operation, Renaming};
use serde_json::{Value, json};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

const XACRO: &str = "arm_description/urdf/arm.urdf.xacro";
const MACRO: &str = "arm_description/urdf/arm_macro.xacro";
const SRDF: &str = "arm_description/config/arm.srdf";

fn files() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/files")
}

fn editor() -> Editor {
    Editor::in_folder(&files(), &Value::Null)
}

/// A snapshot of what was said.
macro_rules! recorded {
    ($said:expr) => {
        insta::with_settings!({ omit_expression => true, prepend_module_to_snapshot => false, snapshot_path => "recorded" }, {
            insta::assert_snapshot!($said);
        });
    };
    ($name:expr, $said:expr) => {
        insta::with_settings!({ omit_expression => true, prepend_module_to_snapshot => false, snapshot_path => "recorded" }, {
            insta::assert_snapshot!($name, $said);
        });
    };
}
pub(crate) use recorded;

#[test]
fn capabilities_are_announced_in_the_offered_encoding() {
    let editor = editor();
    assert_eq!(editor.capabilities["capabilities"]["positionEncoding"], "utf-16");
    let offered = json!({"capabilities": {"general": {"positionEncodings": ["utf-8", "utf-16"]}}});
    let editor = Editor::with(&files(), &offered);
    assert_eq!(editor.capabilities["capabilities"]["positionEncoding"], "utf-8");
    let capabilities = serde_json::to_string_pretty(&editor.capabilities).unwrap();
    recorded!("capabilities", capabilities);
}

#[test]
fn problems_come_as_you_type_and_go_when_they_are_fixed() {
    let mut editor = editor();
    editor.open("hinge.urdf");
    let mut said = format!("opened:\n{}\n", editor.problems("hinge.urdf"));
    editor.type_over("hinge.urdf", "link=\"frame\"", "link=\"frme\"");
    let _ = writeln!(said, "\na name with a slip:\n{}", editor.problems("hinge.urdf"));
    editor.type_over("hinge.urdf", "link=\"frme\"/>", "link=\"frame\"");
    let _ = writeln!(said, "\na tag that is not closed:\n{}", editor.problems("hinge.urdf"));
    editor.type_over("hinge.urdf", "link=\"frame\"", "link=\"frame\"/>");
    editor.type_over("hinge.urdf", "<?xml", "1<?xml");
    let _ = writeln!(said, "\na letter before everything:\n{}", editor.problems("hinge.urdf"));
    editor.type_over("hinge.urdf", "1<?xml", "<?xml");
    editor.type_over("hinge.urdf", "0 0 2", "0 0 1");
    editor.type_over("hinge.urdf", "rpy=\"1.5708 0 0\"", "rpy=\"0 0 0\"");
    let _ = writeln!(said, "\nfixed:\n{}", editor.problems("hinge.urdf"));
    recorded!("problems", said);
}

#[test]
fn an_error_of_xacro_is_in_the_source_of_the_macro_with_the_calls_that_led_there() {
    let mut editor = editor();
    editor.open(XACRO);
    let mut said = format!("the robot:\n{}\nthe macro:\n{}\n", editor.problems(XACRO), editor.problems(MACRO));
    editor.open(MACRO);
    editor.type_over(MACRO, "${length / 2}", "${lenght / 2}");
    let _ = writeln!(said, "\na slip in the macro's unsaved text:\n{}", editor.problems(MACRO));
    editor.type_over(MACRO, "${lenght / 2}", "${length / 0}");
    let _ = writeln!(said, "\na division by 0:\n{}", editor.problems(MACRO));
    editor.type_over(MACRO, "${length / 0}", "${length / 2}");
    editor.type_over(XACRO, "<xacro:arm prefix=\"left_\"", "<xacro:amr prefix=\"left_\"");
    let _ = writeln!(said, "\na macro with a slip:\n{}", editor.problems(XACRO));
    recorded!("xacro_problems", said);
}

#[test]
fn a_part_alone_is_looked_at_in_the_robot_that_includes_it() {
    let mut editor = editor();
    editor.open(MACRO);
    assert!(editor.problems(MACRO).contains("D012"), "{}", editor.problems(MACRO));
    assert!(editor.hover(MACRO, "xyz=\"0 0 ${|length / 2}").contains("`0.2`, `0.25`"));
}

#[test]
fn the_text_of_an_editor_hides_the_file_also_where_it_is_included() {
    let mut editor = editor();
    editor.open(XACRO);
    assert!(editor.hover(XACRO, "name=\"|mast\"").contains("base"));
    let unsaved = std::fs::read_to_string(files().join(MACRO)).unwrap().replace("mass:=2", "mass:=7");
    editor.open_as(MACRO, &unsaved);
    assert!(
        editor.hover(XACRO, "<link name=\"|base\"/>").contains("14 kg"),
        "{}",
        editor.hover(XACRO, "<link name=\"|base\"/>")
    );
}

#[test]
fn quick_fixes_are_those_of_check() {
    let mut editor = editor();
    editor.open("hinge.urdf");
    let whole = json!({"start": {"line": 0, "character": 0}, "end": {"line": 99, "character": 0}});
    let asked = json!({"range": whole, "context": {"diagnostics": []}});
    let actions = editor.ask_of("textDocument/codeAction", "hinge.urdf", &asked).unwrap();
    let mut said = String::new();
    for action in actions.as_array().unwrap() {
        let edited = editor.edited(&action["edit"]);
        let before = editor.text("hinge.urdf");
        let lines = edited["hinge.urdf"].lines().zip(before.lines()).filter(|(after, before)| after != before);
        let lines: Vec<String> =
            lines.map(|(after, before)| format!("    {} -> {}", before.trim(), after.trim())).collect();
        let _ = writeln!(
            said,
            "{} {}\n{}",
            action["kind"].as_str().unwrap(),
            action["title"].as_str().unwrap(),
            lines.join("\n")
        );
    }
    recorded!("quick_fixes", said);
    // What the command line makes of the same file.
    let text = editor.text("hinge.urdf").to_owned();
    let lookup = |_: &str| denavit_compare::lint::Lookup::Unknown;
    let findings =
        denavit_compare::lint::check("hinge.urdf", &text, &lookup, &denavit_compare::lint::Config::default());
    let all = actions.as_array().unwrap().last().unwrap();
    assert_eq!(editor.edited(&all["edit"])["hinge.urdf"], denavit_compare::lint::fix(&text, &findings).0);
}

#[test]
fn a_fix_in_a_macro_is_made_in_its_source() {
    let mut editor = editor();
    editor.open(XACRO);
    editor.open(MACRO);
    let whole = json!({"start": {"line": 0, "character": 0}, "end": {"line": 99, "character": 0}});
    let asked = json!({"range": whole, "context": {"diagnostics": []}});
    let actions = editor.ask_of("textDocument/codeAction", MACRO, &asked).unwrap();
    let all = actions.as_array().unwrap().last().unwrap();
    let edited = editor.edited(&all["edit"]);
    assert!(edited[MACRO].contains("<axis xyz=\"0 0 1\"/>"), "{edited:?}");
}

#[test]
fn hover_says_what_is_there_in_numbers() {
    let mut editor = Editor::in_folder(&files(), &json!({"convention": "proximal"}));
    for file in ["hinge.urdf", "hinge.sdf", "hinge.xml", XACRO, MACRO, SRDF] {
        editor.open(file);
    }
    let places = [
        ("hinge.urdf", "<joint name=\"|turn\" type"),
        ("hinge.urdf", "<|joint name=\"latch\""),
        ("hinge.urdf", "<link name=\"|door\""),
        ("hinge.urdf", "<gazebo reference=\"|door\""),
        ("hinge.urdf", "rpy=\"|1.5708"),
        ("hinge.urdf", "xyz=\"0.4| 0"),
        ("hinge.urdf", "upper=\"|1.57\""),
        ("hinge.urdf", "lower=\"|-0.012"),
        ("hinge.urdf", "velocity=\"|0.1\""),
        ("hinge.urdf", "mass value=\"|12.5"),
        ("hinge.sdf", "<child>|door"),
        ("hinge.xml", "joint=\"|turn\""),
        (XACRO, "length=\"$(arg |reach)"),
        (XACRO, "${2 |* 0.25}"),
        (XACRO, "meshes/|camera.stl"),
        (XACRO, "$(find |arm_description)"),
        (XACRO, "/urdf/|arm_macro.xacro"),
        (MACRO, "${|length / 2}"),
        (MACRO, "<joint name=\"${prefix}|shoulder"),
        (SRDF, "name=\"|left_shoulder\""),
    ];
    let mut said = String::new();
    for (file, place) in places {
        let _ = writeln!(said, "{file} {place}\n{}\n", editor.hover(file, place));
    }
    recorded!("hover", said);
}

#[test]
fn definitions_and_references() {
    let mut editor = editor();
    for file in ["hinge.urdf", "hinge.sdf", "hinge.xml", XACRO, MACRO, SRDF] {
        editor.open(file);
    }
    let places = [
        ("hinge.urdf", "<parent link=\"|door\""),
        ("hinge.urdf", "<joint_name>|turn"),
        ("hinge.sdf", "<child>|door"),
        ("hinge.xml", "joint=\"|turn\""),
        (XACRO, "<xacro:|arm prefix=\"left_"),
        (XACRO, "$(arg |reach)"),
        (XACRO, "$(find |arm_description)"),
        (XACRO, "/urdf/|arm_macro.xacro"),
        (XACRO, "meshes/|camera.stl"),
        (MACRO, "0 ${|quarter}"),
        (MACRO, "${|length / 2}"),
        (MACRO, "<child link=\"${prefix}|upper\""),
        (MACRO, "<parent link=\"|${parent}\""),
        (SRDF, "base_link=\"|base\""),
        (SRDF, "<joint name=\"|left_shoulder\""),
        (SRDF, "group=\"|left\""),
    ];
    let said: String = places.iter().map(|(file, place)| editor.definition_and_references(file, place)).collect();
    recorded!("definitions", said);
}

#[test]
fn materials_have_their_definitions_and_references() {
    let mut editor = editor();
    let urdf = "<robot name=\"p\">\n<material name=\"steel\"><color rgba=\"1 1 1 1\"/></material>\n\
        <link name=\"a\"><visual><geometry><sphere radius=\"1\"/></geometry><material name=\"steel\"/></visual></link>\n\
        <link name=\"b\"><visual><geometry><sphere radius=\"2\"/></geometry><material name=\"steel\"/></visual></link>\n\
        <joint name=\"j\" type=\"fixed\"><parent link=\"a\"/><child link=\"b\"/></joint>\n</robot>\n";
    let mjcf = "<mujoco>\n<asset><material name=\"steel\"/><mesh name=\"shell\" file=\"s.stl\"/></asset>\n<worldbody>\n\
        <geom type=\"sphere\" size=\"1\" material=\"steel\"/>\n<geom type=\"mesh\" mesh=\"shell\" material=\"steel\"/>\n\
        </worldbody>\n</mujoco>\n";
    editor.open_as("painted.urdf", urdf);
    editor.open_as("painted.xml", mjcf);
    let places = [
        ("painted.urdf", "1\"/></geometry><material name=\"|steel"),
        ("painted.urdf", "<material name=\"|steel\"><color"),
        ("painted.xml", "size=\"1\" material=\"|steel"),
        ("painted.xml", "mesh=\"|shell"),
    ];
    let said: String = places.iter().map(|(file, place)| editor.definition_and_references(file, place)).collect();
    recorded!("materials", said);
    let edit = editor.ask_at("textDocument/rename", "painted.urdf", places[0].1, &json!({"newName": "brass"}));
    assert_eq!(edit.unwrap_err(), "only links and joints can be renamed, but \"steel\" names the material");
}

#[test]
fn a_rename_of_a_urdf_is_that_of_the_proved_edit() {
    let mut editor = editor();
    editor.open("hinge.urdf");
    for (place, old, new) in
        [("<joint name=\"|turn\" type", "turn", "swing"), ("<child link=\"|door\"", "door", "leaf")]
    {
        let edit = editor.ask_at("textDocument/rename", "hinge.urdf", place, &json!({"newName": new})).unwrap();
        let edited = editor.edited(&edit);
        let names = vec![Renaming { kind: None, old: old.into(), new: new.into() }];
        let files = Files::urdf("hinge.urdf", editor.text("hinge.urdf"));
        let proved = denavit_edit::apply(&files, &[Operation::Rename { names }]).unwrap();
        assert_eq!(edited["hinge.urdf"], proved.files.urdf.text);
    }
    let taken =
        editor.ask_at("textDocument/rename", "hinge.urdf", "<child link=\"|door\"", &json!({"newName": "knob"}));
    assert_eq!(taken.unwrap_err(), "hinge: a link already has the name \"knob\"");
}

/// Lines that differ from the files on the disk.
fn changed_lines(edited: &std::collections::BTreeMap<String, String>) -> String {
    let mut said = String::new();
    for (file, text) in edited {
        let before = std::fs::read_to_string(files().join(file)).unwrap();
        let _ = writeln!(said, "{file}");
        for (after, before) in text.lines().zip(before.lines()).filter(|(after, before)| after != before) {
            let _ = writeln!(said, "    {} -> {}", before.trim(), after.trim());
        }
    }
    said
}

#[test]
fn a_rename_goes_through_xacro_and_srdf_and_stops_at_an_expression() {
    let mut editor = editor();
    editor.open(XACRO);
    let edit =
        editor.ask_at("textDocument/rename", XACRO, "<child link=\"|camera\"", &json!({"newName": "eye"})).unwrap();
    let mut said = changed_lines(&editor.edited(&edit));
    // The macro is given this name: the calls change, the macro stays.
    let edit =
        editor.ask_at("textDocument/rename", XACRO, "<link name=\"|base\"", &json!({"newName": "torso"})).unwrap();
    let _ = writeln!(said, "what calls pass on:\n{}", changed_lines(&editor.edited(&edit)));
    let range = editor.ask_at("textDocument/prepareRename", XACRO, "<child link=\"|camera\"", &Value::Null).unwrap();
    let _ = writeln!(said, "prepared: {}", serde_json::to_string(&range).unwrap());
    editor.open(MACRO);
    editor.open(SRDF);
    for (file, place) in [
        (MACRO, "<child link=\"${prefix}|upper"),
        (SRDF, "<joint name=\"|left_shoulder"),
        (XACRO, "name=\"|reach\""),
        (XACRO, "|<link name=\"base\""),
    ] {
        let refused = editor.ask_at("textDocument/rename", file, place, &json!({"newName": "other"})).unwrap_err();
        let _ = writeln!(said, "{file} {place}\n    {}", editor.shown(&refused));
    }
    editor.type_over(MACRO, "<link name=\"${prefix}upper\">", "<link name=\"${prefix}on_${parent}\"/><joint name=\"${prefix}f\" type=\"fixed\"><parent link=\"${parent}\"/><child link=\"${prefix}on_${parent}\"/></joint><link name=\"${prefix}upper\">");
    let refused =
        editor.ask_at("textDocument/rename", XACRO, "<link name=\"|base\"", &json!({"newName": "torso"})).unwrap_err();
    let _ = writeln!(said, "a parameter of which another name is made:\n    {}", editor.shown(&refused));
    recorded!("rename", said);
}

#[test]
fn completion_offers_what_may_stand_there() {
    let mut editor = editor();
    editor.open("hinge.urdf");
    editor.type_over("hinge.urdf", "  <link name=\"knob\"/>", "  <link name=\"knob\"/>\n  <joint name=\"n\" type=\"\">\n    <par\n    <child link=\"\"/>\n    <limit />\n  </joint>\n  <link name=\"m\"><visual><geometry><mesh filename=\"arm_description/\"/></geometry></visual></link>");
    editor.open(XACRO);
    assert_eq!(editor.problems(XACRO), "");
    editor.type_over(XACRO, "<gazebo reference=\"camera\"/>", "<gazebo reference=\"\"/>\n  <xacro:arm />\n  <xa\n  <frame name=\"${q}\" other=\"$(find )\" more=\"$(arg )\"/>\n  <mesh filename=\"package://\"/>\n  <mesh filename=\"package://arm_description/meshes/\"/>");
    editor.open(SRDF);
    editor.type_over(SRDF, "tip_link=\"left_uper\"", "tip_link=\"\" ");
    editor.open("hinge.sdf");
    let door = "<pose>0.1 0 0 0 0 1.5708</pose>";
    editor.type_over("hinge.sdf", door, &format!("{door}<gravity></gravity><pose />\n      <pose relative_to=\"\"/>"));
    editor.type_over("hinge.sdf", "      <axis>", "      <ax\n      <axis>");
    editor.open("hinge.xml");
    editor.type_over(
        "hinge.xml",
        "  <worldbody>",
        "  <default><default class=\"visual\"/></default><asset><material name=\"steel\"/></asset>\n  <worldbody>",
    );
    editor.type_over(
        "hinge.xml",
        "        <geom",
        "        <ge\n        <freejoint /><geom class=\"\" material=\"\"/>\n        <geom",
    );
    let places = [
        ("hinge.urdf", "<joint name=\"n\" type=\"|\""),
        ("hinge.urdf", "    <par|\n"),
        ("hinge.urdf", "<child link=\"|\"/>"),
        ("hinge.urdf", "<limit |/>"),
        ("hinge.urdf", "filename=\"arm_description/|\""),
        ("hinge.urdf", "<joint_name>|turn"),
        (XACRO, "<gazebo reference=\"|\""),
        (XACRO, "<xacro:arm |/>"),
        (XACRO, "  <xa|\n"),
        (XACRO, "${q|}"),
        (XACRO, "$(find |)\" more"),
        (XACRO, "$(arg |)\"/>\n  <mesh"),
        (XACRO, "package://|\""),
        (XACRO, "package://arm_description/meshes/|\""),
        (SRDF, "tip_link=\"|\""),
        (SRDF, "reason=\"|Never"),
        ("hinge.sdf", "<joint name=\"turn\" type=\"|revolute"),
        ("hinge.sdf", "      <ax|\n"),
        ("hinge.sdf", "<gravity>|"),
        ("hinge.sdf", "<pose |/>"),
        ("hinge.sdf", "relative_to=\"|\""),
        ("hinge.sdf", "<parent>|frame"),
        ("hinge.xml", "<joint name=\"turn\" type=\"|hinge"),
        ("hinge.xml", "        <ge|\n"),
        ("hinge.xml", "<freejoint |/>"),
        ("hinge.xml", "joint=\"|turn\""),
        ("hinge.xml", "class=\"|\""),
        ("hinge.xml", "material=\"|\""),
    ];
    let mut said = String::new();
    for (file, place) in places {
        let items = editor.ask_at("textDocument/completion", file, place, &Value::Null).unwrap();
        let labels: Vec<&str> = items.as_array().unwrap().iter().map(|item| item["label"].as_str().unwrap()).collect();
        let _ = writeln!(said, "{file} {}\n    {}\n", place.trim(), labels.join(" "));
    }
    recorded!("completion", said);
}

fn outline(symbols: &Value, depth: usize, said: &mut String) {
    for symbol in symbols.as_array().into_iter().flatten() {
        let line = symbol["range"]["start"]["line"].as_u64().unwrap() + 1;
        let _ = writeln!(
            said,
            "{}{} ({}) line {line}",
            "  ".repeat(depth),
            symbol["name"].as_str().unwrap(),
            symbol["detail"].as_str().unwrap()
        );
        outline(&symbol["children"], depth + 1, said);
    }
}

#[test]
fn the_outline_is_the_tree_of_links_and_of_other_files_their_elements() {
    let mut editor = editor();
    let mut said = String::new();
    for file in ["hinge.urdf", "hinge.sdf", "hinge.xml", XACRO, MACRO, SRDF] {
        editor.open(file);
        let symbols = editor.ask_of("textDocument/documentSymbol", file, &Value::Null).unwrap();
        let _ = writeln!(said, "{file}");
        outline(&symbols, 1, &mut said);
    }
    recorded!("outline", said);
}

#[test]
fn elements_fold_and_formatting_changes_white_space_only() {
    let mut editor = editor();
    let options = json!({"options": {"tabSize": 2, "insertSpaces": true}});
    let mut said = String::new();
    for file in ["hinge.urdf", "hinge.sdf", "hinge.xml"] {
        editor.open(file);
        let folds = editor.ask_of("textDocument/foldingRange", file, &Value::Null).unwrap();
        let line = |fold: &Value, end: &str| fold[end].as_u64().unwrap() + 1;
        let folds = folds.as_array().unwrap();
        let folds: Vec<String> =
            folds.iter().map(|fold| format!("{}-{}", line(fold, "startLine"), line(fold, "endLine"))).collect();
        let _ = writeln!(said, "{file}: {}", folds.join(" "));
        let edits = editor.ask_of("textDocument/formatting", file, &options).unwrap();
        assert_eq!(edits, json!([]), "{file} is as it should be");
        let text = editor.text(file).to_owned();
        let crooked = text.replace("\n    <", "\n <").replace("    <joint name", "\t<joint  name");
        editor.open_as(file, &crooked);
        let edits = editor.ask_of("textDocument/formatting", file, &options).unwrap();
        assert_eq!(with_edits(&crooked, &edits), text, "{file}");
        editor.open_as(file, &text);
    }
    recorded!("folding", said);
    let text = editor.text("hinge.urdf").to_owned();
    editor.type_over("hinge.urdf", "  <link name=\"frame\"/>\n", "<link   name = \"frame\" />");
    editor.type_over("hinge.urdf", "    <inertial>\n", "\t<inertial>");
    let edits = editor.ask_of("textDocument/formatting", "hinge.urdf", &options).unwrap();
    assert_eq!(with_edits(editor.text("hinge.urdf"), &edits), text);
    editor.type_over("hinge.urdf", "</robot>", "");
    let refused = editor.ask_of("textDocument/formatting", "hinge.urdf", &options).unwrap_err();
    assert_eq!(refused, "the file is not well-formed XML; correct it first");
}

#[test]
fn the_lens_says_how_far_the_tip_moves_against_the_last_commit() {
    let folder = tempfile::tempdir().unwrap();
    let git = |arguments: &[&str]| {
        let run = std::process::Command::new("git").arg("-C").arg(folder.path()).args(arguments).output();
        run.is_ok_and(|run| run.status.success())
    };
    std::fs::copy(files().join("hinge.urdf"), folder.path().join("hinge.urdf")).unwrap();
    let name = ["-c", "user.name=n", "-c", "user.email=e@example.org"];
    let commit = [&name[..], &["commit", "-q", "-m", "first"]].concat();
    if !git(&["init", "-q"]) || !git(&["add", "."]) || !git(&commit) {
        println!("skipped, because git does not commit here");
        return;
    }
    let mut editor = Editor::in_folder(folder.path(), &Value::Null);
    editor.open("hinge.urdf");
    let title = |editor: &mut Editor| {
        let lenses = editor.ask_of("textDocument/codeLens", "hinge.urdf", &Value::Null).unwrap();
        let resolved = editor.ask("codeLens/resolve", lenses[0].clone()).unwrap();
        resolved["command"]["title"].as_str().unwrap().to_owned()
    };
    assert_eq!(title(&mut editor), "RP, frame → knob, same as HEAD");
    editor.type_over("hinge.urdf", "xyz=\"0.75 0 0\"", "xyz=\"0.75061 0 0\"");
    // 0.61 mm along x: the bound of a shift of a joint's origin is its length.
    assert_eq!(title(&mut editor), "RP, frame → knob, tip moved by at most 0.61 mm since HEAD");
    let uri = editor.uri("hinge.urdf");
    let run = |editor: &mut Editor, command: &str| {
        let words = editor.ask("workspace/executeCommand", json!({"command": command, "arguments": [uri]})).unwrap();
        words.as_str().unwrap().to_owned()
    };
    let table = run(&mut editor, "denavit.server.table");
    assert!(table.contains("turn") && table.contains("latch"), "{table}");
    let compared = run(&mut editor, "denavit.server.compareWithHead");
    assert!(compared.contains("latch") && compared.contains("610 µm"), "{compared}");
    assert_eq!(editor.messages().len(), 2, "an editor without commands of its own is shown the results");
}

#[test]
fn the_link_under_the_cursor_is_known() {
    let mut editor = editor();
    editor.open("hinge.urdf");
    editor.open(MACRO);
    let places = [
        ("hinge.urdf", "<mass value=\"|12.5", json!("door")),
        ("hinge.urdf", "<axis xyz=\"|1 0 0", json!("knob")),
        ("hinge.urdf", "<gazebo reference=\"|door", json!("door")),
        ("hinge.urdf", "<|robot", Value::Null),
        (MACRO, "<axis |xyz", json!("left_upper")),
    ];
    for (file, place, expected) in places {
        assert_eq!(editor.ask_at("denavit/linkAt", file, place, &Value::Null).unwrap(), expected, "{place}");
    }
}

#[test]
fn what_is_not_known_or_wrong_is_said() {
    let mut editor = Editor::in_folder(&files(), &json!({"convention": "craig"}));
    assert!(editor.messages()[0].contains("write distal, proximal, paper or hayati"));
    assert_eq!(editor.ask("textDocument/nonsense", json!({})).unwrap_err(), "textDocument/nonsense is not supported");
    editor.tell(
        "workspace/didChangeConfiguration",
        json!({"settings": {"denavit": {"xacroArguments": {"*": "reach:=1"}}}}),
    );
    editor.open(XACRO);
    assert!(editor.hover(XACRO, "$(arg |reach)").contains("`1`"));
}
