//! What is compared by what it means: followers through their drivers' senses and zeros, sensors where they sit, angles
//! and axes as they were meant.

use denavit_compare::{Comparison, Options, Subject, Verdict, compare, fingerprint, fingerprint_as};
use denavit_model::{Reading, Robot, urdf};

fn read(text: &str) -> Robot {
    urdf::read("r.urdf", text).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

fn found(a: &str, b: &str, options: &Options) -> Comparison {
    let (a, b) = (read(a), read(b));
    compare(&Subject::Robot(&a), &Subject::Robot(&b), options).unwrap()
}

fn same(a: &str, b: &str) -> bool {
    found(a, b, &Options::default()).verdict == Verdict::Same
}

fn print(text: &str) -> denavit_compare::Fingerprint {
    fingerprint(&Subject::Robot(&read(text)), 1e-6)
}

/// Same by diff, and by fingerprint.
#[track_caller]
fn assert_same(a: &str, b: &str) {
    let found = found(a, b, &Options::default());
    assert_eq!(found.verdict, Verdict::Same, "{:?} {:?}\n{b}", found.joints, found.parts);
    assert!(print(a).matches(&print(b).to_string()), "{a}\n{b}");
}

/// Different by diff, and by fingerprint.
#[track_caller]
fn assert_different(a: &str, b: &str) {
    assert!(!same(a, b), "{a}\n{b}");
    assert!(!print(a).matches(&print(b).to_string()), "{a}\n{b}");
}

/// A driver and a follower: sense and zero of each, and what the mimic states.
struct Crank {
    driver: (f64, f64),
    follower: (f64, f64),
    mimic: (f64, f64),
}

impl Crank {
    /// q_f = -0.8 q_d + 0.3, both senses 1, both zeros 0.
    const ORIGINAL: Self = Self { driver: (1.0, 0.0), follower: (1.0, 0.0), mimic: (-0.8, 0.3) };

    fn text(&self) -> String {
        let joint = |(sense, zero): (f64, f64), (lower, upper): (f64, f64)| {
            let ends = [sense * (lower - zero), sense * (upper - zero)];
            let (lower, upper) = (ends[0].min(ends[1]), ends[0].max(ends[1]));
            format!(
                "<axis xyz=\"0 {sense} 0\"/><limit lower=\"{lower}\" upper=\"{upper}\" effort=\"1\" velocity=\"1\"/>"
            )
        };
        let (drive, follow) = (joint(self.driver, (-0.5, 1.0)), joint(self.follower, (-2.0, 2.0)));
        let (Crank { mimic: (factor, offset), .. }, zd, zf) = (self, self.driver.1, self.follower.1);
        format!(
            r#"<robot name="m"><link name="base"/><link name="crank"/><link name="rod"/><link name="tip"/>
            <joint name="drive" type="revolute"><origin xyz="0 0 0.1" rpy="0 {zd} 0"/>{drive}<parent link="base"/>
              <child link="crank"/></joint>
            <joint name="follow" type="revolute"><origin xyz="0.2 0 0" rpy="0 {zf} 0"/>{follow}
              <mimic joint="drive" multiplier="{factor}" offset="{offset}"/><parent link="crank"/><child link="rod"/></joint>
            <joint name="t" type="fixed"><origin xyz="0.15 0 0.02"/><parent link="rod"/><child link="tip"/></joint></robot>"#
        )
    }

    /// What the mimic must state so that both move as in the original.
    ///
    /// A joint of sense s with its zero at z of the original's values has the value s (q - z).
    fn right(mut self) -> Self {
        let (factor, offset) = Self::ORIGINAL.mimic;
        let ((sd, zd), (sf, zf)) = (self.driver, self.follower);
        self.mimic = (sf * factor * sd, sf * (factor * zd + offset - zf));
        self
    }
}

#[test]
fn followers_are_compared_through_the_senses_and_zeros_that_are_free() {
    let options = Options { up_to_zeros: true, ..Options::default() };
    let original = Crank::ORIGINAL.text();
    for driver in [(1.0, 0.0), (-1.0, 0.0), (1.0, 0.35), (-1.0, 0.35)] {
        for follower in [(1.0, 0.0), (-1.0, 0.0), (1.0, -0.2), (-1.0, -0.2)] {
            let moved = Crank { driver, follower, mimic: Crank::ORIGINAL.mimic };
            let stale = moved.text();
            let right = moved.right().text();
            let free = found(&original, &right, &options);
            assert_eq!(free.verdict, Verdict::Same, "{driver:?} {follower:?}: {:?}", free.joints);
            let worst = free.largest().unwrap().sampled_m;
            assert!(worst < 1e-9, "{driver:?} {follower:?}: {worst}");
            if stale == right {
                continue;
            }
            let wrong = found(&original, &stale, &options);
            assert_eq!(wrong.verdict, Verdict::Different, "{driver:?} {follower:?}: {:?}", wrong.joints);
            assert!(wrong.largest().unwrap().sampled_m > 1e-3, "{driver:?} {follower:?}");
        }
    }
}

#[test]
fn a_follower_of_a_follower_follows_the_driver() {
    let through = |driver: &str, factor: f64, offset: f64| {
        format!(
            r#"<robot name="r"><link name="a"/><link name="b"/><link name="c"/><link name="d"/>
            <joint name="j" type="revolute"><axis xyz="0 0 1"/><limit lower="-1" upper="1"/><parent link="a"/><child link="b"/></joint>
            <joint name="k" type="revolute"><origin xyz="1 0 0"/><axis xyz="0 0 1"/><limit lower="-9" upper="9"/><parent link="b"/><child link="c"/>
              <mimic joint="j" multiplier="2" offset="0.1"/></joint>
            <joint name="l" type="revolute"><origin xyz="1 0 0"/><axis xyz="0 0 1"/><limit lower="-9" upper="9"/><parent link="c"/><child link="d"/>
              <mimic joint="{driver}" multiplier="{factor}" offset="{offset}"/></joint></robot>"#
        )
    };
    assert_same(&through("k", 3.0, 0.2), &through("j", 6.0, 0.5));
    assert_different(&through("k", 3.0, 0.2), &through("j", 6.0, 0.2));
}

/// An arm whose link frame sits `up` along the joint's axis and turned by `turn` about it; the sensor states `pose`.
fn reframed(up: f64, turn: f64, further: &str) -> String {
    let (s, c) = (-turn).sin_cos();
    let (x, y) = (0.1 * c, 0.1 * s);
    format!(
        r#"<robot name="r"><link name="base"/><link name="arm"><visual><origin xyz="{x} {y} {z}" rpy="0 0 {back}"/>
        <geometry><box size="0.4 0.1 0.1"/></geometry></visual></link><link name="fore"/>
        <joint name="j" type="revolute"><origin xyz="0 0 {at}" rpy="0 0 {turn}"/><axis xyz="0 0 1"/>
          <limit lower="-1" upper="1" effort="1" velocity="1"/><parent link="base"/><child link="arm"/></joint>
        <joint name="f" type="fixed"><origin xyz="{x} {y} {z}" rpy="0 0 {back}"/><parent link="arm"/><child link="fore"/></joint>
        {further}</robot>"#,
        z = -up,
        at = 0.2 + up,
        back = -turn,
    )
}

/// Where (0.5, 0, 0.1) of the frame that is not moved is in the moved one, and the yaw there.
fn there(up: f64, turn: f64) -> (f64, f64, f64, f64) {
    let (s, c) = (-turn).sin_cos();
    (0.5 * c, 0.5 * s, 0.1 - up, -turn)
}

#[test]
fn what_sits_in_a_link_s_frame_is_compared_where_it_is_on_the_robot() {
    type Kind = fn(f64, f64, f64, f64) -> String;
    let kinds: [Kind; 9] = [
        |x, y, z, yaw| {
            format!("<gazebo reference=\"arm\"><sensor name=\"s\"><pose>{x} {y} {z} 0 0 {yaw}</pose></sensor></gazebo>")
        },
        |x, y, z, yaw| {
            let yaw = yaw.to_degrees();
            format!(
                "<gazebo reference=\"arm\"><light name=\"s\"><pose degrees=\"true\">{x} {y} {z} 0 0 {yaw}</pose></light></gazebo>"
            )
        },
        |x, y, z, yaw| {
            let (s, c) = (yaw / 2.0).sin_cos();
            format!(
                "<gazebo reference=\"arm\"><sensor name=\"s\"><pose rotation_format=\"quat_xyzw\">{x} {y} {z} 0 0 {s} {c}</pose></sensor></gazebo>"
            )
        },
        |x, y, z, yaw| {
            format!("<gazebo reference=\"j\"><sensor name=\"s\"><pose>{x} {y} {z} 0 0 {yaw}</pose></sensor></gazebo>")
        },
        |x, y, z, yaw| {
            format!("<sensor name=\"s\"><parent link=\"arm\"/><origin xyz=\"{x} {y} {z}\" rpy=\"0 0 {yaw}\"/></sensor>")
        },
        |x, y, z, yaw| {
            format!(
                "<gazebo><plugin name=\"p\"><bodyName>arm</bodyName><xyzOffset>{x} {y} {z}</xyzOffset><rpyOffset>0 0 {yaw}</rpyOffset></plugin></gazebo>"
            )
        },
        |x, y, z, yaw| format!("<frame name=\"s\" link=\"arm\" xyz=\"{x} {y} {z}\" rpy=\"0 0 {yaw}\"/>"),
        |x, y, z, yaw| {
            format!(
                "<loop_joint name=\"s\" type=\"revolute\"><link1 link=\"arm\" xyz=\"{x} {y} {z}\" rpy=\"0 0 {yaw}\"/><link2 link=\"base\"/></loop_joint>"
            )
        },
        |x, y, z, yaw| {
            format!(
                "<constraint name=\"s\"><parent link=\"arm\"/><parent_origin xyz=\"{x} {y} {z}\" rpy=\"0 0 {yaw}\"/><child link=\"base\"/></constraint>"
            )
        },
    ];
    for kind in kinds {
        let original = reframed(0.0, 0.0, &kind(0.5, 0.0, 0.1, 0.0));
        for (up, turn) in [(0.0, 0.0), (1.0, 0.0), (0.12, 0.7), (-0.3, -2.5)] {
            let (x, y, z, yaw) = there(up, turn);
            assert_same(&original, &reframed(up, turn, &kind(x, y, z, yaw)));
            if (up, turn) != (0.0, 0.0) {
                assert_different(&original, &reframed(up, turn, &kind(0.5, 0.0, 0.1, 0.0)));
            }
            assert_different(&original, &reframed(up, turn, &kind(x, y, z + 1e-5, yaw)));
            assert_different(&original, &reframed(up, turn, &kind(x, y, z, yaw + 1e-4)));
        }
    }
}

#[test]
fn a_sensor_without_a_pose_sits_at_its_link_and_one_relative_to_another_frame_at_that() {
    let sensor =
        |pose: &str| format!("<gazebo reference=\"arm\"><sensor name=\"s\">{pose}<rate>1</rate></sensor></gazebo>");
    assert_same(&reframed(0.0, 0.0, &sensor("")), &reframed(0.0, 0.0, &sensor("<pose>0 0 0 0 0 0</pose>")));
    assert_same(&reframed(0.0, 0.0, &sensor("")), &reframed(1.0, 0.0, &sensor("<pose>0 0 -1 0 0 0</pose>")));
    assert_different(&reframed(0.0, 0.0, &sensor("")), &reframed(1.0, 0.0, &sensor("")));
    // The other link's frame stays where it is on the robot.
    let at_fore = sensor("<pose relative_to=\"fore\">0.1 0 0 0 0 0</pose>");
    assert_same(&reframed(0.0, 0.0, &at_fore), &reframed(1.0, 0.4, &at_fore));
    assert_same(&reframed(0.0, 0.0, &at_fore), &reframed(0.0, 0.0, &sensor("<pose>0.2 0 0 0 0 0</pose>")));
    let in_world = sensor("<pose frame=\"world\">0.1 0 0 0 0 0</pose>");
    assert_same(&reframed(0.0, 0.0, &in_world), &reframed(1.0, 0.4, &in_world));
    // A frame that nothing has: its name and its numbers count as text.
    let nowhere = |x: f64| sensor(&format!("<pose relative_to=\"nowhere\">{x} 0 0 0 0 0</pose>"));
    assert_different(&reframed(0.0, 0.0, &nowhere(0.1)), &reframed(0.0, 0.0, &nowhere(0.2)));
}

const CONTINUOUS: &str = r#"<robot name="r"><link name="a"/><link name="b"/>
    <joint name="j" type="continuous"><axis xyz="0 0 1"/><limit lower="-6" upper="6" effort="1" velocity="1"/>
    <calibration rising="0.25"/><parent link="a"/><child link="b"/></joint></robot>"#;

#[test]
fn limits_of_continuous_joints_and_calibration_count() {
    assert_different(CONTINUOUS, &CONTINUOUS.replace("upper=\"6\"", "upper=\"5\""));
    assert_different(CONTINUOUS, &CONTINUOUS.replace("lower=\"-6\" upper=\"6\"", ""));
    assert_different(CONTINUOUS, &CONTINUOUS.replace("rising=\"0.25\"", "falling=\"0.25\""));
    let options = Options { up_to_zeros: true, ..Options::default() };
    let reversed = CONTINUOUS.replace("0 0 1", "0 0 -1").replace("rising=\"0.25\"", "falling=\"-0.25\"");
    let free = found(CONTINUOUS, &reversed, &options);
    assert_eq!(free.verdict, Verdict::Same, "{:?}", free.joints);
    let kept = CONTINUOUS.replace("0 0 1", "0 0 -1");
    assert_eq!(found(CONTINUOUS, &kept, &options).verdict, Verdict::Different);
    assert!(found(CONTINUOUS, CONTINUOUS, &options).notes[0].starts_with("both: joint \"j\": <calibration>"));
}

#[test]
fn sizes_of_shapes_are_equal_within_the_tolerance() {
    let with = |shape: &str| {
        format!("<robot name=\"r\"><link name=\"a\"><visual><geometry>{shape}</geometry></visual></link></robot>")
    };
    for (one, other, another) in [
        (
            "<box size=\"0.1 0.2 0.3\"/>",
            "<box size=\"0.1 0.2 0.30000000000000004\"/>",
            "<box size=\"0.1 0.2 0.300002\"/>",
        ),
        ("<sphere radius=\"0.1\"/>", "<sphere radius=\"0.10000000000000002\"/>", "<sphere radius=\"0.100002\"/>"),
        (
            "<cylinder radius=\"0.1\" length=\"1\"/>",
            "<cylinder radius=\"0.1\" length=\"1.0000000000000002\"/>",
            "<cylinder radius=\"0.1\" length=\"1.000002\"/>",
        ),
        (
            "<capsule radius=\"0.1\" length=\"1\"/>",
            "<capsule radius=\"0.1\" length=\"1.0000000000000002\"/>",
            "<capsule radius=\"0.1\" length=\"1.000002\"/>",
        ),
        (
            "<mesh filename=\"m\" scale=\"0.1 1 1\"/>",
            "<mesh filename=\"m\" scale=\"0.10000000000000002 1 1\"/>",
            "<mesh filename=\"m\" scale=\"0.100002 1 1\"/>",
        ),
    ] {
        assert_same(&with(one), &with(other));
        assert_different(&with(one), &with(another));
    }
}

#[test]
fn angles_and_axes_are_read_as_meant_unless_asked_otherwise() {
    let arm = |rpy: &str, axis: &str| {
        format!(
            r#"<robot name="r"><link name="a"/><link name="b"/><link name="c"/>
            <joint name="j" type="continuous"><origin xyz="1 0 0" rpy="{rpy}"/><axis xyz="{axis}"/><parent link="a"/><child link="b"/></joint>
            <joint name="t" type="fixed"><origin xyz="1 0 0"/><parent link="b"/><child link="c"/></joint></robot>"#
        )
    };
    let exact = arm("1.5707963267948966 0 0", "0 0 -1");
    for (rpy, axis) in [
        ("1.5708 0 0", "0 0 -1"),
        ("1.57 0 0", "0 0 -1"),
        ("1.5707963 0 0", "2.2e-08 -4.4e-08 -1.0"),
        ("1.570796 0 0", "0 1e-5 -1"),
    ] {
        let other = arm(rpy, axis);
        assert_same(&exact, &other);
        let options = Options { reading: Reading::AsWritten, ..Options::default() };
        if rpy == "1.5708 0 0" || axis.contains("e-5") {
            assert_eq!(found(&exact, &other, &options).verdict, Verdict::Different, "{rpy} {axis}");
            let written = |text: &str| fingerprint_as(&Subject::Robot(&read(text)), 1e-6, Reading::AsWritten);
            assert!(!written(&exact).matches(&written(&other).to_string()));
        }
    }
    assert_different(&exact, &arm("1.5705123 0 0", "0 0 -1"));
    assert_different(&exact, &arm("1.5707963267948966 0 0", "0 1e-4 -1"));
}

#[test]
fn the_order_in_which_an_element_says_things_does_not_count() {
    let with =
        |inside: &str| format!("<robot name=\"r\"><link name=\"a\"/><gazebo reference=\"a\">{inside}</gazebo></robot>");
    assert_same(&with("<mu1>1</mu1><mu2>2</mu2>"), &with("<mu2>2.0</mu2><mu1>1</mu1>"));
}

/// A folder beside the project, where it is there.
fn beside(path: &str) -> Option<std::path::PathBuf> {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared").join(path);
    if !folder.exists() {
        println!("skipped, because ../shared/{path} is not beside this clone");
    }
    folder.exists().then_some(folder)
}

#[test]
fn verdicts_on_real_files_are_right() {
    let free = Options { up_to_zeros: true, ..Options::default() };
    for (folder, options, pairs) in [
        ("origin-quaternion", Options::default(), &[("q", "rpy", true), ("q", "none", false)][..]),
        (
            "mimic-driver-flipped",
            free,
            &[
                ("original", "flipped_right", true),
                ("original", "flipped_stale_mimic", false),
                ("original", "driver_zero_shifted_right", true),
                ("original", "driver_zero_shifted_stale", false),
            ],
        ),
        (
            "sensor-pose-in-reframed-link",
            Options::default(),
            &[("original", "reframed_right", true), ("original", "reframed_sensor_left_behind", false)],
        ),
        ("shape-sizes-compared-exactly", Options::default(), &[("a", "b", true)]),
        (
            "newcomer",
            Options::default(),
            &[("reframed_gazebo_a", "reframed_gazebo_b", false), ("reframed_gazebo_a", "reframed_gazebo_c", true)],
        ),
    ] {
        let Some(folder) = beside(&format!("wild/{folder}")) else { continue };
        for (one, other, same) in pairs {
            let text = |name: &str| std::fs::read_to_string(folder.join(format!("{name}.urdf"))).unwrap();
            let found = found(&text(one), &text(other), &options);
            assert_eq!(found.verdict == Verdict::Same, *same, "{one} {other}: {:?} {:?}", found.joints, found.parts);
        }
    }
}

#[test]
fn no_inertia_is_the_same_however_a_design_program_writes_it() {
    let arm = |ixx: &str| {
        format!(
            "<robot name=\"r\"><link name=\"a\"/><link name=\"b\"><inertial><mass value=\"0.5\"/>
            <inertia ixx=\"{ixx}\" ixy=\"0\" ixz=\"0\" iyy=\"0\" iyz=\"0\" izz=\"0\"/></inertial></link>
            <joint name=\"j\" type=\"continuous\"><origin xyz=\"0 0 1\"/><parent link=\"a\"/><child link=\"b\"/></joint></robot>"
        )
    };
    assert!(same(&arm("-5.42101e-20"), &arm("0")));
    assert!(!same(&arm("1e-9"), &arm("0")));
    // A milligram of a millimetre's radius is no dust.
    assert!(!same(&arm("1e-12"), &arm("0")));
}
