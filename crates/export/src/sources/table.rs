//! Denavit-Hartenberg tables back to numbers.

use super::cell::{Cell, Variable};
use super::rows::{RowOf, Rows};
use super::stated::{ReadAs, Stated};
use super::units::Unit;
use super::{Source, SourceError, SourceErrorKind, coordinate_of, in_si, place, stem};
use crate::formats::json::{CoordinateEntry, TableFile};
use crate::numbers::{AngleUnit, LengthUnit, Units};
use denavit_dh::matching::{VendorJoint, VendorNumber, VendorRow, VendorTable};
use denavit_dh::{Convention, ConventionRow, Motion, RowLabel, Table, TableJoint};
use denavit_model::Pitch;
use denavit_model::chain::{Coordinate, Quantity};

/// Angles beyond a full turn (rad) are degrees.
const FULL_TURN: f64 = 6.3;
/// Lengths that are mostly beyond this (m) are millimetres: no arm has links of 5 m.
const LONG_LINK: f64 = 5.0;

fn motion(kind: &str, pitch: f64) -> Result<Motion, SourceErrorKind> {
    let wrong = || SourceErrorKind::Pitch { kind: kind.to_owned(), pitch };
    match kind.to_lowercase().as_str() {
        "revolute" | "continuous" | "rotational" | "rotary" | "r" if pitch == 0.0 => Ok(Motion::Revolute),
        "prismatic" | "linear" | "translational" | "p" if pitch == 0.0 => Ok(Motion::Prismatic),
        "helical" | "h" => Pitch::from_metres_per_radian(pitch).map(Motion::Helical).ok_or_else(wrong),
        "revolute" | "continuous" | "rotational" | "rotary" | "r" | "prismatic" | "linear" | "translational" | "p" => {
            Err(wrong())
        }
        _ => Err(SourceErrorKind::Kind(kind.to_owned())),
    }
}

/// What a row is: `base`, `tool`, or a joint.
fn label_of(row: &RowOf) -> String {
    let label = if row.text("row").is_empty() { row.text("joint") } else { row.text("row") };
    match label.to_lowercase().as_str() {
        "base" => "base".to_owned(),
        "tool" | "flange" | "tcp" | "ee" | "end effector" => "tool".to_owned(),
        _ => label.to_owned(),
    }
}

/// The convention that the table states: in a comment, in the base row's kind, in a column.
fn convention_of(rows: &Rows) -> Result<Option<Convention>, SourceError> {
    let mut word = rows.comment("convention").map(str::to_owned);
    for row in rows.iter() {
        let own = row.text("convention");
        let of_base = if label_of(&row) == "base" { row.text("kind") } else { "" };
        if let Some(stated) = [own, of_base].into_iter().find(|text| !text.is_empty()) {
            word = Some(stated.to_owned());
        }
    }
    match word.as_deref() {
        None | Some("") => Ok(rows.stated().convention),
        Some(word) => {
            let known = Convention::from_word(word);
            known.map(Some).ok_or_else(|| rows.error(SourceErrorKind::Convention(word.to_owned())))
        }
    }
}

/// What the file and the user state of it.
pub(super) fn stated(rows: &Rows, given: Stated) -> Result<Stated, SourceError> {
    let own = Stated { convention: convention_of(rows)?, ..rows.stated() };
    let differ = |file: Option<&str>, user: Option<&str>| match (file, user) {
        (Some(file), Some(user)) if file != user => {
            Err(rows.error(SourceErrorKind::Contradiction { file: file.to_owned(), user: user.to_owned() }))
        }
        _ => Ok(()),
    };
    differ(own.convention.map(Convention::word), given.convention.map(Convention::word))?;
    let words = |stated: Stated| {
        let angle = |angle| if angle == AngleUnit::Degree { "deg" } else { "rad" };
        let length = |length| Units { length, ..Units::default() }.length_word();
        (stated.angle.map(angle), stated.length.map(length))
    };
    let ((angle, length), (given_angle, given_length)) = (words(own), words(given));
    differ(angle, given_angle)?;
    differ(length, given_length)?;
    Ok(own.or(given))
}

