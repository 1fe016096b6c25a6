//! Which causes are named: those with nearly all the posterior mass that half-sample refits also select.

use crate::blocks::Block;
use crate::infer::contest::{Contest, Marginal, Member, Seen, Setting, Unnamed, best_of, rivals_of_best};
use crate::infer::curves::{Round, State};
use crate::infer::gram::Gram;
use crate::infer::hypotheses::{Cause, Open, OpenSet};
use crate::infer::members::members;
use crate::infer::model::Kernel;
use crate::scorer::handicap;
use denavit_identify::arm::Arm;
use denavit_identify::effects::candidates::Candidate;
use denavit_identify::effects::carrier::Carrier;
use denavit_identify::effects::catalogue::{KINDS, Kind};
use denavit_identify::effects::curve::Curve;
use denavit_identify::effects::driver::Driver;
use denavit_identify::effects::history::History;
use denavit_identify::effects::model::EffectModel;
use denavit_identify::effects::recorded::given_by_order;
use denavit_identify::effects::survey::Survey;
use denavit_identify::residual::ResidualModel;
use denavit_identify::solve::{Fit, gross};
use denavit_linear::threads::{each_alone, each_alone_until, in_parallel};
use denavit_measurements::Measurements;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// A cause is named from this probability on.
const NAMED: f64 = 0.95;
/// And if at least this share of the half-sample refits selects it.
const FOUND_AGAIN: f64 = 0.8;
/// From this probability on, among models without unexplained structure, a cause stays in the model although it is not named
/// (Barbieri, Berger 2004: the median probability model predicts best). The probabilities of its rivals are added: if one of several
/// acts, including the best of them predicts better than including none.
const KEPT: f64 = 0.5;
/// Number of parts of a run, and how often they are split into two halves.
const PARTS: usize = 10;
const SPLITS: usize = 15;
/// Smallest number of halves that are searched.
const FEWEST_HALVES: usize = 10;
/// If the first halves, in this number, all select a cause, no more are needed: for a cause that seven halves of ten select, that happens
/// once in seventy times.
const UNANIMOUS: usize = 12;
/// A set of causes with this much of the mass remains possible even if every member of the best set is certain.
const POSSIBLE: f64 = 0.1;
/// Each of many sets of the same names may be up to this much below their sum, logarithm.
const BESIDE: f64 = 3.0;
/// Number of sets listed, the most probable first.
const MOST_POSSIBLE: usize = 6;
/// Smallest probability of a rival.
const RIVAL: f64 = 0.02;
/// And it is this much more probable in the other's absence than in its presence, logarithm.
const MORE: f64 = 0.4;
/// Penalty of a scanned number beyond the catalogue's grid: it was refined between grid points.
const REFINED: f64 = 1.0;
/// Penalty of a compliance under a torque that a spring partly balances, against one without a spring: one machine in ten has a
/// spring.
const BALANCED: f64 = 2.3;

/// A cause at a place, and how probable it is that it acts.
#[derive(Debug, Clone, PartialEq)]
pub struct Alternative {
    /// The kind.
    pub kind: Kind,
    /// Where.
    pub place: String,
    /// Posterior probability, 0 to 1.
    pub probability: f64,
}

/// A member of the most probable set.
#[derive(Debug, Clone, PartialEq)]
pub struct Judged {
    /// The term.
    pub candidate: Candidate,
    /// How probable it is that this kind acts at this place.
    pub probability: f64,
    /// Logarithm of the probability that it does not.
    pub log_absent: f64,
    /// Share of the half-sample refits that select it (`found_again`), limited to the share of other rows' sets that select it, if any.
    pub found_again: f64,
    /// Its increase of the log marginal likelihood, prior odds included; the mean over these and the other rows.
    pub gain: f64,
    /// Its rivals.
    pub rivals: Vec<Alternative>,
    /// Whether it is included for the prediction.
    pub predicts: bool,
}

/// Whether a cause is certain enough to be named.
pub fn sure(probability: f64, found_again: f64) -> bool {
    probability >= NAMED && found_again >= FOUND_AGAIN
}

/// Whether this cause or one of its alternatives probably acts.
pub fn likely(probability: f64, rivals: &[Alternative]) -> bool {
    probability + rivals.iter().map(|rival| rival.probability).sum::<f64>() >= KEPT
}

impl Judged {
    /// Whether it stays in the model: named, or for the prediction.
    pub fn kept(&self) -> bool {
        self.named() || self.predicts
    }

