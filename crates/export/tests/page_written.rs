//! Pages of known robots, written to target/oracle/pages with what forward kinematics says: `tests/oracle/page` opens them
//! in a browser and moves their sliders.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test fails by panicking and says what it skips")]

use denavit_dh::{Options, convert};
use denavit_export::Units;
use denavit_export::page::{Card, ChainPart, Document, html, index, markdown};
use denavit_model::tree::Reading;
use denavit_model::{Chain, examples, se3, urdf};
use std::fs;
use std::path::{Path, PathBuf};

fn workspace() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn part(chain: Chain, mut notes: Vec<denavit_model::Note>) -> ChainPart {
    let table = convert::table(&chain, &Options::default()).unwrap();
    notes.extend(table.notes);
    ChainPart { chain, table: table.value, notes, gauge: "The fewest numbers that are not zero.".into() }
}

fn of_example(chain: Chain) -> Document {
    Document {
        main: part(chain, Vec::new()),
        others: Vec::new(),
        robot: None,
        source: "examples".into(),
        fingerprint: Some("example".into()),
        units: Units::default(),
    }
}

fn of_urdf(path: &Path) -> Document {
    let file = path.file_name().unwrap().to_str().unwrap();
    let robot = urdf::read(file, &fs::read_to_string(path).unwrap()).unwrap();
    let main = robot.chain(None, None, Reading::Intended).unwrap();
    let chains = robot.leaf_chains().into_iter().filter(|listing| listing.tip != main.value.tip());
    let moving = chains.filter(|listing| !listing.coordinates.is_empty());
    let others =
        moving.filter_map(|listing| robot.chain(Some(&listing.base), Some(&listing.tip), Reading::Intended).ok());
    let others = others.map(|chain| part(chain.value, chain.notes)).collect();
    let notes = robot.notes.iter().cloned().chain(main.notes).collect();
    Document {
        main: part(main.value, notes),
        others,
        robot: Some(robot),
        source: file.into(),
        ..of_example(examples::planar_arm())
    }
}

fn documents() -> Vec<(String, Document)> {
    let mut documents: Vec<(String, Document)> =
        examples::all().into_iter().map(|chain| (chain.name().to_owned(), of_example(chain))).collect();
    let own =
        ["universal_robots/ur5e", "franka/panda", "denso/hsr065_screw_spline", "kuka/kr16_2_on_rail", "robotiq/2f_85"];
    let own = own.map(|name| (name, workspace().join(format!("robots/{name}.urdf"))));
    let vendors = ["unitree/h1", "aldebaran/nao_v40"];
    let vendors = vendors.map(|name| (name, workspace().join(format!("../shared/vendor/robots/{name}.urdf"))));
    for (name, path) in own.into_iter().chain(vendors) {
        if path.exists() {
            documents.push((name.rsplit('/').next().unwrap().to_owned(), of_urdf(&path)));
        } else {
            println!("{name}: skipped, because {} is not there", path.display());
        }
    }
    documents
}

/// Values spread over the ranges, the same on every run.
fn postures(chain: &Chain) -> Vec<Vec<f64>> {
    let value = |posture: u32, k: usize, (lower, upper): (f64, f64)| {
        let part = (0.618033988749895 * f64::from(posture + 1) + 0.7548776662466927 * k as f64).fract();
        lower + (upper - lower) * part
    };
    let ranges: Vec<(f64, f64)> = chain.coordinates().iter().map(denavit_model::Coordinate::range).collect();
    (0..3).map(|posture| ranges.iter().enumerate().map(|(k, range)| value(posture, k, *range)).collect()).collect()
}

/// What the page must show of its chain `index` at a few postures.
fn expected(index: usize, chain: &Chain) -> Vec<serde_json::Value> {
    let tip = |q: Vec<f64>| {
        let pose = chain.fk(&q);
        let [roll, pitch, yaw] = se3::rpy_from_rotation(&pose.rotation);
        let [x, y, z] = <[f64; 3]>::from(pose.translation.vector);
        serde_json::json!({
            "chain": index, "q": q, "tip": {"x": x, "y": y, "z": z, "roll": roll, "pitch": pitch, "yaw": yaw}
        })
    };
    postures(chain).into_iter().map(tip).collect()
}

#[test]
fn pages_and_what_their_sliders_must_show_are_written_for_the_browser() {
    let folder = workspace().join("target/oracle/pages");
    fs::create_dir_all(&folder).unwrap();
    let mut cards = Vec::new();
    for (name, document) in documents() {
        fs::write(folder.join(format!("{name}.html")), html(&document)).unwrap();
        for file in markdown(&document, &name) {
            fs::write(folder.join(&file.name), &file.text).unwrap();
        }
        let from_main = |part: &&ChainPart| part.chain.base() == document.main.chain.base();
        let others: Vec<&ChainPart> = document.others.iter().filter(from_main).collect();
        let postures = [(0, &document.main)].into_iter().chain(others.last().map(|part| (others.len(), *part)));
        let expected: Vec<_> = postures.flat_map(|(index, part)| expected(index, &part.chain)).collect();
        fs::write(folder.join(format!("{name}.json")), serde_json::to_string_pretty(&expected).unwrap()).unwrap();
        cards.push(Card::of(&document, format!("{name}.html")));
    }
    fs::write(folder.join("index.html"), index("Robots", &cards)).unwrap();
}
