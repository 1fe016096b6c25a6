//! The D-H frames of a whole tree, and the joint origins that lead to them.
//!
//! The tree is cut into paths: first the one to the tip of the table, then, from the frames already placed, the
//! longest remaining path, until every joint has its frame. Each path is a chain whose rows come from
//! [`denavit_dh::convert::table`]: joint origin = row, so that the file shows the table.

use super::bodies::{Bodies, has_axis};
use super::shape::{has_z_axis, is_proximal, row_within};
use super::written::{Numbers, clean, clean_angle};
use super::{ExportError, Frames, LinkFrames, Options};
use denavit_dh::straighten::ROUNDING;
use denavit_dh::table::{DhRow, Row, ToolPart};
use denavit_dh::{NearParallel, Parallelism, convert};
use denavit_model::chain::{Chain, ChainError, ChainJoint, Coordinate, Quantity};
use denavit_model::nalgebra::{Point3, Unit, Vector3};
use denavit_model::notes::Note;
use denavit_model::robot::{JointKind, Robot};
use denavit_model::screw::{AxisLine, Pitch, Screw};
use denavit_model::se3::{self, Pose};
use std::cmp::Reverse;
use std::collections::{BinaryHeap, VecDeque};
use std::f64::consts::PI;
use std::ops::Range;

/// D-H frames of links and the rows that lead to them.
pub(crate) struct Plan {
    /// Of each joint that has an axis: the row that leads to its D-H frame from the frame of link `from`; `None` where the
    /// joint already is in canonical form.
    pub rows: Vec<Option<Numbers>>,
    /// The link whose frame a joint's row starts from: the one that carries the rigid body, or the base that was named.
    pub from: Vec<usize>,
    /// root_from_frame of the D-H frame of each link that a joint with an axis carries; of other links, of their own frame.
    pub frames: Vec<Pose>,
    /// Links whose own frames stay, wherever the D-H frame is.
    pub kept: Vec<bool>,
    /// Notes for the user.
    pub notes: Vec<Note>,
}

/// Frames are not placed farther away than this many times the robot's size; as for tables.
const FAR: f64 = 3.0;

/// Relative to a computed frame, an angle of 1e-12 rad is mostly the rounding error of that frame.
const SURELY_ABOVE: f64 = 2.0;

/// A frame that moves by no more (rad, and m relative to the robot's size) stays: the rounding of the products that
/// lead to it.
pub(crate) const STAYS: f64 = 3e-14;

/// Turn and slide closer to parallel than this (rad) are a helical joint with one frame.
const SAME_AXIS: f64 = 1e-12;

