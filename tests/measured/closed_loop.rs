//! From simulated files to a model, and from the model to commands that reach.

use super::{Folder, apart, json, json_file, tip, ur5e};
use crate::support::{denavit, robot};
use denavit_model::nalgebra::{Quaternion, UnitQuaternion};
use std::process::Command;

/// The files of a calibration with an effect in the data: their folder, and the report.
fn calibrated(effect: &str, columns: &str, kinds: &str) -> (Folder, serde_json::Value) {
    let (folder, ur5e) = (Folder::new(), ur5e());
    let (train, test) = (folder.path("train.csv"), folder.path("test.csv"));
    let simulate = [
        "simulate",
        &ur5e,
        "--rows",
        "150",
        "--seed",
        "11",
        "-o",
        &train,
        "--test",
        &test,
        "--effect",
        effect,
        "--columns",
        columns,
        "--truth",
        &folder.path("truth.json"),
    ];
    assert_eq!(denavit(&simulate).succeeded(), "");
    let [report, page, urdf, yaml, effects] =
        ["report.json", "page.html", "as_it_is.urdf", "as_it_is.yaml", "effects.json"].map(|name| folder.path(name));
    let calibrate = [
        "calibrate",
        &ur5e,
        "--data",
        &train,
        "--test",
        &test,
        "--json",
        &report,
        "--html",
        &page,
        "--urdf",
        &urdf,
        "--dh",
        &yaml,
        "--effects-out",
        &effects,
        "--effects",
        kinds,
    ];
    let run = denavit(&calibrate);
    assert_eq!(run.stderr, "", "nothing but results where no terminal is");
    assert!(run.succeeded().contains("strongest correlations"));
    assert!(std::fs::read_to_string(page).unwrap().starts_with("<!doctype html>"));
    let report = json_file(&report);
    (folder, report)
}

#[test]
fn the_loop_closes_from_simulation_to_commands() {
    let (folder, report) = calibrated("joint_compliance@elbow_joint=0.4mm", "time,payload", "auto");
    assert_eq!(report["schema"], "denavit.calibration/2");
    assert_eq!(report["effects"][0]["kind"], "joint_compliance");
    assert_eq!(report["effects"][0]["joint"], "elbow_joint");
    let truth = json_file(&folder.path("truth.json"));
    let found = report["effects"][0]["parameters"]["coefficient"].clone();
    let (value, std) = (found["value"].as_f64().unwrap(), found["std"].as_f64().unwrap());
    let made = truth["effects"]["effects"][0]["coefficients"][0].as_f64().unwrap();
    assert!((value - made).abs() < 4.0 * std, "{value} ± {std}, made as {made}");
    // Commands for the poses of a plan: the calibrated robot reaches the poses of the drawn one.
    let (urdf, effects, plan) = (folder.path("as_it_is.urdf"), folder.path("effects.json"), folder.path("plan.csv"));
    denavit(&["plan", &ur5e(), "--count", "8", "--measure", "poses", "-o", &plan]).succeeded();
    let run =
        denavit(&["compensate", &urdf, "--effects", &effects, "--poses", &plan, "--given", "payload=2", "--json"]);
    let commands = json(&run.stdout);
    let mut reached = 0;
    for command in commands["commands"].as_array().unwrap() {
        let list = |key: &str| {
            let joints = command[key].as_object().unwrap();
            joints.iter().map(|(name, value)| format!("{name}={value}")).collect::<Vec<_>>().join(",")
        };
        if command["state"] != "reached" {
            continue;
        }
        reached += 1;
        let by = ["--exact", "--effects", &effects, "--given", "payload=2", "--q"];
        let as_it_is = tip(&[&[urdf.as_str()], &by[..], &[list("joints").as_str()]].concat());
        let drawn = tip(&[&ur5e(), "--q", &list("nominal")]);
        assert!(apart(&as_it_is, &drawn) < 1e-9, "{:e}", apart(&as_it_is, &drawn));
        assert!(command["uncompensated_m"].as_f64().unwrap() > 1e-4);
    }
    assert!(reached >= 6, "{reached}");
    assert_eq!(run.code, i32::from(reached < 8));
    // The generated code computes the same, and finds the same commands.
    let code = folder.path("arm.py");
    let with = ["--exact", "--effects", &effects, "--given", "payload=2"];
    denavit(&[&["code", &urdf, "--lang", "python", "-o", &code], &with[..]].concat()).succeeded();
    let q = "0.3,-1.1,0.9,0.2,0.5,-0.4";
    let asked = format!(
        "import runpy; arm = runpy.run_path({code:?}); pose = arm['fk_with_effects']([{q}]); \
         state, q = arm['command_from_target'](pose, [0.31, -1.09, 0.91, 0.19, 0.49, -0.41]); \
         print(arm['self_test'](), state, *(row[3] for row in pose[:3]), *q)"
    );
    match Command::new("python3").args(["-c", &asked]).output() {
        Ok(run) => {
            let said = String::from_utf8(run.stdout).unwrap();
            let numbers: Vec<f64> = said.split_whitespace().map(|word| word.parse().unwrap()).collect();
            assert_eq!(numbers[..2], [0.0, 1.0], "{said} {}", String::from_utf8_lossy(&run.stderr));
            let by_fk = tip(&[&[urdf.as_str()], &with[..], &["--q", q]].concat());
            assert!(apart(&numbers[2..5], &by_fk[..3]) < 1e-9, "{said} {by_fk:?}");
            let joints: Vec<f64> = q.split(',').map(|value| value.parse().unwrap()).collect();
            assert!(apart(&numbers[5..], &joints) < 1e-8, "{said}");
        }
        Err(_) => println!("skipped, because python3 is not installed"),
    }
    // The kinematics file is the same robot except for the frame at its end, and can be used as a source.
    let yaml = folder.path("as_it_is.yaml");
    assert!(denavit(&["poe", &yaml]).succeeded().contains("wrist_3_joint"));
    let moved = |robot: &str, extra: &[&str]| {
        let at = |q: &str| tip(&[&[robot], extra, &["--exact", "--q", q]].concat());
        // Points on the last axis do not depend on the frame at the end of the chain.
        let (a, b) = (at("0.3,-1,0.8,0.2,0.5,0"), at("0.3,-1,0.8,0.2,0.5,3.141592653589793"));
        a.iter().zip(&b).map(|(a, b)| f64::midpoint(*a, *b)).collect::<Vec<f64>>()
    };
    let drawn = apart(&moved(&yaml, &[]), &moved(&ur5e(), &[]));
    let own = apart(&moved(&yaml, &[]), &moved(&urdf, &[]));
    assert!(own < 1e-9 && drawn > 1e-4, "{own:e} {drawn:e}");
}

