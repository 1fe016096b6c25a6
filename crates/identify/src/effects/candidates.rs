//! The terms that the tracer tries for each kind of effect.
//!
//! A new way for a known kind to act is a line in its function. The test `every_kind_offers_terms_that_a_fit_can_use` covers all.

use crate::effects::carrier::Carrier;
use crate::effects::catalogue::Kind;
use crate::effects::driver::{APPROACH, APPROACH_FROM_ROWS, BumpShape, CURRENT, Driver, EFFORT, MOTOR_TORQUE, Side};
use crate::effects::model::{Coupling, Term};
use crate::effects::survey::Survey;
use denavit_measurements::Column;

/// A term to try, and the number of its parameters that a scan chose.
#[derive(Debug, Clone, PartialEq)]
pub struct Candidate {
    /// The term.
    pub term: Term,
    /// Numbers inside the driver that a scan chose: they count as parameters.
    pub scanned: usize,
}

/// The terms of a kind to try on the data at hand.
pub fn candidates(kind: Kind, survey: &Survey) -> Vec<Candidate> {
    match kind {
        Kind::JointScale => joint_scale(survey),
        Kind::HelicalPitch => helical_pitch(survey),
        Kind::TransmissionError => transmission_error(survey),
        Kind::JointCompliance => joint_compliance(survey),
        Kind::Backlash => backlash(survey),
        Kind::JointCoupling => joint_coupling(survey),
        Kind::AxisWobble => axis_wobble(survey),
        Kind::LocalJointError => local_joint_error(survey),
        Kind::LinkCompliance => link_compliance(survey),
        Kind::BaseCompliance => base_compliance(survey),
        Kind::Tilt => tilt(survey),
        Kind::Thermal => thermal(survey),
        Kind::Drift => drift(survey),
        Kind::Latency => latency(survey),
        Kind::InstrumentScale => instrument_scale(survey),
        Kind::TargetIncidence => target_incidence(survey),
        Kind::Geometry => Vec::new(),
    }
}

fn candidate(kind: Kind, carrier: Carrier, driver: Driver, coupling: Coupling, scanned: usize) -> Candidate {
    Candidate { term: Term { kind, carrier, driver, coupling }, scanned }
}

fn each(kind: Kind, carrier: Carrier, driver: Driver) -> Candidate {
    candidate(kind, carrier, driver, Coupling::Each, 0)
}

fn paired(kind: Kind, carrier: Carrier, driver: Driver) -> Candidate {
    candidate(kind, carrier, driver, Coupling::Paired, 0)
}

fn joint_scale(survey: &Survey) -> Vec<Candidate> {
    survey.moving().map(|i| each(Kind::JointScale, Carrier::Joint(i), Driver::Reading(i))).collect()
}

/// Knees of a stiffening gear, and frictions, to try: fractions of the largest torque in the data.
const KNEES: [f64; 3] = [0.1, 0.3, 1.0];
const FRICTIONS: [f64; 4] = [0.12, 0.24, 0.4, 0.65];

fn helical_pitch(survey: &Survey) -> Vec<Candidate> {
    survey.turning().map(|i| each(Kind::HelicalPitch, Carrier::Along(i), Driver::Reading(i))).collect()
}

fn harmonics(kind: Kind, carrier: Carrier, joint: usize, orders: &[f64]) -> impl Iterator<Item = Candidate> {
    orders.iter().map(move |&order| {
        // An integer order is what an engineer would try first; any other was found by scan.
        let scanned = usize::from((order - order.round()).abs() > 1e-9);
        candidate(kind, carrier, Driver::Harmonic { joint, order }, Coupling::Each, scanned)
    })
}

fn transmission_error(survey: &Survey) -> Vec<Candidate> {
    survey
        .moving()
        .flat_map(|i| {
            let mut orders = survey.orders(i);
            orders.extend(survey.high_orders(i));
            orders.extend(survey.motor_orders(i));
            harmonics(Kind::TransmissionError, Carrier::Joint(i), i, &orders).collect::<Vec<_>>()
        })
        .collect()
}

