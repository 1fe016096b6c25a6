//! Does one thing a number of times and nothing else; `benches/count_instructions` runs it under callgrind.
//!
//! `instructions WHAT TIMES`, WHAT one of [`WORK`].

use denavit_benches::{BATCH, ROBOTS, chain, configurations, moved_axes, robot_text};
use denavit_calibrate::IdentifyOptions;
use denavit_compare::{Options, Subject, compare};
use denavit_identify::identify;
use denavit_identify::parameters::NoEffects;
use denavit_identify::simulate::{SimulationOptions, simulate};
use denavit_measurements::kinds::ObservationKind;
use denavit_model::nalgebra::{Point3, Vector6};
use denavit_model::{CompiledChain, Pose, Reading, urdf};
use std::hint::black_box;

/// Does its work this many times.
type Repeat = fn(usize);

/// What can be counted.
const WORK: &[(&str, Repeat)] = &[
    ("plain_fk", |times| kinematics(times, Kinematics::Plain)),
    ("fk", |times| kinematics(times, Kinematics::Fk)),
    ("jacobian", |times| kinematics(times, Kinematics::Jacobian)),
    ("poses", |times| kinematics(times, Kinematics::Poses)),
    ("tips", |times| kinematics(times, Kinematics::Tips)),
    ("load", load),
    ("identify", identification),
    ("compare", comparison),
];

#[derive(Clone, Copy)]
enum Kinematics {
    Plain,
    Fk,
    Jacobian,
    Poses,
    Tips,
}

fn kinematics(times: usize, what: Kinematics) {
    let (_, file, tip) = ROBOTS[0];
    let chain = chain(file, tip);
    let compiled = CompiledChain::new(&chain);
    let n = chain.coordinates().len();
    let q = configurations(n, BATCH);
    let mut columns = vec![Vector6::zeros(); n];
    let (mut poses, mut tips) = (vec![Pose::identity(); BATCH], vec![Point3::origin(); BATCH]);
    let one = q.chunks(n).cycle().take(times);
    match what {
        Kinematics::Plain => one.for_each(|q| _ = black_box(chain.fk(black_box(q)))),
        Kinematics::Fk => one.for_each(|q| _ = black_box(compiled.fk(black_box(q)))),
        Kinematics::Jacobian => one.for_each(|q| _ = black_box(compiled.tip_jacobian_into(black_box(q), &mut columns))),
        Kinematics::Poses => (0..times / BATCH).for_each(|_| compiled.poses_into(black_box(&q), &mut poses)),
        Kinematics::Tips => (0..times / BATCH).for_each(|_| compiled.tips_into(black_box(&q), &mut tips)),
    }
    black_box((columns, poses, tips));
}

fn load(times: usize) {
    let text = robot_text(ROBOTS[0].1);
    for _ in 0..times {
        let robot = urdf::read("robot.urdf", black_box(&text)).expect("a robot");
        black_box(robot.chain(None, None, Reading::Intended).expect("a chain"));
    }
}

/// 10 000 full poses of a 6R arm.
fn identification(times: usize) {
    let (_, file, tip) = ROBOTS[0];
    let chain = chain(file, tip);
    let options = SimulationOptions { kind: ObservationKind::Pose, rows: 10_000, ..Default::default() };
    let data = simulate(&chain, &options, &NoEffects).data;
    for _ in 0..times {
        black_box(identify(black_box(&chain), black_box(&data), &IdentifyOptions::axes(&chain)));
    }
}

/// 100 000 configurations of a 7R arm.
fn comparison(times: usize) {
    let (_, file, tip) = ROBOTS[1];
    let drawn = chain(file, tip);
    let built = moved_axes(&drawn);
    let sides = (Subject::Chain { file: "drawn", chain: &drawn }, Subject::Chain { file: "built", chain: &built });
    let options = Options { samples: 100_000, ..Options::default() };
    (0..times).for_each(|_| _ = black_box(compare(&sides.0, &sides.1, &options)));
}

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    // Cargo also starts this with its own options, when it runs every benchmark.
    let [_, what, times] = arguments.as_slice() else { return };
    let work = WORK.iter().find(|(name, _)| name == what);
    if let (Some((_, work)), Ok(times)) = (work, times.parse()) {
        work(times);
    }
}
