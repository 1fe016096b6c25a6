//! Reads the table of a canonical URDF.

use super::bodies::{Bodies, has_axis};
use super::from_table::is_made_from_table;
use super::shape::{row_of, row_within};
use super::written::Numbers;
use denavit_dh::table::{DhRow, Motion, Row, Table, TableJoint, ToolPart};
use denavit_dh::{Gauge, convert};
use denavit_model::chain::Chain;
use denavit_model::robot::{JointKind, Robot};
use denavit_model::se3::Pose;
use denavit_model::tree::Reading;
use std::f64::consts::{PI, TAU};

/// The Denavit-Hartenberg numbers of the joint origins, if every joint from base to tip is in canonical form;
/// otherwise `None`.
///
/// The numbers and the gauge are those of the file, with angles within half a turn (digit for digit if
/// [`super::from_table`] made the file). In such a file the part from the last joint to the tip is a row and a tool
/// part; in other files they are chosen as in a table of the robot ([`denavit_dh::convert::last_row`]). Also `None`
/// if the last joint carries the tip itself.
pub fn read_off(robot: &Robot, base: Option<&str>, tip: Option<&str>, reading: Reading) -> Option<Table> {
    let chain = robot.chain(base, tip, reading).ok()?.value;
    let bodies = Bodies::of(robot, reading);
    let way = way(robot, &bodies, &chain)?;
    let mut rows = Vec::new();
    let mut joints: Vec<TableJoint> = Vec::new();
    // Fixed joints since the last row, and what a mimic's offset adds to the next one.
    let mut between: Vec<Numbers> = Vec::new();
    let (mut turn, mut slide) = (0.0, 0.0);
    let mut left = chain.joints().iter().peekable();
    for index in way {
        let joint = &robot.joints[index];
        if joint.kind == JointKind::Fixed {
            between.push(bodies.origins[index]);
            continue;
        }
        let z = bodies.axes[index].z;
        if !has_axis(&joint.kind) || z.abs() != 1.0 {
            return None;
        }
        let Some(of) = left.next_if(|next| next.name == joint.name) else {
            // The slide that the turn before it drives: both are one helical joint.
            let helical = joints.last().is_some_and(|last| matches!(last.motion, Motion::Helical(_)));
            let in_place = between.iter().all(is_nothing) && is_nothing(&bodies.origins[index]);
            if helical && in_place && joint.kind == JointKind::Prismatic && joint.mimic.as_ref()?.offset == 0.0 {
                continue;
            }
            return None;
        };
        rows.push(row_with(&between, bodies.origins[index], bodies.size, (turn, slide))?);
        between.clear();
        (turn, slide) = (0.0, 0.0);
        let motion = Motion::of(&of.screw);
        match motion {
            Motion::Prismatic => slide = z * of.offset,
            Motion::Revolute => turn = z * of.offset,
            Motion::Helical(_) if of.offset != 0.0 => return None,
            Motion::Helical(_) => {}
        }
        joints.push(TableJoint { name: of.name.clone(), motion, coordinate: of.coordinate, scale: z * of.scale });
    }
    // The frame of a tip that a joint carries directly is a row only by chance.
    if left.peek().is_some() || between.is_empty() && !joints.is_empty() {
        return None;
    }
    let (last, tool) = tail(&between, is_made_from_table(robot), &chain, bodies.size, (turn, slide))?;
    rows.push(last);
    if !is_made_from_table(robot) {
        rows.iter_mut().for_each(within_half_a_turn);
    }
    Some(Table {
        name: chain.name().to_owned(),
        base: chain.base().to_owned(),
        tip: chain.tip().to_owned(),
        coordinates: chain.coordinates().to_vec(),
        joints,
        rows,
        tool,
    })
}

/// Angles as tables have them, in (-π, π].
fn within_half_a_turn(row: &mut Row) {
    let within = |angle: f64| {
        let turned = if angle > -PI && angle <= PI { angle } else { angle - TAU * (angle / TAU).round() };
        if turned <= -PI { turned + TAU } else { turned }
    };
    if let Row::Dh(row) = row {
        (row.theta, row.alpha) = (within(row.theta), within(row.alpha));
    }
}

/// Joints from base down to tip; `None` where the chain runs up the tree.
fn way(robot: &Robot, bodies: &Bodies, chain: &Chain) -> Option<Vec<usize>> {
    let (base, mut at) = (robot.link_index(chain.base())?, robot.link_index(chain.tip())?);
    let mut way = Vec::new();
    while at != base {
        let joint = bodies.to_parent[at]?;
        way.push(joint);
        at = robot.joints[joint].parent;
    }
    way.reverse();
    Some(way)
}

fn is_nothing(numbers: &Numbers) -> bool {
    *numbers == Numbers::default()
}

/// The row of a joint's origin after fixed joints, including the mimic offset of the previous joint.
fn row_with(between: &[Numbers], origin: Numbers, size: f64, offset: (f64, f64)) -> Option<Row> {
    if between.iter().all(is_nothing) {
        return taken_in(row_of(&origin, size)?, offset);
    }
    let pose = between.iter().fold(Pose::identity(), |pose, numbers| pose * numbers.pose()) * origin.pose();
    taken_in(row_within(&Numbers::of(&pose, size), size, size)?, offset)
}

fn taken_in(row: Row, (turn, slide): (f64, f64)) -> Option<Row> {
    match row {
        row if turn == 0.0 && slide == 0.0 => Some(row),
        Row::Dh(row) => Some(Row::Dh(DhRow { theta: row.theta + turn, d: row.d + slide, ..row })),
        Row::Hayati(_) => None,
    }
}

/// The last row and the tool part: from the file if it was made from a table, otherwise as in a table of the robot.
fn tail(
    between: &[Numbers],
    made_from_table: bool,
    chain: &Chain,
    size: f64,
    offset: (f64, f64),
) -> Option<(Row, ToolPart)> {
    let turned = |numbers: &Numbers| match row_of(numbers, size) {
        Some(Row::Dh(DhRow { theta, d, alpha: 0.0, a: 0.0 })) => Some(ToolPart { theta, d }),
        _ => None,
    };
    let as_it_stands = match between {
        [last] if made_from_table => row_of(last, size).map(|row| (row, ToolPart::default())),
        [last, tool] if made_from_table => row_of(last, size).zip(turned(tool)),
        _ => None,
    };
    let flange = || between.iter().fold(Pose::identity(), |pose, numbers| pose * numbers.pose());
    let (row, tool) = as_it_stands.unwrap_or_else(|| convert::last_row(chain, &flange(), Gauge::Simple));
    Some((taken_in(row, offset)?, tool))
}
