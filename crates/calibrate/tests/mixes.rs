//! Several kinds, setups and files in one fit.

#![allow(clippy::unwrap_used, clippy::print_stdout)] // Tests: a panic is a failure, what is printed is read.

use crate::measured::measured;
use denavit_calibrate::calibration::{CalibrateOptions, Calibration, calibrate};
use denavit_calibrate::{Arm, Freedom, IdentifyOptions, Tolerances};
use denavit_identify::effects::driver::Statics;
use denavit_identify::identifiability::identifiability;
use denavit_identify::identify;
use denavit_identify::parameters::Layout;
use denavit_identify::parameters::NoEffects;
use denavit_identify::residual::ResidualModel;
use denavit_identify::residual::Scratch;
use denavit_identify::residual_statistics::lengths_found;
use denavit_identify::simulate::{SimulationOptions, simulate, simulate_arm};
use denavit_measurements::kinds::ObservationKind;
use denavit_measurements::{Measurements, Units, read, read_socket, write};
use denavit_model::nalgebra::{Matrix3, Vector3};
use denavit_model::tree::Reading;
use denavit_model::{Chain, examples, urdf};

/// The same robot measured in another kind; `rows` of it.
fn measured_as(arm: &Arm, kind: denavit_measurements::kinds::ObservationKind, rows: usize, noise: f64) -> Measurements {
    let chain = &arm.nominal;
    let own = simulate(chain, &SimulationOptions { kind, rows, seed: 3, ..Default::default() }, &NoEffects).arm;
    let arm = Arm { joints: arm.joints.clone(), ..own };
    let options = SimulationOptions {
        kind,
        rows,
        seed: 11,
        noise_position: noise,
        noise_orientation: noise,
        ..Default::default()
    };
    simulate_arm(&arm, &options, &NoEffects).data
}

/// Largest error of the tip beside the truth over some readings, targets and frames aside, m.
fn tip_error(found: &Arm, truth: &Arm) -> f64 {
    // Both measured in poses; the fitted robot must explain them with a frame and a target of its own.
    let test = measured_as(truth, ObservationKind::Pose, 60, 0.0);
    let freedom = IdentifyOptions { freedom: Freedom::placement(found.joints.len()), ..options(&found.nominal) };
    let fit = identify(&found.chain(), &test, &freedom).nominal;
    fit.squares.iter().map(|square| square[0].sqrt()).fold(0.0, f64::max)
}

fn options(chain: &Chain) -> IdentifyOptions {
    IdentifyOptions::axes(chain)
}

#[test]
fn poses_positions_and_distances_of_two_setups_are_one_fit() {
    let chain = examples::puma_like();
    let truth =
        simulate(&chain, &SimulationOptions { kind: ObservationKind::Pose, rows: 3, ..Default::default() }, &NoEffects)
            .arm;
    for noise in [0.0, 5e-5] {
        let part = |kind, rows, name: &str| measured_as(&truth, kind, rows, noise).of_setup(name);
        let parts = vec![
            part(ObservationKind::Pose, 20, "july"),
            part(ObservationKind::Position, 30, "october"),
            part(ObservationKind::Distance, 60, "wire"),
        ];
        let data = Measurements::joined(parts).unwrap();
        assert_eq!(data.scene.measured(), "pose+position+distance");
        assert_eq!((data.scene.setups.len(), data.scene.targets.len(), data.scene.points.len()), (3, 3, 1));
        let found = identify(&chain, &data, &options(&chain)).geometric;
        let error = tip_error(&found.arm, &truth);
        println!("noise {noise}: {error:.2e} m after {} steps, levels {:?}", found.iterations, found.noise.levels);
        assert!(error < if noise == 0.0 { 1e-11 } else { 2e-4 }, "{error}");
        if noise > 0.0 {
            assert!(found.noise.levels.iter().all(|level| (level / noise - 1.0).abs() < 0.4), "{:?}", found.noise);
        }
        let known = identifiability(&data, &found.arm, &NoEffects, &Freedom::axes(6));
        assert_eq!(known.rank, known.expected, "{}", known.formula);
    }
}

