//! Which numbers of a table differ from the robot's.

use super::axes::{Guess, wrapped};
use super::fit::{Fit, Free, GOES_NOWHERE, State};
use super::vendor::{DhNumber, VendorNumber};
use super::{
    BestFits, Difference, Explanation, Matching, Nature, NumberMatch, Placement, RowMatch, Verdict, nearest_quarter,
};
use crate::conventions::RowLabel;

/// A tip error below this, relative to the robot's size, counts as explained: above the error of π written with
/// five digits, far below that of a wrong number.
const EXPLAINED: f64 = 2e-5;

/// A number that moves by less (m or rad, of the robot's size) is not a difference.
const MOVES: f64 = 1e-6;

/// A number is the same amount on the other side when the two add up to less than this share of it.
const OTHER_SIDE: f64 = 0.02;

/// Zeros that differ by less than this, rad, are those that were stated, and not another reading of the same arm.
const NEAR_STATED: f64 = 0.5;

/// Rounding error of a fitted number (rad, m of the robot's size).
const LEFT: f64 = 1e-9;

/// Smallest damping of a fit over all numbers: directions as weak as d between two axes 1e-4 rad from parallel are not followed.
const HELD: f64 = 1e-8;

impl Matching<'_> {
    /// The state with the robot's own numbers, and the fewest that must change where the vendor's do not fit.
    pub(super) fn explained(&self, fits: &BestFits, placement: &Placement) -> (State, Option<Explanation>) {
        if Verdict::of(placement.position_error) <= Verdict::Rounded {
            let fit = Fit { damping: HELD, ..self.fit(&fits.guess.senses) };
            return (fit.solve(fits.state.clone(), &self.all_free()), None);
        }
        let simplest = (&fits.simplest.0, &fits.simplest.1);
        let mut found = self.explained_from(simplest.0, simplest.1, placement);
        let alone = found.as_ref().is_some_and(|(_, explanation)| explanation.differences.len() == 1);
        if !alone && fits.simplest.0.senses != fits.guess.senses {
            let other = self.explained_from(&fits.guess, &fits.state, placement);
            let count = |found: &Option<(State, Explanation)>| {
                found.as_ref().map_or(usize::MAX, |(_, explanation)| explanation.differences.len())
            };
            if count(&other) < count(&found) {
                found = other;
            }
        }
        let found = found.map(|found| self.at_stated_zeros(fits, &found).unwrap_or(found));
        found.map_or_else(|| (fits.state.clone(), None), |(state, explanation)| (state, Some(explanation)))
    }

    /// The same differences at the senses and zeros of the table as it stands, where they serve there, too: turning x of a
    /// frame round changes the sign of a length and two zeros by half a turn, and a reader takes the number with the zeros
    /// that are stated.
    fn at_stated_zeros(
        &self,
        fits: &BestFits,
        (state, explanation): &(State, Explanation),
    ) -> Option<(State, Explanation)> {
        let fit = Fit { damping: HELD, ..self.fit(&fits.guess.senses) };
        let support: Vec<usize> = explanation
            .differences
            .iter()
            .filter_map(|of| self.product.places.iter().position(|place| *place == (of.label, of.number)))
            .collect();
        let left = self.fit(&Self::senses_of(explanation)).errors(state, &self.arm.samples).0;
        // No worse than what was found, but for rounding.
        let enough = (2.0 * left).max(LEFT * self.arm.size);
        let mut free = self.only(&support);
        let stated = fits.state.zeros.clone();
        free.zeros.fill(false);
        let mut trial = fit.solve(fits.state.clone(), &free);
        if fit.errors(&trial, fit.samples).0 > enough {
            // The zeros may also change a little with other numbers.
            trial = fit.solve(fits.state.clone(), &self.only(&support));
            let near = |(zero, stated): (&f64, &f64)| wrapped(zero - stated).abs() < NEAR_STATED;
            let turned_only = (0..stated.len()).filter(|k| self.turns(*k)).all(|k| near((&trial.zeros[k], &stated[k])));
            if fit.errors(&trial, fit.samples).0 > enough || !turned_only {
                return None;
            }
        }
        let differences = self.differences(support, &trial);
        let placement = self.placement(&fits.guess.senses, &trial);
        Some((trial, Explanation { differences, placement }))
    }

    fn senses_of(explanation: &Explanation) -> Vec<f64> {
        explanation.placement.joints.iter().map(|joint| joint.sense.sign()).collect()
    }

    fn all_free(&self) -> Free {
        let numbers = self.product.places.iter().map(|place| self.is_own_number(*place)).collect();
        Free { numbers, ..self.free() }
    }

    fn explained_from(&self, guess: &Guess, fitted: &State, placement: &Placement) -> Option<(State, Explanation)> {
        let fit = Fit { damping: HELD, ..self.fit(&guess.senses) };
        let quick = Fit { falls: GOES_NOWHERE, ..self.fit(&guess.senses) };
        let all = self.all_free();
        let start = self.start(guess);
        let error = |state: &State| fit.errors(state, fit.samples).0;
        let mut whole = fit.solve(start.clone(), &all);
        if error(&whole) > EXPLAINED * self.arm.size {
            let other = fit.solve(fitted.clone(), &all);
            whole = if error(&other) < error(&whole) { other } else { whole };
        }
        let enough = (2.0 * error(&whole)).max(EXPLAINED * self.arm.size);
        if enough > 0.5 * placement.position_error {
            return None;
        }
        let order = self.most_likely_first(&whole, &all);
        let single = order.iter().find_map(|number| {
            let free = self.only(&[*number]);
            let state = quick.solve(start.clone(), &free);
            (error(&state) <= enough).then(|| (vec![*number], fit.solve(state, &free)))
        });
        let (support, state) = single.unwrap_or_else(|| self.fewest(&fit, &order, whole, enough));
        let left = error(&state);
        let state = self.pruned(&guess.senses, state, left, &self.only(&support));
        let differences = self.differences(support, &state);
        let placement = self.placement(&guess.senses, &state);
        Some((state, Explanation { differences, placement }))
    }

    /// Numbers that are not already covered by a zero.
    fn is_own_number(&self, (label, number): (RowLabel, DhNumber)) -> bool {
        match label {
            RowLabel::Joint(index) if self.turns(index) => number != DhNumber::Theta,
            RowLabel::Joint(_) => number != DhNumber::D,
            _ => true,
        }
    }

    fn only(&self, numbers: &[usize]) -> Free {
        let mut free = self.free();
        for number in numbers {
            free.numbers[*number] = true;
        }
        free
    }

    /// Numbers that the vendor states before zeros, then those that moved most in a fit of all.
    fn most_likely_first(&self, whole: &State, all: &Free) -> Vec<usize> {
        let mut order: Vec<usize> = (0..self.numbers.len()).filter(|number| all.numbers[*number]).collect();
        let moved = |number: usize| {
            let scale = if self.product.places[number].1.is_length() { self.arm.size } else { 1.0 };
            (whole.numbers[number] - self.numbers[number]).abs() / scale
        };
        order.retain(|number| moved(*number) > MOVES);
        let stated = |number: usize| self.numbers[number] != 0.0;
        order.sort_by(|a, b| stated(*b).cmp(&stated(*a)).then_with(|| moved(*b).total_cmp(&moved(*a))));
        order
    }

    /// From a fit of all numbers, one after the other put back to the vendor's as long as the rest can do without it.
    fn fewest(&self, fit: &Fit, order: &[usize], whole: State, enough: f64) -> (Vec<usize>, State) {
        let (mut support, mut state) = (order.to_vec(), whole);
        for number in order.iter().rev() {
            let fewer: Vec<usize> = support.iter().copied().filter(|other| other != number).collect();
            let mut trial = state.clone();
            for (index, value) in trial.numbers.iter_mut().enumerate() {
                if !fewer.contains(&index) {
                    *value = self.numbers[index];
                }
            }
            let trial = fit.solve(trial, &self.only(&fewer));
            if fit.errors(&trial, fit.samples).0 <= enough {
                (support, state) = (fewer, trial);
            }
        }
        (support, state)
    }

    /// The numbers of `support` in the order of the table, with the nature of each difference.
    fn differences(&self, mut support: Vec<usize>, state: &State) -> Vec<Difference> {
        support.sort_unstable();
        let nature = |number: usize| {
            let (vendor, robot) = (self.numbers[number], state.numbers[number]);
            if vendor != 0.0 && (robot + vendor).abs() < OTHER_SIDE * vendor.abs() {
                return Nature::Sign;
            }
            let is_length = |place: &(RowLabel, DhNumber)| place.1 == DhNumber::A;
            let lengths: Vec<usize> = (0..self.numbers.len()).filter(|k| is_length(&self.product.places[*k])).collect();
            let Some(at) = lengths.iter().position(|length| *length == number) else { return Nature::Amount };
            let beside = [at.checked_sub(1), Some(at + 1)].into_iter().flatten().filter_map(|k| lengths.get(k));
            let gone = robot.abs() < OTHER_SIDE * vendor.abs();
            let taken = |other: &&usize| {
                let whole = self.numbers[**other].hypot(vendor);
                support.contains(other) && (state.numbers[**other].abs() - whole).abs() < MOVES * self.arm.size
            };
            match beside.filter(|_| gone).find(taken) {
                Some(other) => Nature::OtherSideOfJoint { with: self.product.places[*other].0 },
                None => Nature::Amount,
            }
        };
        let difference = |number: &usize| {
            let (label, which) = self.product.places[*number];
            let (vendor, robot) = (self.numbers[*number], state.numbers[*number]);
            Difference { label, number: which, vendor, robot, nature: nature(*number) }
        };
        support.iter().map(difference).collect()
    }

    /// The table beside the robot's own numbers.
    pub(super) fn rows(&self, found: &State, verdict: Verdict, placement: &Placement) -> Vec<RowMatch> {
        let left = if verdict <= Verdict::Rounded { 2.0 } else { 0.0 };
        let written = |lengths| self.vendor.half_last_place(lengths);
        let length = (left * placement.position_error).max(LEFT * self.arm.size).max(written(true));
        let angle = (left * placement.rotation_error).max(LEFT).max(written(false));
        let mut rows: Vec<RowMatch> = Vec::new();
        for (index, (label, number)) in self.product.places.iter().enumerate() {
            let vendor = self.written(*label, *number);
            let mut robot = found.numbers[index];
            if let (RowLabel::Joint(joint), DhNumber::Theta) = (label, number)
                && self.turns(*joint)
            {
                let zero = found.zeros[*joint];
                let odd = zero - nearest_quarter(zero);
                robot += if odd.abs() <= angle { odd } else { 0.0 };
            }
            let agrees = (robot - vendor.value).abs() <= if number.is_length() { length } else { angle };
            let matched = NumberMatch { number: *number, vendor, robot, agrees };
            match rows.last_mut() {
                Some(row) if row.label == *label => row.numbers.push(matched),
                _ => rows.push(RowMatch { label: *label, numbers: vec![matched] }),
            }
        }
        rows
    }

    fn written(&self, label: RowLabel, number: DhNumber) -> VendorNumber {
        let row = self.vendor.rows().find(|(of, _)| *of == label);
        row.and_then(|(_, row)| row.number(number)).cloned().unwrap_or_default()
    }
}
