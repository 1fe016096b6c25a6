//! `denavit export`: a URDF whose link frames are the D-H frames.

use crate::args::{ExportArguments, FramesName};
use crate::delivery::Delivery;
use crate::failure::Failure;
use crate::output::{self, Status};
use crate::source::{self, Loaded};
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
    if let Some(said) = other_chain_than_of_the_table(&loaded, arguments) {
        output::mention(said);
    }
    delivery.text(exported.value)?;
    Ok(Status::Same)
}

/// An arm with a hand: the frames follow its fingers, through which the longest chain goes, and the table ends at its tool.
fn other_chain_than_of_the_table(loaded: &Loaded, arguments: &ExportArguments) -> Option<String> {
    let Loaded::Robot(tree) = loaded else { return None };
    if arguments.robot.tip.is_some() || arguments.dh_links {
        return None;
    }
    let (of_frames, of_table) = (tree.longest_chain().tip, tree.default_chain().tip);
    (of_frames != of_table).then(|| {
        format!(
            "the frames follow the longest chain, to \"{of_frames}\"; `denavit table` ends at \"{of_table}\", so that its last row \
             may lie elsewhere on the last axis; --tip {of_table} makes the frames those of that table"
        )
    })
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
