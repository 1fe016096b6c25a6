//! Identifiability: the paper's count, the numerical rank, and the names of unidentifiable parameters.

use crate::arm::{Arm, Perturbation, Row, RowState};
use crate::gauge;
use crate::observe::{Seen, model_of};
use crate::parameters::{Effects, Freedom, Layout, Parameter, ParameterKind, Tolerances};
use crate::residual::ResidualModel;
use denavit_measurements::{Measurements, Scene};
use denavit_model::nalgebra::DMatrix;
use denavit_model::{Chain, Screw};
use std::ops::Range;

/// Singular values below this fraction of the largest count as zero, columns scaled to length 1.
///
/// Rounding leaves 1e-13 of the largest; the weakest directions of real runs have 1e-5.
pub const RANK_TOLERANCE: f64 = 1e-9;
/// A parameter is named if more than this fraction (squared) lies in unidentifiable directions.
const NAMED_SHARE: f64 = 0.2;
/// Number of rows of the data, and of the stacked Jacobian, reduced at a time.
const CHUNK: usize = 1024;

/// The number of a chain's parameters, and which of them the data determine.
#[derive(Debug, Clone, PartialEq)]
pub struct Identifiability {
    /// What is measured.
    pub scene: Scene,
    /// The count for enough poses in general position: 5h + 4r + 2t + n plus the unknowns beyond the arm, minus 6 for each
    /// unobservable frame: 6 for poses, 3 per target for positions, none for distances from one anchor.
    pub expected: usize,
    /// The count as a sum, such as `4·6 + 6`.
    pub formula: String,
    /// Rank of the residuals' Jacobian.
    pub rank: usize,
    /// Smallest singular value that counts, relative to the largest; columns scaled to length 1.
    pub smallest: f64,
    /// The parameters that are not identifiable.
    pub unidentifiable: Vec<UnidentifiableParameter>,
}

/// A parameter that the data cannot determine.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct UnidentifiableParameter {
    /// The parameter's name.
    pub parameter: String,
    /// The joint that it belongs to; empty for other parameters.
    pub joint: String,
    /// Why it is not identifiable.
    pub why: String,
}

/// 5h + 4r + 2t + n plus what the measurement adds, and the sum as text.
///
/// # Source
/// Wu, Crawford, Roberts 2019, eq. (23), for poses. With positions only the target's position remains of the tool; with
/// distances the six numbers of target and anchor cancel the unobservable frame.
pub fn expected(chain: &Chain, scene: &Scene, freedom: &Freedom) -> (usize, String) {
    if freedom.zeros_alone() {
        let layout = Layout::new(chain, scene, freedom, &Tolerances::default(), Vec::new());
        let (own, all) = (layout.joints.len(), layout.len());
        return (all, format!("{own} + {}", all - own));
    }
    let count = |wanted: fn(&Screw) -> bool| chain.joints().iter().filter(|joint| wanted(&joint.screw)).count();
    let helical = count(|screw| matches!(screw, Screw::Helical { .. }));
    let revolute = count(|screw| matches!(screw, Screw::Revolute(_)));
    let prismatic = count(|screw| matches!(screw, Screw::Prismatic(_)));
    let scales = freedom.scales.iter().filter(|free| **free).count();
    // Directions alone do not determine the position of an axis or a frame.
    let turned_alone = scene.kinds().iter().all(|kind| kind.is_turned_alone());
    let pitches = chain
        .joints()
        .iter()
        .zip(&freedom.pitches)
        .filter(|(joint, free)| **free && !turned_alone && matches!(joint.screw, Screw::Revolute(_)))
        .count();
    let placed =
        Layout::new(chain, scene, &Freedom::placement(chain.joints().len()), &Tolerances::default(), Vec::new());
    let rest = placed.len().saturating_sub(if turned_alone { 3 } else { 6 } * placed.frames.count);
    let targets = scene.targets.len();
    let word = if rest == 3 * targets && !(0..targets).any(|target| scene.turns(target)) {
        format!("3·{targets}")
    } else {
        rest.to_string()
    };
    let mut terms = Vec::new();
    let axes = if turned_alone {
        [(2, helical), (2, revolute), (0, prismatic)]
    } else {
        [(5, helical), (4, revolute), (2, prismatic)]
    };
    for (factor, number) in axes {
        if factor * number > 0 {
            terms.push(format!("{factor}·{number}"));
        }
    }
    if scales + pitches > 0 {
        terms.push((scales + pitches).to_string());
    }
    if rest > 0 {
        terms.push(word);
    }
    let axes: usize = axes.iter().map(|(factor, number)| factor * number).sum();
    (axes + scales + pitches + rest, terms.join(" + "))
}

