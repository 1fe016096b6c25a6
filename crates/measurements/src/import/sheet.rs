//! The first sheet with data of an Excel workbook, as rows of cells.

use super::problem::{Fault, ImportProblem};
use calamine::{Data, Reader, Xlsx};
use std::io::Cursor;

/// Rows with their numbers in the sheet; empty rows are left out.
pub(super) fn rows(bytes: &[u8]) -> Result<Vec<(usize, Vec<String>)>, Fault> {
    let failed = |reason: String| Fault { line: 0, problem: ImportProblem::Workbook(reason) };
    let mut book: Xlsx<_> = Xlsx::new(Cursor::new(bytes)).map_err(|error| failed(error.to_string()))?;
    for name in book.sheet_names() {
        let range = book.worksheet_range(&name).map_err(|error| failed(error.to_string()))?;
        if range.is_empty() {
            continue;
        }
        let (first_row, first_column) = range.start().unwrap_or((0, 0));
        let before = vec![String::new(); first_column as usize];
        let text = |cell: &Data| match cell {
            Data::Empty => String::new(),
            Data::Error(error) => error.to_string(),
            other => other.to_string(),
        };
        let row = |(index, cells): (usize, &[Data])| {
            (
                first_row as usize + index + 1,
                before.iter().cloned().chain(cells.iter().map(text)).collect::<Vec<String>>(),
            )
        };
        let all = range.rows().enumerate().map(row);
        return Ok(all.filter(|(_, cells)| cells.iter().any(|cell| !cell.trim().is_empty())).collect());
    }
    Err(failed("every sheet is empty".into()))
}
