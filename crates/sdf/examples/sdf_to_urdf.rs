//! Prints an SDF file as URDF; `model://NAME` is searched next to the file's folder.

#![allow(clippy::print_stdout)] // A program.

use std::path::{Path, PathBuf};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let file = std::env::args().nth(1).ok_or("name an SDF file")?;
    let text = std::fs::read_to_string(&file)?;
    let mut fetch = |uri: &str, from: &str| {
        let above = Path::new(from).parent().and_then(Path::parent).unwrap_or(Path::new(".."));
        let path: PathBuf = above.join(uri.trim_start_matches("model://")).join("model.sdf");
        let text = std::fs::read_to_string(&path).map_err(|error| error.to_string())?;
        Ok((path.display().to_string(), text))
    };
    let urdf = denavit_sdf::read(&file, &text, &mut fetch)?;
    let robot = denavit_model::urdf::read(&file, &urdf)?;
    for note in &robot.notes {
        println!("<!-- {} -->", note.to_string().replace("--", "- -"));
    }
    println!("{}", denavit_model::formats::as_urdf(&urdf));
    Ok(())
}
