//! Tokens into a syntax tree, with Python's precedence.

use std::ops::Range;
use std::rc::Rc;

use super::Fault;
use super::lexer::{Token, tokens};
use super::syntax::{Binary, CallArgument, Clause, Comparison, Expression, Kind, Lambda, Unary};
use super::value::Value;
use crate::error::ErrorKind;

/// Parentheses, operators and the like nested deeper than this are no formula; the parser recurses.
const DEEPEST: usize = 100;

const KEYWORDS: &[&str] = &[
    "and", "as", "assert", "async", "await", "break", "class", "continue", "def", "del", "elif", "else", "except",
    "finally", "for", "from", "global", "if", "import", "in", "is", "lambda", "nonlocal", "not", "or", "pass", "raise",
    "return", "try", "while", "with", "yield", "None", "True", "False",
];

/// Whether `name` can name a property or macro: a Python identifier that is no keyword.
pub(crate) fn is_name(name: &str) -> bool {
    name.starts_with(|c: char| c == '_' || c.is_alphabetic())
        && name.chars().all(|c| c == '_' || c.is_alphanumeric())
        && !KEYWORDS.contains(&name)
}

/// Reads an expression.
pub(crate) fn parse(text: &str) -> Result<Expression, Fault> {
    let mut parser = Parser { tokens: tokens(text)?, at: 0, depth: 0 };
    if parser.is_end() {
        return Err(Fault::new(ErrorKind::Syntax, "the expression is empty").at(&(0..text.len())));
    }
    let expression = parser.tuple()?;
    if !parser.is_end() {
        return Err(parser.unexpected());
    }
    Ok(expression)
}

struct Parser {
    tokens: Vec<(Token, Range<usize>)>,
    at: usize,
    depth: usize,
}

impl Parser {
    fn peek(&self) -> &Token {
        &self.tokens[self.at].0
    }

    fn start(&self) -> usize {
        self.tokens[self.at].1.start
    }

    /// The end of the token before.
    fn end(&self) -> usize {
        self.at.checked_sub(1).map_or(0, |before| self.tokens[before].1.end)
    }

    fn is_end(&self) -> bool {
        *self.peek() == Token::End
    }

    fn advance(&mut self) -> Token {
        let token = self.tokens[self.at].0.clone();
        if token != Token::End {
            self.at += 1;
        }
        token
    }

    fn is_symbol(&self, symbol: &str) -> bool {
        matches!(self.peek(), Token::Symbol(found) if *found == symbol)
    }

    fn is_word(&self, word: &str) -> bool {
        matches!(self.peek(), Token::Name(found) if found == word)
    }

    fn take(&mut self, symbol: &str) -> bool {
        let found = self.is_symbol(symbol);
        self.at += usize::from(found);
        found
    }

    fn take_word(&mut self, word: &str) -> bool {
        let found = self.is_word(word);
        self.at += usize::from(found);
        found
    }

    fn expect(&mut self, symbol: &str) -> Result<(), Fault> {
        if self.take(symbol) {
            return Ok(());
        }
        let fault = self.unexpected();
        Err(fault.help(format!("\"{symbol}\" is expected here")))
    }

    fn expect_word(&mut self, word: &str) -> Result<(), Fault> {
        if self.take_word(word) {
            return Ok(());
        }
        let fault = self.unexpected();
        Err(fault.help(format!("\"{word}\" is expected here")))
    }

    fn unexpected(&self) -> Fault {
        let (token, span) = &self.tokens[self.at];
        let message = match token {
            Token::End => "the expression ends too early".to_owned(),
            Token::Symbol(symbol) => format!("\"{symbol}\" is not expected here"),
            Token::Name(name) => format!("\"{name}\" is not expected here"),
            Token::Text(_) => "a text is not expected here".to_owned(),
            Token::Integer(_) | Token::Float(_) => "a number is not expected here".to_owned(),
        };
        let fault = Fault::new(ErrorKind::Syntax, message).at(span);
        match token {
            Token::Symbol("=") => fault.help("compare with \"==\""),
            Token::Symbol("&") => fault.help("write \"and\""),
            _ => fault,
        }
    }

    fn nested<T>(&mut self, inner: impl FnOnce(&mut Self) -> Result<T, Fault>) -> Result<T, Fault> {
        self.depth += 1;
        if self.depth > DEEPEST {
            return Err(Fault::new(ErrorKind::Limit, format!("the expression is nested more than {DEEPEST} deep"))
                .at(&self.tokens[self.at].1));
        }
        let result = inner(self);
        self.depth -= 1;
        result
    }

    fn spanned(&self, start: usize, kind: Kind) -> Expression {
        Expression { kind, span: start..self.end() }
    }

    /// `a, b` without parentheses, or a single expression.
    fn tuple(&mut self) -> Result<Expression, Fault> {
        let start = self.start();
        let first = self.conditional()?;
        if !self.is_symbol(",") {
            return Ok(first);
        }
        let mut items = vec![first];
        while self.take(",") {
            if self.is_end() || self.is_symbol(")") || self.is_symbol("]") {
                break;
            }
            items.push(self.conditional()?);
        }
        Ok(self.spanned(start, Kind::Tuple(items)))
    }

    fn conditional(&mut self) -> Result<Expression, Fault> {
        self.nested(|parser| {
            let start = parser.start();
            if parser.take_word("lambda") {
                return parser.lambda(start);
            }
            let then = parser.or()?;
            if !parser.take_word("if") {
                return Ok(then);
            }
            let condition = parser.or()?;
            parser.expect_word("else")?;
            let otherwise = parser.conditional()?;
            let kind = Kind::Conditional {
                condition: Box::new(condition),
                then: Box::new(then),
                otherwise: Box::new(otherwise),
            };
            Ok(parser.spanned(start, kind))
        })
    }

