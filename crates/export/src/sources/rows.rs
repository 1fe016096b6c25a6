//! Rows with named columns, from CSV with commas, semicolons or tabs, or from a Markdown table; with places for messages.

use super::cell::has_decimal_comma;
use super::header::Heading;
use super::stated::{Said, Stated};
use super::{SourceError, SourceErrorKind, place};

/// What separates columns.
const MARKS: [char; 4] = ['|', ';', '\t', ','];

/// A file's rows.
pub(super) struct Rows<'a> {
    pub file: &'a str,
    headings: Vec<Heading>,
    header_line: usize,
    records: Vec<Record>,
    said: Said,
}

struct Record {
    line: usize,
    cells: Vec<String>,
    /// Where each cell begins in its line, counted from 1.
    columns: Vec<usize>,
}

/// A row with its line.
#[derive(Clone, Copy)]
pub(super) struct RowOf<'a> {
    rows: &'a Rows<'a>,
    record: &'a Record,
}

impl<'a> Rows<'a> {
    pub fn read(file: &'a str, text: &str) -> Result<Self, SourceError> {
        let lines: Vec<&str> = text.lines().collect();
        let is_words = |line: &str| line.trim().is_empty() || line.trim_start().starts_with('#');
        let found = lines.iter().enumerate().find_map(|(index, line)| {
            let mark =
                MARKS.into_iter().find(|mark| is_header(&cut(line, *mark)) && !line.trim_start().starts_with('#'))?;
            Some((index, mark))
        });
        let (header, mark) = found.unwrap_or_else(|| {
            let first = lines.iter().position(|line| !is_words(line)).unwrap_or(0);
            (first, MARKS.into_iter().find(|mark| lines[first].contains(*mark)).unwrap_or(','))
        });
        let headings: Vec<Heading> = cut(lines[header], mark).iter().map(|(_, cell)| Heading::of(cell)).collect();
        let header_line = header + 1;
        let known: Vec<&Heading> = headings.iter().filter(|heading| !heading.name.is_empty()).collect();
        for (index, heading) in known.iter().enumerate() {
            if let Some(twin) = known[..index].iter().find(|twin| twin.name == heading.name) {
                let kind = SourceErrorKind::Twice { first: twin.written.clone(), second: heading.written.clone() };
                return Err(SourceError::at(place(file, header_line, "header"), kind));
            }
        }
        // Behind a Markdown table other things follow; behind a CSV header only comments are words.
        let comments = lines[header..].iter().filter(|line| mark != '|' && line.trim_start().starts_with('#'));
        let said = Said::in_words(lines[..header].iter().chain(comments).copied(), &headings);
        let mut records = Vec::new();
        for (index, line) in lines.iter().enumerate().skip(header + 1) {
            if mark == '|' && !line.contains('|') {
                break;
            }
            let is_rule = mark == '|' && line.chars().all(|c| "|-:= \t".contains(c));
            if is_rule || (mark != '|' && is_words(line)) {
                continue;
            }
            let (columns, cells): (Vec<usize>, Vec<String>) = cut(line, mark).into_iter().unzip();
            if cells.iter().any(|cell| !cell.is_empty()) {
                records.push(Record { line: index + 1, cells, columns });
            }
        }
        let rows = Self { file, headings, header_line, records, said };
        rows.one_decimal_mark()?;
        Ok(rows)
    }

    /// Decimal commas beside decimal points in one file: one of the two is something else.
    fn one_decimal_mark(&self) -> Result<(), SourceError> {
        let mut first: Option<bool> = None;
        for row in self.iter() {
            for heading in self.headings.iter().filter(|heading| is_number(&heading.name)) {
                match (first, has_decimal_comma(row.text(&heading.name))) {
                    (Some(known), Some(found)) if known != found => {
                        return Err(row.error_in(&heading.name, SourceErrorKind::DecimalMarks));
                    }
                    (None, found) => first = found,
                    _ => {}
                }
            }
        }
        Ok(())
    }

    pub fn header_line(&self) -> usize {
        self.header_line
    }

    pub fn columns(&self) -> Vec<String> {
        self.headings.iter().map(|heading| heading.written.trim().to_owned()).collect()
    }

    pub fn has(&self, name: &str) -> bool {
        self.headings.iter().any(|heading| heading.name == name)
    }

    pub fn heading(&self, name: &str) -> Option<&Heading> {
        self.headings.iter().find(|heading| heading.name == name)
    }

    pub fn comment(&self, key: &str) -> Option<&str> {
        self.said.value(key)
    }

    /// What the file states of its convention and units.
    pub fn stated(&self) -> Stated {
        self.said.stated
    }

    pub fn iter(&self) -> impl Iterator<Item = RowOf<'_>> {
        self.records.iter().map(|record| RowOf { rows: self, record })
    }

    pub fn error(&self, kind: SourceErrorKind) -> SourceError {
        SourceError::at(place(self.file, self.header_line, "table"), kind)
    }
}

