//! What is compared, in one list: help texts and docs print it, tests change each entry and look for the difference.

/// Something that `diff`, `fingerprint` and `describe` look at, or do not.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Compared {
    /// What, in a few words.
    pub what: &'static str,
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
    Compared { what: "axis, zero, sense, kind and pitch of every joint, and what carries what", by: By::Motion },
    Compared { what: "lower and upper limits", by: By::Motion },
    Compared { what: "mimic joints: whom they follow, multiplier, offset", by: By::Motion },
    Compared { what: "frames without a body: tools, sensors, mounting points", by: By::Motion },
    Compared { what: "velocity and effort limits, also of continuous joints", by: By::Matter },
    Compared { what: "damping and friction", by: By::Matter },
    Compared { what: "soft limits (safety_controller)", by: By::Matter },
    Compared { what: "calibration, and whatever else stands in a joint or a link", by: By::Matter },
    Compared { what: "masses, centres of mass, inertia tensors", by: By::Matter },
    Compared { what: "visual and collision shapes: kind, size, place, mesh file and scale", by: By::Matter },
    Compared {
        what: "transmissions (mechanicalReduction, hardware interfaces), gazebo, ros2_control and every other element",
        by: By::Matter,
    },
    Compared { what: "names (diff reports them; ‹count-names› makes them count)", by: By::Nobody },
    Compared {
        what: "link frames that carry something, as long as that stays where it was (diff reports them)",
        by: By::Nobody,
    },
    Compared { what: "materials: colours and textures", by: By::Nobody },
    Compared { what: "the contents of mesh files", by: By::Nobody },
    Compared { what: "comments, the order of elements, how numbers are spelled", by: By::Nobody },
];

/// The list as lines of text, for help and docs: what is compared, then what is not.
pub fn listed() -> String {
    let part = |title: &str, by: By| {
        let lines = COMPARED.iter().filter(|entry| entry.by == by).map(|entry| format!("  - {}\n", entry.what));
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
