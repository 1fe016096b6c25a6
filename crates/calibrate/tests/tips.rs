//! Several tips of one tree in one fit: two arms on a torso that turns, and a Baxter.

#![allow(clippy::unwrap_used, clippy::print_stdout)] // Tests: a panic is a failure, what is printed is read.

use crate::hands::{TWO_ARMS, both};
use denavit_calibrate::calibration::{CalibrateOptions, calibrate};
use denavit_calibrate::{Arm, Freedom, IdentifyOptions, Tolerances};
use denavit_identify::arm::{Perturbation, RowState};
use denavit_identify::effects::candidates::candidates;
use denavit_identify::effects::survey::{Survey, with_run_order};
use denavit_identify::effects::{Conditions, Effect, EffectModel, KINDS, SavedEffects, Statics};
use denavit_identify::gauge;
use denavit_identify::identifiability::identifiability;
use denavit_identify::identify;
use denavit_identify::parameters::Effects as _;
use denavit_identify::parameters::Layout;
use denavit_identify::parameters::NoEffects;
use denavit_identify::residual::ResidualModel;
use denavit_identify::residual::Scratch;
use denavit_identify::simulate::effect_specification::{EffectSpecification, specified_effects};
use denavit_identify::simulate::{SimulationOptions, simulate, simulate_arm};
use denavit_measurements::import::ImportOptions;
use denavit_measurements::kinds::ObservationKind;
use denavit_measurements::{Measurements, MissingColumn, RecordedRow, Units, read, read_export, write};
use denavit_model::nalgebra::Vector3;
use denavit_model::{Chain, PlacedRobot, Reading, Tips, se3, urdf};
use denavit_trace::TraceOptions;
use std::sync::Arc;

const BAXTER: &str = include_str!("../../../robots/rethink/baxter.urdf");

fn options(tips: &Arc<Tips>, rows: usize, seed: u64) -> SimulationOptions {
    SimulationOptions { kind: ObservationKind::Pose, rows, seed, tips: Some(tips.clone()), ..Default::default() }
}

#[test]
fn derivatives_are_differences_and_joints_of_the_other_arm_have_none() {
    let (chain, tips, _) = both(TWO_ARMS);
    for kind in [ObservationKind::Pose, ObservationKind::Position, ObservationKind::Distance] {
        let run = simulate(&chain, &SimulationOptions { kind, targets: 2, ..options(&tips, 6, 3) }, &NoEffects);
        let all = vec![true; chain.joints().len()];
        let freedom = Freedom { axes: all.clone(), scales: all.clone(), pitches: all.clone(), zeros: all };
        let layout = Layout::new(&chain, &run.data.scene, &freedom, &Tolerances::default(), Vec::new());
        let model = ResidualModel { data: &run.data, layout: &layout, effects: &NoEffects };
        let (height, columns, step) = (run.data.tallest_row(), layout.len(), 1e-6);
        for row in 0..run.data.len() {
            let at = |arm: &Arm| {
                let mut residual = vec![0.0; height];
                model.row_into(arm, row, &mut Scratch::new(&layout, arm), &mut residual, None);
                residual
            };
            let (mut residual, mut jacobian) = (vec![0.0; height], vec![0.0; height * columns]);
            let mut scratch = Scratch::new(&layout, &run.arm);
            model.row_into(&run.arm, row, &mut scratch, &mut residual, Some(&mut jacobian));
            for column in 0..columns {
                let moved = |by: f64| {
                    let mut change = vec![0.0; columns];
                    change[column] = by;
                    at(&layout.stepped(&run.arm, &change))
                };
                let off = layout.parameters[column].kind.joint();
                let off = off.is_some_and(|joint| !tips[run.data.tip_of(row)].joints[joint]);
                for (line, (ahead, behind)) in
                    moved(step).iter().zip(moved(-step)).enumerate().take(model.height_of(row))
                {
                    let (found, expected) = (jacobian[line * columns + column], (ahead - behind) / (2.0 * step));
                    let name = &layout.parameters[column].name;
                    assert!(
                        (found - expected).abs() < 1e-8 * (1.0 + expected.abs()),
                        "{kind:?} {name}: {found} {expected}"
                    );
                    assert!(!off || found == 0.0, "{kind:?} {name}");
                }
            }
        }
    }
}

