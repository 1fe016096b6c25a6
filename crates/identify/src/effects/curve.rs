//! The error curve of a joint: a smooth function of its own reading, no cause claimed.
//!
//! A curve is a sum of waves whose shapes do not depend on how smooth it is: sines on the range that was measured, or
//! harmonics of a joint that turns all round. How large each wave may be is the kernel's spectral density at its frequency
//! (Solin, Särkkä 2020, "Hilbert space methods for reduced-rank Gaussian process regression").

use serde::{Deserialize, Serialize};
use std::f64::consts::{PI, TAU};

/// Share of the range that the sines' interval adds at both ends together. A sine is zero at the ends of its interval, so
/// the interval must exceed the range; Riutort-Mayol et al. 2023 ("Practical Hilbert space approximate Bayesian
/// Gaussian processes") use a factor of 1.2 and more for length scales that are short relative to the range.
const MARGIN: f64 = 0.2;

/// Number of readings at which a curve's standard deviation is stored.
const SPREAD_PLACES: usize = 400;

/// The waves that make a curve.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Waves {
    /// sin(k π (x - low)/width), k from 1 on, for readings from `low` to `low + width`; 0 elsewhere.
    Sines {
        /// rad or m.
        low: f64,
        /// rad or m.
        width: f64,
        /// How many.
        count: usize,
    },
    /// sin(k x), cos(k x), k from 1 on.
    Turns {
        /// How many k.
        count: usize,
    },
}

impl Waves {
    /// For a joint measured between two readings: harmonics if it is continuous and covered more than a turn, else sines.
    ///
    /// # Shape and units
    /// `highest`: no wave is faster than this, rad per rad or per m; `most`: nor are there more of them.
    pub fn over(low: f64, high: f64, continuous: bool, highest: f64, most: usize) -> Self {
        let span = high - low;
        if continuous && span > TAU {
            return Self::Turns { count: (highest.floor() as usize).min(most / 2).max(1) };
        }
        let width = span * (1.0 + MARGIN);
        let count = ((highest * width / PI).ceil() as usize).min(most).max(1);
        Self::Sines { low: low - 0.5 * MARGIN * span, width, count }
    }

    /// Number of weights of a curve of these waves.
    pub fn len(&self) -> usize {
        match self {
            Self::Sines { count, .. } => *count,
            Self::Turns { count } => 2 * count,
        }
    }

    /// Whether there is no wave.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Frequency of wave `index`, rad per unit of the reading: 1 is one period per turn.
    pub fn frequency(&self, index: usize) -> f64 {
        match self {
            Self::Sines { width, .. } => (index + 1) as f64 * PI / width,
            Self::Turns { .. } => (index / 2 + 1) as f64,
        }
    }

    /// Prior variance of a wave's number per unit of the kernel's spectral density.
    pub fn variance_per_density(&self) -> f64 {
        match self {
            Self::Sines { width, .. } => 2.0 / width,
            Self::Turns { .. } => 1.0 / PI,
        }
    }

    /// Whether a reading is within the interval of the waves.
    pub fn covers(&self, reading: f64) -> bool {
        match self {
            Self::Sines { low, width, .. } => (*low..=low + width).contains(&reading),
            Self::Turns { .. } => true,
        }
    }

    /// The waves at a reading, into `out`.
    pub fn values_into(&self, reading: f64, out: &mut [f64]) {
        let mut places = out.iter_mut();
        self.each(reading, |value| {
            if let Some(place) = places.next() {
                *place = value;
            }
        });
    }

    /// The waves at a reading.
    pub fn values(&self, reading: f64) -> Vec<f64> {
        let mut values = vec![0.0; self.len()];
        self.values_into(reading, &mut values);
        values
    }

    /// Takes the waves at a reading, one after the other.
    fn each(&self, reading: f64, mut take: impl FnMut(f64)) {
        let (angle, inside, count) = match self {
            Self::Sines { low, width, count } => {
                (PI * (reading - low) / width, reading >= *low && reading <= low + width, *count)
            }
            Self::Turns { count } => (reading, true, *count),
        };
        if !inside {
            (0..self.len()).for_each(|_| take(0.0));
            return;
        }
        let both = matches!(self, Self::Turns { .. });
        let (sine, cosine) = angle.sin_cos();
        let (mut s, mut c) = (0.0, 1.0);
        for _ in 0..count {
            (s, c) = (s * cosine + c * sine, c * cosine - s * sine);
            take(s);
            if both {
                take(c);
            }
        }
    }
}

