//! Outputs: nothing is lost, half-written or turned into something else.

use super::Trial;
use crate::support::program;
use std::io::Read as _;
use std::os::unix::fs::{FileTypeExt as _, MetadataExt as _, PermissionsExt as _, chown, symlink};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

fn fifo(trial: &Trial, name: &str) {
    assert!(Command::new("mkfifo").arg(trial.path(name)).status().unwrap().success());
}

#[test]
fn devices_and_pipes_stay_what_they_are() {
    let trial = Trial::new();
    symlink("/dev/null", trial.path("null")).unwrap();
    assert_eq!(trial.run("table arm.urdf -o null").succeeded(), "");
    assert!(trial.path("null").symlink_metadata().unwrap().is_symlink());
    assert!(std::fs::metadata("/dev/null").unwrap().file_type().is_char_device());
    fifo(&trial, "pipe");
    let mut reader = Command::new("cat").arg(trial.path("pipe")).stdout(Stdio::piped()).spawn().unwrap();
    assert_eq!(trial.run("table arm.urdf -o pipe").succeeded(), "");
    let mut text = String::new();
    reader.stdout.take().unwrap().read_to_string(&mut text).unwrap();
    reader.wait().unwrap();
    assert_eq!(text, trial.run("table arm.urdf").succeeded());
    assert!(trial.path("pipe").metadata().unwrap().file_type().is_fifo());
    assert_eq!(trial.run("table arm.urdf -o /dev/stdout").succeeded(), text);
    assert_eq!(trial.names(), ["arm.urdf", "null", "pipe"]);
}

#[test]
fn a_link_stays_and_what_it_leads_to_is_replaced() {
    let trial = Trial::new();
    let text = trial.text("arm.urdf").replacen("1 0 0", "2 0 0", 1);
    let broken = text.replacen("axis xyz=\"0 0 1\"", "axis xyz=\"0 0 2\"", 1);
    assert_ne!(broken, text, "an axis to mend");
    let trial = trial.with("arm.urdf", &broken);
    symlink("arm.urdf", trial.path("link.urdf")).unwrap();
    trial.run("check --fix link.urdf");
    assert!(trial.path("link.urdf").symlink_metadata().unwrap().is_symlink());
    assert!(!trial.text("arm.urdf").contains("0 0 2"), "fixed");
    symlink("not_there_yet.txt", trial.path("later")).unwrap();
    trial.run("table arm.urdf -o later").succeeded();
    assert!(trial.text("not_there_yet.txt").contains("elbow_joint"));
    symlink("b", trial.path("a")).unwrap();
    symlink("a", trial.path("b")).unwrap();
    trial.refuses("table arm.urdf -o a", "its links form a loop");
}

#[test]
fn owner_and_mode_stay() {
    let trial = Trial::new().with("table.txt", "old");
    std::fs::set_permissions(trial.path("table.txt"), std::fs::Permissions::from_mode(0o640)).unwrap();
    // Only root can give a file away.
    let given = chown(trial.path("table.txt"), Some(12345), Some(12345)).is_ok();
    trial.run("table arm.urdf -o table.txt").succeeded();
    let found = trial.path("table.txt").metadata().unwrap();
    assert_eq!(found.mode() & 0o7777, 0o640);
    assert!(!given || (found.uid(), found.gid()) == (12345, 12345));
    assert!(trial.text("table.txt").contains("elbow_joint"));
}

#[test]
fn a_read_only_file_is_refused_with_the_fix() {
    let trial = Trial::new().with("table.txt", "old");
    std::fs::set_permissions(trial.path("table.txt"), std::fs::Permissions::from_mode(0o444)).unwrap();
    trial.refuses(
        "table arm.urdf -o table.txt",
        "table.txt: cannot be written: it is read-only; make it writable (chmod u+w)",
    );
    trial.refuses("simulate missing.urdf -o table.txt", "read-only");
}

