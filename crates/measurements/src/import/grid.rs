//! Bytes of a text file or a spreadsheet as rows of cells under a header, with the line of each.

use super::super::known_columns::MOST_COLUMNS;
use super::problem::{Fault, ImportProblem};
use super::{records, sheet};
use denavit_model::units::Unit;
use encoding_rs::{Encoding, UTF_8, UTF_16BE, UTF_16LE, WINDOWS_1252};

/// Cells under names.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Grid {
    /// The columns' names.
    pub names: Vec<String>,
    /// Their units, where the file gives them.
    pub units: Vec<Option<String>>,
    /// Line of the header.
    pub header_line: usize,
    /// Line and cells of each row.
    pub rows: Vec<(usize, Vec<String>)>,
    /// Notes on how the file was read.
    pub notes: Vec<String>,
    /// Line and text above the header that is not read.
    pub ignored: Vec<(usize, String)>,
    /// Whether numbers are written with a comma.
    pub decimal_comma: bool,
    /// Whether the file is text as our own contract has it: UTF-8, commas, points.
    pub plain: bool,
    /// Whether it is a workbook or a list of records.
    pub is_sheet: bool,
    /// What separates columns; `None` for blanks.
    pub separator: Option<char>,
}

/// Units in a row of units, other than those of lengths and angles.
const OTHER_UNITS: [&str; 9] = ["s", "ms", "sec", "kg", "°c", "c", "-", "", "1"];
/// Number of letters shown of a line that is not read.
const LETTERS_SHOWN: usize = 60;
/// Most lines of other text at the start of a file.
const MOST_LINES_ABOVE: usize = 200;

/// The text of bytes in UTF-8, UTF-16 or windows-1252, and the encoding that was assumed.
pub(super) fn decoded(bytes: &[u8]) -> (String, &'static str) {
    let zeros = |odd: usize| bytes.iter().take(2000).skip(odd).step_by(2).filter(|byte| **byte == 0).count();
    let many = bytes.len().min(2000) / 8;
    let encoding = match Encoding::for_bom(bytes) {
        Some((encoding, _)) => encoding,
        None if zeros(1) > many.max(1) => UTF_16LE,
        None if zeros(0) > many.max(1) => UTF_16BE,
        None if std::str::from_utf8(bytes).is_ok() => UTF_8,
        None => WINDOWS_1252,
    };
    let (text, used, _) = encoding.decode(bytes);
    (text.into_owned(), used.name())
}

/// A number, with a decimal comma where the file writes them.
pub(super) fn number(cell: &str, decimal_comma: bool) -> Option<f64> {
    let cell = cell.trim();
    let value = if decimal_comma { cell.replace(',', ".").parse() } else { cell.parse::<f64>() };
    value.ok().filter(|value| value.is_finite())
}

fn looks_numeric(cell: &str) -> bool {
    number(cell, true).is_some()
}

/// Whether a file is an Excel workbook, which is a zip archive.
pub(super) fn is_workbook(bytes: &[u8]) -> bool {
    bytes.starts_with(b"PK\x03\x04")
}

/// Reads a file into cells; `is_joint` says whether a name is a joint's, which identifies the header row.
pub(super) fn read(bytes: &[u8], is_joint: &dyn Fn(&str) -> bool) -> Result<Grid, Fault> {
    if is_workbook(bytes) {
        let mut grid = laid_out(sheet::rows(bytes)?, is_joint)?;
        (grid.plain, grid.is_sheet) = (false, true);
        grid.notes.insert(0, "read as an Excel workbook, its first sheet with data".into());
        return Ok(grid);
    }
    let (text, encoding) = decoded(bytes);
    if let Some(rows) = records::rows(&text)? {
        let mut grid = laid_out(rows, is_joint)?;
        (grid.plain, grid.is_sheet) = (false, true);
        grid.notes.insert(0, "read as a list of records".into());
        return Ok(grid);
    }
    let separator = separator(&text);
    let split = |line: &str| -> Vec<String> {
        match separator {
            None => line.split_whitespace().map(str::to_owned).collect(),
            Some(separator) => cells(line, separator),
        }
    };
    let lines = text
        .lines()
        .enumerate()
        .map(|(index, line)| (index + 1, line.trim_end_matches('\r')))
        .filter(|(_, line)| is_data(line))
        .map(|(line, text)| (line, split(text)))
        .collect();
    let mut grid = laid_out(lines, is_joint)?;
    let commas = |row: &Vec<String>| row.iter().any(|cell| cell.contains(',') && looks_numeric(cell));
    grid.decimal_comma = separator != Some(',') && grid.rows.iter().any(|(_, row)| commas(row));
    grid.separator = separator;
    grid.plain = encoding == "UTF-8" && separator == Some(',') && grid.plain;
    if encoding != "UTF-8" {
        grid.notes.push(format!("text in {encoding}"));
    }
    let word = match separator {
        Some(',') => "",
        Some(';') => "semicolons",
        Some('\t') => "tabs",
        _ => "blanks",
    };
    if !word.is_empty() {
        grid.notes.push(format!("columns separated by {word}"));
    }
    if grid.decimal_comma {
        grid.notes.push("decimal commas".into());
    }
    Ok(grid)
}

