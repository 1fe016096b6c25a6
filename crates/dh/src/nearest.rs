//! The table of a chain on the branch of a given table: the numbers of a real arm, comparable with those of its drawing.
//!
//! A chain has many tables: x of each frame may point either way, d along parallel axes is free, and so is the place of a sliding
//! axis. [`crate::convert::table`] takes the most readable one; a small tilt of an axis may then reverse a frame, and the tables cannot
//! be subtracted. Here each row takes the choice whose numbers are nearest to those of the given row:
//!
//! ```text
//! chain(q) = base · table(q) · tool        base and tool: near 1, what a controller's table has no number for
//! ```
//! - Where the given row has parallel axes the row is Hayati's, with the given d: five numbers, so that none of them is large.
//! - Where the base's z axis is given along the first joint's, the base moves to the real axis, by the least turn and the least
//!   way; numbers of the base row stay. A controller's base is where its first axis is.
//! - Where the tool's z axis is given along the last joint's, theta and d of the last row take their parts, and the tool the rest.

use crate::convert::{dh_row, of_rows, without_offsets};
use crate::straighten::{ROUNDING, angle_of_lines};
use crate::table::{DhRow, HayatiRow, Row, Table, ToolPart};
use denavit_model::chain::{Chain, ChainError};
use denavit_model::nalgebra::{Point3, Rotation3, Vector3};
use denavit_model::screw::Screw;
use denavit_model::se3::{self, Pose};
use std::f64::consts::PI;

/// A given link twist nearer to 0 or a half turn than this, rad, is that of parallel axes.
const PARALLEL: f64 = 1e-6;

/// The parameters for parallel axes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Parallels {
    /// Hayati's numbers, which stay small.
    #[default]
    Hayati,
    /// The usual four, d of any size: for controllers without beta.
    Dh,
}

/// A chain's table on the branch of a given one.
#[derive(Debug, Clone, PartialEq)]
pub struct Nearest {
    /// chain_base_from_table_base.
    pub base: Pose,
    /// Joints, coordinates and names of the given table, other numbers.
    pub table: Table,
    /// table_tip_from_chain_tip.
    pub tool: Pose,
}

/// The table of `chain` that is nearest to `given`, joint for joint.
///
/// # Shape and units
/// rad and m; the chain has the joints of the table, and about its base, zeros and senses.
///
/// # Errors
/// Another number of joints, or a number that is not finite.
///
/// # Validation
/// tests/nearest.rs: tables that UR's controllers hold, as actual beside nominal.
pub fn nearest(chain: &Chain, given: &Table, parallels: Parallels) -> Result<Nearest, ChainError> {
    let count = given.joints.len();
    if given.rows.len() != count + 1 || chain.joints().len() != count {
        return Err(ChainError::Rows { rows: given.rows.len(), joints: chain.joints().len() });
    }
    let chain = without_offsets(chain)?;
    let size = chain.size();
    let base = base(&chain, given);
    let home = base.inverse() * chain.home();
    let screws: Vec<Screw> = chain.joints().iter().map(|joint| joint.screw.moved(&base.inverse())).collect();
    let mut rows = Vec::new();
    let mut frame = Pose::identity();
    for (index, screw) in screws.iter().enumerate() {
        let row = given.row(index);
        let line = match screw.line() {
            Some(line) => *line,
            // A slide has no place: it takes the given one.
            None => denavit_model::AxisLine {
                direction: screw.direction(),
                point: Point3::from((frame * row.pose()).translation.vector),
            },
        };
        let next = next_row(&frame, &row, (&line.direction, &line.point.coords), size, (index == 0, parallels));
        frame *= next.pose();
        frame.rotation = se3::orthonormalised(&frame.rotation);
        rows.push(next);
    }
    let (last, tool_part, tool) = last(&frame, &home, given, size);
    rows.push(last);
    let mut table = of_rows(&chain, rows, tool_part);
    for (joint, given) in table.joints.iter_mut().zip(&given.joints) {
        joint.name.clone_from(&given.name);
    }
    Ok(Nearest { base, table, tool })
}

