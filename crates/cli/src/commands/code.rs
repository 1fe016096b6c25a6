//! `denavit code`: the kinematics of one robot as source code.

#[cfg(feature = "calibrate")]
mod effects;

use crate::args::{CodeArguments, LanguageName};
use crate::delivery::Delivery;
use crate::failure::Failure;
#[cfg(feature = "calibrate")]
use crate::measured;
use crate::output::{self, Status};
use crate::source;
#[cfg(feature = "calibrate")]
use denavit_code::code_with_effects;
use denavit_code::{Language, Options, Precision, code};
use denavit_load::TableOptions;
#[cfg(feature = "calibrate")]
use denavit_load::measured::{taken_at_averages, without_part_in_the_tip};

/// Runs the command.
pub fn run(arguments: &CodeArguments) -> Result<Status, Failure> {
    let robot = &arguments.robot;
    if arguments.effects.is_none() && !arguments.given.given.is_empty() {
        return Err(Failure::Argument("--given sets quantities that effects follow; it needs --effects".into()));
    }
    let inputs = robot.files().chain(arguments.effects.as_deref());
    let delivery = Delivery::plain(arguments.output.as_deref(), inputs)?;
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
    let options = Options { language, precision };
    let table = &made.table.value;
    let text = match &arguments.effects {
        None => code(table, options),
        #[cfg(not(feature = "calibrate"))]
        Some(_) => return Err(Failure::not_built("calibrate")),
        #[cfg(feature = "calibrate")]
        Some(file) => code_with_effects(table, &correction(arguments, file, &loaded)?, options),
    };
    let text = text.map_err(|source| Failure::Code { file: robot.robot.clone(), source })?;
    delivery.text(text)?;
    Ok(Status::Same)
}

/// The effects of a file, as code has them.
#[cfg(feature = "calibrate")]
fn correction(
    arguments: &CodeArguments,
    file: &str,
    loaded: &source::Loaded,
) -> Result<denavit_code::effects::Effects, Failure> {
    let selection = arguments.robot.selection();
    let chain = loaded.chain(&selection)?.value;
    let saved = measured::effects(Some(file), &loaded.statics(&chain, selection.reading))?;
    let given = measured::given(&arguments.given)?;
    taken_at_averages(file, &saved, &given).iter().for_each(output::mention);
    measured::mention(&without_part_in_the_tip(file, &saved));
    effects::of(file, &saved, &chain, &given)
}
