//! The program from the user's side: arguments, messages, exit codes, files.

use crate::support::{denavit, denavit_with_input, robot};

fn number_after(text: &str, key: &str) -> f64 {
    let json: serde_json::Value = serde_json::from_str(text).unwrap();
    json[key].as_f64().unwrap()
}

#[test]
fn a_table_written_and_read_back_moves_alike() {
    let folder = tempfile::tempdir().unwrap();
    let source = robot("franka/panda.urdf");
    let q = "0.1,-0.2,0.3,-0.4,0.5,0.6,-0.7";
    let pose = |file: &str, extra: &[&str]| {
        let mut arguments = vec!["fk", file, "--json", "--q", q];
        arguments.extend(extra);
        let json: serde_json::Value = serde_json::from_str(&denavit(&arguments).succeeded()).unwrap();
        json["pose"].to_string()
    };
    let numbers = |text: &str| -> Vec<f64> {
        text.split(|c: char| "[],".contains(c)).filter_map(|word| word.parse().ok()).collect()
    };
    let expected = numbers(&pose(&source, &["--tip", "panda_link8"]));
    for format in ["csv", "json"] {
        for convention in ["distal", "proximal", "paper", "hayati"] {
            let path = folder.path().join(format!("table.{format}"));
            let file = path.to_str().unwrap();
            let table =
                ["table", &source, "--tip", "panda_link8", "--format", format, "--convention", convention, "-o", file];
            assert_eq!(denavit(&table).succeeded(), "");
            for (found, expected) in numbers(&pose(file, &[])).iter().zip(&expected) {
                assert!((found - expected).abs() < 1e-14, "{format} {convention}: {found} {expected}");
            }
        }
    }
}

#[test]
fn standard_input_is_a_source() {
    let text = std::fs::read_to_string(robot("universal_robots/ur5e.urdf")).unwrap();
    let from_input = denavit_with_input(&["table", "-"], &text).succeeded();
    assert_eq!(from_input, denavit(&["table", &robot("universal_robots/ur5e.urdf")]).succeeded());
    let csv = denavit(&["table", &robot("universal_robots/ur5e.urdf"), "--format", "csv"]).succeeded();
    assert!(denavit_with_input(&["table", "-"], &csv).succeeded().contains("0.1625"));
}

#[test]
fn the_papers_table_i_is_a_source() {
    let json = denavit(&[
        "table",
        &robot("unimation/puma560_actual_poe.csv"),
        "--gauge",
        "paper",
        "--exact",
        "--format",
        "json",
    ]);
    let table: serde_json::Value = serde_json::from_str(&json.succeeded()).unwrap();
    assert_eq!(table["joints"][2]["kind"], "helical");
    let d = table["rows"][2]["d"].as_f64().unwrap();
    assert!((d + 0.5676553729601925).abs() < 1e-12, "{d}");
}

#[test]
fn messages_name_the_error_and_the_fix() {
    let ur5e = robot("universal_robots/ur5e.urdf");
    let check = |arguments: &[&str], expected: &str| {
        let message = denavit(arguments).failed().replace(&ur5e, "ur5e.urdf");
        assert_eq!(message.trim_end(), expected);
    };
    check(&["table", "missing.urdf"], "error: missing.urdf: cannot be read: No such file or directory (os error 2)");
    check(
        &["table", &ur5e, "--tip", "tool1"],
        "error: ur5e.urdf: the robot has no link \"tool1\"; did you mean \"tool0\"?",
    );
    check(
        &["fk", &ur5e, "--q", "1,2"],
        "error: --q: 2 values for 6 joints; the order is shoulder_pan_joint, shoulder_lift_joint, elbow_joint, \
         wrist_1_joint, wrist_2_joint, wrist_3_joint",
    );
    check(
        &["fk", &ur5e, "--q", "elbow=1"],
        "error: --q: the chain has no joint \"elbow\"; the joints are shoulder_pan_joint, shoulder_lift_joint, elbow_joint, wrist_1_joint, wrist_2_joint, wrist_3_joint",
    );
    check(&["fk", &ur5e, "--q", "0,0,0,0,0,x"], "error: --q: \"x\" is not a finite number");
    check(
        &["table", &ur5e, "--units", "inch"],
        "error: --units: \"inch\" is not a unit of text; write m or mm, and deg or rad",
    );
}

