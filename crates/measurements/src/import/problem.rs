//! Why an export cannot be read.

use crate::plate::Plate;
use thiserror::Error;

/// Why an export cannot be read: the message after file and line.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum ImportProblem {
    /// Nothing that looks like rows of numbers.
    #[error("there are no rows of three or more numbers; is it a text or Excel export of measurements?")]
    NoRows,
    /// A workbook that cannot be read.
    #[error("this Excel workbook cannot be read: {0}; save it again as .xlsx, or as CSV")]
    Workbook(String),
    /// More columns than any measurement has.
    #[error(
        "the line has {found} columns, but at most {most} are read; are rows and columns of the file exchanged, or are the \
         columns separated by something else?"
    )]
    Columns {
        /// How many.
        found: usize,
        /// The limit.
        most: usize,
    },
    /// A column that is not there.
    #[error("there is no column \"{column}\" (for {wanted}); the file has {known}")]
    NoColumn {
        /// Asked for.
        column: String,
        /// What for.
        wanted: String,
        /// The columns.
        known: String,
    },
    /// A unit that means nothing here.
    #[error("column \"{column}\": the unit \"{unit}\" is not known for {quantity}; write one of {known}")]
    Unit {
        /// The column.
        column: String,
        /// Its unit.
        unit: String,
        /// Its quantity.
        quantity: &'static str,
        /// Units of that.
        known: String,
    },
    /// A cell that is not a number.
    #[error("column \"{column}\": \"{text}\" is not a number; correct the cell or remove the row")]
    Number {
        /// The column.
        column: String,
        /// The cell.
        text: String,
    },
    /// A quaternion of another length than 1.
    #[error(
        "the quaternion of columns {columns} has length {length:.6}, not 1; are these its columns, and in this order of x, y, z, w?"
    )]
    Length {
        /// The columns.
        columns: String,
        /// Its length.
        length: f64,
    },
    /// A hole that the plate does not have.
    #[error(
        "column \"hole\": the plate ({plate}) has no hole \"{name}\"; its holes are A1 to {last}; correct the cell or ‹plate›"
    )]
    Hole {
        /// The plate.
        plate: Plate,
        /// The cell.
        name: String,
        /// The last hole.
        last: String,
    },
    /// Options that need columns which are not there, or that contradict each other.
    #[error("{0}")]
    Option(String),
    /// Joint values of another count than the rows, or the chain's joints.
    #[error("{found} where {wanted} are needed; {fix}")]
    Count {
        /// What there is.
        found: String,
        /// What there should be.
        wanted: String,
        /// What to do.
        fix: &'static str,
    },
}

/// A problem and its line, 0 where it has none.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Fault {
    pub line: usize,
    pub problem: ImportProblem,
}
