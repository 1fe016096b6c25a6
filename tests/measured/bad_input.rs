//! What cannot be done is said once and clearly, and nothing is half-written.

use super::{Folder, JOINTS, ur5e};
use crate::golden::snapshot;
use crate::support::{denavit, denavit_with_input, robot};

#[test]
fn standard_input_gives_the_data_and_files_are_written_all_or_none() {
    let (folder, ur5e) = (Folder::new(), ur5e());
    let data = denavit(&["simulate", &ur5e, "--rows", "60"]).succeeded();
    let from_input = denavit_with_input(&["calibrate", &ur5e, "--data", "-", "--effects", "none"], &data).succeeded();
    assert!(from_input.contains("60 positions fitted"), "{from_input}");
    let file = folder.file("data.csv", &data);
    let outputs = |json: &str, html: &str| {
        let (json, html) = (format!("--json={}", folder.path(json)), folder.path(html));
        denavit(&["calibrate", &ur5e, "--data", &file, "--effects", "none", "--html", &html, &json]).failed()
    };
    assert!(outputs("nowhere/r.json", "page.html").contains("there is no folder"));
    assert!(outputs("same", "same").contains("two outputs have the same file"));
    assert_eq!(folder.names(), ["data.csv"]);
    let other = robot("abb/irb120.urdf");
    assert!(denavit(&["calibrate", &other, "--data", &file]).failed().contains("has no column"));
    let table = robot("universal_robots/ur5e_dh.csv");
    let urdf = folder.path("as_it_is.urdf");
    let calibrate = ["calibrate", &table, "--data", &file, "--effects", "none", "--urdf", &urdf];
    assert!(denavit(&calibrate).failed().contains("--urdf needs a URDF as its source"));
    assert_eq!(folder.names(), ["data.csv"]);
}

#[test]
fn bad_input_to_the_measuring_commands_gets_one_clear_message() {
    let (folder, ur5e) = (Folder::new(), ur5e());
    let nan = folder.file("nan.csv", &format!("{JOINTS}\n1,2,3,4,5,nan\n"));
    let few = folder.file("few.csv", &format!("{JOINTS}\n0,0,0,0,0,0\n"));
    let short = folder.file("short.csv", "shoulder_pan_joint,elbow\n1,2\n");
    let says = |arguments: &[&str], expected: &str| {
        let message = denavit(arguments).failed();
        assert!(message.starts_with("error: ") && message.contains(expected), "{arguments:?}: {message}");
    };
    let plan = |rest: &[&str], expected: &str| says(&[&["plan", &ur5e], rest].concat(), expected);
    plan(&["--count", "0"], "0 is not in 1..=65535");
    plan(&["--count", "2", "--candidates", &few], "only 1 of 1 candidates");
    plan(&["--count", "2000"], "only 1000 of 1000 candidates");
    plan(&["--count", "1", "--candidates", &nan], "nan.csv:2: column \"wrist_3_joint\": \"nan\" is not finite");
    plan(&["--count", "1", "--candidates", &short], "did you mean column \"elbow\"?");
    plan(&["--count", "1", "--box", "1,0,0,1,0,1"], "X0 = 1 is not below X1 = 0");
    plan(&["--count", "1", "--box", "0,1,0,nan,0,1"], "Y0 = 0 is not below Y1 = NaN");
    plan(&["--count", "1", "--box", "0,1,0"], "3 numbers; write six, X0,X1,Y0,Y1,Z0,Z1");
    plan(&["--count", "1", "--box", "5,6,5,6,5,6"], "only 0 of 1000 candidates");
    let simulate = |rest: &[&str], expected: &str| says(&[&["simulate", &ur5e], rest].concat(), expected);
    simulate(&["--effect", "rust@base=1mm"], "\"rust\" is not a kind of effect; there are joint_scale");
    simulate(&["--effect", "backlash@elbow=1mm"], "backlash cannot act at \"elbow\"; it can at shoulder_pan_joint");
    simulate(&["--effect", "backlash@elbow_joint=nan"], "\"nan\" is not a strength");
    simulate(&["--effect", "backlash"], "write KIND@PLACE=STRENGTH");
    simulate(&["--effect", "thermal@base=1mm"], "for other places add --columns temperature");
    simulate(&["--effect", "backlash@elbow_joint:order=2=1mm"], "\"order\" cannot be set here");
    simulate(&["--columns", "humidity"], "\"humidity\" cannot be simulated as a column");
    simulate(&["--noise", "-1"], "--noise: \"-1\" is not MM,MRAD");
    simulate(&["--outliers", "1.5"], "it is not a share of the rows");
    simulate(&["--targets", "2", "--measure", "poses"], "only positions can have several targets");
    simulate(&["--poses", &nan], "is not finite");
    let compensate = |rest: &[&str], expected: &str| says(&[&["compensate", &ur5e], rest].concat(), expected);
    compensate(&["--poses", &nan], "is not finite");
    compensate(&["--poses", &few, "--effects", &few], "not a file of effects");
    compensate(&["--poses", &few, "--allowed-miss", "x"], "invalid value 'x'");
    let place = folder.file("place.csv", "x,y,z\n0.4,0.2,0.5\n");
    compensate(&["--poses", &place], "column \"qx\" is missing beside \"x\"");
    let bent = folder.file("bent.csv", "x,y,z,qx,qy,qz,qw\n0.4,0.2,0.5,1,1,0,0\n");
    compensate(&["--poses", &bent], "the quaternion has length 1.414214, not 1");
    let straight = folder.file("straight.csv", "x,y,z,qx,qy,qz,qw\n0.4,0.2,0.5,1,0,0,0\n");
    says(&["identify", &ur5e, "--data", &straight], "joint \"shoulder_pan_joint\" has no column");
    says(&["identify", &ur5e, "--scales", "elbow"], "the chain has no joint \"elbow\"; write all, or some of");
    says(&["fk", &ur5e, "--given", "payload=1"], "it needs --effects");
    says(&["calibrate", "-", "--data", "-"], "standard input (-) can be one file only");
    for option in [["--mass", "20"], ["--gear-ratio", "elbow_joint=100"], ["--max-effects", "3"]] {
        for without in [["--effects", "none"], ["--effects", "curves"], ["--zeros", "all"]] {
            let rest = [option, without].concat();
            let arguments = [&["calibrate", &ur5e, "--data", &few][..], &rest].concat();
            says(&arguments, &format!("{}: there is no search for effects with {}", option[0], without[0]));
        }
    }
}