impl Plan {
    pub fn of(robot: &Robot, bodies: &Bodies, options: &Options) -> Result<Self, ExportError> {
        let links = robot.links.len();
        let mut from: Vec<usize> = robot.joints.iter().map(|joint| bodies.body[joint.parent]).collect();
        let mut placed: Vec<bool> = (0..links).map(|link| !carried_by_axis(robot, bodies, bodies.body[link])).collect();
        let chain = robot.chain(options.base.as_deref(), options.tip.as_deref(), options.reading)?.value;
        let (base, tip) = (robot.link_index(chain.base()), robot.link_index(chain.tip()));
        let named_base = base.filter(|_| options.base.is_some());
        let mut carries = vec![false; links];
        robot.joints.iter().for_each(|joint| carries[joint.parent] = true);
        // If the old names keep their frames, new links get the D-H frames.
        let is_end = |link: usize| options.link_frames == LinkFrames::Replace && !carries[link];
        let kept = (0..links).map(|link| {
            // The tip of the table keeps its frame, too: it is the target frame of planning.
            let is_tip = options.link_frames == LinkFrames::Replace && Some(link) == tip;
            let is_base = options.base.is_some() && Some(link) == base;
            !carried_by_axis(robot, bodies, link) || is_end(link) || is_tip || is_base
        });
        let kept: Vec<bool> = kept.collect();
        let mut plan = Self {
            rows: vec![None; robot.joints.len()],
            from: Vec::new(),
            frames: bodies.poses.clone(),
            kept,
            notes: Vec::new(),
        };
        let mut first: VecDeque<usize> = named_base.into_iter().chain(tip).collect();
        // The longest path on top, the first leaf among equals. A path only gets shorter: one that is as long as when it
        // was pushed is the longest.
        let entry = |(place, leaf): (usize, &usize)| (usize::MAX, Reverse(place), *leaf);
        let mut open: BinaryHeap<(usize, Reverse<usize>, usize)> =
            robot.leaves().iter().enumerate().map(entry).collect();
        loop {
            let (tip, joints) = if let Some(link) = first.pop_front() {
                let joints = way(robot, bodies, &placed, link);
                let starts_at = |base: &usize| {
                    Some(link) == tip && joints.first().is_some_and(|joint| from[*joint] == bodies.body[*base])
                };
                if let (Some(base), Some(joint)) = (named_base.filter(starts_at), joints.first()) {
                    from[*joint] = base;
                }
                (link, joints)
            } else {
                let Some((length, place, leaf)) = open.pop() else { break };
                let joints = way(robot, bodies, &placed, leaf);
                if joints.is_empty() {
                    continue;
                }
                if joints.len() < length {
                    open.push((joints.len(), place, leaf));
                    continue;
                }
                (leaf, joints)
            };
            if let Some(joint) = joints.first()
                && !plan.stands(robot, bodies, options.frames, from[*joint], tip, &joints)
            {
                plan.place(robot, bodies, options, (from[*joint], tip), &joints)?;
            }
            for joint in joints {
                placed[robot.joints[joint].child] = true;
            }
        }
        plan.from = from;
        plan.keep_no_frame_that_is_its_row(robot, bodies);
        Ok(plan)
    }

    /// root_from_frame of each link in the canonical file.
    pub fn poses(&self, bodies: &Bodies) -> Vec<Pose> {
        let pose = |link: usize| if self.kept[link] { bodies.poses[link] } else { self.frames[link] };
        (0..self.frames.len()).map(pose).collect()
    }

    /// root_from_frame of the frame that a path starts from.
    fn start<'a>(&'a self, bodies: &'a Bodies, link: usize) -> &'a Pose {
        if self.kept[link] { &bodies.poses[link] } else { &self.frames[link] }
    }

    /// Whether every joint on a path already is in canonical form, from a frame that stays.
    fn stands(
        &self,
        robot: &Robot,
        bodies: &Bodies,
        frames: Frames,
        start: usize,
        tip: usize,
        joints: &[usize],
    ) -> bool {
        let (turned, moved) = se3::difference(self.start(bodies, start), &bodies.poses[start]);
        let in_form = |place: usize, joint: usize| {
            let child = robot.joints[joint].child;
            if self.kept[child] {
                return true;
            }
            let from = if place == 0 { start } else { bodies.body[robot.joints[joint].parent] };
            let row = || bodies.seen_from(robot, from, joint);
            let is_row = match frames {
                Frames::Distal => row_within(&row().0, bodies.size, row().1).is_some(),
                Frames::Proximal => {
                    let mut behind = (0..robot.joints.len())
                        .filter(|next| has_axis(&robot.joints[*next].kind))
                        .filter(|next| bodies.body[robot.joints[*next].parent] == child)
                        .peekable();
                    let leads = |next: usize| {
                        let seen = bodies.seen_from(robot, child, next).0;
                        is_proximal(&seen, &bodies.axes[next], bodies.size)
                    };
                    let to_tip = || {
                        let step = Numbers::of(&(bodies.poses[child].inverse() * bodies.poses[tip]), bodies.size);
                        is_proximal(&step, &Vector3::z_axis(), bodies.size)
                    };
                    behind.peek().is_none() || behind.any(leads) || place + 1 == joints.len() && to_tip()
                }
            };
            has_z_axis(robot, joint) && is_row
        };
        turned <= STAYS
            && moved <= STAYS * bodies.size
            && joints.iter().enumerate().all(|(place, joint)| in_form(place, *joint))
    }

