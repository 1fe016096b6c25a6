//! The solver: chooses the method for a chain and finds all its solutions for a pose.

use crate::arm::SixR;
use crate::branch::Branch;
use crate::class::Class;
use crate::newton::Landed;
use crate::six::Six;
use crate::{newton, seven};
use denavit_model::chain::{ChainJoint, Coordinate, Quantity};
use denavit_model::nalgebra::Vector6;
use denavit_model::{Chain, Pose, Screw, se3};
use std::f64::consts::TAU;
use std::fmt;

/// A pose counts as reached within this, rad and share of the robot's size: far above rounding, far below any encoder's resolution.
pub(crate) const REACHED: f64 = 1e-9;
/// Two solutions are one when no joint differs by more, rad or share of the robot's size: solutions that meet at a singularity are
/// known to half the digits.
const SAME: f64 = 1e-6;
/// Starts of the numerical search.
const RESTARTS: u32 = 120;
/// Steps of one numerical search.
const SEARCH_STEPS: usize = 60;
/// Values of a redundant joint that are tried where the given one does not reach the pose.
const SWEEP: u32 = 72;

/// How solutions are found.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Method {
    /// Six revolute joints: every branch in closed form.
    ClosedForm {
        /// Which closed form.
        class: Class,
        /// Deviation of this arm's axes from parallel, rad: Newton's method refines the branches of the exact arm.
        angle: f64,
        /// Distance of the axes from their common point, m.
        distance: f64,
    },
    /// Seven revolute joints: the closed form of the six others at each value of one.
    Redundant {
        /// Index of the joint whose value is a parameter.
        parameter: usize,
        /// The closed form of the others.
        class: Class,
    },
    /// Anything else: damped least squares from many starts. Finds most solutions, but not always all.
    Search,
}

impl fmt::Display for Method {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::ClosedForm { class, angle, distance } => {
                write!(f, "closed form: {class}")?;
                if *angle > 1e-9 {
                    write!(f, " within {angle:.1e} rad")?;
                }
                if *distance > 1e-9 {
                    write!(f, " within {:.3} mm", distance * 1e3)?;
                }
                Ok(())
            }
            Self::Redundant { parameter, class } => {
                write!(f, "closed form at each value of joint {}; of the others {class}", parameter + 1)
            }
            Self::Search => write!(f, "numerical search from {RESTARTS} starts; it may miss solutions"),
        }
    }
}

/// One solution.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Found {
    /// Which branch, where the arm's class has names for them.
    pub branch: Option<Branch>,
    /// Distance of the tip's origin from the target, m.
    pub position_error: f64,
    /// Angle of the tip from the target, rad.
    pub orientation_error: f64,
    /// Every joint is within its limits.
    pub within_limits: bool,
}

/// The solutions for one pose; kept by the caller, so that further poses allocate nothing.
#[derive(Debug, Clone, Default)]
pub struct Solutions {
    coordinates: usize,
    joints: Vec<f64>,
    found: Vec<Found>,
    lost: usize,
    reached: bool,
    columns: Vec<Vector6<f64>>,
    trial: Vec<f64>,
    start: Vec<f64>,
    ranks: Vec<Rank>,
    sorted: (Vec<f64>, Vec<Found>),
}

impl Solutions {
    /// How many there are.
    pub fn len(&self) -> usize {
        self.found.len()
    }

    /// None was found, not even a nearest.
    pub fn is_empty(&self) -> bool {
        self.found.is_empty()
    }

    /// Each with its joint values (rad, m), nearest to where the search began first, those outside of limits last.
    pub fn iter(&self) -> impl Iterator<Item = (&[f64], &Found)> {
        self.joints.chunks_exact(self.coordinates.max(1)).zip(&self.found)
    }

    /// Whether the pose is reached; if not, the one solution is the nearest that was found.
    pub fn reached(&self) -> bool {
        self.reached
    }

    /// Branches of the nominal arm that this arm does not have at this pose, or that were not found.
    pub fn lost(&self) -> usize {
        self.lost
    }

    fn clear(&mut self, coordinates: usize) {
        self.coordinates = coordinates;
        self.joints.clear();
        self.found.clear();
        self.lost = 0;
        self.reached = false;
        self.columns.resize(coordinates, Vector6::zeros());
        self.trial.resize(coordinates, 0.0);
        self.start.resize(coordinates, 0.0);
    }
}

/// The values of a coordinate that stand for the same posture.
#[derive(Debug, Clone)]
struct Wrap {
    quantity: Quantity,
    /// What a whole turn of its joint adds, rad; `None` where a joint slides or is a helix.
    turn: Option<f64>,
    /// Its limits, endless where it has none.
    limits: (f64, f64),
}

