//! Rows as they come: none is blamed that fits, what is wrong is said at once, and the pose to measure next helps as promised.

use denavit_calibrate::apply::plan::PlanOptions;
use denavit_calibrate::calibration::monitor::{Monitor, MonitorOptions, RowStatus};
use denavit_calibrate::report::monitor::{json, knowledge, line};
use denavit_calibrate::{IdentifyOptions, Measurements};
use denavit_identify::arm::RowState;
use denavit_identify::parameters::NoEffects;
use denavit_identify::simulate::{Simulation, SimulationOptions, as_displayed, simulate, simulate_arm};
use denavit_measurements::kinds::ObservationKind;
use denavit_model::nalgebra::{Point3, Vector3, Vector6};
use denavit_model::{Chain, examples, se3};

fn monitor(chain: &Chain) -> Monitor {
    let plan = PlanOptions { spread: 200, ..PlanOptions::new(chain, 1, ObservationKind::Position) };
    Monitor::new(chain, MonitorOptions { identify: IdentifyOptions::axes(chain), plan }).unwrap()
}

fn watched(chain: &Chain, data: &Measurements) -> Vec<RowStatus> {
    let (mut monitor, mut all) = (monitor(chain), Vec::new());
    // Row by row, as they come.
    for row in 0..data.len() {
        let so_far: Vec<usize> = (0..=row).collect();
        let mut tell = |status| {
            all.push(status);
            true
        };
        monitor.take(&data.subset(&so_far), &mut tell).unwrap();
    }
    all
}

fn run(chain: &Chain, kind: ObservationKind, rows: usize, seed: u64) -> Simulation {
    let options = SimulationOptions { kind, rows, seed, ..Default::default() };
    let run = simulate(chain, &options, &NoEffects);
    Simulation { data: as_displayed(&run.data, &options), ..run }
}

/// Adds to what is measured in a row, m in the instrument's frame.
fn shifted(data: &mut Measurements, row: usize, by: Vector3<f64>) {
    let values = data.observed.values_mut(data.of_row(row).start);
    values.iter_mut().zip(by.iter()).for_each(|(value, by)| *value += by);
}

fn explained(status: &RowStatus) -> &[String] {
    &status.out_of_line.as_ref().unwrap_or_else(|| panic!("row {} is not out of line", status.row)).explanations
}

#[test]
fn rows_that_fit_are_not_blamed_and_are_as_far_off_as_is_said() {
    for chain in [examples::puma_like(), examples::scara_helical()] {
        for kind in [ObservationKind::Position, ObservationKind::Pose, ObservationKind::Distance] {
            let (mut sum, mut count, mut alarms) = (0.0, 0.0, 0);
            for seed in 0..4 {
                // One number a row: it takes more rows.
                let rows = if kind == ObservationKind::Distance { 60 } else { 40 };
                let statuses = watched(&chain, &run(&chain, kind, rows, seed).data);
                alarms += statuses.iter().filter(|status| status.out_of_line.is_some()).count();
                for off in statuses.iter().filter(|status| status.judged).flat_map(|status| &status.off) {
                    sum += (off.error / off.expected).powi(2);
                    count += 1.0;
                }
                let last = statuses.last().unwrap();
                assert!(last.lines_out_of_line.is_empty() && last.missing_numbers == 0);
                assert!(count > 15.0 * (seed + 1) as f64, "{} {kind:?}: {count} rows judged", chain.name());
            }
            let ratio = f64::sqrt(sum / count);
            println!("{} {kind:?}: {alarms} alarms, off / expected {ratio:.3} over {count} rows", chain.name());
            assert_eq!(alarms, 0, "{} {kind:?}", chain.name());
            assert!((0.8..1.2).contains(&ratio), "{} {kind:?}: {ratio}", chain.name());
        }
    }
}

#[test]
fn a_row_that_is_logged_twice_is_counted_once() {
    let chain = examples::puma_like();
    let data = run(&chain, ObservationKind::Position, 40, 1).data;
    let rows: Vec<usize> = (0..40).flat_map(|row| if row < 30 { vec![row] } else { vec![row, row] }).collect();
    let (once, twice) = (watched(&chain, &data), watched(&chain, &data.subset(&rows)));
    let copies: Vec<usize> = twice.iter().filter(|status| status.copy).map(|status| status.row).collect();
    assert_eq!(copies, (0..10).map(|copy| 32 + 2 * copy).collect::<Vec<_>>());
    let noise = |statuses: &[RowStatus]| statuses.last().unwrap().noise[0].error;
    assert!((noise(&once) / noise(&twice) - 1.0).abs() < 1e-3, "{} {}", noise(&once), noise(&twice));
    let units = denavit_measurements::Units::default();
    assert!(line(&twice[31], &chain, units).contains("an exact copy of an earlier row, not counted again"));
}

