//! Scores sets of candidate effects from inner products of columns alone. Geometry, frames, curves and unexplained structure are
//! eliminated once (a Schur complement); each set then costs one Cholesky factor of its own size.
//!
//! After the elimination, S are the products of the candidates' columns, r their products with the data, and Q the square of the
//! data. P is the prior precision of the coefficients, Λ that of the eliminated parameters, M = Λ + their products. With σ² at its
//! maximum:
//!
//! ```text
//! 2 log p(y | set) = -N log((Q - rᵀ(S+P)⁻¹r)/N) - log|S+P| + log|P| - log|M| + log|Λ|
//! ```
//! S, r, Q and the last two terms depend on the *setting*: which curves and which structure are in the model, and their prior
//! variances. A set's score is that at its best setting.

use crate::infer::evidence::{System, waves_seen};
use crate::infer::gram::Gram;
use crate::infer::model::Kernel;
use denavit_identify::effects::curve::Waves;
use denavit_linear::products::{cross_gram, gram_of, subtract};
use denavit_linear::threads::in_parallel;
use denavit_linear::triangle::{Triangle, dot};
use denavit_model::nalgebra::DMatrix;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::collections::{BTreeMap, HashMap, HashSet};
use std::ops::Range;

/// Logarithm of the prior odds against a curve of a joint, as in [`crate::infer::curves`]: 1 in 100.
const CURVE: f64 = 4.6;
/// Logarithm of the prior odds against a cause outside the catalogue: 1 in 10 000; with less it would replace causes that the
/// catalogue has.
const UNNAMED: f64 = 9.2;
/// Largest number of single changes from one start; the search ends earlier if no change improves the score.
const MOST_ROUNDS: usize = 12;
/// Sets this far behind the best have negligible mass.
const BEHIND: f64 = 30.0;
/// Beyond this a product of several ratios might overflow.
const LARGE: f64 = 1e150;
/// Scores that differ by no more are the same.
const ROUNDING: f64 = 1e-9;
/// Added precision that holds geometry and frames if the rows do not determine them.
const HELD: f64 = 1e-9;
/// Largest number of settings: each costs a factorisation of everything except the candidates.
const MOST_SETTINGS: usize = 60;

/// A candidate among the plain columns.
#[derive(Debug, Clone, PartialEq)]
pub struct Member {
    /// Its columns.
    pub columns: Range<usize>,
    /// Logarithm of its prior odds against being absent.
    pub log_odds: f64,
    /// Its prior precision is at least this.
    pub least_precision: f64,
}

/// Unexplained structure: columns that are in the model together, with one of several prior variances.
#[derive(Debug, Clone, PartialEq)]
pub struct Unnamed {
    /// Its columns.
    pub columns: Vec<usize>,
}

/// Prior variance of a cause, as multiples of the unit-information variance.
const WIDTHS: [f64; 5] = [1.0, 10.0, 100.0, 1e3, 1e4];
/// Prior variance of a structure's contribution to one value, in units of the noise; column by column.
pub const SIZES: [f64; 4] = [1e-3, 1e-2, 1e-1, 1.0];

/// What is in the model besides geometry, frames and candidates: curves and unexplained structure.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Setting {
    /// For each curve: 0, or one more than the index of its kernel.
    pub curves: Vec<usize>,
    /// The structure and its size, if there is one.
    pub unnamed: Option<(usize, usize)>,
}

/// Everything needed to score sets.
#[derive(Debug, Clone)]
pub struct Contest<'a> {
    /// Columns of geometry and frames.
    pub always: usize,
    /// Prior precision of the plain columns; of candidates and structure on its diagonal.
    pub precision: &'a DMatrix<f64>,
    /// Gradient of the prior for the plain columns.
    pub pull: &'a [f64],
    /// Its cost at the present state.
    pub charge: f64,
    /// Waves of each curve.
    pub waves: &'a [Waves],
    /// Their means over the rows, which are constrained to 0.
    pub means: &'a [Vec<f64>],
    /// Precision of that constraint.
    pub firm: &'a [f64],
    /// Kernels that each curve may have.
    pub kernels: &'a [Vec<Kernel>],
    /// Unexplained structures.
    pub unnamed: &'a [Unnamed],
    /// The candidates.
    pub members: &'a [Member],
}

/// The candidates' products after elimination of everything else in a setting.
#[derive(Debug, Clone)]
pub struct Marginal {
    /// Products of all candidates' columns.
    schur: Vec<f64>,
    right: Vec<f64>,
    width: usize,
    /// Half the logarithms of the determinants.
    base: f64,
    left: f64,
    count: f64,
}

/// Geometry, frames, curves and structure of a setting: their columns, their products plus the prior, and their prior odds.
struct Fixed {
    index: Vec<usize>,
    /// Lower triangle, row by row.
    matrix: Vec<f64>,
    right: Vec<f64>,
    log_prior: f64,
    odds: f64,
}

/// Every set seen, with its best score and the setting of that score.
pub type Seen = BTreeMap<Vec<usize>, (f64, usize)>;

