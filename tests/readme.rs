//! The README shows what the commands print, and all documents together are short.

use crate::support::{denavit, own_files, top};
use std::fmt::Write;

/// Most words in the README.
const README_WORDS: usize = 900;
/// Most words in all documents together.
const ALL_WORDS: usize = 20_000;

#[test]
fn every_example_prints_what_the_readme_shows() {
    let text = std::fs::read_to_string(top().join("README.md")).unwrap();
    let mut examples = 0;
    for block in text.split("```console\n").skip(1) {
        let block = block.split("```").next().unwrap();
        let (command, shown) = block.split_once('\n').unwrap();
        let arguments: Vec<&str> = command.strip_prefix("$ denavit ").unwrap().split_whitespace().collect();
        let run = denavit(&arguments);
        assert!(run.code < 2, "{}", run.stderr);
        assert_eq!(run.stdout.trim_end(), shown.trim_end(), "{command}");
        examples += 1;
    }
    assert!(examples >= 3);
}

/// `cargo test -p denavit --test denavit the_documents_are_short -- --nocapture` prints the words of each document.
#[test]
fn the_documents_are_short() {
    let top = top();
    // All except sources of robots, notes on example data, and templates of pages.
    let found = own_files(&top, &[".md"], &["robots", "data", "templates", "shared"]);
    assert!(found.len() > 50, "{} documents", found.len());
    let mut counts: Vec<(usize, String)> = found
        .iter()
        .map(|path| {
            let text = std::fs::read_to_string(path).unwrap();
            // Lines of tables, dashes and signs do not count as words.
            let words = text.split_whitespace().filter(|word| word.contains(char::is_alphanumeric)).count();
            (words, path.strip_prefix(&top).unwrap().to_str().unwrap().to_owned())
        })
        .collect();
    counts.sort_unstable();
    counts.reverse();
    let all: usize = counts.iter().map(|(words, _)| words).sum();
    let mut list = format!("{all:>6} all\n");
    for (words, name) in &counts {
        writeln!(list, "{words:>6} {name}").unwrap();
    }
    println!("{list}");
    assert!(all <= ALL_WORDS, "{all} words, at most {ALL_WORDS}; say it once, and cut what --help says:\n{list}");
    let readme = counts.iter().find(|(_, name)| name == "README.md").unwrap().0;
    assert!(readme <= README_WORDS, "README.md has {readme} words, at most {README_WORDS}");
}
