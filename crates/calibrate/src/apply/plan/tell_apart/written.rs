//! What the poses are for, and the poses, as text, CSV and JSON.

use super::{Possible, TellApart};
use crate::observation::measurements::Units;
use denavit_model::Chain;
use serde_json::{Map, Value, json};
use std::fmt::Write;

/// Version of the JSON.
const SCHEMA: &str = "denavit.tell_apart/1";
/// Odds beyond this are not told further: no model is that true.
const MOST_ODDS: f64 = 1e6;

/// The causes of a hypothesis in words.
fn title(possible: &Possible) -> String {
    let each = possible.causes.iter().map(|cause| format!("{} at {}", cause.kind.name(), cause.place));
    let curve = possible.curve.iter().map(|joint| format!("an error curve of {joint}, no cause known"));
    let all: Vec<String> = each.chain(curve).collect();
    if all.is_empty() { "no cause".into() } else { all.join(" and ") }
}

/// Odds as one says them: 40:1, 1:40.
fn odds(log: f64) -> String {
    let of = |odds: f64| match odds {
        odds if odds > MOST_ODDS => "over 1000000".into(),
        odds if odds < 9.5 => format!("{odds:.1}"),
        odds => format!("{:.0}", round_to_two(odds)),
    };
    if log < 0.0 { format!("1:{}", of((-log).exp())) } else { format!("{}:1", of(log.exp())) }
}

/// To two digits that count.
fn round_to_two(number: f64) -> f64 {
    let unit = 10f64.powf(number.log10().floor() - 1.0);
    (number / unit).round() * unit
}

fn percent(probability: f64) -> String {
    match probability {
        p if p > 0.995 => "over 99 %".into(),
        p if p < 0.005 => "below 1 %".into(),
        p => format!("{:.0} %", 100.0 * p),
    }
}

impl TellApart {
    /// Whether there is anything to tell apart.
    pub fn open(&self) -> bool {
        self.possible.len() > 1
    }

    /// The pair that is hardest to tell apart: the one whose smaller expected odds are the smallest.
    fn hardest(&self) -> Option<&super::Pair> {
        let least = |pair: &super::Pair| pair.expected[0].min(-pair.expected[1]);
        self.pairs.iter().min_by(|a, b| least(a).total_cmp(&least(b)))
    }

    /// A short paragraph for the report of a calibration; none where nothing is open.
    pub fn in_short(&self) -> Option<String> {
        let pair = self.hardest()?;
        let [a, b] = pair.of.map(|index| title(&self.possible[index]));
        let count = self.poses.len();
        let settles = if pair.separated {
            format!(
                "{count} more poses would settle what is open, hardest {a} against {b}: odds now {}, expected {} if the former is \
                 true and {} if the latter",
                odds(pair.log_odds),
                odds(pair.expected[0]),
                odds(pair.expected[1])
            )
        } else {
            format!("{count} more poses would not settle {a} against {b}{}", self.instead(pair))
        };
        let [now, after] = self.unsure.map(|error| error * 1e3);
        Some(format!(
            "{settles}. The error that remains unsure would fall from {now:.3} to {after:.3} mm (root mean square over the joint \
             range). `denavit plan ROBOT --tell-apart RUN.csv` writes the poses."
        ))
    }

    /// What would tell a pair apart that poses do not.
    fn instead(&self, pair: &super::Pair) -> String {
        if pair.vary.is_empty() {
            return ": no pose that was offered separates them; another payload, another kind of measurement, another place of \
                    the instrument or of the target is needed"
                .into();
        }
        format!(": poses alone cannot; vary {}", pair.vary.join(" and "))
    }

