//! A ball in sockets: files without labels compared with one file with labels, and one fit with a tracker.

use super::Folder;
use crate::support::{Run, denavit_in, robot};
use denavit_calibrate::apply::compensate::{Wanted, compensate};
use denavit_ik::Solver;
use denavit_model::nalgebra::{Point3, Rotation3, Vector3};
use denavit_model::{Pose, Reading};
use std::fmt::Write as _;

const NAMES: &str = super::JOINTS;
const PLACES: [(&str, [f64; 3]); 4] = [
    ("front/0", [0.45, 0.15, 0.25]),
    ("front/1", [0.45, 0.20, 0.25]),
    ("left/0", [-0.10, 0.50, 0.40]),
    ("left/1", [-0.10, 0.50, 0.45]),
];

/// The arm as it was built: some lengths are off by a millimetre, some angles by a milliradian.
fn as_built() -> denavit_model::Chain {
    let drawn = std::fs::read_to_string(robot("universal_robots/ur5e.urdf")).unwrap();
    let built = drawn.replace("-0.425", "-0.4262").replace("-0.3922", "-0.3915").replace("0.1333", "0.1341");
    assert_ne!(drawn, built);
    denavit_model::urdf::read("built.urdf", &built).unwrap().chain(None, None, Reading::Intended).unwrap().value
}

/// Pseudo-random numbers between -1 and 1, the same in every run.
fn chance(seed: &mut u64) -> f64 {
    *seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*seed >> 11) as f64 / (1u64 << 52) as f64 - 1.0
}

/// Readings with the ball at this position, in a random orientation.
fn reaching(arm: &denavit_model::Chain, ball: &Point3<f64>, place: &Vector3<f64>, seed: &mut u64) -> Vec<f64> {
    loop {
        let mut draw = || 2.5 * chance(seed);
        let turn = Rotation3::new(Vector3::new(draw(), draw(), draw()));
        let near: Vec<f64> = (0..6).map(|_| draw()).collect();
        let pose = Pose::from_parts((place - turn * ball.coords).into(), turn);
        let found = compensate(&Solver::new(arm), arm, &|q| arm.fk(q), &Wanted::Pose(pose), &near).joints;
        if ((arm.fk(&found) * ball).coords - place).norm() < 1e-12 {
            return found;
        }
    }
}

fn line(numbers: &[f64]) -> String {
    numbers.iter().map(f64::to_string).collect::<Vec<_>>().join(",")
}

/// A folder with the drawn arm, the readings in each socket (`front_0.csv`, …, all of them in `sockets.csv`), and a tracker's
/// measurements of another target (`few.csv`, and `test.csv` as test data).
fn measured() -> Folder {
    let folder = Folder::new();
    std::fs::copy(robot("universal_robots/ur5e.urdf"), folder.path("arm.urdf")).unwrap();
    let (arm, mut seed) = (as_built(), 7);
    let mut all = format!("{NAMES},socket\n");
    for (label, place) in PLACES {
        let mut bare = String::new();
        for _ in 0..25 {
            // A socket locates the ball to a few hundredths of a millimetre.
            let seat = Vector3::from(place).map(|value| value + 2e-5 * chance(&mut seed));
            let q = reaching(&arm, &Point3::new(0.06, 0.03, 0.12), &seat, &mut seed);
            let _ = writeln!(bare, "{}", line(&q));
            let _ = writeln!(all, "{},{label}", line(&q));
        }
        folder.file(&format!("{}.csv", label.replace('/', "_")), &bare);
    }
    folder.file("sockets.csv", &all);
    for (name, rows) in [("few.csv", 9), ("test.csv", 60)] {
        let mut text = format!("{NAMES},x,y,z,setup\n");
        for _ in 0..rows {
            let q: Vec<f64> = (0..6).map(|_| 2.5 * chance(&mut seed)).collect();
            let seen = (arm.fk(&q) * Point3::new(-0.04, 0.02, 0.09)).coords + Vector3::new(2.0, 1.0, 0.5);
            let seen = seen.map(|value| value + 5e-5 * chance(&mut seed));
            let _ = writeln!(text, "{},{},tracker", line(&q), line(seen.as_slice()));
        }
        folder.file(name, &text);
    }
    folder
}

