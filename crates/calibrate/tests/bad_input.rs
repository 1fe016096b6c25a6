//! Every way in which a measurement file can be wrong, with the words that the user sees.

#![allow(clippy::unwrap_used, clippy::print_stdout, clippy::approx_constant)] // Tests: a panic is a failure, what is printed is read.

use denavit_calibrate::calibration::{CalibrateOptions, HoldOut, calibrate};
use denavit_calibrate::{IdentifyOptions, Measurements};
use denavit_identify::effects::driver::Statics;
use denavit_identify::parameters::NoEffects;
use denavit_identify::simulate::{SimulationOptions, simulate, simulate_arm};
use denavit_measurements::kinds::ObservationKind;
use denavit_measurements::{Covariate, DataNote, Units, read, write};
use denavit_model::examples::planar_arm;
use denavit_trace::TraceOptions;

fn error(text: &str) -> String {
    read("m.csv", text.as_bytes(), &planar_arm(), Units::default()).unwrap_err().to_string()
}

fn notes(text: &str) -> Vec<DataNote> {
    read("m.csv", text.as_bytes(), &planar_arm(), Units::default()).unwrap_or_else(|error| panic!("{error}")).notes
}

fn check(text: &str, expected: &str) {
    assert_eq!(error(text), expected);
}

#[test]
fn headers() {
    check(
        "# only a comment\n",
        "m.csv: there is no header row; the first row names the columns: joints, then x,y,z or distance",
    );
    check("", "m.csv: there is no header row; the first row names the columns: joints, then x,y,z or distance");
    check("joint_1,joint_2,x,y,z\n", "m.csv: there are no rows below the header; each row is one pose of the robot");
    check(
        "joint_1;joint_3;x;y;z\n1;2;3;4;5\n",
        "m.csv:1: joint \"joint_2\" has no column; did you mean column \"joint_3\"? Rename that column",
    );
    check(
        "# c\njoint_1,jiont_2,x,y,z\n1,2,3,4,5\n",
        "m.csv:2: joint \"joint_2\" has no column; did you mean column \"jiont_2\"? Rename that column",
    );
    check(
        "joint_1,x,y,z\n1,2,3,4\n",
        "m.csv:1: joint \"joint_2\" has no column; the file needs one column for each of joint_1, joint_2",
    );
    check("joint_1,joint_1,joint_2,x,y,z\n", "m.csv:1: column \"joint_1\" appears twice; give each its own name");
    check("joint_1,joint_2,x,y,z,\n", "m.csv:1: column 6 has no name; name it or remove it");
    check("joint_1,joint_2,x,y\n", "m.csv:1: column \"z\" is missing beside \"x\"; x, y, z belong together");
    check(
        "joint_1,joint_2,x,y,z,qx,qy,qw\n",
        "m.csv:1: column \"qz\" is missing beside \"qx\"; qx, qy, qz, qw belong together",
    );
    check(
        "joint_1,joint_2,x1,y1,z1,x2,y2,z2,qx,qy,qz,qw\n",
        "m.csv:1: a quaternion goes with one target x,y,z, and there are 2 targets; remove qx,qy,qz,qw",
    );
    check(
        "joint_1,joint_2,distnace\n",
        "m.csv:1: no column holds a measured value; there must be x,y,z (with qx,qy,qz,qw for poses), or x1,y1,z1,x2,… for \
         several targets, or distance; did you mean \"distnace\" to be one of them?",
    );
    check(
        "joint_1,joint_2,x,y,z,joint_3.approach\n",
        "m.csv:1: column \"joint_3.approach\": there is no joint \"joint_3\"; did you mean \"joint_2\"?",
    );
}

