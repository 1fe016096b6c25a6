//! A gearbox couples two joints of one body.
//!
//! # Source
//! SDF 1.5, `joint/gearbox_ratio`: θ₂ = -ratio · θ₁, where θ₁ is the angle from the reference body to the parent about `axis` and
//! θ₂ that from the reference body to the child about `axis2`.

use crate::frames::FrameId;
use crate::joints::{self, Motion, mimic_element};
use crate::model::{Joint, Model, Reader};
use crate::pose::{number, text_of};
use denavit_model::nalgebra::Vector3;
use std::collections::HashMap;

/// Axes of a gearbox and of the joint that it couples are parallel within this, rad.
const PARALLEL: f64 = 1e-6;

/// For each joint that a gearbox drives: how it follows the other; and the gearboxes that this covers.
pub(crate) fn couplings<'a>(
    model: &Model<'a>,
    motions: &[Option<Motion>],
    reader: &mut Reader<'a>,
) -> (HashMap<usize, String>, Vec<usize>) {
    let (mut found, mut expressed) = (HashMap::new(), Vec::new());
    for (index, (joint, motion)) in model.joints.iter().zip(motions).enumerate() {
        if !matches!(motion, Some(Motion::Gearbox)) {
            continue;
        }
        match coupling(model, motions, reader, joint) {
            Some((driven, leader, mimic)) if !found.contains_key(&driven) => {
                let (driven_name, leader) = (&model.joints[driven].name, &model.joints[leader].name);
                reader.note(joint.part, format!("the gearbox is read as joint \"{driven_name}\" following joint \"{leader}\""));
                found.insert(driven, mimic);
                expressed.push(index);
            }
            _ => reader.note(
                joint.part,
                "no two joints of its reference body turn about the gearbox's axes; it is kept but couples nothing here",
            ),
        }
    }
    (found, expressed)
}

fn coupling<'a>(
    model: &Model<'a>,
    motions: &[Option<Motion>],
    reader: &mut Reader<'a>,
    gearbox: &Joint<'a>,
) -> Option<(usize, usize, String)> {
    let frames = &model.frames;
    let named = text_of(gearbox.part.child("gearbox_reference_body")?.node);
    let reference = frames.find(&format!("{}{named}", model.scopes[gearbox.scope].prefix))?;
    let ratio = match gearbox.part.child("gearbox_ratio") {
        Some(part) => {
            let ratio = number(part.node);
            reader.take(part, ratio)?
        }
        None => 1.0,
    };
    let body = |frame: FrameId| frames.all[frame].body;
    let mut angle = |end: FrameId, tag: &'static str| -> Option<(usize, f64)> {
        let axis = gearbox.part.child(tag).or(gearbox.part.child("axis"))?;
        let xyz = joints::direction(reader, model, gearbox, axis)?;
        let xyz: Vec<f64> = xyz.split(' ').filter_map(|word| word.parse().ok()).collect();
        let wanted = frames.pose(gearbox.frame).rotation * Vector3::new(xyz[0], xyz[1], xyz[2]);
        let (index, joint, sign) = model.joints.iter().enumerate().find_map(|(index, joint)| {
            match (body(joint.parent), body(joint.child)) {
                (parent, child) if parent == body(reference) && child == body(end) => Some((index, joint, 1.0)),
                (parent, child) if child == body(reference) && parent == body(end) => Some((index, joint, -1.0)),
                _ => None,
            }
        })?;
        let Some(Some(Motion::Axes(axes))) = motions.get(index) else { return None };
        let [one] = &axes[..] else { return None };
        if !["revolute", "continuous"].contains(&one.kind) {
            return None;
        }
        let own = frames.pose(joint.frame).rotation * one.direction;
        let same = own.dot(&wanted).signum();
        (denavit_model::se3::angle_between(&(own * same), &wanted) < PARALLEL).then_some((index, sign * same))
    };
    let (leader, of_leader) = angle(gearbox.parent, "axis")?;
    let (driven, of_driven) = angle(gearbox.child, "axis2")?;
    let factor = -ratio * of_leader * of_driven;
    Some((driven, leader, mimic_element(&model.joints[leader].name, factor, 0.0)))
}