fn joint_compliance(survey: &Survey) -> Vec<Candidate> {
    let by_motor = survey.moving().flat_map(|i| {
        let recorded = [MOTOR_TORQUE, EFFORT, CURRENT].into_iter().filter_map(move |ending| survey.of_joint(i, ending));
        recorded.map(move |column| each(Kind::JointCompliance, Carrier::Joint(i), Driver::Covariate(column)))
    });
    survey
        .moving()
        .filter(|&i| survey.statics.feels_gravity(i))
        .flat_map(|i| {
            let own = |driver: Driver, scanned: usize| {
                candidate(Kind::JointCompliance, Carrier::Joint(i), driver, Coupling::Each, scanned)
            };
            let mut terms = vec![own(Driver::Torque(i), 0), own(Driver::SprungTorque(i), 0)];
            terms.extend(survey.torques_of(i, &KNEES).map(|knee| own(Driver::HardeningTorque { joint: i, knee }, 1)));
            if !survey.statics.masses.from_inertials {
                let beyond = survey.statics.carried(i, usize::MAX).count();
                let depths: Vec<usize> = (1..=beyond).filter(|&links| links <= 2 || links == beyond).collect();
                terms.extend(depths.into_iter().map(|links| {
                    each(Kind::JointCompliance, Carrier::Joint(i), Driver::TorqueTerms { joint: i, links })
                }));
            }
            terms
        })
        .chain(by_motor)
        .collect()
}

fn backlash(survey: &Survey) -> Vec<Candidate> {
    survey
        .moving()
        .flat_map(|i| {
            let recorded = |(ending, from_rows): (&str, bool)| {
                Some(Side { joint: i, from_rows, column: survey.of_joint(i, ending)? })
            };
            let known = [(APPROACH, false), (APPROACH_FROM_ROWS, true)].into_iter().find_map(recorded);
            let by_side = known.clone().map(|side| each(Kind::Backlash, Carrier::Joint(i), Driver::Approach(side)));
            let by_gravity = each(Kind::Backlash, Carrier::Joint(i), Driver::GravitySide(i));
            let loaded = known.filter(|_| survey.statics.feels_gravity(i));
            let by_both = loaded.clone().into_iter().flat_map(move |side| {
                survey.torques_of(i, &FRICTIONS).map(move |friction| {
                    let driver = Driver::FrictionSide { side: side.clone(), friction };
                    candidate(Kind::Backlash, Carrier::Joint(i), driver, Coupling::Each, 1)
                })
            });
            let by_load = loaded.clone().map(|side| each(Kind::Backlash, Carrier::Joint(i), Driver::LoadedSide(side)));
            let wound_up = survey.wound_up(i).map(move |column| {
                candidate(Kind::Backlash, Carrier::Joint(i), Driver::Covariate(column), Coupling::Each, 1)
            });
            by_side.into_iter().chain([by_gravity]).chain(by_load).chain(wound_up).chain(by_both)
        })
        .collect()
}

fn joint_coupling(survey: &Survey) -> Vec<Candidate> {
    // In every row that shows one joint, the other has a reading.
    let shown = |i: usize, j: usize| survey.statics.tips.all().iter().all(|tip| !tip.joints[i] || tip.joints[j]);
    let others = |i: usize| survey.moving().filter(move |&j| j != i && shown(i, j)).map(move |j| (i, j));
    let pairs = survey.moving().flat_map(others);
    pairs.map(|(i, j)| each(Kind::JointCoupling, Carrier::Joint(i), Driver::Reading(j))).collect()
}

fn axis_wobble(survey: &Survey) -> Vec<Candidate> {
    survey
        .moving()
        .flat_map(|i| {
            let orders = survey.orders(i);
            let mut terms: Vec<_> = harmonics(Kind::AxisWobble, Carrier::AxisBasis(i), i, &orders).collect();
            if survey.slides(i) {
                terms.extend(harmonics(Kind::AxisWobble, Carrier::Sideways(i), i, &orders));
            }
            terms
        })
        .collect()
}

fn local_joint_error(survey: &Survey) -> Vec<Candidate> {
    survey
        .moving()
        .flat_map(|joint| {
            survey.bumps(joint).into_iter().map(move |(at, width)| {
                let driver = Driver::Bump { joint, at, width, shape: BumpShape::Bell };
                candidate(Kind::LocalJointError, Carrier::Joint(joint), driver, Coupling::Each, 2)
            })
        })
        .collect()
}

fn link_compliance(survey: &Survey) -> Vec<Candidate> {
    survey
        .turning()
        .flat_map(|i| {
            [
                paired(Kind::LinkCompliance, Carrier::LinkEnd(i), Driver::Cantilever(i)),
                paired(Kind::LinkCompliance, Carrier::AxisBasis(i), Driver::MomentAcross(i)),
                paired(Kind::LinkCompliance, Carrier::LinkEndTurn(i), Driver::EndMoment(i)),
            ]
        })
        .collect()
}

