//! A tool that two tips of a robot hold together: both tips must give the same tool pose.
//!
//! A [pose](super::pose) that every row measures from both tips in its own frame, the tool's, and whose measured value is always the
//! identity: r = X⁻¹ - T t, with X the tool's frame in that row and t the grip of the tip. The joint readings are the measurement.

use super::pose::Pose;
use super::{Discrepancy, Disturbance, Follows, Observe, Rows, Seen};
use crate::parameters::Layout;
use denavit_model::nalgebra::Matrix3;

#[derive(Debug)]
pub(super) struct Grip;

impl Observe for Grip {
    fn discrepancy(&self, seen: &Seen<'_>) -> Discrepancy {
        Pose.discrepancy(seen)
    }

    fn follows(&self, seen: &Seen<'_>) -> Follows {
        Pose.follows(seen)
    }

    fn own_columns(&self, seen: &Seen<'_>, layout: &Layout, left: &Matrix3<f64>, rows: &mut Rows<'_>) {
        Pose.own_columns(seen, layout, left, rows);
    }

    fn predict(&self, seen: &Seen<'_>, values: &mut Vec<f64>) {
        Pose.predict(seen, values);
    }

    fn disturb(&self, values: &mut [f64], errors: &mut Disturbance<'_>) {
        Pose.disturb(values, errors);
    }
}
