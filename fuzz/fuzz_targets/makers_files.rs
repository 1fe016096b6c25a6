//! Any text as a maker's kinematics file, an OPW file, a controller's calibration: a robot, or problems.

#![no_main]

use denavit_export::kinematics_yaml::AngleOrder;
use denavit_export::makers::{self, ur_conf};
use denavit_export::sources::Stated;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    match makers::read_whole("fuzz.yaml", "fuzz", text, AngleOrder::Urdf, Stated::default()) {
        Ok(read) => assert_eq!(read.notes.len(), read.inventory.reported().count()),
        Err(error) => assert!(!error.to_string().is_empty()),
    }
    let _ = ur_conf::is_one(text);
    if let Err(error) = ur_conf::read("fuzz.conf", "fuzz", text, Some("ur5e")) {
        assert!(!error.to_string().is_empty());
    }
});
