//! The Denavit-Hartenberg form as a set of parameters: how many are redundant, where, and where it fails.
//!
//! Base frame (6), a row of four per joint, tool frame (6): 4n + 12 numbers. In the proximal order
//! base · Π Rx(α(i-1)) Tx(a(i-1)) Rz(θi + qi) Tz(di) · tool each number turns about or slides along a line that the
//! robot has: α and a about and along the common normal of neighbouring axes, θ and d about and along an axis.

use crate::identifiability::RANK_TOLERANCE;
use denavit_model::nalgebra::{DMatrix, Point3, Vector3, Vector6};
use denavit_model::{Chain, Pose, Screw, se3};

/// Axes closer to parallel than this have an ill-conditioned common normal, rad.
const NEARLY_PARALLEL: f64 = 0.02;

/// What the D-H form of a chain can and cannot express.
#[derive(Debug, Clone, PartialEq)]
pub struct DhForm {
    /// Numbers in the form: 6 + 4n + 6.
    pub numbers: usize,
    /// Rank with full poses.
    pub rank: usize,
    /// Number of redundant parameters in the base frame and the first row.
    pub redundant_in_base: usize,
    /// Number of redundant parameters in the last θ, d and the tool frame.
    pub redundant_in_tool: usize,
    /// Neighbours with (nearly) parallel axes, by index of the first: no small change of the row tilts one against the
    /// other about the second direction across, and their d cannot be separated.
    pub parallel: Vec<usize>,
    /// Prismatic joints: their axis has no position, so two numbers of the neighbouring rows are redundant.
    pub prismatic: Vec<usize>,
}

struct Column {
    /// Twist at home, base frame.
    twist: Vector6<f64>,
    /// The joints whose motion carries it: all before this index.
    carried_by: usize,
}

fn about(point: &Point3<f64>, direction: &Vector3<f64>) -> Vector6<f64> {
    let v = point.coords.cross(direction);
    Vector6::new(direction.x, direction.y, direction.z, v.x, v.y, v.z)
}

fn along(direction: &Vector3<f64>) -> Vector6<f64> {
    Vector6::new(0.0, 0.0, 0.0, direction.x, direction.y, direction.z)
}

fn axis(screw: &Screw, near: &Point3<f64>) -> (Vector3<f64>, Point3<f64>) {
    let direction = screw.direction().into_inner();
    (direction, screw.line().map_or(*near, |line| line.nearest_to(near)))
}

/// Direction and a point of the common normal of two lines; for parallel ones the perpendicular through `near`.
fn common_normal(a: (Vector3<f64>, Point3<f64>), b: (Vector3<f64>, Point3<f64>)) -> (Vector3<f64>, Point3<f64>) {
    let cross = a.0.cross(&b.0);
    if cross.norm() > 1e-9 {
        let normal = cross.normalize();
        let offset = b.1 - a.1;
        let along_a = offset.cross(&b.0).dot(&cross) / cross.norm_squared();
        return (normal, a.1 + a.0 * along_a);
    }
    let offset = b.1 - a.1;
    let across = offset - a.0 * a.0.dot(&offset);
    let normal = across.try_normalize(1e-12).unwrap_or_else(|| {
        let other = if a.0.x.abs() < 0.9 { Vector3::x() } else { Vector3::y() };
        a.0.cross(&other).normalize()
    });
    (normal, a.1)
}

fn columns(chain: &Chain) -> Vec<Column> {
    let mut columns = Vec::new();
    let all = [Vector3::x(), Vector3::y(), Vector3::z()];
    for e in &all {
        columns.push(Column { twist: about(&Point3::origin(), e), carried_by: 0 });
        columns.push(Column { twist: along(e), carried_by: 0 });
    }
    // The base's z axis is used as the axis before the first.
    let mut last = (Vector3::z(), Point3::origin());
    for (index, joint) in chain.joints().iter().enumerate() {
        let this = axis(&joint.screw, &last.1);
        let (normal, foot) = common_normal(last, this);
        columns.push(Column { twist: about(&foot, &normal), carried_by: index });
        columns.push(Column { twist: along(&normal), carried_by: index });
        columns.push(Column { twist: about(&this.1, &this.0), carried_by: index });
        columns.push(Column { twist: along(&this.0), carried_by: index });
        last = this;
    }
    let tip = Point3::from(chain.home().translation.vector);
    for e in &all {
        columns.push(Column { twist: about(&tip, e), carried_by: chain.joints().len() });
        columns.push(Column { twist: along(e), carried_by: chain.joints().len() });
    }
    columns
}

/// Rank of the twists of the tip over all rows, columns scaled to length 1.
fn rank(matrix: &DMatrix<f64>) -> usize {
    if matrix.ncols() == 0 {
        return 0;
    }
    let mut scaled = matrix.clone();
    for mut column in scaled.column_iter_mut() {
        let norm = column.norm();
        if norm > 0.0 {
            column.scale_mut(norm.recip());
        }
    }
    let values = scaled.singular_values();
    values.iter().filter(|value| **value > RANK_TOLERANCE * values.max()).count()
}

/// Analyse the D-H form with full poses at these joint readings.
pub fn dh_form(chain: &Chain, readings: &[Vec<f64>]) -> DhForm {
    let columns = columns(chain);
    let n = chain.joints().len();
    let mut jacobian = DMatrix::zeros(6 * readings.len(), columns.len());
    let mut motions = vec![Pose::identity(); n];
    for (row, q) in readings.iter().enumerate() {
        chain.fk_into(q, &mut motions);
        for (k, column) in columns.iter().enumerate() {
            let twist = match column.carried_by {
                0 => column.twist,
                carried => se3::adjoint_times(&motions[carried - 1], &column.twist),
            };
            jacobian.view_mut((6 * row, k), (6, 1)).copy_from(&twist);
        }
    }
    let part = |range: std::ops::Range<usize>| {
        let block = jacobian.columns(range.start, range.len()).into_owned();
        range.len() - rank(&block)
    };
    let last = columns.len();
    let slides = |k: usize| matches!(chain.joints()[k].screw, Screw::Prismatic(_));
    let parallel = |k: usize| {
        let (a, b) = (chain.joints()[k].screw.direction(), chain.joints()[k + 1].screw.direction());
        a.cross(&b).norm() < NEARLY_PARALLEL && !slides(k) && !slides(k + 1)
    };
    DhForm {
        numbers: last,
        rank: rank(&jacobian),
        redundant_in_base: part(0..10),
        redundant_in_tool: part(last - 8..last),
        parallel: (0..n.saturating_sub(1)).filter(|&k| parallel(k)).collect(),
        prismatic: (0..n).filter(|&k| slides(k)).collect(),
    }
}
