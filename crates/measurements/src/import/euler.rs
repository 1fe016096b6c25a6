//! Three angles as a rotation, in every common order.

use denavit_model::nalgebra::{Rotation3, Vector3};
use std::fmt;
use std::str::FromStr;
use thiserror::Error;

/// An order of three rotations: `XYZ` about the rotating axes (intrinsic), `xyz` about fixed axes (extrinsic).
///
/// # Validation
/// All 24 orders against `scipy.spatial.transform.Rotation.from_euler`, see the test below.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct EulerOrder {
    axes: [usize; 3],
    intrinsic: bool,
}

/// A word that is not an order of angles.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error(
    "\"{0}\" is not an order of angles; write three of X, Y, Z with no axis twice in a row: XYZ for rotating axes, xyz for fixed \
     ones (roll, pitch, yaw of a URDF is xyz, KUKA's A, B, C is ZYX)"
)]
pub struct EulerError(String);

impl FromStr for EulerOrder {
    type Err = EulerError;

    fn from_str(text: &str) -> Result<Self, EulerError> {
        let wrong = || EulerError(text.into());
        let letters: Vec<char> = text.chars().collect();
        let intrinsic = letters.iter().all(|c| "XYZ".contains(*c));
        let extrinsic = letters.iter().all(|c| "xyz".contains(*c));
        let axis = |c: &char| "xyz".find(c.to_ascii_lowercase()).ok_or_else(wrong);
        let axes: Vec<usize> = letters.iter().map(axis).collect::<Result<_, _>>()?;
        match axes[..] {
            [a, b, c] if a != b && b != c && (intrinsic || extrinsic) => Ok(Self { axes: [a, b, c], intrinsic }),
            _ => Err(wrong()),
        }
    }
}

impl fmt::Display for EulerOrder {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let letters = if self.intrinsic { ["X", "Y", "Z"] } else { ["x", "y", "z"] };
        self.axes.iter().try_for_each(|axis| f.write_str(letters[*axis]))
    }
}

impl EulerOrder {
    /// The rotation of three angles, rad, in the order of the letters.
    pub fn rotation(self, angles: [f64; 3]) -> Rotation3<f64> {
        let turn = |k: usize| Rotation3::from_scaled_axis(Vector3::ith(self.axes[k], angles[k]));
        if self.intrinsic { turn(0) * turn(1) * turn(2) } else { turn(2) * turn(1) * turn(0) }
    }

    /// The index in the order of the rotation about an axis (0-2 for x, y, z), where each axis occurs once.
    pub(super) fn place_of(self, axis: usize) -> Option<usize> {
        let mut places = (0..3).filter(|&k| self.axes[k] == axis);
        places.next().filter(|_| places.next().is_none())
    }
}

/// What three numbers of an orientation mean.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AngleConvention {
    /// Angles of three rotations.
    Euler(EulerOrder),
    /// Axis times angle.
    RotationVector,
}

/// Three numbers of an orientation per row as the file writes them, kept so that another convention can be tried.
#[derive(Debug, Clone, PartialEq)]
pub struct WrittenAngles {
    /// The convention that they were read in.
    pub read_as: AngleConvention,
    /// Whether the column names state their axes, so that an order assigns them by axis and not by position.
    pub by_axis: bool,
    /// rad, in the file's order; not finite where a row has none.
    pub numbers: Vec<[f64; 3]>,
}

impl AngleConvention {
    /// All conventions: the rotation vector, and all 24 orders.
    pub fn all() -> impl Iterator<Item = Self> {
        let axes = || (0..3usize).flat_map(|a| (0..3).flat_map(move |b| (0..3).map(move |c| [a, b, c])));
        let orders = [false, true].into_iter().flat_map(move |intrinsic| {
            axes().filter(|[a, b, c]| a != b && b != c).map(move |axes| Self::Euler(EulerOrder { axes, intrinsic }))
        });
        std::iter::once(Self::RotationVector).chain(orders)
    }

    /// The rotation of three numbers, rad, in the file's order.
    pub fn rotation(self, numbers: [f64; 3], by_axis: bool) -> Rotation3<f64> {
        match self {
            Self::RotationVector => Rotation3::from_scaled_axis(Vector3::from(numbers)),
            Self::Euler(order) => {
                let places = if by_axis { order.places() } else { [0, 1, 2] };
                let mut sorted = numbers;
                for (number, place) in numbers.iter().zip(places) {
                    sorted[place] = *number;
                }
                order.rotation(sorted)
            }
        }
    }
}

