//! Renames links and joints wherever they are used.

use crate::claim::{Claim, Compared, KeptJoint, KeptLink};
use crate::error::{self, EditError};
use crate::references::{self, Names};
use crate::tally::Tally;
use crate::{Change, operations};
use denavit_export::urdf::text::{Edits, Nodes, parse};
use denavit_model::robot::{Robot, SourceText};
use denavit_model::urdf;
use std::collections::{BTreeMap, BTreeSet};

/// A name to change.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Renaming {
    /// `link` or `joint` where both have the name; `None`: whichever has it.
    pub kind: Option<&'static str>,
    /// The old name.
    pub old: String,
    /// The new one.
    pub new: String,
}

/// # Errors
/// A name that is missing, ambiguous or taken.
pub(crate) fn rename(robot: &Robot, srdf: Option<&SourceText>, wanted: &[Renaming]) -> Result<Change, EditError> {
    let mut names = Names::default();
    for Renaming { kind, old, new } in wanted {
        let (link, joint) = (robot.link_index(old), robot.joint_index(old));
        match (kind, link, joint) {
            (None, Some(_), Some(_)) => {
                return Err(EditError::Words(format!(
                    "rename {old}={new}: a link and a joint have this name; write link:{old}={new} or joint:{old}={new}"
                )));
            }
            (Some("joint"), _, _) | (None, None, Some(_)) => {
                error::joint(robot, old)?;
                names.joints.insert(old.clone(), new.clone());
            }
            _ => {
                error::link(robot, old)?;
                names.links.insert(old.clone(), new.clone());
            }
        }
    }
    renamed(robot, srdf, &names)
}

/// # Errors
/// A name that is taken.
pub(crate) fn prefix(robot: &Robot, srdf: Option<&SourceText>, prefix: &str) -> Result<Change, EditError> {
    let with = |name: &String| (name.clone(), format!("{prefix}{name}"));
    let names = Names {
        links: robot.links.iter().map(|link| with(&link.name)).collect(),
        joints: robot.joints.iter().map(|joint| with(&joint.name)).collect(),
    };
    renamed(robot, srdf, &names)
}

/// # Errors
/// A name that is taken, or a text in which the renaming could not be reversed.
pub(crate) fn renamed(robot: &Robot, srdf: Option<&SourceText>, names: &Names) -> Result<Change, EditError> {
    taken(robot, names)?;
    let mut tally = Tally::default();
    let document = parse(robot)?;
    error::all_declared(robot, &Nodes::of(robot, &document)?)?;
    let mut edits = Edits::default();
    let (count, left) = references::rename(&document, names, &mut edits);
    let urdf = edits.apply(&robot.source)?;
    let srdf = match srdf {
        Some(source) => {
            let document = operations::parse_srdf(source)?;
            let mut edits = Edits::default();
            let (count, _) = references::rename(&document, names, &mut edits);
            tally.say(format!("{count} names in the SRDF"));
            Some(edits.apply(source)?)
        }
        None => None,
    };
    can_be_undone(robot, names, &urdf)?;
    for (many, number) in [("links", names.links.len()), ("joints", names.joints.len())] {
        if number > 0 {
            tally.say(format!("{number} {} renamed", if number == 1 { &many[..many.len() - 1] } else { many }));
        }
    }
    tally.say(format!("{count} places changed"));
    Ok(Change { urdf, srdf, claim: claim(robot, names), second: None, files: Vec::new(), tally, notes: left })
}

/// The claim: everything is in place under its new name.
pub(crate) fn claim(robot: &Robot, names: &Names) -> Claim {
    let mut claim = Claim { compared: Compared::No, ..Claim::same(robot) };
    let new = |map: &BTreeMap<String, String>, old: &String| map.get(old).unwrap_or(old).clone();
    for (old, kept) in &mut claim.links {
        *kept = KeptLink { name: new(&names.links, old), ..kept.clone() };
    }
    for (old, kept) in &mut claim.joints {
        *kept = KeptJoint { name: new(&names.joints, old), ..kept.clone() };
    }
    claim
}

fn taken(robot: &Robot, names: &Names) -> Result<(), EditError> {
    let clash = |kind: &str, name: &str| {
        Err(EditError::Words(format!(
            "{}: two {kind}s would be named \"{name}\"; choose another name",
            robot.source.file
        )))
    };
    let mut seen = BTreeSet::new();
    for link in &robot.links {
        let new = names.links.get(&link.name).unwrap_or(&link.name);
        if new.trim().is_empty() || !seen.insert(new) {
            return clash("link", new);
        }
    }
    let mut seen = BTreeSet::new();
    for joint in &robot.joints {
        let new = names.joints.get(&joint.name).unwrap_or(&joint.name);
        if new.trim().is_empty() || !seen.insert(new) {
            return clash("joint", new);
        }
    }
    Ok(())
}

/// The exact proof: restoring the old names gives the old text, byte for byte.
fn can_be_undone(robot: &Robot, names: &Names, text: &str) -> Result<(), EditError> {
    let unproved = |what: String| EditError::Unproved { operation: "rename".into(), what };
    let made = urdf::read(&robot.source.file, text).map_err(|error| unproved(error.to_string()))?;
    let document = parse(&made)?;
    let mut edits = Edits::default();
    references::rename(&document, &names.back(), &mut edits);
    let back = edits.apply(&made.source)?;
    let original = Edits::default().apply(&robot.source)?;
    if back == original {
        return Ok(());
    }
    let line = back.lines().zip(original.lines()).position(|(a, b)| a != b).map_or(0, |index| index + 1);
    Err(unproved(format!(
        "line {line} names something that already has the new name, so the renaming could not be reversed"
    )))
}
