//! Prediction by averaging: one linear Gaussian model holds everything that may act, with the size of each kind set by the evidence.
//!
//! Terms ([`mod@terms`]) and rows ([`mod@linearised`]) give columns; [`sizes`] finds their prior variances and the noise by marginal
//! likelihood. The model moves to the posterior mean of all numbers and is linearised again, `PASSES` times. The result predicts together
//! with plain geometry: [`Averaged`]. Equations and figures: docs/prediction.md.

pub mod linearised;
pub mod sizes;
pub mod terms;

use self::linearised::{Linearised, linearised};
use self::sizes::{Sizes, fitted, problem};
use self::terms::{Family, Terms, of_model, terms};
use crate::arm::{Arm, Row};
use crate::effects::averaged::{Averaged, Known, KnownTip, Spread, mixed};
use crate::effects::driver::{Conditions, Driver, Statics};
use crate::effects::everything::Everything;
use crate::effects::model::{EffectModel, Term};
use crate::effects::survey::Survey;
use crate::identification::Identification;
use crate::identify_options::IdentifyOptions;
use crate::noise::HeldCurve;
use crate::parameters::{Effects as _, Freedom, Layout, NoEffects};
use crate::residual_statistics::{above_zero, residuals};
use crate::solve::{Fit, Noise};
use denavit_linear::threads::with_threads;
use denavit_linear::{Curvature, Gram};
use denavit_measurements::Measurements;
use denavit_model::nalgebra::{DMatrix, DVector, Point3};
use denavit_model::{Chain, Pose, se3};
use std::sync::Arc;

/// Number of linearisations. One is too few for nonlinear fits: measured on the Motoman's draws of March 2019.
const PASSES: usize = 3;
/// The same for the model that it is compared with, which starts at its fit.
const PASSES_OF_NAMED: usize = 1;
/// Most steps with the sizes found, and the change of the predictions, as a fraction of the noise variance, at which they end.
const STEPS_TO_CONVERGE: usize = 16;
const CONVERGED: f64 = 0.01;
/// Smallest fraction of a step that oscillates.
const LEAST_SHARE: f64 = 0.25;
/// Steps of the search for sizes, in the first pass and in those after it.
const STEPS: [usize; 2] = [40, 15];
/// Most values used to find sizes: the rows are spread evenly over the run.
const VALUES_FOR_SIZES: usize = 600;
/// Most values used for the posterior.
const VALUES: usize = 6_000;
/// Rows at which the uncertainty of the target's position is evaluated.
const ROWS_ACROSS: usize = 40;
/// Fewer rejected observations than this are outliers.
pub const LEAST_REJECTED: usize = 4;
/// False positive rate of the test whether a model of causes predicts better than the average. Anything from one in two hundred
/// to one in ten gave the same results on 660 draws of real rows.
const CHANCE: f64 = 0.05;
/// Fewest postures for this test: differences of squares are skewed, and with fewer, Student's test mistakes chance for a gain (the usual
/// rule; Boos, Hughes-Oliver 2000, The American Statistician 54, 121).
const LEAST_POSTURES: usize = 30;
/// Student's degrees of freedom of the weights of rows.
const STUDENT: f64 = 4.0;

/// Why there is no averaged prediction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum NotAveraged {
    /// Several tips, some of them measured by contact or grip.
    TipsTogether,
    /// The calibration continues an earlier one.
    Continued,
    /// No joint moves, or no length is measured.
    NothingMoves,
    /// A matrix could not be factored.
    Numbers,
    /// Effects were not requested.
    NotAsked,
    /// The previous stage's model explains values that geometry rejects and that averaging would leave out.
    NamedExplainsRejected {
        /// Number of values.
        values: usize,
    },
    /// The previous stage's model predicts left-out postures significantly better: root mean squares, m per axis.
    NamedIsBetter {
        /// The error of that model.
        named: f64,
        /// The error of the average.
        averaged: f64,
    },
}

/// A model with causes and error curves that averaging must not fall behind.
#[derive(Debug, Clone, Copy)]
pub struct Named<'a> {
    /// Its fit.
    pub fit: &'a Fit<EffectModel>,
    /// Its error curves, and the prior of their waves.
    pub curves: &'a [HeldCurve<'a>],
}

