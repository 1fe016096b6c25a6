//! The sets of causes that remain possible after a run, and what each predicts for future rows.
//!
//! Each hypothesis is a set of causes with geometry, frames and curves, and its posterior given the measured rows. A future row has
//! columns x of the same kinds; under a hypothesis with A m = b (`System`) its expected value is xᵀ m with the variance
//! s (1 + xᵀ A⁻¹ x), s the variance of the noise.
//! Unexplained structure has no columns beyond the measured rows, so it takes no part in predictions.

use crate::infer::contest::Setting;
use crate::infer::curves::{Laid, Round, State};
use crate::infer::evidence::Solved;
use crate::infer::members::members;
use crate::infer::model::Kernel;
use denavit_identify::arm::Arm;
use denavit_identify::effects::candidates::Candidate;
use denavit_identify::effects::carrier::Carrier;
use denavit_identify::effects::catalogue::Kind;
use denavit_identify::effects::curve::Waves;
use denavit_identify::effects::driver::Driver;
use denavit_identify::effects::history::History;
use denavit_identify::effects::model::{EffectModel, Term};
use denavit_identify::effects::survey::Survey;
use denavit_identify::solve::Fit;
use denavit_linear::products::cross_gram;
use denavit_linear::threads::{available, par_map};
use denavit_linear::triangle::dot;
use denavit_measurements::Measurements;
use denavit_model::Chain;
use serde::Serialize;

/// Largest number of waves of a curve that extends beyond the measured rows: shorter waves are left out.
const MOST_WAVES: usize = 80;
/// The fastest wave, periods per turn; curves of gears hold very little beyond it.
const FASTEST: f64 = 60.0;
/// Largest number of causes for which an error curve of their joint is considered as an alternative.
const MOST_CHALLENGED: usize = 3;
/// Length scale of a curve that replaces a cause which does not follow its joint's own reading, rad or m.
const SOME_LENGTH: f64 = 1.0;

/// A cause: what an engineer would call the same.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Cause {
    /// The kind.
    pub kind: Kind,
    /// Where.
    pub place: String,
}

/// One set of causes that may act.
#[derive(Debug, Clone)]
pub struct Hypothesis {
    /// The causes; empty: only geometry, frames and curves.
    pub causes: Vec<Cause>,
    /// Joints with an error curve: the best one for the set, or one instead of a cause, which the measured rows do not support but rows
    /// elsewhere may.
    pub curves: Vec<usize>,
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

/// A set of causes that remains possible, with its best curves.
#[derive(Debug, Clone)]
pub(crate) struct OpenSet {
    pub(crate) terms: Vec<Candidate>,
    pub(crate) causes: Vec<Cause>,
    pub(crate) log_mass: f64,
    pub(crate) curves: Vec<(usize, Kernel)>,
}

/// The possible sets of causes of a run, with everything needed for their predictions.
#[derive(Debug, Clone)]
pub struct Open {
    /// The rows of the comparison.
    data: Measurements,
    survey: Survey,
    fit: Fit<EffectModel>,
    reference: Arm,
    /// The most probable first.
    sets: Vec<OpenSet>,
}

/// A joint whose side of approach matters for the possible causes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Approached {
    /// The joint.
    pub joint: usize,
    /// The columns that record it: the side, or the joint's windup towards it.
    pub columns: Vec<String>,
    /// Whether all of them follow from the order of the rows.
    pub by_order: bool,
}

/// Hypotheses about one run, and their predictions for future rows.
#[derive(Debug, Clone)]
pub struct Hypotheses {
    /// The most probable first. One: no cause is uncertain.
    pub list: Vec<Hypothesis>,
    /// The future rows.
    pub lines: Lines,
    /// Variance of the noise in units of which they are.
    pub noise: f64,
}

