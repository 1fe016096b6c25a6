//! List of what is compared, and how: help texts and docs print it, tests change each entry and look for the
//! difference. Add a new comparison here first.

/// Something that `diff`, `fingerprint` and `describe` compare, or not.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Compared {
    /// What, in a few words.
    pub what: &'static str,
    /// How it is compared: not as text, unless stated.
    pub meaning: &'static str,
    /// Which comparisons include it.
    pub by: By,
}

/// Which comparisons include something.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum By {
    /// All, including `diff --only kinematics` and the first hash of a fingerprint.
    Motion,
    /// All except `diff --only kinematics`; the second hash of a fingerprint.
    Matter,
    /// None.
    Nobody,
}

/// The list.
pub const COMPARED: &[Compared] = &[
    Compared {
        what: "axis, zero, sense, kind and pitch of every joint, and the tree structure",
        meaning: "screw axes relative to the carrying link; angles and axes read as intended",
        by: By::Motion,
    },
    Compared {
        what: "lower and upper limits",
        meaning: "joint positions; ‹up-to-zeros› uses the other robot's senses and zeros",
        by: By::Motion,
    },
    Compared {
        what: "mimic joints: driver, multiplier, offset",
        meaning: "the follower's value over the range of its first driver, senses and zeros as for limits",
        by: By::Motion,
    },
    Compared {
        what: "frames without a body: tools, sensors, mounting points",
        meaning: "pose on the carrying body",
        by: By::Motion,
    },
    Compared {
        what: "velocity and effort limits, also of continuous joints; the stated range of a continuous joint",
        meaning: "numbers, relative; positions as limits",
        by: By::Matter,
    },
    Compared { what: "damping and friction", meaning: "numbers, relative; 0 if not stated", by: By::Matter },
    Compared {
        what: "soft limits (safety_controller)",
        meaning: "positions as limits, factors relative",
        by: By::Matter,
    },
    Compared {
        what: "calibration: where a reference sensor switches",
        meaning: "positions as limits; a reversed sense swaps rising and falling",
        by: By::Matter,
    },
    Compared {
        what: "masses, centres of mass, inertia tensors",
        meaning: "of each link, on the carrying body, independent of link frames",
        by: By::Matter,
    },
    Compared {
        what: "visual and collision shapes: kind, size, pose, mesh file and scale",
        meaning: "size within the tolerance of lengths, pose on the body, symmetry of round shapes; the mesh's file name as text",
        by: By::Matter,
    },
    Compared {
        what: "poses in other elements: gazebo sensors and lights, plugin offsets, sensor origins, frames, loop ends, \
               friction directions",
        meaning: "pose on the body, independent of notation, unit, link frame and relative_to",
        by: By::Matter,
    },
    Compared {
        what: "transmissions (mechanicalReduction, hardware interfaces), gazebo, ros2_control, closed loops and every other \
               element",
        meaning: "value by value: as numbers, otherwise as text; names may have changed",
        by: By::Matter,
    },
    Compared {
        what: "attributes and text that are not understood",
        meaning: "as text; diff notes each kind",
        by: By::Matter,
    },
    Compared { what: "names", meaning: "diff reports them; ‹count-names› makes them count", by: By::Nobody },
    Compared {
        what: "frames of links that carry something",
        meaning: "if what they carry stays in place; diff reports them",
        by: By::Nobody,
    },
    Compared {
        what: "how a pose is written",
        meaning: "rpy or quat_xyzw, degrees, a zero pose left out",
        by: By::Nobody,
    },
    Compared { what: "materials", meaning: "colours and textures", by: By::Nobody },
    Compared { what: "the contents of mesh files", meaning: "only their names are compared", by: By::Nobody },
    Compared {
        what: "comments, the order of elements, how numbers are spelled",
        meaning: "1.5708 and 1.5707963 are both π/2, unless ‹exact› is given",
        by: By::Nobody,
    },
];

/// The list as lines of text, for help and docs: what is compared, then what is not.
pub fn listed() -> String {
    let part = |title: &str, by: By| {
        let lines = COMPARED
            .iter()
            .filter(|entry| entry.by == by)
            .map(|entry| format!("  - {}\n      {}\n", entry.what, entry.meaning));
        format!("{title}\n{}", lines.collect::<String>())
    };
    [
        part("Compared, also by `diff ‹only› kinematics`:", By::Motion),
        part("Compared as well:", By::Matter),
        part("Not compared:", By::Nobody),
    ]
    .join("")
}
