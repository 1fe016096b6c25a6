//! Makers' forms of a calibration: what is written moves as the calibrated chain does, when it is read as its maker reads it.

#![allow(clippy::unwrap_used, reason = "a test stops at what it did not expect")]

use denavit_export::kinematics_yaml::AngleOrder;
use denavit_export::makers::{self, Calibrated, MakerError, Written, named, new_origins};
use denavit_model::nalgebra::{Vector3, Vector6};
use denavit_model::robot::Robot;
use denavit_model::{Chain, Pose, Reading, Screw, se3};
use std::fmt::Write as _;

fn robot(path: &str) -> Robot {
    let path = format!("{}/../../robots/{path}", env!("CARGO_MANIFEST_DIR"));
    denavit_model::urdf::read(&path, &std::fs::read_to_string(&path).unwrap()).unwrap()
}

/// The chain with each axis turned and moved by some tenths of a milliradian and a millimetre, and another tool.
fn as_built(chain: &Chain) -> Chain {
    let small = |k: usize| {
        let number = |n: usize| 4e-4 * (((k * 7 + n * 3) % 11) as f64 / 5.0 - 1.0);
        se3::exp(&Vector6::from_fn(|n, _| number(n)))
    };
    let screws: Vec<Screw> = chain.joints().iter().enumerate().map(|(k, joint)| joint.screw.moved(&small(k))).collect();
    chain.with_geometry(&screws, small(20) * chain.home()).unwrap()
}

/// Largest distance (m) and angle (rad) of two motions over joint readings.
fn apart(a: &Chain, b: impl Fn(&[f64]) -> Pose) -> (f64, f64) {
    let n = a.coordinates().len();
    (0..200).fold((0.0f64, 0.0f64), |largest, sample| {
        let value = |k: usize| 5.0 * (f64::from(sample) * 0.618_033_988_7 * (k as f64 + 1.0).sqrt()).fract() - 2.5;
        let q: Vec<f64> = (0..n).map(value).collect();
        let (turned, moved) = se3::difference(&a.fk(&q), &b(&q));
        (largest.0.max(moved), largest.1.max(turned))
    })
}

fn written(maker: &str, tree: &Robot, chain: &Chain) -> Written {
    written_as(maker, tree, chain, Reading::Intended)
}

fn written_as(maker: &str, tree: &Robot, chain: &Chain, reading: Reading) -> Written {
    let drawn = Some((tree, reading));
    (named(maker).unwrap().render)(&Calibrated { chain, drawn, effects: &[] }).unwrap()
}

#[test]
fn what_is_written_for_a_maker_reads_back_to_the_last_digits() {
    for (maker, path, tip, exact_tip) in [
        ("franka", "franka/panda.urdf", "panda_link8", true),
        ("xarm", "ufactory/xarm7.urdf", "link_eef", false),
        ("ur", "universal_robots/ur5e.urdf", "tool0", false),
    ] {
        let tree = robot(path);
        let tip = if tree.links.iter().any(|link| link.name == tip) { Some(tip) } else { None };
        let chain = as_built(&tree.chain(None, tip, Reading::Intended).unwrap().value);
        let file = written(maker, &tree, &chain);
        let again = makers::read("arm.yaml", "arm", &file.text, AngleOrder::Urdf).unwrap();
        assert_eq!(again.joints().len(), chain.joints().len());
        // What the form has no place for stands between its last frame and the tip, and is said.
        let tool = again.home().inverse() * chain.home();
        assert_eq!(file.left_out.is_empty(), exact_tip, "{maker}: {:?}", file.left_out);
        let (moved, turned) = apart(&chain, |q| if exact_tip { again.fk(q) } else { again.fk(q) * tool });
        assert!(moved < 1e-12 && turned < 1e-12, "{maker}: {moved:e} m, {turned:e} rad");
        // Read and written again it stays, digit for digit.
        let calibrated = Calibrated { chain: &again, drawn: None, effects: &[] };
        let third = (named(maker).unwrap().render)(&calibrated).unwrap();
        let third = makers::read("arm.yaml", "arm", &third.text, AngleOrder::Urdf).unwrap();
        let (moved, _) = apart(&again, |q| third.fk(q) * (third.home().inverse() * again.home()));
        assert!(moved < 1e-12, "{maker}: {moved:e}");
    }
}