/// A scene with everything in it, written as a file: two setups, anchors and sockets by label, standard deviations.
const MIXED: &str = "\
joint_1,joint_2,x,y,z,distance,setup,anchor,socket,std
0.1,0.2,1.0,0.1,0.2,0.9,a,wall,,0.001
0.3,0.4,1.1,0.2,0.2,,a,,,0.002
0.5,0.6,,,,0.8,b,floor,,0.001
0.7,0.8,,,,,b,,0,0.001
0.9,1.1,1.2,0.1,0.1,,b,,1,0.004
";

#[test]
fn setups_anchors_sockets_and_deviations_are_read_and_written() {
    let chain = examples::planar_arm();
    let data = read("m.csv", MIXED.as_bytes(), &chain, Units::default()).unwrap().data;
    assert_eq!(data.scene.setups, ["a", "b"]);
    assert_eq!(data.scene.points, ["anchor a/wall", "anchor b/floor", "socket b/0", "socket b/1"]);
    assert_eq!(data.scene.targets, ["@a", "@b", "ball"]);
    assert_eq!((0..data.len()).map(|row| data.of_row(row).len()).collect::<Vec<_>>(), [2, 1, 1, 1, 2]);
    // Of positions 1, 2 and 4 mm the usual is 2 mm: a deviation of 1 mm counts double.
    let first = *data.observed.level(0).unwrap();
    assert!((first - Matrix3::identity() * 2.0).norm() < 1e-12, "{first}");
    let again = read("m.csv", write(&data, &[]).as_bytes(), &chain, Units::default()).unwrap().data;
    assert_eq!((again.scene, again.readings), (data.scene.clone(), data.readings.clone()));
}

#[test]
fn every_kind_and_every_setup_has_the_right_derivatives() {
    let chain = examples::planar_arm();
    let mut data = read("m.csv", MIXED.as_bytes(), &chain, Units::default()).unwrap().data;
    assert_eq!(data.scene.know_length(["*/0", "*/1"], 0.05, 1e-3), 1);
    // Axes of an ellipsoid that are none of the frame's.
    let skew = Matrix3::new(1.0, 0.2, -0.1, 0.0, 2.0, 0.3, 0.1, 0.0, 0.5);
    data.observed.set_levels(vec![skew; data.observations()]);
    let freedom = Freedom { scales: vec![true; 2], pitches: vec![true; 2], ..Freedom::axes(2) };
    let layout = Layout::new(&chain, &data.scene, &freedom, &Tolerances::default(), Vec::new());
    let away: Vec<f64> = (0..layout.len()).map(|k| 0.02 * ((k * 7 % 11) as f64 - 5.0)).collect();
    let arm = layout.stepped(&Arm::new(&chain, &data.scene), &away);
    let problem = ResidualModel { data: &data, layout: &layout, effects: &NoEffects };
    let columns = layout.len();
    let lengths = |arm: &Arm| layout.known_lengths(&data.scene, arm)[0].clone();
    for row in 0..data.len() {
        let rows = problem.height_of(row);
        let residual = |arm: &Arm| {
            let mut residual = vec![0.0; rows];
            problem.row_into(arm, row, &mut Scratch::new(&layout, arm), &mut residual, None);
            residual
        };
        let mut jacobian = vec![0.0; rows * columns];
        let mut scratch = Scratch::new(&layout, &arm);
        problem.row_into(&arm, row, &mut scratch, &mut vec![0.0; rows], Some(&mut jacobian));
        for column in 0..columns {
            let moved = |h: f64| {
                let mut step = vec![0.0; columns];
                step[column] = h;
                layout.stepped(&arm, &step)
            };
            let (plus, minus) = (moved(1e-5), moved(-1e-5));
            for (k, (a, b)) in residual(&plus).iter().zip(residual(&minus)).enumerate() {
                let difference = (a - b) / 2e-5 - jacobian[k * columns + column];
                assert!(difference.abs() < 1e-8, "row {row} {}: {difference:e}", layout.parameters[column].name);
            }
            let known = lengths(&arm).columns.iter().filter(|own| own.0 == column).map(|own| own.1).sum::<f64>();
            let difference = (lengths(&plus).residual - lengths(&minus).residual) / 2e-5 - known;
            assert!(difference.abs() < 1e-4, "{}: {difference:e}", layout.parameters[column].name);
        }
    }
}

