//! Measuring, calibrating and compensating as a user does: simulated files in, models and commands out.

use crate::golden::snapshot;
use crate::support::{denavit, denavit_with_input, robot, vendor};
use std::path::Path;
use tempfile::TempDir;

const JOINTS: &str = "shoulder_pan_joint,shoulder_lift_joint,elbow_joint,wrist_1_joint,wrist_2_joint,wrist_3_joint";

fn ur5e() -> String {
    robot("universal_robots/ur5e.urdf")
}

struct Folder(TempDir);

impl Folder {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn path(&self, name: &str) -> String {
        self.0.path().join(name).to_str().unwrap().to_owned()
    }

    fn file(&self, name: &str, text: &str) -> String {
        std::fs::write(self.path(name), text).unwrap();
        self.path(name)
    }

    fn names(&self) -> Vec<String> {
        let entries = std::fs::read_dir(self.0.path()).unwrap();
        let mut names: Vec<String> = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }
}

fn json(text: &str) -> serde_json::Value {
    serde_json::from_str(text).unwrap()
}

fn json_file(path: &str) -> serde_json::Value {
    json(&std::fs::read_to_string(path).unwrap())
}

fn tip(arguments: &[&str]) -> Vec<f64> {
    let all: Vec<&str> = ["fk", "--json"].iter().chain(arguments).copied().collect();
    let pose = json(&denavit(&all).succeeded());
    pose["xyz"].as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect()
}

fn apart(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
}

#[test]
fn helps_of_the_measuring_commands() {
    for command in ["calibrate", "identify", "plan", "simulate", "compensate"] {
        snapshot(&format!("help_{command}"), &denavit(&[command, "--help"]).succeeded());
    }
}

#[test]
fn plans_simulations_and_counts() {
    let ur5e = ur5e();
    snapshot("plan_ur5e", &denavit(&["plan", &ur5e, "--count", "10", "--spread", "200"]).succeeded());
    let columns = "time,temperature,payload,approach,elbow_joint.velocity";
    let effect = "joint_compliance@elbow_joint=0.3mm";
    let simulate = ["simulate", &ur5e, "--rows", "4", "--seed", "3", "--columns", columns, "--effect", effect];
    snapshot("simulate_ur5e", &denavit(&simulate).succeeded());
    let scara = robot("denso/hsr065_screw_spline.urdf");
    snapshot("identify_scara", &denavit(&["identify", &scara]).succeeded());
    snapshot("identify_rail", &denavit(&["identify", &robot("kuka/kr16_2_on_rail.urdf"), "--rows", "60"]).succeeded());
}

#[test]
fn a_joint_that_never_moves_is_named() {
    let folder = Folder::new();
    let rows = (0..30).map(|k| {
        let k = f64::from(k);
        format!("{},{},0.5,{},{},{}\n", 2.0 * k.sin(), (1.7 * k).sin(), 2.0 * (2.3 * k).cos(), (0.7 * k).cos(), k / 9.0)
    });
    let file = folder.file("still.csv", &format!("{JOINTS}\n{}", rows.collect::<String>()));
    let found = json(&denavit(&["identify", &ur5e(), "--data", &file, "--json"]).succeeded());
    assert_eq!((&found["schema"], &found["rows"]), (&"denavit.identifiability/1".into(), &30.into()));
    for kind in found["poe"].as_array().unwrap() {
        assert!(kind["rank"].as_u64().unwrap() < kind["expected"].as_u64().unwrap());
        for untold in kind["unidentifiable"].as_array().unwrap() {
            assert_eq!(untold["joint"], "elbow_joint");
            assert_eq!(untold["why"], "the joint never moves: its reading is 0.5 in every row");
        }
    }
    assert_eq!((&found["dh"]["redundant_in_base"], &found["dh"]["redundant_in_tool"]), (&4.into(), &2.into()));
    assert_eq!(found["dh"]["parallel_neighbours"][0][1], "elbow_joint");
}

