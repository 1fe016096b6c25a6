//! Chosen poses tell more than poses taken as they come; commands reach what they are for.

#![allow(clippy::unwrap_used, clippy::print_stdout)] // Tests: a panic is a failure, what is printed is read.

use denavit_calibrate::apply::compensate::{Wanted, compensate};
use denavit_calibrate::apply::plan::{PlanOptions, plan};
use denavit_identify::parameters::NoEffects;
use denavit_identify::simulate::{SimulationOptions, simulate};
use denavit_ik::Solver;
use denavit_measurements::Units;
use denavit_measurements::kinds::ObservationKind;
use denavit_model::nalgebra::{DMatrix, Point3, Vector6};
use denavit_model::{Screw, examples, se3};

#[test]
fn chosen_poses_are_more_observable_and_stay_in_the_box() {
    for chain in &examples::all()[1..] {
        for kind in [ObservationKind::Pose, ObservationKind::Position, ObservationKind::Distance] {
            let options = PlanOptions { spread: 300, ..PlanOptions::new(chain, 20, kind) };
            let free = plan(chain, &options).unwrap();
            println!("{} {kind:?}\n{}", chain.name(), free.to_text());
            assert_eq!(free.poses.len(), 20);
            assert!(free.observability.o1 > free.at_random.o1, "{}", chain.name());
            assert_eq!(free.to_csv(chain, Units::default()).lines().filter(|line| !line.starts_with('#')).count(), 21);
        }
        let half = [Point3::new(0.0, -9.0, -9.0), Point3::new(9.0, 9.0, 9.0)];
        let options = PlanOptions { allowed: Some(half), ..PlanOptions::new(chain, 12, ObservationKind::Position) };
        for pose in plan(chain, &options).unwrap().poses {
            assert!((chain.fk(&pose) * Point3::from(options.target)).x >= 0.0);
        }
        let none = PlanOptions { allowed: Some([Point3::new(50.0, 0.0, 0.0); 2]), ..options };
        assert_eq!(
            plan(chain, &none).unwrap_err().to_string(),
            "12 poses are wanted, but only 0 of 1000 candidates are within the limits and the box; allow more candidates or \
             choose fewer poses"
        );
    }
}

#[test]
fn commands_reach_the_wanted_pose_by_the_actual_robot() {
    let chain = examples::puma_like();
    let run =
        simulate(&chain, &SimulationOptions { turn: 2e-3, shift: 2e-3, rows: 40, ..Default::default() }, &NoEffects);
    let actual = run.arm.chain();
    let mut reached = 0;
    for row in 0..run.data.len() {
        let q = run.data.reading(row).to_vec();
        let command = compensate(&Solver::new(&chain), &actual, &|q| actual.fk(q), &Wanted::Joints(q.clone()), &q);
        let (turned, moved) = se3::difference(&actual.fk(&command.joints), &chain.fk(&q));
        assert!(command.uncompensated.0 > 1e-4 && (moved - command.position_error).abs() < 1e-15);
        // A stretched arm or wrist: the pose may be out of the actual robot's reach, and the command says so.
        let mut columns = vec![Vector6::zeros(); 6];
        chain.tip_jacobian_into(&q, &mut columns);
        let weakest = DMatrix::from_fn(6, 6, |i, k| columns[k][i]).singular_values().min();
        assert!(
            weakest < 0.05 || (moved < 1e-12 && turned < 1e-11),
            "row {row}: {moved:e} {turned:e}, weakest {weakest}"
        );
        reached += usize::from(moved < 1e-12);
    }
    assert!(reached > 30, "{reached}");
    let wanted = Wanted::Pose(chain.fk(&[0.3, -0.5, 0.8, 0.4, 0.9, -0.2]));
    let command = compensate(&Solver::new(&chain), &actual, &|q| actual.fk(q), &wanted, &[0.0; 6]);
    assert!(command.position_error < 1e-12 && command.outside.len() < 7, "{command:?}");
}

#[test]
fn a_robot_beyond_all_proportion_is_refused() {
    let chain = &examples::all()[1];
    for away in [1e6, 1e155, f64::MAX] {
        let screws: Vec<_> = chain
            .joints()
            .iter()
            .map(|joint| match joint.screw {
                Screw::Revolute(mut line) => {
                    line.point.x += away;
                    Screw::Revolute(line)
                }
                other => other,
            })
            .collect();
        let Ok(far) = chain.with_geometry(&screws, *chain.home()) else { continue };
        let error = plan(&far, &PlanOptions::new(&far, 10, ObservationKind::Position)).unwrap_err().to_string();
        assert!(error.contains("m from the base; no robot is that large"), "{error}");
        let readings = vec![vec![0.1; far.coordinates().len()]; 5];
        let freedom = denavit_calibrate::Freedom::axes(far.joints().len());
        let found = denavit_calibrate::apply::identifiable::at_readings(&far, &freedom, 1, &readings);
        assert!(found.len() == 3, "it ends");
    }
}