    /// Whether it is named.
    pub fn named(&self) -> bool {
        sure(self.probability, self.found_again)
    }
}

/// The candidates, curves and structures that are compared.
pub(crate) struct Question<'a> {
    /// Candidate terms.
    pub candidates: &'a [Candidate],
    /// Every term that was tested.
    pub counted: &'a [Candidate],
    /// The set to start from, by terms.
    pub start: &'a [Candidate],
    /// Curves as fitted with several models: each joint may have any of its kernels.
    pub curves: &'a [&'a [Curve]],
    /// Unexplained structures; each has columns.
    pub structures: &'a [Vec<Block>],
    /// Other rows of the run, which must support a cause, too.
    pub others: &'a [OtherRows<'a>],
}

/// Further rows of the same run, as many as those of the comparison and different from them.
pub(crate) struct OtherRows<'a> {
    pub survey: &'a Survey,
    pub data: &'a Measurements,
    /// The structures' columns in these rows.
    pub structures: Vec<Vec<Block>>,
}

/// The members, curves and structures of a contest, on some rows.
struct Entered {
    round: Round,
    members: Vec<Member>,
    unnamed: Vec<Unnamed>,
}

impl Entered {
    fn new(
        data: &Measurements,
        state: &State,
        reference: &Arm,
        question: &Question<'_>,
        structures: &[Vec<Block>],
        parts: usize,
    ) -> Self {
        let candidates = question.candidates;
        let blocks: Vec<Block> = structures.iter().flatten().cloned().collect();
        let round = Round::beside(data, state, reference, Some(candidates), &blocks, parts);
        let members = members(&round, candidates, |candidate| log_odds(candidate, question.counted, data.len()));
        let mut of_blocks = round.candidates[candidates.len()..].iter();
        let mut columns =
            |structure: &Vec<Block>| of_blocks.by_ref().take(structure.len()).cloned().flatten().collect();
        let unnamed = structures.iter().map(|structure| Unnamed { columns: columns(structure) }).collect();
        Self { round, members, unnamed }
    }

    fn contest<'a>(&'a self, kernels: &'a [Vec<Kernel>]) -> Contest<'a> {
        self.round.contest(kernels, &self.unnamed, &self.members)
    }
}

/// What an engineer would call the same cause.
type Name = (Kind, String);

/// The name of a candidate.
fn name(candidate: &Candidate, fit: &Fit<EffectModel>) -> Name {
    (candidate.term.kind, candidate.term.carrier.place(&fit.effects.statics.chain))
}

/// The result of the comparison.
#[derive(Default)]
pub(crate) struct Judgement {
    /// The members of the most probable set.
    pub members: Vec<Judged>,
    /// The sets of causes that remain possible, if more than one.
    pub open: Option<Open>,
}

