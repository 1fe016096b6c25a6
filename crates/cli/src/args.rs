//! The command line and its help.

mod edit;
mod fleet;
mod json;
mod measured;
pub mod numbers;
mod program;

use clap::{Args, Parser, Subcommand, ValueEnum};
use denavit_model::Reading;
use denavit_model::formats::Format;
use denavit_model::settings::{Shown, shown};
pub use edit::{EditArguments, EditOutputs, OperationArguments, Step, with_steps_joined};
pub use fleet::{
    FleetArguments, FleetCommand, FleetCorpusArguments, FleetHistoryArguments, FleetReportArguments, FleetRunArguments,
    FleetSiblingsArguments, FleetWatchArguments,
};
pub use json::{JsonArguments, with_json_files_joined};
pub use measured::{
    BagArguments, CalibrateArguments, CameraArguments, CompensateArguments, GivenArguments, IdentifyArguments,
    ImportArguments, MeasureArguments, MeasureName, PlanArguments, PlateArguments, SimulateArguments,
};
pub use program::{CompletionsArguments, LspArguments, ManArguments};
use std::path::PathBuf;

/// Denavit-Hartenberg tables, screw axes, comparison and calibration of robots from their descriptions.
#[derive(Debug, Parser)]
#[command(name = "denavit", version, propagate_version = true, max_term_width = 110, after_help = EXAMPLES)]
pub struct Arguments {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// The heading of options that choose the robot and how it is read.
const ROBOT_OPTIONS: &str = "Robot options";

const EXAMPLES: &str = "\
Examples:
  denavit table ur5e.urdf                         D-H table, degrees and metres
  denavit table ur5e.urdf --convention proximal   modified (Craig) form
  denavit table panda.urdf --format tex > dh.tex  for a document
  denavit chains pr2.urdf                         the chains of a robot
  denavit fk ur5e.urdf --q 0,-1.57,1.57,0,0,0     the pose of the tip
  denavit ik ur5e.urdf --pose 0.4,0.2,0.5,3.14,0,0 --all
  denavit table ur.urdf.xacro ur_type:=ur5e       xacro, without ROS
  denavit diff git:HEAD:arm.urdf arm.urdf         what an edit changed
  denavit diff --robots git:main                  every robot of a repository
  denavit calibrate arm.urdf --data tracker.csv   a robot from measurements

ROBOT is a URDF, MJCF, SDF or xacro file, a D-H table or screw axes, a maker's calibration file, - for standard input, \
or git:REVISION:PATH.
Exit codes: 0 done or the same, 1 different or found, 2 error.";

/// The commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Print the Denavit-Hartenberg table of a chain
    Table(TableArguments),
    /// List every chain from a base link to a leaf
    Chains(ChainsArguments),
    /// Compute the pose of the tip at given joint values (forward kinematics)
    Fk(FkArguments),
    /// Compute the joint values that reach a pose (inverse kinematics)
    Ik(IkArguments),
    /// Write the kinematics of one robot as source code: C, C++, Rust, Python, MATLAB
    Code(CodeArguments),
    /// Locate camera and marker from pairs of poses (AX = XB, AX = YB)
    HandEye(HandEyeArguments),
    /// Print the screw axes and the home pose (product of exponentials)
    Poe(PoeArguments),
    /// Compare two robots: per joint, and at the tips
    Diff(DiffArguments),
    /// Print everything that `diff` compares, line by line: for `git diff`
    Describe(DescribeArguments),
    /// Expand a xacro file to URDF, without ROS
    Expand(ExpandArguments),
    /// Write a URDF whose link frames are the D-H frames, a URDF from a D-H table, MJCF or SDF
    Export(ExportArguments),
    /// Edit a URDF: flip, re-zero, re-root, rename and more, each with its proof
    Edit(EditArguments),
    /// Make a page of each robot: figures, tables, a 3-D view
    Doc(DocArguments),
    /// Open robots in a browser: tables, comparison and calibration on a page that works offline
    Explore(ExploreArguments),
    /// Print a short hash of what the robot is, to pin in CI
    Fingerprint(FingerprintArguments),
    /// Find mistakes in robot descriptions
    Check(CheckArguments),
    /// Calibrate a robot from measured data
    Calibrate(Box<CalibrateArguments>),
    /// List the parameters of a robot that measurements can identify
    Identify(IdentifyArguments),
    /// Check each row while you measure, and propose the next pose
    Measure(Box<MeasureArguments>),
    /// Choose the poses to measure that determine the robot best
    Plan(PlanArguments),
    /// Write a plate of holes to print and touch: calibration without an instrument
    Plate(PlateArguments),
    /// Simulate measurements of a robot that differs from its drawing
    Simulate(SimulateArguments),
    /// Compute joint commands with which a calibrated robot reaches poses
    Compensate(CompensateArguments),
    /// Calibrate or check many robots, and store the results as Parquet files
    Fleet(FleetArguments),
    /// Serve an editor: errors as you type, hover, definitions, rename, completion
    Lsp(LspArguments),
    /// Print completions for a shell
    Completions(CompletionsArguments),
    /// Print the manual page, or write one for each command
    Man(ManArguments),
}

