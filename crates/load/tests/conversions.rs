//! From one format to another and home again: what stays as it is, what an edit between changes, what an SRDF takes along.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a panic is a failure, and what is printed is read")]

#[path = "../../../tests/files.rs"]
mod files;

use denavit_compare::lint::RULES;
use denavit_load::{CheckOptions, ConvertOptions, Loaded, Options, Rules, convert, from_text, sidecar_of, srdf_of};
use denavit_model::formats::{Format, Written};
use denavit_model::{Note, Robot};
use files::{files, top};
use std::path::{Path, PathBuf};

const ARM: &str = r#"<?xml version="1.0"?>
<robot name="arm">
  <!-- Measured on Monday. -->
  <link name="base"/>
  <link name="upper">
    <inertial><origin xyz="0 0 .1"/><mass value="2"/><inertia ixx=".02" ixy="0" ixz="0" iyy=".02" iyz="0" izz=".01"/></inertial>
    <visual><geometry><mesh filename="package://arm/upper.dae"/></geometry></visual>
    <collision><geometry><box size=".1 .1 .3"/></geometry></collision>
  </link>
  <link name="lower">
    <inertial><mass value="1"/><inertia ixx=".01" ixy="0" ixz="0" iyy=".01" iyz="0" izz=".01"/></inertial>
  </link>
  <link name="tool"/>
  <joint name="shoulder" type="revolute">
    <origin xyz="0 0 .3" rpy="0 1.5708 0"/><axis xyz="0 0 1"/><parent link="base"/><child link="upper"/>
    <limit lower="-2" upper="2" effort="50" velocity="3"/>
    <safety_controller k_velocity="5" soft_lower_limit="-1.9" soft_upper_limit="1.9"/>
  </joint>
  <joint name="elbow" type="revolute">
    <origin xyz="0 0 .4"/><axis xyz="0 1 0"/><parent link="upper"/><child link="lower"/>
    <limit lower="-1" upper="1" effort="20" velocity="3"/>
  </joint>
  <joint name="flange" type="fixed"><origin xyz="0 0 .2"/><parent link="lower"/><child link="tool"/></joint>
  <transmission name="t"><type>transmission_interface/SimpleTransmission</type><joint name="elbow"/></transmission>
</robot>
"#;

fn options(to: Format, source: &Options) -> ConvertOptions<'_> {
    ConvertOptions { to, output: None, fix_inertia: false, srdf: None, source }
}

