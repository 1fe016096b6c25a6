//! Every branch of six revolute joints: those of the nominal arm, refined for the real arm.

use crate::arm::{Angle, Axis, SixR};
use crate::branch::Branch;
use crate::circles::{EXACT, Few, SLACK};
use crate::class::{Class, Drawn};
use crate::general::{Candidates, Elimination, INDEPENDENT, Order, REGULAR};
use crate::newton::{Landed, Placed};
use crate::solver::{REACHED, STEPS};
use crate::{newton, parallel, wrist};
use denavit_model::Pose;
use std::f64::consts::PI;

/// Starts around a branch that the real arm does not have where the nominal one has it, and how far around, rad: the
/// nearer a singularity, the smaller the region from which Newton's method finds a branch.
const AROUND: u32 = 40;
const NEARBY: [f64; 2] = [0.12, 0.4];

/// Postures that rank the orders of elimination, whose errors differ by powers of ten.
const RANKING: u32 = 8;
/// Postures that a sound elimination must find.
const POSTURES: u32 = 40;
/// Half the angle, rad, by which a posture that was found differs from the one that made the pose.
const SAME_POSTURE: f64 = 1e-5;
/// Candidates this near to their solutions (sine of half an angle) come of accurate eigenvalues.
const ACCURATE: f64 = 1e-3;

/// Arms near one whose own equations are dependent: by how much, rad and share of the size, the axes are off, and which way (a seed).
/// At 1e-6 the equations still are dependent, at 1e-2 solutions are lost. Two solutions near a singularity that an arm does not have,
/// the arm as far off the opposite way has.
const NEAR: [(f64, usize); 4] = [(1e-4, 0), (-1e-4, 0), (3e-4, 1), (-3e-4, 1)];

/// Pivots of the Jacobian (rad and shares of the size) below which a calibrated arm may have branches that the nominal one does not have: ten of
/// 10 000 poses of a UR10 had some beside all eight, at pivots up to 0.011, one of 100 000 above 0.021.
const NEAR_SINGULAR: f64 = 0.025;

/// Branches of a class.
const MOST: u32 = 8;

/// The closed form of six joints.
#[derive(Debug, Clone)]
pub(crate) struct Six {
    arm: SixR,
    pub drawn: Drawn,
    general: Option<Eliminations>,
    /// How far beyond tangency a branch of the nominal arm is tried on the real one.
    slack: f64,
}

/// The outcome of a pose's six-joint candidates.
#[derive(Default)]
pub(crate) struct Tally {
    pub lost: usize,
}

impl Six {
    pub fn of(arm: SixR, size: f64, always_general: bool) -> Self {
        let drawn = Drawn::of(&arm, size);
        let exact = drawn.angle < 1e-9 && drawn.distance < 1e-9 * size;
        let needs_general = always_general && (!exact || drawn.class == Class::General);
        let general = needs_general.then(|| Eliminations::of(&arm, size));
        // Branches are named by points that the class singles out, such as the wrist's centre.
        let named = if drawn.is_reversed() { drawn.arm.reversed() } else { drawn.arm.clone() };
        let arm = arm.with_points_near(&named.axes.map(|axis| axis.point));
        Self { arm, drawn, general, slack: if exact { EXACT } else { SLACK } }
    }

    /// Calls `add` with the joint values of each solution and their pose.
    pub fn each(
        &self,
        target: &Pose,
        size: f64,
        mut add: impl FnMut(&[f64; 6], Option<Branch>, &Landed) -> bool,
    ) -> Tally {
        let mut tally = Tally::default();
        let reversed = self.drawn.is_reversed();
        let seen = if reversed { target.inverse() } else { *target };
        let is_wrist = matches!(self.drawn.class, Class::SphericalWrist | Class::SphericalShoulder);
        let turned = |angles: &[Angle; 6]| {
            let mut angles = *angles;
            if reversed {
                angles.reverse();
                angles = angles.map(|angle| -angle);
            }
            angles
        };
        let exact = self.slack <= EXACT;
        let named = |[a, b, c, d, e, f]: &[Axis; 6]| {
            Some(Branch::of(if reversed { [f, e, d, c, b, a] } else { [a, b, c, d, e, f] }, is_wrist))
        };
        let (mut failed, mut reached, mut smallest) =
            (Few::<[Angle; 6], 8>::new([Angle::ZERO; 6]), 0u32, f64::INFINITY);
        let mut placed = Placed::new(&self.arm);
        let each = |values: &[Angle; 6]| {
            let mut there = turned(values);
            if let Some(landed) = newton::refine(&mut placed, target, size, &mut there, REACHED)
                && add(&values_of(&there), named(placed.axes()), &landed)
            {
                reached += 1;
                smallest = smallest.min(landed.pivot);
            } else {
                failed.push(*values);
            }
        };
        match self.drawn.class {
            Class::SphericalWrist | Class::SphericalShoulder => wrist::solve(&self.drawn.arm, &seen, self.slack, each),
            Class::ParallelShoulder | Class::ParallelWrist => parallel::solve(&self.drawn.arm, &seen, self.slack, each),
            Class::General => {
                self.eliminate(target, size, 0, |values, _, landed| add(values, None, landed));
                return tally;
            }
        }
        // Near a singularity a branch of the real arm is far from that of the nominal one, or exists where the nominal arm has none:
        // only if every branch of the class was reached and none is near a singularity, there is certainly no other.
        if exact || (failed.as_slice().is_empty() && reached == MOST && smallest > NEAR_SINGULAR) {
            return tally;
        }
        let drawn_reaches =
            |values: &&[Angle; 6]| newton::error(&seen, &self.drawn.arm.fk(&values_of(values)), size).norm() < 1e-6;
        let expected = failed.as_slice().iter().filter(drawn_reaches).count();
        let mut new = 0;
        let mut add = |values: &[f64; 6], axes: &[Axis; 6], landed: &Landed| {
            let is_new = add(values, named(axes), landed);
            new += usize::from(is_new);
            is_new
        };
        if self.general.is_some() {
            self.eliminate(target, size, reached as usize, add);
        } else {
            for values in failed.as_slice() {
                self.around(target, size, &turned(values), &mut add);
            }
        }
        tally.lost = expected.saturating_sub(new);
        tally
    }