#[test]
fn simd_rows_sum_what_rows_sum_however_the_rows_are_mixed() {
    let (chain, tips, _) = both(TWO_ARMS);
    for kind in [ObservationKind::Pose, ObservationKind::Position] {
        let run = simulate(&chain, &SimulationOptions { kind, ..options(&tips, 61, 5) }, &NoEffects);
        let mut order: Vec<usize> = (0..run.data.len()).collect();
        order.sort_by_key(|&row| run.data.tip_of(row));
        for data in [run.data.clone(), run.data.subset(&order)] {
            let all = vec![true; chain.joints().len()];
            let freedom = Freedom { axes: all.clone(), scales: all.clone(), pitches: all.clone(), zeros: all };
            let layout = Layout::new(&chain, &data.scene, &freedom, &Tolerances::default(), Vec::new());
            let model = ResidualModel { data: &data, layout: &layout, effects: &NoEffects };
            let arm = Arm { instruments: vec![denavit_model::Pose::identity()], ..run.arm.clone() };
            let weights = vec![1.0; data.observations()];
            let simd_rows = model.sums(&arm, &weights);
            let (height, n) = (data.tallest_row(), layout.len());
            let (mut residual, mut jacobian) = (vec![0.0; height], vec![0.0; height * n]);
            let (mut matrix, mut scratch) = (vec![0.0; n * n], Scratch::new(&layout, &arm));
            for row in 0..data.len() {
                model.row_into(&arm, row, &mut scratch, &mut residual, Some(&mut jacobian));
                for line in jacobian.chunks_exact(n).take(model.height_of(row)) {
                    (0..n * n).for_each(|at| matrix[at] += line[at / n] * line[at % n]);
                }
            }
            let size = |k: usize| matrix[k * n + k].sqrt() + 1e-300;
            for i in 0..n {
                for k in i..n {
                    let found: f64 = simd_rows.channels.iter().map(|channel| channel.matrix[i * n + k]).sum();
                    let apart = (found - matrix[i * n + k]).abs() / (size(i) * size(k) + 1e-12);
                    assert!(apart < 1e-11, "{kind:?} {i} {k}: {found} {}", matrix[i * n + k]);
                }
            }
        }
    }
}

#[test]
fn noise_free_rows_of_both_arms_give_the_robot_back() {
    for text in [TWO_ARMS, BAXTER] {
        let (chain, tips, _) = both(text);
        for kind in [ObservationKind::Pose, ObservationKind::Position] {
            let still =
                SimulationOptions { kind, noise_position: 0.0, noise_orientation: 0.0, ..options(&tips, 120, 7) };
            let run = simulate(&chain, &still, &NoEffects);
            let found = identify(&chain, &run.data, &IdentifyOptions::axes(&chain)).geometric;
            let later = SimulationOptions { rows: 200, seed: 99, ..still };
            let test = simulate_arm(&run.arm, &later, &NoEffects);
            let model = ResidualModel { data: &test.data, layout: &found.layout, effects: &NoEffects };
            let error = model.squares(&found.arm).iter().map(|square| square[0]).fold(0.0, f64::max).sqrt();
            println!("{} {kind:?}: {error:.2e} m after {} steps", chain.name(), found.iterations);
            assert!(error < 1e-12, "{} {kind:?}: {error:e}", chain.name());
        }
    }
}

