//! Whether the tracer names the same causes if the same run is written in other ways.
//! `cargo run --release -p denavit-calibrate --example study_retold -- FOLDER [PART OF A NAME]`, a folder of blind cases made by
//! `tests/oracle/calibration/suite.py`.
//!
//! Each case is traced unchanged; with its rows in another order; with a meaningless column; in millimetres and degrees; with its training
//! and test rows exchanged; and, if a joint's reading is measured from the ground, with this coupling removed from the readings. Prints the
//! cases whose names differ, and a table.
#![allow(clippy::unwrap_used, clippy::print_stdout)] // A study prints, and stops at the first error.

use denavit_calibrate::IdentifyOptions;
use denavit_identify::effects::Statics;
use denavit_identify::effects::survey::with_run_order;
use denavit_identify::identify;
use denavit_measurements::{Measurements, Units, read, write};
use denavit_model::{Chain, Screw, tree::Reading};
use denavit_trace::{TraceOptions, trace};
use rand::seq::SliceRandom;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

type Names = BTreeSet<(String, String)>;

/// A case's robot, and the names of its joints in the truth.
struct Case {
    chain: Chain,
    statics: Statics,
    truth: serde_json::Value,
}

impl Case {
    fn rows(&self, text: &str, units: Units) -> Measurements {
        read("rows.csv", text.as_bytes(), &self.chain, units).unwrap_or_else(|error| panic!("{error}")).data
    }

    /// The causes that are named.
    fn names(&self, data: Measurements) -> Names {
        let data = with_run_order(data);
        let options = TraceOptions::new(IdentifyOptions::axes(&self.chain));
        let identification = identify(&self.chain, &data, &options.identify);
        let found = trace(&self.statics, &data, &identification.geometric, &options);
        let named = found.findings.into_iter().filter(|finding| finding.named);
        named.map(|finding| (finding.term.kind.name().to_string(), finding.place)).collect()
    }

    /// The joint whose reading is measured from the ground, and the joint that drives it.
    fn counts_from_ground(&self) -> Option<(String, String)> {
        let effects = self.truth["effects"].as_array()?;
        let whole = effects.iter().find(|effect| effect["shape"]["whole"] == true)?;
        let word = |value: &serde_json::Value| value.as_str().unwrap().to_string();
        Some((word(&whole["places"][0]), word(&whole["shape"]["driven_by"])))
    }
}

/// The table of a text: header and cells.
fn cells(written: &str) -> (Vec<String>, Vec<Vec<String>>) {
    let mut reader = csv::ReaderBuilder::new().comment(Some(b'#')).from_reader(written.as_bytes());
    let header = reader.headers().unwrap().iter().map(String::from).collect();
    (header, reader.records().map(|row| row.unwrap().iter().map(String::from).collect()).collect())
}

fn text(header: &[String], rows: &[Vec<String>]) -> String {
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(header).unwrap();
    for row in rows {
        writer.write_record(row).unwrap();
    }
    String::from_utf8(writer.into_inner().unwrap()).unwrap()
}

/// Multiplies a number column by a factor.
fn scaled(rows: &mut [Vec<String>], column: usize, factor: f64) {
    for row in rows {
        let value: f64 = row[column].parse().unwrap();
        row[column] = (value * factor).to_string();
    }
}

/// The same text in mm and degrees.
fn in_millimetres(case: &Case, written: &str) -> String {
    let (header, mut rows) = cells(written);
    for (column, name) in header.iter().enumerate() {
        let joint = case.chain.joints().iter().find(|joint| joint.name == *name);
        let length = |name: &str| {
            let word = name.trim_end_matches(|c: char| c.is_ascii_digit());
            ["x", "y", "z", "distance"].contains(&word)
        };
        match joint {
            Some(joint) if !matches!(joint.screw, Screw::Prismatic(_)) => {
                scaled(&mut rows, column, 1.0_f64.to_degrees());
            }
            Some(_) => scaled(&mut rows, column, 1e3),
            None if length(name) => scaled(&mut rows, column, 1e3),
            None => {}
        }
    }
    text(&header, &rows)
}

