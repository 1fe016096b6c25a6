//! The history of one number of one robot: steady, drift or step, and when it leaves its tolerance.

use statrs::distribution::{ContinuousCDF as _, StudentsT};

/// A number at one night.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// Days from an arbitrary day.
    pub day: f64,
    /// The number.
    pub value: f64,
    /// Whether something happened before this night.
    pub event: bool,
}

/// The shape of a history.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Shape {
    /// It scatters about its mean.
    Steady,
    /// It changes with time.
    Drift(Drift),
    /// It changed between two nights.
    Step(Step),
}

/// A change with time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drift {
    /// Per week, in the number's unit.
    pub per_week: f64,
    /// Half the 95 % interval of that.
    pub half_interval_95: f64,
    /// The line at the last night.
    pub now: f64,
}

/// A change between two nights.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Step {
    /// Day of the first night after it.
    pub day: f64,
    /// By how much.
    pub size: f64,
    /// Half the 95 % interval of that.
    pub half_interval_95: f64,
    /// Whether something is on record before that night.
    pub event: bool,
}

/// When a drift leaves a tolerance, days; `None`: not in the next ten years.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Crossing {
    /// When the line does.
    pub day: f64,
    /// When the upper 95 % limit of the line does.
    pub earliest: f64,
    /// When the lower one does; `None`: perhaps never.
    pub latest: Option<f64>,
}

/// Significance level of a change, corrected for all nights at which it may have been: each robot has some thirty
/// numbers, and there are thousands of robots.
const BY_CHANCE: f64 = 1e-5;
/// Horizon of the prediction.
const HORIZON: f64 = 3653.0;
/// Minimum number of nights of a history.
pub const LEAST_NIGHTS: usize = 6;

struct Line {
    mean_day: f64,
    mean: f64,
    slope: f64,
    /// Σ (day - mean)².
    spread: f64,
    /// Residual sum of squares.
    left: f64,
    count: f64,
}

impl Line {
    fn of(points: &[Point]) -> Self {
        let count = points.len() as f64;
        let mean_day = points.iter().map(|point| point.day).sum::<f64>() / count;
        let mean = points.iter().map(|point| point.value).sum::<f64>() / count;
        let spread: f64 = points.iter().map(|point| (point.day - mean_day).powi(2)).sum();
        let product: f64 = points.iter().map(|point| (point.day - mean_day) * (point.value - mean)).sum();
        let slope = if spread > 0.0 { product / spread } else { 0.0 };
        let left = points.iter().map(|point| (point.value - mean - slope * (point.day - mean_day)).powi(2)).sum();
        Self { mean_day, mean, slope, spread, left, count }
    }

    fn at(&self, day: f64) -> f64 {
        self.mean + self.slope * (day - self.mean_day)
    }

    /// Half the 95 % interval of the line at a day.
    fn half(&self, day: f64) -> f64 {
        let variance = self.left / (self.count - 2.0);
        let lever = 1.0 / self.count + (day - self.mean_day).powi(2) / self.spread.max(f64::MIN_POSITIVE);
        student(self.count - 2.0) * (variance * lever).sqrt()
    }
}

fn student(freedom: f64) -> f64 {
    StudentsT::new(0.0, 1.0, freedom.max(1.0)).expect("a positive number").inverse_cdf(0.975)
}

fn squares(points: &[Point]) -> f64 {
    let mean = points.iter().map(|point| point.value).sum::<f64>() / points.len() as f64;
    points.iter().map(|point| (point.value - mean).powi(2)).sum()
}

