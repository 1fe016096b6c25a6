//! Multivariate population of robots: mean and covariance of all numbers of a robot, where each robot is measured in other
//! directions and to another accuracy.
//!
//! ```text
//! robot i:    θᵢ ~ N(μ, Σ / uᵢ),  uᵢ ~ χ²(ν)/ν      likelihood of its rows exp(-½ θᵢᵀ Λᵢ θᵢ + ηᵢᵀ θᵢ)
//! mean:       μ ~ N(0, D),  D the covariance of the nominal prior
//! ```
//! Σ is learned by expectation and maximisation (Dempster, Laird, Rubin 1977) with the mean integrated out, so that a few robots do
//! not give too small a spread. It is learned in two steps. First the accuracy of the series: the nominal covariance
//! with a factor for each kind of error (T). Then Σ = (N S + κ T) / (N + κ), where S is the estimate from the robots'
//! deviations alone: T counts as κ robots, and κ is chosen so that all other robots predict each robot best. The weights uᵢ
//! (Lange, Little, Taylor 1989) keep an outlying robot from inflating the spread of the series. They make the covariance of
//! normal robots too small by a known factor, which is corrected at the end (`consistency`): Σ is the covariance of
//! robots without an accident.

use denavit_model::nalgebra::{DMatrix, DVector};

/// Degrees of freedom of a robot's deviation: nearly normal, with heavy tails for robots that had an accident.
const TAILS: f64 = 8.0;
/// Candidate numbers of robots that the nominal pattern counts as; with the last, only the pattern counts.
const COUNTS_AS: [f64; 6] = [8.0, 16.0, 32.0, 64.0, 128.0, f64::INFINITY];
/// Maximum number of iterations, and the relative change at convergence.
const MOST_STEPS: usize = 60;
const SMALL_STEP: f64 = 1e-3;
/// Smallest variance of any direction, as a fraction of the nominal variance: robots are never identical.
const LEAST_SPREAD: f64 = 1e-6;
/// Fraction of the largest value that counts as rounding.
const ROUNDING: f64 = 1e-10;
/// Fewer robots do not determine a spread.
pub const LEAST_ROBOTS: usize = 3;

/// The information of a robot's rows: Λ and η.
#[derive(Debug, Clone, PartialEq)]
pub struct RobotInformation {
    /// Λ.
    pub information: DMatrix<f64>,
    /// η.
    pub pull: DVector<f64>,
}

/// A population.
#[derive(Debug, Clone, PartialEq)]
pub struct Hierarchy {
    /// Its mean.
    pub mean: DVector<f64>,
    /// Covariance of the estimated mean.
    pub mean_covariance: DMatrix<f64>,
    /// Covariance among robots without an accident.
    pub among: DMatrix<f64>,
    /// For each kind of error, its spread relative to the nominal one.
    pub factors: Vec<f64>,
    /// Number of robots that the nominal pattern counts as.
    pub counts_as: f64,
    /// Weight of each robot: about 1, near 0 for an outlier.
    pub weights: Vec<f64>,
    /// The scale matrices of Student's distribution for `among` and for the pattern.
    shape: DMatrix<f64>,
    pattern: DMatrix<f64>,
}

/// One round over the robots at a given covariance.
struct Round {
    mean: DVector<f64>,
    mean_covariance: DMatrix<f64>,
    /// Expected weighted square of each robot's deviation.
    squares: Vec<DMatrix<f64>>,
    weights: Vec<f64>,
    /// Average number of directions that the rows determine.
    informed: f64,
    /// Each robot's contribution to the information matrix and vector of the mean.
    of_mean: Vec<(DMatrix<f64>, DVector<f64>)>,
}

impl Round {
    fn square(&self) -> DMatrix<f64> {
        let size = self.mean.len();
        let sum = self.squares.iter().fold(DMatrix::zeros(size, size), |sum, square| sum + square);
        sum / self.squares.len() as f64
    }
}

