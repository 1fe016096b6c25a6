//! Converts any tracker's export to a measurement file: from bytes to the CSV of the contract.
//!
//! ```text
//! bytes ─► text (encoding) or sheet ─► cells under names (separator, units row) ─► columns of the contract ─► CSV, m and rad
//!                                                                  ▲
//!                                             names, --columns, --euler, --quaternion, --joints
//! ```
//! Line k of the CSV is line k of the file, so that messages about it point into the file.

mod euler;
mod grid;
mod map;
mod outline;
mod problem;
mod programs;
mod records;
mod sheet;

pub use euler::{AngleConvention, EulerError, EulerOrder, WrittenAngles};
pub use map::{Map, MapError, quaternion_order};
pub use outline::{FileColumn, outline};
pub use problem::ImportProblem;
pub use programs::{JointList, ProgramError, joints};

use super::known_columns::{KNOWN_COVARIATES, KNOWN_VALUES, OF_JOINTS};
use super::units::Units;
use crate::board::Sight;
use crate::plate::Plate;
use denavit_model::nalgebra::{Quaternion, Rotation3, UnitQuaternion, Vector3};
use denavit_model::units::Unit;
use denavit_model::{Chain, Quantity, Tips};
use grid::Grid;
use problem::Fault;
use std::sync::Arc;

/// What the user states about a file.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ImportOptions {
    /// Which column is what.
    pub map: Option<Map>,
    /// The order of columns that look like angles.
    pub euler: Option<EulerOrder>,
    /// Columns `rx, ry, rz` are a rotation vector.
    pub rotation_vector: bool,
    /// Columns `q1, q2, q3, q4` are a quaternion in this order of x, y, z, w, such as `wxyz`.
    pub quaternion: Option<String>,
    /// Joint values from another file, row by row.
    pub joints: Option<JointList>,
    /// The plate whose holes a column `hole` names.
    pub plate: Option<Plate>,
    /// The camera whose pixels are read.
    pub sight: Option<Sight>,
    /// The tips of which a column `tip` says which a row is of, where the robot is measured at several.
    pub tips: Option<Arc<Tips>>,
}

/// A file in the contract's form.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Imported {
    /// CSV.
    pub text: String,
    /// Whether it is in m and rad; else it is the file as it was, in the units that were stated.
    pub converted: bool,
    /// How columns were read, a line each; empty where nothing had to be decided.
    pub taken: Vec<String>,
    /// Names of the contract and the columns that they were read from.
    pub sources: Vec<(String, String)>,
    /// Angles of an orientation as they are written, row by row.
    pub angles: Option<WrittenAngles>,
    /// Line and name of what is not read: lines above the header, columns that a map does not name.
    pub ignored: Vec<(usize, String)>,
}

/// The quantity of a column of the contract.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Counts {
    Length,
    Angle,
    Time,
    /// °C
    Temperature,
    Mass,
    Plain,
}

/// A column of the contract and the cells that make it.
struct Output {
    name: String,
    /// Index of a column, its factor, its name as said.
    parts: Vec<(usize, f64)>,
    source: String,
}

/// The column that names a plate's holes.
struct Holes {
    plate: Plate,
    column: usize,
}

impl Holes {
    /// The cells x, y, z of a row; empty in a row with a posture alone.
    fn place(&self, line: usize, cells: &[String]) -> Result<[String; 3], Fault> {
        let name = cells.get(self.column).map_or("", |cell| cell.trim());
        if name.is_empty() {
            return Ok(<[String; 3]>::default());
        }
        if let Some(place) = self.plate.hole(name) {
            return Ok([place.x, place.y, 0.0].map(|value| value.to_string()));
        }
        let (plate, last) = (self.plate, self.plate.last());
        Err(Fault { line, problem: ImportProblem::Hole { plate, name: name.into(), last } })
    }
}

/// Name of that column.
const HOLE: &str = "hole";

/// Three or four columns of an orientation.
enum Orientation {
    None,
    /// The columns in the order of the rotations, and the index in that order of each in the file's order.
    Euler(EulerOrder, [Output; 3], [usize; 3]),
    Vector([Output; 3]),
    Quaternion([Output; 4]),
}