#[test]
fn an_arm_as_drawn_gives_the_makers_own_figures() {
    // The figures of franka_description's robots/fer/kinematics.yaml.
    let quarter = std::f64::consts::FRAC_PI_2;
    let published = [
        [0.0, 0.0, 0.333, 0.0, 0.0, 0.0],
        [0.0, 0.0, 0.0, -quarter, 0.0, 0.0],
        [0.0, -0.316, 0.0, quarter, 0.0, 0.0],
        [0.0825, 0.0, 0.0, quarter, 0.0, 0.0],
        [-0.0825, 0.384, 0.0, -quarter, 0.0, 0.0],
        [0.0, 0.0, 0.0, quarter, 0.0, 0.0],
        [0.088, 0.0, 0.0, quarter, 0.0, 0.0],
        [0.0, 0.0, 0.107, 0.0, 0.0, 0.0],
    ];
    let mut text = String::new();
    for (index, origin) in published.iter().enumerate() {
        let _ = writeln!(text, "joint{}:\n  kinematic:", index + 1);
        for (key, value) in ["x", "y", "z", "roll", "pitch", "yaw"].iter().zip(origin) {
            let _ = writeln!(text, "    {key}: {value}");
        }
    }
    let tree = robot("franka/panda.urdf");
    let chain = tree.chain(None, Some("panda_link8"), Reading::Intended).unwrap().value;
    let read = makers::read("kinematics.yaml", "fer", &text, AngleOrder::Urdf).unwrap();
    let (moved, turned) = apart(&chain, |q| read.fk(q));
    assert!(moved < 1e-14 && turned < 1e-14, "{moved:e} {turned:e}");
    let own: Vec<String> = written("franka", &tree, &chain)
        .text
        .lines()
        .filter(|l| l.contains(": ") && !l.starts_with('#'))
        .map(str::to_owned)
        .collect();
    let numbers = |lines: Vec<String>| -> Vec<f64> {
        lines.iter().filter_map(|line| line.rsplit(": ").next()?.parse().ok()).collect()
    };
    let published: Vec<f64> = published.into_iter().flatten().collect();
    for (own, published) in numbers(own).iter().zip(&published) {
        assert!((own - published).abs() < 1e-15, "{own} {published}");
    }
    // What stays between flange and tool centre point is said, and no part of the file.
    if tree.links.iter().any(|link| link.name == "panda_hand_tcp") {
        let hand = tree.chain(None, Some("panda_hand_tcp"), Reading::Intended).unwrap().value;
        let with_hand = written("franka", &tree, &hand);
        assert!(with_hand.left_out[0].contains("ends at the flange; from there to panda_hand_tcp"), "{with_hand:?}");
    }
}

/// As `updateURDF` of robot_calibration does it: origin' = origin · offset, the rotation an axis times its angle.
#[test]
fn offsets_applied_as_robot_calibration_does_give_the_calibrated_arm() {
    for (path, tip) in [("universal_robots/ur5e.urdf", "tool0"), ("franka/panda.urdf", "panda_link8")] {
        let tree = robot(path);
        let chain = as_built(&tree.chain(None, Some(tip), Reading::AsWritten).unwrap().value);
        let drawn = Some((&tree, Reading::AsWritten));
        let file =
            (named("robot-calibration").unwrap().render)(&Calibrated { chain: &chain, drawn, effects: &[] }).unwrap();
        assert_eq!(file.left_out, Vec::<String>::new());
        let value = |name: &str| -> f64 {
            let line = file.text.lines().find_map(|line| line.strip_prefix(name)?.strip_prefix(": "));
            line.map_or(0.0, |number| number.parse().unwrap())
        };
        let mut changed = tree.clone();
        for joint in &mut changed.joints {
            let [x, y, z, a, b, c] = ["x", "y", "z", "a", "b", "c"].map(|end| value(&format!("{}_{end}", joint.name)));
            let rotation = se3::exp(&Vector6::new(a, b, c, 0.0, 0.0, 0.0)).rotation;
            let offset = se3::pose(rotation, denavit_model::nalgebra::Vector3::new(x, y, z));
            let new = joint.origin.pose() * offset;
            joint.origin.xyz = new.translation.vector.into();
            joint.origin.rpy = se3::rpy_from_rotation(&new.rotation);
            joint.origin.rpy_written = None;
        }
        let again = changed.chain(Some(chain.base()), Some(tip), Reading::AsWritten).unwrap().value;
        let (moved, turned) = apart(&chain, |q| again.fk(q));
        assert!(moved < 1e-10 && turned < 1e-10, "{path}: {moved:e} {turned:e}");
        read_back(&tree, &file.text, &changed);
    }
}

