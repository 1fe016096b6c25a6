//! Mean and spread of a number over the population, shrinkage estimates of each robot's number, and outliers.

use statrs::distribution::{ContinuousCDF as _, StudentsT};

/// With more robots one cannot mask itself: only suspected outliers are then compared with the others alone.
const MANY: usize = 200;
/// Deviation of a suspected outlier, in standard deviations.
const STANDS_OUT: f64 = 2.5;
/// Minimum number of robots of a population.
pub const LEAST_ROBOTS: usize = 6;

/// A robot's number from its own data, without a prior.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measured {
    /// The number.
    pub value: f64,
    /// Its standard deviation.
    pub std: f64,
}

impl Measured {
    /// The number without the prior that was fitted with it: N(0, std² / held), where `held` is the prior's share of the spread.
    /// `None`: the data say less than the prior.
    pub fn without_prior(value: f64, std: f64, held: f64) -> Option<Self> {
        let free = 1.0 - held;
        (free >= 0.5 && std > 0.0).then(|| Self { value: value / free, std: std / free.sqrt() })
    }
}

/// The population of a number.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Population {
    /// Its mean.
    pub mean: f64,
    /// Standard deviation of the mean.
    pub mean_std: f64,
    /// Standard deviation among robots, without measurement noise.
    pub spread: f64,
}

impl Population {
    /// Mean and spread by the method of Paule and Mandel: the spread at which the weighted squares are as many as there are
    /// degrees of freedom; 0 if the measurement noise explains the scatter. `None` for fewer than two.
    ///
    /// # Reference
    /// R. C. Paule, J. Mandel, "Consensus values and weighting factors", J. Res. NBS 87 (1982), 377-385.
    pub fn of(robots: &[Measured]) -> Option<Self> {
        if robots.len() < 2 {
            return None;
        }
        let freedom = robots.len() as f64 - 1.0;
        let at = |variance: f64| {
            let weight = |robot: &Measured| 1.0 / (robot.std.powi(2) + variance);
            let total: f64 = robots.iter().map(weight).sum();
            let mean = robots.iter().map(|robot| weight(robot) * robot.value).sum::<f64>() / total;
            let squares: f64 = robots.iter().map(|robot| weight(robot) * (robot.value - mean).powi(2)).sum();
            (mean, total, squares)
        };
        let variance = if at(0.0).2 > freedom {
            let plain = robots.iter().map(|robot| robot.value).sum::<f64>() / robots.len() as f64;
            // The plain sum of squares is more than any spread among robots.
            let squares: f64 = robots.iter().map(|robot| (robot.value - plain).powi(2)).sum();
            let (mut low, mut high) = (0.0, squares);
            for _ in 0..60 {
                let middle = f64::midpoint(low, high);
                if at(middle).2 > freedom { low = middle } else { high = middle }
            }
            f64::midpoint(low, high)
        } else {
            0.0
        };
        let (mean, total, _) = at(variance);
        Some(Self { mean, mean_std: (1.0 / total).sqrt(), spread: variance.sqrt() })
    }

    /// A robot's number given its siblings: the empirical Bayes estimate and its standard deviation.
    pub fn shrunk(&self, robot: Measured) -> Measured {
        let (own, among) = (robot.std.powi(2), self.spread.powi(2) + self.mean_std.powi(2));
        let share = among / (own + among);
        Measured { value: self.mean + share * (robot.value - self.mean), std: (share * own).sqrt() }
    }
}

/// An outlier in a number.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Outlier {
    /// Which robot, by place.
    pub robot: usize,
    /// Deviation from its siblings, in standard deviations of a sibling with the same measurement accuracy.
    pub sigmas: f64,
    /// Probability of such a deviation by chance, for this robot and number alone.
    pub p_value: f64,
    /// Its number minus the siblings' mean.
    pub off: f64,
}

