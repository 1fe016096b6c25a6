//! Undeclared loads: runs whose tip carried different masses.
//!
//! The residual of the geometric fit, in units of the noise,
//!
//! ```text
//! r = J b + W w + Σ_s [row of run s] Σ_j (C_j + m_s D_j) c_j + e
//! J  geometry, instrument, targets        W  smooth errors of joints and play, which runs in different regions could confuse with a load
//! C  deflection of joint j under the weight of the links, for 1 rad/(N m)        D  the same under 1 kg at the tip
//! ```
//! b and w are projected out, the compliances c solved for, the masses m found by search; the lightest run is assumed to carry nothing.
//! Only the products of the columns are needed. A load is claimed if it lowers the sum of squares by a twentieth and by more than chance
//! does, in either half of the postures, and by joints that deflect in the direction of their load.

use crate::linear::{Linear, linearise};
use crate::projected::{Projected, RowProducts, fit_with};
use crate::projector::Projector;
use denavit_identify::effects::candidates::candidates;
use denavit_identify::effects::carrier::Carrier;
use denavit_identify::effects::catalogue::Kind;
use denavit_identify::effects::driver::{Driver, Statics};
use denavit_identify::effects::model::{Coupling, Term};
use denavit_identify::effects::survey::Survey;
use denavit_identify::parameters::NoEffects;
use denavit_identify::solve::Fit;
use denavit_measurements::covariates::PAYLOAD;
use denavit_measurements::{Covariate, Measurements};
use denavit_model::nalgebra::{DMatrix, DVector};
use serde::Serialize;
use statrs::distribution::{ContinuousCDF, FisherSnedecor};

/// Largest number of runs: the search takes each in turn.
const MOST_RUNS: usize = 12;
/// Heaviest load that is searched for, kg: few calibrated arms lift more.
const HEAVIEST: f64 = 50.0;
/// Masses that the search tries for each run before it refines the best.
const TRIED: usize = 50;
/// Largest number of rounds over all runs; smallest gain of a round that is followed by another, in chi squared.
const ROUNDS: usize = 40;
const GAINED: f64 = 1e-6;
/// Probability of such a gain by chance in runs with equal loads.
const CHANCE: f64 = 1e-6;
/// Share of the residual without loads that loads must explain. A machine may have errors outside the catalogue that follow gravity, too:
/// the lifting column of Hilti's JaiBot, whose runs had equal loads, has 1 % of this kind, far above chance.
const EXPLAINED: f64 = 0.05;
/// This share of the squared effect of loads must come from joints that deflect in the direction of their load.
const GIVES: f64 = 0.9;
/// In either half of the postures a load must be this many standard deviations above 0.
const IN_HALVES: f64 = 2.0;
/// Step of the second derivatives, of each mass, kg.
const STEP: f64 = 1e-3;

/// A load at the tip that a run's file does not record.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct UndeclaredLoad {
    /// The run's setup.
    pub setup: String,
    /// More than the lightest run, kg.
    pub kg: f64,
    /// Standard deviation, kg; 0 for the lightest run.
    pub std: f64,
}

/// Loads of the runs, by which they differ.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct UndeclaredLoads {
    /// Setup by setup.
    pub runs: Vec<UndeclaredLoad>,
    /// Whether the masses of links are those of the drawing; else they are assumed, and loads scale with them.
    pub masses_from_inertials: bool,
}

impl UndeclaredLoads {
    /// Rows with a column of what their run carries; a run that is not among these carries nothing.
    #[must_use]
    pub fn applied(&self, mut data: Measurements) -> Measurements {
        let of = |setup: usize| {
            let known = self.runs.iter().find(|run| run.setup == data.scene.setups[setup]);
            known.map_or(0.0, |run| run.kg)
        };
        let values = (0..data.len()).map(|row| setup_of(&data, row).map_or(0.0, of)).collect();
        data.covariates.push(Covariate { name: PAYLOAD.into(), values });
        data
    }
}

