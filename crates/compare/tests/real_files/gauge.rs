//! Base, zeros and senses set free; and the bound, held against forward kinematics of its own.

use crate::real_files::support::as_written;
use crate::real_files::support::chance::Chance;
use crate::real_files::support::harmless::origin_of;
use crate::real_files::support::vendor;
use crate::real_files::support::write::{PLAIN, again};
use denavit_compare::{Options, Scope, Subject, Verdict, compare};
use denavit_model::nalgebra::Vector3;
use denavit_model::se3::{self, Pose};
use denavit_model::tree::Reading;
use denavit_model::{Chain, JointKind, Robot};

const ARMS: [&str; 8] = [
    "robots/abb/irb120_3_58.urdf",
    "robots/franka/fer_hand.urdf",
    "robots/kuka/iiwa7.urdf",
    "robots/denso/hsr065a1_n32_scara.urdf",
    "robots/staubli/tx60.urdf",
    "robots/robotics-toolbox/ur5.urdf",
    "robots/ufactory/xarm7.urdf",
    "robots/interbotix/vx300s.urdf",
];

fn arms() -> Vec<Robot> {
    let arms: Vec<Robot> = ARMS.iter().filter_map(|name| vendor::robot(name)).collect();
    if !arms.is_empty() {
        return arms;
    }
    println!("our own arms stand for those of ../shared/vendor, which is not there");
    let own = ["irb120.urdf", "panda.urdf", "iiwa14.urdf", "ur5e.urdf", "xarm7.urdf"];
    vendor::robots().into_iter().filter(|robot| own.iter().any(|name| robot.source.file.ends_with(name))).collect()
}

/// The arm as a bare chain, as a table would give it.
fn chain(robot: &Robot) -> Chain {
    robot.chain(None, None, Reading::AsWritten).unwrap().value
}

/// Everything on the root link moved.
fn mounted_elsewhere(robot: &mut Robot, chance: &mut Chance) {
    let by = se3::pose(se3::rotation_about(&chance.direction(), 1.0), chance.direction().into_inner());
    let root = robot.root;
    for joint in robot.joints.iter_mut().filter(|joint| joint.parent == root) {
        joint.origin = origin_of(&(by * joint.origin.pose()));
    }
    let link = &mut robot.links[root];
    for shape in link.visuals.iter_mut().chain(&mut link.collisions) {
        shape.origin = origin_of(&(by * shape.origin.pose()));
    }
    if let Some(inertial) = &mut link.inertial {
        inertial.origin = origin_of(&(by * inertial.origin.pose()));
    }
}

/// Zeros shifted and senses turned round, limits along with them.
fn counted_otherwise(robot: &mut Robot, chance: &mut Chance) {
    for joint in &mut robot.joints {
        if joint.kind != JointKind::Revolute || joint.mimic.is_some() {
            continue;
        }
        let (axis, shift) = (joint.axis.into_inner(), chance.between(-1.0, 1.0));
        let turn = se3::pose(se3::rotation_about(&axis, shift), Vector3::zeros());
        joint.origin = origin_of(&(joint.origin.pose() * turn));
        let sense = if chance.below(2) == 0 { 1.0 } else { -1.0 };
        joint.axis_written = Some((axis * sense).into());
        if let Some((lower, upper)) = &mut joint.limits.range {
            let (x, y) = ((*lower - shift) * sense, (*upper - shift) * sense);
            (*lower, *upper) = (x.min(y), x.max(y));
        }
    }
}

#[test]
fn a_robot_mounted_elsewhere_is_the_same_up_to_its_base() {
    for (index, arm) in arms().iter().enumerate() {
        let mut moved = arm.clone();
        mounted_elsewhere(&mut moved, &mut Chance::new(index as u64));
        let moved = again(&moved, &PLAIN);
        let (a, b) = (Subject::Robot(arm), Subject::Robot(&moved));
        let strict = compare(&a, &b, &as_written()).unwrap();
        assert_eq!(strict.verdict, Verdict::Different, "{}", arm.source.file);
        let free = compare(&a, &b, &Options { up_to_base: true, ..as_written() }).unwrap();
        assert_eq!(free.verdict, Verdict::Same, "{}: {:?} {:?}", arm.source.file, free.joints, free.parts);
        let (one, other) = (chain(arm), chain(&moved));
        let (a, b) = (Subject::Chain { file: "a", chain: &one }, Subject::Chain { file: "b", chain: &other });
        let bare = compare(&a, &b, &Options { up_to_base: true, ..as_written() }).unwrap();
        assert_eq!(bare.verdict, Verdict::Same, "{} bare: {:?} {:?}", arm.source.file, bare.joints, bare.parts);
    }
}