#[test]
fn intervals_hold_the_truth_and_the_error_is_the_bound() {
    let (chain, tips, _) = both(TWO_ARMS);
    let (mut inside, mut count, mut chi, mut squares) = (0.0, 0.0, 0.0, 0.0);
    let runs = 100u32;
    for seed in 0..runs {
        let asked = options(&tips, 100, u64::from(seed));
        let run = simulate(&chain, &asked, &NoEffects);
        let found = identify(&chain, &run.data, &IdentifyOptions::axes(&chain));
        let fit = found.geometric;
        let truth = gauge::centred(&fit.layout, &run.arm, &found.nominal.arm);
        let (a, b) = (fit.layout.difference(&truth, &truth), fit.layout.difference(&fit.arm, &truth));
        for k in fit.layout.joints.clone() {
            let off = (a[k] - b[k]).abs() / fit.deviation(k);
            count += 1.0;
            inside += f64::from(u8::from(off < 1.96));
            // The covariance is the Cramér-Rao bound with what the prior knows.
            squares += off * off;
        }
        let sum: f64 = fit.squares.iter().map(|square| (square[0] + square[1]) / asked.noise_position.powi(2)).sum();
        let freedom = fit.values.iter().sum::<f64>() - fit.parameters_used.iter().sum::<f64>();
        chi += sum / freedom / f64::from(runs);
    }
    let over_bound = (squares / count).sqrt();
    println!("inside {:.2} %, error over bound {over_bound:.3}, chi2/dof {chi:.4}", 100.0 * inside / count);
    assert!((0.93..0.97).contains(&(inside / count)) && (0.95..1.05).contains(&over_bound) && (chi - 1.0).abs() < 0.02);
}

/// The rows of one tip alone, for a chain of its own.
fn alone(data: &Measurements, tip: &str, chain: &Chain) -> Measurements {
    let text = write(data, &[]);
    let mut lines = text.lines();
    let header = lines.next().unwrap();
    let column = header.split(',').position(|name| name == "tip").unwrap();
    let own = lines.filter(|line| line.split(',').nth(column) == Some(tip));
    let text: Vec<&str> = std::iter::once(header).chain(own).collect();
    read("alone.csv", text.join("\n").as_bytes(), chain, Units::default()).unwrap().data
}

#[test]
fn the_torso_is_known_better_from_both_arms_than_from_one() {
    let (chain, tips, chains) = both(TWO_ARMS);
    let run = simulate(&chain, &options(&tips, 120, 11), &NoEffects);
    let deviations = |chain: &Chain, data: &Measurements| -> Vec<f64> {
        let fit = identify(chain, data, &IdentifyOptions::axes(chain)).geometric;
        let of_torso = |k: &usize| fit.layout.parameters[*k].name.starts_with("torso_turn.");
        fit.layout.joints.clone().filter(of_torso).map(|k| fit.deviation(k)).collect()
    };
    let together = deviations(&chain, &run.data);
    assert_eq!(together.len(), 4);
    for (tip, own) in ["left_hand", "right_hand"].into_iter().zip(&chains) {
        let single = deviations(own, &alone(&run.data, tip, own));
        println!("{tip} alone {single:?}, both {together:?}");
        assert!(together.iter().zip(&single).all(|(both, one)| *both < 0.95 * one), "{together:?} {single:?}");
    }
}

#[test]
fn two_arms_that_share_nothing_are_fitted_as_in_two_fits() {
    let (chain, tips, chains) = both(BAXTER);
    let run = simulate(&chain, &options(&tips, 140, 13), &NoEffects);
    let text = write(&run.data, &[]);
    // An instrument of its own for each arm.
    let own: Vec<String> = text
        .lines()
        .enumerate()
        .map(
            |(k, line)| {
                if k == 0 { format!("{line},setup") } else { format!("{line},{}", line.rsplit(',').next().unwrap()) }
            },
        )
        .collect();
    let import = ImportOptions { tips: Some(tips.clone()), ..ImportOptions::default() };
    let data = read_export("both.csv", own.join("\n").as_bytes(), &chain, Units::default(), &import).unwrap().data;
    assert_eq!(data.scene.setups, ["left_hand", "right_hand"]);
    let found = identify(&chain, &data, &IdentifyOptions::axes(&chain)).geometric;
    assert_eq!(found.layout.frames.count, 2);
    let together = found.layout.difference(&found.arm, &found.arm);
    for (index, (tip, own)) in ["left_hand", "right_hand"].into_iter().zip(&chains).enumerate() {
        let fit = identify(own, &alone(&run.data, tip, own), &IdentifyOptions::axes(own)).geometric;
        let single = fit.layout.difference(&fit.arm, &fit.arm);
        for k in fit.layout.joints.clone() {
            let name = &fit.layout.parameters[k].name;
            let at = found.layout.parameters.iter().position(|parameter| parameter.name == *name).unwrap();
            let apart = (single[k] - together[at]).abs() / fit.deviation(k);
            // The noise level is one for both arms together.
            let spread = (fit.deviation(k) / found.deviation(at) - 1.0).abs();
            assert!(apart < 0.1 && spread < 0.1, "{name}: {apart:e} of its deviation apart, spread {spread}");
        }
        let q: Vec<f64> = vec![0.3; own.coordinates().len()];
        let (turned, moved) = se3::difference(&found.arm.chain_to(index).fk(&q), &fit.arm.chain().fk(&q));
        assert!(turned < 1e-5 && moved < 1e-5, "{tip}: {turned} {moved}");
    }
    // Both seen by one instrument, they are held together by it.
    let shared = identify(&chain, &run.data, &IdentifyOptions::axes(&chain)).geometric;
    assert_eq!(shared.layout.frames.count, 1);
}

