//! A robot's kinematics as a list of assignments, with products by 0 and ±1 left out.

use denavit_dh::table::{Motion, Row, Table};
use denavit_model::se3::sin_cos_of_written;
use std::collections::HashMap;

/// What a product is made of.
#[derive(Debug, Clone, PartialEq)]
pub enum Factor {
    /// A constant.
    Number(f64),
    /// A name that was assigned before, or a coordinate by its index.
    Name(String),
    /// A coordinate.
    Coordinate(usize),
}

/// A signed product.
#[derive(Debug, Clone, PartialEq)]
pub struct Term {
    /// Whether it is subtracted.
    pub negative: bool,
    /// At least one.
    pub factors: Vec<Factor>,
}

/// An assignment.
#[derive(Debug, Clone, PartialEq)]
pub enum Statement {
    /// `name = terms`.
    Sum {
        /// What is assigned.
        name: String,
        /// At least one.
        terms: Vec<Term>,
    },
    /// `sine = sin(angle)`, `cosine = cos(angle)`.
    SinCos {
        /// What the sine is assigned to.
        sine: String,
        /// What the cosine is assigned to.
        cosine: String,
        /// rad.
        angle: Vec<Term>,
    },
    /// `name = function(arguments)`.
    Call {
        /// What is assigned.
        name: String,
        /// What is computed.
        function: Function,
        /// As many as it takes.
        arguments: Vec<Value>,
    },
    /// `array[k] = sin((k + 1) angle)`, or `sin, cos` in turn; all times `inside`, which is 0 or 1.
    Waves {
        /// What is filled.
        array: String,
        /// How many values it has.
        count: usize,
        /// rad.
        angle: Value,
        /// 1, or 0 where there are no waves.
        inside: Value,
        /// Whether cosines go with the sines.
        turns: bool,
    },
    /// `name = Σ array[k] table[k]`.
    Weighted {
        /// What is assigned.
        name: String,
        /// An array that was filled before.
        array: String,
        /// How many values it has.
        count: usize,
        /// By its index among the tables.
        table: usize,
    },
    /// `z[axis][first + k] = array[k] by`.
    Scatter {
        /// 0 to 2.
        axis: usize,
        /// Where the array goes.
        first: usize,
        /// An array that was filled before.
        array: String,
        /// How many values it has.
        count: usize,
        /// What it is multiplied by.
        by: Value,
    },
    /// `z[axis][index] = value`.
    Store {
        /// 0 to 2.
        axis: usize,
        /// Where.
        index: usize,
        /// What.
        value: Value,
    },
    /// `name = Σ (Σ z[axis][first + k] table[row][k])²/3` over axes and rows.
    Squares {
        /// What is assigned.
        name: String,
        /// The first number that counts.
        first: usize,
        /// By its index among the tables.
        table: usize,
    },
}

/// A function that is not a sum of products.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Function {
    Sine,
    Cosine,
    /// Of two numbers.
    Arctangent,
    Root,
    Exponential,
    Inverse,
    Size,
    Most,
    Least,
    /// Of four numbers: the third where the first is below the second, else the last.
    Choice,
}

impl Function {
    /// Its value.
    pub fn of(self, of: &[f64]) -> f64 {
        match self {
            Self::Sine => of[0].sin(),
            Self::Cosine => of[0].cos(),
            Self::Arctangent => of[0].atan2(of[1]),
            Self::Root => of[0].sqrt(),
            Self::Exponential => of[0].exp(),
            Self::Inverse => 1.0 / of[0],
            Self::Size => of[0].abs(),
            Self::Most => of[0].max(of[1]),
            Self::Least => of[0].min(of[1]),
            Self::Choice if of[0] < of[1] => of[2],
            Self::Choice => of[3],
        }
    }
}

fn names(terms: &[Term]) -> Vec<&str> {
    let factors = terms.iter().flat_map(|term| &term.factors);
    factors.filter_map(|factor| if let Factor::Name(name) = factor { Some(name.as_str()) } else { None }).collect()
}

impl Statement {
    /// Names that it reads.
    pub fn reads(&self) -> Vec<&str> {
        match self {
            Self::Sum { terms, .. } | Self::SinCos { angle: terms, .. } => names(terms),
            Self::Call { arguments, .. } => arguments.iter().filter_map(Value::name).collect(),
            Self::Waves { angle, inside, .. } => [angle, inside].into_iter().filter_map(Value::name).collect(),
            Self::Weighted { array, .. } => vec![array],
            Self::Scatter { array, by, .. } => [Some(array.as_str()), by.name()].into_iter().flatten().collect(),
            Self::Store { value, .. } => value.name().into_iter().collect(),
            Self::Squares { .. } => Vec::new(),
        }
    }

