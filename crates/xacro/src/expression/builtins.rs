//! Functions that expressions may call, and the namespaces `math`, `python` and `xacro`.

use std::rc::Rc;

use super::Fault;
use super::evaluate::{Arguments, Evaluator};
use super::math;
use super::number::{parse_float, parse_integer, round_to};
use super::operators::{binary, describe, equal, length, order};
use super::syntax::Binary;
use super::value::{Dict, Value};
use crate::error::ErrorKind;

/// A function, by its name in one of the lists below.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Builtin {
    module: Module,
    name: &'static str,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Module {
    Math,
    Python,
    Xacro,
}

impl Builtin {
    pub fn name(self) -> &'static str {
        self.name
    }
}

impl Module {
    pub fn name(self) -> &'static str {
        match self {
            Self::Math => "math",
            Self::Python => "python",
            Self::Xacro => "xacro",
        }
    }
}

const PYTHON: &[&str] = &[
    "abs",
    "all",
    "any",
    "bool",
    "dict",
    "divmod",
    "enumerate",
    "filter",
    "float",
    "int",
    "len",
    "list",
    "map",
    "max",
    "min",
    "range",
    "repr",
    "reversed",
    "round",
    "sorted",
    "str",
    "sum",
    "tuple",
    "zip",
];

/// Python functions that the Python tool offers without their namespace; the others are a courtesy of ours, which a
/// document's own names may hide without a word.
const PYTHON_GLOBAL: &[&str] =
    &["bool", "dict", "float", "int", "len", "list", "map", "max", "min", "range", "round", "sorted", "str"];

const XACRO: &[&str] = &[
    "abs_filename",
    "arg",
    "dotify",
    "error",
    "fatal",
    "load_yaml",
    "message",
    "print_location",
    "tokenize",
    "warning",
];

const XACRO_GLOBAL: &[&str] = &["abs_filename", "dotify", "load_yaml"];

/// What a name means everywhere, unless the document gives it another meaning.
pub(crate) fn global(name: &str) -> Option<Value> {
    match name {
        "math" => Some(Value::Module(Module::Math)),
        "python" => Some(Value::Module(Module::Python)),
        "xacro" => Some(Value::Module(Module::Xacro)),
        "true" => Some(Value::Bool(true)),
        "false" => Some(Value::Bool(false)),
        _ => member(Module::Math, name)
            .or_else(|| member(Module::Python, name))
            .or_else(|| XACRO_GLOBAL.contains(&name).then(|| member(Module::Xacro, name)).flatten()),
    }
}

/// Whether the Python tool has a global symbol of this name, which a property then hides.
pub(crate) fn is_global(name: &str) -> bool {
    matches!(name, "math" | "python" | "xacro")
        || PYTHON_GLOBAL.contains(&name)
        || XACRO_GLOBAL.contains(&name)
        || member(Module::Math, name).is_some()
}

/// Names that could be meant by a mistyped one.
pub(crate) fn names() -> impl Iterator<Item = &'static str> {
    let math = math::FUNCTIONS.iter().chain(math::CONSTANTS.iter().map(|(name, _)| name));
    math.chain(PYTHON).chain(XACRO_GLOBAL).copied()
}

/// `module.name`
pub(super) fn member(module: Module, name: &str) -> Option<Value> {
    let list = match module {
        Module::Math => {
            if let Some((_, value)) = math::CONSTANTS.iter().find(|(constant, _)| *constant == name) {
                return Some(Value::Float(*value));
            }
            math::FUNCTIONS
        }
        Module::Python => PYTHON,
        Module::Xacro => XACRO,
    };
    let name = list.iter().find(|known| **known == name)?;
    Some(Value::Builtin(Builtin { module, name }))
}

pub(super) fn call(builtin: Builtin, arguments: Arguments, evaluator: &mut Evaluator<'_>) -> Result<Value, Fault> {
    evaluator.meter().step(1)?;
    match builtin.module {
        Module::Math => {
            no_names(&arguments)?;
            math::call(builtin.name, &arguments.plain)
        }
        Module::Xacro => xacro(builtin.name, &arguments, evaluator),
        Module::Python => match builtin.name {
            "bool" | "float" | "int" | "str" | "repr" | "len" | "abs" | "round" | "divmod" => {
                scalar(builtin.name, &arguments, evaluator)
            }
            "all" | "any" | "sum" | "min" | "max" => fold(builtin.name, arguments, evaluator),
            _ => sequence(builtin.name, arguments, evaluator),
        },
    }
}