/// The file is read as what was added by hand.
fn read_back(tree: &Robot, text: &str, changed: &Robot) {
    let read = new_origins("origins.yaml", text, tree).unwrap().unwrap();
    assert!(read.notes.is_empty(), "{:?}", read.notes);
    assert!(!read.origins.is_empty());
    for (index, numbers) in read.origins {
        let (turned, moved) = se3::difference(&numbers.pose(), &changed.joints[index].origin.pose());
        assert!(turned < 1e-14 && moved < 1e-14, "{index}: {turned:e} {moved:e}");
    }
}

/// As FIGAROH's own check does it: each number is added to the one that the URDF writes, be it beyond a quarter turn or not.
#[test]
fn numbers_added_to_the_origins_give_the_calibrated_arm() {
    for (path, tip) in [("universal_robots/ur5e.urdf", "tool0"), ("franka/panda.urdf", "panda_link8")] {
        let tree = robot(path);
        let chain = as_built(&tree.chain(None, Some(tip), Reading::AsWritten).unwrap().value);
        let file = written_as("pal", &tree, &chain, Reading::AsWritten);
        assert_eq!(file.left_out, Vec::<String>::new());
        let mut lines = file.text.lines();
        assert_eq!(lines.next(), Some("robot_state_publisher:"));
        assert_eq!(lines.next(), Some("  geometric_calibration:"));
        let mut changed = tree.clone();
        let mut count = 0;
        for line in lines {
            let (key, number) = line.strip_prefix("    ").unwrap().split_once(": ").unwrap();
            let (name, axis) = key.rsplit_once("_d").unwrap();
            let full = format!("{name}_joint");
            let joint = changed.joints.iter_mut().find(|joint| joint.name == full || joint.name == name).unwrap();
            let at = ["x", "y", "z", "roll", "pitch", "yaw"].iter().position(|known| *known == axis).unwrap();
            let number: f64 = number.parse().unwrap();
            assert!(number.abs() < 0.02, "{line}");
            if at < 3 {
                joint.origin.xyz[at] += number;
            } else {
                joint.origin.rpy[at - 3] += number;
            }
            joint.origin.rpy_written = None;
            count += 1;
        }
        assert!(count > 20, "{count}");
        let again = changed.chain(Some(chain.base()), Some(tip), Reading::AsWritten).unwrap().value;
        let (moved, turned) = apart(&chain, |q| again.fk(q));
        assert!(moved < 1e-10 && turned < 1e-10, "{path}: {moved:e} {turned:e}");
        read_back(&tree, &file.text, &changed);
        // Nothing is added to an arm as drawn.
        let drawn = tree.chain(None, Some(tip), Reading::AsWritten).unwrap().value;
        let none = written_as("pal", &tree, &drawn, Reading::AsWritten).text;
        assert_eq!(none, "robot_state_publisher:\n  geometric_calibration: {}\n");
    }
}

