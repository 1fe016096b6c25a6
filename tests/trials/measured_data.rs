//! Files of measurements: errors are reported, unambiguous data are used, and nothing is counted twice.

use super::Trial;
use crate::support::{Run, robot, top};
use serde_json::Value;
use std::f64::consts::PI;
use std::path::PathBuf;
use std::time::Instant;

/// Rows of a file of measurements, its header apart.
fn cells(text: &str) -> (Vec<String>, Vec<Vec<String>>) {
    let mut lines = text.lines().filter(|line| !line.starts_with('#'));
    let split = |line: &str| line.split(',').map(str::to_owned).collect::<Vec<_>>();
    (split(lines.next().unwrap()), lines.map(split).collect())
}

/// The file with one cell of every row changed.
fn changed(text: &str, column: &str, change: impl Fn(f64) -> f64) -> String {
    let (names, mut rows) = cells(text);
    let at = names.iter().position(|name| name == column).unwrap();
    for row in &mut rows {
        row[at] = change(row[at].parse().unwrap()).to_string();
    }
    joined(&names, &rows)
}

fn joined(names: &[String], rows: &[Vec<String>]) -> String {
    let lines = std::iter::once(names.join(",")).chain(rows.iter().map(|row| row.join(",")));
    lines.map(|line| line + "\n").collect()
}

/// The folder of measured sets; if it is not beside this clone, prints that the test is skipped.
fn measured_by_others() -> Option<PathBuf> {
    let folder = top().join("../shared/measured");
    if folder.is_dir() {
        return Some(folder);
    }
    println!("skipped, because the measurements of others (../shared/measured) are not beside this clone");
    None
}

fn simulated(trial: &Trial, options: &str) -> String {
    trial.run(&format!("simulate arm.urdf -o simulated.csv {options}")).succeeded();
    trial.text("simulated.csv")
}

fn report(trial: &Trial, line: &str) -> Value {
    serde_json::from_str(&trial.run(&format!("calibrate arm.urdf --effects none --json {line}")).succeeded()).unwrap()
}

/// What happened to the data, in a few words: refused and why, or used and how.
fn treated(run: &Run) -> String {
    if run.code != 0 {
        return format!("refused: {}", run.stderr.lines().last().unwrap_or(""));
    }
    let attention = run.stdout.lines().find(|line| line.starts_with("ATTENTION"));
    let supposed = attention.and_then(|line| line.split_once(" if ")).map_or("", |(_, rest)| rest);
    format!("used: {}", supposed.split_once(": they fit").map_or(supposed, |(what, _)| what))
}

#[test]
fn exact_copies_count_once() {
    let trial = Trial::new();
    let once = simulated(&trial, "--rows 40 --seed 3");
    let (names, rows) = cells(&once);
    let twice = joined(&names, &[rows.clone(), rows.clone()].concat());
    let logged = joined(&names, &rows.iter().flat_map(|row| [row.clone(), row.clone()]).collect::<Vec<_>>());
    let trial = trial.with("once.csv", &joined(&names, &rows)).with("twice.csv", &twice).with("logged.csv", &logged);
    let of = |line: &str| report(&trial, line);
    let expected = of("--data once.csv");
    assert_eq!(expected["samples"]["copies"], Value::Null);
    for line in ["--data twice.csv", "--data logged.csv", "--data once.csv --data once.csv"] {
        let found = of(line);
        assert_eq!(found["samples"]["copies"].as_array().unwrap().len(), 40, "{line}");
        assert_eq!(found["samples"]["train"], 40);
        assert_eq!(found["stages"], expected["stages"], "{line}");
    }
    let said = trial.run("calibrate arm.urdf --data twice.csv --effects none").succeeded();
    assert!(said.contains("40 rows are exact copies of earlier ones and counted once, lines: 42, 43"), "{said}");
    // Fitted rows among the test rows.
    let more = simulated(&trial, "--rows 70 --seed 3");
    let (_, more) = cells(&more);
    let test = joined(&names, &[&rows[..5], &more[45..]].concat());
    let trial = trial.with("later.csv", &test);
    let found = report(&trial, "--data once.csv --test later.csv");
    assert_eq!(found["samples"]["test_copies"], serde_json::json!([2, 3, 4, 5, 6]));
    assert_eq!(found["samples"]["test"], 25);
    trial.refuses("calibrate arm.urdf --data once.csv --test twice.csv", "these are the rows of once.csv");
}

