//! First guesses of the poses of instrument, anchor and targets, from which a fit can start.

use crate::arm::Arm;
use crate::least_squares::least_squares;
use crate::observe::model_of;
use crate::parameters::{Freedom, Layout, NoEffects, Tolerances};
use crate::solve::{Fit, FitOptions, fit};
use denavit_measurements::Measurements;
use denavit_measurements::kinds::Frame;
use denavit_model::nalgebra::{DMatrix, DVector, Matrix3, Point3, Rotation3, Vector3};
use denavit_model::{Chain, Pose, se3};
use std::collections::{BTreeMap, BTreeSet};

/// Number of rows for the search for a start.
const ROWS_FOR_START: usize = 60;
/// Number of rows that place the drawn robot before its axes are fitted: more do not improve the start.
const ROWS_FOR_PLACEMENT: usize = 1000;
/// Fewest of these rows that must see each target.
const LEAST_SIGHTS: usize = 30;
/// Number of rotated frames that a fit starts from: those nearest to the data.
const TURNS_TO_FIT: usize = 3;
/// How often targets and instrument are placed alternately, each in closed form, before a rotated frame is evaluated.
const PLACINGS: usize = 3;
/// Iterations that test a start: from the right one a fit has nearly converged.
const ITERATIONS_FROM_START: usize = 15;
/// Another direction of gravity must reduce the sum of squares below this fraction to be used.
const CLEARLY_BETTER: f64 = 0.9;
/// A start is good enough when the residuals of its fit are below this fraction of the robot's size.
const GOOD_ENOUGH: f64 = 0.01;

/// The nominal robot with instrument (or anchor) and targets fitted: the stage `nominal`.
///
/// # Shape and units
/// `weights`: one per observation, 0 for what is to be left out.
pub fn nominal_fit(chain: &Chain, data: &Measurements, weights: &[f64], options: &FitOptions) -> Fit<NoEffects> {
    let freedom = Freedom::placement(chain.joints().len());
    let layout = Layout::new(chain, &data.scene, &freedom, &Tolerances::default(), Vec::new());
    // Where images determine the pose of the board, poses are the better start.
    let start = match data.as_poses() {
        Some(posed) => {
            let layout = Layout::new(chain, &posed.scene, &freedom, &Tolerances::default(), Vec::new());
            let weights = vec![1.0; posed.observations()];
            let start = start(chain, &posed, &weights, &layout);
            let options = FitOptions { robust: true, ..*options };
            fit(&posed, &layout, &start, &NoEffects, &weights, &options).arm
        }
        None => start(chain, data, weights, &layout),
    };
    let start = with_tools_held(chain, data, start);
    let placed = |arm: &Arm| fit(data, &layout, arm, &NoEffects, weights, options);
    with_plates_turned(data, placed(&start), &placed)
}

/// A reversed plate must reduce the sum of squares below this fraction to be used.
const TURNED_IS_BETTER: f64 = 0.9;

/// The fit with every plate on its better side: readings with the wrong sign have a local minimum of their own, which no step
/// leaves.
pub(crate) fn with_plates_turned(
    data: &Measurements,
    mut found: Fit<NoEffects>,
    fit: &dyn Fn(&Arm) -> Fit<NoEffects>,
) -> Fit<NoEffects> {
    let reads = |observation: usize| {
        let kind = data.series_of(observation).kind;
        kind.unknowns().frame == Frame::Plane && kind.numbers() > 0
    };
    let of_plates: Vec<usize> = (0..data.observations()).filter(|&observation| reads(observation)).collect();
    let left = |fit: &Fit<NoEffects>| of_plates.iter().map(|&at| fit.squares[at][0]).sum::<f64>();
    let setups: BTreeSet<usize> = of_plates.iter().map(|&at| data.series_of(at).setup).collect();
    // One may fit only when the others do.
    for _ in &setups {
        let before = left(&found);
        for &setup in &setups {
            let own = of_plates.iter().filter(|&&at| data.series_of(at).setup == setup);
            let read: Vec<f64> = own.map(|&at| data.observed.values(at)[0]).collect();
            let middle = read.iter().sum::<f64>() / read.len() as f64;
            let over = Rotation3::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI);
            let mut arm = found.arm.clone();
            arm.instruments[setup] = se3::pose(over, Vector3::new(0.0, 0.0, 2.0 * middle)) * arm.instruments[setup];
            let turned = fit(&arm);
            if left(&turned) < TURNED_IS_BETTER * left(&found) {
                found = turned;
            }
        }
        if left(&found) >= before {
            break;
        }
    }
    found
}

