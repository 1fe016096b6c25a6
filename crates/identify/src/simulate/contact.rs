//! Planes that a simulated arm touches, and the postures in which it does.

use super::{SimulationOptions, drawn, normal};
use crate::arm::{Arm, RowState};
use denavit_measurements::{Scene, Target};
use denavit_model::nalgebra::{DVector, Point3, Vector3};
use denavit_model::se3;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

/// Planes of a simulated run.
pub const PLANES: usize = 3;
/// Candidate postures per required one: not every one reaches its plane within the joint limits.
pub const TRIES: usize = 20;
/// Travel of a dial gauge to either side, m.
const TRAVEL: f64 = 5e-3;
/// Newton's steps to a plane.
const STEPS: usize = 30;
/// Tolerance of a point on the plane, m.
const ON_PLANE: f64 = 1e-12;
/// Step of the derivatives, rad or m.
const DIFFERENCE: f64 = 1e-6;

/// Planes for a kind of contact.
pub(super) fn scene(options: &SimulationOptions) -> Scene {
    let (kind, mut scene) = (options.kind, Scene::default());
    for plane in 1..=PLANES {
        scene.add(kind, &format!("{plane} {}", kind.own_setup()), Target::alone(kind.own_target().unwrap_or("")), None);
    }
    scene
}

/// Places planes within reach: each contains the target in some posture, with a random orientation.
pub(super) fn within_reach(arm: &mut Arm, random: &mut ChaCha8Rng) {
    let coordinates = arm.nominal.coordinates().to_vec();
    for plane in 0..arm.instruments.len() {
        let q: Vec<f64> = coordinates.iter().map(|coordinate| drawn(coordinate, random)).collect();
        let mut state = RowState::default();
        arm.state_into(&q, 0, None, &mut state);
        let through = (state.tip * Point3::from(arm.targets[0].translation.vector)).coords;
        let towards = Vector3::new(normal(random, 1.0), normal(random, 1.0), normal(random, 1.0)).normalize();
        let rotation = se3::least_rotation(&towards, &Vector3::z());
        arm.instruments[plane] = se3::pose(rotation, -(rotation * through));
    }
}

/// Postures near these in which the target touches its plane, with planes in turn: at most `rows`.
///
/// The noise displaces a contact, since no value is read; a gauge reads somewhere on its travel.
pub(super) fn touching(
    arm: &Arm,
    options: &SimulationOptions,
    readings: Vec<Vec<f64>>,
    random: &mut ChaCha8Rng,
) -> Vec<Vec<f64>> {
    let mut found: Vec<Vec<f64>> = Vec::new();
    for reading in readings {
        if found.len() == options.rows {
            break;
        }
        let height = if options.kind.numbers() == 0 {
            normal(random, options.noise_position)
        } else {
            TRAVEL * (2.0 * random.random::<f64>() - 1.0)
        };
        found.extend(brought_to(arm, found.len() % arm.instruments.len(), height, reading));
    }
    found
}

/// The posture near `q` in which the target is at this height above a plane, m; `None` where there is none within the limits.
fn brought_to(arm: &Arm, plane: usize, height: f64, mut q: Vec<f64>) -> Option<Vec<f64>> {
    let above = |q: &[f64]| {
        let mut state = RowState::default();
        arm.state_into(q, 0, None, &mut state);
        let at = state.tip * Point3::from(arm.targets[0].translation.vector);
        (arm.instruments[plane] * at).z - height
    };
    for _ in 0..STEPS {
        let left = above(&q);
        if left.abs() < ON_PLANE {
            break;
        }
        let slope = DVector::from_fn(q.len(), |k, _| {
            let mut moved = q.clone();
            moved[k] += DIFFERENCE;
            let plus = above(&moved);
            moved[k] -= 2.0 * DIFFERENCE;
            (plus - above(&moved)) / (2.0 * DIFFERENCE)
        });
        let step = &slope * (left / slope.norm_squared());
        q.iter_mut().zip(step.iter()).for_each(|(value, step)| *value -= step);
    }
    let within = arm.nominal.coordinates().iter().zip(&q).all(|(coordinate, value)| {
        let (lower, upper) = coordinate.range();
        (lower..=upper).contains(value)
    });
    (within && above(&q).abs() < 1e3 * ON_PLANE).then_some(q)
}
