//! `'%.3f' % x`, `'{:.3f}'.format(x)`: Python's two ways to write values.

use super::Fault;
use super::number::{exponent_text, float_text};
use super::operators::{describe, dotted, index};
use super::value::Value;
use crate::limits::Meter;

/// How one value is to be written.
#[derive(Debug, Default, Clone)]
struct Specification {
    fill: Option<char>,
    align: Option<char>,
    sign: Option<char>,
    alternate: bool,
    width: usize,
    group: Option<char>,
    precision: Option<usize>,
    kind: Option<char>,
}

/// Wider fields are refused.
const WIDEST: usize = 10_000;

/// `template % values`
pub(super) fn percent_format(template: &str, values: &Value, meter: &mut Meter) -> Result<String, Fault> {
    let arguments = match values {
        Value::Tuple(items) => items.to_vec(),
        other => vec![other.clone()],
    };
    let mut next = arguments.iter();
    let mut out = String::new();
    let mut rest = template;
    while let Some(at) = rest.find('%') {
        out.push_str(&rest[..at]);
        rest = &rest[at + 1..];
        let mut specification = Specification { align: Some('>'), ..Specification::default() };
        let mut value = None;
        if let Some(inner) = rest.strip_prefix('(') {
            let (key, after) =
                inner.split_once(')').ok_or_else(|| Fault::value("the format has \"%(\" without \")\""))?;
            value = Some(index(values, &Value::text(key), meter)?);
            rest = after;
        }
        let flags = rest.len() - rest.trim_start_matches(['-', '+', ' ', '0', '#']).len();
        for flag in rest[..flags].chars() {
            match flag {
                '-' => specification.align = Some('<'),
                '0' if specification.align == Some('>') => {
                    specification.fill = Some('0');
                    specification.align = Some('=');
                }
                '#' => specification.alternate = true,
                '0' => {}
                sign => specification.sign = Some(sign),
            }
        }
        rest = number_after(&rest[flags..], &mut specification.width)?;
        if let Some(after) = rest.strip_prefix('.') {
            let mut precision = 0;
            rest = number_after(after, &mut precision)?;
            specification.precision = Some(precision);
        }
        let kind = rest.chars().next().ok_or_else(|| Fault::value("the format ends after \"%\""))?;
        rest = &rest[kind.len_utf8()..];
        if kind == '%' {
            out.push('%');
            continue;
        }
        let value = match value {
            Some(value) => value,
            None => {
                next.next().cloned().ok_or_else(|| Fault::value("there are fewer values than \"%\" in the format"))?
            }
        };
        let written = match kind {
            's' | 'r' => {
                let text = if kind == 's' { value.to_text(meter)?.to_string() } else { value.to_repr(meter)? };
                specification.kind = Some('s');
                if specification.align == Some('=') {
                    (specification.align, specification.fill) = (Some('>'), None);
                }
                write_value(&Value::text(text), &specification, meter)?
            }
            'd' | 'i' | 'u' => {
                specification.kind = Some('d');
                let integer = match &value {
                    Value::Float(float) => super::math::rounded(float.trunc())?,
                    other => other.clone(),
                };
                write_value(&integer, &specification, meter)?
            }
            'f' | 'F' | 'e' | 'E' | 'g' | 'G' | 'x' | 'X' | 'o' => {
                specification.kind = Some(kind);
                write_value(&value, &specification, meter)?
            }
            other => return Err(Fault::value(format!("\"%{other}\" is not known"))),
        };
        out.push_str(&written);
        meter.text(out.len())?;
    }
    let left_over = next.next().is_some() && !matches!(values, Value::Dict(_));
    if left_over {
        return Err(Fault::value("there are more values than \"%\" in the format"));
    }
    out.push_str(rest);
    Ok(out)
}

fn number_after<'a>(text: &'a str, number: &mut usize) -> Result<&'a str, Fault> {
    let digits = text.bytes().take_while(u8::is_ascii_digit).count();
    if digits > 0 {
        *number = text[..digits]
            .parse()
            .ok()
            .filter(|&width| width <= WIDEST)
            .ok_or_else(|| Fault::value(format!("a field of {} characters is too wide", &text[..digits])))?;
    }
    Ok(&text[digits..])
}

