//! The walk over the document.

use std::collections::{BTreeMap, HashMap};
use std::path::{Path, PathBuf};
use std::rc::Rc;

use super::output::Output;
use super::{Argument, Expanded, Note, Options, Source, folder_of};
use crate::access::Gate;
use crate::error::{ErrorKind, XacroError};
use crate::expression::Expression;
use crate::limits::Meter;
use crate::packages::{PackagePath, package_of};
use crate::place::{SourceFile, Spot};
use crate::scope::{Macros, Scope};
use crate::trace::{EvaluatedAt, Trace};
use crate::tree::{self, Call, Document, Element, Node, Text};
use crate::write;

pub(super) type Outcome<T> = Result<T, Box<XacroError>>;

/// The state of the whole expansion.
pub(super) struct Expander<'a> {
    pub options: &'a Options,
    pub packages: PackagePath,
    pub gate: Gate,
    pub given: &'a [(String, String)],
    /// Arguments by name: given ones, and defaults as they are declared.
    pub arguments: BTreeMap<String, String>,
    pub declared: Vec<Argument>,
    pub meter: Meter,
    pub notes: Vec<Note>,
    pub files_read: Vec<PathBuf>,
    /// Files that are being processed, the innermost last.
    pub files: Vec<PathBuf>,
    /// Properties that are being evaluated, the innermost last.
    pub evaluating: Vec<Rc<str>>,
    pub parsed: HashMap<Rc<str>, Rc<Expression>>,
    pub documents: HashMap<PathBuf, Rc<Document>>,
    /// The macro call that is being expanded.
    pub call: Option<Rc<Call>>,
    /// Values of expressions, if requested.
    pub values: Vec<EvaluatedAt>,
}

/// Visible macros and properties.
#[derive(Clone)]
pub(super) struct Sight {
    pub macros: Rc<Macros>,
    pub symbols: Rc<Scope>,
}

pub(super) fn run(source: &Source, given: &[(String, String)], options: &Options) -> Outcome<Expanded> {
    let path = match source {
        Source::Path(path) => path.clone(),
        Source::Text { name, folder, .. } => {
            folder.as_ref().map_or_else(|| PathBuf::from(name), |folder| folder.join(name))
        }
    };
    let mut gate = Gate::new(&options.access);
    let home = package_of(&path).unwrap_or_else(|| match folder_of(&path) {
        folder if folder.as_os_str().is_empty() => PathBuf::from("."),
        folder => folder.to_path_buf(),
    });
    gate.open(&home);
    let mut expander = Expander {
        options,
        packages: options.packages.near(&path),
        gate,
        given,
        arguments: given.iter().cloned().collect(),
        declared: Vec::new(),
        meter: Meter::new(options.limits.clone()),
        notes: Vec::new(),
        files_read: Vec::new(),
        files: vec![path.clone()],
        evaluating: Vec::new(),
        parsed: HashMap::new(),
        documents: HashMap::new(),
        call: None,
        values: Vec::new(),
    };
    let document = match source {
        Source::Text { name, text, .. } => {
            let text = text.strip_prefix('\u{feff}').unwrap_or(text).to_owned();
            Rc::new(tree::read(&Rc::new(SourceFile { path: name.into(), text }))?)
        }
        Source::Path(path) => {
            // A link may lead to the document itself from anywhere.
            if let Ok(real) = crate::files::canonical(path) {
                expander.gate.open(folder_of(&real));
            }
            expander.document(path)?
        }
    };
    let sight = Sight { macros: Rc::new(Macros::default()), symbols: Scope::root() };
    let root = expander.root(&document.root, &sight)?;
    expander.note_unused_arguments();
    let mut written = write::document(&document.before, &root, &document.after, options.trace);
    Ok(Expanded {
        trace: options.trace.then(|| Trace::of(std::mem::take(&mut written.elements), expander.values)),
        urdf: written.text,
        notes: expander.notes,
        files_read: expander.files_read,
        arguments: expander.declared,
    })
}