impl Nearest {
    /// The same with base and tool as rows of the table: theta of the first and of the last row then count from where their common
    /// normals are, which may be anywhere about axes that nearly coincide; all other numbers stay.
    pub fn in_one_table(&self) -> Table {
        let mut table = self.table.clone();
        let count = table.joints.len();
        let size = table.chain().map_or(1.0, |chain| chain.size());
        let row = |pose: &Pose, given: &Row| {
            let z = pose.rotation * Vector3::z();
            let row = hayati(&Pose::identity(), given, (&z, &pose.translation.vector), size);
            let rest = row.pose().inverse() * pose;
            let r = rest.rotation.matrix();
            (Row::Hayati(row), (r[(1, 0)] - r[(0, 1)]).atan2(r[(0, 0)] + r[(1, 1)]), rest.translation.z)
        };
        if self.tool != Pose::identity() {
            let last = table.row(count);
            let (row, theta, d) = row(&(last.pose() * table.tool.pose() * self.tool), &last);
            table.rows[count] = row;
            table.tool = ToolPart { theta, d };
        }
        if self.base != Pose::identity() {
            let first = table.row(0);
            let (row, theta, d) = row(&(self.base * first.pose()), &first);
            table.rows[0] = row;
            match table.rows.get_mut(1) {
                Some(Row::Dh(next)) => (next.theta, next.d) = (near(next.theta + theta, 0.0), next.d + d),
                Some(Row::Hayati(next)) => (next.theta, next.d) = (near(next.theta + theta, 0.0), next.d + d),
                None => table.tool = ToolPart { theta: table.tool.theta + theta, d: table.tool.d + d },
            }
        }
        table
    }
}

/// Whether a row leads to a parallel axis, as it is given.
pub fn is_parallel(row: &Row) -> bool {
    row.beta().is_some() || row.alpha().sin().abs() < PARALLEL
}

/// Pose of the table's base in the chain's base.
fn base(chain: &Chain, given: &Table) -> Pose {
    let row = given.row(0);
    let Some(first) = chain.joints().first().filter(|_| is_parallel(&row)) else { return Pose::identity() };
    let drawn = row.pose();
    let z = drawn.rotation * Vector3::z();
    let direction = first.screw.direction();
    let turn = Rotation3::rotation_between(&z, &direction).unwrap_or_else(Rotation3::identity);
    let place = Point3::from(drawn.translation.vector);
    let place = first.screw.line().map_or(place, |line| line.nearest_to(&place));
    let real = se3::pose(se3::orthonormalised(&(turn * drawn.rotation)), place.coords);
    let base = real * drawn.inverse();
    let (turned, moved) = se3::difference(&base, &Pose::identity());
    if turned <= ROUNDING && moved <= ROUNDING * chain.size() { Pose::identity() } else { base }
}

/// The row from `frame` to the line, of those there are the nearest to `given`.
fn next_row(
    frame: &Pose,
    given: &Row,
    (direction, point): (&Vector3<f64>, &Vector3<f64>),
    size: f64,
    (first, parallels): (bool, Parallels),
) -> Row {
    let z = frame.rotation * Vector3::z();
    if is_parallel(given) {
        let hayati = hayati(frame, given, (direction, point), size);
        let exactly = hayati.beta == 0.0 && (hayati.alpha.abs() < ROUNDING || PI - hayati.alpha.abs() < ROUNDING);
        let plain = DhRow { theta: hayati.theta, d: hayati.d, alpha: hayati.alpha, a: hayati.a };
        return match parallels {
            // The base is on the first axis already.
            _ if first => *given,
            _ if exactly => Row::Dh(plain),
            Parallels::Dh if angle_of_lines(&z, direction) > ROUNDING => {
                crossing(frame, given, (direction, point), size)
            }
            _ => Row::Hayati(hayati),
        };
    }
    if angle_of_lines(&z, direction) <= ROUNDING {
        return Row::Hayati(hayati(frame, given, (direction, point), size));
    }
    crossing(frame, given, (direction, point), size)
}

