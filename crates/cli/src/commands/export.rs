//! `denavit export`: a URDF whose link frames are the D-H frames.

use crate::args::{ExportArguments, FramesName};
use crate::delivery::Delivery;
use crate::failure::Failure;
use crate::output::{self, Status};
use crate::source;
use denavit_dh::{Gauge, Parallelism};
use denavit_export::urdf::{Frames, LinkFrames, Options};
use denavit_model::Reading;

/// Runs the command.
pub fn run(arguments: &ExportArguments) -> Result<Status, Failure> {
    let robot = &arguments.robot;
    let delivery = Delivery::plain(arguments.output.as_deref(), robot.files())?;
    let loaded = source::load(&robot.robot, &robot.source)?;
    let exported = denavit_load::canonical(&loaded, &robot.robot, &options(arguments))?;
    output::remark(&exported.notes);
    delivery.text(exported.value)?;
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
        base: robot.base.clone(),
        tip: robot.tip.tip.clone(),
    }
}
