//! Arguments of `denavit fleet`.

use super::{JsonArguments, numbers};
use clap::{Args, Subcommand};
use std::path::PathBuf;

const FLEET_EXAMPLES: &str = "\
Examples:
  denavit fleet run plant.csv -o store                        every robot of a manifest, on all cores
  denavit fleet run 'nights/{serial}/{date}.csv' --set robot=ur5e.urdf -o store
  denavit fleet watch store                                   who has changed, with exit code 1
  denavit fleet report store -o pages                         pages for a browser
  denavit fleet corpus robots                                 which of thousands of URDFs have the same mechanism

See docs/fleet.md.";

/// Arguments of `denavit fleet`.
#[derive(Debug, Args)]
#[command(after_help = FLEET_EXAMPLES)]
pub struct FleetArguments {
    /// What to do.
    #[command(subcommand)]
    pub command: FleetCommand,
}

/// What can be done with a fleet.
#[derive(Debug, Subcommand)]
pub enum FleetCommand {
    /// Calibrate, check, compare … every robot of a manifest into a store of Parquet files
    Run(FleetRunArguments),
    /// Find robots that have changed, over thousands of robots and nights: the nightly job
    Watch(FleetWatchArguments),
    /// Print the history of each robot: drifts, steps, and when it leaves a tolerance
    History(FleetHistoryArguments),
    /// Print what robots have in common, and which of them stand out from their siblings
    Siblings(FleetSiblingsArguments),
    /// Make static pages: one for the fleet, one for each robot
    Report(FleetReportArguments),
    /// Find files with the same mechanism or nearly the same, and the commits that changed robots
    Corpus(FleetCorpusArguments),
}

const RUN_EXAMPLES: &str = "\
The manifest is CSV with a row per robot and night (serial,robot,data,date, and task, event, test, against, base, tip, units, \
effects, max_effects, mass, hold_out, seed, tolerance, tolerance_m, tolerance_rad, prior, arguments), TOML with the same keys in [defaults] \
and [[robots]], or a pattern of folders with {serial} and {date}. Paths are taken from the manifest's folder; several files of \
data are joined by ;. Without a task, a row with data is calibrated, and a row without data gets its D-H table.

A run that was stopped or killed continues where it ended; finished work is not repeated. Exit code 1: some robots failed; \
the store has a row with the error of each.

Examples:
  denavit fleet run plant.csv -o store
  denavit fleet run plant.csv -o store --set effects=none --set units=mm,deg
  duckdb -c \"select serial, rms from 'store/runs/*.parquet' order by rms desc\"";

/// Arguments of `denavit fleet run`.
#[derive(Debug, Args)]
#[command(after_help = RUN_EXAMPLES)]
pub struct FleetRunArguments {
    /// CSV, TOML, or a pattern such as 'nights/{serial}/{date}.csv'
    pub manifest: String,
    /// Folder of the store; created if it does not exist, else continued
    #[arg(long, short, value_name = "STORE")]
    pub output: PathBuf,
    /// Value for every entry that has no other: robot=arm.urdf
    #[arg(long, value_name = "WORD=VALUE")]
    pub set: Vec<String>,
    /// Robots computed at the same time; results do not depend on it [default: as many as there are cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    pub threads: Option<u16>,
    /// JSON.
    #[command(flatten)]
    pub json: JsonArguments,
}

const CORPUS_EXAMPLES: &str = "\
Examples:
  denavit fleet corpus robots                    files with the same mechanism or nearly the same, and files without a robot
  denavit fleet corpus robots --near 5e-3 --json corpus.json
  denavit fleet corpus git:.                     which commits changed which robots
  denavit fleet corpus git:. --revision v1..v2";

/// Arguments of `denavit fleet corpus`.
#[derive(Debug, Args)]
#[command(after_help = CORPUS_EXAMPLES)]
pub struct FleetCorpusArguments {
    /// Folder with URDF and xacro files, at any depth, or git:FOLDER of a repository for its history of URDF files
    pub corpus: String,
    /// Files whose fingerprints agree within this have the same mechanism, m and rad
    #[arg(long, value_name = "TOLERANCE", default_value_t = denavit_compare::fingerprint::DEFAULT_TOLERANCE,
        value_parser = numbers::tolerance)]
    pub tolerance: f64,
    /// Mechanisms that differ by no more than this are nearly alike, m and rad; 0: do not search for them
    #[arg(long, value_name = "TOLERANCE", default_value_t = 1e-3, value_parser = numbers::tolerance)]
    pub near: f64,
    /// Revision or range of a history
    #[arg(long, value_name = "REVISION", default_value = "HEAD")]
    pub revision: String,
    /// Files read at the same time [default: as many as there are cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    pub threads: Option<u16>,
    /// JSON.
    #[command(flatten)]
    pub json: JsonArguments,
}

