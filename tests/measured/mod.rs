//! Measuring, calibrating and compensating as a user does: simulated files in, models and commands out.

mod arms;
mod bad_input;
mod closed_loop;
mod contact;
mod exports;
#[cfg(feature = "calibrate")]
mod sockets;
mod watch;

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
fn the_measurements_of_the_project_are_made_as_it_says() {
    let text = std::fs::read_to_string(robot("README.md")).unwrap();
    let command = text.lines().find_map(|line| line.trim().strip_prefix("denavit simulate ")).unwrap();
    let folder = Folder::new();
    let (mut arguments, mut files) = (vec!["simulate".to_owned()], Vec::new());
    for word in command.split_whitespace() {
        if let Some(name) = word.strip_prefix("robots/").filter(|name| name.ends_with("csv")) {
            files.push((folder.path(&files.len().to_string()), robot(name)));
            arguments.push(files.last().unwrap().0.clone());
        } else {
            arguments.push(word.to_owned());
        }
    }
    denavit(&arguments.iter().map(String::as_str).collect::<Vec<_>>()).succeeded();
    assert_eq!(files.len(), 2);
    for (made, kept) in files {
        assert_eq!(std::fs::read_to_string(made).unwrap(), std::fs::read_to_string(kept).unwrap());
    }
}

#[test]
fn helps_of_the_measuring_commands() {
    for command in ["calibrate", "identify", "measure", "plan", "simulate", "compensate"] {
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
fn identify_says_what_a_measurement_file_can_determine() {
    let file = robot("universal_robots/ur5e_tracker.csv");
    let found = json(&denavit(&["identify", &ur5e(), "--data", &file, "--json"]).succeeded());
    assert_eq!(found["rows"], 120);
    for (kind, rank) in found["poe"].as_array().unwrap().iter().zip([30, 27, 24]) {
        assert_eq!((&kind["expected"], &kind["rank"]), (&rank.into(), &rank.into()));
    }
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
        for unidentifiable in kind["unidentifiable"].as_array().unwrap() {
            assert_eq!(unidentifiable["joint"], "elbow_joint");
            assert_eq!(unidentifiable["why"], "the joint never moves: its reading is 0.5 in every row");
        }
    }
    assert_eq!((&found["dh"]["redundant_in_base"], &found["dh"]["redundant_in_tool"]), (&4.into(), &2.into()));
    assert_eq!(found["dh"]["parallel_neighbours"][0][1], "elbow_joint");
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
        assert!(far > 1e-8 && far < 2e-4, "{far:e}");
        let text = std::fs::read_to_string(Path::new(name)).unwrap();
        let from_input = json(&denavit_with_input(&["fk", "-", "--json", q[0], q[1]], &text).succeeded());
        assert!((from_input["xyz"][0].as_f64().unwrap() - plain[0]).abs() < 1e-15);
        assert!(denavit(&["identify", name]).succeeded().contains("= 30"));
    }
}
