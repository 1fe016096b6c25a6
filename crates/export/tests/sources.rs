//! Readers of tables and makers' files: what they understand, and that they report everything else.

#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a test stops at what it did not expect, and says what it skips"
)]

use denavit_export::kinematics_yaml::AngleOrder;
use denavit_export::makers::{self, ur_conf};
use denavit_export::sources::{Read, Stated, read_vendor_table, read_whole};
use denavit_model::Chain;
use std::path::PathBuf;

fn read(file: &str, text: &str) -> Read {
    read_whole(file, text, Stated::default()).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

fn refused(file: &str, text: &str) -> String {
    match read_whole(file, text, Stated::default()) {
        Ok(read) => panic!("{read:?}\n{text}"),
        Err(error) => error.to_string(),
    }
}

fn chain(read: &Read) -> Chain {
    read.source.chain().unwrap()
}

fn tip(read: &Read, q: &[f64]) -> [f64; 3] {
    chain(read).fk(q).translation.vector.into()
}

fn near(found: [f64; 3], expected: [f64; 3]) {
    assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-9), "{found:?} {expected:?}");
}

fn wild(path: &str) -> Option<String> {
    let file = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared/wild").join(path);
    let text = std::fs::read_to_string(file).ok();
    if text.is_none() {
        println!("skipped, because the public cases (../shared/wild) are not beside this clone");
    }
    text
}

#[test]
fn public_cases_of_tables_come_to_their_robots() {
    let Some(two) = wild("techman-delta-dh/two.csv") else { return };
    let half = 0.5f64.to_radians();
    let expected = [0.2 + 0.05 * half.sin(), 0.0, 0.1 + 0.05 * half.cos()];
    near(tip(&read("two.csv", &two), &[0.0, 0.0]), expected);
    near(tip(&read("two.csv", &wild("techman-delta-dh/two_distal.csv").unwrap()), &[0.0, 0.0]), expected);
    let mils = read("u.csv", &wild("table-unit-in-heading-ignored/u.csv").unwrap());
    near(tip(&mils, &[0.0, 0.0]), [13.4 * 25.4e-6, 0.0, 16.0 * 25.4e-6]);
    let fixed = read("n.csv", &wild("table-fixed-row-becomes-joint/n.csv").unwrap());
    assert_eq!(chain(&fixed).joints().len(), 3);
    assert!(fixed.assumed.iter().any(|said| said.contains("it is read as a fixed frame")), "{:?}", fixed.assumed);
    for file in ["rtb_print.txt", "rtb_box.md"] {
        let printed = read(file, &wild(&format!("tables-from-threads/{file}")).unwrap());
        assert_eq!(chain(&printed).joints().len(), if file == "rtb_box.md" { 3 } else { 6 });
    }
    let axes = read("poe.json", &wild("other-formats/poe_modern_robotics.json").unwrap());
    near(tip(&axes, &[0.0; 6]), [0.817, 0.191, -0.006]);
    let yaml = |text: &str| makers::read_whole("a.yaml", "a", text, AngleOrder::Urdf, Stated::default());
    let opw = yaml(&wild("other-formats/opw.yaml").unwrap()).unwrap();
    near(tip(&opw, &[0.0; 6]), [0.5 + 1.55 + 1.0345 + 0.305, 0.0, 0.86 + 0.18]);
    let foreign = yaml(&wild("foreign-yaml-read-as-franka/openarm_like.yaml").unwrap()).unwrap_err().to_string();
    assert!(foreign.contains("at right angles, but here they are not"), "{foreign}");
    let conf = wild("ur-calibration-conf/calibration.conf").unwrap();
    assert!(ur_conf::is_one(&conf));
    let unnamed = ur_conf::read("c.conf", "c", &conf, None).unwrap_err().to_string();
    assert!(unnamed.contains("ur_type:=MODEL"), "{unnamed}");
    let named = ur_conf::read("c.conf", "c", &conf, Some("ur10e")).unwrap();
    assert!(tip(&named, &[0.0; 6]).iter().all(|x| x.abs() < 2.0), "{:?}", tip(&named, &[0.0; 6]));
}

