//! `+ - * / // % **`, comparison, membership, indexing: with Python's results.

use std::cmp::Ordering;
use std::rc::Rc;

use super::Fault;
use super::format::percent_format;
use super::syntax::{Binary, Comparison, Unary};
use super::value::Value;
use crate::error::{ErrorKind, did_you_mean, near};
use crate::limits::Meter;

pub(super) fn unary(operator: Unary, value: &Value) -> Result<Value, Fault> {
    if operator == Unary::Not {
        return Ok(Value::Bool(!value.is_true()));
    }
    let wrong = |symbol| Fault::value(format!("\"{symbol}\" needs a number, not {}", describe(value)));
    match (operator, value.as_integer(), value) {
        (Unary::Minus, Some(integer), _) => integer.checked_neg().map(Value::Integer).ok_or_else(too_large),
        (Unary::Plus, Some(integer), _) => Ok(Value::Integer(integer)),
        (Unary::Invert, Some(integer), _) => Ok(Value::Integer(!integer)),
        (Unary::Minus, None, Value::Float(float)) => Ok(Value::Float(-float)),
        (Unary::Plus, None, Value::Float(float)) => Ok(Value::Float(*float)),
        (Unary::Minus, ..) => Err(wrong("-")),
        (Unary::Plus, ..) => Err(wrong("+")),
        _ => Err(wrong("~")),
    }
}

pub(super) fn binary(operator: Binary, left: &Value, right: &Value, meter: &mut Meter) -> Result<Value, Fault> {
    if let (Some(a), Some(b)) = (left.as_integer(), right.as_integer()) {
        return integers(operator, a, b);
    }
    if let (Some(a), Some(b)) = (left.as_float(), right.as_float()) {
        return floats(operator, a, b).ok_or_else(|| mismatch(operator, left, right))?;
    }
    match (operator, left, right) {
        (Binary::Add, Value::Text(a), Value::Text(b)) => {
            meter.text(a.len() + b.len())?;
            Ok(Value::text([&**a, &**b].concat()))
        }
        (Binary::Add, Value::List(a), Value::List(b)) => {
            meter.step(a.len() + b.len())?;
            Ok(Value::list([&***a, &***b].concat()))
        }
        (Binary::Add, Value::Tuple(a), Value::Tuple(b)) => {
            meter.step(a.len() + b.len())?;
            Ok(Value::tuple([&***a, &***b].concat()))
        }
        (Binary::Multiply, sequence, count) | (Binary::Multiply, count, sequence)
            if count.as_integer().is_some() && length(sequence).is_some() =>
        {
            repeat(sequence, count.as_integer().unwrap_or(0), meter)
        }
        (Binary::Modulo, Value::Text(template), values) => percent_format(template, values, meter).map(Value::text),
        _ => Err(mismatch(operator, left, right)),
    }
}

fn repeat(sequence: &Value, count: i128, meter: &mut Meter) -> Result<Value, Fault> {
    let count = usize::try_from(count.max(0)).unwrap_or(usize::MAX);
    match sequence {
        Value::Text(text) => {
            meter.text(text.len().saturating_mul(count))?;
            Ok(Value::text(text.repeat(count)))
        }
        Value::List(items) | Value::Tuple(items) => {
            meter.step(items.len().saturating_mul(count))?;
            let total = items.len().saturating_mul(count);
            let repeated: Vec<Value> = items.iter().cycle().take(total).cloned().collect();
            Ok(match sequence {
                Value::List(_) => Value::list(repeated),
                _ => Value::tuple(repeated),
            })
        }
        other => Err(Fault::value(format!("{} cannot be repeated", describe(other)))),
    }
}

