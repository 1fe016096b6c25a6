//! Effects of a calibration as the code has them.

use crate::failure::Failure;
use denavit_code::effects as code;
use denavit_code::effects::Input;
use denavit_identify::arm::AxisBasis;
use denavit_identify::effects::averaged::{Averaged, FAR_MORE};
use denavit_identify::effects::carrier::Action;
use denavit_identify::effects::curve::Waves;
use denavit_identify::effects::driver::{
    APPROACH, APPROACH_FROM_ROWS, BumpShape, Conditions, RUN_ORDER, Statics, TWIST_TO_BEND, unit_of,
};
use denavit_identify::effects::{Coupling, Driver, Effect, EffectModel, SavedEffects, recorded};
use denavit_load::measured::with_given;
use denavit_measurements::covariates::PAYLOAD;
use denavit_model::nalgebra::Vector3;
use denavit_model::{Chain, ChainJoint, Pose};
use std::convert::Infallible;

/// The effects of a file on this chain; what is given is written as a constant, what else they follow is an argument.
pub fn of(file: &str, saved: &SavedEffects, chain: &Chain, given: &[(String, f64)]) -> Result<code::Effects, Failure> {
    let refused = |why: String| Failure::Argument(format!("{file}: {why}"));
    let saved = saved.of_the_tip();
    let statics = &saved.statics;
    if statics.tips.all().len() != 1 {
        return Err(refused("the effects are of several tips; calibrate with one --tip".into()));
    }
    if saved.averaged.is_some() && !(saved.effects.is_empty() && saved.curves.is_empty()) {
        return Err(refused(
            "the file has effects besides an averaged prediction; write it again with denavit calibrate".into(),
        ));
    }
    let arguments = arguments(file, &saved, given)?;
    let index = |name: &str| {
        let name = recorded::plain(name);
        arguments.iter().position(|argument| argument.name == name)
    };
    let input = |name: &String| match recorded::given(given, name) {
        Some(value) => Some(Input::Known(value)),
        None => index(name).map(Input::Argument),
    };
    let payload = recorded::given(given, PAYLOAD).unwrap_or(0.0);
    let (model, averaged) = if let Some(averaged) = &saved.averaged {
        let (known, mean) = (&averaged.known, averaged.mean());
        let arm = (&known.drawn.joints[..], known.drawn.tips[0].home);
        (model(&mean.statics, arm, &followed(averaged, &input), mean, payload), Some(blended(averaged)))
    } else {
        let known = |name: &String| input(name).unwrap_or(Input::Known(0.0));
        let effects: Vec<_> = saved.effects.iter().map(|effect| with(effect, &effect.term.driver, &known)).collect();
        let curves = EffectModel { curves: saved.curves.clone(), ..EffectModel::new(statics.clone(), Vec::new()) };
        (model(statics, (chain.joints(), *chain.home()), &effects, &curves, payload), None)
    };
    let mut effects = code::Effects { chain: chain.clone(), arguments, model, averaged, cases: Vec::new() };
    effects.cases = cases(file, &saved, &effects, given)?;
    Ok(effects)
}

/// Arguments of the code: every quantity that effects follow and that is not given.
fn arguments(file: &str, saved: &SavedEffects, given: &[(String, f64)]) -> Result<Vec<code::Argument>, Failure> {
    let mut arguments: Vec<code::Argument> = Vec::new();
    for effect in &saved.effects {
        for name in effect.term.driver.columns() {
            let plain = recorded::plain(name);
            if recorded::given(given, name).is_some() || arguments.iter().any(|argument| argument.name == plain) {
                continue;
            }
            let side = name.ends_with(APPROACH) || name.ends_with(APPROACH_FROM_ROWS);
            if name == RUN_ORDER || (recorded::given_by_order(name) && !side) {
                let (kind, place) = (effect.term.kind.name(), effect.term.carrier.place(&saved.statics.chain));
                return Err(Failure::Argument(format!(
                    "{file}: {kind} at {place} follows \"{plain}\", which comes from the order of the measured rows and is unknown to a \
                     controller; fix it with --given \"{plain}=0\", or calibrate without it: --effects with the other kinds"
                )));
            }
            let unit = if side { "1 from below or -1 from above" } else { unit_of(name) };
            arguments.push(code::Argument { name: plain, unit: unit.into() });
        }
    }
    Ok(arguments)
}

/// An effect with what it follows bound to inputs.
fn with(
    effect: &Effect<Driver<String>>,
    driver: &Driver<String>,
    input: &dyn Fn(&String) -> Input,
) -> Effect<Driver<Input>> {
    let bound: Result<Driver<Input>, Infallible> = driver.named_by(|name| Ok(input(name)));
    let Ok(driver) = bound;
    effect.with_driver(driver)
}

