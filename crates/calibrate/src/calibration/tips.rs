//! Several tips of one robot: what a calibration of them can do, and how well each came out.

use super::{CalibrateError, CalibrateOptions, StageResiduals};
use crate::calibration::contract::TipEntry;
use crate::identify::residual_statistics::{Errors, Residual, errors};
use crate::observation::measurements::Measurements;
use denavit_model::{Chain, Tip};

/// Refuses what cannot be done with several tips.
pub(super) fn check(train: &Measurements, options: &CalibrateOptions) -> Result<(), CalibrateError> {
    let Some(tips) = train.scene.tips() else { return Ok(()) };
    if options.trace.is_some() || options.curves.is_some() {
        return Err(CalibrateError::EffectsOfSeveralTips(train.source.clone()));
    }
    let unseen = (0..tips.all().len()).find(|&tip| rows(train, tip) == 0);
    unseen.map_or(Ok(()), |tip| {
        Err(CalibrateError::NoRowsOfTip { file: train.source.clone(), tip: tips[tip].name.clone() })
    })
}

fn rows(data: &Measurements, tip: usize) -> usize {
    (0..data.len()).filter(|&row| data.tip_of(row) == tip && !data.of_row(row).is_empty()).count()
}

/// The tips and how far each is off at a stage; none where there is one alone.
pub(super) fn entries(
    chain: &Chain,
    (train, test): (&Measurements, Option<&Measurements>),
    stage: &StageResiduals,
) -> Vec<TipEntry> {
    let off = |data: &Measurements, residuals: &[Residual], tip: usize| -> Errors {
        let own = residuals.iter().filter(|residual| data.tip_of(residual.row) == tip);
        errors(&own.copied().collect::<Vec<_>>(), &data.scene)
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
        held_out: test.map_or(0, |test| rows(test, index)),
        train: off(train, &stage.train, index),
        test: test.map(|test| off(test, &stage.test, index)),
    };
    train.scene.tips().map_or_else(Vec::new, |tips| tips.all().iter().enumerate().map(entry).collect())
}
