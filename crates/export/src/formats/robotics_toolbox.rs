//! Python for the Robotics Toolbox: a `DHRobot`, standard or modified.

use super::{Format, RenderError};
use crate::numbers::exact;
use crate::sheet::Sheet;
use denavit_dh::{Convention, ConventionRow, Motion, RowLabel};
use denavit_model::words::{is_control, one_line};
use std::fmt::Write as _;

/// Python for the Robotics Toolbox.
pub const FORMAT: Format =
    Format { name: "rtb", extension: "py", purpose: "Python code for roboticstoolbox: a DHRobot", render };

const CANNOT: fn(&'static str, &'static str) -> RenderError =
    |what, instead| RenderError::CannotHold { format: "rtb", what, instead };

fn render(sheet: &Sheet) -> Result<String, RenderError> {
    let table = sheet.table;
    check(sheet, CANNOT)?;
    let modified = sheet.shown_convention() == Convention::Proximal;
    let suffix = if modified { "MDH" } else { "DH" };
    let rows = sheet.rows();
    let mut out = String::from("# Made by denavit; m and rad.\n");
    let _ = writeln!(out, "from roboticstoolbox import DHRobot, Prismatic{suffix}, Revolute{suffix}");
    out.push_str("from spatialmath import SE3\n\n\nrobot = DHRobot(\n    [\n");
    for row in &rows {
        let RowLabel::Joint(index) = row.label else { continue };
        let joint = &table.joints[index];
        let number = |value: Option<f64>| exact(value.unwrap_or(0.0));
        let limits = table.coordinates[joint.coordinate].limits.range;
        let limits =
            limits.map_or_else(String::new, |(lower, upper)| format!(", qlim=[{}, {}]", exact(lower), exact(upper)));
        let (a, alpha) = (number(row.a), number(row.alpha));
        let (theta, d) = (number(row.theta), number(row.d));
        let _ = match joint.motion {
            Motion::Prismatic => writeln!(
                out,
                "        Prismatic{suffix}(theta={theta}, a={a}, alpha={alpha}, offset={d}{limits}),  # {}",
                one_line(&joint.name)
            ),
            _ => writeln!(
                out,
                "        Revolute{suffix}(d={d}, a={a}, alpha={alpha}, offset={theta}{limits}),  # {}",
                one_line(&joint.name)
            ),
        };
    }
    let (base, tool) = (&rows[0], &rows[rows.len() - 1]);
    let _ = writeln!(out, "    ],\n    name={},", text(&table.name));
    let _ = writeln!(out, "    base={},\n    tool={},\n)", motion(base, modified), motion(tool, modified));
    Ok(out)
}

/// A name as Python text; all but plain characters are written as their code.
fn text(name: &str) -> String {
    let mut out = String::from("\"");
    for c in name.chars() {
        match c {
            '"' | '\\' => out.extend(['\\', c]),
            c if is_control(c) && u32::from(c) <= 0xff => {
                let _ = write!(out, "\\x{:02x}", u32::from(c));
            }
            c if is_control(c) => {
                let _ = write!(out, "\\u{:04x}", u32::from(c));
            }
            c => out.push(c),
        }
    }
    out + "\""
}

/// What code for other toolboxes can hold: joints that turn or slide by their own coordinate.
pub(super) fn check(sheet: &Sheet, cannot: fn(&'static str, &'static str) -> RenderError) -> Result<(), RenderError> {
    let table = sheet.table;
    if sheet.shown_convention() == Convention::Hayati {
        return Err(cannot("column for Hayati's beta", "use ‹convention› distal or proximal"));
    }
    if table.joints.iter().any(|joint| matches!(joint.motion, Motion::Helical(_))) {
        return Err(cannot("helical joint", "use ‹format› json or csv"));
    }
    let own = table.joints.iter().enumerate().all(|(index, joint)| joint.coordinate == index && joint.scale == 1.0);
    if own { Ok(()) } else { Err(cannot("joint that mimics another or has a scale", "use ‹format› json or csv")) }
}

/// The base's or tool's motion in spatialmath's words.
fn motion(row: &ConventionRow, modified: bool) -> String {
    let number = |value: Option<f64>| value.unwrap_or(0.0);
    let about_z = format!("SE3.Rz({}) * SE3.Tz({})", exact(number(row.theta)), exact(number(row.d)));
    let about_x = format!("SE3.Rx({}) * SE3.Tx({})", exact(number(row.alpha)), exact(number(row.a)));
    if row.alpha.is_none() {
        about_z
    } else if modified {
        format!("{about_x} * {about_z}")
    } else {
        format!("{about_z} * {about_x}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_end_no_line_and_no_text() {
        assert_eq!(text("a\"b\\c"), "\"a\\\"b\\\\c\"");
        assert_eq!(text("a\nb\u{7f}\u{2028}ä"), "\"a\\x0ab\\x7f\\u2028ä\"");
    }
}
