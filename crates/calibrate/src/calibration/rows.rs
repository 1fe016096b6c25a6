//! The residual of every row at the adopted stage, and where instruments, targets and points were found: what an engineer
//! who knows the cell checks first.

use crate::calibration::Calibration;
use crate::identify::residual_statistics::{Residual, residuals};
use crate::identify::solve::Fit;
use crate::observation::board::Corner;
use crate::observation::measurements::Measurements;
use crate::observation::parameters::Effects;
use denavit_model::Pose;
use denavit_model::nalgebra::UnitQuaternion;
use serde::Serialize;

/// One observation and what the adopted model leaves of it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RowEntry {
    /// The row's line in its file.
    pub line: usize,
    /// Setup that it was measured in; left out where there is one alone.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub setup: String,
    /// Target; left out where there is one alone.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub target: String,
    /// Corner of the board; left out where no camera sees one.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub corner: String,
    /// Whether it was kept for the test.
    pub held_out: bool,
    /// Whether it was rejected as a gross error.
    pub rejected: bool,
    /// Measured less predicted: three components in the base frame, one number, or of pixels two at the board's usual
    /// distance; m.
    #[serde(rename = "residual_m")]
    pub place: Vec<f64>,
    /// Of the orientation, a rotation vector in the base frame, rad; left out where it was not measured.
    #[serde(rename = "residual_rad", skip_serializing_if = "Vec::is_empty")]
    pub turn: Vec<f64>,
    /// The first in pixels, right and down; left out where none were read.
    #[serde(rename = "residual_px", skip_serializing_if = "Vec::is_empty")]
    pub pixels: Vec<f64>,
}

/// A frame or a point as it was found.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Placed {
    /// Its name; empty where it is the only one.
    pub name: String,
    /// m.
    pub xyz: [f64; 3],
    /// Quaternion x, y, z, w; left out where the orientation was not measured.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub quaternion: Option<[f64; 4]>,
}

/// Where everything beside the robot was found.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Placements {
    /// instrument_from_base of each setup whose instrument's frame was seen; of a plane a frame in which it is z = 0.
    pub instruments: Vec<Placed>,
    /// tip_from_target of each target.
    pub targets: Vec<Placed>,
    /// Points that stand still, base frame: anchors, sockets.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub points: Vec<Placed>,
}

/// Every observation of the fitted rows, then of the held-out ones.
pub(super) fn rows(result: &Calibration) -> Vec<RowEntry> {
    let (all, weights) = match result.beyond_geometry() {
        Some(fit) => fitted(fit, &result.train),
        None => fitted(result.without_effects(), &result.train),
    };
    let train = all.iter().map(|residual| entry(residual, &result.train, false, weights[residual.observation] == 0.0));
    let stage = result.report.stages.iter().position(|stage| stage.adopted).unwrap_or(0);
    let test = result.test.iter().flat_map(|test| {
        let held_out = result.residuals.get(stage).map_or(&[][..], |residuals| &residuals.test);
        held_out.iter().map(|residual| entry(residual, test, true, false))
    });
    train.chain(test).collect()
}

fn fitted<'a, E: Effects>(fit: &'a Fit<E>, data: &Measurements) -> (Vec<Residual>, &'a [f64]) {
    (residuals(&fit.arm, &fit.effects, data), &fit.weights)
}

fn entry(residual: &Residual, data: &Measurements, held_out: bool, rejected: bool) -> RowEntry {
    let series = &data.scene.series[residual.series];
    let name = |names: &[String], index: usize| if names.len() > 1 { names[index].clone() } else { String::new() };
    let height = series.kind.place().height;
    let place: Vec<f64> = residual.place.iter().copied().take(height).collect();
    let corner = series.corner.as_ref();
    let pixels = |corner: &Corner| place.iter().map(|length| length / corner.camera.metres_per_pixel()).collect();
    RowEntry {
        pixels: corner.map_or_else(Vec::new, pixels),
        corner: corner.map_or_else(String::new, |corner| corner.label.clone()),
        line: data.lines[residual.row],
        setup: name(&data.scene.setups, series.setup),
        target: name(&data.scene.targets, series.target),
        held_out,
        rejected,
        place,
        turn: if series.kind.turn().is_some() { residual.turn.iter().copied().collect() } else { Vec::new() },
    }
}

/// Instruments, targets and points at the adopted stage.
pub(super) fn placements(result: &Calibration) -> Placements {
    let (arm, scene) = (result.arm(), &result.train.scene);
    let placed = |name: &String, pose: &Pose, turns: bool| {
        let quaternion = UnitQuaternion::from_rotation_matrix(&pose.rotation);
        let xyzw = quaternion.coords;
        Placed {
            name: name.clone(),
            xyz: pose.translation.vector.into(),
            quaternion: turns.then_some([xyzw.x, xyzw.y, xyzw.z, xyzw.w]),
        }
    };
    let seen = |setup: usize| scene.has_instrument(setup) || scene.has_plane(setup);
    let setups = scene.setups.iter().enumerate().filter(|(setup, _)| seen(*setup));
    let targets = scene.targets.iter().enumerate();
    let points = scene.points.iter().zip(&arm.points);
    Placements {
        instruments: setups.map(|(setup, name)| placed(name, &arm.instruments[setup], true)).collect(),
        targets: targets.map(|(target, name)| placed(name, &arm.targets[target], scene.turns(target))).collect(),
        points: points.map(|(name, at)| Placed { name: name.clone(), xyz: (*at).into(), quaternion: None }).collect(),
    }
}

/// Rows as CSV: `line,setup,target,held_out,rejected,dx_mm,dy_mm,dz_mm` and, for poses, `rx_mrad,ry_mrad,rz_mrad`, for
/// pixels `corner,du_px,dv_px`.
///
/// Distances and other single numbers stand in `dx_mm`.
///
/// # Errors
/// None but those of memory.
pub fn to_csv(rows: &[RowEntry]) -> String {
    let turns = rows.iter().any(|row| !row.turn.is_empty());
    let mut writer = csv::Writer::from_writer(Vec::new());
    let mut header = vec!["line", "setup", "target", "held_out", "rejected", "dx_mm", "dy_mm", "dz_mm"];
    if turns {
        header.extend(["rx_mrad", "ry_mrad", "rz_mrad"]);
    }
    let pixels = rows.iter().any(|row| !row.pixels.is_empty());
    if pixels {
        header.extend(["corner", "du_px", "dv_px"]);
    }
    let mut records = vec![header.into_iter().map(String::from).collect::<Vec<_>>()];
    for row in rows {
        let number =
            |values: &[f64], index: usize| values.get(index).map_or_else(String::new, |v| (v * 1e3).to_string());
        let mut record = vec![
            row.line.to_string(),
            row.setup.clone(),
            row.target.clone(),
            u8::from(row.held_out).to_string(),
            u8::from(row.rejected).to_string(),
        ];
        record.extend((0..3).map(|index| number(&row.place, index)));
        if turns {
            record.extend((0..3).map(|index| number(&row.turn, index)));
        }
        if pixels {
            record.push(row.corner.clone());
            record.extend((0..2).map(|k| row.pixels.get(k).map_or_else(String::new, f64::to_string)));
        }
        records.push(record);
    }
    for record in records {
        writer.write_record(&record).expect("memory takes every record");
    }
    let bytes = writer.into_inner().expect("memory takes every record");
    String::from_utf8(bytes).expect("text goes in, text comes out")
}
