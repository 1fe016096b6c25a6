//! What `check` finds, what it knows already, and robots of a revision in git.

use super::Trial;
use crate::support::{self, Run};
use serde_json::Value;
use std::process::Command;

/// An arm of one revolute joint, with something in the joint and something beside it.
fn arm(joint: &str, beside: &str) -> String {
    format!(
        "<robot name=\"arm\">\n<link name=\"base\"/>\n<link name=\"a\"/>\n<joint name=\"j1\" type=\"revolute\">\n\
         <parent link=\"base\"/>\n<child link=\"a\"/>\n{joint}\n</joint>\n{beside}\n</robot>\n"
    )
}

const LIMIT: &str = "<axis xyz=\"0 0 1\"/><limit lower=\"-1\" upper=\"1\" effort=\"1\" velocity=\"1\"/>";

/// The findings of a rule in a file of this text, a line each.
fn found(rule: &str, text: &str) -> Vec<String> {
    let trial = Trial::new().with("r.urdf", text);
    let run = trial.run("check r.urdf");
    assert!(run.code < 2, "{}", run.stderr);
    run.stdout.lines().filter(|line| line.contains(&format!(" {rule} "))).map(str::to_owned).collect()
}

fn check(rule: &str, text: &str, expected: &[&str]) {
    let lines = found(rule, text);
    assert_eq!(lines.len(), expected.len(), "{rule}: {lines:?}\n{text}");
    for (line, words) in lines.iter().zip(expected) {
        assert!(line.contains(words), "{rule}: {line}\nhas no {words}");
    }
}

#[test]
fn names_of_links_and_joints_that_do_not_exist_are_found_everywhere() {
    let dangling = |beside: &str, expected: &[&str]| check("D042", &arm(LIMIT, beside), expected);
    dangling(
        "<transmission name=\"t\"><joint name=\"j11\"/></transmission>",
        &["transmission \"t\": joint \"j11\" does not exist; did you mean \"j1\"?"],
    );
    dangling("<transmission name=\"t\"><joint name=\"j1\"/></transmission>", &[]);
    dangling(
        "<ros2_control name=\"s\" type=\"system\"><joint name=\"bb\"/><sensor name=\"f\"/><gpio name=\"g\"/></ros2_control>",
        &["ros2_control \"s\": joint \"bb\" does not exist"],
    );
    dangling(
        "<ros2_control name=\"s\"><joint name=\"j1\"><param name=\"mimic\">x</param><param name=\"k\">9</param></joint></ros2_control>",
        &["joint \"x\" does not exist"],
    );
    dangling(
        "<gazebo reference=\"nolink\"/><gazebo reference=\"a\"/><gazebo reference=\"j1\"/><gazebo><plugin name=\"p\"/></gazebo>",
        &["gazebo of \"nolink\": link or joint \"nolink\" does not exist"],
    );
    dangling(
        "<gazebo><plugin name=\"p\"><joint_name>wheel</joint_name><topic>wheel</topic></plugin></gazebo>",
        &["joint \"wheel\" does not exist"],
    );
    dangling(
        "<loop_joint name=\"l\"><link1 link=\"a\"/><link2 link=\"b\"/></loop_joint>",
        &["loop_joint \"l\": link \"b\" does not exist"],
    );
    dangling(
        "<constraint name=\"c\"><parent link=\"a\"/><child link=\"c\"/></constraint>",
        &["constraint \"c\": link \"c\" does not exist"],
    );
    dangling("<transmission name=\"t\"><joint name=\"a\"/></transmission>", &["a link has that name"]);
}

