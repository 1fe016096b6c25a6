//! What is still open after a run: the sets of causes that the data leave possible, and what each predicts of rows to come.
//!
//! Each hypothesis is a set of causes beside geometry, frames and curves, with the posterior that the measured rows gave it. A
//! row to come has columns x of the same kinds; under a hypothesis with A m = b ([`System`]) it is expected at xᵀ m with the
//! variance s (1 + xᵀ A⁻¹ x), s the variance of the noise.
//! Structure without a name has no columns beyond the measured rows, so it has no part in what is predicted.

use crate::effects::catalogue::{Candidate, Kind};
use crate::effects::curve::Waves;
use crate::effects::driver::Driver;
use crate::effects::model::{EffectModel, Term};
use crate::effects::survey::Survey;
use crate::identify::gram::cross_gram;
use crate::identify::solve::Fit;
use crate::identify::threads::{available, dealt};
use crate::identify::triangle::dot;
use crate::observation::arm::Arm;
use crate::observation::measurements::Measurements;
use crate::trace::infer::curves::{Laid, Round, State};
use crate::trace::infer::evidence::{Solved, System};
use crate::trace::infer::model::{Hyperparameters, Kernel};

/// A cause: what an engineer would call the same.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Cause {
    /// The kind.
    pub kind: Kind,
    /// Where.
    pub place: String,
}

/// One set of causes that may act.
#[derive(Debug, Clone)]
pub struct Hypothesis {
    /// The causes; none: nothing but geometry, frames and curves.
    pub causes: Vec<Cause>,
    /// Their terms.
    pub terms: Vec<Term>,
    /// Its share of the posterior mass of all hypotheses of the list.
    pub probability: f64,
    /// Logarithm of that share before it is rounded to 0.
    pub log_probability: f64,
    /// Which of the columns of [`Lines`] it has.
    columns: Vec<usize>,
    solved: Solved,
}

/// Hypotheses about one run.
#[derive(Debug, Clone)]
pub struct Hypotheses {
    /// The most probable first. One: nothing is open.
    pub list: Vec<Hypothesis>,
    /// The model at which all was linearised.
    fit: Fit<EffectModel>,
    reference: Arm,
    joints: Vec<usize>,
    waves: Vec<Waves>,
    /// Terms whose columns any of them has; `None`: the effects of the fit.
    candidates: Option<Vec<Candidate>>,
    /// Variance of the noise in units of that of the fit.
    noise: f64,
}

/// Columns of the model for rows to come, value by value.
#[derive(Debug, Clone)]
pub struct Lines {
    /// All columns of a value, value by value.
    cells: Vec<f64>,
    width: usize,
    /// The values of each row.
    pub rows: Vec<std::ops::Range<usize>>,
    /// What a value is multiplied by to be a length in m; 0 where it is none.
    pub metres: Vec<f64>,
}

/// What a hypothesis predicts of some values, each relative to the same present state and in units of the noise.
#[derive(Debug, Clone)]
pub struct Predicted {
    /// Expected values.
    pub expected: Vec<f64>,
    /// A vector for each value: their products are the covariances of the predictions.
    features: Vec<f64>,
    size: usize,
}

impl Predicted {
    fn feature(&self, value: usize) -> &[f64] {
        &self.features[value * self.size..(value + 1) * self.size]
    }

    /// Covariance of the predictions of two values.
    pub fn covariance(&self, a: usize, b: usize) -> f64 {
        dot(self.feature(a), self.feature(b))
    }

    /// Covariances of these values with these others, row by row of the former.
    pub fn covariances(&self, values: std::ops::Range<usize>, others: std::ops::Range<usize>) -> Vec<f64> {
        let of = |range: std::ops::Range<usize>| &self.features[range.start * self.size..range.end * self.size];
        // The products come column by column of what is named second.
        cross_gram(of(others), of(values), self.size)
    }
}

