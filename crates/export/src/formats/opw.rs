//! Parameters of an ortho-parallel arm with a spherical wrist, as ROS-Industrial's opw_kinematics takes them.

use super::{Format, RenderError};
use crate::makers::opw::{GEOMETRY, OFFSETS, SIGNS};
use crate::sheet::Sheet;
use denavit_dh::matching::Verdict;
use denavit_dh::opw::{CONFIGURATIONS, OpwFit};
use denavit_model::words::one_line;
use std::fmt::Write as _;

/// An OPW file.
pub const FORMAT: Format = Format {
    name: "opw",
    extension: "opw.yaml",
    purpose: "OPW parameters of a six-axis arm, for opw_kinematics; states the fit error",
    render,
};

fn render(sheet: &Sheet) -> Result<String, RenderError> {
    let other = |why: String| RenderError::OtherRobots { format: "opw", why };
    let chain = sheet.table.chain().map_err(|error| other(error.to_string()))?;
    let fit = OpwFit::of(&chain).map_err(|error| other(error.to_string()))?;
    let verdict = Verdict::of(fit.position_error);
    let error = format!("{:.6} mm, {:.1e} rad", fit.position_error * 1e3, fit.rotation_error);
    if verdict > Verdict::Close {
        return Err(other(format!(
            "the arm is not of this kind: largest tip error of the nearest one {error} over {CONFIGURATIONS} joint \
             values"
        )));
    }
    let (name, base, tip) = (one_line(chain.name()), one_line(chain.base()), one_line(chain.tip()));
    let mut out = format!("# {name}: {base} to {tip}; made by denavit; m and rad\n");
    if verdict > Verdict::Exact {
        out.push_str("# The arm is not exactly of this kind; these are the parameters of the nearest one.\n");
    }
    let _ = writeln!(out, "# Largest tip error over {CONFIGURATIONS} joint values: {error}.");
    let arm = fit.parameters;
    let _ = writeln!(out, "{GEOMETRY}:");
    let lengths =
        [("a1", arm.a1), ("a2", arm.a2), ("b", arm.b), ("c1", arm.c1), ("c2", arm.c2), ("c3", arm.c3), ("c4", arm.c4)];
    for (key, value) in lengths {
        // To a picometre: 0.5, not 0.49999999999999994.
        let _ = writeln!(out, "  {key}: {:?}", (value * 1e12).round() / 1e12 + 0.0);
    }
    let list = |values: [f64; 6]| values.map(|value| format!("{:?}", value + 0.0)).join(", ");
    let _ = writeln!(out, "{OFFSETS}: [{}]", list(arm.offsets));
    let signs = arm.signs.map(|sign| if sign < 0.0 { "-1" } else { "1" }).join(", ");
    let _ = writeln!(out, "{SIGNS}: [{signs}]");
    Ok(out)
}
