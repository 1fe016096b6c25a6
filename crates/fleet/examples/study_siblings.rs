//! Accuracy of a calibration from a few poses, without and with the prior from sibling robots.
//!
//! A simulated fleet: UR5e arms of one series with shared casting errors, batch errors, individual errors, and zeros set by
//! hand. Fifty are measured at forty positions; their common part is the prior of twenty others. Then real Pandas, with a
//! ball in sockets: the prior comes from three, few rows of the fourth are fitted and other placements of it are the test.
//!
//! `cargo run --release -p denavit-fleet --example study_siblings [-- SOCKETS]` prints the tables of docs/fleet.md. SOCKETS: folder of
//! the measurements of platonics-delft/kinematics_calibration, a folder for each arm.

#![allow(clippy::print_stdout)] // A study prints its table.
#![allow(clippy::unwrap_used, clippy::cast_possible_truncation)]

use denavit_calibrate::calibration::{CalibrateOptions, Calibration, calibrate};
use denavit_calibrate::{Freedom, IdentifyOptions, Measurements, Tolerances};
use denavit_fleet::siblings::{Learned, Sibling};
use denavit_identify::arm::{Arm, AxisBasis};
use denavit_identify::effects::driver::Statics;
use denavit_identify::parameters::Layout;
use denavit_identify::parameters::NoEffects;
use denavit_identify::parameters::ParameterKind;
use denavit_identify::posterior::Earlier;
use denavit_identify::prior::{SourceKind, sources};
use denavit_identify::residual_statistics::{errors, placed, residuals};
use denavit_identify::simulate::{SimulationOptions, simulate, simulate_arm};
use denavit_linear::threads::{on_this_thread, par_map};
use denavit_load::Selection;
use denavit_measurements::Scene;
use denavit_measurements::{Units, read_socket};
use denavit_model::Chain;
use denavit_model::nalgebra::DVector;
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;
use std::path::Path;

const POSES: [usize; 6] = [4, 6, 8, 12, 20, 40];
const LEARNED_FROM: u64 = 50;
const JUDGED: u64 = 20;
const HELD_OUT: usize = 100;
/// Standard deviations of the errors of the series, of a robot, and of each of two batches, as fractions of 1 mrad and
/// 1 mm; of the zeros, rad.
const SERIES: f64 = 0.5;
const OWN: f64 = 0.1;
const BATCH: f64 = 0.2;
const ZERO: f64 = 5e-4;

struct Series {
    chain: Chain,
    statics: Statics,
    /// Changes of the parameters common to all, of each batch, and by each individual error of a robot.
    common: DVector<f64>,
    batches: [DVector<f64>; 2],
    own: Vec<DVector<f64>>,
    kinds: Vec<ParameterKind>,
}

impl Series {
    fn new() -> Self {
        let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../robots/universal_robots/ur5e.urdf");
        let (chain, statics) = loaded(file, None);
        let (freedom, tolerances) = (Freedom::axes(chain.joints().len()), Tolerances::default());
        let layout = Layout::new(&chain, &Scene::default(), &freedom, &tolerances, Vec::new());
        let parameters = &layout.parameters[layout.joints.clone()];
        let unit = DVector::from_fn(parameters.len(), |k, _| parameters[k].tolerance.unwrap());
        let mut random = ChaCha8Rng::seed_from_u64(2026);
        let all = sources(&chain, parameters, &layout.bases, &layout.frames, &tolerances);
        let mut drawn = |size: f64| {
            let links = all.iter().filter(|source| source.of != SourceKind::Zero);
            let sum = links.map(|source| &source.moved * (size * random.sample::<f64, _>(StandardNormal)));
            sum.fold(DVector::zeros(parameters.len()), |sum, part| sum + part).component_mul(&unit)
        };
        let (common, batches) = (drawn(SERIES), [drawn(BATCH), drawn(BATCH)]);
        let size = |of: SourceKind| if of == SourceKind::Zero { ZERO / tolerances.zero_turn } else { OWN };
        let own = all.iter().map(|source| (&source.moved * size(source.of)).component_mul(&unit)).collect();
        let kinds = parameters.iter().map(|parameter| parameter.kind).collect();
        Self { chain, statics, common, batches, own, kinds }
    }

    /// A robot of the series; `knocked`: error of its third joint's zero.
    fn robot(&self, serial: u64, knocked: f64) -> Arm {
        let mut random = ChaCha8Rng::seed_from_u64(serial);
        let mut change = self.common.clone();
        for moved in self.batches.iter().chain(&self.own) {
            change += moved * random.sample::<f64, _>(StandardNormal);
        }
        let zero = self.own.len() / self.chain.joints().len();
        change += &self.own[3 * zero - 1] * (knocked / ZERO);
        // Poses of instrument and target.
        let drawn = SimulationOptions { rows: 1, seed: serial, turn: 0.0, shift: 0.0, ..SimulationOptions::default() };
        let mut arm = simulate(&self.chain, &drawn, &NoEffects).arm;
        for (index, joint) in self.chain.joints().iter().enumerate() {
            let (mut turned, mut moved) = ([0.0; 2], [0.0; 2]);
            for (kind, change) in self.kinds.iter().zip(change.iter()) {
                match *kind {
                    ParameterKind::Turn { joint, direction } if joint == index => turned[direction] = *change,
                    ParameterKind::Move { joint, direction } if joint == index => moved[direction] = *change,
                    _ => {}
                }
            }
            arm.change_axis(index, &AxisBasis::of(&joint.screw), turned, moved, 0.0);
        }
        arm
    }

