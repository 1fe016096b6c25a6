//! The kinds of effect that the tracer knows, and the terms that it tries for each.
//!
//! One list: the search, `--effects`, the report and the docs page walk [`KINDS`]. A new kind is a variant of [`Kind`] and
//! an entry here; a new way for a known kind to act is a line in its `terms` function. The test
//! `every_kind_offers_terms_that_a_fit_can_use` covers both.

use crate::effects::carrier::Carrier;
use crate::effects::driver::{APPROACH, APPROACH_FROM_ROWS, BumpShape, CURRENT, Driver, EFFORT, MOTOR_TORQUE, Side};
use crate::effects::model::{Coupling, Term};
use crate::effects::survey::Survey;
use denavit_measurements::Column;
use serde::{Deserialize, Serialize};

/// An engineer's name for a cause.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Kind {
    /// A joint's motion is its reading times a constant factor.
    JointScale,
    /// A joint slides along its axis as it turns.
    HelicalPitch,
    /// A periodic error of a joint's value: eccentric encoder, gear.
    TransmissionError,
    /// A joint yields under gravity.
    JointCompliance,
    /// Play in a joint.
    Backlash,
    /// One joint's motion moves another.
    JointCoupling,
    /// A joint's axis tilts or shifts as it moves; a rail that is not straight.
    AxisWobble,
    /// An error at one place of a joint's range.
    LocalJointError,
    /// A link or a bearing bends under gravity.
    LinkCompliance,
    /// The base tilts under the arm's moment.
    BaseCompliance,
    /// The base or a column tilts, with the inclination recorded.
    Tilt,
    /// Something grows or moves with temperature.
    Thermal,
    /// Something moves with time, smoothly or in steps.
    Drift,
    /// Joint readings are older or newer than the measured value.
    Latency,
    /// The instrument's scale is wrong.
    InstrumentScale,
    /// The range depends on the target and on its orientation to the instrument.
    TargetIncidence,
    /// Errors of links and zeros in an averaged prediction: not a cause, so not in the catalogue.
    Geometry,
}

/// A kind's entry in the catalogue.
pub struct Entry {
    /// Which kind.
    pub kind: Kind,
    /// Its name in files and on the command line.
    pub name: &'static str,
    /// The model, with its symbols.
    pub formula: &'static str,
    /// Units of its coefficients.
    pub units: &'static str,
    /// Where the model comes from.
    pub source: &'static str,
    /// The terms to try on the data at hand.
    pub terms: fn(&Survey) -> Vec<Candidate>,
}

/// A term to try, and the number of its parameters that a scan chose.
#[derive(Debug, Clone, PartialEq)]
pub struct Candidate {
    /// The term.
    pub term: Term,
    /// Numbers inside the driver that a scan chose: they count as parameters.
    pub scanned: usize,
}

