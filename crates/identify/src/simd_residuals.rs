//! Residuals of geometry alone and their derivatives for several rows at a time, the SIMD rows: one in each lane of a SIMD vector.
//!
//! The computation is that of [`ResidualModel::row_into`](crate::residual::ResidualModel::row_into) for poses and positions without effects,
//! arranged for speed. Each joint carries a frame (a, b, axis | centre), see [`AxisBasis`]; the way from one frame to the next
//! is constant, the joint's motion rotates a towards b and shifts the centre along the axis. A change of an axis moves a
//! point p by the difference of its effects before and after the joint's motion:
//!
//! ```text
//! turned about a    (a - a') × (p - c) + (c - c') × a'       moved along a    a - a'         ' after the motion
//! ```

use crate::arm::{Arm, AxisBasis};
use crate::jacobian_block::{JacobianBlock, Triple};
use crate::parameters::{Layout, ParameterKind};
use denavit_measurements::{Measurements, Series};
use denavit_model::compiled::sine_and_cosine;
use denavit_model::nalgebra::{Matrix3, Rotation3, Unit, Vector3};
use denavit_model::{ChainJoint, Pose, Screw, Tip, se3};
use fearless_simd::{Simd, SimdBase as _, SimdFloat as _, SimdMask as _};
use std::ops::Range;

/// Below this sine of a residual's angle, series replace the arcsine and the inverse Jacobian of SO(3), to rounding.
const SMALL: f64 = 0.03;

/// One joint, its frame seen from the frame before.
#[derive(Debug, Clone)]
struct Link {
    here: Pose,
    coordinate: usize,
    scale: f64,
    offset: f64,
    nominal_scale: f64,
    /// m/rad; 0 for prismatic joints, too.
    pitch: f64,
    turns: bool,
}

/// The joints on the way to a tip, by their index among all, and the tip seen from the frame of the last.
#[derive(Debug, Clone)]
struct TipPath {
    links: Vec<(usize, Link)>,
    tip: Pose,
}

/// The arm's numbers as the SIMD residuals need them.
#[derive(Debug, Clone)]
pub(crate) struct Geometry {
    /// To each tip.
    ways: Vec<TipPath>,
    /// Whether each joint turns, and its pitch, m/rad; 0 for prismatic joints, too.
    joints: Vec<(bool, f64)>,
}

impl Geometry {
    /// `None` for an arm without joints, for kinds without SIMD residuals, and where values have different standard deviations.
    pub(crate) fn of(arm: &Arm, bases: &[AxisBasis], data: &Measurements) -> Option<Self> {
        let unknown = data.scene.series.iter().any(|series| !series.kind.has_simd_residuals());
        if arm.joints.is_empty() || unknown || data.observed.has_levels() {
            return None;
        }
        let nominal = arm.nominal.joints();
        let link = |before: &mut Pose, joint: &ChainJoint, nominal: &ChainJoint, basis: &AxisBasis| {
            let axis: Unit<_> = joint.screw.direction();
            let rotation = Matrix3::from_columns(&[basis.a, basis.b, axis.into_inner()]);
            let home = se3::pose(Rotation3::from_matrix_unchecked(rotation), basis.centre.coords);
            let here = before.inverse() * home;
            *before = home;
            Link {
                here,
                coordinate: joint.coordinate,
                scale: joint.scale,
                offset: joint.offset,
                nominal_scale: nominal.scale,
                pitch: joint.screw.pitch().unwrap_or(0.0),
                turns: !matches!(joint.screw, Screw::Prismatic(_)),
            }
        };
        let way = |tip: &Tip| {
            let mut before = Pose::identity();
            let joints = arm.joints.iter().zip(nominal).zip(bases).enumerate();
            let on_the_way = joints.filter(|(index, _)| tip.joints[*index]);
            let of = |(index, ((joint, nominal), basis))| (index, link(&mut before, joint, nominal, basis));
            let links = on_the_way.map(of).collect();
            TipPath { links, tip: before.inverse() * tip.home }
        };
        let shape =
            |joint: &ChainJoint| (!matches!(joint.screw, Screw::Prismatic(_)), joint.screw.pitch().unwrap_or(0.0));
        Some(Self { ways: arm.tips.all().iter().map(way).collect(), joints: arm.joints.iter().map(shape).collect() })
    }
}