/// Compares sets of candidates in a model with geometry, frames, curves and unexplained structure: the most probable set, and the sets
/// that remain possible.
///
/// # Shape and units
/// `fit`: a model near the truth, whose effects are set aside. `reference` as in [`denavit_identify::solve::fit`].
pub(crate) fn judge(
    survey: &Survey,
    data: &Measurements,
    fit: &Fit<EffectModel>,
    reference: &Arm,
    question: &Question<'_>,
) -> Judgement {
    let candidates = question.candidates;
    let mut state = State::new(survey, data, fit);
    let kernel = |joint: usize| kernels_of(question.curves, joint);
    let has: Vec<bool> = state.joints.iter().map(|&joint| !kernel(joint).is_empty()).collect();
    state.keep(&has);
    let kernels: Vec<Vec<Kernel>> = state.joints.iter().map(|&joint| kernel(joint)).collect();
    let entered = Entered::new(data, &state, reference, question, question.structures, PARTS);
    let (round, contest) = (&entered.round, entered.contest(&kernels));
    let place = |wanted: &Candidate| candidates.iter().position(|candidate| candidate.term == wanted.term);
    let start: Vec<usize> = question.start.iter().filter_map(place).collect();
    let (seen, settings) = contest.run(&round.gram, std::slice::from_ref(&start));
    let Some((set, _)) = seen.iter().max_by(|a, b| a.1.0.total_cmp(&b.1.0)) else {
        return Judgement::default();
    };
    let names: Vec<Name> = candidates.iter().map(|candidate| name(candidate, fit)).collect();
    let masses = Masses::of(&seen, &names);
    let holds = |set: &[usize], name: &Name| set.iter().any(|&other| names[other] == *name);
    // The best settings of the probable sets.
    let mut which = rivals_of_best(&seen);
    which.push(Vec::new());
    let mut kept: Vec<usize> = which.iter().filter_map(|set| seen.get(set)).map(|(_, setting)| *setting).collect();
    kept.sort_unstable();
    kept.dedup();
    let grounds = |contest: &Contest<'_>, gram: &Gram| -> Vec<Marginal> {
        kept.iter().filter_map(|&setting| contest.ground(gram, &settings[setting].1)).collect()
    };
    let bare = without_structure(&contest, &settings, &which);
    let (predicting, best) = (Masses::of(&bare, &names), best_of(&bare));
    let mut all = set.clone();
    all.extend(best.iter().filter(|member| !set.contains(member)));
    // Without a probable cause, half-sample refits are not made.
    let others = if all.is_empty() { &[][..] } else { question.others };
    let elsewhere = each_alone(others, |other| {
        let mut state = State::new(other.survey, other.data, &on_other_rows(fit, other.data));
        state.keep(&has);
        let entered = Entered::new(other.data, &state, reference, question, &other.structures, 1);
        let contest = entered.contest(&kernels);
        contest.climbed(&grounds(&contest, &entered.round.gram), &which)
    });
    // Each half starts from the run's best set, and from the start of that search.
    let begin: Vec<Vec<usize>> = vec![set.clone(), best.clone(), start, Vec::new()];
    let search = |gram: &Gram| contest.best_from(&grounds(&contest, gram), &begin);
    let sought = |counted: f64, enough: &Enough<'_>| resampled(&round.parts, counted, &search, enough);
    let probability = |name: &Name| masses.log_present(name).exp();
    let named = |&member: &usize| (probability(&names[member]), &names[member]);
    let found_again = found_again(&all.iter().map(named).collect::<Vec<_>>(), &sought, &|set, name| holds(set, name));
    let there: Vec<Vec<usize>> = elsewhere.iter().map(best_of).collect();
    let members: Vec<Judged> = all
        .iter()
        .zip(found_again)
        .map(|(&member, found_again)| {
            let mine = &names[member];
            let gain = |seen: &Seen| gain(seen, &|set| holds(set, mine));
            let mut gains: Vec<f64> = elsewhere.iter().map(gain).filter(|gain| gain.is_finite()).collect();
            gains.push(gain(&seen));
            let found_elsewhere = if there.is_empty() { 1.0 } else { share(&there, |set| holds(set, mine)) };
            let (probability, instead) = (probability(mine), masses.rivals(mine));
            // A cause that is included for the prediction must be likely with and without unexplained structure.
            let predicts = best.contains(&member)
                && !follows_warmth(&candidates[member])
                && likely(probability, &instead)
                && likely(predicting.log_present(mine).exp(), &predicting.rivals(mine));
            Judged {
                candidate: candidates[member].clone(),
                probability,
                log_absent: masses.log_absent(mine),
                found_again: found_again.min(found_elsewhere),
                gain: gains.iter().sum::<f64>() / gains.len() as f64,
                rivals: instead,
                predicts,
            }
        })
        .collect();
    let unsure: Vec<usize> =
        all.iter().zip(&members).filter(|(_, one)| !one.named()).map(|(member, _)| *member).collect();
    let left = possible(&seen, &names, &masses, set, &unsure);
    let sets: Vec<OpenSet> = left
        .into_iter()
        .map(|(set, log_mass)| OpenSet {
            causes: causes(&set, &names),
            curves: curves_beside(&contest, &settings, &set, &state.joints),
            terms: set.iter().map(|&member| candidates[member].clone()).collect(),
            log_mass,
        })
        .collect();
    let open = (sets.len() > 1).then(|| Open::new(data, survey, fit, reference, sets));
    Judgement { members, open }
}

/// A fit seen on rows that it was not made for.
fn on_other_rows(fit: &Fit<EffectModel>, data: &Measurements) -> Fit<EffectModel> {
    let squares = ResidualModel { data, layout: &fit.layout, effects: &fit.effects }.squares(&fit.arm);
    let weights = gross(data, &squares, &vec![1.0; data.observations()], &fit.noise);
    Fit { weights, squares, ..fit.clone() }
}

