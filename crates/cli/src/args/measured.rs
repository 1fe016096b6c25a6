//! Arguments of the commands about measuring, calibrating and compensating.

use super::{JsonArguments, RobotArguments, SeveralTips, numbers};
use clap::{Args, ValueEnum};
use std::path::PathBuf;

/// What an instrument measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum MeasureName {
    /// Position and orientation of a target: x,y,z,qx,qy,qz,qw
    Poses,
    /// Position of one or several targets: x,y,z or x1,y1,z1,x2,…
    Positions,
    /// Distance of a target from one fixed anchor, as a draw-wire sensor measures it
    Distances,
    /// Readings with a ball on the tip that touches planes: plane
    Planes,
    /// Readings of a dial gauge on the tip that stands on plates: dial, setup
    Dial,
}

/// What effects follow, where no file says it.
#[derive(Debug, Args)]
pub struct GivenArguments {
    /// Value of a quantity that an effect follows: payload=2.5 (kg, else 0), temperature=31 (°C), time=3600 (s),
    /// elbow_joint.approach=1
    #[arg(long, value_name = "NAME=VALUE", value_delimiter = ',', allow_hyphen_values = true)]
    pub given: Vec<String>,
}

const CALIBRATE_EXAMPLES: &str = "\
The data are CSV: a column per joint, named as in the URDF (rad, m), and x,y,z of a target on the tip (m), or \
x,y,z,qx,qy,qz,qw, or x1,y1,z1,x2,… of several targets, or distance from a fixed anchor, or pixels u,v of a board's \
corners. Where the instrument stands and where the target sits is found. Row order is run order; time, temperature, payload, JOINT.approach, JOINT.velocity and \
other numeric columns are what effects may follow.

Examples:
  denavit calibrate arm.urdf --data train.csv --test test.csv
  denavit calibrate arm.urdf --data d.csv --units mm,deg --hold-out 0.3 --html report.html
  denavit calibrate arm.urdf --data d.csv --urdf as_it_is.urdf --effects-out effects.json
  denavit calibrate two.urdf --tip left --tip right --data d.csv both hands of a robot in one fit
  denavit calibrate arm.urdf --data corners.csv --camera webcam.yaml --board 7x5:30mm
  denavit calibrate arm.urdf --data d.csv --zeros --urdf zeroed.urdf --offsets-out lerobot offsets.json
  denavit calibrate ur5e.urdf --data d.csv --out-for ur kinematics.yaml  for ur_description; see docs/makers.md
  denavit calibrate arm.urdf --data ten_poses.csv --prior earlier.json   ten poses bring a calibrated robot up to date
  some-tool | denavit calibrate arm.urdf --data - --effects none         geometry alone

See docs/calibration.md and docs/effects.md.";

