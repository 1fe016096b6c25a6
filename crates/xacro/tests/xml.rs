//! Comparison of XML documents: names, attributes in any order, words, numbers to 1e-12; comments on request.

use roxmltree::{Document, Node};

/// Relative, with 1 as the smallest scale: both tools calculate with the same doubles, but sin and its like may differ in the
/// last place among platforms.
const TOLERANCE: f64 = 1e-12;

/// The first difference, or `None`.
pub fn difference(left: &str, right: &str) -> Option<String> {
    let read = |text| Document::parse(text).unwrap_or_else(|error| panic!("{error}: {text}"));
    let (left, right) = (read(left), read(right));
    nodes(left.root_element(), right.root_element(), "")
}

/// The comments, in order, white space simplified.
pub fn comments(text: &str) -> Vec<String> {
    let document = Document::parse(text).unwrap();
    let comments = document.root().descendants().filter(Node::is_comment);
    comments.map(|node| words(node.text().unwrap_or_default())).collect()
}

fn words(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

fn same_words(left: &str, right: &str) -> bool {
    let (left, right): (Vec<&str>, Vec<&str>) = (left.split_whitespace().collect(), right.split_whitespace().collect());
    left.len() == right.len()
        && left.iter().zip(&right).all(|(a, b)| {
            a == b
                || match (a.parse::<f64>(), b.parse::<f64>()) {
                    (Ok(a), Ok(b)) => (a - b).abs() <= TOLERANCE * a.abs().max(1.0),
                    _ => false,
                }
        })
}

fn content<'a>(node: Node<'a, 'a>) -> Vec<Node<'a, 'a>> {
    node.children()
        .filter(|child| child.is_element() || child.is_text() && !child.text().unwrap_or_default().trim().is_empty())
        .collect()
}

fn nodes(left: Node<'_, '_>, right: Node<'_, '_>, path: &str) -> Option<String> {
    if left.is_text() || right.is_text() {
        let (a, b) = (left.text().unwrap_or_default(), right.text().unwrap_or_default());
        let same = left.is_text() && right.is_text() && same_words(a, b);
        return (!same).then(|| format!("{path}: \"{}\" and \"{}\"", words(a), words(b)));
    }
    let path = format!("{path}/{}", left.tag_name().name());
    if left.tag_name() != right.tag_name() {
        return Some(format!("{path} and {}", right.tag_name().name()));
    }
    let sorted = |node: Node<'_, '_>| {
        let mut attributes: Vec<(Option<String>, String, String)> = node
            .attributes()
            .map(|a| (a.namespace().map(str::to_owned), a.name().to_owned(), a.value().to_owned()))
            .collect();
        attributes.sort();
        attributes
    };
    let (a, b) = (sorted(left), sorted(right));
    let same = a.len() == b.len() && a.iter().zip(&b).all(|(a, b)| a.0 == b.0 && a.1 == b.1 && same_words(&a.2, &b.2));
    if !same {
        return Some(format!("{path}: {a:?} and {b:?}"));
    }
    let (a, b) = (content(left), content(right));
    if let Some(found) = a.iter().zip(&b).find_map(|(a, b)| nodes(*a, *b, &path)) {
        return Some(found);
    }
    (a.len() != b.len()).then(|| format!("{path}: {} and {} children", a.len(), b.len()))
}
