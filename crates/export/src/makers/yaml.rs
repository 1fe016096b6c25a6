//! The scalars of a YAML document by path, and which of them were read.

use super::KEYS;
use crate::kinematics_yaml::KinematicsFileError;
use denavit_model::notes::{Note, Place};
use denavit_model::units::Unit;
use denavit_model::words::quoted;
use denavit_model::{Inventory, Quantity};
use saphyr_parser::{Event, Parser};
use std::cell::Cell;

/// A document's scalars: path (keys, and places in lists), text, line.
pub(crate) struct Scalars {
    pub file: String,
    all: Vec<Scalar>,
}

struct Scalar {
    path: Vec<String>,
    text: String,
    /// The text after its `!`.
    tag: Option<String>,
    line: usize,
    read: Cell<bool>,
}

/// A table as cells: statements about it, headings, rows; each with its line.
pub(crate) struct Cells {
    pub words: Vec<(usize, String)>,
    pub headings: Vec<String>,
    pub rows: Vec<(usize, Vec<String>)>,
}

/// What the parser is inside of.
enum Level {
    Map { key: Option<String>, seen: Vec<String> },
    List(usize),
}

impl Scalars {
    pub fn read(file: &str, text: &str) -> Result<Self, KinematicsFileError> {
        let mut levels: Vec<Level> = Vec::new();
        let mut all: Vec<Scalar> = Vec::new();
        let mut documents = 0;
        for event in Parser::new_from_str(text) {
            let (event, span) = event.map_err(|error| KinematicsFileError::Yaml {
                file: file.into(),
                line: error.marker().line(),
                what: error.info().into(),
            })?;
            let line = span.start.line();
            let refused = |what: String| KinematicsFileError::Yaml { file: file.into(), line, what };
            let is_key = matches!(levels.last(), Some(Level::Map { key: None, .. }));
            match event {
                Event::DocumentStart(_) => {
                    documents += 1;
                    if documents > 1 {
                        return Err(refused("a second document begins here; keep one per file".into()));
                    }
                }
                Event::Alias(_) => return Err(refused("aliases are not read; write the value itself".into())),
                Event::MappingStart(..) | Event::SequenceStart(..) if is_key => {
                    return Err(refused("a key is a list or a map; use a plain word as key".into()));
                }
                Event::MappingStart(..) => levels.push(Level::Map { key: None, seen: Vec::new() }),
                Event::SequenceStart(..) => levels.push(Level::List(0)),
                Event::MappingEnd | Event::SequenceEnd => {
                    levels.pop();
                    value_ends(&mut levels);
                }
                Event::Scalar(value, _, _, tag) => {
                    if let (true, Some(Level::Map { key, seen })) = (is_key, levels.last_mut()) {
                        let value = value.into_owned();
                        if seen.contains(&value) {
                            return Err(refused(format!("the key \"{}\" appears twice; remove one", quoted(&value))));
                        }
                        seen.push(value.clone());
                        *key = Some(value);
                        continue;
                    }
                    let path = levels.iter().map(Level::place).collect();
                    let tag = tag.filter(|tag| tag.handle == "!").map(|tag| tag.suffix.clone());
                    all.push(Scalar { path, text: value.into_owned(), tag, line, read: Cell::new(false) });
                    value_ends(&mut levels);
                }
                _ => {}
            }
        }
        Ok(Self { file: file.to_owned(), all })
    }

    /// Whether there is anything below this path.
    pub fn has(&self, path: &[&str]) -> bool {
        self.all
            .iter()
            .any(|scalar| scalar.path.len() > path.len() && scalar.path.iter().zip(path).all(|(a, b)| a == b))
    }

    /// The paths above every key of this name.
    pub fn above(&self, key: &str) -> Vec<Vec<String>> {
        let mut found: Vec<Vec<String>> = Vec::new();
        for scalar in &self.all {
            if let Some(at) = scalar.path.iter().position(|part| part == key)
                && !found.iter().any(|known| known[..] == scalar.path[..at])
            {
                found.push(scalar.path[..at].to_vec());
            }
        }
        found
    }

