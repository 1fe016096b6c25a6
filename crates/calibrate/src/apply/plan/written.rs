//! A plan as CSV for the robot, as text and as JSON.

use super::Plan;
use denavit_measurements::Units;
use denavit_measurements::kinds::ObservationKind;
use denavit_model::Chain;
use serde_json::json;
use std::fmt::Write;

/// Version of the JSON.
const SCHEMA: &str = "denavit.plan/1";

impl Plan {
    /// The poses as CSV for the robot: a header of joint names; the indices and the units as comments.
    pub fn to_csv(&self, chain: &Chain, units: Units) -> String {
        let mut text = String::new();
        for line in self.to_text().lines() {
            let _ = writeln!(text, "# {line}");
        }
        let _ = writeln!(text, "# units: {units}");
        let _ = writeln!(text, "{}", self.joints.join(","));
        for pose in &self.poses {
            let values = chain.coordinates().iter().zip(pose);
            let cells: Vec<String> = values.map(|(joint, value)| format!("{:.9}", value / units.of(joint))).collect();
            let _ = writeln!(text, "{}", cells.join(","));
        }
        text
    }

    /// The same as JSON.
    pub fn to_json(&self, chain: &Chain, kind: ObservationKind) -> String {
        let mut value = json!({
            "schema": SCHEMA,
            "robot": chain.name(),
            "base": chain.base(),
            "tip": chain.tip(),
            "measurement": kind,
            "candidates": self.usable,
            "joints": self.joints,
            "poses": self.poses,
            "observability": self.observability,
            "at_random": self.at_random,
        });
        if self.with_prior {
            value["with_prior"] = json!(true);
        }
        serde_json::to_string_pretty(&value).expect("names are texts and numbers are numbers") + "\n"
    }

    /// What was chosen, and how observable it makes the parameters.
    pub fn to_text(&self) -> String {
        let mut text = format!(
            "{} of {} candidates chosen, {} exchanges; {} parameters observable{}\n",
            self.poses.len(),
            self.usable,
            self.exchanges,
            self.observability.rank,
            if self.with_prior { ", the prior counted as rows" } else { "" }
        );
        let (own, other) = (&self.observability, &self.at_random);
        let _ = writeln!(text, "index  chosen     at random");
        for (name, a, b, meaning) in [
            ("O1", own.o1, other.o1, "geometric mean of the singular values (Borm, Menq 1991)"),
            ("O2", own.o2, other.o2, "smallest over largest (Driels, Pathre 1990)"),
            ("O3", own.o3, other.o3, "smallest (Nahvi, Hollerbach, Hayward 1994)"),
            ("O4", own.o4, other.o4, "smallest² over largest (Nahvi, Hollerbach 1996)"),
            ("O5", own.o5, other.o5, "harmonic sum (Sun, Hollerbach 2008)"),
        ] {
            let _ = writeln!(text, "{name}     {a:<9.3e}  {b:<9.3e}  {meaning}");
        }
        text
    }
}
