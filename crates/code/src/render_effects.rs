//! Effects in a language.

use crate::correction::{Correction, Part, STILL};
use crate::effects::Effects;
use crate::evaluate::Evaluation;
use crate::program::{Function, Statement, Value, needed};
use crate::render::{CodeError, Language, Precision, Writer, comment};
use crate::spread::Table;
use minijinja::{Environment, context};
use serde::Serialize;

/// Newton's steps, at most.
const STEPS: usize = 30;
/// The longest step of a joint value, rad or m.
const LONGEST: f64 = 0.5;
/// Error of the joint values at which the self-test starts, rad or m.
const BESIDE: f64 = 0.01;
/// The code agrees with the effects' own prediction within this, m or rad, or is not written.
const AGREES: f64 = 1e-9;
/// Numbers in a line of a table.
const IN_A_LINE: usize = 8;

/// The values for the language's template.
#[derive(Serialize)]
pub struct Shown {
    /// In MATLAB what the head of the file says.
    help: String,
    functions: String,
    test: String,
}

#[derive(Serialize)]
struct ShownPart {
    lines: Vec<String>,
    outputs: Vec<String>,
    /// Outputs in rows of four.
    rows: Vec<Vec<String>>,
}

#[derive(Serialize)]
struct ShownTable {
    name: String,
    length: usize,
    lines: Vec<String>,
}

#[derive(Serialize)]
struct ShownCase {
    q: Vec<String>,
    given: Vec<String>,
    pose: Vec<Vec<String>>,
}

#[derive(Serialize)]
struct ShownArgument {
    name: String,
    unit: String,
}

/// The smallest square, the damping and the bounds of a precision.
struct Bounds {
    tiny: f64,
    damping: f64,
    /// The tip is there, m; joint values rest, rad or m.
    reached: f64,
    rest: f64,
    tolerance: f64,
}

impl Bounds {
    fn of(precision: Precision) -> Self {
        match precision {
            Precision::Double => Self { tiny: 1e-300, damping: 1e-10, reached: 1e-10, rest: 1e-11, tolerance: 1e-9 },
            Precision::Single => Self { tiny: 1e-30, damping: 1e-5, reached: 3e-5, rest: 1e-6, tolerance: 5e-4 },
        }
    }
}

