//! Readers of measurements: what says nothing new is known, and no input whatever makes them panic or run for ever.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a panic is a failure, and what is printed is read")]

use denavit_measurements::import::{self, EulerOrder, ImportOptions, Map};
use denavit_measurements::{Measurements, Units, poses, read, read_export, read_socket};
use denavit_model::{Chain, Outcome, examples};
use seeded::{Random, mutated};
use std::time::{Duration, Instant};

#[path = "../../../tests/seeded.rs"]
mod seeded;

fn rows(text: &str) -> Measurements {
    read("d.csv", text.as_bytes(), &examples::planar_arm(), Units::default()).unwrap().data
}

#[test]
fn rows_that_say_the_same_are_copies_whatever_else_is_recorded() {
    let data = rows(
        "joint_1,joint_2,x,y,z,time,payload\n0.1,0.2,1,0.5,0,1,2\n0.3,0.2,1,0.6,0,2,2\n0.1,0.2,1,0.5,0,3,2\n\
         0.1,0.2,1,0.5,0,4,3\n0.1,0.2,1,0.5001,0,5,2\n",
    );
    assert_eq!(data.copies(None), [2]);
    assert_eq!(data.copies(Some(&data)), [0, 1, 2, 3, 4]);
    assert_eq!(data.leaving_out(&[2]).lines, [2, 3, 5, 6]);
}

#[test]
fn a_file_given_twice_has_two_setups_and_one_set_of_rows() {
    let one = || rows("joint_1,joint_2,x1,y1,z1,x2,y2,z2\n0.1,0.2,1,0.5,0,1,1,1\n0.3,0.2,1,0.6,0,,,\n");
    let both = Measurements::joined(vec![one().of_setup("a"), one().of_setup("a 2")]).unwrap();
    assert_eq!(both.copies(None), [2, 3]);
    let left = both.leaving_out(&[2, 3]);
    assert_eq!((left.scene.setups.len(), left.scene.targets.len(), left.len()), (1, 2, 2));
}

#[test]
fn one_number_agrees_by_chance() {
    let chance = "joint_1,joint_2,distance\n0.1,0.2,1.5\n0.1,0.2,1.5\n0.1,0.2,1.6\n";
    assert_eq!(rows(chance).copies(None), Vec::<usize>::new());
    let pasted = "joint_1,joint_2,distance\n0.1,0.2,1.5\n0.4,0.2,1.6\n0.1,0.2,1.5\n0.4,0.2,1.6\n";
    assert_eq!(rows(pasted).copies(None), [2, 3]);
    let numbered = "joint_1,joint_2,distance,shot\n0.1,0.2,1.5,1\n0.1,0.2,1.5,2\n0.1,0.2,1.6,3\n0.1,0.2,1.6,3\n";
    assert_eq!(rows(numbered).copies(None), [3]);
}

#[test]
fn rows_of_one_posture_are_known_by_the_first_of_them() {
    let data = rows(
        "joint_1,joint_2,x,y,z\n1.0001,2,0,0,0\n1,2,0,0,1\n1,2.1,0,0,0\n0.9999,2,0,0,2\n1,2.1001,0,0,3\n1.01,2,0,0,0\n",
    );
    assert_eq!(data.first_of_posture(), [0, 0, 2, 0, 2, 5]);
}

#[test]
fn every_cell_is_understood_carried_or_reported() {
    let text =
        "written by hand on Monday,,\njoint_1,joint_2,x,y,z,time,shot,place\n0.1,0.2,1,0.5,0,1,7,a\n0.3,0.2,,,,2,8,b\n";
    let text =
        text.replace("x,y,z", "x1,y1,z1,x2,y2,z2").replace("1,0.5,0,", "1,0.5,0,1,1,1,").replace(",,,,2", ",,,,,,,2");
    let loaded = read("d.csv", text.as_bytes(), &examples::planar_arm(), Units::default()).unwrap();
    let inventory = &loaded.inventory;
    // Two joints, six coordinates and the time, of two rows.
    assert_eq!((inventory.understood, inventory.count(Outcome::Carried)), (18, 2));
    let reported: Vec<&str> = inventory.reported().map(|item| item.what.as_str()).collect();
    assert_eq!(reported.len(), 2, "{reported:?}");
    assert!(reported.iter().any(|what| what.contains("by hand on Monday")), "{reported:?}");
    let said: Vec<String> = loaded.notes.iter().map(ToString::to_string).collect();
    assert!(said.iter().any(|note| note.contains("above the header not read")), "{said:?}");
    assert!(said.iter().any(|note| note == "nothing was measured in 1 rows, lines 4"), "{said:?}");
}

/// Words that matter to the readers.
const WORDS: &[&str] = &[
    ",",
    ";",
    "\t",
    "\n",
    "\r\n",
    "\"",
    "#",
    "//",
    "-",
    "+",
    ".",
    "1e100",
    "-1e200",
    "1e308",
    "1e-320",
    "nan",
    "inf",
    "0",
    "-0",
    "#N/A",
    "joint_1",
    "joint_2",
    "x",
    "y",
    "z",
    "x1",
    "z2",
    "qx",
    "qw",
    "rx",
    "ry",
    "rz",
    "roll",
    "distance",
    "plane",
    "dial",
    "setup",
    "tip",
    "locate",
    "std",
    "x.std",
    "time",
    "payload",
    "temperature",
    "joint_1.approach",
    "joint_9.velocity",
    "u",
    "v",
    "corner",
    " [mm]",
    " (deg)",
    " [zorp]",
    "mm",
    "deg",
    "\u{feff}",
    "\u{e4}",
    "MARKER_NAMES",
    "movej([",
    "])",
    "jointtarget",
    "E6AXIS",
    "{A1 ",
    "units = \"",
    "euler = { order = \"XYZ\", columns = [",
    "column 1",
    "PK\u{3}\u{4}",
    "1,5",
    "9999999999999999999",
];

