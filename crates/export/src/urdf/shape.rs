//! Whether joint origins already are rows.

use super::bodies::has_axis;
use super::written::{Numbers, clean};
use denavit_dh::straighten::ROUNDING;
use denavit_dh::table::{DhRow, HayatiRow, Row};
use denavit_model::nalgebra::{Unit, Vector3};
use denavit_model::robot::Robot;
use denavit_model::se3;

/// Rounding of a row after writing and reading: rad, and m relative to the origin's length.
const WRITTEN: f64 = 1e-14;

/// The same for a frame that is judged only by the next axis.
const ACROSS: f64 = 4e-14;

/// Axes closer to parallel than this (rad), or with the foot of their common normal farther away than this many times
/// the robot's size, may have Hayati's row.
const SURELY_PARALLEL: f64 = 1e-5;
const FAR: f64 = 1.0;

/// Axes farther than this (rad) from parallel have an ordinary D-H row.
const NEARLY_PARALLEL: f64 = 0.3;

pub(crate) fn has_z_axis(robot: &Robot, index: usize) -> bool {
    let joint = &robot.joints[index];
    !has_axis(&joint.kind) || joint.axis_written == Some([0.0, 0.0, 1.0])
}

/// The row that an origin is, if it is one: rpy = (alpha, 0, theta) and xyz = (a cos theta, a sin theta, d), or Hayati's
/// where the axes are nearly parallel and the four numbers would lead far away.
pub(crate) fn row_of(origin: &Numbers, size: f64) -> Option<Row> {
    row_within(origin, size, 0.0)
}

/// As [`row_of`], of an origin that carries the rounding of a length `carried`, m.
pub(crate) fn row_within(origin: &Numbers, size: f64, carried: f64) -> Option<Row> {
    let [x, y, z] = origin.xyz;
    let length = x.hypot(y).max(z.abs()).max(carried);
    let [alpha, pitch, theta] = origin.rpy;
    if pitch.abs() <= WRITTEN {
        let (sine, cosine) = se3::sin_cos_of_written(theta);
        let (along, across) = (x * cosine + y * sine, y * cosine - x * sine);
        return (across.abs() <= WRITTEN * length)
            .then(|| Row::Dh(DhRow { theta, d: z, alpha, a: exact_length(along, [x, y], [cosine, sine]) }));
    }
    // Rz(theta) Tx(a) Rx(alpha) Ry(beta).
    let rotation = se3::rotation_from_rpy(origin.rpy);
    let r = rotation.matrix();
    let theta = (-r[(0, 1)]).atan2(r[(1, 1)]);
    let (sine, cosine) = theta.sin_cos();
    let (along, across) = (x * cosine + y * sine, y * cosine - x * sine);
    let alpha = r[(2, 1)].atan2(cosine * r[(1, 1)] - sine * r[(0, 1)]);
    let beta = (cosine * r[(0, 2)] + sine * r[(1, 2)]).atan2(cosine * r[(0, 0)] + sine * r[(1, 0)]);
    let flat = z.abs() <= WRITTEN * length && across.abs() <= WRITTEN * length;
    let z_axis = rotation.matrix().column(2).into_owned();
    (flat && is_nearly_parallel(origin, &z_axis, size)).then_some(Row::Hayati(HayatiRow {
        theta,
        d: 0.0,
        a: along,
        alpha,
        beta,
    }))
}

/// Whether z and the next axis are too close to parallel to place a frame on their common normal.
fn is_nearly_parallel(origin: &Numbers, axis: &Vector3<f64>, size: f64) -> bool {
    let tilt = se3::angle_between(&Vector3::z(), axis).min(se3::angle_between(&-Vector3::z(), axis));
    let normal = Vector3::z().cross(axis);
    // How far along the axis before the foot of the common normal lies.
    let foot = Vector3::from(origin.xyz).cross(axis).dot(&normal) / normal.norm_squared();
    tilt > ROUNDING && tilt < NEARLY_PARALLEL && (foot.abs() > FAR * size || tilt < SURELY_PARALLEL)
}

/// The length whose products with cosine and sine give the written numbers: the decimal with the fewest digits.
fn exact_length(along: f64, [x, y]: [f64; 2], [cosine, sine]: [f64; 2]) -> f64 {
    let shorter = (12..=16).map(|digits| format!("{along:.digits$e}").parse::<f64>().unwrap_or(along));
    let neighbours = (0..8u32).scan(along.next_down().next_down().next_down().next_down(), |at, _| {
        *at = at.next_up();
        Some(*at)
    });
    let candidates: Vec<f64> = shorter.chain([along]).chain(neighbours).collect();
    let exactly = |a: &&f64| **a * cosine == x && **a * sine == y;
    let cleaned = |a: &&f64| clean(**a * cosine, a.abs()) == x && clean(**a * sine, a.abs()) == y;
    candidates.iter().find(exactly).or_else(|| candidates.iter().find(cleaned)).map_or(along, |a| *a) + 0.0
}

/// Whether the reference frame of an origin is at the foot of the common normal of its z and the next axis, its x
/// along that normal: the origin is Rx(alpha) Tx(a) Rz(theta) Tz(d) where the axis is its z. Or the two are nearly parallel.
pub(crate) fn is_proximal(origin: &Numbers, axis: &Unit<Vector3<f64>>, size: f64) -> bool {
    let direction = se3::rotation_from_rpy(origin.rpy) * axis.as_ref();
    let [x, y, z] = origin.xyz;
    // A frame that was placed along an axis carries the rounding of the robot's size.
    let length = x.abs().max(y.hypot(z)).max(size);
    // A line perpendicular to x that intersects it.
    let across = y * direction.z - z * direction.y;
    direction.x.abs() <= ACROSS && across.abs() <= ACROSS * length || is_nearly_parallel(origin, &direction, size)
}
