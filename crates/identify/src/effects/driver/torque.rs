//! Gravity's loads on joints, links and the base of an arm in a posture.

use crate::effects::driver::statics::{Posture, Statics};
use denavit_model::Screw;
use denavit_model::nalgebra::{Rotation3, Vector3};

/// Shear and bending of a round tube under the same end moment: E/(2G) · 2 for steel.
pub const TWIST_TO_BEND: f64 = 1.3;

impl Posture {
    /// Gravity's moment about a joint's current position, base frame, N·m.
    fn moment(&self, joint: usize) -> Vector3<f64> {
        let load = &self.loads[joint];
        load.moment + self.axes[joint].lever.cross(&load.force)
    }

    /// Its component perpendicular to the axis.
    pub(super) fn moment_across(&self, joint: usize) -> Vector3<f64> {
        let (moment, along) = (self.moment(joint), self.axes[joint].along);
        moment - along * along.dot(&moment)
    }
}

impl Statics {
    /// Gravity's torque (N·m) or force (N) on a joint along its own motion.
    pub fn torque(&self, posture: &Posture, joint: usize) -> f64 {
        let along = posture.axes[joint].along;
        let (moment, force) = (|| along.dot(&posture.moment(joint)), || along.dot(&posture.loads[joint].force));
        match &self.chain.joints()[joint].screw {
            Screw::Prismatic(_) => force(),
            Screw::Revolute(_) => moment(),
            Screw::Helical { pitch, .. } => moment() + pitch.metres_per_radian() * force(),
        }
    }

    /// Gravity's moment on the base about its origin, base frame, N·m.
    pub(super) fn overturning(&self, posture: &Posture) -> Vector3<f64> {
        let on_the_base = self.carriers.iter().zip(&self.points).zip(&posture.loads);
        let moments = on_the_base.filter(|((carrier, _), _)| carrier.is_none());
        moments.map(|((_, at), load)| load.moment + at.coords.cross(&load.force)).sum()
    }

    /// Two lines perpendicular to gravity, base frame: as near to x and y as possible.
    pub fn level(&self) -> [Vector3<f64>; 2] {
        let down = self.masses.gravity.normalize();
        let along = if down.x.abs() < down.y.abs().max(down.z.abs()) { Vector3::x() } else { Vector3::z() };
        let first = (along - down * down.dot(&along)).normalize();
        [first, first.cross(&down)]
    }

    pub(super) fn torque_terms(&self, posture: &Posture, joint: usize, links: usize, out: &mut Vec<f64>) {
        let state = &posture.state;
        let axis = posture.axes[joint].along;
        // Torque per first moment h (kg m): axis · (h × gravity) = (gravity × axis) · h.
        let lever = self.masses.gravity.cross(&axis);
        for link in self.carried(joint, links) {
            let basis = &self.bases[link];
            let rotation = &state.after[link].rotation;
            out.push(lever.dot(&(rotation * basis.a)));
            out.push(lever.dot(&(rotation * basis.b)));
        }
    }

    pub(super) fn cantilever(&self, posture: &Posture, joint: usize, tip: usize) -> [Vector3<f64>; 2] {
        let Some(end) = self.link_end(joint, tip) else { return [Vector3::zeros(); 2] };
        let reach = end.point - self.points[joint];
        let length = reach.norm();
        if length == 0.0 {
            return [Vector3::zeros(); 2];
        }
        let to_home: Rotation3<f64> = posture.state.after[joint].rotation.inverse();
        let (force, torque) = match posture.loads.get(end.slot) {
            Some(load) => (to_home * load.force, to_home * load.moment),
            None => (Vector3::zeros(), Vector3::zeros()),
        };
        let along = reach / length;
        let twist = along * along.dot(&torque);
        let bend = torque - twist;
        let turn = (bend + twist * TWIST_TO_BEND) * length + reach.cross(&force) * (0.5 * length);
        let basis = force - along * along.dot(&force);
        let shift = basis * (length.powi(3) / 3.0) + bend.cross(&reach) * (0.5 * length);
        [turn, shift]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arm::{Arm, AxisBasis};
    use crate::effects::driver::Conditions;
    use denavit_measurements::RecordedRow;
    use denavit_model::examples;

    #[test]
    fn torque_is_the_change_of_potential_energy() {
        for chain in examples::all() {
            let statics = Statics::of_chain(&chain);
            let recorded = RecordedRow::nothing();
            // As drawn, and with axes that differ from the drawing.
            let mut arm = Arm::new(&chain, &denavit_measurements::Scene::default());
            for (index, joint) in chain.joints().iter().enumerate() {
                let moved = if joint.screw.line().is_some() { [0.02, -0.03] } else { [0.0; 2] };
                arm.change_axis(index, &AxisBasis::of(&joint.screw), [0.02, -0.01], moved, 0.0);
            }
            for joints in [chain.joints(), &arm.joints] {
                let energy = |q: &[f64]| -> f64 {
                    let posture = statics.posture(joints, &Conditions { reading: q, recorded, tip: 0 }, None);
                    let masses = statics.masses.points.iter().zip(statics.centres(joints));
                    let high = masses
                        .map(|(p, centre)| (posture.state.after[p.joint] * centre).coords * p.mass)
                        .map(|moment| -statics.masses.gravity.dot(&moment));
                    high.sum()
                };
                let q: Vec<f64> = (0..statics.chain.coordinates().len()).map(|k| 0.4 + 0.3 * k as f64).collect();
                let posture = statics.posture(joints, &Conditions { reading: &q, recorded, tip: 0 }, None);
                for (index, coordinate) in (0..q.len()).map(|k| (k, k)) {
                    let movers: Vec<usize> = (0..statics.chain.joints().len())
                        .filter(|&j| statics.chain.joints()[j].coordinate == coordinate)
                        .collect();
                    let (mut up, mut low) = (q.clone(), q.clone());
                    up[index] += 1e-5;
                    low[index] -= 1e-5;
                    let slope = (energy(&up) - energy(&low)) / 2e-5;
                    let torque: f64 = movers.iter().map(|&j| statics.torque(&posture, j) * joints[j].scale).sum();
                    assert!((torque + slope).abs() < 1e-5 * (1.0 + slope.abs()), "{torque} {slope}");
                }
            }
        }
    }
}
