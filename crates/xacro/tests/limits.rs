//! Documents that would never end, or fill the memory, end with an error, and soon.

use std::time::{Duration, Instant};

use denavit_xacro::{ErrorKind, Limits, Options, Source, expand};

use crate::support::{expand_body, expand_with, fixtures};

/// Far above what the limits allow for on a slow machine in a debug build, far below "for ever".
const SOON: Duration = Duration::from_secs(60);

fn ends_with_a_limit(body: &str) -> String {
    let start = Instant::now();
    let error = expand_body(body).expect_err("the document is a bomb");
    assert!(start.elapsed() < SOON, "{:?} for {body}", start.elapsed());
    assert_eq!(error.kind, ErrorKind::Limit, "{error}");
    assert!(error.place.is_some(), "{error}");
    error.message
}

#[test]
fn macros_that_call_themselves_for_ever() {
    let message = ends_with_a_limit("<xacro:macro name='m'><a><xacro:m/></a></xacro:macro><xacro:m/>");
    assert_eq!(message, "elements, macro calls and includes are nested more than 1000 deep");
    ends_with_a_limit(
        "<xacro:macro name='p'><xacro:q/></xacro:macro><xacro:macro name='q'><xacro:p/></xacro:macro><xacro:p/>",
    );
    let error = expand_body("<xacro:macro name='m'><xacro:m/></xacro:macro><xacro:m/>").unwrap_err().to_string();
    assert!(error.contains("more …") && error.lines().count() < 25, "{error}");
}

#[test]
fn macros_that_double_at_each_step() {
    let mut body = String::from("<xacro:macro name='m0'><a b='0123456789'/></xacro:macro>");
    for level in 1..40 {
        let below = level - 1;
        body += &format!("<xacro:macro name='m{level}'><xacro:m{below}/><xacro:m{below}/></xacro:macro>");
    }
    body += "<xacro:m39/>";
    assert_eq!(ends_with_a_limit(&body), "more than 1000000 nodes are produced");
}

#[test]
fn properties_that_double_at_each_step() {
    let mut body = String::from("<xacro:property name='p0' value='0123456789'/>");
    for level in 1..60 {
        let below = level - 1;
        body += &format!("<xacro:property name='p{level}' value='${{p{below}}}x${{p{below}}}'/>");
    }
    body += "<a b='${p59}'/>";
    ends_with_a_limit(&body);
    let lists = body.replace("'${p", "'${[p").replace("}x${p", ", p").replace("}'/>", "]}'/>");
    ends_with_a_limit(&lists);
}

#[test]
fn values_without_end() {
    for expression in [
        "range(10 ** 30)",
        "len(range(100000000000))",
        "'a' * 10 ** 12",
        "[0] * 10 ** 12",
        "'%1000000d' % 1",
        "9 ** 9 ** 9 ** 9",
        "2 ** 127",
        "1 &lt;&lt; 10 ** 9",
        "170141183460469231731687303715884105727 + 1",
        "[[i * j for i in range(100000)] for j in range(100000)]",
        "('a' * 10000000).replace('a', 'b' * 10000000)",
        "('a' * 1000000).join(['a'] * 1000000)",
        "'x'.zfill(10 ** 15)",
        "python.sum([i for i in range(10 ** 9)])",
        "(lambda f: f(f))(lambda f: f(f))",
        &format!("{}1{}", "(".repeat(500), ")".repeat(500)),
        &format!("{}1", "-".repeat(5000)),
        &format!("{}1", "1 + ".repeat(5000)),
        &format!("{}1", "not ".repeat(5000)),
        &format!("1{}", " ** 1".repeat(5000)),
        &format!("f{}", "(1)".repeat(5000)),
        &format!("{}1{}", "[".repeat(5000), "]".repeat(5000)),
    ] {
        let start = Instant::now();
        let error = expand_body(&format!("<a b=\"${{{expression}}}\"/>")).expect_err(expression);
        assert!(start.elapsed() < SOON, "{:?} for {expression}", start.elapsed());
        let refused = matches!(error.kind, ErrorKind::Limit | ErrorKind::Evaluation);
        assert!(refused, "{expression}: {error}");
    }
}

