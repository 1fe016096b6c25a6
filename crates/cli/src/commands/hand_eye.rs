//! `denavit hand-eye`: where the instrument and the target are, from pairs of poses alone.

use crate::args::{HandEyeArguments, HandEyeFormat};
use crate::delivery::Delivery;
use crate::failure::Failure;
use crate::measured;
use crate::output::Status;
use crate::source;
use denavit_hand_eye::report::{self, Lines};
use denavit_hand_eye::{Arrangement, HandEyeError, Pair, solve};
use denavit_measurements::import::AngleConvention;
use denavit_measurements::pose_pairs::{self, PairAngles};

/// Runs the command.
pub fn run(arguments: &HandEyeArguments) -> Result<Status, Failure> {
    let delivery = Delivery::of(arguments.output.as_deref(), &arguments.json, [arguments.data.as_str()])?;
    let units = measured::units(&arguments.units)?;
    let angles = PairAngles {
        robot: convention("--robot-angles", &arguments.robot_angles)?,
        seen: convention("--angles", &arguments.angles)?,
    };
    let (file, bytes) = source::read_bytes(&arguments.data)?;
    let read = pose_pairs::read(&file, &bytes[..], units, angles)?;
    let pairs: Vec<Pair> =
        read.robot.iter().zip(&read.seen).map(|(robot, seen)| Pair { robot: *robot, seen: *seen }).collect();
    let arrangement = if arguments.on_hand { Arrangement::InstrumentOnHand } else { Arrangement::InstrumentStands };
    let found = solve(&pairs, arrangement)
        .map_err(|source| Failure::HandEye { file: named(&file, &source, &read.lines), source })?;
    let lines = Lines { rows: &read.lines, unseen: &read.unseen };
    let parent = arguments.parent.as_deref().unwrap_or(if arguments.on_hand { "tip" } else { "base" });
    let own = || {
        let placed = report::instrument(&found);
        Ok(match arguments.format {
            HandEyeFormat::Text => report::text(&found, lines),
            HandEyeFormat::Json => report::json(&found, lines),
            HandEyeFormat::RosLaunch => report::ros_launch(placed, parent, &arguments.child),
            HandEyeFormat::RosYaml => report::ros_yaml(placed, parent, &arguments.child),
            HandEyeFormat::Urdf => report::urdf(placed, parent, &arguments.child),
        })
    };
    delivery.deliver(own, || Ok(report::json(&found, lines)))?;
    Ok(if found.unknown.is_none() && found.converged { Status::Same } else { Status::Different })
}

/// The file, and the line where one row is at fault.
fn named(file: &str, error: &HandEyeError, lines: &[usize]) -> String {
    match error {
        HandEyeError::NotFinite(row) => {
            lines.get(row - 1).map_or_else(|| file.to_owned(), |line| format!("{file}:{line}"))
        }
        _ => file.to_owned(),
    }
}

fn convention(option: &str, word: &str) -> Result<AngleConvention, Failure> {
    match word {
        "vector" => Ok(AngleConvention::RotationVector),
        order => order
            .parse()
            .map(AngleConvention::Euler)
            .map_err(|error| Failure::Argument(format!("{option}: {error}; or write vector for a rotation vector"))),
    }
}
