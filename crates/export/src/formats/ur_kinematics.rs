//! The six joint origins of a Universal Robots arm, as `ur_description` takes them for `kinematics_params`.

use super::{Format, RenderError};
use crate::kinematics_yaml::{AngleOrder, KinematicsFile, KinematicsFileError};
use crate::makers::{tool_words, ur_models};
use crate::sheet::Sheet;
use denavit_model::Chain;

/// UR's kinematics file.
pub const FORMAT: Format =
    Format { name: "ur", extension: "yaml", purpose: "kinematics file of a UR arm, for ur_description", render };

fn render(sheet: &Sheet) -> Result<String, RenderError> {
    let other = |why: String| RenderError::OtherRobots { format: "ur", why };
    let chain = sheet.table.chain().map_err(|error| other(error.to_string()))?;
    of_chain(&chain).map(|(text, _)| text).map_err(|error| other(error.to_string()))
}

/// The file of a chain, and the transform from the frame of joint 6 to the tip in words, if it is not the identity.
pub(crate) fn of_chain(chain: &Chain) -> Result<(String, Option<String>), KinematicsFileError> {
    let (mut file, flange) = KinematicsFile::of(chain, AngleOrder::Urdf)?;
    if ur_models::model_of(chain).is_none() {
        return Err(KinematicsFileError::OtherArm { robot: chain.name().into(), models: ur_models::names() });
    }
    // ur_description requires a hash; the driver compares it with the controller's and warns if they differ.
    file.hash = Some("made_by_denavit".into());
    let mut comments = vec![format!("{}: {} to wrist_3_link; made by denavit", chain.name(), chain.base())];
    let tool = tool_words(&flange, chain.size());
    comments.extend(tool.as_ref().map(|tool| format!("from there to {}: {tool}", chain.tip())));
    Ok((file.to_text(AngleOrder::Urdf, &comments), tool))
}
