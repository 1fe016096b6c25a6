//! The value of a syntax tree.

use std::rc::Rc;

use super::Fault;
use super::builtins::{self, Builtin};
use super::methods;
use super::operators::{binary, compare, describe, dotted, index, length, slice, unary};
use super::syntax::{CallArgument, Clause, Expression, Kind};
use super::value::{Closure, Dict, Value};
use crate::error::ErrorKind;
use crate::limits::Meter;
use crate::scope::Scope;

/// The document as an expression sees it.
pub(crate) trait Host {
    /// The value of a name that is not local to the expression.
    fn name(&mut self, name: &str) -> Result<Value, Fault>;
    /// `namespace.name`
    fn member(&mut self, namespace: &Rc<Scope>, name: &str) -> Result<Value, Fault>;
    /// `xacro.load_yaml(file)`
    fn load_yaml(&mut self, file: &str) -> Result<Value, Fault>;
    /// `xacro.arg(name)`
    fn argument(&mut self, name: &str) -> Result<Value, Fault>;
    /// `xacro.abs_filename(file)`
    fn absolute_file(&mut self, file: &str) -> Result<Value, Fault>;
    /// `xacro.warning(text)` and the like: a note for the user.
    fn note(&mut self, text: &str) -> Result<(), Fault>;
    fn meter(&mut self) -> &mut Meter;
}

/// Arguments of a call.
#[derive(Debug, Default)]
pub(super) struct Arguments {
    pub plain: Vec<Value>,
    pub named: Vec<(Rc<str>, Value)>,
}

/// Evaluates an expression.
pub(crate) fn evaluate(expression: &Expression, host: &mut dyn Host) -> Result<Value, Fault> {
    Evaluator { host, locals: Vec::new() }.value(expression)
}

pub(super) struct Evaluator<'a> {
    pub host: &'a mut dyn Host,
    locals: Vec<(Rc<str>, Value)>,
}

