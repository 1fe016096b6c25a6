//! The robots of a repository in two revisions, and how each changed.

use crate::comparison::{Comparison, Verdict};
use serde::Serialize;

/// The robots of a repository in two revisions.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Robots {
    /// What the older revision is called.
    pub before: String,
    /// What the newer one is called.
    pub after: String,
    /// Each robot.
    pub members: Vec<Member>,
    /// Files that are not robots by themselves.
    pub left_out: Vec<String>,
}

/// One of the robots.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Member {
    /// Its name, or its file's.
    pub name: String,
    /// Its file; of a removed robot the one that it was in.
    pub file: String,
    /// The file that it was in, where that is another.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub file_before: Option<String>,
    /// How it changed.
    #[serde(flatten)]
    pub state: State,
}

/// How a robot changed.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "state", rename_all = "snake_case")]
#[non_exhaustive]
pub enum State {
    /// Nothing that it is made from changed.
    Untouched,
    /// It was compared.
    Compared {
        /// What was found.
        comparison: Box<Comparison>,
        /// A picture of both, as a path that a document can show.
        #[serde(skip_serializing_if = "Option::is_none")]
        picture: Option<String>,
    },
    /// It was not there before.
    New,
    /// It was removed.
    Removed,
    /// It cannot be read.
    Unreadable {
        /// Why.
        why: String,
        /// Whether that is new: `false` where it unreadable as before.
        counts: bool,
    },
}

/// Counts of robots by state.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Counts {
    /// All of them.
    pub all: usize,
    /// Compared, and different.
    pub different: usize,
    /// Compared, and the same.
    pub same: usize,
    /// Nothing changed.
    pub untouched: usize,
    /// New.
    pub new: usize,
    /// Removed.
    pub removed: usize,
    /// Cannot be read any more.
    pub unreadable: usize,
    /// Cannot be read, and could not before.
    pub unreadable_before: usize,
}

impl Robots {
    /// Counts of robots by state.
    pub fn count(&self) -> Counts {
        let mut counts = Counts { all: self.members.len(), ..Counts::default() };
        for member in &self.members {
            let place = match &member.state {
                State::Untouched => &mut counts.untouched,
                State::Compared { comparison, .. } if comparison.verdict == Verdict::Same => &mut counts.same,
                State::Compared { .. } => &mut counts.different,
                State::New => &mut counts.new,
                State::Removed => &mut counts.removed,
                State::Unreadable { counts: true, .. } => &mut counts.unreadable,
                State::Unreadable { .. } => &mut counts.unreadable_before,
            };
            *place += 1;
        }
        counts
    }

    /// `2 of 60 different, 1 the same, 57 untouched`.
    pub fn counts(&self) -> String {
        let counts = self.count();
        let mut words = vec![format!("{} of {} different", counts.different, counts.all)];
        for (count, word) in [
            (counts.unreadable, "cannot be read"),
            (counts.same, "the same"),
            (counts.new, "new"),
            (counts.removed, "removed"),
            (counts.unreadable_before, "unreadable as before"),
            (counts.untouched, "untouched"),
        ] {
            if count > 0 {
                words.push(format!("{count} {word}"));
            }
        }
        words.join(", ")
    }
}

impl Member {
    /// `ur5e (robots/ur5e.urdf, was robots/ur.urdf)`.
    pub fn title(&self) -> String {
        let file = (self.file != self.name).then(|| self.file.clone());
        let before = self.file_before.as_ref().map(|before| format!("was {before}"));
        let beside: Vec<String> = file.into_iter().chain(before).collect();
        if beside.is_empty() { self.name.clone() } else { format!("{} ({})", self.name, beside.join(", ")) }
    }
}
