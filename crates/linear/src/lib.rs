//! One linear Gaussian model and its results.
//!
//! ```text
//! y = X b + e,   b ~ N(0, diag v),   e ~ N(0, R),   R block diagonal: one block per measured row (a posture)
//!
//! columns + prior + noise ─► Gram ─┬─► evidence      -2 log p(y), and its derivatives
//!                                  ├─► posterior     mean and covariance of b; prediction of other rows
//!                                  └─► leave_out     every row predicted from all others
//! ```
//! [`components`] is the same evidence as a function of a few sizes, which set variances and noise; [`minimise`] finds the best
//! sizes. The crate knows matrices, but no robots. Below: products of columns and Cholesky factors with SIMD ([`products`],
//! [`triangle`], [`panel`]), on all cores ([`threads`]), with cancellation ([`stop`]).

#![expect(clippy::inline_always, reason = "SIMD code must be compiled into the function that enables the instructions")]

pub mod components;
mod evidence;
pub mod gram;
mod leave_out;
pub mod minimise;
pub mod panel;
pub mod posterior;
pub mod products;
pub mod stop;
pub mod threads;
pub mod triangle;

pub use components::{Components, Part, Pull};
pub use gram::{Curvature, Gram, Problem};
pub use posterior::Posterior;