#[test]
fn degrees_are_found_and_large_radians_are_not() {
    let joint = |inner: &str, expected: &[&str]| check("D017", &arm(inner, ""), expected);
    let limit = |lower: &str, upper: &str, velocity: &str| {
        format!(
            "<axis xyz=\"0 0 1\"/><limit lower=\"{lower}\" upper=\"{upper}\" effort=\"1\" velocity=\"{velocity}\"/>"
        )
    };
    joint(&limit("-180", "180", "90"), &["lower -180 and upper 180 look like degrees; write -3.14159"]);
    joint(&limit("-170", "170", "2"), &["lower -170"]);
    joint(&limit("0", "45", "1"), &["upper 45"]);
    joint(&limit("-3.1", "3.1", "180"), &["velocity 180 is a round number of degrees per second"]);
    for (lower, upper, velocity) in [
        ("-6.2832", "6.2832", "3"),
        ("-9.42", "9.42", "20"),
        ("-10", "10", "100"),
        ("-12.5", "12.5", "2"),
        ("-1e16", "1e16", "1000"),
        ("-1", "1", "40"),
    ] {
        joint(&limit(lower, upper, velocity), &[]);
    }
    joint(
        &format!("<origin rpy=\"0 -90 180\"/>{LIMIT}"),
        &["rpy uses radians: 0 -90 180 looks like degrees; write 0 -1.5707963267948966 3.141592653589793"],
    );
    joint(&format!("<origin rpy=\"0 0 22.5\"/>{LIMIT}"), &["22.5"]);
    joint(&format!("<origin rpy=\"0 6.283185307 12.566370614359172\"/>{LIMIT}"), &[]);
    joint(&format!("<origin xyz=\"90 0 0\" rpy=\"0 0 3\"/>{LIMIT}"), &[]);
    joint(
        &format!("<safety_controller soft_lower_limit=\"-90\" soft_upper_limit=\"90\" k_velocity=\"1\"/>{LIMIT}"),
        &["soft limits -90 and 90"],
    );
    let visual =
        "<link name=\"a\"><visual><origin rpy=\"90 0 0\"/><geometry><sphere radius=\"1\"/></geometry></visual></link>";
    check("D017", &arm(LIMIT, "").replace("<link name=\"a\"/>", visual), &["link \"a\": rpy uses radians"]);
    check("D017", &arm(LIMIT, "<gazebo><pose>0 0 0 90 0 0</pose></gazebo>"), &["pose uses radians"]);
    check("D017", &arm(LIMIT, "<gazebo><pose degrees=\"true\">0 0 0 90 0 0</pose></gazebo>"), &[]);
    // A slide of 90 m is no angle.
    let slide = arm(&limit("-90", "90", "180"), "").replace("revolute", "prismatic");
    check("D017", &slide, &[]);
}

#[test]
fn limits_that_were_rounded_up_beyond_half_a_turn_are_found_and_fixed() {
    let limit = |lower: &str, upper: &str| {
        arm(
            &format!("<axis xyz=\"0 0 1\"/><limit lower=\"{lower}\" upper=\"{upper}\" effort=\"1\" velocity=\"1\"/>"),
            "",
        )
    };
    check("D010", &limit("-3.1416", "3.1416"), &["lower -3.1416 is -π, upper 3.1416 is π, 7.3e-6 rad beyond it"]);
    check("D010", &limit("-3.14", "6.2832"), &["upper 6.2832 is 2π"]);
    check("D010", &limit("-3.14159", "3.1415"), &[]);
    check("D010", &limit("-3.2", "3.15"), &[]);
    let trial = Trial::new().with("r.urdf", &limit("-3.1416", "3.1416"));
    trial.run("check --fix r.urdf").succeeded();
    assert!(trial.text("r.urdf").contains("lower=\"-3.141592653589793\" upper=\"3.141592653589793\""));
}

#[test]
fn what_a_drawing_program_left_in_axes_and_pitches_is_found_and_fixed() {
    let joint = |inner: &str| arm(&format!("{inner}<limit lower=\"-1\" upper=\"1\" effort=\"1\" velocity=\"1\"/>"), "");
    for (inner, said, written) in [
        ("<axis xyz=\"2.2e-08 -4.4e-08 -1.0\"/>", "is 0 0 -1", "xyz=\"0 0 -1\""),
        ("<axis xyz=\"-1.96e-6 2.3e-6 1.0\"/>", "is 0 0 1", "xyz=\"0 0 1\""),
        ("<axis xyz=\"1.6e-08 0.9659258 0.2588190\"/>", "is 0 cos 15° sin 15°", "xyz=\"0 0.965925826"),
        (
            "<origin rpy=\"0 -1.5707927 0\"/><axis xyz=\"0 0 1\"/>",
            "the pitch -1.5707927 is -π/2",
            "rpy=\"0 -1.5707963267948966 0\"",
        ),
    ] {
        check("D018", &joint(inner), &[said]);
        let trial = Trial::new().with("r.urdf", &joint(inner));
        trial.run("check --fix r.urdf").succeeded();
        assert!(trial.text("r.urdf").contains(written), "{}", trial.text("r.urdf"));
        check("D018", &trial.text("r.urdf"), &[]);
    }
    // Calibrated.
    for inner in ["<axis xyz=\"0.0012 0 0.9999993\"/>", "<origin rpy=\"0 -1.57079271234 0\"/><axis xyz=\"0 0 1\"/>"] {
        check("D018", &joint(inner), &[]);
    }
}