fn no_names(arguments: &Arguments) -> Result<(), Fault> {
    match arguments.named.first() {
        Some((name, _)) => Err(Fault::value(format!("there is no argument \"{name}\""))),
        None => Ok(()),
    }
}

fn count_of(arguments: &Arguments, range: std::ops::RangeInclusive<usize>) -> Result<(), Fault> {
    no_names(arguments)?;
    let given = arguments.plain.len();
    if range.contains(&given) {
        return Ok(());
    }
    let (least, most) = range.into_inner();
    let s = if most == 1 { "" } else { "s" };
    let expected = if least == most { most.to_string() } else { format!("{least} to {most}") };
    Err(Fault::value(format!("{expected} argument{s} expected, {given} given")))
}

fn scalar(name: &str, arguments: &Arguments, evaluator: &mut Evaluator<'_>) -> Result<Value, Fault> {
    let most = if matches!(name, "round" | "divmod" | "int") { 2 } else { 1 };
    let least = match name {
        "bool" | "float" | "int" | "str" => 0,
        "divmod" => 2,
        _ => 1,
    };
    count_of(arguments, least..=most)?;
    let Some(value) = arguments.plain.first() else {
        return Ok(match name {
            "bool" => Value::Bool(false),
            "float" => Value::Float(0.0),
            "int" => Value::Integer(0),
            _ => Value::text(""),
        });
    };
    let second = arguments.plain.get(1);
    match name {
        "bool" => Ok(Value::Bool(value.is_true())),
        "float" => match value {
            Value::Text(text) => parse_float(text).map(Value::Float).ok_or_else(|| not_a_number(value)),
            _ => value.as_float().map(Value::Float).ok_or_else(|| not_a_number(value)),
        },
        "int" => integer(value, second),
        "str" => value.to_text(evaluator.meter()).map(Value::Text),
        "repr" => value.to_repr(evaluator.meter()).map(Value::text),
        "len" => match length(value) {
            Some(length) => Ok(Value::Integer(length as i128)),
            None => Err(Fault::value(format!("{} has no length", describe(value)))),
        },
        "abs" => match (value.as_integer(), value) {
            (Some(integer), _) => integer.checked_abs().map(Value::Integer).ok_or_else(|| Fault::value("too large")),
            (None, Value::Float(float)) => Ok(Value::Float(float.abs())),
            _ => Err(not_a_number(value)),
        },
        "divmod" => {
            let other = second.unwrap_or(value);
            let quotient = binary(Binary::FloorDivide, value, other, evaluator.meter())?;
            Ok(Value::tuple(vec![quotient, binary(Binary::Modulo, value, other, evaluator.meter())?]))
        }
        _ => round(value, second),
    }
}

fn not_a_number(value: &Value) -> Fault {
    Fault::value(format!("{} is not a number", describe(value)))
}

fn integer(value: &Value, base: Option<&Value>) -> Result<Value, Fault> {
    match (value, base) {
        (Value::Text(text), None) => parse_integer(text).map(Value::Integer).ok_or_else(|| {
            let fault = Fault::value(format!("{} is not an integer", describe(value)));
            if parse_float(text).is_some() { fault.help("write int(float(…))") } else { fault }
        }),
        (Value::Text(text), Some(base)) => {
            let base = base.as_integer().and_then(|base| u32::try_from(base).ok());
            let base =
                base.filter(|base| (2..=36).contains(base)).ok_or_else(|| Fault::value("the base must be 2 to 36"))?;
            let digits = text.trim().to_ascii_lowercase();
            let digits = match base {
                16 => digits.trim_start_matches("0x"),
                8 => digits.trim_start_matches("0o"),
                2 => digits.trim_start_matches("0b"),
                _ => &digits,
            };
            i128::from_str_radix(digits, base)
                .map(Value::Integer)
                .map_err(|_| Fault::value(format!("{} is not an integer of base {base}", describe(value))))
        }
        (Value::Float(float), None) => math::rounded(float.trunc()),
        _ => value.as_integer().filter(|_| base.is_none()).map(Value::Integer).ok_or_else(|| not_a_number(value)),
    }
}

