//! Any text as an MJCF: URDF text that reads as a robot or says in one sentence why not, or problems with their places; a robot
//! that was read is written again.

#![no_main]

use denavit_model::urdf;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    let mut files = |name: &str| if name == "self" { Ok(text.into()) } else { Err("there is no such file".to_owned()) };
    match denavit_mjcf::read("fuzz.xml", text, &mut files) {
        Ok(made) => {
            if let Ok(robot) = urdf::read("fuzz.xml", &made) {
                assert!(robot.inventory().items.iter().all(|item| item.place.line > 0 && !item.what.is_empty()));
                let options = denavit_mjcf::WriteOptions { fix_inertia: true, mesh: &|_| None, srdf: None };
                let _ = denavit_mjcf::write(&robot, &options);
            }
        }
        Err(error) => assert!(!error.to_string().is_empty()),
    }
});
