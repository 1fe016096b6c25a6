//! Reads randomly changed tables and makers' files for SECONDS: each must soon give a robot or an error message.
//!
//! `cargo run -p denavit-load --example mutate_sources -- SECONDS [SEED]`; the fuzz targets `tables` and `makers_files` do the
//! same with coverage, if cargo-fuzz is installed.

#![allow(clippy::print_stdout, clippy::unwrap_used, reason = "a program for the terminal of whoever changes a reader")]

use denavit_export::sources::{Stated, read_vendor_table};
use denavit_load::{NEARLY_PARALLEL, Options, Selection, TableOptions, from_text};
use seeded::{Random, mutated};
use std::path::Path;
use std::time::{Duration, Instant};

#[path = "../../../tests/seeded.rs"]
mod seeded;

/// Words that the readers know.
const WORDS: &str = "theta§alpha_i-1§d [in]§a (mm)§beta§offset§kind§pitch§scale§q1§q2 - 90°§-π/2§(§)§-§*§/§°§\"§'§|§,§;§\t§ §\n§│§├───┤§+---+§base§\
                     tool§fixed§P§H§1e308§-1e-320§nan§0§999999999999§# units: mm, deg\n§# convention: proximal\n§cubit§\u{feff}§{§}§[§]§:§- §\
                     joint1:\n  kinematic:\n§kinematics:§deg(§!degrees §&a §*a§---\n§delta_a = [§\"schema\"§\"M\"§\"Slist\"§null§true§…§±170°§\u{1f600}§limits§\\|";

/// Texts in every form.
const OWN: &[(&str, &str)] = &[
    (
        "t.md",
        "standard, mm and deg\n\n| i | θᵢ | d | α | a |\n|---|---|---|---|---|\n| 1 | θ₁ | 162.5 | π/2 | 0 |\n| tool | 0 | 9 | 0 | 0 |\n\nwords\n",
    ),
    ("t.txt", "j  theta  d  a  alpha\n1  q1  0.1273  0  1.570796327\n2  q2  0  -0.612  0\n"),
    (
        "t.txt",
        "┌───┬───┬───┐\n│θⱼ │ dⱼ │ aⱼ │ ⍺ⱼ │ q⁻ │ q⁺ │\n├───┼───┼───┤\n│q1 │ 0.1 │ 0 │ 90° │ -180° │ 180° │\n└───┘\n",
    ),
    ("t.csv", "# hayati\n# units: mm, deg\njoint,theta,d,alpha,a,beta\n1,q1,100,0,200,0.5\n2,q2,50,90,0,0\n"),
    (
        "t.yaml",
        "kinematics:\n  joint1: {x: 0, y: 0, z: 0.3, roll: 0, pitch: 0, yaw: 0}\n  joint2: {x: 0, y: 0, z: 0.3, roll: 1.5, pitch: 0, yaw: 0}\n",
    ),
    ("t.yaml", "joint1:\n  kinematic:\n    x: 0\n    y: 0\n    z: 0.333\n    roll: 0\n    pitch: 0\n    yaw: 0\n"),
    (
        "t.yaml",
        "opw_kinematics_geometric_parameters:\n  a1: 0.5\n  a2: -0.18\n  b: 0.0\n  c1: 0.86\n  c2: 1.55\n  c3: 1.0345\n  c4: 0.305\n\
         opw_kinematics_joint_offsets: [0, deg(-90), 0, 0, 0, 0]\nopw_kinematics_joint_sign_corrections: [-1, 1, 1, -1, 1, -1]\n",
    ),
    (
        "t.conf",
        "[mounting]\ndelta_theta = [ 0, 0, 0, 0, 0, 0]\ndelta_a = [ 0, 0, 0, 0, 0, 0]\ndelta_d = [ 0, 0, 0, 0, 0, 0]\n\
         delta_alpha = [ 0, 0, 0, 0, 0, 0]\n",
    ),
    ("t.json", r#"{"M": [[1,0,0,0.8],[0,1,0,0],[0,0,1,0],[0,0,0,1]], "Slist": [[0,0,1,0,0,0],[0,1,0,-0.1,0,0]]}"#),
    (
        "t.json",
        r#"{"schema":"denavit.table/1","robot":"r","base":"b","tip":"t","convention":"distal","units":{"length":"m","angle":"rad"},
        "coordinates":[{"name":"j","quantity":"angle","limits":null}],
        "joints":[{"name":"j","kind":"revolute","coordinate":"j","pitch":0,"scale":1}],
        "rows":[{"row":"base"},{"row":"1","theta":0,"d":0.1,"alpha":0,"a":0.2},{"row":"tool"}]}"#,
    ),
];

fn seeds() -> Vec<(String, String)> {
    let robots = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../robots");
    let mut found = Vec::new();
    for folder in std::fs::read_dir(robots).unwrap().map(|entry| entry.unwrap().path()).filter(|path| path.is_dir()) {
        for file in std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
            let name = file.to_string_lossy().into_owned();
            if name.ends_with("_dh.csv") || name.ends_with("_poe.csv") {
                found.push(("t.csv".to_owned(), std::fs::read_to_string(file).unwrap()));
            }
        }
    }
    found.sort();
    found.extend(OWN.iter().map(|(name, text)| ((*name).to_owned(), (*text).to_owned())));
    found
}

fn main() {
    let mut arguments = std::env::args().skip(1);
    let seconds: u64 = arguments.next().map_or(10, |word| word.parse().unwrap());
    let mut random = Random(arguments.next().map_or(1, |word| word.parse().unwrap()));
    let seeds = seeds();
    let words: Vec<&str> = WORDS.split('§').collect();
    let (begin, mut executions, mut robots) = (Instant::now(), 0u64, 0u64);
    while begin.elapsed() < Duration::from_secs(seconds) {
        let (name, text) = &seeds[random.below(seeds.len())];
        let text = mutated(&[text, &seeds[random.below(seeds.len())].1], &words, 6, &mut random);
        let text = String::from_utf8_lossy(&text).into_owned();
        let start = Instant::now();
        let mut options = Options::default();
        if std::path::Path::new(&name).extension().is_some_and(|ending| ending == "conf") {
            options.arguments.push(("ur_type".into(), "ur5e".into()));
        }
        match from_text(name, &text, &options) {
            Ok(opened) => {
                robots += 1;
                let selection = Selection { file: name, ..Selection::default() };
                let how = TableOptions { convention: None, gauge: None, tolerance: NEARLY_PARALLEL };
                let _ = opened.robot.table(&selection, &how);
            }
            Err(error) => assert!(!error.to_string().is_empty(), "{text}"),
        }
        let _ = read_vendor_table(name, &text, Stated::default());
        assert!(start.elapsed() < Duration::from_secs(20), "{:?} for\n{text}", start.elapsed());
        executions += 1;
    }
    println!("{executions} executions, {robots} of them robots, no finding");
}
