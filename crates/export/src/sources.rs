//! Tables and screw axes as sources: CSV and JSON back to a chain.
//!
//! What a file is, its content says: JSON by its `schema`, CSV by its columns (`theta, d, alpha, a` or `wx … vz`).

mod poe;
mod rows;
mod table;

use crate::formats::json::UnitsEntry;
use denavit_dh::Table;
use denavit_dh::matching::VendorTable;
use denavit_model::chain::{Chain, ChainError, Coordinate};
use denavit_model::notes::Place;
use denavit_model::screw::TwistError;
use thiserror::Error;

/// A robot read from a table or from screw axes.
#[derive(Debug, Clone, PartialEq)]
pub enum Source {
    /// Denavit-Hartenberg numbers, as they stand in the file.
    Table {
        /// The numbers.
        table: Table,
        /// How the file groups them.
        convention: denavit_dh::Convention,
    },
    /// Screw axes.
    Poe(Chain),
}

impl Source {
    /// The chain that it stands for.
    ///
    /// # Errors
    /// As [`Chain::new`].
    pub fn chain(&self) -> Result<Chain, ChainError> {
        match self {
            Self::Table { table, .. } => table.chain()?.within_reach(),
            Self::Poe(chain) => Ok(chain.clone()),
        }
    }
}

/// Why a file is no table and no set of screw axes.
#[derive(Debug, Clone, PartialEq, Error)]
#[error("{place}: {kind}")]
pub struct SourceError {
    /// Where.
    pub place: Place,
    /// What, with the mend.
    pub kind: SourceErrorKind,
}

/// What can be wrong with a table's file.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum SourceErrorKind {
    /// Nothing in it.
    #[error("the file is empty; a robot is a URDF, or a D-H table or screw axes in CSV or JSON")]
    Empty,
    /// Neither kind of CSV.
    #[error("columns are {found}; a D-H table has theta, d, alpha, a and screw axes have wx, wy, wz, vx, vy, vz")]
    Columns {
        /// What there is.
        found: String,
    },
    /// The CSV reader stopped.
    #[error("not CSV: {0}")]
    Csv(String),
    /// The JSON reader stopped.
    #[error("not this JSON: {0}")]
    Json(String),
    /// A schema of something else.
    #[error("schema \"{0}\" is not a robot; denavit.table/1 and denavit.poe/1 are")]
    Schema(String),
    /// A cell that should be a number.
    #[error("{column} is \"{value}\"; write a finite number")]
    Number {
        /// Column.
        column: String,
        /// Cell.
        value: String,
    },
    /// A number that must be there.
    #[error("{column} is missing; write a number, 0 where there is none")]
    Missing {
        /// Column.
        column: String,
    },
    /// An unknown kind.
    #[error("kind is \"{0}\"; write revolute, prismatic or helical")]
    Kind(String),
    /// A helical joint without pitch, or another with one.
    #[error("a {kind} joint with pitch {pitch}; a helical joint has a pitch in m/rad, the others none")]
    Pitch {
        /// Kind.
        kind: String,
        /// Pitch.
        pitch: f64,
    },
    /// An unknown convention.
    #[error("convention is \"{0}\"; write distal, proximal, paper or hayati")]
    Convention(String),
    /// Units that this file cannot have.
    #[error("units are {0}; files are in m and rad")]
    Units(String),
    /// A row out of place.
    #[error("row \"{0}\" stands out of order; rows are base, 1, 2, …, tool")]
    Order(String),
    /// A coordinate that no entry declares.
    #[error("coordinate \"{0}\" is not in `coordinates`; add it")]
    Coordinate(String),
    /// Rows and joints do not go together.
    #[error(transparent)]
    Rows(#[from] denavit_dh::conventions::RowsError),
    /// A twist that moves nothing.
    #[error(transparent)]
    Twist(#[from] TwistError),
    /// The parts make no chain.
    #[error(transparent)]
    Chain(#[from] ChainError),
}

/// Reads a robot from CSV or JSON text; `file` is used in messages, and its stem where the text gives no robot's name.
///
/// # Errors
/// The first thing that is wrong, with file, line and element.
pub fn read(file: &str, text: &str) -> Result<Source, SourceError> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let trimmed = text.trim_start();
    if trimmed.is_empty() {
        return Err(SourceError { place: place(file, 1, "file"), kind: SourceErrorKind::Empty });
    }
    if trimmed.starts_with('{') {
        return json(file, text);
    }
    let rows = rows::Rows::read(file, text)?;
    if rows.has("wx") {
        return poe::of_rows(&rows).map(Source::Poe);
    }
    if rows.has("theta") && rows.has("a") {
        return table::of_rows(&rows);
    }
    let found = rows.columns().join(", ");
    Err(SourceError { place: place(file, rows.header_line(), "header"), kind: SourceErrorKind::Columns { found } })
}

/// Reads a table to match a robot against: numbers keep the text that they are written as; base and tool frames are
/// free, whatever the file says of them.
///
/// # Errors
/// As [`read`]. Screw axes count as their distal table.
pub fn read_vendor_table(file: &str, text: &str) -> Result<VendorTable, SourceError> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    match read(file, text)? {
        Source::Table { table, convention } if text.trim_start().starts_with('{') => {
            Ok(VendorTable::of(&table, convention, false))
        }
        Source::Table { table: read, convention } => {
            table::vendor_of_rows(&rows::Rows::read(file, text)?, &read, convention)
        }
        Source::Poe(chain) => {
            let options = denavit_dh::Options::default();
            let table = denavit_dh::convert::table(&chain, &options)
                .map_err(|error| SourceError { place: place(file, 1, "file"), kind: error.into() })?;
            Ok(VendorTable::of(&table.value, denavit_dh::Convention::Distal, false))
        }
    }
}

