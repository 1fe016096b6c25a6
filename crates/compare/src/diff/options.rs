//! What counts, over which range, and how hard to look.

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
    /// Where and how the robot stands on its root link does not matter.
    pub up_to_base: bool,
    /// Joint zero offsets and senses do not matter.
    pub up_to_zeros: bool,
    /// Added, removed and renamed links, joints and frames matter, too.
    pub count_names: bool,
    /// Ranges to sample instead of the joint limits.
    pub q_range: Vec<Range>,
    /// Configurations to sample.
    pub samples: usize,
    /// Start of the low-discrepancy sequence.
    pub seed: u64,
    /// How decimal literals of angles and axes are read.
    pub reading: Reading,
    /// A format on the way from one to the other: what it cannot say does not count.
    pub through: Option<Format>,
}

/// What is compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Scope {
    /// Motion, limits, inertials, shapes.
    #[default]
    Everything,
    /// Only what moves how and how far: no inertials, shapes, speeds and efforts.
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
    /// 0.1 µm and 1 µrad: far below what is built, far above what rounding to twelve digits leaves.
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
