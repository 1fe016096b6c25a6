//! Exports of makers' programs and of real instruments beside the same numbers in our own form.

use super::diagnosis::{robot, universal_robot};
use super::measured::measured;
use denavit_identify::parameters::NoEffects;
use denavit_identify::simulate::{SimulationOptions, simulate};
use denavit_measurements::import::{self, ImportOptions, Map};
use denavit_measurements::kinds::ObservationKind;
use denavit_measurements::{Loaded, Measurements, Units, read, read_export, write};
use denavit_model::Chain;
use std::fmt::Write as _;

fn ur5e() -> Chain {
    robot("universal_robots/ur5e.urdf")
}

fn simulated(chain: &Chain, kind: ObservationKind) -> Measurements {
    simulate(chain, &SimulationOptions { kind, rows: 12, ..SimulationOptions::default() }, &NoEffects).data
}

/// The joint values as a UR script has them.
fn script(data: &Measurements) -> String {
    (0..data.len()).fold(String::new(), |mut text, row| {
        let values: Vec<String> = data.reading(row).iter().map(f64::to_string).collect();
        let _ = writeln!(text, "movej([{}], a=1.4, v=1.05)", values.join(","));
        text
    })
}

/// Reads an export whose joint values stand in a program, with a map.
fn imported(text: &str, data: &Measurements, chain: &Chain, map: &str) -> Loaded {
    let options = ImportOptions {
        map: Some(Map::read("map.toml", map).unwrap()),
        joints: Some(import::joints("cal.script", &script(data)).unwrap()),
        ..ImportOptions::default()
    };
    read_export("export", text.as_bytes(), chain, Units::default(), &options).unwrap_or_else(|error| panic!("{error}"))
}

/// Readings and observed values, to the last digit.
fn same(found: &Measurements, expected: &Measurements) {
    assert_eq!(found.readings, expected.readings);
    assert_eq!(found.observations(), expected.observations());
    for observation in 0..found.observations() {
        assert_eq!(found.observed.values(observation), expected.observed.values(observation));
    }
}

fn reread(data: &Measurements, chain: &Chain) -> Measurements {
    read("own.csv", write(data, &[]).as_bytes(), chain, Units::default()).unwrap().data
}

/// The same rows in our own form, positions in mm.
fn own_positions_in_mm(data: &Measurements, chain: &Chain, units: &str, joints: impl Fn(f64) -> f64) -> Measurements {
    let mut own = format!("{},x,y,z\n", data.joints.join(","));
    for (row, cells) in cells(data).iter().enumerate() {
        let joints: Vec<String> = data.reading(row).iter().map(|angle| joints(*angle).to_string()).collect();
        let [x, y, z] = [0, 1, 2].map(|k| cells[k] * 1e3);
        let _ = writeln!(own, "{},{x},{y},{z}", joints.join(","));
    }
    read("own.csv", own.as_bytes(), chain, units.parse().unwrap()).unwrap().data
}

/// A quaternion x, y, z, w and a place of each row, as our own form writes them.
fn cells(data: &Measurements) -> Vec<Vec<f64>> {
    (0..data.len())
        .map(|row| {
            let observation = data.of_row(row).next().unwrap();
            data.series_of(observation).kind.to_cells(data.observed.values(observation))
        })
        .collect()
}

