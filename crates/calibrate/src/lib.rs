//! See the crate description; written below.
