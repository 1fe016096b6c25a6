//! How far the instrument's clock is ahead of the robot's, found from motions that happen at the same time.
//!
//! Each sender's stamps are first compared with the recording times, which gives the offset to some tens of
//! milliseconds. The rest is the shift at which the speeds of the joints and of the target correlate best.

use crate::tracks::Track;

/// Largest shift searched after the first comparison, s.
const MOST_SHIFT: f64 = 2.0;
/// Steps of the grid on which speeds are compared, s: no finer than the messages come, within these.
const STEPS: [f64; 2] = [5e-3, 5e-2];
/// Speeds are means over this long, s.
const WINDOW: f64 = 0.1;

/// Longer without a message is a pause, s, and this many times the usual time between messages.
const PAUSE: f64 = 60.0;
const PERIODS_OF_A_PAUSE: f64 = 20.0;
/// No more steps than this are compared: a longer recording is compared in longer steps.
const MOST_STEPS: f64 = 1e7;

/// The result of comparing the two clocks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Clocks {
    /// Subtract this from the target's stamps to get the joints' clock, s.
    pub ahead: f64,
    /// Correlation of the speeds at this shift.
    pub correlation: f64,
}

/// Compares the clocks; `None` where one of the two never moves or they were not recorded at the same time.
///
/// Speeds are compared where both send: a pause costs no time and no memory.
pub(crate) fn clocks(joints: &Track, target: &Track) -> Option<Clocks> {
    let rough = ahead_of_recorder(target) - ahead_of_recorder(joints);
    let in_joints_time: Vec<f64> = target.stamps.iter().map(|stamp| stamp - rough).collect();
    let periods = [period(&joints.stamps), period(&in_joints_time)];
    let both = common(&stretches(&joints.stamps, periods[0]), &stretches(&in_joints_time, periods[1]));
    let long: Vec<[f64; 2]> = both.into_iter().filter(|[from, to]| to - from >= 4.0 * MOST_SHIFT).collect();
    let total: f64 = long.iter().map(|[from, to]| to - from).sum();
    let step = periods[0].max(periods[1]).clamp(STEPS[0], STEPS[1]).max(total / MOST_STEPS);
    let [window, lags] = [WINDOW, MOST_SHIFT].map(|length| steps(length, step));
    let width = joints.values.first()?.len();
    let mut sums = vec![Sums::default(); 2 * lags + 1];
    for [start, end] in long {
        let count = steps(end - start, step);
        let a = speeds(&joints.stamps, &joints.values, width, [start, step], count, window);
        let b = speeds(&in_joints_time, &target.values, 3, [start, step], count, window);
        for (at, sums) in sums.iter_mut().enumerate() {
            sums.add(&a[lags.saturating_sub(at).min(count)..], &b[at.saturating_sub(lags).min(count)..]);
        }
    }
    let found: Vec<f64> = sums.iter().map(Sums::correlation).collect();
    let best = (0..found.len()).filter(|&at| found[at].is_finite()).max_by(|&p, &q| found[p].total_cmp(&found[q]))?;
    // The top of the parabola through three values.
    let around = |at: usize| found.get(at).copied().filter(|value| value.is_finite());
    let between = match (best.checked_sub(1).and_then(around), around(best + 1)) {
        (Some(left), Some(right)) if left + right < 2.0 * found[best] => {
            0.5 * (left - right) / (left - 2.0 * found[best] + right)
        }
        _ => 0.0,
    };
    let shift = (best as f64 - lags as f64 + between) * step;
    Some(Clocks { ahead: rough + shift, correlation: found[best] })
}

/// Where messages come without a pause: from, to, s.
fn stretches(stamps: &[f64], period: f64) -> Vec<[f64; 2]> {
    let pause = PAUSE.max(PERIODS_OF_A_PAUSE * period);
    let mut found: Vec<[f64; 2]> = Vec::new();
    for &stamp in stamps {
        match found.last_mut() {
            Some([_, to]) if stamp - *to <= pause => *to = stamp,
            _ => found.push([stamp, stamp]),
        }
    }
    found
}

/// The intersection of two ordered lists of intervals.
fn common(a: &[[f64; 2]], b: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let (mut i, mut k, mut found) = (0, 0, Vec::new());
    while i < a.len() && k < b.len() {
        let (from, to) = (a[i][0].max(b[k][0]), a[i][1].min(b[k][1]));
        if to > from {
            found.push([from, to]);
        }
        if a[i][1] < b[k][1] { i += 1 } else { k += 1 }
    }
    found
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "some millions at most, none below 0")]
fn steps(length: f64, step: f64) -> usize {
    (length / step).ceil() as usize
}

/// Median of stamps less the recorder's clock, s: stamp and delay of the message together.
fn ahead_of_recorder(track: &Track) -> f64 {
    median(track.stamps.iter().zip(&track.logged).map(|(stamp, logged)| stamp - logged).collect())
}

/// The usual time between stamps, s.
pub(crate) fn period(stamps: &[f64]) -> f64 {
    median(stamps.windows(2).map(|pair| pair[1] - pair[0]).collect())
}