#[test]
fn a_dash_is_standard_output_for_every_option() {
    let trial = Trial::new().with_robot("arm.xacro", "universal_robots/ur5e.urdf");
    trial.run("simulate arm.urdf --rows 40 -o data.csv").succeeded();
    trial.run("plan arm.urdf --count 5 --spread 50 -o plan.csv").succeeded();
    let calibrate = "calibrate arm.urdf --data data.csv --effects none";
    for (line, begins) in [
        ("table arm.urdf -o -", "ur5e "),
        ("poe arm.urdf --format csv -o -", "row,joint,kind"),
        ("poe arm.urdf --json -", "{"),
        ("export arm.urdf -o -", "<?xml"),
        ("expand arm.xacro -o -", "<?xml"),
        ("doc arm.urdf -o -", "<!doctype html>"),
        ("diff arm.urdf arm.urdf -o -", "arm.urdf"),
        ("check arm.urdf --format json -o -", "{"),
        ("plan arm.urdf --count 5 --spread 50 -o -", "# 5 of"),
        ("simulate arm.urdf --rows 2 -o -", "# ur5e"),
        ("simulate arm.urdf --rows 2 -o other.csv --test -", "# ur5e"),
        ("simulate arm.urdf --rows 2 -o other.csv --truth -", "{"),
        ("compensate arm.urdf --poses plan.csv -o -", "# "),
        ("man -o -", ".ie"),
        ("completions bash -o -", "_denavit"),
        (&format!("{calibrate} --json -"), "{"),
        (&format!("{calibrate} --html -"), "<!doctype html>"),
        (&format!("{calibrate} --urdf -"), "<?xml"),
        (&format!("{calibrate} --dh -"), "ur5e "),
        (&format!("{calibrate} --effects-out -"), "{"),
    ] {
        let run = trial.run(line);
        assert!(
            run.code < 2 && run.stdout.starts_with(begins),
            "{line}: {}{}",
            run.stderr,
            &run.stdout[..80.min(run.stdout.len())]
        );
        assert!(!run.stdout.contains("strongest correlations"), "{line}: one output at a time");
    }
    assert_eq!(trial.names(), ["arm.urdf", "arm.xacro", "data.csv", "other.csv", "plan.csv"]);
}

#[test]
fn an_output_is_never_an_input() {
    let trial = Trial::new().with("folder.txt", "");
    trial.run("simulate arm.urdf --rows 40 -o data.csv --test test.csv").succeeded();
    std::fs::hard_link(trial.path("data.csv"), trial.path("hard.html")).unwrap();
    symlink("data.csv", trial.path("soft.html")).unwrap();
    let calibrate = "calibrate arm.urdf --data data.csv --test test.csv --effects none";
    for output in [
        "--json=data.csv",
        "--html ./data.csv",
        "--html hard.html",
        "--html soft.html",
        "--dh test.csv",
        "--urdf arm.urdf",
    ] {
        trial.refuses(&format!("{calibrate} {output}"), "the run reads this file");
    }
    trial.refuses("table arm.urdf -o arm.urdf", "--output arm.urdf: the run reads this file (as arm.urdf)");
    trial.refuses("export arm.urdf -o ./arm.urdf", "the run reads this file");
    trial.refuses("expand arm.urdf parameters:=data.csv -o data.csv", "the run reads this file (as data.csv)");
    trial.refuses("compensate arm.urdf --poses data.csv -o data.csv", "the run reads this file");
    trial.refuses("plan arm.urdf --count 5 --candidates data.csv -o data.csv", "the run reads this file");
    let data = std::fs::File::open(trial.path("data.csv")).unwrap();
    let line = ["calibrate", "arm.urdf", "--data", "-", "--html", "data.csv"];
    let output = program(trial.folder()).args(line).stdin(data).output().unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert!(trial.text("data.csv").starts_with("# ur5e"));
}

#[test]
fn what_a_xacro_file_includes_is_an_input() {
    let main = "<robot name=\"bent\" xmlns:xacro=\"http://www.ros.org/wiki/xacro\">\
        <xacro:include filename=\"parts.xacro\"/>\
        <xacro:property name=\"sizes\" value=\"${xacro.load_yaml('sizes.yaml')}\"/>\
        <link name=\"base\"/><xacro:arm length=\"${sizes['upper']}\"/></robot>";
    let parts = "<robot xmlns:xacro=\"http://www.ros.org/wiki/xacro\"><xacro:macro name=\"arm\" params=\"length\">\
        <link name=\"upper\"/><joint name=\"shoulder\" type=\"revolute\"><parent link=\"base\"/><child link=\"upper\"/>\
        <origin xyz=\"${length} 0 0\"/><limit lower=\"-1\" upper=\"1\" velocity=\"1\" effort=\"1\"/></joint>\
        </xacro:macro></robot>";
    let trial = Trial::new().with("main.xacro", main).with("parts.xacro", parts).with("sizes.yaml", "upper: 0.5\n");
    trial.run("simulate main.xacro --rows 30 -o data.csv").succeeded();
    for file in ["parts.xacro", "sizes.yaml"] {
        for line in [
            format!("table main.xacro -o {file}"),
            format!("table main.xacro --json={file}"),
            format!("expand main.xacro -o {file}"),
            format!("export main.xacro -o {file}"),
            format!("diff arm.urdf main.xacro -o ./{file}"),
            format!("check main.xacro -o {file}"),
            format!("describe main.xacro -o {file}"),
            format!("plan main.xacro --count 8 -o {file}"),
            format!("simulate main.xacro -o {file}"),
            format!("calibrate main.xacro --data data.csv --effects none --html {file}"),
        ] {
            trial.refuses(&line, &format!("{file}: the run reads this file (the robot includes "));
        }
    }
    std::fs::rename(trial.path("parts.xacro"), trial.path("parts.html")).unwrap();
    let trial = trial.with("main.xacro", &main.replace("parts.xacro", "parts.html"));
    std::fs::copy(trial.path("main.xacro"), trial.path("parts.xacro")).unwrap();
    trial.refuses("doc parts.xacro -o .", "the run reads this file (the robot includes ");
}

