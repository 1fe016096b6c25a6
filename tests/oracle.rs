//! Forward kinematics against programs that we did not write: yourdfpy, pinocchio and a numpy reading of URDF.
//!
//! `tests/run` makes the poses (`tests/oracle/fk.py`) and names their file in `DENAVIT_ORACLE`.

use denavit_dh::convert::{HAYATI_BELOW, table};
use denavit_dh::{Convention, Gauge, NearParallel, Options, Parallelism, Table, conventions};
use denavit_export::{Sheet, Units, formats, sources};
use denavit_model::nalgebra::{Matrix3, Rotation3, Vector3};
use denavit_model::se3::{self, Pose};
use denavit_model::{Chain, Reading, Robot};
use std::collections::BTreeMap;

struct Sample {
    q: Vec<f64>,
    pose: Pose,
}

/// Poses of one chain.
struct Witness {
    file: String,
    base: String,
    tip: String,
    joints: Vec<String>,
    samples: Vec<Sample>,
}

fn witnesses() -> Option<Vec<Witness>> {
    let Ok(path) = std::env::var("DENAVIT_ORACLE") else {
        println!("skipped, because DENAVIT_ORACLE names no file of poses; tests/run makes it");
        return None;
    };
    let text = std::fs::read_to_string(&path).unwrap();
    let mut found: BTreeMap<(String, String, String), Witness> = BTreeMap::new();
    for line in text.lines() {
        let record: serde_json::Value = serde_json::from_str(line).unwrap();
        let Some(pose) = record.get("pose").and_then(|pose| pose.as_array()) else { continue };
        let number = |value: &serde_json::Value| value.as_f64().unwrap();
        let m: Vec<f64> = pose.iter().map(number).collect();
        let rotation = Rotation3::from_matrix_unchecked(Matrix3::from_fn(|row, column| m[4 * row + column]));
        let text = |key: &str| record[key].as_str().unwrap().to_owned();
        let key = (text("file"), text("base"), text("tip"));
        let joints = record["joints"].as_array().unwrap().iter().map(|name| name.as_str().unwrap().to_owned());
        let witness = found.entry(key.clone()).or_insert_with(|| Witness {
            file: key.0,
            base: key.1,
            tip: key.2,
            joints: joints.collect(),
            samples: Vec::new(),
        });
        let q = record["q"].as_array().unwrap().iter().map(number).collect();
        witness.samples.push(Sample { q, pose: se3::pose(rotation, Vector3::new(m[3], m[7], m[11])) });
    }
    Some(found.into_values().collect())
}

/// m and rad.
const TOLERANCE: f64 = 1e-9;

/// Agreement of one way to compute poses with the oracle.
#[derive(Default)]
struct Agreement {
    turned: Vec<f64>,
    moved: Vec<f64>,
    /// Poses of tables whose lengths are too large for 1e-9 m in f64: the tolerance is the rounding at these lengths.
    beyond: usize,
}

impl Agreement {
    /// `greatest`: the largest length that `found` is computed from, m.
    fn add(&mut self, found: &Pose, expected: &Pose, greatest: f64) {
        let (turned, moved) = se3::difference(found, expected);
        let rounding = 64.0 * f64::EPSILON * greatest;
        if moved > TOLERANCE && moved <= rounding {
            self.beyond += 1;
            return;
        }
        self.turned.push(turned);
        self.moved.push(moved);
    }

    fn report(&mut self, name: &str) {
        let quantiles = |values: &mut Vec<f64>| {
            values.sort_by(f64::total_cmp);
            let at = |part: f64| values[((values.len() - 1) as f64 * part) as usize];
            (at(0.5), at(0.99), at(1.0))
        };
        let (median, most, worst) = quantiles(&mut self.moved);
        println!("{name}: {} poses, m: median {median:.1e}, 99 % {most:.1e}, largest {worst:.1e}", self.moved.len());
        let (_, _, turned) = quantiles(&mut self.turned);
        if self.beyond > 0 {
            println!("{name}: {} more poses agree to the rounding at the table's longest number only", self.beyond);
        }
        assert!(worst < TOLERANCE && turned < TOLERANCE, "{name}: {worst:e} m, {turned:e} rad");
    }
}

