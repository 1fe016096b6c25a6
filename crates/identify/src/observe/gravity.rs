//! The direction of gravity in a sensor on the tip: an accelerometer at rest, or an inclinometer with two axes.
//!
//! With d = (R(T) Rs)⁻¹ g the direction of gravity in the sensor's axes, Rs the sensor's mounting and g = X⁻¹(-z) gravity in the
//! base frame, X a frame of which only the z axis is observable:
//!
//! - for an accelerometer r = -(α/sin α) bᵢ·d, rad, with m the measured direction, b₁ and b₂ across it, and α the angle between m and d;
//! - for an inclinometer r = mᵢ + asin dᵢ, rad, with mᵢ the angle of its axis i above the horizontal.
//!
//! Neither Rs nor g is known, so that a sensor that reads up is as good as one that reads down. The sensor's position on its link is
//! not observable.

use super::{Discrepancy, Disturbance, Follows, Observe, Rows, Seen};
use crate::parameters::Layout;
use denavit_model::nalgebra::{Matrix3, Rotation3, Vector2, Vector3};

#[derive(Debug)]
pub(super) struct Gravity;

#[derive(Debug)]
pub(super) struct Inclination;

/// Angles whose sine is less than this are small, rad.
const SMALL: f64 = 1e-4;
/// Lower bound of 1 - sin² near the vertical, where the slope of the arcsine is infinite.
const UPRIGHT: f64 = 1e-6;
/// Base frame from the sensor's axes.
fn sensor(seen: &Seen<'_>) -> Rotation3<f64> {
    seen.tip.rotation * seen.arm.targets[seen.series.target].rotation
}

/// Direction of gravity, base frame.
pub(crate) fn down(seen: &Seen<'_>) -> Vector3<f64> {
    -(seen.instrument().rotation.inverse() * Vector3::z())
}

/// The same in the sensor's axes.
fn felt(seen: &Seen<'_>) -> Vector3<f64> {
    sensor(seen).inverse() * down(seen)
}

/// A residual of two angles, and its derivative by the direction of gravity in the sensor's axes.
struct Angles {
    residual: Vector2<f64>,
    slopes: [Vector3<f64>; 2],
}

impl Angles {
    fn discrepancy(&self) -> Discrepancy {
        Discrepancy { place: Vector3::new(self.residual.x, self.residual.y, 0.0), turn: Vector3::zeros() }
    }

    /// A rotation ω of the sensor changes d to d + Sᵀ (g × ω).
    fn follows(&self, seen: &Seen<'_>) -> Follows {
        let (sensor, down) = (sensor(seen), down(seen));
        Follows::Turns(self.slopes.map(|slope| down.cross(&(sensor * slope))))
    }

    /// Turns of the level's frame about its own x and y.
    fn own_columns(&self, seen: &Seen<'_>, layout: &Layout, rows: &mut Rows<'_>) {
        let Some(column) = layout.levels[seen.series.setup] else { return };
        let to_level = seen.instrument().rotation * sensor(seen);
        for (row, slope) in self.slopes.iter().enumerate() {
            let slope = to_level * slope;
            rows.put(row, column, &[-slope.y, slope.x]);
        }
    }
}

/// For a measured direction, length 1.
fn beside(seen: &Seen<'_>) -> Angles {
    let (read, felt) = (Vector3::new(seen.values[0], seen.values[1], seen.values[2]), felt(seen));
    let first = read.cross(&Vector3::ith(read.iamin(), 1.0)).normalize();
    let across = [first, read.cross(&first)];
    let (sine, cosine) = (read.cross(&felt).norm(), read.dot(&felt));
    // α/sin α, and its derivative by the cosine.
    let (stretch, slope) = if sine < SMALL && cosine > 0.0 {
        (1.0 + sine * sine / 6.0, -1.0 / 3.0)
    } else {
        let sine = sine.max(SMALL);
        let stretch = sine.atan2(cosine) / sine;
        (stretch, (cosine * stretch - 1.0) / (sine * sine))
    };
    let parts = across.map(|across| across.dot(&felt));
    let slopes = [0, 1].map(|k| -(across[k] * stretch + read * (slope * parts[k])));
    Angles { residual: -Vector2::from(parts) * stretch, slopes }
}

/// Angle of an axis of the sensor below the horizontal, rad.
fn below(felt: &Vector3<f64>, axis: usize) -> f64 {
    felt[axis].atan2(felt[(axis + 1) % 3].hypot(felt[(axis + 2) % 3]))
}

/// For the angles of two axes above the horizontal, rad.
fn above(seen: &Seen<'_>) -> Angles {
    let felt = felt(seen);
    let residual = Vector2::from_fn(|k, _| seen.values[k] + below(&felt, k));
    let slopes = [0, 1].map(|k| Vector3::ith(k, 1.0 / (1.0 - felt[k] * felt[k]).max(UPRIGHT).sqrt()));
    Angles { residual, slopes }
}

impl Observe for Gravity {
    fn discrepancy(&self, seen: &Seen<'_>) -> Discrepancy {
        beside(seen).discrepancy()
    }

    fn follows(&self, seen: &Seen<'_>) -> Follows {
        beside(seen).follows(seen)
    }

    fn own_columns(&self, seen: &Seen<'_>, layout: &Layout, _left: &Matrix3<f64>, rows: &mut Rows<'_>) {
        beside(seen).own_columns(seen, layout, rows);
    }

    fn predict(&self, seen: &Seen<'_>, values: &mut Vec<f64>) {
        values.extend(felt(seen).iter());
    }

    fn disturb(&self, values: &mut [f64], errors: &mut Disturbance<'_>) {
        let off = errors.vector(errors.orientation) + errors.gross;
        let read = (Vector3::new(values[0], values[1], values[2]) + off).normalize();
        values.copy_from_slice(read.as_slice());
    }
}

impl Observe for Inclination {
    fn discrepancy(&self, seen: &Seen<'_>) -> Discrepancy {
        above(seen).discrepancy()
    }

    fn follows(&self, seen: &Seen<'_>) -> Follows {
        above(seen).follows(seen)
    }

    fn own_columns(&self, seen: &Seen<'_>, layout: &Layout, _left: &Matrix3<f64>, rows: &mut Rows<'_>) {
        above(seen).own_columns(seen, layout, rows);
    }

    fn predict(&self, seen: &Seen<'_>, values: &mut Vec<f64>) {
        let felt = felt(seen);
        values.extend([0, 1].map(|k| -below(&felt, k)));
    }

    fn disturb(&self, values: &mut [f64], errors: &mut Disturbance<'_>) {
        for (value, gross) in values.iter_mut().zip(errors.gross.iter()) {
            *value += gross + (errors.draw)(errors.orientation);
        }
    }
}
