//! Tables and screw axes as sources: reads CSV, Markdown, printed tables and JSON into a chain.
//!
//! The content determines the kind of file: JSON by its `schema`, all others by their column headings (`theta, d, alpha, a`
//! or `wx … vz`) as people write them. Units are in cells (`90°`), headings (`a (mm)`), comments or text above the table,
//! or are stated by the user; otherwise they are inferred from the numbers, and the choice is returned as a sentence.
//! What is not understood is reported: as an error if a number depends on it, otherwise as a note.

mod cell;
mod header;
mod keys;
mod limits;
mod modern_robotics;
mod poe;
mod rows;
mod stated;
mod table;

use crate::formats::json::{CoordinateEntry, UnitsEntry};
use crate::makers::yaml::Cells;
use denavit_dh::matching::VendorTable;
use denavit_dh::{Convention, Table};
use denavit_model::Inventory;
use denavit_model::chain::{Chain, ChainError, Coordinate};
use denavit_model::notes::{Note, Place};
use denavit_model::screw::TwistError;
use denavit_model::units::Unit;
use denavit_model::words::quoted;
use std::fmt;
use thiserror::Error;

pub use stated::{ReadAs, Stated};

/// Columns of a D-H table that are read, by their names here.
const COLUMNS: [&str; 13] =
    ["row", "joint", "kind", "convention", "theta", "offset", "d", "alpha", "a", "r", "beta", "pitch", "scale"];

/// Our name for a column of a D-H table with a heading such as `Alpha [deg]` or `θ`; `None` if it is not read.
pub fn column(heading: &str) -> Option<&'static str> {
    let name = header::Heading::of(heading).name;
    COLUMNS.into_iter().find(|column| *column == name)
}

/// A robot read from a table or from screw axes.
#[derive(Debug, Clone, PartialEq)]
pub enum Source {
    /// Denavit-Hartenberg numbers, as in the file.
    Table {
        /// The numbers.
        table: Table,
        /// How the file groups them.
        convention: Convention,
    },
    /// Screw axes, or a table with frames that its rows cannot represent.
    Poe(Chain),
}

/// A robot that was read, and an inventory of its file.
#[derive(Debug, Clone, PartialEq)]
pub struct Read {
    /// The robot.
    pub source: Source,
    /// A sentence for everything that was not stated and was inferred from the numbers.
    pub assumed: Vec<String>,
    /// What was not understood and was ignored.
    pub notes: Vec<Note>,
    /// What became of every line, column, cell and key.
    pub inventory: Inventory,
}

impl Source {
    /// The chain that it describes.
    ///
    /// # Errors
    /// As [`Chain::new`].
    pub fn chain(&self) -> Result<Chain, ChainError> {
        match self {
            Self::Table { table, .. } => table.chain()?.within_reach(),
            Self::Poe(chain) => chain.clone().within_reach(),
        }
    }
}

/// Why a file is neither a table nor a set of screw axes.
#[derive(Debug, Clone, PartialEq)]
pub struct SourceError {
    /// Where.
    pub place: Place,
    /// Where in the line a cell begins, counted from 1.
    pub column: Option<usize>,
    /// What is wrong, and the fix.
    pub kind: SourceErrorKind,
}

impl SourceError {
    fn at(place: Place, kind: SourceErrorKind) -> Self {
        Self { place, column: None, kind }
    }
}

impl fmt::Display for SourceError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Place { file, line, element } = &self.place;
        let element = quoted(element);
        match self.column {
            Some(column) => write!(f, "{file}:{line}:{column}: {element}: {}", self.kind),
            None => write!(f, "{file}:{line}: {element}: {}", self.kind),
        }
    }
}

impl std::error::Error for SourceError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        std::error::Error::source(&self.kind)
    }
}

