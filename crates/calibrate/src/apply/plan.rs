//! Which poses to measure: those that make the parameters best observable.
//!
//! D-optimal design: among candidate poses choose `count` that make det(Jᵀ J / noise² + P) largest, P the prior; greedily,
//! then by exchange (Fedorov 1972; Mitchell 1974, DETMAX) until no exchange helps.

pub mod next;
pub mod tell_apart;
mod written;

use denavit_identify::arm::{Arm, Perturbation, RowState};
use denavit_identify::gauge;
use denavit_identify::observe::{Seen, model_of};
use denavit_identify::parameters::{Freedom, Layout, NoEffects, Tolerances};
use denavit_identify::posterior::{Earlier, expecting};
use denavit_identify::prior::free_of_common_motions;
use denavit_identify::proportion::{OutOfProportion, TooManyJoints, can_be_identified, within_proportion};
use denavit_identify::residual::{ResidualModel, Scratch};
use denavit_identify::symmetric;
use denavit_measurements::kinds::ObservationKind;
use denavit_measurements::{Measurements, Scene};
use denavit_model::Chain;
use denavit_model::nalgebra::{DMatrix, Point3, Vector3};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde::Serialize;
use thiserror::Error;

/// What to plan for.
#[derive(Debug, Clone, PartialEq)]
pub struct PlanOptions {
    /// Number of poses.
    pub count: usize,
    /// What will be measured.
    pub kind: ObservationKind,
    /// Which parts of the arm will be fitted.
    pub freedom: Freedom,
    /// Candidate poses, one value per coordinate; `None`: spread over the joint limits.
    pub candidates: Option<Vec<Vec<f64>>>,
    /// How many to spread.
    pub spread: usize,
    /// Share of the joint range to keep away from each limit.
    pub margin: f64,
    /// Lowest and highest corner of the box in which the target must stay, base frame, m.
    pub allowed: Option<[Point3<f64>; 2]>,
    /// Where the target sits on the tip, m.
    pub target: Vector3<f64>,
    /// Where the anchor of a distance instrument stands, base frame, m.
    pub anchor: Vector3<f64>,
    /// Standard deviation of one measured component, m and rad alike.
    pub noise: f64,
    /// The prior.
    pub tolerances: Tolerances,
    /// The axes of an earlier calibration: poses are chosen for what they add to it.
    pub earlier: Option<Earlier>,
    /// Seed of the spread candidates and of the random poses that the plan is compared with.
    pub seed: u64,
}

impl PlanOptions {
    /// Every axis, candidates over the whole joint range, a target 0.1 m beside and before the tip.
    pub fn new(chain: &Chain, count: usize, kind: ObservationKind) -> Self {
        Self {
            count,
            kind,
            freedom: Freedom::axes(chain.joints().len()),
            candidates: None,
            spread: 1000,
            margin: 0.02,
            allowed: None,
            target: Vector3::new(0.1, 0.0, 0.1),
            anchor: Vector3::new(1.0, 1.0, 0.0) * chain.size(),
            noise: 5e-5,
            tolerances: Tolerances::default(),
            earlier: None,
            seed: 0,
        }
    }
}

/// Why there is no plan.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum PlanError {
    /// Fewer candidates than poses wanted.
    #[error(
        "{wanted} poses are wanted, but only {left} of {candidates} candidates are within the limits and the box; \
         allow more candidates or choose fewer poses"
    )]
    TooFewCandidates {
        /// Wanted.
        wanted: usize,
        /// Usable.
        left: usize,
        /// All.
        candidates: usize,
    },
    /// A robot larger than anything that is measured.
    #[error(transparent)]
    OutOfProportion(#[from] OutOfProportion),
    /// A chain of more joints than can be planned for.
    #[error(transparent)]
    TooManyJoints(#[from] TooManyJoints),
    /// The measurement holds the target in contact: postures are not chosen freely.
    #[error(
        "poses cannot be planned for {}: you choose them when you bring the target into contact; spread them as widely as the arm can",
        .0.plural()
    )]
    InContact(ObservationKind),
    /// Numbers of the robot that are too far apart in size.
    #[error(
        "the information of these poses cannot be computed: the lengths of the robot and the positions of the target or the anchor \
         differ too much in size; give them in m, and leave out what is not measured"
    )]
    Degenerate,
    /// A candidate of another length.
    #[error("candidate {row}: {found} values, but the chain has {expected} coordinates")]
    Length {
        /// Counted from 1.
        row: usize,
        /// Its values.
        found: usize,
        /// Coordinates.
        expected: usize,
    },
}

