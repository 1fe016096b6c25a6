//! Columns whose names are nearly known names: read as something else they would be lost without notice.

use super::known_columns::{KNOWN_COVARIATES, KNOWN_VALUES, OF_JOINTS};
use super::measurement_error::MeasurementError;
use denavit_model::Coordinate;

/// Names of at least this many letters may have one wrong letter.
const LONG: usize = 6;

const EULER: &str = "write the orientation as a quaternion, in columns qx, qy, qz, qw, or say what the angles are (‹euler› \
                     xyz, ZYX, …; ‹rotation-vector›)";
const QUATERNION: &str = "name a quaternion's columns qx, qy, qz, qw, by meaning and not by position, or give \
                          their order (‹quaternion› wxyz)";

/// Names that programs give to three or four numbers of an orientation, and what to do with them.
const ORIENTATIONS: [(&[&str], &str); 12] = [
    (&["roll", "pitch", "yaw"], EULER),
    (&["rx", "ry", "rz"], EULER),
    (&["a", "b", "c"], EULER),
    (&["w", "p", "r"], EULER),
    (&["rotx", "roty", "rotz"], EULER),
    (&["alpha", "beta", "gamma"], EULER),
    (&["phi", "theta", "psi"], EULER),
    (&["q1", "q2", "q3", "q4"], QUATERNION),
    (&["q0", "q1", "q2", "q3"], QUATERNION),
    (&["ox", "oy", "oz", "ow"], QUATERNION),
    (&["quatx", "quaty", "quatz", "quatw"], QUATERNION),
    (&["rotationx", "rotationy", "rotationz"], EULER),
];

/// A name in the form that is compared: lower case, no unit in brackets, no blanks, underscores, hyphens or dots.
fn plain(name: &str) -> String {
    let before = name.split(['(', '[', '{']).next().unwrap_or(name);
    before.chars().filter(|c| c.is_alphanumeric()).flat_map(char::to_lowercase).collect()
}

/// Whether an unknown column is nearly a known one.
pub(super) fn near_miss(name: &str, names: &[String], coordinates: &[Coordinate]) -> Option<MeasurementError> {
    let own = plain(name);
    let of_joints = coordinates.iter().flat_map(|c| OF_JOINTS.map(|word| format!("{}.{word}", c.name)));
    let known = KNOWN_VALUES.iter().chain(&KNOWN_COVARIATES).map(|known| (*known).to_owned()).chain(of_joints);
    let known: Vec<String> = known.collect();
    if known.iter().any(|known| known == name) {
        return None;
    }
    let typed = |known: &&String| known.len() >= LONG && strsim::osa_distance(&own, &plain(known)) <= 1;
    let known = known.iter().find(|known| own == plain(known)).or_else(|| known.iter().find(typed))?.clone();
    // Several targets are numbered: X beside x1 is not a misspelt x1.
    let numbered = known.len() == 1 && !names.contains(&known) && names.iter().any(|name| name == "x1");
    (!numbered).then(|| MeasurementError::NearMiss { column: name.into(), known })
}

/// Unknown columns that together look like an orientation.
pub(super) fn orientation_left_out(others: &[&String]) -> Option<MeasurementError> {
    ORIENTATIONS.iter().find_map(|(group, fix)| {
        let found =
            group.iter().map(|wanted| others.iter().find(|name| plain(name) == *wanted).map(|name| name.as_str()));
        let found: Vec<&str> = found.collect::<Option<_>>()?;
        Some(MeasurementError::OrientationLeftOut { columns: found.join(", "), fix })
    })
}
