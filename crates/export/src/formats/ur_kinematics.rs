//! The six joint origins of a Universal Robots arm, as `ur_description` takes them for `kinematics_params`.

use super::{Format, RenderError};
use crate::kinematics_yaml::{AngleOrder, KinematicsFile};
use crate::numbers::exact;
use crate::sheet::Sheet;
use denavit_model::Pose;
use denavit_model::se3::{difference, rpy_from_rotation};

/// UR's kinematics file.
pub const FORMAT: Format =
    Format { name: "ur", extension: "yaml", purpose: "kinematics file of a UR arm, for ur_description", render };

fn render(sheet: &Sheet) -> Result<String, RenderError> {
    let other = |why: String| RenderError::OtherRobots { format: "ur", why };
    let chain = sheet.table.chain().map_err(|error| other(error.to_string()))?;
    let (mut file, flange) = KinematicsFile::of(&chain, AngleOrder::Urdf).map_err(|error| other(error.to_string()))?;
    // ur_description asks for a mark; the driver compares it with the controller's and warns where they differ.
    file.hash = Some("made_by_denavit".into());
    let mut comments = vec![format!("{}: {} to wrist_3_link; made by denavit", chain.name(), chain.base())];
    let (turned, moved) = difference(&flange, &Pose::identity());
    if turned > 1e-12 || moved > 1e-12 * chain.size() {
        let xyz: Vec<String> = flange.translation.vector.iter().map(|value| exact(*value)).collect();
        let rpy = rpy_from_rotation(&flange.rotation).map(exact);
        comments.push(format!("from there to {}: xyz {}, rpy {}", chain.tip(), xyz.join(" "), rpy.join(" ")));
    }
    Ok(file.to_text(AngleOrder::Urdf, &comments))
}
