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
    /// Direction of gravity as an accelerometer at rest reads it: gravity_x,gravity_y,gravity_z
    Gravity,
    /// Angles of an inclinometer's two axes above the horizontal: inclination_x,inclination_y
    Inclination,
    /// Readings in which two tips touch each other with their pins: contact
    Contacts,
    /// Readings in which two tips hold one tool: grip
    Grips,
}

/// What effects follow, where no file says it.
#[derive(Debug, Args)]
pub struct GivenArguments {
    /// Value of a quantity that an effect follows: payload=2.5 (kg, else 0), temperature=31 (°C), time=3600 (s),
    /// elbow_joint.approach=1
    #[arg(long, value_name = "NAME=VALUE", value_delimiter = ',', allow_hyphen_values = true)]
    pub given: Vec<String>,
}

/// Headings of options.
const DATA: &str = "Measurements";
const FIT: &str = "Fit";
const WRITTEN: &str = "Files to write";
const COLUMNS: &str = "Columns of the data";
const CAMERA: &str = "Camera";
const BAG: &str = "ROS 2 bags";

const CALIBRATE_EXAMPLES: &str = "\
The data are CSV: a column per joint, named as in the URDF (rad, m), and x,y,z of a target on the tip (m), or \
x,y,z,qx,qy,qz,qw, or x1,y1,z1,x2,… of several targets, or distance from a fixed anchor, or pixels u,v of a board's \
corners. The positions of instrument and target are found. Keep the rows in the order of the run. Effects may follow time, \
temperature, payload, JOINT.approach, JOINT.velocity and other numeric columns.

Examples:
  denavit calibrate arm.urdf --data train.csv --test test.csv
  denavit calibrate arm.urdf --data d.csv --units mm,deg --hold-out 0.3
  denavit calibrate arm.urdf --data d.csv --urdf new.urdf --effects-out e.json
  denavit calibrate two.urdf --tip left --tip right --data d.csv
  denavit calibrate arm.urdf --data d.csv --camera c.yaml --board 7x5:30mm
  denavit calibrate arm.urdf --data d.csv --zeros --urdf zeroed.urdf
  denavit calibrate ur5e.urdf --data d.csv --out-for ur kinematics.yaml
  denavit calibrate arm.urdf --data ten_poses.csv --prior earlier.json
  some-tool | denavit calibrate arm.urdf --data - --effects none

See docs/calibration.md and docs/effects.md.";

