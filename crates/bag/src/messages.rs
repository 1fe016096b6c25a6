//! The messages that are read, field by field.
//!
//! # Source
//! The definitions of `std_msgs`, `sensor_msgs`, `geometry_msgs` and `tf2_msgs` (<https://docs.ros.org/en/rolling/p/>).

use crate::cdr::Cdr;

/// Joint readings.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct JointState {
    /// By the robot's clock, s.
    pub stamp: f64,
    pub names: Vec<String>,
    /// rad or m.
    pub positions: Vec<f64>,
}

/// A target's place.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Placed {
    /// By the instrument's clock, s.
    pub stamp: f64,
    /// What was placed in what, where the message says it: `parent/child`.
    pub frames: String,
    /// m.
    pub place: [f64; 3],
    /// x, y, z, w.
    pub turn: Option<[f64; 4]>,
}

/// A type of message that places targets.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Places {
    Pose,
    Transform,
    Transforms,
    Point,
}

/// The type without its package's `msg` folder: `sensor_msgs/JointState`.
pub(crate) fn plain(kind: &str) -> String {
    kind.replace("/msg/", "/")
}

/// What a type of message places, where it does.
pub(crate) fn places(kind: &str) -> Option<Places> {
    match plain(kind).as_str() {
        "geometry_msgs/PoseStamped" => Some(Places::Pose),
        "geometry_msgs/TransformStamped" => Some(Places::Transform),
        "tf2_msgs/TFMessage" => Some(Places::Transforms),
        "geometry_msgs/PointStamped" => Some(Places::Point),
        _ => None,
    }
}

/// Stamp, s, and frame.
fn header(cdr: &mut Cdr<'_>) -> Option<(f64, String)> {
    let (seconds, nanoseconds) = (cdr.i32()?, cdr.u32()?);
    Some((f64::from(seconds) + f64::from(nanoseconds) * 1e-9, cdr.text()?))
}

/// A `JointState`; `None` if it is not one.
pub(crate) fn joint_state(message: &[u8]) -> Option<JointState> {
    let cdr = &mut Cdr::new(message)?;
    let (stamp, _) = header(cdr)?;
    let names = cdr.list(Cdr::text)?;
    let positions = cdr.list(Cdr::f64)?;
    Some(JointState { stamp, names, positions })
}

fn transform(cdr: &mut Cdr<'_>) -> Option<Placed> {
    let (stamp, parent) = header(cdr)?;
    let frames = format!("{parent}/{}", cdr.text()?);
    Some(Placed { stamp, frames, place: cdr.numbers()?, turn: Some(cdr.numbers()?) })
}

/// What a message places; `None` where it is not of this type.
pub(crate) fn placed(places: Places, message: &[u8]) -> Option<Vec<Placed>> {
    let cdr = &mut Cdr::new(message)?;
    match places {
        Places::Transforms => cdr.list(transform),
        Places::Transform => Some(vec![transform(cdr)?]),
        Places::Pose | Places::Point => {
            let (stamp, _) = header(cdr)?;
            let place = cdr.numbers()?;
            let turn = if places == Places::Pose { Some(cdr.numbers()?) } else { None };
            Some(vec![Placed { stamp, frames: String::new(), place, turn }])
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A point at (1, -2, 0.5) m in frame "base" at 3.25 s, laid out by hand after the standard, big end first.
    #[test]
    fn a_message_is_read_in_either_byte_order() {
        let big: Vec<u8> = [
            &[0u8, 0, 0, 0][..],
            &[0, 0, 0, 3],
            &250_000_000u32.to_be_bytes(),
            &[0, 0, 0, 5],
            b"base\0",
            // To the next multiple of eight after the encapsulation.
            &[0; 7],
            &1.0f64.to_be_bytes(),
            &(-2.0f64).to_be_bytes(),
            &0.5f64.to_be_bytes(),
        ]
        .concat();
        let found = placed(Places::Point, &big).unwrap();
        assert_eq!((found[0].stamp, found[0].place, found[0].turn), (3.25, [1.0, -2.0, 0.5], None));
        // Cut anywhere, it is no message.
        assert!((0..big.len()).all(|end| placed(Places::Point, &big[..end]).is_none()));
        // XCDR2 and parameter lists are not read as if they were plain.
        assert_eq!(placed(Places::Point, &[&[0, 7], &big[2..]].concat()), None);
    }
}