const SEEDS: &[&str] = &[
    "joint_1,joint_2,x,y,z\n0.1,0.2,1,0.5,0\n0.3,0.2,1,0.6,0\n0.5,-0.2,0.9,0.7,0\n",
    "joint_1,joint_2,x1,y1,z1,x2,y2,z2,time,place\n0.1,0.2,1,0.5,0,1,1,1,0,a\n0.3,0.2,1,0.6,0,,,,1,b\n",
    "joint_1,joint_2,x,y,z,qx,qy,qz,qw,payload\n0.1,0.2,1,0.5,0,0,0,0,1,2\n",
    "# note\njoint_1 [deg];joint_2 [deg];X [mm];Y [mm];Z [mm]\n10,5;20;1000;500,25;0\n30;20;1000;600;0\n",
    "joint_1,joint_2,distance,setup,distance.std\n0.1,0.2,1.5,a,1e-4\n0.1,0.4,1.6,b,1e-4\n",
    "joint_1,joint_2,x,y,z,rx,ry,rz\n0.1,0.2,1,0.5,0,0.1,0.2,0.3\n0.3,0.2,1,0.6,0,1,2,3\n",
    "joint_1,joint_2,plane\n0.1,0.2,floor\n0.3,0.4,wall\n",
    "Frame\tTime\tball X\tball Y\tball Z\n1\t0.0\t1.0\t2.0\t3.0\n2\t0.1\t1.0\t2.0\t3.0\n",
    "MODULE m\nCONST jointtarget a:=[[1,2,3,4,5,6],[9E9,9E9,9E9,9E9,9E9,9E9]];\nENDMODULE\n",
    "DECL E6AXIS P1={A1 1.0,A2 -2.0,A3 3.0,A4 4.0,A5 5.0,A6 6.0,E1 0.0}\n",
    "def p():\n  movej([0.1,-0.2,0.3,0.4,0.5,0.6], a=1.4)\nend\n",
    "units = \"mm,deg\"\njoints = [\"column 1\", \"column 2\"]\nx = [\"a\", \"b\"]\neuler = { order = \"ZYX\", columns = [\"c\", \"d\", \"e\"] }\n",
];

/// All readers on one input.
fn read_all(bytes: &[u8], chain: &Chain, options: &[ImportOptions]) {
    let units = Units { length: 1e-3, angle: 1.0 };
    for options in options {
        match read_export("m.csv", bytes, chain, units, options) {
            Ok(loaded) => {
                assert!(!loaded.columns.is_empty() && loaded.data.len() == loaded.data.lines.len());
                let copies = loaded.data.copies(None);
                assert!(copies.len() < loaded.data.len().max(1));
                assert_eq!(loaded.data.first_of_posture().len(), loaded.data.len());
            }
            Err(error) => assert!(!error.to_string().is_empty()),
        }
        if let Err(error) = poses::read_export("m.csv", bytes, chain, units, options) {
            assert!(!error.to_string().is_empty());
        }
    }
    let _ = read_socket("m.csv", bytes, "front/0", chain, units).map_err(|error| error.to_string());
    let _ = import::draft("m.csv", bytes, chain).map_err(|error| error.to_string());
    let _ = import::cells(bytes).map_err(|error| error.to_string());
    let text = String::from_utf8_lossy(bytes);
    let _ = import::joints("p.mod", &text).map_err(|error| error.to_string());
    let _ = Map::read("m.toml", &text).map_err(|error| error.to_string());
}

/// A slice of it with every run of the tests; as many seconds as `DENAVIT_MUTATE_SECONDS` says where it is set.
#[test]
fn no_input_makes_a_reader_panic_or_run_for_ever() {
    let chain = examples::planar_arm();
    let seconds = std::env::var("DENAVIT_MUTATE_SECONDS").ok().and_then(|seconds| seconds.parse::<u64>().ok());
    let euler =
        |order: &str| ImportOptions { euler: Some(order.parse::<EulerOrder>().unwrap()), ..ImportOptions::default() };
    let options = [
        ImportOptions::default(),
        euler("XYZ"),
        ImportOptions { rotation_vector: true, ..ImportOptions::default() },
        ImportOptions {
            map: Some(
                Map::read(
                    "map",
                    "joints = [\"column 1\", \"column 2\"]\nx = \"column 3\"\ny = \"column 4\"\nz = \"column 5\"\n",
                )
                .unwrap(),
            ),
            ..ImportOptions::default()
        },
    ];
    let (begun, mut random, mut executions) = (Instant::now(), Random(34), 0u64);
    loop {
        let enough = match seconds {
            Some(seconds) => begun.elapsed() >= Duration::from_secs(seconds),
            None => executions >= 3000,
        };
        if enough {
            break;
        }
        let bytes = mutated(SEEDS, WORDS, 4, &mut random);
        let one = Instant::now();
        read_all(&bytes, &chain, &options);
        executions += 1;
        // A crowded machine is slow, not for ever.
        assert!(one.elapsed() < Duration::from_secs(20), "{}", String::from_utf8_lossy(&bytes));
    }
    println!("{executions} inputs, {} readers each, in {:?}", 2 * options.len() + 5, begun.elapsed());
}
