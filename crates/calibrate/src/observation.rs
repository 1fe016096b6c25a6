//! What was measured, and what an arm with parameters predicts of it.

pub mod arm;
pub mod board;
pub mod effects_prior;
pub mod frames;
pub mod gauge;
pub mod kinds;
pub(crate) mod least_squares;
pub mod lens;
pub mod measurements;
pub mod parameters;
pub mod plate;
pub mod prior;
pub(crate) mod symmetric;
