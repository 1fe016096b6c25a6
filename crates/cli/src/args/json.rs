//! `--json [FILE]`, the same in every command.

use clap::Args;
use std::ffi::{OsStr, OsString};
use std::path::{Path, PathBuf};

/// JSON beside the text, or instead of it.
#[derive(Debug, Clone, Default, Args)]
pub struct JsonArguments {
    /// Print the result as JSON instead of the text, or write it to FILE beside the text. FILE ends in .json; any other name
    /// needs --json=FILE
    #[arg(id = "json", long = "json", value_name = "FILE", num_args = 0..=1, require_equals = true,
        default_missing_value = "-")]
    pub file: Option<PathBuf>,
}

impl JsonArguments {
    /// Where the JSON goes.
    pub fn place(&self) -> Option<&Path> {
        self.file.as_deref()
    }
}

/// The words of a command line with `--json FILE` as `--json=FILE`: the word after `--json` is its file if it ends in
/// `.json` or is `-`, so that a robot after it (`fk --json arm.urdf`) remains a robot and is never overwritten.
pub fn with_json_files_joined(words: impl IntoIterator<Item = OsString>) -> Vec<OsString> {
    let mut joined: Vec<OsString> = Vec::new();
    let mut plain = false;
    for word in words {
        let is_file = word == "-"
            || Path::new(&word).extension() == Some(OsStr::new("json")) && !word.to_string_lossy().starts_with('-');
        match joined.last_mut() {
            Some(last) if !plain && *last == "--json" && is_file => {
                last.push("=");
                last.push(word);
            }
            _ => {
                plain |= word == "--";
                joined.push(word);
            }
        }
    }
    joined
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_behind_json_is_its_file_and_a_robot_is_none() {
        let joined = |line: &str| {
            let words = with_json_files_joined(line.split(' ').map(OsString::from));
            words.iter().map(|word| word.to_string_lossy().into_owned()).collect::<Vec<_>>().join(" ")
        };
        assert_eq!(joined("fk --json arm.urdf --q 1"), "fk --json arm.urdf --q 1");
        assert_eq!(joined("fk arm.urdf --json out.json"), "fk arm.urdf --json=out.json");
        assert_eq!(joined("fk --json - arm.urdf"), "fk --json=- arm.urdf");
        assert_eq!(joined("fk --json --q 1"), "fk --json --q 1");
        assert_eq!(joined("check -- --json a.json"), "check -- --json a.json");
    }
}
