//! A camera and the board that it sees: one of them is fixed, the other is on the tip.

use super::lens::Lens;
use denavit_model::nalgebra::{Matrix3, Rotation3};
use denavit_model::nalgebra::{Matrix6, SMatrix, Vector2, Vector3, Vector6};
use denavit_model::units::Unit;
use denavit_model::{Pose, Quantity, se3};
use std::fmt;
use std::str::FromStr;
use std::sync::Arc;
use thiserror::Error;

/// A chessboard or ChArUco board, by its squares.
///
/// Inner corners are numbered from 0, along the first row and then row by row, as OpenCV does; corner 0 is one square from
/// the board's origin to the right (x) and down (y).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Board {
    /// Squares across.
    pub columns: usize,
    /// Squares down.
    pub rows: usize,
    /// Edge of a square, m.
    pub square: f64,
}

/// A text that is not a board.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error(
    "\"{0}\" is not a board; write the squares across and down and the edge of a square, such as 7x5:30mm (a chessboard of 7 by 5 \
     squares has 6 by 4 corners)"
)]
pub struct BoardError(pub String);

impl FromStr for Board {
    type Err = BoardError;

    /// `7x5:30mm`.
    fn from_str(text: &str) -> Result<Self, BoardError> {
        let known = |columns: usize, rows: usize| columns > 2 && rows > 2 && columns * rows <= 10_000;
        let read = grid(text).filter(|([columns, rows], _)| known(*columns, *rows));
        read.map(|([columns, rows], square)| Self { columns, rows, square }).ok_or_else(|| BoardError(text.into()))
    }
}

/// Parses text such as `7x5:30mm`: columns and rows, and a length above 0, m.
pub(super) fn grid(text: &str) -> Option<([usize; 2], f64)> {
    let (counts, length) = text.split_once(':')?;
    let (columns, rows) = counts.split_once(['x', 'X', '×'])?;
    let counts = [columns.trim().parse().ok()?, rows.trim().parse().ok()?];
    Some((counts, Unit::value(length, Quantity::Length)?)).filter(|(_, length)| *length > 0.0)
}

impl fmt::Display for Board {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}x{} squares of {} mm", self.columns, self.rows, self.square * 1e3)
    }
}

impl Board {
    /// Number of inner corners.
    pub fn corners(&self) -> usize {
        (self.columns - 1) * (self.rows - 1)
    }

    /// Position of an inner corner on the board, m; `None` where the board has no corner of that number.
    pub fn corner(&self, number: usize) -> Option<Vector2<f64>> {
        let across = self.columns - 1;
        let place = |index: usize| (index + 1) as f64 * self.square;
        (number < self.corners()).then(|| Vector2::new(place(number % across), place(number / across)))
    }
}

/// The known properties of a camera and its board.
#[derive(Debug, Clone, PartialEq)]
pub struct Sight {
    /// The camera's intrinsics.
    pub lens: Lens,
    /// Whether the camera is on the tip and the board fixed; else the other way round.
    pub on_hand: bool,
    /// The board's corners by their numbers; a file may also give positions of its corners.
    pub board: Option<Board>,
}

impl Sight {
    /// The part on the tip.
    pub fn on_tip(&self) -> &'static str {
        if self.on_hand { "camera" } else { "board" }
    }
}

/// A camera that sees a corner.
#[derive(Debug, Clone, PartialEq)]
pub struct Camera {
    /// Its intrinsics.
    pub lens: Lens,
    /// Whether it sits on the tip.
    pub on_hand: bool,
    /// Typical distance of the board, m: errors in pixels are given as lengths at this distance.
    pub range: f64,
}

impl Camera {
    /// Metres per pixel at the board's distance.
    pub fn metres_per_pixel(&self) -> f64 {
        self.range / self.lens.focal()
    }
}

/// A corner of a board, and the camera that sees it.
#[derive(Debug, Clone, PartialEq)]
pub struct Corner {
    /// Its number, or its position as written.
    pub label: String,
    /// Its position on the board, m.
    pub at: Vector2<f64>,
    /// The camera.
    pub camera: Arc<Camera>,
}

/// A board's pose needs at least this many corners.
const LEAST_CORNERS: usize = 4;
/// A homography is unique if its second smallest singular value is above this fraction of the largest.
const ONLY_ONE: f64 = 1e-6;
/// Gauss-Newton steps for the pose of a board.
const STEPS: usize = 10;

