//! The edits as JSON: operations, their claims, and the measured deviations.

use crate::claim::{Claim, JointMap};
use crate::{Done, Report};
use denavit_model::se3::{self, Pose};
use serde::Serialize;

/// What it is called, and its version.
pub const SCHEMA: &str = "denavit.edit/1";

/// A frame displaced by less is unchanged, m and rad.
const STAYS: f64 = 1e-12;

#[derive(Serialize)]
struct Out<'a> {
    schema: &'static str,
    file: &'a str,
    operations: Vec<OperationOut<'a>>,
    meshes: Vec<&'a str>,
}

#[derive(Serialize)]
struct OperationOut<'a> {
    operation: &'a str,
    claim: ClaimOut<'a>,
    proof: ProofOut,
    changes: &'a [String],
    notes: &'a [String],
}

#[derive(Serialize)]
struct ProofOut {
    motion: &'static str,
    /// m.
    moved: f64,
    /// rad.
    turned: f64,
    configurations: usize,
    frames: usize,
}

#[derive(Serialize)]
struct ClaimOut<'a> {
    seen_from: &'a str,
    #[serde(skip_serializing_if = "Option::is_none")]
    mirrored: Option<&'static str>,
    scale: f64,
    /// Those that are not as before.
    joints: Vec<JointOut<'a>>,
    links: Vec<LinkOut<'a>>,
}

/// new value = sense · old value + shift.
#[derive(Serialize)]
struct JointOut<'a> {
    joint: &'a str,
    is: &'a str,
    sense: f64,
    shift: f64,
}

/// The old frame in the new one.
#[derive(Serialize)]
struct LinkOut<'a> {
    link: &'a str,
    is: &'a str,
    xyz: [f64; 3],
    rpy: [f64; 3],
}

fn claim(claim: &Claim) -> ClaimOut<'_> {
    let joints = claim.joints.iter().filter(|(name, kept)| **name != kept.name || kept.map != JointMap::SAME);
    let stays = |offset: &Pose| {
        let (turned, moved) = se3::difference(offset, &Pose::identity());
        turned <= STAYS && moved <= STAYS
    };
    let links = claim.links.iter().filter(|(name, kept)| **name != kept.name || !stays(&kept.offset));
    ClaimOut {
        seen_from: &claim.seen_from,
        mirrored: claim.space.mirrored.map(|index| ["yz", "xz", "xy"][index]),
        scale: claim.space.scale,
        joints: joints
            .map(|(joint, kept)| JointOut { joint, is: &kept.name, sense: kept.map.sense, shift: kept.map.shift })
            .collect(),
        links: links
            .map(|(link, kept)| LinkOut {
                link,
                is: &kept.name,
                xyz: kept.offset.translation.vector.into(),
                rpy: se3::rpy_from_rotation(&kept.offset.rotation),
            })
            .collect(),
    }
}

fn operation(report: &Report) -> OperationOut<'_> {
    let proof = &report.proof;
    OperationOut {
        operation: &report.operation,
        claim: claim(&report.claim),
        proof: ProofOut {
            motion: proof.motion.trim_end_matches(','),
            moved: proof.moved,
            turned: proof.turned,
            configurations: proof.samples,
            frames: proof.frames,
        },
        changes: &report.changes,
        notes: &report.notes,
    }
}

/// What was done, as JSON, two spaces deep; lengths in m, angles in rad.
///
/// # Errors
/// serde_json's, which does not happen for finite numbers.
pub fn to_json(done: &Done) -> Result<String, serde_json::Error> {
    let operations = done.reports.iter().map(operation).collect();
    let meshes = done.meshes.iter().map(|mesh| mesh.file.as_str()).collect();
    serde_json::to_string_pretty(&Out { schema: SCHEMA, file: &done.files.urdf.file, operations, meshes })
}
