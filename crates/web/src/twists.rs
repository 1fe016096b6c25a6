//! One joint's twist moved by hand: which of the six motions of an axis change it, and the resulting D-H numbers.

use crate::answers::{tabled, words};
use crate::question::{Twist, table_options};
use denavit_dh::Motion;
use denavit_load::Loaded;
use denavit_model::nalgebra::{Vector3, Vector6};
use denavit_model::{Chain, Pose, Screw, se3};
use serde_json::{Value, json};

/// A twist that a unit motion changes by less (per rad or per m) does not have this freedom: the change is rounding.
const NO_CHANGE: f64 = 1e-12;

/// The twist before and after, (ω, v) in the base frame, which of the six motions change it, their frame,
/// and the D-H tables before and after, distal, a not negative, as the paper chooses.
///
/// # Errors
/// There is no such joint, or a number is not finite.
///
/// # Source
/// Wu, Crawford, Roberts 2019, section V: S ← Ad(exp η) S keeps kind and pitch; 4 of 6 directions change a revolute or helical
/// axis, 2 of 6 a prismatic one.
pub fn twisted(asked: &Twist) -> Result<Value, String> {
    let source = &asked.source;
    let chain = source.load()?.chain(&source.selection()).map_err(words)?.value;
    let count = chain.joints().len();
    let joint = chain.joints().get(asked.joint).ok_or_else(|| format!("the chain has {count} moving joints"))?;
    if !asked.by.iter().all(|value| value.is_finite()) {
        return Err("six finite numbers are wanted".into());
    }
    let base_from_axis = frame(&chain, asked.joint);
    let about_axis = |motion: &Vector6<f64>| base_from_axis * se3::exp(motion) * base_from_axis.inverse();
    let moved = joint.screw.moved(&about_axis(&Vector6::from(asked.by)));
    let mut screws: Vec<Screw> = chain.joints().iter().map(|joint| joint.screw).collect();
    screws[asked.joint] = moved;
    let after = chain.with_geometry(&screws, *chain.home()).map_err(words)?;
    let options = table_options(Some("distal"), Some("paper"))?;
    let table = |chain: Chain| tabled(&Loaded::Poe(chain), source, &options, &asked.units, "json");
    Ok(json!({
        "name": joint.name,
        "kind": Motion::of(&joint.screw).word(),
        "pitch": joint.screw.pitch().unwrap_or(0.0),
        "before": joint.screw.twist().as_slice(),
        "after": moved.twist().as_slice(),
        "changes": changes(&joint.screw, &base_from_axis),
        "frame": base_from_axis.to_homogeneous().as_slice(),
        "tables": [table(chain.clone())?, table(after)?],
    }))
}

/// Whether a small motion along each of the six directions changes the twist: its part of the bracket \[η, S\].
fn changes(screw: &Screw, base_from_axis: &Pose) -> [bool; 6] {
    let twist = se3::adjoint_times(&base_from_axis.inverse(), &screw.twist());
    let (w, v): (Vector3<f64>, Vector3<f64>) = (twist.fixed_rows::<3>(0).into(), twist.fixed_rows::<3>(3).into());
    std::array::from_fn(|direction| {
        let unit = Vector3::ith(direction % 3, 1.0);
        let changed =
            if direction < 3 { unit.cross(&w).amax().max(unit.cross(&v).amax()) } else { unit.cross(&w).amax() };
        changed > NO_CHANGE
    })
}

/// A frame on a joint's axis, z along it: where the axis is nearest to the arm, or at the joint before it where it is a
/// direction alone.
fn frame(chain: &Chain, joint: usize) -> Pose {
    let screw = &chain.joints()[joint].screw;
    let before = || chain.joints()[..joint].iter().rev().find_map(|joint| joint.screw.line());
    let at = screw.line().or_else(before).map_or_else(Vector3::zeros, |line| line.point.coords);
    se3::pose(se3::least_rotation(&Vector3::z(), &screw.direction()), at)
}
