//! The questions of a page.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use denavit_dh::{Convention, Gauge};
use denavit_export::Units;
use denavit_export::sources::Stated;
use denavit_load::{Loaded, NEARLY_PARALLEL, Opened, Options, Selection, TableOptions};
use denavit_model::{Chain, ChainJoint, Reading};
use denavit_xacro::files::FileOverlay;
use serde::Deserialize;
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::io;
use std::path::{Path, PathBuf};

/// A question of the page.
#[derive(Debug, Clone, Deserialize)]
#[serde(tag = "ask", rename_all = "snake_case")]
pub enum Question {
    /// Description of the robot: chains, links, joints, shapes; its URDF.
    Open(RobotText),
    /// The D-H table in a format.
    Table {
        /// The robot.
        source: RobotText,
        /// `distal`, `proximal`, `paper`, `hayati`; none: as the file has it.
        convention: Option<String>,
        /// `simple` or `paper`; none: as the file has it.
        gauge: Option<String>,
        /// Units of the formats for people, such as `mm,deg`.
        #[serde(default)]
        units: String,
        /// A format of the command line.
        format: String,
    },
    /// Screw axes and home pose.
    Poe(RobotText),
    /// One joint's twist moved, and the resulting D-H numbers.
    Twist(Twist),
    /// Where the tip is.
    Fk {
        /// The robot.
        source: RobotText,
        /// rad and m, by name; missing ones are 0.
        q: BTreeMap<String, f64>,
    },
    /// The tip's pose in many postures.
    Tips {
        /// The robot.
        source: RobotText,
        /// Joint values of each, rad and m, in the chain's order.
        q: Vec<Vec<f64>>,
    },
    /// Joint values that reach a pose.
    Ik(Reach),
    /// The rules.
    Check(RobotText),
    /// The text with one finding fixed, or all.
    Fix {
        /// The robot.
        source: RobotText,
        /// Which finding, counted from 0; none: all.
        only: Option<usize>,
    },
    /// The URDF whose link frames are the D-H frames.
    Canonical(RobotText),
    /// The operations that a robot can be edited by.
    Edits {},
    /// The robot's edited URDF, and its proof.
    Edit {
        /// The robot.
        source: RobotText,
        /// As `denavit edit` takes them: `zero`, `elbow_joint=90deg`.
        words: Vec<String>,
        /// The other robot, if the operation needs one.
        other: Option<RobotText>,
    },
    /// How two robots differ.
    Diff {
        /// One.
        a: RobotText,
        /// The other.
        b: RobotText,
    },
    /// The columns of a measurement file.
    Columns {
        /// The robot.
        source: RobotText,
        /// The measurements.
        data: DataText,
        /// Units such as `mm,deg`.
        #[serde(default)]
        units: String,
        /// Their stated meaning.
        map: Option<String>,
    },
    /// From measured data to a calibrated model.
    Calibrate(Calibrate),
    /// Which effects can act where on this robot.
    Effects(RobotText),
    /// What an effect does to the tip.
    Act {
        /// The robot.
        source: RobotText,
        /// As `denavit simulate --effect` takes it: `KIND@PLACE=STRENGTH`.
        effect: String,
        /// Joint values, rad and m.
        q: Vec<Vec<f64>>,
    },
}

/// What `denavit calibrate` takes.
#[derive(Debug, Clone, Deserialize)]
pub struct Calibrate {
    /// The robot.
    pub source: RobotText,
    /// Name and text of the measurements.
    pub data: DataText,
    /// Test data.
    pub test: Option<DataText>,
    /// Units such as `mm,deg`.
    #[serde(default)]
    pub units: String,
    /// Which column is what, as `denavit calibrate --columns` takes it: TOML.
    pub map: Option<String>,
    /// `none`, `curves`, `auto`.
    pub effects: String,
    /// Fraction of rows to hold out.
    pub hold_out: Option<f64>,
}

/// The target pose of the tip.
#[derive(Debug, Clone, Deserialize)]
pub struct Reach {
    /// The robot.
    pub source: RobotText,
    /// base_from_tip, 16 numbers column by column, m.
    pub pose: [f64; 16],
    /// Joint values to stay next to, rad and m, in the chain's order.
    pub near: Vec<f64>,
}

