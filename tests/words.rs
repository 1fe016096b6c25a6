//! House rule: plain words. Documents, messages, help and doc comments do not use the phrases below.

use crate::support::{own_files, top};
use std::path::{Path, PathBuf};

/// A banned phrase, and what to write instead. `*` is up to forty characters of one clause.
const BANNED: &[(&str, &str)] = &[
    ("mend", "fix"),
    ("mends", "fixes"),
    ("mending", "fixing"),
    ("trouble", "error"),
    ("troubles", "errors"),
    ("told from", "distinguished from"),
    ("x is none", "what it lacks or why it is invalid"),
    ("so many", "a number, or this many"),
    ("in its stead", "alternatives"),
    ("in their stead", "alternatives"),
    ("in the place of", "instead of"),
    ("come out at", "is, or reaches"),
    ("comes out at", "is, or reaches"),
    ("stand in for", "replace"),
    ("stands in", "is in, or replaces"),
    ("off its drawing", "with errors"),
    ("structure without a name", "unexplained structure"),
    ("structure that has no name", "unexplained structure"),
    ("what a run left", "causes that the run cannot distinguish"),
    ("what a run leaves", "causes that the run cannot distinguish"),
    ("leaves open", "cannot distinguish, or does not state"),
    ("left open", "not determined"),
    ("hang on", "depend on, or be attached to"),
    ("hangs on", "depends on, or is attached to"),
    ("hanging on", "attached to"),
    ("of use", "useful, or used"),
    ("of no use", "not used"),
    ("as it is known", "as determined so far"),
    ("for judging", "as test data"),
    ("judge by", "test data, or evaluate with"),
    ("judged by", "evaluated with"),
    ("what the model * leaves", "residuals"),
    ("what the * model leaves", "residuals"),
    ("what geometry leaves", "residuals of the geometry"),
    ("what * geometry leaves", "residuals, or what the geometry does not determine"),
    ("what a fit leaves", "residuals"),
    ("settle", "distinguish, or converge"),
    ("settles", "distinguishes, or converges"),
    ("held against", "compared with"),
    ("hold against", "compare with"),
    ("hold it against", "compare it with"),
    ("data ask for", "selected"),
    ("residuals ask for", "selected"),
    ("found again in", "selected in … of half-sample refits"),
    ("resampled runs", "half-sample refits"),
    ("misses nothing", "no lack of fit"),
    ("corrected for, not named", "included in the model; cause uncertain"),
    ("go on", "continue, or be carried over"),
    ("goes on", "continues"),
    ("hang together", "are correlated"),
    ("hangs together", "is correlated"),
    ("goes for nothing", "is negligible"),
    ("gone on from", "continued"),
    ("hardly tell", "hardly determine"),
    ("told by", "given by, or determined by"),
    ("so often", "how many times"),
    ("in the stead", "instead of"),
];

/// Identifiers that mean nothing to a reader who does not know the code.
const BANNED_NAMES: &[&str] = &[
    "able",
    "climb",
    "dealt",
    "departure",
    "granted",
    "leftover",
    "leftovers",
    "mend",
    "mends",
    "portrait",
    "portraits",
    "settle",
    "settled",
    "trouble",
    "wish",
];

/// Stems of words that no function has in its name, tests included.
const BANNED_IN_FUNCTIONS: &[&str] = &["anew", "mend", "settle", "told", "trouble"];

/// Type names that describe what happens to the value: allowed only as names of values.
const BANNED_TYPES: &[&str] = &["Asked", "Ground", "Held", "Taken", "Way"];

/// Function names that mean nothing without their arguments.
const BANNED_FUNCTIONS: &[&str] = &["look", "made", "without"];