#[test]
fn columns_that_are_nearly_known_are_not_lost() {
    let near = |column: &str, known: &str| {
        check(
            &format!("joint_1,joint_2,x,y,z,{column}\n0,0,1,0,0,1\n"),
            &format!(
                "m.csv:1: column \"{column}\" is nearly \"{known}\"; write \"{known}\" if that is meant, otherwise another \
                 name, such as \"my_{known}\""
            ),
        );
    };
    near("temprature", "temperature");
    near("joint_1_approach", "joint_1.approach");
    // Capitals and units are read, and said.
    let taken = |column: &str, known: &str| {
        let found = notes(&format!("joint_1,joint_2,x,y,z,{column}\n0,0,1,0,0,1\n0.1,0.2,1,0.1,0,1\n"));
        let said = format!("\"{column}\" read as {known}");
        assert!(found.iter().any(|note| note.to_string() == said), "{found:?}");
    };
    taken("Temperature", "temperature");
    taken("Time (s)", "time");
    taken("Payload", "payload");
    taken("joint_2.Velocity", "joint_2.velocity");
    check(
        "joint_1,joint_2,x,y,z,Qx\n0,0,1,0,0,1\n",
        "m.csv:1: column \"qy\" is missing beside \"qx\"; qx, qy, qz, qw belong together\n\
         m.csv:1: column \"qz\" is missing beside \"qx\"; qx, qy, qz, qw belong together\n\
         m.csv:1: column \"qw\" is missing beside \"qx\"; qx, qy, qz, qw belong together",
    );
    let left_out = |columns: &str| {
        let found = error(&format!("joint_1,joint_2,x,y,z,{columns}\n0,0,1,0,0,0,0,0\n"));
        let names = columns.replace(',', ", ");
        let expected =
            format!("m.csv:1: columns {names} look like an orientation and would be left out; write the orientation ");
        assert!(found.starts_with(&expected), "{found}");
        assert!(found.ends_with(", or rename them if they are something else"), "{found}");
    };
    for columns in ["roll,pitch,yaw", "A,B,C", "rx,ry,rz", "W,P,R", "Rot_x,Rot_y,Rot_z"] {
        left_out(columns);
    }
    assert!(error("joint_1,joint_2,x,y,z,q1,q2,q3,q4\n").contains("name a quaternion's columns qx, qy, qz, qw"));
}

#[test]
fn every_column_is_said_to_be_something() {
    let text = "joint_1,joint_2,x,y,z,time,joint_1.approach,operator,gain,locate\n0,0,1,0,0,5,1,ann,2,0\n1,1,0,1,0,6,-1,ben,3,0\n";
    let loaded = read("m.csv", text.as_bytes(), &planar_arm(), Units::default()).unwrap();
    assert_eq!(
        denavit_measurements::columns::in_words(&loaded.columns),
        "joint_1, joint_2 (joint reading); x, y, z (position of the target); time; joint_1.approach (approach of joint_1); \
         operator (label); gain (recorded number); locate (rows that place a target)"
    );
}

#[test]
fn a_row_that_begins_with_a_spreadsheets_error_is_no_comment() {
    for fault in ["#N/A", "#REF!", "#DIV/0!"] {
        check(
            &format!("# a comment\njoint_1,joint_2,x,y,z\n0,0,1,0,0\n{fault},0,1,0,0\n#0,0,1,0,0\n"),
            &format!(
                "m.csv:4: column \"joint_1\": \"{fault}\" is not a number; the spreadsheet could not compute it: correct the cell or remove the row"
            ),
        );
    }
}

#[test]
fn rows_that_judge_must_be_others_and_as_complete() {
    let chain = planar_arm();
    let rows = |seed, names: &[&str]| {
        let covariate = |name: &&str| Covariate { name: (*name).into(), values: (0..40).map(f64::from).collect() };
        let covariates = names.iter().map(covariate).collect();
        simulate(&chain, &SimulationOptions { rows: 40, seed, covariates, ..Default::default() }, &NoEffects).data
    };
    assert_eq!(
        calibration_error(rows(1, &[]), Some(rows(1, &[])), None),
        "simulation: these are the rows of simulation; a test needs rows that were not fitted: measure some, or say \
         ‹hold-out› 0.3"
    );
    let identify = IdentifyOptions::axes(&chain);
    let trace = Some(TraceOptions::new(identify));
    let options = CalibrateOptions { trace, ..CalibrateOptions::geometry(&chain) };
    let error = calibrate(&chain, &Statics::of_chain(&chain), rows(1, &["temperature"]), Some(rows(2, &[])), &options);
    assert_eq!(
        error.unwrap_err().to_string(),
        "simulation: column \"temperature\" of simulation is missing here, but effects may depend on it; add it, or remove it \
         from both files"
    );
}

#[test]
fn held_out_rows_that_are_far_off_are_flagged() {
    let chain = planar_arm();
    let run = simulate(&chain, &SimulationOptions { rows: 60, ..Default::default() }, &NoEffects);
    let mut test =
        simulate_arm(&run.arm, &SimulationOptions { rows: 30, seed: 4, ..Default::default() }, &NoEffects).data;
    test.observed.values_mut(7)[1] += 0.02;
    let line = test.lines[7];
    let options = CalibrateOptions::geometry(&chain);
    let result = calibrate(&chain, &Statics::of_chain(&chain), run.data, Some(test), &options).unwrap();
    assert_eq!(result.report.samples.test_outliers, [line]);
    let said = denavit_calibrate::report::text::report(&result);
    assert!(said.contains(&format!("held-out rows with gross errors, counted nevertheless, lines: {line}")), "{said}");
}