/// A frame for each SIMD row: columns of the rotation, and the origin.
#[derive(Clone, Copy)]
struct Frame<S: Simd> {
    x: Triple<S>,
    y: Triple<S>,
    z: Triple<S>,
    origin: Triple<S>,
}

/// A joint for each SIMD row: its frame before the motion, and the change by the motion.
#[derive(Clone, Copy)]
struct Moved<S: Simd> {
    /// Directions a and b before minus after.
    less: [Triple<S>; 2],
    after: [Triple<S>; 2],
    axis: Triple<S>,
    centre: Triple<S>,
    /// Shift of the centre along the axis, m.
    slide: S::f64s,
    value: S::f64s,
    reading: S::f64s,
}

#[inline(always)]
fn each<S: Simd>(of: impl Fn(usize) -> S::f64s) -> Triple<S> {
    [of(0), of(1), of(2)]
}

#[inline(always)]
fn less<S: Simd>(a: Triple<S>, b: Triple<S>) -> Triple<S> {
    each::<S>(|k| a[k] - b[k])
}

#[inline(always)]
fn cross<S: Simd>(a: Triple<S>, b: Triple<S>) -> Triple<S> {
    each::<S>(|k| a[(k + 1) % 3].mul_sub(b[(k + 2) % 3], a[(k + 2) % 3] * b[(k + 1) % 3]))
}

#[inline(always)]
fn dot<S: Simd>(a: Triple<S>, b: Triple<S>) -> S::f64s {
    a[2].mul_add(b[2], a[1].mul_add(b[1], a[0] * b[0]))
}

/// Rows of a matrix for each SIMD row, times a vector.
#[inline(always)]
fn times<S: Simd>(rows: [Triple<S>; 3], x: Triple<S>) -> Triple<S> {
    each::<S>(|k| dot::<S>(rows[k], x))
}

impl<S: Simd> Frame<S> {
    #[inline(always)]
    fn of(simd: S, pose: &Pose) -> Self {
        let splat = |value| S::f64s::splat(simd, value);
        let column = |k: usize| each::<S>(|row| splat(pose.rotation.matrix()[(row, k)]));
        Self { x: column(0), y: column(1), z: column(2), origin: each::<S>(|k| splat(pose.translation.vector[k])) }
    }

    #[inline(always)]
    fn direction(&self, by: [f64; 3]) -> Triple<S> {
        each::<S>(|k| self.z[k].mul_add(by[2], self.y[k].mul_add(by[1], self.x[k] * by[0])))
    }

    #[inline(always)]
    fn point(&self, at: [f64; 3]) -> Triple<S> {
        each::<S>(|k| self.z[k].mul_add(at[2], self.y[k].mul_add(at[1], self.x[k].mul_add(at[0], self.origin[k]))))
    }

    #[inline(always)]
    fn behind(&self, pose: &Pose) -> Self {
        let r = pose.rotation.matrix();
        Self {
            x: self.direction([r[(0, 0)], r[(1, 0)], r[(2, 0)]]),
            y: self.direction([r[(0, 1)], r[(1, 1)], r[(2, 1)]]),
            z: self.direction([r[(0, 2)], r[(1, 2)], r[(2, 2)]]),
            origin: self.point(pose.translation.vector.into()),
        }
    }

    /// Turned about z, shifted along it.
    #[inline(always)]
    fn moved(&self, (sine, cosine): (S::f64s, S::f64s), slide: S::f64s) -> Self {
        Self {
            x: each::<S>(|k| self.y[k].mul_add(sine, self.x[k] * cosine)),
            y: each::<S>(|k| self.y[k].mul_sub(cosine, self.x[k] * sine)),
            z: self.z,
            origin: each::<S>(|k| self.z[k].mul_add(slide, self.origin[k])),
        }
    }
}

