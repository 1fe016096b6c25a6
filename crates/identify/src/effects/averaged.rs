//! The recommended prediction: the posterior mean of everything that may act, blended with geometry alone posture by posture.
//!
//! ```text
//! base_from_tip = T_g exp(h log(T_g⁻¹ T_a)),     h = v_g / (v_g + v(q))
//! ```
//! T_g: the robot with its geometry alone, T_a: with all effects at their posterior mean, v(q): posterior variance of the target's reading
//! at q, v_g: mean square error of geometry alone on left-out postures (each left out once). Among the fitted postures h is near 1,
//! far from them near 0. Outside the measured ranges the drawing T_n is blended in, too, where the expected error of that blend (v) is far
//! larger than that of the drawing (v_n): a fraction v²/(v² + `FAR_MORE`⁴ v_n²).

pub mod written;

use crate::arm::{AlongSight, Arm, Perturbation, Perturbed, Row, RowState};
use crate::effects::driver::{Conditions, Driver};
use crate::effects::everything::Everything;
use crate::effects::model::{Effect, EffectModel, Standing};
use crate::effects::written::named;
use crate::parameters::{Effects, Parameter, Sensitivity};
use denavit_linear::triangle::dot;
use denavit_measurements::{Column, Measurements, MissingColumn};
use denavit_model::nalgebra::{DMatrix, Point3, Vector3, Vector6};
use denavit_model::{Pose, se3};
use std::sync::Arc;

/// Outside the measured ranges the drawing has half the weight where the expected error of the blend is this many times the drawing's error
/// among the measured postures. A value of 1 did harm on a Barrett WAM: a third of its draws of 15 rows were worse than geometry alone.
pub const FAR_MORE: f64 = 4.0;

/// An averaged prediction.
#[derive(Debug, Clone, PartialEq)]
pub struct Averaged {
    /// Everything that may act on the drawn robot, its geometry included, at the posterior mean; columns are given by name.
    pub effects: Vec<Effect<Driver<String>>>,
    /// For each effect the mean of its driver over the fitted rows, used where the driver is not recorded.
    pub averages: Vec<Vec<f64>>,
    /// The same bound to columns, with the curves of the joints.
    model: Everything,
    /// The same with these means for drivers that depend on the clock.
    timeless: Everything,
    /// Further data of the prediction: large, and the same for all rows.
    pub known: Arc<Known>,
}

/// Data of an averaged prediction other than its mean.
#[derive(Debug, Clone, PartialEq)]
pub struct Known {
    /// The robot as drawn.
    pub drawn: Arm,
    /// The robot with its geometry alone, which the blend corrects.
    pub geometric: Arm,
    /// The base of the averaged robot, in the base frame of the geometric one.
    pub base: Pose,
    /// For each tip its poses by the rows.
    pub tips: Vec<KnownTip>,
    /// instrument_from_base of the averaged robot, for an instrument with a frame: the uncertainty includes its frame, its scale and
    /// its errors along the line of sight.
    pub instrument: Option<Pose>,
    /// Covariance of everything.
    pub spread: Spread,
    /// Covariance of geometry alone.
    pub geometric_spread: Spread,
    /// The base of the drawn robot, in the base frame of the geometric one, by the rows.
    pub drawn_base: Pose,
    /// Mean square error of the drawing, m².
    pub of_drawing: f64,
    /// Prior variance of a joint's curve, rad² or m², which applies outside the interval of its waves.
    pub of_curves: f64,
    /// v_g, m².
    pub of_geometry: f64,
    /// Median variance of geometry alone at the fitted rows, m², included in v_g.
    pub geometry_among_rows: f64,
    /// Ratio of the variance of the target's position to that of its reading: a distance does not constrain directions across it. 1 where
    /// the whole position is read.
    pub across: f64,
    /// Factor on expected squares with which 95 % of the left-out values lie within 1.96 standard deviations.
    pub calibrated: f64,
    /// Mean variance of a measured value about the prediction over the fitted rows, m²: instrument noise and joint repeatability.
    pub noise: f64,
    /// Lowest and highest reading of each coordinate among the fitted rows, rad or m.
    pub ranges: Vec<(f64, f64)>,
}

