//! What must not matter - the order of rows, columns and effects, the units and the notation of a file - and operations that undo each other.

#![allow(clippy::unwrap_used, reason = "a panic is a failure")]

use denavit_calibrate::{Arm, Freedom, IdentifyOptions, Measurements, Tolerances};
use denavit_identify::arm::RowState;
use denavit_identify::effects::survey::Survey;
use denavit_identify::effects::{Carrier, Conditions, Coupling, Driver, Effect, EffectModel, Kind, Statics, Term};
use denavit_identify::identify;
use denavit_identify::initial_guess::rigid_fit;
use denavit_identify::noise::{NoiseModel, noise_model};
use denavit_identify::parameters::Layout;
use denavit_identify::parameters::NoEffects;
use denavit_identify::parameters::ParameterKind;
use denavit_identify::simulate::{SimulationOptions, readings, simulate};
use denavit_measurements::kinds::ObservationKind;
use denavit_measurements::{Covariate, Covariates, RecordedRow, read, write};
use denavit_model::examples::{self, puma_like};
use denavit_model::nalgebra::{Point3, Rotation3, Vector3};
use denavit_model::{Chain, se3};
use denavit_trace::infer::curves::{CurveOptions, fit_curves};
use proptest::prelude::*;
use std::collections::HashSet;

/// Rows of a run with two recorded quantities.
fn run(rows: usize, seed: u64) -> Measurements {
    let of = |name: &str, scale: f64| Covariate {
        name: name.into(),
        values: (0..rows).map(|row| scale * (row as f64 * 0.7).sin()).collect(),
    };
    let covariates = vec![of("temperature", 25.0), of("payload", 1.5)];
    let options = SimulationOptions { kind: ObservationKind::Position, rows, seed, covariates, ..Default::default() };
    simulate(&puma_like(), &options, &NoEffects).data
}

fn again(text: &str, units: &str) -> Measurements {
    read("run.csv", text.as_bytes(), &puma_like(), units.parse().unwrap())
        .unwrap_or_else(|error| panic!("{error}"))
        .data
}

/// Header and rows of a comma-separated text.
fn cells(text: &str) -> Vec<Vec<String>> {
    text.lines().map(|line| line.split(',').map(str::to_owned).collect()).collect()
}

fn text(cells: &[Vec<String>], separator: &str) -> String {
    cells.iter().map(|row| row.join(separator) + "\n").collect()
}