/// Where the chain ends.
#[derive(Debug, Clone, Default, Args)]
pub struct OneTip {
    /// Link that the chain ends at [default: the end of the longest actuated chain]
    #[arg(long, value_name = "LINK", help_heading = ROBOT_OPTIONS)]
    pub tip: Option<String>,
}

/// Where the chain ends, or the chains that are measured together.
#[derive(Debug, Clone, Default, Args)]
pub struct SeveralTips {
    /// Link that the chain ends at [default: the end of the longest actuated chain]; repeat it for several tips of one robot,
    /// such as both hands: a column tip then names the tip of each row
    #[arg(long = "tip", value_name = "LINK", help_heading = ROBOT_OPTIONS)]
    pub tips: Vec<String>,
}

/// Which robot, and which chain of it.
#[derive(Debug, Clone, Args)]
pub struct RobotArguments<T: Args = OneTip> {
    /// URDF, MJCF, SDF, xacro, D-H table (CSV, Markdown, JSON) or screw axes (CSV, JSON), kinematics file of a UR, xArm or Franka
    /// arm (yaml), - for standard input, or git:REVISION:PATH
    pub robot: String,
    /// Link that the chain starts at [default: the root, or below the last floating joint]
    #[arg(long, value_name = "LINK", help_heading = ROBOT_OPTIONS)]
    pub base: Option<String>,
    /// Where it ends.
    #[command(flatten)]
    pub tip: T,
    /// Take every number as written: 1.5708 is not read as π/2, near-parallel axes are not made parallel
    #[arg(long, help_heading = ROBOT_OPTIONS)]
    pub exact: bool,
    /// Angle below which neighbouring axes count as parallel, rad
    #[arg(long, value_name = "RAD", default_value_t = denavit_load::NEARLY_PARALLEL, conflicts_with = "exact",
        value_parser = numbers::tolerance, help_heading = ROBOT_OPTIONS)]
    pub tolerance: f64,
    /// What some sources need.
    #[command(flatten)]
    pub source: SourceArguments,
}

/// What some sources need; a URDF needs none of it.
#[derive(Debug, Clone, Default, Args)]
pub struct SourceArguments {
    /// Arguments of a xacro file
    #[arg(value_name = "NAME:=VALUE", value_parser = xacro_argument)]
    pub values: Vec<String>,
    /// Folder with ROS packages, or a package; may be repeated [also: AMENT_PREFIX_PATH, ROS_PACKAGE_PATH, and the
    /// packages around the file]
    #[arg(long, value_name = "FOLDER", help_heading = ROBOT_OPTIONS)]
    pub package_path: Vec<PathBuf>,
    /// Let xacro read files outside its package and the package path
    #[arg(long, help_heading = ROBOT_OPTIONS)]
    pub allow_any_file: bool,
    /// Read the angles of a UR kinematics file as Rx Ry Rz, as the vendor's tool does [default: Rz Ry Rx, as ROS does]
    #[arg(long, help_heading = ROBOT_OPTIONS)]
    pub vendor_angles: bool,
    /// Convention of a D-H table that does not state it: distal, proximal, paper or hayati [default: distal]
    #[arg(long, value_name = "CONVENTION", value_enum, hide_possible_values = true, help_heading = ROBOT_OPTIONS)]
    pub table_convention: Option<ConventionName>,
    /// Units of a D-H table that does not state them, such as mm,deg [default: found from the numbers]
    #[arg(long, value_name = "UNITS", help_heading = ROBOT_OPTIONS)]
    pub table_units: Option<String>,
}

