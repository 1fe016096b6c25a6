//! The pose of the tip of a URDF's longest chain with every joint at 0: `tip FILE`.

use denavit_model::{Reading, urdf};

#[expect(clippy::print_stdout, reason = "this is a program")]
fn main() -> Result<(), Box<dyn std::error::Error>> {
    let file = std::env::args().nth(1).ok_or("usage: tip FILE")?;
    let robot = urdf::read(&file, &std::fs::read_to_string(&file)?)?;
    let chain = robot.chain(None, None, Reading::Intended)?.value;
    let pose = chain.fk(&vec![0.0; chain.coordinates().len()]);
    println!("{} → {}: {:?} m", chain.base(), chain.tip(), pose.translation.vector.as_slice());
    Ok(())
}
