//! Choices that the geometry does not determine, made so that an engineer recognises the robot.

use crate::table::{Row, ToolPart};
use denavit_model::chain::Chain;
use denavit_model::se3::{self, Pose};
use std::f64::consts::{FRAC_PI_2, PI};

/// How choices that the geometry does not determine are made.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Gauge {
    /// The fewest numbers that are not 0, quarter turns before other angles, frames continuous with their neighbours.
    #[default]
    Simple,
    /// The paper's rule: a ≥ 0 (where axes meet, alpha ≥ 0), and d of parallel axes at the end of their run.
    Paper,
}

/// The readability cost of a number. Only the order of the sums matters.
const LENGTH: f64 = 10.0;
const ODD_ANGLE: f64 = 10.0;
const HALF_TURN: f64 = 6.0;
const QUARTER_TURN: f64 = 5.0;
const NEGATIVE_LENGTH: f64 = 0.2;
const NEGATIVE_ANGLE: f64 = 0.5;
/// Of two equal places for a number the row of a joint is better than the base or the tool, a later row than an earlier.
const OUTSIDE_THE_JOINTS: f64 = 0.2;
const EARLIER: f64 = 0.001;
/// A joint that counts from its frame's own zero is better than one with an offset.
const OFFSET: f64 = 0.3;
/// A slide is expected on the side where the arm continues.
const BEHIND_A_SLIDE: f64 = 0.1;

/// A length below this many times the robot's size, or an angle below this many rad, reads as 0.
const READS_AS_ZERO: f64 = 1e-9;

/// Sums the readability costs of a table.
pub(crate) struct Weigher {
    gauge: Gauge,
    size: f64,
    /// Whether joint k slides.
    slides: Vec<bool>,
}

impl Weigher {
    pub fn new(gauge: Gauge, chain: &Chain) -> Self {
        Self {
            gauge,
            size: chain.size(),
            slides: chain.joints().iter().map(|joint| joint.screw.line().is_none()).collect(),
        }
    }

    pub fn size(&self) -> f64 {
        self.size
    }

    /// Whether two frames are equivalent for every later row.
    pub fn same(&self, a: &Pose, b: &Pose) -> bool {
        let (turned, moved) = se3::difference(a, b);
        turned < READS_AS_ZERO && moved < READS_AS_ZERO * self.size
    }

    /// Cost of row `index` (0: base).
    pub fn row(&self, index: usize, row: &Row) -> f64 {
        if self.gauge == Gauge::Paper {
            return 0.0;
        }
        let angles = angle(row.theta()) + angle(row.alpha()) + angle(row.beta().unwrap_or(0.0));
        let offset = if index > 0 && angle(row.theta()) > 0.0 { OFFSET } else { 0.0 };
        let before = self.slides.len().saturating_sub(index) as f64 * EARLIER;
        let place = before + if index == 0 { OUTSIDE_THE_JOINTS } else { 0.0 };
        let behind_a_slide = index > 0 && self.slides[index - 1];
        let a_place = place + if behind_a_slide { BEHIND_A_SLIDE } else { 0.0 };
        let lengths = self.length(row.a(), a_place) + self.length(row.d().unwrap_or(0.0), place);
        angles + offset + lengths
    }

    /// Cost of the tool's part.
    pub fn tool(&self, tool: &ToolPart) -> f64 {
        if self.gauge == Gauge::Paper {
            return 0.0;
        }
        angle(tool.theta) + self.length(tool.d, OUTSIDE_THE_JOINTS)
    }

    fn length(&self, length: f64, place: f64) -> f64 {
        if length.abs() < READS_AS_ZERO * self.size {
            return 0.0;
        }
        LENGTH + place + if length < 0.0 { NEGATIVE_LENGTH } else { 0.0 }
    }
}

fn angle(angle: f64) -> f64 {
    let near = |value: f64| (angle.abs() - value).abs() < READS_AS_ZERO;
    let sense = if angle < 0.0 && !near(PI) { NEGATIVE_ANGLE } else { 0.0 };
    let kind = if near(0.0) {
        return 0.0;
    } else if near(FRAC_PI_2) {
        QUARTER_TURN
    } else if near(PI) {
        HALF_TURN
    } else {
        ODD_ANGLE
    };
    kind + sense
}