#[test]
fn what_a_form_cannot_hold_is_said() {
    let tree = robot("kuka/iiwa14.urdf");
    let chain = tree.chain(None, None, Reading::Intended).unwrap().value;
    let drawn = Some((&tree, Reading::Intended));
    let effects = ["joint_compliance".to_owned()];
    let of =
        |maker: &str, drawn| (named(maker).unwrap().render)(&Calibrated { chain: &chain, drawn, effects: &effects });
    let xarm = of("xarm", None).unwrap();
    assert!(xarm.left_out[0].contains("not joint_compliance"), "{:?}", xarm.left_out);
    // Its second axis is -z of its link: the form has joints about z alone.
    assert!(matches!(of("xarm", drawn), Err(MakerError::NotAboutZ { joint, .. }) if joint == "joint_a2"));
    let rail = robot("kuka/kr16_2_on_rail.urdf");
    let on_rail = rail.chain(None, None, Reading::Intended).unwrap().value;
    let seven = (named("franka").unwrap().render)(&Calibrated { chain: &on_rail, drawn: None, effects: &[] });
    assert!(seven.unwrap_err().to_string().contains("7 joints, 6 of them revolute"));
    assert!(matches!(of("robot-calibration", None), Err(MakerError::NeedsTree { .. })));
    assert!(of("ur", drawn).unwrap_err().to_string().contains("six revolute joints"));
    assert!(matches!(of("pal", None), Err(MakerError::NeedsTree { .. })));
    let kinova = named("kinova").unwrap_err().to_string();
    assert!(kinova.contains("on request, but in an unpublished format"), "{kinova}");
    assert!(kinova.contains("ur, ur-conf, xarm, franka, pal, robot-calibration"), "{kinova}");
    for (text, expected) in [
        ("kinematics:\n  joint1: {x: 0, y: 0}\n", "arm.yaml: kinematics.joint1.z is missing"),
        ("joint1:\n  kinematic: {x: 0, y: 0, z: a}\n", "arm.yaml:2: joint1.kinematic.z is \"a\", not a finite number"),
        ("joints: 3\n", "not a known kinematics file"),
        ("a: [1\n", "not well-formed YAML"),
    ] {
        let error = makers::read("arm.yaml", "arm", text, AngleOrder::Urdf).unwrap_err().to_string();
        assert!(error.contains(expected), "{error}");
    }
}

#[test]
fn golden_files() {
    for (maker, path, tip) in [
        ("franka", "franka/panda.urdf", Some("panda_link8")),
        ("xarm", "ufactory/xarm7.urdf", None),
        ("ur", "universal_robots/ur5e.urdf", Some("tool0")),
        ("robot-calibration", "universal_robots/ur5e.urdf", Some("tool0")),
    ] {
        let tree = robot(path);
        let chain = as_built(&tree.chain(None, tip, Reading::Intended).unwrap().value);
        let file = written(maker, &tree, &chain);
        // The last digits are the processor's.
        let rounded: String = file
            .text
            .lines()
            .map(|line| {
                let number = line.rsplit_once(": ").and_then(|(key, number)| Some((key, number.parse::<f64>().ok()?)));
                number.map_or_else(
                    || line.split(": xyz").next().unwrap().to_owned(),
                    |(key, number)| format!("{key}: {number:.9}"),
                ) + "\n"
            })
            .collect();
        insta::assert_snapshot!(format!("maker_{maker}"), rounded.replace("-0.000000000", "0.000000000"));
    }
}

/// The model's table and the delta D-H that tmr_ros1's `tm_mod_urdf` has as its example, of a real arm.
const TECHMAN: &str = "DHTable={0.,-90.,0.,145.2,0.,-270.,270,-90.,0.,429.,0.,0.,-180.,180.,0.,0.,411.5,0.,0.,-158.,158.,90.,90.,0.,-122.3,0.,\
    -180.,180.,0.,90.,0.,106.,0.,-180.,180.,0.,0.,0.,113.15,0.,-270.,270.}\n\
    DeltaDH={-0.001059821,0.02508766,0.009534874,0.,0.001116668,0.06614932,0.308224,0.0287381,0.06797475,-0.0319523,0.3752921,\
    0.06614756,-0.006998898,0.06792655,-0.06083903,0.02092069,0.02965812,-0.1331249,0.06793034,0.02077797,0.08265772,0.03200645,\
    0.01835932,0.06145732,0.08273286,0.6686108,0.6972408,-0.1793097,-0.0794057,1.425708}";

