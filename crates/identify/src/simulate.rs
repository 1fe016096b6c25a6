//! Simulated measurement files: a robot that differs from its drawing, an instrument, noise. Seeded.

pub mod columns;
mod contact;
pub mod effect_specification;
pub mod files;
pub mod postures;
mod sight;
pub mod truth;
pub mod two_tips;

use crate::arm::{Arm, AxisBasis, Perturbation, Row, RowState};
use crate::effects::survey::{with_run_order, with_run_order_after};
use crate::observe::{Disturbance, Seen, model_of};
use crate::parameters::Effects;
use denavit_measurements::board::Sight;
use denavit_measurements::kinds::ObservationKind;
use denavit_measurements::{Covariate, Label, Measurements, Scene, Target};
use denavit_model::nalgebra::{Rotation3, Vector3, Vector6};
use denavit_model::{Chain, Coordinate, Pose, Tips, se3};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;
pub use sight::TRIES;
use std::sync::Arc;

/// What to simulate.
#[derive(Debug, Clone, PartialEq)]
pub struct SimulationOptions {
    /// What the instrument measures.
    pub kind: ObservationKind,
    /// Number of rows.
    pub rows: usize,
    /// Number of targets (positions; else 1).
    pub targets: usize,
    /// Same seed, same file.
    pub seed: u64,
    /// Standard deviation of the change of each axis' direction, rad.
    pub turn: f64,
    /// Standard deviation of the change of each axis' position, m.
    pub shift: f64,
    /// Standard deviation of the noise of one position component or distance, m.
    pub noise_position: f64,
    /// Standard deviation of the noise of one rotation vector component, rad.
    pub noise_orientation: f64,
    /// Standard deviation of additional noise along the instrument's line of sight, m.
    pub noise_range: f64,
    /// Standard deviation of the noise of the direction from the instrument to the target, rad.
    pub noise_angle: f64,
    /// Repeatability of each coordinate, rad or m: standard deviation about its reading; empty where exact.
    pub repeatability: Vec<f64>,
    /// Camera and board, for kinds that see the corners of a board; rows that do not see enough of it are left out.
    pub sight: Option<Sight>,
    /// Standard deviation of the noise of a pixel's component, px.
    pub noise_pixel: f64,
    /// Fraction of rows with a gross error of 5 to 50 mm.
    pub outliers: f64,
    /// Additional numeric columns, one value per row each.
    pub covariates: Vec<Covariate>,
    /// Joint readings, one value per coordinate and row (rad, m), instead of random ones within the limits.
    pub readings: Option<Vec<Vec<f64>>>,
    /// The tips that are measured in turn, a row each, where the robot has several: see [`Chain::joined`].
    pub tips: Option<Arc<Tips>>,
    /// Rows of the same run that were measured before, with run order: it continues from there.
    pub before: Option<Measurements>,
}

impl Default for SimulationOptions {
    fn default() -> Self {
        Self {
            kind: ObservationKind::Position,
            rows: 100,
            targets: 1,
            seed: 0,
            turn: 1e-3,
            shift: 1e-3,
            noise_position: 5e-5,
            noise_orientation: 5e-5,
            noise_range: 0.0,
            noise_angle: 0.0,
            repeatability: Vec::new(),
            sight: None,
            noise_pixel: 0.2,
            outliers: 0.0,
            covariates: Vec::new(),
            readings: None,
            tips: None,
            before: None,
        }
    }
}

/// Standard deviation of the tilt of a mounted base, about each of two axes, rad.
const LEAN: f64 = 0.02;

impl SimulationOptions {
    /// Postures to choose from for each row: a camera does not see its board in all of them.
    pub fn tries(&self) -> usize {
        match self.kind {
            kind if kind.of_a_board() => sight::TRIES,
            _ if two_tips::is_of(self) => two_tips::TRIES,
            kind if kind.holds_the_target() => contact::TRIES,
            _ => 1,
        }
    }
}

/// A simulated run: the data, and their true arm.
#[derive(Debug, Clone)]
pub struct Simulation {
    /// The true arm.
    pub arm: Arm,
    /// What was measured.
    pub data: Measurements,
    /// Rows with a gross error.
    pub outliers: Vec<usize>,
}

