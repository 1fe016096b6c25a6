//! What cannot be compared is refused with a message that says how to go on.

use denavit_dh::convert::{Options, table};
use denavit_dh::matching::{VendorTable, match_table};
use denavit_dh::{Convention, Motion};
use denavit_model::examples;

fn refusal(change: impl Fn(&mut VendorTable)) -> String {
    let chain = examples::rail_arm();
    let own = table(&chain, &Options::default()).unwrap().value;
    let mut vendor = VendorTable::of(&own, Convention::Distal, false);
    change(&mut vendor);
    match_table(&chain, &vendor).unwrap_err().to_string()
}

#[test]
fn another_number_of_joints() {
    assert_eq!(
        refusal(|vendor| vendor.joints.truncate(3)),
        "the chain from \"base\" to \"tip\" has 4 moving joints and the table has 3; choose another ‹base› or ‹tip›, or \
         another table"
    );
}

#[test]
fn another_kind_of_joint() {
    assert_eq!(
        refusal(|vendor| vendor.joints[0].motion = Motion::Revolute),
        "row 1: joint \"joint_1\" of the robot is prismatic and the table's is revolute; both must be of the same kind"
    );
}

#[test]
fn joints_in_another_order() {
    assert_eq!(
        refusal(|vendor| vendor.joints.swap(1, 2)),
        "row 2 is named \"joint_3\", but joint 2 from the base is \"joint_2\"; put the rows in the chain's order"
    );
}

#[test]
fn a_number_that_is_none() {
    assert_eq!(refusal(|vendor| vendor.joints[2].row.a = Some(f64::NAN.into())), "row 3: a is not finite");
}

#[test]
fn beta_in_a_proximal_table() {
    let change = |vendor: &mut VendorTable| {
        vendor.convention = Convention::Proximal;
        vendor.joints[1].row.beta = Some(0.1.into());
    };
    assert_eq!(refusal(change), "row 2: beta belongs to the hayati convention");
}