/// Cells of a line, quoted ones unquoted.
fn cells(line: &str, separator: char) -> Vec<String> {
    let mut reader = csv::ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .trim(csv::Trim::All)
        .delimiter(u8::try_from(separator).unwrap_or(b','))
        .from_reader(line.as_bytes());
    let first = reader.records().next();
    first.and_then(Result::ok).map_or_else(Vec::new, |record| record.iter().map(str::to_owned).collect())
}

/// Neither empty nor a comment: `#`, or `//` as SpatialAnalyzer writes them.
fn is_data(line: &str) -> bool {
    let line = line.trim_start();
    let is_comment = line.starts_with("//") || line.starts_with('#') && !line.starts_with("#N/A");
    !line.is_empty() && !is_comment
}

/// What separates columns: `None` for blanks.
fn separator(text: &str) -> Option<char> {
    let lines = || text.lines().filter(|line| is_data(line)).take(MOST_LINES_ABOVE);
    let most = |separator: char| lines().map(|line| line.matches(separator).count()).max().unwrap_or(0);
    [';', '\t', ','].into_iter().find(|separator| most(*separator) >= 2)
}

/// Finds the header, a row of units and the rows among lines of cells.
fn laid_out(mut lines: Vec<(usize, Vec<String>)>, is_joint: &dyn Fn(&str) -> bool) -> Result<Grid, Fault> {
    let named = lines.iter().take(MOST_LINES_ABOVE).position(|(_, cells)| cells.iter().any(|cell| is_joint(cell)));
    if let Some(header) = named {
        let mut rows = lines.split_off(header + 1);
        let Some((header_line, names)) = lines.pop() else { return Err(no_rows()) };
        few_enough(header_line, names.len())?;
        let mut grid =
            Grid { plain: header == 0, header_line, units: vec![None; names.len()], names, ..Grid::default() };
        grid.not_read(&lines);
        if rows.first().is_some_and(|(_, cells)| is_units(cells)) {
            let (line, cells) = rows.remove(0);
            grid.take_units(line, &cells);
        }
        grid.rows = rows;
        return Ok(grid);
    }
    let is_data = |cells: &Vec<String>| {
        let filled = cells.iter().filter(|cell| !cell.is_empty()).count();
        let numbers = cells.iter().filter(|cell| looks_numeric(cell)).count();
        numbers >= 3 && 2 * numbers >= filled
    };
    let first = lines.iter().take(MOST_LINES_ABOVE).position(|(_, cells)| is_data(cells)).ok_or_else(no_rows)?;
    let rows = lines.split_off(first);
    let width = rows.first().map_or(0, |(_, cells)| cells.len());
    few_enough(rows.first().map_or(0, |(line, _)| *line), width)?;
    let mut above = lines;
    let mut grid = Grid { plain: first == 1, units: vec![None; width], rows, ..Grid::default() };
    let units =
        if above.len() > 1 && above.last().is_some_and(|(_, cells)| is_units(cells)) { above.pop() } else { None };
    let markers = above.iter().find(|(_, cells)| cells.first().is_some_and(|cell| cell == "MARKER_NAMES")).cloned();
    if let Some((line, cells)) = markers {
        // Qualisys: three columns per marker, after none, one or two of frame and time.
        let names: Vec<String> = cells[1..].iter().filter(|name| !name.is_empty()).cloned().collect();
        let before = width.saturating_sub(3 * names.len());
        grid.header_line = line;
        grid.plain = false;
        let words = if before == 1 { vec!["time"] } else { vec!["frame", "time"] };
        grid.names = words.into_iter().take(before).map(str::to_owned).collect();
        grid.names.extend(names.iter().flat_map(|name| ["X", "Y", "Z"].map(|axis| format!("{name} {axis}"))));
        grid.notes.push(format!("columns named by the markers of line {line}"));
    } else if let Some((line, names)) = above.pop_if(|(_, cells)| cells.len() >= 3) {
        grid.header_line = line;
        grid.names = names;
        grid.names.resize(width.max(grid.names.len()), String::new());
        let used = grid.names_from_above(&above);
        above.retain(|(line, _)| !used.contains(line));
        grid.not_read(&above);
    } else {
        grid.plain = false;
        grid.names = (1..=width).map(|k| format!("column {k}")).collect();
        grid.notes.push("no header row; columns are called \"column 1\", \"column 2\", …".into());
    }
    grid.units.resize(grid.names.len(), None);
    if let Some((line, cells)) = units {
        grid.take_units(line, &cells);
    }
    Ok(grid)
}