/// Columns of the model for future rows, value by value.
#[derive(Debug, Clone)]
pub struct Lines {
    /// All columns of a value, value by value.
    cells: Vec<f64>,
    width: usize,
    /// For each joint with a curve: the change of each value per unit of it.
    joints: Vec<Vec<f64>>,
    /// The values of each row.
    pub rows: Vec<std::ops::Range<usize>>,
    /// Factor from a value to a length in m; 0 if it is not a length.
    pub metres: Vec<f64>,
}

/// A hypothesis's prediction of some values, each relative to the same present state and in units of the noise.
#[derive(Debug, Clone)]
pub struct Predicted {
    /// Expected values.
    pub expected: Vec<f64>,
    /// A vector for each value: their products are the covariances of the predictions.
    features: Vec<f64>,
    size: usize,
}

impl Predicted {
    /// From vectors of `size` cells each, value by value.
    ///
    /// # Panics
    /// There is not one vector for each value.
    pub fn new(expected: Vec<f64>, features: Vec<f64>, size: usize) -> Self {
        assert_eq!(features.len(), expected.len() * size, "there is a vector for each value");
        Self { expected, features, size }
    }

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
        // The products come column by column of the second factor.
        cross_gram(of(others), of(values), self.size)
    }
}

impl Open {
    pub(super) fn new(
        data: &Measurements,
        survey: &Survey,
        fit: &Fit<EffectModel>,
        reference: &Arm,
        sets: Vec<OpenSet>,
    ) -> Self {
        let (data, survey, fit, reference) = (data.clone(), survey.clone(), fit.clone(), reference.clone());
        Self { data, survey, fit, reference, sets }
    }

    /// The one hypothesis that a fit with its effects and curves is.
    ///
    /// # Shape and units
    /// `data` as fitted; `reference` as in [`denavit_identify::solve::fit`].
    pub fn of_fit(survey: &Survey, data: &Measurements, fit: &Fit<EffectModel>, reference: &Arm) -> Self {
        let term =
            |effect: &denavit_identify::effects::model::Effect| Candidate { term: effect.term.clone(), scanned: 0 };
        let set = OpenSet {
            terms: fit.effects.effects.iter().map(term).collect(),
            causes: Vec::new(),
            log_mass: 0.0,
            curves: fit.effects.curves.iter().map(|curve| (curve.joint, Kernel::of(curve))).collect(),
        };
        Self::new(data, survey, fit, reference, vec![set])
    }

    /// The arm as fitted.
    pub fn arm(&self) -> &Arm {
        &self.fit.arm
    }

    /// The chain that effects are known on.
    fn chain(&self) -> &Chain {
        &self.fit.effects.statics.chain
    }

    /// The joints whose approach or history matters to a hypothesis, the most probable first.
    pub fn approached(&self) -> Vec<Approached> {
        let mut joints: Vec<Approached> = Vec::new();
        for candidate in self.sets.iter().flat_map(|set| &set.terms) {
            let Some((joint, column, by_order)) = self.approach_of(&candidate.term.driver) else { continue };
            let known = joints.iter().position(|known| known.joint == joint).unwrap_or_else(|| {
                joints.push(Approached { joint, columns: Vec::new(), by_order: true });
                joints.len() - 1
            });
            let known = &mut joints[known];
            known.by_order &= by_order;
            if !known.columns.contains(&column) {
                known.columns.push(column);
            }
        }
        joints
    }

    /// The joint whose side of approach or windup a driver follows; the column, and whether it follows from the order of the rows.
    fn approach_of(&self, driver: &Driver) -> Option<(usize, String, bool)> {
        if let Some(side) = driver.side() {
            return Some((side.joint, side.column.name().to_owned(), side.from_rows));
        }
        let column = driver.covariate()?;
        let (joint, _) = History::of_column(column).filter(|(_, history)| history.is_of_the_way())?;
        let joint = self.chain().joints().iter().position(|own| own.name == joint)?;
        Some((joint, column.to_owned(), true))
    }

