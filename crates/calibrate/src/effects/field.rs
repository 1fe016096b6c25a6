//! A smooth function of two joints' readings: an error of a joint for which no cause is claimed, as a curve is of one reading.
//!
//! It is a sum of products of one shape of each reading. No shape is constant: what hangs on one reading alone is a curve's.

use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

/// Shapes over one reading.
const SHAPES: usize = 4;
/// Beyond the range that was measured a shape is nothing after some of this share of the range.
const FADES: f64 = 0.1;

/// Shapes over one joint's reading: of the k-th wave a k-th is expected of what is expected of the first.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Shapes {
    /// cos(k π (x - low)/(high - low))/k for k from 1 to 4; beyond, what it is at the end, fading to nothing.
    Range {
        /// Lowest reading in the data, rad or m.
        low: f64,
        /// Highest reading in the data, rad or m.
        high: f64,
    },
    /// sin(k x)/k and cos(k x)/k for k = 1 and 2, of a joint that turns all round.
    Turns,
}

impl Shapes {
    /// At a reading.
    pub fn values(&self, reading: f64) -> [f64; SHAPES] {
        match *self {
            Self::Range { low, high } => {
                let inside = reading.clamp(low, high);
                let beyond = (reading - inside) / (FADES * (high - low));
                let (part, fades) = (PI * (inside - low) / (high - low), (-0.5 * beyond * beyond).exp());
                std::array::from_fn(|k| fades * ((k + 1) as f64 * part).cos() / (k + 1) as f64)
            }
            Self::Turns => {
                let ((sine, cosine), (twice_sine, twice_cosine)) = (reading.sin_cos(), (2.0 * reading).sin_cos());
                [sine, cosine, 0.5 * twice_sine, 0.5 * twice_cosine]
            }
        }
    }
}

/// A joint's reading and the shapes over it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ShapedReading {
    /// The joint, counted from 0.
    pub joint: usize,
    /// Over its reading.
    pub shapes: Shapes,
}

/// Products of the shapes of two readings: shape by shape of the first, within it of the second.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Products {
    /// Of these two joints.
    pub of: [ShapedReading; 2],
    /// What is expected of the coefficient of each product, rad or m: a standard deviation.
    pub size: f64,
}

impl Products {
    /// How many there are.
    pub const COUNT: usize = SHAPES * SHAPES;

    /// Their joints.
    pub fn joints(&self) -> [usize; 2] {
        self.of.map(|reading| reading.joint)
    }

    /// At the values of the two joints, appended to `out`.
    pub fn values_into(&self, [first, second]: [f64; 2], out: &mut Vec<f64>) {
        let [a, b] = [self.of[0].shapes.values(first), self.of[1].shapes.values(second)];
        out.extend(a.iter().flat_map(|a| b.iter().map(move |b| a * b)));
    }

    /// Whether its numbers can be.
    pub(super) fn possible(&self) -> bool {
        let ranges = self.of.iter().all(|reading| match reading.shapes {
            Shapes::Range { low, high } => low.is_finite() && high.is_finite() && low < high,
            Shapes::Turns => true,
        });
        ranges && self.size.is_finite() && self.size > 0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn products() -> Products {
        let shapes = [Shapes::Range { low: -1.0, high: 2.0 }, Shapes::Turns];
        Products { of: [0, 1].map(|joint| ShapedReading { joint, shapes: shapes[joint] }), size: 1e-4 }
    }

    #[test]
    fn over_its_range_no_product_has_a_part_of_one_reading_alone() {
        let places = 600u32;
        let at = |k: u32, low: f64, span: f64| low + span * (f64::from(k) + 0.5) / f64::from(places);
        let mean = |reading: &dyn Fn(u32) -> [f64; 2]| {
            let mut sums = vec![0.0; Products::COUNT];
            for k in 0..places {
                let mut values = Vec::new();
                products().values_into(reading(k), &mut values);
                sums.iter_mut().zip(&values).for_each(|(sum, value)| *sum += value / f64::from(places));
            }
            sums
        };
        let along_first = mean(&|k| [at(k, -1.0, 3.0), 0.7]);
        let along_second = mean(&|k| [0.4, at(k, -PI, 2.0 * PI)]);
        assert!(
            along_first.iter().chain(&along_second).all(|mean| mean.abs() < 1e-9),
            "{along_first:?} {along_second:?}"
        );
    }

    #[test]
    fn beyond_the_range_it_fades_without_a_step() {
        let shapes = Shapes::Range { low: -1.0, high: 2.0 };
        let size = |reading: f64| shapes.values(reading).iter().map(|value| value.abs()).sum::<f64>();
        let (end, near, far) = (shapes.values(2.0), shapes.values(2.0 + 1e-6), size(3.5));
        assert!(end.iter().zip(&near).all(|(a, b)| (a - b).abs() < 1e-9) && far < 1e-4 * size(2.0), "{far}");
    }

    #[test]
    fn numbers_that_cannot_be_are_told() {
        assert!(products().possible());
        let mut inside_out = products();
        inside_out.of[0].shapes = Shapes::Range { low: 1.0, high: 1.0 };
        assert!(!inside_out.possible() && !Products { size: 0.0, ..products() }.possible());
    }
}
