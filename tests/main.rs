//! One test binary: a module per command, golden files, the oracle.