#[test]
fn two_outputs_need_two_places() {
    let trial = Trial::new().with("data.csv", "").with("page.html", "");
    symlink("page.html", trial.path("link.html")).unwrap();
    let calibrate = "calibrate arm.urdf --data data.csv";
    trial.refuses(&format!("{calibrate} --html same --urdf same"), "two outputs have the same file");
    trial.refuses(&format!("{calibrate} --html page.html --urdf link.html"), "two outputs have the same file");
    trial.refuses(&format!("{calibrate} --html - --urdf -"), "two outputs have the same file");
    trial.refuses("diff arm.urdf arm.urdf --json -o report.json", "write --json report.json");
}

#[test]
fn a_full_disk_changes_no_file() {
    let trial = Trial::new().with("data.csv", "old");
    trial.refuses("simulate arm.urdf --rows 3 -o data.csv --test /dev/full", "/dev/full: cannot be written");
    trial.refuses("simulate arm.urdf --rows 3 -o data.csv --test new.csv --truth /dev/full", "nothing was changed");
    trial.refuses("doc arm.urdf -o data.csv/pages", "data.csv is not a folder");
    trial.refuses("doc arm.urdf -o data.csv", "data.csv is not a folder");
}

#[test]
fn an_interrupted_run_leaves_nothing_behind() {
    let trial = Trial::new().with("data.csv", "old");
    fifo(&trial, "pipe");
    // Nobody reads from the pipe: the run waits there, its other file full beside the old one.
    let line = ["simulate", "arm.urdf", "--rows", "3", "-o", "data.csv", "--test", "pipe"];
    let mut run = program(trial.folder()).args(line).spawn().unwrap();
    let start = Instant::now();
    let staged = |trial: &Trial| {
        let names = trial.names();
        names
            .iter()
            .any(|name| name.starts_with(".denavit-") && trial.path(name).metadata().is_ok_and(|found| found.len() > 0))
    };
    while !staged(&trial) {
        assert!(start.elapsed() < Duration::from_secs(60), "no file was staged");
        std::thread::sleep(Duration::from_millis(5));
    }
    assert!(Command::new("kill").args(["-INT", &run.id().to_string()]).status().unwrap().success());
    assert_eq!(run.wait().unwrap().code(), Some(130));
    assert_eq!(trial.names(), ["arm.urdf", "data.csv", "pipe"]);
    assert_eq!(trial.text("data.csv"), "old");
}

#[test]
fn what_cannot_be_made_is_refused_before_the_work() {
    // The data do not exist: outputs are checked before anything is read.
    let trial = Trial::new();
    let calibrate = "calibrate arm.urdf --data missing.csv";
    for freedom in ["--scales all", "--pitches elbow_joint"] {
        trial.refuses(&format!("{calibrate} {freedom} --urdf as_it_is.urdf"), "write --dh FILE.csv or FILE.json");
        trial.refuses(&format!("{calibrate} {freedom} --dh t.yaml"), "cannot hold what --scales and --pitches fit");
    }
    trial.refuses(
        &format!("{calibrate} --dh t.py"),
        "--dh t.py: rtb has no column for Hayati's beta, which the calibrated",
    );
    trial.refuses(&format!("{calibrate} --dh t.m"), "name a file that ends in one of txt, md, csv, json, tex");
    trial.refuses(&format!("{calibrate} --html nowhere/page.html"), "there is no folder nowhere");
    trial.refuses(&format!("{calibrate} --html ."), "it is a folder");
    trial.refuses(calibrate, "missing.csv: cannot be read");
}