/// The names of a set's members, each once.
fn causes(set: &[usize], names: &[Name]) -> Vec<Cause> {
    let mut causes: Vec<Cause> = Vec::new();
    for (kind, place) in set.iter().map(|&member| names[member].clone()) {
        let cause = Cause { kind, place };
        if !causes.contains(&cause) {
            causes.push(cause);
        }
    }
    causes
}

/// The best curves for a set, among the settings without structure.
fn curves_beside(
    contest: &Contest<'_>,
    settings: &[(Marginal, Setting)],
    set: &[usize],
    joints: &[usize],
) -> Vec<(usize, Kernel)> {
    let known = settings.iter().filter(|(_, setting)| setting.unnamed.is_none());
    let suits = known.max_by(|a, b| contest.at(&a.0, set).total_cmp(&contest.at(&b.0, set)));
    let chosen = suits.map_or_else(|| contest.bare().curves, |(_, setting)| setting.curves.clone());
    let kernel =
        |(curve, kernel): (usize, usize)| Some((joints[curve], contest.kernels[curve][kernel.checked_sub(1)?]));
    chosen.into_iter().enumerate().filter_map(kernel).collect()
}

/// The sets of causes that remain possible, the best first, each with the logarithm of the mass of all sets of the same names: those of
/// [`POSSIBLE`] and more, and for each uncertain member its alternatives: the best set with each of its rivals instead, and the best set
/// without it.
fn possible(
    seen: &Seen,
    names: &[Name],
    masses: &Masses<'_>,
    best: &[usize],
    unsure: &[usize],
) -> Vec<(Vec<usize>, f64)> {
    let has = |set: &[usize], name: &Name| set.iter().any(|&other| names[other] == *name);
    let signature = |set: &[usize]| {
        let mut own: Vec<usize> = set.iter().map(|&member| masses.place(&names[member])).collect();
        own.sort_unstable();
        own.dedup();
        own
    };
    let mut by_score: Vec<(&Vec<usize>, f64)> = seen.iter().map(|(set, (score, _))| (set, *score)).collect();
    by_score.sort_by(|a, b| b.1.total_cmp(&a.1));
    let first =
        |holds: &dyn Fn(&[usize]) -> bool| by_score.iter().find(|(set, _)| holds(set)).map(|(set, _)| (*set).clone());
    let signatures: Vec<Vec<usize>> = seen.keys().map(|set| signature(set)).collect();
    let mass_of = |own: &[usize]| masses.mass(|set| signatures[set] == own);
    let mut sets: Vec<Vec<usize>> = vec![best.to_vec()];
    for &member in unsure {
        let mine = &names[member];
        for rival in masses.rivals(mine) {
            let name = (rival.kind, rival.place);
            sets.extend(first(&|set| has(set, &name) && !has(set, mine)));
        }
        sets.extend(first(&|set| !has(set, mine)));
    }
    let top = by_score[0].1;
    let near = by_score.iter().take_while(|(_, score)| top - score < -POSSIBLE.ln() + BESIDE);
    let near: Vec<Vec<usize>> = near.map(|(set, _)| (*set).clone()).collect();
    sets.extend(near.into_iter().filter(|set| mass_of(&signature(set)) > POSSIBLE.ln()));
    let mut possible: Vec<(Vec<usize>, f64)> = Vec::new();
    let mut known: Vec<Vec<usize>> = Vec::new();
    for set in sets {
        let own = signature(&set);
        if !known.contains(&own) {
            possible.push((set, mass_of(&own)));
            known.push(own);
        }
    }
    possible[1..].sort_by(|a, b| b.1.total_cmp(&a.1));
    possible.truncate(MOST_POSSIBLE);
    possible
}

/// Kernels of a joint's curve in the fitted models.
fn kernels_of(curves: &[&[Curve]], joint: usize) -> Vec<Kernel> {
    let own = curves.iter().flat_map(|curves| curves.iter()).filter(|curve| curve.joint == joint);
    let mut kernels: Vec<Kernel> = Vec::new();
    for kernel in own.map(Kernel::of) {
        if !kernels.contains(&kernel) {
            kernels.push(kernel);
        }
    }
    kernels
}

/// Whether a cause follows the warming of a joint by its own motion: at another pace than the run's the same cause may be many times as
/// large.
fn follows_warmth(candidate: &Candidate) -> bool {
    let column = candidate.term.driver.covariate();
    matches!(column.and_then(History::of_column), Some((_, History::Warmth { .. })))
}

