//! Mesh files to be copied, with the materials and pictures that they name, each at its place below one folder.

use super::{content_of, uris};
use crate::Options;
use crate::read::environment;
use crate::revision::Home;
use denavit_model::Robot;
use denavit_xacro::PackagePath;
use std::path::{Component, Path, PathBuf};

/// Kinds of mesh files that are copied.
const MESHES: [&str; 8] = ["stl", "dae", "obj", "glb", "ply", "off", "msh", "3mf"];

/// Kinds of files that a mesh names and that are copied beside it.
const BESIDE: [&str; 9] = ["mtl", "png", "jpg", "jpeg", "tga", "bmp", "tif", "tiff", "gif"];

/// A file to be written below the folder.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Copy {
    /// The name that the robot has for it; `None` for what a mesh names.
    pub uri: Option<String>,
    /// Where it goes: `PACKAGE/PATH` of a package's file, the path without `..` of others.
    pub place: PathBuf,
    /// Its content.
    pub bytes: Vec<u8>,
}

/// Everything to be written.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Copies {
    /// Each place once.
    pub files: Vec<Copy>,
    /// Meshes that are not there, and why.
    pub missing: Vec<(String, String)>,
    /// What meshes name and is not copied, and why: sentences.
    pub left: Vec<String>,
}

/// The meshes of the robot that was read from `file`, of at most `most` bytes each.
///
/// As of [`super::meshes`] only files of known endings are read.
pub fn copies(robot: &Robot, file: &str, options: &Options, most: u64) -> Copies {
    match Home::of(file) {
        Ok(home) => home.within(|| copies_of(robot, &home.path, options, most)),
        Err(why) => Copies {
            missing: uris(robot).into_iter().map(|uri| (uri.to_owned(), why.clone())).collect(),
            ..Copies::default()
        },
    }
}

fn copies_of(robot: &Robot, file: &Path, options: &Options, most: u64) -> Copies {
    let packages = PackagePath::new(&options.package_path, &environment()).near(file);
    let mut copies = Copies::default();
    for uri in uris(robot) {
        let path = packages.resolve(uri, Some(file)).map_err(|error| error.to_string());
        let read = path.and_then(|path| Ok((content_of(&path, most, &MESHES)?, path)));
        let (bytes, path) = match read {
            Ok(read) => read,
            Err(why) => {
                copies.missing.push((uri.to_owned(), why));
                continue;
            }
        };
        let place = copies.free(&place_of(uri), &bytes);
        copies.beside(&path, &place, &bytes, most);
        copies.files.push(Copy { uri: Some(uri.to_owned()), place, bytes });
    }
    copies
}

impl Copies {
    /// The place, with a number where another file has it.
    fn free(&self, place: &Path, bytes: &[u8]) -> PathBuf {
        let taken = |place: &Path| self.files.iter().any(|file| file.place == place && file.bytes != bytes);
        let numbered = |count: usize| {
            let stem = place.file_stem().unwrap_or_default().to_string_lossy();
            let ending = place.extension().unwrap_or_default().to_string_lossy();
            place.with_file_name(format!("{stem}_{count}.{ending}"))
        };
        let mut found = place.to_path_buf();
        let mut count = 2;
        while taken(&found) {
            found = numbered(count);
            count += 1;
        }
        found
    }

    /// What a file names, and what that names, to the same places beside its copy.
    fn beside(&mut self, path: &Path, place: &Path, bytes: &[u8], most: u64) {
        let folder = path.parent().unwrap_or(Path::new(""));
        for name in named(path, bytes) {
            let shown = path.display();
            let target = within(place.parent().unwrap_or(Path::new("")), &name);
            let Some(target) = target else {
                self.left.push(format!("{shown} names {name}, which is outside the folder; it is not copied"));
                continue;
            };
            match content_of(&folder.join(&name), most, &BESIDE) {
                Ok(_) if self.files.iter().any(|file| file.place == target) => {}
                Ok(content) => {
                    self.beside(&folder.join(&name), &target, &content, most);
                    self.files.push(Copy { uri: None, place: target, bytes: content });
                }
                Err(why) => self.left.push(format!("{shown} names {name}, which is not copied: {why}")),
            }
        }
    }
}

