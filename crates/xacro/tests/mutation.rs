//! A small fuzz run on the stable toolchain: seeded changes of the fixtures neither panic nor run for ever.

use std::time::{Duration, Instant};

use denavit_xacro::{ErrorKind, Limits, Options, Source, expand, is_xacro};

use crate::seeded::{Random, mutated};
use crate::support::fixtures;

/// Words that matter to the reader.
const WORDS: &[&str] = &[
    "${",
    "}",
    "$(",
    ")",
    "$$",
    "xacro:",
    "<xacro:if value=\"",
    "<xacro:insert_block name=\"",
    "'",
    "\"",
    "[",
    "]",
    "(",
    "**",
    "//",
    "%",
    " if ",
    " else ",
    " for ",
    " in ",
    "lambda x: ",
    "not ",
    "-",
    "9999999999",
    "1e308",
    "0",
    "\u{e4}",
    "\u{1f600}",
    "range(",
    "load_yaml(",
    "$(find ",
    "$(arg ",
    "$(eval ",
    ":=",
    "^|",
    "*",
    "<!--",
    "-->",
    "<![CDATA[",
    "&#0;",
    "&lt;",
    "\n",
    ".",
    ".format(",
    "%s",
    "{:>99999}",
    "!degrees ",
];

fn changed(seeds: &[String], random: &mut Random) -> String {
    let seeds: Vec<&str> = seeds.iter().map(String::as_str).collect();
    String::from_utf8_lossy(&mutated(&seeds, WORDS, 3, random)).into_owned()
}

fn small() -> Limits {
    Limits { nodes: 10_000, bytes: 1 << 20, steps: 200_000, ..Limits::default() }
}

fn seeds(folder: &str, extension: &str) -> Vec<String> {
    let mut files: Vec<_> =
        std::fs::read_dir(fixtures().join(folder)).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.retain(|file| file.extension().is_some_and(|known| known == extension));
    files.sort();
    files.iter().map(|file| std::fs::read_to_string(file).unwrap()).collect()
}

/// What became of a text: `None` for a document, else the kind of error.
fn outcome(text: &str) -> Option<ErrorKind> {
    let source = Source::Text {
        name: "mutated.xacro".to_owned(),
        text: text.to_owned(),
        folder: Some(fixtures().join("features")),
    };
    let start = Instant::now();
    let _ = is_xacro(text);
    let result = expand(&source, &[], &Options { limits: small(), ..Options::default() });
    assert!(start.elapsed() < Duration::from_secs(20), "{:?} for {text}", start.elapsed());
    match result {
        Ok(expanded) => {
            roxmltree::Document::parse(&expanded.urdf)
                .unwrap_or_else(|error| panic!("{error}\n{}\nfrom\n{text}", expanded.urdf));
            None
        }
        Err(error) => {
            assert!(!error.to_string().is_empty());
            Some(error.kind)
        }
    }
}

#[test]
fn mutated_documents_give_a_document_or_an_error() {
    let seeds = seeds("features", "xacro");
    let mut random = Random(8);
    let rounds = 3000;
    let outcomes: Vec<_> = (0..rounds).map(|_| outcome(&changed(&seeds, &mut random))).collect();
    let read = outcomes.iter().filter(|outcome| **outcome != Some(ErrorKind::Xml)).count();
    let good = outcomes.iter().filter(|outcome| outcome.is_none()).count();
    println!("of {rounds} mutated documents {read} are XML and {good} expand");
    assert!(read > rounds / 5 && good > rounds / 50, "{read} {good}: only the XML reader is tested");
}

#[test]
fn mutated_expressions_give_a_value_or_an_error() {
    let mut expressions = Vec::new();
    for document in seeds("features", "xacro") {
        expressions.extend(
            document.split("${").skip(1).filter_map(|part| part.split_once('}')).map(|(inner, _)| inner.to_owned()),
        );
    }
    expressions.retain(|inner| !inner.is_empty());
    let mut random = Random(88);
    let rounds = 6000;
    let outcomes: Vec<_> = (0..rounds)
        .map(|_| {
            let inner = changed(&expressions, &mut random).replace('\'', "\"").replace(['<', '&', '}'], " ");
            outcome(&crate::support::robot(&format!("<a b='${{{}}}'/>", inner.replace('"', "&quot;"))))
        })
        .collect();
    let read = outcomes.iter().filter(|outcome| **outcome != Some(ErrorKind::Syntax)).count();
    let good = outcomes.iter().filter(|outcome| outcome.is_none()).count();
    println!("of {rounds} mutated expressions {read} can be read and {good} have a value");
    assert!(read > rounds / 5 && good > rounds / 50, "{read} {good}: only the parser is tested");
}
