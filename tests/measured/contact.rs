//! Planes and dial gauges, from simulated files to errors on planes that were not fitted.

use super::{Folder, json_file, ur5e};
use crate::support::denavit;

const TWO_ARMS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../calibrate/tests/two_arms.urdf");

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
fn hands_that_touch_or_hold_a_tool_calibrate_a_robot() {
    let folder = Folder::new();
    let [data, test, report] = ["data.csv", "test.csv", "report.json"].map(|name| folder.path(name));
    for (measure, rows, word, column) in [("contacts", "40", "spread", "contact"), ("grips", "15", "grip", "grip")] {
        let simulate = ["simulate", TWO_ARMS, "--tip", "left_hand", "--tip", "right_hand", "--measure", measure];
        let made = ["--rows", rows, "--noise", "0.1,0.2", "-o", &data, "--test", &test, "--test-rows", "10"];
        assert_eq!(denavit(&[&simulate[..], &made].concat()).succeeded(), "");
        let text = std::fs::read_to_string(&data).unwrap();
        let lines: Vec<&str> = text.lines().collect();
        assert!(lines[1].starts_with("tip,") && lines[1].ends_with(column), "{text:.300}");
        assert!(lines[2].starts_with("left_hand+right_hand,"), "{text:.600}");
        let calibrate = ["calibrate", TWO_ARMS, "--tip", "left_hand", "--tip", "right_hand", "--effects", "none"];
        let used = ["--data", &data, "--test", &test, "--json", &report];
        denavit(&[&calibrate[..], &used].concat()).succeeded();
        let report = json_file(&report);
        let error = |stage: usize| report["stages"][stage]["test"][format!("{word}_rms_m")].as_f64().unwrap();
        println!("{measure}: {:.4} mm as drawn, {:.4} mm calibrated", error(0) * 1e3, error(1) * 1e3);
        assert!(error(1) < 0.2 * error(0), "{measure}");
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
        "poses cannot be planned for readings on planes: you choose them when you bring the target into contact",
    );
    let effect = ["simulate", &ur5e, "--measure", "planes", "--effect", "backlash@elbow_joint=0.1mm"];
    refused(&effect, "--effect: effects are not simulated with readings on planes");
    let touch = ["simulate", TWO_ARMS, "--tip", "left_hand", "--measure", "contacts"];
    refused(&touch, "--measure: contacts need two tips of one robot; name both (--tip LINK --tip LINK)");
    let hold = ["simulate", TWO_ARMS, "--tip", "left_hand", "--tip", "right_hand", "--measure", "grips"];
    refused(
        &[&hold[..], &["--effect", "joint_scale@left_elbow=1e-3"]].concat(),
        "--effect: effects are not simulated with grips of a tool",
    );
    refused(&[&hold[..], &["--columns", "time"]].concat(), "--columns: no other columns are simulated with grips");
}
