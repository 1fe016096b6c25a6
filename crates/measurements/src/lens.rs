//! A camera's lens: the pixel of a point in front of it, and the viewing direction of a pixel.
//!
//! # Source
//! The models are those of OpenCV (`calib3d`, `fisheye`) and of ROS (REP 104, `sensor_msgs/CameraInfo`): `plumb_bob`,
//! `rational_polynomial` with or without thin prism, and `equidistant`: J. Kannala, S. Brandt, "A generic camera model and
//! calibration method for conventional, wide-angle, and fish-eye lenses", PAMI 2006.

mod file;

pub use file::LensError;

use denavit_model::nalgebra::{Matrix2, Matrix2x3, Matrix3, Vector2, Vector3};

/// The distortion of a lens.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Distortion {
    /// k1, k2, p1, p2, k3, k4, k5, k6, s1, s2, s3, s4 in OpenCV's order: `plumb_bob` has the first five.
    Polynomial([f64; 12]),
    /// k1 … k4 of the angle from the optical axis: `equidistant`, OpenCV's fisheye.
    Fisheye([f64; 4]),
}

/// The known intrinsics of a camera.
#[derive(Debug, Clone, PartialEq)]
pub struct Lens {
    /// Pixels from coordinates on the plane one unit in front of the camera, x to the right and y down.
    pub matrix: Matrix3<f64>,
    /// The distortion, applied before the matrix.
    pub distortion: Distortion,
    /// Width and height of the image, where they are known.
    pub size: Option<[f64; 2]>,
}

/// Smallest depth of a point in front of the camera, as a fraction of its distance.
const IN_FRONT: f64 = 1e-3;
/// Newton's steps to the direction of a pixel.
const MOST_STEPS: usize = 30;
/// Tolerance of a direction, in units of the plane.
const FOUND: f64 = 1e-12;

impl Lens {
    /// A webcam of 640 by 480 pixels without distortion.
    pub fn webcam() -> Self {
        Self {
            matrix: Matrix3::new(600.0, 0.0, 319.5, 0.0, 600.0, 239.5, 0.0, 0.0, 1.0),
            distortion: Distortion::Polynomial([0.0; 12]),
            size: Some([640.0, 480.0]),
        }
    }

    /// Pixels per radian in the middle of the image.
    pub fn focal(&self) -> f64 {
        (self.matrix[(0, 0)] * self.matrix[(1, 1)]).sqrt()
    }

    /// Pixel per unit of the plane.
    fn scale(&self) -> Matrix2<f64> {
        self.matrix.fixed_view::<2, 2>(0, 0).into_owned()
    }

    fn centre(&self) -> Vector2<f64> {
        Vector2::new(self.matrix[(0, 2)], self.matrix[(1, 2)])
    }

    /// The pixel of a point in the camera's frame (m; z forward), and its derivative by the point; `None` where the point is
    /// not in front of the camera.
    pub fn project(&self, point: &Vector3<f64>) -> Option<(Vector2<f64>, Matrix2x3<f64>)> {
        if point.z.is_nan() || point.z <= IN_FRONT * point.norm() {
            return None;
        }
        let on_plane = Vector2::new(point.x / point.z, point.y / point.z);
        let (bent, by_plane) = self.bent(&on_plane);
        let by_point = Matrix2x3::new(1.0, 0.0, -on_plane.x, 0.0, 1.0, -on_plane.y) / point.z;
        let pixel = self.scale() * bent + self.centre();
        pixel.iter().all(|value| value.is_finite()).then(|| (pixel, self.scale() * by_plane * by_point))
    }

    /// The viewing direction of a pixel, as a point on the plane one unit in front of the camera; `None` where there is none.
    pub fn direction(&self, pixel: &Vector2<f64>) -> Option<Vector2<f64>> {
        let wanted = self.scale().try_inverse()? * (pixel - self.centre());
        let mut found = match self.distortion {
            Distortion::Polynomial(_) => wanted,
            // The angle comes first here: the plane stretches it.
            Distortion::Fisheye(_) => wanted * (wanted.norm().min(1.5).tan() / wanted.norm().max(1e-9)),
        };
        for _ in 0..MOST_STEPS {
            let (bent, by_plane) = self.bent(&found);
            let left = wanted - bent;
            if left.norm() < FOUND * (1.0 + wanted.norm()) {
                return Some(found);
            }
            found += by_plane.try_inverse()? * left;
            if !found.iter().all(|value| value.is_finite()) {
                return None;
            }
        }
        None
    }

