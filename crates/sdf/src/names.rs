//! Unique names.

use std::collections::HashSet;

/// The name, or with a number where it is taken.
pub(crate) fn fresh(known: &mut HashSet<String>, wanted: &str) -> String {
    let mut name = wanted.to_owned();
    let mut count = 2;
    while !known.insert(name.clone()) {
        name = format!("{wanted}_{count}");
        count += 1;
    }
    name
}
