//! A model as a robot: by the values that the reader made, and by the text that it wrote.

#![allow(clippy::unwrap_used)] // Tests: a panic is a failure.

#[path = "../../../tests/files.rs"]
mod files;

use self::files::{files, top};
use std::path::Path;

/// The same robot, to the last digit and place; or the same problems.
fn same(file: &str, text: &str, folder: &Path) -> bool {
    let mut content = |name: &str| std::fs::read(folder.join(name)).map_err(|error| error.to_string());
    let Ok(made) = denavit_mjcf::translated(file, text, &mut content) else { return false };
    let by_text = denavit_model::urdf::read(file, &made.text());
    assert_eq!(format!("{:?}", made.robot(file)), format!("{by_text:?}"), "{file}");
    by_text.is_ok()
}

#[test]
fn values_say_what_the_text_says() {
    let shared = top().join("../shared/vendor/mjcf");
    if !shared.exists() {
        println!("skipped, because {} is not there", shared.display());
        return;
    }
    let found = files(&shared, "xml");
    let read = found
        .iter()
        .filter(|path| same(&path.to_string_lossy(), &std::fs::read_to_string(path).unwrap(), path.parent().unwrap()));
    assert!(read.count() > 20, "{found:?}");
}

/// Every kind of joint and shape, a site of a body's name, characters that XML reads as others, and trees that are none.
#[test]
fn values_say_what_the_text_says_of_odd_models() {
    let body = |inside: &str| format!("<mujoco model=\"a &amp; b\"><worldbody>{inside}</worldbody></mujoco>");
    let arm = r#"<body name="a"><freejoint/><geom size="1" rgba="1 0 0.5 -0"/><site name="a" pos="-0 0 1e-20"/>
        <body name="b &lt; c" pos="1 2 3" euler="10 20 30"><joint name="x" axis="0 0 -2" ref="5" range="-10 10" frictionloss="2"/>
        <joint name="y" type="slide" pos="1 1 1" axis="0.70710678 0.70710678 0" limited="false"/><joint name="z" type="ball"/>
        <geom name="g" type="capsule" size="0.1 0.2" contype="0" conaffinity="0"/><geom type="box" size="1 2 3" group="3"/>
        <geom type="cylinder" fromto="0 0 0 1 1 1" size=".1"/><body name="d" pos="0 0 1e300"><geom size="1"/></body></body></body>"#;
    assert!(same("odd.xml", &body(arm), Path::new(".")));
    assert!(same("odd.xml", &body(&arm.replace("name=\"g\"", "name=\"g&#10;h\"")), Path::new(".")));
    for (from, to) in [("\"y\"", "\"x\""), ("1 2 3", "1e308 2 1e308"), ("name=\"d\"", "name=\"world\"")] {
        same("odd.xml", &body(&arm.replace(from, to)), Path::new("."));
    }
}
