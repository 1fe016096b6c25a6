//! `denavit export`: a URDF whose link frames are the D-H frames.

use crate::args::{ExportArguments, FramesName};
use crate::failure::Failure;
use crate::output::{self, Status};
use crate::source::{self, Loaded};
use denavit_dh::{Convention, Gauge, Parallelism};
use denavit_export::urdf::{self, Frames, LinkFrames, Options};
use denavit_model::Reading;

/// Runs the command.
pub fn run(arguments: &ExportArguments) -> Result<Status, Failure> {
    let robot = &arguments.robot;
    let loaded = source::load(&robot.robot, &robot.source)?;
    let text = match &loaded {
        Loaded::Robot(tree) => {
            let exported = urdf::canonical(tree, &options(arguments))?;
            output::remark(&exported.notes);
            exported.value
        }
        Loaded::Table { table, convention, .. } => urdf::from_table(table, *convention)?,
        Loaded::Poe(chain) => {
            let failed = |source| Failure::Chain { file: robot.robot.clone(), source };
            let made = denavit_dh::convert::table(chain, &denavit_dh::Options::default()).map_err(failed)?;
            output::remark(&made.notes);
            urdf::from_table(&made.value, Convention::Distal)?
        }
    };
    super::deliver(arguments.output.as_deref(), &text)?;
    Ok(Status::Same)
}

fn options(arguments: &ExportArguments) -> Options {
    let robot = &arguments.robot;
    Options {
        link_frames: match (arguments.keep_link_frames, arguments.dh_links) {
            (true, _) => LinkFrames::Keep,
            (_, true) => LinkFrames::MarkOnly,
            _ => LinkFrames::Replace,
        },
        frames: match arguments.frames {
            FramesName::Distal => Frames::Distal,
            FramesName::Proximal => Frames::Proximal,
        },
        reading: if robot.exact { Reading::AsWritten } else { Reading::Intended },
        gauge: Gauge::default(),
        parallelism: if robot.exact { Parallelism::Exact } else { Parallelism::Within { angle: robot.tolerance } },
        tip: robot.tip.clone(),
    }
}
