//! Rows beside their prediction by a fit of others, and whether they are out of line.

use denavit_identify::parameters::NoEffects;
use denavit_identify::residual::{ResidualModel, Scratch};
use denavit_identify::solve::{FALSE_REJECTIONS, Fit, GROSS};
use denavit_measurements::Measurements;
use denavit_model::nalgebra::{DMatrix, DVector};
use serde::Serialize;
use statrs::distribution::{ContinuousCDF, FisherSnedecor};

/// A row's residual and its expected size, by noise channel.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Off {
    /// What it is of, such as `position`.
    pub what: &'static str,
    /// Measured less predicted by the rows before: root mean square of the norms over what the row observes.
    pub error: f64,
    /// Its standard deviation: noise and parameter uncertainty.
    pub expected: f64,
    /// `m` or `rad`.
    pub unit: &'static str,
}

/// Why a row is out of line.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct OutOfLine {
    /// rᵀ S⁻¹ r over the number of values.
    pub size: f64,
    /// The size at which a row is out of line.
    pub limit: f64,
    /// The targets that are out of line, where the row sees several.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub targets: Vec<String>,
    /// How many rows one after another are out of line, this one included.
    pub rows: usize,
    /// Possible causes, the likeliest first; empty if no tested cause explains them.
    pub explanations: Vec<String>,
    /// Whether more rows are needed to test every cause: one position cannot distinguish another reflector from a moved base.
    pub undecided: bool,
}

/// Residuals of some rows and their covariance by a fit of others.
pub struct Prediction {
    /// Observations, with their first value.
    pub observations: Vec<(usize, usize)>,
    /// Measured less predicted.
    pub residual: DVector<f64>,
    /// S: that of the residual.
    pub covariance: DMatrix<f64>,
}

impl Prediction {
    /// For these rows.
    pub fn of(fit: &Fit<NoEffects>, data: &Measurements, rows: &[usize]) -> Self {
        let problem = ResidualModel { data, layout: &fit.layout, effects: &NoEffects };
        let columns = fit.layout.len();
        let height: usize = rows.iter().map(|&row| problem.height_of(row)).sum();
        let (mut residual, mut jacobian) = (vec![0.0; height], vec![0.0; height * columns]);
        let mut scratch = Scratch::new(&fit.layout, &fit.arm);
        let (mut at, mut observations, mut variances) = (0, Vec::new(), Vec::new());
        for &row in rows {
            let end = at + problem.height_of(row);
            let cells = &mut jacobian[at * columns..end * columns];
            problem.row_into(&fit.arm, row, &mut scratch, &mut residual[at..end], Some(cells));
            for observation in data.of_row(row) {
                observations.push((observation, at));
                let series = data.series_of(observation);
                let parts = [Some(series.kind.place()), series.kind.turn()];
                for (part, channel) in parts.into_iter().zip(series.channels) {
                    let height = part.map_or(0, |part| part.height);
                    let level = channel.map_or(0.0, |channel| fit.noise.levels[channel]);
                    variances.extend(std::iter::repeat_n(level * level, height));
                    at += height;
                }
            }
        }
        let jacobian = DMatrix::from_row_slice(height, columns, &jacobian);
        let mut covariance = &jacobian * &fit.covariance * jacobian.transpose();
        for (i, variance) in variances.into_iter().enumerate() {
            covariance[(i, i)] += variance;
        }
        Self { observations, residual: DVector::from_vec(residual), covariance }
    }

    /// rᵀ S⁻¹ r of some of the values; infinite where S has no inverse.
    fn chi_squared(&self, from: usize, height: usize) -> f64 {
        let own = self.covariance.view((from, from), (height, height)).into_owned();
        let residual = self.residual.rows(from, height).into_owned();
        own.cholesky().map_or(f64::INFINITY, |factor| residual.dot(&factor.solve(&residual)))
    }

    /// By noise channel.
    pub fn off(&self, fit: &Fit<NoEffects>, data: &Measurements) -> Vec<Off> {
        let of = |(index, part): (usize, &denavit_measurements::kinds::Part)| {
            let (mut square, mut expected, mut count) = (0.0, 0.0, 0.0);
            for &(observation, first) in &self.observations {
                let series = data.series_of(observation);
                let Some(which) = series.channels.iter().position(|own| *own == Some(index)) else { continue };
                let first = if which == 0 { first } else { first + series.kind.place().height };
                square += self.residual.rows(first, part.height).norm_squared();
                expected += (first..first + part.height).map(|i| self.covariance[(i, i)]).sum::<f64>();
                count += 1.0;
            }
            let root = |sum: f64| f64::sqrt(sum / count);
            (count > 0.0).then(|| Off {
                what: part.word,
                error: root(square),
                expected: root(expected),
                unit: part.unit,
            })
        };
        debug_assert_eq!(fit.noise.levels.len(), data.scene.channels.len());
        data.scene.channels.iter().enumerate().filter_map(of).collect()
    }

    /// Why these rows are out of line; `None` where they are not.
    pub fn out_of_line(&self, fit: &Fit<NoEffects>, data: &Measurements) -> Option<OutOfLine> {
        let degrees = fit.degrees_of_freedom();
        // Each observation of each row so far may be an outlier by chance.
        let share = FALSE_REJECTIONS / data.observations().max(1) as f64;
        let mut worst: Option<OutOfLine> = None;
        let mut targets = Vec::new();
        for &(observation, first) in &self.observations {
            let series = data.series_of(observation);
            let height = series.kind.height();
            let size = self.chi_squared(first, height) / height as f64;
            let limit = GROSS * GROSS * quantile(height as f64, degrees, 1.0 - share);
            if size <= limit {
                continue;
            }
            targets.push(data.scene.targets[series.target].clone());
            if worst.as_ref().is_none_or(|worst| size / limit > worst.size / worst.limit) {
                let (targets, explanations) = (Vec::new(), Vec::new());
                worst = Some(OutOfLine { size, limit, targets, rows: 1, explanations, undecided: false });
            }
        }
        targets.dedup();
        let several = data.scene.targets.len() > 1;
        worst.map(|worst| OutOfLine { targets: if several { targets } else { Vec::new() }, ..worst })
    }
}

/// Quantile of Fisher's distribution.
pub fn quantile(height: f64, degrees: f64, share: f64) -> f64 {
    FisherSnedecor::new(height, degrees).map_or(f64::INFINITY, |fisher| fisher.inverse_cdf(share))
}
