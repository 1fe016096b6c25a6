//! One linear Gaussian model, and what is read off it.
//!
//! ```text
//! y = X b + e,   b ~ N(0, diag v),   e ~ N(0, R),   R block by block: one block a row of measurement (a posture)
//!
//! columns + prior + noise ─► Gram ─┬─► evidence      -2 log p(y), and its derivatives
//!                                  ├─► posterior     mean and covariance of b; prediction of other rows
//!                                  └─► leave_out     every row predicted from all the others
//! ```
//! [`components`] is the same evidence as a function of some few sizes, of which variances and noise are made; [`minimise`] finds the best
//! of them. The crate knows matrices, and nothing of robots. Below: products of columns and Cholesky factors in vectors of the machine
//! ([`products`], [`triangle`], [`panel`]), on all cores ([`threads`]), until somebody asks to stop ([`stop`]).

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