#[test]
fn a_posture_is_fitted_or_judges_and_never_both() {
    let trial = Trial::new();
    let (names, postures) = cells(&simulated(&trial, "--rows 12 --seed 4"));
    let joints = names.len() - 3;
    let mut rows = Vec::new();
    for time in 0..5 {
        for posture in &postures {
            let value = |(k, cell): (usize, &String)| {
                // Measured again: readings as an encoder repeats them, values with their noise.
                let noise = 1e-5 * f64::from((time * 31 + 7 * i32::try_from(k).unwrap()) % 11 - 5);
                let jitter = if k < joints { 1e-6 } else { noise };
                (cell.parse::<f64>().unwrap() + f64::from(time) * jitter).to_string()
            };
            rows.push(posture.iter().enumerate().map(value).collect::<Vec<_>>());
        }
    }
    let trial = trial.with("run.csv", &joined(&names, &rows));
    let found = report(&trial, "--data run.csv --hold-out 0.3");
    let held_out = |row: &Value| row["held_out"] == true;
    let entries = found["rows"].as_array().unwrap();
    let posture = |row: &Value| (row["line"].as_u64().unwrap() - 2) % 12;
    for row in entries.iter().filter(|row| held_out(row)) {
        let split = entries.iter().any(|other| posture(other) == posture(row) && !held_out(other));
        assert!(!split, "posture {} is fitted and judges", posture(row));
    }
    assert_eq!(entries.iter().filter(|row| held_out(row)).count(), 20);
}

#[test]
fn a_joint_that_counts_from_another_zero_is_corrected_at_every_number_of_rows() {
    let trial = Trial::new();
    let text = simulated(&trial, "--rows 200 --seed 6");
    let (names, rows) = cells(&text);
    for (joint, degrees) in [("elbow_joint", 90.0), ("wrist_1_joint", -37.2), ("shoulder_lift_joint", 120.0)] {
        for count in [14, 20, 28, 60, 200] {
            let some = changed(&joined(&names, &rows[..count]), joint, |angle| angle - degrees * PI / 180.0);
            std::fs::write(trial.path("run.csv"), some).unwrap();
            let run = trial.run("calibrate arm.urdf --data run.csv --effects none");
            let said = treated(&run);
            let expected = format!("used: \"{joint}\" counted from ");
            assert!(said.starts_with(&expected), "{joint} {degrees} of {count} rows: {said}");
            let found: f64 = said[expected.len()..].trim_end_matches('°').parse().unwrap();
            let off = (found - degrees).rem_euclid(360.0);
            assert!(off.min(360.0 - off) < 0.6, "{said}");
            assert!(run.stdout.starts_with("ATTENTION") && run.stderr.contains(&format!("into column \"{joint}\"")));
        }
    }
    let coupled = |row: &Vec<String>| {
        let mut row = row.clone();
        row[2] = (row[2].parse::<f64>().unwrap() + row[1].parse::<f64>().unwrap()).to_string();
        row
    };
    for count in [14, 28, 200] {
        let rows: Vec<Vec<String>> = rows[..count].iter().map(coupled).collect();
        std::fs::write(trial.path("run.csv"), joined(&names, &rows)).unwrap();
        let said = treated(&trial.run("calibrate arm.urdf --data run.csv --effects none"));
        assert!(said.starts_with("used: \"elbow_joint\" were measured from the ground"), "{count} rows: {said}");
    }
}