#[test]
fn a_robot_counted_otherwise_is_the_same_up_to_its_zeros() {
    for (index, arm) in arms().iter().enumerate() {
        let mut counted = arm.clone();
        counted_otherwise(&mut counted, &mut Chance::new(50 + index as u64));
        let counted = again(&counted, &PLAIN);
        let (a, b) = (Subject::Robot(arm), Subject::Robot(&counted));
        let strict = compare(&a, &b, &as_written()).unwrap();
        assert_eq!(strict.verdict, Verdict::Different, "{}", arm.source.file);
        let options = Options { up_to_zeros: true, scope: Scope::Kinematics, ..as_written() };
        let free = compare(&a, &b, &options).unwrap();
        assert_eq!(free.verdict, Verdict::Same, "{}: {:?} {:?}", arm.source.file, free.joints, free.parts);
        let worst = free.largest().unwrap();
        assert!(worst.sampled_m < 1e-7, "{}: {worst:?}", arm.source.file);
    }
}

/// Largest displacement that forward kinematics of the chains finds within a's limits, from `tries` joint vectors.
fn tried(one: &Chain, other: &Chain, chance: &mut Chance, tries: usize) -> f64 {
    let mut largest = 0.0f64;
    for _ in 0..tries {
        let q: Vec<f64> = one
            .coordinates()
            .iter()
            .map(|coordinate| {
                let (lower, upper) = coordinate.range();
                chance.between(lower, upper)
            })
            .collect();
        let at = |chain: &Chain| -> Pose { chain.fk(&q) };
        largest = largest.max(se3::difference(&at(one), &at(other)).1);
    }
    largest
}

#[test]
fn no_configuration_of_forward_kinematics_exceeds_the_bound() {
    let (mut worst, mut pairs) = (0.0f64, 0);
    for (index, arm) in arms().iter().enumerate() {
        let mut chance = Chance::new(200 + index as u64);
        for edits in 1..=4 {
            let mut edited = arm.clone();
            for joint in edited.joints.iter_mut().take(edits * 2) {
                let turn = se3::rotation_about(&chance.direction(), chance.magnitude(-4.0, -0.5));
                let step = chance.direction().into_inner() * chance.magnitude(-4.0, -0.5);
                joint.origin = origin_of(&(joint.origin.pose() * se3::pose(turn, step)));
            }
            let edited = again(&edited, &PLAIN);
            let (one, other) = (chain(arm), chain(&edited));
            let found = compare(
                &Subject::Chain { file: "a", chain: &one },
                &Subject::Chain { file: "b", chain: &other },
                &as_written(),
            )
            .unwrap();
            let tip = found.largest().unwrap();
            let tried = tried(&one, &other, &mut chance, 4000);
            assert!(tried <= tip.bound_m, "{}: {tried} {}", arm.source.file, tip.bound_m);
            assert!(
                tip.sampled_m <= tip.bound_m && tried <= tip.sampled_m * 1.01,
                "{}: {tried} {tip:?}",
                arm.source.file
            );
            // At the joint values that the comparison names, forward kinematics finds the same displacement.
            let q: Vec<f64> = one
                .coordinates()
                .iter()
                .map(|coordinate| {
                    tip.at.iter().find(|joint| joint.joint == coordinate.name).map_or(0.0, |joint| joint.value)
                })
                .collect();
            let there = se3::difference(&one.fk(&q), &other.fk(&q)).1;
            assert!((there - tip.sampled_m).abs() < 1e-9, "{}: {there} {}", arm.source.file, tip.sampled_m);
            worst = worst.max(tip.bound_m / tip.sampled_m);
            pairs += 1;
        }
    }
    println!("{pairs} pairs of several edits: the bound is at most {worst:.2} times what is found");
}
