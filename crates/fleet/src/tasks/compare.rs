//! `fingerprint` and `diff`: what the robot is, and how it differs from another.

use super::{Found, Summary, TaskError, load, note};
use crate::manifest::Entry;
use denavit_compare::{Options, Verdict, compare};

pub(super) fn fingerprint(entry: &Entry) -> Result<Found, TaskError> {
    let mut found = Found::default();
    let loaded = load(entry, &entry.robot, &mut found.notes)?;
    let print = denavit_compare::fingerprint(&loaded.subject(&entry.robot), entry.options.tolerance);
    found.summary = Summary { name: loaded.chains().robot, fingerprint: print.to_string(), ..Summary::default() };
    Ok(found)
}

pub(super) fn diff(entry: &Entry) -> Result<Found, TaskError> {
    let mut found = Found::default();
    let against = entry.against.as_deref().unwrap_or_default();
    let reference = load(entry, against, &mut found.notes)?;
    let loaded = load(entry, &entry.robot, &mut found.notes)?;
    let options = Options {
        tolerance_m: entry.options.tolerance_m,
        tolerance_rad: entry.options.tolerance_rad,
        ..Options::default()
    };
    let compared = compare(&reference.subject(against), &loaded.subject(&entry.robot), &options)?;
    let level = |counts: bool| if counts { "error" } else { "note" };
    for joint in &compared.joints {
        for change in &joint.changes {
            let sentence = format!("{}: {}", joint.joint, change.what);
            let named = serde_json::to_value(&change.what).expect("names are texts and numbers are numbers");
            let code = named["change"].as_str().unwrap_or_default();
            found.notes.push(note("difference", code, level(change.counts), &joint.joint, sentence));
        }
    }
    for tip in &compared.tips {
        let message = format!("{} is displaced by up to {:.3e} m", tip.tip, tip.sampled_m);
        let mut row = note("difference", "tip", "error", &tip.tip, message);
        row[5] = tip.sampled_m.into();
        row[6] = "m".into();
        found.notes.push(row);
    }
    for part in &compared.parts {
        found.notes.push(note("difference", "part", level(part.counts), &part.part, part.what.clone()));
    }
    found.notes.extend(compared.notes.iter().map(|text| note("difference", "", "note", "", text.clone())));
    let verdict = if compared.verdict == Verdict::Different { "different" } else { "same" };
    found.summary = Summary { name: compared.b.robot.clone(), verdict: verdict.into(), ..Summary::default() };
    Ok(found)
}
