//! Joint senses and zeros for which two lists of axes agree: a search over quantities that do not depend on frames.
//!
//! Directed lines have a common normal x = z × z' without any choice of sign (along the offset where they are
//! parallel), so for given senses the twist, the length and the offset between neighbours are numbers that both lists must
//! agree on, and the joint angle between neighbouring normals gives the zero.

use denavit_model::nalgebra::{Matrix3, Vector3};
use denavit_model::se3::{self, Pose, angle_between};

/// A joint's axis in its base frame.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Axis {
    pub direction: Vector3<f64>,
    /// A point on the line; meaningless for a slide.
    pub point: Vector3<f64>,
    pub turns: bool,
}

/// Senses and zeros to start a fit from.
#[derive(Debug, Clone)]
pub(crate) struct Guess {
    /// 1 or -1.
    pub senses: Vec<f64>,
    /// rad, 0 for slides.
    pub zeros: Vec<f64>,
    /// Sum of the differences of the invariants, m.
    pub cost: f64,
}

/// Neighbours closer to parallel than this (rad) are compared as parallel: beyond any rounded or calibrated right angle,
/// below any twist that a maker would draw.
const PARALLEL: f64 = 0.02;

/// Parallel lines closer than this many times the robot's size have no usable common normal.
const COINCIDES: f64 = 5e-4;

/// Costs within this many times the robot's size of each other count as equal.
const SAME_COST: f64 = 2e-3;

/// A number that is wrong altogether costs this many times the robot's size: one such is better than two, however wrong.
const ONE_WRONG: f64 = 2e-2;

/// A zero beyond this (rad, m) is reported; the error of a quarter turn written as 1.57 is smaller.
const A_ZERO: f64 = 2e-3;

/// Sense vectors that are kept while the search goes along the arm: all of them up to eight joints.
const KEPT: usize = 256;

impl Guess {
    /// How much must be reported: reversed senses and zeros, reversed senses.
    pub fn simplicity(&self) -> (usize, usize) {
        let reversed = self.senses.iter().filter(|sense| **sense < 0.0).count();
        (reversed + self.zeros.iter().filter(|zero| zero.abs() > A_ZERO).count(), reversed)
    }
}

/// Guesses, best first: invariants that agree, then the fewest reversed senses and zeros.
pub(crate) fn guesses(robot: &[Axis], vendor: &[Axis], size: f64) -> Vec<Guess> {
    let mut kept: Vec<Guess> = vec![Guess { senses: Vec::new(), zeros: Vec::new(), cost: 0.0 }];
    for count in 1..=robot.len() {
        let expected = Invariants::of(&vendor[..count], size);
        let mut grown = Vec::with_capacity(2 * kept.len());
        for guess in &kept {
            for sense in [1.0, -1.0] {
                let mut senses = guess.senses.clone();
                senses.push(sense);
                let found = Invariants::of(&with_senses(&robot[..count], &senses), size);
                let (zeros, cost) = found.compare(&expected, &robot[..count], size);
                grown.push(Guess { senses, zeros, cost });
            }
        }
        kept = grown;
        let least = kept.iter().map(|guess| guess.cost).fold(f64::INFINITY, f64::min);
        let class = |guess: &Guess| ((guess.cost - least) / (SAME_COST * size)).floor();
        kept.sort_by(|a, b| class(a).total_cmp(&class(b)).then_with(|| a.simplicity().cmp(&b.simplicity())));
        kept.truncate(KEPT);
    }
    kept
}

/// The axes with their directions times the senses.
pub(crate) fn with_senses(axes: &[Axis], senses: &[f64]) -> Vec<Axis> {
    axes.iter().zip(senses).map(|(axis, sense)| Axis { direction: axis.direction * *sense, ..*axis }).collect()
}

struct Invariants {
    /// Per link: angle between neighbours' directions, rad, in \[0, π\].
    alpha: Vec<f64>,
    /// Per link: distance along the common normal, m.
    a: Vec<Option<f64>>,
    /// Per joint: angle from the normal before to the normal behind, rad.
    theta: Vec<Option<f64>>,
    /// Per joint at which a run of parallel axes ends: its offset along the run, m.
    d: Vec<Option<f64>>,
}

impl Invariants {
    fn of(axes: &[Axis], size: f64) -> Self {
        let n = axes.len();
        let placed = placed(axes);
        let links: Vec<Link> = (1..n).map(|k| Link::between(&placed[k - 1], &placed[k], size)).collect();
        let normals = normals(&links, axes);
        let theta = (0..n).map(|k| {
            let (before, behind) = (normals.get(k.wrapping_sub(1))?.as_ref()?, normals.get(k)?.as_ref()?);
            Some(before.cross(behind).dot(&axes[k].direction).atan2(before.dot(behind)))
        });
        let mut d = vec![None; n];
        let mut entered: Option<(Vector3<f64>, Vector3<f64>)> = None;
        for k in 0..n {
            if let Some(Some((_, foot))) = k.checked_sub(1).map(|before| links[before].feet) {
                entered = Some((foot, axes[k].direction));
            }
            if placed[k].0.is_none() {
                entered = None;
            }
            if let Some((foot, _)) = links.get(k).and_then(|link| link.feet) {
                d[k] = entered.map(|(from, along)| (foot - from).dot(&along));
            }
        }
        Self {
            alpha: links.iter().map(|link| link.alpha).collect(),
            a: links.iter().map(|link| link.a).collect(),
            theta: theta.collect(),
            d,
        }
    }

