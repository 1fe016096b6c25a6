//! File names with `*`, `?` and `[…]`.

use std::path::{Component, Path, PathBuf};

use super::expander::Outcome;
use crate::files;
use crate::limits::Meter;

pub(super) fn is_pattern(name: &str) -> bool {
    name.contains(['*', '?', '['])
}

/// The files that match, sorted. Names that begin with a dot match only a pattern that does.
pub(super) fn files_matching(pattern: &Path, meter: &mut Meter) -> Outcome<Vec<PathBuf>> {
    let mut found = vec![PathBuf::new()];
    for component in pattern.components() {
        let Component::Normal(name) = component else {
            for path in &mut found {
                path.push(component);
            }
            continue;
        };
        let name = name.to_string_lossy();
        if !is_pattern(&name) {
            for path in &mut found {
                path.push(&*name);
            }
            continue;
        }
        let wanted: Vec<char> = name.chars().collect();
        let mut next = Vec::new();
        for folder in found {
            let here = if folder.as_os_str().is_empty() { Path::new(".") } else { &folder };
            for entry in files::entries(here) {
                let Some(entry) = entry.file_name().map(|name| name.to_string_lossy().into_owned()) else { continue };
                meter.step(entry.len() * wanted.len())?;
                let hidden = entry.starts_with('.') && !name.starts_with('.');
                if !hidden && matches(&wanted, &entry.chars().collect::<Vec<_>>()) {
                    next.push(folder.join(entry));
                }
            }
        }
        found = next;
    }
    found.retain(|path| files::exists(path));
    found.sort();
    Ok(found)
}

/// Goes back to the last `*` when the rest does not fit.
fn matches(pattern: &[char], name: &[char]) -> bool {
    let (mut p, mut n) = (0, 0);
    let mut star: Option<(usize, usize)> = None;
    while n < name.len() {
        let step = match pattern.get(p) {
            Some('*') => {
                star = Some((p + 1, n));
                p += 1;
                continue;
            }
            Some('?') => Some(1),
            Some('[') => class(&pattern[p..], name[n]),
            Some(c) if *c == name[n] => Some(1),
            _ => None,
        };
        match (step, star) {
            (Some(length), _) => {
                p += length;
                n += 1;
            }
            (None, Some((after, from))) => {
                p = after;
                n = from + 1;
                star = Some((after, n));
            }
            (None, None) => return false,
        }
    }
    pattern[p..].iter().all(|c| *c == '*')
}

/// The length of a `[…]` that holds `c`.
fn class(pattern: &[char], c: char) -> Option<usize> {
    let end = pattern.iter().skip(2).position(|c| *c == ']')? + 2;
    let inner = &pattern[1..end];
    let (negated, inner) = match inner {
        ['!', rest @ ..] if !rest.is_empty() => (true, rest),
        _ => (false, inner),
    };
    let mut held = false;
    let mut at = 0;
    while at < inner.len() {
        if let [low, '-', high, ..] = inner[at..] {
            held |= (low..=high).contains(&c);
            at += 3;
        } else {
            held |= inner[at] == c;
            at += 1;
        }
    }
    (held != negated).then_some(end + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn patterns_match_as_in_a_shell() {
        let check = |pattern: &str, name: &str, expected: bool| {
            let split = |text: &str| text.chars().collect::<Vec<_>>();
            assert_eq!(matches(&split(pattern), &split(name)), expected, "{pattern} {name}");
        };
        check("*.xacro", "arm.xacro", true);
        check("*.xacro", "arm.xacro.bak", false);
        check("a*b*c", "aXbXbXc", true);
        check("link[0-9]?.urdf", "link3a.urdf", true);
        check("link[!0-9].urdf", "link3.urdf", false);
        check("[", "[", false);
    }
}
