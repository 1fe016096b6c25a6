//! The prior of a robot before it is measured: its links are machined to a tolerance, its zeros are set by hand.
//!
//! An axis is on a link, that link on the axis before it. So errors add up along the chain: with δk the error of
//! link k, ok the error of joint k's zero, Sk its screw,
//!
//! ```text
//! perturbation of axis i = across_i( base + Σ_{k ≤ i} δk + Σ_{k < i} ok Sk )
//! ```
//! with sums over the joints that carry axis i: in a tree those on the way to it.
//! δk turns by `turn` about three axes through axis k's centre and shifts by `shift`; the base has no prior.
//! The prior is normal with the resulting covariance. Its weight relative to the data depends on their noise: where the data
//! determine a direction well it changes nothing, where they do not it keeps to the drawing, and without noise it
//! vanishes. Independent priors of the axes would be wrong: a zero that is off by 10 mrad turns all axes after it, as
//! everyone knows who masters robots.
//!
//! An arm that was calibrated before, or whose siblings were, is known better than that: identified parameters have their
//! earlier mean and covariance, all others the drawing's prior given those.

use crate::arm::AxisBasis;
use crate::frames::Frames;
use crate::parameter::{Parameter, ParameterKind, Tolerances};
use crate::symmetric;
use denavit_model::nalgebra::{DMatrix, DVector, Vector3, Vector6};
use denavit_model::{Chain, Quantity};

/// Standard deviation of the base, rad and m: practically no prior.
const BASE: f64 = 1.0;

/// Coordinates of a twist `[omega; v]` (base frame) in the direction that a parameter changes; 0 for pitch and scale.
fn change_in_basis(parameter: &Parameter, bases: &[AxisBasis], twist: &Vector6<f64>) -> f64 {
    let omega = Vector3::new(twist[0], twist[1], twist[2]);
    match parameter.kind {
        ParameterKind::Turn { joint, direction } => {
            omega.dot(if direction == 0 { &bases[joint].a } else { &bases[joint].b })
        }
        ParameterKind::Move { joint, direction } => {
            let at_centre = Vector3::new(twist[3], twist[4], twist[5]) + omega.cross(&bases[joint].centre.coords);
            at_centre.dot(if direction == 0 { &bases[joint].a } else { &bases[joint].b })
        }
        _ => 0.0,
    }
}

fn about(point: &Vector3<f64>, omega: Vector3<f64>, shift: Vector3<f64>) -> Vector6<f64> {
    let v = point.cross(&omega) + shift;
    Vector6::new(omega.x, omega.y, omega.z, v.x, v.y, v.z)
}

/// Standard deviation of a common motion of all axes, rad and m: the frame holds this motion, not the earlier measurement. The
/// number changes no result.
const COMMON: f64 = 0.03;
/// A common motion with less resistance than this does not move a direction.
const MOVES_NOTHING: f64 = 1e-9;
/// Smallest standard deviation of a parameter, as a fraction of its tolerance: it keeps the covariance invertible.
const BEST_KNOWN: f64 = 1e-6;

/// Standard deviation of ln κ, κ the ratio of a robot's errors to its tolerances.
pub const SHARE_USED: f64 = 0.7;

/// The prior of the joints' parameters: a normal distribution.
#[derive(Debug, Clone, PartialEq)]
pub struct Prior {
    /// Mean deviation from the drawing, in the parameters' units: 0 where nothing was measured before.
    pub mean: DVector<f64>,
    /// Inverse covariance, in units of 1 over the parameters' units.
    pub precision: DMatrix<f64>,
    /// Inverse covariance by the drawing's tolerances alone.
    pub of_drawing: DMatrix<f64>,
    /// Covariance by the drawing's tolerances alone, in tolerances.
    drawn: DMatrix<f64>,
    /// Ratio of the expected variance to that of the drawing's tolerances, without an earlier measurement.
    pub widened: f64,
}

/// Prior knowledge of some parameters, in their order: index among the layout's parameters, mean, covariance.
#[derive(Debug, Clone, PartialEq)]
pub struct KnownBefore {
    /// Indices among the joints' parameters of a layout, each once.
    pub indices: Vec<usize>,
    /// Mean deviation from the drawing, in the parameters' units.
    pub mean: DVector<f64>,
    /// Covariance, in the parameters' units; 0 in directions in which the common frame was held.
    pub covariance: DMatrix<f64>,
    /// Its weight, from 0 to 1.
    pub weight: f64,
}

impl Prior {
    /// By the drawing's tolerances.
    pub fn of_drawing(
        chain: &Chain,
        parameters: &[Parameter],
        bases: &[AxisBasis],
        frames: &Frames,
        tolerances: &Tolerances,
    ) -> Self {
        let drawn = covariance_of_drawing(chain, parameters, bases, frames, tolerances);
        let precision = precise(&drawn, parameters);
        Self { mean: DVector::zeros(parameters.len()), of_drawing: precision.clone(), precision, drawn, widened: 1.0 }
    }

