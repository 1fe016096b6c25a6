//! Tables, makers' files and other sources of numbers: each is understood or refused, and nothing in them is ignored
//! without a message.

use super::Trial;
use crate::support::denavit_with_input;
use serde_json::Value;
use std::fmt::Write as _;

/// The tip's position at joint values, m, and the messages.
fn tip(trial: &Trial, line: &str) -> ([f64; 3], String) {
    let run = trial.run(&format!("{line} --json"));
    let said = run.stderr.clone();
    let json: Value = serde_json::from_str(&run.succeeded()).unwrap();
    (std::array::from_fn(|k| json["xyz"][k].as_f64().unwrap()), said)
}

fn near(found: [f64; 3], expected: [f64; 3]) {
    assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12), "{found:?} {expected:?}");
}

#[test]
fn a_row_with_d_and_beta_keeps_both() {
    let row = "1,q1,100,0,200,30\n2,q2,50,90,0,0\n";
    let header = "joint,theta,d,alpha,a,beta\n";
    let markdown = "| joint | theta | d | alpha | a | beta |\n|---|---|---|---|---|---|\n| 1 | q1 | 100 | 0 | 200 | 30 |\n| 2 | q2 | 50 | 90 | 0 | 0 |\n";
    let mut trial = Trial::new();
    for convention in ["hayati", "distal"] {
        let says = format!("# convention: {convention}\n# units: mm, deg\n");
        trial = trial
            .with(&format!("{convention}.csv"), &format!("{says}{header}{row}"))
            .with(&format!("{convention}.md"), &format!("{says}\n{markdown}"));
    }
    // Tz(0.1) Tx(0.2) Ry(30°) Tz(0.05)
    let (sine, cosine) = 30f64.to_radians().sin_cos();
    let expected = [0.2 + 0.05 * sine, 0.0, 0.1 + 0.05 * cosine];
    for file in ["hayati.csv", "distal.csv", "hayati.md", "distal.md"] {
        let (found, said) = tip(&trial, &format!("fk {file} --q 0,0"));
        near(found, expected);
        assert_eq!(said, "", "{file}");
    }
    let yaml = "convention: hayati\nunits: mm, deg\nremark: ours\ndh:\n  - {theta: q1, d: 100, alpha: 0, a: 200, beta: 30}\n  - {theta: q2, d: 50, alpha: 90, a: 0, beta: 0, mass: 3}\n";
    let named = "units: mm, deg\nshoulder: {theta: q1, d: 100, alpha: 0, a: 200, beta: 30}\nelbow: {theta: q2, d: 50, alpha: 90, a: 0}\n";
    trial = trial.with("rows.yaml", yaml).with("named.yaml", named).with("bad.yaml", &yaml.replace("mm, deg", "cubit"));
    let (found, said) = tip(&trial, "fk rows.yaml --q 0,0");
    near(found, expected);
    assert!(said.contains("rows.yaml:3: key \"remark\"") && said.contains("column \"mass\""), "{said}");
    near(tip(&trial, "fk named.yaml --table-convention distal --q 0,0").0, expected);
    trial.refuses("table bad.yaml", "bad.yaml:2: units: \"cubit\" is not a known unit");
    // There and back in every format that is also a source, and as URDF.
    for (format, name) in [("json", "again.json"), ("csv", "again.csv"), ("md", "again.md")] {
        trial.run(&format!("table hayati.csv --format {format} --units m,rad -o {name}")).succeeded();
        // A table is printed to 1e-9 m and 1e-9 rad.
        let (found, _) = tip(&trial, &format!("fk {name} --q 0,0"));
        assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 2e-9), "{name}: {found:?} {expected:?}");
        assert!(trial.run(&format!("diff hayati.csv {name} --only kinematics --q-range=-3,3")).code == 0, "{name}");
    }
    trial.run("export hayati.csv -o again.urdf").succeeded();
    near(tip(&trial, "fk again.urdf --q 0,0").0, expected);
    let matched = trial.run("table again.urdf --match hayati.csv");
    assert!(matched.code == 0 && matched.stdout.contains(": exact\n"), "{}{}", matched.stdout, matched.stderr);
    let csv = trial.text("hayati.csv").replace("hayati", "proximal");
    let refused = denavit_with_input(&["table", "-"], &csv).failed();
    assert!(refused.contains(":4:") && refused.contains("beta belongs to the hayati convention"), "{refused}");
}

