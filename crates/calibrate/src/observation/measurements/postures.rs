//! Rows by posture: those whose readings are the same stand together.

use super::Measurements;

/// Readings nearer than this are one posture, rad or m: far below what a controller repeats.
const SAME_POSTURE: f64 = 1e-6;

/// Indices of rows, those of one posture together.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Postures {
    rows: Vec<usize>,
    /// Where each posture's rows end.
    ends: Vec<usize>,
}

impl Postures {
    /// Number of different postures.
    pub fn len(&self) -> usize {
        self.ends.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.ends.is_empty()
    }

    /// The rows of each posture, in the order in which they were taken.
    pub fn iter(&self) -> impl Iterator<Item = &[usize]> {
        let starts = std::iter::once(0).chain(self.ends.iter().copied());
        starts.zip(&self.ends).map(|(start, end)| &self.rows[start..*end])
    }

    /// Whether some posture was measured more than once.
    pub fn any_repeats(&self) -> bool {
        self.rows.len() > self.ends.len()
    }
}

impl Measurements {
    /// Indices of the rows by posture: rows whose readings agree to a microradian and a micrometre stand together, in order.
    pub fn postures(&self) -> Postures {
        // Adding 0 makes one zero of two.
        let key = |row: usize, joint: usize| (self.reading(row)[joint] / SAME_POSTURE).round() + 0.0;
        let joints = self.joints.len();
        let order = |a: usize, b: usize, from: usize| {
            (from..joints).map(|joint| key(a, joint).total_cmp(&key(b, joint))).find(|order| order.is_ne())
        };
        // The first joint tells most rows apart: its key is computed once.
        let first = |row: usize| if joints > 0 { key(row, 0) } else { 0.0 };
        let mut keyed: Vec<(f64, usize)> = (0..self.len()).map(|row| (first(row), row)).collect();
        keyed.sort_unstable_by(|(key, row), (other_key, other)| {
            let further = || order(*row, *other, 1).unwrap_or_else(|| row.cmp(other));
            key.total_cmp(other_key).then_with(further)
        });
        let rows: Vec<usize> = keyed.into_iter().map(|(_, row)| row).collect();
        let last = |at: &usize| rows.get(at + 1).is_none_or(|next| order(rows[*at], *next, 0).is_some());
        let ends = (0..rows.len()).filter(last).map(|at| at + 1).collect();
        Postures { rows, ends }
    }
}
