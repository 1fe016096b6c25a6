//! What people get wrong when they write a measurement file, and how each is undone.

use crate::observation::kinds::{ObservationKind, POSE, POSITION};
use crate::observation::measurements::Measurements;
use denavit_model::nalgebra::{Matrix3, Quaternion, Rotation3, UnitQuaternion};
use denavit_model::{Chain, Quantity};
use std::f64::consts::PI;
use std::fmt;

const PLACE: [&str; 3] = ["x", "y", "z"];
/// Readings that are this many rows early or late are looked for.
const STEPS: [i32; 4] = [1, -1, 2, -2];

/// How a quaternion may be written otherwise than x, y, z, w of the target in the instrument's frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum QuaternionSlip {
    /// w, x, y, z in the columns of x, y, z, w.
    ScalarFirst,
    /// The instrument's orientation in the target's frame.
    Inverse,
    /// Both.
    ScalarFirstInverse,
}

/// A likely mistake.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Mistake {
    /// Joints that count the other way.
    Sense(Vec<String>),
    /// The columns of two joints are exchanged.
    Swapped(String, String),
    /// A column is in degrees although radians were meant (`false`), or the other way round (`true`).
    AngleUnit(String, bool),
    /// A slide's column is in millimetres.
    Millimetres(String),
    /// One of x, y, z is in mm although m were meant (`false`), or the other way round (`true`).
    PlaceUnit(usize, bool),
    /// A joint's reading counts another joint's with it: `of` reads its angle plus (or less) that of `by`.
    Coupled {
        /// The joint.
        of: String,
        /// The other one.
        by: String,
        /// Plus.
        plus: bool,
    },
    /// The quaternion is written otherwise.
    Quaternion(QuaternionSlip),
    /// The readings stand so many rows below (negative: above) the values that belong to them.
    OutOfStep(i32),
    /// The data belong to another chain of the robot.
    OtherChain(Box<Chain>),
}

impl fmt::Display for Mistake {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Sense(joints) => {
                let (word, verb) = if joints.len() == 1 { ("joint", "counts") } else { ("joints", "count") };
                write!(f, "{word} \"{}\" {verb} the other way", joints.join("\" and \""))
            }
            Self::Swapped(a, b) => write!(f, "columns \"{a}\" and \"{b}\" were exchanged"),
            Self::AngleUnit(column, false) => write!(f, "column \"{column}\" were in degrees"),
            Self::AngleUnit(column, true) => write!(f, "column \"{column}\" were in rad"),
            Self::Millimetres(column) => write!(f, "column \"{column}\" were in mm"),
            Self::PlaceUnit(axis, metres) => {
                let unit = if *metres { "m" } else { "mm" };
                write!(f, "the {} of what was measured were in {unit}, unlike the other two", PLACE[*axis])
            }
            Self::Coupled { of, by, plus } => {
                let sign = if *plus { "plus" } else { "minus" };
                write!(f, "\"{of}\" were counted from the ground: it reads its own angle {sign} that of \"{by}\"")
            }
            Self::Quaternion(QuaternionSlip::ScalarFirst) => write!(f, "the quaternion were written w first"),
            Self::Quaternion(QuaternionSlip::Inverse) => {
                write!(f, "the quaternion were the inverse: the instrument as the target sees it")
            }
            Self::Quaternion(QuaternionSlip::ScalarFirstInverse) => {
                write!(f, "the quaternion were the inverse and written w first")
            }
            Self::OutOfStep(by) => {
                let word = if *by > 0 { "below" } else { "above" };
                write!(f, "the joint readings stood {} row(s) {word} the values that belong to them", by.abs())
            }
            Self::OtherChain(chain) => {
                write!(f, "they were measured on the chain from \"{}\" to \"{}\"", chain.base(), chain.tip())
            }
        }
    }
}

impl Mistake {
    /// What to do.
    pub fn mend(&self) -> String {
        match self {
            Self::Sense(_) => "change the sign of these readings, or the axis in the robot's file".into(),
            Self::Swapped(..) => "exchange their names in the header row".into(),
            Self::AngleUnit(..) => "write all angles in one unit and say which: ‹units›".into(),
            Self::Millimetres(_) | Self::PlaceUnit(..) => "write all lengths in one unit and say which: ‹units›".into(),
            Self::Coupled { of, by, plus } => {
                let sign = if *plus { "-" } else { "+" };
                format!("write {of} {sign} {by} into column \"{of}\"")
            }
            Self::Quaternion(QuaternionSlip::ScalarFirst) => "order the header row's names as the numbers are".into(),
            Self::Quaternion(_) => "write the target's orientation in the instrument's frame, as qx, qy, qz, qw".into(),
            Self::OutOfStep(_) => "pair readings and values row by row".into(),
            Self::OtherChain(chain) => format!("say ‹base› {} ‹tip› {}", chain.base(), chain.tip()),
        }
    }

