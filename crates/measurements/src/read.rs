//! Reading a measurement file, row by row.

use super::columns::{self, ColumnUse};
use super::data_note::DataNote;
use super::header::{CornerOf, Header, Role, quantity_of, tip_names};
use super::images::{self, Images};
use super::import::{ImportOptions, Imported, import};
use super::join::in_setup;
use super::known_columns::KNOWN_COVARIATES;
use super::measurement_error::{DataError, MeasurementError};
use super::plausible;
use super::rows::{Problems, header_row, line_of, number, rows_of_any_encoding, unreadable};
use super::units::Units;
use super::{Covariate, Label, Measurements, Scene, Target, target_on};
use denavit_model::nalgebra::{Matrix3, Vector3};
use denavit_model::{Chain, Inventory, Place, Quantity, Tips};
use encoding_rs::WINDOWS_1252;
use std::io::Read;
use std::sync::Arc;

/// Bytes of a file that show its form; a larger file in the contract's form is read row by row.
const HEAD: u64 = 1 << 18;
/// Largest recorded number: the time since 1970 in nanoseconds has 19 digits.
const LARGEST_RECORDED: f64 = 1e20;
/// Largest relative deviation of gravity read by an accelerometer at rest, due to scales and zeros of its axes.
const UNEVEN: f64 = 0.02;
/// Smallest standard deviation of an instrument, m.
const LEAST_DEVIATION: f64 = 1e-12;

/// A measurement file's content and notes for the user.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Loaded {
    /// The content, SI units.
    pub data: Measurements,
    /// Findings that are not errors.
    pub notes: Vec<DataNote>,
    /// The meaning of every column, in the file's order.
    pub columns: Vec<ColumnUse>,
    /// What happened to every cell: understood, carried as a recorded number or a label, or not read, with a note.
    pub inventory: Inventory,
}

/// Reads measured data for a chain.
///
/// # Shape and units
/// CSV with a header row; `#` lines are comments. One column per coordinate of the chain, by name; measured values
/// `x,y,z`, with `qx,qy,qz,qw` for poses, or `x1,y1,z1,x2,…`, or `distance`. `units` are the file's; the result is in
/// m and rad. Other encodings, separators, decimal commas, rows of units, names in capitals or with a unit, and workbooks are
/// read as well, with a note.
///
/// # Errors
/// All problems found, each with file and line.
pub fn read(source: &str, input: impl Read, chain: &Chain, units: Units) -> Result<Loaded, DataError> {
    read_export(source, input, chain, units, &ImportOptions::default())
}

/// As [`read`], with options that describe the file's columns.
///
/// # Errors
/// As [`read`].
pub fn read_export(
    source: &str,
    input: impl Read,
    chain: &Chain,
    units: Units,
    options: &ImportOptions,
) -> Result<Loaded, DataError> {
    let mut head = Vec::new();
    let mut input = input;
    if let Err(error) = input.by_ref().take(HEAD).read_to_end(&mut head) {
        return Err(Problems::new(source).only(0, MeasurementError::Unreadable(error.to_string())));
    }
    if head.len() as u64 == HEAD && begins_in_our_form(&head, chain, units, options) {
        return read_contract(source, head.chain(input), chain, units, options);
    }
    let whole = head.chain(input);
    let Imported { text, converted, taken, sources, angles, ignored } =
        in_our_form(source, whole, chain, units, options)?;
    let units = if converted { Units::default() } else { units };
    let mut loaded = read_contract(source, text.as_bytes(), chain, units, options)?;
    loaded.data.angles = angles.filter(|angles| angles.numbers.len() == loaded.data.len());
    loaded.notes.splice(0..0, taken.into_iter().map(DataNote::ReadAs));
    for (line, what) in ignored {
        loaded.inventory.report(Place { file: source.into(), line, element: "not read".into() }, what);
    }
    for column in &mut loaded.columns {
        if let Some((_, own)) = sources.iter().find(|(name, _)| *name == column.column) {
            column.column.clone_from(own);
        }
    }
    Ok(loaded)
}

/// Whether the first lines of a file need no import.
fn begins_in_our_form(head: &[u8], chain: &Chain, units: Units, options: &ImportOptions) -> bool {
    let lines = &head[..head.iter().rposition(|byte| *byte == b'\n').map_or(0, |end| end + 1)];
    import(lines, chain, units, options)
        .is_ok_and(|imported| !imported.converted && imported.taken.is_empty() && imported.text.as_bytes() == lines)
}

