//! Reports of a robot matched with a vendor's table: text and JSON.

use crate::numbers::{Units, decimal};
use crate::sources::{ReadAs, VendorReading};
use comfy_table::{CellAlignment, Table as Grid, presets};
use denavit_dh::RowLabel;
use denavit_dh::matching::{
    DhNumber, Difference, Match, MatchError, Nature, Placement, RowMatch, Sense, Verdict, match_table,
};
use denavit_model::Pose;
use denavit_model::chain::{Chain, Quantity};
use denavit_model::se3::rpy_from_rotation;
use serde::Serialize;
use std::fmt::Write as _;

/// The schema's name and version.
pub const SCHEMA: &str = "denavit.match/1";

#[derive(Serialize)]
struct MatchFile<'a> {
    schema: &'a str,
    robot: &'a str,
    table: &'a str,
    verdict: &'a str,
    read_as: ReadAsEntry,
    #[serde(skip_serializing_if = "Option::is_none")]
    would_match_as: Option<ReadAsEntry>,
    position_error_m: f64,
    rotation_error_rad: f64,
    joints: Vec<JointEntry<'a>>,
    base: FrameEntry,
    tool: FrameEntry,
    rows: Vec<RowEntry>,
    differences: Vec<DifferenceEntry>,
    /// The placement of the table on the robot after correcting the differences.
    #[serde(skip_serializing_if = "Option::is_none")]
    explained: Option<ExplainedEntry<'a>>,
}

#[derive(Serialize)]
struct ExplainedEntry<'a> {
    position_error_m: f64,
    joints: Vec<JointEntry<'a>>,
    base: FrameEntry,
    tool: FrameEntry,
}

/// How the table was read, and whether the file or the user states this or it was tried.
#[derive(Serialize)]
struct ReadAsEntry {
    convention: &'static str,
    angle: &'static str,
    length: &'static str,
    tried: bool,
}

impl ReadAsEntry {
    fn of(read_as: ReadAs, tried: bool) -> Self {
        let (angle, length) = (read_as.angle.word(), read_as.length.word());
        Self { convention: read_as.convention.word(), angle, length, tried }
    }
}

/// The result of matching all readings of a table.
#[derive(Debug)]
pub struct Found<'a> {
    /// The match of the best reading.
    pub found: Match,
    /// That reading.
    pub reading: &'a VendorReading,
    /// For a mismatch: a reading that would match, although it contradicts the file or the user.
    pub otherwise: Option<(Verdict, ReadAs)>,
}

impl Found<'_> {
    /// A note on how the table was read.
    pub fn remark(&self) -> Option<String> {
        if let Some((verdict, read_as)) = &self.otherwise {
            return Some(format!(
                "this looks like {}: the match is then {}; state it with ‹convention› and ‹table-units›, or in the \
                 headings of the file",
                read_as.words(),
                verdict.word()
            ));
        }
        if self.found.verdict == Verdict::Mismatch {
            return self.looks_like();
        }
        let read_as = self.reading.read_as.words();
        self.reading.tried.then(|| format!("read as {read_as}, the best fit among the readings that the file allows"))
    }
}

/// The best match among the readings that agree with everything stated; for a mismatch also a reading that would match.
///
/// # Errors
/// As [`match_table`].
///
/// # Panics
/// There is no reading; [`crate::sources::read_vendor_table`] returns at least one.
pub fn best<'a>(chain: &Chain, readings: &'a [VendorReading]) -> Result<Found<'a>, MatchError> {
    let mut best: Option<(Match, &VendorReading)> = None;
    let mut otherwise: Option<(Match, &VendorReading)> = None;
    for reading in readings {
        let matches = best.as_ref().is_some_and(|(found, _)| found.verdict <= Verdict::Rounded);
        let hopeless = best.as_ref().is_none_or(|(found, _)| found.verdict == Verdict::Mismatch);
        if matches || (reading.against_what_is_stated && !hopeless) {
            break;
        }
        let found = match_table(chain, &reading.table)?;
        let slot = if reading.against_what_is_stated { &mut otherwise } else { &mut best };
        if slot.as_ref().is_none_or(|(known, _)| {
            (found.verdict, found.placement.position_error) < (known.verdict, known.placement.position_error)
                && (found.verdict < known.verdict || found.verdict == Verdict::Mismatch)
        }) {
            *slot = Some((found, reading));
        }
    }
    let (found, reading) = best.expect("the first reading contradicts nothing");
    let otherwise = otherwise.filter(|(other, _)| other.verdict < Verdict::Mismatch);
    Ok(Found { found, reading, otherwise: otherwise.map(|(other, reading)| (other.verdict, reading.read_as)) })
}

/// Angles beyond a full turn (rad) and links beyond this (m) are implausible for an arm.
const FULL_TURN: f64 = 6.3;
const LONG_LINK: f64 = 20.0;