/// Arguments of `denavit calibrate`.
#[derive(Debug, Args)]
#[command(after_help = CALIBRATE_EXAMPLES)]
pub struct CalibrateArguments {
    /// Which robot.
    #[command(flatten)]
    pub robot: RobotArguments<SeveralTips>,
    /// Measurements to fit, or - for standard input; a ROS 2 bag (.mcap, .db3, or its folder), too; several files are several setups: each has its own instrument frame
    /// and targets
    #[arg(long, value_name = "FILE", required_unless_present = "socket")]
    pub data: Vec<String>,
    /// Joint readings taken with a ball on the tip in the socket of this label: a bare CSV without header, a column per
    /// joint, such as front/0=front_0.csv
    #[arg(long, value_name = "LABEL=FILE")]
    pub socket: Vec<String>,
    /// A known distance between two sockets: front/0,front/1=50mm, or '*/0,*/1=50mm' for every placement; how sure it is may
    /// follow as +-0.1mm (else 0.05 mm)
    #[arg(long, value_name = "PAIR=LENGTH")]
    pub distance: Vec<String>,
    /// Test data, never fitted; sockets in it are new places
    #[arg(long, value_name = "FILE", conflicts_with = "hold_out")]
    pub test: Option<String>,
    /// Setups, or placements of sockets, to hold out as test data
    #[arg(long, value_name = "NAMES", value_delimiter = ',', conflicts_with_all = ["hold_out", "test"])]
    pub hold_out_setups: Vec<String>,
    /// Without --test: share of the rows to hold out as test data
    #[arg(long, value_name = "SHARE", value_parser = numbers::part)]
    pub hold_out: Option<f64>,
    /// Seed of the choice of rows held out
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub seed: u64,
    /// Units of the data: lengths m, mm, um or in; angles rad, mrad or deg
    #[arg(long, value_name = "UNITS", default_value = "m,rad")]
    pub units: String,
    /// What the columns of an instrument's export are.
    #[command(flatten)]
    pub import: ImportArguments,
    /// The camera.
    #[command(flatten)]
    pub camera: CameraArguments,
    /// What to take out of a bag.
    #[command(flatten)]
    pub bag: BagArguments,
    /// Print every note; without it one of each kind, and ten lines at most
    #[arg(long)]
    pub verbose: bool,
    /// Print a map of the data's columns to start from, and do nothing else
    #[arg(long, requires = "data")]
    pub columns_draft: bool,
    /// What is fitted beside the axes.
    #[command(flatten)]
    pub freedom: FreedomArguments,
    /// Fit the zeros of joints and no axis: names, or all where none is given
    #[arg(long, value_name = "JOINTS", num_args = 0..=1, default_missing_value = "all", value_delimiter = ',',
        conflicts_with_all = ["effects", "pitches"])]
    pub zeros: Vec<String>,
    /// With --zeros: write the offsets as csv, ros2-control, lerobot, dynamixel, xacro, robot-calibration or urdf; see
    /// docs/without-an-instrument.md
    #[arg(long, value_names = ["FORM", "FILE"], num_args = 2, requires = "zeros")]
    pub offsets_out: Vec<String>,
    /// Continue from an earlier calibration of this robot, as --json wrote it: what it knows of the axes, instead of the
    /// drawing's tolerances, and (but with --effects none) its effects and error curves; a few new poses then bring a robot
    /// up to date
    #[arg(long, value_name = "FILE")]
    pub prior: Option<String>,
    /// Effects to look for beside the geometry: none, curves (error curves of the joints alone), auto, or kinds such as
    /// backlash,joint_compliance
    #[arg(long, value_name = "KINDS", default_value = "auto", value_delimiter = ',')]
    pub effects: Vec<String>,
    /// No more effects than this
    #[arg(long, value_name = "N", default_value_t = 8)]
    pub max_effects: usize,
    /// Motor turns per joint turn: NAME=RATIO
    #[arg(long, value_name = "RATIO", value_delimiter = ',')]
    pub gear_ratio: Vec<String>,
    /// JSON.
    #[command(flatten)]
    pub json: JsonArguments,
    /// Write the result as a page with plots
    #[arg(long, value_name = "FILE")]
    pub html: Option<PathBuf>,
    /// Write the calibrated URDF
    #[arg(long, value_name = "FILE")]
    pub urdf: Option<PathBuf>,
    /// Write the calibrated D-H table; the extension chooses the format (csv, json, md, tex, txt; yaml: the kinematics
    /// file of a UR arm; -: text)
    #[arg(long, value_name = "FILE")]
    pub dh: Option<PathBuf>,
    /// Write nominal, actual and delta of every D-H number with its standard deviation: a .csv, or a table in .md (-: on standard
    /// output); the branch is the nominal table's
    #[arg(long, value_name = "FILE")]
    pub deltas: Option<PathBuf>,
    /// --deltas: the maker's table of the arm as drawn, whose convention, zeros and frames count [default: the drawing's own]
    #[arg(long, value_name = "FILE", requires = "deltas")]
    pub nominal: Option<String>,
    /// Write what a maker's controller or ROS package takes: ur, ur-conf, xarm, franka, pal, robot-calibration; see
    /// docs/makers.md
    #[arg(long, value_names = ["MAKER", "FILE"], num_args = 2)]
    pub out_for: Vec<String>,
    /// Write the residuals of every row as CSV: fitted, rejected and held-out rows
    #[arg(long, value_name = "FILE")]
    pub residuals: Option<PathBuf>,
    /// Write the effects as JSON, for fk, compensate and simulate
    #[arg(long, value_name = "FILE")]
    pub effects_out: Option<PathBuf>,
}