/// Identifiability by the rows of `data` at this state of the arm; measured values do not matter.
pub fn identifiability<E: Effects>(data: &Measurements, arm: &Arm, effects: &E, freedom: &Freedom) -> Identifiability {
    let layout = Layout::new(&arm.nominal, &data.scene, freedom, &Tolerances::default(), effects.parameters());
    let (expected, formula) = expected(&arm.nominal, &data.scene, freedom);
    let expected = expected + layout.effects.len();
    let triangle = triangle(data, &layout, arm, effects);
    let unread = data.scene.kinds().iter().any(|kind| kind.numbers() == 0);
    let triangle = if unread && layout.axes_are_free() {
        orthogonal_to(&triangle, &gauge::common_motions(&layout, arm))
    } else {
        triangle
    };
    let analysis = analyse(&triangle, &gauge::conditions(&layout, arm));
    let unidentifiable = name(&layout, data, arm, &analysis);
    Identifiability {
        scene: data.scene.clone(),
        expected,
        formula,
        rank: analysis.rank,
        smallest: analysis.smallest,
        unidentifiable,
    }
}

/// The rows with the arm's predictions instead of measured values.
fn predicted<E: Effects>(data: &Measurements, rows: Range<usize>, arm: &Arm, effects: &E) -> Measurements {
    let mut predicted = data.subset(&rows.collect::<Vec<usize>>());
    let (mut state, mut perturbation) = (RowState::default(), Perturbation::none(arm.joints.len()));
    let (mut standing, mut values) = (effects.standing(arm), Vec::new());
    for row in 0..predicted.len() {
        perturbation.clear();
        effects.perturb(Row::new(&predicted, row), arm, &mut standing, &mut perturbation);
        arm.state_into(predicted.reading(row), predicted.tip_of(row), Some(&perturbation), &mut state);
        for observation in predicted.of_row(row) {
            let (series, measured) = (predicted.series_of(observation), predicted.observed.values(observation));
            values.clear();
            model_of(series.kind)
                .predict(&Seen::new(arm, &state.tip, &perturbation, series, measured, false), &mut values);
            predicted.observed.values_mut(observation).copy_from_slice(&values);
        }
    }
    predicted
}

/// Upper triangle R of the stacked Jacobian, J = Q R, reduced chunk by chunk.
///
/// With residuals of 0 the common frame is exactly free; measured residuals would constrain it.
fn triangle<E: Effects>(data: &Measurements, layout: &Layout, arm: &Arm, effects: &E) -> DMatrix<f64> {
    let columns = layout.len();
    let height = data.tallest_row();
    let mut scratch = ResidualModel { data, layout, effects }.scratch(arm);
    let (mut residual, mut jacobian) = (vec![0.0; height], vec![0.0; height * columns]);
    let mut pending: Vec<f64> = Vec::new();
    let mut triangle = DMatrix::<f64>::zeros(0, columns);
    for known in layout.known_lengths(&data.scene, arm) {
        let start = pending.len();
        pending.resize(start + columns, 0.0);
        known.columns.iter().for_each(|(column, value)| pending[start + column] = *value);
    }
    for from in (0..data.len()).step_by(CHUNK) {
        let to = data.len().min(from + CHUNK);
        let part = predicted(data, from..to, arm, effects);
        let problem = ResidualModel { data: &part, layout, effects };
        for row in 0..part.len() {
            problem.row_into(arm, row, &mut scratch, &mut residual, Some(&mut jacobian));
            pending.extend_from_slice(&jacobian[..problem.height_of(row) * columns]);
            if pending.len() < CHUNK * columns && from + row + 1 < data.len() {
                continue;
            }
            let chunk = DMatrix::from_row_slice(pending.len() / columns, columns, &pending);
            pending.clear();
            triangle = stacked(&triangle, &chunk).qr().r();
        }
    }
    triangle
}

fn stacked(above: &DMatrix<f64>, below: &DMatrix<f64>) -> DMatrix<f64> {
    let mut matrix = DMatrix::zeros(above.nrows() + below.nrows(), below.ncols());
    matrix.rows_mut(0, above.nrows()).copy_from(above);
    matrix.rows_mut(above.nrows(), below.nrows()).copy_from(below);
    matrix
}

/// A Jacobian that is invariant to these motions: without readings no prediction makes the residuals 0, and the remaining residuals
/// would constrain the common frame.
fn orthogonal_to(triangle: &DMatrix<f64>, motions: &DMatrix<f64>) -> DMatrix<f64> {
    let basis = motions.clone().qr().q();
    triangle - triangle * &basis * basis.transpose()
}

struct Analysis {
    rank: usize,
    smallest: f64,
    /// Per parameter, its fraction in directions that neither the data nor the common frame's conditions determine.
    shares: Vec<f64>,
    /// The directions themselves, columns, scaled.
    directions: DMatrix<f64>,
}