    /// The chain and the data as they would be without the mistake; `None` where it cannot be undone here.
    pub(super) fn undone(&self, chain: &Chain, data: &Measurements) -> Option<(Chain, Measurements)> {
        let n = data.joints.len();
        let at = |name: &str| data.joints.iter().position(|joint| joint == name);
        let mut altered = data.clone();
        match self {
            Self::Sense(joints) => {
                let columns = joints.iter().map(|joint| at(joint)).collect::<Option<Vec<usize>>>()?;
                each_row(&mut altered, n, |row| columns.iter().for_each(|&k| row[k] = -row[k]));
            }
            Self::Swapped(a, b) => {
                let (a, b) = (at(a)?, at(b)?);
                each_row(&mut altered, n, |row| row.swap(a, b));
            }
            Self::AngleUnit(column, radians) => {
                let (k, factor) = (at(column)?, if *radians { 180.0 / PI } else { PI / 180.0 });
                each_row(&mut altered, n, |row| row[k] *= factor);
            }
            Self::Millimetres(column) => {
                let k = at(column)?;
                each_row(&mut altered, n, |row| row[k] *= 1e-3);
            }
            Self::PlaceUnit(axis, metres) => {
                let factor = if *metres { 1e3 } else { 1e-3 };
                for observation in 0..altered.observations() {
                    if places(altered.series_of(observation).kind) {
                        altered.observed.values_mut(observation)[*axis] *= factor;
                    }
                }
            }
            Self::Coupled { of, by, plus } => {
                let (of, by, sign) = (at(of)?, at(by)?, if *plus { 1.0 } else { -1.0 });
                each_row(&mut altered, n, |row| row[of] -= sign * row[by]);
            }
            Self::Quaternion(slip) => {
                for observation in 0..altered.observations() {
                    if altered.series_of(observation).kind != POSE {
                        continue;
                    }
                    // x, y, z and the rotation matrix column by column.
                    let values = &mut altered.observed.values_mut(observation)[3..12];
                    let read = Rotation3::from_matrix_unchecked(Matrix3::from_column_slice(values));
                    values.copy_from_slice(slip.undone(&read).matrix().as_slice());
                }
            }
            Self::OutOfStep(by) => {
                let rows: Vec<usize> = (0..data.len()).collect();
                let shift = usize::try_from(by.abs()).ok()?;
                let kept = rows.len().checked_sub(shift).filter(|kept| *kept > 4)?;
                let (values, readings) = if *by > 0 { (0, shift) } else { (shift, 0) };
                altered = data.subset(&rows[values..values + kept]);
                altered.readings = data.readings[readings * n..(readings + kept) * n].to_vec();
            }
            Self::OtherChain(other) => {
                altered.joints = other.coordinates().iter().map(|coordinate| coordinate.name.clone()).collect();
                altered.readings.clear();
                for row in 0..data.len() {
                    for name in &altered.joints {
                        let own = at(name).map(|k| data.reading(row)[k]);
                        let recorded = || data.covariate(name).map(|column| column.values[row]);
                        altered.readings.push(own.or_else(recorded)?);
                    }
                }
                return Some(((**other).clone(), altered));
            }
        }
        Some((chain.clone(), altered))
    }
}

impl QuaternionSlip {
    fn undone(self, orientation: &Rotation3<f64>) -> Rotation3<f64> {
        let read = UnitQuaternion::from_rotation_matrix(orientation);
        // Columns x, y, z, w held w, x, y, z.
        let first = |q: &UnitQuaternion<f64>| UnitQuaternion::new_normalize(Quaternion::new(q.i, q.j, q.k, q.w));
        let meant = match self {
            Self::ScalarFirst => first(&read),
            Self::Inverse => read.inverse(),
            Self::ScalarFirstInverse => first(&read).inverse(),
        };
        meant.to_rotation_matrix()
    }
}

/// Whether the first three values of an observation are a place.
fn places(kind: ObservationKind) -> bool {
    kind == POSE || kind == POSITION
}

fn each_row(data: &mut Measurements, n: usize, mut change: impl FnMut(&mut [f64])) {
    data.readings.chunks_exact_mut(n).for_each(&mut change);
}

/// The mistakes that can be made with these data, the simplest first.
pub(super) fn likely(chain: &Chain, data: &Measurements, other_chains: &[Chain]) -> Vec<Mistake> {
    let moving: Vec<usize> = (0..data.joints.len()).filter(|&k| !data.never_moves(k)).collect();
    let name = |k: usize| data.joints[k].clone();
    let slides = |k: usize| chain.coordinates()[k].quantity == Quantity::Length;
    let pairs: Vec<(usize, usize)> =
        moving.iter().flat_map(|&a| moving.iter().filter(move |&&b| a < b).map(move |&b| (a, b))).collect();
    let mut all: Vec<Mistake> = moving.iter().map(|&k| Mistake::Sense(vec![name(k)])).collect();
    all.extend(pairs.iter().map(|&(a, b)| Mistake::Swapped(name(a), name(b))));
    for &k in &moving {
        if slides(k) {
            all.push(Mistake::Millimetres(name(k)));
        } else {
            all.extend([false, true].map(|radians| Mistake::AngleUnit(name(k), radians)));
        }
    }
    if data.scene.series.iter().any(|series| places(series.kind)) {
        all.extend((0..3).flat_map(|axis| [false, true].map(|metres| Mistake::PlaceUnit(axis, metres))));
    }
    for (&by, &of) in moving.iter().zip(moving.iter().skip(1)) {
        if !slides(by) && !slides(of) {
            all.extend([true, false].map(|plus| Mistake::Coupled { of: name(of), by: name(by), plus }));
        }
    }
    if data.scene.series.iter().any(|series| series.kind == POSE) {
        use QuaternionSlip::{Inverse, ScalarFirst, ScalarFirstInverse};
        all.extend([ScalarFirst, Inverse, ScalarFirstInverse].map(Mistake::Quaternion));
    }
    all.extend(STEPS.map(Mistake::OutOfStep));
    all.extend(pairs.iter().map(|&(a, b)| Mistake::Sense(vec![name(a), name(b)])));
    all.extend(other_chains.iter().map(|other| Mistake::OtherChain(Box::new(other.clone()))));
    all
}
