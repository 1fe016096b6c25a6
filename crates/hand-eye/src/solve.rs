//! From pairs to both placements: start, fit, outliers, and what is determined.

use crate::closed_form::{METHODS, left_of, quarter_turns};
use crate::fit::{Fitted, covariance, fit, in_parent, median, residual, spread, square, weights};
use crate::motion::unknown;
use crate::{Arrangement, Pair, Row, Unknown};
use denavit_model::nalgebra::{Matrix6, Vector6};
use denavit_model::{Pose, se3};
use statrs::distribution::{ChiSquared, ContinuousCDF};
use thiserror::Error;

/// Smallest number of poses.
pub const FEWEST: usize = 3;
/// Triples of rows that are tried for a start.
const TRIPLES: usize = 300;
/// One set of good rows in this many loses a row.
const FALSE_REJECTIONS: f64 = 1e-3;
/// The standard deviation of a normal variable over the median of its length in three dimensions.
const OF_MEDIAN: f64 = 1.538_172;
/// Rounds of rejecting.
const MOST_ROUNDS: usize = 10;
/// Parts that are held out in turn.
const FOLDS: usize = 20;

/// Why there is no result.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum HandEyeError {
    /// Too few rows.
    #[error("{0} poses; hand-eye calibration needs at least {FEWEST}, and ten or more for reliable errors")]
    TooFew(usize),
    /// The poses do not belong together.
    #[error(
        "the motions of robot and instrument do not agree: they differ by {0:.1}° and {1:.1} % of the size (median); check \
         the arrangement (on the hand or beside the robot), the order of the rows, the units and the angles"
    )]
    Apart(f64, f64),
    /// Not a number.
    #[error("row {0}: a pose is not finite")]
    NotFinite(usize),
}

/// One of the two unknowns.
#[derive(Debug, Clone, PartialEq)]
pub struct Placed {
    /// Name, such as `base_from_instrument`.
    pub name: &'static str,
    /// m.
    pub pose: Pose,
    /// Position (m), then rotation (rad), in the frame that the pose is given in.
    pub covariance: Matrix6<f64>,
}

impl Placed {
    /// Standard deviations: x, y, z in m, turns about x, y, z in rad.
    pub fn std(&self) -> [f64; 6] {
        std::array::from_fn(|index| self.covariance[(index, index)].max(0.0).sqrt())
    }
}

/// The residual of a row.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Residual {
    /// Measured less predicted in the instrument's frame: position (m), rotation vector (rad).
    pub value: Vector6<f64>,
    /// Whether it was left out as a gross outlier.
    pub rejected: bool,
}

/// Root mean squares over rows.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Errors {
    /// Of the distance, m.
    pub position_rms: f64,
    /// Of the angle, rad.
    pub orientation_rms: f64,
}

/// A closed form beside the result.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ClosedForm {
    /// Who published it, and when.
    pub name: &'static str,
    /// How far its placement at the base and that at the tip are from the result, m and rad; `None` where the rows do not determine it.
    pub apart: Option<[(f64, f64); 2]>,
}

/// The result.
#[derive(Debug, Clone, PartialEq)]
pub struct HandEye {
    /// Which of the two is on the hand.
    pub arrangement: Arrangement,
    /// What is fixed to the base.
    pub base: Placed,
    /// What is fixed to the tip.
    pub tip: Placed,
    /// Standard deviation of one component of position, m, and of orientation, rad.
    pub noise: [f64; 2],
    /// Of all rows, in order.
    pub residuals: Vec<Residual>,
    /// Of the rows that were fitted.
    pub fitted: Errors,
    /// Of rows while they were not fitted; absent where too few rows are left for it.
    pub held_out: Option<Errors>,
    /// What the poses do not determine.
    pub unknown: Option<Unknown>,
    /// Closed forms on the rows that were fitted.
    pub closed_forms: Vec<ClosedForm>,
    /// Whether the fit converged.
    pub converged: bool,
}