#[test]
fn a_baxter_of_two_arms_has_as_many_numbers_as_the_rows_tell() {
    let (chain, tips, _) = both(BAXTER);
    assert_eq!(chain.joints().len(), 14);
    let run = simulate(&chain, &options(&tips, 200, 17), &NoEffects);
    let found = identifiability(&run.data, &run.arm, &NoEffects, &Freedom::axes(14));
    assert_eq!((found.formula.as_str(), found.expected, found.rank), ("4·14 + 12", 68, 68));
    assert!(found.unidentifiable.is_empty(), "{:?}", found.unidentifiable);
}

#[test]
fn a_setup_may_see_one_arm_alone_and_rows_may_leave_the_other_arm_out() {
    let (chain, tips, chains) = both(TWO_ARMS);
    let run = simulate(&chain, &options(&tips, 120, 19), &NoEffects);
    let import = ImportOptions { tips: Some(tips.clone()), ..ImportOptions::default() };
    let reread = |text: &str| read_export("rows.csv", text.as_bytes(), &chain, Units::default(), &import);
    let text = write(&run.data, &[]);
    // The other arm's readings are left empty.
    let blank: Vec<String> = text
        .lines()
        .enumerate()
        .map(|(k, line)| {
            let cells = line.split(',').enumerate().map(|(column, cell)| {
                let off = k > 0 && column < 13 && !tips[(k - 1) % 2].coordinates[column];
                if off { "" } else { cell }
            });
            cells.collect::<Vec<_>>().join(",")
        })
        .collect();
    let (full, blank) = (reread(&text).unwrap().data, reread(&blank.join("\n")).unwrap());
    assert!(blank.notes.is_empty(), "{:?}", blank.notes);
    let fit = |data: &Measurements| identify(&chain, data, &IdentifyOptions::axes(&chain)).geometric;
    assert_eq!(fit(&full).arm, fit(&blank.data).arm);
    // A second instrument sees the left arm alone.
    let left = alone(&run.data, "left_hand", &chains[0]);
    let later = simulate(&chain, &SimulationOptions { readings: None, ..options(&tips, 60, 23) }, &NoEffects).arm;
    let second = Arm { joints: run.arm.joints.clone(), ..later };
    let more = simulate_arm(&second, &options(&tips, 80, 29), &NoEffects).data;
    let own: Vec<usize> = (0..more.len()).filter(|&row| more.tip_of(row) == 0).collect();
    let parts = vec![full.of_setup("hall"), more.subset(&own).pruned().of_setup("cell")];
    let data = Measurements::joined(parts).unwrap();
    assert_eq!(data.scene.targets, ["left_hand@hall", "right_hand@hall", "left_hand@cell"]);
    let (one, two) = (fit(&run.data), fit(&data));
    let mut better = 0;
    for k in one.layout.joints.clone() {
        assert!(two.deviation(k) < 1.15 * one.deviation(k), "{}", one.layout.parameters[k].name);
        better += usize::from(two.deviation(k) < 0.95 * one.deviation(k));
    }
    assert!(better > 12 && left.len() == 60, "{better}");
}