/// `PACKAGE/PATH` of a package's file; of a path what leads down.
fn place_of(uri: &str) -> PathBuf {
    let path = match uri.split_once("://") {
        Some(("file", path)) => Path::new(path).file_name().map_or(path, |name| name.to_str().unwrap_or(path)),
        Some((_, path)) => path,
        None if Path::new(uri).is_absolute() => {
            Path::new(uri).file_name().and_then(|name| name.to_str()).unwrap_or(uri)
        }
        None => uri,
    };
    Path::new(path).components().filter(|part| matches!(part, Component::Normal(_))).collect()
}

/// A path from a folder, where it stays below the top.
fn within(folder: &Path, name: &str) -> Option<PathBuf> {
    let mut place = folder.to_owned();
    for part in Path::new(name).components() {
        match part {
            Component::Normal(part) => place.push(part),
            Component::CurDir => {}
            Component::ParentDir => {
                if !place.pop() {
                    return None;
                }
            }
            Component::RootDir | Component::Prefix(_) => return None,
        }
    }
    Some(place)
}

/// Files that a mesh or a material names, each once.
fn named(path: &Path, bytes: &[u8]) -> Vec<String> {
    let ending = path.extension().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
    let text = String::from_utf8_lossy(bytes);
    let lines = || text.lines().map(str::trim);
    let found: Vec<String> = match ending.as_str() {
        "obj" => lines().filter_map(|line| line.strip_prefix("mtllib ")).map(|name| name.trim().to_owned()).collect(),
        // The name is the last word: options stand before it.
        "mtl" => lines()
            .filter(|line| line.starts_with("map_") || line.starts_with("bump ") || line.starts_with("disp "))
            .filter_map(|line| line.split_whitespace().last())
            .map(str::to_owned)
            .collect(),
        "dae" => pictures(&text),
        _ => Vec::new(),
    };
    let mut once: Vec<String> = Vec::new();
    for name in found {
        if !once.contains(&name) {
            once.push(name);
        }
    }
    once
}

/// `<init_from>` of a COLLADA file's images.
fn pictures(text: &str) -> Vec<String> {
    let options = roxmltree::ParsingOptions { allow_dtd: true, ..roxmltree::ParsingOptions::default() };
    let Ok(document) = roxmltree::Document::parse_with_options(text, options) else { return Vec::new() };
    let images = document.descendants().filter(|node| {
        node.tag_name().name() == "init_from" && node.ancestors().any(|above| above.tag_name().name() == "image")
    });
    let names =
        images.flat_map(|image| image.descendants().filter_map(|node| node.text().map(str::trim)).collect::<Vec<_>>());
    names.filter(|name| !name.is_empty()).map(|name| name.trim_start_matches("file://").to_owned()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_lead_down_and_stay_below_the_folder() {
        for (uri, place) in [
            ("package://arm/meshes/a.stl", "arm/meshes/a.stl"),
            ("../meshes/./a.stl", "meshes/a.stl"),
            ("file:///opt/a.stl", "a.stl"),
            ("/opt/a.stl", "a.stl"),
        ] {
            assert_eq!(place_of(uri), Path::new(place));
        }
        assert_eq!(within(Path::new("arm/meshes"), "../textures/a.png"), Some("arm/textures/a.png".into()));
        assert_eq!(within(Path::new("arm"), "../../a.png"), None);
        assert_eq!(named(Path::new("a.obj"), b"mtllib a.mtl\nv 0 0 0\nmtllib a.mtl"), ["a.mtl"]);
        assert_eq!(named(Path::new("a.mtl"), b"  map_Kd -s 1 1 1 a.png"), ["a.png"]);
        let text =
            "<COLLADA><image><init_from>a.png</init_from></image><surface><init_from>b</init_from></surface></COLLADA>";
        assert_eq!(named(Path::new("a.dae"), text.as_bytes()), ["a.png"]);
    }
}