impl Contest<'_> {
    /// No curve and no structure.
    pub fn bare(&self) -> Setting {
        Setting { curves: vec![0; self.waves.len()], unnamed: None }
    }

    /// Everything of a setting but the candidates, with its prior.
    fn held(&self, gram: &Gram, setting: &Setting) -> Fixed {
        let mut index: Vec<usize> = (0..self.always).collect();
        let mut prior = vec![0.0; self.always];
        let mut log_prior = 0.0;
        // Prior odds of curves and unexplained structure.
        let mut odds = 0.0;
        if let Some((structure, size)) = setting.unnamed {
            odds -= UNNAMED + ((self.unnamed.len() * SIZES.len()) as f64).ln();
            for &column in &self.unnamed[structure].columns {
                let precision = self.precision[(column, column)] / SIZES[size];
                index.push(column);
                prior.push(precision);
                log_prior += precision.ln();
            }
        }
        let mut first = gram.plain;
        let mut curves: Vec<(Range<usize>, usize)> = Vec::new();
        for (curve, waves) in self.waves.iter().enumerate() {
            if let Some(kernel) = setting.curves[curve].checked_sub(1) {
                odds -= CURVE + (self.waves.len() as f64).ln();
                let from = index.len();
                let mut sum = 0.0;
                let variances = self.kernels[curve][kernel].variances(waves);
                // Prior and posterior are equal for waves that the data do not determine.
                let seen = waves_seen(&variances, |wave| gram.cell(first + wave, first + wave));
                for (offset, (variance, _)) in variances.into_iter().take(seen).enumerate() {
                    index.push(first + offset);
                    prior.push(1.0 / variance);
                    log_prior -= variance.ln();
                    sum += self.means[curve][offset].powi(2) * variance;
                }
                log_prior += (1.0 + self.firm[curve] * sum).ln();
                curves.push((from..index.len(), curve));
            }
            first += waves.len();
        }
        let size = index.len();
        let mut matrix = vec![0.0; size * size];
        for i in 0..size {
            for k in 0..=i {
                matrix[i * size + k] = gram.cell(index[i], index[k]);
            }
            matrix[i * size + i] += prior[i];
        }
        for i in 0..self.always {
            for k in 0..=i {
                matrix[i * size + k] += self.precision[(i, k)];
            }
        }
        for (range, curve) in curves {
            for i in range.clone() {
                let pull = self.firm[curve] * self.means[curve][i - range.start];
                for k in range.start..=i {
                    matrix[i * size + k] += pull * self.means[curve][k - range.start];
                }
            }
        }
        let right: Vec<f64> =
            (0..size).map(|i| gram.right[index[i]] + if i < self.always { self.pull[i] } else { 0.0 }).collect();
        Fixed { index, matrix, right, log_prior, odds }
    }

    /// Eliminates everything of a setting from the candidates' products; `None` if the system is not positive definite.
    ///
    /// A part of the run may have no or too few rows of a setup: the instrument is then held in its place.
    pub fn ground(&self, gram: &Gram, setting: &Setting) -> Option<Marginal> {
        self.ground_held(gram, setting, 0.0).or_else(|| self.ground_held(gram, setting, HELD))
    }

    /// The same with `more` added to the diagonal of geometry and frames, which is scaled to 1.
    fn ground_held(&self, gram: &Gram, setting: &Setting, more: f64) -> Option<Marginal> {
        let Fixed { index, mut matrix, right, log_prior, odds } = self.held(gram, setting);
        let size = index.len();
        let scale_of = |own: f64| if own > 0.0 { own.powf(-0.5) } else { 1.0 };
        let scale: Vec<f64> = (0..size).map(|i| scale_of(matrix[i * size + i])).collect();
        for i in 0..size {
            for k in 0..=i {
                matrix[i * size + k] *= scale[i] * scale[k];
            }
            if i < self.always {
                matrix[i * size + i] += more;
            }
        }
        let factor = Triangle::factor(matrix, size)?;
        let log_scale: f64 = scale.iter().map(|scale| scale.ln()).sum();
        let base = odds + 0.5 * (log_prior - factor.log_determinant() + 2.0 * log_scale);
        let right: Vec<f64> = right.iter().zip(&scale).map(|(right, scale)| right * scale).collect();
        let half = factor.forward(&right);
        let columns: Vec<usize> = self.members.iter().flat_map(|member| member.columns.clone()).collect();
        let along = columns
            .iter()
            .flat_map(|&column| index.iter().zip(&scale).map(move |(&own, scale)| gram.cell(own, column) * scale));
        let shares = factor.forward_all(along.collect());
        let width = columns.len();
        let mut schur = gram_of(&shares, size);
        for (cells, &column) in schur.chunks_exact_mut(width.max(1)).zip(&columns) {
            cells.iter_mut().zip(&columns).for_each(|(cell, &other)| *cell = gram.cell(column, other) - *cell);
        }
        let right = cross_gram(&half, &shares, size);
        let right = columns.iter().zip(right).map(|(&column, share)| gram.right[column] - share).collect();
        let left = gram.square + self.charge - dot(&half, &half);
        (left > 0.0 && base.is_finite()).then_some(Marginal { schur, right, width, base, left, count: gram.count })
    }

    /// The score of a set at a setting.
    pub fn at(&self, ground: &Marginal, set: &[usize]) -> f64 {
        self.asked(set).score(ground, &mut Vec::new())
    }

    /// The columns and priors of a set, to be scored at a setting.
    fn asked(&self, set: &[usize]) -> ColumnSet {
        // Members' columns follow each other among the candidates' products.
        let first = self.members.first().map_or(0, |member| member.columns.start);
        let mut asked = ColumnSet { columns: Vec::new(), precisions: Vec::new(), odds: 0.0 };
        for member in set.iter().map(|&member| &self.members[member]) {
            asked.odds += member.log_odds;
            for column in member.columns.clone() {
                asked.columns.push(column - first);
                asked.precisions.push((self.precision[(column, column)], member.least_precision));
            }
        }
        asked
    }

    /// The model of a set at a setting, with the best width of its prior, for predictions.
    pub fn system(&self, gram: &Gram, (ground, setting): (&Marginal, &Setting), set: &[usize]) -> (Vec<usize>, System) {
        let asked = self.asked(set);
        let at = |width: f64| (asked.at_width(ground, width, &mut Vec::new()), width);
        let best = WIDTHS.into_iter().map(at).max_by(|a, b| a.0.total_cmp(&b.0));
        let width = best.map_or(1.0, |(_, width)| width);
        let mut held = self.held(gram, setting);
        let before = held.index.len();
        held.index.extend(set.iter().flat_map(|&member| self.members[member].columns.clone()));
        held.right.extend(held.index[before..].iter().map(|&column| gram.right[column]));
        let size = held.index.len();
        let mut matrix = vec![0.0; size * size];
        for i in 0..size {
            if i < before {
                matrix[i * size..=i * size + i].copy_from_slice(&held.matrix[i * before..=i * before + i]);
                continue;
            }
            for k in 0..=i {
                matrix[i * size + k] = gram.cell(held.index[i], held.index[k]);
            }
            matrix[i * size + i] += asked.precision(i - before, width);
        }
        (held.index, System { matrix, right: held.right, square: gram.square + self.charge, count: gram.count })
    }

    /// The score of a set at its best setting.
    pub fn best<'g>(&self, grounds: impl IntoIterator<Item = &'g Marginal>, set: &[usize]) -> (f64, usize) {
        let (asked, mut room) = (self.asked(set), Vec::new());
        let scores = grounds.into_iter().enumerate().map(|(index, ground)| (asked.score(ground, &mut room), index));
        scores.max_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or((f64::NEG_INFINITY, 0))
    }

    /// Hill climbing from each start by the best single change: add, drop or swap a member. Every set on the way is kept.
    pub fn climbed<'s>(&self, grounds: &[Marginal], starts: impl IntoIterator<Item = &'s Vec<usize>>) -> Seen {
        self.way(grounds, starts, Some(Seen::new())).seen.unwrap_or_default()
    }

    /// The best set found in this way, with changes scored only at the best setting of the set that is changed. Other sets are not kept, so
    /// scores that are no better than the present one need not be computed. Empty if no setting can be solved.
    pub fn best_from(&self, grounds: &[Marginal], starts: &[Vec<usize>]) -> Vec<usize> {
        if grounds.is_empty() {
            return Vec::new();
        }
        self.way(grounds, starts, None).best.map_or_else(Vec::new, |(_, set)| set)
    }

    fn way<'s>(
        &self,
        grounds: &[Marginal],
        starts: impl IntoIterator<Item = &'s Vec<usize>>,
        seen: Option<Seen>,
    ) -> Visited {
        let members = (0..self.members.len()).map(|member| self.asked(&[member])).collect();
        let mut way = Visited::new(members, grounds.len(), seen);
        starts.into_iter().for_each(|start| self.hill_climb(grounds, &mut way, start));
        way
    }

    /// The same from one start, until it meets the path of another.
    fn hill_climb(&self, grounds: &[Marginal], way: &mut Visited, start: &[usize]) {
        let mut set = start.to_vec();
        set.sort_unstable();
        let mut key = way.key_of(&set);
        let (mut here, mut at) = self.scored(grounds, way, (&set, key));
        let mut swapping = false;
        for _ in 0..MOST_ROUNDS {
            if !swapping && !way.been.insert(key) {
                break;
            }
            let mut best: Option<(f64, Change)> = None;
            for (change, score) in self.looked_at((grounds, at), way, (&set, key, here), swapping) {
                if score > here + ROUNDING && best.as_ref().is_none_or(|(most, _)| score > *most) {
                    best = Some((score, change));
                }
            }
            match best {
                Some((_, change)) => {
                    (key, set, swapping) = (way.key_after(key, change), change.of(&set), false);
                    (here, at) = self.scored(grounds, way, (&set, key));
                }
                // There are many swaps: they are tried only if nothing else helps.
                None if swapping => break,
                None => swapping = true,
            }
        }
    }

    /// The score of a set with its key, and the one setting at which its changes are scored, where not all that is seen is kept.
    fn scored(&self, grounds: &[Marginal], way: &mut Visited, (set, key): (&[usize], u64)) -> (f64, Option<usize>) {
        let all_kept = way.seen.is_some();
        if all_kept && let Some(score) = way.score_above(key, f64::NEG_INFINITY) {
            return (score, None);
        }
        let scored = self.best(grounds, set);
        way.keep(key, scored, f64::NEG_INFINITY, || set.to_vec());
        (scored.0, (!all_kept).then_some(scored.1))
    }

    /// Scores all sets that differ from one set (given with key and score) by one member added or dropped, or by one member swapped, at one
    /// setting or at the best of all. If the sets on the way are not kept, a set that is no better may get any score that is no better.
    fn looked_at(
        &self,
        (grounds, at): (&[Marginal], Option<usize>),
        way: &mut Visited,
        (set, key, here): (&[usize], u64, f64),
        swapping: bool,
    ) -> Vec<(Change, f64)> {
        let (grounds, key) = match at {
            Some(ground) => (&grounds[ground..=ground], key ^ way.keys_of_grounds[ground]),
            None => (grounds, key),
        };
        let least = if way.seen.is_some() { f64::NEG_INFINITY } else { here };
        let absent: Vec<usize> = (0..self.members.len()).filter(|member| !set.contains(member)).collect();
        let mut changes: Vec<Change> = Vec::new();
        if swapping {
            let others = |&own: &usize| absent.iter().map(move |&other| Change { out: Some(own), into: Some(other) });
            changes.extend(set.iter().flat_map(others));
        } else {
            changes.extend(absent.iter().map(|&other| Change { out: None, into: Some(other) }));
            changes.extend(set.iter().map(|&own| Change { out: Some(own), into: None }));
        }
        let known = |change: &Change| way.score_above(way.key_after(key, *change), least);
        let known: Vec<Option<f64>> = changes.iter().map(known).collect();
        let unknown = changes.iter().zip(&known).filter(|(_, known)| known.is_none());
        let asked: Vec<Change> = unknown.map(|(change, _)| *change).collect();
        let mut new = self.changed(grounds, &way.members, set, &asked, least).into_iter();
        let mut scores = Vec::with_capacity(changes.len());
        for (change, known) in changes.into_iter().zip(known) {
            let score = known.or_else(|| {
                let scored = new.next()?;
                way.keep(way.key_after(key, change), scored, least, || change.of(set));
                Some(scored.0)
            });
            scores.push((change, score.unwrap_or(f64::NEG_INFINITY)));
        }
        scores
    }

    /// The scores of a set after each of these changes, at its best setting: the set is eliminated once, and a dropped member's share is
    /// restored. A score that is not above `least` may be replaced by any other that is not.
    fn changed(
        &self,
        grounds: &[Marginal],
        members: &[ColumnSet],
        set: &[usize],
        changes: &[Change],
        least: f64,
    ) -> Vec<(f64, usize)> {
        if changes.is_empty() {
            return Vec::new();
        }
        let (own, nothing) = (self.asked(set), self.asked(&[]));
        let asked = |member: Option<usize>| member.map_or(&nothing, |member| &members[member]);
        let odds = |change: &Change| {
            let (out, into) = (asked(change.out), asked(change.into));
            let columns = own.columns.len() + into.columns.len() - out.columns.len();
            own.odds - out.odds + into.odds - price_of_width(columns)
        };
        let odds: Vec<f64> = changes.iter().map(odds).collect();
        let at_ground = |ground: &Marginal| -> Vec<f64> {
            // Largest square of the data that remains if a score is above `least`, determinants ignored.
            let most_left: Vec<f64> = odds.iter().map(|odds| ground.most_left(least - odds)).collect();
            let (mut best, mut room) = (vec![f64::NEG_INFINITY; changes.len()], Vec::new());
            for &width in own.widths_near(ground, &mut room) {
                let Some(taken) = own.taken(ground, width) else { continue };
                let mut first = 0;
                for alike in changes.chunk_by(|a, b| a.out == b.out) {
                    let of_these = first..first + alike.len();
                    first += alike.len();
                    let bare = alike.iter().all(|change| change.into.is_none());
                    let left = alike[0].out.map(|out| taken.leaving_out(own.places_of(&members[out]), !bare));
                    let left = match &left {
                        Some(fewer) => fewer.as_ref(),
                        None => Some(&taken.left),
                    };
                    let Some(left) = left else { continue };
                    let price = (left.log_determinant / ground.count).exp();
                    for ((best, change), most_left) in
                        best[of_these.clone()].iter_mut().zip(alike).zip(&most_left[of_these])
                    {
                        *best = best.max(taken.with(left, asked(change.into), most_left / price, &mut room));
                    }
                }
            }
            best.iter().zip(&odds).map(|(best, odds)| best + odds).collect()
        };
        let scores = in_parallel(grounds, at_ground);
        let best = |change: usize| {
            let each = scores.iter().enumerate().map(|(index, scores)| (scores[change], index));
            each.max_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or((f64::NEG_INFINITY, 0))
        };
        (0..changes.len()).map(best).collect()
    }

    /// Initial settings: every curve with one of its kernels or none, one curve less, and structure of every size.
    fn first_settings(&self) -> Vec<Setting> {
        let most = self.kernels.iter().map(Vec::len).max().unwrap_or(0);
        let mut settings = vec![self.bare()];
        for kernel in 1..=most {
            let curves: Vec<usize> =
                self.kernels.iter().map(|own| if kernel <= own.len() { kernel } else { 0 }).collect();
            for curve in 0..curves.len() {
                let mut less = curves.clone();
                less[curve] = 0;
                settings.push(Setting { curves: less, unnamed: None });
            }
            settings.push(Setting { curves, unnamed: None });
        }
        settings
    }

    /// Searches from several starts, and finds the best settings of the probable sets.
    ///
    /// Returns every set seen, and the settings with the candidates' products after elimination.
    pub fn run(&self, gram: &Gram, starts: &[Vec<usize>]) -> (Seen, Vec<(Marginal, Setting)>) {
        let mut settings: Vec<Setting> = Vec::new();
        let mut grounds: Vec<Marginal> = Vec::new();
        self.add(gram, &self.first_settings(), &mut settings, &mut grounds);
        let (mut seen, mut known) = (Seen::new(), 0);
        if grounds.is_empty() {
            return (seen, Vec::new());
        }
        for _ in 0..3 {
            seen = self.climbed(&grounds, starts.iter().chain([&Vec::new()]));
            known = settings.len();
            // The best set, the best without each of its members, and none.
            let mut which = rivals_of_best(&seen);
            which.push(Vec::new());
            for set in which {
                let (mut score, mut at) = self.best(&grounds, &set);
                for axis in 0..=self.kernels.len() {
                    let next = self.neighbours(&settings[at], axis);
                    for index in self.add(gram, &next, &mut settings, &mut grounds) {
                        let found = self.at(&grounds[index], &set);
                        if found > score {
                            (score, at) = (found, index);
                        }
                    }
                }
            }
            if settings.len() == known {
                break;
            }
        }
        // All probable sets at the last settings, too.
        let most = seen.values().map(|(score, _)| *score).fold(f64::NEG_INFINITY, f64::max);
        let mut near: Vec<(&Vec<usize>, &mut (f64, usize))> =
            seen.iter_mut().filter(|(_, scored)| scored.0 > most - 2.0 * BEHIND).collect();
        let last = &grounds[known..];
        let scores = in_parallel(if last.is_empty() { &[] } else { &near[..] }, |(set, _)| self.best(last, set));
        for ((_, scored), (score, setting)) in near.iter_mut().zip(scores) {
            if score > scored.0 {
                **scored = (score, known + setting);
            }
        }
        (seen, grounds.into_iter().zip(settings).collect())
    }

    /// Adds settings that are not yet known, with the candidates' products after elimination, up to the largest number; returns the index of
    /// each.
    fn add(
        &self,
        gram: &Gram,
        wanted: &[Setting],
        settings: &mut Vec<Setting>,
        grounds: &mut Vec<Marginal>,
    ) -> Vec<usize> {
        let place = |settings: &[Setting], wanted: &Setting| settings.iter().position(|other| other == wanted);
        let mut new: Vec<Setting> = Vec::new();
        for setting in wanted {
            let room = settings.len() + new.len() < MOST_SETTINGS;
            if room && place(settings, setting).or(place(&new, setting)).is_none() {
                new.push(setting.clone());
            }
        }
        let made = in_parallel(&new, |setting| self.ground(gram, setting));
        for (setting, ground) in new.into_iter().zip(made) {
            if let Some(ground) = ground {
                settings.push(setting);
                grounds.push(ground);
            }
        }
        wanted.iter().filter_map(|setting| place(settings, setting)).collect()
    }

    /// Settings that differ in the structure (axis 0) or in one curve (the axes after it).
    fn neighbours(&self, setting: &Setting, axis: usize) -> Vec<Setting> {
        let mut list = Vec::new();
        if let Some(curve) = axis.checked_sub(1) {
            for kernel in 0..=self.kernels[curve].len() {
                let mut next = setting.clone();
                next.curves[curve] = kernel;
                list.push(next);
            }
        } else {
            list.push(Setting { unnamed: None, ..setting.clone() });
            let sizes =
                (0..self.unnamed.len()).flat_map(|structure| (0..SIZES.len()).map(move |size| (structure, size)));
            list.extend(sizes.map(|unnamed| Setting { unnamed: Some(unnamed), ..setting.clone() }));
        }
        list.retain(|other| other != setting);
        list
    }
}