#[test]
fn held_out_rows_are_judged_by_tip() {
    let (chain, tips, _) = both(TWO_ARMS);
    let run = simulate(&chain, &options(&tips, 150, 31), &NoEffects);
    let statics = Statics::of_chain(&chain);
    let geometry = CalibrateOptions {
        hold_out: Some(denavit_calibrate::calibration::HoldOut { share: 0.2, seed: 1 }),
        ..CalibrateOptions::geometry(&chain)
    };
    let result = calibrate(&chain, &statics, run.data.clone(), None, &geometry).unwrap();
    let found = &result.report.tips;
    assert_eq!(found.iter().map(|tip| tip.tip.as_str()).collect::<Vec<_>>(), ["left_hand", "right_hand"]);
    assert_eq!(found.iter().map(|tip| tip.fitted + tip.held_out).sum::<usize>(), 150);
    assert!(found.iter().all(|tip| tip.joints.len() == 7 && tip.joints[0] == "torso_turn"));
    for tip in found {
        let off = tip.test.as_ref().unwrap().of("position").unwrap().rms;
        assert!((6e-5..1.6e-4).contains(&off), "{off}");
    }
    let text = denavit_calibrate::report::text::report(&result);
    assert!(text.contains("base to left_hand, right_hand") && text.contains("by tip"), "{text}");
    let page = denavit_calibrate::report::html::page(&result).unwrap();
    assert!(page.contains("table to right_hand, as calibrated"));
    // What gravity acts on must be known on the ways to both.
    let effects =
        CalibrateOptions { trace: Some(TraceOptions::new(IdentifyOptions::axes(&chain))), ..geometry.clone() };
    let error = calibrate(&chain, &statics, run.data.clone(), None, &effects).unwrap_err().to_string();
    assert!(error.contains("Statics::placed_tips"), "{error}");
    let left: Vec<usize> = (0..run.data.len()).filter(|&row| run.data.tip_of(row) == 0).collect();
    let error = calibrate(&chain, &statics, run.data.subset(&left), None, &geometry).unwrap_err().to_string();
    assert_eq!(error, "simulation: no row is of tip \"right_hand\"; measure some, or name only the other tips");
}

/// Both hands, and what gravity acts on.
fn weighed(text: &str) -> (Chain, Arc<Tips>, Statics) {
    let (chain, tips, _) = both(text);
    let robot = urdf::read("robot", text).unwrap();
    let statics = Statics::placed_tips(&PlacedRobot::new(&robot, Reading::Intended), &chain, &tips);
    (chain, tips, statics)
}

#[test]
fn a_torso_carries_both_arms() {
    for text in [TWO_ARMS, BAXTER] {
        let (chain, tips, mut statics) = weighed(text);
        // On a torso that stands askew every joint is loaded.
        statics.masses.gravity = Vector3::new(3.0, -4.0, -8.0);
        let q: Vec<f64> = (0..chain.coordinates().len()).map(|k| 0.7 * (k as f64).sin()).collect();
        let at = |q: &[f64], tip: usize| {
            statics.posture(
                statics.chain.joints(),
                &Conditions { reading: q, recorded: RecordedRow::nothing(), tip },
                None,
            )
        };
        let energy = |q: &[f64]| -> f64 {
            let posture = at(q, 0);
            let points = statics.masses.points.iter();
            let heights = points.map(|p| (p.mass, posture.state.after[p.joint] * p.centre));
            heights.map(|(mass, centre)| -mass * statics.masses.gravity.dot(&centre.coords)).sum()
        };
        for (joint, moving) in chain.joints().iter().enumerate() {
            let moved = |by: f64| {
                let mut q = q.clone();
                q[moving.coordinate] += by;
                energy(&q)
            };
            let slope = (moved(1e-5) - moved(-1e-5)) / 2e-5;
            for tip in 0..tips.all().len() {
                let torque = statics.torque(&at(&q, tip), joint) * moving.scale;
                assert!((torque + slope).abs() < 1e-5 * (1.0 + slope.abs()), "{}: {torque} {slope}", moving.name);
            }
        }
    }
}

