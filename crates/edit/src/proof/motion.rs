//! Checks the motion: every frame of the old robot is where the claim says, at joint values that move all joints.

use super::{Pair, Proof};
use denavit_model::PlacedRobot;
use denavit_model::nalgebra::{Point3, Unit, Vector3};
use denavit_model::robot::{Joint, JointKind, Robot};
use denavit_model::screw::{AxisLine, Screw};
use denavit_model::se3::{self, Pose};
use denavit_model::tree::Reading;

/// Allowed displacement of frames, relative to the robot's size and in rad.
const SAME: f64 = 1e-11;

/// Number of configurations in addition to the one with every joint value 0.
const SAMPLES: usize = 8;

/// Limits may differ by this, relative to the larger of them and 1: rounding of a sum.
const SAME_LIMIT: f64 = 1e-12;

/// The longest way from the root to a link, slides not counted, m; never 0.
pub(crate) fn size(robot: &Robot) -> f64 {
    let placed = PlacedRobot::new(robot, Reading::AsWritten);
    let mut reach = vec![0.0f64; robot.links.len()];
    for link in placed.order() {
        if let Some(joint) = placed.carrier(*link) {
            let step = Vector3::from(robot.joints[joint].origin.xyz).norm();
            reach[*link] = reach[robot.joints[joint].parent] + step;
        }
    }
    let longest = reach.iter().fold(0.0, |a: f64, b| a.max(*b));
    if longest > 0.0 { longest } else { 1.0 }
}

/// The state of a joint in one configuration.
#[derive(Clone, Copy)]
enum Setting {
    Value(f64),
    /// joint_from_child of joints of several values.
    Free(Pose),
}

/// Kinds, limits, speeds and efforts of joints that are kept.
///
/// # Errors
/// What differs.
pub(super) fn check_joints(pair: &Pair) -> Result<(), String> {
    let scale = pair.claim.space.scale;
    for (old, place) in pair.before.joints.iter().zip(&pair.joints) {
        let Some(new) = place.map(|index| &pair.after.joints[index]) else { continue };
        let map = pair.claim.joints[&old.name].map;
        let mirrored = pair.claim.space.mirrored.is_some();
        let same_kind = match (&old.kind, &new.kind) {
            // Reflected, a screw turns the other way as it advances.
            (JointKind::Screw(a), JointKind::Screw(b)) => {
                let factor = if mirrored { -scale } else { scale };
                (a.metres_per_radian() * factor - b.metres_per_radian()).abs()
                    <= SAME_LIMIT * b.metres_per_radian().abs()
            }
            (a, b) => a == b,
        };
        if !same_kind {
            return Err(format!("joint \"{}\" would change its kind", new.name));
        }
        let length = if matches!(old.kind, JointKind::Prismatic) { scale } else { 1.0 };
        let near = |a: f64, b: f64| (a - b).abs() <= SAME_LIMIT * a.abs().max(b.abs()).max(1.0);
        let range = old.limits.range.map(|(lower, upper)| {
            let ends = (map.of(lower) * length, map.of(upper) * length);
            if map.sense < 0.0 { (ends.1, ends.0) } else { ends }
        });
        let same_range = match (range, new.limits.range) {
            (None, None) => true,
            (Some(a), Some(b)) => near(a.0, b.0) && near(a.1, b.1),
            _ => false,
        };
        let same_speed = match (old.limits.velocity, new.limits.velocity) {
            (Some(a), Some(b)) => near(a * length, b),
            (a, b) => a == b,
        };
        if !same_range || !same_speed || old.limits.effort != new.limits.effort {
            return Err(format!("the limits of joint \"{}\" would change", new.name));
        }
        if old.dynamics() != new.dynamics() {
            return Err(format!("damping or friction of joint \"{}\" would change", new.name));
        }
    }
    Ok(())
}

/// # Errors
/// A frame that is not where the claim says.
pub(super) fn check(pair: &Pair) -> Result<Proof, String> {
    let size = size(pair.before) * pair.claim.space.scale;
    let placed = (PlacedRobot::new(pair.before, Reading::AsWritten), PlacedRobot::new(pair.after, Reading::AsWritten));
    let seen_from =
        pair.before.link_index(&pair.claim.seen_from).ok_or("the reference link of the motion is missing")?;
    let (reference, kept) = pair.places[seen_from].ok_or("the reference link of the motion is not kept")?;
    let reference_offset = kept.offset;
    let (mut turned_most, mut moved_most, mut frames) = (0.0f64, 0.0f64, 0);
    for sample in 0..=SAMPLES {
        let settings = settings(pair, &placed.0, sample, size);
        let before = poses(&placed.0, &settings)?;
        let after = poses(&placed.1, &settings_after(pair, &placed, &settings)?)?;
        let back = (before[seen_from].inverse(), (after[reference] * reference_offset).inverse());
        frames = 0;
        for (index, place) in pair.places.iter().enumerate() {
            let Some((at, kept)) = place else { continue };
            let expected = pair.claim.space.pose(&(back.0 * before[index]));
            let found = back.1 * after[*at] * kept.offset;
            let (turned, moved) = se3::difference(&expected, &found);
            frames += 1;
            if turned > SAME || moved > SAME * size.max(expected.translation.vector.norm()) {
                if let Some(allowed) = pair.claim.moves.filter(|allowed| moved <= *allowed) {
                    moved_most = moved_most.max(moved.min(allowed));
                    turned_most = turned_most.max(turned);
                    continue;
                }
                let name = &pair.before.links[index].name;
                return Err(format!("link \"{name}\" would be displaced by {moved:.1e} m and {turned:.1e} rad"));
            }
            moved_most = moved_most.max(moved);
            turned_most = turned_most.max(turned);
        }
    }
    let motion = match (pair.claim.space.mirrored, pair.claim.space.scale, pair.claim.moves) {
        (Some(_), ..) => "moves as the mirror image",
        (None, _, Some(_)) => "moves as intended,",
        (None, scale, None) if scale != 1.0 => "moves as before, scaled,",
        _ => "moves as before",
    };
    Ok(Proof { moved: moved_most, turned: turned_most, samples: SAMPLES + 1, frames, motion })
}

