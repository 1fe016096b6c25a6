//! Comparing, checking and fingerprinting from the command line.

mod recipes;
