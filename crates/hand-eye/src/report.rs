//! A result as text, as JSON, as a static transform of ROS and as a joint of a URDF.

use crate::closed_form::homogeneous;
use crate::{Arrangement, Errors, HandEye, Placed, Unknown};
use denavit_model::{Pose, se3};
use serde::Serialize;
use std::fmt::Write as _;

/// Name and version of the result as JSON.
pub const SCHEMA: &str = "denavit.hand_eye/1";

/// Lines of rejected rows that are listed.
const LISTED: usize = 12;
/// With fewer rows the errors are unreliable.
const FEW: usize = 10;

/// Lines of the rows, and lines in which the target was not seen.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Lines<'a> {
    /// Of each row.
    pub rows: &'a [usize],
    /// Of rows in which nothing was seen.
    pub unseen: &'a [usize],
}

/// For a terminal: the result, its quality, and what to do.
pub fn text(found: &HandEye, lines: Lines) -> String {
    let used = found.residuals.iter().filter(|residual| !residual.rejected).count();
    let where_it_is = match found.arrangement {
        Arrangement::InstrumentStands => "instrument beside the robot, target on the hand",
        Arrangement::InstrumentOnHand => "instrument on the hand, target beside the robot",
    };
    let mut text = format!("hand-eye calibration of {used} pairs of poses\n{where_it_is}\n");
    if let Some(unknown) = &found.unknown {
        let _ = writeln!(text, "WARNING: {unknown}");
    }
    if !found.converged {
        text.push_str("WARNING: the fit did not converge; do not use it\n");
    }
    if used < FEW {
        let _ = writeln!(text, "WARNING: only {used} rows; with {FEW} or more the errors below are reliable");
    }
    for placed in [&found.base, &found.tip] {
        text.push_str(&placement(placed));
    }
    text.push('\n');
    let errors = |name: &str, errors: &Errors| {
        format!("{name:<28} {:>9.4} mm {:>9.4}°\n", errors.position_rms * 1e3, errors.orientation_rms.to_degrees())
    };
    text.push_str(&errors("rms of the fitted rows", &found.fitted));
    if let Some(held_out) = &found.held_out {
        text.push_str(&errors("rms of the held-out rows", held_out));
    }
    let apart: Vec<f64> =
        found.closed_forms.iter().filter_map(|form| form.apart.map(|[base, _]| base.0 * 1e3)).collect();
    if let (true, Some(most)) = (apart.len() > 1, apart.iter().copied().reduce(f64::max)) {
        let _ = writeln!(
            text,
            "the results of {} closed forms for {} are within {most:.3} mm of this",
            apart.len(),
            found.base.name
        );
    }
    let rejected: Vec<usize> = lines
        .rows
        .iter()
        .zip(&found.residuals)
        .filter(|(_, residual)| residual.rejected)
        .map(|(line, _)| *line)
        .collect();
    listed(&mut text, "rejected as gross outliers, lines: ", &rejected);
    listed(&mut text, "target not seen, lines: ", lines.unseen);
    text
}

fn listed(text: &mut String, what: &str, lines: &[usize]) {
    if !lines.is_empty() {
        let shown: Vec<String> = lines.iter().take(LISTED).map(usize::to_string).collect();
        let more = lines.len().saturating_sub(LISTED);
        let more = if more > 0 { format!(" and {more} more") } else { String::new() };
        let _ = writeln!(text, "{what}{}{more}", shown.join(", "));
    }
}

fn placement(placed: &Placed) -> String {
    let place = placed.pose.translation.vector;
    let turn = se3::rpy_from_rotation(&placed.pose.rotation).map(f64::to_degrees);
    let std = placed.std();
    let mut text = format!("\n{}\n", placed.name);
    let values = |values: [f64; 3], decimals: usize| values.map(|value| format!("{value:>11.decimals$}")).join(" ");
    let _ = writeln!(text, "  x y z, mm             {}", values([place.x, place.y, place.z].map(|x| x * 1e3), 3));
    let _ = writeln!(text, "    standard deviation  {}", values([std[0], std[1], std[2]].map(|x| x * 1e3), 3));
    let _ = writeln!(text, "  roll pitch yaw, °     {}", values(turn, 4));
    let _ = writeln!(text, "    turns about x y z ± {}", values([std[3], std[4], std[5]].map(f64::to_degrees), 4));
    text
}

