//! The texts of a model: the file itself and what it includes.

use crate::error::{SdfProblem, SdfProblemKind};
use crate::includes::Fetch;
use denavit_model::Place;
use denavit_model::well_formed::unbound_prefixes;
use roxmltree::{Document, Node, ParsingOptions};
use std::borrow::Cow;
use std::collections::HashMap;
use std::fmt::Write as _;

/// Every text, and which text each include refers to.
#[derive(Default)]
pub(crate) struct Sources {
    pub files: Vec<File>,
    /// By the file and the byte offset of the `<include>`: the file that it names, or why there is none.
    pub includes: HashMap<(usize, usize), Result<usize, String>>,
    pub problems: Vec<SdfProblem>,
    pub notes: Vec<(Place, String)>,
}

/// A text as the XML parser takes it, with the lines of the original.
pub(crate) struct File {
    pub name: String,
    pub text: String,
    ends: Vec<usize>,
}

impl File {
    /// The line (counted from 1) of a byte offset.
    pub fn line(&self, offset: usize) -> usize {
        1 + self.ends.partition_point(|end| *end < offset)
    }
}

/// A model may include models this deep.
const DEEPEST: usize = 32;

impl Sources {
    /// The file and everything that it includes.
    pub fn gathered(file: &str, text: &str, fetch: &mut Fetch) -> Self {
        let mut sources = Self::default();
        sources.add(file, text);
        // The files on the way to each file.
        let mut above: Vec<Vec<usize>> = vec![Vec::new()];
        let mut next = 0;
        while next < sources.files.len() {
            for (at, uri) in sources.uris(next) {
                let from = sources.files[next].name.clone();
                let found = match fetch(&uri, &from) {
                    Err(reason) => Err(reason),
                    Ok(_) if above[next].len() >= DEEPEST => {
                        Err(format!("models include each other more than {DEEPEST} deep"))
                    }
                    Ok((name, text)) => {
                        let known = sources.files.iter().position(|file| file.name == name);
                        if known.is_some_and(|known| known == next || above[next].contains(&known)) {
                            sources.problem(next, at, "<include>", SdfProblemKind::IncludeCycle(uri.clone()));
                            continue;
                        }
                        Ok(known.unwrap_or_else(|| {
                            let mut way = above[next].clone();
                            way.push(next);
                            above.push(way);
                            sources.add(&name, &text)
                        }))
                    }
                };
                sources.includes.insert((next, at), found);
            }
            next += 1;
        }
        sources
    }

    fn add(&mut self, name: &str, original: &str) -> usize {
        let (text, fixed) = well_formed(original);
        for (offset, what) in fixed {
            let line = 1 + original[..offset].matches('\n').count();
            self.notes.push((Place { file: name.to_owned(), line, element: "file".into() }, what));
        }
        let text = text.into_owned();
        let ends = text.match_indices('\n').map(|(at, _)| at).collect();
        self.files.push(File { name: name.to_owned(), text, ends });
        self.files.len() - 1
    }

    /// Byte offsets of the includes of a file, and what they include.
    fn uris(&self, file: usize) -> Vec<(usize, String)> {
        let text = &self.files[file].text;
        if !text.contains("<include") {
            return Vec::new();
        }
        let Ok(document) = parsed(text) else { return Vec::new() };
        let includes = document.descendants().filter(|node| node.has_tag_name("include"));
        let uris = includes.filter_map(|node| {
            let uri = node.children().find(|child| child.has_tag_name("uri"))?.text()?.trim();
            Some((node.range().start, uri.to_owned()))
        });
        uris.collect()
    }

    /// Every file's document; those that do not parse are problems.
    pub fn documents(&self) -> (Vec<Option<Document<'_>>>, Vec<SdfProblem>) {
        let mut problems = Vec::new();
        let documents = self.files.iter().map(|file| {
            parsed(&file.text)
                .map_err(|error| {
                    let place =
                        Place { file: file.name.clone(), line: error.pos().row as usize, element: "file".into() };
                    problems.push(SdfProblem { place, kind: SdfProblemKind::Xml(error.to_string()) });
                })
                .ok()
        });
        (documents.collect(), problems)
    }

    fn problem(&mut self, file: usize, at: usize, element: &str, kind: SdfProblemKind) {
        let place = self.place(file, at, element);
        self.problems.push(SdfProblem { place, kind });
    }

    /// The place of something in one of the files.
    pub fn place(&self, file: usize, at: usize, element: impl Into<String>) -> Place {
        let file = &self.files[file];
        Place { file: file.name.clone(), line: file.line(at), element: element.into() }
    }
}

fn parsed(text: &str) -> Result<Document<'_>, roxmltree::Error> {
    Document::parse_with_options(text, ParsingOptions { allow_dtd: true, ..ParsingOptions::default() })
}

/// `link "arm"`, `<pose>`.
pub(crate) fn element_of(node: Node) -> String {
    match node.attribute("name") {
        Some(name) => format!("{} \"{name}\"", node.tag_name().name()),
        None => format!("<{}>", node.tag_name().name()),
    }
}

/// A text that the XML parser takes, of the same lines; what was done, and where.
fn well_formed(original: &str) -> (Cow<'_, str>, Vec<(usize, String)>) {
    let mut fixed = Vec::new();
    let mut text = Cow::Borrowed(original);
    if let Some(rest) = original.strip_prefix('\u{feff}') {
        text = Cow::Owned(rest.to_owned());
    }
    // An XML declaration behind white space or comments, as some converters write it.
    if let Some(at) = text.find("<?xml").filter(|at| *at > 0 && only_comments(&text[..*at])) {
        let end = text[at..].find("?>").map_or(text.len(), |end| at + end + 2);
        let blank: String = text[at..end].chars().map(|letter| if letter == '\n' { '\n' } else { ' ' }).collect();
        fixed.push((at, "the XML declaration is not at the start of the file; it is skipped".to_owned()));
        text.to_mut().replace_range(at..end, &blank);
    }
    let unbound = unbound_prefixes(&text);
    let root = ["<sdf", "<gazebo", "<model"].iter().find_map(|tag| Some(text.find(tag)? + tag.len()));
    if let (Some(at), false) = (root, unbound.is_empty()) {
        let declared = declarations(&unbound);
        fixed.push((0, format!("namespace prefix {} is not declared; read as part of the name", unbound.join(", "))));
        text.to_mut().insert_str(at, &declared);
    }
    (text, fixed)
}

/// Attributes that declare namespace prefixes.
pub(crate) fn declarations(prefixes: &[&str]) -> String {
    let mut out = String::new();
    for prefix in prefixes {
        let uri = if *prefix == "drake" { "http://drake.mit.edu" } else { &format!("urn:unbound:{prefix}") };
        let _ = write!(out, " xmlns:{prefix}=\"{uri}\"");
    }
    out
}

fn only_comments(mut text: &str) -> bool {
    loop {
        text = text.trim_start();
        if text.is_empty() {
            return true;
        }
        let Some(end) = text.strip_prefix("<!--").and_then(|rest| rest.find("-->")) else { return false };
        text = &text["<!--".len() + end + "-->".len()..];
    }
}