impl Wrap {
    fn of(coordinate: &Coordinate, joint: &ChainJoint) -> Self {
        let turns = coordinate.quantity == Quantity::Angle && matches!(joint.screw, Screw::Revolute(_));
        let limits = coordinate.limits.interval().filter(|_| !coordinate.continuous);
        Self {
            quantity: coordinate.quantity,
            turn: turns.then(|| TAU / joint.scale.abs()),
            limits: limits.unwrap_or((f64::NEG_INFINITY, f64::INFINITY)),
        }
    }

    #[inline]
    fn holds(&self, q: f64) -> bool {
        q >= self.limits.0 - SAME && q <= self.limits.1 + SAME
    }

    /// The value by whole turns next to `near`, within the limits if there is such a turn.
    #[inline]
    fn nearest(&self, q: f64, near: f64) -> f64 {
        let Some(turn) = self.turn else { return q };
        let apart = q - near;
        let turns = match apart.abs() / turn {
            few if few <= 0.5 => 0.0,
            few if few < 1.5 => 1.0f64.copysign(apart),
            _ => (apart / turn).round(),
        };
        let nearest = q - turns * turn;
        if self.holds(nearest) {
            return nearest;
        }
        let first = ((self.limits.0 - SAME - nearest) / turn).ceil();
        let last = ((self.limits.1 + SAME - nearest) / turn).floor();
        if first > last { nearest } else { nearest + 0.0f64.clamp(first, last) * turn }
    }
}

#[derive(Debug, Clone)]
enum Strategy {
    Six(Box<Six>),
    Seven { parameter: usize },
    Search,
}

/// Inverse kinematics of one chain.
///
/// # Examples
/// ```
/// use denavit_ik::Solver;
/// use denavit_model::examples;
/// let arm = examples::puma_like();
/// let solver = Solver::new(&arm);
/// let pose = arm.fk(&[0.3, 0.5, -0.7, 0.4, 0.6, -0.2]);
/// let solutions = solver.solve(&pose, &[0.0; 6]);
/// assert_eq!(solutions.len(), 8);
/// ```
#[derive(Debug, Clone)]
pub struct Solver {
    chain: Chain,
    size: f64,
    /// Of each coordinate.
    wraps: Vec<Wrap>,
    strategy: Strategy,
    method: Method,
}

impl Solver {
    /// Finds the chain's class from its screw axes.
    pub fn new(chain: &Chain) -> Self {
        let size = chain.size();
        let (strategy, method) = if let Some(arm) = SixR::of(chain) {
            let six = Six::of(arm, size, true);
            let (class, angle, distance) = (six.drawn.class, six.drawn.angle, six.drawn.distance);
            (Strategy::Six(Box::new(six)), Method::ClosedForm { class, angle, distance })
        } else if let Some((parameter, class)) = seven::redundant(chain, size) {
            (Strategy::Seven { parameter }, Method::Redundant { parameter, class })
        } else {
            (Strategy::Search, Method::Search)
        };
        let wraps = chain.coordinates().iter().zip(chain.joints()).map(|(of, joint)| Wrap::of(of, joint)).collect();
        Self { chain: chain.clone(), size, wraps, strategy, method }
    }

    /// The method for this chain.
    pub fn method(&self) -> &Method {
        &self.method
    }

    /// The chain.
    pub fn chain(&self) -> &Chain {
        &self.chain
    }

    /// All solutions for a pose; see [`Solver::solve_into`].
    pub fn solve(&self, target: &Pose, near: &[f64]) -> Solutions {
        let mut solutions = Solutions::default();
        self.solve_into(target, near, &mut solutions);
        solutions
    }

    /// All solutions for base_from_tip = `target`, nearest to `near` first; those outside of limits last.
    ///
    /// Joints that turn are given by the whole turns that bring them next to `near` within their limits. Where no solution
    /// reaches the pose, the nearest that was found is the only one ([`Solutions::reached`] is false); a chain without coordinates has none. Chains of more than six
    /// coordinates: the solutions at the parameter's value in `near`, or at the nearest value that has one.
    ///
    /// # Shape and units
    /// `near`: one value per coordinate, rad or m.
    ///
    /// # Panics
    /// `near` is shorter than [`Chain::coordinates`].
    pub fn solve_into(&self, target: &Pose, near: &[f64], solutions: &mut Solutions) {
        let n = self.chain.coordinates().len();
        let near = &near[..n];
        solutions.clear(n);
        if n == 0 {
            return;
        }
        match &self.strategy {
            Strategy::Six(six) => {
                let tally = six.each(target, self.size, |values, branch, landed| {
                    self.add(near, values, branch, landed, solutions)
                });
                solutions.lost = tally.lost;
            }
            Strategy::Seven { parameter } => self.seven(*parameter, target, near, solutions),
            Strategy::Search => self.search(target, near, solutions, RESTARTS),
        }
        solutions.reached = !solutions.found.is_empty();
        if !solutions.reached {
            self.nearest(target, near, solutions);
        }
        sort(near, solutions);
    }

