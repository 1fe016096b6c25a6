//! Screw axes and home pose as documents: text, CSV, JSON.
//!
//! CSV: `row,joint,kind,wx,wy,wz,vx,vy,vz,pitch,scale`; rows 1 … n hold unit twists, row `tool` the twist whose
//! exponential is the home pose, as in the paper's Table I.

use crate::formats::json::{CoordinateEntry, NoteEntry, UnitsEntry};
use crate::numbers::{Units, decimal, exact};
use comfy_table::{CellAlignment, Table as Grid, presets};
use denavit_dh::Motion;
use denavit_model::chain::Chain;
use denavit_model::notes::Note;
use denavit_model::se3;
use denavit_model::words::{one_line, to_cell};
use serde::{Deserialize, Serialize};
use std::fmt::Write as _;

/// The schema's name and version.
pub const SCHEMA: &str = "denavit.poe/1";

/// A product of exponentials as a file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PoeFile {
    /// [`SCHEMA`].
    pub schema: String,
    /// The robot's name.
    pub robot: String,
    /// Base link: the frame of the twists.
    pub base: String,
    /// Tip link.
    pub tip: String,
    /// Always `m` and `rad`.
    pub units: UnitsEntry,
    /// What moves it.
    pub coordinates: Vec<CoordinateEntry>,
    /// From base to tip.
    pub joints: Vec<ScrewEntry>,
    /// base_from_tip with every joint value 0: 4 rows of 4.
    pub home: [[f64; 4]; 4],
    /// Numbers not read as written, and other findings.
    #[serde(default)]
    pub notes: Vec<NoteEntry>,
}

/// A joint's screw axis.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ScrewEntry {
    /// Joint name.
    pub name: String,
    /// `revolute`, `prismatic` or `helical`.
    pub kind: String,
    /// Name of the coordinate that moves it.
    pub coordinate: String,
    /// `[omega; v]` of unit length, or of any length where no scale is given.
    pub twist: [f64; 6],
    /// m/rad; follows from the twist, repeated for readers.
    #[serde(default)]
    pub pitch: f64,
    /// Joint value per coordinate.
    #[serde(default = "one")]
    pub scale: f64,
    /// Joint value at coordinate 0, rad or m.
    #[serde(default)]
    pub offset: f64,
}

fn one() -> f64 {
    1.0
}

impl PoeFile {
    /// The file of a chain.
    pub fn of(chain: &Chain, notes: &[Note]) -> Self {
        let joints = chain.joints().iter().map(|joint| {
            let motion = Motion::of(&joint.screw);
            ScrewEntry {
                name: joint.name.clone(),
                kind: motion.word().to_owned(),
                coordinate: chain.coordinates()[joint.coordinate].name.clone(),
                twist: joint.screw.twist().into(),
                pitch: motion.pitch(),
                scale: joint.scale,
                offset: joint.offset,
            }
        });
        let home = chain.home().to_homogeneous();
        Self {
            schema: SCHEMA.to_owned(),
            robot: chain.name().to_owned(),
            base: chain.base().to_owned(),
            tip: chain.tip().to_owned(),
            units: UnitsEntry { length: "m".into(), angle: "rad".into() },
            coordinates: chain.coordinates().iter().map(CoordinateEntry::from).collect(),
            joints: joints.collect(),
            home: std::array::from_fn(|row| std::array::from_fn(|column| home[(row, column)])),
            notes: notes.iter().map(NoteEntry::from).collect(),
        }
    }
}

/// JSON at full precision; denavit reads it back.
pub fn json(chain: &Chain, notes: &[Note]) -> String {
    serde_json::to_string_pretty(&PoeFile::of(chain, notes)).expect("every number of a chain is finite") + "\n"
}