fn to(format: Format, file: &str, text: &str) -> Written {
    let source = Options::default();
    convert(file, text, &options(format, &source)).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

fn robot(file: &str, text: &str) -> Robot {
    match from_text(file, text, &Options::default()).unwrap_or_else(|error| panic!("{error}\n{text}")).robot {
        Loaded::Robot(robot) => *robot,
        other => panic!("{other:?}"),
    }
}

/// A folder of its own for a test.
fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

/// The URDF of a description that was made of [`ARM`] and edited.
fn home(name: &str, format: Format, edit: impl Fn(&str) -> String) -> Written {
    let file = folder(name).join(format!("arm.{}", format.word()));
    let made = to(format, "arm.urdf", ARM);
    std::fs::write(sidecar_of(&file), made.sidecar.unwrap()).unwrap();
    let edited = edit(&made.text);
    assert_ne!(edited, made.text);
    to(Format::Urdf, file.to_str().unwrap(), &edited)
}

#[test]
fn an_edit_between_comes_home_and_all_else_stays_byte_for_byte() {
    for (format, from, into) in [
        (Format::Mjcf, r#"range="-1 1""#, r#"range="-1 1.25""#),
        (Format::Sdf, "<lower>-1</lower><upper>1</upper>", "<lower>-1</lower><upper>1.25</upper>"),
    ] {
        let came = home("range", format, |text| {
            assert_eq!(text.matches(from).count(), 1, "{text}");
            text.replace(from, into)
        });
        assert_eq!(came.text, ARM.replace(r#"lower="-1" upper="1""#, r#"lower="-1" upper="1.25""#), "{format:?}");
        assert!(came.losses.is_empty(), "{:?}", came.losses);
        assert!(came.proof[0].starts_with("1 edit(s)"), "{:?}", came.proof);
    }
}

#[test]
fn values_links_and_joints_are_put_in_and_taken_out() {
    let came = home("parts", Format::Mjcf, |text| {
        let text = text.replace(r#"pos="0 0 0.4""#, r#"pos="0 0.01 0.4""#);
        let text =
            text.replace(r#"mass="2""#, r#"mass="2.5""#).replace(r#"size="0.05 0.05 0.15""#, r#"size="0.05 0.05 0.2""#);
        text.replace(r#"<body name="tool""#, r#"<body name="camera" pos="0.1 0 0"/><body name="tool""#)
    });
    for piece in [
        r#"<origin xyz="0 0.01 0.4"/><axis xyz="0 1 0"/><parent link="upper"/>"#,
        r#"<mass value="2.5"/>"#,
        r#"<box size="0.1 0.1 0.4"/>"#,
        r#"<link name="camera"/>"#,
        r#"<child link="camera"/>"#,
        "<!-- Measured on Monday. -->",
        "package://arm/upper.dae",
        "<safety_controller",
        "<transmission name=\"t\">",
        r#"rpy="0 1.5708 0""#,
    ] {
        assert!(came.text.contains(piece), "{piece}\n{}", came.text);
    }
    assert!(came.losses.is_empty(), "{:?}", came.losses);
    let gone = home("gone", Format::Mjcf, |text| {
        let from = text.find("<body name=\"lower\"").unwrap();
        let until = text.rfind("</body>").unwrap();
        let until = text[..until].rfind("</body>").unwrap();
        format!("{}{}", &text[..from], &text[until..])
    });
    assert!(!gone.text.contains("name=\"elbow\" type"), "{}", gone.text);
    assert!(gone.text.contains("package://arm/upper.dae"));
    assert!(
        gone.losses.iter().any(|loss| loss.what == "<transmission>" && loss.why.contains("elbow")),
        "{:?}",
        gone.losses
    );
}

#[test]
fn what_an_edit_cannot_bring_home_is_said() {
    let came = home("said", Format::Mjcf, |text| {
        let text = text.replace(r#"<joint name="elbow""#, r#"<joint name="elbow_pitch""#);
        text.replace("</worldbody>", "</worldbody><actuator><motor name=\"m\" joint=\"shoulder\"/></actuator>")
    });
    let said: Vec<String> = came.losses.iter().map(ToString::to_string).collect();
    assert!(said.iter().any(|line| line.contains("joint \"elbow_pitch\": its new name")), "{said:?}");
    assert!(said.iter().any(|line| line.contains("<motor>")), "{said:?}");
}

#[test]
fn a_way_home_to_mjcf_says_what_stays_lost() {
    let file = folder("mjcf_home").join("m.urdf");
    let text = "<mujoco><worldbody><body name=\"a\"><joint name=\"j\"/><geom size=\".1\"/></body></worldbody>\n\
                <actuator>\n<motor name=\"m\" joint=\"j\"/></actuator></mujoco>";
    let made = to(Format::Urdf, "m.xml", text);
    std::fs::write(sidecar_of(&file), made.sidecar.unwrap()).unwrap();
    let name = file.to_str().unwrap();
    assert_eq!(to(Format::Mjcf, name, &made.text).text, text);
    let turned = made.text.replace("<axis xyz=\"0 0 1\"/>", "<axis xyz=\"0 1 0\"/>");
    assert_ne!(turned, made.text);
    let came = to(Format::Mjcf, name, &turned);
    assert_eq!((came.text, came.losses.len()), (text.replace("name=\"j\"/>", "axis=\"0 1 0\" name=\"j\"/>"), 0));
    let edited = made.text.replace(
        "</robot>",
        "<link name=\"b\"/><joint name=\"f\" type=\"fixed\"><parent link=\"a\"/><child link=\"b\"/></joint></robot>",
    );
    let said = to(Format::Mjcf, name, &edited).losses.iter().map(ToString::to_string).collect::<Vec<_>>();
    assert!(said.iter().any(|line| line.starts_with("m.xml:3: motor \"m\": <motor>: remains lost")), "{said:?}");
}

#[test]
fn a_broken_sidecar_is_said() {
    let file = folder("broken").join("arm.xml");
    let made = to(Format::Mjcf, "arm.urdf", ARM);
    for (content, word) in [
        ("{", "it is not a sidecar"),
        (
            r#"{"schema":"denavit.sidecar/9","sha256":"","source":{"format":"urdf","file":"","text":""},"losses":[]}"#,
            "denavit.sidecar/9",
        ),
    ] {
        std::fs::write(sidecar_of(&file), content).unwrap();
        let source = Options::default();
        let error =
            convert(file.to_str().unwrap(), &made.text, &options(Format::Urdf, &source)).unwrap_err().to_string();
        assert!(error.contains("arm.xml.denavit.json: cannot be read") && error.contains(word), "{error}");
    }
}

#[test]
fn a_table_comes_home_as_the_urdf_that_it_was_made() {
    let table = "joint,kind,theta,d,alpha,a\nj1,revolute,0,0.4,-90,0.025\nj2,revolute,0,0,0,0.56\n";
    let file = folder("table").join("arm.xml");
    let made = to(Format::Mjcf, "arm.csv", table);
    std::fs::write(sidecar_of(&file), made.sidecar.unwrap()).unwrap();
    let came = to(Format::Urdf, file.to_str().unwrap(), &made.text);
    assert_eq!(Format::of_text(&came.text), Some(Format::Urdf), "{}", came.text);
}

/// Models of others, and our own of each format.
fn models() -> Vec<PathBuf> {
    let mut found = Vec::new();
    for folder in ["../shared/vendor/mjcf", "../shared/vendor/sdf", "crates/sdf/tests/models", "robots"] {
        let folder = top().join(folder);
        if folder.is_dir() {
            found.extend(["xml", "sdf", "urdf"].iter().flat_map(|ending| files(&folder, ending)));
        } else {
            println!("skipped, because {} is not there", folder.display());
        }
    }
    found.sort();
    found
}

/// Of the vendors' files one in this many: `tests/oracle/formats/back.py` takes all of them.
const OF_OTHERS: usize = 16;

#[test]
fn within_a_format_nothing_changes_and_an_export_of_an_export_is_the_export() {
    let (mut same, mut again, mut refused) = (0, 0, 0);
    let source = Options::default();
    let shared = |path: &Path| path.to_string_lossy().contains("shared");
    let (others, own): (Vec<_>, Vec<_>) = models().into_iter().partition(|path| shared(path));
    for path in own.into_iter().step_by(4).chain(others.into_iter().step_by(OF_OTHERS)) {
        let (file, text) = (path.to_string_lossy().into_owned(), std::fs::read_to_string(&path).unwrap());
        let Some(format) = Format::of_text(&text) else { continue };
        let Ok(own) = convert(&file, &text, &options(format, &source)) else {
            refused += 1;
            continue;
        };
        assert!(own.text == text && own.sidecar.is_none(), "{file}");
        same += 1;
        for other in Format::ALL.into_iter().filter(|other| *other != format) {
            let changed = ConvertOptions { fix_inertia: other == Format::Mjcf, ..options(other, &source) };
            let once = convert(&file, &text, &changed).unwrap_or_else(|error| panic!("{error}"));
            // Away from the file, so that no sidecar is found.
            let twice =
                convert("once", &once.text, &options(other, &source)).unwrap_or_else(|error| panic!("{file}: {error}"));
            assert!(twice.text == once.text, "{file}");
            again += 1;
        }
    }
    println!("{same} files the same, {again} exports the same again, {refused} refused");
    assert!(same >= 5);
}

const SRDF: &str = r#"<robot name="arm">
  <group name="arm"><chain base_link="base" tip_link="tool"/></group>
  <group_state name="home" group="arm"><joint name="elbow" value="0.5"/><joint name="shoulder" value="-0.25"/></group_state>
  <group_state name="up" group="arm"><joint name="wrist" value="1"/></group_state>
  <disable_collisions link1="base" link2="upper" reason="Adjacent"/>
  <disable_collisions link1="base" link2="lwoer" reason="Never"/>
</robot>"#;

#[test]
fn pairs_and_states_of_an_srdf_are_contacts_and_keys() {
    let source = Options::default();
    let how = ConvertOptions { srdf: Some(("arm.srdf", SRDF)), ..options(Format::Mjcf, &source) };
    let made = convert("arm.urdf", ARM, &how).unwrap();
    for piece in [
        r#"<exclude body1="base" body2="upper"/>"#,
        r#"<key name="arm/home" qpos="-0.25 0.5"/>"#,
        r#"<key name="arm/up" qpos="0 0"/>"#,
    ] {
        assert!(made.text.contains(piece), "{piece}\n{}", made.text);
    }
    let said: Vec<String> = made.losses.iter().map(ToString::to_string).collect();
    for piece in
        ["arm.srdf:2: group \"arm\": <group>", "arm.srdf:4: joint \"wrist\"", "arm.srdf:6: <disable_collisions>"]
    {
        assert!(said.iter().any(|line| line.contains(piece)), "{piece} {said:?}");
    }
    let back = srdf_of("arm.xml", &made.text, &source).unwrap().text;
    for piece in [
        r#"<disable_collisions link1="base" link2="upper" reason="User"/>"#,
        r#"<group_state name="home" group="arm">"#,
        r#"<joint name="shoulder" value="-0.25"/>"#,
    ] {
        assert!(back.contains(piece), "{piece}\n{back}");
    }
    assert!(srdf_of("arm.urdf", ARM, &source).unwrap_err().to_string().contains("an SRDF is made only from MJCF"));
}

#[test]
fn rules_of_other_formats_find_their_bad_example_and_not_their_good_one() {
    let mut count = 0;
    let rules = Rules::of("m.xml", &CheckOptions::default()).unwrap();
    for rule in RULES.iter().filter(|rule| rule.bad.starts_with("<mujoco") || rule.bad.starts_with("<sdf")) {
        let found = |text: &str| {
            let robot = robot("m.xml", text);
            // What is only a note of the reading has a rule of its own here.
            assert!(robot.notes.iter().all(|note| matches!(note, Note::Corrected { .. })), "{:?}", robot.notes);
            let findings = rules.check("m.xml", &robot.source.text);
            findings.into_iter().map(|finding| (finding.rule, finding.place.line)).collect::<Vec<_>>()
        };
        let (bad, good) = (found(rule.bad), found(rule.good));
        let own = bad.iter().filter(|(code, _)| *code == rule.code).collect::<Vec<_>>();
        assert_eq!(own.len(), 1, "{rule:?}: {bad:?}");
        assert!(own[0].1 > 1, "the line of the file: {bad:?}");
        assert!(
            bad.iter().all(|(code, _)| *code != "D007") && good.iter().all(|(code, _)| *code != rule.code),
            "{bad:?} {good:?}"
        );
        count += 1;
    }
    assert!(count >= 4);
}
