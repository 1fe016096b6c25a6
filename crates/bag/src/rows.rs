//! A row for each standstill, as the CSV of a measurement file.

use crate::BagOptions;
use crate::clock::{Clocks, clocks, median, period};
use crate::error::BagError;
use crate::standstill::{LEAST, standstills};
use crate::tracks::{Track, tracks};

/// Smallest correlation of speeds at which joints and target belong together.
const RELATED: f64 = 0.3;
/// Smallest number of target readings for a row.
const LEAST_READINGS: usize = 3;
/// A target whose readings spread this many times more than usual was moving.
const MOVING: f64 = 10.0;

/// Spreads below this (m) are rounding: the instrument repeats the same digits and its uncertainty is unknown.
const ROUNDING: f64 = 1e-9;
/// Readings that agree by chance may be at most this many times more certain than usual.
const SURER: f64 = 10.0;

/// The rows of a bag.
#[derive(Debug, Clone, PartialEq)]
pub struct Rows {
    /// CSV: time (s), a column per joint (rad or m), x, y, z (m), qx, qy, qz, qw where the target was turned, and the standard
    /// deviations of x, y, z over the standstill (m).
    pub csv: String,
    /// What was found, as sentences.
    pub notes: Vec<String>,
}

/// Means and spreads over one standstill.
struct Row {
    time: f64,
    joints: Vec<f64>,
    target: Vec<f64>,
    spread: [f64; 3],
    readings: usize,
}

/// Reads a bag: a file of `ros2 bag record`, or its folder.
///
/// # Errors
/// A bag that cannot be read, that does not say which topics are meant, or in which nothing stands still.
pub fn rows(bag: &str, asked: &BagOptions) -> Result<Rows, BagError> {
    let (joints, target) = tracks(bag, asked)?;
    let unrelated = |correlation: String| BagError::Unrelated {
        file: bag.into(),
        target: target.name.clone(),
        joints: joints.name.clone(),
        correlation,
    };
    let found = clocks(&joints, &target).ok_or_else(|| unrelated("none".into()))?;
    if found.correlation < RELATED {
        return Err(unrelated(format!("{:.2}", found.correlation)));
    }
    let stands = standstills(&joints);
    let all: Vec<Row> = stands.iter().filter_map(|stand| row(*stand, &joints, &target, &found)).collect();
    let size = |row: &Row| row.spread.iter().map(|spread| spread.powi(2)).sum::<f64>().sqrt();
    let usual = median(all.iter().map(size).collect());
    let rows: Vec<&Row> = all.iter().filter(|row| size(row) <= MOVING * usual || usual == 0.0).collect();
    if rows.is_empty() {
        return Err(BagError::NoStandstill { file: bag.into(), least: LEAST.to_string() });
    }
    let (unseen, moving) = (stands.len() - all.len(), all.len() - rows.len());
    let mut notes = vec![
        format!(
            "{} standstills of {LEAST} s or more; joints of {} ({:.0} Hz), target of {} ({:.0} Hz), means of {:.0} readings",
            rows.len(),
            joints.name,
            1.0 / period(&joints.stamps),
            target.name,
            1.0 / period(&target.stamps),
            median(rows.iter().map(|row| row.readings as f64).collect()),
        ),
        format!(
            "the clock of {} is {:.4} s ahead of that of {} (correlation of their speeds {:.2})",
            target.name, found.ahead, joints.name, found.correlation
        ),
    ];
    if unseen > 0 {
        notes.push(format!("{unseen} standstills are left out: the target was not seen in them"));
    }
    if moving > 0 {
        notes.push(format!(
            "{moving} standstills are left out: the target's readings spread {MOVING} times more than usual"
        ));
    }
    Ok(Rows { csv: csv(&rows, asked), notes })
}

/// Indices of the target's readings between two times of the joints' clock.
fn readings(target: &Track, [from, to]: [f64; 2], clocks: &Clocks) -> std::ops::Range<usize> {
    let first = target.stamps.partition_point(|stamp| stamp - clocks.ahead < from);
    first..target.stamps.partition_point(|stamp| stamp - clocks.ahead <= to).max(first)
}

