//! From screw axes to Denavit-Hartenberg numbers (Lemmas 1 to 4), for revolute, prismatic and helical joints in any mix.
//!
//! The frame on an axis is given by two neighbouring axes: z along the axis, x along the common normal with the one
//! before, origin at its foot. The remaining freedom (the sense of x, the position along parallel axes, the position of
//! a prismatic axis) is the gauge: the candidates come from `candidates`, the choice from [`crate::gauge`].
//!
//! Numerics: each row is computed from the frame that the rows before it *actually* give, so rounding does not accumulate;
//! d and a are solved for so that the next axis is reached to rounding, however close to parallel the two are.

use crate::candidates::{Target, candidates};
use crate::gauge::{Gauge, Weigher};
use crate::straighten::{Parallelism, angle_of_lines, straightened};
use crate::table::{DhRow, Motion, Row, Table, TableJoint, ToolPart};
use denavit_model::chain::{Chain, ChainError};
use denavit_model::nalgebra::Vector3;
use denavit_model::notes::{Note, Noted};
use denavit_model::se3::{self, Pose};
use std::f64::consts::{FRAC_PI_2, PI};

/// How to convert.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Options {
    /// When neighbours count as parallel.
    pub parallelism: Parallelism,
    /// Choice that the geometry does not determine.
    pub gauge: Gauge,
    /// What rows near-parallel neighbours get.
    pub near_parallel: NearParallel,
}

/// What rows near-parallel neighbours get.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum NearParallel {
    /// The usual four numbers, however large.
    #[default]
    Dh,
    /// Hayati's four where the angle between neighbours is below this, rad.
    HayatiBelow(f64),
}

/// Neighbours closer than this (rad) get Hayati's numbers when asked for: the common normal is then farther than some
/// ten times their distance.
pub const HAYATI_BELOW: f64 = 0.1;

/// A number larger than this many times the robot's size gets a note.
const FAR: f64 = 3.0;

/// The Denavit-Hartenberg numbers of a chain.
///
/// # Shape and units
/// n + 1 rows for n joints, rad and m. Joint offsets go into theta and d.
///
/// # Errors
/// As [`Chain::new`]; does not happen for a chain that was one.
///
/// # Source
/// Wu, Crawford, Roberts 2019, Lemmas 1-4 and eq. (10); atan2 forms throughout, where the published code takes arccos.
///
/// # Examples
/// ```
/// use denavit_dh::convert::{Options, table};
/// let chain = denavit_model::examples::puma_like();
/// let table = table(&chain, &Options::default())?.value;
/// let q = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6];
/// assert!((table.fk(&q).to_homogeneous() - chain.fk(&q).to_homogeneous()).norm() < 1e-14);
/// # Ok::<(), denavit_model::ChainError>(())
/// ```
pub fn table(chain: &Chain, options: &Options) -> Result<Noted<Table>, ChainError> {
    let chain = without_offsets(chain)?;
    let Noted { value: chain, mut notes } = match options.parallelism {
        Parallelism::Exact => Noted { value: chain, notes: Vec::new() },
        Parallelism::Within { angle } => straightened(&chain, angle)?,
    };
    let (rows, tool) = rows(&chain, options);
    let table = of_rows(&chain, rows, tool);
    notes.extend(far_numbers(&chain, &table));
    Ok(Noted { value: table, notes })
}

/// The table of a chain whose rows are known.
pub(crate) fn of_rows(chain: &Chain, rows: Vec<Row>, tool: ToolPart) -> Table {
    let joints = chain.joints().iter().map(|joint| TableJoint {
        name: joint.name.clone(),
        motion: Motion::of(&joint.screw),
        coordinate: joint.coordinate,
        scale: joint.scale,
    });
    Table {
        name: chain.name().to_owned(),
        base: chain.base().to_owned(),
        tip: chain.tip().to_owned(),
        coordinates: chain.coordinates().to_vec(),
        joints: joints.collect(),
        rows,
        tool,
    }
}