/// Arguments of `denavit calibrate`.
#[derive(Debug, Args)]
#[command(after_help = CALIBRATE_EXAMPLES)]
pub struct CalibrateArguments {
    /// Measurements to fit, or - for standard input, or a ROS 2 bag (.mcap, .db3, folder); several files are several setups,
    /// each with its own instrument frame and targets
    #[arg(long, value_name = "FILE", required_unless_present = "socket", help_heading = DATA)]
    pub data: Vec<String>,
    /// Units of the data: lengths m, mm, um or in; angles rad, mrad or deg
    #[arg(long, value_name = "UNITS", default_value = "m,rad", help_heading = DATA)]
    pub units: String,
    /// Share of the rows to hold out as test data
    #[arg(long, value_name = "SHARE", value_parser = numbers::part, help_heading = DATA)]
    pub hold_out: Option<f64>,
    /// Test data, never fitted; each socket in it counts as a new position
    #[arg(long, value_name = "FILE", conflicts_with = "hold_out", help_heading = DATA)]
    pub test: Option<String>,
    /// Setups, or placements of sockets, to hold out as test data
    #[arg(long, value_name = "NAMES", value_delimiter = ',', conflicts_with_all = ["hold_out", "test"],
        help_heading = DATA)]
    pub hold_out_setups: Vec<String>,
    /// Seed for the choice of held-out rows
    #[arg(long, value_name = "N", default_value_t = 0, help_heading = DATA)]
    pub seed: u64,
    /// Joint readings with a ball on the tip in the socket of this label: a CSV without header, a column per joint, such as
    /// front/0=front_0.csv
    #[arg(long, value_name = "LABEL=FILE", help_heading = DATA)]
    pub socket: Vec<String>,
    /// Known distance between two sockets: front/0,front/1=50mm, or '*/0,*/1=50mm' for every placement; its standard
    /// deviation may follow as +-0.1mm (else 0.05 mm)
    #[arg(long, value_name = "PAIR=LENGTH", help_heading = DATA)]
    pub distance: Vec<String>,
    /// Print a draft of a map for --columns, and do nothing else
    #[arg(long, requires = "data", help_heading = DATA)]
    pub columns_draft: bool,
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
    /// What is fitted beside the axes.
    #[command(flatten)]
    pub freedom: FreedomArguments,
    /// Fit only the zeros of joints, no axes: names of joints, or all if none is given
    #[arg(long, value_name = "JOINTS", num_args = 0..=1, default_missing_value = "all", value_delimiter = ',',
        conflicts_with_all = ["effects", "pitches"], help_heading = FIT)]
    pub zeros: Vec<String>,
    /// Earlier calibration of this robot, as --json wrote it, to update with a few new poses: its axes, and its effects and
    /// error curves unless --effects none
    #[arg(long, value_name = "FILE", help_heading = FIT)]
    pub prior: Option<String>,
    /// Effects to search beside the geometry: none, curves (error curves of the joints alone), auto, or kinds such as
    /// backlash,joint_compliance
    #[arg(long, value_name = "KINDS", default_value = "auto", value_delimiter = ',', help_heading = FIT)]
    pub effects: Vec<String>,
    /// Largest number of effects [default: as many as the evidence selects]
    #[arg(long, value_name = "N", help_heading = FIT)]
    pub max_effects: Option<usize>,
    /// Mass of all moving links (data sheet), for a description without masses
    #[arg(long, value_name = "KG", help_heading = FIT)]
    pub mass: Option<f64>,
    /// Motor turns per joint turn: NAME=RATIO
    #[arg(long, value_name = "RATIO", value_delimiter = ',', help_heading = FIT)]
    pub gear_ratio: Vec<String>,
    /// JSON.
    #[command(flatten)]
    pub json: JsonArguments,
    /// Write the report as a page with plots
    #[arg(long, value_name = "FILE", help_heading = WRITTEN)]
    pub html: Option<PathBuf>,
    /// Write the calibrated URDF
    #[arg(long, value_name = "FILE", help_heading = WRITTEN)]
    pub urdf: Option<PathBuf>,
    /// Write the calibrated D-H table; the extension chooses the format (csv, json, md, tex, txt; yaml: the kinematics
    /// file of a UR arm; -: text)
    #[arg(long, value_name = "FILE", help_heading = WRITTEN)]
    pub dh: Option<PathBuf>,
    /// Write effects and error curves as JSON, for fk, compensate and simulate
    #[arg(long, value_name = "FILE", help_heading = WRITTEN)]
    pub effects_out: Option<PathBuf>,
    /// Write the residuals of every row as CSV: fitted, rejected and held-out rows
    #[arg(long, value_name = "FILE", help_heading = WRITTEN)]
    pub residuals: Option<PathBuf>,
    /// Write the file of a maker's controller or ROS package: ur, ur-conf, xarm, franka, pal, robot-calibration; see
    /// docs/makers.md
    #[arg(long, value_names = ["MAKER", "FILE"], num_args = 2, help_heading = WRITTEN)]
    pub out_for: Vec<String>,
    /// Write nominal, actual and delta of every D-H number with its standard deviation, as .csv or .md (-: on standard
    /// output)
    #[arg(long, value_name = "FILE", help_heading = WRITTEN)]
    pub deltas: Option<PathBuf>,
    /// With --deltas: the maker's table of the drawn arm; the deltas have its convention, zeros and frames [default: the
    /// drawing's own]
    #[arg(long, value_name = "FILE", requires = "deltas", help_heading = WRITTEN)]
    pub nominal: Option<String>,
    /// With --zeros: write the offsets as csv, ros2-control, lerobot, dynamixel, xacro, robot-calibration or urdf; see
    /// docs/without-an-instrument.md
    #[arg(long, value_names = ["FORM", "FILE"], num_args = 2, requires = "zeros", help_heading = WRITTEN)]
    pub offsets_out: Vec<String>,
    /// Which robot.
    #[command(flatten)]
    pub robot: RobotArguments<SeveralTips>,
}

/// What the columns of an instrument's export are, where their names do not say so; see docs/measurements.md.
#[derive(Debug, Args)]
pub struct ImportArguments {
    /// Map of the data's columns: a TOML file, or x=X1,y=Y1,z=Z1 for a few
    #[arg(long, value_name = "MAP", help_heading = COLUMNS)]
    pub columns: Option<String>,
    /// Order of the turns of angle columns (roll,pitch,yaw; rx,ry,rz; A,B,C; W,P,R): XYZ about moving axes (intrinsic), xyz
    /// about fixed axes (extrinsic)
    #[arg(long, value_name = "ORDER", conflicts_with_all = ["quaternion", "rotation_vector"], help_heading = COLUMNS)]
    pub euler: Option<String>,
    /// Order of a quaternion's columns q1,q2,q3,q4 (or q0,q1,q2,q3), such as wxyz
    #[arg(long, value_name = "ORDER", conflicts_with = "rotation_vector", help_heading = COLUMNS)]
    pub quaternion: Option<String>,
    /// Columns rx,ry,rz are a rotation vector: axis times angle
    #[arg(long, help_heading = COLUMNS)]
    pub rotation_vector: bool,
    /// Joint values of the data's rows, from a robot program: ABB RAPID jointtarget, KUKA KRL AXIS, UR script movej
    #[arg(long, value_name = "PROGRAM", help_heading = COLUMNS)]
    pub joints: Option<String>,
    /// Printed plate whose holes the column hole names: holes per row, rows, and spacing
    #[arg(long, value_name = "4x3:40mm", help_heading = COLUMNS)]
    pub plate: Option<String>,
}