/// A member that leaves a set, one that comes into it.
#[derive(Debug, Clone, Copy)]
struct Change {
    out: Option<usize>,
    into: Option<usize>,
}

/// What is known of the score of a set.
#[derive(Clone, Copy)]
enum Known {
    Exactly(f64),
    AtMost(f64),
}

/// Records of a search: scores and sets that were visited.
struct Visited {
    /// Columns and priors of each member.
    members: Vec<ColumnSet>,
    /// A random number for each member; a set's key is the exclusive or of its members' numbers. Collisions are negligible.
    keys: Vec<u64>,
    /// The same for each ground: scores at a single ground are stored under the set's key combined with that number.
    keys_of_grounds: Vec<u64>,
    /// Of every set that was scored.
    scores: HashMap<u64, Known>,
    /// Sets that changes were made from.
    been: HashSet<u64>,
    best: Option<(f64, Vec<usize>)>,
    /// Every set that was scored, if requested.
    seen: Option<Seen>,
}

impl Visited {
    fn new(members: Vec<ColumnSet>, grounds: usize, seen: Option<Seen>) -> Self {
        let mut random = ChaCha8Rng::seed_from_u64(0);
        let mut keys = |count: usize| (0..count).map(|_| random.random()).collect();
        let (keys, keys_of_grounds) = (keys(members.len()), keys(grounds));
        Self { members, keys, keys_of_grounds, scores: HashMap::new(), been: HashSet::new(), best: None, seen }
    }