/// What the columns of an instrument's export are, where their names do not say so; see docs/measurements.md.
#[derive(Debug, Args)]
pub struct ImportArguments {
    /// Which column of the data is what: a TOML file, or x=X1,y=Y1,z=Z1 for a few
    #[arg(long, value_name = "MAP")]
    pub columns: Option<String>,
    /// Columns of angles (roll,pitch,yaw; rx,ry,rz; A,B,C; W,P,R) are turns in this order: XYZ about the axes as they turn
    /// along (intrinsic), xyz about fixed axes (extrinsic)
    #[arg(long, value_name = "ORDER", conflicts_with_all = ["quaternion", "rotation_vector"])]
    pub euler: Option<String>,
    /// Columns q1,q2,q3,q4 (or q0,q1,q2,q3) are a quaternion in this order, such as wxyz
    #[arg(long, value_name = "ORDER", conflicts_with = "rotation_vector")]
    pub quaternion: Option<String>,
    /// Columns rx,ry,rz are a rotation vector: axis times angle
    #[arg(long)]
    pub rotation_vector: bool,
    /// Joint values of the data's rows, from a robot program: ABB RAPID jointtarget, KUKA KRL AXIS, UR script movej
    #[arg(long, value_name = "PROGRAM")]
    pub joints: Option<String>,
    /// A column hole names what each row touches on a plate of denavit plate: holes of a row, rows, and their distance
    #[arg(long, value_name = "4x3:40mm")]
    pub plate: Option<String>,
}

/// The camera whose pixels are in the data; see docs/camera.md.
#[derive(Debug, Args)]
pub struct CameraArguments {
    /// Intrinsics of the camera whose pixels are in the data: YAML as ROS (camera_info) or OpenCV write it
    #[arg(long, value_name = "FILE")]
    pub camera: Option<String>,
    /// The camera sits on the hand and sees a board that stands still, not the other way round
    #[arg(long, requires = "camera")]
    pub on_hand: bool,
    /// The board that the camera sees: squares across and down, and the edge of a square
    #[arg(long, value_name = "7x5:30mm", requires = "camera")]
    pub board: Option<String>,
}

/// What to take out of a ROS 2 bag; see docs/bags.md.
#[derive(Debug, Args)]
pub struct BagArguments {
    /// Topic of a bag's joint readings, where several name the robot's joints
    #[arg(long, value_name = "TOPIC", requires = "data")]
    pub joint_topic: Option<String>,
    /// Topic of a bag's target, where several may be meant; /tf:PARENT/CHILD is a transform among others
    #[arg(long, value_name = "TOPIC", requires = "data")]
    pub target_topic: Option<String>,
}

impl ImportArguments {
    /// The files that the run reads for it, as named.
    pub fn files(&self) -> impl Iterator<Item = &str> {
        self.columns.as_deref().into_iter().chain(self.joints.as_deref())
    }
}

/// What is fitted beside the axes.
#[derive(Debug, Args)]
pub struct FreedomArguments {
    /// Joints whose scale is fitted, too (the paper's normalisation factor): names, or all
    #[arg(long, value_name = "JOINTS", value_delimiter = ',')]
    pub scales: Vec<String>,
    /// Revolute joints whose pitch is fitted, too (the paper's h): names, or all
    #[arg(long, value_name = "JOINTS", value_delimiter = ',')]
    pub pitches: Vec<String>,
}

const IDENTIFY_EXAMPLES: &str = "\
Prints the count 5h + 4r + 2t + n + 6 of Wu, Crawford and Roberts (h screws, r revolute joints, t slides, n scales) \
for poses, positions and distances, and beside it the rank of the identification Jacobian; names what is not identifiable and \
why; then the same for the D-H form.

Examples:
  denavit identify arm.urdf                     what any measurement could tell
  denavit identify arm.urdf --data poses.csv    what measuring at these joint values can tell
  denavit identify arm.urdf --scales all --json";

