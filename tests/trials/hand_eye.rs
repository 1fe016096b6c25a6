//! Hand-eye calibration from the command line.

use super::Trial;
use denavit_model::se3;
use serde_json::Value;
use std::fmt::Write as _;

/// Where the instrument is, and where the target is on the hand.
fn truth() -> [denavit_model::Pose; 2] {
    let base = se3::pose(se3::rotation_from_rpy([0.02, -0.01, 2.1]), [2.5, -1.1, 0.4].into());
    let tip = se3::pose(se3::rotation_from_rpy([0.1, 0.2, 0.3]), [0.02, -0.01, 0.12].into());
    [base, tip]
}

/// A file of pairs, rounded as people write them: 0.1 µm and 1e-7.
pub fn pairs(rows: usize) -> String {
    let [base, tip] = truth();
    let mut text = String::from("robot_x,robot_y,robot_z,robot_rx,robot_ry,robot_rz,x,y,z,qx,qy,qz,qw\n");
    for row in 0..rows {
        let k = row as f64;
        let turn = [(0.7 * k).sin(), 0.8 * (1.3 * k).cos(), 1.1 * (0.4 * k).sin()];
        let robot =
            se3::pose(se3::rotation_from_rpy(turn), [0.4 + 0.2 * (0.9 * k).sin(), 0.3 * (1.1 * k).cos(), 0.5].into());
        let seen = base.inverse() * robot * tip;
        let (place, vector) = (robot.translation.vector, se3::rotation_vector(&robot.rotation));
        let numbers = [place.x, place.y, place.z, vector.x, vector.y, vector.z].into_iter();
        let numbers =
            numbers.chain(seen.translation.vector.iter().copied()).chain(se3::quaternion_xyzw(&seen.rotation));
        let cells: Vec<String> = numbers.map(|number| format!("{number:.7}")).collect();
        let _ = writeln!(text, "{}", cells.join(","));
    }
    text
}

fn apart(value: &Value, name: &str, truth: &denavit_model::Pose) -> f64 {
    let xyz: Vec<f64> = serde_json::from_value(value[name]["xyz"].clone()).unwrap();
    (0..3).map(|k| (xyz[k] - truth.translation.vector[k]).abs()).fold(0.0, f64::max)
}

#[test]
fn both_places_come_out_of_pairs_of_poses() {
    let trial = Trial::new().with("pairs.csv", &pairs(20));
    let json: Value = serde_json::from_str(&trial.run("hand-eye --data pairs.csv --json").succeeded()).unwrap();
    let [base, tip] = truth();
    assert!(apart(&json, "base_from_instrument", &base) < 1e-6 && apart(&json, "tip_from_target", &tip) < 1e-6);
    assert_eq!((&json["arrangement"], &json["unknown"]), (&"instrument_stands".into(), &Value::Null));
    let text = trial.run("hand-eye --data pairs.csv").succeeded();
    assert!(text.contains("hand-eye calibration of 20 pairs of poses\ninstrument beside the robot"), "{text}");
    assert!(text.lines().all(|line| line.chars().count() <= 80), "{text}");
    // The other arrangement does not fit, and is refused.
    let wrong = trial.run("hand-eye --data pairs.csv --on-hand");
    assert_eq!(wrong.code, 2, "{}", wrong.stdout);
    assert!(wrong.stderr.contains("the motions of robot and instrument do not agree"), "{}", wrong.stderr);
    let launch = trial.run("hand-eye --data pairs.csv --format ros-launch --parent base_link --child cam").succeeded();
    assert!(launch.contains("--x 2.5") && launch.contains("--frame-id base_link --child-frame-id cam"), "{launch}");
    let urdf = trial.run("hand-eye --data pairs.csv --format urdf --child cam").succeeded();
    let robot = format!("<robot name=\"r\"><link name=\"base\"/>{urdf}</robot>");
    let fk = trial.with("r.urdf", &robot).run("chains r.urdf").succeeded();
    assert!(fk.contains("cam"), "{fk}");
}

#[test]
fn the_file_of_a_forum_gives_the_answer_beside_it() {
    let file = crate::support::top().join("../shared/wild/hand-eye-from-poses/poses.csv");
    if !file.is_file() {
        println!("skipped, because ../shared is not beside this clone");
        return;
    }
    let trial = Trial::new();
    let json: Value =
        serde_json::from_str(&trial.run(&format!("hand-eye --data {} --json", file.display())).succeeded()).unwrap();
    // What stands beside the file is instrument_from_base.
    let [beside, _] = truth();
    let moved = apart(&json, "base_from_instrument", &beside.inverse());
    let std: Vec<f64> = serde_json::from_value(json["base_from_instrument"]["std"].clone()).unwrap();
    let most = std.iter().take(3).copied().fold(0.0, f64::max);
    assert!(moved < 4.0 * most && moved < 2e-3, "{moved} {most}");
}

#[test]
fn what_is_wrong_is_named_with_its_place() {
    let trial = Trial::new().with("pairs.csv", &pairs(20)).with("no.csv", "x,y,z,qx,qy,qz,qw\n1,2,3,0,0,0,1\n");
    trial.refuses("hand-eye --data no.csv", "no.csv:1: column \"robot_x\" is missing; a pair of poses needs");
    trial.refuses("hand-eye --data pairs.csv --robot-angles XXY", "--robot-angles: \"XXY\" is not an order of angles");
    let two = pairs(2);
    let trial = trial.with("two.csv", &two);
    trial.refuses("hand-eye --data two.csv", "two.csv: 2 poses; hand-eye calibration needs 3 at least");
    // One axis only.
    let rows = "robot_x,robot_y,robot_z,robot_rx,robot_ry,robot_rz,x,y,z,rx,ry,rz\n";
    let turns =
        (0..12).map(|k| format!("0,0,0,0,0,{0},0,0,0,0,0,{0}\n", 0.2 * f64::from(k))).collect::<Vec<_>>().concat();
    let run = trial.with("scara.csv", &format!("{rows}{turns}")).run("hand-eye --data scara.csv");
    assert_eq!(run.code, 1, "{}", run.stderr);
    assert!(run.stdout.contains("WARNING: the hand turns about one axis only (0.00 0.00 1.00"), "{}", run.stdout);
}