/// Observability indices of a set of poses, from the singular values s1 ≥ … ≥ sL > 0 of the identification Jacobian in
/// units of the tolerances, the common frame left out. An earlier calibration counts as additional rows: the squares of the singular
/// values are then the eigenvalues of Jᵀ J + noise² P.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Observability {
    /// (s1 ··· sL)^(1/L) / √poses (Borm, Menq 1991).
    pub o1: f64,
    /// sL / s1 (Driels, Pathre 1990).
    pub o2: f64,
    /// sL (Nahvi, Hollerbach, Hayward 1994).
    pub o3: f64,
    /// sL² / s1 (Nahvi, Hollerbach 1996).
    pub o4: f64,
    /// 1 / (1/s1 + … + 1/sL) (Sun, Hollerbach 2008).
    pub o5: f64,
    /// Number of singular values that count.
    pub rank: usize,
}

/// Poses to measure.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// Names of the coordinates.
    pub joints: Vec<String>,
    /// The poses, one value per coordinate, rad or m, in the order of the candidates.
    pub poses: Vec<Vec<f64>>,
    /// Their indices.
    pub observability: Observability,
    /// The same for as many candidates taken at random: means over [`RANDOM_SETS`] sets.
    pub at_random: Observability,
    /// Candidates that could be used.
    pub usable: usize,
    /// Exchanges made.
    pub exchanges: usize,
    /// Whether the indices include an earlier calibration.
    pub with_prior: bool,
}

/// Sets of random poses that a plan is compared with.
pub const RANDOM_SETS: usize = 10;
/// Below this share of the largest a singular value counts as zero.
const RANK_TOLERANCE: f64 = 1e-9;
/// An exchange must raise the logarithm of the determinant by this much.
const LEAST_GAIN: f64 = 1e-6;
/// Sweeps over all chosen poses.
const MOST_SWEEPS: usize = 20;

/// Choose poses.
///
/// # Errors
/// Too few candidates are left, or one has the wrong length; or the chain has too many joints.
pub fn plan(chain: &Chain, options: &PlanOptions) -> Result<Plan, PlanError> {
    within_proportion(chain)?;
    can_be_identified(chain)?;
    if options.kind.holds_the_target() {
        return Err(PlanError::InContact(options.kind));
    }
    let all = candidates(chain, options)?;
    let total = all.len();
    let mut arm = Arm::new(chain, &Scene::of(options.kind, 1));
    arm.targets[0].translation.vector = options.target;
    arm.points.fill(options.anchor);
    let usable: Vec<Vec<f64>> = all.into_iter().filter(|q| allowed(chain, &arm, q, options)).collect();
    if usable.len() < options.count || options.count == 0 {
        return Err(PlanError::TooFewCandidates { wanted: options.count, left: usable.len(), candidates: total });
    }
    let design = Design::new(chain, &arm, &usable, options);
    let (chosen, exchanges) = design.choose(options.count).ok_or(PlanError::Degenerate)?;
    Ok(Plan {
        joints: chain.coordinates().iter().map(|coordinate| coordinate.name.clone()).collect(),
        poses: chosen.iter().map(|&index| design.candidates[index].clone()).collect(),
        observability: design.observability(&chosen),
        at_random: design.at_random(options.count, options.seed),
        usable: design.candidates.len(),
        exchanges,
        with_prior: options.earlier.is_some(),
    })
}

