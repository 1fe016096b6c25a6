//! Every posture of a six-axis arm that reaches one pose.

use denavit_ik::Solver;
use denavit_model::examples;

#[expect(clippy::print_stdout, reason = "this is a program")]
fn main() {
    let arm = examples::puma_like();
    let pose = arm.fk(&[0.3, 0.5, -0.7, 0.4, 0.6, -0.2]);
    for (q, found) in Solver::new(&arm).solve(&pose, &[0.0; 6]).iter() {
        println!("{q:.4?} {found:?}");
    }
}
