//! There and back: over random trees, and over what files state of a joint's values.

use crate::support::{edit, edit_files, words_of};
use denavit_compare::{Options, Subject, Verdict, compare};
use denavit_edit::{Files, Operation, Text, apply};
use denavit_model::{Reading, urdf};
use proptest::prelude::*;
use std::fmt::Write as _;

/// A joint of a random tree.
#[derive(Debug, Clone)]
struct Drawn {
    parent: usize,
    kind: usize,
    axis: Option<[i8; 3]>,
    origin: Option<([f64; 3], [f64; 3])>,
    mimic: Option<(usize, f64)>,
    heavy: bool,
}

const KINDS: [&str; 6] = ["fixed", "revolute", "continuous", "prismatic", "floating", "planar"];

fn drawn() -> impl Strategy<Value = Vec<Drawn>> {
    let axis = prop::option::of(prop::array::uniform3(-1..=1i8).prop_filter("no axis", |axis| *axis != [0; 3]));
    let numbers = || prop::array::uniform3(prop_oneof![Just(0.0), -1.0..1.0f64]);
    let origin = prop::option::of((numbers(), numbers()));
    let mimic = prop::option::weighted(0.2, (0..8usize, -2.0..2.0f64));
    let one = (0..8usize, 0..6usize, axis, origin, mimic, any::<bool>());
    let one =
        one.prop_map(|(parent, kind, axis, origin, mimic, heavy)| Drawn { parent, kind, axis, origin, mimic, heavy });
    prop::collection::vec(one, 1..8)
}

/// Links l0 … ln, joints j1 … jn.
fn text_of(drawn: &[Drawn]) -> String {
    let mut text = String::from("<robot name=\"random\">\n  <link name=\"l0\"/>\n");
    for (index, joint) in drawn.iter().enumerate() {
        let child = index + 1;
        let kind = KINDS[joint.kind];
        if joint.heavy {
            let _ = writeln!(
                text,
                "  <link name=\"l{child}\">\n    <inertial><origin xyz=\"0.1 0 0.2\"/><mass value=\"2\"/>\
                 <inertia ixx=\"1\" ixy=\"0.1\" ixz=\"0.2\" iyy=\"2\" iyz=\"0.3\" izz=\"2.5\"/></inertial>\n    \
                 <visual><origin xyz=\"0 0.1 0\" rpy=\"0.3 0 1\"/><geometry><box size=\"1 2 3\"/></geometry></visual>\n  </link>"
            );
        } else {
            let _ = writeln!(text, "  <link name=\"l{child}\"/>");
        }
        let _ = writeln!(text, "  <joint name=\"j{child}\" type=\"{kind}\">");
        if let Some((xyz, rpy)) = joint.origin {
            let [x, y, z] = xyz;
            let [a, b, c] = rpy;
            let _ = writeln!(text, "    <origin xyz=\"{x} {y} {z}\" rpy=\"{a} {b} {c}\"/>");
        }
        let _ = writeln!(text, "    <parent link=\"l{}\"/>\n    <child link=\"l{child}\"/>", joint.parent % child);
        if let Some([x, y, z]) = joint.axis {
            let _ = writeln!(text, "    <axis xyz=\"{x} {y} {z}\"/>");
        }
        if matches!(kind, "revolute" | "prismatic") {
            text.push_str("    <limit lower=\"-1.25\" upper=\"0.5\" effort=\"10\" velocity=\"2\"/>\n");
            text.push_str(
                "    <safety_controller k_velocity=\"3\" soft_lower_limit=\"-1\" soft_upper_limit=\"0.4\"/>\n",
            );
            text.push_str("    <calibration rising=\"0.25\"/>\n");
        }
        if let Some((driver, multiplier)) = joint.mimic {
            let driver = driver % child;
            if driver > 0
                && matches!(kind, "revolute" | "continuous" | "prismatic")
                && (1..4).contains(&drawn[driver - 1].kind)
            {
                let _ = writeln!(text, "    <mimic joint=\"j{driver}\" multiplier=\"{multiplier}\" offset=\"0.125\"/>");
            }
        }
        text.push_str("  </joint>\n");
    }
    text + "</robot>\n"
}

