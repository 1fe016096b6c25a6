//! What an operation changed, counted for the report.

/// Counted changes, in the order in which they first happened.
#[derive(Debug, Default)]
pub(crate) struct Tally {
    said: Vec<String>,
    counted: Vec<(&'static str, &'static str, &'static str, usize)>,
}

impl Tally {
    /// A separate sentence, such as `joint_3 reversed`.
    pub fn say(&mut self, what: impl Into<String>) {
        self.said.push(what.into());
    }

    /// One more of a kind: `count("limit", "limits", "exchanged")`.
    pub fn count(&mut self, one: &'static str, many: &'static str, verb: &'static str) {
        match self.counted.iter_mut().find(|(known, _, done, _)| *known == one && *done == verb) {
            Some((.., number)) => *number += 1,
            None => self.counted.push((one, many, verb, 1)),
        }
    }

    /// Everything, as it is printed.
    pub fn said(&self) -> Vec<String> {
        let counted = self
            .counted
            .iter()
            .map(|(one, many, verb, number)| format!("{number} {} {verb}", if *number == 1 { one } else { many }));
        self.said.iter().cloned().chain(counted).collect()
    }
}
