//! The rules for a file: its configuration, and the folders of its meshes.

use crate::read::environment;
use crate::revision::Home;
use crate::{LoadError, Project};
use denavit_compare::Finding;
use denavit_compare::lint::{self, Config, ConfigError, Lookup};
use denavit_model::{Inventory, Place, Robot};
use denavit_xacro::{PackageError, PackagePath, files};
use std::path::{Path, PathBuf};
use thiserror::Error;

/// What is chosen beside the configuration file.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct CheckOptions {
    /// Rules to leave out, by code or name.
    pub allow: Vec<String>,
    /// Rules whose findings are errors, by code or name.
    pub deny: Vec<String>,
    /// Configuration file; `None`: `denavit.toml` beside the robot or in a folder above.
    pub config: Option<PathBuf>,
    /// Folders with ROS packages, or packages, to find meshes in.
    pub package_path: Vec<PathBuf>,
}

/// Why a file cannot be compared with the rules.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum CheckError {
    /// The configuration cannot be read.
    #[error(transparent)]
    Load(#[from] LoadError),
    /// The configuration is invalid.
    #[error(transparent)]
    Config(#[from] ConfigError),
}

/// The rules for one file.
#[derive(Debug)]
pub struct Rules {
    config: Config,
    packages: PackagePath,
    home: Home,
}

impl Rules {
    /// The rules for the robot `file`, by its configuration and the options.
    ///
    /// # Errors
    /// The configuration cannot be read, or names a rule that does not exist.
    pub fn of(file: &str, options: &CheckOptions) -> Result<Self, CheckError> {
        let home = Home::of(file).map_err(|reason| LoadError::Read { file: file.to_owned(), reason })?;
        home.within(|| Self::at(&home, options))
    }

    fn at(home: &Home, options: &CheckOptions) -> Result<Self, CheckError> {
        let robot = home.path.as_path();
        let mut folders = options.package_path.clone();
        let mut config = Config::default();
        if let Some(path) = options.config.clone().or_else(|| Project::file_for(robot)) {
            let project = Project::open(&path.to_string_lossy(), path.parent().unwrap_or(Path::new(".")))?;
            folders.extend(project.package_path);
            config = project.rules;
        }
        config.allow(&options.allow)?;
        config.deny(&options.deny)?;
        let environment = environment();
        let packages = PackagePath::new(&folders, &environment).near(robot);
        Ok(Self { config, packages, home: home.clone() })
    }

    /// What the rules find in the text of `file`.
    pub fn check(&self, file: &str, text: &str) -> Vec<Finding> {
        self.check_and_read(file, text).0
    }

    /// As [`Rules::check`], with the robot, whose inventory says what became of everything in the file; `None` if it is not one.
    pub fn check_and_read(&self, file: &str, text: &str) -> (Vec<Finding>, Option<Robot>) {
        let lookup = |mesh: &str| match self.packages.resolve(mesh, Some(&self.home.path)) {
            Ok(path) if files::is_file(&path) => Lookup::Found,
            Ok(path) => Lookup::NotFound(self.home.shown_in(&format!("there is no file {}", path.display()))),
            Err(error @ PackageError::NotFound { .. }) => {
                let package = mesh.split("://").nth(1).and_then(|path| path.split('/').next()).unwrap_or(mesh);
                Lookup::NoPackage { package: package.to_owned(), why: error.to_string() }
            }
            Err(error) => Lookup::NotFound(error.to_string()),
        };
        self.home.within(|| lint::check_and_read(file, text, &lookup, &self.config))
    }

    /// What keeps a description in another format from being a robot, as findings.
    pub fn refused(&self, problems: &[(Place, String)]) -> Vec<Finding> {
        lint::refused(problems, &self.config)
    }

    /// What the rules find in an SRDF that belongs to a robot, and what became of everything in it.
    pub fn check_srdf(&self, file: &str, text: &str, robot: &Robot) -> (Vec<Finding>, Inventory) {
        lint::srdf::check(file, text, robot, &self.config)
    }
}
