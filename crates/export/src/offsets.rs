//! Joint offsets in the formats of servos, drivers and ROS packages.
//!
//! An offset is added to a joint's reading: angle = reading + zero. An offset that the data cannot separate from the
//! pose of the instrument is omitted from every format except the table, with a note.

use crate::makers::Written;
use crate::urdf::ExportError;
use crate::urdf::text::{Edits, Nodes, parse, word};
use denavit_model::robot::Robot;
use std::f64::consts::TAU;
use std::fmt::Write as _;
use thiserror::Error;

/// Steps of a servo's encoder in a turn: Feetech STS, Dynamixel X.
const STEPS: f64 = 4096.0;
/// What a Feetech servo's offset register holds, in steps: eleven bits and a sign.
const FEETECH_MOST: i64 = 2047;
/// What a Dynamixel takes in position mode, in steps; it ignores more.
const DYNAMIXEL_MOST: i64 = 1024;

/// The offset of one joint.
#[derive(Debug, Clone, PartialEq)]
pub struct Offset {
    /// The joint.
    pub joint: String,
    /// Added to its reading, rad or m.
    pub zero: f64,
    /// Standard deviation, the same unit.
    pub std: f64,
    /// Whether the joint turns.
    pub turns: bool,
    /// Whether the data determine it.
    pub determined: bool,
}

/// What the files are made from.
#[derive(Debug, Clone, Copy)]
pub struct Offsets<'a> {
    /// Joint by joint, in the chain's order.
    pub joints: &'a [Offset],
    /// The tree, for the URDF format.
    pub drawn: Option<&'a Robot>,
}

/// A format.
#[derive(Debug, Clone, Copy)]
pub struct Form {
    /// The word on the command line.
    pub name: &'static str,
    /// Which program uses the file.
    pub purpose: &'static str,
    /// Writes it.
    pub render: fn(&Offsets) -> Result<Written, OffsetsError>,
}

/// Every format.
pub const FORMS: &[Form] = &[
    Form { name: "csv", purpose: "a table: joint, zero, standard deviation", render: csv },
    Form {
        name: "ros2-control",
        purpose: "transmissions with <offset>, for the <ros2_control> element",
        render: ros2_control,
    },
    Form {
        name: "lerobot",
        purpose: "changes of homing_offset in lerobot's calibration, in steps of a Feetech servo",
        render: lerobot,
    },
    Form { name: "dynamixel", purpose: "changes of Homing Offset (20), in steps of a Dynamixel X", render: dynamixel },
    Form { name: "xacro", purpose: "arguments JOINT_zero:=VALUE", render: xacro },
    Form {
        name: "robot-calibration",
        purpose: "the ROS package robot_calibration: loadOffsetYAML",
        render: robot_calibration,
    },
    Form { name: "urdf", purpose: "the URDF with <calibration rising>, origins unchanged", render: urdf },
];

/// Why offsets cannot be written in a format.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum OffsetsError {
    /// No format with this name.
    #[error("‹offsets-out›: \"{name}\" is not a known format; known formats: {known}")]
    Unknown {
        /// The requested name.
        name: String,
        /// What there is.
        known: String,
    },
    /// The format holds servo steps.
    #[error("‹offsets-out› {form}: joint \"{joint}\" slides, and the format holds servo steps; use csv")]
    Slides {
        /// The form.
        form: &'static str,
        /// The joint.
        joint: String,
    },
    /// The format is a URDF.
    #[error("‹offsets-out› urdf: the format edits a URDF; give the robot as a URDF or xacro, or use csv")]
    NeedsTree,
    /// A calibration in the file is not a number.
    #[error(
        "{file}:{line}: joint \"{joint}\": rising=\"{written}\" is not a number; correct it, or use ‹offsets-out› csv"
    )]
    NoNumber {
        /// The file.
        file: String,
        /// The line.
        line: usize,
        /// The joint.
        joint: String,
        /// The written value.
        written: String,
    },
    /// The URDF's text could not be edited.
    #[error(transparent)]
    Export(#[from] ExportError),
}

/// The format with this name.
///
/// # Errors
/// The name is unknown; the message lists the known ones.
pub fn named(name: &str) -> Result<&'static Form, OffsetsError> {
    let known = || FORMS.iter().map(|form| form.name).collect::<Vec<_>>().join(", ");
    let found = FORMS.iter().find(|form| form.name == name);
    found.ok_or_else(|| OffsetsError::Unknown { name: name.to_owned(), known: known() })
}

/// The offsets that the data determine, and a note on each of the others.
fn determined<'a>(offsets: &Offsets<'a>) -> (Vec<&'a Offset>, Vec<String>) {
    let (determined, not): (Vec<&Offset>, Vec<&Offset>) = offsets.joints.iter().partition(|offset| offset.determined);
    let left_out = |offset: &&Offset| format!("the data do not determine the zero of \"{}\"; left out", offset.joint);
    (determined, not.iter().map(left_out).collect())
}