/// The effects of an averaged prediction: quantities that are not given are set to their averages.
fn followed(averaged: &Averaged, input: &dyn Fn(&String) -> Option<Input>) -> Vec<Effect<Driver<Input>>> {
    let bound = |(effect, averages): (&Effect<Driver<String>>, &Vec<f64>)| {
        let known = effect.term.driver.columns().into_iter().all(|name| input(name).is_some());
        let fixed = Driver::Fixed(averages.clone());
        let driver = if known { &effect.term.driver } else { &fixed };
        with(effect, driver, &|name| input(name).unwrap_or(Input::Known(0.0)))
    };
    let mut effects: Vec<Effect<Driver<Input>>> = averaged.effects.iter().zip(&averaged.averages).map(bound).collect();
    let beyond = |driver: &Driver<Input>| match driver {
        Driver::Smooth { covariate: Input::Known(value), knots } => {
            let last = knots.len() - 1;
            let step = (knots[last] - knots[0]) / last as f64;
            *value < knots[0] - step || *value > knots[last] + step
        }
        _ => false,
    };
    if effects.iter().any(|effect| beyond(&effect.term.driver)) {
        for (effect, averages) in effects.iter_mut().zip(&averaged.averages) {
            if matches!(effect.term.driver, Driver::Smooth { .. }) {
                effect.term.driver = Driver::Fixed(averages.clone());
            }
        }
    }
    effects
}

/// Effects and curves on an arm with these joints and this base_from_tip.
fn model(
    statics: &Statics,
    (joints, home): (&[ChainJoint], Pose),
    effects: &[Effect<Driver<Input>>],
    curves: &EffectModel,
    payload: f64,
) -> code::Model {
    let curves = curves.curves.iter().map(|curve| code::Curve {
        joint: curve.joint,
        interval: match curve.waves {
            Waves::Sines { low, width, .. } => Some((low, width)),
            Waves::Turns { .. } => None,
        },
        weights: curve.weights.clone(),
    });
    let masses = statics.masses.points.iter().zip(statics.centres(joints));
    code::Model {
        joints: joints.to_vec(),
        home,
        read: statics.chain.joints().to_vec(),
        terms: effects.iter().map(|effect| term(statics, joints, effect)).collect(),
        curves: curves.collect(),
        masses: code::Masses {
            points: masses.map(|(mass, centre)| (mass.joint, mass.mass, centre.coords)).collect(),
            gravity: statics.masses.gravity,
            payload: (payload, statics.tips[0].home.translation.vector),
            starts: statics.points.iter().map(|point| point.coords).collect(),
        },
    }
}

fn term(statics: &Statics, joints: &[ChainJoint], effect: &Effect<Driver<Input>>) -> code::Term {
    let values = effect.term.driver.len(statics);
    let directions = effect.term.carrier.directions(statics, joints, 0);
    let mut moves = Vec::new();
    for (direction, actions) in directions.iter().enumerate() {
        for value in 0..values {
            let coefficient = match effect.term.coupling {
                Coupling::Each => direction * values + value,
                Coupling::Paired if direction == value => 0,
                Coupling::Paired => continue,
            };
            for action in actions {
                let action = match action {
                    Action::Twist { slot, twist } => code::Action::Twist { slot: *slot, twist: *twist },
                    Action::Target(shift) => code::Action::Target(*shift),
                    Action::Scale => code::Action::Scale,
                    Action::Sight(sight) => code::Action::Sight(sight.turning, sight.steady),
                    // Neither moves the target.
                    Action::Anchor(_) | Action::Reading => continue,
                };
                moves.push(code::Move { coefficient, value, action });
            }
        }
    }
    code::Term { driver: driver(statics, &effect.term.driver), coefficients: effect.coefficients.clone(), moves }
}

