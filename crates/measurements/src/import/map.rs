//! Which column is what: a small TOML file, or the same on the command line; and a draft of one.

use super::super::units::{Units, UnitsError};
use super::euler::EulerOrder;
use super::grid::{Grid, number};
use super::plain;
use denavit_model::{Chain, Quantity};
use std::fmt::Write as _;
use thiserror::Error;
use toml::{Table, Value};

/// Not a map.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("{file}: {reason}")]
pub struct MapError {
    /// The file, or `--columns`.
    pub file: String,
    /// What is wrong and what to write.
    pub reason: String,
}

/// What a file's columns mean.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Map {
    /// Units of lengths and angles that state none, as `mm,deg`.
    pub units: Option<Units>,
    /// Columns of the joints, in the chain's order.
    pub joints: Vec<String>,
    /// Column names of the contract, and the columns of the file that are added up for each.
    pub columns: Vec<(String, Vec<String>)>,
    /// Three columns of angles and their order.
    pub euler: Option<(EulerOrder, [String; 3])>,
    /// Three columns of a rotation vector.
    pub rotation_vector: Option<[String; 3]>,
    /// Four columns of a quaternion, x, y, z, w.
    pub quaternion: Option<[String; 4]>,
}

impl Map {
    /// Reads a map.
    ///
    /// # Errors
    /// The text is not TOML, or not a map.
    pub fn read(file: &str, text: &str) -> Result<Self, MapError> {
        let failed = |reason: String| MapError { file: file.into(), reason };
        let table: Table =
            text.parse().map_err(|error: toml::de::Error| failed(error.to_string().trim_end().into()))?;
        let mut map = Self::default();
        for (key, value) in &table {
            let wrong = |wanted: &str| failed(format!("\"{key}\" must be {wanted}"));
            match key.as_str() {
                "units" => {
                    let units = value.as_str().ok_or_else(|| wrong("a text such as \"mm,deg\""))?;
                    map.units = Some(units.parse().map_err(|error: UnitsError| failed(error.to_string()))?);
                }
                "joints" => map.joints = names(value).ok_or_else(|| wrong("a list of columns, one per joint"))?,
                "euler" => {
                    let order = value.get("order").and_then(Value::as_str);
                    let order = order.ok_or_else(|| wrong("{ order = \"XYZ\", columns = [\"…\", \"…\", \"…\"] }"))?;
                    let order = order.parse().map_err(|error: super::euler::EulerError| failed(error.to_string()))?;
                    let columns = value.get("columns").and_then(names).and_then(|names| names.try_into().ok());
                    map.euler = Some((order, columns.ok_or_else(|| wrong("{ order = \"XYZ\", columns = [three] }"))?));
                }
                "rotation_vector" => {
                    let columns = names(value).and_then(|names| names.try_into().ok());
                    map.rotation_vector = Some(columns.ok_or_else(|| wrong("a list of three columns"))?);
                }
                "quaternion" => {
                    let order = value.get("order").and_then(Value::as_str).unwrap_or("xyzw");
                    let columns: Option<[String; 4]> =
                        value.get("columns").and_then(names).and_then(|names| names.try_into().ok());
                    let columns = columns.ok_or_else(|| wrong("{ order = \"wxyz\", columns = [four] }"))?;
                    map.quaternion = Some(quaternion_order(order, &columns).ok_or_else(|| {
                        failed(format!(
                            "quaternion: order \"{order}\" is not one of x, y, z, w, each once; write wxyz or xyzw"
                        ))
                    })?);
                }
                _ => {
                    let columns = names(value).ok_or_else(|| wrong("a column, or a list of columns to add up"))?;
                    map.columns.push((key.clone(), columns));
                }
            }
        }
        Ok(map)
    }

    /// Reads `x=Column,y=Other column [mm]` of a command line.
    ///
    /// # Errors
    /// A part without `=`.
    pub fn of_words(words: &str) -> Result<Self, MapError> {
        let mut map = Self::default();
        for word in words.split(',') {
            let (name, column) = word.split_once('=').ok_or_else(|| MapError {
                file: "‹columns›".into(),
                reason: format!("\"{word}\" is not NAME=COLUMN; write x=X1,y=Y1 or the name of a TOML file"),
            })?;
            map.columns.push((name.trim().into(), column.split('+').map(|part| part.trim().into()).collect()));
        }
        Ok(map)
    }
}

/// Four columns in the order of a word such as `wxyz`, as x, y, z, w; `None` where the word is not an order.
pub fn quaternion_order(order: &str, columns: &[String; 4]) -> Option<[String; 4]> {
    let letters: Vec<char> = order.chars().collect();
    let at = |letter: char| letters.iter().position(|c| *c == letter).filter(|_| letters.len() == 4);
    Some([columns[at('x')?].clone(), columns[at('y')?].clone(), columns[at('z')?].clone(), columns[at('w')?].clone()])
}

