//! The rows of a file: lines in any encoding, cells, numbers, and the problems found.

use super::measurement_error::{DataError, DataProblem, FAULTS, MeasurementError};
use encoding_rs::WINDOWS_1252;
use std::cell::Cell;
use std::io::{BufRead as _, Read};
use std::rc::Rc;

/// Most problems listed.
pub(super) const MOST_PROBLEMS: usize = 10;
/// Largest number of a joint or of an instrument in a file: a thousand kilometres in micrometres. Squares of larger ones may
/// overflow.
const LARGEST_WRITTEN: f64 = 1e12;

/// The rows of a file, header included, `#` lines left out.
pub(super) fn rows_of(input: impl Read) -> csv::Reader<impl Read> {
    rows_of_any_encoding(input).0
}

/// The same, and whether some line so far was not UTF-8, which is then read as windows-1252.
pub(super) fn rows_of_any_encoding(input: impl Read) -> (csv::Reader<impl Read>, Rc<Cell<bool>>) {
    let lines = Lines::new(LineFeeds(input));
    let foreign = lines.foreign.clone();
    let reader = csv::ReaderBuilder::new()
        .comment(Some(b'#'))
        .flexible(true)
        .has_headers(false)
        .trim(csv::Trim::All)
        .from_reader(lines.chain(&b"\n"[..]));
    (reader, foreign)
}

/// The names in the header row, and its line.
pub(super) fn header_row(reader: &mut csv::Reader<impl Read>, source: &str) -> Result<(Vec<String>, u64), DataError> {
    let mut record = csv::StringRecord::new();
    let (line, problem) = match reader.read_record(&mut record) {
        Ok(true) => {
            let names = record.iter().map(|name| name.trim_start_matches('\u{feff}').to_owned()).collect();
            return Ok((names, reader.position().line() - 1));
        }
        Ok(false) => (0, MeasurementError::NoHeader),
        Err(error) => (line_of(&error), unreadable(&error)),
    };
    Err(Problems::new(source).only(line, problem))
}

/// Input whose lines end in a line feed only: then a record's last line is the one before its reader's position.
///
/// A record's own position is not used: it counts from before the comments above it.
struct LineFeeds<R>(R);

impl<R: Read> Read for LineFeeds<R> {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        loop {
            let count = self.0.read(buffer)?;
            let mut kept = 0;
            for index in 0..count {
                if buffer[index] != b'\r' {
                    buffer[kept] = buffer[index];
                    kept += 1;
                }
            }
            if kept > 0 || count == 0 {
                return Ok(kept);
            }
        }
    }
}

/// Input line by line, in UTF-8. A row that begins with a spreadsheet's error is a row, not a comment: a blank goes before it.
struct Lines<R> {
    input: std::io::BufReader<R>,
    line: Vec<u8>,
    at: usize,
    /// Whether some line was not UTF-8.
    foreign: Rc<Cell<bool>>,
}

impl<R: Read> Lines<R> {
    fn new(input: R) -> Self {
        Self { input: std::io::BufReader::new(input), line: Vec::new(), at: 0, foreign: Rc::default() }
    }
}

impl<R: Read> Read for Lines<R> {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        if self.at == self.line.len() {
            self.line.clear();
            self.at = 0;
            self.input.read_until(b'\n', &mut self.line)?;
            if std::str::from_utf8(&self.line).is_err() {
                self.line = WINDOWS_1252.decode_without_bom_handling(&self.line).0.into_owned().into_bytes();
                self.foreign.set(true);
            }
            let fault = |fault: &str| {
                let rest = self.line.strip_prefix(fault.as_bytes());
                rest.is_some_and(|rest| rest.first().is_none_or(|next| b",;\t\n ".contains(next)))
            };
            if FAULTS.iter().any(|known| fault(known)) {
                self.line.insert(0, b' ');
            }
        }
        let count = buffer.len().min(self.line.len() - self.at);
        buffer[..count].copy_from_slice(&self.line[self.at..self.at + count]);
        self.at += count;
        Ok(count)
    }
}

pub(super) fn line_of(error: &csv::Error) -> u64 {
    error.position().map_or(0, csv::Position::line)
}

pub(super) fn unreadable(error: &csv::Error) -> MeasurementError {
    match error.kind() {
        csv::ErrorKind::Utf8 { .. } => MeasurementError::Unreadable("the text is not UTF-8".into()),
        csv::ErrorKind::Io(error) => MeasurementError::Unreadable(error.to_string()),
        _ => MeasurementError::Unreadable(error.to_string()),
    }
}

/// Problems of a file while it is read.
pub(super) struct Problems<'a> {
    source: &'a str,
    pub found: Vec<DataProblem>,
    more: usize,
}

impl<'a> Problems<'a> {
    pub fn new(source: &'a str) -> Self {
        Self { source, found: Vec::new(), more: 0 }
    }

    pub fn add(&mut self, line: u64, problem: MeasurementError) {
        if self.found.len() < MOST_PROBLEMS {
            self.found.push(DataProblem { file: self.source.into(), line, problem });
        } else {
            self.more += 1;
        }
    }

    pub fn error(self) -> DataError {
        DataError { problems: self.found, more: self.more }
    }

    pub fn only(mut self, line: u64, problem: MeasurementError) -> DataError {
        self.add(line, problem);
        self.error()
    }
}

/// A finite number.
pub(super) fn number(column: &str, cell: &str) -> Result<f64, MeasurementError> {
    if cell.is_empty() {
        return Err(MeasurementError::Empty { column: column.into() });
    }
    match cell.parse::<f64>() {
        Ok(value) if value.abs() <= LARGEST_WRITTEN => Ok(value),
        Ok(value) if value.is_finite() => Err(MeasurementError::TooLarge { column: column.into(), text: cell.into() }),
        Ok(_) => Err(MeasurementError::NotFinite {
            column: column.into(),
            text: cell.into(),
            fix: if column.starts_with(['x', 'y', 'z']) && column[1..].chars().all(|c| c.is_ascii_digit()) {
                "leave the cells of a target empty where it was not seen"
            } else {
                "correct the cell or remove the row"
            },
        }),
        Err(_) => Err(MeasurementError::NotANumber { column: column.into(), text: cell.into() }),
    }
}
