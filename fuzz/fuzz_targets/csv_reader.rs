//! Any text as a table file, a vendor's table, screw axes, or measurements: values, or problems with their places.

#![no_main]

use denavit_measurements::{self, Units};
use denavit_export::sources;
use denavit_model::examples;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    for name in ["fuzz.csv", "fuzz.json"] {
        if let Err(error) = sources::read(name, text, sources::Stated::default()) {
            assert!(!error.to_string().is_empty());
        }
    }
    let _ = sources::read_vendor_table("fuzz.csv", text, sources::Stated::default());
    if let Err(error) = measurements::read("fuzz.csv", text.as_bytes(), &examples::planar_arm(), Units::default()) {
        assert!(!error.to_string().is_empty());
    }
});
