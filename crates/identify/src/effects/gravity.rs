//! Gravity on an arm: masses from the URDF, or default masses in the arm's shape where it has none.

use crate::arm::RowState;
use crate::effects::link_points::axis_points;
use denavit_model::nalgebra::{Point3, Vector3};
use denavit_model::{Chain, PlacedRobot, Tips};
use std::collections::HashMap;

/// m/s².
const STANDARD_GRAVITY: f64 = 9.806_65;

/// Default mass per metre of arm beyond a link where the URDF has no inertials, kg/m: only ratios matter, since the
/// estimated compliance is proportional to it.
const STAND_IN_DENSITY: f64 = 10.0;

/// A point mass fixed to a link.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PointMass {
    /// The joint that carries it, counted from 0.
    pub joint: usize,
    /// kg.
    pub mass: f64,
    /// Centre, base frame at home, m.
    pub centre: Point3<f64>,
}

/// The masses that gravity acts on.
#[derive(Debug, Clone, PartialEq)]
pub struct Masses {
    /// Point masses; statics needs no inertia tensors.
    pub points: Vec<PointMass>,
    /// Direction and size of gravity in the base frame, m/s².
    pub gravity: Vector3<f64>,
    /// False where the URDF has no inertials and the masses are defaults.
    pub from_inertials: bool,
}

/// The load of joint i in one row: gravity on everything beyond it, base frame.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Load {
    /// N.
    pub force: Vector3<f64>,
    /// N·m about joint i's point, at its current position.
    pub moment: Vector3<f64>,
}

impl Masses {
    /// Masses of the links beyond each joint of the chain, other joints of the tree at zero; gravity is -z of the root.
    ///
    /// Links without `inertial` weigh nothing; if none beyond the first joint has one, [`Masses::stand_in`] is used.
    pub fn of(placed: &PlacedRobot, chain: &Chain, tips: &Tips) -> Self {
        let robot = placed.robot();
        let Some(base) = robot.link_index(chain.base()) else { return Self::stand_in(chain, tips) };
        let base_from_root = placed.pose(base).inverse();
        let in_chain: HashMap<&str, usize> =
            chain.joints().iter().enumerate().map(|(index, joint)| (joint.name.as_str(), index)).collect();
        let mut points = Vec::new();
        let mut open = vec![(base, None)];
        while let Some((link, carried_by)) = open.pop() {
            if let (Some(mass), Some(joint)) = (placed.mass(link).filter(|mass| mass.mass > 0.0), carried_by) {
                points.push(PointMass { joint, mass: mass.mass, centre: base_from_root * mass.centre });
            }
            for index in placed.carried(link) {
                let joint = &robot.joints[*index];
                open.push((joint.child, in_chain.get(joint.name.as_str()).copied().or(carried_by)));
            }
        }
        if points.is_empty() {
            return Self { gravity: base_from_root.rotation * down(), ..Self::stand_in(chain, tips) };
        }
        points.sort_by_key(|point| point.joint);
        Self { points, gravity: base_from_root.rotation * down(), from_inertials: true }
    }

    /// A rod along each link, heavier towards the base as in real arms: mass in proportion to the reach from there on.
    ///
    /// Where the ways to two tips separate, the joints before have the rods of the first.
    pub fn stand_in(chain: &Chain, tips: &Tips) -> Self {
        let mut masses: Vec<PointMass> = Vec::new();
        for tip in tips.all() {
            let points = axis_points(&tip.chain(chain).expect("a part of a chain is a chain"));
            let lengths: Vec<f64> = points.windows(2).map(|pair| (pair[1] - pair[0]).norm()).collect();
            for (own, joint) in tip.on_the_way().enumerate() {
                if masses.iter().all(|known| known.joint != joint) {
                    let beyond: f64 = lengths[own..].iter().sum();
                    let centre = Point3::from((points[own].coords + points[own + 1].coords) * 0.5);
                    masses.push(PointMass { joint, mass: STAND_IN_DENSITY * beyond, centre });
                }
            }
        }
        Self { points: masses, gravity: down(), from_inertials: false }
    }