/// The arm with the plates on the same side as another's.
pub(crate) fn with_plates_of(data: &Measurements, arm: &Arm, other: &Arm) -> Arm {
    let mut arm = arm.clone();
    for setup in (0..data.scene.setups.len()).filter(|&setup| data.scene.has_plane(setup)) {
        arm.instruments[setup] = other.instruments[setup];
    }
    arm
}

/// Rows spread over the run that suffice to place the drawn robot; `None` where all are needed.
pub fn some_rows(data: &Measurements) -> Option<Measurements> {
    let rows = data.len();
    if rows <= ROWS_FOR_PLACEMENT {
        return None;
    }
    let spread: Vec<usize> = (0..ROWS_FOR_PLACEMENT).map(|k| k * (rows - 1) / (ROWS_FOR_PLACEMENT - 1)).collect();
    let some = data.subset(&spread);
    let mut sights = vec![0; some.scene.targets.len()];
    (0..some.observations()).for_each(|observation| sights[some.series_of(observation).target] += 1);
    sights.iter().all(|sights| *sights >= LEAST_SIGHTS).then_some(some)
}

/// A start near the best fit: a closed form on some rows, and a search over rotated frames where that fails.
fn start(chain: &Chain, data: &Measurements, weights: &[f64], layout: &Layout) -> Arm {
    if data.scene.setups.len() > 1 && data.scene.has_instruments() {
        return assembled(chain, data, weights);
    }
    let rows = usable_rows(data, weights);
    let few = data.subset(&rows);
    let weights: Vec<f64> =
        rows.iter().flat_map(|&row| data.of_row(row)).map(|observation| weights[observation]).collect();
    let tips = tips_as_drawn(chain, &few);
    let good = GOOD_ENOUGH * chain.size();
    let mut best: Option<(f64, Arm)> = None;
    let options = FitOptions { robust: true, most_iterations: ITERATIONS_FROM_START, ..FitOptions::default() };
    for guess in guesses(chain, &few, &tips) {
        let fit = fit(&few, layout, &guess, &NoEffects, &weights, &options);
        let left = misfit(&fit);
        if left.is_finite() && best.as_ref().is_none_or(|(least, _)| left < *least) {
            best = Some((left, fit.arm));
        }
        if left < good {
            break;
        }
    }
    best.map_or_else(|| Arm::new(chain, &data.scene), |(_, arm)| arm)
}

/// Pose of the tip in each row by the drawing.
fn tips_as_drawn(chain: &Chain, data: &Measurements) -> Vec<Pose> {
    let tips = data.scene.tips_of(chain);
    (0..data.len()).map(|row| tips[data.tip_of(row)].fk(chain, data.reading(row))).collect()
}

/// Separate starts of the setups, combined.
fn assembled(chain: &Chain, data: &Measurements, weights: &[f64]) -> Arm {
    let mut arm = Arm::new(chain, &data.scene);
    for setup in (0..data.scene.setups.len()).filter(|&setup| !data.scene.is_held(setup)) {
        let (part, observations) = data.of_one_setup(setup);
        let weights: Vec<f64> = observations.iter().map(|&observation| weights[observation]).collect();
        let freedom = Freedom::placement(chain.joints().len());
        let layout = Layout::new(chain, &part.scene, &freedom, &Tolerances::default(), Vec::new());
        let own = start(chain, &part, &weights, &layout);
        arm.instruments[setup] = own.instruments.first().copied().unwrap_or_else(Pose::identity);
        for (name, target) in part.scene.targets.iter().zip(&own.targets) {
            if let Some(index) = data.scene.targets.iter().position(|known| known == name) {
                arm.targets[index] = *target;
            }
        }
        for (name, point) in part.scene.points.iter().zip(&own.points) {
            if let Some(index) = data.scene.points.iter().position(|known| known == name) {
                arm.points[index] = *point;
            }
        }
    }
    arm
}

