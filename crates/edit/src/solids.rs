//! Simple solids around the triangles of a mesh: boxes, cylinders, spheres, convex hulls.
//!
//! Each is found from the corners of the convex hull and rounded outwards, so that the numbers of a file hold every point. Boxes and
//! cylinders are aligned with the mesh's own axes, its principal axes, or a face of the hull.

use denavit_model::hull::{Hull, signed_volume};
use denavit_model::nalgebra::{Matrix3, Rotation3, SymmetricEigen, Unit, Vector3};
use denavit_model::robot::Geometry;
use denavit_model::se3::{self, Pose};
use std::collections::BTreeMap;
use std::fmt::Write as _;

pub use denavit_model::hull::Triangle;
pub(crate) use denavit_model::hull::in_no_order;

/// Directions of hull faces that are tried, the largest faces first.
const FACES_TRIED: usize = 200;

/// A rotated solid replaces one along the mesh's own axes only if its volume is less than this fraction, because a shape
/// without angles is easier to read.
const WORTH_TURNING: f64 = 0.99;

/// Rounding of a face's plane, relative to the size of the hull.
const ON_THE_FACE: f64 = 1e-12;

/// Rounding of the corners of a face, relative to the size of the hull.
const UNSURE: f64 = 8.0 * f64::EPSILON;

/// Lengths are rounded outwards to this fraction of the size.
const OUTWARDS: f64 = 1e-6;

/// Two normals closer than this, rad, are one direction.
const ONE_DIRECTION: f64 = 1e-6;

/// What is inside has normal · point ≤ offset.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Plane {
    normal: Vector3<f64>,
    offset: f64,
}

/// The planes of its faces, with every corner times factors. `far`: the length, m, whose rounding error the compared points carry.
pub(crate) fn planes(hull: &Hull, factors: [f64; 3], far: f64) -> Vec<Plane> {
    let scaled = scaled(hull, factors);
    let size = scaled.corners.iter().fold(0.0, |size: f64, corner| size.max(corner.amax()));
    let plane = |[a, b, c]: Triangle| {
        let across = (b - a).cross(&(c - a));
        let longest = (b - a).norm().max((c - b).norm()).max((a - c).norm());
        // Rounding turns the normal of a face as thin as rounding itself; its neighbours shut out what it cannot.
        let unsure = UNSURE * size * longest / across.norm();
        let normal = across.try_normalize(0.0)?;
        Some(Plane { normal, offset: normal.dot(&a) + (ON_THE_FACE + unsure) * size + UNSURE * far })
    };
    scaled.triangles().filter_map(plane).collect()
}

/// As an OBJ file, every digit.
pub(crate) fn obj(hull: &Hull) -> String {
    let mut text = String::from("# convex hull\n");
    for corner in &hull.corners {
        let _ = writeln!(text, "v {} {} {}", corner.x, corner.y, corner.z);
    }
    for [a, b, c] in &hull.faces {
        let _ = writeln!(text, "f {} {} {}", a + 1, b + 1, c + 1);
    }
    text
}

/// The hull of an OBJ file that [`obj`] wrote.
pub(crate) fn of_obj(text: &str) -> Option<Hull> {
    let mut hull = Hull { corners: Vec::new(), faces: Vec::new() };
    for line in text.lines() {
        let words: Vec<&str> = line.split_whitespace().collect();
        match words[..] {
            ["v", x, y, z] => hull.corners.push(Vector3::new(x.parse().ok()?, y.parse().ok()?, z.parse().ok()?)),
            ["f", a, b, c] => {
                let index = |word: &str| word.parse::<usize>().ok()?.checked_sub(1);
                hull.faces.push([index(a)?, index(b)?, index(c)?]);
            }
            _ => {}
        }
    }
    (!hull.faces.is_empty()).then_some(hull)
}

fn scaled(hull: &Hull, factors: [f64; 3]) -> Hull {
    let scale = Vector3::from(factors);
    let corners = hull.corners.iter().map(|corner| corner.component_mul(&scale)).collect();
    let mut faces = hull.faces.clone();
    if factors.iter().product::<f64>() < 0.0 {
        for face in &mut faces {
            face.swap(1, 2);
        }
    }
    Hull { corners, faces }
}

