//! Methods of texts, lists and dictionaries. Those that would change a value in place are not there.

use std::rc::Rc;

use super::Fault;
use super::evaluate::{Arguments, Evaluator};
use super::format::brace_format;
use super::operators::describe;
use super::sequences::position;
use super::value::Value;

const TEXT: &[&str] = &[
    "capitalize",
    "center",
    "count",
    "endswith",
    "find",
    "format",
    "index",
    "isalnum",
    "isalpha",
    "isdigit",
    "islower",
    "isnumeric",
    "isspace",
    "isupper",
    "join",
    "ljust",
    "lower",
    "lstrip",
    "partition",
    "removeprefix",
    "removesuffix",
    "replace",
    "rfind",
    "rjust",
    "rpartition",
    "rsplit",
    "rstrip",
    "split",
    "splitlines",
    "startswith",
    "strip",
    "swapcase",
    "title",
    "upper",
    "zfill",
];
const LIST: &[&str] = &["copy", "count", "index"];
const DICT: &[&str] = &["copy", "get", "items", "keys", "values"];

/// The method's name, if values of this type have it.
pub(super) fn known(object: &Value, name: &str) -> Option<&'static str> {
    let list = match object {
        Value::Text(_) => TEXT,
        Value::List(_) | Value::Tuple(_) => LIST,
        Value::Dict(_) => DICT,
        _ => return None,
    };
    list.iter().find(|known| **known == name).copied()
}

pub(super) fn call(
    object: &Value,
    name: &str,
    arguments: Arguments,
    evaluator: &mut Evaluator<'_>,
) -> Result<Value, Fault> {
    match object {
        Value::Text(text) if name == "format" => {
            evaluator.meter().text(text.len())?;
            brace_format(text, &arguments.plain, &arguments.named, evaluator.meter()).map(Value::text)
        }
        Value::Text(text) => {
            let arguments = text_arguments(name, arguments)?;
            evaluator.meter().text(text.len())?;
            text_method(text, name, &arguments, evaluator)
        }
        Value::Dict(dict) => match (name, &arguments.plain[..]) {
            ("keys", []) => evaluator.items(object).map(Value::list),
            ("values", []) => {
                evaluator.meter().step(dict.entries().len())?;
                Ok(Value::list(dict.entries().iter().map(|(_, value)| value.clone()).collect()))
            }
            ("items", []) => {
                evaluator.meter().step(dict.entries().len())?;
                let pairs = dict.entries().iter();
                Ok(Value::list(pairs.map(|(key, value)| Value::tuple(vec![key.clone(), value.clone()])).collect()))
            }
            ("copy", []) => Ok(object.clone()),
            ("get", [key]) => Ok(dict.get(key)?.cloned().unwrap_or(Value::None)),
            ("get", [key, default]) => Ok(dict.get(key)?.unwrap_or(default).clone()),
            _ => Err(wrong_arguments(name)),
        },
        Value::List(items) | Value::Tuple(items) => match (name, &arguments.plain[..]) {
            ("copy", []) => Ok(object.clone()),
            ("index", [wanted]) => match position(items, wanted, evaluator)? {
                Some(at) => Ok(Value::Integer(at as i128)),
                None => Err(Fault::value(format!("{} is not in the list", describe(wanted)))),
            },
            ("count", [wanted]) => {
                let mut count = 0;
                for item in items.iter() {
                    count += i128::from(super::operators::equal(item, wanted, evaluator.meter())?);
                }
                Ok(Value::Integer(count))
            }
            _ => Err(wrong_arguments(name)),
        },
        other => Err(Fault::value(format!("{} has no method \"{name}\"", describe(other)))),
    }
}

fn wrong_arguments(name: &str) -> Fault {
    Fault::value(format!("{name}() cannot take these arguments"))
}

/// The arguments in order; only `split` has names for them.
fn text_arguments(name: &str, arguments: Arguments) -> Result<Vec<Value>, Fault> {
    let mut plain = arguments.plain;
    for (argument, value) in arguments.named {
        let at = match (name, &*argument) {
            ("split" | "rsplit", "sep") => 0,
            ("split" | "rsplit", "maxsplit") => 1,
            _ => return Err(Fault::value(format!("{name}() has no argument \"{argument}\""))),
        };
        plain.resize(plain.len().max(at + 1), Value::None);
        plain[at] = value;
    }
    Ok(plain)
}

