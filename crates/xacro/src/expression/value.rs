//! Values of expressions, and how Python writes them.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::rc::Rc;

use super::Fault;
use super::builtins::{Builtin, Module};
use super::number::float_text;
use super::syntax::Lambda;
use crate::limits::Meter;
use crate::scope::Scope;
use crate::tree::Element;

#[derive(Debug, Clone)]
pub(crate) enum Value {
    None,
    Bool(bool),
    Integer(i128),
    Float(f64),
    Text(Rc<str>),
    List(Rc<Vec<Value>>),
    Tuple(Rc<Vec<Value>>),
    Dict(Rc<Dict>),
    Builtin(Builtin),
    Module(Module),
    /// A method that waits for its arguments.
    Method(Rc<(Value, &'static str)>),
    Lambda(Rc<Closure>),
    /// Properties of a file that was included with `ns`.
    Namespace(Rc<Scope>),
    /// A block parameter, or the content of a property.
    Block(Rc<Element>),
}

/// A lambda with the local names that it was written among.
#[derive(Debug)]
pub(crate) struct Closure {
    pub lambda: Rc<Lambda>,
    pub captured: Vec<(Rc<str>, Value)>,
}

/// A dictionary that keeps the order of insertion.
#[derive(Debug, Default)]
pub(crate) struct Dict {
    entries: Vec<(Value, Value)>,
    places: BTreeMap<Key, usize>,
}

/// A value in its hashed form: `1`, `1.0` and `True` are the same key.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Key {
    None,
    Integer(i128),
    Float(u64),
    Text(Rc<str>),
    Tuple(Vec<Key>),
}

impl Dict {
    pub fn insert(&mut self, key: Value, value: Value) -> Result<(), Fault> {
        let hashed = key.key()?;
        if let Some(&at) = self.places.get(&hashed) {
            self.entries[at].1 = value;
        } else {
            self.places.insert(hashed, self.entries.len());
            self.entries.push((key, value));
        }
        Ok(())
    }

    pub fn get(&self, key: &Value) -> Result<Option<&Value>, Fault> {
        Ok(self.places.get(&key.key()?).map(|&at| &self.entries[at].1))
    }

    pub fn get_text(&self, key: &str) -> Option<&Value> {
        self.places.get(&Key::Text(key.into())).map(|&at| &self.entries[at].1)
    }

    pub fn entries(&self) -> &[(Value, Value)] {
        &self.entries
    }
}

/// The largest power of two below which every integral f64 is an exact i128.
const EXACT: f64 = 1e37;

impl Value {
    pub fn text(text: impl AsRef<str>) -> Self {
        Self::Text(text.as_ref().into())
    }

    pub fn list(items: Vec<Value>) -> Self {
        Self::List(Rc::new(items))
    }

    pub fn tuple(items: Vec<Value>) -> Self {
        Self::Tuple(Rc::new(items))
    }

    /// Python's name of the type.
    pub fn type_name(&self) -> &'static str {
        match self {
            Self::None => "NoneType",
            Self::Bool(_) => "bool",
            Self::Integer(_) => "int",
            Self::Float(_) => "float",
            Self::Text(_) => "str",
            Self::List(_) => "list",
            Self::Tuple(_) => "tuple",
            Self::Dict(_) => "dict",
            Self::Builtin(_) | Self::Method(_) | Self::Lambda(_) => "function",
            Self::Module(_) | Self::Namespace(_) => "namespace",
            Self::Block(_) => "block",
        }
    }

    pub fn is_true(&self) -> bool {
        match self {
            Self::None => false,
            Self::Bool(value) => *value,
            Self::Integer(value) => *value != 0,
            Self::Float(value) => *value != 0.0,
            Self::Text(value) => !value.is_empty(),
            Self::List(items) | Self::Tuple(items) => !items.is_empty(),
            Self::Dict(dict) => !dict.entries.is_empty(),
            _ => true,
        }
    }

    /// An integer, where Python would take the value as one.
    pub fn as_integer(&self) -> Option<i128> {
        match self {
            Self::Bool(value) => Some(i128::from(*value)),
            Self::Integer(value) => Some(*value),
            _ => None,
        }
    }

