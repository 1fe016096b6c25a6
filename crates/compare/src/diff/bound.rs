//! Upper bound of the displacement of a tip over the joint ranges.
//!
//! ```text
//! t_b - t_a = Σ C1 ··· C(i-1) (Ci - Ai) A(i+1) ··· An t  +  C1 ··· Cn (t' - t)
//! ```
//! Motions keep distances, so |t_b - t_a| ≤ Σ max |Ci y - Ai y| + |t' - t|, y over all places of a's tip behind joint
//! i. These places lie in a ball that is carried from the tip to the joint: turning a ball by an interval of angles
//! about an axis gives a ball again. With z = Ai y and V = Ci Ai⁻¹, |Ci y - Ai y| = |V z - z|, which is exact for the
//! ball's centre and off by at most the rotation angle times its radius; over an interval of qi, V z changes by no
//! more than the difference of both unit twists, seen from behind the joint, moves a point of the ball. The box of
//! joint values is halved where that helps most, until the bound is close to an attained value.

use crate::diff::steps::{Motor, Step, TipPath};
use crate::mechanism::Interval;
use denavit_model::Screw;
use denavit_model::nalgebra::{Point3, Vector3, Vector6};
use denavit_model::se3::{self, Pose};
use std::collections::BinaryHeap;

/// Halving ends when the bound is this close to an attained value.
const CLOSE: f64 = 1.1;
/// Or after this many halvings per joint: a bound stays a bound.
const HALVINGS: usize = 1500;
/// Maximum number of joint motions computed for one tip; if a path needs more for a single pass, the bound is only
/// the gap between the reachable regions of both tips.
const MOTIONS: usize = 20_000_000;

/// An upper bound for [`TipPath::displacement`] over the intervals, m.
pub(crate) fn upper(way: &TipPath, intervals: &[Interval]) -> f64 {
    let changed = way.steps.iter().filter(|step| !step.still).count();
    let halvings = (MOTIONS / (way.steps.len() * changed).max(1)).min(HALVINGS);
    let steps = if halvings == 0 {
        f64::INFINITY
    } else {
        (0..way.steps.len()).map(|index| step_upper(way, index, intervals, halvings)).sum()
    };
    let cell: Vec<(f64, f64)> = intervals.iter().map(|interval| (interval.lower, interval.upper)).collect();
    let (mut one, mut other) = (Ball { centre: way.tip_a, radius: 0.0 }, Ball { centre: way.tip_b, radius: 0.0 });
    for step in way.steps.iter().rev() {
        one = one.carried(step, &cell).0;
        other = other.carried_in_b(step, &cell);
    }
    let reach = one.radius + other.radius + one.centre.coords.norm();
    let rounding = 64.0 * f64::EPSILON * reach * (1.0 + way.steps.len() as f64);
    (steps + (way.tip_b - way.tip_a).norm()).min(one.widest_gap(&other)) + rounding
}

#[derive(Debug, Clone, Copy)]
struct Ball {
    centre: Point3<f64>,
    radius: f64,
}

/// A box of joint values and the bound over it.
struct Cell {
    intervals: Vec<(f64, f64)>,
    upper: f64,
    /// The coordinate whose halving helps most.
    widest: usize,
}

impl PartialEq for Cell {
    fn eq(&self, other: &Self) -> bool {
        self.upper == other.upper
    }
}
impl Eq for Cell {}
impl PartialOrd for Cell {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}
impl Ord for Cell {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.upper.total_cmp(&other.upper)
    }
}

fn step_upper(way: &TipPath, index: usize, intervals: &[Interval], halvings: usize) -> f64 {
    if way.steps[index].still {
        return 0.0;
    }
    let box_of_all: Vec<(f64, f64)> = intervals.iter().map(|interval| (interval.lower, interval.upper)).collect();
    let mut reached = 0.0f64;
    let mut look = |intervals: Vec<(f64, f64)>| {
        let (upper, at_middle, widest) = bounds(way, index, &intervals);
        reached = reached.max(at_middle);
        (Cell { intervals, upper, widest }, reached)
    };
    let mut open = BinaryHeap::new();
    let (first, mut best) = look(box_of_all);
    open.push(first);
    for _ in 0..halvings {
        let Some(worst) = open.peek() else { break };
        if worst.upper <= CLOSE * best {
            break;
        }
        let Some(worst) = open.pop() else { break };
        let (lower, upper) = worst.intervals[worst.widest];
        let middle = 0.5 * (lower + upper);
        for half in [(lower, middle), (middle, upper)] {
            let mut intervals = worst.intervals.clone();
            intervals[worst.widest] = half;
            let (cell, reached) = look(intervals);
            best = reached;
            open.push(Cell { upper: cell.upper.min(worst.upper), ..cell });
        }
    }
    open.peek().map_or(0.0, |worst| worst.upper)
}