fn text_method(text: &str, name: &str, arguments: &[Value], evaluator: &mut Evaluator<'_>) -> Result<Value, Fault> {
    Ok(match (name, arguments) {
        ("split", _) => split(text, arguments, false, evaluator)?,
        ("rsplit", _) => split(text, arguments, true, evaluator)?,
        ("splitlines", []) => {
            let lines: Vec<Value> = text.lines().map(Value::text).collect();
            evaluator.meter().step(lines.len())?;
            Value::list(lines)
        }
        ("lower", []) => Value::text(text.to_lowercase()),
        ("upper", []) => Value::text(text.to_uppercase()),
        ("swapcase", []) => Value::text(
            text.chars()
                .flat_map(|c| {
                    if c.is_lowercase() { c.to_uppercase().collect::<Vec<_>>() } else { c.to_lowercase().collect() }
                })
                .collect::<String>(),
        ),
        ("capitalize", []) => Value::text(capitalised(text)),
        ("title", []) => {
            let words = text.split_inclusive(|c: char| !c.is_alphabetic()).map(capitalised);
            Value::text(words.collect::<String>())
        }
        ("strip" | "lstrip" | "rstrip", []) => Value::text(strip(text, name, char::is_whitespace)),
        ("strip" | "lstrip" | "rstrip", [Value::Text(set)]) => Value::text(strip(text, name, |c| set.contains(c))),
        ("replace", [Value::Text(from), Value::Text(to), rest @ ..]) => {
            let most = match rest {
                [] => usize::MAX,
                [count] => count.as_integer().map_or(usize::MAX, |count| usize::try_from(count).unwrap_or(usize::MAX)),
                _ => return Err(wrong_arguments(name)),
            };
            let found = text.matches(&**from).take(most).count();
            evaluator.meter().text(text.len() + found.saturating_mul(to.len()))?;
            Value::text(text.replacen(&**from, to, most))
        }
        ("startswith" | "endswith", [Value::Tuple(options)]) => {
            let mut found = false;
            for option in options.iter() {
                found |= text_method(text, name, std::slice::from_ref(option), evaluator)?.is_true();
            }
            Value::Bool(found)
        }
        ("startswith", [Value::Text(part)]) => Value::Bool(text.starts_with(&**part)),
        ("endswith", [Value::Text(part)]) => Value::Bool(text.ends_with(&**part)),
        ("removeprefix", [Value::Text(part)]) => Value::text(text.strip_prefix(&**part).unwrap_or(text)),
        ("removesuffix", [Value::Text(part)]) => Value::text(text.strip_suffix(&**part).unwrap_or(text)),
        ("find" | "rfind" | "index", [Value::Text(part)]) => {
            let at = if name == "rfind" { text.rfind(&**part) } else { text.find(&**part) };
            match at {
                Some(at) => Value::Integer(text[..at].chars().count() as i128),
                None if name == "index" => {
                    return Err(Fault::value(format!("\"{part}\" is not in the text")));
                }
                None => Value::Integer(-1),
            }
        }
        ("count", [Value::Text(part)]) => Value::Integer(text.matches(&**part).count() as i128),
        ("partition" | "rpartition", [Value::Text(separator)]) => {
            let parts = if name == "partition" {
                text.split_once(&**separator).map_or([text, "", ""], |(a, b)| [a, separator, b])
            } else {
                text.rsplit_once(&**separator).map_or(["", "", text], |(a, b)| [a, separator, b])
            };
            Value::tuple(parts.map(Value::text).to_vec())
        }
        ("join", [parts]) => {
            let items = evaluator.items(parts)?;
            let mut words: Vec<Rc<str>> = Vec::with_capacity(items.len());
            let mut bytes = 0usize;
            for item in items {
                let Value::Text(word) = item else {
                    return Err(Fault::value(format!("join() needs texts, not {}", describe(&item)))
                        .help("turn each into text with str(…)"));
                };
                bytes = bytes.saturating_add(word.len() + text.len());
                words.push(word);
            }
            evaluator.meter().text(bytes)?;
            Value::text(words.join(text))
        }
        ("zfill" | "ljust" | "rjust" | "center", [width, rest @ ..]) => {
            let fill = match rest {
                [] => ' ',
                [Value::Text(fill)] if fill.chars().count() == 1 => fill.chars().next().unwrap_or(' '),
                _ => return Err(wrong_arguments(name)),
            };
            let width = width.as_integer().ok_or_else(|| wrong_arguments(name))?;
            let width = usize::try_from(width.max(0)).unwrap_or(usize::MAX);
            evaluator.meter().text(width)?;
            Value::text(justified(text, name, width, fill))
        }
        (_, []) if name.starts_with("is") => Value::Bool(is_all(text, name)),
        _ => return Err(wrong_arguments(name)),
    })
}