fn shuffled(count: usize, seed: u64) -> Vec<usize> {
    let mut order: Vec<usize> = (0..count).collect();
    order.sort_by_key(|index| (*index as u64 + 1).wrapping_mul(seed | 1).wrapping_mul(0x9e37_79b9_7f4a_7c15));
    order
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(16))]

    #[test]
    fn columns_may_stand_in_any_order(seed in any::<u64>()) {
        let file = cells(&write(&run(12, seed % 100), &[]));
        let order = shuffled(file[0].len(), seed);
        let moved: Vec<Vec<String>> = file.iter().map(|row| order.iter().map(|&at| row[at].clone()).collect()).collect();
        let (mut found, mut expected) = (again(&text(&moved, ","), "m,rad"), again(&text(&file, ","), "m,rad"));
        // Recorded quantities keep the file's order.
        for data in [&mut found, &mut expected] {
            let mut columns = std::mem::take(&mut data.covariates).into_columns();
            columns.sort_by(|a, b| a.name.cmp(&b.name));
            data.covariates = Covariates::from(columns);
        }
        prop_assert_eq!(found, expected);
    }

    #[test]
    fn rows_are_kept_in_their_order(seed in any::<u64>()) {
        let file = cells(&write(&run(12, seed % 100), &[]));
        let order = shuffled(file.len() - 1, seed);
        let moved: Vec<Vec<String>> = std::iter::once(0).chain(order.iter().map(|row| row + 1)).map(|row| file[row].clone()).collect();
        let found = again(&text(&moved, ","), "m,rad");
        let mut expected = again(&text(&file, ","), "m,rad").subset(&order);
        expected.lines.clone_from(&found.lines);
        prop_assert_eq!(found, expected);
    }

    #[test]
    fn units_and_notation_do_not_change_what_is_measured(seed in 0u64..100) {
        let (file, joints) = (cells(&write(&run(12, seed), &[])), puma_like().coordinates().len());
        let expected = again(&text(&file, ","), "m,rad");
        // Degrees and millimetres, said beside the file or in its header, with commas in numbers and semicolons between.
        let factor = |column: usize| match column {
            column if column < joints => 180.0 / std::f64::consts::PI,
            column if column < joints + 3 => 1000.0,
            _ => 1.0,
        };
        let mut scaled = file.clone();
        for row in &mut scaled[1..] {
            for (column, cell) in row.iter_mut().enumerate() {
                *cell = (cell.parse::<f64>().unwrap() * factor(column)).to_string();
            }
        }
        let mut headed = scaled.clone();
        for (column, name) in headed[0].iter_mut().enumerate() {
            match column {
                column if column < joints => name.push_str(" [deg]"),
                column if column < joints + 3 => name.push_str(" [mm]"),
                _ => {}
            }
        }
        for row in &mut headed[1..] {
            for cell in row {
                *cell = cell.replace('.', ",");
            }
        }
        for found in [again(&text(&scaled, ","), "mm,deg"), again(&text(&headed, ";"), "m,rad")] {
            prop_assert_eq!(found.len(), expected.len());
            for row in 0..found.len() {
                for (a, b) in found.reading(row).iter().zip(expected.reading(row)) {
                    prop_assert!((a - b).abs() < 1e-14, "row {}: {} {}", row, a, b);
                }
                let (a, b) = (found.position(row, 0).unwrap(), expected.position(row, 0).unwrap());
                prop_assert!((a - b).norm() < 1e-14, "row {}: {} {}", row, a, b);
            }
            prop_assert_eq!(&found.covariate("temperature").unwrap().values, &expected.covariate("temperature").unwrap().values);
        }
    }

    #[test]
    fn a_motion_is_found_from_points_and_their_images(
        turn in prop::array::uniform3(-3.0..3.0f64),
        shift in prop::array::uniform3(-2.0..2.0f64),
        points in prop::collection::vec(prop::array::uniform3(-1.0..1.0f64), 4..9),
    ) {
        let motion = se3::pose(Rotation3::from_scaled_axis(Vector3::from(turn)), Vector3::from(shift));
        let pairs: Vec<_> = points.iter().map(|point| (Vector3::from(*point), motion * Point3::from(*point))).map(|(from, to)| (from, to.coords)).collect();
        let found = rigid_fit(&pairs).unwrap();
        for (from, to) in &pairs {
            let image = found * Point3::from(*from);
            prop_assert!((image.coords - to).norm() < 1e-12);
        }
    }
}

#[test]
fn setups_that_are_joined_come_apart_again() {
    let [a, b] = [1, 2].map(|seed| again(&write(&run(8, seed), &[]), "m,rad"));
    let [mut a, mut b] = [a.of_setup("left"), b.of_setup("right")];
    let joined = Measurements::joined(vec![a.clone(), b.clone()]).unwrap();
    assert_eq!(joined.len(), 16);
    let (mut kept, mut held) = joined.apart(&["right".to_owned()]).unwrap();
    for data in [&mut a, &mut b, &mut kept, &mut held] {
        data.source.clear();
    }
    assert_eq!((kept, held), (a, b));
    assert_eq!(joined.apart(&["middle".to_owned()]), Err("middle".to_owned()));
}

/// Layouts with everything free, and the arms that they are of.
fn free(chain: &Chain) -> (Layout, Arm) {
    let options = SimulationOptions { kind: ObservationKind::Pose, rows: 5, targets: 1, ..Default::default() };
    let arm = simulate(chain, &options, &NoEffects);
    let all = vec![true; chain.joints().len()];
    let freedom = Freedom { axes: all.clone(), scales: all.clone(), pitches: all.clone(), zeros: all };
    (Layout::new(chain, &arm.data.scene, &freedom, &Tolerances::default(), Vec::new()), arm.arm)
}

