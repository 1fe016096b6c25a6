//! The elements of a model, those of included files in their place, and its classes of defaults.

use crate::Files;
use denavit_model::formats::FormatError;
use denavit_model::notes::Place;
use denavit_model::problems::nearest_name;
use denavit_model::write::escape;
use roxmltree::{Document as Xml, Node, ParsingOptions, StringStorage};
use std::borrow::Cow;
use std::cell::OnceCell;
use std::collections::{BTreeMap, HashMap};

/// Deeper trees are refused: no robot has them, and every walk over them is recursive.
const DEEPEST: usize = 500;

/// An attribute's name and value, as the text has them where it can.
pub type Attribute<'t> = (&'t str, Cow<'t, str>);

/// An element.
#[derive(Debug, Clone, Default)]
pub struct Item<'t> {
    pub tag: &'t str,
    pub attributes: Vec<Attribute<'t>>,
    pub children: Vec<Item<'t>>,
    pub text: String,
    /// File, as an index, and line.
    pub at: (usize, usize),
}

/// Texts that are included, one behind another: each stays where it is while more are read.
#[derive(Debug, Default)]
pub struct Included {
    text: OnceCell<String>,
    next: OnceCell<Box<Included>>,
}

impl Included {
    fn keep(&self, text: String) -> &str {
        let mut last = self;
        while last.text.get().is_some() {
            last = last.next.get_or_init(Box::default);
        }
        last.text.get_or_init(|| text)
    }
}

impl Item<'_> {
    pub fn get(&self, name: &str) -> Option<&str> {
        self.attributes.iter().find(|(known, _)| *known == name).map(|(_, value)| &**value)
    }

    /// Its name in messages: `joint "elbow"`, `<option>`.
    pub fn label(&self) -> String {
        match self.get("name").or_else(|| self.get("class").filter(|_| self.tag == "default")) {
            Some(name) => format!("{} \"{name}\"", self.tag),
            None => format!("<{}>", self.tag),
        }
    }

    /// As text, with everything in it.
    pub fn xml(&self) -> String {
        let mut out = String::new();
        self.put(&mut out);
        out
    }

    fn put(&self, out: &mut String) {
        out.extend(["<", self.tag]);
        for (name, value) in &self.attributes {
            out.extend([" ", name, "=\""]);
            escape(out, value);
            out.push('"');
        }
        if self.children.is_empty() && self.text.is_empty() {
            out.push_str("/>");
            return;
        }
        out.push('>');
        escape(out, &self.text);
        for child in &self.children {
            child.put(out);
        }
        out.extend(["</", self.tag, ">"]);
    }
}

/// Attributes by the tag that they are defaults of.
type Class<'t> = BTreeMap<&'t str, Vec<Attribute<'t>>>;

/// A model's elements and classes.
#[derive(Debug)]
pub struct Document<'t> {
    pub root: Item<'t>,
    pub files: Vec<String>,
    classes: HashMap<String, Class<'t>>,
}

/// Reads a model and what it includes.
pub fn read<'t>(
    file: &str,
    text: &'t str,
    included: &'t Included,
    files: &mut Files,
) -> Result<Document<'t>, FormatError> {
    let mut reader = Reader { names: vec![file.to_owned()], included, files };
    let root = reader.parsed(text, 0)?;
    let names = reader.names;
    let mut document = Document { root, files: names, classes: HashMap::new() };
    if document.root.tag != "mujoco" {
        let what = format!(
            "the root element is <{}>, which is only a part of a model; give the file that includes it, whose root is <mujoco>",
            document.root.tag
        );
        return Err(FormatError::one(document.place(&document.root), what));
    }
    document.collect_classes()?;
    Ok(document)
}

struct Reader<'t, 'f, 'g> {
    names: Vec<String>,
    included: &'t Included,
    files: &'f mut Files<'g>,
}

impl<'t> Reader<'t, '_, '_> {
    fn parsed(&mut self, text: &'t str, file: usize) -> Result<Item<'t>, FormatError> {
        let options = ParsingOptions { allow_dtd: true, ..ParsingOptions::default() };
        let xml = Xml::parse_with_options(text, options).map_err(|error| {
            let place =
                Place { file: self.names[file].clone(), line: error.pos().row as usize, element: "file".into() };
            FormatError::one(place, format!("not well-formed XML: {error}; correct it in this line"))
        })?;
        let breaks = text.bytes().enumerate().filter(|(_, byte)| *byte == b'\n');
        let ends: Vec<usize> = breaks.map(|(at, _)| at).collect();
        self.item(xml.root_element(), file, &ends, 0)
    }

    fn item(&mut self, node: Node<'_, 't>, file: usize, ends: &[usize], depth: usize) -> Result<Item<'t>, FormatError> {
        let line = 1 + ends.partition_point(|end| *end < node.range().start);
        let own = |attribute: roxmltree::Attribute<'_, 't>| {
            let value = match attribute.value_storage() {
                StringStorage::Borrowed(value) => Cow::Borrowed(*value),
                StringStorage::Owned(value) => Cow::Owned(value.to_string()),
            };
            (attribute.name(), value)
        };
        let mut result = Item {
            tag: node.tag_name().name(),
            attributes: node.attributes().map(own).collect(),
            at: (file, line),
            ..Item::default()
        };
        if depth > DEEPEST {
            let place = Place { file: self.names[file].clone(), line, element: result.label() };
            return Err(FormatError::one(
                place,
                format!("is nested more than {DEEPEST} elements deep; flatten the model"),
            ));
        }
        for child in node.children() {
            if child.is_text() {
                result.text.push_str(child.text().unwrap_or_default().trim());
            }
            if !child.is_element() {
                continue;
            }
            let child = self.item(child, file, ends, depth + 1)?;
            if child.tag == "include" {
                result.children.extend(self.include(&child, file)?);
            } else {
                result.children.push(child);
            }
        }
        Ok(result)
    }

