//! Every branch of six revolute joints: those of the drawn arm, carried to the arm as it is.

use crate::arm::SixR;
use crate::branch::Branch;
use crate::circles::{EXACT, Few, SLACK};
use crate::class::{Class, Drawn};
use crate::general::Elimination;
use crate::solver::{REACHED, STEPS};
use crate::{newton, parallel, wrist};
use denavit_model::Pose;

/// Starts around a branch that the real arm does not have where the drawn one has it, and how far around, rad: the
/// nearer a singularity, the smaller the region from which Newton's method finds a branch.
const AROUND: u32 = 40;
const NEARBY: [f64; 2] = [0.12, 0.4];

/// The closed form of six joints.
#[derive(Debug, Clone)]
pub(crate) struct Six {
    arm: SixR,
    pub drawn: Drawn,
    general: Option<Box<Elimination>>,
    /// How far beyond tangency a branch of the drawn arm is tried on the real one.
    slack: f64,
}

/// What a pose's six-joint candidates were good for.
#[derive(Default)]
pub(crate) struct Tally {
    pub lost: usize,
}

impl Six {
    pub fn of(arm: SixR, size: f64, always_general: bool) -> Self {
        let drawn = Drawn::of(&arm, size);
        let exact = drawn.angle < 1e-9 && drawn.distance < 1e-9 * size;
        let needs_general = always_general && (!exact || drawn.class == Class::General);
        let general = needs_general.then(|| Box::new(Elimination::of(&arm, size)));
        Self { arm, drawn, general, slack: if exact { EXACT } else { SLACK } }
    }

    /// Calls `add` with the joint values of each solution.
    pub fn each(&self, target: &Pose, size: f64, mut add: impl FnMut(&[f64; 6], Option<Branch>) -> bool) -> Tally {
        let mut tally = Tally::default();
        let reversed = self.drawn.is_reversed();
        let seen = if reversed { target.inverse() } else { *target };
        let is_wrist = matches!(self.drawn.class, Class::SphericalWrist | Class::SphericalShoulder);
        let found = match self.drawn.class {
            Class::SphericalWrist | Class::SphericalShoulder => wrist::solve(&self.drawn.arm, &seen, self.slack),
            Class::ParallelShoulder | Class::ParallelWrist => parallel::solve(&self.drawn.arm, &seen, self.slack),
            Class::General => {
                self.eliminate(target, size, |values| {
                    add(values, None);
                });
                return tally;
            }
        };
        let turned = |values: &[f64; 6]| {
            let mut values = *values;
            if reversed {
                values.reverse();
                values = values.map(|value| -value);
            }
            values
        };
        let exact = self.slack <= EXACT;
        let named = |values: &[f64; 6]| Some(Branch::of(&self.drawn.arm, &turned(values), is_wrist));
        let (mut failed, mut reached) = (Few::<[f64; 6], 8>::new([0.0; 6]), 0u32);
        for values in found.as_slice() {
            let mut there = turned(values);
            if newton::refine(&self.arm, target, size, &mut there, REACHED).is_some() && add(&there, named(&there)) {
                reached += 1;
            } else {
                failed.push(*values);
            }
        }
        // Near a singularity a branch of the real arm lies far from that of the drawn one. Solutions come in pairs, so that an odd
        // number of them tells the same.
        if exact || (failed.as_slice().is_empty() && reached % 2 == 0) {
            return tally;
        }
        for values in failed.as_slice() {
            let drawn_reaches = newton::error(&seen, &self.drawn.arm.fk(values), size).norm() < 1e-6;
            // All of the starts: where two singularities meet the real arm may have four branches in place of two.
            let mut found = false;
            for k in 0..AROUND {
                let mut there = turned(values);
                for (joint, value) in there.iter_mut().enumerate() {
                    *value += NEARBY[k as usize % 2] * (2.0 * (0.5 + f64::from(k) * STEPS[joint]).fract() - 1.0);
                }
                found |= newton::refine(&self.arm, target, size, &mut there, REACHED).is_some()
                    && add(&there, named(&there));
            }
            tally.lost += usize::from(!found && drawn_reaches);
        }
        self.eliminate(target, size, |values| {
            add(values, named(values));
        });
        tally
    }

    fn eliminate(&self, target: &Pose, size: f64, mut add: impl FnMut(&[f64; 6])) {
        let Some(general) = &self.general else { return };
        for values in general.solve(target, size).as_slice() {
            let mut there = *values;
            if newton::refine(&self.arm, target, size, &mut there, REACHED).is_some() {
                add(&there);
            }
        }
    }
}