impl Expander<'_> {
    /// Reads a XML file, once.
    pub fn document(&mut self, path: &Path) -> Outcome<Rc<Document>> {
        if let Some(document) = self.documents.get(path) {
            return Ok(Rc::clone(document));
        }
        let file = self.read(path)?;
        let document = Rc::new(tree::read(&file)?);
        self.documents.insert(path.to_path_buf(), Rc::clone(&document));
        Ok(document)
    }

    /// Reads a file.
    pub fn read(&mut self, path: &Path) -> Outcome<Rc<SourceFile>> {
        let text = self.gate.read(path, self.meter.limits.bytes)?;
        self.meter.text(text.len())?;
        if !self.files_read.iter().any(|known| known == path) {
            self.files_read.push(path.to_path_buf());
        }
        // A byte order mark is no content.
        let text = text.strip_prefix('\u{feff}').map(str::to_owned).unwrap_or(text);
        Ok(Rc::new(SourceFile { path: path.to_path_buf(), text }))
    }

    pub fn note(&mut self, spot: &Spot, message: impl Into<String>) {
        const MOST_NOTES: usize = 1000;
        if self.notes.len() < MOST_NOTES {
            self.notes.push(Note { place: Some(spot.place()), message: message.into() });
        }
    }

    fn root(&mut self, source: &Rc<Element>, sight: &Sight) -> Outcome<Element> {
        let mut output = Output::new(source.bare(), true);
        self.start_tag(source, sight, &mut output)?;
        if let Some(target) = source.attribute("xacro:targetNamespace") {
            output.element.namespaces.retain(|(name, _)| &**name != "xmlns");
            output.element.namespaces.insert(0, ("xmlns".into(), Rc::clone(&target.value)));
        }
        self.children(source, sight, &mut output)?;
        Ok(output.element)
    }

    fn note_unused_arguments(&mut self) {
        for (name, _) in self.given {
            if !self.declared.iter().any(|argument| argument.name == *name) {
                let message = format!("the argument \"{name}\" is given, but the document does not declare it");
                self.notes.push(Note { place: None, message });
            }
        }
    }

    /// Evaluates an element, with its attributes and children.
    pub fn element(&mut self, source: &Rc<Element>, sight: &Sight) -> Outcome<Element> {
        let mut output = Output::new(source.bare(), true);
        output.element.calls.clone_from(&self.call);
        self.start_tag(source, sight, &mut output)?;
        self.children(source, sight, &mut output)?;
        Ok(output.element)
    }

    /// Evaluates the attributes; those with the prefix `xacro` are dropped.
    fn start_tag(&mut self, source: &Element, sight: &Sight, output: &mut Output) -> Outcome<()> {
        let mut bytes = source.name.len();
        output.element.namespaces =
            source.namespaces.iter().filter(|(name, _)| &**name != "xmlns:xacro").cloned().collect();
        for attribute in &source.attributes {
            if attribute.name.starts_with("xacro:") {
                if &*attribute.name != "xacro:targetNamespace" {
                    let message =
                        format!("<{}> does not take the attribute \"{}\": it is ignored", source.name, attribute.name);
                    self.note(&source.spot_of(attribute), message);
                }
                continue;
            }
            let value = self.words(&attribute.value, &source.spot_of(attribute), &sight.symbols)?;
            bytes += attribute.name.len() + value.len();
            output.set_attribute(Rc::clone(&attribute.name), value, attribute.range.clone());
        }
        self.meter.node(bytes).map_err(|error| error.at(&source.spot()))
    }

    /// Evaluates the children into `output`.
    pub fn children(&mut self, source: &Element, sight: &Sight, output: &mut Output) -> Outcome<()> {
        self.meter.enter().map_err(|error| error.at(&source.spot()))?;
        let mut comments_too = false;
        for child in &source.children {
            match child {
                Node::Element(element) => {
                    comments_too = false;
                    self.dispatch(element, sight, output)?;
                }
                Node::Text(text) => {
                    let value = self.words(&text.value, &text.spot, &sight.symbols)?;
                    comments_too &= value.trim().is_empty();
                    self.meter.node(value.len()).map_err(|error| error.at(&text.spot))?;
                    output.push(Node::Text(Text { value, spot: text.spot.clone() }));
                }
                Node::Comment(text) if text.value.contains("xacro:eval-comments") => {
                    comments_too = !text.value.contains("xacro:eval-comments:off");
                }
                Node::Comment(text) => {
                    let value = if comments_too {
                        self.words(&text.value, &text.spot, &sight.symbols)?
                    } else {
                        Rc::clone(&text.value)
                    };
                    self.meter.node(value.len()).map_err(|error| error.at(&text.spot))?;
                    output.push(Node::Comment(Text { value, spot: text.spot.clone() }));
                }
                Node::Cdata(_) | Node::Instruction { .. } => {
                    self.meter.node(0)?;
                    output.push(child.clone());
                }
            }
        }
        self.meter.leave();
        Ok(())
    }

    /// A failure at an element.
    pub fn wrong(element: &Element, message: impl Into<String>) -> Box<XacroError> {
        XacroError::new(ErrorKind::Element, message).at(&element.spot())
    }
}
