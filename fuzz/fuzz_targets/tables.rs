//! Any text as a table, printed or in CSV, Markdown, JSON, and as a vendor's table: values, or problems with their places.

#![no_main]

use denavit_export::sources::{self, Stated};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    for name in ["fuzz.csv", "fuzz.md", "fuzz.txt", "fuzz.json"] {
        match sources::read_whole(name, text, Stated::default()) {
            Ok(read) => assert_eq!(read.notes.len(), read.inventory.reported().count()),
            Err(error) => assert!(!error.to_string().is_empty()),
        }
    }
    let _ = sources::read_vendor_table("fuzz.csv", text, Stated::default());
});
