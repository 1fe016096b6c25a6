//! Rows that are exact copies of others: pasted twice, logged twice, the same file twice. They say nothing new, and as repeats
//! they would make the instrument look better than it is.

use super::Measurements;
use super::scene::label_of;
use std::collections::HashMap;
use std::hash::{DefaultHasher, Hash, Hasher};

/// Rows with fewer measured numbers may agree to the last digit by chance.
const NUMBERS_THAT_TELL: usize = 3;
/// Recorded quantities that make two rows different although everything that was measured agrees.
const CONDITIONS: [&str; 1] = ["payload"];
/// The end of names of columns that do so, too.
const SIDE: &str = ".approach";

/// What one row says, by which copies are found.
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
    /// Rows with one or two measured numbers agree by chance; they are copies where every other column agrees as well, and where
    /// either one of these numbers its rows or no posture shows two different values.
    pub fn copies(&self, before: Option<&Self>) -> Vec<usize> {
        let mut known: HashMap<u64, Vec<(bool, usize)>> = HashMap::with_capacity(self.len());
        let by_chance = !self.repeats_tell();
        let hashed = |data: &Self, row: usize| {
            let mut hasher = DefaultHasher::new();
            data.said(row).hash(&mut hasher);
            hasher.finish()
        };
        if let Some(before) = before {
            for row in 0..before.len() {
                known.entry(hashed(before, row)).or_default().push((true, row));
            }
        }
        let mut copies = Vec::new();
        for row in 0..self.len() {
            let own = known.entry(hashed(self, row)).or_default();
            let same = |(earlier, other): &(bool, usize)| {
                let data = if *earlier { before.unwrap_or(self) } else { self };
                self.said(row) == data.said(*other)
                    && (self.numbers_in(row) >= NUMBERS_THAT_TELL
                        || !by_chance
                        || self.recorded_alike(row, data, *other))
            };
            if self.of_row(row).is_empty() || !own.iter().any(same) {
                own.push((false, row));
            } else {
                copies.push(row);
            }
        }
        copies
    }

    /// The rows without those of these indices, and without what only those spoke of.
    #[must_use]
    pub fn without(&self, rows: &[usize]) -> Self {
        let mut left_out = vec![false; self.len()];
        rows.iter().for_each(|&row| left_out[row] = true);
        let kept: Vec<usize> = (0..self.len()).filter(|&row| !left_out[row]).collect();
        self.subset(&kept).pruned()
    }

    fn numbers_in(&self, row: usize) -> usize {
        self.of_row(row).map(|observation| self.observed.values(observation).len()).sum()
    }

    fn said(&self, row: usize) -> Said<'_> {
        // Adding 0 makes one zero of two.
        let mut numbers: Vec<u64> = self.reading(row).iter().map(|value| (value + 0.0).to_bits()).collect();
        let mut seen = Vec::new();
        for observation in self.of_row(row) {
            numbers.extend(self.observed.values(observation).iter().map(|value| (value + 0.0).to_bits()));
            let series = self.series_of(observation);
            let target = self.scene.targets[series.target].split('@').next().unwrap_or("");
            let point = series.point.map_or("", |point| label_of(&self.scene.points[point]));
            // A plane is a setup, and its label is what tells it from others.
            let plane = if series.kind.unknowns().plane { self.scene.setups[series.setup].as_str() } else { "" };
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

    /// Whether rows that say the same with few numbers cannot do so by chance: no posture that was measured again shows two
    /// different values.
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

    /// Whether two rows agree in every other column, and one of these tells rows apart.
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

/// What stands behind the last stroke: the label without the setup's name.
fn last_part(name: &str) -> &str {
    name.rsplit('/').next().unwrap_or(name)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::observation::measurements::{Units, read};
    use denavit_model::examples;

    fn rows(text: &str) -> Measurements {
        read("d.csv", text.as_bytes(), &examples::planar_arm(), Units::default()).unwrap().data
    }

    #[test]
    fn rows_that_say_the_same_are_copies_whatever_else_is_recorded() {
        let data = rows(
            "joint_1,joint_2,x,y,z,time,payload\n0.1,0.2,1,0.5,0,1,2\n0.3,0.2,1,0.6,0,2,2\n0.1,0.2,1,0.5,0,3,2\n\
             0.1,0.2,1,0.5,0,4,3\n0.1,0.2,1,0.5001,0,5,2\n",
        );
        assert_eq!(data.copies(None), [2]);
        assert_eq!(data.copies(Some(&data)), [0, 1, 2, 3, 4]);
        assert_eq!(data.without(&[2]).lines, [2, 3, 5, 6]);
    }

    #[test]
    fn a_file_given_twice_has_two_setups_and_one_set_of_rows() {
        let one = || rows("joint_1,joint_2,x1,y1,z1,x2,y2,z2\n0.1,0.2,1,0.5,0,1,1,1\n0.3,0.2,1,0.6,0,,,\n");
        let both = Measurements::joined(vec![one().of_setup("a"), one().of_setup("a 2")]).unwrap();
        assert_eq!(both.copies(None), [2, 3]);
        let left = both.without(&[2, 3]);
        assert_eq!((left.scene.setups.len(), left.scene.targets.len(), left.len()), (1, 2, 2));
    }

    #[test]
    fn one_number_agrees_by_chance() {
        let chance = "joint_1,joint_2,distance\n0.1,0.2,1.5\n0.1,0.2,1.5\n0.1,0.2,1.6\n";
        assert_eq!(rows(chance).copies(None), Vec::<usize>::new());
        let pasted = "joint_1,joint_2,distance\n0.1,0.2,1.5\n0.4,0.2,1.6\n0.1,0.2,1.5\n0.4,0.2,1.6\n";
        assert_eq!(rows(pasted).copies(None), [2, 3]);
        let numbered = "joint_1,joint_2,distance,shot\n0.1,0.2,1.5,1\n0.1,0.2,1.5,2\n0.1,0.2,1.6,3\n0.1,0.2,1.6,3\n";
        assert_eq!(rows(numbered).copies(None), [3]);
    }
}