fn analyse(triangle: &DMatrix<f64>, conditions: &DMatrix<f64>) -> Analysis {
    let columns = triangle.ncols();
    let scale: Vec<f64> =
        triangle.column_iter().map(|column| if column.norm() > 0.0 { column.norm().recip() } else { 1.0 }).collect();
    if !triangle.iter().chain(conditions).all(|value| value.is_finite()) {
        // The search for singular values does not end on overflowed numbers.
        return Analysis {
            rank: 0,
            smallest: 0.0,
            shares: vec![1.0; columns],
            directions: DMatrix::identity(columns, columns),
        };
    }
    let mut scaled = triangle.clone();
    for (mut column, s) in scaled.column_iter_mut().zip(&scale) {
        column.scale_mut(*s);
    }
    let values = scaled.singular_values();
    let largest = values.max();
    let identifiable = || values.iter().copied().filter(|value| *value > RANK_TOLERANCE * largest);
    let rank = identifiable().count();
    let smallest = identifiable().fold(f64::INFINITY, f64::min) / largest;
    // Conditions as further rows, with the weight of data, so that the common frame does not count as unidentifiable.
    let mut held = conditions.transpose();
    for (mut column, s) in held.column_iter_mut().zip(&scale) {
        column.scale_mut(*s);
    }
    for mut row in held.row_iter_mut() {
        let norm = row.norm();
        if norm > 0.0 {
            row.scale_mut(largest / norm);
        }
    }
    let mut all = stacked(&scaled, &held);
    if all.nrows() < columns {
        all = stacked(&all, &DMatrix::zeros(columns - all.nrows(), columns));
    }
    let svd = all.svd(false, true);
    let v_t = svd.v_t.expect("these singular vectors were asked for");
    let unidentifiable: Vec<usize> =
        (0..columns).filter(|&k| svd.singular_values[k] <= 1e3 * RANK_TOLERANCE * largest).collect();
    let directions = DMatrix::from_fn(columns, unidentifiable.len(), |row, k| v_t[(unidentifiable[k], row)]);
    let shares = (0..columns).map(|row| directions.row(row).norm_squared()).collect();
    Analysis { rank, smallest, shares, directions }
}

fn name(layout: &Layout, data: &Measurements, arm: &Arm, analysis: &Analysis) -> Vec<UnidentifiableParameter> {
    let joints = arm.nominal.joints();
    let still: Vec<bool> = joints.iter().map(|joint| data.never_moves(joint.coordinate)).collect();
    let joint_name = |parameter: &Parameter| parameter.kind.joint().map_or(String::new(), |k| joints[k].name.clone());
    let mut unidentifiable = Vec::new();
    for (index, parameter) in layout.parameters.iter().enumerate() {
        // The motion of other joints also determines a zero.
        let of_zero = matches!(parameter.kind, ParameterKind::Zero { .. });
        let of_still_joint = !of_zero && parameter.kind.joint().is_some_and(|joint| still[joint]);
        let why = if let Some(joint) = parameter.kind.joint().filter(|_| of_still_joint) {
            let at = data.reading(0)[joints[joint].coordinate];
            format!("the joint never moves: its reading is {at} in every row")
        } else if analysis.shares[index] > NAMED_SHARE && (of_zero || !still.contains(&true)) {
            why_mixed(layout, analysis, index)
        } else {
            continue;
        };
        unidentifiable.push(UnidentifiableParameter {
            parameter: parameter.name.clone(),
            joint: joint_name(parameter),
            why,
        });
    }
    unidentifiable
}

/// The parameters that share an unidentifiable direction with this one.
fn why_mixed(layout: &Layout, analysis: &Analysis, index: usize) -> String {
    let own = analysis.directions.row(index);
    let mut partners: Vec<(f64, usize)> = (0..layout.len())
        .filter(|&other| other != index)
        .map(|other| (analysis.directions.row(other).dot(&own).abs(), other))
        .filter(|(weight, _)| *weight > 0.3 * own.norm_squared())
        .collect();
    if partners.is_empty() {
        return "it moves no row".into();
    }
    partners.sort_by(|a, b| b.0.total_cmp(&a.0));
    let names: Vec<&str> = partners.iter().take(3).map(|(_, other)| layout.parameters[*other].name.as_str()).collect();
    let more = if partners.len() > 3 { format!(" and {} more", partners.len() - 3) } else { String::new() };
    format!("indistinguishable in these data from {}{more}", names.join(", "))
}

/// Whether a parameter belongs to the robot, not to how it is measured.
pub fn of_robot(kind: ParameterKind) -> bool {
    kind.joint().is_some() || matches!(kind, ParameterKind::Effect { .. })
}
