//! Nominal, actual and delta values of a real arm, in the convention and on the branch of its nominal table.

use crate::numbers::exact;
use denavit_dh::nearest::{Parallels, is_parallel, nearest};
use denavit_dh::{Convention, ConventionRow, RowLabel, Table};
use denavit_model::chain::{Chain, ChainError};
use denavit_model::se3::{self, Pose};
use std::f64::consts::PI;
use std::fmt::Write as _;

/// One number.
#[derive(Debug, Clone, PartialEq)]
pub struct Delta {
    /// `base`, a joint's name, `tool`.
    pub row: String,
    /// `theta`, `d`, `alpha`, `a`, `beta`; `x` … `yaw` of base and tool, which a controller's table lacks.
    pub number: &'static str,
    /// rad or m.
    pub nominal: f64,
    /// rad or m.
    pub actual: f64,
    /// Standard deviation of the actual value, rad or m; `None` if unknown.
    pub std: Option<f64>,
}

impl Delta {
    /// Whether it is a length.
    pub fn is_length(&self) -> bool {
        ["d", "a", "x", "y", "z"].contains(&self.number)
    }

    /// Actual minus nominal.
    pub fn delta(&self) -> f64 {
        self.actual - self.nominal
    }
}

/// Compares every number of `chain` with that of `nominal`, in a convention.
///
/// # Shape and units
/// rad and m. Rows base, 1 … n, tool of the table; then six numbers for the displacement of the real base from the nominal
/// one, and six for the tool.
///
/// # Errors
/// The numbers of joints differ, or a number is not finite.
pub fn deltas(
    chain: &Chain,
    nominal: &Table,
    convention: Convention,
    parallels: Parallels,
) -> Result<Vec<Delta>, ChainError> {
    let found = nearest(chain, nominal, parallels)?;
    // Rows with beta have no proximal form: both are then given as distal.
    let hayati = found.table.rows.iter().chain(&nominal.rows).any(|row| row.beta().is_some());
    let convention = if hayati { Convention::Hayati } else { convention };
    let (before, after) = (nominal.convention_rows(convention), found.table.convention_rows(convention));
    let mut deltas = Vec::new();
    for (before, after) in before.iter().zip(&after) {
        let row = match before.label {
            RowLabel::Base => "base".to_owned(),
            RowLabel::Joint(index) => nominal.joints[index].name.clone(),
            RowLabel::Tool => "tool".to_owned(),
        };
        for (number, of) in NUMBERS {
            let (before, after) = (of(before), of(after));
            if number == "beta" && !(parallels == Parallels::Hayati && may_tilt(nominal, &row)) {
                continue;
            }
            if number == "beta" || before.is_some() || after.is_some() {
                let (nominal, actual) = (before.unwrap_or(0.0), after.unwrap_or(0.0));
                deltas.push(Delta { row: row.clone(), number, nominal, actual, std: None });
            }
        }
    }
    deltas.extend(pose("base frame", &found.base));
    deltas.extend(pose("tool frame", &found.tool));
    Ok(deltas)
}

/// Whether the row of a joint leads to a nominally parallel axis: only then does it have a beta.
fn may_tilt(nominal: &Table, joint: &str) -> bool {
    let index = nominal.joints.iter().position(|of| of.name == joint);
    index.is_some_and(|index| index + 1 < nominal.joints.len() && is_parallel(&nominal.row(index + 1)))
}

type Number = (&'static str, fn(&ConventionRow) -> Option<f64>);

const NUMBERS: [Number; 5] = [
    ("theta", |row| row.theta),
    ("d", |row| row.d),
    ("alpha", |row| row.alpha),
    ("a", |row| row.a),
    ("beta", |row| row.beta),
];

fn pose(row: &'static str, pose: &Pose) -> impl Iterator<Item = Delta> {
    let place = pose.translation.vector;
    let [roll, pitch, yaw] = se3::rpy_from_rotation(&pose.rotation);
    let numbers = [("x", place.x), ("y", place.y), ("z", place.z), ("roll", roll), ("pitch", pitch), ("yaw", yaw)];
    numbers.into_iter().map(move |(number, actual)| Delta { row: row.into(), number, nominal: 0.0, actual, std: None })
}

/// As CSV in rad and m, every digit.
pub fn csv(deltas: &[Delta]) -> String {
    let mut text = String::from("row,number,nominal,actual,delta,std,unit\n");
    for of in deltas {
        let std = of.std.map_or_else(String::new, exact);
        let unit = if of.is_length() { "m" } else { "rad" };
        let row =
            if of.row.contains([',', '"']) { format!("\"{}\"", of.row.replace('"', "\"\"")) } else { of.row.clone() };
        let numbers = [of.nominal, of.actual, of.delta()].map(exact).join(",");
        let _ = writeln!(text, "{row},{},{numbers},{std},{unit}", of.number);
    }
    text
}

/// As a Markdown table in mm and degrees.
pub fn markdown(deltas: &[Delta]) -> String {
    let mut text =
        String::from("| row | number | nominal | actual | delta | ± | unit |\n|---|---|---|---|---|---|---|\n");
    for of in deltas {
        let (factor, unit) = if of.is_length() { (1e3, "mm") } else { (180.0 / PI, "°") };
        let shown = |value: f64| crate::numbers::decimal(value * factor, 5);
        let std = of.std.map_or_else(String::new, shown);
        let (nominal, actual, delta) = (shown(of.nominal), shown(of.actual), shown(of.delta()));
        let _ = writeln!(text, "| {} | {} | {nominal} | {actual} | {delta} | {std} | {unit} |", of.row, of.number);
    }
    text
}
