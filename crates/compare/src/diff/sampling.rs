//! The largest displacement that is found: a low-discrepancy sequence, then ascent from the best of it.

use crate::diff::steps::Way;
use crate::mechanism::Interval;

/// Joint values where a tip is displaced most, and by how much, m.
#[derive(Debug, Clone)]
pub(crate) struct Largest {
    pub q: Vec<f64>,
    pub displacement: f64,
}

/// The sequence of additive recurrences with the powers of the d-th generalised golden ratio.
///
/// # Source
/// M. Roberts 2018, "The unreasonable effectiveness of quasirandom sequences" (R_d).
pub(crate) struct LowDiscrepancy {
    steps: Vec<f64>,
    starts: Vec<f64>,
}

impl LowDiscrepancy {
    pub fn new(dimensions: usize, seed: u64) -> Self {
        let mut golden = 2.0f64;
        for _ in 0..60 {
            golden = (1.0 + golden).powf(1.0 / (dimensions as f64 + 1.0));
        }
        let steps: Vec<f64> = (1..=dimensions).map(|k| golden.powf(-(k as f64)).fract()).collect();
        let mut state = seed;
        let starts = (0..dimensions).map(|_| unit_interval(&mut state)).collect();
        Self { steps, starts }
    }

    /// Coordinate `k` of point `n`, in \[0, 1).
    pub fn at(&self, n: usize, k: usize) -> f64 {
        (self.starts[k] + self.steps[k] * n as f64).fract()
    }
}

/// A number in \[0, 1) from a counter (splitmix64).
fn unit_interval(state: &mut u64) -> f64 {
    *state = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
    let mut z = *state;
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
}

/// Starts of the ascent.
const STARTS: usize = 3;
/// Displacements this close, relative, are the same.
const ALIKE: f64 = 1e-9;
/// Rounds over all coordinates; each ends early when nothing is gained.
const ROUNDS: usize = 12;

/// The largest displacement over the intervals; `zero` (every coordinate at 0 or at the nearest limit) is looked at first.
pub(crate) fn largest(way: &Way, intervals: &[Interval], samples: usize, seed: u64) -> Largest {
    let zero: Vec<f64> = intervals.iter().map(|i| 0.0f64.clamp(i.lower, i.upper)).collect();
    let used = way.coordinates();
    let at_zero = Largest { displacement: way.displacement(&zero), q: zero.clone() };
    let mut best = vec![at_zero.clone()];
    let sequence = LowDiscrepancy::new(used.len(), seed);
    let mut q = zero;
    let count = if used.is_empty() { 0 } else { samples };
    for n in 0..count {
        for (k, coordinate) in used.iter().enumerate() {
            let interval = &intervals[*coordinate];
            q[*coordinate] = interval.lower + sequence.at(n, k) * (interval.upper - interval.lower);
        }
        let displacement = way.displacement(&q);
        if best.len() < STARTS || best.last().is_some_and(|last| displacement > last.displacement) {
            let place = best.partition_point(|known| known.displacement >= displacement);
            best.insert(place, Largest { q: q.clone(), displacement });
            best.truncate(STARTS);
        }
    }
    let climbed = best.into_iter().map(|start| climb(way, intervals, &used, start));
    let larger = |one: Largest, other: Largest| if other.displacement > one.displacement { other } else { one };
    let found = climbed.fold(at_zero.clone(), larger);
    // Where the displacement is the same everywhere, rounding would choose the place.
    if at_zero.displacement >= found.displacement * (1.0 - ALIKE) { at_zero } else { found }
}

/// Coordinate by coordinate to the best value on the whole interval, until nothing is gained.
fn climb(way: &Way, intervals: &[Interval], used: &[usize], mut at: Largest) -> Largest {
    for _ in 0..ROUNDS {
        let before = at.displacement;
        for coordinate in used {
            improve(way, &intervals[*coordinate], *coordinate, &mut at);
        }
        if at.displacement <= before * (1.0 + 1e-9) {
            break;
        }
    }
    at
}

/// The best of a grid on the interval, then golden section beside it.
fn improve(way: &Way, interval: &Interval, coordinate: usize, at: &mut Largest) {
    const GRID: usize = 8;
    const SECTIONS: usize = 24;
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    let width = interval.upper - interval.lower;
    if width <= 0.0 {
        return;
    }
    let mut q = at.q.clone();
    let mut value = |x: f64| {
        q[coordinate] = x;
        way.displacement(&q)
    };
    let (mut best_x, mut best) = (at.q[coordinate], at.displacement);
    for k in 0..=GRID {
        let x = interval.lower + width * k as f64 / GRID as f64;
        let found = value(x);
        if found > best {
            (best_x, best) = (x, found);
        }
    }
    let reach = width / GRID as f64;
    let (mut lower, mut upper) = ((best_x - reach).max(interval.lower), (best_x + reach).min(interval.upper));
    for _ in 0..SECTIONS {
        let (x, y) = (upper - GOLDEN * (upper - lower), lower + GOLDEN * (upper - lower));
        let (at_x, at_y) = (value(x), value(y));
        for (place, found) in [(x, at_x), (y, at_y)] {
            if found > best {
                (best_x, best) = (place, found);
            }
        }
        if at_x > at_y {
            upper = y;
        } else {
            lower = x;
        }
    }
    at.q[coordinate] = best_x;
    at.displacement = best;
}