/// Computes these rows: squared residuals of their observations into `squares`, the rest into the blocks of the channels.
#[inline(always)]
pub(crate) fn rows<S: Simd>(
    simd: S,
    (geometry, arm, layout, data): (&Geometry, &Arm, &Layout, &Measurements),
    weights: &[f64],
    rows: Range<usize>,
    squares: &mut [[f64; 2]],
    blocks: &mut [JacobianBlock],
) {
    let (simd_rows, observed) = (S::f64s::LEN, &data.observed);
    let zero = S::f64s::splat(simd, 0.0);
    let none = Moved::<S> {
        less: [[zero; 3]; 2],
        after: [[zero; 3]; 2],
        axis: [zero; 3],
        centre: [zero; 3],
        slide: zero,
        value: zero,
        reading: zero,
    };
    let mut joints = vec![none; geometry.joints.len()];
    let instruments: Vec<Pose> = arm.instruments.iter().map(Pose::inverse).collect();
    let first = observed.of_row(rows.start).start;
    for start in rows.clone().step_by(simd_rows) {
        let count = simd_rows.min(rows.end - start);
        let row = |lane: usize| start + lane.min(count - 1);
        for (of_tip, way) in geometry.ways.iter().enumerate() {
            if geometry.ways.len() > 1 {
                if !(0..count).any(|lane| data.tip_of(start + lane) == of_tip) {
                    continue;
                }
                joints.fill(none);
            }
            let tip = walk(simd, way, data, row, &mut joints);
            for (index, series) in data.scene.series.iter().enumerate() {
                if data.scene.tip_of(series.target) != of_tip {
                    continue;
                }
                // The observation of this series in each SIMD row.
                let mut at = [None::<usize>; 8];
                for (lane, at) in at.iter_mut().enumerate().take(count) {
                    *at = observed.of_row(start + lane).find(|&observation| observed.series(observation) == index);
                }
                if at.iter().all(Option::is_none) {
                    continue;
                }
                let weight = S::f64s::from_fn(simd, |lane| at[lane].map_or(0.0, |observation| weights[observation]));
                let number = |k: usize| {
                    S::f64s::from_fn(simd, |lane| at[lane].map_or(0.0, |observation| observed.values(observation)[k]))
                };
                let measured = each::<S>(number);
                let in_base = Frame::<S>::of(simd, &instruments[series.setup]);
                let measured = each::<S>(|k| {
                    let turned =
                        in_base.y[k].mul_add(measured[1], in_base.x[k].mul_add(measured[0], in_base.origin[k]));
                    in_base.z[k].mul_add(measured[2], turned)
                });
                let target = &arm.targets[series.target];
                let predicted = tip.point(target.translation.vector.into());
                let residual = less::<S>(measured, predicted);
                let factor = weight.sqrt();
                let Some(place_block) = series.channels[0].and_then(|channel| blocks.get_mut(channel)) else {
                    continue;
                };
                place_block.take_simd::<S>(residual, factor, |parameter| {
                    let rate = place_rate(simd, geometry, layout.parameters[parameter].kind, &joints, predicted);
                    match rate {
                        Some(rate) => each::<S>(|k| -rate[k]),
                        None => rest_of_place(simd, series, layout.parameters[parameter].kind, measured, &tip),
                    }
                });
                let place = dot::<S>(residual, residual);
                let mut turn = zero;
                if let Some(block) = series.channels[1].and_then(|channel| blocks.get_mut(channel)) {
                    let attitude = tip.behind(&se3::pose(target.rotation, Vector3::zeros()));
                    let measured: [Triple<S>; 3] = std::array::from_fn(|column| {
                        let axis = each::<S>(|k| number(3 + 3 * column + k));
                        each::<S>(|k| {
                            in_base.z[k].mul_add(axis[2], in_base.y[k].mul_add(axis[1], in_base.x[k] * axis[0]))
                        })
                    });
                    let (residual, right) = turned(simd, measured, &attitude);
                    turn = dot::<S>(residual, residual);
                    block.take_simd::<S>(residual, factor, |parameter| {
                        let rate = match layout.parameters[parameter].kind {
                            ParameterKind::Turn { joint, direction } => {
                                times::<S>(right, joints[joint].less[direction])
                            }
                            ParameterKind::Scale { joint } if geometry.joints[joint].0 => {
                                let moved = &joints[joint];
                                let turn = times::<S>(right, moved.axis);
                                each::<S>(|k| turn[k] * moved.reading)
                            }
                            // The left inverse Jacobian is the right one transposed.
                            ParameterKind::Instrument { setup, component } if setup == series.setup => right[component],
                            ParameterKind::TargetTurn { target, component } if target == series.target => {
                                times::<S>(right, [tip.x, tip.y, tip.z][component])
                            }
                            _ => [zero; 3],
                        };
                        each::<S>(|k| -rate[k])
                    });
                }
                let (place, turn) = (place.as_slice(), turn.as_slice());
                for (lane, observation) in at.iter().enumerate().filter_map(|(lane, at)| Some((lane, (*at)?))) {
                    squares[observation - first] = [place[lane], turn[lane]];
                }
            }
        }
    }
}

