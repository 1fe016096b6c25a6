//! The expanded tree as text.

use std::fmt::Write as _;

use crate::trace::{AttributeOrigin, ElementOrigin};
use crate::tree::{Element, Node};

/// The text, and where its elements come from.
pub(crate) struct Written {
    pub text: String,
    trace: bool,
    pub elements: Vec<ElementOrigin>,
}

const INDENT: &str = "  ";

/// Writes a document: two spaces for each level, attributes in their order, comments kept.
pub(crate) fn document(before: &[Node], root: &Element, after: &[Node], trace: bool) -> Written {
    let text = String::from("<?xml version=\"1.0\"?>\n");
    let mut out = Written { text, trace, elements: Vec::new() };
    for node in before {
        write_node(&mut out, node, 0);
    }
    write_element(&mut out, root, 0, true);
    for node in after {
        write_node(&mut out, node, 0);
    }
    out
}

fn write_node(out: &mut Written, node: &Node, level: usize) {
    if let Node::Element(element) = node {
        return write_element(out, element, level, true);
    }
    if let Node::Text(text) = node
        && text.value.trim().is_empty()
    {
        return;
    }
    out.text.push_str(&INDENT.repeat(level));
    write_inline(out, node);
    out.text.push('\n');
}

fn write_inline(out: &mut Written, node: &Node) {
    if let Node::Element(element) = node {
        return write_element(out, element, 0, false);
    }
    let out = &mut out.text;
    match node {
        Node::Element(_) => {}
        Node::Text(text) => escape(out, &text.value, false),
        // "]]>" would end the section.
        Node::Cdata(value) => {
            let _ = write!(out, "<![CDATA[{}]]>", value.replace("]]>", "]]]]><![CDATA[>"));
        }
        Node::Comment(text) => {
            // Two dashes would end the comment.
            let safe = text.value.replace("--", "- -");
            let safe = safe.strip_suffix('-').map_or(safe.clone(), |start| format!("{start}- "));
            let _ = write!(out, "<!--{safe}-->");
        }
        Node::Instruction { target, value } => {
            let space = if value.is_empty() { "" } else { " " };
            let _ = write!(out, "<?{target}{space}{value}?>");
        }
    }
}

fn write_element(written: &mut Written, element: &Element, level: usize, pretty: bool) {
    let (indent, newline) = if pretty { (INDENT.repeat(level), "\n") } else { (String::new(), "") };
    let trace = written.trace;
    let out = &mut written.text;
    let at = out.len() + indent.len();
    let _ = write!(out, "{indent}<{}", element.name);
    let mut origins = Vec::new();
    let namespaces = element.namespaces.iter().map(|(name, value)| (name, value, None));
    let attributes =
        element.attributes.iter().map(|attribute| (&attribute.name, &attribute.value, Some(&attribute.range)));
    for (name, value, range) in namespaces.chain(attributes) {
        let _ = write!(out, " {name}=\"");
        let start = out.len();
        escape(out, value, true);
        if let (true, Some(source)) = (trace, range) {
            origins.push(AttributeOrigin { at: start..out.len(), source: source.clone() });
        }
        out.push('"');
    }
    if trace {
        written.elements.push(ElementOrigin {
            at,
            spot: element.spot(),
            attributes: origins,
            calls: element.calls.clone(),
        });
    }
    let out = &mut written.text;
    let is_blank = |node: &Node| matches!(node, Node::Text(text) if text.value.trim().is_empty());
    let has_words =
        element.children.iter().any(|node| matches!(node, Node::Text(_) | Node::Cdata(_)) && !is_blank(node));
    if element.children.iter().all(is_blank) {
        let _ = write!(out, "/>{newline}");
        return;
    }
    out.push('>');
    if has_words || !pretty {
        // White space next to words may matter.
        for child in &element.children {
            write_inline(written, child);
        }
        let _ = write!(written.text, "</{}>{newline}", element.name);
        return;
    }
    out.push('\n');
    for child in &element.children {
        write_node(written, child, level + 1);
    }
    let _ = write!(written.text, "{indent}</{}>{newline}", element.name);
}

fn escape(out: &mut String, text: &str, in_attribute: bool) {
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' if in_attribute => out.push_str("&quot;"),
            '\n' | '\t' if in_attribute => {
                let _ = write!(out, "&#{};", u32::from(c));
            }
            '\r' => out.push_str("&#13;"),
            // Characters that XML has no way to write.
            '\0'..='\u{8}' | '\u{b}' | '\u{c}' | '\u{e}'..='\u{1f}' | '\u{fffe}' | '\u{ffff}' => {
                out.push('\u{fffd}');
            }
            c => out.push(c),
        }
    }
}
