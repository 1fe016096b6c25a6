//! Days as manifests write them and as Parquet counts them.

use jiff::ToSpan as _;
use jiff::civil::Date;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::fmt;
use std::str::FromStr;

/// A day, counted from 1970-01-01 in the proleptic Gregorian calendar.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Day(pub i32);

const FIRST: Date = Date::constant(1970, 1, 1);

impl FromStr for Day {
    type Err = String;

    /// `YYYY-MM-DD`; a time of day after it is ignored.
    fn from_str(text: &str) -> Result<Self, String> {
        let day = text.trim().split(['T', ' ']).next().unwrap_or_default();
        let date = day.parse::<Date>().ok().filter(|date| date.to_string() == day);
        let date = date.ok_or_else(|| format!("\"{text}\" is not a date; write it as 2026-11-22"))?;
        Ok(Self((date - FIRST).get_days()))
    }
}

impl fmt::Display for Day {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        FIRST.saturating_add(i64::from(self.0).days()).fmt(f)
    }
}

impl Serialize for Day {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

impl<'de> Deserialize<'de> for Day {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        String::deserialize(deserializer)?.parse().map_err(serde::de::Error::custom)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn days_count_as_unix_does() {
        for (text, days) in [("1970-01-01", 0), ("2000-02-29", 11_016), ("2026-11-22", 20_779), ("1969-12-31", -1)] {
            assert_eq!(text.parse::<Day>(), Ok(Day(days)), "{text}");
            assert_eq!(Day(days).to_string(), text);
        }
        assert_eq!("2026-11-22T23:10".parse::<Day>(), Ok(Day(20_779)));
        for wrong in ["22.11.2026", "2026-02-29", "2026-04-31", "2026-13-01", "", "2026-1"] {
            assert!(wrong.parse::<Day>().is_err(), "{wrong}");
        }
    }
}