fn driver(statics: &Statics, driver: &Driver<Input>) -> code::Driver {
    let screw = |joint: usize| &statics.chain.joints()[joint].screw;
    let across = |joint: usize| -> [Vector3<f64>; 2] {
        let basis = AxisBasis::of(screw(joint));
        [basis.a, basis.b]
    };
    let count = statics.chain.joints().len();
    let next = |joint: usize| statics.link_end(joint, 0).map(|end| end.slot).filter(|slot| *slot < count);
    match driver {
        Driver::Constant => code::Driver::Constant(vec![1.0]),
        Driver::Fixed(values) => code::Driver::Constant(values.clone()),
        Driver::Reading(joint) => code::Driver::Reading(*joint),
        Driver::Harmonic { joint, order } => code::Driver::Harmonic { joint: *joint, order: *order },
        Driver::Bump { joint, at, width, shape } => {
            let shape = match shape {
                BumpShape::Bell => code::Bump::Bell,
                BumpShape::Tent => code::Bump::Tent,
                BumpShape::Wave => code::Bump::Wave,
            };
            code::Driver::Bump { joint: *joint, at: *at, width: *width, shape }
        }
        Driver::Torque(joint) => code::Driver::Torque(*joint),
        Driver::TorqueTerms { joint, links } => {
            let carried = (*joint..count).take(*links);
            code::Driver::TorqueTerms(*joint, carried.map(|link| (link, across(link))).collect())
        }
        Driver::SprungTorque(joint) => code::Driver::SprungTorque(*joint),
        Driver::HardeningTorque { joint, knee } => code::Driver::HardeningTorque(*joint, *knee),
        Driver::MomentAcross(joint) => code::Driver::MomentAcross(*joint, across(*joint)),
        Driver::Cantilever(joint) => {
            let end = statics.link_end(*joint, 0).map_or(statics.points[*joint], |end| end.point);
            let reach = end - statics.points[*joint];
            code::Driver::Cantilever { joint: *joint, next: next(*joint), reach, twist_to_bend: TWIST_TO_BEND }
        }
        Driver::EndMoment(joint) => code::Driver::EndMoment(*joint, next(*joint)),
        Driver::Overturning => code::Driver::Overturning(vec![Vector3::x(), Vector3::y(), Vector3::z()]),
        Driver::LevelOverturning => code::Driver::Overturning(statics.level().to_vec()),
        Driver::Approach(of) => code::Driver::Told(vec![(1.0, of.column)]),
        Driver::GravitySide(joint) => code::Driver::GravitySide(*joint),
        Driver::FrictionSide { side, friction } => code::Driver::FrictionSide(side.joint, side.column, *friction),
        Driver::LoadedSide(side) => code::Driver::LoadedSide(side.joint, side.column),
        Driver::Velocities(moving) => {
            let mut values = vec![(0.0, Input::Known(0.0)); count];
            for of in moving {
                values[of.joint] = (statics.chain.joints()[of.joint].scale, of.of_coordinate);
            }
            code::Driver::Told(values)
        }
        Driver::Covariate(input) => code::Driver::Told(vec![(1.0, *input)]),
        Driver::Decay { covariate, from, constant } => {
            code::Driver::Decay { of: *covariate, from: *from, constant: *constant }
        }
        Driver::Steps { covariate, at } => code::Driver::Steps(*covariate, at.clone()),
        Driver::Smooth { covariate, knots } => code::Driver::Smooth(*covariate, knots.clone()),
    }
}

fn blended(averaged: &Averaged) -> code::Averaged {
    let (known, tip) = (&averaged.known, &averaged.known.tips[0]);
    let spread = |spread: &denavit_identify::effects::averaged::Spread| code::Spread {
        kept: spread.kept.clone(),
        covariance: spread.covariance.clone(),
    };
    code::Averaged {
        geometric: known.geometric.joints.clone(),
        home: known.geometric.tips[0].home,
        placed: [known.base, tip.averaged],
        drawn: [known.drawn_base, tip.drawn],
        target: tip.target,
        instrument: known.instrument,
        spreads: [spread(&known.spread), spread(&known.geometric_spread)],
        of_curves: known.of_curves,
        of_drawing: known.of_drawing,
        of_geometry: [known.of_geometry, known.geometry_among_rows],
        across: known.across,
        far_more: FAR_MORE,
        ranges: known.ranges.clone(),
    }
}

/// Postures, values of the arguments, and where the tip is by `denavit fk`.
fn cases(
    file: &str,
    saved: &SavedEffects,
    effects: &code::Effects,
    given: &[(String, f64)],
) -> Result<Vec<code::Case>, Failure> {
    let ranges = effects.averaged.as_ref().map(|averaged| &averaged.ranges[..]);
    let mut cases = Vec::new();
    for (index, q) in code::postures(&effects.chain, ranges).into_iter().enumerate() {
        let given_value = |(k, argument): (usize, &code::Argument)| {
            let places = places(saved, &argument.name);
            // A side, or so much of anything else that the arm moves by little.
            let size = if argument.name.ends_with(APPROACH) { 1.0 } else { 0.05 };
            let upward = if (index + k) % 2 == 0 { size } else { -size };
            places.get((index + k) % places.len().max(1)).copied().unwrap_or(upward)
        };
        let values: Vec<f64> = effects.arguments.iter().enumerate().map(given_value).collect();
        let mut all = given.to_vec();
        all.extend(effects.arguments.iter().map(|argument| argument.name.clone()).zip(values.iter().copied()));
        let (model, recorded) = with_given(file, saved, &all)?;
        let pose = model.fk(&effects.chain, &Conditions { reading: &q, recorded: recorded.row(0), tip: 0 });
        cases.push(code::Case { q, given: values, pose });
    }
    Ok(cases)
}

/// Values at which something follows what is named.
fn places(saved: &SavedEffects, name: &str) -> Vec<f64> {
    let mut places = Vec::new();
    for effect in &saved.effects {
        match &effect.term.driver {
            Driver::Steps { covariate, at } if recorded::plain(covariate) == name => places.extend(at),
            Driver::Smooth { covariate, knots } if recorded::plain(covariate) == name => {
                places.extend(knots.windows(2).map(|pair| 0.3 * pair[0] + 0.7 * pair[1]));
            }
            Driver::Decay { covariate, from, constant } if recorded::plain(covariate) == name => {
                places.extend([from + 0.5 * constant, from - constant]);
            }
            _ => {}
        }
    }
    places
}