#[test]
fn a_row_without_a_variable_and_frames_between_joints() {
    let text = "# distal\n# units: m, deg\njoint,theta,d,alpha,a\npedestal,0,0.5,0,0\n1,q1,0.1,0,0.3\nspacer,0,0.02,90,0\n2,q2,0,0,0.2\n\
                plate,0,0.05,90,0.01\nneedle,0,0.1,0,0\n";
    let found = read("t.csv", text);
    near(tip(&found, &[0.0, 0.0]), [0.51, -0.05, 0.52]);
    assert_eq!(found.assumed.len(), 4, "{:?}", found.assumed);
    let alone = "# distal\n# units: m, deg\njoint,theta,d,alpha,a\n1,0,0.1,0,0.3\n2,0,0,0,0.2\ntool,0,0.1,90,0.04\n";
    assert!((tip(&read("t.csv", alone), &[0.0, 0.0])[0] - 0.54).abs() < 1e-12);
    let readings = read_vendor_table("t.csv", text, Stated::default()).unwrap();
    assert_eq!(readings[0].table.joints.len(), 2);
}

#[test]
fn what_a_row_says_twice_must_be_the_same() {
    for (text, said) in [
        ("theta,d,alpha,a\nq1,0,q2,0\n", "alpha holds a variable"),
        ("theta,d,alpha,a\nθ1,d1,0,0\n", "theta holds the variable theta1 and d the variable d1"),
        ("kind,theta,d,alpha,a\nR,0,d1,0,0\n", "kind is revolute, but d holds the variable"),
        ("kind,theta,d,alpha,a\nP,q1,0,0,0\n", "kind is prismatic, but theta holds the variable"),
        ("kind,offset,d,alpha,a\nP,90,q1,0,0\n", "the offset may belong to d"),
        ("theta,d,alpha,a\nq1,0,0,0,7\n", "the row has 5 cells but the header has 4"),
        ("theta,d,alpha,a\n90° + π/2,0,0,0\n", "theta is \"90° + π/2\""),
        ("theta,d [furlong],alpha,a\nq1,0,0,0\n", "column \"d [furlong]\": \"furlong\" is no unit"),
        ("theta,d [deg],alpha,a\nq1,0,0,0\n", "\"deg\" is not a known unit here"),
        ("# units: furlong\ntheta,d,alpha,a\nq1,0,0,0\n", "t.csv:1: units: \"furlong\" is no unit"),
    ] {
        let message = refused("t.csv", text);
        assert!(message.contains(said), "{message}");
    }
}

#[test]
fn every_reader_of_tables_reports_what_it_does_not_understand() {
    let reported = |read: &Read, said: &str| {
        let notes: Vec<String> = read.notes.iter().map(ToString::to_string).collect();
        assert!(notes.iter().any(|note| note.contains(said)), "{said}: {notes:?}");
        assert_eq!(notes.len(), read.inventory.reported().count());
    };
    let csv = "# distal\n# units: m, deg\nrow,theta,d,alpha,a\n1,q1,0.1,90,0\n2,q2,0,0,0.2\n";
    let clean = read("t.csv", csv);
    assert!(clean.notes.is_empty() && clean.assumed.is_empty() && clean.inventory.understood > 10, "{clean:?}");
    let lines: Vec<&str> = csv.lines().collect();
    for mark in [",", ";", "\t"] {
        for place in 0..=5 {
            let with = |line: &str, word: &str| {
                let mut cells: Vec<&str> = line.split(',').collect();
                cells.insert(place, word);
                cells.join(mark)
            };
            for heading in ["colour", ""] {
                let rows = [with(lines[2], heading), with(lines[3], "red"), with(lines[4], "7")];
                let text = format!("{}\n{}\n{}\n", lines[0], lines[1], rows.join("\n"));
                reported(&read("t.csv", &text), &format!("t.csv:3: column \"{heading}\""));
            }
        }
        for place in 2..=5 {
            for row in ["spare,word,0,0,0", "9,0,0.5,0,0", "3,cubit,0,0,0", "3,0,0,0,0,0"] {
                let mut rows = lines.clone();
                rows.insert(place, row);
                let text = rows.join("\n").replace(',', mark).replace("m; deg", "m, deg").replace("m\t deg", "m, deg");
                if let Ok(read) = read_whole("t.csv", &text, Stated::default()) {
                    assert_eq!(place, 2, "{text}");
                    reported(&read, "a row above the header is ignored");
                }
            }
        }
    }
    let markdown = "standard, lengths in m, angles in degrees\n\n| theta | d | alpha | a | limits |\n|---|---|---|---|---|\n| q1 | 0.1 | 90 | 0 | ±170° |\n";
    assert!(read("t.md", markdown).notes.is_empty());
    reported(&read("t.md", &format!("{markdown}\nSee page 3.\n")), "t.md:7: text: text behind the table is not read");
    reported(&read("t.md", &format!("{markdown}\n# B\n\n{markdown}")), "another table follows");
    reported(&read("t.md", &markdown.replace("±170°", "page 3")), "limits \"page 3\" are not understood");
    let axes = "row,joint,kind,wx,wy,wz,vx,vy,vz,colour\n1,j,revolute,0,0,1,0,0,0,red\ntool,,,0,0,0,0.5,0,0,\n";
    reported(&read("p.csv", axes), "column \"colour\"");
    assert!(refused("p.csv", &axes.replace("revolute", "prismatic")).contains("the twist is revolute"));
    let mr =
        r#"{"M": [[1,0,0,0.8],[0,1,0,0],[0,0,1,0],[0,0,0,1]], "Slist": [[0,0,1,0,0,0],[0,1,0,-0.1,0,0]], "Glist": 1}"#;
    reported(&read("m.json", mr), "key \"Glist\"");
    let body = mr.replace("Slist", "Blist");
    assert!(chain(&read("m.json", &body)).joints().len() == 2);
    let both = mr.replace("\"Glist\": 1", "\"Blist\": [[0,0,1,0,0,0],[0,1,0,-0.1,0,0]]");
    assert!(refused("m.json", &both).contains("Ad(M) times Blist is not Slist"));
}

