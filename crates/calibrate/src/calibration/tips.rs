//! Several tips of one robot: what their calibration supports, and the error of each.

use super::{CalibrateError, CalibrateOptions};
use crate::calibration::contract::TipEntry;
use denavit_identify::effects::driver::Statics;
use denavit_identify::residual_statistics::{Errors, Residual, errors};
use denavit_measurements::Measurements;
use denavit_model::{Chain, Tip};

/// Refuses what cannot be done with several tips.
pub(super) fn check(train: &Measurements, statics: &Statics, options: &CalibrateOptions) -> Result<(), CalibrateError> {
    let Some(tips) = train.scene.tips() else { return Ok(()) };
    if (options.trace.is_some() || options.curves.is_some()) && statics.tips != *tips {
        return Err(CalibrateError::StaticsOfOtherTips(train.source.clone()));
    }
    let unseen = (0..tips.all().len()).find(|&tip| rows(train, tip) == 0);
    unseen.map_or(Ok(()), |tip| {
        Err(CalibrateError::NoRowsOfTip { file: train.source.clone(), tip: tips[tip].name.clone() })
    })
}

fn rows(data: &Measurements, tip: usize) -> usize {
    (0..data.len()).filter(|&row| data.tip_of(row) == tip && !data.of_row(row).is_empty()).count()
}

/// The tips and the error of each at a stage; empty for a single tip. `left`: the residuals of the fitted rows that were
/// kept.
pub(super) fn entries(
    chain: &Chain,
    (train, left): (&Measurements, impl FnOnce() -> Vec<Residual>),
    test: Option<(&Measurements, &[Residual])>,
) -> Vec<TipEntry> {
    let Some(tips) = train.scene.tips() else { return Vec::new() };
    let left = left();
    let off = |data: &Measurements, residuals: &[Residual], tip: usize| -> Errors {
        errors(residuals.iter().filter(|residual| data.tip_of(residual.row) == tip), &data.scene)
    };
    let entry = |(index, tip): (usize, &Tip)| TipEntry {
        tip: tip.name.clone(),
        joints: chain
            .joints()
            .iter()
            .zip(&tip.joints)
            .filter(|(_, on_the_way)| **on_the_way)
            .map(|(joint, _)| joint.name.clone())
            .collect(),
        fitted: rows(train, index),
        held_out: test.map_or(0, |(test, _)| rows(test, index)),
        train: off(train, &left, index),
        test: test.map(|(test, left)| off(test, left, index)),
    };
    tips.all().iter().enumerate().map(entry).collect()
}
