//! How every column of a file was read: listed in the report, so that nothing is left out silently.

use super::Measurements;
use super::header::{Header, OF_TWO_TIPS, Role};
use super::known_columns::{KNOWN_COVARIATES, OF_JOINTS};
use crate::kinds::Frame;
use denavit_model::{Inventory, Place};
use serde::Serialize;

/// A column and its meaning.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct ColumnUse {
    /// Its name in the header row.
    pub column: String,
    /// Its meaning, such as `joint reading` or `label`.
    pub taken_for: String,
}

/// The meanings of a file's columns, in its order.
pub(super) fn used(header: &Header, data: &Measurements) -> Vec<ColumnUse> {
    let other = |name: &str| {
        let of_joint = name
            .rsplit_once('.')
            .filter(|(joint, word)| OF_JOINTS.contains(word) && data.joints.iter().any(|known| known == joint));
        if KNOWN_COVARIATES.contains(&name)
            || ((name == "tip" || OF_TWO_TIPS.iter().any(|(word, _)| *word == name)) && data.scene.tips().is_some())
        {
            return name.to_owned();
        }
        if let Some((joint, word)) = of_joint {
            return format!("{word} of {joint}");
        }
        let numbers = data.covariates.iter().any(|covariate| covariate.name == name);
        if numbers { "recorded number" } else { "label" }.to_owned()
    };
    let of = |(name, role): (&String, &Role)| ColumnUse {
        column: name.clone(),
        taken_for: match role {
            Role::Joint(_) => "joint reading".into(),
            Role::Value(group, column) => {
                let group = &header.groups[*group];
                let target = match group.target.as_str() {
                    "" => "the target".into(),
                    target => format!("target {target}"),
                };
                if group.corner.is_some() {
                    "pixels of corners of the board".into()
                } else if group.kind.is_turned_alone() {
                    format!("{} of {target}", group.kind.plural())
                } else if *column >= group.kind.lengths() {
                    format!("orientation of {target} (quaternion)")
                } else if group.kind.unknowns().frame == Frame::Instrument {
                    format!("position of {target}")
                } else {
                    format!("{} of {target}", group.kind.name())
                }
            }
            Role::Spread(_) => "standard deviation".into(),
            Role::Corner => "which corner of the board".into(),
            Role::Locate => "rows that place a target".into(),
            Role::Other => other(name),
        },
    };
    header.names.iter().zip(&header.roles).map(of).collect()
}

/// What happened to the cells: those of joints and measured values are understood, others are carried as numbers or labels, and
/// rows without measured values are reported.
pub(super) fn inventory(header: &Header, data: &Measurements) -> Inventory {
    let mut inventory = Inventory::default();
    let place = |line: usize, element: &str| Place { file: data.source.clone(), line, element: element.into() };
    for (name, role) in header.names.iter().zip(&header.roles) {
        let has_meaning = KNOWN_COVARIATES.contains(&name.as_str())
            || name.rsplit_once('.').is_some_and(|(joint, _)| data.joints.iter().any(|known| known == joint));
        if *role != Role::Other || has_meaning {
            inventory.understood += data.len();
            continue;
        }
        let as_what = if data.covariate(name).is_some() { "recorded number" } else { "label" };
        inventory.carry(place(1, as_what), format!("column \"{name}\""));
    }
    for row in (0..data.len()).filter(|&row| data.of_row(row).is_empty()) {
        inventory.report(place(data.lines[row], "row"), "nothing was measured in it");
    }
    inventory
}

/// The same in a few lines, with neighbours of the same meaning combined.
pub fn in_words(columns: &[ColumnUse]) -> String {
    let mut parts = Vec::new();
    for together in columns.chunk_by(|a, b| a.taken_for == b.taken_for) {
        let names: Vec<&str> = together.iter().map(|column| column.column.as_str()).collect();
        let taken_for = &together[0].taken_for;
        let shown = match names[..] {
            [name] if name == taken_for => name.to_owned(),
            [name] => format!("{name} ({taken_for})"),
            [first, second] => format!("{first}, {second} ({taken_for})"),
            [first, second, third] => format!("{first}, {second}, {third} ({taken_for})"),
            [first, .., last] => format!("{first} … {last} ({} × {taken_for})", names.len()),
            [] => continue,
        };
        parts.push(shown);
    }
    parts.join("; ")
}