#[test]
fn units_in_headings_are_known_or_refused() {
    let d = |heading: &str, value: &str| format!("theta [rad],{heading},alpha [rad],a [m]\nq1,{value},0,0\n");
    for (heading, value, metres) in [
        ("d [in]", "16", 0.4064),
        ("d [\"]", "16", 0.4064),
        ("\"d [\"\"]\"", "16", 0.4064),
        ("d (ft)", "2", 0.6096),
        ("d [feet]", "2", 0.6096),
        ("d [mils]", "16", 4.064e-4),
        ("d [µm]", "500", 5e-4),
        ("d [um]", "500", 5e-4),
        ("d [dm]", "5", 0.5),
        ("d_cm", "5", 0.05),
        ("d", "16 in", 0.4064),
        ("d [mm]", "16 in", 0.4064),
        ("d in inches", "16", 0.4064),
    ] {
        let text = format!("# convention: distal\n{}", d(heading, value));
        let run = denavit_with_input(&["fk", "-", "--json"], &text);
        assert_eq!(run.stderr, "", "{heading}");
        let json: Value = serde_json::from_str(&run.succeeded()).unwrap();
        assert!((json["xyz"][2].as_f64().unwrap() - metres).abs() < 1e-12, "{heading}: {}", json["xyz"]);
    }
    for (heading, value, radians) in [
        ("alpha [mrad]", "100", 0.1),
        ("alpha [gon]", "100", std::f64::consts::FRAC_PI_2),
        ("alpha [rev]", "0.25", std::f64::consts::FRAC_PI_2),
        ("alpha (turn)", "0.25", std::f64::consts::FRAC_PI_2),
        ("alpha [arcmin]", "5400", std::f64::consts::FRAC_PI_2),
        ("alpha [arcsec]", "3600", std::f64::consts::PI / 180.0),
        ("alpha [']", "60", std::f64::consts::PI / 180.0),
    ] {
        let text = format!("# convention: distal\ntheta [rad],d [m],{heading},a [m]\nq1,0,{value},0\n");
        let run = denavit_with_input(&["table", "-", "--json"], &text);
        assert_eq!(run.stderr, "", "{heading}");
        let json: Value = serde_json::from_str(&run.succeeded()).unwrap();
        assert!((json["rows"][1]["alpha"].as_f64().unwrap() - radians).abs() < 1e-12, "{heading}");
    }
    let refused = |text: &str, said: &[&str]| {
        let message = denavit_with_input(&["table", "-"], text).failed();
        assert!(said.iter().all(|said| message.contains(said)), "{message}");
    };
    refused(&d("d [furlong]", "16"), &["<stdin>:1: column \"d [furlong]\"", "\"furlong\" is not a known unit", "ft"]);
    refused(&d("d [deg]", "16"), &["\"deg\" is not a known unit"]);
    refused(&d("d", "16 furlong"), &["d is \"16 furlong\""]);
    refused(
        &format!("# units: furlong, deg\n{}", d("d", "1")),
        &["<stdin>:1: units", "\"furlong\" is not a known unit"],
    );
    refused("theta,d,alpha,a\nrad,cubit,rad,m\nq1,1,0,0\n", &["theta is \"rad\""]);
    // A row of units.
    let run = denavit_with_input(&["fk", "-", "--json"], "# distal\ntheta,d,alpha,a\nrad,in,deg,m\nq1,16,0,0\n");
    let json: Value = serde_json::from_str(&run.succeeded()).unwrap();
    assert!((json["xyz"][2].as_f64().unwrap() - 0.4064).abs() < 1e-12);
    // One list for the command line, too.
    let run = denavit_with_input(
        &["fk", "-", "--json", "--table-units", "in,grad"],
        "# distal\ntheta,d,alpha,a\nq1,16,0,0\n",
    );
    let json: Value = serde_json::from_str(&run.succeeded()).unwrap();
    assert!((json["xyz"][2].as_f64().unwrap() - 0.4064).abs() < 1e-12);
}

#[test]
fn units_that_are_assumed_are_mentioned() {
    let said = |text: &str| denavit_with_input(&["table", "-"], text).stderr;
    let bare = said("# distal\ntheta,d,alpha,a\nq1,0.3,1.57,0\n");
    assert!(bare.contains("unit of angles is not stated; they are read as rad"), "{bare}");
    assert!(bare.contains("unit of lengths is not stated; they are read as m"), "{bare}");
    let degrees = said("# distal\ntheta,d,alpha,a\nq1,300,90,0\n");
    assert!(degrees.contains("read as degrees") && degrees.contains("read as mm"), "{degrees}");
    assert_eq!(said("# distal\ntheta,d,alpha,a\nq1,0,0,0\n"), "", "nothing has a unit");
    assert_eq!(said("# distal\n# units: mm, deg\ntheta,d,alpha,a\nq1,300,90,0\n"), "");
    let german = said("# distal\n# units: mm, deg\ntheta,d,alpha [Grad],a\nq1,300,90,0\n");
    assert!(german.contains("400 to a turn"), "{german}");
}