impl<T: Args> RobotArguments<T> {
    /// How the literals of angles are read.
    pub fn reading(&self) -> Reading {
        if self.exact { Reading::AsWritten } else { Reading::Intended }
    }

    /// The files that the run reads for it, as named.
    pub fn files(&self) -> impl Iterator<Item = &str> {
        std::iter::once(self.robot.as_str()).chain(self.source.files())
    }
}

impl SourceArguments {
    /// What may be files among the values of a xacro file's arguments.
    pub fn files(&self) -> impl Iterator<Item = &str> {
        self.values.iter().filter_map(|word| word.split_once(":=").map(|(_, value)| value))
    }
}

fn xacro_argument(word: &str) -> Result<String, String> {
    if word.contains(":=") {
        return Ok(word.to_owned());
    }
    Err("only arguments of a xacro file (NAME:=VALUE) may follow the robot; give a file of measurements with --data"
        .to_owned())
}

/// Units of printed text.
#[derive(Debug, Args)]
pub struct UnitsArguments {
    /// Units of text: m or mm, deg or rad
    #[arg(long, value_name = "UNITS", default_value = "m,deg")]
    pub units: String,
}

/// Names of conventions on the command line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum ConventionName {
    /// Standard (Denavit-Hartenberg, Paul): Rz(θ) Tz(d) Rx(α) Tx(a)
    #[value(alias = "standard")]
    Distal,
    /// Modified (Craig, Khalil): Rx(α) Tx(a) Rz(θ) Tz(d)
    #[value(alias = "modified", alias = "craig")]
    Proximal,
    /// Rows H0 … Hn and the tool's pair (Wu, Crawford, Roberts)
    Paper,
    /// Distal, with Rz(θ) Tx(a) Rx(α) Ry(β) for near-parallel neighbours
    Hayati,
}

impl ConventionName {
    /// The convention of this name.
    pub fn convention(self) -> denavit_dh::Convention {
        match self {
            Self::Distal => denavit_dh::Convention::Distal,
            Self::Proximal => denavit_dh::Convention::Proximal,
            Self::Paper => denavit_dh::Convention::Paper,
            Self::Hayati => denavit_dh::Convention::Hayati,
        }
    }
}

/// Names of gauges on the command line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum GaugeName {
    /// The fewest nonzero numbers; quarter turns rather than other angles
    Simple,
    /// The paper's rule: a ≥ 0, d of parallel axes at the end of their run
    Paper,
}

/// Arguments of `denavit table`.
#[derive(Debug, Args)]
pub struct TableArguments {
    /// Which robot.
    #[command(flatten)]
    pub robot: RobotArguments,
    /// Format of the output
    #[arg(long, value_name = "FORMAT", default_value = "text", value_parser = format_names(), conflicts_with = "json")]
    pub format: String,
    /// JSON.
    #[command(flatten)]
    pub json: JsonArguments,
    /// How the numbers are grouped into rows
    #[arg(long, value_enum)]
    pub convention: Option<ConventionName>,
    /// Rule for choices that the geometry does not determine
    #[arg(long, value_enum)]
    pub gauge: Option<GaugeName>,
    /// Compare with a vendor's table (CSV, Markdown, JSON): find senses, zeros, base and tool frames, print the table in
    /// the vendor's form and list differences; exit code 1 unless exact or rounded. --convention and --table-units state
    /// how to read the table; otherwise all are tried
    #[arg(long, value_name = "TABLE", conflicts_with = "gauge")]
    pub r#match: Option<String>,
    /// Units of text.
    #[command(flatten)]
    pub units: UnitsArguments,
    /// Write to a file, as a whole or not at all [default: standard output]
    #[arg(long, short, value_name = "FILE")]
    pub output: Option<PathBuf>,
}

fn format_names() -> clap::builder::PossibleValuesParser {
    let values = denavit_export::FORMATS
        .iter()
        .map(|format| clap::builder::PossibleValue::new(format.name).help(format.purpose));
    values.collect::<Vec<_>>().into()
}

/// Arguments of `denavit chains`.
#[derive(Debug, Args)]
pub struct ChainsArguments {
    /// URDF or xacro, - for standard input, or git:REVISION:PATH
    pub robot: String,
    /// What some sources need.
    #[command(flatten)]
    pub source: SourceArguments,
    /// JSON.
    #[command(flatten)]
    pub json: JsonArguments,
}

