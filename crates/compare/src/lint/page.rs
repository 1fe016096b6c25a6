//! The list of rules as a page, and one rule explained: both made from [`RULES`].

use crate::lint::{RULES, Rule};
use std::fmt::Write;

/// One rule in Markdown: what it finds, why that matters, an example and its mend.
pub fn explain(rule: &Rule) -> String {
    let mend = if rule.fixable { "`‹fix›` fixes it" } else { "to be fixed by hand" };
    let mut out = format!("## {} {}\n\n", rule.code, rule.name);
    let _ = writeln!(out, "{}. *{}; {mend}.*\n\n{}\n", rule.summary, rule.level.word(), rule.why);
    let _ = writeln!(out, "```xml\n{}\n```\n", rule.bad.trim());
    let _ = writeln!(out, "Corrected:\n\n```xml\n{}\n```", rule.good.trim());
    out
}

/// Every rule in Markdown: the text of `docs/rules.md`.
pub fn page() -> String {
    let mut out = String::from(
        "# Rules of `denavit check`\n\n\
         This page is made from the list of rules (`denavit check ‹rules›`); the test `the_page_is_up_to_date` keeps it so.\n\n\
         A finding of level *error* makes the exit code 1. `‹allow› RULE` leaves a rule out, `‹deny› RULE` makes its\n\
         findings errors; both take a number, a name or `all`, and both may stand in a file `denavit.toml`:\n\n\
         ```toml\n[check]\nallow = [\"inertial-missing\"]\ndeny = [\"D010\"]\npackage-path = [\"..\"]\n```\n\n\
         | number | name | level | fix | finds |\n|---|---|---|---|---|\n",
    );
    for rule in RULES {
        let fix = if rule.fixable { "yes" } else { "" };
        let anchor = format!("{}-{}", rule.code.to_lowercase(), rule.name);
        let _ = writeln!(
            out,
            "| [{}](#{anchor}) | {} | {} | {fix} | {} |",
            rule.code,
            rule.name,
            rule.level.word(),
            rule.summary.replace('|', "\\|")
        );
    }
    for rule in RULES {
        out.push('\n');
        out.push_str(&explain(rule));
    }
    out
}
