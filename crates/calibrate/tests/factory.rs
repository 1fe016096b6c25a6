//! Arms calibrated at the factory: kinematics files and delta tables of real controllers.

#![allow(clippy::unwrap_used, clippy::print_stdout, clippy::approx_constant)] // Tests: a panic is a failure, what is printed is read.

use denavit_calibrate::apply::delta_table;
use denavit_dh::DhRow;
use denavit_export::kinematics_yaml::{AngleOrder, KinematicsFile, NAMES, read};
use denavit_model::{Chain, se3};

fn shared(name: &str) -> Option<String> {
    let path = format!("{}/../../../shared/vendor/ur_calibration/{name}", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(&path).ok();
    if text.is_none() {
        println!("skipped, because {path} is not here");
    }
    text
}

fn ideal(d: [f64; 6], a: [f64; 6]) -> Vec<DhRow> {
    let alpha = [1.570796327, 0.0, 0.0, 1.570796327, -1.570796327, 0.0];
    (0..6).map(|k| DhRow { theta: 0.0, d: d[k], alpha: alpha[k], a: a[k] }).collect()
}

fn individual(name: &str) -> Option<Chain> {
    let rows = if name == "A" {
        ideal([0.1273, 0., 0., 0.163941, 0.1157, 0.0922], [0., -0.612, -0.5723, 0., 0., 0.])
    } else {
        ideal([0.1807, 0., 0., 0.17415, 0.11985, 0.11655], [0., -0.6127, -0.57155, 0., 0., 0.])
    };
    let deltas = delta_table::read("factory_deltas.csv", &shared("factory_deltas.csv")?).unwrap();
    Some(delta_table::chain(name, &rows, &deltas, &NAMES.map(|(_, joint)| joint)).unwrap())
}

/// Largest angle (rad) and distance (m) between the tips of two chains over 300 joint readings.
fn apart(a: &Chain, b: &Chain) -> (f64, f64) {
    let mut largest = (0.0f64, 0.0f64);
    for sample in 0..300 {
        let q: Vec<f64> = (0..6)
            .map(|k| 6.0 * (0.5 + f64::from(sample) * 0.618_033_988_7 * (f64::from(k) + 1.0).sqrt()).fract() - 3.0)
            .collect();
        let (turned, moved) = se3::difference(&a.fk(&q), &b.fk(&q));
        largest = (largest.0.max(turned), largest.1.max(moved));
    }
    largest
}

#[test]
fn files_move_as_the_controllers_tables_do() {
    for (name, file) in [("A", "individual_A_ur10_kinematics.yaml"), ("B", "individual_B_ur10e_kinematics.yaml")] {
        let (Some(table), Some(text)) = (individual(name), shared(file)) else { return };
        let parsed = read(file, &text).unwrap();
        let (turned, moved) = apart(&parsed.chain(name, AngleOrder::Urdf).unwrap(), &table);
        println!("{name}: {turned:e} rad, {moved:e} m");
        assert!(turned < 1e-12 && moved < 1e-12, "{name}: {turned:e} {moved:e}");
        let (turned, moved) = apart(&parsed.chain(name, AngleOrder::Vendor).unwrap(), &table);
        println!("{name}, angles in the other order: {turned:e} rad, {moved:e} m");
        assert!(moved > 1e-6 && moved < 60e-6, "{name}: {moved:e}");
    }
}

#[test]
fn what_is_written_moves_as_the_chain_does() {
    for name in ["A", "B", "C"] {
        let Some(chain) = individual(name) else { return };
        for order in [AngleOrder::Urdf, AngleOrder::Vendor] {
            let (file, rest) = KinematicsFile::of(&chain, order).unwrap();
            let again = read("written", &file.to_text(order, &[])).unwrap();
            assert_eq!(again, file);
            let made = again.chain(name, order).unwrap();
            let with_rest = made
                .with_geometry(&made.joints().iter().map(|joint| joint.screw).collect::<Vec<_>>(), made.home() * rest);
            let (turned, moved) = apart(&with_rest.unwrap(), &chain);
            println!("{name} {order:?}: {turned:e} rad, {moved:e} m, rest {:e} m", rest.translation.vector.norm());
            assert!(turned < 1e-12 && moved < 1e-12, "{name}: {turned:e} {moved:e}");
            let largest = again.origins.iter().flatten().fold(0.0f64, |a, b| a.max(b.abs()));
            assert!(largest < 4.0, "{name}: {largest}");
        }
    }
}

#[test]
fn a_file_written_by_the_vendors_tool_is_read_and_written_again() {
    let Some(text) = shared("individual_D_ur5_kinematics.yaml") else { return };
    let parsed = read("individual_D", &text).unwrap();
    assert_eq!(parsed.hash.as_deref(), Some("calib_15200003067234149431"));
    for order in [AngleOrder::Urdf, AngleOrder::Vendor] {
        let again = read("written", &parsed.to_text(order, &["comment".into()])).unwrap();
        assert_eq!(again, parsed);
        let chain = parsed.chain("D", order).unwrap();
        let (file, rest) = KinematicsFile::of(&chain, order).unwrap();
        let made = file.chain("D", order).unwrap();
        let screws: Vec<_> = made.joints().iter().map(|joint| joint.screw).collect();
        let (turned, moved) = apart(&made.with_geometry(&screws, made.home() * rest).unwrap(), &chain);
        assert!(turned < 1e-12 && moved < 1e-12, "{turned:e} {moved:e}");
    }
}

#[test]
fn bad_files_are_refused_with_their_place() {
    let error = |text: &str| read("k.yaml", text).unwrap_err().to_string();
    assert_eq!(
        error("kinematics:\n  shoulder: {x: 0, y: 0, z: 0.1, roll: 0, pitch: 0}\n"),
        "k.yaml: kinematics.shoulder.yaw is missing; each origin needs x, y, z, roll, pitch, yaw"
    );
    assert_eq!(
        error("kinematics:\n  shoulder:\n    x: none\n"),
        "k.yaml:3: kinematics.shoulder.x is \"none\", not a finite number"
    );
    assert!(error("kinematics: [\n").starts_with("k.yaml:2: this is not well-formed YAML"));
    let planar = denavit_model::examples::planar_arm();
    assert_eq!(
        KinematicsFile::of(&planar, AngleOrder::Urdf).unwrap_err().to_string(),
        "planar_arm: a kinematics file needs six revolute joints without scale or offset, but this chain has 2 joints, 2 \
         of this kind; write a table or a URDF"
    );
}