#[test]
fn bad_files_get_one_clear_message() {
    let link =
        |names: &[&str]| names.iter().map(|name| format!("<link name=\"{name}\"/>")).collect::<Vec<_>>().concat();
    let joint = |body: &str| format!("<joint name=\"j\" type=\"revolute\">{body}</joint>");
    let ends = "<parent link=\"a\"/><child link=\"b\"/>";
    for (body, expected) in [
        (
            String::new(),
            "robot \"r\": the robot has no <link>; was a xacro file expanded without its macro being called?",
        ),
        (link(&["a", "a"]), "link \"a\": the name is already taken in line 1; rename one of the two"),
        (
            link(&["a", "b"]),
            "link \"b\": the robot has 2 root links: \"a\", \"b\"; join them by a fixed joint, or remove what is not used",
        ),
        (
            link(&["a", "b"]) + &joint("<parent link=\"a\"/>"),
            "joint \"j\": <child link=\"…\"/> is missing; name the link",
        ),
        (
            link(&["base", "b"]) + &joint("<parent link=\"bsae\"/><child link=\"b\"/>"),
            "joint \"j\": parent link \"bsae\" does not exist; did you mean \"base\"?",
        ),
        (
            link(&["a", "b"]) + &joint(&format!("{ends}<axis xyz=\"0 0 0\"/>")),
            "joint \"j\": axis xyz=\"0 0 0\" has length zero; give the direction that the joint moves along or about",
        ),
        (
            link(&["a", "b"]) + &joint(&format!("{ends}<origin xyz=\"0 nan 0\"/>")),
            "joint \"j\": <origin xyz=\"0 nan 0\">: \"nan\" is not a finite number",
        ),
        (
            link(&["a", "b"]) + &joint(&format!("{ends}<origin xyz=\"0 0\"/>")),
            "joint \"j\": <origin xyz=\"0 0\"> has 2 numbers instead of 3",
        ),
        (
            link(&["a", "b"])
                + &joint(ends)
                + "<joint name=\"k\" type=\"fixed\"><parent link=\"b\"/><child link=\"a\"/></joint>",
            "link \"a\": the joints close a loop through links \"a\", \"b\"; a URDF is a tree, so cut the loop at one joint",
        ),
    ] {
        let message = denavit_with_input(&["table", "-"], &format!("<robot name=\"r\">{body}</robot>")).failed();
        assert_eq!(message.trim_end(), format!("error: <stdin>:1: {expected}"));
    }
    assert!(denavit_with_input(&["table", "-"], "").failed().contains("the file is empty"));
    assert!(
        denavit_with_input(&["table", "-"], "<robot>")
            .failed()
            .starts_with("error: <stdin>:1: file: not well-formed XML")
    );
    assert!(
        denavit_with_input(&["table", "-"], "row,theta\n1,2")
            .failed()
            .contains("nor a table with columns theta, d, alpha, a")
    );
}

#[test]
fn what_is_surely_meant_is_read_with_a_note() {
    let robot = "\u{feff}\n <?xml version=\"1.0\"?><robot name=\"r\"><link name=\"a\"/><link name=\"b\"/><gz:plugin/>\
        <joint name=\"j\" type=\"prismatic\"><parent link=\"a\"/><child link=\"b\"/><origin xyz=\"0,0,1\"/></joint></robot>";
    let text = denavit_with_input(&["table", "-"], robot).succeeded();
    assert!(text.contains("white space before the XML declaration is skipped"), "{text}");
    assert!(text.contains("namespace prefix gz is not declared"), "{text}");
    assert!(text.contains("has commas; read as three numbers"), "{text}");
}

#[test]
fn a_failing_run_leaves_the_old_file_as_it_was() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("table.md");
    std::fs::write(&path, "old").unwrap();
    denavit(&["table", "missing.urdf", "--format", "md", "-o", path.to_str().unwrap()]).failed();
    assert_eq!(std::fs::read_to_string(&path).unwrap(), "old");
    let nowhere = folder.path().join("nowhere/table.md");
    let message = denavit(&["table", &robot("universal_robots/ur5e.urdf"), "-o", nowhere.to_str().unwrap()]).failed();
    assert!(message.contains("cannot be written") && message.contains("nothing was changed"), "{message}");
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
}