/// OptiTrack Motive, a rigid body: docs.optitrack.com, "Data Export: CSV".
#[test]
fn motive_rigid_bodies() {
    let chain = ur5e();
    let data = simulated(&chain, ObservationKind::Pose);
    let mut text = String::from(
        "Format Version,1.23,Take Name,arm,Capture Frame Rate,120,Rotation Type,Quaternion,Length Units,Meters\n\n\
         ,,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body\n\
         ,,Tool,Tool,Tool,Tool,Tool,Tool,Tool,Tool\n\
         ,,9a3f6e1c-0d52-4c7b-8f8a-1a2b3c4d5e6f,9a3f6e1c-0d52-4c7b-8f8a-1a2b3c4d5e6f,,,,,,\n\
         ,,Rotation,Rotation,Rotation,Rotation,Position,Position,Position,Mean Marker Error\n\
         Frame,Time (Seconds),X,Y,Z,W,X,Y,Z,\n",
    );
    for (row, cells) in cells(&data).iter().enumerate() {
        let [x, y, z, qx, qy, qz, qw] = cells[..] else { panic!("{cells:?}") };
        let _ = writeln!(text, "{row},{},{qx},{qy},{qz},{qw},{x},{y},{z},0.0004", row as f64 * 0.5);
    }
    let map = "x = \"Position.X\"\ny = \"Position.Y\"\nz = \"Position.Z\"\ntime = \"Time (Seconds)\"\n\
               quaternion = { columns = [\"Rotation.X\", \"Rotation.Y\", \"Rotation.Z\", \"Rotation.W\"] }\n";
    let found = imported(&text, &data, &chain, map);
    same(&found.data, &reread(&data, &chain));
    assert_eq!(found.data.covariate("time").unwrap().values[3], 1.5);
}

/// Vicon Nexus, trajectories: help.vicon.com, "ASCII files".
#[test]
fn vicon_trajectories() {
    let chain = ur5e();
    let data = simulated(&chain, ObservationKind::Position);
    let mut text = String::from(
        "Trajectories\n100\n,,Tool:ball,,,Tool:other,,\nFrame,Sub Frame,X,Y,Z,X,Y,Z\n,,mm,mm,mm,mm,mm,mm\n",
    );
    for (row, cells) in cells(&data).iter().enumerate() {
        let [x, y, z] = [0, 1, 2].map(|k| cells[k] * 1e3);
        let _ = writeln!(text, "{},0,{x},{y},{z},1,2,3", row + 1);
    }
    let map = "x = \"Tool:ball.X\"\ny = \"Tool:ball.Y\"\nz = \"Tool:ball.Z\"\n";
    let expected = own_positions_in_mm(&data, &chain, "mm,rad", |angle| angle);
    same(&imported(&text, &data, &chain, map).data, &expected);
}

/// Qualisys Track Manager, markers: QTM user manual, "TSV file formats", motion data.
#[test]
fn qualisys_markers() {
    let chain = ur5e();
    let data = simulated(&chain, ObservationKind::Position);
    let mut text = String::from(
        "NO_OF_FRAMES\t12\nNO_OF_CAMERAS\t7\nNO_OF_MARKERS\t2\nFREQUENCY\t120\nNO_OF_ANALOG\t0\nANALOG_FREQUENCY\t0\n\
         DESCRIPTION\t--\nTIME_STAMP\t2014-06-17, 08:53:44\nDATA_INCLUDED\t3D\nMARKER_NAMES\tball\tother\n",
    );
    for cells in cells(&data) {
        let [x, y, z] = [0, 1, 2].map(|k| cells[k] * 1e3);
        let _ = writeln!(text, "{x}\t{y}\t{z}\t1\t2\t3");
    }
    let map = "units = \"mm,deg\"\nx = \"ball X\"\ny = \"ball Y\"\nz = \"ball Z\"\n";
    let expected = own_positions_in_mm(&data, &chain, "mm,rad", |angle| angle);
    same(&imported(&text, &data, &chain, map).data, &expected);
}

/// SpatialAnalyzer, its User's Manual, "Exporting ASCII Formatted Points": what is named of a point (collection, group and target,
/// group and target, target, nothing) before x y z, separated by blanks or commas, comments after `//`; with uncertainties
/// and time stamps behind them.
#[test]
fn points_of_spatial_analyzer() {
    let chain = ur5e();
    let data = simulated(&chain, ObservationKind::Position);
    let comments =
        "// SpatialAnalyzer 2024.1\n// Working Frame: A::WORLD\n// Cartesian coordinates: X Y Z, Millimeters\n";
    let expected = own_positions_in_mm(&data, &chain, "mm,rad", |angle| angle);
    for (named, behind) in [("A{s}ball run{s}p{n}", ""), ("ball_run{s}p{n}", ""), ("p{n}", "{s}0.012{s}0.011{s}0.02")] {
        for (separator, above) in [(", ", comments), (",", ""), (" ", comments), ("  ", "")] {
            // Names with blanks stand between commas alone.
            let named =
                if separator.trim().is_empty() { named.replace("ball run", "ball_run") } else { named.to_owned() };
            let words = |text: &str, row: usize| text.replace("{s}", separator).replace("{n}", &row.to_string());
            let mut text = above.to_owned();
            for (row, cells) in cells(&data).iter().enumerate() {
                let place = [0, 1, 2].map(|k| (cells[k] * 1e3).to_string()).join(separator);
                let _ = writeln!(text, "{}{separator}{place}{}", words(&named, row), words(behind, row));
            }
            let first = named.matches("{s}").count() + 2;
            let [x, y, z] = [first, first + 1, first + 2].map(|column| format!("\"column {column}\""));
            let map = format!("units = \"mm,deg\"\nx = {x}\ny = {y}\nz = {z}\n");
            println!("{text}");
            same(&imported(&text, &data, &chain, &map).data, &expected);
        }
    }
}

