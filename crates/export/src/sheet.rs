//! The data of a table document: the table, how to show it, and notes.

use crate::numbers::Units;
use denavit_dh::{Convention, ConventionRow, Motion, RowLabel, Table, TableJoint};
use denavit_model::chain::{Coordinate, Quantity};
use denavit_model::notes::Note;

/// A table with everything in its document.
#[derive(Debug, Clone)]
pub struct Sheet<'a> {
    /// The numbers.
    pub table: &'a Table,
    /// How they are grouped.
    pub convention: Convention,
    /// Units of documents for people.
    pub units: Units,
    /// Numbers not read as written, and other findings.
    pub notes: &'a [Note],
    /// Where the robot came from: a file's name.
    pub source: &'a str,
    /// How the gauge was chosen, in words.
    pub gauge: &'a str,
}

/// A row ready for a document: cells of text.
pub struct TextRow {
    /// `base`, `1` … `n`, `tool`.
    pub label: String,
    /// Joint name, or empty.
    pub joint: String,
    /// Kind, or empty.
    pub kind: String,
    /// The numbers, in the order of [`Sheet::number_columns`]; empty where the row has none.
    pub numbers: Vec<String>,
    /// Limits, or empty.
    pub limits: String,
}

impl Sheet<'_> {
    /// The convention of the rows: Hayati's wherever a row has beta.
    pub fn shown_convention(&self) -> Convention {
        let hayati = self.table.rows.iter().any(|row| row.beta().is_some());
        if hayati { Convention::Hayati } else { self.convention }
    }

    /// One sentence on how a row is to be read.
    pub fn row_formula(&self) -> &'static str {
        match self.shown_convention() {
            Convention::Distal | Convention::Paper => "row i = Rz(θ) Tz(d) Rx(α) Tx(a)",
            Convention::Proximal => "row i = Rx(α) Tx(a) Rz(θ) Tz(d)",
            Convention::Hayati => "row i = Rz(θ) Tz(d) Rx(α) Tx(a), with β: Rz(θ) Tz(d) Tx(a) Rx(α) Ry(β)",
        }
    }

    /// The convention's name in words.
    pub fn convention_words(&self) -> &'static str {
        match self.shown_convention() {
            Convention::Distal => "distal (standard) Denavit-Hartenberg",
            Convention::Proximal => "proximal (modified, Craig) Denavit-Hartenberg",
            Convention::Paper => "Denavit-Hartenberg in the paper's form",
            Convention::Hayati => "Hayati-Mirmirani",
        }
    }

    /// `6R`, `RRPH`, …: one letter a joint, base to tip; a count for a run of one kind.
    pub fn kinds(&self) -> String {
        let letters: Vec<char> =
            self.table.joints.iter().map(|joint| joint.motion.word().to_uppercase().remove(0)).collect();
        match letters.first() {
            None => "no joints".to_owned(),
            Some(first) if letters.len() > 3 && letters.iter().all(|letter| letter == first) => {
                format!("{}{first}", letters.len())
            }
            Some(_) => letters.into_iter().collect(),
        }
    }

    /// Rows in the sheet's convention.
    pub fn rows(&self) -> Vec<ConventionRow> {
        self.table.convention_rows(self.shown_convention())
    }

    /// Names of the numbers that the rows have, in the order in which the convention applies them.
    pub fn number_columns(&self) -> Vec<&'static str> {
        match self.shown_convention() {
            Convention::Distal | Convention::Paper => vec!["theta", "d", "alpha", "a"],
            Convention::Proximal => vec!["alpha", "a", "theta", "d"],
            Convention::Hayati => vec!["theta", "d", "alpha", "a", "beta"],
        }
    }

    /// Every row as text; `variable` writes the symbol of coordinate k (counted from 1).
    pub fn text_rows(&self, variable: impl Fn(usize) -> String) -> Vec<TextRow> {
        let columns = self.number_columns();
        let rows = self.rows();
        let text = |row: &ConventionRow| {
            let joint = match row.label {
                RowLabel::Joint(index) => Some(&self.table.joints[index]),
                _ => None,
            };
            let numbers = columns.iter().map(|column| self.cell(column, row, joint, &variable)).collect();
            let label = match row.label {
                RowLabel::Base => "base".to_owned(),
                RowLabel::Joint(index) => (index + 1).to_string(),
                RowLabel::Tool => "tool".to_owned(),
            };
            TextRow {
                label,
                joint: joint.map_or_else(String::new, |joint| joint.name.clone()),
                kind: joint.map_or("", |joint| joint.motion.word()).to_owned(),
                numbers,
                limits: joint.map_or_else(String::new, |joint| self.limits(joint)),
            }
        };
        rows.iter().map(text).collect()
    }

    fn cell(
        &self,
        column: &str,
        row: &ConventionRow,
        joint: Option<&TableJoint>,
        variable: impl Fn(usize) -> String,
    ) -> String {
        let is_angle = ["theta", "alpha", "beta"].contains(&column);
        let value = match column {
            "theta" => row.theta,
            "d" => row.d,
            "alpha" => row.alpha,
            "a" => row.a,
            _ => row.beta,
        };
        let Some(value) = value else { return String::new() };
        let number = if is_angle { self.units.angle(value) } else { self.units.length(value) };
        let moved = joint.and_then(|joint| {
            let factor = match (column, joint.motion) {
                ("theta", Motion::Revolute | Motion::Helical(_)) | ("d", Motion::Prismatic) => joint.scale,
                ("d", Motion::Helical(pitch)) => joint.scale * pitch.metres_per_radian(),
                _ => return None,
            };
            Some((factor, variable(joint.coordinate + 1)))
        });
        let Some((factor, symbol)) = moved else { return number };
        let factor = crate::numbers::decimal(factor, 9);
        let term = match factor.as_str() {
            "1" => symbol,
            "-1" => format!("-{symbol}"),
            factor => format!("{factor} {symbol}"),
        };
        match number.strip_prefix('-') {
            _ if number == "0" => term,
            Some(positive) => format!("{term} - {positive}"),
            None => format!("{term} + {number}"),
        }
    }

    fn limits(&self, joint: &TableJoint) -> String {
        let coordinate = &self.table.coordinates[joint.coordinate];
        if coordinate.name != joint.name {
            return format!("follows {}", coordinate.name);
        }
        self.limits_of(coordinate)
    }

    /// Limits of a coordinate with their unit.
    pub fn limits_of(&self, coordinate: &Coordinate) -> String {
        let unit = match coordinate.quantity {
            Quantity::Angle => self.units.angle_word().to_owned(),
            Quantity::Length => format!(" {}", self.units.length_word()),
        };
        let unit = if unit == "rad" { " rad".to_owned() } else { unit };
        match coordinate.limits.range {
            Some((lower, upper)) => {
                let show = |value: f64| self.units.value(value, coordinate.quantity);
                format!("{} … {}{unit}", show(lower), show(upper))
            }
            None if coordinate.continuous => "endless".to_owned(),
            None => "none stated".to_owned(),
        }
    }

    /// Upper bound of the tip displacement by all numbers that were not read as written, m, and their count.
    pub fn displacement_bound(&self) -> (f64, usize) {
        let read = |note: &&Note| matches!(note, Note::IntendedAngle { .. } | Note::TreatedAsParallel { .. });
        let moving: Vec<f64> = self.notes.iter().filter(read).map(Note::tip_moves).collect();
        (moving.iter().sum::<f64>() + 0.0, moving.len())
    }
}
