//! Expressions outside a document.

use std::collections::BTreeMap;
use std::rc::Rc;

use super::{Fault, Host, Value, evaluate, global, parse, parse_float, parse_integer};
use crate::error::ErrorKind;
use crate::limits::Meter;
use crate::scope::Scope;

/// Evaluates an expression that sees functions and constants only.
pub(crate) fn constant(text: &str, meter: &mut Meter) -> Result<Value, Fault> {
    with_arguments(text, &BTreeMap::new(), meter)
}

/// Evaluates an expression that sees the document's arguments, as `$(eval …)` does: each as the number or truth value
/// that it looks like.
pub(crate) fn with_arguments(
    text: &str,
    arguments: &BTreeMap<String, String>,
    meter: &mut Meter,
) -> Result<Value, Fault> {
    meter.text(text.len())?;
    evaluate(&parse(text.trim())?, &mut Nowhere { arguments, meter })
}

struct Nowhere<'a> {
    arguments: &'a BTreeMap<String, String>,
    meter: &'a mut Meter,
}

fn typed(text: &str) -> Value {
    if let Some(integer) = parse_integer(text).filter(|_| !text.contains('.')) {
        return Value::Integer(integer);
    }
    match parse_float(text).filter(|_| text.contains('.')) {
        Some(float) => Value::Float(float),
        None if text.eq_ignore_ascii_case("true") => Value::Bool(true),
        None if text.eq_ignore_ascii_case("false") => Value::Bool(false),
        None => Value::text(text),
    }
}

fn out_of_sight(what: &str) -> Fault {
    Fault::new(ErrorKind::UndefinedName, format!("{what} cannot be used here"))
}

impl Host for Nowhere<'_> {
    fn name(&mut self, name: &str) -> Result<Value, Fault> {
        let argument = self.arguments.get(name).map(|text| typed(text));
        global(name)
            .or(argument)
            .ok_or_else(|| Fault::new(ErrorKind::UndefinedName, format!("\"{name}\" is not defined here")))
    }

    fn member(&mut self, _: &Rc<Scope>, _: &str) -> Result<Value, Fault> {
        Err(out_of_sight("a namespace"))
    }

    fn load_yaml(&mut self, _: &str) -> Result<Value, Fault> {
        Err(out_of_sight("load_yaml()"))
    }

    fn argument(&mut self, name: &str) -> Result<Value, Fault> {
        self.arguments.get(name).map(|text| typed(text)).ok_or_else(|| out_of_sight("xacro.arg()"))
    }

    fn absolute_file(&mut self, _: &str) -> Result<Value, Fault> {
        Err(out_of_sight("abs_filename()"))
    }

    fn note(&mut self, _: &str) -> Result<(), Fault> {
        Ok(())
    }

    fn meter(&mut self) -> &mut Meter {
        self.meter
    }
}