impl EulerOrder {
    /// The indices in the order of the rotations about x, y, z; 0, 1, 2 where an axis occurs twice.
    pub(super) fn places(self) -> [usize; 3] {
        match [0, 1, 2].map(|axis| self.place_of(axis)) {
            [Some(x), Some(y), Some(z)] => [x, y, z],
            _ => [0, 1, 2],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use denavit_model::nalgebra::UnitQuaternion;

    /// `Rotation.from_euler(order, [0.3, -1.1, 2.2]).as_quat()` of scipy 1.15.3, w not negative.
    const SCIPY: [(&str, [f64; 4]); 24] = [
        ("xyx", [0.809_032_659_057_943, -0.304_038_322_147_702, -0.425_161_896_167_591, 0.268_820_046_295_701]),
        ("xyz", [0.518_380_015_878_985, -0.120_887_121_214_180, 0.786_674_784_167_746, 0.312_747_896_901_772]),
        ("xzx", [0.809_032_659_057_943, 0.425_161_896_167_591, -0.304_038_322_147_702, 0.268_820_046_295_701]),
        ("xzy", [-0.402_804_021_277_394, 0.715_814_539_346_549, -0.347_966_172_753_774, 0.451_971_247_229_222]),
        ("yxy", [-0.304_038_322_147_702, 0.809_032_659_057_943, 0.425_161_896_167_591, 0.268_820_046_295_701]),
        ("yxz", [-0.347_966_172_753_774, -0.402_804_021_277_394, 0.715_814_539_346_549, 0.451_971_247_229_222]),
        ("yzx", [0.786_674_784_167_746, 0.518_380_015_878_985, -0.120_887_121_214_180, 0.312_747_896_901_772]),
        ("yzy", [-0.425_161_896_167_591, 0.809_032_659_057_943, -0.304_038_322_147_702, 0.268_820_046_295_701]),
        ("zxy", [-0.120_887_121_214_180, 0.786_674_784_167_746, 0.518_380_015_878_985, 0.312_747_896_901_772]),
        ("zxz", [-0.304_038_322_147_702, -0.425_161_896_167_591, 0.809_032_659_057_943, 0.268_820_046_295_701]),
        ("zyx", [0.715_814_539_346_549, -0.347_966_172_753_774, -0.402_804_021_277_394, 0.451_971_247_229_222]),
        ("zyz", [0.425_161_896_167_591, -0.304_038_322_147_702, 0.809_032_659_057_943, 0.268_820_046_295_701]),
        ("XYX", [0.809_032_659_057_943, -0.304_038_322_147_702, 0.425_161_896_167_591, 0.268_820_046_295_701]),
        ("XYZ", [-0.402_804_021_277_394, -0.347_966_172_753_774, 0.715_814_539_346_549, 0.451_971_247_229_222]),
        ("XZX", [0.809_032_659_057_943, -0.425_161_896_167_591, -0.304_038_322_147_702, 0.268_820_046_295_701]),
        ("XZY", [0.518_380_015_878_985, 0.786_674_784_167_746, -0.120_887_121_214_180, 0.312_747_896_901_772]),
        ("YXY", [-0.304_038_322_147_702, 0.809_032_659_057_943, -0.425_161_896_167_591, 0.268_820_046_295_701]),
        ("YXZ", [-0.120_887_121_214_180, 0.518_380_015_878_985, 0.786_674_784_167_746, 0.312_747_896_901_772]),
        ("YZX", [0.715_814_539_346_549, -0.402_804_021_277_394, -0.347_966_172_753_774, 0.451_971_247_229_222]),
        ("YZY", [0.425_161_896_167_591, 0.809_032_659_057_943, -0.304_038_322_147_702, 0.268_820_046_295_701]),
        ("ZXY", [-0.347_966_172_753_774, 0.715_814_539_346_549, -0.402_804_021_277_394, 0.451_971_247_229_222]),
        ("ZXZ", [-0.304_038_322_147_702, 0.425_161_896_167_591, 0.809_032_659_057_943, 0.268_820_046_295_701]),
        ("ZYX", [0.786_674_784_167_746, -0.120_887_121_214_180, 0.518_380_015_878_985, 0.312_747_896_901_772]),
        ("ZYZ", [-0.425_161_896_167_591, -0.304_038_322_147_702, 0.809_032_659_057_943, 0.268_820_046_295_701]),
    ];

    #[test]
    fn every_order_is_scipys() {
        for (order, [x, y, z, w]) in SCIPY {
            let rotation = order.parse::<EulerOrder>().unwrap().rotation([0.3, -1.1, 2.2]);
            let q = UnitQuaternion::from_rotation_matrix(&rotation);
            let sign = q.w.signum();
            let off = [q.i * sign - x, q.j * sign - y, q.k * sign - z, q.w * sign - w];
            assert!(off.iter().all(|off| off.abs() < 1e-14), "{order}: {off:?}");
        }
        for wrong in ["XXY", "XYz", "", "XY", "ABC", "XYZX"] {
            assert!(wrong.parse::<EulerOrder>().is_err(), "{wrong}");
        }
    }
}
