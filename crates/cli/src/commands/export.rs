//! `denavit export`: a URDF whose link frames are the D-H frames, or the robot in another format with its frames as they are.

use crate::args::{ExportArguments, FramesName, RobotFormatName};
use crate::delivery::Delivery;
use crate::failure::Failure;
use crate::output::{self, Outputs, Status};
use crate::source::{self, Loaded};
use denavit_dh::{Gauge, Parallelism};
use denavit_export::urdf::{Frames, LinkFrames, Options};
use denavit_load::{ConvertOptions, TableOptions};
use denavit_model::Reading;
use denavit_model::formats::{Format, Loss};
use std::path::Path;

/// Runs the command.
pub fn run(arguments: &ExportArguments) -> Result<Status, Failure> {
    let robot = &arguments.robot;
    if let Some(to) = by_name(arguments) {
        let (file, text) = source::read_text(&robot.robot)?;
        return converted(arguments, to, &file, &text);
    }
    if arguments.output.is_some() && robot.robot != "-" {
        let (file, text) = source::read_text(&robot.robot)?;
        // A URDF of another format is that robot with its frames, not with the frames of a table.
        if Format::of_text(&text).is_some_and(|format| format != Format::Urdf)
            && !arguments.keep_link_frames
            && !arguments.dh_links
        {
            return converted(arguments, Format::Urdf, &file, &text);
        }
    }
    for (given, option) in [
        (arguments.proof, "--proof"),
        (arguments.fix_inertia, "--fix-inertia"),
        (arguments.srdf.is_some(), "--srdf"),
        (arguments.srdf_out.is_some(), "--srdf-out"),
    ] {
        if given {
            return Err(Failure::Argument(format!(
                "{option} is for a conversion; choose its format: --to mjcf, sdf or urdf"
            )));
        }
    }
    let delivery = Delivery::plain(arguments.output.as_deref(), robot.files())?;
    let loaded = source::load(&robot.robot, &robot.source)?;
    let options = options(arguments);
    let exported = denavit_load::canonical(&loaded, &robot.robot, &options)?;
    output::remark(&exported.notes);
    let how = TableOptions { convention: None, gauge: None, tolerance: robot.tolerance };
    let replaced = matches!(loaded, Loaded::Robot(_)) && options.link_frames == LinkFrames::Replace;
    if replaced && !denavit_load::same_table(&loaded, &exported.value, &robot.selection(), &how)? {
        output::mention(
            "the D-H tables of the source and of this export have different numbers for the same robot: the geometry does not \
             determine how lengths along one axis are split",
        );
    }
    delivery.text(exported.value)?;
    Ok(Status::Same)
}

/// The format to convert to, where an option or the output's name says one.
fn by_name(arguments: &ExportArguments) -> Option<Format> {
    let by_output = || Format::of_file_name(&arguments.output.as_ref()?.to_string_lossy());
    let to = arguments.to.map(RobotFormatName::format);
    to.or_else(|| by_output().filter(|format| *format != Format::Urdf))
}

/// Writes the robot in another format, with what it lost beside it.
fn converted(arguments: &ExportArguments, to: Format, file: &str, text: &str) -> Result<Status, Failure> {
    let robot = &arguments.robot;
    if arguments.fix_inertia && to != Format::Mjcf {
        let name = to.name();
        return Err(Failure::Argument(format!("--fix-inertia: {name} accepts every inertia; leave the option out")));
    }
    if arguments.srdf.is_some() && to != Format::Mjcf {
        let name = to.name();
        return Err(Failure::Argument(format!(
            "--srdf: {name} cannot hold the contents of an SRDF; keep the SRDF as a file of its own"
        )));
    }
    let srdf = arguments.srdf.as_deref().map(source::read_text).transpose()?;
    let mut outputs = Outputs::beside(robot.files().chain(arguments.srdf.as_deref()));
    let place = arguments.output.as_deref().unwrap_or(Path::new("-"));
    let own = outputs.add("--output", place)?;
    let to_file = !outputs.take_standard_output();
    let sidecar = to_file.then(|| denavit_load::sidecar_of(place));
    let beside = sidecar.as_ref().map(|sidecar| outputs.add("--output", sidecar)).transpose()?;
    let of_srdf = outputs.add_if("--srdf-out", arguments.srdf_out.as_deref())?;
    let source = source::options(&robot.source)?;
    let output = arguments.output.as_deref().filter(|_| to_file);
    let options = ConvertOptions {
        to,
        output,
        fix_inertia: arguments.fix_inertia,
        srdf: srdf.as_ref().map(|(file, text)| (file.as_str(), text.as_str())),
        source: &source,
    };
    let mut written = denavit_load::convert(file, text, &options)?;
    let mut texts = vec![(own, written.text.clone())];
    texts.extend(beside.zip(written.sidecar.clone()));
    if let Some(place) = of_srdf {
        let srdf = denavit_load::srdf_of(file, text, &source)?;
        texts.push((place, srdf.text));
        // What the SRDF says is not lost.
        written.losses.retain(|loss| !["<exclude>", "<key>"].contains(&loss.what.as_str()));
        written.losses.extend(srdf.losses);
    }
    outputs.write(&texts)?;
    for (loss, others) in kinds(&written.losses) {
        let more = if others == 0 { String::new() } else { format!(" (and {others} more like it)") };
        output::mention(format!("lost: {loss}{more}"));
    }
    if arguments.proof && to_file {
        output::print(&(written.proof.join("\n") + "\n"))?;
    } else if arguments.proof {
        written.proof.iter().for_each(output::mention);
    }
    Ok(Status::Same)
}

/// The first loss of each kind, and how many more there are of it.
fn kinds(losses: &[Loss]) -> Vec<(&Loss, usize)> {
    let mut found: Vec<(&Loss, usize)> = Vec::new();
    let kind = |loss: &Loss| (loss.what.split('=').next().unwrap_or_default().to_owned(), loss.why.clone());
    for loss in losses {
        match found.iter_mut().find(|(known, _)| kind(known) == kind(loss)) {
            Some((_, others)) => *others += 1,
            None => found.push((loss, 0)),
        }
    }
    found
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