    /// The rows of a D-H table: maps in a list, or under names, in one place of the document. Scalars next to it that state
    /// convention or units are returned as words.
    pub fn table(&self) -> Option<Cells> {
        let row_of = |scalar: &Scalar| scalar.path.len().checked_sub(2).map(|at| scalar.path[..=at].to_vec());
        let mut places: Vec<Vec<String>> = Vec::new();
        for scalar in &self.all {
            if let Some(row) = row_of(scalar) {
                let place = row[..row.len() - 1].to_vec();
                if !places.contains(&place) {
                    places.push(place);
                }
            }
        }
        let mut found = places.into_iter().filter_map(|place| self.cells_at(&place));
        let cells = found.next()?;
        found.next().is_none().then_some(cells)
    }

    fn cells_at(&self, place: &[String]) -> Option<Cells> {
        let of_table = |scalar: &&Scalar| scalar.path.len() == place.len() + 2 && scalar.path[..place.len()] == *place;
        let mut headings: Vec<String> = Vec::new();
        let mut rows: Vec<(String, usize, Vec<String>)> = Vec::new();
        for scalar in self.all.iter().filter(of_table) {
            let (row, key) = (&scalar.path[place.len()], &scalar.path[place.len() + 1]);
            let column = headings.iter().position(|known| known == key).unwrap_or_else(|| {
                headings.push(key.clone());
                headings.len() - 1
            });
            if rows.last().is_none_or(|(known, ..)| known != row) {
                rows.push((row.clone(), scalar.line, Vec::new()));
            }
            let (.., cells) = rows.last_mut()?;
            cells.resize(cells.len().max(column + 1), String::new());
            cells[column].clone_from(&scalar.text);
        }
        if !crate::sources::is_table_header(&headings) {
            return None;
        }
        let mut words = Vec::new();
        for scalar in &self.all {
            let says = |key: &str| {
                ["convention", "robot"].contains(&key) || key.split(['_', ' ']).any(|w| ["unit", "units"].contains(&w))
            };
            let below = scalar.path.len() == place.len().max(1) || scalar.path.len() == 1;
            if of_table(&scalar) {
                scalar.read.set(true);
            } else if let (true, Some(key)) = (below, scalar.path.last().filter(|key| says(&key.to_lowercase()))) {
                scalar.read.set(true);
                words.push((scalar.line, format!("{}: {}", key.replace('_', " "), scalar.text)));
            }
        }
        // Rows under names have them as the joints' names.
        let named = rows.iter().any(|(row, ..)| row.parse::<usize>().is_err());
        if named && !headings.iter().any(|heading| heading.to_lowercase() == "joint") {
            headings.push("joint".into());
            for (row, _, cells) in &mut rows {
                cells.resize(headings.len() - 1, String::new());
                cells.push(row.clone());
            }
        }
        let rows = rows.into_iter().map(|(_, line, cells)| (line, cells)).collect();
        Some(Cells { words, headings, rows })
    }

    fn find(&self, path: &[&str]) -> Option<&Scalar> {
        let scalar = self.all.iter().find(|scalar| scalar.path.iter().eq(path.iter()))?;
        scalar.read.set(true);
        Some(scalar)
    }

    /// The text at a path.
    pub fn text(&self, path: &[&str]) -> Option<&str> {
        self.find(path).map(|scalar| scalar.text.as_str())
    }

    /// The number at a path, in m or rad; `None` if there is none. `deg(90)` and `!degrees 90` state their unit, as in
    /// ROS.
    pub fn number(&self, path: &[&str], quantity: Quantity) -> Result<Option<f64>, KinematicsFileError> {
        let Some(scalar) = self.find(path) else { return Ok(None) };
        let text = scalar.text.trim();
        let call = text.split_once('(').and_then(|(word, rest)| Some((word, rest.strip_suffix(')')?)));
        let (word, digits) = match (&scalar.tag, call) {
            (Some(tag), None) => (Some(tag.as_str()), text),
            (None, Some((word, digits))) => (Some(word), digits),
            (None, None) => (None, text),
            (Some(_), Some(_)) => (Some("!"), text),
        };
        let unit = match word {
            None | Some("float" | "int") => Some(1.0),
            Some(word) => Unit::of(word, quantity).map(Unit::in_si),
        };
        let value = digits.trim().parse::<f64>().ok().zip(unit).map(|(number, unit)| number * unit);
        value.filter(|value| value.is_finite()).map(Some).ok_or_else(|| KinematicsFileError::NotANumber {
            file: self.file.clone(),
            line: scalar.line,
            path: path.join("."),
            text: scalar.tag.as_ref().map_or_else(|| scalar.text.clone(), |tag| format!("!{tag} {}", scalar.text)),
        })
    }