    /// What is open, what is expected of the poses.
    pub fn to_text(&self) -> String {
        let mut text = String::new();
        if self.open() {
            let _ = writeln!(text, "what may act, as the run leaves it:");
            for (index, possible) in self.possible.iter().enumerate() {
                let _ = writeln!(text, "  {}  {:<9}  {}", index + 1, percent(possible.probability), title(possible));
            }
        } else {
            let _ = writeln!(text, "nothing is open: poses are chosen for the prediction alone");
        }
        let for_prediction = self.poses.len() - self.for_separation;
        let _ = write!(text, "{} of {} candidates chosen", self.poses.len(), self.usable);
        if self.open() {
            let _ = write!(
                text,
                ": {} to tell these apart, {} exchanges, {} for the prediction",
                self.for_separation, self.exchanges, for_prediction
            );
        }
        text.push('\n');
        if self.open() {
            let _ = writeln!(text, "pair     odds now       expected if the first is true, if the second is");
            for pair in &self.pairs {
                let [a, b] = pair.of.map(|index| index + 1);
                let name = format!("{a} : {b}");
                let [first, second] = pair.expected.map(odds);
                let _ = writeln!(text, "{name:<7}  {:<13}  {first:<15}  {second}", odds(pair.log_odds));
            }
            for pair in self.pairs.iter().filter(|pair| !pair.separated) {
                let [a, b] = pair.of.map(|index| index + 1);
                let _ = writeln!(text, "{a} and {b} are not told apart{}", self.instead(pair));
            }
        }
        let [now, after] = self.unsure.map(|error| error * 1e3);
        let _ = writeln!(
            text,
            "error that remains unsure: {now:.3} mm now, {after:.3} mm expected with these poses (root mean square over the joint range)"
        );
        for approach in &self.approach {
            let joint = &approach.joint;
            let _ = if approach.by_order {
                writeln!(
                    text,
                    "measure in this order, from pose to pose without a detour: it makes {joint} come from below first, then from \
                     above, as was chosen; begin with {joint} below the first pose"
                )
            } else {
                writeln!(text, "approach each pose with {joint} rising where {joint}.approach is 1, falling where it is -1")
            };
        }
        text
    }

    /// The poses as CSV for the robot: a header of joint names, and the sides of approach that the measured file must have; what
    /// they are for as comments.
    pub fn to_csv(&self, chain: &Chain, units: Units) -> String {
        let mut text = String::new();
        for line in self.to_text().lines() {
            let _ = writeln!(text, "# {line}");
        }
        let _ = writeln!(text, "# units: {units}");
        let written: Vec<&super::Approach> = self.approach.iter().filter(|approach| !approach.by_order).collect();
        let sides = written.iter().map(|approach| format!("{}.approach", approach.joint));
        let header: Vec<String> = self.joints.iter().cloned().chain(sides).collect();
        let _ = writeln!(text, "{}", header.join(","));
        for (index, pose) in self.poses.iter().enumerate() {
            let values = chain.coordinates().iter().zip(pose);
            let cells = values.map(|(joint, value)| format!("{:.9}", value / units.of(joint)));
            let sides = written.iter().map(|approach| format!("{:.0}", approach.sides[index]));
            let _ = writeln!(text, "{}", cells.chain(sides).collect::<Vec<String>>().join(","));
        }
        text
    }

    /// The same as JSON; odds as natural logarithms, lengths in m.
    pub fn to_json(&self, chain: &Chain) -> String {
        let mut value = json!({
            "schema": SCHEMA,
            "robot": chain.name(),
            "base": chain.base(),
            "tip": chain.tip(),
        });
        let all = value.as_object_mut().expect("an object was written");
        self.members(all);
        all.insert("candidates".into(), json!(self.usable));
        all.insert("joints".into(), json!(self.joints));
        all.insert("poses".into(), json!(self.poses));
        let approach = self.approach.iter().map(|approach| {
            json!({ "joint": approach.joint, "by_order": approach.by_order, "sides": approach.sides })
        });
        all.insert("approach".into(), approach.collect());
        serde_json::to_string_pretty(&value).expect("names are texts and numbers are numbers") + "\n"
    }

    /// What is open and what is expected: the part that a calibration's report has, too.
    fn members(&self, all: &mut Map<String, Value>) {
        let possible = self.possible.iter().map(|possible| {
            let causes: Vec<Value> = possible
                .causes
                .iter()
                .map(|cause| json!({ "kind": cause.kind.name(), "place": cause.place }))
                .collect();
            json!({ "causes": causes, "curve": possible.curve, "probability": possible.probability, "follows": possible.follows })
        });
        all.insert("possible".into(), possible.collect());
        let pairs = self.pairs.iter().map(|pair| {
            json!({
                "of": pair.of,
                "log_odds": pair.log_odds,
                "expected_if_first": pair.expected[0],
                "expected_if_second": pair.expected[1],
                "separated": pair.separated,
                "vary": pair.vary,
            })
        });
        all.insert("pairs".into(), pairs.collect());
        all.insert("for_separation".into(), json!(self.for_separation));
        all.insert("unsure".into(), json!({ "now": self.unsure[0], "expected": self.unsure[1] }));
    }
}
