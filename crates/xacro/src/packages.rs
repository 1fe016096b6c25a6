//! Where ROS packages are, and what `package://`, `model://` and `file://` mean.

use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use crate::error::{did_you_mean, near};
use crate::files;

mod crawl;

pub use crawl::package_name;

/// Environment variables, as values: the library does not read the process's own.
///
/// ```
/// use denavit_xacro::Environment;
///
/// let environment: Environment = [("AMENT_PREFIX_PATH".to_owned(), "/opt/ros/jazzy".to_owned())].into_iter().collect();
/// assert_eq!(environment.get("AMENT_PREFIX_PATH"), Some("/opt/ros/jazzy"));
/// ```
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Environment {
    values: BTreeMap<String, String>,
    /// Variables that are set, but not to text.
    unreadable: BTreeSet<String>,
}

impl Environment {
    /// The value of a variable.
    pub fn get(&self, name: &str) -> Option<&str> {
        self.values.get(name).map(String::as_str)
    }

    /// The same with variables whose value is not UTF-8 text: a document that uses one is refused.
    #[must_use]
    pub fn with_unreadable(mut self, names: impl IntoIterator<Item = String>) -> Self {
        self.unreadable.extend(names);
        self
    }

    /// Whether a variable is set to a value that is not UTF-8 text.
    pub fn is_unreadable(&self, name: &str) -> bool {
        self.unreadable.contains(name)
    }

    pub(crate) fn names(&self) -> impl Iterator<Item = &str> {
        self.values.keys().map(String::as_str)
    }
}

impl FromIterator<(String, String)> for Environment {
    fn from_iter<T: IntoIterator<Item = (String, String)>>(variables: T) -> Self {
        Self { values: variables.into_iter().collect(), unreadable: BTreeSet::new() }
    }
}

/// Why a package or the file of a URI is not found.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum PackageError {
    /// No searched folder holds the package.
    #[error("package \"{name}\" is not found{}", looked_text(looked, near))]
    NotFound {
        /// The requested package.
        name: String,
        /// The searched folders, in order.
        looked: Vec<PathBuf>,
        /// Packages there with a name like it.
        near: Vec<String>,
    },
    /// Not the name of a package.
    #[error("\"{name}\" is not a package name; write letters, digits, \"_\" and \"-\" only")]
    Name {
        /// What was asked for.
        name: String,
    },
    /// A URI that does not refer to a file.
    #[error("\"{uri}\" does not refer to a file; write package://, file://, model:// or a path")]
    Uri {
        /// The URI.
        uri: String,
    },
}

fn looked_text(looked: &[PathBuf], near: &[String]) -> String {
    let mut text = String::new();
    if looked.is_empty() {
        text.push_str("; there are no folders to search");
    } else {
        let folders: Vec<String> = looked.iter().map(|folder| folder.display().to_string()).collect();
        text.push_str("; looked in ");
        text.push_str(&folders.join(", "));
    }
    text.push_str("; ");
    match did_you_mean(near) {
        Some(question) => text.push_str(&question),
        None => text.push_str("give the folder that holds it with ‹package-path›, or set ROS_PACKAGE_PATH"),
    }
    text
}

/// Folders in which packages are searched for, in order.
///
/// First the folders given by hand, then those around a file ([`PackagePath::near`]), then `AMENT_PREFIX_PATH`, then
/// `ROS_PACKAGE_PATH`, and for `model://` also `GAZEBO_MODEL_PATH` and `GZ_SIM_RESOURCE_PATH`. A package is a folder
/// with a `package.xml` that gives the name, or a folder of that name right below a folder given by hand. Where no
/// `package.xml` gives the name, it is a package whose folder has that name, or a folder above the file that has.
#[derive(Debug, Clone, Default)]
pub struct PackagePath {
    given: Vec<Root>,
    around: Vec<Root>,
    ament: Vec<Root>,
    ros: Vec<Root>,
    models: Vec<Root>,
    /// The folders above the file, the nearest first, as far as they belong to it.
    above: Vec<PathBuf>,
}