#[test]
fn techman_s_delta_is_added_to_its_table() {
    use denavit_export::makers::techman;
    use denavit_export::sources::Source;
    assert!(techman::is_one(TECHMAN));
    let Source::Table { table, .. } = techman::read("tm.txt", "tm5-900", TECHMAN).unwrap().source else {
        panic!("a table")
    };
    assert!((table.rows[2].a() - 0.4290287381).abs() < 1e-15);
    assert!((table.rows[6].beta().unwrap() - 1.425708f64.to_radians()).abs() < 1e-15);
    // Of each joint Rz(θ) Tz(d) Tx(a) Rx(α) Ry(β), multiplied out with other means.
    let numbers = |name: &str| -> Vec<f64> {
        let inside = TECHMAN.split(name).nth(1).unwrap().trim_start_matches("={").split('}').next().unwrap();
        inside.split(',').map(|word| word.parse().unwrap()).collect()
    };
    let (model, arm) = (numbers("DHTable"), numbers("DeltaDH"));
    let mut expected = Pose::identity();
    for joint in 0..6 {
        let sum = |place: usize| model[7 * joint + place] + arm[5 * joint + place];
        let turn = |axis: Vector3<f64>, degrees: f64| {
            se3::pose(se3::rotation_about(&axis, degrees.to_radians()), Vector3::zeros())
        };
        let slide = |axis: Vector3<f64>, mm: f64| se3::pose(se3::rotation_from_rpy([0.0; 3]), axis * (mm / 1e3));
        expected *= turn(Vector3::z(), sum(0)) * slide(Vector3::z(), sum(3)) * slide(Vector3::x(), sum(2));
        expected *= turn(Vector3::x(), sum(1)) * turn(Vector3::y(), arm[5 * joint + 4]);
    }
    let (turned, moved) = se3::difference(&expected, &table.fk(&[0.0; 6]));
    assert!(turned < 1e-12 && moved < 1e-12, "{turned} {moved}");
    let Source::Table { table, .. } = techman::read("tm.txt", "tm5-900", &techman::drawn(TECHMAN)).unwrap().source
    else {
        panic!("a table")
    };
    assert_eq!((table.rows[2].a(), table.rows[6].beta().unwrap_or_default()), (0.429, 0.0));
    let short = TECHMAN.replace("1.425708}", "}");
    let error = techman::read("tm.txt", "tm", &short).unwrap_err().to_string();
    assert!(error.contains("DHTable has 42 numbers and DeltaDH 29"), "{error}");
}

#[test]
fn a_controllers_lists_are_those_of_the_calibrated_arm() {
    use denavit_dh::Convention;
    use denavit_dh::matching::{VendorTable, match_table};
    use denavit_export::makers::ur_conf;
    use denavit_export::sources::Source;
    let tree = robot("universal_robots/ur5e.urdf");
    let chain = as_built(&tree.chain(None, Some("tool0"), Reading::Intended).unwrap().value);
    let file = written("ur-conf", &tree, &chain);
    assert!(file.left_out.iter().any(|what| what.contains("flange")), "{:?}", file.left_out);
    let Source::Table { table, .. } = ur_conf::read("arm.conf", "arm", &file.text, Some("ur5e")).unwrap().source else {
        panic!("a table")
    };
    // Base and tool are free, as they are in a controller.
    let found = match_table(&chain, &VendorTable::of(&table, Convention::Distal, false)).unwrap();
    assert!(found.placement.position_error < 1e-9, "{}", found.placement.position_error);
    assert!(found.placement.joints.iter().all(|joint| joint.zero.abs() < 1e-6), "{:?}", found.placement.joints);
}
