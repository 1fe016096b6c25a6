//! What the reader knows about each URDF element: what it understands, and what it only keeps.

/// An element that the reader understands.
pub(super) struct Known {
    /// Its tag, without a prefix.
    pub tag: &'static str,
    /// Attributes that it reads, or that name things and do nothing else.
    pub attributes: &'static [&'static str],
    /// Attributes that it keeps and compares without knowing what they mean.
    pub kept: &'static [&'static str],
    /// Elements in it that it understands.
    pub children: &'static [&'static Known],
    /// Elements in it that it keeps whole: they do not say how the robot moves, or [`crate::posed`] reads where they sit.
    pub carried: &'static [&'static str],
    /// Whether it states a pose or a motion: anything in it that is not understood may change that.
    pub places: bool,
    /// Whether only the first of several counts.
    pub once: bool,
}

/// An element with nothing in it, of which the first counts.
const fn leaf(tag: &'static str, attributes: &'static [&'static str]) -> Known {
    Known { tag, attributes, kept: &[], children: &[], carried: &[], places: false, once: true }
}

const fn placing(tag: &'static str, attributes: &'static [&'static str]) -> Known {
    Known { places: true, ..leaf(tag, attributes) }
}

/// URDF's four of a `<limit>`.
pub(super) const RANGE: &[&str] = &["lower", "upper", "velocity", "effort"];

static ORIGIN: Known = placing("origin", &["xyz", "rpy", "quat_xyzw"]);
static PARENT: Known = placing("parent", &["link"]);
static CHILD: Known = placing("child", &["link"]);
static AXIS: Known = placing("axis", &["xyz"]);
static MIMIC: Known = placing("mimic", &["joint", "multiplier", "offset"]);
static PITCH: Known = placing("screw_thread_pitch", &["value"]);
static LIMIT: Known = Known {
    kept: &["acceleration", "deceleration", "jerk", "command_effort", "current", "gear_velocity"],
    ..placing("limit", RANGE)
};
static DYNAMICS: Known = Known {
    kept: &["D", "K", "mu_coulomb", "mu_viscous", "spring_reference", "spring_stiffness"],
    ..leaf("dynamics", &["damping", "friction"])
};
static SOFT_LIMITS: Known =
    leaf("safety_controller", &["soft_lower_limit", "soft_upper_limit", "k_position", "k_velocity"]);
static CALIBRATION: Known = leaf("calibration", &["rising", "falling", "reference_position"]);

static MASS: Known = leaf("mass", &["value"]);
static INERTIA: Known = leaf("inertia", &["ixx", "ixy", "ixz", "iyy", "iyz", "izz"]);
static INERTIAL: Known = Known { children: &[&ORIGIN, &MASS, &INERTIA], places: true, ..leaf("inertial", &[]) };

static BOX: Known = leaf("box", &["size"]);
static SPHERE: Known = leaf("sphere", &["radius"]);
static CYLINDER: Known = leaf("cylinder", &["radius", "length"]);
static CAPSULE: Known = leaf("capsule", &["radius", "length"]);
static MESH: Known = Known { carried: &["declare_convex"], ..leaf("mesh", &["filename", "scale"]) };
static GEOMETRY: Known =
    Known { children: &[&BOX, &SPHERE, &CYLINDER, &CAPSULE, &MESH], ..leaf("geometry", &["name"]) };

static SHAPE: &[&Known] = &[&ORIGIN, &GEOMETRY];
static VISUAL: Known = Known { children: SHAPE, carried: &["material"], once: false, ..placing("visual", &["name"]) };
static COLLISION: Known = Known {
    children: SHAPE,
    carried: &["material", "surface", "proximity_properties", "contact_coefficients"],
    once: false,
    ..placing("collision", &["name"])
};

static LINK: Known = Known {
    children: &[&INERTIAL, &VISUAL, &COLLISION],
    carried: &[
        "contact",
        "surface",
        "gravity",
        "kinematic",
        "self_collide",
        "self_collision_checking",
        "collision_checking",
        "material",
        "sensor",
    ],
    once: false,
    ..leaf("link", &["name"])
};
static JOINT: Known = Known {
    kept: &["dont_collapse"],
    children: &[&ORIGIN, &PARENT, &CHILD, &AXIS, &LIMIT, &MIMIC, &PITCH, &DYNAMICS, &SOFT_LIMITS, &CALIBRATION],
    carried: &[
        "controller_gains",
        "joint_properties",
        "traits",
        "gear_ratio",
        "rotor_inertia",
        "hardwareInterface",
        "physics",
    ],
    once: false,
    ..placing("joint", &["name", "type"])
};

/// What may stand in the element at a path of tags below `<robot>`: attributes and elements that are understood or kept.
pub(super) fn vocabulary(path: &[&str]) -> Option<(Vec<&'static str>, Vec<&'static str>)> {
    let mut known = &ROBOT;
    for tag in path {
        known = known.children.iter().find(|child| child.tag == *tag)?;
    }
    let attributes = known.attributes.iter().chain(known.kept).copied().collect();
    let children = known.children.iter().map(|child| child.tag).chain(known.carried.iter().copied()).collect();
    Some((attributes, children))
}

/// The whole file. What closes a loop is kept and noted: see [`crate::loops`].
pub(super) static ROBOT: Known = Known {
    children: &[&LINK, &JOINT],
    carried: &[
        "material",
        "transmission",
        "gazebo",
        "ros2_control",
        "sensor",
        "frame",
        "force_element",
        "cable",
        "collision_filter_group",
        "constraint",
        "loop_joint",
        "loop",
        "closed_loop",
        "loop_closure",
        "linear_bushing_rpy",
        "ball_constraint",
        "distance_constraint",
        "weld_constraint",
        "mujoco",
        "isaac",
    ],
    once: false,
    ..leaf("robot", &["name", "version"])
};