impl UndeclaredLoads {
    /// The finding and what to do, as one sentence.
    pub fn said(&self) -> String {
        let carries = |run: &&UndeclaredLoad| run.std > 0.0;
        let listed: Vec<String> = self
            .runs
            .iter()
            .filter(carries)
            .map(|run| format!("{:.2} ± {:.2} kg in setup {}", run.kg, run.std, run.setup))
            .collect();
        let lightest = self.runs.iter().find(|run| !carries(run)).map_or("", |run| &run.setup);
        let assumed = if self.masses_from_inertials {
            ""
        } else {
            " (the masses of links are assumed, as the description has none, and loads scale with them)"
        };
        format!(
            "the setups carry different loads at the tip, which no column records: relative to setup {lightest} {}{assumed}; the rows are used \
             with these loads; write the loads into a column \"payload\" (kg)",
            listed.join(", ")
        )
    }
}

fn setup_of(data: &Measurements, row: usize) -> Option<usize> {
    data.of_row(row).next().map(|observation| data.series_of(observation).setup)
}

/// The loads by which runs differ; `None` if the rows show no difference, or if a column records the loads.
pub fn undeclared_loads(statics: &Statics, data: &Measurements, geometric: &Fit<NoEffects>) -> Option<UndeclaredLoads> {
    let runs = data.scene.setups.len();
    let planes = (0..runs).any(|setup| data.scene.has_plane(setup));
    if !(2..=MOST_RUNS).contains(&runs) || planes || data.covariate(PAYLOAD).is_some() {
        return None;
    }
    let survey = Survey::of(statics, data, Vec::new());
    let soft: Vec<Term> = survey
        .moving()
        .filter(|&joint| statics.feels_gravity(joint))
        .map(|joint| of_joint(Kind::JointCompliance, joint, Driver::Torque(joint)))
        .collect();
    if soft.is_empty() {
        return None;
    }
    let problem = Problem::of(statics, data, geometric, &soft, &smooth(&survey))?;
    let none = problem.all.squares(&vec![0.0; runs])?;
    let found = problem.all.loads(runs)?;
    let least = problem.all.squares(&found)?;
    let free = problem.all.freedom.checked_sub(soft.len() + runs - 1).filter(|&free| free > 0)?;
    let noise = least / free as f64;
    let statistic = (none - least) / (runs - 1) as f64 / noise;
    let by_chance = FisherSnedecor::new((runs - 1) as f64, free as f64).ok()?.sf(statistic);
    let explains = none - least > EXPLAINED * none && by_chance < CHANCE;
    if !(explains && problem.all.gives(&found)? > GIVES) {
        return None;
    }
    let std = problem.all.deviations(&found, noise)?;
    let lightest = (0..runs).min_by(|&a, &b| found[a].total_cmp(&found[b]))?;
    let differs = |run: usize| run != lightest && found[run] > 3.0 * std[run];
    let heaviest =
        (0..runs).filter(|&run| differs(run)).max_by(|&a, &b| (found[a] / std[a]).total_cmp(&(found[b] / std[b])))?;
    for half in &problem.halves {
        let own = half.searched(runs, lightest, 0.0)?;
        let noise =
            half.squares(&own)? / half.freedom.checked_sub(soft.len() + runs - 1).filter(|&free| free > 0)? as f64;
        if own[heaviest] < IN_HALVES * half.deviations(&own, noise)?[heaviest] {
            return None;
        }
    }
    let run =
        |setup: usize| UndeclaredLoad { setup: data.scene.setups[setup].clone(), kg: found[setup], std: std[setup] };
    Some(UndeclaredLoads { runs: (0..runs).map(run).collect(), masses_from_inertials: statics.masses.from_inertials })
}

pub(super) fn of_joint(kind: Kind, joint: usize, driver: Driver) -> Term {
    Term { kind, carrier: Carrier::Joint(joint), driver, coupling: Coupling::Each }
}

/// Errors of joints that follow their readings, and play: two harmonics of each joint, and its side.
pub(super) fn smooth(survey: &Survey) -> Vec<Term> {
    let waves = survey.moving().flat_map(|joint| {
        [1.0, 2.0].map(|order| of_joint(Kind::TransmissionError, joint, Driver::Harmonic { joint, order }))
    });
    let play = candidates(Kind::Backlash, survey).into_iter().map(|candidate| candidate.term);
    waves.chain(play.filter(|term| matches!(term.driver, Driver::Approach(_)))).collect()
}

