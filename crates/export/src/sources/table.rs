//! Reads Denavit-Hartenberg tables.

use super::cell::{Cell, Variable};
use super::header::quantity_of;
use super::limits::{self, Limit};
use super::rows::{RowOf, Rows};
use super::stated::{ReadAs, Stated};
use super::{Read, Source, SourceError, SourceErrorKind, coordinate_of, in_si, place, stem};
use crate::formats::json::TableFile;
use denavit_dh::conventions::chain_of_rows;
use denavit_dh::matching::{VendorJoint, VendorNumber, VendorRow, VendorTable};
use denavit_dh::{Convention, ConventionRow, Motion, Options, RowLabel, Table, TableJoint, convert};
use denavit_model::Pitch;
use denavit_model::chain::{Chain, Coordinate, Quantity};
use denavit_model::units::Unit;

/// Angles beyond a full turn (rad) are degrees.
const FULL_TURN: f64 = 6.3;
/// Lengths that are mostly beyond this (m) are millimetres: no arm has links of 5 m.
const LONG_LINK: f64 = 5.0;

pub(super) fn motion(kind: &str, pitch: f64) -> Result<Motion, SourceErrorKind> {
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

/// What a row is called: `base`, `tool`, or as it is written.
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
        let fixed = |text: &&str| text.eq_ignore_ascii_case("fixed");
        if let Some(stated) = [own, of_base].into_iter().find(|text| !text.is_empty() && !fixed(text)) {
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
    differ(own.angle.map(Unit::word), given.angle.map(Unit::word))?;
    differ(own.length.map(Unit::word), given.length.map(Unit::word))?;
    Ok(own.or(given))
}

/// How to read a file, and a sentence for each thing that is not stated.
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
        // Only our own files have a column of scales, in rad and m.
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
                Unit::Degree
            }
            Some(_) => {
                notes.push(format!(
                    "{file}: the unit of angles is not stated; they are read as rad (‹table-units› deg reads them as degrees)"
                ));
                Unit::Radian
            }
            None => Unit::Radian,
        },
    };
    let length = if let Some(length) = stated.length {
        length
    } else {
        let lengths = bare(&["d", "a"])?;
        match lengths.get(lengths.len() / 2) {
            Some(middle) if *middle > LONG_LINK => {
                notes.push(format!(
                    "{file}: the unit of lengths is not stated; they are read as mm, because links of {middle} m are \
                     implausible (‹table-units› m reads them as m)"
                ));
                Unit::Millimetre
            }
            Some(_) => {
                notes.push(format!(
                    "{file}: the unit of lengths is not stated; they are read as m (‹table-units› mm reads them as mm)"
                ));
                Unit::Metre
            }
            None => Unit::Metre,
        }
    };
    if rows.writes("grad") {
        notes.push(format!("{file}: grad is read as gradians, 400 to a turn; write deg for degrees"));
    }
    Ok((ReadAs { convention, length, angle }, notes))
}

/// A cell of one of the five numbers or of the offset.
fn cell_of(row: &RowOf, name: &str) -> Result<Option<Cell>, SourceError> {
    let text = row.text(name);
    if text.is_empty() {
        return Ok(None);
    }
    let quantity = quantity_of(name).unwrap_or(Quantity::Angle);
    let cell = Cell::of(text, quantity).ok_or_else(|| row.not_a_number(name))?;
    match cell.unit {
        Some(unit) if unit.quantity() != quantity => Err(row.not_a_number(name)),
        _ => Ok(Some(cell)),
    }
}

/// How the numbers of a file are read.
struct Numbers<'a> {
    rows: &'a Rows<'a>,
    length: Unit,
    angle: Unit,
    /// Whether units in headings apply; units in cells always do.
    headings_count: bool,
}

impl<'a> Numbers<'a> {
    fn of(rows: &'a Rows<'a>, read_as: ReadAs, headings_count: bool) -> Self {
        Self { rows, length: read_as.length, angle: read_as.angle, headings_count }
    }

    fn unit(&self, name: &str, cell: &Cell) -> Unit {
        let of_heading = self.rows.heading(name).and_then(|heading| heading.unit).filter(|_| self.headings_count);
        let of_file = if quantity_of(name) == Some(Quantity::Length) { self.length } else { self.angle };
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
        if !number.value.is_finite() {
            return Err(row.not_a_number(name));
        }
        Ok(Some((number, cell.variable)))
    }