/// The files of a calibration with an effect in the data: their folder, and the report.
fn calibrated(effect: &str, columns: &str) -> (Folder, serde_json::Value) {
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
    let (folder, report) = calibrated("joint_compliance@elbow_joint=0.4mm", "time,payload");
    assert_eq!(report["schema"], "denavit.calibration/1");
    assert_eq!(report["effects"][0]["kind"], "joint_compliance");
    assert_eq!(report["effects"][0]["joint"], "elbow_joint");
    let truth = json_file(&folder.path("truth.json"));
    let found = report["effects"][0]["parameters"]["coefficient"].clone();
    let (value, std) = (found["value"].as_f64().unwrap(), found["std"].as_f64().unwrap());
    let made = truth["effects"]["effects"][0]["coefficients"][0].as_f64().unwrap();
    assert!((value - made).abs() < 4.0 * std, "{value} ± {std}, made as {made}");
    // Commands for the poses of a plan: where the robot as it is then goes, the drawn one would have gone.
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
    // The kinematics file is the same robot but for the frame at its end, and a source like any other.
    let yaml = folder.path("as_it_is.yaml");
    assert!(denavit(&["poe", &yaml]).succeeded().contains("wrist_3_joint"));
    let moved = |robot: &str, extra: &[&str]| {
        let at = |q: &str| tip(&[&[robot], extra, &["--exact", "--q", q]].concat());
        // Points on the last axis stay where they are, whatever frame ends the chain.
        let (a, b) = (at("0.3,-1,0.8,0.2,0.5,0"), at("0.3,-1,0.8,0.2,0.5,3.141592653589793"));
        a.iter().zip(&b).map(|(a, b)| f64::midpoint(*a, *b)).collect::<Vec<f64>>()
    };
    let drawn = apart(&moved(&yaml, &[]), &moved(&ur5e(), &[]));
    let own = apart(&moved(&yaml, &[]), &moved(&urdf, &[]));
    assert!(own < 1e-9 && drawn > 1e-4, "{own:e} {drawn:e}");
}

#[test]
fn effects_are_used_again_and_ask_for_what_they_follow() {
    let (folder, report) = calibrated("thermal@elbow_joint=0.4mm", "temperature");
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
    let again = ["simulate", &ur5e, "--effects", &effects];
    assert!(
        denavit(&again)
            .failed()
            .ends_with("thermal follows \"temperature\"; record it with --columns \"temperature\"\n")
    );
    denavit(&[&again[..], &["--columns", "temperature"]].concat()).succeeded();
    let other = robot("universal_robots/ur10e.urdf");
    assert!(
        denavit(&["fk", &other, "--effects", &effects]).failed().contains("the effects are those of robot \"ur5e\"")
    );
    let other = robot("abb/irb120.urdf");
    assert!(
        denavit(&["fk", &other, "--effects", &effects]).failed().contains("the effects are for joints shoulder_pan")
    );
}

#[test]
fn poses_that_cannot_be_reached_are_named() {
    let folder = Folder::new();
    let poses = "x,y,z,roll,pitch,yaw\n400,200,500,180,0,0\n3000,0,0,0,0,0\n400,250,500,180,0,5\n";
    let file = folder.file("poses.csv", poses);
    let from = robot("universal_robots/ur5e_dh.csv");
    let arguments = ["compensate", &ur5e(), "--from", &from, "--poses", &file, "--units", "mm,deg"];
    // The table has names of its own for its joints.
    assert!(denavit(&arguments).failed().contains("--from"));
    let arguments = ["compensate", &ur5e(), "--poses", &file, "--units", "mm,deg"];
    let run = denavit(&arguments);
    assert_eq!(run.code, 1, "{}", run.stderr);
    snapshot("compensate_ur5e", &run.stdout);
    let out = folder.path("commands.csv");
    let run = denavit(&[&arguments[..], &["-o", &out]].concat());
    assert!(run.code == 1 && run.stdout.contains("line 3: out of reach"), "{}", run.stdout);
    assert!(std::fs::read_to_string(out).unwrap().contains("out of reach"));
}

