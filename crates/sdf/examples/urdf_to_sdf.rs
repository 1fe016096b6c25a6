//! Prints a URDF as SDF, and what is lost on standard error.

#![allow(clippy::print_stdout, clippy::print_stderr)] // A program.

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let file = std::env::args().nth(1).ok_or("name a URDF file")?;
    let robot = denavit_model::urdf::read(&file, &std::fs::read_to_string(&file)?)?;
    let written = denavit_sdf::write(&robot)?;
    for loss in &written.losses {
        eprintln!("{loss}");
    }
    println!("{}", written.text);
    Ok(())
}
