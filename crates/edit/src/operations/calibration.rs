//! Puts a manufacturer's calibration of one arm into the joint origins of a URDF.
//!
//! The file gives a chain of screw axes in its own frames. If its base and tip are links of the robot, it is used
//! unchanged. A manufacturer's list of joint origins starts at the link that carries its first joint and ends at the link
//! that its last joint carries. A D-H table has its own base, tip, zeros and senses; they follow from matching the *nominal*
//! table with the URDF: robot(q) = B · table(sense · q + zero) · E. The calibrated robot is then
//! B · actual(sense · q + zero) · E.
//!
//! Only joint origins change: each link turns by the angle between its nominal and its real axis, and moves to the nearest
//! point of the real axis, so that meshes and frames stay as closely as possible in place.

use crate::Change;
use crate::claim::{Claim, Compared};
use crate::error::EditError;
use crate::tally::Tally;
use denavit_dh::matching::{VendorTable, Verdict, match_table};
use denavit_dh::{Convention, Table};
use denavit_export::urdf::text::{Edits, Nodes, Numbers, joint_origin, parse};
use denavit_export::urdf::with_chain;
use denavit_model::robot::{JointKind, Robot, SourceText};
use denavit_model::se3::Pose;
use denavit_model::tree::Reading;
use denavit_model::{Chain, ChainJoint, PlacedRobot, Screw, se3};

/// A calibration that moves a link by more than this many times the robot's size belongs to another robot.
const PLAUSIBLE: f64 = 0.05;

/// A manufacturer's calibration of one arm.
#[derive(Debug, Clone, PartialEq)]
pub enum Actual {
    /// A chain of screw axes.
    Chain {
        /// The calibrated arm.
        chain: Box<Chain>,
        /// How its frames relate to the robot's.
        frames: Frames,
    },
    /// The calibrated joint origins of the robot, by joint index.
    Origins(Vec<(usize, Numbers)>),
}

/// How the frames of a file relate to those of a robot.
#[derive(Debug, Clone, PartialEq)]
pub enum Frames {
    /// Base and tip are links of the robot, or the file is a manufacturer's list of joint origins.
    Own,
    /// As this nominal table of the same manufacturer matches the URDF.
    AsNominal(Box<Table>, Convention),
}

/// # Errors
/// Joints that are not in the robot, a nominal table that does not match the URDF, or a chain that URDF cannot express.
pub(crate) fn set(robot: &Robot, srdf: Option<&SourceText>, file: &str, actual: &Actual) -> Result<Change, EditError> {
    match actual {
        Actual::Chain { chain, frames } => set_chain(robot, srdf, file, (chain, frames)),
        Actual::Origins(origins) => set_origins(robot, srdf, file, origins),
    }
}

/// Sets calibrated joint origins; their children move along.
fn set_origins(
    robot: &Robot,
    srdf: Option<&SourceText>,
    file: &str,
    origins: &[(usize, Numbers)],
) -> Result<Change, EditError> {
    let size = crate::proof::motion::size(robot);
    let document = parse(robot)?;
    let nodes = Nodes::of(robot, &document)?;
    let mut edits = Edits::default();
    for (index, numbers) in origins {
        let (turned, moved) = se3::difference(&robot.joints[*index].origin.pose(), &numbers.pose());
        if moved > PLAUSIBLE * size || turned > PLAUSIBLE {
            return Err(EditError::Words(format!(
                "{file}: it would move the origin of joint \"{}\" by {:.0} mm and {:.1}°: this calibration is for \
                 another robot",
                robot.joints[*index].name,
                1e3 * moved,
                turned.to_degrees()
            )));
        }
        joint_origin(&robot.source, &mut edits, nodes.joint(*index), numbers);
    }
    let mut tally = Tally::default();
    tally.say(format!("joint origins set from {file}: {}", origins.len()));
    let claim =
        Claim { compared: Compared::No, moves: Some(2.0 * PLAUSIBLE * size), foreign: true, ..Claim::same(robot) };
    Ok(Change::of(edits.apply(&robot.source)?, srdf, claim, tally, Vec::new()))
}

