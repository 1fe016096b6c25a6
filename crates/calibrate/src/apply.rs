//! What is done with a robot model: commands that make up for its errors, poses to measure.

pub mod compensate;
pub mod delta_table;
pub mod identifiable;
pub mod plan;
pub mod print_plate;