#[test]
fn lines_are_counted_with_comments_and_any_line_end() {
    check(
        "# a\n\njoint_1,joint_2,x,y,z\n# b\n# c\n0,a,1,0,0",
        "m.csv:6: column \"joint_2\": \"a\" is not a number; correct the cell or remove the row",
    );
    check(
        "# a\r\njoint_1,joint_2,x,y,z\r\n0,a,1,0,0\r\n",
        "m.csv:3: column \"joint_2\": \"a\" is not a number; correct the cell or remove the row",
    );
}

#[test]
fn cells() {
    let row = |cells: &str| format!("joint_1,joint_2,x,y,z,temperature\n0,0,1,0,0,20\n{cells}\n");
    check(
        &row("0,0,1,0,0"),
        "m.csv:3: 5 cells, but the header names 6 columns; write an empty cell for what was not seen",
    );
    check(
        &row("0,5,0,1,0,0,20"),
        "m.csv:3: 7 cells, but the header names 6 columns; is a decimal comma or an unquoted comma in it?",
    );
    check(
        &row("0,abc,1,0,0,20"),
        "m.csv:3: column \"joint_2\": \"abc\" is not a number; correct the cell or remove the row",
    );
    check(
        &row("0,\"0,5\",1,0,0,20"),
        "m.csv:3: column \"joint_2\": \"0,5\" is not a number; write the decimal point as a dot",
    );
    check(
        &row("0,0,NaN,0,0,20"),
        "m.csv:3: column \"x\": \"NaN\" is not finite; leave the cells of a target empty where it was not seen",
    );
    check(
        &row("inf,0,1,0,0,20"),
        "m.csv:3: column \"joint_1\": \"inf\" is not finite; correct the cell or remove the row",
    );
    check(
        &row(",0,1,0,0,20"),
        "m.csv:3: column \"joint_1\" is empty; every row needs this value: fill it in or remove the row",
    );
    check(
        &row("0,0,1,,0,20"),
        "m.csv:3: target \"\" has some of x, y, z but not all; leave all empty where it was not seen",
    );
    check(
        &row("0,0,1,0,0,warm"),
        "m.csv:3: column \"temperature\": \"warm\" is not a number; correct the cell or remove the row",
    );
    check(
        &row("0,0,1,0,0,"),
        "m.csv:3: column \"temperature\" is empty; every row needs this value: fill it in or remove the row",
    );
    check(
        "joint_1,joint_2,x,y,z,qx,qy,qz,qw\n0,0,1,0,0,1,1,0,0\n",
        "m.csv:2: the quaternion has length 1.414214, not 1; the columns are qx,qy,qz,qw in this order of meaning",
    );
    check(
        "joint_1,joint_2,distance\n0,0,-1\n",
        "m.csv:2: distance -1 is not positive; it is the length in m from the anchor to the target",
    );
    check(
        "joint_1,joint_2,x,y,z,joint_1.approach\n0,0,1,0,0,1\n0,0,1,0,0,2\n",
        "m.csv:3: column \"joint_1.approach\": 2 is not a side; write 1 or -1, or 0 where it is unknown",
    );
    check(
        "joint_1,joint_2,x,y,z,locate\n0,0,1,0,0,yes\n",
        "m.csv:2: column \"locate\": \"yes\" is not a number; correct the cell or remove the row",
    );
    check("joint_1,joint_2,x,y,z,locate\n0,0,1,0,0,2\n", "m.csv:2: column \"locate\": 2 is neither 0 nor 1");
    check("joint_1,joint_2,x,y,z\n0,0,,,\n", "m.csv: no row has a measured value; every cell of the targets is empty");
    let many = format!("joint_1,joint_2,x,y,z\n{}", "a,0,1,0,0\n".repeat(14));
    assert!(error(&many).ends_with("\n… and 4 more"), "{}", error(&many));
    let bytes = b"joint_1,joint_2,x,y,z\n0,0,1,0,\xff\n";
    let text = read("m.csv", &bytes[..], &planar_arm(), Units::default()).unwrap_err().to_string();
    assert_eq!(text, "m.csv:2: column \"z\": \"ÿ\" is not a number; correct the cell or remove the row");
}

