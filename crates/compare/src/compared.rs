//! What is compared and by which meaning, in one list: help texts and docs print it, tests change each entry and look for
//! the difference. Who compares something new adds it here first.

/// Something that `diff`, `fingerprint` and `describe` look at, or do not.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Compared {
    /// What, in a few words.
    pub what: &'static str,
    /// As what it is compared: not as text, unless that is said.
    pub meaning: &'static str,
    /// Who looks at it.
    pub by: By,
}

/// Who looks at something.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum By {
    /// Everybody; also `diff --only kinematics`, and the first hash of a fingerprint.
    Motion,
    /// Everybody but `diff --only kinematics`; the second hash of a fingerprint.
    Matter,
    /// Nobody.
    Nobody,
}

/// The list.
pub const COMPARED: &[Compared] = &[
    Compared {
        what: "axis, zero, sense, kind and pitch of every joint, and what carries what",
        meaning: "screw axes on the link that carries them; angles and axes read as intended",
        by: By::Motion,
    },
    Compared {
        what: "lower and upper limits",
        meaning: "joint positions; ‹up-to-zeros› takes the other robot's senses and zeros",
        by: By::Motion,
    },
    Compared {
        what: "mimic joints: whom they follow, multiplier, offset",
        meaning: "the follower's value over the range of the joint that moves it in the end, senses and zeros as for limits",
        by: By::Motion,
    },
    Compared {
        what: "frames without a body: tools, sensors, mounting points",
        meaning: "pose on the body that carries them",
        by: By::Motion,
    },
    Compared {
        what: "velocity and effort limits, also of continuous joints; a range that a continuous joint states",
        meaning: "numbers, relative; positions as limits",
        by: By::Matter,
    },
    Compared { what: "damping and friction", meaning: "numbers, relative; 0 where none is stated", by: By::Matter },
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
        meaning: "of each link, on the body that carries it, in no link's frame",
        by: By::Matter,
    },
    Compared {
        what: "visual and collision shapes: kind, size, place, mesh file and scale",
        meaning: "size within the tolerance of lengths, pose on the body, symmetry of round shapes; the mesh's file name as text",
        by: By::Matter,
    },
    Compared {
        what: "what elements place: sensors and lights of gazebo, offsets of plugins, sensor origins, frames, ends of loops, \
               directions of friction",
        meaning: "pose on the body, whatever notation, unit, link frame or relative_to it is given by",
        by: By::Matter,
    },
    Compared {
        what: "transmissions (mechanicalReduction, hardware interfaces), gazebo, ros2_control, closed loops and every other \
               element",
        meaning: "value by value: numbers as numbers, else text, under names that may have changed",
        by: By::Matter,
    },
    Compared {
        what: "attributes and texts that are not understood",
        meaning: "as text; diff notes each kind of them",
        by: By::Matter,
    },
    Compared { what: "names", meaning: "diff reports them; ‹count-names› makes them count", by: By::Nobody },
    Compared {
        what: "link frames that carry something",
        meaning: "as long as that stays where it was; diff reports them",
        by: By::Nobody,
    },
    Compared {
        what: "how a place is written",
        meaning: "rpy or quat_xyzw, degrees, a pose left out because it is zero",
        by: By::Nobody,
    },
    Compared { what: "materials", meaning: "colours and textures", by: By::Nobody },
    Compared { what: "the contents of mesh files", meaning: "their names are compared", by: By::Nobody },
    Compared {
        what: "comments, the order of elements, how numbers are spelled",
        meaning: "1.5708 and 1.5707963 are both π/2, unless ‹exact› is said",
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

#[cfg(test)]
mod tests;
