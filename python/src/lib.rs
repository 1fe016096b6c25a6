//! The native part of the Python package `denavit`: values in, the library's functions, values out.
//!
//! It contains no logic. Results that have a JSON contract are returned as that JSON, so that Python and the command line give the
//! same; the public classes are written in Python around these.

mod arrays;
mod chain;
mod compare;
mod errors;
mod fleet;
mod given;
mod given_file;
mod hand_eye;
mod interruptible;
mod measured;
mod poses;
mod robot;
mod run;
mod table;

use pyo3::prelude::*;

/// The native part of `denavit`; use the classes of the package.
#[pymodule(gil_used = false)]
mod _denavit {
    #[pymodule_export]
    use crate::chain::{Chain, branch_names};
    #[pymodule_export]
    use crate::compare::{Comparison, Findings, check, compare, fingerprint, fingerprint_matches};
    #[pymodule_export]
    use crate::fleet::{FleetLedger, fleet_compute, fleet_run};
    #[pymodule_export]
    use crate::given::Effects;
    #[pymodule_export]
    const COLUMNS_IN_WORDS: &str = crate::given_file::COLUMNS_IN_WORDS;
    #[pymodule_export]
    use crate::given_file::{bag_rows, cells, columns_draft, read_bytes};
    #[pymodule_export]
    use crate::hand_eye::hand_eye;
    #[pymodule_export]
    use crate::measured::{Fit, calibrate};
    #[pymodule_export]
    use crate::poses::pose_matrices;
    #[pymodule_export]
    use crate::robot::{Robot, quaternion, read_text, rpy};
    #[pymodule_export]
    use crate::run::{plan, simulate, tell_apart};
    #[pymodule_export]
    use crate::table::{Table, table_columns, table_units};
}