/// The same text with a meaningless column.
fn with_a_column(written: &str, random: &mut ChaCha8Rng) -> String {
    let (mut header, mut rows) = cells(written);
    header.push("humidity".into());
    for row in &mut rows {
        row.push(random.random_range(30.0..60.0_f64).to_string());
    }
    text(&header, &rows)
}

/// The same text with `joint` measured from the link before it: `times` the reading of `driven_by` added.
fn corrected(written: &str, joint: &str, driven_by: &str, times: f64) -> String {
    let (header, mut rows) = cells(written);
    let place = |name: &str| header.iter().position(|other| other == name).unwrap();
    let (joint, driven_by) = (place(joint), place(driven_by));
    for row in &mut rows {
        let [own, other] = [joint, driven_by].map(|column| row[column].parse::<f64>().unwrap());
        row[joint] = (own + times * other).to_string();
    }
    text(&header, &rows)
}

fn listed(names: &Names) -> String {
    let words: Vec<String> = names.iter().map(|(kind, place)| format!("{kind} at {place}")).collect();
    if words.is_empty() { "nothing".into() } else { words.join(", ") }
}

fn main() {
    let root = std::env::args().nth(1).unwrap();
    let only = std::env::args().nth(2);
    let mut folders: Vec<_> = std::fs::read_dir(&root).unwrap().map(|entry| entry.unwrap().path()).collect();
    folders.retain(|folder| folder.join("truth.json").exists());
    folders.sort();
    let mut table: BTreeMap<&str, (usize, usize)> = BTreeMap::new();
    for folder in folders {
        let name = folder.file_name().unwrap().to_string_lossy().to_string();
        if only.as_ref().is_some_and(|part| !name.contains(part.as_str())) {
            continue;
        }
        let file = |name: &str| std::fs::read_to_string(Path::new(&folder).join(name)).unwrap();
        let robot = denavit_model::urdf::read("nominal.urdf", &file("nominal.urdf")).unwrap();
        let chain = robot.chain(None, None, Reading::Intended).unwrap().value;
        let case = Case {
            statics: Statics::of(&robot, &chain),
            chain,
            truth: serde_json::from_str(&file("truth.json")).unwrap(),
        };
        let (train, test) = (file("train.csv"), file("test.csv"));
        let units = Units::default();
        let mut random = ChaCha8Rng::seed_from_u64(1);
        let as_it_is = case.rows(&train, units);
        let mut order: Vec<usize> = (0..as_it_is.len()).collect();
        order.shuffle(&mut random);
        let written = write(&as_it_is, &[]);
        let mut ways = vec![
            ("rows in another order", as_it_is.subset(&order)),
            ("a meaningless column", case.rows(&with_a_column(&written, &mut random), units)),
            ("mm and degrees", case.rows(&in_millimetres(&case, &written), "mm,deg".parse().unwrap())),
            ("training and test exchanged", case.rows(&test, units)),
        ];
        let truly = case.names(as_it_is);
        // The coupling is named with the controller's readings, and not after it was removed.
        let mut apart = truly.clone();
        if let Some((joint, driven_by)) = case.counts_from_ground() {
            apart.retain(|(kind, place)| (kind.as_str(), place) != ("joint_coupling", &joint));
            // The sign with the smaller misfit is right.
            let misfit = |data: &Measurements| {
                let options = IdentifyOptions::axes(&case.chain);
                identify(&case.chain, data, &options).geometric.noise.first()
            };
            let both = [1.0, -1.0].map(|times| case.rows(&corrected(&written, &joint, &driven_by, times), units));
            let [added, taken] = both;
            let data = if misfit(&added) < misfit(&taken) { added } else { taken };
            ways.push(("coupling removed", data));
        }
        for (way, data) in ways {
            let expected = if way == "coupling removed" { &apart } else { &truly };
            let found = case.names(data);
            let (cases, same) = table.entry(way).or_default();
            *cases += 1;
            if found == *expected {
                *same += 1;
            } else {
                println!("{name}, {way}: {} instead of {}", listed(&found), listed(expected));
            }
        }
    }
    println!("| change | files | same names |\n|---|---:|---:|");
    for (way, (cases, same)) in table {
        println!("| {way} | {cases} | {same} |");
    }
}