impl Evaluator<'_> {
    pub fn meter(&mut self) -> &mut Meter {
        self.host.meter()
    }

    fn value(&mut self, expression: &Expression) -> Result<Value, Fault> {
        self.meter().descend()?;
        let value = self.kind(&expression.kind).map_err(|fault| fault.at(&expression.span));
        self.meter().ascend();
        value
    }

    fn values(&mut self, expressions: &[Expression]) -> Result<Vec<Value>, Fault> {
        expressions.iter().map(|expression| self.value(expression)).collect()
    }

    fn kind(&mut self, kind: &Kind) -> Result<Value, Fault> {
        match kind {
            Kind::Constant(value) => Ok(value.clone()),
            Kind::Name(name) => match self.locals.iter().rev().find(|(local, _)| local == name) {
                Some((_, value)) => Ok(value.clone()),
                None => self.host.name(name),
            },
            Kind::List(items) => self.values(items).map(Value::list),
            Kind::Tuple(items) => self.values(items).map(Value::tuple),
            Kind::Dict(entries) => {
                let mut dict = Dict::default();
                for (key, value) in entries {
                    let key = self.value(key)?;
                    dict.insert(key, self.value(value)?)?;
                }
                Ok(Value::Dict(Rc::new(dict)))
            }
            Kind::Unary(operator, operand) => unary(*operator, &self.value(operand)?),
            Kind::Binary(operator, left, right) => {
                let left = self.value(left)?;
                let right = self.value(right)?;
                binary(*operator, &left, &right, self.meter())
            }
            Kind::Compare(first, rest) => {
                let mut left = self.value(first)?;
                for (comparison, right) in rest {
                    let right = self.value(right)?;
                    if !compare(*comparison, &left, &right, self.meter())? {
                        return Ok(Value::Bool(false));
                    }
                    left = right;
                }
                Ok(Value::Bool(true))
            }
            Kind::And(operands) => self.first_that_is(false, operands),
            Kind::Or(operands) => self.first_that_is(true, operands),
            Kind::Conditional { condition, then, otherwise } => {
                let chosen = if self.value(condition)?.is_true() { then } else { otherwise };
                self.value(chosen)
            }
            Kind::Attribute(object, name) => {
                let object = self.value(object)?;
                self.attribute(&object, name)
            }
            Kind::Index(container, at) => {
                let container = self.value(container)?;
                let at = self.value(at)?;
                index(&container, &at, self.meter())
            }
            Kind::Slice(container, parts) => {
                let container = self.value(container)?;
                let mut bounds = [None, None, None];
                for (bound, part) in bounds.iter_mut().zip(parts) {
                    *bound = part.as_ref().map(|part| self.value(part)).transpose()?;
                }
                slice(&container, &bounds, self.meter())
            }
            Kind::Call { function, arguments } => {
                let function = self.value(function)?;
                let arguments = self.arguments(arguments)?;
                self.call(&function, arguments)
            }
            Kind::Comprehension { element, clauses } => {
                let mut items = Vec::new();
                let locals = self.locals.len();
                let result = self.comprehension(element, clauses, &mut items);
                self.locals.truncate(locals);
                result.map(|()| Value::list(items))
            }
            Kind::Lambda(lambda) => {
                let closure = Closure { lambda: Rc::clone(lambda), captured: self.locals.clone() };
                Ok(Value::Lambda(Rc::new(closure)))
            }
        }
    }

    fn first_that_is(&mut self, wanted: bool, operands: &[Expression]) -> Result<Value, Fault> {
        let mut last = Value::None;
        for operand in operands {
            last = self.value(operand)?;
            if last.is_true() == wanted {
                break;
            }
        }
        Ok(last)
    }

    fn attribute(&mut self, object: &Value, name: &str) -> Result<Value, Fault> {
        match object {
            Value::Module(module) => builtins::member(*module, name).ok_or_else(|| {
                Fault::new(ErrorKind::UndefinedName, format!("\"{}\" has no \"{name}\"", module.name()))
            }),
            Value::Namespace(scope) => self.host.member(scope, name),
            _ => {
                if let Some(method) = methods::known(object, name) {
                    return Ok(Value::Method(Rc::new((object.clone(), method))));
                }
                if let Value::Dict(dict) = object {
                    return dict.get_text(name).cloned().ok_or_else(|| dotted(dict.entries(), name));
                }
                Err(Fault::new(ErrorKind::UndefinedName, format!("{} has no method \"{name}\"", describe(object))))
            }
        }
    }

    fn arguments(&mut self, written: &[CallArgument]) -> Result<Arguments, Fault> {
        let mut arguments = Arguments::default();
        for argument in written {
            match argument {
                CallArgument::Plain(value) => arguments.plain.push(self.value(value)?),
                CallArgument::Named(name, value) => {
                    let value = self.value(value)?;
                    arguments.named.push((Rc::clone(name), value));
                }
                CallArgument::Spread(value) => {
                    let value = self.value(value)?;
                    arguments.plain.extend(self.items(&value)?);
                }
            }
        }
        Ok(arguments)
    }

    pub fn call(&mut self, function: &Value, arguments: Arguments) -> Result<Value, Fault> {
        match function {
            Value::Builtin(builtin) => self.builtin(*builtin, arguments),
            Value::Method(method) => methods::call(&method.0, method.1, arguments, self),
            Value::Lambda(closure) => self.lambda(closure, arguments),
            other => Err(Fault::value(format!("{} cannot be called", describe(other)))),
        }
    }

    fn builtin(&mut self, builtin: Builtin, arguments: Arguments) -> Result<Value, Fault> {
        builtins::call(builtin, arguments, self).map_err(|mut fault| {
            let known = fault.error.message.contains(builtin.name());
            if fault.span.is_none() && fault.error.kind == ErrorKind::Evaluation && !known {
                fault.error.message = format!("{}(): {}", builtin.name(), fault.error.message);
            }
            fault
        })
    }

    fn lambda(&mut self, closure: &Closure, arguments: Arguments) -> Result<Value, Fault> {
        let Closure { lambda, captured } = closure;
        if arguments.plain.len() != lambda.parameters.len() || !arguments.named.is_empty() {
            return Err(Fault::value(format!(
                "the lambda takes {} arguments, {} are given",
                lambda.parameters.len(),
                arguments.plain.len() + arguments.named.len()
            )));
        }
        let parameters = lambda.parameters.iter().cloned().zip(arguments.plain);
        let inner = captured.iter().cloned().chain(parameters).collect();
        let outer = std::mem::replace(&mut self.locals, inner);
        // The span belongs to the text that the lambda was written in, which may be another one.
        let value = self.value(&lambda.body).map_err(|fault| Fault { span: None, ..fault });
        self.locals = outer;
        value
    }

    fn comprehension(&mut self, element: &Expression, clauses: &[Clause], items: &mut Vec<Value>) -> Result<(), Fault> {
        let Some((clause, inner)) = clauses.split_first() else {
            items.push(self.value(element)?);
            return Ok(());
        };
        let iterable = self.value(&clause.iterable)?;
        for item in self.items(&iterable)? {
            self.meter().step(1)?;
            let locals = self.locals.len();
            self.bind(&clause.targets, item)?;
            let mut wanted = true;
            for condition in &clause.conditions {
                wanted = wanted && self.value(condition)?.is_true();
            }
            if wanted {
                self.comprehension(element, inner, items)?;
            }
            self.locals.truncate(locals);
        }
        Ok(())
    }

    fn bind(&mut self, targets: &[Rc<str>], item: Value) -> Result<(), Fault> {
        if let [target] = targets {
            self.locals.push((Rc::clone(target), item));
            return Ok(());
        }
        let count = length(&item);
        if count != Some(targets.len()) {
            return Err(Fault::value(format!("{} cannot be unpacked into {} names", describe(&item), targets.len())));
        }
        let parts = self.items(&item)?;
        self.locals.extend(targets.iter().cloned().zip(parts));
        Ok(())
    }

    /// What a loop over `value` goes through.
    pub fn items(&mut self, value: &Value) -> Result<Vec<Value>, Fault> {
        let count = length(value).ok_or_else(|| Fault::value(format!("{} cannot be iterated", describe(value))))?;
        self.meter().step(count)?;
        Ok(match value {
            Value::Text(text) => text.chars().map(|c| Value::text(c.encode_utf8(&mut [0; 4]))).collect(),
            Value::List(items) | Value::Tuple(items) => items.to_vec(),
            Value::Dict(dict) => dict.entries().iter().map(|(key, _)| key.clone()).collect(),
            _ => Vec::new(),
        })
    }
}
