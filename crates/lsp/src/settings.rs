//! Settings of an editor's user.

use denavit_dh::Convention;
use denavit_load::{CheckOptions, Options};
use serde::Deserialize;
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Settings, as `initializationOptions` and `workspace/didChangeConfiguration` give them.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub(crate) struct Settings {
    /// `distal`, `proximal`, `paper` or `hayati`.
    convention: Option<String>,
    /// Arguments of xacro files, `name:=value`, by the name or the end of the path of the file; `*` applies to every file.
    xacro_arguments: BTreeMap<String, Words>,
    /// Folders with ROS packages, or packages.
    package_path: Vec<PathBuf>,
    /// Whether xacro may read files outside its package and the package path.
    allow_any_file: bool,
}

/// `["a:=1", "b:=2"]`, or `"a:=1 b:=2"`.
#[derive(Debug, Clone, Deserialize)]
#[serde(untagged)]
enum Words {
    List(Vec<String>),
    Line(String),
}

impl Settings {
    /// Reads an editor's settings, which may have a section `denavit` next to those of other programs.
    pub fn read(value: &Value) -> Result<Self, String> {
        let own = value.get("denavit").unwrap_or(value);
        if own.is_null() {
            return Ok(Self::default());
        }
        let settings: Self = serde_json::from_value(own.clone()).map_err(|error| format!("settings: {error}"))?;
        match settings.convention.as_deref() {
            Some(word) if convention(word).is_none() => {
                Err(format!("settings: convention \"{word}\" is not known; write distal, proximal, paper or hayati"))
            }
            _ => Ok(settings),
        }
    }

    /// The convention of Denavit-Hartenberg rows.
    pub fn convention(&self) -> Option<Convention> {
        convention(self.convention.as_deref()?)
    }

    /// The options for reading a file.
    pub fn options(&self, file: &Path) -> Options {
        let mut arguments: Vec<(String, String)> = Vec::new();
        for (name, words) in &self.xacro_arguments {
            if name != "*" && !file.ends_with(name) {
                continue;
            }
            let words: Vec<&str> = match words {
                Words::List(list) => list.iter().map(String::as_str).collect(),
                Words::Line(line) => line.split_whitespace().collect(),
            };
            for (name, value) in words.into_iter().filter_map(|word| word.split_once(":=")) {
                arguments.retain(|(known, _)| known != name);
                arguments.push((name.to_owned(), value.to_owned()));
            }
        }
        Options {
            arguments,
            arguments_for_another: true,
            package_path: self.package_path.clone(),
            allow_any_file: self.allow_any_file,
            ..Options::default()
        }
    }

    /// The options of the rules.
    pub fn check(&self) -> CheckOptions {
        CheckOptions { package_path: self.package_path.clone(), ..CheckOptions::default() }
    }
}

fn convention(word: &str) -> Option<Convention> {
    match word {
        "distal" => Some(Convention::Distal),
        "proximal" => Some(Convention::Proximal),
        "paper" => Some(Convention::Paper),
        "hayati" => Some(Convention::Hayati),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn arguments_are_those_of_every_file_and_then_those_of_its_name() {
        let sent = json!({"denavit": {"convention": "proximal", "xacroArguments": {"*": "a:=1 b:=2", "ur/arm.xacro": ["b:=3"]}}});
        let settings = Settings::read(&sent).unwrap();
        let of = |file: &str| settings.options(Path::new(file)).arguments;
        let pair = |name: &str, value: &str| (name.to_owned(), value.to_owned());
        assert_eq!(of("/x/arm.xacro"), [pair("a", "1"), pair("b", "2")]);
        assert_eq!(of("/x/ur/arm.xacro"), [pair("a", "1"), pair("b", "3")]);
        assert_eq!(settings.convention(), Some(Convention::Proximal));
        assert!(Settings::read(&json!({"convention": "craig"})).unwrap_err().contains("proximal"));
        assert!(Settings::read(&Value::Null).unwrap().convention().is_none());
    }
}