    /// One solution per pose along a path, each next to the one before: the branch of `start` is kept where it can be.
    ///
    /// The second value states where it could not: `None` for a pose that is not reached, otherwise how far the joint that moves most
    /// turned (rad) or slid (m) from the pose before.
    pub fn follow(&self, path: &[Pose], start: &[f64]) -> Vec<(Vec<f64>, Option<f64>)> {
        let mut near = start.to_vec();
        let mut solutions = Solutions::default();
        path.iter()
            .map(|target| {
                self.solve_into(target, &near, &mut solutions);
                let reached = solutions.reached();
                let best = solutions.iter().next().map_or_else(|| near.clone(), |(joints, _)| joints.to_vec());
                let step = best.iter().zip(&near).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                if reached {
                    near.clone_from(&best);
                }
                (best, reached.then_some(step))
            })
            .collect()
    }

    /// Adds joint values unless they are there already; whether they are new.
    fn add(
        &self,
        near: &[f64],
        values: &[f64],
        branch: Option<Branch>,
        landed: &Landed,
        solutions: &mut Solutions,
    ) -> bool {
        let at = solutions.joints.len();
        solutions.joints.extend(
            values
                .iter()
                .zip(near)
                .zip(self.chain.joints())
                .zip(&self.wraps)
                .map(|(((value, near), joint), wrap)| wrap.nearest((value - joint.offset) / joint.scale, *near)),
        );
        self.keep((landed.orientation, landed.position * self.size), at, near.len(), branch, solutions)
    }

    /// Keeps the joint values that stand at `at` unless they are there already, or miss the target by more than counts as reached.
    fn keep(
        &self,
        (orientation_error, position_error): (f64, f64),
        at: usize,
        n: usize,
        branch: Option<Branch>,
        solutions: &mut Solutions,
    ) -> bool {
        let (before, new) = solutions.joints.split_at(at);
        let same = |old: &[f64]| {
            old.iter().zip(new).zip(&self.wraps).all(|((a, b), wrap)| match wrap.quantity {
                // Values lie within a turn of each other where no limits move them apart.
                Quantity::Angle if (a - b).abs() < TAU - SAME => (a - b).abs() < SAME,
                Quantity::Angle => {
                    let turns = ((a - b) / TAU).round();
                    (a - b - turns * TAU).abs() < SAME
                }
                Quantity::Length => (a - b).abs() < SAME * self.size,
            })
        };
        let again = before.chunks_exact(n).any(same);
        if again || position_error > 2.0 * REACHED * self.size || orientation_error > 2.0 * REACHED {
            solutions.joints.truncate(at);
            return false;
        }
        let within_limits = self.within_limits(new);
        solutions.found.push(Found { branch, position_error, orientation_error, within_limits });
        true
    }

    fn within_limits(&self, q: &[f64]) -> bool {
        q.iter().zip(&self.wraps).all(|(q, wrap)| wrap.holds(*q))
    }

    fn seven(&self, parameter: usize, target: &Pose, near: &[f64], solutions: &mut Solutions) {
        let coordinate = &self.chain.coordinates()[parameter];
        let (lower, upper) = coordinate.range();
        let start = near[parameter];
        let widest = (upper - start).abs().max((start - lower).abs());
        for step in 0..=SWEEP {
            // Outwards from the given value, to both sides in turn.
            let side = if step % 2 == 0 { 1.0 } else { -1.0 };
            let q = start + side * f64::from(step.div_ceil(2)) * 2.0 * widest / f64::from(SWEEP);
            if step > 0 && (q < lower || q > upper) {
                continue;
            }
            let joint = &self.chain.joints()[parameter];
            let value = joint.value(&self.pad(parameter, q));
            let Some(arm) = seven::held(&self.chain, parameter, value) else { return };
            let six = Six::of(arm, self.size, false);
            let tally = six.each(target, self.size, |values, branch, landed| {
                let mut all = [0.0; 7];
                for (k, all) in all.iter_mut().enumerate() {
                    *all = match k.cmp(&parameter) {
                        std::cmp::Ordering::Less => values[k],
                        std::cmp::Ordering::Equal => value,
                        std::cmp::Ordering::Greater => values[k - 1],
                    };
                }
                self.add(near, &all, branch, landed, solutions)
            });
            solutions.lost = tally.lost;
            if solutions.found.iter().any(|found| found.within_limits) {
                return;
            }
        }
    }

