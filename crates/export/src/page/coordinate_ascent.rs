//! Coordinate ascent of a posture towards a goal: each step moves one coordinate and costs one joint motion.

use denavit_model::chain::Chain;
use denavit_model::nalgebra::Point3;
use denavit_model::se3::Pose;

/// A posture during the ascent.
///
/// ```text
/// tip = motion_1 ··· motion_i-1 · motion_i · behind_i+1     the first factors and the last point are known in a pass
/// ```
pub(super) struct CoordinateAscent<'a> {
    chain: &'a Chain,
    ranges: &'a [(f64, f64)],
    q: Vec<f64>,
    /// The tip as the joints from i on move it; n + 1 points.
    behind: Vec<Point3<f64>>,
    /// Whether a coordinate moves one joint alone; the others are mimicked.
    alone: Vec<bool>,
}

impl<'a> CoordinateAscent<'a> {
    pub fn new(chain: &'a Chain, ranges: &'a [(f64, f64)], q: Vec<f64>) -> Self {
        let mut count = vec![0; ranges.len()];
        for joint in chain.joints() {
            count[joint.coordinate] += 1;
        }
        let alone = count.into_iter().map(|count| count == 1).collect();
        let behind = vec![Point3::origin(); chain.joints().len() + 1];
        let mut ascent = Self { chain, ranges, q, behind, alone };
        ascent.look_back();
        ascent
    }

    /// Where the tip is.
    pub fn place(&self) -> Point3<f64> {
        self.behind[0]
    }

    pub fn values(&self) -> &[f64] {
        &self.q
    }

    /// Where the tip would be with another value of the first coordinate.
    pub fn with_first(&self, value: f64) -> Point3<f64> {
        let first = &self.chain.joints()[0];
        if first.coordinate == 0 && self.alone[0] {
            return self.motion(0, value) * self.behind[1];
        }
        let mut q = self.q.clone();
        q[0] = value;
        Point3::from(self.chain.fk(&q).translation.vector)
    }

    fn motion(&self, joint: usize, value: f64) -> Pose {
        let joint = &self.chain.joints()[joint];
        joint.screw.motion(joint.scale * value + joint.offset)
    }

    fn look_back(&mut self) {
        let count = self.chain.joints().len();
        self.behind[count] = Point3::from(self.chain.home().translation.vector);
        for joint in (0..count).rev() {
            let value = self.q[self.chain.joints()[joint].coordinate];
            self.behind[joint] = self.motion(joint, value) * self.behind[joint + 1];
        }
    }

    /// Each coordinate once: moved by the step (a part of its range) one way or the other where that is higher. Calls `reached`
    /// with every position reached, and returns whether there was one.
    pub fn pass(
        &mut self,
        step: f64,
        height: impl Fn(&Point3<f64>) -> f64,
        mut reached: impl FnMut(Point3<f64>),
    ) -> bool {
        let mut best = height(&self.place());
        let mut before = Pose::identity();
        let mut higher = false;
        for joint in 0..self.chain.joints().len() {
            let coordinate = self.chain.joints()[joint].coordinate;
            let (lower, upper) = self.ranges[coordinate];
            let old = self.q[coordinate];
            for sign in [1.0, -1.0] {
                let value = (old + sign * step * (upper - lower)).clamp(lower, upper);
                self.q[coordinate] = value;
                let place = if self.alone[coordinate] {
                    before * (self.motion(joint, value) * self.behind[joint + 1])
                } else {
                    Point3::from(self.chain.fk(&self.q).translation.vector)
                };
                if height(&place) > best {
                    best = height(&place);
                    higher = true;
                    reached(place);
                    break;
                }
                self.q[coordinate] = old;
            }
            if !self.alone[coordinate] {
                // The joint that mimics, behind, has moved with it.
                self.look_back();
            }
            before *= self.motion(joint, self.q[coordinate]);
        }
        self.look_back();
        higher
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use denavit_model::examples;

    #[test]
    fn a_pass_comes_where_forward_kinematics_says() {
        let chain = examples::puma_like();
        let ranges: Vec<(f64, f64)> = chain.coordinates().iter().map(denavit_model::Coordinate::range).collect();
        let mut ascent = CoordinateAscent::new(&chain, &ranges, vec![0.1, 0.2, -0.3, 0.4, -0.5, 0.6]);
        for step in [0.1, 0.05, 0.01] {
            let mut last = ascent.place();
            let moved = ascent.pass(step, |place| place.coords.norm(), |place| last = place);
            let expected = chain.fk(ascent.values()).translation.vector;
            assert!(
                moved && (ascent.place().coords - expected).norm() < 1e-14 && (last.coords - expected).norm() < 1e-14
            );
        }
        let turned = ascent.with_first(0.7);
        let mut q = ascent.values().to_vec();
        q[0] = 0.7;
        assert!((turned.coords - chain.fk(&q).translation.vector).norm() < 1e-14);
    }
}
