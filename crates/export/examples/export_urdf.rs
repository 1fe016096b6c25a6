//! Canonical URDFs, for tests in other languages: `export_urdf [--keep] [--mark] [--as-written] [--proximal] IN OUT [IN OUT …]`.
//!
//! For a file that cannot be converted it writes no OUT, but a line on standard error.

use denavit_export::urdf::{Frames, LinkFrames, Options, canonical};
use denavit_model::tree::Reading;
use std::process::ExitCode;

fn convert(input: &str, output: &str, options: &Options) -> Result<(), Box<dyn std::error::Error>> {
    let robot = denavit_model::urdf::read(input, &std::fs::read_to_string(input)?)?;
    std::fs::write(output, canonical(&robot, options)?.value)?;
    Ok(())
}

#[expect(clippy::print_stderr, reason = "this is a program")]
fn main() -> ExitCode {
    let (flags, files): (Vec<String>, Vec<String>) = std::env::args().skip(1).partition(|word| word.starts_with("--"));
    let mut options = Options::default();
    for flag in &flags {
        match flag.as_str() {
            "--keep" => options.link_frames = LinkFrames::Keep,
            "--mark" => options.link_frames = LinkFrames::MarkOnly,
            "--as-written" => options.reading = Reading::AsWritten,
            "--proximal" => options.frames = Frames::Proximal,
            _ => {
                eprintln!("{flag}: no such option");
                return ExitCode::from(2);
            }
        }
    }
    let mut code = ExitCode::SUCCESS;
    for pair in files.chunks(2) {
        let [input, output] = pair else { return ExitCode::from(2) };
        if let Err(error) = convert(input, output, &options) {
            eprintln!("{input}: {error}");
            code = ExitCode::from(2);
        }
    }
    code
}