    /// Names that it assigns; none where it fills a part of z.
    pub fn assigns(&self) -> Vec<&str> {
        match self {
            Self::Sum { name, .. }
            | Self::Call { name, .. }
            | Self::Weighted { name, .. }
            | Self::Squares { name, .. } => vec![name],
            Self::SinCos { sine, cosine, .. } => vec![sine, cosine],
            Self::Waves { array, .. } => vec![array],
            Self::Scatter { .. } | Self::Store { .. } => Vec::new(),
        }
    }
}

/// A number that is known now, or when the code runs.
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    /// Known now.
    Number(f64),
    /// A name, perhaps with a minus.
    Name {
        /// Whether it is negated.
        negative: bool,
        /// The name.
        name: String,
    },
}

impl Value {
    pub const ZERO: Self = Self::Number(0.0);
    pub const ONE: Self = Self::Number(1.0);

    /// A value that already has a name.
    pub fn named(name: impl Into<String>) -> Self {
        Self::Name { negative: false, name: name.into() }
    }

    /// Its name, where it has one.
    pub fn name(&self) -> Option<&str> {
        if let Self::Name { name, .. } = self { Some(name) } else { None }
    }

    pub fn negated(self) -> Self {
        match self {
            Self::Number(number) => Self::Number(0.0 - number),
            Self::Name { negative, name } => Self::Name { negative: !negative, name },
        }
    }

    /// As a sum of one term.
    pub fn term(&self) -> Term {
        match self {
            Self::Number(number) => Term {
                negative: number.is_sign_negative() && *number != 0.0,
                factors: vec![Factor::Number(number.abs())],
            },
            Self::Name { negative, name } => Term { negative: *negative, factors: vec![Factor::Name(name.clone())] },
        }
    }
}

type Vector = [Value; 3];

/// Forward kinematics and Jacobian, written out.
#[derive(Debug, Clone, PartialEq)]
pub struct Program {
    /// What the pose needs, in order.
    pub pose_statements: Vec<Statement>,
    /// Rows of the rotation and the translation.
    pub pose: [[Value; 4]; 3],
    /// What the Jacobian needs beyond them, in order.
    pub jacobian_statements: Vec<Statement>,
    /// Angular rows first, a column for each coordinate.
    pub jacobian: Vec<Vec<Value>>,
}

/// A joint's axis in the base frame, when it is reached.
struct Axis {
    direction: Vector,
    point: Vector,
    motion: Motion,
    coordinate: usize,
    scale: f64,
}

/// Assignments, each result with a name of its own.
#[derive(Debug, Default)]
pub struct Sheet {
    pub statements: Vec<Statement>,
    /// Results that have a name already, by what they are made of.
    known: HashMap<String, String>,
    next: usize,
}

struct Writer {
    sheet: Sheet,
    columns: [Vector; 3],
    place: Vector,
}

impl Program {
    /// Of a table.
    pub fn of(table: &Table) -> Self {
        let mut writer = Writer::new();
        let mut axes = Vec::new();
        writer.row(&table.row(0), None);
        for (index, joint) in table.joints.iter().enumerate() {
            axes.push(Axis {
                direction: writer.columns[2].clone(),
                point: writer.place.clone(),
                motion: joint.motion,
                coordinate: joint.coordinate,
                scale: joint.scale,
            });
            writer.row(&table.row(index + 1), Some((joint.motion, joint.coordinate, joint.scale)));
        }
        writer.turn_about_z(table.tool.theta, None);
        writer.along(2, table.tool.d, None);
        let [x, y, z] = &writer.columns;
        let pose =
            std::array::from_fn(|row| [x[row].clone(), y[row].clone(), z[row].clone(), writer.place[row].clone()]);
        let pose_statements = std::mem::take(&mut writer.sheet.statements);
        let jacobian = writer.jacobian(&axes, table.coordinates.len());
        Self { pose_statements, pose, jacobian_statements: writer.sheet.statements, jacobian }
    }
}

impl Writer {
    fn new() -> Self {
        let unit = |at: usize| std::array::from_fn(|row| Value::Number(f64::from(u8::from(row == at))));
        Self {
            sheet: Sheet::default(),
            columns: [unit(0), unit(1), unit(2)],
            place: [Value::ZERO, Value::ZERO, Value::ZERO],
        }
    }

