//! `denavit export`: a URDF whose link frames are the D-H frames.

use crate::args::{ExportArguments, FramesName};
use crate::delivery::Delivery;
use crate::failure::Failure;
use crate::output::{self, Status};
use crate::source::{self, Loaded};
use denavit_dh::table::Row;
use denavit_dh::{Gauge, Parallelism};
use denavit_export::urdf::{Frames, LinkFrames, Options};
use denavit_load::TableOptions;
use denavit_model::Reading;

/// Numbers of two tables that are closer than this, relative to 1 or their size, are one number.
const SAME_NUMBER: f64 = 1e-9;

/// Runs the command.
pub fn run(arguments: &ExportArguments) -> Result<Status, Failure> {
    let robot = &arguments.robot;
    let delivery = Delivery::plain(arguments.output.as_deref(), robot.files())?;
    let loaded = source::load(&robot.robot, &robot.source)?;
    let exported = denavit_load::canonical(&loaded, &robot.robot, &options(arguments))?;
    output::remark(&exported.notes);
    if other_numbers_than_the_table(&loaded, &exported.value, arguments)? {
        output::mention(
            "the table of the source has other numbers of the same robot than the table of this export: the geometry leaves free \
             how lengths along one axis are split",
        );
    }
    delivery.text(exported.value)?;
    Ok(Status::Same)
}

/// Whether the table of the file that is written differs from that of its source, both as `denavit table` prints them.
fn other_numbers_than_the_table(loaded: &Loaded, text: &str, arguments: &ExportArguments) -> Result<bool, Failure> {
    if !matches!(loaded, Loaded::Robot(_)) || options(arguments).link_frames != LinkFrames::Replace {
        return Ok(false);
    }
    let selection = arguments.robot.selection();
    let how = TableOptions { convention: None, gauge: None, tolerance: arguments.robot.tolerance };
    let exported = denavit_load::from_text("exported.urdf", text, &denavit_load::Options::default())?.robot;
    let (table, in_file) = (loaded.table(&selection, &how)?.table.value, exported.table(&selection, &how)?.table.value);
    let near = |a: f64, b: f64| (a - b).abs() <= SAME_NUMBER * a.abs().max(1.0);
    let same = table.rows.len() == in_file.rows.len()
        && table.rows.iter().zip(&in_file.rows).all(|rows| match rows {
            (Row::Dh(a), Row::Dh(b)) => {
                near(a.theta, b.theta) && near(a.d, b.d) && near(a.alpha, b.alpha) && near(a.a, b.a)
            }
            (a, b) => a == b,
        });
    Ok(!same || !near(table.tool.theta, in_file.tool.theta) || !near(table.tool.d, in_file.tool.d))
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
