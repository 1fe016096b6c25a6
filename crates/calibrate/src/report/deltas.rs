//! Nominal, actual and delta with standard deviations: the changes to a controller's table.

use crate::calibration::{AdoptedFit, Calibration};
use denavit_dh::convert::HAYATI_BELOW;
use denavit_dh::matching::{MatchError, VendorTable, Verdict, match_table};
use denavit_dh::nearest::Parallels;
use denavit_dh::{Convention, NearParallel, Options, Parallelism, Table, convert};
use denavit_export::deltas::{Delta, deltas};
use denavit_identify::arm::Arm;
use denavit_identify::solve::Fit;
use denavit_model::nalgebra::{DMatrix, DVector};
use denavit_model::{Chain, ChainError};
use thiserror::Error;

/// Why there are no deltas.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum DeltasError {
    /// The nominal table is another robot's.
    #[error(
        "the nominal table differs from the robot as drawn by up to {miss:.1} mm; name the table to which the controller adds its numbers"
    )]
    OtherRobot {
        /// mm.
        miss: f64,
    },
    /// The joints differ.
    #[error("the nominal table: {0}")]
    Match(#[from] MatchError),
    /// The chain has no table.
    #[error(transparent)]
    Chain(#[from] ChainError),
}

/// A nominal table, its convention, and what its parallel axes get.
#[derive(Debug, Clone, PartialEq)]
pub struct Nominal {
    /// As the maker prints it; the drawing's own where there is none.
    pub table: Option<(Table, Convention)>,
    /// Hayati's numbers, or the four of controllers without beta.
    pub parallels: Parallels,
}

/// The step of a difference quotient, in standard deviations.
const STEP: f64 = 0.01;

/// A parameter that is known exactly is stepped by this, rad or m.
const LEAST_STEP: f64 = 1e-9;

/// The numbers of the calibrated arm to a tip beside the nominal ones, with standard deviations from the covariance of the
/// adopted geometry.
///
/// # Errors
/// The nominal table is another arm's.
pub fn of(result: &Calibration, tip: usize, nominal: &Nominal) -> Result<Vec<Delta>, DeltasError> {
    match result.fit() {
        AdoptedFit::Geometry(fit) => of_fit(fit, tip, nominal),
        AdoptedFit::Named(fit) => of_fit(fit, tip, nominal),
        AdoptedFit::Averaged(fit) => of_fit(fit, tip, nominal),
    }
}

/// The same of one fit.
///
/// # Errors
/// As [`of`].
pub fn of_fit<E>(fit: &Fit<E>, tip: usize, nominal: &Nominal) -> Result<Vec<Delta>, DeltasError> {
    let drawn = fit.arm.nominal_to(tip);
    let (table, convention, placement) = match &nominal.table {
        None => {
            let options = Options {
                parallelism: Parallelism::Exact,
                near_parallel: NearParallel::HayatiBelow(HAYATI_BELOW),
                ..Options::default()
            };
            (convert::table(&drawn, &options)?.value, Convention::Distal, None)
        }
        Some((table, convention)) => {
            let found = match_table(&drawn, &VendorTable::of(table, *convention, false))?;
            if found.verdict == Verdict::Mismatch {
                return Err(DeltasError::OtherRobot { miss: 1e3 * found.placement.position_error });
            }
            (table.clone(), *convention, Some(found.placement))
        }
    };
    let in_its_frames =
        |chain: Chain| placement.as_ref().map_or(Ok(chain.clone()), |lies| lies.in_frames_of_the_table(&chain));
    let numbers = |arm: &Arm| deltas(&in_its_frames(arm.chain_to(tip))?, &table, convention, nominal.parallels);
    let mut found = numbers(&fit.arm)?;
    let joints: Vec<usize> = fit.layout.joints.clone().collect();
    let mut slopes = DMatrix::zeros(found.len(), joints.len());
    for (column, parameter) in joints.iter().enumerate() {
        let size = (STEP * fit.deviation(*parameter)).max(LEAST_STEP);
        let mut step = vec![0.0; fit.layout.len()];
        let mut at = |size: f64| {
            step[*parameter] = size;
            numbers(&fit.layout.stepped(&fit.arm, &step))
        };
        let (up, down) = (at(size)?, at(-size)?);
        // A row may be of another kind exactly at the drawing, where parallel axes have no beta.
        if up.len() == found.len() && down.len() == found.len() {
            let slope = up.iter().zip(&down).map(|(up, down)| (up.actual - down.actual) / (2.0 * size));
            slopes.set_column(column, &DVector::from_iterator(found.len(), slope));
        }
    }
    let covariance = DMatrix::from_fn(joints.len(), joints.len(), |i, k| fit.covariance[(joints[i], joints[k])]);
    let spread = &slopes * covariance * slopes.transpose();
    for (index, delta) in found.iter_mut().enumerate() {
        delta.std = (!joints.is_empty()).then(|| spread[(index, index)].max(0.0).sqrt());
    }
    Ok(found)
}
