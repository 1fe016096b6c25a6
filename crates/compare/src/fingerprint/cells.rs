//! Assigns numbers to cells, and finds numbers too close to a border.

/// The tolerance unless the user gives one: m, rad, and relative for masses.
pub const DEFAULT_TOLERANCE: f64 = 1e-6;

/// Position of the borders between the multiples of the grid: away from every decimal and every simple fraction of π.
const OFFSET: f64 = 0.618_033_988_749_894_9;

/// Nearer to a border than this share of a cell, a number may fall on either side; far above rounding, far below one.
const UNSURE: f64 = 1e-4;

/// Both sides are tried for at most this many numbers, the first ones.
const MOST_UNSURE: usize = 8;

/// Puts numbers into cells; `choice` selects the side of unsure ones.
pub(super) struct Cells {
    grid: f64,
    relative: f64,
    /// Bit k: the k-th unsure number is taken on its other side.
    choice: u32,
    unsure: usize,
}

impl Cells {
    pub fn new(tolerance: f64, choice: u32) -> Self {
        Self { grid: tolerance / 3f64.sqrt(), relative: tolerance, choice, unsure: 0 }
    }

    /// How many numbers were unsure, among those with both sides tried.
    pub fn unsure(&self) -> usize {
        self.unsure.min(MOST_UNSURE)
    }

    /// The cell of a length (m), an angle (rad) or a component of a direction.
    pub fn of(&mut self, x: f64) -> i64 {
        self.cell(x / self.grid)
    }

    /// The cell of a number of any size whose relative change matters: sign and logarithm; 0 has one of its own.
    pub fn relative(&mut self, x: f64) -> [i64; 2] {
        if x == 0.0 {
            return [0, 0];
        }
        let cell = self.cell(x.abs().ln() / self.relative);
        [if x < 0.0 { -1 } else { 1 }, cell]
    }

    #[expect(clippy::cast_possible_truncation, reason = "a cell is far below 2^63; beyond, the cast saturates")]
    fn cell(&mut self, x: f64) -> i64 {
        let shifted = x + OFFSET;
        let (cell, place) = (shifted.floor(), shifted - shifted.floor());
        let other = match place {
            p if p < UNSURE => -1,
            p if p > 1.0 - UNSURE => 1,
            _ => return cell as i64,
        };
        let turn = self.unsure < MOST_UNSURE && (self.choice >> self.unsure) & 1 == 1;
        self.unsure += 1;
        (cell as i64).saturating_add(if turn { other } else { 0 })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_beside_a_border_has_both_cells() {
        let border = (1.0 - OFFSET) * 1e-6 / 3f64.sqrt();
        let below = |choice| Cells::new(1e-6, choice).of(border * (1.0 - 1e-9));
        let above = |choice| Cells::new(1e-6, choice).of(border * (1.0 + 1e-9));
        assert_eq!((below(0), above(0)), (0, 1));
        assert_eq!((below(1), above(1)), (1, 0));
    }

    #[test]
    fn written_numbers_are_sure() {
        for tolerance in [1e-3, 1e-6, 1e-9] {
            let mut cells = Cells::new(tolerance, 0);
            for k in 0..2000 {
                cells.of(f64::from(k) * 0.0005);
                cells.of(f64::from(k) * std::f64::consts::PI / 180.0);
            }
            assert!(cells.unsure <= 4, "{} of 4000 at {tolerance}", cells.unsure);
        }
    }
}
