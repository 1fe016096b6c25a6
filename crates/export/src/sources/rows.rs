//! Rows with named columns, from CSV with commas, semicolons or tabs, from a Markdown table, from a printed table with blanks
//! or boxes; with places for messages.

use super::cell::has_decimal_comma;
use super::header::{Heading, KNOWN, quantity_of};
use super::stated::{Said, Stated};
use super::{SourceError, SourceErrorKind, place};
use crate::makers::yaml::Cells;
use denavit_model::notes::Note;
use denavit_model::units::Unit;
use denavit_model::words::{from_cell, quoted};
use denavit_model::{Inventory, Quantity};

/// What separates columns; blanks come last, as every line has some.
const MARKS: [char; 5] = ['|', ';', '\t', ',', ' '];

/// A file's rows.
pub(super) struct Rows<'a> {
    pub file: &'a str,
    headings: Vec<Heading>,
    header_line: usize,
    records: Vec<Record>,
    said: Said,
    mark: char,
    /// Notes on what was not understood.
    pub notes: Vec<Note>,
    /// What became of every line, column and cell.
    pub inventory: Inventory,
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

fn is_words(line: &str) -> bool {
    line.trim().is_empty() || line.trim_start().starts_with('#')
}

/// A line of a boxed table with plain marks between its cells.
fn unboxed(line: &str) -> String {
    line.chars().map(|c| if matches!(c, '│' | '┃' | '║') { '|' } else { c }).collect()
}

/// A line that only draws: `|---|---|`, `+----+`, `├───┼───┤`. A row of single dashes is one of zeros, but below the header.
fn is_rule(line: &str, below_header: bool) -> bool {
    let drawn = |c: char| "|-:=+ \t".contains(c) || ('\u{2500}'..='\u{257f}').contains(&c);
    let long = ["--", "==", ":-", "─", "━", "═", "-:"].iter().any(|piece| line.contains(piece));
    line.chars().all(drawn) && (long || (below_header && line.contains('-')))
}

impl<'a> Rows<'a> {
    pub fn read(file: &'a str, text: &str) -> Result<Self, SourceError> {
        let lines: Vec<String> = text.lines().map(unboxed).collect();
        let (header, mark) = header_of(&lines).unwrap_or_else(|| {
            let first = lines.iter().position(|line| !is_words(line)).unwrap_or(0);
            (first, MARKS.into_iter().find(|mark| lines[first].contains(*mark)).unwrap_or(','))
        });
        let headings: Vec<Heading> = cut(&lines[header], mark).iter().map(|(_, cell)| Heading::of(cell)).collect();
        let header_line = header + 1;
        one_column_each(file, header_line, &headings)?;
        // Other text may follow a Markdown table; after a CSV header only comments are text.
        let numbered = || lines.iter().enumerate().map(|(index, line)| (index, line.as_str()));
        let comments = numbered().skip(header).filter(|(_, line)| mark != '|' && line.trim_start().starts_with('#'));
        let said = Said::in_words(numbered().take(header).chain(comments), &headings);
        unit_is_known(file, &said)?;
        let inventory = Inventory { understood: headings.len(), ..Inventory::default() };
        let (records, notes) = (Vec::new(), Vec::new());
        let mut rows = Self { file, headings, header_line, records, said, mark, notes, inventory };
        rows.take_lines(&lines, header)?;
        rows.take_row_of_units()?;
        rows.one_decimal_mark()?;
        rows.report_columns();
        Ok(rows)
    }

    /// A table whose cells do not come from lines of text.
    pub fn of_cells(file: &'a str, cells: &Cells) -> Result<Self, SourceError> {
        let headings: Vec<Heading> = cells.headings.iter().map(|heading| Heading::of(heading)).collect();
        let header_line = cells.rows.first().map_or(1, |(line, _)| *line);
        one_column_each(file, header_line, &headings)?;
        let said =
            Said::in_words(cells.words.iter().map(|(line, words)| (line.saturating_sub(1), words.as_str())), &headings);
        unit_is_known(file, &said)?;
        let record =
            |(line, cells): &(usize, Vec<String>)| Record { line: *line, cells: cells.clone(), columns: Vec::new() };
        let records = cells.rows.iter().map(record).collect();
        let (notes, inventory) = (Vec::new(), Inventory::default());
        let mut rows = Self { file, headings, header_line, records, said, mark: ',', notes, inventory };
        rows.one_decimal_mark()?;
        rows.report_columns();
        Ok(rows)
    }

