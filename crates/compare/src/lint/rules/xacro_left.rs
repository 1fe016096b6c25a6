//! xacro that was not expanded.

use crate::lint::finding::Found;
use crate::lint::{Rule, Sheet};
use crate::report::Level;

pub(super) const RULE: Rule = Rule {
    code: "D080",
    name: "xacro-left",
    level: Level::Warning,
    summary: "The file has xacro elements that were not expanded",
    why: "URDF readers silently skip them and everything that they would insert. Expand the file, or give this \
          program the .xacro file, which it expands.",
    bad: "<xacro:property xmlns:xacro=\"http://www.ros.org/wiki/xacro\" name=\"length\" value=\"1\"/>\n<link name=\"base\"/>",
    good: "<link name=\"base\"/>",
    fixable: false,
    check,
};

fn check(sheet: &Sheet) -> Vec<Found> {
    let xacro = |namespace: &str| namespace.contains("xacro");
    let mut left = sheet.elements().filter(|node| node.tag_name().namespace().is_some_and(xacro));
    let Some(first) = left.next() else { return Vec::new() };
    let others = left.count();
    let what = match others {
        0 => "xacro that was not expanded; expand the file".to_owned(),
        others => format!("xacro that was not expanded, and {others} more such elements; expand the file"),
    };
    vec![Found::at(first.range().start, format!("<xacro:{}>", first.tag_name().name()), what)]
}
