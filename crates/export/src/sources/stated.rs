//! Convention and units of a table: stated by the user, stated by the file, or inferred from the numbers.

use super::header::Heading;
use crate::numbers::UnknownUnit;
use denavit_dh::Convention;
use denavit_model::chain::Quantity;
use denavit_model::units::Unit;

/// What is stated of a table's file; `None` where nothing is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Stated {
    /// How its rows are grouped.
    pub convention: Option<Convention>,
    /// Unit of its lengths.
    pub length: Option<Unit>,
    /// Unit of its angles.
    pub angle: Option<Unit>,
}

impl Stated {
    /// From words such as `mm,deg`, in any order.
    ///
    /// # Errors
    /// The word that is not a unit, or the second of two units of one quantity.
    pub fn with_units(self, words: &str) -> Result<Self, UnknownUnit> {
        let mut stated = self;
        let (mut length, mut angle) = (None, None);
        for word in words.split([',', ' ']).filter(|word| !word.is_empty()) {
            let unit = Unit::of_any(word).ok_or_else(|| UnknownUnit::of(word))?;
            let slot = if unit.quantity() == Quantity::Length { &mut length } else { &mut angle };
            if slot.is_some_and(|known| known != unit) {
                return Err(UnknownUnit::of(word));
            }
            *slot = Some(unit);
        }
        stated.length = length.or(stated.length);
        stated.angle = angle.or(stated.angle);
        Ok(stated)
    }

    /// This, completed by the other where this states nothing.
    #[must_use]
    pub fn or(self, other: Self) -> Self {
        Self {
            convention: self.convention.or(other.convention),
            length: self.length.or(other.length),
            angle: self.angle.or(other.angle),
        }
    }
}

/// How a table is read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ReadAs {
    /// How its rows are grouped.
    pub convention: Convention,
    /// Unit of lengths without one.
    pub length: Unit,
    /// Unit of angles without one.
    pub angle: Unit,
}

impl ReadAs {
    /// In words: `distal, rad and m`.
    pub fn words(&self) -> String {
        let angle = if self.angle == Unit::Degree { "degrees" } else { self.angle.word() };
        format!("{}, {angle} and {}", self.convention.word(), self.length.word())
    }
}

/// Other words in a statement of units.
const FILLERS: [&str; 14] = [
    "lengths",
    "length",
    "angles",
    "angle",
    "distances",
    "distance",
    "and",
    "are",
    "is",
    "of",
    "all",
    "for",
    "linear",
    "angular",
];

/// The units that a comment such as `units: mm, deg` states.
fn units_of(value: &str) -> Result<Stated, UnknownUnit> {
    let spaced = value.to_lowercase().replace('°', " ° ");
    let words: Vec<&str> = spaced
        .split(|c: char| c.is_whitespace() || ",;/:=()[]".contains(c))
        .filter(|word| !word.is_empty() && !FILLERS.contains(word))
        .collect();
    let lengths = words.iter().filter_map(|word| Unit::of(word, Quantity::Length)).count();
    // "lengths in mm": "in" means inches only if there is no other unit of length.
    let words: Vec<&str> = words.into_iter().filter(|word| !(*word == "in" && lengths > 1)).collect();
    Stated::default().with_units(&words.join(","))
}

/// What the text around a table states.
pub(super) struct Said {
    pairs: Vec<(String, String)>,
    pub stated: Stated,
    /// The line's index and the word of a stated unit that is not known.
    pub unknown_unit: Option<(usize, String)>,
}

impl Said {
    /// From the lines around the table and its headings.
    pub fn in_words<'a>(lines: impl Iterator<Item = (usize, &'a str)>, headings: &[Heading]) -> Self {
        let mut pairs = Vec::new();
        let mut words: Vec<String> = Vec::new();
        let (mut of_pairs, mut unknown_unit) = (Stated::default(), None);
        for (index, line) in lines {
            let line = line.trim().trim_start_matches('#').trim();
            let pair = line.split_once(':').map(|(key, value)| (key.trim().to_lowercase(), value.trim().to_owned()));
            match pair {
                Some((key, value)) if key.split_whitespace().any(|word| ["unit", "units"].contains(&word)) => {
                    match units_of(&value) {
                        Ok(stated) => of_pairs = of_pairs.or(stated),
                        Err(unknown) => unknown_unit = unknown_unit.or(Some((index, unknown.word))),
                    }
                }
                Some((key, value)) if ["convention", "robot"].contains(&key.as_str()) => {
                    pairs.push((key, value));
                }
                // A cited source does not state how this table is written.
                Some((key, _)) if ["source", "author", "title", "note"].contains(&key.as_str()) => {}
                _ => {
                    let spaced = line.to_lowercase().replace('°', " ° ");
                    words.extend(spaced.split(|c: char| !(c.is_alphanumeric() || c == '°')).map(str::to_owned));
                }
            }
        }
        let has = |names: &[&str]| words.iter().any(|word| names.contains(&word.as_str()));
        // Words that always are units; "in", "mil" and "turn" also have other meanings.
        let in_prose = |word: &str| {
            !["in", "m", "mil", "mils", "rev", "revs", "turn", "turns", "foot", "grad", "thou"].contains(&word)
        };
        let only = |quantity: Quantity| {
            let found = words.iter().filter(|word| word.chars().count() > 1 || *word == "°");
            let mut units = found.filter(|word| in_prose(word)).filter_map(|word| Unit::of(word, quantity));
            let first = units.next()?;
            Some((first, units.all(|unit| unit == first)))
        };
        let alone = |found: Option<(Unit, bool)>| found.filter(|(_, alone)| *alone).map(|(unit, _)| unit);
        let angles = only(Quantity::Angle);
        let lengths = only(Quantity::Length);
        // A lone "m" is a unit if there also is a unit of angles.
        let length = match lengths {
            None if angles.is_some() && has(&["m"]) => Some(Unit::Metre),
            Some((unit, _)) if unit != Unit::Metre && angles.is_some() && has(&["m"]) => None,
            found => alone(found),
        };
        let angle = alone(angles);
        let proximal = has(&["proximal", "modified", "craig", "khalil", "moddh", "mdh"]);
        let distal = has(&["distal", "standard", "classic", "classical", "stddh"]);
        let hayati = has(&["hayati"]);
        let convention = match (distal, proximal, hayati) {
            (_, false, true) => Some(Convention::Hayati),
            (true, false, false) => Some(Convention::Distal),
            (false, true, false) => Some(Convention::Proximal),
            (false, false, false) if headings.iter().any(|heading| heading.of_link_before) => {
                Some(Convention::Proximal)
            }
            _ => None,
        };
        let stated = of_pairs.or(Stated { convention, length, angle });
        Self { pairs, stated, unknown_unit }
    }

    pub fn value(&self, key: &str) -> Option<&str> {
        self.pairs.iter().find(|(known, _)| known == key).map(|(_, value)| value.as_str())
    }
}
