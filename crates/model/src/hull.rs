//! The convex hull of points: point by point, with the exact predicates of the crate `robust`.

use nalgebra::Vector3;
use std::collections::{BTreeMap, BTreeSet};

/// Corners, m.
pub type Triangle = [Vector3<f64>; 3];

/// A convex polyhedron.
#[derive(Debug, Clone, PartialEq)]
pub struct Hull {
    /// m.
    pub corners: Vec<Vector3<f64>>,
    /// Indices of corners, counter-clockwise from outside.
    pub faces: Vec<[usize; 3]>,
}

impl Hull {
    /// The hull of points (m): each point is added, the faces that it sees are removed, and their outline is joined to it. This is
    /// slow for some orders of the points; [`in_no_order`] gives a fast order.
    /// `None` where the points lie in a plane.
    ///
    /// # Examples
    /// ```
    /// use denavit_model::{hull::Hull, nalgebra::Vector3};
    /// let corners = [Vector3::zeros(), Vector3::x(), Vector3::y(), Vector3::z(), Vector3::repeat(0.1)];
    /// let hull = Hull::of(&corners).unwrap();
    /// assert_eq!(hull.corners.len(), 4);
    /// assert!((hull.volume() - 1.0 / 6.0).abs() < 1e-15);
    /// ```
    pub fn of(points: &[Vector3<f64>]) -> Option<Self> {
        let start = tetrahedron(points)?;
        let [a, b, c, d] = start;
        let mut faces = vec![[a, b, c], [a, d, b], [b, d, c], [c, d, a]];
        for (index, point) in points.iter().enumerate().filter(|(index, _)| !start.contains(index)) {
            let sees = |face: &[usize; 3]| side(face.map(|corner| points[corner]), point) > 0.0;
            if !faces.iter().any(sees) {
                continue;
            }
            let (seen, kept): (Vec<[usize; 3]>, Vec<[usize; 3]>) = faces.iter().copied().partition(sees);
            faces = kept;
            let edges = |face: &[usize; 3]| [(face[0], face[1]), (face[1], face[2]), (face[2], face[0])];
            let inner: BTreeSet<(usize, usize)> = seen.iter().flat_map(edges).collect();
            let outline = seen.iter().flat_map(edges).filter(|(from, to)| !inner.contains(&(*to, *from)));
            faces.extend(outline.map(|(from, to)| [from, to, index]));
        }
        let used: BTreeSet<usize> = faces.iter().flatten().copied().collect();
        let number: BTreeMap<usize, usize> = used.iter().enumerate().map(|(new, old)| (*old, new)).collect();
        let corners = used.iter().map(|index| points[*index]).collect();
        Some(Self { corners, faces: faces.iter().map(|face| face.map(|corner| number[&corner])).collect() })
    }

    /// Its faces, counter-clockwise from outside, m.
    pub fn triangles(&self) -> impl Iterator<Item = Triangle> + '_ {
        self.faces.iter().map(|face| face.map(|corner| self.corners[corner]))
    }

    /// m³.
    pub fn volume(&self) -> f64 {
        signed_volume(self.triangles())
    }
}

/// Above 0 where the point sees the face from outside, counter-clockwise; exactly 0 in its plane (Shewchuk 1997).
fn side([a, b, c]: Triangle, point: &Vector3<f64>) -> f64 {
    let exact = |at: &Vector3<f64>| robust::Coord3D { x: at.x, y: at.y, z: at.z };
    // Its own sign is positive behind the face.
    -robust::orient3d(exact(&a), exact(&b), exact(&c), exact(point))
}

/// Four points that are not in a plane, the fourth behind the face of the other three; `None` where there are none.
fn tetrahedron(points: &[Vector3<f64>]) -> Option<[usize; 4]> {
    let farthest = |measure: &dyn Fn(&Vector3<f64>) -> f64| {
        let all = points.iter().map(measure).enumerate();
        all.max_by(|a, b| a.1.total_cmp(&b.1)).filter(|(_, most)| *most > 0.0).map(|(index, _)| index)
    };
    let a = farthest(&|_| 1.0)?;
    let b = farthest(&|point| (point - points[a]).norm_squared())?;
    let c = farthest(&|point| (points[b] - points[a]).cross(&(point - points[a])).norm_squared())?;
    let d = farthest(&|point| side([points[a], points[b], points[c]], point).abs())?;
    let behind = side([points[a], points[b], points[c]], &points[d]) < 0.0;
    Some(if behind { [a, b, c, d] } else { [a, c, b, d] })
}

/// The volume that a closed surface bounds, m³, above 0 where its triangles are counter-clockwise from outside.
pub fn signed_volume(triangles: impl IntoIterator<Item = Triangle>) -> f64 {
    triangles.into_iter().map(|[a, b, c]| a.dot(&b.cross(&c)) / 6.0).sum()
}

/// Each point once, in an order unrelated to their positions.
pub fn in_no_order(points: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
    let bits = |point: &Vector3<f64>| [point.x, point.y, point.z].map(|x| (x + 0.0).to_bits());
    let key = |bits: [u64; 3]| {
        bits.into_iter().fold(0u64, |sum, x| (sum.rotate_left(17) ^ x).wrapping_mul(0x9e37_79b9_7f4a_7c15))
    };
    let once: BTreeSet<[u64; 3]> = points.iter().map(bits).collect();
    let mut once: Vec<[u64; 3]> = once.into_iter().collect();
    once.sort_by_key(|bits| key(*bits));
    once.into_iter().map(|bits| Vector3::from(bits.map(f64::from_bits))).collect()
}
