//! Links merged, robots put together and taken apart, mirrored and scaled.

use crate::support::{edit, words_of};
use denavit_edit::{Files, Operation, Text, Words, apply};
use denavit_model::nalgebra::Vector3;
use denavit_model::{PlacedRobot, Reading, urdf};

const ARM: &str = r#"<robot name="arm">
  <material name="grey"><color rgba="0.5 0.5 0.5 1"/></material>
  <link name="left_base">
    <inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>
  </link>
  <!-- a plate -->
  <link name="left_plate">
    <inertial><origin xyz="0 0 0.5"/><mass value="3"/><inertia ixx="1" ixy="0.25" ixz="0.125" iyy="2" iyz="0.5" izz="3"/></inertial>
    <visual><origin xyz="0 0.5 0" rpy="0.25 0 0.5"/><geometry><mesh filename="package://arm/plate.stl"/></geometry><material name="grey"/></visual>
    <collision><geometry><cylinder radius="0.125" length="1"/></geometry></collision>
  </link>
  <link name="left_tip"/>
  <link name="left_camera"/>
  <joint name="left_bolt" type="fixed">
    <parent link="left_base"/> <child link="left_plate"/> <origin xyz="1 0.25 0" rpy="0 0 1.5707963267948966"/>
  </joint>
  <joint name="left_turn" type="revolute">
    <parent link="left_plate"/> <child link="left_tip"/> <origin xyz="0 0 1"/> <axis xyz="0 0 1"/>
    <limit lower="-1" upper="2" effort="1" velocity="1"/>
  </joint>
  <joint name="left_mount" type="fixed"> <parent link="left_tip"/> <child link="left_camera"/> <origin xyz="0.5 0 0"/> </joint>
  <gazebo reference="left_plate"><sensor name="s" type="imu"><pose>0 0 0.25 0 0 0</pose></sensor></gazebo>
  <gazebo><plugin name="p" filename="p.so"><frameName>left_camera</frameName></plugin></gazebo>
</robot>
"#;

const GRIPPER: &str = r#"<robot name="gripper">
  <material name="grey"><color rgba="0 0 0 1"/></material>
  <link name="palm"><visual><geometry><box size="1 1 1"/></geometry><material name="grey"/></visual></link>
  <link name="finger"/>
  <joint name="slide" type="prismatic">
    <parent link="palm"/> <child link="finger"/> <axis xyz="0 1 0"/> <limit lower="0" upper="0.1" effort="1" velocity="1"/>
  </joint>
</robot>
"#;

fn attach(prefix: &str) -> Result<String, String> {
    let mut words = words_of("attach gripper.urdf --at left_camera --pose 0,0,100mm,0,0,90deg");
    words.other = Some(Text { file: "gripper.urdf".into(), text: GRIPPER.into() });
    words.prefix = Some(prefix.into());
    let operation = Operation::of(&words).map_err(|error| error.to_string())?;
    let done = apply(&Files::urdf("arm.urdf", ARM), &[operation]).map_err(|error| error.to_string())?;
    Ok(done.files.urdf.text)
}

#[test]
fn merged_links_add_up_and_what_is_named_stays() {
    let done = edit(ARM, "merge").unwrap();
    let text = &done.files.urdf.text;
    let robot = urdf::read("merged.urdf", text).unwrap();
    let names: Vec<&str> = robot.links.iter().map(|link| link.name.as_str()).collect();
    assert_eq!(names, ["left_base", "left_tip", "left_camera"]);
    let base = robot.links[0].inertial.as_ref().unwrap();
    assert_eq!(base.mass, 4.0);
    // Three quarters of the way to (1, 0.25, 0.5).
    assert_eq!(base.origin.xyz, [0.75, 0.1875, 0.375]);
    // 1 + 1.. along the merged axes: of the plate turned by a quarter, iyy counts along x.
    let arms = |square: f64| 1.0 * 3.0 / 4.0 * square;
    assert!((base.tensor[(0, 0)] - (1.0 + 2.0 + arms(0.25f64.powi(2) + 0.5f64.powi(2)))).abs() < 1e-12);
    assert!(text.contains(
        r#"<gazebo reference="left_base"><sensor name="s" type="imu"><pose>1 0.25 0.25 0 0 1.5707963267948966</pose>"#
    ));
    assert!(text.contains("<!-- a plate -->"));
    assert!(
        done.reports[0].notes[0].contains("left_camera\" is kept as a frame: <frameName>"),
        "{:?}",
        done.reports[0].notes
    );
    assert_eq!(
        edit(ARM, "merge left_turn").unwrap_err().to_string(),
        "robot.urdf:17: joint \"left_turn\": only a fixed joint can be merged; this one moves"
    );
    let kept = edit(ARM, "merge left_bolt --keep left_plate").unwrap().files.urdf.text;
    let kept = urdf::read("kept.urdf", &kept).unwrap();
    let plate = &kept.links[kept.link_index("left_plate").unwrap()];
    assert!(plate.inertial.is_none() && plate.visuals.is_empty() && kept.links[0].visuals.len() == 1);
}