/// A tip, placed by the rows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KnownTip {
    /// The averaged robot's tip, in the tip frame of the geometric one.
    pub averaged: Pose,
    /// The drawn robot's tip, in the tip frame of the geometric one.
    pub drawn: Pose,
    /// Point at which errors are evaluated: tip frame, m.
    pub target: Vector3<f64>,
}

/// A covariance of some numbers.
#[derive(Debug, Clone, PartialEq)]
pub struct Spread {
    /// Which of the model's numbers have an uncertainty; after them come, in this order, the instrument's frame (six numbers, where
    /// there is one) and the position of each tip's target (three).
    pub kept: Vec<usize>,
    /// Their covariance.
    pub covariance: DMatrix<f64>,
}

/// An averaged prediction in one posture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Blend {
    /// Weights of the averaged and of the drawn robot; the rest is the geometric robot's.
    pub shares: [f64; 2],
    /// Expected square error of the blend, m² per axis: that of a mixture, Σ wᵢ (vᵢ + dᵢ²), dᵢ the distance of each from the blend.
    pub variance: f64,
    /// The same for a reading that is one length.
    pub of_length: f64,
}

impl Averaged {
    /// With everything at its mean. `statics` and curves are those of `mean`.
    pub fn new(mean: Everything, averages: Vec<Vec<f64>>, known: Known) -> Self {
        let effects = mean.0.effects.iter().map(|effect| named(effect, &mean.0.statics.chain)).collect();
        let timeless = timeless(&mean, &averages);
        Self { effects, averages, model: mean, timeless, known: Arc::new(known) }
    }

    /// From a file: no columns are bound yet.
    pub fn unbound(
        model: EffectModel,
        effects: Vec<Effect<Driver<String>>>,
        averages: Vec<Vec<f64>>,
        known: Known,
    ) -> Self {
        let model = Everything(model);
        Self { effects, averages, timeless: model.clone(), model, known: Arc::new(known) }
    }

    /// The model at its mean.
    pub fn mean(&self) -> &EffectModel {
        &self.model.0
    }

    /// For rows with the columns of `column`: quantities that are not recorded take their mean.
    #[must_use]
    pub fn bound(&self, column: &dyn Fn(&str) -> Result<Column, MissingColumn>) -> Self {
        let bound = |(effect, averages): (&Effect<Driver<String>>, &Vec<f64>)| {
            let driver = effect.term.driver.named_by(|name| column(name));
            effect.with_driver(driver.unwrap_or_else(|_| Driver::Fixed(averages.clone())))
        };
        let effects = self.effects.iter().zip(&self.averages).map(bound).collect();
        let model = Everything(EffectModel { effects, ..self.model.0.clone() });
        Self { timeless: timeless(&model, &self.averages), model, ..self.clone() }
    }

    /// Names of all quantities that it depends on; none of them is required.
    pub fn follows(&self) -> impl Iterator<Item = &String> {
        self.effects.iter().flat_map(|effect| effect.term.driver.columns())
    }

    /// The part of its state that is the same for all rows.
    pub(super) fn at_home(&self) -> Standing {
        self.model.0.standing_of(&self.known.drawn.joints)
    }