/// camera_from_board of these corners seen at these pixels; `None` where they do not determine it.
///
/// # Shape and units
/// Places on the board, m, and pixels, one each.
///
/// # Source
/// Z. Zhang, "A flexible new technique for camera calibration", PAMI 2000: the homography gives the start, Gauss-Newton on
/// the pixels the result.
pub fn board_pose(lens: &Lens, seen: &[(Vector2<f64>, Vector2<f64>)]) -> Option<Pose> {
    if seen.len() < LEAST_CORNERS {
        return None;
    }
    let looked: Vec<(Vector2<f64>, Vector2<f64>)> =
        seen.iter().map(|(at, pixel)| Some((*at, lens.direction(pixel)?))).collect::<Option<_>>()?;
    let mut pose = from_homography(&looked)?;
    for _ in 0..STEPS {
        let (mut normal, mut right) = (Matrix6::zeros(), Vector6::zeros());
        for (at, pixel) in seen {
            let turned = pose.rotation * Vector3::new(at.x, at.y, 0.0);
            let (found, by_point) = lens.project(&(turned + pose.translation.vector))?;
            let mut by_pose = SMatrix::<f64, 2, 6>::zeros();
            by_pose.fixed_columns_mut::<3>(0).copy_from(&(-by_point * se3::skew(&turned)));
            by_pose.fixed_columns_mut::<3>(3).copy_from(&by_point);
            normal += by_pose.transpose() * by_pose;
            right += by_pose.transpose() * (pixel - found);
        }
        let step = normal.cholesky()?.solve(&right);
        let turn = Rotation3::from_scaled_axis(Vector3::new(step[0], step[1], step[2])) * pose.rotation;
        let moved = pose.translation.vector + Vector3::new(step[3], step[4], step[5]);
        pose = se3::pose(se3::orthonormalised(&turn), moved);
    }
    (pose.translation.vector.z > 0.0).then_some(pose)
}

/// The pose of the homography from the board to the plane in front of the camera.
fn from_homography(seen: &[(Vector2<f64>, Vector2<f64>)]) -> Option<Pose> {
    let count = seen.len() as f64;
    let middle = seen.iter().map(|(at, _)| at).sum::<Vector2<f64>>() / count;
    let size = (seen.iter().map(|(at, _)| (at - middle).norm_squared()).sum::<f64>() / count).sqrt();
    let mut normal = SMatrix::<f64, 9, 9>::zeros();
    for (at, looked) in seen {
        let own = (at - middle) / size;
        let (x, y, u, v) = (own.x, own.y, looked.x, looked.y);
        for line in [[x, y, 1.0, 0.0, 0.0, 0.0, -u * x, -u * y, -u], [0.0, 0.0, 0.0, x, y, 1.0, -v * x, -v * y, -v]] {
            let line = SMatrix::<f64, 9, 1>::from(line);
            normal += line * line.transpose();
        }
    }
    let own = normal.symmetric_eigen();
    let mut order: Vec<usize> = (0..9).collect();
    order.sort_by(|a, b| own.eigenvalues[*a].total_cmp(&own.eigenvalues[*b]));
    if own.eigenvalues[order[1]] < ONLY_ONE * ONLY_ONE * own.eigenvalues[order[8]] {
        return None;
    }
    let best = own.eigenvectors.column(order[0]).into_owned();
    let homography = Matrix3::from_row_slice(best.as_slice());
    let columns = [0, 1, 2].map(|k| homography.column(k).into_owned());
    // The board is in front of the camera.
    let sign = if columns[2].z < 0.0 { -1.0 } else { 1.0 };
    let length = sign * 2.0 / (columns[0].norm() + columns[1].norm());
    let [x, y, place] = columns.map(|column| column * length);
    let rough = Matrix3::from_columns(&[x, y, x.cross(&y)]);
    let svd = rough.svd(true, true);
    let rotation = Rotation3::from_matrix_unchecked(svd.u? * svd.v_t?);
    let origin = place * size - rotation * Vector3::new(middle.x, middle.y, 0.0);
    origin.iter().all(|value| value.is_finite()).then(|| se3::pose(rotation, origin))
}

#[cfg(test)]
mod tests {
    use super::*;
    use denavit_model::nalgebra::Point3;

    #[test]
    fn a_board_is_written_by_its_squares() {
        let board: Board = "7x5:30mm".parse().unwrap();
        assert_eq!(board, Board { columns: 7, rows: 5, square: 0.03 });
        assert_eq!((board.corners(), board.corner(7), board.corner(24)), (24, Some(Vector2::new(0.06, 0.06)), None));
        for wrong in ["7x5", "7:30mm", "7x5:30", "1x5:30mm", "7x5:-3mm", "axb:1mm", ""] {
            assert_eq!(wrong.parse::<Board>(), Err(BoardError(wrong.into())), "{wrong}");
        }
    }

    #[test]
    fn the_pose_of_a_board_is_found_from_its_pixels() {
        let board: Board = "7x5:30mm".parse().unwrap();
        let lens = Lens::webcam();
        for turn in [[0.0, 0.0, 0.0], [0.4, -0.3, 1.0], [-0.6, 0.5, -2.5], [0.1, 0.9, 3.1]] {
            let pose = se3::pose(Rotation3::from_scaled_axis(turn.into()), Vector3::new(0.02, -0.05, 0.6));
            let corners = (0..board.corners()).filter_map(|number| board.corner(number));
            let seen: Vec<_> = corners
                .map(|at| (at, lens.project(&(pose * Point3::new(at.x, at.y, 0.0)).coords).unwrap().0))
                .collect();
            let found = board_pose(&lens, &seen).unwrap();
            let left =
                (found.translation.vector - pose.translation.vector).norm() + found.rotation.angle_to(&pose.rotation);
            assert!(left < 1e-9, "{turn:?}: {left}");
            // Three corners, and corners in one line, do not determine it.
            assert_eq!(board_pose(&lens, &seen[..3]), None);
            assert_eq!(board_pose(&lens, &seen[..6]), None);
        }
    }
}
