//! Candidate rows from a frame on one axis to a frame on the next: every gauge choice that could be readable.

use crate::convert::{NearParallel, Options, dh_row, tidy_angle, tidy_length};
use crate::gauge::Gauge;
use crate::straighten::{ROUNDING, angle_of_lines, place_of};
use crate::table::{DhRow, HayatiRow, Row};
use denavit_model::chain::Chain;
use denavit_model::nalgebra::{Matrix3, Vector3};
use denavit_model::screw::Screw;
use denavit_model::se3::Pose;

/// The axis that a row must reach: a joint's axis, or the tool's z axis.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Target {
    pub direction: Vector3<f64>,
    /// A point on the line; for a prismatic joint a point near the arm, since the position is free.
    pub point: Vector3<f64>,
    pub place_is_free: bool,
    /// The tool's x axis, for the last target.
    pub tool_x: Option<Vector3<f64>>,
    /// How far ahead the first target is that is not parallel, or the last one; 0 for the last.
    turns_after: usize,
    /// How far ahead the first target is that has a place; 0 for the last.
    placed_after: usize,
}

impl Target {
    /// Base z, the joint axes, the tool's z: n + 2 of them.
    pub fn all(chain: &Chain) -> Vec<Self> {
        let mut passed = denavit_model::nalgebra::Point3::origin();
        let mut targets = vec![Self {
            direction: Vector3::z(),
            point: Vector3::zeros(),
            place_is_free: false,
            tool_x: None,
            turns_after: 0,
            placed_after: 0,
        }];
        for joint in chain.joints() {
            passed = place_of(&joint.screw, passed);
            targets.push(Self {
                direction: joint.screw.direction().into_inner(),
                point: passed.coords,
                place_is_free: matches!(joint.screw, Screw::Prismatic(_)),
                tool_x: None,
                turns_after: 0,
                placed_after: 0,
            });
        }
        targets.push(Self::tool(chain.home()));
        Self::look_ahead(&mut targets);
        targets
    }

    /// The tool's z, the last target.
    pub fn tool(pose: &Pose) -> Self {
        let rotation = pose.rotation.matrix();
        Self {
            direction: rotation.column(2).into_owned(),
            point: pose.translation.vector,
            place_is_free: false,
            tool_x: Some(rotation.column(0).into_owned()),
            turns_after: 0,
            placed_after: 0,
        }
    }
}

impl Target {
    /// From the last one back, so that a long run of parallel axes is not walked for each of them.
    fn look_ahead(targets: &mut [Self]) {
        for index in (0..targets.len().saturating_sub(1)).rev() {
            let (here, ahead) = (targets[index], &targets[index + 1..]);
            let mut turns = 0;
            while ahead[turns].turns_after > 0 && angle_of_lines(&here.direction, &ahead[turns].direction) <= ROUNDING {
                turns += ahead[turns].turns_after;
            }
            let placed = if ahead[0].place_is_free { ahead[0].placed_after } else { 0 };
            targets[index].turns_after = turns + 1;
            targets[index].placed_after = placed + 1;
        }
    }
}

/// The first target ahead of `ahead[0]` that has a place.
fn placed_ahead(ahead: &[Target]) -> Option<&Target> {
    ahead.get(ahead[0].placed_after).filter(|_| ahead.len() > 1)
}

/// Candidate rows from `frame` (z along `here`) to the first of `ahead`.
pub(crate) fn candidates(
    frame: &Pose,
    here: &Vector3<f64>,
    ahead: &[Target],
    options: &Options,
    size: f64,
) -> Vec<Row> {
    let next = &ahead[0];
    let z = frame.rotation.matrix().column(2).into_owned();
    let apart = angle_of_lines(here, &next.direction);
    if let NearParallel::HayatiBelow(angle) = options.near_parallel
        && apart < angle
    {
        return hayati_rows(frame, next, size);
    }
    let paper = options.gauge == Gauge::Paper;
    let last = ahead.len() == 1;
    let rows = if apart <= ROUNDING {
        parallel_rows(frame, &z, ahead, paper, size)
    } else {
        crossing_rows(frame, &z, ahead, paper, last, size)
    };
    rows.into_iter().map(Row::Dh).collect()
}

/// Lemma 1 and related cases: the axes are not parallel, x is along ± their common normal.
fn crossing_rows(frame: &Pose, z: &Vector3<f64>, ahead: &[Target], paper: bool, last: bool, size: f64) -> Vec<DhRow> {
    let next = &ahead[0];
    let normal = z.cross(&next.direction).normalize();
    let places = if next.place_is_free { free_places(frame, &normal, z, ahead) } else { vec![next.point] };
    let mut rows = Vec::new();
    for place in &places {
        let both = [1.0, -1.0].map(|sign| dh_row(frame, &(normal * sign), &next.direction, place, None, size));
        if paper {
            // a ≥ 0, and where the axes meet alpha ≥ 0; the tool's pair has alpha ≥ 0 and a of either sign.
            let by_length = !last && both[0].a.abs() > MEETS * size;
            let chosen = if by_length { usize::from(both[0].a < 0.0) } else { usize::from(both[0].alpha < 0.0) };
            return vec![both[chosen]];
        }
        rows.extend(both);
    }
    rows
}

