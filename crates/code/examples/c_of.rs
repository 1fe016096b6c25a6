//! Forward kinematics of a URDF's longest chain as one C file: `c_of FILE > arm.c`.

use denavit_code::{Language, Options, Precision, code};
use denavit_dh::convert;
use denavit_model::{Reading, urdf};

#[expect(clippy::print_stdout, reason = "this is a program")]
fn main() -> Result<(), Box<dyn std::error::Error>> {
    let file = std::env::args().nth(1).ok_or("usage: c_of FILE")?;
    let robot = urdf::read(&file, &std::fs::read_to_string(&file)?)?;
    let chain = robot.chain(None, None, Reading::Intended)?.value;
    let table = convert::table(&chain, &denavit_dh::Options::default())?.value;
    print!("{}", code(&table, Options { language: Language::C, precision: Precision::Double })?);
    Ok(())
}
