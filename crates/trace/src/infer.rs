//! Error curves of joints: geometry, frames and a smooth error of each joint's own reading fitted together, judged by the
//! marginal likelihood.
//!
//! ```text
//! y = G η + F φ + Σ_j C_j w_j + Σ_e A_e β_e + ε
//! ```
//! [`model`] says what each block of columns is and how large its numbers are expected to be, [`evidence`] scores a model,
//! [`maximum`] finds the few numbers that the score leaves free, [`curves`] fits, [`contest`] compares sets of effects,
//! [`named`] says which of them are sure enough to be named, and `predictor` which of the others a prediction holds.

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
mod predictor;
mod replicates;

pub use curves::{CurveOptions, fit_curves};
pub use hypotheses::{Cause, Hypotheses, Hypothesis, Open};