#[test]
fn files_of_a_calibration_turn_the_tip_as_it_was_measured() {
    turned_as_measured("0,0", 1e-8);
}

/// With geometric errors an arm's orientation to gravity differs by a milliradian from that of its calibrated frames, which poses do not
/// show: the fit itself has an error of 0.7 µrad in the joint's compliance.
#[test]
fn files_of_a_calibration_off_its_drawing_turn_the_tip_as_far_as_gravity_is_known() {
    turned_as_measured("1,1", 3e-6);
}

/// `error`: mm and mrad of each axis; `within`: rad.
fn turned_as_measured(error: &str, within: f64) {
    let (folder, ur5e) = (Folder::new(), ur5e());
    let [data, urdf, effects] = ["data.csv", "as_it_is.urdf", "effects.json"].map(|name| folder.path(name));
    let effect = "axis_wobble@wrist_1_joint:order=2=0.4mm";
    let rows =
        ["--rows", "40", "--noise", "0,0", "--measure", "poses", "--columns", "payload", "--geometry-error", error];
    let simulate =
        ["simulate", &ur5e, "-o", &data, "--effect", "joint_compliance@elbow_joint=0.3mm", "--effect", effect];
    denavit(&[&simulate[..], &rows].concat()).succeeded();
    let kinds = "joint_compliance,axis_wobble";
    let calibrate =
        ["calibrate", &ur5e, "--data", &data, "--urdf", &urdf, "--effects-out", &effects, "--effects", kinds];
    denavit(&calibrate).succeeded();
    let text = std::fs::read_to_string(&data).unwrap();
    let mut turns: Vec<[UnitQuaternion<f64>; 2]> = Vec::new();
    for line in text.lines().filter(|line| !line.starts_with(['#', 's'])).take(6) {
        let cells: Vec<&str> = line.split(',').collect();
        let payload = format!("payload={}", cells[13]);
        let q = cells[..6].join(",");
        let fk = ["fk", &urdf, "--exact", "--json", "--effects", &effects, "--given", &payload, "--q", &q];
        let predicted = json(&denavit(&fk).succeeded());
        let turn = |x: f64, y: f64, z: f64, w: f64| UnitQuaternion::new_normalize(Quaternion::new(w, x, y, z));
        let p: Vec<f64> =
            predicted["quaternion_xyzw"].as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect();
        let m: Vec<f64> = cells[9..13].iter().map(|cell| cell.parse().unwrap()).collect();
        turns.push([turn(p[0], p[1], p[2], p[3]), turn(m[0], m[1], m[2], m[3])]);
    }
    // The angle between two rows does not depend on the poses of instrument and target.
    for pair in turns.windows(2) {
        let angle = |which: usize| pair[0][which].angle_to(&pair[1][which]);
        assert!((angle(0) - angle(1)).abs() < within, "{:e}", angle(0) - angle(1));
        assert!(pair[0][0].angle_to(&pair[1][0]) > 0.1);
    }
}

