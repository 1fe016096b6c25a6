//! Wrong files: one message for each thing that is wrong, with its file, line and element, and what to do.

#![allow(clippy::unwrap_used, clippy::too_many_lines)] // Tests: a panic is a failure; a list is as long as it is.

fn message(text: &str) -> String {
    denavit_sdf::read("bad.sdf", text, &mut denavit_sdf::includes::nothing).unwrap_err().to_string()
}

/// A model of two links, its joint as given, from line 3 on.
fn with_joint(joint: &str) -> String {
    format!("<sdf version=\"1.9\"><model name=\"m\">\n<link name=\"base\"/><link name=\"arm\"/>\n{joint}</model></sdf>")
}

#[test]
fn every_mistake_is_said_with_its_place_and_the_fix() {
    let ends = "<parent>base</parent><child>arm</child>";
    let axis = "<axis><xyz>0 0 1</xyz></axis>";
    for (text, expected) in [
        ("<sdf version=\"1.9\"><model", "bad.sdf:1: file: not well-formed XML: "),
        ("<sdf version=\"1.9\"/>", "bad.sdf:1: <sdf>: the file has no <model>; a robot is one model"),
        ("<world/>", "bad.sdf:1: <world>: the root element is <world>, not <sdf>; is this an SDF file?"),
        (
            "<sdf version=\"1.9\"><model name=\"m\"/></sdf>",
            "bad.sdf:1: model \"m\": the model has no <link>; add one, or include a model that has",
        ),
        (
            "<sdf version=\"1.9\">\n<model name=\"a\"/><model name=\"b\"/></sdf>",
            "bad.sdf:2: model \"b\": there are 2 models: \"a\", \"b\"; a robot is one model, so put it into a file of its own",
        ),
        (&with_joint("<link/>"), "bad.sdf:3: <link>: the attribute `name` is missing; give it one"),
        (
            &with_joint(&format!("<joint name=\"j\" type=\"revolute\">{axis}</joint>")),
            "bad.sdf:3: joint \"j\": <parent> is missing; add it\nbad.sdf:3: joint \"j\": <child> is missing; add it",
        ),
        (
            &with_joint("<joint name=\"j\" type=\"fixed\"><parent>bsae</parent><child>arm</child></joint>"),
            "bad.sdf:3: joint \"j\": parent link \"bsae\" does not exist in this model; did you mean \"base\"?",
        ),
        (
            &with_joint("<joint name=\"j\" type=\"fixed\"><parent>base</parent><child>world</child></joint>"),
            "bad.sdf:3: joint \"j\": the child of a joint is \"world\"; swap parent and child",
        ),
        (
            &with_joint("<joint name=\"j\" type=\"fixed\"><parent>arm</parent><child>arm</child></joint>"),
            "bad.sdf:3: joint \"j\": parent and child are both on link \"arm\"; a joint needs two links",
        ),
        (
            &with_joint(&format!("<joint name=\"j\" type=\"revolute\">{ends}</joint>")),
            "bad.sdf:3: joint \"j\": <axis> is missing; add it",
        ),
        (
            &with_joint(&format!("<joint name=\"j\">{ends}</joint>")),
            "bad.sdf:3: joint \"j\": the attribute `type` is missing; write type=\"revolute\", \"prismatic\", \"fixed\", …",
        ),
        (
            &with_joint(&format!("<joint name=\"j\" type=\"hinge\">{ends}</joint>")),
            "bad.sdf:3: joint \"j\": the joint type \"hinge\" is unknown; SDF knows revolute, continuous, prismatic, screw, \
             fixed, universal, revolute2, ball and gearbox",
        ),
        (
            &with_joint(&format!("<joint name=\"j\" type=\"revolute\">{ends}<axis>\n<xyz>0 0 0</xyz></axis></joint>")),
            "bad.sdf:3: joint \"j\": the axis <xyz>0 0 0</xyz> has length zero; give the direction that the joint moves along or about",
        ),
        (
            &with_joint(&format!("<joint name=\"j\" type=\"revolute\">{ends}<axis>\n<xyz>0 0</xyz></axis></joint>")),
            "bad.sdf:4: joint \"j\": <xyz>0 0</xyz> has 2 numbers instead of 3",
        ),
        (
            &with_joint(&format!("<joint name=\"j\" type=\"fixed\">{ends}<pose>0 0 x 0 0 0</pose></joint>")),
            "bad.sdf:3: joint \"j\": <pose>0 0 x 0 0 0</pose>: \"x\" is not a finite number",
        ),
        (
            &with_joint(&format!(
                "<joint name=\"j\" type=\"fixed\">{ends}<pose rotation_format=\"wxyz\">0 0 0 0 0 0</pose></joint>"
            )),
            "bad.sdf:3: joint \"j\": rotation_format=\"wxyz\" is unknown; write euler_rpy or quat_xyzw",
        ),
        (
            &with_joint(&format!(
                "<joint name=\"j\" type=\"fixed\">{ends}<pose rotation_format=\"quat_xyzw\">0 0 0 0 0 0 0</pose></joint>"
            )),
            "bad.sdf:3: joint \"j\": the quaternion in <pose>0 0 0 0 0 0 0</pose> has length zero; for no rotation write \"0 0 0 1\"",
        ),
        (
            &with_joint(&format!(
                "<joint name=\"j\" type=\"fixed\">{ends}<pose degrees=\"yes\">0 0 0 0 0 0</pose></joint>"
            )),
            "bad.sdf:3: joint \"j\": <pose>0 0 0 0 0 0</pose>: \"yes\" is not a truth value; write degrees=\"true\" or \"false\"",
        ),
        (
            &with_joint(&format!(
                "<joint name=\"j\" type=\"fixed\">{ends}<pose relative_to=\"bas\">0 0 0 0 0 0</pose></joint>"
            )),
            "bad.sdf:3: joint \"j\": relative_to \"bas\" does not exist in this model; did you mean \"base\"?",
        ),
        (
            &with_joint(&format!(
                "<joint name=\"j\" type=\"revolute\">{ends}<axis><xyz expressed_in=\"hand\">0 0 1</xyz></axis></joint>"
            )),
            "bad.sdf:3: joint \"j\": expressed_in \"hand\" does not exist in this model; add it or correct the name",
        ),
        (
            &with_joint(
                "<frame name=\"f\"><pose relative_to=\"g\"/></frame><frame name=\"g\"><pose relative_to=\"f\"/></frame>",
            ),
            "bad.sdf:3: frame \"f\": frames depend on each other: \"g\", \"f\"; define one of them in a frame that does not depend on it",
        ),
        (
            &with_joint("<frame name=\"f\" attached_to=\"g\"/><frame name=\"g\" attached_to=\"f\"/>"),
            "bad.sdf:3: frame \"f\": frames depend on each other: \"g\", \"f\"; define one of them in a frame that does not depend on it",
        ),
        (
            &with_joint(&format!(
                "<joint name=\"j\" type=\"screw\">{ends}{axis}<screw_thread_pitch>0</screw_thread_pitch></joint>"
            )),
            "bad.sdf:3: joint \"j\": <screw_thread_pitch>0</screw_thread_pitch> is not a valid pitch; write screw_thread_pitch in m per turn, not 0",
        ),
        (&with_joint("<include/>"), "bad.sdf:3: model \"m\": <uri> is missing; add it"),
        (
            &with_joint(
                "<include>\n<uri>model://gripper</uri></include><joint name=\"j\" type=\"fixed\"><parent>gripper::palm</parent><child>arm</child></joint>",
            ),
            "bad.sdf:4: joint \"j\": its parent is in the model model://gripper, which was not found (no files are read here); add the \
             folder that holds it to ‹package-path›",
        ),
        (
            &with_joint("<link name=\"x\"><visual name=\"v\"/></link>"),
            "bad.sdf:3: link \"x\": <geometry> is missing; add it",
        ),
        (
            &with_joint("<link name=\"x\"><visual name=\"v\"><geometry><sphere/></geometry></visual></link>"),
            "bad.sdf:3: link \"x\": <radius> is missing; add it",
        ),
        (
            &with_joint("<link name=\"x\"><inertial><mass>heavy</mass></inertial></link>"),
            "bad.sdf:3: link \"x\": <mass>heavy</mass>: \"heavy\" is not a finite number",
        ),
        (
            &with_joint("<static>perhaps</static>"),
            "bad.sdf:3: model \"m\": <static>perhaps</static>: \"perhaps\" is not a truth value; write true or false",
        ),
    ] {
        let said = message(text);
        if expected.ends_with(": ") {
            assert!(said.starts_with(expected), "{said}");
        } else {
            assert_eq!(said, expected, "{text}");
        }
    }
}

