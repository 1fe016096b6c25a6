//! What a user of the libraries can ask for panics nowhere.

use crate::support::robot;
use denavit_calibrate::observation::measurements::{self, Units};
use denavit_model::Reading;

#[test]
fn a_file_of_distances_has_no_positions() {
    let text = std::fs::read_to_string(robot("universal_robots/ur5e.urdf")).unwrap();
    let arm = denavit_model::urdf::read("arm.urdf", &text).unwrap();
    let chain = arm.chain(None, None, Reading::Intended).unwrap().value;
    let joints: Vec<&str> = chain.coordinates().iter().map(|joint| joint.name.as_str()).collect();
    let rows: Vec<String> = (0..4u32).map(|k| format!("0,-1,1,0,0.{k},0,1.{k}\n")).collect();
    let file = format!("{},distance\n{}", joints.join(","), rows.concat());
    let data = measurements::read("data.csv", file.as_bytes(), &chain, Units::default()).unwrap().data;
    for (row, target) in [(0, 0), (3, 0), (0, 7), (99, 0)] {
        assert_eq!(data.position(row, target), None);
    }
}