    /// Coordinates that are zero but for one.
    fn pad(&self, k: usize, q: f64) -> [f64; 7] {
        let mut all = [0.0; 7];
        all[self.chain.joints()[k].coordinate] = q;
        all
    }

    /// Damped least squares from `near` and from points spread over the joint range.
    fn search(&self, target: &Pose, near: &[f64], solutions: &mut Solutions, starts: u32) {
        let n = near.len();
        for start in 0..starts {
            let at = solutions.joints.len();
            let left = self.descend(target, near, start, solutions);
            if left < REACHED {
                // Mimic joints share a coordinate: only a chain without them turns whole turns freely.
                let joints = self.chain.joints();
                if joints.len() == n && joints.iter().enumerate().all(|(k, joint)| joint.coordinate == k) {
                    for ((q, near), wrap) in solutions.joints[at..].iter_mut().zip(near).zip(&self.wraps) {
                        *q = wrap.nearest(*q, *near);
                    }
                }
                let errors = se3::difference(&self.chain.fk(&solutions.joints[at..]), target);
                self.keep(errors, at, n, None, solutions);
            } else {
                solutions.joints.truncate(at);
            }
            // With more coordinates than numbers of a pose there are infinitely many solutions: the nearest few are enough.
            if n > 6 && solutions.found.len() >= 16 {
                return;
            }
        }
    }

    /// One search; its joint values are appended.
    fn descend(&self, target: &Pose, near: &[f64], start: u32, solutions: &mut Solutions) -> f64 {
        let Solutions { joints, columns, trial, start: q, .. } = solutions;
        for (k, q) in q.iter_mut().enumerate() {
            let (lower, upper) = self.chain.coordinates()[k].range();
            // Additive recurrence with the square roots of primes: spread evenly for any number of coordinates.
            let share = (0.5 + f64::from(start) * STEPS[k % STEPS.len()] + 0.37 * (k / STEPS.len()) as f64).fract();
            *q = if start == 0 { near[k] } else { lower + share * (upper - lower) };
        }
        let left = newton::least_squares(&self.chain, target, self.size, q, (columns, trial), SEARCH_STEPS);
        joints.extend_from_slice(q);
        left
    }

    /// Where no solution reaches the pose: the smallest error over some searches.
    fn nearest(&self, target: &Pose, near: &[f64], solutions: &mut Solutions) {
        let n = near.len();
        let mut least = f64::INFINITY;
        for start in 0..24 {
            let at = solutions.joints.len();
            let left = self.descend(target, near, start, solutions);
            if left < least {
                least = left;
                if at > 0 {
                    solutions.joints.copy_within(at.., 0);
                }
            }
            solutions.joints.truncate(n);
        }
        let (orientation_error, position_error) = se3::difference(&self.chain.fk(&solutions.joints), target);
        let within_limits = self.within_limits(&solutions.joints);
        solutions.found.push(Found { branch: None, position_error, orientation_error, within_limits });
        solutions.reached = position_error <= REACHED * self.size && orientation_error <= REACHED;
    }
}

/// Fractional parts of the square roots of the first primes.
pub(crate) const STEPS: [f64; 8] = [
    0.414_213_562_373_095,
    0.732_050_807_568_877,
    0.236_067_977_499_789,
    0.645_751_311_064_590,
    0.316_624_790_355_399,
    0.605_551_275_463_989,
    0.123_105_625_617_660,
    0.358_898_943_540_673,
];

/// Within limits first, then the least greatest change of a joint.
fn sort(near: &[f64], solutions: &mut Solutions) {
    let n = near.len();
    let Solutions { joints, found, ranks, sorted, .. } = solutions;
    ranks.clear();
    for (place, (joints, found)) in joints.chunks_exact(n).zip(found.iter()).enumerate() {
        let farthest = joints.iter().zip(near).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        ranks.push(Rank { outside: !found.within_limits, farthest, place });
        // Insertion sort: a handful of items, and no allocation.
        let mut j = place;
        while j > 0 && ranks[j - 1].is_behind(&ranks[j]) {
            ranks.swap(j - 1, j);
            j -= 1;
        }
    }
    let (before, founds) = sorted;
    before.clone_from(joints);
    founds.clone_from(found);
    for (to, Rank { place, .. }) in ranks.iter().enumerate() {
        joints[to * n..][..n].copy_from_slice(&before[place * n..][..n]);
        found[to] = founds[*place];
    }
}

/// What solutions are sorted by, and where one stood before.
#[derive(Debug, Clone, Copy)]
struct Rank {
    outside: bool,
    farthest: f64,
    place: usize,
}

impl Rank {
    fn is_behind(&self, other: &Self) -> bool {
        (self.outside, self.farthest) > (other.outside, other.farthest)
    }
}
