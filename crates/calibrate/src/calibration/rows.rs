//! The residual of every row at the adopted stage, and the estimated places of instruments, targets and points, which an engineer
//! who knows the cell checks first.

use crate::calibration::adoption::AdoptedFit;
use crate::calibration::placed_anew::PlacedAnew;
use denavit_identify::arm::Arm;
use denavit_identify::effects::Correction;
use denavit_identify::parameters::{Effects, NoEffects};
use denavit_identify::residual_statistics::{Residual, bound_later, placed, residuals_of};
use denavit_identify::solve::Fit;
use denavit_measurements::board::Corner;
use denavit_measurements::{Measurements, Scene};
use denavit_model::Pose;
use denavit_model::nalgebra::UnitQuaternion;
use serde::ser::SerializeSeq as _;
use serde::{Serialize, Serializer};
use std::sync::Arc;

/// Rows whose residuals are found at once: of a million they need not all be kept.
const ROWS_AT_ONCE: usize = 4096;

/// One observation and its residual.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct RowEntry {
    /// The row's line in its file.
    pub line: usize,
    /// Setup that it was measured in; left out if there is only one.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub setup: String,
    /// Target; left out if there is only one.
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
    /// Of the orientation, a rotation vector in the base frame, rad; of gravity two angles in the sensor's axes; left out where neither
    /// was measured.
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

/// Estimated places of instruments, targets and points.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Placements {
    /// instrument_from_base of each setup whose instrument's frame was seen; of a plane a frame in which it is z = 0, of gravity one in which it
    /// pulls against z.
    pub instruments: Vec<Placed>,
    /// tip_from_target of each target.
    pub targets: Vec<Placed>,
    /// Points that stand still, base frame: anchors, sockets.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub points: Vec<Placed>,
}

/// Residuals of the adopted model, fitted rows first. An entry is computed on request: there may be a million rows, and few users
/// of a million rows read them.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Rows {
    parts: Vec<FileResiduals>,
}

/// The inputs for the residuals of one file.
#[derive(Debug, Clone, PartialEq)]
struct FileResiduals {
    data: Arc<Measurements>,
    arm: Arm,
    /// For `data`; none where geometry alone was adopted.
    effects: Option<Correction>,
    /// Observations rejected as gross errors, ascending.
    rejected: Vec<usize>,
    held_out: bool,
}

impl Rows {
    /// Of an adopted fit.
    pub(super) fn of(
        fit: AdoptedFit<'_>,
        rows: (&Arc<Measurements>, Option<&Arc<Measurements>>),
        placed_anew: Option<&PlacedAnew>,
    ) -> Self {
        match fit {
            AdoptedFit::Geometry(fit) => Self::left_by(fit, rows, placed_anew, |_| None),
            AdoptedFit::Named(fit) => Self::left_by(fit, rows, placed_anew, |effects| Some(effects.into())),
            AdoptedFit::Averaged(fit) => Self::left_by(fit, rows, placed_anew, |averaged| Some(averaged.into())),
        }
    }

    fn left_by<E: Effects>(
        fit: &Fit<E>,
        (train, test): (&Arc<Measurements>, Option<&Arc<Measurements>>),
        placed_anew: Option<&PlacedAnew>,
        model: impl Fn(E) -> Option<Correction>,
    ) -> Self {
        let rejected = fit.weights.iter().enumerate().filter(|(_, weight)| **weight == 0.0);
        let fitted = FileResiduals {
            data: train.clone(),
            arm: fit.arm.clone(),
            effects: model(fit.effects.clone()),
            rejected: rejected.map(|(observation, _)| observation).collect(),
            held_out: false,
        };
        let judged = test.map(|test| FileResiduals {
            data: test.clone(),
            arm: {
                let mut arm =
                    placed(fit, train, test).expect("the held-out rows were placed when the stage was judged");
                if let Some(anew) = placed_anew {
                    anew.apply(&mut arm);
                }
                arm
            },
            effects: model(bound_later(&fit.effects, train, test).expect("effects were bound when it was judged")),
            rejected: Vec::new(),
            held_out: true,
        });
        Self { parts: std::iter::once(fitted).chain(judged).collect() }
    }

