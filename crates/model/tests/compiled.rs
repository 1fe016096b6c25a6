//! The compiled chain against the plain one: chains of every kind of joint, every width of vector, every path.

use denavit_model::nalgebra::{Point3, Unit, Vector3, Vector6};
use denavit_model::{
    AxisLine, Chain, ChainJoint, CompiledChain, Coordinate, JacobianFrame, Pitch, Pose, Quantity, Screw, examples, se3,
};
use proptest::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI};
use std::num::NonZeroUsize;

/// Bound for the difference between the two, in rad and in sizes of the robot.
const AGREES: f64 = 1e-14;

fn direction() -> impl Strategy<Value = Unit<Vector3<f64>>> {
    let near = |v: Vector3<f64>| (0..3usize, -16.0..-1.0f64).prop_map(move |(k, e)| Vector3::ith(k, 10f64.powf(e)) + v);
    let axis = prop::sample::select(vec![Vector3::x(), Vector3::y(), Vector3::z()]);
    let signed = (axis, any::<bool>()).prop_map(|(v, turned)| if turned { -v } else { v });
    let oblique = prop::array::uniform3(-1.0..1.0f64).prop_map(Vector3::from);
    let oblique = oblique.prop_filter("a direction has a length", |v| v.norm() > 0.1);
    prop_oneof![3 => signed.clone(), 2 => oblique, 1 => signed.prop_flat_map(near)].prop_map(Unit::new_normalize)
}

fn screw() -> impl Strategy<Value = Screw> {
    let point = prop::array::uniform3(prop_oneof![Just(0.0), -1.0..1.0f64]).prop_map(Point3::from);
    (direction(), point, 0..5u8, prop_oneof![-0.1..-1e-4, 1e-4..0.1f64]).prop_map(|(direction, point, kind, pitch)| {
        let axis = AxisLine { direction, point };
        match kind {
            0 => Screw::Prismatic(direction),
            1 => Screw::Helical { axis, pitch: Pitch::from_metres_per_radian(pitch).expect("not zero") },
            _ => Screw::Revolute(axis),
        }
    })
}

/// Up to twenty joints, some of them driven by another's coordinate, scaled and offset.
fn chain() -> impl Strategy<Value = Chain> {
    let scale = prop_oneof![3 => Just(1.0), 1 => Just(-1.0), 1 => -2.0..-0.1f64];
    let offset = prop_oneof![3 => Just(0.0), 1 => Just(FRAC_PI_2), 1 => -1.0..1.0f64];
    let joint = (screw(), scale, offset, 0..8usize);
    let home = (
        prop::array::uniform3(prop_oneof![Just(0.0), -1.0..1.0f64]),
        prop::array::uniform3(prop_oneof![Just(0.0), Just(FRAC_PI_2), Just(PI), -PI..PI]),
    );
    (prop::collection::vec(joint, 0..20), home).prop_map(|(parts, (xyz, rpy))| {
        let mut coordinates = Vec::new();
        let mut joints = Vec::new();
        for (k, (screw, scale, offset, mimics)) in parts.into_iter().enumerate() {
            if mimics > 0 || coordinates.is_empty() {
                let quantity = if screw.line().is_some() { Quantity::Angle } else { Quantity::Length };
                coordinates.push(Coordinate::unlimited(format!("q{k}"), quantity));
            }
            let coordinate = if mimics > 0 { coordinates.len() - 1 } else { 0 };
            joints.push(ChainJoint { name: format!("j{k}"), screw, coordinate, scale, offset });
        }
        let home = se3::pose(se3::rotation_from_rpy(rpy), Vector3::from(xyz));
        Chain::new(("random", "base", "tip"), coordinates, joints, home).expect("all numbers are finite")
    })
}

/// The farthest that the chain's frames come from the base at `q`, m: what rounding is relative to.
fn size(chain: &Chain, q: &[f64]) -> f64 {
    let slides = chain.joints().iter().map(|joint| (joint.value(q) * joint.screw.pitch().unwrap_or(1.0)).abs());
    chain.size() + slides.sum::<f64>()
}

fn compiled(chain: &Chain) -> Vec<CompiledChain> {
    [512, 256, 128].into_iter().filter_map(|bits| CompiledChain::with_vector_bits(chain, bits)).collect()
}

fn configurations(chain: &Chain, count: usize, values: &[f64]) -> Vec<f64> {
    values.iter().copied().cycle().take(chain.coordinates().len() * count).collect()
}

fn assert_agree(chain: &Chain, q: &[f64], found: &Pose, what: &str) {
    let (turned, moved) = se3::difference(found, &chain.fk(q));
    let joints = chain.joints().len().max(6) as f64;
    // Rounding grows with the number of joints; six are the measure.
    let bound = AGREES * joints / 6.0;
    assert!(
        turned <= bound && moved <= bound * size(chain, q),
        "{what}: {turned} rad, {moved} m at {q:?} of {chain:?}"
    );
}

