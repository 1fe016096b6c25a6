//! Variances of several sources of noise, by restricted maximum likelihood: Patterson and Thompson, Biometrika 58 (1971), 545.
//!
//! With y the residuals of a fit and X the columns of its free numbers,
//!
//! ```text
//! y = X β + ε      ε of a row ~ N(0, V_i),  V_i = Σ_k t_k B_ik B_ikᵀ      β ~ N(mean, prior⁻¹), flat where the prior is 0
//! deviance = Σ log|V_i| + log|A| + yᵀ V⁻¹ y - gᵀ A⁻¹ g      A = Xᵀ V⁻¹ X + prior,  g = Xᵀ V⁻¹ y + pull
//! ```
//! is -2 times the logarithm of the likelihood. β is integrated out, which accounts for the degrees of freedom of the geometry.
//! Rows are independent, so V is a small block for each row and no matrix of the size of all values is formed; a step costs as
//! much as forming A. The matrix of second derivatives is the average information of Gilmour, Thompson and Cullis, Biometrics 51
//! (1995), 1440; variances are not negative (projected Newton steps, Bertsekas 1982).

use denavit_linear::products::{TILE, add_gram, gram_of, subtract};
use denavit_linear::threads::in_parallel;
use denavit_linear::triangle::{Triangle, dot};
use denavit_model::nalgebra::{DMatrix, DVector};
use std::ops::Range;

/// Values in a part, about: rows are processed in parts so that their columns stay in the cache.
const VALUES_OF_A_PART: usize = 384;
/// Fewer parts than this are faster without threads.
const PARTS_FOR_THREADS: usize = 6;
/// Most steps.
const MOST_STEPS: usize = 200;
/// A step that changes the deviance by less than this fraction of it, and the variances by less than [`SAME_VARIANCE`], is the last.
const SAME_DEVIANCE: f64 = 1e-10;
/// Fraction of a variance; for a variance below this fraction of the whole noise, fraction of this bound.
const SAME_VARIANCE: f64 = 1e-6;
/// Smallest variance of a channel's level relative to the whole noise: keeps blocks invertible.
pub const LEAST_LEVEL: f64 = 1e-9;
/// Fraction of the predicted gain that a step must reach.
const ENOUGH: f64 = 1e-4;
/// Most halvings of a step.
const MOST_HALVINGS: usize = 40;
/// Rounding error of the deviance, relative to the number of values.
const ROUNDING: f64 = 1e-13;

/// Contribution of one source to the covariance of a row per unit of its variance: B Bᵀ.
#[derive(Debug, Clone, PartialEq)]
pub struct Factor {
    /// Index of the source.
    pub source: usize,
    /// B, column by column; a column has one cell per value of the row.
    pub cells: Vec<f64>,
}

/// One row of measured values.
#[derive(Debug, Clone, PartialEq)]
pub struct RowBlock {
    /// y.
    pub residual: Vec<f64>,
    /// X, column by column.
    pub columns: Vec<f64>,
    /// Contribution of each source; sources not listed contribute nothing.
    pub factors: Vec<Factor>,
    /// Whether the next row was measured right after this one and has the same kinds of values.
    pub has_next: bool,
}

impl RowBlock {
    fn height(&self) -> usize {
        self.residual.len()
    }
}

/// Rows whose columns are stored together.
#[derive(Debug, Clone)]
struct Part {
    rows: Vec<RowPlace>,
    /// X, value by value.
    x: Vec<f64>,
    y: Vec<f64>,
}

#[derive(Debug, Clone)]
struct RowPlace {
    first: usize,
    height: usize,
    factors: Vec<Factor>,
    has_next: bool,
}

/// All rows and the prior of β.
#[derive(Debug, Clone)]
pub struct Reml {
    parts: Vec<Part>,
    columns: usize,
    sources: usize,
    prior: DMatrix<f64>,
    pull: DVector<f64>,
    values: usize,
    /// Least variance of each source.
    least: Vec<f64>,
}

