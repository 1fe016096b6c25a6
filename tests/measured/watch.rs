//! `denavit measure` beside a file that grows.

use super::{Folder, ur5e};
use crate::support::{denavit, denavit_with_input, program};
use serde_json::Value;
use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::process::{Command, Stdio};

/// A simulated run and its lines: the header first.
fn simulated(rows: &str) -> (Folder, Vec<String>) {
    let folder = Folder::new();
    denavit(&["simulate", &ur5e(), "--rows", rows, "--seed", "3", "-o", &folder.path("all.csv")]).succeeded();
    let text = std::fs::read_to_string(folder.path("all.csv")).unwrap();
    let lines = text.lines().filter(|line| !line.starts_with('#')).map(|line| format!("{line}\n")).collect();
    (folder, lines)
}

/// The line with its last number, a z in metres, larger by so much.
fn raised(line: &str, by: f64) -> String {
    let (rest, z) = line.trim_end().rsplit_once(',').unwrap();
    format!("{rest},{}\n", z.parse::<f64>().unwrap() + by)
}

#[cfg(unix)]
#[test]
fn rows_are_judged_while_the_file_grows() {
    let (folder, lines) = simulated("24");
    let path = folder.path("run.csv");
    let mut child = program(std::path::Path::new("."))
        .args(["measure", &ur5e(), "--data", &path, "--watch", "--json", "--spread", "50"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut out = BufReader::new(child.stdout.take().unwrap()).lines();
    let mut next = || serde_json::from_str::<Value>(&out.next().unwrap().unwrap()).unwrap();
    let append = |text: &str| {
        let mut file = std::fs::OpenOptions::new().create(true).append(true).open(&path).unwrap();
        file.write_all(text.as_bytes()).unwrap();
    };
    // The file is not there yet; then a header; then rows, one of them in two pieces.
    append(&lines[0]);
    append(&lines[1..4].concat());
    for row in 1..4 {
        assert_eq!((next()["row"].as_u64(), row), (Some(row), row));
    }
    let (first, second) = lines[4].split_at(20);
    append(first);
    std::thread::sleep(std::time::Duration::from_millis(300));
    append(second);
    assert_eq!(next()["row"], 4);
    for (row, line) in lines.iter().enumerate().take(20).skip(5) {
        append(line);
        let status = next();
        assert_eq!((&status["row"], &status["out_of_line"]), (&row.into(), &Value::Null), "{status}");
    }
    append(&raised(&lines[20], 0.01));
    let status = next();
    assert_eq!((&status["line"], &status["lines_out_of_line"][0]), (&21.into(), &21.into()), "{status}");
    assert!(status["out_of_line"]["rows"] == 1, "{status}");
    // Taken back: the file is another, and its rows are taken anew.
    std::fs::write(&path, lines[..20].concat()).unwrap();
    for row in 1..20 {
        let status = next();
        assert_eq!((&status["row"], &status["restarts"]), (&row.into(), &1.into()), "{status}");
    }
    Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(0));
    let mut said = String::new();
    child.stderr.take().unwrap().read_to_string(&mut said).unwrap();
    assert!(said.contains("the file is shorter than before; all its rows are read again"), "{said}");
}

#[test]
fn a_whole_file_and_standard_input_end_by_themselves() {
    let (folder, mut lines) = simulated("20");
    let whole = folder.file("run.csv", &lines.concat());
    let run = denavit(&["measure", &ur5e(), "--data", &whole, "--spread", "50", "--json", &folder.path("run.json")]);
    assert_eq!((run.code, run.stdout.lines().count()), (0, 20), "{}", run.stderr);
    assert!(run.stdout.lines().last().unwrap().contains("of 24 parameters known"), "{}", run.stdout);
    let written = std::fs::read_to_string(folder.path("run.json")).unwrap();
    assert_eq!(written.lines().count(), 20);
    lines[17] = raised(&lines[17], 0.02);
    let run = denavit_with_input(&["measure", &ur5e(), "--data", "-", "--spread", "50"], &lines.concat());
    assert_eq!(run.code, 1, "{}{}", run.stdout, run.stderr);
    let out: Vec<&str> = run.stdout.lines().filter(|line| line.contains("DOES NOT FIT")).collect();
    assert!(out.len() == 1 && out[0].starts_with("line 18: DOES NOT FIT, 2"), "{out:?}");
}

#[test]
fn what_cannot_be_watched_is_refused() {
    let (folder, lines) = simulated("12");
    let refused = |data: &str, more: &[&str], expected: &str| {
        let run = denavit(&[&["measure", &ur5e(), "--data", data], more].concat());
        assert_eq!(run.code, 2, "{}{}", run.stdout, run.stderr);
        assert!(run.stderr.contains(expected), "{}", run.stderr);
    };
    refused("run.xlsx", &[], "run.xlsx: a workbook does not grow row by row");
    refused("run.mcap", &["--watch"], "run.mcap: a bag does not grow row by row");
    refused(&folder.file("empty.csv", &lines[0]), &[], "there are no rows below the header");
    let wide = lines[2].replacen(',', ",1,", 1);
    let bad = folder.file("bad.csv", &[&lines[0], &lines[1], &wide].map(String::as_str).concat());
    refused(&bad, &["--watch"], "bad.csv:3: ");
    refused(&folder.path("none.csv"), &[], "none.csv");
}

#[test]
fn a_robot_that_was_calibrated_before_is_judged_from_the_first_rows() {
    let (folder, lines) = simulated("40");
    let [first, later] = [("first.csv", 1..29), ("later.csv", 29..41)]
        .map(|(name, rows)| folder.file(name, &format!("{}{}", lines[0], lines[rows].concat())));
    let known = folder.path("known.json");
    denavit(&["calibrate", &ur5e(), "--data", &first, "--effects", "none", "--json", &known]).succeeded();
    let judged = |more: &[&str]| {
        let run = denavit(&[&["measure", &ur5e(), "--data", &later, "--spread", "50", "--json"], more].concat());
        assert_eq!(run.code, 0, "{}{}", run.stdout, run.stderr);
        let rows = run.stdout.lines().map(|line| serde_json::from_str::<Value>(line).unwrap());
        rows.filter(|row| row["judged"] == true).count()
    };
    let (alone, with) = (judged(&[]), judged(&["--prior", &known]));
    assert!(with >= alone + 3, "{with} of 12 rows judged with what was known, {alone} without");
}
