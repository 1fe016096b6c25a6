//! Forward kinematics of many postures: eight at once, with sines of their own, in loops that a compiler makes vectors of.

use crate::program::{Statement, Value};
use crate::render::Writer;
use serde::Serialize;

/// Beyond this joint value, rad, the reduction by quarter turns loses digits and the library's sines are taken.
const LARGEST: f64 = 1e5;

/// Leading 33 bits of π/2, so that its product with fewer than 2^20 quarter turns is exact, and the rest of it.
const QUARTER_TURN: [f64; 2] = [1.570_796_326_734_125_6, 6.077_100_506_506_192e-11];

/// 1.5 · 2^52: what is added to it becomes whole, in its lowest bits.
const ROUNDER: f64 = 6_755_399_441_055_744.0;

/// sin r = r + r³ (c\[0\] + r² c\[1\] + ···) on \[-π/4, π/4\], error below 2^-58.
///
/// # Source
/// fdlibm, k_sin.c, Sun Microsystems 1993.
const SINE: [f64; 6] = [
    -1.666_666_666_666_663_2e-1,
    8.333_333_333_322_49e-3,
    -1.984_126_982_985_795e-4,
    2.755_731_370_707_007e-6,
    -2.505_076_025_340_686_4e-8,
    1.589_690_995_211_55e-10,
];

/// cos r = 1 - r²/2 + r⁴ (c\[0\] + r² c\[1\] + ···) on \[-π/4, π/4\], error below 2^-58.
///
/// # Source
/// fdlibm, k_cos.c, Sun Microsystems 1993.
const COSINE: [f64; 6] = [
    4.166_666_666_666_66e-2,
    -1.388_888_888_887_411e-3,
    2.480_158_728_947_673e-5,
    -2.755_731_435_139_066_3e-7,
    2.087_572_321_298_175e-9,
    -1.135_964_755_778_819_5e-11,
];

/// What the templates fill in.
#[derive(Debug, Serialize)]
pub struct Shown {
    /// rad, of the posture in a lane.
    angles: Vec<String>,
    lines: Vec<String>,
    largest: String,
    quarters_per_radian: String,
    rounder: String,
    quarter_turn: [String; 2],
    sine: [String; 6],
    cosine: [String; 6],
    /// How far the self-test lets these poses be from those of one posture, m or -.
    tolerance: String,
}

impl Shown {
    /// Of the statements of a pose whose outputs are `pose`, by a writer for lanes.
    pub fn of(statements: &[&Statement], pose: &[&Value], writer: &Writer, size: f64) -> Self {
        let mut angles = Vec::new();
        // A sine has a name of its own in the lanes, which the other lines read.
        let read = |name: &String| {
            statements.iter().any(|statement| statement.reads().contains(&name.as_str()))
                || pose.iter().any(|value| value.name() == Some(name))
        };
        let mut lines = Vec::new();
        for statement in statements {
            if let Statement::SinCos { sine, cosine, angle } = statement {
                for (name, array) in [(sine, "sine"), (cosine, "cosine")] {
                    if read(name) {
                        lines.push(writer.assigned(name, &format!("{array}[{}][lane]", angles.len())));
                    }
                }
                angles.push(writer.sum(angle));
            } else {
                lines.extend(writer.lines(&[statement], pose));
            }
        }
        let numbers = |numbers: [f64; 6]| numbers.map(|number| writer.number(number));
        Self {
            angles,
            lines,
            largest: writer.number(LARGEST),
            quarters_per_radian: writer.number(std::f64::consts::FRAC_2_PI),
            rounder: writer.number(ROUNDER),
            quarter_turn: QUARTER_TURN.map(|part| writer.number(part)),
            sine: numbers(SINE),
            cosine: numbers(COSINE),
            tolerance: writer.number(1e-13 * size.max(1.0)),
        }
    }
}
