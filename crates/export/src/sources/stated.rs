//! Convention and units of a table: what the user states, what the file states, what only its numbers tell.

use super::header::Heading;
use super::units::Unit;
use crate::numbers::{AngleUnit, LengthUnit, Units};
use denavit_dh::Convention;

/// What is stated of a table's file; `None` where nothing is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Stated {
    /// How its rows are grouped.
    pub convention: Option<Convention>,
    /// Unit of its lengths.
    pub length: Option<LengthUnit>,
    /// Unit of its angles.
    pub angle: Option<AngleUnit>,
}

impl Stated {
    /// From words such as `mm,deg`, in any order.
    ///
    /// # Errors
    /// The word that is no unit.
    pub fn with_units(self, words: &str) -> Result<Self, String> {
        let mut stated = self;
        for word in words.split([',', ' ']).filter(|word| !word.is_empty()) {
            match Unit::of(&word.to_lowercase()) {
                Some(Unit::Radian) => stated.angle = Some(AngleUnit::Radian),
                Some(Unit::Degree) => stated.angle = Some(AngleUnit::Degree),
                Some(Unit::Metre) => stated.length = Some(LengthUnit::Metre),
                Some(Unit::Millimetre) => stated.length = Some(LengthUnit::Millimetre),
                _ => return Err(word.to_owned()),
            }
        }
        Ok(stated)
    }

    /// This, and what the other says where this says nothing.
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
    /// Units of numbers without one.
    pub units: Units,
}

impl ReadAs {
    /// In words: `distal, rad and m`.
    pub fn words(&self) -> String {
        let angle = if self.units.angle == AngleUnit::Degree { "degrees" } else { "rad" };
        format!("{}, {angle} and {}", self.convention.word(), self.units.length_word())
    }
}

/// What the words around a table say.
pub(super) struct Said {
    pairs: Vec<(String, String)>,
    pub stated: Stated,
}

impl Said {
    /// From the lines around the table and its headings.
    pub fn in_words<'a>(lines: impl Iterator<Item = &'a str>, headings: &[Heading]) -> Self {
        let mut pairs = Vec::new();
        let mut words: Vec<String> = Vec::new();
        for line in lines {
            let line = line.trim().trim_start_matches('#').trim();
            let pair = line.split_once(':').map(|(key, value)| (key.trim().to_lowercase(), value.trim().to_owned()));
            match pair {
                Some((key, value)) if ["convention", "units", "robot"].contains(&key.as_str()) => {
                    pairs.push((key, value))
                }
                // Who is quoted says nothing of how it is written here.
                Some((key, _)) if ["source", "author", "title", "note"].contains(&key.as_str()) => {}
                _ => {
                    let spaced = line.to_lowercase().replace('°', " ° ");
                    words.extend(spaced.split(|c: char| !(c.is_alphanumeric() || c == '°')).map(str::to_owned));
                }
            }
        }
        let units = pairs.iter().find(|(key, _)| key == "units");
        let of_pair = units.and_then(|(_, value)| Stated::default().with_units(value).ok()).unwrap_or_default();
        let has = |names: &[&str]| words.iter().any(|word| names.contains(&word.as_str()));
        let of_unit = |unit: Unit| words.iter().any(|word| word.len() > 1 && Unit::of(word) == Some(unit));
        let angle = match (of_unit(Unit::Degree), of_unit(Unit::Radian)) {
            (true, false) => Some(AngleUnit::Degree),
            (false, true) => Some(AngleUnit::Radian),
            _ => None,
        };
        // A lone "m" is a unit where a unit of angles stands, too.
        let metre = of_unit(Unit::Metre) || (angle.is_some() && has(&["m"]));
        let length = match (of_unit(Unit::Millimetre), metre) {
            (true, false) => Some(LengthUnit::Millimetre),
            (false, true) => Some(LengthUnit::Metre),
            _ => None,
        };
        let proximal = has(&["proximal", "modified", "craig", "khalil"]);
        let distal = has(&["distal", "standard", "classic", "classical"]);
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
        let stated = of_pair.or(Stated { convention, length, angle });
        Self { pairs, stated }
    }

    pub fn value(&self, key: &str) -> Option<&str> {
        self.pairs.iter().find(|(known, _)| known == key).map(|(_, value)| value.as_str())
    }
}