/// s per unit.
const TIMES: [(&str, f64); 6] =
    [("s", 1.0), ("sec", 1.0), ("seconds", 1.0), ("ms", 1e-3), ("min", 60.0), ("h", 3600.0)];
/// °C per unit: scales with another zero are refused.
const TEMPERATURES: [(&str, f64); 4] = [("°c", 1.0), ("c", 1.0), ("degc", 1.0), ("celsius", 1.0)];
/// kg per unit.
const MASSES: [(&str, f64); 3] = [("kg", 1.0), ("g", 1e-3), ("lb", 0.453_592_37)];

/// Names of three angles whose convention must be stated, with the axis of each.
const ANGLE_COLUMNS: [([&str; 3], Option<[usize; 3]>); 7] = [
    (["roll", "pitch", "yaw"], Some([0, 1, 2])),
    (["rx", "ry", "rz"], Some([0, 1, 2])),
    (["rotx", "roty", "rotz"], Some([0, 1, 2])),
    (["rotationx", "rotationy", "rotationz"], Some([0, 1, 2])),
    (["a", "b", "c"], None),
    (["w", "p", "r"], Some([0, 1, 2])),
    (["alpha", "beta", "gamma"], None),
];

/// Names of a quaternion whose order must be stated.
const QUATERNIONS: [[&str; 4]; 4] = [
    ["q1", "q2", "q3", "q4"],
    ["q0", "q1", "q2", "q3"],
    ["ox", "oy", "oz", "ow"],
    ["quatx", "quaty", "quatz", "quatw"],
];

/// Brings a file into the contract's form; one that has it already comes back as it is.
///
/// `units` are those of columns that name none.
pub(super) fn import(bytes: &[u8], chain: &Chain, units: Units, options: &ImportOptions) -> Result<Imported, Fault> {
    let asked = ImportOptions { sight: None, ..options.clone() } != ImportOptions::default();
    let untouched = || {
        let (text, _) = grid::decoded(bytes);
        Imported { text, converted: false, taken: Vec::new(), sources: Vec::new(), angles: None, ignored: Vec::new() }
    };
    let cells = match grid::read(bytes, &|name| names_a_joint(name, chain)) {
        Ok(cells) => cells,
        // The contract's own reader reports a text without rows.
        Err(Fault { problem: ImportProblem::NoRows, .. }) if !asked => return Ok(untouched()),
        Err(fault) => return Err(fault),
    };
    let named = cells.names.iter().any(|name| names_a_joint(name, chain));
    if !asked && !cells.is_sheet && !named && cells.separator == Some(',') {
        return Ok(untouched());
    }
    let mut work = Work { grid: &cells, chain, units, taken: cells.notes.clone(), ignored: cells.ignored.clone() };
    if let Some(units) = options.map.as_ref().and_then(|map| map.units) {
        work.units = units;
    }
    let outputs = match &options.map {
        Some(map) => work.mapped(map, options.joints.is_some())?,
        None => work.by_name()?,
    };
    let renamed = outputs.iter().any(|output| output.source != output.name);
    if !asked && cells.plain && !renamed {
        return Ok(untouched());
    }
    let orientation = work.orientation(options)?;
    let holes = options.plate.map(|plate| work.holes(plate, &outputs)).transpose()?;
    work.written(outputs, &orientation, options.joints.as_ref(), options.map.is_none(), holes.as_ref())
}

/// A map to start from.
///
/// # Errors
/// A file without rows, or a workbook that cannot be read; the message does not name the file.
pub fn draft(file: &str, bytes: &[u8], chain: &Chain) -> Result<String, ImportProblem> {
    let cells = grid::read(bytes, &|name| names_a_joint(name, chain)).map_err(|fault| fault.problem)?;
    Ok(map::draft(file, &cells, chain))
}

