//! How far the instrument's clock is ahead of the robot's: what moves together moves at the same time.
//!
//! Each sender's stamps are first compared with when its messages were recorded, which tells the clocks to some tens of
//! milliseconds. What is left is the shift at which the joints' speed and the target's go together best.

use crate::tracks::Track;

/// Largest shift that is looked for after the first comparison, s.
const MOST_SHIFT: f64 = 2.0;
/// Steps of the grid on which speeds are compared, s: no finer than the messages come, within these.
const STEPS: [f64; 2] = [5e-3, 5e-2];
/// Speeds are means over this long, s.
const WINDOW: f64 = 0.1;

/// Longer recordings have a stamp that is wrong, s: a fortnight.
const LONGEST: f64 = 1.2e6;

/// What the two clocks say of each other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Clocks {
    /// What to take from the target's stamps to have the joints' clock, s.
    pub ahead: f64,
    /// Of the speeds, at this shift.
    pub correlation: f64,
}

/// Compares the clocks; `None` where one of the two never moves or they were not recorded at the same time.
pub(crate) fn clocks(joints: &Track, target: &Track) -> Option<Clocks> {
    let rough = ahead_of_recorder(target) - ahead_of_recorder(joints);
    let in_joints_time: Vec<f64> = target.stamps.iter().map(|stamp| stamp - rough).collect();
    let start = joints.stamps.first()?.max(*in_joints_time.first()?);
    let end = joints.stamps.last()?.min(*in_joints_time.last()?);
    let step = period(&joints.stamps).max(period(&in_joints_time)).clamp(STEPS[0], STEPS[1]);
    if !(4.0 * MOST_SHIFT..LONGEST).contains(&(end - start)) {
        return None;
    }
    let [count, window, lags] = [end - start, WINDOW, MOST_SHIFT].map(|length| steps(length, step));
    let width = joints.values.first()?.len();
    let a = speeds(&joints.stamps, &joints.values, width, [start, step], count, window);
    let b = speeds(&in_joints_time, &target.values, 3, [start, step], count, window);
    let of = |at: usize| correlation(&a[lags.saturating_sub(at)..], &b[at.saturating_sub(lags)..]);
    let found: Vec<f64> = (0..=2 * lags).map(of).collect();
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
    let mut on_grid = Vec::with_capacity(count + window);
    for k in 0..count + window {
        let time = start + (k as f64 - 0.5 * window as f64) * step;
        while at + 2 < stamps.len() && stamps[at + 1] <= time {
            at += 1;
        }
        let next = (at + 1).min(stamps.len() - 1);
        let apart = stamps[next] - stamps[at];
        let share = if apart > 0.0 { ((time - stamps[at]) / apart).clamp(0.0, 1.0) } else { 0.0 };
        let value = |column: usize| values[at][column] * (1.0 - share) + values[next][column] * share;
        on_grid.push((0..width).map(value).collect::<Vec<f64>>());
    }
    let speed = |k: usize| {
        let square: f64 =
            on_grid[k + window].iter().zip(&on_grid[k]).map(|(after, before)| (after - before).powi(2)).sum();
        square.sqrt().sqrt()
    };
    (0..count).map(speed).collect()
}

/// Of two rows of numbers, as far as both go.
fn correlation(a: &[f64], b: &[f64]) -> f64 {
    let both = a.len().min(b.len());
    let (a, b, count) = (&a[..both], &b[..both], both as f64);
    let (mean_a, mean_b) = (a.iter().sum::<f64>() / count, b.iter().sum::<f64>() / count);
    let (mut both, mut own_a, mut own_b) = (0.0, 0.0, 0.0);
    for (x, y) in a.iter().zip(b) {
        both += (x - mean_a) * (y - mean_b);
        own_a += (x - mean_a).powi(2);
        own_b += (y - mean_b).powi(2);
    }
    both / (own_a * own_b).sqrt()
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
        // What never moves tells no time.
        let (joints, target) = tracks(0.0, |_| 0.0);
        assert_eq!(clocks(&joints, &target), None);
    }
}
