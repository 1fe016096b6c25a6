//! Uncertainty of a fit's numbers, and the prior's part in it.
//!
//! Intervals are Student's, since the noise is estimated from the same data.

use crate::gauge;
use crate::solve::{Fit, missing_degrees};
use denavit_model::nalgebra::DVector;
use statrs::distribution::{ContinuousCDF, StudentsT};

/// Residuals below this fraction of the robot's size (and rad) count as zero: a micrometre on a metre.
const EXACT: f64 = 1e-6;
/// A condition smaller than this fraction of the largest is rounding.
const SAYS_NOTHING: f64 = 1e-9;

impl<E> Fit<E> {
    /// Measured values minus parameters that the data determine, plus those that were [assumed](Self::assumed_degrees).
    pub fn degrees_of_freedom(&self) -> f64 {
        let left = self.values.iter().sum::<f64>() - self.parameters_used.iter().sum::<f64>();
        (left + self.assumed_degrees()).max(1.0)
    }

    /// Degrees of freedom of the noise that the data lack: an assumed noise replaces them (see
    /// [`crate::solve::ASSUMED_NOISE`]). 0 with enough data.
    pub fn assumed_degrees(&self) -> f64 {
        self.values.iter().zip(&self.parameters_used).map(|(count, used)| missing_degrees(*count, *used)).sum()
    }

    /// Whether the numbers are a result: the last step was too small to matter, or the residuals of one kind of value are so small
    /// that its weight blocks steps for the others (data without noise).
    pub fn converged_or_exact(&self) -> bool {
        let least = EXACT * self.arm.nominal.size();
        self.converged || self.noise.levels.iter().any(|level| *level <= least)
    }

    /// Standard deviation of a parameter, in its unit.
    pub fn deviation(&self, parameter: usize) -> f64 {
        self.covariance[(parameter, parameter)].max(0.0).sqrt()
    }

    /// Half width of the interval that covers a parameter's true value with this probability, in its unit.
    ///
    /// `share` lies between 0 and 1. With 40 distances and 24 parameters the factor on the standard deviation is 2.12
    /// for 0.95, with a thousand values the familiar 1.96.
    pub fn half_interval(&self, parameter: usize, share: f64) -> f64 {
        let student = StudentsT::new(0.0, 1.0, self.degrees_of_freedom())
            .expect("degrees of freedom are positive and the scale is 1");
        student.inverse_cdf(0.5 + 0.5 * share) * self.deviation(parameter)
    }

    /// Fraction of a joint parameter's uncertainty due to the prior: 1 without information in the data, 0 where they determine it.
    ///
    /// Ratio of the standard deviation to the prior's, with the common frame held in both.
    pub fn held_by_prior(&self, parameter: usize) -> f64 {
        let count = self.layout.joints.len();
        let spread = self.prior_spread();
        if parameter >= count || spread[parameter] == 0.0 {
            return 0.0;
        }
        (self.covariance[(parameter, parameter)] / spread[parameter]).sqrt().min(1.0)
    }

    /// Variances of the joints' parameters by the prior alone, the common frame held.
    fn prior_spread(&self) -> Vec<f64> {
        let count = self.layout.joints.len();
        let covariance = self.layout.prior.covariance(&self.layout.parameters[self.layout.joints.clone()]);
        let mut conditions = gauge::conditions(&self.layout, &self.arm).rows(0, count).into_owned();
        if conditions.ncols() == 0 {
            return (0..count).map(|k| covariance[(k, k)]).collect();
        }
        // Each condition scaled to size 1. Along a SCARA's parallel axes one is empty, and is left out.
        let size = DVector::from_fn(conditions.ncols(), |k, _| {
            conditions.column(k).dot(&(&covariance * conditions.column(k))).sqrt()
        });
        for (k, mut column) in conditions.column_iter_mut().enumerate() {
            column.scale_mut(if size[k] > SAYS_NOTHING * size.max() { size[k].recip() } else { 0.0 });
        }
        let along = &covariance * &conditions;
        let inverse = (conditions.transpose() * &along).pseudo_inverse(SAYS_NOTHING);
        let held = &along * inverse.expect("the threshold is not negative") * along.transpose();
        (0..count).map(|k| covariance[(k, k)] - held[(k, k)]).collect()
    }
}
