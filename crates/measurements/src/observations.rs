//! Observations in columns: the series of each, and its values.

use denavit_model::nalgebra::Matrix3;
use std::ops::Range;

/// The observations of all rows, row by row.
#[derive(Debug, Clone, PartialEq)]
pub struct Observations {
    /// First observation of each row, and the end of the last.
    starts: Vec<u32>,
    series: Vec<u32>,
    /// First number of each observation, and the end of the last.
    firsts: Vec<u32>,
    numbers: Vec<f64>,
    /// Factor on the lengths of each observation, in its measured axes, that gives all of them the standard deviation of their
    /// channel; empty where none is needed.
    levels: Vec<Matrix3<f64>>,
}

impl Default for Observations {
    fn default() -> Self {
        Self { starts: vec![0], series: Vec::new(), firsts: vec![0], numbers: Vec::new(), levels: Vec::new() }
    }
}

impl Observations {
    /// Appends an observation to the current row.
    ///
    /// # Shape and units
    /// `values`: as many as the series' kind stores, in its units.
    pub fn push(&mut self, series: usize, values: &[f64]) {
        self.series.push(short(series));
        self.numbers.extend_from_slice(values);
        self.firsts.push(short(self.numbers.len()));
        if !self.levels.is_empty() {
            self.levels.push(Matrix3::identity());
        }
    }

    /// Appends an observation of `others` with its precision.
    pub fn adopt(&mut self, series: usize, others: &Self, observation: usize) {
        self.push(series, others.values(observation));
        if let Some(level) = others.level(observation) {
            self.levels.resize(self.len(), Matrix3::identity());
            self.levels[self.series.len() - 1] = *level;
        }
    }

    /// Frees memory that was reserved for more.
    pub(super) fn shrink(&mut self) {
        self.starts.shrink_to_fit();
        self.series.shrink_to_fit();
        self.firsts.shrink_to_fit();
        self.numbers.shrink_to_fit();
    }

    /// Ends the row.
    pub fn end_row(&mut self) {
        self.starts.push(short(self.series.len()));
    }

    /// Reopens the last row: the next pushes belong to it until it is ended.
    pub(super) fn resume_row(&mut self) {
        if self.starts.len() > 1 {
            self.starts.pop();
        }
    }

    /// The observations of the current row.
    pub(super) fn since_row_began(&self) -> Range<usize> {
        self.starts[self.starts.len() - 1] as usize..self.series.len()
    }

    /// Number of observations.
    pub fn len(&self) -> usize {
        self.series.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.series.is_empty()
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.starts.len() - 1
    }

    /// The observations of a row.
    #[inline]
    pub fn of_row(&self, row: usize) -> Range<usize> {
        self.starts[row] as usize..self.starts[row + 1] as usize
    }

    /// The row of an observation.
    pub fn row_of(&self, observation: usize) -> usize {
        self.starts.partition_point(|start| *start as usize <= observation) - 1
    }

    /// Index of the series that an observation belongs to.
    #[inline]
    pub fn series(&self, observation: usize) -> usize {
        self.series[observation] as usize
    }

    /// The numbers of an observation.
    #[inline]
    pub fn values(&self, observation: usize) -> &[f64] {
        &self.numbers[self.firsts[observation] as usize..self.firsts[observation + 1] as usize]
    }

    /// The same, mutable.
    pub fn values_mut(&mut self, observation: usize) -> &mut [f64] {
        &mut self.numbers[self.firsts[observation] as usize..self.firsts[observation + 1] as usize]
    }

    /// The factor that gives an observation the precision of its channel; `None` where none needs one.
    #[inline]
    pub fn level(&self, observation: usize) -> Option<&Matrix3<f64>> {
        self.levels.get(observation)
    }

    /// Whether observations differ in precision.
    pub fn has_levels(&self) -> bool {
        !self.levels.is_empty()
    }

    /// Sets the precision factor of each observation: see [`Observations::level`].
    ///
    /// # Shape and units
    /// One matrix per observation.
    pub fn set_levels(&mut self, levels: Vec<Matrix3<f64>>) {
        debug_assert_eq!(levels.len(), self.len());
        self.levels = levels;
    }

    /// These rows, with the series that `series` gives; observations for which it gives none are left out.
    #[must_use]
    pub fn subset(&self, rows: impl Iterator<Item = usize>, series: impl Fn(usize) -> Option<usize>) -> Self {
        let mut subset = Self::default();
        let mut levels = Vec::new();
        for row in rows {
            for observation in self.of_row(row) {
                if let Some(series) = series(self.series(observation)) {
                    subset.push(series, self.values(observation));
                    levels.extend(self.level(observation));
                }
            }
            subset.end_row();
        }
        subset.levels = levels;
        subset
    }
}

/// Indices in half the memory.
fn short(index: usize) -> u32 {
    u32::try_from(index).expect("four thousand million numbers are more than anybody measures")
}
