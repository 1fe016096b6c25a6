//! Numbers on the command line; NaN, infinite and out-of-range values are refused.

/// A tolerance: finite, 0 or more.
pub fn tolerance(text: &str) -> Result<f64, String> {
    number(text, |value| value.is_finite() && value >= 0.0, "write a finite number of 0 or more")
}

/// A share between 0 and 1, both excluded.
pub fn part(text: &str) -> Result<f64, String> {
    number(text, |value| value > 0.0 && value < 1.0, "write a number between 0 and 1")
}

/// A share from 0 to 1, both included.
pub fn share(text: &str) -> Result<f64, String> {
    number(text, |value| (0.0..=1.0).contains(&value), "it is not a share of the rows; write 0 to 1")
}

fn number(text: &str, good: impl Fn(f64) -> bool, fix: &str) -> Result<f64, String> {
    text.trim().parse::<f64>().ok().filter(|value| good(*value)).ok_or_else(|| fix.to_owned())
}
