//! Whether measured data can belong to the chain, and notes on them.

use super::Measurements;
use super::data_note::DataNote;
use super::measurement_error::MeasurementError;
use denavit_model::nalgebra::Vector3;
use denavit_model::{Chain, Quantity};

/// Readings this many times beyond the limits suggest another unit.
const BEYOND_LIMITS: f64 = 3.0;
/// Measured lengths this many times beyond the reach suggest another unit.
const BEYOND_REACH: f64 = 4.0;
/// Targets closer than this in every row are the same target, m.
const SAME_TARGET: f64 = 1e-9;

/// Removes targets that repeat another one or that no row sees.
pub(super) fn drop_targets(data: &mut Measurements, notes: &mut Vec<DataNote>) {
    let count = data.scene.targets.len();
    // Targets of several setups are never seen in one row: they are not duplicates.
    if data.scene.setups.len() > 1 || !data.scene.kinds().iter().all(|kind| kind.of_several()) {
        return;
    }
    let mut keep: Vec<usize> = Vec::new();
    for target in 0..count {
        let seen = (0..data.len()).any(|row| data.position(row, target).is_some());
        let twin = keep.iter().copied().find(|&other| {
            (0..data.len()).all(|row| match (data.position(row, target), data.position(row, other)) {
                (Some(a), Some(b)) => (a - b).norm() < SAME_TARGET,
                (None, None) => true,
                _ => false,
            })
        });
        match (seen, twin) {
            (false, _) => notes.push(DataNote::NeverSeen { target: data.scene.targets[target].clone() }),
            (true, Some(of)) => notes.push(DataNote::DuplicateTarget {
                target: data.scene.targets[target].clone(),
                of: data.scene.targets[of].clone(),
            }),
            (true, None) => keep.push(target),
        }
    }
    if keep.len() < count {
        data.keep_targets(&(0..count).map(|target| keep.contains(&target)).collect::<Vec<bool>>());
    }
}

/// Problems that only all values together show: units, nothing seen.
pub(super) fn problems(data: &Measurements, chain: &Chain) -> Vec<(u64, MeasurementError)> {
    if data.scene.targets.is_empty() {
        return vec![(0, MeasurementError::NothingSeen)];
    }
    let mut problems = readings_in_other_units(data, chain);
    if problems.is_empty() {
        problems.extend(lengths_in_other_units(data, chain).map(|problem| (0, problem)));
    }
    problems
}

fn readings_in_other_units(data: &Measurements, chain: &Chain) -> Vec<(u64, MeasurementError)> {
    let mut problems = Vec::new();
    for (index, coordinate) in chain.coordinates().iter().enumerate() {
        let (lower, upper) = coordinate.range();
        let bound = lower.abs().max(upper.abs());
        let slides = coordinate.quantity == Quantity::Length;
        // Angles may wind up where nothing limits them; slides without limits may be of any length.
        let unlimited = coordinate.limits.range.is_none();
        if unlimited && slides {
            continue;
        }
        let factor = if unlimited { 10.0 } else { BEYOND_LIMITS };
        let far =
            (0..data.len()).map(|row| (row, data.reading(row)[index])).max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()));
        let Some((row, value)) = far.filter(|(_, value)| value.abs() > factor * bound) else { continue };
        let joint = coordinate.name.clone();
        let problem = if slides {
            MeasurementError::LooksLikeMillimetres { joint, value, lower, upper }
        } else {
            MeasurementError::LooksLikeDegrees { joint, value, lower, upper }
        };
        problems.push((data.lines[row] as u64, problem));
    }
    problems
}

fn lengths_in_other_units(data: &Measurements, chain: &Chain) -> Option<MeasurementError> {
    let reach = 2.0 * chain.reach_beyond(0, &denavit_model::nalgebra::Point3::origin());
    let all = || (0..data.observations()).map(|at| (data.series_of(at).kind, data.observed.values(at)));
    let places = || all().filter_map(|(kind, values)| kind.position(values));
    let low = places().fold(Vector3::repeat(f64::INFINITY), |low, p| low.inf(&p));
    let high = places().fold(Vector3::repeat(f64::NEG_INFINITY), |high, p| high.sup(&p));
    let (mut what, mut span) = ("positions", (high - low).norm());
    let lengths = all().filter(|(kind, _)| kind.place().height == 1).filter_map(|(_, values)| values.first());
    let (low, high) = lengths.fold((f64::INFINITY, 0.0f64), |(low, high), d| (low.min(*d), high.max(*d)));
    if places().next().is_none() {
        (what, span) = ("distances", high - low);
    }
    (span > BEYOND_REACH * reach.max(1e-3)).then_some(MeasurementError::BeyondReach { what, span, reach })
}

/// Findings that are not errors.
pub(super) fn notes(data: &Measurements, chain: &Chain) -> Vec<DataNote> {
    let mut notes = Vec::new();
    for (index, coordinate) in chain.coordinates().iter().enumerate() {
        let rows = || (0..data.len()).filter(|&row| data.moves_its_tip(row, index));
        let values = || rows().map(|row| data.reading(row)[index]);
        let low = values().fold(f64::INFINITY, f64::min);
        if data.never_moves(index) {
            notes.push(DataNote::NeverMoves { joint: coordinate.name.clone(), at: low });
        }
        if let Some((lower, upper)) = coordinate.limits.interval() {
            let slack = 1e-6 + 1e-3 * (upper - lower);
            let rows = values().filter(|value| *value < lower - slack || *value > upper + slack).count();
            if rows > 0 {
                notes.push(DataNote::OutsideLimits { joint: coordinate.name.clone(), rows });
            }
        }
    }
    notes
}
