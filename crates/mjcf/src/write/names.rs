//! Names that are unique among their kind.

use std::collections::HashSet;

/// Names that are taken.
#[derive(Debug, Default)]
pub struct Names(HashSet<String>);

impl Names {
    /// These are taken from the start.
    pub fn with<const N: usize>(taken: [&str; N]) -> Self {
        Self(taken.into_iter().map(str::to_owned).collect())
    }

    /// The wanted name, or one like it where that is taken; whether it is another.
    pub fn give(&mut self, wanted: &str) -> (String, bool) {
        let mut name = wanted.to_owned();
        let mut number = 2;
        while !self.0.insert(name.clone()) {
            name = format!("{wanted}_{number}");
            number += 1;
        }
        let renamed = name != wanted;
        (name, renamed)
    }
}