/// Arguments of `denavit identify`.
#[derive(Debug, Args)]
#[command(after_help = IDENTIFY_EXAMPLES)]
pub struct IdentifyArguments {
    /// Which robot.
    #[command(flatten)]
    pub robot: RobotArguments,
    /// Joint values to measure at: a measurement file or a plan, or - for standard input [default: spread over the joint
    /// range]
    #[arg(long, value_name = "FILE", conflicts_with = "rows")]
    pub data: Option<String>,
    /// Units of the data: lengths m, mm, um or in; angles rad, mrad or deg
    #[arg(long, value_name = "UNITS", default_value = "m,rad")]
    pub units: String,
    /// What the columns of an instrument's export are.
    #[command(flatten)]
    pub import: ImportArguments,
    /// Targets on the tip that a position measurement sees
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..))]
    pub targets: u16,
    /// Configurations spread over the joint range
    #[arg(long, value_name = "N", default_value_t = 100, value_parser = clap::value_parser!(u16).range(1..))]
    pub rows: u16,
    /// What is fitted beside the axes.
    #[command(flatten)]
    pub freedom: FreedomArguments,
    /// JSON.
    #[command(flatten)]
    pub json: JsonArguments,
}

const MEASURE_EXAMPLES: &str = "\
After each row: how far it is from what the rows before it predict, and how far was to be expected; what would explain a row \
that is out of line (another reflector, a moved base, a joint that stands elsewhere than it reads); which parameters are known \
worst; which pose would help most next. On a terminal what is known stays at the foot; elsewhere each row is a line. Nothing \
is known of obstacles: look at a pose before the robot takes it.

With --watch the file may grow, be replaced, or not be there yet; Ctrl-C ends the run. Exit codes: 0 every row fits, 1 rows \
are out of line, 2 error.

Examples:
  denavit measure arm.urdf --data run.csv --watch
  denavit measure arm.urdf --data run.csv --watch --units mm,deg --candidates safe_poses.csv
  denavit measure arm.urdf --data run.csv --watch --prior march.json   a robot that was calibrated before
  some-tool | denavit measure arm.urdf --data - --json        a line of JSON per row
  denavit measure arm.urdf --data run.csv                     a file that is whole";

/// Arguments of `denavit measure`.
#[derive(Debug, Args)]
#[command(after_help = MEASURE_EXAMPLES)]
pub struct MeasureArguments {
    /// Which robot.
    #[command(flatten)]
    pub robot: RobotArguments,
    /// Measurements, or - for standard input, which is read as it comes
    #[arg(long = "data", value_name = "FILE")]
    pub file: String,
    /// Continue when the file has been read: take what is appended to it, until Ctrl-C
    #[arg(long)]
    pub watch: bool,
    /// Touch the holes of --plate one after another: at each Enter the last joint values of this file (CSV, or a topic's dump
    /// that grows) are appended to --data
    #[arg(long, value_name = "FILE", requires = "plate", conflicts_with_all = ["watch", "json"])]
    pub touch: Option<String>,
    /// Units of the data, of the candidates and of the pose to measure next: lengths m, mm, um or in; angles rad, mrad or deg
    #[arg(long, value_name = "UNITS", default_value = "m,rad")]
    pub units: String,
    /// What the columns of an instrument's export are.
    #[command(flatten)]
    pub import: ImportArguments,
    /// The camera.
    #[command(flatten)]
    pub camera: CameraArguments,
    /// What is fitted beside the axes.
    #[command(flatten)]
    pub freedom: FreedomArguments,
    /// What an earlier calibration knows of the axes, as denavit calibrate --json wrote it: rows are judged from the first few on
    #[arg(long, value_name = "FILE")]
    pub prior: Option<String>,
    /// CSV of joint values from which the next pose is chosen [default: spread over the joint limits]
    #[arg(long, value_name = "FILE")]
    pub candidates: Option<String>,
    /// How many to spread over the joint limits
    #[arg(long, value_name = "N", default_value_t = 500, conflicts_with = "candidates",
        value_parser = clap::value_parser!(u16).range(1..))]
    pub spread: u16,
    /// Box in which the target must stay, base frame, m
    #[arg(long, value_name = "X0,X1,Y0,Y1,Z0,Z1", value_delimiter = ',', allow_hyphen_values = true)]
    pub r#box: Vec<f64>,
    /// JSON.
    #[command(flatten)]
    pub json: JsonArguments,
}

