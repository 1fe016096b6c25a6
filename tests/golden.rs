//! Golden files: every format of a few robots, walking the list of formats.

use crate::support::{denavit, robot, top};

const ROBOTS: &[(&str, &[&str])] = &[
    ("ur5e", &["universal_robots/ur5e.urdf"]),
    ("panda", &["franka/panda.urdf", "--tip", "panda_link8", "--convention", "proximal"]),
    ("scara_helical", &["denso/hsr065_screw_spline.urdf"]),
    ("puma_actual", &["unimation/puma560_actual_poe.csv", "--gauge", "paper", "--exact", "--units", "mm"]),
    ("stanford_hayati", &["stanford/stanford_arm.urdf", "--convention", "hayati"]),
];

pub fn snapshot(name: &str, text: &str) {
    let folder = top().join("tests/golden");
    let text = text.replace(&format!("{}/", top().display()), "");
    insta::with_settings!({ snapshot_path => folder, prepend_module_to_snapshot => false, omit_expression => true }, {
        insta::assert_snapshot!(name, text);
    });
}

#[test]
fn every_format_of_every_golden_robot() {
    for (name, arguments) in ROBOTS {
        let file = robot(arguments[0]);
        for format in denavit_export::FORMATS {
            let mut all = vec!["table", &file, "--format", format.name];
            all.extend(&arguments[1..]);
            let run = denavit(&all);
            // A format may be unable to express a robot: then the error says so.
            let text = if run.code == 0 { run.stdout } else { run.failed() };
            snapshot(&format!("table_{name}.{}", format.extension), &text);
        }
    }
}

#[test]
fn screw_axes() {
    for format in ["text", "csv", "json"] {
        let text = denavit(&["poe", &robot("stanford/stanford_arm.urdf"), "--format", format]).succeeded();
        snapshot(&format!("poe_stanford_{format}"), &text);
    }
}

#[test]
fn chains_and_forward_kinematics() {
    snapshot("chains_baxter", &denavit(&["chains", &robot("rethink/baxter.urdf")]).succeeded());
    snapshot("chains_gripper_json", &denavit(&["chains", &robot("robotiq/2f_85.urdf"), "--json"]).succeeded());
    let fk = ["fk", &robot("universal_robots/ur5e.urdf"), "--q", "0,-90,90,0,0,0", "--degrees"];
    snapshot("fk_ur5e", &denavit(&fk).succeeded());
}

#[test]
fn matches() {
    let table = robot("unimation/puma560_dh.csv");
    let robot = robot("unimation/puma560.urdf");
    snapshot("match_puma_text", &denavit(&["table", &robot, "--match", &table]).succeeded());
    snapshot("match_puma_json", &denavit(&["table", &robot, "--match", &table, "--format", "json"]).succeeded());
}

#[test]
fn help_teaches() {
    snapshot("help", &denavit(&["--help"]).succeeded());
    snapshot("help_table", &denavit(&["table", "--help"]).succeeded());
}
