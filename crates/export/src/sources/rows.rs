//! CSV rows with named columns, units in column names, and places for messages.

use super::{SourceError, SourceErrorKind, place};

/// A CSV file's rows.
pub(super) struct Rows<'a> {
    pub file: &'a str,
    /// Column name without unit, as written, and factor to SI.
    columns: Vec<(String, String, f64)>,
    header_line: usize,
    records: Vec<csv::StringRecord>,
    /// What the `#` lines say: `# key: value`.
    comments: Vec<(String, String)>,
}

/// A row with its line.
#[derive(Clone, Copy)]
pub(super) struct RowOf<'a> {
    rows: &'a Rows<'a>,
    record: &'a csv::StringRecord,
}

/// A column's name without its unit, and what makes its numbers SI.
fn column(written: &str) -> (String, f64) {
    let lower = written.to_ascii_lowercase();
    for (suffix, factor) in [("_deg", std::f64::consts::PI / 180.0), ("_mm", 1e-3), ("_rad", 1.0), ("_m", 1.0)] {
        if let Some(name) = lower.strip_suffix(suffix) {
            return (name.trim_end_matches("_offset").to_owned(), factor);
        }
    }
    (lower, 1.0)
}

impl<'a> Rows<'a> {
    pub fn read(file: &'a str, text: &str) -> Result<Self, SourceError> {
        let mut reader = csv::ReaderBuilder::new()
            .comment(Some(b'#'))
            .trim(csv::Trim::All)
            .flexible(true)
            .from_reader(text.as_bytes());
        let wrong = |error: csv::Error| {
            let line = error.position().map_or(1, csv::Position::line);
            let line = usize::try_from(line).unwrap_or(1);
            SourceError { place: place(file, line, "file"), kind: SourceErrorKind::Csv(error.to_string()) }
        };
        let header = reader.headers().map_err(wrong)?.clone();
        let columns = header.iter().map(|written| {
            let (name, factor) = column(written);
            (name, written.to_owned(), factor)
        });
        let columns = columns.collect();
        let header_line = line_of(&header);
        let mut records = Vec::new();
        for record in reader.records() {
            let record = record.map_err(wrong)?;
            if record.iter().any(|cell| !cell.is_empty()) {
                records.push(record);
            }
        }
        let comments =
            text.lines().filter_map(|line| line.trim().strip_prefix('#')).filter_map(|line| line.split_once(':'));
        let comments =
            comments.map(|(key, value)| (key.trim().to_ascii_lowercase(), value.trim().to_owned())).collect();
        Ok(Self { file, columns, header_line, records, comments })
    }

    pub fn header_line(&self) -> usize {
        self.header_line
    }

    pub fn columns(&self) -> Vec<String> {
        self.columns.iter().map(|(_, written, _)| written.clone()).collect()
    }

    pub fn has(&self, name: &str) -> bool {
        self.columns.iter().any(|(known, _, _)| known == name)
    }

    pub fn comment(&self, key: &str) -> Option<&str> {
        self.comments.iter().find(|(known, _)| known == key).map(|(_, value)| value.as_str())
    }

    pub fn iter(&self) -> impl Iterator<Item = RowOf<'_>> {
        self.records.iter().map(|record| RowOf { rows: self, record })
    }

    pub fn error(&self, kind: SourceErrorKind) -> SourceError {
        SourceError { place: place(self.file, self.header_line, "table"), kind }
    }
}

fn line_of(record: &csv::StringRecord) -> usize {
    record.position().and_then(|position| usize::try_from(position.line()).ok()).unwrap_or(1)
}

impl RowOf<'_> {
    pub fn error(&self, kind: SourceErrorKind) -> SourceError {
        let label = self.text("row");
        let element = if label.is_empty() { "row".to_owned() } else { format!("row \"{label}\"") };
        SourceError { place: place(self.rows.file, line_of(self.record), element), kind }
    }

    pub fn text(&self, name: &str) -> &str {
        let index = self.rows.columns.iter().position(|(known, _, _)| known == name);
        index.and_then(|index| self.record.get(index)).unwrap_or_default()
    }

    /// The number of a column in SI; `None` where the cell is empty or the column absent.
    pub fn number(&self, name: &str) -> Result<Option<f64>, SourceError> {
        let Some((_, written, factor)) = self.rows.columns.iter().find(|(known, _, _)| known == name) else {
            return Ok(None);
        };
        let value = self.text(name);
        if value.is_empty() {
            return Ok(None);
        }
        match value.parse::<f64>() {
            Ok(number) if number.is_finite() => Ok(Some(number * factor)),
            _ => Err(self.error(SourceErrorKind::Number { column: written.clone(), value: value.to_owned() })),
        }
    }

    /// A cell's text and its unit in SI; `None` where it is empty.
    pub fn written(&self, name: &str) -> Option<(&str, f64)> {
        let (_, _, factor) = self.rows.columns.iter().find(|(known, _, _)| known == name)?;
        let text = self.text(name);
        (!text.is_empty()).then_some((text, *factor))
    }

    pub fn required(&self, name: &str) -> Result<f64, SourceError> {
        self.number(name)?.ok_or_else(|| self.error(SourceErrorKind::Missing { column: name.to_owned() }))
    }
}