    /// Newton's method from many starts around the values of a branch: all of them, as where two singularities meet the arm may have
    /// four branches instead of two.
    fn around(
        &self,
        target: &Pose,
        size: f64,
        values: &[Angle; 6],
        add: &mut impl FnMut(&[f64; 6], &[Axis; 6], &Landed) -> bool,
    ) {
        let mut placed = Placed::new(&self.arm);
        for k in 0..AROUND {
            let mut there = *values;
            for (joint, angle) in there.iter_mut().enumerate() {
                let by = NEARBY[k as usize % 2] * (2.0 * (0.5 + f64::from(k) * STEPS[joint]).fract() - 1.0);
                *angle = Angle::at(angle.value + by);
            }
            if let Some(landed) = newton::refine(&mut placed, target, size, &mut there, REACHED) {
                add(&values_of(&there), placed.axes(), &landed);
            }
        }
    }

    /// Adds what elimination finds to the solutions that are `known`; `add` tells whether a solution is new.
    fn eliminate(
        &self,
        target: &Pose,
        size: f64,
        known: usize,
        mut add: impl FnMut(&[f64; 6], &[Axis; 6], &Landed) -> bool,
    ) {
        let Some(Eliminations { own, near, dependent }) = &self.general else { return };
        let mut placed = Placed::new(&self.arm);
        // How many are new, and how far the farthest solution lies from where its candidate was; `None` without solutions.
        let mut refined = |candidates: &Candidates| {
            let (mut new, mut farthest) = (0, None::<f64>);
            for values in candidates.joints.as_slice() {
                let mut there = values.map(Angle::at);
                if let Some(landed) = newton::refine(&mut placed, target, size, &mut there, REACHED) {
                    new += usize::from(add(&values_of(&there), placed.axes(), &landed));
                    farthest = Some(farthest.unwrap_or(0.0).max(apart(&values_of(&there), values)));
                }
            }
            (new, farthest)
        };
        let candidates = own.solve(target, size);
        let (new, farthest) = refined(&candidates);
        let found = known + new;
        let near_enough = farthest.is_some_and(|farthest| farthest < ACCURATE);
        let accurate = candidates.regular > REGULAR || (candidates.regular > INDEPENDENT && near_enough);
        // Each real eigenvalue is a solution, and solutions come in pairs: if some are missing, the equations are nearly dependent.
        if *dependent || !accurate || found < candidates.real || found % 2 == 1 {
            for near in near {
                refined(&near.solve(target, size));
            }
        }
    }
}

/// The eliminations that together find every solution.
#[derive(Debug, Clone)]
struct Eliminations {
    /// In the order that is most accurate for this arm.
    own: Elimination,
    /// Of arms near it, for poses at which its equations are dependent.
    near: Vec<Elimination>,
    /// Its equations are dependent at any pose.
    dependent: bool,
}

impl Eliminations {
    /// Some postures of the arm show which order is accurate.
    fn of(arm: &SixR, size: f64) -> Self {
        let [first, others @ ..] = Order::ALL.map(|order| {
            let elimination = Elimination::of(arm, size, order);
            let digits = |k| error(&elimination, arm, size, &posture(k)).max(f64::EPSILON).ln();
            ((1..=RANKING).map(digits).sum::<f64>(), elimination)
        });
        let (_, own) = others.into_iter().fold(first, |best, other| if other.0 < best.0 { other } else { best });
        let dependent = !(1..=POSTURES).all(|k| finds(&own, arm, size, &posture(k)));
        let near = |(angle, seed)| Elimination::of(&arm.perturbed(angle, size, seed), size, Order::ALL[0]);
        Self { own, near: NEAR.into_iter().map(near).collect(), dependent }
    }
}

/// One of a sequence of postures that fills the joint range evenly, rad.
fn posture(k: u32) -> [f64; 6] {
    std::array::from_fn(|joint| PI * (2.0 * (0.5 + f64::from(k) * STEPS[joint]).fract() - 1.0))
}

/// By how much two postures differ: the largest sine of half a joint's difference.
fn apart(a: &[f64; 6], b: &[f64; 6]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (0.5 * (a - b)).sin().abs()).fold(0.0, f64::max)
}

/// The error of the candidate that is nearest to a posture, among those for its own pose.
fn error(elimination: &Elimination, arm: &SixR, size: f64, posture: &[f64; 6]) -> f64 {
    let candidates = elimination.solve(&arm.fk(posture), size);
    candidates.joints.as_slice().iter().map(|values| apart(values, posture)).fold(1.0, f64::min)
}

/// Whether a posture is among the solutions of its own pose.
fn finds(elimination: &Elimination, arm: &SixR, size: f64, posture: &[f64; 6]) -> bool {
    let target = arm.fk(posture);
    let mut placed = Placed::new(arm);
    elimination.solve(&target, size).joints.as_slice().iter().any(|values| {
        let mut there = values.map(Angle::at);
        let landed = newton::refine(&mut placed, &target, size, &mut there, REACHED);
        landed.is_some() && apart(&values_of(&there), posture) < SAME_POSTURE
    })
}

fn values_of(angles: &[Angle; 6]) -> [f64; 6] {
    angles.map(|angle| angle.value)
}