impl Shown {
    /// The functions of effects and their part of the self-test.
    pub fn of(effects: &Effects, plain: &Writer) -> Result<Self, CodeError> {
        let bounds = Bounds::of(plain.options.precision);
        let correction = Correction::of(effects, bounds.tiny, bounds.damping);
        let off = effects.cases.iter().map(|case| Evaluation::off(&correction, case)).fold(0.0, f64::max);
        if off > AGREES * effects.chain.size().max(1.0) {
            return Err(CodeError::Disagrees(off));
        }
        let writer = Writer {
            options: plain.options,
            prefix: plain.prefix.clone(),
            tables: correction.tables.clone(),
            numbers: correction.numbers,
            lanes: None,
        };
        let part = |part: &Part| {
            let statements: Vec<&Statement> = part.statements.iter().collect();
            let values: Vec<&Value> = part.outputs.iter().collect();
            let statements = needed(&statements, &values);
            let outputs: Vec<String> = part.outputs.iter().map(|value| writer.value(value)).collect();
            let rows = outputs.chunks(4).map(<[String]>::to_vec).collect();
            ShownPart { lines: writer.lines(&statements, &values), outputs, rows }
        };
        let serde = |part: Option<ShownPart>| minijinja::Value::from(minijinja::value::Serde(part));
        let numbers = |of: &[f64]| of.iter().map(|value| writer.number(*value)).collect::<Vec<_>>();
        let tables: Vec<ShownTable> = correction
            .tables
            .iter()
            .map(|table| ShownTable {
                name: table.name.clone(),
                length: table.values.len(),
                lines: table.values.chunks(IN_A_LINE).map(|line| numbers(line).join(", ")).collect(),
            })
            .collect();
        let cases: Vec<ShownCase> = effects
            .cases
            .iter()
            .map(|case| {
                let pose = case.pose.to_homogeneous();
                let row = |row: usize| (0..4).map(|column| writer.number(pose[(row, column)])).collect();
                ShownCase { q: numbers(&case.q), given: numbers(&case.given), pose: (0..3).map(row).collect() }
            })
            .collect();
        let arguments: Vec<ShownArgument> = effects
            .arguments
            .iter()
            .map(|argument| ShownArgument { name: comment(&argument.name), unit: comment(&argument.unit) })
            .collect();
        let size = effects.chain.size().max(1.0);
        let single = plain.options.precision == Precision::Single;
        let suffix = if single && matches!(plain.options.language, Language::C | Language::Cpp) { "f" } else { "" };
        let mut environment = Environment::new();
        environment.set_auto_escape_callback(|_| minijinja::AutoEscape::None);
        let filled = |which: &str| {
            environment
                .render_str(
                    plain.options.language.template_of_effects(),
                    context! {
                        part => which,
                        name => &plain.prefix,
                        real => writer.real(),
                        suffix => suffix,
                        n => effects.chain.coordinates().len(),
                        arguments => minijinja::Value::from(minijinja::value::Serde(&arguments)),
                        tables => minijinja::Value::from(minijinja::value::Serde(&tables)),
                        curves => !effects.model.curves.is_empty(),
                        numbers => correction.numbers,
                        bends => correction.bend.is_some(),
                        twists => correction.twists,
                        passes => correction.passes,
                        still => writer.number(STILL),
                        steady => serde(correction.steady.as_ref().map(part)),
                        bend => serde(correction.bend.as_ref().map(part)),
                        reach => serde(Some(part(&correction.reach))),
                        step => serde(Some(part(&correction.step))),
                        steps => STEPS,
                        longest => writer.number(LONGEST),
                        reached => writer.number(bounds.reached * size),
                        rest => writer.number(bounds.rest),
                        tolerance => writer.number(bounds.tolerance * size),
                        beside => writer.number(BESIDE),
                        cases => minijinja::Value::from(minijinja::value::Serde(&cases)),
                    },
                )
                .map_err(|error| CodeError::Template(error.to_string()))
        };
        let help = if plain.options.language == Language::Matlab { filled("help")? } else { String::new() };
        Ok(Self { help, functions: filled("functions")?, test: filled("test")? })
    }
}

