//! Data that are not the robot's, or not as they are written: said, with what to do; never fitted to.

#![allow(clippy::unwrap_used, clippy::print_stdout)] // Tests: a panic is a failure, what is printed is read.

use super::measured::measured;
use super::real::{irb120, tiago};
use denavit_calibrate::Measurements;
use denavit_calibrate::calibration::{CalibrateOptions, calibrate};
use denavit_calibrate::report::text;
use denavit_export::sources::{self, Source, Stated};
use denavit_identify::effects::driver::Statics;
use denavit_identify::parameters::NoEffects;
use denavit_identify::simulate::{SimulationOptions, simulate, simulate_arm};
use denavit_measurements::kinds::ObservationKind;
use denavit_measurements::{Units, read};
use denavit_model::Chain;
use denavit_model::nalgebra::{Matrix3, Quaternion, Rotation3, UnitQuaternion, Vector3};
use denavit_model::tree::Reading;
use std::path::Path;

pub fn robot(path: &str) -> Chain {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../robots").join(path);
    let text = std::fs::read_to_string(file).unwrap();
    denavit_model::urdf::read(path, &text).unwrap().chain(None, None, Reading::Intended).unwrap().value
}

fn ur5e() -> Chain {
    robot("universal_robots/ur5e.urdf")
}

fn data(chain: &Chain, kind: ObservationKind, seed: u64) -> Measurements {
    simulate(chain, &SimulationOptions { kind, rows: 60, seed, ..SimulationOptions::default() }, &NoEffects).data
}

fn positions() -> Measurements {
    data(&ur5e(), ObservationKind::Position, 2)
}

fn refused(chain: &Chain, data: Measurements) -> String {
    let result = calibrate(chain, &Statics::of_chain(chain), data, None, &CalibrateOptions::geometry(chain));
    let said = result.map(|result| text::report(&result)).expect_err("this is no calibration").to_string();
    println!("{said}\n");
    said
}

fn each_row(mut data: Measurements, change: impl Fn(&mut [f64])) -> Measurements {
    let n = data.joints.len();
    data.readings.chunks_exact_mut(n).for_each(change);
    data
}

fn check(data: Measurements, mistake: &str, fix: &str) {
    let said = refused(&ur5e(), data);
    assert!(said.contains(mistake) && said.contains(fix), "{said}");
}

#[test]
fn a_reversed_sense_is_named() {
    for (joint, name) in [(1, "shoulder_lift_joint"), (4, "wrist_2_joint")] {
        let reversed = each_row(positions(), |row| row[joint] = -row[joint]);
        check(reversed, &format!("if joint \"{name}\" counts the other way"), "change the sign of these readings");
    }
    let two = each_row(positions(), |row| {
        row[0] = -row[0];
        row[3] = -row[3];
    });
    check(two, "joints \"shoulder_pan_joint\" and \"wrist_1_joint\" count the other way", "change the sign");
}

#[test]
fn swapped_columns_are_named() {
    check(
        each_row(positions(), |row| row.swap(1, 3)),
        "columns \"shoulder_lift_joint\" and \"wrist_1_joint\" were exchanged",
        "exchange their names in the header row",
    );
}

#[test]
fn one_column_in_another_unit_is_named() {
    let degrees = each_row(positions(), |row| row[4] = row[4].to_degrees());
    check(degrees, "column \"wrist_2_joint\" were in degrees", "‹units›");
    let radians = each_row(positions(), |row| row[2] = row[2].to_radians());
    check(radians, "column \"elbow_joint\" were in rad", "‹units›");
}

#[test]
fn a_joint_counted_from_the_ground_is_corrected() {
    let chain = ur5e();
    let data = each_row(positions(), |row| row[2] += row[1]);
    let result =
        calibrate(&chain, &Statics::of_chain(&chain), data, None, &CalibrateOptions::geometry(&chain)).unwrap();
    let said = text::report(&result);
    let first = said.lines().next().unwrap();
    println!("{first}");
    let mistake = "\"elbow_joint\" were measured from the ground: its reading is its own angle plus that of \"shoulder_lift_joint\"";
    assert!(first.starts_with("ATTENTION") && first.contains(mistake), "{said}");
    assert!(first.contains("write elbow_joint - shoulder_lift_joint into column \"elbow_joint\""), "{said}");
    assert_eq!(result.report.read_as.unwrap().joints, ["elbow_joint"]);
}

#[test]
fn quaternions_in_another_order_are_named() {
    let poses = || data(&ur5e(), ObservationKind::Pose, 4);
    let turned = |change: fn(UnitQuaternion<f64>) -> UnitQuaternion<f64>| {
        let mut data = poses();
        for observation in 0..data.observations() {
            let values = &mut data.observed.values_mut(observation)[3..12];
            let rotation = Rotation3::from_matrix_unchecked(Matrix3::from_column_slice(values));
            let changed = change(UnitQuaternion::from_rotation_matrix(&rotation)).to_rotation_matrix();
            values.copy_from_slice(changed.matrix().as_slice());
        }
        data
    };
    // Written w, x, y, z and read as x, y, z, w.
    let first = turned(|q| UnitQuaternion::new_normalize(Quaternion::new(q.k, q.w, q.i, q.j)));
    check(first, "the quaternion were written w first", "put the names of the header row");
    check(turned(|q| q.inverse()), "the quaternion were inverse", "in the instrument's frame");
}

