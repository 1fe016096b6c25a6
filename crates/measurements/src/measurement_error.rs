//! Errors in a measurement file: each message states the line, the error and the fix.

use std::fmt;
use thiserror::Error;

/// What spreadsheets write into a cell that they could not compute; German ones, too.
pub(super) const FAULTS: [&str; 12] = [
    "#N/A", "#NV", "#REF!", "#VALUE!", "#DIV/0!", "#NAME?", "#NUM!", "#NULL!", "#WERT!", "#BEZUG!", "#ZAHL!", "#NAME!",
];

/// A problem at a place in a measurement file.
#[derive(Debug, Clone, PartialEq, Error)]
#[error("{}{problem}", place(file, *line))]
pub struct DataProblem {
    /// The file's name.
    pub file: String,
    /// Line, counted from 1; 0 for the file as a whole.
    pub line: u64,
    /// What is wrong.
    pub problem: MeasurementError,
}

fn place(file: &str, line: u64) -> String {
    if line == 0 { format!("{file}: ") } else { format!("{file}:{line}: ") }
}

fn said(tip: &str) -> String {
    if tip.is_empty() { "the cell is empty".into() } else { format!("\"{tip}\" is not among the calibrated tips") }
}

/// All problems found in a file, in its order.
#[derive(Debug, Clone, PartialEq, Error)]
pub struct DataError {
    /// At least one.
    pub problems: Vec<DataProblem>,
    /// How many more there are.
    pub more: usize,
}

impl fmt::Display for DataError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, problem) in self.problems.iter().enumerate() {
            if index > 0 {
                writeln!(f)?;
            }
            write!(f, "{problem}")?;
        }
        if self.more > 0 {
            write!(f, "\n… and {} more", self.more)?;
        }
        Ok(())
    }
}

