//! The pose of a camera beside a robot, from poses of the hand and of the marker on it.
//!
//! The poses are simulated here, with 0.5 mm and 1 mrad of noise; yours come from the robot and the camera.

use denavit_hand_eye::{Arrangement, Pair, report, solve};
use denavit_model::{Pose, se3};

const ROWS: usize = 12;

/// The n-th of numbers spread evenly over ±1: the noise of each row, in units of its size.
fn spread(n: usize) -> f64 {
    // The golden ratio's multiples do not repeat.
    (n as f64 * 0.618_033_988_749_894_9).fract() * 2.0 - 1.0
}

fn seen(robot: &Pose, row: usize) -> Pose {
    let base_from_camera = se3::pose(se3::rotation_from_rpy([-2.0, 0.1, 1.5]), [1.2, 0.1, 0.8].into());
    let tip_from_marker = se3::translation([0.0, 0.02, 0.11].into());
    let noise = |at: usize, size: f64| [0, 1, 2].map(|axis| size * spread(row * 7 + at + axis));
    let noise = se3::pose(se3::rotation_from_rpy(noise(0, 1e-3)), noise(3, 5e-4).into());
    base_from_camera.inverse() * robot * tip_from_marker * noise
}

#[expect(clippy::print_stdout, reason = "this is a program")]
fn main() -> Result<(), Box<dyn std::error::Error>> {
    let pairs: Vec<Pair> = (0..ROWS)
        .map(|row| {
            let turn = [0, 1, 2].map(|axis| spread(3 * row + axis));
            let place = [0, 1, 2].map(|axis| 0.3 * spread(40 + 3 * row + axis));
            let robot = se3::pose(se3::rotation_from_rpy(turn), [0.5 + place[0], place[1], 0.4 + place[2]].into());
            Pair { robot, seen: seen(&robot, row) }
        })
        .collect();
    let found = solve(&pairs, Arrangement::InstrumentStands)?;
    println!("{} {:?} m", found.base.name, found.base.pose.translation.vector.as_slice());
    let std = found.base.std().map(|std| format!("{std:.1e}"));
    println!("standard deviations {} (m, rad)", std.join(" "));
    print!("{}", report::ros_launch(&found.base.pose, "base_link", "camera"));
    Ok(())
}