/// Sets a chain's axes, keeping the frames of the robot as closely as possible.
fn set_chain(
    robot: &Robot,
    srdf: Option<&SourceText>,
    file: &str,
    (chain, frames): (&Chain, &Frames),
) -> Result<Change, EditError> {
    let wrong = |what: String| EditError::Words(format!("{file}: {what}"));
    let joints = joints(robot, chain).map_err(wrong)?;
    let (base, tip) = match robot.chain(Some(chain.base()), Some(chain.tip()), Reading::AsWritten) {
        Ok(own)
            if *frames == Frames::Own
                && bases(robot, robot.joints[joints[0]].parent)
                    .iter()
                    .any(|base| robot.links[*base].name == own.value.base())
                && is_plausible(&own.value, chain) =>
        {
            (chain.base().to_owned(), chain.tip().to_owned())
        }
        // A maker's names may be those of other links of the robot.
        _ => ends(robot, &joints, chain, frames),
    };
    let drawn = robot
        .chain(Some(&base), Some(&tip), Reading::AsWritten)
        .map_err(|error| EditError::Words(format!("{file}: {error}")))?
        .value;
    if drawn.joints().len() != chain.joints().len() {
        let (has, own) = (chain.joints().len(), drawn.joints().len());
        return Err(wrong(format!("it has {has} joints, but the robot has {own} from \"{base}\" to \"{tip}\"")));
    }
    let (screws, home) = match frames {
        Frames::Own => {
            let pairs = chain.joints().iter().zip(drawn.joints());
            (pairs.map(|(joint, of)| (joint.screw, joint.offset, of)).collect::<Vec<_>>(), *chain.home())
        }
        Frames::AsNominal(table, convention) => laid(&drawn, chain, (table, *convention)).map_err(wrong)?,
    };
    let joints = screws.into_iter().map(|(screw, offset, of)| ChainJoint { screw, offset, ..of.clone() }).collect();
    let calibrated = Chain::new((drawn.name(), base, tip), drawn.coordinates().to_vec(), joints, home)
        .map_err(|error| EditError::Words(format!("{file}: {error}")))?;
    let moved =
        (calibrated.fk(&zeros(&calibrated)).translation.vector - drawn.fk(&zeros(&drawn)).translation.vector).norm();
    if moved > PLAUSIBLE * drawn.size() {
        return Err(wrong(format!(
            "at joint values 0 it would move \"{}\" by {:.0} mm: this calibration is for another robot, or is \
             rounded; a UR calibration needs every digit, because lengths of hundreds of metres cancel in it",
            calibrated.tip(),
            1e3 * moved
        )));
    }
    let made = with_chain(robot, &calibrated, Reading::AsWritten)?;
    let mut tally = Tally::default();
    tally.say(format!("{} joint origins set from {file}", calibrated.joints().len()));
    let claim = Claim {
        compared: Compared::No,
        moves: Some(2.0 * PLAUSIBLE * drawn.size()),
        foreign: true,
        seen_from: calibrated.base().to_owned(),
        ..Claim::same(robot)
    };
    let notes = made.notes.iter().map(ToString::to_string).collect();
    Ok(Change::of(made.value, srdf, claim, tally, notes))
}

/// The robot's joints for those of the chain: of the same names, or those of the default chain in order.
fn joints(robot: &Robot, chain: &Chain) -> Result<Vec<usize>, String> {
    let named: Option<Vec<usize>> = chain.joints().iter().map(|joint| robot.joint_index(&joint.name)).collect();
    if let Some(named) = named.filter(|named| !named.is_empty()) {
        return Ok(named);
    }
    let default = robot.default_chain();
    let own: Option<Vec<usize>> = default.coordinates.iter().map(|name| robot.joint_index(name)).collect();
    let own = own.unwrap_or_default();
    let moving = own.iter().filter(|joint| robot.joints[**joint].kind != JointKind::Fixed).count();
    if moving != chain.joints().len() || own.is_empty() {
        let names: Vec<&str> = chain.joints().iter().map(|joint| joint.name.as_str()).collect();
        return Err(format!(
            "its joints ({}) are not the robot's, and the robot's chain has {moving} joints; rename them in the file",
            names.join(", ")
        ));
    }
    Ok(own)
}