/// Names of a file's columns and below them its rows, as comma-separated text; `None` of a file that is just that.
///
/// # Errors
/// A workbook that cannot be read; the message does not name the file.
pub fn cells(bytes: &[u8]) -> Result<Option<String>, ImportProblem> {
    let grid = match grid::read(bytes, &|_| false) {
        Ok(grid) if grid.plain => return Ok(None),
        Ok(grid) => grid,
        Err(Fault { problem: ImportProblem::NoRows, .. }) if !grid::is_workbook(bytes) => return Ok(None),
        Err(fault) => return Err(fault.problem),
    };
    let mut out = csv::WriterBuilder::new().flexible(true).from_writer(Vec::new());
    let point = |cell: &String| match grid::number(cell, grid.decimal_comma) {
        Some(_) if grid.decimal_comma => cell.replace(',', "."),
        _ => cell.clone(),
    };
    let rows = grid.rows.iter().map(|(_, row)| row.iter().map(point).collect());
    for row in std::iter::once(grid.names.clone()).chain(rows) {
        out.write_record(row).expect("memory takes what is written");
    }
    let bytes = out.into_inner().expect("memory takes what is written");
    Ok(Some(String::from_utf8_lossy(&bytes).into_owned()))
}

/// Whether a column's name is that of a joint, apart from its case, its blanks and a unit in brackets.
fn names_a_joint(name: &str, chain: &Chain) -> bool {
    let own = plain(name);
    chain.coordinates().iter().any(|coordinate| coordinate.name == name || plain(&coordinate.name) == own)
}

struct Work<'a> {
    grid: &'a Grid,
    chain: &'a Chain,
    units: Units,
    taken: Vec<String>,
    ignored: Vec<(usize, String)>,
}

/// A name in the form that is compared: lower case, no unit in brackets, underscores for blanks and hyphens.
fn plain(name: &str) -> String {
    let own = bracketed(name).map_or(name, |(own, _)| own);
    own.trim().to_lowercase().replace([' ', '-'], "_")
}

/// The unit in brackets at the end of a name.
fn bracketed(name: &str) -> Option<(&str, &str)> {
    let name = name.trim();
    let open = name.rfind(['(', '['])?;
    let inside = name[open + 1..].strip_suffix([')', ']'])?;
    Some((name[..open].trim_end(), inside.trim()))
}