/// A robot averaged over everything that may act.
#[derive(Debug, Clone)]
pub struct Averaging {
    /// The recommended prediction: the arm of the geometric fit, with instruments and targets of the averaged one. It has no sums of squares.
    pub fit: Fit<Averaged>,
    /// The sizes.
    pub sizes: Sizes,
    /// Root mean square of leave-one-posture-out residuals, m per axis: geometry alone, and the blend of geometry and the averaged robot.
    pub left_out: [f64; 2],
    /// The same of the model that does not predict significantly better.
    pub named: Option<f64>,
}

/// A row predicted from all others.
struct LeftOut {
    /// The row, and the number of its posture.
    row: usize,
    posture: usize,
    /// Lengths, measured minus predicted, m.
    residual: Vec<f64>,
    /// Mean prediction variance of a length, m².
    variance: f64,
    /// Mean noise variance of a length, m².
    noise: f64,
    /// Weight of the row.
    weight: f64,
}

impl LeftOut {
    /// Weighted sum of the squares, m².
    fn square(&self) -> f64 {
        self.weight * self.residual.iter().map(|r| r * r).sum::<f64>()
    }
}

/// Mean square for each axis, m².
fn mean_square(rows: &[LeftOut]) -> f64 {
    rows.iter().map(LeftOut::square).sum::<f64>() / values(rows)
}

/// Number of lengths.
fn values(rows: &[LeftOut]) -> f64 {
    rows.iter().map(|row| row.residual.len()).sum::<usize>() as f64
}

/// Whether these rows are predicted significantly better than by another model, posture by posture. A search among a thousand causes
/// finds some with a smaller gain by chance.
fn clearly_better(these: &[LeftOut], others: &[LeftOut]) -> bool {
    let change = |(this, other): (&LeftOut, &LeftOut)| (this.posture, other.square() - this.square());
    let changes: Vec<(usize, f64)> = these.iter().zip(others).map(change).collect();
    let of_posture = |own: &[(usize, f64)]| own.iter().map(|(_, change)| change).sum();
    let changes: Vec<f64> = changes.chunk_by(|a, b| a.0 == b.0).map(of_posture).collect();
    changes.len() >= LEAST_POSTURES && above_zero(&changes, CHANCE)
}

/// The same rows predicted by the blend.
fn blended(geometric: &[LeftOut], averaged: &[LeftOut]) -> Vec<LeftOut> {
    let of_geometry = mean_square(geometric);
    let blend = |(geometric, averaged): (&LeftOut, &LeftOut)| {
        let share = of_geometry / (of_geometry + averaged.variance);
        let both = || geometric.residual.iter().zip(&averaged.residual);
        let apart = both().map(|(g, a)| (g - a).powi(2)).sum::<f64>() / averaged.residual.len() as f64;
        LeftOut {
            residual: both().map(|(g, a)| g + share * (a - g)).collect(),
            variance: mixed(share, [averaged.variance, of_geometry], apart),
            ..*averaged
        }
    };
    geometric.iter().zip(averaged).map(blend).collect()
}

/// Factor on expected squares with which 95 % of the left-out values lie within 1.96 standard deviations. The sizes were found from the same
/// rows and use up degrees of freedom, at most half of all.
fn calibrated(rows: &[LeftOut], sizes: usize) -> Option<f64> {
    let standardised = |row: &LeftOut| {
        let deviation = (row.variance + row.noise).sqrt();
        row.residual.iter().map(move |residual| residual.abs() / deviation).collect::<Vec<f64>>()
    };
    let mut all: Vec<f64> = rows.iter().flat_map(standardised).collect();
    all.sort_by(f64::total_cmp);
    let count = all.len() as f64;
    // The rank of the quantile with one more value, the future one (Vovk, Gammerman, Shafer 2005).
    let rank = (95 * (all.len() + 1)).div_ceil(100).min(all.len());
    let widest = all.get(rank.checked_sub(1)?)?;
    Some((widest / 1.96).powi(2) * count / (count - sizes as f64).max(0.5 * count))
}

/// Data shared by all passes.
struct Averager<'a> {
    data: &'a Measurements,
    terms: &'a Terms,
    layout: Layout,
    observed: &'a [f64],
    weights: Vec<f64>,
    some: Vec<usize>,
    all: Vec<usize>,
}

/// The state of a pass.
#[derive(Clone)]
struct At {
    arm: Arm,
    model: Everything,
    sizes: Sizes,
}