    /// Number of observations.
    pub fn len(&self) -> usize {
        self.parts.iter().map(FileResiduals::len).sum()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// One entry after the other.
    pub fn iter(&self) -> impl Iterator<Item = RowEntry> {
        self.parts.iter().flat_map(FileResiduals::entries)
    }
}

impl Serialize for Rows {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut list = serializer.serialize_seq(Some(self.len()))?;
        self.iter().try_for_each(|row| list.serialize_element(&row))?;
        list.end()
    }
}

impl FileResiduals {
    fn len(&self) -> usize {
        let rows = (0..self.data.len()).filter(|&row| !self.data.locate[row]);
        rows.map(|row| self.data.of_row(row).len()).sum()
    }

    fn entries(&self) -> impl Iterator<Item = RowEntry> {
        let some = |from: usize| {
            let rows = from..(from + ROWS_AT_ONCE).min(self.data.len());
            match &self.effects {
                Some(effects) => residuals_of(rows, &self.arm, effects, &self.data),
                None => residuals_of(rows, &self.arm, &NoEffects, &self.data),
            }
        };
        let residuals = (0..self.data.len()).step_by(ROWS_AT_ONCE).flat_map(some);
        residuals.map(|residual| self.entry(&residual))
    }

    fn entry(&self, left: &Residual) -> RowEntry {
        let scene = &self.data.scene;
        let series = &scene.series[left.series];
        let name = |names: &[String], index: usize| if names.len() > 1 { names[index].clone() } else { String::new() };
        let corner = series.corner.as_ref();
        let part = series.kind.place();
        let first: Vec<f64> = left.place.iter().take(part.height).copied().collect();
        let (place, angles) = if part.unit == "m" { (first, Vec::new()) } else { (Vec::new(), first) };
        let pixels = |corner: &Corner| place.iter().map(|length| length / corner.camera.metres_per_pixel()).collect();
        RowEntry {
            pixels: corner.map_or_else(Vec::new, pixels),
            corner: corner.map_or_else(String::new, |corner| corner.label.clone()),
            line: self.data.lines[left.row],
            setup: name(&scene.setups, series.setup),
            target: name(&scene.targets, series.target),
            held_out: self.held_out,
            rejected: self.rejected.binary_search(&left.observation).is_ok(),
            place,
            turn: if series.kind.turn().is_some() { left.turn.as_slice().to_vec() } else { angles },
        }
    }
}

/// Instruments, targets and points at the adopted stage.
pub(super) fn placements(arm: &Arm, scene: &Scene) -> Placements {
    let placed = |name: &String, pose: &Pose, turns: bool| {
        let quaternion = UnitQuaternion::from_rotation_matrix(&pose.rotation);
        let xyzw = quaternion.coords;
        Placed {
            name: name.clone(),
            xyz: pose.translation.vector.into(),
            quaternion: turns.then_some([xyzw.x, xyzw.y, xyzw.z, xyzw.w]),
        }
    };
    let seen = |setup: usize| {
        let own = scene.has_instrument(setup) && !scene.is_held(setup);
        own || scene.has_plane(setup) || scene.has_level(setup)
    };
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
pub fn to_csv(rows: &Rows) -> String {
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
    let mut write = |record: Vec<String>| writer.write_record(&record).expect("memory takes every record");
    write(header.into_iter().map(String::from).collect());
    for row in rows.iter() {
        let number =
            |values: &[f64], index: usize| values.get(index).map_or_else(String::new, |v| (v * 1e3).to_string());
        let flags = [row.held_out, row.rejected].map(|flag| u8::from(flag).to_string());
        let mut record = vec![row.line.to_string(), row.setup, row.target];
        record.extend(flags);
        record.extend((0..3).map(|index| number(&row.place, index)));
        if turns {
            record.extend((0..3).map(|index| number(&row.turn, index)));
        }
        if pixels {
            record.push(row.corner);
            record.extend((0..2).map(|k| row.pixels.get(k).map_or_else(String::new, f64::to_string)));
        }
        write(record);
    }
    let bytes = writer.into_inner().expect("memory takes every record");
    String::from_utf8(bytes).expect("text goes in, text comes out")
}