#[test]
fn a_row_without_a_variable_is_a_fixed_frame_where_the_others_have_one() {
    let table = |last: &str| {
        format!(
            "Joint,a (m),d (m),alpha (rad),theta (rad)\n1,0,0.333,0,θ1\n2,0,0,-pi/2,θ2\n3,0,0.316,pi/2,θ3\n{last},0,0.107,0,0\n"
        )
    };
    for name in ["tool0", "hand", "Gripper", "TCP frame", "EE frame", "Tip", "4", "", "Flange", "TCP"] {
        let run = denavit_with_input(&["table", "-", "--json"], &table(name));
        let json: Value = serde_json::from_str(&run.stdout).unwrap();
        assert_eq!(json["joints"].as_array().unwrap().len(), 3, "{name}: {}", run.stderr);
        assert_eq!(json["rows"][4]["d"], 0.107, "{name}");
        let mentioned = run.stderr.contains("it is read as a fixed frame");
        assert_eq!(mentioned, !["Flange", "TCP"].contains(&name), "{name}: {}", run.stderr);
    }
    // Frames before and between joints, and with more numbers than the tool row of a distal table has.
    let trial = Trial::new().with(
        "frames.csv",
        "# distal\n# units: m, deg\njoint,theta,d,alpha,a\npedestal,0,0.5,0,0\n1,q1,0.1,0,0.3\nspacer,0,0.02,90,0\n2,q2,0,0,0.2\n\
         plate,0,0.05,90,0.01\nneedle,0,0.1,0,0\n",
    );
    let (found, said) = tip(&trial, "fk frames.csv --q 0,0");
    // Tz(.5) Tz(.1) Tx(.3) Tz(.02) Rx(90) Tx(.2) Tz(.05) Rx(90) Tx(.01) Tz(.1)
    near(found, [0.51, -0.05, 0.52]);
    assert_eq!(said.matches("fixed frame").count(), 4, "{said}");
    let alone = "# distal\n# units: m, deg\njoint,theta,d,alpha,a\n1,0,0.1,0,0.3\n2,0,0,0,0.2\ntool,0,0.1,90,0.04\n";
    let json = denavit_with_input(&["fk", "-", "--q", "0,0", "--json"], alone).succeeded();
    let json: Value = serde_json::from_str(&json).unwrap();
    assert!((json["xyz"][0].as_f64().unwrap() - 0.54).abs() < 1e-12, "the tool's length is kept: {}", json["xyz"]);
}

#[test]
fn what_a_row_says_twice_must_be_the_same() {
    let refused = |text: &str, said: &str| {
        let message = denavit_with_input(&["table", "-"], &format!("# units: m, deg\n{text}")).failed();
        assert!(message.contains(said), "{text}: {message}");
    };
    refused("theta,d,alpha,a\nq1,0,q2,0\n", "alpha holds a variable");
    refused("theta,d,alpha,a\nθ1,d1,0,0\n", "theta holds the variable theta1 and d the variable d1");
    refused("kind,theta,d,alpha,a\nR,0,d1,0,0\n", "kind is revolute, but d holds the variable");
    refused("kind,theta,d,alpha,a\nP,q1,0,0,0\n", "kind is prismatic, but theta holds the variable");
    refused("kind,offset,d,alpha,a\nP,90,q1,0,0\n", "the offset may belong to d");
    refused("theta,d,alpha,a\nq1,0,0,0,7\n", "the row has 5 cells but the header has 4");
    refused("theta,d,alpha,a\n90° + π/2,0,0,0\n", "theta is \"90° + π/2\"");
    let trial = Trial::new().with("offset.csv", "# distal\n# units: m, deg\ntheta,d,alpha,a\n(q1 - 90°),0,0,0.5\n");
    near(tip(&trial, "fk offset.csv --q 0").0, [0.0, -0.5, 0.0]);
}

