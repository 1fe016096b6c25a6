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
    /// The decimal literal, in the same unit as `value`; its last place says how precise the vendor is.
    pub written: Option<String>,
}

impl From<f64> for VendorNumber {
    fn from(value: f64) -> Self {
        Self { value, written: None }
    }
}

impl VendorNumber {
    /// From a decimal literal in rad or m; `None` where it is no number.
    ///
    /// # Examples
    /// ```
    /// use denavit_dh::matching::VendorNumber;
    /// let d = VendorNumber::from_written("0.1625").unwrap();
    /// assert_eq!(d.half_last_place(), 0.5e-4);
    /// ```
    pub fn from_written(written: &str) -> Option<Self> {
        let written = written.trim();
        let value = written.parse().ok()?;
        Some(Self { value, written: Some(written.to_owned()) })
    }

    /// Decimal places that are written; `None` for a number without text.
    pub fn places(&self) -> Option<i32> {
        let written = self.written.as_deref()?;
        let (mantissa, exponent) = match written.split_once(['e', 'E']) {
            Some((mantissa, exponent)) => (mantissa, exponent.parse().ok()?),
            None => (written, 0),
        };
        let decimals = mantissa.split_once('.').map_or(0, |(_, decimals)| decimals.len());
        Some(i32::try_from(decimals).ok()? - exponent)
    }

    /// Half a unit of the last place that is written, rad or m; 0 for a number without text, and for a plain `0` or
    /// `0.0`, which is written for nothing at all.
    pub fn half_last_place(&self) -> f64 {
        match self.places() {
            Some(places) if self.value != 0.0 => 0.5 * 10f64.powi(-places),
            _ => 0.0,
        }
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
    /// Twist about y, rad; with it the row is Hayati's Rz(theta) Tx(a) Rx(alpha) Ry(beta).
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
