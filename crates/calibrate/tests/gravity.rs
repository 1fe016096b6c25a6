//! Accelerometers and inclinometers: what the direction of gravity tells of an arm, files, and one fit with a tracker.

use crate::webcam::{derivatives, efficiency_of, panda};
use denavit_calibrate::calibration::{CalibrateOptions, calibrate};
use denavit_calibrate::report::text;
use denavit_calibrate::{Arm, Freedom, IdentifyOptions, Measurements};
use denavit_identify::effects::Statics;
use denavit_identify::identifiability::identifiability;
use denavit_identify::identify;
use denavit_identify::parameters::NoEffects;
use denavit_identify::residual_statistics::residuals;
use denavit_identify::simulate::{SimulationOptions, simulate, simulate_arm};
use denavit_identify::solve::Fit;
use denavit_measurements::import::ImportOptions;
use denavit_measurements::kinds::ObservationKind;
use denavit_measurements::{Units, read, read_export, write};
use denavit_model::{Chain, Reading, examples, urdf};
use std::fmt::Write as _;
use std::sync::Arc;

/// Noise of a sensor, rad.
const NOISE: f64 = 2e-4;

fn options(kind: ObservationKind, rows: usize, seed: u64) -> SimulationOptions {
    SimulationOptions { kind, rows, seed, noise_orientation: NOISE, ..SimulationOptions::default() }
}

fn fitted(chain: &Chain, data: &Measurements) -> Fit<NoEffects> {
    identify(chain, data, &IdentifyOptions::axes(chain)).geometric
}

#[test]
fn without_noise_nothing_is_left_and_the_rank_is_what_directions_tell() {
    for chain in [examples::puma_like(), panda()] {
        for kind in [ObservationKind::Gravity, ObservationKind::Inclination] {
            let run =
                simulate(&chain, &SimulationOptions { noise_orientation: 0.0, ..options(kind, 80, 1) }, &NoEffects);
            let fit = fitted(&chain, &run.data);
            let left = fit.squares.iter().map(|square| square[0].sqrt()).fold(0.0, f64::max);
            let known = identifiability(&run.data, &fit.arm, &NoEffects, &Freedom::axes(chain.joints().len()));
            println!(
                "{} {kind:?}: {left:.1e} rad; {} of {} = {}",
                chain.name(),
                known.rank,
                known.expected,
                known.formula
            );
            assert!(fit.converged_or_exact() && left < 1e-9, "{} {kind:?}: {left:e}", chain.name());
            assert_eq!(known.expected, 2 * chain.joints().len() + 2);
            assert!(known.rank <= known.expected && known.rank + 2 >= known.expected);
        }
    }
}

#[test]
fn directions_of_gravity_tell_what_their_noise_allows() {
    for kind in [ObservationKind::Gravity, ObservationKind::Inclination] {
        let ratio = efficiency_of(&panda(), &options(kind, 100, 0), |_, options| options.noise_orientation, 0..60);
        println!("{kind:?}: error over the bound {ratio:.3}");
        assert!((0.95..1.05).contains(&ratio), "{kind:?}: {ratio}");
    }
}

#[test]
fn intervals_of_predicted_directions_hold_the_truth() {
    let chain = panda();
    for kind in [ObservationKind::Gravity, ObservationKind::Inclination] {
        let (mut inside, mut all) = (0.0, 0.0);
        for seed in 0..30 {
            let run = simulate(&chain, &options(kind, 60, seed), &NoEffects);
            let fit = fitted(&chain, &run.data);
            let exact = SimulationOptions { noise_orientation: 0.0, ..options(kind, 40, 1000 + seed) };
            let later = simulate_arm(&run.arm, &exact, &NoEffects).data;
            let ahead = derivatives(&later, &fit.layout, &fit.arm);
            let variance = (&ahead * &fit.covariance).component_mul(&ahead).column_sum();
            let off = residuals(&fit.arm, &NoEffects, &later).into_iter().flat_map(|left| [left.place.x, left.place.y]);
            for (off, variance) in off.zip(variance.iter()) {
                inside += f64::from(u8::from(off.abs() < 1.96 * variance.sqrt()));
                all += 1.0;
            }
        }
        let share = inside / all;
        println!("{kind:?}: {share:.3} of the 95 % intervals hold the truth");
        assert!((0.92..0.98).contains(&share), "{kind:?}: {share}");
    }
}

