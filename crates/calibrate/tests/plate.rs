//! Joint zeros from a printed plate of holes.

use crate::touched::Touching;
use denavit_calibrate::IdentifyOptions;
use denavit_identify::identify;
use denavit_measurements::import::ImportOptions;
use denavit_measurements::{Units, read, read_export};
use denavit_model::examples;

#[test]
fn touched_holes_tell_the_zeros() {
    let chain = examples::puma_like();
    let plate = "4x3:40mm".parse().unwrap();
    let touching = Touching { chain: &chain, plate, zeros: 0.03, axes: [0.0, 0.0], noise: 2e-4 };
    let run = touching.run(4, 5);
    let (fitted, later) = run.rows.split_at(36);
    let data = touching.data(fitted);
    assert_eq!((data.len(), data.scene.setups.len()), (36, 3));
    let found = identify(&chain, &data, &IdentifyOptions::zeros(&chain, vec![true; 6]));
    let [drawn, zeroed, true_arm] =
        [&found.nominal.arm, &found.geometric.arm, &run.truth].map(|arm| touching.error(arm, later));
    println!("as drawn {drawn:.6} m, with zeros {zeroed:.6} m, the true arm {true_arm:.6} m");
    assert!(drawn > 2e-3 && zeroed < 1.5 * true_arm, "{drawn} {zeroed} {true_arm}");
}

#[test]
fn a_hole_that_is_not_there_and_a_plate_that_is_not_stated_are_said() {
    let chain = examples::puma_like();
    let said = |text: &str, plate: Option<&str>| {
        let options = ImportOptions { plate: plate.map(|plate| plate.parse().unwrap()), ..ImportOptions::default() };
        read_export("run.csv", text.as_bytes(), &chain, Units::default(), &options).unwrap_err().to_string()
    };
    let header = "joint_1,joint_2,joint_3,joint_4,joint_5,joint_6";
    let wrong = said(&format!("{header},hole\n0,0,0,0,0,0,A1\n0,0,0,0,0,0,D1\n"), Some("4x3:40mm"));
    assert!(wrong.starts_with("run.csv:3:") && wrong.contains("no hole \"D1\"; its holes are A1 to C4"), "{wrong}");
    let without = said(&format!("{header},hole\n0,0,0,0,0,0,A1\n"), None);
    assert!(without.contains("give the plate of the holes by ‹plate›"), "{without}");
    let both = said(&format!("{header},hole,x,y,z\n0,0,0,0,0,0,A1,1,2,3\n"), Some("4x3:40mm"));
    assert!(both.contains("leave out one of both"), "{both}");
    let none = said(&format!("{header},x,y,z\n0,0,0,0,0,0,1,2,3\n"), Some("4x3:40mm"));
    assert!(none.contains("needs a column \"hole\""), "{none}");
    // A label of this name beside a tracker's numbers is a label.
    let rows = format!("{header},hole,x,y,z\n0,0,0,0,0,0,A1,1,2,3\n");
    assert!(read("run.csv", rows.as_bytes(), &chain, Units::default()).is_ok());
}
