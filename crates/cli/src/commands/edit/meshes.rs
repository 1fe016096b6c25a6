//! The mesh files of an edited robot: what they hold, where copies and hulls go, and what the text calls them there.

use crate::args::SourceArguments;
use crate::failure::Failure;
use crate::output;
use crate::source;
use denavit_edit::{Meshes, Text, Words};
use std::collections::BTreeMap;
use std::path::{Component, Path, PathBuf};

/// Meshes of more bytes than this are not read.
const MOST: u64 = 1 << 30;

/// What is written beside the robot, and what is known of its meshes, over several operations.
#[derive(Default)]
pub(super) struct MeshFiles {
    /// Robots whose meshes may be asked for.
    pub robots: Vec<Text>,
    /// By the names that the text has for them.
    known: Option<Meshes>,
    /// Copies, and where they go.
    pub copies: Vec<(PathBuf, Vec<u8>)>,
    /// For hulls: what stands before their names, and the folder that they go to.
    folders: Vec<(String, PathBuf)>,
}

impl MeshFiles {
    /// Of the robot that is edited.
    pub fn of(robot: Text) -> Self {
        Self { robots: vec![robot], ..Self::default() }
    }

    /// Gives an operation what it needs of the meshes.
    pub fn prepare(&mut self, words: &mut Words, place: &Path, source: &SourceArguments) -> Result<(), Failure> {
        if words.takes_meshes() {
            words.meshes = self.known(source)?.clone();
        }
        let Some(folder) = words.to.clone().map(PathBuf::from) else { return Ok(()) };
        if words.takes_meshes() || words.copies_meshes() {
            output::OutputFolder::of(&folder)?;
            let prefix = prefix(&folder, place)?;
            self.folders.push((prefix.clone(), folder.clone()));
            words.folder = Some(prefix);
        }
        if words.copies_meshes() {
            words.copies = self.copied(&folder, &words.folder.clone().unwrap_or_default(), source)?;
        }
        Ok(())
    }

    /// Where a new mesh goes, by its name in the text.
    pub fn place(&self, uri: &str) -> Option<PathBuf> {
        self.folders.iter().find_map(|(prefix, folder)| Some(folder.join(uri.strip_prefix(prefix.as_str())?)))
    }

    fn known(&mut self, source: &SourceArguments) -> Result<&mut Meshes, Failure> {
        let options = source::options(source)?;
        if self.known.is_none() {
            let mut known = Meshes::new();
            for text in &self.robots {
                let robot = denavit_edit::robot_of(text)?;
                let meshes = denavit_load::meshes(&robot, &text.file, &options, MOST);
                for mesh in meshes.found {
                    known.insert(mesh.uri.clone(), denavit_load::triangles(&mesh.uri, &mesh.bytes));
                }
                known.extend(meshes.missing.into_iter().map(|(uri, why)| (uri, Err(why))));
            }
            self.known = Some(known);
        }
        Ok(self.known.get_or_insert_default())
    }

    /// New names by the old ones; the copies are kept for later.
    fn copied(
        &mut self,
        folder: &Path,
        prefix: &str,
        source: &SourceArguments,
    ) -> Result<BTreeMap<String, String>, Failure> {
        let options = source::options(source)?;
        let mut names = BTreeMap::new();
        let mut beside = 0;
        for text in self.robots.clone() {
            let robot = denavit_edit::robot_of(&text)?;
            let copies = denavit_load::copies(&robot, &text.file, &options, MOST);
            if let Some((uri, why)) = copies.missing.first() {
                return Err(Failure::Argument(format!(
                    "{}: mesh \"{uri}\": {why} (missing meshes: {})",
                    text.file,
                    copies.missing.len()
                )));
            }
            copies.left.iter().for_each(output::mention);
            for copy in copies.files {
                match copy.uri {
                    Some(uri) => {
                        names.insert(uri, format!("{prefix}{}", slashes(&copy.place)));
                    }
                    None => beside += 1,
                }
                self.copies.push((folder.join(&copy.place), copy.bytes));
            }
        }
        if names.is_empty() {
            return Err(Failure::Argument("meshes: the robot has no mesh files".into()));
        }
        let with = if beside == 0 { String::new() } else { format!(", with {beside} files that they refer to") };
        output::mention(format!("{} mesh files go to {}{with}", names.len(), folder.display()));
        // A later operation knows them by their new names.
        let known = self.known(source)?;
        let again: Vec<_> =
            names.iter().filter_map(|(old, new)| Some((new.clone(), known.get(old)?.clone()))).collect();
        known.extend(again);
        Ok(names)
    }
}

/// What stands before the name of a file in `folder`: `package://NAME/…/` where the folder is in a ROS package, or the way from the
/// folder of the edited robot.
fn prefix(folder: &Path, robot: &Path) -> Result<String, Failure> {
    let folder = real(folder)?;
    for package in folder.ancestors() {
        let Some(name) = denavit_load::package_name(package) else { continue };
        let rest = folder.strip_prefix(package).unwrap_or(Path::new(""));
        let rest = slashes(rest);
        return Ok(if rest.is_empty() { format!("package://{name}/") } else { format!("package://{name}/{rest}/") });
    }
    let from = if robot == Path::new("-") { Path::new(".") } else { robot.parent().unwrap_or(Path::new("")) };
    let from = real(if from.as_os_str().is_empty() { Path::new(".") } else { from })?;
    let shared = from.components().zip(folder.components()).take_while(|(a, b)| a == b).count();
    let up = from.components().skip(shared).map(|_| Component::ParentDir);
    let way: PathBuf = up.chain(folder.components().skip(shared)).collect();
    let way = slashes(&way);
    Ok(if way.is_empty() { way } else { way + "/" })
}

fn slashes(path: &Path) -> String {
    path.components().map(|part| part.as_os_str().to_string_lossy().into_owned()).collect::<Vec<_>>().join("/")
}

/// A folder with links followed, as far as it is there.
fn real(folder: &Path) -> Result<PathBuf, Failure> {
    let failed =
        |error: std::io::Error| Failure::Write { file: folder.display().to_string(), reason: error.to_string() };
    let whole = std::path::absolute(folder).map_err(failed)?;
    let there = whole.ancestors().find(|above| above.exists()).unwrap_or(Path::new("/"));
    let rest = whole.strip_prefix(there).unwrap_or(Path::new("")).to_owned();
    Ok(there.canonicalize().map_err(failed)?.join(rest))
}