fn integers(operator: Binary, a: i128, b: i128) -> Result<Value, Fault> {
    let integer = match operator {
        Binary::Add => a.checked_add(b),
        Binary::Subtract => a.checked_sub(b),
        Binary::Multiply => a.checked_mul(b),
        Binary::Divide | Binary::FloorDivide | Binary::Modulo if b == 0 => {
            return Err(division_by_zero());
        }
        Binary::Divide => return Ok(Value::Float(a as f64 / b as f64)),
        Binary::FloorDivide => a.checked_div_euclid(b).map(|quotient| {
            // Euclid rounds towards the sign of the divisor; Python rounds down.
            if b < 0 && a.rem_euclid(b) != 0 { quotient - 1 } else { quotient }
        }),
        Binary::Modulo => a.checked_rem_euclid(b).map(|rest| if b < 0 && rest != 0 { rest + b } else { rest }),
        Binary::Power if b < 0 => {
            return floats(operator, a as f64, b as f64).unwrap_or_else(|| Err(division_by_zero()));
        }
        Binary::Power => match (a, u32::try_from(b)) {
            (0 | 1, _) => Some(if b == 0 { 1 } else { a }),
            (-1, _) => Some(if b % 2 == 0 { 1 } else { -1 }),
            (_, Ok(exponent)) => a.checked_pow(exponent),
            (_, Err(_)) => None,
        },
        Binary::And => Some(a & b),
        Binary::Or => Some(a | b),
        Binary::Xor => Some(a ^ b),
        Binary::ShiftLeft | Binary::ShiftRight if b < 0 => {
            return Err(Fault::value(format!("a shift by {b}, which is negative")));
        }
        Binary::ShiftLeft if a == 0 => Some(0),
        Binary::ShiftLeft => {
            u32::try_from(b).ok().filter(|&bits| bits < 127).and_then(|bits| a.checked_mul(1i128 << bits))
        }
        Binary::ShiftRight => Some(a >> u32::try_from(b).unwrap_or(127).min(127)),
    };
    integer.map(Value::Integer).ok_or_else(too_large)
}

fn too_large() -> Fault {
    Fault::new(ErrorKind::Limit, "the result is an integer with more than 127 bits")
        .help("calculate with floats: write 10.0 instead of 10")
}

fn division_by_zero() -> Fault {
    Fault::value("division by zero")
}

/// `None` if the operator has no meaning for floats.
fn floats(operator: Binary, a: f64, b: f64) -> Option<Result<Value, Fault>> {
    let value = match operator {
        Binary::Add => a + b,
        Binary::Subtract => a - b,
        Binary::Multiply => a * b,
        Binary::Divide | Binary::FloorDivide | Binary::Modulo if b == 0.0 => {
            return Some(Err(division_by_zero()));
        }
        Binary::Divide => a / b,
        Binary::FloorDivide => {
            let rest = python_rest(a, b);
            ((a - rest) / b).round()
        }
        Binary::Modulo => python_rest(a, b),
        Binary::Power if a == 0.0 && b < 0.0 => return Some(Err(division_by_zero())),
        Binary::Power => {
            let power = a.powf(b);
            if a < 0.0 && b.fract() != 0.0 && b.is_finite() {
                return Some(Err(Fault::value(format!("{a} to the power of {b} is a complex number"))));
            }
            if power.is_infinite() && a.is_finite() && b.is_finite() {
                return Some(Err(Fault::value("the result is too large for a number")));
            }
            power
        }
        _ => return None,
    };
    Some(Ok(Value::Float(value)))
}

/// The rest of a division that rounds down: it has the sign of the divisor.
fn python_rest(a: f64, b: f64) -> f64 {
    let rest = a % b;
    if rest != 0.0 && (rest < 0.0) != (b < 0.0) { rest + b } else { rest }
}

fn mismatch(operator: Binary, left: &Value, right: &Value) -> Fault {
    let symbol = operator.symbol();
    let fault = Fault::value(format!("\"{symbol}\" does not work between {} and {}", describe(left), describe(right)));
    match (operator, left, right) {
        (Binary::Add, Value::Text(_), _) | (Binary::Add, _, Value::Text(_)) => {
            fault.help("turn the number into text with str(…), or the text into a number with float(…)")
        }
        (_, Value::Text(_), _) | (_, _, Value::Text(_)) => fault.help("turn the text into a number with float(…)"),
        _ => fault,
    }
}

/// A value in an error message: its type, and the value itself where that is short.
pub(super) fn describe(value: &Value) -> String {
    match value {
        Value::None => "None".to_owned(),
        Value::Bool(true) => "True".to_owned(),
        Value::Bool(false) => "False".to_owned(),
        Value::Integer(integer) => format!("the number {integer}"),
        Value::Float(float) => format!("the number {}", super::number::float_text(*float)),
        Value::Text(text) if text.chars().count() <= 40 => format!("the text \"{text}\""),
        Value::Text(text) => format!("the text \"{}…\"", text.chars().take(40).collect::<String>()),
        other => format!("a {}", other.type_name()),
    }
}