/// How the variances of all sources depend on fewer numbers: t_k = factor_k · ψ_of_k, or 0.
#[derive(Debug, Clone, PartialEq)]
pub struct Tied {
    /// For each source the number that it depends on and the factor; `None`: it contributes nothing.
    pub of: Vec<Option<(usize, f64)>>,
    /// Count of these numbers.
    pub count: usize,
}

impl Tied {
    /// Every source has a variance of its own.
    pub fn each(sources: usize) -> Self {
        Self { of: (0..sources).map(|k| Some((k, 1.0))).collect(), count: sources }
    }

    /// The same, but the sources of this number contribute nothing. The number keeps its index, without meaning.
    #[must_use]
    pub fn at_zero(&self, number: usize) -> Self {
        let of = self.of.iter().map(|of| of.filter(|(own, _)| *own != number)).collect();
        Self { of, count: self.count }
    }

    /// Variances of all sources.
    pub fn variances(&self, numbers: &[f64]) -> Vec<f64> {
        self.of.iter().map(|of| of.map_or(0.0, |(own, factor)| factor * numbers[own])).collect()
    }
}

/// The deviance at some variances, and how it changes with them.
#[derive(Debug, Clone)]
pub struct Slope {
    /// -2 log likelihood, up to a constant.
    pub deviance: f64,
    /// First derivatives by the sources' variances.
    pub gradient: DVector<f64>,
    /// Average information, the average of the deviance's second derivatives; a column per source. The gradient's covariance is
    /// twice this.
    pub information: DMatrix<f64>,
    /// Each row's contribution to the gradient, a column per row.
    pub scores: DMatrix<f64>,
    /// Sum over neighbours in the run of the products of their whitened residuals, corrected for the correlation that the fit
    /// causes between independent rows, and the number of products.
    pub lag: (f64, f64),
    /// Sums of squares and of fourth powers of the whitened residuals.
    pub powers: (f64, f64),
    /// Values that the free numbers use up.
    pub used: f64,
}

/// The likeliest variances.
#[derive(Debug, Clone)]
pub struct Likeliest {
    /// The numbers that the sources depend on.
    pub numbers: Vec<f64>,
    /// The deviance and its slope there.
    pub slope: Slope,
    /// Steps taken.
    pub steps: usize,
}

/// A part with whitened rows.
struct Whitened {
    /// L⁻¹ X, value by value.
    x: Vec<f64>,
    /// L⁻¹ y.
    y: Vec<f64>,
    /// Lower triangles L of V_i = L Lᵀ, one full square block per row, column by column.
    factors: Vec<f64>,
    log_determinant: f64,
    /// Products of the columns of x and y, each with those to its right and with itself.
    gram: Vec<f64>,
}

/// The factor A = R Rᵀ for integrating out β.
struct Integrated {
    deviance: f64,
    factor: Triangle,
    /// R⁻¹ g.
    half: Vec<f64>,
}

/// Sums of a part, or of all.
struct Sums {
    gradient: DVector<f64>,
    /// Of the whitened sources.
    gram: DMatrix<f64>,
    /// R⁻¹ Xᵀ times them.
    along: DMatrix<f64>,
    scores: Vec<f64>,
    lag: (f64, f64),
    powers: (f64, f64),
    used: f64,
}

impl Reml {
    /// # Shape and units
    /// Each row's `columns` has as many columns as `prior` and `pull`; `least`: for each source, 0 or [`LEAST_LEVEL`]. Values are in units
    /// of their noise, so that variances are of the order of 1.
    pub fn new(rows: Vec<RowBlock>, prior: DMatrix<f64>, pull: DVector<f64>, least: Vec<f64>) -> Self {
        let columns = pull.len();
        let values = rows.iter().map(RowBlock::height).sum();
        let mut parts = Vec::new();
        let mut own: Vec<RowBlock> = Vec::new();
        let mut height = 0;
        for row in rows {
            height += row.height();
            own.push(row);
            if height >= VALUES_OF_A_PART {
                parts.push(part(std::mem::take(&mut own), columns));
                height = 0;
            }
        }
        if !own.is_empty() {
            parts.push(part(own, columns));
        }
        Self { parts, columns, sources: least.len(), prior, pull, values, least }
    }

