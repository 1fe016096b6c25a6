//! A turn and a slide that follow one coordinate along one axis are one screw joint, as URDF has to write it.

use super::{Mechanism, MovingJoint};
use denavit_model::{Pitch, Screw};

/// Neighbouring turn and slide axes closer to parallel than this (rad) make a screw; above it they are two joints.
const SAME_AXIS: f64 = 1e-9;

impl Mechanism {
    /// Whether a joint turns and slides at once.
    pub(crate) fn has_screws(&self) -> bool {
        self.joints.iter().any(|joint| matches!(joint.screw, Some(Screw::Helical { .. })))
    }

    /// Makes one screw joint of each such pair with nothing but a link frame in between.
    pub(crate) fn join_screws(&mut self) {
        let mut hanging: Vec<usize> = self.joints_on().iter().map(Vec::len).collect();
        // For each joint that goes into the one behind it, that one.
        let mut into: Vec<Option<usize>> = vec![None; self.joints.len()];
        for second in 0..self.joints.len() {
            let Some((first, joined)) = self.screw_ending_in(second, &hanging) else { continue };
            let between = std::mem::take(&mut self.bodies[first + 1].frames);
            self.bodies[second + 1].frames.extend(between);
            self.joints[second] = joined;
            hanging[first + 1] = 0;
            into[first] = Some(second);
        }
        if into.iter().all(Option::is_none) {
            return;
        }
        // Body 0 stays; every other body goes with its joint.
        let mut new = vec![0; self.bodies.len()];
        let mut kept = 0;
        for (joint, into) in into.iter().enumerate() {
            if into.is_none() {
                kept += 1;
                new[joint + 1] = kept;
            }
        }
        let body_now = |body: usize| {
            let carrier = body.checked_sub(1).and_then(|joint| into[joint]);
            new[carrier.map_or(body, |joint| joint + 1)]
        };
        for element in &mut self.elements {
            element.body = body_now(element.body);
            for part in &mut element.parts {
                part.body = body_now(part.body);
            }
        }
        for joint in &mut self.joints {
            joint.parent = joint.parent.and_then(|parent| new[parent + 1].checked_sub(1));
        }
        let mut gone = into.iter().map(Option::is_some);
        self.joints.retain(|_| !gone.next().unwrap_or(false));
        let mut gone = std::iter::once(false).chain(into.iter().map(Option::is_some));
        self.bodies.retain(|_| !gone.next().unwrap_or(false));
    }

    /// The joint before `second` that makes a screw with it, and the screw; `hanging`: how many joints are attached to each body.
    fn screw_ending_in(&self, second: usize, hanging: &[usize]) -> Option<(usize, MovingJoint)> {
        let behind = &self.joints[second];
        let first = behind.parent?;
        let before = &self.joints[first];
        let (turn, slide) = match (before.screw?, behind.screw?) {
            (Screw::Revolute(_), Screw::Prismatic(_)) => (before, behind),
            (Screw::Prismatic(_), Screw::Revolute(_)) => (behind, before),
            _ => return None,
        };
        let (line, along) = (*turn.screw?.line()?, slide.screw?.direction());
        let (turns, slides) = (turn.drive?, slide.drive?);
        let body = &self.bodies[first + 1];
        let empty = body.shapes.is_empty() && body.mass.is_none() && body.frames.iter().all(|frame| !frame.leaf);
        let alone = hanging[first + 1] == 1;
        let coupled = turns.coordinate == slides.coordinate && turns.offset == 0.0 && slides.offset == 0.0;
        if !(empty && alone && coupled) || line.direction.cross(&along).norm() > SAME_AXIS {
            return None;
        }
        let pitch = line.direction.dot(&along).signum() * slides.scale / turns.scale;
        let screw = Screw::Helical { axis: line, pitch: Pitch::from_metres_per_radian(pitch)? };
        let owner = if before.mimic.is_none() { before } else { behind };
        let joined = MovingJoint {
            kind: "screw".into(),
            screw: Some(screw),
            parent: before.parent,
            child: behind.child.clone(),
            drive: turn.drive,
            origin: turn.origin,
            ..owner.clone()
        };
        Some((first, joined))
    }
}