pub(super) fn compare(comparison: Comparison, left: &Value, right: &Value, meter: &mut Meter) -> Result<bool, Fault> {
    Ok(match comparison {
        Comparison::Equal => equal(left, right, meter)?,
        Comparison::NotEqual => !equal(left, right, meter)?,
        Comparison::Is => identical(left, right),
        Comparison::IsNot => !identical(left, right),
        Comparison::In => contains(right, left, meter)?,
        Comparison::NotIn => !contains(right, left, meter)?,
        Comparison::Less | Comparison::LessEqual | Comparison::Greater | Comparison::GreaterEqual => {
            let Some(ordering) = order(left, right, meter)? else {
                return if left.as_float().is_some() && right.as_float().is_some() {
                    Ok(false)
                } else {
                    Err(Fault::value(format!(
                        "\"{}\" does not work between {} and {}",
                        comparison.symbol(),
                        describe(left),
                        describe(right)
                    )))
                };
            };
            match comparison {
                Comparison::Less => ordering.is_lt(),
                Comparison::LessEqual => ordering.is_le(),
                Comparison::Greater => ordering.is_gt(),
                _ => ordering.is_ge(),
            }
        }
    })
}

fn identical(left: &Value, right: &Value) -> bool {
    match (left, right) {
        (Value::None, Value::None) => true,
        (Value::Bool(a), Value::Bool(b)) => a == b,
        (Value::Integer(a), Value::Integer(b)) => a == b,
        (Value::Text(a), Value::Text(b)) => a == b,
        (Value::List(a), Value::List(b)) | (Value::Tuple(a), Value::Tuple(b)) => Rc::ptr_eq(a, b),
        (Value::Dict(a), Value::Dict(b)) => Rc::ptr_eq(a, b),
        _ => false,
    }
}

pub(super) fn equal(left: &Value, right: &Value, meter: &mut Meter) -> Result<bool, Fault> {
    meter.step(1)?;
    if let (Some(a), Some(b)) = (left.as_integer(), right.as_integer()) {
        return Ok(a == b);
    }
    if let (Some(a), Some(b)) = (left.as_float(), right.as_float()) {
        return Ok(a == b);
    }
    Ok(match (left, right) {
        (Value::None, Value::None) => true,
        (Value::Text(a), Value::Text(b)) => a == b,
        (Value::List(a), Value::List(b)) | (Value::Tuple(a), Value::Tuple(b)) => {
            if a.len() != b.len() {
                return Ok(false);
            }
            for (a, b) in a.iter().zip(b.iter()) {
                if !equal(a, b, meter)? {
                    return Ok(false);
                }
            }
            true
        }
        (Value::Dict(a), Value::Dict(b)) => {
            if a.entries().len() != b.entries().len() {
                return Ok(false);
            }
            for (key, value) in a.entries() {
                let same = match b.get(key)? {
                    Some(other) => equal(value, other, meter)?,
                    None => false,
                };
                if !same {
                    return Ok(false);
                }
            }
            true
        }
        _ => false,
    })
}

/// `None` if the two have no order.
pub(super) fn order(left: &Value, right: &Value, meter: &mut Meter) -> Result<Option<Ordering>, Fault> {
    meter.step(1)?;
    if let (Some(a), Some(b)) = (left.as_integer(), right.as_integer()) {
        return Ok(Some(a.cmp(&b)));
    }
    if let (Some(a), Some(b)) = (left.as_float(), right.as_float()) {
        return Ok(a.partial_cmp(&b));
    }
    match (left, right) {
        (Value::Text(a), Value::Text(b)) => Ok(Some(a.cmp(b))),
        (Value::List(a), Value::List(b)) | (Value::Tuple(a), Value::Tuple(b)) => {
            for (a, b) in a.iter().zip(b.iter()) {
                if !equal(a, b, meter)? {
                    return order(a, b, meter);
                }
            }
            Ok(Some(a.len().cmp(&b.len())))
        }
        _ => Ok(None),
    }
}

fn contains(container: &Value, item: &Value, meter: &mut Meter) -> Result<bool, Fault> {
    match (container, item) {
        (Value::Text(text), Value::Text(part)) => {
            meter.text(text.len())?;
            Ok(text.contains(&**part))
        }
        (Value::List(items) | Value::Tuple(items), _) => {
            for candidate in items.iter() {
                if equal(candidate, item, meter)? {
                    return Ok(true);
                }
            }
            Ok(false)
        }
        (Value::Dict(dict), _) => Ok(dict.get(item)?.is_some()),
        _ => Err(Fault::value(format!("\"in\" cannot search {}", describe(container)))),
    }
}