fn is_same(before: &str, after: &str) -> bool {
    let (a, b) = (urdf::read("a.urdf", before).unwrap(), urdf::read("b.urdf", after).unwrap());
    let options = Options { samples: 0, reading: Reading::AsWritten, ..Options::default() };
    compare(&Subject::Robot(&a), &Subject::Robot(&b), &options).unwrap().verdict == Verdict::Same
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]

    #[test]
    fn flipped_twice_is_the_first(drawn in drawn(), which in 0..8usize) {
        let text = text_of(&drawn);
        let joint = which % drawn.len();
        let name = format!("j{}", joint + 1);
        let flipped = edit(&text, &format!("flip {name}"));
        if !(1..4).contains(&drawn[joint].kind) {
            prop_assert!(flipped.is_err());
            return Ok(());
        }
        let flipped = flipped.unwrap().files.urdf.text;
        prop_assert_ne!(&flipped, &text);
        let again = edit(&flipped, &format!("flip {name}")).unwrap().files.urdf.text;
        if drawn[joint].axis.is_some() && drawn[joint].mimic.is_none() {
            prop_assert_eq!(again, text);
        } else {
            prop_assert!(is_same(&text, &again), "{again}");
        }
    }

    #[test]
    fn zeroed_there_and_back_is_the_same(drawn in drawn(), which in 0..8usize, value in -2.0..2.0f64) {
        let text = text_of(&drawn);
        let joint = which % drawn.len();
        let name = format!("j{}", joint + 1);
        if (1..4).contains(&drawn[joint].kind) {
            let again = edit(&text, &format!("zero {name}={value};zero {name}={}", -value)).unwrap().files.urdf.text;
            prop_assert!(is_same(&text, &again), "{again}");
        }
    }

    #[test]
    fn rerooted_there_and_back_is_the_same(drawn in drawn(), which in 0..9usize) {
        let text = text_of(&drawn);
        let link = which % (drawn.len() + 1);
        let there = edit(&text, &format!("reroot l{link}")).unwrap().files.urdf.text;
        let made = urdf::read("there.urdf", &there).unwrap();
        prop_assert_eq!(&made.links[made.root].name, &format!("l{link}"));
        let again = edit(&there, "reroot l0").unwrap().files.urdf.text;
        prop_assert!(is_same(&text, &again), "{there}{again}");
        prop_assert_eq!(urdf::read("again.urdf", &again).unwrap().links.len(), drawn.len() + 1);
    }

    #[test]
    fn mirrored_twice_is_the_first(drawn in drawn(), plane in 0..3usize) {
        let text = text_of(&drawn);
        let plane = ["xy", "xz", "yz"][plane];
        if let Ok(once) = edit(&text, &format!("mirror {plane}")) {
            let again = edit(&once.files.urdf.text, &format!("mirror {plane}")).unwrap().files.urdf.text;
            prop_assert!(is_same(&text, &again), "{again}");
        }
    }

    #[test]
    fn attached_then_extracted_is_the_same(drawn in drawn(), which in 0..9usize) {
        let text = text_of(&drawn);
        let mut words = words_of(&format!("attach other.urdf --at l{} --pose 0.1,0.2,0.3,10deg,0,20deg --prefix g_", which % (drawn.len() + 1)));
        words.other = Some(Text { file: "other.urdf".into(), text: text.clone() });
        let both = apply(&Files::urdf("robot.urdf", &*text), &[Operation::of(&words).unwrap()]).unwrap().files.urdf.text;
        prop_assert!(is_same(&text, &edit(&both, "cut g_l0").unwrap().files.urdf.text));
        let mut names = String::from("extract g_l0;rename");
        for index in 0..=drawn.len() {
            let _ = write!(names, " g_l{index}=l{index}");
            if index > 0 {
                let _ = write!(names, " g_j{index}=j{index}");
            }
        }
        prop_assert!(is_same(&text, &edit(&both, &names).unwrap().files.urdf.text));
    }

    #[test]
    fn what_is_recentred_is_there_already(drawn in drawn()) {
        let text = text_of(&drawn);
        let once = edit(&text, "recentre").unwrap().files.urdf.text;
        prop_assert_eq!(&edit(&once, "recentre").unwrap().files.urdf.text, &once);
    }

    #[test]
    fn renamed_and_back_is_the_first(drawn in drawn(), which in 0..8usize) {
        let text = text_of(&drawn);
        let name = which % drawn.len() + 1;
        let there = format!("rename l{name}=arm j{name}=turn;prefix a_");
        let back = format!("rename a_arm=l{name} a_turn=j{name}");
        let there = edit(&text, &there).unwrap().files.urdf.text;
        prop_assert!(is_same(&text, &there));
        let mut operations = back;
        for index in (0..=drawn.len()).filter(|index| *index != name) {
            let _ = write!(operations, " a_l{index}=l{index}");
            if index > 0 {
                let _ = write!(operations, " a_j{index}=j{index}");
            }
        }
        prop_assert_eq!(edit(&there, &operations).unwrap().files.urdf.text, text);
    }
}

