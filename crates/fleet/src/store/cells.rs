//! Reads columns written by other programs: DuckDB, pandas and Polars may store the same numbers in columns without
//! empty cells, with other widths, or as timestamps instead of days.

use super::schema::Kind;
use super::table::Cell;
use parquet::basic::{ConvertedType, LogicalType, TimeUnit};
use parquet::column::reader::{ColumnReader, ColumnReaderImpl};
use parquet::data_type::{ByteArray, DataType};
use parquet::errors::ParquetError;
use parquet::schema::types::ColumnDescriptor;

/// The values of a column, `None` where there is none.
type Values<T> = Vec<Option<T>>;

/// Largest integer that a floating point number represents exactly.
const EXACT: f64 = 9_007_199_254_740_992.0;

/// The cells of a column of `count` rows.
///
/// # Errors
/// The column holds lists, or values that are none of this kind; or it cannot be decoded.
pub(super) fn cells(
    reader: ColumnReader,
    column: &ColumnDescriptor,
    kind: Kind,
    count: usize,
) -> Result<Vec<Cell>, ParquetError> {
    if column.max_rep_level() > 0 {
        return Err(ParquetError::General(format!("it holds lists instead of {}", kind.name())));
    }
    match reader {
        ColumnReader::ByteArrayColumnReader(typed) => {
            each(values(typed, column, count)?, |bytes: ByteArray| text(&bytes, kind))
        }
        ColumnReader::DoubleColumnReader(typed) => each(values(typed, column, count)?, |number| real(number, kind)),
        ColumnReader::FloatColumnReader(typed) => {
            each(values(typed, column, count)?, |number: f32| real(number.into(), kind))
        }
        ColumnReader::Int64ColumnReader(typed) => {
            let meaning = meaning(column);
            each(values(typed, column, count)?, |number| whole(number, kind, meaning))
        }
        ColumnReader::Int32ColumnReader(typed) => {
            let meaning = meaning(column);
            each(values(typed, column, count)?, |number: i32| whole(number.into(), kind, meaning))
        }
        ColumnReader::BoolColumnReader(typed) => {
            each(values(typed, column, count)?, |flag| (kind == Kind::Flag).then_some(Cell::Flag(flag)))
        }
        ColumnReader::Int96ColumnReader(_) | ColumnReader::FixedLenByteArrayColumnReader(_) => None,
    }
    .ok_or_else(|| ParquetError::General(format!("it does not hold {}", kind.name())))
}

fn each<T>(values: Values<T>, cell: impl Fn(T) -> Option<Cell>) -> Option<Vec<Cell>> {
    values.into_iter().map(|value| value.map_or(Some(Cell::Empty), &cell)).collect()
}

/// Decodes a column. A column declared without empty cells has no definition levels.
fn values<T: DataType>(
    mut reader: ColumnReaderImpl<T>,
    column: &ColumnDescriptor,
    count: usize,
) -> Result<Values<T::T>, ParquetError> {
    let full = column.max_def_level();
    let (mut levels, mut values) = (Vec::new(), Vec::new());
    let mut rows = 0;
    while rows < count {
        let wanted = (full > 0).then_some(&mut levels);
        let (more, _, _) = reader.read_records(count - rows, wanted, None, &mut values)?;
        if more == 0 {
            return Err(ParquetError::EOF(format!("it ends after {rows} of {count} rows")));
        }
        rows += more;
    }
    if full == 0 {
        return Ok(values.into_iter().map(Some).collect());
    }
    let mut values = values.into_iter();
    Ok(levels.iter().map(|level| if *level < full { None } else { values.next() }).collect())
}

fn text(bytes: &ByteArray, kind: Kind) -> Option<Cell> {
    (kind == Kind::Text).then(|| Cell::from(String::from_utf8_lossy(bytes.data()).into_owned()))
}

/// pandas stores integers as floating point if some are missing, and missing numbers as NaN.
fn real(number: f64, kind: Kind) -> Option<Cell> {
    match kind {
        Kind::Real => Some(Cell::Real(number)),
        Kind::Count if number.is_nan() => Some(Cell::Empty),
        #[allow(clippy::cast_possible_truncation, reason = "it is whole and small")]
        Kind::Count if number.fract() == 0.0 && number.abs() <= EXACT => Some(Cell::Count(number as i64)),
        _ => None,
    }
}

/// The meaning of a column's integers.
#[derive(Clone, Copy)]
enum Meaning {
    /// Themselves.
    Number,
    /// This many ten-to-the-minus-n.
    Decimal(i32),
    /// Time since 1970, this many to a day.
    Time(i64),
}

fn meaning(column: &ColumnDescriptor) -> Meaning {
    const SECONDS: i64 = 86_400;
    match (column.logical_type_ref(), column.converted_type()) {
        (Some(LogicalType::Date), _) | (None, ConvertedType::DATE) => Meaning::Time(1),
        (Some(LogicalType::Timestamp(moment)), _) => Meaning::Time(match moment.unit {
            TimeUnit::MILLIS => SECONDS * 1_000,
            TimeUnit::MICROS => SECONDS * 1_000_000,
            TimeUnit::NANOS => SECONDS * 1_000_000_000,
        }),
        (None, ConvertedType::TIMESTAMP_MILLIS) => Meaning::Time(SECONDS * 1_000),
        (None, ConvertedType::TIMESTAMP_MICROS) => Meaning::Time(SECONDS * 1_000_000),
        (Some(LogicalType::Decimal(_)), _) | (None, ConvertedType::DECIMAL) => Meaning::Decimal(column.type_scale()),
        _ => Meaning::Number,
    }
}

#[allow(clippy::cast_precision_loss, reason = "a number that the file keeps as a whole one")]
fn whole(number: i64, kind: Kind, meaning: Meaning) -> Option<Cell> {
    match (kind, meaning) {
        (Kind::Day, Meaning::Time(in_a_day)) => i32::try_from(number.div_euclid(in_a_day)).ok().map(Cell::Day),
        (Kind::Count, Meaning::Number | Meaning::Decimal(0)) => Some(Cell::Count(number)),
        (Kind::Real, Meaning::Number) => Some(Cell::Real(number as f64)),
        (Kind::Real, Meaning::Decimal(places)) => Some(Cell::Real(number as f64 / 10.0_f64.powi(places))),
        _ => None,
    }
}
