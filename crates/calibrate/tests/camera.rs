//! A camera: derivatives, files, efficiency, and one fit with a tracker.

#![allow(clippy::unwrap_used, clippy::print_stdout)] // Tests: a panic is a failure, what is printed is read.

use crate::webcam::{efficiency, panda, webcam};
use denavit_calibrate::calibration::{CalibrateOptions, HoldOut, calibrate};
use denavit_calibrate::{Arm, Freedom, IdentifyOptions, Tolerances};
use denavit_identify::effects::driver::Statics;
use denavit_identify::identifiability::identifiability;
use denavit_identify::identify;
use denavit_identify::parameters::Layout;
use denavit_identify::parameters::NoEffects;
use denavit_identify::residual::ResidualModel;
use denavit_identify::residual::Scratch;
use denavit_identify::simulate::{SimulationOptions, simulate, simulate_arm};
use denavit_measurements::board::Sight;
use denavit_measurements::import::ImportOptions;
use denavit_measurements::kinds::ObservationKind;
use denavit_measurements::lens::{Distortion, Lens};
use denavit_measurements::{DataError, Loaded, Measurements, Units, read_export, write};
use denavit_model::examples;
use std::fmt::Write as _;

#[test]
fn derivatives_are_those_of_differences() {
    let lenses = [
        Distortion::Polynomial([-0.28, 0.07, 2e-4, -1e-3, 0.02, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]),
        Distortion::Polynomial([0.5, -0.2, 1e-3, 4e-4, 0.03, 0.7, -0.1, 0.01, 1e-3, -2e-3, 2e-3, 5e-4]),
        Distortion::Fisheye([0.04, -0.02, 0.01, -3e-3]),
    ];
    let mut worst: f64 = 0.0;
    for chain in [examples::puma_like(), examples::scara_helical()] {
        for (on_hand, distortion) in [false, true].into_iter().flat_map(|on_hand| lenses.map(|lens| (on_hand, lens))) {
            let mut options = SimulationOptions { rows: 3, turn: 0.02, shift: 0.02, ..webcam(on_hand) };
            options.sight.as_mut().unwrap().lens.distortion = distortion;
            let run = simulate(&chain, &options, &NoEffects);
            assert_eq!(run.data.len(), 3, "{} sees too little", chain.name());
            let n = chain.joints().len();
            let freedom =
                Freedom { axes: vec![true; n], scales: vec![true; n], pitches: vec![true; n], zeros: vec![true; n] };
            let layout = Layout::new(&chain, &run.data.scene, &freedom, &Tolerances::default(), Vec::new());
            let away: Vec<f64> = (0..layout.len()).map(|k| 0.002 * ((k * 7 % 11) as f64 - 5.0)).collect();
            let arm = layout.stepped(&run.arm, &away);
            let problem = ResidualModel { data: &run.data, layout: &layout, effects: &NoEffects };
            let columns = layout.len();
            let sums = problem.sums(&arm, &vec![1.0; run.data.observations()]);
            let mut gradient = vec![0.0; columns];
            for row in 0..run.data.len() {
                let height = problem.height_of(row);
                assert!(height >= 24);
                let (mut residual, mut jacobian) = (vec![0.0; height], vec![0.0; height * columns]);
                let mut scratch = Scratch::new(&layout, &arm);
                problem.row_into(&arm, row, &mut scratch, &mut residual, Some(&mut jacobian));
                for (line, left) in jacobian.chunks_exact(columns).zip(&residual) {
                    gradient.iter_mut().zip(line).for_each(|(sum, value)| *sum += value * left);
                }
                for column in 0..columns {
                    let h = 1e-6;
                    let at = |step: f64| {
                        let mut steps = vec![0.0; columns];
                        steps[column] = step;
                        let (arm, mut residual) = (layout.stepped(&arm, &steps), vec![0.0; height]);
                        problem.row_into(&arm, row, &mut Scratch::new(&layout, &arm), &mut residual, None);
                        residual
                    };
                    let (plus, minus) = (at(h), at(-h));
                    for k in 0..height {
                        let difference = (plus[k] - minus[k]) / (2.0 * h) - jacobian[k * columns + column];
                        let name = &layout.parameters[column].name;
                        assert!(difference.abs() < 1e-6, "{} {on_hand} {name}: {difference:e}", chain.name());
                        worst = worst.max(difference.abs());
                    }
                }
            }
            // The fit's own sums leave no column out.
            for (column, (sum, expected)) in sums.channels[0].gradient.iter().zip(&gradient).enumerate() {
                let name = &layout.parameters[column].name;
                assert!((sum - expected).abs() < 1e-9 * (1.0 + expected.abs()), "{name}: {sum} {expected}");
            }
        }
    }
    println!("largest difference {worst:e}");
}