/// A joint with everything that states a value of it, and a follower.
const FULL: &str = r#"<robot name="full">
  <link name="base"/> <link name="arm"/> <link name="finger"/>
  <joint name="turn" type="revolute">
    <parent link="base"/> <child link="arm"/>
    <limit lower="-1.5" upper="2" effort="1" velocity="1"/>
    <safety_controller k_velocity="1" soft_lower_limit="-1.4" soft_upper_limit="1.9"/>
    <calibration rising="0.5"/>
  </joint>
  <joint name="grip" type="prismatic">
    <parent link="arm"/> <child link="finger"/> <axis xyz="0 1 0"/>
    <limit lower="0" upper="0.1" effort="1" velocity="1"/> <mimic joint="turn"/>
  </joint>
  <transmission name="drive">
    <type>transmission_interface/SimpleTransmission</type>
    <joint name="turn"><hardwareInterface>PositionJointInterface</hardwareInterface></joint>
    <actuator name="motor"><mechanicalReduction>100</mechanicalReduction></actuator>
  </transmission>
  <gazebo reference="turn"><springReference>0.25</springReference></gazebo>
  <ros2_control name="system" type="system">
    <joint name="turn">
      <command_interface name="position"><param name="min">-1.5</param><param name="max">2</param></command_interface>
      <state_interface name="position"><param name="initial_value">0.75</param></state_interface>
      <state_interface name="velocity"/>
    </joint>
  </ros2_control>
</robot>
"#;

const STATES: &str = r#"<robot name="full">
  <group name="all"><chain base_link="base" tip_link="finger"/></group>
  <group_state name="home" group="all"><joint name="turn" value="0.75"/></group_state>
</robot>
"#;

fn full() -> Files {
    Files {
        urdf: Text { file: "full.urdf".into(), text: FULL.into() },
        srdf: Some(Text { file: "full.srdf".into(), text: STATES.into() }),
    }
}

#[test]
fn everything_that_states_a_value_follows_a_flip() {
    let done = edit_files(&full(), "flip turn").unwrap();
    let text = &done.files.urdf.text;
    for expected in [
        r#"<axis xyz="-1 0 0"/>"#,
        r#"<limit lower="-2" upper="1.5""#,
        r#"soft_lower_limit="-1.9" soft_upper_limit="1.4""#,
        r#"<calibration falling="-0.5"/>"#,
        r#"<mimic joint="turn" multiplier="-1"/>"#,
        "<mechanicalReduction>-100</mechanicalReduction>",
        "<springReference>-0.25</springReference>",
        r#"<param name="min">-2</param><param name="max">1.5</param>"#,
        r#"<param name="initial_value">-0.75</param>"#,
    ] {
        assert!(text.contains(expected), "{expected} is missing in\n{text}");
    }
    assert!(done.files.srdf.unwrap().text.contains(r#"value="-0.75""#));
    assert_eq!(
        done.reports[0].to_string(),
        "flip turn: moves as before within 1e-15 m and 1e-15 rad; turn reversed; 1 limit exchanged; 1 soft limit exchanged; \
         1 calibration position rewritten; 1 mimic joint updated; 1 transmission updated; 1 value for Gazebo rewritten; \
         1 command range rewritten; 1 initial value rewritten; 1 SRDF state rewritten"
    );
}

#[test]
fn everything_that_states_a_value_follows_a_new_zero() {
    let done = edit_files(&full(), "zero turn=0.5rad").unwrap();
    let text = &done.files.urdf.text;
    for expected in [
        r#"<origin xyz="0 0 0" rpy="0.5 0 0"/>"#,
        r#"<limit lower="-2" upper="1.5""#,
        r#"soft_lower_limit="-1.9" soft_upper_limit="1.4""#,
        r#"<calibration rising="0"/>"#,
        r#"<mimic joint="turn" offset="0.5"/>"#,
        "<offset>-0.5</offset>",
        "<springReference>-0.25</springReference>",
        r#"<param name="min">-2</param><param name="max">1.5</param>"#,
        r#"<param name="initial_value">0.25</param>"#,
    ] {
        assert!(text.contains(expected), "{expected} is missing in\n{text}");
    }
    assert!(done.files.srdf.unwrap().text.contains(r#"value="0.25""#));
}

#[test]
fn names_follow_everywhere() {
    let done = edit_files(&full(), "rename turn=elbow finger=tip").unwrap();
    let (text, srdf) = (&done.files.urdf.text, &done.files.srdf.as_ref().unwrap().text);
    assert!(!text.contains("\"turn\"") && !text.contains("\"finger\""), "{text}");
    assert_eq!(text.matches("\"elbow\"").count(), 5);
    assert!(srdf.contains(r#"tip_link="tip""#) && srdf.contains(r#"<joint name="elbow" value="0.75"/>"#));
    let taken = edit_files(&full(), "rename arm=finger").unwrap_err();
    assert_eq!(taken.to_string(), "full.urdf: two links would be named \"finger\"; choose another name");
}

#[test]
fn what_cannot_be_done_says_why() {
    for (operation, expected) in [
        ("flip trun", "robot.urdf: the robot has no joint \"trun\"; did you mean \"turn\"?"),
        ("zero turn=3kg", "\"3kg\" is not an angle, such as 0.5, 0.5rad or 90deg"),
        ("zero turn", "zero turn: write zero JOINT=VALUE"),
        ("reroot", "reroot: write reroot LINK"),
    ] {
        assert_eq!(edit(FULL, operation).unwrap_err().to_string(), expected);
    }
}
