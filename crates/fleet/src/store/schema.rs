//! The tables of a store: columns, units and what they mean; `docs/fleet-store.md` is made of this list.

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
    /// What it says; empty cells where that does not apply.
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
    /// Its columns behind [`COMMON`].
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
    /// There is none of this name.
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
    column("key", Text, "", "SHA-256 of inputs, options and version: the run that the row is of"),
    column("serial", Text, "", "the robot"),
    column("date", Day, "", "the night"),
    column("task", Text, "", "calibrate, table, check, fingerprint or diff"),
];

/// One row a run.
pub const RUNS: TableKind = TableKind {
    name: "runs",
    row: "a robot, a night, a task: finished or failed",
    own: &[
        column("robot", Text, "", "the robot's file as the manifest names it"),
        column("name", Text, "", "the name that the file gives the robot"),
        column("data", Text, "", "the files of measurements, joined by ;"),
        column("event", Text, "", "what happened before this night, as the manifest says: collision, gear exchanged"),
        column("version", Text, "", "of denavit"),
        column("ok", Flag, "", "whether it was done"),
        column("error", Text, "", "why not"),
        column(
            "verdict",
            Text,
            "",
            "calibrate: the stage adopted; check: clean, warned or failed; diff: same or different",
        ),
        column("fingerprint", Text, "", "of the robot as drawn"),
        column("rows_fitted", Count, "", "rows of measurements fitted"),
        column("rows_held_out", Count, "", "rows held out"),
        column("nominal_rms", Real, "m", "error of the drawing on the rows held out, else on those fitted"),
        column("geometric_rms", Real, "m", "the same with the geometry fitted"),
        column("rms", Real, "m", "the same at the stage adopted"),
        column("structured", Flag, "", "whether what is left has structure that no effect explains"),
        added("base", Text, "", "link that the calibrated chain starts at"),
        added("tip", Text, "", "link that it ends at"),
        added("prior", Text, "", "what the fit went on from: siblings, or a file as the manifest names it"),
        added("prior_weight", Real, "1", "how much of that counted, as the rows bear it out"),
        column(
            "seconds",
            Real,
            "s",
            "computing time; the one number that another run of the same work does not repeat",
        ),
    ],
};

/// One row a parameter.
pub const PARAMETERS: TableKind = TableKind {
    name: "parameters",
    row: "a parameter of a joint: its change from the drawing (calibrate), or a number of the D-H table (table)",
    own: &[
        column("joint", Text, "", "the joint; base and tool have none"),
        column("parameter", Text, "", "turn_x … move_z, pitch, scale; theta, d, alpha, a, beta"),
        column("value", Real, "unit", "the number"),
        column("std", Real, "unit", "standard deviation, the prior included"),
        column("half_interval_95", Real, "unit", "half the interval that holds the true value with 95 %"),
        column("unit", Text, "", "rad, m, m/rad or 1"),
        column("held_by_prior", Real, "1", "how much of the spread is the prior's: 1 where the data say nothing"),
    ],
};

/// One row an axis.
pub const AXES: TableKind = TableKind {
    name: "axes",
    row: "the screw axis of a joint as drawn, which parameters are counted from, in the base frame",
    own: &[
        column("joint", Text, "", "the joint"),
        column("omega_x", Real, "1", "direction; 0 of a slide"),
        column("omega_y", Real, "1", "the same"),
        column("omega_z", Real, "1", "the same"),
        column("v_x", Real, "m", "speed of the point at the origin, for 1 rad/s; direction of a slide"),
        column("v_y", Real, "m", "the same"),
        column("v_z", Real, "m", "the same"),
    ],
};

/// One row two parameters.
pub const INFORMATION: TableKind = TableKind {
    name: "information",
    row: "what the rows alone, no prior, say of two parameters together; instrument, target and effects are left free",
    own: &[
        column("parameter", Text, "", "such as elbow_joint.turn_x"),
        column("other", Text, "", "such as this one itself; each two stand together once; empty: the pull"),
        column(
            "value",
            Real,
            "1/unit²",
            "inverse covariance Λ of the two; with nothing (1/unit): the pull η, so that the rows' likelihood is exp(-½ θᵀΛθ + ηᵀθ)",
        ),
    ],
};