/// The columns of these terms about the geometric fit.
fn columns(statics: &Statics, data: &Measurements, geometric: &Fit<NoEffects>, terms: &[Term]) -> Linear {
    linearise(data, &fit_with(statics, geometric, terms), &geometric.arm, &[])
}

/// Products of the projected columns and residual: first of the compliances under the links' weight, then run after run under 1 kg.
struct Products {
    gram: DMatrix<f64>,
    along: DVector<f64>,
    square: f64,
    joints: usize,
    /// Number of values, less the directions that are projected out.
    freedom: usize,
}

struct Problem {
    all: Products,
    /// Of every other posture.
    halves: [Products; 2],
}

impl Problem {
    fn of(
        statics: &Statics,
        data: &Measurements,
        geometric: &Fit<NoEffects>,
        soft: &[Term],
        smooth: &[Term],
    ) -> Option<Self> {
        let joints = soft.len();
        let terms: Vec<Term> = soft.iter().chain(smooth).cloned().collect();
        let linear = columns(statics, data, geometric, &terms);
        let mut loaded = data.clone();
        loaded.covariates.push(Covariate { name: PAYLOAD.into(), values: vec![1.0; data.len()] });
        let under_load = columns(statics, &loaded, geometric, soft).effects;
        let rows = linear.residual.len();
        let under_weight = linear.effects.columns(0, joints).into_owned();
        let others = linear.effects.columns(joints, linear.effects.ncols() - joints).into_owned();
        let projector = Projector::new(&[&linear.geometry, &others], &linear.residual);
        let runs: Vec<Option<usize>> = linear.rows.iter().map(|&row| setup_of(data, row)).collect();
        let mut cells = under_weight.as_slice().to_vec();
        for run in 0..data.scene.setups.len() {
            for joint in 0..joints {
                let own = under_load.column(joint) - under_weight.column(joint);
                let here = |at: usize| runs.get(at).is_some_and(|known| *known == Some(run));
                cells.extend((0..rows).map(|at| if here(at) { own[at] } else { 0.0 }));
            }
        }
        let projected = Projected::new(&projector, cells, &linear, data);
        let products = |half: Option<usize>, rank: usize| {
            let RowProducts { gram, along, square, values } = projected.products(half);
            Products { gram, along, square, joints, freedom: values.saturating_sub(rank) }
        };
        let rank = projected.rank;
        let halves = [0, 1].map(|half| products(Some(half), rank / 2));
        Some(Self { all: products(None, rank), halves })
    }
}

impl Products {
    /// Products of the compliances' columns with these masses of the runs, and with the residual.
    fn under(&self, loads: &[f64]) -> (DMatrix<f64>, DVector<f64>) {
        let joints = self.joints;
        let mut mix = DMatrix::zeros(self.along.len(), joints);
        for (block, weight) in std::iter::once(1.0).chain(loads.iter().copied()).enumerate() {
            (0..joints).for_each(|joint| mix[(block * joints + joint, joint)] = weight);
        }
        (mix.transpose() * &self.gram * &mix, mix.transpose() * &self.along)
    }

    /// The compliances with these masses of the runs.
    fn softness(&self, loads: &[f64]) -> Option<(DVector<f64>, DVector<f64>)> {
        let (mut gram, along) = self.under(loads);
        // A joint that the rows do not determine is held at no compliance.
        let most = gram.diagonal().amax().max(f64::MIN_POSITIVE);
        (0..self.joints).for_each(|joint| gram[(joint, joint)] += 1e-9 * most);
        // Columns are those of measured minus predicted.
        Some((-gram.cholesky()?.solve(&along), along))
    }

    /// The sum of squared residuals with these masses of the runs.
    fn squares(&self, loads: &[f64]) -> Option<f64> {
        let (softness, along) = self.softness(loads)?;
        Some(self.square + along.dot(&softness))
    }

