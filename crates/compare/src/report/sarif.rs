//! SARIF 2.1.0: results with rules and places, for code scanning.
//!
//! # Source
//! OASIS, Static Analysis Results Interchange Format 2.1.0, sections 3.13 to 3.30.

use crate::lint::RULES;
use crate::report::{Entry, FileInventory, Report};
use denavit_model::Outcome;
use denavit_model::settings::plain;
use serde_json::{Value, json};
use std::fmt::Write;

pub(super) fn render(report: &Report) -> String {
    let results: Vec<Value> = report.entries().iter().map(result).collect();
    let rules: Vec<Value> = match report {
        Report::Comparison(_) | Report::Robots(_) => vec![json!({
            "id": "diff",
            "shortDescription": { "text": "The robot has changed" }
        })],
        Report::Findings { .. } => RULES
            .iter()
            .map(|rule| {
                json!({
                    "id": rule.code,
                    "name": rule.name,
                    "shortDescription": { "text": rule.summary },
                    "fullDescription": { "text": plain(rule.why) },
                })
            })
            .collect(),
    };
    let driver = json!({
        "name": "denavit",
        "version": env!("CARGO_PKG_VERSION"),
        "rules": rules,
    });
    let mut log = json!({
        "$schema": "https://json.schemastore.org/sarif-2.1.0.json",
        "version": "2.1.0",
        "runs": [{ "tool": { "driver": driver }, "results": results }]
    });
    if let Report::Findings { inventories, .. } = report {
        let counts = inventories.iter().map(|FileInventory { file, inventory }| {
            json!({
                "file": uri(file),
                "understood": inventory.understood,
                "carried": inventory.count(Outcome::Carried),
                "notUnderstood": inventory.count(Outcome::Reported),
            })
        });
        log["runs"][0]["properties"] = json!({ "inventory": counts.collect::<Vec<Value>>() });
    }
    serde_json::to_string_pretty(&log).expect("plain values with text keys") + "\n"
}

fn result(entry: &Entry) -> Value {
    let mut place = json!({ "artifactLocation": { "uri": uri(&entry.file) } });
    if let Some(line) = entry.line {
        place["region"] = json!({ "startLine": line });
    }
    json!({
        "ruleId": entry.code,
        "level": entry.level.word(),
        "message": { "text": entry.sentence() },
        "locations": [{ "physicalLocation": place }],
    })
}

/// A path as a URI reference: what a URI reserves is written as `%XX`.
fn uri(path: &str) -> String {
    let mut out = String::new();
    for byte in path.bytes() {
        if byte.is_ascii_alphanumeric() || b"-._~/:".contains(&byte) {
            out.push(char::from(byte));
        } else {
            let _ = write!(out, "%{byte:02X}");
        }
    }
    out
}
