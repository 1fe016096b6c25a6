//! XML elements that say more of a robot than links and joints do: transmissions, dynamics, soft limits, simulators'
//! settings. They are kept as they are, so that they can be compared and written again.

use roxmltree::Node;
use std::collections::HashMap;

/// An element with everything in it.
#[derive(Debug, Clone, Default)]
pub struct Element {
    /// The element itself, then what is in it, parents before children, in the order of the file.
    pub nodes: Vec<ElementNode>,
    /// Byte offset of the element in the source text.
    pub at: usize,
}

/// Two elements are equal wherever they are in the text.
impl PartialEq for Element {
    fn eq(&self, other: &Self) -> bool {
        self.nodes == other.nodes
    }
}

impl Eq for Element {}

/// One element of an [`Element`]'s tree.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct ElementNode {
    /// Its depth; 0 for the element itself.
    pub depth: usize,
    /// Its tag as written, prefix included.
    pub tag: String,
    /// Attributes as written, prefix included, and their values.
    pub attributes: Vec<(String, String)>,
    /// Its own text, white space at both ends left out.
    pub text: String,
}

/// Below this depth elements are counted, not named: their paths would grow with the square of the depth.
const NAMED_DEPTH: usize = 32;

impl Element {
    /// An element as it is in the text that `node` was read from.
    pub(crate) fn of(node: Node, text: &str) -> Self {
        let mut nodes = Vec::new();
        let mut open = vec![(node, 0)];
        while let Some((node, depth)) = open.pop() {
            let mut own = String::new();
            for child in node.children().filter(Node::is_text) {
                own.push_str(child.text().unwrap_or_default());
            }
            let attributes = node.attributes().map(|attribute| {
                let written = text.get(attribute.range()).unwrap_or_default();
                let name = written.split('=').next().unwrap_or_default().trim_end();
                (name.to_owned(), attribute.value().to_owned())
            });
            nodes.push(ElementNode {
                depth,
                tag: tag_of(node, text),
                attributes: attributes.collect(),
                text: own.trim().to_owned(),
            });
            let first = open.len();
            open.extend(node.children().filter(Node::is_element).map(|child| (child, depth + 1)));
            open[first..].reverse();
        }
        Self { nodes, at: node.range().start }
    }

    /// An element without content.
    pub fn empty(tag: impl Into<String>, attributes: impl IntoIterator<Item = (String, String)>) -> Self {
        let attributes = attributes.into_iter().collect();
        Self { nodes: vec![ElementNode { tag: tag.into(), attributes, ..ElementNode::default() }], at: 0 }
    }

    /// Its tag as written.
    pub fn tag(&self) -> &str {
        self.nodes.first().map_or("", |node| &node.tag)
    }

    /// An attribute of the element itself.
    pub fn attribute(&self, name: &str) -> Option<&str> {
        self.nodes.first()?.attribute(name)
    }

    /// An attribute of the element itself as a finite number.
    pub fn number(&self, name: &str) -> Option<f64> {
        self.attribute(name)?.trim().parse().ok().filter(|number: &f64| number.is_finite())
    }

    /// A label that distinguishes it from others of its tag: `transmission "elbow"`, `gazebo of "forearm"`, `gazebo of plugin "control"`,
    /// or the tag alone.
    pub fn label(&self) -> String {
        let Some(node) = self.nodes.first() else { return String::new() };
        match (node.attribute("name"), node.attribute("reference")) {
            (Some(name), _) => format!("{} \"{name}\"", node.tag),
            (None, Some(link)) => format!("{} of \"{link}\"", node.tag),
            (None, None) => {
                let named = self.nodes.iter().skip(1).filter(|node| node.depth == 1);
                let mut named = named.filter_map(|node| Some((&node.tag, node.attribute("name")?)));
                named.next().map_or_else(|| node.tag.clone(), |(tag, name)| format!("{} of {tag} \"{name}\"", node.tag))
            }
        }
    }

    /// Every value in it under the path that leads there, such as `actuator "motor"/mechanicalReduction` or
    /// `@damping`; paths are unique, in the order of the file. Names that are part of a path are no values.
    pub fn entries(&self) -> Vec<(String, String)> {
        self.entries_without(&|_, _| false)
    }