    /// The same rows, with each row's factors changed in place.
    pub(super) fn refactored(mut self, change: impl Fn(usize, &mut Vec<Factor>)) -> Self {
        for (index, row) in self.parts.iter_mut().flat_map(|part| &mut part.rows).enumerate() {
            change(index, &mut row.factors);
        }
        self
    }

    /// The same with `more` additional sources, whose factors `change` adds.
    pub(super) fn with_sources(self, more: usize, change: impl Fn(usize, &mut Vec<Factor>)) -> Self {
        let mut changed = self.refactored(change);
        changed.sources += more;
        changed.least.resize(changed.sources, 0.0);
        changed
    }

    /// Number of values.
    pub fn values(&self) -> usize {
        self.values
    }

    /// The deviance; infinite if a row's covariance has no inverse.
    ///
    /// # Shape and units
    /// `variances`: one for each source.
    pub fn deviance(&self, variances: &[f64]) -> f64 {
        let whitened = self.whitened(variances);
        whitened.and_then(|whitened| self.integrated(&whitened)).map_or(f64::INFINITY, |found| found.deviance)
    }

    /// The deviance and its derivatives; `None` if a row's covariance has no inverse.
    pub fn slope(&self, variances: &[f64]) -> Option<Slope> {
        self.slope_of(variances, &vec![true; self.sources])
    }

    /// The same, with derivatives by the wanted sources only.
    fn slope_of(&self, variances: &[f64], wanted: &[bool]) -> Option<Slope> {
        let whitened = self.whitened(variances)?;
        let integrated = self.integrated(&whitened)?;
        let both: Vec<(&Part, &Whitened)> = self.parts.iter().zip(&whitened).collect();
        let sums = each_part(&both, |(part, whitened)| self.sums(part, whitened, wanted, &integrated));
        let (sources, columns) = (self.sources, self.columns);
        let mut total = Sums {
            gradient: DVector::zeros(sources),
            gram: DMatrix::zeros(sources, sources),
            along: DMatrix::zeros(columns, sources),
            scores: Vec::new(),
            lag: (0.0, 0.0),
            powers: (0.0, 0.0),
            used: 0.0,
        };
        for sums in sums {
            total.gradient += sums.gradient;
            total.gram += sums.gram;
            total.along += sums.along;
            total.scores.extend(sums.scores);
            total.lag = (total.lag.0 + sums.lag.0, total.lag.1 + sums.lag.1);
            total.powers = (total.powers.0 + sums.powers.0, total.powers.1 + sums.powers.1);
            total.used += sums.used;
        }
        let rows = total.scores.len() / sources.max(1);
        Some(Slope {
            deviance: integrated.deviance,
            gradient: total.gradient,
            information: total.gram - total.along.transpose() * &total.along,
            scores: DMatrix::from_vec(sources, rows, total.scores),
            lag: total.lag,
            powers: total.powers,
            used: total.used,
        })
    }

    /// The variances at which the likelihood is largest, none below its lower bound; numbers that are `held` keep their values.
    ///
    /// `enough`: stops when a step is predicted to gain less deviance than this; 0 for full convergence.
    /// `None` if the rows' covariances have no inverse at `start`.
    pub fn likeliest(&self, tied: &Tied, start: &[f64], held: &[usize], enough: f64) -> Option<Likeliest> {
        let least = self.least_of(tied);
        let moved = |k: usize| if held.contains(&k) { start[k] } else { start[k].max(least[k]) };
        let start: Vec<f64> = (0..tied.count).map(moved).collect();
        let wanted: Vec<bool> = tied.of.iter().map(Option::is_some).collect();
        let slope = self.slope_of(&tied.variances(&start), &wanted)?;
        self.likeliest_from(tied, (&start, slope), held, enough)
    }