const PLATE_EXAMPLES: &str = "\
Each hole is a cone of 90 degrees, in which a ball or a pen's point on the tip comes to rest. Print the solid, or the drawing at \
100 % on paper for a pen, fix it in reach, touch the holes in as many postures as you can, and move it two or three times:

  denavit plate 4x3:40mm --ball 10mm -o plate.stl -o plate.svg
  denavit measure so100.urdf --plate 4x3:40mm --data run.csv --touch joint_states.yaml
  denavit calibrate so100.urdf --plate 4x3:40mm --data run.csv --zeros --urdf zeroed.urdf

See docs/without-an-instrument.md.";

/// Arguments of `denavit plate`.
#[derive(Debug, Args)]
#[command(after_help = PLATE_EXAMPLES)]
pub struct PlateArguments {
    /// Holes of a row, rows, and from one hole to the next: 4x3:40mm
    #[arg(value_name = "HOLES")]
    pub plate: String,
    /// Diameter of the ball on the tip, or of a pen where its cone begins
    #[arg(long, value_name = "LENGTH", default_value = "10mm")]
    pub ball: String,
    /// Write to a file that ends in .stl (a solid, mm) or .svg (a drawing at its true size); several times for both
    #[arg(long, short, value_name = "FILE", required = true)]
    pub output: Vec<PathBuf>,
}

const PLAN_EXAMPLES: &str = "\
Chooses, among candidates within the joint limits, the poses that make the determinant of the information largest \
(D-optimal), and prints the observability indices O1 to O5 beside those of random poses. Nothing is known of obstacles: \
look at the poses before the robot takes them.

Examples:
  denavit plan arm.urdf --count 40 -o poses.csv
  denavit plan arm.urdf --count 40 --measure distances --box 0.2,1,-0.5,0.5,0,1
  denavit plan arm.urdf --count 25 --candidates safe_poses.csv --json
  denavit plan arm.urdf --tell-apart run.csv -o poses.csv       poses that distinguish its possible causes

With --tell-apart the run is calibrated as denavit calibrate does it. Where it leaves several causes possible, poses are chosen \
that tell them apart, and the odds that are to be expected are printed; where nothing is open, poses that make the prediction \
surest. Measure the poses in the order in which they are written, and append them to the run. See docs/effects.md.";

/// Arguments of `denavit plan`.
#[derive(Debug, Args)]
#[command(after_help = PLAN_EXAMPLES)]
pub struct PlanArguments {
    /// Which robot.
    #[command(flatten)]
    pub robot: RobotArguments,
    /// Poses to choose [default with --tell-apart: 20]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..), required_unless_present = "tell_apart")]
    pub count: Option<u16>,
    /// The rows of a run, or - for standard input: poses that distinguish its possible causes, measured as its last row
    /// was; several files are several setups
    #[arg(long, value_name = "FILE", conflicts_with_all = ["measure", "target", "anchor"])]
    pub tell_apart: Vec<String>,
    /// What the columns of the run are.
    #[command(flatten)]
    pub import: ImportArguments,
    /// What will be measured
    #[arg(long, value_enum, default_value_t = MeasureName::Positions)]
    pub measure: MeasureName,
    /// CSV of joint values to choose from [default: spread over the joint limits]
    #[arg(long, value_name = "FILE")]
    pub candidates: Option<String>,
    /// How many to spread over the joint limits
    #[arg(long, value_name = "N", default_value_t = 1000, conflicts_with = "candidates",
        value_parser = clap::value_parser!(u16).range(1..))]
    pub spread: u16,
    /// Units of the run, of the candidates and of the chosen poses: lengths m, mm, um or in; angles rad, mrad or deg
    #[arg(long, value_name = "UNITS", default_value = "m,rad")]
    pub units: String,
    /// What an earlier calibration knows of the axes, as denavit calibrate --json wrote it: poses that add to that
    #[arg(long, value_name = "FILE")]
    pub prior: Option<String>,
    /// Box in which the target must stay, base frame, m
    #[arg(long, value_name = "X0,X1,Y0,Y1,Z0,Z1", value_delimiter = ',', allow_hyphen_values = true)]
    pub r#box: Vec<f64>,
    /// Where the target sits on the tip, m
    #[arg(long, value_name = "X,Y,Z", value_delimiter = ',', allow_hyphen_values = true, default_value = "0.1,0,0.1")]
    pub target: Vec<f64>,
    /// Where the anchor of a distance instrument stands, base frame, m [default: the arm's size away]
    #[arg(long, value_name = "X,Y,Z", value_delimiter = ',', allow_hyphen_values = true)]
    pub anchor: Vec<f64>,
    /// Seed of the spread candidates and of the random poses that the plan is compared with
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub seed: u64,
    /// JSON.
    #[command(flatten)]
    pub json: JsonArguments,
    /// Write to a file, as a whole or not at all [default: standard output]
    #[arg(long, short, value_name = "FILE")]
    pub output: Option<PathBuf>,
}