/// Every set found from these starts at their best settings without unexplained structure, which predicts nothing.
fn without_structure(contest: &Contest<'_>, settings: &[(Marginal, Setting)], starts: &[Vec<usize>]) -> Seen {
    let bare = settings.iter().filter(|(_, setting)| setting.unnamed.is_none());
    let bare: Vec<&Marginal> = bare.map(|(ground, _)| ground).collect();
    let suits = in_parallel(starts, |set| contest.best(bare.iter().copied(), set).1);
    let grounds =
        bare.iter().enumerate().filter(|(place, _)| suits.contains(place)).map(|(_, ground)| (*ground).clone());
    contest.climbed(&grounds.collect::<Vec<Marginal>>(), starts)
}

/// Posterior mass of sets, by the names of their members.
struct Masses<'a> {
    /// Each once.
    names: Vec<&'a Name>,
    /// For each name, the sets that contain it.
    holds: Vec<Vec<bool>>,
    /// Of each set.
    scores: Vec<f64>,
    /// Logarithm of the total mass.
    whole: f64,
}

impl<'a> Masses<'a> {
    fn of(seen: &Seen, all: &'a [Name]) -> Self {
        let mut names: Vec<&Name> = Vec::new();
        let mut place = |name: &'a Name| {
            names.iter().position(|known| *known == name).unwrap_or_else(|| {
                names.push(name);
                names.len() - 1
            })
        };
        let places: Vec<usize> = all.iter().map(&mut place).collect();
        let mut holds = vec![vec![false; seen.len()]; names.len()];
        for (index, set) in seen.keys().enumerate() {
            for &member in set {
                holds[places[member]][index] = true;
            }
        }
        let scores = seen.values().map(|(score, _)| *score).collect();
        let mut masses = Self { names, holds, scores, whole: 0.0 };
        masses.whole = masses.sum(|_| true);
        masses
    }

    /// # Panics
    /// The name is unknown.
    fn place(&self, name: &Name) -> usize {
        self.names.iter().position(|known| *known == name).expect("every candidate has a name")
    }

    fn sum(&self, holds: impl Fn(usize) -> bool) -> f64 {
        let scores = || self.scores.iter().enumerate().filter(|(set, _)| holds(*set)).map(|(_, score)| *score);
        let top = scores().fold(f64::NEG_INFINITY, f64::max);
        if top == f64::NEG_INFINITY { top } else { top + scores().map(|score| (score - top).exp()).sum::<f64>().ln() }
    }

    /// Logarithm of the share of the mass in sets for which `holds` is true.
    fn mass(&self, holds: impl Fn(usize) -> bool) -> f64 {
        (self.sum(holds) - self.whole).min(0.0)
    }

    /// The same for sets that contain a name, and for those that do not.
    fn log_present(&self, name: &Name) -> f64 {
        let own = &self.holds[self.place(name)];
        self.mass(|set| own[set])
    }

    fn log_absent(&self, name: &Name) -> f64 {
        let own = &self.holds[self.place(name)];
        self.mass(|set| !own[set])
    }

    /// Causes that act instead of `mine`: more probable without it than with it. A cause that acts in any case is not a rival.
    fn rivals(&self, mine: &Name) -> Vec<Alternative> {
        let own = &self.holds[self.place(mine)];
        let (present, absent) = (self.log_present(mine), self.log_absent(mine));
        let mut rivals: Vec<Alternative> = Vec::new();
        if absent.exp() <= RIVAL {
            return rivals;
        }
        for (name, holds) in self.names.iter().zip(&self.holds).filter(|(name, _)| **name != mine) {
            let instead = self.mass(|set| holds[set] && !own[set]);
            let beside = self.mass(|set| holds[set] && own[set]) - present;
            if instead.exp() > RIVAL && instead - absent > beside + MORE {
                rivals.push(Alternative { kind: name.0, place: name.1.clone(), probability: instead.exp() });
            }
        }
        rivals.sort_by(|a, b| b.probability.total_cmp(&a.probability));
        rivals
    }
}

/// Difference between the best score of sets for which `holds` is true and the best of the others.
fn gain(seen: &Seen, holds: &dyn Fn(&[usize]) -> bool) -> f64 {
    let best = |with: bool| {
        let scores = seen.iter().filter(|(set, _)| holds(set) == with).map(|(_, (score, _))| *score);
        scores.fold(f64::NEG_INFINITY, f64::max)
    };
    best(true) - best(false)
}

