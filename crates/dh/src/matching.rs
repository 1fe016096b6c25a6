//! Is this robot the one that a vendor's table describes? Finds the joint senses, zeros and frames for which it is, and
//! the numbers that differ where it is not.
//!
//! ```text
//! robot(q) = B · vendor(sense · |scale| q + zero) · E      at every q
//!
//! axes ──► senses and zeros that could be ──► least squares over B, E, zeros ──► verdict
//! (invariants of neighbouring lines)                     and over the table's numbers ──► differences
//! ```
//! A match with everything free hides mistakes: it cannot distinguish two robots that differ only in a zero or a sense. So
//! the senses and zeros that were needed are part of the answer, and of all that fit, those with the fewest reversed
//! senses and zeros are chosen.

mod answer;
mod arm;
mod axes;
mod explain;
mod fit;
mod vendor;

pub use answer::{
    Difference, Explanation, JointMatch, Match, MatchError, Nature, NumberMatch, Placement, RowMatch, Sense, Verdict,
};
pub use vendor::{DhNumber, VendorJoint, VendorNumber, VendorRow, VendorTable, Written};

use crate::conventions::RowLabel;
use crate::table::Motion;
use arm::Arm;
use axes::{Guess, alignment, guesses, with_senses, wrapped};
use denavit_model::chain::Chain;
use denavit_model::se3::{self, Pose};
use fit::{AT_ITS_LEAST, Fit, Free, GOES_NOWHERE, Product, State};
use std::f64::consts::FRAC_PI_2;

/// Guesses that are fitted where one of them comes close.
const TRIED: usize = 12;

/// Guesses that are fitted where none does, or where given frames distinguish senses that the axes do not.
const TRIED_AT_MOST: usize = 32;

/// Smallest damping of a fit of frames and zeros: enough against rounding where the geometry leaves one free.
const DAMPING: f64 = 1e-12;

/// A guess whose residual is at most this many times the smallest is as good as the best one.
const AS_GOOD: f64 = 2.0;

/// A zero of 0 or a quarter turn may have this many times the residual of one in between.
const PRUNED_AS_GOOD: f64 = 1.1;

/// Finds how a vendor's table fits a robot, and what differs.
///
/// # Errors
/// The joints differ in number, kind or order, or a number is not finite.
///
/// # Validation
/// tests/matching.rs: every published table that was verified elsewhere comes to the same verdict.
///
/// # Examples
/// ```
/// use denavit_dh::matching::{Verdict, VendorTable, match_table};
/// use denavit_dh::{Convention, Options, convert};
/// let chain = denavit_model::examples::puma_like();
/// let table = convert::table(&chain, &Options::default())?.value;
/// let mut vendor = VendorTable::of(&table, Convention::Distal, false);
/// assert_eq!(match_table(&chain, &vendor).unwrap().verdict, Verdict::Exact);
/// vendor.joints[1].row.a = Some(0.5.into());
/// let found = match_table(&chain, &vendor).unwrap();
/// assert_eq!(found.verdict, Verdict::Mismatch);
/// assert!((found.explanation.unwrap().differences[0].robot - 0.43).abs() < 1e-12);
/// # Ok::<(), denavit_model::ChainError>(())
/// ```
pub fn match_table(chain: &Chain, vendor: &VendorTable) -> Result<Match, MatchError> {
    check(chain, vendor)?;
    let arm = Arm::of(chain);
    let (product, numbers) = Product::of(vendor);
    let matching = Matching { chain, arm: &arm, vendor, product: &product, numbers: &numbers };
    let fits = matching.best_fits();
    let placement = matching.placement(&fits.guess.senses, &fits.state);
    let verdict = Verdict::of(placement.position_error);
    let (found, explanation) = matching.explained(&fits, &placement);
    let rows = matching.rows(&found, verdict, &placement);
    Ok(Match { verdict, placement, rows, explanation })
}