#[test]
fn what_is_not_understood_not_in_force_or_not_solved_is_said() {
    check(
        "D009",
        &arm(&format!("<origin xyz=\"0 0 1\" rpi=\"1 0 0\"/>{LIMIT}"), ""),
        &["r.urdf:7: warning D009 joint \"j1\": attribute rpi=\"1 0 0\" of <origin> is not understood"],
    );
    check("D009", &arm(&format!("<orgin xyz=\"0 0 1\"/>{LIMIT}"), ""), &["<orgin> in <joint> is not understood"]);
    check("D009", &arm(LIMIT, "<gazebo reference=\"a\"><mu1>0.2</mu1></gazebo>"), &[]);
    check(
        "D025",
        &arm(LIMIT, "").replace("revolute", "continuous"),
        &["it is continuous, so its limits -1 and 1 are not in force"],
    );
    check(
        "D025",
        &arm("<limit lower=\"0\" upper=\"0\" effort=\"1\" velocity=\"1\"/>", "").replace("revolute", "continuous"),
        &[],
    );
    check(
        "D090",
        &arm(LIMIT, "<constraint name=\"c\"><parent link=\"base\"/><child link=\"a\"/></constraint>"),
        &["constraint \"c\": closes a loop between \"base\" and \"a\""],
    );
    check("D091", &arm(&format!("{LIMIT}<calibration rising=\"-0.5\"/>"), ""), &["<calibration>: rising -0.5 is kept"]);
    check(
        "D009",
        &arm(
            &format!("{LIMIT}<calibration rising=\"-0.5\"/>"),
            "<loop_joint name=\"l\"><link1 link=\"a\"/></loop_joint>",
        ),
        &[],
    );
}

#[test]
fn the_account_of_a_file_is_shown_in_every_format() {
    let trial =
        Trial::new().with("r.urdf", &arm(&format!("<origin rpi=\"0 0 0\"/>{LIMIT}"), "<gazebo reference=\"a\"/>"));
    let text = trial.run("check r.urdf").succeeded();
    assert!(text.contains("understood, 1 kept unchanged (1 <gazebo>), 1 not understood\n1 file(s)"), "{text}");
    let json: Value = serde_json::from_str(&trial.run("check r.urdf --json").succeeded()).unwrap();
    let account = &json["inventory"][0];
    assert!(account["understood"].as_u64().unwrap() > 10, "{account}");
    assert_eq!((&account["carried"][0]["what"], &account["carried"][0]["line"]), (&"<gazebo>".into(), &9.into()));
    assert_eq!(account["not_understood"][0]["what"], "attribute rpi=\"0 0 0\" of <origin>");
    let sarif: Value = serde_json::from_str(&trial.run("check r.urdf --format sarif").succeeded()).unwrap();
    assert_eq!(sarif["runs"][0]["properties"]["inventory"][0]["notUnderstood"], 1);
}