/// Directions of the largest faces, each once.
fn normals(hull: &Hull) -> Vec<Vector3<f64>> {
    let mut found: Vec<(f64, Vector3<f64>)> = hull
        .triangles()
        .filter_map(|[a, b, c]| {
            let normal = (b - a).cross(&(c - a));
            Some((normal.norm(), normal.try_normalize(0.0)?))
        })
        .collect();
    found.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut normals: Vec<Vector3<f64>> = Vec::new();
    for (_, normal) in found {
        if normals.len() == FACES_TRIED {
            break;
        }
        if normals.iter().all(|known| known.cross(&normal).norm() > ONE_DIRECTION) {
            normals.push(normal);
        }
    }
    normals
}

/// The volume that a closed surface bounds, m³; `None` where it is open.
pub(crate) fn volume(triangles: &[Triangle]) -> Option<f64> {
    let bits = |corner: &Vector3<f64>| [corner.x, corner.y, corner.z].map(|x| (x + 0.0).to_bits());
    let mut edges: BTreeMap<([u64; 3], [u64; 3]), i32> = BTreeMap::new();
    for corners in triangles {
        for index in 0..3 {
            let (from, to) = (bits(&corners[index]), bits(&corners[(index + 1) % 3]));
            if from == to {
                continue;
            }
            let (edge, way) = if from < to { ((from, to), 1) } else { ((to, from), -1) };
            *edges.entry(edge).or_default() += way;
        }
    }
    let volume = signed_volume(triangles.iter().copied()).abs();
    (volume > 0.0 && edges.values().all(|count| *count == 0)).then_some(volume)
}

/// A simple solid, and where it is in the frame of its points.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Placed {
    pub pose: Pose,
    pub geometry: Geometry,
}

impl Placed {
    pub fn volume(&self) -> f64 {
        match self.geometry {
            Geometry::Box([x, y, z]) => x * y * z,
            Geometry::Cylinder { radius, length } => std::f64::consts::PI * radius * radius * length,
            Geometry::Sphere(radius) => 4.0 / 3.0 * std::f64::consts::PI * radius.powi(3),
            _ => f64::INFINITY,
        }
    }
}

/// Whether a solid in its own frame contains a point. `hull`: of a mesh file, with its scale.
pub(crate) fn holds(geometry: &Geometry, hull: &[Plane], point: &Vector3<f64>) -> bool {
    match geometry {
        Geometry::Box(size) => (0..3).all(|index| 2.0 * point[index].abs() <= size[index]),
        Geometry::Cylinder { radius, length } => point.xy().norm() <= *radius && 2.0 * point.z.abs() <= *length,
        Geometry::Sphere(radius) => point.norm() <= *radius,
        Geometry::Mesh { .. } => !hull.is_empty() && hull.iter().all(|face| face.normal.dot(point) <= face.offset),
        _ => false,
    }
}

/// The points that a solid must contain, and its possible directions.
pub(crate) struct Cloud {
    points: Vec<Vector3<f64>>,
    size: f64,
    normals: Vec<Vector3<f64>>,
    principal: Matrix3<f64>,
}

impl Cloud {
    /// `hull`: of the points, where they have one.
    pub fn of(points: &[Vector3<f64>], hull: Option<&Hull>) -> Self {
        let all = hull.map_or(points, |hull| &hull.corners);
        let points = in_no_order(all);
        let middle = points.iter().sum::<Vector3<f64>>() / points.len().max(1) as f64;
        let size = points.iter().map(|point| (point - middle).norm()).fold(f64::MIN_POSITIVE, f64::max);
        let spread = points.iter().map(|point| (point - middle) * (point - middle).transpose()).sum::<Matrix3<f64>>();
        let principal = SymmetricEigen::new(spread / (size * size)).eigenvectors;
        Self { points, size, normals: hull.map_or_else(Vec::new, normals), principal }
    }

    fn step(&self) -> f64 {
        10f64.powf((self.size * OUTWARDS).log10().ceil())
    }

    /// Rounded up, with room for the rounding of a pose.
    fn up(&self, length: f64) -> f64 {
        let steps = (length / self.step() + 1e-3).ceil();
        crate::literal::short(steps * self.step())
    }

    /// A centre in few digits.
    fn rounded(&self, centre: Vector3<f64>) -> Vector3<f64> {
        centre.map(|x| crate::literal::short((x / self.step()).round() * self.step()) + 0.0)
    }

