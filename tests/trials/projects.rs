//! A repository's robots: `denavit.toml`, and `diff --robots` over all of them.

use super::Trial;
use super::checks::{repository, sh};
use crate::support::robot;
use serde_json::Value;

const ARM: &str = "<robot name=\"arm\" xmlns:xacro=\"http://ros.org/wiki/xacro\"><xacro:arg name=\"length\" default=\"0.4\"/>\
     <link name=\"a\"/><link name=\"b\"/><link name=\"tip\"/>\
     <joint name=\"j1\" type=\"revolute\"><parent link=\"a\"/><child link=\"b\"/><axis xyz=\"0 0 1\"/>\
     <limit lower=\"-1\" upper=\"1\" effort=\"1\" velocity=\"1\"/></joint>\
     <joint name=\"f\" type=\"fixed\"><parent link=\"b\"/><child link=\"tip\"/><origin xyz=\"$(arg length) 0 0\"/></joint></robot>";
const TOML: &str = "[robots.long]\nfile = 'urdf/arm.xacro'\narguments = { length = 0.7 }\ntip = 'tip'\n\n\
     [robots.short]\nfile = 'urdf/arm.xacro'\n";
const MJCF: &str = "<mujoco model='m'><worldbody><body name='b' pos='0 0 0.3'><joint name='j' axis='0 1 0' type='hinge'/>\
     <geom size='0.1'/></body></worldbody></mujoco>\n";
const SDF: &str = "<sdf version='1.9'><model name='s'><link name='a'/><link name='b'><pose>0 0 0.5 0 0 0</pose></link>\
     <joint name='j' type='revolute'><parent>a</parent><child>b</child><axis><xyz>0 1 0</xyz></axis></joint></model></sdf>\n";

fn json(trial: &Trial, line: &str, code: i32) -> Value {
    let run = trial.run(&format!("{line} --json"));
    assert_eq!(run.code, code, "{line}: {}{}", run.stdout, run.stderr);
    serde_json::from_str(&run.stdout).unwrap()
}

/// The state of each robot, by name, and the verdict where it was compared.
fn states(report: &Value) -> Vec<(String, String)> {
    let text = |value: &Value| value.as_str().unwrap_or_default().to_owned();
    let members = report["members"].as_array().unwrap().iter();
    members
        .map(|member| {
            let verdict = text(&member["comparison"]["verdict"]);
            (text(&member["name"]), if verdict.is_empty() { text(&member["state"]) } else { verdict })
        })
        .collect()
}

fn pair(name: &str, state: &str) -> (String, String) {
    (name.to_owned(), state.to_owned())
}

#[test]
fn robots_of_one_file_are_compared_each_with_its_own_arguments() {
    let Some(trial) = repository(&[("urdf/arm.xacro", ARM), ("denavit.toml", TOML)]) else {
        return;
    };
    let untouched = json(&trial, "diff --robots git:HEAD", 0);
    assert_eq!(states(&untouched), [pair("long", "untouched"), pair("short", "untouched")]);
    assert!(sh(&trial, "sed -i s/0.7/0.75/ denavit.toml"));
    let changed = json(&trial, "diff --robots git:HEAD", 1);
    assert_eq!(states(&changed), [pair("long", "different"), pair("short", "untouched")]);
    // The tip is 5 cm farther out, wherever the joint stands.
    let moved = changed["members"][0]["comparison"]["parts"].to_string();
    assert!(moved.contains("50 mm"), "{moved}");
    // The file has a new name, and one of the robots another one.
    assert!(sh(&trial, "git mv urdf arms && sed -i 's/urdf.arm/arms\\/arm/; s/0.75/0.7/' denavit.toml && git add ."));
    let renamed = json(&trial, "diff --robots git:HEAD", 0);
    assert_eq!(states(&renamed), [pair("long", "same"), pair("short", "same")]);
    assert_eq!(renamed["members"][0]["file_before"], "urdf/arm.xacro");
    assert!(sh(&trial, "sed -i 's/robots.short/robots.stub/' denavit.toml && git add . && git commit -qm 2"));
    let other = json(&trial, "diff --robots git:HEAD~1 git:HEAD", 0);
    assert_eq!(states(&other), [pair("long", "same"), pair("stub", "same")]);
}

