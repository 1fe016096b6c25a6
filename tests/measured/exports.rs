//! Any export: each form of a file gives the same result as the same data in our own form, to the last digit.

use crate::support::{Run, denavit_in, robot};
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// A folder with an arm and measurements of it, full poses in m and rad.
struct Room(TempDir);

/// Header and rows.
type Rows = (Vec<String>, Vec<Vec<f64>>);

impl Room {
    fn new() -> Self {
        let room = Self(tempfile::tempdir().unwrap());
        std::fs::copy(robot("universal_robots/ur5e.urdf"), room.path("arm.urdf")).unwrap();
        room.run("simulate arm.urdf --measure poses --rows 40 --columns temperature -o own.csv").succeeded();
        room
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn write(&self, name: &str, bytes: impl AsRef<[u8]>) {
        std::fs::write(self.path(name), bytes).unwrap();
    }

    fn run(&self, line: &str) -> Run {
        denavit_in(self.0.path(), &line.split_whitespace().collect::<Vec<_>>())
    }

    /// The report of a calibration without the names of the file and its columns.
    fn report(&self, data: &str) -> serde_json::Value {
        let run = self.run(&format!("calibrate arm.urdf --effects none --json --data {data}"));
        let mut json: serde_json::Value = serde_json::from_str(&run.succeeded()).unwrap();
        json.as_object_mut().unwrap().remove("columns");
        json.as_object_mut().unwrap().remove("origin");
        // Another form has the same row in another line.
        for row in json["rows"].as_array_mut().unwrap() {
            row.as_object_mut().unwrap().remove("line");
        }
        json
    }

    /// The data in our own form.
    fn own(&self) -> Rows {
        rows(&self.path("own.csv"))
    }
}

fn rows(path: &Path) -> Rows {
    let text = std::fs::read_to_string(path).unwrap();
    let mut lines = text.lines().filter(|line| !line.starts_with('#'));
    let names = lines.next().unwrap().split(',').map(str::to_owned).collect();
    (names, lines.map(|line| line.split(',').map(|cell| cell.parse().unwrap()).collect()).collect())
}

/// A table as text, its cells written by `cell`.
fn table(names: &[String], rows: &[Vec<f64>], separator: &str, cell: impl Fn(usize, f64) -> String) -> String {
    let line = |row: &Vec<f64>| row.iter().enumerate().map(|(k, x)| cell(k, *x)).collect::<Vec<_>>().join(separator);
    let lines: Vec<String> = rows.iter().map(line).collect();
    format!("{}\n{}\n", names.join(separator), lines.join("\n"))
}

fn plain(_: usize, value: f64) -> String {
    value.to_string()
}

#[test]
fn every_form_of_text_is_the_same_data() {
    let room = Room::new();
    let (names, rows) = room.own();
    let own = room.report("own.csv");
    let commas = |_: usize, value: f64| value.to_string().replace('.', ",");
    let semicolons = table(&names, &rows, ";", commas);
    let tabs = table(&names, &rows, "\t", plain);
    let utf16 = |text: &str, big: bool| -> Vec<u8> {
        let unit = |unit: u16| if big { unit.to_be_bytes() } else { unit.to_le_bytes() };
        std::iter::once(0xfeff).chain(text.encode_utf16()).flat_map(unit).collect()
    };
    // A degree sign in cp1252, which is not UTF-8, in a name and a preamble.
    let mut cp1252 = b"Meas\xfcrements of an arm\r\n\r\n".to_vec();
    let capitals: Vec<String> = names.iter().map(|name| format!("{} [?]", name.to_uppercase())).collect();
    let units = |name: &String| match name.as_str() {
        name if name.ends_with("_joint") => "rad",
        "x" | "y" | "z" => "m",
        _ => "-",
    };
    let named: Vec<String> = capitals.iter().zip(&names).map(|(shown, name)| shown.replace('?', units(name))).collect();
    cp1252.extend(table(&named, &rows, ";", plain).replace('\n', "\r\n").bytes());
    let row_of_units = names.iter().map(units).collect::<Vec<_>>().join(",");
    let with_units = table(&names, &rows, ",", plain).replacen('\n', &format!("\n{row_of_units}\n"), 1);
    for (file, bytes, said) in [
        ("semicolons.csv", semicolons.clone().into_bytes(), "decimal commas"),
        ("tabs.txt", tabs.clone().into_bytes(), "columns separated by tabs"),
        ("marked.csv", [b"\xef\xbb\xbf", semicolons.as_bytes()].concat(), "columns separated by semicolons"),
        ("little.txt", utf16(&tabs, false), "text in UTF-16LE"),
        ("big.txt", utf16(&semicolons, true), "text in UTF-16BE"),
        ("windows.csv", cp1252, "\"X [m]\" read as x"),
        ("units.csv", with_units.into_bytes(), "line 2 is a row of units"),
    ] {
        room.write(file, bytes);
        let run = room.run(&format!("identify arm.urdf --data {file}"));
        assert_eq!(run.code, 0, "{file}: {}", run.stderr);
        let run = room.run(&format!("calibrate arm.urdf --effects none --data {file}"));
        assert!(run.stderr.contains(said), "{file}: {}", run.stderr);
        assert_eq!(room.report(file), own, "{file}");
    }
}

#[test]
fn units_by_column_are_the_same_data() {
    let room = Room::new();
    let (names, rows) = room.own();
    // The reference in mm and degrees, by --units; the same with the units in the names, whatever --units says.
    let shown = |k: usize, value: f64| match names[k].as_str() {
        name if name.ends_with("_joint") => value.to_degrees().to_string(),
        "x" | "y" | "z" => (value * 1e3).to_string(),
        _ => value.to_string(),
    };
    room.write("reference.csv", table(&names, &rows, ",", shown));
    let reference = room.report("reference.csv --units mm,deg");
    let unit = |name: &String| match name.as_str() {
        joint if joint.ends_with("_joint") => format!("{joint} (deg)"),
        "x" | "y" | "z" => format!("{} [mm]", name.to_uppercase()),
        _ => name.clone(),
    };
    let named: Vec<String> = names.iter().map(unit).collect();
    room.write("named.csv", table(&named, &rows, ",", shown));
    assert_eq!(room.report("named.csv"), reference);
    assert_eq!(room.report("named.csv --units m,rad"), reference);
    let run = room.run("calibrate arm.urdf --effects none --data named.csv");
    assert!(
        run.stderr.contains("\"elbow_joint (deg)\" read as elbow_joint, × 0.017453292519943295 rad"),
        "{}",
        run.stderr
    );
    assert!(run.stdout.contains("X [mm]"), "{}", run.stdout);
}

#[test]
fn a_map_says_what_names_do_not() {
    let room = Room::new();
    let (names, rows) = room.own();
    let own = room.report("own.csv");
    // Columns of other names and in another order, w first, with some that are not measurements.
    let other: Vec<String> = names
        .iter()
        .enumerate()
        .map(|(k, name)| if name == "temperature" { "Temp".into() } else { format!("Col {k}") })
        .chain(["Goal".into(), "Part".into()])
        .collect();
    let more: Vec<Vec<f64>> = rows.iter().map(|row| row.iter().copied().chain([7.0, 8.0]).collect()).collect();
    room.write("other.csv", table(&other, &more, ";", plain));
    let at = |name: &str| other[names.iter().position(|known| known == name).unwrap()].clone();
    let joints: Vec<String> = names.iter().filter(|name| name.ends_with("_joint")).map(|name| at(name)).collect();
    let map = format!(
        "joints = {joints:?}\nx = {:?}\ny = {:?}\nz = {:?}\ntemperature = \"Temp\"\n\
         quaternion = {{ order = \"wxyz\", columns = {:?} }}\n",
        at("x"),
        at("y"),
        at("z"),
        ["qw", "qx", "qy", "qz"].map(at)
    );
    room.write("map.toml", &map);
    assert_eq!(room.report("other.csv --columns map.toml"), own);
    let run = room.run("calibrate arm.urdf --effects none --data other.csv --columns map.toml --verbose");
    assert!(run.stderr.contains("left out because the map does not name them: Goal, Part"), "{}", run.stderr);
    assert!(run.stderr.contains("read as qx, qy, qz, qw"), "{}", run.stderr);
    // On the command line, for a few columns.
    let renamed: Vec<String> =
        names.iter().map(|name| if name.len() == 1 { format!("P{name}") } else { name.clone() }).collect();
    room.write("few.csv", table(&renamed, &rows, ",", plain));
    let few = "few.csv --columns x=Px,y=Py,z=Pz,qx=qx,qy=qy,qz=qz,qw=qw,temperature=temperature";
    assert_eq!(room.report(few), own);
    // A draft names every column, and becomes a map when its gaps are filled.
    let draft = room.run("calibrate arm.urdf --data few.csv --columns-draft").succeeded();
    assert!(draft.contains("joints = [\"shoulder_pan_joint\", \"shoulder_lift_joint\""), "{draft}");
    assert!(draft.contains("x = \"Px\"") && draft.contains("#   \"temperature\" = "), "{draft}");
    room.write("draft.toml", draft.replace("units = \"mm,deg\"", "units = \"m,rad\""));
    room.run("calibrate arm.urdf --effects none --data few.csv --columns draft.toml").succeeded();
    // An output never replaces the map.
    let refused = room.run("calibrate arm.urdf --data few.csv --columns map.toml --html map.toml").failed();
    assert!(refused.contains("the run reads this file (as map.toml)"), "{refused}");
}

#[test]
fn orientations_in_other_forms_are_the_same_poses() {
    let room = Room::new();
    let (names, rows) = room.own();
    let place = names.iter().position(|name| name == "qx").unwrap();
    let before = &names[..place];
    let rotation = |row: &[f64]| {
        let [x, y, z, w] = [row[place], row[place + 1], row[place + 2], row[place + 3]];
        denavit_model::nalgebra::UnitQuaternion::new_normalize(denavit_model::nalgebra::Quaternion::new(w, x, y, z))
    };
    let own = room.report("own.csv");
    let figure = |report: &serde_json::Value| report["stages"][1]["train"]["orientation_rms_rad"].as_f64().unwrap();
    let with = |columns: &[&str], numbers: &dyn Fn(&[f64]) -> Vec<f64>| {
        let names: Vec<String> = before.iter().cloned().chain(columns.iter().map(|name| (*name).to_owned())).collect();
        let rows: Vec<Vec<f64>> =
            rows.iter().map(|row| row[..place].iter().copied().chain(numbers(row)).collect()).collect();
        table(&names, &rows, ",", plain)
    };
    // nalgebra's angles are roll, pitch, yaw about fixed axes: xyz, or ZYX about turned ones.
    let angles = |row: &[f64]| {
        let (roll, pitch, yaw) = rotation(row).euler_angles();
        vec![roll, pitch, yaw]
    };
    room.write("fixed.csv", with(&["roll", "pitch", "yaw"], &angles));
    room.write("kuka.csv", with(&["A", "B", "C"], &|row| angles(row).into_iter().rev().collect()));
    room.write("vector.csv", with(&["rx", "ry", "rz"], &|row| rotation(row).scaled_axis().iter().copied().collect()));
    room.write(
        "four.csv",
        with(&["q1", "q2", "q3", "q4"], &|row| vec![row[place + 3], row[place], row[place + 1], row[place + 2]]),
    );
    for line in
        ["fixed.csv --euler xyz", "kuka.csv --euler ZYX", "vector.csv --rotation-vector", "four.csv --quaternion wxyz"]
    {
        let report = room.report(line);
        assert!((figure(&report) - figure(&own)).abs() < 1e-12, "{line}: {} {}", figure(&report), figure(&own));
    }
    // With a wrong map the data do not fit the robot; without a map the columns are an error.
    for (line, said) in [
        ("fixed.csv --euler XYZ", "use --euler xyz"),
        ("fixed.csv", "columns roll, pitch, yaw"),
        ("four.csv", "columns q1, q2, q3, q4"),
        ("fixed.csv --euler XXY", "\"XXY\" is not an order of angles"),
        ("own.csv --euler XYZ", "no three columns are named like angles"),
        ("four.csv --quaternion wxy", "an order such as wxyz"),
    ] {
        let message = room.run(&format!("calibrate arm.urdf --effects none --data {line}")).failed();
        assert!(message.contains(said), "{line}: {message}");
    }
}

#[test]
fn bad_exports_get_one_message_with_place_and_fix() {
    let room = Room::new();
    let (names, rows) = room.own();
    let good = table(&names, &rows, ";", plain);
    let cell = rows[2][3].to_string();
    let spoilt = |by: &str| good.replacen(&format!(";{cell};"), &format!(";{by};"), 1);
    assert_ne!(spoilt("abc"), good);
    room.write("good.csv", &good);
    room.write("word.csv", spoilt("abc"));
    room.write("fault.csv", spoilt("#N/A"));
    room.write("empty.csv", spoilt(""));
    room.write("more.csv", spoilt("1;2"));
    room.write("inches.csv", good.replacen(";x;", ";x (furlongs);", 1));
    room.write("book.xlsx", b"PK\x03\x04 no workbook");
    room.write("none.txt", "nothing\tto\tsee\n");
    room.write("unknown.toml", "x = \"X9\"\ny = \"y\"\nz = \"z\"\n");
    room.write("broken.toml", "x = [\n");
    room.write("order.toml", "quaternion = { order = \"wxyy\", columns = [\"qw\", \"qx\", \"qy\", \"qz\"] }\n");
    room.write("length.toml", "quaternion = { order = \"xyzw\", columns = [\"qx\", \"qy\", \"qz\", \"x\"] }\n");
    room.write("joints.toml", "joints = [\"elbow_joint\"]\n");
    room.write("short.script", "movej([0,0,0,0,0,0])\n");
    room.write("poses.script", "movel(p[0,0,0,0,0,0])\n");
    for (line, said) in [
        (
            "word.csv",
            "word.csv:4: column \"wrist_1_joint\": \"abc\" is not a number; correct the cell or remove the row",
        ),
        ("fault.csv", "fault.csv:4: column \"wrist_1_joint\": \"#N/A\" is not a number"),
        ("empty.csv", "empty.csv:4: column \"wrist_1_joint\" is empty; every row needs this value"),
        ("more.csv", "more.csv:4: 15 cells where 14 columns are needed"),
        (
            "inches.csv",
            "inches.csv:1: column \"x (furlongs)\": the unit \"furlongs\" is not known for lengths; write one of m",
        ),
        ("book.xlsx", "book.xlsx: this Excel workbook cannot be read"),
        ("none.txt --columns x=a,y=b,z=c", "none.txt: there are no rows of three or more numbers"),
        (
            "good.csv --columns unknown.toml",
            "good.csv:1: there is no column \"X9\" (for x); the file has \"shoulder_pan_joint\"",
        ),
        ("good.csv --columns broken.toml", "broken.toml: "),
        ("good.csv --columns order.toml", "order \"wxyy\" is not one of x, y, z, w, each once"),
        ("good.csv --columns length.toml", "not 1; are these its columns"),
        ("good.csv --columns joints.toml", "the map names columns of 1 joints where 6 are needed"),
        ("good.csv --columns x=a,y", "\"y\" is not NAME=COLUMN"),
        ("good.csv --joints short.script", "there are 1 rows of joint values where 40 are needed"),
        ("good.csv --joints poses.script", "1 pose(s), which say where the tool was sent"),
    ] {
        let message = room.run(&format!("calibrate arm.urdf --effects none --data {line}")).failed();
        assert!(message.contains(said), "{line}: {message}");
    }
}

#[test]
fn joint_values_come_from_robot_programs() {
    let room = Room::new();
    let (names, rows) = room.own();
    let places =
        |wanted: bool| (0..names.len()).filter(|k| names[*k].ends_with("_joint") == wanted).collect::<Vec<_>>();
    let (joints, others) = (places(true), places(false));
    let only: Vec<Vec<f64>> = rows.iter().map(|row| others.iter().map(|k| row[*k]).collect()).collect();
    let named: Vec<String> = others.iter().map(|k| names[*k].clone()).collect();
    room.write("seen.csv", table(&named, &only, ",", plain));
    let list = |row: &Vec<f64>, cell: &dyn Fn(f64) -> String| {
        joints.iter().map(|k| cell(row[*k])).collect::<Vec<_>>().join(",")
    };
    let script: Vec<String> =
        rows.iter().map(|row| format!("  movej([{}], a=1.4, v=1.05)\n", list(row, &|x| x.to_string()))).collect();
    room.write("cal.script", format!("def cal():\n{}end\n", script.concat()));
    assert_eq!(room.report("seen.csv --joints cal.script"), room.report("own.csv"));
    // Conversion to degrees loses the last digit of rad; the reference is converted in the same way.
    let degrees = |x: f64| x.to_degrees().to_string();
    let back: Vec<Vec<f64>> = rows
        .iter()
        .map(|row| {
            let of = |(k, x): (usize, &f64)| {
                if joints.contains(&k) { degrees(*x).parse::<f64>().unwrap().to_radians() } else { *x }
            };
            row.iter().enumerate().map(of).collect()
        })
        .collect();
    room.write("reference.csv", table(&names, &back, ",", plain));
    let rapid: Vec<String> = rows
        .iter()
        .enumerate()
        .map(|(k, row)| format!("  CONST jointtarget p{k}:=[[{}],[9E9,9E9,9E9,9E9,9E9,9E9]];\n", list(row, &degrees)))
        .collect();
    room.write("cal.mod", format!("MODULE cal\n  ! measured by hand\n{}ENDMODULE\n", rapid.concat()));
    let krl: Vec<String> = rows
        .iter()
        .enumerate()
        .map(|(p, row)| {
            let axes: Vec<String> =
                joints.iter().enumerate().map(|(k, at)| format!("A{} {}", k + 1, degrees(row[*at]))).collect();
            format!("DECL E6AXIS XP{p}={{{},E1 0.0,E2 0.0}}\n", axes.join(","))
        })
        .collect();
    room.write("cal.dat", krl.concat());
    let reference = room.report("reference.csv");
    for program in ["cal.mod", "cal.dat"] {
        assert_eq!(room.report(&format!("seen.csv --joints {program}")), reference, "{program}");
    }
}

#[test]
fn a_workbook_is_the_same_data() {
    let room = Room::new();
    for name in ["readings.xlsx", "readings.csv"] {
        let file = crate::support::top().join("tests/measured/files").join(name);
        std::fs::copy(file, room.path(name)).unwrap();
    }
    let book = room.report("readings.xlsx");
    assert_eq!(book, room.report("readings.csv --units mm,deg"));
    let run = room.run("calibrate arm.urdf --effects none --data readings.xlsx");
    assert!(
        run.stderr.contains("read as an Excel workbook") && run.stdout.contains("X [mm]"),
        "{}{}",
        run.stderr,
        run.stdout
    );
}