    fn key_of(&self, set: &[usize]) -> u64 {
        set.iter().fold(0, |key, &member| key ^ self.keys[member])
    }

    fn key_after(&self, key: u64, change: Change) -> u64 {
        [change.out, change.into].into_iter().flatten().fold(key, |key, member| key ^ self.keys[member])
    }

    /// The score of a set, if known; a score that is not above `least` may be replaced by any other that is not.
    fn score_above(&self, key: u64, least: f64) -> Option<f64> {
        match *self.scores.get(&key)? {
            Known::Exactly(score) => Some(score),
            Known::AtMost(most) => (most <= least).then_some(f64::NEG_INFINITY),
        }
    }

    /// Stores the score and the best setting of a set; a score that is not above `least` may be replaced by any other that is not.
    fn keep(&mut self, key: u64, scored: (f64, usize), least: f64, set: impl Fn() -> Vec<usize>) {
        self.scores.insert(key, if scored.0 > least { Known::Exactly(scored.0) } else { Known::AtMost(least) });
        if self.best.as_ref().is_none_or(|(most, _)| scored.0 > *most) {
            self.best = Some((scored.0, set()));
        }
        if let Some(seen) = &mut self.seen {
            seen.insert(set(), scored);
        }
    }
}

impl Change {
    /// The set after it, in order.
    fn of(self, set: &[usize]) -> Vec<usize> {
        let mut set: Vec<usize> = set.iter().copied().filter(|member| Some(*member) != self.out).collect();
        if let Some(into) = self.into {
            set.insert(set.partition_point(|other| *other < into), into);
        }
        set
    }
}

