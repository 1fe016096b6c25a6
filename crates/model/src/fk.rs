//! Forward kinematics and Jacobians of a chain, without allocation.

use crate::chain::Chain;
use crate::se3::{self, Pose};
use nalgebra::{Point3, Vector6};

impl Chain {
    /// base_from_tip at the coordinates `q`.
    ///
    /// # Shape and units
    /// `q`: one value per coordinate, rad or m. Result: m.
    ///
    /// # Panics
    /// `q` is shorter than [`Chain::coordinates`].
    ///
    /// # Source
    /// Wu, Crawford, Roberts 2019, eq. (5).
    pub fn fk(&self, q: &[f64]) -> Pose {
        let mut reached = Pose::identity();
        for joint in self.joints() {
            reached *= joint.screw.motion(joint.value(q));
        }
        reached * self.home()
    }

    /// For each joint, the motion that the joints up to and including it have made at `q`: `motions[i]` carries what
    /// is fixed to the link after joint i from its place at home to its place at `q`. Returns base_from_tip.
    ///
    /// # Panics
    /// `q` or `motions` is too short.
    pub fn fk_into(&self, q: &[f64], motions: &mut [Pose]) -> Pose {
        let mut reached = Pose::identity();
        for (joint, motion) in self.joints().iter().zip(motions.iter_mut()) {
            reached *= joint.screw.motion(joint.value(q));
            *motion = reached;
        }
        reached * self.home()
    }

    /// Space Jacobian at `q`: column k is the twist `[omega; v]` of the tip in the base frame per unit of coordinate k.
    /// Returns base_from_tip.
    ///
    /// # Panics
    /// `q` or `columns` is shorter than [`Chain::coordinates`].
    ///
    /// # Source
    /// Lynch, Park 2017, Definition 5.1; mimic joints add to their driver's column.
    pub fn space_jacobian_into(&self, q: &[f64], columns: &mut [Vector6<f64>]) -> Pose {
        columns.fill(Vector6::zeros());
        let mut reached = Pose::identity();
        for joint in self.joints() {
            columns[joint.coordinate] += se3::adjoint_times(&reached, &joint.screw.twist()) * joint.scale;
            reached *= joint.screw.motion(joint.value(q));
        }
        reached * self.home()
    }

    /// Geometric Jacobian at `q`: column k is `[angular velocity; velocity of the tip's origin]`, both in the base
    /// frame, per unit of coordinate k.
    ///
    /// # Panics
    /// As [`Chain::space_jacobian_into`].
    pub fn tip_jacobian_into(&self, q: &[f64], columns: &mut [Vector6<f64>]) -> Pose {
        let pose = self.space_jacobian_into(q, columns);
        let tip = pose.translation.vector;
        for column in columns.iter_mut() {
            let omega = column.fixed_rows::<3>(0).into_owned();
            let v = column.fixed_rows::<3>(3) + omega.cross(&tip);
            column.fixed_rows_mut::<3>(3).copy_from(&v);
        }
        pose
    }

    /// An upper bound, m, for the distance of the tip's origin from `point` (a point on joint `index`'s link at home)
    /// over the whole joint range.
    pub fn reach_beyond(&self, index: usize, point: &Point3<f64>) -> f64 {
        let mut last = *point;
        let mut reach = 0.0;
        for joint in &self.joints()[index..] {
            if let Some(line) = joint.screw.line() {
                let next = line.nearest_to(&last);
                reach += (next - last).norm();
                last = next;
            }
            reach += self.greatest_slide(joint);
        }
        reach + (Point3::from(self.home().translation.vector) - last).norm()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::examples;
    use nalgebra::Vector3;
    use std::f64::consts::FRAC_PI_2;

    #[test]
    fn planar_arm_reaches_where_plane_geometry_says() {
        let arm = examples::planar_arm();
        let tip = arm.fk(&[FRAC_PI_2, -FRAC_PI_2]).translation.vector;
        assert!((tip - Vector3::new(0.5, 1.0, 0.0)).norm() < 1e-15, "{tip}");
    }

    #[test]
    fn jacobians_agree_with_central_differences() {
        for chain in examples::all() {
            let n = chain.coordinates().len();
            let q: Vec<f64> = (0..n).map(|k| 0.3 + 0.2 * k as f64).collect();
            let (mut space, mut tip) = (vec![Vector6::zeros(); n], vec![Vector6::zeros(); n]);
            let pose = chain.space_jacobian_into(&q, &mut space);
            chain.tip_jacobian_into(&q, &mut tip);
            assert!(se3::difference(&pose, &chain.fk(&q)).1 < 1e-14);
            for k in 0..n {
                let step = 1e-5;
                let (mut plus, mut minus) = (q.clone(), q.clone());
                plus[k] += step;
                minus[k] -= step;
                let (plus, minus) = (chain.fk(&plus), chain.fk(&minus));
                let velocity = (plus.translation.vector - minus.translation.vector) / (2.0 * step);
                let twist = se3::log(&(plus * minus.inverse())) / (2.0 * step);
                assert!((twist - space[k]).norm() < 1e-9, "{} column {k}", chain.name());
                assert!((velocity - tip[k].fixed_rows::<3>(3)).norm() < 1e-9, "{} column {k}", chain.name());
            }
        }
    }

    #[test]
    fn reach_bounds_every_sample() {
        for chain in examples::all() {
            let n = chain.coordinates().len();
            let bound = chain.reach_beyond(0, &Point3::origin());
            for sample in 0..500u32 {
                let q: Vec<f64> = (0..n)
                    .map(|k| {
                        let (lower, upper) = chain.coordinates()[k].range();
                        let part = (0.5 + f64::from(sample) * 0.618_033_988_749_895 * (k as f64 + 1.0).sqrt()).fract();
                        lower + part * (upper - lower)
                    })
                    .collect();
                assert!(chain.fk(&q).translation.vector.norm() <= bound + 1e-12, "{}", chain.name());
            }
        }
    }
}
