//! Rules and their examples.

use denavit_compare::lint::{Config, Finding, Lookup, RULES, Rule, check, fails, fix, page, rule};
use denavit_model::settings::{Shown, shown};
use std::fmt::Write as _;
use std::path::Path;

fn robot(content: &str) -> String {
    format!("<robot name=\"example\">\n{content}\n</robot>\n")
}

/// Rules of other formats are compared with their examples where those formats are read.
fn is_urdf(rule: &Rule) -> bool {
    !rule.bad.starts_with("<mujoco") && !rule.bad.starts_with("<sdf")
}

/// Only the mesh of the corrected example is there.
fn lookup(name: &str) -> Lookup {
    if name.contains("bsae") { Lookup::NotFound("looked in meshes/".into()) } else { Lookup::Found }
}

fn codes(text: &str) -> Vec<&'static str> {
    check("example.urdf", text, &lookup, &Config::default()).iter().map(|finding| finding.rule).collect()
}

#[test]
fn each_rule_finds_its_bad_example_and_not_its_good_one() {
    for rule in RULES.iter().filter(|rule| is_urdf(rule)) {
        let (bad, good) = (codes(&robot(rule.bad)), codes(&robot(rule.good)));
        assert!(bad.contains(&rule.code), "{rule:?}: {bad:?}");
        assert!(!good.contains(&rule.code), "{rule:?}: {good:?}");
    }
}

#[test]
fn fixable_rules_turn_the_bad_example_into_the_good_one() {
    for rule in RULES.iter().filter(|rule| is_urdf(rule)) {
        let text = robot(rule.bad);
        let findings = check("example.urdf", &text, &lookup, &Config::default());
        let own: Vec<Finding> = findings.into_iter().filter(|finding| finding.rule == rule.code).collect();
        let (fixed, made) = fix(&text, &own);
        assert_eq!(made > 0, rule.fixable, "{rule:?}");
        if rule.fixable {
            assert_eq!(fixed, robot(rule.good), "{rule:?}");
        }
    }
}

#[test]
fn fixes_fall_in_the_right_place_behind_dropped_and_declared_text() {
    let text = "\n<?xml version=\"1.0\"?>\n<robot name=\"r\"><a:b/><link name=\"x\"/><link name=\"y\"/>\
                <joint name=\"j\" type=\"continuous\"><axis xyz=\"0 0 2\"/><parent link=\"x\"/><child link=\"y\"/></joint></robot>";
    let findings = check("r.urdf", text, &lookup, &Config::default());
    let (fixed, made) = fix(text, &findings);
    assert_eq!((made, fixed), (1, text.replace("0 0 2", "0 0 1")));
}

#[test]
fn numbers_and_names_are_unique_and_in_order() {
    for pair in RULES.windows(2) {
        assert!(pair[0].code < pair[1].code, "{pair:?}");
    }
    for rule in RULES {
        assert_eq!(RULES.iter().filter(|other| other.name == rule.name).count(), 1, "{rule:?}");
    }
}

#[test]
fn the_page_is_up_to_date() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/rules.md");
    let page = shown(&page(), Shown::CommandLine).into_owned();
    if std::env::var_os("UPDATE_PAGES").is_some() {
        std::fs::write(&path, &page).unwrap();
    }
    let written = std::fs::read_to_string(&path).unwrap();
    assert!(written == page, "docs/rules.md is not what the list of rules says; run the tests with UPDATE_PAGES=1");
}

#[test]
fn rules_are_allowed_and_denied_by_number_and_name() {
    let mut config = Config::default();
    config.allow(&["all"]).unwrap();
    config.deny(&["axis-missing"]).unwrap();
    let text = robot(rule("axis-missing").unwrap().bad);
    let findings = check("example.urdf", &text, &lookup, &config);
    assert_eq!(findings.len(), 1);
    assert!(fails(&findings));
    let error = config.allow(&["axis-mising"]).unwrap_err();
    assert_eq!(error.to_string(), "there is no rule \"axis-mising\"; did you mean \"axis-missing\"?");
}

#[test]
fn an_unreadable_file_has_findings_with_lines() {
    let findings = check("r.urdf", "<robot name='r'>\n<<<<<<< HEAD\n</robot>", &lookup, &Config::default());
    let found: Vec<String> = findings.iter().map(ToString::to_string).collect();
    assert_eq!(found.len(), 1, "{found:?}");
    assert!(found[0].starts_with("r.urdf:2: D001 file: not well-formed XML"), "{found:?}");
    assert!(fails(&findings));
}

#[test]
fn an_arm_with_a_gripper_has_its_frame() {
    let arm = |ends: &str| {
        let mut text = String::new();
        for k in 0..4 {
            let _ = write!(
                text,
                "<link name=\"l{k}\"/><joint name=\"j{k}\" type=\"continuous\"><axis xyz=\"0 {} {}\"/><parent \
                 link=\"l{k}\"/><child link=\"l{}\"/></joint>",
                k % 2,
                1 - k % 2,
                k + 1
            );
        }
        text.push_str("<link name=\"l4\"/>");
        codes(&robot(&(text + ends))).contains(&"D070")
    };
    let hand =
        "<link name=\"hand\"/><joint name=\"mount\" type=\"fixed\"><parent link=\"l4\"/><child link=\"hand\"/></joint>";
    let finger = |name: &str, parent: &str| {
        format!(
            "<link name=\"{name}\"/><joint name=\"{name}_joint\" type=\"prismatic\"><axis xyz=\"1 0 0\"/><limit \
             lower=\"0\" upper=\"1\"/><parent link=\"{parent}\"/><child link=\"{name}\"/></joint>"
        )
    };
    assert!(arm(""));
    assert!(!arm(&[hand, &finger("a", "hand"), &finger("b", "hand")].concat()));
    assert!(!arm(&[hand, &finger("left_jaw", "hand")].concat()));
    assert!(arm(&finger("a", "l4")));
}
