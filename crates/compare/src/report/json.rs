//! Everything as JSON, two spaces deep.

use crate::comparison::Comparison;
use crate::report::{Entry, FileInventory, Report};
use crate::robots::Robots;
use denavit_model::{Inventory, Outcome};
use serde::Serialize;

#[derive(Serialize)]
struct FindingOut<'a> {
    rule: &'a str,
    level: crate::report::Level,
    file: &'a str,
    line: usize,
    element: &'a str,
    message: &'a str,
    fixable: bool,
}

/// What a comparison is called, and its version.
const COMPARISON: &str = "denavit.diff/1";
/// What the robots of a repository are called, and their version.
const ROBOTS: &str = "denavit.diff.robots/1";
/// What findings are called, and their version.
const FINDINGS: &str = "denavit.check/1";

#[derive(Serialize)]
struct ComparisonOut<'a> {
    schema: &'static str,
    #[serde(flatten)]
    comparison: &'a Comparison,
}

#[derive(Serialize)]
struct RobotsOut<'a> {
    schema: &'static str,
    #[serde(flatten)]
    robots: &'a Robots,
}

#[derive(Serialize)]
struct FindingsOut<'a> {
    schema: &'static str,
    files: &'a [String],
    findings: Vec<FindingOut<'a>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    known: Option<usize>,
    inventory: Vec<InventoryOut<'a>>,
}

/// What became of everything in a file.
#[derive(Serialize)]
struct InventoryOut<'a> {
    file: &'a str,
    understood: usize,
    carried: Vec<ItemOut<'a>>,
    not_understood: Vec<ItemOut<'a>>,
}

#[derive(Serialize)]
struct ItemOut<'a> {
    line: usize,
    element: &'a str,
    what: &'a str,
}

fn inventory(of: &FileInventory) -> InventoryOut<'_> {
    let FileInventory { file, inventory } = of;
    InventoryOut {
        file,
        understood: inventory.understood,
        carried: items(inventory, Outcome::Carried),
        not_understood: items(inventory, Outcome::Reported),
    }
}

fn items(inventory: &Inventory, outcome: Outcome) -> Vec<ItemOut<'_>> {
    let items = inventory.items.iter().filter(|item| item.outcome == outcome);
    items.map(|item| ItemOut { line: item.place.line, element: &item.place.element, what: &item.what }).collect()
}

pub(super) fn render(report: &Report) -> String {
    let text = match report {
        Report::Comparison(comparison) => {
            serde_json::to_string_pretty(&ComparisonOut { schema: COMPARISON, comparison })
        }
        Report::Robots(robots) => serde_json::to_string_pretty(&RobotsOut { schema: ROBOTS, robots }),
        Report::Findings { files, findings, inventories, known } => {
            let findings = findings.iter().map(|finding| FindingOut {
                rule: finding.rule,
                level: finding.level,
                file: &finding.place.file,
                line: finding.place.line,
                element: &finding.place.element,
                message: &finding.message,
                fixable: !finding.fix.is_empty(),
            });
            serde_json::to_string_pretty(&FindingsOut {
                schema: FINDINGS,
                files,
                findings: findings.collect(),
                known: *known,
                inventory: inventories.iter().map(inventory).collect(),
            })
        }
    };
    text.expect("plain values with text keys") + "\n"
}

impl Entry {
    /// `subject: message`, or the message alone where the entry is about the whole.
    pub(super) fn sentence(&self) -> String {
        if self.subject == "note" { self.message.clone() } else { format!("{}: {}", self.subject, self.message) }
    }
}
