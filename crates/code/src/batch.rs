//! Forward kinematics of many postures: eight or sixteen at once, with own sines, in loops that a compiler vectorises.

use crate::program::{Statement, Value};
use crate::render::Writer;
use denavit_model::compiled::quarter_turns::{COSINE, LARGEST_REDUCED, QUARTER_TURN, QUARTER_TURN_REST, ROUNDER, SINE};
use serde::Serialize;

/// The values for the templates.
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
            largest: writer.number(LARGEST_REDUCED),
            quarters_per_radian: writer.number(std::f64::consts::FRAC_2_PI),
            rounder: writer.number(ROUNDER),
            quarter_turn: [QUARTER_TURN, QUARTER_TURN_REST].map(|part| writer.number(part)),
            sine: numbers(SINE),
            cosine: numbers(COSINE),
            tolerance: writer.number(1e-13 * size.max(1.0)),
        }
    }
}