    /// As [`Element::entries`], without what `read` says is read otherwise: a node's text and the node itself (`None`), or
    /// one of its attributes.
    pub fn entries_without(&self, read: &dyn Fn(usize, Option<&str>) -> bool) -> Vec<(String, String)> {
        let mut result = Vec::new();
        for (index, (node, here)) in self.nodes.iter().zip(self.paths()).enumerate() {
            let inside = self.nodes[index + 1..].iter().enumerate().take_while(|(_, next)| next.depth > node.depth);
            let mut inside = inside.filter(|(_, next)| next.depth == node.depth + 1);
            let holds = inside.any(|(offset, _)| !read(index + 1 + offset, None));
            let named = node.depth > 0 && node.attribute("name").is_some();
            let own = result.len();
            if !node.text.is_empty() && !read(index, None) {
                let words: Vec<&str> = node.text.split_whitespace().collect();
                result.push((here.clone(), words.join(" ")));
            }
            for (name, value) in &node.attributes {
                let in_label = name == "name" && (named || node.depth == 0) || name == "reference" && node.depth == 0;
                if !in_label && !read(index, Some(name)) {
                    let words: Vec<&str> = value.split_whitespace().collect();
                    result.push((format!("{here}@{name}"), words.join(" ")));
                }
            }
            if node.depth > 0 && result.len() == own && !holds && !read(index, None) {
                result.push((here, String::new()));
            }
        }
        result
    }

    /// The path to each node, unique among them; empty for the element itself.
    pub fn paths(&self) -> Vec<String> {
        let mut path: Vec<String> = Vec::new();
        let mut known: HashMap<String, usize> = HashMap::new();
        let mut result = Vec::with_capacity(self.nodes.len());
        for node in &self.nodes {
            let depth = node.depth.min(NAMED_DEPTH);
            path.truncate(depth.saturating_sub(1));
            if depth > 0 {
                let mut step = match node.attribute("name") {
                    Some(name) => format!("{} \"{name}\"", node.tag),
                    None => node.tag.clone(),
                };
                let whole = path.join("/") + "/" + &step;
                let count = known.entry(whole).and_modify(|count| *count += 1).or_insert(1);
                if *count > 1 {
                    step = format!("{step} [{count}]");
                }
                path.push(step);
            }
            result.push(path.join("/"));
        }
        result
    }
}

impl ElementNode {
    /// An attribute's value.
    pub fn attribute(&self, name: &str) -> Option<&str> {
        self.attributes.iter().find(|(known, _)| known == name).map(|(_, value)| value.as_str())
    }
}

/// The tag with its prefix, as it is in the text.
fn tag_of(node: Node, text: &str) -> String {
    let open = text.get(node.range().start + 1..).unwrap_or_default();
    let end = open.find(|c: char| c.is_whitespace() || c == '>' || c == '/').unwrap_or(open.len());
    open[..end].to_owned()
}

#[cfg(test)]
mod tests {
    use crate::urdf;

    #[test]
    fn every_value_of_a_transmission_has_a_path() {
        let text = r#"<robot name="r"><link name="a"/>
            <transmission name="t" type="simple"><joint name="j"/><actuator name="m"><mechanicalReduction> -100
            </mechanicalReduction></actuator><joint name="k"><offset/><offset>1 2</offset></joint></transmission></robot>"#;
        let robot = urdf::read("r.urdf", text).unwrap();
        assert_eq!(robot.elements[0].label(), "transmission \"t\"");
        let entries: Vec<String> =
            robot.elements[0].entries().into_iter().map(|(path, value)| format!("{path}: {value}")).collect();
        assert_eq!(
            entries,
            [
                "@type: simple",
                "joint \"j\": ",
                "actuator \"m\"/mechanicalReduction: -100",
                "joint \"k\"/offset: ",
                "joint \"k\"/offset [2]: 1 2"
            ]
        );
    }

    #[test]
    fn deep_elements_cost_no_more_than_their_text() {
        let depth = 20_000;
        let text = format!(
            "<robot name=\"r\"><link name=\"a\"/><gazebo>{}x{}</gazebo></robot>",
            "<d>".repeat(depth),
            "</d>".repeat(depth)
        );
        if let Ok(robot) = urdf::read("r.urdf", &text) {
            assert!(robot.elements[0].entries().last().unwrap().0.len() < 1000);
        }
    }
}
