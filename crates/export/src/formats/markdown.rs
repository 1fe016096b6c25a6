//! A Markdown table for a repository or a wiki.

use super::{Format, RenderError, text};
use crate::sheet::Sheet;
use comfy_table::presets;
use std::fmt::Write as _;

/// Markdown.
pub const FORMAT: Format = Format { name: "md", extension: "md", purpose: "Markdown table", render };

fn render(sheet: &Sheet) -> Result<String, RenderError> {
    let table = sheet.table;
    let (angle, length) = (sheet.units.angle_word(), sheet.units.length_word());
    let name = if table.name.is_empty() { "(no name)" } else { &table.name };
    let mut out = format!("### {name}: `{}` → `{}`\n\n", table.base, table.tip);
    let _ = writeln!(out, "{}, {angle} and {length}; {}.\n", sheet.convention_words(), sheet.row_formula());
    out.push_str(&text::grid(sheet, presets::ASCII_MARKDOWN));
    let remarks = text::remarks(sheet);
    for line in remarks.lines() {
        let _ =
            writeln!(out, "{}", line.strip_prefix("  ").map_or_else(|| line.to_owned(), |note| format!("- {note}")));
    }
    Ok(out)
}