#[test]
fn standard_input_gives_the_data_and_files_are_written_all_or_none() {
    let (folder, ur5e) = (Folder::new(), ur5e());
    let data = denavit(&["simulate", &ur5e, "--rows", "60"]).succeeded();
    let from_input = denavit_with_input(&["calibrate", &ur5e, "--data", "-", "--effects", "none"], &data).succeeded();
    assert!(from_input.contains("60 positions fitted"), "{from_input}");
    let file = folder.file("data.csv", &data);
    let outputs = |json: &str, html: &str| {
        let (json, html) = (folder.path(json), folder.path(html));
        denavit(&["calibrate", &ur5e, "--data", &file, "--effects", "none", "--html", &html, "--json", &json]).failed()
    };
    assert!(outputs("nowhere/r.json", "page.html").contains("there is no folder"));
    assert!(outputs("same", "same").contains("two outputs have this name"));
    assert_eq!(folder.names(), ["data.csv"]);
    let table = robot("universal_robots/ur5e_dh.csv");
    assert!(denavit(&["calibrate", &table, "--data", &file]).failed().contains("has no column"));
}

#[test]
fn bad_input_to_the_measuring_commands_gets_one_clear_message() {
    let (folder, ur5e) = (Folder::new(), ur5e());
    let nan = folder.file("nan.csv", &format!("{JOINTS}\n1,2,3,4,5,nan\n"));
    let few = folder.file("few.csv", &format!("{JOINTS}\n0,0,0,0,0,0\n"));
    let short = folder.file("short.csv", "shoulder_pan_joint,elbow\n1,2\n");
    let says = |arguments: &[&str], expected: &str| {
        let message = denavit(arguments).failed();
        assert!(message.starts_with("error: ") && message.contains(expected), "{arguments:?}: {message}");
    };
    let plan = |rest: &[&str], expected: &str| says(&[&["plan", &ur5e], rest].concat(), expected);
    plan(&["--count", "0"], "0 is not in 1..=65535");
    plan(&["--count", "2", "--candidates", &few], "only 1 of 1 candidates");
    plan(&["--count", "2000"], "only 1000 of 1000 candidates");
    plan(&["--count", "1", "--candidates", &nan], "nan.csv:2: column \"wrist_3_joint\": \"nan\" is not finite");
    plan(&["--count", "1", "--candidates", &short], "did you mean it by column \"elbow\"?");
    plan(&["--count", "1", "--box", "1,0,0,1,0,1"], "X0 = 1 is not below X1 = 0");
    plan(&["--count", "1", "--box", "0,1,0,nan,0,1"], "Y0 = 0 is not below Y1 = NaN");
    plan(&["--count", "1", "--box", "0,1,0"], "3 numbers where X0,X1,Y0,Y1,Z0,Z1 are six");
    plan(&["--count", "1", "--box", "5,6,5,6,5,6"], "only 0 of 1000 candidates");
    let simulate = |rest: &[&str], expected: &str| says(&[&["simulate", &ur5e], rest].concat(), expected);
    simulate(&["--effect", "rust@base=1mm"], "\"rust\" is no kind of effect; there are joint_scale");
    simulate(&["--effect", "backlash@elbow=1mm"], "backlash cannot act at \"elbow\"; it can at shoulder_pan_joint");
    simulate(&["--effect", "backlash@elbow_joint=nan"], "\"nan\" is no strength");
    simulate(&["--effect", "backlash"], "write KIND@PLACE=STRENGTH");
    simulate(&["--effect", "thermal@base=1mm"], "add --columns temperature");
    simulate(&["--effect", "backlash@elbow_joint:order=2=1mm"], "\"order\" cannot be set here");
    simulate(&["--columns", "humidity"], "\"humidity\" is no column that a run has");
    simulate(&["--noise", "-1"], "--noise: \"-1\" is not MM,MRAD");
    simulate(&["--outliers", "1.5"], "1.5 is no share");
    simulate(&["--targets", "2", "--measure", "poses"], "only positions are of several targets");
    simulate(&["--poses", &nan], "is not finite");
    let compensate = |rest: &[&str], expected: &str| says(&[&["compensate", &ur5e], rest].concat(), expected);
    compensate(&["--poses", &nan], "is not finite");
    compensate(&["--poses", &few, "--effects", &few], "not a file of effects");
    compensate(&["--poses", &few, "--allowed-miss", "x"], "invalid value 'x'");
    let place = folder.file("place.csv", "x,y,z\n0.4,0.2,0.5\n");
    compensate(&["--poses", &place], "column \"qx\" is missing beside \"x\"");
    let bent = folder.file("bent.csv", "x,y,z,qx,qy,qz,qw\n0.4,0.2,0.5,1,1,0,0\n");
    compensate(&["--poses", &bent], "the quaternion has length 1.414214, not 1");
    says(&["identify", &ur5e, "--data", &place], "joint values are needed here");
    says(&["identify", &ur5e, "--scales", "elbow"], "the chain has no joint \"elbow\"; write all, or of");
    says(&["fk", &ur5e, "--given", "payload=1"], "give --effects, too");
    says(&["calibrate", "-", "--data", "-"], "standard input (-) can be one file only");
}