/// A joint's axis moved by hand.
#[derive(Debug, Clone, Deserialize)]
pub struct Twist {
    /// The robot.
    pub source: RobotText,
    /// Which joint of the chain, counted from 0.
    pub joint: usize,
    /// Turned about x, y, z, then moved along them, rad and m; z is the axis as drawn.
    pub by: [f64; 6],
    /// Units of the tables for people, such as `mm,deg`.
    pub units: String,
}

/// A file of data: a text, or a workbook.
#[derive(Debug, Clone, Deserialize)]
pub struct DataText {
    /// Its name.
    pub file: String,
    /// What it holds.
    #[serde(flatten)]
    pub content: Content,
}

/// What a file of data holds.
#[derive(Debug, Clone, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Content {
    /// Text.
    Text(String),
    /// An Excel workbook, in base64.
    Workbook(String),
}

impl DataText {
    /// The file's bytes.
    ///
    /// # Errors
    /// A workbook that is not base64.
    pub(crate) fn bytes(&self) -> Result<Cow<'_, [u8]>, String> {
        match &self.content {
            Content::Text(text) => Ok(Cow::Borrowed(text.as_bytes())),
            Content::Workbook(packed) => {
                STANDARD.decode(packed).map(Cow::Owned).map_err(|error| format!("{}: {error}", self.file))
            }
        }
    }
}

/// A robot's text, the files beside it, and how it is to be read.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(default)]
pub struct RobotText {
    /// Its name, for messages, and for relative names in it.
    pub file: String,
    /// Its text.
    pub text: String,
    /// Texts of files beside it that it may include.
    pub files: BTreeMap<String, String>,
    /// Names of files that are there, and not brought: meshes.
    pub names: Vec<String>,
    /// Arguments of a xacro file.
    pub arguments: BTreeMap<String, String>,
    /// Base link of the chain.
    pub base: Option<String>,
    /// Tip link of the chain.
    pub tip: Option<String>,
    /// Whether numbers are read exactly as written.
    pub exact: bool,
}

impl Question {
    /// The files in the question, and the names of others without their content.
    pub(crate) fn files(&self) -> FileOverlay {
        let robots: Vec<&RobotText> = match self {
            Self::Open(source)
            | Self::Poe(source)
            | Self::Check(source)
            | Self::Canonical(source)
            | Self::Effects(source) => vec![source],
            Self::Table { source, .. }
            | Self::Fk { source, .. }
            | Self::Tips { source, .. }
            | Self::Fix { source, .. }
            | Self::Columns { source, .. }
            | Self::Act { source, .. } => {
                vec![source]
            }
            Self::Edit { source, other, .. } => std::iter::once(source).chain(other).collect(),
            Self::Edits {} => Vec::new(),
            Self::Diff { a, b } => vec![a, b],
            Self::Calibrate(asked) => vec![&asked.source],
            Self::Ik(asked) => vec![&asked.source],
            Self::Twist(asked) => vec![&asked.source],
        };
        let mut held = FileOverlay::default();
        for robot in robots {
            for name in &robot.names {
                held.add_later(Path::new(name), || {
                    Err(io::Error::other("this page draws meshes but does not compute their mass"))
                });
            }
            for (name, text) in &robot.files {
                held.add(Path::new(name), text.clone().into_bytes());
            }
        }
        held
    }
}

impl RobotText {
    fn options(&self) -> Options {
        Options {
            arguments: self.arguments.iter().map(|(name, value)| (name.clone(), value.clone())).collect(),
            // Every dropped file is visible.
            package_path: vec![PathBuf::from("/")],
            stated: Stated::default(),
            ..Options::default()
        }
    }

    /// The robot.
    pub(crate) fn open(&self) -> Result<Opened, String> {
        denavit_load::from_text(&self.file, &self.text, &self.options())
            .map_err(|error| denavit_model::words::readable(&error.to_string()).into_owned())
    }

    /// The robot, without the notes of its reading.
    pub(crate) fn load(&self) -> Result<Loaded, String> {
        Ok(self.open()?.robot)
    }