const FK_EXAMPLES: &str = "\
Examples:
  denavit fk ur5e.urdf --q 0,-90,90,0,0,0 --degrees
  denavit fk calibrated.urdf --effects effects.json --given payload=2 --q elbow_joint=1.2";

/// Arguments of `denavit fk`.
#[derive(Debug, Args)]
#[command(after_help = FK_EXAMPLES)]
pub struct FkArguments {
    /// Which robot.
    #[command(flatten)]
    pub robot: RobotArguments,
    /// Joint values in rad and m, in order (0.1,0.2,…) or by name (elbow=0.2,…; the others are 0)
    #[arg(long, value_name = "VALUES", allow_hyphen_values = true, default_value = "")]
    pub q: String,
    /// Joint angles of --q are in degrees
    #[arg(long)]
    pub degrees: bool,
    /// File of effects, as `denavit calibrate --effects-out` wrote it
    #[arg(long, value_name = "FILE")]
    pub effects: Option<String>,
    /// What the effects follow.
    #[command(flatten)]
    pub given: GivenArguments,
    /// JSON.
    #[command(flatten)]
    pub json: JsonArguments,
    /// Units of text.
    #[command(flatten)]
    pub units: UnitsArguments,
}

const IK_EXAMPLES: &str = "\
A pose is that of the tip in the base frame: x,y,z and roll,pitch,yaw (R = Rz(yaw) Ry(pitch) Rx(roll)). A CSV may have qx,qy,qz,qw \
instead of the angles; a row of joint values means the robot's pose there. Solutions nearest to --near come first, those \
outside the limits last; each row starts from the solution of the row before. If a pose is not reached within the limits, the \
nearest pose and its distance are printed, and the exit code is 1.

Examples:
  denavit ik ur5e.urdf --pose 0.4,0.2,0.5,180,0,0 --units m,deg --all
  denavit ik calibrated.urdf --poses path.csv --near 0,-90,90,0,90,0 --units mm,deg -o joints.csv";

/// Arguments of `denavit ik`.
#[derive(Debug, Args)]
#[command(after_help = IK_EXAMPLES)]
pub struct IkArguments {
    /// Which robot.
    #[command(flatten)]
    pub robot: RobotArguments,
    /// Pose to reach: x,y,z,roll,pitch,yaw
    #[arg(
        long,
        value_name = "POSE",
        value_delimiter = ',',
        allow_hyphen_values = true,
        required_unless_present = "poses",
        conflicts_with = "poses"
    )]
    pub pose: Vec<f64>,
    /// Poses to reach, a CSV, or - for standard input
    #[arg(long, value_name = "FILE")]
    pub poses: Option<String>,
    /// Joint values to which the first solution is nearest, in order or by name, in --units
    #[arg(long, value_name = "VALUES", allow_hyphen_values = true, default_value = "")]
    pub near: String,
    /// Print every solution, not only the first
    #[arg(long)]
    pub all: bool,
    /// Units of poses and of joint values: lengths m, mm, um or in; angles rad, mrad or deg
    #[arg(long, value_name = "UNITS", default_value = "m,rad")]
    pub units: String,
    /// JSON.
    #[command(flatten)]
    pub json: JsonArguments,
    /// Write to a file, as a whole or not at all [default: standard output]
    #[arg(long, short, value_name = "FILE")]
    pub output: Option<PathBuf>,
}

const CODE_EXAMPLES: &str = "\
Writes one file without dependencies: forward kinematics and Jacobian with all numbers written out, without heap, loops or \
branches, and a self-test with stored postures. C and C++ are headers; -DNAME_SELF_TEST_MAIN makes a program of one.

Examples:
  denavit code ur5e.urdf --lang c -o ur5e.h
  denavit code calibrated.urdf --lang rust -o arm.rs
  denavit code calibrated.urdf --effects effects.json --given payload=2 --lang c -o arm.h
  denavit code panda.urdf --tip panda_hand --lang matlab -o panda.m";

/// Languages.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum LanguageName {
    /// C99, a header
    C,
    /// C++17, a header
    Cpp,
    /// A module without allocation
    Rust,
    /// A module that imports math alone
    Python,
    /// A function file
    Matlab,
}