#[test]
fn effects_written_by_hand_are_checked() {
    let folder = Folder::new();
    let file = |driver: &str, coefficients: &str| {
        let joints: Vec<String> = JOINTS.split(',').map(|joint| format!("\"{joint}\"")).collect();
        let effect = format!(
            "{{\"kind\": \"drift\", \"carrier\": \"target\", \"driver\": {driver}, \"coupling\": \"each\", \"coefficients\": [{coefficients}]}}"
        );
        let text = format!(
            "{{\"schema\": \"denavit.effects/1\", \"robot\": \"ur5e\", \"joints\": [{}], \"effects\": [{effect}]}}",
            joints.join(",")
        );
        folder.file("effects.json", &text)
    };
    let fk = |file: &str| denavit(&["fk", &ur5e(), "--effects", file, "--given", "time=3"]);
    let run = fk(&file("{\"covariate\": \"time\"}", "1e-3, 0, 0"));
    assert!(run.stderr.contains("drift at target changes what is measured, not where the tip is; left out"));
    assert_eq!(run.succeeded(), denavit(&["fk", &ur5e()]).succeeded());
    let message = fk(&file("{\"smooth\": {\"covariate\": \"time\", \"knots\": []}}", "1e-3, 0, 0")).failed();
    assert!(message.contains("effect 1 (drift): a number of its driver cannot be"), "{message}");
    let message = fk(&file("{\"covariate\": \"time\"}", "1e-3")).failed();
    assert!(message.contains("1 coefficients are given; give 3"), "{message}");
}

#[test]
fn kinematics_files_of_real_arms_are_sources() {
    let Some(vendor) = vendor() else { return };
    for file in crate::support::files(&vendor.join("ur_calibration"), "yaml") {
        let name = file.to_str().unwrap();
        let q = ["--q", "0.3,-1.1,0.8,0.2,0.5,0.4"];
        let plain = tip(&[&[name], &q[..]].concat());
        let vendors = tip(&[&[name, "--vendor-angles"], &q[..]].concat());
        let far = apart(&plain, &vendors);
        println!("{}: the order of angles moves the tip by {far:e} m", file.file_name().unwrap().display());
        assert!(far > 1e-8 && far < 60e-6, "{far:e}");
        let text = std::fs::read_to_string(Path::new(name)).unwrap();
        let from_input = json(&denavit_with_input(&["fk", "-", "--json", q[0], q[1]], &text).succeeded());
        assert!((from_input["xyz"][0].as_f64().unwrap() - plain[0]).abs() < 1e-15);
        assert!(denavit(&["identify", name]).succeeded().contains("= 30"));
    }
}
