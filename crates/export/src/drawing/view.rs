//! From m in space to places on the sheet: parallel projection.

use super::Detail;
use denavit_model::nalgebra::{Point3, Vector3};

/// The viewing direction; x of the base points forward, z up.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum View {
    /// From ahead: y to the right, z up.
    Front,
    /// From the robot's right: x to the right, z up.
    Side,
    /// From ahead, right and above; the three axes equally foreshortened.
    Isometric,
}

impl View {
    /// Every view, in the order of the documents.
    pub const ALL: [Self; 3] = [Self::Isometric, Self::Front, Self::Side];

    /// `front`, `side` or `isometric`.
    pub fn word(self) -> &'static str {
        match self {
            Self::Front => "front",
            Self::Side => "side",
            Self::Isometric => "isometric",
        }
    }

    /// Directions of the sheet in space: to the right, up, towards the reader.
    fn directions(self) -> [Vector3<f64>; 3] {
        match self {
            Self::Front => [Vector3::y(), Vector3::z(), Vector3::x()],
            Self::Side => [Vector3::x(), Vector3::z(), -Vector3::y()],
            Self::Isometric => [
                Vector3::new(1.0, 1.0, 0.0).normalize(),
                Vector3::new(-1.0, 1.0, 2.0).normalize(),
                Vector3::new(1.0, -1.0, 1.0).normalize(),
            ],
        }
    }
}

/// A place on the sheet: to the right, down, and towards the reader, all in px.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Place {
    pub x: f64,
    pub y: f64,
    pub near: f64,
}

impl Place {
    pub fn distance(&self, other: &Self) -> f64 {
        (self.x - other.x).hypot(self.y - other.y)
    }
}

/// The sheet: which part of space is shown, and where.
pub(crate) struct Frame {
    pub view: View,
    pub width: f64,
    pub height: f64,
    /// m per px.
    pub pixel: f64,
    directions: [Vector3<f64>; 3],
    /// Sheet coordinates (m) of the middle.
    middle: (f64, f64),
}

impl Frame {
    /// A sheet of this width around points, with room for symbols and words.
    pub fn around(points: &[Point3<f64>], view: View, width: f64, detail: Detail) -> Self {
        let directions = view.directions();
        let along = |k: usize| points.iter().map(move |point| point.coords.dot(&directions[k]));
        let bounds = |k: usize| {
            let lower = along(k).fold(f64::INFINITY, f64::min);
            let upper = along(k).fold(f64::NEG_INFINITY, f64::max);
            (lower, upper)
        };
        let ((left, right), (bottom, top)) = (bounds(0), bounds(1));
        let (margin, shortest, tallest) = match detail {
            Detail::Dimensioned => (105.0, 0.3, if view == View::Isometric { 0.86 } else { 1.15 }),
            Detail::Plain => (46.0, 0.2, 0.72),
        };
        let (wide, high) = ((right - left).max(1e-9), (top - bottom).max(1e-9));
        let room = width - 2.0 * margin;
        let pixel = (wide / room).max(high / (width * tallest - 2.0 * margin));
        let height = (high / pixel + 2.0 * margin).clamp(width * shortest, width * tallest);
        let middle = (f64::midpoint(left, right), f64::midpoint(bottom, top));
        Self { view, width, height: height.round(), pixel, directions, middle }
    }

    /// The position of a point on the sheet.
    pub fn place(&self, point: &Point3<f64>) -> Place {
        let [right, up, near] = self.directions.map(|direction| point.coords.dot(&direction));
        Place {
            x: self.width / 2.0 + (right - self.middle.0) / self.pixel,
            y: self.height / 2.0 - (up - self.middle.1) / self.pixel,
            near: near / self.pixel,
        }
    }

    /// Part of a unit direction that points to the reader, -1 to 1.
    pub fn towards_reader(&self, direction: &Vector3<f64>) -> f64 {
        direction.dot(&self.directions[2])
    }
}