    /// A kept frame that already is the D-H frame is treated like the others: its origin is the row.
    fn keep_no_frame_that_is_its_row(&mut self, robot: &Robot, bodies: &Bodies) {
        for (index, joint) in robot.joints.iter().enumerate() {
            let (turned, moved) = se3::difference(&self.frames[joint.child], &bodies.poses[joint.child]);
            let there = turned <= STAYS && moved <= STAYS * bodies.size;
            if self.rows[index].is_some() && there && has_z_axis(robot, index) {
                self.kept[joint.child] = false;
            }
        }
    }

    /// Frames and rows of the joints on one path.
    fn place(
        &mut self,
        robot: &Robot,
        bodies: &Bodies,
        options: &Options,
        (start, tip): (usize, usize),
        joints: &[usize],
    ) -> Result<(), ExportError> {
        let base = *self.start(bodies, start);
        let base_from = |link: usize| base.inverse() * bodies.poses[link];
        let steps = steps(robot, bodies, joints, &base_from);
        let names = (robot.name.clone(), robot.links[start].name.clone(), robot.links[tip].name.clone());
        let chain = chain(robot, names, &steps, base_from(tip))
            .map_err(|source| ExportError::Chain { file: robot.source.file.clone(), source })?;
        let size = chain.size().max(bodies.size);
        let rows = self.rows(robot, &chain, &steps, options, size)?;
        let mut frame = base;
        let (mut shift, mut upright) = (Pose::identity(), true);
        for (index, step) in steps.iter().enumerate() {
            let before = shift;
            shift = Pose::identity();
            if options.frames == Frames::Proximal
                && let Row::Dh(next) = rows[index + 1]
                && next.d.abs() <= FAR * size
            {
                shift = ToolPart { theta: next.theta, d: next.d }.pose();
            }
            for (place, (joint, same_sense)) in step.joints.iter().enumerate() {
                let numbers = match (place, rows[index]) {
                    (0, Row::Dh(row)) if before == Pose::identity() && shift == Pose::identity() => {
                        dh_numbers(turned_over(row, upright, *same_sense), size)
                    }
                    (0, row) => {
                        let between = before.inverse() * row.pose() * shift;
                        Numbers::of(&(over(upright) * between * over(*same_sense)), size)
                    }
                    _ => Numbers::of(&over(upright == *same_sense), size),
                };
                upright = *same_sense;
                frame *= numbers.pose();
                frame.rotation = se3::orthonormalised(&frame.rotation);
                self.rows[*joint] = Some(numbers);
                self.frames[robot.joints[*joint].child] = frame;
            }
        }
        Ok(())
    }

    /// The table's rows; Hayati's where neighbouring axes are so nearly parallel that the usual four numbers would be huge.
    ///
    /// The chain is cut after each such pair: the rest is a new table, from the frame reached there.
    fn rows(
        &mut self,
        robot: &Robot,
        chain: &Chain,
        steps: &[Step],
        options: &Options,
        size: f64,
    ) -> Result<Vec<Row>, ExportError> {
        let chain_error = |source| ExportError::Chain { file: robot.source.file.clone(), source };
        let dh =
            convert::Options { parallelism: Parallelism::Exact, gauge: options.gauge, near_parallel: NearParallel::Dh };
        let mut rows = Vec::new();
        let mut left = chain.clone();
        loop {
            let table = convert::table(&left, &dh).map_err(chain_error)?.value;
            let Some((index, angle)) = nearly_parallel(&left, &table.rows, options.parallelism, size) else {
                rows.extend(table.rows);
                return Ok(rows);
            };
            let here = index.checked_sub(1).map_or_else(Pose::identity, |before| table.frames()[before]);
            let only = behind(&left, index..index + 1, &here).map_err(chain_error)?;
            let hayati = convert::Options { near_parallel: NearParallel::HayatiBelow(angle * SURELY_ABOVE), ..dh };
            let row = convert::table(&only, &hayati).map_err(chain_error)?.value.rows[0];
            left = behind(&left, index + 1..left.joints().len(), &(here * row.pose())).map_err(chain_error)?;
            rows.extend(&table.rows[..index]);
            self.notes.push(tilted(robot, &steps[rows.len()], angle));
            rows.push(row);
        }
    }
}

