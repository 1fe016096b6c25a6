//! Names of columns that have a meaning, and how many columns a file may have.

/// Most columns: the corners of a large board and recorded quantities are a few thousand.
pub(super) const MOST_COLUMNS: usize = 10_000;

/// Covariates with a meaning: s, °C, kg at the tip link's origin.
pub(super) const KNOWN_COVARIATES: [&str; 3] = ["time", "temperature", "payload"];
/// Endings of further columns of a joint.
pub(super) const OF_JOINTS: [&str; 3] = ["velocity", "approach", "temperature"];
/// Names of measured values.
pub(super) const KNOWN_VALUES: [&str; 15] = [
    "x",
    "y",
    "z",
    "qx",
    "qy",
    "qz",
    "qw",
    "distance",
    "locate",
    "hole",
    "gravity_x",
    "gravity_y",
    "gravity_z",
    "inclination_x",
    "inclination_y",
];