    /// The robot under these conditions: geometry alone, everything averaged, the drawing, and their variances.
    fn robots(&self, conditions: &Conditions<'_>, standing: &mut Standing) -> Robots {
        let Known { drawn, geometric, base, .. } = &*self.known;
        let KnownTip { averaged: tip, drawn: drawn_tip, target: judged } = &self.known.tips[conditions.tip];
        let beyond = self.model.0.effects.iter().any(|effect| match &effect.term.driver {
            Driver::Smooth { covariate, knots } => {
                let (value, last) = (conditions.recorded.value(covariate), knots.len() - 1);
                let step = (knots[last] - knots[0]) / last as f64;
                value < knots[0] - step || value > knots[last] + step
            }
            _ => false,
        });
        let model = if beyond { &self.timeless } else { &self.model };
        let mut own = Perturbation::none(drawn.joints.len());
        model.0.bend(conditions, &drawn.joints, standing, &mut own);
        let (mut averaged, mut plain) = (RowState::default(), RowState::default());
        drawn.state_into(conditions.reading, conditions.tip, Some(&own), &mut averaged);
        geometric.state_into(conditions.reading, conditions.tip, None, &mut plain);
        let to_averaged = plain.tip.inverse() * base * averaged.tip * tip;
        let [of_all, of_geometry, of_placement] = self.variances(model, conditions, standing, &averaged);
        let moves = &drawn.tips[conditions.tip].coordinates;
        let ranges = self.known.ranges.iter().zip(conditions.reading).zip(moves);
        let inside = ranges.filter(|(_, moves)| **moves).all(|(((low, high), q), _)| (*low..=*high).contains(q));
        let to_drawn = (!inside).then(|| {
            let mut as_drawn = RowState::default();
            drawn.state_into(conditions.reading, conditions.tip, None, &mut as_drawn);
            plain.tip.inverse() * self.known.drawn_base * as_drawn.tip * drawn_tip
        });
        let target = (averaged.tip * tip * Point3::from(*judged)).coords;
        let read = target
            + averaged.tip.rotation * own.target
            + self.by_instrument(&target, &averaged.tip, own.scale, &own.sight);
        let apart = (plain.tip.inverse() * base * Point3::from(read)).coords - judged;
        Robots { tip: conditions.tip, to_averaged, apart, to_drawn, own, of_all, of_geometry, of_placement }
    }

    /// Excess of the reading of the averaged robot's target at `p` (base frame, m) by the instrument's scale and line of sight: a scale that is
    /// too large and a frame that is too near compensate each other.
    fn by_instrument(&self, p: &Vector3<f64>, tip: &Pose, scale: f64, sight: &AlongSight) -> Vector3<f64> {
        let Some(instrument) = &self.known.instrument else { return Vector3::zeros() };
        let there = (instrument * Point3::from(*p)).coords;
        instrument.rotation.inverse() * there * scale + sight.beyond(&there, instrument, tip)
    }

    /// v = trace(Z S Zᵀ)/3 of everything, of geometry alone, and of the latter's instrument and target positions; Z: derivatives of the
    /// target by each number.
    fn variances(
        &self,
        model: &Everything,
        conditions: &Conditions<'_>,
        standing: &mut Standing,
        state: &RowState,
    ) -> [f64; 3] {
        let Known { drawn, spread, geometric_spread, instrument, tips, of_curves, .. } = &*self.known;
        let KnownTip { averaged: tip, target, .. } = &tips[conditions.tip];
        let mut sensitivities = vec![Sensitivity::default(); model.coefficients()];
        model.0.sensitivities_of(conditions, standing, state, &mut sensitivities);
        let on_tip = tip.rotation * target + tip.translation.vector;
        let p = (state.tip * Point3::from(on_tip)).coords;
        let turned = |twist: &Vector6<f64>| {
            Vector3::new(twist[0], twist[1], twist[2]).cross(&p) + Vector3::new(twist[3], twist[4], twist[5])
        };
        let moved = |by: &Sensitivity| {
            let of_arm = turned(&by.twist) + state.tip.rotation * by.target;
            of_arm + self.by_instrument(&p, &state.tip, by.scale, &by.sight)
        };
        let by_coefficients: Vec<Vector3<f64>> = sensitivities.iter().map(moved).collect();
        let frame = (0..6).filter(|_| instrument.is_some()).map(|k| turned(&Vector6::ith(k, 1.0)));
        let own = |k: usize| if k / 3 == conditions.tip { 1.0 } else { 0.0 };
        let places = (0..3 * tips.len()).map(|k| state.tip.rotation * Vector3::ith(k % 3, own(k)));
        let placed: Vec<Vector3<f64>> = frame.chain(places).collect();
        let mut curves = Vec::new();
        let mut first = model.coefficients();
        for curve in &model.0.curves {
            if let Some((unit, waves)) = model.of_curve(curve, conditions, &drawn.joints, state) {
                curves.push(ByWaves { first, by: moved(&unit), waves });
            }
            first += curve.waves.len();
        }
        let motion = Motion { by_coefficients, curves, placed };
        let beyond = of_curves * self.beyond_the_waves(conditions, state, &p);
        let [of_all, _] = motion.variances(spread);
        let [of_geometry, of_placement] = motion.variances(geometric_spread);
        [of_all + beyond, of_geometry, of_placement]
    }