#[test]
fn units() {
    check(
        "joint_1,joint_2,x,y,z\n10,20,1,0,0\n90,45,1,0,0\n",
        "m.csv:3: joint \"joint_1\" reads 90 rad, and its limits are -2.900 to 2.900 rad; if the readings are in degrees, \
         say ‹units› deg\nm.csv:3: joint \"joint_2\" reads 45 rad, and its limits are -2.900 to 2.900 rad; if the readings \
         are in degrees, say ‹units› deg",
    );
    check(
        "joint_1,joint_2,x,y,z\n0,0,1500,0,0\n1,1,0,1500,0\n",
        "m.csv: the measured positions span 2121.3203 m, but no two places that this robot can reach are further apart than \
         3.0000 m; if the lengths are in millimetres, say ‹units› mm",
    );
    let in_mm = "joint_1,joint_2,x,y,z\n0,0,1500,0,0\n90,0,0,1500,0\n";
    let data = read("m.csv", in_mm.as_bytes(), &planar_arm(), "mm,deg".parse().unwrap()).unwrap().data;
    assert!((data.position(1, 0).unwrap().y - 1.5).abs() < 1e-15 && (data.reading(1)[0] - 1.5708).abs() < 1e-4);
    let wrong = "mm,furlong".parse::<Units>().unwrap_err().to_string();
    assert!(wrong.starts_with("units \"mm,furlong\": \"furlong\" is not one of m, "), "{wrong}");
    assert!(wrong.ends_with("; write for example mm,deg"), "{wrong}");
}

#[test]
fn what_is_no_failure_is_noted() {
    let found = notes(
        "\u{feff}joint_1,joint_2,x1,y1,z1,x2,y2,z2,x3,y3,z3,who\n0,0.5,1,0,0,1,0,0,,,,ann\n1,0.5,0,1,0,0,1,0,,,,ben\n",
    );
    let texts: Vec<String> = found.iter().map(ToString::to_string).collect();
    assert_eq!(
        texts,
        [
            "target 2 repeats target 1 in every row; it is counted once",
            "no row sees target 3; it is left out",
            "joint \"joint_2\" is at 0.5 in every row; the data cannot separate its axis from its neighbours'",
        ]
    );
    assert_eq!(
        notes("joint_1,joint_2,x,y,z\n0,0,1,0,0\n3.2,1,0,1,0\n")[0].to_string(),
        "joint \"joint_1\" is outside its limits in 1 rows"
    );
}

#[test]
fn what_is_written_is_read_again() {
    for kind in [ObservationKind::Pose, ObservationKind::Position, ObservationKind::Distance] {
        let run = simulate(
            &planar_arm(),
            &SimulationOptions { kind, rows: 20, targets: 2, ..Default::default() },
            &NoEffects,
        );
        let text = write(&run.data, &["made up".into()]);
        let mut again = read("simulation", text.as_bytes(), &planar_arm(), Units::default()).unwrap().data;
        for at in 0..again.observations() {
            let written = run.data.observed.values(at);
            for (a, b) in again.observed.values_mut(at).iter_mut().zip(written) {
                assert!((*a - b).abs() < 1e-14);
                *a = *b;
            }
        }
        again.lines.clone_from(&run.data.lines);
        assert_eq!(again, run.data);
    }
}

fn calibration_error(data: Measurements, test: Option<Measurements>, hold_out: Option<f64>) -> String {
    let chain = planar_arm();
    let options = CalibrateOptions {
        hold_out: hold_out.map(|share| HoldOut { share, seed: 0 }),
        ..CalibrateOptions::geometry(&chain)
    };
    calibrate(&chain, &Statics::of_chain(&chain), data, test, &options).unwrap_err().to_string()
}

#[test]
fn data_that_cannot_be_fitted() {
    let of =
        |kind, rows| simulate(&planar_arm(), &SimulationOptions { kind, rows, ..Default::default() }, &NoEffects).data;
    assert_eq!(
        calibration_error(of(ObservationKind::Position, 3), None, None),
        "simulation: 3 rows hold 9 measured numbers, but 9 are needed to place the instrument and the targets, and a few more \
         as a check; measure more poses"
    );
    let mut mixed = of(ObservationKind::Position, 60);
    let observed = mixed.observed.subset((0..60).map(|row| (row + 7) % 60), Some);
    mixed.observed = observed;
    let text = calibration_error(mixed, None, None);
    assert!(
        text.starts_with("simulation: the fitted robot explains nothing: the measured position varies by 1"),
        "{text}"
    );
    assert!(text.ends_with("are all units right (‹units›)?"), "{text}");
    assert_eq!(
        calibration_error(of(ObservationKind::Position, 40), Some(of(ObservationKind::Pose, 5)), None),
        "simulation: it holds poses, but the model was fitted to positions; test with the same kind of value"
    );
    let mut other = of(ObservationKind::Position, 5);
    other.scene.targets = vec!["7".into()];
    assert_eq!(
        calibration_error(of(ObservationKind::Position, 40), Some(other), None),
        "simulation: target \"7\" is not among the fitted ones () and no row places it; set locate = 1 in a row that sees \
         it, or measure a fitted target"
    );
    assert_eq!(
        calibration_error(of(ObservationKind::Position, 40), None, Some(1.5)),
        "‹hold-out› 1.5: give the share of rows to keep for the test, between 0 and 1; both parts need postures of their own"
    );
}