    /// The distorted position of a point on the plane, and its derivative by the point.
    fn bent(&self, place: &Vector2<f64>) -> (Vector2<f64>, Matrix2<f64>) {
        match &self.distortion {
            Distortion::Polynomial(numbers) => polynomial(place, numbers),
            Distortion::Fisheye(numbers) => fisheye(place, numbers),
        }
    }
}

fn polynomial(place: &Vector2<f64>, numbers: &[f64; 12]) -> (Vector2<f64>, Matrix2<f64>) {
    let [k1, k2, p1, p2, k3, k4, k5, k6, s1, s2, s3, s4] = *numbers;
    let (x, y) = (place.x, place.y);
    let r2 = place.norm_squared();
    let above = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3));
    let below = 1.0 + r2 * (k4 + r2 * (k5 + r2 * k6));
    let radial = above / below;
    // Per r².
    let rate = (k1 + r2 * (2.0 * k2 + r2 * 3.0 * k3) - radial * (k4 + r2 * (2.0 * k5 + r2 * 3.0 * k6))) / below;
    let prism = Vector2::new(s1 + s2 * r2, s3 + s4 * r2) * r2;
    let by_prism = Vector2::new(s1 + 2.0 * s2 * r2, s3 + 2.0 * s4 * r2);
    let tangential =
        Vector2::new(2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x), p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y);
    let across = 2.0 * (p1 * x + p2 * y);
    let by_tangential = Matrix2::new(2.0 * p1 * y + 6.0 * p2 * x, across, across, 6.0 * p1 * y + 2.0 * p2 * x);
    let by_r2 = place * rate + by_prism;
    let by_place = Matrix2::identity() * radial + by_r2 * (place * 2.0).transpose() + by_tangential;
    (place * radial + tangential + prism, by_place)
}

fn fisheye(place: &Vector2<f64>, [k1, k2, k3, k4]: &[f64; 4]) -> (Vector2<f64>, Matrix2<f64>) {
    let r = place.norm();
    if r < 1e-6 {
        return (*place, Matrix2::identity());
    }
    let angle = r.atan();
    let a2 = angle * angle;
    let bent = angle * (1.0 + a2 * (k1 + a2 * (k2 + a2 * (k3 + a2 * k4))));
    let per_angle = 1.0 + a2 * (3.0 * k1 + a2 * (5.0 * k2 + a2 * (7.0 * k3 + a2 * 9.0 * k4)));
    let factor = bent / r;
    let rate = (per_angle / (1.0 + r * r) - factor) / r;
    (place * factor, Matrix2::identity() * factor + place * place.transpose() * (rate / r))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lenses() -> [Lens; 4] {
        let with = |distortion: Distortion| Lens { distortion, ..Lens::webcam() };
        [
            Lens::webcam(),
            with(Distortion::Polynomial([-0.28, 0.07, 2e-4, -1e-3, 0.02, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0])),
            with(Distortion::Polynomial([0.5, -0.2, 1e-3, 4e-4, 0.03, 0.7, -0.1, 0.01, 1e-3, -2e-3, 2e-3, 5e-4])),
            with(Distortion::Fisheye([0.04, -0.02, 0.01, -3e-3])),
        ]
    }

    #[test]
    fn a_pixel_looks_where_its_point_is() {
        for lens in lenses() {
            for (x, y) in [(0.0, 0.0), (0.3, -0.2), (-0.5, 0.35), (1e-8, 2e-8)] {
                let (pixel, _) = lens.project(&Vector3::new(2.0 * x, 2.0 * y, 2.0)).unwrap();
                let found = lens.direction(&pixel).unwrap();
                assert!((found - Vector2::new(x, y)).norm() < 1e-10, "{lens:?} {x} {y}: {found}");
            }
        }
    }

    #[test]
    fn the_derivative_of_a_pixel_is_that_of_its_differences() {
        for lens in lenses() {
            let point = Vector3::new(0.4, -0.3, 1.1);
            let (_, derivative) = lens.project(&point).unwrap();
            for k in 0..3 {
                let step = Vector3::ith(k, 1e-6);
                let ends = [point + step, point - step].map(|point| lens.project(&point).unwrap().0);
                let difference = (ends[0] - ends[1]) / 2e-6 - derivative.column(k);
                assert!(difference.norm() < 1e-5, "{lens:?} {k}: {difference}");
            }
        }
    }

    #[test]
    fn what_is_behind_a_camera_has_no_pixel() {
        assert_eq!(Lens::webcam().project(&Vector3::new(0.1, 0.1, -1.0)), None);
        assert_eq!(Lens::webcam().project(&Vector3::zeros()), None);
    }
}