#[test]
fn sorting_what_has_no_order() {
    assert!(expand_body("<a b='${python.sorted([nan, 3, nan, 1, 2] * 20)}'/>").is_ok());
    let error =
        expand_body("<a b='${python.sorted([(nan, i) for i in range(100)] + [(1, nan)] * 100)}'/>").unwrap_err();
    assert_eq!(error.kind, ErrorKind::Evaluation);
    let error = expand_body("<a b='${python.sorted([1, 3, 2] * 30 + [\"a\"])}'/>").unwrap_err();
    assert_eq!(error.kind, ErrorKind::Evaluation);
}

#[test]
fn long_chains_of_properties() {
    let mut body = String::from("<xacro:property name='p0' value='${1}'/>");
    for level in 1..2000 {
        body += &format!("<xacro:property name='p{level}' value='${{p{} + 1}}'/>", level - 1);
    }
    ends_with_a_limit(&(body + "<a b='${p1999}'/>"));
}

#[test]
fn deep_documents() {
    let deep = format!("{}{}", "<a>".repeat(20_000), "</a>".repeat(20_000));
    ends_with_a_limit(&deep);
    let deep = format!("{}{}", "<a>".repeat(900), "</a>".repeat(900));
    assert!(expand_body(&deep).is_ok());
}

#[test]
fn entities_that_double_at_each_step() {
    let mut text = String::from("<!DOCTYPE r [<!ENTITY e0 'ha'>");
    for level in 1..30 {
        text += &format!("<!ENTITY e{level} '&e{};&e{};'>", level - 1, level - 1);
    }
    text += "]><r>&e29;</r>";
    let error = expand(&Source::text("bomb.xml", text), &[], &Options::default()).unwrap_err();
    assert_eq!(error.kind, ErrorKind::Xml, "{error}");
}

#[test]
fn files_that_include_themselves() {
    let error = expand(&Source::path(fixtures().join("errors/cycle.xacro")), &[], &Options::default()).unwrap_err();
    assert_eq!(error.kind, ErrorKind::Limit);
    assert!(error.message.starts_with("files are included more than 64 deep"), "{error}");
}

#[test]
fn yaml_without_end() {
    let folder = std::path::PathBuf::from(env!("CARGO_TARGET_TMPDIR"));
    let mut bomb = String::from("a0: &a0 [x, x]\n");
    for level in 1..60 {
        bomb += &format!("a{level}: &a{level} [*a{}, *a{}]\n", level - 1, level - 1);
    }
    let deep = format!("{}{}", "[".repeat(5000), "]".repeat(5000));
    for (name, yaml) in [("aliases.yaml", bomb), ("deep.yaml", deep)] {
        std::fs::write(folder.join(name), yaml).unwrap();
        let text = crate::support::robot(&format!("<a b='${{xacro.load_yaml(\"{name}\")}}'/>"));
        let source = Source::Text { name: "robot.xacro".to_owned(), text, folder: Some(folder.clone()) };
        let start = Instant::now();
        let error = expand(&source, &[], &Options::default()).unwrap_err();
        assert!(start.elapsed() < SOON);
        assert!(matches!(error.kind, ErrorKind::Limit | ErrorKind::Yaml), "{error}");
    }
}

#[test]
fn each_limit_can_be_set() {
    let body = "<xacro:macro name='m' params='n'><a/><xacro:if value='${n}'><xacro:m n='${n - 1}'/></xacro:if></xacro:macro><xacro:m n='20'/>";
    let full = Limits::default();
    assert!(expand_with(body, full.clone()).is_ok());
    for (limits, words) in [
        (Limits { depth: 30, ..full.clone() }, "nested more than 30 deep"),
        (Limits { nodes: 15, ..full.clone() }, "more than 15 nodes"),
        (Limits { bytes: 20, ..full.clone() }, "more than 20 bytes"),
        (Limits { steps: 50, ..full.clone() }, "more than 50 evaluation steps"),
    ] {
        let error = expand_with(body, limits).unwrap_err();
        assert_eq!(error.kind, ErrorKind::Limit);
        assert!(error.message.contains(words), "{error}");
    }
}