/// Items of a sequence, characters of a text, keys of a dictionary; `None` for everything else.
pub(super) fn length(value: &Value) -> Option<usize> {
    match value {
        Value::Text(text) => Some(text.chars().count()),
        Value::List(items) | Value::Tuple(items) => Some(items.len()),
        Value::Dict(dict) => Some(dict.entries().len()),
        _ => None,
    }
}

/// `container[index]`
pub(super) fn index(container: &Value, index: &Value, meter: &mut Meter) -> Result<Value, Fault> {
    if let Value::Dict(dict) = container {
        return dict.get(index)?.cloned().ok_or_else(|| missing_key(dict.entries(), index));
    }
    let (Some(length), Some(position)) = (length(container), index.as_integer()) else {
        return Err(match length(container) {
            Some(_) => Fault::value(format!("an index must be an integer, not {}", describe(index))),
            None => Fault::value(format!("{} cannot be indexed", describe(container))),
        });
    };
    let from_start = if position < 0 { position + length as i128 } else { position };
    let at = usize::try_from(from_start)
        .ok()
        .filter(|&at| at < length)
        .ok_or_else(|| Fault::value(format!("index {position} is out of range: there are {length} items")))?;
    Ok(match container {
        Value::List(items) | Value::Tuple(items) => items[at].clone(),
        Value::Text(text) => {
            meter.text(text.len())?;
            Value::text(text.chars().skip(at).take(1).collect::<String>())
        }
        _ => Value::None,
    })
}

fn missing_key(entries: &[(Value, Value)], key: &Value) -> Fault {
    let names: Vec<&str> = entries
        .iter()
        .filter_map(|(key, _)| match key {
            Value::Text(name) => Some(&**name),
            _ => None,
        })
        .collect();
    let fault = Fault::new(
        ErrorKind::UndefinedName,
        format!("there is no key {}", describe(key).trim_start_matches("the text ")),
    );
    let alike = match key {
        Value::Text(word) => near(word, names.iter().copied()),
        _ => Vec::new(),
    };
    match did_you_mean(&alike) {
        Some(help) => fault.help(help),
        None if names.is_empty() => fault,
        None => {
            let shown: Vec<&str> = names.iter().copied().take(8).collect();
            let more = if names.len() > shown.len() { ", …" } else { "" };
            fault.help(format!("the keys are {}{more}", shown.join(", ")))
        }
    }
}

/// `container.key` of a dictionary.
pub(super) fn dotted(entries: &[(Value, Value)], key: &str) -> Fault {
    missing_key(entries, &Value::text(key))
}

/// `container[start:stop:step]`
pub(super) fn slice(container: &Value, parts: &[Option<Value>; 3], meter: &mut Meter) -> Result<Value, Fault> {
    let Some(length) = length(container).filter(|_| !matches!(container, Value::Dict(_))) else {
        return Err(Fault::value(format!("{} cannot be sliced", describe(container))));
    };
    let mut bounds = [None; 3];
    for (bound, part) in bounds.iter_mut().zip(parts) {
        *bound = match part {
            None | Some(Value::None) => None,
            Some(value) => Some(
                value
                    .as_integer()
                    .ok_or_else(|| Fault::value(format!("an index must be an integer, not {}", describe(value))))?,
            ),
        };
    }
    let step = bounds[2].unwrap_or(1);
    if step == 0 {
        return Err(Fault::value("the step of a slice is 0"));
    }
    let size = length as i128;
    let (lowest, highest) = if step > 0 { (0, size) } else { (-1, size - 1) };
    let place = |bound: Option<i128>, default: i128| {
        bound.map_or(default, |at| if at < 0 { at.saturating_add(size) } else { at }.clamp(lowest, highest))
    };
    let (mut at, stop) = if step > 0 {
        (place(bounds[0], lowest), place(bounds[1], highest))
    } else {
        (place(bounds[0], highest), place(bounds[1], lowest))
    };
    meter.step(length)?;
    let mut positions = Vec::new();
    while if step > 0 { at < stop } else { at > stop } {
        positions.extend(usize::try_from(at).ok());
        at = at.saturating_add(step);
    }
    Ok(match container {
        Value::Text(text) => {
            let characters: Vec<char> = text.chars().collect();
            Value::text(positions.into_iter().map(|at| characters[at]).collect::<String>())
        }
        Value::List(items) => Value::list(positions.into_iter().map(|at| items[at].clone()).collect()),
        Value::Tuple(items) => Value::tuple(positions.into_iter().map(|at| items[at].clone()).collect()),
        _ => Value::None,
    })
}