/// A joint's error curve: value += curve(value).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Curve {
    /// The joint, counted from 0.
    pub joint: usize,
    /// Its waves.
    pub waves: Waves,
    /// One number per wave, rad or m.
    pub weights: Vec<f64>,
    /// Lowest and highest reading in the data, rad or m.
    pub range: (f64, f64),
    /// Prior standard deviation of the curve, rad or m: the kernel's.
    pub size: f64,
    /// The kernel's length scale, rad or m.
    pub length: f64,
    /// Standard deviation of the curve at evenly spaced readings over the range, ends included, rad or m.
    pub spread: Vec<f64>,
}

impl Curve {
    /// Correction of the joint's value at a reading, rad or m; 0 where there were no data.
    pub fn value(&self, reading: f64) -> f64 {
        let (mut weights, mut sum) = (self.weights.iter(), 0.0);
        self.waves.each(reading, |wave| sum += weights.next().map_or(0.0, |weight| wave * weight));
        sum
    }

    /// Standard deviation of the curve at a reading, rad or m; the prior's where there were no data.
    pub fn deviation(&self, reading: f64) -> f64 {
        let (low, high) = self.range;
        if !(low..=high).contains(&reading) || self.spread.len() < 2 {
            return self.size;
        }
        let at = (reading - low) / (high - low) * (self.spread.len() - 1) as f64;
        let index = (at as usize).min(self.spread.len() - 2);
        let part = at - index as f64;
        self.spread[index] * (1.0 - part) + self.spread[index + 1] * part
    }

    /// Readings at which the spread is stored.
    pub fn places(range: (f64, f64)) -> impl Iterator<Item = f64> {
        (0..SPREAD_PLACES).map(move |k| range.0 + (range.1 - range.0) * k as f64 / (SPREAD_PLACES - 1) as f64)
    }

    /// The fault of a curve from a file, for a chain of this many joints.
    pub(super) fn fault(&self, joints: usize) -> Option<String> {
        if self.joint >= joints {
            return Some(format!("it names joint {}; joints are 0 to {}", self.joint, joints.saturating_sub(1)));
        }
        if self.weights.len() != self.waves.len() {
            return Some(format!("{} weights are given; give {}", self.weights.len(), self.waves.len()));
        }
        let numbers = self.weights.iter().chain(&self.spread).chain([&self.size, &self.length]);
        let width = if let Waves::Sines { width, .. } = self.waves { width } else { 1.0 };
        let good = numbers.copied().all(f64::is_finite) && width > 0.0 && self.range.0 < self.range.1;
        (!good).then(|| "one of its numbers is not finite, or its range is empty; give finite numbers".into())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn waves_are_sines_of_their_frequencies() {
        for waves in [Waves::over(-1.0, 2.0, false, 30.0, 50), Waves::over(-4.0, 4.0, true, 40.0, 100)] {
            for reading in [-0.9, 0.1, 1.7] {
                for (index, value) in waves.values(reading).into_iter().enumerate() {
                    let wanted = match &waves {
                        Waves::Sines { low, .. } => (waves.frequency(index) * (reading - low)).sin(),
                        Waves::Turns { .. } if index % 2 == 0 => (waves.frequency(index) * reading).sin(),
                        Waves::Turns { .. } => (waves.frequency(index) * reading).cos(),
                    };
                    assert!((value - wanted).abs() < 1e-12, "{index} at {reading}: {value} {wanted}");
                }
            }
        }
        assert_eq!(Waves::over(0.0, 1.0, false, 10.0, 9).values(7.0), [0.0; 4]);
    }

    #[test]
    fn beyond_the_data_a_curve_is_nothing_and_unsure() {
        let waves = Waves::over(0.0, 1.0, false, 10.0, 9);
        let weights = vec![1e-3; waves.len()];
        let curve =
            Curve { joint: 0, waves, weights, range: (0.0, 1.0), size: 1e-3, length: 0.1, spread: vec![1e-5, 3e-5] };
        assert_eq!((curve.value(5.0), curve.deviation(5.0)), (0.0, 1e-3));
        assert!(curve.value(0.4) != 0.0 && (curve.deviation(0.5) - 2e-5).abs() < 1e-18);
    }
}