/// Text as one line with single blanks, because a phrase may cross a line's end.
fn flat(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Whether a text has a phrase: whole words, the first letter in upper or lower case.
fn has(text: &str, phrase: &str) -> bool {
    if phrase == "x is none" {
        // "there is none" is plain English.
        return text.match_indices(" is none").any(|(at, found)| {
            let ends = !text[at + found.len()..].starts_with(|c: char| c.is_alphanumeric());
            let before = text[..at].rsplit(' ').next().unwrap_or_default();
            ends && !before.eq_ignore_ascii_case("there")
        });
    }
    let (first, rest) = phrase.split_once(" * ").map_or((phrase, None), |(first, rest)| (first, Some(rest)));
    let large = first[..1].to_uppercase() + &first[1..];
    [first, &large].iter().any(|first| {
        text.match_indices(*first).any(|(at, found)| {
            let begins = text[..at].chars().next_back().is_none_or(|c| !c.is_alphanumeric() && c != '_' && c != '-');
            let after = &text[at + found.len()..];
            let ends = !after.starts_with(|c: char| c.is_alphanumeric() || c == '_' || c == '-');
            let clause: String = after.chars().take(40).take_while(|c| !".;:".contains(*c)).collect();
            begins && ends && rest.is_none_or(|rest| has(&clause, rest))
        })
    })
}

/// Kind of a part of a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Comment,
    Text,
    Name,
}

/// The parts of Rust code that people read, each with its line: comments, joined for each block; strings; and identifiers.
fn read_of_rust(code: &str) -> Vec<(Kind, usize, String)> {
    let mut parts: Vec<(Kind, usize, String)> = Vec::new();
    let (mut rest, mut line, mut last_comment) = (code, 1, 0);
    while let Some(c) = rest.chars().next() {
        let length = if rest.starts_with("//") {
            let end = rest.find('\n').unwrap_or(rest.len());
            let words = rest[..end].trim_start_matches(['/', '!']).to_owned();
            match parts.last_mut() {
                Some((Kind::Comment, _, text)) if last_comment + 1 == line => {
                    text.push(' ');
                    text.push_str(&words);
                }
                _ => parts.push((Kind::Comment, line, words)),
            }
            last_comment = line;
            end
        } else if let Some(marks) = raw_string(rest) {
            let close = format!("\"{}", "#".repeat(marks));
            let start = marks + 2;
            let end = rest[start..].find(&close).map_or(rest.len(), |end| start + end);
            parts.push((Kind::Text, line, rest[start..end].to_owned()));
            (end + close.len()).min(rest.len())
        } else if c == '"' {
            let mut end = 1;
            let bytes = rest.as_bytes();
            while end < bytes.len() && bytes[end] != b'"' {
                end += if bytes[end] == b'\\' { 2 } else { 1 };
            }
            parts.push((Kind::Text, line, rest[1..end.min(rest.len())].replace("\\\n", " ").replace("\\n", " ")));
            (end + 1).min(rest.len())
        } else if c == '\'' {
            // A character, or a lifetime.
            let mut letters = rest.char_indices().skip(1);
            match (letters.next(), letters.next()) {
                (Some((_, '\\')), _) => {
                    rest[2..].char_indices().skip(1).find(|(_, c)| *c == '\'').map_or(2, |(at, _)| at + 3)
                }
                (Some(_), Some((at, '\''))) => at + 1,
                _ => 1,
            }
        } else if c.is_alphabetic() || c == '_' {
            let end = rest.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(rest.len());
            parts.push((Kind::Name, line, rest[..end].to_owned()));
            end
        } else {
            c.len_utf8()
        };
        line += rest[..length].matches('\n').count();
        rest = &rest[length..];
    }
    parts
}

/// Number of `#` that open a raw string here.
fn raw_string(text: &str) -> Option<usize> {
    let rest = text.strip_prefix('r')?;
    let marks = rest.len() - rest.trim_start_matches('#').len();
    rest[marks..].starts_with('"').then_some(marks)
}

