//! Everything that may act, as terms of one linear model: the family of each coefficient, and its scale per unit of the family's size.
//!
//! Nothing is selected. Drivers are scaled by the robot (its turns, its moments of gravity at postures spread over the joints' ranges), never by
//! the data: a unit of a family's size is about a radian at a joint, or a metre.

use crate::effects::candidates::tilting;
use crate::effects::carrier::Carrier;
use crate::effects::catalogue::Kind;
use crate::effects::curve::{Curve, Waves};
use crate::effects::driver::{
    APPROACH, APPROACH_FROM_ROWS, CURRENT, Conditions, Driver, EFFORT, MOTOR_TORQUE, Side, Statics,
};
use crate::effects::everything::Everything;
use crate::effects::model::{Coupling, EffectModel, Term};
use crate::effects::survey::Survey;
use crate::noise::HeldCurve;
use crate::parameters::Tolerances;
use denavit_measurements::RecordedRow;
use std::f64::consts::PI;

/// Coefficients that share one size.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Family {
    /// Positions of axes on their links, in tolerances.
    Geometry,
    /// Zeros of joints, in their tolerances.
    Zero,
    /// A joint's error as a function of its own reading.
    Curve,
    /// Compliance of joints under gravity, masses as given.
    Compliance,
    /// The same with free first moments of links.
    Moments,
    /// Compliance of links and bearings.
    Link,
    /// Compliance of the base.
    Base,
    /// Scales of joints.
    Scale,
    /// Slides along turning axes, m.
    Pitch,
    /// Play by the side of approach and by the side to which gravity pushes.
    Play,
    /// A neighbour's motion.
    Coupling,
    /// Axes that tilt as they turn; rails that are not straight.
    Wobble,
    /// The instrument, or what it is set up on.
    Drift,
    /// The target on the tip.
    TargetDrift,
    /// Errors along the line of sight.
    Incidence,
    /// The instrument's metre.
    Instrument,
    /// With recorded inclination.
    Tilt,
    /// With recorded temperature.
    Thermal,
    /// With recorded torque or current.
    Motor,
    /// Readings older than what is measured.
    Latency,
    /// Causes identified in the same rows.
    Named,
}

impl Family {
    /// Whether it belongs to links and zeros.
    pub fn is_of_geometry(self) -> bool {
        matches!(self, Self::Geometry | Self::Zero)
    }
}

/// Highest frequency of waves, rad per rad or per m: what even few rows resolve.
const FASTEST: f64 = 40.0;
/// Most waves of a joint.
const MOST_WAVES: usize = 90;
/// The waves' interval extends the range of the data by this much on either side, rad or m.
const BEYOND: f64 = 0.3;
/// Number of postures that set the scale of drivers.
const POSTURES: usize = 48;
/// Play follows gravity's side where gravity's moment exceeds this fraction of the robot's largest.
const SIDE: f64 = 0.02;
/// Straight pieces of a drift curve.
const PIECES: usize = 4;
/// Prior standard deviation of a cause's root mean square effect where no other prior is known: ten tolerances of geometry, rad or m.
const ANY_SIZE: f64 = 1e-2;
/// A usual change of temperature, K.
const WARM: f64 = 10.0;

/// The terms with the prior of each of their numbers; waves come after all coefficients.
pub struct Terms {
    /// The model with all numbers zero.
    pub model: Everything,
    /// The family of each number.
    pub families: Vec<Family>,
    /// The scale of each number, per unit of its family's size.
    pub scales: Vec<f64>,
    /// Frequency of each wave, rad per rad or per m; 0 for coefficients.
    pub frequencies: Vec<f64>,
    /// For each joint that has a curve, the coefficient that moves it alone.
    pub joints: Vec<usize>,
}

struct Builder<'a> {
    survey: &'a Survey,
    statics: &'a Statics,
    terms: Vec<Term>,
    families: Vec<Family>,
    scales: Vec<f64>,
}