/// Averages over everything that may act in these rows. `causes`: terms of the identified causes; `named`: the model to compare with.
///
/// # Errors
/// Averaging does not apply or predicts worse; the previous stage then remains the best.
pub fn averaged(
    statics: &Statics,
    data: &Measurements,
    identification: &Identification,
    options: &IdentifyOptions,
    (causes, named): (&[Term], Option<Named<'_>>),
) -> Result<Averaging, NotAveraged> {
    let geometric = &identification.geometric;
    if statics.tips.several() && data.scene.kinds().iter().any(|kind| kind.own_target().is_some()) {
        return Err(NotAveraged::TipsTogether);
    }
    if options.earlier.is_some() {
        return Err(NotAveraged::Continued);
    }
    let survey = Survey::of(statics, data, Vec::new());
    if survey.moving().next().is_none() || !data.scene.channels.iter().any(|channel| channel.unit == "m") {
        return Err(NotAveraged::NothingMoves);
    }
    let explained = named.map_or(0, |named| {
        let kept = named.fit.weights.iter().zip(&geometric.weights);
        kept.filter(|(by_named, by_geometry)| **by_named > 0.0 && **by_geometry == 0.0).count()
    });
    if explained >= LEAST_REJECTED {
        return Err(NotAveraged::NamedExplainsRejected { values: explained });
    }
    let causes: Vec<(Term, f64)> = causes.iter().filter_map(|term| in_own_units(term, statics, data)).collect();
    let terms = terms(&survey, &options.tolerances, &causes);
    let spread = |values: usize| {
        let rows = data.len().min((values * data.len()).div_ceil(data.values().max(1)));
        data.spread_by_posture(rows)
    };
    let averager = |terms| Averager {
        data,
        terms,
        layout: placing(&geometric.arm.nominal, data, options, terms),
        observed: &geometric.weights,
        weights: student(data, geometric),
        some: spread(VALUES_FOR_SIZES),
        all: spread(VALUES),
    };
    let of_named = named.map(|named| {
        (
            named,
            of_model(&survey, &options.tolerances, (&named.fit.effects, named.curves), |term| {
                in_own_units(term, statics, data).map_or(0.0, |(_, scale)| scale)
            }),
        )
    });
    with_threads(|| {
        let (found, left_out, plain) = averager(&terms).run(&identification.nominal.arm, geometric)?;
        let named = of_named.as_ref().and_then(|(named, terms)| averager(terms).named(named, &plain));
        let better = named.as_ref().is_some_and(|named| clearly_better(named, &left_out));
        Some((Averaging { named: named.map(|rows| mean_square(&rows).sqrt()), ..found }, better))
    })
    .ok_or(NotAveraged::Numbers)
    .and_then(|(found, better)| match (found.named, found.left_out[1]) {
        (Some(named), averaged) if better => Err(NotAveraged::NamedIsBetter { named, averaged }),
        _ => Ok(found),
    })
}

/// The layout of these terms' numbers and the poses of instruments and targets.
fn placing(chain: &Chain, data: &Measurements, options: &IdentifyOptions, terms: &Terms) -> Layout {
    let freedom = Freedom::placement(chain.joints().len());
    Layout::new(chain, &data.scene, &freedom, &options.tolerances, terms.model.parameters())
}

/// A term with 1 over the root mean square of its driver in the data; none where the driver is always 0.
fn in_own_units(term: &Term, statics: &Statics, data: &Measurements) -> Option<(Term, f64)> {
    let rows = data.spread_by_posture(data.len().min(VALUES_FOR_SIZES));
    let mut square = 0.0;
    for &row in &rows {
        let conditions = Conditions::of(Row::new(data, row));
        let posture = statics.posture(statics.chain.joints(), &conditions, None);
        let mut values = Vec::new();
        term.driver.values_into(statics, &conditions, &posture, &mut values);
        square += values.iter().map(|value| value * value).sum::<f64>() / values.len().max(1) as f64;
    }
    let size = (square / rows.len().max(1) as f64).sqrt();
    (size > 0.0 && size.is_finite()).then(|| (term.clone(), 1.0 / size))
}

/// Student's weight of each row, 5/(4 + s²), with s the residual of geometry over the median.
fn student(data: &Measurements, fit: &Fit<NoEffects>) -> Vec<f64> {
    let size = |row: usize| {
        let of_row = data.of_row(row).filter(|&observation| fit.weights[observation] > 0.0);
        let sizes: Vec<f64> = of_row
            .map(|at| {
                fit.noise.chi_squared(data.series_of(at), fit.squares[at]) / data.series_of(at).kind.height() as f64
            })
            .collect();
        sizes.iter().sum::<f64>() / sizes.len().max(1) as f64
    };
    let sizes: Vec<f64> = (0..data.len()).map(size).collect();
    let mut sorted: Vec<f64> = sizes.iter().copied().filter(|size| *size > 0.0).collect();
    sorted.sort_by(f64::total_cmp);
    let median = sorted.get(sorted.len() / 2).copied().unwrap_or(1.0);
    sizes.iter().map(|size| (STUDENT + 1.0) / (STUDENT + size / median)).collect()
}

impl Averager<'_> {
    fn linearised(&self, rows: &[usize], at: &At) -> Linearised {
        linearised(self.data, rows, (&at.arm, &at.model, &self.layout), (self.observed, &self.weights))
    }

    /// New sizes.
    fn sized(&self, at: &At, rows: &Linearised, pass: usize) -> Sizes {
        fitted(rows, self.data, self.terms, &at.sizes, (STEPS[usize::from(pass > 0)], pass == 0))
    }

    /// New sizes, with everything at its posterior mean.
    fn pass(&self, at: &At, pass: usize) -> Option<At> {
        let rows = self.linearised(&self.some, at);
        let at = At { sizes: self.sized(at, &rows, pass), ..at.clone() };
        Some(self.at_mean(&at, &rows, &self.curvature(&rows, &at)?, 1.0).0)
    }

    /// The factored model there, and which columns are in it.
    fn curvature(&self, rows: &Linearised, at: &At) -> Option<(Curvature, Vec<usize>)> {
        let (problem, chosen) = problem(rows, self.terms, &at.sizes);
        Some((problem.gram()?.curvature(), chosen))
    }

    /// A step to the posterior mean by these rows and this curvature, or this fraction of it; and the mean square change of the predictions
    /// by the whole step, in units of the noise.
    fn at_mean(
        &self,
        at: &At,
        rows: &Linearised,
        (curvature, chosen): &(Curvature, Vec<usize>),
        share: f64,
    ) -> (At, f64) {
        let mut numbers = DVector::zeros(rows.columns.ncols());
        numbers.iter_mut().zip(at.model.numbers()).for_each(|(place, number)| *place = number);
        let residual = &rows.data - &rows.columns * &numbers;
        let step = curvature.step((&rows.columns, chosen), &residual, &numbers.select_rows(chosen));
        // Numbers that are not among the columns go to 0.
        let mut whole = -numbers;
        chosen.iter().zip(step.iter()).for_each(|(&column, step)| whole[column] = *step);
        let changes = &rows.columns * &whole;
        let change = curvature.in_noise(&changes).norm_squared() / rows.data.len() as f64;
        whole *= share;
        let step = whole.as_slice();
        let (arm, model) = (self.layout.stepped(&at.arm, step), at.model.stepped(&step[..rows.of_model]));
        (At { arm, model, sizes: at.sizes.clone() }, change)
    }

    /// Repeats the step with these sizes until convergence. The curvature is kept as long as steps become shorter.
    fn until_converged(&self, at: At, rows: &[usize]) -> Option<At> {
        let (mut at, mut before, mut share, mut known) = (at, f64::INFINITY, 1.0, None);
        for _ in 0..STEPS_TO_CONVERGE {
            let rows = self.linearised(rows, &at);
            let by_known = known.take().map(|known| (self.at_mean(&at, &rows, &known, share), known));
            let shorter = by_known.filter(|((_, change), _)| *change < 0.5 * before);
            let ((next, change), curvature) = if let Some(step) = shorter {
                step
            } else {
                let fresh = self.curvature(&rows, &at)?;
                (self.at_mean(&at, &rows, &fresh, share), fresh)
            };
            at = next;
            if change < CONVERGED {
                break;
            }
            // Steps that do not become shorter oscillate.
            if change > 0.5 * before {
                share = (0.5 * share).max(LEAST_SHARE);
            }
            (before, known) = (change, Some(curvature));
        }
        Some(at)
    }

    /// Rows predicted by this model from all others. `plain`: geometry alone.
    fn named(&self, named: &Named<'_>, plain: &At) -> Option<Vec<LeftOut>> {
        let mut numbers = self.terms.model.numbers();
        let geometry = self.terms.families.iter().take_while(|family| family.is_of_geometry()).count();
        numbers[..geometry].copy_from_slice(&plain.model.numbers()[..geometry]);
        let step: Vec<f64> = numbers.iter().zip(self.terms.model.numbers()).map(|(to, from)| to - from).collect();
        let noise = &named.fit.noise.levels;
        let mut at =
            At { arm: plain.arm.clone(), model: self.terms.model.stepped(&step), sizes: Sizes::of_model(noise) };
        for _ in 0..PASSES_OF_NAMED {
            let rows = self.linearised(&self.some, &at);
            (at, _) = self.at_mean(&at, &rows, &self.curvature(&rows, &at)?, 1.0);
        }
        Some(self.left_out(&at)?.1)
    }

    /// The averaged prediction, the rows predicted by it from all others, and the final state of geometry alone.
    fn run(&self, nominal: &Arm, geometric: &Fit<NoEffects>) -> Option<(Averaging, Vec<LeftOut>, At)> {
        let found = (&*geometric.noise.levels, geometric.layout.prior.widened);
        let of_geometry = Family::is_of_geometry;
        let start = |used: &dyn Fn(Family) -> bool, as_tolerated| Sizes::start(found, self.terms, used, as_tolerated);
        // Instruments and targets start from the geometric fit: the drawing's may be half a metre away.
        let placed = Arm { joints: nominal.joints.clone(), ..geometric.arm.clone() };
        let mut plain = At { arm: placed, model: self.terms.model.clone(), sizes: start(&of_geometry, true) };
        for pass in 0..=PASSES {
            plain = self.pass(&plain, pass)?;
        }
        plain = self.until_converged(plain, &self.some)?;
        let (of_plain, of_geometry) = self.left_out(&plain)?;
        let all = start(&|_| true, false);
        let mut at = At { sizes: all, ..plain.clone() };
        for pass in 0..PASSES - 1 {
            at = self.pass(&at, pass)?;
        }
        at.sizes = self.sized(&at, &self.linearised(&self.some, &at), PASSES - 1);
        at = self.until_converged(at, &self.all)?;
        let (spread, left_out) = self.left_out(&at)?;
        let v_g = mean_square(&of_geometry);
        let mut found = self.result((nominal, geometric), &at, [spread, of_plain], v_g);
        let averaged = &mut found.fit.effects;
        let geometry_among_rows = self.median(&left_out, |conditions, _| averaged.unsure(conditions)[1])?;
        let across = self.across(averaged, &left_out)?;
        let left_out = blended(&of_geometry, &left_out);
        let calibrated = calibrated(&left_out, at.sizes.count())?;
        let noise = calibrated * (left_out.iter().map(|row| row.noise).sum::<f64>() / left_out.len() as f64);
        let known = Arc::make_mut(&mut averaged.known);
        (known.geometry_among_rows, known.across) = (geometry_among_rows, across);
        (known.calibrated, known.noise) = (calibrated, noise);
        Some((Averaging { left_out: [v_g, mean_square(&left_out)].map(f64::sqrt), ..found }, left_out, plain))
    }

    /// The covariance of all numbers with a relevant prior variance, of the instrument's frame and of the target's position.
    fn spread(&self, gram: &Gram, columns: &[usize]) -> Spread {
        let frame = self.layout.instruments.first().copied().flatten().into_iter().flat_map(|first| first..first + 6);
        let place =
            first_targets(self.data).filter_map(|target| self.layout.places[target]).flat_map(|first| first..first + 3);
        let numbers = columns.iter().take_while(|&&column| self.layout.effects.contains(&column)).count();
        let beside = frame.chain(place).filter_map(|column| columns.binary_search(&column).ok());
        let chosen: Vec<usize> = (0..numbers).chain(beside).collect();
        Spread { covariance: gram.posterior().marginal(&chosen).covariance, kept: columns[..numbers].to_vec() }
    }

    /// Median ratio of the variance of the target's position to that of its reading: a distance does not constrain directions across it.
    fn across(&self, averaged: &Averaged, rows: &[LeftOut]) -> Option<f64> {
        if self.data.scene.series.iter().all(|series| series.kind.place().height == 3) {
            return Some(1.0);
        }
        let ratio = self.median(rows, |conditions, left| averaged.unsure(conditions)[0] / left.variance);
        ratio.filter(|ratio| *ratio > 0.0)
    }

    /// The median over some of the rows.
    fn median(&self, rows: &[LeftOut], of: impl Fn(&Conditions<'_>, &LeftOut) -> f64) -> Option<f64> {
        let some = rows.iter().step_by(rows.len().div_ceil(ROWS_ACROSS).max(1));
        let mut values: Vec<f64> = some.map(|left| of(&Conditions::of(Row::new(self.data, left.row)), left)).collect();
        values.sort_by(f64::total_cmp);
        values.get(values.len() / 2).copied().filter(|value| value.is_finite())
    }

    /// The model's covariance at its current state, and each row that measures lengths, predicted from all others.
    fn left_out(&self, at: &At) -> Option<(Spread, Vec<LeftOut>)> {
        let own = self.linearised(&self.all, at);
        let (problem, columns) = problem(&own, self.terms, &at.sizes);
        let noise: Vec<DVector<f64>> = problem.noise.iter().map(DMatrix::diagonal).collect();
        let gram = problem.gram()?;
        let mut rows = Vec::new();
        let of_lengths =
            |value: &usize| own.channels[*value].is_some_and(|channel| self.data.scene.channels[channel].unit == "m");
        for (index, left) in gram.leave_out()?.iter().enumerate() {
            let mut first = own.rows[index].start;
            for &(row, height) in &own.sources[index] {
                let lengths: Vec<usize> =
                    (first..first + height).filter(of_lengths).map(|value| value - own.rows[index].start).collect();
                first += height;
                if lengths.is_empty() {
                    continue;
                }
                let of_prediction = |&k: &usize| (left.covariance[(k, k)] - noise[index][k]).max(0.0);
                rows.push(LeftOut {
                    row,
                    posture: index,
                    residual: lengths.iter().map(|&k| left.residual[k]).collect(),
                    variance: lengths.iter().map(of_prediction).sum::<f64>() / lengths.len() as f64,
                    noise: lengths.iter().map(|&k| noise[index][k]).sum::<f64>() / lengths.len() as f64,
                    weight: own.weights[index],
                });
            }
        }
        Some((self.spread(&gram, &columns), rows))
    }

    fn result(
        &self,
        (nominal, geometric): (&Arm, &Fit<NoEffects>),
        at: &At,
        [spread, geometric_spread]: [Spread; 2],
        of_geometry: f64,
    ) -> Averaging {
        let has_instrument = self.layout.instruments.first().is_some_and(Option::is_some);
        let instrument = at.arm.instruments.first().copied().filter(|_| has_instrument);
        let mut kept = [&spread.kept[..], &geometric_spread.kept].concat();
        kept.sort_unstable();
        kept.dedup();
        let (mean, places) = at.model.pruned(&kept);
        let moved = |spread: Spread| Spread {
            kept: spread.kept.iter().filter_map(|&number| places[number]).collect(),
            ..spread
        };
        let (spread, geometric_spread) = (moved(spread), moved(geometric_spread));
        let drawn = Arm { instruments: Vec::new(), points: Vec::new(), ..at.arm.clone() };
        let (base, averaged_tips) = between(&at.arm, &geometric.arm, self.data);
        let (drawn_base, drawn_tips) = between(nominal, &geometric.arm, self.data);
        let base_back = base.inverse();
        let placed = at.arm.sits_on.iter().zip(&at.arm.targets);
        let arm = Arm {
            joints: geometric.arm.joints.clone(),
            instruments: at.arm.instruments.iter().map(|instrument| instrument * base_back).collect(),
            points: at.arm.points.iter().map(|point| (base * Point3::from(*point)).coords).collect(),
            targets: placed.map(|(tip, target)| averaged_tips[*tip].inverse() * target).collect(),
            ..geometric.arm.clone()
        };
        let tips = first_targets(self.data).zip(averaged_tips.into_iter().zip(drawn_tips)).map(
            |(target, (averaged, drawn))| KnownTip { averaged, drawn, target: arm.targets[target].translation.vector },
        );
        let known = Known {
            drawn,
            geometric: Arm {
                instruments: Vec::new(),
                points: Vec::new(),
                targets: Vec::new(),
                ..geometric.arm.clone()
            },
            base,
            tips: tips.collect(),
            instrument,
            spread,
            geometric_spread,
            drawn_base,
            of_drawing: self.of_drawing(nominal),
            of_curves: at.sizes.of_curves(),
            of_geometry,
            geometry_among_rows: 0.0,
            across: 1.0,
            calibrated: 1.0,
            noise: 0.0,
            ranges: ranges(self.data),
        };
        let averages = averages(&mean.0, self.data, &self.some);
        let fit = Fit {
            squares: Vec::new(),
            arm,
            effects: Averaged::new(mean, averages, known),
            noise: Noise { levels: at.sizes.noise.iter().map(|size| size.exp()).collect() },
            layout: geometric.layout.clone(),
            weights: geometric.weights.clone(),
            covariance: geometric.covariance.clone(),
            parameters_used: geometric.parameters_used.clone(),
            values: geometric.values.clone(),
            iterations: 2 * PASSES,
            jacobians: 2 * PASSES,
            converged: true,
            unfinished: None,
        };
        Averaging { fit, sizes: at.sizes.clone(), left_out: [of_geometry.sqrt(); 2], named: None }
    }
}

impl Averager<'_> {
    /// Mean square residual of the drawing, m² per axis, corrected for the parameters that place it.
    fn of_drawing(&self, nominal: &Arm) -> f64 {
        let left = residuals(nominal, &NoEffects, self.data);
        let (mut sum, mut count) = (0.0, 0.0);
        for residual in left.iter().filter(|residual| self.observed[residual.observation] > 0.0) {
            sum += residual.place.norm_squared();
            count += self.data.scene.series[residual.series].kind.place().height as f64;
        }
        let placed = (self.layout.len() - self.layout.effects.len()) as f64;
        sum / (count - placed).max(1.0)
    }
}

