//! A program in a language.

use crate::batch;
use crate::effects::Effects;
use crate::inverse::{Class, Inverse};
use crate::program::{Factor, Program, Statement, Term, Value, needed};
use crate::render_effects::Shown;
use crate::spread::Table;
use denavit_model::chain::Quantity;
use denavit_model::nalgebra::Vector3;
use denavit_model::{CompiledChain, JacobianFrame};
use minijinja::{Environment, context};
use serde::Serialize;
use std::collections::BTreeSet;
use thiserror::Error;

/// A language.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Language {
    /// C99, a header.
    C,
    /// C++17, a header.
    Cpp,
    /// Rust, a module; no allocation.
    Rust,
    /// Python 3, a module; `math` alone.
    Python,
    /// MATLAB or Octave, a function file.
    Matlab,
}

/// Every language, its word and the file's extension.
pub const LANGUAGES: [(Language, &str, &str); 5] = [
    (Language::C, "c", "h"),
    (Language::Cpp, "cpp", "hpp"),
    (Language::Rust, "rust", "rs"),
    (Language::Python, "python", "py"),
    (Language::Matlab, "matlab", "m"),
];

/// Width of the numbers, where the language has a choice.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Precision {
    /// Eight bytes.
    #[default]
    Double,
    /// Four bytes.
    Single,
}

/// What is written.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options {
    /// In which language.
    pub language: Language,
    /// How wide numbers are.
    pub precision: Precision,
}

/// Why there is no code.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum CodeError {
    /// The table does not describe a chain.
    #[error(transparent)]
    Chain(#[from] denavit_model::ChainError),
    /// Nothing moves.
    #[error("nothing moves between \"{0}\" and \"{1}\"; choose another base and tip")]
    NothingMoves(String, String),
    /// The written code does not reproduce the effects that it was made from.
    #[error(
        "the code would miss the effects' own prediction by {0:.1e} m or rad; nothing is written; please report this bug"
    )]
    Disagrees(f64),
    /// The template cannot be filled in.
    #[error("the code could not be filled in: {0}")]
    Template(String),
}

impl Language {
    /// The word that names it.
    pub fn word(self) -> &'static str {
        self.entry().1
    }

    /// The extension of its file, without a point.
    pub fn extension(self) -> &'static str {
        self.entry().2
    }

    fn entry(self) -> &'static (Self, &'static str, &'static str) {
        LANGUAGES.iter().find(|(language, ..)| *language == self).expect("every language is in the list")
    }

    pub(crate) fn template_of_effects(self) -> &'static str {
        match self {
            Self::C => include_str!("../templates/effects/c.jinja"),
            Self::Cpp => include_str!("../templates/effects/cpp.jinja"),
            Self::Rust => include_str!("../templates/effects/rust.jinja"),
            Self::Python => include_str!("../templates/effects/python.jinja"),
            Self::Matlab => include_str!("../templates/effects/matlab.jinja"),
        }
    }

    fn template(self) -> &'static str {
        match self {
            Self::C => include_str!("../templates/c.jinja"),
            Self::Cpp => include_str!("../templates/cpp.jinja"),
            Self::Rust => include_str!("../templates/rust.jinja"),
            Self::Python => include_str!("../templates/python.jinja"),
            Self::Matlab => include_str!("../templates/matlab.jinja"),
        }
    }
}

/// Postures of the self-test.
const POSTURES: usize = 4;

#[derive(Serialize)]
struct Case {
    q: Vec<String>,
    pose: Vec<Vec<String>>,
    jacobian: Vec<Vec<String>>,
}

/// The constants of a closed form, as the language writes them.
#[derive(Serialize)]
struct InverseShown {
    wrist: bool,
    axes: Vec<[String; 3]>,
    points: Vec<[String; 3]>,
    /// tip_from_base at zero, three rows.
    tip_from_base: Vec<Vec<String>>,
    centre: [String; 3],
    side: [String; 3],
    /// From the point of axis 3 to what the elbow carries, and to the point of axis 2; half the sum of their squares.
    forearm: [String; 3],
    upper: [String; 3],
    half_squares: String,
    /// What the centre has along axis 2, from the point of axis 1.
    level: String,
    third: String,
    fourth: String,
    slack: String,
    reached: String,
    same: String,
}

#[derive(Serialize)]
struct CoordinateShown {
    index: usize,
    name: String,
    unit: &'static str,
}

/// The code of a table's chain.
///
/// # Shape and units
/// Poses are base_from_tip (m), joint values rad or m in the order of the table's coordinates; the Jacobian's columns are twists in
/// the frame of the base's orientation at the tip's origin, angular rows first.
///
/// # Errors
/// The table stands for no chain, or nothing in it moves.
pub fn code(table: &denavit_dh::Table, options: Options) -> Result<String, CodeError> {
    code_with(table, None, options)
}

