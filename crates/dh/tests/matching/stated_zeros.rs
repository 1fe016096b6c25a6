//! A number of the robot's is shown as it is at the senses and zeros that the match states.

use denavit_dh::matching::{DhNumber, Match, VendorTable, match_table};
use denavit_dh::{Convention, Options, RowLabel, Table, convert};
use denavit_model::chain::Chain;
use denavit_model::se3;

/// The six-axis arms that robots of this project are, by base, shoulder, elbow and wrist: m.
fn arm(lengths: [f64; 6]) -> Chain {
    let [a1, a2, a3, d1, d4, d6] = lengths;
    let opw = denavit_dh::opw::OrthoParallelWrist {
        a1,
        a2: a3,
        b: 0.0,
        c1: d1,
        c2: a2,
        c3: d4,
        c4: d6,
        offsets: [0.0, 0.3, -0.4, 0.0, 0.0, 0.0],
        signs: [1.0, -1.0, 1.0, -1.0, 1.0, 1.0],
    };
    opw.chain("arm").unwrap()
}

fn table_of(chain: &Chain) -> Table {
    convert::table(chain, &Options::default()).unwrap().value
}

/// Largest distance of the tips when the robot's number stands in the vendor's table, at what the match says it needs.
fn apart(chain: &Chain, vendor: &VendorTable, found: &Match) -> f64 {
    let explanation = found.explanation.as_ref().unwrap();
    let mut table = vendor.clone();
    for difference in &explanation.differences {
        let RowLabel::Joint(index) = difference.label else { panic!("{difference:?}") };
        let row = &mut table.joints[index].row;
        let slot = match difference.number {
            DhNumber::Theta => &mut row.theta,
            DhNumber::D => &mut row.d,
            DhNumber::Alpha => &mut row.alpha,
            DhNumber::A => &mut row.a,
            DhNumber::Beta => &mut row.beta,
        };
        *slot = Some(difference.robot.into());
    }
    // Zeros and senses are those of the answer's first page; base and tool are free.
    let changed = match_table(chain, &table).unwrap();
    let stated = |found: &Match| -> Vec<(f64, f64)> {
        found.placement.joints.iter().map(|joint| (joint.sense.sign(), joint.zero)).collect()
    };
    for ((sense, zero), (other, changed_zero)) in stated(found).iter().zip(stated(&changed)) {
        assert_eq!(*sense, other, "{:?}\n{:?}", found.placement.joints, changed.placement.joints);
        let turned = se3::rotation_about(&denavit_model::nalgebra::Vector3::z_axis(), zero - changed_zero);
        let (angle, _) = se3::difference(
            &se3::pose(turned, denavit_model::nalgebra::Vector3::zeros()),
            &denavit_model::Pose::identity(),
        );
        // The table as it stands bends zeros a little to fit.
        assert!(angle < 0.2, "{:?}\n{:?}", found.placement.joints, changed.placement.joints);
    }
    changed.placement.position_error
}

#[test]
fn a_length_that_differs_is_shown_at_the_zeros_that_are_stated() {
    let mut shown = 0;
    for lengths in [
        [0.15, 0.77, 0.0, 0.43, 0.82, 0.09],
        [0.15, 0.77, 0.1, 0.43, 0.82, 0.09],
        [0.0, 0.77, -0.05, 0.36, 0.7, 0.1],
        [0.32, 1.075, 0.225, 0.68, 1.28, 0.2],
        [0.1, 0.27, 0.07, 0.29, 0.302, 0.072],
    ] {
        let chain = arm(lengths);
        let table = table_of(&chain);
        for convention in [Convention::Distal, Convention::Proximal] {
            let vendor = VendorTable::of(&table, convention, false);
            for row in 0..vendor.joints.len() {
                let Some(length) = vendor.joints[row].row.a.as_ref().map(|a| a.value).filter(|a| a.abs() > 0.2) else {
                    continue;
                };
                for turned in [false, true] {
                    let mut slip = vendor.clone();
                    let value = length * 0.974;
                    slip.joints[row].row.a = Some(if turned { -value } else { value }.into());
                    let found = match_table(&chain, &slip).unwrap();
                    let Some(explanation) = &found.explanation else { panic!("{lengths:?} {row} is not explained") };
                    assert!(
                        apart(&chain, &slip, &found) < 1e-6,
                        "{lengths:?} {convention:?} row {row}: {explanation:?}"
                    );
                    if let [only] = &explanation.differences[..] {
                        assert!(only.robot * only.vendor > 0.0, "{lengths:?} {convention:?} {turned}: {only:?}");
                        shown += 1;
                    }
                }
            }
        }
    }
    println!("{shown} lengths");
    assert!(shown > 10, "{shown}");
}
