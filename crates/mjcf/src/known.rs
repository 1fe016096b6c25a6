//! The elements and attributes of MJCF, and which of them the reader translates. Known ones that it does not translate are kept.

/// For a translated element: attributes that are read, and attributes that are known and kept.
pub struct Known {
    pub tag: &'static str,
    pub read: &'static [&'static str],
    pub kept: &'static [&'static str],
}

const ELEMENTS: &[Known] = &[
    Known { tag: "mujoco", read: &["model"], kept: &[] },
    Known {
        tag: "compiler",
        read: &[
            "angle",
            "eulerseq",
            "autolimits",
            "meshdir",
            "assetdir",
            "inertiafromgeom",
            "balanceinertia",
            "boundmass",
            "boundinertia",
            "settotalmass",
            "inertiagrouprange",
            "strippath",
            "coordinate",
            "texturedir",
        ],
        kept: &[
            "fitaabb",
            "discardvisual",
            "usethread",
            "fusestatic",
            "alignfree",
            "saveinertial",
            "convexhull",
            "conflict",
        ],
    },
    Known { tag: "worldbody", read: &["name"], kept: &[] },
    Known {
        tag: "body",
        read: &["name", "childclass", "pos", "quat", "axisangle", "euler", "xyaxes", "zaxis"],
        kept: &["mocap", "gravcomp", "user", "sleep"],
    },
    Known {
        tag: "frame",
        read: &["name", "childclass", "pos", "quat", "axisangle", "euler", "xyaxes", "zaxis"],
        kept: &[],
    },
    Known {
        tag: "inertial",
        read: &["pos", "quat", "axisangle", "euler", "xyaxes", "zaxis", "mass", "diaginertia", "fullinertia"],
        kept: &[],
    },
    Known {
        tag: "joint",
        read: &[
            "name",
            "class",
            "type",
            "pos",
            "axis",
            "range",
            "limited",
            "ref",
            "damping",
            "frictionloss",
            "actuatorfrcrange",
            "actuatorfrclimited",
        ],
        kept: &[
            "armature",
            "stiffness",
            "springref",
            "springdamper",
            "solreflimit",
            "solimplimit",
            "solreffriction",
            "solimpfriction",
            "margin",
            "group",
            "user",
            "actuatorgravcomp",
        ],
    },
    Known { tag: "freejoint", read: &["name"], kept: &["group", "align"] },
    Known {
        tag: "geom",
        read: &[
            "name",
            "class",
            "type",
            "size",
            "pos",
            "quat",
            "axisangle",
            "euler",
            "xyaxes",
            "zaxis",
            "fromto",
            "mesh",
            "mass",
            "density",
            "contype",
            "conaffinity",
            "group",
            "rgba",
            "material",
            "shellinertia",
        ],
        kept: &[
            "condim",
            "priority",
            "friction",
            "solmix",
            "solref",
            "solimp",
            "margin",
            "gap",
            "hfield",
            "fluidshape",
            "fluidcoef",
            "user",
            "fitscale",
        ],
    },
    Known {
        tag: "site",
        read: &["name", "class", "pos", "quat", "axisangle", "euler", "xyaxes", "zaxis", "fromto"],
        kept: &["type", "size", "group", "material", "rgba", "user"],
    },
    Known {
        tag: "mesh",
        read: &["name", "class", "file", "scale", "refpos", "refquat", "inertia", "vertex", "face", "content_type"],
        kept: &[
            "normal",
            "texcoord",
            "smoothnormal",
            "maxhullvert",
            "builtin",
            "params",
            "material",
            "octree_maxdepth",
            "needsdf",
        ],
    },
];

/// Sections that are kept as a whole, each of their elements by itself.
pub const KEPT_SECTIONS: &[&str] = &[
    "option",
    "size",
    "visual",
    "statistic",
    "custom",
    "extension",
    "contact",
    "deformable",
    "tendon",
    "actuator",
    "sensor",
    "keyframe",
];

/// Sections that are translated.
pub const SECTIONS: &[&str] = &["compiler", "default", "asset", "worldbody", "equality"];

/// Elements of a body that are known and kept.
pub const KEPT_OF_BODY: &[&str] = &["camera", "light", "plugin", "skin", "flexcomp"];

/// Elements that generate bodies, which are not supported.
pub const MAKE_BODIES: &[&str] = &["replicate", "attach", "composite"];

/// Assets that are known and kept.
pub const KEPT_ASSETS: &[&str] = &["texture", "material", "hfield", "skin", "model"];

/// Elements of `<default>`.
pub const OF_DEFAULT: &[&str] = &[
    "default",
    "mesh",
    "material",
    "joint",
    "geom",
    "site",
    "camera",
    "light",
    "pair",
    "equality",
    "tendon",
    "general",
    "motor",
    "position",
    "velocity",
    "intvelocity",
    "damper",
    "cylinder",
    "muscle",
    "adhesion",
    "dcmotor",
];

/// What is known of an element.
pub fn known(tag: &str) -> Option<&'static Known> {
    ELEMENTS.iter().find(|known| known.tag == tag)
}