    /// Zeros that make the joint angles agree, and the sum of the remaining differences, m.
    fn compare(&self, expected: &Self, axes: &[Axis], size: f64) -> (Vec<f64>, f64) {
        let soft = |apart: f64| apart.abs().min(ONE_WRONG * size);
        let mut cost = 0.0;
        for (found, expected) in self.alpha.iter().zip(&expected.alpha) {
            cost += soft((found - expected) * size);
        }
        for (found, expected) in self.a.iter().chain(&self.d).zip(expected.a.iter().chain(&expected.d)) {
            if let (Some(found), Some(expected)) = (found, expected) {
                cost += soft(found - expected);
            }
        }
        let mut zeros = vec![0.0; axes.len()];
        for (k, axis) in axes.iter().enumerate() {
            let (Some(found), Some(expected)) = (self.theta[k], expected.theta[k]) else { continue };
            let apart = wrapped(found - expected);
            if axis.turns {
                zeros[k] = apart;
            } else {
                cost += soft(apart * size);
            }
        }
        (zeros, cost)
    }
}

/// An angle in (-π, π], rad; what rounding keeps from π counts as π.
pub(crate) fn wrapped(angle: f64) -> f64 {
    let angle = angle - std::f64::consts::TAU * (angle / std::f64::consts::TAU).round();
    if angle < 1e-6 - std::f64::consts::PI { angle + std::f64::consts::TAU } else { angle }
}

/// Point (where the axis has one) and direction. A slide along the turning axis before it is put on that axis' line.
fn placed(axes: &[Axis]) -> Vec<(Option<Vector3<f64>>, Vector3<f64>)> {
    let mut placed: Vec<(Option<Vector3<f64>>, Vector3<f64>)> = Vec::new();
    for axis in axes {
        let inherited =
            placed.last().filter(|(_, before)| parallel(before, &axis.direction)).and_then(|(point, _)| *point);
        placed.push((if axis.turns { Some(axis.point) } else { inherited }, axis.direction));
    }
    placed
}

fn parallel(a: &Vector3<f64>, b: &Vector3<f64>) -> bool {
    a.cross(b).norm() < PARALLEL
}

struct Link {
    alpha: f64,
    a: Option<f64>,
    normal: Option<Vector3<f64>>,
    /// Where the common normal of lines that are not parallel stands on the two.
    feet: Option<(Vector3<f64>, Vector3<f64>)>,
}

impl Link {
    fn between(
        (point, direction): &(Option<Vector3<f64>>, Vector3<f64>),
        (next_point, next): &(Option<Vector3<f64>>, Vector3<f64>),
        size: f64,
    ) -> Self {
        let alpha = angle_between(direction, next);
        let offset = point.zip(*next_point).map(|(point, next_point)| next_point - point);
        if parallel(direction, next) {
            let across = offset.map(|offset| offset - direction * offset.dot(direction));
            let a = across.map(|across| across.norm());
            let normal = across.filter(|across| across.norm() > COINCIDES * size).map(|across| across.normalize());
            return Self { alpha, a, normal, feet: None };
        }
        let cross = direction.cross(next);
        let normal = cross.normalize();
        let feet = point.zip(*next_point).map(|(point, next_point)| {
            let (offset, length2) = (next_point - point, cross.norm_squared());
            let here = offset.cross(next).dot(&cross) / length2;
            let there = offset.cross(direction).dot(&cross) / length2;
            (point + direction * here, next_point + next * there)
        });
        Self { alpha, a: offset.map(|offset| offset.dot(&normal)), normal: Some(normal), feet }
    }
}

/// The normals of the links; where the lines coincide it is the neighbour's, such that no slide has to turn.
fn normals(links: &[Link], axes: &[Axis]) -> Vec<Option<Vector3<f64>>> {
    let mut normals: Vec<_> = links.iter().map(|link| link.normal).collect();
    for k in (0..normals.len()).rev() {
        if normals[k].is_none() && axes[k].turns && !axes[k + 1].turns {
            normals[k] = normals.get(k + 1).copied().flatten();
        }
    }
    for k in 1..normals.len() {
        if normals[k].is_none() {
            normals[k] = normals[k - 1];
        }
    }
    normals
}

/// The motion that brings one list of axes onto another as well as one can: directions first, then lines.
pub(crate) fn alignment(from: &[Axis], onto: &[Axis], size: f64) -> Pose {
    let mut correlation = Matrix3::zeros();
    let (placed_from, placed_onto) = (placed(from), placed(onto));
    for k in 0..from.len() {
        correlation += onto[k].direction * from[k].direction.transpose();
        if k == 0 {
            continue;
        }
        let across = |placed: &[(Option<Vector3<f64>>, Vector3<f64>)]| {
            let offset = placed[k].0? - placed[k - 1].0?;
            Some((offset - placed[k].1 * offset.dot(&placed[k].1)) / size)
        };
        if let (true, Some(from), Some(onto)) =
            (parallel(&from[k].direction, &from[k - 1].direction), across(&placed_from), across(&placed_onto))
        {
            correlation += onto * from.transpose();
        }
    }
    let svd = correlation.svd(true, true);
    let (Some(u), Some(v_t)) = (svd.u, svd.v_t) else { return Pose::identity() };
    let handed = Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, (u * v_t).determinant().signum()));
    let rotation = denavit_model::nalgebra::Rotation3::from_matrix_unchecked(u * handed * v_t);
    let (mut normal, mut right) = (Matrix3::zeros(), Vector3::zeros());
    for (from, onto) in from.iter().zip(onto).filter(|(from, _)| from.turns) {
        let across = Matrix3::identity() - onto.direction * onto.direction.transpose();
        normal += across;
        right += across * (onto.point - rotation * from.point);
    }
    let shift = normal.svd(true, true).solve(&right, 1e-9).unwrap_or_else(|_| Vector3::zeros());
    se3::pose(rotation, shift)
}
