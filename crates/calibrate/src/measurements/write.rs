//! Writing a measurement file: what [`super::read`] reads.

use super::{MeasurementKind, Measurements};
use denavit_model::nalgebra::UnitQuaternion;

/// The data as CSV text in m and rad, with `comments` on top, every number with all its digits.
pub fn write(data: &Measurements, comments: &[String]) -> String {
    let mut text = String::new();
    for comment in comments {
        text.push_str("# ");
        text.push_str(comment);
        text.push('\n');
    }
    let mut writer = csv::Writer::from_writer(Vec::new());
    let mut header = data.joints.clone();
    match data.kind {
        MeasurementKind::Distance => header.push("distance".into()),
        MeasurementKind::Pose => header.extend(["x", "y", "z", "qx", "qy", "qz", "qw"].map(String::from)),
        MeasurementKind::Position => {
            for target in &data.targets {
                header.extend(["x", "y", "z"].map(|axis| format!("{axis}{target}")));
            }
        }
    }
    header.extend(data.covariates.iter().map(|column| column.name.clone()));
    header.extend(data.labels.iter().map(|column| column.name.clone()));
    let locates = data.locate.contains(&true);
    if locates {
        header.push("locate".into());
    }
    let to_memory = "writing to memory does not fail";
    writer.write_record(&header).expect(to_memory);
    for row in 0..data.len() {
        let mut cells: Vec<String> = data.reading(row).iter().map(f64::to_string).collect();
        match data.kind {
            MeasurementKind::Distance => cells.push(data.distances[row].to_string()),
            MeasurementKind::Pose | MeasurementKind::Position => {
                for target in 0..data.targets.len() {
                    match data.position(row, target) {
                        Some(position) => cells.extend(position.iter().map(f64::to_string)),
                        None => cells.extend([String::new(), String::new(), String::new()]),
                    }
                }
            }
        }
        if data.kind == MeasurementKind::Pose {
            let quaternion = UnitQuaternion::from_rotation_matrix(&data.orientations[row]);
            cells.extend(quaternion.coords.iter().map(f64::to_string));
        }
        cells.extend(data.covariates.iter().map(|column| column.values[row].to_string()));
        cells.extend(data.labels.iter().map(|column| column.values[row].clone()));
        if locates {
            cells.push(u8::from(data.locate[row]).to_string());
        }
        writer.write_record(&cells).expect(to_memory);
    }
    let bytes = writer.into_inner().expect(to_memory);
    text.push_str(&String::from_utf8(bytes).expect("only UTF-8 was written"));
    text
}
