//! MATLAB for the Robotics System Toolbox: a `rigidBodyTree`.
//!
//! The toolbox's own `'dh'` form overwrites theta with the joint variable, which loses offsets: whole transforms are written
//! instead.

use super::{Format, RenderError, robotics_toolbox};
use crate::numbers::exact;
use crate::sheet::Sheet;
use denavit_dh::{ConventionRow, Motion, RowLabel};
use denavit_model::words::is_control;
use std::fmt::Write as _;

/// MATLAB for the Robotics System Toolbox.
pub const FORMAT: Format = Format { name: "matlab", extension: "m", purpose: "MATLAB code: a rigidBodyTree", render };

fn render(sheet: &Sheet) -> Result<String, RenderError> {
    robotics_toolbox::check(sheet, |what, instead| RenderError::CannotHold { format: "matlab", what, instead })?;
    let table = sheet.table;
    // The frame on a joint's axis is the body's: row i - 1 of the distal form leads to joint i.
    let rows = table.convention_rows(denavit_dh::Convention::Distal);
    let mut out = String::from("% Made by denavit; m and rad.\n");
    out.push_str("dh = @(theta, d, alpha, a) [ ...\n");
    out.push_str("    cos(theta), -sin(theta)*cos(alpha),  sin(theta)*sin(alpha), a*cos(theta); ...\n");
    out.push_str("    sin(theta),  cos(theta)*cos(alpha), -cos(theta)*sin(alpha), a*sin(theta); ...\n");
    out.push_str("    0,           sin(alpha),             cos(alpha),            d; ...\n");
    out.push_str("    0,           0,                      0,                     1];\n\n");
    out.push_str("robot = rigidBodyTree('DataFormat', 'row');\n");
    let _ = writeln!(out, "robot.BaseName = {};", quoted(&table.base));
    let mut parent = "robot.BaseName".to_owned();
    for (index, joint) in table.joints.iter().enumerate() {
        let kind = if joint.motion == Motion::Prismatic { "prismatic" } else { "revolute" };
        let body = quoted(&format!("{}_link", joint.name));
        let _ = writeln!(out, "\njoint = rigidBodyJoint({}, '{kind}');", quoted(&joint.name));
        let _ = writeln!(out, "setFixedTransform(joint, {});", call(&rows[index]));
        if let Some((lower, upper)) = table.coordinates[joint.coordinate].limits.range {
            let _ = writeln!(out, "joint.PositionLimits = [{}, {}];", exact(lower), exact(upper));
        }
        let _ = writeln!(out, "body = rigidBody({body});\nbody.Joint = joint;\naddBody(robot, body, {parent});");
        parent = body;
    }
    let n = table.joints.len();
    let tip = quoted(&table.tip);
    let _ = writeln!(out, "\nbody = rigidBody({tip});");
    let _ = writeln!(out, "setFixedTransform(body.Joint, {} * {});", call(&rows[n]), call(&rows[n + 1]));
    let _ = writeln!(out, "addBody(robot, body, {parent});");
    debug_assert_eq!(rows[n + 1].label, RowLabel::Tool);
    Ok(out)
}

fn call(row: &ConventionRow) -> String {
    let number = |value: Option<f64>| exact(value.unwrap_or(0.0));
    format!("dh({}, {}, {}, {})", number(row.theta), number(row.d), number(row.alpha), number(row.a))
}

/// A name as MATLAB text; letters that would end the line as numbers: `['elbow', char(10), 'x']`.
fn quoted(text: &str) -> String {
    if !text.contains(is_control) {
        return format!("'{}'", text.replace('\'', "''"));
    }
    let parts: Vec<String> = text
        .split_inclusive(is_control)
        .flat_map(|piece| {
            let control = piece.chars().last().filter(|c| is_control(*c));
            let words = piece.trim_end_matches(is_control);
            let words = (!words.is_empty()).then(|| format!("'{}'", words.replace('\'', "''")));
            words.into_iter().chain(control.map(|c| format!("char({})", u32::from(c)))).collect::<Vec<_>>()
        })
        .collect();
    format!("[{}]", parts.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_end_no_line_and_no_text() {
        assert_eq!(quoted("it's"), "'it''s'");
        assert_eq!(quoted("a\n% b'c\r"), "['a', char(10), '% b''c', char(13)]");
    }
}