/// The same motion with every joint offset folded into the axes and the home pose.
pub(crate) fn without_offsets(chain: &Chain) -> Result<Chain, ChainError> {
    let mut moved = Pose::identity();
    let mut joints = Vec::new();
    for joint in chain.joints() {
        joints.push(denavit_model::ChainJoint { screw: joint.screw.moved(&moved), offset: 0.0, ..joint.clone() });
        moved *= joint.screw.motion(joint.offset);
    }
    let names = (chain.name(), chain.base(), chain.tip());
    Chain::new(names, chain.coordinates().to_vec(), joints, moved * chain.home())
}

/// A path from the base to some axis: the last row, the frame that it leads to, the cost, and the path before.
struct State {
    frame: Pose,
    row: Row,
    cost: f64,
    from: usize,
}

/// How many paths are kept at each axis; few differ.
const KEPT: usize = 64;

fn rows(chain: &Chain, options: &Options) -> (Vec<Row>, ToolPart) {
    let targets = Target::all(chain);
    let weigher = Weigher::new(options.gauge, chain);
    let start = State { frame: Pose::identity(), row: Row::Dh(DhRow::default()), cost: 0.0, from: 0 };
    let mut layers = vec![vec![start]];
    for index in 1..targets.len() {
        let mut layer: Vec<State> = Vec::new();
        for (from, state) in layers[index - 1].iter().enumerate() {
            let here = targets[index - 1].direction;
            for row in candidates(&state.frame, &here, &targets[index..], options, weigher.size()) {
                let mut frame = state.frame * row.pose();
                frame.rotation = se3::orthonormalised(&frame.rotation);
                let cost = state.cost + weigher.row(index - 1, &row);
                match layer.iter_mut().find(|known| weigher.same(&known.frame, &frame)) {
                    Some(known) if cost < known.cost => *known = State { frame, row, cost, from },
                    Some(_) => {}
                    None => layer.push(State { frame, row, cost, from }),
                }
            }
        }
        layer.sort_by(|a, b| a.cost.total_cmp(&b.cost));
        layer.truncate(KEPT);
        layers.push(layer);
    }
    let last = layers.last().map_or(&[][..], |layer| &layer[..]);
    let tools: Vec<ToolPart> = last.iter().map(|state| tool_part(&state.frame, chain.home(), weigher.size())).collect();
    let total = |index: &usize| last[*index].cost + weigher.tool(&tools[*index]);
    let mut best = (0..last.len()).min_by(|a, b| total(a).total_cmp(&total(b))).expect("every axis has a candidate");
    let tool = tools[best];
    let mut rows = Vec::new();
    for layer in layers[1..].iter().rev() {
        rows.push(layer[best].row);
        best = layer[best].from;
    }
    rows.reverse();
    (rows, tool)
}

/// The last row and the tool part of a table of `chain`, from the frame on its last joint's axis to the tip: what
/// [`table`] would choose if the frames before it were given.
///
/// # Shape and units
/// `flange` is the tip's pose in that frame, whose z is the last joint's axis; rad and m.
pub fn last_row(chain: &Chain, flange: &Pose, gauge: Gauge) -> (Row, ToolPart) {
    let weigher = Weigher::new(gauge, chain);
    let options = Options { gauge, ..Options::default() };
    let target = Target::tool(flange);
    let mut best: Option<(f64, Row, ToolPart)> = None;
    for row in candidates(&Pose::identity(), &Vector3::z(), &[target], &options, weigher.size()) {
        let tool = tool_part(&row.pose(), flange, weigher.size());
        let cost = weigher.row(chain.joints().len(), &row) + weigher.tool(&tool);
        if best.is_none_or(|(least, ..)| cost < least) {
            best = Some((cost, row, tool));
        }
    }
    let (_, row, tool) = best.expect("every axis has a candidate");
    (row, tool)
}