fn check(chain: &Chain, vendor: &VendorTable) -> Result<(), MatchError> {
    let joints = chain.joints();
    for (label, numbers) in vendor.rows() {
        let row = match label {
            RowLabel::Base => 0,
            RowLabel::Joint(index) => index + 1,
            RowLabel::Tool => vendor.joints.len() + 1,
        };
        for number in DhNumber::ALL {
            if numbers.number(number).is_some_and(|number| !number.value.is_finite()) {
                return Err(MatchError::NotFinite { row, number: number.word() });
            }
        }
        if vendor.convention == crate::Convention::Proximal && numbers.beta.is_some() {
            return Err(MatchError::Beta { row });
        }
    }
    if joints.len() != vendor.joints.len() {
        let (base, tip) = (chain.base().to_owned(), chain.tip().to_owned());
        return Err(MatchError::Count { base, tip, robot: joints.len(), vendor: vendor.joints.len() });
    }
    for (index, (joint, of_vendor)) in joints.iter().zip(&vendor.joints).enumerate() {
        let motion = Motion::of(&joint.screw);
        let slides = |motion: Motion| matches!(motion, Motion::Prismatic);
        if let Some(name) = &of_vendor.name
            && *name != joint.name
            && joints.iter().any(|other| other.name == *name)
        {
            return Err(MatchError::Order { row: index + 1, robot: joint.name.clone(), vendor: name.clone() });
        }
        if slides(motion) != slides(of_vendor.motion) {
            return Err(MatchError::Kind {
                row: index + 1,
                joint: joint.name.clone(),
                robot: motion.word(),
                vendor: of_vendor.motion.word(),
            });
        }
    }
    Ok(())
}

/// The guess that fits best (the simplest of those that fit as well), and the simplest that the axes allow.
struct BestFits {
    guess: Guess,
    state: State,
    simplest: (Guess, State),
}

/// Robot and table, prepared.
struct Matching<'a> {
    chain: &'a Chain,
    arm: &'a Arm,
    vendor: &'a VendorTable,
    product: &'a Product,
    numbers: &'a [f64],
}

