//! Robots, configurations and the clock that the benchmarks share.
//!
//! A figure is the median over a few hundred windows of some hundred microseconds: on a shared machine most of these windows
//! are not interrupted, but most of criterion's samples, which take milliseconds, are. The peers in C++ and Python are timed
//! in the same way, so that ratios are meaningful.

use denavit_model::nalgebra::Vector3;
use denavit_model::{Chain, Reading, se3, urdf};
use std::path::PathBuf;
use std::time::{Duration, Instant};

/// A robot to be measured: its name in the table, its file below `robots/`, its tip link.
pub const ROBOTS: &[(&str, &str, &str)] =
    &[("UR5e", "universal_robots/ur5e.urdf", "tool0"), ("Panda", "franka/panda.urdf", "panda_link8")];

/// Configurations in a batch: all data stay in the second-level cache.
pub const BATCH: usize = 1000;

/// Path of a file below `robots/`.
pub fn robot_file(file: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../robots").join(file)
}

/// Text of a file below `robots/`.
///
/// # Panics
/// The file cannot be read.
pub fn robot_text(file: &str) -> String {
    std::fs::read_to_string(robot_file(file)).expect("robots/ holds the file")
}

/// The chain to `tip` of a file below `robots/`.
///
/// # Panics
/// The file is no robot, or has no such link.
pub fn chain(file: &str, tip: &str) -> Chain {
    let robot = urdf::read(file, &robot_text(file)).expect("robots/ holds URDFs");
    robot.chain(None, Some(tip), Reading::Intended).expect("the robot has the link").value
}

/// The chain with every axis moved by about a millimetre, each its own way.
///
/// # Panics
/// Never: small finite moves make a chain.
pub fn moved_axes(drawn: &Chain) -> Chain {
    let moved = drawn.joints().iter().enumerate().map(|(k, joint)| {
        let by = 1e-3 * Vector3::new((k as f64).sin(), (k as f64).cos(), 0.3);
        joint.screw.moved(&se3::translation(by))
    });
    drawn.with_geometry(&moved.collect::<Vec<_>>(), *drawn.home()).expect("a chain like the drawn one")
}

/// `count` configurations one after the other, each value in \[-3, 3\]: the same on every run.
pub fn configurations(coordinates: usize, count: usize) -> Vec<f64> {
    let part = |k: usize| (k as f64 * 0.618_033_988_749_894_9).fract();
    (1..=coordinates * count).map(|k| 6.0 * part(k) - 3.0).collect()
}

/// Windows in a measurement, at most.
const WINDOWS: usize = 300;
/// Time limit for all windows except the first five.
const PATIENCE: Duration = Duration::from_millis(400);

/// Median time of `work`, which does its work `times` times; ns for each.
///
/// # Panics
/// `times` is 0.
pub fn median_ns(times: usize, mut work: impl FnMut()) -> f64 {
    let start = Instant::now();
    let mut windows = Vec::with_capacity(WINDOWS);
    work();
    while windows.len() < WINDOWS && (windows.len() < 5 || start.elapsed() < PATIENCE) {
        let window = Instant::now();
        work();
        windows.push(window.elapsed().as_nanos() as f64 / times as f64);
    }
    windows.sort_by(f64::total_cmp);
    windows[windows.len() / 2]
}

/// Measures and prints one line of JSON: `{"robot", "who", "what", "ns"}`.
#[expect(clippy::print_stdout, reason = "the figures are what the program is for")]
pub fn report(robot: &str, who: &str, what: &str, times: usize, work: impl FnMut()) {
    let ns = median_ns(times, work);
    println!(r#"{{"robot": "{robot}", "who": "{who}", "what": "{what}", "ns": {ns:.2}}}"#);
}
