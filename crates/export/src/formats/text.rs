//! Aligned text for a terminal.

use super::{Format, RenderError};
use crate::sheet::Sheet;
use comfy_table::{CellAlignment, Table as Grid, TableStyle, presets};
use denavit_model::words::one_line;
use std::fmt::Write as _;

/// Aligned text.
pub const FORMAT: Format = Format { name: "text", extension: "txt", purpose: "aligned, for a terminal", render };

fn render(sheet: &Sheet) -> Result<String, RenderError> {
    let table = sheet.table;
    let (angle, length) = (sheet.units.angle_word(), sheet.units.length_word());
    let name = if table.name.is_empty() { "(no name)" } else { &table.name };
    let (name, base, tip) = (one_line(name), one_line(&table.base), one_line(&table.tip));
    let mut out = format!("{name}   {base} → {tip}   {}\n", sheet.kinds());
    let _ = writeln!(out, "{}, {angle} and {length}: {}\n", sheet.convention_words(), sheet.row_formula());
    out.push_str(&grid(sheet, presets::NOTHING, |cell| one_line(cell).into_owned()));
    out.push_str(&remarks(sheet));
    Ok(out)
}

/// The rows as a grid in a style of the table library; `safe` makes a name safe for it.
pub(crate) fn grid(sheet: &Sheet, style: TableStyle, safe: fn(&str) -> String) -> String {
    let symbols = sheet.number_columns().into_iter().map(|column| match column {
        "theta" => "θ",
        "alpha" => "α",
        "beta" => "β",
        other => other,
    });
    let pitched = sheet.table.joints.iter().any(|joint| joint.motion.pitch() != 0.0);
    let header: Vec<&str> = ["row", "joint", "kind"].into_iter().chain(symbols).chain(["limits"]).collect();
    let mut grid = Grid::new();
    grid.load_style(style).set_header(&header);
    for row in sheet.text_rows(|k| format!("q{k}")) {
        let cells = [row.label, safe(&row.joint), row.kind].into_iter().chain(row.numbers).chain([safe(&row.limits)]);
        grid.add_row(cells.collect::<Vec<_>>());
    }
    let last = header.len() - 1;
    for (index, column) in grid.column_iter_mut().enumerate() {
        let side = if (3..last).contains(&index) { CellAlignment::Right } else { CellAlignment::Left };
        column.set_cell_alignment(side);
    }
    let lines: Vec<String> = grid.lines().map(|line| line.trim_end().to_owned()).collect();
    let mut text = lines.join("\n") + "\n";
    if pitched && sheet.units.angle == crate::numbers::AngleUnit::Degree {
        text.push_str("\nIn d, the number before q is the pitch in m/rad.\n");
    }
    text
}

/// Notes on the numbers.
pub(crate) fn remarks(sheet: &Sheet) -> String {
    let mut out = String::new();
    let (bound, count) = sheet.displacement_bound();
    if count > 0 {
        let noun = if count == 1 { "number was" } else { "numbers were" };
        let _ = writeln!(
            out,
            "\n{count} {noun} read as intended, not as written; this moves the tip by at most {} mm (‹exact› reads as \
             written):",
            crate::numbers::decimal(bound * 1e3, if bound < 1e-5 { 6 } else { 3 })
        );
    } else if !sheet.notes.is_empty() {
        out.push_str("\nNotes:\n");
    }
    for note in sheet.notes {
        let _ = writeln!(out, "  {}", one_line(&note.to_string()));
    }
    out
}
