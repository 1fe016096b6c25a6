//! Files of pairs of poses.

use denavit_measurements::import::AngleConvention;
use denavit_measurements::pose_pairs::{PairAngles, PosePairs, read};
use denavit_model::se3;

fn read_text(text: &str, angles: PairAngles) -> Result<PosePairs, String> {
    read("p.csv", text.as_bytes(), "mm,deg".parse().unwrap(), angles).map_err(|error| error.to_string())
}

#[test]
fn orientations_are_one_in_every_form() {
    let seen = "x,y,z,qx,qy,qz,qw";
    let rows = |robot: &str, turn: &str| format!("{robot},{seen}\n1000,0,0,{turn},1,2,3,0,0,0,1\n");
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let place = "robot_x,robot_y,robot_z";
    let texts = [
        rows(&format!("{place},robot_qx,robot_qy,robot_qz,robot_qw"), &format!("0,0,{half},{half}")),
        rows(&format!("{place},robot_rx,robot_ry,robot_rz"), "0,0,90"),
        rows(&format!("{place},robot_roll,robot_pitch,robot_yaw"), "0,0,90"),
    ];
    let expected = se3::rotation_from_rpy([0.0, 0.0, std::f64::consts::FRAC_PI_2]);
    for text in &texts {
        let pairs = read_text(text, PairAngles::default()).unwrap();
        assert!(se3::rotation_angle(&(pairs.robot[0].rotation.inverse() * expected)) < 1e-15, "{text}");
        assert_eq!((pairs.robot[0].translation.x, pairs.seen[0].translation.z), (1.0, 0.003));
        assert_eq!(pairs.lines, [2]);
    }
    // KUKA's A, B, C.
    let robot = AngleConvention::Euler("ZYX".parse().unwrap());
    let pairs = read_text(
        &rows(&format!("{place},robot_rx,robot_ry,robot_rz"), "90,0,0"),
        PairAngles { robot, ..PairAngles::default() },
    );
    assert!(se3::rotation_angle(&(pairs.unwrap().robot[0].rotation.inverse() * expected)) < 1e-15);
}

#[test]
fn rows_in_which_nothing_was_seen_are_kept_apart() {
    let head = "robot_x,robot_y,robot_z,robot_rx,robot_ry,robot_rz,x,y,z,rx,ry,rz,image";
    let text = format!("{head}\n1,2,3,0,0,0,,,,,,,a.png\n1,2,3,0,0,0,1,1,1,0,0,0,b.png\n");
    let pairs = read_text(&text, PairAngles::default()).unwrap();
    assert_eq!((pairs.unseen, pairs.lines), (vec![2], vec![3]));
}

#[test]
fn problems_are_named_with_their_line() {
    let failed = |text: &str| read_text(text, PairAngles::default()).unwrap_err();
    assert_eq!(
        failed("x,y,z,rx,ry,rz\n1,2,3,0,0,0\n"),
        "p.csv:1: column \"robot_x\" is missing; a pair of poses needs robot_x, robot_y, robot_z, robot_rx, robot_ry, \
         robot_rz, and the columns are x, y, z, rx, ry, rz; an orientation is qx, qy, qz, qw, or a rotation vector rx, ry, rz, \
         or roll, pitch, yaw"
    );
    let head = "robot_x,robot_y,robot_z,robot_rx,robot_ry,robot_rz,x,y,z,qx,qy,qz,qw";
    assert!(failed(&format!("{head}\n0,0,0,0,0,0,0,0,0,0,0,1,1\n")).contains("p.csv:2: the quaternion has length"));
    assert!(failed(&format!("{head}\n0,0,0,0,0,0,0,0,0,0,0,a,1\n")).contains("p.csv:2: column \"qz\""));
    assert!(failed(&format!("{head}\n")).contains("no rows"));
}