    /// Uncertain causes: joints with a cause that not all sets contain, and that cause.
    fn challenged(&self) -> Vec<(usize, &Candidate)> {
        let mut joints: Vec<(usize, &Candidate)> = Vec::new();
        for candidate in self.sets.iter().flat_map(|set| &set.terms) {
            let all = self.sets.iter().all(|set| set.terms.iter().any(|other| other.term == candidate.term));
            if let Carrier::Joint(joint) = candidate.term.carrier
                && !all
                && !joints.iter().any(|(known, _)| *known == joint)
                && joints.len() < MOST_CHALLENGED
            {
                joints.push((joint, candidate));
            }
        }
        joints
    }

    /// The model with waves that cover the measured and the future rows.
    fn state(&self, rows: &Measurements, joints: &[usize]) -> State {
        let mut state = State::new(&self.survey, &self.data, &self.fit);
        let kept: Vec<bool> = state.joints.iter().map(|joint| joints.contains(joint)).collect();
        state.keep(&kept);
        let chain = self.chain();
        for (waves, &joint) in state.waves.iter_mut().zip(&state.joints) {
            let moving = &chain.joints()[joint];
            let (mut low, mut high) = self.survey.ranges[joint];
            for row in 0..rows.len() {
                let reading = moving.value(rows.reading(row));
                (low, high) = (low.min(reading), high.max(reading));
            }
            let slides = self.survey.slides(joint);
            let highest = if slides { FASTEST * std::f64::consts::TAU / (high - low) } else { FASTEST };
            *waves = Waves::over(low, high, chain.coordinates()[moving.coordinate].continuous, highest, MOST_WAVES);
        }
        state
    }

    /// All terms, each once.
    fn candidates(&self) -> Vec<Candidate> {
        let mut candidates: Vec<Candidate> = Vec::new();
        for candidate in self.sets.iter().flat_map(|set| &set.terms) {
            if !candidates.iter().any(|other| other.term == candidate.term) {
                candidates.push(candidate.clone());
            }
        }
        candidates
    }

    /// The setting of each set, and the kernels that the curves of these joints have in any of them.
    fn settings(&self, joints: &[usize]) -> Option<(Vec<Setting>, Vec<Vec<Kernel>>)> {
        let mut kernels: Vec<Vec<Kernel>> = vec![Vec::new(); joints.len()];
        let mut settings = Vec::new();
        for set in &self.sets {
            let mut setting = Setting { curves: vec![0; joints.len()], unnamed: None };
            for (joint, kernel) in &set.curves {
                let at = joints.iter().position(|other| other == joint)?;
                let known = kernels[at].iter().position(|other| other == kernel);
                let own = known.unwrap_or_else(|| {
                    kernels[at].push(*kernel);
                    kernels[at].len() - 1
                });
                setting.curves[at] = own + 1;
            }
            settings.push(setting);
        }
        Some((settings, kernels))
    }

    /// The curves that replace a cause, if its joint has none in the set without it.
    fn challenges<'a>(
        &self,
        challenged: &[(usize, &'a Candidate)],
        joints: &[usize],
        settings: &[Setting],
    ) -> Vec<Challenge<'a>> {
        let of = |&(joint, candidate): &(usize, &'a Candidate)| {
            let curve = joints.iter().position(|other| *other == joint)?;
            let holds = |set: &OpenSet| set.terms.iter().any(|other| other.term == candidate.term);
            let with = self.sets.iter().position(holds)?;
            let without = self.sets.iter().position(|set| !holds(set))?;
            (settings[without].curves[curve] == 0).then_some(Challenge { curve, candidate, with, without })
        };
        challenged.iter().filter_map(of).collect()
    }