#[test]
fn every_reader_of_makers_files_reports_what_it_does_not_understand() {
    let xarm = "kinematics:\n  joint1: {x: 0, y: 0, z: 0.3, roll: 0, pitch: 0, yaw: 0}\n  joint2: {x: 0, y: 0, z: 0.3, roll: 1.5, pitch: 0, yaw: 0}\n";
    let opw = "opw_kinematics_geometric_parameters:\n  a1: 0.5\n  a2: -0.18\n  b: 0.0\n  c1: 0.86\n  c2: 1.55\n  c3: 1.0345\n  c4: 0.305\n\
               opw_kinematics_joint_offsets: [0, deg(-90), 0, 0, 0, 0]\nopw_kinematics_joint_sign_corrections: [-1, 1, 1, -1, 1, -1]\n";
    let rows = "convention: distal\nunits: m, deg\ndh:\n  - {theta: q1, d: 0.1, alpha: 90, a: 0}\n  - {theta: q2, d: 0, alpha: 0, a: 0.2}\n";
    let yaml = |text: &str| makers::read_whole("a.yaml", "a", text, AngleOrder::Urdf, Stated::default());
    for text in [xarm, opw, rows] {
        let clean = yaml(text).unwrap();
        assert!(clean.notes.is_empty(), "{:?}", clean.notes);
        let lines: Vec<&str> = text.lines().collect();
        for place in 0..=lines.len() {
            let indent = lines.get(place).map_or("", |line| &line[..line.len() - line.trim_start().len()]);
            let list = lines.get(place).is_some_and(|line| line.trim_start().starts_with('-'));
            let mut all: Vec<String> = lines.iter().map(|line| (*line).to_owned()).collect();
            all.insert(place, format!("{indent}{}colour: red", if list { "- " } else { "" }));
            if let Ok(read) = yaml(&all.join("\n")) {
                let notes: Vec<String> = read.notes.iter().map(ToString::to_string).collect();
                assert!(notes.iter().any(|note| note.contains("colour")), "{}: {notes:?}", all.join("\n"));
            }
        }
    }
    near(tip(&yaml(rows).unwrap(), &[0.0, 0.0]), [0.2, 0.0, 0.1]);
    let named = "units: m, deg\nshoulder: {theta: q1, d: 0.1, alpha: 90, a: 0}\nelbow: {theta: q2, d: 0, alpha: 0, a: 0.2, mass: 3}\n";
    let named = yaml(named).unwrap();
    assert_eq!(chain(&named).coordinates()[1].name, "elbow");
    assert!(named.notes.iter().any(|note| note.to_string().contains("column \"mass\"")), "{:?}", named.notes);
}