    /// As [`likeliest`](Self::likeliest), with the slope at `start` given, at least by the sources that depend on a number.
    pub fn likeliest_from(
        &self,
        tied: &Tied,
        (start, mut slope): (&[f64], Slope),
        held: &[usize],
        enough: f64,
    ) -> Option<Likeliest> {
        let least = self.least_of(tied);
        let mut numbers: Vec<f64> = start.to_vec();
        let free: Vec<usize> = (0..tied.count)
            .filter(|k| !held.contains(k) && tied.of.iter().flatten().any(|(own, _)| own == k))
            .collect();
        let wanted: Vec<bool> = tied.of.iter().map(Option::is_some).collect();
        let mut steps = 0;
        while steps < MOST_STEPS && !free.is_empty() {
            let (gradient, information) = of_numbers(tied, &slope);
            let room: Vec<f64> = free.iter().map(|&k| numbers[k] - least[k]).collect();
            let pull = gradient.select_rows(&free);
            let curvature = information.select_rows(&free).select_columns(&free);
            let step = bounded_step(&pull, &curvature, &room);
            let promised = -pull.dot(&step) - 0.5 * step.dot(&(&curvature * &step));
            if promised <= enough.max(ROUNDING * self.values as f64) {
                break;
            }
            steps += 1;
            let Some((next, reached)) =
                self.along(tied, &wanted, &numbers, &slope, (&free, &step, pull.dot(&step)), &least)
            else {
                break;
            };
            let changed = numbers.iter().zip(&next).map(|(a, b)| (a - b).abs() / a.max(*b).max(SAME_VARIANCE));
            let changed = changed.fold(0.0, f64::max);
            let gain = slope.deviance - reached.deviance;
            (numbers, slope) = (next, reached);
            if gain <= SAME_DEVIANCE * slope.deviance.abs().max(1.0) && changed <= SAME_VARIANCE {
                break;
            }
        }
        Some(Likeliest { numbers, slope, steps })
    }

    /// The lower bound of each number.
    fn least_of(&self, tied: &Tied) -> Vec<f64> {
        let mut least = vec![0.0f64; tied.count];
        for (of, own) in tied.of.iter().zip(&self.least) {
            if let Some((number, factor)) = of {
                least[*number] = least[*number].max(own / factor);
            }
        }
        least
    }

    /// The next numbers along a step, and the slope there; `None` if the deviance falls no further.
    ///
    /// The step: which numbers, the change of each, and the change of the deviance per unit of the step.
    fn along(
        &self,
        tied: &Tied,
        wanted: &[bool],
        numbers: &[f64],
        slope: &Slope,
        (free, step, change): (&[usize], &DVector<f64>, f64),
        least: &[f64],
    ) -> Option<(Vec<f64>, Slope)> {
        let mut share = 1.0;
        for _ in 0..MOST_HALVINGS {
            let mut next = numbers.to_vec();
            for (k, step) in free.iter().zip(step.iter()) {
                next[*k] = (numbers[*k] + share * step).max(least[*k]);
            }
            let reached = self.slope_of(&tied.variances(&next), wanted);
            let enough = |reached: &Slope| slope.deviance - reached.deviance >= -ENOUGH * share * change;
            if let Some(reached) = reached.filter(enough) {
                return Some((next, reached));
            }
            share *= 0.5;
        }
        None
    }

    fn whitened(&self, variances: &[f64]) -> Option<Vec<Whitened>> {
        each_part(&self.parts, |part| whiten(part, variances, self.columns)).into_iter().collect()
    }

    fn integrated(&self, parts: &[Whitened]) -> Option<Integrated> {
        let columns = self.columns;
        let width = width_of(columns);
        // Row by row, the lower triangle.
        let mut matrix = self.prior.as_slice().to_vec();
        let mut gradient = self.pull.clone();
        let (mut squares, mut log_determinant) = (0.0, 0.0);
        for part in parts {
            for k in 0..columns {
                for i in 0..=k {
                    matrix[k * columns + i] += part.gram[k * width + i];
                }
                gradient[k] += part.gram[columns * width + k];
            }
            squares += part.gram[columns * width + columns];
            log_determinant += part.log_determinant;
        }
        let factor = Triangle::factor(matrix, columns)?;
        let half = factor.forward(gradient.as_slice());
        let deviance = log_determinant + factor.log_determinant() + squares - dot(&half, &half);
        deviance.is_finite().then_some(Integrated { deviance, factor, half })
    }

