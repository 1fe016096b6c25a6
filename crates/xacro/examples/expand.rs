//! Expands a xacro file: `expand FILE [--package-path FOLDER]… [--allow-any-file] [name:=value]…`

#![allow(clippy::print_stdout, clippy::print_stderr, reason = "a program")]

use std::path::PathBuf;
use std::process::ExitCode;

use denavit_xacro::{Environment, FileAccess, Options, PackagePath, Source, expand};

fn main() -> ExitCode {
    let mut folders: Vec<PathBuf> = Vec::new();
    let mut arguments = Vec::new();
    let mut file = None;
    let mut access = FileAccess::default();
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        if word == "--package-path" {
            folders.extend(words.next().map(PathBuf::from));
        } else if word == "--allow-any-file" {
            access = FileAccess::Any;
        } else if let Some((name, value)) = word.split_once(":=") {
            arguments.push((name.to_owned(), value.to_owned()));
        } else {
            file = Some(word);
        }
    }
    let Some(file) = file else {
        eprintln!("usage: expand FILE [--package-path FOLDER]… [--allow-any-file] [name:=value]…");
        return ExitCode::from(2);
    };
    let environment: Environment = std::env::vars().collect();
    let options =
        Options { packages: PackagePath::new(&folders, &environment), environment, access, ..Options::default() };
    match expand(&Source::path(file), &arguments, &options) {
        Ok(expanded) => {
            for note in &expanded.notes {
                eprintln!("note: {note}");
            }
            print!("{}", expanded.urdf);
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("{error}");
            ExitCode::from(2)
        }
    }
}
