//! `denavit fk`: where the tip is.

use crate::args::FkArguments;
#[cfg(feature = "calibrate")]
use crate::args::GivenArguments;
use crate::delivery::Delivery;
use crate::failure::Failure;
#[cfg(feature = "calibrate")]
use crate::measured;
use crate::output::{self, Status};
use crate::source;
use denavit_export::numbers::decimal;
use denavit_export::poe::pose_text;
#[cfg(feature = "calibrate")]
use denavit_identify::effects::driver::{Conditions, Statics};
#[cfg(feature = "calibrate")]
use denavit_load::measured::{taken_at_averages, with_given, without_part_in_the_tip};
#[cfg(feature = "calibrate")]
use denavit_model::Pose;
use denavit_model::chain::{Chain, Coordinate, Quantity};
use denavit_model::nalgebra::UnitQuaternion;
use denavit_model::problems::nearest_name;
use denavit_model::se3;
use std::fmt::Write as _;

/// Runs the command.
pub fn run(arguments: &FkArguments) -> Result<Status, Failure> {
    let units = super::units(&arguments.units)?;
    let inputs = arguments.robot.files().chain(arguments.effects.as_deref());
    let delivery = Delivery::of(None, &arguments.json, inputs)?;
    let loaded = source::load(&arguments.robot.robot, &arguments.robot.source)?;
    let noted = loaded.chain(&arguments.robot.selection())?;
    let chain = &noted.value;
    let q = joint_values(chain, "--q", &arguments.q, arguments.degrees)?;
    doubts(chain, &q, arguments.degrees);
    let pose = match &arguments.effects {
        None if !arguments.given.given.is_empty() => {
            return Err(Failure::Argument("--given sets quantities that effects follow; it needs --effects".into()));
        }
        None => chain.fk(&q),
        #[cfg(not(feature = "calibrate"))]
        Some(_) => return Err(Failure::not_built("calibrate")),
        #[cfg(feature = "calibrate")]
        Some(file) => {
            let statics = loaded.statics(chain, arguments.robot.selection().reading);
            with_effects(file, &statics, chain, &arguments.given, &q)?
        }
    };
    let rpy = se3::rpy_from_rotation(&pose.rotation);
    let quaternion = UnitQuaternion::from_rotation_matrix(&pose.rotation);
    let quaternion_vector = quaternion.scaled_axis();
    let [x, y, z, w] = [quaternion.i, quaternion.j, quaternion.k, quaternion.w];
    output::remark(&noted.notes);
    let json = || Ok(denavit_load::json::fk(&noted, &q, &pose));
    let text = || {
        let list = |numbers: &[String]| numbers.join("  ");
        let mut text = format!("{} → {}\n\n{}\n", chain.base(), chain.tip(), pose_text(&pose, units));
        let xyz: Vec<String> = pose.translation.vector.iter().map(|value| units.length(*value)).collect();
        let rpy: Vec<String> = rpy.iter().map(|value| units.angle(*value)).collect();
        let quaternion: Vec<String> = [x, y, z, w].iter().map(|value| decimal(*value, 9)).collect();
        let _ = writeln!(text, "x y z            {}  {}", list(&xyz), units.length_word());
        let _ = writeln!(text, "roll pitch yaw   {}  {}", list(&rpy), units.angle_word());
        let _ = writeln!(text, "quaternion xyzw  {}", list(&quaternion));
        let vector: Vec<String> = quaternion_vector.iter().map(|value| units.angle(*value)).collect();
        let _ = writeln!(text, "rotation vector  {}  {}", list(&vector), units.angle_word());
        Ok(text)
    };
    delivery.deliver(text, json)?;
    Ok(Status::Same)
}

