//! Verdicts go by what a file means: what is not understood is said, what is placed is compared where it is.

use super::Trial;
use crate::support::{denavit, files, top, vendor};
use std::path::PathBuf;

const ARM: &str = r#"<robot name="r"><link name="base"/><link name="arm"/><link name="tip"/>
<joint name="j" type="revolute"><origin xyz="0 0 0.1" ORIGIN/><axis xyz="0 0 1"/><limit lower="-1" upper="1" effort="1" velocity="1"/><parent link="base"/><child link="arm"/></joint>
<joint name="t" type="fixed"><origin xyz="0.1 0 0.2"/><parent link="arm"/><child link="tip"/></joint>
FURTHER</robot>"#;

fn arm(origin: &str, further: &str) -> String {
    ARM.replace("ORIGIN", origin).replace("FURTHER", further)
}

#[test]
fn a_quaternion_is_a_rotation_in_every_command_and_stays_one() {
    let quaternion = "quat_xyzw=\"0.7071067811865476 0 0 0.7071067811865476\"";
    let trial = Trial::new()
        .with("q.urdf", &arm(quaternion, ""))
        .with("rpy.urdf", &arm("rpy=\"1.5708 0 0\"", ""))
        .with("none.urdf", &arm("", ""))
        .with("both.urdf", &arm(&format!("rpy=\"0 0 0\" {quaternion}"), ""));
    assert_eq!(trial.run("diff q.urdf rpy.urdf").code, 0);
    assert_eq!(trial.run("diff q.urdf none.urdf").code, 1);
    let at = |file: &str| trial.run(&format!("fk {file} --q j=0")).succeeded();
    assert_eq!(at("q.urdf"), at("rpy.urdf"));
    assert_ne!(at("q.urdf"), at("none.urdf"));
    trial.refuses("table both.urdf", "remove one of the two");
    let exported = trial.run("export q.urdf --keep-link-frames").succeeded();
    assert!(exported.contains("quat_xyzw=") && !exported.contains("rpy="), "{exported}");
    let trial = trial.with("exported.urdf", &exported);
    assert_eq!(trial.run("diff q.urdf exported.urdf").code, 0);
    let moved = trial.run("export q.urdf").succeeded();
    let trial = trial.with("moved.urdf", &moved);
    let found = trial.run("diff q.urdf moved.urdf");
    assert_eq!(found.code, 0, "{}{moved}", found.stdout);
}

#[test]
fn what_is_not_understood_is_said_by_table_and_diff() {
    for (further, words) in [
        ("<loop_joint name=\"l\"><link1 link=\"tip\"/><link2 link=\"base\"/></loop_joint>", "not solved"),
        ("<constraint name=\"l\"><parent link=\"tip\"/><child link=\"base\"/></constraint>", "not solved"),
        ("<gazebo><joint name=\"l\"><parent>tip</parent><child>base</child></joint></gazebo>", "not solved"),
        ("<joints/>", "<joints> in <robot> is not understood"),
    ] {
        let trial = Trial::new().with("a.urdf", &arm("", further)).with("b.urdf", &arm("", ""));
        let table = trial.run("table a.urdf");
        assert!(format!("{}{}", table.stdout, table.stderr).contains(words), "{}{}", table.stdout, table.stderr);
        let found = trial.run("diff a.urdf b.urdf");
        assert_eq!(found.code, 1, "{}", found.stdout);
        assert!(found.stdout.contains(words) && found.stdout.contains("a.urdf:4: "), "{}", found.stdout);
        assert!(trial.run("diff a.urdf a.urdf").stdout.contains(words));
    }
    let trial = Trial::new().with("a.urdf", &arm("quat=\"1 0 0 0\"", "")).with("b.urdf", &arm("", ""));
    let found = trial.run("diff a.urdf b.urdf");
    assert_eq!(found.code, 1, "{}", found.stdout);
    assert!(found.stdout.contains("attribute quat=\"1 0 0 0\" of <origin> is not understood"), "{}", found.stdout);
}

