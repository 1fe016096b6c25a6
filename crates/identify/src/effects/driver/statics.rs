//! The chain and its masses, and the arm's posture with them in a row.

use crate::arm::{AxisBasis, Perturbation, Row, RowState};
use crate::effects::gravity::{Load, Masses, PointMass};
use crate::effects::link_points::{axis_points, link_points, points_of};
use denavit_measurements::RecordedRow;
use denavit_model::nalgebra::{Point3, Vector3};
use denavit_model::{Chain, ChainJoint, PlacedRobot, Pose, Reading, Robot, Screw, Tips, se3};
use std::sync::Arc;

/// An axis within 2.6° of gravity's direction is vertical, one within 2.6° of the horizontal is level: cosine and sine.
const UPRIGHT: f64 = 0.999;
const LEVEL: f64 = 0.045;

/// The arm's posture and its loads.
#[derive(Debug, Clone, Default)]
pub struct Posture {
    /// Motions of the joints.
    pub state: RowState,
    /// Gravity on each joint.
    pub loads: Vec<Load>,
    /// The axis of each joint.
    pub axes: Vec<StandingAxis>,
}

/// A joint's axis in a posture, base frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StandingAxis {
    /// Its direction, of length 1.
    pub along: Vector3<f64>,
    /// From the axis to the reference point of the joint's [`Load`], m.
    pub lever: Vector3<f64>,
}

impl StandingAxis {
    /// The axis of a joint at home; `point`: reference point of its load, m.
    fn at_home(joint: &ChainJoint, point: &Point3<f64>) -> Self {
        let lever = joint.screw.line().map_or_else(Vector3::zeros, |line| point - line.nearest_to(point));
        Self { along: joint.screw.direction().into_inner(), lever }
    }

    /// The same after this motion of the joint's carrier from home.
    fn moved(&self, before: &Pose) -> Self {
        Self { along: before.rotation * self.along, lever: before.rotation * self.lever }
    }
}

/// An arm with its masses, at home: the same for all rows.
#[derive(Debug, Clone, Default)]
pub struct AtHome {
    /// Positions of its masses, base frame, m; see [`Statics::centres`].
    centres: Vec<Point3<f64>>,
    axes: Vec<StandingAxis>,
}

/// The data of one row that a driver may use.
#[derive(Clone, Copy)]
pub struct Conditions<'a> {
    /// Joint readings in coordinate order, rad or m.
    pub reading: &'a [f64],
    /// The recorded quantities.
    pub recorded: RecordedRow<'a>,
    /// Index in [`Statics::tips`] of the tip that was measured.
    pub tip: usize,
}

impl<'a> Conditions<'a> {
    /// The conditions of a row.
    pub fn of(row: Row<'a>) -> Self {
        Self { reading: row.reading(), recorded: row.recorded(), tip: row.tip() }
    }
}

/// The chain and its masses: what drivers are computed with. Of several tips the joints of all, see [`Chain::joined`].
#[derive(Debug, Clone, PartialEq)]
pub struct Statics {
    /// The nominal chain.
    pub chain: Chain,
    /// Its tips.
    pub tips: Arc<Tips>,
    /// The masses that gravity acts on.
    pub masses: Masses,
    /// One point per joint and one for each tip, base frame at home, m: where links begin and end.
    pub points: Vec<Point3<f64>>,
    /// For each joint, the joint that carries it.
    pub(super) carriers: Vec<Option<usize>>,
    /// For each joint, directions across its axis.
    pub(in crate::effects) bases: Vec<AxisBasis>,
}

/// Where a link ends on the way to a tip.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinkEnd {
    /// The twist of [`Perturbation::twists`] that acts there: that of the next joint, or the tip's.
    pub slot: usize,
    /// At home, base frame, m.
    pub point: Point3<f64>,
}

impl Statics {
    /// From these parts; `points`: one per joint and one for each tip.
    pub(in crate::effects) fn new(chain: Chain, tips: Arc<Tips>, masses: Masses, points: Vec<Point3<f64>>) -> Self {
        let carriers = tips.carriers();
        let bases = chain.joints().iter().map(|joint| AxisBasis::of(&joint.screw)).collect();
        Self { chain, tips, masses, points, carriers, bases }
    }