/// The first joint whose axis is nearly parallel to the one before, and the angle between them, rad.
fn nearly_parallel(chain: &Chain, rows: &[Row], parallelism: Parallelism, size: f64) -> Option<(usize, f64)> {
    let far = |row: &Row| row.a().abs().max(row.d().unwrap_or(0.0).abs()) > FAR * size;
    let tolerance = match parallelism {
        Parallelism::Exact => 0.0,
        Parallelism::Within { angle } => angle,
    };
    let mut before = Vector3::z_axis();
    chain.joints().iter().enumerate().find_map(|(index, joint)| {
        let direction = joint.screw.direction();
        let angle = se3::angle_between(&before, &direction).min(se3::angle_between(&before, &-direction.into_inner()));
        before = direction;
        (angle > ROUNDING && (angle < tolerance || far(&rows[index]))).then_some((index, angle))
    })
}

/// The joints `range` of a chain and its tip, in the frame `base`.
fn behind(chain: &Chain, range: Range<usize>, base: &Pose) -> Result<Chain, ChainError> {
    let seen = base.inverse();
    let joints = chain.joints()[range].iter().enumerate().map(|(coordinate, joint)| ChainJoint {
        screw: joint.screw.moved(&seen),
        coordinate,
        ..joint.clone()
    });
    let joints: Vec<ChainJoint> = joints.collect();
    let of = |joint: &ChainJoint| chain.coordinates().iter().find(|coordinate| coordinate.name == joint.name).cloned();
    let coordinates = joints.iter().filter_map(of).collect();
    Chain::new((chain.name(), chain.base(), chain.tip()), coordinates, joints, seen * chain.home())
}

fn tilted(robot: &Robot, step: &Step, angle: f64) -> Note {
    let what = format!(
        "its axis is {angle:.1e} rad from parallel to the axis before; the origin has a small pitch for it, which \
         keeps the motion and places the frame near the arm"
    );
    Note::Corrected { place: robot.joint_place(step.joints[0].0), what }
}

fn carried_by_axis(robot: &Robot, bodies: &Bodies, link: usize) -> bool {
    bodies.to_parent[link].is_some_and(|joint| has_axis(&robot.joints[joint].kind))
}

/// The joints with an axis on the path from the nearest placed frame down to `link`.
fn way(robot: &Robot, bodies: &Bodies, placed: &[bool], link: usize) -> Vec<usize> {
    let mut joints = Vec::new();
    let mut at = bodies.body[link];
    while let Some(joint) = bodies.to_parent[at] {
        if placed[at] {
            break;
        }
        joints.push(joint);
        at = bodies.body[robot.joints[joint].parent];
    }
    joints.reverse();
    joints
}

/// One screw axis of a path: a joint, or a turn and the slide that it drives, and whether each has the axis' sense.
struct Step {
    joints: Vec<(usize, bool)>,
    screw: Screw,
}

fn steps(robot: &Robot, bodies: &Bodies, joints: &[usize], base_from: &impl Fn(usize) -> Pose) -> Vec<Step> {
    let mut steps: Vec<Step> = Vec::new();
    for index in joints {
        let joint = &robot.joints[*index];
        let pose = base_from(joint.child);
        let direction = Unit::new_normalize(pose.rotation * bodies.axes[*index].as_ref());
        let axis = AxisLine { direction, point: Point3::from(pose.translation.vector) };
        let screw = match joint.kind {
            JointKind::Prismatic => Screw::Prismatic(direction),
            JointKind::Screw(pitch) => Screw::Helical { axis, pitch },
            _ => Screw::Revolute(axis),
        };
        if let Some(last) = steps.last_mut()
            && let [(before, _)] = last.joints[..]
            && let Some(pitch) = coupled(robot, before, *index)
            && last.screw.direction().cross(&direction).norm() < SAME_AXIS
        {
            let same = last.screw.direction().dot(&direction) > 0.0;
            let sense = if same { 1.0 } else { -1.0 };
            let turn = *last.screw.line().unwrap_or(&axis);
            let turn_first = last.screw.line().is_some();
            if let Some(pitch) = Pitch::from_metres_per_radian(sense * pitch) {
                last.joints = if turn_first {
                    vec![(before, true), (*index, same)]
                } else {
                    vec![(before, same), (*index, true)]
                };
                last.screw = Screw::Helical { axis: turn, pitch };
                continue;
            }
        }
        steps.push(Step { joints: vec![(*index, true)], screw });
    }
    steps
}

