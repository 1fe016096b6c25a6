//! A chain put together, joint by joint, along the way from base to tip.

use super::{PLANAR_PARTS, Reading, Step, TreeError};
use crate::chain::{Chain, ChainJoint, Coordinate, Limits, Quantity};
use crate::notes::{Note, Noted, Place};
use crate::placed::PlacedRobot;
use crate::robot::{Joint, JointKind, Robot};
use crate::screw::{AxisLine, Pitch, Screw};
use crate::se3::{self, Pose};
use nalgebra::{Point3, Unit, Vector3};
use std::collections::HashMap;

/// Neighbouring turn and slide axes closer to parallel than this (rad) make a screw; above it they are two joints.
const SAME_AXIS: f64 = 1e-9;

/// A literal read as intended: enough to say later how far it moves the tip.
struct ReadLiteral {
    place: Place,
    written: String,
    read_as: String,
    /// rad.
    change: f64,
    /// Length of the path up to this literal, m.
    reach_before: f64,
}

/// A chain under construction.
pub(super) struct Assembly<'a> {
    robot: &'a Robot,
    placed: &'a PlacedRobot<'a>,
    base_from_here: Pose,
    coordinates: Vec<Coordinate>,
    drivers: HashMap<(usize, &'static str), usize>,
    joints: Vec<ChainJoint>,
    /// Sum of the lengths walked and the slides passed, m.
    reach: f64,
    literals: Vec<ReadLiteral>,
    notes: Vec<Note>,
}

impl<'a> Assembly<'a> {
    pub(super) fn new(placed: &'a PlacedRobot<'a>) -> Self {
        Self {
            robot: placed.robot(),
            placed,
            base_from_here: Pose::identity(),
            coordinates: Vec::new(),
            drivers: HashMap::new(),
            joints: Vec::new(),
            reach: 0.0,
            literals: Vec::new(),
            notes: Vec::new(),
        }
    }

    pub(super) fn walk(mut self, base: usize, tip: usize, steps: &[Step]) -> Result<Noted<Chain>, TreeError> {
        for step in steps {
            let joint = &self.robot.joints[step.joint];
            let length = Vector3::from(joint.origin.xyz).norm();
            if step.upwards {
                self.moving(step.joint, true)?;
                let pose = self.origin(step.joint);
                self.reach += length;
                self.base_from_here *= pose.inverse();
            } else {
                self.reach += length;
                let pose = self.origin(step.joint);
                self.base_from_here *= pose;
                self.moving(step.joint, false)?;
            }
        }
        let robot = self.robot;
        self.join_screws();
        let names = (robot.name.as_str(), robot.links[base].name.as_str(), robot.links[tip].name.as_str());
        let chain = Chain::new(names, self.coordinates, self.joints, self.base_from_here)
            .and_then(Chain::within_reach)
            .map_err(|source| TreeError::Chain { file: robot.source.file.clone(), source })?;
        let mut notes = self.notes;
        notes.extend(self.literals.into_iter().map(|literal| Note::IntendedAngle {
            tip_moves: literal.change.abs() * (self.reach - literal.reach_before),
            place: literal.place,
            written: literal.written,
            read_as: literal.read_as,
            change: literal.change,
        }));
        Ok(Noted { value: chain, notes })
    }

    /// parent_from_child of a joint; adds a note for what was read differently from what is written.
    fn origin(&mut self, joint: usize) -> Pose {
        let read = self.placed.origin(joint);
        for (written, angle) in &read.reread {
            let place = self.robot.joint_place(joint);
            let (written, read_as, change) = (written.clone(), angle.read_as.clone(), angle.change);
            self.literals.push(ReadLiteral { place, written, read_as, change, reach_before: self.reach });
        }
        read.pose()
    }

    fn moving(&mut self, index: usize, upwards: bool) -> Result<(), TreeError> {
        let joint = &self.robot.joints[index];
        self.axis(index);
        let Some(screw) = joint.kind.screw(joint, self.placed.reading()) else {
            return match joint.kind {
                JointKind::Fixed => Ok(()),
                JointKind::Planar => {
                    self.planar(index, joint, upwards);
                    Ok(())
                }
                _ => {
                    let name = |link: usize| self.robot.links[link].name.clone();
                    let (below, above) = (name(joint.child), name(joint.parent));
                    let word = joint.kind.word().to_owned();
                    Err(TreeError::Unsupported { place: self.robot.joint_place(index), word, below, above })
                }
            };
        };
        let drive = self.placed.drive(index)?;
        let sign = if upwards { -1.0 } else { 1.0 };
        let Some(driver) = drive.driver else {
            // It follows a joint that never moves: a fixed displacement.
            self.base_from_here *= screw.motion(sign * drive.offset);
            return Ok(());
        };
        let coordinate = self.coordinate(driver, "");
        self.push(joint.name.clone(), screw, coordinate, sign * drive.scale, sign * drive.offset);
        Ok(())
    }