#[test]
fn every_description_is_compared_in_its_format_and_under_its_old_name() {
    let ur = std::fs::read_to_string(robot("universal_robots/ur5e.urdf")).unwrap();
    let Some(trial) = repository(&[
        ("a/ur.urdf", &ur),
        ("a/same.urdf", &ur.replace("ur5e", "again")),
        ("gone.urdf", &ARM.replace("$(arg length)", "1")),
        ("m.xml", MJCF),
        ("package.xml", "<package><name>d</name></package>"),
        ("s.sdf", SDF),
    ]) else {
        return;
    };
    let edit = "git mv a/ur.urdf b.urdf && sed -i s/-0.425/-0.427/ b.urdf && git rm -q gone.urdf && sed -i s/0.3/0.31/ m.xml && \
                sed -i 's/0 0 0.5/0 0 0.52/' s.sdf && cp a/same.urdf new.urdf";
    assert!(sh(&trial, edit));
    let line = "diff --robots git:HEAD";
    let report = json(&trial, line, 1);
    let expected = [
        pair("a/same.urdf", "untouched"),
        pair("b.urdf", "different"),
        pair("m.xml", "different"),
        pair("new.urdf", "new"),
        pair("s.sdf", "different"),
        pair("gone.urdf", "removed"),
    ];
    assert_eq!(states(&report), expected);
    assert_eq!(report["members"][1]["file_before"], "a/ur.urdf");
    let run = trial.run(&format!("{line} --format markdown --pictures shown -o report.md"));
    assert_eq!(run.code, 1, "{}", run.stderr);
    let page = trial.text("report.md");
    assert!(page.starts_with("### Robots: 3 of 6 different, 1 new, 1 removed, 1 untouched\n"), "{page}");
    let row = page.lines().find(|line| line.starts_with("| `b.urdf`<br>was a/ur.urdf | **different** | 2")).unwrap();
    assert!(row.contains("joint \"elbow_joint\": axis moved by 2 mm"), "{row}");
    for name in ["b.urdf.svg", "m.xml.svg", "s.sdf.svg"] {
        assert!(page.contains(&format!("(shown/{name})")), "{page}");
        roxmltree_reads(&trial.text(&format!("shown/{name}")));
    }
    // Nothing moved: there is nothing to draw.
    assert!(sh(&trial, "sed -i '0,/velocity=\"[0-9.]*\"/s//velocity=\"9\"/' a/same.urdf"));
    trial.run(&format!("{line} --format markdown --pictures limits -o limits.md"));
    let limits = trial.text("limits.md");
    assert!(limits.contains("`a/same.urdf` | **different**") && !limits.contains("limits/a-same.urdf.svg"), "{limits}");
    assert!(sh(&trial, "git checkout -q a/same.urdf"));
    let said = trial.run(line).stdout;
    assert!(said.contains("b.urdf (was a/ur.urdf): different\n  joint \"elbow_joint\": axis moved by 2 mm"), "{said}");
    for (format, words) in [
        ("junit", "tests=\"6\" failures=\"3\""),
        ("sarif", "\"uri\": \"b.urdf\""),
        ("github", "::error file=b.urdf,line="),
        ("badge", "\"message\": \"3 of 6 different, 1 new, 1 removed, 1 untouched\""),
    ] {
        let run = trial.run(&format!("{line} --format {format}"));
        assert!(run.code == 1 && run.stdout.contains(words), "{format}: {}{}", run.stdout, run.stderr);
    }
    assert_eq!(json(&trial, "diff --robots git:HEAD --tolerance-m 1", 0)["members"].as_array().unwrap().len(), 6);
    // From a folder inside.
    let inside = crate::support::denavit_in(&trial.path("a"), &["diff", "--robots", "git:HEAD"]);
    assert!(inside.code == 1 && inside.stdout.contains("3 of 6 different"), "{}{}", inside.stdout, inside.stderr);
}

/// A picture is XML.
fn roxmltree_reads(svg: &str) {
    let root = svg.find("<svg").unwrap();
    assert_eq!(svg.matches("<svg").count(), 3, "{}", &svg[root..root + 100]);
    assert_eq!(svg.matches("</svg>").count(), 3);
}