    /// The content of an included file.
    fn include(&mut self, item: &Item, file: usize) -> Result<Vec<Item<'t>>, FormatError> {
        let place = Place { file: self.names[file].clone(), line: item.at.1, element: "<include>".into() };
        let Some(name) = item.get("file") else {
            return Err(FormatError::one(place, "the attribute `file` is missing; name the file to include"));
        };
        if self.names.iter().any(|known| known == name) {
            let what = format!("includes {name} a second time, which MuJoCo refuses; include it once");
            return Err(FormatError::one(place, what));
        }
        let bytes = (self.files)(name).map_err(|why| {
            FormatError::one(place.clone(), format!("includes {name}, which cannot be read: {why}; add the file"))
        })?;
        let text = String::from_utf8(bytes).map_err(|_| {
            FormatError::one(place, format!("includes {name}, which is not UTF-8 text; save it as UTF-8"))
        })?;
        self.names.push(name.to_owned());
        Ok(self.parsed(self.included.keep(text), self.names.len() - 1)?.children)
    }
}

impl<'t> Document<'t> {
    pub fn place_of(&self, at: (usize, usize), element: impl Into<String>) -> Place {
        Place { file: self.files.get(at.0).cloned().unwrap_or_default(), line: at.1, element: element.into() }
    }

    pub fn place(&self, item: &Item) -> Place {
        self.place_of(item.at, item.label())
    }

    /// Sections of this name, in the order of the file.
    pub fn sections<'a>(&'a self, tag: &'a str) -> impl Iterator<Item = &'a Item<'t>> {
        self.root.children.iter().filter(move |child| child.tag == tag)
    }

    fn collect_classes(&mut self) -> Result<(), FormatError> {
        let mut classes: HashMap<String, Class<'t>> = HashMap::new();
        classes.insert("main".into(), Class::new());
        let mut open: Vec<(&Item<'t>, Option<String>)> = self.sections("default").map(|item| (item, None)).collect();
        open.reverse();
        while let Some((item, parent)) = open.pop() {
            let name = match (item.get("class"), &parent) {
                (Some(name), _) => name.to_owned(),
                (None, None) => "main".to_owned(),
                (None, Some(_)) => {
                    let what = "a class inside another needs a name; write <default class=\"…\">";
                    return Err(FormatError::one(self.place(item), what));
                }
            };
            // The outermost class is the main one under whatever name.
            let mut class = match &parent {
                Some(parent) => classes.get(parent).cloned().unwrap_or_default(),
                None => classes.get("main").cloned().unwrap_or_default(),
            };
            for child in item.children.iter().filter(|child| child.tag != "default") {
                let known = class.entry(child.tag).or_default();
                for (attribute, value) in &child.attributes {
                    known.retain(|(other, _)| other != attribute);
                    known.push((*attribute, value.clone()));
                }
            }
            if parent.is_none() {
                classes.insert("main".into(), class.clone());
            }
            classes.insert(name.clone(), class);
            let inner = item.children.iter().filter(|child| child.tag == "default");
            let first = open.len();
            open.extend(inner.map(|child| (child, Some(name.clone()))));
            open[first..].reverse();
        }
        self.classes = classes;
        Ok(())
    }

    /// An element with its defaults written out: its own class, that of the bodies that it is in, or the main one.
    pub fn resolved(&self, item: &Item<'t>, childclass: Option<&str>) -> Result<Item<'t>, FormatError> {
        let name = item.get("class").or(childclass).unwrap_or("main");
        let Some(class) = self.classes.get(name) else {
            let near = nearest_name(name, self.classes.keys().map(String::as_str));
            let advice = near.map_or("define it in <default>".into(), |near| format!("did you mean \"{near}\"?"));
            return Err(FormatError::one(self.place(item), format!("there is no class \"{name}\"; {advice}")));
        };
        let defaults = class.get(item.tag).map_or(&[][..], Vec::as_slice);
        let mut attributes = Vec::with_capacity(item.attributes.len() + defaults.len());
        attributes.extend(item.attributes.iter().filter(|(name, _)| *name != "class").cloned());
        let mut result =
            Item { tag: item.tag, attributes, children: item.children.clone(), text: item.text.clone(), at: item.at };
        for (attribute, value) in defaults {
            if result.get(attribute).is_none() && !overruled(item, attribute) {
                result.attributes.push((*attribute, value.clone()));
            }
        }
        Ok(result)
    }
}

/// Whether an attribute of another name with the same purpose overrides a default.
fn overruled(item: &Item, attribute: &str) -> bool {
    const TURNS: [&str; 5] = ["quat", "axisangle", "euler", "xyaxes", "zaxis"];
    let stands = |names: &[&str]| names.iter().any(|name| item.get(name).is_some());
    match attribute {
        turn if TURNS.contains(&turn) => stands(&TURNS),
        "diaginertia" => stands(&["fullinertia"]),
        _ => false,
    }
}
