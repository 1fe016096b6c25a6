//! A tool that two tips of a robot hold together: where one of them has it is where the other has it.
//!
//! A [pose](super::pose) that every row sees from both tips in a frame of its own, the tool's, where it reads nothing but that frame
//! itself: r = X⁻¹ - T t, with X the tool's frame in that row and t how the tip holds it. The joint readings are the measurement.

use super::{Discrepancy, Disturbance, Follows, Frame, Observe, POSE, Part, Rows, Seen, Unknowns};
use crate::observation::measurements::MeasurementError;
use crate::observation::parameters::Layout;
use denavit_model::nalgebra::Matrix3;

#[derive(Debug)]
pub(super) struct Grip;

/// Place and orientation of a frame in itself.
const ITSELF: [f64; 12] = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];

impl Observe for Grip {
    fn name(&self) -> &'static str {
        "grip"
    }

    fn plural(&self) -> &'static str {
        "grips of a tool"
    }

    fn place(&self) -> Part {
        Part { word: "grip", height: 3, unit: "m", by_turn: false }
    }

    fn turn(&self) -> Option<Part> {
        Some(Part { word: "turn of the grip", height: 3, unit: "rad", by_turn: true })
    }

    fn unknowns(&self) -> Unknowns {
        Unknowns { frame: Frame::Grip, turn: true, ..Unknowns::default() }
    }

    fn numbers(&self) -> usize {
        ITSELF.len()
    }

    fn discrepancy(&self, seen: &Seen<'_>) -> Discrepancy {
        POSE.discrepancy(seen)
    }

    fn follows(&self, seen: &Seen<'_>) -> Follows {
        POSE.follows(seen)
    }

    fn own_columns(&self, seen: &Seen<'_>, layout: &Layout, left: &Matrix3<f64>, rows: &mut Rows<'_>) {
        POSE.own_columns(seen, layout, left, rows);
    }

    fn own_target(&self) -> Option<&'static str> {
        Some("grip")
    }

    fn own_setup(&self) -> &'static str {
        "tool"
    }

    fn label(&self) -> Option<&'static str> {
        Some("grip")
    }

    fn holds_the_target(&self) -> bool {
        true
    }

    fn predict(&self, seen: &Seen<'_>, values: &mut Vec<f64>) {
        POSE.predict(seen, values);
    }

    fn disturb(&self, values: &mut [f64], errors: &mut Disturbance<'_>) {
        POSE.disturb(values, errors);
    }

    fn columns(&self, _target: &str) -> Vec<String> {
        Vec::new()
    }

    fn of_cells(&self, _cells: &[f64], values: &mut Vec<f64>) -> Result<f64, MeasurementError> {
        values.extend(ITSELF);
        Ok(0.0)
    }

    fn lengths(&self) -> usize {
        0
    }
}