fn json(file: &str, text: &str) -> Result<Source, SourceError> {
    let at = |error: &serde_json::Error| place(file, error.line(), "file");
    let wrong =
        |error: serde_json::Error| SourceError { place: at(&error), kind: SourceErrorKind::Json(error.to_string()) };
    let value: serde_json::Value = serde_json::from_str(text).map_err(wrong)?;
    let schema = value.get("schema").and_then(serde_json::Value::as_str).unwrap_or_default().to_owned();
    match schema.as_str() {
        crate::formats::json::SCHEMA => table::of_file(file, &serde_json::from_str(text).map_err(wrong)?),
        crate::poe::SCHEMA => poe::of_file(file, &serde_json::from_str(text).map_err(wrong)?).map(Source::Poe),
        _ => Err(SourceError { place: place(file, 1, "schema"), kind: SourceErrorKind::Schema(schema) }),
    }
}

fn place(file: &str, line: usize, element: impl Into<String>) -> Place {
    Place { file: file.to_owned(), line, element: element.into() }
}

/// What every JSON source holds: numbers in m and rad.
fn in_si(file: &str, units: &UnitsEntry) -> Result<(), SourceError> {
    if units.length == "m" && units.angle == "rad" {
        return Ok(());
    }
    let units = format!("{} and {}", units.length, units.angle);
    Err(SourceError { place: place(file, 1, "units"), kind: SourceErrorKind::Units(units) })
}

/// Index of the coordinate that a JSON joint names.
fn coordinate_of(file: &str, joint: &str, name: &str, coordinates: &[Coordinate]) -> Result<usize, SourceError> {
    coordinates.iter().position(|coordinate| coordinate.name == name).ok_or_else(|| SourceError {
        place: place(file, 1, format!("joint \"{joint}\"")),
        kind: SourceErrorKind::Coordinate(name.to_owned()),
    })
}

fn stem(file: &str) -> String {
    let name = file.rsplit(['/', '\\']).next().unwrap_or(file);
    name.split('.').next().unwrap_or(name).to_owned()
}