/// As JSON, m and rad.
pub fn json(found: &HandEye, lines: Lines) -> String {
    #[derive(Serialize)]
    struct Side {
        matrix: [[f64; 4]; 4],
        xyz: [f64; 3],
        rpy: [f64; 3],
        quaternion_xyzw: [f64; 4],
        std: [f64; 6],
        covariance: Vec<Vec<f64>>,
    }
    #[derive(Serialize)]
    struct RowOut {
        line: usize,
        position_error_m: [f64; 3],
        orientation_error_rad: [f64; 3],
        rejected: bool,
    }
    #[derive(Serialize)]
    struct ErrorsOut {
        position_rms_m: f64,
        orientation_rms_rad: f64,
    }
    let side = |placed: &Placed| {
        let place = placed.pose.translation.vector;
        serde_json::to_value(Side {
            matrix: homogeneous(&placed.pose),
            xyz: [place.x, place.y, place.z],
            rpy: se3::rpy_from_rotation(&placed.pose.rotation),
            quaternion_xyzw: se3::quaternion_xyzw(&placed.pose.rotation),
            std: placed.std(),
            covariance: (0..6).map(|row| placed.covariance.row(row).iter().copied().collect()).collect(),
        })
    };
    let errors = |errors: &Errors| ErrorsOut {
        position_rms_m: errors.position_rms,
        orientation_rms_rad: errors.orientation_rms,
    };
    let rows: Vec<RowOut> = lines
        .rows
        .iter()
        .zip(&found.residuals)
        .map(|(line, residual)| {
            let [x, y, z, a, b, c] = residual.value.into();
            RowOut {
                line: *line,
                position_error_m: [x, y, z],
                orientation_error_rad: [a, b, c],
                rejected: residual.rejected,
            }
        })
        .collect();
    let value = serde_json::json!({
        "schema": SCHEMA,
        "arrangement": found.arrangement,
        "rows": found.residuals.len(),
        "rejected": found.residuals.iter().filter(|residual| residual.rejected).count(),
        "unseen_lines": lines.unseen,
        found.base.name: side(&found.base).expect("plain values"),
        found.tip.name: side(&found.tip).expect("plain values"),
        "noise": { "position_m": found.noise[0], "orientation_rad": found.noise[1] },
        "fitted": errors(&found.fitted),
        "held_out": found.held_out.as_ref().map(errors),
        "unknown": found.unknown.as_ref().map(|unknown: &Unknown| {
            serde_json::json!({ "detail": unknown, "message": unknown.to_string() })
        }),
        "closed_forms": found.closed_forms.iter().map(|form| serde_json::json!({
            "name": form.name,
            "determined": form.apart.is_some(),
            "base_apart_m": form.apart.map(|[(moved, _), _]| moved),
            "base_apart_rad": form.apart.map(|[(_, turned), _]| turned),
        })).collect::<Vec<_>>(),
        "converged": found.converged,
        "residuals": rows,
    });
    serde_json::to_string_pretty(&value).expect("plain values with text keys") + "\n"
}

/// Where the instrument is: its pose in its parent.
pub fn instrument(found: &HandEye) -> &Pose {
    match found.arrangement {
        Arrangement::InstrumentStands => &found.base.pose,
        Arrangement::InstrumentOnHand => &found.tip.pose,
    }
}

fn numbers(pose: &Pose) -> ([f64; 3], [f64; 4], [f64; 3]) {
    let place = pose.translation.vector;
    ([place.x, place.y, place.z], se3::quaternion_xyzw(&pose.rotation), se3::rpy_from_rotation(&pose.rotation))
}

fn escaped(name: &str) -> String {
    name.replace('&', "&amp;").replace('<', "&lt;").replace('"', "&quot;")
}

/// A launch file of ROS 2 with tf2_ros' static_transform_publisher.
pub fn ros_launch(pose: &Pose, parent: &str, child: &str) -> String {
    let ([x, y, z], [qx, qy, qz, qw], _) = numbers(pose);
    let (parent, child) = (escaped(parent), escaped(child));
    format!(
        "<launch>\n  <node pkg=\"tf2_ros\" exec=\"static_transform_publisher\"\n        args=\"--x {x} --y {y} --z {z} --qx {qx} --qy {qy} \
         --qz {qz} --qw {qw}\n              --frame-id {parent} --child-frame-id {child}\"/>\n</launch>\n"
    )
}

/// A transform as geometry_msgs/TransformStamped writes it.
pub fn ros_yaml(pose: &Pose, parent: &str, child: &str) -> String {
    let ([x, y, z], [qx, qy, qz, qw], _) = numbers(pose);
    let quoted = |name: &str| serde_json::to_string(name).expect("a text");
    format!(
        "header:\n  frame_id: {}\nchild_frame_id: {}\ntransform:\n  translation: {{x: {x:?}, y: {y:?}, z: {z:?}}}\n  rotation: {{x: \
         {qx:?}, y: {qy:?}, z: {qz:?}, w: {qw:?}}}\n",
        quoted(parent),
        quoted(child)
    )
}

/// A link and the fixed joint that places it, for a URDF.
pub fn urdf(pose: &Pose, parent: &str, child: &str) -> String {
    let ([x, y, z], _, [roll, pitch, yaw]) = numbers(pose);
    let (parent, child) = (escaped(parent), escaped(child));
    format!(
        "<link name=\"{child}\"/>\n<joint name=\"{parent}_to_{child}\" type=\"fixed\">\n  <origin xyz=\"{x} {y} {z}\" rpy=\"{roll} \
         {pitch} {yaw}\"/>\n  <parent link=\"{parent}\"/>\n  <child link=\"{child}\"/>\n</joint>\n"
    )
}
