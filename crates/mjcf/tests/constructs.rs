//! Each construct of MJCF by itself: what becomes of it, by numbers worked out by hand or by MuJoCo's documentation.

#![allow(clippy::unwrap_used)] // Tests: a panic is a failure.

use denavit_model::nalgebra::{Rotation3, Vector3};
use denavit_model::robot::{Geometry, JointKind};
use denavit_model::{Note, Reading, Robot, se3, urdf};
use std::f64::consts::{FRAC_PI_2, PI};

fn no_files(name: &str) -> Result<Vec<u8>, String> {
    Err(format!("there is no {name}"))
}

/// The robot of what stands in a `<mujoco>`.
fn read(content: &str) -> Robot {
    let text = format!("<mujoco model=\"m\">\n{content}\n</mujoco>");
    let urdf = denavit_mjcf::read("m.xml", &text, &mut no_files).unwrap_or_else(|error| panic!("{error}\n{text}"));
    urdf::read("m.xml", &urdf).unwrap_or_else(|error| panic!("{error}\n{urdf}"))
}

/// A base with one body in it.
fn body(attributes: &str, content: &str) -> Robot {
    read(&format!("<worldbody><body name=\"base\"><body name=\"b\" {attributes}>{content}</body></body></worldbody>"))
}

fn turn(robot: &Robot) -> Rotation3<f64> {
    robot.joints[0].origin.pose().rotation
}

fn refused(content: &str) -> String {
    let text = format!("<mujoco>\n{content}\n</mujoco>");
    denavit_mjcf::read("m.xml", &text, &mut no_files).unwrap_err().to_string()
}

#[test]
fn every_form_of_an_orientation() {
    let quarter = se3::rotation_about(&Vector3::z(), FRAC_PI_2);
    for attributes in [
        "quat=\"1 0 0 1\"",
        "axisangle=\"0 0 2 90\"",
        "euler=\"0 0 90\"",
        "xyaxes=\"0 1 0 -1 0 0\"",
        "xyaxes=\"0 3 0 -1 5 0\"",
    ] {
        assert!(apart(&turn(&body(attributes, "")), &quarter) < 1e-15, "{attributes}");
    }
    let z = turn(&body("zaxis=\"1 0 0\"", "")) * Vector3::z();
    assert!((z - Vector3::x()).norm() < 1e-15);
    let half = turn(&body("zaxis=\"0 0 -1\"", "")) * Vector3::z();
    assert!((half + Vector3::z()).norm() < 1e-15);
}

/// The angle between two rotations, rad.
fn apart(a: &Rotation3<f64>, b: &Rotation3<f64>) -> f64 {
    se3::rotation_angle(&(a.inverse() * b))
}

#[test]
fn an_euler_sequence_in_capitals_turns_about_fixed_axes() {
    let of = |compiler: &str| {
        let content = format!(
            "<compiler angle=\"radian\" {compiler}/><worldbody><body name=\"a\"><body name=\"b\" euler=\".1 .2 .3\"/></body></worldbody>"
        );
        turn(&read(&content))
    };
    let [x, y, z] = [(Vector3::x(), 0.1), (Vector3::y(), 0.2), (Vector3::z(), 0.3)]
        .map(|(axis, angle)| se3::rotation_about(&axis, angle));
    assert!(apart(&of(""), &(x * y * z)) < 1e-15);
    assert!(apart(&of("eulerseq=\"XYZ\""), &(z * y * x)) < 1e-15);
    let zyx = se3::rotation_about(&Vector3::z(), 0.1)
        * se3::rotation_about(&Vector3::y(), 0.2)
        * se3::rotation_about(&Vector3::x(), 0.3);
    assert!(apart(&of("eulerseq=\"zyx\""), &zyx) < 1e-15);
}

#[test]
fn classes_inside_classes_and_childclass() {
    let robot = read(
        r#"<default><joint damping="1"/><default class="a"><joint damping="2" axis="1 0 0"/><default class="b"><joint range="-90 90"/>
        </default></default></default><worldbody><body name="r"><body name="x" childclass="a"><joint name="in_a"/>
        <body name="y"><joint name="in_b" class="b"/><body name="z" childclass="main"><joint name="in_main"/></body></body></body></body>
        </worldbody>"#,
    );
    let [a, b, main] = ["in_a", "in_b", "in_main"].map(|name| &robot.joints[robot.joint_index(name).unwrap()]);
    assert_eq!((a.dynamics().damping, a.axis.x, &a.kind), (2.0, 1.0, &JointKind::Continuous));
    assert_eq!((b.dynamics().damping, b.limits.range), (2.0, Some((-FRAC_PI_2, FRAC_PI_2))));
    assert_eq!((main.dynamics().damping, main.axis.z), (1.0, 1.0));
}

