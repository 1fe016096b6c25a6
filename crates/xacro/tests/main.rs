//! Expansion from the outside: features, errors, limits, packages, vendors' files.

mod errors;
mod features;
mod limits;
mod mutation;
mod packages;
mod support;
mod vendor;
mod xml;