#[test]
fn diff_fingerprint_and_describe_read_angles_as_tables_do_unless_exact() {
    let trial = Trial::new()
        .with("a.urdf", &arm("rpy=\"1.5707963267948966 0 0\"", ""))
        .with("b.urdf", &arm("rpy=\"1.5708 0 0\"", ""));
    assert_eq!(trial.run("diff a.urdf b.urdf").code, 0);
    assert_eq!(trial.run("diff a.urdf b.urdf --exact").code, 1);
    for command in ["fingerprint", "describe"] {
        let of = |file: &str, exact: &str| trial.run(&format!("{command} {file} {exact}")).succeeded();
        assert_eq!(of("a.urdf", ""), of("b.urdf", ""));
        assert_ne!(of("a.urdf", "--exact"), of("b.urdf", "--exact"));
    }
}

fn wild(path: &str) -> Option<PathBuf> {
    let folder = top().join("../shared/wild").join(path);
    if !folder.exists() {
        println!("skipped, because ../shared/wild/{path} is not beside this clone");
    }
    folder.exists().then_some(folder)
}

#[test]
fn verdicts_on_real_files_are_right() {
    for (folder, options, pairs) in [
        ("origin-quaternion", "", &[("q", "rpy", 0), ("q", "none", 1)][..]),
        (
            "mimic-driver-flipped",
            "--up-to-zeros",
            &[
                ("original", "flipped_right", 0),
                ("original", "flipped_stale_mimic", 1),
                ("original", "driver_zero_shifted_right", 0),
                ("original", "driver_zero_shifted_stale", 1),
            ],
        ),
        (
            "sensor-pose-in-reframed-link",
            "",
            &[("original", "reframed_right", 0), ("original", "reframed_sensor_left_behind", 1)],
        ),
        ("shape-sizes-compared-exactly", "", &[("a", "b", 0)]),
        (
            "newcomer",
            "",
            &[("reframed_gazebo_a", "reframed_gazebo_b", 1), ("reframed_gazebo_a", "reframed_gazebo_c", 0)],
        ),
    ] {
        let Some(folder) = wild(folder) else { continue };
        for (one, other, code) in pairs {
            let path = |name: &str| folder.join(format!("{name}.urdf")).to_str().unwrap().to_owned();
            let (one, other) = (path(one), path(other));
            let words: Vec<&str> = ["diff", &one, &other].into_iter().chain(options.split_whitespace()).collect();
            let found = denavit(&words);
            assert_eq!(found.code, *code, "{one} {other}: {}{}", found.stdout, found.stderr);
        }
    }
}

#[test]
fn dust_in_axes_makes_no_odd_numbers_in_tables() {
    for path in ["axis-noise/parallel_2e-6.urdf", "cad-noise-axes/arm.urdf"] {
        let Some(file) = wild(path) else { continue };
        let table = denavit(&["table", file.to_str().unwrap()]);
        assert_eq!(table.code, 0, "{}", table.stderr);
        for odd in ["89.99", "179.99", "-75561", "90.000"] {
            assert!(!table.stdout.contains(odd), "{}", table.stdout);
        }
        assert!(format!("{}{}", table.stdout, table.stderr).contains("read as"), "{}", table.stdout);
    }
}

/// An export is the same robot as its source, whatever stands in the frames of the links that it moves.
#[test]
fn exports_of_vendors_files_are_the_same_as_their_sources() {
    let Some(vendor) = vendor() else { return };
    let trial = Trial::new();
    let (mut same, mut different) = (0, Vec::new());
    for (index, path) in files(&vendor.join("robots"), "urdf").iter().enumerate() {
        if index % 12 != 0 {
            continue;
        }
        let source = path.to_str().unwrap();
        let exported = denavit(&["export", source]);
        if exported.code != 0 {
            continue;
        }
        std::fs::write(trial.path("exported.urdf"), exported.stdout).unwrap();
        let out = trial.path("exported.urdf");
        let found = denavit(&["diff", source, out.to_str().unwrap(), "--samples", "64"]);
        if found.code == 0 {
            same += 1;
        } else {
            different.push(format!("{source}: {}{}", found.stdout, found.stderr));
        }
    }
    assert!(same > 10 && different.is_empty(), "{same} the same; {}", different.join("\n"));
}
