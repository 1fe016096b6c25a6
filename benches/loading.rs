//! From the text of a URDF to a chain, compared with urdf-rs alone and the XML parser alone; from an MJCF to a robot.

use denavit_benches::{ROBOTS, report, robot_file, robot_text};
use denavit_model::{Reading, urdf};
use std::hint::black_box;
use std::path::PathBuf;

/// Environment variable with the file of a large robot, because the repository has none: `benches/run` sets the PR2.
const LARGE: &str = "DENAVIT_LARGE_URDF";

/// Environment variable with an MJCF model without includes: `benches/run` sets one of 30 bodies, if it exists.
const MJCF: &str = "DENAVIT_MJCF";

pub fn loading() {
    let small = ROBOTS.iter().map(|(robot, file, _)| ((*robot).to_owned(), robot_text(file)));
    let large = std::env::var_os(LARGE).map(PathBuf::from).and_then(|path| {
        Some((path.file_stem()?.to_string_lossy().into_owned(), std::fs::read_to_string(&path).ok()?))
    });
    for (robot, text) in small.chain(large) {
        report(&robot, "denavit, to a chain", "load", 1, || {
            let robot = urdf::read("robot.urdf", black_box(&text)).expect("a robot");
            black_box(robot.chain(None, None, Reading::Intended).expect("a chain"));
        });
        report(&robot, "roxmltree, the XML alone", "load", 1, || {
            black_box(roxmltree::Document::parse(black_box(&text)).expect("XML").root_element().range());
        });
        if urdf_rs::read_from_string(&text).is_ok() {
            report(&robot, "urdf-rs", "load", 1, || _ = black_box(urdf_rs::read_from_string(black_box(&text))));
        }
    }
    let model = std::env::var_os(MJCF).map(PathBuf::from).and_then(|path| {
        Some((path.file_stem()?.to_string_lossy().into_owned(), std::fs::read_to_string(&path).ok()?))
    });
    if let Some((name, text)) = model {
        let made = |text: &str| {
            denavit_mjcf::translated("model.xml", text, &mut |name| Err(format!("{name} is not read")))
                .expect("a model in MJCF")
        };
        report(&name, "denavit, MJCF to a robot", "mjcf", 1, || {
            black_box(made(black_box(&text)).robot("model.xml").expect("a robot"));
        });
        report(&name, "denavit, MJCF to the text of a URDF", "mjcf", 1, || {
            _ = black_box(made(black_box(&text)).text());
        });
        report(&name, "roxmltree, the XML alone", "mjcf", 1, || {
            black_box(roxmltree::Document::parse(black_box(&text)).expect("XML").root_element().range());
        });
    }
    let (robot, file, _) = ROBOTS[0];
    let path = robot_file(file);
    report(robot, "reading the file", "load", 1, || _ = black_box(std::fs::read_to_string(black_box(&path))));
}