    fn sums(&self, part: &Part, whitened: &Whitened, wanted: &[bool], integrated: &Integrated) -> Sums {
        let (sources, columns) = (self.sources, self.columns);
        // R⁻¹ x of each value: products of two of these are the covariance that the free numbers cause.
        let reduced = integrated.factor.forward_all(whitened.x.clone());
        let of_values = |values: Range<usize>| &reduced[values.start * columns..values.end * columns];
        let mut sums = Sums {
            gradient: DVector::zeros(sources),
            gram: DMatrix::zeros(sources, sources),
            along: DMatrix::zeros(columns, sources),
            scores: vec![0.0; sources * part.rows.len()],
            lag: (0.0, 0.0),
            powers: (0.0, 0.0),
            used: 0.0,
        };
        let left: Vec<f64> =
            whitened.y.iter().enumerate().map(|(k, y)| y - dot(of_values(k..k + 1), &integrated.half)).collect();
        let mut at_factor = 0;
        let mut moved: Vec<Vec<f64>> = vec![Vec::new(); sources];
        let mut c = Vec::new();
        for (index, row) in part.rows.iter().enumerate() {
            let (h, first) = (row.height, row.first);
            let own = first..first + h;
            let factor = &whitened.factors[at_factor..at_factor + h * h];
            at_factor += h * h;
            let left_here = &left[own.clone()];
            let hat = if columns == 0 { vec![0.0; h * h] } else { gram_of(of_values(own.clone()), columns) };
            sums.used += (0..h).map(|k| hat[k * h + k]).sum::<f64>();
            for moved in &mut moved {
                moved.clear();
                moved.resize(h, 0.0);
            }
            for of in row.factors.iter().filter(|of| wanted[of.source]) {
                for b in of.cells.chunks_exact(h) {
                    c.clear();
                    c.extend_from_slice(b);
                    solve_lower(factor, h, &mut c);
                    let pull: f64 = c.iter().zip(left_here).map(|(c, e)| c * e).sum();
                    let mut trace = 0.0;
                    for k in 0..h {
                        let through: f64 = (0..h).map(|i| hat[k * h + i] * c[i]).sum();
                        trace += c[k] * (c[k] - through);
                        // The opposite, as it is taken away below.
                        moved[of.source][k] -= c[k] * pull;
                    }
                    sums.scores[index * sources + of.source] += trace - pull * pull;
                }
            }
            for k in 0..sources {
                sums.gradient[k] += sums.scores[index * sources + k];
            }
            let here: Vec<usize> =
                (0..sources).filter(|&k| wanted[k] && row.factors.iter().any(|of| of.source == k)).collect();
            for &k in &here {
                for &l in &here {
                    sums.gram[(k, l)] += moved[k].iter().zip(&moved[l]).map(|(a, b)| a * b).sum::<f64>();
                }
                subtract(of_values(own.clone()), &moved[k], &mut sums.along.as_mut_slice()[k * columns..][..columns]);
            }
            for e in left_here {
                sums.powers = (sums.powers.0 + e * e, sums.powers.1 + e.powi(4));
            }
            if row.has_next && index + 1 < part.rows.len() {
                // The fit correlates the residuals of independent rows: their expected product is minus this.
                let next = own.end..own.end + h;
                let product: f64 = left_here.iter().zip(&left[next.clone()]).map(|(a, b)| a * b).sum();
                let product = product + dot(of_values(own), of_values(next));
                sums.lag = (sums.lag.0 + product, sums.lag.1 + h as f64);
            }
        }
        sums
    }
}

