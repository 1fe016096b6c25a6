//! JSON in rad and m: everything needed to rebuild the chain.

use super::{Format, RenderError};
use crate::sheet::Sheet;
use denavit_dh::RowLabel;
use denavit_model::chain::{Coordinate, Limits, Quantity};
use denavit_model::notes::Note;
use denavit_model::settings::plain;
use serde::{Deserialize, Serialize};

/// JSON.
pub const FORMAT: Format =
    Format { name: "json", extension: "json", purpose: "everything, rad and m; denavit reads it back", render };

/// The schema's name and version.
pub const SCHEMA: &str = "denavit.table/1";

/// A table's file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TableFile {
    /// [`SCHEMA`].
    pub schema: String,
    /// The robot's name.
    pub robot: String,
    /// Base link.
    pub base: String,
    /// Tip link.
    pub tip: String,
    /// Where it came from.
    #[serde(default)]
    pub source: String,
    /// `distal`, `proximal`, `paper` or `hayati`.
    pub convention: String,
    /// How the gauge was chosen: `simple`, `paper`, or `file` where the source has the numbers.
    #[serde(default)]
    pub gauge: String,
    /// Always `m` and `rad`.
    pub units: UnitsEntry,
    /// What moves it.
    pub coordinates: Vec<CoordinateEntry>,
    /// From base to tip.
    pub joints: Vec<JointEntry>,
    /// base, 1 … n, tool.
    pub rows: Vec<RowEntry>,
    /// Upper bound of the tip displacement by all numbers that were not read as written, m.
    #[serde(default)]
    pub tip_moves_at_most: f64,
    /// Numbers not read as written, and other findings.
    #[serde(default)]
    pub notes: Vec<NoteEntry>,
}

/// Units of a file.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct UnitsEntry {
    /// `m`
    pub length: String,
    /// `rad`
    pub angle: String,
}

/// A coordinate.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CoordinateEntry {
    /// Name.
    pub name: String,
    /// `angle` or `length`.
    pub quantity: String,
    /// Continuous joint.
    #[serde(default)]
    pub continuous: bool,
    /// Limits, where stated.
    pub limits: Option<LimitsEntry>,
}

/// Limits, rad or m.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LimitsEntry {
    /// Lowest.
    pub lower: f64,
    /// Highest.
    pub upper: f64,
    /// Per second.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub velocity: Option<f64>,
    /// N·m or N.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub effort: Option<f64>,
}

/// A joint.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct JointEntry {
    /// Name.
    pub name: String,
    /// `revolute`, `prismatic` or `helical`.
    pub kind: String,
    /// Name of the coordinate that moves it.
    pub coordinate: String,
    /// m/rad.
    pub pitch: f64,
    /// The paper's normalisation factor, or a mimic joint's multiplier.
    pub scale: f64,
}

/// A row; numbers that its convention does not have are absent.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RowEntry {
    /// `base`, `1` … `n`, `tool`.
    pub row: String,
    /// rad.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub theta: Option<f64>,
    /// m.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub d: Option<f64>,
    /// rad.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub alpha: Option<f64>,
    /// m.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub a: Option<f64>,
    /// rad.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub beta: Option<f64>,
}

/// A note.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct NoteEntry {
    /// `intended_angle`, `treated_as_parallel`, `far_number`, `mended`, `split`, `ends_at_tool`.
    pub kind: String,
    /// The sentence that a terminal shows.
    pub message: String,
    /// File, line and element, if it concerns a file.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub file: Option<String>,
    /// Counted from 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub line: Option<usize>,
    /// The element.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub element: Option<String>,
    /// The literal.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub written: Option<String>,
    /// The multiple of π that it was read as.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub read_as: Option<String>,
    /// At most, m.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tip_moves_at_most: Option<f64>,
}

