//! Functions that expressions may call, and the namespaces `math`, `python` and `xacro`.

use super::Fault;
use super::evaluate::{Arguments, Evaluator};
use super::math;
use super::number::{parse_float, parse_integer, round_to};
use super::operators::{binary, describe, length};
use super::sequences::{fold, sequence};
use super::syntax::Binary;
use super::value::Value;
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

/// Python functions that the Python tool offers without their namespace; the others are an extension, which a
/// document's own names may hide without a note.
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

pub(super) fn no_names(arguments: &Arguments) -> Result<(), Fault> {
    match arguments.named.first() {
        Some((name, _)) => Err(Fault::value(format!("there is no argument \"{name}\""))),
        None => Ok(()),
    }
}

pub(super) fn count_of(arguments: &Arguments, range: std::ops::RangeInclusive<usize>) -> Result<(), Fault> {
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
