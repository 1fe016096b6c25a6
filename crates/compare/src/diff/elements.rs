//! What a file says beyond links and joints - transmissions, simulators' and controllers' settings, calibration -
//! compared value by value.

use crate::comparison::{PartDifference, PartKind};
use crate::mechanism::{Mechanism, PlacedElement};
use std::collections::HashMap;

/// Numbers closer than this, relative, are one number written twice.
const WRITTEN: f64 = 1e-9;

/// Every value that differs; `renamed` gives names of a under which b knows the same joint or link, `line` the line of a
/// byte offset in b's text.
pub(crate) fn compare(
    a: &Mechanism,
    b: &Mechanism,
    renamed: &HashMap<&str, &str>,
    line: &dyn Fn(usize) -> Option<usize>,
) -> Vec<PartDifference> {
    let in_b_words = |text: &str| with_names_of_b(text, renamed);
    let in_b: HashMap<&str, &PlacedElement> =
        b.elements.iter().map(|element| (element.label.as_str(), element)).collect();
    let mut found = Vec::new();
    let mut met: HashMap<&str, ()> = HashMap::new();
    let difference = |part: &str, what: String, at: Option<usize>| PartDifference {
        part: part.to_owned(),
        what,
        kind: PartKind::Element,
        line: at.and_then(line),
        counts: true,
        link: None,
    };
    for element in &a.elements {
        let label = in_b_words(&element.label);
        let Some(other) = in_b.get(label.as_str()) else {
            found.push(difference(&element.label, "is gone".into(), None));
            continue;
        };
        met.insert(&other.label, ());
        let mut left: HashMap<&str, &str> =
            other.entries.iter().map(|(path, value)| (path.as_str(), value.as_str())).collect();
        for (path, value) in &element.entries {
            match left.remove(in_b_words(path).as_str()) {
                None if value.is_empty() => found.push(difference(&element.label, format!("{path} is gone"), None)),
                None => found.push(difference(&element.label, format!("{path}: {value} is gone"), None)),
                Some(now) if same(&in_b_words(value), now) => {}
                Some(now) => {
                    found.push(difference(&element.label, format!("{path}: {value} to {now}"), Some(other.at)));
                }
            }
        }
        for (path, value) in other.entries.iter().filter(|(path, _)| left.contains_key(path.as_str())) {
            let what = if value.is_empty() { format!("{path} is new") } else { format!("{path}: {value} is new") };
            found.push(difference(&element.label, what, Some(other.at)));
        }
    }
    for element in b.elements.iter().filter(|element| !met.contains_key(element.label.as_str())) {
        found.push(difference(&element.label, "is new".into(), Some(element.at)));
    }
    found
}

/// A value, or names in quotes in a label or path, as b has them.
fn with_names_of_b(text: &str, renamed: &HashMap<&str, &str>) -> String {
    if let Some(name) = renamed.get(text) {
        return (*name).to_owned();
    }
    if renamed.is_empty() || !text.contains('"') {
        return text.to_owned();
    }
    let pieces = text.split('"').enumerate().map(|(index, piece)| match renamed.get(piece) {
        Some(name) if index % 2 == 1 => *name,
        _ => piece,
    });
    pieces.collect::<Vec<_>>().join("\"")
}

/// Whether two values are the same: word by word, numbers as numbers.
fn same(one: &str, other: &str) -> bool {
    if one == other {
        return true;
    }
    let (mut x, mut y) = (one.split_whitespace(), other.split_whitespace());
    loop {
        match (x.next(), y.next()) {
            (None, None) => return true,
            (Some(x), Some(y)) if x == y => {}
            (Some(x), Some(y)) => match (x.parse::<f64>(), y.parse::<f64>()) {
                (Ok(x), Ok(y)) if (x - y).abs() <= WRITTEN * x.abs() => {}
                _ => return false,
            },
            _ => return false,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_compared_as_numbers_and_names_as_those_of_the_other_robot() {
        assert!(same("1 2.0 x", "1.0 2 x") && !same("1 2", "1 3") && !same("1", "1 2") && !same("-100", "1"));
        let renamed = HashMap::from([("elbow", "joint_3")]);
        assert_eq!(with_names_of_b("joint \"elbow\"/offset", &renamed), "joint \"joint_3\"/offset");
        assert_eq!(with_names_of_b("elbow", &renamed), "joint_3");
    }
}