#[test]
fn a_row_that_is_said_to_be_bad_counts_for_little() {
    let chain = examples::puma_like();
    let options = SimulationOptions { kind: ObservationKind::Position, rows: 120, ..Default::default() };
    let run = simulate(&chain, &options, &NoEffects);
    let (mut plain, truth) = (run.data, run.arm);
    // Every third row is 20 times as noisy.
    let mut levels = vec![Matrix3::identity(); 120];
    for row in (0..120).step_by(3) {
        let values = plain.observed.values_mut(row);
        (0..3).for_each(|k| values[k] += 1e-3 * ((row * 31 + k * 17) as f64).sin());
        levels[row] = Matrix3::identity() * (5e-5 / 7e-4);
    }
    let mut weighed = plain.clone();
    weighed.observed.set_levels(levels);
    let fit = |data: &Measurements| {
        let options = IdentifyOptions {
            fit: denavit_calibrate::FitOptions { robust: false, ..Default::default() },
            ..IdentifyOptions::axes(&chain)
        };
        tip_error(&identify(&chain, data, &options).geometric.arm, &truth)
    };
    let (without, with) = (fit(&plain), fit(&weighed));
    println!("largest error of the tip: {without:.2e} m without, {with:.2e} m with standard deviations");
    assert!(with < 0.5 * without, "{with} {without}");
}

/// Readings in the sockets of one arm of ../shared, a label for each file.
fn sockets(chain: &Chain, arm: &str) -> Option<Measurements> {
    let folder = measured(&format!("sockets/{arm}"))?;
    let mut placements: Vec<_> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    placements.sort();
    let mut parts = Vec::new();
    for placement in placements {
        for hole in [0, 1] {
            let label = format!("{}/{hole}", placement.file_name().unwrap().to_string_lossy());
            let file = std::fs::File::open(placement.join(format!("hole_{hole}.csv"))).unwrap();
            parts.push(read_socket(&label, file, &label, chain, Units::default()).unwrap());
        }
    }
    Measurements::joined(parts)
}

#[test]
fn a_ball_in_sockets_calibrates_four_pandas_on_placements_that_no_fit_has_seen() {
    let robot = include_str!("../../../robots/franka/panda.urdf");
    let robot = denavit_model::urdf::read("panda.urdf", robot).unwrap();
    let chain = robot.chain(None, Some("panda_link8"), denavit_model::Reading::default()).unwrap().value;
    for (arm, held, nominal, most) in [
        ("panda_1", ["right", ""], 8.95, 0.79),
        ("panda_2", ["high", "mid-high,mid_left"], 7.95, 0.73),
        ("panda_3", ["backcenter", "frontright"], 3.18, 0.23),
        ("panda_4", ["very-front", ""], 4.21, 0.26),
    ] {
        let Some(mut data) = sockets(&chain, arm) else { return };
        assert!(
            data.scene.know_length(["*/0", "*/1"], 0.05, 5e-5) > 2 && data.scene.kinds() == [ObservationKind::Socket]
        );
        let held: Vec<String> =
            held.iter().flat_map(|names| names.split(',')).filter(|name| !name.is_empty()).map(String::from).collect();
        let (train, test) = data.apart(&held).unwrap();
        let found = identify(&chain, &train, &options(&chain));
        let spread = |fit| {
            let arm = denavit_identify::residual_statistics::placed(fit, &train, &test).unwrap();
            let all = denavit_identify::residual_statistics::residuals(&arm, &NoEffects, &test);
            let off = lengths_found(&arm, &NoEffects, &test)
                .iter()
                .map(|length| (length.found_m - length.known_m).abs() * 1e3)
                .fold(0.0, f64::max);
            (denavit_identify::residual_statistics::errors(&all, &test.scene).of("spread").unwrap().rms * 1e3, off)
        };
        let (before, (after, off)) = (spread(&found.nominal).0, spread(&found.geometric));
        println!("{arm}: spread held out {before:.3} -> {after:.3} mm, 50 mm off by up to {off:.3} mm");
        assert!((before - nominal).abs() < 0.15 && after < most + 0.02 && off < 0.5, "{arm}");
    }
}

#[test]
fn sockets_without_a_known_distance_say_that_only_tolerances_hold_the_size() {
    let robot = include_str!("../../../robots/franka/panda.urdf");
    let robot = denavit_model::urdf::read("panda.urdf", robot).unwrap();
    let chain = robot.chain(None, Some("panda_link8"), denavit_model::Reading::default()).unwrap().value;
    let Some(mut data) = sockets(&chain, "panda_4") else { return };
    let says = |data: &Measurements| {
        let options = CalibrateOptions::geometry(&chain);
        let found = calibrate(&chain, &Statics::of_chain(&chain), data.clone(), None, &options).unwrap();
        denavit_calibrate::report::text::calibration(&found).contains("size: the measurements contain no length")
    };
    assert!(says(&data));
    data.scene.know_length(["*/0", "*/1"], 0.05, 5e-5);
    assert!(!says(&data));
}

