//! Numbers as people write them in tables: `90`, `-90°`, `π/2`, `-3pi/4`, `162,5`, `q1`, `q2 - 90°`, `θ3*`.

use super::header::plain;
use denavit_model::chain::Quantity;
use denavit_model::units::Unit;

/// What is in a cell: factor · variable + constant.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Cell {
    /// The constant, in `unit` where there is one.
    pub constant: f64,
    /// The unit that the cell states; a multiple of π is in rad.
    pub unit: Option<Unit>,
    /// The constant's digits with their sign, where it is a plain decimal.
    pub literal: Option<String>,
    /// The joint's variable and its factor.
    pub variable: Option<Variable>,
}

/// A joint's variable in a cell.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Variable {
    /// Such as `q1`; empty for a lone star.
    pub name: String,
    pub factor: f64,
}

/// Maximum nesting of brackets and signs in a cell, more than anyone writes.
const DEPTH: usize = 32;

impl Cell {
    /// Reads a cell of a column of `quantity`; `None` if it is not a number. A lone dash is 0.
    pub fn of(text: &str, quantity: Quantity) -> Option<Self> {
        let mut text = plain(&text.trim().to_lowercase());
        text.retain(|c| !"$\\{}`".contains(c));
        if text == "-" {
            return Some(Self { constant: 0.0, unit: None, literal: None, variable: None });
        }
        let text = with_points(&text)?;
        // "π/2 rad" states its unit twice.
        let text = text.strip_suffix("rad").filter(|_| text.contains(['π', 'i'])).unwrap_or(&text).trim_end();
        let mut reader = Reader { left: text, has_pi: false, unit: None, quantity, depth: 0 };
        let sum = reader.sum()?;
        if !reader.left.is_empty() || !sum.constant.is_finite() {
            return None;
        }
        let unit = match (reader.has_pi, reader.unit) {
            // A multiple of π beside degrees: the two do not add up.
            (true, Some(unit)) if unit != Unit::Radian => return None,
            (true, _) if quantity == Quantity::Angle => Some(Unit::Radian),
            (true, _) => return None,
            (false, unit) => unit,
        };
        Some(Self { constant: sum.constant, unit, literal: sum.literal, variable: sum.variable })
    }
}

/// Decimal commas as points; `None` where the text has both.
fn with_points(text: &str) -> Option<String> {
    match (text.matches(',').count(), text.contains('.')) {
        (0, _) => Some(text.to_owned()),
        (_, true) => None,
        (_, false) => Some(text.replace(',', ".")),
    }
}

/// Whether the number has a decimal comma (`Some(true)`), a point, or neither.
pub(super) fn has_decimal_comma(text: &str) -> Option<bool> {
    let between_digits = |mark: char| {
        let letters: Vec<char> = text.chars().collect();
        letters.windows(2).any(|pair| pair[0] == mark && pair[1].is_ascii_digit())
    };
    if between_digits(',') {
        return Some(true);
    }
    between_digits('.').then_some(false)
}

/// factor · variable + constant.
#[derive(Default)]
struct Sum {
    constant: f64,
    literal: Option<String>,
    variable: Option<Variable>,
}

impl Sum {
    fn times(self, by: f64) -> Self {
        let variable = self.variable.map(|v| Variable { factor: v.factor * by, ..v });
        Self { constant: self.constant * by, literal: None, variable }
    }
}

struct Reader<'a> {
    left: &'a str,
    has_pi: bool,
    unit: Option<Unit>,
    quantity: Quantity,
    depth: usize,
}