#[test]
fn readings_out_of_step_are_named() {
    let whole = positions();
    let mut late = whole.subset(&(0..59).collect::<Vec<usize>>());
    late.readings.clone_from(&whole.subset(&(1..60).collect::<Vec<usize>>()).readings);
    check(late, "the joint readings were 1 row(s) above the values", "pair readings and values row by row");
}

#[test]
fn another_robot_is_refused() {
    let said = refused(&robot("universal_robots/ur10e.urdf"), positions());
    assert!(said.contains("is this the robot that was measured"), "{said}");
    let said = refused(&robot("abb/irb120.urdf"), {
        let mut data = positions();
        data.joints = robot("abb/irb120.urdf").coordinates().iter().map(|c| c.name.clone()).collect();
        data
    });
    assert!(said.contains("is this the robot that was measured"), "{said}");
}

#[test]
fn rows_of_two_robots_are_named() {
    let (mut both, other) = (positions(), data(&ur5e(), ObservationKind::Position, 77));
    for row in 0..other.len() {
        for observation in other.of_row(row) {
            both.observed.push(other.observed.series(observation), other.observed.values(observation));
        }
        both.end_row(other.reading(row), 0, false);
    }
    both.lines = (2..122).collect();
    let said = refused(&ur5e(), both);
    assert!(said.contains("60 of 120 rows fit this robot together"), "{said}");
    assert!(said.contains("lines 62-121;") || said.contains("lines 2-61;"), "{said}");
}

/// Rows of both, one file after the other.
fn one_behind_the_other(mut first: Measurements, second: &Measurements) -> Measurements {
    for row in 0..second.len() {
        for observation in second.of_row(row) {
            first.observed.push(second.observed.series(observation), second.observed.values(observation));
        }
        first.end_row(second.reading(row), 0, false);
    }
    first.lines = (2..first.len() + 2).collect();
    first
}

#[test]
fn rows_of_two_individuals_are_named() {
    // Two arms off their drawing by a millimetre and a milliradian each, measured by one instrument that was not moved.
    let chain = ur5e();
    let built = |seed: u64| {
        let options = SimulationOptions { rows: 60, seed, ..SimulationOptions::default() };
        simulate(&chain, &options, &NoEffects)
    };
    let (one, other) = (built(2), built(77));
    let mut same_place = one.arm.clone();
    same_place.joints.clone_from(&other.arm.joints);
    let options = SimulationOptions { rows: 60, seed: 77, ..SimulationOptions::default() };
    let other = simulate_arm(&same_place, &options, &NoEffects);
    let said = refused(&chain, one_behind_the_other(one.data.clone(), &other.data));
    assert!(said.contains("60 of 120 rows fit this robot together"), "{said}");
    assert!(said.contains("lines 62-121; are they of another robot"), "{said}");
    // The same arm whose instrument was moved in between by 3 mm is one robot, which effects may explain.
    let mut moved = one.arm.clone();
    moved.instruments[0].translation.vector.x += 0.003;
    let moved = simulate_arm(&moved, &options, &NoEffects);
    let both = one_behind_the_other(one.data, &moved.data);
    let result = calibrate(&chain, &Statics::of_chain(&chain), both, None, &CalibrateOptions::geometry(&chain));
    if let Err(error) = result {
        panic!("{error}");
    }
}

#[test]
fn one_coordinate_in_another_unit_is_named() {
    for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
        let mut data = positions();
        for observation in 0..data.observations() {
            data.observed.values_mut(observation)[axis] *= 1e3;
        }
        check(data, &format!("the measured {name} were in mm, unlike the other two"), "‹units›");
    }
    let mut data = positions();
    for observation in 0..data.observations() {
        data.observed.values_mut(observation)[2] *= 1e-3;
    }
    check(data, "the measured z were in m, unlike the other two", "‹units›");
}

#[test]
fn a_longer_link_is_said_first() {
    let drawn = ur5e();
    let mut screws: Vec<_> = drawn.joints().iter().map(|joint| joint.screw).collect();
    let longer = Vector3::new(-0.025, 0.0, 0.0);
    for screw in &mut screws[2..] {
        if let denavit_model::Screw::Revolute(line) = screw {
            line.point += longer;
        }
    }
    let mut home = *drawn.home();
    home.translation.vector += longer;
    let built = drawn.with_geometry(&screws, home).unwrap();
    let run = simulate(&built, &SimulationOptions { rows: 80, ..SimulationOptions::default() }, &NoEffects);
    let options = CalibrateOptions::geometry(&drawn);
    let result = calibrate(&drawn, &Statics::of_chain(&drawn), run.data, None, &options).unwrap();
    let said = text::report(&result);
    println!("{said}");
    assert!(said.contains("DIFFERS FROM THE DRAWING by far more than manufacturing tolerances"), "{said}");
    let first = &result.report.differs_from_drawing[0];
    assert_eq!(first.parameter, "elbow_joint.move_x");
    assert!((first.value + 0.025).abs() < 0.004, "{first:?}");
    assert_eq!(result.report.differs_from_drawing.len(), 1, "{said}");
}