impl Builder<'_> {
    fn add(&mut self, kind: Kind, carrier: Carrier, driver: Driver, coupling: Coupling, of: &[(Family, f64)]) -> usize {
        let term = Term { kind, carrier, driver, coupling };
        let first = self.families.len();
        for k in 0..term.coefficients(self.statics) {
            let (family, scale) = of[k % of.len()];
            self.families.push(family);
            self.scales.push(scale);
        }
        self.terms.push(term);
        first
    }

    fn each(&mut self, kind: Kind, carrier: Carrier, driver: Driver, family: Family, scale: f64) -> usize {
        self.add(kind, carrier, driver, Coupling::Each, &[(family, scale)])
    }
}

/// The largest root mean square moment of gravity about any joint's point, at postures spread over the ranges, N·m (N for a slide's force).
pub fn largest_moment(statics: &Statics) -> f64 {
    let chain = &statics.chain;
    let mut squares = vec![0.0; chain.joints().len()];
    for posture in 0..POSTURES {
        let value = |(k, coordinate): (usize, &denavit_model::Coordinate)| {
            let (lower, upper) = coordinate.range();
            lower + (upper - lower) * (0.5 + posture as f64 * 0.618_033_988_749_895 * (k as f64 + 1.0).sqrt()).fract()
        };
        let q: Vec<f64> = chain.coordinates().iter().enumerate().map(value).collect();
        let conditions = Conditions { reading: &q, recorded: RecordedRow::nothing(), tip: 0 };
        let posture = statics.posture(chain.joints(), &conditions, None);
        for (joint, square) in squares.iter_mut().enumerate() {
            let mut values = Vec::new();
            Driver::<denavit_measurements::Column>::MomentAcross(joint).values_into(
                statics,
                &conditions,
                &posture,
                &mut values,
            );
            values.push(statics.torque(&posture, joint));
            *square += values.iter().map(|value| value * value).sum::<f64>();
        }
    }
    squares.iter().map(|square| (square / POSTURES as f64).sqrt()).fold(0.0, f64::max)
}

/// Everything that may act on a robot in these rows. `named`: causes identified in the rows.
pub fn terms(survey: &Survey, tolerances: &Tolerances, named: &[(Term, f64)]) -> Terms {
    let statics = &survey.statics;
    let n = statics.chain.joints().len();
    let mut b = Builder { survey, statics, terms: Vec::new(), families: Vec::new(), scales: Vec::new() };
    let moving: Vec<usize> = survey.moving().collect();
    let zeros = geometry(&mut b, n, tolerances);
    let moment = largest_moment(statics);
    for &i in &moving {
        of_joint(&mut b, i, &moving, moment);
    }
    surroundings(&mut b, &moving, moment);
    for (term, scale) in named {
        b.each_of(term, *scale);
    }
    let mut model = EffectModel::of_terms(statics, None, &b.terms);
    let Builder { mut families, mut scales, .. } = b;
    let mut frequencies = vec![0.0; families.len()];
    for &joint in &moving {
        let curve = curve(survey, joint);
        for k in 0..curve.waves.len() {
            families.push(Family::Curve);
            scales.push(curve.waves.variance_per_density().sqrt());
            frequencies.push(curve.waves.frequency(k));
        }
        model.curves.push(curve);
    }
    let joints = moving.iter().map(|&joint| zeros[joint]).collect();
    Terms { model: Everything(model), families, scales, frequencies, joints }
}