/// Work on each part, on several cores if there are enough parts.
fn each_part<T: Sync, R: Send>(parts: &[T], work: impl Fn(&T) -> R + Sync) -> Vec<R> {
    if parts.len() < PARTS_FOR_THREADS { parts.iter().map(work).collect() } else { in_parallel(parts, work) }
}

fn width_of(columns: usize) -> usize {
    (columns + 1).next_multiple_of(TILE.0)
}

fn part(rows: Vec<RowBlock>, columns: usize) -> Part {
    let values: usize = rows.iter().map(RowBlock::height).sum();
    let mut x = vec![0.0; values * columns];
    let mut y = Vec::with_capacity(values);
    let mut places = Vec::with_capacity(rows.len());
    for row in rows {
        let (height, first) = (row.height(), y.len());
        for (column, own) in row.columns.chunks_exact(height).enumerate() {
            own.iter().enumerate().for_each(|(k, cell)| x[(first + k) * columns + column] = *cell);
        }
        y.extend_from_slice(&row.residual);
        places.push(RowPlace { first, height, factors: row.factors, has_next: row.has_next });
    }
    Part { rows: places, x, y }
}

fn whiten(part: &Part, variances: &[f64], columns: usize) -> Option<Whitened> {
    let mut factors = Vec::with_capacity(part.rows.iter().map(|row| row.height * row.height).sum());
    let mut log_determinant = 0.0;
    for row in &part.rows {
        let h = row.height;
        let start = factors.len();
        factors.resize(start + h * h, 0.0);
        let block = &mut factors[start..];
        for of in &row.factors {
            let variance = variances[of.source];
            if variance == 0.0 {
                continue;
            }
            for b in of.cells.chunks_exact(h) {
                for k in 0..h {
                    let own = variance * b[k];
                    if own != 0.0 {
                        for i in k..h {
                            block[k * h + i] += own * b[i];
                        }
                    }
                }
            }
        }
        log_determinant += factor_lower(block, h)?;
    }
    let (mut x, mut y) = (part.x.clone(), part.y.clone());
    let (mut at, mut times) = (0, Vec::new());
    for row in &part.rows {
        let (h, first) = (row.height, row.first);
        let factor = &factors[at..at + h * h];
        at += h * h;
        solve_lower(factor, h, &mut y[first..first + h]);
        for k in 0..h {
            let (before, own) = x[first * columns..].split_at_mut(k * columns);
            let own = &mut own[..columns];
            times.clear();
            times.extend((0..k).map(|j| factor[j * h + k]));
            subtract(before, &times, own);
            for cell in own {
                *cell /= factor[k * h + k];
            }
        }
    }
    let width = width_of(columns);
    let values = y.len();
    let mut cells = vec![0.0; width * values];
    for (value, x) in x.chunks_exact(columns.max(1)).enumerate() {
        x.iter().enumerate().for_each(|(column, cell)| cells[column * values + value] = *cell);
    }
    cells[columns * values..(columns + 1) * values].copy_from_slice(&y);
    let mut gram = vec![0.0; width * width];
    add_gram(&cells, values, values, &mut gram);
    Some(Whitened { x, y, factors, log_determinant, gram })
}

/// Replaces a symmetric matrix, given by its lower triangle column by column, by its factor L; returns the logarithm of its determinant.
fn factor_lower(block: &mut [f64], h: usize) -> Option<f64> {
    let mut log_determinant = 0.0;
    for k in 0..h {
        let pivot = block[k * h + k];
        if !(pivot > 0.0 && pivot.is_finite()) {
            return None;
        }
        log_determinant += pivot.ln();
        let root = pivot.sqrt();
        for i in k..h {
            block[k * h + i] /= root;
        }
        for j in k + 1..h {
            let own = block[k * h + j];
            for i in j..h {
                block[j * h + i] -= own * block[k * h + i];
            }
        }
    }
    Some(log_determinant)
}

