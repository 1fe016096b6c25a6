//! Poses and numbers as SDF writes them.

use crate::error::SdfProblemKind as Kind;
use denavit_model::Pose;
use denavit_model::nalgebra::{Quaternion, UnitQuaternion, Vector3};
use denavit_model::se3;
use roxmltree::Node;

/// A pose as it is written, and its value.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Step {
    /// base_from_frame.
    pub pose: Pose,
    /// The attributes of a URDF `<origin>` that say the same in the same digits; empty for the identity.
    pub origin: String,
}

impl Step {
    pub fn identity() -> Self {
        Self { pose: Pose::identity(), origin: String::new() }
    }

    pub fn is_identity(&self) -> bool {
        self.origin.is_empty()
    }

    /// A pose that was computed.
    pub fn computed(pose: Pose) -> Self {
        let xyz: Vec<f64> = pose.translation.vector.iter().map(|length| clean_length(*length)).collect();
        let rpy = se3::written_rpy(&pose.rotation);
        let rpy = rpy.map(|angle| if angle.abs() < ROUNDING { 0.0 } else { angle });
        if xyz.iter().all(|length| *length == 0.0) && rpy == [0.0; 3] {
            return Self::identity();
        }
        Self { pose, origin: format!("xyz=\"{}\" rpy=\"{}\"", numbers(&xyz), numbers(&rpy)) }
    }
}

/// Angles (rad) and components of unit vectors below this are zero up to the rounding of products of rotations.
pub(crate) const ROUNDING: f64 = 2e-15;
/// Lengths are rounded to a decimal of this many places (m) where that changes them by less than [`ROUNDING`] of their size or
/// of 1 m: a difference of two short decimals is one.
const PLACES: i32 = 12;

fn clean_length(length: f64) -> f64 {
    let scale = 10f64.powi(PLACES);
    let rounded = (length * scale).round() / scale;
    if (rounded - length).abs() <= 4e-16 * length.abs().max(1.0) { rounded + 0.0 } else { length }
}

pub(crate) fn numbers(values: &[f64]) -> String {
    values.iter().map(ToString::to_string).collect::<Vec<_>>().join(" ")
}

/// An element's own text without white space around it.
pub(crate) fn text_of<'a>(node: Node<'a, '_>) -> &'a str {
    node.text().unwrap_or_default().trim()
}

fn bad(node: Node, word: &str, wanted: &'static str) -> Kind {
    Kind::BadNumber {
        element: node.tag_name().name().to_owned(),
        value: text_of(node).to_owned(),
        word: word.to_owned(),
        wanted,
    }
}

/// The text of an element as one finite number.
pub(crate) fn number(node: Node) -> Result<f64, Kind> {
    finite(text_of(node)).ok_or_else(|| bad(node, text_of(node), "finite number"))
}

/// The text of an element as a number that may be infinite.
pub(crate) fn number_or_infinite(node: Node) -> Result<f64, Kind> {
    let number = text_of(node).parse::<f64>().ok().filter(|number| !number.is_nan());
    number.ok_or_else(|| bad(node, text_of(node), "number"))
}

/// `true`, `false`, 1, 0.
pub(crate) fn boolean(node: Node) -> Result<bool, Kind> {
    match text_of(node).to_ascii_lowercase().as_str() {
        "true" | "1" => Ok(true),
        "false" | "0" | "" => Ok(false),
        other => Err(bad(node, other, "truth value; write true or false")),
    }
}

fn finite(word: &str) -> Option<f64> {
    word.parse::<f64>().ok().filter(|number| number.is_finite())
}

/// The words of an element's text, each a finite number, `count` of them.
pub(crate) fn several<'a>(node: Node<'a, '_>, count: usize) -> Result<(Vec<f64>, Vec<&'a str>), Kind> {
    let words: Vec<&str> = text_of(node).split_whitespace().collect();
    let numbers: Result<Vec<f64>, Kind> =
        words.iter().map(|word| finite(word).ok_or_else(|| bad(node, word, "finite number"))).collect();
    let numbers = numbers?;
    if numbers.len() != count {
        return Err(Kind::WrongCount {
            element: node.tag_name().name().to_owned(),
            value: text_of(node).to_owned(),
            found: numbers.len(),
            expected: count,
        });
    }
    Ok((numbers, words))
}

/// A `<pose>`: three lengths (m), then fixed-axis angles (rad, or degrees) or a quaternion x, y, z, w.
///
/// # Source
/// <http://sdformat.org/spec>, `pose`: `degrees` and `rotation_format` since SDF 1.9; an empty pose is the identity.
pub(crate) fn step(node: Node) -> Result<Step, Kind> {
    if text_of(node).is_empty() {
        return Ok(Step::identity());
    }
    let degrees = match node.attribute("degrees").map(str::trim) {
        None | Some("false" | "0") => false,
        Some("true" | "1") => true,
        Some(other) => return Err(bad(node, other, "truth value; write degrees=\"true\" or \"false\"")),
    };
    match node.attribute("rotation_format").map_or("euler_rpy", str::trim) {
        "euler_rpy" => {
            let (values, words) = several(node, 6)?;
            let turned = |angle: f64| if degrees { angle.to_radians() } else { angle };
            let rpy = [turned(values[3]), turned(values[4]), turned(values[5])];
            let pose = se3::pose(se3::rotation_from_rpy(rpy), Vector3::new(values[0], values[1], values[2]));
            if values.iter().all(|value| *value == 0.0) {
                return Ok(Step::identity());
            }
            let angles = if degrees { numbers(&rpy) } else { words[3..].join(" ") };
            Ok(Step { pose, origin: format!("xyz=\"{}\" rpy=\"{angles}\"", words[..3].join(" ")) })
        }
        "quat_xyzw" => {
            let (values, words) = several(node, 7)?;
            let quaternion = Quaternion::new(values[6], values[3], values[4], values[5]);
            let turn = UnitQuaternion::try_new(quaternion, f64::MIN_POSITIVE);
            let turn = turn.ok_or_else(|| Kind::ZeroQuaternion(text_of(node).to_owned()))?.to_rotation_matrix();
            let pose = se3::pose(turn, Vector3::new(values[0], values[1], values[2]));
            let origin = format!("xyz=\"{}\" quat_xyzw=\"{}\"", words[..3].join(" "), words[3..].join(" "));
            Ok(if pose == Pose::identity() { Step::identity() } else { Step { pose, origin } })
        }
        other => Err(Kind::UnknownRotation(other.to_owned())),
    }
}
