//! Two hands of one robot that touch each other.

use crate::hands::{TWO_ARMS, Touches, both, errors};
use denavit_calibrate::observation::measurements::import::ImportOptions;
use denavit_calibrate::observation::measurements::{Units, read, read_export};
use std::sync::Arc;

#[test]
fn touches_of_both_hands_calibrate_both_arms_as_well_as_can_be() {
    let [drawn, fitted, plain, bound] = errors(40, 0..12);
    println!("as drawn {drawn:.2e} m, fitted {fitted:.2e} m, plain least squares {plain:.2e} m, bound {bound:.2e} m");
    assert!(drawn > 5e-4 && (0.85..1.15).contains(&(fitted / bound)) && fitted < 1.02 * plain);
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
}
