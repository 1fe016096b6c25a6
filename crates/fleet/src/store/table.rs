//! Rows in memory, column by column, and their Parquet.

use super::cells::cells;
use super::schema::{Kind, TableKind};
use crate::error::FleetError;
use parquet::basic::{ConvertedType, LogicalType, Repetition, Type as Physical};
use parquet::column::writer::ColumnWriter;
use parquet::data_type::ByteArray;
use parquet::errors::ParquetError;
use parquet::file::properties::WriterProperties;
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::Type;
use std::fs::File;
use std::io::Write;
use std::path::Path;
use std::sync::Arc;

/// One cell.
#[derive(Debug, Clone, PartialEq)]
pub enum Cell {
    /// Text.
    Text(String),
    /// A number.
    Real(f64),
    /// A whole number.
    Count(i64),
    /// True or false.
    Flag(bool),
    /// A day.
    Day(i32),
    /// Nothing to say.
    Empty,
}

impl From<&str> for Cell {
    fn from(text: &str) -> Self {
        if text.is_empty() { Self::Empty } else { Self::Text(text.to_owned()) }
    }
}
impl From<String> for Cell {
    fn from(text: String) -> Self {
        if text.is_empty() { Self::Empty } else { Self::Text(text) }
    }
}
impl From<f64> for Cell {
    fn from(number: f64) -> Self {
        Self::Real(number)
    }
}
impl From<usize> for Cell {
    fn from(count: usize) -> Self {
        Self::Count(i64::try_from(count).unwrap_or(i64::MAX))
    }
}
impl From<bool> for Cell {
    fn from(flag: bool) -> Self {
        Self::Flag(flag)
    }
}
impl<T: Into<Self>> From<Option<T>> for Cell {
    fn from(cell: Option<T>) -> Self {
        cell.map_or(Self::Empty, Into::into)
    }
}

impl Cell {
    /// Its text; empty where it has none.
    pub fn text(&self) -> &str {
        if let Self::Text(text) = self { text } else { "" }
    }

    /// Its number.
    pub fn real(&self) -> Option<f64> {
        if let Self::Real(number) = self { Some(*number) } else { None }
    }

    /// Its whole number.
    pub fn count(&self) -> Option<i64> {
        if let Self::Count(number) = self { Some(*number) } else { None }
    }

    /// Whether it is true.
    pub fn is_true(&self) -> bool {
        *self == Self::Flag(true)
    }

    /// Its day.
    pub fn day(&self) -> Option<i32> {
        if let Self::Day(day) = self { Some(*day) } else { None }
    }
}

/// Takes the rows of one row group after the other.
pub type Reader<'a> = dyn FnMut(&[Vec<Cell>]) -> Result<(), FleetError> + 'a;

/// Maximum rows of a row group, which bounds the memory for reading or merging a file of any size.
const ROWS_IN_GROUP: usize = 16_384;

/// Rows of one table, every column of it.
#[derive(Debug, Clone)]
pub struct Rows {
    /// Which table.
    pub table: &'static TableKind,
    /// Row by row.
    pub rows: Vec<Vec<Cell>>,
}

/// The Parquet schema of a table.
fn schema(table: &TableKind) -> Result<Arc<Type>, ParquetError> {
    let fields = table.columns().map(|column| {
        let (physical, logical, converted) = match column.kind {
            Kind::Text => (Physical::BYTE_ARRAY, Some(LogicalType::String), ConvertedType::UTF8),
            Kind::Real => (Physical::DOUBLE, None, ConvertedType::NONE),
            Kind::Count => (Physical::INT64, None, ConvertedType::NONE),
            Kind::Flag => (Physical::BOOLEAN, None, ConvertedType::NONE),
            Kind::Day => (Physical::INT32, Some(LogicalType::Date), ConvertedType::DATE),
        };
        let field = Type::primitive_type_builder(column.name, physical).with_repetition(Repetition::OPTIONAL);
        Ok(Arc::new(field.with_logical_type(logical).with_converted_type(converted).build()?))
    });
    let fields = fields.collect::<Result<Vec<_>, ParquetError>>()?;
    Ok(Arc::new(Type::group_type_builder(table.name).with_fields(fields).build()?))
}

impl Rows {
    /// None yet.
    pub fn of(table: &'static TableKind) -> Self {
        Self { table, rows: Vec::new() }
    }

    /// Their Parquet.
    ///
    /// # Errors
    /// The rows have other columns than their table.
    pub fn parquet(&self) -> Result<Vec<u8>, FleetError> {
        let mut bytes = Vec::new();
        let mut groups = Groups::begin(self.table, &mut bytes)?;
        for row in &self.rows {
            groups.push(row.clone())?;
        }
        groups.end()?;
        Ok(bytes)
    }

