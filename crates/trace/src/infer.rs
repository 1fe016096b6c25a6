//! The linear Gaussian model of a run: geometry, frames, a smooth error curve of each joint's reading and effects, fitted together
//! and scored by the marginal likelihood.
//!
//! ```text
//! y = G η + F φ + Σ_j C_j w_j + Σ_e A_e β_e + ε
//! ```
//! [`model`] describes each block of columns and its prior, [`evidence`] scores a model, [`maximum`] finds the hyperparameters,
//! [`curves`] fits, [`contest`] compares sets of effects, [`named`] decides which of them are named, and which others are
//! included for the prediction.

pub mod contest;
pub mod curves;
pub mod deflection;
pub mod evidence;
mod gaps;
pub mod gram;
pub mod hypotheses;
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a number of orders to try")]
pub mod lines;
pub mod maximum;
mod members;
pub mod model;
pub mod named;
mod replicates;

pub use curves::{CurveOptions, fit_curves};
pub use hypotheses::{Cause, Hypotheses, Hypothesis, Open};