/// Arguments of `denavit code`.
#[derive(Debug, Args)]
#[command(after_help = CODE_EXAMPLES)]
pub struct CodeArguments {
    /// Which robot.
    #[command(flatten)]
    pub robot: RobotArguments,
    /// File of effects, as `denavit calibrate --effects-out` wrote it: the code corrects for them
    #[arg(long, value_name = "FILE")]
    pub effects: Option<String>,
    /// What the effects follow.
    #[command(flatten)]
    pub given: GivenArguments,
    /// Language
    #[arg(long, value_name = "LANGUAGE")]
    pub lang: LanguageName,
    /// Single precision, in C, C++ and Rust
    #[arg(long)]
    pub single: bool,
    /// Write to a file, as a whole or not at all [default: standard output]
    #[arg(long, short, value_name = "FILE")]
    pub output: Option<PathBuf>,
}

const HAND_EYE_EXAMPLES: &str = "\
The file has a row per standstill: the robot's pose (tip in the base frame) in robot_x,robot_y,robot_z and robot_rx,robot_ry,\
robot_rz, and the measured pose of the target in the instrument's frame in x,y,z,qx,qy,qz,qw. Either orientation may be a \
quaternion qx,qy,qz,qw, a rotation vector rx,ry,rz, or roll,pitch,yaw. A row whose target was not seen has empty cells. Measure ten \
poses or more, with turns of 30° or more about two axes. No robot description is needed.

Examples:
  denavit hand-eye --data poses.csv                        camera beside the robot, marker on the hand
  denavit hand-eye --data poses.csv --on-hand --json       camera on the hand
  denavit hand-eye --data kuka.csv --units mm,deg --robot-angles ZYX
  denavit hand-eye --data poses.csv --format ros-launch --parent base_link --child camera_link -o camera.launch.xml";

/// Formats of a hand-eye calibration.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum HandEyeFormat {
    /// For a terminal
    Text,
    /// Everything, m and rad
    Json,
    /// Launch file of ROS 2 with a static transform
    RosLaunch,
    /// A transform in the form of geometry_msgs/TransformStamped
    RosYaml,
    /// A link and a fixed joint for a URDF
    Urdf,
}

/// Arguments of `denavit hand-eye`.
#[derive(Debug, Args)]
#[command(after_help = HAND_EYE_EXAMPLES)]
pub struct HandEyeArguments {
    /// Pairs of poses, a CSV, or - for standard input
    #[arg(long, value_name = "FILE")]
    pub data: String,
    /// The instrument is on the hand and the target stands still, not the reverse
    #[arg(long)]
    pub on_hand: bool,
    /// Units of the file: lengths m, mm, um or in; angles rad, mrad or deg
    #[arg(long, value_name = "UNITS", default_value = "m,rad")]
    pub units: String,
    /// Form of robot_rx,robot_ry,robot_rz: vector, or an order of turns such as xyz or ZYX
    #[arg(long, value_name = "ANGLES", default_value = "vector")]
    pub robot_angles: String,
    /// Form of rx,ry,rz, likewise
    #[arg(long, value_name = "ANGLES", default_value = "vector")]
    pub angles: String,
    /// Output format
    #[arg(long, value_name = "FORMAT", default_value = "text")]
    pub format: HandEyeFormat,
    /// Parent of the instrument's frame in ROS and URDF [default: base, or tip with --on-hand]
    #[arg(long, value_name = "NAME")]
    pub parent: Option<String>,
    /// Name of the instrument's frame in ROS and URDF
    #[arg(long, value_name = "NAME", default_value = "instrument")]
    pub child: String,
    /// JSON.
    #[command(flatten)]
    pub json: JsonArguments,
    /// Write to a file, as a whole or not at all [default: standard output]
    #[arg(long, short, value_name = "FILE")]
    pub output: Option<PathBuf>,
}

/// Formats of screw axes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum PoeFormat {
    /// Aligned, for a terminal
    Text,
    /// rad and m at full precision; denavit reads it back
    Csv,
    /// Everything, rad and m; denavit reads it back
    Json,
}

/// Arguments of `denavit poe`.
#[derive(Debug, Args)]
pub struct PoeArguments {
    /// Which robot.
    #[command(flatten)]
    pub robot: RobotArguments,
    /// Format of the output
    #[arg(long, value_enum, default_value_t = PoeFormat::Text, conflicts_with = "json")]
    pub format: PoeFormat,
    /// JSON.
    #[command(flatten)]
    pub json: JsonArguments,
    /// Write to a file, as a whole or not at all [default: standard output]
    #[arg(long, short, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Units of text.
    #[command(flatten)]
    pub units: UnitsArguments,
}