#[test]
fn printed_tables_are_read() {
    let blanks = "j  theta  d  a  alpha\n1  q1  0.1273  0  1.570796327\n2  q2  0  -0.612  0\n3  q3  0 -0.5723 0\n\
                  4 q4 0.163941 0 1.570796327\n5 q5 0.1157 0 -1.570796327\n6 q6 0.0922 0 0\n";
    let boxed = "DHRobot: UR10, 6 joints (RRRRRR), dynamics, standard DH parameters\n\
                 ┌─────┬──────────┬─────────┬────────┬─────────┬────────┐\n\
                 │ θⱼ  │    dⱼ    │   aⱼ    │   ⍺ⱼ   │   q⁻    │   q⁺   │\n\
                 ├─────┼──────────┼─────────┼────────┼─────────┼────────┤\n\
                 │ q1  │   0.1273 │       0 │  90.0° │ -180.0° │ 180.0° │\n\
                 │ q2  │        0 │  -0.612 │   0.0° │ -180.0° │ 180.0° │\n\
                 │ q3  │        0 │ -0.5723 │   0.0° │ -180.0° │ 180.0° │\n\
                 │ q4  │ 0.163941 │       0 │  90.0° │ -180.0° │ 180.0° │\n\
                 │ q5  │   0.1157 │       0 │ -90.0° │ -180.0° │ 180.0° │\n\
                 │ q6  │   0.0922 │       0 │   0.0° │ -180.0° │ 180.0° │\n\
                 └─────┴──────────┴─────────┴────────┴─────────┴────────┘\n\n\
                 ┌─────┬────────────────────────────────┐\n\
                 │tool │ t = 0, 0, 0.1; rpy/xyz = 0°, 0°, 0° │\n\
                 └─────┴────────────────────────────────┘\n";
    let matlab = "+---+----+----------+---------+-------+\n| j | theta |   d |   a | alpha |\n+---+----+-----+----+----+\n\
                  |  1|  q1|  0.1273|       0| 1.5708|\n|  2|  q2|       0|  -0.612|      0|\n+---+----+-----+----+----+\n";
    let trial = Trial::new()
        .with("print.txt", blanks)
        .with("box.md", boxed)
        .with("matlab.txt", matlab)
        .with_robot("ur10.csv", "universal_robots/ur10_dh.csv");
    for file in ["print.txt", "box.md"] {
        let (found, _) = tip(&trial, &format!("fk {file} --q 0.1,-0.2,0.3,-0.4,0.5,0.6"));
        let (expected, _) = tip(&trial, "fk ur10.csv --q 0.1,-0.2,0.3,-0.4,0.5,0.6");
        assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-8), "{file}: {found:?} {expected:?}");
    }
    let boxed = trial.run("table box.md --json");
    assert!(boxed.stderr.contains("box.md:14: text"), "the tool is not read, and said so: {}", boxed.stderr);
    assert!(!boxed.stderr.contains("convention is not stated"), "{}", boxed.stderr);
    let json: Value = serde_json::from_str(&boxed.stdout).unwrap();
    assert!((json["coordinates"][0]["limits"]["lower"].as_f64().unwrap() + std::f64::consts::PI).abs() < 1e-12);
    assert!(trial.run("chains matlab.txt").succeeded().contains(" 2  joint_1 joint_2"));
}

#[test]
fn other_text_is_not_called_xml() {
    let trial = Trial::new()
        .with("notes.txt", "The robot stands in hall 3.\n")
        .with("robot.toml", "[robot]\nname = \"arm\"\n")
        .with("broken.urdf", "robot without marks\n");
    for file in ["notes.txt", "robot.toml"] {
        trial.refuses(&format!("table {file}"), "this is not a robot in a known format");
        trial.refuses(&format!("check {file}"), file);
        let said = trial.run(&format!("table {file}")).stderr;
        assert!(!said.contains("well-formed XML"), "{said}");
    }
    trial.refuses("table broken.urdf", "not well-formed XML");
}

fn origins(of: impl Fn(usize) -> [f64; 6], count: usize) -> String {
    let mut text = String::new();
    for joint in 1..=count {
        let _ = writeln!(text, "joint{joint}:\n  kinematic:");
        for (key, value) in ["x", "y", "z", "roll", "pitch", "yaw"].iter().zip(of(joint)) {
            let _ = writeln!(text, "    {key}: {value}");
        }
    }
    text
}