/// Penalty for choosing the width of the prior of this number of coefficients.
fn price_of_width(columns: usize) -> f64 {
    if columns == 0 { 0.0 } else { (WIDTHS.len() as f64).ln() }
}

/// The columns of a set, and their priors.
struct ColumnSet {
    /// Among the candidates' products.
    columns: Vec<usize>,
    /// For each column the unit-information precision, and the least precision.
    precisions: Vec<(f64, f64)>,
    /// Logarithm of the set's prior odds.
    odds: f64,
}

impl ColumnSet {
    /// Prior precision of a coefficient. A cause may be far stronger than what one row shows of it, so the width of the prior is
    /// chosen by empirical Bayes (the g of Zellner's prior; George, Foster 2000), one width for all.
    fn precision(&self, column: usize, width: f64) -> f64 {
        let (unit, least) = self.precisions[column];
        (unit / width).max(least)
    }

    /// The score at a setting with the best width of the prior, less the penalty for that choice; `room` is a reused buffer.
    fn score(&self, ground: &Marginal, room: &mut Vec<f64>) -> f64 {
        if self.columns.is_empty() {
            return ground.score(0.0, 0.0) + self.odds;
        }
        let best = WIDTHS.iter().map(|&width| self.at_width(ground, width, room)).fold(f64::NEG_INFINITY, f64::max);
        best - price_of_width(self.columns.len())
    }

    /// The widths to try after a single change: the present best and its neighbours; all if the set is empty.
    fn widths_near(&self, ground: &Marginal, room: &mut Vec<f64>) -> &'static [f64] {
        if self.columns.is_empty() {
            return &WIDTHS;
        }
        let scores = WIDTHS.iter().map(|&width| self.at_width(ground, width, room)).enumerate();
        let (suits, _) = scores.max_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or_default();
        &WIDTHS[suits.saturating_sub(1)..(suits + 2).min(WIDTHS.len())]
    }

    /// The same with a prior of this width.
    fn at_width(&self, ground: &Marginal, width: f64, room: &mut Vec<f64>) -> f64 {
        let of = |i: usize| self.columns[i];
        let product = |i: usize, k: usize| ground.schur[of(i) * ground.width + of(k)];
        let explained = self.explained(width, product, |i| ground.right[of(i)], room);
        explained.map_or(f64::NEG_INFINITY, |own| ground.score(own.drop, own.log_determinant()) + self.odds)
    }

    /// How much the columns explain, with S and r from these closures; `None` if the system is not positive definite.
    fn explained(
        &self,
        width: f64,
        product: impl Fn(usize, usize) -> f64,
        right: impl Fn(usize) -> f64,
        room: &mut Vec<f64>,
    ) -> Option<Explained> {
        // Cholesky's factor of S + P, row by row, followed by L⁻¹ r.
        let count = self.columns.len();
        room.clear();
        room.resize(count * (count + 1), 0.0);
        let (rows, halves) = room.split_at_mut(count * count);
        // The logarithm is taken of a product, before it overflows.
        let (mut drop, mut log_determinant, mut ratios) = (0.0, 0.0, 1.0_f64);
        for i in 0..count {
            let precision = self.precision(i, width);
            let (before, row) = rows.split_at_mut(i * count);
            let row = &mut row[..count];
            for (k, earlier) in before.chunks_exact(count).enumerate() {
                let known: f64 = row[..k].iter().zip(&earlier[..k]).map(|(a, b)| a * b).sum();
                row[k] = (product(i, k) - known) / earlier[k];
            }
            let left = product(i, i) + precision - row[..i].iter().map(|cell| cell * cell).sum::<f64>();
            if left <= 0.0 {
                return None;
            }
            row[i] = left.sqrt();
            let known: f64 = row[..i].iter().zip(&halves[..i]).map(|(a, b)| a * b).sum();
            halves[i] = (right(i) - known) / row[i];
            drop += halves[i] * halves[i];
            ratios *= left / precision;
            if ratios > LARGE {
                log_determinant += ratios.ln();
                ratios = 1.0;
            }
        }
        Some(Explained { drop, log_determinant, ratios })
    }
}