    fn take_lines(&mut self, lines: &[String], header: usize) -> Result<(), SourceError> {
        let boxed = self.mark == '|';
        for (index, line) in lines.iter().enumerate().take(header).filter(|(_, line)| !is_words(line)) {
            let numbers = cut(line, self.mark).iter().filter(|(_, cell)| cell.parse::<f64>().is_ok()).count();
            if numbers > 1 {
                self.report(index + 1, "line", "a row above the header is ignored; put it below the header");
            }
        }
        let mut after = None;
        let mut first = true;
        for (index, line) in lines.iter().enumerate().skip(header + 1) {
            if boxed && after.is_none() && !line.contains('|') && !is_rule(line, first) {
                after = Some(index);
            }
            if after.is_some() {
                continue;
            }
            if boxed && is_rule(line, first) || !boxed && is_words(line) {
                first = false;
                continue;
            }
            first = false;
            let (columns, cells): (Vec<usize>, Vec<String>) =
                if self.mark == ' ' { blanks(line, self.headings.len()) } else { cut(line, self.mark) }
                    .into_iter()
                    .unzip();
            let found = cells.iter().rposition(|cell| !cell.is_empty()).map_or(0, |last| last + 1);
            if found > self.headings.len() || (self.mark == ' ' && found != self.headings.len()) {
                let kind = SourceErrorKind::Cells { found, expected: self.headings.len() };
                return Err(SourceError::at(place(self.file, index + 1, "row"), kind));
            }
            if found > 0 {
                self.inventory.understood += found;
                self.records.push(Record { line: index + 1, cells, columns });
            }
        }
        let rest = lines.iter().enumerate().skip(after.unwrap_or(lines.len()));
        let mut rest = rest.filter(|(_, line)| !line.trim().is_empty() && !is_rule(line, true));
        if let Some((index, _)) = rest.next() {
            let tables =
                rest.filter(|(_, line)| MARKS.into_iter().any(|mark| is_header(&cut(line, mark), mark))).count();
            let what = if tables > 0 {
                "another table follows and was ignored; put each robot into its own file"
            } else {
                "text after the table is ignored; state units and convention above it, and base and tool frames in \
                 rows of the table"
            };
            self.report(index + 1, "text", what);
        }
        Ok(())
    }

    fn report(&mut self, line: usize, element: &str, what: &str) {
        let place = place(self.file, line, element);
        self.inventory.report(place.clone(), what);
        self.notes.push(Note::NotUnderstood { place, what: what.to_owned() });
    }

    /// Reports something in a row, with its place.
    pub fn report_in(&mut self, line: usize, element: &str, what: &str) {
        self.report(line, element, what);
    }

    /// Applies a row of units below the header to the headings.
    fn take_row_of_units(&mut self) -> Result<(), SourceError> {
        let Some(record) = self.records.first() else { return Ok(()) };
        let mut units = Vec::new();
        for (index, heading) in self.headings.iter().enumerate() {
            let cell = record.cells.get(index).map_or("", |cell| cell.trim().trim_matches(['[', ']', '(', ')']));
            match quantity_of(&heading.name) {
                Some(quantity) if !cell.is_empty() && cell != "-" => match Unit::of(cell, quantity) {
                    Some(unit) => units.push((index, unit)),
                    None => return Ok(()),
                },
                _ => {}
            }
        }
        if units.is_empty() {
            return Ok(());
        }
        for (index, unit) in units {
            let heading = &mut self.headings[index];
            if let Some(first) = heading.unit.filter(|known| *known != unit) {
                let kind = SourceErrorKind::Contradiction { file: first.word().into(), user: unit.word().into() };
                return Err(SourceError::at(place(self.file, self.header_line + 1, "row of units"), kind));
            }
            heading.unit = Some(unit);
        }
        self.records.remove(0);
        Ok(())
    }

    /// Unknown columns.
    fn report_columns(&mut self) {
        let mut unknown = Vec::new();
        for (index, heading) in self.headings.iter().enumerate() {
            let filled = self.records.iter().any(|record| record.cells.get(index).is_some_and(|cell| !cell.is_empty()));
            let understood = if heading.name.is_empty() { !filled } else { KNOWN.contains(&heading.name.as_str()) };
            if !understood {
                unknown.push(format!("column \"{}\"", quoted(heading.written.trim())));
            }
        }
        for element in unknown {
            self.report(self.header_line, &element, "the column is unknown and was ignored");
        }
    }

    /// Units in headings that are not known.
    pub fn known_units_only(&self) -> Result<(), SourceError> {
        for heading in &self.headings {
            // A pitch has two units, which its own reader knows.
            if let Some(word) = heading.unknown.as_ref().filter(|_| heading.name != "pitch") {
                let kind =
                    SourceErrorKind::UnknownUnit { word: word.clone(), known: known_units(quantity_of(&heading.name)) };
                let element = format!("column \"{}\"", quoted(heading.written.trim()));
                return Err(SourceError::at(place(self.file, self.header_line, element), kind));
            }
        }
        Ok(())
    }

