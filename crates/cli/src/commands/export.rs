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
    if let Some(said) = other_numbers_than_the_table(&loaded, &exported.value, arguments)? {
        output::mention(said);
    }
    delivery.text(exported.value)?;
    Ok(Status::Same)
}

/// The frames follow the longest chain, through a hand's fingers where the arm carries one; the table ends at the tool. Where
/// that leads to other numbers it must be said.
fn other_numbers_than_the_table(
    loaded: &Loaded,
    text: &str,
    arguments: &ExportArguments,
) -> Result<Option<String>, Failure> {
    let Loaded::Robot(tree) = loaded else { return Ok(None) };
    let options = options(arguments);
    let (of_frames, of_table) = (tree.longest_chain().tip, tree.default_chain().tip);
    if of_frames == of_table || options.tip.is_some() || options.link_frames != LinkFrames::Replace {
        return Ok(None);
    }
    let selection = arguments.robot.selection();
    let how = TableOptions { convention: None, gauge: None, tolerance: arguments.robot.tolerance };
    let Ok(table) = loaded.table(&selection, &how) else { return Ok(None) };
    let exported = denavit_load::from_text("exported.urdf", text, &denavit_load::Options::default())?.robot;
    let Ok(in_file) = exported.table(&selection, &how) else { return Ok(None) };
    let (table, in_file) = (table.table.value, in_file.table.value);
    let near = |a: f64, b: f64| (a - b).abs() <= SAME_NUMBER * a.abs().max(1.0);
    let same = table.rows.len() == in_file.rows.len()
        && table.rows.iter().zip(&in_file.rows).all(|rows| match rows {
            (Row::Dh(a), Row::Dh(b)) => {
                near(a.theta, b.theta) && near(a.d, b.d) && near(a.alpha, b.alpha) && near(a.a, b.a)
            }
            (a, b) => a == b,
        });
    let tools = (table.tool, in_file.tool);
    let same = same && near(tools.0.theta, tools.1.theta) && near(tools.0.d, tools.1.d);
    Ok((!same).then(|| {
        format!(
            "the frames follow the longest chain, to \"{of_frames}\"; the table of the source ends at \"{of_table}\" and has \
             other numbers of the same robot than the table of this export: `denavit table` prints either"
        )
    }))
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
        tip: robot.tip.tip.clone(),
    }
}
