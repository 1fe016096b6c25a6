//! Edits of number literals that keep as much of the text as possible.

use denavit_export::urdf::text::{clean, word};

/// The same number with the other sign, its digits as they were: `1.5708` and `-1.5708`. Zero and non-numbers stay.
pub(crate) fn negated(literal: &str) -> String {
    let trimmed = literal.trim();
    let Ok(value) = trimmed.parse::<f64>() else { return literal.to_owned() };
    if value == 0.0 {
        return literal.to_owned();
    }
    let digits = trimmed.trim_start_matches(['-', '+']);
    let sign = if trimmed.starts_with('-') { "" } else { "-" };
    literal.replacen(trimmed, &format!("{sign}{digits}"), 1)
}

/// The numbers of a literal, some with the other sign; the white space between them stays.
pub(crate) fn negated_where(literal: &str, negate: &[bool]) -> String {
    each_number(
        literal,
        |index, number| {
            if negate.get(index).copied().unwrap_or(false) { negated(number) } else { number.to_owned() }
        },
    )
}

/// The numbers of a literal times factors, one for each number; the others stay.
pub(crate) fn times(literal: &str, factors: &[f64]) -> String {
    each_number(literal, |index, number| {
        let factor = factors.get(index).copied().unwrap_or(1.0);
        match number.parse::<f64>() {
            Ok(value) if factor != 1.0 && value.is_finite() => word(short(value * factor)),
            _ => number.to_owned(),
        }
    })
}

/// A literal with each of its numbers, counted from 0, rewritten; the text between them stays.
fn each_number(literal: &str, written: impl Fn(usize, &str) -> String) -> String {
    let between = |c: char| c.is_whitespace() || c == ',';
    let mut result = String::with_capacity(literal.len());
    let mut index = 0;
    for piece in literal.split_inclusive(between) {
        let number = piece.trim_end_matches(between);
        if !number.is_empty() {
            result.push_str(&written(index, number));
            index += 1;
        }
        result.push_str(&piece[number.len()..]);
    }
    result
}

/// A product without rounding error: the decimal of fifteen digits if it is within rounding.
pub(crate) fn short(value: f64) -> f64 {
    let rounded: f64 = format!("{value:.14e}").parse().unwrap_or(value);
    if (rounded - value).abs() <= 2.0 * f64::EPSILON * value.abs() { rounded } else { value }
}

/// A sum without rounding error, relative to the largest of its terms.
pub(crate) fn sum(terms: &[f64]) -> f64 {
    let scale = terms.iter().fold(0.0, |a: f64, b| a.max(b.abs()));
    clean(terms.iter().sum(), scale)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digits_stay_when_the_sign_changes() {
        for (from, to) in
            [("1.5708", "-1.5708"), ("-.50", ".50"), (" +1e-3 ", " -1e-3 "), ("0", "0"), ("-0.0", "-0.0"), ("x", "x")]
        {
            assert_eq!(negated(from), to);
        }
        assert_eq!(negated_where("1  -2,3\n", &[true, true, false]), "-1  2,3\n");
        assert_eq!(negated_where(" 0 1 2", &[true, false, true]), " 0 1 -2");
    }

    #[test]
    fn products_are_short() {
        assert_eq!(times("162.5 0 -392.2", &[1e-3; 3]), "0.1625 0 -0.3922");
        assert_eq!(times("0.1", &[3.0]), "0.3");
        assert_eq!(sum(&[0.1, 0.2]), 0.3);
    }
}
