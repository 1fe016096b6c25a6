//! The tables of a store: columns, units and meanings; `docs/fleet-store.md` is generated from this list.

/// What a column holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// UTF-8 text.
    Text,
    /// 64-bit floating point.
    Real,
    /// 64-bit integer.
    Count,
    /// True or false.
    Flag,
    /// A day.
    Day,
}

impl Kind {
    /// Its name in the documents.
    pub fn name(self) -> &'static str {
        match self {
            Self::Text => "text",
            Self::Real => "double",
            Self::Count => "int64",
            Self::Flag => "boolean",
            Self::Day => "date",
        }
    }
}

/// A column.
#[derive(Debug, Clone, Copy)]
pub struct Column {
    /// Its name.
    pub name: &'static str,
    /// What it holds.
    pub kind: Kind,
    /// Of its numbers; empty where they have none.
    pub unit: &'static str,
    /// Its meaning; cells are empty if it does not apply.
    pub meaning: &'static str,
    /// Stores of older versions do not have it: its cells are then empty.
    pub added: bool,
}

/// A table.
#[derive(Debug)]
pub struct TableKind {
    /// Its name, and that of its folder.
    pub name: &'static str,
    /// What a row is.
    pub row: &'static str,
    /// Its columns after [`COMMON`].
    pub own: &'static [Column],
}

impl TableKind {
    /// Every column.
    pub fn columns(&self) -> impl Iterator<Item = &'static Column> {
        COMMON.iter().chain(self.own)
    }

    /// Place of a column among all.
    ///
    /// # Panics
    /// No column has this name.
    pub fn index(&self, name: &str) -> usize {
        self.columns().position(|column| column.name == name).expect("a column of this table")
    }
}

const fn column(name: &'static str, kind: Kind, unit: &'static str, meaning: &'static str) -> Column {
    Column { name, kind, unit, meaning, added: false }
}

/// A column that was not there at first.
const fn added(name: &'static str, kind: Kind, unit: &'static str, meaning: &'static str) -> Column {
    Column { name, kind, unit, meaning, added: true }
}

use Kind::{Count, Day, Flag, Real, Text};

/// What every row begins with.
pub const COMMON: &[Column] = &[
    column("key", Text, "", "SHA-256 of inputs, options and version: identifies the run"),
    column("serial", Text, "", "the robot"),
    column("date", Day, "", "the night"),
    column("task", Text, "", "calibrate, table, check, fingerprint or diff"),
];

/// One row a run.
pub const RUNS: TableKind = TableKind {
    name: "runs",
    row: "one robot, night and task, finished or failed",
    own: &[
        column("robot", Text, "", "file of the robot"),
        column("name", Text, "", "the robot's name in its file"),
        column("data", Text, "", "measurement files, joined by ;"),
        column("event", Text, "", "event before this night (manifest)"),
        column("version", Text, "", "version of denavit"),
        column("ok", Flag, "", "succeeded"),
        column("error", Text, "", "error message"),
        column(
            "verdict",
            Text,
            "",
            "calibrate: the stage adopted; check: clean, warned or failed; diff: same or different",
        ),
        column("fingerprint", Text, "", "fingerprint of the nominal robot"),
        column("rows_fitted", Count, "", "training rows"),
        column("rows_held_out", Count, "", "held-out rows"),
        column("nominal_rms", Real, "m", "nominal error on held-out rows (training rows if there are none)"),
        column("geometric_rms", Real, "m", "with fitted geometry"),
        column("rms", Real, "m", "at the adopted stage"),
        column("structured", Flag, "", "residuals have unexplained structure"),
        added("base", Text, "", "first link of the chain"),
        added("tip", Text, "", "last link"),
        added("prior", Text, "", "prior: siblings, or a file"),
        added("prior_weight", Real, "1", "weight of the prior"),
        column("seconds", Real, "s", "computing time; not reproducible"),
    ],
};

/// One row a parameter.
pub const PARAMETERS: TableKind = TableKind {
    name: "parameters",
    row: "a parameter of a joint: its change from nominal (calibrate), or a number of the D-H table (table)",
    own: &[
        column("joint", Text, "", "joint; empty for base and tool"),
        column("parameter", Text, "", "turn_x … move_z, pitch, scale; theta, d, alpha, a, beta"),
        column("value", Real, "unit", "the number"),
        column("std", Real, "unit", "standard deviation, the prior included"),
        column("half_interval_95", Real, "unit", "half of the 95 % interval"),
        column("unit", Text, "", "rad, m, m/rad or 1"),
        column("held_by_prior", Real, "1", "share of the variance from the prior: 1 if not identifiable"),
    ],
};

