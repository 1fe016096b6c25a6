//! The truth of a simulated file, as JSON: to evaluate a calibration.

use crate::effects::Correction;
use crate::parameters::{Freedom, Layout, Tolerances};
use crate::simulate::{Simulation, SimulationOptions};
use denavit_measurements::word_of_two_tips;
use denavit_model::Pose;
use denavit_model::nalgebra::UnitQuaternion;
use serde_json::{Map, Value, json};

/// Version of the format.
pub const SCHEMA: &str = "denavit.simulation/1";

fn pose(pose: &Pose) -> Value {
    let quaternion = UnitQuaternion::from_rotation_matrix(&pose.rotation);
    let xyz: [f64; 3] = pose.translation.vector.into();
    let xyzw: [f64; 4] = quaternion.coords.into();
    json!({"xyz": xyz, "quaternion_xyzw": xyzw})
}

/// Standard deviations of the sources of noise, m and rad; absent sources are left out.
fn noise(options: &SimulationOptions) -> Value {
    let mut noise = json!({"position_m": options.noise_position, "orientation_rad": options.noise_orientation});
    for (name, size) in [("range_m", options.noise_range), ("angle_rad", options.noise_angle)] {
        if size > 0.0 {
            noise[name] = json!(size);
        }
    }
    if !options.repeatability.is_empty() {
        noise["repeatability"] = json!(options.repeatability);
    }
    noise
}

/// The truth of a run: how far each axis is from its drawing (rad, m, by the names of a calibration's parameters), the
/// instrument, the targets, noise, the rows with gross errors (counted from 1) and the effects.
pub fn to_json(run: &Simulation, options: &SimulationOptions, effects: &Correction) -> String {
    let (arm, chain) = (&run.arm, &run.arm.nominal);
    let freedom = Freedom::axes(chain.joints().len());
    let layout = Layout::new(chain, &run.data.scene, &freedom, &Tolerances::default(), Vec::new());
    let difference = layout.difference(arm, arm);
    let axes: Map<String, Value> =
        layout.joints.clone().map(|k| (layout.parameters[k].name.clone(), json!(difference[k]))).collect();
    let mut truth = json!({
        "schema": SCHEMA,
        "robot": chain.name(),
        "base": chain.base(),
        "tip": chain.tip(),
        "measurement": options.kind,
        "rows": options.rows,
        "seed": options.seed,
        "noise": noise(options),
        "axes": axes,
    });
    if options.kind.of_a_board() {
        truth["noise"] = json!({"pixel_px": options.noise_pixel});
    }
    // The contact point of two tips differs in each row.
    let points = if word_of_two_tips(options.kind).is_some() { &[] } else { &arm.points[..] };
    for (point, name) in points.iter().zip(&run.data.scene.points) {
        let place: [f64; 3] = (*point).into();
        truth[name] = json!(place);
    }
    if run.data.scene.has_instruments() {
        truth["instrument_from_base"] = pose(&arm.instruments[0]);
    }
    truth["tip_from_targets"] = arm.targets.iter().map(pose).collect();
    if arm.tips.several() {
        // The tip of each target.
        truth["tips"] = arm.sits_on.iter().map(|tip| json!(arm.tips[*tip].name)).collect();
    }
    truth["gross_errors"] = run.outliers.iter().map(|row| json!(row + 1)).collect();
    truth["effects"] = serde_json::from_str(&effects.to_json()).expect("what was just written as JSON is JSON");
    serde_json::to_string_pretty(&truth).expect("names are texts and numbers are numbers") + "\n"
}