/// DELMIA, Auto ID (3DEXPERIENCE help, "Auto ID Input File"): a name, x, y, z in mm, roll, pitch, yaw in degrees, then the joint
/// values in degrees; tabs between columns, a header or none.
#[test]
fn measurements_of_delmia() {
    let chain = ur5e();
    let data = simulated(&chain, ObservationKind::Pose);
    let mut rows = String::new();
    let mut own = format!("{},x,y,z,roll,pitch,yaw\n", data.joints.join(","));
    for (row, cells) in cells(&data).iter().enumerate() {
        let [x, y, z, qx, qy, qz, qw] = cells[..] else { panic!("{cells:?}") };
        let quaternion = denavit_model::nalgebra::Quaternion::new(qw, qx, qy, qz);
        let (roll, pitch, yaw) = denavit_model::nalgebra::UnitQuaternion::new_normalize(quaternion).euler_angles();
        let place = [x, y, z].map(|value| (value * 1e3).to_string());
        let turned = [roll, pitch, yaw].map(|angle| angle.to_degrees().to_string());
        let joints: Vec<String> = data.reading(row).iter().map(|angle| angle.to_degrees().to_string()).collect();
        let _ = writeln!(rows, "Tag.{row}\t{}\t{}\t{}", place.join("\t"), turned.join("\t"), joints.join("\t"));
        let _ = writeln!(own, "{},{},{}", joints.join(","), place.join(","), turned.join(","));
    }
    let units: Units = "mm,deg".parse().unwrap();
    let euler = ImportOptions { euler: Some("xyz".parse().unwrap()), ..ImportOptions::default() };
    let expected = read_export("own.csv", own.as_bytes(), &chain, units, &euler).unwrap().data;
    let named = "Tag\tX\tY\tZ\tRoll\tPitch\tYaw\tJ1\tJ2\tJ3\tJ4\tJ5\tJ6\n";
    let numbered = |from: usize, to: usize| (from..=to).map(|column| format!("column {column}")).collect::<Vec<_>>();
    for header in ["", named] {
        let map = format!(
            "units = \"mm,deg\"\njoints = {:?}\nx = \"column 2\"\ny = \"column 3\"\nz = \"column 4\"\n\
             euler = {{ order = \"xyz\", columns = {:?} }}\n",
            numbered(8, 13),
            numbered(5, 7)
        );
        let options = ImportOptions { map: Some(Map::read("map.toml", &map).unwrap()), ..ImportOptions::default() };
        let text = format!("{header}{rows}");
        let found = read_export("auto.txt", text.as_bytes(), &chain, Units::default(), &options);
        same(&found.unwrap_or_else(|error| panic!("{error}")).data, &expected);
    }
}