    /// The same where some of the parameters were identified before.
    ///
    /// With K those known before, μ and C their mean and covariance, U all others and D the drawing's covariance,
    /// U = A K + e, A = D_UK D_KK⁻¹, e with the covariance D_UU - A D_KU. The earlier rows count with the power `weight` in the
    /// likelihood: precision w P + (1 - w) P_drawing (Ibrahim and Chen 2000, Statistical Science 15, 46).
    #[must_use]
    pub fn knowing(self, parameters: &[Parameter], bases: &[AxisBasis], frames: &Frames, before: &KnownBefore) -> Self {
        let count = parameters.len();
        let drawn = &self.drawn;
        let known = &before.indices;
        let others: Vec<usize> = (0..count).filter(|index| !known.contains(index)).collect();
        let block = |rows: &[usize], columns: &[usize]| drawn.select_rows(rows).select_columns(columns);
        let unit = |index: usize| parameters[index].tolerance.unwrap_or(1.0);
        let mut covariance = DMatrix::from_fn(known.len(), known.len(), |i, k| {
            before.covariance[(i, k)] / (unit(known[i]) * unit(known[k]))
        });
        for (frame, twist) in common_motions(frames) {
            let moved = moved_by(&twist, parameters, bases, |joint| frames.joints[joint] == frame);
            let own = DVector::from_iterator(known.len(), known.iter().map(|&index| moved[index] * COMMON));
            covariance += &own * own.transpose();
        }
        for i in 0..known.len() {
            covariance[(i, i)] += BEST_KNOWN.powi(2);
        }
        let inverse = symmetric::inverse(&block(known, known), BEST_KNOWN.powi(2));
        let along = block(&others, known) * inverse;
        let rest = block(&others, &others) - &along * block(known, &others);
        let cross = &along * &covariance;
        let own = &cross * along.transpose() + rest;
        let mut all = DMatrix::zeros(count, count);
        let mut place = |rows: &[usize], columns: &[usize], values: &DMatrix<f64>| {
            for (i, &row) in rows.iter().enumerate() {
                for (k, &column) in columns.iter().enumerate() {
                    all[(row, column)] = values[(i, k)];
                    all[(column, row)] = values[(i, k)];
                }
            }
        };
        place(known, known, &covariance);
        place(&others, known, &cross);
        place(&others, &others, &own);
        let scaled = DVector::from_fn(known.len(), |i, _| before.mean[i] / unit(known[i]));
        let expected = &along * &scaled;
        let mut mean = DVector::zeros(count);
        for (i, &index) in known.iter().enumerate() {
            mean[index] = before.mean[i];
        }
        for (i, &index) in others.iter().enumerate() {
            mean[index] = expected[i] * unit(index);
        }
        let full = precise(&all, parameters);
        let precision = &full * before.weight + &self.of_drawing * (1.0 - before.weight);
        let pull = &full * mean * before.weight;
        let mean = covariance_of(&precision, parameters) * pull;
        Self { mean, precision, ..self }
    }

    /// Covariance of the parameters, in their units.
    pub fn covariance(&self, parameters: &[Parameter]) -> DMatrix<f64> {
        covariance_of(&self.precision, parameters)
    }

    /// By the drawing's tolerances, their variance `widened` times as large.
    #[must_use]
    pub fn with_variance(self, widened: f64) -> Self {
        Self { precision: &self.of_drawing / widened, widened, ..self }
    }

    /// Whether the prior comes from the drawing alone.
    pub fn is_of_drawing(&self) -> bool {
        self.precision == &self.of_drawing / self.widened
    }
}

/// For each frame, rotations about the base's axes and shifts along them, by 1 rad and 1 m.
fn common_motions(frames: &Frames) -> impl Iterator<Item = (usize, Vector6<f64>)> {
    (0..frames.count).flat_map(|frame| (0..6).map(move |k| (frame, Vector6::ith(k, 1.0))))
}

/// Change of each parameter by a twist of some joints' axes, in tolerances.
fn moved_by(
    twist: &Vector6<f64>,
    parameters: &[Parameter],
    bases: &[AxisBasis],
    carried: impl Fn(usize) -> bool,
) -> Vec<f64> {
    let of = |parameter: &Parameter| {
        let along = parameter.kind.joint().is_some_and(&carried);
        if along { change_in_basis(parameter, bases, twist) / parameter.tolerance.unwrap_or(1.0) } else { 0.0 }
    };
    parameters.iter().map(of).collect()
}

/// Inverse of a covariance in tolerances, in units of 1 over the parameters' units.
fn precise(covariance: &DMatrix<f64>, parameters: &[Parameter]) -> DMatrix<f64> {
    let count = parameters.len();
    let unit = |index: usize| parameters[index].tolerance.unwrap_or(1.0);
    let mut precision = symmetric::inverse(covariance, BEST_KNOWN.powi(2));
    for i in 0..count {
        for k in 0..count {
            precision[(i, k)] /= unit(i) * unit(k);
        }
    }
    precision
}

