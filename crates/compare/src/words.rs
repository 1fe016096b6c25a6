//! Numbers in words: the unit that reads best, four digits, never "-0".

use std::fmt;

/// A length in m, mm, µm or nm.
pub(crate) fn length(metres: f64) -> String {
    match metres.abs() {
        0.0 => "0 m".into(),
        m if m < 1e-9 => format!("{metres:.1e} m"),
        m if m < 1e-6 => format!("{} nm", digits(metres * 1e9)),
        m if m < 1e-3 => format!("{} µm", digits(metres * 1e6)),
        m if m < 1.0 => format!("{} mm", digits(metres * 1e3)),
        m if m < 1e4 => format!("{} m", digits(metres)),
        _ => format!("{metres:.3e} m"),
    }
}

/// An angle in rad, also in degrees if these are easier to imagine.
pub(crate) fn angle(rad: f64) -> String {
    match rad.abs() {
        0.0 => "0 rad".into(),
        a if a < 1e-6 => format!("{rad:.1e} rad"),
        a if a < 1e-3 => format!("{} µrad", digits(rad * 1e6)),
        a if a < 1e-2 => format!("{} mrad ({}°)", digits(rad * 1e3), digits(rad.to_degrees())),
        _ => format!("{} rad ({}°)", digits(rad), digits(rad.to_degrees())),
    }
}

/// A displacement: its length and angle, each where it is above its tolerance.
pub(crate) fn displacement((rad, m): (f64, f64), tolerance_rad: f64, tolerance_m: f64) -> String {
    match (rad > tolerance_rad, m > tolerance_m) {
        (true, true) => format!("moved by {} and turned by {}", length(m), angle(rad)),
        (true, false) => format!("turned by {}", angle(rad)),
        _ => format!("moved by {}", length(m)),
    }
}

/// A joint value to four decimals: the location of a maximum is not more precise.
pub(crate) fn joint_value(value: f64) -> String {
    ((value * 1e4).round() / 1e4 + 0.0).to_string()
}

/// Four significant digits, no trailing zeros.
pub(crate) fn digits(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return if value == 0.0 { "0".into() } else { value.to_string() };
    }
    let rounded: f64 = format!("{value:.3e}").parse().unwrap_or(value);
    let text = rounded.to_string();
    if text.len() > 9 { format!("{rounded:e}") } else { text }
}

/// A limit, or that there is none.
pub(crate) fn stated(value: Option<f64>) -> String {
    value.map_or_else(|| "none".into(), |value| (value + 0.0).to_string())
}

/// The joint that carries another.
pub(crate) fn carrier(name: &str) -> String {
    if name.is_empty() { "the root".into() } else { format!("joint \"{name}\"") }
}

/// A magnitude in words with the sign of a number.
pub(crate) struct Signed<'a>(pub &'a str, pub f64);

impl fmt::Display for Signed<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}{}", if self.1 < 0.0 { "-" } else { "+" }, self.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_as_an_engineer_writes_them() {
        assert_eq!(length(0.000_012_345_6), "12.35 µm");
        assert_eq!(length(0.0203), "20.3 mm");
        assert_eq!(length(1.5), "1.5 m");
        assert_eq!(length(-0.0), "0 m");
        assert_eq!(angle(1e-3), "1 mrad (0.0573°)");
        assert_eq!(angle(std::f64::consts::FRAC_PI_2), "1.571 rad (90°)");
        assert_eq!(angle(1e-5), "10 µrad");
        assert_eq!(stated(Some(-0.0)), "0");
    }
}
