//! Planes that a ball touches and dial gauges on plates: what they tell, files, and one fit with a tracker.

use crate::webcam::{efficiency_of, panda};
use denavit_calibrate::apply::plan::{PlanOptions, plan};
use denavit_calibrate::{Arm, Freedom, IdentifyOptions, Measurements};
use denavit_identify::identifiability::identifiability;
use denavit_identify::identify;
use denavit_identify::parameters::NoEffects;
use denavit_identify::simulate::{SimulationOptions, simulate, simulate_arm};
use denavit_identify::solve::Fit;
use denavit_measurements::kinds::ObservationKind;
use denavit_measurements::{Units, read, write};
use denavit_model::{Chain, examples};

fn options(kind: ObservationKind, rows: usize) -> SimulationOptions {
    SimulationOptions { kind, rows, noise_position: 1e-5, ..SimulationOptions::default() }
}

fn fitted(chain: &Chain, data: &Measurements) -> Fit<NoEffects> {
    identify(chain, data, &IdentifyOptions::axes(chain)).geometric
}

#[test]
fn without_noise_the_planes_are_met() {
    for chain in [examples::puma_like(), panda()] {
        for kind in [ObservationKind::Plane, ObservationKind::Dial] {
            let exact = SimulationOptions { noise_position: 0.0, ..options(kind, 150) };
            let run = simulate(&chain, &exact, &NoEffects);
            let rest = fitted(&chain, &run.data);
            let left = rest.squares.iter().map(|square| square[0].sqrt()).fold(0.0, f64::max);
            println!("{} {kind:?}: largest residual {left:.1e} m, {} steps", chain.name(), rest.iterations);
            assert!(rest.converged_or_exact() && left < 1e-9, "{} {kind:?}: {left:e}", chain.name());
            let known = identifiability(&run.data, &rest.arm, &NoEffects, &Freedom::axes(chain.joints().len()));
            println!("  {} of {} = {}", known.rank, known.expected, known.formula);
        }
    }
}

#[test]
fn planes_and_dial_gauges_tell_what_their_noise_allows() {
    // Ten runs tell the ratio to some per cent: study_contact is long.
    for kind in [ObservationKind::Plane, ObservationKind::Dial] {
        let ratio = efficiency_of(&panda(), &options(kind, 300), |_, options| options.noise_position, 0..10);
        println!("{kind:?}: error over the bound {ratio:.3}");
        assert!((0.85..1.15).contains(&ratio), "{kind:?}: {ratio}");
    }
}

#[test]
fn what_is_simulated_is_read_back() {
    let chain = panda();
    for kind in [ObservationKind::Plane, ObservationKind::Dial] {
        let run = simulate(&chain, &options(kind, 30), &NoEffects);
        assert_eq!((run.data.len(), run.data.scene.setups.len()), (30, 3));
        let text = write(&run.data, &[]);
        let back = read("c.csv", text.as_bytes(), &chain, Units::default()).unwrap().data;
        assert_eq!(
            (&back.readings, &back.observed, &back.scene),
            (&run.data.readings, &run.data.observed, &run.data.scene)
        );
        assert_eq!(back.labels, run.data.labels);
    }
}

#[test]
fn a_tracker_a_plate_and_a_dial_gauge_are_one_fit() {
    let chain = panda();
    let tracker = SimulationOptions { kind: ObservationKind::Position, rows: 30, seed: 3, ..Default::default() };
    let seen = simulate(&chain, &tracker, &NoEffects);
    let alone = fitted(&chain, &seen.data);
    let mut parts = vec![seen.data];
    for kind in [ObservationKind::Plane, ObservationKind::Dial] {
        let touching = options(kind, 60);
        let own = simulate(&chain, &touching, &NoEffects).arm;
        let arm = Arm { joints: seen.arm.joints.clone(), ..own };
        parts.push(simulate_arm(&arm, &touching, &NoEffects).data);
    }
    let data = Measurements::joined(parts).unwrap();
    assert_eq!(data.scene.measured(), "position+plane+dial");
    assert_eq!((data.scene.setups.len(), data.scene.targets.len()), (7, 3));
    let both = fitted(&chain, &data);
    let spread = |fit: &Fit<NoEffects>| fit.layout.joints.clone().map(|k| fit.covariance[(k, k)]).sum::<f64>().sqrt();
    println!("levels {:?}, spread {:.2e} of {:.2e}", both.noise.levels, spread(&both), spread(&alone));
    assert!((both.noise.levels[0] / 5e-5 - 1.0).abs() < 0.3, "{:?}", both.noise);
    assert!(both.noise.levels[1..].iter().all(|level| (level / 1e-5 - 1.0).abs() < 0.3), "{:?}", both.noise);
    assert!(spread(&both) < 0.7 * spread(&alone));
}

#[test]
fn planes_can_be_kept_for_judging_and_poses_are_not_chosen_for_them() {
    let chain = panda();
    let run = simulate(&chain, &options(ObservationKind::Plane, 120), &NoEffects);
    let (train, held) = run.data.apart(&["3".into()]).unwrap();
    assert_eq!((train.len(), held.len()), (80, 40));
    let fit = fitted(&chain, &train);
    // A plane that no fit has seen lies where its rows have it.
    let arm = denavit_identify::residual_statistics::placed(&fit, &train, &held).unwrap();
    let left = denavit_identify::residual_statistics::residuals(&arm, &NoEffects, &held);
    let rms = (left.iter().map(|residual| residual.place.norm_squared()).sum::<f64>() / left.len() as f64).sqrt();
    let nominal = Arm { joints: chain.joints().to_vec(), ..arm };
    let before = denavit_identify::residual_statistics::residuals(&nominal, &NoEffects, &held);
    let drawn = (before.iter().map(|residual| residual.place.norm_squared()).sum::<f64>() / 40.0).sqrt();
    println!("held-out plane: {:.3} mm rms, as drawn {:.3} mm", rms * 1e3, drawn * 1e3);
    assert!(rms < 0.2 * drawn);
    let error = plan(&chain, &PlanOptions::new(&chain, 10, ObservationKind::Plane)).unwrap_err().to_string();
    assert!(error.starts_with("poses cannot be planned for readings on planes"), "{error}");
}