/// The camera whose pixels are in the data; see docs/camera.md.
#[derive(Debug, Args)]
pub struct CameraArguments {
    /// Intrinsics of the camera: YAML as ROS (camera_info) or OpenCV write it
    #[arg(long, value_name = "FILE", help_heading = CAMERA)]
    pub camera: Option<String>,
    /// The camera is on the hand and the board stands still, not the reverse
    #[arg(long, requires = "camera", help_heading = CAMERA)]
    pub on_hand: bool,
    /// The board: squares across and down, and the edge of a square
    #[arg(long, value_name = "7x5:30mm", requires = "camera", help_heading = CAMERA)]
    pub board: Option<String>,
}

/// What to take out of a ROS 2 bag; see docs/bags.md.
#[derive(Debug, Args)]
pub struct BagArguments {
    /// Topic of the joint readings, if several name the robot's joints
    #[arg(long, value_name = "TOPIC", requires = "data", help_heading = BAG)]
    pub joint_topic: Option<String>,
    /// Topic of the target, if there are several; /tf:PARENT/CHILD is a transform
    #[arg(long, value_name = "TOPIC", requires = "data", help_heading = BAG)]
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
    /// Joints whose scale is fitted too (the paper's normalisation factor): names, or all
    #[arg(long, value_name = "JOINTS", value_delimiter = ',', help_heading = FIT)]
    pub scales: Vec<String>,
    /// Revolute joints whose pitch is fitted too (the paper's h): names, or all
    #[arg(long, value_name = "JOINTS", value_delimiter = ',', help_heading = FIT)]
    pub pitches: Vec<String>,
}

const IDENTIFY_EXAMPLES: &str = "\
Prints the number of parameters, 5h + 4r + 2t + n + 6 (Wu, Crawford and Roberts: h screws, r revolute joints, t slides, n \
scales), for poses, positions and distances, and the rank of the identification Jacobian; names what is not identifiable and \
why; then the same for the D-H form.

Examples:
  denavit identify arm.urdf                     with any measurement
  denavit identify arm.urdf --data poses.csv    measured at these joint values
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
Prints for each row its distance from the prediction of the rows before it, and the expected distance; likely causes of a row \
that does not fit (another reflector, a moved base, a wrong joint reading); the least known parameters; the next pose to measure. \
Check that pose for obstacles before the robot takes it.

With --watch the file may grow, be replaced, or not exist yet; Ctrl-C ends the run. Exit codes: 0 every row fits, 1 some rows \
do not fit, 2 error.

Examples:
  denavit measure arm.urdf --data run.csv --watch
  denavit measure arm.urdf --data run.csv --watch --candidates safe_poses.csv
  denavit measure arm.urdf --data run.csv --watch --prior march.json
  some-tool | denavit measure arm.urdf --data - --json   a JSON line per row
  denavit measure arm.urdf --data run.csv                a finished file";

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
    /// Wait for rows that are appended to the file, until Ctrl-C
    #[arg(long)]
    pub watch: bool,
    /// Touch the holes of --plate one after another: at each Enter the last joint values of this file (CSV, or a topic's
    /// growing dump) are appended to --data
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
    /// Earlier calibration, as denavit calibrate --json wrote it: checks then begin after a few rows
    #[arg(long, value_name = "FILE")]
    pub prior: Option<String>,
    /// CSV of joint values from which the next pose is chosen [default: spread over the joint limits]
    #[arg(long, value_name = "FILE")]
    pub candidates: Option<String>,
    /// Number of candidates to spread over the joint limits
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
    /// Holes per row, rows, and spacing: 4x3:40mm
    #[arg(value_name = "HOLES")]
    pub plate: String,
    /// Diameter of the ball on the tip, or of a pen where its cone begins
    #[arg(long, value_name = "LENGTH", default_value = "10mm")]
    pub ball: String,
    /// Write to a file that ends in .stl (a solid, mm) or .svg (a drawing at its true size); repeat it for both
    #[arg(long, short, value_name = "FILE", required = true)]
    pub output: Vec<PathBuf>,
}

const PLAN_EXAMPLES: &str = "\
Chooses, among candidates within the joint limits, the poses with the largest determinant of the information \
(D-optimal), and prints the observability indices O1 to O5 beside those of random poses: larger is better. Check the poses \
for obstacles before the robot takes them.