impl From<&Note> for NoteEntry {
    fn from(note: &Note) -> Self {
        let (kind, place) = match note {
            Note::Corrected { place, .. } => ("mended", Some(place)),
            Note::NotUnderstood { place, .. } => ("not_understood", Some(place)),
            Note::IntendedAngle { place, .. } => ("intended_angle", Some(place)),
            Note::TreatedAsParallel { .. } => ("treated_as_parallel", None),
            Note::FarNumber { .. } => ("far_number", None),
            Note::Split { place, .. } => ("split", Some(place)),
            Note::EndsAtTool { .. } => ("ends_at_tool", None),
            _ => ("note", None),
        };
        let (written, read_as) = match note {
            Note::IntendedAngle { written, read_as, .. } => (Some(written.clone()), Some(read_as.clone())),
            _ => (None, None),
        };
        let moves = note.tip_moves();
        Self {
            kind: kind.to_owned(),
            message: plain(note),
            file: place.map(|place| place.file.clone()),
            line: place.map(|place| place.line),
            element: place.map(|place| place.element.clone()),
            written,
            read_as,
            tip_moves_at_most: (moves > 0.0).then_some(moves),
        }
    }
}

impl From<&Coordinate> for CoordinateEntry {
    fn from(coordinate: &Coordinate) -> Self {
        let quantity = if coordinate.quantity == Quantity::Angle { "angle" } else { "length" };
        let limits = coordinate.limits;
        let entry = |(lower, upper)| LimitsEntry { lower, upper, velocity: limits.velocity, effort: limits.effort };
        Self {
            name: coordinate.name.clone(),
            quantity: quantity.to_owned(),
            continuous: coordinate.continuous,
            limits: limits.range.map(entry),
        }
    }
}

impl CoordinateEntry {
    /// The coordinate of the entry; an unknown quantity counts as an angle.
    pub fn coordinate(&self) -> Coordinate {
        let quantity = if self.quantity == "length" { Quantity::Length } else { Quantity::Angle };
        let limits = self.limits.as_ref().map_or_else(Limits::default, |entry| Limits {
            range: Some((entry.lower, entry.upper)),
            velocity: entry.velocity,
            effort: entry.effort,
        });
        Coordinate { name: self.name.clone(), quantity, limits, continuous: self.continuous }
    }
}

impl TableFile {
    /// The file of a sheet.
    pub fn of(sheet: &Sheet) -> Self {
        let table = sheet.table;
        let joints = table.joints.iter().map(|joint| JointEntry {
            name: joint.name.clone(),
            kind: joint.motion.word().to_owned(),
            coordinate: table.coordinates[joint.coordinate].name.clone(),
            pitch: joint.motion.pitch(),
            scale: joint.scale,
        });
        let label = |label| match label {
            RowLabel::Base => "base".to_owned(),
            RowLabel::Joint(index) => (index + 1).to_string(),
            RowLabel::Tool => "tool".to_owned(),
        };
        let rows = sheet.rows();
        let rows = rows.iter().map(|row| RowEntry {
            row: label(row.label),
            theta: row.theta,
            d: row.d,
            alpha: row.alpha,
            a: row.a,
            beta: row.beta,
        });
        Self {
            schema: SCHEMA.to_owned(),
            robot: table.name.clone(),
            base: table.base.clone(),
            tip: table.tip.clone(),
            source: sheet.source.to_owned(),
            convention: sheet.shown_convention().word().to_owned(),
            gauge: sheet.gauge.to_owned(),
            units: UnitsEntry { length: "m".into(), angle: "rad".into() },
            coordinates: table.coordinates.iter().map(CoordinateEntry::from).collect(),
            joints: joints.collect(),
            rows: rows.collect(),
            tip_moves_at_most: sheet.displacement_bound().0,
            notes: sheet.notes.iter().map(NoteEntry::from).collect(),
        }
    }
}

fn render(sheet: &Sheet) -> Result<String, RenderError> {
    let text = serde_json::to_string_pretty(&TableFile::of(sheet)).expect("every number in a table is finite");
    Ok(text + "\n")
}