/// Both placements from pairs of poses.
///
/// # Shape and units
/// Three rows or more; m. Noise of position and of orientation are estimated.
///
/// # Errors
/// Too few rows, a number that is not finite, or rows that do not belong together.
pub fn solve(pairs: &[Pair], arrangement: Arrangement) -> Result<HandEye, HandEyeError> {
    if pairs.len() < FEWEST {
        return Err(HandEyeError::TooFew(pairs.len()));
    }
    let finite = |pose: &Pose| pose.to_homogeneous().iter().all(|number| number.is_finite());
    if let Some(at) = pairs.iter().position(|pair| !finite(&pair.robot) || !finite(&pair.seen)) {
        return Err(HandEyeError::NotFinite(at + 1));
    }
    let rows = arrangement.rows(pairs);
    let size = size(&rows);
    let start = start(&rows, size);
    belong(&start, &rows, size)?;
    let (fitted, kept) = without_outliers(start, &rows, size);
    let of_rows =
        |keep: &[bool]| -> Vec<Row> { rows.iter().zip(keep).filter(|(_, keep)| **keep).map(|(row, _)| *row).collect() };
    let used = of_rows(&kept);
    let covariance = covariance(&fitted.normal, size);
    let own: [Matrix6<f64>; 2] = [0, 6].map(|at| covariance.fixed_view::<6, 6>(at, at).into_owned());
    let placed = [0, 1].map(|side| (fitted.placed[side], in_parent(&fitted.placed[side], &own[side])));
    let [base, tip] = arrangement.sorted(placed);
    let [base_name, tip_name] = arrangement.names();
    let named = |name, (pose, covariance)| Placed { name, pose, covariance };
    let pairs_used: Vec<Pair> = pairs.iter().zip(&kept).filter(|(_, keep)| **keep).map(|(pair, _)| *pair).collect();
    let closed_forms = METHODS.iter().map(|method| {
        let apart = (method.solve)(&used).map(|found| {
            arrangement.sorted([0, 1].map(|side| {
                let (turned, moved) = se3::difference(&found[side], &fitted.placed[side]);
                (moved, turned)
            }))
        });
        ClosedForm { name: method.name, apart }
    });
    Ok(HandEye {
        arrangement,
        base: named(base_name, base),
        tip: named(tip_name, tip),
        noise: fitted.noise,
        residuals: rows
            .iter()
            .zip(&kept)
            .map(|(row, keep)| Residual { value: residual(&fitted.placed, row), rejected: !keep })
            .collect(),
        fitted: errors(used.iter().map(|row| residual(&fitted.placed, row))),
        held_out: held_out(&fitted, &used, size),
        unknown: unknown(&pairs_used, &fitted.normal, size),
        closed_forms: closed_forms.collect(),
        converged: fitted.converged,
    })
}

/// How far the robot and what it sees are spread; 1 m where nothing moves.
fn size(rows: &[Row]) -> f64 {
    let robot = spread(rows.iter().map(|row| row.moved.translation.vector));
    let seen = spread(rows.iter().map(|row| row.seen.translation.vector));
    let size = robot.max(seen);
    if size > 0.0 { size } else { 1.0 }
}

/// A row's distance from a placement, with a turn of one radian as long as the size.
fn apart(placed: &[Pose; 2], row: &Row, size: f64) -> f64 {
    square(&residual(placed, row), [size.powi(-2), 1.0]).sqrt()
}

/// Rows that are this close to a closed form, in units of the size and in rad, have determined it.
const DETERMINED: f64 = 0.2;

/// The start that most rows agree with: closed forms on all rows and on triples; of rows that determine none, quarter turns.
fn start(rows: &[Row], size: f64) -> [Pose; 2] {
    let mut best = Best { rows, size, middle: f64::INFINITY, placed: [Pose::identity(), Pose::identity()] };
    METHODS.iter().filter_map(|method| (method.solve)(rows)).for_each(|found| best.take(found));
    let n = rows.len();
    for triple in 0..TRIPLES.min(n * n * n) {
        // Steps of primes: every run tries the same triples.
        let chosen = [7919, 104_729, 1_299_709].map(|prime: usize| triple.wrapping_mul(prime) / 16 % n);
        if chosen[0] == chosen[1] || chosen[1] == chosen[2] || chosen[0] == chosen[2] {
            continue;
        }
        if let Some(found) = (METHODS[0].solve)(&chosen.map(|index| rows[index])) {
            best.take(found);
        }
    }
    if best.middle > DETERMINED {
        for turn in quarter_turns() {
            let right = se3::pose(turn, [0.0; 3].into());
            if let Some(left) = left_of(rows, &right) {
                best.take(fit([left, right], rows, size).placed);
            }
        }
    }
    best.placed
}