    /// Rz(theta) Tz(d), with what a joint adds, then the rest of the row.
    fn row(&mut self, row: &Row, joint: Option<(Motion, usize, f64)>) {
        let (mut turn, mut slide) = (None, None);
        if let Some((motion, coordinate, scale)) = joint {
            let by = |factor: f64| Term {
                negative: factor < 0.0,
                factors: if factor.abs() == 1.0 {
                    vec![Factor::Coordinate(coordinate)]
                } else {
                    vec![Factor::Number(factor.abs()), Factor::Coordinate(coordinate)]
                },
            };
            match motion {
                Motion::Revolute => turn = Some(by(scale)),
                Motion::Prismatic => slide = Some(by(scale)),
                Motion::Helical(_) => (turn, slide) = (Some(by(scale)), Some(by(motion.pitch() * scale))),
            }
        }
        self.turn_about_z(row.theta(), turn);
        self.along(2, row.d().unwrap_or(0.0), slide);
        match row {
            Row::Dh(row) => {
                self.turn_by(1, 2, sin_cos_of_written(row.alpha));
                self.along(0, row.a, None);
            }
            Row::Hayati(row) => {
                self.along(0, row.a, None);
                self.turn_by(1, 2, sin_cos_of_written(row.alpha));
                self.turn_by(2, 0, sin_cos_of_written(row.beta));
            }
        }
    }

    /// Turns about z by a constant and, where a joint turns, by its coordinate: a constant of whole quarter turns costs nothing, any
    /// other goes into the angle.
    fn turn_about_z(&mut self, theta: f64, joint: Option<Term>) {
        let (sine, cosine) = sin_cos_of_written(theta);
        let is_quarter = sine == 0.0 || cosine == 0.0;
        if let Some(turn) = joint {
            let mut angle = vec![turn];
            if !is_quarter {
                angle.push(Value::Number(theta).term());
            }
            let index = self.sheet.fresh();
            let (sine, cosine) = (format!("s{index}"), format!("c{index}"));
            self.sheet.statements.push(Statement::SinCos { sine: sine.clone(), cosine: cosine.clone(), angle });
            let name = |name| Value::Name { negative: false, name };
            self.turn_columns(0, 1, (name(sine), name(cosine)));
            if !is_quarter {
                return;
            }
        }
        self.turn_by(0, 1, (sine, cosine));
    }

    fn turn_by(&mut self, first: usize, second: usize, (sine, cosine): (f64, f64)) {
        self.turn_columns(first, second, (Value::Number(sine), Value::Number(cosine)));
    }

    /// Turns in the plane of two axes of the frame: first' = first·cos + second·sin, second' = second·cos - first·sin.
    fn turn_columns(&mut self, first: usize, second: usize, (sine, cosine): (Value, Value)) {
        let (a, b) = (self.columns[first].clone(), self.columns[second].clone());
        for row in 0..3 {
            self.columns[first][row] = self.sheet.sum(&[(&a[row], &cosine), (&b[row], &sine)]);
            self.columns[second][row] = self.sheet.sum(&[(&b[row], &cosine), (&a[row].clone().negated(), &sine)]);
        }
    }

    /// Moves along an axis of the frame by a constant, and by what a joint adds.
    fn along(&mut self, axis: usize, length: f64, joint: Option<Term>) {
        let by = match joint {
            None => Value::Number(length),
            Some(slide) => {
                let name = format!("d{}", self.sheet.fresh());
                let mut terms = vec![slide];
                if length != 0.0 {
                    terms.push(Value::Number(length).term());
                }
                self.sheet.statements.push(Statement::Sum { name: name.clone(), terms });
                Value::Name { negative: false, name }
            }
        };
        for row in 0..3 {
            let (here, along) = (self.place[row].clone(), self.columns[axis][row].clone());
            self.place[row] = self.sheet.sum(&[(&here, &Value::Number(1.0)), (&along, &by)]);
        }
    }

    fn jacobian(&mut self, axes: &[Axis], coordinates: usize) -> Vec<Vec<Value>> {
        let mut columns: Vec<[Vec<(Value, Value)>; 6]> = vec![Default::default(); coordinates];
        let tip = self.place.clone();
        for axis in axes {
            let scale = Value::Number(axis.scale);
            let column = &mut columns[axis.coordinate];
            if axis.motion != Motion::Prismatic {
                let arm: Vec<Value> = (0..3)
                    .map(|row| {
                        self.sheet.sum(&[
                            (&tip[row], &Value::Number(1.0)),
                            (&axis.point[row].clone().negated(), &Value::Number(1.0)),
                        ])
                    })
                    .collect();
                for row in 0..3 {
                    column[row].push((axis.direction[row].clone(), scale.clone()));
                    let (next, after) = ((row + 1) % 3, (row + 2) % 3);
                    let across = self.sheet.sum(&[
                        (&axis.direction[next], &arm[after]),
                        (&axis.direction[after].clone().negated(), &arm[next]),
                    ]);
                    column[3 + row].push((across, scale.clone()));
                }
            }
            let slides = match axis.motion {
                Motion::Prismatic => axis.scale,
                Motion::Revolute => 0.0,
                Motion::Helical(_) => axis.scale * axis.motion.pitch(),
            };
            if slides != 0.0 {
                for row in 0..3 {
                    column[3 + row].push((axis.direction[row].clone(), Value::Number(slides)));
                }
            }
        }
        let mut rows = vec![Vec::new(); 6];
        for column in &columns {
            for (row, parts) in column.iter().enumerate() {
                let parts: Vec<(&Value, &Value)> = parts.iter().map(|(a, b)| (a, b)).collect();
                rows[row].push(self.sheet.sum(&parts));
            }
        }
        rows
    }
}