#[test]
fn two_joints_that_count_from_other_zeros_are_corrected() {
    let trial = Trial::new();
    let text = simulated(&trial, "--rows 40 --seed 8");
    let text = changed(&text, "elbow_joint", |angle| angle + 0.5 * PI);
    let text = changed(&text, "wrist_2_joint", |angle| angle - PI / 3.0);
    std::fs::write(trial.path("run.csv"), text).unwrap();
    let said = treated(&trial.run("calibrate arm.urdf --data run.csv --effects none"));
    assert!(
        said.contains("\"elbow_joint\" counted from -90°") && said.contains("\"wrist_2_joint\" counted from 60°"),
        "{said}"
    );
}

#[test]
fn data_that_explain_nothing_are_refused_however_little_is_left() {
    let trial = Trial::new();
    let near: String = std::iter::once(
        "shoulder_pan_joint,shoulder_lift_joint,elbow_joint,wrist_1_joint,wrist_2_joint,wrist_3_joint\n".to_owned(),
    )
    .chain((0..60).map(|row| {
        let cell = |k: u32| {
            let wave = (f64::from(row) * (1.3 + f64::from(k))).sin();
            format!("{}", [0.3, -1.2, 1.4, -1.0, -1.3, 0.4][k as usize] + 0.03 * wave)
        };
        (0..6).map(cell).collect::<Vec<_>>().join(",") + "\n"
    }))
    .collect();
    let trial = trial.with("near.csv", &near);
    trial.run("simulate arm.urdf --poses near.csv -o small.csv").succeeded();
    trial.run("calibrate arm.urdf --data small.csv --effects none").succeeded();
    let (names, rows) = cells(&trial.text("small.csv"));
    let shuffled: Vec<Vec<String>> =
        (0..60).map(|row| [&rows[row][..6], &rows[(7 * row + 3) % 60][6..]].concat()).collect();
    std::fs::write(trial.path("shuffled.csv"), joined(&names, &shuffled)).unwrap();
    trial.refuses("calibrate arm.urdf --data shuffled.csv --effects none", "explains nothing");
    // Radians and metres read as degrees and millimetres.
    let small = simulated(&trial, "--rows 40 --seed 2");
    std::fs::write(trial.path("si.csv"), small).unwrap();
    let said = "if all angles were in rad and all lengths were in m";
    trial.refuses("calibrate arm.urdf --data si.csv --units mm,deg --effects none", said);
}

#[test]
fn the_convention_of_an_orientation_is_proposed() {
    let trial = Trial::new();
    let (names, rows) = cells(&simulated(&trial, "--rows 40 --seed 5 --measure poses"));
    let at = names.iter().position(|name| name == "qx").unwrap();
    let vector = |row: &Vec<String>| {
        let q: Vec<f64> = row[at..at + 4].iter().map(|cell| cell.parse().unwrap()).collect();
        let length = (q[0] * q[0] + q[1] * q[1] + q[2] * q[2]).sqrt();
        let angle = 2.0 * length.atan2(q[3]);
        let angle = if angle > PI { angle - 2.0 * PI } else { angle };
        let turned = (0..3).map(|k| (q[k] / length * angle).to_string());
        row[..at].iter().cloned().chain(turned).collect::<Vec<_>>()
    };
    let rows: Vec<Vec<String>> = rows.iter().map(vector).collect();
    let names = [&names[..at], &["rx", "ry", "rz"].map(String::from)[..]].concat();
    let trial = trial.with("run.csv", &joined(&names, &rows));
    trial.run("calibrate arm.urdf --data run.csv --rotation-vector --effects none").succeeded();
    for order in ["XYZ", "xyz", "ZYX", "zxz"] {
        trial.refuses(
            &format!("calibrate arm.urdf --data run.csv --euler {order} --effects none"),
            "use --rotation-vector",
        );
    }
    // The same numbers as angles of fixed axes.
    let trial = trial.with("small.csv", &joined(&names, &rows));
    let said = trial.run("calibrate arm.urdf --data small.csv --euler YZX --effects none").failed();
    assert!(said.contains("within") && said.contains("mrad"), "{said}");
}