#[test]
fn attached_then_extracted_is_the_gripper_and_cut_is_the_arm() {
    assert_eq!(
        attach("").unwrap_err(),
        "gripper.urdf:2: material \"grey\": the robot that it is attached to has a different material with this name; \
         give a prefix"
    );
    let both = attach("g_").unwrap();
    let robot = urdf::read("both.urdf", &both).unwrap();
    let placed = PlacedRobot::new(&robot, Reading::AsWritten);
    let at = placed.pose(robot.link_index("left_camera").unwrap());
    let palm = at.inverse() * placed.pose(robot.link_index("g_palm").unwrap());
    assert!((palm.translation.vector - Vector3::new(0.0, 0.0, 0.1)).norm() < 1e-15);
    assert!(both.contains(r#"<material name="g_grey"><color rgba="0 0 0 1"/></material>"#));
    let gripper = edit(&both, "extract g_palm;rename g_palm=palm g_finger=finger g_slide=slide").unwrap();
    let gripper = urdf::read("gripper.urdf", &gripper.files.urdf.text).unwrap();
    assert_eq!(gripper.links[gripper.root].name, "palm");
    assert_eq!((gripper.links.len(), gripper.joints.len()), (2, 1));
    let arm = edit(&both, "cut g_palm").unwrap().files.urdf.text;
    assert_eq!(arm.replace("\n  <material name=\"g_grey\"><color rgba=\"0 0 0 1\"/></material>", ""), ARM);
    let clash = edit(&both, "cut left_base").unwrap_err().to_string();
    assert!(clash.ends_with("link \"left_base\": it is the root, so nothing would remain"), "{clash}");
}

#[test]
fn the_mirror_image_of_the_mirror_image_is_the_file() {
    let done = edit(ARM, "mirror xz --names left=right").unwrap();
    let text = &done.files.urdf.text;
    for expected in [
        r#"<origin xyz="1 -0.25 0" rpy="0 0 -1.5707963267948966"/>"#,
        r#"<axis xyz="0 0 -1"/>"#,
        r#"ixy="-0.25" ixz="0.125" iyy="2" iyz="-0.5""#,
        r#"<mesh filename="package://arm/plate.stl" scale="1 -1 1"/>"#,
        r#"<origin xyz="0 -0.5 0" rpy="-0.25 0 -0.5"/>"#,
        r#"<limit lower="-1" upper="2""#,
        "<frameName>right_camera</frameName>",
    ] {
        assert!(text.contains(expected), "{expected} is missing in\n{text}");
    }
    assert_eq!(edit(text, "mirror y --names right=left").unwrap().files.urdf.text, ARM);
}

#[test]
fn lengths_scale_and_frames_move_alone() {
    let text = edit(ARM, "scale 0.5").unwrap().files.urdf.text;
    assert!(text.contains(r#"<origin xyz="0.5 0.125 0" rpy="0 0 1.5707963267948966"/>"#), "{text}");
    assert!(text.contains(r#"scale="0.5 0.5 0.5""#) && text.contains(r#"<cylinder radius="0.0625" length="0.5"/>"#));
    assert!(text.contains("<pose>0 0 0.125 0 0 0</pose>") && text.contains(r#"ixy="0.0625""#));
    let moved = edit(ARM, "origin left_tip --to 0,0,0.25,0,0,90deg;origin left_tip --to 0,0,-0.25,0,0,-90deg").unwrap();
    let (before, after) = (urdf::read("a", ARM).unwrap(), urdf::read("b", &moved.files.urdf.text).unwrap());
    assert_eq!(before.joints[1].origin.xyz, after.joints[1].origin.xyz);
    let off = edit(ARM, "origin left_tip --to 0.1,0,0").unwrap_err().to_string();
    assert!(off.contains("the link's frame on this joint's axis; give a position on the axis"), "{off}");
}

#[test]
fn round_values_are_written_and_calibrated_ones_stay() {
    let text =
        ARM.replace("1.5707963267948966", "1.5708").replace("xyz=\"0.5 0 0\"", "xyz=\"0.5 0 0\" rpy=\"0.7853123 0 0\"");
    let done = edit(&text, "snap").unwrap();
    assert!(done.files.urdf.text.contains("1.5707963267948966") && done.files.urdf.text.contains("0.7853123"));
    assert_eq!(done.reports[0].changes, ["1 number replaced"]);
    assert!(done.reports[0].notes[0].contains("1.5708 is 1.5707963267948966; this moves no tip by more than"));
}

#[test]
fn frames_go_to_the_mass_or_beside_it_on_the_axis() {
    let text = ARM.replace(
        "<link name=\"left_tip\"/>",
        "<link name=\"left_tip\"><inertial><origin xyz=\"0.25 0 0.5\"/><mass value=\"1\"/><inertia ixx=\"1\" ixy=\"0\" ixz=\"0\" iyy=\"1\" \
         iyz=\"0\" izz=\"1\"/></inertial></link>",
    );
    let done = edit(&text, "recentre").unwrap();
    let robot = urdf::read("recentred.urdf", &done.files.urdf.text).unwrap();
    let centre = |name: &str| robot.links[robot.link_index(name).unwrap()].inertial.as_ref().unwrap().origin.xyz;
    // The plate is fixed; the tip turns about z.
    assert_eq!((centre("left_plate"), centre("left_tip")), ([0.0; 3], [0.25, 0.0, 0.0]));
    assert_eq!(robot.joints[1].origin.xyz, [0.0, 0.0, 1.0]);
    assert!(done.files.urdf.text.contains(r#"<origin xyz="0.5 0 -0.5"/>"#), "{}", done.files.urdf.text);
    assert_eq!(done.reports[0].changes, ["2 link frames moved to the mass"]);
    let refused = edit(&text, "recentre left_camera").unwrap_err().to_string();
    assert!(refused.ends_with("it has no mass, so it has no centre of mass"), "{refused}");
}

/// The corners come back to the mesh with the rounding of their place, which is large beside the mesh.
#[test]
fn the_hull_of_a_small_mesh_far_from_its_link_holds_it() {
    let text = r#"<robot name="r"> <link name="base"> <collision> <origin xyz="0.3 1.404 -0.235" rpy="0.3 0.2 0.1"/>
      <geometry> <mesh filename="a.stl" scale="0.0001 0.0001 0.0001"/> </geometry> </collision> </link> </robot>"#;
    let corners: Vec<Vector3<f64>> = (0..20u32)
        .map(|k| {
            let (sine, cosine) = (f64::from(k) * 2.4).sin_cos();
            let height = f64::from(k) / 10.0 - 0.95;
            let width = (1.0 - height * height).sqrt();
            Vector3::new(width * cosine, width * sine, height)
        })
        .collect();
    let triangles = corners.windows(3).map(|of| [of[0], of[1], of[2]]).collect();
    let words = Words {
        meshes: [("a.stl".to_owned(), Ok(triangles))].into(),
        folder: Some("hulls/".into()),
        to: Some("hulls".into()),
        ..words_of("simplify-collision hull")
    };
    let done = apply(&Files::urdf("robot.urdf", text), &[Operation::of(&words).unwrap()]).unwrap();
    assert!(done.files.urdf.text.contains("hulls/a_hull.obj"));
    assert_eq!(done.meshes[0].text.lines().filter(|line| line.starts_with("v ")).count(), 20);
}

#[test]
fn canonical_frames_are_those_of_the_export() {
    let done = edit(ARM, "canonical").unwrap();
    let robot = urdf::read("arm.urdf", ARM).unwrap();
    let options = denavit_export::urdf::Options { reading: Reading::AsWritten, ..Default::default() };
    assert_eq!(done.files.urdf.text, denavit_export::urdf::canonical(&robot, &options).unwrap().value);
    let robot = urdf::read("canonical.urdf", &edit(FOLDED, "canonical").unwrap().files.urdf.text).unwrap();
    // z along both axes, x along their common normal.
    assert_eq!(robot.joints[0].axis.into_inner(), Vector3::z());
    assert_eq!(
        edit(FOLDED, "canonical;canonical").unwrap().files.urdf.text,
        edit(FOLDED, "canonical").unwrap().files.urdf.text
    );
}

const FOLDED: &str = r#"<robot name="folded"> <link name="base"/> <link name="arm"/> <link name="hand"/> <link name="tip"/>
  <joint name="one" type="continuous"> <parent link="base"/> <child link="arm"/> <axis xyz="0 1 0"/> </joint>
  <joint name="two" type="continuous"> <parent link="arm"/> <child link="hand"/> <origin xyz="1 0 0"/> <axis xyz="1 0 0"/> </joint>
  <joint name="end" type="fixed"> <parent link="hand"/> <child link="tip"/> <origin xyz="0 0 1"/> </joint>
</robot>
"#;

#[test]
fn a_tip_s_frame_moves_and_comes_back() {
    let moved = edit(ARM, "origin left_camera --to 0,0,0.125,0,0,90deg").unwrap().files.urdf.text;
    assert!(moved.contains(r#"<origin xyz="0.5 0 0.125" rpy="0 0 1.5707963267948966"/>"#), "{moved}");
    let back = edit(&moved, "origin left_camera --to 0,0,-0.125,0,0,-90deg").unwrap().files.urdf.text;
    let (before, after) = (urdf::read("a", ARM).unwrap(), urdf::read("b", &back).unwrap());
    assert_eq!(before.joints[2].origin.xyz, after.joints[2].origin.xyz);
}
