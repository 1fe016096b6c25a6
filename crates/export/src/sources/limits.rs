//! Limits of a joint in a table: columns `lower` and `upper` (`q⁻`, `q⁺`), or one column of ranges.

use super::cell::Cell;
use super::rows::{RowOf, Rows};
use super::{SourceError, SourceErrorKind};
use denavit_model::Quantity;
use denavit_model::units::Unit;

/// A row's joint limits, rad or m.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Limit {
    /// Nothing.
    NotStated,
    /// Continuous.
    Endless,
    /// From and to.
    Range(f64, f64),
    /// Something else.
    NotUnderstood(String),
}

/// The limits in a row; `of_file` is the unit of numbers without one.
pub(super) fn of_row(row: &RowOf, rows: &Rows, quantity: Quantity, of_file: Unit) -> Result<Limit, SourceError> {
    let bound = |name: &str| -> Result<Option<f64>, SourceError> {
        let text = row.text(name);
        if text.is_empty() || text == "-" {
            return Ok(None);
        }
        let of_heading = rows.heading(name).and_then(|heading| bracketed(&heading.written, quantity));
        let cell = Cell::of(text, quantity).filter(|cell| cell.variable.is_none());
        let cell = cell.ok_or_else(|| row.not_a_number(name))?;
        Ok(Some(cell.unit.or(of_heading).unwrap_or(of_file).to_si(cell.constant)))
    };
    match (bound("lower")?, bound("upper")?) {
        (Some(lower), Some(upper)) if lower <= upper => return Ok(Limit::Range(lower, upper)),
        (Some(_), Some(_)) => return Err(row.error_in("lower", SourceErrorKind::Limits)),
        (None, None) => {}
        _ => return Ok(Limit::NotUnderstood(format!("{} {}", row.text("lower"), row.text("upper")))),
    }
    let of_heading = rows.heading("limits").and_then(|heading| bracketed(&heading.written, quantity));
    Ok(range(row.text("limits"), quantity, of_heading.unwrap_or(of_file)))
}

/// The unit in the brackets of a heading whose column may count either quantity.
fn bracketed(written: &str, quantity: Quantity) -> Option<Unit> {
    let inside = written.rsplit_once(['[', '('])?.1;
    Unit::of(inside.trim_end_matches([']', ')']), quantity)
}

/// `-170 … 170°`, `±170°`, `endless`: ranges as our documents and manuals print them.
fn range(text: &str, quantity: Quantity, of_file: Unit) -> Limit {
    let text = text.trim();
    if ["", "-", "–", "none stated"].contains(&text) || text.starts_with("follows ") {
        return Limit::NotStated;
    }
    if text == "endless" {
        return Limit::Endless;
    }
    let number = |text: &str| Cell::of(text, quantity).filter(|cell| cell.variable.is_none());
    let parsed = || {
        if let Some(both) = text.strip_prefix('±').or_else(|| text.strip_prefix("+/-")) {
            let cell = number(both)?;
            let bound = cell.unit.unwrap_or(of_file).to_si(cell.constant);
            return Some((-bound, bound));
        }
        let (lower, upper) =
            text.split_once('…').or_else(|| text.split_once("...")).or_else(|| text.split_once(" to "))?;
        let (lower, upper) = (number(lower)?, number(upper)?);
        // One unit after both numbers.
        let shared = upper.unit.or(lower.unit).unwrap_or(of_file);
        let si = |cell: Cell| cell.unit.unwrap_or(shared).to_si(cell.constant);
        Some((si(lower), si(upper)))
    };
    match parsed() {
        Some((lower, upper)) if lower <= upper => Limit::Range(lower, upper),
        _ => Limit::NotUnderstood(text.to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn ranges_as_documents_print_them() {
        let of = |text, quantity, unit| range(text, quantity, unit);
        assert_eq!(of("-180 … 180°", Quantity::Angle, Unit::Radian), Limit::Range(-PI, PI));
        assert_eq!(of("±90°", Quantity::Angle, Unit::Radian), Limit::Range(-PI / 2.0, PI / 2.0));
        assert_eq!(of("0 … 1.25 m", Quantity::Length, Unit::Millimetre), Limit::Range(0.0, 1.25));
        assert_eq!(of("-1 … 1 rad", Quantity::Angle, Unit::Degree), Limit::Range(-1.0, 1.0));
        assert_eq!(of("none stated", Quantity::Angle, Unit::Degree), Limit::NotStated);
        assert_eq!(of("endless", Quantity::Angle, Unit::Degree), Limit::Endless);
        assert_eq!(of("see page 3", Quantity::Angle, Unit::Degree), Limit::NotUnderstood("see page 3".into()));
        assert_eq!(of("3 … 1", Quantity::Angle, Unit::Degree), Limit::NotUnderstood("3 … 1".into()));
    }
}