/// How to read a file, and a sentence for each thing that nobody states.
pub(super) fn assumed(rows: &Rows, stated: Stated) -> Result<(ReadAs, Vec<String>), SourceError> {
    let mut notes = Vec::new();
    let file = rows.file;
    let convention = stated.convention.unwrap_or_else(|| {
        notes.push(format!(
            "{file}: the table's convention is not stated; it is read as distal (standard); ‹table-convention› proximal \
             reads it as modified"
        ));
        Convention::Distal
    });
    let bare = |names: &[&str]| -> Result<Vec<f64>, SourceError> {
        let mut found = Vec::new();
        // No manual has a column of scales: such a file is our own, in rad and m.
        for row in rows.iter().filter(|_| !rows.has("scale")) {
            for name in names.iter().filter(|name| rows.heading(name).is_some_and(|heading| heading.unit.is_none())) {
                if let Some(cell) = cell_of(&row, name)?.filter(|cell| cell.unit.is_none() && cell.constant != 0.0) {
                    found.push(cell.constant.abs());
                }
            }
        }
        found.sort_by(f64::total_cmp);
        Ok(found)
    };
    let angle = match stated.angle {
        Some(angle) => angle,
        None => match bare(&["theta", "offset", "alpha", "beta"])?.last() {
            Some(largest) if *largest > FULL_TURN => {
                notes.push(format!(
                    "{file}: the unit of angles is not stated; they are read as degrees, as {largest} is more than a full \
                     turn in rad (‹table-units› rad reads them as rad)"
                ));
                AngleUnit::Degree
            }
            _ => AngleUnit::Radian,
        },
    };
    let length = if let Some(length) = stated.length {
        length
    } else {
        let lengths = bare(&["d", "a"])?;
        match lengths.get(lengths.len() / 2) {
            Some(middle) if *middle > LONG_LINK => {
                notes.push(format!(
                    "{file}: the unit of lengths is not stated; they are read as mm, as links of {middle} m are no \
                         robot's (‹table-units› m reads them as m)"
                ));
                LengthUnit::Millimetre
            }
            _ => LengthUnit::Metre,
        }
    };
    Ok((ReadAs { convention, units: Units { length, angle } }, notes))
}

fn cell_of(row: &RowOf, name: &str) -> Result<Option<Cell>, SourceError> {
    let text = row.text(name);
    if text.is_empty() {
        return Ok(None);
    }
    let cell = Cell::of(text).ok_or_else(|| row.not_a_number(name))?;
    let is_length = ["d", "a"].contains(&name);
    match cell.unit {
        Some(unit) if unit.is_length() != is_length => Err(row.not_a_number(name)),
        _ => Ok(Some(cell)),
    }
}

/// How the numbers of a file are read.
struct Numbers<'a> {
    rows: &'a Rows<'a>,
    units: Units,
    /// Whether units of headings count; units in cells always do.
    headings_count: bool,
}

impl Numbers<'_> {
    fn unit(&self, name: &str, cell: &Cell) -> Unit {
        let of_heading = self.rows.heading(name).and_then(|heading| heading.unit).filter(|_| self.headings_count);
        let of_file = if ["d", "a"].contains(&name) { self.units.length.into() } else { self.units.angle.into() };
        cell.unit.or(of_heading).unwrap_or(of_file)
    }

    /// A cell's number with its text, and the variable in it.
    fn number(&self, row: &RowOf, name: &str) -> Result<Option<(VendorNumber, Option<Variable>)>, SourceError> {
        let Some(cell) = cell_of(row, name)? else { return Ok(None) };
        let unit = self.unit(name, &cell);
        let number = match &cell.literal {
            Some(literal) => VendorNumber::from_written(literal, unit.in_si()).ok_or_else(|| row.not_a_number(name))?,
            None => VendorNumber::from(unit.to_si(cell.constant)),
        };
        Ok(Some((number, cell.variable)))
    }

    fn value(&self, row: &RowOf, name: &str) -> Result<Option<f64>, SourceError> {
        Ok(self.number(row, name)?.map(|(number, _)| number.value))
    }

    /// theta and what a column of offsets adds to it.
    fn theta(&self, row: &RowOf) -> Result<Option<VendorNumber>, SourceError> {
        let (theta, offset) = (self.number(row, "theta")?, self.number(row, "offset")?);
        Ok(match (theta, offset) {
            (None, None) => None,
            (Some((theta, _)), None) => Some(theta),
            (Some((theta, _)), Some((offset, _))) if theta.value != 0.0 => Some((theta.value + offset.value).into()),
            (_, Some((offset, _))) => Some(offset),
        })
    }

    fn of_row(&self, row: &RowOf, label: RowLabel) -> Result<ConventionRow, SourceError> {
        let joint = matches!(label, RowLabel::Joint(_));
        let number = |name: &str| match self.value(row, name)? {
            None if joint => Err(row.missing(name)),
            number => Ok(number),
        };
        let theta = match self.theta(row)? {
            None if joint && self.rows.has("theta") => return Err(row.missing("theta")),
            theta => theta.map(|theta| theta.value),
        };
        let beta = self.value(row, "beta")?;
        // A Hayati row is one with beta and an empty d.
        let hayati = beta.is_some() && row.text("d").is_empty();
        let d = if hayati { None } else { number("d")? };
        let beta = if hayati { beta } else { beta.filter(|beta| *beta != 0.0) };
        Ok(ConventionRow { label, theta, d, alpha: number("alpha")?, a: number("a")?, beta })
    }
}

