//! Arguments of `denavit edit`: operations one after another.

use super::{ConventionName, JsonArguments};
use clap::{Args, Parser};
use std::ffi::OsString;
use std::fmt::Write as _;
use std::path::PathBuf;

/// Separates the words of an operation after `--then`, which clap takes as one value.
const BETWEEN: char = '\u{1f}';

fn help() -> String {
    let mut text = String::from("Operations:\n");
    for operation in denavit_edit::OPERATIONS {
        let _ = writeln!(text, "  {:<34} {}", operation.usage, operation.purpose);
    }
    text + "
Each result is read again and compared with the source: what the operation must not change is checked at joint values that
move all joints, and by `denavit diff` where possible. If a check fails, or an operation is not possible, the exit code is 2,
the reason is printed, and nothing is written.

Examples:
  denavit edit arm.urdf flip elbow_joint -o out.urdf
  denavit edit arm.urdf zero elbow_joint=90deg --then reroot tool0 -o out.urdf
  denavit edit arm.urdf rename tool0=flange --srdf arm.srdf --srdf-out new.srdf -o out.urdf
  denavit edit arm.urdf attach gripper.urdf --at tool0 --pose 0,0,10mm,0,0,90deg --prefix gripper_ -o out.urdf
  denavit edit left_arm.urdf mirror xz --names left=right -o right_arm.urdf
  denavit edit ur5e.urdf set-calibration my_ur5e_calibration.yaml -o my_ur5e.urdf
  denavit edit arm.urdf simplify-collision smallest --then meshes --to arm/meshes -o arm/arm.urdf
  denavit edit arm.urdf merge --keep tool0 --dry-run"
}

/// Arguments of `denavit edit`.
#[derive(Debug, Args)]
#[command(after_help = help())]
pub struct EditArguments {
    /// URDF, - for standard input, or git:REVISION:PATH; xacro with --expand
    pub robot: String,
    /// An operation and its words, as below; NAME:=VALUE are arguments of a xacro file
    #[arg(required = true, value_name = "OPERATION")]
    pub operation: Vec<String>,
    /// Another operation, on the result of the one before: all words up to the next --then
    #[arg(long, value_name = "OPERATION…")]
    pub then: Vec<String>,
    /// What some operations take.
    #[command(flatten)]
    pub with: OperationArguments,
    /// Where it goes.
    #[command(flatten)]
    pub outputs: EditOutputs,
}

/// What some operations take beside their words.
#[derive(Debug, Clone, Default, Args)]
pub struct OperationArguments {
    /// attach: link that the other robot is attached to
    #[arg(long, value_name = "LINK")]
    pub at: Option<String>,
    /// attach: pose of its root in that link, x,y,z or x,y,z,roll,pitch,yaw in m and rad, or with units [default: 0]
    #[arg(long, value_name = "POSE", allow_hyphen_values = true)]
    pub pose: Option<String>,
    /// attach: prefix of its names
    #[arg(long, value_name = "PREFIX")]
    pub prefix: Option<String>,
    /// merge: link to keep as a frame, without mass and shapes; may be given several times
    #[arg(long, value_name = "LINK")]
    pub keep: Vec<String>,
    /// mirror: parts of names that are exchanged, such as left=right; may be given several times
    #[arg(long, value_name = "ONE=OTHER")]
    pub names: Vec<String>,
    /// origin: new pose of the frame, in the present frame; meshes, simplify-collision: folder for the mesh files
    #[arg(long, value_name = "POSE|FOLDER", allow_hyphen_values = true)]
    pub to: Option<String>,
    /// set-calibration: the maker's table of the arm as drawn, which relates the calibrated numbers to the robot
    #[arg(long, value_name = "FILE")]
    pub nominal: Option<String>,
    /// set-calibration: convention of a D-H table that does not state it [default: distal]
    #[arg(long, value_name = "CONVENTION", value_enum, hide_possible_values = true)]
    pub table_convention: Option<ConventionName>,
    /// set-calibration: units of a D-H table that does not state them, such as mm,deg
    #[arg(long, value_name = "UNITS")]
    pub table_units: Option<String>,
    /// set-calibration: read the angles of a UR kinematics file as the vendor's tool does
    #[arg(long)]
    pub vendor_angles: bool,
}