    fn directions(&self) -> Vec<Vector3<f64>> {
        let own = [Vector3::z(), Vector3::x(), Vector3::y()].into_iter();
        own.chain((0..3).map(|index| self.principal.column(index).into_owned())).chain(self.normals.clone()).collect()
    }

    /// The smallest of several: the first is along the mesh's own axes, as are those of `plain`.
    fn best(candidates: &[Placed], plain: usize) -> Placed {
        let smallest = |part: &[Placed]| {
            let least = part.iter().min_by(|a, b| a.volume().total_cmp(&b.volume()));
            least.expect("the mesh's own axes are always tried").clone()
        };
        let (own, all) = (smallest(&candidates[..plain]), smallest(candidates));
        if all.volume() < WORTH_TURNING * own.volume() { all } else { own }
    }

    fn box_along(&self, rotation: Rotation3<f64>) -> Placed {
        let back = rotation.inverse();
        let mut ends = (Vector3::repeat(f64::INFINITY), Vector3::repeat(f64::NEG_INFINITY));
        for point in &self.points {
            let at = back * point;
            ends = (ends.0.inf(&at), ends.1.sup(&at));
        }
        let centre = self.rounded(rotation * ((ends.0 + ends.1) / 2.0));
        let mut half = Vector3::zeros();
        for point in &self.points {
            half = half.sup(&(back * (point - centre)).abs());
        }
        let size = half.map(|half| self.up(2.0 * half));
        Placed { pose: se3::pose(rotation, centre), geometry: Geometry::Box(size.into()) }
    }

    /// The smallest box of those along the mesh's axes, its principal axes, or with a side on a face of the hull.
    pub fn boxed(&self) -> Placed {
        let mut candidates = vec![self.box_along(Rotation3::identity())];
        candidates.push(self.box_along(proper(self.principal)));
        let candidate = |normal: &Vector3<f64>| {
            let (rotation, _) = self.rectangle(normal);
            self.box_along(rotation)
        };
        candidates.extend(self.normals.iter().map(candidate));
        Self::best(&candidates, 1)
    }

    /// A frame with z along `normal` and x along a side of the smallest rectangle around the points, seen from there; its area.
    fn rectangle(&self, normal: &Vector3<f64>) -> (Rotation3<f64>, f64) {
        let frame = along(normal);
        let flat: Vec<[f64; 2]> =
            self.points.iter().map(|point| frame.inverse() * point).map(|at| [at.x, at.y]).collect();
        let outline = outline(flat);
        let mut best = (f64::INFINITY, 0.0f64);
        for (index, from) in outline.iter().enumerate() {
            let to = outline[(index + 1) % outline.len()];
            let angle = (to[1] - from[1]).atan2(to[0] - from[0]);
            let (sine, cosine) = angle.sin_cos();
            let mut ends = [f64::INFINITY, f64::NEG_INFINITY, f64::INFINITY, f64::NEG_INFINITY];
            for [x, y] in &outline {
                let (u, v) = (cosine * x + sine * y, cosine * y - sine * x);
                ends = [ends[0].min(u), ends[1].max(u), ends[2].min(v), ends[3].max(v)];
            }
            let area = (ends[1] - ends[0]) * (ends[3] - ends[2]);
            if area < best.0 {
                best = (area, angle);
            }
        }
        (frame * se3::rotation_about(&Vector3::z(), best.1), best.0)
    }

    fn cylinder_along(&self, direction: &Vector3<f64>) -> Placed {
        let rotation = along(direction);
        let back = rotation.inverse();
        let turned: Vec<Vector3<f64>> = self.points.iter().map(|point| back * point).collect();
        let flat: Vec<Vector3<f64>> = turned.iter().map(|at| Vector3::new(at.x, at.y, 0.0)).collect();
        let centre = smallest_ball(&flat, 3).centre;
        let ends =
            turned.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |ends, at| (ends.0.min(at.z), ends.1.max(at.z)));
        let centre = self.rounded(rotation * Vector3::new(centre.x, centre.y, f64::midpoint(ends.0, ends.1)));
        let (mut radius, mut half) = (0.0f64, 0.0f64);
        for point in &self.points {
            let at = back * (point - centre);
            (radius, half) = (radius.max(at.xy().norm()), half.max(at.z.abs()));
        }
        let geometry = Geometry::Cylinder { radius: self.up(radius), length: self.up(2.0 * half) };
        Placed { pose: se3::pose(rotation, centre), geometry }
    }

    /// The smallest cylinder of those along these directions.
    pub fn cylinder(&self) -> Placed {
        let candidates: Vec<_> = self.directions().iter().map(|direction| self.cylinder_along(direction)).collect();
        Self::best(&candidates, 3)
    }

    /// The smallest sphere.
    pub fn sphere(&self) -> Placed {
        let centre = self.rounded(smallest_ball(&self.points, 4).centre);
        let radius = self.points.iter().map(|point| (point - centre).norm()).fold(0.0, f64::max);
        Placed { pose: se3::pose(Rotation3::identity(), centre), geometry: Geometry::Sphere(self.up(radius)) }
    }
}

