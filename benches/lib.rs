//! Holds nothing: each benchmark is a file beside this one.
