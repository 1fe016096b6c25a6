//! Where an effect acts: the directions in which a carrier can move the arm, its targets or its instrument.
//!
//! A new carrier is a variant of [`Carrier`], its arm in [`Carrier::directions`] and in [`Carrier::place`], and a term
//! that uses it in [`super::candidates`]; the test `every_direction_does_what_its_action_says` then covers it.

use crate::arm::{AlongSight, Perturbation};
use crate::effects::driver::{LinkEnd, Statics};
use denavit_model::nalgebra::{Point3, Vector3, Vector6};
use denavit_model::{Chain, ChainJoint, Screw};
use serde::{Deserialize, Serialize};

/// Where an effect acts. Joints are counted from 0, base to tip.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Carrier {
    /// The value of a joint, rad or m: one direction.
    Joint(usize),
    /// A slide along a turning joint's axis, m: one direction.
    Along(usize),
    /// A tilt of a joint's axis relative to the link before it, rad: two directions.
    AxisBasis(usize),
    /// A shift of a joint's axis across itself, m: two directions.
    Sideways(usize),
    /// The far end of a joint's link, turned (rad) and shifted (m) in the link's own axes: six directions.
    LinkEnd(usize),
    /// The far end of a joint's link, turned about its end point (rad), link's own axes: three directions.
    LinkEndTurn(usize),
    /// The length of one link, m per m: one direction.
    LinkLength(usize),
    /// Every length of the arm, m per m: one direction.
    Lengths,
    /// The base relative to the instrument, three rotations about its origin (rad) and three shifts (m).
    Base,
    /// Turns of the base alone, rad: three directions.
    BaseTurn,
    /// The target on the tip, m: three directions.
    Target,
    /// The anchor of a distance instrument, m: three directions.
    Anchor,
    /// The scale of the instrument, m per m: one direction.
    Scale,
    /// The zero of a distance instrument, m: one direction.
    Reading,
    /// Excess of the range along the line of sight, depending on the target's orientation to the instrument, m: three directions, the
    /// tip's axes.
    ///
    /// An instrument that reads a range and two angles has two centres in a target: where its range ends and where its angles point.
    /// With both fixed to the tip, at t + s for the angles and at t + s + c for the range, the reading is off by s + u (u · c), u the line of
    /// sight. The shift s acts as one of the target itself; the rest is the range's error u · c, first harmonic of the angle of
    /// incidence. A ball of glass (index n) whose silvered shell is δ off the ball's centre has its angles' centre at δ and the
    /// range's at n δ, so c = (n - 1) δ. Windows and prisms have both centres at one depth up to the square of the angle of
    /// incidence.
    Sight,
    /// The zero of an instrument's range, m, such as a wrong prism constant: one direction.
    Range,
    /// Every joint's value at once, rad or m: one direction per joint.
    AllJoints,
}

/// One part of a direction's effect, per unit of its coefficient.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Action {
    /// A twist of [`Perturbation::twists`].
    Twist {
        /// Which twist.
        slot: usize,
        /// `[omega; v]`, rad and m, base frame at home.
        twist: Vector6<f64>,
    },
    /// A shift of the target, tip frame, m.
    Target(Vector3<f64>),
    /// A shift of the anchor, base frame, m.
    Anchor(Vector3<f64>),
    /// The instrument's scale.
    Scale,
    /// The instrument's zero, m.
    Reading,
    /// Excess of the range along the line of sight.
    Sight(AlongSight),
}

impl Action {
    /// Adds `amount` of the action to a perturbation.
    pub fn add_to(&self, amount: f64, perturbation: &mut Perturbation) {
        match self {
            Self::Twist { slot, twist } => perturbation.twists[*slot] += twist * amount,
            Self::Target(shift) => perturbation.target += shift * amount,
            Self::Anchor(shift) => perturbation.anchor += shift * amount,
            Self::Scale => perturbation.scale += amount,
            Self::Reading => perturbation.reading += amount,
            Self::Sight(sight) => perturbation.sight += *sight * amount,
        }
    }
}

/// A turn about a line, as a twist.
fn turn(direction: &Vector3<f64>, point: &Point3<f64>) -> Vector6<f64> {
    let v = point.coords.cross(direction);
    Vector6::new(direction.x, direction.y, direction.z, v.x, v.y, v.z)
}

/// A shift, as a twist.
fn shift(direction: &Vector3<f64>) -> Vector6<f64> {
    Vector6::new(0.0, 0.0, 0.0, direction.x, direction.y, direction.z)
}