/// What can be wrong with a table's file.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum SourceErrorKind {
    /// Nothing in it.
    #[error("the file is empty; a robot is a URDF, or a D-H table or screw axes in CSV, Markdown or JSON")]
    Empty,
    /// Neither kind of table.
    #[error("columns are {found}; a D-H table has {accepted}", found = quoted(found), accepted = header::ACCEPTED)]
    Columns {
        /// What there is.
        found: String,
    },
    /// A column name with two meanings in the literature.
    #[error(
        "\"{word}\" is the link length in some books and the link offset in others (Khalil); name the columns a and d",
        word = quoted(.0)
    )]
    Ambiguous(String),
    /// Two columns of one meaning.
    #[error("\"{}\" and \"{}\" name the same column; rename or remove one", quoted(first), quoted(second))]
    Twice {
        /// A heading.
        first: String,
        /// Another.
        second: String,
    },
    /// Commas and points as decimal marks in one file.
    #[error("this number uses another decimal mark than those before it; use a point in all, or a comma in all")]
    DecimalMarks,
    /// The JSON reader stopped.
    #[error("invalid JSON for this schema: {0}")]
    Json(String),
    /// A schema of something else.
    #[error(
        "schema \"{}\" is not a robot; use denavit.table/1, denavit.poe/1, or screw axes as in Modern Robotics (keys \
         M and Slist or Blist)",
        quoted(.0)
    )]
    Schema(String),
    /// A calibration result, which is not a robot without the one that it corrects.
    #[error(
        "this is a calibration result for \"{}\": it holds only corrections to the nominal model; make a URDF of both \
         with `denavit edit ROBOT.urdf set-calibration {}` and give that",
        quoted(robot),
        quoted(file)
    )]
    Corrections {
        /// The file.
        file: String,
        /// The robot's name.
        robot: String,
    },
    /// A cell that should be a number.
    #[error(
        "{} is \"{}\"; write a finite number, such as 0.1625, -90°, π/2 or q1 + 90°",
        quoted(column),
        quoted(value)
    )]
    Number {
        /// Column.
        column: String,
        /// Cell.
        value: String,
    },
    /// A required number.
    #[error("{column} is missing; write a number, 0 if there is none")]
    Missing {
        /// Column.
        column: String,
    },
    /// An unknown kind.
    #[error("kind is \"{}\"; write revolute, prismatic, helical or fixed", quoted(.0))]
    Kind(String),
    /// A helical joint without pitch, or another with one.
    #[error("a {kind} joint with pitch {pitch}; only a helical joint has a pitch (in m/rad)")]
    Pitch {
        /// Kind.
        kind: String,
        /// Pitch.
        pitch: f64,
    },
    /// An unknown convention.
    #[error("convention is \"{word}\"; write distal (standard), proximal (modified, craig), paper or hayati", word = quoted(.0))]
    Convention(String),
    /// File and user contradict each other.
    #[error("the file says {file} and the options say {user}; leave the option out, or correct the file")]
    Contradiction {
        /// What the file says.
        file: String,
        /// What the user says.
        user: String,
    },
    /// Units that this file cannot have.
    #[error("units are {0}; files are in m and rad")]
    Units(String),
    /// A row out of place.
    #[error("row \"{}\" is out of order; rows are base, 1, 2, …, tool", quoted(.0))]
    Order(String),
    /// A coordinate that no entry declares.
    #[error("coordinate \"{}\" is not in `coordinates`; add it", quoted(.0))]
    Coordinate(String),
    /// A unit that is not known.
    #[error("\"{}\" is not a known unit here; write one of {known}", quoted(word))]
    UnknownUnit {
        /// As it is written.
        word: String,
        /// Those that are known.
        known: String,
    },
    /// More or fewer cells than columns.
    #[error("the row has {found} cells but the header has {expected}; give each cell a column")]
    Cells {
        /// How many there are.
        found: usize,
        /// How many columns there are.
        expected: usize,
    },
    /// A variable where a number belongs.
    #[error("{column} holds a variable; only theta or d may vary, so write a number")]
    Variable {
        /// Column.
        column: String,
    },
    /// Two variables in one row.
    #[error(
        "theta holds the variable {} and d the variable {}; a joint has one variable: write a number for the other",
        quoted(turn),
        quoted(slide)
    )]
    TwoVariables {
        /// In theta.
        turn: String,
        /// In d.
        slide: String,
    },
    /// A kind that contradicts the variable.
    #[error("kind is {kind}, but {column} holds the variable; correct one of the two")]
    OtherKind {
        /// The kind.
        kind: String,
        /// The column with the variable.
        column: String,
    },
    /// A fixed row with a variable.
    #[error("kind is fixed, but the row holds a variable; correct one of the two")]
    FixedMoves,
    /// An offset that may be of d.
    #[error("the joint is prismatic, so the offset may belong to d; add it to d, or name the column theta_offset")]
    OffsetOfSlide,
    /// Swapped limits.
    #[error("the lower limit is above the upper limit; swap them")]
    Limits,
    /// A quantity of a coordinate is unknown.
    #[error("quantity is \"{}\"; write angle or length", quoted(.0))]
    Quantity(String),
    /// Contradictory screw axes.
    #[error("{0}")]
    Axes(String),
    /// Rows and joints do not match.
    #[error(transparent)]
    Rows(#[from] denavit_dh::conventions::RowsError),
    /// A twist that moves nothing.
    #[error(transparent)]
    Twist(#[from] TwistError),
    /// The parts do not form a chain.
    #[error(transparent)]
    Chain(#[from] ChainError),
}

/// Whether a text holds a table, by its column headings, not by its file name.
pub fn holds_table(text: &str) -> bool {
    rows::holds_header(text)
}

/// Reads a robot from CSV, Markdown or JSON text; `file` is used in messages, and its stem where the text gives no robot's
/// name. `given` applies where the file states nothing.
///
/// # Errors
/// The first thing that is wrong, with file, line, column and element.
///
/// # Examples
/// ```
/// use denavit_export::sources::{self, Source, Stated};
/// let text = "Joint;Alpha [deg];a (mm);d (mm);θ\n1;90;0;162,5;q1\n2;0;-425;0;q2 - 90°\n";
/// let Source::Table { table, .. } = sources::read("manual.csv", text, Stated::default())? else { panic!() };
/// assert_eq!((table.rows[1].a(), table.rows[2].a()), (0.0, -0.425));
/// # Ok::<(), sources::SourceError>(())
/// ```
pub fn read(file: &str, text: &str, given: Stated) -> Result<Source, SourceError> {
    read_whole(file, text, given).map(|read| read.source)
}

/// The same, with an inventory of the file.
///
/// # Errors
/// As [`read`].
pub fn read_whole(file: &str, text: &str, given: Stated) -> Result<Read, SourceError> {
    match content(file, text, given)? {
        Content::Whole(read) => Ok(read),
        Content::Rows(rows) => table::of_rows(rows, given),
    }
}

pub(crate) fn is_table_header(headings: &[String]) -> bool {
    rows::are_headings(headings)
}

/// A D-H table in a YAML document.
pub(crate) fn of_cells(file: &str, cells: &Cells, given: Stated) -> Result<Read, SourceError> {
    table::of_rows(rows::Rows::of_cells(file, cells)?, given)
}

/// What a file holds.
enum Content<'a> {
    /// Something that needs no choice.
    Whole(Read),
    /// A D-H table as rows.
    Rows(rows::Rows<'a>),
}

fn content<'a>(file: &'a str, text: &str, given: Stated) -> Result<Content<'a>, SourceError> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let trimmed = text.trim_start();
    if trimmed.is_empty() {
        return Err(SourceError::at(place(file, 1, "file"), SourceErrorKind::Empty));
    }
    if trimmed.starts_with('{') {
        return json(file, text, given).map(Content::Whole);
    }
    let rows = rows::Rows::read(file, text)?;
    if rows.has("wx") {
        return poe::of_rows(rows).map(Content::Whole);
    }
    let wrong = |kind| Err(SourceError::at(place(file, rows.header_line(), "header"), kind));
    if let Some(heading) = rows.heading("r").filter(|_| !(rows.has("a") && rows.has("d"))) {
        return wrong(SourceErrorKind::Ambiguous(heading.written.clone()));
    }
    let turns = rows.has("theta") || rows.has("offset");
    if turns && ["d", "alpha", "a"].iter().all(|name| rows.has(name)) {
        return Ok(Content::Rows(rows));
    }
    wrong(SourceErrorKind::Columns { found: rows.columns().join(", ") })
}