    /// Adds a note for an axis that is read as a direction other than the written one. The joint's motion turns by at most twice
    /// the angle between the two.
    fn axis(&mut self, index: usize) {
        let joint = &self.robot.joints[index];
        let meant = joint.axis_meant.as_ref().filter(|_| joint.kind.moves() && joint.kind != JointKind::Floating);
        if let (Some(meant), Reading::Intended) = (meant, self.placed.reading()) {
            self.literals.push(ReadLiteral {
                place: self.robot.joint_place(index),
                written: format!("axis {}", meant.written),
                read_as: meant.read_as.clone(),
                change: 2.0 * meant.turned,
                reach_before: self.reach,
            });
        }
    }

    fn push(&mut self, name: String, screw: Screw, coordinate: usize, scale: f64, offset: f64) {
        let screw = screw.moved(&self.base_from_here);
        let joint = ChainJoint { name, screw, coordinate, scale, offset };
        let (lower, upper) = self.coordinates[coordinate].range();
        let value = |q: f64| (scale * q + offset).abs();
        self.reach += screw.pitch().unwrap_or(1.0).abs() * value(lower).max(value(upper));
        self.joints.push(joint);
    }

    fn planar(&mut self, index: usize, joint: &Joint, upwards: bool) {
        let normal = joint.axis_as(self.placed.reading());
        // The plane's own x and y: those of the frame when the normal is z, else turned with it.
        let across = if normal.x.abs() < 0.9 { Vector3::x() } else { Vector3::y() };
        let x = Unit::new_normalize(across - normal.as_ref() * normal.dot(&across));
        let y = Unit::new_normalize(normal.cross(&x));
        let line = AxisLine { direction: normal, point: Point3::origin() };
        let mut parts = [Screw::Prismatic(x), Screw::Prismatic(y), Screw::Revolute(line)]
            .into_iter()
            .zip(PLANAR_PARTS)
            .collect::<Vec<_>>();
        let sign = if upwards { -1.0 } else { 1.0 };
        if upwards {
            parts.reverse();
        }
        for (screw, part) in parts {
            let coordinate = self.coordinate(index, part);
            self.push(format!("{}{part}", joint.name), screw, coordinate, sign, 0.0);
        }
        let place = self.robot.joint_place(index);
        let what = format!("planar joint: becomes \"{0}_x\", \"{0}_y\" (m) and \"{0}_yaw\" (rad)", joint.name);
        self.notes.push(Note::Split { place, what });
    }

    /// Index of the coordinate of a joint's (part's) own value.
    fn coordinate(&mut self, driver: usize, part: &'static str) -> usize {
        if let Some(found) = self.drivers.get(&(driver, part)) {
            return *found;
        }
        let joint = &self.robot.joints[driver];
        let slides = joint.kind == JointKind::Prismatic || ["_x", "_y"].contains(&part);
        let quantity = if slides { Quantity::Length } else { Quantity::Angle };
        let continuous = joint.kind == JointKind::Continuous;
        let limits = if part.is_empty() { joint.limits_in_force() } else { Limits::default() };
        self.drivers.insert((driver, part), self.coordinates.len());
        self.coordinates.push(Coordinate { name: format!("{}{part}", joint.name), quantity, limits, continuous });
        self.coordinates.len() - 1
    }

    /// Makes one helical joint of each turn and slide that share coordinate and axis.
    fn join_screws(&mut self) {
        let mut index = 0;
        while index + 1 < self.joints.len() {
            if let Some((joined, behind)) = joined(&self.joints[index], &self.joints[index + 1]) {
                self.joints[index] = joined;
                self.joints.remove(index + 1);
                for joint in &mut self.joints[index + 1..] {
                    joint.screw = joint.screw.moved(&behind);
                }
                self.base_from_here = behind * self.base_from_here;
            }
            index += 1;
        }
    }
}

/// One helical joint for two neighbours, and the constant motion of what follows them.
fn joined(one: &ChainJoint, other: &ChainJoint) -> Option<(ChainJoint, Pose)> {
    let (turn, line, slide) = match (one.screw, other.screw) {
        (Screw::Revolute(line), Screw::Prismatic(_)) => (one, line, other),
        (Screw::Prismatic(_), Screw::Revolute(line)) => (other, line, one),
        _ => return None,
    };
    let along = slide.screw.direction();
    let apart = line.direction.cross(&along).norm();
    if one.coordinate != other.coordinate || apart > SAME_AXIS {
        return None;
    }
    let sense = line.direction.dot(&along).signum();
    let pitch = Pitch::from_metres_per_radian(sense * slide.scale / turn.scale)?;
    let left_over = sense * slide.offset - pitch.metres_per_radian() * turn.offset;
    let behind = se3::translation(line.direction.as_ref() * left_over);
    Some((ChainJoint { screw: Screw::Helical { axis: line, pitch }, ..turn.clone() }, behind))
}
