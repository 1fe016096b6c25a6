//! The project's robots, as drawn.

use denavit_identify::effects::Statics;
use denavit_model::tree::Reading;
use denavit_model::{Chain, urdf};
use std::path::Path;

/// A robot of `robots/` with what gravity acts on.
pub fn drawn(path: &str) -> (Chain, Statics) {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../robots").join(path);
    let robot = urdf::read(path, &std::fs::read_to_string(file).unwrap()).unwrap();
    let chain = robot.chain(None, None, Reading::Intended).unwrap().value;
    let statics = Statics::of(&robot, &chain);
    (chain, statics)
}

/// The one that most runs are of.
pub fn ur5e() -> (Chain, Statics) {
    drawn("universal_robots/ur5e.urdf")
}