fn row(stand: [f64; 2], joints: &Track, target: &Track, clocks: &Clocks) -> Option<Row> {
    let of_joints = joints.stamps.partition_point(|stamp| *stamp < stand[0])
        ..joints.stamps.partition_point(|stamp| *stamp <= stand[1]);
    let seen = readings(target, stand, clocks);
    if seen.len() < LEAST_READINGS || of_joints.is_empty() {
        return None;
    }
    let seen = &target.values[seen];
    let mut means = mean(seen);
    if means.len() == 7 {
        means.splice(3.., turn(seen));
    }
    let degrees = seen.len() as f64 - 1.0;
    let spread = |k: usize| (seen.iter().map(|one| (one[k] - means[k]).powi(2)).sum::<f64>() / degrees).sqrt();
    Some(Row {
        time: 0.5 * (stand[0] + stand[1]),
        joints: mean(&joints.values[of_joints]),
        spread: [spread(0), spread(1), spread(2)],
        readings: seen.len(),
        target: means,
    })
}

fn mean(values: &[Vec<f64>]) -> Vec<f64> {
    let count = values.len() as f64;
    // Relative to the first value: a constant remains exact.
    let column = |k: usize| values[0][k] + values.iter().map(|one| one[k] - values[0][k]).sum::<f64>() / count;
    (0..values[0].len()).map(column).collect()
}

/// The mean of quaternions that are near each other, q and -q being the same turn; of length 1.
fn turn(values: &[Vec<f64>]) -> Vec<f64> {
    let first = &values[0][3..];
    let alike = |one: &Vec<f64>| {
        let along: f64 = one[3..].iter().zip(first).map(|(a, b)| a * b).sum();
        one[3..].iter().map(|part| part * along.signum()).collect::<Vec<f64>>()
    };
    let mean = mean(&values.iter().map(alike).collect::<Vec<_>>());
    let length = mean.iter().map(|part| part * part).sum::<f64>().sqrt();
    if (length - 1.0).abs() < 1e-15 { mean } else { mean.iter().map(|part| part / length).collect() }
}

fn csv(rows: &[&Row], asked: &BagOptions) -> String {
    let mut writer = csv::Writer::from_writer(Vec::new());
    let turned = rows[0].target.len() == 7;
    // Standard deviations weigh rows against each other: without any they say nothing.
    let usual = median(rows.iter().flat_map(|row| row.spread).collect());
    let spreads = usual > ROUNDING;
    let target: &[&str] = if turned { &["x", "y", "z", "qx", "qy", "qz", "qw"] } else { &["x", "y", "z"] };
    let spread: &[&str] = if spreads { &["x.std", "y.std", "z.std"] } else { &[] };
    let names = asked.joints.iter().map(String::as_str).chain(target.iter().copied()).chain(spread.iter().copied());
    let header: Vec<&str> = std::iter::once("time").chain(names).collect();
    let mut records = vec![header.into_iter().map(String::from).collect::<Vec<_>>()];
    let start = rows[0].time;
    for row in rows {
        let numbers = std::iter::once(row.time - start).chain(row.joints.iter().chain(&row.target).copied());
        let mut record: Vec<String> = numbers.map(|number| number.to_string()).collect();
        if spreads {
            record.extend(row.spread.iter().map(|spread| spread.max(usual / SURER).to_string()));
        }
        records.push(record);
    }
    for record in records {
        writer.write_record(record).expect("writing into memory does not fail");
    }
    let bytes = writer.into_inner().expect("writing into memory does not fail");
    String::from_utf8(bytes).expect("CSV of texts is text")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_row_is_surer_than_its_readings_can_say() {
        let asked = BagOptions { joints: vec!["a".into()], ..BagOptions::default() };
        let stds = |spreads: &[f64]| -> Vec<String> {
            let row = |spread: &f64| Row {
                time: 0.0,
                joints: vec![0.1],
                target: vec![1.0, 2.0, 3.0],
                spread: [*spread; 3],
                readings: 5,
            };
            let rows: Vec<Row> = spreads.iter().map(row).collect();
            let csv = csv(&rows.iter().collect::<Vec<_>>(), &asked);
            csv.lines().map(|line| line.rsplit(',').next().unwrap_or_default().to_owned()).collect()
        };
        let found = stds(&[2e-5, 0.0, 1e-18, 4e-5, 2e-5]);
        assert_eq!(found[0], "z.std");
        for (found, expected) in found[1..].iter().zip([2e-5, 2e-6, 2e-6, 4e-5, 2e-5]) {
            assert!((found.parse::<f64>().unwrap() - expected).abs() < 1e-15, "{found}");
        }
        assert_eq!(stds(&[0.0, 1e-17, 0.0]), ["z", "3", "3", "3"]);
    }
}