/// A file of any form, converted to the contract's form.
pub(super) fn in_our_form(
    source: &str,
    mut input: impl Read,
    chain: &Chain,
    units: Units,
    options: &ImportOptions,
) -> Result<Imported, DataError> {
    let mut bytes = Vec::new();
    if let Err(error) = input.read_to_end(&mut bytes) {
        return Err(Problems::new(source).only(0, MeasurementError::Unreadable(error.to_string())));
    }
    import(&bytes, chain, units, options)
        .map_err(|fault| Problems::new(source).only(fault.line as u64, MeasurementError::Import(fault.problem)))
}

fn read_contract(
    source: &str,
    input: impl Read,
    chain: &Chain,
    units: Units,
    options: &ImportOptions,
) -> Result<Loaded, DataError> {
    let sight = options.sight.as_ref();
    let tips = options.tips.as_ref().filter(|tips| tips.several());
    let (mut reader, foreign) = rows_of_any_encoding(input);
    let mut problems = Problems::new(source);
    let mut record = csv::StringRecord::new();
    let (names, header_line) = header_row(&mut reader, source)?;
    let header = match Header::read(names, chain.coordinates(), sight, tips.map(|tips| &**tips)) {
        Ok(header) => header,
        Err(found) => {
            for problem in found {
                problems.add(header_line, problem);
            }
            return Err(problems.error());
        }
    };
    let mut table = Table::new(&header, chain, units, source, tips);
    table.images = sight.map(Images::new);
    loop {
        match reader.read_record(&mut record) {
            Ok(true) => table.row(&record, reader.position().line() - 1, &mut problems),
            Ok(false) => break,
            Err(error) => {
                problems.add(line_of(&error), unreadable(&error));
                break;
            }
        }
    }
    let mut loaded = table.finish(chain, problems)?;
    if foreign.get() {
        loaded.notes.insert(0, DataNote::ReadAs(format!("text in {}", WINDOWS_1252.name())));
    }
    Ok(loaded)
}

/// A column that is neither joint nor measured value, before it is known whether it holds numbers.
struct OtherColumn {
    name: String,
    factor: f64,
    numbers: Vec<f64>,
    texts: Vec<String>,
    /// The first cell that is not a number: row index, line, text.
    first_text: Option<(usize, u64, String)>,
    /// The first number above the largest recorded number: line, text.
    beyond: Option<(u64, String)>,
    must_be_numeric: bool,
}

struct Table<'a> {
    header: &'a Header,
    factors: Vec<f64>,
    data: Measurements,
    others: Vec<OtherColumn>,
    normalised_by: f64,
    /// Which series a group's observations in a setup, with a label, at a tip, belong to.
    series: Vec<(usize, String, String, usize, usize)>,
    /// The tips, if there are several, and the current row's.
    tips: Option<Arc<Tips>>,
    tip: usize,
    /// Standard deviations of the lengths of each observation, m.
    spreads: Vec<[f64; 3]>,
    /// Lines, and the size there of a quantity that is constant for a sensor at rest.
    strengths: Vec<(u64, f64)>,
    /// The camera, where there is one.
    images: Option<Images<'a>>,
}