/// Prior odds of a cause: each kind is as likely as another, and each of its terms as likely as another of the same kind; but where a kind has
/// plain forms and others, the plain ones together are as likely as all others.
fn log_odds(candidate: &Candidate, counted: &[Candidate], rows: usize) -> f64 {
    let kind = candidate.term.kind;
    let of_kind = || counted.iter().filter(|other| other.term.kind == kind);
    let alike = of_kind().filter(|other| is_plain(other) == is_plain(candidate)).count().max(1);
    let same = if alike < of_kind().count() { 2 * alike } else { alike };
    let scanned = match &candidate.term.driver {
        // The first step is one of the catalogue's; each further one may be after any row.
        Driver::Steps { at, .. } => REFINED + (at.len() - 1) as f64 * (rows as f64).ln(),
        Driver::SprungTorque(_) => BALANCED,
        _ => REFINED * candidate.scanned as f64,
    };
    let instrument = if candidate.term.carrier == Carrier::Scale { 1.0 } else { 0.0 };
    -((KINDS.len() * same) as f64).ln() - 0.5 * handicap(kind) - scanned - instrument
}

/// Whether a cause has the form that an engineer would try first: an integer order, a whole torque, one side or the other, a base with
/// equal compliance in all directions.
fn is_plain(candidate: &Candidate) -> bool {
    match candidate.term.driver {
        Driver::Harmonic { .. } => candidate.scanned == 0,
        Driver::SprungTorque(_)
        | Driver::HardeningTorque { .. }
        | Driver::FrictionSide { .. }
        | Driver::LoadedSide { .. }
        | Driver::LevelOverturning => false,
        Driver::Covariate(ref column) => !given_by_order(column.name()),
        _ => true,
    }
}

/// Whether the sets found on the halves so far are enough for a decision.
type Enough<'a> = dyn Fn(&[Vec<usize>]) -> bool + Sync + 'a;