/// How much columns explain, and their cost log |S + P| - log |P|; a part of it is kept as its exponential, as logarithms take most
/// of the time.
struct Explained {
    drop: f64,
    log_determinant: f64,
    ratios: f64,
}

impl Explained {
    fn log_determinant(&self) -> f64 {
        self.log_determinant + self.ratios.ln()
    }
}

/// All candidates' products after elimination of a set, at one setting and one width of the prior: the [`Marginal`] given that set.
struct Downdated<'a> {
    set: &'a ColumnSet,
    ground: &'a Marginal,
    width: f64,
    /// L⁻¹ times the products of the set's columns with all columns, column by column of the set; L is Cholesky's factor of S + P.
    shares: Vec<f64>,
    /// The factor's diagonal, and L⁻¹ r.
    pivots: Vec<f64>,
    halves: Vec<f64>,
    left: Remainder,
}

/// All candidates' products after elimination of a set.
#[derive(Clone)]
struct Remainder {
    /// For each column, its square and its product with the data after elimination of the set.
    square: Vec<f64>,
    right: Vec<f64>,
    /// And of its product with the column before it: most causes have one column or two.
    before: Vec<f64>,
    /// Shares that were restored, column by column.
    given_back: Vec<f64>,
    drop: f64,
    log_determinant: f64,
}

impl ColumnSet {
    /// None where the system is not positive.
    fn taken<'a>(&'a self, ground: &'a Marginal, width: f64) -> Option<Downdated<'a>> {
        let all = ground.width;
        let mut shares: Vec<f64> = Vec::with_capacity(self.columns.len() * all);
        let (mut pivots, mut halves) = (Vec::new(), Vec::new());
        let mut left = Remainder {
            square: (0..all).map(|k| ground.schur[k * all + k]).collect(),
            right: ground.right.clone(),
            before: (0..all).map(|k| if k > 0 { ground.schur[k * all + k - 1] } else { 0.0 }).collect(),
            given_back: Vec::new(),
            drop: 0.0,
            log_determinant: 0.0,
        };
        for (index, &own) in self.columns.iter().enumerate() {
            let mut share = ground.schur[own * all..(own + 1) * all].to_vec();
            let before: Vec<f64> = shares.chunks_exact(all).map(|other| other[own]).collect();
            subtract(&shares, &before, &mut share);
            let precision = self.precision(index, width);
            let square = left.square[own] + precision;
            if square <= 0.0 {
                return None;
            }
            let pivot = square.sqrt();
            let half = left.right[own] / pivot;
            for ((share, square), right) in share.iter_mut().zip(&mut left.square).zip(&mut left.right) {
                *share /= pivot;
                *square -= *share * *share;
                *right -= *share * half;
            }
            for (before, pair) in left.before.iter_mut().skip(1).zip(share.windows(2)) {
                *before -= pair[0] * pair[1];
            }
            shares.extend(share);
            pivots.push(pivot);
            halves.push(half);
            left.drop += half * half;
            left.log_determinant += (square / precision).ln();
        }
        Some(Downdated { set: self, ground, width, shares, pivots, halves, left })
    }

    /// Where the columns of one of its members are among its own.
    fn places_of(&self, member: &Self) -> Range<usize> {
        let from = member.columns.first().and_then(|first| self.columns.iter().position(|own| own == first));
        from.map_or(0..0, |from| from..from + member.columns.len())
    }
}

impl Remainder {
    /// Without the columns.
    fn bare(&self) -> Self {
        let (drop, log_determinant) = (self.drop, self.log_determinant);
        Self {
            square: Vec::new(),
            right: Vec::new(),
            before: Vec::new(),
            given_back: Vec::new(),
            drop,
            log_determinant,
        }
    }
}

impl Downdated<'_> {
    /// The same without some of the set's columns, given by their places in it. What they take beyond the others is the share along their
    /// columns of L⁻¹, made orthogonal; it is restored for the other columns that are needed. `None` if the system is not positive definite.
    fn leaving_out(&self, places: Range<usize>, others: bool) -> Option<Remainder> {
        let (all, count) = (self.ground.width, self.pivots.len());
        let mut left = if others { self.left.clone() } else { self.left.bare() };
        let mut roots: Vec<Vec<f64>> = Vec::with_capacity(places.len());
        for place in places {
            let mut root = vec![0.0; count];
            root[place] = 1.0 / self.pivots[place];
            for row in place + 1..count {
                let column = self.set.columns[row];
                let known: f64 = (place..row).map(|k| self.shares[k * all + column] * root[k]).sum();
                root[row] = -known / self.pivots[row];
            }
            for other in &roots {
                let share = dot(&root, other);
                root.iter_mut().zip(other).for_each(|(cell, other)| *cell -= share * other);
            }
            let norm = dot(&root, &root).sqrt();
            if norm.is_nan() || norm <= 0.0 {
                return None;
            }
            for cell in &mut root {
                *cell /= norm;
            }
            let half = dot(&root, &self.halves);
            if others {
                // Its sign does not matter.
                let mut back = vec![0.0; all];
                subtract(&self.shares, &root, &mut back);
                for ((back, square), right) in back.iter().zip(&mut left.square).zip(&mut left.right) {
                    *square += back * back;
                    *right -= back * half;
                }
                for (before, pair) in left.before.iter_mut().skip(1).zip(back.windows(2)) {
                    *before += pair[0] * pair[1];
                }
                left.given_back.extend(back);
            }
            left.drop -= half * half;
            left.log_determinant += (norm * norm * self.set.precision(place, self.width)).ln();
            roots.push(root);
        }
        Some(left)
    }

    /// The score with more columns, without prior odds; -∞ if the square of the data that remains is above `most_left`. `room` is a reused
    /// buffer.
    fn with(&self, left: &Remainder, other: &ColumnSet, most_left: f64, room: &mut Vec<f64>) -> f64 {
        let (all, of) = (self.ground.width, |i: usize| other.columns[i]);
        // A member's columns follow each other.
        let product = |i: usize, k: usize| match i - k {
            0 => left.square[of(i)],
            1 => left.before[of(i)],
            _ => {
                let sum =
                    |parts: &[f64]| -> f64 { parts.chunks_exact(all).map(|part| part[of(i)] * part[of(k)]).sum() };
                self.ground.schur[of(i) * all + of(k)] - sum(&self.shares) + sum(&left.given_back)
            }
        };
        let explained = other.explained(self.width, product, |i| left.right[of(i)], room);
        // Determinants only grow with more columns.
        explained
            .filter(|own| self.ground.left - (left.drop + own.drop) <= most_left)
            .map_or(f64::NEG_INFINITY, |own| {
                self.ground.score(left.drop + own.drop, left.log_determinant + own.log_determinant())
            })
    }
}