/// A table from rows; base and tool rows may be left out, then they are nothing.
pub(super) fn of_rows(rows: &Rows, given: Stated) -> Result<Source, SourceError> {
    let (read_as, assumed) = assumed(rows, stated(rows, given)?)?;
    let table = table_of(&Numbers { rows, units: read_as.units, headings_count: true }, read_as.convention)?;
    Ok(Source::Table { table, convention: read_as.convention, assumed })
}

fn table_of(numbers: &Numbers, convention: Convention) -> Result<Table, SourceError> {
    let rows = numbers.rows;
    let mut base = None;
    let mut tool = None;
    let mut joints: Vec<TableJoint> = Vec::new();
    let mut known = Coordinates::default();
    let mut lines = Vec::new();
    for row in rows.iter() {
        let label = label_of(&row);
        let out_of_order = || row.error(SourceErrorKind::Order(label.clone()));
        match label.as_str() {
            "base" if base.is_none() && joints.is_empty() => base = Some(numbers.of_row(&row, RowLabel::Base)?),
            "tool" if tool.is_none() => tool = Some(numbers.of_row(&row, RowLabel::Tool)?),
            "base" | "tool" => return Err(out_of_order()),
            _ if tool.is_some() => return Err(out_of_order()),
            label => {
                if label.parse().is_ok_and(|number: usize| number != joints.len() + 1) {
                    return Err(out_of_order());
                }
                let joint = joint_of(numbers, &row, joints.len(), &mut known)?;
                lines.push(numbers.of_row(&row, RowLabel::Joint(joints.len()))?);
                joints.push(joint);
            }
        }
    }
    let nothing = |label| ConventionRow { label, theta: None, d: None, alpha: None, a: None, beta: None };
    let mut all = vec![base.unwrap_or_else(|| nothing(RowLabel::Base))];
    all.extend(lines);
    all.push(tool.unwrap_or_else(|| nothing(RowLabel::Tool)));
    let name = rows.comment("robot").map_or_else(|| stem(rows.file), str::to_owned);
    Table::from_convention_rows((name, "base", "tool"), known.all, joints, convention, &all)
        .map_err(|error| rows.error(error.into()))
}

/// The coordinates so far, and the variables that the table writes for them.
#[derive(Default)]
struct Coordinates {
    all: Vec<Coordinate>,
    symbols: Vec<(String, usize)>,
}