    /// Writes them as a row group.
    fn write<W: Write + Send>(&self, writer: &mut SerializedFileWriter<W>) -> Result<(), ParquetError> {
        let mut group = writer.next_row_group()?;
        let mut index = 0;
        while let Some(mut column) = group.next_column()? {
            let cells = self.rows.iter().map(|row| &row[index]);
            let levels: Vec<i16> = cells.clone().map(|cell| i16::from(*cell != Cell::Empty)).collect();
            match column.untyped() {
                ColumnWriter::ByteArrayColumnWriter(typed) => {
                    let values: Vec<ByteArray> =
                        cells.filter(|cell| **cell != Cell::Empty).map(|cell| ByteArray::from(cell.text())).collect();
                    typed.write_batch(&values, Some(&levels), None)?;
                }
                ColumnWriter::DoubleColumnWriter(typed) => {
                    let values: Vec<f64> = cells.filter_map(Cell::real).collect();
                    typed.write_batch(&values, Some(&levels), None)?;
                }
                ColumnWriter::Int64ColumnWriter(typed) => {
                    let values: Vec<i64> = cells.filter_map(Cell::count).collect();
                    typed.write_batch(&values, Some(&levels), None)?;
                }
                ColumnWriter::BoolColumnWriter(typed) => {
                    let values: Vec<bool> = cells.filter(|cell| **cell != Cell::Empty).map(Cell::is_true).collect();
                    typed.write_batch(&values, Some(&levels), None)?;
                }
                ColumnWriter::Int32ColumnWriter(typed) => {
                    let values: Vec<i32> = cells.filter_map(Cell::day).collect();
                    typed.write_batch(&values, Some(&levels), None)?;
                }
                _ => return Err(ParquetError::General("a column of no known kind".into())),
            }
            column.close()?;
            index += 1;
        }
        group.close()?;
        Ok(())
    }

    /// Passes on the rows of a Parquet file, one row group at a time, so that memory does not grow with the file; if `wanted`
    /// names columns, the others are empty.
    ///
    /// # Errors
    /// The file is not Parquet, or has other columns; or `each` fails.
    pub fn each_group(
        table: &'static TableKind,
        path: &Path,
        wanted: &[&str],
        each: &mut Reader<'_>,
    ) -> Result<(), FleetError> {
        let not_ours = |reason: String| FleetError::NotOurs { file: path.to_owned(), reason };
        let file = File::open(path).map_err(FleetError::store(path))?;
        let reader = SerializedFileReader::new(file).map_err(|error| not_ours(error.to_string()))?;
        let present = reader.metadata().file_metadata().schema_descr().columns().to_vec();
        let columns: Vec<_> = table.columns().collect();
        for group in 0..reader.num_row_groups() {
            let group = reader.get_row_group(group).map_err(|error| not_ours(error.to_string()))?;
            let count = usize::try_from(group.metadata().num_rows()).map_err(|error| not_ours(error.to_string()))?;
            let mut rows = vec![vec![Cell::Empty; columns.len()]; count];
            for (index, column) in columns.iter().enumerate() {
                if !wanted.is_empty() && !wanted.contains(&column.name) {
                    continue;
                }
                let at = present.iter().position(|found| found.name() == column.name);
                if at.is_none() && column.added {
                    continue;
                }
                let at = at.ok_or_else(|| not_ours(format!("it has no column \"{}\"", column.name)))?;
                let cells =
                    group.get_column_reader(at).and_then(|reader| cells(reader, &present[at], column.kind, count));
                let cells = cells.map_err(|error| not_ours(format!("column \"{}\": {error}", column.name)))?;
                for (row, cell) in rows.iter_mut().zip(cells) {
                    row[index] = cell;
                }
            }
            each(&rows)?;
        }
        Ok(())
    }
}

/// A Parquet file in the making: rows go into it group by group.
pub(super) struct Groups<W: Write + Send> {
    writer: SerializedFileWriter<W>,
    rows: Rows,
}

impl<W: Write + Send> Groups<W> {
    /// Nothing in it yet.
    pub(super) fn begin(table: &'static TableKind, file: W) -> Result<Self, FleetError> {
        let properties = Arc::new(WriterProperties::builder().set_created_by("denavit".into()).build());
        let writer = schema(table).and_then(|schema| SerializedFileWriter::new(file, schema, properties));
        Ok(Self { writer: writer.map_err(unwritten(table))?, rows: Rows::of(table) })
    }

    /// One more row.
    pub(super) fn push(&mut self, row: Vec<Cell>) -> Result<(), FleetError> {
        self.rows.rows.push(row);
        if self.rows.rows.len() >= ROWS_IN_GROUP { self.flush() } else { Ok(()) }
    }

    fn flush(&mut self) -> Result<(), FleetError> {
        self.rows.write(&mut self.writer).map_err(unwritten(self.rows.table))?;
        self.rows.rows.clear();
        Ok(())
    }

    /// The end of the file.
    pub(super) fn end(mut self) -> Result<(), FleetError> {
        if !self.rows.rows.is_empty() {
            self.flush()?;
        }
        self.writer.close().map_err(unwritten(self.rows.table))?;
        Ok(())
    }
}

fn unwritten(table: &TableKind) -> impl FnOnce(ParquetError) -> FleetError {
    let file = Path::new(table.name).to_owned();
    move |error| FleetError::Store { file, reason: error.to_string() }
}