fn csv(offsets: &Offsets) -> Result<Written, OffsetsError> {
    let mut text = String::from("joint,zero,std,unit,told\n");
    for Offset { joint, zero, std, turns, determined } in offsets.joints {
        let unit = if *turns { "rad" } else { "m" };
        let _ = writeln!(text, "{},{zero:?},{std:?},{unit},{determined}", quoted(joint));
    }
    Ok(Written { text, left_out: Vec::new() })
}

/// A name as a cell of a CSV.
fn quoted(name: &str) -> String {
    if name.contains([',', '"', '\n']) { format!("\"{}\"", name.replace('"', "\"\"")) } else { name.to_owned() }
}

/// `SimpleTransmission`: joint position = actuator position / reduction + offset
/// (ros-controls/ros2_control, `transmission_interface/simple_transmission.hpp`).
fn ros2_control(offsets: &Offsets) -> Result<Written, OffsetsError> {
    let (determined, left_out) = determined(offsets);
    let mut text =
        String::from("<!-- Inside <ros2_control>. Keep an existing reduction, and add to an existing offset. -->\n");
    for Offset { joint, zero, .. } in determined {
        let name = crate::urdf::text::escaped(joint);
        let _ = writeln!(
            text,
            "<transmission name=\"{name}_transmission\">\n  <plugin>transmission_interface/SimpleTransmission</plugin>\n  \
             <actuator name=\"{name}_actuator\" role=\"actuator1\"/>\n  <joint name=\"{name}\" role=\"joint1\">\n    \
             <mechanical_reduction>1</mechanical_reduction>\n    <offset>{}</offset>\n  </joint>\n</transmission>",
            word(*zero)
        );
    }
    Ok(Written { text, left_out })
}

/// Servo steps by joint, and what was omitted from the file.
type Steps = (Vec<(String, i64)>, Vec<String>);

/// Servo steps that shift the reading by the zero; a note on each that exceeds the register.
#[allow(clippy::cast_possible_truncation, reason = "a zero of a joint is a few turns at most, thousands of steps")]
fn steps(form: &'static str, (sign, most): (f64, i64), offsets: &Offsets) -> Result<Steps, OffsetsError> {
    let (determined, mut left_out) = determined(offsets);
    let mut all = Vec::new();
    for offset in determined {
        if !offset.turns {
            return Err(OffsetsError::Slides { form, joint: offset.joint.clone() });
        }
        let steps = (sign * offset.zero * STEPS / TAU).round() as i64;
        if steps.abs() > most {
            left_out.push(format!(
                "\"{}\" would change by {steps} steps, and the register holds {most}; remount its horn",
                offset.joint
            ));
        }
        all.push((offset.joint.clone(), steps));
    }
    Ok((all, left_out))
}

/// Present Position = Actual Position - Homing Offset (huggingface/lerobot, `motors/feetech/feetech.py`).
fn lerobot(offsets: &Offsets) -> Result<Written, OffsetsError> {
    let (all, left_out) = steps("lerobot", (-1.0, FEETECH_MOST), offsets)?;
    let entries: serde_json::Map<String, serde_json::Value> =
        all.into_iter().map(|(joint, steps)| (joint, serde_json::json!({ "add_to_homing_offset": steps }))).collect();
    let text = serde_json::to_string_pretty(&entries).expect("names are texts and steps are numbers") + "\n";
    Ok(Written { text, left_out })
}

/// Present Position(132) = Actual Position + Homing Offset(20), 4096 steps a turn (ROBOTIS e-Manual, X series).
fn dynamixel(offsets: &Offsets) -> Result<Written, OffsetsError> {
    let (all, left_out) = steps("dynamixel", (1.0, DYNAMIXEL_MOST), offsets)?;
    let mut text = String::from("joint,add_to_homing_offset\n");
    for (joint, steps) in all {
        let _ = writeln!(text, "{},{steps}", quoted(&joint));
    }
    Ok(Written { text, left_out })
}

fn xacro(offsets: &Offsets) -> Result<Written, OffsetsError> {
    let (determined, left_out) = determined(offsets);
    let of = |offset: &&Offset| format!("{}_zero:={}", offset.joint, word(offset.zero));
    Ok(Written { text: determined.iter().map(of).collect::<Vec<_>>().join(" ") + "\n", left_out })
}

/// A joint's name alone is what is added to its position (mikeferguson/robot_calibration,
/// `src/optimization/offsets.cpp`).
fn robot_calibration(offsets: &Offsets) -> Result<Written, OffsetsError> {
    let (determined, left_out) = determined(offsets);
    let mut text = String::new();
    for Offset { joint, zero, .. } in determined {
        let _ = writeln!(text, "{}: {zero:?}", crate::makers::yaml::key(joint));
    }
    Ok(Written { text, left_out })
}