#[test]
fn another_reflector_is_seen_at_once_and_named_with_the_second_row() {
    let chain = examples::puma_like();
    let Simulation { arm, mut data, .. } = run(&chain, ObservationKind::Position, 30, 5);
    let mut state = RowState::default();
    for row in [20, 21] {
        arm.state_into(data.reading(row), 0, None, &mut state);
        let shift = arm.instruments[0].rotation * state.tip.rotation * Vector3::new(0.0, 0.0, 12.7e-3);
        shifted(&mut data, row, shift);
    }
    let statuses = watched(&chain, &data);
    let out: Vec<usize> = statuses.iter().filter(|status| status.out_of_line.is_some()).map(|s| s.row).collect();
    assert_eq!(out, [21, 22]);
    let words = explained(&statuses[21]);
    assert!(words.len() == 1 && words[0].starts_with("the target has moved by 12."), "{words:?}");
    let last = statuses.last().unwrap();
    // They stay out of the fit: the noise is that of the others.
    assert_eq!(last.lines_out_of_line, [data.lines[20], data.lines[21]]);
    assert!((3e-5..8e-5).contains(&last.noise[0].error), "{:?}", last.noise);
}

#[test]
fn a_base_that_slips_is_distinguished_from_other_mistakes() {
    let chain = examples::puma_like();
    let Simulation { arm, mut data, .. } = run(&chain, ObservationKind::Position, 30, 6);
    let slip = se3::exp(&Vector6::new(0.0, 0.0, 2e-3, 3e-3, 0.0, 0.0));
    for row in 24..30 {
        let instrument = arm.instruments[0];
        let seen = Point3::from(data.position(row, 0).unwrap());
        let there = instrument * slip * (instrument.inverse() * seen);
        shifted(&mut data, row, there - seen);
    }
    let statuses = watched(&chain, &data);
    assert!(statuses[..24].iter().all(|status| status.out_of_line.is_none()));
    assert!(statuses[24..].iter().all(|status| status.out_of_line.is_some()));
    // Three rows tell a motion in space.
    let words = explained(&statuses[26]);
    assert!(words.len() == 1 && words[0].contains("the instrument or the robot's base has moved by"), "{words:?}");
    assert!(explained(&statuses[29])[0].contains("and 0.11"), "2 mrad are 0.115°: {:?}", explained(&statuses[29]));
}

#[test]
fn a_joint_that_stands_elsewhere_than_it_reads_is_named() {
    let chain = examples::puma_like();
    let mut data = run(&chain, ObservationKind::Pose, 30, 7).data;
    let n = data.joints.len();
    data.readings[25 * n + 2] -= 0.01;
    let statuses = watched(&chain, &data);
    let expected = format!("joint {} is +0.57", data.joints[2]);
    assert!(explained(&statuses[25])[0].starts_with(&expected), "{:?}", explained(&statuses[25]));
    assert_eq!(statuses.iter().filter(|status| status.out_of_line.is_some()).count(), 1);
}

#[test]
fn a_reading_that_came_late_is_said_to_have() {
    let chain = examples::puma_like();
    let mut data = run(&chain, ObservationKind::Position, 25, 8).data;
    let before = data.observed.values(21).to_vec();
    data.observed.values_mut(22).copy_from_slice(&before);
    let statuses = watched(&chain, &data);
    assert!(explained(&statuses[22])[0].contains("repeats the row before"), "{:?}", explained(&statuses[22]));
}