/// Geometry with the causes and error curves of a model, each number with its prior standard deviation: for a cause `ANY_SIZE` times `scale`
/// of its term. The numbers start at the model's values.
pub fn of_model(
    survey: &Survey,
    tolerances: &Tolerances,
    (model, curves): (&EffectModel, &[HeldCurve<'_>]),
    scale: impl Fn(&Term) -> f64,
) -> Terms {
    let statics = &survey.statics;
    let mut b = Builder { survey, statics, terms: Vec::new(), families: Vec::new(), scales: Vec::new() };
    let n = statics.chain.joints().len();
    let zeros = geometry(&mut b, n, tolerances);
    let first = b.terms.len();
    for effect in &model.effects {
        b.each_of(&effect.term, ANY_SIZE * scale(&effect.term));
    }
    let mut own = EffectModel::of_terms(statics, None, &b.terms);
    let Builder { mut families, mut scales, .. } = b;
    for (own, effect) in own.effects[first..].iter_mut().zip(&model.effects) {
        own.coefficients.clone_from(&effect.coefficients);
    }
    for HeldCurve { curve, variances } in curves {
        scales.extend(variances.iter().map(|variance| variance.sqrt()));
        families.resize(scales.len(), Family::Named);
        own.curves.push((*curve).clone());
    }
    let frequencies = vec![0.0; families.len()];
    let joints = survey.moving().map(|joint| zeros[joint]).collect();
    Terms { model: Everything(own), families, scales, frequencies, joints }
}

impl Builder<'_> {
    fn each_of(&mut self, term: &Term, scale: f64) {
        let Term { kind, carrier, driver, coupling } = term.clone();
        self.add(kind, carrier, driver, coupling, &[(Family::Named, scale)]);
    }
}

/// Errors of links and zeros; returns the coefficient of each joint's zero.
fn geometry(b: &mut Builder<'_>, n: usize, tolerances: &Tolerances) -> Vec<usize> {
    let (turn, shift) = ((Family::Geometry, tolerances.turn), (Family::Geometry, tolerances.shift));
    let statics = b.statics;
    let mut add = |carrier, of: &[_]| b.add(Kind::Geometry, carrier, Driver::Constant, Coupling::Each, of);
    for link in std::iter::once(None).chain((0..n).map(Some)) {
        let carried: Vec<usize> = (0..n).filter(|&joint| statics.carrier(joint) == link).collect();
        if let (Some(i), 1) = (link, carried.len()) {
            add(Carrier::LinkEnd(i), &[turn, turn, turn, shift, shift, shift]);
        }
        let several = carried.len() > 1;
        // With several, each is mounted separately; a turn about its axis is its zero. The rows place a single base, or a target.
        for joint in carried.into_iter().filter(|_| several) {
            add(Carrier::AxisBasis(joint), &[turn]);
            add(Carrier::Sideways(joint), &[shift]);
            add(Carrier::Along(joint), &[shift]);
        }
    }
    let zero = |b: &Builder<'_>, i| if b.survey.slides(i) { tolerances.zero_slide } else { tolerances.zero_turn };
    (0..n)
        .map(|i| {
            let scale = zero(b, i);
            b.each(Kind::Geometry, Carrier::Joint(i), Driver::Constant, Family::Zero, scale)
        })
        .collect()
}

fn of_joint(b: &mut Builder<'_>, i: usize, moving: &[usize], moment: f64) {
    let (survey, statics) = (b.survey, b.statics);
    let slides = |joint: usize| survey.slides(joint);
    let turn = |joint: usize| if slides(joint) { 1.0 } else { 1.0 / PI };
    b.each(Kind::JointScale, Carrier::Joint(i), Driver::Reading(i), Family::Scale, turn(i));
    if !slides(i) {
        b.each(Kind::HelicalPitch, Carrier::Along(i), Driver::Reading(i), Family::Pitch, turn(i));
    }
    if statics.feels_gravity(i) && moment > 0.0 {
        let knee = SIDE * moment;
        let driver = Driver::HardeningTorque { joint: i, knee };
        let of = [(Family::Compliance, 1.0 / moment), (Family::Play, 1.0 / knee)];
        b.add(Kind::JointCompliance, Carrier::Joint(i), driver, Coupling::Each, &of);
        let driver = Driver::TorqueTerms { joint: i, links: usize::MAX };
        let per_moment = statics.masses.gravity.norm().recip();
        b.each(Kind::JointCompliance, Carrier::Joint(i), driver, Family::Moments, per_moment);
    }
    if !slides(i) && moment > 0.0 {
        let of = [(Family::Link, 1.0 / moment)];
        // What bends under a joint on the base is the base itself.
        if statics.carrier(i).is_some() {
            let driver = Driver::MomentAcross(i);
            b.add(Kind::LinkCompliance, Carrier::AxisBasis(i), driver, Coupling::Paired, &of);
        }
        b.add(Kind::LinkCompliance, Carrier::LinkEndTurn(i), Driver::EndMoment(i), Coupling::Paired, &of);
    }
    for order in [1.0, 2.0] {
        // A rail: half a wave and a whole one over the range that it may move.
        let (lower, upper) = statics.chain.coordinates()[statics.chain.joints()[i].coordinate].range();
        let order = if slides(i) { order * PI / (upper - lower) } else { order };
        let driver = Driver::Harmonic { joint: i, order };
        b.each(Kind::AxisWobble, Carrier::AxisBasis(i), driver.clone(), Family::Wobble, 1.0);
        if slides(i) {
            b.each(Kind::AxisWobble, Carrier::Sideways(i), driver, Family::Wobble, 1.0);
        }
    }
    for &j in moving {
        if statics.carrier(i) == Some(j) || statics.carrier(j) == Some(i) {
            b.each(Kind::JointCoupling, Carrier::Joint(i), Driver::Reading(j), Family::Coupling, turn(j));
        }
    }
    let side = [(APPROACH, false), (APPROACH_FROM_ROWS, true)]
        .into_iter()
        .find_map(|(ending, from_rows)| Some(Side { joint: i, from_rows, column: survey.of_joint(i, ending)? }));
    if let Some(side) = side {
        b.each(Kind::Backlash, Carrier::Joint(i), Driver::Approach(side), Family::Play, 1.0);
    }
    for column in [MOTOR_TORQUE, EFFORT, CURRENT].into_iter().filter_map(|ending| survey.of_joint(i, ending)) {
        b.each(
            Kind::JointCompliance,
            Carrier::Joint(i),
            Driver::Covariate(column),
            Family::Motor,
            1.0 / moment.max(1.0),
        );
    }
}

fn surroundings(b: &mut Builder<'_>, moving: &[usize], moment: f64) {
    let survey = b.survey;
    if moment > 0.0 {
        b.each(Kind::BaseCompliance, Carrier::BaseTurn, Driver::LevelOverturning, Family::Base, 1.0 / moment);
    }
    let mut stands: Vec<Carrier> = Vec::new();
    if survey.instrument {
        stands.push(Carrier::Base);
    }
    if survey.anchor {
        stands.extend([Carrier::Reading, Carrier::Anchor]);
    }
    if let Some(clock) = &survey.clock {
        let smooth = || Driver::Smooth { covariate: clock.column.clone(), knots: clock.knots(PIECES) };
        for carrier in &stands {
            b.each(Kind::Drift, *carrier, smooth(), Family::Drift, 1.0);
        }
        b.each(Kind::Drift, Carrier::Target, smooth(), Family::TargetDrift, 1.0);
    }
    if survey.sight {
        b.each(Kind::TargetIncidence, Carrier::Sight, Driver::Constant, Family::Incidence, 1.0);
        b.each(Kind::TargetIncidence, Carrier::Range, Driver::Constant, Family::Incidence, 1.0);
    }
    if survey.instrument || survey.anchor {
        b.each(Kind::InstrumentScale, Carrier::Scale, Driver::Constant, Family::Instrument, 1.0);
    }
    for (column, scatter) in &survey.tilts {
        for carrier in tilting(survey) {
            b.each(Kind::Tilt, carrier, Driver::Covariate(column.clone()), Family::Tilt, 1.0 / scatter);
        }
    }
    for column in &survey.temperatures {
        let joints = moving.iter().map(|&joint| Carrier::Joint(joint));
        let carriers: Vec<Carrier> =
            joints.chain(stands.iter().copied()).chain([Carrier::Target, Carrier::Lengths]).collect();
        for carrier in carriers {
            b.each(Kind::Thermal, carrier, Driver::Covariate(column.clone()), Family::Thermal, 1.0 / WARM);
        }
    }
    if !survey.velocities.is_empty() {
        let driver = Driver::Velocities(survey.velocities.clone());
        b.add(Kind::Latency, Carrier::AllJoints, driver, Coupling::Paired, &[(Family::Latency, 1.0)]);
    }
}

/// A joint's curve, as yet zero.
fn curve(survey: &Survey, joint: usize) -> Curve {
    let range = survey.ranges[joint];
    let (low, width) = (range.0 - BEYOND, range.1 - range.0 + 2.0 * BEYOND);
    // As many waves as reach the fastest.
    let reaches = |count: &usize| *count as f64 >= FASTEST * width / PI;
    let count = (3..MOST_WAVES).find(reaches).unwrap_or(MOST_WAVES);
    let waves = Waves::Sines { low, width, count };
    Curve { joint, weights: vec![0.0; waves.len()], waves, range, size: 0.0, length: 0.0, spread: Vec::new() }
}