    /// Its URDF, with xacro expanded; the name that the command line gives it.
    pub(crate) fn urdf(&self) -> Result<(String, String), String> {
        if !denavit_load::is_markup(&self.file, &self.text) {
            let (robot, scales) = without_scales(self.load()?)?;
            let urdf = denavit_load::canonical(&robot, &self.file, &self.canonical_options());
            let named = if scales.is_empty() { "as URDF" } else { "as URDF, joint scales left out" };
            return Ok((format!("{} ({named})", self.file), urdf.map_err(|error| error.to_string())?.value));
        }
        let urdf = denavit_load::urdf_text(&self.file, self.text.clone(), &self.options(), &self.canonical_options());
        let urdf = urdf.map_err(|error| error.to_string())?;
        Ok((urdf.shown, urdf.text))
    }

    pub(crate) fn canonical_options(&self) -> denavit_export::urdf::Options {
        denavit_export::urdf::Options {
            reading: self.reading(),
            parallelism: if self.exact {
                denavit_dh::Parallelism::Exact
            } else {
                denavit_dh::Parallelism::Within { angle: NEARLY_PARALLEL }
            },
            tip: self.tip.clone(),
            ..denavit_export::urdf::Options::default()
        }
    }

    pub(crate) fn reading(&self) -> Reading {
        if self.exact { Reading::AsWritten } else { Reading::Intended }
    }

    pub(crate) fn selection(&self) -> Selection<'_> {
        Selection { file: &self.file, base: self.base.as_deref(), tip: self.tip.as_deref(), reading: self.reading() }
    }
}

/// A robot whose joint values equal their coordinates, which is all that a URDF can state, and the scales of the joints of which
/// one was left out, by name; a joint that another drives keeps its own.
///
/// # Errors
/// The joints do not form a chain.
pub fn without_scales(robot: Loaded) -> Result<(Loaded, BTreeMap<String, f64>), String> {
    let Loaded::Poe(chain) = &robot else { return Ok((robot, BTreeMap::new())) };
    let drives = |joint: &ChainJoint| chain.coordinates()[joint.coordinate].name == joint.name;
    let scaled = |joint: &&ChainJoint| drives(joint) && joint.scale.abs() != 1.0;
    let scales: BTreeMap<String, f64> =
        chain.joints().iter().filter(scaled).map(|joint| (joint.name.clone(), joint.scale)).collect();
    if scales.is_empty() {
        return Ok((robot, scales));
    }
    let joints = chain.joints().iter().map(|joint| {
        let scale = if scales.contains_key(&joint.name) { 1.0 } else { joint.scale };
        ChainJoint { scale, ..joint.clone() }
    });
    let names = (chain.name(), chain.base(), chain.tip());
    let plain = Chain::new(names, chain.coordinates().to_vec(), joints.collect(), *chain.home());
    Ok((Loaded::Poe(plain.map_err(|error| error.to_string())?), scales))
}

/// How a table is to be made.
pub fn table_options(convention: Option<&str>, gauge: Option<&str>) -> Result<TableOptions, String> {
    let convention = match convention {
        None | Some("") => None,
        Some("distal") => Some(Convention::Distal),
        Some("proximal") => Some(Convention::Proximal),
        Some("paper") => Some(Convention::Paper),
        Some("hayati") => Some(Convention::Hayati),
        Some(word) => return Err(format!("\"{word}\" is no convention; take distal, proximal, paper or hayati")),
    };
    let gauge = match gauge {
        None | Some("") => None,
        Some("simple") => Some(Gauge::Simple),
        Some("paper") => Some(Gauge::Paper),
        Some(word) => return Err(format!("\"{word}\" is no gauge; take simple or paper")),
    };
    Ok(TableOptions { convention, gauge, tolerance: NEARLY_PARALLEL })
}

/// Units of documents for people.
pub fn units(written: &str) -> Result<Units, String> {
    Units::default()
        .with_words(written)
        .map_err(|unknown| format!("\"{}\" is not a known unit; write m or mm, and deg or rad", unknown.word))
}