/// x ← L⁻¹ x.
#[inline]
fn solve_lower(factor: &[f64], h: usize, x: &mut [f64]) {
    for k in 0..h {
        let column = &factor[k * h..(k + 1) * h];
        let value = x[k] / column[k];
        x[k] = value;
        for i in k + 1..h {
            x[i] -= column[i] * value;
        }
    }
}

/// Gradient and information by the numbers that the variances depend on.
pub fn of_numbers(tied: &Tied, slope: &Slope) -> (DVector<f64>, DMatrix<f64>) {
    let mut gradient = DVector::zeros(tied.count);
    let mut information = DMatrix::zeros(tied.count, tied.count);
    for (k, of) in tied.of.iter().enumerate() {
        let Some((number, factor)) = of else { continue };
        gradient[*number] += factor * slope.gradient[k];
        for (l, other) in tied.of.iter().enumerate() {
            if let Some((second, by)) = other {
                information[(*number, *second)] += factor * by * slope.information[(k, l)];
            }
        }
    }
    (gradient, information)
}

/// The step d that minimizes gᵀ d + ½ dᵀ H d if no number falls by more than its room: the active sets of Lawson and Hanson
/// (Solving Least Squares Problems, 1974, chapter 23). Newton steps that are clipped at the bounds one by one need not descend.
fn bounded_step(gradient: &DVector<f64>, curvature: &DMatrix<f64>, room: &[f64]) -> DVector<f64> {
    let count = room.len();
    let mut step = DVector::<f64>::zeros(count);
    let mut inside: Vec<bool> = (0..count).map(|k| room[k] > 0.0).collect();
    let size = |k: usize| curvature[(k, k)].abs().max(f64::MIN_POSITIVE);
    for _ in 0..4 * count + 4 {
        // To the minimum over the numbers inside, or until one of them reaches its bound.
        while inside.contains(&true) {
            let own: Vec<usize> = (0..count).filter(|&k| inside[k]).collect();
            let goal = unbounded(gradient, curvature, &own, &step, &inside);
            let mut share = 1.0;
            let mut first = None;
            for (at, &k) in own.iter().enumerate() {
                let fall = step[k] - goal[at];
                if fall > 0.0 && goal[at] < -room[k] {
                    let until = (step[k] + room[k]) / fall;
                    if until < share {
                        (share, first) = (until.max(0.0), Some(k));
                    }
                }
            }
            for (at, &k) in own.iter().enumerate() {
                step[k] += share * (goal[at] - step[k]);
            }
            let Some(k) = first else { break };
            step[k] = -room[k];
            inside[k] = false;
        }
        let slope = gradient + curvature * &step;
        let worst = (0..count)
            .filter(|&k| !inside[k] && slope[k] < -1e-12 * (gradient[k].abs() + size(k).sqrt()))
            .max_by(|&a, &b| (slope[a].abs() / size(a).sqrt()).total_cmp(&(slope[b].abs() / size(b).sqrt())));
        let Some(k) = worst else { break };
        inside[k] = true;
    }
    step
}

