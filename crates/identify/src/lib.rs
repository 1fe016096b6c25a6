//! From data to an arm: predictions of observations, effects beyond geometry, and the fit.
//!
//! ```text
//! arm, parameters, observe   the arm, and its prediction of one observation
//! prior, gauge, frames       its expected errors, and the unobservable frames
//! effects                    what moves a joint or a link beyond its geometry
//! residual, solve            residuals, closed-form Jacobian, normal equations ─► fit
//! identifiability, noise     what the data determine, and how accurate they are
//! averaging                  everything that may act at once, each kind with the size that the data support
//! simulate                   measurements of a robot that is known
//! ```
//! For denavit's own crates: its contents change without notice; the stable names are those at the root of `denavit-calibrate`.

#![expect(clippy::inline_always, reason = "SIMD code must be compiled into the function that enables the instructions")]

pub mod arm;
pub mod averaging;
pub mod carried;
mod continued;
pub mod dh_form;
pub mod effects;
pub mod effects_prior;
pub mod frames;
pub mod gauge;
pub mod identifiability;
pub mod identification;
pub mod identify_options;
pub mod information;
pub mod initial_guess;
pub mod intervals;
mod jacobian_block;
pub mod known_effects;
pub mod lack_of_fit;
mod least_squares;
pub mod noise;
pub mod normal_equations;
pub mod observe;
pub mod parameter;
pub mod parameters;
pub mod posterior;
pub mod prior;
pub mod proportion;
pub mod quantization;
pub mod redundancy;
pub mod residual;
pub mod residual_statistics;
pub mod siblings;
mod simd_residuals;
pub mod simulate;
pub mod solve;
pub mod symmetric;

pub use identification::{EarlierFit, Identification, identify};
pub use identify_options::{IdentifyOptions, fit_stage};