/// A hypothesis as the contest has it: the causes, the logarithm of its mass, its columns among those of the contest, its model.
pub(super) struct Contestant {
    pub(super) terms: Vec<Candidate>,
    pub(super) causes: Vec<Cause>,
    pub(super) log_mass: f64,
    pub(super) columns: Vec<usize>,
    pub(super) system: System,
}

impl Hypotheses {
    /// Hypotheses of a contest in which `candidates` took part, whose columns came after the first `always`; `None` where one
    /// of them has no solution.
    pub(super) fn of_contest(
        state: &State,
        reference: &Arm,
        candidates: (&[Candidate], &[std::ops::Range<usize>]),
        round: &Round,
        contestants: Vec<Contestant>,
    ) -> Option<Self> {
        let (candidates, ranges) = candidates;
        let used: Vec<usize> = (0..candidates.len())
            .filter(|&k| contestants.iter().any(|one| one.columns.contains(&ranges[k].start)) && !ranges[k].is_empty())
            .collect();
        // Columns of the contest that rows to come have, too: geometry and frames, what any hypothesis names, all curves.
        let own = (0..round.always).chain(used.iter().flat_map(|&k| ranges[k].clone()));
        let own: Vec<usize> = own.chain(round.gram.plain..round.gram.size).collect();
        let place = |column: &usize| own.iter().position(|other| other == column);
        let top = contestants.iter().map(|one| one.log_mass).fold(f64::NEG_INFINITY, f64::max);
        let sum = contestants.iter().map(|one| (one.log_mass - top).exp()).sum::<f64>().ln() + top;
        let mut noise = f64::INFINITY;
        let mut list = Vec::new();
        for Contestant { terms, causes, log_mass, columns, system } in contestants {
            let (square, count) = (system.square, system.count);
            let solved = system.solved()?;
            noise = noise.min((square - solved.explained()) / count);
            list.push(Hypothesis {
                causes,
                terms: terms.into_iter().map(|candidate| candidate.term).collect(),
                probability: (log_mass - sum).exp(),
                log_probability: log_mass - sum,
                columns: columns.iter().map(place).collect::<Option<_>>()?,
                solved,
            });
        }
        let candidates = Some(used.into_iter().map(|k| candidates[k].clone()).collect());
        let (fit, joints, waves) = (state.fit.clone(), state.joints.clone(), state.waves.clone());
        let found = Self { list, fit, reference: reference.clone(), joints, waves, candidates, noise };
        (noise > 0.0 && noise.is_finite()).then_some(found)
    }

    /// The one hypothesis that a fit with its effects and curves is; `None` where it has no solution.
    ///
    /// # Shape and units
    /// `data` as fitted; `reference` as in [`crate::identify::solve::fit`].
    pub fn of_fit(survey: &Survey, data: &Measurements, fit: &Fit<EffectModel>, reference: &Arm) -> Option<Self> {
        let mut state = State::new(survey, data, fit);
        let kernel = |joint: usize| fit.effects.curves.iter().find(|curve| curve.joint == joint).map(Kernel::of);
        let kernels: Vec<Option<Kernel>> = state.joints.iter().map(|&joint| kernel(joint)).collect();
        state.keep(&kernels.iter().map(Option::is_some).collect::<Vec<bool>>());
        // How many waves a curve may have hangs on how many other numbers there were when it was fitted.
        for (waves, joint) in state.waves.iter_mut().zip(&state.joints) {
            let own = fit.effects.curves.iter().find(|curve| curve.joint == *joint);
            waves.clone_from(&own.expect("joints without a curve were left out").waves);
        }
        let round = Round::beside(data, &state, reference, None, &[], 1);
        let hyper = Hyperparameters { log_noise: 0.0, kernels: kernels.into_iter().flatten().collect() };
        let (system, _) = round.model().system(&hyper);
        let hypothesis = Hypothesis {
            causes: Vec::new(),
            terms: fit.effects.effects.iter().map(|effect| effect.term.clone()).collect(),
            probability: 1.0,
            log_probability: 0.0,
            columns: (0..system.right.len()).collect(),
            solved: system.solved()?,
        };
        let State { fit, joints, waves, .. } = state;
        let (list, reference) = (vec![hypothesis], reference.clone());
        Some(Self { list, fit, reference, joints, waves, candidates: None, noise: 1.0 })
    }

