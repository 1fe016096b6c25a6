//! The kinds of effect that the tracer knows.
//!
//! One list: `--effects`, the report and the docs page walk [`KINDS`]. A new kind is a variant of [`Kind`], an entry here and a function
//! in [`candidates`](super::candidates).

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
}

/// Every kind, in the order of the table in the docs.
pub const KINDS: &[Entry] = &[
    Entry {
        kind: Kind::JointScale,
        name: "joint_scale",
        formula: "value_i += c · value_i",
        units: "rad/rad or m/m",
        source: "Wu, Crawford, Roberts 2019, eq. (23)",
    },
    Entry {
        kind: Kind::HelicalPitch,
        name: "helical_pitch",
        formula: "slide along axis i += c · value_i",
        units: "m/rad",
        source: "Wu, Crawford, Roberts 2019, section II",
    },
    Entry {
        kind: Kind::TransmissionError,
        name: "transmission_error",
        formula: "value_i += s · sin(k · value_i) + c · cos(k · value_i), k found by scan",
        units: "rad or m",
        source: "k = 1: eccentric encoder; motor side: k = gear ratio (Tuttle 1992 for harmonic drives)",
    },
    Entry {
        kind: Kind::JointCompliance,
        name: "joint_compliance",
        formula: "value_i += c · torque on joint i: gravity's, payload included, less a spring's, or level beyond a knee found by scan; or the motor's, if recorded",
        units: "rad/(N m) or m/N",
        source: "Khalil, Besnard 2002; a gear that stiffens: Spong 1987",
    },
    Entry {
        kind: Kind::Backlash,
        name: "backlash",
        formula: "value_i += c · side, side = ±1 by approach, by gravity, or by the stronger of gravity and friction (found by scan); or side times gravity's torque, for friction that grows with load; or by travel since the last reversal",
        units: "rad or m (half of the play)",
        source: "play; friction and its memory: Dahl 1968",
    },
    Entry {
        kind: Kind::JointCoupling,
        name: "joint_coupling",
        formula: "value_i += c · value_j",
        units: "rad/rad, m/rad, rad/m or m/m",
        source: "geared wrists: Whitney, Lozinski, Rourke 1986",
    },
    Entry {
        kind: Kind::AxisWobble,
        name: "axis_wobble",
        formula: "tilt of axis i about a and b += s · sin(k · value_i) + c · cos(k · value_i); for a rail also shifts",
        units: "rad or m",
        source: "error motions of a rotary axis, ISO 230-7; straightness, ISO 230-1",
    },
    Entry {
        kind: Kind::LocalJointError,
        name: "local_joint_error",
        formula: "value_i += c · bump((value_i - at)/width), a bell, a tent or a wave; at and width found by scan",
        units: "rad or m",
        source: "a damaged tooth or a scratch on the scale",
    },
    Entry {
        kind: Kind::LinkCompliance,
        name: "link_compliance",
        formula: "end of link i moves as a cantilever under gravity's wrench, c = 1/EI; or axis i tilts by c · moment across it",
        units: "1/(N m²); rad/(N m)",
        source: "Euler-Bernoulli beam; bearing stiffness",
    },
    Entry {
        kind: Kind::BaseCompliance,
        name: "base_compliance",
        formula: "base turns by c · overturning moment, c one number or a 3 × 2 matrix",
        units: "rad/(N m)",
        source: "a floor or table as a spring",
    },
    Entry {
        kind: Kind::Tilt,
        name: "tilt",
        formula: "base, or far end of a slide's link, turns by c · inclination, a column named tilt…",
        units: "rad per unit of the column",
        source: "lifting column: Kindle et al. 2025, IEEE RA-L 10(1)",
    },
    Entry {
        kind: Kind::Thermal,
        name: "thermal",
        formula: "joint value, link lengths, base, target, anchor or instrument += c · temperature; or joint value or its link's length += c · warmth (recent travel)",
        units: "carrier's unit per °C; per rad/s or rad/row (m/s, m/row)",
        source: "thermal expansion; Newton's law of cooling",
    },
    Entry {
        kind: Kind::Drift,
        name: "drift",
        formula: "the same carriers += c · f(time or run order), f linear, 1 - exp(-t/T), steps or straight pieces",
        units: "carrier's unit, or per s or row",
        source: "new setup, collision, creep, a sensor's zero",
    },
    Entry {
        kind: Kind::Latency,
        name: "latency",
        formula: "value_i += c · velocity_i for every joint",
        units: "s",
        source: "readings and measurement at different times",
    },
    Entry {
        kind: Kind::InstrumentScale,
        name: "instrument_scale",
        formula: "measured lengths are (1 + c) times too long",
        units: "m/m",
        source: "the instrument's scale",
    },
    Entry {
        kind: Kind::TargetIncidence,
        name: "target_incidence",
        formula: "range += c · u, u the direction from instrument to target in the tip's axes; or range += c",
        units: "m",
        source: "eccentric target (US patent 7388654); wrong prism constant",
    },
];

/// Geometry as a part of an averaged prediction.
static GEOMETRY: Entry = Entry {
    kind: Kind::Geometry,
    name: "geometry",
    formula: "ends of links turned and shifted, values of joints off by a constant",
    units: "rad or m",
    source: "no effect: what a fit of the axes finds, too",
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

#[cfg(test)]
mod tests {
    use super::*;

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
