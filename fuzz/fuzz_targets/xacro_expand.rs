//! Any text as a xacro document: no panic, no hang, and what comes out is XML.

#![no_main]

use denavit_xacro::{Limits, Options, Source, expand, is_xacro};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    let _ = is_xacro(text);
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../crates/xacro/tests/fixtures/features");
    let source = Source::Text { name: "fuzz.xacro".to_owned(), text: text.to_owned(), folder: Some(folder.into()) };
    let limits = Limits { nodes: 10_000, bytes: 1 << 20, steps: 200_000, ..Limits::default() };
    match expand(&source, &[], &Options { limits, ..Options::default() }) {
        Ok(expanded) => assert!(roxmltree::Document::parse(&expanded.urdf).is_ok(), "{}", expanded.urdf),
        Err(error) => assert!(!error.to_string().is_empty()),
    }
});
