//! Prints a MuJoCo model as URDF: `mjcf_to_urdf FILE`.

use std::path::Path;

#[expect(clippy::print_stdout, reason = "this is a program")]
fn main() -> Result<(), Box<dyn std::error::Error>> {
    let file = std::env::args().nth(1).ok_or("usage: mjcf_to_urdf FILE")?;
    // Included files and meshes are named relative to the model's folder.
    let folder = Path::new(&file).parent().unwrap_or(Path::new("")).to_owned();
    let mut files = |name: &str| std::fs::read(folder.join(name)).map_err(|error| format!("{name}: {error}"));
    print!("{}", denavit_mjcf::read(&file, &std::fs::read_to_string(&file)?, &mut files)?);
    Ok(())
}