fn is_number(name: &str) -> bool {
    ["theta", "offset", "d", "alpha", "a", "beta"].contains(&name)
}

/// Three of the four numbers, or screw axes: then the line is a table's header.
fn is_header(cells: &[(usize, String)]) -> bool {
    let names: Vec<String> = cells.iter().map(|(_, cell)| Heading::of(cell).name).collect();
    let has = |name: &str| names.iter().any(|known| known == name);
    let numbers = [has("theta") || has("offset"), has("d"), has("alpha"), has("a") || has("r")];
    numbers.iter().filter(|has| **has).count() >= 3 || (has("wx") && has("vx"))
}

/// Whether a text holds the header of a table of ours, whatever its file is called.
pub(super) fn holds_header(text: &str) -> bool {
    text.lines()
        .any(|line| !line.trim_start().starts_with('#') && MARKS.into_iter().any(|mark| is_header(&cut(line, mark))))
}

/// A line's cells, each with the column where it begins, counted from 1.
fn cut(line: &str, mark: char) -> Vec<(usize, String)> {
    let line = if mark == '|' { line.trim_end().strip_suffix('|').unwrap_or(line) } else { line };
    let mut reader = csv::ReaderBuilder::new();
    reader
        .has_headers(false)
        .flexible(true)
        .trim(csv::Trim::All)
        .delimiter(u8::try_from(mark).unwrap_or(b','))
        .quoting(mark != '|');
    let mut record = csv::StringRecord::new();
    let mut reader = reader.from_reader(line.as_bytes());
    if !reader.read_record(&mut record).unwrap_or(false) {
        return Vec::new();
    }
    let mut behind = 0;
    let mut cells = Vec::new();
    for cell in &record {
        let start = line[behind..].find(cell).map_or(behind, |at| behind + at);
        cells.push((line[..start].chars().count() + 1, cell.to_owned()));
        let end = start + cell.len();
        behind = line[end..].find(mark).map_or(line.len(), |at| end + at + 1);
    }
    // A Markdown row begins with its mark.
    if mark == '|' && cells.first().is_some_and(|(_, cell)| cell.is_empty()) {
        cells.remove(0);
    }
    cells
}

impl RowOf<'_> {
    pub fn error(&self, kind: SourceErrorKind) -> SourceError {
        SourceError::at(place(self.rows.file, self.record.line, self.element()), kind)
    }

    /// An error in the cell of a column.
    pub fn error_in(&self, name: &str, kind: SourceErrorKind) -> SourceError {
        let column = self.index(name).and_then(|index| self.record.columns.get(index)).copied();
        SourceError { place: place(self.rows.file, self.record.line, self.element()), column, kind }
    }

    fn element(&self) -> String {
        let label = self.text("row");
        if label.is_empty() { "row".to_owned() } else { format!("row \"{label}\"") }
    }

    fn index(&self, name: &str) -> Option<usize> {
        self.rows.headings.iter().position(|known| known.name == name)
    }

    pub fn text(&self, name: &str) -> &str {
        let cell = self.index(name).and_then(|index| self.record.cells.get(index));
        cell.map_or("", String::as_str)
    }

    /// The plain number of a column, its heading's unit in SI; `None` where the cell is empty or the column absent.
    pub fn number(&self, name: &str) -> Result<Option<f64>, SourceError> {
        let (Some(heading), value) = (self.rows.heading(name), self.text(name)) else { return Ok(None) };
        if value.is_empty() {
            return Ok(None);
        }
        match value.replace(',', ".").parse::<f64>() {
            Ok(number) if number.is_finite() => Ok(Some(heading.unit.map_or(number, |unit| unit.to_si(number)))),
            _ => Err(self.not_a_number(name)),
        }
    }

    pub fn not_a_number(&self, name: &str) -> SourceError {
        let column = self.rows.heading(name).map_or_else(|| name.to_owned(), |heading| heading.written.clone());
        self.error_in(name, SourceErrorKind::Number { column, value: self.text(name).to_owned() })
    }

    pub fn missing(&self, name: &str) -> SourceError {
        self.error_in(name, SourceErrorKind::Missing { column: name.to_owned() })
    }

    pub fn required(&self, name: &str) -> Result<f64, SourceError> {
        self.number(name)?.ok_or_else(|| self.missing(name))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_and_where_they_begin() {
        let cells = |line, mark| cut(line, mark);
        assert_eq!(cells("1; 90 ;-3,5", ';'), [(1, "1".into()), (4, "90".into()), (8, "-3,5".into())]);
        assert_eq!(cells("| 1 | q1 |", '|'), [(3, "1".into()), (7, "q1".into())]);
        assert_eq!(cells("\"a,b\",2", ','), [(2, "a,b".into()), (7, "2".into())]);
        assert_eq!(cells("a,,b", ','), [(1, "a".into()), (3, String::new()), (4, "b".into())]);
    }
}
