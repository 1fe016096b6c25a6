//! Every report format, as the user sees it.

use denavit_compare::lint::{Config, Lookup, check};
use denavit_compare::report::{Colour, FORMATS, Report, text};
use denavit_compare::{Comparison, Options, Subject, compare};
use denavit_model::urdf;

const BEFORE: &str = r#"<robot name="arm">
  <link name="base"/>
  <link name="upper">
    <inertial> <origin xyz="0.2 0 0"/> <mass value="2"/>
      <inertia ixx="0.01" ixy="0" ixz="0" iyy="0.02" iyz="0" izz="0.02"/> </inertial>
    <visual> <origin xyz="0.2 0 0"/> <geometry> <box size="0.4 0.1 0.1"/> </geometry> </visual>
  </link>
  <link name="lower">
    <visual> <geometry> <mesh filename="package://arm/lower.stl"/> </geometry> </visual>
  </link>
  <link name="tool0"/>
  <joint name="shoulder" type="revolute">
    <origin xyz="0 0 0.5"/> <axis xyz="0 0 1"/> <parent link="base"/> <child link="upper"/>
    <limit lower="-1" upper="1" effort="10" velocity="1"/>
  </joint>
  <joint name="elbow" type="revolute">
    <origin xyz="0.4 0 0"/> <axis xyz="0 1 0"/> <parent link="upper"/> <child link="lower"/>
    <limit lower="0" upper="1.5" effort="10" velocity="1"/>
  </joint>
  <joint name="flange" type="fixed">
    <origin xyz="0.3 0 0"/> <parent link="lower"/> <child link="tool0"/>
  </joint>
</robot>
"#;

/// The elbow moved and limited otherwise, the arm heavier, a mesh of another name, the lower link renamed.
fn after() -> String {
    BEFORE
        .replace("xyz=\"0.4 0 0\"", "xyz=\"0.4 0.002 0.001\"")
        .replace("upper=\"1.5\"", "upper=\"1.6\"")
        .replace("mass value=\"2\"", "mass value=\"2.5\"")
        .replace("lower.stl", "lower_v2.stl")
        .replace("link name=\"tool0\"", "link name=\"tool\"")
        .replace("link=\"tool0\"", "link=\"tool\"")
}

fn comparison() -> Comparison {
    let a = urdf::read("before.urdf", BEFORE).unwrap();
    let b = urdf::read("after, with | in its name.urdf", &after()).unwrap();
    compare(&Subject::Robot(&a), &Subject::Robot(&b), &Options::default()).unwrap()
}

const FAULTY: &str = r#"<robot name="faulty">
  <link name="base"/> <link name="arm"> <visual> <geometry> <mesh filename="package://no/where &amp; ever.stl"/>
  </geometry> </visual> </link>
  <joint name="j" type="revolute"> <origin rpy="1.57 0 0"/> <axis xyz="0 0 2"/>
    <parent link="base"/> <child link="arm"/> <limit lower="1" upper="-1" effort="1" velocity="1"/> </joint>
</robot>
"#;

fn snapshots() -> insta::Settings {
    let mut settings = insta::Settings::clone_current();
    settings.set_snapshot_path("golden");
    settings.set_prepend_module_to_snapshot(false);
    settings.set_omit_expression(true);
    // Full digits differ from platform to platform in the last: six are the same everywhere.
    settings.add_filter(r"(\d\.\d{6})\d+", "$1");
    settings
}

#[test]
fn a_comparison_in_every_format() {
    let comparison = comparison();
    snapshots().bind(|| {
        for format in FORMATS {
            insta::assert_snapshot!(format!("diff_{}", format.name), (format.render)(&Report::Comparison(&comparison)));
        }
        insta::assert_snapshot!("diff_colour", text(&Report::Comparison(&comparison), Colour::Ansi));
    });
}

#[test]
fn findings_in_every_format() {
    let lookup = |name: &str| Lookup::NotFound(format!("no package \"{}\"", &name[10..12]));
    let findings = check("faulty.urdf", FAULTY, &lookup, &Config::default());
    let files = ["faulty.urdf".to_owned(), "clean.urdf".to_owned()];
    snapshots().bind(|| {
        for format in FORMATS {
            let report = Report::Findings { files: &files, findings: &findings, inventories: &[], known: None };
            insta::assert_snapshot!(format!("check_{}", format.name), (format.render)(&report));
        }
    });
}

#[test]
fn the_same_robot_in_every_format() {
    let a = urdf::read("a.urdf", BEFORE).unwrap();
    let comparison = compare(&Subject::Robot(&a), &Subject::Robot(&a), &Options::default()).unwrap();
    snapshots().bind(|| {
        for format in FORMATS.iter().filter(|format| ["text", "junit", "markdown"].contains(&format.name)) {
            insta::assert_snapshot!(format!("same_{}", format.name), (format.render)(&Report::Comparison(&comparison)));
        }
    });
}

#[test]
fn machine_formats_are_well_formed() {
    let comparison = comparison();
    let render = |name: &str| (denavit_compare::report::format(name).unwrap().render)(&Report::Comparison(&comparison));
    let junit = render("junit");
    let document = roxmltree::Document::parse(&junit).unwrap();
    let failures = document.descendants().filter(|node| node.has_tag_name("failure")).count();
    assert_eq!(document.root_element().attribute("failures"), Some(failures.to_string().as_str()));
    let sarif: serde_json::Value = serde_json::from_str(&render("sarif")).unwrap();
    let rules = sarif["runs"][0]["tool"]["driver"]["rules"].as_array().unwrap();
    for result in sarif["runs"][0]["results"].as_array().unwrap() {
        assert!(rules.iter().any(|rule| rule["id"] == result["ruleId"]), "{result}");
    }
    for line in render("github").lines() {
        assert!(["::error ", "::warning ", "::notice "].iter().any(|start| line.starts_with(start)), "{line}");
    }
}