/// Axes closer than this many times the robot's size meet.
const MEETS: f64 = 1e-12;

/// Places for a prismatic axis: through the frame's origin, and through what lies ahead, whole or by one number alone.
fn free_places(frame: &Pose, normal: &Vector3<f64>, z: &Vector3<f64>, ahead: &[Target]) -> Vec<Vector3<f64>> {
    let origin = frame.translation.vector;
    let mut places = vec![origin];
    if let Some(goal) = placed_ahead(ahead) {
        let along = goal.direction;
        let nearest = goal.point + along * (origin - goal.point).dot(&along);
        for goal in [nearest, goal.point] {
            let basis = Matrix3::from_columns(&[*z, *normal, ahead[0].direction]);
            if let Some(parts) = basis.lu().solve(&(goal - origin)) {
                places.extend([goal, origin + z * parts.x, origin + normal * parts.y]);
            }
        }
    }
    places
}

/// Lemma 2 and related cases: the axes are parallel; d is free, and where they coincide x is too.
fn parallel_rows(frame: &Pose, z: &Vector3<f64>, ahead: &[Target], paper: bool, size: f64) -> Vec<DhRow> {
    let next = &ahead[0];
    let origin = frame.translation.vector;
    let here_x = frame.rotation.matrix().column(0).into_owned();
    let goal = placed_ahead(ahead);
    let mut places = vec![next.point];
    if next.place_is_free {
        places = vec![origin];
        places.extend(goal.filter(|_| !paper).map(|goal| goal.point));
    }
    let mut rows = Vec::new();
    for place in places {
        let mut offsets = vec![0.0];
        if !paper {
            offsets.extend(stops(&origin, z, &place, ahead));
        }
        let across = (place - origin) - z * (place - origin).dot(z);
        let mut directions = if across.norm() > COINCIDES * size {
            vec![across.normalize(), -across.normalize()]
        } else {
            let mut free = vec![here_x];
            free.extend(coming_x(z, &place, ahead));
            free
        };
        if paper {
            directions.truncate(1);
        }
        for x in &directions {
            for d in &offsets {
                rows.push(dh_row(frame, x, &next.direction, &place, Some(*d), size));
            }
        }
    }
    rows
}

/// Parallel axes closer than this many times the robot's size coincide.
const COINCIDES: f64 = 1e-12;

/// Candidate positions along the parallel axes: the foot of the next common normal, or the height of the tip.
fn stops(origin: &Vector3<f64>, z: &Vector3<f64>, place: &Vector3<f64>, ahead: &[Target]) -> Vec<f64> {
    let level = |point: &Vector3<f64>| (point - origin).dot(z);
    if ahead[0].tool_x.is_some() {
        return vec![level(&ahead[0].point)];
    }
    let target = &ahead[ahead[0].turns_after];
    if target.place_is_free || angle_of_lines(z, &target.direction) <= ROUNDING {
        return vec![level(&target.point)];
    }
    // The foot, on the line through `place` along z, of the common normal with the target's line.
    let normal = z.cross(&target.direction);
    let along = (target.point - place).cross(&target.direction).dot(&normal) / normal.norm_squared();
    vec![level(&(place + z * along))]
}

/// The x axis that the next row will have, both senses: taken early, it makes the next theta 0.
fn coming_x(z: &Vector3<f64>, place: &Vector3<f64>, ahead: &[Target]) -> Vec<Vector3<f64>> {
    let x = match ahead.get(1) {
        None => ahead[0].tool_x,
        Some(target) if angle_of_lines(z, &target.direction) > ROUNDING => Some(z.cross(&target.direction).normalize()),
        Some(target) => {
            let across = (target.point - place) - z * (target.point - place).dot(z);
            across.try_normalize(0.0).filter(|_| across.norm() > COINCIDES).or(target.tool_x)
        }
    };
    x.map_or_else(Vec::new, |x| vec![x, -x])
}

/// Rz(theta) Tx(a) Rx(alpha) Ry(beta): x points to where the next axis cuts this frame's xy-plane.
fn hayati_rows(frame: &Pose, next: &Target, size: f64) -> Vec<Row> {
    let local = frame.rotation.inverse();
    let direction = local * next.direction;
    let offset = if next.place_is_free { Vector3::zeros() } else { local * (next.point - frame.translation.vector) };
    let cut = offset - direction * (offset.z / direction.z);
    let across = cut.x.hypot(cut.y);
    let row = |theta: f64, a: f64| {
        let theta = tidy_angle(theta);
        let turned = DhRow { theta, ..DhRow::default() }.pose().rotation.inverse() * direction;
        let beta = tidy_angle(turned.x.atan2(turned.y.hypot(turned.z)));
        let alpha = tidy_angle((-turned.y).atan2(turned.z));
        Row::Hayati(HayatiRow { theta, d: 0.0, a: tidy_length(a, size), alpha, beta })
    };
    if across <= COINCIDES * size {
        return vec![row(0.0, 0.0)];
    }
    vec![row(cut.y.atan2(cut.x), across), row((-cut.y).atan2(-cut.x), -across)]
}