/// Derivative of a position residual by parameters other than a joint's: of the instrument, which reads `measured` (base
/// frame, m), and of the target.
#[inline(always)]
fn rest_of_place<S: Simd>(
    simd: S,
    series: &Series,
    kind: ParameterKind,
    measured: Triple<S>,
    tip: &Frame<S>,
) -> Triple<S> {
    let zero = S::f64s::splat(simd, 0.0);
    match kind {
        ParameterKind::Instrument { setup, component } if setup == series.setup && component < 3 => {
            let mut e = [zero; 3];
            e[component] = S::f64s::splat(simd, 1.0);
            cross::<S>(measured, e)
        }
        ParameterKind::Instrument { setup, component } if setup == series.setup => {
            let mut e = [zero; 3];
            e[component - 3] = S::f64s::splat(simd, -1.0);
            e
        }
        ParameterKind::Target { target: of, component } if of == series.target => {
            each::<S>(|k| -[tip.x, tip.y, tip.z][component][k])
        }
        _ => [zero; 3],
    }
}

/// From the base to the tip; stores the motion of each joint on the way in `joints`.
#[inline(always)]
fn walk<S: Simd>(
    simd: S,
    way: &TipPath,
    data: &Measurements,
    row: impl Fn(usize) -> usize,
    joints: &mut [Moved<S>],
) -> Frame<S> {
    let mut frame = Frame::<S>::of(simd, &Pose::identity());
    for (index, link) in &way.links {
        let before = frame.behind(&link.here);
        let reading = S::f64s::from_fn(simd, |lane| data.reading(row(lane))[link.coordinate]);
        let value = reading * link.scale + link.offset;
        let (turn, slide) = if link.turns {
            (sine_and_cosine(simd, value), value * link.pitch)
        } else {
            ((S::f64s::splat(simd, 0.0), S::f64s::splat(simd, 1.0)), value)
        };
        frame = before.moved(turn, slide);
        joints[*index] = Moved {
            less: [less::<S>(before.x, frame.x), less::<S>(before.y, frame.y)],
            after: [frame.x, frame.y],
            axis: before.z,
            centre: before.origin,
            slide,
            value,
            reading: reading * link.nominal_scale,
        };
    }
    frame.behind(&way.tip)
}

/// Velocity of the point `p` per unit of a joint's parameter; `None` for other parameters.
#[inline(always)]
fn place_rate<S: Simd>(
    simd: S,
    geometry: &Geometry,
    kind: ParameterKind,
    joints: &[Moved<S>],
    p: Triple<S>,
) -> Option<Triple<S>> {
    Some(match kind {
        ParameterKind::Turn { joint, direction } => {
            let moved = &joints[joint];
            let swung = cross::<S>(moved.less[direction], less::<S>(p, moved.centre));
            // c - c' is minus the slide times the axis.
            let back = cross::<S>(moved.axis, moved.after[direction]);
            each::<S>(|k| back[k].mul_add(-moved.slide, swung[k]))
        }
        ParameterKind::Move { joint, direction } => joints[joint].less[direction],
        ParameterKind::Pitch { joint } => each::<S>(|k| joints[joint].axis[k] * joints[joint].value),
        ParameterKind::Scale { joint } => {
            let (moved, (turns, pitch)) = (&joints[joint], geometry.joints[joint]);
            let swung = cross::<S>(moved.axis, less::<S>(p, moved.centre));
            let (turning, sliding) = if turns { (1.0, pitch) } else { (0.0, 1.0) };
            let (turning, sliding) = (S::f64s::splat(simd, turning), S::f64s::splat(simd, sliding));
            each::<S>(|k| moved.axis[k].mul_add(sliding, swung[k] * turning) * moved.reading)
        }
        _ => return None,
    })
}

