//! `denavit export`: a URDF whose link frames are the D-H frames.

use crate::args::{ExportArguments, FramesName};
use crate::delivery::Delivery;
use crate::failure::Failure;
use crate::output::{self, Status};
use crate::source::{self, Loaded};
use denavit_dh::{Gauge, Parallelism};
use denavit_export::urdf::{Frames, LinkFrames, Options};
use denavit_load::TableOptions;
use denavit_model::Reading;

/// Runs the command.
pub fn run(arguments: &ExportArguments) -> Result<Status, Failure> {
    let robot = &arguments.robot;
    let delivery = Delivery::plain(arguments.output.as_deref(), robot.files())?;
    let loaded = source::load(&robot.robot, &robot.source)?;
    let options = options(arguments);
    let exported = denavit_load::canonical(&loaded, &robot.robot, &options)?;
    output::remark(&exported.notes);
    let how = TableOptions { convention: None, gauge: None, tolerance: robot.tolerance };
    let replaced = matches!(loaded, Loaded::Robot(_)) && options.link_frames == LinkFrames::Replace;
    if replaced && !denavit_load::same_table(&loaded, &exported.value, &robot.selection(), &how)? {
        output::mention(
            "the table of the source has other numbers of the same robot than the table of this export: the geometry leaves free \
             how lengths along one axis are split",
        );
    }
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