/// Arguments of `denavit expand`.
#[derive(Debug, Args)]
pub struct ExpandArguments {
    /// Xacro file, or - for standard input
    pub file: String,
    /// What it needs.
    #[command(flatten)]
    pub source: SourceArguments,
    /// Write to a file, as a whole or not at all [default: standard output]
    #[arg(long, short, value_name = "FILE")]
    pub output: Option<PathBuf>,
}

/// What `--only` restricts a comparison to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum OnlyName {
    /// Motion and position limits; no inertials, shapes, speeds, efforts, transmissions and settings
    Kinematics,
}

/// Arguments of `denavit describe`.
#[derive(Debug, Args)]
#[command(after_long_help = what_is_compared())]
pub struct DescribeArguments {
    /// Any source
    pub robot: String,
    /// What some sources need.
    #[command(flatten)]
    pub source: SourceArguments,
    /// Take every number as written: 1.5708 is not read as π/2
    #[arg(long)]
    pub exact: bool,
    /// Write to a file, as a whole or not at all [default: standard output]
    #[arg(long, short, value_name = "FILE")]
    pub output: Option<PathBuf>,
}

/// Arguments of `denavit diff`.
#[derive(Debug, Args)]
#[command(after_long_help = what_is_compared())]
#[expect(clippy::struct_excessive_bools, reason = "each is a flag of its own")]
pub struct DiffArguments {
    /// The robot before: any source. With --robots the revision to compare with: git:REVISION
    pub a: String,
    /// The robot after: any source. With --robots a second revision [default: the working tree]
    #[arg(required_unless_present = "robots")]
    pub b: Option<String>,
    /// Compare every robot of the repository: those that denavit.toml names, or else every description in it
    #[arg(long)]
    pub robots: bool,
    /// Draw each robot that differs, before and after, as an SVG in this folder, which `--format markdown` shows
    #[arg(long, value_name = "FOLDER", requires = "robots")]
    pub pictures: Option<PathBuf>,
    /// What some sources need.
    #[command(flatten)]
    pub source: SourceArguments,
    /// Lengths closer than this are equal, m [default: what denavit.toml states, else 1e-7]
    #[arg(long, value_name = "M", value_parser = numbers::tolerance)]
    pub tolerance_m: Option<f64>,
    /// Angles closer than this are equal, rad [default: what denavit.toml states, else 1e-6]
    #[arg(long, value_name = "RAD", value_parser = numbers::tolerance)]
    pub tolerance_rad: Option<f64>,
    /// Compare only this
    #[arg(long, value_enum)]
    pub only: Option<OnlyName>,
    /// Ignore the pose of the robot on its root link
    #[arg(long)]
    pub up_to_base: bool,
    /// Ignore joint zeros and senses
    #[arg(long)]
    pub up_to_zeros: bool,
    /// One robot was converted through this format: ignore what the format cannot express
    #[arg(long, value_enum, value_name = "FORMAT")]
    pub through: Option<RobotFormatName>,
    /// Count added, removed and renamed links, joints and frames as differences
    #[arg(long)]
    pub count_names: bool,
    /// Take every number as written: 1.5708 is not read as π/2
    #[arg(long)]
    pub exact: bool,
    /// Range to sample instead of the joint limits, rad or m: LOWER,UPPER for all joints or NAME=LOWER,UPPER
    #[arg(long, value_name = "RANGE", allow_hyphen_values = true)]
    pub q_range: Vec<String>,
    /// Configurations to sample
    #[arg(long, value_name = "N", default_value_t = 4096, value_parser = clap::value_parser!(u32).range(1..))]
    pub samples: u32,
    /// Start of the low-discrepancy sequence
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
    /// Format of the report
    #[arg(long, value_name = "FORMAT", default_value = "text", value_parser = report_names(), conflicts_with = "json")]
    pub format: String,
    /// JSON.
    #[command(flatten)]
    pub json: JsonArguments,
    /// Write to a file, as a whole or not at all [default: standard output]
    #[arg(long, short, value_name = "FILE")]
    pub output: Option<PathBuf>,
}

fn report_names() -> clap::builder::PossibleValuesParser {
    let values = denavit_compare::report::FORMATS;
    let values = values.iter().map(|format| clap::builder::PossibleValue::new(format.name).help(format.summary));
    values.collect::<Vec<_>>().into()
}