fn tool_part(frame: &Pose, home: &Pose, size: f64) -> ToolPart {
    let step = frame.inverse() * home;
    let r = step.rotation.matrix();
    let theta = (r[(1, 0)] - r[(0, 1)]).atan2(r[(0, 0)] + r[(1, 1)]);
    ToolPart { theta: tidy_angle(theta), d: tidy_length(step.translation.vector.z, size) }
}

/// The row from `frame` whose x axis is `x` and that meets the line through `point` along `direction`.
///
/// theta from x; alpha from the direction in the turned frame; then, with y' = z' × x: a is the offset along x, and d
/// from the offset along y', which alone sees it. `d_if_parallel` is taken where the axes are parallel.
pub(crate) fn dh_row(
    frame: &Pose,
    x: &Vector3<f64>,
    direction: &Vector3<f64>,
    point: &Vector3<f64>,
    d_if_parallel: Option<f64>,
    size: f64,
) -> DhRow {
    let local = frame.rotation.inverse();
    let x = local * x;
    let theta = tidy_angle(x.y.atan2(x.x));
    let turned = DhRow { theta, ..DhRow::default() }.pose().rotation.inverse();
    let z = turned * (local * direction);
    let offset = turned * (local * (point - frame.translation.vector));
    let alpha = if d_if_parallel.is_some() { if z.z < 0.0 { PI } else { 0.0 } } else { tidy_angle((-z.y).atan2(z.z)) };
    let (sine, cosine) = se3::sin_cos_of_written(alpha);
    // y' = (0, cos alpha, sin alpha): what is left of the offset across the new axis and x.
    let d = d_if_parallel.unwrap_or_else(|| (offset.y * cosine + offset.z * sine) / sine);
    DhRow { theta, d: tidy_length(d, size), alpha, a: tidy_length(offset.x, size) }
}

/// An angle in (-π, π], rounded to a quarter turn where only rounding keeps it from being one.
pub(crate) fn tidy_angle(angle: f64) -> f64 {
    let quarters = (angle / FRAC_PI_2).round();
    let angle = if (angle - quarters * FRAC_PI_2).abs() < 8.0 * f64::EPSILON { quarters * FRAC_PI_2 } else { angle };
    if angle <= -PI { PI } else { angle + 0.0 }
}

/// A length, rounded to nine places where only rounding keeps it from being so.
pub(crate) fn tidy_length(length: f64, size: f64) -> f64 {
    let rounded = (length * 1e9).round() / 1e9;
    if (length - rounded).abs() < 4.0 * f64::EPSILON * size { rounded + 0.0 } else { length }
}

fn far_numbers(chain: &Chain, table: &Table) -> Vec<Note> {
    let size = chain.size();
    let targets = Target::all(chain);
    let name = |index: usize| match index {
        0 => "base z".to_owned(),
        index if index <= chain.joints().len() => chain.joints()[index - 1].name.clone(),
        _ => "tool z".to_owned(),
    };
    let longest = |row: &Row| row.d().unwrap_or(0.0).abs().max(row.a().abs());
    let far: Vec<(usize, f64)> =
        table.rows.iter().map(longest).enumerate().filter(|(_, length)| *length > FAR * size).collect();
    let angle = |index: usize| angle_of_lines(&targets[index].direction, &targets[index + 1].direction);
    // A far common normal is named where the axes are near parallel; the way back from it gets no second note.
    let named: Vec<&(usize, f64)> = far.iter().filter(|(index, _)| angle(*index) < HAYATI_BELOW).collect();
    let named = if named.is_empty() { far.iter().collect() } else { named };
    let note = |(index, length): &(usize, f64)| Note::FarNumber {
        joints: (name(*index), name(index + 1)),
        angle: angle(*index),
        length: *length,
        size,
    };
    named.into_iter().map(note).collect()
}