/// `template.format(…)`
pub(super) fn brace_format(
    template: &str,
    plain: &[Value],
    named: &[(std::rc::Rc<str>, Value)],
    meter: &mut Meter,
) -> Result<String, Fault> {
    let mut out = String::new();
    let mut rest = template;
    let mut automatic = 0;
    while let Some(at) = rest.find(['{', '}']) {
        out.push_str(&rest[..at]);
        let brace = &rest[at..=at];
        rest = &rest[at + 1..];
        if let Some(after) = rest.strip_prefix(brace) {
            out.push_str(brace);
            rest = after;
            continue;
        }
        let unbalanced = || Fault::value("the format has a single brace; double it for a literal brace");
        if brace == "}" {
            return Err(unbalanced());
        }
        let (field, after) = rest.split_once('}').ok_or_else(unbalanced)?;
        rest = after;
        let (field, specification) = field.split_once(':').unwrap_or((field, ""));
        let (path, conversion) = match field.split_once('!') {
            Some((path, conversion)) => (path, conversion),
            None => (field, ""),
        };
        let mut value = field_value(path, plain, named, &mut automatic, meter)?;
        match conversion {
            "" => {}
            "s" => value = Value::Text(value.to_text(meter)?),
            "r" => value = Value::text(value.to_repr(meter)?),
            other => return Err(Fault::value(format!("the conversion \"!{other}\" is not known"))),
        }
        let specification = specification_of(specification)?;
        out.push_str(&write_value(&value, &specification, meter)?);
        meter.text(out.len())?;
    }
    out.push_str(rest);
    Ok(out)
}

/// `0`, `name`, nothing for the next one; then `.key` and `[index]`.
fn field_value(
    path: &str,
    plain: &[Value],
    named: &[(std::rc::Rc<str>, Value)],
    automatic: &mut usize,
    meter: &mut Meter,
) -> Result<Value, Fault> {
    let end = path.find(['.', '[']).unwrap_or(path.len());
    let head = &path[..end];
    let missing = || Fault::value(format!("the format needs \"{head}\", which is not given"));
    let mut value = if head.is_empty() {
        *automatic += 1;
        plain
            .get(*automatic - 1)
            .cloned()
            .ok_or_else(|| Fault::value("there are fewer values than braces in the format"))?
    } else if let Ok(position) = head.parse::<usize>() {
        plain.get(position).cloned().ok_or_else(missing)?
    } else {
        named.iter().find(|(name, _)| &**name == head).map(|(_, value)| value.clone()).ok_or_else(missing)?
    };
    let mut rest = &path[end..];
    while !rest.is_empty() {
        let (key, bracketed) = if let Some(inner) = rest.strip_prefix('[') {
            let (key, after) =
                inner.split_once(']').ok_or_else(|| Fault::value("the format has \"[\" without \"]\""))?;
            rest = after;
            (key, true)
        } else {
            let inner = rest.strip_prefix('.').ok_or_else(missing)?;
            let end = inner.find(['.', '[']).unwrap_or(inner.len());
            rest = &inner[end..];
            (&inner[..end], false)
        };
        value = match (&value, key.parse::<i128>()) {
            (Value::Dict(dict), _) if !bracketed => {
                dict.get_text(key).cloned().ok_or_else(|| dotted(dict.entries(), key))?
            }
            (_, Ok(position)) => index(&value, &Value::Integer(position), meter)?,
            _ => index(&value, &Value::text(key), meter)?,
        };
    }
    Ok(value)
}

fn specification_of(text: &str) -> Result<Specification, Fault> {
    let wrong = || Fault::value(format!("the format \"{text}\" is not known"));
    let mut specification = Specification::default();
    let mut characters = text.chars();
    let (first, second) = (characters.next(), characters.next());
    let is_align = |c: Option<char>| c.is_some_and(|c| "<>=^".contains(c));
    let mut rest = text;
    if is_align(second) {
        (specification.fill, specification.align) = (first, second);
        rest = characters.as_str();
    } else if is_align(first) {
        specification.align = first;
        rest = &text[1..];
    }
    if let Some(sign) = rest.chars().next().filter(|c| "+- ".contains(*c)) {
        specification.sign = Some(sign);
        rest = &rest[1..];
    }
    if let Some(after) = rest.strip_prefix('#') {
        specification.alternate = true;
        rest = after;
    }
    if rest.starts_with('0') && specification.align.is_none() {
        (specification.fill, specification.align) = (Some('0'), Some('='));
    }
    rest = number_after(rest, &mut specification.width)?;
    if let Some(group) = rest.chars().next().filter(|c| ",_".contains(*c)) {
        specification.group = Some(group);
        rest = &rest[1..];
    }
    if let Some(after) = rest.strip_prefix('.') {
        let mut precision = 0;
        if !after.starts_with(|c: char| c.is_ascii_digit()) {
            return Err(wrong());
        }
        rest = number_after(after, &mut precision)?;
        specification.precision = Some(precision);
    }
    let mut kinds = rest.chars();
    specification.kind = kinds.next();
    if kinds.next().is_some() {
        return Err(wrong());
    }
    Ok(specification)
}