impl Reader<'_> {
    fn skip(&mut self) {
        self.left = self.left.trim_start();
    }

    fn take(&mut self, mark: char) -> bool {
        self.skip();
        let rest = self.left.strip_prefix(mark);
        self.left = rest.unwrap_or(self.left);
        rest.is_some()
    }

    fn sum(&mut self) -> Option<Sum> {
        let mut sum = Sum::default();
        let mut constants = 0;
        let mut sign = if self.take('-') { -1.0 } else { 1.0 };
        if sign > 0.0 {
            self.take('+');
        }
        loop {
            let term = self.product()?;
            if term.variable.is_none() || term.constant != 0.0 {
                constants += 1;
                sum.constant += sign * term.constant;
                let negative = |literal: String| if sign < 0.0 { format!("-{literal}") } else { literal };
                sum.literal = term.literal.filter(|_| constants == 1).map(negative);
            }
            match term.variable {
                Some(_) if sum.variable.is_some() => return None,
                Some(variable) => sum.variable = Some(Variable { factor: sign * variable.factor, ..variable }),
                None => {}
            }
            sign = if self.take('+') {
                1.0
            } else if self.take('-') {
                -1.0
            } else {
                return Some(sum);
            };
        }
    }

    fn product(&mut self) -> Option<Sum> {
        let mut product = self.factor()?;
        loop {
            self.skip();
            let starred = self.left.strip_prefix('*');
            if starred.is_some_and(|rest| {
                let rest = rest.trim_start();
                rest.is_empty() || rest.starts_with(['+', '-', ')'])
            }) {
                // A trailing star marks the variable.
                self.take('*');
                if product.variable.is_none() {
                    return (product.constant == 0.0).then(|| Sum {
                        variable: Some(Variable { name: String::new(), factor: 1.0 }),
                        ..Sum::default()
                    });
                }
                return Some(product);
            }
            if self.take('/') {
                let by = self.factor()?;
                if by.variable.is_some() || by.constant == 0.0 {
                    return None;
                }
                let constant = product.constant / by.constant;
                product = Sum { constant, ..product.times(1.0 / by.constant) };
                continue;
            }
            let times = self.take('*') || self.take('·') || self.take('×');
            self.skip();
            if !times && !self.left.starts_with(|c: char| c.is_alphabetic() || c == '(' || c == 'π') {
                return Some(product);
            }
            let by = self.factor()?;
            product = match (&product.variable, &by.variable) {
                (Some(_), Some(_)) => return None,
                (Some(_), None) => product.times(by.constant),
                (None, _) => by.times(product.constant),
            };
        }
    }

    fn factor(&mut self) -> Option<Sum> {
        self.depth += 1;
        let found = if self.depth > DEPTH { None } else { self.shallow_factor() };
        self.depth -= 1;
        found
    }

    fn shallow_factor(&mut self) -> Option<Sum> {
        self.skip();
        if self.take('(') {
            let inner = self.sum()?;
            return self.take(')').then_some(inner);
        }
        if self.take('-') {
            return Some(self.factor()?.times(-1.0));
        }
        if self.left.starts_with('*') {
            // A lone star.
            self.take('*');
            return Some(Sum { variable: Some(Variable { name: String::new(), factor: 1.0 }), ..Sum::default() });
        }
        if self.left.starts_with(|c: char| c.is_ascii_digit() || c == '.') {
            return self.number();
        }
        let end = self.left.find(|c: char| !(c.is_alphanumeric() || c == '_')).unwrap_or(self.left.len());
        let (word, rest) = self.left.split_at(end);
        if word == "pi" || word == "π" {
            self.left = rest;
            self.has_pi = true;
            return Some(Sum { constant: std::f64::consts::PI, ..Sum::default() });
        }
        let name: String = word.chars().filter(|c| *c != '_').collect();
        let letters = name.trim_end_matches(|c: char| c.is_ascii_digit() || c == 'i' || c == 'j');
        let is_variable = ["q", "theta", "th", "d", "var", "variable", "ph"].contains(&letters);
        if word.is_empty() || !is_variable {
            return None;
        }
        self.left = rest.strip_prefix("(t)").unwrap_or(rest);
        self.left = self.left.strip_prefix('^').unwrap_or(self.left);
        Some(Sum { variable: Some(Variable { name, factor: 1.0 }), ..Sum::default() })
    }

    fn number(&mut self) -> Option<Sum> {
        let bytes = self.left.as_bytes();
        let digits = |mut at: usize| {
            while bytes.get(at).is_some_and(u8::is_ascii_digit) {
                at += 1;
            }
            at
        };
        let mut end = digits(0);
        if bytes.get(end) == Some(&b'.') {
            end = digits(end + 1);
        }
        if bytes.get(end) == Some(&b'e') {
            let signed = end + 1 + usize::from(matches!(bytes.get(end + 1), Some(b'+' | b'-')));
            if digits(signed) > signed {
                end = digits(signed);
            }
        }
        let (literal, rest) = self.left.split_at(end);
        let constant = literal.parse().ok()?;
        self.left = rest.trim_start();
        let of_unit = |c: char| c.is_alphabetic() || "°º˚\"'″′”’".contains(c);
        let word = self.left.find(|c: char| !of_unit(c)).unwrap_or(self.left.len());
        if let Some(unit) = Unit::of(&self.left[..word], self.quantity) {
            if self.unit.is_some_and(|known| known != unit) {
                return None;
            }
            self.unit = Some(unit);
            self.left = &self.left[word..];
        }
        Some(Sum { constant, literal: Some(literal.to_owned()), variable: None })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{FRAC_PI_2, PI};

    #[test]
    fn numbers_as_manuals_print_them() {
        for (text, constant, unit, literal) in [
            ("90", 90.0, None, Some("90")),
            ("-90°", -90.0, Some(Unit::Degree), Some("-90")),
            ("−90 deg", -90.0, Some(Unit::Degree), Some("-90")),
            ("π/2", FRAC_PI_2, Some(Unit::Radian), None),
            ("-pi/2", -FRAC_PI_2, Some(Unit::Radian), None),
            ("3π/2", 1.5 * PI, Some(Unit::Radian), None),
            ("3*pi/4", 0.75 * PI, Some(Unit::Radian), None),
            ("(1/2) π", FRAC_PI_2, Some(Unit::Radian), None),
            ("162,5", 162.5, None, Some("162.5")),
            ("162.5 mm", 162.5, Some(Unit::Millimetre), Some("162.5")),
            ("-1.5e-3", -1.5e-3, None, Some("-1.5e-3")),
            (".0825", 0.0825, None, Some(".0825")),
            ("–", 0.0, None, None),
            ("$-\\pi/2$", -FRAC_PI_2, Some(Unit::Radian), None),
            ("5.9\"", 5.9, Some(Unit::Inch), Some("5.9")),
            ("16 in", 16.0, Some(Unit::Inch), Some("16")),
            ("3'", 3.0, Some(Unit::Foot), Some("3")),
            ("100 grad", 100.0, Some(Unit::Gradian), Some("100")),
            ("12 µm", 12.0, Some(Unit::Micrometre), Some("12")),
        ] {
            let quantity = unit.map_or(Quantity::Angle, Unit::quantity);
            let cell = Cell::of(text, quantity).unwrap_or_else(|| panic!("{text}"));
            assert!((cell.constant - constant).abs() < 1e-15 * constant.abs().max(1.0), "{text}: {cell:?}");
            assert_eq!((cell.unit, cell.literal.as_deref(), cell.variable), (unit, literal, None), "{text}");
        }
    }

    #[test]
    fn variables_with_what_is_added_to_them() {
        for (text, name, factor, constant) in [
            ("q1", "q1", 1.0, 0.0),
            ("θ₁", "theta1", 1.0, 0.0),
            ("θ_3*", "theta3", 1.0, 0.0),
            ("$\\theta_{2}$ - 90°", "theta2", 1.0, -90.0),
            ("q1 + 90°", "q1", 1.0, 90.0),
            ("-q4+π/2", "q4", -1.0, FRAC_PI_2),
            ("-90 + q2", "q2", 1.0, -90.0),
            ("1.0000005 q1 + 116.542117", "q1", 1.000_000_5, 116.542_117),
            ("*", "", 1.0, 0.0),
            ("0*", "", 1.0, 0.0),
            ("d3", "d3", 1.0, 0.0),
            ("(q2 - 90°)", "q2", 1.0, -90.0),
            ("-(q2 - 90°)", "q2", -1.0, 90.0),
            ("2*(q1 + 45°)", "q1", 2.0, 90.0),
            ("q1/2 + 1", "q1", 0.5, 1.0),
        ] {
            let cell = Cell::of(text, Quantity::Angle).unwrap_or_else(|| panic!("{text}"));
            assert_eq!(cell.variable, Some(Variable { name: name.into(), factor }), "{text}");
            assert!((cell.constant - constant).abs() < 1e-15, "{text}: {cell:?}");
        }
    }

    #[test]
    fn what_is_no_number() {
        for text in
            ["", "about 3", "1,000.5", "q1 + q2", "90° + 1 rad", "1/0", "nan", "inf", "1e999", "0.1.2", "π°x", "+"]
        {
            assert_eq!(Cell::of(text, Quantity::Angle), None, "{text}");
        }
        for text in ["16 furlong", "90°", "π/2", "1 m + 1 mm", "90° + π/2"] {
            assert_eq!(Cell::of(text, Quantity::Length), None, "{text}");
        }
        assert_eq!(Cell::of("90° + π/2", Quantity::Angle), None);
    }

    #[test]
    fn brackets_and_signs_by_the_ten_thousand_are_no_number() {
        for text in
            ["(".repeat(40_000), "-".repeat(40_000), "(-".repeat(20_000) + "1", format!("{}1", "-".repeat(40_000))]
        {
            assert_eq!(Cell::of(&text, Quantity::Angle), None);
        }
        assert_eq!(Cell::of(&format!("{}7{}", "(".repeat(9), ")".repeat(9)), Quantity::Angle).unwrap().constant, 7.0);
    }
}
