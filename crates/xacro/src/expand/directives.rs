//! Elements with the prefix `xacro`.

use std::rc::Rc;

use super::Argument;
use super::expander::{Expander, Outcome, Sight};
use super::output::Output;
use crate::error::{ErrorKind, XacroError};
use crate::expression::{Value, parse_integer};
use crate::place::Spot;
use crate::tree::{Element, Node};

/// Names that old xacro versions allowed without the prefix, and that nobody else uses.
const OLD_NAMES: &[&str] = &["macro", "if", "unless", "insert_block"];

impl Expander<'_> {
    /// Evaluates one child element into `output`.
    pub fn dispatch(&mut self, element: &Rc<Element>, sight: &Sight, output: &mut Output) -> Outcome<()> {
        let Some(name) = element.name.strip_prefix("xacro:") else {
            if OLD_NAMES.contains(&&*element.name) {
                self.note(
                    &element.spot(),
                    format!("<{0}> is kept as it is: if it is meant for xacro, write <xacro:{0}>", element.name),
                );
            }
            let produced = self.element(element, sight)?;
            output.push(Node::Element(Rc::new(produced)));
            return Ok(());
        };
        match name {
            "property" => {
                output.drop_comments();
                self.property(element, sight)?;
                output.close_directive();
            }
            "macro" => {
                output.drop_comments();
                self.define_macro(element, sight)?;
                output.close_directive();
            }
            "arg" => {
                self.declare_argument(element, sight)?;
                output.drop_comments();
                output.close_directive();
            }
            "include" => {
                self.include(element, sight, output)?;
                output.close_directive();
            }
            "if" | "unless" => {
                output.drop_comments();
                self.condition(element, name == "if", sight, output)?;
                output.close_directive();
            }
            "insert_block" => self.insert_block(element, sight, output)?,
            "element" => self.named_element(element, sight, output)?,
            "attribute" => self.added_attribute(element, sight, output)?,
            "call" => self.dynamic_call(element, sight, output)?,
            _ => self.call(element, name, sight, output)?,
        }
        Ok(())
    }

    /// The values of the `required` attributes, which must be there; others than these and `optional` are noted.
    pub fn attributes<'e, const N: usize>(
        &mut self,
        element: &'e Element,
        required: [&str; N],
        optional: &[&str],
    ) -> Outcome<[&'e crate::tree::Attribute; N]> {
        for attribute in &element.attributes {
            if !required.contains(&&*attribute.name) && !optional.contains(&&*attribute.name) {
                let spot = element.spot_of(attribute);
                self.note(
                    &spot,
                    format!("<{}> does not take the attribute \"{}\": it is ignored", element.name, attribute.name),
                );
            }
        }
        let mut found = Vec::with_capacity(N);
        for name in required {
            found.push(element.attribute(name).ok_or_else(|| {
                Self::wrong(element, format!("<{}> has no attribute \"{name}\"", element.name))
                    .help(format!("add {name}=\"…\""))
            })?);
        }
        Ok(found.try_into().expect("one was pushed for each of N names"))
    }

    /// Notes what is in an element whose content means nothing.
    pub fn note_content(&mut self, element: &Element) {
        let words = element.children.iter().find_map(|child| match child {
            Node::Element(child) => Some((child.spot(), format!("<{}>", child.name))),
            Node::Text(text) if !text.value.trim().is_empty() => Some((text.spot.clone(), text_of(&text.value))),
            Node::Cdata(text) => Some((element.spot(), text_of(text))),
            _ => None,
        });
        if let Some((spot, what)) = words {
            self.note(&spot, format!("{what} in <{}> is not understood: it is ignored", element.name));
        }
    }

    /// Whether a value is true; only truth values and integers are valid.
    pub fn truth(value: &Value, text: &str, spot: &Spot) -> Outcome<bool> {
        let Value::Text(words) = value else { return Ok(value.is_true()) };
        match &**words {
            "true" | "True" => Ok(true),
            "false" | "False" => Ok(false),
            words => parse_integer(words).map(|integer| integer != 0).ok_or_else(|| {
                let shown = if words == text { String::new() } else { format!(" is \"{words}\", which") };
                XacroError::new(
                    ErrorKind::Evaluation,
                    format!("the condition \"{text}\"{shown} is neither true nor false"),
                )
                .help("write true, false, an integer, or a comparison in ${…}")
                .at(spot)
            }),
        }
    }

    fn condition(&mut self, element: &Rc<Element>, wanted: bool, sight: &Sight, output: &mut Output) -> Outcome<()> {
        let [condition] = self.attributes(element, ["value"], &[])?;
        let spot = element.spot_of(condition);
        let value = self.value(&condition.value, &spot, &sight.symbols)?;
        if Self::truth(&value, &condition.value, &spot)? == wanted {
            let mut inner = Output::new(element.bare(), false);
            self.children(element, sight, &mut inner)?;
            output.extend(inner.element.children);
        }
        Ok(())
    }

    fn declare_argument(&mut self, element: &Rc<Element>, sight: &Sight) -> Outcome<()> {
        let [name, default] = self.attributes(element, ["name", "default"], &[])?;
        self.note_content(element);
        let name_text = name.value.to_string();
        let value = if let Some(value) = self.arguments.get(&name_text) {
            value.clone()
        } else {
            let value = self.words(&default.value, &element.spot_of(default), &sight.symbols)?.to_string();
            self.arguments.insert(name_text.clone(), value.clone());
            value
        };
        if !self.declared.iter().any(|argument| argument.name == name_text) {
            self.declared.push(Argument { name: name_text, default: Some(default.value.to_string()), value });
        }
        Ok(())
    }

    fn insert_block(&mut self, element: &Rc<Element>, sight: &Sight, output: &mut Output) -> Outcome<()> {
        let [name] = self.attributes(element, ["name"], &[])?;
        self.note_content(element);
        let name_text = &name.value;
        let mut block = |stars: &str| self.name(&format!("{stars}{name_text}"), &element.spot(), &sight.symbols);
        if let Some(Value::Block(block)) = block("**")? {
            if let Some(attribute) = block.attributes.first().filter(|_| &*block.name != "xacro:property") {
                let message = format!(
                    "the attribute \"{}\" of <{}> is ignored: a block \"**{name_text}\" inserts only its children",
                    attribute.name, block.name
                );
                self.note(&element.spot(), message);
            }
            let mut inner = Output::new(block.bare(), false);
            self.children(&block, sight, &mut inner)?;
            output.extend(inner.element.children);
            return Ok(());
        }
        if let Some(Value::Block(block)) = block("*")? {
            // A block has been evaluated where it was written; what is left in it is evaluated here.
            let mut inner = Output::new(block.bare(), false);
            let holder = Element { children: vec![Node::Element(block)], ..element.bare() };
            self.plain_children(&holder, sight, &mut inner)?;
            output.extend(inner.element.children);
            return Ok(());
        }
        let names = sight.symbols.names();
        let blocks = names.iter().filter_map(|name| name.strip_prefix('*')).map(|name| name.trim_start_matches('*'));
        let alike = crate::error::near(name_text, blocks);
        let error = XacroError::new(ErrorKind::UndefinedName, format!("there is no block \"{name_text}\""));
        Err(match crate::error::did_you_mean(&alike) {
            Some(question) => error.help(question),
            None => error.help(format!("a block is a macro's parameter \"*{name_text}\" or \"**{name_text}\"")),
        }
        .at(&element.spot_of(name)))
    }

    /// Evaluates the children without checking whether they are xacro elements themselves.
    fn plain_children(&mut self, holder: &Element, sight: &Sight, output: &mut Output) -> Outcome<()> {
        for child in holder.elements() {
            let produced = self.element(child, sight)?;
            output.push(Node::Element(Rc::new(produced)));
        }
        Ok(())
    }

    fn named_element(&mut self, element: &Rc<Element>, sight: &Sight, output: &mut Output) -> Outcome<()> {
        let name = element.attribute("xacro:name").ok_or_else(|| {
            Self::wrong(element, "<xacro:element> has no attribute \"xacro:name\"").help("add xacro:name=\"…\"")
        })?;
        let spot = element.spot_of(name);
        let words = self.words(&name.value, &spot, &sight.symbols)?;
        check_name(&words, "element", &spot)?;
        let mut renamed = Element::clone(element);
        renamed.attributes.retain(|attribute| &*attribute.name != "xacro:name");
        renamed.name = words;
        if &*renamed.name == "xacro:element" {
            return Err(Self::wrong(element, "<xacro:element> cannot produce itself"));
        }
        self.dispatch(&Rc::new(renamed), sight, output)
    }

    fn added_attribute(&mut self, element: &Rc<Element>, sight: &Sight, output: &mut Output) -> Outcome<()> {
        let [name, value] = self.attributes(element, ["name", "value"], &[])?;
        self.note_content(element);
        let spot = element.spot_of(name);
        let words = self.words(&name.value, &spot, &sight.symbols)?;
        check_name(&words, "attribute", &spot)?;
        let content = self.words(&value.value, &element.spot_of(value), &sight.symbols)?;
        if output.is_written {
            output.set_attribute(words, content, value.range.clone());
        } else {
            self.note(
                &element.spot(),
                format!("<xacro:attribute> \"{words}\" has no effect here: it must be a direct child of the element that gets it"),
            );
        }
        Ok(())
    }
}

/// A text as messages show it, cut to a readable length.
pub(super) fn text_of(words: &str) -> String {
    const SHOWN: usize = 40;
    let words = words.trim();
    match words.char_indices().nth(SHOWN) {
        Some((end, _)) => format!("the text \"{}…\"", &words[..end]),
        None => format!("the text \"{words}\""),
    }
}

/// Names that come from expressions must be names of XML.
fn check_name(name: &str, what: &str, spot: &Spot) -> Outcome<()> {
    let is_start = |c: char| c.is_alphabetic() || c == '_' || c == ':';
    let is_inner = |c: char| is_start(c) || c.is_numeric() || c == '-' || c == '.';
    if name.starts_with(is_start) && name.chars().all(is_inner) {
        return Ok(());
    }
    Err(XacroError::new(ErrorKind::Element, format!("\"{name}\" cannot be the name of an {what}")).at(spot))
}