#[test]
fn a_joint_beside_the_origin_and_with_a_zero_of_its_own() {
    let robot = body("pos=\"1 0 0\"", "<joint name=\"j\" pos=\"0 1 0\" ref=\"90\" range=\"0 180\"/>");
    assert_eq!(robot.joints[0].limits.range, Some((0.0, PI)));
    let chain = robot.chain(Some("base"), Some("b"), Reading::AsWritten).unwrap().value;
    // At the reference the body stands as it is written; a quarter turn back it hangs about the point 1 1 0.
    let at = |q: f64| chain.fk(&[q]).translation.vector;
    assert!((at(FRAC_PI_2) - Vector3::new(1.0, 0.0, 0.0)).norm() < 1e-15);
    assert!((at(0.0) - Vector3::new(0.0, 1.0, 0.0)).norm() < 1e-15);
}

#[test]
fn several_joints_in_a_body_act_one_behind_another() {
    let robot =
        body("", "<joint name=\"x\" type=\"slide\" axis=\"1 0 0\"/><joint name=\"t\" axis=\"0 0 1\" pos=\"0 2 0\"/>");
    let chain = robot.chain(Some("base"), Some("b"), Reading::AsWritten).unwrap().value;
    let pose = chain.fk(&[3.0, FRAC_PI_2]);
    // T(3 0 0) · turn about the line through 0 2 0.
    assert!((pose.translation.vector - Vector3::new(5.0, 2.0, 0.0)).norm() < 1e-15, "{pose}");
    assert_eq!(robot.links.iter().filter(|link| link.inertial.is_none()).count(), robot.links.len());
}

#[test]
fn kinds_of_joints() {
    let robot = read(
        r#"<worldbody><body name="a"><freejoint/><body name="b"><joint type="ball" range="0 30"/></body>
        <body name="c"><joint name="s" type="slide" range="-1 2"/></body></body></worldbody>"#,
    );
    let kinds: Vec<&str> = robot.joints.iter().map(|joint| joint.kind.word()).collect();
    assert_eq!(kinds, ["floating", "ball", "prismatic"]);
    assert_eq!(robot.joints[2].limits.range, Some((-1.0, 2.0)));
    assert_eq!(robot.links[robot.root].name, "world");
}

#[test]
fn a_stated_inertia_in_every_form() {
    let inertial = |content: &str| body("", content).links[1].inertial.clone().unwrap();
    let full = inertial("<inertial pos=\"1 2 3\" mass=\"2\" fullinertia=\"3 4 5 .1 .2 .3\"/>");
    assert_eq!(full.mass, 2.0);
    assert_eq!((full.tensor[(0, 0)], full.tensor[(0, 1)], full.tensor[(1, 2)]), (3.0, 0.1, 0.3));
    let turned = inertial("<inertial pos=\"0 0 0\" mass=\"1\" diaginertia=\"1 2 3\" quat=\"1 0 0 1\"/>");
    let r = se3::rotation_from_rpy(turned.origin.rpy);
    let tensor = r.matrix() * turned.tensor * r.matrix().transpose();
    assert!((tensor[(0, 0)] - 2.0).abs() < 1e-15 && (tensor[(1, 1)] - 1.0).abs() < 1e-15);
}

