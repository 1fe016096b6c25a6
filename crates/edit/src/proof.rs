//! Checks that the new robot is what the operation claims: it is read back and compared with the old one.

mod matter;
pub(crate) mod motion;

use crate::claim::{Claim, Compared, KeptLink};
use denavit_compare::comparison::PartKind;
use denavit_compare::{JointChange, Options, PartDifference, Subject, Verdict, compare};
use denavit_model::Robot;
use denavit_model::tree::Reading;
use std::collections::BTreeMap;
use std::fmt;

/// How accurately a claim holds.
#[derive(Debug, Clone, PartialEq)]
pub struct Proof {
    /// The largest displacement of a frame from its claimed pose, over all links and sampled joint values, m.
    pub moved: f64,
    /// The same in rad.
    pub turned: f64,
    /// Configurations that were sampled.
    pub samples: usize,
    /// Frames that were compared in each.
    pub frames: usize,
    /// The motion, such as `moves as before`.
    pub motion: &'static str,
}

impl fmt::Display for Proof {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} within {} m and {} rad", self.motion, rounded_up(self.moved), rounded_up(self.turned))
    }
}

/// One digit, rounded up; rounding errors of f64 are given as 1e-15.
fn rounded_up(value: f64) -> String {
    if value <= 1e-15 {
        return "1e-15".into();
    }
    let exponent = value.log10().floor();
    let digit = (value / 10f64.powf(exponent)).ceil();
    if digit >= 10.0 { format!("1e{}", exponent + 1.0) } else { format!("{digit}e{exponent}") }
}

/// Two robots and where links of the one are in the other.
pub(crate) struct Pair<'a> {
    before: &'a Robot,
    after: &'a Robot,
    claim: &'a Claim,
    /// For each link of `before`, its place in `after`.
    places: Vec<Option<(usize, &'a KeptLink)>>,
    /// For each joint of `before`, its index in `after`.
    joints: Vec<Option<usize>>,
}

/// Checks the claim on the new robot.
///
/// # Errors
/// The violated part of the claim.
pub(crate) fn prove(before: &Robot, after: &Robot, claim: &Claim) -> Result<Proof, String> {
    let links: BTreeMap<&str, usize> =
        after.links.iter().enumerate().map(|(index, link)| (link.name.as_str(), index)).collect();
    let joints: BTreeMap<&str, usize> =
        after.joints.iter().enumerate().map(|(index, joint)| (joint.name.as_str(), index)).collect();
    let mut pair = Pair { before, after, claim, places: Vec::new(), joints: Vec::new() };
    for link in &before.links {
        let Some(kept) = claim.links.get(&link.name) else {
            pair.places.push(None);
            continue;
        };
        let index = links.get(kept.name.as_str()).ok_or_else(|| format!("link \"{}\" is lost", kept.name))?;
        pair.places.push(Some((*index, kept)));
    }
    for joint in &before.joints {
        let Some(kept) = claim.joints.get(&joint.name) else {
            pair.joints.push(None);
            continue;
        };
        let index = joints.get(kept.name.as_str()).ok_or_else(|| format!("joint \"{}\" is lost", kept.name))?;
        pair.joints.push(Some(*index));
    }
    matter::check(&pair)?;
    motion::check_joints(&pair)?;
    let proof = motion::check(&pair)?;
    compared(&pair)?;
    Ok(proof)
}

/// The exact comparison, if it covers the claim.
fn compared(pair: &Pair) -> Result<(), String> {
    let (up_to_zeros, reading) = match pair.claim.compared {
        Compared::No => return Ok(()),
        Compared::Same | Compared::UpToFrames => (false, Reading::AsWritten),
        Compared::AsMeant => (false, Reading::Intended),
        Compared::UpToZeros => (true, Reading::AsWritten),
    };
    // The motion was sampled already.
    let options = Options { up_to_zeros, samples: 0, reading, ..Options::default() };
    let found = compare(&Subject::Robot(pair.before), &Subject::Robot(pair.after), &options)
        .map_err(|error| error.to_string())?;
    if found.verdict == Verdict::Same {
        return Ok(());
    }
    // What states a joint's values differs on purpose; limits and mimic joints were compared with the claim already.
    let is_value = |change: &JointChange| {
        up_to_zeros
            && matches!(
                change,
                JointChange::LimitChanged { .. }
                    | JointChange::PropertyChanged { .. }
                    | JointChange::MimicChanged { .. }
            )
    };
    let joint = found.joints.iter().find_map(|joint| {
        let change = joint.changes.iter().find(|change| change.counts && !is_value(&change.what))?;
        Some(format!("joint \"{}\": {}", joint.joint, change.what))
    });
    let is_excused = |kind: PartKind| match pair.claim.compared {
        Compared::UpToZeros => kind == PartKind::Element,
        Compared::UpToFrames => matches!(kind, PartKind::Element | PartKind::Frame),
        _ => false,
    };
    let counts = |part: &&PartDifference| part.counts && !is_excused(part.kind);
    let part = || found.parts.iter().find(counts).map(|part| format!("{}: {}", part.part, part.what));
    joint.or_else(part).map_or(Ok(()), Err)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_are_rounded_up() {
        for (value, expected) in [(0.0, "1e-15"), (1.2e-15, "2e-15"), (9.5e-14, "1e-13"), (3e-3, "3e-3")] {
            assert_eq!(rounded_up(value), expected);
        }
    }
}
