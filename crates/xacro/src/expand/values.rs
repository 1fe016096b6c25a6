//! Texts with `${…}` and `$(…)` into values, and the document as expressions see it.

use std::path::{Path, PathBuf};
use std::rc::Rc;

use super::expander::{Expander, Outcome};
use super::folder_of;
use crate::error::{ErrorKind, Frame, XacroError, did_you_mean, near};
use crate::expression::{self, Fault, Host, Value};
use crate::limits::Meter;
use crate::place::Spot;
use crate::scope::{Entry, Scope};
use crate::text::{Segment, segments};
use crate::trace::EvaluatedAt;
use crate::yaml;

/// Values beyond this number are not traced.
const MOST_VALUES: usize = 100_000;

impl Expander<'_> {
    /// The value of a text: typed if it is a single expression, otherwise words.
    pub fn value(&mut self, text: &str, spot: &Spot, scope: &Rc<Scope>) -> Outcome<Value> {
        if !text.contains('$') {
            return Ok(Value::text(text));
        }
        let parts = segments(text).map_err(|range| {
            let message = format!("\"{}\" is not valid", &text[range.clone()]);
            XacroError::new(ErrorKind::Syntax, message)
                .help(
                    "close \"${\" with \"}\" and \"$(\" with \")\"; write \"$$\" for a literal dollar before a bracket",
                )
                .at(&spot.within(text, range))
        })?;
        self.meter.step(parts.len())?;
        let mut values = Vec::with_capacity(parts.len());
        for part in parts {
            values.push(match part {
                Segment::Plain(range) => Value::text(&text[range]),
                Segment::Expression(range) => {
                    let inner = spot.within(text, range.clone());
                    self.expression(&text[range], &inner, scope)?
                }
                Segment::Substitution(range) => {
                    let whole = spot.within(text, range.start - 2..range.end + 1);
                    let inner = spot.within(text, range.clone());
                    let words = self.words(&text[range], &inner, scope)?;
                    let value = self.substitution(&words, &whole)?;
                    if self.options.trace && self.values.len() < MOST_VALUES {
                        self.values.push(EvaluatedAt { spot: inner, value: Rc::clone(&value) });
                    }
                    Value::Text(value)
                }
            });
        }
        if values.len() == 1 {
            return Ok(values.remove(0));
        }
        let mut joined = String::new();
        for value in values {
            let words = value.to_text(&mut self.meter).map_err(|fault| fault.error.at(spot))?;
            joined.push_str(&words);
            self.meter.text(joined.len()).map_err(|error| error.at(spot))?;
        }
        Ok(Value::text(joined))
    }

    /// The value of a text, as text.
    pub fn words(&mut self, text: &str, spot: &Spot, scope: &Rc<Scope>) -> Outcome<Rc<str>> {
        let value = self.value(text, spot, scope)?;
        value.to_text(&mut self.meter).map_err(|fault| fault.error.at(spot))
    }

    /// The value of the inside of `${…}`.
    fn expression(&mut self, inner: &str, spot: &Spot, scope: &Rc<Scope>) -> Outcome<Value> {
        let written = self.words(inner, spot, scope)?;
        let trimmed = written.trim();
        let outcome = self.evaluate(trimmed, spot, scope);
        if self.options.trace
            && self.values.len() < MOST_VALUES
            && let Ok(value) = &outcome
            && let Ok(words) = value.to_text(&mut self.meter)
        {
            self.values.push(EvaluatedAt { spot: spot.clone(), value: words });
        }
        outcome.map_err(|fault| {
            if fault.error.place.is_some() {
                return fault.error;
            }
            if *written != *inner {
                let mut error = fault.error.at(spot);
                error.expression = Some(trimmed.to_owned());
                return error;
            }
            let offset = written.len() - written.trim_start().len();
            let span = fault.span.unwrap_or(0..trimmed.len());
            fault.error.at(&spot.within(inner, span.start + offset..span.end + offset))
        })
    }

    /// Evaluates an expression; the failure knows its span in `text`.
    pub fn evaluate(&mut self, text: &str, spot: &Spot, scope: &Rc<Scope>) -> Result<Value, Fault> {
        let expression = if let Some(expression) = self.parsed.get(text) {
            Rc::clone(expression)
        } else {
            self.meter.text(text.len())?;
            self.meter.step(text.len())?;
            let expression = Rc::new(expression::parse(text)?);
            self.parsed.insert(text.into(), Rc::clone(&expression));
            expression
        };
        let mut host = DocumentHost { expander: self, scope, spot };
        expression::evaluate(&expression, &mut host)
    }

    /// The value of a name, which may be a property that nobody has used yet.
    pub fn name(&mut self, name: &str, spot: &Spot, scope: &Rc<Scope>) -> Outcome<Option<Value>> {
        let Some((owner, entry)) = scope.find(name) else {
            return Ok(None);
        };
        let (text, defined) = match entry {
            Entry::Ready(value) => return Ok(Some(value)),
            Entry::Lazy { text, spot } => (text, spot),
            Entry::Evaluating => {
                let mut chain: Vec<&str> = self.evaluating.iter().map(|name| &**name).collect();
                chain.push(name);
                let first = chain.iter().position(|known| *known == name).unwrap_or(0);
                return Err(XacroError::new(
                    ErrorKind::Evaluation,
                    format!("property \"{name}\" is defined in terms of itself: {}", chain[first..].join(" → ")),
                )
                .help("write lazy_eval=\"false\" on the property to use the value that it had before"));
            }
        };
        let name: Rc<str> = name.into();
        owner.set(Rc::clone(&name), Entry::Evaluating);
        self.evaluating.push(Rc::clone(&name));
        self.meter.enter()?;
        let value = self
            .value(&text, &defined, &owner)
            .map_err(|error| error.within(Frame::Property { name: name.to_string(), used: spot.place() }))?;
        self.meter.leave();
        self.evaluating.pop();
        let value = literal(value);
        owner.set(name, Entry::Ready(value.clone()));
        Ok(Some(value))
    }

    /// Relative file names begin in the folder of the file that is being processed.
    pub fn absolute(&self, file: &str) -> PathBuf {
        let folder = self.files.last().map_or(Path::new(""), |file| folder_of(file));
        folder.join(file)
    }

    fn yaml(&mut self, name: &str, spot: &Spot) -> Result<Value, Fault> {
        let path = self.absolute(name);
        let file = self.read(&path)?;
        // Units may be expressions of numbers and functions; the document's names are out of sight.
        let value = yaml::load(&file, &mut self.meter, &expression::constant);
        value.map_err(|error| Fault::from(error.within(Frame::Include { file: path, at: spot.place() })))
    }
}