/// Inverse of a precision in units of 1 over the parameters' units.
pub fn covariance_of(precision: &DMatrix<f64>, parameters: &[Parameter]) -> DMatrix<f64> {
    let unit = |index: usize| parameters[index].tolerance.unwrap_or(1.0);
    let count = parameters.len();
    let scaled = DMatrix::from_fn(count, count, |i, k| precision[(i, k)] * unit(i) * unit(k));
    let inverse = symmetric::inverse(&scaled, 0.0);
    DMatrix::from_fn(count, count, |i, k| inverse[(i, k)] * unit(i) * unit(k))
}

/// Directions of the joints' parameters, in tolerances, orthogonal to common motions of a frame's axes: orthonormal columns.
pub fn free_of_common_motions(parameters: &[Parameter], bases: &[AxisBasis], frames: &Frames) -> DMatrix<f64> {
    let count = parameters.len();
    let mut moved = DMatrix::<f64>::zeros(count, 6 * frames.count);
    for (mut column, (frame, twist)) in moved.column_iter_mut().zip(common_motions(frames)) {
        column.copy_from_slice(&moved_by(&twist, parameters, bases, |joint| frames.joints[joint] == frame));
    }
    let largest = moved.column_iter().map(|column| column.norm()).fold(f64::MIN_POSITIVE, f64::max);
    for mut column in moved.column_iter_mut() {
        let size = column.norm();
        column.scale_mut(if size > MOVES_NOTHING * largest { size.recip() } else { 0.0 });
    }
    let eigen = (&moved * moved.transpose()).symmetric_eigen();
    let free: Vec<usize> = (0..count).filter(|&k| eigen.eigenvalues[k] < MOVES_NOTHING).collect();
    eigen.eigenvectors.select_columns(&free)
}

/// A possible error of a robot, and the change of the joints' parameters by it.
#[derive(Debug, Clone, PartialEq)]
pub struct Source {
    /// Its kind.
    pub of: SourceKind,
    /// Change of each parameter by one standard deviation of the error, in tolerances.
    pub moved: DVector<f64>,
}

/// A kind of error of a robot: the errors of one kind are equally large.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum SourceKind {
    /// The direction of an axis on the link that carries it.
    Turn,
    /// Its position.
    Shift,
    /// The zero of a joint.
    Zero,
    /// Pitches, scales, and zeros that are parameters of their own.
    Ratio,
}

/// All possible errors of a robot except its base, by the drawing's tolerances.
pub fn sources(
    chain: &Chain,
    parameters: &[Parameter],
    bases: &[AxisBasis],
    frames: &Frames,
    tolerances: &Tolerances,
) -> Vec<Source> {
    let mut sources = Vec::new();
    for (i, parameter) in parameters.iter().enumerate() {
        let by_itself = |kind| {
            matches!(kind, ParameterKind::Pitch { .. } | ParameterKind::Scale { .. } | ParameterKind::Zero { .. })
        };
        if by_itself(parameter.kind) {
            let moved = DVector::from_fn(parameters.len(), |k, _| if k == i { 1.0 } else { 0.0 });
            sources.push(Source { of: SourceKind::Ratio, moved });
        }
    }
    let mut add = |of: SourceKind, twist: &Vector6<f64>, deviation: f64, carried: &dyn Fn(usize) -> bool| {
        let moved = DVector::from_vec(moved_by(twist, parameters, bases, carried)) * deviation;
        sources.push(Source { of, moved });
    };
    for (index, joint) in chain.joints().iter().enumerate() {
        let centre = bases[index].centre.coords;
        for k in 0..3 {
            let e = Vector3::ith(k, 1.0);
            let on_it = |joint| frames.carries(index, joint);
            add(SourceKind::Turn, &about(&centre, e, Vector3::zeros()), tolerances.turn, &on_it);
            add(SourceKind::Shift, &about(&centre, Vector3::zeros(), e), tolerances.shift, &on_it);
        }
        let slides = chain.coordinates()[joint.coordinate].quantity == Quantity::Length;
        let zero = if slides { tolerances.zero_slide } else { tolerances.zero_turn };
        add(SourceKind::Zero, &joint.screw.twist(), zero, &|other| other > index && frames.carries(index, other));
    }
    sources
}

/// Covariance of the joints' parameters by the drawing, in tolerances, so that rad and m mix well.
fn covariance_of_drawing(
    chain: &Chain,
    parameters: &[Parameter],
    bases: &[AxisBasis],
    frames: &Frames,
    tolerances: &Tolerances,
) -> DMatrix<f64> {
    let base = common_motions(frames).map(|(frame, twist)| {
        DVector::from_vec(moved_by(&twist, parameters, bases, |joint| frames.joints[joint] == frame)) * BASE
    });
    let sources = sources(chain, parameters, bases, frames, tolerances).into_iter().map(|source| source.moved);
    let mut covariance = DMatrix::<f64>::zeros(parameters.len(), parameters.len());
    for moved in base.chain(sources) {
        covariance += &moved * moved.transpose();
    }
    covariance
}