    /// The arm as fitted.
    pub fn arm(&self) -> &Arm {
        &self.fit.arm
    }

    /// Variance of the noise in units of which [`Lines`] are.
    pub fn noise(&self) -> f64 {
        self.noise
    }

    /// Whether there is more than one.
    pub fn open(&self) -> bool {
        self.list.len() > 1
    }

    /// The joints whose side of approach a hypothesis follows, the most probable first, each with the name of the column and
    /// whether the order of the rows tells it.
    pub fn approached(&self) -> Vec<(usize, String, bool)> {
        let mut joints: Vec<(usize, String, bool)> = Vec::new();
        for term in self.list.iter().flat_map(|hypothesis| &hypothesis.terms) {
            if let Driver::Approach { joint, from_rows, side } = &term.driver
                && !joints.iter().any(|(known, ..)| known == joint)
            {
                joints.push((*joint, side.name().to_owned(), *from_rows));
            }
        }
        joints
    }

    /// Columns of rows to come, which have the scene and the recorded columns of the run.
    pub fn lines(&self, data: &Measurements) -> Lines {
        let mut fit = self.fit.clone();
        fit.weights = vec![1.0; data.observations()];
        let laid = Laid::of(data, &fit, &self.joints, &self.reference, self.candidates.as_deref(), &[]);
        let width = laid.plain.len() + self.waves.iter().map(Waves::len).sum::<usize>();
        let values = laid.linear.values();
        let mut cells = vec![0.0; width * values];
        let chain = &fit.effects.statics.chain;
        for (value, line) in cells.chunks_exact_mut(width.max(1)).enumerate() {
            let (plain, mut rest) = line.split_at_mut(laid.plain.len());
            for (cell, column) in plain.iter_mut().zip(&laid.plain) {
                *cell = column[value];
            }
            let reading = data.reading(laid.linear.rows[value]);
            for ((joint, waves), column) in self.joints.iter().zip(&self.waves).zip(&laid.joints) {
                let (own, others) = rest.split_at_mut(waves.len());
                rest = others;
                waves.values_into(chain.joints()[*joint].value(reading), own);
                own.iter_mut().for_each(|cell| *cell *= column[value]);
            }
        }
        let (mut rows, mut metres) = (Vec::with_capacity(data.len()), Vec::with_capacity(values));
        for row in 0..data.len() {
            let from = metres.len();
            for observation in data.of_row(row) {
                let series = data.series_of(observation);
                for (part, channel) in [Some(series.kind.place()), series.kind.turn()].into_iter().zip(series.channels) {
                    let Some(part) = part else { continue };
                    let level = channel.map_or(1.0, |channel| fit.noise.levels[channel]);
                    metres.extend(std::iter::repeat_n(if part.unit == "m" { level } else { 0.0 }, part.height));
                }
            }
            rows.push(from..metres.len());
        }
        Lines { cells, width, rows, metres }
    }

    /// What one of them predicts of rows to come.
    pub fn predicted(&self, hypothesis: usize, lines: &Lines) -> Predicted {
        let Hypothesis { columns, solved, .. } = &self.list[hypothesis];
        let each = lines.cells.chunks_exact(lines.width.max(1));
        let features = dealt(each, available(), || vec![0.0; columns.len()], |own, line| {
            for (cell, &column) in own.iter_mut().zip(columns) {
                *cell = line[column];
            }
            solved.feature(own)
        });
        let expected = features.iter().map(|feature| solved.expected(feature)).collect();
        Predicted { expected, size: columns.len(), features: features.into_iter().flatten().collect() }
    }
}
