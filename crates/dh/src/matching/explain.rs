//! Which numbers of a table are not the robot's.

use super::axes::Guess;
use super::fit::{Fit, Free, State};
use super::vendor::{DhNumber, VendorNumber};
use super::{
    Difference, Explanation, Match, Nature, NumberMatch, Placement, Problem, QUARTER, RowMatch, Verdict,
    nearest_quarter,
};
use crate::conventions::RowLabel;

/// What is left of a tip error once it counts as explained, relative to the robot's size: above what π written with
/// five digits leaves, far below a number that was mistaken.
const EXPLAINED: f64 = 2e-5;

/// A number that moves by less (m or rad, of the robot's size) is not a difference.
const MOVES: f64 = 1e-6;

/// A number is the same amount on the other side when the two add up to less than this share of it.
const OTHER_SIDE: f64 = 0.02;

/// Least damping of a fit over all numbers: what two axes 1e-4 rad from parallel say of d is not followed.
const HELD: f64 = 1e-8;

impl Problem<'_> {
    /// The state with the robot's own numbers, and where the vendor's do not serve, the fewest that must change.
    pub(super) fn explained(
        &self,
        guess: &Guess,
        fitted: &State,
        placement: &Placement,
    ) -> (State, Option<Explanation>) {
        let verdict = Verdict::of(placement.position_error);
        let mut fit = self.fit_of(&guess.senses);
        fit.damping = HELD;
        let mut all = self.free();
        all.numbers = self.product.places.iter().map(|place| self.is_own_number(*place)).collect();
        if verdict <= Verdict::Rounded {
            return (fit.solve(fitted.clone(), &all), None);
        }
        let start = self.start(guess);
        let whole = [start.clone(), fitted.clone()].map(|start| fit.solve(start, &all));
        let error = |state: &State| fit.errors(state, fit.samples).0;
        let whole = whole.into_iter().min_by(|a, b| error(a).total_cmp(&error(b))).expect("there are two");
        let enough = (2.0 * error(&whole)).max(EXPLAINED * self.arm.size);
        if enough > 0.5 * placement.position_error {
            return (fitted.clone(), None);
        }
        let order = self.most_likely_first(&whole, &all);
        let single = order.iter().find_map(|number| {
            let free = self.only(&[*number]);
            let starts = [start.clone(), fitted.clone()];
            let found = starts.into_iter().map(|start| fit.solve(start, &free)).find(|state| error(state) <= enough)?;
            Some((vec![*number], found))
        });
        let (support, state) = single.unwrap_or_else(|| self.fewest(&fit, &order, whole, enough));
        let state = self.tidied(&guess.senses, state, enough, &self.only(&support));
        let differences = support.iter().map(|number| self.difference(*number, state.numbers[*number]));
        let mut differences: Vec<(usize, Difference)> = support.iter().copied().zip(differences).collect();
        differences.sort_by_key(|(number, _)| *number);
        let differences = differences.into_iter().map(|(_, difference)| difference).collect();
        let placement = self.placement(&guess.senses, &state);
        (state, Some(Explanation { differences, placement }))
    }

    /// Numbers that a zero does not stand for already.
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

    fn difference(&self, number: usize, robot: f64) -> Difference {
        let (label, which) = self.product.places[number];
        let vendor = self.numbers[number];
        let other_side = vendor != 0.0 && (robot + vendor).abs() < OTHER_SIDE * vendor.abs();
        let nature = if other_side { Nature::Sign } else { Nature::Amount };
        Difference { label, number: which, vendor, robot, nature }
    }

    /// The table beside the robot's own numbers.
    pub(super) fn rows(&self, found: &State, verdict: Verdict, placement: &Placement) -> Vec<RowMatch> {
        let left = if verdict <= Verdict::Rounded { 2.0 } else { 0.0 };
        let length = (left * placement.position_error).max(EXPLAINED * 1e-3 * self.arm.size);
        let angle = (left * placement.rotation_error).max(length / self.arm.size);
        let mut rows: Vec<RowMatch> = Vec::new();
        for (index, (label, number)) in self.product.places.iter().enumerate() {
            let vendor = self.written(*label, *number);
            let mut robot = found.numbers[index];
            if let (RowLabel::Joint(joint), DhNumber::Theta) = (label, number)
                && self.turns(*joint)
            {
                let zero = found.zeros[*joint];
                let odd = zero - nearest_quarter(zero);
                robot += if odd.abs() < QUARTER { odd } else { 0.0 };
            }
            let left = if number.is_length() { length } else { angle };
            let agrees = (robot - vendor.value).abs() <= left.max(vendor.half_last_place());
            let matched = NumberMatch { number: *number, vendor, robot, agrees };
            match rows.last_mut() {
                Some(row) if row.label == *label => row.numbers.push(matched),
                _ => rows.push(RowMatch { label: *label, numbers: vec![matched] }),
            }
        }
        rows
    }

    fn written(&self, label: RowLabel, number: DhNumber) -> VendorNumber {
        let row = match label {
            RowLabel::Base => self.vendor.base.as_ref(),
            RowLabel::Joint(index) => self.vendor.joints.get(index).map(|joint| &joint.row),
            RowLabel::Tool => self.vendor.tool.as_ref(),
        };
        row.and_then(|row| row.number(number)).cloned().unwrap_or_default()
    }
}

impl NumberMatch {
    /// The robot's number at the vendor's precision: the vendor's own text where the two agree.
    pub fn printed(&self) -> String {
        match (&self.vendor.written, self.agrees) {
            (Some(written), true) => written.clone(),
            (None, true) => format!("{}", self.vendor.value),
            (_, false) => {
                let places = self.vendor.places().unwrap_or(6).max(6);
                format!("{:.*}", usize::try_from(places).unwrap_or(6), self.robot)
            }
        }
    }
}

impl Match {
    /// Whether every number of the table prints back as the vendor wrote it.
    pub fn prints_back(&self) -> bool {
        self.rows.iter().flat_map(|row| &row.numbers).all(|number| number.agrees)
    }
}
