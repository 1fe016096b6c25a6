//! A Denavit-Hartenberg table, and whether it is the vendor's.

use crate::errors::{Class, Spot, argument, error, said};
use crate::robot::stated;
use denavit_export::{Sheet, Units, formats, matched, sources};
use denavit_load::Made;
use denavit_model::Chain;
use denavit_model::units::Unit;
use pyo3::prelude::*;
use std::sync::Arc;

/// For each heading the name of the column of a D-H table that it means; `None` where such a column is not read.
#[pyfunction]
#[expect(clippy::needless_pass_by_value, reason = "what Python calls with is handed over by value")]
pub fn table_columns(headings: Vec<String>) -> Vec<Option<&'static str>> {
    headings.iter().map(|heading| sources::column(heading)).collect()
}

/// Words for the units of a table: those that are given, m and rad where none is.
#[pyfunction]
pub fn table_units(given: &str) -> PyResult<String> {
    let stated = stated(None, given)?;
    let (length, angle) = (stated.length.unwrap_or(Unit::Metre), stated.angle.unwrap_or(Unit::Radian));
    Ok(format!("{},{}", length.word(), angle.word()))
}

/// A table.
#[pyclass(frozen, module = "denavit._denavit")]
pub struct Table {
    pub made: Made,
    pub chain: Chain,
    pub file: Arc<str>,
}

fn units(written: &str) -> PyResult<Units> {
    let units = Units::default().with_words(written);
    units.map_err(|unknown| {
        argument(format!("units: \"{}\" is not a known unit; write m or mm, and deg or rad", unknown.word))
    })
}

impl Table {
    fn sheet(&self, units: Units) -> Sheet<'_> {
        Sheet {
            table: &self.made.table.value,
            convention: self.made.convention,
            units,
            notes: &self.made.table.notes,
            source: &self.file,
            gauge: self.made.gauge,
        }
    }
}

#[pymethods]
impl Table {
    /// In one of the formats of `denavit table`.
    fn render(&self, format: &str, units: &str) -> PyResult<String> {
        let known = || formats::FORMATS.iter().map(|format| format.name).collect::<Vec<_>>().join(", ");
        let found = formats::named(format);
        let found = found.ok_or_else(|| argument(format!("format is \"{format}\"; write one of {}", known())))?;
        let rendered = (found.render)(&self.sheet(self::units(units)?));
        rendered.map(said).map_err(|failure| error(Class::Export, &failure.to_string(), Spot::default()))
    }

    /// Column names, cells as text row by row, and one sentence on how a row is to be read.
    #[expect(clippy::type_complexity, reason = "it is the grid of a document")]
    fn cells(
        &self,
        units: &str,
    ) -> PyResult<(Vec<&'static str>, Vec<(String, String, String, Vec<String>, String)>, String)> {
        let sheet = self.sheet(self::units(units)?);
        let rows = sheet.text_rows(|k| format!("q{k}"));
        let rows = rows.into_iter().map(|row| (row.label, row.joint, row.kind, row.numbers, row.limits)).collect();
        let (angle, length) = (sheet.units.angle_word(), sheet.units.length_word());
        let words = format!("{}, {angle} and {length}: {}", sheet.convention_words(), sheet.row_formula());
        Ok((sheet.number_columns(), rows, words))
    }

    /// How a vendor's table fits the robot: JSON, and text.
    #[pyo3(signature = (file, text, convention, units))]
    fn r#match(
        &self,
        py: Python<'_>,
        file: &str,
        text: &str,
        convention: Option<&str>,
        units: &str,
    ) -> PyResult<(String, String)> {
        let readings = sources::read_vendor_table(file, text, stated(convention, units)?);
        let readings =
            readings.map_err(|failure| error(Class::Robot, &failure.to_string(), (&failure.place).into()))?;
        let found = py.detach(|| matched::best(&self.chain, &readings));
        let found = found.map_err(|failure| error(Class::Argument, &format!("{file}: {failure}"), Spot::file(file)))?;
        let words = matched::text(&self.chain, file, &found, Units::default());
        let words = said(words);
        Ok((matched::json(&self.chain, file, &found), words))
    }
}