/// The same with effects: functions `fk_with_effects` and `command_from_target`.
///
/// # Errors
/// As [`code`]; and the code does not give the poses of the effects' cases.
pub fn code_with_effects(table: &denavit_dh::Table, effects: &Effects, options: Options) -> Result<String, CodeError> {
    code_with(table, Some(effects), options)
}

fn code_with(table: &denavit_dh::Table, effects: Option<&Effects>, options: Options) -> Result<String, CodeError> {
    let chain = table.chain()?;
    if table.coordinates.is_empty() {
        return Err(CodeError::NothingMoves(table.base.clone(), table.tip.clone()));
    }
    let program = Program::of(table);
    let writer = Writer { options, prefix: identifier(&table.name), tables: Vec::new(), numbers: 0, lanes: None };
    let effects = effects.map(|effects| Shown::of(effects, &writer)).transpose()?;
    let pose: Vec<&Value> = program.pose.iter().flatten().collect();
    let jacobian: Vec<&Value> = program.jacobian.iter().flatten().collect();
    let for_pose: Vec<&Statement> = program.pose_statements.iter().collect();
    let for_jacobian: Vec<&Statement> = program.pose_statements.iter().chain(&program.jacobian_statements).collect();
    let for_pose = needed(&for_pose, &pose);
    let for_jacobian = needed(&for_jacobian, &jacobian);
    let compiled = CompiledChain::new(&chain);
    let ranges: Vec<(f64, f64)> = chain.coordinates().iter().map(denavit_model::Coordinate::range).collect();
    let cases: Vec<Case> = (0..POSTURES)
        .map(|index| {
            let q = posture(&ranges, index);
            let matrix = chain.fk(&q).to_homogeneous();
            let mut columns = vec![0.0; 6 * q.len()];
            compiled.jacobians_into(JacobianFrame::Tip, &q, &mut columns);
            Case {
                q: q.iter().map(|value| writer.number(*value)).collect(),
                pose: (0..3).map(|row| (0..4).map(|column| writer.number(matrix[(row, column)])).collect()).collect(),
                jacobian: columns
                    .chunks(q.len())
                    .map(|row| row.iter().map(|value| writer.number(*value)).collect())
                    .collect(),
            }
        })
        .collect();
    let coordinates: Vec<CoordinateShown> = table
        .coordinates
        .iter()
        .enumerate()
        .map(|(index, coordinate)| CoordinateShown {
            index,
            name: comment(&coordinate.name),
            unit: if coordinate.quantity == Quantity::Length { "m" } else { "rad" },
        })
        .collect();
    let inverse = Inverse::of(&chain);
    let compiled_language = matches!(options.language, Language::C | Language::Cpp | Language::Rust);
    let batch = (compiled_language && options.precision == Precision::Double).then(|| {
        let writer = Writer {
            prefix: writer.prefix.clone(),
            tables: Vec::new(),
            lanes: Some(chain.coordinates().len()),
            ..writer
        };
        batch::Shown::of(&for_pose, &pose, &writer, chain.size())
    });
    let tolerance = match options.precision {
        Precision::Double => 1e-12,
        Precision::Single => 1e-4,
    };
    let mut environment = Environment::new();
    environment.set_auto_escape_callback(|_| minijinja::AutoEscape::None);
    environment
        .render_str(
            options.language.template(),
            context! {
                name => identifier(&table.name),
                upper => identifier(&table.name).to_uppercase(),
                robot => comment(&table.name),
                base => comment(&table.base),
                tip => comment(&table.tip),
                n => table.coordinates.len(),
                real => writer.real(),
                suffix => if options.precision == Precision::Single { "f" } else { "" },
                coordinates => minijinja::Value::from(minijinja::value::Serde(coordinates)),
                batch => minijinja::Value::from(minijinja::value::Serde(batch)),
                for_pose => writer.lines(&for_pose, &pose),
                for_jacobian => writer.lines(&for_jacobian, &jacobian),
                pose => program.pose.iter().map(|row| row.iter().map(|v| writer.value(v)).collect::<Vec<_>>()).collect::<Vec<_>>(),
                jacobian => program.jacobian.iter().map(|row| row.iter().map(|v| writer.value(v)).collect::<Vec<_>>()).collect::<Vec<_>>(),
                multiplications => multiplications(&for_pose),
                jacobian_multiplications => multiplications(&for_jacobian),
                inverse => minijinja::Value::from(minijinja::value::Serde(
                    inverse.as_ref().ok().map(|inverse| writer.inverse(inverse, chain.size()))
                )),
                no_inverse => inverse.as_ref().err().copied(),
                cases => minijinja::Value::from(minijinja::value::Serde(cases)),
                effects => minijinja::Value::from(minijinja::value::Serde(effects)),
                tolerance => writer.number(tolerance * chain.size().max(1.0)),
            },
        )
        .map_err(|error| CodeError::Template(error.to_string()))
}