pub(crate) fn median(mut values: Vec<f64>) -> f64 {
    if values.is_empty() {
        return 0.0;
    }
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// Root of the speed at the steps of a grid: starts and stops count for more than what is between them.
fn speeds(
    stamps: &[f64],
    values: &[Vec<f64>],
    width: usize,
    [start, step]: [f64; 2],
    count: usize,
    window: usize,
) -> Vec<f64> {
    let mut at = 0;
    // The last `window` places are kept.
    let mut places = vec![0.0; window * width];
    let mut speeds = Vec::with_capacity(count);
    for k in 0..count + window {
        let time = start + (k as f64 - 0.5 * window as f64) * step;
        while at + 2 < stamps.len() && stamps[at + 1] <= time {
            at += 1;
        }
        let next = (at + 1).min(stamps.len() - 1);
        let apart = stamps[next] - stamps[at];
        let share = if apart > 0.0 { ((time - stamps[at]) / apart).clamp(0.0, 1.0) } else { 0.0 };
        let first = (k % window) * width;
        let mut square = 0.0;
        for (column, place) in places[first..first + width].iter_mut().enumerate() {
            let value = values[at][column] * (1.0 - share) + values[next][column] * share;
            square += (value - *place).powi(2);
            *place = value;
        }
        if k >= window {
            speeds.push(square.sqrt().sqrt());
        }
    }
    speeds
}

/// Of pairs of numbers, for their correlation.
#[derive(Debug, Clone, Copy, Default)]
struct Sums {
    count: f64,
    mean: [f64; 2],
    /// Of squares and of products, about the means.
    squares: [f64; 2],
    products: f64,
}

impl Sums {
    /// Two rows of numbers, as far as both go (Chan, Golub, LeVeque 1983).
    fn add(&mut self, a: &[f64], b: &[f64]) {
        let both = a.len().min(b.len());
        if both == 0 {
            return;
        }
        let (a, b, own) = (&a[..both], &b[..both], both as f64);
        let mean = [a.iter().sum::<f64>() / own, b.iter().sum::<f64>() / own];
        let count = self.count + own;
        let off = [mean[0] - self.mean[0], mean[1] - self.mean[1]];
        let share = self.count * own / count;
        for (x, y) in a.iter().zip(b) {
            self.products += (x - mean[0]) * (y - mean[1]);
            self.squares[0] += (x - mean[0]).powi(2);
            self.squares[1] += (y - mean[1]).powi(2);
        }
        self.products += share * off[0] * off[1];
        for (k, off) in off.into_iter().enumerate() {
            self.squares[k] += share * off.powi(2);
            self.mean[k] += off * own / count;
        }
        self.count = count;
    }

    fn correlation(&self) -> f64 {
        self.products / (self.squares[0] * self.squares[1]).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    /// Two joints and a target that follows them, seen `ahead` seconds later by its own clock.
    fn tracks(ahead: f64, moves: impl Fn(f64) -> f64) -> (Track, Track) {
        let (mut joints, mut target) = (Track::default(), Track::default());
        for k in 0..6000 {
            let time = 1e9 + 0.01 * f64::from(k);
            let q = moves(time - 1e9);
            joints.stamps.push(time);
            joints.logged.push(time + 0.002);
            joints.values.push(vec![q, 0.5 * q]);
        }
        for k in 0..3600 {
            let time = 1e9 + 0.0123 + f64::from(k) / 60.0;
            let q = moves(time - 1e9);
            target.stamps.push(time + ahead);
            target.logged.push(time + 0.04);
            target.values.push(vec![q.cos(), q.sin(), 0.1 * q]);
        }
        (joints, target)
    }

    #[test]
    fn a_clock_is_found_by_what_moves() {
        let moves = |time: f64| (TAU * time / 7.0).sin() + 0.4 * (TAU * time / 2.3).sin();
        for ahead in [0.0, -3.2, 1234.5678] {
            let (joints, target) = tracks(ahead, moves);
            let found = clocks(&joints, &target).unwrap();
            assert!((found.ahead - ahead).abs() < 3e-3 && found.correlation > 0.9, "{ahead}: {found:?}");
        }
        // A pause of a month in the middle is neither sampled nor mistaken for a standstill of the clocks.
        let (mut joints, mut target) = tracks(0.4, moves);
        for track in [&mut joints, &mut target] {
            let half = track.stamps.len() / 2;
            for k in half..track.stamps.len() {
                track.stamps[k] += 2.6e6;
                track.logged[k] += 2.6e6;
            }
        }
        let begun = std::time::Instant::now();
        let found = clocks(&joints, &target).unwrap();
        assert!((found.ahead - 0.4).abs() < 3e-3 && found.correlation > 0.9, "{found:?}");
        assert!(begun.elapsed().as_secs() < 20);
        // What never moves tells no time.
        let (joints, target) = tracks(0.0, |_| 0.0);
        assert_eq!(clocks(&joints, &target), None);
    }
}