impl Carrier {
    /// The directions of the carrier on an arm in rows of a tip: each a sum of actions that share one coefficient. A joint
    /// that is not on the way to the tip has as many, which do nothing.
    ///
    /// Axes are those of `joints`, the actual ones where known. Directions across an axis are those of the nominal one,
    /// carried along, so that a small change of the axis turns them by little.
    pub fn directions(&self, statics: &Statics, joints: &[ChainJoint], tip: usize) -> Vec<Vec<Action>> {
        let (nominal, points) = (statics.chain.joints(), &statics.points);
        let on_the_way = |joint: usize| statics.tips[tip].joints[joint];
        if let Some(joint) = self.joint().filter(|&joint| !on_the_way(joint)) {
            let own = statics.tips.all().iter().position(|tip| tip.joints[joint]);
            return own.map_or_else(Vec::new, |own| vec![Vec::new(); self.directions(statics, joints, own).len()]);
        }
        let across = |i: usize| statics.bases[i].carried(&nominal[i].screw, &joints[i].screw);
        let unit = [Vector3::x(), Vector3::y(), Vector3::z()];
        let first = statics.on_the_way(tip).next().unwrap_or(joints.len());
        let end_of = |i: usize| statics.link_end(i, tip).expect("a joint that is not on the way has been dealt with");
        let twist = |slot: usize, twist: Vector6<f64>| vec![Action::Twist { slot, twist }];
        match *self {
            Self::Joint(i) => vec![twist(i, joints[i].screw.twist())],
            Self::Along(i) => vec![twist(i, shift(&joints[i].screw.direction()))],
            Self::AxisBasis(i) => {
                let across = across(i);
                let centre = joints[i].screw.line().map_or(points[i], |line| line.nearest_to(&points[i]));
                vec![twist(i, turn(&across.a, &centre)), twist(i, turn(&across.b, &centre))]
            }
            Self::Sideways(i) => {
                let across = across(i);
                vec![twist(i, shift(&across.a)), twist(i, shift(&across.b))]
            }
            Self::LinkEnd(i) => {
                let LinkEnd { slot, point } = end_of(i);
                let turns = unit.iter().map(|u| twist(slot, turn(u, &point)));
                turns.chain(unit.iter().map(|u| twist(slot, shift(u)))).collect()
            }
            Self::LinkEndTurn(i) => {
                let LinkEnd { slot, point } = end_of(i);
                unit.iter().map(|u| twist(slot, turn(u, &point))).collect()
            }
            Self::LinkLength(i) => {
                let LinkEnd { slot, point } = end_of(i);
                vec![twist(slot, shift(&(point - points[i])))]
            }
            Self::Lengths => {
                let start = points.get(first).map_or_else(Vector3::zeros, |point| point.coords);
                let links = statics.on_the_way(tip).map(|i| {
                    let LinkEnd { slot, point } = end_of(i);
                    Action::Twist { slot, twist: shift(&(point - points[i])) }
                });
                vec![std::iter::once(Action::Twist { slot: first, twist: shift(&start) }).chain(links).collect()]
            }
            Self::Base => {
                let turns = unit.iter().map(|u| twist(first, turn(u, &Point3::origin())));
                turns.chain(unit.iter().map(|u| twist(first, shift(u)))).collect()
            }
            Self::BaseTurn => unit.iter().map(|u| twist(first, turn(u, &Point3::origin()))).collect(),
            Self::Target => unit.iter().map(|u| vec![Action::Target(*u)]).collect(),
            Self::Anchor => unit.iter().map(|u| vec![Action::Anchor(*u)]).collect(),
            Self::Scale => vec![vec![Action::Scale]],
            Self::Reading => vec![vec![Action::Reading]],
            Self::Sight => unit.iter().map(|u| vec![Action::Sight(AlongSight { turning: *u, steady: 0.0 })]).collect(),
            Self::Range => vec![vec![Action::Sight(AlongSight { turning: Vector3::zeros(), steady: 1.0 })]],
            Self::AllJoints => {
                let moved = |i: usize| if on_the_way(i) { twist(i, joints[i].screw.twist()) } else { Vec::new() };
                (0..joints.len()).map(moved).collect()
            }
        }
    }

    /// The joint at which it acts, where it acts at one.
    pub fn joint(&self) -> Option<usize> {
        match *self {
            Self::Joint(i)
            | Self::Along(i)
            | Self::AxisBasis(i)
            | Self::Sideways(i)
            | Self::LinkEnd(i)
            | Self::LinkEndTurn(i)
            | Self::LinkLength(i) => Some(i),
            _ => None,
        }
    }

    /// Where it acts, as in reports: the joint's name, or `base`, `links`, `target`, `anchor`, `instrument`,
    /// `wire zero`, `all joints`.
    pub fn place(&self, chain: &Chain) -> String {
        match self {
            Self::Lengths => "links".into(),
            Self::Base | Self::BaseTurn => "base".into(),
            Self::Target | Self::Sight | Self::Range => "target".into(),
            Self::Anchor => "anchor".into(),
            Self::Scale => "instrument".into(),
            Self::Reading => "wire zero".into(),
            Self::AllJoints => "all joints".into(),
            Self::Joint(i)
            | Self::Along(i)
            | Self::AxisBasis(i)
            | Self::Sideways(i)
            | Self::LinkEnd(i)
            | Self::LinkEndTurn(i)
            | Self::LinkLength(i) => chain.joints()[*i].name.clone(),
        }
    }

