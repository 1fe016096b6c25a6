//! The elements, attributes and values of SDF and MJCF, from their specifications (`tests/oracle/vocabulary.py`).

/// MuJoCo's schema.
pub(crate) const MJCF: &str = include_str!("vocabulary/mjcf.txt");
/// The specification of SDF.
pub(crate) const SDF: &str = include_str!("vocabulary/sdf.txt");

/// The allowed content of an element.
#[derive(Debug, Default, PartialEq, Eq)]
pub(crate) struct Words {
    /// Attributes, each with its allowed values, if listed.
    pub attributes: Vec<(&'static str, Vec<&'static str>)>,
    pub children: Vec<&'static str>,
    /// Allowed values of its text, if listed.
    pub values: Vec<&'static str>,
}

impl Words {
    /// The listed values of an attribute.
    pub fn of(&self, attribute: &str) -> &[&'static str] {
        self.attributes.iter().find(|(name, _)| *name == attribute).map_or(&[], |(_, values)| values)
    }
}

/// The allowed content of the element at a path of tags from the root; `None` if the list has no such element.
pub(crate) fn words(list: &'static str, path: &[&str]) -> Option<Words> {
    let lines: Vec<&'static str> = list.lines().filter(|line| !line.starts_with('#')).collect();
    let depth = |line: &str| line.len() - line.trim_start().len();
    let tag = |line: &'static str| word_of(line).0.trim_start_matches('@');
    let root = |tag: &str| lines.iter().position(|line| depth(line) == 0 && word_of(line).0 == tag);
    let children = |at: usize| {
        let own = depth(lines[at]);
        let below = lines[at + 1..].iter().take_while(move |line| depth(line) > own).enumerate();
        below.filter(move |(_, line)| depth(line) == own + 1).map(move |(next, _)| at + 1 + next).collect::<Vec<_>>()
    };
    let (first, rest) = path.split_first()?;
    let mut at = root(first)?;
    for step in rest {
        at = children(at).into_iter().find(|child| tag(lines[*child]) == *step)?;
        if lines[at].trim_start().starts_with('@') {
            at = root(step)?;
        }
    }
    Some(Words {
        attributes: lines[at].split_whitespace().skip(1).map(pair).collect(),
        children: children(at).into_iter().map(|child| tag(lines[child])).collect(),
        values: word_of(lines[at]).1,
    })
}

/// The first word of a line, with its values.
fn word_of(line: &'static str) -> (&'static str, Vec<&'static str>) {
    pair(line.split_whitespace().next().unwrap_or_default())
}

/// `name=a|b` in its parts.
fn pair(word: &'static str) -> (&'static str, Vec<&'static str>) {
    word.split_once('=').map_or((word, Vec::new()), |(name, values)| (name, values.split('|').collect()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_leads_through_elements_that_contain_themselves() {
        let joint = words(MJCF, &["mujoco", "worldbody", "frame", "body", "body", "joint"]).unwrap();
        assert_eq!(joint.of("type"), ["hinge", "slide", "ball", "free"]);
        assert_eq!(words(MJCF, &["mujoco", "worldbody", "joint"]), None);
        let class = words(MJCF, &["mujoco", "default", "default", "geom"]).unwrap();
        assert!(class.attributes.iter().all(|(name, _)| *name != "name"), "a default has no name");
        let inertia = words(SDF, &["sdf", "world", "model", "model", "link", "inertial", "inertia"]).unwrap();
        assert_eq!(inertia.children, ["ixx", "ixy", "ixz", "iyy", "iyz", "izz"]);
        assert_eq!(words(SDF, &["sdf", "model", "static"]).unwrap().values, ["true", "false"]);
        assert_eq!(words(SDF, &["sdf", "model", "joint", "axis", "mimic"]).unwrap().children.len(), 3);
        assert_eq!(words(SDF, &["mujoco"]), None);
    }

    #[test]
    fn every_reference_of_the_lists_leads_somewhere() {
        for list in [MJCF, SDF] {
            for line in list.lines().filter_map(|line| line.trim_start().strip_prefix('@')) {
                assert!(words(list, &[line]).is_some(), "{line}");
            }
        }
    }
}