#[test]
fn numbers_that_are_too_large_are_one_error() {
    let trial = Trial::new();
    let text = simulated(&trial, "--rows 30 --seed 1 --columns temperature,time");
    let (names, rows) = cells(&text);
    for number in ["1e100", "-1e200", "1e308"] {
        for column in 0..names.len() {
            let mut rows = rows.clone();
            rows[4][column] = number.into();
            std::fs::write(trial.path("run.csv"), joined(&names, &rows)).unwrap();
            let begun = Instant::now();
            let said = trial.run("calibrate arm.urdf --data run.csv --effects none").failed();
            let column = &names[column];
            let wanted = format!("run.csv:6: column \"{column}\": {number} is larger than anything that is measured");
            assert!(said.contains(&wanted) && said.lines().count() == 1, "{column}: {said}");
            assert!(begun.elapsed().as_secs() < 10, "{column} took {:?}", begun.elapsed());
        }
    }
    let wide = |line: &str| (0..200_000).map(|k| format!("{line}{k}")).collect::<Vec<_>>().join(",");
    let trial = trial.with("wide.csv", &format!("{}\n{}\n", wide("c"), wide("1")));
    let begun = Instant::now();
    trial.refuses("calibrate arm.urdf --data wide.csv", "200000 columns");
    assert!(begun.elapsed().as_secs() < 20, "{:?}", begun.elapsed());
}

#[test]
fn whatever_is_not_known_is_carried_or_reported_in_every_position() {
    let trial = Trial::new();
    let (names, rows) = cells(&simulated(&trial, "--rows 20 --seed 1"));
    let used = |text: &str| {
        std::fs::write(trial.path("run.csv"), text).unwrap();
        let run = trial.run("calibrate arm.urdf --data run.csv --effects none");
        (run.code, format!("{}{}", run.stdout, run.stderr))
    };
    for column in 0..=names.len() {
        // Unknown columns of numbers and of texts.
        for value in ["7.25", "blau"] {
            let with = |row: &Vec<String>, cell: &str| {
                let mut row = row.clone();
                row.insert(column, cell.into());
                row
            };
            let more: Vec<Vec<String>> = rows.iter().map(|row| with(row, value)).collect();
            let (code, said) = used(&joined(&with(&names, "zorp"), &more));
            assert!(code == 0 && said.contains("zorp ("), "{column} {value}: {said}");
        }
        if column == names.len() {
            continue;
        }
        // A meaningless cell, an unknown unit, a misspelt name.
        let mut odd = rows.clone();
        odd[3][column] = "zorp".into();
        let (code, said) = used(&joined(&names, &odd));
        assert!(code == 2 && said.contains("run.csv:5:") && said.contains("zorp"), "{column}: {said}");
        let mut units = names.clone();
        units[column] = format!("{} [zorp]", names[column]);
        let (code, said) = used(&joined(&units, &rows));
        assert!(code == 2 && said.contains("zorp"), "{column}: {said}");
        let mut named = names.clone();
        named[column] = "zorp".into();
        let (code, said) = used(&joined(&named, &rows));
        assert!(code == 2 && said.contains(&format!("\"{}\"", names[column])), "{column}: {said}");
    }
    for (row, line) in [(0, 2), (9, 11), (19, 21)] {
        let mut longer = rows.clone();
        longer[row].push("zorp".into());
        let (code, said) = used(&joined(&names, &longer));
        assert!(code == 2 && said.contains(&format!("run.csv:{line}")), "{row}: {said}");
    }
    let (code, said) = used(&format!("zorp of the day;;\n{}", joined(&names, &rows)));
    assert!(code == 2 || said.contains("zorp of the day"), "{said}");
    let (code, said) = used(&joined(
        &[&names[..], &["temperature [F]".to_owned()]].concat(),
        &rows.iter().map(|row| [&row[..], &["70".to_owned()]].concat()).collect::<Vec<_>>(),
    ));
    assert!(code == 2 && said.contains("the unit \"F\" is not known"), "{said}");
}