    /// Unit of each direction's coefficient for a dimensionless driver: rad, m, or 1.
    pub fn unit(&self, chain: &Chain, direction: usize) -> &'static str {
        let slides = |joint: usize| matches!(chain.joints()[joint].screw, Screw::Prismatic(_));
        match self {
            Self::Joint(joint) if slides(*joint) => "m",
            Self::AllJoints if slides(direction) => "m",
            Self::Joint(_) | Self::AllJoints | Self::AxisBasis(_) | Self::BaseTurn | Self::LinkEndTurn(_) => "rad",
            Self::LinkEnd(_) | Self::Base if direction < 3 => "rad",
            Self::Along(_)
            | Self::Sideways(_)
            | Self::Target
            | Self::Anchor
            | Self::Reading
            | Self::Sight
            | Self::Range
            | Self::LinkEnd(_)
            | Self::Base => "m",
            Self::LinkLength(_) | Self::Lengths | Self::Scale => "m/m",
        }
    }

    /// Words for each direction, for the names of parameters.
    pub fn direction_name(&self, direction: usize) -> &'static str {
        const SIX: [&str; 6] = ["turn_x", "turn_y", "turn_z", "shift_x", "shift_y", "shift_z"];
        match self {
            Self::AxisBasis(_) => ["tilt_a", "tilt_b"][direction],
            Self::Sideways(_) => ["shift_a", "shift_b"][direction],
            Self::Base | Self::BaseTurn | Self::LinkEnd(_) | Self::LinkEndTurn(_) => SIX[direction],
            Self::Target | Self::Anchor => SIX[direction + 3],
            Self::Sight => ["along_x", "along_y", "along_z"][direction],
            _ => "",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arm::{Arm, RowState};
    use denavit_model::examples;

    fn all(n: usize) -> Vec<Carrier> {
        let mut carriers = vec![Carrier::Lengths, Carrier::Base, Carrier::BaseTurn, Carrier::AllJoints];
        for i in 0..n {
            carriers.extend([
                Carrier::Joint(i),
                Carrier::Along(i),
                Carrier::AxisBasis(i),
                Carrier::Sideways(i),
                Carrier::LinkEnd(i),
                Carrier::LinkEndTurn(i),
                Carrier::LinkLength(i),
            ]);
        }
        carriers
    }

    #[test]
    fn every_direction_does_what_its_action_says() {
        for chain in examples::all() {
            let arm = Arm::new(&chain, &denavit_measurements::Scene::default());
            let n = chain.coordinates().len();
            let q: Vec<f64> = (0..n).map(|k| 0.2 + 0.1 * k as f64).collect();
            for carrier in all(chain.joints().len()) {
                for (index, direction) in
                    carrier.directions(&Statics::of_chain(&chain), chain.joints(), 0).iter().enumerate()
                {
                    let mut perturbation = Perturbation::none(chain.joints().len());
                    for action in direction {
                        action.add_to(1e-4, &mut perturbation);
                    }
                    let (mut still, mut moved) = (RowState::default(), RowState::default());
                    arm.state_into(&q, 0, None, &mut still);
                    arm.state_into(&q, 0, Some(&perturbation), &mut moved);
                    let tip = (moved.tip.translation.vector - still.tip.translation.vector).norm();
                    let turned = denavit_model::se3::difference(&moved.tip, &still.tip).0;
                    let bound = 1e-4 * (1.0 + 3.0 * chain.size()) * n as f64;
                    assert!(tip <= bound && turned <= 1e-4 * n as f64 + 1e-12, "{carrier:?} {index}: {tip} {turned}");
                    if carrier.unit(&chain, index) == "rad" {
                        assert!(turned > 0.99e-4, "{carrier:?} {index} turns by {turned}");
                    }
                    if matches!(carrier, Carrier::Along(_) | Carrier::Sideways(_)) {
                        assert!((tip - 1e-4).abs() < 1e-12, "{carrier:?} {index} moves by {tip}");
                    }
                }
            }
        }
    }

    #[test]
    fn stretching_every_length_scales_the_reach() {
        let chain = examples::planar_arm();
        let arm = Arm::new(&chain, &denavit_measurements::Scene::default());
        let mut perturbation = Perturbation::none(chain.joints().len());
        for action in &Carrier::Lengths.directions(&Statics::of_chain(&chain), chain.joints(), 0)[0] {
            action.add_to(0.01, &mut perturbation);
        }
        let (mut still, mut stretched) = (RowState::default(), RowState::default());
        arm.state_into(&[0.4, 0.9], 0, None, &mut still);
        arm.state_into(&[0.4, 0.9], 0, Some(&perturbation), &mut stretched);
        let expected = still.tip.translation.vector * 1.01;
        assert!((stretched.tip.translation.vector - expected).norm() < 1e-12);
    }
}
