//! Few rows: nothing is claimed that so few numbers cannot tell.

#![allow(clippy::unwrap_used, clippy::print_stdout)] // Tests: a panic is a failure, what is printed is read.

use crate::drawn::ur5e;
use denavit_calibrate::calibration::adoption::Adopted;
use denavit_calibrate::calibration::{CalibrateOptions, Calibration, calibrate};
use denavit_calibrate::report::text;
use denavit_calibrate::{Arm, IdentifyOptions, Measurements};
use denavit_identify::parameters::NoEffects;
use denavit_identify::simulate::{SimulationOptions, simulate, simulate_arm};
use denavit_trace::TraceOptions;

/// Positions of a robot without any effect, and 40 rows that no fit sees.
fn clean(rows: usize, seed: u64) -> (Measurements, Measurements) {
    let (chain, _) = ur5e();
    let options = SimulationOptions { rows, seed, ..SimulationOptions::default() };
    let run = simulate(&chain, &options, &NoEffects);
    let test = SimulationOptions { rows: 40, seed: seed + 1000, ..SimulationOptions::default() };
    (run.data, simulate_arm(&run.arm, &test, &NoEffects).data)
}

fn calibrated(rows: usize, seed: u64, effects: bool, test: bool) -> Calibration {
    let (chain, statics) = ur5e();
    let (data, held_out) = clean(rows, seed);
    let identify = IdentifyOptions::axes(&chain);
    let trace = effects.then(|| TraceOptions::new(identify.clone()));
    let options = CalibrateOptions { trace, ..CalibrateOptions::geometry(&chain) };
    calibrate(&chain, &statics, data, test.then_some(held_out), &options).unwrap()
}

fn test_rms(result: &Calibration, stage: usize) -> f64 {
    result.report.stages[stage].test.as_ref().unwrap().of("position").unwrap().rms
}

#[test]
fn fewer_numbers_than_parameters_are_no_perfect_fit() {
    let (mut nominal, mut fitted) = (0.0, 0.0);
    for seed in 0..8 {
        let result = calibrated(8, seed, true, true);
        let said = text::report(&result);
        let redundancy = &result.report.redundancy;
        assert_eq!((redundancy.values, redundancy.postures, redundancy.degrees_of_freedom), (24, 8, 0), "{said}");
        assert!(said.contains("redundancy: 24 numbers in 8 postures, 0 degrees of freedom"), "{said}");
        assert!(said.contains("degrees of freedom that determine the noise are missing"), "{said}");
        assert!(!said.contains("0.0000") && !said.contains("± 0.000") && !said.contains("inf"), "{said}");
        assert!(result.report.effects.is_empty() && !said.contains("no unexplained structure"), "{said}");
        for parameter in &result.report.parameters {
            assert!(parameter.half_interval_95 > 2.0 * parameter.std && parameter.std > 0.0, "{parameter:?}");
        }
        nominal += test_rms(&result, 0);
        fitted += test_rms(&result, 1);
    }
    println!("held out, mean of 8 seeds: nominal {nominal:.6}, fitted {fitted:.6}");
    assert!(fitted < nominal, "the prior makes a fit to 24 numbers better than the drawing: {fitted} {nominal}");
}

#[test]
fn intervals_hold_what_they_say_with_few_rows() {
    let (mut inside, mut all) = (0u32, 0u32);
    for seed in 0..20 {
        let (chain, _) = ur5e();
        let options = SimulationOptions { rows: 10, seed, ..SimulationOptions::default() };
        let run = simulate(&chain, &options, &NoEffects);
        let result = calibrate(&chain, &ur5e().1, run.data, None, &CalibrateOptions::geometry(&chain)).unwrap();
        let fit = &result.identification.geometric;
        let truth = fit.layout.difference(&denavit_identify::gauge::centred(&fit.layout, &run.arm, &fit.arm), &fit.arm);
        for (index, parameter) in result.report.parameters.iter().enumerate() {
            all += 1;
            inside += u32::from((parameter.change - truth[index]).abs() < parameter.half_interval_95);
        }
    }
    let share = f64::from(inside) / f64::from(all);
    println!("{inside} of {all} inside 95 %");
    assert!(share > 0.9, "{share}");
}

#[test]
fn clean_files_of_few_rows_name_no_effect() {
    for (rows, seeds) in [(12, 6), (16, 4), (20, 4), (28, 3)] {
        let mut named = 0;
        for seed in 0..seeds {
            let result = calibrated(rows, seed, true, true);
            named += usize::from(!result.report.effects.is_empty());
            assert!(test_rms(&result, 1) < test_rms(&result, 0));
            assert_eq!(result.report.adopted, Adopted::Geometric);
        }
        println!("{rows} rows: {named} of {seeds} runs name an effect");
        assert_eq!(named, 0);
    }
}

#[test]
fn sixty_equal_rows_are_one_posture() {
    let (chain, statics) = ur5e();
    let (data, _) = clean(20, 3);
    let equal = data.subset(&[4; 60]);
    let error = calibrate(&chain, &statics, equal, None, &CalibrateOptions::geometry(&chain)).unwrap_err().to_string();
    assert_eq!(
        error,
        "simulation: 1 row holds 3 measured numbers, but 9 are needed to place the instrument and the targets, and a few more \
         as a check; measure more poses"
    );
    let few = data.subset(&(0..60).map(|row| row % 10).collect::<Vec<usize>>());
    let result = calibrate(&chain, &statics, few, None, &CalibrateOptions::geometry(&chain)).unwrap();
    assert_eq!((result.report.redundancy.postures, result.report.redundancy.degrees_of_freedom), (10, 3));
    assert!(!result.report.redundancy.enough_for_effects);
}

#[test]
fn held_out_rows_that_a_stage_makes_worse_are_reported_and_choose_nothing() {
    let (chain, statics) = ur5e();
    // The fitted rows are of a robot with errors, those held out of one that is as drawn, placed alike.
    let options = SimulationOptions { rows: 30, seed: 5, turn: 2e-3, shift: 3e-3, ..SimulationOptions::default() };
    let run = simulate(&chain, &options, &NoEffects);
    let mut drawn = run.arm.clone();
    drawn.joints = Arm::new(&chain, &run.data.scene).joints;
    let test =
        simulate_arm(&drawn, &SimulationOptions { rows: 40, seed: 9, ..SimulationOptions::default() }, &NoEffects).data;
    let result = calibrate(&chain, &statics, run.data, Some(test), &CalibrateOptions::geometry(&chain)).unwrap();
    let said = text::report(&result);
    assert_eq!(result.report.adopted, Adopted::Geometric, "{said}");
    assert!(result.report.stages[1].worse_on_held_out && result.report.stages[1].adopted);
    assert!(
        said.contains("\"geometric\" predicts the held-out rows worse than \"nominal\", by more than chance"),
        "{said}"
    );
}
