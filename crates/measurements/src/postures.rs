//! Rows grouped by posture: those with equal readings.

use super::Measurements;

/// Readings closer than this are one posture, rad or m: far below a controller's repeatability.
const SAME_POSTURE: f64 = 1e-6;

/// Readings closer than this are one posture measured again, rad or m: the scatter of encoders when a pose is held or repeated.
const TAKEN_AGAIN: f64 = 5e-4;

/// Indices of rows, grouped by posture.
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
    /// Indices of the rows by posture: groups rows whose readings agree to a microradian and a micrometre, in order.
    pub fn postures(&self) -> Postures {
        // Adding 0 turns -0 into 0.
        let key = |row: usize, joint: usize| (self.reading(row)[joint] / SAME_POSTURE).round() + 0.0;
        let joints = self.joints.len();
        let order = |a: usize, b: usize, from: usize| {
            (from..joints).map(|joint| key(a, joint).total_cmp(&key(b, joint))).find(|order| order.is_ne())
        };
        // The first joint distinguishes most rows: its key is computed once.
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

    /// Whether two rows measure two tips of the robot in one posture.
    pub fn same_posture_of_other_tip(&self, row: usize, other: usize) -> bool {
        let near = || self.reading(row).iter().zip(self.reading(other)).all(|(a, b)| (a - b).abs() <= SAME_POSTURE);
        self.tip_of(row) != self.tip_of(other) && near()
    }

    /// Indices of about this many rows, at most all, spread evenly over the run; rows of several tips in one posture stay together.
    pub fn spread_by_posture(&self, count: usize) -> Vec<usize> {
        let begins = |row: &usize| *row == 0 || !self.same_posture_of_other_tip(*row - 1, *row);
        let firsts: Vec<usize> = (0..self.len()).filter(begins).chain([self.len()]).collect();
        let all = firsts.len() - 1;
        let wanted = (all * count).div_ceil(self.len().max(1));
        (0..wanted).map(|k| k * all / wanted).flat_map(|k| firsts[k]..firsts[k + 1]).collect()
    }

    /// For each row the first row of the same posture: readings that agree to half a milliradian and half a millimetre.
    ///
    /// Rows of one posture share the model's error there, so they are never split between fit and test.
    pub fn first_of_posture(&self) -> Vec<usize> {
        let joints = self.joints.len();
        let mut first: Vec<usize> = (0..self.len()).collect();
        let range = |joint: &usize| {
            let values = (0..self.len()).map(|row| self.reading(row)[*joint]);
            let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)));
            high - low
        };
        // Along the joint that moves most, few rows are neighbours.
        let Some(along) = (0..joints).max_by(|a, b| range(a).total_cmp(&range(b))) else { return first };
        let at = |row: usize| self.reading(row)[along];
        let mut order = first.clone();
        order.sort_by(|a, b| at(*a).total_cmp(&at(*b)).then(a.cmp(b)));
        let mut leaders: Vec<usize> = Vec::new();
        let mut led_by = vec![0; self.len()];
        for &row in &order {
            let near = |leader: &usize| {
                self.tip_of(*leader) == self.tip_of(row)
                    && self.reading(*leader).iter().zip(self.reading(row)).all(|(a, b)| (a - b).abs() <= TAKEN_AGAIN)
            };
            let within = leaders.iter().rev().take_while(|leader| at(row) - at(**leader) <= TAKEN_AGAIN);
            led_by[row] = within.copied().find(near).unwrap_or(row);
            if led_by[row] == row {
                leaders.push(row);
            }
        }
        // The leader is the lowest along that joint; the first is the earliest row.
        for row in (0..self.len()).rev() {
            first[led_by[row]] = row;
        }
        led_by.into_iter().map(|leader| first[leader]).collect()
    }
}
