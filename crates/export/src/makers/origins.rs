//! Joint origins that reproduce a calibrated chain, each joint about z of its frame.

use super::{Calibrated, MakerError, without_effects};
use crate::kinematics_yaml;
use crate::urdf;
use denavit_model::chain::Chain;
use denavit_model::robot::{Joint, Robot};
use denavit_model::se3::Pose;
use denavit_model::tree::Reading;
use denavit_model::{Screw, UrdfError};

/// Allowed deviation of a frame's z from the joint's axis, rad and relative to the robot's size.
const ON_AXIS: f64 = 1e-9;

/// The origins of a calibrated arm.
pub(super) struct Origins {
    /// Of each joint, in the frame of the link before.
    pub joints: Vec<(String, Pose)>,
    /// From the last joint's frame to the chain's tip.
    pub tool: Pose,
    /// From the last joint's frame to another link of the tree.
    pub tree: Option<Robot>,
}

impl Origins {
    /// Joint origins with the link frames of the nominal tree; without a tree, with frames at the feet of common normals.
    pub fn of(calibrated: &Calibrated, maker: &'static str, wanted: &'static str) -> Result<Self, MakerError> {
        let chain = calibrated.chain;
        // In a tree a zero goes into the origin of its joint.
        let plain = |joint: &&denavit_model::ChainJoint| {
            let counts = joint.offset == 0.0 || calibrated.drawn.is_some();
            matches!(joint.screw, Screw::Revolute(_)) && joint.scale == 1.0 && counts
        };
        let revolute = chain.joints().iter().filter(plain).count();
        if revolute != chain.joints().len() {
            let found = format!("{} joints, {revolute} of them revolute without scale or offset", chain.joints().len());
            return Err(other_chain(chain, maker, wanted, found));
        }
        let Some((drawn, reading)) = calibrated.drawn else {
            let (origins, tool) = kinematics_yaml::origins(chain);
            let names = chain.joints().iter().map(|joint| joint.name.clone());
            return Ok(Self { joints: names.zip(origins).collect(), tool, tree: None });
        };
        let tree = calibrated_tree(drawn, chain, reading)?;
        let nominal = drawn.chain(Some(chain.base()), Some(chain.tip()), reading)?.value;
        let at_zero = urdf::zeros_taken_in(&nominal, chain)?;
        let mut before = Pose::identity();
        let mut joints = Vec::new();
        for joint in &at_zero.joints {
            let frame = carried_by(&tree, chain, &joint.name)?;
            let line = joint.screw.line().expect("every joint is revolute");
            let z = frame.rotation.matrix().column(2).into_owned();
            let origin = denavit_model::nalgebra::Point3::from(frame.translation.vector);
            let off = (line.nearest_to(&origin) - origin).norm();
            if (z - line.direction.into_inner()).norm() > ON_AXIS || off > ON_AXIS * chain.size() {
                return Err(MakerError::NotAboutZ { maker, joint: joint.name.clone() });
            }
            joints.push((joint.name.clone(), before.inverse() * frame));
            before = frame;
        }
        Ok(Self { joints, tool: before.inverse() * at_zero.home, tree: Some(tree) })
    }

    /// From the last joint's frame to a link of the tree whose name ends so.
    pub fn to_link(&self, chain: &Chain, end: &str) -> Result<Option<Pose>, MakerError> {
        let (Some(tree), Some((last, _))) = (&self.tree, self.joints.last()) else { return Ok(None) };
        let Some(link) = tree.links.iter().find(|link| link.name.ends_with(end)) else { return Ok(None) };
        let reached = tree.chain(Some(chain.base()), Some(&link.name), Reading::AsWritten)?.value;
        Ok(Some(carried_by(tree, chain, last)?.inverse() * reached.home()))
    }
}

pub(super) fn other_chain(chain: &Chain, maker: &'static str, wanted: &'static str, found: String) -> MakerError {
    MakerError::OtherChain { maker, wanted, base: chain.base().to_owned(), tip: chain.tip().to_owned(), found }
}

/// The tree with the calibrated chain.
pub(super) fn calibrated_tree(drawn: &Robot, chain: &Chain, reading: Reading) -> Result<Robot, MakerError> {
    let text = urdf::with_chain(drawn, chain, reading)?.value;
    denavit_model::urdf::read("the calibrated URDF", &text).map_err(|error: UrdfError| error.into())
}

/// Changes of an origin below this, m and rad, are rounding.
pub(super) const NOTHING: f64 = 1e-13;

/// The joints of the nominal robot with those of the calibrated one, for formats that store changes of origins.
pub(super) struct Changes {
    /// Each joint, nominal and calibrated.
    pub joints: Vec<(Joint, Joint)>,
    /// What such a format cannot represent.
    pub left_out: Vec<String>,
}

impl Changes {
    /// Those of an arm with a nominal tree.
    pub fn of(calibrated: &Calibrated, maker: &'static str) -> Result<Self, MakerError> {
        let Some((drawn, reading)) = calibrated.drawn else { return Err(MakerError::NeedsTree { maker }) };
        let mut left_out = without_effects(calibrated);
        let mut joints = Vec::new();
        for joint in calibrated_tree(drawn, calibrated.chain, reading)?.joints {
            match drawn.joints.iter().find(|old| old.name == joint.name) {
                Some(old) => joints.push((old.clone(), joint)),
                None => left_out.push(format!("joint \"{}\" is new: the format has no place for it", joint.name)),
            }
        }
        Ok(Self { joints, left_out })
    }
}

/// base_from_link of the link that a joint carries, at zero.
fn carried_by(tree: &Robot, chain: &Chain, joint: &str) -> Result<Pose, MakerError> {
    let link = tree.joints.iter().find(|of| of.name == joint).map(|of| tree.links[of.child].name.clone());
    Ok(*tree.chain(Some(chain.base()), link.as_deref(), Reading::AsWritten)?.value.home())
}
