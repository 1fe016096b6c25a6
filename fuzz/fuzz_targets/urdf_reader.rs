//! Any text as a URDF: a robot whose chains can be folded, whose inventory has a place for everything, and whose sensors'
//! poses can be written again; or problems with their places.

#![no_main]

use denavit_model::{Reading, posed, urdf};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    match urdf::read("fuzz.urdf", text) {
        Ok(robot) => {
            assert!(robot.inventory().items.iter().all(|item| item.place.line > 0 && !item.what.is_empty()));
            for element in &robot.elements {
                for posed in posed::in_element(element, None) {
                    let changes = posed.rewritten(&posed.placed);
                    assert!(changes.iter().all(|change| change.node < element.nodes.len()));
                }
            }
            for listing in robot.leaf_chains().iter().take(20) {
                let _ = robot.chain(Some(&listing.base), Some(&listing.tip), Reading::Intended);
            }
        }
        Err(error) => assert!(!error.to_string().is_empty()),
    }
});