/// CSV at full precision; denavit reads it back. Joint offsets are folded into the axes and the home pose.
pub fn csv(chain: &Chain) -> String {
    let form = denavit_model::forms::BaseForm::of(chain);
    let mut writer = ::csv::Writer::from_writer(Vec::new());
    let mut write = |cells: Vec<String>| writer.write_record(cells).expect("writing to memory does not fail");
    let header = ["row", "joint", "kind", "wx", "wy", "wz", "vx", "vy", "vz", "pitch", "scale"];
    write(header.map(str::to_owned).to_vec());
    for (index, (joint, twist)) in chain.joints().iter().zip(&form.twists).enumerate() {
        let motion = Motion::of(&joint.screw);
        let unit = twist / joint.scale;
        let coordinate = to_cell(&chain.coordinates()[joint.coordinate].name).into_owned();
        let numbers = unit.iter().copied().chain([motion.pitch(), joint.scale]).map(exact);
        write([(index + 1).to_string(), coordinate, motion.word().to_owned()].into_iter().chain(numbers).collect());
    }
    let home = se3::log(&form.home);
    let numbers = home.iter().copied().chain([0.0, 1.0]).map(exact);
    write(["tool".to_owned(), String::new(), String::new()].into_iter().chain(numbers).collect());
    String::from_utf8(writer.into_inner().expect("writing to memory does not fail")).expect("every cell was text")
}

/// Aligned text: a point on each axis is easier to check on a drawing than v, so both are shown.
pub fn text(chain: &Chain, notes: &[Note], units: Units) -> String {
    let length = units.length_word();
    let mut out = format!("{}   {} → {}\n", one_line(chain.name()), one_line(chain.base()), one_line(chain.tip()));
    let _ =
        writeln!(out, "screw axes [ω; v] in the base frame at zero, v and points in {length}, pitch in {length}/rad\n");
    let mut grid = Grid::new();
    grid.load_style(presets::NOTHING);
    grid.set_header([
        "joint",
        "kind",
        "ωx",
        "ωy",
        "ωz",
        "vx",
        "vy",
        "vz",
        "point on the axis",
        "pitch",
        "scale",
        "offset",
    ]);
    for joint in chain.joints() {
        let motion = Motion::of(&joint.screw);
        let twist = joint.screw.twist();
        let angular = twist.iter().take(3).map(|w| decimal(*w, 8));
        let prismatic = joint.screw.line().is_none();
        let linear = twist.iter().skip(3).map(|v| if prismatic { decimal(*v, 8) } else { units.length(*v) });
        let point = joint
            .screw
            .line()
            .map_or_else(String::new, |line| line.point.iter().map(|x| units.length(*x)).collect::<Vec<_>>().join(" "));
        let tail = [point, units.length(motion.pitch()), decimal(joint.scale, 9), decimal(joint.offset, 9)];
        let cells = [one_line(&joint.name).into_owned(), motion.word().to_owned()]
            .into_iter()
            .chain(angular)
            .chain(linear)
            .chain(tail);
        grid.add_row(cells.collect::<Vec<_>>());
    }
    for (index, column) in grid.column_iter_mut().enumerate() {
        let side = if index > 1 && index != 8 { CellAlignment::Right } else { CellAlignment::Left };
        column.set_cell_alignment(side);
    }
    for line in grid.lines() {
        let _ = writeln!(out, "{}", line.trim_end());
    }
    out.push_str("\nhome pose, base_from_tip at zero\n\n");
    out.push_str(&pose_text(chain.home(), units));
    for note in notes {
        let _ = writeln!(out, "\n  {}", one_line(&note.to_string()));
    }
    out
}

/// A pose as a matrix of four rows, translation in the given units.
pub fn pose_text(pose: &se3::Pose, units: Units) -> String {
    let matrix = pose.to_homogeneous();
    let mut grid = Grid::new();
    grid.load_style(presets::NOTHING);
    for row in 0..4 {
        let cell = |column: usize| {
            let value = matrix[(row, column)];
            if column == 3 && row < 3 { units.length(value) } else { decimal(value, 9) }
        };
        grid.add_row((0..4).map(cell).collect::<Vec<_>>());
    }
    for column in grid.column_iter_mut() {
        column.set_cell_alignment(CellAlignment::Right);
    }
    grid.lines().fold(String::new(), |text, line| text + line.trim_end() + "\n")
}