#[test]
fn a_step_is_the_difference_that_it_makes() {
    for chain in examples::all() {
        let (layout, arm) = free(&chain);
        for parameter in 0..layout.len() {
            // Of axes that are not where they are drawn to second order alone: the step from the drawing is told exactly.
            let start = Arm { joints: chain.joints().to_vec(), ..arm.clone() };
            let mut step = vec![0.0; layout.len()];
            step[parameter] = 1e-3;
            let stepped = layout.stepped(&start, &step);
            let name = &layout.parameters[parameter].name;
            for (other, change) in layout.difference(&stepped, &start).into_iter().enumerate() {
                let expected = match layout.parameters[other].kind {
                    ParameterKind::Instrument { .. } | ParameterKind::Plane { .. } | ParameterKind::Point { .. } => 0.0,
                    _ => step[other],
                };
                let at = &layout.parameters[other].name;
                assert!((change - expected).abs() < 1e-9, "{}: {name} changes {at} by {change:e}", chain.name());
            }
            step[parameter] = -1e-3;
            let back = layout.difference(&layout.stepped(&stepped, &step), &start);
            assert!(back.iter().all(|left| left.abs() < 1e-9), "{}: {name} leaves {back:?}", chain.name());
        }
    }
}

#[test]
fn effects_stand_between_joints_and_surroundings_and_can_be_taken_out() {
    for chain in examples::all() {
        let (layout, _) = free(&chain);
        let names: HashSet<&str> = layout.parameters.iter().map(|parameter| parameter.name.as_str()).collect();
        assert_eq!(names.len(), layout.len(), "{}: two parameters of one name", chain.name());
        let statics = Statics::of_chain(&chain);
        let model = EffectModel::of_terms(&statics, None, &[scale(0), scale(chain.joints().len() - 1)]);
        let with = layout.with_effects(denavit_identify::parameters::Effects::parameters(&model));
        assert_eq!(with.effects, layout.joints.end..layout.joints.end + 2);
        for (target, place) in with.places.iter().enumerate() {
            assert_eq!(with.parameters[place.unwrap()].kind, ParameterKind::Target { target, component: 0 });
        }
        assert_eq!(with.with_effects(Vec::new()), layout);
    }
}

fn scale(joint: usize) -> Term {
    Term {
        kind: Kind::JointScale,
        carrier: Carrier::Joint(joint),
        driver: Driver::Reading(joint),
        coupling: Coupling::Each,
    }
}

#[test]
fn effects_add_up_in_any_order() {
    let chain = puma_like();
    let effects: Vec<Effect> = (0..chain.joints().len())
        .map(|joint| Effect { term: scale(joint), coefficients: vec![1e-3 * (joint as f64 - 2.5)] })
        .collect();
    let turned: Vec<Effect> = effects.iter().rev().cloned().collect();
    let [one, other] = [effects.clone(), turned].map(|effects| EffectModel::new(Statics::of_chain(&chain), effects));
    for q in readings(&chain, 20, 3) {
        let conditions = Conditions { reading: &q, recorded: RecordedRow::nothing(), tip: 0 };
        let (a, b) = (one.fk(&chain, &conditions), other.fk(&chain, &conditions));
        assert!((a.translation.vector - b.translation.vector).norm() < 1e-15);
        // A joint that counts too many turns by that share: forward kinematics of the chain at the true values.
        let truth: Vec<f64> = q.iter().zip(&effects).map(|(q, effect)| q * (1.0 + effect.coefficients[0])).collect();
        assert!((a.translation.vector - chain.fk(&truth).translation.vector).norm() < 1e-14);
        assert!((a.rotation.matrix() - chain.fk(&truth).rotation.matrix()).norm() < 1e-13);
    }
}

#[test]
fn an_arm_stands_where_its_chain_says() {
    for chain in examples::all() {
        let (_, arm) = free(&chain);
        let calibrated = arm.chain();
        let mut state = RowState::default();
        for q in readings(&chain, 10, 5) {
            arm.state_into(&q, 0, None, &mut state);
            let expected = calibrated.fk(&q);
            assert!((state.tip.translation.vector - expected.translation.vector).norm() < 1e-13, "{}", chain.name());
            assert!((state.tip.rotation.matrix() - expected.rotation.matrix()).norm() < 1e-13, "{}", chain.name());
        }
    }
}