#[test]
fn masses_of_geoms() {
    let of = |geom: &str| body("", geom).links[1].inertial.clone().unwrap();
    let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-12 * b.abs().max(1e-3), "{a} is not {b}");
    let ball = of("<geom size=\".1\"/>");
    near(ball.mass, 4.0 / 3.0 * PI);
    near(ball.tensor[(0, 0)], 0.4 * ball.mass * 0.01);
    let cuboid = of("<geom type=\"box\" size=\".1 .2 .3\" density=\"500\" pos=\"1 0 0\"/>");
    near(cuboid.mass, 0.2 * 0.4 * 0.6 * 500.0);
    near(cuboid.tensor[(0, 0)], cuboid.mass * (0.4 * 0.4 + 0.6 * 0.6) / 12.0);
    assert_eq!(cuboid.origin.xyz, [1.0, 0.0, 0.0]);
    let rod = of("<geom type=\"cylinder\" size=\".1\" fromto=\"0 0 0 2 0 0\" mass=\"3\"/>");
    near(rod.tensor[(1, 1)], 3.0 * (0.01 / 4.0 + 4.0 / 12.0));
    assert_eq!(rod.origin.xyz, [1.0, 0.0, 0.0]);
    let capsule = of("<geom type=\"capsule\" size=\".1 .2\"/>");
    near(capsule.mass, 1000.0 * (PI * 0.01 * 0.4 + 4.0 / 3.0 * PI * 0.001));
    let two = of("<geom size=\".1\" mass=\"1\" pos=\"1 0 0\"/><geom size=\".1\" mass=\"3\" pos=\"-1 0 0\"/>");
    assert_eq!((two.mass, two.origin.xyz), (4.0, [-0.5, 0.0, 0.0]));
    near(two.tensor[(1, 1)], 4.0 * 0.004 + 1.5 * 1.5 + 3.0 * 0.25);
}

#[test]
fn what_the_compiler_asks_of_masses() {
    let with = |compiler: &str| {
        read(&format!(
            "<compiler {compiler}/><worldbody><body name=\"a\"><inertial pos=\"0 0 0\" mass=\"1\" diaginertia=\"1 1 4\"/>
            <geom size=\".1\" mass=\"2\" group=\"4\"/></body></worldbody>"
        ))
    };
    let mass = |robot: &Robot| robot.links[0].inertial.as_ref().unwrap().mass;
    assert_eq!(mass(&with("")), 1.0);
    assert_eq!(mass(&with("inertiafromgeom=\"true\"")), 2.0);
    assert!(with("inertiafromgeom=\"true\" inertiagrouprange=\"0 3\"").links[0].inertial.is_none());
    assert_eq!(mass(&with("settotalmass=\"5\"")), 5.0);
    assert_eq!(mass(&with("boundmass=\"3\"")), 3.0);
    let balanced = with("balanceinertia=\"true\"");
    assert!((balanced.links[0].inertial.as_ref().unwrap().tensor[(2, 2)] - 2.0).abs() < 1e-15);
    assert!(balanced.notes.iter().any(|note| note.to_string().contains("balanceinertia")));
}

#[test]
fn couplings_and_what_is_none() {
    let robot = read(
        r#"<worldbody><body name="r"><body name="a"><joint name="a" ref="10"/></body><body name="b"><joint name="b" ref="20"/></body>
        <body name="c"><joint name="c"/></body></body></worldbody>
        <equality><joint joint1="b" joint2="a" polycoef=".1 2 0 0 0"/><joint joint1="c" joint2="a" polycoef="0 1 1 0 0"/>
        <connect body1="a" body2="c" anchor="0 0 0"/></equality>"#,
    );
    let mimic = robot.joints[robot.joint_index("b").unwrap()].mimic.clone().unwrap();
    assert_eq!((mimic.joint.as_str(), mimic.multiplier), ("a", 2.0));
    assert!((mimic.offset - (0.1 + 20f64.to_radians() - 2.0 * 10f64.to_radians())).abs() < 1e-15);
    assert!(robot.joints[robot.joint_index("c").unwrap()].mimic.is_none());
    let kept: Vec<&str> = robot.source.kept().iter().map(|kept| kept.loss.what.as_str()).collect();
    assert_eq!(kept, ["<joint>", "<connect>"]);
    assert!(robot.source.kept()[0].text.contains("polycoef=\"0 1 1 0 0\""));
}

#[test]
fn forces_of_joints_and_actuators() {
    let robot = read(
        r#"<worldbody><body name="r"><body name="a"><joint name="a" actuatorfrcrange="-3 2" damping=".5" frictionloss=".1"/></body>
        <body name="b"><joint name="b"/></body><body name="c"><joint name="c"/></body></body></worldbody>
        <actuator><position joint="a" forcerange="-9 9"/><motor joint="b" ctrlrange="-2 2" gear="50"/>
        <velocity joint="c" ctrlrange="-4 4"/></actuator>"#,
    );
    let limits = |name: &str| robot.joints[robot.joint_index(name).unwrap()].limits;
    assert_eq!((limits("a").effort, limits("b").effort, limits("c").velocity), (Some(3.0), Some(100.0), Some(4.0)));
    assert_eq!(robot.joints[0].dynamics().friction, 0.1);
}

