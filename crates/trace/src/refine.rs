//! Refines the nonlinear parameters of a driver (order, place, width, time constant), which a scan only brackets.

use crate::by_carrier::{ByCarrier, ByRow};
use crate::downdate::Reduced;
use crate::scorer::{CandidateScorer, Scored};
use denavit_identify::effects::candidates::Candidate;
use denavit_identify::effects::driver::{BumpShape, Driver};
use denavit_identify::effects::survey::Survey;
use denavit_measurements::Column;

/// Steps of the golden section: they shrink a bracket to 0.618¹⁶, less than a thousandth of it.
const HALVINGS: usize = 16;
/// Scanned numbers of a bump: place and width.
const BUMP_NUMBERS: usize = 2;
/// How much better another shape of a bump must be.
const OUTLINE: f64 = 6.0;
/// Places that are tried for a piecewise constant function.
const PLACES: i32 = 24;
/// Halvings between two of them, to find the step.
const HALVINGS_OF_A_STEP: usize = 8;
/// The golden section.
const GOLDEN: f64 = 0.618_033_988_749_895;

impl CandidateScorer<'_> {
    /// The candidate with the scanned numbers at which it explains most, scored.
    pub fn refined(&self, model: &Reduced<'_>, survey: &Survey, candidate: &Candidate) -> Scored {
        let by_row = ByRow::new(self.linear, model.model);
        let here = by_row.with(candidate.term.carrier);
        let score = |driver: Driver, scanned: usize| {
            let mut tried = candidate.clone();
            tried.term.driver = driver;
            tried.scanned = scanned;
            self.judged(model, &tried, self.gain_at(&here, model, &tried.term))
        };
        let drop = |driver: Driver| score(driver, candidate.scanned).gain.drop;
        match candidate.term.driver.clone() {
            Driver::Harmonic { joint, order } if survey.motor_orders(joint).contains(&order) => {
                score(Driver::Harmonic { joint, order }, 0)
            }
            Driver::Harmonic { joint, order } => {
                let step = survey.order_step(joint);
                let at = |order: f64| drop(Driver::Harmonic { joint, order });
                let best = highest(at, (order - step).max(0.25 * order), order + step);
                let free = score(Driver::Harmonic { joint, order: best }, 1);
                if survey.slides(joint) {
                    return free;
                }
                let whole = score(Driver::Harmonic { joint, order: best.round().max(1.0) }, 0);
                if whole.delta_bic >= free.delta_bic { whole } else { free }
            }
            Driver::Bump { joint, at, width, shape } => {
                let bump = |at: f64, width: f64, shape: BumpShape| Driver::Bump { joint, at, width, shape };
                let (mut at, mut width) = (at, width);
                let moved = |at: &mut f64, width: &mut f64, shape: BumpShape, reach: f64| {
                    *at = highest(|at| drop(bump(at, *width, shape)), *at - reach * *width, *at + reach * *width);
                    let (low, high) = ((0.5 * *width).ln(), (2.0 * *width).ln());
                    let log = highest(|log: f64| drop(bump(*at, log.exp(), shape)), low, high);
                    *width = log.exp().clamp(0.005 * survey.span(joint), 0.2 * survey.span(joint));
                };
                for reach in [1.2, 0.5, 0.5] {
                    moved(&mut at, &mut width, shape, reach);
                }
                let own = score(bump(at, width, shape), BUMP_NUMBERS);
                let others = BumpShape::ALL.into_iter().filter(|other| *other != shape).map(|other| {
                    let (mut at, mut width) = (at, width);
                    moved(&mut at, &mut width, other, 0.5);
                    score(bump(at, width, other), BUMP_NUMBERS)
                });
                // The shape is not counted as a parameter: only a clearly better one replaces it.
                others.fold(own, |best, other| if other.delta_bic > best.delta_bic + OUTLINE { other } else { best })
            }
            Driver::HardeningTorque { joint, knee } => {
                let at = |log: f64| drop(Driver::HardeningTorque { joint, knee: log.exp() });
                let log = highest(at, (0.2 * knee).ln(), (5.0 * knee).ln());
                score(Driver::HardeningTorque { joint, knee: log.exp() }, 1)
            }
            Driver::FrictionSide { side, friction } => {
                let with = |friction: f64| Driver::FrictionSide { side: side.clone(), friction };
                let friction = best_stretch(|friction| drop(with(friction)), 0.6 * friction, 1.4 * friction);
                score(with(friction), 1)
            }
            Driver::Decay { covariate, from, constant } => {
                let at = |log: f64| drop(Driver::Decay { covariate: covariate.clone(), from, constant: log.exp() });
                let log = highest(at, (0.3 * constant).ln(), (3.0 * constant).ln());
                score(Driver::Decay { covariate: covariate.clone(), from, constant: log.exp() }, 1)
            }
            Driver::Steps { covariate, at } => {
                let mut at = at;
                let places =
                    survey.clock.as_ref().map(denavit_identify::effects::survey::Clock::all_places).unwrap_or_default();
                for k in 0..at.len() {
                    at[k] = self.best_place((&here, model), candidate, &covariate, &at, k, &places);
                }
                at.sort_by(f64::total_cmp);
                let with =
                    |at: &[f64]| score(Driver::Steps { covariate: covariate.clone(), at: at.to_vec() }, at.len());
                let mut best = with(&at);
                // A step that replaced one elsewhere is dropped once that one is found.
                while at.len() > 1 {
                    let fewer = (0..at.len()).map(|out| [&at[..out], &at[out + 1..]].concat());
                    let tried = fewer.map(|at| (with(&at), at)).max_by(|a, b| a.0.delta_bic.total_cmp(&b.0.delta_bic));
                    let Some((fewer, places)) = tried.filter(|(fewer, _)| fewer.delta_bic > best.delta_bic) else {
                        break;
                    };
                    (best, at) = (fewer, places);
                }
                best
            }
            driver => score(driver, candidate.scanned),
        }
    }

    /// The place at which step `k` explains most, within a stretch of the run around it.
    fn best_place(
        &self,
        (carrier, model): (&ByCarrier<'_>, &Reduced<'_>),
        candidate: &Candidate,
        covariate: &Column,
        at: &[f64],
        k: usize,
        places: &[f64],
    ) -> f64 {
        let here = places.partition_point(|place| *place < at[k]);
        let reach = (places.len() / 40).clamp(6, 40);
        let near = &places[here.saturating_sub(reach)..(here + reach).min(places.len())];
        let mut best = (f64::NEG_INFINITY, at[k]);
        for &place in near {
            if at.iter().enumerate().any(|(other, taken)| other != k && *taken == place) {
                continue;
            }
            let mut tried = candidate.term.clone();
            let mut moved = at.to_vec();
            moved[k] = place;
            tried.driver = Driver::Steps { covariate: covariate.clone(), at: moved };
            let drop = self.gain_at(carrier, model, &tried).drop;
            if drop > best.0 {
                best = (drop, place);
            }
        }
        best.1
    }
}