    /// For a chain of this robot, its angles as intended.
    pub fn of(robot: &Robot, chain: &Chain) -> Self {
        Self::placed(&PlacedRobot::new(robot, Reading::Intended), chain)
    }

    /// For a chain of this robot, its angles read as for the chain.
    pub fn placed(robot: &PlacedRobot, chain: &Chain) -> Self {
        Self::placed_tips(robot, chain, &Arc::new(Tips::only(chain)))
    }

    /// For the joints of several tips of this robot, angles read as for them.
    pub fn placed_tips(robot: &PlacedRobot, chain: &Chain, tips: &Arc<Tips>) -> Self {
        let masses = Masses::of(robot, chain, tips);
        let points = points_of(chain, tips, |chain| link_points(robot, chain));
        Self::new(chain.clone(), tips.clone(), masses, points)
    }

    /// For a chain without a tree: default masses, links run from axis to axis.
    pub fn of_chain(chain: &Chain) -> Self {
        Self::of_tips(chain, &Arc::new(Tips::only(chain)))
    }

    /// The same for the joints of several tips.
    pub fn of_tips(chain: &Chain, tips: &Arc<Tips>) -> Self {
        let (masses, points) = (Masses::stand_in(chain, tips), points_of(chain, tips, axis_points));
        Self::new(chain.clone(), tips.clone(), masses, points)
    }

    /// The joint that carries a joint; none where it is on the base.
    pub fn carrier(&self, joint: usize) -> Option<usize> {
        self.carriers[joint]
    }