    /// The six numbers of an origin below this path.
    pub fn origin(&self, path: &[&str]) -> Result<[f64; 6], KinematicsFileError> {
        let mut numbers = [0.0; 6];
        for (index, (number, key)) in numbers.iter_mut().zip(KEYS).enumerate() {
            let whole: Vec<&str> = path.iter().copied().chain([key]).collect();
            let quantity = if index < 3 { Quantity::Length } else { Quantity::Angle };
            *number = self.number(&whole, quantity)?.ok_or_else(|| KinematicsFileError::Missing {
                file: self.file.clone(),
                name: path.join("."),
                key,
            })?;
        }
        Ok(numbers)
    }

    /// Notes on everything that was not read, and the inventory.
    pub fn account(&self) -> (Vec<Note>, Inventory) {
        let mut inventory = Inventory::default();
        let mut notes = Vec::new();
        for scalar in &self.all {
            if scalar.read.get() {
                inventory.understand();
                continue;
            }
            let element = format!("key \"{}\"", quoted(&scalar.path.join(".")));
            let place = Place { file: self.file.clone(), line: scalar.line, element };
            let what = "the key is unknown and was ignored".to_owned();
            inventory.report(place.clone(), what.clone());
            notes.push(Note::NotUnderstood { place, what });
        }
        (notes, inventory)
    }
}

impl Level {
    /// Its part of a path.
    fn place(&self) -> String {
        match self {
            Self::Map { key, .. } => key.clone().unwrap_or_default(),
            Self::List(index) => index.to_string(),
        }
    }
}

/// The next thing is another key, or the next place of the list.
fn value_ends(levels: &mut [Level]) {
    match levels.last_mut() {
        Some(Level::Map { key, .. }) => *key = None,
        Some(Level::List(index)) => *index += 1,
        None => {}
    }
}

/// A name as a key of a YAML map, in quotes unless it is plain.
pub(crate) fn key(name: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "_./-".contains(c);
    let is_word = name.chars().all(plain) && name.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_');
    if is_word { name.to_owned() } else { serde_json::Value::from(name).to_string() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_by_their_paths_and_units_as_ros_writes_them() {
        let text = "a:\n  b: [1, deg(90), !degrees 180]\n  c: {x: !millimeters 5, y: !furlongs 1}\n";
        let scalars = Scalars::read("f.yaml", text).unwrap();
        let number = |path: &[&str], quantity| scalars.number(path, quantity);
        assert_eq!(number(&["a", "b", "0"], Quantity::Length).unwrap(), Some(1.0));
        assert_eq!(number(&["a", "b", "1"], Quantity::Angle).unwrap(), Some(std::f64::consts::FRAC_PI_2));
        assert_eq!(number(&["a", "b", "2"], Quantity::Angle).unwrap(), Some(std::f64::consts::PI));
        assert_eq!(number(&["a", "c", "x"], Quantity::Length).unwrap(), Some(0.005));
        assert_eq!(scalars.account().0.len(), 1, "one key is not read yet");
        let error = number(&["a", "c", "y"], Quantity::Length).unwrap_err().to_string();
        assert!(error.contains("f.yaml:3: a.c.y is \"!furlongs 1\""), "{error}");
        assert!(scalars.account().0.is_empty());
        for (text, said) in [
            ("a: 1\na: 2\n", "the key \"a\" appears twice"),
            ("a: &x 1\nb: *x\n", "aliases are not read"),
            ("a: 1\n---\nb: 2\n", "a second document"),
            ("? [1, 2]\n: 3\n", "a key is a list"),
        ] {
            let error = Scalars::read("f.yaml", text).err().unwrap().to_string();
            assert!(error.contains(said), "{error}");
        }
    }

    #[test]
    fn names_are_keys() {
        assert_eq!(key("arm_1_joint"), "arm_1_joint");
        assert_eq!(key("a: b\nc"), "\"a: b\\nc\"");
    }
}
