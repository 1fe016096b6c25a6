//! How sure a fit is of its numbers: Student's intervals, for the noise is estimated from the same data.

use crate::solve::Fit;
use statrs::distribution::{ContinuousCDF, StudentsT};

impl<E> Fit<E> {
    /// Measured values beyond the parameters that the data pay for; at least 1.
    pub fn degrees_of_freedom(&self) -> f64 {
        (self.values.iter().sum::<f64>() - self.parameters_used.iter().sum::<f64>()).max(1.0)
    }

    /// Standard deviation of a parameter, in its unit.
    pub fn deviation(&self, parameter: usize) -> f64 {
        self.covariance[(parameter, parameter)].max(0.0).sqrt()
    }

    /// Half the width of the interval that covers a parameter's true value with this probability, in its unit.
    ///
    /// `share` lies between 0 and 1. With 40 distances and 24 parameters the factor on the standard deviation is 2.12
    /// for 0.95, with a thousand values the familiar 1.96.
    pub fn half_interval(&self, parameter: usize, share: f64) -> f64 {
        let student = StudentsT::new(0.0, 1.0, self.degrees_of_freedom())
            .expect("degrees of freedom are positive and the scale is 1");
        student.inverse_cdf(0.5 + 0.5 * share) * self.deviation(parameter)
    }
}
