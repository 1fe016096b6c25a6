//! Meaningless numbers are refused; suspicious numbers are reported.

use super::Trial;
use std::collections::BTreeSet;

#[test]
fn nonsense_is_an_error_in_every_option() {
    let trial = Trial::new().with("data.csv", "");
    for option in [
        "table arm.urdf --tolerance",
        "diff arm.urdf arm.urdf --tolerance-m",
        "diff arm.urdf arm.urdf --tolerance-rad",
        "diff arm.urdf arm.urdf --q-range",
        "diff arm.urdf arm.urdf --samples",
        "fingerprint arm.urdf --tolerance",
        "fk arm.urdf --q elbow_joint",
        "fk arm.urdf --effects data.csv --given payload",
        "calibrate arm.urdf --data data.csv --hold-out",
        "calibrate arm.urdf --data data.csv --max-effects",
        "calibrate arm.urdf --data data.csv --gear-ratio elbow_joint",
        "identify arm.urdf --rows",
        "identify arm.urdf --targets",
        "plan arm.urdf --count",
        "plan arm.urdf --count 5 --spread",
        "plan arm.urdf --count 5 --target 0,0,",
        "plan arm.urdf --count 5 --anchor 0,0,",
        "plan arm.urdf --count 5 --box 0,1,0,1,0,",
        "simulate arm.urdf --rows",
        "simulate arm.urdf --noise",
        "simulate arm.urdf --outliers",
        "simulate arm.urdf --geometry-error",
        "compensate arm.urdf --poses data.csv --allowed-miss",
    ] {
        for number in ["nan", "inf", "-inf", "1e999", "abc"] {
            let joined = if option.ends_with(',') || option.ends_with("_joint") || option.ends_with("payload") {
                let between = if option.ends_with(',') { "" } else { "=" };
                format!("{option}{between}{number}")
            } else {
                format!("{option}={number}")
            };
            let run = trial.run(&joined);
            assert_eq!((run.code, run.stdout.as_str()), (2, ""), "{joined}: {}", run.stderr);
        }
    }
    for (line, said) in [
        ("table arm.urdf --tolerance=-1e-6", "write a finite number of 0 or more"),
        ("diff arm.urdf arm.urdf --tolerance-m=-1", "write a finite number of 0 or more"),
        ("calibrate arm.urdf --data data.csv --hold-out=1.5", "write a number between 0 and 1"),
        ("fingerprint arm.urdf --tolerance=0", "write a number between 0 and 1"),
        ("diff arm.urdf arm.urdf --samples=0", "0 is not in 1"),
    ] {
        trial.refuses(line, said);
    }
}

#[test]
fn a_text_that_is_no_fingerprint_is_an_error_and_no_difference() {
    let trial = Trial::new();
    let own = trial.run("fingerprint arm.urdf").succeeded();
    assert_eq!(trial.run(&format!("fingerprint arm.urdf --expect {own}")).code, 0);
    let json: serde_json::Value = serde_json::from_str(&trial.run("fingerprint arm.urdf --json").succeeded()).unwrap();
    assert_eq!(json["fingerprint"], own.trim());
    let refuses = |written: &str, said: &str| {
        let run = trial.run(&format!("fingerprint arm.urdf --expect={written}"));
        assert!(run.code == 2 && run.stderr.contains(said), "{written}: {}", run.stderr);
    };
    refuses("abc", "\"abc\" is not a fingerprint; it looks like");
    refuses(&own.trim()[..own.len() - 2], "is not a fingerprint");
    refuses(&own.trim().replacen("d3", "d1", 1), "is of format d1, but this version uses d3");
    refuses(&own.trim().replacen("1e-6", "1e-5", 1), "has the tolerance 1e-5; compare with --tolerance 1e-5");
    let other = own.trim().chars().map(|c| if c == 'a' { 'b' } else { c }).collect::<String>();
    let other = if other == own.trim() { other.replace('1', "2").replace("d3-2e-6", "d3-1e-6") } else { other };
    assert_eq!(trial.run(&format!("fingerprint arm.urdf --expect={other}")).code, 1, "{other}");
}

#[test]
fn joint_values_outside_of_the_limits_are_mentioned() {
    let trial = Trial::new();
    let said = |line: &str| trial.run(line).stderr;
    let degrees = said("fk arm.urdf --q 0,-90,90,0,0,0");
    assert!(degrees.contains("--q is outside of the limits of shoulder_lift_joint, elbow_joint"), "{degrees}");
    assert!(degrees.contains("looks like degrees; for degrees add --degrees"), "{degrees}");
    assert_eq!(said("fk arm.urdf --q 0,-90,90,0,0,0 --degrees"), "");
    assert_eq!(said("fk arm.urdf --q 0,-1.5,1.5,0,0,0"), "");
    let beyond = said("fk arm.urdf --q elbow_joint=7");
    assert!(beyond.contains("outside of the limits of elbow_joint") && !beyond.contains("degrees"), "{beyond}");
}

#[test]
fn no_note_says_that_nothing_moves() {
    let turned = "<robot name=\"r\"><link name=\"a\"/><link name=\"b\"/><link name=\"c\"/>\
        <joint name=\"j\" type=\"continuous\"><parent link=\"a\"/><child link=\"b\"/><axis xyz=\"0 0 1\"/></joint>\
        <joint name=\"k\" type=\"fixed\"><parent link=\"b\"/><child link=\"c\"/><origin rpy=\"1.57 0 0\"/></joint></robot>";
    let trial = Trial::new().with("turned.urdf", turned);
    let text = trial.run("table turned.urdf").succeeded();
    assert!(text.contains("1.57 read as π/2; the tip turns by at most 8.0e-4 rad and does not move"), "{text}");
    let mut said = BTreeSet::new();
    for path in crate::support::files(&crate::support::top().join("robots"), "urdf") {
        let run = crate::support::denavit(&["table", path.to_str().unwrap()]);
        said.extend(
            format!("{}{}", run.stdout, run.stderr)
                .lines()
                .filter(|line| line.contains("at most 0 m"))
                .map(str::to_owned),
        );
    }
    assert!(said.is_empty(), "{said:?}");
}

#[test]
fn a_home_pose_that_is_no_rotation_is_refused() {
    let trial = Trial::new();
    trial.run("poe arm.urdf --format json -o axes.json").succeeded();
    let written: serde_json::Value = serde_json::from_str(&trial.text("axes.json")).unwrap();
    let altered = |change: fn(&mut f64)| {
        let mut value = written.clone();
        let rows = value["home"].as_array_mut().unwrap();
        for row in rows.iter_mut().take(3) {
            let number = &mut row.as_array_mut().unwrap()[0];
            let mut plain = number.as_f64().unwrap();
            change(&mut plain);
            *number = plain.into();
        }
        value.to_string()
    };
    let trial = trial.with("mirrored.json", &altered(|x| *x = -*x)).with("scaled.json", &altered(|x| *x *= 1.1));
    for file in ["mirrored.json", "scaled.json"] {
        trial.refuses(&format!("table {file}"), "the rotation of the home pose is invalid");
        trial.refuses(&format!("table {file}"), file);
    }
}