    /// The joints on the way to a tip, base to tip.
    pub fn on_the_way(&self, tip: usize) -> impl Iterator<Item = usize> + '_ {
        self.tips[tip].on_the_way()
    }

    /// Where a joint's link ends on the way to a tip; none where the joint is not on it.
    pub fn link_end(&self, joint: usize, tip: usize) -> Option<LinkEnd> {
        let joints = self.chain.joints().len();
        self.tips[tip].joints[joint].then(|| match self.on_the_way(tip).find(|&other| other > joint) {
            Some(next) => LinkEnd { slot: next, point: self.points[next] },
            None => LinkEnd { slot: joints, point: self.points[joints + tip] },
        })
    }

    /// The joint itself and those that it carries, at most `most`.
    pub(in crate::effects) fn carried(&self, joint: usize, most: usize) -> impl Iterator<Item = usize> + '_ {
        (joint..self.chain.joints().len()).filter(move |&other| self.tips.carries(joint, other)).take(most)
    }

    /// The posture of an arm with these joints in one row, deflected by a perturbation where one is known: with the axes of `joints`, the actual
    /// ones where known. Gravity has the drawing's direction.
    ///
    /// Joints that are not on the way to the row's tip are at their readings: what they carry loads the joints before them.
    pub fn posture(
        &self,
        joints: &[ChainJoint],
        conditions: &Conditions<'_>,
        perturbation: Option<&Perturbation>,
    ) -> Posture {
        let (mut motions, mut posture) = (Vec::new(), Posture::default());
        motions_into(joints, conditions.reading, &mut motions);
        self.posture_into(&self.at_home(joints), &motions, conditions, perturbation, &mut posture);
        posture
    }

    /// An arm with these joints and its masses.
    pub fn at_home(&self, joints: &[ChainJoint]) -> AtHome {
        let axes = joints.iter().zip(&self.points).map(|(joint, point)| StandingAxis::at_home(joint, point));
        AtHome { centres: self.centres(joints), axes: axes.collect() }
    }

    /// The posture of an arm whose joints make these motions ([`motions_into`]), written to `out`.
    pub fn posture_into(
        &self,
        arm: &AtHome,
        motions: &[Pose],
        conditions: &Conditions<'_>,
        perturbation: Option<&Perturbation>,
        Posture { state, loads, axes }: &mut Posture,
    ) {
        state.before.clear();
        state.after.clear();
        let tip = &self.tips[conditions.tip];
        let given_way = |reached: &mut Pose, slot: usize| {
            // Most joints have no deflection.
            let by = perturbation.map(|perturbation| &perturbation.twists[slot]).filter(|by| by.amax() > 0.0);
            if let Some(by) = by {
                *reached *= se3::exp(by);
            }
        };
        let mut last = None;
        for (index, motion) in motions.iter().enumerate() {
            let mut reached = self.carriers[index].map_or_else(Pose::identity, |carrier| state.after[carrier]);
            if tip.joints[index] {
                last = Some(index);
                given_way(&mut reached, index);
            }
            state.before.push(reached);
            state.after.push(reached * motion);
        }
        let mut reached = last.map_or_else(Pose::identity, |last| state.after[last]);
        given_way(&mut reached, motions.len());
        state.tip = reached * tip.home;
        let payload = last.map(|joint| (joint, conditions.recorded.payload()));
        self.masses.loads_into(&arm.centres, &self.points, &self.carriers, state, payload, loads);
        axes.clear();
        axes.extend(arm.axes.iter().zip(&state.before).map(|(axis, before)| axis.moved(before)));
    }

    /// The same with default masses, scaled to this total, kg.
    #[must_use]
    pub fn of_total(&self, total: f64) -> Self {
        let mut scaled = self.clone();
        let points = &mut scaled.masses.points;
        let sum: f64 = points.iter().map(|point| point.mass).sum();
        if !self.masses.from_inertials && sum > 0.0 {
            for point in points.iter_mut() {
                point.mass *= total / sum;
            }
        }
        scaled
    }

    /// Loads every joint of a posture with these masses instead of the links'; `payload`: with a row's payload.
    ///
    /// `centres`: of the masses, base frame at home, m.
    pub fn load_with(
        &self,
        masses: &Masses,
        centres: &[Point3<f64>],
        payload: Option<&Conditions<'_>>,
        posture: &mut Posture,
    ) {
        let last = |conditions: &Conditions<'_>| self.on_the_way(conditions.tip).last();
        let payload = payload.and_then(|row| last(row).map(|joint| (joint, row.recorded.payload())));
        let Posture { state, loads, .. } = posture;
        masses.loads_into(centres, &self.points, &self.carriers, state, payload, loads);
    }

    /// Positions of the masses of an arm with these joints, base frame at home, m: each link moves with its joint's axis, by the smallest
    /// motion from the drawn to the actual axis. The link's rotation about the axis is as drawn.
    pub fn centres(&self, joints: &[ChainJoint]) -> Vec<Point3<f64>> {
        let carried = |mass: &PointMass| {
            let (drawn, actual) = (&self.chain.joints()[mass.joint].screw, &joints[mass.joint].screw);
            if drawn == actual {
                return mass.centre;
            }
            let turn = se3::least_rotation(&drawn.direction(), &actual.direction());
            let point = &self.points[mass.joint];
            let on = |screw: &Screw| screw.line().map_or(*point, |line| line.nearest_to(point));
            on(actual) + turn * (mass.centre - on(drawn))
        };
        self.masses.points.iter().map(carried).collect()
    }

    /// Whether gravity may load a joint: not one that turns about a vertical axis, or slides along a level one, whatever the joints before it
    /// read. The small torque (or force) due to the tilt of a mounted base adds no information beyond geometry.
    pub fn feels_gravity(&self, joint: usize) -> bool {
        let down = self.masses.gravity.normalize();
        let along_gravity = |joint: &ChainJoint| joint.screw.direction().dot(&down).abs();
        let turns = |joint: &ChainJoint| !matches!(joint.screw, Screw::Prismatic(_));
        let upright = |joint: &ChainJoint| along_gravity(joint) > UPRIGHT;
        let joints = self.chain.joints();
        let before = (0..joint).filter(|&other| self.tips.carries(other, joint)).map(|other| &joints[other]);
        let stays = before.filter(|before| turns(before)).all(upright);
        let own = &joints[joint];
        let unloaded = if turns(own) { upright(own) } else { along_gravity(own) < LEVEL };
        !(stays && unloaded)
    }
}

