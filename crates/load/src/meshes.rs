//! The mesh files that a robot's shapes name.

mod collada;
mod copied;

pub use copied::{Copies, Copy, copies};

use crate::Options;
use crate::read::environment;
use crate::revision::Home;
use denavit_model::Robot;
use denavit_model::nalgebra::Vector3;
use denavit_model::robot::Geometry;
use denavit_xacro::{PackagePath, files};
use std::path::Path;

/// What a viewer of meshes can show.
const ENDINGS: [&str; 3] = ["stl", "dae", "obj"];

/// A mesh as its robot names it, and its file's content.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MeshFile {
    /// As the robot writes it: `package://…`, `file://…` or a path.
    pub uri: String,
    /// What the file holds.
    pub bytes: Vec<u8>,
}

/// Meshes of a robot, each named once.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Meshes {
    /// Those that are there, in the order of the robot.
    pub found: Vec<MeshFile>,
    /// Those that are not, and why.
    pub missing: Vec<(String, String)>,
}

/// The meshes of the robot that was read from `file`, of at most `most` bytes together.
///
/// Only files that end in `.stl`, `.dae` or `.obj`, after links are followed, are read: a robot's text must not disclose other
/// files of the reader. For a robot of a revision in git, the files of that revision are read.
pub fn meshes(robot: &Robot, file: &str, options: &Options, most: u64) -> Meshes {
    match Home::of(file) {
        Ok(home) => home.within(|| meshes_of(robot, &home.path, options, most)),
        Err(why) => {
            let missing = uris(robot).into_iter().map(|uri| (uri.to_owned(), why.clone())).collect();
            Meshes { found: Vec::new(), missing }
        }
    }
}

/// The triangles that a mesh file holds, in its own frame, m: STL, OBJ, COLLADA, by its name's ending.
///
/// # Errors
/// Another kind of file, or one that does not hold what it should; a sentence.
pub fn triangles(name: &str, bytes: &[u8]) -> Result<Vec<[Vector3<f64>; 3]>, String> {
    let ending = name.rsplit('.').next().unwrap_or_default().to_ascii_lowercase();
    match ending.as_str() {
        "stl" | "obj" => return denavit_mjcf::mesh_triangles(name, bytes),
        "dae" => {}
        _ => return Err(format!("a .{ending} file cannot be read; use .stl, .obj or .dae")),
    }
    let found = collada::triangles(bytes)?;
    if found.is_empty() { Err("it has no triangles".into()) } else { Ok(found) }
}

fn meshes_of(robot: &Robot, file: &Path, options: &Options, most: u64) -> Meshes {
    let packages = PackagePath::new(&options.package_path, &environment()).near(file);
    let mut meshes = Meshes::default();
    let mut left = most;
    for uri in uris(robot) {
        let read = packages.resolve(uri, Some(file)).map_err(|error| error.to_string());
        match read.and_then(|path| content(&path, left)) {
            Ok(bytes) => {
                left = left.saturating_sub(bytes.len() as u64);
                meshes.found.push(MeshFile { uri: uri.to_owned(), bytes });
            }
            Err(why) => meshes.missing.push((uri.to_owned(), why)),
        }
    }
    meshes
}

fn uris(robot: &Robot) -> Vec<&str> {
    let shapes = robot.links.iter().flat_map(|link| link.visuals.iter().chain(&link.collisions));
    let mut uris: Vec<&str> = Vec::new();
    for shape in shapes {
        if let Geometry::Mesh { filename, .. } = &shape.geometry
            && !uris.contains(&filename.as_str())
        {
            uris.push(filename);
        }
    }
    uris
}

fn content(path: &Path, most: u64) -> Result<Vec<u8>, String> {
    content_of(path, most, &ENDINGS)
}