#[test]
fn four_joints_reach_places_and_leave_directions() {
    let (folder, scara) = (Folder::new(), robot("adept/cobra600.urdf"));
    let [data, urdf, effects, plan] =
        ["d.csv", "as_it_is.urdf", "effects.json", "plan.csv"].map(|name| folder.path(name));
    let effect = format!(
        "backlash@{}=0.2mm",
        json(&denavit(&["identify", &scara, "--json"]).succeeded())["dh"]["parallel_neighbours"][0][0]
            .as_str()
            .unwrap()
    );
    let simulate = ["simulate", &scara, "-o", &data, "--measure", "poses", "--rows", "150", "--effect", &effect];
    denavit(&simulate).succeeded();
    let calibrate = ["calibrate", &scara, "--data", &data, "--urdf", &urdf, "--effects-out", &effects];
    assert!(denavit(&calibrate).succeeded().contains(&effect.replace('@', " at ").replace("=0.2mm", "")));
    denavit(&["plan", &scara, "--count", "6", "-o", &plan]).succeeded();
    let compensate = ["compensate", &urdf, "--effects", &effects, "--poses", &plan];
    let strict = denavit(&compensate);
    assert!(strict.code == 1 && strict.stdout.starts_with("# 0 of 6 poses reached"), "{}", strict.stdout);
    denavit(&[&compensate[..], &["--allowed-miss", "0.001,20"]].concat()).succeeded();
}

#[test]
fn an_averaged_prediction_says_what_it_takes_at_its_average() {
    let (folder, report) = calibrated("thermal@elbow_joint=0.4mm", "temperature", "auto");
    assert_eq!(report["adopted"], "averaged");
    let (effects, ur5e) = (folder.path("effects.json"), ur5e());
    let done = denavit(&["fk", &ur5e, "--effects", &effects]);
    assert!(
        done.stderr.contains("the average of the fitted rows for \"temperature\"; set a value with --given"),
        "{}",
        done.stderr
    );
    let at = |given: &str| tip(&[&ur5e, "--effects", &effects, "--given", given]);
    assert!(apart(&at("temperature=20"), &at("temperature=28")) > 1e-5);
}

#[test]
fn effects_are_used_again_and_ask_for_what_they_follow() {
    let (folder, report) = calibrated("thermal@elbow_joint=0.4mm", "temperature", "thermal");
    assert_eq!(
        (&report["effects"][0]["kind"], &report["effects"][0]["joint"]),
        (&"thermal".into(), &"elbow_joint".into())
    );
    let (effects, ur5e) = (folder.path("effects.json"), ur5e());
    let message = denavit(&["fk", &ur5e, "--effects", &effects]).failed();
    assert!(
        message.ends_with(
            "thermal at elbow_joint follows \"temperature\"; give its value: --given \"temperature=VALUE\"\n"
        )
    );
    let at = |given: &str| tip(&[&ur5e, "--effects", &effects, "--given", given]);
    assert!(apart(&at("temperature=20"), &at("temperature=28")) > 1e-5);
    // Code gets missing values by an argument.
    let code = denavit(&["code", &ur5e, "--lang", "c", "--effects", &effects]).succeeded();
    assert!(code.contains("given[0]  temperature (°C)") && code.contains("const double given[1], double pose[3][4]"));
    let fixed =
        denavit(&["code", &ur5e, "--lang", "c", "--effects", &effects, "--given", "temperature=20"]).succeeded();
    assert!(!fixed.contains("given["));
    let again = ["simulate", &ur5e, "--effects", &effects];
    assert!(
        denavit(&again)
            .failed()
            .ends_with("thermal depends on \"temperature\"; record it with --columns \"temperature\"\n")
    );
    denavit(&[&again[..], &["--columns", "temperature"]].concat()).succeeded();
    let other = robot("universal_robots/ur10e.urdf");
    assert!(denavit(&["fk", &other, "--effects", &effects]).failed().contains("the effects belong to robot \"ur5e\""));
    let other = robot("abb/irb120.urdf");
    assert!(
        denavit(&["fk", &other, "--effects", &effects]).failed().contains("the effects are for joints shoulder_pan")
    );
}
