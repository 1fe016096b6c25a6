//! A table as a vendor prints it: numbers with the text that they were written as, base and tool rows where there are any.

use crate::conventions::{Convention, ConventionRow, RowLabel};
use crate::table::{Motion, Table};

/// One of the numbers of a row.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DhNumber {
    /// Joint angle about z, rad.
    Theta,
    /// Link offset along z, m.
    D,
    /// Link twist about x, rad.
    Alpha,
    /// Link length along x, m.
    A,
    /// Hayati's twist about y, rad.
    Beta,
}

impl DhNumber {
    /// Every number, in the order of the paper, Hayati's last.
    pub const ALL: [Self; 5] = [Self::Theta, Self::D, Self::Alpha, Self::A, Self::Beta];

    /// The word that tables use.
    pub fn word(self) -> &'static str {
        match self {
            Self::Theta => "theta",
            Self::D => "d",
            Self::Alpha => "alpha",
            Self::A => "a",
            Self::Beta => "beta",
        }
    }

    /// Whether it counts metres; the others count radians.
    pub fn is_length(self) -> bool {
        matches!(self, Self::D | Self::A)
    }
}

/// A number and, where it came from text, that text.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct VendorNumber {
    /// rad or m.
    pub value: f64,
    /// How it is written; its last place says how precise the vendor is.
    pub written: Option<Written>,
}

/// A decimal literal and its unit.
#[derive(Debug, Clone, PartialEq)]
pub struct Written {
    /// As the table has it.
    pub text: String,
    /// One of its units in rad or m: 1, π/180 for degrees, 1e-3 for millimetres.
    pub unit: f64,
}

impl From<f64> for VendorNumber {
    fn from(value: f64) -> Self {
        Self { value, written: None }
    }
}

impl VendorNumber {
    /// From a decimal literal in units of `unit` rad or m; `None` where it is no number.
    ///
    /// # Examples
    /// ```
    /// use denavit_dh::matching::VendorNumber;
    /// let d = VendorNumber::from_written("162.5", 1e-3).unwrap();
    /// assert_eq!((d.value, d.places()), (0.1625, Some(1)));
    /// ```
    pub fn from_written(text: &str, unit: f64) -> Option<Self> {
        let text = text.trim();
        let number: f64 = text.parse().ok()?;
        // Divided by the whole number that 1e-3 stands for, 162.5 mm is the f64 0.1625.
        let whole = (1.0 / unit).round();
        let value = if whole > 1.0 && (whole * unit - 1.0).abs() < 1e-15 { number / whole } else { number * unit };
        Some(Self { value, written: Some(Written { text: text.to_owned(), unit }) })
    }

    /// Decimal places that are written; `None` for a number without text.
    pub fn places(&self) -> Option<i32> {
        let written = &self.written.as_ref()?.text;
        let (mantissa, exponent) = match written.split_once(['e', 'E']) {
            Some((mantissa, exponent)) => (mantissa, exponent.parse().ok()?),
            None => (written.as_str(), 0),
        };
        let decimals = mantissa.split_once('.').map_or(0, |(_, decimals)| decimals.len());
        Some(i32::try_from(decimals).ok()? - exponent)
    }
}

/// A row; `None` for numbers that it does not have, which count as 0.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct VendorRow {
    /// Joint angle about z, rad.
    pub theta: Option<VendorNumber>,
    /// Link offset along z, m.
    pub d: Option<VendorNumber>,
    /// Link twist about x, rad.
    pub alpha: Option<VendorNumber>,
    /// Link length along x, m.
    pub a: Option<VendorNumber>,
    /// Twist about y, rad; with it the row is Hayati's Rz(theta) Tz(d) Tx(a) Rx(alpha) Ry(beta).
    pub beta: Option<VendorNumber>,
}

impl VendorRow {
    /// The number of this kind, where the row has one.
    pub fn number(&self, number: DhNumber) -> Option<&VendorNumber> {
        match number {
            DhNumber::Theta => self.theta.as_ref(),
            DhNumber::D => self.d.as_ref(),
            DhNumber::Alpha => self.alpha.as_ref(),
            DhNumber::A => self.a.as_ref(),
            DhNumber::Beta => self.beta.as_ref(),
        }
    }

    fn of(row: &ConventionRow) -> Self {
        let number = |value: Option<f64>| value.map(VendorNumber::from);
        Self {
            theta: number(row.theta),
            d: number(row.d),
            alpha: number(row.alpha),
            a: number(row.a),
            beta: number(row.beta),
        }
    }
}

/// A joint of a vendor's table.
#[derive(Debug, Clone, PartialEq)]
pub struct VendorJoint {
    /// Its name, where the table gives names.
    pub name: Option<String>,
    /// How it moves along z.
    pub motion: Motion,
    /// Its numbers.
    pub row: VendorRow,
}

/// A vendor's table, in the vendor's convention.
#[derive(Debug, Clone, PartialEq)]
pub struct VendorTable {
    /// How its numbers are grouped; a distal or proximal row may also be Hayati's in [`Convention::Hayati`].
    pub convention: Convention,
    /// From the robot's base frame to the first joint; where it is absent the base frame is free.
    pub base: Option<VendorRow>,
    /// From base to tip.
    pub joints: Vec<VendorJoint>,
    /// To the robot's tip frame; where it is absent the tool frame is free.
    pub tool: Option<VendorRow>,
}

impl VendorTable {
    /// Its rows: base, joints, tool.
    pub fn rows(&self) -> impl Iterator<Item = (RowLabel, &VendorRow)> {
        let joints = self.joints.iter().enumerate().map(|(index, joint)| (RowLabel::Joint(index), &joint.row));
        let base = self.base.iter().map(|row| (RowLabel::Base, row));
        base.chain(joints).chain(self.tool.iter().map(|row| (RowLabel::Tool, row)))
    }

    /// Half a unit of the last place that the table's lengths (m), or its angles (rad), are written to anywhere: "0.2"
    /// beside "0.2433" is 0.2000. 0 for a table without text.
    pub fn half_last_place(&self, lengths: bool) -> f64 {
        let numbers = self.rows().flat_map(|(_, row)| DhNumber::ALL.map(|number| (number, row.number(number))));
        let halves = numbers.filter(|(number, _)| number.is_length() == lengths).filter_map(|(_, number)| {
            let number = number?;
            Some(0.5 * number.written.as_ref()?.unit * 10f64.powi(-number.places()?))
        });
        let least = halves.fold(f64::INFINITY, f64::min);
        if least.is_finite() { least } else { 0.0 }
    }

    /// A table of ours as if a vendor had printed it; `frames` says whether its base and tool rows hold.
    pub fn of(table: &Table, convention: Convention, frames: bool) -> Self {
        let rows = table.convention_rows(convention);
        let hayati = rows.iter().any(|row| row.beta.is_some());
        let convention = if hayati { Convention::Hayati } else { convention };
        let mut vendor = Self { convention, base: None, joints: Vec::new(), tool: None };
        for row in &rows {
            match row.label {
                RowLabel::Base => vendor.base = frames.then(|| VendorRow::of(row)),
                RowLabel::Tool => vendor.tool = frames.then(|| VendorRow::of(row)),
                RowLabel::Joint(index) => vendor.joints.push(VendorJoint {
                    name: Some(table.joints[index].name.clone()),
                    motion: table.joints[index].motion,
                    row: VendorRow::of(row),
                }),
            }
        }
        vendor
    }
}