#[test]
fn a_robot_that_cannot_be_read_any_more_is_an_error_and_the_others_are_compared() {
    let arm = ARM.replace("$(arg length)", "1");
    let files = [("a.urdf", &*arm), ("b.urdf", &*arm), ("never.urdf", "<robot")];
    let Some(trial) = repository(&files) else {
        return;
    };
    assert!(sh(
        &trial,
        "sed -i 's,</robot>,,' a.urdf && sed -i s/'\"1 0 0\"'/'\"2 0 0\"'/ b.urdf && echo >> never.urdf"
    ));
    let report = json(&trial, "diff --robots git:HEAD", 2);
    let expected = [pair("a.urdf", "unreadable"), pair("b.urdf", "different"), pair("never.urdf", "unreadable")];
    assert_eq!(states(&report), expected);
    let counts = |at: usize| report["members"][at]["counts"].as_bool().unwrap();
    assert!(counts(0) && !counts(2));
}

#[test]
fn revisions_and_places_that_cannot_be_are_refused() {
    let Some(trial) = repository(&[("urdf/arm.xacro", ARM), ("denavit.toml", TOML)]) else {
        return;
    };
    for (line, said) in [
        ("diff --robots main", "\"main\" is not a revision; write git:REVISION"),
        ("diff --robots git:HEAD:urdf/arm.xacro", "is not a revision"),
        ("diff --robots git:nowhere", "git:nowhere: cannot be read: this clone has no such revision"),
        ("diff --robots git:--output=x", "this clone has no such revision"),
        ("diff --robots git:HEAD length:=1", "the argument length:=1 belongs to one robot; write it into denavit.toml"),
        ("diff urdf/arm.xacro", "required"),
        ("diff urdf/arm.xacro urdf/arm.xacro --pictures x", "--robots"),
    ] {
        trial.refuses(line, said);
    }
    let outside = Trial::new();
    outside.refuses("diff --robots git:HEAD", "cannot be read");
}

#[test]
fn denavit_toml_says_where_it_is_wrong() {
    let trial = Trial::new();
    for (text, said) in [
        ("[rules]\nallow = []\nalow = []\n", "denavit.toml:3: unknown field `alow`"),
        ("[robots.a]\ntip = 'x'\n", "missing field `file`"),
        ("[tolerance]\nm = -1.0\n", "denavit.toml:2: a tolerance is a finite number, 0 or more, not -1"),
        ("[robots.a]\nfile = 'arm.urdf'\narguments = { x = [1] }\n", "an argument of a xacro file is a text, a number"),
        ("[rules]\ndeny = ['rounded-py']\n", "did you mean \"rounded-pi\"?"),
    ] {
        std::fs::write(trial.path("denavit.toml"), text).unwrap();
        trial.refuses("check arm.urdf", said);
    }
}

#[test]
fn check_takes_the_robots_the_baseline_and_the_rules_of_denavit_toml() {
    let trial = Trial::new().with("denavit.toml", "");
    trial.refuses("check", "no robot is named, here or in a denavit.toml");
    std::fs::create_dir(trial.path("urdf")).unwrap();
    std::fs::write(trial.path("urdf/arm.xacro"), ARM.replace("axis xyz=\"0 0 1\"", "axis xyz=\"0 0 2\"")).unwrap();
    std::fs::write(trial.path("denavit.toml"), TOML).unwrap();
    let said = trial.run("check").stdout;
    // Two robots of one file, and one finding.
    assert_eq!(said.matches("D012").count(), 1, "{said}");
    assert!(said.contains("1 file(s), "), "{said}");
    // Version 0.1 called the table so.
    for table in ["rules", "check"] {
        std::fs::write(trial.path("denavit.toml"), format!("[{table}]\nallow = ['D012']\n{TOML}")).unwrap();
        assert!(!trial.run("check").stdout.contains("D012"));
    }
    std::fs::write(trial.path("denavit.toml"), format!("baseline = 'known.json'\n{TOML}")).unwrap();
    trial.refuses("check", "known.json");
    trial.run("check --write-baseline known.json").succeeded();
    let said = trial.run("check");
    assert!(said.stdout.contains("0 new finding(s)"), "{}", said.stdout);
    assert!(!said.stderr.contains("are fixed"), "{}", said.stderr);
}

#[test]
fn the_tolerance_of_denavit_toml_holds_for_diff_unless_one_is_said() {
    let trial = Trial::new().with("denavit.toml", "[tolerance]\nm = 0.01\n");
    let longer = trial.text("arm.urdf").replacen("-0.425", "-0.427", 1);
    let trial = trial.with("longer.urdf", &longer);
    assert_eq!(trial.run("diff arm.urdf longer.urdf").code, 0);
    assert_eq!(trial.run("diff arm.urdf longer.urdf --tolerance-m 1e-6").code, 1);
}