/// For each of these names (with their probabilities) the share of half-sample refits that select it. If too few halves select an otherwise
/// certain cause, halves with every row counted twice are tried, and the larger share is used.
///
/// A half counted twice differs from the run as much as another run of the same length: leaving out half of the rows reproduces the
/// variance of an estimate (Shao and Wu, Annals of Statistics 17 (1989), 1176). But with few rows, curves follow the doubled noise.
/// Counted once, a half has no such copies but only half the information: a cause that the run shows well may be too weak there.
/// A cause that is selected in either way does not depend on particular rows.
///
/// The search ends as soon as it is decided for each otherwise certain cause whether enough of all halves select it (a curtailed test;
/// Wetherill, Sequential Methods in Statistics, 1966), or after [`UNANIMOUS`] halves if all select it; the share refers to the halves searched.
fn found_again<N: Sync>(
    names: &[(f64, N)],
    sought: &dyn Fn(f64, &Enough<'_>) -> Vec<Vec<usize>>,
    holds: &(dyn Fn(&[usize], &N) -> bool + Sync),
) -> Vec<f64> {
    let shares = |counted: f64, asked: &[usize]| -> Vec<f64> {
        let enough = |found: &[Vec<usize>]| {
            let decided = |&index: &usize| decided(found.iter().map(|set| holds(set, &names[index].1)), found.len());
            found.len() >= FEWEST_HALVES && asked.iter().all(decided)
        };
        let found = sought(counted, &enough);
        names.iter().map(|(_, name)| share(&found, |set| holds(set, name))).collect()
    };
    if names.is_empty() {
        return Vec::new();
    }
    let sure: Vec<usize> = (0..names.len()).filter(|&index| names[index].0 >= NAMED).collect();
    let mut again = shares(1.0, &sure);
    let failed: Vec<usize> = sure.into_iter().filter(|&index| again[index] < FOUND_AGAIN).collect();
    if !failed.is_empty() {
        let twice = shares(2.0, &failed);
        for index in failed {
            again[index] = again[index].max(twice[index]);
        }
    }
    again
}

/// The share of these sets for which `holds` is true.
fn share(sets: &[Vec<usize>], holds: impl Fn(&[usize]) -> bool) -> f64 {
    sets.iter().filter(|set| holds(set)).count() as f64 / sets.len().max(1) as f64
}

/// Whether the halves searched so far decide whether enough of all halves find a cause.
fn decided(found: impl Iterator<Item = bool>, searched: usize) -> bool {
    let (all, found) = (2 * SPLITS, found.filter(|found| *found).count());
    let enough = |found: usize| found as f64 >= FOUND_AGAIN * all as f64;
    enough(found) || !enough(found + all - searched) || (found == searched && searched >= UNANIMOUS)
}

/// The sets found on halves of the run, until there are enough, with each row counted `counted` times. The run is split repeatedly into two
/// halves (complementary pairs; Shah and Samworth, Journal of the Royal Statistical Society B 75 (2013), 55).
fn resampled(
    parts: &[Gram],
    counted: f64,
    search: &(dyn Fn(&Gram) -> Vec<usize> + Sync),
    enough: &Enough<'_>,
) -> Vec<Vec<usize>> {
    let mut random = ChaCha8Rng::seed_from_u64(0);
    let mut order: Vec<usize> = (0..parts.len()).collect();
    let mut halves: Vec<Vec<usize>> = Vec::with_capacity(2 * SPLITS);
    for _ in 0..SPLITS {
        for last in (1..order.len()).rev() {
            order.swap(last, random.random_range(0..=last));
        }
        halves.extend(order.chunks(parts.len().div_ceil(2)).map(<[usize]>::to_vec));
    }
    let found_on = |half: &Vec<usize>| {
        let times = |part| if half.contains(&part) { counted } else { 0.0 };
        let counts: Vec<f64> = (0..parts.len()).map(times).collect();
        search(&Gram::weighted(parts, &counts))
    };
    each_alone_until(&halves, found_on, enough)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::cell::RefCell;

    /// Halves that find a cause or do not, as often as they are counted; how many were searched each time.
    fn again(probability: f64, once: &[bool], twice: &[bool]) -> (f64, Vec<usize>) {
        let searched = RefCell::new(Vec::new());
        let sought = |counted: f64, enough: &Enough<'_>| {
            let found = if counted > 1.0 { twice } else { once };
            let sets: Vec<Vec<usize>> = found.iter().map(|found| if *found { vec![7] } else { Vec::new() }).collect();
            let first = (1..=sets.len()).find(|first| enough(&sets[..*first])).unwrap_or(sets.len());
            searched.borrow_mut().push(first);
            sets[..first].to_vec()
        };
        let again = found_again(&[(probability, 7)], &sought, &|set, name| set.contains(name));
        (again[0], searched.into_inner())
    }

    #[test]
    fn no_more_halves_are_searched_than_the_verdict_takes() {
        let all = 2 * SPLITS;
        let mixed = |missed: usize| -> Vec<bool> { (0..all).map(|half| half >= missed).collect() };
        let (always, never) = (mixed(0), mixed(all));
        assert_eq!(again(0.99, &always, &never), (1.0, vec![12]));
        // Six that miss it are not too many, seven are.
        assert_eq!(again(0.99, &mixed(6), &never), (0.8, vec![30]));
        assert_eq!(again(0.99, &mixed(7), &never), (0.3, vec![10, 10]));
        assert_eq!(again(0.99, &mixed(7), &always), (1.0, vec![10, 12]));
        // One that misses it among the first: all are searched that may say otherwise.
        let late: Vec<bool> = (0..all).map(|half| half != 1 && half < 25).collect();
        assert_eq!(again(0.99, &late, &never), (24.0 / 25.0, vec![25]));
        let late: Vec<bool> = (0..all).map(|half| half != 1 && half < 24).collect();
        assert_eq!(again(0.99, &late, &never), (23.0 / 30.0, vec![30, 10]));
        // It does not matter for a cause that is not probable.
        assert_eq!(again(0.5, &always, &never), (1.0, vec![10]));
    }

    #[test]
    fn the_verdict_is_that_of_all_halves_but_where_the_first_all_find_it() {
        let mut random = ChaCha8Rng::seed_from_u64(5);
        for _ in 0..500 {
            let level: f64 = random.random_range(0.6..1.0);
            let found: Vec<bool> = (0..2 * SPLITS).map(|_| random.random_bool(level)).collect();
            let whole = found.iter().filter(|found| **found).count() as f64 / found.len() as f64;
            let (share, _) = again(0.99, &found, &vec![false; found.len()]);
            let unanimous = found[..UNANIMOUS].iter().all(|found| *found);
            assert_eq!(sure(0.99, share), unanimous || sure(0.99, whole), "{found:?}");
        }
    }
}