    /// Mean square motion of the target per unit of curve, over the joints that read outside the interval of their waves.
    fn beyond_the_waves(&self, conditions: &Conditions<'_>, state: &RowState, p: &Vector3<f64>) -> f64 {
        let joints = &self.known.drawn.joints;
        let curves = self.model.0.curves.iter().filter(|curve| {
            let reading = self.model.0.statics.chain.joints()[curve.joint].value(conditions.reading);
            self.known.drawn.tips[conditions.tip].joints[curve.joint] && !curve.waves.covers(reading)
        });
        let moved = curves.map(|curve| {
            let twist = se3::adjoint_times(&state.before[curve.joint], &joints[curve.joint].screw.twist());
            let omega = Vector3::new(twist[0], twist[1], twist[2]);
            (omega.cross(p) + Vector3::new(twist[3], twist[4], twist[5])).norm_squared()
        });
        moved.sum::<f64>() / 3.0
    }

    /// The weights of the averaged robot, the drawn one and geometry alone under these conditions.
    pub fn blend(&self, conditions: &Conditions<'_>) -> Blend {
        self.weighed(&self.robots(conditions, &mut self.at_home()))
    }

    fn weighed(&self, robots: &Robots) -> Blend {
        let Known { of_geometry, of_drawing, geometry_among_rows, .. } = &*self.known;
        let whole = of_geometry + (robots.of_geometry - geometry_among_rows).max(0.0);
        if !(robots.of_all.is_finite() && robots.of_all > 0.0) {
            return Blend { shares: [0.0, 0.0], variance: whole, of_length: whole };
        }
        // In terms of the reading: with a distance, neither knows the directions across it.
        let share = of_geometry / (of_geometry + robots.of_all / self.known.across);
        let way = robots.apart;
        let apart = way.norm_squared() / 3.0;
        let variance = mixed(share, [robots.of_all, whole], apart);
        let of_length = mixed(share, [robots.of_all / self.known.across, whole], apart);
        let Some(to_drawn) = &robots.to_drawn else { return Blend { shares: [share, 0.0], variance, of_length } };
        // The drawing is placed by the same rows, with the same uncertainty.
        let of_drawing = of_drawing + robots.of_placement;
        let drawn = 1.0 / (1.0 + (FAR_MORE.powi(2) * of_drawing / variance).powi(2));
        let target = Point3::from(self.known.tips[robots.tip].target);
        let apart = (to_drawn * target - target - way * share).norm_squared() / 3.0;
        Blend {
            shares: [share * (1.0 - drawn), drawn],
            variance: mixed(drawn, [of_drawing, variance], apart),
            of_length: mixed(drawn, [of_drawing, of_length], apart),
        }
    }

    /// Expected error of the blend: root mean square per axis, m, without the noise of a measured row.
    pub fn expected_error(&self, conditions: &Conditions<'_>) -> f64 {
        (self.known.calibrated * self.blend(conditions).variance).sqrt()
    }

    /// Variance of a measured value there, noise included, m²: of a position component, or of a single length.
    pub fn variance_of_a_value(&self, conditions: &Conditions<'_>, length: bool) -> f64 {
        let blend = self.blend(conditions);
        self.known.calibrated * if length { blend.of_length } else { blend.variance } + self.known.noise
    }

    /// Variance of the target's position by everything and by geometry alone, m² per axis.
    pub(crate) fn unsure(&self, conditions: &Conditions<'_>) -> [f64; 2] {
        let robots = self.robots(conditions, &mut self.at_home());
        [robots.of_all, robots.of_geometry]
    }

    /// Adds to `out` the blend's perturbation of the robot with its geometry alone.
    pub(super) fn correct(&self, conditions: &Conditions<'_>, standing: &mut Standing, out: &mut Perturbation) {
        let robots = self.robots(conditions, standing);
        let [share, of_drawn] = self.weighed(&robots).shares;
        let home = &self.known.geometric.tips[conditions.tip].home;
        let last = out.twists.len() - 1;
        let mut step = se3::log(&robots.to_averaged) * share;
        if let Some(to_drawn) = &robots.to_drawn {
            step += se3::log(to_drawn) * of_drawn;
        }
        out.twists[last] += se3::adjoint_times(home, &step);
        out.target += robots.own.target * share;
        out.anchor += robots.own.anchor * share;
        out.scale += robots.own.scale * share;
        out.reading += robots.own.reading * share;
        out.sight += robots.own.sight * share;
    }
}