/// What is read beside the robot, and what is written.
#[derive(Debug, Clone, Default, Args)]
pub struct EditOutputs {
    /// SRDF of the robot: its names and states are changed to match
    #[arg(long, value_name = "FILE")]
    pub srdf: Option<String>,
    /// File for the changed SRDF
    #[arg(long, value_name = "FILE", requires = "srdf")]
    pub srdf_out: Option<PathBuf>,
    /// Expand a xacro file first; the result is a URDF
    #[arg(long)]
    pub expand: bool,
    /// Folder with ROS packages, or a package; may be given several times
    #[arg(long, value_name = "FOLDER")]
    pub package_path: Vec<PathBuf>,
    /// Let xacro read files outside its package and the package path
    #[arg(long)]
    pub allow_any_file: bool,
    /// Print the changes as `diff -u` does, and write nothing
    #[arg(long, conflicts_with_all = ["output", "srdf_out", "json"])]
    pub dry_run: bool,
    /// Write to a file, as a whole or not at all [default: standard output]
    #[arg(long, short, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// What was done and proved, as JSON.
    #[command(flatten)]
    pub json: JsonArguments,
}

/// One operation with what stands beside it.
#[derive(Debug)]
pub struct Step {
    /// Its words.
    pub words: Vec<String>,
    /// Its options.
    pub with: OperationArguments,
}

/// What follows a `--then`.
#[derive(Debug, Parser)]
#[command(name = "denavit edit … --then", no_binary_name = true, disable_help_flag = true)]
struct Then {
    #[arg(required = true, value_name = "OPERATION")]
    operation: Vec<String>,
    #[command(flatten)]
    with: OperationArguments,
    #[command(flatten)]
    outputs: EditOutputs,
}

impl EditArguments {
    /// The operations in order, and what is read and written, wherever in the line it is given.
    ///
    /// # Errors
    /// clap's, for words after `--then` that are not options of an operation.
    pub fn steps(&self) -> Result<(Vec<Step>, EditOutputs), clap::Error> {
        let mut outputs = self.outputs.clone();
        let mut steps = vec![Step { words: self.operation.clone(), with: self.with.clone() }];
        for then in &self.then {
            let Then { operation, with, outputs: more } = Then::try_parse_from(then.split(BETWEEN))?;
            steps.push(Step { words: operation, with });
            outputs.srdf = more.srdf.or(outputs.srdf);
            outputs.srdf_out = more.srdf_out.or(outputs.srdf_out);
            outputs.output = more.output.or(outputs.output);
            outputs.expand |= more.expand;
            outputs.dry_run |= more.dry_run;
            outputs.allow_any_file |= more.allow_any_file;
            outputs.json.file = more.json.file.or(outputs.json.file);
            outputs.package_path.extend(more.package_path);
        }
        Ok((steps, outputs))
    }
}

/// The words of a command line of `edit`, with all words after a `--then` joined to its one value.
pub fn with_steps_joined(words: Vec<OsString>) -> Vec<OsString> {
    if words.get(1).is_none_or(|word| word != "edit") {
        return words;
    }
    let mut joined: Vec<OsString> = Vec::new();
    let mut open = false;
    for word in words {
        if word == "--then" {
            joined.push("--then=".into());
            open = true;
            continue;
        }
        match joined.last_mut() {
            Some(last) if open => {
                if last != "--then=" {
                    last.push(BETWEEN.to_string());
                }
                last.push(word);
            }
            _ => joined.push(word),
        }
    }
    joined
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_stands_behind_then_is_one_operation() {
        let joined = |line: &str| {
            let words = with_steps_joined(line.split(' ').map(OsString::from).collect());
            words.iter().map(|word| word.to_string_lossy().replace(BETWEEN, "|")).collect::<Vec<_>>().join(" ")
        };
        assert_eq!(
            joined("denavit edit a.urdf flip j --then zero k=1 -o b.urdf --then reroot t"),
            "denavit edit a.urdf flip j --then=zero|k=1|-o|b.urdf --then=reroot|t"
        );
        assert_eq!(joined("denavit table a --then"), "denavit table a --then");
    }
}