/// The minimum over some numbers, the others fixed.
fn unbounded(
    gradient: &DVector<f64>,
    curvature: &DMatrix<f64>,
    own: &[usize],
    step: &DVector<f64>,
    inside: &[bool],
) -> DVector<f64> {
    let fixed = DVector::from_fn(step.len(), |k, _| if inside[k] { 0.0 } else { step[k] });
    let pull = -(gradient + curvature * fixed).select_rows(own);
    let block = curvature.select_rows(own).select_columns(own);
    let mut ridge = 1e-14;
    loop {
        let mut damped = block.clone();
        for k in 0..own.len() {
            damped[(k, k)] += ridge * block[(k, k)].max(f64::MIN_POSITIVE);
        }
        match damped.cholesky() {
            Some(factor) => return factor.solve(&pull),
            None if ridge > 1e6 => return DVector::zeros(own.len()),
            None => ridge *= 100.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A matrix of full rank that is not nearly diagonal.
    fn curvature(count: usize) -> DMatrix<f64> {
        let root = DMatrix::from_fn(count, count, |i, k| ((3 * i + 7 * k * k) as f64 * 0.61).sin());
        &root * root.transpose() + DMatrix::identity(count, count) * 0.05
    }

    #[test]
    fn a_bounded_step_is_the_least_within_its_bounds() {
        for case in 0..40 {
            let count = 1 + case % 6;
            let h = curvature(count);
            let gradient = DVector::from_fn(count, |k, _| ((case * 5 + 11 * k) as f64 * 0.37).cos());
            let room: Vec<f64> = (0..count).map(|k| if (case + k) % 3 == 0 { 0.0 } else { 0.3 }).collect();
            let step = bounded_step(&gradient, &h, &room);
            let slope = &gradient + &h * &step;
            for k in 0..count {
                assert!(step[k] >= -room[k] - 1e-12, "{case}: {step}");
                let at_bound = step[k] <= -room[k] + 1e-12;
                // At a bound it would continue; elsewhere the slope is 0.
                assert!(if at_bound { slope[k] > -1e-9 } else { slope[k].abs() < 1e-9 }, "{case}: {slope}");
            }
        }
    }

    /// Thirty rows of two and three values, with sources that are present and absent.
    fn problem() -> Reml {
        let number = |k: usize| ((k * k * 13 + 7 * k) as f64 * 0.713).sin();
        let columns = 4;
        let rows = (0..30).map(|row| {
            let h = 2 + row % 2;
            let cells =
                |seed: usize, width: usize| (0..h * width).map(|k| number(seed + 31 * row + k)).collect::<Vec<f64>>();
            let level = (0..h * h).map(|k| f64::from(u8::from(k % (h + 1) == 0))).collect();
            let factors = vec![
                Factor { source: 0, cells: level },
                Factor { source: 1, cells: cells(900, 1) },
                Factor { source: 2, cells: cells(2100, 2) },
            ];
            let shared = 2.0 * number(5000 + row);
            let residual = (0..h).map(|k| number(7000 + 3 * row + k) + shared * factors[1].cells[k]).collect();
            RowBlock { residual, columns: cells(300, columns), factors, has_next: row % 2 == 0 }
        });
        let prior = DMatrix::from_diagonal_element(columns, columns, 0.3);
        Reml::new(rows.collect(), prior, DVector::from_element(columns, 0.1), vec![LEAST_LEVEL, 0.0, 0.0])
    }

    #[test]
    fn the_gradient_is_the_deviances() {
        let reml = problem();
        let at = [0.7, 0.4, 0.2];
        let slope = reml.slope(&at).unwrap();
        assert!((slope.deviance - reml.deviance(&at)).abs() < 1e-10);
        for k in 0..3 {
            let moved = |by: f64| {
                let mut there = at;
                there[k] += by;
                reml.deviance(&there)
            };
            let difference = (moved(1e-5) - moved(-1e-5)) / 2e-5;
            assert!((slope.gradient[k] - difference).abs() < 1e-6 * (1.0 + difference.abs()), "{k}: {difference}");
            assert!((slope.scores.row(k).sum() - slope.gradient[k]).abs() < 1e-9);
        }
    }

    #[test]
    fn no_neighbour_of_the_likeliest_is_likelier() {
        let reml = problem();
        let tied = Tied::each(3);
        let found = reml.likeliest(&tied, &[1.0, 0.1, 0.1], &[], 0.0).unwrap();
        let again = reml.likeliest(&tied, &[0.2, 2.0, 1.0], &[], 0.0).unwrap();
        for k in 0..3 {
            assert!((found.numbers[k] - again.numbers[k]).abs() < 1e-5, "{:?} {:?}", found.numbers, again.numbers);
            for factor in [0.99, 1.01] {
                let mut there = found.numbers.clone();
                there[k] = there[k] * factor + 1e-4 * f64::from(u8::from(factor > 1.0));
                assert!(reml.deviance(&there) >= found.slope.deviance - 1e-9, "{k}");
            }
        }
        assert!(found.numbers[1] > 0.5, "{:?}", found.numbers);
    }
}