#[test]
fn without_noise_the_robot_is_found() {
    for on_hand in [false, true] {
        let chain = panda();
        let options = SimulationOptions { noise_pixel: 0.0, rows: 40, ..webcam(on_hand) };
        let run = simulate(&chain, &options, &NoEffects);
        let found = identify(&chain, &run.data, &IdentifyOptions::axes(&chain)).geometric;
        let left = found.squares.iter().map(|square| square[0].sqrt()).fold(0.0, f64::max);
        println!("{on_hand}: largest residual {left:.1e} m, {} steps", found.iterations);
        assert!(found.converged && left < 1e-10, "{left}");
        let known = identifiability(&run.data, &found.arm, &NoEffects, &Freedom::axes(7));
        assert_eq!(known.rank, known.expected, "{}", known.formula);
    }
}

#[test]
fn a_webcam_tells_what_its_noise_allows() {
    // 0.2 px, 60 images of 24 corners; 1 is the Cramér-Rao bound. Ten runs tell it to some per cent: study_camera is long.
    for on_hand in [false, true] {
        let ratio = efficiency(on_hand, 0..10);
        println!("camera on the hand {on_hand}: error over the bound {ratio:.3}");
        assert!((0.92..1.08).contains(&ratio), "{ratio}");
    }
}

#[test]
fn a_camera_and_a_tracker_are_one_fit() {
    let chain = panda();
    let seen = simulate(&chain, &SimulationOptions { rows: 30, ..webcam(false) }, &NoEffects);
    let tracker = SimulationOptions { kind: ObservationKind::Position, rows: 30, seed: 3, ..Default::default() };
    let own = simulate(&chain, &tracker, &NoEffects).arm;
    let arm = Arm { joints: seen.arm.joints.clone(), ..own };
    let positions = simulate_arm(&arm, &tracker, &NoEffects).data;
    let one = |data: &Measurements| identify(&chain, data, &IdentifyOptions::axes(&chain)).geometric;
    let data = Measurements::joined(vec![positions.clone(), seen.data]).unwrap();
    assert_eq!(data.scene.measured(), "position+pixel");
    assert_eq!((data.scene.setups.len(), data.scene.targets.len()), (2, 2));
    let (both, alone) = (one(&data), one(&positions));
    // The more is measured, the surer every axis is.
    let spread = |fit: &denavit_identify::solve::Fit<NoEffects>| -> f64 {
        fit.layout.joints.clone().map(|k| fit.covariance[(k, k)]).sum::<f64>().sqrt()
    };
    println!("levels {:?}, spread {:.2e} of {:.2e}", both.noise.levels, spread(&both), spread(&alone));
    assert!((both.noise.levels[0] / 5e-5 - 1.0).abs() < 0.3, "{:?}", both.noise);
    let pixels = both.noise.levels[1] / data.scene.per_pixel(1).unwrap();
    assert!((pixels / 0.2 - 1.0).abs() < 0.1, "{pixels} px");
    assert!(spread(&both) < spread(&alone));
}

fn sight() -> Sight {
    webcam(false).sight.unwrap()
}

fn read(text: &str, sight: Option<Sight>) -> Result<Loaded, DataError> {
    let options = ImportOptions { sight, ..ImportOptions::default() };
    read_export("c.csv", text.as_bytes(), &examples::planar_arm(), Units::default(), &options)
}

#[test]
fn files_by_columns_and_by_rows_are_the_same() {
    let chain = panda();
    let run = simulate(&chain, &SimulationOptions { rows: 5, ..webcam(false) }, &NoEffects);
    let wide = write(&run.data, &[]);
    let mut long = format!("{},image,corner,v,u\n", run.data.joints.join(","));
    let mut placed = format!("{},image,board_x,board_y,v,u\n", run.data.joints.join(","));
    for row in 0..run.data.len() {
        let joints: Vec<String> = run.data.reading(row).iter().map(f64::to_string).collect();
        for observation in run.data.of_row(row) {
            let corner = run.data.series_of(observation).corner.as_ref().unwrap();
            let [u, v] = run.data.observed.values(observation) else { panic!("two numbers") };
            let before = format!("{},image {row}", joints.join(","));
            writeln!(long, "{before},{},{v},{u}", corner.label).unwrap();
            writeln!(placed, "{before},{},{},{v},{u}", corner.at.x, corner.at.y).unwrap();
        }
    }
    let options = ImportOptions { sight: Some(sight()), ..ImportOptions::default() };
    let read = |text: &str| read_export("c.csv", text.as_bytes(), &chain, Units::default(), &options).unwrap();
    let (wide, long, placed) = (read(&wide), read(&long), read(&placed));
    let mean = run.data.observations() / run.data.len();
    assert!(mean >= 12 && long.data.len() == 5 && placed.data.len() == 5);
    assert_eq!((&wide.data.readings, wide.data.observations()), (&long.data.readings, long.data.observations()));
    let fits = [wide, long, placed].map(|loaded| {
        assert!((0.3..1.5).contains(&loaded.data.scene.range().unwrap()));
        let squares: f64 = identify(&chain, &loaded.data, &IdentifyOptions::axes(&chain))
            .nominal
            .squares
            .iter()
            .map(|square| square[0])
            .sum();
        squares
    });
    assert!(fits.iter().all(|fit| (fit / fits[0] - 1.0).abs() < 1e-9), "{fits:?}");
}

