//! The few sizes that set prior and noise, found by marginal likelihood.
//!
//! Prior of each number: N(0, τ² scale²), one τ for each family; waves: times the spectral density of a squared exponential,
//! √(2π) l exp(-(ω l)²/2). Noise of a row: [σ² for each channel + ρ² Σ_j J_j J_jᵀ]/w, ρ the repeatability of joints, w the row's weight.
//! The search minimises -2 log evidence plus -2 log prior of the sizes: half-Cauchy of a milliradian (or millimetre; less for play and
//! runout) on each τ and ρ, normal distributions on ln κ (geometry, zeros), ln l and, centred on the residuals of geometry, ln σ.

use crate::averaging::linearised::Linearised;
use crate::averaging::terms::{Family, Terms};
use crate::effects::curve::Curve;
use crate::prior::SHARE_USED;
use denavit_linear::gram::Problem;
use denavit_linear::minimise::{Local, minimise};
use denavit_linear::products::cross_gram;
use denavit_linear::threads::{each_alone, in_parallel, on_this_thread};
use denavit_linear::{Components, Part, Pull};
use denavit_measurements::Measurements;
use denavit_model::nalgebra::{DMatrix, DVector};
use std::f64::consts::TAU;

/// Prior median of a family's size, rad or m; play: an arc minute, as in catalogues of reducers; axes that wobble or slide as they
/// turn: 10 µm on 0.1 m. A third of that made no difference on fifteen to thirty rows of a UR5; ten times that predicted worse.
const USUAL: f64 = 1e-3;
const USUAL_PLAY: f64 = 2.9e-4;
const USUAL_RUNOUT: f64 = 1e-4;
/// Prior mean and standard deviation of ln κ, κ a robot's errors over its tolerances, and of ln l, l in rad or m (Rasmussen, Williams 2006, 5.4).
const KAPPA: (f64, f64) = (0.0, SHARE_USED);
const ZERO: (f64, f64) = (-1.5, 1.0);
const LENGTH: (f64, f64) = (-1.2, 0.8);
/// Prior standard deviation of ln σ about the residuals of geometry: fifteen rows can be fitted without any noise.
const LEVEL: f64 = 1.0;
/// Prior standard deviation of frames and targets that a fit has placed, m or rad: practically uninformative.
const PLACED: f64 = 0.1;
/// Smallest and largest size of a family, and of noise.
const FAMILY: (f64, f64) = (1e-7, 1e-2);
/// The same of κ.
const SHARE: (f64, f64) = (0.03, 20.0);
const NOISE: (f64, f64) = (5e-7, 3e-2);
/// Values per part of the evidence: its cost grows with their cube.
pub const AT_ONCE: usize = 300;
/// Numbers with a smaller prior standard deviation are left out, rad or m.
const NOTHING: f64 = 5e-8;
/// The search ends where the derivatives of -2 log likelihood by the logarithms are below this.
const LEAST_SLOPE: f64 = 0.1;
/// Minorise-maximise steps before the search.
const WARM_UP: usize = 4;

/// The sizes, as natural logarithms.
#[derive(Debug, Clone, PartialEq)]
pub struct Sizes {
    /// σ of each channel.
    pub noise: Vec<f64>,
    /// ρ.
    pub joints: f64,
    /// l.
    pub length: f64,
    /// τ or κ of each family at hand.
    pub families: Vec<(Family, f64)>,
    /// Whether tolerances are used as given, κ = 1, as in the fit of geometry alone.
    pub as_tolerated: bool,
    /// Prior of each channel's noise.
    levels: Vec<f64>,
}

/// The prior of the logarithm of a family's size, for families whose size is a fraction of tolerances.
fn tolerated(family: Family) -> Option<(f64, f64)> {
    match family {
        Family::Geometry => Some(KAPPA),
        Family::Zero => Some(ZERO),
        _ => None,
    }
}

/// Prior median of this family's size, rad or m.
fn usual(family: Family) -> f64 {
    match family {
        Family::Play => USUAL_PLAY,
        Family::Wobble | Family::Pitch => USUAL_RUNOUT,
        _ => USUAL,
    }
}