/// Every kind, in the order of the table in the docs.
pub const KINDS: &[Entry] = &[
    Entry {
        kind: Kind::JointScale,
        name: "joint_scale",
        formula: "value_i += c · value_i",
        units: "rad/rad or m/m",
        source: "Wu, Crawford, Roberts 2019, eq. (23)",
        terms: joint_scale,
    },
    Entry {
        kind: Kind::HelicalPitch,
        name: "helical_pitch",
        formula: "slide along axis i += c · value_i",
        units: "m/rad",
        source: "Wu, Crawford, Roberts 2019, section II",
        terms: helical_pitch,
    },
    Entry {
        kind: Kind::TransmissionError,
        name: "transmission_error",
        formula: "value_i += s · sin(k · value_i) + c · cos(k · value_i), k found by scan",
        units: "rad or m",
        source: "k = 1: eccentric encoder; motor side: k = gear ratio (Tuttle 1992 for harmonic drives)",
        terms: transmission_error,
    },
    Entry {
        kind: Kind::JointCompliance,
        name: "joint_compliance",
        formula: "value_i += c · torque on joint i: gravity's, payload included, less a spring's, or level beyond a knee found by scan; or the motor's, if recorded",
        units: "rad/(N m) or m/N",
        source: "Khalil, Besnard 2002; a gear that stiffens: Spong 1987",
        terms: joint_compliance,
    },
    Entry {
        kind: Kind::Backlash,
        name: "backlash",
        formula: "value_i += c · side, side = ±1 by approach, by gravity, or by the stronger of gravity and friction (found by scan); or side times gravity's torque, for friction that grows with load; or by travel since the last reversal",
        units: "rad or m (half of the play)",
        source: "play; friction and its memory: Dahl 1968",
        terms: backlash,
    },
    Entry {
        kind: Kind::JointCoupling,
        name: "joint_coupling",
        formula: "value_i += c · value_j",
        units: "rad/rad, m/rad, rad/m or m/m",
        source: "geared wrists: Whitney, Lozinski, Rourke 1986",
        terms: joint_coupling,
    },
    Entry {
        kind: Kind::AxisWobble,
        name: "axis_wobble",
        formula: "tilt of axis i about a and b += s · sin(k · value_i) + c · cos(k · value_i); for a rail also shifts",
        units: "rad or m",
        source: "error motions of a rotary axis, ISO 230-7; straightness, ISO 230-1",
        terms: axis_wobble,
    },
    Entry {
        kind: Kind::LocalJointError,
        name: "local_joint_error",
        formula: "value_i += c · bump((value_i - at)/width), a bell, a tent or a wave; at and width found by scan",
        units: "rad or m",
        source: "a damaged tooth or a scratch on the scale",
        terms: local_joint_error,
    },
    Entry {
        kind: Kind::LinkCompliance,
        name: "link_compliance",
        formula: "end of link i moves as a cantilever under gravity's wrench, c = 1/EI; or axis i tilts by c · moment across it",
        units: "1/(N m²); rad/(N m)",
        source: "Euler-Bernoulli beam; bearing stiffness",
        terms: link_compliance,
    },
    Entry {
        kind: Kind::BaseCompliance,
        name: "base_compliance",
        formula: "base turns by c · overturning moment, c one number or a 3 × 2 matrix",
        units: "rad/(N m)",
        source: "a floor or table as a spring",
        terms: base_compliance,
    },
    Entry {
        kind: Kind::Tilt,
        name: "tilt",
        formula: "base, or far end of a slide's link, turns by c · inclination, a column named tilt…",
        units: "rad per unit of the column",
        source: "lifting column: Kindle et al. 2025, IEEE RA-L 10(1)",
        terms: tilt,
    },
    Entry {
        kind: Kind::Thermal,
        name: "thermal",
        formula: "joint value, link lengths, base, target, anchor or instrument += c · temperature; or joint value or its link's length += c · warmth (recent travel)",
        units: "carrier's unit per °C; per rad/s or rad/row (m/s, m/row)",
        source: "thermal expansion; Newton's law of cooling",
        terms: thermal,
    },
    Entry {
        kind: Kind::Drift,
        name: "drift",
        formula: "the same carriers += c · f(time or run order), f linear, 1 - exp(-t/T), steps or straight pieces",
        units: "carrier's unit, or per s or row",
        source: "new setup, collision, creep, a sensor's zero",
        terms: drift,
    },
    Entry {
        kind: Kind::Latency,
        name: "latency",
        formula: "value_i += c · velocity_i for every joint",
        units: "s",
        source: "readings and measurement at different times",
        terms: latency,
    },
    Entry {
        kind: Kind::InstrumentScale,
        name: "instrument_scale",
        formula: "measured lengths are (1 + c) times too long",
        units: "m/m",
        source: "the instrument's scale",
        terms: instrument_scale,
    },
    Entry {
        kind: Kind::TargetIncidence,
        name: "target_incidence",
        formula: "range += c · u, u the direction from instrument to target in the tip's axes; or range += c",
        units: "m",
        source: "eccentric target (US patent 7388654); wrong prism constant",
        terms: target_incidence,
    },
];

/// Geometry as a part of an averaged prediction.
static GEOMETRY: Entry = Entry {
    kind: Kind::Geometry,
    name: "geometry",
    formula: "ends of links turned and shifted, values of joints off by a constant",
    units: "rad or m",
    source: "no effect: what a fit of the axes finds, too",
    terms: |_| Vec::new(),
};

impl Kind {
    /// The meaning of an effect of this kind, and the recommended action.
    pub fn advice(self) -> &'static str {
        match self {
            Self::JointScale => {
                "the joint turns more or less than it reads: compensate, or check encoder and gear ratio"
            }
            Self::HelicalPitch => "the joint moves along its axis as it turns: compensate",
            Self::TransmissionError => "the joint errs periodically: compensate, or check gear and encoder",
            Self::JointCompliance => "the joint yields under load: compensate, or check its gear",
            Self::Backlash => "the joint has play: compensate, or approach every pose from the same side",
            Self::JointCoupling => "the joint follows another joint: compensate",
            Self::AxisWobble => "the axis tilts as the joint turns: compensate, or check its bearing",
            Self::LocalJointError => "the joint errs in one part of its range: compensate, or check its gear there",
            Self::LinkCompliance => "the link or its bearing bends under load: compensate",
            Self::BaseCompliance => "the base moves under load: fasten it, or compensate",
            Self::Tilt => "it tilts as its inclinometer says: compensate with the recorded inclination",
            Self::Thermal => {
                "it depends on a temperature or on warmth: warm the robot up before measuring, or compensate"
            }
            Self::Drift => "it changed during the run: fasten it and measure again",
            Self::Latency => "readings and measured values were taken at different times: measure at standstill",
            Self::InstrumentScale => "the instrument's lengths are scaled: check its settings",
            Self::Geometry => "no named cause: included in the model",
            Self::TargetIncidence => "the range depends on the target's orientation: check the target",
        }
    }

    /// Its entry.
    pub fn entry(self) -> &'static Entry {
        KINDS.iter().chain([&GEOMETRY]).find(|entry| entry.kind == self).expect("every kind has an entry: tested")
    }

    /// Its name in files and on the command line.
    pub fn name(self) -> &'static str {
        self.entry().name
    }

    /// The kind of this name.
    pub fn named(name: &str) -> Option<Self> {
        KINDS.iter().find(|entry| entry.name == name).map(|entry| entry.kind)
    }
}

