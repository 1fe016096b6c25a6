//! The canonical URDF piece by piece, as a reader of the file sees it.

#![expect(clippy::unwrap_used, reason = "a test stops at what it did not expect")]

use denavit_export::urdf::{Frames, LinkFrames, Options, canonical};
use denavit_model::se3::{self, Pose};
use denavit_model::tree::Reading;
use denavit_model::{Robot, urdf};

fn robot(body: &str) -> Robot {
    urdf::read("test.urdf", &format!("<robot name=\"test\">\n{body}\n</robot>\n")).unwrap()
}

fn export(body: &str, options: &Options) -> String {
    let text = canonical(&robot(body), options).unwrap().value;
    let again = urdf::read("test.urdf", &text).unwrap();
    assert_eq!(canonical(&again, options).unwrap().value, text, "the export of the export");
    text.trim_start_matches("<robot name=\"test\">\n").trim_end_matches("\n</robot>\n").to_owned()
}

fn check(body: &str, expected: &str) {
    assert_eq!(export(body, &Options::default()), expected);
}

/// A link between joints, whose frame moves, and a tool on it, whose frame stays.
const JOINT: &str = r#"<link name="base"/><link name="arm"/>
<joint name="j" type="continuous"><parent link="base"/><child link="arm"/><origin xyz="0 0 0.50"/><axis xyz="1 0 0"/></joint><link name="tool"/><joint name="f" type="fixed"><parent link="arm"/><child link="tool"/></joint>"#;

const JOINT_OUT: &str = r#"<link name="base"/><link name="arm"/>
<joint name="j" type="continuous"><parent link="base"/><child link="arm"/><origin xyz="0 0 0.50" rpy="1.5707963267948966 0 1.5707963267948966"/><axis xyz="0 0 1"/></joint><link name="tool"/><joint name="f" type="fixed"><origin xyz="0 0 0" rpy="-1.5707963267948966 -1.5707963267948966 0"/><parent link="arm"/><child link="tool"/></joint>"#;

#[test]
fn a_joint_gets_its_row_and_the_axis_z() {
    check(JOINT, JOINT_OUT);
}

#[test]
fn origin_and_axis_are_put_in_where_the_file_leaves_them_out() {
    check(
        r#"<link name="base"/><link name="arm"><visual><geometry><sphere radius="1"/></geometry></visual></link>
<joint name="j" type="prismatic">
  <parent link="base"/>
  <child link="arm"/>
</joint><link name="tool"/><joint name="f" type="fixed"><origin rpy="1.5707963267948966 0 1.5707963267948966"/><parent link="arm"/><child link="tool"/></joint>"#,
        r#"<link name="base"/><link name="arm"><visual><origin xyz="0 0 0" rpy="-1.5707963267948966 -1.5707963267948966 0"/><geometry><sphere radius="1"/></geometry></visual></link>
<joint name="j" type="prismatic">
  <origin xyz="0 0 0" rpy="1.5707963267948966 0 1.5707963267948966"/>
  <axis xyz="0 0 1"/>
  <parent link="base"/>
  <child link="arm"/>
</joint><link name="tool"/><joint name="f" type="fixed"><origin rpy="0 0 0"/><parent link="arm"/><child link="tool"/></joint>"#,
    );
}

/// Poses by kind of element, of `<gazebo>` sensors too, in the root's frame at zero.
fn gazebo_sensor(text: &str) -> Pose {
    let wrapped = format!("<robot name=\"test\">\n{text}\n</robot>\n");
    let robot = urdf::read("test.urdf", &wrapped).unwrap();
    let pose = text.split("<pose>").nth(1).map_or("0 0 0 0 0 0", |rest| rest.split("</pose>").next().unwrap());
    let n: Vec<f64> = pose.split_whitespace().map(|word| word.parse().unwrap()).collect();
    let local = se3::pose(se3::rotation_from_rpy([n[3], n[4], n[5]]), [n[0], n[1], n[2]].into());
    robot.joints[0].origin.pose() * local
}

