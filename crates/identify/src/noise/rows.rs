//! Residuals of each row, with the columns of the free numbers and of every source of noise.

use super::lever::Arms;
use super::reml::{Factor, LEAST_LEVEL, Reml, RowBlock};
use super::source::{Place, Source};
use crate::arm::Arm;
use crate::effects::curve::Curve;
use crate::effects::probe::Probe;
use crate::parameters::Effects;
use crate::residual::{ResidualModel, Scratch};
use crate::solve::Fit;
use denavit_measurements::Measurements;
use denavit_model::Quantity;
use denavit_model::nalgebra::{DMatrix, DVector, Matrix3, Rotation3, Vector3};

/// Directions of the free numbers with less than this fraction of the information of the best determined one belong to the common frame.
const UNKNOWN: f64 = 1e-11;
/// With many free numbers, most of them of curves, a direction in which the data's fraction of the information is below this is fixed:
/// it uses up less than a tenth of a value, all of them together about a thousandth of all values.
const HARDLY_KNOWN: f64 = 0.1;
/// More free numbers than this are many.
const MANY: usize = 80;
/// Largest work of one step, as values times the square of the number of free numbers: beyond it rows are left out.
const MOST_WORK: usize = 4_000_000;
/// At least this many values per free number are kept.
const VALUES_PER_NUMBER: usize = 3;
/// Rows, at most.
pub const MOST_ROWS: usize = 5000;
/// With at least this many values per number of the curves, the curves are fixed: fitting them has then lowered the noise by at most half
/// the inverse of this.
const VALUES_OF_KNOWN: usize = 50;
/// With fixed curves the rows may take this many times the work, which is still less than the curves would have taken.
const FOR_ROWS: usize = 4;
/// A target nearer to the instrument than this share of its usual distance has no direction.
const NO_DISTANCE: f64 = 1e-3;

/// An error curve of a joint that was fitted together with the geometry, and its prior.
#[derive(Debug, Clone)]
pub struct HeldCurve<'a> {
    /// The curve.
    pub curve: &'a Curve,
    /// Prior variance of the number of each wave, rad² or m².
    pub variances: Vec<f64>,
}

/// Rows ready for [`Reml`].
#[derive(Debug)]
pub(super) struct Prepared {
    pub reml: Reml,
    pub sources: Vec<Source>,
    /// Effect of a lever between orientations and positions; `None` without orientations, or if positions have weights in other axes.
    pub arms: Option<Arms>,
    /// Rows used.
    pub rows: usize,
    /// Rows available.
    pub of: usize,
}

/// One row before the free numbers are reduced.
struct Raw {
    residual: Vec<f64>,
    /// Column by column.
    columns: Vec<f64>,
    factors: Vec<Factor>,
    /// The series of each value.
    series: Vec<usize>,
    row: usize,
    /// For each observation with an orientation: base_from_target, and the indices of its first position and first rotation value.
    turned: Vec<(Rotation3<f64>, [usize; 2])>,
}