/// Deviation of each robot from its siblings: the population is that of the others, so that no robot masks itself.
/// Empty for fewer than [`LEAST_ROBOTS`].
pub fn off_siblings(robots: &[Measured]) -> Vec<Outlier> {
    if robots.len() < LEAST_ROBOTS {
        return Vec::new();
    }
    let student = StudentsT::new(0.0, 1.0, robots.len() as f64 - 2.0).expect("some robots");
    let all = Population::of(robots);
    let of = |index: usize| {
        if let Some(all) = all.filter(|_| robots.len() > MANY) {
            let found = held_against(&all, robots, index, &student);
            if found.sigmas.abs() < STANDS_OUT {
                return Some(found);
            }
        }
        let others: Vec<Measured> =
            robots.iter().enumerate().filter(|(other, _)| *other != index).map(|(_, robot)| *robot).collect();
        Some(held_against(&Population::of(&others)?, robots, index, &student))
    };
    (0..robots.len()).filter_map(of).collect()
}

fn held_against(siblings: &Population, robots: &[Measured], index: usize, student: &StudentsT) -> Outlier {
    let robot = robots[index];
    let spread = (siblings.spread.powi(2) + siblings.mean_std.powi(2) + robot.std.powi(2)).sqrt();
    let off = robot.value - siblings.mean;
    let sigmas = off / spread;
    Outlier { robot: index, sigmas, p_value: 2.0 * student.sf(sigmas.abs()), off }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt as _, SeedableRng as _};
    use rand_distr::StandardNormal;

    fn robots(seed: u64, count: usize, spread: f64) -> (Vec<f64>, Vec<Measured>) {
        let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(seed);
        let mut normal = || random.sample::<f64, _>(StandardNormal);
        let truth: Vec<f64> = (0..count).map(|_| 5.0 + spread * normal()).collect();
        let measured = truth.iter().enumerate().map(|(index, truth)| {
            let std = if index % 2 == 0 { 0.5 } else { 1.5 };
            Measured { value: truth + std * normal(), std }
        });
        (truth.clone(), measured.collect())
    }

    /// Weights and consensus of two laboratories can be written down: with equal deviations the spread is the variance of the
    /// values less that of the measurement.
    #[test]
    fn paule_and_mandel_in_a_case_that_can_be_written_down() {
        let found =
            Population::of(&[Measured { value: 1.0, std: 0.5 }, Measured { value: 4.0, std: 0.5 }]).expect("two");
        assert!((found.mean - 2.5).abs() < 1e-12 && (found.spread.powi(2) - (4.5 - 0.25)).abs() < 1e-9, "{found:?}");
        let none =
            Population::of(&[Measured { value: 1.0, std: 5.0 }, Measured { value: 2.0, std: 5.0 }]).expect("two");
        assert_eq!(none.spread, 0.0);
    }

    #[test]
    fn siblings_make_a_robot_better_known() {
        let (mut alone, mut together) = (0.0, 0.0);
        for seed in 0..50 {
            let (truth, measured) = robots(seed, 40, 0.7);
            let population = Population::of(&measured).expect("forty");
            for (truth, robot) in truth.iter().zip(&measured) {
                alone += (robot.value - truth).powi(2);
                together += (population.shrunk(*robot).value - truth).powi(2);
            }
        }
        // With mean and spread known it would be 0.23 of alone.
        assert!(together < 0.37 * alone, "{together} {alone}");
    }

    #[test]
    fn off_by_chance_is_as_rare_as_it_says_and_one_that_is_off_is_named() {
        let rare: usize = (0..200)
            .map(|seed| off_siblings(&robots(seed, 40, 0.7).1).iter().filter(|o| o.p_value < 0.01).count())
            .sum();
        assert!((40..=130).contains(&rare), "{rare} of 8000 where 80 are expected");
        let mut measured = robots(1, 40, 0.7).1;
        measured[16].value += 8.0;
        let worst = off_siblings(&measured).into_iter().max_by(|a, b| a.sigmas.abs().total_cmp(&b.sigmas.abs()));
        assert!(worst.is_some_and(|worst| worst.robot == 16 && worst.sigmas > 4.0), "{worst:?}");
        assert!(off_siblings(&measured[..5]).is_empty());
    }
}
