//! Search for the largest displacement: a low-discrepancy sequence, then ascent from its best points.

use crate::diff::steps::TipPath;
use crate::mechanism::Interval;
use denavit_model::CompiledChain;
use denavit_model::nalgebra::Point3;

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
/// Configurations that are computed at once.
const BATCH: usize = 1024;
/// Displacements this close, relative, are the same.
const ALIKE: f64 = 1e-9;
/// Maximum number of joint motions for one tip: more than any arm needs, one or two seconds for a chain of thousands
/// of joints, for which fewer configurations are sampled.
const MOTIONS: usize = 40_000_000;
/// Rounds over all coordinates; each ends early when nothing is gained.
const ROUNDS: usize = 12;

/// The largest displacement over the intervals; `zero` (every coordinate at 0 or at the nearest limit) is sampled first.
pub(crate) fn largest(way: &TipPath, intervals: &[Interval], samples: usize, seed: u64) -> Largest {
    let zero: Vec<f64> = intervals.iter().map(|i| 0.0f64.clamp(i.lower, i.upper)).collect();
    let used = way.coordinates();
    let at_zero = Largest { displacement: way.displacement(&zero), q: zero.clone() };
    let configurations = MOTIONS / way.steps.len().max(1);
    let samples = samples.min(configurations / 2);
    let places = if used.is_empty() { Vec::new() } else { sampled(way, intervals, &used, samples, seed) };
    let starts = places.into_iter().map(|start| {
        let mut q = zero.clone();
        for (value, coordinate) in start.iter().zip(&used) {
            q[*coordinate] = *value;
        }
        Largest { displacement: way.displacement(&q), q }
    });
    let mut best: Vec<Largest> = std::iter::once(at_zero.clone()).chain(starts).collect();
    best.sort_by(|one, other| other.displacement.total_cmp(&one.displacement));
    best.truncate(STARTS);
    // Each coordinate of each start gets its share of the remaining budget; if that is too small, only the samples count.
    let tries = configurations / (2 * STARTS) / PER_COORDINATE;
    let climbed = best.into_iter().map(|start| ascend(way, intervals, &used, start, tries));
    let larger = |one: Largest, other: Largest| if other.displacement > one.displacement { other } else { one };
    let found = climbed.fold(at_zero.clone(), larger);
    // Where the displacement is the same everywhere, rounding would choose the place.
    if at_zero.displacement >= found.displacement * (1.0 - ALIKE) { at_zero } else { found }
}

/// The used coordinates' values at the places of the sequence where the tip is displaced most, the largest first.
fn sampled(way: &TipPath, intervals: &[Interval], used: &[usize], samples: usize, seed: u64) -> Vec<Vec<f64>> {
    let sequence = LowDiscrepancy::new(used.len(), seed);
    let ranges: Vec<(f64, f64)> =
        used.iter().map(|coordinate| (intervals[*coordinate].lower, intervals[*coordinate].upper)).collect();
    let mut displacements = Displacements::new(way, used, intervals.len());
    let mut best: Vec<(f64, Vec<f64>)> = Vec::new();
    let mut values = Vec::with_capacity(BATCH * used.len());
    for first in (0..samples).step_by(BATCH) {
        values.clear();
        for n in first..(first + BATCH).min(samples) {
            let place = |(k, (lower, upper)): (usize, &(f64, f64))| lower + sequence.at(n, k) * (upper - lower);
            values.extend(ranges.iter().enumerate().map(place));
        }
        for (displacement, values) in displacements.of(&values).iter().zip(values.chunks_exact(used.len())) {
            if best.len() < STARTS || best.last().is_some_and(|last| *displacement > last.0) {
                let place = best.partition_point(|known| known.0 >= *displacement);
                best.insert(place, (*displacement, values.to_vec()));
                best.truncate(STARTS);
            }
        }
    }
    best.into_iter().map(|(_, values)| values).collect()
}

/// How far apart both tips are at many configurations.
struct Displacements<'a> {
    way: &'a TipPath,
    used: &'a [usize],
    compiled: Option<[CompiledChain; 2]>,
    tips: [Vec<Point3<f64>>; 2],
    q: Vec<f64>,
    found: Vec<f64>,
}

impl<'a> Displacements<'a> {
    fn new(way: &'a TipPath, used: &'a [usize], coordinates: usize) -> Self {
        let compiled = way.compiled(used);
        Self { way, used, compiled, tips: [Vec::new(), Vec::new()], q: vec![0.0; coordinates], found: Vec::new() }
    }

    /// `values`: those of the used coordinates, configuration by configuration. Result: m.
    fn of(&mut self, values: &[f64]) -> &[f64] {
        self.found.clear();
        if let Some(chains) = &self.compiled {
            for (tips, chain) in self.tips.iter_mut().zip(chains) {
                tips.resize(values.len() / self.used.len(), Point3::origin());
                chain.tips_into(values, tips);
            }
            let [one, other] = &self.tips;
            self.found.extend(one.iter().zip(other).map(|(one, other)| (one - other).norm()));
        } else {
            for values in values.chunks_exact(self.used.len()) {
                for (value, coordinate) in values.iter().zip(self.used) {
                    self.q[*coordinate] = *value;
                }
                self.found.push(self.way.displacement(&self.q));
            }
        }
        &self.found
    }
}

/// Coordinate by coordinate to the best value on the whole interval, until nothing is gained.
fn ascend(way: &TipPath, intervals: &[Interval], used: &[usize], mut at: Largest, mut tries: usize) -> Largest {
    for _ in 0..ROUNDS {
        let before = at.displacement;
        for coordinate in used {
            if tries == 0 {
                return at;
            }
            tries -= 1;
            improve(way, &intervals[*coordinate], *coordinate, &mut at);
        }
        if at.displacement <= before * (1.0 + 1e-9) {
            break;
        }
    }
    at
}

/// Configurations that [`improve`] looks at.
const PER_COORDINATE: usize = 57;

/// The best of a grid on the interval, then golden section around it.
fn improve(way: &TipPath, interval: &Interval, coordinate: usize, at: &mut Largest) {
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
