//! Common mistakes in measurement files, and how each is undone.

use super::conventions::{self, Meant};
use denavit_measurements::Measurements;
use denavit_measurements::import::AngleConvention;
use denavit_measurements::kinds::ObservationKind;
use denavit_model::nalgebra::{Matrix3, Quaternion, Rotation3, UnitQuaternion};
use denavit_model::{Chain, Quantity};
use std::f64::consts::PI;
use std::fmt;

const PLACE: [&str; 3] = ["x", "y", "z"];
/// Largest shift of readings by rows that is tried.
const STEPS: [i32; 4] = [1, -1, 2, -2];

/// Quaternions written in another way than x, y, z, w of the target in the instrument's frame.
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
    /// A joint's reading includes another joint's angle: `of` reads its angle plus (or less) that of `by`.
    Coupled {
        /// The joint.
        of: String,
        /// The other one.
        by: String,
        /// Plus.
        plus: bool,
    },
    /// Joints that count from another zero: each with what is added to its reading to have the angle of the drawing, rad.
    Zero(Vec<(String, f64)>),
    /// All lengths, or all angles, or both are in another unit: what they are multiplied by.
    Units {
        /// Of lengths.
        lengths: f64,
        /// Of angles.
        angles: f64,
    },
    /// The angles of the orientation are written in another convention.
    Angles {
        /// Which.
        convention: AngleConvention,
        /// Whether they are the inverse: the instrument in the target's frame.
        inverse: bool,
        /// What they are multiplied by to be in rad as they were read.
        factor: f64,
    },
    /// The quaternion is written otherwise.
    Quaternion(QuaternionSlip),
    /// The readings are this many rows below (negative: above) the values that belong to them.
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
                write!(f, "the measured {} were in {unit}, unlike the other two", PLACE[*axis])
            }
            Self::Coupled { of, by, plus } => {
                let sign = if *plus { "plus" } else { "minus" };
                write!(
                    f,
                    "\"{of}\" were measured from the ground: its reading is its own angle {sign} that of \"{by}\""
                )
            }
            Self::Zero(zeros) => {
                let of = |(joint, zero): &(String, f64)| format!("\"{joint}\" counted from {}", in_degrees(*zero));
                write!(f, "{}", zeros.iter().map(of).collect::<Vec<_>>().join(" and "))
            }
            Self::Units { lengths, angles } => {
                let said = [
                    angle_unit(*angles).map(|unit| format!("all angles were in {unit}")),
                    length_unit(*lengths).map(|unit| format!("all lengths were in {unit}")),
                ];
                f.write_str(&said.into_iter().flatten().collect::<Vec<_>>().join(" and "))
            }
            Self::Angles { convention, inverse, factor } => {
                let what = match convention {
                    AngleConvention::RotationVector => "a rotation vector".to_owned(),
                    AngleConvention::Euler(order) => format!("the angles of {order}"),
                };
                let unit = angle_unit(*factor).map_or_else(String::new, |unit| format!(", in {unit}"));
                let inverse = if *inverse { ", and inverse: of the instrument in the target's frame" } else { "" };
                write!(f, "the orientation were written as {what}{unit}{inverse}")
            }
            Self::Quaternion(QuaternionSlip::ScalarFirst) => write!(f, "the quaternion were written w first"),
            Self::Quaternion(QuaternionSlip::Inverse) => {
                write!(f, "the quaternion were inverse: of the instrument in the target's frame")
            }
            Self::Quaternion(QuaternionSlip::ScalarFirstInverse) => {
                write!(f, "the quaternion were inverse and written w first")
            }
            Self::OutOfStep(by) => {
                let word = if *by > 0 { "below" } else { "above" };
                write!(f, "the joint readings were {} row(s) {word} the values that belong to them", by.abs())
            }
            Self::OtherChain(chain) => {
                write!(f, "they were measured on the chain from \"{}\" to \"{}\"", chain.base(), chain.tip())
            }
        }
    }
}

impl Mistake {
    /// What to do.
    pub fn fix(&self) -> String {
        match self {
            Self::Sense(_) => "change the sign of these readings, or the axis in the robot's file".into(),
            Self::Swapped(..) => "exchange their names in the header row".into(),
            Self::AngleUnit(..) => "write all angles in one unit and state it: ‹units›".into(),
            Self::Millimetres(_) | Self::PlaceUnit(..) => "write all lengths in one unit and state it: ‹units›".into(),
            Self::Coupled { of, by, plus } => {
                let sign = if *plus { "-" } else { "+" };
                format!("write {of} {sign} {by} into column \"{of}\"")
            }
            Self::Zero(zeros) => {
                let of = |(joint, zero): &(String, f64)| {
                    let sign = if *zero < 0.0 { '-' } else { '+' };
                    format!("write {joint} {sign} {} into column \"{joint}\"", in_degrees(zero.abs()))
                };
                zeros.iter().map(of).collect::<Vec<_>>().join(", ")
            }
            Self::Units { .. } => "state them: ‹units›, or units in the map".into(),
            Self::Angles { convention, inverse, factor } => {
                let option = match convention {
                    AngleConvention::RotationVector => {
                        "use ‹rotation-vector› (in a map: rotation_vector = [three columns])".to_owned()
                    }
                    AngleConvention::Euler(order) => {
                        format!("use ‹euler› {order} (in a map: euler = {{ order = \"{order}\", columns = [three] }})")
                    }
                };
                let unit = angle_unit(*factor).map_or_else(String::new, |unit| format!(", name the unit: rx ({unit})"));
                let inverse =
                    if *inverse { ", and write the target's orientation in the instrument's frame" } else { "" };
                format!("{option}{unit}{inverse}")
            }
            Self::Quaternion(QuaternionSlip::ScalarFirst) => {
                "put the names of the header row in the order of the numbers".into()
            }
            Self::Quaternion(_) => "write the target's orientation in the instrument's frame, as qx, qy, qz, qw".into(),
            Self::OutOfStep(_) => "pair readings and values row by row".into(),
            Self::OtherChain(chain) => format!("use ‹base› {} ‹tip› {}", chain.base(), chain.tip()),
        }
    }

