//! What a reader did with everything in its source: understood, kept, or reported.
//!
//! Every reader (URDF, xacro, tables, makers' files, measurements) returns its value together with an [`Inventory`].
//! What is understood is only counted; what is not has an [`Item`] with its place.

use crate::notes::Place;

/// What a reader did with something that it does not understand.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Outcome {
    /// Kept unchanged, and independent of everything that is re-expressed: a colour, a comment, a plugin's text.
    Carried,
    /// Ignored, and reported by a note or an error.
    Reported,
}

/// One thing in the source that the reader did not understand.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Item {
    /// Where it stands.
    pub place: Place,
    /// What it is, as the file writes it: `attribute quat="0 0 0 1"`, `<loop_joint>`, `column "remark"`.
    pub what: String,
    /// What was done with it.
    pub outcome: Outcome,
}

/// Everything in a source, in its order.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Inventory {
    /// How many attributes, elements, cells and rows were understood.
    pub understood: usize,
    /// Everything else.
    pub items: Vec<Item>,
}

impl Inventory {
    /// Counts one thing that was understood.
    pub fn understand(&mut self) {
        self.understood += 1;
    }

    /// Records something that is kept unchanged.
    pub fn carry(&mut self, place: Place, what: impl Into<String>) {
        self.items.push(Item { place, what: what.into(), outcome: Outcome::Carried });
    }

    /// Records something that a note or an error reports.
    pub fn report(&mut self, place: Place, what: impl Into<String>) {
        self.items.push(Item { place, what: what.into(), outcome: Outcome::Reported });
    }

    /// How many items had this outcome.
    pub fn count(&self, outcome: Outcome) -> usize {
        self.items.iter().filter(|item| item.outcome == outcome).count()
    }

    /// What is reported, in the order of the source.
    pub fn reported(&self) -> impl Iterator<Item = &Item> {
        self.items.iter().filter(|item| item.outcome == Outcome::Reported)
    }

    /// Adds the inventory of another reader of the same source.
    pub fn append(&mut self, other: Self) {
        self.understood += other.understood;
        self.items.extend(other.items);
    }
}