/// Draw a true arm near the nominal one, and measure it.
///
/// The random draws depend on the seed and the options, not on the effects.
pub fn simulate<E: Effects>(chain: &Chain, options: &SimulationOptions, effects: &E) -> Simulation {
    let mut random = ChaCha8Rng::seed_from_u64(options.seed);
    let arm = draw_arm(chain, options, &mut random);
    measure(&arm, options, effects, &mut random)
}

/// Measure a given arm with a seed of its own.
pub fn simulate_arm<E: Effects>(arm: &Arm, options: &SimulationOptions, effects: &E) -> Simulation {
    measure(arm, options, effects, &mut ChaCha8Rng::seed_from_u64(options.seed))
}

/// Random joint readings within the limits: `rows` times one value per coordinate, rad or m.
pub fn readings(chain: &Chain, rows: usize, seed: u64) -> Vec<Vec<f64>> {
    let n = chain.coordinates().len();
    let mut flat = vec![0.0; rows * n];
    readings_into(chain, seed, &mut flat);
    (0..rows).map(|row| flat[row * n..(row + 1) * n].to_vec()).collect()
}

/// The same into a slice, row by row.
pub fn readings_into(chain: &Chain, seed: u64, readings: &mut [f64]) {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    // A different stream from that of the arm and the noise.
    random.set_stream(1 << 33);
    for row in readings.chunks_exact_mut(chain.coordinates().len().max(1)) {
        for (value, coordinate) in row.iter_mut().zip(chain.coordinates()) {
            *value = drawn(coordinate, &mut random);
        }
    }
}

/// The same as controller commands: rounded to 1 µrad and 1 µm, the robot's actual values.
pub fn commanded_readings(chain: &Chain, rows: usize, seed: u64) -> Vec<Vec<f64>> {
    let rounded = |reading: Vec<f64>| reading.iter().map(|value| (value * 1e6).round() / 1e6).collect();
    readings(chain, rows, seed).into_iter().map(rounded).collect()
}

/// Measured values with the digits that an instrument of this noise shows: two more than its noise. Without noise, all digits.
pub fn as_displayed(data: &Measurements, options: &SimulationOptions) -> Measurements {
    let mut data = data.clone();
    let shown = |value: f64| {
        if options.noise_position == 0.0 {
            return value;
        }
        let digits = 10f64.powf((2.0 - options.noise_position.log10().floor()).min(15.0));
        (value * digits).round() / digits
    };
    for observation in 0..data.observations() {
        let lengths = data.series_of(observation).kind.lengths();
        data.observed.values_mut(observation)[..lengths].iter_mut().for_each(|value| *value = shown(*value));
    }
    data
}

fn drawn(coordinate: &Coordinate, random: &mut ChaCha8Rng) -> f64 {
    let (lower, upper) = coordinate.range();
    lower + (upper - lower) * random.random::<f64>()
}

fn normal(random: &mut ChaCha8Rng, deviation: f64) -> f64 {
    random.sample::<f64, _>(StandardNormal) * deviation
}

fn normal_vector(random: &mut ChaCha8Rng, deviation: f64) -> Vector3<f64> {
    Vector3::new(normal(random, deviation), normal(random, deviation), normal(random, deviation))
}

/// The observed scene: the corners of the board, or this many targets.
fn scene(options: &SimulationOptions, targets: usize) -> Scene {
    if let Some(tips) = options.tips.as_ref().filter(|tips| tips.several()) {
        return Scene::on_tips(options.kind, tips, if options.kind.of_several() { targets } else { 1 });
    }
    let board = || Scene::of_board(options.kind, options.sight.as_ref()?, 1.0);
    if options.kind.holds_the_target() {
        return contact::scene(options);
    }
    if options.kind.is_turned_alone() {
        let (kind, mut scene) = (options.kind, Scene::default());
        scene.add(kind, kind.own_setup(), Target::alone(kind.own_target().unwrap_or("")), None);
        return scene;
    }
    let of_board = options.kind.of_a_board().then(board).flatten();
    of_board.unwrap_or_else(|| Scene::of_several(options.kind, targets))
}

