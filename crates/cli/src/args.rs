//! The command line: what can be asked for, and the help that teaches it.

use clap::{Args, Parser, Subcommand, ValueEnum};
use std::path::PathBuf;

/// A robot's URDF in; screw axes, Denavit-Hartenberg tables, comparison and calibration out.
#[derive(Debug, Parser)]
#[command(name = "denavit", version, propagate_version = true, max_term_width = 110, after_help = EXAMPLES)]
pub struct Arguments {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

const EXAMPLES: &str = "\
Examples:
  denavit table ur5e.urdf                          the D-H table, in degrees and metres
  denavit table ur5e.urdf --convention proximal    modified (Craig) form
  denavit table panda.urdf --format tex > dh.tex   for a document
  denavit chains pr2.urdf                          which chains there are
  denavit fk ur5e.urdf --q 0,-1.57,1.57,0,0,0      where the tip is

ROBOT is a URDF, a D-H table or screw axes (CSV or JSON), - for standard input, or git:REVISION:PATH.
Exit codes: 0 done or the same, 1 different or found, 2 trouble.";

/// The commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Print the Denavit-Hartenberg table of a chain
    Table(TableArguments),
    /// List every chain from a base link to a leaf
    Chains(ChainsArguments),
    /// Forward kinematics: where the tip is at given joint values
    Fk(FkArguments),
    /// Print the screw axes and the home pose (product of exponentials)
    Poe(PoeArguments),
}

/// Which robot, and which chain of it.
#[derive(Debug, Args)]
pub struct RobotArguments {
    /// URDF, D-H table or screw axes (CSV, JSON), - for standard input, or git:REVISION:PATH
    pub robot: String,
    /// Link that the chain starts at [default: the root, or below the last floating joint]
    #[arg(long, value_name = "LINK")]
    pub base: Option<String>,
    /// Link that the chain ends at [default: the end of the longest actuated chain]
    #[arg(long, value_name = "LINK")]
    pub tip: Option<String>,
    /// Take every number as it is written: no angle read as the multiple of π it was meant for, no near-parallel axes
    /// made parallel
    #[arg(long)]
    pub exact: bool,
    /// Neighbouring axes closer to parallel than this are treated as parallel, rad
    #[arg(long, value_name = "RAD", default_value_t = 1e-6, conflicts_with = "exact")]
    pub tolerance: f64,
}

/// Units of what is printed for people.
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

/// Names of gauges on the command line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum GaugeName {
    /// The fewest numbers that are not 0, quarter turns before other angles
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
    #[arg(long, value_name = "FORMAT", default_value = "text", value_parser = format_names())]
    pub format: String,
    /// How the numbers are grouped into rows
    #[arg(long, value_enum)]
    pub convention: Option<ConventionName>,
    /// How to choose what the geometry leaves free
    #[arg(long, value_enum)]
    pub gauge: Option<GaugeName>,
    /// Compare with a vendor's table (CSV or JSON): find the senses, zeros, base and tool frames in which the robot
    /// equals it, print it in the vendor's form, say where they differ; exit code 1 unless exact or rounded
    #[arg(long, value_name = "TABLE", conflicts_with_all = ["convention", "gauge"])]
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
    /// URDF, - for standard input, or git:REVISION:PATH
    pub robot: String,
    /// Print JSON
    #[arg(long)]
    pub json: bool,
}

/// Arguments of `denavit fk`.
#[derive(Debug, Args)]
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
    /// Print JSON, rad and m at full precision
    #[arg(long)]
    pub json: bool,
    /// Units of text.
    #[command(flatten)]
    pub units: UnitsArguments,
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
    #[arg(long, value_enum, default_value_t = PoeFormat::Text)]
    pub format: PoeFormat,
    /// Units of text.
    #[command(flatten)]
    pub units: UnitsArguments,
}