const SIMULATE_EXAMPLES: &str = "\
An effect is KIND@PLACE=STRENGTH: one of the kinds of docs/effects.md; a joint's name or base, links, target, \
anchor, instrument, \"wire zero\", \"all joints\"; what it moves the measured values by (0.3mm, root mean square) or its \
coefficient in SI units. Parameters of a kind are set as KIND@PLACE:order=3=0.1mm (order; at and width; knee; friction; step; with; over).

Examples:
  denavit simulate arm.urdf -o data.csv --rows 120 --seed 7
  denavit simulate arm.urdf -o train.csv --test test.csv --effect backlash@elbow_joint=0.1mm
  denavit simulate arm.urdf -o d.csv --columns temperature --effect thermal@base=0.2mm
  denavit simulate arm.urdf -o d.csv --poses plan.csv --effects effects.json --truth truth.json";

/// Arguments of `denavit simulate`.
#[derive(Debug, Args)]
#[command(after_help = SIMULATE_EXAMPLES)]
pub struct SimulateArguments {
    /// Which robot.
    #[command(flatten)]
    pub robot: RobotArguments<SeveralTips>,
    /// Write the measurements, as a whole or not at all [default: standard output]
    #[arg(long, short, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Rows to measure, at random joint values within the limits
    #[arg(long, value_name = "N", default_value_t = 100, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub rows: u32,
    /// CSV of joint values to measure at, such as a plan, instead of random ones
    #[arg(long, value_name = "FILE", conflicts_with = "rows")]
    pub poses: Option<String>,
    /// Units of --poses: lengths m, mm, um or in; angles rad, mrad or deg
    #[arg(long, value_name = "UNITS", default_value = "m,rad", requires = "poses")]
    pub units: String,
    /// Same seed, same files
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub seed: u64,
    /// What is measured
    #[arg(long, value_enum, default_value_t = MeasureName::Positions)]
    pub measure: MeasureName,
    /// Targets on the tip that a position measurement sees
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..))]
    pub targets: u16,
    /// How far each axis is from its drawing, standard deviations: mm and mrad
    #[arg(long, value_name = "MM,MRAD", value_delimiter = ',', allow_hyphen_values = true, default_value = "1,1")]
    pub geometry_error: Vec<f64>,
    /// Noise of each measured component, standard deviations: mm, and mrad for poses
    #[arg(
        long,
        value_name = "MM,MRAD",
        value_delimiter = ',',
        allow_hyphen_values = true,
        default_value = "0.05,0.05"
    )]
    pub noise: Vec<f64>,
    /// Noise along the instrument's line of sight beside that, standard deviation, mm
    #[arg(long, value_name = "MM", default_value_t = 0.0, value_parser = numbers::tolerance)]
    pub range_noise: f64,
    /// Noise of the direction in which the instrument sees the target beside that, standard deviation, mrad
    #[arg(long, value_name = "MRAD", default_value_t = 0.0, value_parser = numbers::tolerance)]
    pub angle_noise: f64,
    /// How well a joint comes back to its reading, standard deviation: mrad, and mm for slides; without a joint all of them
    #[arg(long, value_name = "[JOINT=]SIZE")]
    pub repeatability: Vec<String>,
    /// A camera measures, at random joint values in which it sees its board.
    #[command(flatten)]
    pub camera: CameraArguments,
    /// Noise of each component of a pixel, standard deviation, px
    #[arg(long, value_name = "PX", default_value_t = 0.2, requires = "camera", value_parser = numbers::tolerance)]
    pub pixel_noise: f64,
    /// Share of rows with a gross error of 5 to 50 mm
    #[arg(long, value_name = "SHARE", default_value_t = 0.0, value_parser = numbers::share)]
    pub outliers: f64,
    /// Effect on the robot or its instrument: KIND@PLACE=STRENGTH; may be given several times
    #[arg(long, value_name = "EFFECT", allow_hyphen_values = true)]
    pub effect: Vec<String>,
    /// Effects that `denavit calibrate --effects-out` wrote
    #[arg(long, value_name = "FILE")]
    pub effects: Option<String>,
    /// What is recorded beside the measurements: time, temperature, payload, tilt_x, tilt_y, approach, velocity, or JOINT.temperature …
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    pub columns: Vec<String>,
    /// Write rows for a test, too: the same robot, measured after the others
    #[arg(long, value_name = "FILE")]
    pub test: Option<PathBuf>,
    /// Rows of the test
    #[arg(long, value_name = "N", default_value_t = 40, requires = "test",
        value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub test_rows: u32,
    /// Write what the files were made of, as JSON
    #[arg(long, value_name = "FILE")]
    pub truth: Option<PathBuf>,
}

