//! LaTeX with booktabs.

use super::{Format, RenderError};
use crate::sheet::Sheet;
use std::fmt::Write as _;

/// LaTeX with booktabs.
pub const FORMAT: Format =
    Format { name: "tex", extension: "tex", purpose: "LaTeX table, needs \\usepackage{booktabs}", render };

fn render(sheet: &Sheet) -> Result<String, RenderError> {
    let columns = sheet.number_columns();
    let angle = match sheet.units.angle {
        crate::numbers::AngleUnit::Degree => "$^\\circ$",
        crate::numbers::AngleUnit::Radian => "rad",
    };
    let length = sheet.units.length_word();
    let head = columns.iter().map(|column| match *column {
        "theta" => format!("$\\theta$ ({angle})"),
        "alpha" => format!("$\\alpha$ ({angle})"),
        "beta" => format!("$\\beta$ ({angle})"),
        other => format!("${other}$ ({length})"),
    });
    let head: Vec<String> = head.collect();
    let mut out = String::from("% \\usepackage{booktabs}\n\\begin{table}\n  \\centering\n");
    let caption =
        format!("{}: {} to {}, {}.", sheet.table.name, sheet.table.base, sheet.table.tip, sheet.convention_words());
    let _ = writeln!(out, "  \\caption{{{}}}", escaped(&caption));
    let _ = writeln!(out, "  \\begin{{tabular}}{{lll{}}}\n    \\toprule", "r".repeat(columns.len()));
    let _ = writeln!(out, "    row & joint & kind & {} \\\\\n    \\midrule", head.join(" & "));
    for row in sheet.text_rows(|k| format!("q_{{{k}}}")) {
        let numbers: Vec<String> =
            row.numbers.iter().map(|cell| if cell.is_empty() { String::new() } else { format!("${cell}$") }).collect();
        let _ =
            writeln!(out, "    {} & {} & {} & {} \\\\", row.label, escaped(&row.joint), row.kind, numbers.join(" & "));
    }
    out.push_str("    \\bottomrule\n  \\end{tabular}\n\\end{table}\n");
    for note in sheet.notes {
        let _ = writeln!(out, "% {note}");
    }
    Ok(out)
}

/// Text in which LaTeX's own characters stand for themselves.
fn escaped(text: &str) -> String {
    let mut out = String::new();
    for c in text.chars() {
        match c {
            '\\' => out.push_str("\\textbackslash{}"),
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