    fn lambda(&mut self, start: usize) -> Result<Expression, Fault> {
        let mut parameters = Vec::new();
        while !self.take(":") {
            parameters.push(self.identifier()?);
            if !self.take(",") && !self.is_symbol(":") {
                return Err(self.unexpected());
            }
        }
        let body = self.conditional()?;
        Ok(self.spanned(start, Kind::Lambda(Rc::new(Lambda { parameters, body }))))
    }

    fn identifier(&mut self) -> Result<Rc<str>, Fault> {
        match self.peek() {
            Token::Name(name) if !KEYWORDS.contains(&name.as_str()) => {
                let name = name.as_str().into();
                self.at += 1;
                Ok(name)
            }
            _ => Err(self.unexpected()),
        }
    }

    fn or(&mut self) -> Result<Expression, Fault> {
        self.chain("or", Self::and, Kind::Or)
    }

    fn and(&mut self) -> Result<Expression, Fault> {
        self.chain("and", Self::not, Kind::And)
    }

    fn chain(
        &mut self,
        word: &str,
        operand: fn(&mut Self) -> Result<Expression, Fault>,
        kind: fn(Vec<Expression>) -> Kind,
    ) -> Result<Expression, Fault> {
        let start = self.start();
        let first = operand(self)?;
        if !self.is_word(word) {
            return Ok(first);
        }
        let mut operands = vec![first];
        while self.take_word(word) {
            operands.push(operand(self)?);
        }
        Ok(self.spanned(start, kind(operands)))
    }

    fn not(&mut self) -> Result<Expression, Fault> {
        let start = self.start();
        if self.take_word("not") {
            let operand = self.nested(Self::not)?;
            return Ok(self.spanned(start, Kind::Unary(Unary::Not, Box::new(operand))));
        }
        self.comparison()
    }

    fn comparison(&mut self) -> Result<Expression, Fault> {
        let start = self.start();
        let first = self.binary(0)?;
        let mut rest = Vec::new();
        while let Some(comparison) = self.comparison_symbol() {
            rest.push((comparison, self.binary(0)?));
        }
        if rest.is_empty() {
            return Ok(first);
        }
        Ok(self.spanned(start, Kind::Compare(Box::new(first), rest)))
    }

    fn comparison_symbol(&mut self) -> Option<Comparison> {
        for (symbol, comparison) in [
            ("==", Comparison::Equal),
            ("!=", Comparison::NotEqual),
            ("<=", Comparison::LessEqual),
            ("<", Comparison::Less),
            (">=", Comparison::GreaterEqual),
            (">", Comparison::Greater),
        ] {
            if self.take(symbol) {
                return Some(comparison);
            }
        }
        if self.take_word("in") {
            return Some(Comparison::In);
        }
        if self.take_word("is") {
            return Some(if self.take_word("not") { Comparison::IsNot } else { Comparison::Is });
        }
        let not_in =
            self.is_word("not") && matches!(self.tokens.get(self.at + 1), Some((Token::Name(word), _)) if word == "in");
        if not_in {
            self.at += 2;
            return Some(Comparison::NotIn);
        }
        None
    }

    /// The operators of `LEVELS[level]` and those that bind tighter.
    fn binary(&mut self, level: usize) -> Result<Expression, Fault> {
        const LEVELS: [&[(&str, Binary)]; 6] = [
            &[("|", Binary::Or)],
            &[("^", Binary::Xor)],
            &[("&", Binary::And)],
            &[("<<", Binary::ShiftLeft), (">>", Binary::ShiftRight)],
            &[("+", Binary::Add), ("-", Binary::Subtract)],
            &[("*", Binary::Multiply), ("/", Binary::Divide), ("//", Binary::FloorDivide), ("%", Binary::Modulo)],
        ];
        let Some(operators) = LEVELS.get(level) else { return self.unary() };
        let start = self.start();
        let mut left = self.binary(level + 1)?;
        let mut operands = 0;
        while let Some(&(_, operator)) = operators.iter().find(|(symbol, _)| self.is_symbol(symbol)) {
            // The tree leans to the left and is walked by recursion.
            operands += 1;
            if operands > 10 * DEEPEST {
                return Err(Fault::new(ErrorKind::Limit, format!("more than {} operators in a row", 10 * DEEPEST))
                    .at(&self.tokens[self.at].1));
            }
            self.at += 1;
            let right = self.binary(level + 1)?;
            left = self.spanned(start, Kind::Binary(operator, Box::new(left), Box::new(right)));
        }
        Ok(left)
    }

    fn unary(&mut self) -> Result<Expression, Fault> {
        let start = self.start();
        for (symbol, operator) in [("-", Unary::Minus), ("+", Unary::Plus), ("~", Unary::Invert)] {
            if self.take(symbol) {
                let operand = self.nested(Self::unary)?;
                return Ok(self.spanned(start, Kind::Unary(operator, Box::new(operand))));
            }
        }
        let base = self.postfix()?;
        if self.take("**") {
            let exponent = self.nested(Self::unary)?;
            return Ok(self.spanned(start, Kind::Binary(Binary::Power, Box::new(base), Box::new(exponent))));
        }
        Ok(base)
    }

    fn postfix(&mut self) -> Result<Expression, Fault> {
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
