//! LaTeX with booktabs.

use super::{Format, RenderError};
use crate::sheet::Sheet;
use denavit_model::words::{is_control, one_line};
use std::fmt::Write as _;

/// LaTeX with booktabs.
pub const FORMAT: Format = Format {
    name: "tex",
    extension: "tex",
    purpose: "LaTeX table for one column or two, needs \\usepackage{booktabs}",
    render,
};

/// Widths of a column and of both in the usual two-column styles, pt.
const COLUMN: f64 = 240.0;
const PAGE: f64 = 500.0;
/// In \footnotesize, pt: average width of a letter, and the gap between two columns.
const LETTER: f64 = 4.6;
const BETWEEN: f64 = 6.0;

fn render(sheet: &Sheet) -> Result<String, RenderError> {
    let columns = sheet.number_columns();
    let angle = match sheet.units.angle {
        crate::numbers::AngleUnit::Degree => "$^\\circ$",
        crate::numbers::AngleUnit::Radian => "rad",
    };
    let length = sheet.units.length_word();
    let rows = sheet.text_rows(|k| format!("q_{{{k}}}"));
    // A column with "revolute" in every row is omitted.
    let mixed = rows.iter().any(|row| !row.kind.is_empty() && row.kind != "revolute");
    let mut head = vec!["row".to_owned(), "joint".to_owned()];
    head.extend(mixed.then(|| "kind".to_owned()));
    head.extend(columns.iter().map(|column| match *column {
        "theta" => format!("$\\theta$ ({angle})"),
        "alpha" => format!("$\\alpha$ ({angle})"),
        "beta" => format!("$\\beta$ ({angle})"),
        other => format!("${other}$ ({length})"),
    }));
    let words = head.len() - columns.len();
    let line = |row: &crate::sheet::TextRow| -> Vec<String> {
        let cells = [row.label.clone(), escaped(&row.joint)].into_iter().chain(mixed.then(|| row.kind.clone()));
        let number = |cell: &String| if cell.is_empty() { String::new() } else { format!("${cell}$") };
        cells.chain(row.numbers.iter().map(number)).collect()
    };
    let mut lines = vec![head];
    lines.extend(rows.iter().map(line));
    let width = width(&lines);
    let (place, fits) = (if width > COLUMN { "table*" } else { "table" }, width <= PAGE);
    let mut out = String::from(if fits { "% \\usepackage{booktabs}\n" } else { "% \\usepackage{booktabs,graphicx}\n" });
    let _ = writeln!(out, "\\begin{{{place}}}\n  \\centering");
    let all_revolute = if mixed || sheet.table.joints.is_empty() { "" } else { ", all joints revolute" };
    let caption = format!(
        "{}: {} to {}, {}{all_revolute}.",
        sheet.table.name,
        sheet.table.base,
        sheet.table.tip,
        sheet.convention_words()
    );
    let _ = writeln!(out, "  \\caption{{{}}}\n  \\label{{tab:dh-{}}}", breakable(&caption), label(&sheet.table.name));
    out.push_str("  \\footnotesize\n  \\setlength{\\tabcolsep}{3pt}\n");
    if !fits {
        out.push_str("  \\resizebox{\\linewidth}{!}{%\n");
    }
    let _ = writeln!(out, "  \\begin{{tabular}}{{{}{}}}\n    \\toprule", "l".repeat(words), "r".repeat(columns.len()));
    for (index, line) in lines.iter().enumerate() {
        let _ = writeln!(out, "    {} \\\\", line.join(" & "));
        if index == 0 {
            out.push_str("    \\midrule\n");
        }
    }
    let _ = writeln!(out, "    \\bottomrule\n  \\end{{tabular}}{}\n\\end{{{place}}}", if fits { "" } else { "}" });
    for note in sheet.notes {
        let _ = writeln!(out, "% {}", one_line(&note.to_string()));
    }
    Ok(out)
}

/// About how wide the table is, pt.
fn width(lines: &[Vec<String>]) -> f64 {
    let letters = |cell: &str| {
        let marks = cell.chars().filter(|c| "$\\{}".contains(*c)).count();
        let words = if cell.contains("\\theta") || cell.contains("\\alpha") || cell.contains("\\beta") { 4 } else { 0 };
        let spread = cell.matches(" + ").count() + cell.matches(" - ").count();
        (cell.chars().count() + spread).saturating_sub(marks + words + cell.matches("circ").count() * 4)
    };
    let columns = lines.first().map_or(0, Vec::len);
    let widest = |column: usize| lines.iter().map(|line| letters(&line[column])).max().unwrap_or(0) as f64;
    (0..columns).map(|column| widest(column) * LETTER + BETWEEN).sum()
}

/// A name as a label: letters, digits, hyphens.
fn label(name: &str) -> String {
    let plain = |c: char| if c.is_ascii_alphanumeric() { c.to_ascii_lowercase() } else { '-' };
    let label: String = name.chars().map(plain).collect();
    if label.is_empty() { "robot".to_owned() } else { label }
}

/// Text whose long names may be broken after an underscore.
fn breakable(text: &str) -> String {
    escaped(text).replace("\\_", "\\_\\allowbreak ")
}

/// Text with LaTeX's special characters escaped.
fn escaped(text: &str) -> String {
    let mut out = String::new();
    for c in text.chars() {
        match c {
            '\\' => out.push_str("\\textbackslash{}"),
            c if is_control(c) => out.push(' '),
            '~' => out.push_str("\\textasciitilde{}"),
            '^' => out.push_str("\\textasciicircum{}"),
            '_' | '&' | '%' | '$' | '#' | '{' | '}' => {
                out.push('\\');
                out.push(c);
            }
            c => out.push(c),
        }
    }
    out
}