    fn value(&self, row: &RowOf, name: &str) -> Result<Option<f64>, SourceError> {
        Ok(self.number(row, name)?.map(|(number, _)| number.value))
    }

    /// A number of a column that holds no variable.
    fn constant(&self, row: &RowOf, name: &str) -> Result<Option<f64>, SourceError> {
        match self.number(row, name)? {
            Some((_, Some(_))) => Err(row.error_in(name, SourceErrorKind::Variable { column: name.to_owned() })),
            number => Ok(number.map(|(number, _)| number.value)),
        }
    }

    /// theta plus the offset column.
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
        let number = |name: &str, value: Option<f64>| match value {
            None if joint => Err(row.missing(name)),
            number => Ok(number),
        };
        let theta = match self.theta(row)? {
            None if joint && self.rows.has("theta") => return Err(row.missing("theta")),
            theta => theta.map(|theta| theta.value),
        };
        let beta = self.constant(row, "beta")?;
        // A row with beta and an empty d is Hayati's with four numbers, one with both has five.
        let four = beta.is_some() && row.text("d").is_empty();
        let d = if four { None } else { number("d", self.value(row, "d")?)? };
        let beta = if four { beta } else { beta.filter(|beta| *beta != 0.0) };
        let alpha = number("alpha", self.constant(row, "alpha")?)?;
        Ok(ConventionRow { label, theta, d, alpha, a: number("a", self.constant(row, "a")?)?, beta })
    }

    /// The variables in theta and d.
    fn variables(&self, row: &RowOf) -> Result<(Option<Variable>, Option<Variable>), SourceError> {
        let of = |name| Ok::<_, SourceError>(self.number(row, name)?.and_then(|(_, variable)| variable));
        Ok((of("theta")?, of("d")?))
    }
}

/// The rows of a table in its order: joints, and fixed frames before, between and after them.
struct Layout {
    name: String,
    coordinates: Vec<Coordinate>,
    joints: Vec<TableJoint>,
    rows: Vec<ConventionRow>,
    /// Sentences on rows that were read as fixed frames by their numbers.
    assumed: Vec<String>,
    /// Cells that are not understood: line, element, what.
    unknown: Vec<(usize, String, String)>,
}

/// A table from rows; missing base and tool rows are the identity.
pub(super) fn of_rows(mut rows: Rows, given: Stated) -> Result<Read, SourceError> {
    rows.known_units_only()?;
    let (read_as, mut sentences) = assumed(&rows, stated(&rows, given)?)?;
    let layout = Layout::of(&Numbers::of(&rows, read_as, true), read_as.convention)?;
    for (line, element, what) in layout.unknown.clone() {
        rows.report_in(line, &element, &what);
    }
    sentences.extend(layout.assumed.iter().cloned());
    let source = match layout.table(read_as.convention) {
        Some(table) => Source::Table { table, convention: read_as.convention },
        None => Source::Poe(layout.chain(read_as.convention).map_err(|error| rows.error(error.into()))?),
    };
    Ok(Read { source, assumed: sentences, notes: rows.notes, inventory: rows.inventory })
}

/// Sentences on rows that are read as fixed frames by their numbers alone.
pub(super) fn fixed_frames(rows: &Rows, given: Stated) -> Result<Vec<String>, SourceError> {
    let (read_as, _) = assumed(rows, stated(rows, given)?)?;
    Ok(Layout::of(&Numbers::of(rows, read_as, true), read_as.convention)?.assumed)
}

