//! ns per pose of a UR5e: the generated `fk_batch` from several compilers and denavit's batch in vectors of 256 bits, timed in turn in one
//! run. `batch_time UR5E.urdf` prints the smallest of the rounds' medians.

use denavit_code::{Language, Options, Precision, code};
use denavit_dh::convert;
use denavit_model::{CompiledChain, Pose, Reading, urdf};
use std::hint::black_box;
use std::path::Path;
use std::process::Command;
use std::time::Instant;

const POSTURES: usize = 1000;
const WINDOWS: usize = 300;
const ROUNDS: usize = 7;

const C: &str = r#"
#define _POSIX_C_SOURCE 200809L
#include <stdio.h>
#include <stdlib.h>
#include <time.h>
#ifdef __cplusplus
#include "arm.hpp"
#define RUN(q, n, poses) ur5e::fk_batch((const ur5e::Joints*)(q), n, (ur5e::Pose*)(poses))
#else
#include "arm.h"
#ifdef ONE
#define RUN(q, n, poses) for (int i = 0; i < n; ++i) ur5e_fk(q + 6 * i, (double(*)[4])(poses + 12 * i))
#else
#define RUN ur5e_fk_batch
#endif
#endif
static double q[6000], poses[12000], windows[300];
static int by_size(const void *a, const void *b) { double x = *(const double *)a, y = *(const double *)b; return (x > y) - (x < y); }
static __attribute__((noinline)) void run(const double *q, double *poses) { RUN(q, 1000, poses); }
int main(void)
{
    for (int i = 0; i < 6000; ++i) { double part = (i + 1) * 0.6180339887498949; q[i] = 6 * (part - (int)part) - 3; }
    run(q, poses);
    for (int r = 0; r < 300; ++r) {
        struct timespec a, b;
        clock_gettime(CLOCK_MONOTONIC, &a);
        run(q, poses);
        clock_gettime(CLOCK_MONOTONIC, &b);
        windows[r] = (b.tv_sec - a.tv_sec) * 1e6 + (b.tv_nsec - a.tv_nsec) * 1e-3;
    }
    qsort(windows, 300, 8, by_size);
    printf("%f\n", windows[150]);
}
"#;

const RUST: &str = r#"
mod arm;
use std::hint::black_box;
fn main() {
    let part = |k: usize| ((k + 1) as f64 * 0.6180339887498949).fract();
    let q: Vec<[f64; 6]> = (0..1000).map(|i| std::array::from_fn(|j| 6.0 * part(6 * i + j) - 3.0)).collect();
    let mut poses = vec![[[0.0; 4]; 3]; 1000];
    let mut windows: Vec<f64> = (0..300).map(|_| {
        let start = std::time::Instant::now();
        arm::fk_batch(black_box(&q), black_box(&mut poses));
        start.elapsed().as_nanos() as f64 / 1000.0
    }).collect();
    windows.sort_by(f64::total_cmp);
    println!("{}", windows[150]);
}
"#;

fn median(mut work: impl FnMut()) -> f64 {
    let window = |_| {
        let start = Instant::now();
        work();
        start.elapsed().as_nanos() as f64 / POSTURES as f64
    };
    let mut windows: Vec<f64> = (0..WINDOWS).map(window).collect();
    windows.sort_by(f64::total_cmp);
    windows[WINDOWS / 2]
}

#[expect(clippy::print_stdout, reason = "this is a program")]
fn main() -> Result<(), Box<dyn std::error::Error>> {
    let file = std::env::args().nth(1).ok_or("usage: batch_time UR5E.urdf")?;
    let robot = urdf::read(&file, &std::fs::read_to_string(&file)?)?;
    let chain = robot.chain(None, None, Reading::Intended)?.value;
    let table = convert::table(&chain, &denavit_dh::Options::default())?.value;
    let folder = std::env::temp_dir().join(format!("batch_time{}", std::process::id()));
    std::fs::create_dir(&folder)?;
    for language in [Language::C, Language::Cpp, Language::Rust] {
        let text = code(&table, Options { language, precision: Precision::Double })?;
        std::fs::write(folder.join(format!("arm.{}", language.extension())), text)?;
    }
    std::fs::write(folder.join("main.c"), C)?;
    std::fs::write(folder.join("main.rs"), RUST)?;
    let wide = "x86-64-v3";
    let programs: Vec<(&str, String)> = [
        ("gcc", "-O3 -DONE main.c -lm".to_owned()),
        ("gcc", "-O3 main.c -lm".to_owned()),
        ("gcc", format!("-O3 -march={wide} main.c -lm")),
        ("gcc", format!("-std=c99 -O3 -march={wide} main.c -lm")),
        ("gcc", "-O3 -march=native main.c -lm".to_owned()),
        ("g++", format!("-x c++ -O3 -march={wide} main.c")),
        ("rustc", "-O main.rs".to_owned()),
        ("rustc", format!("-O -C target-cpu={wide} main.rs")),
    ]
    .into();
    let made = |index: usize| folder.join(format!("program{index}"));
    for (index, (program, flags)) in programs.iter().enumerate() {
        let edition: &[&str] = if *program == "rustc" { &["--edition", "2021"] } else { &[] };
        let mut command = Command::new(program);
        command.args(edition).arg("-o").arg(made(index)).args(flags.split(' ')).current_dir(&folder);
        if !command.status()?.success() {
            return Err(format!("{program} {flags} failed").into());
        }
    }
    let part = |k: usize| ((k + 1) as f64 * 0.618_033_988_749_894_9).fract();
    let q: Vec<f64> = (0..chain.coordinates().len() * POSTURES).map(|k| 6.0 * part(k) - 3.0).collect();
    let mut poses = vec![Pose::identity(); POSTURES];
    let compiled = CompiledChain::with_vector_bits(&chain, 256).ok_or("no vectors of 256 bits here")?;
    let mut least = vec![f64::INFINITY; programs.len() + 1];
    for _ in 0..ROUNDS {
        let ours = median(|| compiled.poses_into(black_box(&q), black_box(&mut poses)));
        least[programs.len()] = least[programs.len()].min(ours);
        for (index, least) in least.iter_mut().take(programs.len()).enumerate() {
            *least = least.min(run(&made(index))?);
        }
    }
    for ((program, flags), ns) in programs.iter().zip(&least) {
        println!("{ns:6.1} ns  {program} {flags}");
    }
    println!("{:6.1} ns  denavit, 256 bits", least[programs.len()]);
    std::fs::remove_dir_all(&folder)?;
    Ok(())
}

fn run(program: &Path) -> Result<f64, Box<dyn std::error::Error>> {
    Ok(String::from_utf8(Command::new(program).output()?.stdout)?.trim().parse()?)
}
