//! A straight line through noisy points: coefficients with standard deviations, and each point predicted from the others.

use denavit_linear::Problem;
use nalgebra::{DMatrix, DVector};

/// Standard deviation of a point, and the prior standard deviation of each coefficient.
const NOISE: f64 = 0.1;
const BEFORE: f64 = 10.0;

#[expect(clippy::print_stdout, reason = "this is a program")]
fn main() -> Result<(), Box<dyn std::error::Error>> {
    let measured = [(0.0, 1.02), (1.0, 2.96), (2.0, 5.11), (3.0, 6.93), (4.0, 9.05)];
    let count = measured.len();
    let problem = Problem {
        columns: DMatrix::from_fn(count, 2, |row, column| if column == 0 { 1.0 } else { measured[row].0 }),
        data: DVector::from_iterator(count, measured.iter().map(|point| point.1)),
        // Each point is a row of its own with independent noise.
        rows: (0..count).map(|row| row..row + 1).collect(),
        noise: vec![DMatrix::from_element(1, 1, NOISE * NOISE); count],
        variances: DVector::from_element(2, BEFORE * BEFORE),
    };
    let gram = problem.gram().ok_or("a covariance is not positive")?;
    let found = gram.posterior();
    for (name, k) in [("offset", 0), ("slope", 1)] {
        println!("{name} {:.3} ± {:.3}", found.mean[k], found.covariance[(k, k)].sqrt());
    }
    println!("-2 log evidence {:.2}", gram.evidence());
    for (point, left_out) in measured.iter().zip(gram.leave_out().ok_or("the numbers lose their precision")?) {
        let std = left_out.covariance[(0, 0)].sqrt();
        println!("x = {}: {:+.3} from the line through the others, ± {std:.3}", point.0, left_out.residual[0]);
    }
    Ok(())
}
