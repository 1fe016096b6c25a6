//! The four conventions, as different groupings of one sequence of numbers.
//!
//! ```text
//! paper, distal   H0 · [Q(q1) H1] ··· [Q(qn) Hn] · Rz Tz              base = H0            row i = Rz(θi+qi) Tz(di) Rx(αi) Tx(ai)
//! proximal        Rz Tz · [Rx Tx Rz(θ1+q1) Tz] ··· · Rx Tx Rz Tz      base = Rz(θ0) Tz(d0)  row i = Rx(α) Tx(a) Rz(θi+qi) Tz(di)
//! ```

use crate::table::{DhRow, HayatiRow, Row, Table, TableJoint, ToolPart};
use denavit_model::chain::{Chain, ChainError, ChainJoint, Coordinate};
use denavit_model::se3::Pose;
use thiserror::Error;

/// How the numbers are grouped into rows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Convention {
    /// Standard (Denavit and Hartenberg, Paul): row i = Rz(theta + q) Tz(d) Rx(alpha) Tx(a), after joint i.
    #[default]
    Distal,
    /// Modified (Craig, Khalil): row i = Rx(alpha) Tx(a) Rz(theta + q) Tz(d), up to and with joint i.
    Proximal,
    /// Rows H0 … Hn and the tool's pair; grouped as distal.
    Paper,
    /// As distal, with Hayati's numbers Rz(theta) Tz(d) Tx(a) Rx(alpha) Ry(beta) for near-parallel neighbours.
    Hayati,
}

impl Convention {
    /// Every convention, in the order of the documents.
    pub const ALL: [Self; 4] = [Self::Distal, Self::Proximal, Self::Paper, Self::Hayati];

    /// The word that files and the command line use.
    pub fn word(self) -> &'static str {
        match self {
            Self::Distal => "distal",
            Self::Proximal => "proximal",
            Self::Paper => "paper",
            Self::Hayati => "hayati",
        }
    }

    /// The convention of this word; also `standard` and `modified`, `craig`.
    pub fn from_word(word: &str) -> Option<Self> {
        match word.to_ascii_lowercase().as_str() {
            "standard" | "classic" | "classical" | "dh" | "sdh" | "paul" => Some(Self::Distal),
            "modified" | "mdh" | "craig" | "modified-craig" | "khalil" => Some(Self::Proximal),
            word => Self::ALL.into_iter().find(|convention| convention.word() == word),
        }
    }
}

/// Which row of a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RowLabel {
    /// From the base frame to the first joint.
    Base,
    /// Of joint `index`, counted from 0.
    Joint(usize),
    /// To the tool frame.
    Tool,
}

/// A row in some convention; `None` for numbers that such a row does not have.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ConventionRow {
    /// Which row.
    pub label: RowLabel,
    /// rad.
    pub theta: Option<f64>,
    /// m.
    pub d: Option<f64>,
    /// rad.
    pub alpha: Option<f64>,
    /// m.
    pub a: Option<f64>,
    /// rad.
    pub beta: Option<f64>,
}

/// Why rows do not form a table.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum RowsError {
    /// The numbers of rows and joints do not match.
    #[error("{joints} joints need {joints} rows between base and tool, but there are {rows}")]
    Count {
        /// How many joints.
        joints: usize,
        /// How many rows.
        rows: usize,
    },
    /// A proximal table cannot hold Hayati's beta.
    #[error("row {row}: beta belongs to the hayati convention")]
    Beta {
        /// Counted from 1, 0 for the base.
        row: usize,
    },
    /// A number of the base or tool row that the convention cannot hold.
    #[error(
        "the {row} row has {number} = {value}, which a {convention} table cannot hold; write 0, or give that frame its own row"
    )]
    NoPlace {
        /// `base` or `tool`.
        row: &'static str,
        /// Which number.
        number: &'static str,
        /// As shortest decimal, rad or m.
        value: String,
        /// The convention.
        convention: &'static str,
    },
}

fn dh_of(row: &ConventionRow) -> DhRow {
    let number = |value: Option<f64>| value.unwrap_or(0.0);
    DhRow { theta: number(row.theta), d: number(row.d), alpha: number(row.alpha), a: number(row.a) }
}

impl Table {
    /// The rows base, 1 … n, tool in a convention.
    ///
    /// A table with Hayati rows has no proximal form: it is then given as [`Convention::Hayati`] would be.
    pub fn convention_rows(&self, convention: Convention) -> Vec<ConventionRow> {
        let blank = ConventionRow { label: RowLabel::Tool, theta: None, d: None, alpha: None, a: None, beta: None };
        let n = self.joints.len();
        let label = |index: usize| if index == 0 { RowLabel::Base } else { RowLabel::Joint(index - 1) };
        let proximal = convention == Convention::Proximal && self.rows.iter().all(|row| row.beta().is_none());
        let mut rows = Vec::with_capacity(n + 2);
        for index in 0..=n {
            let row = self.row(index);
            let twist = if proximal { index.checked_sub(1).map(|before| self.row(before)) } else { Some(row) };
            rows.push(ConventionRow {
                label: label(index),
                theta: Some(row.theta()),
                d: row.d(),
                alpha: twist.map(|row| row.alpha()),
                a: twist.map(|row| row.a()),
                beta: row.beta(),
            });
        }
        let last = self.row(n);
        // Proximal: Hn's twist and length stand before the tool's pair.
        let (alpha, a) = if proximal { (Some(last.alpha()), Some(last.a())) } else { (None, None) };
        rows.push(ConventionRow { theta: Some(self.tool.theta), d: Some(self.tool.d), alpha, a, ..blank });
        rows
    }