/// Where on a joint's axis its child link's frame lies.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum FramesName {
    /// At the foot of the common normal with the previous axis
    Distal,
    /// At the foot of the common normal with the next axis
    Proximal,
}

/// A format for whole robots.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum RobotFormatName {
    /// URDF, frames as they are
    Urdf,
    /// MuJoCo's format
    Mjcf,
    /// Gazebo's and Drake's format
    Sdf,
}

impl RobotFormatName {
    /// The format.
    pub fn format(self) -> Format {
        match self {
            Self::Urdf => Format::Urdf,
            Self::Mjcf => Format::Mjcf,
            Self::Sdf => Format::Sdf,
        }
    }
}

/// Arguments of `denavit export`.
#[expect(clippy::struct_excessive_bools, reason = "each is a flag of the command line")]
#[derive(Debug, Args)]
pub struct ExportArguments {
    /// Which robot.
    #[command(flatten)]
    pub robot: RobotArguments,
    /// Keep every old frame under its old name, as a link fixed to the new one
    #[arg(long, conflicts_with = "dh_links")]
    pub keep_link_frames: bool,
    /// Add marker links dh_0 … dh_n of the chain and move nothing
    #[arg(long)]
    pub dh_links: bool,
    /// Where on a joint's axis its child link's frame lies
    #[arg(long, value_enum, default_value_t = FramesName::Distal)]
    pub frames: FramesName,
    /// Convert to this format and leave every frame where it is; what the format cannot express is listed, and kept in
    /// FILE.denavit.json beside the output [default: by the extension of the output, .xml or .sdf, or .urdf if the source
    /// has another format]
    #[arg(long, value_enum, value_name = "FORMAT", conflicts_with_all = ["keep_link_frames", "dh_links"])]
    pub to: Option<RobotFormatName>,
    /// Print what was checked in the converted text, and how much it differs
    #[arg(long)]
    pub proof: bool,
    /// Replace an inertia that no body can have by the nearest possible one, if the format refuses it
    #[arg(long)]
    pub fix_inertia: bool,
    /// SRDF of the robot: its disabled collisions become excluded contacts of an MJCF, its states keys
    #[arg(long, value_name = "FILE")]
    pub srdf: Option<String>,
    /// File for the SRDF that is made from an MJCF's excluded contacts and keys
    #[arg(long, value_name = "FILE")]
    pub srdf_out: Option<PathBuf>,
    /// Write to a file, as a whole or not at all [default: standard output]
    #[arg(long, short, value_name = "FILE")]
    pub output: Option<PathBuf>,
}

/// Arguments of `denavit doc`.
#[derive(Debug, Args)]
pub struct DocArguments {
    /// Robots: any source, or a folder for all robots in it; several give a page each and an index. NAME:=VALUE are
    /// arguments of the xacro files among them
    #[arg(required = true, value_name = "ROBOT")]
    pub robots: Vec<String>,
    /// Folder for the pages, or - for a single page on standard output
    #[arg(long, short, value_name = "FOLDER")]
    pub output: PathBuf,
    /// Markdown and SVG files for a repository's docs folder instead of HTML
    #[arg(long)]
    pub markdown: bool,
    /// Link that the chain starts at
    #[arg(long, value_name = "LINK")]
    pub base: Option<String>,
    /// Link that the chain ends at
    #[arg(long, value_name = "LINK")]
    pub tip: Option<String>,
    /// Take every number as written
    #[arg(long)]
    pub exact: bool,
    /// Folder with ROS packages, or a package, for xacro files
    #[arg(long, value_name = "FOLDER")]
    pub package_path: Vec<PathBuf>,
    /// Let xacro read files outside its package and the package path
    #[arg(long)]
    pub allow_any_file: bool,
    /// Units of text.
    #[command(flatten)]
    pub units: UnitsArguments,
}

