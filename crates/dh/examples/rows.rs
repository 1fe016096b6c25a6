//! The Denavit-Hartenberg rows of an arm given by its screw axes.

use denavit_dh::{Convention, Options, convert};
use denavit_model::examples;

#[expect(clippy::print_stdout, reason = "this is a program")]
fn main() -> Result<(), Box<dyn std::error::Error>> {
    let table = convert::table(&examples::puma_like(), &Options::default())?.value;
    for row in table.convention_rows(Convention::Distal) {
        println!("{row:?}");
    }
    Ok(())
}