impl<'a> Table<'a> {
    fn new(header: &'a Header, chain: &Chain, units: Units, source: &str, tips: Option<&Arc<Tips>>) -> Self {
        let coordinates = chain.coordinates();
        let of = |quantity: Quantity| if quantity == Quantity::Angle { units.angle } else { units.length };
        let factor = |(name, role): (&String, &Role)| match role {
            Role::Joint(index) => of(coordinates[*index].quantity),
            Role::Value(group, column) if *column < header.groups[*group].kind.lengths() => units.length,
            Role::Value(group, _) if header.groups[*group].kind.has_angles() => units.angle,
            Role::Other => quantity_of(name, coordinates).map_or(1.0, of),
            Role::Spread(_) | Role::Corner => units.length,
            Role::Value(..) | Role::Locate => 1.0,
        };
        let factors: Vec<f64> = header.names.iter().zip(&header.roles).map(factor).collect();
        let tells_apart = |name: &String| {
            let columns = header.groups.iter().filter_map(|group| group.label).chain(header.setup).chain(header.tip);
            columns.into_iter().any(|column| header.names[column] == *name)
        };
        let other = |((name, role), factor): ((&String, &Role), &f64)| {
            (*role == Role::Other).then(|| OtherColumn {
                name: name.clone(),
                factor: *factor,
                numbers: Vec::new(),
                texts: Vec::new(),
                first_text: tells_apart(name).then(|| (0, 0, String::new())),
                beyond: None,
                must_be_numeric: KNOWN_COVARIATES.contains(&name.as_str())
                    || name.rsplit_once('.').is_some_and(|(joint, _)| coordinates.iter().any(|c| c.name == joint)),
            })
        };
        let others = header.names.iter().zip(&header.roles).zip(&factors).filter_map(other).collect();
        let joints = coordinates.iter().map(|coordinate| coordinate.name.clone()).collect();
        let mut data = Measurements::empty(source, joints, Scene::of_tips(tips.cloned()));
        let mut series = Vec::new();
        // Series without labels exist even if no row observes them.
        for (group, of) in header.groups.iter().enumerate() {
            if header.setup.is_none() && header.tip.is_none() && of.label.is_none() && of.corner.is_none() {
                let (setup, target, _) = in_setup(of.kind, "", &of.target, "");
                let own = data.scene.add(of.kind, &setup, Target::alone(&target), None);
                series.push((group, String::new(), String::new(), 0, own));
            }
        }
        let tips = tips.cloned();
        let (spreads, strengths, images) = (Vec::new(), Vec::new(), None);
        Self { header, factors, data, others, normalised_by: 0.0, series, tips, tip: 0, spreads, strengths, images }
    }

    fn row(&mut self, record: &csv::StringRecord, line: u64, problems: &mut Problems<'_>) {
        let expected = self.header.names.len();
        if record.len() != expected {
            problems.add(line, MeasurementError::Ragged { found: record.len(), expected });
            return;
        }
        for tip in self.tips_of(record, line, problems) {
            self.tip = tip;
            self.row_at_tip(record, line, problems);
        }
    }

    /// The row for one of its tips.
    fn row_at_tip(&mut self, record: &csv::StringRecord, line: u64, problems: &mut Problems<'_>) {
        let row = self.data.lines.len();
        let goes_on = self.images.as_mut().is_some_and(|images| images.goes_on(self.header, record));
        let mut reading = vec![0.0; self.data.joints.len()];
        let mut cells: Vec<Vec<Option<f64>>> =
            self.header.groups.iter().map(|of| vec![None; of.columns.len()]).collect();
        let mut unreadable = vec![false; cells.len()];
        let mut spreads = vec![[f64::NAN; 3]; cells.len()];
        let mut locate = false;
        let mut other = 0;
        for (column, cell) in record.iter().enumerate() {
            let name = &self.header.names[column];
            let role = self.header.roles[column];
            if role == Role::Other {
                if !goes_on {
                    self.others[other].take(row, line, cell);
                }
                other += 1;
                continue;
            }
            if role == Role::Corner {
                continue;
            }
            if let Role::Value(group, _) = role
                && cell.is_empty()
                && (self.header.groups.len() > 1 || self.header.groups[group].kind.of_several())
                && !matches!(self.header.groups[group].corner, Some(CornerOf::Numbered(_) | CornerOf::Placed(_)))
            {
                continue;
            }
            if let Role::Joint(index) = role
                && cell.is_empty()
                && self.tips.as_ref().is_some_and(|tips| !tips[self.tip].coordinates[index])
            {
                // It does not move this tip.
                continue;
            }
            let value = match number(name, cell) {
                Ok(value) => value * self.factors[column],
                Err(problem) => {
                    problems.add(line, problem);
                    if let Role::Value(group, _) = role {
                        unreadable[group] = true;
                    }
                    0.0
                }
            };
            match role {
                Role::Joint(index) => reading[index] = value,
                Role::Value(group, column) => cells[group][column] = Some(value),
                Role::Spread(of) => {
                    if value < LEAST_DEVIATION && !cell.is_empty() {
                        problems.add(line, MeasurementError::NotADeviation { column: name.clone(), value });
                    }
                    match of {
                        Some((group, column)) => spreads[group][column] = value,
                        None => spreads.iter_mut().for_each(|spread| *spread = [value; 3]),
                    }
                }
                Role::Locate => {
                    if value != 0.0 && value != 1.0 {
                        problems.add(line, MeasurementError::NotAFlag(value));
                    }
                    locate = value != 0.0;
                }
                Role::Other | Role::Corner => {}
            }
        }
        if goes_on {
            self.data.observed.resume_row();
        }
        for (group, cells) in cells.iter().enumerate().filter(|(group, _)| !unreadable[*group]) {
            let label = |column: Option<usize>| column.and_then(|column| record.get(column)).unwrap_or("");
            let of = &self.header.groups[group];
            let setup = label(self.header.setup);
            if of.corner.is_some() {
                self.corner(line, group, setup, record, cells, problems);
                continue;
            }
            self.observation(line, group, [setup, label(of.label)], cells, spreads[group], problems);
        }
        if goes_on {
            self.data.observed.end_row();
            return;
        }
        self.data.end_row(&reading, usize::try_from(line).unwrap_or(usize::MAX), locate);
    }