impl Layout {
    fn of(numbers: &Numbers, convention: Convention) -> Result<Self, SourceError> {
        let rows = numbers.rows;
        let name = rows.comment("robot").map_or_else(|| stem(rows.file), str::to_owned);
        let (coordinates, joints, lines) = (Vec::new(), Vec::new(), Vec::new());
        let mut layout = Self { name, coordinates, joints, rows: lines, assumed: Vec::new(), unknown: Vec::new() };
        let mut known = Coordinates::default();
        let mut moves = Vec::new();
        for row in rows.iter() {
            let (turns, slides) = numbers.variables(&row)?;
            moves.push(turns.is_some() || slides.is_some());
        }
        let some_move = moves.iter().any(|moves| *moves);
        let mut last_number: Option<usize> = None;
        let (mut with_base, mut with_tool) = (false, false);
        for (row, moves) in rows.iter().zip(moves) {
            let label = label_of(&row);
            let kind = row.text("kind");
            let fixed_kind = kind.eq_ignore_ascii_case("fixed");
            let out_of_order = || row.error(SourceErrorKind::Order(label.clone()));
            if fixed_kind && moves {
                return Err(row.error(SourceErrorKind::FixedMoves));
            }
            let named_fixed = ["base", "tool"].contains(&label.as_str()) && !moves;
            let silent = some_move && !moves && kind.is_empty();
            if let Ok(number) = label.parse::<usize>() {
                // Books count from 1, some from 0.
                if last_number.map_or(number > 1, |last| last.checked_add(1) != Some(number)) {
                    return Err(out_of_order());
                }
                last_number = Some(number);
            }
            if named_fixed || fixed_kind || silent {
                let is_base = label == "base" || (label != "tool" && layout.joints.is_empty());
                let twice = label == "base" && (with_base || !layout.joints.is_empty());
                if twice || (label == "tool" && with_tool) {
                    return Err(out_of_order());
                }
                with_base |= label == "base";
                with_tool |= label == "tool";
                let line = numbers.of_row(&row, if is_base { RowLabel::Base } else { RowLabel::Tool })?;
                if beta_in(convention, &line) {
                    return Err(row
                        .error_in("beta", denavit_dh::conventions::RowsError::Beta { row: layout.rows.len() }.into()));
                }
                if silent && !named_fixed {
                    let (file, line) = (rows.file, row.line());
                    let called = if label.is_empty() { String::new() } else { format!(" \"{label}\"") };
                    layout.assumed.push(format!(
                        "{file}:{line}: row{called} names no variable, unlike the rows of joints; it is read as a \
                         fixed frame"
                    ));
                }
                layout.rows.push(line);
                continue;
            }
            if with_tool {
                return Err(out_of_order());
            }
            let (joint, limit) = joint_of(numbers, &row, layout.joints.len(), &mut known)?;
            if let Limit::NotUnderstood(text) = limit {
                let what =
                    format!("limits \"{}\" are not understood and were ignored", denavit_model::words::quoted(&text));
                layout.unknown.push((row.line(), row.element(), what));
            }
            let line = numbers.of_row(&row, RowLabel::Joint(layout.joints.len()))?;
            if beta_in(convention, &line) {
                return Err(row.error_in(
                    "beta",
                    denavit_dh::conventions::RowsError::Beta { row: layout.joints.len() + 1 }.into(),
                ));
            }
            layout.rows.push(line);
            layout.joints.push(joint);
        }
        layout.coordinates = known.all;
        Ok(layout)
    }

    /// Frames before the first joint, whether there are some between joints, frames after the last.
    fn fixed(&self) -> (&[ConventionRow], bool, &[ConventionRow]) {
        let is_joint = |row: &ConventionRow| matches!(row.label, RowLabel::Joint(_));
        let first = self.rows.iter().position(is_joint).unwrap_or(self.rows.len());
        let behind = self.rows.iter().rposition(is_joint).map_or(self.rows.len(), |last| last + 1);
        let between = self.rows[first..behind].iter().any(|row| !is_joint(row));
        (&self.rows[..first], between, &self.rows[behind..])
    }

    /// The table with the file's own numbers, where its fixed frames have a place in it.
    fn table(&self, convention: Convention) -> Option<Table> {
        let (base, between, tool) = self.fixed();
        if between || base.len() > 1 || tool.len() > 1 {
            return None;
        }
        let nothing = |label| ConventionRow { label, theta: None, d: None, alpha: None, a: None, beta: None };
        let or_nothing =
            |rows: &[ConventionRow], label| rows.first().map_or(nothing(label), |row| ConventionRow { label, ..*row });
        let joints = self.rows.iter().filter(|row| matches!(row.label, RowLabel::Joint(_)));
        let mut all = vec![or_nothing(base, RowLabel::Base)];
        all.extend(joints);
        all.push(or_nothing(tool, RowLabel::Tool));
        let names = (self.name.as_str(), "base", "tool");
        Table::from_convention_rows(names, self.coordinates.clone(), self.joints.clone(), convention, &all).ok()
    }