/// The maximum of a unimodal function in an interval, by golden section.
fn highest(f: impl Fn(f64) -> f64, low: f64, high: f64) -> f64 {
    let (mut low, mut high) = (low, high);
    let (mut left, mut right) = (high - GOLDEN * (high - low), low + GOLDEN * (high - low));
    let (mut f_left, mut f_right) = (f(left), f(right));
    for _ in 0..HALVINGS {
        if f_left >= f_right {
            (high, right, f_right) = (right, left, f_left);
            left = high - GOLDEN * (high - low);
            f_left = f(left);
        } else {
            (low, left, f_left) = (left, right, f_right);
            right = low + GOLDEN * (high - low);
            f_right = f(right);
        }
    }
    0.5 * (low + high)
}

/// The maximum of a piecewise constant function: the middle of its highest piece.
fn best_stretch(f: impl Fn(f64) -> f64, low: f64, high: f64) -> f64 {
    let step = (high - low) / f64::from(PLACES);
    let tried: Vec<(f64, f64)> = (0..=PLACES).map(|k| low + step * f64::from(k)).map(|at| (at, f(at))).collect();
    let (_, top) =
        tried.iter().copied().fold((low, f64::NEG_INFINITY), |best, one| if one.1 > best.1 { one } else { best });
    let mut best = tried.iter().skip_while(|(_, value)| *value < top).take_while(|(_, value)| *value >= top);
    let first = best.next().map_or(low, |(at, _)| *at);
    let last = best.last().map_or(first, |(at, _)| *at);
    let end = |inside: f64, outside: f64| {
        let (mut inside, mut outside) = (inside, outside);
        for _ in 0..HALVINGS_OF_A_STEP {
            let middle = 0.5 * (inside + outside);
            if f(middle) >= top { inside = middle } else { outside = middle }
        }
        inside
    };
    0.5 * (end(first, first - step) + end(last, last + step))
}

#[cfg(test)]
mod tests {
    use super::{best_stretch, highest};

    #[test]
    fn the_middle_of_the_highest_stretch_is_found() {
        let f = |x: f64| if (0.33..0.87).contains(&x) { 1.0 } else { 0.0 };
        let found = best_stretch(f, 0.0, 2.4);
        assert!((found - 0.6).abs() < 1e-3, "{found}");
        // Wherever one begins.
        assert!((best_stretch(f, 0.1, 1.0) - found).abs() < 1e-3);
    }

    #[test]
    fn the_highest_point_is_found() {
        let found = highest(|x| -(x - 0.3) * (x - 0.3), -1.0, 2.0);
        assert!((found - 0.3).abs() < 2e-3, "{found}");
    }
}