#[test]
fn sensors_and_lights_in_gazebo_blocks_move_along() {
    for (block, poses) in [
        (
            "<gazebo reference=\"arm\"><sensor name=\"imu\" type=\"imu\"><pose>0.1 0.2 0.3 0 0 0.4</pose></sensor></gazebo>",
            1,
        ),
        ("<gazebo reference=\"arm\"><sensor name=\"imu\" type=\"imu\"><always_on>1</always_on></sensor></gazebo>", 1),
        ("<gazebo reference=\"arm\"><projector name=\"p\">\n  <pose>0 0 0 0 -1.5707 0</pose></projector></gazebo>", 1),
        ("<gazebo reference=\"arm\"><light name=\"l\"><pose/></light></gazebo>", 1),
        ("<gazebo reference=\"arm\"><visual><pose>1 0 0 0 0 0</pose></visual></gazebo>", 1),
        ("<gazebo reference=\"arm\"><visual><material>a</material></visual><mu1>0.2</mu1></gazebo>", 0),
    ] {
        let body = format!("{JOINT}\n{block}");
        let text = export(&body, &Options::default());
        assert_eq!(text.matches("<pose>").count(), poses, "{text}");
        let (turned, moved) = se3::difference(&gazebo_sensor(&body), &gazebo_sensor(&text));
        assert!(poses == 0 || turned < 1e-15 && moved < 1e-15, "{text}");
    }
}

#[test]
fn what_gazebo_gives_in_other_frames_stays() {
    for block in [
        "<gazebo reference=\"base\"><sensor><pose>1 0 0 0 0 0</pose></sensor></gazebo>",
        "<gazebo reference=\"arm\"><sensor><pose relative_to=\"base\">1 0 0 0 0 0</pose></sensor></gazebo>",
        "<gazebo><plugin><xyzOffset>1 0 0</xyzOffset></plugin></gazebo>",
    ] {
        check(&format!("{JOINT}\n{block}"), &format!("{JOINT_OUT}\n{block}"));
    }
    let camera = "<gazebo reference=\"arm\"><sensor><pose>0 0 0 0 0 0</pose><camera><pose>1 0 0 0 0 0</pose></camera></sensor></gazebo>";
    let text = export(&format!("{JOINT}\n{camera}"), &Options::default());
    assert!(text.contains("<camera><pose>1 0 0 0 0 0</pose></camera>"), "{text}");
}

#[test]
fn plugins_that_name_a_moved_link_are_noted() {
    let plugin = "<gazebo><plugin name=\"p\"><bodyName>arm</bodyName></plugin></gazebo>";
    let notes = canonical(&robot(&format!("{JOINT}\n{plugin}")), &Options::default()).unwrap().notes;
    let notes: Vec<String> = notes.iter().map(ToString::to_string).collect();
    assert_eq!(
        notes,
        ["test.urdf:4: <bodyName>: simulator settings name links whose frames move (1 in total, this one \"arm\"); \
             they now act at the new frames, ‹keep-link-frames› keeps the old frames"]
    );
}

#[test]
fn drake_frames_and_sensors_by_parent_move_along() {
    let text = export(
        &format!(
            "{JOINT}\n<frame name=\"f\" link=\"arm\" xyz=\"1 0 0\"/>\n<cable><terminator link=\"arm\" xyz=\"1 0 0\"/></cable>\n<sensor name=\"s\"><parent link=\"arm\"/><origin xyz=\"0 1 0\"/></sensor>"
        ),
        &Options::default(),
    );
    assert!(text.contains("<terminator link=\"arm\" xyz=\"0 0 1\"/>"), "{text}");
    assert!(
        text.contains(
            "<frame name=\"f\" link=\"arm\" xyz=\"0 0 1\" rpy=\"-1.5707963267948966 -1.5707963267948966 0\"/>"
        ),
        "{text}"
    );
    assert!(
        text.contains("<origin xyz=\"1 0 0\" rpy=\"-1.5707963267948966 -1.5707963267948966 0\"/></sensor>"),
        "{text}"
    );
}

#[test]
fn text_around_the_poses_stays_byte_for_byte() {
    let body = "<!-- a ü -->\r\n<link name='base' />\t<link name='arm'><inertial><mass  value = '1.0'/>\r\n\
         <origin rpy='0 0 0'  xyz='0.10 0 0'/><inertia ixx='1' ixy='0.1' ixz='0' iyy='2' iyz='0' izz='3'/></inertial></link>\r\n\
         <joint type=\"continuous\" name=\"j\"><axis xyz='1.0 0 0'/><parent link='base'/><child link='arm'/><limit effort=\"1e2\"/></joint>\r\n\
         <link name='tool'/><joint name='f' type='fixed'><origin rpy='1.5707963267948966 0 1.5707963267948966'/><parent link='arm'/><child link='tool'/></joint>";
    let expected = body
        .replace("rpy='0 0 0'  xyz='0.10 0 0'", "rpy='-1.5707963267948966 -1.5707963267948966 0'  xyz='0 0 0.1'")
        .replace("<axis xyz='1.0 0 0'/>", "<axis xyz='0 0 1'/>")
        .replace("rpy='1.5707963267948966 0 1.5707963267948966'/><parent", "rpy='0 0 0'/><parent")
        .replace("name=\"j\">", "name=\"j\"><origin xyz=\"0 0 0\" rpy=\"1.5707963267948966 0 1.5707963267948966\"/>");
    check(body, &expected);
    let marked = format!("\u{feff}<robot name=\"t\"><xacro:unbound/>{JOINT}</robot>");
    let text = canonical(&urdf::read("t", &marked).unwrap(), &Options::default()).unwrap().value;
    assert_eq!(text, format!("\u{feff}<robot name=\"t\"><xacro:unbound/>{JOINT_OUT}</robot>"));
}