    /// The prediction of each hypothesis for `rows`, which have the scene and the recorded columns of the run; `None` if one has no
    /// solution.
    pub fn hypotheses(&self, rows: &Measurements) -> Option<Hypotheses> {
        let challenged = self.challenged();
        let mut joints: Vec<usize> = self.sets.iter().flat_map(|set| &set.curves).map(|(joint, _)| *joint).collect();
        joints.extend(challenged.iter().map(|(joint, _)| *joint));
        // What the fit's own curves explain is added back, whether a hypothesis has them or not.
        joints.extend(self.fit.effects.curves.iter().map(|curve| curve.joint));
        let state = self.state(rows, &joints);
        let candidates = self.candidates();
        let round = Round::beside(&self.data, &state, &self.reference, Some(&candidates), &[], 1);
        let members = members(&round, &candidates, |_| 0.0);
        let (settings, mut kernels) = self.settings(&state.joints)?;
        let lines = self.lines(rows, &state, &candidates);
        let challenges = self.challenges(&challenged, &state.joints, &settings);
        let index = |set: &OpenSet| -> Vec<usize> {
            let of = |term: &Candidate| candidates.iter().position(|other| other.term == term.term);
            set.terms.iter().filter_map(of).collect()
        };
        let mut noise = f64::INFINITY;
        let mut list: Vec<Hypothesis> = Vec::new();
        let contest = round.contest(&kernels, &[], &members);
        for (set, setting) in self.sets.iter().zip(&settings) {
            let ground = contest.ground(&round.gram, setting)?;
            let (columns, system) = contest.system(&round.gram, (&ground, setting), &index(set));
            let (square, count) = (system.square, system.count);
            let solved = system.solved()?;
            noise = noise.min((square - solved.explained()) / count);
            list.push(Hypothesis {
                causes: set.causes.clone(),
                curves: set.curves.iter().map(|(joint, _)| *joint).collect(),
                terms: set.terms.iter().map(|candidate| candidate.term.clone()).collect(),
                probability: 0.0,
                log_probability: set.log_mass,
                columns,
                solved,
            });
        }
        for Challenge { curve: at, candidate, with, without } in challenges {
            // A curve that replaces a cause is as large as the cause in the future rows.
            let member = candidates.iter().position(|other| other.term == candidate.term)?;
            let size = list[with].size_of(&members[member].columns, &lines, at) * noise.sqrt();
            let length = length_of(&candidate.term, state.joints[at]);
            if !(size > 0.0 && size.is_finite()) {
                continue;
            }
            kernels[at].push(Kernel { log_variance: 2.0 * size.ln(), log_length: length.ln() });
            let mut setting = settings[without].clone();
            setting.curves[at] = kernels[at].len();
            let contest = round.contest(&kernels, &[], &members);
            let challenger = || {
                let set = index(&self.sets[without]);
                let bare = contest.at(&contest.ground(&round.gram, &settings[without])?, &set);
                let ground = contest.ground(&round.gram, &setting)?;
                let gain = contest.at(&ground, &set) - bare;
                let (columns, system) = contest.system(&round.gram, (&ground, &setting), &set);
                let solved = system.solved()?;
                let like = list[without].clone();
                let log_probability = self.sets[without].log_mass + gain;
                let curves = like.curves.iter().copied().chain([state.joints[at]]).collect();
                Some(Hypothesis { curves, log_probability, columns, solved, ..like })
            };
            let challenger = challenger();
            list.extend(challenger);
        }
        share_out(&mut list);
        (noise > 0.0 && noise.is_finite()).then_some(Hypotheses { list, lines, noise })
    }