#[test]
fn a_file_that_cannot_be_read_keeps_nobody_from_the_findings_of_the_others() {
    let trial = Trial::new().with("r.urdf", &arm(&format!("<origin rpi=\"0 0 0\"/>{LIMIT}"), ""));
    let broken = "<robot xmlns:xacro=\"http://ros.org/wiki/xacro\" name=\"r\"><xacro:nowhere/></robot>";
    std::fs::write(trial.path("b.urdf.xacro"), broken).unwrap();
    for files in ["b.urdf.xacro r.urdf", "r.urdf not_there.urdf"] {
        let run = trial.run(&format!("check {files}"));
        assert_eq!(run.code, 2, "{files}: {}", run.stderr);
        assert!(run.stdout.contains("rpi"), "{files}: {}", run.stdout);
        assert!(run.stderr.contains("files could not be read; the others are checked"), "{files}: {}", run.stderr);
    }
    trial.refuses("check b.urdf.xacro", "there is no macro");
}

#[test]
fn with_a_baseline_only_what_is_new_fails() {
    let bad = arm("<limit lower=\"1\" upper=\"-1\" effort=\"1\" velocity=\"1\"/>", "");
    let trial = Trial::new().with("bad.urdf", &bad);
    std::fs::create_dir(trial.path("robots")).unwrap();
    std::fs::rename(trial.path("bad.urdf"), trial.path("robots/bad.urdf")).unwrap();
    std::fs::remove_file(trial.path("arm.urdf")).unwrap();
    assert_eq!(trial.run("check robots").code, 1);
    let written = trial.run("check --write-baseline known.json robots");
    assert_eq!((written.code, written.stdout.as_str()), (0, ""), "{}", written.stderr);
    assert!(written.stderr.contains("of 1 file(s) are now known"), "{}", written.stderr);
    let clean = |line: &str| {
        let run = trial.run(line);
        assert_eq!(run.code, 0, "{line}: {}", run.stdout);
        assert!(run.stdout.contains("0 new finding(s), 0 of them errors;"), "{}", run.stdout);
    };
    clean("check --baseline known.json robots");
    // From elsewhere, and with every line moved.
    let inside = support::denavit_in(&trial.path("robots"), &["check", "--baseline", "../known.json", "bad.urdf"]);
    assert_eq!(inside.code, 0, "{}", inside.stdout);
    std::fs::write(trial.path("robots/bad.urdf"), bad.replacen(">\n", ">\n\n<!-- down -->\n\n", 1)).unwrap();
    clean("check --baseline known.json robots");
    // The same fault in another file is new, and so is another in this.
    std::fs::write(trial.path("robots/copy.urdf"), &bad).unwrap();
    let run = trial.run("check --baseline known.json robots");
    assert_eq!(run.code, 1, "{}", run.stdout);
    assert!(run.stdout.contains("copy.urdf:7: error D021"), "{}", run.stdout);
    assert!(!run.stdout.contains("bad.urdf:4: ") && !run.stdout.contains("bad.urdf:7: "), "{}", run.stdout);
    std::fs::remove_file(trial.path("robots/copy.urdf")).unwrap();
    std::fs::write(trial.path("robots/bad.urdf"), bad.replace("</joint>", "<mimic joint=\"nobody\"/></joint>"))
        .unwrap();
    let run = trial.run("check --baseline known.json robots --json");
    let json: Value = serde_json::from_str(&run.stdout).unwrap();
    assert_eq!((run.code, json["findings"].as_array().unwrap().len()), (1, 1), "{json}");
    assert_eq!(json["findings"][0]["rule"], "D040");
    // What is fixed is said.
    std::fs::write(trial.path("robots/bad.urdf"), arm(LIMIT, "")).unwrap();
    let run = trial.run("check --baseline known.json robots");
    assert!(run.code == 0 && run.stderr.contains("2 finding(s) of the baseline are fixed"), "{}", run.stderr);
    trial.refuses("check --baseline missing.json robots", "missing.json");
    trial.refuses("check --baseline robots/bad.urdf robots", "this is no baseline");
}

const SRDF: &str = "<robot name=\"arm\">\n<group name=\"g\">\n<chain base_link=\"base\" tip_link=\"aa\"/>\n<joint name=\"jj\"/>\n</group>\n\
                    <group_state name=\"home\" group=\"gg\"><joint name=\"j1\" value=\"0\"/></group_state>\n\
                    <disable_collisions link1=\"base\" link2=\"b\" reason=\"Never\"/>\n<virtual_joint name=\"v\" type=\"fixed\" \
                    parent_frame=\"world\" child_link=\"base\"/>\n<passive_joint name=\"v\"/>\n<robotx/>\n</robot>\n";