impl Sizes {
    /// Start of the search: noise of a fit of geometry alone, by channel, and the ratio of its tolerances' variance to the drawing's.
    pub fn start(
        (noise, widened): (&[f64], f64),
        terms: &Terms,
        used: impl Fn(Family) -> bool,
        as_tolerated: bool,
    ) -> Self {
        let mut families: Vec<Family> = terms.families.iter().copied().filter(|family| used(*family)).collect();
        families.sort_unstable();
        families.dedup();
        let start = |family: Family| match tolerated(family) {
            Some(_) if as_tolerated || family == Family::Geometry => 0.5 * widened.ln(),
            Some((mean, _)) => mean,
            None => f64::ln(5e-5),
        };
        let levels: Vec<f64> = noise.iter().map(|level| (0.7 * level).clamp(NOISE.0, NOISE.1).ln()).collect();
        Self {
            noise: levels.clone(),
            joints: f64::ln(3e-5),
            length: LENGTH.0,
            families: families.into_iter().map(|family| (family, start(family))).collect(),
            as_tolerated,
            levels,
        }
    }

    /// Sizes of a model whose terms and tolerances already include them: none is fitted. `noise`: by channel.
    pub fn of_model(noise: &[f64]) -> Self {
        let levels: Vec<f64> = noise.iter().map(|level| level.clamp(NOISE.0, NOISE.1).ln()).collect();
        Self {
            noise: levels.clone(),
            joints: f64::NEG_INFINITY,
            length: LENGTH.0,
            families: [Family::Geometry, Family::Zero, Family::Named].map(|family| (family, 0.0)).to_vec(),
            as_tolerated: true,
            levels,
        }
    }

    fn of(&self, family: Family) -> Option<f64> {
        self.families.iter().find(|(known, _)| *known == family).map(|(_, size)| *size)
    }

    /// Number of sizes.
    pub fn count(&self) -> usize {
        self.numbers().len()
    }

    fn numbers(&self) -> Vec<f64> {
        let families = self.families.iter().map(|(_, size)| *size);
        self.noise.iter().copied().chain([self.joints, self.length]).chain(families).collect()
    }

    fn with(&self, numbers: &[f64]) -> Self {
        let channels = self.noise.len();
        let families = self.families.iter().zip(&numbers[channels + 2..]).map(|((family, _), size)| (*family, *size));
        Self {
            noise: numbers[..channels].to_vec(),
            joints: numbers[channels],
            length: numbers[channels + 1],
            families: families.collect(),
            as_tolerated: self.as_tolerated,
            levels: self.levels.clone(),
        }
    }

    fn bounds(&self) -> Vec<(f64, f64)> {
        let ln = |(low, high): (f64, f64)| (low.ln(), high.ln());
        let family = |(family, size): &(Family, f64)| match tolerated(*family) {
            Some(_) if self.as_tolerated => (*size, *size),
            Some(_) => ln(SHARE),
            None => ln(FAMILY),
        };
        let noise = self.noise.iter().map(|_| ln(NOISE));
        noise.chain([ln((1e-7, 3e-3)), ln((0.05, 2.0))]).chain(self.families.iter().map(family)).collect()
    }

    /// -2 log prior of each size, with its first and second derivative.
    fn expected(&self) -> Vec<[f64; 3]> {
        let cauchy = |size: f64, usual: f64| {
            let ratio = (2.0 * size).exp() / usual.powi(2);
            [2.0 * ratio.ln_1p(), 4.0 * ratio / (1.0 + ratio), 8.0 * ratio / (1.0 + ratio).powi(2)]
        };
        let normal = |size: f64, (mean, deviation): (f64, f64)| {
            let z = (size - mean) / deviation;
            [z * z, 2.0 * z / deviation, 2.0 / deviation.powi(2)]
        };
        let of = |(family, size): &(Family, f64)| {
            tolerated(*family).map_or_else(|| cauchy(*size, usual(*family)), |by| normal(*size, by))
        };
        let noise = self.noise.iter().zip(&self.levels).map(|(size, level)| normal(*size, (*level, LEVEL)));
        let each = noise.chain([cauchy(self.joints, USUAL), normal(self.length, LENGTH)]);
        each.chain(self.families.iter().map(of)).collect()
    }