#[test]
fn sockets_and_a_known_distance_tell_the_whole_robot() {
    let chain = examples::puma_like();
    let part = |seed: u64, label: &str| {
        let readings = denavit_identify::simulate::readings(&chain, 40, seed);
        let line = |row: &Vec<f64>| row.iter().map(f64::to_string).collect::<Vec<_>>().join(",") + "\n";
        let text: String = readings.iter().map(line).collect();
        read_socket("s.csv", text.as_bytes(), label, &chain, Units::default()).unwrap()
    };
    let mut data = Measurements::joined(vec![part(1, "a/0"), part(2, "a/1"), part(3, "b/0")]).unwrap();
    assert_eq!(data.scene.know_length(["a/0", "a/1"], 0.05, 1e-4), 1);
    let mut arm = Arm::new(&chain, &data.scene);
    arm.targets[0].translation.vector = Vector3::new(0.05, 0.02, 0.1);
    arm.points = vec![Vector3::new(0.5, 0.1, 0.3), Vector3::new(0.5, 0.15, 0.3), Vector3::new(0.1, 0.5, 0.4)];
    let found = identifiability(&data, &arm, &NoEffects, &Freedom::axes(6));
    // Six joints of four, three for the ball, nine for the sockets, less the frame that nobody sees.
    assert_eq!((found.rank, found.expected), (30, 30), "{}", found.formula);
}

/// Position rms of the held-out rows of one setup, m.
fn held_out_rms(result: &Calibration, setup: &str) -> f64 {
    let test = result.test.as_ref().unwrap();
    let own: Vec<f64> = result.residuals()[1]
        .test
        .iter()
        .filter(|residual| test.scene.setups[test.scene.series[residual.series].setup] == setup)
        .map(|residual| residual.place.norm_squared())
        .collect();
    assert!(own.len() > 100, "{} rows of {setup}", own.len());
    (own.iter().sum::<f64>() / own.len() as f64).sqrt()
}

/// One robot, measured in July and in October with the tracker and its target mounted anew: one fit of both is as good for
/// each as a fit of its own.
#[test]
fn two_campaigns_of_one_arm_share_the_arm_alone() {
    let drawn = include_str!("../../../robots/universal_robots/ur10.urdf");
    let chain = urdf::read("ur10.urdf", drawn).unwrap().chain(None, None, Reading::default()).unwrap().value;
    let thinned = |file: &str, setup: &str, every: usize| -> Option<[Measurements; 2]> {
        let path = measured(&format!("ipa_ur10/{file}.csv"))?;
        let data = read(file, std::fs::File::open(path).unwrap(), &chain, Units::default()).unwrap().data;
        let rows = |from: usize| (from..data.len()).step_by(every).collect::<Vec<_>>();
        Some([rows(0), rows(every / 2)].map(|rows| data.subset(&rows).of_setup(setup)))
    };
    let (Some([july, july_test]), Some([october, october_test])) =
        (thinned("grid", "july", 20), thinned("joint_configurations", "october", 3))
    else {
        return;
    };
    let options = CalibrateOptions::geometry(&chain);
    let statics = Statics::of_chain(&chain);
    let fit = |train: Measurements, test: Measurements| {
        calibrate(&chain, &statics, train, Some(test), &options).unwrap_or_else(|error| panic!("{error}"))
    };
    let both = Measurements::joined(vec![july.clone(), october.clone()]).unwrap();
    assert_eq!(both.scene.setups, ["july", "october"]);
    let both = fit(both, Measurements::joined(vec![july_test.clone(), october_test.clone()]).unwrap());
    for (setup, train, test) in [("july", july, july_test), ("october", october, october_test)] {
        let (alone, together) = (held_out_rms(&fit(train, test), setup), held_out_rms(&both, setup));
        println!("{setup}: {:.3} mm alone, {:.3} mm in one fit with the other", alone * 1e3, together * 1e3);
        assert!(together < 1.1 * alone, "{setup}: {together} against {alone}");
    }
}