/// The joint vector in our order of coordinates.
fn ordered(chain: &Chain, witness: &Witness, q: &[f64]) -> Vec<f64> {
    let value = |name: &str| witness.joints.iter().position(|joint| joint == name).map(|index| q[index]);
    chain
        .coordinates()
        .iter()
        .map(|coordinate| {
            value(&coordinate.name).unwrap_or_else(|| panic!("{}: no value for {}", witness.file, coordinate.name))
        })
        .collect()
}

fn tables(chain: &Chain) -> Vec<(&'static str, Convention, Table)> {
    // Axes half a nanoradian from parallel move a tip by less than the oracle's tolerance; kilometres of d by more.
    let exact = Options { parallelism: Parallelism::Within { angle: 5e-10 }, ..Options::default() };
    let paper = Options { gauge: Gauge::Paper, ..exact };
    let hayati = Options { near_parallel: NearParallel::HayatiBelow(HAYATI_BELOW), ..exact };
    let made = |options| table(chain, &options).unwrap().value;
    vec![
        ("distal", Convention::Distal, made(exact)),
        ("proximal", Convention::Proximal, made(exact)),
        ("paper", Convention::Paper, made(paper)),
        ("hayati", Convention::Hayati, made(hayati)),
    ]
}

#[test]
fn every_chain_of_every_file_moves_as_the_oracle_says() {
    let Some(witnesses) = witnesses() else { return };
    let mut poe = Agreement::default();
    let mut by_convention: BTreeMap<&str, Agreement> = BTreeMap::new();
    let mut read_back: BTreeMap<&str, Agreement> = BTreeMap::new();
    let mut robots: BTreeMap<String, Robot> = BTreeMap::new();
    let mut longest = 0.0f64;
    for witness in &witnesses {
        let robot = robots.entry(witness.file.clone()).or_insert_with(|| {
            let text = std::fs::read_to_string(&witness.file).unwrap();
            denavit_model::urdf::read(&witness.file, &text).unwrap_or_else(|error| panic!("{error}"))
        });
        let chain = robot.chain(Some(&witness.base), Some(&witness.tip), Reading::AsWritten).unwrap().value;
        for sample in &witness.samples {
            poe.add(&chain.fk(&ordered(&chain, witness, &sample.q)), &sample.pose, 0.0);
        }
        for (name, convention, table) in tables(&chain) {
            longest = longest.max(table.greatest_length());
            let rows = table.convention_rows(convention);
            let sheet = Sheet { table: &table, convention, units: Units::default(), notes: &[], source: "", gauge: "" };
            let again: Vec<(&str, Chain)> = ["csv", "json"]
                .into_iter()
                .map(|format| {
                    let text = (formats::named(format).unwrap().render)(&sheet).unwrap();
                    (format, sources::read("table", &text, sources::Stated::default()).unwrap().chain().unwrap())
                })
                .collect();
            for sample in &witness.samples {
                let q = ordered(&chain, witness, &sample.q);
                let values: Vec<f64> = table.joints.iter().map(|joint| joint.scale * q[joint.coordinate]).collect();
                let found = conventions::fk_of_rows(convention, &rows, &table.joints, &values);
                by_convention.entry(name).or_default().add(&found, &sample.pose, table.greatest_length());
                for (format, again) in &again {
                    read_back.entry(format).or_default().add(
                        &again.fk(&ordered(again, witness, &sample.q)),
                        &sample.pose,
                        table.greatest_length(),
                    );
                }
            }
        }
    }
    println!("{} files, {} chains", robots.len(), witnesses.len());
    poe.report("screw axes");
    for (name, agreement) in by_convention.iter_mut().chain(&mut read_back) {
        agreement.report(name);
    }
    println!("the longest number in a table as written: {longest:.1e} m");
}