    /// The tip of a row, or both tips of a contact; none where it names no tip.
    fn tips_of(&self, record: &csv::StringRecord, line: u64, problems: &mut Problems<'_>) -> Vec<usize> {
        let (Some(tips), Some(column)) = (&self.tips, self.header.tip) else { return vec![0] };
        let found = record.get(column).unwrap_or("");
        let mut both = self.header.groups.iter().filter(|group| group.of_two_tips).filter_map(|group| group.label);
        let touching = both.any(|column| record.get(column).is_some_and(|label| !label.is_empty()));
        let named: Vec<Option<usize>> = match found.split_once('+').filter(|_| touching) {
            Some((first, second)) => [first, second].map(|name| tips.position(name.trim())).into(),
            None => vec![tips.position(found)],
        };
        let known: Vec<usize> = named.iter().flatten().copied().collect();
        let problem = match known[..] {
            [first, second] if touching && first != second => return known,
            [_] if !touching && named.len() == 1 => return known,
            _ if touching => MeasurementError::NotTwoTips { found: found.into(), tips: tip_names(tips) },
            _ => MeasurementError::NotATip { found: found.into(), tips: tip_names(tips) },
        };
        problems.add(line, problem);
        Vec::new()
    }

    /// The name of a target of the current row, and its tip.
    fn target(&self, name: &str) -> String {
        self.tips.as_ref().map_or_else(|| name.to_owned(), |tips| target_on(&tips[self.tip].name, name))
    }

    /// The observation in the cells of a group; not seen if all are empty.
    fn observation(
        &mut self,
        line: u64,
        group: usize,
        [setup, label]: [&str; 2],
        cells: &[Option<f64>],
        spread: [f64; 3],
        problems: &mut Problems<'_>,
    ) {
        let of = &self.header.groups[group];
        let there: Vec<f64> = cells.iter().flatten().copied().collect();
        if there.is_empty() && (!cells.is_empty() || label.is_empty()) {
            return;
        }
        if there.len() < cells.len() {
            problems.add(line, MeasurementError::PartOfTarget { target: of.target.clone() });
            return;
        }
        let mut values = Vec::new();
        match of.kind.of_cells(&there, &mut values) {
            Ok(changed) => {
                self.normalised_by = self.normalised_by.max(changed);
                self.strengths.extend(of.kind.strength(&there).map(|strength| (line, strength)));
                let series = self.series_of(group, setup, label, line);
                self.data.observed.push(series, &values);
                self.keep_spread(spread);
            }
            Err(problem) => problems.add(line, problem),
        }
    }

