//! No call by a user of the libraries panics.

use crate::support::robot;
use denavit_calibrate::calibration::{CalibrateError, CalibrateOptions, calibrate};
use denavit_dh::{Convention, Options, ToolPart};
use denavit_export::formats::FORMATS;
use denavit_export::sheet::Sheet;
use denavit_identify::effects::driver::{Conditions, Driver, Posture, Statics};
use denavit_measurements::{self, Covariate, Covariates, Measurements, Units};
use denavit_model::{Chain, Reading, Robot};

fn arm() -> (Robot, Chain) {
    let text = std::fs::read_to_string(robot("universal_robots/ur5e.urdf")).unwrap();
    let arm = denavit_model::urdf::read("arm.urdf", &text).unwrap();
    let chain = arm.chain(None, None, Reading::Intended).unwrap().value;
    (arm, chain)
}

/// Rows of measured values: numbers after the six joints.
fn measured(chain: &Chain, columns: &str, rows: &[String]) -> Measurements {
    let joints: Vec<&str> = chain.coordinates().iter().map(|joint| joint.name.as_str()).collect();
    let file = format!("{},{columns}\n{}", joints.join(","), rows.concat());
    denavit_measurements::read("data.csv", file.as_bytes(), chain, Units::default()).unwrap().data
}

#[test]
fn a_file_of_distances_has_no_positions() {
    let (_, chain) = arm();
    let rows: Vec<String> = (0..4u32).map(|k| format!("0,-1,1,0,0.{k},0,1.{k}\n")).collect();
    let data = measured(&chain, "distance", &rows);
    for (row, target) in [(0, 0), (3, 0), (0, 7), (99, 0)] {
        assert_eq!(data.position(row, target), None);
    }
}

#[test]
fn a_table_without_rows_is_written_or_refused() {
    let (_, chain) = arm();
    let mut table = denavit_dh::convert::table(&chain, &Options::default()).unwrap().value;
    table.rows.clear();
    table.tool = ToolPart { theta: 0.0, d: 0.0 };
    for convention in [Convention::Distal, Convention::Proximal] {
        let sheet = Sheet {
            table: &table,
            convention,
            units: denavit_export::numbers::Units::default(),
            notes: &[],
            source: "arm.urdf",
            gauge: "simple",
        };
        for format in FORMATS {
            let written = (format.render)(&sheet);
            println!("{}: {}", format.name, written.map_or_else(|error| error.to_string(), |_| "written".to_owned()));
        }
    }
    // What is missing moves nothing: the joints alone are left.
    assert!(table.fk(&[0.3; 6]).translation.vector.norm() < 1e-15);
}

#[test]
fn knots_of_a_users_own_may_be_any() {
    let (robot, chain) = arm();
    let statics = Statics::of(&robot, &chain);
    let recorded = Covariates::from(vec![Covariate { name: "temperature".into(), values: vec![20.0] }]);
    let temperature = recorded.column("one row", 1, "temperature").unwrap();
    for knots in [vec![], vec![20.0], vec![20.0, 20.0], vec![30.0, 10.0, 20.0], vec![f64::NAN, 1.0]] {
        let driver = Driver::Smooth { covariate: temperature.clone(), knots: knots.clone() };
        let conditions = Conditions { reading: &[0.0; 6], recorded: recorded.row(0), tip: 0 };
        let mut values = Vec::new();
        driver.values_into(&statics, &conditions, &Posture::default(), &mut values);
        assert_eq!(values.len(), driver.len(&statics), "{knots:?}");
    }
}

#[test]
fn gravity_and_links_stand_where_the_chain_does() {
    // Angles of four digits are read as a quarter turn; of a file that says so in full the same must come out.
    let file = |quarter: &str| {
        format!(
            "<robot name=\"r\"><link name=\"a\"/>\
             <link name=\"b\"><inertial><origin xyz=\"0 0 0.4\"/><mass value=\"9\"/>\
             <inertia ixx=\"1\" iyy=\"1\" izz=\"1\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial></link><link name=\"c\"/>\
             <joint name=\"j\" type=\"revolute\"><parent link=\"a\"/><child link=\"b\"/><origin xyz=\"0 0 1\" \
             rpy=\"{quarter} 0 0\"/><axis xyz=\"0 0 1\"/><limit lower=\"-1\" upper=\"1\" velocity=\"1\" effort=\"1\"/></joint>\
             <joint name=\"k\" type=\"revolute\"><parent link=\"b\"/><child link=\"c\"/><origin xyz=\"0 0 2\"/>\
             <axis xyz=\"1 0 0\"/><limit lower=\"-1\" upper=\"1\" velocity=\"1\" effort=\"1\"/></joint></robot>"
        )
    };
    let statics = |quarter: &str| {
        let robot = denavit_model::urdf::read("r.urdf", &file(quarter)).unwrap();
        let chain = robot.chain(None, None, Reading::Intended).unwrap().value;
        Statics::of(&robot, &chain)
    };
    let (rounded, full) = (statics("1.571"), statics("1.5707963267948966"));
    assert_eq!(rounded.masses, full.masses);
    assert_eq!(rounded.points, full.points);
    // As written they would be some 0.4 mm apart.
    assert!((full.points[1].y + 2.0).abs() < 1e-12, "{}", full.points[1]);
}

#[test]
fn a_fit_that_did_not_converge_is_no_result() {
    let (_, chain) = arm();
    let rows: Vec<String> = (0..40u32)
        .map(|k| {
            let angle = |joint: u32| 2.0 * f64::from((k * (joint + 3) * 7) % 40) / 40.0 - 1.0;
            let reading: Vec<f64> = (0..6).map(angle).collect();
            let tip = chain.fk(&reading).translation.vector;
            let reading: Vec<String> = reading.iter().map(f64::to_string).collect();
            format!("{},{},{},{}\n", reading.join(","), tip.x * 1.0005, tip.y, tip.z)
        })
        .collect();
    let data = measured(&chain, "x,y,z", &rows);
    let run = |most_iterations| {
        let mut options = CalibrateOptions::geometry(&chain);
        options.identify.fit.most_iterations = most_iterations;
        calibrate(&chain, &Statics::of_chain(&chain), data.clone(), None, &options)
    };
    assert!(run(60).is_ok());
    let error = run(1).unwrap_err();
    assert!(matches!(error, CalibrateError::NotConverged { iterations: 1, .. }), "{error}");
    assert!(error.to_string().contains("did not converge in 1 steps, so there is no result: "), "{error}");
}
