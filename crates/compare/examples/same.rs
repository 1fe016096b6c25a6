//! Whether two URDFs are the same robot: `same A B`.

use denavit_compare::report::{Report, format};
use denavit_compare::{Options, Subject, compare};
use denavit_model::urdf;

#[expect(clippy::print_stdout, reason = "this is a program")]
fn main() -> Result<(), Box<dyn std::error::Error>> {
    let read = |at| -> Result<_, Box<dyn std::error::Error>> {
        let file: String = std::env::args().nth(at).ok_or("usage: same A B")?;
        Ok(urdf::read(&file, &std::fs::read_to_string(&file)?)?)
    };
    let (a, b) = (read(1)?, read(2)?);
    let found = compare(&Subject::Robot(&a), &Subject::Robot(&b), &Options::default())?;
    print!("{}", (format("text").ok_or("no such format")?.render)(&Report::Comparison(&found)));
    Ok(())
}