#[test]
fn the_order_of_rows_changes_neither_fit_nor_curves() {
    let chain = puma_like();
    let statics = Statics::of_chain(&chain);
    let gear = EffectModel::new(
        statics.clone(),
        vec![Effect {
            term: Term {
                kind: Kind::TransmissionError,
                carrier: Carrier::Joint(1),
                driver: Driver::Harmonic { joint: 1, order: 3.0 },
                coupling: Coupling::Each,
            },
            coefficients: vec![4e-4, -3e-4],
        }],
    );
    let options = SimulationOptions { kind: ObservationKind::Position, rows: 90, seed: 2, ..Default::default() };
    let data = simulate(&chain, &options, &gear).data;
    let order: Vec<usize> = (0..data.len()).rev().collect();
    let [one, other] = [data.clone(), data.subset(&order)].map(|data| {
        let fit = identify(&chain, &data, &IdentifyOptions::axes(&chain)).geometric;
        let survey = Survey::of(&statics, &data, Vec::new());
        let curves = fit_curves(&survey, &data, &fit.with_model(&statics, None), &fit.arm, &CurveOptions::default());
        (fit, curves)
    });
    let difference = one.0.layout.difference(&one.0.arm, &one.0.arm);
    let turned = other.0.layout.difference(&other.0.arm, &other.0.arm);
    for (a, b) in difference.iter().zip(&turned) {
        assert!((a - b).abs() < 1e-9, "{a} {b}");
    }
    let curve = |found: &denavit_trace::infer::curves::CurveFit| {
        let curves = &found.fit.effects.curves;
        assert_eq!(curves.iter().map(|curve| curve.joint).collect::<Vec<_>>(), [1]);
        curves[0].clone()
    };
    let (a, b) = (curve(&one.1), curve(&other.1));
    for place in [-1.5, -0.5, 0.3, 1.1] {
        assert!((a.value(place) - b.value(place)).abs() < 1e-7, "{} {}", a.value(place), b.value(place));
    }
    // It is the gear's error but for its mean, which is the joint's zero.
    let error = |place: f64| 4e-4 * (3.0 * place).sin() - 3e-4 * (3.0 * place).cos();
    let places: Vec<f64> = (0..40).map(|k| a.range.0 + (a.range.1 - a.range.0) * f64::from(k) / 39.0).collect();
    let mean = places.iter().map(|place| error(*place) - a.value(*place)).sum::<f64>() / 40.0;
    for place in places {
        let left = error(place) - a.value(place) - mean;
        assert!(left.abs() < 2e-4, "at {place}: {left:e}");
    }
}

#[test]
fn a_run_in_reverse_order_has_the_same_noise() {
    let chain = puma_like();
    let options =
        SimulationOptions { kind: ObservationKind::Pose, rows: 60, noise_range: 2e-4, seed: 4, ..Default::default() };
    let data = simulate(&chain, &options, &NoEffects).data;
    let backwards = data.subset(&(0..data.len()).rev().collect::<Vec<_>>());
    let [one, other] = [data, backwards].map(|data| {
        let fit = identify(&chain, &data, &IdentifyOptions::axes(&chain)).geometric;
        noise_model(&fit, &data, &[]).unwrap()
    });
    let of =
        |model: &NoiseModel| model.components.iter().map(|part| (part.name.clone(), part.claimed)).collect::<Vec<_>>();
    assert_eq!(of(&one), of(&other));
    for (a, b) in one.components.iter().zip(&other.components) {
        let largest = a.value.max(b.value).max(a.high.unwrap_or(0.0));
        assert!((a.value - b.value).abs() <= 1e-4 * largest, "{}: {} {}", a.name, a.value, b.value);
    }
    let [a, b] = [&one, &other].map(|model| model.run_order.unwrap());
    assert!((a.lag_1 - b.lag_1).abs() < 1e-4 && !a.claimed && !b.claimed, "{a:?} {b:?}");
}
