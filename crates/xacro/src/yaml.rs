//! YAML files as the Python tool reads them: YAML 1.1, with tags for units.

use std::collections::BTreeMap;
use std::rc::Rc;

use saphyr_parser::{Event, Parser, ScalarStyle, Span, Tag};

use crate::error::{ErrorKind, XacroError};
use crate::expression::{Dict, Fault, Value, parse_integer};
use crate::limits::Meter;
use crate::place::{SourceFile, Spot};

/// Collections nested deeper than this are refused.
const DEEPEST: usize = 100;

/// Tags that multiply a number, or an expression, into SI units.
const UNITS: &[(&str, f64)] = &[
    ("radians", 1.0),
    ("degrees", std::f64::consts::PI / 180.0),
    ("meters", 1.0),
    ("millimeters", 0.001),
    ("foot", 0.3048),
    ("inches", 0.0254),
];

/// A collection that is being filled.
enum Open {
    Sequence { anchor: usize, items: Vec<Value> },
    Mapping { anchor: usize, dict: Dict, merged: Vec<Value>, key: Option<Value> },
}

/// Reads the first document of a file. `expression` evaluates the text below a unit tag.
pub(crate) fn load(
    file: &Rc<SourceFile>,
    meter: &mut Meter,
    expression: &dyn Fn(&str, &mut Meter) -> Result<Value, Fault>,
) -> Result<Value, Box<XacroError>> {
    let text = &*file.text;
    meter.text(text.len())?;
    let mut open: Vec<Open> = Vec::new();
    let mut anchors: BTreeMap<usize, Value> = BTreeMap::new();
    for event in Parser::new_from_str(text) {
        let (event, span) = event.map_err(|error| {
            let at = byte_offset(text, error.marker().line(), error.marker().col());
            XacroError::new(ErrorKind::Yaml, format!("this is not well-formed YAML: {}", error.info()))
                .at(&Spot::new(file, at..at + 1))
        })?;
        meter.step(1)?;
        let place = || spot(file, span);
        let finished = match event {
            Event::Scalar(value, style, anchor, tag) => {
                let value = scalar(&value, style, tag.as_deref(), meter, expression)
                    .map_err(|fault| fault.error.at(&place()))?;
                Some((anchor, value))
            }
            Event::Alias(anchor) => {
                let value = anchors.get(&anchor).cloned().ok_or_else(|| {
                    XacroError::new(ErrorKind::Yaml, "the alias is inside the node that it refers to").at(&place())
                })?;
                Some((0, value))
            }
            Event::SequenceStart(anchor, _) => {
                open.push(Open::Sequence { anchor, items: Vec::new() });
                None
            }
            Event::MappingStart(anchor, _) => {
                open.push(Open::Mapping { anchor, dict: Dict::default(), merged: Vec::new(), key: None });
                None
            }
            Event::SequenceEnd | Event::MappingEnd => {
                Some(close(open.pop()).map_err(|fault| fault.error.at(&place()))?)
            }
            Event::DocumentEnd => return Ok(Value::None),
            _ => None,
        };
        if open.len() > DEEPEST {
            return Err(
                XacroError::new(ErrorKind::Limit, format!("the YAML is nested more than {DEEPEST} deep")).at(&place())
            );
        }
        let Some((anchor, value)) = finished else { continue };
        if anchor > 0 {
            anchors.insert(anchor, value.clone());
        }
        match open.last_mut() {
            None => return Ok(value),
            Some(Open::Sequence { items, .. }) => items.push(value),
            Some(Open::Mapping { dict, merged, key, .. }) => match key.take() {
                None => *key = Some(value),
                Some(Value::Text(name)) if &*name == "<<" => merged.push(value),
                Some(name) => dict.insert(name, value).map_err(|fault| fault.error.at(&place()))?,
            },
        }
    }
    Ok(Value::None)
}

fn close(open: Option<Open>) -> Result<(usize, Value), Fault> {
    match open {
        Some(Open::Sequence { anchor, items }) => Ok((anchor, Value::list(items))),
        Some(Open::Mapping { anchor, mut dict, merged, .. }) => {
            for source in merged {
                let sources = match &source {
                    Value::List(items) => items.to_vec(),
                    _ => vec![source],
                };
                for source in sources {
                    let Value::Dict(source) = source else {
                        return Err(Fault::new(ErrorKind::Yaml, "\"<<\" can merge mappings only"));
                    };
                    for (key, value) in source.entries() {
                        if dict.get(key)?.is_none() {
                            dict.insert(key.clone(), value.clone())?;
                        }
                    }
                }
            }
            Ok((anchor, Value::Dict(Rc::new(dict))))
        }
        None => Ok((0, Value::None)),
    }
}

