//! Two hands of one robot that touch each other.

use crate::hands::{Grips, TWO_ARMS, Touches, both, covered, errors, grip_errors};
use denavit_measurements::import::ImportOptions;
use denavit_measurements::{Units, read, read_export};
use std::sync::Arc;

#[test]
fn touches_of_both_hands_calibrate_both_arms_as_well_as_can_be() {
    let [drawn, fitted, plain, bound] = errors(40, 0..12);
    println!("as drawn {drawn:.2e} m, fitted {fitted:.2e} m, plain least squares {plain:.2e} m, bound {bound:.2e} m");
    assert!(drawn > 5e-4 && (0.85..1.15).contains(&(fitted / bound)) && fitted < 1.02 * plain);
}

#[test]
fn intervals_of_touches_hold_the_truth() {
    let share = covered(40, 0..12);
    println!("{share:.3} of the 95 % intervals hold the way between the points");
    assert!((0.92..0.98).contains(&share), "{share}");
}

#[test]
fn a_tool_in_both_hands_calibrates_both_arms_as_well_as_can_be() {
    // Three runs tell the ratio to some tenths; study_contact has more.
    let ([drawn, fitted, bound], share) = grip_errors(20, 0..3);
    println!("as drawn {drawn:?}, fitted {fitted:?}, bound {bound:?} m and rad; {share:.3} of the 95 % intervals");
    for k in 0..2 {
        assert!(drawn[k] > 5.0 * fitted[k] && (0.7..1.3).contains(&(fitted[k] / bound[k])), "{k}");
    }
    assert!((0.90..0.99).contains(&share), "{share}");
}

#[test]
fn a_grip_is_a_frame_of_its_own_and_its_label_names_the_tool() {
    let run = Grips::drawn(26, 3);
    let data = run.data(&run.postures[..6]);
    assert_eq!((data.len(), data.postures().len(), data.scene.setups.len()), (12, 6, 6));
    assert_eq!(data.scene.targets, ["left_hand grip bar", "right_hand grip bar"]);
}

#[test]
fn a_touch_is_a_place_of_its_own_and_its_label_names_the_points() {
    let run = Touches::drawn(6, 3);
    let data = run.data(&run.postures);
    assert_eq!((data.len(), data.postures().len(), data.scene.points.len()), (12, 6, 6));
    assert_eq!(data.scene.targets, ["left_hand ball pins", "right_hand ball pins"]);
}

#[test]
fn a_contact_without_two_tips_is_said() {
    let (chain, tips, _) = both(TWO_ARMS);
    let names: Vec<&str> = chain.coordinates().iter().map(|coordinate| coordinate.name.as_str()).collect();
    let zeros = vec!["0"; names.len()].join(",");
    let text = |tip: &str, label: &str| format!("tip,{},contact\n{tip},{zeros},{label}\n", names.join(","));
    let options = ImportOptions { tips: Some(Arc::clone(&tips)), ..ImportOptions::default() };
    let said = |tip: &str, label: &str| {
        read_export("run.csv", text(tip, label).as_bytes(), &chain, Units::default(), &options).unwrap_err().to_string()
    };
    for tip in ["left_hand", "left_hand+left_hand", "left_hand+foot", "left_hand+right_hand+foot"] {
        let found = said(tip, "pins");
        assert!(found.starts_with("run.csv:2:") && found.contains("with a + between them"), "{found}");
    }
    assert!(said("left_hand+right_hand", "").contains("write the tip that the row was measured at"));
    let alone =
        read("run.csv", text("left_hand", "pins").as_bytes(), &chain, Units::default()).unwrap_err().to_string();
    assert!(alone.contains("name both (‹tip› LINK ‹tip› LINK)"), "{alone}");
    let held = text("left_hand", "bar").replace("contact", "grip");
    let alone = read("run.csv", held.as_bytes(), &chain, Units::default()).unwrap_err().to_string();
    assert!(alone.contains("column \"grip\""), "{alone}");
}
