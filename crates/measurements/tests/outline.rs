//! What the columns of a file are taken for.

use denavit_measurements::import::outline;
use denavit_model::urdf::read;
use denavit_model::{Chain, Reading};

fn chain() -> Chain {
    let joint = |k: usize| {
        format!(
            "<link name=\"l{k}\"/><joint name=\"joint_a{k}\" type=\"continuous\"><parent link=\"l{}\"/><child link=\"l{k}\"/>\
             <origin xyz=\"{k} 0 0\"/></joint>",
            k - 1
        )
    };
    let text = format!("<robot name=\"r\"><link name=\"l0\"/>{}{}</robot>", joint(1), joint(2));
    read("r.urdf", &text).unwrap().chain(None, None, Reading::Intended).unwrap().value
}

#[test]
fn names_that_say_what_they_are_are_sure_and_others_are_guessed() {
    let text = "Joint A1,J2,T_x [mm],T_y [mm],T_z [mm],rx,ry,rz,Temperature,operator\n0,1,2,3,4,5,6,7,20,Ann\n";
    let columns = outline(text.as_bytes(), &chain()).unwrap();
    let seen: Vec<_> = columns.iter().map(|it| (it.meaning.as_deref(), it.sure, it.orientation)).collect();
    let expected = [
        (Some("joint_a1"), true, false),
        (Some("joint_a2"), false, false),
        (Some("x"), false, false),
        (Some("y"), false, false),
        (Some("z"), false, false),
        (None, false, true),
        (None, false, true),
        (None, false, true),
        (Some("temperature"), true, false),
        (None, false, false),
    ];
    assert_eq!(seen, expected);
    assert_eq!(columns[2].unit.as_deref(), Some("mm"));
    assert_eq!(columns[9].first, ["Ann"]);
}