/// As a fit sees it: none of its numbers is free.
impl Effects for Averaged {
    type Standing = Standing;

    fn standing(&self, _arm: &Arm) -> Standing {
        self.at_home()
    }

    fn parameters(&self) -> Vec<Parameter> {
        Vec::new()
    }

    fn perturb(&self, row: Row<'_>, _arm: &Arm, standing: &mut Standing, out: &mut Perturbation) -> bool {
        self.correct(&Conditions::of(row), standing, out);
        true
    }

    fn sensitivities(&self, _: Row<'_>, _: &Arm, _: &mut Standing, _: Perturbed<'_>, _: &mut [Sensitivity]) {}

    fn bound_to(&self, data: &Measurements) -> Result<Self, MissingColumn> {
        Ok(self.bound(&|name| data.column(name)))
    }

    fn stepped(&self, _step: &[f64]) -> Self {
        self.clone()
    }
}

/// Derivatives of the target in one posture, base frame: by each coefficient, by the waves of each curve, and by its position.
struct Motion {
    by_coefficients: Vec<Vector3<f64>>,
    curves: Vec<ByWaves>,
    placed: Vec<Vector3<f64>>,
}

/// A joint's curve: all of its waves move the target along one line.
struct ByWaves {
    /// The number of its first wave.
    first: usize,
    /// Motion of the target per unit of the curve.
    by: Vector3<f64>,
    /// The curve by each wave.
    waves: Vec<f64>,
}

impl Motion {
    /// trace(Z S Zᵀ)/3 of all numbers of a spread, and of the positions alone.
    fn variances(&self, spread: &Spread) -> [f64; 2] {
        let (kept, size) = (&spread.kept, spread.covariance.nrows());
        let coefficients = kept.partition_point(|&number| number < self.by_coefficients.len());
        let alone = kept[..coefficients].iter().map(|&number| &self.by_coefficients[number]).chain(&self.placed);
        let alone: Vec<&Vector3<f64>> = alone.collect();
        let axes: [Vec<f64>; 3] = std::array::from_fn(|axis| alone.iter().map(|by| by[axis]).collect());
        let curves = self.curves.iter().map(|curve| {
            let below = |number: usize| kept.partition_point(|&other| other < number);
            let own = below(curve.first)..below(curve.first + curve.waves.len());
            let waves: Vec<f64> = kept[own.clone()].iter().map(|number| curve.waves[number - curve.first]).collect();
            (own, &curve.by, waves)
        });
        let curves: Vec<_> = curves.collect();
        let (mut sum, mut of_places) = (0.0, 0.0);
        for (index, by) in alone.iter().enumerate() {
            let column = if index < coefficients { index } else { index + kept.len() - coefficients };
            let covariance = &spread.covariance.as_slice()[column * size..][..size];
            for (axis, by) in axes.iter().zip(by.iter()) {
                // What comes before in the covariance, which is symmetric, and the variance itself.
                let before = &axis[..index.min(coefficients)];
                let places = &axis[before.len()..index];
                let by_places = 2.0 * dot(places, &covariance[kept.len()..][..places.len()]) + by * covariance[column];
                sum += by * (2.0 * dot(before, &covariance[..before.len()]) + by_places);
                of_places += if index < coefficients { 0.0 } else { by * by_places };
            }
            for (own, along, waves) in &curves {
                sum += 2.0 * by.dot(along) * dot(waves, &covariance[own.clone()]);
            }
        }
        for (index, (own, along, waves)) in curves.iter().enumerate() {
            for (before, (column, wave)) in own.clone().zip(waves).enumerate() {
                let covariance = &spread.covariance.as_slice()[column * size..][..size];
                for (other, across, others) in &curves[..index] {
                    sum += 2.0 * wave * along.dot(across) * dot(others, &covariance[other.clone()]);
                }
                let by_waves = 2.0 * dot(&waves[..before], &covariance[own.start..column]) + wave * covariance[column];
                sum += wave * along.norm_squared() * by_waves;
            }
        }
        [sum, of_places].map(|sum| (sum / 3.0).max(0.0))
    }
}