fn write_value(value: &Value, specification: &Specification, meter: &mut Meter) -> Result<String, Fault> {
    meter.step(specification.width / 16 + 1)?;
    let text_kind = matches!(specification.kind, None | Some('s'));
    if let (Value::Text(text), true) = (value, text_kind) {
        let shown: String = match specification.precision {
            Some(precision) => text.chars().take(precision).collect(),
            None => text.to_string(),
        };
        return Ok(pad("", &shown, specification, '<'));
    }
    let plain = specification.kind.is_none() && specification.precision.is_none();
    if plain && value.as_float().is_none() || matches!((value, plain), (Value::Bool(_), true)) {
        return Ok(pad("", &value.to_text(meter)?, specification, '<'));
    }
    let (negative, digits) = match (specification.kind, value.as_integer()) {
        (None | Some('d' | 'n'), Some(integer))
            if specification.precision.is_none() || specification.kind.is_some() =>
        {
            (integer < 0, grouped(&integer.unsigned_abs().to_string(), specification.group))
        }
        (Some(kind @ ('x' | 'X' | 'o' | 'b')), Some(integer)) => {
            let absolute = integer.unsigned_abs();
            let (prefix, digits) = match kind {
                'x' => ("0x", format!("{absolute:x}")),
                'X' => ("0X", format!("{absolute:X}")),
                'o' => ("0o", format!("{absolute:o}")),
                _ => ("0b", format!("{absolute:b}")),
            };
            (integer < 0, if specification.alternate { format!("{prefix}{digits}") } else { digits })
        }
        (Some('c'), Some(integer)) => {
            let c = u32::try_from(integer).ok().and_then(char::from_u32);
            let c = c.ok_or_else(|| Fault::value(format!("{integer} is not a character")))?;
            return Ok(pad("", &c.to_string(), specification, '<'));
        }
        _ => {
            let float = value.as_float().ok_or_else(|| {
                let kind = specification.kind.map(String::from).unwrap_or_default();
                Fault::value(format!("the format \"{kind}\" cannot write {}", describe(value)))
            })?;
            (float.is_sign_negative() && !float.is_nan(), float_digits(float.abs(), specification)?)
        }
    };
    let sign = match (negative, specification.sign) {
        (true, _) => "-",
        (false, Some('+')) => "+",
        (false, Some(' ')) => " ",
        _ => "",
    };
    Ok(pad(sign, &digits, specification, '>'))
}

/// The digits of a float that is not negative.
fn float_digits(value: f64, specification: &Specification) -> Result<String, Fault> {
    let precision = specification.precision.unwrap_or(6);
    let kind = specification.kind;
    if !value.is_finite() {
        let text = float_text(value);
        return Ok(if kind.is_some_and(|kind| kind.is_ascii_uppercase()) { text.to_uppercase() } else { text });
    }
    let digits = match kind {
        Some('f' | 'F') => format!("{value:.precision$}"),
        Some('%') => format!("{:.precision$}%", value * 100.0),
        Some('e' | 'E') => exponential(value, precision),
        Some('g' | 'G' | 'n') => general(value, precision.max(1), specification.alternate),
        None => match specification.precision {
            None => float_text(value),
            Some(precision) => {
                let text = general(value, precision.max(1), false);
                if text.contains(['.', 'e']) { text } else { format!("{text}.0") }
            }
        },
        Some(other) => {
            return Err(Fault::value(format!("the format \"{other}\" cannot write the number {value}")));
        }
    };
    let digits = match (specification.group, digits.find(['.', 'e', '%'])) {
        (None, _) => digits,
        (group, Some(end)) => grouped(&digits[..end], group) + &digits[end..],
        (group, None) => grouped(&digits, group),
    };
    Ok(if matches!(kind, Some('E' | 'G')) { digits.to_uppercase() } else { digits })
}

