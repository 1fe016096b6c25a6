//! Points on the arm at home: where its links are taken to end.

use denavit_model::nalgebra::Point3;
use denavit_model::{Chain, PlacedRobot, Tips};
use std::collections::HashMap;

/// Points on the arm at home, m: `points[i]` on joint i where the URDF places it, the last at the tip.
///
/// Joints that the tree does not know by name use [`axis_points`].
pub fn link_points(placed: &PlacedRobot, chain: &Chain) -> Vec<Point3<f64>> {
    let robot = placed.robot();
    let mut points = axis_points(chain);
    let Some(base) = robot.link_index(chain.base()) else { return points };
    let base_from_root = placed.pose(base).inverse();
    let links: HashMap<&str, usize> = robot.joints.iter().map(|joint| (joint.name.as_str(), joint.child)).collect();
    for (point, joint) in points.iter_mut().zip(chain.joints()) {
        let Some(link) = links.get(joint.name.as_str()) else { continue };
        let placed = base_from_root * Point3::from(placed.pose(*link).translation.vector);
        // If the joint's line misses the point, the path does not run up the tree.
        let passes = joint.screw.line().is_none_or(|line| (line.nearest_to(&placed) - placed).norm() < 1e-6);
        if passes {
            *point = placed;
        }
    }
    points
}

/// The same without a tree: on each axis the point nearest to the one before; a slide has the point of the joint before it.
pub fn axis_points(chain: &Chain) -> Vec<Point3<f64>> {
    let tip = Point3::from(chain.home().translation.vector);
    let mut points = Vec::with_capacity(chain.joints().len() + 1);
    let mut last = Point3::origin();
    for joint in chain.joints() {
        if let Some(line) = joint.screw.line() {
            last = line.nearest_to(&last);
        }
        points.push(last);
    }
    points.push(tip);
    points
}

/// Points on the ways to all tips, one per joint and one for each tip: `of` gives those of the chain to one tip.
pub(super) fn points_of(chain: &Chain, tips: &Tips, of: impl Fn(&Chain) -> Vec<Point3<f64>>) -> Vec<Point3<f64>> {
    let joints = chain.joints().len();
    let mut points = vec![None; joints + tips.all().len()];
    for (index, tip) in tips.all().iter().enumerate() {
        let slots = tip.on_the_way().chain([joints + index]);
        for (slot, point) in slots.zip(of(&tip.chain(chain).expect("a part of a chain is a chain"))) {
            points[slot].get_or_insert(point);
        }
    }
    points.into_iter().map(|point| point.unwrap_or_else(Point3::origin)).collect()
}