#[test]
fn effects_have_their_derivatives_in_rows_of_their_arm_and_none_in_the_others() {
    let (chain, tips, statics) = weighed(TWO_ARMS);
    let run = simulate(&chain, &options(&tips, 8, 3), &NoEffects);
    let data = with_run_order(run.data.clone());
    let survey = Survey::of(&statics, &data, Vec::new());
    let mut seen: Vec<(String, usize)> = Vec::new();
    for entry in KINDS {
        for candidate in candidates(entry.kind, &survey) {
            let term = candidate.term;
            let place = (format!("{:?} {:?}", term.kind, term.carrier), term.driver.len(&statics));
            if seen.contains(&place) {
                continue;
            }
            seen.push(place.clone());
            let model = EffectModel::of_terms(&statics, None, std::slice::from_ref(&term));
            let freedom = Freedom::axes(chain.joints().len());
            let layout = Layout::new(&chain, &data.scene, &freedom, &Tolerances::default(), model.parameters());
            let (height, columns, step) = (data.tallest_row(), layout.len(), 1e-7);
            for row in 0..data.len() {
                let with = |index: usize, by: f64| {
                    let mut model = model.clone();
                    model.effects[0].coefficients[index] = by;
                    let mut residual = vec![0.0; height];
                    let problem = ResidualModel { data: &data, layout: &layout, effects: &model };
                    problem.row_into(&run.arm, row, &mut problem.scratch(&run.arm), &mut residual, None);
                    residual
                };
                let (mut residual, mut jacobian) = (vec![0.0; height], vec![0.0; height * columns]);
                let problem = ResidualModel { data: &data, layout: &layout, effects: &model };
                let mut scratch = problem.scratch(&run.arm);
                problem.row_into(&run.arm, row, &mut scratch, &mut residual, Some(&mut jacobian));
                let off = term.carrier.joint().is_some_and(|joint| !tips[data.tip_of(row)].joints[joint]);
                for index in 0..model.effects[0].coefficients.len() {
                    let (ahead, behind) = (with(index, step), with(index, -step));
                    for line in 0..problem.height_of(row) {
                        let found = jacobian[line * columns + layout.effects.start + index];
                        let expected = (ahead[line] - behind[line]) / (2.0 * step);
                        let apart = (found - expected).abs();
                        assert!(apart < 1e-5 * (1.0 + expected.abs()), "{place:?}: {found} {expected}");
                        assert!(!off || found == 0.0, "{place:?}");
                    }
                }
            }
        }
    }
    assert!(seen.len() > 60, "{}", seen.len());
}

#[test]
fn effects_of_one_tip_act_as_they_do_among_those_of_all() {
    let (chain, tips, statics) = weighed(TWO_ARMS);
    let data = with_run_order(simulate(&chain, &options(&tips, 8, 3), &NoEffects).data);
    let survey = Survey::of(&statics, &data, Vec::new());
    let mut effects: Vec<Effect> = Vec::new();
    for candidate in KINDS.iter().flat_map(|entry| candidates(entry.kind, &survey)) {
        let term = candidate.term;
        let alike = |other: &Effect| {
            other.term.kind == term.kind
                && other.term.carrier == term.carrier
                && std::mem::discriminant(&other.term.driver) == std::mem::discriminant(&term.driver)
        };
        if term.driver.columns().is_empty() && !effects.iter().any(alike) {
            let coefficients = (0..term.coefficients(&statics)).map(|k| 1e-6 * (1.0 + k as f64)).collect();
            effects.push(Effect { term, coefficients });
        }
    }
    let model = EffectModel::new(statics, effects);
    let arm = Arm::new(&chain, &data.scene);
    for (index, tip) in tips.all().iter().enumerate() {
        // The other arm hangs as at home.
        let q: Vec<f64> =
            tip.coordinates.iter().enumerate().map(|(k, own)| if *own { 0.3 + 0.1 * k as f64 } else { 0.0 }).collect();
        let own: Vec<f64> = q.iter().zip(&tip.coordinates).filter(|(_, own)| **own).map(|(q, _)| *q).collect();
        let conditions = |reading| Conditions { reading, recorded: RecordedRow::nothing(), tip: 0 };
        let alone = model.to_tip(index).fk(&tip.chain(&chain).unwrap(), &conditions(&own));
        let mut perturbation = Perturbation::none(chain.joints().len());
        model.add_perturbation(&Conditions { tip: index, ..conditions(&q) }, chain.joints(), &mut perturbation);
        let mut state = RowState::default();
        arm.state_into(&q, index, Some(&perturbation), &mut state);
        let (turned, moved) = se3::difference(&alone, &state.tip);
        assert!(turned < 1e-12 && moved < 1e-12, "{}: {turned} {moved}", tip.name);
        assert!((alone.translation.vector - tip.fk(&chain, &q).translation.vector).norm() > 1e-6);
        // As a file has it, too.
        let text = model.to_tip(index).to_json();
        let statics = model.to_tip(index).statics;
        SavedEffects::from_json("effects.json", &text, &statics).unwrap();
    }
}

