//! Whether the noise level, the intervals and the held-out error are right. Reads runs made by pinocchio from standard input
//! (`tests/oracle/calibration/runs.py study`) and prints the table of docs/calibration.md.

#![allow(clippy::unwrap_used, clippy::print_stdout)] // A study prints its table, and stops at a bad line.

#[allow(dead_code, reason = "the tests use more of it than the study")]
#[path = "../tests/runs/mod.rs"]
mod runs;

use runs::{Run, Score};
use std::io::BufRead;

#[derive(Default)]
struct Tally {
    case: String,
    runs: f64,
    inside: f64,
    inside_squared: f64,
    parameters: f64,
    chi_squared: f64,
    degrees_of_freedom: f64,
    unseen: f64,
    attainable: f64,
    load: f64,
    iterations: Vec<usize>,
    wrongly_rejected: usize,
    missed: usize,
    outliers: usize,
}

impl Tally {
    fn add(&mut self, run: &Run) {
        let found = run.identify();
        let score = Score::of(run, &found);
        self.runs += 1.0;
        self.parameters += score.parameters;
        self.inside += score.inside / score.parameters;
        self.inside_squared += (score.inside / score.parameters).powi(2);
        self.chi_squared += score.chi_squared;
        self.degrees_of_freedom += score.degrees_of_freedom;
        self.unseen += score.unseen;
        self.attainable += score.attainable;
        self.load += score.load;
        self.iterations.push(found.geometric.iterations);
        let rejected = run.rejected(&found.geometric);
        self.wrongly_rejected += rejected.iter().filter(|row| !run.outliers.contains(row)).count();
        self.missed += run.outliers.iter().filter(|row| !rejected.contains(row)).count();
        self.outliers += run.outliers.len();
    }

    fn print(&mut self) {
        self.iterations.sort_unstable();
        let inside = self.inside / self.runs;
        let spread = ((self.inside_squared / self.runs - inside * inside).max(0.0) / self.runs).sqrt();
        // Errors on new rows, including their own noise, in units of the noise.
        let reached = (1.0 + self.unseen / self.runs).sqrt();
        println!(
            "| {} | {} | {:.2} ± {:.2} % | {:.4} | {:.4} | {:.4} | {}, {:.1} %, {} | {} of {} | {} |",
            self.case,
            self.runs,
            100.0 * inside,
            100.0 * spread,
            self.chi_squared / self.degrees_of_freedom,
            reached / (1.0 + self.load / self.runs).sqrt(),
            reached / (1.0 + self.attainable / self.runs).sqrt(),
            self.iterations[self.iterations.len() / 2],
            100.0 * self.iterations.iter().filter(|count| **count <= 6).count() as f64 / self.runs,
            self.iterations[self.iterations.len() - 1],
            self.missed,
            self.outliers,
            self.wrongly_rejected,
        );
    }
}

fn main() {
    println!(
        "| run | runs | inside 95 % | χ²/dof | error / floor·√(1 + p/N) | error / attainable | iterations: median, at most 6, most \
         | outliers missed | clean rows rejected |"
    );
    println!("|---|---|---|---|---|---|---|---|---|");
    let mut tally = Tally::default();
    for line in std::io::stdin().lock().lines() {
        let run = Run::parse(&line.unwrap());
        if run.case != tally.case {
            if tally.runs > 0.0 {
                tally.print();
            }
            tally = Tally { case: run.case.clone(), ..Tally::default() };
        }
        tally.add(&run);
    }
    if tally.runs > 0.0 {
        tally.print();
    }
}
