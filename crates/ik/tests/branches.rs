//! Every branch, on arms of each class, drawn and calibrated: the joint values that made a pose are among its solutions.

#![allow(clippy::unwrap_used, clippy::print_stdout)] // Tests: a panic is a failure, what is printed is read.

use denavit_ik::{Class, Method, Solutions, Solver};
use denavit_model::chain::{ChainJoint, Coordinate, Quantity};
use denavit_model::nalgebra::{Point3, Unit, Vector3};
use denavit_model::{AxisLine, Chain, Screw, examples, se3};
use std::f64::consts::{PI, TAU};

/// Numbers spread evenly over 0 to 1, the same in every run.
struct Spread(u64);

impl Spread {
    fn next(&mut self) -> f64 {
        // SplitMix64 (Steele, Lea, Flood 2014).
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    fn within(&mut self, bound: f64) -> f64 {
        bound * (2.0 * self.next() - 1.0)
    }

    fn vector(&mut self, bound: f64) -> Vector3<f64> {
        Vector3::new(self.within(bound), self.within(bound), self.within(bound))
    }
}

fn arm(axes: &[([f64; 3], [f64; 3])], tip: [f64; 3]) -> Chain {
    let screws = axes.iter().map(|(direction, point)| {
        let direction = Unit::new_normalize(Vector3::from(*direction));
        Screw::Revolute(AxisLine { direction, point: Point3::from(*point) })
    });
    with_screws(screws.collect(), Vector3::from(tip))
}

fn with_screws(screws: Vec<Screw>, tip: Vector3<f64>) -> Chain {
    let names: Vec<String> = (1..=screws.len()).map(|k| format!("joint_{k}")).collect();
    let coordinates = names.iter().map(|name| Coordinate::unlimited(name.clone(), Quantity::Angle)).collect();
    let joints = screws.into_iter().zip(&names).enumerate().map(|(k, (screw, name))| {
        let (coordinate, scale, offset) = (k, 1.0, 0.0);
        ChainJoint { name: name.clone(), screw, coordinate, scale, offset }
    });
    let home = se3::pose(se3::rotation_from_rpy([0.3, -0.2, 1.0]), tip);
    Chain::new(("arm", "base", "tip"), coordinates, joints.collect(), home).unwrap()
}

/// UR5e's axes (maker's D-H figures), at its zero.
fn ur5e() -> Chain {
    let (d1, a2, a3, d4, d5) = (0.1625, -0.425, -0.3922, 0.1333, 0.0997);
    arm(
        &[
            ([0., 0., 1.], [0.; 3]),
            ([0., -1., 0.], [0., 0., d1]),
            ([0., -1., 0.], [a2, 0., d1]),
            ([0., -1., 0.], [a2 + a3, 0., d1]),
            ([0., 0., -1.], [a2 + a3, -d4, d1]),
            ([0., -1., 0.], [a2 + a3, -d4, d1 - d5]),
        ],
        [-0.8172, -0.2329, 0.0628],
    )
}

/// An arm of KUKA's and ABB's kind: shoulder offset, forearm offset, spherical wrist.
fn opw() -> Chain {
    arm(
        &[
            ([0., 0., 1.], [0.; 3]),
            ([0., 1., 0.], [0.15, 0., 0.5]),
            ([0., 1., 0.], [0.15, 0., 1.2]),
            ([1., 0., 0.], [0.3, 0., 1.3]),
            ([0., 1., 0.], [0.9, 0., 1.3]),
            ([1., 0., 0.], [0.9, 0., 1.3]),
        ],
        [1.0, 0., 1.3],
    )
}

/// A spherical wrist behind three axes without any symmetry.
fn oblique_shoulder() -> Chain {
    arm(
        &[
            ([0.1, 0.2, 1.], [0.; 3]),
            ([0.3, 1., 0.1], [0.1, 0.1, 0.4]),
            ([1., 0.4, 0.3], [0.5, 0.1, 0.5]),
            ([0.2, 0., 1.], [0.8, 0.3, 0.6]),
            ([0., 1., 0.], [0.8, 0.3, 0.6]),
            ([1., 0., 0.3], [0.8, 0.3, 0.6]),
        ],
        [0.9, 0.3, 0.7],
    )
}

fn moved(chain: &Chain, spread: &mut Spread, turn: f64, shift: f64) -> Chain {
    let screws = chain.joints().iter().map(|joint| {
        let line = joint.screw.line().unwrap();
        let direction = Unit::new_normalize(*line.direction + spread.vector(turn));
        Screw::Revolute(AxisLine { direction, point: line.point + spread.vector(shift) })
    });
    chain.with_geometry(&screws.collect::<Vec<_>>(), *chain.home()).unwrap()
}

fn random(spread: &mut Spread) -> Chain {
    let screws = (0..6).map(|_| {
        let direction = Unit::new_normalize(spread.vector(1.0));
        Screw::Revolute(AxisLine { direction, point: Point3::from(spread.vector(0.5)) })
    });
    let screws = screws.collect();
    let tip = spread.vector(0.5);
    with_screws(screws, tip)
}

fn reversed(chain: &Chain) -> Chain {
    let tip_from_base = chain.home().inverse();
    let screws: Vec<_> = chain.joints().iter().rev().map(|joint| joint.screw.moved(&tip_from_base)).collect();
    with_screws(screws.clone(), Vector3::zeros()).with_geometry(&screws, tip_from_base).unwrap()
}

/// Smallest singular value over largest: how near the arm is to a singularity, where branches meet.
fn regular(chain: &Chain, q: &[f64]) -> bool {
    let mut columns = vec![denavit_model::nalgebra::Vector6::zeros(); q.len()];
    chain.tip_jacobian_into(q, &mut columns);
    let jacobian = denavit_model::nalgebra::Matrix6::from_columns(&columns);
    let values = jacobian.singular_values();
    values[5] > 1e-3 * values[0]
}

/// How many of the poses lost the joint values that made them; the numbers of solutions, summed; the worst error.
fn missed(chain: &Chain, poses: u64, seed: u64) -> (u64, usize, f64) {
    let solver = Solver::new(chain);
    let mut spread = Spread(seed);
    let mut solutions = Solutions::default();
    let (mut missed, mut count, mut worst) = (0, 0, 0.0f64);
    let n = chain.coordinates().len();
    let mut tried = 0;
    while tried < poses {
        let q: Vec<f64> = (0..n).map(|_| spread.within(PI)).collect();
        if !regular(chain, &q) {
            continue;
        }
        tried += 1;
        solver.solve_into(&chain.fk(&q), &vec![0.0; n], &mut solutions);
        let there =
            |joints: &[f64]| joints.iter().zip(&q).all(|(a, b)| (a - b - ((a - b) / TAU).round() * TAU).abs() < 1e-5);
        let lost = !solutions.iter().any(|(joints, _)| there(joints));
        missed += u64::from(lost);
        count += solutions.len();
        if !solutions.reached() {
            missed += 1;
            continue;
        }
        for (joints, found) in solutions.iter() {
            let (turned, moved) = se3::difference(&chain.fk(joints), &chain.fk(&q));
            assert!(found.position_error <= 2e-9 * chain.size());
            worst = worst.max(turned).max(moved / chain.size());
        }
    }
    (missed, count, worst)
}

fn class(chain: &Chain) -> Class {
    match Solver::new(chain).method() {
        Method::ClosedForm { class, .. } => *class,
        other => panic!("{other}"),
    }
}

#[test]
fn drawn_arms_lose_no_branch() {
    for (chain, expected) in [
        (examples::puma_like(), Class::SphericalWrist),
        (opw(), Class::SphericalWrist),
        (oblique_shoulder(), Class::SphericalWrist),
        (ur5e(), Class::ParallelShoulder),
        (reversed(&opw()), Class::SphericalShoulder),
        (reversed(&ur5e()), Class::ParallelWrist),
    ] {
        assert_eq!(class(&chain), expected);
        let (missed, count, worst) = missed(&chain, 2000, 1);
        println!(
            "{expected}: {missed} of 2000 lost, {:.2} solutions each, worst error {worst:.1e}",
            count as f64 / 2000.0
        );
        assert!(missed == 0 && worst < 1e-12, "{expected}: {missed} lost, {worst:e}");
    }
}

#[test]
fn calibrated_arms_keep_the_branches_of_their_drawing() {
    let mut spread = Spread(5);
    for drawn in [examples::puma_like(), opw(), ur5e(), oblique_shoulder(), reversed(&opw()), reversed(&ur5e())] {
        let chain = moved(&drawn, &mut spread, 2e-3, 1e-3);
        let (missed, count, worst) = missed(&chain, 300, 2);
        println!(
            "{}: {missed} of 300 lost, {:.2} solutions each, worst error {worst:.1e}",
            class(&chain),
            count as f64 / 300.0
        );
        assert!(missed == 0 && worst < 1e-12, "{missed} lost, {worst:e}");
    }
}

#[test]
fn arms_without_symmetry_lose_at_most_one_branch_in_a_thousand() {
    let mut spread = Spread(9);
    let (mut lost, mut all, mut poses) = (0, 0, 0);
    for arm in 0..10 {
        let chain = random(&mut spread);
        assert_eq!(class(&chain), Class::General);
        let (missed, count, worst) = missed(&chain, 40, 100 + arm);
        assert!(worst < 1e-9, "{worst:e}");
        (lost, all, poses) = (lost + missed, all + count, poses + 40);
    }
    println!("{lost} of {poses} lost, {:.2} solutions each", all as f64 / f64::from(poses));
    assert!(lost * 1000 <= u64::try_from(all).unwrap(), "{lost} lost of {poses}");
}

/// FANUC's CRX-10iA/L, at its zero.
fn crx10ial() -> Chain {
    arm(
        &[
            ([0., 0., 1.], [0.; 3]),
            ([0., 1., 0.], [0., 0., 0.245]),
            ([0., -1., 0.], [0., 0., 0.955]),
            ([-1., 0., 0.], [0., 0., 0.955]),
            ([0., -1., 0.], [0.54, 0., 0.955]),
            ([-1., 0., 0.], [0.54, -0.15, 0.955]),
        ],
        [0.7, -0.15, 0.955],
    )
}

/// Yaskawa's HC10, at its zero.
fn hc10() -> Chain {
    arm(
        &[
            ([0., 0., 1.], [0.; 3]),
            ([0., 1., 0.], [0., 0., 0.275]),
            ([0., -1., 0.], [0., 0., 0.975]),
            ([0., 0., 1.], [0., 0., 0.975]),
            ([0., -1., 0.], [0., 0., 0.475]),
            ([0., 0., 1.], [0., 0.162, 0.475]),
        ],
        [0., 0.162, 0.475],
    )
}

/// Whether joint values are among the solutions of their own pose.
fn is_found(chain: &Chain, q: &[f64; 6]) -> bool {
    let solutions = Solver::new(chain).solve(&chain.fk(q), &[0.0; 6]);
    solutions
        .iter()
        .any(|(joints, _)| joints.iter().zip(q).all(|(a, b)| (a - b - ((a - b) / TAU).round() * TAU).abs() < 1e-5))
}

/// Poses of 10 to 14 solutions, none of these near a singularity; the elimination of four arms near each lost them.
#[test]
fn postures_of_poses_with_many_solutions_are_found() {
    let of_crx = [
        [0.049, 2.333, -0.872, 0.617, -2.769, -0.706],
        [1.052, 2.238, -1.041, 0.783, -2.834, 1.869],
        [-1.919, 2.523, -1.026, 1.655, -1.209, -3.094],
        [1.24, 0.842, -0.79, 0.156, 0.026, -1.916],
        [1.923, -0.827, -1.178, 0.866, -2.844, 1.38],
    ];
    let of_hc10 = [
        [-1.797, -2.617, -0.384, 1.38, 1.75, -3.035],
        [2.707, -2.555, -0.629, 2.117, -1.983, 2.472],
        [0.183, -2.527, -0.358, 0.898, 2.673, -1.123],
        [2.621, -2.44, -0.852, 1.97, -0.984, 2.569],
    ];
    for (chain, postures) in [(crx10ial(), &of_crx[..]), (hc10(), &of_hc10[..])] {
        assert_eq!(class(&chain), Class::General);
        for q in postures {
            assert!(is_found(&chain, q), "{q:?}");
        }
    }
}

/// With axis 6 along axis 1, or nearly so, the equations of the order that is best elsewhere are dependent.
#[test]
fn a_vertical_tool_axis_loses_no_branch() {
    let (chain, mut spread) = (crx10ial(), Spread(12));
    for tilt in [0.0, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2] {
        let mut lost = 0;
        for k in 0..30 {
            let up = if k % 2 == 0 { 1.0 } else { -1.0 };
            let mut q: [f64; 6] = std::array::from_fn(|_| spread.within(PI));
            (q[3], q[4]) = (0.0, 0.0);
            let forearm = chain.fk(&[q[0], q[1], q[2], 0.0, 0.0, 0.0]).rotation * chain.home().rotation.inverse();
            // Axis 6 is (-cos q5, -sin q5 sin q4, -sin q5 cos q4) as the forearm sees it.
            let seen = forearm.inverse() * Vector3::new(tilt, 0.5 * tilt, up).normalize();
            q[3] = (-seen.y).atan2(-seen.z);
            q[4] = seen.y.hypot(seen.z).atan2(-seen.x);
            lost += usize::from(regular(&chain, &q) && !is_found(&chain, &q));
        }
        println!("tilt {tilt:e}: {lost} of 30 lost");
        assert_eq!(lost, 0, "tilt {tilt:e}");
    }
}

/// Axis 6 along axis 1 within 1e-3 to 1e-6 rad: the count of real eigenvalues was too small, and taken for sure, or none of the arms
/// near had these solutions.
#[test]
fn postures_of_a_nearly_vertical_tool_axis_are_found() {
    let of_crx = [
        [-1.389741665, -1.621406512, 1.468080264, -3.141110943, -1.623778900, 0.425836498],
        [-0.860199156, -0.007386997, 1.563269837, 0.768140330, 0.000124953, -1.847446469],
        [-1.258662970, -0.483886775, 1.086908484, 1.998767329, -0.000010396, 0.598924203],
        [0.785800735, -2.831676543, 1.880723065, 1.954457114, 0.000002282, -2.979982777],
        [2.205731114, -1.606923508, 3.105464720, 1.529583896, -0.000000629, 1.355676959],
    ];
    let of_hc10 = [
        [-2.358725132, 0.123881356, 0.123828963, 1.597479950, 0.000083790, 1.170682263],
        [-0.903990269, -0.496691227, 2.644894864, -1.967361406, -0.000010495, 0.166708903],
        [-0.837016951, -0.466496180, 2.675091412, -1.165311513, -3.141581804, -2.812843235],
        [-0.991163347, -3.122413223, 0.019177967, 2.427517738, 3.141591262, 2.514106582],
    ];
    for (chain, postures) in [(crx10ial(), &of_crx[..]), (hc10(), &of_hc10[..])] {
        let lost = postures.iter().filter(|q| !is_found(&chain, q)).count();
        assert_eq!(lost, 0, "of {}", postures.len());
    }
}

/// A UR10 as its maker calibrated it: the pose of this posture has two solutions beside one for each of the eight branches, of which none
/// is near a singularity.
#[test]
fn solutions_beside_all_eight_branches_are_found() {
    let chain = arm(
        &[
            ([0., 0., 1.], [0., 0., 0.]),
            ([-0.000072901, -0.999999975, -0.000211988], [0.000046309, -0.000027129, 0.127956086]),
            ([0.000051443, -0.999975202, 0.007042251], [-0.612169092, 0.000869684, 0.127964016]),
            ([0.000781993, -0.999789459, 0.020504288], [-1.183449465, 0.001697365, 0.127897956]),
            ([0.000073388, -0.01915492, -0.999816525], [-1.183211612, -0.166015813, 0.003093754]),
            ([0.00078185, -0.999791228, 0.02041786], [-1.183337428, -0.000675166, 0.012252414]),
        ],
        [-1.183136215, -0.257975567, 0.017507034],
    );
    assert_eq!(class(&chain), Class::ParallelShoulder);
    assert!(is_found(&chain, &[-2.358464058, 2.526700474, -2.210987975, 1.847963256, 0.001926616, -1.665934085]));
}

/// Round angles make the equations of such an arm dependent: those of arms near it are solved.
#[test]
fn an_arm_whose_wrist_has_an_offset_loses_at_most_one_branch_in_two_hundred() {
    // As Yaskawa's HC10 and Fanuc's CRX: axes 2 and 3 parallel, 4 and 6 parallel at zero, 0.16 m apart.
    let chain = arm(
        &[
            ([0., 0., 1.], [0.; 3]),
            ([0., 1., 0.], [0., 0., 0.275]),
            ([0., -1., 0.], [0., 0., 0.975]),
            ([-1., 0., 0.], [0., 0., 0.975]),
            ([0., -1., 0.], [0.5, 0., 0.975]),
            ([-1., 0., 0.], [0.5, 0.16, 0.975]),
        ],
        [0.63, 0.16, 0.975],
    );
    assert_eq!(class(&chain), Class::General);
    let (missed, count, worst) = missed(&chain, 100, 3);
    println!("{missed} of 100 lost, {:.2} solutions each", count as f64 / 100.0);
    assert!(missed * 200 <= u64::try_from(count).unwrap() && worst < 1e-9, "{missed} lost, {worst:e}");
}

/// iiwa 14 and the like: spherical shoulder and wrist, the elbow turns about the line between them.
fn seven(offset: f64) -> Chain {
    arm(
        &[
            ([0., 0., 1.], [0.; 3]),
            ([0., 1., 0.], [0., 0., 0.36]),
            ([0., 0., 1.], [0., 0., 0.36]),
            ([0., -1., 0.], [offset, 0., 0.78]),
            ([0., 0., 1.], [0., 0., 0.9]),
            ([0., 1., 0.], [0., 0., 1.18]),
            ([0., 0., 1.], [0.088 * f64::from(u8::from(offset > 0.0)), 0., 1.3]),
        ],
        [0., 0., 1.4],
    )
}

#[test]
fn seven_joints_are_solved_at_a_value_of_one() {
    for (chain, parameter) in [(seven(0.0), 2), (seven(0.0825), 6)] {
        let solver = Solver::new(&chain);
        assert!(
            matches!(solver.method(), Method::Redundant { parameter: p, .. } if *p == parameter),
            "{}",
            solver.method()
        );
        let mut spread = Spread(3);
        for _ in 0..200 {
            let q: Vec<f64> = (0..7).map(|_| spread.within(2.5)).collect();
            let target = chain.fk(&q);
            let solutions = solver.solve(&target, &q);
            assert!(solutions.reached());
            let best = solutions.iter().next().unwrap();
            let farthest = best.0.iter().zip(&q).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(farthest < 1e-4, "{q:?} {best:?}");
            // From another value of the parameter the pose is reached, too.
            let solutions = solver.solve(&target, &[0.0; 7]);
            assert!(solutions.reached() && solutions.iter().all(|(_, found)| found.position_error < 1e-8));
        }
    }
}

#[test]
fn other_chains_are_searched_and_a_pose_out_of_reach_has_a_nearest() {
    for chain in examples::all() {
        let solver = Solver::new(&chain);
        let n = chain.coordinates().len();
        let mut spread = Spread(4);
        let mut reached = 0;
        for _ in 0..10 {
            let range = |coordinate: &Coordinate, share: f64| {
                coordinate.range().0 + share * (coordinate.range().1 - coordinate.range().0)
            };
            let q: Vec<f64> = chain.coordinates().iter().map(|coordinate| range(coordinate, spread.next())).collect();
            reached += usize::from(solver.solve(&chain.fk(&q), &vec![0.0; n]).reached());
        }
        assert!(reached >= 9, "{}: {reached} of 10, {}", chain.name(), solver.method());
        let far = se3::translation(Vector3::new(100.0, 0.0, 0.0));
        let solutions = solver.solve(&far, &vec![0.0; n]);
        let (_, nearest) = solutions.iter().next().unwrap();
        assert!(!solutions.reached() && nearest.position_error > 50.0);
    }
}

#[test]
fn a_path_keeps_its_branch_and_limits_choose_the_turn() {
    let chain = ur5e();
    let solver = Solver::new(&chain);
    let start = [0.3, -1.2, 1.4, -0.5, -1.3, 0.2];
    let path: Vec<_> = (0..50).map(|k| chain.fk(&start.map(|q| q + 0.01 * f64::from(k)))).collect();
    for (k, (joints, step)) in solver.follow(&path, &start).into_iter().enumerate() {
        assert!(step.unwrap() < 0.02, "{k} {step:?}");
        assert!((joints[0] - 0.3 - 0.01 * k as f64).abs() < 1e-9);
    }
    // The same arm whose first joint may turn from half a turn to one and a half.
    let mut coordinates = chain.coordinates().to_vec();
    coordinates[0].limits = denavit_model::Limits::between(PI, 3.0 * PI);
    let names = (chain.name(), chain.base(), chain.tip());
    let narrow = Chain::new(names, coordinates, chain.joints().to_vec(), *chain.home()).unwrap();
    let solutions = Solver::new(&narrow).solve(&chain.fk(&start), &start);
    let (joints, found) = solutions.iter().next().unwrap();
    assert!(found.within_limits && joints[0] >= PI && joints[0] <= 3.0 * PI, "{joints:?}");
}
