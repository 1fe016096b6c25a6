//! Completion at the cursor: elements, attributes, names, words and files.

use crate::analysis::Analysis;
use crate::features::definition::{evaluated, packages};
use crate::markup::{Markup, Spot};
use crate::names::{Kind, Language, XACRO};
use crate::session::Session;
use crate::vocabulary::{self, Words};
use denavit_edit::{Kind as Named, named_by_attribute, named_by_text};
use denavit_model::urdf::vocabulary;
use gen_lsp_types::{CompletionItem, CompletionItemKind, CompletionItemTextEdit, TextEdit};
use std::collections::BTreeSet;
use std::ops::Range;
use std::path::Path;
use std::rc::Rc;

/// Maximum number of folder entries offered.
const MOST_FILES: usize = 500;

/// Types of joints.
const TYPES: [(&str, &str); 6] = [
    ("revolute", "turns between limits"),
    ("continuous", "turns without limits"),
    ("prismatic", "slides"),
    ("fixed", "does not move"),
    ("floating", "moves freely"),
    ("planar", "moves and turns in a plane"),
];

struct Offer<'a> {
    session: &'a Session,
    path: &'a Path,
    text: &'a str,
    markup: &'a Markup,
    at: usize,
    items: Vec<(String, String, CompletionItemKind)>,
    /// What an item replaces, up to the cursor.
    from: usize,
}

pub(crate) fn complete(session: &Session, path: &Path, at: usize) -> Vec<CompletionItem> {
    let (Some(text), Some(markup)) = (session.files.text(path), session.files.markup(path)) else { return Vec::new() };
    let mut offer = Offer { session, path, text: &text.text, markup: &markup, at, items: Vec::new(), from: at };
    offer.find();
    let range = text.range(&(offer.from..at));
    let mut seen = BTreeSet::new();
    offer
        .items
        .into_iter()
        .filter(|(label, ..)| seen.insert(label.clone()))
        .map(|(label, detail, kind)| CompletionItem {
            kind: Some(kind),
            detail: (!detail.is_empty()).then_some(detail),
            filter_text: Some(label.clone()),
            text_edit: Some(CompletionItemTextEdit::TextEdit(TextEdit { range, new_text: label.clone() })),
            label,
            ..CompletionItem::default()
        })
        .collect()
}

