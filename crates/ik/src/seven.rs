//! Seven revolute joints: the six others with one held.

use crate::arm::{Axis, SixR};
use crate::class::{Class, Drawn};
use denavit_model::nalgebra::Vector3;
use denavit_model::{Chain, Screw};

/// Joints of a seven-joint arm in the order in which they are tried as the parameter: the third turns the elbow of arms with a
/// spherical shoulder and wrist, the last that of arms with an offset wrist.
const PARAMETERS: [usize; 7] = [2, 6, 3, 0, 4, 1, 5];

/// A seven-joint arm with joint `parameter` held at a joint value (rad).
pub(crate) fn held(chain: &Chain, parameter: usize, value: f64) -> Option<SixR> {
    let joints = chain.joints();
    let in_order = joints.iter().enumerate().all(|(k, joint)| joint.coordinate == k);
    if joints.len() != 7 || chain.coordinates().len() != 7 || !in_order {
        return None;
    }
    let motion = joints[parameter].screw.motion(value);
    let mut axes = [Axis { direction: Vector3::z(), point: Vector3::zeros() }; 6];
    let others = joints.iter().enumerate().filter(|(k, _)| *k != parameter);
    for (axis, (k, joint)) in axes.iter_mut().zip(others) {
        let Screw::Revolute(line) = joint.screw else { return None };
        let line = if k > parameter { line.moved(&motion) } else { line };
        *axis = Axis { direction: *line.direction, point: line.point.coords };
    }
    matches!(joints[parameter].screw, Screw::Revolute(_)).then(|| SixR { axes, home: motion * chain.home() })
}

/// The joint of a seven-joint arm to hold, and the class of the others: the same at whatever value it is held.
pub(crate) fn redundant(chain: &Chain, size: f64) -> Option<(usize, Class)> {
    PARAMETERS.into_iter().find_map(|parameter| {
        let class_at = |value: f64| Some(Drawn::of(&held(chain, parameter, value)?, size).class);
        let class = class_at(0.7)?;
        (class != Class::General && class_at(-1.3)? == class && class_at(0.1)? == class).then_some((parameter, class))
    })
}