#[test]
fn sites_are_frames_and_shapes_are_seen_or_touched() {
    let robot = read(
        r#"<asset><mesh name="m" file="m.stl" scale="2 2 2" refpos="1 0 0"/></asset><worldbody><body name="b">
        <site name="tcp" pos="0 0 1"/><geom type="mesh" mesh="m" contype="0" conaffinity="0"/><geom size=".1" group="3"/>
        <geom type="plane" size="1 1 1"/></body></worldbody>"#,
    );
    assert_eq!(robot.links[1].name, "tcp");
    assert_eq!(robot.joints[0].origin.xyz, [0.0, 0.0, 1.0]);
    let (visual, collision) = (&robot.links[0].visuals, &robot.links[0].collisions);
    assert_eq!(visual[0].geometry, Geometry::Mesh { filename: "m.stl".into(), scale: [2.0; 3] });
    assert_eq!(visual[0].origin.xyz, [-2.0, 0.0, 0.0]);
    assert_eq!((visual.len(), collision.len()), (1, 1));
    assert!(robot.source.kept().iter().any(|kept| kept.loss.what == "<geom>" && kept.text.contains("plane")));
    // The mesh's file gives no mass here, which is said.
    assert!(
        robot
            .notes
            .iter()
            .any(|note| matches!(note, Note::Corrected { what, .. } if what.contains("mass is not known")))
    );
}

#[test]
fn frames_move_what_stands_in_them() {
    let robot = read(
        "<worldbody><body name=\"r\"><frame pos=\"1 0 0\" euler=\"0 0 90\"><body name=\"b\" pos=\"1 0 0\"/></frame></body></worldbody>",
    );
    assert!((robot.joints[0].origin.pose().translation.vector - Vector3::new(1.0, 1.0, 0.0)).norm() < 1e-15);
}

#[test]
fn included_files_stand_in_their_place() {
    let main = "<mujoco>\n<include file=\"arm.xml\"/>\n</mujoco>";
    let arm =
        "<mujocoinclude>\n<worldbody>\n<body name=\"a\">\n<joint axis=\"0 0 0\"/></body></worldbody></mujocoinclude>";
    let mut files = |name: &str| if name == "arm.xml" { Ok(arm.into()) } else { Err("none".to_owned()) };
    let error = denavit_mjcf::read("main.xml", main, &mut files).unwrap_err();
    assert_eq!(error.to_string(), "arm.xml:4: <joint>: its axis has length 0; write a direction such as 0 0 1");
}

/// One message with file, line, element and what to do.
#[test]
fn bad_input() {
    let body = |content: &str| refused(&format!("<worldbody><body name=\"b\">{content}</body></worldbody>"));
    for (found, expected) in [
        (
            body("<joint range=\"1 x\"/>"),
            "m.xml:2: <joint>: range=\"1 x\": \"x\" is not a number; write a finite number",
        ),
        (body("<joint range=\"1\"/>"), "m.xml:2: <joint>: range=\"1\" has 1 number(s); write 2"),
        (
            body("<joint type=\"screw\"/>"),
            "m.xml:2: <joint>: type=\"screw\" is not a joint type; write hinge, slide, ball or free",
        ),
        (body("<geom class=\"x\" size=\"1\"/>"), "m.xml:2: <geom>: there is no class \"x\"; define it in <default>"),
        (body("<geom type=\"mesh\" mesh=\"x\"/>"), "m.xml:2: <geom>: there is no mesh \"x\"; define it in <asset>"),
        (
            body("<geom type=\"box\" size=\"1 1\"/>"),
            "m.xml:2: <geom>: a box needs 3 positive size(s), m; write size=\"…\"",
        ),
        (
            body("<site name=\"s\" quat=\"0 0 0 0\"/>"),
            "m.xml:2: site \"s\": quat has length 0; write w x y z of a rotation, such as 1 0 0 0",
        ),
        (body("<inertial pos=\"0 0 0\"/>"), "m.xml:2: <inertial>: has no mass; write mass=\"…\" in kg"),
        (
            refused("<include file=\"gone.xml\"/>"),
            "m.xml:2: <include>: includes gone.xml, which cannot be read: there is no gone.xml; add the file",
        ),
        (
            refused("<compiler angle=\"grad\"/><worldbody/>"),
            "m.xml:2: <compiler>: angle=\"grad\" is not a unit; write degree or radian",
        ),
        (refused(""), "m.xml:1: <mujoco>: has no <body> in its <worldbody>; name the file that holds the robot"),
    ] {
        assert_eq!(found.lines().next(), Some(expected));
    }
    assert!(body("<replicate count=\"3\"/>").contains("mj_saveLastXML"));
    let broken = denavit_mjcf::read("m.xml", "<mujoco>", &mut no_files).unwrap_err().to_string();
    assert!(broken.starts_with("m.xml:1: file: not well-formed XML"), "{broken}");
}

