//! The canonical URDF of any source.

use crate::{LoadError, Loaded, Selection, TableOptions};
use denavit_dh::table::Row;
use denavit_dh::{Convention, Table};
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
            // A URDF made from another format is a source of its own now.
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

/// Whether the table of a URDF that [`canonical`] wrote is that of its source, each as `denavit table` prints it.
///
/// # Errors
/// One of the two has no table along this chain.
pub fn same_table(
    source: &Loaded,
    written: &str,
    selection: &Selection,
    options: &TableOptions,
) -> Result<bool, LoadError> {
    let written = crate::from_text("exported.urdf", written, &crate::Options::default())?.robot;
    let table = |robot: &Loaded| robot.table(selection, options).map(|made| made.table.value);
    Ok(same_numbers(&table(source)?, &table(&written)?))
}

/// Numbers of two tables that are closer than this, relative to 1 or their size, are one number.
const SAME_NUMBER: f64 = 1e-9;

fn same_numbers(a: &Table, b: &Table) -> bool {
    let near = |a: f64, b: f64| (a - b).abs() <= SAME_NUMBER * a.abs().max(1.0);
    a.rows.len() == b.rows.len()
        && a.rows.iter().zip(&b.rows).all(|rows| match rows {
            (Row::Dh(a), Row::Dh(b)) => {
                near(a.theta, b.theta) && near(a.d, b.d) && near(a.alpha, b.alpha) && near(a.a, b.a)
            }
            (a, b) => a == b,
        })
        && near(a.tool.theta, b.tool.theta)
        && near(a.tool.d, b.tool.d)
}