/// Candidates spread evenly over the joint range: an additive recurrence in the generalised golden ratio (Roberts 2018).
fn candidates(chain: &Chain, options: &PlanOptions) -> Result<Vec<Vec<f64>>, PlanError> {
    let n = chain.coordinates().len();
    if let Some(given) = &options.candidates {
        if let Some(row) = given.iter().position(|q| q.len() != n) {
            return Err(PlanError::Length { row: row + 1, found: given[row].len(), expected: n });
        }
        return Ok(given.clone());
    }
    // The root of x^(n+1) = x + 1.
    let mut phi = 2.0f64;
    for _ in 0..60 {
        phi = (1.0 + phi).powf(1.0 / (n as f64 + 1.0));
    }
    // Every seed starts the sequence elsewhere; 0 in the middle.
    let start = |k: usize| 0.5 + options.seed as f64 * 0.618_033_988_749_895 * (k as f64 + 1.0).sqrt();
    let at = |row: usize, (k, coordinate): (usize, &denavit_model::Coordinate)| {
        let (lower, upper) = coordinate.range();
        let inset = options.margin * (upper - lower);
        let share = (start(k) + (row + 1) as f64 * phi.powi(-(i32::try_from(k).unwrap_or(0) + 1))).fract();
        lower + inset + (upper - lower - 2.0 * inset) * share
    };
    Ok((0..options.spread)
        .map(|row| chain.coordinates().iter().enumerate().map(|pair| at(row, pair)).collect())
        .collect())
}

fn allowed(chain: &Chain, arm: &Arm, q: &[f64], options: &PlanOptions) -> bool {
    let within = chain.coordinates().iter().zip(q).all(|(coordinate, value)| {
        let (lower, upper) = coordinate.range();
        coordinate.limits.range.is_none() || (*value >= lower && *value <= upper)
    });
    let target = chain.fk(q) * Point3::from(arm.targets[0].translation.vector);
    within
        && options
            .allowed
            .is_none_or(|[low, high]| (0..3).all(|axis| target[axis] >= low[axis] && target[axis] <= high[axis]))
}

/// Jacobian rows of every candidate, and prior information.
struct Design {
    candidates: Vec<Vec<f64>>,
    /// Each candidate's rows over the noise, parameters in units of their prior standard deviations.
    rows: Vec<DMatrix<f64>>,
    /// All of them, one below the other.
    stacked: DMatrix<f64>,
    before: DMatrix<f64>,
    /// Rows over the noise that represent an earlier calibration; none without.
    known: DMatrix<f64>,
    noise: f64,
}