/// The first target on each tip.
fn first_targets(data: &Measurements) -> impl Iterator<Item = usize> + '_ {
    let scene = &data.scene;
    let tips = scene.tips().map_or(1, |tips| tips.all().len());
    (0..tips).filter_map(|tip| (0..scene.targets.len()).find(|&target| scene.tip_of(target) == tip))
}

/// The base and the tips of one arm relative to those of another for the same rows: by the first instrument, or the first point, and the first
/// target on each tip.
fn between(from: &Arm, to: &Arm, data: &Measurements) -> (Pose, Vec<Pose>) {
    let by_instrument = data.scene.has_instrument(0).then(|| to.instruments[0].inverse() * from.instruments[0]);
    let by_point = || from.points.first().zip(to.points.first()).map(|(from, to)| se3::translation(to - from));
    let base = by_instrument.or_else(by_point).unwrap_or_else(Pose::identity);
    let tip = |target: usize| {
        let (own, other) = (&from.targets[target], &to.targets[target]);
        if data.scene.turns(target) {
            own * other.inverse()
        } else {
            se3::translation(own.translation.vector - other.translation.vector)
        }
    };
    (base, first_targets(data).map(tip).collect())
}

/// Lowest and highest reading of each coordinate, in rows whose tip it moves.
fn ranges(data: &Measurements) -> Vec<(f64, f64)> {
    let range = |coordinate: usize| {
        let rows = (0..data.len()).filter(|&row| data.moves_its_tip(row, coordinate));
        let values = rows.map(|row| data.reading(row)[coordinate]);
        values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)))
    };
    (0..data.joints.len()).map(range).collect()
}

/// The average of every driver's values over some rows.
fn averages(model: &EffectModel, data: &Measurements, rows: &[usize]) -> Vec<Vec<f64>> {
    let mut sums: Vec<Vec<f64>> =
        model.effects.iter().map(|effect| vec![0.0; effect.term.driver.len(&model.statics)]).collect();
    let follows = |driver: &Driver| !driver.columns().is_empty();
    for &row in rows {
        let conditions = Conditions::of(Row::new(data, row));
        let posture = model.statics.posture(model.statics.chain.joints(), &conditions, None);
        for (effect, sum) in model.effects.iter().zip(&mut sums).filter(|(effect, _)| follows(&effect.term.driver)) {
            let mut values = Vec::new();
            effect.term.driver.values_into(&model.statics, &conditions, &posture, &mut values);
            sum.iter_mut().zip(values).for_each(|(sum, value)| *sum += value / rows.len() as f64);
        }
    }
    sums
}