/// A posture of the self-test: the zero, then points spread over the ranges.
pub(crate) fn posture(ranges: &[(f64, f64)], index: usize) -> Vec<f64> {
    let place = |joint: usize| (0.618_033_988_749_895 * (index * 7 + joint + 1) as f64).fract();
    let value = |(joint, (lower, upper)): (usize, &(f64, f64))| {
        if index == 0 { 0.0 } else { lower + (upper - lower) * place(joint) }
    };
    // Few digits, so that the file is readable.
    ranges.iter().enumerate().map(value).map(|value| (value * 1e3).round() / 1e3).collect()
}

fn multiplications(statements: &[&Statement]) -> usize {
    let of = |terms: &[Term]| terms.iter().map(|term| term.factors.len() - 1).sum::<usize>();
    statements
        .iter()
        .map(|statement| match statement {
            Statement::Sum { terms, .. } => of(terms),
            Statement::SinCos { angle, .. } => of(angle),
            _ => 0,
        })
        .sum()
}

/// A name that is valid in every language.
fn identifier(name: &str) -> String {
    let letters: String = name
        .chars()
        .map(|letter| if letter.is_ascii_alphanumeric() { letter.to_ascii_lowercase() } else { '_' })
        .collect();
    let letters = letters.trim_matches('_');
    if letters.is_empty() || letters.starts_with(|letter: char| letter.is_ascii_digit()) {
        format!("robot_{letters}").trim_end_matches('_').to_owned()
    } else {
        letters.to_owned()
    }
}

/// A text that ends no comment and no string of any language.
pub fn comment(text: &str) -> String {
    let safe = |letter: char| letter.is_alphanumeric() || " ._-+()[]°".contains(letter);
    text.chars().map(|letter| if safe(letter) { letter } else { '_' }).collect()
}

/// Writes values and statements in a language.
pub struct Writer {
    pub options: Options,
    /// What stands before the names of the file's functions in C.
    pub prefix: String,
    /// Numbers that functions look up, and how long the rows of z are.
    pub tables: Vec<Table>,
    pub numbers: usize,
    /// How many joint values a posture has, where the code runs over many of them.
    pub lanes: Option<usize>,
}

