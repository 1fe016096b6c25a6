//! Edits are written as a whole with their report, or not at all with the reason.

use super::Trial;

#[test]
fn edits_are_chained_and_reported() {
    let trial = Trial::new();
    let said = trial.run("edit arm.urdf flip elbow_joint --then zero elbow_joint=90deg -o out.urdf").succeeded();
    assert_eq!(
        said,
        "flip elbow_joint: moves as before within 1e-15 m and 1e-15 rad; elbow_joint reversed; 1 limit exchanged\n\
         zero elbow_joint=90deg: moves as before within 1e-15 m and 1e-15 rad; elbow_joint reads 0 where it read \
         1.5707963267948966; 1 limit shifted\n"
    );
    assert!(trial.text("out.urdf").contains(r#"<axis xyz="0 0 -1"/>"#));
    assert_eq!(trial.run("diff arm.urdf out.urdf --up-to-zeros").code, 0);
    let diff = trial.run("edit arm.urdf prefix left_ --dry-run").succeeded();
    assert!(diff.starts_with("--- ") && diff.contains("\n+  <link name=\"left_base\">"), "{diff}");
}

#[test]
fn what_cannot_be_edited_says_why_and_writes_nothing() {
    let xacro = r#"<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:property name="l" value="1"/>
        <link name="a"/><link name="b"/><joint name="j" type="continuous"><parent link="a"/><child link="b"/>
        <origin xyz="${l} 0 0"/></joint></robot>"#;
    let trial = Trial::new().with("bent.xacro", xacro);
    trial.refuses("edit bent.xacro flip j -o out.urdf", "this is xacro: one line may make several joints");
    trial.refuses("edit arm.urdf flip elbow -o out.urdf", "the robot has no joint \"elbow\"");
    trial.refuses("edit arm.urdf turn elbow_joint -o out.urdf", "\"turn\" is not an operation");
    trial.refuses("edit arm.urdf flip elbow_joint --keep tool0 -o out.urdf", "flip takes no --keep; write flip JOINT");
    assert!(!trial.path("out.urdf").exists());
    trial.run("edit bent.xacro flip j --expand -o out.urdf").succeeded();
    assert!(trial.text("out.urdf").contains(r#"<axis xyz="-1 0 0"/>"#));
}

#[test]
fn a_makers_figures_go_into_the_joint_origins() {
    let trial = Trial::new().with_robot("drawn.csv", "universal_robots/ur5e_dh.csv");
    let table = trial.text("drawn.csv");
    let actual = table.replace("0.1625", "0.1627");
    assert_ne!(actual, table);
    let trial = trial.with("actual.csv", &actual);
    trial.refuses("edit arm.urdf set-calibration actual.csv -o out.urdf", "--nominal FILE names the maker's table");
    let said = trial.run("edit arm.urdf set-calibration actual.csv --nominal drawn.csv -o out.urdf").succeeded();
    assert!(said.starts_with("set-calibration actual.csv: moves as intended, within "), "{said}");
    assert!(said.contains("e-4 m and"), "{said}");
    assert!(trial.text("out.urdf").contains("0 0 0.1627"));
}

/// A tetrahedron in mm, as an OBJ file with a material that names a picture.
const TETRAHEDRON: &str =
    "mtllib paint.mtl\nv 0 0 0\nv 100 0 0\nv 0 200 0\nv 0 0 300\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";

const SHAPED: &str = r#"<robot name="arm"> <link name="base">
    <visual><geometry><mesh filename="package://arm_description/meshes/a.obj" scale="0.001 0.001 0.001"/></geometry></visual>
    <collision><origin xyz="0 0 1"/><geometry><mesh filename="package://arm_description/meshes/a.obj" scale="0.001 0.001 0.001"/></geometry></collision>
    <collision><geometry><sphere radius="0.1"/></geometry></collision>
  </link> </robot>"#;

fn shaped() -> Trial {
    let trial = Trial::new().with("shaped.urdf", SHAPED);
    let folder = trial.path("arm_description/meshes");
    std::fs::create_dir_all(&folder).unwrap();
    std::fs::create_dir_all(trial.path("new_description")).unwrap();
    std::fs::write(folder.join("a.obj"), TETRAHEDRON).unwrap();
    std::fs::write(folder.join("paint.mtl"), "newmtl p\nmap_Kd ../paint.png\n").unwrap();
    std::fs::write(trial.path("arm_description/paint.png"), "a picture").unwrap();
    trial
        .with("arm_description/package.xml", "<package><name>arm_description</name></package>")
        .with("new_description/package.xml", "<package><name>new_description</name></package>")
}

#[test]
fn meshes_are_copied_with_what_they_name_and_their_paths_follow() {
    let trial = shaped();
    trial.refuses("edit shaped.urdf meshes --package-path . -o out.urdf", "meshes: write meshes --to FOLDER");
    trial.run("edit shaped.urdf meshes --package-path . --to new_description/meshes -o out.urdf").succeeded();
    let text = trial.text("out.urdf");
    let path = "package://new_description/meshes/arm_description/meshes/a.obj";
    assert_eq!(text.matches(path).count(), 2, "{text}");
    assert_eq!(text.replace(path, "package://arm_description/meshes/a.obj"), SHAPED);
    for (copy, content) in [
        ("meshes/a.obj", TETRAHEDRON),
        ("meshes/paint.mtl", "newmtl p\nmap_Kd ../paint.png\n"),
        ("paint.png", "a picture"),
    ] {
        assert_eq!(trial.text(&format!("new_description/meshes/arm_description/{copy}")), content);
    }
    // Beside no package the way is that from the robot's file.
    trial.run("edit shaped.urdf meshes --package-path . --to copies -o new_description/out.urdf").succeeded();
    assert!(trial.text("new_description/out.urdf").contains(r#"filename="../copies/arm_description/meshes/a.obj""#));
    std::fs::remove_file(trial.path("arm_description/meshes/a.obj")).unwrap();
    trial.refuses("edit shaped.urdf meshes --package-path . --to others -o other.urdf", "there is no file");
}

#[test]
fn shapes_around_a_mesh_hold_it_and_say_what_they_add() {
    let trial = shaped();
    let run = trial.run("edit shaped.urdf simplify-collision box --package-path . -o box.urdf --json box.json");
    assert_eq!(run.code, 0, "{}", run.stderr);
    assert!(run.stdout.contains("all 12 triangle vertices are inside"), "{}", run.stdout);
    // A tetrahedron has a sixth of its box.
    assert!(run.stderr.contains("500 % of the mesh's volume"), "{}", run.stderr);
    let text = trial.text("box.urdf");
    assert!(text.contains(r#"<origin xyz="0.05 0.1 1.15"/><geometry><box size="0.100"#), "{text}");
    assert!(text.contains("<sphere radius=\"0.1\"/>") && text.matches("a.obj").count() == 1, "{text}");
    assert!(trial.text("box.json").contains("\"schema\": \"denavit.edit/1\""));
    trial.refuses(
        "edit shaped.urdf simplify-collision hull --package-path . -o hull.urdf",
        "a hull needs its own file; name a folder for it",
    );
    trial.refuses(
        "edit shaped.urdf simplify-collision cone -o out.urdf",
        "\"cone\" is not a shape; write box, cylinder, sphere, smallest or hull",
    );
    trial.refuses("edit arm.urdf simplify-collision box -o out.urdf", "these links have no collision mesh");
    trial.run("edit shaped.urdf simplify-collision hull --package-path . --to hulls -o hull.urdf").succeeded();
    assert!(trial.text("hull.urdf").contains(r#"<mesh filename="hulls/a_hull.obj" scale="0.001 0.001 0.001"/>"#));
    assert_eq!(trial.text("hulls/a_hull.obj").lines().filter(|line| line.starts_with("f ")).count(), 4);
}

#[test]
fn the_model_of_a_controllers_file_is_that_of_the_robot() {
    let conf = "[mounting]\ndelta_theta = [0, 0, 0, 0, 0, 0]\ndelta_d = [0.0002, 0, 0, 0, 0, 0]\ndelta_alpha = [0, 0, 0, 0, 0, 0]\n\
                delta_a = [0, 0.001, 0, 0, 0, 0]\ncalibration_status = 2\n";
    let trial = Trial::new().with("calibration.conf", conf);
    let run = trial.run("edit arm.urdf set-calibration calibration.conf -o out.urdf");
    assert_eq!(run.code, 0, "{}", run.stderr);
    assert!(run.stderr.contains("ur_type:=ur5e is assumed"), "{}", run.stderr);
    assert!(trial.text("out.urdf").contains("-0.424"), "{}", trial.text("out.urdf"));
}

#[test]
fn numbers_that_are_added_to_origins_are_added() {
    let pal = "robot_state_publisher:\n  geometric_calibration:\n    elbow_dx: 0.0004\n    elbow_droll: 0.0051\n    nobody_dx: 1\n";
    let offsets = "elbow_joint_x: 0.001\nelbow_joint_a: 0.002\n";
    let trial = Trial::new().with("pal.yaml", pal).with("offsets.yaml", offsets);
    let trial = trial.with("other.yaml", "geometric_calibration: {arm_dx: 1}\n").with("far.yaml", "elbow_joint_x: 1\n");
    let run = trial.run("edit arm.urdf set-calibration pal.yaml -o pal.urdf");
    assert_eq!(run.code, 0, "{}", run.stderr);
    assert!(run.stderr.contains("nobody_dx\": the key is not understood"), "{}", run.stderr);
    assert!(trial.text("pal.urdf").contains(r#"<origin xyz="-0.4246 0 0" rpy="0.0051 0 0"/>"#));
    trial.run("edit arm.urdf set-calibration offsets.yaml -o offsets.urdf").succeeded();
    assert!(trial.text("offsets.urdf").contains(r#"<origin xyz="-0.424 0 0" rpy="0.002 0 0"/>"#));
    trial.refuses("edit arm.urdf set-calibration other.yaml -o out.urdf", "no key names a joint of this robot");
    trial.refuses(
        "edit arm.urdf set-calibration far.yaml -o out.urdf",
        "by 1000 mm and 0.0°: this calibration is for another robot",
    );
}

#[test]
fn what_calibrate_found_is_no_robot_and_says_how_it_becomes_one() {
    let trial = Trial::new().with("calib.json", r#"{"schema": "denavit.calibration/2", "robot": "ur5e"}"#);
    for command in ["table calib.json", "diff arm.urdf calib.json"] {
        let run = trial.run(command);
        assert_eq!(run.code, 2, "{}", run.stderr);
        assert!(
            run.stderr.contains("`denavit edit ROBOT.urdf set-calibration calib.json` makes a URDF of both"),
            "{}",
            run.stderr
        );
    }
}