    /// A corner of a board; empty cells: not seen.
    fn corner(
        &mut self,
        line: u64,
        group: usize,
        setup: &str,
        record: &csv::StringRecord,
        cells: &[Option<f64>],
        problems: &mut Problems<'_>,
    ) {
        let (of, Some(images)) = (&self.header.groups[group], self.images.as_ref()) else { return };
        let [u, v] = match *cells {
            [None, None] => return,
            [Some(u), Some(v)] => [u, v],
            _ => {
                let corner = of.columns[0][1..].to_owned();
                problems.add(line, MeasurementError::PartOfCorner { corner, columns: of.columns.join(", ") });
                return;
            }
        };
        let corner = match images.corner(self.header, of, record, &self.factors) {
            Ok(corner) => corner,
            Err(problem) => {
                problems.add(line, problem);
                return;
            }
        };
        if let Some(problem) = images.outside(&of.columns, [u, v]) {
            problems.add(line, problem);
            return;
        }
        let (setup, target, _) = in_setup(of.kind, setup, &self.target(&of.target), "");
        let label = corner.label.clone();
        let tip = self.tip;
        let same = |known: &&(usize, String, String, usize, usize)| {
            known.0 == group && known.1 == setup && known.2 == label && known.3 == tip
        };
        let series = if let Some(known) = self.series.iter().find(same) {
            known.4
        } else {
            let series = self.data.scene.add_corner(of.kind, &setup, Target { name: &target, tip }, corner);
            self.series.push((group, setup, label.clone(), tip, series));
            series
        };
        if self.data.observed.since_row_began().any(|observation| self.data.observed.series(observation) == series) {
            problems.add(line, MeasurementError::CornerTwice { corner: label });
            return;
        }
        self.data.observed.push(series, &[u, v]);
        self.keep_spread([f64::NAN; 3]);
    }

    fn series_of(&mut self, group: usize, setup: &str, label: &str, line: u64) -> usize {
        let (tip, of) = (self.tip, &self.header.groups[group]);
        // Where two tips touch, the label names their points, and each row has its own contact position.
        let (target, label) = if of.of_two_tips {
            (format!("{} {label}", of.target), format!("{label}, line {line}"))
        } else {
            (of.target.clone(), label.to_owned())
        };
        let same = |known: &&(usize, String, String, usize, usize)| {
            known.0 == group && known.1 == setup && known.2 == label && known.3 == tip
        };
        if let Some(known) = self.series.iter().rev().find(same) {
            return known.4;
        }
        let (own, target, point) = in_setup(of.kind, setup, &self.target(&target), &label);
        let series = self.data.scene.add(of.kind, &own, Target { name: &target, tip }, Some(&point));
        self.series.push((group, setup.into(), label, tip, series));
        series
    }

    /// Whether rows have standard deviations.
    fn has_spreads(&self) -> bool {
        self.header.roles.iter().any(|role| matches!(role, Role::Spread(_)))
    }

    fn keep_spread(&mut self, spread: [f64; 3]) {
        if self.has_spreads() {
            self.spreads.push(spread);
        }
    }

    /// The precision of each observation relative to its channel.
    fn levels(&mut self) {
        if !self.has_spreads() {
            return;
        }
        let channels = self.data.scene.channels.len();
        let (mut sums, mut counts) = (vec![0.0; channels], vec![0.0; channels]);
        let channel = |observation: usize| self.data.series_of(observation).channels[0].unwrap_or(0);
        let known = |spread: &[f64; 3]| spread.iter().filter(|s| s.is_finite()).map(|s| s.ln()).collect::<Vec<f64>>();
        for (observation, spread) in self.spreads.iter().enumerate() {
            let logarithms = known(spread);
            sums[channel(observation)] += logarithms.iter().sum::<f64>();
            counts[channel(observation)] += logarithms.len() as f64;
        }
        let level = |observation: usize, spread: &[f64; 3]| {
            let usual = (sums[channel(observation)] / f64::max(counts[channel(observation)], 1.0)).exp();
            let factor = |k: usize| if spread[k].is_finite() { usual / spread[k] } else { 1.0 };
            Matrix3::from_diagonal(&Vector3::new(factor(0), factor(1), factor(2)))
        };
        let levels = self.spreads.iter().enumerate().map(|(at, spread)| level(at, spread)).collect();
        self.data.observed.set_levels(levels);
    }