/// Classifies a history of at least six nights by Student's tests of a line and of a step at any night: the more significant
/// of the two, if significant. The p-value of a step is multiplied by the number of nights tried, unless an event is on
/// record before it. Fewer nights count as steady.
pub fn shape(points: &[Point]) -> Shape {
    let count = points.len();
    if count < LEAST_NIGHTS {
        return Shape::Steady;
    }
    let n = count as f64;
    let constant = squares(points);
    // The digits of a number without scatter have no information.
    if constant <= 0.0 {
        return Shape::Steady;
    }
    let freedom = StudentsT::new(0.0, 1.0, n - 2.0).expect("six nights");
    // Of what a change leaves: its squares over what it explains, two-sided.
    let by_chance = |left: f64| {
        let left = left.max(constant * 1e-12);
        2.0 * freedom.sf(((constant - left).max(0.0) / left * (n - 2.0)).sqrt())
    };
    let line = Line::of(points);
    let drift = by_chance(line.left);
    let tried = (count - 3) as f64;
    let steps = (2..=count - 2).map(|at| {
        let left = squares(&points[..at]) + squares(&points[at..]);
        (by_chance(left) * if points[at].event { 1.0 } else { tried }, at, left)
    });
    let (stepped, at, left) = steps.min_by(|a, b| a.0.total_cmp(&b.0)).expect("six nights have a middle");
    if drift.min(stepped) > BY_CHANCE {
        return Shape::Steady;
    }
    if drift <= stepped {
        let half = student(n - 2.0) * (line.left / (n - 2.0) / line.spread.max(f64::MIN_POSITIVE)).sqrt();
        let now = line.at(points[count - 1].day);
        return Shape::Drift(Drift { per_week: 7.0 * line.slope, half_interval_95: 7.0 * half, now });
    }
    let mean = |points: &[Point]| points.iter().map(|point| point.value).sum::<f64>() / points.len() as f64;
    let (before, after) = points.split_at(at);
    let spread = (left / (n - 2.0) * (1.0 / before.len() as f64 + 1.0 / after.len() as f64)).sqrt();
    Shape::Step(Step {
        day: points[at].day,
        size: mean(after) - mean(before),
        half_interval_95: student(n - 2.0) * spread,
        event: points[at].event,
    })
}

/// When the line of a history leaves ±`tolerance`, as seen from its last night.
pub fn crossing(points: &[Point], tolerance: f64) -> Option<Crossing> {
    if points.len() < LEAST_NIGHTS {
        return None;
    }
    let line = Line::of(points);
    let last = points[points.len() - 1].day;
    let side = line.slope.signum();
    let first = |of: &dyn Fn(f64) -> f64| {
        // The band is convex in time: from the last night on it is crossed once at most.
        if of(last) >= tolerance {
            return Some(last);
        }
        let (mut low, mut high) = (last, last + HORIZON);
        if of(high) < tolerance {
            return None;
        }
        for _ in 0..60 {
            let middle = f64::midpoint(low, high);
            if of(middle) < tolerance { low = middle } else { high = middle }
        }
        Some(high)
    };
    let day = first(&|day| side * line.at(day))?;
    let earliest = first(&|day| side * line.at(day) + line.half(day))?;
    Some(Crossing { day, earliest, latest: first(&|day| side * line.at(day) - line.half(day)) })
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt as _, SeedableRng as _};
    use rand_distr::StandardNormal;

    fn history(seed: u64, nights: usize, of: impl Fn(f64) -> f64) -> Vec<Point> {
        let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(seed);
        let point = |night: usize| {
            let noise: f64 = random.sample(StandardNormal);
            Point { day: night as f64, value: of(night as f64) + noise, event: false }
        };
        (0..nights).map(point).collect()
    }

    #[test]
    fn what_was_put_in_comes_out() {
        let seeds = 300;
        let count = |of: &dyn Fn(f64) -> f64, is: &dyn Fn(Shape) -> bool| {
            (0..seeds).filter(|seed| is(shape(&history(*seed, 30, of)))).count()
        };
        assert!(count(&|_| 0.0, &|found| found == Shape::Steady) >= 299, "steady histories are called so");
        let drift = |found| matches!(found, Shape::Drift(drift) if (drift.per_week - 1.4).abs() < 0.7);
        assert!(count(&|day| 0.2 * day, &drift) > 285);
        let step = |found| matches!(found, Shape::Step(step) if (step.day - 18.0).abs() <= 1.0);
        assert!(count(&|day| if day >= 18.0 { 4.0 } else { 0.0 }, &step) > 285);
    }

    #[test]
    fn the_slope_s_interval_and_the_crossing_s_band_hold_95_percent() {
        let (mut held, mut crossed) = (0, 0);
        for seed in 0..400 {
            let points = history(seed, 30, |day| 0.3 * day);
            let Shape::Drift(found) = shape(&points) else { continue };
            held += usize::from((found.per_week - 2.1).abs() <= found.half_interval_95);
            let when = crossing(&points, 15.0).expect("it drifts");
            crossed += usize::from(when.earliest <= 50.0 && when.latest.is_none_or(|latest| latest >= 50.0));
        }
        assert!((368..=392).contains(&held) && (368..=396).contains(&crossed), "{held} {crossed}");
    }
}
