//! Everything of a robot is compared in the way that the list says.

use denavit_compare::compared::{By, COMPARED};
use denavit_compare::describe::describe;
use denavit_compare::lint::{Config, Lookup, check};
use denavit_compare::report::{Colour, Report, text as text_of};
use denavit_compare::{Comparison, Options, Scope, Subject, Verdict, compare, fingerprint};
use denavit_model::urdf;
use std::fmt::Write as _;
use std::time::{Duration, Instant};

const ROBOT: &str = r#"<robot name="r">
  <link name="base"><visual><geometry><box size="1 1 1"/></geometry><material name="grey"/></visual></link>
  <link name="arm"><inertial><origin xyz="0 0 0.1"/><mass value="2"/>
    <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial><contact><stiffness value="5"/></contact></link>
  <link name="hand"><collision><geometry><mesh filename="hand.stl"/></geometry></collision></link>
  <link name="middle"/><link name="tcp"/><link name="finger"><visual><geometry><sphere radius="0.1"/></geometry></visual></link>
  <joint name="shoulder" type="continuous"><origin xyz="0 0 1"/><axis xyz="0 0 1"/><parent link="base"/><child link="arm"/>
    <limit velocity="2" effort="30"/><dynamics damping="0.5" friction="0.1"/><calibration rising="0.3"/></joint>
  <joint name="elbow" type="revolute"><origin xyz="1 0 0"/><axis xyz="0 1 0"/><parent link="arm"/><child link="hand"/>
    <limit lower="-1" upper="1" velocity="2" effort="30"/>
    <safety_controller soft_lower_limit="-0.9" soft_upper_limit="0.9" k_position="10" k_velocity="1"/></joint>
  <joint name="f0" type="fixed"><origin xyz="0 0 0.1"/><parent link="hand"/><child link="middle"/></joint>
  <joint name="f1" type="fixed"><origin xyz="0 0 0.1"/><parent link="middle"/><child link="tcp"/></joint>
  <joint name="grip" type="prismatic"><axis xyz="1 0 0"/><parent link="hand"/><child link="finger"/>
    <limit lower="0" upper="1"/><mimic joint="elbow" multiplier="0.5" offset="0"/></joint>
  <transmission name="t"><type>simple</type><joint name="elbow"/>
    <actuator name="m"><mechanicalReduction>1</mechanicalReduction></actuator></transmission>
  <gazebo reference="arm"><mu1>0.2</mu1></gazebo>
  <gazebo reference="hand"><sensor name="cam"><pose>0 0 0.1 0 0 0</pose></sensor><fdir1>1 0 0</fdir1></gazebo>
  <sensor name="ft"><parent link="hand"/><origin xyz="0 0 0.1"/></sensor>
</robot>"#;