/// Arguments of `denavit explore`.
#[derive(Debug, Args)]
pub struct ExploreArguments {
    /// Robots: any source, or a folder for all robots in it; two are compared. NAME:=VALUE are arguments of the xacro files
    /// among them. Without a robot, drop files on the page
    #[arg(value_name = "ROBOT")]
    pub robots: Vec<String>,
    /// Write the page to a file, - for standard output, instead of serving it
    #[arg(long, short, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Port to serve at, on this machine only; 0: any free port
    #[arg(long, value_name = "PORT", default_value_t = 0, conflicts_with = "output")]
    pub port: u16,
    /// Print the address and open no browser
    #[arg(long, conflicts_with = "output")]
    pub no_browser: bool,
    /// Folder with ROS packages, or a package, for xacro files and meshes
    #[arg(long, value_name = "FOLDER")]
    pub package_path: Vec<PathBuf>,
    /// Let xacro read files outside its package and the package path
    #[arg(long)]
    pub allow_any_file: bool,
}

/// Arguments of `denavit fingerprint`.
#[derive(Debug, Args)]
#[command(after_long_help = what_is_compared())]
pub struct FingerprintArguments {
    /// Any source
    pub robot: String,
    /// What some sources need.
    #[command(flatten)]
    pub source: SourceArguments,
    /// Cell size: m, rad, and relative for masses
    #[arg(long, value_name = "SIZE", default_value_t = denavit_compare::fingerprint::DEFAULT_TOLERANCE,
        value_parser = numbers::part)]
    pub tolerance: f64,
    /// Compare with a recorded fingerprint: exit code 0 the same, 1 different
    #[arg(long, value_name = "FINGERPRINT")]
    pub expect: Option<String>,
    /// Take every number as written: 1.5708 is not read as π/2
    #[arg(long)]
    pub exact: bool,
    /// With --expect: compare motion only; masses, shapes, speeds, transmissions and settings may differ
    #[arg(long, requires = "expect")]
    pub only_motion: bool,
    /// JSON.
    #[command(flatten)]
    pub json: JsonArguments,
}

/// Arguments of `denavit check`.
#[derive(Debug, Args)]
#[expect(clippy::struct_excessive_bools, reason = "each is a flag of its own")]
pub struct CheckArguments {
    /// Any sources, or folders for all robots in them; SRDF files together with their URDF. NAME:=VALUE are arguments of
    /// the xacro files among them [default: the robots that denavit.toml names]
    #[arg(value_name = "ROBOT")]
    pub files: Vec<String>,
    /// Leave out a rule, by code or name; `all` leaves out all that are not denied
    #[arg(long, value_name = "RULE", value_delimiter = ',')]
    pub allow: Vec<String>,
    /// Make a rule's findings errors, by code or name
    #[arg(long, value_name = "RULE", value_delimiter = ',')]
    pub deny: Vec<String>,
    /// Configuration file [default: denavit.toml beside the robot or in a folder above]
    #[arg(long, value_name = "FILE")]
    pub config: Option<PathBuf>,
    /// Folder with ROS packages, or a package, to find meshes in, and for xacro files
    #[arg(long, value_name = "FOLDER")]
    pub package_path: Vec<PathBuf>,
    /// Let xacro read files outside its package and the package path
    #[arg(long)]
    pub allow_any_file: bool,
    /// Fix in place the findings whose fix is certain
    #[arg(long)]
    pub fix: bool,
    /// Known findings, written by --write-baseline: only new findings are reported, and only new errors make the exit code 1
    /// [default: the file that denavit.toml names]
    #[arg(long, value_name = "FILE")]
    pub baseline: Option<PathBuf>,
    /// Write the findings of this run into FILE, for --baseline, instead of reporting them
    #[arg(long, value_name = "FILE", conflicts_with_all = ["baseline", "fix", "format", "json", "output"])]
    pub write_baseline: Option<PathBuf>,
    /// Leave out, with a message, xacro files that are not robots by themselves, such as files of macros
    #[arg(long)]
    pub robots_only: bool,
    /// List the rules
    #[arg(long)]
    pub rules: bool,
    /// Explain a rule, by code or name
    #[arg(long, value_name = "RULE")]
    pub explain: Option<String>,
    /// Format of the report
    #[arg(long, value_name = "FORMAT", default_value = "text", value_parser = report_names(), conflicts_with = "json")]
    pub format: String,
    /// JSON.
    #[command(flatten)]
    pub json: JsonArguments,
    /// Write to a file, as a whole or not at all [default: standard output]
    #[arg(long, short, value_name = "FILE")]
    pub output: Option<PathBuf>,
}

/// What a comparison looks at, for the help of those that make one.
fn what_is_compared() -> String {
    shown(&denavit_compare::compared::listed(), Shown::CommandLine).into_owned()
}
