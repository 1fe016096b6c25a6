//! Files of joint values and poses.

use denavit_measurements::poses::{Poses, read, read_joints};
use denavit_measurements::{Covariate, Units};
use denavit_model::{examples, se3};

fn read_text(text: &str) -> Result<Poses, String> {
    let units = "mm,deg".parse().unwrap();
    read("p.csv", text.as_bytes(), &examples::planar_arm(), units).map_err(|error| error.to_string())
}

#[test]
fn joints_poses_and_what_comes_along_are_read_in_their_units() {
    let poses = read_text("# made by hand\njoint_1,joint_2,payload,word\n90,-180,2.5,a\n").unwrap();
    assert_eq!(poses.joints, [[90f64.to_radians(), -std::f64::consts::PI]]);
    assert!(poses.poses.is_empty());
    assert_eq!(poses.covariates, [Covariate { name: "payload".into(), values: vec![2.5] }]);
    assert_eq!(poses.lines, [3]);
    let by_quaternion = read_text("x,y,z,qx,qy,qz,qw\n1000,0,0,0,0,1,0\n").unwrap();
    let by_angles = read_text("x,y,z,roll,pitch,yaw\n1000,0,0,0,0,180\n").unwrap();
    let (turned, moved) = se3::difference(&by_quaternion.poses[0], &by_angles.poses[0]);
    assert!(turned < 1e-15 && moved == 0.0 && by_angles.poses[0].translation.x == 1.0);
}

#[test]
fn joints_are_read_from_a_measurement_file() {
    let text = "joint_1,x,y,z,joint_2\n1,0,0,0,2\n";
    let read = |text: &str| read_joints("d.csv", text.as_bytes(), &examples::planar_arm(), Units::default());
    assert_eq!(read(text).unwrap(), [[1.0, 2.0]]);
    let failed = read("x,y,z,joint_1\n1,0,0,0\n").unwrap_err().to_string();
    assert!(failed.starts_with("d.csv:1: joint \"joint_2\" has no column"), "{failed}");
}

#[test]
fn problems_are_named_with_their_line() {
    let failed = |text: &str| read_text(text).unwrap_err();
    assert!(
        failed("a,b\n1,2\n").starts_with("p.csv:1: no column belongs to a joint or a pose; there must be one for each")
    );
    assert!(failed("joint_1,joint2\n1,2\n").contains("did you mean column \"joint2\"?"));
    assert_eq!(
        failed("x,y,qx,qy,qz,qw\n1,2,0,0,0,1\n"),
        "p.csv:1: column \"z\" is missing beside \"x\"; x, y, z, qx, qy, qz, qw belong together"
    );
    assert_eq!(
        failed("joint_1,joint_2\n1,nan\n1\n"),
        "p.csv:2: column \"joint_2\": \"nan\" is not finite; correct the cell or remove the row\n\
         p.csv:3: 1 cells, but the header names 2 columns; write an empty cell for what was not seen"
    );
    assert!(failed("x,y,z,qx,qy,qz,qw\n1,0,0,0,0,1,1\n").contains("the quaternion has length 1.414214, not 1"));
    assert_eq!(
        failed("joint_1,joint_2\n"),
        "p.csv: there are no rows below the header; each row is one pose of the robot"
    );
}