/// For each entry of the list edits of the robot, and words of the difference that is found.
const EDITS: &[&[(&str, &str, &str)]] = &[
    &[
        ("<axis xyz=\"0 1 0\"/>", "<axis xyz=\"0 -1 0\"/>", "sense reversed"),
        ("<origin xyz=\"1 0 0\"/>", "<origin xyz=\"1.05 0 0\"/>", "moved by 50 mm"),
        ("type=\"continuous\"", "type=\"revolute\"", "kind continuous to revolute"),
    ],
    &[("lower=\"-1\"", "lower=\"-1.1\"", "lower limit -1 to -1.1")],
    &[("multiplier=\"0.5\"", "multiplier=\"0.6\"", "mimic")],
    &[(TCP, "", "link \"tcp\": frame is gone (joint \"f1\")")],
    &[
        ("<limit velocity=\"2\"", "<limit velocity=\"3\"", "velocity limit 2 to 3"),
        ("<limit velocity=\"2\" effort=\"30\"", "<limit velocity=\"2\" effort=\"31\"", "effort limit 30 to 31"),
        ("<limit velocity=\"2\"", "<limit lower=\"-3\" upper=\"3\" velocity=\"2\"", "lower limit none to -3"),
    ],
    &[("damping=\"0.5\"", "damping=\"0.6\"", "damping 0.5 to 0.6"), (" friction=\"0.1\"", "", "friction 0.1 to 0")],
    &[
        ("soft_lower_limit=\"-0.9\"", "soft_lower_limit=\"-0.8\"", "soft lower limit -0.9 to -0.8"),
        ("k_velocity=\"1\"", "k_velocity=\"2\"", "k_velocity 1 to 2"),
    ],
    &[
        ("<calibration rising=\"0.3\"/>", "", "calibration rising 0.3 to none"),
        ("rising=\"0.3\"", "rising=\"0.4\"", "calibration rising 0.3 to 0.4"),
    ],
    &[
        ("<mass value=\"2\"/>", "<mass value=\"20\"/>", "mass 2 kg to 20 kg"),
        ("xyz=\"0 0 0.1\"/><mass", "xyz=\"0 0 0.2\"/><mass", "centre of mass"),
        ("ixx=\"1\"", "ixx=\"1.1\"", "inertia tensor"),
    ],
    &[
        ("size=\"1 1 1\"", "size=\"1 1 2\"", "visual"),
        ("hand.stl\"", "other.stl\"", "mesh other.stl"),
        ("hand.stl\"", "hand.stl\" scale=\"1 1 2\"", "scale 1 1 2"),
    ],
    &[
        ("<pose>0 0 0.1 0 0 0", "<pose>0 0 0.2 0 0 0", "gazebo of \"hand\": sensor \"cam\"/pose moved by 100 mm"),
        ("<pose>0 0 0.1 0 0 0", "<pose>0 0 0.1 0 0 0.1", "sensor \"cam\"/pose turned by"),
        ("<fdir1>1 0 0", "<fdir1>0 1 0", "fdir1 turned by"),
        ("<origin xyz=\"0 0 0.1\"/></sensor>", "</sensor>", "sensor \"ft\": origin moved by 100 mm"),
        ("<pose>0 0 0.1", "<pose relative_to=\"arm\">0 0 0.1", "sensor \"cam\"/pose moves with another body"),
    ],
    &[
        ("<stiffness value=\"5\"/>", "<stiffness value=\"6\"/>", "link \"arm\"/contact: stiffness@value: 5 to 6"),
        (">1</mech", ">-100</mech", "transmission \"t\": actuator \"m\"/mechanicalReduction: 1 to -100"),
        ("<mu1>0.2", "<mu1>0.3", "gazebo of \"arm\": mu1: 0.2 to 0.3"),
        ("<gazebo reference=\"arm\"><mu1>0.2</mu1></gazebo>", "", "gazebo of \"arm\": is gone"),
    ],
    &[
        ("<axis xyz=\"0 1 0\"/>", "<axis xyz=\"0 1 0\" quat=\"1 0 0 0\"/>", "joint \"elbow\"/<axis>: is new"),
        ("<link name=\"base\">", "<link name=\"base\">Base", "link \"base\"/<link>"),
    ],
    &[("\"finger\"", "\"thumb\"", "")],
    &[(MIDDLE, MIDDLE_ELSEWHERE, "")],
    &[
        ("<origin xyz=\"1 0 0\"/>", "<origin xyz=\"1 0 0\" quat_xyzw=\"0 0 0 1\"/>", ""),
        ("<pose>0 0 0.1 0 0 0", "<pose degrees=\"true\" relative_to=\"hand\">0 0 0.1 0 0 0", ""),
        ("<pose>0 0 0.1 0 0 0", "<pose relative_to=\"tcp\">0 0 -0.1 0 0 0", ""),
        ("<pose>0 0 0.1 0 0 0", "<pose rotation_format=\"quat_xyzw\">0 0 0.1 0 0 0 1", ""),
    ],
    &[("<material name=\"grey\"/>", "<material name=\"red\"/>", "")],
    &[],
    &[("value=\"5\"", "value=\"5.0\"", ""), ("<link name=\"base\">", "<!-- here --><link name=\"base\">", "")],
];

const TCP: &str =
    "<joint name=\"f1\" type=\"fixed\"><origin xyz=\"0 0 0.1\"/><parent link=\"middle\"/><child link=\"tcp\"/></joint>";
const MIDDLE: &str = "<origin xyz=\"0 0 0.1\"/><parent link=\"hand\"/><child link=\"middle\"/></joint>\n  <joint name=\"f1\" type=\"fixed\"><origin xyz=\"0 0 0.1\"/>";
const MIDDLE_ELSEWHERE: &str = "<origin xyz=\"0 0 0.05\"/><parent link=\"hand\"/><child link=\"middle\"/></joint>\n  <joint name=\"f1\" type=\"fixed\"><origin xyz=\"0 0 0.15\"/>";