fn draw_arm(chain: &Chain, options: &SimulationOptions, random: &mut ChaCha8Rng) -> Arm {
    let scene = scene(options, options.targets);
    let mut arm = Arm::new(chain, &scene);
    let size = (0..arm.tips.all().len()).map(|tip| arm.nominal_to(tip).size()).fold(0.0, f64::max);
    for (index, joint) in chain.joints().iter().enumerate() {
        let turned = [normal(random, options.turn), normal(random, options.turn)];
        let moved = [normal(random, options.shift), normal(random, options.shift)];
        arm.change_axis(index, &AxisBasis::of(&joint.screw), turned, moved, 0.0);
    }
    for point in &mut arm.points {
        let away = normal_vector(random, 1.0);
        *point = away * (size / away.norm().max(1e-3));
    }
    for (setup, instrument) in arm.instruments.iter_mut().enumerate() {
        if scene.has_instrument(setup) {
            let (turn, place) = (normal_vector(random, 1.0), normal_vector(random, size));
            *instrument = se3::exp(&Vector6::new(turn.x, turn.y, turn.z, place.x, place.y, place.z));
        }
        if scene.has_level(setup) {
            let leans = normal_vector(random, LEAN);
            *instrument = se3::exp(&Vector6::new(leans.x, leans.y, 0.0, 0.0, 0.0, 0.0));
        }
    }
    for (index, target) in arm.targets.iter_mut().enumerate() {
        target.translation.vector = normal_vector(random, 0.1 * size);
        if scene.turns(index) {
            target.rotation = Rotation3::from_scaled_axis(normal_vector(random, 0.5));
        }
    }
    if options.kind.holds_the_target() && !two_tips::is_of(options) {
        contact::within_reach(&mut arm, random);
    }
    if let Some(sight) = options.sight.as_ref().filter(|_| options.kind.of_a_board()) {
        sight::face_each_other(&mut arm, &scene, sight, random);
    }
    arm
}

fn measure<E: Effects>(arm: &Arm, options: &SimulationOptions, effects: &E, random: &mut ChaCha8Rng) -> Simulation {
    let coordinates = arm.nominal.coordinates();
    let mut readings = options.readings.clone().unwrap_or_default();
    if options.readings.is_none() {
        let draw = |_| coordinates.iter().map(|coordinate| drawn(coordinate, random)).collect();
        readings.extend((0..options.rows * options.tries()).map(draw));
    }
    if options.kind.of_a_board() {
        readings = sight::that_see_enough(arm, &scene(options, 1), readings, options.rows);
    }
    if options.kind.holds_the_target() {
        readings = contact::touching(arm, options, readings, random);
    }
    let mut data = unmeasured(arm, options, &readings);
    let seen = match &options.before {
        Some(before) => with_run_order_after(data.clone(), before),
        None => with_run_order(data.clone()),
    };
    let (mut state, mut perturbation) = (RowState::default(), Perturbation::none(arm.joints.len()));
    let mut standing = effects.standing(arm);
    let mut outliers = Vec::new();
    for row in 0..data.len() {
        perturbation.clear();
        effects.perturb(Row::new(&seen, row), arm, &mut standing, &mut perturbation);
        come_back(arm, &options.repeatability, &mut perturbation, random);
        arm.state_into(data.reading(row), data.tip_of(row), Some(&perturbation), &mut state);
        let (gross, error) = gross_error(options, random);
        outliers.extend(gross.then_some(row));
        observe(arm, &state, &perturbation, options, error, row, &mut data, random);
    }
    Simulation { arm: arm.clone(), data, outliers }
}

/// Whether a row has a gross error, and the error, m: 5 to 50 mm, or zero.
fn gross_error(options: &SimulationOptions, random: &mut ChaCha8Rng) -> (bool, Vector3<f64>) {
    let gross = random.random::<f64>() < options.outliers;
    let direction = normal_vector(random, 1.0).normalize();
    let error = direction * (5e-3 + 45e-3 * random.random::<f64>());
    (gross, if gross { error } else { Vector3::zeros() })
}

/// Shifts every coordinate from its reading by a random repeatability error.
fn come_back(arm: &Arm, repeatability: &[f64], perturbation: &mut Perturbation, random: &mut ChaCha8Rng) {
    for (coordinate, deviation) in repeatability.iter().enumerate() {
        let beside = normal(random, *deviation);
        for (index, joint) in arm.joints.iter().enumerate().filter(|(_, joint)| joint.coordinate == coordinate) {
            perturbation.twists[index] += joint.screw.twist() * (joint.scale * beside);
        }
    }
}

