//! Solves poses of one arm, for `tests/oracle/ik_peers.py`, which compares the solutions with other solvers.
//!
//! `peers ARM POSES SOLUTIONS [TIMES]`: the text file ARM has the direction and a point of each axis (rad, m), then the home pose's
//! 16 numbers, row by row. POSES has rows of joint values, 8 bytes a number. SOLUTIONS gets a row for each solution: the pose's index,
//! then the joint values. The poses are solved TIMES more without other work: the difference of two runs is the solver's time.

#![expect(clippy::print_stdout, reason = "printing is its purpose")]

use denavit_ik::{Solutions, Solver};
use denavit_model::chain::{ChainJoint, Coordinate, Quantity};
use denavit_model::nalgebra::{Matrix3, Point3, Rotation3, Unit, Vector3};
use denavit_model::{AxisLine, Chain, Pose, Screw, se3};

fn arm(numbers: &[f64]) -> Chain {
    let (axes, home) = numbers.split_at(numbers.len() - 16);
    let vector = |part: &[f64]| Vector3::new(part[0], part[1], part[2]);
    let screws = axes.chunks_exact(6).map(|axis| {
        let direction = Unit::new_normalize(vector(axis));
        Screw::Revolute(AxisLine { direction, point: Point3::from(vector(&axis[3..])) })
    });
    let names: Vec<String> = (1..=axes.len() / 6).map(|index| format!("joint_{index}")).collect();
    let coordinates = names.iter().map(|name| Coordinate::unlimited(name.clone(), Quantity::Angle)).collect();
    let joints = screws.zip(&names).enumerate().map(|(coordinate, (screw, name))| ChainJoint {
        name: name.clone(),
        screw,
        coordinate,
        scale: 1.0,
        offset: 0.0,
    });
    let rotation = Matrix3::new(home[0], home[1], home[2], home[4], home[5], home[6], home[8], home[9], home[10]);
    let home = se3::pose(Rotation3::from_matrix(&rotation), Vector3::new(home[3], home[7], home[11]));
    Chain::new(("arm", "base", "tip"), coordinates, joints.collect(), home).expect("an arm")
}

fn main() {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let [arm_file, poses_file, solutions_file, more @ ..] = &words[..] else { panic!("ARM POSES SOLUTIONS [TIMES]") };
    let times: usize = more.first().map_or(0, |word| word.parse().expect("a number"));
    let text = std::fs::read_to_string(arm_file).expect("the arm");
    let numbers: Vec<f64> = text.split_whitespace().map(|word| word.parse().expect("a number")).collect();
    let chain = arm(&numbers);
    let count = chain.coordinates().len();
    let bytes = std::fs::read(poses_file).expect("the poses");
    let values: Vec<f64> =
        bytes.chunks_exact(8).map(|eight| f64::from_le_bytes(eight.try_into().expect("8"))).collect();
    let poses: Vec<Pose> = values.chunks_exact(count).map(|q| chain.fk(q)).collect();
    let solver = Solver::new(&chain);
    let near = vec![0.0; count];
    let mut solutions = Solutions::default();
    for pose in std::iter::repeat_n(&poses, times).flatten() {
        solver.solve_into(pose, &near, &mut solutions);
        std::hint::black_box(&solutions);
    }
    let mut out = Vec::new();
    for (index, pose) in poses.iter().enumerate() {
        solver.solve_into(pose, &near, &mut solutions);
        if solutions.reached() {
            for (joints, _) in solutions.iter() {
                out.extend((index as f64).to_le_bytes());
                out.extend(joints.iter().flat_map(|value| value.to_le_bytes()));
            }
        }
    }
    std::fs::write(solutions_file, out).expect("the solutions");
    println!("{}", solver.method());
}
