//! Arms with effects whose poses are known without them: an error of a joint's value is another joint value, gravity's torque the slope of
//! potential energy.

use denavit_code::effects::{
    Action, Argument, Averaged, Bump, Case, Curve, Driver, Effects, Input, Masses, Model, Move, Spread, Term, postures,
};
use denavit_model::chain::{Limits, Quantity};
use denavit_model::nalgebra::{DMatrix, Point3, Unit, Vector3, Vector6};
use denavit_model::{Chain, ChainJoint, Coordinate, Pose, Screw, examples};

/// m/s².
const GRAVITY: f64 = 9.81;

fn bare(chain: &Chain) -> Model {
    Model {
        joints: chain.joints().to_vec(),
        home: *chain.home(),
        read: chain.joints().to_vec(),
        terms: Vec::new(),
        curves: Vec::new(),
        masses: Masses {
            points: Vec::new(),
            gravity: Vector3::new(0.0, 0.0, -GRAVITY),
            payload: (0.0, chain.home().translation.vector),
            starts: chain
                .joints()
                .iter()
                .map(|joint| joint.screw.line().map_or_else(Vector3::zeros, |l| l.point.coords))
                .collect(),
        },
    }
}

/// An effect on the value of a joint.
fn on_joint(chain: &Chain, joint: usize, driver: Driver, coefficients: &[f64]) -> Term {
    let twist = chain.joints()[joint].screw.twist();
    let moved = |k: usize| Move { coefficient: k, value: k, action: Action::Twist { slot: joint, twist } };
    Term { driver, coefficients: coefficients.to_vec(), moves: (0..coefficients.len()).map(moved).collect() }
}

fn cases(chain: &Chain, given: &[f64], pose: impl Fn(&[f64]) -> Pose) -> Vec<Case> {
    let case = |q: Vec<f64>| Case { pose: pose(&q), q, given: given.to_vec() };
    postures(chain, None).into_iter().map(case).collect()
}

/// Errors of joint values that follow the values, and on what the code is told.
fn of_values() -> Effects {
    let chain = examples::puma_like();
    let mut model = bare(&chain);
    let bump = |shape| Driver::Bump { joint: 2, at: 0.2, width: 0.9, shape };
    model.terms = vec![
        on_joint(&chain, 0, Driver::Reading(0), &[2e-3]),
        on_joint(&chain, 1, Driver::Harmonic { joint: 0, order: 2.5 }, &[1e-3, -2e-3]),
        on_joint(&chain, 2, bump(Bump::Tent), &[3e-3]),
        on_joint(&chain, 2, bump(Bump::Wave), &[1e-3]),
        on_joint(&chain, 3, bump(Bump::Bell), &[1e-3]),
        on_joint(&chain, 4, Driver::Told(vec![(2.0, Input::Argument(0))]), &[1e-3]),
        on_joint(&chain, 4, Driver::Steps(Input::Argument(0), vec![-1.0, 1.0]), &[1e-3, 1.0]),
        on_joint(&chain, 5, Driver::Decay { of: Input::Argument(1), from: 1.0, constant: 2.0 }, &[1e-2]),
        on_joint(&chain, 5, Driver::Smooth(Input::Argument(1), vec![0.0, 2.0, 6.0]), &[1e-2, 3e-2]),
        on_joint(&chain, 5, Driver::Constant(vec![1.0]), &[-1e-3]),
    ];
    model.curves = vec![
        Curve { joint: 3, interval: Some((-2.0, 3.0)), weights: vec![1e-3, 0.0, -5e-4] },
        Curve { joint: 5, interval: None, weights: vec![1e-3, 2e-3, -1e-3] },
    ];
    let given = [0.5, 4.0];
    let pose = |q: &[f64]| {
        let mut actual = q.to_vec();
        let u = (q[2] - 0.2) / 0.9;
        actual[0] += 2e-3 * q[0];
        actual[1] += 1e-3 * (2.5 * q[0]).sin() - 2e-3 * (2.5 * q[0]).cos();
        actual[2] += 3e-3 * (1.0 - 0.5 * u.abs()).max(0.0);
        actual[2] += if u.abs() > 2.5 { 0.0 } else { 1e-3 * (0.5 + 0.5 * (std::f64::consts::PI * u / 2.5).cos()) };
        actual[3] += 1e-3 * (-0.5 * u * u).exp();
        if (-2.0..=1.0).contains(&q[3]) {
            let angle = std::f64::consts::PI * (q[3] + 2.0) / 3.0;
            actual[3] += 1e-3 * angle.sin() - 5e-4 * (3.0 * angle).sin();
        }
        actual[4] += 1e-3 * (2.0 * 0.5) + 1e-3;
        actual[5] += 1e-2 * (1.0 - (-1.5f64).exp()) + 1e-2 * 0.5 + 3e-2 * 0.5 - 1e-3;
        actual[5] += 1e-3 * q[5].sin() + 2e-3 * q[5].cos() - 1e-3 * (2.0 * q[5]).sin();
        chain.fk(&actual)
    };
    let arguments = ["temperature", "time"].map(|name| Argument { name: name.into(), unit: "1".into() }).to_vec();
    Effects { cases: cases(&chain, &given, pose), arguments, averaged: None, model, chain: chain.clone() }
}