#[derive(Debug, Clone)]
struct Root {
    folder: PathBuf,
    /// How many folders deep packages are searched for.
    depth: usize,
    /// Whether a folder of the right name is enough, without a `package.xml`.
    by_folder_name: bool,
    /// The packages found below the folder: name and folder.
    packages: OnceLock<Vec<(String, PathBuf)>>,
}

impl Root {
    fn new(folder: impl Into<PathBuf>, depth: usize, by_folder_name: bool) -> Self {
        let folder = folder.into();
        let folder = files::absolute(&folder).unwrap_or(folder);
        Self { folder, depth, by_folder_name, packages: OnceLock::new() }
    }

    fn find(&self, name: &str) -> Option<PathBuf> {
        for direct in [self.folder.join(name), self.folder.join("share").join(name)] {
            let named = crawl::package_name(&direct);
            let fits = match &named {
                Some(named) => named == name,
                None => self.by_folder_name && files::is_folder(&direct),
            };
            if fits {
                return Some(direct);
            }
        }
        if self.by_folder_name && self.folder.file_name().is_some_and(|folder| folder == name) {
            return Some(self.folder.clone());
        }
        self.packages().iter().find(|(found, _)| found == name).map(|(_, folder)| folder.clone())
    }

    /// A package by the name of its folder, whatever name its `package.xml` gives.
    fn find_by_folder(&self, name: &str) -> Option<PathBuf> {
        let direct = [self.folder.clone(), self.folder.join(name), self.folder.join("share").join(name)];
        let direct = direct
            .into_iter()
            .find(|folder| folder.file_name().is_some_and(|own| own == name) && crawl::package_name(folder).is_some());
        let found = || self.packages().iter().map(|(_, folder)| folder.clone());
        direct.or_else(|| found().find(|folder| folder.file_name().is_some_and(|own| own == name)))
    }

    fn packages(&self) -> &[(String, PathBuf)] {
        self.packages.get_or_init(|| crawl::packages(&self.folder, self.depth))
    }
}

/// Source trees nest packages a few folders deep, installed ones right below `share`.
const SOURCE_DEPTH: usize = 5;
const INSTALLED_DEPTH: usize = 2;
/// Siblings of a file's package, and packages of the repository next to it.
const AROUND_DEPTH: usize = 2;
/// Folders above a file that may be its package, by their name alone.
const ABOVE_DEPTH: usize = 4;

impl PackagePath {
    /// Search folders from `--package-path` values and the variables named above.
    ///
    /// A folder may be a package, hold packages, or be an install prefix with a `share` folder.
    pub fn new(given: &[PathBuf], environment: &Environment) -> Self {
        let listed = |variable: &str, depth: usize, by_folder_name: bool| -> Vec<Root> {
            // Not every platform can split; none has to split nothing.
            let value = environment.get(variable).filter(|value| !value.is_empty());
            value
                .into_iter()
                .flat_map(std::env::split_paths)
                .filter(|folder| !folder.as_os_str().is_empty())
                .map(|folder| Root::new(folder, depth, by_folder_name))
                .collect()
        };
        let mut models = listed("GAZEBO_MODEL_PATH", 1, true);
        models.extend(listed("GZ_SIM_RESOURCE_PATH", 1, true));
        Self {
            given: given.iter().map(|folder| Root::new(folder, SOURCE_DEPTH, true)).collect(),
            around: Vec::new(),
            ament: listed("AMENT_PREFIX_PATH", INSTALLED_DEPTH, false),
            ros: listed("ROS_PACKAGE_PATH", SOURCE_DEPTH, false),
            models,
            above: Vec::new(),
        }
    }

    /// The same path with the packages around `file`: the one that it is in, found by walking up to a `package.xml`,
    /// and the packages beside that one.
    #[must_use]
    pub fn near(&self, file: &Path) -> Self {
        let mut path = self.clone();
        let absolute = files::absolute(file).unwrap_or_else(|_| file.to_owned());
        path.above = absolute.ancestors().skip(1).take(ABOVE_DEPTH).map(Path::to_path_buf).collect();
        let Some(package) = package_of(file) else { return path };
        path.around.push(Root::new(&package, 0, false));
        if let Some(parent) = package.parent() {
            path.around.push(Root::new(parent, AROUND_DEPTH, false));
        }
        path
    }

