//! Real robots, measured by others. The data are not part of this repository.

use denavit_calibrate::errors::{errors, placed, residuals};
use denavit_calibrate::measurements::{Units, read};
use denavit_calibrate::{IdentifyOptions, Measurements, NoEffects, identify};
use denavit_model::nalgebra::{Point3, Unit, Vector3};
use denavit_model::{AxisLine, Chain, ChainJoint, Coordinate, Limits, Quantity, Screw, se3};
use std::path::PathBuf;

fn measured(name: &str) -> Option<PathBuf> {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared/measured").join(name);
    if path.exists() {
        return Some(path);
    }
    println!("skipped, because {} is not here", path.display());
    None
}

fn load(name: &str, chain: &Chain) -> Option<Measurements> {
    let path = measured(name)?;
    let file = std::fs::File::open(&path).unwrap();
    let loaded = read(name, file, chain, Units::default()).unwrap_or_else(|error| panic!("{error}"));
    for note in loaded.notes {
        println!("{note}");
    }
    Some(loaded.data)
}

/// IRB 120 as the data sheet draws it: shoulder 0.290 m, upper arm 0.270, elbow offset 0.070, forearm 0.302, flange 0.072.
fn irb120() -> Chain {
    let axes: [([f64; 3], [f64; 3]); 6] = [
        ([0., 0., 1.], [0., 0., 0.]),
        ([0., 1., 0.], [0., 0., 0.290]),
        ([0., 1., 0.], [0., 0., 0.560]),
        ([1., 0., 0.], [0., 0., 0.630]),
        ([0., 1., 0.], [0.302, 0., 0.630]),
        ([1., 0., 0.], [0.302, 0., 0.630]),
    ];
    let name = |k: usize| format!("joint_{}", k + 1);
    let limits = Limits { lower: -3.5, upper: 3.5, velocity: None, effort: None };
    let coordinates = (0..6)
        .map(|k| Coordinate { limits: Some(limits), ..Coordinate::unlimited(name(k), Quantity::Angle) })
        .collect();
    let joints = axes
        .iter()
        .enumerate()
        .map(|(k, (direction, point))| ChainJoint {
            name: name(k),
            screw: Screw::Revolute(AxisLine {
                direction: Unit::new_normalize(Vector3::from(*direction)),
                point: Point3::from(*point),
            }),
            coordinate: k,
            scale: 1.0,
            offset: 0.0,
        })
        .collect();
    Chain::new(("irb120", "base_link", "tool0"), coordinates, joints, se3::translation(Vector3::new(0.374, 0., 0.630)))
        .unwrap()
}

#[test]
fn wu_irb120_geometry() {
    let chain = irb120();
    let (Some(train), Some(test)) = (load("wu_irb120/train.csv", &chain), load("wu_irb120/test.csv", &chain)) else {
        return;
    };
    for tolerance in [1e-3, 2e-3, 5e-3, 2e-2, 1.0] {
        for robust in [true, false] {
            let mut options = IdentifyOptions::axes(&chain);
            options.tolerances.turn = tolerance;
            options.tolerances.shift = tolerance;
            options.fit.robust = robust;
            let found = identify(&chain, &train, &options);
            let report = |name: &str, fit: &denavit_calibrate::Fit<NoEffects>| {
                let arm = placed(&fit.arm, &NoEffects, &train, &test).unwrap();
                let e = errors(&residuals(&arm, &NoEffects, &test), test.kind);
                let rejected = fit.weights.iter().filter(|w| **w == 0.0).count();
                println!(
                    "{name} tolerance {tolerance} robust {robust}: noise {:.4} mm, test mean {:.4} max {:.4} mm, {} iterations, used {:.2}, rejected {rejected}",
                    fit.noise.position * 1e3,
                    e.position_mean_m.unwrap() * 1e3,
                    e.position_max_m.unwrap() * 1e3,
                    fit.iterations,
                    fit.parameters_used[0]
                );
            };
            report("nominal", &found.nominal);
            report("geometric", &found.geometric);
        }
    }
}

#[test]
fn robotcali_irb120_geometry() {
    let chain = irb120();
    let Some(data) = load("robotcali_irb120/measurements.csv", &chain) else { return };
    for tolerance in [1e-3, 2e-2] {
        let test_rows: Vec<usize> = (0..data.len()).filter(|row| row % 10 >= 7).collect();
        let train_rows: Vec<usize> = (0..data.len()).filter(|row| row % 10 < 7).collect();
        let (train, test) = (data.subset(&train_rows), data.subset(&test_rows));
        let mut options = IdentifyOptions::axes(&chain);
        options.tolerances.turn = tolerance;
        options.tolerances.shift = tolerance;
        let found = identify(&chain, &train, &options);
        for fit in [&found.nominal, &found.geometric] {
            let e = errors(&residuals(&fit.arm, &NoEffects, &test), test.kind);
            println!(
                "tolerance {tolerance}: noise {:.3} mm, test rms {:.3} mm, {} iterations",
                fit.noise.position * 1e3,
                e.distance_rms_m.unwrap() * 1e3,
                fit.iterations
            );
        }
    }
}
