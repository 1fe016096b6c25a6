//! Kinematics of a URDF's longest chain as one file of C, or of another language: `c_of FILE [LANGUAGE] > arm.h`.

use denavit_code::{LANGUAGES, Options, Precision, code};
use denavit_dh::convert;
use denavit_model::{Reading, urdf};

#[expect(clippy::print_stdout, reason = "this is a program")]
fn main() -> Result<(), Box<dyn std::error::Error>> {
    let file = std::env::args().nth(1).ok_or("usage: c_of FILE [LANGUAGE]")?;
    let word = std::env::args().nth(2).unwrap_or_else(|| "c".into());
    let (language, ..) = LANGUAGES.into_iter().find(|it| it.1 == word).ok_or("no such language")?;
    let robot = urdf::read(&file, &std::fs::read_to_string(&file)?)?;
    let chain = robot.chain(None, None, Reading::Intended)?.value;
    let table = convert::table(&chain, &denavit_dh::Options::default())?.value;
    print!("{}", code(&table, Options { language, precision: Precision::Double })?);
    Ok(())
}
