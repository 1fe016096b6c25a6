//! Known findings of a repository, so that only new ones count.

use crate::lint::Finding;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use thiserror::Error;

/// What a baseline is called, and its version.
const SCHEMA: &str = "denavit.baseline/1";

/// Known findings: how many of each rule each element of each file has.
///
/// It holds no lines, so moving an element creates no new finding. It holds no messages either, so a changed value
/// under a known finding, or the wording of another version, creates no new finding.
///
/// # Examples
/// ```
/// use denavit_compare::lint::{Baseline, Config, Lookup, check};
/// let text = |above: &str| format!(r#"<robot name="r">{above}<link name="a"/><link name="b"/><joint name="j"
///   type="continuous"><axis xyz="0 0 2"/><parent link="a"/><child link="b"/></joint></robot>"#);
/// let found = |text: &str| check("arm.urdf", text, &|_| Lookup::Unknown, &Config::default());
/// let mut known = Baseline::default();
/// known.add("arm.urdf", &found(&text("")));
/// let (new, count) = known.new_among("arm.urdf", found(&text("\n\n<!-- moved down -->\n")));
/// assert_eq!((new.len(), count), (0, 1));
/// ```
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Baseline {
    /// By file, rule and element.
    files: BTreeMap<String, BTreeMap<String, BTreeMap<String, usize>>>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Written {
    schema: String,
    files: BTreeMap<String, BTreeMap<String, BTreeMap<String, usize>>>,
}

/// Why a file is not a baseline.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum BaselineError {
    /// Not the JSON that is expected.
    #[error("{file}:{line}: this is not a baseline: {message}; write one with ‹write-baseline›")]
    Json {
        /// The file.
        file: String,
        /// Counted from 1.
        line: usize,
        /// What the parser says.
        message: String,
    },
    /// Another version's.
    #[error("{file}: schema \"{found}\" is not \"{SCHEMA}\"; write a new baseline with ‹write-baseline›")]
    Schema {
        /// The file.
        file: String,
        /// As written.
        found: String,
    },
}

impl Baseline {
    /// From the text of a file.
    ///
    /// # Errors
    /// It is not a baseline.
    pub fn read(file: &str, text: &str) -> Result<Self, BaselineError> {
        let text = text.trim_start_matches('\u{feff}');
        let written: Written = serde_json::from_str(text).map_err(|error| {
            let words = error.to_string();
            let message = words.split(" at line ").next().unwrap_or_default().to_owned();
            BaselineError::Json { file: file.to_owned(), line: error.line().max(1), message }
        })?;
        if written.schema != SCHEMA {
            return Err(BaselineError::Schema { file: file.to_owned(), found: written.schema });
        }
        Ok(Self { files: written.files })
    }

    /// The text of a file: sorted, a line for each element, so that git merges it.
    pub fn text(&self) -> String {
        let written = Written { schema: SCHEMA.to_owned(), files: self.files.clone() };
        serde_json::to_string_pretty(&written).expect("plain values with text keys") + "\n"
    }

    /// Adds the findings of a file; `path` is what the baseline calls it.
    pub fn add(&mut self, path: &str, findings: &[Finding]) {
        for finding in findings {
            let rules = self.files.entry(path.to_owned()).or_default();
            let elements = rules.entry(finding.rule.to_owned()).or_default();
            *elements.entry(finding.place.element.clone()).or_default() += 1;
        }
    }

    /// The findings of a file that are not known, and how many are. If a rule has more findings in an element than are
    /// known, the last are new.
    pub fn new_among(&self, path: &str, findings: Vec<Finding>) -> (Vec<Finding>, usize) {
        let mut left = self.files.get(path).cloned().unwrap_or_default();
        let count = findings.len();
        let new: Vec<Finding> = findings
            .into_iter()
            .filter(|finding| {
                let known = left.get_mut(finding.rule).and_then(|elements| elements.get_mut(&finding.place.element));
                match known {
                    Some(known) if *known > 0 => {
                        *known -= 1;
                        false
                    }
                    _ => true,
                }
            })
            .collect();
        let known = count - new.len();
        (new, known)
    }

    /// How many findings are known of a file.
    pub fn known_of(&self, path: &str) -> usize {
        self.files.get(path).into_iter().flat_map(BTreeMap::values).flat_map(BTreeMap::values).sum()
    }

    /// How many findings are known in all.
    pub fn len(&self) -> usize {
        self.files.keys().map(|path| self.known_of(path)).sum()
    }

    /// Whether nothing is known.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::Level;
    use denavit_model::Place;

    fn finding(rule: &'static str, line: usize, element: &str) -> Finding {
        let place = Place { file: "a.urdf".into(), line, element: element.into() };
        Finding { rule, level: Level::Error, place, message: format!("line {line}"), fix: Vec::new() }
    }

    #[test]
    fn one_more_of_a_known_kind_is_new_and_so_is_another_file() {
        let mut known = Baseline::default();
        known.add("a.urdf", &[finding("D010", 3, "joint \"j\""), finding("D010", 4, "joint \"j\"")]);
        let known = Baseline::read("b.json", &known.text()).unwrap();
        let now = || [7, 8, 9].map(|line| finding("D010", line, "joint \"j\"")).to_vec();
        let (new, count) = known.new_among("a.urdf", now());
        assert_eq!((new.len(), new[0].place.line, count), (1, 9, 2));
        assert_eq!(known.new_among("b.urdf", now()).0.len(), 3);
        assert_eq!(known.new_among("a.urdf", vec![finding("D011", 3, "joint \"j\"")]).0.len(), 1);
        assert_eq!((known.len(), known.known_of("b.urdf")), (2, 0));
    }

    #[test]
    fn what_is_no_baseline_is_refused_with_its_line() {
        let read = |text: &str| Baseline::read("b.json", text).unwrap_err().to_string();
        assert!(
            read("{\n\"schema\": 1}").starts_with("b.json:2: this is no baseline: invalid type"),
            "{}",
            read("{\n\"schema\": 1}")
        );
        assert!(read("").starts_with("b.json:1: "), "{}", read(""));
        assert!(read("{\"schema\": \"denavit.check/1\", \"files\": {}}").contains("schema \"denavit.check/1\""));
    }
}