#[test]
fn every_mistake_in_a_file_of_pixels_is_named() {
    let head = "joint_1,joint_2,corner,u,v\n";
    let said = |text: &str| read(text, Some(sight())).unwrap_err().to_string();
    let check = |text: &str, expected: &str| assert_eq!(said(text), expected);
    check(
        &format!("{head}0.1,0.2,24,100,100\n"),
        "c.csv:2: corner \"24\" is not on the board (7x5 squares of 30 mm: corners 0 to 23)",
    );
    check(
        &format!("{head}0.1,0.2,first,100,100\n"),
        "c.csv:2: corner \"first\" is not on the board (7x5 squares of 30 mm: corners 0 to 23)",
    );
    check(
        &format!("{head}0.1,0.2,3,700,100\n"),
        "c.csv:2: column \"u\": 700 is outside the image of 640 x 480 pixels; are these this camera's pixels?",
    );
    check(
        &format!("{head}0.1,0.2,3,70,100\n0.1,0.2,3,71,100\n"),
        "c.csv:3: corner \"3\" appears twice in one image; remove one of them, or number the images in a column image",
    );
    check(
        &format!("{head}0.1,0.2,3,70,\n"),
        "c.csv:2: column \"v\" is empty; every row needs this value: fill it in or remove the row",
    );
    check(
        &format!("{head}0.1,0.2,3,70,wide\n"),
        "c.csv:2: column \"v\": \"wide\" is not a number; correct the cell or remove the row",
    );
    check(
        "joint_1,joint_2,u0,v0,u1,v1\n0.1,0.2,1,2,3,\n",
        "c.csv:2: corner \"1\" has one of u1, v1 but not both; leave both empty where it was not seen",
    );
    check(
        "joint_1,joint_2,u0,v0,u1\n0.1,0.2,1,2,3\n",
        "c.csv:1: column \"v1\" is missing beside \"u1\"; u1, v1 belong together",
    );
    check(
        "joint_1,joint_2,u,v\n0.1,0.2,1,2\n",
        "c.csv:1: columns u, v do not say which corner of the board they show; add a column corner with its number, or \
         board_x,board_y",
    );
    check(
        "joint_1,joint_2,x,y,z\n0.1,0.2,1,2,3\n",
        "c.csv:1: a camera was given, but no columns hold pixels; there must be u,v with corner, or u0,v0,u1,v1,… by corner",
    );
    check(
        &format!("{head}0.1,0.2,3,70,100\n0.1,0.2,4,71,100\n0.3,0.2,4,71,100\n"),
        "c.csv: no image shows four corners of the board that are not in one line, but the camera's pose needs them; check \
         ‹board›, ‹camera› and the numbers of the corners",
    );
    let without = |sight| read(&format!("{head}0.1,0.2,3,70,100\n"), sight).unwrap_err().to_string();
    assert_eq!(
        without(Some(Sight { board: None, ..sight() })),
        "c.csv:1: corners are numbered, but the board is unknown; give its squares by ‹board›, such as 7x5:30mm"
    );
    assert_eq!(
        without(None),
        "c.csv:1: columns u and v are pixels of an unknown camera; give its intrinsics by ‹camera› FILE.yaml and its board by \
         ‹board›, such as 7x5:30mm"
    );
}

#[test]
fn residuals_of_held_out_images_are_as_large_as_the_noise() {
    let chain = panda();
    let run = simulate(&chain, &SimulationOptions { rows: 60, ..webcam(false) }, &NoEffects);
    let mut data = run.data;
    data.scene.set_range(0.6);
    let hold_out = Some(HoldOut { share: 0.3, seed: 0 });
    let options = CalibrateOptions { hold_out, ..CalibrateOptions::geometry(&chain) };
    let result = calibrate(&chain, &Statics::of_chain(&chain), data, None, &options).unwrap();
    let stage = result.report.stages.last().unwrap();
    let [train, test] = [&stage.train, stage.test.as_ref().unwrap()].map(|errors| *errors.of("reprojection").unwrap());
    let pixels = |error: &denavit_identify::residual_statistics::ErrorSummary| error.rms / error.per_pixel.unwrap();
    println!("fitted {:.4} px, held out {:.4} px", pixels(&train), pixels(&test));
    // Two components of 0.2 px.
    assert!((0.26..0.29).contains(&pixels(&train)) && (0.26..0.34).contains(&pixels(&test)));
    assert!(result.report.rows.iter().all(|row| row.pixels.len() == 2 && !row.corner.is_empty()));
    let json: serde_json::Value = serde_json::from_str(&result.report.to_json()).unwrap();
    let last = json["stages"].as_array().unwrap().last().unwrap()["test"].clone();
    let ratio = last["reprojection_rms_m"].as_f64().unwrap() / last["reprojection_rms_px"].as_f64().unwrap();
    assert!((ratio - 0.6 / Lens::webcam().focal()).abs() < 1e-12, "{last}");
    assert_eq!(json["measurement"], serde_json::json!(ObservationKind::Pixel));
}
