//! Answers about a robot as JSON, the same from the command line and from a web page.

use crate::Listing;
use denavit_model::nalgebra::UnitQuaternion;
use denavit_model::notes::Noted;
use denavit_model::tree::ChainListing;
use denavit_model::{Chain, Pose, se3};
use serde::Serialize;

#[derive(Serialize)]
struct ChainsOut<'a> {
    schema: &'static str,
    robot: &'a str,
    chains: Vec<ChainOut<'a>>,
}

#[derive(Serialize)]
struct ChainOut<'a> {
    base: &'a str,
    tip: &'a str,
    coordinates: &'a [String],
    default: bool,
}

/// The chains of a robot, `denavit.chains/1`.
pub fn chains(listing: &Listing) -> String {
    let Listing { robot, chains, default } = listing;
    let added = (!chains.contains(default)).then_some(default);
    let entry = |listing: &'_ ChainListing| listing == default;
    let entries = added.into_iter().chain(chains).map(|listing| ChainOut {
        base: &listing.base,
        tip: &listing.tip,
        coordinates: &listing.coordinates,
        default: entry(listing),
    });
    pretty(&ChainsOut { schema: "denavit.chains/1", robot, chains: entries.collect() })
}

#[derive(Serialize)]
struct FkOut<'a> {
    schema: &'static str,
    robot: &'a str,
    base: &'a str,
    tip: &'a str,
    q: serde_json::Map<String, serde_json::Value>,
    pose: [[f64; 4]; 4],
    xyz: [f64; 3],
    rpy: [f64; 3],
    quaternion_xyzw: [f64; 4],
    tip_moves_at_most: f64,
}

/// Where the tip is, `denavit.fk/1`: `pose` is base_from_tip (m) at the joint values `q` (rad, m).
pub fn fk(noted: &Noted<Chain>, q: &[f64], pose: &Pose) -> String {
    let chain = &noted.value;
    let quaternion = UnitQuaternion::from_rotation_matrix(&pose.rotation);
    let matrix = pose.to_homogeneous();
    let coordinates = chain.coordinates().iter().zip(q);
    pretty(&FkOut {
        schema: "denavit.fk/1",
        robot: chain.name(),
        base: chain.base(),
        tip: chain.tip(),
        q: coordinates.map(|(coordinate, value)| (coordinate.name.clone(), (*value).into())).collect(),
        pose: std::array::from_fn(|row| std::array::from_fn(|column| matrix[(row, column)])),
        xyz: pose.translation.vector.into(),
        rpy: se3::rpy_from_rotation(&pose.rotation),
        quaternion_xyzw: [quaternion.i, quaternion.j, quaternion.k, quaternion.w],
        tip_moves_at_most: noted.notes.iter().map(denavit_model::Note::tip_moves).sum::<f64>() + 0.0,
    })
}

fn pretty(value: &impl Serialize) -> String {
    serde_json::to_string_pretty(value).expect("plain values with text keys") + "\n"
}