    /// Whether rows can be used with the mistake undone: the meaning of each reading is then certain, and nothing else changes.
    pub fn harmless(&self) -> bool {
        matches!(self, Self::Coupled { .. } | Self::Zero(_))
    }

    /// The offsets of each coordinate's reading, if the mistake is only zeros.
    pub fn zeros(&self, chain: &Chain) -> Option<Vec<f64>> {
        let Self::Zero(zeros) = self else { return None };
        let mut shifts = vec![0.0; chain.coordinates().len()];
        for (name, zero) in zeros {
            shifts[chain.coordinates().iter().position(|coordinate| coordinate.name == *name)?] += zero;
        }
        Some(shifts)
    }

    /// The joints whose readings it changes.
    pub fn joints(&self) -> Vec<&str> {
        match self {
            Self::Zero(zeros) => zeros.iter().map(|(joint, _)| joint.as_str()).collect(),
            Self::Sense(joints) => joints.iter().map(String::as_str).collect(),
            Self::Swapped(a, b) => vec![a, b],
            Self::Coupled { of, .. } => vec![of],
            Self::AngleUnit(joint, _) | Self::Millimetres(joint) => vec![joint],
            _ => Vec::new(),
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
            Self::Zero(zeros) => {
                let of = |(joint, zero): &(String, f64)| Some((at(joint)?, *zero));
                let zeros = zeros.iter().map(of).collect::<Option<Vec<_>>>()?;
                each_row(&mut altered, n, |row| zeros.iter().for_each(|(k, zero)| row[*k] += zero));
            }
            Self::Units { lengths, angles } => {
                let factors: Vec<f64> = chain
                    .coordinates()
                    .iter()
                    .map(|coordinate| if coordinate.quantity == Quantity::Length { *lengths } else { *angles })
                    .collect();
                each_row(&mut altered, n, |row| {
                    row.iter_mut().zip(&factors).for_each(|(cell, factor)| *cell *= factor);
                });
                for observation in 0..altered.observations() {
                    let count = altered.series_of(observation).kind.lengths();
                    altered.observed.values_mut(observation).iter_mut().take(count).for_each(|value| *value *= lengths);
                }
                if let Some(written) = &data.angles {
                    turned(&mut altered, (written.read_as, false, *angles))?;
                }
            }
            Self::Angles { convention, inverse, factor } => turned(&mut altered, (*convention, *inverse, *factor))?,
            Self::Quaternion(slip) => {
                for observation in 0..altered.observations() {
                    if altered.series_of(observation).kind != ObservationKind::Pose {
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

/// Converts the orientations again from the angles as written.
fn turned(data: &mut Measurements, meant: Meant) -> Option<()> {
    let written = data.angles.clone()?;
    for row in 0..data.len() {
        let rotation = conventions::rotation(meant, written.by_axis, written.numbers[row]);
        for observation in data.of_row(row) {
            if data.series_of(observation).kind == ObservationKind::Pose {
                data.observed.values_mut(observation)[3..12].copy_from_slice(rotation.matrix().as_slice());
            }
        }
    }
    Some(())
}

/// An angle as people write it: `90°`, `-37.21°`.
fn in_degrees(angle: f64) -> String {
    let degrees = (angle.to_degrees() * 100.0).round() / 100.0;
    format!("{degrees}°")
}

/// The true unit of angles that were read in another one.
fn angle_unit(factor: f64) -> Option<&'static str> {
    (factor != 1.0).then_some(if factor > 1.0 { "rad" } else { "deg" })
}

/// The true unit of lengths that were read in another one.
fn length_unit(factor: f64) -> Option<&'static str> {
    let known = LENGTH_FACTORS.iter().find(|(known, _)| *known == factor);
    known.map(|(_, unit)| *unit)
}

/// Factor for lengths in this unit that were read as mm, m or in.
const LENGTH_FACTORS: [(f64, &str); 6] =
    [(1e3, "m"), (1e-3, "mm"), (25.4, "in"), (0.0254, "in"), (1.0 / 25.4, "mm"), (1.0 / 0.0254, "m")];

/// Whether the first three values of an observation are a place.
fn places(kind: ObservationKind) -> bool {
    kind == ObservationKind::Pose || kind == ObservationKind::Position
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
    if data.scene.series.iter().any(|series| series.kind == ObservationKind::Pose) {
        use QuaternionSlip::{Inverse, ScalarFirst, ScalarFirstInverse};
        all.extend([ScalarFirst, Inverse, ScalarFirstInverse].map(Mistake::Quaternion));
    }
    let factors = || std::iter::once(1.0).chain(LENGTH_FACTORS.map(|(factor, _)| factor));
    for angles in [1.0, 180.0 / PI, PI / 180.0] {
        let other = factors().filter(|lengths| *lengths != 1.0 || angles != 1.0);
        all.extend(other.map(|lengths| Mistake::Units { lengths, angles }));
    }
    all.extend(STEPS.map(Mistake::OutOfStep));
    all.extend(pairs.iter().map(|&(a, b)| Mistake::Sense(vec![name(a), name(b)])));
    all.extend(other_chains.iter().map(|other| Mistake::OtherChain(Box::new(other.clone()))));
    all
}