fn calibrate(folder: &Folder, words: &str) -> Run {
    let line = format!("calibrate arm.urdf --effects none {words}");
    denavit_in(folder.0.path(), &line.split_whitespace().collect::<Vec<_>>())
}

fn report(folder: &Folder, words: &str) -> serde_json::Value {
    super::json(&calibrate(folder, &format!("{words} --json")).succeeded())
}

const BARE: &str =
    "--socket front/0=front_0.csv --socket front/1=front_1.csv --socket left/0=left_0.csv --socket left/1=left_1.csv";
const KNOWN: &str = "--distance */0,*/1=50mm";

#[test]
fn bare_files_are_the_same_as_a_column_of_labels() {
    let folder = measured();
    let of = |words: &str| {
        let mut report = report(&folder, &format!("{words} {KNOWN} --hold-out-setups left"));
        for part in ["columns", "origin"] {
            report.as_object_mut().unwrap().remove(part);
        }
        // Another file has the same row in another line.
        for row in report["rows"].as_array_mut().unwrap() {
            row.as_object_mut().unwrap().remove("line");
        }
        report
    };
    let (bare, labelled) = (of(BARE), of("--data sockets.csv"));
    assert_eq!(bare, labelled);
    let spread = |stage: usize| bare["stages"][stage]["test"]["spread_rms_m"].as_f64().unwrap();
    assert!(spread(1) < 0.5 * spread(0), "{} {}", spread(0), spread(1));
    // One pair by name is one of the pairs of a pattern.
    let named = format!("{BARE} --distance front/0,front/1=50mm --distance left/0,left/1=50mm --hold-out-setups left");
    assert_eq!(report(&folder, &named)["stages"], bare["stages"]);
}

#[test]
fn sockets_and_a_tracker_are_one_fit() {
    let folder = measured();
    let rms = |words: &str| {
        let report = report(&folder, words);
        let stage = report["stages"].as_array().unwrap().iter().find(|stage| stage["name"] == "geometric").unwrap();
        (stage["test"]["position_rms_m"].as_f64().unwrap(), stage["train"].clone())
    };
    let (alone, _) = rms("--data few.csv --test test.csv");
    let (together, train) = rms(&format!("--data few.csv {BARE} {KNOWN} --test test.csv"));
    println!("held out positions: {alone:.2e} m by nine rows alone, {together:.2e} m with the sockets");
    assert!(together < 1.5e-4 && together < 0.6 * alone, "{alone} {together}");
    assert!(train["spread_rms_m"].is_number() && train["position_rms_m"].is_number(), "{train}");
}

#[test]
fn bad_words_and_files_of_sockets_get_one_message() {
    let folder = measured();
    let first = std::fs::read_to_string(folder.path("front_0.csv")).unwrap();
    let cell = first.split(',').nth(1).unwrap().to_owned();
    folder.file("word.csv", &first.replacen(&cell, "abc", 1));
    folder.file("short.csv", &first.replacen(&format!("{cell},"), "", 1));
    folder.file("empty.csv", "");
    for (words, said) in [
        ("--socket front/0=word.csv", "word.csv:1: "),
        ("--socket front/0=short.csv", "short.csv:1: the row has 5 values"),
        ("--socket front/0=empty.csv", "empty.csv: "),
        ("--socket front/0=none.csv", "none.csv"),
        ("--socket front_0.csv", "LABEL=FILE"),
        ("--data sockets.csv --distance front/0,front/1", "front/0,front/1"),
        ("--data sockets.csv --distance front/0,front/7=50mm", "front/7"),
        ("--data sockets.csv --distance front/0,front/1=50furlongs", "50furlongs"),
        ("--data sockets.csv --hold-out-setups behind", "behind"),
    ] {
        let run = calibrate(&folder, words);
        println!("{words}: {}", run.stderr);
        assert_eq!(run.code, 2, "{words}: {}", run.stderr);
        assert!(run.stderr.contains(said) && run.stderr.matches("error: ").count() == 1, "{words}: {}", run.stderr);
    }
}
