//! An earlier calibration's knowledge of effects' coefficients, given the axes, as rows in addition to the measured ones.
//!
//! With η the joints' parameters, μ their expected values, c the coefficients, and C the earlier covariance,
//!
//! ```text
//! c | η ~ N(m + A (η - μ), R)      A = C_cη C_ηη⁻¹      R = C_cc - A C_ηc
//! ```
//! Together with the joints' own prior this is the earlier posterior of axes and coefficients.

use crate::parameter::Known;
use crate::symmetric;
use denavit_model::nalgebra::{DMatrix, DVector};

/// Smallest conditional standard deviation of a coefficient, as a fraction of its standard deviation: R stays invertible.
const BEST_KNOWN: f64 = 1e-5;

/// The prior of some coefficients of a model, given the joints' parameters.
#[derive(Debug, Clone, PartialEq)]
pub struct EffectsPrior {
    /// Index of the first among the numbers of all effects.
    first: usize,
    /// μ, in the parameters' units.
    expected: DVector<f64>,
    /// m, in the coefficients' units.
    mean: DVector<f64>,
    /// A: a row for each coefficient, a column for each of the joints' parameters.
    along: DMatrix<f64>,
    /// L with Lᵀ L = R⁻¹.
    whitening: DMatrix<f64>,
}

impl EffectsPrior {
    /// The prior of the coefficients from `first` on.
    ///
    /// # Shape and units
    /// `own`: covariance of the coefficients; `cross`: theirs with the joints' parameters, a row for each coefficient;
    /// `joints`: expected values of the joints' parameters, and their covariance.
    pub fn new(
        first: usize,
        mean: DVector<f64>,
        own: &DMatrix<f64>,
        cross: &DMatrix<f64>,
        (expected, joints): (DVector<f64>, DMatrix<f64>),
    ) -> Self {
        let size: Vec<f64> = (0..joints.nrows()).map(|k| joints[(k, k)].max(f64::MIN_POSITIVE).sqrt()).collect();
        let scaled = DMatrix::from_fn(size.len(), size.len(), |i, k| joints[(i, k)] / (size[i] * size[k]));
        let inverse = symmetric::inverse(&scaled, BEST_KNOWN * BEST_KNOWN);
        let inverse = DMatrix::from_fn(size.len(), size.len(), |i, k| inverse[(i, k)] / (size[i] * size[k]));
        let along = cross * inverse;
        let rest = own - &along * cross.transpose();
        let count = mean.len();
        let spread: Vec<f64> = (0..count).map(|k| own[(k, k)].max(f64::MIN_POSITIVE).sqrt()).collect();
        let mut scaled = DMatrix::from_fn(count, count, |i, k| rest[(i, k)] / (spread[i] * spread[k]));
        // Eigenvalues below 0 are rounding.
        let eigen = (0.5 * (&scaled + scaled.transpose())).symmetric_eigen();
        let kept = eigen.eigenvalues.map(|value| value.max(BEST_KNOWN * BEST_KNOWN));
        scaled = &eigen.eigenvectors * DMatrix::from_diagonal(&kept.map(|value| value.sqrt().recip()));
        let whitening = DMatrix::from_fn(count, count, |i, k| scaled[(k, i)] / spread[k]);
        Self { first, expected, mean, along, whitening }
    }

    /// The same where the joints' parameters that it was made with are these.
    #[must_use]
    pub fn spread_over(self, joints: &[usize], of: usize) -> Self {
        let mut along = DMatrix::zeros(self.mean.len(), of);
        for (from, to) in joints.iter().enumerate() {
            along.set_column(*to, &self.along.column(from));
        }
        let mut expected = DVector::zeros(of);
        joints.iter().enumerate().for_each(|(from, to)| expected[*to] = self.expected[from]);
        Self { expected, along, ..self }
    }

    /// The prior of held coefficients: each with its mean and standard deviation.
    pub fn held(first: usize, mean: DVector<f64>, std: &[f64], joints: usize) -> Self {
        let firm = |value: &f64| if *value > 0.0 { value.recip() } else { 0.0 };
        let whitening = DMatrix::from_diagonal(&DVector::from_iterator(std.len(), std.iter().map(firm)));
        Self { first, expected: DVector::zeros(joints), along: DMatrix::zeros(mean.len(), joints), whitening, mean }
    }

    /// The rows: `difference` is η, `numbers` are those of all effects, the first of them is column `start` of the layout, and the
    /// joints' parameters are the first columns.
    pub fn known(&self, difference: &DVector<f64>, numbers: &[f64], start: usize) -> Vec<Known> {
        let count = self.mean.len();
        let own = DVector::from_row_slice(&numbers[self.first..self.first + count]);
        let residual = &self.whitening * (own - &self.mean - &self.along * (difference - &self.expected));
        let by_joints = -(&self.whitening * &self.along);
        let row = |k: usize| {
            let effects = (0..count).map(|column| (start + self.first + column, self.whitening[(k, column)]));
            let joints = (0..self.along.ncols()).map(|column| (column, by_joints[(k, column)]));
            let columns = joints.chain(effects).filter(|(_, value)| *value != 0.0).collect();
            Known { residual: residual[k], columns }
        };
        (0..count).map(row).collect()
    }

    /// Precision of joints' parameters and coefficients together that these rows add, joints first; for a model that has no other
    /// coefficients.
    pub fn precision(&self) -> DMatrix<f64> {
        let (count, joints) = (self.mean.len(), self.along.ncols());
        let mut rows = DMatrix::zeros(count, joints + count);
        rows.columns_mut(0, joints).copy_from(&-(&self.whitening * &self.along));
        rows.columns_mut(joints, count).copy_from(&self.whitening);
        rows.transpose() * rows
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn with_the_joints_prior_it_is_the_joint_distribution() {
        let whole = DMatrix::from_row_slice(3, 3, &[4.0, 1.0, 0.5, 1.0, 3.0, 0.7, 0.5, 0.7, 2.0]);
        let joints = whole.view((0, 0), (2, 2)).into_owned();
        let cross = whole.view((2, 0), (1, 2)).into_owned();
        let own = whole.view((2, 2), (1, 1)).into_owned();
        let prior =
            EffectsPrior::new(0, DVector::from_element(1, 0.3), &own, &cross, (DVector::zeros(2), joints.clone()));
        let mut precision = prior.precision();
        let mut block = precision.view_mut((0, 0), (2, 2));
        block += joints.clone().try_inverse().unwrap();
        let wanted = whole.try_inverse().unwrap();
        assert!((precision - wanted).amax() < 1e-12);
        let known = prior.known(&DVector::from_row_slice(&[0.1, -0.2]), &[0.5], 7);
        let expected = 0.3 + (&cross * joints.try_inverse().unwrap() * DVector::from_row_slice(&[0.1, -0.2]))[0];
        let std = prior.precision()[(2, 2)].sqrt();
        assert!((known[0].residual - (0.5 - expected) * std).abs() < 1e-12);
        assert!(known[0].columns.iter().any(|(column, value)| *column == 7 && (value - std).abs() < 1e-12));
    }
}