fn round(value: &Value, digits: Option<&Value>) -> Result<Value, Fault> {
    let digits = match digits {
        None | Some(Value::None) => None,
        Some(digits) => Some(digits.as_integer().ok_or_else(|| not_a_number(digits))?),
    };
    let places = digits.map(|digits| i32::try_from(digits.clamp(-400, 400)).unwrap_or(0));
    match (value.as_integer(), value, places) {
        (Some(integer), _, None | Some(0..)) => Ok(Value::Integer(integer)),
        (Some(integer), _, Some(places)) => math::rounded(round_to(integer as f64, places)),
        (None, Value::Float(float), None) => math::rounded(float.round_ties_even()),
        (None, Value::Float(float), Some(places)) => Ok(Value::Float(round_to(*float, places))),
        _ => Err(not_a_number(value)),
    }
}

fn fold(name: &str, mut arguments: Arguments, evaluator: &mut Evaluator<'_>) -> Result<Value, Fault> {
    let key = take_named(&mut arguments, "key");
    let default = take_named(&mut arguments, "default");
    no_names(&arguments)?;
    let extremum = matches!(name, "min" | "max");
    let items = match &arguments.plain[..] {
        [] => return Err(Fault::value("1 argument expected, 0 given")),
        [only] => evaluator.items(only)?,
        [sequence, _] if name == "sum" => evaluator.items(sequence)?,
        several if extremum => several.to_vec(),
        several => return Err(Fault::value(format!("1 argument expected, {} given", several.len()))),
    };
    match name {
        "all" => Ok(Value::Bool(items.iter().all(Value::is_true))),
        "any" => Ok(Value::Bool(items.iter().any(Value::is_true))),
        "sum" => {
            let mut sum = arguments.plain.get(1).cloned().unwrap_or(Value::Integer(0));
            for item in &items {
                sum = binary(Binary::Add, &sum, item, evaluator.meter())?;
            }
            Ok(sum)
        }
        _ => {
            let keys = keys(&items, key.as_ref(), evaluator)?;
            let mut best: Option<usize> = None;
            for at in 0..items.len() {
                let better = match best {
                    None => true,
                    Some(best) => {
                        let ordering = ordered(&keys[at], &keys[best], evaluator)?;
                        if name == "min" { ordering.is_lt() } else { ordering.is_gt() }
                    }
                };
                if better {
                    best = Some(at);
                }
            }
            best.map(|at| items[at].clone())
                .or(default)
                .ok_or_else(|| Fault::value("there are no items to choose from"))
        }
    }
}

fn take_named(arguments: &mut Arguments, name: &str) -> Option<Value> {
    let at = arguments.named.iter().position(|(named, _)| &**named == name)?;
    Some(arguments.named.remove(at).1)
}

fn keys(items: &[Value], key: Option<&Value>, evaluator: &mut Evaluator<'_>) -> Result<Vec<Value>, Fault> {
    match key {
        None | Some(Value::None) => Ok(items.to_vec()),
        Some(key) => items
            .iter()
            .map(|item| evaluator.call(key, Arguments { plain: vec![item.clone()], named: Vec::new() }))
            .collect(),
    }
}

fn ordered(a: &Value, b: &Value, evaluator: &mut Evaluator<'_>) -> Result<std::cmp::Ordering, Fault> {
    let numbers = a.as_float().is_some() && b.as_float().is_some();
    match order(a, b, evaluator.meter())? {
        Some(ordering) => Ok(ordering),
        // NaN, which Python leaves where it is.
        None if numbers => Ok(std::cmp::Ordering::Equal),
        None => Err(Fault::value(format!("{} and {} have no order", describe(a), describe(b)))),
    }
}