#[test]
fn the_next_pose_helps_as_much_as_it_promises() {
    let chain = examples::puma_like();
    let options = SimulationOptions { rows: 12, seed: 9, ..Default::default() };
    let first = simulate(&chain, &options, &NoEffects);
    let (mut monitor, mut data) = (monitor(&chain), first.data.clone());
    let mut predictions = Vec::new();
    let mut last: Option<RowStatus> = None;
    for step in 0..10 {
        let mut status = None;
        monitor
            .take(&data, &mut |found| {
                status = Some(found);
                true
            })
            .unwrap();
        let status = status.unwrap();
        if let Some(before) = &last {
            // The worst parameter of before, as it was promised; the noise is estimated anew.
            let (worst, noise) =
                (&before.known.as_ref().unwrap().worst[0], status.noise[0].error / before.noise[0].error);
            let now = status.known.as_ref().unwrap().worst.iter().find(|now| now.parameter == worst.parameter);
            if let Some(now) = now {
                let promised = worst.std_after_next.unwrap() * noise;
                assert!((now.std / promised - 1.0).abs() < 0.25, "step {step}: {} {promised}", now.std);
            }
        }
        predictions.push(status.known.as_ref().unwrap().prediction_std_m.unwrap());
        let next: Vec<f64> = status.next.as_ref().unwrap().iter().map(|(_, value)| *value).collect();
        let at = SimulationOptions { readings: Some(vec![next]), rows: 1, seed: 100 + step, ..options.clone() };
        data = Measurements::joined(vec![data, simulate_arm(&first.arm, &at, &NoEffects).data]).unwrap();
        last = Some(status);
    }
    // As many rows at random.
    let random = simulate_arm(&first.arm, &SimulationOptions { rows: 10, seed: 77, ..options }, &NoEffects).data;
    let data = Measurements::joined(vec![first.data, random]).unwrap();
    let worst = |status: &RowStatus| status.known.as_ref().unwrap().worst[0].std / status.noise[0].error;
    let (chosen, at_random) = (worst(&last.unwrap()), worst(watched(&chain, &data).last().unwrap()));
    println!("predictions {predictions:?}; worst over noise {chosen:.2}, after ten poses at random {at_random:.2}");
    assert!(chosen < at_random && predictions[10 - 1] < 0.7 * predictions[0]);
}

#[test]
fn before_there_is_a_fit_it_says_what_is_missing() {
    let chain = examples::puma_like();
    let statuses = watched(&chain, &run(&chain, ObservationKind::Position, 12, 1).data);
    assert_eq!((statuses[0].missing_numbers, statuses[2].missing_numbers, statuses[3].missing_numbers), (7, 1, 0));
    assert!(statuses[..3].iter().all(|status| status.off.is_empty() && status.known.is_none()));
    let units = denavit_measurements::Units::default();
    let text: String = statuses.iter().map(|status| line(status, &chain, units)).collect();
    println!("{text}{}", knowledge(&statuses[11], &chain, units));
    assert!(text.starts_with("line 2: too few rows to place the instrument and the target\n"));
    let value: serde_json::Value = serde_json::from_str(&json(&statuses[11], 0)).unwrap();
    assert_eq!((&value["schema"], &value["row"]), (&"denavit.measure/1".into(), &12.into()));
    assert_eq!(value["next"].as_object().unwrap().len(), 6);
}

#[test]
fn a_joint_that_counts_from_another_zero_is_said_once_and_read_so() {
    let chain = examples::puma_like();
    let right = run(&chain, ObservationKind::Position, 45, 6);
    let (quarter, mut data) = (std::f64::consts::FRAC_PI_2, right.data.clone());
    let n = chain.coordinates().len();
    data.readings.iter_mut().skip(2).step_by(n).for_each(|reading| *reading -= quarter);
    let statuses = watched(&chain, &data);
    let said: Vec<&RowStatus> = statuses.iter().filter(|status| status.read_as.is_some()).collect();
    assert_eq!(said.iter().map(|status| status.row).collect::<Vec<_>>(), [20]);
    let text = line(said[0], &chain, denavit_measurements::Units::default());
    println!("{text}");
    let name = &chain.coordinates()[2].name;
    assert!(text.starts_with("ATTENTION") && text.contains(&format!("\"{name}\" counted from 90°")), "{text}");
    let last = statuses.last().unwrap();
    assert!(last.judged && last.lines_out_of_line.is_empty(), "{last:?}");
    // As calibrate does with the same file; and what to measure next is said in the controller's readings.
    let plain = watched(&chain, &right.data);
    let [next, expected] = [last, plain.last().unwrap()].map(|status| status.next.clone().unwrap());
    for (k, ((_, next), (_, expected))) in next.iter().zip(&expected).enumerate() {
        assert!((next - expected + if k == 2 { quarter } else { 0.0 }).abs() < 1e-9, "{k}: {next} {expected}");
    }
}