fn scalar(
    text: &str,
    style: ScalarStyle,
    tag: Option<&Tag>,
    meter: &mut Meter,
    expression: &dyn Fn(&str, &mut Meter) -> Result<Value, Fault>,
) -> Result<Value, Fault> {
    let Some(tag) = tag else {
        return Ok(if style == ScalarStyle::Plain { plain(text) } else { Value::text(text) });
    };
    let wrong = |what: &str| Fault::new(ErrorKind::Yaml, format!("\"{text}\" is not {what}"));
    if tag.is_yaml_core_schema() {
        return match &*tag.suffix {
            "str" => Ok(Value::text(text)),
            "null" => Ok(Value::None),
            "bool" => boolean(text).map(Value::Bool).ok_or_else(|| wrong("a truth value")),
            "int" => integer(text).map(Value::Integer).ok_or_else(|| wrong("an integer")),
            "float" => {
                let value = float(text).or_else(|| integer(text).map(|value| value as f64));
                value.map(Value::Float).ok_or_else(|| wrong("a number"))
            }
            other => Err(Fault::new(ErrorKind::Yaml, format!("the tag \"!!{other}\" is not known"))),
        };
    }
    let unit = UNITS.iter().find(|(name, _)| tag.handle == "!" && tag.suffix == *name);
    let Some((_, factor)) = unit else {
        let known: Vec<String> = UNITS.iter().map(|(name, _)| format!("!{name}")).collect();
        return Err(Fault::new(ErrorKind::Yaml, format!("the tag \"{}{}\" is not known", tag.handle, tag.suffix))
            .help(format!("the units are {}", known.join(", "))));
    };
    let value = expression(text, meter)?;
    let number = match &value {
        Value::Text(text) => crate::expression::parse_float(text),
        other => other.as_float(),
    };
    number.map(|number| Value::Float(number * factor)).ok_or_else(|| wrong("a number"))
}

/// The value of a scalar without quotes and tag in YAML 1.1.
fn plain(text: &str) -> Value {
    if matches!(text, "" | "~" | "null" | "Null" | "NULL") {
        return Value::None;
    }
    if let Some(value) = boolean(text) {
        return Value::Bool(value);
    }
    if let Some(value) = integer(text) {
        return Value::Integer(value);
    }
    if let Some(value) = float(text) {
        return Value::Float(value);
    }
    Value::text(text)
}

fn boolean(text: &str) -> Option<bool> {
    let same_case = |word: &str| {
        let mut capital = word.to_owned();
        capital[..1].make_ascii_uppercase();
        text == word || text == capital || text == word.to_ascii_uppercase()
    };
    if ["yes", "true", "on"].into_iter().any(same_case) {
        Some(true)
    } else if ["no", "false", "off"].into_iter().any(same_case) {
        Some(false)
    } else {
        None
    }
}

/// Decimal, `0b…`, `0…` (octal), `0x…`, and `1:30` (base 60).
fn integer(text: &str) -> Option<i128> {
    let (sign, digits) = match text.as_bytes().first()? {
        b'-' => (-1, &text[1..]),
        b'+' => (1, &text[1..]),
        _ => (1, text),
    };
    let first = *digits.as_bytes().first()?;
    if !first.is_ascii_digit() || !digits.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'_' || b == b':') {
        return None;
    }
    let plain = digits.replace('_', "");
    let value = if let Some(binary) = plain.strip_prefix("0b") {
        i128::from_str_radix(binary, 2).ok()?
    } else if let Some(hexadecimal) = plain.strip_prefix("0x") {
        i128::from_str_radix(hexadecimal, 16).ok()?
    } else if plain.contains(':') {
        if first == b'0' {
            return None;
        }
        sexagesimal(&plain)?
    } else if plain.len() > 1 && plain.starts_with('0') {
        i128::from_str_radix(&plain, 8).ok()?
    } else {
        parse_integer(&plain)?
    };
    Some(sign * value)
}

fn sexagesimal(text: &str) -> Option<i128> {
    let mut value = 0i128;
    for (at, part) in text.split(':').enumerate() {
        let part: i128 = part.parse().ok()?;
        if at > 0 && part > 59 {
            return None;
        }
        value = value.checked_mul(60)?.checked_add(part)?;
    }
    Some(value)
}

