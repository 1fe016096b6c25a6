//! The pixel of a board's corner in the image of a camera, right and down, px.

use super::{Frame, ObservationKind, Part, Recorded, Unknowns};
use crate::MeasurementError;
use crate::board::{Corner, board_pose};
use denavit_model::nalgebra::Vector2;

#[derive(Debug)]
pub(super) struct Pixel;

impl Recorded for Pixel {
    fn name(&self) -> &'static str {
        "pixel"
    }

    fn plural(&self) -> &'static str {
        "images"
    }

    fn place(&self) -> Part {
        Part { word: "reprojection", height: 2, unit: "m", by_turn: true }
    }

    fn unknowns(&self) -> Unknowns {
        Unknowns { frame: Frame::Instrument, turn: true, ..Unknowns::default() }
    }

    fn numbers(&self) -> usize {
        2
    }

    fn own_setup(&self) -> &'static str {
        "camera"
    }

    fn of_a_board(&self) -> bool {
        true
    }

    fn together(&self, seen: &[(&Corner, &[f64])]) -> Option<(ObservationKind, Vec<f64>)> {
        let camera = &seen.first()?.0.camera;
        let pixels: Vec<_> =
            seen.iter().map(|(corner, values)| (corner.at, Vector2::new(values[0], values[1]))).collect();
        let pose = board_pose(&camera.lens, &pixels)?;
        let pose = if camera.on_hand { pose.inverse() } else { pose };
        let place = pose.translation.vector;
        Some((ObservationKind::Pose, place.iter().chain(pose.rotation.matrix().iter()).copied().collect()))
    }

    fn columns(&self, corner: &str) -> Vec<String> {
        vec![format!("u{corner}"), format!("v{corner}")]
    }

    fn of_cells(&self, cells: &[f64], values: &mut Vec<f64>) -> Result<f64, MeasurementError> {
        values.extend_from_slice(cells);
        Ok(0.0)
    }

    fn lengths(&self) -> usize {
        0
    }
}