/// Whatever the reader does not know is reported, wherever it stands.
#[test]
fn something_unknown_in_every_position_is_reported() {
    const MODEL: &str = r#"<mujoco model="m"><compiler angle="radian"/><default><joint damping="1"/><default class="c"><geom size="1"/></default></default>
<asset><mesh name="m" file="m.stl"/></asset><worldbody><body name="a"><freejoint/><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>
<frame pos="0 0 1"><site name="s"/></frame><geom name="g" type="box" size="1 1 1"/><body name="b"><joint name="j"/></body></body></worldbody>
<equality/><keyframe/></mujoco>"#;
    let read = |text: &str| {
        let urdf = denavit_mjcf::read("m.xml", text, &mut no_files).unwrap_or_else(|error| panic!("{error}\n{text}"));
        urdf::read("m.xml", &urdf).unwrap()
    };
    assert_eq!(read(MODEL).inventory().reported().count(), 0, "{:?}", read(MODEL).inventory());
    let mut places = 0;
    for (at, _) in MODEL.match_indices('<').filter(|(at, _)| !MODEL[at + 1..].starts_with(['/', '?'])) {
        let end = at + MODEL[at..].find([' ', '/', '>']).unwrap();
        let tag = &MODEL[at + 1..end];
        let attribute = format!("{} unheard_of=\"1\"{}", &MODEL[..end], &MODEL[end..]);
        let known_whole = ["keyframe", "equality", "asset", "worldbody"].contains(&tag);
        if !known_whole {
            assert!(
                read(&attribute).inventory().reported().any(|item| item.what.contains("unheard_of")),
                "{attribute}"
            );
            places += 1;
        }
        let close = at + MODEL[at..].find('>').unwrap();
        if !MODEL[..close].ends_with('/') {
            let element = format!("{}<unheard_of/>{}", &MODEL[..=close], &MODEL[close + 1..]);
            let found = read(&element).inventory();
            assert!(found.items.iter().any(|item| item.what.contains("unheard_of")), "{element}");
            places += 1;
        }
    }
    assert!(places > 15, "{places}");
}

/// The mass and principal moments that MuJoCo 4.0.0 compiles of the same.
#[test]
fn shells_weigh_what_mujoco_says() {
    for (geom, mass, [x, y, z]) in [
        ("type=\"sphere\" size=\".3\"", 2.261946710584651, [0.1357168, 0.1357168, 0.1357168]),
        ("type=\"box\" size=\".1 .2 .3\"", 1.76, [0.10826667, 0.08426667, 0.04853333]),
        ("type=\"cylinder\" size=\".1 .3\"", 0.879645943005142, [0.03801327, 0.03801327, 0.00816814]),
        ("type=\"capsule\" size=\".1 .3\"", 1.0053096491487339, [0.05822418, 0.05822418, 0.00921534]),
        ("type=\"ellipsoid\" size=\".1 .2 .3\"", 0.9794386666743462, [0.03615035, 0.02813673, 0.01620536]),
    ] {
        let robot = body("", &format!("<joint/><geom {geom} shellinertia=\"true\" density=\"2\"/>"));
        let inertial = robot.links.iter().find(|link| link.name == "b").unwrap().inertial.as_ref().unwrap();
        assert!((inertial.mass - mass).abs() < 1e-14, "{geom}: {}", inertial.mass);
        for (index, moment) in [x, y, z].into_iter().enumerate() {
            assert!((inertial.tensor[(index, index)] - moment).abs() < 6e-9, "{geom}: {}", inertial.tensor);
        }
    }
}

