//! Several tips of one robot: both hands of a Baxter in one fit, and what is refused.

use super::Trial;
use serde_json::Value;

const BOTH: &str = "--tip left_hand --tip right_hand";

fn trial() -> Trial {
    let trial = Trial::new().with_robot("baxter.urdf", "rethink/baxter.urdf");
    trial.run(&format!("simulate baxter.urdf {BOTH} --measure poses --rows 120 --seed 2 -o both.csv")).succeeded();
    trial
}

#[test]
fn both_hands_are_one_fit_and_one_robot() {
    let trial = trial();
    let outputs = "--json fit.json --urdf fit.urdf --dh table.csv --hold-out 0.25";
    let run = trial.run(&format!("calibrate baxter.urdf {BOTH} --data both.csv {outputs}"));
    let text = run.succeeded();
    assert!(text.contains("torso to left_hand, right_hand") && text.contains("4·14 + 12 = 68 expected, 68"), "{text}");
    let found: Value = serde_json::from_str(&trial.text("fit.json")).unwrap();
    assert_eq!(found["tips"][1]["tip"], "right_hand");
    assert_eq!(found["tips"][1]["joints"].as_array().unwrap().len(), 7);
    assert!(found["tips"][1]["test"]["position_rms_m"].as_f64().unwrap() < 2e-4);
    for (tip, side) in [("left_hand", "left"), ("right_hand", "right")] {
        let rows = trial.text(&format!("table_{tip}.csv"));
        assert!(rows.contains(side), "{rows}");
        // The URDF moves each hand as its own table does.
        trial.run(&format!("fk fit.urdf --tip {tip} --q 0.1,0.2,0.3,0.4,0.5,0.6,0.7")).succeeded();
    }
    // One tip of the result goes on by itself.
    trial.run("identify fit.urdf --tip left_hand").succeeded();
    let again = format!("calibrate baxter.urdf {BOTH} --data both.csv --prior fit.json --effects none");
    trial.run(&again).succeeded();
}

#[test]
fn what_one_arm_gives_is_found_and_goes_into_its_own_file() {
    let trial = trial();
    let effect = "--effect joint_compliance@left_s1=0.4mm";
    trial
        .run(&format!("simulate baxter.urdf {BOTH} --measure poses --rows 300 --seed 4 {effect} -o soft.csv"))
        .succeeded();
    let outputs = "--json fit.json --urdf fit.urdf --effects-out effects.json --html fit.html";
    trial.run(&format!("calibrate baxter.urdf {BOTH} --data soft.csv --hold-out 0.25 {outputs}")).succeeded();
    let found: Value = serde_json::from_str(&trial.text("fit.json")).unwrap();
    let effects = found["effects"].as_array().unwrap();
    assert!(
        effects.len() == 1 && effects[0]["kind"] == "joint_compliance" && effects[0]["joint"] == "left_s1",
        "{effects:?}"
    );
    let fk = |tip: &str, effects: &str| {
        trial.run(&format!("fk fit.urdf --tip {tip} --q 0.1,0.2,0.3,0.4,0.5,0.6,0.7 {effects}")).succeeded()
    };
    assert_ne!(fk("left_hand", "--effects effects_left_hand.json"), fk("left_hand", ""));
    assert_eq!(fk("right_hand", "--effects effects_right_hand.json"), fk("right_hand", ""));
}

#[test]
fn a_hand_bolted_to_the_base_is_calibrated_by_its_grips() {
    let trial = Trial::new().with_robot("baxter.urdf", "rethink/baxter.urdf");
    let tips = "--tip torso --tip right_hand";
    let rows = "--measure grips --rows 40 --seed 6 -o bolted.csv --test later.csv";
    trial.run(&format!("simulate baxter.urdf {tips} {rows}")).succeeded();
    assert!(trial.text("bolted.csv").contains("\ntorso+right_hand,"));
    trial.run(&format!("calibrate baxter.urdf {tips} --data bolted.csv --test later.csv --json fit.json")).succeeded();
    let found: Value = serde_json::from_str(&trial.text("fit.json")).unwrap();
    let error = |stage: usize| found["stages"][stage]["test"]["grip_rms_m"].as_f64().unwrap();
    assert!(error(1) < 0.3 * error(0), "{} {}", error(0), error(1));
}

#[test]
fn one_tip_has_no_list_of_tips() {
    let trial = trial();
    let rows = trial.text("both.csv");
    let own: Vec<&str> = rows.lines().filter(|line| !line.ends_with(",right_hand")).collect();
    let trial = trial.with("left.csv", &(own.join("\n") + "\n"));
    let text = trial.run("calibrate baxter.urdf --tip left_hand --data left.csv --effects none --json").succeeded();
    let found: Value = serde_json::from_str(&text).unwrap();
    assert!(found.get("tips").is_none() && found["tip"] == "left_hand");
}

#[test]
fn what_several_tips_cannot_do_is_refused_in_a_sentence() {
    let trial = trial();
    let rows = trial.text("both.csv");
    let trial = trial
        .with("wrong.csv", &rows.replacen("right_hand", "rigth_hand", 1))
        .with("without.csv", &rows.replacen(",tip\n", ",place\n", 1));
    let calibrate = format!("calibrate baxter.urdf {BOTH}");
    for (words, expected) in [
        (
            format!("{calibrate} --data wrong.csv"),
            "column \"tip\": \"rigth_hand\" is not among the calibrated tips; write the tip that the row was measured at: \
             left_hand or right_hand",
        ),
        (format!("{calibrate} --data without.csv"), "there is no column \"tip\", but several tips are calibrated"),
        (
            "calibrate baxter.urdf --tip left_hand --data both.csv".into(),
            "the row belongs to \"right_hand\", but the chain ends at \"left_hand\"; name every tip that is calibrated",
        ),
        (format!("{calibrate} --data both.csv --tip left_wrist"), "both.csv: no row is of tip \"left_wrist\""),
        (format!("{calibrate} --data both.csv --tip left_hand"), "tip \"left_hand\" is named twice"),
        (format!("{calibrate} --data both.csv --out-for robot-calibration out.yaml"), "a maker's file holds one arm"),
        (format!("{calibrate} --data both.csv --socket a=both.csv"), "calibrate one tip at a time"),
        (format!("simulate baxter.urdf {BOTH} --measure planes"), "are simulated at one tip"),
        (format!("plan baxter.urdf {BOTH} --count 5"), "'--tip <LINK>' cannot be used multiple times"),
        (format!("measure baxter.urdf {BOTH} --data both.csv"), "'--tip <LINK>' cannot be used multiple times"),
        (format!("compensate baxter.urdf {BOTH} --poses both.csv"), "'--tip <LINK>' cannot be used multiple times"),
        (format!("identify baxter.urdf {BOTH}"), "'--tip <LINK>' cannot be used multiple times"),
    ] {
        trial.refuses(&words, expected);
    }
}
