//! The canonical URDF of any source.

use crate::{LoadError, Loaded};
use denavit_dh::Convention;
use denavit_export::urdf::{self, Options};
use denavit_model::formats::as_urdf;
use denavit_model::notes::Noted;

/// A tree's text with its link frames moved onto the D-H frames; a URDF made of a table or of screw axes.
///
/// # Errors
/// The robot cannot be written so; `file` is what messages call it.
pub fn canonical(robot: &Loaded, file: &str, options: &Options) -> Result<Noted<String>, LoadError> {
    robot.sound(file)?;
    let own = |value| Noted { value, notes: Vec::new() };
    Ok(match robot {
        Loaded::Robot(tree) => {
            let Noted { value, notes } = urdf::canonical(tree, options)?;
            // What was made of another format is a URDF of its own now.
            Noted { value: as_urdf(&value), notes }
        }
        Loaded::Table { table, convention, .. } => own(urdf::from_table(table, *convention)?),
        Loaded::Poe(chain) => {
            let failed = |source| LoadError::Chain { file: file.to_owned(), source };
            let made = denavit_dh::convert::table(chain, &denavit_dh::Options::default()).map_err(failed)?;
            Noted { value: urdf::from_table(&made.value, Convention::Distal)?, notes: made.notes }
        }
    })
}