/// The largest noise level of the lengths, m.
fn misfit(fit: &Fit<NoEffects>) -> f64 {
    fit.noise.levels.iter().fold(0.0f64, |most, level| most.max(*level))
}

/// Rows spread over the run that see the most targets.
fn usable_rows(data: &Measurements, weights: &[f64]) -> Vec<usize> {
    let useful: Vec<usize> =
        (0..data.len()).filter(|&row| data.of_row(row).any(|observation| weights[observation] > 0.0)).collect();
    if useful.len() <= ROWS_FOR_START {
        return useful;
    }
    (0..ROWS_FOR_START).map(|k| useful[k * (useful.len() - 1) / (ROWS_FOR_START - 1)]).collect()
}

/// Arms to start from: with many orientations of the instrument, or many positions of the points.
fn guesses<'a>(chain: &'a Chain, data: &'a Measurements, tips: &'a [Pose]) -> Box<dyn Iterator<Item = Arm> + 'a> {
    let targets = data.scene.targets.len();
    if !data.scene.has_instruments() {
        return Box::new(point_guesses(chain, data, tips));
    }
    let from_tips = std::iter::once_with(move || aligned(chain, data, tips, &vec![Vector3::zeros(); targets]));
    let nearest = move || {
        let placed = |rotation: &Rotation3<f64>| aligned(chain, data, tips, &offsets_for(data, tips, rotation));
        let turned = turned_frames();
        let arms = turned.iter().map(|rotation| {
            let arm = (1..PLACINGS).fold(placed(rotation), |arm, _| placed(&arm.instruments[0].rotation));
            (squares_left(&arm, data, tips), arm)
        });
        let mut arms: Vec<(f64, Arm)> = arms.collect();
        arms.sort_by(|a, b| a.0.total_cmp(&b.0));
        arms.into_iter().take(TURNS_TO_FIT).map(|(_, arm)| arm)
    };
    Box::new(from_tips.chain(std::iter::once_with(nearest).flatten()))
}

/// Sum of the squared distances between measured positions and this arm's predictions, m².
fn squares_left(arm: &Arm, data: &Measurements, tips: &[Pose]) -> f64 {
    positions(data)
        .map(|(row, target, measured)| {
            let on_arm = tips[row] * Point3::from(arm.targets[target].translation.vector);
            (arm.instruments[0] * on_arm - Point3::from(measured)).norm_squared()
        })
        .sum()
}

/// Measured positions: row, target, position in the instrument's frame, m.
fn positions(data: &Measurements) -> impl Iterator<Item = (usize, usize, Vector3<f64>)> + '_ {
    (0..data.len()).flat_map(move |row| {
        data.of_row(row).filter_map(move |observation| {
            let series = data.series_of(observation);
            Some((row, series.target, series.kind.position(data.observed.values(observation))?))
        })
    })
}

/// The arm with the best instrument pose for these targets (tip frame, m), and targets and points to match.
fn aligned(chain: &Chain, data: &Measurements, tips: &[Pose], offsets: &[Vector3<f64>]) -> Arm {
    let mut arm = Arm::new(chain, &data.scene);
    let on_arm = |row: usize, target: usize| tips[row].rotation * offsets[target] + tips[row].translation.vector;
    let pairs: Vec<_> = positions(data).map(|(row, target, measured)| (on_arm(row, target), measured)).collect();
    let Some(instrument) = rigid_fit(&pairs) else { return arm };
    arm.instruments[0] = instrument;
    for (target, pose) in arm.targets.iter_mut().enumerate() {
        let seen: Vec<Vector3<f64>> = positions(data)
            .filter(|(_, of, _)| *of == target)
            .map(|(row, _, measured)| {
                let in_base = instrument.inverse() * Point3::from(measured);
                (tips[row].inverse() * in_base).coords
            })
            .collect();
        if !seen.is_empty() {
            pose.translation.vector = seen.iter().sum::<Vector3<f64>>() / seen.len() as f64;
        }
        let mut sum = Matrix3::zeros();
        for (row, tip) in tips.iter().enumerate() {
            for observation in data.of_row(row) {
                let series = data.series_of(observation);
                let turn = series.kind.orientation(data.observed.values(observation));
                if let Some(orientation) = turn.filter(|_| series.target == target) {
                    sum += (tip.rotation.inverse() * instrument.rotation.inverse() * orientation).into_inner();
                }
            }
        }
        if sum != Matrix3::zeros() {
            pose.rotation = nearest_rotation(&sum);
        }
    }
    place_planes(data, tips, &mut arm);
    place_levels(data, tips, &mut arm);
    let points = places_of_points(data, tips, &arm).into_iter();
    arm.points = points.map(|places| places.first().copied().unwrap_or_default()).collect();
    arm
}

