//! Reverses the sense of a joint, with a proof, and prints the diff: `flip FILE JOINT`.

use denavit_edit::{Files, Operation, apply, unified_diff};

#[expect(clippy::print_stdout, reason = "this is a program")]
fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut words = std::env::args().skip(1);
    let (Some(file), Some(joint)) = (words.next(), words.next()) else { return Err("usage: flip FILE JOINT".into()) };
    let files = Files::urdf(&*file, std::fs::read_to_string(&file)?);
    let done = apply(&files, &[Operation::Flip { joint }])?;
    print!("{}", unified_diff(&files.urdf, &done.files.urdf));
    Ok(())
}