impl Offer<'_> {
    fn add(&mut self, label: impl Into<String>, detail: impl Into<String>, kind: CompletionItemKind) {
        self.items.push((label.into(), detail.into(), kind));
    }

    fn find(&mut self) {
        match self.markup.spot(self.at) {
            Spot::Name(tag) if self.at <= self.markup.tags[tag].name.end => {
                self.from = self.markup.tags[tag].name.start;
                self.elements(tag);
            }
            Spot::AttributeName(tag, attribute) => {
                self.from = self.markup.tags[tag].attributes[attribute].name.start;
                self.attributes(tag);
            }
            Spot::Inside(tag) => self.attributes(tag),
            Spot::Value(tag, attribute) => self.value(tag, attribute),
            Spot::Text(tag) => self.words(tag),
            _ => {}
        }
    }

    fn language(&self) -> Language {
        Language::of(self.path, self.text)
    }

    fn robots(&self) -> Vec<Rc<Analysis>> {
        self.session.last_robots_of(self.path)
    }

    /// Tags from below the root to an element, without those of xacro.
    fn way(&self, tag: usize) -> Vec<&str> {
        let mut way: Vec<usize> = std::iter::once(tag).chain(self.markup.around(tag)).collect();
        way.reverse();
        let name = |tag: &usize| &self.text[self.markup.tags[*tag].name.clone()];
        way.iter().skip(1).map(name).filter(|name| !name.starts_with("xacro:")).collect()
    }

    /// The allowed content of an element of SDF or MJCF.
    fn words_of(&self, tag: usize) -> Option<Words> {
        let mut way: Vec<usize> = std::iter::once(tag).chain(self.markup.around(tag)).collect();
        way.reverse();
        let name = |tag: &usize| &self.text[self.markup.tags[*tag].name.clone()];
        let mut way: Vec<&str> = way.iter().map(name).filter(|name| !name.starts_with("xacro:")).collect();
        match self.language() {
            Language::Mjcf => {
                // An included file starts with the content of a model.
                way[0] = "mujoco";
                vocabulary::words(vocabulary::MJCF, &way)
            }
            Language::Sdf => vocabulary::words(vocabulary::SDF, &way),
            _ => None,
        }
    }

    /// Names of elements with a tag, or in an element of that name, in the files that belong together.
    fn names_of(&mut self, tag: &str, attribute: &str) {
        for file in self.files() {
            let (Some(text), Some(markup)) = (self.session.files.text(&file), self.session.files.markup(&file)) else {
                continue;
            };
            let shown = file.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
            for (index, own) in markup.tags.iter().enumerate() {
                let around = markup.around(index).next().map(|parent| markup.local(&text.text, parent));
                if (markup.local(&text.text, index) == tag || around == Some(tag))
                    && let Some(name) = own.attribute(&text.text, attribute)
                {
                    self.add(name, &shown, CompletionItemKind::Reference);
                }
            }
        }
    }

    /// Offers values of an attribute of SDF or MJCF; returns whether the attribute is known.
    fn listed(&mut self, tag: usize, name: &str) -> bool {
        let language = self.language();
        if !matches!(language, Language::Sdf | Language::Mjcf) {
            return false;
        }
        let known = self.words_of(tag).unwrap_or_default();
        let listed = known.of(name).to_vec();
        for word in &listed {
            self.add(*word, "", CompletionItemKind::EnumMember);
        }
        if !listed.is_empty() || name == "name" {
            return true;
        }
        let own = self.markup.local(self.text, tag).to_owned();
        match (language, name) {
            (Language::Mjcf, "class" | "childclass") => {
                if own != "default" {
                    self.names_of("default", "class");
                }
            }
            // `joint`, `body1`, `site2`: a name of such an element; actuators have tags of their own.
            (Language::Mjcf, _) => {
                let tag = name.trim_end_matches(|c: char| c.is_ascii_digit());
                if !["joint", "body"].contains(&tag) {
                    self.names_of(tag, "name");
                }
                return !self.items.is_empty();
            }
            (_, "relative_to" | "attached_to" | "expressed_in" | "placement_frame") => {
                self.names_of("frame", "name");
                self.parts(Named::Either);
                self.add("__model__", "the frame of the model", CompletionItemKind::Keyword);
            }
            (_, "canonical_link") => self.parts(Named::Link),
            _ => return false,
        }
        true
    }

    fn is_xacro(&self) -> bool {
        denavit_xacro::is_xacro(self.text)
    }

    fn elements(&mut self, tag: usize) {
        let parent = self.markup.tags[tag].parent;
        match self.language() {
            Language::Urdf => {
                let way = parent.map_or(Vec::new(), |parent| self.way(parent));
                let own: Vec<&'static str> = vocabulary(&way).map_or(Vec::new(), |(_, children)| children);
                for child in own {
                    self.add(child, "", CompletionItemKind::Class);
                }
            }
            Language::Srdf => {
                let parent = parent.map_or("", |parent| self.markup.local(self.text, parent)).to_owned();
                for child in denavit_compare::lint::srdf::children_of(&parent) {
                    self.add(child, "", CompletionItemKind::Class);
                }
            }
            Language::Sdf | Language::Mjcf => {
                let known = parent.and_then(|parent| self.words_of(parent)).unwrap_or_default();
                for child in known.children {
                    self.add(child, "", CompletionItemKind::Class);
                }
            }
        }
        if self.is_xacro() {
            for name in XACRO {
                self.add(format!("xacro:{name}"), "xacro", CompletionItemKind::Keyword);
            }
            for (name, _) in self.named(Kind::Macro) {
                self.add(format!("xacro:{name}"), "macro", CompletionItemKind::Function);
            }
        }
    }

    fn attributes(&mut self, tag: usize) {
        let full = self.text[self.markup.tags[tag].name.clone()].to_owned();
        let mut known: Vec<String> = match (full.strip_prefix("xacro:"), self.language()) {
            (Some("macro"), _) => ["name", "params"].map(str::to_owned).to_vec(),
            (Some("property"), _) => {
                ["name", "value", "default", "scope", "remove", "lazy_eval"].map(str::to_owned).to_vec()
            }
            (Some("arg"), _) => ["name", "default"].map(str::to_owned).to_vec(),
            (Some("include"), _) => ["filename", "ns", "optional"].map(str::to_owned).to_vec(),
            (Some("if" | "unless"), _) => vec!["value".to_owned()],
            (Some("insert_block" | "element" | "attribute"), _) => vec!["name".to_owned()],
            (Some("call"), _) => vec!["macro".to_owned()],
            (Some(name), _) => self.parameters_of(name),
            (None, Language::Urdf) => {
                let way = self.way(tag);
                let own = vocabulary(&way).map_or(Vec::new(), |(attributes, _)| attributes);
                own.into_iter().map(str::to_owned).collect()
            }
            (None, Language::Srdf) => {
                let parent = self.markup.tags[tag].parent.map_or("", |parent| self.markup.local(self.text, parent));
                let own = denavit_compare::lint::srdf::attributes_of(&full, parent);
                own.iter().map(|name| (*name).to_owned()).collect()
            }
            (None, Language::Sdf | Language::Mjcf) => {
                let known = self.words_of(tag).unwrap_or_default();
                known.attributes.into_iter().map(|(name, _)| name.to_owned()).collect()
            }
        };
        let of = &self.markup.tags[tag].attributes;
        let is_here = |name: &Range<usize>| name.start <= self.at && self.at <= name.end;
        let taken: Vec<&str> = of
            .iter()
            .filter(|attribute| !is_here(&attribute.name))
            .map(|attribute| &self.text[attribute.name.clone()])
            .collect();
        known.retain(|name| !taken.contains(&name.as_str()));
        for name in known {
            self.add(name, "", CompletionItemKind::Property);
        }
    }

    /// The parameters of a macro.
    fn parameters_of(&self, name: &str) -> Vec<String> {
        let mut found = Vec::new();
        for file in self.files() {
            let (Some(names), Some(text), Some(markup)) =
                (self.session.files.names(&file), self.session.files.text(&file), self.session.files.markup(&file))
            else {
                continue;
            };
            let defined = names.iter().find(|other| other.kind == Kind::Macro && other.defines && other.name == name);
            let Some(defined) = defined else { continue };
            let is_value = |other: &&crate::names::Occurrence| {
                let tag = &markup.tags[defined.tag];
                let starred = text.text[..other.range.start].ends_with('*');
                other.tag == defined.tag
                    && other.kind == Kind::Property
                    && other.defines
                    && !starred
                    && tag.start.contains(&other.range.start)
            };
            found.extend(names.iter().filter(is_value).map(|other| other.name.clone()));
            break;
        }
        found
    }

    /// Files that belong together with this one.
    fn files(&self) -> Vec<std::path::PathBuf> {
        let mut files = vec![self.path.to_path_buf()];
        for analysis in self.session.analyses().filter(|analysis| analysis.files.iter().any(|file| file == self.path)) {
            files.extend(analysis.files.iter().filter(|file| *file != self.path).cloned());
        }
        let mut seen = BTreeSet::new();
        files.retain(|file| seen.insert(file.clone()));
        files
    }

    /// Defined names of a kind, with the file's name.
    fn named(&self, kind: Kind) -> Vec<(String, String)> {
        let mut found = Vec::new();
        for file in self.files() {
            let shown = file.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
            let names = self.session.files.names(&file);
            let own = names.iter().flat_map(|names| names.iter()).filter(|name| name.kind == kind && name.defines);
            found.extend(own.map(|name| (name.name.clone(), shown.clone())));
        }
        found
    }

    /// Links or joints of the robots, and those defined in the text.
    fn parts(&mut self, kind: Named) {
        let mut links: Vec<(String, &str)> = Vec::new();
        for robot in self.robots().iter().filter_map(|analysis| analysis.robot.as_ref()) {
            if kind != Named::Joint {
                links.extend(robot.links.iter().map(|link| (link.name.clone(), "link")));
            }
            if kind != Named::Link {
                links.extend(robot.joints.iter().map(|joint| (joint.name.clone(), "joint")));
            }
        }
        if links.is_empty() {
            if kind != Named::Joint {
                links.extend(self.named(Kind::Link).into_iter().map(|(name, _)| (name, "link")));
            }
            if kind != Named::Link {
                links.extend(self.named(Kind::Joint).into_iter().map(|(name, _)| (name, "joint")));
            }
        }
        for (name, what) in links {
            self.add(name, what, CompletionItemKind::Reference);
        }
    }

    fn value(&mut self, tag: usize, attribute: usize) {
        let attribute = &self.markup.tags[tag].attributes[attribute];
        let (name, value) = (self.text[attribute.name.clone()].to_owned(), attribute.value.clone());
        let full = self.text[self.markup.tags[tag].name.clone()].to_owned();
        let local = self.markup.local(self.text, tag).to_owned();
        if self.substitution(value.clone()) {
            return;
        }
        self.from = value.start;
        match (full.strip_prefix("xacro:"), local.as_str(), name.as_str()) {
            (Some("include"), _, "filename") | (None, "mesh" | "texture", "filename") | (None, "include", "file") => {
                self.paths(value.start);
            }
            (Some(_), ..) => {}
            _ if self.listed(tag, &name) => {}
            (None, "joint", "type") => {
                for (word, what) in TYPES {
                    self.add(word, what, CompletionItemKind::EnumMember);
                }
            }
            (None, "virtual_joint", "type") => {
                for word in ["fixed", "floating", "planar"] {
                    self.add(word, "", CompletionItemKind::EnumMember);
                }
            }
            (None, "disable_collisions", "reason") => {
                for word in ["Adjacent", "Never", "Default", "Always", "User"] {
                    self.add(word, "", CompletionItemKind::EnumMember);
                }
            }
            (None, "material", "name") => {
                for (name, file) in self.named(Kind::Material) {
                    self.add(name, file, CompletionItemKind::Struct);
                }
            }
            (None, _, "group" | "parent_group") if self.language() == Language::Srdf => {
                for (name, file) in self.named(Kind::Group) {
                    self.add(name, file, CompletionItemKind::Struct);
                }
            }
            // A new link or joint has a new name.
            (None, "link" | "joint", "name") if self.language() == Language::Urdf && self.way(tag).len() == 1 => {}
            (None, local, name) => {
                let kind = match self.language() {
                    Language::Mjcf if name.starts_with("joint") => Some(Named::Joint),
                    Language::Mjcf if name.starts_with("body") => Some(Named::Link),
                    Language::Mjcf => None,
                    _ => named_by_attribute(local, name),
                };
                if let Some(kind) = kind {
                    self.parts(kind);
                }
            }
        }
    }

    fn words(&mut self, tag: usize) {
        let Some(inside) = self.markup.tags[tag].inside() else { return };
        let (local, name) = (self.markup.local(self.text, tag), self.markup.tags[tag].attribute(self.text, "name"));
        let listed = self.words_of(tag).map_or(Vec::new(), |known| known.values);
        if !listed.is_empty() {
            self.from = self.at - self.text[inside.start..self.at].trim_start().len();
            for word in listed {
                self.add(word, "", CompletionItemKind::EnumMember);
            }
            return;
        }
        let Some(kind) = named_by_text(local, name).filter(|_| self.language() != Language::Mjcf) else { return };
        let before = &self.text[inside.start..self.at];
        let start = before.rfind([' ', ',', '\n', '\t']).map_or(inside.start, |at| inside.start + at + 1);
        self.from = start;
        self.parts(kind);
    }

    /// Completion inside `${…}` or `$(…)`; returns whether the cursor is there.
    fn substitution(&mut self, value: Range<usize>) -> bool {
        let before = &self.text[value.start..self.at];
        let open = |opens: &str, closes: char| before.rfind(opens).filter(|at| !before[*at..].contains(closes));
        if let Some(at) = open("${", '}') {
            let inner = &before[at + 2..];
            let word = inner.rfind(|c: char| !(c.is_alphanumeric() || c == '_')).map_or(0, |end| end + 1);
            self.from = value.start + at + 2 + word;
            for (name, file) in self.named(Kind::Property) {
                if !name.contains('$') {
                    self.add(name, file, CompletionItemKind::Variable);
                }
            }
            return true;
        }
        let Some(at) = open("$(", ')') else { return false };
        let inner = &before[at + 2..];
        let Some((word, rest)) = inner.split_once(' ') else {
            self.from = value.start + at + 2;
            for (word, what) in
                [("find", "folder of a package"), ("arg", "an argument"), ("env", "an environment variable")]
            {
                self.add(word, what, CompletionItemKind::Keyword);
            }
            return true;
        };
        self.from = self.at - rest.trim_start().len();
        match word {
            "find" => {
                for name in packages(self.session, self.path).packages() {
                    self.add(name, "package", CompletionItemKind::Module);
                }
            }
            "arg" => {
                for (name, file) in self.named(Kind::Argument) {
                    self.add(name, file, CompletionItemKind::Variable);
                }
            }
            _ => {}
        }
        true
    }

    /// Files and folders, of a package or next to the file.
    fn paths(&mut self, start: usize) {
        let written = &self.text[start..self.at];
        let packages = packages(self.session, self.path);
        if let Some(rest) = written.strip_prefix("package://")
            && !rest.contains('/')
        {
            self.from = self.at - rest.len();
            for name in packages.packages() {
                self.add(format!("{name}/"), "package", CompletionItemKind::Module);
            }
            return;
        }
        let slash = written.rfind('/').map_or(start, |at| start + at + 1);
        self.from = slash;
        let folder = evaluated(self.session, self.path, start..slash).filter(|folder| !folder.contains('$'));
        let Some(folder) = folder.and_then(|folder| packages.resolve(&folder, Some(self.path)).ok()) else { return };
        if written.is_empty() {
            self.add("package://", "a file of a package", CompletionItemKind::Keyword);
            self.add("$(find ", "a file of a package", CompletionItemKind::Keyword);
        }
        let Ok(entries) = std::fs::read_dir(&folder) else { return };
        let mut names: Vec<(String, bool)> = entries
            .flatten()
            .take(MOST_FILES)
            .map(|entry| (entry.file_name().to_string_lossy().into_owned(), entry.path().is_dir()))
            .filter(|(name, _)| !name.starts_with('.'))
            .collect();
        names.sort();
        for (name, is_folder) in names {
            let kind = if is_folder { CompletionItemKind::Folder } else { CompletionItemKind::File };
            self.add(if is_folder { format!("{name}/") } else { name }, "", kind);
        }
    }
}