const COMPENSATE_EXAMPLES: &str = "\
ROBOT is the robot as it is: the calibrated URDF. Poses are CSV: the tip in the base frame as x,y,z (m) and \
qx,qy,qz,qw or roll,pitch,yaw, or other angles as --euler and --rotation-vector say; or joint values, which stand for the pose that the nominal robot has there; with both, the \
joint values are where the search starts. Other columns (payload, temperature, …) are what effects may follow; sides of \
approach are those of the row order unless given. The commands keep their poses' order. Rows that are out of reach or \
outside of the limits are named, and the exit code is then 1. Fewer than six joints cannot correct every direction: place \
goes first, and --allowed-miss says what direction may be off.

Examples:
  denavit compensate as_it_is.urdf --from arm.urdf --poses poses.csv -o commands.csv
  denavit compensate as_it_is.urdf --effects effects.json --poses poses.csv --json
  denavit compensate as_it_is.urdf --poses ur.csv --rotation-vector   # x,y,z,rx,ry,rz of a UR";

/// Arguments of `denavit compensate`.
#[derive(Debug, Args)]
#[command(after_help = COMPENSATE_EXAMPLES)]
pub struct CompensateArguments {
    /// Which robot.
    #[command(flatten)]
    pub robot: RobotArguments,
    /// Poses to reach, or - for standard input
    #[arg(long, value_name = "FILE")]
    pub poses: String,
    /// Units of the poses and of the commands: lengths m, mm, um or in; angles rad, mrad or deg
    #[arg(long, value_name = "UNITS", default_value = "m,rad")]
    pub units: String,
    /// What the columns of the poses are.
    #[command(flatten)]
    pub import: ImportArguments,
    /// The robot as drawn, that the controller believes in [default: the one kept in the file of effects, else ROBOT]
    #[arg(long, value_name = "ROBOT")]
    pub from: Option<String>,
    /// Effects that act on the robot: what `denavit calibrate --effects-out` wrote
    #[arg(long, value_name = "FILE")]
    pub effects: Option<String>,
    /// What the effects follow.
    #[command(flatten)]
    pub given: GivenArguments,
    /// How far a command may miss its pose and still count as reaching it: mm and mrad
    #[arg(
        long,
        value_name = "MM,MRAD",
        value_delimiter = ',',
        allow_hyphen_values = true,
        default_value = "0.001,0.001"
    )]
    pub allowed_miss: Vec<f64>,
    /// JSON.
    #[command(flatten)]
    pub json: JsonArguments,
    /// Write to a file, as a whole or not at all [default: standard output]
    #[arg(long, short, value_name = "FILE")]
    pub output: Option<PathBuf>,
}