#[test]
fn an_instrument_that_was_moved_before_the_test_is_named() {
    let trial = Trial::new();
    trial.run("simulate arm.urdf --rows 60 --seed 5 -o run.csv --test later.csv").succeeded();
    let text = changed(&trial.text("later.csv"), "x", |x| x + 0.031);
    std::fs::write(trial.path("moved.csv"), changed(&text, "z", |z| z - 0.012)).unwrap();
    let run = trial.run("calibrate arm.urdf --data run.csv --test moved.csv --effects none");
    assert!(run.stderr.contains("moved before them: instrument (by 33.2"), "{}", run.stderr);
    let said = run.succeeded();
    assert!(said.starts_with("ATTENTION: the test rows are evaluated as if"), "{said}");
    let found = report(&trial, "--data run.csv --test moved.csv");
    let errors = |found: &Value| found["stages"][1]["test"]["position_rms_m"].as_f64().unwrap();
    let as_it_was = errors(&report(&trial, "--data run.csv --test later.csv"));
    assert!(errors(&found) < 1.2 * as_it_was, "{} {as_it_was}", errors(&found));
    assert_eq!(found["placed_anew"]["moved"][0]["what"], "instrument");
}

/// A lifting column that tilts in its guide, with accelerometers on it: the tilt is named, and the error at other postures falls to a
/// quarter.
#[test]
fn the_recorded_tilt_of_a_real_lifting_column_is_named() {
    let Some(folder) = measured_by_others() else { return };
    let folder = folder.join("hilti_jaibot");
    let trial = Trial::new();
    let (names, rows) = cells(&std::fs::read_to_string(folder.join("flat.csv")).unwrap());
    let [fitted, others] = [true, false].map(|fitted| {
        rows.iter().enumerate().filter(|(k, _)| (k % 5 == 0) == fitted).map(|(_, row)| row.clone()).collect::<Vec<_>>()
    });
    std::fs::write(trial.path("fitted.csv"), joined(&names, &fitted)).unwrap();
    std::fs::write(trial.path("others.csv"), joined(&names, &others)).unwrap();
    let robot = folder.join("trailblazer.urdf");
    let run = trial.run(&format!("calibrate {} --data fitted.csv --test others.csv --json", robot.display()));
    let found: Value = serde_json::from_str(&run.succeeded()).unwrap();
    let stages = found["stages"].as_array().unwrap();
    let error = |name: &str| {
        let stage = stages.iter().find(|stage| stage["name"] == name).unwrap();
        stage["test"]["position_rms_m"].as_f64().unwrap()
    };
    assert!(error("averaged") < 0.25 * error("geometric"), "{} {}", error("averaged"), error("geometric"));
    let named = |effect: &Value| {
        effect["kind"] == "tilt" && effect["joint"] == "column_middle_joint" && effect["covariate"] == "tilt_column_x"
    };
    assert!(found["effects"].as_array().unwrap().iter().any(named), "{}", found["effects"]);
}

/// Draws of rows from real robots are treated alike, whichever rows they are.
#[test]
fn draws_of_few_rows_from_real_robots_are_treated_alike() {
    let Some(folder) = measured_by_others() else { return };
    let at = |name: &str| folder.join(name).to_str().unwrap().to_owned();
    let trial = Trial::new();
    let sets = [
        (at("motoman_dual/motoman_right.csv"), at("motoman_dual/right_august2019.csv"), "m,rad"),
        (at("jacobi_wam/robot_dh.csv"), at("jacobi_wam/grid.csv"), "mm,deg"),
    ];
    for (arm, data, units) in sets {
        let (names, rows) = cells(&std::fs::read_to_string(&data).unwrap());
        let mut state = 1u64;
        let mut treatments: Vec<String> = Vec::new();
        for _ in 0..30 {
            let mut left: Vec<usize> = (0..rows.len()).collect();
            let drawn: Vec<Vec<String>> = (0..28)
                .map(|_| {
                    state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
                    let at = usize::try_from(state >> 33).unwrap() % left.len();
                    rows[left.swap_remove(at)].clone()
                })
                .collect();
            std::fs::write(trial.path("drawn.csv"), joined(&names, &drawn)).unwrap();
            let run = trial.run(&format!("calibrate {arm} --data drawn.csv --units {units} --effects none"));
            treatments.push(treated(&run));
        }
        let first = treatments[0].clone();
        let others: Vec<&String> = treatments.iter().filter(|other| **other != first).collect();
        println!("{data}: {first}; {} of 30 otherwise: {others:?}", others.len());
        assert!(others.is_empty(), "{data}: {first}; {others:?}");
    }
}