impl Writer {
    pub fn real(&self) -> &'static str {
        match (self.options.language, self.options.precision) {
            (Language::Rust, Precision::Double) => "f64",
            (Language::Rust, Precision::Single) => "f32",
            (_, Precision::Double) => "double",
            (_, Precision::Single) => "float",
        }
    }

    pub fn is_c(&self) -> bool {
        matches!(self.options.language, Language::C | Language::Cpp)
    }

    /// A number as the language writes it, every digit kept.
    pub fn number(&self, number: f64) -> String {
        let number = number + 0.0;
        let mut text = match self.options.precision {
            Precision::Double => format!("{number:?}"),
            #[allow(clippy::cast_possible_truncation, reason = "four bytes are what is asked for")]
            Precision::Single => format!("{:?}", number as f32),
        };
        if self.is_c() && self.options.precision == Precision::Single {
            text.push('f');
        }
        text
    }

    fn inverse(&self, inverse: &Inverse, size: f64) -> InverseShown {
        let vector = |vector: Vector3<f64>| [0, 1, 2].map(|row| self.number(vector[row]));
        let Inverse { axes, points, .. } = inverse;
        let wrist = inverse.class == Class::SphericalWrist;
        let carried = if wrist { inverse.centre } else { points[3] };
        let forearm = carried - points[2];
        let upper = points[1] - points[2];
        let tip_from_base = inverse.home.inverse().to_homogeneous();
        // A root whose square is negative by rounding alone is 0; the self-test's bounds for solutions.
        let (slack, reached, same) = match self.options.precision {
            Precision::Double => (1e-12, 1e-9, 1e-6),
            Precision::Single => (1e-5, 2e-3, 2e-2),
        };
        InverseShown {
            wrist,
            axes: axes.iter().map(|axis| vector(*axis)).collect(),
            points: points.iter().map(|point| vector(*point)).collect(),
            tip_from_base: (0..3)
                .map(|row| (0..4).map(|column| self.number(tip_from_base[(row, column)])).collect())
                .collect(),
            centre: vector(inverse.centre),
            side: vector(inverse.side),
            forearm: vector(forearm),
            upper: vector(upper),
            half_squares: self.number(0.5 * (forearm.norm_squared() + upper.norm_squared())),
            level: self.number(axes[1].dot(&(inverse.centre - points[0]))),
            third: self.number(inverse.along[0]),
            fourth: self.number(inverse.along[1]),
            slack: self.number(slack),
            reached: self.number(reached * size.max(1.0)),
            same: self.number(same),
        }
    }

    fn coordinate(&self, index: usize) -> String {
        match (self.options.language, self.lanes) {
            (Language::Matlab, _) => format!("q({})", index + 1),
            (Language::C, Some(values)) => format!("q[{values} * lane + {index}]"),
            (_, Some(_)) => format!("q[lane][{index}]"),
            (_, None) => format!("q[{index}]"),
        }
    }

    pub fn value(&self, value: &Value) -> String {
        match value {
            Value::Number(number) => self.number(*number),
            Value::Name { negative, name } => format!("{}{}", if *negative { "-" } else { "" }, self.name(name)),
        }
    }

    /// A name, or a place of an array such as `pose[0][3]`.
    pub fn name(&self, name: &str) -> String {
        match name.split_once('[') {
            Some((array, places)) if self.options.language == Language::Matlab => {
                let places = places.trim_end_matches(']').split("][");
                let places =
                    places.map(|place| place.parse().map_or_else(|_| place.to_owned(), |k: usize| (k + 1).to_string()));
                format!("{array}({})", places.collect::<Vec<_>>().join(", "))
            }
            _ => name.to_owned(),
        }
    }

    pub fn sum(&self, terms: &[Term]) -> String {
        match (self.options.language, self.lanes) {
            // rustc, unlike gcc, never fuses a product and a sum by itself.
            (Language::Rust, Some(_)) => self.multiply_adds(terms),
            _ => self.plain_sum(terms.iter()),
        }
    }

    /// A sum that adds each product to what comes before it by `multiply_add`.
    fn multiply_adds(&self, terms: &[Term]) -> String {
        let (mut products, mut rest): (Vec<&Term>, Vec<&Term>) = terms.iter().partition(|term| term.factors.len() > 1);
        if rest.is_empty() {
            rest.push(products.remove(0));
        }
        products.into_iter().fold(self.plain_sum(rest.into_iter()), |sum, term| {
            let factors = self.factors(term);
            let (last, others) = factors.split_last().expect("a product");
            let sign = if term.negative { "-" } else { "" };
            format!("multiply_add({sign}{}, {last}, {sum})", others.join(" * "))
        })
    }

    fn plain_sum<'t>(&self, terms: impl Iterator<Item = &'t Term>) -> String {
        let mut text = String::new();
        for (index, term) in terms.enumerate() {
            text.push_str(match (index, term.negative) {
                (0, true) => "-",
                (0, false) => "",
                (_, true) => " - ",
                (_, false) => " + ",
            });
            text.push_str(&self.factors(term).join(" * "));
        }
        text
    }

    fn factors(&self, term: &Term) -> Vec<String> {
        let factor = |factor: &Factor| match factor {
            Factor::Number(number) => self.number(*number),
            Factor::Name(name) => self.name(name),
            Factor::Coordinate(index) => self.coordinate(*index),
        };
        term.factors.iter().map(factor).collect()
    }

    /// Statements, one a line; of a sine and a cosine only what others or the outputs read.
    pub fn lines(&self, statements: &[&Statement], outputs: &[&Value]) -> Vec<String> {
        let by_others = statements.iter().flat_map(|statement| statement.reads());
        let read: BTreeSet<&str> = by_others.chain(outputs.iter().filter_map(|value| value.name())).collect();
        let mut lines = Vec::new();
        for statement in statements {
            match statement {
                Statement::Sum { name, terms } => lines.push(self.assigned(name, &self.sum(terms))),
                Statement::SinCos { sine, cosine, angle } => {
                    let angle = self.sum(angle);
                    for (name, function) in [(sine, "sin"), (cosine, "cos")] {
                        if read.contains(name.as_str()) {
                            lines.push(self.assigned(name, &self.called(function, &angle)));
                        }
                    }
                }
                other => lines.extend(self.line_of_effects(other)),
            }
        }
        lines
    }

    fn called(&self, function: &str, angle: &str) -> String {
        match (self.options.language, self.options.precision) {
            (Language::C, Precision::Single) => format!("{function}f({angle})"),
            (Language::Cpp, _) => format!("std::{function}({angle})"),
            (Language::Rust, _) => format!("({angle}).{function}()"),
            _ => format!("{function}({angle})"),
        }
    }

    pub fn assigned(&self, name: &str, value: &str) -> String {
        match self.options.language {
            Language::C | Language::Cpp => format!("const {} {name} = {value};", self.real()),
            Language::Rust => format!("let {name} = {value};"),
            Language::Python => format!("{name} = {value}"),
            Language::Matlab => format!("{name} = {value};"),
        }
    }
}