impl Marginal {
    /// The score if candidates explain so much more, with these determinants.
    fn score(&self, drop: f64, determinants: f64) -> f64 {
        let left = (self.left - drop) / self.count;
        if left <= 0.0 { f64::NEG_INFINITY } else { self.base - 0.5 * (self.count * left.ln() + determinants) }
    }

    /// Largest square of the data that remains if a score is above this one, determinants ignored.
    fn most_left(&self, score: f64) -> f64 {
        // A margin for rounding.
        self.count * (2.0 * (self.base + ROUNDING - score) / self.count).exp()
    }
}

/// The set with the best score; empty if there is none.
pub fn best_of(seen: &Seen) -> Vec<usize> {
    seen.iter().max_by(|a, b| a.1.0.total_cmp(&b.1.0)).map_or_else(Vec::new, |(set, _)| set.clone())
}

/// The best set, and for each of its members the best set without it.
pub fn rivals_of_best(seen: &Seen) -> Vec<Vec<usize>> {
    let mut order: Vec<(&Vec<usize>, f64)> = seen.iter().map(|(set, (score, _))| (set, *score)).collect();
    order.sort_by(|a, b| b.1.total_cmp(&a.1));
    let Some((best, _)) = order.first() else { return Vec::new() };
    let mut which: Vec<Vec<usize>> = vec![(*best).clone()];
    for member in *best {
        if let Some((other, _)) = order.iter().find(|(other, _)| !other.contains(member))
            && !which.contains(other)
        {
            which.push((*other).clone());
        }
    }
    which
}