#[test]
fn an_srdf_is_checked_against_its_robot() {
    let trial = Trial::new().with("r.urdf", &arm(LIMIT, "")).with("r.srdf", SRDF);
    let run = trial.run("check r.srdf r.urdf");
    assert!(run.code < 2, "{}", run.stderr);
    let lines: Vec<&str> =
        run.stdout.lines().filter(|line| line.starts_with("r.srdf:") && line.contains(" D0")).collect();
    let expected = [
        "r.srdf:3: warning D042 group \"g\": link \"aa\" does not exist; did you mean \"a\"?",
        "r.srdf:4: warning D042 group \"g\": joint \"jj\" does not exist; did you mean \"j1\"?",
        "r.srdf:6: warning D042 group_state \"home\": group \"gg\" does not exist",
        "r.srdf:7: warning D042 disable_collisions \"base\" \"b\": link \"b\" does not exist; did you mean \"a\"?",
        "r.srdf:10: warning D009 robotx: <robotx> is not understood",
    ];
    assert_eq!(lines.len(), expected.len(), "{}", run.stdout);
    for (line, words) in lines.iter().zip(expected) {
        assert!(line.contains(words), "{line}\n{words}");
    }
    trial.refuses("check r.srdf", "the robot \"arm\" is not among the files; name its URDF, too");
    assert!(trial.run("check .").stdout.contains("r.srdf:3: warning D042"));
    let other =
        Trial::new().with("r.urdf", &arm(LIMIT, "")).with("r.srdf", "<robot name=\"mra\"><group name=\"g\"/></robot>");
    let said = other.run("check r.urdf r.srdf").stdout;
    assert!(said.contains("it is for robot \"mra\", but the robot's name is \"arm\""), "{said}");
    assert_eq!(Trial::new().with("r.srdf", "<robot").run("check arm.urdf r.srdf").code, 1);
}

/// Files written and committed; `None`, with the reason printed, where there is no git.
pub(super) fn repository(files: &[(&str, &str)]) -> Option<Trial> {
    let trial = Trial::new();
    std::fs::remove_file(trial.path("arm.urdf")).unwrap();
    for (name, text) in files {
        let path = trial.path(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, text).unwrap();
    }
    if !sh(
        &trial,
        "git init -q . && git config user.name t && git config user.email t@example.org && git add . && git commit -qm 1",
    ) {
        println!("skipped, because there is no git");
        return None;
    }
    Some(trial)
}

pub(super) fn sh(trial: &Trial, script: &str) -> bool {
    ran(trial, script).code == 0
}

/// A script in the repository, `denavit` on the PATH.
fn ran(trial: &Trial, script: &str) -> Run {
    let binary = std::path::Path::new(env!("CARGO_BIN_EXE_denavit")).parent().unwrap();
    let path = format!("{}:{}", binary.display(), std::env::var("PATH").unwrap());
    let mut command = Command::new("bash");
    command.args(["-c", script]).current_dir(trial.folder()).env("GIT_CONFIG_GLOBAL", "/dev/null").env("PATH", path);
    match command.output() {
        Ok(output) => {
            let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
            Run { code: output.status.code().unwrap_or(-1), stdout: text(&output.stdout), stderr: text(&output.stderr) }
        }
        Err(error) => Run { code: -1, stdout: String::new(), stderr: error.to_string() },
    }
}

const PACKAGE: &str = "<package format=\"3\"><name>d</name></package>";
const MACROS: &str = "<robot xmlns:xacro=\"http://ros.org/wiki/xacro\"><xacro:property name=\"L\" value=\"0.4\"/><xacro:macro name=\"arm\">\
     <link name=\"a\"/><link name=\"b\"><visual><geometry><mesh filename=\"file://$(find d)/meshes/b.stl\"/></geometry></visual></link>\
     <link name=\"c\"/><joint name=\"j1\" type=\"continuous\"><parent link=\"a\"/><child link=\"b\"/><axis xyz=\"0 0 1\"/></joint>\
     <joint name=\"j2\" type=\"continuous\"><parent link=\"b\"/><child link=\"c\"/><origin xyz=\"${L} 0 ${height['z']}\"/>\
     <axis xyz=\"0 1 0\"/></joint></xacro:macro></robot>";