#[test]
fn what_is_simulated_is_read_back_and_units_count() {
    let chain = panda();
    for kind in [ObservationKind::Gravity, ObservationKind::Inclination] {
        let run = simulate(&chain, &options(kind, 20, 2), &NoEffects);
        let back = read("g.csv", write(&run.data, &[]).as_bytes(), &chain, Units::default()).unwrap().data;
        assert_eq!((&back.readings, &back.scene), (&run.data.readings, &run.data.scene));
        for row in 0..20 {
            let pairs = back.observed.values(row).iter().zip(run.data.observed.values(row));
            assert!(pairs.clone().count() == kind.numbers() && pairs.into_iter().all(|(a, b)| (a - b).abs() < 1e-15));
        }
    }
    let text = write(&simulate(&chain, &options(ObservationKind::Inclination, 20, 2), &NoEffects).data, &[]);
    let degrees = |text: &str| {
        let mut lines = text.lines();
        let header = lines.next().unwrap().to_owned();
        let rows = lines.map(|line| {
            let cells = line.split(',').map(|cell| cell.parse::<f64>().unwrap().to_degrees().to_string());
            cells.collect::<Vec<_>>().join(",")
        });
        std::iter::once(header).chain(rows).collect::<Vec<_>>().join("\n")
    };
    let turned = degrees(&text);
    let back = read("g.csv", turned.as_bytes(), &chain, "m,deg".parse().unwrap()).unwrap().data;
    let own = read("g.csv", text.as_bytes(), &chain, Units::default()).unwrap().data;
    let off = (0..20).flat_map(|row| back.observed.values(row).iter().zip(own.observed.values(row)));
    assert!(off.into_iter().all(|(a, b)| (a - b).abs() < 1e-12));
}

#[test]
fn zeros_are_found_with_a_telephone_in_the_gripper() {
    // Of the two parallel axes of shoulder and elbow it sees the sum; the first joint's zero and the last one's are nobody's to tell.
    let chain = examples::puma_like();
    let zeros = [0.05, -0.04, 0.06, -0.03, 0.02, 0.01];
    let still = SimulationOptions { turn: 0.0, shift: 0.0, ..options(ObservationKind::Gravity, 40, 5) };
    let mut truth = simulate(&chain, &SimulationOptions { rows: 1, ..still.clone() }, &NoEffects).arm;
    zeros.iter().enumerate().for_each(|(joint, zero)| truth.shift_zero(joint, *zero));
    let data = simulate_arm(&truth, &still, &NoEffects).data;
    let all = IdentifyOptions::zeros(&chain, vec![true; 6]);
    let fit = identify(&chain, &data, &all).geometric;
    let found = fit.layout.difference(&fit.arm, &fit.arm);
    let determined: Vec<usize> = fit.layout.joints.clone().filter(|&k| fit.held_by_prior(k) < 0.5).collect();
    for &k in &determined {
        println!("{}: {:.5} ± {:.5}, {}", fit.layout.parameters[k].name, found[k], fit.deviation(k), zeros[k]);
        assert!((found[k] - zeros[k]).abs() < 5.0 * fit.deviation(k) && fit.deviation(k) < 5e-4);
    }
    assert_eq!(determined, [3, 4]);
    let variance = fit.covariance[(1, 1)] + fit.covariance[(2, 2)] + 2.0 * fit.covariance[(1, 2)];
    let off = found[1] + found[2] - zeros[1] - zeros[2];
    assert!(off.abs() < 5.0 * variance.sqrt() && variance.sqrt() < 5e-4, "{off} ± {}", variance.sqrt());
}

#[test]
fn a_tracker_and_an_accelerometer_are_one_fit() {
    let chain = panda();
    let tracker = SimulationOptions {
        kind: ObservationKind::Position,
        rows: 20,
        seed: 3,
        noise_position: 2e-4,
        ..Default::default()
    };
    let seen = simulate(&chain, &tracker, &NoEffects);
    let own = simulate(&chain, &options(ObservationKind::Gravity, 60, 4), &NoEffects).arm;
    let arm = Arm { joints: seen.arm.joints.clone(), ..own };
    let felt = simulate_arm(&arm, &options(ObservationKind::Gravity, 60, 4), &NoEffects).data;
    let alone = fitted(&chain, &seen.data);
    let data = Measurements::joined(vec![seen.data, felt]).unwrap();
    assert_eq!((data.scene.measured().as_str(), data.scene.targets.len()), ("position+gravity", 2));
    let both = fitted(&chain, &data);
    let spread = |fit: &Fit<NoEffects>| fit.layout.joints.clone().map(|k| fit.covariance[(k, k)]).sum::<f64>().sqrt();
    println!("levels {:?}, spread {:.2e} of {:.2e}", both.noise.levels, spread(&both), spread(&alone));
    assert!((both.noise.levels[0] / 2e-4 - 1.0).abs() < 0.35 && (both.noise.levels[1] / NOISE - 1.0).abs() < 0.2);
    assert!(spread(&both) < 0.9 * spread(&alone));
    let said = text::report(
        &calibrate(&chain, &Statics::of_chain(&chain), data, None, &CalibrateOptions::geometry(&chain)).unwrap(),
    );
    println!("{said}");
    for words in ["gravity in mrad", "from the vertical", "errors in mm"] {
        assert!(said.contains(words), "{words}");
    }
}