impl Found<'_> {
    /// For a table that does not match: the units that implausible numbers suggest.
    fn looks_like(&self) -> Option<String> {
        let table = &self.reading.table;
        let largest = |lengths: bool| {
            let numbers = table.rows().flat_map(|(_, row)| DhNumber::ALL.map(|number| (number, row.number(number))));
            let numbers = numbers.filter(|(number, _)| number.is_length() == lengths);
            numbers.filter_map(|(_, number)| Some(number?.value.abs())).fold(0.0, f64::max)
        };
        let (angle, length) = (largest(false), largest(true));
        let mut looks = Vec::new();
        if angle > FULL_TURN {
            looks.push(format!("angles up to {} rad look like degrees (‹table-units› deg)", decimal(angle, 3)));
        }
        if length > LONG_LINK {
            looks.push(format!("lengths up to {} m look like millimetres (‹table-units› mm)", decimal(length, 3)));
        }
        (!looks.is_empty()).then(|| looks.join("; "))
    }
}

#[derive(Serialize)]
struct JointEntry<'a> {
    name: &'a str,
    sense: i8,
    zero: f64,
}

#[derive(Serialize)]
struct FrameEntry {
    xyz: [f64; 3],
    rpy: [f64; 3],
}

#[derive(Serialize)]
struct RowEntry {
    row: String,
    numbers: Vec<NumberEntry>,
}

#[derive(Serialize)]
struct NumberEntry {
    number: &'static str,
    table: f64,
    robot: f64,
    printed: String,
    agrees: bool,
}

#[derive(Serialize)]
struct DifferenceEntry {
    row: String,
    number: &'static str,
    table: f64,
    robot: f64,
    words: String,
}

fn label(label: RowLabel) -> String {
    match label {
        RowLabel::Base => "base".to_owned(),
        RowLabel::Joint(index) => (index + 1).to_string(),
        RowLabel::Tool => "tool".to_owned(),
    }
}

fn frame(pose: &Pose) -> FrameEntry {
    FrameEntry { xyz: pose.translation.vector.into(), rpy: rpy_from_rotation(&pose.rotation) }
}

fn joints(placement: &Placement) -> Vec<JointEntry<'_>> {
    placement
        .joints
        .iter()
        .map(|joint| JointEntry {
            name: &joint.name,
            sense: if joint.sense == Sense::Same { 1 } else { -1 },
            zero: joint.zero,
        })
        .collect()
}

fn differences(found: &Match) -> &[Difference] {
    found.explanation.as_ref().map_or(&[], |explanation| &explanation.differences)
}

/// JSON in m and rad. `table` is the table's file.
pub fn json(chain: &Chain, table: &str, result: &Found) -> String {
    let found = &result.found;
    let placement = &found.placement;
    let row = |row: &RowMatch| RowEntry {
        row: label(row.label),
        numbers: row
            .numbers
            .iter()
            .map(|number| NumberEntry {
                number: number.number.word(),
                table: number.vendor.value,
                robot: number.robot,
                printed: number.printed(),
                agrees: number.agrees,
            })
            .collect(),
    };
    let difference = |difference: &Difference| DifferenceEntry {
        row: label(difference.label),
        number: difference.number.word(),
        table: difference.vendor,
        robot: difference.robot,
        words: words(difference, Units::default()),
    };
    let file = MatchFile {
        schema: SCHEMA,
        robot: chain.name(),
        table,
        verdict: found.verdict.word(),
        read_as: ReadAsEntry::of(result.reading.read_as, result.reading.tried),
        would_match_as: result.otherwise.as_ref().map(|(_, read_as)| ReadAsEntry::of(*read_as, true)),
        position_error_m: placement.position_error,
        rotation_error_rad: placement.rotation_error,
        joints: joints(placement),
        base: frame(&placement.base),
        tool: frame(&placement.tool),
        rows: found.rows.iter().map(row).collect(),
        differences: differences(found).iter().map(difference).collect(),
        explained: found.explanation.as_ref().map(|explanation| ExplainedEntry {
            position_error_m: explanation.placement.position_error,
            joints: joints(&explanation.placement),
            base: frame(&explanation.placement.base),
            tool: frame(&explanation.placement.tool),
        }),
    };
    serde_json::to_string_pretty(&file).expect("every number of a match is finite") + "\n"
}