/// Places planes by the rows that touch them, with this arm's targets.
fn place_planes(data: &Measurements, tips: &[Pose], arm: &mut Arm) {
    for setup in (0..data.scene.setups.len()).filter(|&setup| data.scene.has_plane(setup)) {
        let (mut predicted, mut values, mut kind) = (Vec::new(), Vec::new(), None);
        for (row, tip) in tips.iter().enumerate() {
            for observation in data.of_row(row).filter(|&observation| data.series_of(observation).setup == setup) {
                let series = data.series_of(observation);
                predicted.push((tip * Point3::from(arm.targets[series.target].translation.vector)).coords);
                values.push(data.observed.values(observation));
                kind = Some(series.kind);
            }
        }
        if let Some(plane) = kind.and_then(|kind| model_of(kind).plane(&predicted, &values)) {
            arm.instruments[setup] = plane;
        }
    }
}

/// Places held tools: the first tip's frame is the tool's; finds the grip of the other tips, and the frames of all rows.
fn with_tools_held(chain: &Chain, data: &Measurements, mut arm: Arm) -> Arm {
    let firsts = data.scene.tool_frames();
    if firsts.is_empty() {
        return arm;
    }
    let tips = tips_as_drawn(chain, data);
    let mut seen: BTreeMap<usize, Vec<(usize, Pose)>> = BTreeMap::new();
    for (row, tip) in tips.iter().enumerate() {
        for series in data.of_row(row).map(|observation| data.series_of(observation)) {
            if series.kind.unknowns().frame == Frame::Grip {
                seen.entry(series.setup).or_default().push((series.target, *tip));
            }
        }
    }
    let mut held: BTreeMap<usize, Vec<Pose>> = BTreeMap::new();
    for both in seen.values() {
        let Some((_, tool)) = both.iter().find(|(target, _)| firsts.contains(target)) else { continue };
        for (target, tip) in both.iter().filter(|(target, _)| !firsts.contains(target)) {
            held.entry(*target).or_default().push(tip.inverse() * tool);
        }
    }
    for &target in &firsts {
        arm.targets[target] = Pose::identity();
    }
    for (target, poses) in &held {
        arm.targets[*target] = mean_pose(poses);
    }
    for (setup, both) in &seen {
        let tools: Vec<Pose> = both.iter().map(|(target, tip)| tip * arm.targets[*target]).collect();
        arm.instruments[*setup] = mean_pose(&tools).inverse();
    }
    arm
}

/// Mean of poses that are near to each other; at least one.
pub(crate) fn mean_pose(poses: &[Pose]) -> Pose {
    let place = poses.iter().map(|pose| pose.translation.vector).sum::<Vector3<f64>>() / poses.len() as f64;
    let turn = poses.iter().map(|pose| pose.rotation.into_inner()).sum::<Matrix3<f64>>();
    se3::pose(nearest_rotation(&turn), place)
}

/// How often sensors and the direction of gravity are updated alternately, each in closed form.
const LEVELLINGS: usize = 10;

