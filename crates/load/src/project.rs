//! `denavit.toml`: what a repository states of its robots.

use crate::{CheckError, read_text};
use denavit_compare::lint::{Config, ConfigError};
use denavit_xacro::files;
use serde::{Deserialize, Deserializer, de};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Name of the file, looked for beside a robot and in the folders above.
pub const FILE_NAME: &str = "denavit.toml";

/// What a `denavit.toml` states.
#[derive(Debug, Clone, Default, PartialEq)]
#[non_exhaustive]
pub struct Project {
    /// Which rules count.
    pub rules: Config,
    /// Folders with ROS packages, or packages; each with the folder of the file before it.
    pub package_path: Vec<PathBuf>,
    /// Known findings, with the folder of the file before it.
    pub baseline: Option<PathBuf>,
    /// Lengths closer than this are equal, m.
    pub tolerance_m: Option<f64>,
    /// Angles closer than this are equal, rad.
    pub tolerance_rad: Option<f64>,
    /// The robots of the repository, by name.
    pub robots: Vec<ProjectRobot>,
}

/// A robot that a `denavit.toml` names.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub struct ProjectRobot {
    /// Its name there.
    pub name: String,
    /// Its description, with the folder of the `denavit.toml` before it.
    pub file: PathBuf,
    /// Arguments of a xacro file, name and value.
    pub arguments: Vec<(String, String)>,
    /// Link that its chain starts at.
    pub base: Option<String>,
    /// Link that its chain ends at.
    pub tip: Option<String>,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields, default, rename_all = "kebab-case")]
struct Written {
    package_path: Vec<String>,
    baseline: Option<String>,
    // Version 0.1 called the table `check`.
    #[serde(alias = "check")]
    rules: WrittenRules,
    tolerance: WrittenTolerance,
    robots: BTreeMap<String, WrittenRobot>,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields, default, rename_all = "kebab-case")]
struct WrittenRules {
    allow: Vec<String>,
    deny: Vec<String>,
    // Where version 0.1 had it.
    package_path: Vec<String>,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields, default)]
struct WrittenTolerance {
    #[serde(deserialize_with = "tolerance")]
    m: Option<f64>,
    #[serde(deserialize_with = "tolerance")]
    rad: Option<f64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct WrittenRobot {
    file: String,
    #[serde(default)]
    arguments: BTreeMap<String, Argument>,
    base: Option<String>,
    tip: Option<String>,
}

/// A xacro argument: xacro reads every value as text.
struct Argument(String);

impl<'de> Deserialize<'de> for Argument {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        match toml::Value::deserialize(deserializer)? {
            toml::Value::String(text) => Ok(Self(text)),
            toml::Value::Integer(number) => Ok(Self(number.to_string())),
            toml::Value::Float(number) => Ok(Self(number.to_string())),
            toml::Value::Boolean(word) => Ok(Self(word.to_string())),
            _ => Err(de::Error::custom("an argument of a xacro file is a text, a number, true or false")),
        }
    }
}

fn tolerance<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<f64>, D::Error> {
    let value = f64::deserialize(deserializer)?;
    if value.is_finite() && value >= 0.0 {
        return Ok(Some(value));
    }
    Err(de::Error::custom(format!("a tolerance is a finite number, 0 or more, not {value}")))
}

impl Project {
    /// From the text of the file; `folder` is the one that its paths count from.
    ///
    /// # Errors
    /// It is not TOML, has unknown keys, or names a rule that does not exist.
    ///
    /// # Examples
    /// ```
    /// let text = "[rules]\nallow = ['rounded-pi']\n\n[robots.ur5e]\nfile = 'urdf/ur.urdf.xacro'\narguments = { ur_type = 'ur5e' }\n";
    /// let project = denavit_load::Project::read("denavit.toml", text, "robots".as_ref())?;
    /// assert_eq!(project.robots[0].file.to_str(), Some("robots/urdf/ur.urdf.xacro"));
    /// # Ok::<(), denavit_compare::lint::ConfigError>(())
    /// ```
    pub fn read(file: &str, text: &str, folder: &Path) -> Result<Self, ConfigError> {
        let written: Written = toml::from_str(text).map_err(|error| {
            let at = error.span().map_or(0, |span| span.start);
            let line = 1 + text.get(..at).map_or(0, |before| before.matches('\n').count());
            ConfigError::Toml { file: file.to_owned(), line, message: error.message().to_owned() }
        })?;
        let mut rules = Config::default();
        rules.allow(&written.rules.allow)?;
        rules.deny(&written.rules.deny)?;
        let packages = written.package_path.iter().chain(&written.rules.package_path);
        let robot = |(name, robot): (String, WrittenRobot)| ProjectRobot {
            name,
            file: folder.join(robot.file),
            arguments: robot.arguments.into_iter().map(|(name, Argument(value))| (name, value)).collect(),
            base: robot.base,
            tip: robot.tip,
        };
        Ok(Self {
            rules,
            package_path: packages.map(|package| folder.join(package)).collect(),
            baseline: written.baseline.map(|baseline| folder.join(baseline)),
            tolerance_m: written.tolerance.m,
            tolerance_rad: written.tolerance.rad,
            robots: written.robots.into_iter().map(robot).collect(),
        })
    }

    /// From a file; also `git:REVISION:PATH`, whose `folder` is that of the working tree.
    ///
    /// # Errors
    /// It cannot be read, or as [`Project::read`].
    pub fn open(name: &str, folder: &Path) -> Result<Self, CheckError> {
        let (name, text) = read_text(name)?;
        Ok(Self::read(&name, &text, folder)?)
    }

    /// The `denavit.toml` that holds for a robot's file or in a folder: beside it, or in a folder above.
    pub fn file_for(place: &Path) -> Option<PathBuf> {
        let place = files::canonical(place).ok()?;
        let own = usize::from(!files::is_folder(&place));
        place.ancestors().skip(own).map(|folder| folder.join(FILE_NAME)).find(|path| files::is_file(path))
    }

    /// What is stated for a robot's file or in a folder; nothing where there is no `denavit.toml`.
    ///
    /// # Errors
    /// As [`Project::open`].
    pub fn of(place: &Path) -> Result<Option<Self>, CheckError> {
        let Some(path) = Self::file_for(place) else { return Ok(None) };
        let folder = path.parent().unwrap_or(Path::new(".")).to_path_buf();
        Self::open(&path.to_string_lossy(), &folder).map(Some)
    }
}
