//! Any text as an SDF: URDF text that the URDF reader takes or refuses with places, and that is written as SDF and read again; or
//! problems with their places.

#![no_main]

use denavit_model::{Robot, urdf};
use libfuzzer_sys::fuzz_target;

fn read(text: &str) -> Option<Robot> {
    match denavit_sdf::read("fuzz.sdf", text, &mut |_, _| Err("there is none".into())) {
        Ok(urdf) => urdf::read("fuzz.sdf", &urdf).ok(),
        Err(error) => {
            assert!(!error.problems.is_empty() && error.problems.iter().all(|(place, _)| place.line > 0));
            None
        }
    }
}

fuzz_target!(|text: &str| {
    let Some(robot) = read(text) else { return };
    assert!(robot.inventory().items.iter().all(|item| item.place.line > 0 && !item.what.is_empty()));
    let Ok(written) = denavit_sdf::write(&robot) else { return };
    if let Some(again) = read(&written.text) {
        assert_eq!(again.links.len(), robot.links.len());
    }
});
