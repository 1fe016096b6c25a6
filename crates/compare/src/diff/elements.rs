//! Compares elements other than links and joints - transmissions, simulator and controller settings, calibration -
//! value by value; poses in them are compared on the robot, independent of the link frame they refer to.

use crate::comparison::{PartDifference, PartKind};
use crate::diff::Options;
use crate::diff::alignment::Alignment;
use crate::mechanism::{Mechanism, PartPlace, PlacedElement, apart, by_path};
use crate::words;
use denavit_model::se3;
use std::collections::{HashMap, HashSet};

/// Numbers closer than this, relative, are equal.
const WRITTEN: f64 = 1e-9;

/// Every value that differs; `renamed` gives names of a under which b knows the same joint or link, `line` the line of a
/// byte offset in b's text.
pub(crate) fn compare(
    a: &Mechanism,
    b: &Mechanism,
    at: &Alignment,
    options: &Options,
    renamed: &HashMap<&str, &str>,
    line: &dyn Fn(usize) -> Option<usize>,
) -> Vec<PartDifference> {
    let in_b_words = |text: &str| with_names_of_b(text, renamed);
    let in_b: HashMap<&str, &PlacedElement> =
        b.elements.iter().map(|element| (element.label.as_str(), element)).collect();
    let mut found = Vec::new();
    let mut met: HashSet<&str> = HashSet::new();
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
        met.insert(&other.label);
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
        for (path, what) in moved(&(a, element), &(b, other), at, options, &in_b_words) {
            found.push(difference(&element.label, format!("{path} {what}"), Some(other.at)));
        }
        for (path, value) in other.entries.iter().filter(|(path, _)| left.contains_key(path.as_str())) {
            let what = if value.is_empty() { format!("{path} is new") } else { format!("{path}: {value} is new") };
            found.push(difference(&element.label, what, Some(other.at)));
        }
    }
    for element in b.elements.iter().filter(|element| !met.contains(element.label.as_str())) {
        found.push(difference(&element.label, "is new".into(), Some(element.at)));
    }
    found
}

/// Poses of the element that differ in b, by path, with the difference.
fn moved(
    (a, element): &(&Mechanism, &PlacedElement),
    (b, other): &(&Mechanism, &PlacedElement),
    at: &Alignment,
    options: &Options,
    in_b_words: &dyn Fn(&str) -> String,
) -> Vec<(String, String)> {
    if element.parts.is_empty() && other.parts.is_empty() {
        return Vec::new();
    }
    let mut left = by_path(&other.parts);
    let mut found = Vec::new();
    for part in &element.parts {
        let Some(now) = left.remove(in_b_words(&part.path).as_str()) else {
            found.push((part.path.clone(), "is gone".to_owned()));
            continue;
        };
        let by = match (&part.place, &now.place) {
            (PartPlace::Inside(one), PartPlace::Inside(other)) => apart(one, other),
            _ if !together(a, b, at, part.body, now.body) => {
                found.push((part.path.clone(), "moves with another body".to_owned()));
                continue;
            }
            (PartPlace::Pose(one), PartPlace::Pose(other)) => apart(&(at.moved[part.body] * one), other),
            (PartPlace::Point(one), PartPlace::Point(other)) => (0.0, (at.moved[part.body] * one - other).norm()),
            (PartPlace::Direction(one), PartPlace::Direction(other)) => {
                let one = at.moved[part.body].rotation * one;
                // A direction of friction has no sense.
                (se3::angle_between(&one, other).min(se3::angle_between(&-one, other)), 0.0)
            }
            _ => {
                found.push((part.path.clone(), "is specified differently".to_owned()));
                continue;
            }
        };
        if by.0 > options.tolerance_rad || by.1 > options.tolerance_m {
            let by = words::displacement(by, options.tolerance_rad, options.tolerance_m);
            found.push((part.path.clone(), by));
        }
    }
    found.extend(left.into_keys().map(|path| (path.to_owned(), "is new".to_owned())));
    found
}

/// Whether a body of b corresponds to one of a, ignoring joints that only b has.
fn together(a: &Mechanism, b: &Mechanism, at: &Alignment, in_a: usize, mut in_b: usize) -> bool {
    while let Some(joint) = in_b.checked_sub(1).filter(|joint| at.joint_a[*joint].is_none()) {
        in_b = b.joints[joint].parent.map_or(0, |parent| parent + 1);
    }
    at.body_b[in_a] == in_b || a.bodies.len() == 1 && b.bodies.len() == 1
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
