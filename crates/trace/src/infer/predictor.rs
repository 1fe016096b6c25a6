//! Effects that are included for the prediction although they are not named: the best set among models without unexplained structure,
//! as such structure predicts nothing.

use crate::infer::contest::{Contest, Marginal, Seen, Setting, best_of};
use crate::infer::gram::Gram;
use denavit_linear::threads::{get_or_make, in_parallel};
use std::sync::OnceLock;

/// The best set for the prediction, and all sets seen.
pub(super) struct Predictor<'a> {
    contest: &'a Contest<'a>,
    settings: Vec<&'a Setting>,
    grounds: Vec<Marginal>,
    /// Of the run.
    parts: &'a [Gram],
    pub(super) set: Vec<usize>,
    pub(super) seen: Seen,
    /// The set's squared residual in each part.
    left: OnceLock<Option<Vec<f64>>>,
}

impl<'a> Predictor<'a> {
    /// The best set found from these starts, at their best settings without structure.
    pub(super) fn new(
        contest: &'a Contest<'a>,
        settings: &'a [(Marginal, Setting)],
        starts: &[Vec<usize>],
        parts: &'a [Gram],
    ) -> Self {
        let predict: Vec<&(Marginal, Setting)> =
            settings.iter().filter(|(_, setting)| setting.unnamed.is_none()).collect();
        let suits = in_parallel(starts, |set| contest.best(predict.iter().map(|(ground, _)| ground), set).1);
        let suit = predict.iter().enumerate().filter(|(place, _)| suits.contains(place));
        let (grounds, settings): (Vec<Marginal>, Vec<&Setting>) =
            suit.map(|(_, (ground, setting))| (ground.clone(), setting)).unzip();
        let seen = contest.climbed(&grounds, starts);
        Self { contest, settings, grounds, parts, set: best_of(&seen), seen, left: OnceLock::new() }
    }

    /// Whether a member of the set improves the prediction of left-out rows by more than chance; parts of the run are left out one after
    /// the other.
    pub(super) fn pays(&self, member: usize) -> bool {
        let without: Vec<usize> = self.set.iter().copied().filter(|&other| other != member).collect();
        let (Some(with), Some(without)) = (self.own(), self.held_out(&without)) else { return false };
        beyond_chance(&without.iter().zip(with).map(|(without, with)| without - with).collect::<Vec<f64>>())
    }

    /// Whether the set predicts left-out rows as well, up to chance, as another set at its setting with unexplained structure: such
    /// structure is then not needed.
    pub(super) fn does_as_well_as(&self, other: &[usize], setting: &Setting) -> bool {
        let (Some(own), Some(other)) = (self.own(), self.held_out_at(other, setting)) else { return false };
        !beyond_chance(&own.iter().zip(other).map(|(own, other)| own - other).collect::<Vec<f64>>())
    }

    /// The squared residual of its own set in each part.
    fn own(&self) -> Option<&Vec<f64>> {
        get_or_make(&self.left, || self.held_out(&self.set)).as_ref()
    }

    /// Squared residuals of each part, in units of the noise, under the set with curves fitted to the other parts.
    fn held_out(&self, set: &[usize]) -> Option<Vec<f64>> {
        self.held_out_at(set, self.settings.get(self.contest.best(&self.grounds, set).1)?)
    }

    fn held_out_at(&self, set: &[usize], setting: &Setting) -> Option<Vec<f64>> {
        let numbers: Vec<usize> = (0..self.parts.len()).collect();
        let left = in_parallel(&numbers, |&part| {
            let others = Gram::of_others(self.parts, part);
            let ground = self.contest.ground(&others, setting)?;
            let (columns, system) = self.contest.system(&others, (&ground, setting), set);
            let mut mean = vec![0.0; others.size];
            for (column, number) in columns.into_iter().zip(system.solved()?.mean()) {
                mean[column] = number;
            }
            Some(self.parts[part].misfit(&mean))
        });
        left.into_iter().collect()
    }
}

/// Whether the mean of these is above 0 by more than its standard error.
fn beyond_chance(falls: &[f64]) -> bool {
    let count = falls.len() as f64;
    let mean = falls.iter().sum::<f64>() / count;
    let variance = falls.iter().map(|fall| (fall - mean).powi(2)).sum::<f64>() / (count - 1.0);
    falls.len() > 1 && mean > (variance / count).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::infer::contest::Member;
    use crate::infer::gram::Columns;
    use denavit_model::nalgebra::DMatrix;

    /// Two columns of geometry and two candidates, of which the first acts.
    #[test]
    fn what_acts_pays_and_what_does_not_does_not() {
        const VALUES: usize = 200;
        let cell = |value: usize, k: usize| ((value * value * (k + 3)) as f64 * 0.737).sin();
        let plain: Vec<Vec<f64>> = (0..4).map(|k| (0..VALUES).map(|value| cell(value, k)).collect()).collect();
        let explained: Vec<f64> =
            (0..VALUES).map(|value| plain[1][value] + 0.5 * plain[2][value] + cell(value, 40)).collect();
        let rows: Vec<usize> = (0..VALUES).collect();
        let of_part = |part: usize| {
            let own = part * VALUES / 5..(part + 1) * VALUES / 5;
            let cut: Vec<&[f64]> = plain.iter().map(|column| &column[own.clone()]).collect();
            let (explained, rows) = (&explained[own.clone()], &rows[own.clone()]);
            Gram::of(&Columns { explained, plain: &cut, joints: &[], rows, weights: &[1.0; VALUES / 5] }, &[], &[])
        };
        let parts: Vec<Gram> = (0..5).map(of_part).collect();
        let members: Vec<Member> =
            (2..4).map(|k| Member { columns: k..k + 1, log_odds: -2.0, least_precision: 0.0 }).collect();
        let precision = DMatrix::from_diagonal_element(4, 4, 0.01);
        let contest = Contest::of_plain(2, &precision, &[0.0; 4], &members);
        let whole = Gram::weighted(&parts, &[1.0; 5]);
        let (_, settings) = contest.run(&whole, &[]);
        let predictor = Predictor::new(&contest, &settings, &[Vec::new()], &parts);
        assert_eq!(predictor.set, [0]);
        let setting = &settings[0].1;
        assert!(predictor.does_as_well_as(&[0, 1], setting));
        let nothing = Predictor { set: Vec::new(), ..Predictor::new(&contest, &settings, &[Vec::new()], &parts) };
        assert!(!nothing.does_as_well_as(&[0], setting) && nothing.does_as_well_as(&[1], setting));
        let mut predictor = Predictor::new(&contest, &settings, &[Vec::new()], &parts);
        predictor.set = vec![0, 1];
        assert!(predictor.pays(0) && !predictor.pays(1));
    }

    #[test]
    fn a_fall_counts_beyond_its_standard_error() {
        assert!(beyond_chance(&[1.0, 2.0, 1.5, 0.5]) && !beyond_chance(&[1.0, -2.0, 1.5, 0.5]) && !beyond_chance(&[]));
    }
}