const WATCH_EXAMPLES: &str = "\
A robot's first nights are its reference; a night with a recorded event starts a new reference. The false discovery rate over \
the robots of a night is controlled (Benjamini and Hochberg). An alarm needs two marks in three nights, of the same parameter in \
the same direction, or medians of the last five nights and of the five before that deviate to the same side. Exit code 1: there is \
an alarm.

Examples:
  denavit fleet watch store
  denavit fleet watch store --junit watch.xml --markdown watch.md";

/// Arguments of `denavit fleet watch`.
#[derive(Debug, Args)]
#[command(after_help = WATCH_EXAMPLES)]
pub struct FleetWatchArguments {
    /// Folder of the store
    pub store: PathBuf,
    /// False discovery rate of a night's marks
    #[arg(long, value_name = "SHARE", default_value_t = 0.05, value_parser = numbers::part)]
    pub rate: f64,
    /// Number of first nights of a robot, with which its later nights are compared
    #[arg(long, value_name = "NIGHTS", default_value_t = 8, value_parser = clap::value_parser!(u16).range(3..))]
    pub reference: u16,
    /// Write a JUnit report: a case for each robot of the night
    #[arg(long, value_name = "FILE")]
    pub junit: Option<PathBuf>,
    /// Write a message in Markdown
    #[arg(long, value_name = "FILE")]
    pub markdown: Option<PathBuf>,
    /// JSON.
    #[command(flatten)]
    pub json: JsonArguments,
}

const HISTORY_EXAMPLES: &str = "\
Examples:
  denavit fleet history store               drifts and steps, robot by robot
  denavit fleet history store SN-017        one robot";

/// Arguments of `denavit fleet history`.
#[derive(Debug, Args)]
#[command(after_help = HISTORY_EXAMPLES)]
pub struct FleetHistoryArguments {
    /// Folder of the store
    pub store: PathBuf,
    /// One robot [default: all]
    pub serial: Option<String>,
    /// Tolerance about the first nights, which a drift may leave, m
    #[arg(long, value_name = "M", default_value_t = 5e-4, value_parser = numbers::tolerance)]
    pub tolerance_m: f64,
    /// The same for angles, rad
    #[arg(long, value_name = "RAD", default_value_t = 1e-3, value_parser = numbers::tolerance)]
    pub tolerance_rad: f64,
    /// JSON.
    #[command(flatten)]
    pub json: JsonArguments,
}

/// Arguments of `denavit fleet report`.
#[derive(Debug, Args)]
pub struct FleetReportArguments {
    /// Folder of the store
    pub store: PathBuf,
    /// Folder of the pages: index.html for the fleet, robots/ with a page for each robot
    #[arg(long, short, value_name = "FOLDER")]
    pub output: PathBuf,
}

const SIBLINGS_EXAMPLES: &str = "\
Exit code 1: some robots stand out from their siblings.

Examples:
  denavit fleet siblings store
  denavit fleet siblings store --prior-out siblings.json
  denavit calibrate arm.urdf --data eight_poses.csv --prior siblings.json
  denavit fleet siblings store --without SN-017 --prior-out others.json";

/// Arguments of `denavit fleet siblings`.
#[derive(Debug, Args)]
#[command(after_help = SIBLINGS_EXAMPLES)]
pub struct FleetSiblingsArguments {
    /// Folder of the store
    pub store: PathBuf,
    /// Write what the robots have in common as a prior, for `calibrate --prior` of another such robot
    #[arg(long, value_name = "FILE")]
    pub prior_out: Option<PathBuf>,
    /// Leave this robot out of the prior
    #[arg(long, value_name = "SERIAL", requires = "prior_out")]
    pub without: Option<String>,
    /// Drawing of the siblings to use [default: that of the robot left out, else the drawing of most robots]
    #[arg(long, value_name = "FILE", requires = "prior_out")]
    pub robot: Option<String>,
    /// Link that the siblings to use were calibrated to, if the store has several
    #[arg(long, value_name = "LINK", requires = "prior_out")]
    pub tip: Option<String>,
    /// False discovery rate over robots and parameters
    #[arg(long, value_name = "SHARE", default_value_t = 0.05, value_parser = numbers::part)]
    pub rate: f64,
    /// JSON.
    #[command(flatten)]
    pub json: JsonArguments,
}
