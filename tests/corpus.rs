//! Every vendor's file gives a readable table or a reason; and the statement about the tip is true.

use crate::support::{configurations, files, top, vendor};
use denavit_dh::Options;
use denavit_dh::convert::table;
use denavit_model::{Note, Reading, se3};

/// Files in which a number larger than three times the robot's size is right: real offsets between nearly parallel axes.
const TRULY_FAR: &[(&str, &str)] =
    &[("gingerurdf.urdf", "finger joints are turned by full-precision angles some 1e-4 rad off, as drawn in CAD")];

/// Checks one file; returns the number of chains, or the reason for having none.
fn check(path: &std::path::Path, samples: usize, far: &mut Vec<String>) -> Result<usize, String> {
    let name = path.to_str().unwrap();
    let text = std::fs::read_to_string(path).map_err(|error| error.to_string())?;
    let robot = denavit_model::urdf::read(name, &text).map_err(|error| error.to_string())?;
    let listings = robot.leaf_chains();
    for listing in &listings {
        let chain_as = |reading| robot.chain(Some(&listing.base), Some(&listing.tip), reading);
        let (Ok(read), Ok(written)) = (chain_as(Reading::Intended), chain_as(Reading::AsWritten)) else { continue };
        let made = table(&read.value, &Options::default()).unwrap();
        for note in made.notes.iter().filter(|note| matches!(note, Note::FarNumber { .. })) {
            if !read.value.joints().is_empty() {
                far.push(format!("{name} {}: {note}", listing.tip));
            }
        }
        let stated: f64 = read.notes.iter().chain(&made.notes).map(Note::tip_moves).sum();
        let ranges: Vec<(f64, f64)> =
            written.value.coordinates().iter().map(denavit_model::Coordinate::range).collect();
        for q in configurations(&ranges, samples) {
            let moved = se3::difference(&written.value.fk(&q), &made.value.fk(&q)).1;
            let rounding = 1e-13 * written.value.size().max(made.value.greatest_length());
            assert!(moved <= stated + rounding, "{name} {}: moved {moved:e}, stated {stated:e}", listing.tip);
        }
    }
    Ok(listings.len())
}

#[test]
fn own_robots_have_readable_tables() {
    let found = files(&top().join("robots"), "urdf");
    assert!(found.len() >= 10);
    let mut far = Vec::new();
    for path in found {
        assert!(check(&path, 10_000, &mut far).unwrap() > 0);
    }
    assert!(far.is_empty(), "{}", far.join("\n"));
}

#[test]
fn vendors_robots_have_readable_tables_and_true_bounds() {
    let Some(vendor) = vendor() else { return };
    let found = files(&vendor.join("robots"), "urdf");
    assert!(found.len() > 200, "{}", found.len());
    let (mut chains, mut far) = (0, Vec::new());
    let mut refused = Vec::new();
    for path in &found {
        match check(path, 200, &mut far) {
            Ok(count) => chains += count,
            Err(reason) => refused.push(reason),
        }
    }
    println!("{} files, {chains} chains, {} refused:", found.len(), refused.len());
    for reason in &refused {
        println!("  {reason}");
    }
    println!("{} numbers beyond three times the robot's size:", far.len());
    for line in &far {
        println!("  {line}");
    }
    far.retain(|line| !TRULY_FAR.iter().any(|(known, _)| line.contains(known)));
    assert!(far.is_empty(), "{}", far.join("\n"));
    assert!(refused.iter().all(|reason| reason.contains(".urdf:")), "a refusal names its place");
}
