//! The Denavit-Hartenberg table of any source: `table FILE`.

use denavit_export::{Sheet, Units, formats};
use denavit_load::{NEARLY_PARALLEL, Options, Selection, TableOptions, load};

#[expect(clippy::print_stdout, reason = "this is a program")]
fn main() -> Result<(), Box<dyn std::error::Error>> {
    let file = std::env::args().nth(1).ok_or("usage: table FILE")?;
    let robot = load(&file, &Options::default())?.robot;
    let options = TableOptions { convention: None, gauge: None, tolerance: NEARLY_PARALLEL };
    let made = robot.table(&Selection { file: &file, ..Selection::default() }, &options)?;
    let sheet = Sheet {
        table: &made.table.value,
        notes: &made.table.notes,
        convention: made.convention,
        gauge: made.gauge,
        units: Units::default(),
        source: &file,
    };
    print!("{}", (formats::named("text").ok_or("no such format")?.render)(&sheet)?);
    Ok(())
}
