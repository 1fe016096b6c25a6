//! Detects lasting changes by medians: of some nights, and of as many before them, each compared with the reference median.
//!
//! One bad night hardly moves a median, and the median of five nights with Student's tails of 4 degrees of freedom has
//! nearly normal tails. Both medians must deviate to the same side, so each needs a smaller deviation than a single median
//! among thousands of robots. The scatter of the difference of two medians is learned from the fleet, like that of a night.

use super::median;
use super::vigil::{Night, Nights, Scatters, Watch};
use statrs::distribution::{Continuous as _, ContinuousCDF as _, Normal};

/// One robot's two medians, for its most significant number.
pub(super) struct Test {
    pub number: usize,
    /// Median of the last nights minus that of the reference.
    pub change: f64,
    /// The same in units of a night's scatter.
    pub sigmas: f64,
    /// The larger p-value of the two, for this number alone.
    pub p_value: f64,
    /// Day of the first of the nights.
    pub since: i32,
}

/// Deviations of medians from the median of the nights just before them, over the fleet: each night counts once.
pub(super) fn deviations(robots: &[Nights], number: usize, how: &Watch) -> Vec<f64> {
    let mut deviations = Vec::new();
    for robot in robots {
        for quiet in robot.nights.chunk_by(|_, next| !next.event) {
            let values: Vec<f64> = quiet.iter().filter_map(|night| *night.values.get(number)?).collect();
            let windows = values.windows(how.reference + how.lasting).step_by(how.lasting);
            deviations.extend(windows.map(|window| {
                let (before, last) = window.split_at(how.reference);
                middle(last) - middle(before)
            }));
        }
    }
    deviations
}

fn middle(values: &[f64]) -> f64 {
    median(&mut values.to_vec())
}

/// The test of the last nights after a reference; `None` if they are too few.
pub(super) fn test(reference: &[Night], others: &[Night], scatters: &Scatters, how: &Watch) -> Option<Test> {
    let first = others.len().checked_sub(2 * how.lasting)?;
    let (earlier, last) = others[first..].split_at(how.lasting);
    let mut best: Option<Test> = None;
    for (number, scatters) in scatters.medians.iter().zip(&scatters.nights).enumerate() {
        let (Some(scatter), Some(of_night)) = scatters else { continue };
        let of = |nights: &[Night]| {
            let values: Option<Vec<f64>> = nights.iter().map(|night| *night.values.get(number)?).collect();
            values.map(|values| middle(&values))
        };
        let (Some(before), Some(earlier), Some(last)) = (of(reference), of(earlier), of(last)) else { continue };
        let (earlier, change) = (earlier - before, last - before);
        if (earlier > 0.0) != (change > 0.0) {
            continue;
        }
        let p_value = scatter.p_value(earlier, 1.0).max(scatter.p_value(change, 1.0));
        if best.as_ref().is_none_or(|best| p_value < best.p_value) {
            let sigmas = change / of_night.scale;
            best = Some(Test { number, change, sigmas, p_value, since: others[first].day });
        }
    }
    best
}

/// The alarm threshold that keeps the false alarms of a healthy fleet of this size below the limit.
pub(super) struct Limit {
    p_value: f64,
    shared: f64,
    /// False alarms per night of a healthy fleet.
    pub expected_false: f64,
}

impl Limit {
    pub fn of(robots: usize, numbers: usize, how: &Watch) -> Self {
        // What two medians have in common is that of the reference.
        let shared = how.lasting as f64 / (how.lasting + how.reference) as f64;
        let tests = (robots * numbers) as f64;
        let expected = |limit: f64| 2.0 * both_beyond(limit, shared, 2) * tests;
        let (mut low, mut high) = (0.0, 8.0);
        for _ in 0..40 {
            let limit = f64::midpoint(low, high);
            if expected(limit) > how.lasting_rate { low = limit } else { high = limit }
        }
        Self { p_value: 2.0 * normal().sf(high), shared, expected_false: expected(high) }
    }

    pub fn is_passed_by(&self, p_value: f64) -> bool {
        p_value <= self.p_value
    }

    /// The p-value of a robot both of whose medians have such a p-value, corrected for all its numbers.
    pub fn p_value(&self, of_each: f64, numbers: usize) -> f64 {
        let limit = -normal().inverse_cdf((0.5 * of_each).max(1e-300));
        (2.0 * both_beyond(limit, self.shared, 2) * numbers as f64).clamp(f64::MIN_POSITIVE, 1.0)
    }
}

fn normal() -> Normal {
    Normal::new(0.0, 1.0).expect("a standard deviation of 1")
}

/// Probability that `count` normal numbers with this shared fraction of variance all exceed a limit on one side: integrated
/// over the shared part.
pub(super) fn both_beyond(limit: f64, shared: f64, count: i32) -> f64 {
    let normal = normal();
    let step = 0.01;
    let at = |index: i32| {
        let common = f64::from(index) * step;
        let beyond = normal.sf((limit - shared.sqrt() * common) / (1.0 - shared).sqrt());
        normal.pdf(common) * beyond.powi(count) * step
    };
    (-800..=800).map(at).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Orthant probability of the bivariate normal distribution (Sheppard 1899): 1/4 + asin(r) / 2π; and without anything shared.
    #[test]
    fn both_beyond_in_cases_that_can_be_written_down() {
        for shared in [0.1, 0.385, 0.8_f64] {
            let asin = shared.atan2((1.0 - shared * shared).sqrt());
            let orthant = 0.25 + asin / std::f64::consts::TAU;
            assert!((both_beyond(0.0, shared, 2) - orthant).abs() < 1e-6, "{shared}");
        }
        let alone = normal().sf(3.0);
        assert!((both_beyond(3.0, 0.0, 2) / alone.powi(2) - 1.0).abs() < 1e-6);
        assert!((both_beyond(3.0, 0.4, 1) / alone - 1.0).abs() < 1e-4);
    }

    #[test]
    fn the_limit_keeps_what_was_asked_for() {
        let how = Watch::default();
        for (robots, numbers) in [(10, 25), (10_000, 25)] {
            let limit = Limit::of(robots, numbers, &how);
            assert!((limit.expected_false / how.lasting_rate - 1.0).abs() < 1e-3);
            assert!(limit.is_passed_by(limit.p_value) && !limit.is_passed_by(1.01 * limit.p_value));
            assert!((limit.p_value(limit.p_value, numbers) * robots as f64 / how.lasting_rate - 1.0).abs() < 0.01);
        }
    }
}