#[test]
fn a_foreign_yaml_is_not_taken_for_a_franka() {
    let upright = |joint: usize| [0.01 * joint as f64, 0.0, 0.1, 0.0, 0.0, 0.0];
    let quarter = std::f64::consts::FRAC_PI_2;
    let franka = |joint: usize| match joint {
        1 => [0.0, 0.0, 0.333, 0.0, 0.0, 0.0],
        8 => [0.0, 0.0, 0.107, 0.0, 0.0, 0.0],
        joint => [0.0, 0.1, 0.0, if joint % 2 == 0 { -quarter } else { quarter }, 0.0, 0.0],
    };
    let one_off = |joint: usize| if joint == 5 { [0.0, 0.1, 0.0, 0.0, 0.0, 0.0] } else { franka(joint) };
    let trial = Trial::new()
        .with("upright.yaml", &origins(upright, 8))
        .with("one_off.yaml", &origins(one_off, 8))
        .with("more.yaml", &format!("{}remark: ours\n", origins(franka, 8)))
        .with("xarm.yaml", "kinematics:\n  joint1: {x: 0, y: 0, z: 0.3, roll: 0, pitch: 0, yaw: 0}\n  joint2: {x: 0, y: 0, z: 0.3, roll: 0, pitch: 0, yaw: 0}\n");
    trial.refuses("table upright.yaml", "at right angles, but here they are not");
    trial.refuses("table one_off.yaml", "axes 4 and 5 of a Franka arm");
    trial.refuses("table xarm.yaml", "every axis would be parallel");
    let read = trial.run("table more.yaml");
    assert_eq!(read.code, 0, "{}", read.stderr);
    assert!(read.stderr.contains("read as the joint origins of a Franka arm"), "{}", read.stderr);
    assert!(read.stderr.contains("more.yaml:65: key \"remark\": the key is unknown"), "{}", read.stderr);
}

#[test]
fn a_controllers_calibration_is_read_with_its_model() {
    let conf = |theta: &str| {
        format!(
            "[mounting]\ndelta_theta = [ {theta}, 0, 0, 0, 0, 0]\ndelta_a = [ 0.0001, 0, 0, 0, 0, 0]\n\
             delta_d = [ 0.001, 0, 0, 0, 0, 0]\ndelta_alpha = [ 0, 0, 0, 0, 0, 0]\njoint_checksum = [ 0x1, 0x2]\n\
             calibration_status = 2\nremark = 7\n"
        )
    };
    let trial = Trial::new().with("calibration.conf", &conf("0.01")).with("bad.conf", &conf("nan"));
    trial.refuses("table calibration.conf", "ur_type:=MODEL, one of ur3");
    trial.refuses("table calibration.conf ur_type:=ur99", "the model \"ur99\" is not known");
    trial.refuses("table bad.conf ur_type:=ur5e", "delta_theta is \"[ nan, 0, 0, 0, 0, 0]\"");
    let run = trial.run("table calibration.conf ur_type:=ur5e --json");
    assert!(run.stderr.contains("calibration.conf:8: key \"remark\""), "{}", run.stderr);
    let json: Value = serde_json::from_str(&run.succeeded()).unwrap();
    let row = &json["rows"][1];
    let number = |key: &str| row[key].as_f64().unwrap();
    assert_eq!([number("theta"), number("d"), number("a")], [0.01, 0.1625 + 0.001, 0.0001]);
    // The factory's figures of individual arms, and the joint origins computed from them elsewhere.
    let Some(vendor) = crate::support::vendor() else { return };
    let deltas = std::fs::read_to_string(vendor.join("ur_calibration/factory_deltas.csv")).unwrap();
    for (robot, model, yaml) in
        [("A", "ur10", "individual_A_ur10_kinematics.yaml"), ("B", "ur10e", "individual_B_ur10e_kinematics.yaml")]
    {
        let rows: Vec<Vec<&str>> = deltas.lines().map(|line| line.split(',').collect()).collect();
        let rows: Vec<&Vec<&str>> = rows.iter().filter(|row| row[0] == robot).collect();
        let list = |column: usize| rows.iter().map(|row| row[column]).collect::<Vec<_>>().join(", ");
        let conf = format!(
            "[mounting]\ndelta_theta = [{}]\ndelta_a = [{}]\ndelta_d = [{}]\ndelta_alpha = [{}]\n",
            list(3),
            list(5),
            list(4),
            list(6)
        );
        std::fs::write(trial.path("single.conf"), conf).unwrap();
        std::fs::copy(vendor.join("ur_calibration").join(yaml), trial.path("single.yaml")).unwrap();
        let q = "--q 0.1,-0.2,0.3,-0.4,0.5,0.6";
        let (one, _) = tip(&trial, &format!("fk single.conf ur_type:={model} {q}"));
        let (other, _) = tip(&trial, &format!("fk single.yaml {q}"));
        assert!(one.iter().zip(other).all(|(a, b)| (a - b).abs() < 1e-9), "{robot}: {one:?} {other:?}");
    }
}