impl Design {
    fn new(chain: &Chain, arm: &Arm, candidates: &[Vec<f64>], options: &PlanOptions) -> Self {
        let joints = arm.nominal.coordinates().iter().map(|coordinate| coordinate.name.clone()).collect();
        let rows = Measurements::empty("plan", joints, Scene::of(options.kind, 1));
        let data = as_predicted(arm, rows, &[0], candidates);
        let candidates: Vec<Vec<f64>> = (0..data.len()).map(|row| data.reading(row).to_vec()).collect();
        let layout = Layout::new(chain, &data.scene, &options.freedom, &options.tolerances, Vec::new());
        let layout = expecting(layout, options.earlier.as_ref());
        let n = layout.len();
        // A millimetre and a milliradian for parameters without a tolerance.
        let unit: Vec<f64> = layout.parameters.iter().map(|parameter| parameter.tolerance.unwrap_or(1e-3)).collect();
        let problem = ResidualModel { data: &data, layout: &layout, effects: &NoEffects };
        let height = options.kind.height();
        let mut scratch = Scratch::new(&layout, arm);
        let (mut residual, mut jacobian) = (vec![0.0; height], vec![0.0; height * n]);
        let rows: Vec<DMatrix<f64>> = (0..candidates.len())
            .map(|row| {
                problem.row_into(arm, row, &mut scratch, &mut residual, Some(&mut jacobian));
                DMatrix::from_fn(height, n, |i, k| jacobian[i * n + k] * unit[k] / options.noise)
            })
            .collect();
        let mut before = DMatrix::<f64>::identity(n, n) * 1e-6;
        for i in layout.joints.clone() {
            for k in layout.joints.clone() {
                before[(i, k)] += layout.prior.precision[(i, k)] * unit[i] * unit[k];
            }
        }
        let held = gauge::in_scaled(gauge::conditions(&layout, arm), &unit);
        before += &held * held.transpose();
        let mut stacked = DMatrix::zeros(height * rows.len(), n);
        for (index, own) in rows.iter().enumerate() {
            stacked.rows_mut(index * height, height).copy_from(own);
        }
        let joints = layout.joints.clone();
        let mut known = DMatrix::zeros(if options.earlier.is_some() { joints.len() } else { 0 }, n);
        if options.earlier.is_some() {
            let precision = &layout.prior.precision;
            let scaled = DMatrix::from_fn(joints.len(), joints.len(), |i, k| precision[(i, k)] * unit[i] * unit[k]);
            // A common motion of all axes is not a parameter: the prior hardly constrains it, and the indices leave it out.
            let free = free_of_common_motions(&layout.parameters[joints.clone()], &layout.bases, &layout.frames);
            let rows = symmetric::lower(&scaled, 0.0).transpose() * &free * free.transpose();
            known.columns_mut(joints.start, joints.len()).copy_from(&rows);
        }
        Self { candidates, rows, stacked, before, known, noise: options.noise }
    }

    /// ln det growth when rows are added to a design with this inverse.
    fn gain(inverse: &DMatrix<f64>, rows: &DMatrix<f64>) -> f64 {
        let mut inner = rows * inverse * rows.transpose();
        for i in 0..inner.nrows() {
            inner[(i, i)] += 1.0;
        }
        inner.determinant().max(f64::MIN_POSITIVE).ln()
    }

    /// (M ± Rᵀ R)⁻¹ from M⁻¹ (Woodbury).
    fn updated(inverse: &DMatrix<f64>, rows: &DMatrix<f64>, sign: f64) -> Option<DMatrix<f64>> {
        let along = inverse * rows.transpose();
        let mut inner = rows * &along * sign;
        for i in 0..inner.nrows() {
            inner[(i, i)] += 1.0;
        }
        Some(inverse - &along * inner.try_inverse()? * along.transpose() * sign)
    }

    fn inverse(&self, chosen: &[usize]) -> Option<DMatrix<f64>> {
        let mut matrix = self.before.clone();
        for &index in chosen {
            matrix += self.rows[index].transpose() * &self.rows[index];
        }
        Some(matrix.cholesky()?.inverse())
    }

