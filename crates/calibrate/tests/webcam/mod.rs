//! A webcam and a Franka Panda, and how near a fit comes to what the noise allows: for the tests and for `study_camera`.

use denavit_calibrate::{Arm, IdentifyOptions, Measurements};
use denavit_identify::gauge;
use denavit_identify::identify;
use denavit_identify::parameters::Layout;
use denavit_identify::parameters::NoEffects;
use denavit_identify::residual::ResidualModel;
use denavit_identify::residual::Scratch;
use denavit_identify::residual_statistics::residuals;
use denavit_identify::simulate::{SimulationOptions, simulate, simulate_arm};
use denavit_measurements::board::Sight;
use denavit_measurements::kinds::ObservationKind;
use denavit_measurements::lens::{Distortion, Lens};
use denavit_model::nalgebra::DMatrix;
use denavit_model::tree::Reading;
use denavit_model::{Chain, urdf};
use std::ops::Range;

/// The Panda of `robots/franka`, base to flange.
pub fn panda() -> Chain {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../robots/franka/panda.urdf");
    let robot = urdf::read("panda.urdf", &std::fs::read_to_string(path).unwrap()).unwrap();
    robot.chain(None, Some("panda_link8"), Reading::Intended).unwrap().value
}

/// 60 images of a board of 7 by 5 squares of 30 mm, seen to 0.2 px.
pub fn webcam(on_hand: bool) -> SimulationOptions {
    let mut bend = [0.0; 12];
    bend[..5].copy_from_slice(&[0.08, -0.18, 1e-3, -5e-4, 0.05]);
    let lens = Lens { distortion: Distortion::Polynomial(bend), ..Lens::webcam() };
    let sight = Some(Sight { lens, on_hand, board: "7x5:30mm".parse().ok() });
    SimulationOptions {
        kind: ObservationKind::Pixel,
        rows: 60,
        sight,
        noise_pixel: 0.2,
        ..SimulationOptions::default()
    }
}

/// The information that the rows give at this arm, beside the prior and the conditions that hold the common frame; and
/// their derivatives, row by row.
pub fn derivatives(data: &Measurements, layout: &Layout, arm: &Arm) -> DMatrix<f64> {
    let problem = ResidualModel { data, layout, effects: &NoEffects };
    let mut scratch = Scratch::new(layout, arm);
    let heights: Vec<usize> = (0..data.len()).map(|row| problem.height_of(row)).collect();
    let n = layout.len();
    let mut all = Vec::with_capacity(heights.iter().sum::<usize>() * n);
    for (row, height) in heights.iter().enumerate() {
        let mut jacobian = vec![0.0; height * n];
        problem.row_into(arm, row, &mut scratch, &mut vec![0.0; *height], Some(&mut jacobian));
        all.extend(jacobian);
    }
    DMatrix::from_row_slice(all.len() / n, n, &all)
}

/// Error of predicted pixels in images that were not fitted, over what the Cramér-Rao bound allows for them: 1 where
/// nothing better can be had from these data and the prior; root mean square over the runs of these seeds.
pub fn efficiency(on_hand: bool, seeds: Range<u64>) -> f64 {
    let sigma =
        |data: &Measurements, options: &SimulationOptions| options.noise_pixel * data.scene.per_pixel(0).unwrap();
    efficiency_of(&panda(), &webcam(on_hand), sigma, seeds)
}

/// The same of what is measured with these options; `sigma`: standard deviation of one value, m.
pub fn efficiency_of(
    chain: &Chain,
    options: &SimulationOptions,
    sigma: fn(&Measurements, &SimulationOptions) -> f64,
    seeds: Range<u64>,
) -> f64 {
    let (mut found, mut allowed) = (0.0, 0.0);
    for seed in seeds {
        let options = SimulationOptions { seed, ..options.clone() };
        let run = simulate(chain, &options, &NoEffects);
        let fit = identify(chain, &run.data, &IdentifyOptions::axes(chain)).geometric;
        let later = SimulationOptions {
            seed: seed + 1_000_000,
            noise_pixel: 0.0,
            noise_position: 0.0,
            noise_orientation: 0.0,
            ..options.clone()
        };
        let test = simulate_arm(&run.arm, &later, &NoEffects).data;
        let sigma = sigma(&run.data, &options);
        let layout = &fit.layout;
        // Parameters in units of a thousandth, for the numbers' sake.
        let unit = vec![1e-3; layout.len()];
        let rows = derivatives(&run.data, layout, &run.arm) * (1e-3 / sigma);
        let held = gauge::in_scaled(gauge::conditions(layout, &run.arm), &unit);
        let mut information = rows.transpose() * &rows + &held * held.transpose() * 1e6;
        for i in layout.joints.clone() {
            for k in layout.joints.clone() {
                information[(i, k)] += layout.prior.precision[(i, k)] * 1e-6;
            }
        }
        let bound = information.cholesky().unwrap().inverse();
        let ahead = derivatives(&test, layout, &run.arm) * 1e-3;
        allowed += (&ahead * bound).component_mul(&ahead).sum();
        found +=
            residuals(&fit.arm, &NoEffects, &test).iter().map(|residual| residual.place.norm_squared()).sum::<f64>();
    }
    (found / allowed).sqrt()
}
