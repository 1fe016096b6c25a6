//! Days as manifests write them and as Parquet counts them.

use std::fmt;
use std::str::FromStr;

/// A day, counted from 1970-01-01 in the proleptic Gregorian calendar.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Day(pub i32);

impl FromStr for Day {
    type Err = String;

    /// `YYYY-MM-DD`; a time of day behind it is left out.
    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || format!("\"{text}\" is no day; write it as 2026-11-22");
        let day = text.trim().split(['T', ' ']).next().unwrap_or_default();
        let mut parts = day.split('-').map(|part| part.parse::<i32>().ok());
        let (Some(Some(year)), Some(Some(month)), Some(Some(of_month)), None) =
            (parts.next(), parts.next(), parts.next(), parts.next())
        else {
            return Err(wrong());
        };
        if !((1..=9999).contains(&year) && (1..=12).contains(&month) && (1..=31).contains(&of_month)) {
            return Err(wrong());
        }
        // Years that begin in March: a leap day then ends its year.
        let (shifted, years) = if month > 2 { (month - 3, year) } else { (month + 9, year - 1) };
        let (era, of_era) = (years.div_euclid(400), years.rem_euclid(400));
        let of_year = (153 * shifted + 2) / 5 + of_month - 1;
        let found = Self(era * 146_097 + of_era * 365 + of_era / 4 - of_era / 100 + of_year - 719_468);
        // The 31st of a month of 30 days comes back as another day.
        if found.to_string() == format!("{year:04}-{month:02}-{of_month:02}") { Ok(found) } else { Err(wrong()) }
    }
}

impl fmt::Display for Day {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let days = self.0 + 719_468;
        let (era, of_era) = (days.div_euclid(146_097), days.rem_euclid(146_097));
        let years = (of_era - of_era / 1460 + of_era / 36_524 - of_era / 146_096) / 365;
        let of_year = of_era - (365 * years + years / 4 - years / 100);
        let shifted = (5 * of_year + 2) / 153;
        let month = if shifted < 10 { shifted + 3 } else { shifted - 9 };
        let year = years + era * 400 + i32::from(month <= 2);
        write!(f, "{year:04}-{month:02}-{:02}", of_year - (153 * shifted + 2) / 5 + 1)
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