    /// Prior variance of each number of the model.
    pub fn variances(&self, terms: &Terms) -> Vec<f64> {
        let length = self.length.exp();
        let of = |((family, scale), frequency): ((&Family, &f64), &f64)| {
            let size = self.of(*family).map_or(0.0, |size| (2.0 * size).exp());
            let density = if *family == Family::Curve { density(*frequency, length) } else { 1.0 };
            size * scale * scale * density
        };
        terms.families.iter().zip(&terms.scales).zip(&terms.frequencies).map(of).collect()
    }

    /// Prior variance of a joint's curve, rad² or m².
    pub fn of_curves(&self) -> f64 {
        self.of(Family::Curve).map_or(0.0, |size| (2.0 * size).exp())
    }
}

/// Spectral density of a squared exponential of variance 1.
fn density(frequency: f64, length: f64) -> f64 {
    TAU.sqrt() * length * (-0.5 * (frequency * length).powi(2)).exp()
}

/// The linear problem for these sizes, and its columns: numbers that may be large enough to matter, then the frames.
pub fn problem(rows: &Linearised, terms: &Terms, sizes: &Sizes) -> (Problem, Vec<usize>) {
    let mut variances = sizes.variances(terms);
    variances.resize(rows.columns.ncols(), PLACED * PLACED);
    let chosen: Vec<usize> = (0..variances.len()).filter(|&k| variances[k] > NOTHING * NOTHING).collect();
    let mut noise = Vec::with_capacity(rows.rows.len());
    for (row, weight) in rows.rows.iter().zip(&rows.weights) {
        let mut block = DMatrix::zeros(row.len(), row.len());
        for (k, value) in row.clone().enumerate() {
            block[(k, k)] = rows.channels[value].map_or(1.0, |channel| (2.0 * sizes.noise[channel]).exp());
        }
        if rows.channels[row.start].is_some() {
            for &joint in &terms.joints {
                let moved = rows.columns.view((row.start, joint), (row.len(), 1));
                block += moved * moved.transpose() * (2.0 * sizes.joints).exp();
            }
            block /= *weight;
        }
        noise.push(block);
    }
    let problem = Problem {
        columns: rows.columns.select_columns(&chosen),
        data: rows.data.clone(),
        rows: rows.rows.clone(),
        noise,
        variances: DVector::from_fn(chosen.len(), |k, _| variances[chosen[k]]),
    };
    (problem, chosen)
}

/// The parts of the evidence of some rows: parts of which only the amounts change, and the curves.
struct Parts {
    data: DVector<f64>,
    frames: Part,
    known: Part,
    channels: Vec<Part>,
    joints: Part,
    families: Vec<Option<Part>>,
    curves: Vec<JointCurve>,
    /// The row of each value, and the start of each row, followed by the end of the last.
    row_of: Vec<usize>,
    starts: Vec<usize>,
}

/// -2 log p(y) of some rows for some sizes.
struct Evidence {
    value: f64,
    /// For each size the two parts of half the derivative by its logarithm: see [`Pull`].
    pulls: Vec<[f64; 2]>,
    /// Approximate second derivatives by the same: [`Components::information`].
    information: DMatrix<f64>,
}

/// A joint's curve in some rows.
struct JointCurve {
    /// J_j, of each value.
    moved: Vec<f64>,
    /// Waves, a column for each row, and the frequency and variance per density of each.
    waves: DMatrix<f64>,
    frequencies: Vec<f64>,
    per_density: f64,
}

