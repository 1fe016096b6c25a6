//! Which rules count: the user's choice, from the command line or `denavit.toml` in the repository.

use crate::lint::{RULES, Rule, rule};
use crate::report::Level;
use denavit_model::problems::nearest_name;
use serde::Deserialize;
use std::collections::BTreeSet;
use thiserror::Error;

/// Name of the configuration file, looked for beside the robot and in the folders above.
pub const FILE_NAME: &str = "denavit.toml";

/// Rules that are left out, rules that make a check fail, and where packages are.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Config {
    /// Codes of rules that are not looked at.
    allow: BTreeSet<&'static str>,
    /// Codes of rules whose findings are errors.
    deny: BTreeSet<&'static str>,
    /// Folders that hold ROS packages, relative to the configuration file.
    pub package_path: Vec<String>,
}

/// What is wrong with a configuration.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum ConfigError {
    /// No rule has that code or name.
    #[error("there is no rule \"{name}\"{}", .near.as_ref().map_or_else(|| "; `denavit check ‹rules›` lists them".to_owned(), |near| format!("; did you mean \"{near}\"?")))]
    NoSuchRule {
        /// As written.
        name: String,
        /// The nearest name that exists.
        near: Option<&'static str>,
    },
    /// The file is not the TOML that is expected.
    #[error("{file}:{line}: {message}")]
    Toml {
        /// The file.
        file: String,
        /// Counted from 1.
        line: usize,
        /// What the parser says.
        message: String,
    },
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields, default, rename_all = "kebab-case")]
struct Written {
    check: WrittenCheck,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields, default, rename_all = "kebab-case")]
struct WrittenCheck {
    allow: Vec<String>,
    deny: Vec<String>,
    package_path: Vec<String>,
}

impl Config {
    /// From the text of a `denavit.toml`.
    ///
    /// # Errors
    /// It is not TOML, has unknown keys, or names a rule that does not exist.
    ///
    /// # Examples
    /// ```
    /// use denavit_compare::lint::{Config, rule};
    /// let config = Config::read("denavit.toml", "[check]\nallow = [\"rounded-pi\"]\ndeny = [\"D050\"]\n")?;
    /// assert_eq!(config.level_of(rule("D010").expect("it exists")), None);
    /// # Ok::<(), denavit_compare::lint::ConfigError>(())
    /// ```
    pub fn read(file: &str, text: &str) -> Result<Self, ConfigError> {
        let written: Written = toml::from_str(text).map_err(|error| {
            let at = error.span().map_or(0, |span| span.start);
            let line = 1 + text.get(..at).map_or(0, |before| before.matches('\n').count());
            ConfigError::Toml { file: file.to_owned(), line, message: error.message().to_owned() }
        })?;
        let mut config = Self { package_path: written.check.package_path, ..Self::default() };
        config.allow(&written.check.allow)?;
        config.deny(&written.check.deny)?;
        Ok(config)
    }

    /// Leaves rules out, by code or name; `all` leaves out all that are not denied.
    ///
    /// # Errors
    /// No rule has that code or name.
    pub fn allow(&mut self, rules: &[impl AsRef<str>]) -> Result<(), ConfigError> {
        for code in codes(rules)? {
            self.deny.remove(code);
            self.allow.insert(code);
        }
        Ok(())
    }

    /// Makes the findings of rules errors, by code or name; `all` stands for every rule.
    ///
    /// # Errors
    /// No rule has that code or name.
    pub fn deny(&mut self, rules: &[impl AsRef<str>]) -> Result<(), ConfigError> {
        for code in codes(rules)? {
            self.allow.remove(code);
            self.deny.insert(code);
        }
        Ok(())
    }

    /// How serious a rule's findings are; `None` where it is left out.
    pub fn level_of(&self, rule: &Rule) -> Option<Level> {
        if self.deny.contains(rule.code) {
            return Some(Level::Error);
        }
        (!self.allow.contains(rule.code)).then_some(rule.level)
    }
}

fn codes(rules: &[impl AsRef<str>]) -> Result<Vec<&'static str>, ConfigError> {
    let mut result = Vec::new();
    for name in rules.iter().map(AsRef::as_ref) {
        if name == "all" {
            result.extend(RULES.iter().map(|rule| rule.code));
            continue;
        }
        let found = rule(name).ok_or_else(|| ConfigError::NoSuchRule {
            name: name.to_owned(),
            near: nearest_name(name, RULES.iter().flat_map(|rule| [rule.name, rule.code])),
        })?;
        result.push(found.code);
    }
    Ok(result)
}