proptest! {
    #[test]
    fn one_configuration_at_a_time(chain in chain(), values in prop::collection::vec(-7.0..7.0f64, 20)) {
        let q = configurations(&chain, 1, &values);
        for compiled in compiled(&chain) {
            assert_agree(&chain, &q, &compiled.fk(&q), "fk");
        }
    }

    #[test]
    fn many_configurations_at_once(chain in chain(), count in 0..35usize, values in prop::collection::vec(-7.0..7.0f64, 97)) {
        let n = chain.coordinates().len();
        let q = configurations(&chain, count, &values);
        for compiled in compiled(&chain) {
            let (mut poses, mut tips) = (vec![Pose::identity(); count], vec![Point3::origin(); count]);
            compiled.poses_into(&q, &mut poses);
            compiled.tips_into(&q, &mut tips);
            for (k, (pose, tip)) in poses.iter().zip(&tips).enumerate() {
                assert_agree(&chain, &q[k * n..(k + 1) * n], pose, "poses");
                prop_assert_eq!(&pose.translation.vector, &tip.coords);
            }
            let (mut shared, mut shared_tips) = (vec![Pose::identity(); count], vec![Point3::origin(); count]);
            let threads = NonZeroUsize::new(3).unwrap();
            compiled.poses_into_by_threads(threads, &q, &mut shared);
            compiled.tips_into_by_threads(threads, &q, &mut shared_tips);
            prop_assert_eq!((&shared, &shared_tips), (&poses, &tips));
        }
    }

    #[test]
    fn jacobians(chain in chain(), values in prop::collection::vec(-7.0..7.0f64, 20)) {
        let n = chain.coordinates().len();
        let q = configurations(&chain, 1, &values);
        let mut expected = vec![Vector6::zeros(); n];
        for compiled in compiled(&chain) {
            let mut found = vec![Vector6::repeat(f64::NAN); n];
            chain.space_jacobian_into(&q, &mut expected);
            assert_agree(&chain, &q, &compiled.space_jacobian_into(&q, &mut found), "space Jacobian");
            let bound = 2e-13 * (1.0 + size(&chain, &q));
            for (k, (found, expected)) in found.iter().zip(&expected).enumerate() {
                prop_assert!((found - expected).norm() <= bound, "space column {}: {} {}", k, found, expected);
            }
            chain.tip_jacobian_into(&q, &mut expected);
            assert_agree(&chain, &q, &compiled.tip_jacobian_into(&q, &mut found), "tip Jacobian");
            for (k, (found, expected)) in found.iter().zip(&expected).enumerate() {
                prop_assert!((found - expected).norm() <= bound, "tip column {}: {} {}", k, found, expected);
            }
        }
    }
}

#[test]
fn matrices_and_jacobians_of_many_configurations_are_those_of_each() {
    for chain in examples::all() {
        let (n, count) = (chain.coordinates().len(), 21);
        let q: Vec<f64> = (0..n * count).map(|index| (index as f64 * 0.37).sin()).collect();
        let compiled = CompiledChain::new(&chain);
        for threads in [1, 2, 5].map(|threads| NonZeroUsize::new(threads).unwrap()) {
            let mut matrices = vec![[f64::NAN; 16]; count];
            compiled.matrices_into_by_threads(threads, &q, &mut matrices);
            let frames = [JacobianFrame::Space, JacobianFrame::Body, JacobianFrame::Tip];
            let jacobians = frames.map(|frame| {
                let mut jacobians = vec![f64::NAN; 6 * n * count];
                compiled.jacobians_into_by_threads(threads, frame, &q, &mut jacobians);
                jacobians
            });
            for (index, q) in q.chunks(n).enumerate() {
                let (mut space, mut tip) = (vec![Vector6::zeros(); n], vec![Vector6::zeros(); n]);
                let pose = chain.space_jacobian_into(q, &mut space);
                chain.tip_jacobian_into(q, &mut tip);
                let (home, away) = (pose.to_homogeneous(), se3::adjoint(&pose.inverse()));
                for row in 0..4 {
                    for column in 0..4 {
                        assert!((matrices[index][4 * row + column] - home[(row, column)]).abs() < 1e-13);
                    }
                }
                for k in 0..n {
                    let expected = [space[k], away * space[k], tip[k]];
                    for (found, expected) in jacobians.iter().zip(expected) {
                        let found = &found[6 * n * index..6 * n * (index + 1)];
                        assert!(
                            (0..6).all(|row| (found[row * n + k] - expected[row]).abs() < 1e-12),
                            "{}",
                            chain.name()
                        );
                    }
                }
            }
        }
    }
}

#[test]
fn far_from_zero_and_not_finite() {
    for chain in examples::all() {
        let n = chain.coordinates().len();
        for value in [1e3, -99_999.9, 1.1e5, 1e9, f64::NAN] {
            let q = vec![value; n];
            for compiled in compiled(&chain) {
                let mut poses = [Pose::identity(); 3];
                let many: Vec<f64> = [q.as_slice(), &vec![0.1; n], &vec![-0.2; n]].concat();
                compiled.poses_into(&many, &mut poses);
                assert_agree(&chain, &vec![0.1; n], &poses[1], "beside a far one");
                for found in [compiled.fk(&q), poses[0]] {
                    if value.is_nan() {
                        assert!(found.translation.vector.iter().any(|x| x.is_nan()), "{}", chain.name());
                    } else {
                        assert_agree(&chain, &q, &found, "far");
                    }
                }
            }
        }
    }
}

#[test]
fn quarter_turns_of_the_home_pose_are_exact() {
    let chain = examples::puma_like();
    let home = CompiledChain::new(&chain).fk(&[0.0; 6]);
    assert_eq!(home.rotation.matrix(), chain.home().rotation.matrix());
    assert!((home.translation.vector - chain.home().translation.vector).norm() < 3e-16);
}

#[test]
#[should_panic(expected = "one value for each coordinate of each configuration")]
fn a_batch_of_the_wrong_length_is_refused() {
    let chain = CompiledChain::new(&examples::planar_arm());
    chain.tips_into(&[0.0; 5], &mut [Point3::origin(); 2]);
}
