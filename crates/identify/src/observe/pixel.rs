//! The pixel of a board's corner in the image of a camera.
//!
//! r = (m - u) D/f, m, right and down in the image: m the measured pixel, u the predicted one, f the focal
//! length in pixels, and D the board's typical distance, so that an error in pixels is a length there; D and f are constants,
//! and all pixels have the same weight. u is the image of the corner b by the lens, in the camera at
//!
//! - X T t b, the camera fixed at X = instrument_from_base, the board at t on the tip;
//! - (T t)⁻¹ X⁻¹ b, the camera at t on the tip, the board fixed: the "instrument" X is the board.
//!
//! In both cases the tip's motion moves the corner relative to the camera as if the corner were on the tip: forward, or back.

use super::{Discrepancy, Disturbance, Follows, Observe, Rows, Seen};
use crate::parameters::{Layout, Sensitivity};
use denavit_measurements::board::Camera;
use denavit_model::nalgebra::{Matrix3, Point3, Vector2, Vector3};

#[derive(Debug)]
pub(super) struct Pixel;

/// A board is recognised above this cosine between its normal and the line of sight.
const LEAST_SLANT: f64 = 0.25;
/// A corner nearer to the image's edge than this is not recognised, px.
const EDGE: f64 = 4.0;
/// Simulated pixels are written to this many parts.
const PARTS: f64 = 1e4;

/// A corner as seen by the camera.
struct View<'a> {
    camera: &'a Camera,
    /// In the base frame, m.
    point: Vector3<f64>,
    /// In the camera's frame, m.
    in_camera: Vector3<f64>,
    /// Rotation from base to camera; inverted where the camera moves.
    moves: Matrix3<f64>,
    /// The board's normal, away from the viewer, camera's frame.
    normal: Vector3<f64>,
}

fn view<'a>(seen: &Seen<'a>) -> Option<View<'a>> {
    let corner = seen.series.corner.as_ref()?;
    let (camera, instrument, tip) = (&*corner.camera, seen.instrument(), seen.tip);
    let target = &seen.arm.targets[seen.series.target];
    let on_tip = target.translation.vector + seen.perturbation.target;
    let on_board = Vector3::new(corner.at.x, corner.at.y, 0.0);
    Some(if camera.on_hand {
        let point = instrument.inverse() * Point3::from(on_board);
        let towards = (tip.rotation * target.rotation).inverse();
        let in_camera = target.rotation.inverse() * ((tip.inverse() * point).coords - on_tip);
        let normal = towards * instrument.rotation.inverse() * Vector3::z();
        View { camera, point: point.coords, in_camera, moves: -towards.into_inner(), normal }
    } else {
        let point = tip.rotation * (on_tip + target.rotation * on_board) + tip.translation.vector;
        let in_camera = instrument.rotation * point + instrument.translation.vector;
        let normal = instrument.rotation * tip.rotation * target.rotation * Vector3::z();
        View { camera, point, in_camera, moves: instrument.rotation.into_inner(), normal }
    })
}

/// The predicted pixel; an instrument that reads lengths too long sees the image larger.
fn predicted(seen: &Seen<'_>) -> Option<Vector2<f64>> {
    let view = view(seen)?;
    let (pixel, _) = view.camera.lens.project(&view.in_camera)?;
    let centre = view.camera.lens.matrix.fixed_view::<2, 1>(0, 2).into_owned();
    Some(centre + (pixel - centre) * (1.0 + seen.perturbation.scale))
}

fn metres_per_pixel(seen: &Seen<'_>) -> f64 {
    seen.series.corner.as_ref().map_or(1.0, |corner| corner.camera.metres_per_pixel())
}