/// What the text of a property means: a number, a truth value, a text in quotes, or itself.
pub(super) fn literal(value: Value) -> Value {
    let Value::Text(text) = &value else { return value };
    if text.len() >= 2 && text.starts_with('\'') && text.ends_with('\'') {
        return Value::text(&text[1..text.len() - 1]);
    }
    if text.contains('_') {
        return value;
    }
    if let Some(integer) = expression::parse_integer(text) {
        return Value::Integer(integer);
    }
    if let Some(float) = expression::parse_float(text) {
        return Value::Float(float);
    }
    match &**text {
        "true" | "True" => Value::Bool(true),
        "false" | "False" => Value::Bool(false),
        _ => value,
    }
}

/// What an expression sees.
struct DocumentHost<'e, 'a, 's> {
    expander: &'e mut Expander<'a>,
    scope: &'s Rc<Scope>,
    spot: &'s Spot,
}

impl Host for DocumentHost<'_, '_, '_> {
    fn name(&mut self, name: &str) -> Result<Value, Fault> {
        if let Some(value) = self.expander.name(name, self.spot, self.scope)? {
            return Ok(value);
        }
        if let Some(value) = expression::global(name) {
            return Ok(value);
        }
        let known = self.scope.names();
        let properties = known.iter().filter(|name| !name.starts_with('*')).map(ToString::to_string);
        let alike = near(name, properties.chain(expression::names().map(str::to_owned)));
        let fault = Fault::new(ErrorKind::UndefinedName, format!("\"{name}\" is not defined"));
        Err(match did_you_mean(&alike) {
            Some(question) => fault.help(question),
            None if self.expander.arguments.contains_key(name) => {
                fault.help(format!("the argument of that name is $(arg {name})"))
            }
            None => fault,
        })
    }

    fn member(&mut self, namespace: &Rc<Scope>, name: &str) -> Result<Value, Fault> {
        if let Some(value) = self.expander.name(name, self.spot, namespace)? {
            return Ok(value);
        }
        let known = namespace.names();
        let alike = near(name, known.iter().map(|name| &**name));
        let fault = Fault::new(ErrorKind::UndefinedName, format!("the namespace has no property \"{name}\""));
        Err(match did_you_mean(&alike) {
            Some(question) => fault.help(question),
            None => fault,
        })
    }

    fn load_yaml(&mut self, file: &str) -> Result<Value, Fault> {
        self.expander.yaml(file, self.spot)
    }

    fn argument(&mut self, name: &str) -> Result<Value, Fault> {
        Ok(self.expander.argument(name).map(Value::text)?)
    }

    fn absolute_file(&mut self, file: &str) -> Result<Value, Fault> {
        Ok(Value::text(self.expander.absolute(file).to_string_lossy()))
    }

    fn note(&mut self, text: &str) -> Result<(), Fault> {
        self.expander.meter.text(text.len())?;
        self.expander.note(self.spot, text);
        Ok(())
    }

    fn meter(&mut self) -> &mut Meter {
        &mut self.expander.meter
    }
}