fn few_enough(line: usize, columns: usize) -> Result<(), Fault> {
    let problem = ImportProblem::Columns { found: columns, most: MOST_COLUMNS };
    if columns > MOST_COLUMNS { Err(Fault { line, problem }) } else { Ok(()) }
}

fn no_rows() -> Fault {
    Fault { line: 0, problem: ImportProblem::NoRows }
}

fn is_units(cells: &[String]) -> bool {
    let word = |cell: &String| cell.trim_matches(['[', ']', '(', ')']).to_lowercase();
    let measures = |cell: &String| Unit::of_any(&word(cell)).is_some();
    cells.len() >= 3
        && cells.iter().all(|cell| measures(cell) || OTHER_UNITS.contains(&word(cell).as_str()))
        && cells.iter().any(measures)
}

impl Grid {
    fn take_units(&mut self, line: usize, cells: &[String]) {
        let unit = |cell: &String| {
            let word = cell.trim_matches(['[', ']', '(', ')']);
            (!["", "-", "1"].contains(&word)).then(|| word.to_owned())
        };
        self.units = (0..self.names.len()).map(|k| cells.get(k).and_then(unit)).collect();
        self.notes.push(format!("line {line} is a row of units"));
        self.plain = false;
    }

    /// Where names repeat (X, Y, Z for each body), prefixes those of the lines above: Motive, Vicon.
    /// Returns the lines that were used.
    fn names_from_above(&mut self, above: &[(usize, Vec<String>)]) -> Vec<usize> {
        let mut used = Vec::new();
        let repeats =
            |names: &[String]| (0..names.len()).any(|k| !names[k].is_empty() && names[..k].contains(&names[k]));
        for (line, cells) in above.iter().rev() {
            if !repeats(&self.names) {
                return used;
            }
            let filled = cells.iter().filter(|cell| !cell.is_empty()).count();
            let identifiers =
                cells.iter().any(|cell| cell.len() >= 30 && cell.chars().all(|c| c.is_ascii_hexdigit() || c == '-'));
            if filled < 2 && cells.len() < 3 || identifiers {
                continue;
            }
            let mut last = String::new();
            for (k, name) in self.names.iter_mut().enumerate() {
                if let Some(cell) = cells.get(k).filter(|cell| !cell.is_empty()) {
                    last.clone_from(cell);
                }
                let known = ["Frame", "Sub Frame", "Time"].iter().any(|word| name.starts_with(word)) || name.is_empty();
                if !last.is_empty() && !known {
                    *name = format!("{last}.{name}");
                }
            }
            self.plain = false;
            self.notes.push(format!("names of line {line} are prefixed to those of line {}", self.header_line));
            used.push(*line);
        }
        used
    }

    /// Notes which lines above the header are not read.
    fn not_read(&mut self, above: &[(usize, Vec<String>)]) {
        let Some((first, cells)) = above.first() else { return };
        let text = cells.iter().filter(|cell| !cell.is_empty()).map(String::as_str).collect::<Vec<_>>().join(" ");
        let cut: String = text.chars().take(LETTERS_SHOWN).collect();
        let more = if cut.len() < text.len() { " …" } else { "" };
        let lines = match above {
            [_] => format!("line {first}"),
            [.., (last, _)] => format!("lines {first} to {last}"),
            [] => return,
        };
        self.notes.push(format!("{lines} above the header not read: \"{cut}{more}\""));
        self.ignored.extend(above.iter().map(|(line, cells)| (*line, cells.join(" "))));
    }

    /// Index of a column by its exact name, else by its name without case, else by its number: `column 7`.
    pub fn column(&self, name: &str) -> Option<usize> {
        let exact = self.names.iter().position(|known| known == name);
        let placed = || {
            let place = name.trim().strip_prefix("column ")?.parse::<usize>().ok()?.checked_sub(1)?;
            (place < self.names.len()).then_some(place)
        };
        let named = || self.names.iter().position(|known| known.trim().eq_ignore_ascii_case(name.trim()));
        exact.or_else(named).or_else(placed)
    }
}
