//! A plate with a grid of conical holes: touching a hole with the tip measures a position, since the position of the hole on
//! the plate is known.

use super::board::grid;
use denavit_model::nalgebra::Vector2;
use std::fmt;
use std::str::FromStr;
use thiserror::Error;

/// Most holes along a side: rows are named by one letter.
const MOST: usize = 26;

/// A plate by its holes.
///
/// Hole A1 is the origin of the plate's frame, x points to A2, y to B1, and z out of the plate. The positions are those of
/// the ball's or the point's centre in its hole: all at the same height.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plate {
    /// Holes of a row: 1, 2, …
    pub columns: usize,
    /// Rows: A, B, …
    pub rows: usize,
    /// From one hole to the next, m.
    pub pitch: f64,
}

/// A text that is not a plate.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error(
    "\"{0}\" is not a plate; write the holes per row, the number of rows and the hole spacing, such as 4x3:40mm (2 to 26 holes \
     each way)"
)]
pub struct PlateError(pub String);

impl FromStr for Plate {
    type Err = PlateError;

    /// `4x3:40mm`.
    fn from_str(text: &str) -> Result<Self, PlateError> {
        let read = grid(text).filter(|(counts, _)| counts.iter().all(|count| (2..=MOST).contains(count)));
        read.map(|([columns, rows], pitch)| Self { columns, rows, pitch }).ok_or_else(|| PlateError(text.into()))
    }
}

impl fmt::Display for Plate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}x{} holes, {} mm apart", self.columns, self.rows, self.pitch * 1e3)
    }
}

impl Plate {
    /// Names and positions of the holes, row by row, m.
    pub fn holes(&self) -> impl Iterator<Item = (String, Vector2<f64>)> + '_ {
        (0..self.rows).flat_map(move |row| {
            (0..self.columns).map(move |column| {
                let place = Vector2::new(column as f64, row as f64) * self.pitch;
                (format!("{}{}", letter(row), column + 1), place)
            })
        })
    }

    /// Position of a hole on the plate, m; `None` where the plate has no hole of that name.
    pub fn hole(&self, name: &str) -> Option<Vector2<f64>> {
        let name = name.trim();
        self.holes().find(|(known, _)| known.eq_ignore_ascii_case(name)).map(|(_, place)| place)
    }

    /// The name of the last hole.
    pub fn last(&self) -> String {
        format!("{}{}", letter(self.rows - 1), self.columns)
    }
}

fn letter(row: usize) -> char {
    char::from(b'A' + u8::try_from(row).expect("no more rows than letters"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn holes_are_named_by_row_and_column() {
        let plate: Plate = "4x3:40mm".parse().unwrap();
        let names: Vec<String> = plate.holes().map(|(name, _)| name).collect();
        assert_eq!(names.len(), 12);
        assert_eq!((names[0].as_str(), names[4].as_str(), plate.last()), ("A1", "B1", "C4".to_owned()));
        assert_eq!(plate.hole("c4"), Some(Vector2::new(0.12, 0.08)));
        assert_eq!(plate.hole("D1"), None);
        for text in ["4x3", "1x3:40mm", "4x27:40mm", "4x3:0mm", "4x3:-40mm", "4x3:40", "4x3:40kg", ""] {
            assert!(text.parse::<Plate>().is_err(), "{text}");
        }
    }
}