impl Observe for Pixel {
    fn discrepancy(&self, seen: &Seen<'_>) -> Discrepancy {
        let (read, turn) = (Vector2::new(seen.values[0], seen.values[1]), Vector3::zeros());
        let Some(pixel) = predicted(seen) else {
            // Behind the camera: farther off than any image is wide.
            return Discrepancy { place: Vector3::new(10.0, 10.0, 0.0) * seen.series.range(), turn };
        };
        let left = (read - pixel) * metres_per_pixel(seen);
        Discrepancy { place: Vector3::new(left.x, left.y, 0.0), turn }
    }

    fn follows(&self, seen: &Seen<'_>) -> Follows {
        let behind = Follows::Lines { point: seen.predicted, lines: [Vector3::zeros(); 2] };
        let Some(view) = view(seen) else { return behind };
        let Some((_, by_point)) = view.camera.lens.project(&view.in_camera) else { return behind };
        let by_base = by_point * view.moves * (metres_per_pixel(seen) * (1.0 + seen.perturbation.scale));
        Follows::Lines { point: view.point, lines: [0, 1].map(|row| by_base.row(row).transpose()) }
    }

    fn by_effect(&self, seen: &Seen<'_>, effect: &Sensitivity) -> Vector3<f64> {
        let plain = view(seen).and_then(|view| {
            let centre = view.camera.lens.matrix.fixed_view::<2, 1>(0, 2).into_owned();
            Some(view.camera.lens.project(&view.in_camera)?.0 - centre)
        });
        let moved = plain.unwrap_or_default() * (effect.scale * metres_per_pixel(seen));
        Vector3::new(-moved.x, -moved.y, 0.0)
    }

    fn own_columns(&self, seen: &Seen<'_>, layout: &Layout, _left: &Matrix3<f64>, rows: &mut Rows<'_>) {
        let Follows::Lines { point, lines } = self.follows(seen) else { return };
        let target = &seen.arm.targets[seen.series.target];
        // From the origin of the camera or board on the tip, tip frame.
        let on_tip = target.translation.vector + seen.perturbation.target;
        let arm = (seen.tip.inverse() * Point3::from(point)).coords - on_tip;
        for (row, line) in lines.iter().enumerate() {
            if let Some(column) = layout.instruments[seen.series.setup] {
                let moment = point.cross(line);
                rows.put(row, column, &[-moment.x, -moment.y, -moment.z, -line.x, -line.y, -line.z]);
            }
            if let Some(column) = layout.turns[seen.series.target] {
                rows.put(row, column, (-arm.cross(&(seen.tip.rotation.inverse() * line))).as_slice());
            }
        }
    }

    fn predict(&self, seen: &Seen<'_>, values: &mut Vec<f64>) {
        let pixel = predicted(seen).unwrap_or_default();
        values.extend([pixel.x, pixel.y]);
    }

    fn disturb(&self, values: &mut [f64], errors: &mut Disturbance<'_>) {
        for (value, gross) in values.iter_mut().zip(errors.gross.iter()) {
            // One pixel of error for each millimetre.
            let read = *value + gross * 1e3 + (errors.draw)(errors.pixel);
            *value = if errors.pixel > 0.0 { (read * PARTS).round() / PARTS } else { read };
        }
    }

    fn in_view(&self, seen: &Seen<'_>) -> bool {
        let (Some(view), Some(pixel)) = (view(seen), predicted(seen)) else { return false };
        let [width, height] = view.camera.lens.size.unwrap_or([f64::INFINITY; 2]);
        let inside = |value: f64, size: f64| value > EDGE && value < size - EDGE;
        // The distortion may fold the image: then the pixel does not belong to this point.
        let straight = view.camera.lens.direction(&pixel).is_some_and(|direction| {
            let there = Vector2::new(view.in_camera.x, view.in_camera.y) / view.in_camera.z;
            (direction - there).norm() < 1e-6 || seen.perturbation.scale != 0.0
        });
        let facing = view.normal.dot(&view.in_camera) > LEAST_SLANT * view.in_camera.norm();
        inside(pixel.x, width) && inside(pixel.y, height) && facing && straight
    }
}