impl Parts {
    fn of(rows: &Linearised, terms: &Terms, sizes: &Sizes, data: &Measurements) -> Self {
        let values = rows.data.len();
        let diagonal = |wanted: Option<usize>| {
            let mut blocks = Vec::new();
            for (row, weight) in rows.rows.iter().zip(&rows.weights) {
                for value in row.clone().filter(|&value| rows.channels[value] == wanted) {
                    blocks.push((value..value + 1, DMatrix::from_element(1, 1, 1.0 / weight)));
                }
            }
            Part::Rows(blocks)
        };
        let by_joints = rows.rows.iter().zip(&rows.weights).map(|(row, weight)| {
            let moved = rows.columns.rows(row.start, row.len()).select_columns(&terms.joints);
            (row.clone(), &moved * moved.transpose() / *weight)
        });
        let family = |(family, _): &(Family, f64)| {
            (*family != Family::Curve).then(|| {
                let own: Vec<usize> = (0..terms.families.len()).filter(|&k| terms.families[k] == *family).collect();
                let mut columns = rows.columns.select_columns(&own);
                columns.column_iter_mut().zip(&own).for_each(|(mut column, &k)| column.scale_mut(terms.scales[k]));
                Part::of_columns(&columns)
            })
        };
        let mut row_of = vec![0; values];
        for (index, row) in rows.rows.iter().enumerate() {
            row_of[row.clone()].fill(index);
        }
        let mut curves = Vec::new();
        if sizes.of(Family::Curve).is_some() {
            let mut first = terms.model.coefficients();
            for (curve, &joint) in terms.model.0.curves.iter().zip(&terms.joints) {
                curves.push(JointCurve {
                    moved: rows.columns.column(joint).iter().copied().collect(),
                    waves: waves(rows, terms, curve, data),
                    frequencies: terms.frequencies[first..first + curve.waves.len()].to_vec(),
                    per_density: curve.waves.variance_per_density(),
                });
                first += curve.waves.len();
            }
        }
        let frames = rows.columns.columns(rows.of_model, rows.columns.ncols() - rows.of_model).into_owned();
        Self {
            data: rows.data.clone(),
            frames: Part::of_columns(&frames),
            known: diagonal(None),
            channels: (0..sizes.noise.len()).map(|channel| diagonal(Some(channel))).collect(),
            joints: Part::Rows(by_joints.collect()),
            families: sizes.families.iter().map(family).collect(),
            curves,
            row_of,
            starts: rows.rows.iter().map(|row| row.start).chain([values]).collect(),
        }
    }

    /// The curves' covariance of the values for a length, and its derivative by the logarithm of that.
    fn curves(&self, length: f64) -> [Part; 2] {
        let values = self.data.len();
        let mut both = [DMatrix::zeros(values, values), DMatrix::zeros(values, values)];
        for curve in &self.curves {
            // Fast waves are negligible.
            let own: Vec<usize> =
                (0..curve.frequencies.len()).filter(|&k| density(curve.frequencies[k], length) > 1e-12).collect();
            let (waves, count) = (curve.waves.select_rows(&own), own.len());
            if count == 0 {
                continue;
            }
            let sizes: Vec<[f64; 2]> = own
                .iter()
                .map(|&k| {
                    let size = curve.per_density * density(curve.frequencies[k], length);
                    [size, size * (1.0 - (curve.frequencies[k] * length).powi(2))]
                })
                .collect();
            for (slope, sum) in both.iter_mut().enumerate() {
                let scaled = DMatrix::from_fn(count, waves.ncols(), |k, row| sizes[k][slope] * waves[(k, row)]);
                let kernel = cross_gram(scaled.as_slice(), waves.as_slice(), count);
                self.add_kernel(&kernel, &curve.moved, sum);
            }
        }
        for sum in &mut both {
            sum.fill_lower_triangle_with_upper_triangle();
        }
        both.map(Part::All)
    }

    /// Adds to the upper triangle of a covariance of values: `moved` of each value, with this covariance of the rows.
    fn add_kernel(&self, kernel: &[f64], moved: &[f64], sum: &mut DMatrix<f64>) {
        let (values, rows) = (moved.len(), self.starts.len() - 1);
        for (right, column) in sum.as_mut_slice().chunks_exact_mut(values).enumerate() {
            let kernel = &kernel[self.row_of[right] * rows..];
            let rows = kernel[..=self.row_of[right]].iter().zip(self.starts.windows(2));
            for (kernel, ends) in rows {
                let times = kernel * moved[right];
                let own = ends[0]..ends[1];
                let cells = column[own.clone()].iter_mut().zip(&moved[own]);
                cells.for_each(|(cell, moved)| *cell += times * moved);
            }
        }
    }