/// One row a number of an effect.
pub const EFFECTS: TableKind = TableKind {
    name: "effects",
    row: "a number of an effect that the data ask for",
    own: &[
        column("kind", Text, "", "joint_compliance, backlash, …"),
        column("place", Text, "", "the joint, or base, target, instrument"),
        column("driven_by", Text, "", "the recorded quantity or the other joint that drives it"),
        column("parameter", Text, "", "which number of the effect"),
        column("value", Real, "unit", "the number"),
        column("std", Real, "unit", "standard deviation"),
        column("unit", Text, "", "of value and std"),
        column("probability", Real, "1", "posterior probability that this kind acts here"),
        column("found_again", Real, "1", "share of resampled runs that find it"),
        column("named", Flag, "", "false: it stays in the model, but another cause may explain the same"),
    ],
};

/// One row a point of a curve.
pub const CURVES: TableKind = TableKind {
    name: "curves",
    row: "a point of a joint's error curve, no cause claimed",
    own: &[
        column("joint", Text, "", "the joint"),
        column("reading", Real, "unit", "the joint's reading"),
        column("value", Real, "unit", "what is added to the reading"),
        column("std", Real, "unit", "standard deviation of that"),
        column("unit", Text, "", "rad or m"),
    ],
};

/// One row an observation.
pub const RESIDUALS: TableKind = TableKind {
    name: "residuals",
    row: "what the adopted model leaves of one observation",
    own: &[
        column("line", Count, "", "line of the row in its file"),
        column("setup", Text, "", "where there are several"),
        column("target", Text, "", "where there are several"),
        column("held_out", Flag, "", "kept for the test"),
        column("rejected", Flag, "", "left out as a gross error"),
        column(
            "x",
            Real,
            "m",
            "measured less predicted, base frame; the distance or the only number where there is one",
        ),
        column("y", Real, "m", "the same"),
        column("z", Real, "m", "the same"),
        column("rx", Real, "rad", "of the orientation, a rotation vector in the base frame"),
        column("ry", Real, "rad", "the same"),
        column("rz", Real, "rad", "the same"),
    ],
};

/// One row a remark.
pub const NOTES: TableKind = TableKind {
    name: "notes",
    row: "what must be said of a run: a rule that is broken, a difference, what no row tells",
    own: &[
        column("kind", Text, "", "rule, difference, reading, unidentifiable, unexplained, drawing"),
        column("code", Text, "", "of the rule, of the parameter, of the change"),
        column("level", Text, "", "error, warning, note"),
        column("place", Text, "", "joint, link, or file:line"),
        column("message", Text, "", "the sentence"),
        column("value", Real, "unit", "how much, where it has a number"),
        column("unit", Text, "", "of value"),
    ],
};

/// Every table; runs last, as its row says that the others are whole.
pub const TABLES: [&TableKind; 8] = [&INFORMATION, &AXES, &PARAMETERS, &EFFECTS, &CURVES, &RESIDUALS, &NOTES, &RUNS];

/// The tables as the document shows them.
pub fn markdown() -> String {
    use std::fmt::Write as _;
    let mut text = String::new();
    let row = |text: &mut String, column: &Column| {
        let _ = writeln!(text, "| `{}` | {} | {} | {} |", column.name, column.kind.name(), column.unit, column.meaning);
    };
    let head = "| column | type | unit | what it says |\n|---|---|---|---|\n";
    let _ = write!(text, "Every row begins with\n\n{head}");
    for column in COMMON {
        row(&mut text, column);
    }
    for table in TABLES.iter().rev() {
        let _ = write!(text, "\n`{}/*.parquet`: {}.\n\n{head}", table.name, table.row);
        for column in table.own {
            row(&mut text, column);
        }
    }
    text
}