/// The same, in the units that the headings of alpha and a state.
fn as_headed(rows: &rows::Rows, read_as: ReadAs) -> ReadAs {
    let unit = |name| rows.heading(name).and_then(|heading| heading.unit);
    let (angle, length) = (unit("alpha").unwrap_or(read_as.angle), unit("a").unwrap_or(read_as.length));
    ReadAs { length, angle, ..read_as }
}

/// A table to match a robot against, in one of its possible readings.
#[derive(Debug, Clone, PartialEq)]
pub struct VendorReading {
    /// The numbers.
    pub table: VendorTable,
    /// How they are read.
    pub read_as: ReadAs,
    /// Whether this is one of several possible choices, not stated by anyone.
    pub tried: bool,
    /// Whether file or user state otherwise.
    pub against_what_is_stated: bool,
}

/// Reads a table to match a robot against: numbers keep their written text; base and tool frames are free, whatever the
/// file says. The first reading is the one that [`read`] takes; then those that differ in convention
/// or units if these are not stated; last those that contradict what is stated.
///
/// # Errors
/// As [`read`]. Screw axes count as their distal table.
pub fn read_vendor_table(file: &str, text: &str, given: Stated) -> Result<Vec<VendorReading>, SourceError> {
    let alone = |table, convention| {
        let read_as = ReadAs { convention, length: Unit::Metre, angle: Unit::Radian };
        vec![VendorReading { table, read_as, tried: false, against_what_is_stated: false }]
    };
    match content(file, text, given)? {
        Content::Whole(Read { source: Source::Table { table, convention }, .. }) => {
            Ok(alone(VendorTable::of(&table, convention, false), convention))
        }
        Content::Whole(Read { source: Source::Poe(chain), .. }) => {
            let made = denavit_dh::convert::table(&chain, &denavit_dh::Options::default())
                .map_err(|error| SourceError::at(place(file, 1, "file"), error.into()))?;
            Ok(alone(VendorTable::of(&made.value, Convention::Distal, false), Convention::Distal))
        }
        Content::Rows(rows) => readings(&rows, given),
    }
}

