//! The list of rules as a page, and one rule explained; both are made from [`RULES`].

use crate::lint::{RULES, Rule};
use std::fmt::Write;

/// One rule in Markdown: what it finds, why that matters, a wrong example and the corrected one.
pub fn explain(rule: &Rule) -> String {
    let fix = if rule.fixable { "`‹fix›` fixes it" } else { "to be fixed by hand" };
    let mut out = format!("## {} {}\n\n", rule.code, rule.name);
    let _ = writeln!(out, "{}. *{}; {fix}.*\n\n{}\n", rule.summary, rule.level.word(), rule.why);
    let _ = writeln!(out, "```xml\n{}\n```\n", rule.bad.trim());
    let _ = writeln!(out, "Corrected:\n\n```xml\n{}\n```", rule.good.trim());
    out
}

/// Every rule in Markdown, a line each: the text of `docs/rules.md`.
pub fn page() -> String {
    let mut out = String::from(
        "# Rules of `denavit check`\n\n\
         Made from the list of rules (`denavit check ‹rules›`). [Explanations](ci.md#rules) have examples.\n\n\
         A finding of level *error* makes the exit code 1. `‹allow› RULE` leaves a rule out, `‹deny› RULE` makes its findings\n\
         errors; both take a number, a name or `all`, also in [`denavit.toml`](ci.md#denavittoml). `‹fix›` fixes the rules\n\
         marked *fixable*.\n\n",
    );
    for rule in RULES {
        let fixable = if rule.fixable { ", fixable" } else { "" };
        let Rule { code, name, summary, level, .. } = rule;
        let _ = writeln!(out, "- **{code} {name}** ({}{fixable}): {summary}.", level.word());
    }
    out
}