    /// The table of rows base, 1 … n, tool in a convention.
    ///
    /// # Errors
    /// There is not one row for each joint, or beta is in a proximal table.
    pub fn from_convention_rows(
        (name, base, tip): (impl Into<String>, impl Into<String>, impl Into<String>),
        coordinates: Vec<Coordinate>,
        joints: Vec<TableJoint>,
        convention: Convention,
        rows: &[ConventionRow],
    ) -> Result<Self, RowsError> {
        let n = joints.len();
        if rows.len() != n + 2 {
            return Err(RowsError::Count { joints: n, rows: rows.len().saturating_sub(2) });
        }
        let tool = dh_of(&rows[n + 1]);
        let proximal = convention == Convention::Proximal;
        if let Some(error) = without_place(convention, &rows[0], &rows[n + 1]) {
            return Err(error);
        }
        let mut kept = Vec::with_capacity(n + 1);
        for index in 0..=n {
            let mut row = dh_of(&rows[index]);
            if proximal {
                let next = dh_of(&rows[index + 1]);
                row = DhRow { alpha: next.alpha, a: next.a, ..row };
            }
            kept.push(match rows[index].beta {
                Some(_) if proximal => return Err(RowsError::Beta { row: index }),
                Some(beta) if rows[index].d.is_none() || beta != 0.0 => {
                    Row::Hayati(HayatiRow { theta: row.theta, d: row.d, a: row.a, alpha: row.alpha, beta })
                }
                _ => Row::Dh(row),
            });
        }
        let tool = ToolPart { theta: tool.theta, d: tool.d };
        Ok(Self { name: name.into(), base: base.into(), tip: tip.into(), coordinates, joints, rows: kept, tool })
    }
}

/// The first number of base or tool row that the convention does not use.
fn without_place(convention: Convention, base: &ConventionRow, tool: &ConventionRow) -> Option<RowsError> {
    let proximal = convention == Convention::Proximal;
    let unused = |row: &ConventionRow| {
        let numbers = [("alpha", row.alpha), ("a", row.a), ("beta", row.beta)];
        let number = numbers.into_iter().find(|(_, value)| value.is_some_and(|value| value != 0.0));
        number.map(|(number, value)| (number, value.unwrap_or_default()))
    };
    let (row, found) = if proximal { ("base", unused(base)) } else { ("tool", unused(tool)) };
    let (number, value) = found?;
    Some(RowsError::NoPlace { row, number, value: format!("{value}"), convention: convention.word() })
}

/// The constant motions before and after a joint's motion in a row: the row is before · motion · behind.
fn parts(convention: Convention, row: &ConventionRow) -> (Pose, Pose) {
    let numbers = dh_of(row);
    let rz_tz = DhRow { theta: numbers.theta, d: numbers.d, ..DhRow::default() }.pose();
    let rx_tx = DhRow { alpha: numbers.alpha, a: numbers.a, ..DhRow::default() }.pose();
    match (convention, row.beta) {
        (Convention::Proximal, _) => (rx_tx, rz_tz),
        (_, Some(beta)) => (Pose::identity(), rz_tz * rx_tx * HayatiRow { beta, ..HayatiRow::default() }.pose()),
        _ => (Pose::identity(), rz_tz * rx_tx),
    }
}

/// The chain of rows in a convention with any number of fixed frames (base and tool rows) before, between and behind the
/// joints.
///
/// # Errors
/// As [`Chain::new`].
pub fn chain_of_rows(
    names: (impl Into<String>, impl Into<String>, impl Into<String>),
    coordinates: Vec<Coordinate>,
    joints: &[TableJoint],
    convention: Convention,
    rows: &[ConventionRow],
) -> Result<Chain, ChainError> {
    let mut reached = Pose::identity();
    let mut moving = Vec::new();
    for row in rows {
        let (before, behind) = parts(convention, row);
        reached *= before;
        if let RowLabel::Joint(index) = row.label
            && let Some(joint) = joints.get(index)
        {
            moving.push(ChainJoint {
                name: joint.name.clone(),
                screw: joint.motion.screw(&reached),
                coordinate: joint.coordinate,
                scale: joint.scale,
                offset: 0.0,
            });
        }
        reached *= behind;
    }
    Chain::new(names, coordinates, moving, reached)
}

/// Forward kinematics directly from convention rows by their definition: an independent check for tests and
/// documents. `values` are joint values (scale and coordinate already applied), rad or m.
pub fn fk_of_rows(convention: Convention, rows: &[ConventionRow], joints: &[TableJoint], values: &[f64]) -> Pose {
    let mut reached = Pose::identity();
    for row in rows {
        let motion = match row.label {
            RowLabel::Joint(index) => joints[index].motion.pose(values[index]),
            _ => Pose::identity(),
        };
        let (before, behind) = parts(convention, row);
        reached *= before * motion * behind;
    }
    reached
}