/// Notes on a vendor's table: what [`read_vendor_table`] does not read, and rows that it reads as fixed frames.
///
/// # Errors
/// As [`read_vendor_table`].
pub fn vendor_notes(file: &str, text: &str, given: Stated) -> Result<Vec<String>, SourceError> {
    let notes = |notes: &[Note]| notes.iter().map(ToString::to_string).collect::<Vec<_>>();
    match content(file, text, given)? {
        Content::Whole(read) => Ok(notes(&read.notes)),
        Content::Rows(rows) => {
            let mut said = table::fixed_frames(&rows, given)?;
            said.extend(notes(&rows.notes));
            Ok(said)
        }
    }
}

fn readings(rows: &rows::Rows, given: Stated) -> Result<Vec<VendorReading>, SourceError> {
    rows.known_units_only()?;
    let stated = table::stated(rows, given)?;
    let (first, _) = table::assumed(rows, stated)?;
    let heads =
        |names: &[&str]| names.iter().all(|name| rows.heading(name).is_none_or(|heading| heading.unit.is_some()));
    let angles_in_headings = heads(&["theta", "offset", "alpha", "beta"]);
    let lengths_in_headings = heads(&["d", "a"]);
    let mut found: Vec<VendorReading> = Vec::new();
    let conventions = match first.convention {
        Convention::Distal | Convention::Proximal => vec![Convention::Distal, Convention::Proximal],
        other => vec![other],
    };
    // What is read first, then the units that tables usually have.
    let units = |first: Unit, usual: [Unit; 2]| {
        let others = usual.into_iter().filter(move |unit| *unit != first);
        std::iter::once(first).chain(others).collect::<Vec<_>>()
    };
    let angles = units(first.angle, [Unit::Radian, Unit::Degree]);
    let lengths = units(first.length, [Unit::Metre, Unit::Millimetre]);
    for convention in conventions {
        for angle in angles.iter().copied() {
            for length in lengths.iter().copied() {
                let read_as = ReadAs { convention, length, angle };
                let contradicts = stated.convention.is_some_and(|stated| stated != convention)
                    || (stated.angle.is_some_and(|stated| stated != angle) && !angles_in_headings)
                    || (stated.length.is_some_and(|stated| stated != length) && !lengths_in_headings);
                let table = match table::vendor_of_rows(rows, read_as, true) {
                    Ok(table) => table,
                    // A row with beta is not proximal.
                    Err(_) if read_as != first => continue,
                    Err(error) => return Err(error),
                };
                let known = found.iter().any(|other| other.table == table);
                if !known || read_as == first {
                    found.retain(|other| other.table != table);
                    found.push(VendorReading {
                        table,
                        read_as: as_headed(rows, read_as),
                        tried: read_as != first,
                        against_what_is_stated: contradicts,
                    });
                }
            }
        }
    }
    // What headings state may be a slip, too.
    for angle in angles {
        for length in lengths.iter().copied() {
            let read_as = ReadAs { length, angle, ..first };
            let table = table::vendor_of_rows(rows, read_as, false)?;
            if !found.iter().any(|other| other.table == table) {
                found.push(VendorReading { table, read_as, tried: true, against_what_is_stated: true });
            }
        }
    }
    found.sort_by_key(|reading| (reading.against_what_is_stated, reading.tried));
    Ok(found)
}

