//! A joint's history, computed from the order of the rows: one rule for measured runs and for commands.
//!
//! Each is a state that every move updates, and a computed column that drivers use like a recorded one.

use crate::effects::approach::side_after;
use crate::effects::columns::{APPROACH, APPROACH_FROM_ROWS, MEMORIES, WARMTH, WOUND_UP};

/// Time constants of warmth in rows, where no row has a time.
const LAGS_IN_ROWS: [f64; 5] = [10.0, 40.0, 160.0, 640.0, 2560.0];
/// Time constants of warmth, s: from a minute to some hours.
const LAGS_IN_SECONDS: [f64; 5] = [60.0, 240.0, 960.0, 3840.0, 15360.0];

/// A state of a joint, computed from the order of the rows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum History {
    /// The side from which it came, +1 from below.
    Side,
    /// Its wind-up against friction, -1 to +1: each move brings it nearer to the side of the motion by a fraction
    /// 1 - exp(-travel/memory) (Dahl 1968, "A solid friction model", with exponent 1).
    WoundUp {
        /// rad or m.
        memory: f64,
    },
    /// Its warmth by its own work: its travel, by row or by second, through a first-order lag. Friction makes heat in proportion to the
    /// travel, and the joint cools in proportion to its warmth (Newton's law of cooling).
    Warmth {
        /// Time constant, rows or s.
        lag: f64,
        /// Unit of the time constant.
        pace: Pace,
    },
}

/// Unit of a lag.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Pace {
    /// By rows.
    Rows,
    /// By the column `time`, s.
    Seconds,
}

/// A joint's motion from one row to the next.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Move {
    /// rad or m.
    pub moved: f64,
    /// The largest change of a reading that is not a move, rad or m.
    pub still: f64,
    /// Duration, s; none where unknown.
    pub seconds: Option<f64>,
}

impl Pace {
    /// Of one word.
    const fn word(self) -> &'static str {
        match self {
            Self::Rows => "rows",
            Self::Seconds => "s",
        }
    }
}

impl History {
    /// All states, warmth by the clock only where there is a clock.
    pub fn available(clock: bool) -> impl Iterator<Item = Self> {
        Self::all().filter(move |history| clock || !history.needs_a_clock())
    }

    /// All possible states.
    fn all() -> impl Iterator<Item = Self> {
        let wound_up = MEMORIES.into_iter().map(|memory| Self::WoundUp { memory });
        std::iter::once(Self::Side)
            .chain(wound_up)
            .chain(LAGS_IN_ROWS.into_iter().map(|lag| Self::Warmth { lag, pace: Pace::Rows }))
            .chain(LAGS_IN_SECONDS.into_iter().map(|lag| Self::Warmth { lag, pace: Pace::Seconds }))
    }

    /// Whether it needs the column `time`.
    pub const fn needs_a_clock(self) -> bool {
        matches!(self, Self::Warmth { pace: Pace::Seconds, .. })
    }

    /// Whether the last move to a pose determines it, whatever came before.
    pub const fn is_of_the_way(self) -> bool {
        matches!(self, Self::Side | Self::WoundUp { .. })
    }

    /// The ending of its column after the joint's name, where it is computed from the order of the rows.
    pub fn ending(self) -> String {
        match self {
            Self::Side => APPROACH_FROM_ROWS.to_owned(),
            Self::WoundUp { memory } => format!("{WOUND_UP} {memory}"),
            Self::Warmth { lag, pace } => format!("{WARMTH} {lag} {}", pace.word()),
        }
    }

    /// The joint and the state of a column that is computed from the order of the rows.
    pub fn of_column(name: &str) -> Option<(&str, Self)> {
        if let Some(joint) = name.strip_suffix(APPROACH) {
            return Some((joint, Self::Side));
        }
        // Most columns are of another kind, and this is called often.
        let may = [APPROACH_FROM_ROWS, WOUND_UP, WARMTH].iter().any(|word| name.contains(word));
        let mut all = may.then(Self::all).into_iter().flatten();
        all.find_map(|history| Some((name.strip_suffix(history.ending().as_str())?, history)))
    }

    /// Its unit, for a joint that slides or turns.
    pub const fn unit(self, slides: bool) -> &'static str {
        match self {
            Self::Side | Self::WoundUp { .. } => "1",
            Self::Warmth { pace: Pace::Rows, .. } if slides => "m/row",
            Self::Warmth { pace: Pace::Rows, .. } => "rad/row",
            Self::Warmth { .. } if slides => "m/s",
            Self::Warmth { .. } => "rad/s",
        }
    }

    /// Its value after a move; `had`: the value before, 0 where there is none yet.
    pub fn after(self, step: Move, had: f64) -> f64 {
        let Move { moved, still, seconds } = step;
        let moves = moved.abs() > still;
        match self {
            Self::Side => side_after(moved, still, had),
            Self::WoundUp { .. } if !moves => had,
            Self::WoundUp { memory } => had + (moved.signum() - had) * -(-moved.abs() / memory).exp_m1(),
            Self::Warmth { lag, pace } => {
                let travel = if moves { moved.abs() } else { 0.0 };
                let took = match pace {
                    Pace::Rows => 1.0,
                    Pace::Seconds => seconds.unwrap_or(0.0),
                };
                // A clock that was set back gives no duration: heat is added, and no cooling.
                if took > 0.0 { had + (travel / took - had) * -(-took / lag).exp_m1() } else { had + travel / lag }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::approach::LEAST_MOVE;

    fn step(moved: f64) -> Move {
        Move { moved, still: LEAST_MOVE, seconds: Some(2.0) }
    }

    #[test]
    fn every_history_has_its_column_and_converges() {
        for history in History::available(true) {
            let name = format!("elbow{}", history.ending());
            assert_eq!(History::of_column(&name), Some(("elbow", history)), "{name}");
            let mut state = 0.0;
            for _ in 0..60_000 {
                state = history.after(step(0.05), state);
            }
            let back = history.after(step(-0.05), state);
            let stood = history.after(step(0.0), state);
            match history {
                History::Side => assert!(state == 1.0 && back == -1.0 && stood == state),
                History::WoundUp { memory } => {
                    let expected = -1.0 + (state + 1.0) * (-0.05 / memory).exp();
                    assert!((state - 1.0).abs() < 1e-9 && (back - expected).abs() < 1e-12, "{back} {expected}");
                    assert_eq!(stood, state);
                }
                History::Warmth { lag, pace } => {
                    let took = if pace == Pace::Rows { 1.0 } else { 2.0 };
                    // Travel by row or second, in either direction; a joint at rest cools.
                    assert!((state - 0.05 / took).abs() < 1e-4 && (back - state).abs() < 1e-6, "{history:?} {state}");
                    assert!((stood - state * (-took / lag).exp()).abs() < 1e-12, "{history:?} {stood}");
                    let set_back = history.after(Move { seconds: Some(-5.0), ..step(0.05) }, state);
                    assert!(set_back.is_finite() && set_back > 0.0);
                }
            }
        }
        assert_eq!(History::of_column("elbow.approach"), Some(("elbow", History::Side)));
        assert_eq!(History::of_column("temperature"), None);
        assert!(History::available(false).all(|history| !history.needs_a_clock()));
    }
}