/// Placements that the middle row agrees with best.
struct Best<'a> {
    rows: &'a [Row],
    size: f64,
    middle: f64,
    placed: [Pose; 2],
}

impl Best<'_> {
    fn take(&mut self, placed: [Pose; 2]) {
        let middle = median(self.rows.iter().map(|row| apart(&placed, row, self.size)).collect());
        if middle < self.middle {
            (self.middle, self.placed) = (middle, placed);
        }
    }
}

/// Rows that agree worse than this are not from one robot and one instrument, in units of the size and in rad.
const APART: f64 = 0.5;

fn belong(start: &[Pose; 2], rows: &[Row], size: f64) -> Result<(), HandEyeError> {
    let residuals: Vec<Vector6<f64>> = rows.iter().map(|row| residual(start, row)).collect();
    let middle = |at: usize| median(residuals.iter().map(|residual| residual.fixed_rows::<3>(at).norm()).collect());
    let (place, turn) = (middle(0) / size, middle(3));
    if place > APART || turn > APART { Err(HandEyeError::Apart(turn.to_degrees(), 100.0 * place)) } else { Ok(()) }
}

/// Fits, leaves out rows far beyond the noise, lets rows back in, until nothing changes.
fn without_outliers(start: [Pose; 2], rows: &[Row], size: f64) -> (Fitted, Vec<bool>) {
    let limit = ChiSquared::new(6.0)
        .map(|law| law.inverse_cdf(1.0 - FALSE_REJECTIONS / rows.len() as f64))
        .expect("six degrees of freedom are a law");
    let all: Vec<Vector6<f64>> = rows.iter().map(|row| residual(&start, row)).collect();
    let robust = [0, 3].map(|at| {
        let middle = median(all.iter().map(|residual| residual.fixed_rows::<3>(at).norm()).collect());
        middle / OF_MEDIAN
    });
    let within = |placed: &[Pose; 2], noise: [f64; 2], slack: f64| -> Vec<bool> {
        let weights = weights(noise, size);
        rows.iter().map(|row| square(&residual(placed, row), weights) <= slack * limit).collect()
    };
    // A start from three rows is coarse.
    let mut kept = within(&start, robust, 9.0);
    let mut placed = start;
    for _ in 0..MOST_ROUNDS {
        let used: Vec<Row> = rows.iter().zip(&kept).filter(|(_, keep)| **keep).map(|(row, _)| *row).collect();
        if used.len() < FEWEST {
            kept = vec![true; rows.len()];
            break;
        }
        let found = fit(placed, &used, size);
        placed = found.placed;
        let next = within(&placed, found.noise, 1.0);
        if next == kept || next.iter().filter(|keep| **keep).count() < FEWEST {
            return (found, kept);
        }
        kept = next;
    }
    let used: Vec<Row> = rows.iter().zip(&kept).filter(|(_, keep)| **keep).map(|(row, _)| *row).collect();
    (fit(placed, &used, size), kept)
}

fn errors(residuals: impl Iterator<Item = Vector6<f64>>) -> Errors {
    let (mut place, mut turn, mut count) = (0.0, 0.0, 0.0);
    for residual in residuals {
        place += residual.fixed_rows::<3>(0).norm_squared();
        turn += residual.fixed_rows::<3>(3).norm_squared();
        count += 1.0;
    }
    let rms = |sum: f64| (sum / f64::max(count, 1.0)).sqrt();
    Errors { position_rms: rms(place), orientation_rms: rms(turn) }
}

/// Each part of the rows predicted by a fit of the others.
fn held_out(fitted: &Fitted, rows: &[Row], size: f64) -> Option<Errors> {
    let folds = FOLDS.min(rows.len());
    if rows.len() < 2 * FEWEST {
        return None;
    }
    let mut left = Vec::with_capacity(rows.len());
    for fold in 0..folds {
        let others: Vec<Row> =
            rows.iter().enumerate().filter(|(index, _)| index % folds != fold).map(|(_, row)| *row).collect();
        let found = fit(fitted.placed, &others, size);
        left.extend(rows.iter().skip(fold).step_by(folds).map(|row| residual(&found.placed, row)));
    }
    Some(errors(left.into_iter()))
}