/// Prefixes of the schemas of calibration results.
const CORRECTIONS: [&str; 2] = ["denavit.calibration/", "denavit.prior/"];

fn json(file: &str, text: &str, given: Stated) -> Result<Read, SourceError> {
    let wrong = |error: serde_json::Error| {
        let column = (error.column() > 0).then(|| error.column());
        let kind = SourceErrorKind::Json(error.to_string());
        SourceError { column, ..SourceError::at(place(file, error.line(), "file"), kind) }
    };
    let value: serde_json::Value = serde_json::from_str(text).map_err(wrong)?;
    if modern_robotics::is_one(&value) {
        return modern_robotics::of_value(file, text, &value, given);
    }
    let schema = value.get("schema").and_then(serde_json::Value::as_str).unwrap_or_default().to_owned();
    let (source, shape) = match schema.as_str() {
        crate::formats::json::SCHEMA => {
            (table::of_file(file, &serde_json::from_str(text).map_err(wrong)?)?, keys::TABLE)
        }
        crate::poe::SCHEMA => {
            (poe::of_file(file, &serde_json::from_str(text).map_err(wrong)?).map(Source::Poe)?, keys::POE)
        }
        found => {
            let is_calibration = CORRECTIONS.iter().any(|known| found.starts_with(known));
            let robot = value.get("robot").and_then(serde_json::Value::as_str).unwrap_or("the robot").to_owned();
            let kind = if is_calibration {
                SourceErrorKind::Corrections { file: file.to_owned(), robot }
            } else {
                SourceErrorKind::Schema(schema)
            };
            return Err(SourceError::at(place(file, 1, "schema"), kind));
        }
    };
    let (notes, inventory) = keys::unknown(file, text, &value, &shape);
    Ok(Read { source, assumed: Vec::new(), notes, inventory })
}

/// The coordinates of a JSON file; lower and upper limits are in the order of the original robot, even if swapped.
fn coordinates_of(file: &str, entries: &[CoordinateEntry]) -> Result<Vec<Coordinate>, SourceError> {
    let coordinate = |entry: &CoordinateEntry| {
        let at = || place(file, 1, format!("coordinate \"{}\"", entry.name));
        if !["angle", "length"].contains(&entry.quantity.as_str()) {
            return Err(SourceError::at(at(), SourceErrorKind::Quantity(entry.quantity.clone())));
        }
        Ok(entry.coordinate())
    };
    entries.iter().map(coordinate).collect()
}

fn place(file: &str, line: usize, element: impl Into<String>) -> Place {
    Place { file: file.to_owned(), line, element: element.into() }
}

/// Every JSON source is in m and rad.
fn in_si(file: &str, units: &UnitsEntry) -> Result<(), SourceError> {
    if units.length == "m" && units.angle == "rad" {
        return Ok(());
    }
    let units = format!("{} and {}", units.length, units.angle);
    Err(SourceError::at(place(file, 1, "units"), SourceErrorKind::Units(units)))
}

/// Index of the coordinate that a JSON joint names.
fn coordinate_of(file: &str, joint: &str, name: &str, coordinates: &[Coordinate]) -> Result<usize, SourceError> {
    coordinates.iter().position(|coordinate| coordinate.name == name).ok_or_else(|| {
        let kind = SourceErrorKind::Coordinate(name.to_owned());
        SourceError::at(place(file, 1, format!("joint \"{joint}\"")), kind)
    })
}

fn stem(file: &str) -> String {
    let name = file.rsplit(['/', '\\']).next().unwrap_or(file);
    name.split('.').next().unwrap_or(name).to_owned()
}
