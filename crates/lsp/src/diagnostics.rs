//! Problems as an editor shows them, and their certain fixes.

use crate::analysis::Problem;
use crate::session::Files;
use crate::uri::uri_of;
use denavit_compare::lint;
use denavit_compare::report::Level;
use gen_lsp_types::{
    Code, Diagnostic, DiagnosticRelatedInformation, DiagnosticSeverity, Location, Message, Position, Range,
};

/// The source of the diagnostics.
pub(crate) const SOURCE: &str = "denavit";

/// Problems of one file, in its present state.
pub(crate) fn diagnostics(files: &Files, problems: &[Problem]) -> Vec<Diagnostic> {
    problems.iter().map(|problem| diagnostic(files, problem)).collect()
}

pub(crate) fn diagnostic(files: &Files, problem: &Problem) -> Diagnostic {
    let range = |spot: &crate::analysis::Spot| {
        let start = Position { line: 0, character: 0 };
        files.text(&spot.file).map_or(Range { start, end: start }, |text| text.range(&spot.range))
    };
    let related: Vec<DiagnosticRelatedInformation> = problem
        .related
        .iter()
        .map(|(spot, message)| DiagnosticRelatedInformation {
            location: Location { uri: uri_of(&spot.file), range: range(spot) },
            message: message.clone(),
        })
        .collect();
    let name = problem.code.and_then(lint::rule).map(|rule| rule.name);
    Diagnostic {
        range: range(&problem.at),
        severity: Some(match problem.level {
            Level::Error => DiagnosticSeverity::Error,
            Level::Warning => DiagnosticSeverity::Warning,
            Level::Note => DiagnosticSeverity::Information,
        }),
        code: problem.code.map(|code| Code::String(name.map_or(code.to_owned(), |name| format!("{code} {name}")))),
        code_description: None,
        source: Some(SOURCE.to_owned()),
        message: Message::String(problem.message.clone()),
        tags: None,
        related_information: (!related.is_empty()).then_some(related),
        data: None,
    }
}
