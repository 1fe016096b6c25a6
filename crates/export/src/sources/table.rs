//! Denavit-Hartenberg tables back to numbers.

use super::rows::{RowOf, Rows};
use super::{Source, SourceError, SourceErrorKind, coordinate_of, in_si, place, stem};
use crate::formats::json::{CoordinateEntry, TableFile};
use denavit_dh::matching::{VendorJoint, VendorNumber, VendorRow, VendorTable};
use denavit_dh::{Convention, ConventionRow, Motion, RowLabel, Table, TableJoint};
use denavit_model::Pitch;
use denavit_model::chain::{Coordinate, Quantity};

fn motion(kind: &str, pitch: f64) -> Result<Motion, SourceErrorKind> {
    let wrong = || SourceErrorKind::Pitch { kind: kind.to_owned(), pitch };
    match kind {
        "revolute" | "continuous" if pitch == 0.0 => Ok(Motion::Revolute),
        "prismatic" if pitch == 0.0 => Ok(Motion::Prismatic),
        "helical" => Pitch::from_metres_per_radian(pitch).map(Motion::Helical).ok_or_else(wrong),
        "revolute" | "continuous" | "prismatic" => Err(wrong()),
        other => Err(SourceErrorKind::Kind(other.to_owned())),
    }
}

/// A table from CSV rows; base and tool rows may be left out, then they are nothing.
pub(super) fn of_rows(rows: &Rows) -> Result<Source, SourceError> {
    let mut base = None;
    let mut tool = None;
    let mut convention = rows.comment("convention").map(str::to_owned);
    let mut joints: Vec<TableJoint> = Vec::new();
    let mut coordinates: Vec<Coordinate> = Vec::new();
    let mut numbers = Vec::new();
    for row in rows.iter() {
        let label = row.text("row").to_owned();
        let out_of_order = || row.error(SourceErrorKind::Order(label.clone()));
        match label.as_str() {
            "base" if base.is_none() && joints.is_empty() => {
                if !row.text("kind").is_empty() {
                    convention = Some(row.text("kind").to_owned());
                }
                base = Some(numbers_of(&row, RowLabel::Base)?);
            }
            "tool" if tool.is_none() => tool = Some(numbers_of(&row, RowLabel::Tool)?),
            "base" | "tool" => return Err(out_of_order()),
            _ if tool.is_some() => return Err(out_of_order()),
            label => {
                if label.parse().is_ok_and(|number: usize| number != joints.len() + 1) {
                    return Err(out_of_order());
                }
                let joint = joint_of(&row, joints.len(), &mut coordinates)?;
                numbers.push(numbers_of(&row, RowLabel::Joint(joints.len()))?);
                joints.push(joint);
            }
        }
        if !row.text("convention").is_empty() {
            convention = Some(row.text("convention").to_owned());
        }
    }
    let convention = match convention.as_deref() {
        None | Some("") => Convention::Distal,
        Some(word) => {
            Convention::from_word(word).ok_or_else(|| rows.error(SourceErrorKind::Convention(word.to_owned())))?
        }
    };
    let nothing = |label| ConventionRow { label, theta: None, d: None, alpha: None, a: None, beta: None };
    let mut all = vec![base.unwrap_or_else(|| nothing(RowLabel::Base))];
    all.extend(numbers);
    all.push(tool.unwrap_or_else(|| nothing(RowLabel::Tool)));
    let name = rows.comment("robot").map_or_else(|| stem(rows.file), str::to_owned);
    let table = Table::from_convention_rows((name, "base", "tool"), coordinates, joints, convention, &all)
        .map_err(|error| rows.error(error.into()))?;
    Ok(Source::Table { table, convention })
}

fn joint_of(row: &RowOf, index: usize, coordinates: &mut Vec<Coordinate>) -> Result<TableJoint, SourceError> {
    let name = match row.text("joint") {
        "" => format!("joint_{}", index + 1),
        name => name.to_owned(),
    };
    let kind = match row.text("kind") {
        "" => "revolute",
        kind => kind,
    };
    let motion = motion(kind, row.number("pitch")?.unwrap_or(0.0)).map_err(|kind| row.error(kind))?;
    let scale = row.number("scale")?.unwrap_or(1.0);
    let known = coordinates.iter().position(|coordinate| coordinate.name == name);
    let coordinate = known.unwrap_or_else(|| {
        let quantity = if motion == Motion::Prismatic { Quantity::Length } else { Quantity::Angle };
        coordinates.push(Coordinate::unlimited(name.clone(), quantity));
        coordinates.len() - 1
    });
    Ok(TableJoint { name, motion, coordinate, scale })
}

fn numbers_of(row: &RowOf, label: RowLabel) -> Result<ConventionRow, SourceError> {
    let joint = matches!(label, RowLabel::Joint(_));
    let number = |name| if joint { row.required(name).map(Some) } else { row.number(name) };
    let beta = row.number("beta")?;
    // A Hayati row is one with beta and an empty d.
    let hayati = beta.is_some() && row.text("d").is_empty();
    let d = if hayati { None } else { number("d")? };
    let beta = if hayati { beta } else { beta.filter(|beta| *beta != 0.0) };
    Ok(ConventionRow { label, theta: number("theta")?, d, alpha: number("alpha")?, a: number("a")?, beta })
}

/// The joint rows with the text that their numbers are written as.
pub(super) fn vendor_of_rows(rows: &Rows, table: &Table, convention: Convention) -> Result<VendorTable, SourceError> {
    let mut joints = Vec::new();
    for row in rows.iter().filter(|row| !["base", "tool"].contains(&row.text("row"))) {
        let number = |name: &str| row.written(name).and_then(|(text, unit)| VendorNumber::from_written(text, unit));
        let numbers = VendorRow {
            theta: number("theta"),
            d: number("d"),
            alpha: number("alpha"),
            a: number("a"),
            beta: number("beta").filter(|_| convention == Convention::Hayati),
        };
        let name = row.text("joint");
        let motion = table.joints[joints.len()].motion;
        joints.push(VendorJoint { name: (!name.is_empty()).then(|| name.to_owned()), motion, row: numbers });
    }
    Ok(VendorTable { convention, base: None, joints, tool: None })
}

/// A table from its JSON file.
pub(super) fn of_file(file: &str, content: &TableFile) -> Result<Source, SourceError> {
    let error = |element: String, kind| SourceError { place: place(file, 1, element), kind };
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
    Ok(Source::Table { table, convention })
}
