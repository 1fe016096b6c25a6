//! What the poses are for, and the poses, as text, CSV and JSON.

use super::{Pair, Possible, Prospect, TellApart, Unsure};
use denavit_measurements::Units;
use denavit_model::Chain;
use serde_json::json;
use std::fmt::Write;

/// Version of the JSON.
const SCHEMA: &str = "denavit.tell_apart/1";
/// Odds are printed up to this: no model is that true.
const MOST_ODDS: f64 = 1e6;
/// Pairs are reported if the geometric mean of their probabilities is above this.
const IN_QUESTION: f64 = 0.02;

/// Causes and curves that a set holds, in words.
fn parts(possible: &Possible) -> Vec<String> {
    let causes = possible.causes.iter().map(|cause| format!("{} at {}", cause.kind.name(), cause.place));
    let curves = possible.curves.iter().map(|joint| format!("an error curve of {joint}"));
    causes.chain(curves).collect()
}

/// Those of `all` that are not among `others`.
fn beyond(all: &[String], others: &[String]) -> String {
    all.iter().filter(|part| !others.contains(part)).cloned().collect::<Vec<String>>().join(" and ")
}

/// Odds as one says them: 40:1, 1:40.
fn odds(log: f64) -> String {
    if log.abs() > MOST_ODDS.ln() {
        return if log > 0.0 { format!("over {MOST_ODDS:.0}:1") } else { format!("below 1:{MOST_ODDS:.0}") };
    }
    let of = |odds: f64| if odds < 9.5 { format!("{odds:.1}") } else { format!("{:.0}", round_to_two(odds)) };
    if log < 0.0 { format!("1:{}", of((-log).exp())) } else { format!("{}:1", of(log.exp())) }
}

/// To two significant digits.
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

impl Prospect {
    /// Whether there is anything to tell apart.
    pub fn open(&self) -> bool {
        self.possible.len() > 1
    }

    /// Pairs in which both are probable enough to be reported.
    fn in_question(&self) -> impl Iterator<Item = &Pair> {
        let weight =
            |pair: &&Pair| pair.of.iter().map(|&index| self.possible[index].log_probability).sum::<f64>() / 2.0;
        self.pairs.iter().filter(move |pair| weight(pair) > IN_QUESTION.ln())
    }

    /// A short paragraph for the report of a calibration; `None` if no cause is uncertain.
    pub fn in_short(&self) -> Option<String> {
        // The most probable, and the next that lacks a cause of it.
        let causes = |index: usize| &self.possible[index].causes;
        let lacks = |pair: &&Pair| pair.of[0] == 0 && causes(0).iter().any(|cause| !causes(pair.of[1]).contains(cause));
        let pair = self.pairs.iter().find(lacks).or_else(|| self.pairs.first())?;
        // What both hold is not in question.
        let [first, second] = pair.of.map(|index| parts(&self.possible[index]));
        let (poses, Unsure { now, expected }) = (self.poses, self.unsure);
        let (what, ends) = match (beyond(&first, &second), beyond(&second, &first)) {
            (a, b) if b.is_empty() => (format!("whether there is {a}"), ["there is", "there is not"]),
            (a, b) if a.is_empty() => (format!("whether there is {b}"), ["there is not", "there is"]),
            (a, b) => (format!("whether it is {a}, or {b}"), ["it is the first", "it is the second"]),
        };
        let expected_odds = if pair.separated {
            format!(
                "{poses} more poses would show {what}: the odds are {} now, {} if {}, {} if {}. `denavit plan` with ‹tell-apart› writes them.",
                odds(pair.log_odds),
                odds(pair.expected_if_first),
                ends[0],
                odds(pair.expected_if_second),
                ends[1]
            )
        } else {
            format!("{poses} more poses would not show {what}: {}.", instead(pair))
        };
        Some(format!(
            "{expected_odds} The uncertainty of the prediction is {:.3} mm now, {:.3} mm expected with them (root mean square over \
             the joint range).",
            now * 1e3,
            expected * 1e3
        ))
    }
}

/// What would distinguish a pair that poses do not.
fn instead(pair: &Pair) -> String {
    if pair.vary.is_empty() {
        return "change the payload, the kind of measurement, or the place of the instrument or the target".into();
    }
    format!("vary {} as well", pair.vary.join(" and "))
}

impl TellApart {
    /// The possible causes, and what the poses are expected to show.
    pub fn to_text(&self) -> String {
        let mut text = String::new();
        let prospect = &self.prospect;
        if prospect.open() {
            let each: Vec<Vec<String>> = prospect.possible.iter().map(parts).collect();
            let in_all: Vec<String> =
                each[0].iter().filter(|part| each.iter().all(|set| set.contains(part))).cloned().collect();
            if !in_all.is_empty() {
                let _ = writeln!(text, "in any case: {}", in_all.join(" and "));
            }
            let _ = writeln!(text, "possible causes:");
            for (index, (possible, set)) in prospect.possible.iter().zip(&each).enumerate() {
                let own = beyond(set, &in_all);
                let none = if in_all.is_empty() { "no cause" } else { "no other" };
                let own = if own.is_empty() { none } else { &own };
                let _ = writeln!(text, "  {}  {:<9}  {own}", index + 1, percent(possible.probability));
            }
        } else {
            let _ = writeln!(text, "no cause is uncertain: the poses are chosen for the prediction alone");
        }
        let _ = write!(text, "{} of {} candidates chosen", self.poses.len(), self.usable);
        if prospect.open() {
            let for_prediction = self.poses.len() - prospect.for_separation;
            let apart = prospect.for_separation;
            let _ = write!(text, ": {apart} to distinguish these, {for_prediction} for the prediction");
        }
        text.push('\n');
        if prospect.open() {
            let _ = writeln!(text, "pair     odds now         expected if the first is true, if the second is");
            for pair in prospect.pairs.iter().filter(|pair| pair.of[0] == 0) {
                let [a, b] = pair.of.map(|index| index + 1);
                let name = format!("{a} : {b}");
                let [first, second] = [pair.expected_if_first, pair.expected_if_second].map(odds);
                let _ = writeln!(text, "{name:<7}  {:<15}  {first:<28}  {second}", odds(pair.log_odds));
            }
            for pair in prospect.in_question().filter(|pair| !pair.separated) {
                let [a, b] = pair.of.map(|index| index + 1);
                let _ = writeln!(text, "these poses do not distinguish {a} and {b}: {}", instead(pair));
            }
        }
        let Unsure { now, expected } = prospect.unsure;
        let _ = writeln!(
            text,
            "uncertainty of the prediction: {:.3} mm now, {:.3} mm expected with these poses (root mean square over the {})",
            now * 1e3,
            expected * 1e3,
            if self.at_given { "candidates" } else { "joint range" }
        );
        for approach in &self.approach {
            let joint = &approach.joint;
            let _ = if approach.by_order {
                writeln!(
                    text,
                    "measure in this order, directly from pose to pose: {joint} then comes from below first and from above \
                     later, as planned; begin with {joint} below the first pose"
                )
            } else {
                writeln!(
                    text,
                    "approach each pose with {joint} rising where {joint}.approach is 1, falling where it is -1"
                )
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
        let value = json!({
            "schema": SCHEMA,
            "robot": chain.name(),
            "base": chain.base(),
            "tip": chain.tip(),
            "candidates": self.usable,
            "joints": self.joints,
            "poses": self.poses,
            "approach": self.approach,
            "prospect": self.prospect,
        });
        serde_json::to_string_pretty(&value).expect("names are texts and numbers are numbers") + "\n"
    }
}