fn sequence(name: &str, mut arguments: Arguments, evaluator: &mut Evaluator<'_>) -> Result<Value, Fault> {
    match name {
        "dict" => return dictionary(&arguments, evaluator),
        "range" => return range(&arguments, evaluator),
        "sorted" => {
            let key = take_named(&mut arguments, "key");
            let reverse = take_named(&mut arguments, "reverse").is_some_and(|value| value.is_true());
            count_of(&arguments, 1..=1)?;
            let items = evaluator.items(&arguments.plain[0])?;
            return sorted(items, key.as_ref(), reverse, evaluator);
        }
        "enumerate" => {
            let start = take_named(&mut arguments, "start").or_else(|| arguments.plain.get(1).cloned());
            let start = start.and_then(|start| start.as_integer()).unwrap_or(0);
            let Some(values) = arguments.plain.first() else {
                return Err(Fault::value("1 argument expected, 0 given"));
            };
            let items = evaluator.items(values)?;
            let numbered = items
                .into_iter()
                .zip(0i128..)
                .map(|(item, at)| Value::tuple(vec![Value::Integer(start.saturating_add(at)), item]));
            return Ok(Value::list(numbered.collect()));
        }
        _ => {}
    }
    no_names(&arguments)?;
    match name {
        "list" | "tuple" | "reversed" => {
            count_of(&arguments, usize::from(name == "reversed")..=1)?;
            let mut items = match arguments.plain.first() {
                Some(value) => evaluator.items(value)?,
                None => Vec::new(),
            };
            if name == "reversed" {
                items.reverse();
            }
            Ok(if name == "tuple" { Value::tuple(items) } else { Value::list(items) })
        }
        "map" | "filter" => {
            let Some((function, sequences)) = arguments.plain.split_first() else {
                return Err(Fault::value("2 arguments expected, 0 given"));
            };
            let rows = rows(sequences, evaluator)?;
            let mut items = Vec::new();
            for row in rows {
                let kept = row.first().cloned().unwrap_or(Value::None);
                let result = match function {
                    Value::None => kept.clone(),
                    _ => evaluator.call(function, Arguments { plain: row, named: Vec::new() })?,
                };
                if name == "map" {
                    items.push(result);
                } else if result.is_true() {
                    items.push(kept);
                }
            }
            Ok(Value::list(items))
        }
        _ => Ok(Value::list(rows(&arguments.plain, evaluator)?.into_iter().map(Value::tuple).collect())),
    }
}

/// First items, second items, … up to the shortest sequence.
fn rows(sequences: &[Value], evaluator: &mut Evaluator<'_>) -> Result<Vec<Vec<Value>>, Fault> {
    let columns = sequences.iter().map(|values| evaluator.items(values)).collect::<Result<Vec<_>, _>>()?;
    let shortest = columns.iter().map(Vec::len).min().unwrap_or(0);
    Ok((0..shortest).map(|at| columns.iter().map(|column| column[at].clone()).collect()).collect())
}

fn sorted(
    items: Vec<Value>,
    key: Option<&Value>,
    reverse: bool,
    evaluator: &mut Evaluator<'_>,
) -> Result<Value, Fault> {
    let keys = keys(&items, key, evaluator)?;
    let mut keyed: Vec<(Value, Value)> = keys.into_iter().zip(items).collect();
    let mut failure = None;
    let mut compare = |a: &Value, b: &Value| match ordered(a, b, evaluator) {
        Ok(ordering) => ordering,
        Err(fault) => {
            failure.get_or_insert(fault);
            std::cmp::Ordering::Equal
        }
    };
    if reverse {
        keyed.reverse();
    }
    // NaN breaks the total order that `sort_by` asks for; a merge sort of our own would not mind, `sort_by` may panic.
    if keyed.iter().any(|(key, _)| key.as_float().is_some_and(f64::is_nan)) {
        return Err(Fault::value("nan has no order"));
    }
    keyed.sort_by(|a, b| compare(&a.0, &b.0));
    if let Some(fault) = failure {
        return Err(fault);
    }
    let mut items: Vec<Value> = keyed.into_iter().map(|(_, item)| item).collect();
    if reverse {
        items.reverse();
    }
    Ok(Value::list(items))
}

fn dictionary(arguments: &Arguments, evaluator: &mut Evaluator<'_>) -> Result<Value, Fault> {
    let mut dict = Dict::default();
    match &arguments.plain[..] {
        [] => {}
        [Value::Dict(other)] => {
            evaluator.meter().step(other.entries().len())?;
            for (key, value) in other.entries() {
                dict.insert(key.clone(), value.clone())?;
            }
        }
        [pairs] => {
            for pair in evaluator.items(pairs)? {
                let [key, value]: [Value; 2] = evaluator
                    .items(&pair)?
                    .try_into()
                    .map_err(|_| Fault::value("pairs of key and value are expected"))?;
                dict.insert(key, value)?;
            }
        }
        _ => return Err(Fault::value("1 argument expected")),
    }
    for (name, value) in &arguments.named {
        dict.insert(Value::Text(Rc::clone(name)), value.clone())?;
    }
    Ok(Value::Dict(Rc::new(dict)))
}