    /// The folder of a package.
    ///
    /// # Errors
    /// [`PackageError::NotFound`] with the searched folders; [`PackageError::Name`] for an invalid name.
    pub fn find(&self, name: &str) -> Result<PathBuf, PackageError> {
        self.find_in(name, &[], &[])
    }

    /// The file that a mesh's or texture's URI names. It need not exist.
    ///
    /// `package://name/path`, `model://name/path`, `file:///path`, an absolute path, or a path relative to the folder
    /// of `from`.
    ///
    /// # Errors
    /// As [`PackagePath::find`]; [`PackageError::Uri`] for other schemes.
    pub fn resolve(&self, uri: &str, from: Option<&Path>) -> Result<PathBuf, PackageError> {
        let wrong = || PackageError::Uri { uri: uri.to_owned() };
        let Some((scheme, rest)) = uri.split_once("://") else {
            let folder = from.and_then(Path::parent).unwrap_or(Path::new(""));
            return Ok(folder.join(uri));
        };
        let in_package = |models: &[Root]| {
            let (name, path) = rest.split_once('/').unwrap_or((rest, ""));
            let folder = self.find_in(name, models, &self.above)?;
            let path = path.trim_start_matches('/');
            let written = folder.join(path);
            Ok(if files::exists(&written) || !path.contains('%') { written } else { folder.join(decoded(path)) })
        };
        match scheme {
            "package" => in_package(&[]),
            "model" => in_package(&self.models),
            "file" => {
                let path = rest.strip_prefix("localhost").unwrap_or(rest);
                if !path.starts_with('/') {
                    return Err(wrong());
                }
                Ok(PathBuf::from(decoded(path)))
            }
            _ => Err(wrong()),
        }
    }

    /// Names of all visible packages, sorted.
    pub fn packages(&self) -> Vec<String> {
        let mut names: Vec<String> =
            self.roots().flat_map(|root| root.packages().iter().map(|(name, _)| name.clone())).collect();
        names.sort();
        names.dedup();
        names
    }

    fn roots(&self) -> impl Iterator<Item = &Root> {
        self.given.iter().chain(&self.around).chain(&self.ament).chain(&self.ros)
    }

    /// `above`: folders that are packages by their name alone. What they hold is shown, never read into a document.
    fn find_in(&self, name: &str, models: &[Root], above: &[PathBuf]) -> Result<PathBuf, PackageError> {
        let is_name = !name.is_empty()
            && name.chars().all(|c| c.is_alphanumeric() || "_-.+".contains(c))
            && !name.starts_with('.');
        if !is_name {
            return Err(PackageError::Name { name: name.to_owned() });
        }
        let roots = || self.roots().chain(models);
        if let Some(folder) = roots().find_map(|root| root.find(name)) {
            return Ok(folder);
        }
        // Files are also written against the folder that a package is in, where its `package.xml` has another name.
        let by_folder = || roots().find_map(|root| root.find_by_folder(name));
        if let Some(folder) = by_folder().or_else(|| above.iter().find(|folder| folder.ends_with(name)).cloned()) {
            return Ok(folder);
        }
        let mut looked: Vec<PathBuf> = Vec::new();
        for root in roots() {
            if !looked.contains(&root.folder) {
                looked.push(root.folder.clone());
            }
        }
        let names = self.packages();
        let near = near(name, &names);
        Err(PackageError::NotFound { name: name.to_owned(), looked, near })
    }
}

/// The folder of the package that `file` is in: the nearest one above with a `package.xml`.
pub(crate) fn package_of(file: &Path) -> Option<PathBuf> {
    let file = files::absolute(file).ok()?;
    let folder = file.ancestors().skip(1).find(|folder| files::is_file(&folder.join("package.xml")))?;
    Some(folder.to_path_buf())
}

/// A path with `%20` and the like written out.
fn decoded(path: &str) -> String {
    percent_encoding::percent_decode_str(path).decode_utf8().map_or_else(|_| path.to_owned(), Cow::into_owned)
}
