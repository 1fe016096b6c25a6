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
    trial.refuses("edit bent.xacro flip j -o out.urdf", "this is xacro: one line of it may stand for several joints");
    trial.refuses("edit arm.urdf flip elbow -o out.urdf", "the robot has no joint \"elbow\"");
    trial.refuses("edit arm.urdf turn elbow_joint -o out.urdf", "\"turn\" is no operation");
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
    assert!(said.starts_with("set-calibration actual.csv: moves on purpose, within "), "{said}");
    assert!(said.contains("e-4 m and"), "{said}");
    assert!(trial.text("out.urdf").contains("0 0 0.1627"));
}