/// A number with a point; an exponent needs a sign, as in YAML 1.1.
fn float(text: &str) -> Option<f64> {
    let unsigned = text.strip_prefix(['+', '-']).unwrap_or(text);
    match unsigned {
        ".inf" | ".Inf" | ".INF" => {
            return Some(if text.starts_with('-') { f64::NEG_INFINITY } else { f64::INFINITY });
        }
        ".nan" | ".NaN" | ".NAN" if unsigned == text => return Some(f64::NAN),
        _ => {}
    }
    let (mantissa, exponent) = match unsigned.find(['e', 'E']) {
        Some(at) => (&unsigned[..at], Some(&unsigned[at + 1..])),
        None => (unsigned, None),
    };
    let (whole, fraction) = mantissa.split_once('.')?;
    let digits = |part: &str| part.bytes().all(|b| b.is_ascii_digit() || b == b'_');
    let some_digit = |part: &str| part.bytes().any(|b| b.is_ascii_digit());
    let starts_well =
        if whole.is_empty() { some_digit(fraction) } else { whole.starts_with(|c: char| c.is_ascii_digit()) };
    let exponent_fits = exponent.is_none_or(|exponent| {
        exponent.starts_with(['+', '-']) && exponent.len() > 1 && exponent[1..].bytes().all(|b| b.is_ascii_digit())
    });
    if !(starts_well && digits(whole) && digits(fraction) && exponent_fits) {
        return None;
    }
    text.replace('_', "").parse().ok()
}

fn spot(file: &Rc<SourceFile>, span: Span) -> Spot {
    let start = byte_offset(&file.text, span.start.line(), span.start.col());
    let end = byte_offset(&file.text, span.end.line(), span.end.col());
    Spot::new(file, start..end.max(start + 1))
}

/// Lines count from 1, columns from 0.
fn byte_offset(text: &str, line: usize, column: usize) -> usize {
    let start: usize = text.split_inclusive('\n').take(line.saturating_sub(1)).map(str::len).sum();
    let rest = text.get(start..).unwrap_or_default();
    rest.char_indices().nth(column).map_or(text.len(), |(at, _)| start + at)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::limits::Limits;

    fn check(yaml: &str, expected: &str) {
        let file = Rc::new(SourceFile { path: "test.yaml".into(), text: yaml.to_owned() });
        let mut meter = Meter::new(Limits::default());
        let number = |text: &str, _: &mut Meter| Ok(Value::text(text));
        let shown = match load(&file, &mut meter, &number) {
            Ok(value) => value.to_repr(&mut meter).unwrap(),
            Err(error) => error.to_string(),
        };
        assert_eq!(shown, expected, "{yaml}");
    }

    #[test]
    fn scalars_have_the_types_of_yaml_1_1() {
        check("[1, -2, +3, 0x1F, 010, 0b11, 1_000, 1:30]", "[1, -2, 3, 31, 8, 3, 1000, 90]");
        check("[1.5, .5, 1., 1.0e-3, 1.0e+3, .inf, -.inf]", "[1.5, 0.5, 1.0, 0.001, 1000.0, inf, -inf]");
        check("[1e-3, 1.0e3, 09, 1.2.3]", "['1e-3', '1.0e3', '09', '1.2.3']");
        check("[yes, No, ON, off, true, False, y]", "[True, False, True, False, True, False, 'y']");
        check("[~, null, '', 'null', \"1\"]", "[None, None, '', 'null', '1']");
        check("", "None");
    }

    #[test]
    fn collections_anchors_and_merges_are_read() {
        check("a: {b: [1, {c: 2}]}\nd:\n- x\n- y", "{'a': {'b': [1, {'c': 2}]}, 'd': ['x', 'y']}");
        check("a: &x {p: 1, q: 2}\nb:\n  <<: *x\n  q: 3", "{'a': {'p': 1, 'q': 2}, 'b': {'q': 3, 'p': 1}}");
        check("1: a\ntrue: b", "{1: 'b'}");
    }

    #[test]
    fn unit_tags_give_si_units() {
        check("[!degrees 180, !millimeters 5, !inches 1.0, !radians 2]", "[3.141592653589793, 0.005, 0.0254, 2.0]");
        check("!!float 3", "3.0");
        check("!!str 3", "'3'");
    }
}