/// What is wrong.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum MeasurementError {
    /// An export that cannot be brought into the contract's form.
    #[error(transparent)]
    Import(#[from] super::import::ImportProblem),
    /// Nothing but comments.
    #[error("there is no header row; the first row names the columns: joints, then x,y,z or distance")]
    NoHeader,
    /// A header and no data.
    #[error("there are no rows below the header; each row is one pose of the robot")]
    NoRows,
    /// The text is not UTF-8, or a quote is never closed.
    #[error("{0}; write the file as UTF-8 text with comma-separated columns")]
    Unreadable(String),
    /// The columns are separated by something else.
    #[error("the header is a single column \"{found}\"; separate columns by commas, not by {separator}")]
    Separator {
        /// The header as read.
        found: String,
        /// What it seems to use.
        separator: &'static str,
    },
    /// Two columns of one name.
    #[error("column \"{0}\" appears twice; give each its own name")]
    DuplicateColumn(String),
    /// A column that lacks its name.
    #[error("column {0} has no name; name it or remove it")]
    NamelessColumn(usize),
    /// Neither joints nor poses.
    #[error(
        "no column belongs to a joint or a pose; there must be one for each of {joints}, or x,y,z with qx,qy,qz,qw or \
         roll,pitch,yaw"
    )]
    NeitherJointsNorPose {
        /// The joints.
        joints: String,
    },
    /// A joint of the chain has no column.
    #[error("joint \"{joint}\" has no column; {}", fix_for_joint(suggestion.as_deref(), joints))]
    MissingJoint {
        /// The joint.
        joint: String,
        /// A column whose name is nearly right.
        suggestion: Option<String>,
        /// All joints that need a column.
        joints: String,
    },
    /// No joint has a column, and as many columns as joints are numbered.
    #[error(
        "no column is named after a joint; if \"{first}\" to \"{last}\" are the joints' readings in this order, say ‹columns› {map}"
    )]
    NumberedJoints {
        /// The first of the columns.
        first: String,
        /// The last.
        last: String,
        /// The map.
        map: String,
    },
    /// No measured value.
    #[error(
        "no column holds a measured value; there must be x,y,z (with qx,qy,qz,qw for poses), or x1,y1,z1,x2,… for \
         several targets, or distance{}",
        suggestion.as_deref().map_or_else(String::new, |name| match name {
            "hole" => "; give the plate of the holes by ‹plate›".into(),
            _ => format!("; did you mean \"{name}\" to be one of them?"),
        })
    )]
    NothingMeasured {
        /// A column whose name is nearly right.
        suggestion: Option<String>,
    },
    /// A part of a group of columns is missing.
    #[error("column \"{missing}\" is missing beside \"{present}\"; {group} belong together")]
    Incomplete {
        /// What is missing.
        missing: String,
        /// What is there.
        present: String,
        /// The group.
        group: String,
    },
    /// A column of a pair of poses is missing.
    #[error(
        "column \"{missing}\" is missing; a pair of poses needs {group}, and the columns are {present}; an orientation is qx, qy, \
         qz, qw, or a rotation vector rx, ry, rz, or roll, pitch, yaw"
    )]
    NoPosePair {
        /// The first that is missing.
        missing: String,
        /// What belongs together.
        group: String,
        /// The columns of the file.
        present: String,
    },
    /// A row of a bare file of readings with another number of values.
    #[error(
        "the row has {found} values; a file of readings without a header has one for each of {expected} joints: {joints}"
    )]
    NotReadings {
        /// Its values.
        found: usize,
        /// The joints' number.
        expected: usize,
        /// The joints.
        joints: String,
    },
    /// Not a standard deviation.
    #[error(
        "column \"{column}\": {value} is not a standard deviation; write a positive number in the file's unit of length"
    )]
    NotADeviation {
        /// The column.
        column: String,
        /// The cell.
        value: f64,
    },
    /// A quaternion with several targets.
    #[error("a quaternion goes with one target x,y,z, and there are {0} targets; remove qx,qy,qz,qw")]
    QuaternionOfSeveral(usize),
    /// A column whose name is nearly one that has a meaning.
    #[error(
        "column \"{column}\" is nearly \"{known}\"; write \"{known}\" if that is meant, otherwise another name, such as \
         \"my_{known}\""
    )]
    NearMiss {
        /// The column.
        column: String,
        /// The name that has a meaning.
        known: String,
    },
    /// Columns that look like an orientation but have unknown names.
    #[error(
        "columns {columns} look like an orientation and would be left out; {fix}, or rename them if they are something \
         else"
    )]
    OrientationLeftOut {
        /// The columns.
        columns: String,
        /// What to do.
        fix: &'static str,
    },
    /// `<joint>.approach` of an unknown joint.
    #[error("column \"{column}\": there is no joint \"{joint}\"{}", did_you_mean(suggestion.as_deref()))]
    ColumnOfUnknownJoint {
        /// The column.
        column: String,
        /// The part before the dot.
        joint: String,
        /// A joint whose name is near.
        suggestion: Option<String>,
    },
    /// A row with too many or too few cells.
    #[error("{found} cells, but the header names {expected} columns; {}", if found > expected {
        "is a decimal comma or an unquoted comma in it?"
    } else {
        "write an empty cell for what was not seen"
    })]
    Ragged {
        /// Cells in this row.
        found: usize,
        /// Columns in the header.
        expected: usize,
    },
    /// A cell that is not a number.
    #[error("column \"{column}\": \"{text}\" is not a number; {}", fix_for_text(text))]
    NotANumber {
        /// The column.
        column: String,
        /// The cell.
        text: String,
    },
    /// NaN or infinite.
    #[error("column \"{column}\": \"{text}\" is not finite; {fix}")]
    NotFinite {
        /// The column.
        column: String,
        /// The cell.
        text: String,
        /// What to do.
        fix: &'static str,
    },
    /// A number beyond any robot or instrument.
    #[error("column \"{column}\": {text} is larger than anything that is measured; correct the cell or remove the row")]
    TooLarge {
        /// The column.
        column: String,
        /// The cell.
        text: String,
    },
    /// More columns than any measurement has.
    #[error(
        "the header names {found} columns, but at most {most} are read; are rows and columns of the file exchanged, or does it \
         lack a header line?"
    )]
    TooManyColumns {
        /// How many.
        found: usize,
        /// The limit.
        most: usize,
    },
    /// An empty cell where a number must be.
    #[error("column \"{column}\" is empty; every row needs this value: fill it in or remove the row")]
    Empty {
        /// The column.
        column: String,
    },
    /// Some but not all coordinates of a target.
    #[error("target \"{target}\" has some of x, y, z but not all; leave all empty where it was not seen")]
    PartOfTarget {
        /// The target.
        target: String,
    },
    /// A quaternion far from length 1.
    #[error("the quaternion has length {length:.6}, not 1; the columns are qx,qy,qz,qw in this order of meaning")]
    NotAUnitQuaternion {
        /// Its length.
        length: f64,
    },
    /// Pixels, and nothing is known of the camera.
    #[error(
        "columns u and v are pixels of an unknown camera; give its intrinsics by ‹camera› FILE.yaml and its board by \
         ‹board›, such as 7x5:30mm"
    )]
    PixelsWithoutCamera,
    /// A camera, and no pixels.
    #[error(
        "a camera was given, but no columns hold pixels; there must be u,v with corner, or u0,v0,u1,v1,… by corner"
    )]
    NoPixels,
    /// Pixels without a corner.
    #[error(
        "columns u, v do not say which corner of the board they show; add a column corner with its number, or board_x,board_y"
    )]
    WhichCorner,
    /// Numbers of corners, and no board.
    #[error("corners are numbered, but the board is unknown; give its squares by ‹board›, such as 7x5:30mm")]
    NoBoard,
    /// A number that no corner of the board has.
    #[error("corner \"{corner}\" is not on the board ({board}: corners 0 to {last})")]
    NoSuchCorner {
        /// As written.
        corner: String,
        /// The board.
        board: String,
        /// The largest number.
        last: usize,
    },
    /// A corner that appears twice in one image.
    #[error(
        "corner \"{corner}\" appears twice in one image; remove one of them, or number the images in a column image"
    )]
    CornerTwice {
        /// As written.
        corner: String,
    },
    /// Half a pixel.
    #[error("corner \"{corner}\" has one of {columns} but not both; leave both empty where it was not seen")]
    PartOfCorner {
        /// As written.
        corner: String,
        /// Their names.
        columns: String,
    },
    /// Gravity without a direction.
    #[error("gravity_x, gravity_y and gravity_z are all 0; leave the three cells empty where nothing was read")]
    NoDirection,
    /// Two inclinations that two axes at right angles cannot have.
    #[error(
        "two axes at right angles cannot be inclination_x {:.4} and inclination_y {:.4} rad above the horizontal; if the file is in \
         degrees, say ‹units› m,deg",
        .0[0], .0[1]
    )]
    NotTwoInclinations([f64; 2]),
    /// Several tips, and no column that names the tip of a row.
    #[error(
        "there is no column \"tip\", but several tips are calibrated; add one that names the tip of each row: {tips}"
    )]
    NoTipColumn {
        /// The tips.
        tips: String,
    },
    /// A row that names no tip, or another one.
    #[error("column \"tip\": {}; write the tip that the row was measured at: {tips}", said(found))]
    NotATip {
        /// As written.
        found: String,
        /// The tips.
        tips: String,
    },
    /// A row of a contact that does not name two tips.
    #[error(
        "column \"tip\": {}; a row with a contact or a grip names both tips, with a + between them: {tips}",
        said(found)
    )]
    NotTwoTips {
        /// As written.
        found: String,
        /// The tips.
        tips: String,
    },
    /// Contacts or grips of a robot that is calibrated to one tip.
    #[error(
        "column \"{0}\" needs two tips of the robot, but one is named; name both (‹tip› LINK ‹tip› LINK), or call a \
         place that does not move with the robot a socket"
    )]
    TwoTipsOfOne(&'static str),
    /// A row of another tip than the one that is calibrated.
    #[error(
        "column \"tip\": the row belongs to \"{found}\", but the chain ends at \"{tip}\"; name every tip that is calibrated \
         (‹tip› {tip} ‹tip› {found}), or give the column another name where it means something else"
    )]
    AnotherTip {
        /// As written.
        found: String,
        /// The chain's.
        tip: String,
    },
    /// A pixel that is not in the image.
    #[error(
        "column \"{column}\": {value} is outside the image of {width} x {height} pixels; are these this camera's pixels?"
    )]
    OutsideImage {
        /// The column.
        column: String,
        /// The cell.
        value: f64,
        /// px.
        width: f64,
        /// px.
        height: f64,
    },
    /// No image says where the board is.
    #[error(
        "no image shows four corners of the board that are not in one line, but the camera's pose needs them; check \
         ‹board›, ‹camera› and the numbers of the corners"
    )]
    NoBoardPose,
    /// A distance that is not positive.
    #[error("distance {0} is not positive; it is the length in m from the anchor to the target")]
    NotPositive(f64),
    /// A side other than +1 and -1.
    #[error("column \"{column}\": {value} is not a side; write 1 or -1, or 0 where it is unknown")]
    NotASide {
        /// The column.
        column: String,
        /// The cell.
        value: f64,
    },
    /// `locate` other than 0 and 1.
    #[error("column \"locate\": {0} is neither 0 nor 1")]
    NotAFlag(f64),
    /// Joint readings that look like degrees.
    #[error(
        "joint \"{joint}\" reads {value} rad, and its limits are {lower:.3} to {upper:.3} rad; if the readings are in \
         degrees, say ‹units› deg"
    )]
    LooksLikeDegrees {
        /// The joint.
        joint: String,
        /// The reading.
        value: f64,
        /// rad.
        lower: f64,
        /// rad.
        upper: f64,
    },
    /// Slides that look like millimetres.
    #[error(
        "joint \"{joint}\" reads {value} m, and its limits are {lower:.3} to {upper:.3} m; if the lengths are in \
         millimetres, say ‹units› mm"
    )]
    LooksLikeMillimetres {
        /// The joint.
        joint: String,
        /// The reading.
        value: f64,
        /// m.
        lower: f64,
        /// m.
        upper: f64,
    },
    /// Measured lengths far beyond the robot.
    #[error(
        "the measured {what} span {span:.4} m, but no two places that this robot can reach are further apart than \
         {reach:.4} m; if the lengths are in millimetres, say ‹units› mm"
    )]
    BeyondReach {
        /// `positions` or `distances`.
        what: &'static str,
        /// m.
        span: f64,
        /// m.
        reach: f64,
    },
    /// No observation at all.
    #[error("no row has a measured value; every cell of the targets is empty")]
    NothingSeen,
}

fn did_you_mean(suggestion: Option<&str>) -> String {
    suggestion
        .map_or_else(|| "; name it after a joint of the chain".into(), |name| format!("; did you mean \"{name}\"?"))
}

fn fix_for_joint(suggestion: Option<&str>, joints: &str) -> String {
    suggestion.map_or_else(
        || format!("the file needs one column for each of {joints}"),
        |name| format!("did you mean column \"{name}\"? Rename that column"),
    )
}

fn fix_for_text(text: &str) -> &'static str {
    if text.contains(',') {
        "write the decimal point as a dot"
    } else if FAULTS.contains(&text) {
        "the spreadsheet could not compute it: correct the cell or remove the row"
    } else if text.starts_with('#') {
        "write a comment on a line of its own"
    } else {
        "correct the cell or remove the row"
    }
}