fn capitalised(word: &str) -> String {
    let mut characters = word.chars();
    let first = characters.next().map(|c| c.to_uppercase().collect::<String>()).unwrap_or_default();
    first + &characters.as_str().to_lowercase()
}

fn strip(text: &str, name: &str, mut is_cut: impl FnMut(char) -> bool) -> String {
    let mut kept = text;
    if name != "rstrip" {
        kept = kept.trim_start_matches(&mut is_cut);
    }
    if name != "lstrip" {
        let end = kept.char_indices().rev().find(|&(_, c)| !is_cut(c));
        kept = end.map_or("", |(at, c)| &kept[..at + c.len_utf8()]);
    }
    kept.to_owned()
}

fn justified(text: &str, name: &str, width: usize, fill: char) -> String {
    let missing = width.saturating_sub(text.chars().count());
    let run = |count: usize| fill.to_string().repeat(count);
    match name {
        "ljust" => text.to_owned() + &run(missing),
        "rjust" => run(missing) + text,
        "center" => {
            // Python puts the odd one to the left if the width is odd.
            let left = missing / 2 + (missing & width & 1);
            run(left) + text + &run(missing - left)
        }
        _ => {
            let (sign, digits) = match text.strip_prefix(['+', '-']) {
                Some(digits) => (&text[..1], digits),
                None => ("", text),
            };
            format!("{sign}{}{digits}", "0".repeat(missing))
        }
    }
}

fn is_all(text: &str, name: &str) -> bool {
    let all = |test: fn(char) -> bool| !text.is_empty() && text.chars().all(test);
    match name {
        "isalnum" => all(char::is_alphanumeric),
        "isalpha" => all(char::is_alphabetic),
        "isdigit" | "isnumeric" => all(char::is_numeric),
        "isspace" => all(char::is_whitespace),
        "islower" => text.chars().any(char::is_lowercase) && !text.chars().any(char::is_uppercase),
        _ => text.chars().any(char::is_uppercase) && !text.chars().any(char::is_lowercase),
    }
}

fn split(text: &str, arguments: &[Value], from_right: bool, evaluator: &mut Evaluator<'_>) -> Result<Value, Fault> {
    let most = match arguments.get(1) {
        None => usize::MAX,
        Some(count) => {
            let count = count.as_integer().ok_or_else(|| wrong_arguments("split"))?;
            usize::try_from(count).unwrap_or(usize::MAX)
        }
    };
    let pieces = most.saturating_add(1);
    let mut parts: Vec<&str> = match arguments.first() {
        None | Some(Value::None) if from_right => {
            let mut rest = text.trim_end();
            let mut parts = Vec::new();
            while !rest.is_empty() && parts.len() < most {
                let at = rest
                    .rfind(char::is_whitespace)
                    .map_or(0, |at| at + rest[at..].chars().next().map_or(0, char::len_utf8));
                parts.push(&rest[at..]);
                rest = rest[..at].trim_end();
            }
            if !rest.is_empty() {
                parts.push(rest);
            }
            parts
        }
        None | Some(Value::None) => {
            let mut rest = text.trim_start();
            let mut parts = Vec::new();
            while !rest.is_empty() && parts.len() < most {
                let at = rest.find(char::is_whitespace).unwrap_or(rest.len());
                parts.push(&rest[..at]);
                rest = rest[at..].trim_start();
            }
            if !rest.is_empty() {
                parts.push(rest);
            }
            parts
        }
        Some(Value::Text(separator)) if !separator.is_empty() => {
            if from_right {
                text.rsplitn(pieces, &**separator).collect()
            } else {
                text.splitn(pieces, &**separator).collect()
            }
        }
        Some(other) => {
            return Err(Fault::value(format!("split() cannot split at {}", describe(other))));
        }
    };
    if from_right {
        parts.reverse();
    }
    evaluator.meter().step(parts.len())?;
    Ok(Value::list(parts.into_iter().map(Value::text).collect()))
}