const ROBOT: &str = "<robot name=\"r\" xmlns:xacro=\"http://ros.org/wiki/xacro\"><xacro:include filename=\"$(find d)/urdf/m.xacro\"/>\
     <xacro:property name=\"height\" value=\"${xacro.load_yaml('../config/h.yaml')}\"/><xacro:arm/></robot>";

fn xacro_repository() -> Option<Trial> {
    repository(&[
        ("x/package.xml", PACKAGE),
        ("x/urdf/m.xacro", MACROS),
        ("x/urdf/r.urdf.xacro", ROBOT),
        ("x/config/h.yaml", "z: 0.1\n"),
        ("x/meshes/b.stl", "solid b"),
    ])
}

#[test]
fn a_xacro_of_a_revision_is_expanded_with_what_that_revision_has() {
    let Some(trial) = xacro_repository() else {
        return;
    };
    let diff = "diff git:HEAD:x/urdf/r.urdf.xacro x/urdf/r.urdf.xacro";
    let same = trial.run(diff).succeeded();
    assert!(same.contains("the same robot"), "{same}");
    for (file, from, to) in [("x/urdf/m.xacro", "0.4", "0.5"), ("x/config/h.yaml", "0.1", "0.3")] {
        let before = trial.text(file);
        std::fs::write(trial.path(file), before.replace(from, to)).unwrap();
        for line in [diff.to_owned(), format!("diff --package-path . {}", &diff[5..])] {
            let run = trial.run(&line);
            assert_eq!(run.code, 1, "{file}: {}{}", run.stdout, run.stderr);
            assert!(run.stdout.contains("joint \"j2\""), "{}", run.stdout);
        }
        std::fs::write(trial.path(file), before).unwrap();
    }
    // The package's folder and everything in it may be gone, or be called otherwise.
    assert!(sh(&trial, "git mv x y && sed -i s/0.4/0.5/ y/urdf/m.xacro"));
    let run = trial.run("diff git:HEAD:x/urdf/r.urdf.xacro y/urdf/r.urdf.xacro");
    assert_eq!(run.code, 1, "{}{}", run.stdout, run.stderr);
    // From a folder inside, by a relative path, and as staged.
    let inside = support::denavit_in(&trial.path("y/urdf"), &["chains", "git:HEAD:../../x/urdf/r.urdf.xacro"]);
    assert_eq!(inside.code, 0, "{}", inside.stderr);
    assert_eq!(trial.run("chains git::y/urdf/r.urdf.xacro").code, 0);
    let linked = "mkdir z && ln -s ../y/urdf/r.urdf.xacro z/l.urdf.xacro && git add . && git commit -qm 2 && rm -r y z";
    assert!(sh(&trial, linked));
    assert_eq!(trial.run("chains git:HEAD:y/urdf/r.urdf.xacro").code, 0);
}

#[cfg(unix)]
#[test]
fn a_link_in_a_revision_is_the_file_that_it_leads_to() {
    let Some(trial) = xacro_repository() else {
        return;
    };
    let commit = "git add . && git -c user.name=a -c user.email=a@b commit -q -m link";
    assert!(sh(&trial, &format!("ln -s r.urdf.xacro x/urdf/l.urdf.xacro && ln -s nowhere broken.urdf && {commit}")));
    let same = trial.run("diff git:HEAD:x/urdf/l.urdf.xacro x/urdf/r.urdf.xacro").succeeded();
    assert!(same.contains("the same robot"), "{same}");
    let run = trial.run("chains git:HEAD:broken.urdf");
    assert_eq!(run.code, 2, "{}", run.stdout);
    assert!(run.stderr.contains("git:HEAD:broken.urdf"), "{}", run.stderr);
}

