//! A hash of everything that a run's result depends on: the bytes of its inputs, its options, the version.

use crate::manifest::{Entry, PriorSource};
use crate::tasks::source_options;
use sha2::{Digest, Sha256};
use std::collections::HashMap;
use std::sync::Mutex;

/// Incremented when the tables of a result change.
const TABLES_VERSION: &str = "fleet tables 2";

/// Hashes of robots' files, which many entries share.
#[derive(Debug, Default)]
pub(crate) struct Robots(Mutex<HashMap<String, [u8; 32]>>);

/// The key of an entry: SHA-256, 64 hexadecimal digits.
///
/// For a xacro file the expanded URDF is hashed, because it may include other files. An unreadable file also gives a key,
/// which changes when it becomes readable.
pub(crate) fn key(entry: &Entry, robots: &Robots) -> String {
    let mut hash = Sha256::new();
    for part in [TABLES_VERSION, env!("CARGO_PKG_VERSION")] {
        hash.update(part.as_bytes());
        hash.update([0]);
    }
    hash.update(serde_json::to_vec(entry).expect("texts and numbers"));
    for robot in [Some(entry.robot.as_str()), entry.against.as_deref()].into_iter().flatten() {
        hash.update(robots.of(robot, entry));
    }
    // What was learned from siblings is in the entry itself.
    let prior = entry.prior.iter().filter_map(|prior| match prior {
        PriorSource::File(file) => Some(file),
        PriorSource::Siblings { .. } => None,
    });
    for file in entry.data.iter().chain(&entry.test).chain(prior) {
        hash.update(of_bytes(file));
    }
    base16ct::lower::encode_string(&hash.finalize())
}

fn of_bytes(file: &str) -> [u8; 32] {
    match denavit_load::read_bytes(file) {
        Ok((_, bytes)) => Sha256::digest(bytes).into(),
        Err(error) => Sha256::digest(error.to_string()).into(),
    }
}

impl Robots {
    fn of(&self, robot: &str, entry: &Entry) -> [u8; 32] {
        let name = format!("{robot}\n{:?}", entry.options.arguments);
        let known = self.0.lock().expect("hashing does not panic").get(&name).copied();
        known.unwrap_or_else(|| {
            let hash = of_robot(robot, entry);
            self.0.lock().expect("hashing does not panic").insert(name, hash);
            hash
        })
    }
}

fn of_robot(robot: &str, entry: &Entry) -> [u8; 32] {
    let plain = of_bytes(robot);
    let Ok((file, text)) = denavit_load::read_text(robot) else { return plain };
    if !may_be_xacro(&text) {
        return plain;
    }
    match denavit_load::expanded(&file, &text, &source_options(entry)) {
        Ok(expanded) => Sha256::digest(expanded.urdf).into(),
        Err(_) => plain,
    }
}

/// Whether a text may be xacro: then more than its own bytes may matter.
fn may_be_xacro(text: &str) -> bool {
    text.contains("xacro")
}
