//! Targets of a test file, placed by its own rows.

#![allow(clippy::unwrap_used, clippy::print_stdout)] // Tests: a panic is a failure, what is printed is read.

use denavit_calibrate::IdentifyOptions;
use denavit_identify::identify;
use denavit_identify::parameters::NoEffects;
use denavit_identify::residual_statistics::{errors, placed, residuals};
use denavit_identify::simulate::{SimulationOptions, simulate, simulate_arm};
use denavit_measurements::kinds::ObservationKind;
use denavit_model::examples;
use denavit_model::nalgebra::Vector3;

#[test]
fn a_target_is_placed_beside_the_fitted_ones_of_the_same_configuration() {
    let chain = examples::puma_like();
    let kind = ObservationKind::Position;
    let mut run =
        simulate(&chain, &SimulationOptions { kind, rows: 300, targets: 3, ..Default::default() }, &NoEffects);
    // In its first row the arm hangs lower than any geometry says: by four times the noise, too little to be rejected.
    let sag = Vector3::new(0.0, 0.0, -2e-4);
    for observation in run.data.of_row(0) {
        run.data.observed.values_mut(observation)[2] += sag.z;
    }
    let fit = identify(&chain, &run.data, &IdentifyOptions::axes(&chain)).geometric;
    // Another target, placed by a row with the same readings: it hangs lower there, too.
    let mut truth = run.arm.clone();
    truth.targets.truncate(1);
    truth.targets[0].translation.vector += Vector3::new(0.01, 0.02, 0.0);
    let exact = SimulationOptions { kind, rows: 200, seed: 7, noise_position: 0.0, ..Default::default() };
    let mut test = simulate_arm(&truth, &exact, &NoEffects).data;
    test.scene.targets[0] = "other".into();
    let dimension = chain.coordinates().len();
    test.readings[..dimension].copy_from_slice(run.data.reading(0));
    let here = denavit_identify::simulate::true_target(&truth, test.reading(0), 0);
    let seen = (truth.instruments[0] * here).translation.vector + sag;
    test.observed.values_mut(0).copy_from_slice(seen.as_slice());
    test.locate[0] = true;
    let mean = |test: &denavit_calibrate::Measurements| {
        let arm = placed(&fit, &run.data, test).unwrap();
        errors(&residuals(&arm, &NoEffects, test), &test.scene).of("position").unwrap().mean
    };
    let beside = mean(&test);
    // At readings that the fit has not seen there is nothing to go by.
    test.readings[0] += 1e-5;
    let alone = mean(&test);
    println!("beside the fitted targets {beside:.2e} m, by itself {alone:.2e} m");
    assert!(beside < 8e-5 && alone > 1.5e-4, "{beside} {alone}");
}