/// Whether the displacement of the tip from its nominal pose is plausible for a calibration.
fn is_plausible(drawn: &Chain, actual: &Chain) -> bool {
    if drawn.joints().len() != actual.joints().len() {
        return false;
    }
    let (turned, moved) = se3::difference(&drawn.fk(&zeros(drawn)), &actual.fk(&zeros(actual)));
    moved <= PLAUSIBLE * drawn.size() && turned <= 4.0 * PLAUSIBLE
}

fn zeros(chain: &Chain) -> Vec<f64> {
    vec![0.0; chain.coordinates().len()]
}

/// A link and those that carry it rigidly, towards the root.
fn bases(robot: &Robot, first: usize) -> Vec<usize> {
    let carriers = robot.carriers();
    let mut bases = vec![first];
    while let Some(joint) = carriers[bases[bases.len() - 1]].filter(|joint| !robot.joints[*joint].kind.moves()) {
        bases.push(robot.joints[joint].parent);
    }
    bases
}

/// The links for base and tip of the file: of those on the first joint's carrier, towards the root, and those that the
/// last joint carries, the pair with the closest nominal pose. A table matched with the robot needs no such guess.
fn ends(robot: &Robot, joints: &[usize], chain: &Chain, frames: &Frames) -> (String, String) {
    let placed = PlacedRobot::new(robot, Reading::AsWritten);
    let (first, last) = (robot.joints[joints[0]].parent, robot.joints[joints[joints.len() - 1]].child);
    let name = |link: usize| robot.links[link].name.clone();
    if *frames != Frames::Own {
        return (name(first), name(last));
    }
    let bases = bases(robot, first);
    let tips = (0..robot.links.len()).filter(|link| placed.body(*link) == placed.body(last));
    let mut best = (f64::INFINITY, first, last);
    for tip in tips {
        for base in &bases {
            let pose = placed.pose(*base).inverse() * placed.pose(tip);
            let (turned, moved) = se3::difference(&pose, &chain.fk(&zeros(chain)));
            let miss = moved / chain.size() + turned;
            // Of two that are as near the first stays: rounding decides nothing.
            if miss < best.0 - 1e-9 {
                best = (miss, *base, tip);
            }
        }
    }
    (name(best.1), name(best.2))
}

type Laid<'a> = (Vec<(Screw, f64, &'a ChainJoint)>, Pose);

/// The actual table with the frames, zeros and senses by which the nominal one matches the URDF.
fn laid<'a>(drawn: &'a Chain, actual: &Chain, (table, convention): (&Table, Convention)) -> Result<Laid<'a>, String> {
    let vendor = VendorTable::of(table, convention, false);
    let found = match_table(drawn, &vendor).map_err(|error| format!("the nominal table: {error}"))?;
    if found.verdict == Verdict::Mismatch {
        return Err(format!(
            "the nominal table does not match the URDF: it deviates by up to {:.1} mm; give the table that the \
             calibration is added to",
            1e3 * found.placement.position_error
        ));
    }
    let placement = &found.placement;
    let mut screws = Vec::new();
    for ((joint, of), lies) in actual.joints().iter().zip(drawn.joints()).zip(&placement.joints) {
        let sense = lies.sense.sign();
        let screw = joint.screw.moved(&placement.base);
        let screw = if sense < 0.0 { screw.reversed() } else { screw };
        // exp(S (s q + z + o)) = exp(s S (q + s (z + o)))
        screws.push((screw, sense * (lies.zero + joint.offset), of));
    }
    Ok((screws, placement.base * actual.home() * placement.tool))
}
