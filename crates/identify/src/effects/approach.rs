//! The side from which a joint approached its position: one rule for measured runs and for commands.
//!
//! A joint that stands still keeps its side. Its readings jitter by the noise of its encoder, so the smallest real move is
//! estimated from the run itself.

/// Smallest move, rad or m: commands have a resolution of a microradian or a micrometre.
pub const LEAST_MOVE: f64 = 1e-6;
/// The jitter of an encoder is below this, rad or m.
const MOST_JITTER: f64 = 1e-3;
/// The smallest real move must be this many times the largest jitter to be distinguished from it.
const GAP: f64 = 30.0;
/// Jitter must make up this fraction of the moves: a few small moves are real moves.
const LEAST_SHARE: f64 = 0.05;

/// The largest change of a reading that is not a move, rad or m: [`LEAST_MOVE`], or more where the readings of a joint that
/// stands still jitter by more.
///
/// There is jitter if the changes from row to row fall into two groups with a gap between them.
pub fn still(readings: &[f64]) -> f64 {
    let mut moves: Vec<f64> =
        readings.windows(2).map(|pair| (pair[1] - pair[0]).abs()).filter(|moved| *moved > LEAST_MOVE).collect();
    moves.sort_by(f64::total_cmp);
    let least = (LEAST_SHARE * moves.len() as f64).max(2.0);
    let gap = (1..moves.len())
        .filter(|&k| k as f64 >= least && moves[k - 1] < MOST_JITTER && moves[k] > GAP * moves[k - 1])
        .max_by(|&a, &b| (moves[a] / moves[a - 1]).total_cmp(&(moves[b] / moves[b - 1])));
    gap.map_or(LEAST_MOVE, |k| (moves[k] * moves[k - 1]).sqrt())
}

/// The side after a move, +1 or -1: a joint that stands still keeps the one it `had` (0: not known yet).
pub fn side_after(moved: f64, still: f64, had: f64) -> f64 {
    if moved.abs() <= still { had } else { moved.signum() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn jitter_is_no_move_and_a_small_move_is_one() {
        // A joint at three positions, read with 20 µrad of jitter.
        let jitter = |k: usize| 2e-5 * ((k * 7919 % 13) as f64 / 6.0 - 1.0);
        let readings: Vec<f64> = (0..60).map(|k| 0.4 * ((k / 5) % 3) as f64 + jitter(k)).collect();
        let still_below = still(&readings);
        assert!(still_below > 5e-5 && still_below < 0.4, "{still_below}");
        let clean: Vec<f64> = (0..60).map(|k| 0.4 * f64::from((k / 5) % 3)).collect();
        let sides = |readings: &[f64]| {
            let below = still(readings);
            let mut side = 0.0;
            readings
                .windows(2)
                .map(|pair| {
                    side = side_after(pair[1] - pair[0], below, side);
                    side
                })
                .collect::<Vec<f64>>()
        };
        assert_eq!(sides(&readings), sides(&clean));
        // Commanded steps of 10 µrad are moves.
        let fine: Vec<f64> = (0..30).map(|k| 1e-5 * f64::from(k)).collect();
        assert_eq!(still(&fine), LEAST_MOVE);
        assert_eq!(side_after(-1e-5, LEAST_MOVE, 1.0), -1.0);
        assert_eq!(side_after(1e-7, LEAST_MOVE, -1.0), -1.0);
    }
}
