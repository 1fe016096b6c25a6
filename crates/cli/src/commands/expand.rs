//! `denavit expand`: xacro to URDF.

use crate::args::ExpandArguments;
use crate::delivery::Delivery;
use crate::failure::Failure;
use crate::output::Status;
use crate::source;

/// Runs the command.
pub fn run(arguments: &ExpandArguments) -> Result<Status, Failure> {
    let inputs = std::iter::once(arguments.file.as_str()).chain(arguments.source.files());
    let delivery = Delivery::plain(arguments.output.as_deref(), inputs)?;
    let (file, text) = source::read_text(&arguments.file)?;
    let urdf = source::expanded(&file, &text, &arguments.source)?;
    delivery.text(urdf)?;
    Ok(Status::Same)
}
