//! Planes and dial gauges, from simulated files to errors on planes that were not fitted.

use super::{Folder, json_file, ur5e};
use crate::support::denavit;

#[test]
fn planes_and_dial_gauges_calibrate_a_robot() {
    let (folder, ur5e) = (Folder::new(), ur5e());
    for (measure, word, head) in [("planes", "height", "plane"), ("dial", "dial", "dial,setup")] {
        let (data, report) = (folder.path("data.csv"), folder.path("report.json"));
        let simulate =
            ["simulate", &ur5e, "--measure", measure, "--rows", "150", "--noise", "0.01", "--seed", "4", "-o", &data];
        assert_eq!(denavit(&simulate).succeeded(), "");
        let text = std::fs::read_to_string(&data).unwrap();
        assert!(text.lines().nth(1).unwrap().ends_with(head), "{measure}: {text:.300}");
        let calibrate =
            ["calibrate", &ur5e, "--data", &data, "--effects", "none", "--hold-out-setups", "3", "--json", &report];
        denavit(&calibrate).succeeded();
        let report = json_file(&report);
        let error = |stage: usize| report["stages"][stage]["test"][format!("{word}_rms_m")].as_f64().unwrap();
        println!("{measure}: {:.4} mm as drawn, {:.4} mm calibrated", error(0) * 1e3, error(1) * 1e3);
        assert!(error(1) < 0.15 * error(0), "{measure}: {report}");
        assert_eq!(report["placements"]["instruments"].as_array().unwrap().len(), 2);
    }
}

#[test]
fn what_contact_cannot_do_is_refused() {
    let ur5e = ur5e();
    let refused = |arguments: &[&str], expected: &str| {
        let run = denavit(arguments);
        assert_eq!(run.code, 2, "{}{}", run.stdout, run.stderr);
        assert!(run.stderr.contains(expected), "{}", run.stderr);
    };
    let plan = ["plan", &ur5e, "--count", "10", "--measure", "planes"];
    refused(
        &plan,
        "poses cannot be chosen for readings on planes: whoever brings the target into contact chooses them",
    );
    let effect = ["simulate", &ur5e, "--measure", "planes", "--effect", "backlash@elbow_joint=0.1mm"];
    refused(&effect, "--effect: effects are not simulated with readings on planes");
}
