//! The syntax tree of an expression.

use std::ops::Range;
use std::rc::Rc;

use super::value::Value;

#[derive(Debug)]
pub(crate) struct Expression {
    pub kind: Kind,
    /// Bytes of the expression's text.
    pub span: Range<usize>,
}

#[derive(Debug)]
pub(crate) enum Kind {
    Constant(Value),
    Name(Rc<str>),
    List(Vec<Expression>),
    Tuple(Vec<Expression>),
    Dict(Vec<(Expression, Expression)>),
    Unary(Unary, Box<Expression>),
    Binary(Binary, Box<Expression>, Box<Expression>),
    /// `a < b <= c`: each operand is evaluated once.
    Compare(Box<Expression>, Vec<(Comparison, Expression)>),
    And(Vec<Expression>),
    Or(Vec<Expression>),
    Conditional {
        condition: Box<Expression>,
        then: Box<Expression>,
        otherwise: Box<Expression>,
    },
    Attribute(Box<Expression>, Rc<str>),
    Index(Box<Expression>, Box<Expression>),
    Slice(Box<Expression>, [Option<Box<Expression>>; 3]),
    Call {
        function: Box<Expression>,
        arguments: Vec<CallArgument>,
    },
    /// `[element for …]`, and a generator, which is evaluated at once.
    Comprehension {
        element: Box<Expression>,
        clauses: Vec<Clause>,
    },
    Lambda(Rc<Lambda>),
}

#[derive(Debug)]
pub(crate) enum CallArgument {
    Plain(Expression),
    /// `*values`
    Spread(Expression),
    /// `name=value`
    Named(Rc<str>, Expression),
}

/// `for targets in iterable if condition …`
#[derive(Debug)]
pub(crate) struct Clause {
    pub targets: Vec<Rc<str>>,
    pub iterable: Expression,
    pub conditions: Vec<Expression>,
}

#[derive(Debug)]
pub(crate) struct Lambda {
    pub parameters: Vec<Rc<str>>,
    pub body: Expression,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Unary {
    Minus,
    Plus,
    Invert,
    Not,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Binary {
    Add,
    Subtract,
    Multiply,
    Divide,
    FloorDivide,
    Modulo,
    Power,
    And,
    Or,
    Xor,
    ShiftLeft,
    ShiftRight,
}

impl Binary {
    pub fn symbol(self) -> &'static str {
        match self {
            Self::Add => "+",
            Self::Subtract => "-",
            Self::Multiply => "*",
            Self::Divide => "/",
            Self::FloorDivide => "//",
            Self::Modulo => "%",
            Self::Power => "**",
            Self::And => "&",
            Self::Or => "|",
            Self::Xor => "^",
            Self::ShiftLeft => "<<",
            Self::ShiftRight => ">>",
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Comparison {
    Equal,
    NotEqual,
    Less,
    LessEqual,
    Greater,
    GreaterEqual,
    In,
    NotIn,
    Is,
    IsNot,
}

impl Comparison {
    pub fn symbol(self) -> &'static str {
        match self {
            Self::Equal => "==",
            Self::NotEqual => "!=",
            Self::Less => "<",
            Self::LessEqual => "<=",
            Self::Greater => ">",
            Self::GreaterEqual => ">=",
            Self::In => "in",
            Self::NotIn => "not in",
            Self::Is => "is",
            Self::IsNot => "is not",
        }
    }
}