    fn finish(mut self, chain: &Chain, mut problems: Problems<'_>) -> Result<Loaded, DataError> {
        if self.data.lines.is_empty() && problems.found.is_empty() {
            problems.add(0, MeasurementError::NoRows);
        }
        for column in std::mem::take(&mut self.others) {
            column.finish(&mut self.data, &mut problems);
        }
        if !problems.found.is_empty() {
            return Err(problems.error());
        }
        if self.tips.is_none()
            && let Some((line, problem)) = another_tip(&self.data, chain)
        {
            problems.add(line, problem);
            return Err(problems.error());
        }
        let mut notes = Vec::new();
        // Rounding to six digits needs no note.
        if self.normalised_by > 1e-5 {
            notes.push(DataNote::Normalised { by: self.normalised_by });
        }
        notes.extend(uneven(&self.strengths));
        self.levels();
        if self.images.is_some() && !self.data.observed.is_empty() {
            match images::range(&self.data) {
                Some(range) => self.data.scene.set_range(range),
                None => problems.add(0, MeasurementError::NoBoardPose),
            }
        }
        plausible::drop_targets(&mut self.data, &mut notes);
        for (line, problem) in plausible::problems(&self.data, chain) {
            problems.add(line, problem);
        }
        if !problems.found.is_empty() {
            return Err(problems.error());
        }
        notes.extend(plausible::notes(&self.data, chain));
        self.data.shrink();
        let columns = columns::used(self.header, &self.data);
        let inventory = columns::inventory(self.header, &self.data);
        let lines = || (0..self.data.len()).filter(|&row| self.data.of_row(row).is_empty());
        if lines().next().is_some() {
            notes.push(DataNote::NothingMeasured { lines: lines().map(|row| self.data.lines[row]).collect() });
        }
        Ok(Loaded { data: self.data, notes, columns, inventory })
    }
}

/// The rows of an accelerometer in which it did not stand still.
fn uneven(strengths: &[(u64, f64)]) -> Option<DataNote> {
    let mut sorted: Vec<f64> = strengths.iter().map(|(_, strength)| *strength).collect();
    sorted.sort_by(f64::total_cmp);
    let usual = *sorted.get(sorted.len() / 2)?;
    let off = |strength: f64| (strength / usual - 1.0).abs();
    let lines: Vec<usize> = strengths
        .iter()
        .filter(|(_, strength)| off(*strength) > UNEVEN)
        .map(|(line, _)| usize::try_from(*line).unwrap_or(usize::MAX))
        .collect();
    let by = strengths.iter().map(|(_, strength)| off(*strength)).fold(0.0, f64::max);
    (!lines.is_empty()).then_some(DataNote::UnevenGravity { usual, by, lines })
}

/// The first row of another tip than the chain's.
fn another_tip(data: &Measurements, chain: &Chain) -> Option<(u64, MeasurementError)> {
    let named = data.labels.iter().find(|label| label.name == "tip")?;
    let row = named.values.iter().position(|tip| !tip.is_empty() && tip != chain.tip())?;
    let problem = MeasurementError::AnotherTip { found: named.values[row].clone(), tip: chain.tip().into() };
    Some((data.lines[row] as u64, problem))
}

impl OtherColumn {
    fn take(&mut self, row: usize, line: u64, cell: &str) {
        if self.first_text.is_none() {
            match cell.parse::<f64>() {
                Ok(value) if value.is_finite() => {
                    if value.abs() > LARGEST_RECORDED {
                        self.beyond.get_or_insert_with(|| (line, cell.into()));
                    }
                    self.numbers.push(value * self.factor);
                    return;
                }
                _ => {
                    self.first_text = Some((row, line, cell.into()));
                    // Earlier cells were read as numbers; as texts they get their shortest form.
                    self.texts = self.numbers.iter().map(|value| (value / self.factor).to_string()).collect();
                }
            }
        }
        self.texts.push(cell.into());
    }

    fn finish(self, data: &mut Measurements, problems: &mut Problems<'_>) {
        let Some((row, line, text)) = self.first_text else {
            if let Some((line, text)) = self.beyond {
                problems.add(line, MeasurementError::TooLarge { column: self.name, text });
                return;
            }
            let side = |value: &f64| *value == 0.0 || value.abs() == 1.0;
            let odd = self.name.ends_with(".approach").then(|| self.numbers.iter().position(|value| !side(value)));
            if let Some(row) = odd.flatten() {
                let problem = MeasurementError::NotASide { column: self.name, value: self.numbers[row] };
                problems.add(data.lines[row] as u64, problem);
                return;
            }
            data.covariates.push(Covariate { name: self.name, values: self.numbers });
            return;
        };
        let numeric = self.texts.iter().filter(|text| text.parse::<f64>().is_ok_and(f64::is_finite)).count();
        if self.must_be_numeric || row > 0 && 2 * numeric > self.texts.len() {
            problems
                .add(line, number(&self.name, &text).err().unwrap_or(MeasurementError::Empty { column: self.name }));
        } else {
            data.labels.push(Label { name: self.name, values: self.texts });
        }
    }
}
