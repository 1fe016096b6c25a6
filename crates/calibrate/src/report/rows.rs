//! Where instruments and targets were found, which rows fit worst, and the table before and after, as text.

use crate::calibration::Calibration;
use crate::calibration::rows::{Placed, Placements, RowEntry, Rows};
use crate::report::tables::table;
use denavit_dh::convert::{self, HAYATI_BELOW};
use denavit_dh::{Convention, NearParallel, Options, Parallelism};
use denavit_export::formats::FORMATS;
use denavit_export::{Sheet, Units};
use denavit_model::{Chain, Tip};
use serde::Serialize;

/// This many rows are listed.
const LISTED: usize = 15;

/// Instruments, targets and points: places in mm, orientations as quaternions x, y, z, w.
pub fn placements(found: &Placements) -> String {
    let mut rows = vec![["", "name", "x, mm", "y, mm", "z, mm", "qx", "qy", "qz", "qw"].map(String::from).to_vec()];
    let mut add = |what: &str, placed: &[Placed]| {
        for one in placed {
            let mut row = vec![what.to_owned(), one.name.clone()];
            row.extend(one.xyz.iter().map(|value| format!("{:.4}", value * 1e3)));
            row.extend(match one.quaternion {
                Some(quaternion) => quaternion.map(|value| format!("{value:.6}")),
                None => [const { String::new() }; 4],
            });
            rows.push(row);
        }
    };
    add("instrument from base", &found.instruments);
    add("target on the tip", &found.targets);
    add("point in the base frame", &found.points);
    table(&rows)
}

/// The rows that the adopted model fits worst, the largest first.
pub fn worst(rows: &Rows) -> String {
    let mut worst: Vec<(f64, RowEntry)> = Vec::with_capacity(LISTED + 1);
    for row in rows.iter() {
        let of = if row.place.is_empty() { &row.turn } else { &row.place };
        let size = of.iter().map(|value| value * value).sum::<f64>().sqrt();
        let place = worst.partition_point(|(larger, _)| larger.total_cmp(&size).is_ge());
        if place < LISTED {
            worst.insert(place, (size, row));
            worst.truncate(LISTED);
        }
    }
    let mut lines = vec![["line", "setup", "target", "", "residual, mm", "rotation, mrad"].map(String::from).to_vec()];
    for (size, row) in worst {
        let what = match (row.held_out, row.rejected) {
            (true, _) => "held out",
            (false, true) => "rejected",
            (false, false) => "fitted",
        };
        let turn = row.turn.iter().map(|value| value * value).sum::<f64>().sqrt();
        lines.push(vec![
            row.line.to_string(),
            row.setup,
            row.target,
            what.into(),
            if row.place.is_empty() { String::new() } else { format!("{:.4}", size * 1e3) },
            if row.turn.is_empty() { String::new() } else { format!("{:.4}", turn * 1e3) },
        ]);
    }
    table(&lines)
}

/// The tables of the chain to one tip.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Tables {
    /// `" to <tip>"` where there are several tips; else empty.
    pub of: String,
    /// As drawn.
    pub drawn: String,
    /// As calibrated.
    pub calibrated: String,
}

/// For each tip the table of the robot as drawn and as calibrated; a chain that has none in text is left out.
pub fn tables(result: &Calibration) -> Vec<Tables> {
    let arm = result.arm();
    let of_tip = |(index, tip): (usize, &Tip)| {
        Some(Tables {
            of: if arm.tips.several() { format!(" to {}", tip.name) } else { String::new() },
            drawn: dh_table(&arm.nominal_to(index))?,
            calibrated: dh_table(&arm.chain_to(index))?,
        })
    };
    arm.tips.all().iter().enumerate().filter_map(of_tip).collect()
}

fn dh_table(chain: &Chain) -> Option<String> {
    let options = Options {
        parallelism: Parallelism::Exact,
        near_parallel: NearParallel::HayatiBelow(HAYATI_BELOW),
        ..Options::default()
    };
    let made = convert::table(chain, &options).ok()?;
    let sheet = Sheet {
        table: &made.value,
        convention: Convention::Hayati,
        units: Units::default(),
        notes: &[],
        source: chain.name(),
        gauge: "simple",
    };
    (FORMATS.iter().find(|format| format.name == "text")?.render)(&sheet).ok()
}
