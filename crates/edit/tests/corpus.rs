//! Every operation over every URDF at hand: done, refused with the reason, never wrong.

use crate::support::{edit, files, top};
use denavit_compare::comparison::PartKind;
use denavit_compare::{Options, PartDifference, Subject, compare};
use denavit_edit::EditError;
use denavit_model::robot::Robot;
use denavit_model::{Reading, urdf};
use std::collections::BTreeMap;
use std::path::PathBuf;

/// Folders beside the project and those that the environment names, separated by colons.
fn corpus() -> Vec<PathBuf> {
    let mut folders = vec![top().join("robots")];
    let vendor = top().join("../shared/vendor");
    if vendor.is_dir() {
        folders.extend([vendor.join("robots"), vendor.join("xacro"), vendor.join("quirky")]);
    } else {
        println!(
            "skipped, because the vendors' files (../shared/vendor) are not beside this clone: their part of the corpus"
        );
    }
    if let Ok(more) = std::env::var("DENAVIT_ROBOTS") {
        folders.extend(more.split(':').map(PathBuf::from));
    }
    folders.iter().flat_map(|folder| files(folder, "urdf")).collect()
}

/// What there is to ask of a robot, and how it is undone, if it can be in one call.
fn asked(robot: &Robot) -> Vec<(&'static str, String, Option<String>)> {
    let mut asked = Vec::new();
    let moving = robot.joints.iter().filter(|joint| joint.kind.has_one_value());
    for joint in moving.take(2) {
        let name = &joint.name;
        if name.contains([' ', ';']) {
            continue;
        }
        asked.push(("flip", format!("flip {name}"), Some(format!("flip {name}"))));
        asked.push(("zero", format!("zero {name}=0.25"), Some(format!("zero {name}=-0.25"))));
    }
    let root = &robot.links[robot.root].name;
    for leaf in robot.leaves().into_iter().take(1) {
        let leaf = &robot.links[leaf].name;
        if !leaf.contains([' ', ';']) && !root.contains([' ', ';']) {
            asked.push(("reroot", format!("reroot {leaf}"), Some(format!("reroot {root}"))));
        }
    }
    if !root.contains([' ', ';', '=']) {
        asked.push((
            "rename",
            format!("rename link:{root}=another_root"),
            Some(format!("rename link:another_root={root}")),
        ));
    }
    asked.push(("prefix", "prefix left_".into(), None));
    asked.push(("merge", "merge".into(), None));
    asked.push(("mirror", "mirror xz".into(), Some("mirror xz".into())));
    asked.push(("mirror", "mirror yz".into(), Some("mirror yz".into())));
    let middle = &robot.links[robot.links.len() / 2].name;
    if !middle.contains([' ', ';']) {
        asked.push(("extract", format!("extract {middle}"), None));
        asked.push(("cut", format!("cut {middle}"), None));
    }
    asked
}

fn same(before: &Robot, text: &str) -> Result<(), String> {
    let after = urdf::read("after.urdf", text).map_err(|error| error.to_string())?;
    let options = Options { samples: 0, reading: Reading::AsWritten, ..Options::default() };
    let found =
        compare(&Subject::Robot(before), &Subject::Robot(&after), &options).map_err(|error| error.to_string())?;
    // A default that is stated is the same transmission.
    let stated = |part: &&PartDifference| {
        part.kind == PartKind::Element
            && (part.what.ends_with("mechanicalReduction: 1 is new")
                || part.what.contains("offset: 0")
                || part.what.starts_with("actuator") && part.what.ends_with("is gone"))
    };
    let joints = found.joints.iter().find(|joint| joint.changes.iter().any(|change| change.counts));
    let part = found.parts.iter().find(|part| part.counts && !stated(part));
    if joints.is_none() && part.is_none() { Ok(()) } else { Err(format!("{joints:?} {part:?}")) }
}

#[test]
fn every_operation_over_every_file_is_done_or_refused() {
    let mut counts: BTreeMap<&str, [usize; 4]> = BTreeMap::new();
    let mut reasons: BTreeMap<String, usize> = BTreeMap::new();
    let mut wrong = Vec::new();
    let paths = corpus();
    let mut read = 0;
    for path in &paths {
        let Ok(text) = std::fs::read_to_string(path) else { continue };
        let Ok(robot) = urdf::read("before.urdf", &text) else { continue };
        read += 1;
        for (name, operation, back) in asked(&robot) {
            let count = counts.entry(name).or_default();
            match edit(&text, &operation) {
                Ok(done) => {
                    count[0] += 1;
                    let Some(back) = back else { continue };
                    match edit(&done.files.urdf.text, &back) {
                        Ok(again) if again.files.urdf.text == text => count[3] += 1,
                        Ok(again) => {
                            if let Err(what) = same(&robot, &again.files.urdf.text) {
                                wrong.push(format!("{}: {operation}, and back: {what}", path.display()));
                            }
                        }
                        Err(error) => wrong.push(format!("{}: {operation}, back: {error}", path.display())),
                    }
                }
                Err(error @ EditError::Unproved { .. }) => {
                    count[2] += 1;
                    wrong.push(format!("{}: {error}", path.display()));
                }
                Err(error) => {
                    count[1] += 1;
                    let said = error.to_string();
                    let reason = said.rsplit(": ").next().unwrap_or_default().to_owned();
                    *reasons.entry(format!("{name}: {reason}")).or_default() += 1;
                }
            }
        }
    }
    println!("{read} of {} files are robots", paths.len());
    for (name, [done, refused, unproved, bytes]) in &counts {
        println!("{name}: {done} done, {refused} refused, {unproved} unproved; {bytes} undone byte for byte");
    }
    for (reason, count) in &reasons {
        println!("  {count} × {reason}");
    }
    assert!(read >= 10);
    assert!(wrong.is_empty(), "{} wrong:\n{}", wrong.len(), wrong.join("\n"));
}