/// A sensor on the forearm and a tracker's target on the flange, rows of either.
#[test]
fn a_sensor_may_sit_on_any_link() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../robots/franka/panda.urdf");
    let robot = urdf::read("panda.urdf", &std::fs::read_to_string(path).unwrap()).unwrap();
    let chains =
        ["panda_link8", "panda_link5"].map(|tip| robot.chain(None, Some(tip), Reading::Intended).unwrap().value);
    let (chain, tips) = Chain::joined(&chains[0], &chains[1..]).unwrap();
    let tips = Arc::new(tips);
    let seen = simulate(&chains[0], &SimulationOptions { rows: 30, seed: 8, ..Default::default() }, &NoEffects);
    let own = simulate(&chains[1], &options(ObservationKind::Gravity, 30, 9), &NoEffects).arm;
    let arm = Arm { joints: seen.arm.joints[..own.joints.len()].to_vec(), ..own };
    let felt = simulate_arm(&arm, &options(ObservationKind::Gravity, 30, 9), &NoEffects).data;
    // As a user writes them: a row names its link; joints beyond it are left empty.
    let names: Vec<&str> = chain.coordinates().iter().map(|coordinate| coordinate.name.as_str()).collect();
    let mut text = format!("tip,{},x,y,z,gravity_x,gravity_y,gravity_z\n", names.join(","));
    let mut row = |tip: &str, q: &[f64], values: &[f64]| {
        let mut cells: Vec<String> = q.iter().map(f64::to_string).collect();
        cells.resize(names.len(), String::new());
        let values: Vec<String> = values.iter().map(f64::to_string).collect();
        let empty = vec![String::new(); 3];
        let ends = if tip == "panda_link8" { [values, empty] } else { [empty, values] };
        let _ = writeln!(text, "{tip},{},{},{}", cells.join(","), ends[0].join(","), ends[1].join(","));
    };
    for at in 0..30 {
        row("panda_link8", seen.data.reading(at), seen.data.observed.values(at));
        row("panda_link5", felt.reading(at), felt.observed.values(at));
    }
    let options = ImportOptions { tips: Some(tips), ..ImportOptions::default() };
    let data = read_export("both.csv", text.as_bytes(), &chain, Units::default(), &options).unwrap().data;
    let fit = fitted(&chain, &data);
    println!("{:?} {:?}", data.scene.targets, fit.noise.levels);
    assert_eq!(data.scene.targets, ["panda_link8", "panda_link5 accelerometer"]);
    assert!(fit.converged_or_exact() && (fit.noise.levels[1] / NOISE - 1.0).abs() < 0.35, "{:?}", fit.noise.levels);
}

#[test]
fn what_is_no_direction_is_said() {
    let chain = examples::puma_like();
    let names: Vec<&str> = chain.coordinates().iter().map(|coordinate| coordinate.name.as_str()).collect();
    let text = |columns: &str, cells: &[&str]| {
        let row = |cells: &&str| format!("{},{cells}\n", vec!["0.1"; names.len()].join(","));
        format!("{},{columns}\n{}", names.join(","), cells.iter().map(row).collect::<String>())
    };
    let said = |columns: &str, cells: &[&str]| {
        read("g.csv", text(columns, cells).as_bytes(), &chain, Units::default()).unwrap_err().to_string()
    };
    let found = said("gravity_x,gravity_y", &["0,1"]);
    assert!(found.contains("\"gravity_z\"") && !found.contains("no column holds"), "{found}");
    let found = said("gravity_x,gravity_y,gravity_z", &["0,0,0"]);
    assert!(found.starts_with("g.csv:2:") && found.contains("are all 0"), "{found}");
    let found = said("inclination_x,inclination_y", &["0.1,0.2", "30,2"]);
    assert!(found.starts_with("g.csv:3:") && found.contains("‹units› m,deg"), "{found}");
    let found = said("gravityx,gravity_y,gravity_z", &["0,0,1"]);
    assert!(found.contains("gravity_x"), "{found}");
    let uneven = text("gravity_x,gravity_y,gravity_z", &["0,0,9.8", "0,9.81,0", "0,0,11"]);
    let loaded = read("g.csv", uneven.as_bytes(), &chain, Units::default()).unwrap();
    let notes: Vec<String> = loaded.notes.iter().map(ToString::to_string).collect();
    assert!(notes.iter().any(|note| note.contains("lines 4") && note.contains("12.1 %")), "{notes:?}");
}