/// RoboDK: the file of a calibration project, as `Python/Examples/Macros/CalculateErrorsDistances.py` of RoboDK-API reads it: a row
/// above, then six joints in degrees, the measured place and the target's place on the flange in mm. What the row above says
/// is not documented: columns are named by their place.
#[test]
fn measurements_of_robodk() {
    let chain = ur5e();
    let data = simulated(&chain, ObservationKind::Position);
    let mut text = String::from("a,row,that,nobody,documents,at,all,but,skips,without,reading,it\n");
    for (row, cells) in cells(&data).iter().enumerate() {
        let joints: Vec<String> = data.reading(row).iter().map(|angle| angle.to_degrees().to_string()).collect();
        let [x, y, z] = [0, 1, 2].map(|k| cells[k] * 1e3);
        let _ = writeln!(text, "{},{x},{y},{z},12.5,-30,104.25", joints.join(","));
    }
    let expected = own_positions_in_mm(&data, &chain, "mm,deg", f64::to_degrees);
    let page = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/measurements.md")).unwrap();
    let mut map = page.split("```toml\n").skip(1).map(|rest| rest.split("```").next().unwrap());
    let map = map.find(|map| map.contains("column 7")).unwrap();
    let options = ImportOptions { map: Some(Map::read("map.toml", map).unwrap()), ..ImportOptions::default() };
    let found = read_export("robodk.csv", text.as_bytes(), &chain, Units::default(), &options);
    same(&found.unwrap_or_else(|error| panic!("{error}")).data, &expected);
}

/// A list of points without a header, as a point list of a tracker's program may be: name, x, y, z.
#[test]
fn a_bare_list_of_points() {
    let chain = ur5e();
    let data = simulated(&chain, ObservationKind::Position);
    let mut text = String::new();
    for (row, cells) in cells(&data).iter().enumerate() {
        let _ = writeln!(text, "P{row} {} {} {}", cells[0], cells[1], cells[2]);
    }
    let map = "x = \"column 2\"\ny = \"column 3\"\nz = \"column 4\"\n";
    same(&imported(&text, &data, &chain, map).data, &reread(&data, &chain));
}

const IPA: &str = "units = \"mm,rad\"\n\
    temperature = \"measurement_temperature\"\n\
    x = \"measurement_x\"\ny = \"measurement_y\"\nz = \"measurement_z\"\n\
    \"x.std\" = \"measurement_std_x\"\n\"y.std\" = \"measurement_std_y\"\n\"z.std\" = \"measurement_std_z\"\n\
    euler = { order = \"XYZ\", columns = [\"measurement_rx (deg)\", \"measurement_ry (deg)\", \"measurement_rz (deg)\"] }\n";

#[test]
fn the_ur10_of_a_laboratory_as_it_was_published() {
    let (Some(path), Some(own)) =
        (measured("ipa_ur10/joint_configurations_as_published.csv"), measured("ipa_ur10/joint_configurations.csv"))
    else {
        return;
    };
    assert!(IPA.lines().count() <= 10);
    let chain = universal_robot([0.1273, -0.612, -0.5723, 0.163_941, 0.1157, 0.0922]);
    let bytes = std::fs::read(&path).unwrap();
    let options = ImportOptions { map: Some(Map::read("map.toml", IPA).unwrap()), ..ImportOptions::default() };
    let found = read_export("published.csv", &bytes[..], &chain, Units::default(), &options).unwrap();
    let said: Vec<String> = found.notes.iter().map(ToString::to_string).collect();
    assert!(said.iter().any(|note| note == "decimal commas"), "{said:?}");
    assert!(said.iter().any(|note| note.contains("left out") && note.contains("Goal roll")), "{said:?}");
    // Every number as the published text has it, read here by hand.
    let text = String::from_utf8(bytes).unwrap();
    let mut lines = text.trim_start_matches('\u{feff}').lines();
    let names: Vec<&str> = lines.next().unwrap().split(';').collect();
    let at = |name: &str| names.iter().position(|known| *known == name).unwrap();
    let mut rows = 0;
    for (row, line) in lines.enumerate() {
        let number = |name: &str| line.split(';').nth(at(name)).unwrap().replace(',', ".").parse::<f64>().unwrap();
        let joints: Vec<f64> = chain.coordinates().iter().map(|joint| number(&joint.name)).collect();
        assert_eq!(found.data.reading(row), joints);
        let place = found.data.position(row, 0).unwrap();
        let expected = ["measurement_x", "measurement_y", "measurement_z"].map(|name| number(name) * 1e-3);
        assert_eq!([place.x, place.y, place.z], expected, "line {}", row + 2);
        rows += 1;
    }
    assert_eq!((rows, found.data.len()), (1495, 1495));
    // The same set in our own form, whose quaternions were computed elsewhere and rounded to nine places.
    let own = read("own.csv", std::fs::File::open(own).unwrap(), &chain, Units::default()).unwrap().data;
    let mut worst = 0.0f64;
    for observation in 0..own.observations() {
        for (a, b) in found.data.observed.values(observation).iter().zip(own.observed.values(observation)) {
            worst = worst.max((a - b).abs());
        }
    }
    println!("largest difference from the converted set: {worst:e}");
    assert!(worst < 3e-9, "{worst:e}");
}