/// Text: the verdict, the placement of the match, the table in the vendor's form, and the differences.
pub fn text(chain: &Chain, table: &str, result: &Found, units: Units) -> String {
    let found = &result.found;
    let placement = &found.placement;
    let mut out = format!(
        "{} against {table}: {}\nlargest tip error {} mm, {:.1e} rad over random joint values\n\n",
        chain.name(),
        found.verdict.word(),
        decimal(placement.position_error * 1e3, 6),
        placement.rotation_error,
    );
    if let Some(remark) = result.remark() {
        let _ = writeln!(out, "{remark}\n");
    }
    out.push_str(&needed(chain, placement, units));
    let _ = writeln!(
        out,
        "\nthe robot's table in the vendor's form ({}); * marks a number that differs from the vendor's:\n",
        result.reading.table.convention.word()
    );
    out.push_str(&rows(found));
    if found.prints_back() {
        out.push_str("\nEvery number is printed as the vendor wrote it.\n");
    }
    match &found.explanation {
        None => {}
        Some(explanation) if explanation.differences.is_empty() => {}
        Some(explanation) => {
            out.push_str("\ndifferences:\n");
            for difference in &explanation.differences {
                let _ = writeln!(out, "  {}", words(difference, units));
            }
            let left = explanation.placement.position_error;
            let _ = writeln!(out, "  with these corrected the largest tip error is {} mm", decimal(left * 1e3, 6));
            if !same_zeros(placement, &explanation.placement) {
                let _ = write!(out, "\nwith these corrected {}", needed(chain, &explanation.placement, units));
            }
        }
    }
    out
}

/// Zeros that differ by less than this, rad or m, are printed once.
const SAME_ZERO: f64 = 1e-3;

fn same_zeros(one: &Placement, other: &Placement) -> bool {
    one.joints.iter().zip(&other.joints).all(|(one, other)| {
        let turns = (one.zero - other.zero) / std::f64::consts::TAU;
        one.sense == other.sense && (turns - turns.round()).abs() * std::f64::consts::TAU < SAME_ZERO
    })
}

/// Senses, zeros and frames of the match: a free match would hide errors if it did not list them.
fn needed(chain: &Chain, placement: &Placement, units: Units) -> String {
    let mut out = String::new();
    let mut plain = true;
    for (joint, of_chain) in placement.joints.iter().zip(chain.joints()) {
        let quantity = chain.coordinates()[of_chain.coordinate].quantity;
        let unit = if quantity == Quantity::Angle { units.angle_word() } else { units.length_word() };
        let zero = units.value(joint.zero, quantity);
        if joint.sense == Sense::Reversed || zero != "0" {
            plain = false;
            let sense = if joint.sense == Sense::Reversed { "reversed sense" } else { "same sense" };
            let _ =
                writeln!(out, "  {}: {sense}, reads {zero} {unit} in the table where the robot reads 0", joint.name);
        }
    }
    if plain {
        out.push_str("  every joint has the same sense and zero\n");
    }
    for (name, pose) in [("base", &placement.base), ("tool", &placement.tool)] {
        let FrameEntry { xyz, rpy } = frame(pose);
        let xyz: Vec<String> = xyz.iter().map(|value| units.length(*value)).collect();
        let rpy: Vec<String> = rpy.iter().map(|value| units.angle(*value)).collect();
        let (length, angle) = (units.length_word(), units.angle_word());
        let _ = writeln!(out, "  {name} frame: xyz {} {length}, rpy {} {angle}", xyz.join(" "), rpy.join(" "));
    }
    format!("the match uses\n{out}")
}

fn rows(found: &Match) -> String {
    let mut grid = Grid::new();
    grid.load_style(presets::NOTHING);
    if let Some(first) = found.rows.first() {
        let names = first.numbers.iter().map(|number| number.number.word().to_owned());
        grid.set_header(std::iter::once("row".to_owned()).chain(names).collect::<Vec<_>>());
    }
    for row in &found.rows {
        let cells = row.numbers.iter().map(|number| {
            let printed = number.printed();
            match printed.parse() {
                Ok(value) if !number.agrees => format!("*{}", decimal(value, 12)),
                _ => printed,
            }
        });
        grid.add_row(std::iter::once(label(row.label)).chain(cells).collect::<Vec<_>>());
    }
    for (index, column) in grid.column_iter_mut().enumerate() {
        column.set_cell_alignment(if index > 0 { CellAlignment::Right } else { CellAlignment::Left });
    }
    grid.lines().fold(String::new(), |text, line| text + line.trim_end() + "\n")
}

fn words(difference: &Difference, units: Units) -> String {
    let show = |value: f64| {
        if difference.number.is_length() {
            format!("{} {}", units.length(value), units.length_word())
        } else {
            format!("{} {}", units.angle(value), units.angle_word())
        }
    };
    let (vendor, robot) = (show(difference.vendor), show(difference.robot));
    let place = format!("row {}: {}", label(difference.label), difference.number.word());
    match difference.nature {
        Nature::Sign => {
            format!("{place} is {vendor} in the table and {robot} in the robot: opposite sign")
        }
        Nature::OtherSideOfJoint { with } => format!(
            "{place} is {vendor} in the table and {robot} in the robot, which has it on the other side of the joint, in row {}",
            label(with)
        ),
        Nature::Amount => format!("{place} is {vendor} in the table and {robot} in the robot"),
    }
}
