//! How many Jacobians a geometric fit takes, and whether it converges: `cargo run --release --example study_fit -- ROBOT FILE [DRAWS]`.
//!
//! For all rows and for random draws of 15 to 200 rows: fits that did not converge, steps and Jacobians of the geometric fit (median, most),
//! and its root mean square error on up to 300 other rows (geometric mean over the draws, largest; mm). Environment variables: `TIP`, `UNITS`.
#![allow(clippy::unwrap_used, clippy::print_stdout)] // A study prints, and stops at the first failure.

#[allow(dead_code, reason = "other studies take what this one does not")]
mod real;

use self::real::Real;
use denavit_identify::parameters::NoEffects;
use denavit_identify::residual::ResidualModel;
use denavit_identify::{IdentifyOptions, identify};

/// Rows of a draw: xorshift, so that the draws are the same everywhere.
fn drawn(rows: usize, count: usize, seed: u64) -> (Vec<usize>, Vec<usize>) {
    let mut all: Vec<usize> = (0..rows).collect();
    let mut state = 0x9E37_79B9_7F4A_7C15u64.wrapping_mul(seed + 1);
    for k in 0..rows - 1 {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        let other = k + usize::try_from(state % (rows - k) as u64).unwrap();
        all.swap(k, other);
    }
    let rest = all.split_off(count);
    (all, rest.into_iter().take(300).collect())
}

fn middle(values: &mut [usize]) -> (usize, usize) {
    values.sort_unstable();
    (values[values.len() / 2], values[values.len() - 1])
}

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    let real = Real::robot(&arguments[1]);
    let data = real.rows(&arguments[2]);
    let draws: u64 = arguments.get(3).map_or(10, |word| word.parse().unwrap());
    let options = IdentifyOptions::axes(&real.chain);
    println!("{} rows of {}", data.len(), arguments[2]);
    println!(
        "| rows | fits | not converged | steps | Jacobians | error on other rows, mm: mean, largest |\n|---|---|---|---|---|---|"
    );
    for count in [15, 20, 30, 50, 100, 200, data.len()] {
        let all = count == data.len();
        if count > data.len() || (!all && count + 20 > data.len()) {
            continue;
        }
        let (mut open, mut steps, mut jacobians, mut errors) = (0, Vec::new(), Vec::new(), Vec::new());
        for seed in 0..if all { 1 } else { draws } {
            let (some, others) = drawn(data.len(), count, seed);
            let fit = identify(&real.chain, &data.subset(&some), &options).geometric;
            if !fit.converged_or_exact() {
                open += 1;
                println!("  seed {seed}: {:?}", fit.unfinished);
            }
            steps.push(fit.iterations);
            jacobians.push(fit.jacobians);
            let judged = if others.is_empty() { data.subset(&some) } else { data.subset(&others) };
            let model = ResidualModel { data: &judged, layout: &fit.layout, effects: &NoEffects };
            let squares = model.squares(&fit.arm);
            let mean = squares.iter().map(|square| square[0]).sum::<f64>() / squares.len() as f64;
            errors.push(1e3 * mean.sqrt());
        }
        let mean = (errors.iter().map(|error| error.ln()).sum::<f64>() / errors.len() as f64).exp();
        let most = errors.iter().copied().fold(0.0, f64::max);
        let (steps, jacobians) = (middle(&mut steps), middle(&mut jacobians));
        println!(
            "| {count} | {} | {open} | {}, {} | {}, {} | {mean:.4}, {most:.4} |",
            errors.len(),
            steps.0,
            steps.1,
            jacobians.0,
            jacobians.1
        );
    }
}