impl Hierarchy {
    /// Learns it. `sources`: for each kind of error, the parameter changes by its nominal standard deviations, one per column.
    /// `None`: fewer than [`LEAST_ROBOTS`].
    pub fn of(robots: &[&RobotInformation], sources: &[DMatrix<f64>]) -> Option<Self> {
        if robots.len() < LEAST_ROBOTS {
            return None;
        }
        let size = robots[0].pull.len();
        let drawing = covariance(sources, &vec![1.0; sources.len()], size);
        let mut factors = vec![1.0; sources.len()];
        let mut weights = vec![1.0; robots.len()];
        for _ in 0..MOST_STEPS {
            let pattern = covariance(sources, &factors, size);
            let round = round(robots, &pattern, &drawing, &weights)?;
            let precision = inverse(&pattern)?;
            let pulled = &precision * round.square() * &precision;
            weights = round.weights;
            // Multiplicative steps: Zhou, Hu, Zhou, Lange 2019, J. Comput. Graph. Stat. 28, 350.
            let mut largest = 0.0_f64;
            for (factor, moved) in factors.iter_mut().zip(sources) {
                let trace = |matrix: &DMatrix<f64>| (moved.transpose() * matrix * moved).trace();
                let ratio = (trace(&pulled) / trace(&precision)).sqrt();
                let next = (*factor * ratio).max(LEAST_SPREAD);
                largest = largest.max((next / *factor - 1.0).abs());
                *factor = next;
            }
            if largest < SMALL_STEP {
                break;
            }
        }
        let pattern = covariance(sources, &factors, size);
        let found = round(robots, &pattern, &drawing, &weights)?;
        let share = consistency(found.informed);
        let start = Self {
            mean: DVector::zeros(size),
            mean_covariance: drawing.clone(),
            among: &pattern / share,
            factors: factors.iter().map(|factor| (factor / share).sqrt()).collect(),
            counts_as: f64::INFINITY,
            weights,
            shape: pattern.clone(),
            pattern,
        };
        let tried = COUNTS_AS.iter().filter_map(|&counts_as| {
            let found = Self { counts_as, ..start.clone() }.learned(robots, &drawing)?;
            Some((found.predicted(robots, &drawing)?, found))
        });
        tried.reduce(|best, next| if next.0 >= best.0 { next } else { best }).map(|(_, found)| found)
    }

    /// Continues learning from here without one of the robots; the nominal pattern and its count stay.
    pub fn leaving_out(&self, robots: &[&RobotInformation], left_out: usize, sources: &[DMatrix<f64>]) -> Option<Self> {
        if robots.len() <= LEAST_ROBOTS {
            return None;
        }
        let others: Vec<&RobotInformation> = all_but(robots, left_out).copied().collect();
        let weights = all_but(&self.weights, left_out).copied().collect();
        let drawing = covariance(sources, &vec![1.0; sources.len()], self.mean.len());
        Self { weights, ..self.clone() }.learned(&others, &drawing)
    }

    /// Predictive mean and covariance of another robot of the population.
    pub fn next(&self) -> (DVector<f64>, DMatrix<f64>) {
        (self.mean.clone(), &self.among + &self.mean_covariance)
    }

    /// Expectation and maximisation until convergence.
    fn learned(mut self, robots: &[&RobotInformation], drawing: &DMatrix<f64>) -> Option<Self> {
        let mut informed = 0.0;
        for _ in 0..MOST_STEPS {
            let round = round(robots, &self.shape, drawing, &self.weights)?;
            let next = self.together(&round.square(), robots.len());
            let change = (&next - &self.shape).norm() / self.shape.norm().max(f64::MIN_POSITIVE);
            (self.mean, self.mean_covariance, self.weights) = (round.mean, round.mean_covariance, round.weights);
            (self.shape, informed) = (next, round.informed);
            if change < SMALL_STEP {
                break;
            }
        }
        self.among = &self.shape / consistency(informed);
        Some(self)
    }

    /// The estimate from the robots, and the pattern as this many additional robots.
    fn together(&self, square: &DMatrix<f64>, robots: usize) -> DMatrix<f64> {
        if self.counts_as.is_infinite() {
            return self.pattern.clone();
        }
        (square * robots as f64 + &self.pattern * self.counts_as) / (robots as f64 + self.counts_as)
    }

    /// Summed log probability of each robot's rows given all others: for each, one step without the robot.
    fn predicted(&self, robots: &[&RobotInformation], drawing: &DMatrix<f64>) -> Option<f64> {
        let round = round(robots, &self.shape, drawing, &self.weights)?;
        let total = round.square() * robots.len() as f64;
        let of_drawing = inverse(drawing)?;
        let (precision, pull) = round
            .of_mean
            .iter()
            .fold((of_drawing, DVector::zeros(self.mean.len())), |(precision, pull), (own, pulled)| {
                (precision + own, pull + pulled)
            });
        let mut sum = 0.0;
        for (robot, measured) in robots.iter().enumerate() {
            let others = robots.len() - 1;
            let among = self.together(&((&total - &round.squares[robot]) / others as f64), others);
            let mean_covariance = inverse(&(&precision - &round.of_mean[robot].0))?;
            let mean = &mean_covariance * (&pull - &round.of_mean[robot].1);
            sum += log_probability(measured, &mean, &(among + mean_covariance))?;
        }
        Some(sum)
    }
}