impl Matching<'_> {
    /// Frames that are not given, the zeros that they do not hold, and no numbers.
    fn free(&self) -> Free {
        let n = self.arm.screws.len();
        let (base, tool) = (self.vendor.base.is_none(), self.vendor.tool.is_none());
        let zeros = (0..n).map(|k| !(base && k == 0 || tool && k + 1 == n)).collect();
        Free { base, tool, zeros, numbers: vec![false; self.numbers.len()] }
    }

    /// The state for a guess: frames by aligning the axes, or zeros of the outer joints where they are given.
    fn start(&self, guess: &Guess) -> State {
        let mut zeros = guess.zeros.clone();
        let n = zeros.len();
        let free = self.free();
        for (zero, free) in zeros.iter_mut().zip(&free.zeros) {
            if !free {
                *zero = 0.0;
            }
        }
        let robot = with_senses(&self.arm.axes(), &guess.senses);
        let vendor = self.product.axes(self.numbers, &zeros);
        let mut base = alignment(&vendor, &robot, self.arm.size);
        let mut tool = (base * self.product.pose(self.numbers, &zeros)).inverse() * self.arm.home;
        if n == 0 {
            return State { base: Pose::identity(), tool, zeros, numbers: self.numbers.to_vec() };
        }
        if !free.base {
            if vendor[0].turns {
                zeros[0] = wrapped(zeros[0] + turn_about(&base, &vendor[0].direction));
            }
            base = Pose::identity();
        }
        if !free.tool {
            let reached = self.product.pose(self.numbers, &zeros);
            if vendor[n - 1].turns {
                let axis = reached.rotation.inverse() * self.product.axes(self.numbers, &zeros)[n - 1].direction;
                let left = (base * reached).inverse() * self.arm.home;
                zeros[n - 1] = wrapped(zeros[n - 1] + turn_about(&left, &axis));
            }
            tool = Pose::identity();
        }
        State { base, tool, zeros, numbers: self.numbers.to_vec() }
    }

    fn best_fits(&self) -> BestFits {
        let free = self.free();
        let robot = self.arm.axes();
        let unturned = vec![0.0; robot.len()];
        let guesses = guesses(&robot, &self.product.axes(self.numbers, &unturned), self.arm.size);
        let tried = if free.base && free.tool { TRIED } else { TRIED_AT_MOST };
        // The directions of the axes do not determine a slide's zero.
        let has_slides = robot.iter().any(|axis| !axis.turns);
        let mut fitted: Vec<(f64, Guess, State)> = Vec::new();
        let mut least = f64::INFINITY;
        for guess in guesses {
            let verdict = Verdict::of(least);
            let count = fitted.len();
            let found = verdict == Verdict::Exact && !has_slides;
            if found || count >= TRIED_AT_MOST || (count >= tried && verdict < Verdict::Mismatch) {
                break;
            }
            let fit = Fit { falls: GOES_NOWHERE, ..self.fit(&guess.senses) };
            let state = fit.solve(self.start(&guess), &free);
            let (error, _) = fit.errors(&state, &self.arm.samples);
            least = least.min(error);
            fitted.push((error, guess, state));
        }
        let simplest = fitted.first().map(|(_, guess, state)| (guess.clone(), state.clone()));
        let exact = Verdict::of(least) == Verdict::Exact;
        let as_good = |error: f64| (error <= AS_GOOD * least || exact) && Verdict::of(error) == Verdict::of(least);
        let polished = |(_, guess, state): (f64, Guess, State)| {
            let fit = self.fit(&guess.senses);
            let state = fit.solve(state, &free);
            let (error, _) = fit.errors(&state, &self.arm.samples);
            let state = self.pruned(&guess.senses, state, error, &free);
            (guess, state)
        };
        let simplicity =
            |(guess, state): &(Guess, State)| Guess { zeros: state.zeros.clone(), ..guess.clone() }.simplicity();
        let best = fitted.into_iter().filter(|(error, ..)| as_good(*error));
        let alike = if has_slides && exact { TRIED } else { 1 };
        let best = best.take(alike).map(polished).min_by_key(simplicity);
        let (simplest, (guess, state)) = simplest.zip(best).expect("there is always a guess");
        BestFits { guess, state, simplest }
    }

    fn fit<'s>(&'s self, senses: &'s [f64]) -> Fit<'s> {
        Fit {
            product: self.product,
            senses,
            samples: &self.arm.samples,
            size: self.arm.size,
            damping: DAMPING,
            falls: AT_ITS_LEAST,
        }
    }

    /// Unneeded zeros become 0; zeros for which a quarter turn fits as well become a quarter turn.
    fn pruned(&self, senses: &[f64], mut state: State, error: f64, free: &Free) -> State {
        let fit = self.fit(senses);
        let allowed = error * PRUNED_AS_GOOD + 1e-12 * self.arm.size;
        let mut free = free.clone();
        for k in 0..state.zeros.len() {
            if state.zeros[k] == 0.0 {
                free.zeros[k] = false;
            }
            if !free.zeros[k] {
                continue;
            }
            state.zeros[k] = if self.turns(k) { wrapped(state.zeros[k]) } else { state.zeros[k] };
            let quarter = if self.turns(k) { nearest_quarter(state.zeros[k]) } else { 0.0 };
            for value in [0.0, quarter] {
                let mut trial = state.clone();
                trial.zeros[k] = value;
                free.zeros[k] = false;
                let trial = fit.solve(trial, &free);
                if fit.errors(&trial, &self.arm.samples).0 <= allowed {
                    state = trial;
                    break;
                }
                free.zeros[k] = true;
            }
        }
        state
    }

    fn turns(&self, joint: usize) -> bool {
        !matches!(self.product.motions[joint], Motion::Prismatic)
    }

    fn placement(&self, senses: &[f64], state: &State) -> Placement {
        let (position_error, rotation_error) = self.fit(senses).errors(state, &self.arm.proof);
        let joints =
            self.chain.joints().iter().zip(senses).zip(&state.zeros).map(|((joint, sense), zero)| JointMatch {
                name: joint.name.clone(),
                sense: if *sense < 0.0 { Sense::Reversed } else { Sense::Same },
                zero: *zero,
            });
        Placement { joints: joints.collect(), base: state.base, tool: state.tool, position_error, rotation_error }
    }
}

fn nearest_quarter(angle: f64) -> f64 {
    wrapped((angle / FRAC_PI_2).round() * FRAC_PI_2)
}

/// Angle by which a motion turns about a direction, as well as it is defined, rad.
fn turn_about(motion: &Pose, direction: &denavit_model::nalgebra::Vector3<f64>) -> f64 {
    let across = se3::skew(direction);
    let rotation = motion.rotation.matrix();
    // tr(R) = u'Ru + cos · tr(I - uu'), and [u]' meets sin only.
    let sine = -(across * rotation).trace();
    let cosine = rotation.trace() - direction.dot(&(rotation * direction));
    sine.atan2(cosine)
}
