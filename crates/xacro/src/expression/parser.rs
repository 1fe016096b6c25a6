//! Tokens into a syntax tree, with Python's precedence.

use std::ops::Range;
use std::rc::Rc;

use super::Fault;
use super::lexer::{Token, tokens};
use super::syntax::{Binary, Comparison, Expression, Kind, Lambda, Unary};
use crate::error::ErrorKind;

/// Parentheses, operators and the like nested deeper than this are refused, since the parser recurses.
pub(super) const DEEPEST: usize = 100;

const KEYWORDS: &[&str] = &[
    "and", "as", "assert", "async", "await", "break", "class", "continue", "def", "del", "elif", "else", "except",
    "finally", "for", "from", "global", "if", "import", "in", "is", "lambda", "nonlocal", "not", "or", "pass", "raise",
    "return", "try", "while", "with", "yield", "None", "True", "False",
];

/// Whether `name` can name a property or macro: a Python identifier that is not a keyword.
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

pub(super) struct Parser {
    pub(super) tokens: Vec<(Token, Range<usize>)>,
    pub(super) at: usize,
    depth: usize,
}

impl Parser {
    pub(super) fn peek(&self) -> &Token {
        &self.tokens[self.at].0
    }

    pub(super) fn start(&self) -> usize {
        self.tokens[self.at].1.start
    }

    /// The end of the token before.
    pub(super) fn end(&self) -> usize {
        self.at.checked_sub(1).map_or(0, |before| self.tokens[before].1.end)
    }

    pub(super) fn is_end(&self) -> bool {
        *self.peek() == Token::End
    }

    pub(super) fn advance(&mut self) -> Token {
        let token = self.tokens[self.at].0.clone();
        if token != Token::End {
            self.at += 1;
        }
        token
    }

    pub(super) fn is_symbol(&self, symbol: &str) -> bool {
        matches!(self.peek(), Token::Symbol(found) if *found == symbol)
    }

    pub(super) fn is_word(&self, word: &str) -> bool {
        matches!(self.peek(), Token::Name(found) if found == word)
    }

    pub(super) fn take(&mut self, symbol: &str) -> bool {
        let found = self.is_symbol(symbol);
        self.at += usize::from(found);
        found
    }

    pub(super) fn take_word(&mut self, word: &str) -> bool {
        let found = self.is_word(word);
        self.at += usize::from(found);
        found
    }

    pub(super) fn expect(&mut self, symbol: &str) -> Result<(), Fault> {
        if self.take(symbol) {
            return Ok(());
        }
        let fault = self.unexpected();
        Err(fault.help(format!("\"{symbol}\" is expected here")))
    }

    pub(super) fn expect_word(&mut self, word: &str) -> Result<(), Fault> {
        if self.take_word(word) {
            return Ok(());
        }
        let fault = self.unexpected();
        Err(fault.help(format!("\"{word}\" is expected here")))
    }

    pub(super) fn unexpected(&self) -> Fault {
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

    pub(super) fn nested<T>(&mut self, inner: impl FnOnce(&mut Self) -> Result<T, Fault>) -> Result<T, Fault> {
        self.depth += 1;
        if self.depth > DEEPEST {
            return Err(Fault::new(ErrorKind::Limit, format!("the expression is nested more than {DEEPEST} deep"))
                .at(&self.tokens[self.at].1));
        }
        let result = inner(self);
        self.depth -= 1;
        result
    }

    pub(super) fn spanned(&self, start: usize, kind: Kind) -> Expression {
        Expression { kind, span: start..self.end() }
    }

    /// `a, b` without parentheses, or a single expression.
    pub(super) fn tuple(&mut self) -> Result<Expression, Fault> {
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

    pub(super) fn conditional(&mut self) -> Result<Expression, Fault> {
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

    pub(super) fn lambda(&mut self, start: usize) -> Result<Expression, Fault> {
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

    pub(super) fn identifier(&mut self) -> Result<Rc<str>, Fault> {
        match self.peek() {
            Token::Name(name) if !KEYWORDS.contains(&name.as_str()) => {
                let name = name.as_str().into();
                self.at += 1;
                Ok(name)
            }
            _ => Err(self.unexpected()),
        }
    }

    pub(super) fn or(&mut self) -> Result<Expression, Fault> {
        self.chain("or", Self::and, Kind::Or)
    }

    pub(super) fn and(&mut self) -> Result<Expression, Fault> {
        self.chain("and", Self::not, Kind::And)
    }

    pub(super) fn chain(
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

    pub(super) fn not(&mut self) -> Result<Expression, Fault> {
        let start = self.start();
        if self.take_word("not") {
            let operand = self.nested(Self::not)?;
            return Ok(self.spanned(start, Kind::Unary(Unary::Not, Box::new(operand))));
        }
        self.comparison()
    }

    pub(super) fn comparison(&mut self) -> Result<Expression, Fault> {
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

    pub(super) fn comparison_symbol(&mut self) -> Option<Comparison> {
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
    pub(super) fn binary(&mut self, level: usize) -> Result<Expression, Fault> {
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

    pub(super) fn unary(&mut self) -> Result<Expression, Fault> {
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
}
