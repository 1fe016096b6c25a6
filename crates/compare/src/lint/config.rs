//! Which rules count: the user's choice, from the command line or the repository's `denavit.toml`.

use crate::lint::{RULES, Rule, rule};
use crate::report::Level;
use denavit_model::problems::nearest_name;
use std::collections::BTreeSet;
use thiserror::Error;

/// Rules that are left out, and rules that make a check fail.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Config {
    /// Codes of rules that are not checked.
    allow: BTreeSet<&'static str>,
    /// Codes of rules whose findings are errors.
    deny: BTreeSet<&'static str>,
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

impl Config {
    /// Disables rules, by code or name; `all` disables all that are not denied.
    ///
    /// # Errors
    /// No rule has that code or name.
    ///
    /// # Examples
    /// ```
    /// use denavit_compare::lint::{Config, rule};
    /// let mut config = Config::default();
    /// config.allow(&["rounded-pi"])?;
    /// assert_eq!(config.level_of(rule("D010").expect("it exists")), None);
    /// # Ok::<(), denavit_compare::lint::ConfigError>(())
    /// ```
    pub fn allow(&mut self, rules: &[impl AsRef<str>]) -> Result<(), ConfigError> {
        for code in codes(rules)? {
            self.deny.remove(code);
            self.allow.insert(code);
        }
        Ok(())
    }

    /// Makes the findings of rules errors, by code or name; `all` means every rule.
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