#[test]
fn compliance_of_one_arm_is_found_at_its_joint() {
    for (text, rows, place) in [(TWO_ARMS, 300, "left_shoulder_lift"), (BAXTER, 300, "right_s1")] {
        let (chain, tips, statics) = weighed(text);
        let asked = options(&tips, rows, 11);
        let bare = simulate(&chain, &asked, &NoEffects);
        let soft: EffectSpecification = format!("joint_compliance@{place}=0.4mm").parse().unwrap();
        let model = specified_effects(&[soft], &statics, &bare, 1).unwrap();
        let mut data = simulate(&chain, &asked, &model).data;
        if text == TWO_ARMS {
            // Cells of the other arm are left empty.
            let n = chain.coordinates().len();
            for row in 0..data.len() {
                let moved = &tips[data.tip_of(row)].coordinates;
                (0..n).filter(|&k| !moved[k]).for_each(|k| data.readings[row * n + k] = 0.0);
            }
        }
        let geometry = CalibrateOptions::geometry(&chain);
        let effects = CalibrateOptions { trace: Some(TraceOptions::new(geometry.identify.clone())), ..geometry };
        let result = calibrate(&chain, &statics, data, None, &effects).unwrap();
        let found: Vec<(&str, Option<&str>)> =
            result.report.effects.iter().map(|effect| (&effect.kind[..], effect.joint.as_deref())).collect();
        assert_eq!(found, [("joint_compliance", Some(place))]);
        let truth = model.effects[0].coefficients[0];
        let value = &result.trace.as_ref().unwrap().findings[0].values[0];
        assert!((value.value - truth).abs() < 4.5 * value.std.unwrap(), "{} {truth}", value.value);
        assert!(!result.report.unexplained.structured);
    }
}

/// Two arms with compliances in torso and shoulder, the same postures seen by both hands: rows to fit and to judge by.
fn soft_arms(rows: usize) -> (Chain, Statics, Measurements, Measurements) {
    let (chain, tips, statics) = weighed(TWO_ARMS);
    let asked = SimulationOptions { kind: ObservationKind::Position, ..options(&tips, rows + 200, 17) };
    let bare = simulate(&chain, &asked, &NoEffects);
    let soft = [
        "axis_wobble@torso_turn=0.3mm",
        "joint_compliance@left_shoulder_lift=0.4mm",
        "transmission_error@right_elbow=0.2mm",
    ];
    let soft: Vec<EffectSpecification> = soft.iter().map(|text| text.parse().unwrap()).collect();
    let model = specified_effects(&soft, &statics, &bare, 1).unwrap();
    let data = simulate(&chain, &asked, &model).data;
    let all: Vec<usize> = (0..data.len()).collect();
    (chain, statics, data.subset(&all[..rows]), data.subset(&all[rows..]))
}

