//! The paper's count against the numerical rank.

#![allow(clippy::unwrap_used, clippy::print_stdout)] // Tests: a panic is a failure, what is printed is read.

use denavit_calibrate::apply::identifiable::of_chain;
use denavit_calibrate::{Freedom, IdentifyOptions};
use denavit_identify::dh_form::dh_form;
use denavit_identify::identifiability::identifiability;
use denavit_identify::identify;
use denavit_identify::parameters::NoEffects;
use denavit_identify::simulate::{SimulationOptions, simulate};
use denavit_measurements::kinds::ObservationKind;
use denavit_model::examples;

#[test]
fn rank_is_the_papers_count() {
    for chain in examples::all() {
        let n = chain.joints().len();
        for (targets, scales) in [(1, false), (3, false), (1, true)] {
            let freedom = Freedom { scales: vec![scales; n], ..Freedom::axes(n) };
            for found in of_chain(&chain, &freedom, targets, 60) {
                let place = format!("{} {} {}", chain.name(), found.scene.measured(), found.formula);
                if chain.name() == "planar_arm" && found.scene.measured() == "distance" {
                    // Of two parallel axes as drawn, distances tell one number less, and its names are given.
                    assert_eq!(found.rank + 1, found.expected, "{place}");
                    assert!(
                        found.unidentifiable.iter().any(|unidentifiable| unidentifiable.parameter == "target.x"),
                        "{:?}",
                        found.unidentifiable
                    );
                } else {
                    assert_eq!(found.rank, found.expected, "{place}");
                    assert!(
                        found.unidentifiable.is_empty() && found.smallest > 1e-2,
                        "{place} {:?}",
                        found.unidentifiable
                    );
                }
            }
        }
        let readings: Vec<Vec<f64>> =
            (0..60).map(|row| (0..n).map(|k| ((row * 37 + k * 11) % 17) as f64 * 0.3 - 2.4).collect()).collect();
        let form = dh_form(&chain, &readings);
        assert_eq!((form.redundant_in_base, form.redundant_in_tool), (4, 2), "{}", chain.name());
        let poe = of_chain(&chain, &Freedom::axes(n), 1, 60)[0].rank;
        if form.parallel.is_empty() && form.prismatic.is_empty() {
            assert_eq!((form.numbers - 6, form.rank), (poe, poe), "{}", chain.name());
        } else if form.prismatic.is_empty() {
            // Each parallel pair costs a direction that only the POE form has.
            assert_eq!(form.rank, poe - form.parallel.len(), "{}", chain.name());
        }
    }
}

#[test]
fn a_joint_that_never_moves_is_named_and_left_at_nominal() {
    let chain = &examples::puma_like();
    for kind in [ObservationKind::Pose, ObservationKind::Position] {
        let mut run = simulate(chain, &SimulationOptions { kind, rows: 80, ..Default::default() }, &NoEffects);
        // The joint stands still, and the measured values are those of the robot standing so.
        let truth = run.arm.clone();
        for row in 0..run.data.len() {
            run.data.readings[row * 6 + 3] = 0.4;
        }
        for row in 0..run.data.len() {
            let pose = truth.instruments[0] * denavit_identify::simulate::true_target(&truth, run.data.reading(row), 0);
            let numbers = pose.translation.vector.iter().chain(pose.rotation.matrix().iter());
            run.data.observed.values_mut(row).iter_mut().zip(numbers).for_each(|(value, number)| *value = *number);
        }
        let freedom = Freedom::axes(6);
        let found = identifiability(&run.data, &run.arm, &NoEffects, &freedom);
        assert_eq!(found.rank, found.expected - 4);
        assert!(
            found
                .unidentifiable
                .iter()
                .all(|unidentifiable| unidentifiable.joint == "joint_4" && unidentifiable.why.contains("never moves"))
        );
        let fit = identify(chain, &run.data, &IdentifyOptions::axes(chain)).geometric;
        assert!(fit.noise.first() < 1e-11, "{}", fit.noise.first());
        let change = fit.arm.change(3);
        let largest = [change.turned, change.moved].concat().iter().fold(0.0f64, |a, b| a.max(b.abs()));
        assert!(largest < 1e-6, "{change:?}");
    }
}