#[test]
fn opw_files_and_screw_axes_of_modern_robotics_are_robots() {
    let opw = "opw_kinematics_geometric_parameters:\n  a1: 0.5\n  a2: -0.18\n  b: 0.0\n  c1: 0.86\n  c2: 1.55\n  c3: 1.0345\n  c4: 0.305\n\
               opw_kinematics_joint_offsets: [0, deg(-90), 0, 0, 0, 0]\nopw_kinematics_joint_sign_corrections: [-1, 1, 1, -1, 1, -1]\n";
    let axes = r#"{"M": [[-1,0,0,0.817],[0,0,1,0.191],[0,1,0,-0.006],[0,0,0,1]], "Slist": [[0,0,1,0,0,0],[0,1,0,-0.089,0,0],[0,1,0,-0.089,0,0.425],[0,1,0,-0.089,0,0.817],[0,0,-1,-0.109,0.817,0],[0,1,0,0.006,0,0.817]]}"#;
    let value: Value = serde_json::from_str(axes).unwrap();
    let column =
        |k: usize| -> Vec<Value> { value["Slist"].as_array().unwrap().iter().map(|row| row[k].clone()).collect() };
    let columns = serde_json::json!({"M": value["M"], "Slist": (0..6).map(column).collect::<Vec<_>>(), "Glist": []});
    let trial = Trial::new()
        .with("arm.yaml", opw)
        .with("moveit.yaml", &format!("manipulator:\n  solver: opw\n  {}", opw.trim_end().replace('\n', "\n  ")))
        .with("sign.yaml", &opw.replace("[-1, 1, 1", "[-2, 1, 1"))
        .with("short.yaml", &opw.replace(", 0]\n", "]\n"))
        .with("axes.json", axes)
        .with("columns.json", &columns.to_string())
        .with("bad.json", &axes.replace("[0,0,1,0,0,0]", "[0,0,2,0,0,0]"));
    // At q = 0 joint 2 is at -(-90°): forwards.
    near(tip(&trial, "fk arm.yaml --q 0,0,0,0,0,0").0, [0.5 + 1.55 + 1.0345 + 0.305, 0.0, 0.86 + 0.18]);
    let (found, said) = tip(&trial, "fk moveit.yaml --q 0,0,0,0,0,0");
    near(found, [3.3895, 0.0, 1.04]);
    assert!(said.contains("moveit.yaml:2: key \"manipulator.solver\""), "{said}");
    trial.refuses("table sign.yaml", "a sign correction is -2");
    trial.refuses("table short.yaml", "opw_kinematics_joint_offsets.5 is missing");
    // Out again.
    trial.run("table arm.yaml --format opw -o again.yaml").succeeded();
    assert!(trial.text("again.yaml").contains("a1: 0.5\n"), "{}", trial.text("again.yaml"));
    assert_eq!(trial.run("diff arm.yaml again.yaml --only kinematics --q-range=-3,3").code, 0);
    trial.refuses("table arm.urdf --format opw", "axes 4, 5 and 6 do not meet in a point");
    let rows = tip(&trial, "fk axes.json --q 0.1,0.2,0.3,0.4,0.5,0.6").0;
    let (found, said) = tip(&trial, "fk columns.json --q 0.1,0.2,0.3,0.4,0.5,0.6");
    near(found, rows);
    assert!(said.contains("key \"Glist\": the key is unknown") && said.contains("read as m"), "{said}");
    near(tip(&trial, "fk axes.json --q 0,0,0,0,0,0").0, [0.817, 0.191, -0.006]);
    trial.refuses("table bad.json", "is not of unit length");
}

