//! From data to an arm: what it predicts of an observation, what moves it beyond its geometry, and the fit.
//!
//! ```text
//! arm, parameters, observe   the arm, and what it predicts of one observation
//! prior, gauge, frames       how far it may be from its drawing, and what no data can tell
//! effects                    what moves a joint or a link beyond its geometry
//! residual, solve            residuals, closed-form Jacobian, normal equations ─► fit
//! identifiability, noise     what the data tell, and how exact they are
//! averaging                  everything that may act at once, each kind as large as the data say
//! simulate                   measurements of a robot that is known
//! ```
//! For denavit's own crates: what is in it changes without notice; the names that stay are those at the root of `denavit-calibrate`.

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