#[test]
fn both_hands_are_predicted_better_by_everything_averaged_than_by_geometry_alone() {
    for rows in [30, 120] {
        let (chain, statics, train, test) = soft_arms(rows);
        let options = CalibrateOptions { average: true, ..CalibrateOptions::geometry(&chain) };
        let result = calibrate(&chain, &statics, train, Some(test), &options).unwrap();
        let error = |stage: usize| result.report.stages[stage].test.as_ref().unwrap().of("position").unwrap().rms;
        println!("{rows} rows: geometric {:.6}, averaged {:.6}", error(1), error(2));
        assert_eq!(result.report.stages[2].name, "averaged");
        assert!(error(2) < if rows > 100 { 0.6 } else { 1.0 } * error(1), "{rows}: {} {}", error(1), error(2));
    }
}

#[test]
fn what_is_averaged_for_one_tip_predicts_as_it_does_among_those_of_all_in_a_file_too() {
    let (chain, statics, train, _) = soft_arms(120);
    let options = CalibrateOptions { average: true, ..CalibrateOptions::geometry(&chain) };
    let result = calibrate(&chain, &statics, train, None, &options).unwrap();
    let (model, arm, tips) = (result.effects(&statics), result.arm(), &statics.tips);
    assert!(model.averaged.is_some());
    for (index, tip) in tips.all().iter().enumerate() {
        // The other arm hangs as at home; once inside of what was measured, once outside.
        for size in [0.3, 3.0] {
            let q: Vec<f64> = tip.coordinates.iter().map(|own| if *own { size } else { 0.0 }).collect();
            let own: Vec<f64> = q.iter().zip(&tip.coordinates).filter(|(_, own)| **own).map(|(q, _)| *q).collect();
            let conditions = |reading| Conditions { reading, recorded: RecordedRow::nothing(), tip: 0 };
            let mut perturbation = Perturbation::none(chain.joints().len());
            model.add_perturbation(&Conditions { tip: index, ..conditions(&q) }, &arm.joints, &mut perturbation);
            let mut state = RowState::default();
            arm.state_into(&q, index, Some(&perturbation), &mut state);
            let alone = model.to_tip(index);
            let saved = SavedEffects::from_json("effects.json", &alone.to_json(), &alone.effects.statics).unwrap();
            let absent = |name: &str| Err(MissingColumn::Absent { file: "none".into(), column: name.into() });
            for model in [&alone, &saved.bound(&absent).unwrap()] {
                let (turned, moved) = se3::difference(&model.fk(&arm.chain_to(index), &conditions(&own)), &state.tip);
                assert!(turned < 1e-9 && moved < 1e-9, "{} at {size}: {turned} {moved}", tip.name);
            }
            let plain = arm.chain_to(index).fk(&own);
            assert!((plain.translation.vector - state.tip.translation.vector).norm() > 1e-6);
        }
    }
}

#[test]
fn a_row_without_its_tip_is_named() {
    let (chain, tips, chains) = both(TWO_ARMS);
    let text = write(&simulate(&chain, &options(&tips, 4, 1), &NoEffects).data, &[]);
    let import = ImportOptions { tips: Some(tips), ..ImportOptions::default() };
    let wrong = |text: &str| {
        read_export("rows.csv", text.as_bytes(), &chain, Units::default(), &import).unwrap_err().to_string()
    };
    assert_eq!(
        wrong(&text.replace("right_hand", "right_hnd")).lines().next().unwrap(),
        "rows.csv:3: column \"tip\": \"right_hnd\" is not among the calibrated tips; write the tip that the row was \
         measured at: left_hand or right_hand"
    );
    assert!(wrong(&text.replace("left_hand", "")).starts_with("rows.csv:2: column \"tip\": the cell is empty; write"));
    let without = text.replace(",tip\n", ",place\n");
    assert!(
        wrong(&without).contains("there is no column \"tip\", but several tips are calibrated"),
        "{}",
        wrong(&without)
    );
    let one = read("rows.csv", text.as_bytes(), &chains[0], Units::default()).unwrap_err().to_string();
    assert!(
        one.starts_with(
            "rows.csv:3: column \"tip\": the row belongs to \"right_hand\", but the chain ends at \"left_hand\""
        ),
        "{one}"
    );
}