/// A number in -1 … 1 that depends only on joint and sample.
fn spread(name: &str, sample: usize, salt: f64) -> f64 {
    let seed = name.bytes().fold(0.0, |sum, byte| 0.7 * sum + f64::from(byte));
    (seed + 1.7 * sample as f64 + salt).sin()
}

/// Values of joints that are free, in the sample; all 0 in the first.
fn settings(pair: &Pair, placed: &PlacedRobot, sample: usize, size: f64) -> Vec<Setting> {
    let free: Vec<Setting> = pair.before.joints.iter().map(|joint| setting(joint, sample, size)).collect();
    driven(placed, &free)
}

fn setting(joint: &Joint, sample: usize, size: f64) -> Setting {
    let number = |salt: f64| if sample == 0 { 0.0 } else { spread(&joint.name, sample, salt) };
    match joint.kind {
        JointKind::Revolute | JointKind::Continuous | JointKind::Screw(_) => Setting::Value(3.0 * number(0.0)),
        JointKind::Prismatic => Setting::Value(0.3 * size * number(0.0)),
        JointKind::Planar => {
            let axis = joint.axis;
            let slide = Vector3::new(number(1.0), number(2.0), number(3.0)) * size;
            let across = slide - axis.as_ref() * axis.dot(&slide);
            Setting::Free(se3::pose(se3::rotation_about(&axis, 3.0 * number(0.0)), across))
        }
        JointKind::Floating => Setting::Free(se3::pose(
            se3::rotation_from_rpy([3.0 * number(4.0), number(5.0), 3.0 * number(6.0)]),
            Vector3::new(number(1.0), number(2.0), number(3.0)) * size,
        )),
        _ => Setting::Value(0.0),
    }
}

/// With mimic joints at the values from their drivers.
fn driven(placed: &PlacedRobot, free: &[Setting]) -> Vec<Setting> {
    let value = |index: usize| match placed.drive(index) {
        Ok(drive) => match drive.driver.map(|driver| free[driver]) {
            Some(Setting::Value(value)) => Setting::Value(drive.scale * value + drive.offset),
            Some(free) => free,
            None => Setting::Value(drive.offset),
        },
        // It follows nothing that is there: any value is as good.
        Err(_) => free[index],
    };
    (0..free.len()).map(value).collect()
}

fn settings_after(
    pair: &Pair,
    (before, after): &(PlacedRobot, PlacedRobot),
    settings: &[Setting],
) -> Result<Vec<Setting>, String> {
    let mut free: Vec<Setting> = pair.after.joints.iter().map(|joint| setting(joint, 0, 1.0)).collect();
    for (index, place) in pair.joints.iter().enumerate() {
        let Some(at) = *place else { continue };
        let (old, new) = (&pair.before.joints[index], &pair.after.joints[at]);
        let kept = &pair.claim.joints[&old.name];
        free[at] = match settings[index] {
            Setting::Value(value) => {
                let length = if matches!(old.kind, JointKind::Prismatic) { pair.claim.space.scale } else { 1.0 };
                Setting::Value(kept.map.of(value) * length)
            }
            Setting::Free(motion) if kept.reversed => {
                let forward = before.origin(index).pose() * motion;
                let back = after.origin(at).pose().inverse() * forward.inverse();
                if new.kind == JointKind::Planar && !is_planar(&back, &new.axis) {
                    return Err(format!("joint \"{}\" would move out of its plane", new.name));
                }
                Setting::Free(back)
            }
            Setting::Free(motion) => Setting::Free(pair.claim.space.pose(&motion)),
        };
    }
    Ok(driven(after, &free))
}

fn is_planar(motion: &Pose, axis: &Unit<Vector3<f64>>) -> bool {
    let slide = motion.translation.vector;
    let turned = se3::angle_between(&(motion.rotation * axis.as_ref()), axis.as_ref());
    turned <= SAME && slide.dot(axis).abs() <= SAME * (1.0 + slide.norm())
}

/// root_from_link of every link.
fn poses(placed: &PlacedRobot, settings: &[Setting]) -> Result<Vec<Pose>, String> {
    let robot = placed.robot();
    let mut poses = vec![Pose::identity(); robot.links.len()];
    for link in placed.order() {
        let Some(index) = placed.carrier(*link) else { continue };
        let joint = &robot.joints[index];
        let line = AxisLine { direction: joint.axis, point: Point3::origin() };
        let motion = match (&joint.kind, settings[index]) {
            (JointKind::Fixed | JointKind::Unknown(_), _) => Pose::identity(),
            (_, Setting::Free(pose)) => pose,
            (JointKind::Prismatic, Setting::Value(value)) => Screw::Prismatic(joint.axis).motion(value),
            (JointKind::Screw(pitch), Setting::Value(value)) => {
                Screw::Helical { axis: line, pitch: *pitch }.motion(value)
            }
            (_, Setting::Value(value)) => Screw::Revolute(line).motion(value),
        };
        poses[*link] = poses[joint.parent] * placed.origin(index).pose() * motion;
    }
    if poses.iter().any(|pose| !pose.to_homogeneous().iter().all(|number| number.is_finite())) {
        return Err("a frame would have no finite place".into());
    }
    Ok(poses)
}
