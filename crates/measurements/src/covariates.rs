//! Numbers recorded beside the measurements, and the only way an effect can read them.
//!
//! An effect depends on a [`Column`], which exists only where every row has a value for it; otherwise the request is an error
//! that names the file, the column and the fix. Code that is evaluated row by row takes the column, not a name or an index,
//! so that a quantity that nobody recorded cannot be read as 0.
//!
//! ```compile_fail,E0451
//! use denavit_measurements::Column;
//! let column = Column { index: 3, name: "temperature".into() };
//! ```
//! ```
//! use denavit_measurements::{Covariate, Covariates};
//! let recorded = Covariates::from(vec![Covariate { name: "temperature".into(), values: vec![20.5, 21.0] }]);
//! let column = recorded.column("run.csv", 2, "temperature")?;
//! assert_eq!(column.name(), "temperature");
//! assert!(recorded.column("run.csv", 2, "payload").is_err());
//! # Ok::<(), denavit_measurements::MissingColumn>(())
//! ```

use std::ops::Deref;
use std::sync::Arc;
use thiserror::Error;

/// Name of the covariate that gives the mass at the tip, kg.
pub const PAYLOAD: &str = "payload";

/// A numeric column that is neither a joint reading nor a measured value.
#[derive(Debug, Clone, PartialEq)]
pub struct Covariate {
    /// The column's name, such as `temperature` (°C) or `joint_2.approach`.
    pub name: String,
    /// One value per row, in the column's own unit.
    pub values: Vec<f64>,
}

/// The numeric columns of a run.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Covariates {
    columns: Vec<Covariate>,
    payload: Option<usize>,
}

/// A recorded quantity that every row of a run has: its index among the columns of that run, of any part of it and of every
/// run with the same columns.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Column {
    index: usize,
    name: Arc<str>,
}

/// Why an effect cannot use a recorded quantity.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum MissingColumn {
    /// There is no column of this name.
    #[error("{file}: there is no column \"{column}\", but an effect depends on it; record it, or leave the effect out")]
    Absent {
        /// The file.
        file: String,
        /// The name.
        column: String,
    },
    /// A row has no finite number in it.
    #[error(
        "{file}: row {row} has no value in column \"{column}\", but an effect depends on it; fill it in, or remove the row \
         or the column"
    )]
    Incomplete {
        /// The file.
        file: String,
        /// The name.
        column: String,
        /// Counted from 1, without the header.
        row: usize,
    },
}

impl MissingColumn {
    /// The column's name.
    pub fn column(&self) -> &str {
        match self {
            Self::Absent { column, .. } | Self::Incomplete { column, .. } => column,
        }
    }
}

impl Column {
    /// Its name.
    pub fn name(&self) -> &str {
        &self.name
    }
}

impl AsRef<str> for Column {
    fn as_ref(&self) -> &str {
        &self.name
    }
}

impl Covariates {
    /// No columns.
    pub const fn none() -> Self {
        Self { columns: Vec::new(), payload: None }
    }

    /// Adds a column.
    pub fn push(&mut self, column: Covariate) {
        if self.payload.is_none() && column.name == PAYLOAD {
            self.payload = Some(self.columns.len());
        }
        self.columns.push(column);
    }

    /// The column of this name, which has a finite value in each of this many rows; `file` is for the error.
    ///
    /// # Errors
    /// There is no such column, or a row has no value in it.
    pub fn column(&self, file: &str, rows: usize, name: &str) -> Result<Column, MissingColumn> {
        let (file, column) = (|| file.to_owned(), || name.to_owned());
        let Some(index) = self.columns.iter().position(|known| known.name == name) else {
            return Err(MissingColumn::Absent { file: file(), column: column() });
        };
        let values = &self.columns[index].values;
        let here = |row: &usize| values.get(*row).is_none_or(|value| !value.is_finite());
        match (0..rows).find(here) {
            Some(row) => Err(MissingColumn::Incomplete { file: file(), column: column(), row: row + 1 }),
            None => Ok(Column { index, name: name.into() }),
        }
    }