fn crossing(frame: &Pose, given: &Row, (direction, point): (&Vector3<f64>, &Vector3<f64>), size: f64) -> Row {
    let normal = (frame.rotation * Vector3::z()).cross(direction).normalize();
    let rows = [1.0, -1.0].map(|sign| dh_row(frame, &(normal * sign), direction, point, None, size));
    let away = |row: &DhRow| {
        let alpha = near(row.alpha, given.alpha()) - given.alpha();
        (near(row.theta, given.theta()) - given.theta()).abs() + alpha.abs()
    };
    let row = if away(&rows[1]) < away(&rows[0]) { rows[1] } else { rows[0] };
    let theta = near(row.theta, given.theta());
    Row::Dh(DhRow { theta, alpha: near(row.alpha, given.alpha()), ..row })
}

/// Rz(theta) Tz(d) Tx(a) Rx(alpha) Ry(beta) with the given d.
fn hayati(frame: &Pose, given: &Row, (direction, point): (&Vector3<f64>, &Vector3<f64>), size: f64) -> HayatiRow {
    let d = given.d().unwrap_or(0.0);
    let level = frame * DhRow { d, ..DhRow::default() }.pose();
    let back = level.rotation.inverse();
    let direction = back * direction;
    let offset = back * (point - level.translation.vector);
    let cut = offset - direction * (offset.z / direction.z);
    let across = cut.x.hypot(cut.y);
    // Axes that are drawn as one, or nearly so, give theta no meaning: it stays.
    let theta = if across <= ROUNDING * size {
        given.theta()
    } else {
        let along = cut.y.atan2(cut.x);
        let both = [along, along + PI].map(|theta| near(theta, given.theta()));
        if (both[1] - given.theta()).abs() < (both[0] - given.theta()).abs() { both[1] } else { both[0] }
    };
    let turn = DhRow { theta, ..DhRow::default() }.pose().rotation.inverse();
    let (turned, cut) = (turn * direction, turn * cut);
    let beta = turned.x.atan2(turned.y.hypot(turned.z));
    let alpha = near((-turned.y).atan2(turned.z), given.alpha());
    let small = |angle: f64| if angle.abs() <= ROUNDING { 0.0 } else { angle };
    HayatiRow { theta, d, a: cut.x, alpha, beta: small(beta) }
}

/// The row after the last joint, the tool's part, and the rest.
fn last(frame: &Pose, home: &Pose, given: &Table, size: f64) -> (Row, ToolPart, Pose) {
    let row = given.row(given.joints.len());
    if is_parallel(&row) {
        let drawn = row.pose() * given.tool.pose();
        let real = frame.inverse() * home;
        let turn = (real.rotation * drawn.rotation.inverse()).into_inner();
        let theta = row.theta() + (turn[(1, 0)] - turn[(0, 1)]).atan2(turn[(0, 0)] + turn[(1, 1)]);
        let slid = real.translation.z - drawn.translation.z;
        let next = match row {
            Row::Dh(row) => Row::Dh(DhRow { theta, d: row.d + slid, ..row }),
            Row::Hayati(row) => Row::Hayati(HayatiRow { theta, d: row.d + slid, ..row }),
        };
        let tool = (next.pose() * given.tool.pose()).inverse() * real;
        let (turned, moved) = se3::difference(&tool, &Pose::identity());
        let rest = if turned <= ROUNDING && moved <= ROUNDING * size { Pose::identity() } else { tool };
        return (next, given.tool, rest);
    }
    let rotation = home.rotation.matrix();
    let (z, place) = (rotation.column(2).into_owned(), home.translation.vector);
    let next = next_row(frame, &row, (&z, &place), size, (false, Parallels::Hayati));
    let step = (frame * next.pose()).inverse() * home;
    let r = step.rotation.matrix();
    let theta = near((r[(1, 0)] - r[(0, 1)]).atan2(r[(0, 0)] + r[(1, 1)]), given.tool.theta);
    (next, ToolPart { theta, d: step.translation.z }, Pose::identity())
}

/// The angle, a whole number of turns away, that is nearest to another.
fn near(angle: f64, to: f64) -> f64 {
    angle - ((angle - to) / (2.0 * PI)).round() * 2.0 * PI
}
