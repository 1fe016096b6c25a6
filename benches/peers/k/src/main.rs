//! Forward kinematics and Jacobian of the crate k, timed as ours are: medians of short windows, a JSON line each.
//!
//! `k-kinematics ROBOT FILE TIP`

use std::hint::black_box;
use std::time::Instant;

/// Calls in a window of some hundred microseconds.
const CALLS: u32 = 100;
const WINDOWS: usize = 300;

fn nanoseconds(mut call: impl FnMut(usize)) -> f64 {
    let mut times: Vec<f64> = (0..WINDOWS)
        .map(|window| {
            let start = Instant::now();
            for index in 0..CALLS {
                call(window + index as usize);
            }
            start.elapsed().as_nanos() as f64 / f64::from(CALLS)
        })
        .collect();
    times.sort_by(f64::total_cmp);
    times[WINDOWS / 2]
}

fn main() {
    let words: Vec<String> = std::env::args().collect();
    let [_, robot, file, tip] = &words[..] else { panic!("k-kinematics ROBOT FILE TIP") };
    let tree = k::Chain::<f64>::from_urdf_file(file).expect("k reads the file");
    let joint = tree.iter().find(|node| node.link().as_ref().is_some_and(|link| &link.name == tip)).expect("the tip");
    let arm = k::SerialChain::from_end(joint);
    let freedom = arm.dof();
    let configurations: Vec<Vec<f64>> = (0..64)
        .map(|row| (0..freedom).map(|column| ((row * 7 + column * 3) as f64 * 0.618).fract() - 0.5).collect())
        .collect();
    let report = |what: &str, time: f64| {
        println!("{{\"robot\": \"{robot}\", \"who\": \"k\", \"what\": \"{what}\", \"ns\": {time:.2}}}");
    };
    let set = |index: usize| arm.set_joint_positions_unchecked(&configurations[index % configurations.len()]);
    report(
        "fk",
        nanoseconds(|index| {
            set(index);
            arm.update_transforms();
            black_box(arm.end_transform());
        }),
    );
    report(
        "jacobian",
        nanoseconds(|index| {
            set(index);
            arm.update_transforms();
            black_box(k::jacobian(&arm));
        }),
    );
}