#[test]
fn the_ur5_of_a_thesis_as_it_was_published() {
    let Some(path) = measured("jacobi_ur5/as_published.csv") else { return };
    let map = "units = \"mm,deg\"\n\
               joints = [\"joint_1\", \"joint_2\", \"joint_3\", \"joint_4\", \"joint_5\", \"joint_6\"]\n\
               x = [\"x_t\", \"x_dif\"]\ny = [\"y_t\", \"y_dif\"]\nz = [\"z_t\", \"z_dif\"]\n";
    let chain = universal_robot([0.089_159, -0.425, -0.392_25, 0.109_15, 0.094_65, 0.0823]);
    let text = std::fs::read_to_string(path).unwrap();
    let options = ImportOptions { map: Some(Map::read("map.toml", map).unwrap()), ..ImportOptions::default() };
    let found = read_export("published.csv", text.as_bytes(), &chain, Units::default(), &options).unwrap().data;
    // The same in our own form, added up here.
    let joints: Vec<&str> = chain.coordinates().iter().map(|joint| joint.name.as_str()).collect();
    let mut own = format!("{},x,y,z\n", joints.join(","));
    for line in text.lines().skip(1).filter(|line| !line.trim().is_empty()) {
        let cells: Vec<f64> = line.split(',').map(|cell| cell.trim().parse().unwrap()).collect();
        let angles: Vec<String> = cells[7..13].iter().map(f64::to_string).collect();
        let sum = |k: usize| cells[1 + k] + cells[4 + k];
        let _ = writeln!(own, "{},{},{},{}", angles.join(","), sum(0), sum(1), sum(2));
    }
    let expected = read("own.csv", own.as_bytes(), &chain, "mm,deg".parse().unwrap()).unwrap().data;
    assert!(found.len() >= 10, "{}", found.len());
    same(&found, &expected);
}

#[test]
fn every_reader_takes_any_form() {
    use denavit_measurements::poses;
    let chain = ur5e();
    let names: Vec<&str> = chain.coordinates().iter().map(|joint| joint.name.as_str()).collect();
    let shown: Vec<String> = names.iter().map(|name| format!("{} (deg)", name.to_uppercase())).collect();
    let text = format!("{}\n10,5;-90;90;0;1;2\n", shown.join(";"));
    let found = poses::read_joints("poses.csv", text.as_bytes(), &chain, Units::default()).unwrap();
    assert_eq!(
        found,
        [[10.5, -90.0, 90.0, 0.0, 1.0, 2.0].map(|degrees: f64| degrees * (std::f64::consts::PI / 180.0))]
    );
    let poses_text = "x;y;z;roll;pitch;yaw\n400,5;200;500;180;0;0\n";
    let units: Units = "mm,deg".parse().unwrap();
    let found = poses::read("poses.csv", poses_text.as_bytes(), &chain, units).unwrap();
    let plain =
        poses::read("poses.csv", poses_text.replace(',', ".").replace(';', ",").as_bytes(), &chain, units).unwrap();
    assert_eq!(found, plain);
}

#[test]
fn maps_of_the_documentation_are_maps() {
    let page = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/measurements.md");
    let page = std::fs::read_to_string(page).unwrap();
    let blocks: Vec<&str> = page.split("```toml\n").skip(1).map(|rest| rest.split("```").next().unwrap()).collect();
    assert_eq!(blocks.len(), 4);
    for block in &blocks {
        Map::read("measurements.md", block).unwrap_or_else(|error| panic!("{error}"));
    }
    assert_eq!(Map::read("a", blocks[0]).unwrap(), Map::read("b", IPA).unwrap());
}
