//! Denavit-Hartenberg numbers in the paper's order, and the chain that they describe.

use denavit_model::chain::{Chain, ChainError, ChainJoint, Coordinate};
use denavit_model::nalgebra::{Matrix3, Point3, Rotation3, Unit, Vector3};
use denavit_model::screw::{AxisLine, Pitch, Screw};
use denavit_model::se3::{self, Pose, sin_cos_of_written};

/// The four Denavit-Hartenberg numbers: Rz(theta) Tz(d) Rx(alpha) Tx(a).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct DhRow {
    /// Joint angle about z, rad.
    pub theta: f64,
    /// Link offset along z, m.
    pub d: f64,
    /// Link twist about x, rad.
    pub alpha: f64,
    /// Link length along x, m.
    pub a: f64,
}

/// Hayati's numbers for near-parallel neighbours: Rz(theta) Tz(d) Tx(a) Rx(alpha) Ry(beta).
///
/// Hayati and Mirmirani's four have d = 0; Hayati and Roberts, and Techman's delta D-H, have five.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct HayatiRow {
    /// Joint angle about z, rad.
    pub theta: f64,
    /// Link offset along z, m; 0 in the form of four numbers.
    pub d: f64,
    /// Link length along x, m.
    pub a: f64,
    /// Twist about x, rad.
    pub alpha: f64,
    /// Twist about y, rad.
    pub beta: f64,
}

/// The step from the frame on one axis to the frame on the next.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Row {
    /// The usual four.
    Dh(DhRow),
    /// For near-parallel neighbours.
    Hayati(HayatiRow),
}

impl DhRow {
    /// Rz(theta) Tz(d) Rx(alpha) Tx(a); a quarter turn given as the nearest f64 is exact.
    pub fn pose(&self) -> Pose {
        let (st, ct) = sin_cos_of_written(self.theta);
        let (sa, ca) = sin_cos_of_written(self.alpha);
        let rotation =
            Rotation3::from_matrix_unchecked(Matrix3::new(ct, -st * ca, st * sa, st, ct * ca, -ct * sa, 0.0, sa, ca));
        se3::pose(rotation, Vector3::new(self.a * ct, self.a * st, self.d))
    }
}

impl HayatiRow {
    /// Rz(theta) Tz(d) Tx(a) Rx(alpha) Ry(beta).
    pub fn pose(&self) -> Pose {
        let (st, ct) = sin_cos_of_written(self.theta);
        let (sb, cb) = sin_cos_of_written(self.beta);
        let turned = DhRow { theta: self.theta, d: 0.0, alpha: self.alpha, a: 0.0 }.pose().rotation;
        let about_y = Rotation3::from_matrix_unchecked(Matrix3::new(cb, 0.0, sb, 0.0, 1.0, 0.0, -sb, 0.0, cb));
        se3::pose(turned * about_y, Vector3::new(self.a * ct, self.a * st, self.d))
    }
}

impl Row {
    /// The motion that the row describes.
    pub fn pose(&self) -> Pose {
        match self {
            Self::Dh(row) => row.pose(),
            Self::Hayati(row) => row.pose(),
        }
    }

    /// Joint angle about z, rad.
    pub fn theta(&self) -> f64 {
        match self {
            Self::Dh(row) => row.theta,
            Self::Hayati(row) => row.theta,
        }
    }

    /// Link length along x, m.
    pub fn a(&self) -> f64 {
        match self {
            Self::Dh(row) => row.a,
            Self::Hayati(row) => row.a,
        }
    }

    /// Twist about x, rad.
    pub fn alpha(&self) -> f64 {
        match self {
            Self::Dh(row) => row.alpha,
            Self::Hayati(row) => row.alpha,
        }
    }

    /// Link offset along z, m; a Hayati row of four numbers has none.
    pub fn d(&self) -> Option<f64> {
        match self {
            Self::Dh(row) => Some(row.d),
            Self::Hayati(row) => (row.d != 0.0).then_some(row.d),
        }
    }

    /// Twist about y, rad; only a Hayati row has one.
    pub fn beta(&self) -> Option<f64> {
        match self {
            Self::Dh(_) => None,
            Self::Hayati(row) => Some(row.beta),
        }
    }
}

/// The last two numbers: Rz(theta) Tz(d), from the last common normal to the tool frame.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ToolPart {
    /// rad.
    pub theta: f64,
    /// m.
    pub d: f64,
}

impl ToolPart {
    /// Rz(theta) Tz(d).
    pub fn pose(&self) -> Pose {
        DhRow { theta: self.theta, d: self.d, ..DhRow::default() }.pose()
    }
}

/// How a joint moves along its z axis at joint value v: Q = Rz(v), Tz(v), or Rz(v) Tz(pitch v).
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Motion {
    /// Turns.
    Revolute,
    /// Slides.
    Prismatic,
    /// Turns and slides.
    Helical(Pitch),
}