const HAND: &str = r#"<link name="base"/><link name="palm"/><link name="one"/><link name="two"/><link name="camera"/>
<joint name="a" type="revolute"><parent link="base"/><child link="palm"/><origin xyz="0 0 0.3"/><axis xyz="0 1 0"/><limit lower="-1" upper="2" effort="1" velocity="1"/></joint>
<joint name="b" type="revolute"><parent link="palm"/><child link="one"/><origin xyz="0.1 0 0"/><axis xyz="0 -1 0"/><limit lower="-1" upper="2" effort="1" velocity="1"/><mimic joint="a" multiplier="-0.50" offset="0.1"/></joint>
<joint name="c" type="revolute"><parent link="palm"/><child link="two"/><origin xyz="0 0.1 0" rpy="1.57 0 0"/><axis xyz="0 0 1"/><limit lower="-1" upper="2" effort="1" velocity="1"/></joint>
<joint name="d" type="fixed"><parent link="palm"/><child link="camera"/><origin xyz="0 0 0.1"/></joint>"#;

#[test]
fn mimics_and_limits_stay_for_no_zero_and_no_sense_moves() {
    let text = export(HAND, &Options::default());
    assert!(text.contains(r#"<mimic joint="a" multiplier="-0.50" offset="0.1"/>"#));
    assert_eq!(text.matches(r#"<limit lower="-1" upper="2" effort="1" velocity="1"/>"#).count(), 3);
    let (before, after) = (robot(HAND), urdf::read("t", &format!("<robot name=\"t\">{text}</robot>")).unwrap());
    for tip in ["one", "two", "camera"] {
        let chain = |robot: &Robot| robot.chain(Some("base"), Some(tip), Reading::Intended).unwrap().value;
        let (one, other) = (chain(&before), chain(&after));
        // The frames of moving links differ, by the same motion at every q.
        let q = vec![0.7; one.coordinates().len()];
        let zero = vec![0.0; one.coordinates().len()];
        let offset = |q: &[f64]| one.fk(q).inverse() * other.fk(q);
        let (turned, moved) = se3::difference(&offset(&q), &offset(&zero));
        assert!(turned < 1e-15 && moved < 1e-15, "{tip}");
    }
}

/// base_from_link at zero.
fn at_zero(text: &str, link: &str) -> Pose {
    let robot = robot(text);
    let base = robot.links[robot.root].name.clone();
    let chain = robot.chain(Some(&base), Some(link), Reading::Intended).unwrap().value;
    chain.fk(&vec![0.0; chain.coordinates().len()])
}

#[test]
fn tips_and_links_on_fixed_joints_keep_their_frames() {
    let arm = r#"<link name="world"/><link name="mount"/><link name="one"/><link name="plate"/><link name="two"/><link name="finger"/>
<joint name="m" type="fixed"><parent link="world"/><child link="mount"/><origin xyz="0.1 0.2 0.3" rpy="0.4 0.5 0.6"/></joint>
<joint name="a" type="revolute"><parent link="mount"/><child link="one"/><origin xyz="0 0 0.3" rpy="0.1 0 0"/><axis xyz="0 1 0"/><limit lower="-1" upper="2"/></joint>
<joint name="p" type="fixed"><parent link="one"/><child link="plate"/><origin xyz="0.05 0 0.02" rpy="0 0.7 0"/></joint>
<joint name="b" type="revolute"><parent link="plate"/><child link="two"/><origin xyz="0.3 0.1 0"/><axis xyz="0.3 -1 0"/><limit lower="-1" upper="2"/></joint>
<joint name="c" type="prismatic"><parent link="two"/><child link="finger"/><origin xyz="0.1 0 0" rpy="0 0.2 0"/><axis xyz="1 0.5 0"/><limit lower="0" upper="1"/></joint>"#;
    for frames in [Frames::Distal, Frames::Proximal] {
        let text = export(arm, &Options { frames, ..Options::default() });
        assert_ne!(text, arm);
        let mut moved_links = Vec::new();
        for link in ["mount", "one", "plate", "two", "finger"] {
            let (turned, moved) = se3::difference(&at_zero(arm, link), &at_zero(&text, link));
            if turned > 1e-15 || moved > 1e-15 {
                moved_links.push(link);
            }
        }
        assert_eq!(moved_links, ["one", "two"], "{text}");
        // The finger's axis is given in the frame that stays.
        assert!(text.contains(r#"<axis xyz="1 0.5 0"/>"#), "{text}");
        assert_eq!(text.matches(r#"<axis xyz="0 0 1"/>"#).count(), 2, "{text}");
    }
    // A base that is named keeps its frame, too, and the table starts there.
    let options = Options { base: Some("one".into()), ..Options::default() };
    let text = export(arm, &options);
    let (turned, moved) = se3::difference(&at_zero(arm, "one"), &at_zero(&text, "one"));
    assert!(turned < 1e-15 && moved < 1e-15, "{text}");
}

#[test]
fn axes_that_are_nearly_parallel_are_exported() {
    for tilt in [1e-15, 1e-13, 1e-12, 3e-12, 1e-11, 1e-10, 1e-9, 1e-7, 1e-5] {
        let arm = format!(
            r#"<link name="base"/><link name="one"><inertial><origin xyz="0.1 0.2 0.3"/><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<link name="two"><inertial><origin xyz="0.1 0.2 0.3"/><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link><link name="tip"/>
<joint name="a" type="revolute"><parent link="base"/><child link="one"/><origin xyz="-0.0154 0.0018 -0.0979" rpy="2e-14 -0.0873 3.1154"/><axis xyz="-1 -2.5e-13 {tilt}"/><limit lower="-1" upper="2"/></joint>
<joint name="b" type="revolute"><parent link="one"/><child link="two"/><origin xyz="-1.5e-11 -0.0015 -0.04" rpy="-6e-16 {tilt} 2.5e-13"/><axis xyz="-1 2.5e-13 -{tilt}"/><limit lower="-1" upper="2"/></joint>
<joint name="f" type="fixed"><parent link="two"/><child link="tip"/><origin xyz="0.1 0 0" rpy="0 0.2 0"/></joint>"#
        );
        for reading in [Reading::AsWritten, Reading::Intended] {
            let text = export(&arm, &Options { reading, ..Options::default() });
            let (turned, moved) = se3::difference(&at_zero(&arm, "tip"), &at_zero(&text, "tip"));
            assert!(turned < 1e-11 && moved < 1e-11, "{tilt}: {turned} {moved}");
        }
    }
    let file = crate::urdf_corpus::workspace().join("../shared/wild/export-refused-nearly-parallel/five_joints.urdf");
    let Ok(text) = std::fs::read_to_string(&file) else {
        println!("skipped, because {} is missing", file.display());
        return;
    };
    for reading in [Reading::AsWritten, Reading::Intended] {
        let options = Options { reading, ..Options::default() };
        canonical(&urdf::read("five_joints.urdf", &text).unwrap(), &options).unwrap();
    }
}

#[test]
fn poses_move_along_in_their_own_notation() {
    let sensor = |pose: &str| format!("{JOINT}\n<gazebo reference=\"arm\"><sensor name=\"s\">{pose}</sensor></gazebo>");
    let out = |pose: &str| {
        export(&sensor(pose), &Options::default()).rsplit("<sensor name=\"s\">").next().unwrap().to_owned()
    };
    assert!(
        out("<pose>0.1 0 0 0 0 0</pose>").starts_with("<pose>0 0 0.1 -1.5707963267948966 -1.5707963267948966 0</pose>")
    );
    let degrees = out("<pose degrees=\"true\">0.1 0 0 0 0 0</pose>");
    assert!(degrees.starts_with("<pose degrees=\"true\">0 0 0.1 -90 -90 0</pose>"), "{degrees}");
    let quaternion = out("<pose rotation_format=\"quat_xyzw\">0.1 0 0 0 0 0 1</pose>");
    assert!(quaternion.starts_with("<pose rotation_format=\"quat_xyzw\">0 0 0.1 "), "{quaternion}");
    let numbers = quaternion.split(['>', '<']).nth(2).unwrap().split_whitespace().skip(3);
    let numbers: Vec<f64> = numbers.map(|word| word.parse().unwrap()).collect();
    assert!(numbers.iter().all(|number| (number.abs() - 0.5).abs() < 1e-15), "{numbers:?}");
    for stays in ["<pose relative_to=\"tool\">1 0 0 0 0 0</pose>", "<pose frame=\"world\">1 0 0 0 0 0</pose>"] {
        assert!(out(stays).starts_with(stays), "{}", out(stays));
    }
    let moves = out("<pose relative_to=\"arm\">0.1 0 0 0 0 0</pose>");
    assert!(moves.starts_with("<pose relative_to=\"arm\">0 0 0.1 "), "{moves}");
    // Of a joint that SDF adds, the pose is given in the child link.
    let text = export(
        &format!(
            "{JOINT}\n<gazebo><joint name=\"k\" type=\"ball\"><parent>base</parent><child>arm</child><pose>0.1 0 0 0 0 0</pose></joint></gazebo>"
        ),
        &Options::default(),
    );
    assert!(text.contains("<child>arm</child><pose>0 0 0.1 "), "{text}");
    let five = canonical(&robot(&sensor("<pose>0.1 0 0 0 0</pose>")), &Options::default()).unwrap_err().to_string();
    assert!(five.starts_with("test.urdf:4: ") && five.contains("its <pose> is not a valid pose"), "{five}");
}

#[test]
fn what_table_refuses_is_refused_in_the_same_words() {
    let looped = HAND.replace("<axis xyz=\"0 1 0\"/>", "<axis xyz=\"0 1 0\"/><mimic joint=\"b\"/>");
    let robot = robot(&looped);
    let table = robot.chain(None, None, Reading::Intended).unwrap_err().to_string();
    for link_frames in [LinkFrames::Replace, LinkFrames::Keep, LinkFrames::MarkOnly] {
        let options = Options { link_frames, ..Options::default() };
        assert_eq!(canonical(&robot, &options).unwrap_err().to_string(), table);
    }
}

#[test]
fn markers_move_nothing_and_are_put_in_once() {
    for frames in [Frames::Distal, Frames::Proximal] {
        let options = Options { link_frames: LinkFrames::MarkOnly, frames, ..Options::default() };
        let text = export(HAND, &options);
        assert!(text.starts_with(HAND), "{text}");
        assert_eq!(text.matches("<link name=\"dh_").count(), 3, "{text}");
        let marked = urdf::read("t", &format!("<robot name=\"t\">{text}</robot>")).unwrap();
        let base = robot(HAND).default_chain().base;
        let pose = |link: &str| marked.chain(Some(&base), Some(link), Reading::Intended).unwrap().value;
        // dh_k moves with joint k, and its z axis is that of the next joint (distal) or of its own (proximal).
        for k in 0..3 {
            assert_eq!(pose(&format!("dh_{k}")).joints().len(), k);
        }
    }
    let taken = HAND.replace("\"camera\"", "\"dh_0\"");
    let options = Options { link_frames: LinkFrames::MarkOnly, ..Options::default() };
    let taken = format!(
        "{taken}<link name=\"x\"/><joint name=\"y\" type=\"fixed\"><parent link=\"dh_0\"/><child link=\"x\"/></joint>"
    );
    let message = canonical(&robot(&taken), &options).unwrap_err().to_string();
    assert_eq!(message, "test.urdf:2: link \"dh_0\": the export needs this name for a frame; rename this element");
}

#[test]
fn a_turn_and_its_slide_share_one_frame() {
    let spline = r#"<link name="base"/><link name="a"/><link name="b"/><link name="tip"/>
<joint name="turn" type="revolute"><origin xyz="1 0 0"/><axis xyz="0 1 0"/><parent link="base"/><child link="a"/><limit lower="-2" upper="2" effort="1" velocity="1"/></joint>
<joint name="slide" type="prismatic"><axis xyz="0 -1 0"/><parent link="a"/><child link="b"/><limit lower="-2" upper="2" effort="1" velocity="1"/><mimic joint="turn" multiplier="0.25"/></joint>
<joint name="flange" type="fixed"><origin xyz="0 0 0.1"/><parent link="b"/><child link="tip"/></joint>"#;
    let text = export(spline, &Options::default());
    let (before, after) = (robot(spline), urdf::read("t", &format!("<robot name=\"t\">{text}</robot>")).unwrap());
    let chain = |robot: &Robot| robot.chain(None, None, Reading::Intended).unwrap().value;
    assert_eq!(chain(&after).joints()[0].screw.pitch(), Some(-0.25));
    let slide = &after.joints[after.joint_index("slide").unwrap()];
    assert_eq!((slide.origin.xyz, slide.origin.rpy), ([0.0; 3], [std::f64::consts::PI, 0.0, 0.0]));
    let (turned, moved) = se3::difference(&chain(&before).fk(&[0.8]), &chain(&after).fk(&[0.8]));
    assert!(turned < 1e-15 && moved < 1e-15, "{turned} {moved}");
}

#[test]
fn shortened_angles_are_corrected_with_a_note_or_kept() {
    let exported = canonical(&robot(HAND), &Options::default()).unwrap();
    assert!(exported.notes[0].to_string().starts_with("test.urdf:5: joint \"c\": 1.57 read as π/2; the tip turns by"));
    assert!(!exported.value.contains("1.57 "));
    let options = Options { reading: Reading::AsWritten, ..Options::default() };
    let kept = canonical(&robot(HAND), &options).unwrap();
    assert!(kept.value.contains("rpy=\"3.140796326794897 0 0\""), "{}", kept.value);
    assert!(kept.notes.is_empty());
}

#[test]
fn a_name_that_is_taken_is_refused() {
    let body = format!(
        "{JOINT}<link name=\"arm_dh\"/><joint name=\"k\" type=\"fixed\"><parent link=\"arm\"/><child link=\"arm_dh\"/></joint>"
    );
    let options = Options { link_frames: LinkFrames::Keep, ..Options::default() };
    let message = canonical(&robot(&body), &options).unwrap_err().to_string();
    assert_eq!(message, "test.urdf:3: link \"arm_dh\": the export needs this name for a frame; rename this element");
    let options = Options { tip: Some("tool9".into()), ..Options::default() };
    let message = canonical(&robot(JOINT), &options).unwrap_err().to_string();
    assert_eq!(message, "test.urdf: the robot has no link \"tool9\"; did you mean \"tool\"?");
}

#[test]
fn an_entity_that_stands_for_two_elements_is_refused() {
    let arm = JOINT.replace("<link name=\"arm\"/>", "<link name=\"arm\">&ball;</link>");
    let text = |base: &str| {
        format!(
            "<!DOCTYPE robot [<!ENTITY ball '<visual><origin xyz=\"1 0 0\"/><geometry><sphere radius=\"1\"/></geometry>\
             </visual>'>]>\n<robot name=\"t\">{}</robot>",
            arm.replace("<link name=\"base\"/>", base)
        )
    };
    let twice = urdf::read("t.urdf", &text("<link name=\"base\">&ball;</link>")).unwrap();
    let error = canonical(&twice, &Options::default()).unwrap_err().to_string();
    assert_eq!(
        error,
        "t.urdf: the visual of link \"base\" would move; expand XML entities and give each link one <inertial>, then \
         export again"
    );
}

#[test]
fn odd_files_are_exported_or_refused_with_a_reason() {
    let folder = crate::urdf_corpus::workspace().join("../shared/vendor/quirky");
    let Ok(entries) = std::fs::read_dir(&folder) else {
        println!("skipped, because {} is missing", folder.display());
        return;
    };
    let (mut exported, mut refused) = (0, 0);
    for path in entries.flatten().map(|entry| entry.path()).filter(|path| path.extension().is_some_and(|e| e == "urdf"))
    {
        let file = path.file_name().unwrap().to_string_lossy().into_owned();
        let Ok(text) = std::fs::read_to_string(&path) else { continue };
        for link_frames in [LinkFrames::Replace, LinkFrames::Keep, LinkFrames::MarkOnly] {
            let options = Options { link_frames, ..Options::default() };
            let made = urdf::read(&file, &text).map_err(|error| error.to_string()).and_then(|robot| {
                canonical(&robot, &options).map(|made| made.value).map_err(|error| error.to_string())
            });
            match made {
                Ok(made) => {
                    exported += 1;
                    let again = canonical(&urdf::read(&file, &made).unwrap(), &options).unwrap().value;
                    assert_eq!(again, made, "{file}");
                }
                Err(reason) => {
                    refused += 1;
                    assert!(reason.starts_with(&file), "{file}: {reason}");
                }
            }
        }
    }
    println!("{exported} exports of odd files, {refused} refusals");
    assert!(exported > 0 && refused > 0);
}