fn names(value: &Value) -> Option<Vec<String>> {
    match value {
        Value::String(name) => Some(vec![name.clone()]),
        Value::Array(list) => list.iter().map(|name| name.as_str().map(str::to_owned)).collect(),
        _ => None,
    }
}

/// A draft of a map: what is certain, and every column of the file with its first value to choose from.
pub(super) fn draft(file: &str, grid: &Grid, chain: &Chain) -> String {
    // A JSON string is a TOML string.
    let quoted = |text: &str| serde_json::Value::from(text).to_string();
    let joints = chain.coordinates();
    let guessed = joint_columns(grid, chain);
    let units = likely_units(grid, chain, &guessed);
    let mut text = format!(
        "# Which column of {file} is what; see docs/measurements.md.\n\
         units = \"{units}\"   # of columns without a unit; guessed from the size of the numbers: check\n"
    );
    let listed: Vec<String> = guessed.iter().map(|name| quoted(name.map_or("?", String::as_str))).collect();
    let order: Vec<&str> = joints.iter().map(|joint| joint.name.as_str()).collect();
    let _ = writeln!(text, "joints = [{}]   # {}", listed.join(", "), order.join(", "));
    for (axis, column) in ["x", "y", "z"].into_iter().zip(place_columns(grid)) {
        let _ = writeln!(text, "{axis} = {}", quoted(column.map_or("?", String::as_str)));
    }
    text += "# euler = { order = \"XYZ\", columns = [\"\", \"\", \"\"] }         # rotating axes; xyz: fixed axes\n\
             # quaternion = { order = \"wxyz\", columns = [\"\", \"\", \"\", \"\"] }\n\
             # temperature = \"\"   time = \"\"   payload = \"\"   \"JOINT.approach\" = \"\"\n# columns of the file, with the first row's value:\n";
    for (k, name) in grid.names.iter().enumerate() {
        let first = grid.rows.first().and_then(|(_, cells)| cells.get(k)).map_or("", String::as_str);
        let _ = writeln!(text, "#   {} = {first}", quoted(name));
    }
    text
}

/// Joint readings above this are degrees, those below radians.
const MOST_RADIANS: f64 = 7.0;
/// Positions beyond this many metres are millimetres.
const MOST_METRES: f64 = 20.0;

/// The likely units of the numbers, by their size; mm and deg where nothing shows it.
fn likely_units(grid: &Grid, chain: &Chain, joints: &[Option<&String>]) -> Units {
    let largest = |name: &String| {
        let column = grid.column(name)?;
        let cells = grid.rows.iter().filter_map(|(_, row)| number(row.get(column)?, grid.decimal_comma));
        cells.map(f64::abs).max_by(f64::total_cmp)
    };
    let of_angles = joints.iter().zip(chain.coordinates()).filter(|(_, c)| c.quantity == Quantity::Angle);
    let angle = of_angles.filter_map(|(name, _)| largest((*name)?)).max_by(f64::total_cmp);
    let length = place_columns(grid).into_iter().filter_map(|name| largest(name?)).max_by(f64::total_cmp);
    let degrees: Units = Units { length: 1e-3, angle: std::f64::consts::PI / 180.0 };
    Units {
        length: if length.is_some_and(|length| length <= MOST_METRES) { 1.0 } else { degrees.length },
        angle: if angle.is_some_and(|angle| angle <= MOST_RADIANS) { 1.0 } else { degrees.angle },
    }
}

fn small(text: &str) -> String {
    text.to_lowercase()
}

/// The likely column of each joint, in the chain's order: by the joint's name, or by a number such as joint_1, A1,
/// axis 1, J1.
pub(super) fn joint_columns<'a>(grid: &'a Grid, chain: &Chain) -> Vec<Option<&'a String>> {
    let numbered = |k: usize| {
        grid.names.iter().find(|name| {
            let digits: String = name.chars().filter(char::is_ascii_digit).collect();
            let letters: String = small(name).chars().take_while(|c| c.is_alphabetic()).collect();
            digits == (k + 1).to_string() && ["joint", "j", "a", "axis", "q"].contains(&letters.as_str())
        })
    };
    let own = |name: &str| grid.names.iter().find(|column| small(column).starts_with(&small(name)));
    chain.coordinates().iter().enumerate().map(|(k, joint)| own(&joint.name).or_else(|| numbered(k))).collect()
}

/// The likely columns of the measured x, y, z.
pub(super) fn place_columns(grid: &Grid) -> [Option<&String>; 3] {
    ["x", "y", "z"].map(|axis| {
        // Without a unit in brackets: T_x [mm].
        let ends = |name: &&String| plain(name).trim_end_matches(|c: char| !c.is_alphanumeric()).ends_with(axis);
        let exact = grid.names.iter().find(|name| plain(name) == axis);
        exact.or_else(|| grid.names.iter().find(ends))
    })
}