impl Motion {
    /// `revolute`, `prismatic` or `helical`.
    pub fn word(self) -> &'static str {
        match self {
            Self::Revolute => "revolute",
            Self::Prismatic => "prismatic",
            Self::Helical(_) => "helical",
        }
    }

    /// m/rad; 0 but for helical joints.
    pub fn pitch(self) -> f64 {
        match self {
            Self::Helical(pitch) => pitch.metres_per_radian(),
            _ => 0.0,
        }
    }

    /// Q at joint value `value` (rad, or m for prismatic joints).
    pub fn pose(self, value: f64) -> Pose {
        match self {
            Self::Revolute => ToolPart { theta: value, d: 0.0 },
            Self::Prismatic => ToolPart { theta: 0.0, d: value },
            Self::Helical(pitch) => ToolPart { theta: value, d: pitch.metres_per_radian() * value },
        }
        .pose()
    }

    /// The kind of a screw.
    pub fn of(screw: &Screw) -> Self {
        match screw {
            Screw::Revolute(_) => Self::Revolute,
            Screw::Prismatic(_) => Self::Prismatic,
            Screw::Helical { pitch, .. } => Self::Helical(*pitch),
        }
    }

    pub(crate) fn screw(self, frame: &Pose) -> Screw {
        let direction = Unit::new_normalize(frame.rotation.matrix().column(2).into_owned());
        let axis = AxisLine { direction, point: Point3::from(frame.translation.vector) };
        match self {
            Self::Revolute => Screw::Revolute(axis),
            Self::Prismatic => Screw::Prismatic(direction),
            Self::Helical(pitch) => Screw::Helical { axis, pitch },
        }
    }
}

/// A joint of a table: its value is `scale · q[coordinate]`; zero offsets stand in the table's theta and d.
#[derive(Debug, Clone, PartialEq)]
pub struct TableJoint {
    /// The joint's name.
    pub name: String,
    /// How it moves along z.
    pub motion: Motion,
    /// Index of the coordinate that moves it.
    pub coordinate: usize,
    /// The paper's normalisation factor, or a mimic joint's multiplier.
    pub scale: f64,
}

/// A robot's Denavit-Hartenberg numbers in the paper's form; every convention is a regrouping of them.
///
/// T = H0 Q(q1) H1 Q(q2) ··· Q(qn) Hn · Rz(thetaT) Tz(dT), with Q(q) = Rz(j q) Tz(k q).
///
/// # Source
/// Wu, Crawford, Roberts 2019, eq. (10).
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// The robot's name.
    pub name: String,
    /// Name of the base link.
    pub base: String,
    /// Name of the tip link.
    pub tip: String,
    /// The numbers that move it.
    pub coordinates: Vec<Coordinate>,
    /// From base to tip.
    pub joints: Vec<TableJoint>,
    /// H0 … Hn: one more than there are joints.
    pub rows: Vec<Row>,
    /// Rz(thetaT) Tz(dT).
    pub tool: ToolPart,
}

impl Table {
    /// Hi; a row that is missing moves nothing.
    pub fn row(&self, index: usize) -> Row {
        self.rows.get(index).copied().unwrap_or(Row::Dh(DhRow { theta: 0.0, d: 0.0, alpha: 0.0, a: 0.0 }))
    }

    /// base_from_tip at the coordinates `q`, rad or m; a coordinate that is not there is 0.
    pub fn fk(&self, q: &[f64]) -> Pose {
        let mut reached = self.row(0).pose();
        for (index, joint) in self.joints.iter().enumerate() {
            let value = q.get(joint.coordinate).copied().unwrap_or(0.0);
            reached *= joint.motion.pose(joint.scale * value) * self.row(index + 1).pose();
        }
        reached * self.tool.pose()
    }

    /// The frames on each joint's axis and after the last common normal, at zero: base_from_frame, n + 1 of them.
    pub fn frames(&self) -> Vec<Pose> {
        let mut reached = Pose::identity();
        self.rows
            .iter()
            .map(|row| {
                reached *= row.pose();
                reached
            })
            .collect()
    }

    /// The largest absolute length in the table, m.
    pub fn greatest_length(&self) -> f64 {
        let lengths = self.rows.iter().flat_map(|row| [row.a().abs(), row.d().unwrap_or(0.0).abs()]);
        lengths.fold(self.tool.d.abs(), f64::max)
    }

    /// The chain that the table stands for.
    ///
    /// # Errors
    /// There is not one row more than there are joints, a number is not finite, or a scale is zero.
    pub fn chain(&self) -> Result<Chain, ChainError> {
        if self.rows.len() != self.joints.len() + 1 {
            return Err(ChainError::Rows { rows: self.rows.len(), joints: self.joints.len() });
        }
        let frames = self.frames();
        let joints = self.joints.iter().zip(&frames).map(|(joint, frame)| ChainJoint {
            name: joint.name.clone(),
            screw: joint.motion.screw(frame),
            coordinate: joint.coordinate,
            scale: joint.scale,
            offset: 0.0,
        });
        let home = frames.last().copied().unwrap_or_else(Pose::identity) * self.tool.pose();
        Chain::new((&*self.name, &*self.base, &*self.tip), self.coordinates.clone(), joints.collect(), home)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Convention;
    use crate::convert::{Options, table};
    use denavit_model::examples;

    /// Every field is public, so anybody can make such a table.
    #[test]
    fn a_table_without_rows_is_refused_and_panics_nowhere() {
        let mut table = table(&examples::puma_like(), &Options::default()).expect("a table").value;
        table.rows.clear();
        assert_eq!(table.fk(&[]), table.tool.pose());
        assert_eq!(table.convention_rows(Convention::Distal).len(), table.joints.len() + 2);
        assert_eq!(table.convention_rows(Convention::Proximal).len(), table.joints.len() + 2);
        assert_eq!(table.chain().map(drop), Err(ChainError::Rows { rows: 0, joints: 6 }));
    }
}