/// Says which joint values are outside of the limits, and whether they look like degrees.
fn doubts(chain: &Chain, q: &[f64], degrees: bool) {
    let coordinates = || chain.coordinates().iter().zip(q);
    let inside = |coordinate: &Coordinate, value: f64| {
        let (lower, upper) = coordinate.range();
        coordinate.limits.range.is_none() || (lower..=upper).contains(&value)
    };
    let outside = coordinates().filter(|(coordinate, value)| !inside(coordinate, **value));
    let outside: Vec<&str> = outside.map(|(coordinate, _)| coordinate.name.as_str()).collect();
    if !outside.is_empty() {
        output::mention(format!("--q is outside of the limits of {}", outside.join(", ")));
    }
    let angles = || coordinates().filter(|(coordinate, _)| coordinate.quantity == Quantity::Angle);
    let beyond = |coordinate: &Coordinate, value: f64| {
        let (lower, upper) = coordinate.range();
        coordinate.limits.range.is_some() && value.abs() > FAR_OUTSIDE * lower.abs().max(upper.abs())
    };
    let far = angles().any(|(coordinate, value)| value.abs() > MOST_RADIANS || beyond(coordinate, *value));
    let fits = angles().all(|(coordinate, value)| inside(coordinate, value.to_radians()));
    if far && fits && !degrees {
        output::mention("--q is read in radians but looks like degrees; for degrees add --degrees");
    }
}

/// More than two turns from zero, rad: nobody who thinks in radians writes such an angle.
const MOST_RADIANS: f64 = 4.0 * std::f64::consts::PI;

/// A value that is this many times the farther limit is not meant in radians.
const FAR_OUTSIDE: f64 = 1.5;

/// Where the tip is with the effects of a file.
#[cfg(feature = "calibrate")]
fn with_effects(
    file: &str,
    statics: &Statics,
    chain: &Chain,
    given: &GivenArguments,
    q: &[f64],
) -> Result<Pose, Failure> {
    let effects = measured::effects(Some(file), statics)?;
    let given = measured::given(given)?;
    let (model, recorded) = with_given(file, &effects, &given)?;
    taken_at_averages(file, &effects, &given).iter().for_each(output::mention);
    measured::mention(&without_part_in_the_tip(file, &effects));
    Ok(model.fk(chain, &Conditions { reading: q, recorded: recorded.row(0), tip: 0 }))
}

/// Joint values from `0.1,0.2`, `[0.1, 0.2]` or `name=0.1,other=0.2` of a named option, rad and m.
pub fn joint_values(chain: &Chain, option: &str, written: &str, degrees: bool) -> Result<Vec<f64>, Failure> {
    let coordinates = chain.coordinates();
    let list = written.trim();
    let bare = |open, close| list.strip_prefix(open).and_then(|list| list.strip_suffix(close));
    let list = bare('[', ']').or_else(|| bare('(', ')')).unwrap_or(list);
    let words: Vec<&str> = list.split([',', ' ']).map(str::trim).filter(|word| !word.is_empty()).collect();
    let wrong = |message: String| Failure::Argument(format!("{option}: {message}"));
    let names = || coordinates.iter().map(|coordinate| coordinate.name.as_str()).collect::<Vec<_>>().join(", ");
    let by_name = words.iter().any(|word| word.contains('='));
    if !by_name && !words.is_empty() && words.len() != coordinates.len() {
        return Err(wrong(format!(
            "{} values for {} joints; the order is {}",
            words.len(),
            coordinates.len(),
            names()
        )));
    }
    let mut q = vec![0.0; coordinates.len()];
    for (position, word) in words.iter().enumerate() {
        let (index, value) = match word.split_once('=') {
            None if by_name => return Err(wrong(format!("\"{word}\" has no name; name every value or none"))),
            None => (position, *word),
            Some((name, value)) => {
                let found = coordinates.iter().position(|coordinate| coordinate.name == name);
                let index = found.ok_or_else(|| {
                    let near = nearest_name(name, coordinates.iter().map(|coordinate| coordinate.name.as_str()));
                    let fix = near.map_or_else(
                        || format!("the joints are {}", names()),
                        |near| format!("did you mean \"{near}\"?"),
                    );
                    wrong(format!("the chain has no joint \"{name}\"; {fix}"))
                })?;
                (index, value)
            }
        };
        let number = value.parse::<f64>().ok().filter(|number| number.is_finite());
        let number = number.ok_or_else(|| wrong(format!("\"{value}\" is not a finite number")))?;
        let angle = coordinates[index].quantity == Quantity::Angle;
        q[index] = if degrees && angle { number.to_radians() } else { number };
    }
    Ok(q)
}