Examples:
  denavit plan arm.urdf --count 40 -o poses.csv
  denavit plan arm.urdf --count 40 --measure distances --box 0.2,1,-0.5,0.5,0,1
  denavit plan arm.urdf --count 25 --candidates safe_poses.csv --json
  denavit plan arm.urdf --tell-apart run.csv -o poses.csv

With --tell-apart the run is calibrated first. If several causes are possible, the poses distinguish them, and the expected \
odds are printed; otherwise the poses reduce the error of the prediction. Measure them in the order of the file, and append \
the rows to the run. See docs/effects.md.";

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
    /// Choose poses that distinguish the possible causes of this run (- for standard input), measured as its last row was;
    /// several files are several setups
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
    /// Number of candidates to spread over the joint limits
    #[arg(long, value_name = "N", default_value_t = 1000, conflicts_with = "candidates",
        value_parser = clap::value_parser!(u16).range(1..))]
    pub spread: u16,
    /// Units of the run, of the candidates and of the chosen poses: lengths m, mm, um or in; angles rad, mrad or deg
    #[arg(long, value_name = "UNITS", default_value = "m,rad")]
    pub units: String,
    /// Earlier calibration, as denavit calibrate --json wrote it: choose poses that add to it
    #[arg(long, value_name = "FILE")]
    pub prior: Option<String>,
    /// Box in which the target must stay, base frame, m
    #[arg(long, value_name = "X0,X1,Y0,Y1,Z0,Z1", value_delimiter = ',', allow_hyphen_values = true)]
    pub r#box: Vec<f64>,
    /// Position of the target on the tip, m
    #[arg(long, value_name = "X,Y,Z", value_delimiter = ',', allow_hyphen_values = true, default_value = "0.1,0,0.1")]
    pub target: Vec<f64>,
    /// Position of the anchor of a distance instrument, base frame, m [default: the arm's size away]
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
An effect is KIND@PLACE=STRENGTH. KIND is one of the kinds of docs/effects.md. PLACE is a joint's name or base, links, target, \
anchor, instrument, \"wire zero\", \"all joints\". STRENGTH is the change of the measured values (0.3mm, root mean square) or the \
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
    /// Seed; the same seed gives the same files
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
    /// Additional noise along the instrument's line of sight, standard deviation, mm
    #[arg(long, value_name = "MM", default_value_t = 0.0, value_parser = numbers::tolerance)]
    pub range_noise: f64,
    /// Additional noise of the direction from instrument to target, standard deviation, mrad
    #[arg(long, value_name = "MRAD", default_value_t = 0.0, value_parser = numbers::tolerance)]
    pub angle_noise: f64,
    /// Repeatability of a joint, standard deviation: mrad, or mm for slides; without a name, of all joints
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
    /// Columns to record beside the measurements: time, temperature, payload, tilt_x, tilt_y, approach, velocity, or JOINT.temperature …
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    pub columns: Vec<String>,
    /// Write test rows, too: the same robot, measured after the others
    #[arg(long, value_name = "FILE")]
    pub test: Option<PathBuf>,
    /// Number of test rows
    #[arg(long, value_name = "N", default_value_t = 40, requires = "test",
        value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub test_rows: u32,
    /// Write the simulated robot, as JSON
    #[arg(long, value_name = "FILE")]
    pub truth: Option<PathBuf>,
}

const COMPENSATE_EXAMPLES: &str = "\
ROBOT is the calibrated URDF. Poses are CSV: the tip in the base frame as x,y,z (m) and qx,qy,qz,qw or roll,pitch,yaw, or \
other angles as --euler and --rotation-vector state; or joint values, which mean the pose of the nominal robot there; with \
both, the search starts at the joint values. Effects may follow other columns (payload, temperature, …); approach sides follow \
from the row order unless given. Rows out of reach or limits are named, and the exit code is then 1. Fewer than six joints \
cannot correct every direction: position is corrected first, and --allowed-miss states the allowed error of direction.

Examples:
  denavit compensate calibrated.urdf --from arm.urdf --poses poses.csv -o commands.csv
  denavit compensate calibrated.urdf --effects effects.json --poses poses.csv --json
  denavit compensate calibrated.urdf --poses ur.csv --rotation-vector   # x,y,z,rx,ry,rz of a UR";

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
    /// The robot as drawn, which the controller uses [default: that in the file of effects, else ROBOT]
    #[arg(long, value_name = "ROBOT")]
    pub from: Option<String>,
    /// File of effects, as `denavit calibrate --effects-out` wrote it
    #[arg(long, value_name = "FILE")]
    pub effects: Option<String>,
    /// What the effects follow.
    #[command(flatten)]
    pub given: GivenArguments,
    /// Error up to which a command counts as reaching its pose: mm and mrad
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
