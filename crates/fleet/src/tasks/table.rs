//! `table`: the D-H numbers of the chain, distal rows.

use super::{Found, Summary, TaskError, load, note, selection};
use crate::manifest::Entry;
use denavit_dh::Convention;
use denavit_load::{NEARLY_PARALLEL, TableOptions};

pub(super) fn run(entry: &Entry) -> Result<Found, TaskError> {
    let mut found = Found::default();
    let loaded = load(entry, &entry.robot, &mut found.notes)?;
    let options = TableOptions { convention: Some(Convention::Distal), gauge: None, tolerance: NEARLY_PARALLEL };
    let made = loaded.table(&selection(entry), &options)?.table;
    let table = made.value;
    for remark in &made.notes {
        found.notes.push(note("reading", "", "note", &entry.robot, remark.to_string()));
    }
    let mut numbers = |place: &str, values: [(&str, Option<f64>, &str); 5]| {
        for (name, value, unit) in values {
            if let Some(value) = value {
                let nothing = crate::store::table::Cell::Empty;
                let row = vec![
                    place.into(),
                    name.into(),
                    value.into(),
                    nothing.clone(),
                    nothing.clone(),
                    unit.into(),
                    nothing,
                ];
                found.parameters.push(row);
            }
        }
    };
    for (index, row) in table.rows.iter().enumerate() {
        let place =
            index.checked_sub(1).and_then(|joint| table.joints.get(joint)).map_or("", |joint| joint.name.as_str());
        numbers(
            place,
            [
                ("theta", Some(row.theta()), "rad"),
                ("d", row.d(), "m"),
                ("alpha", Some(row.alpha()), "rad"),
                ("a", Some(row.a()), "m"),
                ("beta", row.beta(), "rad"),
            ],
        );
    }
    let tool = [("tool_theta", Some(table.tool.theta), "rad"), ("tool_d", Some(table.tool.d), "m")];
    numbers("", [tool[0], tool[1], ("", None, ""), ("", None, ""), ("", None, "")]);
    let print = denavit_compare::fingerprint(&loaded.subject(&entry.robot), entry.options.tolerance);
    found.summary = Summary { name: table.name, fingerprint: print.to_string(), ..Summary::default() };
    Ok(found)
}
