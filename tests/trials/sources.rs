//! Every command takes every source.

use super::Trial;
use crate::support::denavit_with_input;

const XACRO: &str = r#"<?xml version="1.0"?>
<robot name="bent" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:arg name="length" default="0.5"/>
  <link name="base"/> <link name="upper"/> <link name="lower"/> <link name="tool0"/>
  <joint name="shoulder" type="revolute"> <parent link="base"/> <child link="upper"/> <axis xyz="0 0 1"/>
    <limit lower="-2" upper="2" velocity="1" effort="9"/> </joint>
  <joint name="elbow" type="revolute"> <parent link="upper"/> <child link="lower"/> <axis xyz="0 1 0"/>
    <origin xyz="$(arg length) 0 0.1"/> <limit lower="-2" upper="2" velocity="1" effort="9"/> </joint>
  <joint name="flange" type="fixed"> <parent link="lower"/> <child link="tool0"/> <origin xyz="0.3 0 0"/> </joint>
</robot>
"#;

#[test]
fn every_command_takes_every_source() {
    let trial = Trial::new().with("bent.xacro", XACRO).with_robot("table.csv", "universal_robots/ur5e_dh.csv");
    for (format, file) in [("json", "table.json"), ("ur", "ur.yaml")] {
        trial.run(&format!("table arm.urdf --format {format} -o {file}")).succeeded();
    }
    trial.run("poe arm.urdf --format csv -o axes.csv").succeeded();
    trial.run("poe arm.urdf --format json -o axes.json").succeeded();
    for source in ["arm.urdf", "bent.xacro", "table.csv", "table.json", "axes.csv", "axes.json", "ur.yaml"] {
        let data = format!("data of {source}.csv").replace(' ', "_");
        for line in [
            format!("table {source}"),
            format!("chains {source}"),
            format!("fk {source}"),
            format!("poe {source}"),
            format!("export {source}"),
            format!("doc {source} -o -"),
            format!("diff {source} {source}"),
            format!("fingerprint {source}"),
            format!("check {source}"),
            format!("identify {source} --rows 10"),
            format!("plan {source} --count 8 --spread 60 -o poses_{data}"),
            format!("simulate {source} --rows 30 -o {data}"),
            format!("compensate {source} --poses poses_{data}"),
            format!("calibrate {source} --data {data} --effects none"),
        ] {
            let run = trial.run(&line);
            assert!(run.code < 2, "{line}: {}", run.stderr);
        }
    }
}

#[test]
fn arguments_of_xacro_reach_every_command() {
    let trial = Trial::new().with("bent.xacro", XACRO);
    let long = trial.run("fk bent.xacro length:=1.5").succeeded();
    assert_ne!(long, trial.run("fk bent.xacro").succeeded());
    let page = |line: &str| trial.run(line).succeeded();
    assert_ne!(page("doc bent.xacro -o -"), page("doc bent.xacro length:=1.5 -o -"));
    assert!(trial.run("check bent.xacro length:=1.5").code < 2);
    assert!(trial.run("check bent.xacro length:=nonsense").stdout.contains("\"nonsense\" is not a finite number"));
    trial.refuses("doc length:=1.5 -o pages", "no robot is named");
    trial.refuses("table arm.urdf 1.5", "arguments of a xacro file (NAME:=VALUE)");
}

#[test]
fn arguments_of_xacro_are_for_xacro() {
    let trial = Trial::new()
        .with("bent.xacro", XACRO)
        .with_robot("table.csv", "universal_robots/ur5e_dh.csv")
        .with("poses.csv", "x,y,z\n0.4,0.1,0.3\n")
        .with("data.csv", "");
    for source in ["arm.urdf", "table.csv"] {
        for line in [
            format!("table {source} length:=1.5"),
            format!("chains {source} length:=1.5"),
            format!("fk {source} length:=1.5"),
            format!("poe {source} length:=1.5"),
            format!("export {source} length:=1.5"),
            format!("describe {source} length:=1.5"),
            format!("fingerprint {source} length:=1.5"),
            format!("identify {source} length:=1.5"),
            format!("plan {source} length:=1.5 --count 8"),
            format!("simulate {source} length:=1.5"),
            format!("calibrate {source} length:=1.5 --data data.csv"),
            format!("compensate {source} length:=1.5 --poses poses.csv"),
        ] {
            trial.refuses(&line, &format!("{source}: this is not a xacro file, so it takes no argument length:=1.5"));
        }
    }
    for line in [
        "diff arm.urdf table.csv length:=1.5",
        "doc arm.urdf table.csv length:=1.5 -o -",
        "check arm.urdf length:=1.5",
        "compensate arm.urdf length:=1.5 --from table.csv --poses poses.csv",
    ] {
        trial.refuses(line, "takes");
    }
    // Of use to one of them is enough.
    let both = trial.run("diff arm.urdf bent.xacro length:=1.5");
    assert_eq!(both.code, 1, "{}", both.stderr);
    assert!(trial.run("check arm.urdf bent.xacro length:=1.5").code < 2);
    assert_eq!(trial.run("doc arm.urdf bent.xacro length:=1.5 -o pages").code, 0);
}

