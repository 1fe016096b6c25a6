//! `denavit code`: the kinematics of one robot as source code.

use crate::args::{CodeArguments, LanguageName};
use crate::delivery::Delivery;
use crate::failure::Failure;
use crate::output::{self, Status};
use crate::source;
use denavit_code::{Language, Options, Precision, code};
use denavit_load::TableOptions;

/// Runs the command.
pub fn run(arguments: &CodeArguments) -> Result<Status, Failure> {
    let robot = &arguments.robot;
    let delivery = Delivery::plain(arguments.output.as_deref(), robot.files())?;
    let loaded = source::load(&robot.robot, &robot.source)?;
    let how = TableOptions { convention: None, gauge: None, tolerance: robot.tolerance };
    let made = loaded.table(&robot.selection(), &how)?;
    output::remark(&made.table.notes);
    let language = match arguments.lang {
        LanguageName::C => Language::C,
        LanguageName::Cpp => Language::Cpp,
        LanguageName::Rust => Language::Rust,
        LanguageName::Python => Language::Python,
        LanguageName::Matlab => Language::Matlab,
    };
    let precision = if arguments.single { Precision::Single } else { Precision::Double };
    let text = code(&made.table.value, Options { language, precision })
        .map_err(|source| Failure::Code { file: robot.robot.clone(), source })?;
    delivery.text(text)?;
    Ok(Status::Same)
}
