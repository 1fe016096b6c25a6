//! Robots to mutate, written out again as URDF text, and a seeded source of numbers.

pub mod chance;
pub mod harmless;
pub mod real;
pub mod vendor;
pub mod write;