/// Rotation vector of measured · predictedᵀ in each SIMD row, and the inverse right Jacobian of SO(3) there, row by row.
#[inline(always)]
fn turned<S: Simd>(simd: S, measured: [Triple<S>; 3], predicted: &Frame<S>) -> (Triple<S>, [Triple<S>; 3]) {
    let axes = [predicted.x, predicted.y, predicted.z];
    let cell = |row: usize, column: usize| {
        let product = |k: usize| measured[k][row] * axes[k][column];
        measured[2][row].mul_add(axes[2][column], measured[1][row].mul_add(axes[1][column], product(0)))
    };
    let sine = [cell(2, 1) - cell(1, 2), cell(0, 2) - cell(2, 0), cell(1, 0) - cell(0, 1)];
    let sine = each::<S>(|k| sine[k] * 0.5);
    let cosine = (cell(0, 0) + cell(1, 1) + cell(2, 2) - 1.0) * 0.5;
    let s2 = dot::<S>(sine, sine);
    let small = s2.simd_le(SMALL * SMALL) & cosine.simd_ge(0.0);
    let (vector, factor) = if small.any_false() {
        let rotation = |lane: usize| {
            let at = |row: usize, column: usize| cell(row, column).as_slice()[lane];
            Rotation3::from_matrix_unchecked(Matrix3::from_fn(at))
        };
        let vectors: [Vector3<f64>; 8] = std::array::from_fn(|lane| {
            if lane < S::f64s::LEN { se3::rotation_vector(&rotation(lane)) } else { Vector3::zeros() }
        });
        let factor = S::f64s::from_fn(simd, |lane| square_factor(vectors[lane].norm_squared()));
        (each::<S>(|k| S::f64s::from_fn(simd, |lane| vectors[lane][k])), factor)
    } else {
        // asin(s)/s, and (1 - t/2 cot(t/2))/t², as series.
        let series = |x: S::f64s, c: [f64; 5]| {
            let sum = S::f64s::splat(simd, c[4]).mul_add(x, c[3]);
            sum.mul_add(x, c[2]).mul_add(x, c[1]).mul_add(x, c[0])
        };
        let stretch = series(s2, [1.0, 1.0 / 6.0, 3.0 / 40.0, 5.0 / 112.0, 35.0 / 1152.0]);
        let vector = each::<S>(|k| sine[k] * stretch);
        let t2 = dot::<S>(vector, vector);
        let factor = series(t2, [1.0 / 12.0, 1.0 / 720.0, 1.0 / 30240.0, 1.0 / 1209600.0, 1.0 / 47900160.0]);
        (vector, factor)
    };
    // I + [r]/2 + factor [r]², [r]² = r rᵀ - |r|² I.
    let t2 = dot::<S>(vector, vector);
    let half = each::<S>(|k| vector[k] * 0.5);
    let diagonal = t2.mul_add(-factor, 1.0);
    let square = |i: usize, k: usize| vector[i] * vector[k] * factor;
    let rows = [
        [square(0, 0) + diagonal, square(0, 1) - half[2], square(0, 2) + half[1]],
        [square(1, 0) + half[2], square(1, 1) + diagonal, square(1, 2) - half[0]],
        [square(2, 0) - half[1], square(2, 1) + half[0], square(2, 2) + diagonal],
    ];
    (vector, rows)
}

/// (1 - t/2 cot(t/2))/t² of the square of an angle t, rad².
pub(crate) fn square_factor(t2: f64) -> f64 {
    let t = t2.sqrt();
    if t < 1e-3 { 1.0 / 12.0 + t2 / 720.0 } else { (1.0 - t * t.sin() / (4.0 * (0.5 * t).sin().powi(2))) / t2 }
}