    /// What was recorded in a row.
    pub fn row(&self, row: usize) -> RecordedRow<'_> {
        RecordedRow { columns: self, row }
    }

    /// The same with other values in one column.
    pub fn set(&mut self, column: &Column, values: impl FnMut() -> f64) {
        self.columns[column.index].values.fill_with(values);
    }

    /// Removes the rows from this one on.
    pub fn truncate(&mut self, rows: usize) {
        self.columns.iter_mut().for_each(|column| column.values.truncate(rows));
    }

    /// Frees memory that was reserved for more rows.
    pub(super) fn shrink(&mut self) {
        self.columns.iter_mut().for_each(|column| column.values.shrink_to_fit());
    }

    /// The columns themselves.
    pub fn into_columns(self) -> Vec<Covariate> {
        self.columns
    }
}

impl Deref for Covariates {
    type Target = [Covariate];

    fn deref(&self) -> &[Covariate] {
        &self.columns
    }
}

impl From<Vec<Covariate>> for Covariates {
    fn from(columns: Vec<Covariate>) -> Self {
        let payload = columns.iter().position(|column| column.name == PAYLOAD);
        Self { columns, payload }
    }
}

/// What was recorded in one row.
#[derive(Debug, Clone, Copy)]
pub struct RecordedRow<'a> {
    columns: &'a Covariates,
    row: usize,
}

impl RecordedRow<'_> {
    /// A row without recorded quantities.
    pub const fn nothing() -> RecordedRow<'static> {
        const NONE: &Covariates = &Covariates::none();
        RecordedRow { columns: NONE, row: 0 }
    }

    /// The column of this name, if it was recorded.
    ///
    /// # Errors
    /// It was not.
    pub fn column(&self, name: &str) -> Result<Column, MissingColumn> {
        self.columns.column("", self.row + 1, name)
    }

    /// The value in a column, in the column's own unit.
    ///
    /// # Panics
    /// The column is of a run with other columns.
    #[inline]
    pub fn value(&self, column: &Column) -> f64 {
        match self.columns.columns.get(column.index) {
            Some(own) if *own.name == *column.name => own.values[self.row],
            _ => panic!("\"{}\" was looked up in a run with other columns", column.name),
        }
    }

    /// The mass at the tip, kg: where a run has no such column, nothing was carried.
    #[inline]
    pub fn payload(&self) -> f64 {
        self.columns.payload.map_or(0.0, |index| self.columns.columns[index].values[self.row])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn recorded() -> Covariates {
        let column = |name: &str, values: &[f64]| Covariate { name: name.into(), values: values.to_vec() };
        Covariates::from(vec![column("time", &[0.0, 1.0, 2.0]), column("temperature", &[20.0, f64::NAN, 21.0])])
    }

    #[test]
    fn a_column_is_complete_or_is_none() {
        let recorded = recorded();
        let time = recorded.column("run.csv", 3, "time").unwrap();
        assert_eq!((time.name(), recorded.row(2).value(&time)), ("time", 2.0));
        let refused = |rows, name| recorded.column("run.csv", rows, name).unwrap_err().to_string();
        assert_eq!(
            refused(3, "payload"),
            "run.csv: there is no column \"payload\", but an effect depends on it; record it, or leave the effect out"
        );
        assert_eq!(
            refused(3, "temperature"),
            "run.csv: row 2 has no value in column \"temperature\", but an effect depends on it; fill it in, or remove the \
             row or the column"
        );
        assert!(refused(4, "time").starts_with("run.csv: row 4 has no value in column \"time\""));
        assert!(recorded.column("run.csv", 1, "temperature").is_ok());
    }

    #[test]
    #[should_panic(expected = "\"time\" was looked up in a run with other columns")]
    fn a_column_of_another_run_is_not_read() {
        let other = Covariates::from(vec![Covariate { name: "payload".into(), values: vec![1.0] }]);
        let time = recorded().column("run.csv", 3, "time").unwrap();
        other.row(0).value(&time);
    }

    #[test]
    #[should_panic(expected = "\"time\" was looked up in a run with other columns")]
    fn a_column_is_not_read_in_a_run_without_columns() {
        let time = recorded().column("run.csv", 3, "time").unwrap();
        RecordedRow::nothing().value(&time);
    }

    #[test]
    fn a_payload_is_found_however_it_came_in() {
        let payload = || Covariate { name: PAYLOAD.into(), values: vec![2.5] };
        let mut pushed = Covariates::none();
        assert_eq!(pushed.row(0).payload(), 0.0);
        pushed.push(payload());
        assert_eq!(pushed.row(0).payload(), 2.5);
        assert_eq!(Covariates::from(vec![payload()]).row(0).payload(), 2.5);
        assert_eq!(RecordedRow::nothing().payload(), 0.0);
    }
}
