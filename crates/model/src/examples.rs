//! A few example robots for the tests and doctests of all crates, with arbitrary round numbers.

use crate::chain::{Chain, ChainJoint, Coordinate, Limits, Quantity};
use crate::screw::{AxisLine, Pitch, Screw};
use crate::se3;
use nalgebra::{Point3, Unit, Vector3};

fn axis(direction: [f64; 3], point: [f64; 3]) -> AxisLine {
    AxisLine { direction: Unit::new_normalize(Vector3::from(direction)), point: Point3::from(point) }
}

fn revolute(direction: [f64; 3], point: [f64; 3]) -> Screw {
    Screw::Revolute(axis(direction, point))
}

fn prismatic(direction: [f64; 3]) -> Screw {
    Screw::Prismatic(Unit::new_normalize(Vector3::from(direction)))
}

fn chain(name: &str, screws: &[Screw], tip: [f64; 3], rpy: [f64; 3]) -> Chain {
    let coordinates = screws.iter().enumerate().map(|(k, screw)| {
        let slides = matches!(screw, Screw::Prismatic(_));
        let (quantity, bound) = if slides { (Quantity::Length, 0.5) } else { (Quantity::Angle, 2.9) };
        let limits = Limits { velocity: Some(1.0), effort: Some(10.0), ..Limits::between(-bound, bound) };
        Coordinate { limits, ..Coordinate::unlimited(format!("joint_{}", k + 1), quantity) }
    });
    let joints = screws.iter().enumerate().map(|(k, screw)| ChainJoint {
        name: format!("joint_{}", k + 1),
        screw: *screw,
        coordinate: k,
        scale: 1.0,
        offset: 0.0,
    });
    let home = se3::pose(se3::rotation_from_rpy(rpy), Vector3::from(tip));
    Chain::new((name, "base", "tip"), coordinates.collect(), joints.collect(), home)
        .expect("example figures are finite")
}

/// Two revolute joints about z, links of 1 m and 0.5 m along x.
pub fn planar_arm() -> Chain {
    chain(
        "planar_arm",
        &[revolute([0., 0., 1.], [0.; 3]), revolute([0., 0., 1.], [1., 0., 0.])],
        [1.5, 0., 0.],
        [0.; 3],
    )
}

/// Six revolute joints in the manner of a PUMA: parallel shoulder and elbow, intersecting wrist.
pub fn puma_like() -> Chain {
    let screws = [
        revolute([0., 0., 1.], [0.; 3]),
        revolute([0., -1., 0.], [0., 0.15, 0.67]),
        revolute([0., -1., 0.], [0.43, 0.15, 0.67]),
        revolute([0., 0., 1.], [0.41, 0.15, 0.9]),
        revolute([0., -1., 0.], [0.41, 0.15, 1.1]),
        revolute([0., 0., 1.], [0.41, 0.15, 1.1]),
    ];
    chain("puma_like", &screws, [0.41, 0.15, 1.16], [0.; 3])
}

/// A SCARA: two vertical axes, a slide, and a last joint whose ball screw couples turn and slide.
pub fn scara_helical() -> Chain {
    let pitch = Pitch::from_lead(0.02).expect("not zero");
    let screws = [
        revolute([0., 0., 1.], [0.; 3]),
        revolute([0., 0., 1.], [0.3, 0., 0.]),
        prismatic([0., 0., -1.]),
        Screw::Helical { axis: axis([0., 0., -1.], [0.55, 0., 0.]), pitch },
    ];
    chain("scara_helical", &screws, [0.55, 0., 0.2], [std::f64::consts::PI, 0., 0.])
}

/// A three-joint arm on a linear rail, axes oblique on purpose.
pub fn rail_arm() -> Chain {
    let screws = [
        prismatic([0., 1., 0.2]),
        revolute([0., 0.1, 1.], [0.1, 0., 0.5]),
        revolute([1., -1., 0.3], [0.3, 0.2, 0.6]),
        revolute([0.2, 1., -0.4], [0.5, -0.2, 0.9]),
    ];
    chain("rail_arm", &screws, [0.7, 0.1, 1.2], [0.3, -0.2, 0.7])
}

/// All of them.
pub fn all() -> Vec<Chain> {
    vec![planar_arm(), puma_like(), scara_helical(), rail_arm()]
}