/// One row an axis.
pub const AXES: TableKind = TableKind {
    name: "axes",
    row: "the nominal screw axis of a joint, base frame; parameters are changes from it",
    own: &[
        column("joint", Text, "", "the joint"),
        column("omega_x", Real, "1", "direction; 0 if prismatic"),
        column("omega_y", Real, "1", "as above"),
        column("omega_z", Real, "1", "as above"),
        column("v_x", Real, "m", "velocity at the origin for 1 rad/s; direction if prismatic"),
        column("v_y", Real, "m", "as above"),
        column("v_z", Real, "m", "as above"),
    ],
};

/// One row two parameters.
pub const INFORMATION: TableKind = TableKind {
    name: "information",
    row: "information of the rows about two parameters, without prior; instrument, target and effects free",
    own: &[
        column("parameter", Text, "", "such as elbow_joint.turn_x"),
        column("other", Text, "", "second parameter, each pair once; empty: η"),
        column("value", Real, "1/unit²", "Λ; η (1/unit) if `other` is empty: likelihood exp(-½ θᵀΛθ + ηᵀθ)"),
    ],
};

/// One row a number of an effect.
pub const EFFECTS: TableKind = TableKind {
    name: "effects",
    row: "a coefficient of a selected effect",
    own: &[
        column("kind", Text, "", "joint_compliance, backlash, …"),
        column("place", Text, "", "joint, base, target, instrument"),
        column("driven_by", Text, "", "recorded quantity or joint that drives it"),
        column("parameter", Text, "", "name of the coefficient"),
        column("value", Real, "unit", "the number"),
        column("std", Real, "unit", "standard deviation"),
        column("unit", Text, "", "of value and std"),
        column("probability", Real, "1", "posterior probability"),
        column("found_again", Real, "1", "share of half-sample refits that select it"),
        column("named", Flag, "", "false: included in the model, cause uncertain"),
    ],
};

/// One row a point of a curve.
pub const CURVES: TableKind = TableKind {
    name: "curves",
    row: "a point of a joint's error curve",
    own: &[
        column("joint", Text, "", "the joint"),
        column("reading", Real, "unit", "the joint's reading"),
        column("value", Real, "unit", "error added to the reading"),
        column("std", Real, "unit", "standard deviation"),
        column("unit", Text, "", "rad or m"),
    ],
};

/// One row an observation.
pub const RESIDUALS: TableKind = TableKind {
    name: "residuals",
    row: "the residual of one observation",
    own: &[
        column("line", Count, "", "line of the row in its file"),
        column("setup", Text, "", "where there are several"),
        column("target", Text, "", "where there are several"),
        column("held_out", Flag, "", "held out"),
        column("rejected", Flag, "", "excluded as a gross error"),
        column("x", Real, "m", "measured minus predicted, base frame; a distance is in `x`"),
        column("y", Real, "m", "as above"),
        column("z", Real, "m", "as above"),
        column("rx", Real, "rad", "rotation vector, base frame"),
        column("ry", Real, "rad", "as above"),
        column("rz", Real, "rad", "as above"),
    ],
};

/// One row a remark.
pub const NOTES: TableKind = TableKind {
    name: "notes",
    row: "findings: a rule, a difference, a parameter that is not identifiable",
    own: &[
        column("kind", Text, "", "rule, difference, reading, unidentifiable, unexplained, drawing"),
        column("code", Text, "", "rule, parameter or change"),
        column("level", Text, "", "error, warning, note"),
        column("place", Text, "", "joint, link, or file:line"),
        column("message", Text, "", "the sentence"),
        column("value", Real, "unit", "size, if any"),
        column("unit", Text, "", "of value"),
    ],
};

/// Every table; `runs` last, because its row marks the others as complete.
pub const TABLES: [&TableKind; 8] = [&INFORMATION, &AXES, &PARAMETERS, &EFFECTS, &CURVES, &RESIDUALS, &NOTES, &RUNS];

/// The tables as the document shows them.
pub fn markdown() -> String {
    use std::fmt::Write as _;
    let mut text = String::new();
    let line = |text: &mut String, column: &Column| {
        let unit = if column.unit.is_empty() { String::new() } else { format!(", {}", column.unit) };
        let _ = writeln!(text, "- `{}` {}{unit}: {}", column.name, column.kind.name(), column.meaning);
    };
    text.push_str("Every row begins with\n\n");
    for column in COMMON {
        line(&mut text, column);
    }
    for table in TABLES.iter().rev() {
        let _ = write!(text, "\n`{}/*.parquet`: {}.\n\n", table.name, table.row);
        for column in table.own {
            line(&mut text, column);
        }
    }
    text
}