fn range(arguments: &Arguments, evaluator: &mut Evaluator<'_>) -> Result<Value, Fault> {
    count_of(arguments, 1..=3)?;
    let bounds = arguments
        .plain
        .iter()
        .map(|value| {
            value.as_integer().ok_or_else(|| Fault::value(format!("an integer is expected, not {}", describe(value))))
        })
        .collect::<Result<Vec<_>, _>>()?;
    let (start, stop, step) = match bounds[..] {
        [stop] => (0, stop, 1),
        [start, stop] => (start, stop, 1),
        _ => (bounds[0], bounds[1], bounds[2]),
    };
    if step == 0 {
        return Err(Fault::value("the step is 0"));
    }
    let span = if step > 0 { stop.saturating_sub(start) } else { start.saturating_sub(stop) };
    let width = step.unsigned_abs();
    let count = u128::try_from(span).unwrap_or(0).div_ceil(width);
    let count = usize::try_from(count).unwrap_or(usize::MAX);
    evaluator.meter().step(count.saturating_mul(2))?;
    let mut values = Vec::with_capacity(count);
    let mut at = start;
    for _ in 0..count {
        values.push(Value::Integer(at));
        at = at.saturating_add(step);
    }
    Ok(Value::list(values))
}

fn xacro(name: &str, arguments: &Arguments, evaluator: &mut Evaluator<'_>) -> Result<Value, Fault> {
    match name {
        "warning" | "error" | "message" | "print_location" | "fatal" => {
            let mut words = Vec::new();
            for value in &arguments.plain {
                words.push(value.to_text(evaluator.meter())?);
            }
            let text = words.join(" ");
            if name == "fatal" {
                return Err(Fault::new(ErrorKind::Fatal, text));
            }
            if name != "print_location" {
                evaluator.host.note(&text)?;
            }
            Ok(Value::text(""))
        }
        "tokenize" => tokenize(arguments, evaluator),
        "dotify" => {
            count_of(arguments, 1..=1)?;
            match &arguments.plain[0] {
                dict @ Value::Dict(_) => Ok(dict.clone()),
                other => Err(Fault::value(format!("a dictionary is expected, not {}", describe(other)))),
            }
        }
        _ => {
            count_of(arguments, 1..=1)?;
            let text = arguments.plain[0].to_text(evaluator.meter())?;
            match name {
                "load_yaml" => evaluator.host.load_yaml(&text),
                "arg" => evaluator.host.argument(&text),
                _ => evaluator.host.absolute_file(&text),
            }
        }
    }
}

/// Splits at any of the characters of the second argument.
fn tokenize(arguments: &Arguments, evaluator: &mut Evaluator<'_>) -> Result<Value, Fault> {
    let option = |at: usize, name: &str| {
        let named = arguments.named.iter().find(|(named, _)| &**named == name);
        arguments.plain.get(at).or(named.map(|(_, value)| value))
    };
    let Some(Value::Text(text)) = option(0, "s") else {
        return Err(Fault::value("a text is expected"));
    };
    let separators = match option(1, "sep") {
        None => ",; ",
        Some(Value::Text(separators)) => separators,
        Some(other) => return Err(Fault::value(format!("a text is expected, not {}", describe(other)))),
    };
    let skip_empty = option(2, "skip_empty").is_none_or(Value::is_true);
    evaluator.meter().text(text.len())?;
    evaluator.meter().step(text.len())?;
    let parts = text.split(|c| separators.contains(c)).filter(|part| !skip_empty || !part.is_empty()).map(Value::text);
    Ok(Value::list(parts.collect()))
}

/// Whether a value is among others.
pub(super) fn position(items: &[Value], wanted: &Value, evaluator: &mut Evaluator<'_>) -> Result<Option<usize>, Fault> {
    for (at, item) in items.iter().enumerate() {
        if equal(item, wanted, evaluator.meter())? {
            return Ok(Some(at));
        }
    }
    Ok(None)
}