/// Shoulder and elbow that give under gravity, the first of them as it stiffens.
fn of_gravity() -> Effects {
    let chain = examples::puma_like();
    let mut model = bare(&chain);
    let points = [
        (1, 12.0, [0.2, 0.1, 0.7]),
        (1, 3.0, [0.3, 0.2, 0.6]),
        (2, 6.0, [0.45, 0.2, 0.9]),
        (5, 1.5, [0.42, 0.15, 1.14]),
    ];
    model.masses.points = points.map(|(joint, mass, centre)| (joint, mass, Vector3::from(centre))).to_vec();
    model.masses.payload.0 = 2.0;
    model.terms = vec![
        on_joint(&chain, 1, Driver::HardeningTorque(1, 40.0), &[1e-6, 2e-6]),
        on_joint(&chain, 2, Driver::Torque(2), &[5e-6]),
        on_joint(&chain, 4, Driver::GravitySide(4), &[1e-4]),
    ];
    let masses = model.masses.clone();
    let energy = |q: &[f64]| {
        let mut reached = Pose::identity();
        let mut after = Vec::new();
        for joint in chain.joints() {
            reached *= joint.screw.motion(joint.value(q));
            after.push(reached);
        }
        let tip = Point3::from(masses.payload.1);
        let hung = masses.points.iter().map(|(joint, mass, centre)| mass * (after[*joint] * Point3::from(*centre)).z);
        GRAVITY * (hung.sum::<f64>() + masses.payload.0 * (reached * tip).z)
    };
    let torque = |q: &[f64], joint: usize| {
        let at = |by: f64| {
            let mut q = q.to_vec();
            q[joint] += by;
            energy(&q)
        };
        (at(-1e-4) - at(1e-4)) / 2e-4
    };
    let pose = |q: &[f64]| {
        let mut actual = q.to_vec();
        for _ in 0..20 {
            let [first, second, third] = [1, 2, 4].map(|joint| torque(&actual, joint));
            actual = q.to_vec();
            actual[1] += 1e-6 * first + 2e-6 * first / (1.0 + first.abs() / 40.0);
            actual[2] += 5e-6 * second;
            actual[4] += if third < 0.0 { -1e-4 } else { 1e-4 };
        }
        chain.fk(&actual)
    };
    Effects { cases: cases(&chain, &[], pose), arguments: Vec::new(), averaged: None, model, chain: chain.clone() }
}

/// An averaged prediction in one of three places: sure of itself, unsure, and far from what was measured.
fn of_averages(index: usize) -> Effects {
    let drawn = examples::puma_like();
    let mut offset = drawn.joints().to_vec();
    offset[1].offset = 0.01;
    let geometric = drawn.coordinates().to_vec();
    let geometric =
        Chain::new((drawn.name(), drawn.base(), drawn.tip()), geometric, offset, *drawn.home()).expect("finite");
    let mut model = bare(&drawn);
    model.terms = vec![on_joint(&drawn, 0, Driver::Constant(vec![1.0]), &[0.02])];
    let weights = vec![1e-3, 5e-4];
    model.curves = vec![Curve { joint: 2, interval: Some((-3.0, 6.0)), weights }];
    let variance = [1e-24, 1e3, 1e3][index];
    let spread = |kept: Vec<usize>| {
        let size = kept.len() + 3;
        Spread { covariance: DMatrix::identity(size, size) * variance, kept }
    };
    let averaged = Averaged {
        geometric: geometric.joints().to_vec(),
        home: *drawn.home(),
        placed: [Pose::identity(); 2],
        drawn: [Pose::identity(); 2],
        target: Vector3::new(0.0, 0.1, 0.2),
        instrument: None,
        spreads: [spread(vec![0, 1, 2]), spread(vec![0])],
        of_curves: 0.0,
        of_drawing: 1e-12,
        of_geometry: [1e-7, 0.0],
        across: 1.0,
        far_more: 4.0,
        ranges: if index == 2 { vec![(5.0, 6.0); 6] } else { vec![(-9.0, 9.0); 6] },
    };
    let pose = |q: &[f64]| match index {
        0 => {
            let mut actual = q.to_vec();
            let angle = std::f64::consts::PI * (q[2] + 3.0) / 6.0;
            actual[0] += 0.02;
            actual[2] += 1e-3 * angle.sin() + 5e-4 * (2.0 * angle).sin();
            drawn.fk(&actual)
        }
        1 => geometric.fk(q),
        // The place of the target is as unsure for the drawing as for geometry, which leaves it this share.
        _ => {
            let placed = 1e3;
            let (all, plain) = unsure(&drawn, q, variance);
            let share = 1e-7 / (1e-7 + all);
            let apart = 0.0;
            let whole = 1e-7 + plain;
            let blend = share * all + (1.0 - share) * whole + share * (1.0 - share) * apart;
            let of_drawing = 1e-12 + placed;
            let of_drawn = 1.0 / (1.0 + (16.0 * of_drawing / blend).powi(2));
            let from_geometric = geometric.fk(q).inverse() * drawn.fk(q);
            geometric.fk(q) * denavit_model::se3::exp(&(denavit_model::se3::log(&from_geometric) * of_drawn))
        }
    };
    let cases = cases(&drawn, &[], pose);
    Effects { chain: geometric.clone(), arguments: Vec::new(), model, averaged: Some(averaged), cases }
}

