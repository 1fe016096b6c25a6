//! What is compared, over which range, and with how many samples.

use denavit_model::formats::Format;
use denavit_model::tree::Reading;

/// How two robots are compared.
#[derive(Debug, Clone, PartialEq)]
pub struct Options {
    /// Lengths closer than this are equal, m.
    pub tolerance_m: f64,
    /// Angles closer than this are equal, rad.
    pub tolerance_rad: f64,
    /// Masses and inertia tensors closer than this are equal, relative.
    pub tolerance_mass: f64,
    /// What is compared.
    pub scope: Scope,
    /// The pose of the robot on its root link does not count.
    pub up_to_base: bool,
    /// Joint zero offsets and senses do not count.
    pub up_to_zeros: bool,
    /// Added, removed and renamed links, joints and frames count, too.
    pub count_names: bool,
    /// Ranges to sample instead of the joint limits.
    pub q_range: Vec<Range>,
    /// Configurations to sample.
    pub samples: usize,
    /// Start of the low-discrepancy sequence.
    pub seed: u64,
    /// How decimal literals of angles and axes are read.
    pub reading: Reading,
    /// An intermediate format between the two: what it cannot express does not count.
    pub through: Option<Format>,
}

/// What is compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Scope {
    /// Motion, limits, inertials, shapes.
    #[default]
    Everything,
    /// Only motion and its limits: no inertials, shapes, speeds and efforts.
    Kinematics,
}

/// A range of joint values.
#[derive(Debug, Clone, PartialEq)]
pub struct Range {
    /// The joint; `None` for every joint that has no range of its own in the list.
    pub joint: Option<String>,
    /// Lowest value, rad or m.
    pub lower: f64,
    /// Highest value, rad or m.
    pub upper: f64,
}

impl Default for Options {
    /// 0.1 µm and 1 µrad: far below manufacturing tolerances, far above rounding to twelve digits.
    fn default() -> Self {
        Self {
            tolerance_m: 1e-7,
            tolerance_rad: 1e-6,
            tolerance_mass: 1e-6,
            scope: Scope::Everything,
            up_to_base: false,
            up_to_zeros: false,
            count_names: false,
            q_range: Vec::new(),
            samples: 4096,
            seed: 1,
            reading: Reading::Intended,
            through: None,
        }
    }
}
