//! Quick fixes: the certain fixes of the rules.

use crate::analysis::Problem;
use crate::diagnostics::diagnostic;
use crate::session::Session;
use crate::uri::uri_of;
use denavit_compare::lint::rule;
use gen_lsp_types::{CodeAction, CodeActionKind, Range, TextEdit, WorkspaceEdit};
use std::path::Path;

/// The fixes of problems in a range, and one fix for all of them in the file.
pub(crate) fn actions(session: &Session, path: &Path, range: Range, only: Option<&[String]>) -> Vec<CodeAction> {
    let Some(text) = session.files.text(path) else { return Vec::new() };
    let bytes = text.bytes(range);
    let problems: Vec<Problem> =
        session.problems_of(path).into_iter().filter(|problem| !problem.fix.is_empty()).collect();
    let wanted = |kind: &str| {
        only.is_none_or(|only| only.iter().any(|only| kind == only || kind.starts_with(&format!("{only}."))))
    };
    let edit = |problems: &[&Problem]| {
        let mut edits: Vec<TextEdit> = Vec::new();
        let mut fixes: Vec<_> = problems.iter().flat_map(|problem| &problem.fix).collect();
        fixes.sort_by_key(|(range, _)| (range.start, range.end));
        let mut end = 0;
        for (range, new) in fixes {
            // Of edits that overlap, the first.
            if range.start >= end {
                edits.push(TextEdit { range: text.range(range), new_text: new.clone() });
                end = range.end;
            }
        }
        WorkspaceEdit { changes: Some([(uri_of(path), edits)].into()), ..WorkspaceEdit::default() }
    };
    let mut found = Vec::new();
    let line = |at: usize| text.line_of(at);
    let near = |problem: &&Problem| {
        let on_lines = line(problem.at.range.start)..=line(problem.at.range.end);
        on_lines.contains(&line(bytes.start)) || bytes.contains(&problem.at.range.start)
    };
    if wanted("quickfix") {
        for problem in problems.iter().filter(near) {
            let name = problem.code.and_then(rule).map_or("", |rule| rule.name);
            let element = problem.message.split(": ").next().unwrap_or_default();
            let change = match &problem.fix[..] {
                [(range, new)] if !range.is_empty() && !new.is_empty() => {
                    format!("write {new} for {}", text.text.get(range.clone()).unwrap_or_default())
                }
                _ => format!("fix {name}"),
            };
            found.push(CodeAction {
                kind: Some(CodeActionKind::QuickFix),
                diagnostics: Some(vec![diagnostic(&session.files, problem)]),
                is_preferred: Some(true),
                title: format!("{element}: {change}"),
                edit: Some(edit(&[problem])),
                ..CodeAction::default()
            });
        }
    }
    if wanted("source.fixAll") && !problems.is_empty() {
        let all: Vec<&Problem> = problems.iter().collect();
        found.push(CodeAction {
            kind: Some(CodeActionKind::SourceFixAll),
            title: format!("Apply all {} safe fixes", all.len()),
            edit: Some(edit(&all)),
            ..CodeAction::default()
        });
    }
    found
}