    /// Columns of future rows.
    fn lines(&self, data: &Measurements, state: &State, candidates: &[Candidate]) -> Lines {
        let mut fit = self.fit.clone();
        fit.weights = vec![1.0; data.observations()];
        let laid = Laid::of(data, &fit, &state.joints, &self.reference, Some(candidates), &[]);
        let width = laid.plain.len() + state.waves.iter().map(Waves::len).sum::<usize>();
        let values = laid.linear.values();
        let mut cells = vec![0.0; width * values];
        for (value, line) in cells.chunks_exact_mut(width.max(1)).enumerate() {
            let (plain, mut rest) = line.split_at_mut(laid.plain.len());
            for (cell, column) in plain.iter_mut().zip(&laid.plain) {
                *cell = column[value];
            }
            let reading = data.reading(laid.linear.rows[value]);
            for ((joint, waves), column) in state.joints.iter().zip(&state.waves).zip(&laid.joints) {
                let (own, others) = rest.split_at_mut(waves.len());
                rest = others;
                waves.values_into(self.chain().joints()[*joint].value(reading), own);
                for cell in own {
                    *cell *= column[value];
                }
            }
        }
        let (mut rows, mut metres) = (Vec::with_capacity(data.len()), Vec::with_capacity(values));
        for row in 0..data.len() {
            let from = metres.len();
            for observation in data.of_row(row) {
                let series = data.series_of(observation);
                for (part, channel) in [Some(series.kind.place()), series.kind.turn()].into_iter().zip(series.channels)
                {
                    let Some(part) = part else { continue };
                    let level = channel.map_or(1.0, |channel| fit.noise.levels[channel]);
                    metres.extend(std::iter::repeat_n(if part.unit == "m" { level } else { 0.0 }, part.height));
                }
            }
            rows.push(from..metres.len());
        }
        Lines { cells, width, joints: laid.joints, rows, metres }
    }
}

/// A curve, by its index, that replaces a cause: the best set with the cause and the best without it.
struct Challenge<'a> {
    curve: usize,
    candidate: &'a Candidate,
    with: usize,
    without: usize,
}

/// Makes probabilities of the masses.
fn share_out(list: &mut [Hypothesis]) {
    let top = list.iter().map(|one| one.log_probability).fold(f64::NEG_INFINITY, f64::max);
    let sum = list.iter().map(|one| (one.log_probability - top).exp()).sum::<f64>().ln() + top;
    for hypothesis in list {
        hypothesis.log_probability -= sum;
        hypothesis.probability = hypothesis.log_probability.exp();
    }
}

/// Length scale of a curve with the same effect as a term that follows its joint's reading, rad or m.
fn length_of(term: &Term, own: usize) -> f64 {
    match term.driver {
        Driver::Harmonic { joint, order } if joint == own => order.recip(),
        Driver::Bump { joint, width, .. } if joint == own => width,
        _ => SOME_LENGTH,
    }
}

impl Hypothesis {
    /// Size of a joint's curve with as large an effect in future rows as these columns, rad or m in units of the noise.
    fn size_of(&self, columns: &std::ops::Range<usize>, lines: &Lines, joint: usize) -> f64 {
        let (mut does, mut one) = (0.0, 0.0);
        for (line, unit) in lines.cells.chunks_exact(lines.width.max(1)).zip(&lines.joints[joint]) {
            let own = |column: &usize| if columns.contains(column) { line[*column] } else { 0.0 };
            let cells: Vec<f64> = self.columns.iter().map(own).collect();
            does += self.solved.expected(&self.solved.feature(&cells)).powi(2);
            one += unit * unit;
        }
        (does / f64::max(one, f64::MIN_POSITIVE)).sqrt()
    }
}

impl Hypotheses {
    /// Whether there is more than one.
    pub fn open(&self) -> bool {
        self.list.len() > 1
    }

    /// The prediction of one of them for the future rows.
    pub fn predicted(&self, hypothesis: usize) -> Predicted {
        let Hypothesis { columns, solved, .. } = &self.list[hypothesis];
        let each = self.lines.cells.chunks_exact(self.lines.width.max(1));
        let features = par_map(
            each,
            available(),
            || vec![0.0; columns.len()],
            |own, line| {
                for (cell, &column) in own.iter_mut().zip(columns) {
                    *cell = line[column];
                }
                solved.feature(own)
            },
        );
        let expected = features.iter().map(|feature| solved.expected(feature)).collect();
        Predicted { expected, size: columns.len(), features: features.into_iter().flatten().collect() }
    }
}