/// A frame whose z axis is this direction; the mesh's own where it is z.
fn along(direction: &Vector3<f64>) -> Rotation3<f64> {
    Rotation3::rotation_between(&Vector3::z(), direction)
        .unwrap_or_else(|| Rotation3::from_axis_angle(&Unit::new_unchecked(Vector3::x()), std::f64::consts::PI))
}

fn proper(mut columns: Matrix3<f64>) -> Rotation3<f64> {
    if columns.determinant() < 0.0 {
        columns.column_mut(0).neg_mut();
    }
    se3::orthonormalised(&Rotation3::from_matrix_unchecked(columns))
}

/// Corners of the convex outline of points in a plane, counter-clockwise (Andrew's monotone chain).
fn outline(mut points: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    points.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    points.dedup();
    if points.len() < 3 {
        return points;
    }
    let turns_left =
        |a: [f64; 2], b: [f64; 2], c: [f64; 2]| (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]) > 0.0;
    let half = |points: &mut dyn Iterator<Item = [f64; 2]>| {
        let mut half: Vec<[f64; 2]> = Vec::new();
        for point in points {
            while half.len() >= 2 && !turns_left(half[half.len() - 2], half[half.len() - 1], point) {
                half.pop();
            }
            half.push(point);
        }
        half.pop();
        half
    };
    let mut outline = half(&mut points.iter().copied());
    outline.extend(half(&mut points.iter().rev().copied()));
    outline
}

#[derive(Clone, Copy)]
struct Ball {
    centre: Vector3<f64>,
    /// Below 0 for the empty one.
    squared: f64,
}

impl Ball {
    fn holds(&self, point: &Vector3<f64>) -> bool {
        (point - self.centre).norm_squared() <= self.squared * (1.0 + 1e-12)
    }

    /// The smallest that these points are all on; `None` where there is none.
    fn through(points: &[Vector3<f64>]) -> Option<Self> {
        let Some((first, rest)) = points.split_first() else {
            return Some(Self { centre: Vector3::zeros(), squared: -1.0 });
        };
        let mut products = Matrix3::identity();
        let mut squares = Vector3::zeros();
        for (i, one) in rest.iter().enumerate() {
            for (j, other) in rest.iter().enumerate() {
                products[(i, j)] = 2.0 * (one - first).dot(&(other - first));
            }
            squares[i] = (one - first).norm_squared();
        }
        let parts = products.lu().solve(&squares)?;
        let step: Vector3<f64> = rest.iter().enumerate().map(|(index, point)| (point - first) * parts[index]).sum();
        step.iter().all(|x| x.is_finite()).then(|| Self { centre: first + step, squared: step.norm_squared() })
    }
}