/// A body like an L, whose hull is more than it: the figures are those that MuJoCo 4.0.0 compiles.
#[test]
fn a_convex_inertia_is_that_of_the_hull() {
    const VERTICES: &str = "0 0 0 .25 0 0 .25 .125 0 .125 .125 0 .125 .25 0 0 .25 0 0 0 .125 .25 0 .125 .25 .125 .125 .125 .125 .125 \
                            .125 .25 .125 0 .25 .125";
    const FACES: &str = "3 1 0 3 2 1 5 3 0 5 4 3 6 7 9 7 8 9 6 9 11 9 10 11 0 1 7 0 7 6 1 2 8 1 8 7 2 3 9 2 9 8 3 4 10 3 10 9 4 5 11 \
                         4 11 10 5 0 6 5 6 11";
    let model = |inertia: &str| {
        format!(
            "<asset><mesh name=\"l\" inertia=\"{inertia}\" vertex=\"{VERTICES}\" face=\"{FACES}\"/></asset>
             <worldbody><body name=\"b\"><joint/><geom type=\"mesh\" mesh=\"l\"/></body></worldbody>"
        )
    };
    for (inertia, mass, along, xx, xy, zz) in [
        ("convex", 6.835_937_5, 0.113_095_24, 0.040_992_86, 0.007_326_64, 0.064_183_80),
        ("exact", 5.859_375, 0.104_166_67, 0.035_603_84, 0.010_172_53, 0.055_948_89),
    ] {
        let robot = read(&model(inertia));
        let inertial = robot.links.iter().find(|link| link.name == "b").unwrap().inertial.as_ref().unwrap();
        let (centre, tensor) = (inertial.origin.xyz, inertial.tensor);
        assert!((inertial.mass - mass).abs() < 1e-12, "{inertia}: {}", inertial.mass);
        assert!((centre[0] - along).abs() < 6e-9 && (centre[2] - 0.0625).abs() < 1e-12, "{inertia}: {centre:?}");
        for (is, stated) in [(tensor[(0, 0)], xx), (tensor[(0, 1)], xy), (tensor[(2, 2)], zz)] {
            assert!((is - stated).abs() < 6e-9, "{inertia}: {tensor}");
        }
    }
    assert!(refused(&model("hull")).contains("write convex, exact, legacy or shell"));
}

/// Six corners and eight faces in MuJoCo's own format; the figures are those that MuJoCo 4.0.0 compiles.
#[test]
fn meshes_of_mujocos_own_format_weigh_what_mujoco_says() {
    let corners: [[f32; 3]; 6] =
        [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0], [0.5, 0.5, 0.2], [0.5, 0.5, -1.0]];
    let faces: [[i32; 3]; 8] = [[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4], [1, 0, 5], [2, 1, 5], [3, 2, 5], [0, 3, 5]];
    let mut bytes: Vec<u8> = [6, 0, 0, 8_i32].iter().flat_map(|count| count.to_le_bytes()).collect();
    bytes.extend(corners.iter().flatten().flat_map(|number| number.to_le_bytes()));
    bytes.extend(faces.iter().flatten().flat_map(|number| number.to_le_bytes()));
    for (inertia, mass, [x, y, z]) in [
        ("legacy", 400.0, [37.6, 37.6, 40.0]),
        ("exact", 400.0, [37.6, 37.6, 40.0]),
        ("shell", 3313.100941140352, [519.01639929, 519.01639929, 552.18349019]),
    ] {
        let text = format!(
            "<mujoco><asset><mesh name=\"m\" file=\"m.msh\" inertia=\"{inertia}\"/></asset><worldbody><body name=\"b\"><freejoint/>\
             <geom type=\"mesh\" mesh=\"m\"/></body></worldbody></mujoco>"
        );
        let urdf = denavit_mjcf::read("m.xml", &text, &mut |_| Ok(bytes.clone())).unwrap();
        let robot = urdf::read("m.xml", &urdf).unwrap();
        let inertial = robot.links.iter().find_map(|link| link.inertial.as_ref()).unwrap();
        // Corners are numbers of 32 bits.
        assert!((inertial.mass / mass - 1.0).abs() < 1e-8, "{inertia}: {}", inertial.mass);
        for (index, moment) in [x, y, z].into_iter().enumerate() {
            assert!((inertial.tensor[(index, index)] / moment - 1.0).abs() < 1e-7, "{inertia}: {}", inertial.tensor);
        }
        let mut broken = bytes.clone();
        broken.truncate(100);
        let urdf = denavit_mjcf::read("m.xml", &text, &mut |_| Ok(broken.clone())).unwrap();
        assert!(urdf.contains("not a valid MuJoCo MSH file"), "{urdf}");
    }
}
