//! The store, the page that describes it, and the statistics of fleets.

#![allow(clippy::unwrap_used, reason = "a test that cannot make its input has failed")]

mod page;
mod stored;
mod watched;