    /// Refuses decimal commas and decimal points in one file: one of the two has another meaning.
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

    /// Whether a heading or a cell uses this spelling of a unit.
    pub fn writes(&self, word: &str) -> bool {
        let has = |text: &str| text.to_lowercase().split(|c: char| !c.is_alphabetic()).any(|found| found == word);
        self.headings.iter().any(|heading| has(&heading.written))
            || self.records.iter().any(|record| {
                let numbers = self.headings.iter().zip(&record.cells).filter(|(heading, _)| is_number(&heading.name));
                numbers.into_iter().any(|(_, cell)| has(cell))
            })
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

/// Checks that no two headings have the same meaning.
fn one_column_each(file: &str, line: usize, headings: &[Heading]) -> Result<(), SourceError> {
    let known: Vec<&Heading> = headings.iter().filter(|heading| !heading.name.is_empty()).collect();
    for (index, heading) in known.iter().enumerate() {
        if let Some(twin) = known[..index].iter().find(|twin| twin.name == heading.name) {
            let kind = SourceErrorKind::Twice { first: twin.written.clone(), second: heading.written.clone() };
            return Err(SourceError::at(place(file, line, "header"), kind));
        }
    }
    Ok(())
}

fn unit_is_known(file: &str, said: &Said) -> Result<(), SourceError> {
    let Some((index, word)) = &said.unknown_unit else { return Ok(()) };
    let kind = SourceErrorKind::UnknownUnit { word: word.clone(), known: known_units(None) };
    Err(SourceError::at(place(file, index + 1, "units"), kind))
}

/// Whether these are the headings of a D-H table.
pub(super) fn are_headings(headings: &[String]) -> bool {
    let cells: Vec<(usize, String)> = headings.iter().map(|heading| (1, heading.clone())).collect();
    is_header(&cells, ',')
}

fn known_units(quantity: Option<Quantity>) -> String {
    match quantity {
        Some(quantity) => Unit::words(quantity),
        None => format!("{} and {}", Unit::words(Quantity::Length), Unit::words(Quantity::Angle)),
    }
}

fn is_number(name: &str) -> bool {
    ["theta", "offset", "d", "alpha", "a", "beta"].contains(&name)
}

fn header_of(lines: &[String]) -> Option<(usize, char)> {
    lines.iter().enumerate().filter(|(_, line)| !line.trim_start().starts_with('#')).find_map(|(index, line)| {
        let mark = MARKS.into_iter().find(|mark| is_header(&cut(line, *mark), *mark))?;
        Some((index, mark))
    })
}

/// A line with three of the four numbers, or with screw axes, is a table's header. If blanks separate the columns, every
/// word must be a heading, because sentences also mention theta, d and a.
fn is_header(cells: &[(usize, String)], mark: char) -> bool {
    let names: Vec<String> = cells.iter().map(|(_, cell)| Heading::of(cell).name).collect();
    let has = |name: &str| names.iter().any(|known| known == name);
    let numbers = [has("theta") || has("offset"), has("d"), has("alpha"), has("a") || has("r")];
    let enough = numbers.iter().filter(|has| **has).count() >= 3 || (has("wx") && has("vx"));
    enough && (mark != ' ' || names.iter().all(|name| !name.is_empty() && KNOWN.contains(&name.as_str())))
}

/// Whether a text holds the header of one of our tables, whatever its file name.
pub(super) fn holds_header(text: &str) -> bool {
    header_of(&text.lines().map(unboxed).collect::<Vec<_>>()).is_some()
}

/// A line's cells, each with the column where it begins, counted from 1.
fn cut(line: &str, mark: char) -> Vec<(usize, String)> {
    match mark {
        '|' => barred(line),
        ' ' => blanks(line, 0),
        _ => separated(line, mark),
    }
}

/// Cells of CSV.
fn separated(line: &str, mark: char) -> Vec<(usize, String)> {
    let mut reader = csv::ReaderBuilder::new();
    reader.has_headers(false).flexible(true).trim(csv::Trim::All).delimiter(u8::try_from(mark).unwrap_or(b','));
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
        behind = line.get(end..).and_then(|rest| rest.find(mark)).map_or(line.len(), |at| end + at + 1);
    }
    cells
}

/// Cells between bars; a bar after a backslash belongs to the cell. A row may begin and end with a bar.
fn barred(line: &str) -> Vec<(usize, String)> {
    let mut cells = vec![(1, String::new())];
    let mut escaped = false;
    for (index, c) in line.chars().enumerate() {
        let Some((start, cell)) = cells.last_mut() else { break };
        if c == '|' && !escaped {
            cells.push((index + 2, String::new()));
            continue;
        }
        if cell.is_empty() && c.is_whitespace() {
            *start = index + 2;
            continue;
        }
        escaped = c == '\\' && !escaped;
        cell.push(c);
    }
    for (_, cell) in &mut cells {
        cell.truncate(cell.trim_end().len());
    }
    if cells.len() > 1 && cells.first().is_some_and(|(_, cell)| cell.is_empty()) {
        cells.remove(0);
    }
    if cells.len() > 1 && cells.last().is_some_and(|(_, cell)| cell.is_empty()) {
        cells.pop();
    }
    cells
}

/// Cells between blanks; where `wanted` says how many there should be, the splitting that gives as many: at two blanks and
/// more, at each, or at each with units joined to their numbers.
fn blanks(line: &str, wanted: usize) -> Vec<(usize, String)> {
    let mut words: Vec<(usize, String, usize)> = Vec::new();
    let mut gap = 2;
    for (index, c) in line.chars().enumerate() {
        if c.is_whitespace() {
            gap += if c == '\t' { 2 } else { 1 };
            continue;
        }
        match words.last_mut() {
            Some((_, word, _)) if gap == 0 => word.push(c),
            _ => words.push((index + 1, c.to_string(), gap)),
        }
        gap = 0;
    }
    let joined = |joins: &dyn Fn(&str, &str, usize) -> bool| {
        let mut cells: Vec<(usize, String)> = Vec::new();
        for (start, word, gap) in &words {
            match cells.last_mut() {
                Some((_, cell)) if joins(cell, word, *gap) => {
                    cell.push(' ');
                    cell.push_str(word);
                }
                _ => cells.push((*start, word.clone())),
            }
        }
        cells
    };
    let bracketed = |_: &str, word: &str, gap: usize| gap == 1 && word.starts_with(['[', '(']);
    if wanted == 0 {
        return joined(&bracketed);
    }
    let wide = joined(&|_, _, gap| gap < 2);
    let narrow = joined(&|_, _, _| false);
    let with_units = joined(&|cell, word, gap| {
        gap == 1 && Unit::of_any(word).is_some() && cell.ends_with(|c: char| c.is_ascii_digit())
    });
    [wide, with_units].into_iter().find(|cells| cells.len() == wanted).unwrap_or(narrow)
}

/// Text of a Markdown cell without escapes.
fn without_escapes(cell: &str) -> String {
    let mut out = String::new();
    let mut letters = cell.chars().peekable();
    while let Some(c) = letters.next() {
        match letters.peek() {
            Some(next) if c == '\\' && next.is_ascii_punctuation() => out.extend(letters.next()),
            _ => out.push(c),
        }
    }
    out.replace("&lt;", "<").replace("&gt;", ">").replace("&amp;", "&")
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

    pub fn line(&self) -> usize {
        self.record.line
    }

    pub fn element(&self) -> String {
        let label = self.text("row");
        if label.is_empty() { "row".to_owned() } else { format!("row \"{}\"", quoted(label)) }
    }

    pub fn heading(&self, name: &str) -> Option<&Heading> {
        self.rows.heading(name)
    }

    fn index(&self, name: &str) -> Option<usize> {
        self.rows.headings.iter().position(|known| known.name == name)
    }

    pub fn text(&self, name: &str) -> &str {
        let cell = self.index(name).and_then(|index| self.record.cells.get(index));
        cell.map_or("", String::as_str)
    }

    /// A name without the escapes for a cell.
    pub fn name(&self, name: &str) -> String {
        let text = self.text(name);
        if self.rows.mark == '|' { without_escapes(text) } else { from_cell(text).to_owned() }
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
        assert_eq!(cells("| a\\|b | c |", '|'), [(3, "a\\|b".into()), (10, "c".into())]);
        assert_eq!(cells("| | c |", '|'), [(3, String::new()), (5, "c".into())]);
        assert_eq!(cells("\"a,b\",2", ','), [(2, "a,b".into()), (7, "2".into())]);
        assert_eq!(cells("a,,b", ','), [(1, "a".into()), (3, String::new()), (4, "b".into())]);
        assert_eq!(cells(" j  alpha (deg)", ' '), [(2, "j".into()), (5, "alpha (deg)".into())]);
        assert_eq!(blanks("1 q2 - 90°  3 mm", 2), [(1, "1 q2 - 90°".into()), (13, "3 mm".into())]);
        assert_eq!(blanks("1 q2 3 mm", 3), [(1, "1".into()), (3, "q2".into()), (6, "3 mm".into())]);
    }

    #[test]
    fn what_draws_a_table() {
        for (line, below, drawn) in [
            ("|---|:--:|", false, true),
            ("+----+----+", false, true),
            ("├───┼───┤", false, true),
            ("|-|-|", true, true),
            ("| - | - | - |", false, false),
            ("| 1 | - |", true, false),
        ] {
            assert_eq!(is_rule(line, below), drawn, "{line}");
        }
    }
}