#[cfg(test)]
impl<'a> Contest<'a> {
    /// Candidates with this number of columns of geometry and nothing else.
    pub(super) fn of_plain(always: usize, precision: &'a DMatrix<f64>, pull: &'a [f64], members: &'a [Member]) -> Self {
        Contest {
            always,
            precision,
            pull,
            charge: 0.0,
            waves: &[],
            means: &[],
            firm: &[],
            kernels: &[],
            unnamed: &[],
            members,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::infer::gram::Columns;
    use denavit_model::nalgebra::DVector;

    const VALUES: usize = 60;

    fn cell(value: usize, k: usize) -> f64 {
        ((value * 7 + k * 13) as f64 * 0.61).sin() + 0.3 * ((value * k + 3) as f64 * 1.7).cos()
    }

    fn scores_after_changes_are_those_of_the_sets(contest: &Contest<'_>, grounds: &[Marginal], set: &[usize]) {
        let members = [None, Some(0), Some(1), Some(2), Some(3)];
        let asked: Vec<ColumnSet> = (0..4).map(|member| contest.asked(&[member])).collect();
        let outs = members.iter().filter(|out| out.is_none_or(|out| set.contains(&out)));
        let changes: Vec<Change> = outs
            .flat_map(|&out| members.iter().map(move |&into| Change { out, into }))
            .filter(|change| change.into.is_none_or(|into| !set.contains(&into)))
            .collect();
        for (change, found) in changes.iter().zip(contest.changed(grounds, &asked, set, &changes, f64::NEG_INFINITY)) {
            let whole = contest.at(&grounds[0], &change.of(set));
            assert!((found.0 - whole).abs() < 1e-9, "{set:?} {change:?}: {} {whole}", found.0);
        }
    }

    /// Two columns of geometry, three candidates of one column and one of two, two columns of structure, a curve; the data hold the second
    /// candidate.
    #[test]
    fn scores_are_those_of_the_covariance_written_out_and_the_truth_wins() {
        let plain: Vec<Vec<f64>> = (0..9).map(|k| (0..VALUES).map(|value| cell(value, k + 1)).collect()).collect();
        let joint: Vec<f64> = (0..VALUES).map(|value| cell(value, 11)).collect();
        let explained: Vec<f64> =
            (0..VALUES).map(|value| 2.0 * plain[0][value] + 1.2 * plain[3][value] + 0.3 * cell(value, 29)).collect();
        let waves = [Waves::over(0.0, 1.0, false, 12.0, 5)];
        let readings = vec![(0..VALUES).map(|row| 0.5 + 0.4 * cell(row, 17)).collect::<Vec<f64>>()];
        let rows: Vec<usize> = (0..VALUES).collect();
        let borrowed: Vec<&[f64]> = plain.iter().map(Vec::as_slice).collect();
        let columns = Columns {
            explained: &explained,
            plain: &borrowed,
            joints: &[&joint],
            rows: &rows,
            weights: &[1.0; VALUES],
        };
        let gram = Gram::of(&columns, &waves, &readings);
        let precision = DMatrix::from_diagonal(&DVector::from_fn(9, |k, _| 0.1 + 0.05 * k as f64));
        // Of the second one the data do not see the fast waves.
        let kernels =
            vec![vec![Kernel { log_variance: -1.0, log_length: -1.5 }, Kernel { log_variance: -1.0, log_length: 0.0 }]];
        let member = |columns: Range<usize>| Member { columns, log_odds: -2.0, least_precision: 0.0 };
        let members = [2..3, 3..4, 4..5, 5..7].map(member);
        let unnamed = [Unnamed { columns: vec![7, 8] }];
        let contest = Contest {
            always: 2,
            precision: &precision,
            pull: &[0.0; 9],
            charge: 0.0,
            waves: &waves,
            means: &[vec![0.0; waves[0].len()]],
            firm: &[0.0],
            kernels: &kernels,
            unnamed: &unnamed,
            members: &members,
        };
        let at_width = |setting: &Setting, set: &[usize], width: f64| -> f64 {
            let mut covariance = DMatrix::<f64>::identity(VALUES, VALUES);
            let mut add = |column: &dyn Fn(usize) -> f64, variance: f64| {
                let column = DVector::from_fn(VALUES, |value, _| column(value));
                covariance += &column * column.transpose() * variance;
            };
            for k in 0..2 {
                add(&|value| plain[k][value], 1.0 / precision[(k, k)]);
            }
            for k in set.iter().flat_map(|&member| members[member].columns.clone()) {
                add(&|value| plain[k][value], width / precision[(k, k)]);
            }
            if let Some((_, size)) = setting.unnamed {
                for k in 7..9 {
                    add(&|value| plain[k][value], SIZES[size] / precision[(k, k)]);
                }
            }
            if setting.curves[0] > 0 {
                let kernel = kernels[0][setting.curves[0] - 1];
                for (k, (variance, _)) in kernel.variances(&waves[0]).into_iter().enumerate() {
                    add(&|value| joint[value] * waves[0].values(readings[0][value])[k], variance);
                }
            }
            let y = DVector::from_column_slice(&explained);
            let factor = covariance.cholesky().unwrap();
            let left = y.dot(&factor.solve(&y)) / VALUES as f64;
            let determinant: f64 = factor.l().diagonal().iter().map(|cell| 2.0 * cell.ln()).sum();
            let unnamed = setting.unnamed.map_or(0.0, |_| UNNAMED + (SIZES.len() as f64).ln());
            let odds = 2.0 * set.len() as f64 + unnamed + CURVE * setting.curves[0].min(1) as f64;
            -0.5 * (VALUES as f64 * left.ln() + determinant) - odds
        };
        let written = |setting: &Setting, set: &[usize]| -> f64 {
            if set.is_empty() {
                return at_width(setting, set, 1.0);
            }
            let widths = WIDTHS.iter().map(|width| at_width(setting, set, *width));
            widths.fold(f64::NEG_INFINITY, f64::max) - (WIDTHS.len() as f64).ln()
        };
        let bare = contest.bare();
        let full = Setting { curves: vec![1], unnamed: Some((0, 2)) };
        let reference = contest.at(&contest.ground(&gram, &bare).unwrap(), &[]) - written(&bare, &[]);
        let smooth = Setting { curves: vec![2], unnamed: None };
        assert!(contest.held(&gram, &smooth).index.len() < 2 + waves[0].len());
        for (setting, off) in
            [(bare, 1e-8), (Setting { curves: vec![1], unnamed: None }, 1e-8), (full, 1e-8), (smooth, 2e-2)]
        {
            let ground = contest.ground(&gram, &setting).unwrap();
            for set in [vec![], vec![1], vec![0, 2], vec![0, 1, 3]] {
                let found = contest.at(&ground, &set) - written(&setting, &set) - reference;
                assert!(found.abs() < off, "{setting:?} {set:?}: off by {found}");
            }
            let grounds = [ground];
            for set in [&[1][..], &[3], &[0, 2], &[1, 3], &[0, 1, 3]] {
                scores_after_changes_are_those_of_the_sets(&contest, &grounds, set);
            }
            // What is not worked out does not change what is best.
            let starts = [vec![0, 2], vec![0, 3], Vec::new()];
            assert_eq!(contest.best_from(&grounds, &starts), best_of(&contest.climbed(&grounds, &starts)));
            assert!(contest.best_from(&[], &starts).is_empty());
        }
        let (seen, settings) = contest.run(&gram, &[vec![0, 2]]);
        let (best, (_, at)) = seen.iter().max_by(|a, b| a.1.0.total_cmp(&b.1.0)).unwrap();
        assert_eq!((best.as_slice(), &settings[*at].1), (&[1][..], &contest.bare()));
    }

    /// Two columns of geometry, then two candidates of which the first acts; beside it the same with the frame of a setup that these rows lack.
    #[test]
    fn a_frame_of_which_nothing_was_measured_changes_no_choice() {
        let plain: Vec<Vec<f64>> = (0..4).map(|k| (0..VALUES).map(|value| cell(value, k)).collect()).collect();
        let explained: Vec<f64> =
            (0..VALUES).map(|value| plain[1][value] + 0.8 * plain[2][value] + 0.5 * cell(value, 40)).collect();
        let rows: Vec<usize> = (0..VALUES).collect();
        let score = |frame: &[Vec<f64>]| -> (Vec<f64>, Vec<usize>) {
            let columns: Vec<&[f64]> =
                plain[..2].iter().chain(frame).chain(&plain[2..]).map(std::vec::Vec::as_slice).collect();
            let given =
                Columns { explained: &explained, plain: &columns, joints: &[], rows: &rows, weights: &[1.0; VALUES] };
            let gram = Gram::of(&given, &[], &[]);
            let always = 2 + frame.len();
            let precision =
                DMatrix::from_fn(
                    always + 2,
                    always + 2,
                    |i, k| {
                        if i == k && !(2..always).contains(&i) { 0.01 } else { 0.0 }
                    },
                );
            let member = |k: usize| Member { columns: k..k + 1, log_odds: -2.0, least_precision: 0.0 };
            let members = [member(always), member(always + 1)];
            let pull = vec![0.0; always];
            let contest = Contest::of_plain(always, &precision, &pull, &members);
            let grounds = [contest.ground(&gram, &contest.bare()).unwrap()];
            let none = contest.at(&grounds[0], &[]);
            let scores = [vec![0], vec![1], vec![0, 1]].iter().map(|set| contest.at(&grounds[0], set) - none).collect();
            (scores, contest.best_from(&grounds, &[Vec::new(), vec![1]]))
        };
        let one_row = |value: f64| -> Vec<f64> { (0..VALUES).map(|row| if row == 0 { value } else { 0.0 }).collect() };
        let (expected, best) = score(&[]);
        assert_eq!(best, [0]);
        let (lacking, found) = score(&[vec![0.0; VALUES]]);
        assert_eq!(found, best);
        for (lacking, expected) in lacking.iter().zip(&expected) {
            assert!((lacking - expected).abs() < 1e-6, "{lacking} {expected}");
        }
        // Two directions of a frame that one row cannot tell apart.
        assert_eq!(score(&[one_row(1.0), one_row(2.0)]).1, best);
    }
}