#[test]
fn what_was_met_in_the_wild_is_said_rightly() {
    let folder = top().join("../shared/wild");
    if !folder.is_dir() {
        println!("skipped, because the files met in the wild (../shared/wild) are not beside this clone");
        return;
    }
    let arm = robot("universal_robots/ur5e.urdf");
    let at = |name: &str| folder.join(name).to_str().unwrap().to_owned();
    let trial = Trial::new();
    let run =
        |data: &str, options: &str| trial.run(&format!("calibrate {arm} --data {} --effects none {options}", at(data)));
    let zero = run("large-joint-zeros/ur_elbow_90.csv", "");
    assert!(treated(&zero).starts_with("used: \"elbow_joint\" counted from 90°"), "{}{}", zero.stdout, zero.stderr);
    for order in ["xyz", "XYZ", "ZYX"] {
        let said = run("orientation-convention/rotvec.csv", &format!("--euler {order}")).failed();
        assert!(said.contains("use --rotation-vector"), "{said}");
    }
    // The columns rz, ry, rx in the order ZYX are the same rotation.
    for options in ["--rotation-vector", "--euler XYZ"] {
        let said = run("orientation-convention/xyz_fixed.csv", options).failed();
        assert!(said.contains("use --euler xyz"), "{said}");
    }
    let said = run("units-not-stated/rad_m_40.csv", "--units mm,deg").failed();
    assert!(said.contains("all angles were in rad and all lengths were in m"), "{said}");
    let said = run("units-not-stated/small_shuffled.csv", "").failed();
    assert!(said.contains("explains nothing"), "{said}");
}

#[test]
fn joint_values_are_taken_as_a_list_and_degrees_are_suspected() {
    let trial = Trial::new();
    let bare = trial.run("fk arm.urdf --q 0,-1.57,0.2,0,0,1").succeeded();
    let arguments = ["fk", "arm.urdf", "--q", "[0, -1.57, 0.2, 0, 0, 1]"];
    assert_eq!(crate::support::denavit_in(trial.folder(), &arguments).succeeded(), bare);
    assert!(bare.contains("\nrotation vector  "), "{bare}");
    let run = trial.run("fk arm.urdf --q 0,-10,10,0,0,0");
    assert!(run.stderr.contains("looks like degrees; for degrees add --degrees"), "{}", run.stderr);
}

#[test]
fn poses_to_reach_may_be_written_as_a_rotation_vector_or_as_angles() {
    let trial = Trial::new();
    let quaternions = "x,y,z,qx,qy,qz,qw\n0.3,0.2,0.4,0.6,0,0.8,0\n-0.4,0.3,0.35,0,0,0,1\n";
    let vectors = format!("x,y,z,rx,ry,rz\n0.3,0.2,0.4,{},0,{}\n-0.4,0.3,0.35,0,0,0\n", 0.6 * PI, 0.8 * PI);
    let trial = trial.with("q.csv", quaternions).with("v.csv", &vectors);
    let numbers = |said: &str| -> Vec<f64> {
        let (_, rows) = cells(said);
        rows.iter().flatten().filter_map(|cell| cell.parse::<f64>().ok()).collect()
    };
    let expected = numbers(&trial.run("compensate arm.urdf --poses q.csv").stdout);
    let found = numbers(&trial.run("compensate arm.urdf --poses v.csv --rotation-vector").stdout);
    assert!(expected.len() >= 12 && expected.len() == found.len(), "{expected:?} {found:?}");
    assert!(expected.iter().zip(&found).all(|(a, b)| (a - b).abs() < 1e-6), "{expected:?} {found:?}");
    trial.refuses("compensate arm.urdf --poses v.csv", "qx");
}
