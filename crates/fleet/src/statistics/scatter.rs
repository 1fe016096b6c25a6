//! Scatter of a robot's number from night to night, learned from the whole fleet, including its tails.

use super::median;
use statrs::distribution::{ContinuousCDF as _, StudentsT};

/// Median of |x| of a normal distribution with standard deviation 1.
const MEDIAN_OF_NORMAL: f64 = 0.674_489_75;
/// Minimum degrees of freedom: heavier tails would hide everything.
const LEAST_FREEDOM: f64 = 3.0;
/// Maximum degrees of freedom, practically a normal distribution.
const MOST_FREEDOM: f64 = 1e4;

/// The scatter of one number from night to night.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scatter {
    /// Scale of Student's distribution, in the number's unit.
    pub scale: f64,
    /// Its degrees of freedom: few if tails are heavy or data are few.
    pub freedom: f64,
}

impl Scatter {
    /// Learned from deviations of quiet nights from the mean of the nights before, scaled to the spread of one night.
    ///
    /// The scale comes from the median, which is robust against a few sick robots; the tails are matched at the 90th
    /// percentile, so that sick robots can only make them heavier and the watch more conservative. `None`: fewer than eight
    /// deviations, or no scatter at all.
    pub fn of(deviations: &[f64]) -> Option<Self> {
        let count = deviations.len();
        if count < 8 {
            return None;
        }
        let mut sizes: Vec<f64> = deviations.iter().map(|deviation| deviation.abs()).collect();
        let middle = median(&mut sizes);
        // Half the values alike: a number that is not measured, but given.
        if middle <= 0.0 {
            return None;
        }
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a place in the list")]
        let beyond = sizes[(0.9 * count as f64) as usize] / middle;
        // What a robust scale of so few numbers is worth: the median has 37 % of the efficiency of the mean square.
        let known = 0.37 * count as f64;
        let mut freedom = LEAST_FREEDOM;
        while freedom < MOST_FREEDOM && ratio(freedom) > beyond {
            freedom *= 1.1;
        }
        let freedom = freedom.min(known).clamp(LEAST_FREEDOM, MOST_FREEDOM);
        Some(Self { scale: middle / quantile(freedom, 0.75), freedom })
    }

    /// Probability of a deviation at least as large, of either sign; `spread`: ratio of the scatter of the difference
    /// to that of one night.
    pub fn p_value(&self, deviation: f64, spread: f64) -> f64 {
        let size = deviation.abs() / (self.scale * spread);
        (2.0 * student(self.freedom).sf(size)).clamp(f64::MIN_POSITIVE, 1.0)
    }
}

fn student(freedom: f64) -> StudentsT {
    StudentsT::new(0.0, 1.0, freedom).expect("a positive number of degrees of freedom")
}

fn quantile(freedom: f64, share: f64) -> f64 {
    if freedom >= MOST_FREEDOM && share == 0.75 { MEDIAN_OF_NORMAL } else { student(freedom).inverse_cdf(share) }
}

/// By how much the 90th percentile of |t| exceeds its median.
fn ratio(freedom: f64) -> f64 {
    quantile(freedom, 0.95) / quantile(freedom, 0.75)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt as _, SeedableRng as _};
    use rand_distr::{StandardNormal, StudentT};

    #[test]
    fn scale_and_tails_come_back() {
        let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(1);
        let normal: Vec<f64> = (0..40_000).map(|_| 3.0 * random.sample::<f64, _>(StandardNormal)).collect();
        let found = Scatter::of(&normal).expect("many");
        assert!((found.scale / 3.0 - 1.0).abs() < 0.03 && found.freedom > 20.0, "{found:?}");
        let tails = StudentT::new(4.0).expect("4 is positive");
        let heavy: Vec<f64> = (0..40_000).map(|_| 3.0 * random.sample(tails)).collect();
        let found = Scatter::of(&heavy).expect("many");
        assert!((found.scale / 3.0 - 1.0).abs() < 0.05 && (3.0..6.0).contains(&found.freedom), "{found:?}");
        assert!(Scatter::of(&[0.0; 100]).is_none() && Scatter::of(&[1.0; 7]).is_none());
    }

    #[test]
    fn one_sick_robot_in_a_hundred_does_not_move_the_scale() {
        let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(2);
        let mut all: Vec<f64> = (0..9900).map(|_| random.sample(StandardNormal)).collect();
        all.extend([100.0; 100]);
        let found = Scatter::of(&all).expect("many");
        assert!((found.scale - 1.0).abs() < 0.15, "{found:?}");
    }
}