/// A frame with its z axis opposite to this direction of gravity (any length, base frame).
pub(crate) fn level(down: &Vector3<f64>) -> Pose {
    let up = -down.try_normalize(0.0).unwrap_or_else(|| -Vector3::z());
    let rotation = se3::least_rotation(&up, &Vector3::z());
    se3::pose(Rotation3::from_matrix_unchecked(*rotation.matrix()), Vector3::zeros())
}

/// Direction of gravity, base frame, orientations of sensors on their tips, by target, and the sum of squares.
struct Levelled {
    left: f64,
    down: Vector3<f64>,
    sensors: Vec<Option<Rotation3<f64>>>,
}

/// Orients gravity sensors and level frames by the rows: tries gravity along each axis of the base, and uses the first of equally
/// good ones.
fn place_levels(data: &Measurements, tips: &[Pose], arm: &mut Arm) {
    for setup in (0..data.scene.setups.len()).filter(|&setup| data.scene.has_level(setup)) {
        let mut felt: Vec<(usize, usize, Vector3<f64>)> = Vec::new();
        for row in 0..tips.len() {
            for observation in data.of_row(row).filter(|&observation| data.series_of(observation).setup == setup) {
                let series = data.series_of(observation);
                let down = series.kind.down(data.observed.values(observation));
                felt.extend(down.map(|down| (row, series.target, down)));
            }
        }
        let mut best: Option<Levelled> = None;
        for start in [-1.0, 1.0].into_iter().flat_map(|sign| [2, 0, 1].map(|axis| Vector3::ith(axis, sign))) {
            let (mut down, mut sensors) = (start, Vec::new());
            for _ in 0..LEVELLINGS {
                let mut turns = vec![Matrix3::zeros(); data.scene.targets.len()];
                for (row, target, own) in &felt {
                    turns[*target] += tips[*row].rotation.inverse() * down * own.transpose();
                }
                let seen = |turn: &Matrix3<f64>| (*turn != Matrix3::zeros()).then(|| nearest_rotation(turn));
                sensors = turns.iter().map(seen).collect::<Vec<_>>();
                let of = |(row, target, own): &(usize, usize, Vector3<f64>)| {
                    Some(tips[*row].rotation * sensors[*target]? * own)
                };
                let sum: Vector3<f64> = felt.iter().filter_map(of).sum();
                down = sum.try_normalize(0.0).unwrap_or(down);
            }
            let off = |(row, target, own): &(usize, usize, Vector3<f64>)| {
                Some((tips[*row].rotation * sensors[*target]? * own - down).norm_squared())
            };
            let left: f64 = felt.iter().filter_map(off).sum();
            if best.as_ref().is_none_or(|best| left < CLEARLY_BETTER * best.left) {
                best = Some(Levelled { left, down, sensors });
            }
        }
        let Some(Levelled { down, sensors, .. }) = best else { continue };
        arm.instruments[setup] = level(&down);
        for (target, rotation) in arm.targets.iter_mut().zip(sensors) {
            target.rotation = rotation.unwrap_or(target.rotation);
        }
    }
}

/// Possible positions of each point, with this arm's targets.
fn places_of_points(data: &Measurements, tips: &[Pose], arm: &Arm) -> Vec<Vec<Vector3<f64>>> {
    let of_point = |point: usize| {
        let (mut predicted, mut values, mut kind) = (Vec::new(), Vec::new(), None);
        for (row, tip) in tips.iter().enumerate() {
            for observation in data.of_row(row) {
                let series = data.series_of(observation);
                if series.point == Some(point) {
                    predicted.push((tip * Point3::from(arm.targets[series.target].translation.vector)).coords);
                    values.push(data.observed.values(observation));
                    kind = Some(series.kind);
                }
            }
        }
        kind.map_or_else(Vec::new, |kind| model_of(kind).points(&predicted, &values))
    };
    (0..data.scene.points.len()).map(of_point).collect()
}

