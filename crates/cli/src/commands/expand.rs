//! `denavit expand`: xacro to URDF.

use crate::args::ExpandArguments;
use crate::failure::Failure;
use crate::output::Status;
use crate::source;

/// Runs the command.
pub fn run(arguments: &ExpandArguments) -> Result<Status, Failure> {
    let (file, text) = source::read_text(&arguments.file)?;
    let urdf = source::expanded(&file, &text, &arguments.source)?;
    super::deliver(arguments.output.as_deref(), &urdf)?;
    Ok(Status::Same)
}
