//! Universal Robots: `calibration.conf` of a controller, the corrections of one arm to the ideal table of its model.
//!
//! ```text
//! [mounting]
//! delta_theta = [ 2.1e-05, 0.968, …]     # rad, six of each
//! delta_a = …                            # m
//! delta_d = …                            # m
//! delta_alpha = …                        # rad
//! joint_checksum = …
//! calibration_status = 2                 # 0 == notInitialized, 1 == notLinearised, 2 == Linearised
//! ```
//! **Source.** github.com/UniversalRobots/Universal_Robots_ROS2_Driver, `ur_calibration`, which reads the same figures from a
//! controller and adds them to its ideal table. The file does not name the model.

use super::ur_models::{Model, model_of, names};
use super::{Calibrated, Maker, MakerError, Written, tool_words, without_effects};
use crate::kinematics_yaml::KinematicsFileError;
use crate::numbers::exact;
use crate::sources::{Read, Source};
use denavit_dh::matching::{VendorTable, match_table};
use denavit_dh::nearest::{Parallels, nearest};
use denavit_dh::{Convention, Row};
use denavit_model::Inventory;
use denavit_model::notes::{Note, Place};
use denavit_model::words::quoted;
use std::fmt::Write as _;

/// The name of the argument that names the model, as ur_description has it.
pub const MODEL_ARGUMENT: &str = "ur_type";

const LISTS: [&str; 4] = ["delta_theta", "delta_d", "delta_alpha", "delta_a"];

/// Whether a text is such a file.
pub fn is_one(text: &str) -> bool {
    let has = |start: &str| text.lines().any(|line| line.trim_start().starts_with(start));
    has("[mounting]") && LISTS.iter().any(|list| has(list))
}

/// Reads the file of an arm of this model.
///
/// # Errors
/// The model is missing or unknown, or a list is missing, appears twice, or does not have six finite numbers.
pub fn read(file: &str, robot: &str, text: &str, model: Option<&str>) -> Result<Read, KinematicsFileError> {
    let refused = |what: String| KinematicsFileError::NotThisArm {
        file: file.to_owned(),
        form: "calibration.conf of a Universal Robots controller",
        what,
    };
    let known = || format!("add {MODEL_ARGUMENT}:=MODEL, one of {}", names());
    let Some(model) = model else {
        return Err(refused(format!(
            "it holds the corrections to the ideal table of the model, but does not name the model; {}",
            known()
        )));
    };
    let model = Model::named(model)
        .ok_or_else(|| refused(format!("the model \"{}\" is not known; {}", quoted(model), known())))?;
    let mut lists: [Option<[f64; 6]>; 4] = [None; 4];
    let mut inventory = Inventory::default();
    let (mut notes, mut assumed) = (Vec::new(), Vec::new());
    let mut section = String::new();
    for (index, line) in text.lines().enumerate() {
        let line = line.trim_start_matches('\u{feff}').split(['#', ';']).next().unwrap_or_default().trim();
        let place = |element: &str| Place { file: file.to_owned(), line: index + 1, element: element.to_owned() };
        if line.is_empty() {
            continue;
        }
        if let Some(name) = line.strip_prefix('[').and_then(|rest| rest.strip_suffix(']')) {
            name.trim().clone_into(&mut section);
            if section == "mounting" {
                inventory.understand();
            }
            continue;
        }
        let (key, value) = line.split_once('=').map_or((line, ""), |(key, value)| (key.trim(), value.trim()));
        let list = LISTS.iter().position(|list| *list == key).filter(|_| section == "mounting");
        match (list, key) {
            (Some(list), _) => {
                if lists[list].is_some() {
                    return Err(refused(format!("line {}: {key} appears twice; remove one", index + 1)));
                }
                let numbers = six(value);
                lists[list] = Some(numbers.ok_or_else(|| {
                    refused(format!(
                        "line {}: {key} is \"{}\"; write six finite numbers in brackets",
                        index + 1,
                        quoted(value)
                    ))
                })?);
                inventory.understand();
            }
            // The joints' checksums, without effect on the kinematics.
            (None, "joint_checksum") if section == "mounting" => inventory.carry(place(key), key),
            (None, "calibration_status") if section == "mounting" => {
                inventory.understand();
                if value != "2" {
                    assumed.push(format!(
                        "{file}:{}: calibration_status is {}; a calibrated arm has 2",
                        index + 1,
                        quoted(value)
                    ));
                }
            }
            _ => {
                let place = place(&format!("key \"{}\"", quoted(key)));
                let what = "the key is unknown and was ignored".to_owned();
                inventory.report(place.clone(), what.clone());
                notes.push(Note::NotUnderstood { place, what });
            }
        }
    }
    let mut added = [[0.0; 4]; 6];
    for (column, (list, name)) in lists.iter().zip(LISTS).enumerate() {
        let list = list.ok_or_else(|| refused(format!("{name} is missing")))?;
        for (row, number) in added.iter_mut().zip(list) {
            row[column] = number;
        }
    }
    let table = model.table(robot, &added).map_err(|error| refused(error.to_string()))?;
    table.chain()?.within_reach()?;
    assumed.push(format!("{file}: read as the calibration of a {}", model.name.to_uppercase().replace('E', "e")));
    Ok(Read { source: Source::Table { table, convention: Convention::Distal }, assumed, notes, inventory })
}

