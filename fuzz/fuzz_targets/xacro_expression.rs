//! Any text as an expression: a value or an error, soon.

#![no_main]

use denavit_xacro::{Limits, Options, Source, expand};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    let mut escaped = String::new();
    for c in text.chars() {
        match c {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '"' => escaped.push_str("&quot;"),
            '\0'..='\x1f' | '\u{fffe}' | '\u{ffff}' => escaped.push(' '),
            c => escaped.push(c),
        }
    }
    let document = format!(
        "<robot xmlns:xacro=\"http://www.ros.org/wiki/xacro\"><xacro:property name=\"x\" value=\"${{[1, 2.5, 'a b']}}\"/>\
         <xacro:property name=\"y\" value=\"${{dict(a=1, b=x)}}\"/><a b=\"${{{escaped}}}\"/></robot>"
    );
    let limits = Limits { nodes: 10_000, bytes: 1 << 20, steps: 200_000, ..Limits::default() };
    let options = Options { limits, ..Options::default() };
    if let Err(error) = expand(&Source::text("fuzz.xacro", document), &[], &options) {
        assert!(!error.to_string().is_empty());
    }
});