    fn sibling(&self, serial: u64) -> Sibling {
        let data = measured(&self.robot(serial, 0.0), 40, 1000 + serial);
        let found = fitted(&self.chain, &self.statics, data, None, None);
        Sibling::of(&format!("{serial:03}"), &self.chain, found.information.unwrap())
    }

    /// Square of the held-out error without the prior and with it, and the prior's weight.
    fn judged(&self, serial: u64, knocked: f64, poses: usize, prior: &Earlier) -> [f64; 3] {
        let arm = self.robot(serial, knocked);
        let data = measured(&arm, poses, 2000 + serial);
        let test = measured(&arm, HELD_OUT, 3000 + serial);
        let alone = fitted(&self.chain, &self.statics, data.clone(), Some(test.clone()), None);
        let with = fitted(&self.chain, &self.statics, data, Some(test), Some(prior.clone()));
        [square(&alone), square(&with), with.report.earlier.as_ref().unwrap().weight]
    }
}

fn measured(arm: &Arm, rows: usize, seed: u64) -> Measurements {
    simulate_arm(arm, &SimulationOptions { rows, seed, ..SimulationOptions::default() }, &NoEffects).data
}

fn loaded(file: &str, tip: Option<&str>) -> (Chain, Statics) {
    let loaded = denavit_load::load(file, &denavit_load::Options::default()).unwrap().robot;
    let selection = Selection { file, tip, ..Selection::default() };
    let chain = loaded.chain(&selection).unwrap().value;
    let statics = loaded.statics(&chain, selection.reading);
    (chain, statics)
}

fn fitted(
    chain: &Chain,
    statics: &Statics,
    data: Measurements,
    test: Option<Measurements>,
    earlier: Option<Earlier>,
) -> Calibration {
    let identify = IdentifyOptions { earlier, ..IdentifyOptions::axes(chain) };
    let options = CalibrateOptions { identify, ..CalibrateOptions::geometry(chain) };
    on_this_thread(|| calibrate(chain, statics, data, test, &options)).unwrap_or_else(|error| panic!("{error}"))
}

/// Error of the geometric stage on held-out rows.
fn square(found: &Calibration) -> f64 {
    let stage = found.report.stages.iter().find(|stage| stage.name == "geometric").unwrap();
    stage.test.as_ref().unwrap().of("position").unwrap().rms.powi(2)
}

fn on_all_cores<T: Send>(count: u64, work: impl Fn(u64) -> T + Sync) -> Vec<T> {
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    par_map(0..count, threads, || (), |(), index| work(index))
}

/// Root of the mean square, mm.
fn rms(squares: impl Iterator<Item = f64>) -> f64 {
    let squares: Vec<f64> = squares.collect();
    1e3 * (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
}

fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_unstable_by(f64::total_cmp);
    f64::midpoint(values[(values.len() - 1) / 2], values[values.len() / 2])
}

fn main() {
    let series = Series::new();
    let siblings = on_all_cores(LEARNED_FROM, |serial| series.sibling(serial));
    let learned = Learned::of(&series.chain, &siblings).unwrap();
    let shares: Vec<String> = learned.population.factors.iter().map(|factor| format!("{factor:.3}")).collect();
    println!("spread over the drawing's (turn, shift, zero): {}", shares.join(", "));
    println!("the drawing's pattern counts as {} robots", learned.population.counts_as);
    let prior = learned.prior(None).unwrap();
    println!(
        "\n| poses | alone: rms, median mm | with {LEARNED_FROM} siblings | weight, mean |\n|---:|---:|---:|---:|"
    );
    for poses in POSES {
        let found = on_all_cores(JUDGED, |robot| series.judged(5000 + robot, 0.0, poses, &prior));
        row(&poses.to_string(), &found);
    }
    println!("\n| 8 poses, siblings | alone | with them | weight, mean |\n|---:|---:|---:|---:|");
    for count in [3, 5, 10, 20] {
        let prior = Learned::of(&series.chain, &siblings[..count]).unwrap().prior(None).unwrap();
        let found = on_all_cores(JUDGED, |robot| series.judged(5000 + robot, 0.0, 8, &prior));
        row(&count.to_string(), &found);
    }
    println!("\n| elbow's zero off by 20 mrad, poses | alone | with {LEARNED_FROM} siblings | weight, mean |");
    println!("|---:|---:|---:|---:|");
    for poses in [8, 12, 20] {
        let found = on_all_cores(JUDGED, |robot| series.judged(5000 + robot, 0.02, poses, &prior));
        row(&poses.to_string(), &found);
    }
    if let Some(folder) = std::env::args().nth(1) {
        pandas(Path::new(&folder));
    }
}