#[test]
fn everything_that_is_wrong_is_said_at_once() {
    let text = "<sdf version=\"1.9\"><model name=\"m\"><link name=\"a\"><inertial><mass>x</mass></inertial></link>\n\
                <link name=\"b\"/><joint name=\"j\" type=\"hinge\"><parent>a</parent><child>b</child></joint>\n\
                <joint name=\"k\" type=\"revolute\"><parent>a</parent><child>b</child></joint></model></sdf>";
    assert_eq!(message(text).lines().count(), 2, "{}", message(text));
}

#[test]
fn a_model_that_includes_itself_is_refused() {
    let text = "<sdf version=\"1.9\"><model name=\"m\"><link name=\"a\"/><include><uri>model://m</uri></include></model></sdf>";
    let mut fetch = |_: &str, _: &str| Ok(("m.sdf".to_owned(), text.to_owned()));
    let said = denavit_sdf::read("m.sdf", text, &mut fetch).unwrap_err().to_string();
    assert_eq!(said, "m.sdf:1: <include>: the model model://m includes itself; remove one of the includes");
}

#[test]
fn a_joint_that_sdf_cannot_say_is_refused() {
    let text = "<robot name=\"r\"><link name=\"a\"/><link name=\"b\"/>\n\
                <joint name=\"j\" type=\"spatial\"><parent link=\"a\"/><child link=\"b\"/></joint></robot>";
    let robot = denavit_model::urdf::read("r.urdf", text).unwrap();
    let said = denavit_sdf::write(&robot).unwrap_err().to_string();
    assert_eq!(said, "r.urdf:2: joint \"j\": type \"spatial\" is not an SDF joint type; write another type");
}
