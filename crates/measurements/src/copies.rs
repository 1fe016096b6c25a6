//! Rows that are exact copies of others: pasted twice, logged twice, the same file twice. They add no information, and as repeats
//! they would make the instrument look better than it is.

use super::Measurements;
use super::scene::label_of;
use crate::kinds::Frame;
use std::hash::{DefaultHasher, Hash, Hasher};

/// Rows with fewer measured values may agree to the last digit by chance.
const NUMBERS_THAT_TELL: usize = 3;
/// Recorded quantities that distinguish two rows with equal measured values.
const CONDITIONS: [&str; 1] = ["payload"];
/// The ending of further such columns.
const SIDE: &str = ".approach";

/// The content of a row that identifies copies.
#[derive(PartialEq, Eq, Hash)]
struct Said<'a> {
    /// Readings, measured values and conditions, bit by bit.
    numbers: Vec<u64>,
    /// Kind, target and point of each observation, without the setup's name: a file that is given twice has two.
    seen: Vec<[&'a str; 4]>,
}

impl Measurements {
    /// Indices of the rows that say the same as an earlier row of `before` or of these, digit for digit: readings, measured
    /// values, payload and sides of approach. Names of setups do not count, since each file has its own.
    ///
    /// Rows with one or two measured values may agree by chance; they are copies only if every other column agrees as well, and if
    /// either one of these columns numbers its rows or no posture has two different values.
    pub fn copies(&self, before: Option<&Self>) -> Vec<usize> {
        let by_chance = !self.repeats_tell();
        let hashed = |data: &Self, row: usize| {
            let mut hasher = DefaultHasher::new();
            data.said(row).hash(&mut hasher);
            hasher.finish()
        };
        // Among rows with the same hash, those of `before` come first, then these in order.
        let earlier =
            before.into_iter().flat_map(|data| (0..data.len()).map(move |row| (hashed(data, row), false, row)));
        let own = (0..self.len()).map(|row| (hashed(self, row), true, row));
        let mut rows: Vec<(u64, bool, usize)> = earlier.chain(own).collect();
        rows.sort_unstable();
        let mut copies = Vec::new();
        for alike in rows.chunk_by(|a, b| a.0 == b.0).filter(|alike| alike.len() > 1) {
            let mut kept: Vec<(&Self, usize)> = Vec::new();
            for &(_, own, row) in alike {
                let data = if own { self } else { before.unwrap_or(self) };
                let same = |(other, at): &(&Self, usize)| {
                    data.said(row) == other.said(*at)
                        && (data.numbers_in(row) >= NUMBERS_THAT_TELL
                            || !by_chance
                            || data.recorded_alike(row, other, *at))
                };
                if own && !self.of_row(row).is_empty() && kept.iter().any(same) {
                    copies.push(row);
                } else {
                    kept.push((data, row));
                }
            }
        }
        copies.sort_unstable();
        copies
    }

    /// The data without the rows of these indices, and without what only those rows used.
    #[must_use]
    pub fn leaving_out(&self, rows: &[usize]) -> Self {
        let mut left_out = vec![false; self.len()];
        for row in rows {
            left_out[*row] = true;
        }
        let kept: Vec<usize> = (0..self.len()).filter(|&row| !left_out[row]).collect();
        self.subset(&kept).pruned()
    }

    fn numbers_in(&self, row: usize) -> usize {
        self.of_row(row).map(|observation| self.observed.values(observation).len()).sum()
    }

    fn said(&self, row: usize) -> Said<'_> {
        // Adding 0 turns -0 into 0.
        let mut numbers: Vec<u64> = self.reading(row).iter().map(|value| (value + 0.0).to_bits()).collect();
        let mut seen = Vec::new();
        for observation in self.of_row(row) {
            numbers.extend(self.observed.values(observation).iter().map(|value| (value + 0.0).to_bits()));
            let series = self.series_of(observation);
            let target = self.scene.targets[series.target].split('@').next().unwrap_or("");
            let point = series.point.map_or("", |point| label_of(&self.scene.points[point]));
            // A plane is a setup, identified by its label.
            let plane = if series.kind.unknowns().frame == Frame::Plane {
                self.scene.setups[series.setup].as_str()
            } else {
                ""
            };
            let own = if series.kind.own_target().is_some() { point } else { last_part(point) };
            let corner = series.corner.as_ref().map_or("", |corner| corner.label.as_str());
            seen.push([series.kind.name(), target, if corner.is_empty() { own } else { corner }, last_part(plane)]);
        }
        numbers.push(u64::from(self.locate[row]));
        let condition = |name: &str| CONDITIONS.contains(&name) || name.ends_with(SIDE);
        let conditions = self.covariates.iter().filter(|column| condition(&column.name));
        numbers.extend(conditions.map(|column| (column.values[row] + 0.0).to_bits()));
        Said { numbers, seen }
    }

    /// Whether equal rows with few values cannot be chance: no repeated posture has two different values.
    fn repeats_tell(&self) -> bool {
        if (0..self.len()).all(|row| self.numbers_in(row) >= NUMBERS_THAT_TELL) {
            return true;
        }
        self.postures().iter().all(|rows| {
            let first = self.said(rows[0]).seen;
            let values = |row: usize| self.of_row(row).map(|at| self.observed.values(at).to_vec()).collect::<Vec<_>>();
            rows.iter().skip(1).all(|&row| self.said(row).seen != first || values(row) == values(rows[0]))
        })
    }

    /// Whether two rows agree in every other column, and one of these columns distinguishes rows.
    fn recorded_alike(&self, row: usize, other: &Self, at: usize) -> bool {
        let numbers = |column: &&super::Covariate| {
            let of = other.covariate(&column.name).map(|of| of.values[at]);
            of.is_some_and(|value| value.to_bits() == column.values[row].to_bits())
        };
        let text = |label: &super::Label| {
            let of = other.labels.iter().find(|of| of.name == label.name).map(|of| &of.values[at]);
            of == Some(&label.values[row])
        };
        let tells = |column: &super::Covariate| {
            let first = column.values.first().copied();
            column.values.iter().filter(|value| Some(**value) != first).count() * 2 > column.values.len()
        };
        self.covariates.iter().all(|column| numbers(&column))
            && self.labels.iter().all(text)
            && self.covariates.iter().any(tells)
    }
}

/// The part after the last slash: the label without the setup's name.
fn last_part(name: &str) -> &str {
    name.rsplit('/').next().unwrap_or(name)
}