#[test]
fn nothing_that_is_not_understood_is_passed_over() {
    let notes = |file: &str, text: &str, said: &str| {
        let trial = Trial::new().with(file, text);
        let run = trial.run(&format!("table {file}"));
        assert!(run.stderr.contains(said), "{file}: {}", run.stderr);
    };
    let csv = "# distal\n# units: m, deg\nrow,theta,d,alpha,a\n1,q1,0.1,90,0\n2,q2,0,0,0.2\n";
    let lines: Vec<&str> = csv.lines().collect();
    // A column in every place.
    for place in 0..=5 {
        let with = |line: &str, word: &str| {
            let mut cells: Vec<&str> = line.split(',').collect();
            cells.insert(place, word);
            cells.join(",")
        };
        let text = format!(
            "{}\n{}\n{}\n{}\n{}\n",
            lines[0],
            lines[1],
            with(lines[2], "colour"),
            with(lines[3], "red"),
            with(lines[4], "7")
        );
        notes("column.csv", &text, "column.csv:3: column \"colour\": the column is unknown");
        let text = format!(
            "{}\n{}\n{}\n{}\n{}\n",
            lines[0],
            lines[1],
            with(lines[2], ""),
            with(lines[3], "red"),
            with(lines[4], "")
        );
        notes("nameless.csv", &text, "nameless.csv:3: column \"\"");
    }
    // A row in every place: a row of words is an error, a row of numbers is a joint or above the header.
    for place in 2..=5 {
        let mut rows = lines.clone();
        rows.insert(place, "spare,word,0,0,0");
        let run = denavit_with_input(&["table", "-"], &rows.join("\n"));
        assert!(run.code == 2 || place == 2, "{place}: {}", run.stdout);
        rows[place] = "9,0,0.5,0,0";
        let run = denavit_with_input(&["table", "-"], &rows.join("\n"));
        assert!(run.code == 2 || run.stderr.contains("row"), "{place}: {}{}", run.stdout, run.stderr);
    }
    // A unit in every heading, and in every cell.
    for column in ["theta", "d", "alpha", "a"] {
        let text = csv.replacen(&format!(",{column}"), &format!(",{column} [cubit]"), 1);
        assert!(
            denavit_with_input(&["table", "-"], &text).failed().contains("\"cubit\" is not a known unit"),
            "{column}"
        );
    }
    for cell in ["q1,0.1,90,0", "q1,0.1 cubit,90,0", "q1 cubit,0.1,90,0", "q1,0.1,90 cubit,0", "q1,0.1,90,0 cubit"]
        .iter()
        .skip(1)
    {
        denavit_with_input(&["table", "-"], &csv.replace("q1,0.1,90,0", cell)).failed();
    }
    let markdown = "standard, lengths in m, angles in degrees\n\n| theta | d | alpha | a |\n|---|---|---|---|\n| q1 | 0.1 | 90 | 0 |\n";
    notes("text.md", &format!("{markdown}\nSee page 3.\n"), "text.md:7: text: text after the table is ignored");
    notes("two.md", &format!("{markdown}\n# B\n\n{markdown}"), "another table follows");
    assert_eq!(denavit_with_input(&["table", "-"], markdown).stderr, "");
    // Keys at every level of our own JSON.
    let trial = Trial::new().with("t.csv", csv);
    for (kind, command) in [("table", "table t.csv --json"), ("poe", "poe t.csv --json")] {
        let json: Value = serde_json::from_str(&trial.run(command).succeeded()).unwrap();
        let mut pointers = vec![String::new(), "/units".into(), "/coordinates/0".into(), "/joints/1".into()];
        pointers.extend((kind == "table").then(|| "/rows/2".to_owned()));
        for pointer in pointers {
            let mut with = json.clone();
            with.pointer_mut(&pointer).unwrap()["colour"] = "red".into();
            let run = denavit_with_input(&["table", "-"], &with.to_string());
            assert!(run.stderr.contains("colour\": the key is unknown"), "{kind} {pointer}: {}", run.stderr);
        }
        let clean = denavit_with_input(&["table", "-"], &json.to_string());
        assert_eq!((clean.code, clean.stderr.as_str()), (0, ""), "{kind}");
    }
}

#[test]
fn names_do_not_leave_their_place_in_any_output() {
    let name = "x\\n'); system('id'); % \\\"; import os # <script> a|b =1+1";
    let names = |text: &str| text.replace("joint_1", name);
    let trial = Trial::new().with("t.csv", "# distal\n# units: m, deg\ntheta,d,alpha,a\nq1,0.1,90,0\nq2,0,0,0.2\n");
    let json = trial.run("table t.csv --json").succeeded();
    let trial = trial.with("named.json", &names(&json)).with("formula.json", &json.replace("joint_1", "=1+1|cmd"));
    let matlab = trial.run("table named.json --format matlab").succeeded();
    assert!(matlab.contains("['x', char(10), '''); system(''id''); % \"; import os # <script> a|b =1+1']"), "{matlab}");
    assert!(!matlab.contains("\n')"), "{matlab}");
    let python = trial.run("table named.json --format rtb").succeeded();
    assert!(python.contains("# x\\n'); system"), "{python}");
    for format in ["text", "md", "tex"] {
        let text = trial.run(&format!("table named.json --format {format}")).succeeded();
        assert!(!text.contains("x\n'"), "{format}: {text}");
        assert!(format != "md" || (text.contains("&lt;script&gt; a\\|b") && !text.contains("<script>")), "{text}");
    }
    for command in ["table formula.json --format csv", "poe formula.json --format csv"] {
        let csv = trial.run(command).succeeded();
        assert!(csv.contains(",'=1+1|cmd,") && !csv.contains(",=1"), "{csv}");
        let again = denavit_with_input(&["chains", "-"], &csv).succeeded();
        assert!(again.contains(" 2  =1+1|cmd joint_2"), "{again}");
    }
    let md = trial.run("table formula.json --format md").succeeded();
    assert!(denavit_with_input(&["chains", "-"], &md).succeeded().contains("=1+1|cmd"), "{md}");
}