/// Variance of a mixture of two with these variances and this squared distance `apart`; `share`: weight of the first.
pub(crate) fn mixed(share: f64, [first, second]: [f64; 2], apart: f64) -> f64 {
    share * first + (1.0 - share) * second + share * (1.0 - share) * apart
}

struct Robots {
    /// Which tip it is.
    tip: usize,
    /// From the tip of the geometric robot to that of the averaged one.
    to_averaged: Pose,
    /// Difference of the readings of the averaged and the geometric robot's target, tip frame, m.
    apart: Vector3<f64>,
    /// And to that of the drawn one, outside the measured ranges.
    to_drawn: Option<Pose>,
    own: Perturbation,
    /// v(q) of everything, and of geometry alone, m².
    of_all: f64,
    of_geometry: f64,
    /// The same of the positions of instrument and target, for either robot.
    of_placement: f64,
}

/// The model with means for drivers that depend on the clock piece by piece.
fn timeless(model: &Everything, averages: &[Vec<f64>]) -> Everything {
    let mut model = model.clone();
    for (effect, averages) in model.0.effects.iter_mut().zip(averages) {
        if matches!(effect.term.driver, Driver::Smooth { .. }) {
            effect.term.driver = Driver::Fixed(averages.clone());
        }
    }
    model
}

#[cfg(test)]
mod tests {
    use super::{ByWaves, Motion, Spread};
    use denavit_model::nalgebra::{DMatrix, Matrix3xX, Vector3};
    use proptest::prelude::*;
    use rand::SeedableRng as _;
    use rand_chacha::ChaCha8Rng;

    proptest! {
        /// trace(Z S Zᵀ)/3, number by number.
        #[test]
        fn variances_by_joint_are_those_of_all_numbers(seed in 0..u64::MAX) {
            let mut rng = ChaCha8Rng::seed_from_u64(seed);
            let mut cell = || rng.random_range(-1.0..1.0);
            let mut vector = || Vector3::from_fn(|_, _| cell());
            let by_coefficients: Vec<Vector3<f64>> = (0..7).map(|_| vector()).collect();
            let placed: Vec<Vector3<f64>> = (0..9).map(|_| vector()).collect();
            let (lines, first) = ([vector(), vector(), vector()], [7, 11, 17]);
            let waves = [4, 6, 3].map(|count| (0..count).map(|_| cell()).collect::<Vec<f64>>());
            // A joint that does not move this tip: its waves are there, and move nothing.
            let still = 1;
            let curve = |k: usize| ByWaves { first: first[k], by: lines[k], waves: waves[k].clone() };
            let curves = (0..3).filter(|k| *k != still).map(curve).collect();
            let kept: Vec<usize> = (0..20).filter(|number| number % 5 != 3).collect();
            let moved = |number: usize| match (0..3).rev().find(|k| first[*k] <= number) {
                None => by_coefficients[number],
                Some(k) if k == still => Vector3::zeros(),
                Some(k) => lines[k] * waves[k][number - first[k]],
            };
            let columns: Vec<Vector3<f64>> = kept.iter().map(|number| moved(*number)).chain(placed.clone()).collect();
            let z = Matrix3xX::from_columns(&columns);
            let root = DMatrix::from_fn(columns.len(), columns.len(), |_, _| cell());
            let covariance = &root * root.transpose();
            let places = z.columns(kept.len(), 9).into_owned();
            let of_places = covariance.view((kept.len(), kept.len()), (9, 9)).into_owned();
            let wanted = [(&z * &covariance * z.transpose()).trace(), (&places * of_places * places.transpose()).trace()];
            let found = Motion { by_coefficients, curves, placed }.variances(&Spread { kept, covariance });
            for (found, wanted) in found.iter().zip(wanted) {
                prop_assert!((3.0 * found - wanted).abs() < 1e-10 * wanted, "{found} against {}", wanted / 3.0);
            }
        }
    }
}
