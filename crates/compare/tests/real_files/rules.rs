//! The rules, held against every file of the corpus, readable or not.

use crate::real_files::support::vendor;
use denavit_compare::lint::{Config, Lookup, RULES, check, fix, rule};

fn unknown(_: &str) -> Lookup {
    Lookup::Unknown
}

#[test]
fn fixes_fix_what_they_say_and_break_nothing_else() {
    let texts = vendor::texts();
    assert!(!texts.is_empty(), "robots/ holds some at least");
    let mut counts = vec![(0, 0, String::new()); RULES.len()];
    for (file, text) in &texts {
        let findings = check(file, text, &unknown, &Config::default());
        let mut last = None;
        for finding in &findings {
            let index = RULES.iter().position(|rule| rule.code == finding.rule).unwrap();
            counts[index].0 += 1;
            counts[index].1 += usize::from(last != Some(finding.rule));
            last = Some(finding.rule);
            if std::env::var("SHOW").is_ok_and(|show| show == finding.rule) {
                println!("{finding}");
            }
            if counts[index].2.is_empty() {
                counts[index].2 = finding.to_string();
            }
        }
        let (fixed, made) = fix(text, &findings);
        let left = check(file, &fixed, &unknown, &Config::default());
        let fixable = left.iter().filter(|finding| !finding.fix.is_empty()).count();
        assert_eq!(fixable, 0, "{file}: {made} fixes made");
        let others = |findings: &[denavit_compare::Finding]| {
            let hand = |code: &str| rule(code).is_some_and(|rule| !rule.fixable && rule.name != "nearly-parallel");
            findings.iter().filter(|finding| hand(finding.rule)).count()
        };
        assert_eq!(others(&findings), others(&left), "{file}");
    }
    println!("{} files", texts.len());
    for (rule, (findings, _, example)) in RULES.iter().zip(&counts) {
        println!("{} {:22} {findings:5}  {example}", rule.code, rule.name);
    }
}