pub(super) const MAKER: Maker = Maker {
    name: "ur-conf",
    purpose: "the delta lists of a controller's calibration.conf; d2 to d4 may have any size, as in the controller",
    render,
};

/// The arm's corrections to the ideal table of its model, in the controller's four lists.
fn render(calibrated: &Calibrated) -> Result<Written, MakerError> {
    let chain = calibrated.chain;
    let other = |found: String| MakerError::OtherChain {
        maker: "ur-conf",
        wanted: "the six joints of a Universal Robots arm",
        base: chain.base().to_owned(),
        tip: chain.tip().to_owned(),
        found,
    };
    let (tree, reading) = calibrated.drawn.ok_or(MakerError::NeedsTree { maker: "ur-conf" })?;
    let drawn = tree.chain(Some(chain.base()), Some(chain.tip()), reading)?.value;
    let name = model_of(&drawn).ok_or_else(|| other("other axes".into()))?;
    let ideal = Model::named(name).map(|model| model.table("", &[[0.0; 4]; 6])).transpose();
    let ideal = ideal.map_err(|error| other(error.to_string()))?.ok_or_else(|| other("other axes".into()))?;
    let vendor = VendorTable::of(&ideal, Convention::Distal, false);
    let lies = match_table(&drawn, &vendor).map_err(|error| other(error.to_string()))?;
    let own = lies.placement.in_frames_of_the_table(chain).map_err(KinematicsFileError::from)?;
    let found = nearest(&own, &ideal, Parallels::Dh).map_err(KinematicsFileError::from)?;
    let rows = (1..=6).map(|index| (found.table.row(index), ideal.row(index)));
    let mut lists: [Vec<String>; 4] = [const { Vec::new() }; 4];
    for (actual, ideal) in rows {
        let length = |row: &Row| row.d().unwrap_or(0.0);
        let added = [
            actual.theta() - ideal.theta(),
            length(&actual) - length(&ideal),
            actual.alpha() - ideal.alpha(),
            actual.a() - ideal.a(),
        ];
        for (list, number) in lists.iter_mut().zip(added) {
            list.push(exact(number));
        }
    }
    let mut text = format!("# What this arm adds to the ideal table of a {name}; rad and m.\n[mounting]\n");
    for (name, list) in LISTS.iter().zip(&lists) {
        let _ = writeln!(text, "{name} = [{}]", list.join(", "));
    }
    text.push_str("calibration_status = 2\n");
    let mut left_out = without_effects(calibrated);
    for (what, pose) in [("base", &found.base), ("flange", &found.tool)] {
        let words = tool_words(pose, chain.size());
        left_out.extend(words.map(|words| {
            format!("a controller's table has no numbers for the {what} frame, which is displaced by {words}")
        }));
    }
    left_out.push(format!(
        "the file lacks the controller's checksum, so no controller accepts it; `denavit table FILE \
         {MODEL_ARGUMENT}:={name}` reads it"
    ));
    Ok(Written { text, left_out })
}

fn six(value: &str) -> Option<[f64; 6]> {
    let inside = value.strip_prefix('[')?.strip_suffix(']')?;
    let numbers: Vec<f64> = inside.split(',').map(|word| word.trim().parse().ok()).collect::<Option<_>>()?;
    let numbers: [f64; 6] = numbers.try_into().ok()?;
    numbers.iter().all(|number| number.is_finite()).then_some(numbers)
}