impl Work<'_> {
    fn in_header(&self, problem: ImportProblem) -> Fault {
        Fault { line: self.grid.header_line, problem }
    }

    fn counts(&self, name: &str) -> Counts {
        let coordinates = self.chain.coordinates();
        let of = |quantity: Quantity| if quantity == Quantity::Angle { Counts::Angle } else { Counts::Length };
        if let Some(joint) = coordinates.iter().find(|c| c.name == name) {
            return of(joint.quantity);
        }
        if let Some((joint, "velocity")) = name.rsplit_once('.') {
            return coordinates.iter().find(|c| c.name == joint).map_or(Counts::Plain, |c| of(c.quantity));
        }
        let place = name.strip_suffix(".std").unwrap_or(name);
        let target = place.strip_prefix(['x', 'y', 'z']).is_some_and(|rest| rest.chars().all(|c| c.is_ascii_digit()));
        match name {
            "time" => Counts::Time,
            "temperature" => Counts::Temperature,
            "payload" => Counts::Mass,
            _ if name.strip_suffix(".temperature").is_some_and(|joint| coordinates.iter().any(|c| c.name == joint)) => {
                Counts::Temperature
            }
            "distance" | "std" | "distance.std" => Counts::Length,
            "roll" | "pitch" | "yaw" => Counts::Angle,
            _ if target => Counts::Length,
            _ => Counts::Plain,
        }
    }

    /// The factor that converts a column to m, rad, s.
    fn factor(&self, column: &str, unit: Option<&str>, counts: Counts) -> Result<f64, Fault> {
        let of = |word: &str, words: &[(&str, f64)]| {
            words.iter().find(|(known, _)| *known == word).map(|(_, factor)| *factor)
        };
        // A dash in a row of units states none.
        let Some(unit) = unit.filter(|unit| !matches!(*unit, "-" | "–" | "—")) else {
            return Ok(match counts {
                Counts::Length => self.units.length,
                Counts::Angle => self.units.angle,
                _ => 1.0,
            });
        };
        let word = unit.to_lowercase();
        // A velocity by its quantity: deg/s.
        let word = if column.to_lowercase().contains("velocity") { word.trim_end_matches("/s") } else { &word };
        let measured = |quantity| Unit::of(word, quantity).map(Unit::in_si);
        let (quantity, found, known) = match counts {
            Counts::Length => ("lengths", measured(Quantity::Length), Unit::words(Quantity::Length)),
            Counts::Angle => ("angles", measured(Quantity::Angle), Unit::words(Quantity::Angle)),
            Counts::Time => ("times", of(word, &TIMES), "s, ms, min, h".to_owned()),
            Counts::Temperature => ("temperatures", of(word, &TEMPERATURES), "°C".to_owned()),
            Counts::Mass => ("masses", of(word, &MASSES), "kg, g, lb".to_owned()),
            Counts::Plain => return Ok(1.0),
        };
        found.ok_or_else(|| {
            let (column, unit) = (column.into(), unit.into());
            self.in_header(ImportProblem::Unit { column, unit, quantity, known })
        })
    }

    /// A column of the file by its name in a map, with or without a unit in brackets.
    fn part(&self, written: &str, wanted: &str, counts: Counts) -> Result<(usize, f64), Fault> {
        let named = bracketed(written);
        let index = self.grid.column(written).or_else(|| self.grid.column(named?.0));
        let index = index.ok_or_else(|| {
            self.in_header(ImportProblem::NoColumn {
                column: written.into(),
                wanted: wanted.into(),
                known: self.grid.names.iter().map(|name| format!("\"{name}\"")).collect::<Vec<_>>().join(", "),
            })
        })?;
        let own = bracketed(&self.grid.names[index]).map(|(_, unit)| unit);
        let unit = named.map(|(_, unit)| unit).or(self.grid.units[index].as_deref()).or(own);
        Ok((index, self.factor(&self.grid.names[index], unit, counts)?))
    }

    fn output(&self, name: &str, columns: &[String], counts: Counts) -> Result<Output, Fault> {
        let parts = columns.iter().map(|column| self.part(column, name, counts)).collect::<Result<Vec<_>, _>>()?;
        let said = parts.iter().map(|(index, _)| self.grid.names[*index].clone()).collect::<Vec<_>>().join(" + ");
        Ok(Output { name: name.into(), parts, source: said })
    }

    fn mapped(&mut self, map: &Map, joints_elsewhere: bool) -> Result<Vec<Output>, Fault> {
        let coordinates = self.chain.coordinates();
        let mut outputs = Vec::new();
        if !map.joints.is_empty() && map.joints.len() != coordinates.len() {
            return Err(self.in_header(ImportProblem::Count {
                found: format!("the map names columns of {} joints", map.joints.len()),
                wanted: coordinates.len().to_string(),
                fix: "list one column for each joint of the chain, in its order",
            }));
        }
        for (index, coordinate) in coordinates.iter().enumerate() {
            let own = || map.columns.iter().any(|(name, _)| *name == coordinate.name);
            let column = match map.joints.get(index) {
                Some(column) => column.clone(),
                None if own() || joints_elsewhere => continue,
                None => coordinate.name.clone(),
            };
            outputs.push(self.output(&coordinate.name, &[column], self.counts(&coordinate.name))?);
        }
        for (name, columns) in &map.columns {
            outputs.push(self.output(name, columns, self.counts(name))?);
        }
        let mut used: Vec<usize> = outputs.iter().flat_map(|output| output.parts.iter().map(|part| part.0)).collect();
        let angles = map.euler.iter().flat_map(|(_, columns)| columns).chain(map.rotation_vector.iter().flatten());
        let turning = angles.chain(map.quaternion.iter().flatten());
        used.extend(turning.filter_map(|name| Some(self.part(name, "", Counts::Plain).ok()?.0)));
        let left: Vec<&str> =
            (0..self.grid.names.len()).filter(|k| !used.contains(k)).map(|k| self.grid.names[k].as_str()).collect();
        if !left.is_empty() {
            self.taken.push(format!("left out because the map does not name them: {}", left.join(", ")));
            let line = self.grid.header_line;
            self.ignored.extend(left.iter().map(|name| (line, format!("column \"{name}\""))));
        }
        Ok(outputs)
    }

    /// The contract's name for a column's own name, apart from case, blanks and a unit.
    fn meaning(&self, name: &str) -> Option<String> {
        let joints = || self.chain.coordinates().iter().map(|coordinate| coordinate.name.clone());
        let of_joints = joints().flat_map(|joint| OF_JOINTS.map(|word| format!("{joint}.{word}")));
        let words = KNOWN_VALUES.iter().chain(&KNOWN_COVARIATES).map(|word| (*word).to_owned());
        let known: Vec<String> = joints().chain(words).chain(of_joints).collect();
        let target = |own: &str| {
            let digits = own.strip_prefix(['x', 'y', 'z'])?;
            (!digits.is_empty() && digits.chars().all(|c| c.is_ascii_digit())).then(|| own.to_owned())
        };
        let own = plain(name);
        let meant = known.into_iter().find(|known| known == name || plain(known) == own);
        let taken = |meant: &String| self.grid.names.contains(meant) && meant != name;
        meant.or_else(|| target(&own)).filter(|meant| !taken(meant))
    }

    /// Every column under the contract's name that its own name means, else under its own.
    fn by_name(&self) -> Result<Vec<Output>, Fault> {
        let mut outputs: Vec<Output> = Vec::new();
        for (index, name) in self.grid.names.iter().enumerate() {
            let meant = self.meaning(name).unwrap_or_else(|| name.clone());
            let counts = self.counts(&meant);
            let unit = self.grid.units[index].as_deref().or(bracketed(name).map(|(_, unit)| unit));
            let factor = self.factor(name, unit, counts)?;
            outputs.push(Output { name: meant, parts: vec![(index, factor)], source: name.clone() });
        }
        Ok(outputs)
    }

    fn three(&self, columns: &[String; 3], counts: Counts) -> Result<[Output; 3], Fault> {
        let [a, b, c] = columns;
        let of = |column: &String| self.output("the orientation", std::slice::from_ref(column), counts);
        Ok([of(a)?, of(b)?, of(c)?])
    }

    /// Columns as x, y, z, w.
    fn of_quaternion(&self, columns: &[String; 4]) -> Result<Orientation, Fault> {
        let of = |column: &String| self.output("the quaternion", std::slice::from_ref(column), Counts::Plain);
        let [x, y, z, w] = columns;
        Ok(Orientation::Quaternion([of(x)?, of(y)?, of(z)?, of(w)?]))
    }

    fn orientation(&self, options: &ImportOptions) -> Result<Orientation, Fault> {
        if let Some(map) = &options.map {
            if let Some((order, columns)) = &map.euler {
                return Ok(Orientation::Euler(*order, self.three(columns, Counts::Angle)?, [0, 1, 2]));
            }
            if let Some(columns) = &map.rotation_vector {
                return Ok(Orientation::Vector(self.three(columns, Counts::Angle)?));
            }
            if let Some(columns) = &map.quaternion {
                return self.of_quaternion(columns);
            }
        }
        let find = |wanted: &str| {
            let letters = |name: &String| plain(name).replace(['_', '.'], "");
            self.grid.names.iter().find(|name| letters(name) == wanted).cloned()
        };
        if let Some(order) = &options.quaternion {
            let named = |group: &[&str; 4]| {
                let [a, b, c, d] = group.map(find);
                Some([a?, b?, c?, d?])
            };
            let columns = QUATERNIONS.iter().find_map(named).and_then(|columns| quaternion_order(order, &columns));
            return match columns {
                Some(columns) => self.of_quaternion(&columns),
                None => Err(self.in_header(ImportProblem::Option(
                    "‹quaternion› needs an order such as wxyz and four columns that are named q1 … q4 or q0 … q3; columns \
                     qx, qy, qz, qw need none, and a map (‹columns› map.toml) takes any names"
                        .into(),
                ))),
            };
        }
        if options.euler.is_none() && !options.rotation_vector {
            return Ok(Orientation::None);
        }
        let found = ANGLE_COLUMNS.iter().find_map(|(group, axes)| {
            let [a, b, c] = group.map(find);
            Some(([a?, b?, c?], *axes))
        });
        let Some((columns, axes)) = found else {
            return Err(self.in_header(ImportProblem::Option(
                "no three columns are named like angles (roll,pitch,yaw; rx,ry,rz; A,B,C; W,P,R); name them in a map: \
                 ‹columns› map.toml with euler = { order = \"XYZ\", columns = [\"…\", \"…\", \"…\"] }"
                    .into(),
            )));
        };
        let Some(order) = options.euler else { return Ok(Orientation::Vector(self.three(&columns, Counts::Angle)?)) };
        // Columns that name their axis are assigned by axis.
        let places = axes.map_or([0, 1, 2], |_| order.places());
        let mut sorted = columns.clone();
        for (column, place) in columns.iter().zip(places) {
            sorted[place].clone_from(column);
        }
        Ok(Orientation::Euler(order, self.three(&sorted, Counts::Angle)?, places))
    }

    /// The column that names the hole of a plate which each row touches.
    fn holes(&self, plate: Plate, outputs: &[Output]) -> Result<Holes, Fault> {
        let problem = |text: &str| self.in_header(ImportProblem::Option(text.into()));
        let named = outputs.iter().find(|output| output.name == HOLE && output.parts.len() == 1);
        let column = named
            .ok_or_else(|| problem("‹plate› needs a column \"hole\" with the hole that each row touches: A1, A2, …"))?
            .parts[0]
            .0;
        if outputs.iter().any(|output| ["x", "y", "z"].contains(&output.name.as_str())) {
            return Err(problem("‹plate› and columns x, y, z both give positions; leave one of them out"));
        }
        Ok(Holes { plate, column })
    }

    fn value(&self, output: &Output, line: usize, cells: &[String]) -> Result<Option<f64>, Fault> {
        let (mut written, mut scaled) = (0.0, 0.0);
        for (index, factor) in &output.parts {
            let text = cells.get(*index).map_or("", |cell| cell.trim());
            if text.is_empty() {
                return Ok(None);
            }
            let value = grid::number(text, self.grid.decimal_comma).ok_or_else(|| Fault {
                line,
                problem: ImportProblem::Number { column: self.grid.names[*index].clone(), text: text.into() },
            })?;
            written += value;
            scaled += value * factor;
        }
        // One unit: added as written.
        let unit = output.parts[0].1;
        let alike = output.parts.iter().all(|part| part.1 == unit);
        Ok(Some(if alike { written * unit } else { scaled }))
    }

    fn required(&self, output: &Output, line: usize, cells: &[String]) -> Result<f64, Fault> {
        let problem = || ImportProblem::Number { column: output.source.clone(), text: String::new() };
        self.value(output, line, cells)?.ok_or_else(|| Fault { line, problem: problem() })
    }

    /// The quaternion x, y, z, w of a row.
    fn quaternion(&self, orientation: &Orientation, line: usize, cells: &[String]) -> Result<Option<[f64; 4]>, Fault> {
        let three = |outputs: &[Output; 3]| -> Result<[f64; 3], Fault> {
            let [a, b, c] = outputs;
            Ok([self.required(a, line, cells)?, self.required(b, line, cells)?, self.required(c, line, cells)?])
        };
        let rotation = match orientation {
            Orientation::None => return Ok(None),
            Orientation::Euler(order, angles, _) => order.rotation(three(angles)?),
            Orientation::Vector(vector) => Rotation3::from_scaled_axis(Vector3::from(three(vector)?)),
            Orientation::Quaternion([x, y, z, w]) => {
                let value = |output: &Output| self.required(output, line, cells);
                let read = Quaternion::new(value(w)?, value(x)?, value(y)?, value(z)?);
                if (read.norm() - 1.0).abs() > 1e-3 {
                    let columns = [x, y, z, w].map(|output| output.source.as_str()).join(", ");
                    return Err(Fault { line, problem: ImportProblem::Length { columns, length: read.norm() } });
                }
                return Ok(Some([read.i, read.j, read.k, read.w]));
            }
        };
        let q = UnitQuaternion::from_rotation_matrix(&rotation);
        Ok(Some([q.i, q.j, q.k, q.w]))
    }

    /// Three numbers of an orientation in the file's order, rad; not numbers where it has none.
    fn as_written(&self, orientation: &Orientation, line: usize, cells: &[String]) -> Result<[f64; 3], Fault> {
        let (columns, places) = match orientation {
            Orientation::Euler(_, columns, places) => (columns, *places),
            Orientation::Vector(columns) => (columns, [0, 1, 2]),
            Orientation::None | Orientation::Quaternion(_) => return Ok([f64::NAN; 3]),
        };
        let mut numbers = [f64::NAN; 3];
        for (number, place) in numbers.iter_mut().zip(places) {
            *number = self.required(&columns[place], line, cells)?;
        }
        Ok(numbers)
    }

    fn said(&mut self, outputs: &[Output], orientation: &Orientation) {
        for output in outputs {
            let factors: Vec<String> =
                output.parts.iter().filter(|part| part.1 != 1.0).map(|part| part.1.to_string()).collect();
            let unit = match self.counts(&output.name) {
                Counts::Plain => String::new(),
                _ if factors.is_empty() => String::new(),
                Counts::Length => format!(", × {} m", factors[0]),
                Counts::Angle => format!(", × {} rad", factors[0]),
                Counts::Time => format!(", × {} s", factors[0]),
                Counts::Temperature => format!(", × {} °C", factors[0]),
                Counts::Mass => format!(", × {} kg", factors[0]),
            };
            if output.source != output.name || !unit.is_empty() {
                self.taken.push(format!("\"{}\" read as {}{unit}", output.source, output.name));
            }
        }
        let names =
            |outputs: &[Output]| outputs.iter().map(|output| output.source.as_str()).collect::<Vec<_>>().join(", ");
        match orientation {
            Orientation::None => {}
            Orientation::Euler(order, columns, _) => {
                let letters = format!("{order}");
                self.taken.push(format!("\"{}\" read as the angles of {letters}, in this order", names(columns)));
            }
            Orientation::Vector(columns) => {
                self.taken.push(format!("\"{}\" read as a rotation vector", names(columns)));
            }
            Orientation::Quaternion(columns) => {
                self.taken.push(format!("\"{}\" read as qx, qy, qz, qw", names(columns)));
            }
        }
    }

    /// The CSV, with each row on its line of the file.
    fn written(
        mut self,
        mut outputs: Vec<Output>,
        orientation: &Orientation,
        joints: Option<&JointList>,
        by_axis: bool,
        holes: Option<&Holes>,
    ) -> Result<Imported, Fault> {
        let turning: Vec<usize> = match orientation {
            Orientation::None => Vec::new(),
            Orientation::Euler(_, columns, _) | Orientation::Vector(columns) => {
                columns.iter().map(|c| c.parts[0].0).collect()
            }
            Orientation::Quaternion(columns) => columns.iter().map(|c| c.parts[0].0).collect(),
        };
        // Columns of the orientation have no second use.
        outputs.retain(|output| !output.parts.iter().any(|part| turning.contains(&part.0)) || output.parts.len() > 1);
        if let Some(joints) = joints {
            let coordinates = self.chain.coordinates();
            outputs.retain(|output| !coordinates.iter().any(|c| c.name == output.name));
            let short = joints.rows.iter().find(|(_, values)| values.len() != coordinates.len());
            if joints.rows.len() != self.grid.rows.len() || short.is_some() {
                let found = short.map_or_else(
                    || format!("there are {} rows of joint values", joints.rows.len()),
                    |(line, values)| format!("line {line} of the joint values has {} numbers", values.len()),
                );
                let wanted = if short.is_some() { coordinates.len() } else { self.grid.rows.len() };
                let fix = "each measured row needs the joint values at which it was measured";
                return Err(self.in_header(ImportProblem::Count { found, wanted: wanted.to_string(), fix }));
            }
            self.taken.push(format!("joint values from {}: {}", joints.file, joints.taken_for));
        }
        if let Some(Holes { plate, .. }) = holes {
            outputs.retain(|output| output.name != HOLE);
            self.taken.push(format!("column \"hole\" read as x, y, z on the plate ({plate})"));
        }
        self.said(&outputs, orientation);
        let mut lines: Vec<(usize, Vec<String>)> = Vec::with_capacity(self.grid.rows.len() + 1);
        let mut header: Vec<String> = Vec::new();
        if joints.is_some() {
            header.extend(self.chain.coordinates().iter().map(|coordinate| coordinate.name.clone()));
        }
        header.extend(outputs.iter().map(|output| output.name.clone()));
        if holes.is_some() {
            header.extend(["x", "y", "z"].map(String::from));
        }
        if !matches!(orientation, Orientation::None) {
            header.extend(["qx", "qy", "qz", "qw"].map(String::from));
        }
        let read_as = match orientation {
            Orientation::Euler(order, ..) => Some(AngleConvention::Euler(*order)),
            Orientation::Vector(_) => Some(AngleConvention::RotationVector),
            Orientation::None | Orientation::Quaternion(_) => None,
        };
        let mut angles = read_as.map(|read_as| WrittenAngles { read_as, by_axis, numbers: Vec::new() });
        let first = self.grid.rows.first().map_or(1, |row| row.0);
        lines.push((self.grid.header_line.clamp(1, first.saturating_sub(1).max(1)), header));
        for (row, (line, cells)) in self.grid.rows.iter().enumerate() {
            let filled = cells.iter().rposition(|cell| !cell.is_empty()).map_or(0, |last| last + 1);
            if filled > self.grid.names.len() {
                return Err(Fault {
                    line: *line,
                    problem: ImportProblem::Count {
                        found: format!("{filled} cells"),
                        wanted: format!("{} columns", self.grid.names.len()),
                        fix: "does a text contain the column separator? Put it in quotes",
                    },
                });
            }
            let mut written: Vec<String> = Vec::new();
            if let Some(joints) = joints {
                written.extend(joints.rows[row].1.iter().map(f64::to_string));
            }
            for output in &outputs {
                let text = || cells.get(output.parts[0].0).cloned().unwrap_or_default();
                let cell = match self.counts(&output.name) {
                    // A label, or a number of its own unit.
                    Counts::Plain if output.parts.len() == 1 => {
                        grid::number(&text(), self.grid.decimal_comma).map_or_else(text, |value| value.to_string())
                    }
                    _ => self.value(output, *line, cells)?.map_or_else(String::new, |value| value.to_string()),
                };
                written.push(cell);
            }
            if let Some(holes) = holes {
                written.extend(holes.place(*line, cells)?);
            }
            if let Some(quaternion) = self.quaternion(orientation, *line, cells)? {
                written.extend(quaternion.iter().map(f64::to_string));
            }
            if let Some(angles) = &mut angles {
                angles.numbers.push(self.as_written(orientation, *line, cells)?);
            }
            lines.push((*line, written));
        }
        let sources = outputs.into_iter().map(|output| (output.name, output.source)).collect();
        Ok(Imported {
            text: placed(&lines),
            converted: true,
            taken: self.taken,
            sources,
            angles,
            ignored: self.ignored,
        })
    }
}

/// CSV with each row on its line, as far as there is room: lines between are comments.
fn placed(lines: &[(usize, Vec<String>)]) -> String {
    let mut text = String::new();
    let mut at = 1;
    for (line, cells) in lines {
        while at < *line {
            text.push_str("#\n");
            at += 1;
        }
        let mut writer = csv::Writer::from_writer(Vec::new());
        let to_memory = "writing to memory does not fail";
        writer.write_record(cells).expect(to_memory);
        text.push_str(&String::from_utf8_lossy(&writer.into_inner().expect(to_memory)));
        at += 1;
    }
    text
}