/// The bound over a box, the displacement at its middle, and the coordinate to halve next.
fn bounds(way: &TipPath, index: usize, cell: &[(f64, f64)]) -> (f64, f64, usize) {
    let middle: Vec<f64> = cell.iter().map(|(lower, upper)| 0.5 * (lower + upper)).collect();
    let mut growth = vec![0.0; cell.len()];
    let mut ball = Ball { centre: way.tip_a, radius: 0.0 };
    let mut point = way.tip_a;
    for step in way.steps[index + 1..].iter().rev() {
        let (carried, grown) = ball.carried(step, cell);
        ball = carried;
        if let Some(motor) = &step.a {
            growth[motor.drive.coordinate] += grown;
            point = motor.screw.motion(motor.value(&middle)) * point;
        }
    }
    let step = &way.steps[index];
    let at = |motor: &Option<Motor>| motor.map_or_else(Pose::identity, |m| m.screw.motion(m.value(&middle)));
    let (moved_a, moved_b) = (at(&step.a), at(&step.b) * step.carried);
    let between = moved_b * moved_a.inverse();
    let angle = se3::rotation_angle(&between.rotation);
    let factor = 2.0 * (0.5 * angle).sin();
    let (places, grown) = ball.carried(step, cell);
    let shifted = (between * places.centre - places.centre).norm();
    for value in &mut growth {
        *value *= factor;
    }
    if let Some(motor) = &step.a {
        growth[motor.drive.coordinate] += factor * grown;
    }
    let half = |motor: &Motor| 0.5 * (cell[motor.drive.coordinate].1 - cell[motor.drive.coordinate].0);
    let swing = step.a.as_ref().map_or(ball, |motor| {
        let reach = motor.drive.scale.abs() * half(motor);
        ball.swept(&motor.screw, -reach, reach).0
    });
    let twist_a = step.a.as_ref().map_or_else(Vector6::zeros, |motor| motor.screw.twist() * motor.drive.scale);
    let twist_b = step.b.as_ref().map_or_else(Vector6::zeros, |motor| step.behind * motor.drive.scale);
    let mut change = 0.0;
    match (&step.a, &step.b) {
        (Some(one), Some(other)) if one.drive.coordinate == other.drive.coordinate => {
            let by = half(one) * swing.fastest(&(twist_b - twist_a));
            growth[one.drive.coordinate] += by;
            change += by;
        }
        _ => {
            for (motor, twist) in [(&step.a, twist_a), (&step.b, twist_b)] {
                if let Some(motor) = motor {
                    let by = half(motor) * swing.fastest(&twist);
                    growth[motor.drive.coordinate] += by;
                    change += by;
                }
            }
        }
    }
    let widest = (0..growth.len()).max_by(|x, y| growth[*x].total_cmp(&growth[*y])).unwrap_or(0);
    let at_middle = (moved_b * point - moved_a * point).norm();
    let upper = (shifted + factor * places.radius + change).min(places.widest_gap(&ball.carried_in_b(step, cell)));
    (upper, at_middle, widest)
}

impl Ball {
    /// The ball around all places that a step of a takes the ball to, and by how much it grew.
    fn carried(self, step: &Step, cell: &[(f64, f64)]) -> (Self, f64) {
        let Some(motor) = &step.a else { return (self, 0.0) };
        let (lower, upper) = cell[motor.drive.coordinate];
        let (x, y) = (motor.drive.scale * lower + motor.drive.offset, motor.drive.scale * upper + motor.drive.offset);
        self.swept(&motor.screw, x.min(y), x.max(y))
    }

    /// The ball around all places that a step of b takes the ball to.
    fn carried_in_b(self, step: &Step, cell: &[(f64, f64)]) -> Self {
        let carried = Self { centre: step.carried * self.centre, radius: self.radius };
        let Some(motor) = &step.b else { return carried };
        let (lower, upper) = cell[motor.drive.coordinate];
        let (x, y) = (motor.drive.scale * lower + motor.drive.offset, motor.drive.scale * upper + motor.drive.offset);
        carried.swept(&motor.screw, x.min(y), x.max(y)).0
    }

    /// Largest distance between points of the two balls.
    fn widest_gap(&self, other: &Self) -> f64 {
        (self.centre - other.centre).norm() + self.radius + other.radius
    }

    /// The ball around all places under joint values from `lower` to `upper`, and by how much it grew.
    fn swept(self, screw: &Screw, lower: f64, upper: f64) -> (Self, f64) {
        let (middle, half) = (0.5 * (lower + upper), 0.5 * (upper - lower));
        let (grown, centre) = match screw {
            Screw::Prismatic(direction) => (half, self.centre + direction.as_ref() * middle),
            Screw::Revolute(line) | Screw::Helical { axis: line, .. } => {
                let foot = line.nearest_to(&self.centre);
                let arm = self.centre - foot;
                let pitch = screw.pitch().unwrap_or(0.0);
                let slide = line.direction.as_ref() * (pitch * middle);
                let slid = pitch.abs() * half;
                if half >= std::f64::consts::FRAC_PI_2 {
                    (arm.norm() + slid, foot + slide)
                } else {
                    // The centre of the smallest ball around an arc is above the middle of its chord.
                    let turned = se3::rotation_about(&line.direction, middle) * arm;
                    (arm.norm() * half.sin() + slid, foot + turned * half.cos() + slide)
                }
            }
        };
        (Self { centre, radius: self.radius + grown }, grown)
    }

    /// How fast a twist moves any point of the ball at most.
    fn fastest(&self, twist: &Vector6<f64>) -> f64 {
        let omega: Vector3<f64> = twist.fixed_rows::<3>(0).into_owned();
        let v = twist.fixed_rows::<3>(3) + omega.cross(&self.centre.coords);
        v.norm() + omega.norm() * self.radius
    }
}