    /// The masses of the runs with the least residual, the lightest 0.
    fn loads(&self, runs: usize) -> Option<Vec<f64>> {
        let mut lightest = 0;
        // A run that is lighter than the assumed lightest run is itself the lightest.
        for _ in 0..runs {
            let found = self.searched(runs, lightest, -HEAVIEST)?;
            let next = (0..runs).min_by(|&a, &b| found[a].total_cmp(&found[b]))?;
            if found[next] >= 0.0 {
                return Some(found);
            }
            lightest = next;
        }
        self.searched(runs, lightest, 0.0)
    }

    /// The same with one run that carries nothing, each other run in turn: the best of many masses from `least` on, refined by thirds.
    fn searched(&self, runs: usize, lightest: usize, least: f64) -> Option<Vec<f64>> {
        let mut loads = vec![0.0; runs];
        let mut best = self.squares(&loads)?;
        for _ in 0..ROUNDS {
            let before = best;
            for run in (0..runs).filter(|&run| run != lightest) {
                let of = |mass: f64, loads: &mut Vec<f64>| {
                    let old = std::mem::replace(&mut loads[run], mass);
                    let found = self.squares(loads);
                    loads[run] = old;
                    found
                };
                let step = (HEAVIEST - least) / TRIED as f64;
                let mut here = (best, loads[run]);
                for k in 0..=TRIED {
                    let mass = least + step * k as f64;
                    let squares = of(mass, &mut loads)?;
                    if squares < here.0 {
                        here = (squares, mass);
                    }
                }
                let (mut low, mut high) = ((here.1 - step).max(least), (here.1 + step).min(HEAVIEST));
                while high - low > 1e-6 {
                    let (a, b) = (low + (high - low) / 3.0, high - (high - low) / 3.0);
                    if of(a, &mut loads)? < of(b, &mut loads)? { high = b } else { low = a }
                }
                let middle = 0.5 * (low + high);
                let squares = of(middle, &mut loads)?;
                if squares < here.0 {
                    here = (squares, middle);
                }
                (best, loads[run]) = here;
            }
            if before - best < GAINED {
                break;
            }
        }
        Some(loads)
    }

    /// Standard deviations of the masses that are not 0, by the curvature of the sum of squares.
    fn deviations(&self, loads: &[f64], noise: f64) -> Option<Vec<f64>> {
        let free: Vec<usize> = (0..loads.len()).filter(|&run| loads[run] != 0.0).collect();
        let at = |shifts: &[(usize, f64)]| {
            let mut moved = loads.to_vec();
            for (run, by) in shifts {
                moved[*run] += by;
            }
            self.squares(&moved)
        };
        let mut curvature = DMatrix::zeros(free.len(), free.len());
        for (i, &a) in free.iter().enumerate() {
            for (j, &b) in free.iter().enumerate() {
                let sum = at(&[(a, STEP), (b, STEP)])? + at(&[(a, -STEP), (b, -STEP)])?;
                let difference = at(&[(a, STEP), (b, -STEP)])? + at(&[(a, -STEP), (b, STEP)])?;
                curvature[(i, j)] = (sum - difference) / (8.0 * STEP * STEP) / noise;
            }
        }
        let covariance = curvature.cholesky()?.inverse();
        let mut std = vec![0.0; loads.len()];
        free.iter().enumerate().for_each(|(i, &run)| std[run] = covariance[(i, i)].sqrt());
        Some(std)
    }

    /// The share of the squared effect of loads from joints that deflect in the direction of their load.
    fn gives(&self, loads: &[f64]) -> Option<f64> {
        let (softness, _) = self.softness(loads)?;
        let joints = self.joints;
        let of = |joint: usize| {
            let pull = |a: usize, b: usize| {
                loads[a] * loads[b] * self.gram[((a + 1) * joints + joint, (b + 1) * joints + joint)]
            };
            let runs = loads.len();
            let square: f64 = (0..runs).flat_map(|a| (0..runs).map(move |b| pull(a, b))).sum();
            square * softness[joint].powi(2)
        };
        let all: f64 = (0..joints).map(of).sum();
        let right: f64 = (0..joints).filter(|&joint| softness[joint] > 0.0).map(of).sum();
        (all > 0.0).then(|| right / all)
    }
}