fn exponential(value: f64, precision: usize) -> String {
    let text = format!("{value:.precision$e}");
    let (digits, exponent) = text.split_once('e').expect("`{:e}` writes an exponent");
    let exponent: i32 = exponent.parse().expect("the exponent of an f64 is a small integer");
    format!("{digits}e{}", exponent_text(exponent))
}

/// `%g`: `precision` significant digits, without trailing zeros.
fn general(value: f64, precision: usize, keep_zeros: bool) -> String {
    let scientific = exponential(value, precision - 1);
    let (digits, exponent) = scientific.split_once('e').expect("`exponential` writes an exponent");
    let exponent: i32 = exponent.parse().expect("the exponent of an f64 is a small integer");
    let strip = |digits: &str| {
        if keep_zeros || !digits.contains('.') {
            digits.to_owned()
        } else {
            digits.trim_end_matches('0').trim_end_matches('.').to_owned()
        }
    };
    let significant = i32::try_from(precision).unwrap_or(i32::MAX);
    if exponent < -4 || exponent >= significant {
        return format!("{}e{}", strip(digits), exponent_text(exponent));
    }
    let decimals = usize::try_from(significant - 1 - exponent).unwrap_or(0);
    strip(&format!("{value:.decimals$}"))
}

fn grouped(digits: &str, group: Option<char>) -> String {
    let Some(separator) = group else { return digits.to_owned() };
    let mut out = String::new();
    for (at, digit) in digits.chars().enumerate() {
        if at > 0 && (digits.len() - at).is_multiple_of(3) {
            out.push(separator);
        }
        out.push(digit);
    }
    out
}

fn pad(sign: &str, body: &str, specification: &Specification, default_align: char) -> String {
    let length = sign.chars().count() + body.chars().count();
    let missing = specification.width.saturating_sub(length);
    let fill = specification.fill.unwrap_or(' ').to_string();
    let align = specification.align.unwrap_or(default_align);
    let (left, right) = match align {
        '<' => (0, missing),
        '^' => (missing / 2, missing - missing / 2),
        _ => (missing, 0),
    };
    if align == '=' {
        return format!("{sign}{}{body}", fill.repeat(missing));
    }
    format!("{}{sign}{body}{}", fill.repeat(left), fill.repeat(right))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::limits::Limits;

    fn check_percent(template: &str, values: &Value, expected: &str) {
        let mut meter = Meter::new(Limits::default());
        assert_eq!(percent_format(template, values, &mut meter).unwrap(), expected);
    }

    fn check_braces(template: &str, value: Value, expected: &str) {
        let mut meter = Meter::new(Limits::default());
        assert_eq!(brace_format(template, &[value], &[], &mut meter).unwrap(), expected);
    }

    #[test]
    fn percent_formats_write_as_python_does() {
        check_percent("%.3f", &Value::Float(2.0 / 3.0), "0.667");
        check_percent("%5d|%-5d|%05d", &Value::tuple(vec![Value::Integer(-7); 3]), "   -7|-7   |-0007");
        check_percent(
            "%g %g %g",
            &Value::tuple([1e-5, 100_000.0, 1e6].map(Value::Float).to_vec()),
            "1e-05 100000 1e+06",
        );
        check_percent("%s is 100%%", &Value::text("x"), "x is 100%");
        check_percent("%x", &Value::Integer(255), "ff");
    }

    #[test]
    fn brace_formats_write_as_python_does() {
        check_braces("{:.3f}", Value::Float(1.0), "1.000");
        check_braces("{0:>6}|{0:<6}|{0:^6}", Value::text("ab"), "    ab|ab    |  ab  ");
        check_braces("{:+,.2f}", Value::Float(1_234_567.891), "+1,234,567.89");
        check_braces("{:08.3f}", Value::Float(-3.5), "-003.500");
        check_braces("{:e}", Value::Float(12345.678), "1.234568e+04");
        check_braces("{:.3}", Value::Float(2.0), "2.0");
        check_braces("{{{}}}", Value::Integer(3), "{3}");
        check_braces("{!r}", Value::text("it's"), "\"it's\"");
        check_braces("{:05d}", Value::Integer(42), "00042");
        check_braces("{:.0%}", Value::Float(0.5), "50%");
    }
}