#[test]
fn meshes_of_a_revision_are_those_of_the_revision() {
    let mesh = "<visual><geometry><mesh filename=\"package://d/meshes/b.stl\"/></geometry></visual>";
    let text = arm(LIMIT, "").replace("<link name=\"a\"/>", &format!("<link name=\"a\">{mesh}</link>"));
    let Some(trial) =
        repository(&[("x/package.xml", PACKAGE), ("x/urdf/r.urdf", &text), ("x/meshes/b.stl", "solid b")])
    else {
        return;
    };
    assert!(!trial.run("check git:HEAD:x/urdf/r.urdf").stdout.contains("D050"));
    assert!(sh(
        &trial,
        "git rm -q x/meshes/b.stl && git commit -qm 2 && mkdir x/meshes && echo solid > x/meshes/b.stl"
    ));
    let gone = trial.run("check git:HEAD:x/urdf/r.urdf").stdout;
    assert!(gone.contains("D050") && gone.contains("there is no file git:HEAD:x/meshes/b.stl"), "{gone}");
    assert!(!trial.run("check git:HEAD~1:x/urdf/r.urdf").stdout.contains("D050"));
    assert!(!trial.run("check x/urdf/r.urdf").stdout.contains("D050"));
}

#[test]
fn what_a_revision_does_not_have_is_refused_by_its_name() {
    let Some(trial) = xacro_repository() else {
        return;
    };
    assert!(sh(&trial, "git rm -q --cached x/urdf/m.xacro && git commit -qm 2"));
    trial.refuses(
        "diff git:HEAD:x/urdf/r.urdf.xacro x/urdf/r.urdf.xacro",
        "\"git:HEAD:x/urdf/m.xacro\" cannot be read: there is no such file",
    );
    trial.refuses("chains git:nowhere:x/urdf/r.urdf.xacro", "nowhere");
    let broken = MACROS.replace("${L}", "${M}");
    std::fs::write(trial.path("x/urdf/m.xacro"), broken).unwrap();
    assert!(sh(&trial, "git add . && git commit -qm 3"));
    trial.refuses("chains git:HEAD:x/urdf/r.urdf.xacro", "git:HEAD:x/urdf/m.xacro:1:");
    // A submodule has its own revisions.
    let part = "git init -q sub && cd sub && git config user.name t && git config user.email t@e.org && cp ../x/urdf/m.xacro . && \
                git add . && git commit -qm s && cd .. && git add sub 2>/dev/null && git commit -qm 4 && \
                sed -i 's,$(find d)/urdf/m.xacro,../../sub/m.xacro,' x/urdf/r.urdf.xacro && git commit -qam 5";
    assert!(sh(&trial, part));
    trial.refuses("chains --allow-any-file git:HEAD:x/urdf/r.urdf.xacro", "it is in the submodule sub");
}

#[test]
fn what_is_outside_the_repository_is_read_as_it_is_now_and_said() {
    let Some(trial) = xacro_repository() else {
        return;
    };
    let outside = Trial::new()
        .with("package.xml", "<package><name>far</name></package>")
        .with("l.xacro", "<robot xmlns:xacro=\"http://ros.org/wiki/xacro\"><link name=\"far\"/></robot>");
    std::fs::write(trial.path("x/urdf/o.urdf.xacro"), "<robot name=\"o\" xmlns:xacro=\"http://ros.org/wiki/xacro\"><xacro:include filename=\"$(find far)/l.xacro\"/></robot>").unwrap();
    assert!(sh(&trial, "git add . && git commit -qm 2"));
    let line = format!("expand git:HEAD:x/urdf/o.urdf.xacro --package-path {}", outside.folder().display());
    let run = trial.run(&line);
    assert!(run.code == 0 && run.stdout.contains("link name=\"far\""), "{}", run.stderr);
    assert!(
        run.stderr.contains("l.xacro is outside the repository, so its present content was read"),
        "{}",
        run.stderr
    );
}