    /// Loads on every joint in a row, written to `out`.
    ///
    /// `centres`: of the masses, base frame at home, m, as [`Masses::points`] has them or where an actual arm carries them; `points`: one per
    /// joint, base frame at home, m; `carriers`: for each joint the one that carries it; `payload` (kg)
    /// is at the tip's origin, on a joint.
    pub fn loads_into(
        &self,
        centres: &[Point3<f64>],
        points: &[Point3<f64>],
        carriers: &[Option<usize>],
        state: &RowState,
        payload: Option<(usize, f64)>,
        out: &mut Vec<Load>,
    ) {
        out.clear();
        out.resize(state.before.len(), Load::default());
        // About the base origin first: everything from the tip down to joint i.
        let hung = self.points.iter().zip(centres);
        let hung = hung.map(|(point, centre)| (point.joint, point.mass, (state.after[point.joint] * centre).coords));
        let payload = payload.filter(|(_, payload)| *payload != 0.0);
        for (joint, mass, at) in hung.chain(payload.map(|(joint, mass)| (joint, mass, state.tip.translation.vector))) {
            let force = self.gravity * mass;
            out[joint].add(&Load { force, moment: at.cross(&force) });
        }
        // No joint comes before its carrier.
        for joint in (0..out.len()).rev() {
            if let Some(carrier) = carriers[joint] {
                let beyond = out[joint];
                out[carrier].add(&beyond);
            }
        }
        for ((load, before), point) in out.iter_mut().zip(&state.before).zip(points) {
            load.moment -= (before * point).coords.cross(&load.force);
        }
    }
}

impl Load {
    fn add(&mut self, other: &Self) {
        self.force += other.force;
        self.moment += other.moment;
    }
}

fn down() -> Vector3<f64> {
    Vector3::new(0.0, 0.0, -STANDARD_GRAVITY)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arm::Arm;
    use denavit_model::examples;

    #[test]
    fn a_rod_held_level_weighs_half_its_length() {
        let chain = examples::planar_arm();
        let mut masses = Masses::stand_in(&chain, &Tips::only(&chain));
        masses.gravity = Vector3::new(0.0, -STANDARD_GRAVITY, 0.0);
        let mut state = RowState::default();
        Arm::new(&chain, &denavit_measurements::Scene::default()).state_into(&[0.0, 0.0], 0, None, &mut state);
        let points = axis_points(&chain);
        let centres: Vec<Point3<f64>> = masses.points.iter().map(|mass| mass.centre).collect();
        let mut loads = Vec::new();
        masses.loads_into(&centres, &points, &[None, Some(0)], &state, Some((1, 2.0)), &mut loads);
        let length = (points[2] - points[1]).norm();
        let mass = STAND_IN_DENSITY * length;
        let expected = -STANDARD_GRAVITY * (mass * length / 2.0 + 2.0 * length);
        assert!((loads[1].moment.z - expected).abs() < 1e-12, "{} {expected}", loads[1].moment.z);
        assert!((loads[1].force.y + STANDARD_GRAVITY * (mass + 2.0)).abs() < 1e-12);
    }

    #[test]
    fn masses_and_link_ends_stand_where_the_chain_has_them() {
        use crate::effects::link_points::link_points;
        use denavit_model::{Reading, urdf};
        // A quarter turn cut off after three digits: a metre farther on, 0.8 mm of difference.
        let text = r#"<robot name="r"><link name="base"/><link name="arm"><inertial><origin xyz="0 1 0"/><mass value="1"/>
            </inertial></link><link name="tip"/>
            <joint name="j" type="continuous"><origin rpy="1.57 0 0"/><axis xyz="0 0 1"/><parent link="base"/>
            <child link="arm"/></joint>
            <joint name="k" type="continuous"><origin xyz="0 1 0"/><axis xyz="0 0 1"/><parent link="arm"/>
            <child link="tip"/></joint></robot>"#;
        let robot = urdf::read("r.urdf", text).unwrap();
        for reading in [Reading::Intended, Reading::AsWritten] {
            let placed = PlacedRobot::new(&robot, reading);
            let chain = placed.chain(None, None).unwrap().value;
            let place = chain.home().translation.vector;
            let (masses, points) = (Masses::of(&placed, &chain, &Tips::only(&chain)), link_points(&placed, &chain));
            assert!((masses.points[0].centre.coords - place).norm() < 1e-15, "{reading:?}");
            assert!((points[1].coords - place).norm() < 1e-15, "{reading:?}");
        }
    }
}