    fn best(&self, inverse: &DMatrix<f64>, chosen: &[usize]) -> Option<(usize, f64)> {
        // One product for all candidates: it is most of the work.
        let products = &self.stacked * inverse;
        let height = self.rows[0].nrows();
        let gain = |index: usize| {
            let mut inner = products.rows(index * height, height) * self.rows[index].transpose();
            for i in 0..height {
                inner[(i, i)] += 1.0;
            }
            inner.determinant().max(f64::MIN_POSITIVE).ln()
        };
        (0..self.rows.len())
            .filter(|index| !chosen.contains(index))
            .map(|index| (index, gain(index)))
            .max_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// The poses and the exchanges made; `None` if rounding makes the information singular.
    fn choose(&self, count: usize) -> Option<(Vec<usize>, usize)> {
        let mut chosen: Vec<usize> = Vec::with_capacity(count);
        let mut inverse = self.inverse(&[])?;
        while chosen.len() < count {
            let Some((index, _)) = self.best(&inverse, &chosen) else { break };
            chosen.push(index);
            inverse = self.inverse(&chosen)?;
        }
        let mut exchanges = 0;
        for _ in 0..MOST_SWEEPS {
            let mut changed = false;
            for place in 0..chosen.len() {
                let out = chosen[place];
                let Some(without) = Self::updated(&inverse, &self.rows[out], -1.0) else { continue };
                let own = Self::gain(&without, &self.rows[out]);
                let Some((index, gain)) = self.best(&without, &chosen) else { continue };
                if gain > own + LEAST_GAIN {
                    chosen[place] = index;
                    inverse = self.inverse(&chosen)?;
                    exchanges += 1;
                    changed = true;
                }
            }
            if !changed {
                break;
            }
        }
        chosen.sort_unstable();
        Some((chosen, exchanges))
    }

    fn at_random(&self, count: usize, seed: u64) -> Observability {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut drawn = || {
            let mut order: Vec<(f64, usize)> =
                (0..self.candidates.len()).map(|index| (random.random::<f64>(), index)).collect();
            order.sort_by(|a, b| a.0.total_cmp(&b.0));
            order[..count].iter().map(|(_, index)| *index).collect::<Vec<usize>>()
        };
        let sets: Vec<Observability> = (0..RANDOM_SETS).map(|_| self.observability(&drawn())).collect();
        let mean = |of: fn(&Observability) -> f64| sets.iter().map(of).sum::<f64>() / RANDOM_SETS as f64;
        Observability {
            o1: mean(|set| set.o1),
            o2: mean(|set| set.o2),
            o3: mean(|set| set.o3),
            o4: mean(|set| set.o4),
            o5: mean(|set| set.o5),
            rank: sets.iter().map(|set| set.rank).min().unwrap_or(0),
        }
    }

    fn observability(&self, chosen: &[usize]) -> Observability {
        let (height, columns) = (self.rows[0].nrows(), self.rows[0].ncols());
        let measured = height * chosen.len();
        let mut matrix = DMatrix::zeros(measured + self.known.nrows(), columns);
        matrix.rows_mut(measured, self.known.nrows()).copy_from(&(&self.known * self.noise));
        for (k, &index) in chosen.iter().enumerate() {
            matrix.rows_mut(k * height, height).copy_from(&(&self.rows[index] * self.noise));
        }
        let mut values: Vec<f64> = matrix.singular_values().iter().copied().collect();
        values.sort_by(|a, b| b.total_cmp(a));
        let largest = values.first().copied().unwrap_or(0.0);
        values.retain(|value| *value > RANK_TOLERANCE * largest);
        let smallest = values.last().copied().unwrap_or(0.0);
        let rank = values.len();
        let mean_log = values.iter().map(|value| value.ln()).sum::<f64>() / rank.max(1) as f64;
        Observability {
            o1: mean_log.exp() / (chosen.len() as f64).sqrt(),
            o2: smallest / largest,
            o3: smallest,
            o4: smallest * smallest / largest,
            o5: values.iter().map(|value| value.recip()).sum::<f64>().recip(),
            rank,
        }
    }
}

/// Rows at these poses, with the arm's predictions for the `series` of `rows` as measured values: only the derivatives are used. A series
/// that cannot be observed at a pose is left out of its row, and a pose without observations is left out of the rows; the line of
/// a row is the number of its pose, counted from 1.
fn as_predicted<'a>(
    arm: &Arm,
    mut rows: Measurements,
    series: &[usize],
    poses: impl IntoIterator<Item = &'a Vec<f64>>,
) -> Measurements {
    let (mut state, still, mut values) = (RowState::default(), Perturbation::none(arm.joints.len()), Vec::new());
    for (index, pose) in poses.into_iter().enumerate() {
        arm.state_into(pose, 0, None, &mut state);
        let mut any = false;
        for &index in series {
            let of = &rows.scene.series[index];
            let nothing = vec![0.0; of.kind.numbers()];
            let seen = Seen::new(arm, &state.tip, &still, of, &nothing, false);
            if model_of(of.kind).in_view(&seen) {
                values.clear();
                model_of(of.kind).predict(&seen, &mut values);
                rows.observed.push(index, &values);
                any = true;
            }
        }
        if any {
            rows.end_row(pose, index + 1, false);
        }
    }
    rows
}