#[test]
fn effects_written_by_hand_are_checked() {
    let folder = Folder::new();
    let file = |driver: &str, coefficients: &str| {
        let joints: Vec<String> = JOINTS.split(',').map(|joint| format!("\"{joint}\"")).collect();
        let effect = format!(
            "{{\"kind\": \"drift\", \"carrier\": \"target\", \"driver\": {driver}, \"coupling\": \"each\", \"coefficients\": [{coefficients}]}}"
        );
        let text = format!(
            "{{\"schema\": \"denavit.effects/1\", \"robot\": \"ur5e\", \"joints\": [{}], \"effects\": [{effect}]}}",
            joints.join(",")
        );
        folder.file("effects.json", &text)
    };
    let fk = |file: &str| denavit(&["fk", &ur5e(), "--effects", file]);
    let run = fk(&file("{\"covariate\": \"time\"}", "1e-3, 0, 0"));
    assert!(run.stderr.contains("drift at target changes the measurement, not the pose of the tip; left out"));
    assert_eq!(run.succeeded(), denavit(&["fk", &ur5e()]).succeeded());
    let message = fk(&file("{\"smooth\": {\"covariate\": \"time\", \"knots\": []}}", "1e-3, 0, 0")).failed();
    assert!(message.contains("effect 1 (drift): a number of its driver is out of range"), "{message}");
    let message = fk(&file("{\"covariate\": \"time\"}", "1e-3")).failed();
    assert!(message.contains("1 coefficients are given; give 3"), "{message}");
}

#[test]
fn poses_that_cannot_be_reached_are_named() {
    let folder = Folder::new();
    let poses = "x,y,z,roll,pitch,yaw\n400,200,500,180,0,0\n3000,0,0,0,0,0\n400,250,500,180,0,5\n";
    let file = folder.file("poses.csv", poses);
    let from = robot("abb/irb120.urdf");
    let arguments = ["compensate", &ur5e(), "--from", &from, "--poses", &file, "--units", "mm,deg"];
    assert!(denavit(&arguments).failed().contains("but those of"));
    let arguments = ["compensate", &ur5e(), "--poses", &file, "--units", "mm,deg"];
    let run = denavit(&arguments);
    assert_eq!(run.code, 1, "{}", run.stderr);
    snapshot("compensate_ur5e", &run.stdout);
    let out = folder.path("commands.csv");
    let run = denavit(&[&arguments[..], &["-o", &out]].concat());
    assert!(run.code == 1 && run.stdout.contains("line 3: out of reach"), "{}", run.stdout);
    assert!(std::fs::read_to_string(out).unwrap().contains("out of reach"));
}
