//! Universal Robots: `kinematics_params` of ur_description, see [`crate::kinematics_yaml`].

use super::{Calibrated, Maker, MakerError, Written, without_effects};
use crate::formats::ur_kinematics;

pub(super) const MAKER: Maker =
    Maker { name: "ur", purpose: "ur_description: kinematics_params_file:=FILE of the driver", render };

fn render(calibrated: &Calibrated) -> Result<Written, MakerError> {
    let (text, tool) = ur_kinematics::of_chain(calibrated.chain)?;
    let mut left_out = without_effects(calibrated);
    left_out.extend(tool.map(|tool| {
        format!("this format ends at wrist_3_link; from there to {} it is {tool}", calibrated.chain.tip())
    }));
    Ok(Written { text, left_out })
}