fn row(name: &str, found: &[[f64; 3]]) {
    let of = |k: usize| (rms(found.iter().map(|of| of[k])), 1e3 * median(found.iter().map(|of| of[k])).sqrt());
    let ((alone, alone_median), (with, with_median)) = (of(0), of(1));
    let weight = found.iter().map(|of| of[2]).sum::<f64>() / found.len() as f64;
    println!("| {name} | {alone:.3}, {alone_median:.3} | {with:.3}, {with_median:.3} | {weight:.2} |");
}

/// Arms, and their test placements.
const PANDAS: [(&str, &[&str]); 4] = [
    ("panda_1", &["right"]),
    ("panda_2", &["high", "mid-high", "mid_left"]),
    ("panda_3", &["backcenter", "frontright"]),
    ("panda_4", &["very-front"]),
];
/// Rows of each socket that are fitted; all of the placements.
const OF_SOCKET: [usize; 4] = [3, 6, 12, 100];

fn pandas(folder: &Path) {
    let (chain, statics) =
        loaded(concat!(env!("CARGO_MANIFEST_DIR"), "/../../robots/franka/panda.urdf"), Some("panda_link8"));
    let arms: Vec<(Measurements, Measurements)> =
        PANDAS.iter().map(|(arm, held)| sockets(&chain, &folder.join(arm), held)).collect();
    let siblings: Vec<Sibling> = PANDAS
        .iter()
        .zip(&arms)
        .map(|((arm, _), (train, _))| {
            let found = fitted(&chain, &statics, train.clone(), None, None);
            Sibling::of(arm, &chain, found.information.unwrap())
        })
        .collect();
    println!(
        "\n| Panda, placements | rows of each socket | alone, mm | with three siblings | weight |\n|---|---:|---:|---:|---:|"
    );
    for (left_out, (arm, _)) in PANDAS.iter().enumerate() {
        let others: Vec<Sibling> =
            siblings.iter().enumerate().filter(|(index, _)| *index != left_out).map(|(_, one)| one.clone()).collect();
        let prior = Learned::of(&chain, &others).and_then(|learned| learned.prior(None)).unwrap();
        let (train, test) = &arms[left_out];
        let labels = train.scene.points.len() / 2;
        for placements in [1, labels] {
            for rows in OF_SOCKET {
                let few = some(train, placements, rows);
                let alone = fitted(&chain, &statics, few.clone(), None, None);
                let with = fitted(&chain, &statics, few.clone(), None, Some(prior.clone()));
                let spread = |found: &Calibration| {
                    let Ok(arm) = placed(&found.identification.geometric, &few, test) else { return f64::NAN };
                    1e3 * errors(&residuals(&arm, &NoEffects, test), &test.scene).of("spread").unwrap().rms
                };
                println!(
                    "| {arm}, {placements} | {rows} | {:.3} | {:.3} | {:.2} |",
                    spread(&alone),
                    spread(&with),
                    with.report.earlier.as_ref().unwrap().weight
                );
            }
        }
    }
}

/// Rows of an arm to fit, and those of the test placements.
fn sockets(chain: &Chain, folder: &Path, held: &[&str]) -> (Measurements, Measurements) {
    let mut placements: Vec<_> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    placements.sort();
    let part = |placement: &std::path::PathBuf, hole: u8| {
        let label = format!("{}/{hole}", placement.file_name().unwrap().to_string_lossy());
        let file = std::fs::File::open(placement.join(format!("hole_{hole}.csv"))).unwrap();
        read_socket(&label, file, &label, chain, Units::default()).unwrap()
    };
    let parts = placements.iter().flat_map(|placement| [part(placement, 0), part(placement, 1)]).collect();
    let mut all = Measurements::joined(parts).unwrap();
    all.scene.know_length(["*/0", "*/1"], 0.05, 5e-5);
    all.apart(&held.iter().map(|name| (*name).to_owned()).collect::<Vec<_>>()).unwrap()
}

/// The first placements, and evenly spaced rows of each socket.
fn some(data: &Measurements, placements: usize, rows: usize) -> Measurements {
    let mut names: Vec<String> = data.scene.points.iter().filter_map(|point| placement_of(point)).collect();
    names.dedup();
    let others = names.split_off(placements);
    let few = if others.is_empty() { data.clone() } else { data.apart(&others).unwrap().0 };
    let mut of_point: Vec<Vec<usize>> = vec![Vec::new(); few.scene.points.len()];
    for row in 0..few.len() {
        let point = few.of_row(row).next().and_then(|at| few.series_of(at).point);
        of_point[point.unwrap()].push(row);
    }
    let spaced = |own: Vec<usize>| {
        let count = rows.min(own.len());
        (0..count).map(|k| own[k * own.len() / count]).collect::<Vec<_>>()
    };
    let mut chosen: Vec<usize> = of_point.into_iter().flat_map(spaced).collect();
    chosen.sort_unstable();
    few.subset(&chosen)
}

/// `front` of `socket front/0`.
fn placement_of(point: &str) -> Option<String> {
    let (placement, _) = point.rsplit_once('/')?;
    Some(placement.rsplit(' ').next().unwrap_or(placement).to_owned())
}