impl Sheet {
    /// A function's value: a number where its arguments are.
    pub fn call(&mut self, function: Function, arguments: &[&Value]) -> Value {
        let numbers =
            arguments.iter().map(|value| if let Value::Number(number) = value { Some(*number) } else { None });
        if let Some(numbers) = numbers.collect::<Option<Vec<f64>>>() {
            return Value::Number(function.of(&numbers));
        }
        let key = format!("{function:?}{arguments:?}");
        if let Some(name) = self.known.get(&key) {
            return Value::named(name);
        }
        let name = format!("t{}", self.fresh());
        self.known.insert(key, name.clone());
        let arguments = arguments.iter().map(|value| (*value).clone()).collect();
        self.statements.push(Statement::Call { name: name.clone(), function, arguments });
        Value::named(name)
    }

    /// A name that is free.
    pub fn fresh(&mut self) -> usize {
        self.next += 1;
        self.next
    }

    /// Σ a·b: a value where that is one, else a new name.
    pub fn sum(&mut self, products: &[(&Value, &Value)]) -> Value {
        let (mut constant, mut terms) = (0.0, Vec::new());
        for product in products {
            match product {
                (Value::Number(a), Value::Number(b)) => constant += a * b,
                (Value::Number(zero), _) | (_, Value::Number(zero)) if *zero == 0.0 => {}
                (Value::Number(number), Value::Name { negative, name })
                | (Value::Name { negative, name }, Value::Number(number)) => {
                    let mut factors = vec![Factor::Name(name.clone())];
                    if number.abs() != 1.0 {
                        factors.insert(0, Factor::Number(number.abs()));
                    }
                    terms.push(Term { negative: *negative != (*number < 0.0), factors });
                }
                (Value::Name { negative: a, name: first }, Value::Name { negative: b, name: second }) => {
                    terms.push(Term {
                        negative: a != b,
                        factors: vec![Factor::Name(first.clone()), Factor::Name(second.clone())],
                    });
                }
            }
        }
        match &terms[..] {
            [] => return Value::Number(constant),
            [Term { negative, factors }] if constant == 0.0 => {
                if let [Factor::Name(name)] = &factors[..] {
                    return Value::Name { negative: *negative, name: name.clone() };
                }
            }
            _ => {}
        }
        if constant != 0.0 {
            terms.push(Value::Number(constant).term());
        }
        // A sum that begins without a minus reads better.
        terms.sort_by_key(|term| term.negative);
        for negative in [false, true] {
            if let Some(name) = self.known.get(&key(&terms, negative)) {
                return Value::Name { negative, name: name.clone() };
            }
        }
        let name = format!("t{}", self.fresh());
        self.known.insert(key(&terms, false), name.clone());
        self.statements.push(Statement::Sum { name: name.clone(), terms });
        Value::Name { negative: false, name }
    }
}

/// A sum's terms as one text, independent of their order; with every sign reversed on request.
fn key(terms: &[Term], negated: bool) -> String {
    let mut texts: Vec<String> = terms
        .iter()
        .map(|term| {
            let mut factors: Vec<String> = term.factors.iter().map(|factor| format!("{factor:?}")).collect();
            factors.sort();
            format!("{}{}", if term.negative == negated { '+' } else { '-' }, factors.join("*"))
        })
        .collect();
    texts.sort();
    texts.concat()
}

/// The statements that the outputs need, in order, without unused ones.
pub fn needed<'a>(statements: &[&'a Statement], outputs: &[&Value]) -> Vec<&'a Statement> {
    let mut wanted: std::collections::BTreeSet<&str> = outputs.iter().filter_map(|value| value.name()).collect();
    let mut kept = Vec::new();
    for statement in statements.iter().rev() {
        let assigned = statement.assigns();
        if assigned.is_empty() || assigned.iter().any(|name| wanted.contains(name)) {
            wanted.extend(statement.reads());
            kept.push(*statement);
        }
    }
    kept.reverse();
    kept
}