/// Like robot_calibration's `updateURDF`: added to an existing `rising`.
fn urdf(offsets: &Offsets) -> Result<Written, OffsetsError> {
    let robot = offsets.drawn.ok_or(OffsetsError::NeedsTree)?;
    let (determined, left_out) = determined(offsets);
    let document = parse(robot)?;
    let nodes = Nodes::of(robot, &document)?;
    let mut edits = Edits::default();
    for Offset { joint, zero, .. } in determined {
        let Some(index) = robot.joint_index(joint) else { continue };
        let node = nodes.joint(index);
        let found = node.children().find(|child| child.has_tag_name("calibration"));
        match found.and_then(|calibration| Some((calibration, calibration.attribute("rising")?))) {
            Some((calibration, written)) => {
                let old = written.trim().parse::<f64>().map_err(|_| OffsetsError::NoNumber {
                    file: robot.source.file.clone(),
                    line: robot.source.line(calibration.range().start),
                    joint: joint.clone(),
                    written: written.to_owned(),
                })?;
                edits.attribute(&robot.source, calibration, "rising", &word(old + zero));
            }
            None => {
                if let Some(calibration) = found {
                    edits.attribute(&robot.source, calibration, "rising", &word(*zero));
                } else {
                    let element = format!("<calibration rising=\"{}\"/>", word(*zero));
                    edits.lines_at_end(&robot.source, node, &[element]);
                }
            }
        }
    }
    Ok(Written { text: edits.apply(&robot.source)?, left_out })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn joints() -> Vec<Offset> {
        let of = |joint: &str, zero: f64, determined| Offset {
            joint: joint.into(),
            zero,
            std: 1e-3,
            turns: true,
            determined,
        };
        vec![of("pan", 0.0, false), of("lift", 0.1, true), of("elbow", -0.05, true)]
    }

    fn text(form: &str) -> String {
        let joints = joints();
        (named(form).unwrap().render)(&Offsets { joints: &joints, drawn: None }).unwrap().text
    }

    #[test]
    fn steps_have_the_sense_of_each_servo() {
        // 0.1 rad are 65.19 steps of 4096; a reading is raised by less offset (Feetech) or more (Dynamixel).
        assert!(text("lerobot").contains("\"lift\": {\n    \"add_to_homing_offset\": -65"));
        assert!(text("dynamixel").contains("lift,65\nelbow,-33\n"));
    }

    #[test]
    fn what_the_data_do_not_tell_is_left_out() {
        for form in FORMS.iter().filter(|form| !["csv", "urdf"].contains(&form.name)) {
            let joints = joints();
            let made = (form.render)(&Offsets { joints: &joints, drawn: None }).unwrap();
            assert!(!made.text.contains("pan") && made.text.contains("elbow"), "{}: {}", form.name, made.text);
            assert_eq!(made.left_out.len(), 1, "{}", form.name);
        }
        assert!(text("csv").contains("pan,0.0,0.001,rad,false"));
    }

    #[test]
    fn a_calibration_that_stands_there_is_added_to() {
        let source = "<robot name=\"r\">\n  <link name=\"a\"/>\n  <link name=\"b\"/>\n  <link name=\"c\"/>\n  \
            <joint name=\"lift\" type=\"continuous\">\n    <parent link=\"a\"/>\n    <child link=\"b\"/>\n    \
            <calibration rising=\"0.2\"/>\n  </joint>\n  <joint name=\"elbow\" type=\"continuous\">\n    \
            <parent link=\"b\"/>\n    <child link=\"c\"/>\n  </joint>\n</robot>\n";
        let robot = denavit_model::urdf::read("r.urdf", source).unwrap();
        let joints = joints();
        let made = urdf(&Offsets { joints: &joints, drawn: Some(&robot) }).unwrap().text;
        let expected = source
            .replace("rising=\"0.2\"", "rising=\"0.30000000000000004\"")
            .replace("<child link=\"c\"/>", "<child link=\"c\"/>\n    <calibration rising=\"-0.05\"/>");
        assert_eq!(made, expected);
        assert!(matches!(urdf(&Offsets { joints: &joints, drawn: None }), Err(OffsetsError::NeedsTree)));
        let wrong = denavit_model::urdf::read("r.urdf", &source.replace("0.2", "x")).unwrap();
        let error = urdf(&Offsets { joints: &joints, drawn: Some(&wrong) }).unwrap_err().to_string();
        assert!(error.starts_with("r.urdf:8: joint \"lift\": rising=\"x\" is not a number"), "{error}");
    }
}
