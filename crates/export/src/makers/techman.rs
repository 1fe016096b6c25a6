//! Techman: the D-H table of a model and the delta D-H of one arm, from a TM controller.
//!
//! ```text
//! DHTable={θ, α, a, d, kind, lower, upper, …}      seven of each joint, degrees and mm
//! DeltaDH={Δθ, Δα, Δa, Δd, Δβ, …}                  five of each joint
//! ```
//! A row is Rz(θ) Tz(d) Tx(a) Rx(α) Ry(β) of the sums.
//!
//! **Source.** github.com/TechmanRobotInc/tmr_ros1, `tm_mod_urdf`: items `DHTable` and `DeltaDH` of the controller, and what the script
//! makes of them.

use crate::kinematics_yaml::KinematicsFileError;
use crate::sources::{Read, Source};
use denavit_dh::{Convention, ConventionRow, Motion, RowLabel, Table, TableJoint};
use denavit_model::Inventory;
use denavit_model::chain::{Coordinate, Quantity};

/// Numbers of each joint in the two lists.
const OF_MODEL: usize = 7;
const OF_ARM: usize = 5;

/// Whether a text holds both lists.
pub fn is_one(text: &str) -> bool {
    list(text, "DHTable").is_some() && list(text, "DeltaDH").is_some()
}

/// The text between the braces after a name.
fn list<'a>(text: &'a str, name: &str) -> Option<&'a str> {
    let rest = &text[text.find(name)? + name.len()..];
    let inside = rest.trim_start().strip_prefix('=')?.trim_start().strip_prefix('{')?;
    Some(&inside[..inside.find('}')?])
}

/// The same text with nothing added to the model's table.
pub fn drawn(text: &str) -> String {
    match list(text, "DeltaDH") {
        None => text.to_owned(),
        Some(inside) => {
            let zeros = vec!["0"; inside.split(',').count()].join(",");
            text.replacen(inside, &zeros, 1)
        }
    }
}

/// Reads the two lists.
///
/// # Errors
/// A list is missing, does not match the other, or holds a value that is not a finite number.
pub fn read(file: &str, robot: &str, text: &str) -> Result<Read, KinematicsFileError> {
    let refused = |what: String| KinematicsFileError::NotThisArm {
        file: file.to_owned(),
        form: "DHTable and DeltaDH of a Techman controller",
        what,
    };
    let numbers = |name: &str| {
        let inside = list(text, name).ok_or_else(|| refused(format!("{name}={{…}} is missing")))?;
        let number = |word: &str| word.trim().parse::<f64>().ok().filter(|number| number.is_finite());
        let all: Option<Vec<f64>> = inside.split(',').filter(|word| !word.trim().is_empty()).map(number).collect();
        all.ok_or_else(|| refused(format!("{name} holds something that is not a number")))
    };
    let (model, arm) = (numbers("DHTable")?, numbers("DeltaDH")?);
    let count = model.len() / OF_MODEL;
    if count == 0 || model.len() != OF_MODEL * count || arm.len() != OF_ARM * count {
        let (has, own) = (model.len(), arm.len());
        return Err(refused(format!(
            "DHTable has {has} numbers and DeltaDH {own}; each joint needs {OF_MODEL} and {OF_ARM}"
        )));
    }
    let nothing = |label| ConventionRow { label, theta: None, d: None, alpha: None, a: None, beta: None };
    let mut rows = vec![nothing(RowLabel::Base)];
    let (mut joints, mut coordinates) = (Vec::new(), Vec::new());
    for (index, (of_model, added)) in model.chunks_exact(OF_MODEL).zip(arm.chunks_exact(OF_ARM)).enumerate() {
        let angle = |place: usize| (of_model[place] + added[place]).to_radians();
        let length = |place: usize| (of_model[place] + added[place]) / 1e3;
        rows.push(ConventionRow {
            label: RowLabel::Joint(index),
            theta: Some(angle(0)),
            alpha: Some(angle(1)),
            a: Some(length(2)),
            d: Some(length(3)),
            beta: Some(added[4].to_radians()),
        });
        let name = format!("joint_{}", index + 1);
        joints.push(TableJoint { name: name.clone(), motion: Motion::Revolute, coordinate: index, scale: 1.0 });
        let mut coordinate = Coordinate::unlimited(name, Quantity::Angle);
        let range = (of_model[5].to_radians(), of_model[6].to_radians());
        coordinate.limits.range = (range.0 < range.1).then_some(range);
        coordinates.push(coordinate);
    }
    rows.push(nothing(RowLabel::Tool));
    let convention = Convention::Hayati;
    let table = Table::from_convention_rows((robot, "base", "flange"), coordinates, joints, convention, &rows)
        .map_err(|error| refused(error.to_string()))?;
    table.chain()?.within_reach()?;
    let assumed = vec![format!("{file}: read as the D-H table and the delta D-H of a Techman arm, in degrees and mm")];
    Ok(Read {
        source: Source::Table { table, convention },
        assumed,
        notes: Vec::new(),
        inventory: Inventory::default(),
    })
}
