//! Joint values for a pose, and edits, as the page asks for them.

#![allow(clippy::unwrap_used, reason = "a panic is a failure")]

use serde_json::{Value, json};

const UR5E: &str = include_str!("../../../robots/universal_robots/ur5e.urdf");
const NEAR: [f64; 6] = [0.6, -1.1, 1.3, -0.8, -1.2, 0.3];

fn answer(question: &Value) -> Value {
    serde_json::from_str(&denavit_web::answer(&question.to_string())).unwrap()
}

fn source(text: &str) -> Value {
    json!({ "file": "arm.urdf", "text": text, "files": {}, "names": [], "exact": false })
}

/// base_from_tip at joint values, 16 numbers column by column, by the answer to `fk`.
fn pose(text: &str, names: &[&str], q: &[f64]) -> Vec<f64> {
    let values: Value = names.iter().zip(q).map(|(name, q)| ((*name).to_owned(), json!(q))).collect();
    let answered = answer(&json!({ "ask": "fk", "source": source(text), "q": values }));
    let answered: Value = serde_json::from_str(answered["text"].as_str().unwrap()).unwrap();
    let rows: Vec<Vec<f64>> = serde_json::from_value(answered["pose"].clone()).unwrap();
    (0..16).map(|at| rows[at % 4][at / 4]).collect()
}

#[test]
fn every_posture_of_a_pose_is_one_and_the_present_one_comes_first() {
    let names =
        ["shoulder_pan_joint", "shoulder_lift_joint", "elbow_joint", "wrist_1_joint", "wrist_2_joint", "wrist_3_joint"];
    let wanted = pose(UR5E, &names, &NEAR);
    let answered = answer(&json!({ "ask": "ik", "source": source(UR5E), "pose": wanted, "near": NEAR }));
    assert_eq!(
        (answered["reached"].as_bool(), answered["solutions"].as_array().map(Vec::len)),
        (Some(true), Some(8)),
        "{answered}"
    );
    for (at, solution) in answered["solutions"].as_array().unwrap().iter().enumerate() {
        let joints: Vec<f64> = serde_json::from_value(solution["joints"].clone()).unwrap();
        let apart = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(apart(&pose(UR5E, &names, &joints), &wanted) < 1e-12);
        assert_eq!(apart(&joints, &NEAR) < 1e-9, at == 0, "only the first one is the present one");
    }
}

#[test]
fn what_is_no_pose_or_no_posture_gets_one_sentence() {
    let mut pose = vec![1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.3, 0.2, 0.4, 1.0];
    let ask = |pose: &[f64], near: &[f64], text: &str| {
        answer(&json!({ "ask": "ik", "source": source(text), "pose": pose, "near": near }))
    };
    assert_eq!(ask(&pose, &NEAR[..5], UR5E)["error"], "6 finite joint values are wanted");
    let still = "<robot name=\"r\"><link name=\"a\"/><link name=\"b\"/><joint name=\"j\" type=\"fixed\"><parent link=\"a\"/><child link=\"b\"/></joint></robot>";
    assert!(ask(&pose, &[], still)["error"].as_str().is_some_and(|words| words.contains("nothing moves between")));
    for (at, number) in [(0, 1.1), (3, 0.5), (15, 0.0)] {
        let kept = std::mem::replace(&mut pose[at], number);
        assert_eq!(ask(&pose, &NEAR, UR5E)["error"], "16 numbers of a pose are wanted, column by column");
        pose[at] = kept;
    }
    pose[12] = 5.0;
    let far = ask(&pose, &NEAR, UR5E);
    assert_eq!((far["reached"].as_bool(), far["solutions"].as_array().map(Vec::len)), (Some(false), Some(1)));
    assert!(far["solutions"][0]["position_error_m"].as_f64().unwrap() > 4.0);
}

#[test]
fn an_edit_that_takes_a_robot_wants_one() {
    let asked = |other: Value| {
        let words = ["attach", "hand.urdf", "--at", "tool0", "--prefix", "hand_"];
        answer(&json!({ "ask": "edit", "source": source(UR5E), "words": words, "other": other }))
    };
    assert!(asked(Value::Null)["error"].as_str().is_some_and(|words| words.contains("write attach FILE --at LINK")));
    let hand = json!({ "file": "hand.urdf", "text": "<robot name=\"hand\"><link name=\"palm\"/></robot>", "files": {}, "names": [], "exact": false });
    let done = asked(hand);
    assert!(done["said"][0].as_str().is_some_and(|words| words.starts_with("attach hand.urdf at tool0")), "{done}");
    assert!(done["text"].as_str().unwrap().contains("hand_palm") && done["diff"].as_str().unwrap().contains('+'));
}
