//! Names, literals, brackets, and what follows them: calls, indices, attributes.

use super::Fault;
use super::lexer::Token;
use super::parser::{DEEPEST, Parser};
use super::syntax::{CallArgument, Clause, Expression, Kind};
use super::value::Value;
use crate::error::ErrorKind;

impl Parser {
    pub(super) fn postfix(&mut self) -> Result<Expression, Fault> {
        let start = self.start();
        let mut value = self.atom()?;
        let mut links = 0;
        loop {
            links += 1;
            if links > 10 * DEEPEST {
                return Err(Fault::new(ErrorKind::Limit, "the chain of calls is too long").at(&self.tokens[self.at].1));
            }
            let kind = if self.take(".") {
                Kind::Attribute(Box::new(value), self.identifier()?)
            } else if self.take("(") {
                Kind::Call { function: Box::new(value), arguments: self.arguments()? }
            } else if self.take("[") {
                self.subscript(value)?
            } else {
                return Ok(value);
            };
            value = self.spanned(start, kind);
        }
    }

    fn arguments(&mut self) -> Result<Vec<CallArgument>, Fault> {
        let mut arguments = Vec::new();
        while !self.take(")") {
            let start = self.start();
            let named = matches!(self.peek(), Token::Name(_))
                && matches!(self.tokens.get(self.at + 1), Some((Token::Symbol("="), _)));
            arguments.push(if self.take("*") {
                CallArgument::Spread(self.conditional()?)
            } else if named {
                let name = self.identifier()?;
                self.expect("=")?;
                CallArgument::Named(name, self.conditional()?)
            } else {
                let element = self.conditional()?;
                if self.is_word("for") {
                    let clauses = self.clauses()?;
                    let kind = Kind::Comprehension { element: Box::new(element), clauses };
                    CallArgument::Plain(self.spanned(start, kind))
                } else {
                    CallArgument::Plain(element)
                }
            });
            if !self.take(",") && !self.is_symbol(")") {
                return Err(self.unexpected().help("\")\" or \",\" is expected here"));
            }
        }
        Ok(arguments)
    }

    fn subscript(&mut self, value: Expression) -> Result<Kind, Fault> {
        let value = Box::new(value);
        let mut parts: [Option<Box<Expression>>; 3] = [None, None, None];
        let mut colons = 0;
        while !self.take("]") {
            if self.take(":") {
                colons += 1;
                if colons > 2 {
                    return Err(self.unexpected());
                }
            } else if parts[colons].is_none() {
                parts[colons] = Some(Box::new(self.tuple()?));
            } else {
                return Err(self.unexpected().help("\"]\" is expected here"));
            }
        }
        if colons > 0 {
            return Ok(Kind::Slice(value, parts));
        }
        match parts {
            [Some(index), ..] => Ok(Kind::Index(value, index)),
            _ => Err(Fault::new(ErrorKind::Syntax, "the index is missing").at(&(self.end() - 1..self.end()))),
        }
    }

    fn clauses(&mut self) -> Result<Vec<Clause>, Fault> {
        let mut clauses = Vec::new();
        while self.take_word("for") {
            let parenthesised = self.take("(");
            let mut targets = vec![self.identifier()?];
            while self.take(",") {
                targets.push(self.identifier()?);
            }
            if parenthesised {
                self.expect(")")?;
            }
            self.expect_word("in")?;
            let iterable = self.or()?;
            let mut conditions = Vec::new();
            while self.take_word("if") {
                conditions.push(self.or()?);
            }
            clauses.push(Clause { targets, iterable, conditions });
        }
        Ok(clauses)
    }

    fn atom(&mut self) -> Result<Expression, Fault> {
        let start = self.start();
        let token = self.peek().clone();
        let kind = match token {
            Token::Integer(value) => {
                self.advance();
                Kind::Constant(Value::Integer(value))
            }
            Token::Float(value) => {
                self.advance();
                Kind::Constant(Value::Float(value))
            }
            Token::Text(mut text) => {
                self.advance();
                while let Token::Text(more) = self.peek() {
                    text.push_str(more);
                    self.advance();
                }
                Kind::Constant(Value::text(text))
            }
            Token::Name(name) => {
                let constant = match name.as_str() {
                    "None" => Some(Value::None),
                    "True" => Some(Value::Bool(true)),
                    "False" => Some(Value::Bool(false)),
                    _ => None,
                };
                match constant {
                    Some(value) => {
                        self.advance();
                        Kind::Constant(value)
                    }
                    None => Kind::Name(self.identifier()?),
                }
            }
            Token::Symbol("(") => {
                self.advance();
                return self.parenthesised(start);
            }
            Token::Symbol("[") => {
                self.advance();
                self.bracketed()?
            }
            Token::Symbol("{") => {
                self.advance();
                self.braced()?
            }
            _ => return Err(self.unexpected()),
        };
        Ok(self.spanned(start, kind))
    }

    fn parenthesised(&mut self, start: usize) -> Result<Expression, Fault> {
        if self.take(")") {
            return Ok(self.spanned(start, Kind::Tuple(Vec::new())));
        }
        let inner = self.tuple()?;
        if self.is_word("for") {
            let clauses = self.clauses()?;
            self.expect(")")?;
            let kind = Kind::Comprehension { element: Box::new(inner), clauses };
            return Ok(self.spanned(start, kind));
        }
        self.expect(")")?;
        Ok(self.spanned(start, inner.kind))
    }

    /// A list, or a comprehension of one.
    fn bracketed(&mut self) -> Result<Kind, Fault> {
        let mut items = Vec::new();
        while !self.take("]") {
            items.push(self.conditional()?);
            if items.len() == 1 && self.is_word("for") {
                let clauses = self.clauses()?;
                self.expect("]")?;
                let element = Box::new(items.remove(0));
                return Ok(Kind::Comprehension { element, clauses });
            }
            if !self.take(",") && !self.is_symbol("]") {
                return Err(self.unexpected().help("\"]\" or \",\" is expected here"));
            }
        }
        Ok(Kind::List(items))
    }

    /// A dictionary. Inside `${…}` there is none, since the first `}` ends the expression.
    fn braced(&mut self) -> Result<Kind, Fault> {
        let mut entries = Vec::new();
        while !self.take("}") {
            let key = self.conditional()?;
            self.expect(":")?;
            entries.push((key, self.conditional()?));
            if !self.take(",") && !self.is_symbol("}") {
                return Err(self.unexpected().help("\"}\" or \",\" is expected here"));
            }
        }
        Ok(Kind::Dict(entries))
    }
}