fn edited(from: &str, to: &str) -> String {
    assert!(ROBOT.contains(from), "{from}");
    let text = ROBOT.replace(from, to);
    // The tool frame's link goes with its joint.
    if from == TCP { text.replace("<link name=\"tcp\"/>", "") } else { text }
}

fn found(text: &str, scope: Scope) -> Comparison {
    let (a, b) = (urdf::read("a", ROBOT).unwrap(), urdf::read("b", text).unwrap());
    compare(&Subject::Robot(&a), &Subject::Robot(&b), &Options { scope, ..Options::default() }).unwrap()
}

#[test]
fn every_entry_of_the_list_is_compared_as_it_says() {
    assert_eq!(EDITS.len(), COMPARED.len());
    let print = |text: &str| fingerprint(&Subject::Robot(&urdf::read("r", text).unwrap()), 1e-6);
    let lines = |text: &str| describe(&Subject::Robot(&urdf::read("r", text).unwrap()));
    let own = print(ROBOT);
    for (entry, edits) in COMPARED.iter().zip(EDITS) {
        for (from, to, words) in *edits {
            let text = edited(from, to);
            let (all, motion) = (found(&text, Scope::Everything), found(&text, Scope::Kinematics));
            let said = text_of(&Report::Comparison(&all), Colour::None);
            assert!(said.contains(words), "{from} to {to}: {said}");
            let differs = |comparison: &Comparison| comparison.verdict == Verdict::Different;
            assert_eq!(differs(&all), entry.by != By::Nobody, "{from} to {to}: {said}");
            assert_eq!(differs(&motion), entry.by == By::Motion, "{from} to {to}: {motion:?}");
            let now = print(&text);
            assert_eq!(now.motion != own.motion, entry.by == By::Motion, "{from} to {to}");
            if entry.by != By::Motion {
                assert_eq!(now.matter != own.matter, entry.by == By::Matter, "{from} to {to}");
            }
            assert!(entry.by == By::Nobody || lines(&text) != lines(ROBOT), "{from} to {to} is not in the description");
        }
    }
}

#[test]
fn frames_on_one_side_only_are_named() {
    let interior = ROBOT
        .replace("\"middle\"", "\"other_middle\"")
        .replace("xyz=\"0 0 0.1\"/><parent link=\"hand\"", "xyz=\"0 0 0.05\"/><parent link=\"hand\"")
        .replace("xyz=\"0 0 0.1\"/><parent link=\"other", "xyz=\"0 0 0.15\"/><parent link=\"other");
    let found = found(&interior, Scope::Everything);
    assert_eq!(found.verdict, Verdict::Same, "{found:?}");
    assert!(found.notes.iter().any(|note| note == "links removed: \"middle\""), "{:?}", found.notes);
    assert!(found.notes.iter().any(|note| note == "links added: \"other_middle\""), "{:?}", found.notes);
}

#[test]
fn a_new_frame_counts_but_not_for_motion() {
    let new = "<link name=\"camera\"/><joint name=\"c\" type=\"fixed\"><origin xyz=\"0 0 1\"/><parent link=\"hand\"/><child \
               link=\"camera\"/></joint></robot>";
    let text = ROBOT.replace("</robot>", new);
    assert_eq!(found(&text, Scope::Everything).verdict, Verdict::Different);
    assert_eq!(found(&text, Scope::Kinematics).verdict, Verdict::Same);
}

#[test]
fn a_text_that_is_no_fingerprint_is_distinguished_from_another_fingerprint() {
    let own = fingerprint(&Subject::Robot(&urdf::read("r", ROBOT).unwrap()), 1e-6);
    assert_eq!(own.comparable(&own.to_string()), Ok(()));
    for (written, words) in [
        ("abc", "is not a fingerprint"),
        ("d3-1e-6-98f2c1a0b3d4-55e01f7a9c2", "is not a fingerprint"),
        ("d1-1e-6-98f2c1a0b3d4-55e01f7a9c22", "format d1"),
        ("d3-1e-5-98f2c1a0b3d4-55e01f7a9c22", "‹tolerance› 1e-5"),
    ] {
        let error = own.comparable(written).unwrap_err().to_string();
        assert!(error.contains(words), "{error}");
    }
}