fn base_compliance(_: &Survey) -> Vec<Candidate> {
    vec![
        paired(Kind::BaseCompliance, Carrier::BaseTurn, Driver::Overturning),
        each(Kind::BaseCompliance, Carrier::BaseTurn, Driver::LevelOverturning),
    ]
}

fn tilt(survey: &Survey) -> Vec<Candidate> {
    let by = |column: &Column| {
        tilting(survey).map(|carrier| each(Kind::Tilt, carrier, Driver::Covariate(column.clone()))).collect::<Vec<_>>()
    };
    survey.tilts.iter().map(|(column, _)| column).flat_map(by).collect()
}

/// Carriers of an inclinometer: the base, and lifting columns.
pub fn tilting(survey: &Survey) -> impl Iterator<Item = Carrier> + '_ {
    let columns = survey.moving().filter(|&joint| survey.slides(joint)).map(Carrier::LinkEndTurn);
    std::iter::once(Carrier::BaseTurn).chain(columns)
}

/// Carriers that may move with temperature or time.
fn movable(survey: &Survey) -> Vec<Carrier> {
    let mut carriers: Vec<Carrier> = survey.moving().map(Carrier::Joint).collect();
    if survey.anchor {
        carriers.extend([Carrier::Reading, Carrier::Anchor]);
    }
    if survey.instrument {
        carriers.push(Carrier::Base);
    }
    carriers.extend([Carrier::Target, Carrier::Lengths, Carrier::Scale]);
    carriers
}

fn thermal(survey: &Survey) -> Vec<Candidate> {
    let links = (0..survey.statics.chain.joints().len()).map(Carrier::LinkLength);
    let general = movable(survey).into_iter().chain(links).flat_map(|carrier| {
        let of = |column: &Column| each(Kind::Thermal, carrier, Driver::Covariate(column.clone()));
        survey.temperatures.iter().map(of).collect::<Vec<_>>()
    });
    let own = survey.moving().filter_map(|i| {
        let own = survey.of_joint(i, ".temperature")?;
        Some(each(Kind::Thermal, Carrier::Joint(i), Driver::Covariate(own)))
    });
    let by_work = survey.moving().flat_map(|i| {
        let grows = [Carrier::Joint(i), Carrier::LinkLength(i)];
        let of = move |carrier, column: &Column| {
            candidate(Kind::Thermal, carrier, Driver::Covariate(column.clone()), Coupling::Each, 1)
        };
        let warmth: Vec<Column> = survey.warmth(i).collect();
        grows.into_iter().flat_map(move |carrier| warmth.iter().map(|column| of(carrier, column)).collect::<Vec<_>>())
    });
    general.chain(own).chain(by_work).collect()
}

fn drift(survey: &Survey) -> Vec<Candidate> {
    let Some(clock) = &survey.clock else { return Vec::new() };
    let column = || clock.column.clone();
    let mut terms = Vec::new();
    for carrier in movable(survey) {
        terms.push(each(Kind::Drift, carrier, Driver::Covariate(column())));
        for constant in clock.constants() {
            let driver = Driver::Decay { covariate: column(), from: clock.first(), constant };
            terms.push(candidate(Kind::Drift, carrier, driver, Coupling::Each, 1));
        }
        if matches!(carrier, Carrier::Lengths | Carrier::Scale) {
            continue;
        }
        for at in clock.places() {
            let driver = Driver::Steps { covariate: column(), at: vec![at] };
            terms.push(candidate(Kind::Drift, carrier, driver, Coupling::Each, 1));
        }
        for pieces in clock.pieces(carrier == Carrier::Reading) {
            terms.push(each(Kind::Drift, carrier, Driver::Smooth { covariate: column(), knots: pieces }));
        }
    }
    terms
}

fn latency(survey: &Survey) -> Vec<Candidate> {
    let known = !survey.velocities.is_empty();
    let term = || paired(Kind::Latency, Carrier::AllJoints, Driver::Velocities(survey.velocities.clone()));
    known.then(term).into_iter().collect()
}

fn instrument_scale(_: &Survey) -> Vec<Candidate> {
    vec![each(Kind::InstrumentScale, Carrier::Scale, Driver::Constant)]
}

fn target_incidence(survey: &Survey) -> Vec<Candidate> {
    let along = |carrier| each(Kind::TargetIncidence, carrier, Driver::Constant);
    if survey.sight { vec![along(Carrier::Sight), along(Carrier::Range)] } else { Vec::new() }
}