#[test]
fn xacro_and_tables_are_checked() {
    let trial = Trial::new()
        .with("bent.xacro", &XACRO.replace("0 0 1", "0 0 2"))
        .with_robot("table.csv", "universal_robots/ur5e_dh.csv")
        .with("bad.csv", "row,theta,d,alpha,a\n1,q1,nan,0,0\n");
    let found = trial.run("check bent.xacro");
    assert!(found.stdout.contains("bent.xacro (expanded):") && found.stdout.contains("D012"), "{}", found.stdout);
    let fixed = trial.run("check --fix bent.xacro");
    assert!(fixed.stderr.contains("--fix changes URDF files only"), "{}", fixed.stderr);
    assert!(trial.text("bent.xacro").contains("0 0 2"));
    assert_eq!(trial.run("check table.csv").code, 0);
    trial.refuses("check bad.csv", "bad.csv:2");
    assert!(denavit_with_input(&["check", "-"], XACRO).code < 2);
}

#[test]
fn a_folder_stands_for_the_robots_in_it() {
    let trial = Trial::new();
    std::fs::create_dir_all(trial.path("robots/parts/.git")).unwrap();
    let trial = trial
        .with("robots/bent.xacro", XACRO)
        .with("robots/parts/macros.xacro", "<robot xmlns:xacro=\"http://www.ros.org/wiki/xacro\"/>")
        .with("robots/parts/.git/hidden.urdf", "<robot/>")
        .with("robots/notes.csv", "time,reading\n1,2\n")
        .with_robot("robots/parts/table.csv", "universal_robots/ur5e_dh.csv")
        .with_robot("robots/two.urdf", "abb/irb120.urdf");
    let checked = trial.run("check robots --json");
    let report: serde_json::Value = serde_json::from_str(&checked.stdout).unwrap();
    assert_eq!(report["files"], serde_json::json!(["robots/bent.xacro", "robots/parts/table.csv", "robots/two.urdf"]));
    assert!(checked.stderr.contains("robots/parts/macros.xacro: left out"), "{}", checked.stderr);
    let written = trial.run("doc robots -o pages").succeeded();
    assert_eq!(
        written.lines().collect::<Vec<_>>(),
        ["pages/bent.html", "pages/table.html", "pages/two.html", "pages/index.html"]
    );
    std::fs::create_dir(trial.path("empty")).unwrap();
    trial.refuses("check empty", "there is no robot in this folder");
}

#[test]
fn an_arm_with_a_hand_ends_at_its_tool() {
    let trial = Trial::new().with_robot("panda.urdf", "franka/panda.urdf");
    let run = trial.run("fk panda.urdf");
    assert!(
        run.stderr.contains("the chain ends at \"panda_hand_tcp\"") && run.stderr.contains("--tip"),
        "{}",
        run.stderr
    );
    assert!(run.succeeded().starts_with("panda_link0 → panda_hand_tcp"));
    assert!(trial.run("chains panda.urdf").succeeded().contains("* panda_link0 → panda_hand_tcp"));
    assert!(!trial.run("fk panda.urdf --tip panda_leftfinger").stderr.contains("--tip"));
}

#[test]
fn the_export_has_the_numbers_of_the_table_or_says_that_it_has_not() {
    let trial = Trial::new().with_robot("panda.urdf", "franka/panda.urdf");
    let rows = |file: &str| -> Vec<Vec<f64>> {
        let json: serde_json::Value =
            serde_json::from_str(&trial.run(&format!("table {file} --json")).succeeded()).unwrap();
        let number = |row: &serde_json::Value, key: &str| row[key].as_f64().unwrap_or(0.0);
        let of = |row| ["theta", "d", "alpha", "a"].map(|key| number(row, key)).to_vec();
        json["rows"].as_array().unwrap().iter().chain([&json["tool"]]).map(of).collect()
    };
    let near = |one: &[Vec<f64>], other: &[Vec<f64>]| {
        one.concat().iter().zip(other.concat()).all(|(a, b)| (a - b).abs() < 1e-9) && one.len() == other.len()
    };
    let run = trial.run("export panda.urdf -o panda_dh.urdf");
    assert_eq!((run.code, run.stderr.as_str()), (0, ""));
    assert!(near(&rows("panda.urdf"), &rows("panda_dh.urdf")), "{:?} {:?}", rows("panda.urdf"), rows("panda_dh.urdf"));
    assert_eq!(trial.run("export panda_dh.urdf").succeeded(), trial.text("panda_dh.urdf"));
    let Some(vendor) = crate::support::vendor() else {
        return;
    };
    let mut hands = 0;
    for path in crate::support::files(&vendor.join("robots"), "urdf") {
        std::fs::copy(&path, trial.path("robot.urdf")).unwrap();
        let described = trial.run("table robot.urdf --json");
        if described.code != 0 || !format!("{}{}", described.stdout, described.stderr).contains("the chain ends at") {
            continue;
        }
        let run = trial.run("export robot.urdf -o robot_dh.urdf");
        if run.code != 0 {
            continue;
        }
        hands += 1;
        let said = run.stderr.contains("have different numbers for the same robot");
        let same = near(&rows("robot.urdf")[..], &rows("robot_dh.urdf")[..]);
        assert!(said || same, "{}: {}", path.display(), run.stderr);
        if said {
            println!("{}: said", path.display());
        }
        assert_eq!(trial.run("export robot_dh.urdf").succeeded(), trial.text("robot_dh.urdf"), "{}", path.display());
    }
    println!("{hands} arms with hands");
    assert!(hands > 5, "{hands}");
}