    /// A number as float.
    pub fn as_float(&self) -> Option<f64> {
        match self {
            Self::Float(value) => Some(*value),
            _ => self.as_integer().map(|value| value as f64),
        }
    }

    fn key(&self) -> Result<Key, Fault> {
        Ok(match self {
            Self::None => Key::None,
            Self::Bool(value) => Key::Integer(i128::from(*value)),
            Self::Integer(value) => Key::Integer(*value),
            #[allow(clippy::cast_possible_truncation, reason = "integral, and bounded by EXACT")]
            Self::Float(value) if value.fract() == 0.0 && value.abs() < EXACT => Key::Integer(*value as i128),
            Self::Float(value) => Key::Float(value.to_bits()),
            Self::Text(value) => Key::Text(Rc::clone(value)),
            Self::Tuple(items) => Key::Tuple(items.iter().map(Self::key).collect::<Result<_, _>>()?),
            other => {
                return Err(Fault::value(format!("a {} cannot be a dictionary key", other.type_name())));
            }
        })
    }

    /// `str(value)`, with the cost charged to `meter`.
    pub fn to_text(&self, meter: &mut Meter) -> Result<Rc<str>, Fault> {
        if let Self::Text(text) = self {
            return Ok(Rc::clone(text));
        }
        let mut out = String::new();
        self.write(&mut out, false, meter)?;
        Ok(out.into())
    }

    /// `repr(value)`.
    pub fn to_repr(&self, meter: &mut Meter) -> Result<String, Fault> {
        let mut out = String::new();
        self.write(&mut out, true, meter)?;
        Ok(out)
    }

    fn write(&self, out: &mut String, quoted: bool, meter: &mut Meter) -> Result<(), Fault> {
        let before = out.len();
        match self {
            Self::None => out.push_str("None"),
            Self::Bool(value) => out.push_str(if *value { "True" } else { "False" }),
            Self::Integer(value) => out.push_str(&value.to_string()),
            Self::Float(value) => out.push_str(&float_text(*value)),
            Self::Text(text) if quoted => write_quoted(out, text),
            Self::Text(text) => out.push_str(text),
            Self::List(items) => write_items(out, "[", items, "]", meter)?,
            Self::Tuple(items) if items.len() == 1 => write_items(out, "(", items, ",)", meter)?,
            Self::Tuple(items) => write_items(out, "(", items, ")", meter)?,
            Self::Dict(dict) => {
                out.push('{');
                for (index, (key, value)) in dict.entries.iter().enumerate() {
                    out.push_str(if index > 0 { ", " } else { "" });
                    key.write(out, true, meter)?;
                    out.push_str(": ");
                    value.write(out, true, meter)?;
                }
                out.push('}');
            }
            other => {
                return Err(Fault::value(format!("a {} has no text to write into the document", other.type_name())));
            }
        }
        if out.len() > meter.limits.bytes {
            meter.text(out.len())?;
        }
        meter.step((out.len() - before) / 16 + 1)?;
        Ok(())
    }
}

fn write_items(out: &mut String, open: &str, items: &[Value], close: &str, meter: &mut Meter) -> Result<(), Fault> {
    out.push_str(open);
    for (index, item) in items.iter().enumerate() {
        out.push_str(if index > 0 { ", " } else { "" });
        item.write(out, true, meter)?;
    }
    out.push_str(close);
    Ok(())
}

/// Single quotes, unless the text has some and no double quotes.
fn write_quoted(out: &mut String, text: &str) {
    let quote = if text.contains('\'') && !text.contains('"') { '"' } else { '\'' };
    out.push(quote);
    for c in text.chars() {
        match c {
            '\\' => out.push_str("\\\\"),
            '\n' => out.push_str("\\n"),
            '\r' => out.push_str("\\r"),
            '\t' => out.push_str("\\t"),
            c if c == quote => out.extend(['\\', c]),
            c if u32::from(c) < 0x20 || u32::from(c) == 0x7f => {
                let _ = write!(out, "\\x{:02x}", u32::from(c));
            }
            c => out.push(c),
        }
    }
    out.push(quote);
}
