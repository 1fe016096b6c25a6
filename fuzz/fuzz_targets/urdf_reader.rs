//! Any text as a URDF: a robot whose chains can be folded, or problems with their places.

#![no_main]

use denavit_model::{Reading, urdf};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    match urdf::read("fuzz.urdf", text) {
        Ok(robot) => {
            for listing in robot.leaf_chains().iter().take(20) {
                let _ = robot.chain(Some(&listing.base), Some(&listing.tip), Reading::Intended);
            }
        }
        Err(error) => assert!(!error.to_string().is_empty()),
    }
});
