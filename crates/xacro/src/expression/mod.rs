//! The subset of Python expressions that xacro files use.
//!
//! Integers have 128 bits and lists cannot be changed in place; apart from these the results, and the way they are
//! written, are Python's. Nothing of Python's object model can be reached: names, attributes and methods are closed lists.

mod atoms;
mod builtins;
mod constant;
mod evaluate;
mod format;
mod lexer;
mod math;
mod methods;
mod number;
mod operators;
mod parser;
mod sequences;
mod syntax;
mod value;

pub(crate) use builtins::{global, is_global, names};
pub(crate) use constant::{constant, with_arguments};
pub(crate) use evaluate::{Host, evaluate};
pub(crate) use number::{parse_float, parse_integer};
pub(crate) use parser::{is_name, parse};
pub(crate) use syntax::Expression;
pub(crate) use value::{Dict, Value};

use std::ops::Range;

use crate::error::{ErrorKind, XacroError};

/// A failure inside an expression, with the wrong part of its text.
#[derive(Debug)]
pub(crate) struct Fault {
    pub error: Box<XacroError>,
    pub span: Option<Range<usize>>,
}

impl Fault {
    pub fn new(kind: ErrorKind, message: impl Into<String>) -> Self {
        Self { error: XacroError::new(kind, message), span: None }
    }

    /// A failure of evaluation: wrong type, wrong value.
    pub fn value(message: impl Into<String>) -> Self {
        Self::new(ErrorKind::Evaluation, message)
    }

    pub fn help(mut self, help: impl Into<String>) -> Self {
        self.error = self.error.help(help);
        self
    }

    /// Sets the span, unless one further inside is known.
    pub fn at(mut self, span: &Range<usize>) -> Self {
        self.span.get_or_insert_with(|| span.clone());
        self
    }
}

impl From<Box<XacroError>> for Fault {
    fn from(error: Box<XacroError>) -> Self {
        Self { error, span: None }
    }
}