#[test]
fn intended_angles_are_listed_and_can_be_switched_off() {
    let urdf = r#"<robot name="r"><link name="a"/><link name="b"/><link name="c"/>
        <joint name="j" type="revolute"><origin xyz="0 0 1" rpy="1.57 0 0"/><axis xyz="0 0 1"/><parent link="a"/><child link="b"/><limit lower="-1" upper="1"/></joint>
        <joint name="k" type="revolute"><origin xyz="0.5 0 0" rpy="-1.57 0 0"/><axis xyz="0 0 1"/><parent link="b"/><child link="c"/></joint></robot>"#;
    let text = denavit_with_input(&["table", "-"], urdf).succeeded();
    assert!(text.contains("<stdin>:2: joint \"j\": 1.57 read as π/2; the tip moves by at most 398.2 µm"), "{text}");
    let json = denavit_with_input(&["table", "-", "--format", "json"], urdf).succeeded();
    let bound = number_after(&json, "tip_moves_at_most");
    assert!((bound - 0.5 * (std::f64::consts::FRAC_PI_2 - 1.57)).abs() < 1e-12, "{bound}");
    let exact = denavit_with_input(&["table", "-", "--exact"], urdf).succeeded();
    assert!(!exact.contains("read as"), "{exact}");
}

#[test]
fn a_robot_that_is_not_the_vendors_is_distinguished_by_row_and_number() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("other.csv");
    let text = std::fs::read_to_string(robot("unimation/puma560_dh.csv")).unwrap();
    assert!(text.contains("0.0203"));
    std::fs::write(&path, text.replace("0.0203", "-0.0203")).unwrap();
    let run = denavit(&["table", &robot("unimation/puma560.urdf"), "--match", path.to_str().unwrap()]);
    assert_eq!(run.code, 1);
    assert!(run.stdout.contains("mismatch") && run.stdout.contains("row 3: a is -0.0203 m"), "{}", run.stdout);
}

#[test]
fn every_table_of_the_project_matches_its_robot() {
    for table in crate::support::files(&crate::support::top().join("robots"), "csv") {
        let name = table.to_str().unwrap().to_owned();
        let Some(stem) = name.strip_suffix("_dh.csv") else {
            continue;
        };
        let urdf = format!("{stem}.urdf");
        if !std::path::Path::new(&urdf).is_file() {
            continue;
        }
        let tips: &[&str] = if stem.ends_with("panda") { &["--tip", "panda_link8"] } else { &[] };
        let mut arguments = vec!["table", &urdf, "--match", &name];
        arguments.extend(tips);
        assert!(denavit(&arguments).succeeded().contains("Every number is printed as"), "{name}");
    }
}

#[test]
fn a_kinematics_file_makes_ur_description_the_robot_that_it_is_of() {
    let Some(vendor) = crate::support::vendor() else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let (file, ur5e) = (folder.path().join("ur.yaml"), robot("universal_robots/ur5e.urdf"));
    let file = file.to_str().unwrap();
    denavit(&["table", &ur5e, "--format", "ur", "-o", file]).succeeded();
    let xacro = vendor.join("xacro/packages/ur_description/urdf/ur.urdf.xacro");
    let parameters = format!("kinematics_params:={file}");
    let xacro = [xacro.to_str().unwrap(), "name:=ur", "ur_type:=ur5e", &parameters, "--allow-any-file"];
    let tip = |arguments: &[&str]| -> Vec<f64> {
        let q = ["--exact", "--json", "--q", "0.1,-0.7,0.9,0.4,-0.5,0.6"];
        let all: Vec<&str> = ["fk"].iter().chain(arguments).chain(&q).copied().collect();
        let json: serde_json::Value = serde_json::from_str(&denavit(&all).succeeded()).unwrap();
        json["xyz"].as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect()
    };
    let mut expanded = xacro.to_vec();
    expanded.extend(["--base", "base_link_inertia", "--tip", "tool0"]);
    for (found, expected) in tip(&expanded).iter().zip(tip(&[&ur5e])) {
        assert!((found - expected).abs() < 1e-9, "{found} {expected}");
    }
}
