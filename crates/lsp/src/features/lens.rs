//! The line above a robot: a summary, and the displacement of its tip since the last commit.

use crate::features::commands::{self, robot_of, sheet, table};
use crate::session::Session;
use crate::uri::{path_of, uri_of};
use denavit_compare::Verdict;
use gen_lsp_types::{CodeLens, Command, Uri};
use serde_json::json;
use std::path::Path;

/// A lens for the summary, computed when it becomes visible, and one for each command.
pub(crate) fn lenses(session: &Session, path: &Path) -> Vec<CodeLens> {
    let (Some(text), Some(markup)) = (session.files.text(path), session.files.markup(path)) else { return Vec::new() };
    let is_robot = session.robots_of(path).first().is_some_and(|analysis| analysis.file == path);
    let Some(root) = markup.tags.first().filter(|_| is_robot) else { return Vec::new() };
    let range = text.range(&root.name);
    let uri = uri_of(path);
    let argument = Some(vec![json!(uri)]);
    let command = |title: &str, own: &str, of_server: &str| Command {
        title: title.to_owned(),
        tooltip: None,
        command: if session.has_commands { own } else { of_server }.to_owned(),
        arguments: argument.clone(),
    };
    let mut found = vec![CodeLens { range, command: None, data: Some(json!(uri)) }];
    let mut add = |command| found.push(CodeLens { range, command: Some(command), data: None });
    add(command("show table", "denavit.showTable", commands::TABLE));
    add(command("compare with HEAD", "denavit.compareWithHead", commands::COMPARE));
    if session.has_commands {
        add(command("show explorer", "denavit.showExplorer", ""));
    }
    found
}

pub(crate) fn resolve(session: &Session, mut lens: CodeLens) -> CodeLens {
    let uri = lens.data.as_ref().and_then(|data| data.as_str()).map(Uri::from);
    if let (Some(uri), None) = (uri, &lens.command)
        && let Some(path) = path_of(&uri)
    {
        let command = if session.has_commands { "denavit.compareWithHead" } else { commands::COMPARE };
        lens.command = Some(Command {
            title: summary(session, &path),
            tooltip: None,
            command: command.to_owned(),
            arguments: Some(vec![json!(uri)]),
        });
    }
    lens
}

/// `6R, base → tool0, tip moved by at most 0.61 mm since HEAD`
fn summary(session: &Session, path: &Path) -> String {
    let robot = match robot_of(session, path) {
        Ok(robot) => robot,
        Err(why) => return why,
    };
    let shown = path.display().to_string();
    let what = match table(session, &robot, None) {
        Ok(made) => {
            let sheet = sheet(&made, &shown);
            format!("{}, {} → {}", sheet.kinds(), made.table.value.base, made.table.value.tip)
        }
        Err(why) => return why,
    };
    match against_head(session, path) {
        Some(words) => format!("{what}, {words}"),
        None => what,
    }
}

/// `None` if the file is in no commit.
fn against_head(session: &Session, path: &Path) -> Option<String> {
    let (comparison, _) = commands::with_head(session, path).ok()?;
    if comparison.verdict == Verdict::Same {
        return Some("same as HEAD".to_owned());
    }
    let farthest = comparison.tips.iter().max_by(|a, b| a.bound_m.total_cmp(&b.bound_m));
    let moved = farthest.filter(|tip| tip.bound_m > comparison.tolerance_m);
    Some(match moved {
        Some(tip) => {
            let millimetres = tip.bound_m * 1e3;
            let places = if millimetres < 10.0 { 2 } else { 0 };
            let which = if comparison.tips.len() > 1 { format!(" ({})", tip.tip) } else { String::new() };
            format!(
                "tip{which} moved by at most {} mm since HEAD",
                denavit_export::numbers::decimal(millimetres, places)
            )
        }
        None => "differs from HEAD, tips unchanged".to_owned(),
    })
}