/// Metres of slide per radian of turn where one of two neighbouring joints drives the other, or both follow a third.
fn coupled(robot: &Robot, one: usize, other: usize) -> Option<f64> {
    let turns = |joint: usize| matches!(robot.joints[joint].kind, JointKind::Revolute | JointKind::Continuous);
    let slides = |joint: usize| robot.joints[joint].kind == JointKind::Prismatic;
    let (turn, slide) = match (turns(one) && slides(other), slides(one) && turns(other)) {
        (true, _) => (one, other),
        (_, true) => (other, one),
        _ => return None,
    };
    let (turn, slide) = (&robot.joints[turn], &robot.joints[slide]);
    match (&turn.mimic, &slide.mimic) {
        (None, Some(follows)) if follows.joint == turn.name => Some(follows.multiplier),
        (Some(follows), None) if follows.joint == slide.name && follows.multiplier != 0.0 => {
            Some(1.0 / follows.multiplier)
        }
        (Some(a), Some(b)) if a.joint == b.joint && a.multiplier != 0.0 => Some(b.multiplier / a.multiplier),
        _ => None,
    }
}

/// The chain of a path, each step with its own coordinate: at joint values 0, regardless of mimics.
fn chain(robot: &Robot, names: (String, String, String), steps: &[Step], home: Pose) -> Result<Chain, ChainError> {
    let lead = |step: &Step| {
        let turn = step.joints.iter().find(|(joint, _)| robot.joints[*joint].kind != JointKind::Prismatic);
        turn.unwrap_or(&step.joints[0]).0
    };
    let coordinates = steps.iter().map(|step| {
        let joint = &robot.joints[lead(step)];
        let slides = joint.kind == JointKind::Prismatic;
        let continuous = joint.kind == JointKind::Continuous;
        Coordinate {
            name: joint.name.clone(),
            quantity: if slides { Quantity::Length } else { Quantity::Angle },
            limits: joint.limits_in_force(),
            continuous,
        }
    });
    let joints = steps.iter().enumerate().map(|(coordinate, step)| ChainJoint {
        name: robot.joints[lead(step)].name.clone(),
        screw: step.screw,
        coordinate,
        scale: 1.0,
        offset: 0.0,
    });
    Chain::new(names, coordinates.collect(), joints.collect(), home)
}

/// Half a turn about x where the sense differs.
fn over(same_sense: bool) -> Pose {
    let alpha = if same_sense { 0.0 } else { PI };
    DhRow { alpha, ..DhRow::default() }.pose()
}

/// The row between frames of which the first or the second is flipped.
fn turned_over(row: DhRow, before_upright: bool, behind_upright: bool) -> DhRow {
    let half_turn = |alpha: f64| if alpha > 0.0 { alpha - PI } else { alpha + PI };
    let mut row = row;
    if !before_upright {
        row = DhRow { theta: -row.theta, d: -row.d, alpha: half_turn(row.alpha), a: row.a };
    }
    if !behind_upright {
        row.alpha = half_turn(row.alpha);
    }
    row
}

/// A row as URDF writes it: rpy = (alpha, 0, theta), xyz = (a cos theta, a sin theta, d).
pub(crate) fn dh_numbers(row: DhRow, size: f64) -> Numbers {
    let (theta, a) = (clean_angle(row.theta), clean(row.a, size));
    let (sine, cosine) = se3::sin_cos_of_written(theta);
    let xyz = Vector3::new(clean(a * cosine, a), clean(a * sine, a), clean(row.d, size));
    Numbers { xyz: xyz.into(), rpy: [clean_angle(row.alpha), 0.0, theta] }
}