    /// -2 log p(y), and its derivatives by the logarithm of each size.
    fn evidence(&self, sizes: &Sizes) -> Option<Evidence> {
        let amount = |size: f64| (2.0 * size).exp();
        let curves = (!self.curves.is_empty()).then(|| self.curves(sizes.length.exp()));
        let mut parts: Vec<(Option<&Part>, f64)> = Vec::new();
        parts.extend(self.channels.iter().zip(&sizes.noise).map(|(part, size)| (Some(part), amount(*size))));
        parts.push((Some(&self.joints), amount(sizes.joints)));
        // The length is not an amount: its index is reserved.
        parts.push((None, 0.0));
        for (own, (_, size)) in self.families.iter().zip(&sizes.families) {
            parts.push((own.as_ref().or(curves.as_ref().map(|[curves, _]| curves)), amount(*size)));
        }
        let always = [(&self.frames, PLACED * PLACED), (&self.known, 1.0)];
        let all = parts.iter().filter_map(|(part, amount)| Some(((*part)?, *amount))).chain(always);
        let found = Components::of(&self.data, all)?;
        let mut along = DMatrix::zeros(self.data.len(), parts.len());
        let mut pulls = vec![[0.0; 2]; parts.len()];
        let mut take = |place: usize, part: &Part, amount: f64| {
            let Pull { wide, narrow, along: own } = found.pull(part);
            pulls[place] = [wide * amount, narrow * amount];
            along.column_mut(place).axpy(2.0 * amount, &own, 0.0);
        };
        for (place, (part, amount)) in parts.iter().enumerate() {
            if let Some(part) = part {
                take(place, part, *amount);
            }
        }
        if let (Some([_, by_length]), Some(size)) = (&curves, sizes.of(Family::Curve)) {
            take(sizes.noise.len() + 1, by_length, 0.5 * amount(size));
        }
        Some(Evidence { value: found.evidence, information: found.information(&along), pulls })
    }

    /// The sum of the variances that a family adds per unit of its amount.
    fn trace(&self, family: usize, length: f64) -> f64 {
        self.families[family].as_ref().map_or_else(|| self.curves(length)[0].trace(), Part::trace)
    }
}

/// The most probable sizes for some rows of the data, part by part; `start` where there are none better. `anew`: whether `start` was found without
/// the rows.
pub fn fitted(
    rows: &Linearised,
    data: &Measurements,
    terms: &Terms,
    start: &Sizes,
    (most, anew): (usize, bool),
) -> Sizes {
    let parts: Vec<Parts> = rows.parts().iter().map(|rows| Parts::of(rows, terms, start, data)).collect();
    let evidence = |sizes: &Sizes| {
        let count = sizes.numbers().len();
        let mut sum = Evidence { value: 0.0, pulls: vec![[0.0; 2]; count], information: DMatrix::zeros(count, count) };
        for found in each_alone(&parts, |part| part.evidence(sizes)) {
            let own = found?;
            sum.value += own.value;
            sum.information += own.information;
            sum.pulls.iter_mut().zip(own.pulls).for_each(|(pull, own)| *pull = [pull[0] + own[0], pull[1] + own[1]]);
        }
        Some(sum)
    };
    let objective = |numbers: &[f64]| {
        let sizes = start.with(numbers);
        let Evidence { mut value, pulls, information: mut curvature } = evidence(&sizes)?;
        let mut slope = DVector::from_iterator(pulls.len(), pulls.iter().map(|[wide, narrow]| 2.0 * (wide - narrow)));
        for (k, [expected, by_size, curved]) in sizes.expected().into_iter().enumerate() {
            value += expected;
            slope[k] += by_size;
            curvature[(k, k)] += curved;
        }
        Some(Local { value, slope, curvature })
    };
    // With tolerances as given only the noise is unknown: there is no plateau.
    let anew = anew && !start.as_tolerated;
    let search = |start: &Sizes| {
        let mut from = start.clone();
        if anew {
            for _ in 0..WARM_UP {
                from = from.balanced(&evidence(&from)?.pulls);
            }
        }
        minimise(&mut |numbers: &[f64]| objective(numbers), &from.numbers(), &start.bounds(), most, LEAST_SLOPE)
    };
    let mut starts = vec![start.clone()];
    if anew {
        starts.push(start.as_large_as_noise(&parts));
    }
    // Small matrices: one thread per part and start, and none within a part.
    let found =
        in_parallel(&starts, |start| if parts.len() > 1 { search(start) } else { on_this_thread(|| search(start)) });
    let best = found.into_iter().flatten().min_by(|a, b| a.1.total_cmp(&b.1));
    best.map_or_else(|| start.clone(), |(numbers, _)| start.with(&numbers))
}

