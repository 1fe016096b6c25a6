//! Checks the documents' statements on real arms with an extract of one set that the project may include.

use super::*;

/// Position error on test rows, mm rms, of each stage, as in `examples/measured/ur10/README.md`. The tolerance of a hundredth is for
/// the order of sums.
const UR10: [(&str, f64); 3] = [("nominal", 1.088), ("geometric", 0.409), ("geometric + curves", 0.133)];

#[test]
fn a_measured_ur10_is_calibrated_as_well_as_its_page_says() {
    let [fit, test] = ["fit", "test"].map(|name| format!("examples/measured/ur10/{name}.csv"));
    let robot = robot("universal_robots/ur10.urdf");
    let run = denavit(&["calibrate", &robot, "--data", &fit, "--test", &test, "--effects", "curves", "--json"]);
    assert_eq!(run.code, 0, "{}", run.stderr);
    let report: serde_json::Value = serde_json::from_str(&run.stdout).unwrap();
    let page = std::fs::read_to_string(crate::support::top().join("examples/measured/ur10/README.md")).unwrap();
    for (name, shown) in UR10 {
        let stage = report["stages"].as_array().unwrap().iter().find(|stage| stage["name"] == name).unwrap();
        let error = 1e3 * stage["test"]["position_rms_m"].as_f64().unwrap();
        assert!((error - shown).abs() < 0.01 * shown, "{name}: {error} mm, {shown} stated");
        assert!(page.contains(&format!("{shown:.3}")), "the page does not state {shown}");
    }
}
