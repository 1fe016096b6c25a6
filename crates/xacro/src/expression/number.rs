//! Numbers as Python reads and writes them.

/// `repr` of a float: the shortest digits that read back the same, always with a point or an exponent.
pub(crate) fn float_text(value: f64) -> String {
    if value.is_nan() {
        return "nan".to_owned();
    }
    if value.is_infinite() {
        return if value > 0.0 { "inf" } else { "-inf" }.to_owned();
    }
    let scientific = format!("{value:e}");
    let (digits, exponent) = scientific.split_once('e').expect("`{:e}` writes an exponent");
    let exponent: i32 = exponent.parse().expect("the exponent of an f64 is a small integer");
    if (-4..16).contains(&exponent) {
        let text = format!("{value}");
        return if text.contains('.') { text } else { format!("{text}.0") };
    }
    format!("{digits}e{}", exponent_text(exponent))
}

/// A sign and two digits at least.
pub(crate) fn exponent_text(exponent: i32) -> String {
    let sign = if exponent < 0 { '-' } else { '+' };
    format!("{sign}{:02}", exponent.unsigned_abs())
}

/// What `int(text)` reads, in base 10.
pub(crate) fn parse_integer(text: &str) -> Option<i128> {
    let text = text.trim();
    let digits = text.strip_prefix(['+', '-']).unwrap_or(text);
    let well_formed = !digits.is_empty()
        && digits.split('_').all(|part| !part.is_empty() && part.bytes().all(|b| b.is_ascii_digit()));
    if !well_formed {
        return None;
    }
    text.replace('_', "").parse().ok()
}

/// What `float(text)` reads.
pub(crate) fn parse_float(text: &str) -> Option<f64> {
    let text = text.trim();
    let unsigned = text.strip_prefix(['+', '-']).unwrap_or(text);
    let named = ["inf", "infinity", "nan"].iter().any(|name| unsigned.eq_ignore_ascii_case(name));
    let numeric = unsigned.starts_with(|c: char| c.is_ascii_digit() || c == '.')
        && unsigned.bytes().all(|b| b.is_ascii_digit() || b".eE+-_".contains(&b));
    if !named && !numeric {
        return None;
    }
    if !unsigned.contains('_') {
        return text.parse().ok();
    }
    let bytes = unsigned.as_bytes();
    let between_digits = (0..bytes.len())
        .filter(|&at| bytes[at] == b'_')
        .all(|at| at > 0 && bytes[at - 1].is_ascii_digit() && bytes.get(at + 1).is_some_and(u8::is_ascii_digit));
    between_digits.then(|| text.replace('_', "").parse().ok()).flatten()
}

/// `round(value, digits)`: the nearest with that many decimals, ties to even, by the exact value of the float.
pub(crate) fn round_to(value: f64, digits: i32) -> f64 {
    if !value.is_finite() || digits > 323 {
        return value;
    }
    if let Ok(decimals) = usize::try_from(digits) {
        return format!("{value:.decimals$}").parse().unwrap_or(value);
    }
    if digits < -308 {
        return 0.0 * value;
    }
    let unit = 10f64.powi(-digits);
    (value / unit).round_ties_even() * unit
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn floats_are_written_as_python_repr() {
        for (value, text) in [
            (0.0, "0.0"),
            (-0.0, "-0.0"),
            (1.0, "1.0"),
            (0.1 + 0.2, "0.30000000000000004"),
            (1e15, "1000000000000000.0"),
            (1e16, "1e+16"),
            (1.5e300, "1.5e+300"),
            (0.0001, "0.0001"),
            (0.000_01, "1e-05"),
            (1.25e-7, "1.25e-07"),
            (f64::INFINITY, "inf"),
            (std::f64::consts::PI, "3.141592653589793"),
        ] {
            assert_eq!(float_text(value), text);
        }
    }

    #[test]
    fn literals_are_read_as_python_reads_them() {
        assert_eq!(parse_integer(" +12 "), Some(12));
        assert_eq!(parse_integer("1_000"), Some(1000));
        assert_eq!(parse_integer("0x10"), None);
        assert_eq!(parse_integer("_1"), None);
        assert_eq!(parse_float(".5"), Some(0.5));
        assert_eq!(parse_float("1."), Some(1.0));
        assert_eq!(parse_float("1e-3"), Some(0.001));
        assert_eq!(parse_float("-Infinity"), Some(f64::NEG_INFINITY));
        assert_eq!(parse_float("1e"), None);
        assert_eq!(parse_float("e5"), None);
        assert_eq!(parse_float("1_0.5"), Some(10.5));
        assert_eq!(parse_float("1_.5"), None);
    }

    #[test]
    fn rounding_takes_the_exact_value_and_ties_to_even() {
        assert_eq!(round_to(2.675, 2), 2.67);
        assert_eq!(round_to(0.125, 2), 0.12);
        assert_eq!(round_to(2.5, 0), 2.0);
        assert_eq!(round_to(1250.0, -2), 1200.0);
    }
}