impl Sizes {
    /// Sizes with which every family and the joints' repeatability add a tenth of the noise variance, geometry in its tolerances. The evidence
    /// has no slope at sizes far below the noise.
    fn as_large_as_noise(&self, parts: &[Parts]) -> Self {
        let sum = |of: &dyn Fn(&Parts) -> f64| parts.iter().map(of).sum::<f64>();
        let noise = sum(&|part| {
            let channels = part.channels.iter().zip(&self.noise);
            channels.map(|(part, size)| part.trace() * (2.0 * size).exp()).sum()
        });
        let size = |own: f64, usual: f64, otherwise: f64| {
            if own > 0.0 { (0.1 * noise / own).sqrt().clamp(FAMILY.0, usual).ln() } else { otherwise }
        };
        let mut large = self.clone();
        large.joints = size(sum(&|part| part.joints.trace()), USUAL, self.joints);
        for (k, (family, own)) in large.families.iter_mut().enumerate() {
            *own = match tolerated(*family) {
                Some((mean, _)) => mean,
                None => size(sum(&|part| part.trace(k, self.length.exp())), usual(*family), *own),
            };
        }
        large
    }

    /// A minorise-maximise step, which needs no slope and so leaves plateaus: each amount times the root of the ratio of its upward and
    /// downward pull (Zhou, Hu, Zhou, Lange 2019, Journal of Computational and Graphical Statistics 28, 350). Fractions of tolerances
    /// and the length stay.
    fn balanced(&self, pulls: &[[f64; 2]]) -> Self {
        let expected = self.expected();
        let (mut numbers, bounds) = (self.numbers(), self.bounds());
        let channels = self.noise.len();
        for (k, number) in numbers.iter_mut().enumerate() {
            let family = k.checked_sub(channels + 2).map(|at| self.families[at].0);
            let amount = k <= channels || family.is_some_and(|family| tolerated(family).is_none());
            let [wide, narrow] = pulls[k];
            let wide = wide + 0.5 * expected[k][1];
            if amount && wide > 0.0 {
                let step = 0.25 * (narrow.max(f64::MIN_POSITIVE) / wide).ln();
                *number = (*number + step).clamp(bounds[k].0, bounds[k].1);
            }
        }
        self.with(&numbers)
    }
}

/// Waves of a joint's curve, a column for each row.
fn waves(rows: &Linearised, terms: &Terms, curve: &Curve, data: &Measurements) -> DMatrix<f64> {
    let joint = &terms.model.0.statics.chain.joints()[curve.joint];
    let mut all = DMatrix::zeros(curve.waves.len(), rows.rows.len());
    for (row, sources) in rows.sources.iter().enumerate() {
        if let Some((source, _)) = sources.first() {
            let values = curve.waves.values(joint.value(data.reading(*source)));
            values.into_iter().enumerate().for_each(|(k, value)| all[(k, row)] = value);
        }
    }
    all
}

impl Linearised {
    /// Parts of `AT_ONCE` values, with rows dealt in turn.
    fn parts(&self) -> Vec<Self> {
        let count = self.data.len().div_ceil(AT_ONCE).max(1);
        (0..count)
            .map(|part| {
                let rows: Vec<usize> = (0..self.rows.len()).filter(|row| row % count == part).collect();
                let values: Vec<usize> = rows.iter().flat_map(|&row| self.rows[row].clone()).collect();
                let mut from = 0;
                let ranges = rows.iter().map(|&row| {
                    from += self.rows[row].len();
                    from - self.rows[row].len()..from
                });
                Self {
                    rows: ranges.collect(),
                    columns: self.columns.select_rows(&values),
                    data: DVector::from_fn(values.len(), |k, _| self.data[values[k]]),
                    channels: values.iter().map(|&value| self.channels[value]).collect(),
                    weights: rows.iter().map(|&row| self.weights[row]).collect(),
                    sources: rows.iter().map(|&row| self.sources[row].clone()).collect(),
                    of_model: self.of_model,
                }
            })
            .collect()
    }
}