/// Adds the noise of an instrument that reads a range and two angles: along the line of sight, and across it in
/// proportion to the distance.
fn misread(values: &mut [f64], options: &SimulationOptions, random: &mut ChaCha8Rng) {
    let place = Vector3::new(values[0], values[1], values[2]);
    let distance = place.norm();
    if distance == 0.0 {
        return;
    }
    let sight = place / distance;
    let any = normal_vector(random, options.noise_angle * distance);
    let along = normal(random, options.noise_range);
    let noise = any - sight * sight.dot(&any) + sight * along;
    for k in 0..3 {
        values[k] += noise[k];
    }
}

/// Adds the instrument's readings in a row, with noise and a gross error.
#[expect(clippy::too_many_arguments, reason = "it is one step of the loop above")]
fn observe(
    arm: &Arm,
    state: &RowState,
    perturbation: &Perturbation,
    options: &SimulationOptions,
    gross: Vector3<f64>,
    row: usize,
    data: &mut Measurements,
    random: &mut ChaCha8Rng,
) {
    let mut values = Vec::new();
    for observation in data.of_row(row) {
        let series = data.series_of(observation).clone();
        values.clear();
        let measured = data.observed.values(observation);
        model_of(series.kind).predict(&Seen::new(arm, &state.tip, perturbation, &series, measured, false), &mut values);
        let mut errors = Disturbance {
            gross,
            position: options.noise_position,
            orientation: options.noise_orientation,
            pixel: options.noise_pixel,
            draw: &mut |deviation| normal(random, deviation),
        };
        model_of(series.kind).disturb(&mut values, &mut errors);
        if series.kind.has_simd_residuals() && (options.noise_range > 0.0 || options.noise_angle > 0.0) {
            misread(&mut values, options, random);
        }
        data.observed.values_mut(observation).copy_from_slice(&values);
    }
}

/// The rows, nothing measured yet.
fn unmeasured(arm: &Arm, options: &SimulationOptions, readings: &[Vec<f64>]) -> Measurements {
    let joints = arm.nominal.coordinates().iter().map(|coordinate| coordinate.name.clone()).collect();
    let scene = scene(options, arm.targets.len() / arm.tips.all().len());
    let mut data = Measurements::empty("simulation", joints, scene);
    data.covariates = options.covariates.clone().into();
    let nothing = vec![0.0; options.kind.numbers()];
    let touches = options.kind.holds_the_target();
    if touches {
        // The column that identifies the planes.
        let name = options.kind.label().unwrap_or("setup").to_owned();
        let planes = data.scene.setups.iter().map(|setup| setup.split(' ').next().unwrap_or("").to_owned());
        data.labels.push(Label { name, values: planes.cycle().take(readings.len()).collect() });
    }
    let tips = arm.tips.all().len();
    if tips > 1 {
        let name = |row: usize| arm.tips[row % tips].name.clone();
        data.labels.push(Label { name: "tip".into(), values: (0..readings.len()).map(name).collect() });
    }
    let (mut state, still) = (RowState::default(), Perturbation::none(arm.joints.len()));
    for (row, reading) in readings.iter().enumerate() {
        let of_tip = row % tips;
        arm.state_into(reading, of_tip, None, &mut state);
        for (index, series) in data.scene.series.iter().enumerate() {
            if data.scene.tip_of(series.target) != of_tip {
                continue;
            }
            if touches && index != row % data.scene.series.len() {
                continue;
            }
            if model_of(series.kind).in_view(&Seen::new(arm, &state.tip, &still, series, &nothing, false)) {
                data.observed.push(index, &nothing);
            }
        }
        data.end_row(reading, row + 2, false);
    }
    data.covariates.truncate(readings.len());
    data
}

/// base_from_target without instrument and noise, for a target of the arm.
pub fn true_target(arm: &Arm, q: &[f64], target: usize) -> Pose {
    let mut state = RowState::default();
    arm.state_into(q, arm.sits_on[target], None, &mut state);
    state.tip * arm.targets[target]
}