/// The smallest ball around points (Welzl 1991), of which at most `most` determine it: 4 in space, 3 in a plane.
fn smallest_ball(points: &[Vector3<f64>], most: usize) -> Ball {
    fn ball(points: &[Vector3<f64>], on: &mut Vec<Vector3<f64>>, most: usize) -> Option<Ball> {
        let mut found = Ball::through(on)?;
        if on.len() == most {
            return Some(found);
        }
        for (index, point) in points.iter().enumerate() {
            if !found.holds(point) {
                on.push(*point);
                // Points that rounding makes dependent give none: the ball before is as good to rounding.
                found = ball(&points[..index], on, most).unwrap_or(found);
                on.pop();
            }
        }
        Some(found)
    }
    ball(points, &mut Vec::new(), most).unwrap_or(Ball { centre: Vector3::zeros(), squared: -1.0 })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn cuboid(half: [f64; 3], pose: &Pose) -> Vec<Vector3<f64>> {
        let mut corners = Vec::new();
        for x in [-1.0, 1.0] {
            for y in [-1.0, 1.0] {
                for z in [-1.0, 1.0] {
                    let corner = denavit_model::nalgebra::Point3::new(x * half[0], y * half[1], z * half[2]);
                    corners.push((pose * corner).coords);
                }
            }
        }
        corners
    }

    #[test]
    fn a_turned_cuboid_is_its_own_box() {
        let pose = se3::pose(se3::rotation_from_rpy([0.3, -0.5, 0.9]), Vector3::new(0.1, 0.2, -0.3));
        let points = cuboid([0.05, 0.1, 0.2], &pose);
        let hull = Hull::of(&points).unwrap();
        assert!((hull.volume() - 0.008).abs() < 1e-12);
        assert_eq!(hull.corners.len(), 8);
        let found = Cloud::of(&points, Some(&hull)).boxed();
        assert!((found.volume() - 0.008).abs() < 1e-6, "{found:?}");
        let own = Cloud::of(&cuboid([0.05, 0.1, 0.2], &Pose::identity()), None).boxed();
        assert_eq!(own.pose, Pose::identity());
    }

    #[test]
    fn the_smallest_ball_is_known() {
        // On a regular tetrahedron with inner points.
        let corners = [[1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]].map(Vector3::from);
        let points: Vec<Vector3<f64>> = corners.iter().flat_map(|corner| [*corner, corner / 2.0]).collect();
        let ball = smallest_ball(&points, 4);
        assert!(ball.centre.norm() < 1e-12 && (ball.squared - 3.0).abs() < 1e-12);
        assert!(Hull::of(&points[..3]).is_none());
    }

    #[test]
    fn open_surfaces_have_no_volume() {
        let hull = Hull::of(&cuboid([0.5; 3], &Pose::identity())).unwrap();
        let mut triangles: Vec<Triangle> = hull.triangles().collect();
        assert!((volume(&triangles).unwrap() - 1.0).abs() < 1e-12);
        triangles.pop();
        assert_eq!(volume(&triangles), None);
        assert_eq!(of_obj(&obj(&hull)).unwrap(), hull);
    }

    /// Two rings whose corners are in a plane but for rounding, as meshes of turned parts have them.
    #[test]
    fn a_face_as_thin_as_rounding_shuts_no_corner_out() {
        let ring = |x: f64| {
            (0..60u32).map(move |k| {
                let (sine, cosine) = (f64::from(k) * std::f64::consts::TAU / 60.0).sin_cos();
                Vector3::new(x + f64::from(k * k % 7) * 1e-18, 0.018 * cosine, 0.018 * sine)
            })
        };
        let points: Vec<Vector3<f64>> = ring(0.0).chain(ring(0.016)).collect();
        let hull = Hull::of(&in_no_order(&points)).unwrap();
        let mesh = Geometry::Mesh { filename: String::new(), scale: [1.0; 3] };
        let planes = planes(&hull, [1.0; 3], 0.0);
        assert!(points.iter().all(|point| holds(&mesh, &planes, point)));
        for off in [Vector3::new(-1e-9, 0.0, 0.0), Vector3::new(0.017, 0.0, 0.0), Vector3::new(0.008, 0.0181, 0.0)] {
            assert!(!holds(&mesh, &planes, &off), "{off}");
        }
    }

    proptest! {
        #[test]
        fn every_solid_holds_every_point(numbers in prop::collection::vec(prop::array::uniform3(-1.0..1.0f64), 4..40),
            size in -3.0..2.0f64) {
            let points: Vec<Vector3<f64>> = numbers.iter().map(|of| Vector3::from(*of) * 10f64.powf(size)).collect();
            let hull = Hull::of(&points).unwrap();
            let cloud = Cloud::of(&points, Some(&hull));
            for solid in [cloud.boxed(), cloud.cylinder(), cloud.sphere()] {
                prop_assert!(solid.volume() >= hull.volume());
                for point in &points {
                    let at = solid.pose.inverse() * denavit_model::nalgebra::Point3::from(*point);
                    prop_assert!(holds(&solid.geometry, &[], &at.coords), "{solid:?} {point}");
                }
            }
            let mesh = Geometry::Mesh { filename: String::new(), scale: [1.0, -2.0, 1.0] };
            let planes = planes(&hull, [1.0, -2.0, 1.0], 0.0);
            for point in &points {
                prop_assert!(holds(&mesh, &planes, &point.component_mul(&Vector3::new(1.0, -2.0, 1.0))));
            }
        }
    }
}