/// The motion of each joint to its reading, written to `out`.
pub fn motions_into(joints: &[ChainJoint], reading: &[f64], out: &mut Vec<Pose>) {
    out.clear();
    out.extend(joints.iter().map(|joint| joint.screw.motion(joint.value(reading))));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arm::{Arm, AxisBasis};
    use denavit_model::nalgebra::Unit;
    use denavit_model::{AxisLine, Coordinate, Quantity, examples};

    #[test]
    fn masses_stay_as_far_from_their_axes_as_they_are_drawn() {
        for chain in examples::all() {
            let statics = Statics::of_chain(&chain);
            let drawn: Vec<Point3<f64>> = statics.masses.points.iter().map(|mass| mass.centre).collect();
            assert_eq!(statics.centres(chain.joints()), drawn);
            let mut arm = Arm::new(&chain, &denavit_measurements::Scene::default());
            for (index, joint) in chain.joints().iter().enumerate() {
                let moved = if joint.screw.line().is_some() { [0.02, -0.03] } else { [0.0; 2] };
                arm.change_axis(index, &AxisBasis::of(&joint.screw), [0.02, -0.01], moved, 0.0);
            }
            let turning = statics.masses.points.iter().zip(statics.centres(&arm.joints));
            for (mass, centre) in turning.filter(|(mass, _)| chain.joints()[mass.joint].screw.line().is_some()) {
                let away =
                    |screw: &Screw, point: &Point3<f64>| (screw.line().unwrap().nearest_to(point) - point).norm();
                let drawn = away(&chain.joints()[mass.joint].screw, &mass.centre);
                let actual = away(&arm.joints[mass.joint].screw, &centre);
                assert!((drawn - actual).abs() < 1e-12 && centre != mass.centre, "{}: {drawn} {actual}", chain.name());
            }
        }
    }

    #[test]
    fn a_level_slide_feels_no_gravity_until_a_joint_before_it_tilts_it() {
        let slide = |direction: [f64; 3]| Screw::Prismatic(Unit::new_normalize(Vector3::from(direction)));
        let turn = |direction: [f64; 3]| {
            let direction = Unit::new_normalize(Vector3::from(direction));
            Screw::Revolute(AxisLine { direction, point: Point3::origin() })
        };
        let feels = |screws: &[Screw]| Statics::of_chain(&chain_of(screws)).feels_gravity(screws.len() - 1);
        let (x, z) = ([1.0, 0.0, 0.0], [0.0, 0.0, 1.0]);
        assert!(!feels(&[slide(x)]) && !feels(&[slide([1.0, 0.0, 0.02])]));
        assert!(feels(&[slide(z)]) && feels(&[slide([1.0, 0.0, 0.1])]));
        assert!(!feels(&[turn(z), slide(x)]) && feels(&[turn(x), slide(x)]));
        assert!(!feels(&[slide(x), turn(z)]) && feels(&[slide(x), turn(x)]));
    }

    fn chain_of(screws: &[Screw]) -> Chain {
        let numbered = || screws.iter().enumerate().map(|(index, screw)| (format!("joint_{index}"), screw));
        let quantity = |screw: &Screw| match screw {
            Screw::Prismatic(_) => Quantity::Length,
            Screw::Revolute(_) | Screw::Helical { .. } => Quantity::Angle,
        };
        let coordinates = numbered().map(|(name, screw)| Coordinate::unlimited(name, quantity(screw))).collect();
        let joint = |(coordinate, (name, screw))| ChainJoint { name, screw, coordinate, scale: 1.0, offset: 0.0 };
        let joints = numbered().map(|(name, screw)| (name, *screw)).enumerate().map(joint).collect();
        Chain::new(("slides", "base", "tip"), coordinates, joints, Pose::identity()).unwrap()
    }
}