fn all_but<T>(list: &[T], left_out: usize) -> impl Iterator<Item = &T> {
    list.iter().enumerate().filter(move |(index, _)| *index != left_out).map(|(_, item)| item)
}

fn covariance(sources: &[DMatrix<f64>], factors: &[f64], size: usize) -> DMatrix<f64> {
    let parts = sources.iter().zip(factors).map(|(moved, factor)| moved * moved.transpose() * *factor);
    parts.fold(DMatrix::zeros(size, size), |sum, part| sum + part)
}

fn inverse(matrix: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    matrix.clone().cholesky().map(|factor| factor.inverse())
}

/// The mean at this covariance, and each robot's deviation from it.
fn round(robots: &[&RobotInformation], among: &DMatrix<f64>, drawing: &DMatrix<f64>, weights: &[f64]) -> Option<Round> {
    let size = among.nrows();
    let precision = inverse(among)?;
    let (mut of_all, mut pull) = (inverse(drawing)?, DVector::zeros(size));
    let mut own = Vec::with_capacity(robots.len());
    let mut of_mean = Vec::with_capacity(robots.len());
    let mut informed = 0.0;
    for (measured, weight) in robots.iter().zip(weights) {
        let precision = &precision * *weight;
        let covariance = inverse(&(&measured.information + &precision))?;
        let along = &covariance * &precision;
        informed += (size as f64 - along.trace()) / robots.len() as f64;
        let adds = (&precision - &precision * &along, along.tr_mul(&measured.pull));
        of_all += &adds.0;
        pull += &adds.1;
        own.push(covariance);
        of_mean.push(adds);
    }
    let mean_covariance = inverse(&of_all)?;
    let mean = &mean_covariance * pull;
    let mut round = Round { mean, mean_covariance, squares: Vec::new(), weights: Vec::new(), informed, of_mean };
    for ((measured, weight), covariance) in robots.iter().zip(weights).zip(own) {
        let off = &covariance * (&measured.pull - &measured.information * &round.mean);
        let by_mean = &covariance * &measured.information;
        let square = &covariance + &off * off.transpose() + &by_mean * &round.mean_covariance * by_mean.transpose();
        let deviation = (&precision * &square).trace();
        round.weights.push((TAILS + size as f64) / (TAILS + deviation));
        round.squares.push(square * *weight);
    }
    Some(round)
}

/// Scale of Student's distribution as a fraction of the covariance of normal robots, if the rows of each determine k
/// directions: c with c = E[(ν + k) / (ν + χ²ₖ / c) · χ²ₖ / k], so that 1 = (ν + k) E[1 / (νc + χ²ₖ₊₂)].
///
/// It is the constant that makes this M-estimator of scatter consistent at the normal distribution (Lopuhaä 1989, Ann. Stat. 17,
/// 1662). E[1 / (a + χ²ₘ)] = ∫ e^(-at) (1 + 2t)^(-m/2) dt, by Simpson's rule.
fn consistency(informed: f64) -> f64 {
    const STEPS: u32 = 1000;
    let weight = |share: f64| {
        let (a, half) = (TAILS * share, informed / 2.0 + 1.0);
        // The integrand falls at least as fast as e^(-at); beyond 40 / a it is nothing.
        let width = 40.0 / (a * f64::from(STEPS));
        let integrand = |step: u32| {
            let t = f64::from(step) * width;
            let counts = if step == 0 || step == STEPS { 1.0 } else { f64::from(2 + 2 * (step % 2)) };
            counts * (-a * t - half * (2.0 * t).ln_1p()).exp()
        };
        (TAILS + informed) * width / 3.0 * (0..=STEPS).map(integrand).sum::<f64>()
    };
    let (mut low, mut high) = (0.5, 1.0);
    while high - low > 1e-9 {
        let middle = f64::midpoint(low, high);
        // The smaller the share, the larger the weight.
        if weight(middle) > 1.0 { low = middle } else { high = middle }
    }
    f64::midpoint(low, high)
}