/// A robot of `count` joints, in a row or all on the base; the elbow may be moved.
fn many(count: usize, in_a_row: bool, moved: f64) -> String {
    let mut text = String::from("<robot name=\"r\"><link name=\"l0\"/>");
    for k in 1..=count {
        let parent = if in_a_row { k - 1 } else { 0 };
        let x = if k == count / 2 { 0.01 + moved } else { 0.01 };
        let _ = write!(
            text,
            "<link name=\"l{k}\"><inertial><mass value=\"1\"/><inertia ixx=\"1\" iyy=\"1\" izz=\"1\" ixy=\"0\" ixz=\"0\" \
             iyz=\"0\"/></inertial><visual><geometry><sphere radius=\"0.1\"/></geometry></visual></link><joint \
             name=\"j{k}\" type=\"revolute\"><origin xyz=\"{x} 0 0\"/><axis xyz=\"0 0 1\"/><limit lower=\"-1\" upper=\"1\" \
             velocity=\"1\" effort=\"1\"/><parent link=\"l{parent}\"/><child link=\"l{k}\"/></joint>"
        );
    }
    text + "</robot>"
}

fn time_of(work: impl FnOnce()) -> Duration {
    let start = Instant::now();
    work();
    start.elapsed()
}

#[test]
fn nothing_grows_with_the_square_of_the_robot() {
    type Work = fn(&str, &str);
    // Eight times the joints: linear work takes 8 times as long, quadratic 64 times.
    let (small, large) = (400, 3200);
    let check = |text: &str, _: &str| {
        let lookup = |_: &str| Lookup::Unknown;
        drop(check("r", text, &lookup, &Config::default()));
    };
    let print = |text: &str, _: &str| drop(fingerprint(&Subject::Robot(&urdf::read("r", text).unwrap()), 1e-6));
    let differ = |one: &str, other: &str| {
        let (a, b) = (urdf::read("a", one).unwrap(), urdf::read("b", other).unwrap());
        drop(
            compare(&Subject::Robot(&a), &Subject::Robot(&b), &Options { samples: 64, ..Options::default() }).unwrap(),
        );
    };
    let works: [(&str, Work); 3] = [("check", check), ("fingerprint", print), ("diff", differ)];
    for in_a_row in [true, false] {
        for (name, work) in works {
            let times = |count| {
                let (one, other) = (many(count, in_a_row, 0.0), many(count, in_a_row, 0.0));
                move || time_of(|| work(&one, &other))
            };
            let (short, long) = (times(small), times(large));
            // Whatever else the machine does lengthens some of the times; what is quadratic is too slow every time.
            let ratio = || long().as_secs_f64() / short().as_secs_f64().max(2e-3);
            let least = (0..10).map(|_| ratio()).find(|ratio| *ratio < 30.0);
            assert!(
                least.is_some(),
                "{name}, in a row {in_a_row}: eight times as large takes 30 times as long, ten times"
            );
        }
    }
}

#[test]
fn an_edit_of_a_long_chain_is_found_and_bounded() {
    let (a, b) = (many(20_000, true, 0.0), many(20_000, true, 0.002));
    let (a, b) = (urdf::read("a", &a).unwrap(), urdf::read("b", &b).unwrap());
    let found = compare(&Subject::Robot(&a), &Subject::Robot(&b), &Options::default()).unwrap();
    assert_eq!(found.joints.len(), 1, "{:?}", found.joints);
    assert_eq!(found.joints[0].joint, "j10000");
    let tip = found.largest().unwrap();
    assert!(tip.sampled_m > 0.00199 && tip.bound_m >= tip.sampled_m, "{} {}", tip.sampled_m, tip.bound_m);
}

#[test]
fn absurd_magnitudes_end_and_are_found() {
    for length in ["1e6", "1e155", "1e308"] {
        let text = ROBOT.replace("<origin xyz=\"1 0 0\"/>", &format!("<origin xyz=\"{length} 0 0\"/>"));
        assert_eq!(found(&text, Scope::Everything).verdict, Verdict::Different);
        let findings = check("r", &text, &|_| Lookup::Unknown, &Config::default());
        assert!(findings.iter().any(|finding| finding.rule == "D016"), "{findings:?}");
        let robot = urdf::read("r", &text).unwrap();
        drop(fingerprint(&Subject::Robot(&robot), 1e-6));
        let error = robot.chain(None, None, denavit_model::Reading::Intended).unwrap_err().to_string();
        assert!(error.contains("give every length in m"), "{error}");
    }
}
