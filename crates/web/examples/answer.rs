//! Answers questions of the explorer's page natively, one JSON text a line, and says how long each took: what
//! `web/measure` holds the page's own times against.

#![expect(clippy::print_stdout, reason = "what it prints is all that it is for")]

use std::io::BufRead as _;
use std::time::Instant;

fn main() {
    for line in std::io::stdin().lock().lines() {
        let question = line.expect("questions are lines of UTF-8");
        let before = Instant::now();
        let answer = denavit_web::answer(&question);
        let milliseconds = before.elapsed().as_secs_f64() * 1e3;
        println!("{}", serde_json::json!({ "milliseconds": milliseconds, "failed": answer.starts_with("{\"error\"") }));
    }
}