impl Writer {
    /// A statement that occurs only with effects, as lines.
    pub fn line_of_effects(&self, statement: &Statement) -> Vec<String> {
        let language = self.options.language;
        let prefix = &self.prefix;
        let place = |axis: usize, index: usize| self.name(&format!("z[{}]", axis * self.numbers + index));
        let table = |table: usize| {
            let name = &self.tables[table].name;
            match language {
                Language::C => format!("{prefix}_{name}"),
                Language::Cpp => format!("detail::{name}"),
                Language::Rust => name.to_uppercase(),
                Language::Python => format!("_{name}"),
                Language::Matlab => format!("{name}()"),
            }
        };
        match statement {
            Statement::Sum { .. } | Statement::SinCos { .. } => Vec::new(),
            Statement::Call { name, function, arguments } => {
                let arguments: Vec<String> = arguments.iter().map(|value| self.value(value)).collect();
                vec![self.assigned(name, &self.function(*function, &arguments))]
            }
            Statement::Waves { array, count, angle, inside, turns } => {
                let (angle, inside, real) = (self.value(angle), self.value(inside), self.real());
                match language {
                    Language::C => vec![
                        format!("{real} {array}[{count}];"),
                        format!("{prefix}_waves({angle}, {inside}, {count}, {}, {array});", u8::from(*turns)),
                    ],
                    Language::Cpp => {
                        vec![format!("const auto {array} = detail::waves<{count}>({angle}, {inside}, {turns});")]
                    }
                    Language::Rust => vec![format!("let {array} = waves::<{count}>({angle}, {inside}, {turns});")],
                    Language::Python => {
                        let turns = if *turns { "True" } else { "False" };
                        vec![format!("{array} = _waves({angle}, {inside}, {count}, {turns})")]
                    }
                    Language::Matlab => vec![format!("{array} = waves({angle}, {inside}, {count}, {turns});")],
                }
            }
            Statement::Weighted { name, array, count, table: index } => {
                let table = table(*index);
                let sum = match language {
                    Language::C => format!("{prefix}_weighted({array}, {table}, {count})"),
                    Language::Cpp => format!("detail::weighted({array}, {table})"),
                    Language::Rust => format!("weighted(&{array}, &{table})"),
                    Language::Python => format!("_weighted({array}, {table})"),
                    Language::Matlab => format!("sum({array} .* {table})"),
                };
                vec![self.assigned(name, &sum)]
            }
            Statement::Scatter { axis, first, array, count, by } => {
                let (by, start) = (self.value(by), axis * self.numbers + first);
                vec![match language {
                    Language::C => format!("{prefix}_scatter({by}, {array}, {count}, &z[{start}]);"),
                    Language::Cpp => format!("detail::scatter({by}, {array}, {start}, z);"),
                    Language::Rust => format!("scatter({by}, &{array}, &mut z[{start}..]);"),
                    Language::Python => format!("z[{start}:{}] = [{by} * wave for wave in {array}]", start + count),
                    Language::Matlab => format!("z({}:{}) = {by} * {array};", start + 1, start + count),
                }]
            }
            Statement::Store { axis, index, value } => {
                let end = if language == Language::Python { "" } else { ";" };
                vec![format!("{} = {}{end}", place(*axis, *index), self.value(value))]
            }
            Statement::Squares { name, first, table: index } => {
                let Table { rows, columns, .. } = self.tables[*index];
                let table = table(*index);
                let sum = match language {
                    Language::C => format!("{prefix}_squares(z, {first}, {table}, {rows}, {columns})"),
                    Language::Cpp => format!("detail::squares(z, {first}, {table}, {rows}, {columns})"),
                    Language::Rust => format!("squares(&z, {first}, &{table}, {rows}, {columns})"),
                    Language::Python => format!("_squares(z, {first}, {table}, {rows}, {columns})"),
                    Language::Matlab => format!("squares(z, {first}, {table}, {rows}, {columns})"),
                };
                vec![self.assigned(name, &sum)]
            }
        }
    }

    fn function(&self, function: Function, of: &[String]) -> String {
        let language = self.options.language;
        if function == Function::Choice {
            let [a, b, first, second] = of else { return String::new() };
            return match language {
                Language::C | Language::Cpp => format!("(({a}) < ({b})) ? ({first}) : ({second})"),
                Language::Rust => format!("if ({a}) < ({b}) {{ {first} }} else {{ {second} }}"),
                Language::Python => format!("{first} if {a} < {b} else {second}"),
                Language::Matlab => format!("choice(({a}) < ({b}), {first}, {second})"),
            };
        }
        if function == Function::Inverse {
            return format!("{} / {}", self.number(1.0), of[0]);
        }
        let word = match (function, language) {
            (Function::Sine, _) => "sin",
            (Function::Cosine, _) => "cos",
            (Function::Arctangent, _) => "atan2",
            (Function::Root, _) => "sqrt",
            (Function::Exponential, _) => "exp",
            (Function::Size, Language::C) => "fabs",
            (Function::Size, _) => "abs",
            (Function::Most, Language::C) => "fmax",
            (Function::Least, Language::C) => "fmin",
            (Function::Most, _) => "max",
            (Function::Least, _) => "min",
            (Function::Inverse | Function::Choice, _) => "",
        };
        let all = of.join(", ");
        match (language, self.options.precision) {
            (Language::C, Precision::Single) => format!("{word}f({all})"),
            (Language::Cpp, _) => format!("std::{word}({all})"),
            (Language::Rust, _) => {
                let real = self.real();
                format!("{real}::{word}({all})")
            }
            _ => format!("{word}({all})"),
        }
    }
}
