//! Seeded changes of models: each is read, or refused with its place; nothing panics.

#![allow(clippy::unwrap_used, clippy::print_stdout)] // Tests: a panic is a failure; how many is printed.

use denavit_model::urdf;
use proptest::prelude::*;

const MODELS: [&str; 6] = [
    include_str!("models/old_frames.sdf"),
    include_str!("models/new_frames.sdf"),
    include_str!("models/joints.sdf"),
    include_str!("models/nested.sdf"),
    include_str!("models/shapes.sdf"),
    include_str!("models/camera.sdf"),
];

/// Pieces of a text between `<`, `>`, quotes and blanks.
fn pieces(text: &str) -> Vec<&str> {
    text.split_inclusive(['<', '>', '"', ' ', '/']).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]
    #[test]
    fn a_changed_model_is_read_or_refused(
        model in 0..MODELS.len(),
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<prop::sample::Index>(), 0..3u8), 1..6),
    ) {
        let mut parts = pieces(MODELS[model]);
        for (at, from, how) in &changes {
            let (at, from) = (at.index(parts.len()), parts[from.index(parts.len())]);
            match how {
                0 => drop(parts.remove(at)),
                1 => parts.insert(at, from),
                _ => parts[at] = from,
            }
        }
        let text = parts.concat();
        let mut fetch = |_: &str, _: &str| Ok(("camera.sdf".to_owned(), MODELS[5].to_owned()));
        match denavit_sdf::read("m.sdf", &text, &mut fetch) {
            Ok(urdf) => match urdf::read("m.sdf", &urdf) {
                Ok(robot) => drop(denavit_sdf::write(&robot)),
                Err(error) => prop_assert!(!error.problems.is_empty()),
            },
            Err(error) => prop_assert!(!error.problems.is_empty()),
        }
    }
}