/// The least squares motion from the first points of the pairs (m) to the second; `None` without pairs.
///
/// # Source
/// Kabsch 1976; Umeyama 1991 for the sign.
pub fn rigid_fit(pairs: &[(Vector3<f64>, Vector3<f64>)]) -> Option<Pose> {
    if pairs.is_empty() {
        return None;
    }
    let count = pairs.len() as f64;
    let from = pairs.iter().map(|pair| pair.0).sum::<Vector3<f64>>() / count;
    let to = pairs.iter().map(|pair| pair.1).sum::<Vector3<f64>>() / count;
    let spread = pairs.iter().map(|pair| (pair.1 - to) * (pair.0 - from).transpose()).sum::<Matrix3<f64>>();
    let rotation = nearest_rotation(&spread);
    Some(se3::pose(rotation, to - rotation * from))
}

fn nearest_rotation(matrix: &Matrix3<f64>) -> Rotation3<f64> {
    let svd = matrix.svd(true, true);
    let (u, v_t) = (svd.u.expect("asked for"), svd.v_t.expect("asked for"));
    let sign = (u * v_t).determinant().signum();
    let mut turned = u;
    let last = svd.singular_values.imin();
    turned.column_mut(last).scale_mut(sign);
    Rotation3::from_matrix_unchecked(turned * v_t)
}

/// 24 rotations of a cube and as many between them.
fn turned_frames() -> Vec<Rotation3<f64>> {
    let quarter = std::f64::consts::FRAC_PI_2;
    let mut frames = Vec::new();
    for yaw in 0..4 {
        for [roll, pitch] in [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [3.0, 0.0], [0.0, 1.0], [0.0, -1.0]] {
            let turn = se3::rotation_from_rpy([roll * quarter, pitch * quarter, f64::from(yaw) * quarter]);
            frames.push(turn);
            frames.push(turn * se3::rotation_from_rpy([0.5 * quarter, 0.5 * quarter, 0.0]));
        }
    }
    frames
}

/// Targets (tip frame) that fit best for an instrument of this rotation: R p + x = m is linear in targets and position.
fn offsets_for(data: &Measurements, tips: &[Pose], rotation: &Rotation3<f64>) -> Vec<Vector3<f64>> {
    let targets = data.scene.targets.len();
    let unknowns = 3 * targets + 3;
    let mut matrix = DMatrix::<f64>::zeros(unknowns, unknowns);
    let mut right = DVector::<f64>::zeros(unknowns);
    for (row, target, measured) in positions(data) {
        let tip = &tips[row];
        let value = measured - rotation * tip.translation.vector;
        let turn = (rotation * tip.rotation).into_inner();
        for i in 0..3 {
            let mut coefficients = DVector::<f64>::zeros(unknowns);
            for k in 0..3 {
                coefficients[3 * target + k] = turn[(i, k)];
            }
            coefficients[3 * targets + i] = 1.0;
            matrix.ger(1.0, &coefficients, &coefficients, 1.0);
            right.axpy(value[i], &coefficients, 1.0);
        }
    }
    let solution = least_squares(matrix, &right);
    (0..targets)
        .map(|target| Vector3::new(solution[3 * target], solution[3 * target + 1], solution[3 * target + 2]))
        .collect()
}

/// Positions of points by their kinds, for targets at the tip and around it.
fn point_guesses<'a>(chain: &'a Chain, data: &'a Measurements, tips: &'a [Pose]) -> impl Iterator<Item = Arm> + 'a {
    let reach = 0.2 * chain.size();
    let mut offsets = vec![Vector3::zeros()];
    for k in 0..3 {
        offsets.push(Vector3::ith(k, reach));
        offsets.push(Vector3::ith(k, -reach));
    }
    offsets.into_iter().flat_map(move |offset| {
        let mut arm = Arm::new(chain, &data.scene);
        arm.targets.iter_mut().for_each(|target| target.translation.vector = offset);
        place_planes(data, tips, &mut arm);
        place_levels(data, tips, &mut arm);
        let places = places_of_points(data, tips, &arm);
        // Planes alone have one position each.
        let most = places.iter().map(Vec::len).max().unwrap_or(1);
        (0..most).map(move |choice| {
            let at = |places: &Vec<Vector3<f64>>| places.get(choice).or(places.first()).copied().unwrap_or_default();
            Arm { points: places.iter().map(at).collect(), ..arm.clone() }
        })
    })
}