/// The catalogue as a table in Markdown: the one in `docs/effects-tables.md`.
pub fn markdown() -> String {
    let mut table = String::from("| kind | model | unit of c | source |\n|---|---|---|---|\n");
    for entry in KINDS {
        let Entry { name, formula, units, source, .. } = entry;
        table.extend(["| `", name, "` | ", formula, " | ", units, " | ", source, " |\n"]);
    }
    table
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::driver::{Conditions, Statics, VELOCITY};
    use crate::effects::survey::with_run_order;
    use denavit_measurements::kinds::ObservationKind;
    use denavit_measurements::{Covariate, Measurements, Scene};
    use denavit_model::examples;

    fn rich(chain: &denavit_model::Chain) -> Measurements {
        let rows = 60;
        let joints: Vec<String> = chain.coordinates().iter().map(|c| c.name.clone()).collect();
        let value = |row: usize, k: usize| (row as f64 * (0.7 + 0.31 * k as f64)).sin();
        let column =
            |name: String, slope: f64| Covariate { name, values: (0..rows).map(|row| slope * row as f64).collect() };
        let velocities = joints.iter().map(|joint| column(format!("{joint}{VELOCITY}"), 0.01));
        let rooms = [("time", 30.0), ("temperature", 0.1), ("tilt_x", 1e-3)];
        let covariates = rooms.map(|(name, slope)| column(name.into(), slope)).into_iter().chain(velocities);
        let covariates: Vec<Covariate> = covariates.collect();
        let mut data = Measurements::empty("rich.csv", joints, Scene::of(ObservationKind::Position, 1));
        let width = data.joints.len();
        for row in 0..rows {
            let reading: Vec<f64> = (0..width).map(|k| value(row, k)).collect();
            data.end_row(&reading, row + 2, false);
        }
        data.covariates = covariates.into();
        with_run_order(data)
    }

    #[test]
    fn every_kind_offers_terms_that_a_fit_can_use() {
        for chain in examples::all() {
            let statics = Statics::of_chain(&chain);
            let data = rich(&chain);
            let survey = Survey::of(&statics, &data, Vec::new());
            for entry in KINDS {
                let terms = (entry.terms)(&survey);
                let none = match entry.kind {
                    Kind::JointCompliance => !survey.moving().any(|joint| statics.feels_gravity(joint)),
                    _ => survey.turning().next().is_none(),
                };
                assert!(!terms.is_empty() || none, "{} on {}", entry.name, chain.name());
                for candidate in terms {
                    assert_eq!(candidate.term.kind, entry.kind);
                    let q = vec![0.2; chain.coordinates().len()];
                    let conditions = Conditions { reading: &q, recorded: data.covariates.row(7), tip: 0 };
                    let posture = statics.posture(chain.joints(), &conditions, None);
                    let mut values = Vec::new();
                    candidate.term.driver.values_into(&statics, &conditions, &posture, &mut values);
                    assert!(candidate.term.coefficients(&statics) > 0 && values.iter().all(|value| value.is_finite()));
                }
            }
        }
    }

    #[test]
    fn names_are_their_own_and_lead_back() {
        for entry in KINDS {
            assert_eq!(Kind::named(entry.name), Some(entry.kind));
            assert_eq!(serde_json::to_value(entry.kind).unwrap(), entry.name);
            assert_eq!(entry.kind.name(), entry.name);
        }
    }

    #[test]
    fn docs_show_this_catalogue() {
        let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/effects-tables.md");
        let docs = std::fs::read_to_string(path).unwrap();
        assert!(docs.contains(&markdown()), "put this into docs/effects-tables.md:\n{}", markdown());
    }
}