fn joint_of(numbers: &Numbers, row: &RowOf, index: usize, known: &mut Coordinates) -> Result<TableJoint, SourceError> {
    let number_of = |name| Ok::<_, SourceError>(numbers.number(row, name)?.and_then(|(_, variable)| variable));
    let (turns, slides) = (number_of("theta")?, number_of("d")?);
    let name = match row.text("joint") {
        // Without a column of row numbers a number in the column of joints is one.
        name if name.is_empty() || row.text("row").is_empty() && name.parse::<usize>().is_ok() => {
            format!("joint_{}", index + 1)
        }
        name => name.to_owned(),
    };
    let mut pitch = row.number("pitch")?.unwrap_or(0.0);
    let kind = match (row.text("kind"), &turns, &slides) {
        ("", Some(turn), Some(slide)) => {
            pitch = slide.factor / turn.factor;
            "helical"
        }
        ("", None, Some(_)) => "prismatic",
        ("", _, None) => "revolute",
        (kind, Some(turn), Some(slide)) if kind.eq_ignore_ascii_case("helical") && pitch == 0.0 => {
            pitch = slide.factor / turn.factor;
            kind
        }
        (kind, _, _) => kind,
    };
    let motion = motion(kind, pitch).map_err(|kind| row.error(kind))?;
    let variable = if motion == Motion::Prismatic { slides.or(turns) } else { turns };
    let scale = row.number("scale")?.or(variable.as_ref().map(|variable| variable.factor)).unwrap_or(1.0);
    let symbol = variable.map(|variable| variable.name).filter(|name| name.ends_with(|c: char| c.is_ascii_digit()));
    let by_symbol = symbol.as_ref().and_then(|symbol| known.symbols.iter().find(|(other, _)| other == symbol));
    let by_name = known.all.iter().position(|coordinate| coordinate.name == name);
    let coordinate = by_symbol.map(|(_, index)| *index).or(by_name).unwrap_or_else(|| {
        let quantity = if motion == Motion::Prismatic { Quantity::Length } else { Quantity::Angle };
        known.all.push(Coordinate::unlimited(name.clone(), quantity));
        known.all.len() - 1
    });
    known.symbols.extend(symbol.map(|symbol| (symbol, coordinate)));
    Ok(TableJoint { name, motion, coordinate, scale })
}

/// The joint rows with the text that their numbers are written as, read in one way.
pub(super) fn vendor_of_rows(rows: &Rows, read_as: ReadAs, headings_count: bool) -> Result<VendorTable, SourceError> {
    let numbers = Numbers { rows, units: read_as.units, headings_count };
    let table = table_of(&numbers, read_as.convention)?;
    let mut joints = Vec::new();
    for row in rows.iter().filter(|row| !["base", "tool"].contains(&label_of(row).as_str())) {
        let number = |name: &str| Ok::<_, SourceError>(numbers.number(&row, name)?.map(|(number, _)| number));
        let line = VendorRow {
            theta: numbers.theta(&row)?,
            d: number("d")?,
            alpha: number("alpha")?,
            a: number("a")?,
            beta: number("beta")?.filter(|_| read_as.convention == Convention::Hayati),
        };
        let name = row.text("joint");
        let named = !name.is_empty() && name.parse::<usize>().is_err();
        let motion = table.joints[joints.len()].motion;
        joints.push(VendorJoint { name: named.then(|| name.to_owned()), motion, row: line });
    }
    Ok(VendorTable { convention: read_as.convention, base: None, joints, tool: None })
}

/// A table from its JSON file.
pub(super) fn of_file(file: &str, content: &TableFile) -> Result<Source, SourceError> {
    let error = |element: String, kind| SourceError::at(place(file, 1, element), kind);
    let convention = Convention::from_word(&content.convention)
        .ok_or_else(|| error("convention".into(), SourceErrorKind::Convention(content.convention.clone())))?;
    in_si(file, &content.units)?;
    let coordinates: Vec<Coordinate> = content.coordinates.iter().map(CoordinateEntry::coordinate).collect();
    let mut joints = Vec::new();
    for entry in &content.joints {
        let element = format!("joint \"{}\"", entry.name);
        let motion = motion(&entry.kind, entry.pitch).map_err(|kind| error(element.clone(), kind))?;
        let coordinate = coordinate_of(file, &entry.name, &entry.coordinate, &coordinates)?;
        joints.push(TableJoint { name: entry.name.clone(), motion, coordinate, scale: entry.scale });
    }
    let count = content.rows.len();
    let rows = content.rows.iter().enumerate().map(|(index, entry)| {
        let label = match index {
            0 => RowLabel::Base,
            index if index + 1 == count => RowLabel::Tool,
            index => RowLabel::Joint(index - 1),
        };
        ConventionRow { label, theta: entry.theta, d: entry.d, alpha: entry.alpha, a: entry.a, beta: entry.beta }
    });
    let rows: Vec<ConventionRow> = rows.collect();
    let names = (&*content.robot, &*content.base, &*content.tip);
    let table = Table::from_convention_rows(names, coordinates, joints, convention, &rows)
        .map_err(|kind| error("rows".into(), kind.into()))?;
    Ok(Source::Table { table, convention, assumed: Vec::new() })
}