/// The rows of a fit; `None` if no row is used, or a noise level is unknown.
pub(super) fn prepared<E: Effects>(fit: &Fit<E>, data: &Measurements, curves: &[HeldCurve<'_>]) -> Option<Prepared> {
    let kept = |row: usize| data.of_row(row).any(|observation| fit.weights[observation] > 0.0);
    let all: Vec<usize> = (0..data.len()).filter(|&row| kept(row)).collect();
    if all.is_empty() || fit.noise.levels.iter().any(|level| !(*level > 0.0 && level.is_finite())) {
        return None;
    }
    let sources = sources_of(fit, data);
    let waves = curves.iter().map(|held| held.curve.waves.len()).sum::<usize>();
    let known = data.values() >= VALUES_OF_KNOWN * waves;
    let (curves, waves, work) =
        if known && waves > 0 { (&[][..], 0, FOR_ROWS * MOST_WORK) } else { (curves, waves, MOST_WORK) };
    let free = fit.layout.len() + waves;
    let height = data.values().div_ceil(data.len());
    let least = (VALUES_PER_NUMBER * free).div_ceil(height);
    let most = (work / (height * free * free).max(1)).max(least).min(MOST_ROWS);
    let chosen = spread(&all, most);
    let mut raw = raw_rows(fit, data, curves, &sources, &chosen);
    let units = scaled(&mut raw, fit, &sources);
    let of_size = |(source, unit_size)| Source { unit_size, ..source };
    let sources: Vec<Source> = sources.into_iter().zip(units).map(of_size).collect();
    let arms = arms(&raw, fit, data, &sources);
    let (prior, pull) = held_by(fit, data, curves);
    let (reml, rows) = reduced(raw, prior, pull, &sources)?;
    Some(Prepared { reml, sources, arms, rows, of: all.len() })
}

/// At most `most` of these rows, evenly spaced, in pairs of neighbours to keep information on the order of the run.
fn spread(rows: &[usize], most: usize) -> Vec<usize> {
    if rows.len() <= most {
        return rows.to_vec();
    }
    let pairs = (most / 2).max(1);
    let places = (0..pairs).map(|k| k * (rows.len() - 1) / pairs);
    let mut chosen: Vec<usize> = places.flat_map(|at| [rows[at], rows[at + 1]]).collect();
    chosen.dedup();
    chosen
}

/// Every source that can be seen in these data.
fn sources_of<E: Effects>(fit: &Fit<E>, data: &Measurements) -> Vec<Source> {
    let level = |(channel, part): (usize, &denavit_measurements::kinds::Part)| Source {
        place: Place::Level(channel),
        name: part.word.into(),
        unit: part.unit,
        unit_size: 1.0,
    };
    let mut sources: Vec<Source> = data.scene.channels.iter().enumerate().map(level).collect();
    if data.scene.series.iter().any(|series| series.kind.has_simd_residuals()) {
        sources.push(Source { place: Place::Range, name: "range".into(), unit: "m", unit_size: 1.0 });
        sources.push(Source { place: Place::Angle, name: "angle".into(), unit: "rad", unit_size: 1.0 });
    }
    for (index, coordinate) in fit.arm.nominal.coordinates().iter().enumerate() {
        let unit = if coordinate.quantity == Quantity::Length { "m" } else { "rad" };
        sources.push(Source { place: Place::Joint(index), name: coordinate.name.clone(), unit, unit_size: 1.0 });
    }
    sources
}

fn raw_rows<E: Effects>(
    fit: &Fit<E>,
    data: &Measurements,
    curves: &[HeldCurve<'_>],
    sources: &[Source],
    rows: &[usize],
) -> Vec<Raw> {
    let arm = &fit.arm;
    let joints = arm.joints.len();
    let probe = Probe::of_joints(&fit.effects, arm);
    let layout = fit.layout.with_effects(probe.parameters());
    let problem = ResidualModel { data, layout: &layout, effects: &probe };
    let mut scratch = problem.scratch(arm);
    let width = layout.len();
    let (mut residual, mut jacobian) = (vec![0.0; data.tallest_row()], vec![0.0; data.tallest_row() * width]);
    let first_joint = layout.effects.end - joints;
    let own: Vec<usize> = (0..first_joint).chain(layout.effects.end..width).collect();
    let mut found = Vec::with_capacity(rows.len());
    for &row in rows {
        problem.row_into(arm, row, &mut scratch, &mut residual, Some(&mut jacobian));
        // The line of each kept value, its channel and its observation.
        let (mut lines, mut line) = (Vec::new(), 0);
        for observation in data.of_row(row) {
            let series = data.series_of(observation);
            for k in 0..series.kind.height() {
                let channel = series.channels[usize::from(k >= series.kind.place().height)];
                if let Some(channel) = channel.filter(|_| fit.weights[observation] > 0.0) {
                    lines.push((line, channel, observation, k));
                }
                line += 1;
            }
        }
        let h = lines.len();
        let over = |channel: usize| 1.0 / fit.noise.levels[channel];
        let cell = |line: usize, column: usize| jacobian[line * width + column];
        let column_of = |column: usize, sign: f64| {
            lines
                .iter()
                .map(move |&(line, channel, ..)| sign * cell(line, column) * over(channel))
                .collect::<Vec<f64>>()
        };
        let mut columns = Vec::with_capacity(h * (own.len() + 8));
        for &column in &own {
            columns.extend(column_of(column, -1.0));
        }
        let reading = data.reading(row);
        for held in curves {
            let moved = column_of(first_joint + held.curve.joint, -1.0);
            for wave in held.curve.waves.values(arm.nominal.joints()[held.curve.joint].value(reading)) {
                columns.extend(moved.iter().map(|cell| wave * cell));
            }
        }
        let mut factors = Vec::new();
        for (source, of) in sources.iter().enumerate() {
            let mut cells = Vec::new();
            match of.place {
                Place::Level(channel) => {
                    for (at, _) in lines.iter().enumerate().filter(|(_, line)| line.1 == channel) {
                        cells.extend((0..h).map(|k| f64::from(u8::from(k == at))));
                    }
                }
                Place::Range | Place::Angle => {
                    for direction in beams(&problem, arm, data, row, &scratch, of.place) {
                        let (observation, direction) = direction;
                        let value = |&(_, channel, own, k): &(usize, usize, usize, usize)| {
                            if own == observation && k < 3 { direction[k] * over(channel) } else { 0.0 }
                        };
                        if fit.weights[observation] > 0.0 {
                            cells.extend(lines.iter().map(value));
                        }
                    }
                }
                Place::Joint(coordinate) => {
                    let mut moved = vec![0.0; h];
                    for (joint, of) in arm.joints.iter().enumerate().filter(|(_, of)| of.coordinate == coordinate) {
                        for (sum, cell) in moved.iter_mut().zip(column_of(first_joint + joint, of.scale)) {
                            *sum += cell;
                        }
                    }
                    cells = moved;
                }
            }
            if cells.iter().any(|cell| *cell != 0.0) {
                factors.push(Factor { source, cells });
            }
        }
        let residual = lines.iter().map(|&(line, channel, ..)| residual[line] * over(channel)).collect();
        let series = lines.iter().map(|line| data.observed.series(line.2)).collect();
        let start = |observation: usize, at: usize| lines.iter().position(|line| line.2 == observation && line.3 == at);
        let of_pose = |observation: usize| {
            let seen = problem.seen(arm, observation, &scratch);
            seen.series.kind.turn()?;
            let place = start(observation, 0)?;
            let turn = start(observation, seen.series.kind.place().height)?;
            Some((seen.tip.rotation * arm.targets[seen.series.target].rotation, [place, turn]))
        };
        let turned = data.of_row(row).filter_map(of_pose).collect();
        found.push(Raw { residual, columns, factors, series, row, turned });
    }
    found
}

/// Effect of a lever in every row; `None` without noise of orientations, or if positions are weighted along axes of their own.
fn arms<E: Effects>(rows: &[Raw], fit: &Fit<E>, data: &Measurements, sources: &[Source]) -> Option<Arms> {
    let posed = data.scene.series.iter().find(|series| series.kind.turn().is_some())?;
    let [Some(place), Some(channel)] = posed.channels else { return None };
    let source = sources.iter().position(|source| source.place == Place::Level(channel))?;
    let weighed = |row: &Raw| data.of_row(row.row).any(|observation| data.observed.level(observation).is_some());
    if rows.iter().any(weighed) {
        return None;
    }
    let unit = fit.noise.levels[place] / fit.noise.levels[channel];
    let of_row = |row: &Raw| {
        let own = row.factors.iter().find(|factor| factor.source == source)?;
        let h = row.residual.len();
        let arm = |axis: usize| {
            let mut cells = vec![0.0; own.cells.len()];
            for (from, [place, turn]) in &row.turned {
                let lever = from * Vector3::ith(axis, 1.0);
                for (cells, noise) in cells.chunks_exact_mut(h).zip(own.cells.chunks_exact(h)) {
                    let turn = Vector3::from_column_slice(&noise[*turn..turn + 3]);
                    cells[*place..place + 3].copy_from_slice(turn.cross(&lever).as_slice());
                }
            }
            cells
        };
        (!row.turned.is_empty()).then(|| [0, 1, 2].map(arm))
    };
    Some(Arms { source, unit, rows: rows.iter().map(of_row).collect() })
}

/// For each observation in the instrument's frame the effect of a unit of noise, in the axes of the residual: 1 m along the line of sight,
/// or 1 rad about the instrument in both directions across it.
fn beams<E: Effects>(
    problem: &ResidualModel<'_, E>,
    arm: &Arm,
    data: &Measurements,
    row: usize,
    scratch: &Scratch<E::Standing>,
    place: Place,
) -> Vec<(usize, Vector3<f64>)> {
    let mut found = Vec::new();
    for observation in data.of_row(row).filter(|&observation| data.series_of(observation).kind.has_simd_residuals()) {
        let seen = problem.seen(arm, observation, scratch);
        let instrument = seen.instrument();
        let sight = seen.predicted - instrument.inverse().translation.vector;
        let distance = sight.norm();
        if distance < NO_DISTANCE * arm.nominal.size() {
            continue;
        }
        let axes = data
            .observed
            .level(observation)
            .map_or_else(Matrix3::identity, |level| level * instrument.rotation.matrix());
        let along = sight / distance;
        if place == Place::Range {
            found.push((observation, axes * along));
            continue;
        }
        let least = (0..3).min_by(|&i, &k| along[i].abs().total_cmp(&along[k].abs())).unwrap_or(0);
        let across = along.cross(&Vector3::ith(least, 1.0)).normalize();
        for direction in [across, along.cross(&across)] {
            found.push((observation, axes * direction * distance));
        }
    }
    found
}

/// Scales every source so that a variance of 1 would explain all noise; returns the sizes, in the sources' units.
fn scaled<E>(rows: &mut [Raw], fit: &Fit<E>, sources: &[Source]) -> Vec<f64> {
    let mut sums = vec![(0.0, 0.0); sources.len()];
    for row in rows.iter() {
        for factor in &row.factors {
            // Values that the source does not affect do not count.
            let h = row.residual.len();
            let touched = (0..h).filter(|k| factor.cells.iter().skip(*k).step_by(h).any(|cell| *cell != 0.0)).count();
            let sum = &mut sums[factor.source];
            sum.0 += factor.cells.iter().map(|cell| cell * cell).sum::<f64>();
            sum.1 += touched as f64;
        }
    }
    let size = |(source, (squares, values)): (&Source, &(f64, f64))| match source.place {
        Place::Level(channel) => fit.noise.levels[channel],
        _ if *squares > 0.0 => (values / squares).sqrt(),
        _ => 1.0,
    };
    let sizes: Vec<f64> = sources.iter().zip(&sums).map(size).collect();
    for factor in rows.iter_mut().flat_map(|row| &mut row.factors) {
        if !matches!(sources[factor.source].place, Place::Level(_)) {
            factor.cells.iter_mut().for_each(|cell| *cell *= sizes[factor.source]);
        }
    }
    sizes
}

/// Precision of the prior of the free numbers, and the gradient of its logarithm at the fit.
fn held_by<E: Effects>(fit: &Fit<E>, data: &Measurements, curves: &[HeldCurve<'_>]) -> (DMatrix<f64>, DVector<f64>) {
    let layout = &fit.layout;
    let waves: usize = curves.iter().map(|held| held.curve.waves.len()).sum();
    let count = layout.len() + waves;
    let (mut prior, mut pull) = (DMatrix::zeros(count, count), DVector::zeros(count));
    let joints = layout.joints.len();
    prior.view_mut((0, 0), (joints, joints)).copy_from(&layout.prior.precision);
    let perturbation = layout.perturbation(&fit.arm, &fit.arm);
    pull.rows_mut(0, joints).copy_from(&-(&layout.prior.precision * perturbation));
    for known in layout.known(&data.scene, &fit.arm, &fit.effects.numbers()) {
        for (i, a) in &known.columns {
            pull[*i] -= a * known.residual;
            for (k, b) in &known.columns {
                prior[(*i, *k)] += a * b;
            }
        }
    }
    let mut at = layout.len();
    for held in curves {
        for (weight, variance) in held.curve.weights.iter().zip(&held.variances) {
            let precision = 1.0 / variance.max(f64::MIN_POSITIVE);
            prior[(at, at)] = precision;
            pull[at] = -precision * weight;
            at += 1;
        }
    }
    (prior, pull)
}

/// The rows with the free numbers in identifiable directions, scaled to equal information.
fn reduced(raw: Vec<Raw>, prior: DMatrix<f64>, pull: DVector<f64>, sources: &[Source]) -> Option<(Reml, usize)> {
    let count = pull.len();
    let mut information = DMatrix::zeros(count, count);
    for row in &raw {
        let columns = DMatrix::from_column_slice(row.residual.len(), count, &row.columns);
        information.gemm(1.0, &columns.transpose(), &columns, 1.0);
    }
    information += &prior;
    let scale = information.diagonal().map(|own| if own > 0.0 { own.powf(-0.5) } else { 0.0 });
    let scaled = DMatrix::from_fn(count, count, |i, k| information[(i, k)] * scale[i] * scale[k]);
    let eigen = scaled.symmetric_eigen();
    let largest = eigen.eigenvalues.max();
    let kept: Vec<usize> = (0..count).filter(|&k| eigen.eigenvalues[k] > UNKNOWN * largest).collect();
    let mut directions = DMatrix::from_fn(count, kept.len(), |i, k| {
        scale[i] * eigen.eigenvectors[(i, kept[k])] / eigen.eigenvalues[kept[k]].sqrt()
    });
    if directions.ncols() > MANY {
        // In these directions rows and prior together have information 1; the eigenvalues are the prior's fractions.
        let shares = (directions.transpose() * &prior * &directions).symmetric_eigen();
        let by_rows: Vec<usize> =
            (0..shares.eigenvalues.len()).filter(|&k| 1.0 - shares.eigenvalues[k] > HARDLY_KNOWN).collect();
        directions *= shares.eigenvectors.select_columns(&by_rows);
    }
    let prior = directions.transpose() * prior * &directions;
    let pull = directions.transpose() * pull;
    let least: Vec<f64> =
        sources.iter().map(|source| if matches!(source.place, Place::Level(_)) { LEAST_LEVEL } else { 0.0 }).collect();
    let rows = raw.len();
    let mut blocks = Vec::with_capacity(rows);
    let mut iterator = raw.into_iter().peekable();
    while let Some(row) = iterator.next() {
        let has_next = iterator.peek().is_some_and(|next| next.row == row.row + 1 && next.series == row.series);
        let columns = DMatrix::from_column_slice(row.residual.len(), count, &row.columns) * &directions;
        blocks.push(RowBlock {
            columns: columns.as_slice().to_vec(),
            residual: row.residual,
            factors: row.factors,
            has_next,
        });
    }
    (!blocks.is_empty()).then(|| (Reml::new(blocks, prior, pull, least), rows))
}