#[test]
fn long_names_and_deep_cells_are_answered_shortly() {
    let deep = "(".repeat(40_000);
    for cell in [deep.clone(), "-".repeat(40_000), format!("{deep}1{}", ")".repeat(40_000))] {
        let message = denavit_with_input(&["table", "-"], &format!("theta,d,alpha,a\nq1,{cell},0,0\n")).failed();
        assert!(message.len() < 2000 && message.contains("…"), "{}", message.len());
    }
    let name = "n".repeat(70_000);
    let urdf = format!(
        "<robot name='r'><link name='{name}'/><link name='b'/><joint name='j' type='continuous'><parent link='{name}'/>\
         <child link='b'/><axis xyz='0 0 1'/></joint></robot>"
    );
    assert_eq!(denavit_with_input(&["chains", "-"], &urdf).code, 0);
    let broken = urdf.replace("<child link='b'/>", &format!("<child link='{name}x'/>"));
    let message = denavit_with_input(&["chains", "-"], &broken).failed();
    assert!(message.lines().all(|line| line.len() < 4000), "{}", message.len());
}

#[cfg(unix)]
#[test]
fn a_variable_that_is_no_text_stops_nobody() {
    use std::os::unix::ffi::OsStrExt as _;
    let trial = Trial::new().with(
        "a.xacro",
        "<robot xmlns:xacro='http://www.ros.org/wiki/xacro' name='a'><link name='$(env NAMED)'/></robot>",
    );
    let run = crate::support::program(trial.folder())
        .args(["describe", "a.xacro"])
        .env("NAMED", "base")
        .env("ODD", std::ffi::OsStr::from_bytes(b"\xff\xfe"))
        .output()
        .unwrap();
    assert_eq!(run.status.code(), Some(0), "{}", String::from_utf8_lossy(&run.stderr));
}

#[test]
fn the_kinematics_file_of_a_ur_is_for_a_ur() {
    let trial = Trial::new().with_robot("irb120.urdf", "abb/irb120.urdf");
    assert_eq!(trial.run("table arm.urdf --format ur -o ur.yaml").code, 0);
    trial.refuses("table irb120.urdf --format ur", "the axes at zero match no Universal Robots arm");
    let table = "# distal\n# units: m, deg\ntheta,d,alpha,a\nq1,0.1452,-90,0\nq2,0,0,0.329\nq3,0,0,0.3115\nq4,-0.1222,90,0\nq5,0.106,90,0\nq6,0.1132,0,0\n";
    let techman = denavit_with_input(&["table", "-", "--format", "ur"], table).failed();
    assert!(techman.contains("no Universal Robots arm"), "{techman}");
}

#[test]
fn what_table_refuses_export_and_describe_refuse() {
    let far = "<robot name='far'><link name='a'/><link name='b'/><link name='c'/>\
        <joint name='j' type='continuous'><parent link='a'/><child link='b'/><origin xyz='0 0 1e200'/><axis xyz='0 0 1'/></joint>\
        <joint name='k' type='continuous'><parent link='b'/><child link='c'/><origin xyz='1e200 0 1'/><axis xyz='0 1 0'/></joint></robot>";
    let trial = Trial::new()
        .with("far.urdf", far)
        .with("far.csv", "# distal\n# units: m, deg\ntheta,d,alpha,a\nq1,1e200,90,0\nq2,0,0,1e200\n")
        .with("parallel.yaml", &origins(|_| [0.0, 0.0, 0.1, 0.0, 0.0, 0.0], 8));
    for file in ["far.urdf", "far.csv", "parallel.yaml"] {
        for command in ["table", "export", "describe"] {
            let run = trial.run(&format!("{command} {file}"));
            assert_eq!(run.code, 2, "{command} {file}: {}{}", run.stdout, run.stderr);
        }
    }
}
