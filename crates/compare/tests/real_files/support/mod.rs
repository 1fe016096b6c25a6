//! Robots to mutate, written out again as URDF text, and a seeded source of numbers.

pub mod chance;
pub mod harmless;
pub mod real;
pub mod vendor;
pub mod write;

use denavit_compare::Options;
use denavit_model::Reading;

/// Edits are made to numbers as they stand in the files, so that these are what is compared.
pub fn as_written() -> Options {
    Options { reading: Reading::AsWritten, ..Options::default() }
}
