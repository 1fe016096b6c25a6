//! A Markdown table for a repository or a wiki.

use super::{Format, RenderError, text};
use crate::sheet::Sheet;
use comfy_table::presets;
use denavit_model::words::one_line;
use std::fmt::Write as _;

/// Markdown.
pub const FORMAT: Format = Format { name: "md", extension: "md", purpose: "Markdown table", render };

fn render(sheet: &Sheet) -> Result<String, RenderError> {
    let table = sheet.table;
    let (angle, length) = (sheet.units.angle_word(), sheet.units.length_word());
    let name = if table.name.is_empty() { "(no name)" } else { &table.name };
    let mut out = format!("### {}: {} → {}\n\n", escaped(name), code(&table.base), code(&table.tip));
    let _ = writeln!(out, "{}, {angle} and {length}; {}.\n", sheet.convention_words(), sheet.row_formula());
    out.push_str(&text::grid(sheet, presets::ASCII_MARKDOWN, escaped));
    let remarks = text::remarks(sheet);
    for line in remarks.lines() {
        let _ = writeln!(
            out,
            "{}",
            line.strip_prefix("  ").map_or_else(|| line.to_owned(), |note| format!("- {}", escaped(note)))
        );
    }
    Ok(out)
}

/// Text escaped for Markdown and HTML, on one line.
pub(crate) fn escaped(text: &str) -> String {
    let mut out = String::new();
    for c in one_line(text).chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '|' | '\\' | '`' | '*' | '[' | ']' => out.extend(['\\', c]),
            c => out.push(c),
        }
    }
    out
}

/// Text as code.
fn code(text: &str) -> String {
    format!("`{}`", one_line(text).replace('`', "'"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_stand_for_themselves() {
        assert_eq!(escaped("joint_1"), "joint_1");
        assert_eq!(escaped("<img src=x> a|b\n# c"), "&lt;img src=x&gt; a\\|b\\\\n# c");
        assert_eq!(code("a`b"), "`a'b`");
    }
}
