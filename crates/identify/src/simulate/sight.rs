//! A camera and a board: their poses in a simulated cell, and the postures in which the camera sees the board.

use super::{drawn, normal_vector};
use crate::arm::{Arm, Perturbation, RowState};
use crate::observe::{Seen, model_of};
use denavit_measurements::Scene;
use denavit_measurements::board::Sight;
use denavit_model::nalgebra::{Rotation3, Vector3};
use denavit_model::se3;
use rand_chacha::ChaCha8Rng;

/// Candidate postures per required one: an arm's camera looks elsewhere most of the time.
pub const TRIES: usize = 400;
/// Number of poses to try for the fixed part.
const PLACES: usize = 40;
/// Postures to evaluate a pose.
const POSTURES: usize = 400;
/// Fraction of the image's width that the board fills in the middle of the image.
const FILLED: f64 = 0.3;
/// Distance from the tip, m.
const FROM_TIP: f64 = 0.05;
/// Obliquity of the board in the middle of the image, rad.
const TILT: f64 = 0.2;

/// Places camera and board so that the most postures see the board's middle.
pub(super) fn face_each_other(arm: &mut Arm, scene: &Scene, sight: &Sight, random: &mut ChaCha8Rng) {
    let Some(board) = sight.board else { return };
    let (across, down) = (board.columns as f64 * board.square, board.rows as f64 * board.square);
    let width = sight.lens.size.map_or(2.0 * sight.lens.matrix[(0, 2)], |[width, _]| width);
    let distance = sight.lens.focal() * across.max(down) / (FILLED * width);
    for target in &mut arm.targets {
        target.translation.vector = normal_vector(random, FROM_TIP);
    }
    // The outermost corners show how much of the board is in view.
    let (last, row) = (board.corners() - 1, board.columns - 2);
    let corners = [0, row, last - row, last].map(|number| scene.series[number].clone());
    let mut outermost = scene.clone();
    outermost.series = corners.into();
    let coordinates = arm.nominal.coordinates().to_vec();
    let mut posture = || -> Vec<f64> { coordinates.iter().map(|coordinate| drawn(coordinate, random)).collect() };
    let postures: Vec<Vec<f64>> = (0..POSTURES).map(|_| posture()).collect();
    let seen_from: Vec<Vec<f64>> = (0..PLACES).map(|_| posture()).collect();
    let mut best = None;
    for q in seen_from {
        let turn = Rotation3::from_scaled_axis(normal_vector(random, TILT));
        let middle = Vector3::new(0.5 * across, 0.5 * down, 0.0);
        let camera_from_board = se3::pose(turn, Vector3::new(0.0, 0.0, distance) - turn * middle);
        let still_from_tip = if sight.on_hand { camera_from_board.inverse() } else { camera_from_board };
        let mut state = RowState::default();
        arm.state_into(&q, 0, None, &mut state);
        arm.instruments[0] = still_from_tip * (state.tip * arm.targets[0]).inverse();
        let count = postures.iter().filter(|q| share_in_view(arm, &outermost, q) > 0.5).count();
        if best.as_ref().is_none_or(|(most, _)| count > *most) {
            best = Some((count, arm.instruments[0]));
        }
    }
    if let Some((_, place)) = best {
        arm.instruments[0] = place;
    }
}

/// The first postures in which at least half of the corners are visible, at most this many; all of them where there are not more.
pub(super) fn that_see_enough(arm: &Arm, scene: &Scene, postures: Vec<Vec<f64>>, wanted: usize) -> Vec<Vec<f64>> {
    if postures.len() <= wanted {
        return postures;
    }
    postures.into_iter().filter(|q| share_in_view(arm, scene, q) >= 0.5).take(wanted).collect()
}

/// Fraction of visible corners.
fn share_in_view(arm: &Arm, scene: &Scene, q: &[f64]) -> f64 {
    let (mut state, still) = (RowState::default(), Perturbation::none(arm.joints.len()));
    arm.state_into(q, 0, None, &mut state);
    let seen = |series: &&denavit_measurements::Series| {
        model_of(series.kind).in_view(&Seen::new(arm, &state.tip, &still, series, &[0.0; 2], false))
    };
    scene.series.iter().filter(seen).count() as f64 / scene.series.len().max(1) as f64
}