/// Variance of the target by joint 0, the curve of joint 2 and the target's place, and by joint 0 and the place alone.
fn unsure(chain: &Chain, q: &[f64], variance: f64) -> (f64, f64) {
    let mut actual = q.to_vec();
    let angle = std::f64::consts::PI * (q[2] + 3.0) / 6.0;
    actual[0] += 0.02;
    actual[2] += 1e-3 * angle.sin() + 5e-4 * (2.0 * angle).sin();
    let target = Point3::new(0.0, 0.1, 0.2);
    let by = |joint: usize| {
        let at = |step: f64| {
            let mut q = actual.clone();
            q[joint] += step;
            (chain.fk(&q) * target).coords
        };
        ((at(1e-5) - at(-1e-5)) / 2e-5).norm_squared()
    };
    let waves = angle.sin().powi(2) + (2.0 * angle).sin().powi(2);
    let plain = (by(0) + 3.0) / 3.0 * variance;
    (plain + by(2) * waves / 3.0 * variance, plain)
}

/// Twists across and along axes, on a chain with a slide and a ball screw.
fn of_four_joints() -> Effects {
    let chain = examples::scara_helical();
    let mut model = bare(&chain);
    let shift = Vector6::new(0.0, 0.0, 0.0, 1e-3, 0.0, 0.0);
    let moves = vec![Move { coefficient: 0, value: 0, action: Action::Twist { slot: 4, twist: shift } }];
    model.terms = vec![
        on_joint(&chain, 2, Driver::Reading(2), &[1e-3]),
        Term { driver: Driver::Reading(0), coefficients: vec![2.0], moves },
    ];
    let pose = |q: &[f64]| {
        let mut actual = q.to_vec();
        actual[2] += 1e-3 * q[2];
        let from_home = chain.fk(&actual) * chain.home().inverse();
        from_home * denavit_model::se3::exp(&(shift * 2.0 * q[0])) * chain.home()
    };
    Effects { cases: cases(&chain, &[], pose), arguments: Vec::new(), averaged: None, model, chain: chain.clone() }
}

/// Seven joints: an arm on a rail that is longer than it reads.
fn of_seven_joints() -> Effects {
    let arm = examples::puma_like();
    let mut coordinates = arm.coordinates().to_vec();
    let slide = Coordinate { limits: Limits::between(-0.4, 0.4), ..Coordinate::unlimited("rail", Quantity::Length) };
    coordinates.insert(0, slide);
    let screw = Screw::Prismatic(Unit::new_normalize(Vector3::new(0.0, 1.0, 0.0)));
    let mut joints = vec![ChainJoint { name: "rail".into(), screw, coordinate: 0, scale: 1.0, offset: 0.0 }];
    joints.extend(arm.joints().iter().map(|joint| ChainJoint { coordinate: joint.coordinate + 1, ..joint.clone() }));
    let chain = Chain::new(("on_a_rail", "base", "tip"), coordinates, joints, *arm.home()).expect("finite");
    let mut model = bare(&chain);
    model.terms =
        vec![on_joint(&chain, 0, Driver::Reading(0), &[2e-3]), on_joint(&chain, 3, Driver::Reading(2), &[1e-3])];
    let pose = |q: &[f64]| {
        let mut actual = q.to_vec();
        actual[0] += 2e-3 * q[0];
        actual[3] += 1e-3 * q[2];
        chain.fk(&actual)
    };
    Effects { cases: cases(&chain, &[], pose), arguments: Vec::new(), averaged: None, model, chain: chain.clone() }
}

/// All of them.
pub fn all() -> Vec<Effects> {
    vec![of_values(), of_gravity(), of_averages(0), of_averages(1), of_averages(2), of_four_joints(), of_seven_joints()]
}