    fn chain(&self, convention: Convention) -> Result<Chain, denavit_model::ChainError> {
        let names = (self.name.as_str(), "base", "tool");
        chain_of_rows(names, self.coordinates.clone(), &self.joints, convention, &self.rows)?.within_reach()
    }
}

fn beta_in(convention: Convention, row: &ConventionRow) -> bool {
    convention == Convention::Proximal && row.beta.is_some()
}

/// The coordinates so far, and the table's variables for them.
#[derive(Default)]
struct Coordinates {
    all: Vec<Coordinate>,
    symbols: Vec<(String, usize)>,
}

fn joint_of(
    numbers: &Numbers,
    row: &RowOf,
    index: usize,
    known: &mut Coordinates,
) -> Result<(TableJoint, Limit), SourceError> {
    let (turns, slides) = numbers.variables(row)?;
    let name = match row.name("joint") {
        // Without a column of row numbers a number in the column of joints is one.
        name if name.is_empty() || row.text("row").is_empty() && name.parse::<usize>().is_ok() => {
            format!("joint_{}", index + 1)
        }
        name => name,
    };
    if let (Some(turn), Some(slide)) = (&turns, &slides)
        && turn.name != slide.name
    {
        let (turn, slide) = (turn.name.clone(), slide.name.clone());
        return Err(row.error(SourceErrorKind::TwoVariables { turn, slide }));
    }
    let mut pitch = pitch_of(row)?.unwrap_or(0.0);
    let kind = match (row.text("kind"), &turns, &slides) {
        ("", Some(turn), Some(slide)) => {
            pitch = slide.factor / turn.factor;
            "helical"
        }
        ("", None, Some(_)) => "prismatic",
        ("", _, None) => "revolute",
        (kind, Some(turn), Some(slide)) if is_helical(kind) && pitch == 0.0 => {
            pitch = slide.factor / turn.factor;
            kind
        }
        (kind, _, _) => kind,
    };
    let motion = motion(kind, pitch).map_err(|kind| row.error(kind))?;
    let moved = match motion {
        Motion::Prismatic => turns.as_ref().map(|_| "theta"),
        Motion::Revolute => slides.as_ref().map(|_| "d"),
        Motion::Helical(_) => None,
    };
    if let Some(column) = moved {
        let kind = motion.word().to_owned();
        return Err(row.error_in(column, SourceErrorKind::OtherKind { kind, column: column.to_owned() }));
    }
    let plain_offset = numbers.rows.heading("offset").is_some_and(|heading| heading.plain_offset);
    if motion == Motion::Prismatic && plain_offset && numbers.value(row, "offset")?.is_some_and(|offset| offset != 0.0)
    {
        return Err(row.error_in("offset", SourceErrorKind::OffsetOfSlide));
    }
    let variable = if motion == Motion::Prismatic { slides } else { turns };
    let scale = row.number("scale")?.or(variable.as_ref().map(|variable| variable.factor)).unwrap_or(1.0);
    let symbol = variable.map(|variable| variable.name).filter(|name| name.ends_with(|c: char| c.is_ascii_digit()));
    let by_symbol = symbol.as_ref().and_then(|symbol| known.symbols.iter().find(|(other, _)| other == symbol));
    let by_name = known.all.iter().position(|coordinate| coordinate.name == name);
    let mut limit = Limit::NotStated;
    let coordinate = if let Some(coordinate) = by_symbol.map(|(_, index)| *index).or(by_name) {
        coordinate
    } else {
        let quantity = if motion == Motion::Prismatic { Quantity::Length } else { Quantity::Angle };
        let of_file = if quantity == Quantity::Length { numbers.length } else { numbers.angle };
        let mut coordinate = Coordinate::unlimited(name.clone(), quantity);
        limit = limits::of_row(row, numbers.rows, quantity, of_file)?;
        match limit {
            Limit::Range(lower, upper) => coordinate.limits.range = Some((lower, upper)),
            Limit::Endless => coordinate.continuous = true,
            _ => {}
        }
        known.all.push(coordinate);
        known.all.len() - 1
    };
    known.symbols.extend(symbol.map(|symbol| (symbol, coordinate)));
    Ok((TableJoint { name, motion, coordinate, scale }, limit))
}

fn is_helical(kind: &str) -> bool {
    ["helical", "h"].contains(&kind.to_lowercase().as_str())
}

