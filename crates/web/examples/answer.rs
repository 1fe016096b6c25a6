//! Answers questions of the explorer's page natively, one JSON text a line, and prints how long each took: what
//! `web/measure` compares the page's own times with. With `--answers` it prints the answers instead.

#![expect(clippy::print_stdout, reason = "printing is its purpose")]

use std::io::BufRead as _;
use std::time::Instant;

fn main() {
    let whole = std::env::args().any(|argument| argument == "--answers");
    for line in std::io::stdin().lock().lines() {
        let question = line.expect("questions are lines of UTF-8");
        let before = Instant::now();
        let answer = denavit_web::answer(&question);
        let milliseconds = before.elapsed().as_secs_f64() * 1e3;
        if whole {
            println!("{}", answer.replace('\n', " "));
            continue;
        }
        println!("{}", serde_json::json!({ "milliseconds": milliseconds, "failed": answer.starts_with("{\"error\"") }));
    }
}