/// The content of a file that is called by one of these endings when links are followed.
fn content_of(path: &Path, most: u64, endings: &[&str]) -> Result<Vec<u8>, String> {
    let shown = path.display();
    let real = files::canonical(path).map_err(|_| format!("there is no file {shown}"))?;
    let ending = real.extension().map(|ending| ending.to_string_lossy().to_ascii_lowercase());
    if !ending.is_some_and(|ending| endings.contains(&ending.as_str())) {
        return Err(format!("{shown} does not end in one of .{}", endings.join(", .")));
    }
    let Some(size) = files::size(&real).map_err(|error| format!("{shown}: {error}"))? else {
        return Err(format!("{shown} is not a file"));
    };
    if size > most {
        return Err(format!("{shown} has {} MB, and all meshes together are too many", size >> 20));
    }
    let bytes = files::read(&real).map_err(|error| format!("{shown}: {error}"))?;
    if bytes.starts_with(b"version https://git-lfs") {
        return Err(format!("{shown} is a pointer of git LFS, not the file itself; fetch it with git lfs pull"));
    }
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Loaded, from_text};
    use std::path::PathBuf;

    const ARM: &str = r#"<robot name="arm"><link name="a">
        <visual><geometry><mesh filename="meshes/a.stl"/></geometry></visual>
        <visual><geometry><mesh filename="package://arm_description/meshes/b.dae"/></geometry></visual>
        <visual><geometry><mesh filename="secret.txt"/></geometry></visual>
        <visual><geometry><mesh filename="meshes/linked.stl"/></geometry></visual>
        <visual><geometry><mesh filename="meshes/gone.obj"/></geometry></visual>
        <collision><geometry><mesh filename="meshes/a.stl"/></geometry></collision></link></robot>"#;

    fn folder(name: &str) -> PathBuf {
        let folder = std::env::temp_dir().join(format!("denavit-meshes-{name}-{}", std::process::id()));
        let _ = std::fs::remove_dir_all(&folder);
        std::fs::create_dir_all(folder.join("meshes")).unwrap();
        let write = |name: &str, text: &str| std::fs::write(folder.join(name), text).unwrap();
        write("package.xml", "<package><name>arm_description</name></package>");
        write("meshes/a.stl", "solid a");
        write("meshes/b.dae", "<COLLADA/>");
        write("secret.txt", "nobody's business");
        #[cfg(unix)]
        std::os::unix::fs::symlink(folder.join("secret.txt"), folder.join("meshes/linked.stl")).unwrap();
        folder
    }

    fn of(folder: &Path, most: u64) -> Meshes {
        let Loaded::Robot(robot) = from_text("arm.urdf", ARM, &Options::default()).unwrap().robot else {
            unreachable!("a URDF is a robot")
        };
        meshes(&robot, &folder.join("arm.urdf").to_string_lossy(), &Options::default(), most)
    }

    #[test]
    fn meshes_are_found_beside_the_robot_and_in_packages_and_nothing_else_is_read() {
        let folder = folder("found");
        let meshes = of(&folder, 1000);
        let found: Vec<&str> = meshes.found.iter().map(|mesh| mesh.uri.as_str()).collect();
        assert_eq!(found, ["meshes/a.stl", "package://arm_description/meshes/b.dae"]);
        assert_eq!(meshes.found[0].bytes, b"solid a");
        let missing: Vec<&str> = meshes.missing.iter().map(|(uri, _)| uri.as_str()).collect();
        assert_eq!(missing, ["secret.txt", "meshes/linked.stl", "meshes/gone.obj"]);
        std::fs::remove_dir_all(folder).unwrap();
    }

    #[test]
    fn there_is_a_bound_on_all_of_them_together() {
        let folder = folder("bound");
        let meshes = of(&folder, 10);
        assert_eq!(meshes.found.len(), 1, "{meshes:?}");
        assert!(meshes.missing.iter().any(|(_, why)| why.contains("too many")), "{meshes:?}");
        std::fs::remove_dir_all(folder).unwrap();
    }
}
