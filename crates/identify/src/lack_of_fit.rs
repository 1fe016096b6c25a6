//! Rows that repeat a posture: the repeatability of instrument and arm, and whether the model has a lack of fit.
//!
//! Residuals at one posture differ by the pure error alone; their common part is the lack of fit. The
//! variances are compared by Fisher's F (Draper and Smith, Applied Regression Analysis, 3rd edition, section 2.1).

use crate::residual_statistics::Residual;
use denavit_measurements::Measurements;
use denavit_model::nalgebra::Vector3;
use serde::Serialize;
use statrs::distribution::{ContinuousCDF, FisherSnedecor};

/// Fewest degrees of freedom to estimate the pure error.
const LEAST_DEGREES: usize = 3;

/// Repeats of one kind of value: of positions, distances or orientations.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct LackOfFit {
    /// `position`, `distance`, `orientation` …
    pub of: &'static str,
    /// `m` or `rad`.
    pub unit: &'static str,
    /// Postures that were measured more than once.
    pub postures: usize,
    /// Observations at them.
    pub observations: usize,
    /// Standard deviation of one component between repeats: the pure error, which no model can remove.
    pub pure_error: f64,
    /// Degrees of freedom of the pure error.
    pub pure_degrees: usize,
    /// Standard deviation of the lack of fit of one component, 0 where there is none.
    pub missed: f64,
    /// Degrees of freedom of the lack of fit.
    pub missed_degrees: usize,
    /// Variance of the lack of fit over that of the pure error; absent where the repeats are equal to the last digit.
    pub f: Option<f64>,
    /// Probability of this F or a larger one without lack of fit.
    pub p_value: f64,
}

/// The repeats among fitted rows, one entry for each kind of value.
///
/// # Shape and units
/// `residuals`: m and rad, of the rows that were kept, computed only where a posture repeats; `parameters`: number of identified
/// parameters, divided among the kinds by their number of values.
pub fn lack_of_fit(
    data: &Measurements,
    residuals: impl FnOnce() -> Vec<Residual>,
    parameters: usize,
) -> Vec<LackOfFit> {
    let postures = data.postures();
    if !postures.any_repeats() {
        return Vec::new();
    }
    let residuals = residuals();
    let mut posture = vec![0; data.len()];
    for (index, rows) in postures.iter().enumerate() {
        for row in rows {
            posture[*row] = index;
        }
    }
    let mut sorted: Vec<&Residual> = residuals.iter().collect();
    sorted.sort_by_key(|residual| (posture[residual.row], residual.series));
    let groups: Vec<&[&Residual]> =
        sorted.chunk_by(|a, b| (posture[a.row], a.series) == (posture[b.row], b.series)).collect();
    let all: usize = residuals.iter().map(|residual| data.scene.series[residual.series].kind.height()).sum();
    let of_channel = |channel: usize| {
        let part = data.scene.channels[channel];
        let mut sums = Sums::default();
        for group in &groups {
            let own = data.scene.series[group[0].series].channels;
            if own[0] == Some(channel) {
                sums.add(group.iter().map(|residual| residual.place), part.height);
            } else if own[1] == Some(channel) {
                sums.add(group.iter().map(|residual| residual.turn), part.height);
            }
        }
        let share = parameters as f64 * sums.values as f64 / all.max(1) as f64;
        sums.judge(part.word, part.unit, share)
    };
    (0..data.scene.channels.len()).filter_map(of_channel).collect()
}

#[derive(Default)]
struct Sums {
    postures: usize,
    observations: usize,
    values: usize,
    total: f64,
    pure: f64,
    pure_degrees: usize,
}

impl Sums {
    fn add(&mut self, residuals: impl Iterator<Item = Vector3<f64>> + Clone, height: usize) {
        let count = residuals.clone().count();
        let mean = residuals.clone().sum::<Vector3<f64>>() / count as f64;
        self.total += residuals.clone().map(|residual| residual.norm_squared()).sum::<f64>();
        self.values += count * height;
        if count > 1 {
            self.postures += 1;
            self.observations += count;
            self.pure += residuals.map(|residual| (residual - mean).norm_squared()).sum::<f64>();
            self.pure_degrees += (count - 1) * height;
        }
    }

    fn judge(&self, of: &'static str, unit: &'static str, parameters: f64) -> Option<LackOfFit> {
        let degrees = self.values as f64 - parameters - self.pure_degrees as f64;
        if self.pure_degrees < LEAST_DEGREES || degrees < 1.0 {
            return None;
        }
        let (missed, pure) = ((self.total - self.pure).max(0.0) / degrees, self.pure / self.pure_degrees as f64);
        let f = (pure > 0.0).then(|| missed / pure);
        let chance = FisherSnedecor::new(degrees, self.pure_degrees as f64);
        let p_value = match (f, chance) {
            (Some(f), Ok(chance)) => chance.sf(f),
            _ => f64::from(u8::from(missed == 0.0)),
        };
        Some(LackOfFit {
            of,
            unit,
            postures: self.postures,
            observations: self.observations,
            pure_error: pure.sqrt(),
            pure_degrees: self.pure_degrees,
            missed: (missed - pure).max(0.0).sqrt(),
            // The number of parameters per kind need not be an integer.
            #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
            missed_degrees: degrees.round() as usize,
            f,
            p_value,
        })
    }
}