#[test]
fn clean_runs_and_rough_robots_are_left_alone() {
    let robots = ["universal_robots/ur5e.urdf", "kuka/iiwa14.urdf", "adept/cobra600.urdf", "abb/irb120.urdf"];
    for path in robots {
        let chain = robot(path);
        for kind in [ObservationKind::Position, ObservationKind::Pose, ObservationKind::Distance] {
            for (turn, noise) in [(1e-3, 5e-5), (4e-3, 3e-3)] {
                // Every mistake is tried on a rough robot, which takes a while.
                if turn > 1e-3 && (path != robots[0] || kind == ObservationKind::Distance) {
                    continue;
                }
                let options = SimulationOptions {
                    kind,
                    rows: 60,
                    turn,
                    shift: turn,
                    noise_position: noise,
                    noise_orientation: noise,
                    seed: 11,
                    ..SimulationOptions::default()
                };
                let run = simulate(&chain, &options, &NoEffects);
                let options = CalibrateOptions::geometry(&chain);
                let result = calibrate(&chain, &Statics::of_chain(&chain), run.data, None, &options);
                let result = result.unwrap_or_else(|error| panic!("{path} {kind:?} {noise}: {error}"));
                let differs = &result.report.differs_from_drawing;
                assert!(turn > 1e-3 || differs.is_empty(), "{path} {kind:?}: {differs:?}");
            }
        }
    }
}

fn table(text: &str) -> Chain {
    match sources::read("table.csv", text, Stated::default()).unwrap() {
        Source::Table { table, .. } => table.chain().unwrap(),
        Source::Poe(chain) => chain,
    }
}

/// A UR arm by its published D-H numbers, m.
pub fn universal_robot([d1, a2, a3, d4, d5, d6]: [f64; 6]) -> Chain {
    table(&format!(
        "# convention: distal\nrow,joint,kind,theta,d,alpha,a\n\
         1,shoulder_pan_joint,revolute,0,{d1},1.5707963267948966,0\n2,shoulder_lift_joint,revolute,0,0,0,{a2}\n\
         3,elbow_joint,revolute,0,0,0,{a3}\n4,wrist_1_joint,revolute,0,{d4},1.5707963267948966,0\n\
         5,wrist_2_joint,revolute,0,{d5},-1.5707963267948966,0\n6,wrist_3_joint,revolute,0,{d6},0,0\n"
    ))
}

#[test]
fn real_robots_are_left_alone() {
    let ur10 = || universal_robot([0.1273, -0.612, -0.5723, 0.163_941, 0.1157, 0.0922]);
    let ur5 = || universal_robot([0.089_159, -0.425, -0.392_25, 0.109_15, 0.094_65, 0.0823]);
    let wam = measured("jacobi_wam/robot_dh.csv").map(|path| table(&std::fs::read_to_string(path).unwrap()));
    let sets = [
        (Some(irb120()), "wu_irb120/train.csv", "m,rad", 1),
        (Some(irb120()), "robotcali_irb120/measurements.csv", "m,rad", 4),
        (tiago(), "tiago_mocap/measurements.csv", "m,rad", 1),
        (Some(ur10()), "ipa_ur10/grid.csv", "m,rad", 40),
        (Some(ur10()), "ipa_ur10/joint_configurations.csv", "m,rad", 6),
        (Some(ur5()), "jacobi_ur5/grid.csv", "mm,deg", 4),
        (wam, "jacobi_wam/grid.csv", "mm,deg", 1),
    ];
    for (chain, name, units, every) in sets {
        let (Some(chain), Some(path)) = (chain, measured(name)) else { continue };
        let file = std::fs::File::open(path).unwrap();
        let whole = read(name, file, &chain, units.parse::<Units>().unwrap()).unwrap_or_else(|error| panic!("{error}"));
        let data = whole.data.subset(&(0..whole.data.len()).step_by(every).collect::<Vec<usize>>());
        let options = CalibrateOptions::geometry(&chain);
        let result = calibrate(&chain, &Statics::of_chain(&chain), data, None, &options);
        let result = result.unwrap_or_else(|error| panic!("{name}: {error}"));
        let fit = &result.identification.geometric;
        println!(
            "{name}: leaves {:.3} of the size per mille, {:.3} mrad, settled in {}; {:?}",
            1e3 * fit.noise.first() / chain.size(),
            1e3 * fit.noise.levels.get(1).copied().unwrap_or(0.0),
            fit.iterations,
            result.report.differs_from_drawing
        );
        assert!(result.report.differs_from_drawing.is_empty());
    }
}