#[test]
fn the_hooks_see_xacro_included_files_and_renamed_files() {
    let Some(trial) = xacro_repository() else {
        return;
    };
    let hook = support::top().join("hooks/same-motion").to_str().unwrap().to_owned();
    let refused = |script: &str, code: i32, said: &str| {
        assert!(sh(&trial, script), "{script}");
        let run = ran(&trial, &hook);
        assert_eq!(run.code, code, "{script}: {}{}", run.stdout, run.stderr);
        assert!(run.stdout.contains(said), "{script}: {}", run.stdout);
        assert!(sh(&trial, "git reset -q --hard && git clean -qfd"));
    };
    refused("true", 0, "0 of");
    refused("sed -i s/0.4/0.5/ x/urdf/m.xacro && git add .", 1, "x/urdf/r.urdf.xacro: different");
    refused("sed -i s/0.1/0.3/ x/config/h.yaml && git add .", 1, "different");
    refused("git mv x/urdf/r.urdf.xacro x/urdf/s.urdf.xacro", 0, "the same robot");
    refused(
        "git mv x/urdf/r.urdf.xacro x/urdf/s.urdf.xacro && sed -i s/0.4/0.5/ x/urdf/m.xacro && git add .",
        1,
        "x/urdf/s.urdf.xacro (was x/urdf/r.urdf.xacro): different",
    );
    refused("git rm -q x/urdf/m.xacro", 2, "x/urdf/r.urdf.xacro: cannot be read: ");
    refused("cp x/urdf/r.urdf.xacro x/urdf/new.urdf.xacro && git add .", 0, "x/urdf/new.urdf.xacro: new");
    // The rules: a file of macros is no robot, a broken one is one.
    let run = ran(&trial, "denavit check --robots-only x/urdf/m.xacro x/urdf/r.urdf.xacro");
    assert_eq!(run.code, 0, "{}{}", run.stdout, run.stderr);
    assert!(run.stderr.contains("x/urdf/m.xacro: left out, as it is not a robot by itself"), "{}", run.stderr);
    std::fs::write(trial.path("x/urdf/r.urdf.xacro"), ROBOT.replace("/m.xacro", "/n.xacro")).unwrap();
    assert_eq!(ran(&trial, "denavit check --robots-only x/urdf/r.urdf.xacro").code, 2);
}

#[test]
fn a_package_is_found_by_the_name_of_its_folder_as_well() {
    let trial = Trial::new();
    std::fs::remove_file(trial.path("arm.urdf")).unwrap();
    for folder in ["other-name/robots/one/urdf", "other-name/meshes", "plain/urdf", "plain/meshes"] {
        std::fs::create_dir_all(trial.path(folder)).unwrap();
    }
    let mesh = |name: &str| {
        format!(
            "<robot name=\"r\"><link name=\"a\"><visual><geometry><mesh filename=\"package://{name}/meshes/a.stl\"/></geometry></visual></link></robot>"
        )
    };
    let write = |name: &str, text: &str| std::fs::write(trial.path(name), text).unwrap();
    write("other-name/package.xml", "<package><name>real_name</name></package>");
    write("other-name/meshes/a.stl", "solid a");
    write("plain/meshes/a.stl", "solid a");
    write("other-name/robots/one/urdf/by_name.urdf", &mesh("real_name"));
    write("other-name/robots/one/urdf/by_folder.urdf", &mesh("other-name"));
    write("plain/urdf/above.urdf", &mesh("plain"));
    let found = trial.run("check .").stdout;
    assert!(!found.contains("D050"), "{found}");
    write("plain/urdf/above.urdf", &mesh("plane"));
    assert!(trial.run("check .").stdout.contains("D050"));
}

#[cfg(unix)]
#[test]
fn a_variable_that_is_not_utf_8_does_not_stop_what_does_not_use_it() {
    use std::os::unix::ffi::OsStrExt as _;
    let trial = Trial::new().with(
        "r.xacro",
        "<robot name=\"r\" xmlns:xacro=\"http://ros.org/wiki/xacro\"><link name=\"$(optenv ODD a)\"/></robot>",
    );
    let run = |file: &str| {
        let mut command = support::program(trial.folder());
        command.env("ODD", std::ffi::OsStr::from_bytes(b"\xff\xfe"));
        let output = command.args(["check", file]).output().unwrap();
        (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
    };
    assert_eq!(run("arm.urdf").0, Some(0));
    let (code, said) = run("r.xacro");
    assert!(code == Some(2) && said.contains("\"ODD\" is not text in UTF-8"), "{said}");
}