/// Pitch in m per rad; a heading may say `mm/rad`, `mm/rev`.
fn pitch_of(row: &RowOf) -> Result<Option<f64>, SourceError> {
    let Some(number) = row.number("pitch")? else { return Ok(None) };
    let inside = row.heading("pitch").and_then(|heading| heading.unknown.clone());
    let Some(inside) = inside else { return Ok(Some(number)) };
    let unit = inside.split_once('/').and_then(|(length, angle)| {
        Some((Unit::of(length, Quantity::Length)?, Unit::of(angle.trim_start_matches("per "), Quantity::Angle)?))
    });
    let known = "m/rad, mm/rad, m/rev, mm/rev".to_owned();
    let (length, angle) =
        unit.ok_or_else(|| row.error_in("pitch", SourceErrorKind::UnknownUnit { word: inside, known }))?;
    Ok(Some(length.to_si(number) / angle.in_si()))
}

/// The joint rows with the text that their numbers are written as, read in one way.
pub(super) fn vendor_of_rows(rows: &Rows, read_as: ReadAs, headings_count: bool) -> Result<VendorTable, SourceError> {
    let numbers = Numbers::of(rows, read_as, headings_count);
    let layout = Layout::of(&numbers, read_as.convention)?;
    if layout.fixed().1 {
        // Frames between joints: the robot's own table has them in other numbers.
        let chain = layout.chain(read_as.convention).map_err(|error| rows.error(error.into()))?;
        let made = convert::table(&chain, &Options::default()).map_err(|error| rows.error(error.into()))?;
        return Ok(VendorTable::of(&made.value, Convention::Distal, false));
    }
    let mut joints = Vec::new();
    let lines = rows.iter().zip(&layout.rows).filter(|(_, line)| matches!(line.label, RowLabel::Joint(_)));
    for (row, line) in lines {
        let number = |name: &str| Ok::<_, SourceError>(numbers.number(&row, name)?.map(|(number, _)| number));
        let vendor = VendorRow {
            theta: numbers.theta(&row)?,
            d: number("d")?,
            alpha: number("alpha")?,
            a: number("a")?,
            beta: number("beta")?.filter(|_| line.beta.is_some()),
        };
        let name = row.name("joint");
        let named = !name.is_empty() && name.parse::<usize>().is_err();
        let motion = layout.joints[joints.len()].motion;
        joints.push(VendorJoint { name: named.then_some(name), motion, row: vendor });
    }
    Ok(VendorTable { convention: read_as.convention, base: None, joints, tool: None })
}

/// A table from its JSON file.
pub(super) fn of_file(file: &str, content: &TableFile) -> Result<Source, SourceError> {
    let error = |element: String, kind| SourceError::at(place(file, 1, element), kind);
    let convention = Convention::from_word(&content.convention)
        .ok_or_else(|| error("convention".into(), SourceErrorKind::Convention(content.convention.clone())))?;
    in_si(file, &content.units)?;
    let coordinates = super::coordinates_of(file, &content.coordinates)?;
    let mut joints = Vec::new();
    for entry in &content.joints {
        let element = format!("joint \"{}\"", entry.name);
        let motion = motion(&entry.kind, entry.pitch).map_err(|kind| error(element.clone(), kind))?;
        let coordinate = coordinate_of(file, &entry.name, &entry.coordinate, &coordinates)?;
        joints.push(TableJoint { name: entry.name.clone(), motion, coordinate, scale: entry.scale });
    }
    let count = content.rows.len();
    let mut rows = Vec::new();
    for (index, entry) in content.rows.iter().enumerate() {
        let (label, word) = match index {
            0 => (RowLabel::Base, "base".to_owned()),
            index if index + 1 == count => (RowLabel::Tool, "tool".to_owned()),
            index => (RowLabel::Joint(index - 1), index.to_string()),
        };
        if entry.row != word {
            return Err(error("rows".into(), SourceErrorKind::Order(entry.row.clone())));
        }
        rows.push(ConventionRow {
            label,
            theta: entry.theta,
            d: entry.d,
            alpha: entry.alpha,
            a: entry.a,
            beta: entry.beta,
        });
    }
    let names = (&*content.robot, &*content.base, &*content.tip);
    let table = Table::from_convention_rows(names, coordinates, joints, convention, &rows)
        .map_err(|kind| error("rows".into(), kind.into()))?;
    Ok(Source::Table { table, convention })
}