#[test]
fn what_people_read_is_in_plain_words() {
    let mut found: Vec<PathBuf> = Vec::new();
    for folder in ["docs", "crates", "python", "web/src", "robots"] {
        let endings: &[&str] = if folder == "docs" { &[".md"] } else { &[".md", ".rs", ".py", ".pyi", ".ts"] };
        found.extend(own_files(&top().join(folder), endings, &["tests"]));
    }
    found.extend(["README.md", "ARCHITECTURE.md", "CONTRIBUTING.md", "CHANGELOG.md"].map(|name| top().join(name)));
    assert!(found.len() > 500, "{} files were looked at", found.len());
    let (mut wrong, mut words) = (Vec::new(), 0);
    for path in found {
        let text = std::fs::read_to_string(&path).unwrap();
        let name = path.strip_prefix(top()).unwrap().to_str().unwrap().to_owned();
        let parts = if Path::new(&name).extension().is_some_and(|extension| extension == "rs") {
            read_of_rust(&text)
        } else {
            let lines = text.lines().filter(|line| !line.starts_with("from ") && !line.starts_with("import "));
            let lines = lines.map(|line| line.trim_start().trim_start_matches(['#', '*', '/']));
            vec![(Kind::Text, 1, lines.collect::<Vec<_>>().join("\n"))]
        };
        let mut after_fn = false;
        for (kind, line, part) in parts {
            if kind == Kind::Name {
                let is_function = std::mem::replace(&mut after_fn, part == "fn");
                if BANNED_NAMES.contains(&&*part.to_lowercase())
                    || BANNED_TYPES.contains(&&*part)
                    || (is_function && BANNED_FUNCTIONS.contains(&&*part))
                {
                    wrong.push(format!("{name}:{line}: the identifier {part}; write one that says what it is"));
                }
                continue;
            }
            let part = flat(&part);
            words += part.split(' ').count();
            for (phrase, instead) in BANNED.iter().filter(|(phrase, _)| has(&part, phrase)) {
                wrong.push(format!("{name}:{line}: \"{phrase}\"; write: {instead}"));
            }
        }
    }
    assert!(words > 100_000, "{words} words were looked at");
    assert!(wrong.is_empty(), "{} places:\n{}", wrong.len(), wrong.join("\n"));
}

/// Names of the functions in a file of Rust or Python.
fn functions(path: &Path) -> Vec<String> {
    let text = std::fs::read_to_string(path).unwrap();
    if path.extension().is_some_and(|extension| extension == "rs") {
        let names: Vec<_> = read_of_rust(&text).into_iter().filter(|(kind, ..)| *kind == Kind::Name).collect();
        return names.windows(2).filter(|pair| pair[0].2 == "fn").map(|pair| pair[1].2.clone()).collect();
    }
    let name = |line: &str| Some(line.trim_start().strip_prefix("def ")?.split('(').next()?.to_owned());
    text.lines().filter_map(name).collect()
}

#[test]
fn functions_have_plain_names() {
    let folders = ["benches", "crates", "python", "tests"].map(|folder| top().join(folder));
    let files: Vec<PathBuf> = folders.iter().flat_map(|folder| own_files(folder, &[".rs", ".py"], &[])).collect();
    let names: Vec<_> =
        files.iter().flat_map(|file| functions(file).into_iter().map(move |name| (file, name))).collect();
    assert!(names.len() > 5000, "{} functions were looked at", names.len());
    let banned = |word: &str| BANNED_IN_FUNCTIONS.iter().any(|stem| word.starts_with(stem));
    let wrong: Vec<_> = names.iter().filter(|(_, name)| name.split('_').any(banned)).collect();
    assert!(wrong.is_empty(), "{} names: {wrong:#?}", wrong.len());
}

#[test]
fn phrases_are_found_where_they_are_written() {
    assert!(
        has("Mend it", "mend") && !has("amend it", "mend") && !has("{mend_it}", "mend") && !has("recommend", "mend")
    );
    assert!(has("a file that is none.", "x is none") && !has("made where there is none", "x is none"));
    assert!(has("What the adopted model leaves of a row", "what the * model leaves"));
    assert!(!has("what the geometry. A model leaves", "what the * model leaves"));
    let code = "/// so\n/// many\nfn f() { let c = '\"'; g(\"it \\\n  goes on\"); } // mend\nlet r = r#\"a \"b\" c\"#;";
    let parts: Vec<_> = read_of_rust(code).into_iter().map(|(kind, line, text)| (kind, line, flat(&text))).collect();
    let read: Vec<_> = parts.iter().filter(|(kind, ..)| *kind != Kind::Name).cloned().collect();
    let expected = [
        (Kind::Comment, 1, "so many"),
        (Kind::Text, 3, "it goes on"),
        (Kind::Comment, 4, "mend"),
        (Kind::Text, 5, "a \"b\" c"),
    ];
    assert_eq!(read, expected.map(|(kind, line, text)| (kind, line, text.to_owned())));
    let names: Vec<_> = parts.iter().filter(|(kind, ..)| *kind == Kind::Name).map(|(.., name)| &**name).collect();
    assert_eq!(names, ["fn", "f", "let", "c", "g", "let", "r"]);
}