/// Log probability of a robot's rows for this mean and covariance, up to a common constant, with the tails of a robot's
/// deviation.
fn log_probability(measured: &RobotInformation, mean: &DVector<f64>, covariance: &DMatrix<f64>) -> Option<f64> {
    let eigen = measured.information.clone().symmetric_eigen();
    let least = eigen.eigenvalues.max() * ROUNDING;
    let kept: Vec<usize> = (0..eigen.eigenvalues.len()).filter(|&k| eigen.eigenvalues[k] > least).collect();
    let roots = DVector::from_fn(kept.len(), |k, _| eigen.eigenvalues[kept[k]].sqrt());
    let directions = eigen.eigenvectors.select_columns(&kept);
    // The rows as independent numbers of standard deviation 1.
    let read = directions.tr_mul(&(&measured.pull - &measured.information * mean)).component_div(&roots);
    let mut spread = directions.transpose() * covariance * &directions;
    for i in 0..kept.len() {
        for k in 0..kept.len() {
            spread[(i, k)] = spread[(i, k)] * roots[i] * roots[k] + f64::from(u8::from(i == k));
        }
    }
    let factor = spread.cholesky()?;
    let square = read.dot(&factor.solve(&read));
    let log_determinant: f64 = factor.l_dirty().diagonal().iter().map(|value| 2.0 * value.ln()).sum();
    Some(-0.5 * log_determinant - 0.5 * (TAILS + kept.len() as f64) * (1.0 + square / TAILS).ln())
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt as _, SeedableRng as _};
    use rand_distr::StandardNormal;

    const SIZE: usize = 4;

    /// A number in the first place, 0 elsewhere.
    fn first(value: f64) -> DVector<f64> {
        DVector::from_fn(SIZE, |k, _| if k == 0 { value } else { 0.0 })
    }

    /// Robots with this covariance about a mean of 3, 0, 0, 0; each is measured in directions of its own.
    fn robots(seed: u64, count: usize, root: &DMatrix<f64>) -> (Vec<DVector<f64>>, Vec<RobotInformation>) {
        measured_by(seed, count, root, 6, 2.0)
    }

    /// The same, measured by this many rows, each with sensitivity `gain` in units of its noise.
    fn measured_by(
        seed: u64,
        count: usize,
        root: &DMatrix<f64>,
        rows: usize,
        gain: f64,
    ) -> (Vec<DVector<f64>>, Vec<RobotInformation>) {
        let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(seed);
        let mut normal = |rows: usize, columns: usize| {
            DMatrix::from_fn(rows, columns, |_, _| random.sample::<f64, _>(StandardNormal))
        };
        let one = |_: usize| {
            let truth = root * normal(SIZE, 1).column(0) + first(3.0);
            let design = normal(rows, SIZE) * gain;
            let read = &design * &truth + normal(rows, 1).column(0);
            (truth, RobotInformation { information: design.tr_mul(&design), pull: design.tr_mul(&read) })
        };
        (0..count).map(one).unzip()
    }

    fn sources() -> Vec<DMatrix<f64>> {
        vec![
            DMatrix::identity(SIZE, SIZE).columns(0, 2).into_owned(),
            DMatrix::identity(SIZE, SIZE).columns(2, 2).into_owned(),
        ]
    }

    #[test]
    fn mean_and_covariance_of_many_robots_are_found() {
        let root = DMatrix::from_row_slice(
            SIZE,
            SIZE,
            &[
                1.0, 0.0, 0.0, 0.0, //
                0.9, 0.3, 0.0, 0.0, //
                0.0, 0.0, 0.2, 0.0, //
                0.0, 0.0, 0.0, 0.2,
            ],
        );
        let (_, measured) = robots(3, 2000, &root);
        let found = Hierarchy::of(&measured.iter().collect::<Vec<_>>(), &sources()).unwrap();
        let truth = &root * root.transpose();
        assert!((&found.among - &truth).norm() < 0.06 * truth.norm(), "{} {truth}", found.among);
        assert!((&found.mean - first(3.0)).norm() < 0.1, "{}", found.mean);
        assert!(found.counts_as < 100.0 && found.factors[0] > 3.0 * found.factors[1], "{found:?}");
    }

    /// If rows determine a direction no better than robots differ in it, the iteration ends some per cent before convergence.
    #[test]
    fn the_spread_of_normal_robots_is_neither_too_small_nor_too_large() {
        const RUNS: u32 = 2;
        // As in the nominal pattern, equal within a kind of error: the pattern counts as some of the robots.
        let root = DMatrix::from_diagonal(&DVector::from_vec(vec![1.0, 1.0, 0.3, 0.3]));
        for (rows, gain) in [(8, 50.0), (6, 4.0)] {
            let mut ratios = [0.0; SIZE];
            for seed in 0..RUNS {
                let (_, measured) = measured_by(100 + u64::from(seed), 1000, &root, rows, gain);
                let found = Hierarchy::of(&measured.iter().collect::<Vec<_>>(), &sources()).unwrap();
                for (k, ratio) in ratios.iter_mut().enumerate() {
                    *ratio += (found.among[(k, k)].sqrt() / root[(k, k)] - 1.0) / f64::from(RUNS);
                }
            }
            println!("{rows} rows, gain {gain}: spread too large by {ratios:.4?}");
            assert!(ratios.iter().all(|ratio| ratio.abs() < 0.03), "{rows} rows, gain {gain}: {ratios:?}");
        }
    }

    #[test]
    fn what_student_takes_is_that_of_a_large_sample() {
        use rand_distr::{ChiSquared, Distribution as _};
        let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(1);
        for informed in [1.0, 2.5, 4.0, 9.0, 24.0] {
            let law = ChiSquared::new(informed).unwrap();
            let squares: Vec<f64> = (0..100_000).map(|_| law.sample(&mut random)).collect();
            let mut share = 1.0;
            for _ in 0..40 {
                let of = |square: &f64| (TAILS + informed) / (TAILS + square / share) * square / informed;
                share = squares.iter().map(of).sum::<f64>() / squares.len() as f64;
            }
            let found = consistency(informed);
            println!("{informed} directions: {found:.4}, large sample {share:.4}");
            assert!((found / share - 1.0).abs() < 0.005, "{informed}: {found} {share}");
        }
    }

    #[test]
    fn a_robot_is_better_known_with_its_siblings_and_one_that_is_off_spoils_nobody() {
        let root = DMatrix::identity(SIZE, SIZE) * 0.3;
        let (mut alone, mut together, mut beside, mut weight) = (0.0, 0.0, 0.0, 0.0_f64);
        for seed in 0..20 {
            let (truth, mut measured) = robots(seed, 12, &root);
            let error = |measured: &[RobotInformation]| {
                let all: Vec<&RobotInformation> = measured.iter().collect();
                let found = Hierarchy::of(&all, &sources()).unwrap();
                let of = |robot: usize| {
                    let (mean, covariance) = found.leaving_out(&all, robot, &sources()).unwrap().next();
                    let precision = inverse(&covariance).unwrap();
                    let known = inverse(&(&measured[robot].information + &precision)).unwrap();
                    (known * (&measured[robot].pull + precision * mean) - &truth[robot]).norm_squared()
                };
                ((0..11).map(of).sum::<f64>(), found.weights[11])
            };
            let own = |robot: usize| {
                (inverse(&measured[robot].information).unwrap() * &measured[robot].pull - &truth[robot]).norm_squared()
            };
            alone += (0..11).map(own).sum::<f64>();
            together += error(&measured).0;
            let knocked = DVector::from_element(SIZE, 10.0);
            let knock = &measured[11].information * knocked;
            measured[11].pull += knock;
            let (square, counted) = error(&measured);
            beside += square;
            weight = weight.max(counted);
        }
        assert!(together < 0.75 * alone, "{together} {alone}");
        assert!(beside < 0.9 * alone && weight < 0.1, "{beside} {alone} {weight}");
    }

    #[test]
    fn directions_that_nobody_measures_stay_as_drawn() {
        let measured: Vec<RobotInformation> = (0..5)
            .map(|robot| RobotInformation {
                information: DMatrix::from_fn(SIZE, SIZE, |i, k| if i == 0 && k == 0 { 1e6 } else { 0.0 }),
                pull: first(1e6 * (1.0 + 0.01 * f64::from(robot))),
            })
            .collect();
        let found = Hierarchy::of(&measured.iter().collect::<Vec<_>>(), &sources()).unwrap();
        let (mean, covariance) = found.next();
        assert!((mean[0] - 1.02).abs() < 0.02 && mean[3].abs() < 1e-9, "{mean}");
        assert!((1.0..3.0).contains(&covariance[(3, 3)]) && covariance[(0, 0)] < covariance[(3, 3)], "{covariance}");
        assert!(Hierarchy::of(&measured[..2].iter().collect::<Vec<_>>(), &sources()).is_none());
    }
}
