//! Errors, with their place, the calls that led there and the expression.

use std::fmt;
use std::path::PathBuf;

use crate::place::{Place, Spot};

/// The kind of failure, for programs; people read the message.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum ErrorKind {
    /// A file could not be read.
    Read,
    /// A file outside the folders that may be read.
    Access,
    /// Text that is not well-formed XML.
    Xml,
    /// Text that is not well-formed YAML.
    Yaml,
    /// An expression that cannot be read.
    Syntax,
    /// An expression that cannot be evaluated: a wrong type, an index out of range, a division by zero.
    Evaluation,
    /// A property, function or block that is not defined.
    UndefinedName,
    /// A macro that is not defined.
    UndefinedMacro,
    /// An argument without value.
    UndefinedArgument,
    /// An environment variable that is not set.
    UndefinedVariable,
    /// A package that is not found.
    Package,
    /// A xacro element that is used in a wrong way.
    Element,
    /// A limit of [`crate::Limits`] was passed.
    Limit,
    /// `$(command …)` and `$(anon …)`, which are never executed.
    Refused,
    /// `xacro.fatal(…)`: the document itself gave up.
    Fatal,
}

/// One step of the chain of calls to an error, from the inside out.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub enum Frame {
    /// A macro was called.
    Macro {
        /// Name as called.
        name: String,
        /// Where it is defined.
        defined: Place,
        /// Where it was called.
        called: Place,
    },
    /// A file was included.
    Include {
        /// The file that was included.
        file: PathBuf,
        /// Where the include stands.
        at: Place,
    },
    /// A property was evaluated when it was first used.
    Property {
        /// Name of the property.
        name: String,
        /// Where it was used.
        used: Place,
    },
}

/// Why an expansion failed, and where.
///
/// `Display` shows everything: `place: what is wrong; the fix`, the line with the error underlined, and the chain
/// of calls and includes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct XacroError {
    /// What kind of failure.
    pub kind: ErrorKind,
    /// What is wrong, with the value.
    pub message: String,
    /// The fix, where there is one.
    pub help: Option<String>,
    /// Where; `None` if the failure is not in a file that was read.
    pub place: Option<Place>,
    /// The line at `place`, and the number of wrong characters from `place.column` on.
    pub line: Option<(String, usize)>,
    /// The expression after substitution, where it is not what is in the line.
    pub expression: Option<String>,
    /// Macro calls, includes and property uses that led there, the innermost first.
    pub stack: Vec<Frame>,
}

impl XacroError {
    pub(crate) fn new(kind: ErrorKind, message: impl Into<String>) -> Box<Self> {
        Box::new(Self {
            kind,
            message: message.into(),
            help: None,
            place: None,
            line: None,
            expression: None,
            stack: Vec::new(),
        })
    }

    pub(crate) fn help(mut self: Box<Self>, help: impl Into<String>) -> Box<Self> {
        self.help = Some(help.into());
        self
    }

    /// Sets the place, unless one further inside is known.
    pub(crate) fn at(mut self: Box<Self>, spot: &Spot) -> Box<Self> {
        if self.place.is_none() {
            let (line, covered) = spot.line();
            self.place = Some(spot.place());
            self.line = Some((line.to_owned(), covered));
        }
        self
    }

    pub(crate) fn within(mut self: Box<Self>, frame: Frame) -> Box<Self> {
        self.stack.push(frame);
        self
    }
}

impl std::error::Error for XacroError {}

/// Deeper chains are cut in the middle, since the ends matter.
const FRAMES_SHOWN_AT_EACH_END: usize = 6;
/// Longer lines are cut around the error.
const LINE_SHOWN: usize = 160;

impl fmt::Display for XacroError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(place) = &self.place {
            write!(formatter, "{place}: ")?;
        }
        formatter.write_str(&self.message)?;
        if let Some(help) = &self.help {
            write!(formatter, "; {help}")?;
        }
        if let (Some(place), Some((line, covered))) = (&self.place, &self.line) {
            underline(formatter, place, line, *covered)?;
        }
        if let Some(expression) = &self.expression {
            write!(formatter, "\n  in the expression: {expression}")?;
        }
        let hidden = self.stack.len().saturating_sub(2 * FRAMES_SHOWN_AT_EACH_END);
        for (index, frame) in self.stack.iter().enumerate() {
            if hidden > 0 && index == FRAMES_SHOWN_AT_EACH_END {
                write!(formatter, "\n  … {hidden} more …")?;
            }
            if hidden == 0 || index < FRAMES_SHOWN_AT_EACH_END || index >= self.stack.len() - FRAMES_SHOWN_AT_EACH_END {
                write!(formatter, "\n  {frame}")?;
            }
        }
        Ok(())
    }
}

fn underline(formatter: &mut fmt::Formatter<'_>, place: &Place, line: &str, covered: usize) -> fmt::Result {
    let before = place.column - 1;
    let start = before.saturating_sub(LINE_SHOWN / 2);
    let shown: String = line.chars().skip(start).take(LINE_SHOWN).collect();
    let number = place.line.to_string();
    let margin = " ".repeat(number.len());
    let space: String = shown.chars().take(before - start).map(|c| if c == '\t' { '\t' } else { ' ' }).collect();
    let carets = covered.min(shown.chars().count().saturating_sub(before - start)).max(1);
    write!(formatter, "\n {number} | {shown}\n {margin} | {space}{}", "^".repeat(carets))
}

impl fmt::Display for Frame {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Macro { name, defined, called } => {
                write!(formatter, "in macro \"{name}\" (defined at {defined}), called at {called}")
            }
            Self::Include { file, at } => {
                write!(formatter, "in {}, included at {at}", file.display())
            }
            Self::Property { name, used } => {
                write!(formatter, "in the value of property \"{name}\", used at {used}")
            }
        }
    }
}

/// The candidates that a wrong word may have meant, best first, three at most.
pub(crate) fn near<T: AsRef<str>>(word: &str, candidates: impl IntoIterator<Item = T>) -> Vec<String> {
    const ALIKE: f64 = 0.7;
    /// Words of more bytes are not compared: nobody types them, and the time grows with the product of the lengths.
    const LONGEST: usize = 255;
    let mut scored: Vec<(f64, String)> = candidates
        .into_iter()
        .filter(|candidate| word.len().max(candidate.as_ref().len()) <= LONGEST)
        .map(|candidate| {
            let candidate = candidate.as_ref();
            (strsim::normalized_damerau_levenshtein(word, candidate), candidate.to_owned())
        })
        .filter(|&(score, _)| score >= ALIKE)
        .collect();
    scored.sort_by(|a, b| b.0.total_cmp(&a.0).then_with(|| a.1.cmp(&b.1)));
    scored.dedup();
    scored.into_iter().take(3).map(|(_, name)| name).collect()
}

/// `did you mean "a" or "b"?`
pub(crate) fn did_you_mean(names: &[String]) -> Option<String> {
    let quoted: Vec<String> = names.iter().map(|name| format!("\"{name}\"")).collect();
    (!quoted.is_empty()).then(|| format!("did you mean {}?", quoted.join(" or ")))
}
