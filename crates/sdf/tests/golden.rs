//! Small models of each construct, as URDF with the places of the SDF, and as SDF again.

#![allow(clippy::unwrap_used)] // Tests: a panic is a failure.

use denavit_model::{formats, urdf};

fn models(name: &str) -> String {
    std::fs::read_to_string(format!("{}/tests/models/{name}", env!("CARGO_MANIFEST_DIR"))).unwrap()
}

/// The URDF, its notes, the SDF that is written of it, and what is lost.
fn shown(name: &str) -> String {
    let mut fetch = |uri: &str, _: &str| match uri {
        "model://camera" => Ok(("camera.sdf".to_owned(), models("camera.sdf"))),
        _ => Err("there is none".to_owned()),
    };
    let text = denavit_sdf::read(name, &models(name), &mut fetch).unwrap();
    let robot = urdf::read(name, &text).unwrap();
    let notes: String = robot.notes.iter().fold(String::new(), |all, note| all + &note.to_string() + "\n");
    let written = denavit_sdf::write(&robot).unwrap();
    let losses: String = written.losses.iter().fold(String::new(), |all, loss| all + &loss.to_string() + "\n");
    format!("{}\nnotes\n{notes}\n{}\nlosses\n{losses}", formats::as_urdf(&text), written.text)
}

#[test]
fn every_construct_reads_as_it_should() {
    for name in ["old_frames.sdf", "new_frames.sdf", "joints.sdf", "nested.sdf", "shapes.sdf"] {
        insta::assert_snapshot!(name.trim_end_matches(".sdf"), shown(name));
    }
}
