//! What the user reads when something is wrong, word for word.

use denavit_xacro::{ErrorKind, FileAccess, Frame, Options, Source, XacroError, expand};

use crate::support::{expand_body, fixtures, packages_in, without_folders};

fn failure(body: &str) -> XacroError {
    expand_body(body).expect_err("the body is wrong")
}

fn message(body: &str) -> String {
    failure(body).to_string()
}

fn file_failure(name: &str) -> XacroError {
    let file = fixtures().join("errors").join(name);
    expand(&Source::path(file), &[], &packages_in(&fixtures())).expect_err("the file is wrong")
}

fn file_message(name: &str) -> String {
    without_folders(&file_failure(name).to_string())
}

#[test]
fn names_that_are_not_defined() {
    insta::assert_snapshot!(message("<a b='1 ${lenght}'/><xacro:property name='length' value='1'/>"), @r#"
robot.xacro:2:11: "lenght" is not defined
 2 | <a b='1 ${lenght}'/><xacro:property name='length' value='1'/>
   |           ^^^^^^
"#);
    insta::assert_snapshot!(message("<xacro:property name='length' value='1'/>\n<a b='${2 * lenght + 1}'/>"), @r#"
robot.xacro:3:13: "lenght" is not defined; did you mean "length"?
 3 | <a b='${2 * lenght + 1}'/>
   |             ^^^^^^
"#);
    insta::assert_snapshot!(message("<a b='${sinus(1)}'/>"), @r#"
robot.xacro:2:9: "sinus" is not defined
 2 | <a b='${sinus(1)}'/>
   |         ^^^^^
"#);
    insta::assert_snapshot!(message("<a b='${math.sinus(1)}'/>"), @r#"
robot.xacro:2:9: "math" has no "sinus"
 2 | <a b='${math.sinus(1)}'/>
   |         ^^^^^^^^^^
"#);
    insta::assert_snapshot!(message("<xacro:arg name='size' default='1'/><a b='${size}'/>"), @r#"
robot.xacro:2:45: "size" is not defined; the argument of that name is $(arg size)
 2 | <xacro:arg name='size' default='1'/><a b='${size}'/>
   |                                             ^^^^
"#);
    insta::assert_snapshot!(message("<a b='${open(1)} ${__import__}'/>"), @r#"
robot.xacro:2:9: "open" is not defined
 2 | <a b='${open(1)} ${__import__}'/>
   |         ^^^^
"#);
    insta::assert_snapshot!(message("<xacro:insert_block name='origin'/>"), @r#"
robot.xacro:2:27: there is no block "origin"; a block is a macro's parameter "*origin" or "**origin"
 2 | <xacro:insert_block name='origin'/>
   |                           ^^^^^^
"#);
}

#[test]
fn arguments_environment_and_packages() {
    insta::assert_snapshot!(message("<xacro:arg name='prefix' default=''/><a b='$(arg prefx)'/>"), @r#"
robot.xacro:2:44: the argument "prefx" has no value; did you mean "prefix"?
 2 | <xacro:arg name='prefix' default=''/><a b='$(arg prefx)'/>
   |                                            ^^^^^^^^^^^^
"#);
    insta::assert_snapshot!(message("<a b='$(arg tip)'/>"), @r#"
robot.xacro:2:7: the argument "tip" has no value; give it as tip:=value, or declare <xacro:arg name="tip" default="…"/> before
 2 | <a b='$(arg tip)'/>
   |       ^^^^^^^^^^
"#);
    insta::assert_snapshot!(message("<a b='$(env DENAVIT_NO_SUCH)'/>"), @r#"
robot.xacro:2:7: the environment variable "DENAVIT_NO_SUCH" is not set; set it, or write $(optenv DENAVIT_NO_SUCH default)
 2 | <a b='$(env DENAVIT_NO_SUCH)'/>
   |       ^^^^^^^^^^^^^^^^^^^^^^
"#);
    insta::assert_snapshot!(message("<a b='$(find no_such_package)/x'/>"), @r#"
robot.xacro:2:7: package "no_such_package" is not found; there are no folders to search; give the folder that holds it with ‹package-path›, or set ROS_PACKAGE_PATH
 2 | <a b='$(find no_such_package)/x'/>
   |       ^^^^^^^^^^^^^^^^^^^^^^^
"#);
    insta::assert_snapshot!(message("<a b='$(find ../../etc)/x'/>"), @r#"
robot.xacro:2:7: "../../etc" is not a package name; write letters, digits, "_" and "-" only
 2 | <a b='$(find ../../etc)/x'/>
   |       ^^^^^^^^^^^^^^^^^
"#);
    insta::assert_snapshot!(message("<a b='$(command ls)'/>"), @r"
robot.xacro:2:7: $(command …) is never executed; pass the value as an argument: name:=value
 2 | <a b='$(command ls)'/>
   |       ^^^^^^^^^^^^^
");
    insta::assert_snapshot!(message("<a b='$(anon node)'/>"), @r"
robot.xacro:2:7: $(anon …) is never executed; pass the value as an argument: name:=value
 2 | <a b='$(anon node)'/>
   |       ^^^^^^^^^^^^
");
    insta::assert_snapshot!(message("<a b='$(arm_id)_link'/>"), @r"
robot.xacro:2:7: $(arm_id …) is not known; there are $(arg …), $(find …), $(env …), $(optenv …), $(dirname), $(cwd) and $(eval …)
 2 | <a b='$(arm_id)_link'/>
   |       ^^^^^^^^^
");
    insta::assert_snapshot!(message("<a b='$(arg a b)'/>"), @r"
robot.xacro:2:7: $(arg …) takes one name, not 2; there are $(arg …), $(find …), $(env …), $(optenv …), $(dirname), $(cwd) and $(eval …)
 2 | <a b='$(arg a b)'/>
   |       ^^^^^^^^^^
");
    insta::assert_snapshot!(message("<a b='$(eval 1 + undefined)'/>"), @r#"
robot.xacro:2:7: "undefined" is not defined here
 2 | <a b='$(eval 1 + undefined)'/>
   |       ^^^^^^^^^^^^^^^^^^^^^
  in the expression: 1 + undefined
"#);
}

#[test]
fn expressions_that_cannot_be_read() {
    insta::assert_snapshot!(message("<a b='${1 +}'/>"), @r"
robot.xacro:2:12: the expression ends too early
 2 | <a b='${1 +}'/>
   |            ^
");
    insta::assert_snapshot!(message("<a b='${}'/>"), @r"
robot.xacro:2:9: the expression is empty
 2 | <a b='${}'/>
   |         ^
");
    insta::assert_snapshot!(message("<a b='${(1, 2}'/>"), @r#"
robot.xacro:2:14: the expression ends too early; ")" is expected here
 2 | <a b='${(1, 2}'/>
   |              ^
"#);
    insta::assert_snapshot!(message("<a b='${a = 1}'/>"), @r#"
robot.xacro:2:11: "=" is not expected here; compare with "=="
 2 | <a b='${a = 1}'/>
   |           ^
"#);
    insta::assert_snapshot!(message("<a b='${1 if 2}'/>"), @r#"
robot.xacro:2:15: the expression ends too early; "else" is expected here
 2 | <a b='${1 if 2}'/>
   |               ^
"#);
    insta::assert_snapshot!(message("<a b='${\"open}'/>"), @r#"
robot.xacro:2:9: this text has no closing quote
 2 | <a b='${"open}'/>
   |         ^^^^^
"#);
    insta::assert_snapshot!(message("<a b='${1.2.3}'/>"), @r#"
robot.xacro:2:9: "1.2.3" is not a number
 2 | <a b='${1.2.3}'/>
   |         ^^^^^
"#);
    insta::assert_snapshot!(message("<a b='${007}'/>"), @r#"
robot.xacro:2:9: "007" is not a number; write integers without leading zeros
 2 | <a b='${007}'/>
   |         ^^^
"#);
    insta::assert_snapshot!(message("<a b='${a ? 1 : 2}'/>"), @r#"
robot.xacro:2:11: "?" has no meaning in an expression
 2 | <a b='${a ? 1 : 2}'/>
   |           ^
"#);
    insta::assert_snapshot!(message("<a b='${!a}'/>"), @r#"
robot.xacro:2:9: "!" has no meaning in an expression; write "not"
 2 | <a b='${!a}'/>
   |         ^
"#);
    insta::assert_snapshot!(message("<a b='1 ${2'/>"), @r#"
robot.xacro:2:9: "${2" is not valid; close "${" with "}" and "$(" with ")"; write "$$" for a literal dollar before a bracket
 2 | <a b='1 ${2'/>
   |         ^^^
"#);
    insta::assert_snapshot!(message("<a b='$(find x'/>"), @r#"
robot.xacro:2:7: "$(find x" is not valid; close "${" with "}" and "$(" with ")"; write "$$" for a literal dollar before a bracket
 2 | <a b='$(find x'/>
   |       ^^^^^^^^
"#);
    insta::assert_snapshot!(message("<a b='$$5'/>"), @r#"
robot.xacro:2:7: "$$" is not valid; close "${" with "}" and "$(" with ")"; write "$$" for a literal dollar before a bracket
 2 | <a b='$$5'/>
   |       ^^
"#);
}

#[test]
fn expressions_that_have_no_value() {
    insta::assert_snapshot!(message("<a b='${1 / (2 - 2)}'/>"), @r"
robot.xacro:2:9: division by zero
 2 | <a b='${1 / (2 - 2)}'/>
   |         ^^^^^^^^^^^
");
    insta::assert_snapshot!(message("<a b='${\"a\" + 1}'/>"), @r#"
robot.xacro:2:9: "+" does not work between the text "a" and the number 1; turn the number into text with str(…), or the text into a number with float(…)
 2 | <a b='${"a" + 1}'/>
   |         ^^^^^^^
"#);
    insta::assert_snapshot!(message("<xacro:property name='x' value='1 2 3'/>\n<a b='${-x}'/>"), @r#"
robot.xacro:3:9: "-" needs a number, not the text "1 2 3"
 3 | <a b='${-x}'/>
   |         ^^
"#);
    insta::assert_snapshot!(message("<xacro:property name='x' value='1 2 3'/>\n<a b='${sin(x)}'/>"), @r#"
robot.xacro:3:9: sin(): a number is expected, not the text "1 2 3"; turn the text into a number with float(…)
 3 | <a b='${sin(x)}'/>
   |         ^^^^^^
"#);
    insta::assert_snapshot!(message("<a b='${[1, 2][5]}'/>"), @r"
robot.xacro:2:9: index 5 is out of range: there are 2 items
 2 | <a b='${[1, 2][5]}'/>
   |         ^^^^^^^^^
");
    insta::assert_snapshot!(message("<a b='${dict(alpha=1)[\"alfa\"]}'/>"), @r#"
robot.xacro:2:9: there is no key "alfa"; the keys are alpha
 2 | <a b='${dict(alpha=1)["alfa"]}'/>
   |         ^^^^^^^^^^^^^^^^^^^^^
"#);
    insta::assert_snapshot!(message("<a b='${dict(alpha=1).omega}'/>"), @r#"
robot.xacro:2:9: there is no key "omega"; the keys are alpha
 2 | <a b='${dict(alpha=1).omega}'/>
   |         ^^^^^^^^^^^^^^^^^^^
"#);
    insta::assert_snapshot!(message("<a b='${sqrt(-1)}'/>"), @r"
robot.xacro:2:9: sqrt(): -1 is outside the domain of the function
 2 | <a b='${sqrt(-1)}'/>
   |         ^^^^^^^^
");
    insta::assert_snapshot!(message("<a b='${int(\"1.5\")}'/>"), @r#"
robot.xacro:2:9: the text "1.5" is not an integer; write int(float(…))
 2 | <a b='${int("1.5")}'/>
   |         ^^^^^^^^^^
"#);
    insta::assert_snapshot!(message("<a b='${\"a\" &lt; 1}'/>"), @r#"
robot.xacro:2:7: "<" does not work between the text "a" and the number 1
 2 | <a b='${"a" &lt; 1}'/>
   |       ^^^^^^^^^^^^^
"#);
    insta::assert_snapshot!(message("<a b='${\"text\".reverse()}'/>"), @r#"
robot.xacro:2:9: the text "text" has no method "reverse"
 2 | <a b='${"text".reverse()}'/>
   |         ^^^^^^^^^^^^^^
"#);
    insta::assert_snapshot!(message("<a b='${sin}'/>"), @r"
robot.xacro:2:7: a function has no text to write into the document
 2 | <a b='${sin}'/>
   |       ^^^^^^
");
    insta::assert_snapshot!(message("<a b='${sin(1, 2)}'/>"), @r"
robot.xacro:2:9: sin(): 1 argument expected, 2 given
 2 | <a b='${sin(1, 2)}'/>
   |         ^^^^^^^^^
");
    insta::assert_snapshot!(message("<a b='${3(4)}'/>"), @r"
robot.xacro:2:9: the number 3 cannot be called
 2 | <a b='${3(4)}'/>
   |         ^^^^
");
    insta::assert_snapshot!(message("<a b='${xacro.fatal(\"give a\", \"tool\")}'/>"), @r#"
robot.xacro:2:9: give a tool
 2 | <a b='${xacro.fatal("give a", "tool")}'/>
   |         ^^^^^^^^^^^^^^^^^^^^^^^^^^^^^
"#);
    insta::assert_snapshot!(message("<xacro:property name='a' value='${b}'/><xacro:property name='b' value='${a + 1}'/>\n<c d='${a}'/>"), @r#"
robot.xacro:2:74: property "a" is defined in terms of itself: a → b → a; write lazy_eval="false" on the property to use the value that it had before
 2 | <xacro:property name='a' value='${b}'/><xacro:property name='b' value='${a + 1}'/>
   |                                                                          ^
  in the value of property "b", used at robot.xacro:2:35
  in the value of property "a", used at robot.xacro:3:9
"#);
}

#[test]
fn elements_that_are_used_in_a_wrong_way() {
    insta::assert_snapshot!(message("<xacro:macro name='wheel' params='radius'><w/></xacro:macro>\n<xacro:weel radius='1'/>"), @r#"
robot.xacro:3:2: there is no macro "weel"; did you mean "wheel"?
 3 | <xacro:weel radius='1'/>
   |  ^^^^^^^^^^
"#);
    insta::assert_snapshot!(message("<xacro:macro name='wheel' params='radius'><w/></xacro:macro>\n<xacro:wheel radus='1'/>"), @r#"
robot.xacro:3:14: the macro "wheel" has no parameter "radus"; did you mean "radius"?
 3 | <xacro:wheel radus='1'/>
   |              ^^^^^
"#);
    insta::assert_snapshot!(message("<xacro:macro name='wheel' params='radius width'><w/></xacro:macro>\n<xacro:wheel/>"), @r#"
robot.xacro:3:2: the macro "wheel" gets no value for "radius", "width"
 3 | <xacro:wheel/>
   |  ^^^^^^^^^^^
"#);
    insta::assert_snapshot!(message("<xacro:macro name='wheel' params='*origin'><w/></xacro:macro>\n<xacro:wheel/>"), @r#"
robot.xacro:3:2: the macro "wheel" needs a child element for its parameter "*origin"
 3 | <xacro:wheel/>
   |  ^^^^^^^^^^^
"#);
    insta::assert_snapshot!(message("<xacro:macro name='wheel'><w/></xacro:macro>\n<xacro:wheel>\n  <origin/>\n</xacro:wheel>"), @r#"
robot.xacro:4:4: the macro "wheel" has no block parameter for the child <origin>; the parameters for children are written "*name"
 4 |   <origin/>
   |    ^^^^^^
"#);
    insta::assert_snapshot!(message("<xacro:macro name='wheel' params='r:=^'><w/></xacro:macro>\n<xacro:wheel/>"), @r#"
robot.xacro:3:2: there is no property "r" to forward to the macro "wheel"
 3 | <xacro:wheel/>
   |  ^^^^^^^^^^^
"#);
    insta::assert_snapshot!(message("<xacro:macro name='a.b'/>"), @r#"
robot.xacro:2:20: "a.b" cannot be the name of a macro: "." separates namespaces
 2 | <xacro:macro name='a.b'/>
   |                    ^^^
"#);
    insta::assert_snapshot!(message("<xacro:macro params='x'/>"), @r#"
robot.xacro:2:2: <xacro:macro> has no attribute "name"; add name="…"
 2 | <xacro:macro params='x'/>
   |  ^^^^^^^^^^^
"#);
    insta::assert_snapshot!(message("<xacro:property name='two words' value='1'/>"), @r#"
robot.xacro:2:2: "two words" cannot be the name of a property; use letters, digits and "_"; do not start with a digit or "__", and do not use a Python keyword
 2 | <xacro:property name='two words' value='1'/>
   |  ^^^^^^^^^^^^^^
"#);
    insta::assert_snapshot!(message("<xacro:property name='class' value='1'/>"), @r#"
robot.xacro:2:2: "class" cannot be the name of a property; use letters, digits and "_"; do not start with a digit or "__", and do not use a Python keyword
 2 | <xacro:property name='class' value='1'/>
   |  ^^^^^^^^^^^^^^
"#);
    insta::assert_snapshot!(message("<xacro:property name='a' value='1' default='2'/>"), @r#"
robot.xacro:2:2: property "a" has more than one of value, default and remove
 2 | <xacro:property name='a' value='1' default='2'/>
   |  ^^^^^^^^^^^^^^
"#);
    insta::assert_snapshot!(message("<xacro:if value='maybe'/>"), @r#"
robot.xacro:2:18: the condition "maybe" is neither true nor false; write true, false, an integer, or a comparison in ${…}
 2 | <xacro:if value='maybe'/>
   |                  ^^^^^
"#);
    insta::assert_snapshot!(message("<xacro:property name='kind' value='sphere'/>\n<xacro:if value='${kind}'/>"), @r#"
robot.xacro:3:18: the condition "${kind}" is "sphere", which is neither true nor false; write true, false, an integer, or a comparison in ${…}
 3 | <xacro:if value='${kind}'/>
   |                  ^^^^^^^
"#);
    insta::assert_snapshot!(message("<xacro:if test='1'/>"), @r#"
robot.xacro:2:2: <xacro:if> has no attribute "value"; add value="…"
 2 | <xacro:if test='1'/>
   |  ^^^^^^^^
"#);
    insta::assert_snapshot!(message("<xacro:element xacro:name='${\"a b\"}'/>"), @r#"
robot.xacro:2:28: "a b" cannot be the name of an element
 2 | <xacro:element xacro:name='${"a b"}'/>
   |                            ^^^^^^^^
"#);
    insta::assert_snapshot!(message("<xacro:call/>"), @r#"
robot.xacro:2:2: <xacro:call> has no attribute "macro"; add macro="…"
 2 | <xacro:call/>
   |  ^^^^^^^^^^
"#);
    insta::assert_snapshot!(message("<xacro:unknown/>"), @r#"
robot.xacro:2:2: there is no macro "unknown"; define it, or include the file that does, before it is called
 2 | <xacro:unknown/>
   |  ^^^^^^^^^^^^^
"#);
}

#[test]
fn files_that_cannot_be_used() {
    insta::assert_snapshot!(message("<xacro:include filename='no_such_file.xacro'/>"), @r#"
robot.xacro:2:26: "no_such_file.xacro" cannot be read: there is no such file
 2 | <xacro:include filename='no_such_file.xacro'/>
   |                          ^^^^^^^^^^^^^^^^^^
"#);
    insta::assert_snapshot!(message("<a b='${xacro.load_yaml(\"no_such_file.yaml\")}'/>"), @r#"
robot.xacro:2:9: "no_such_file.yaml" cannot be read: there is no such file
 2 | <a b='${xacro.load_yaml("no_such_file.yaml")}'/>
   |         ^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^
"#);
    insta::assert_snapshot!(file_message("includes_broken.xacro"), @r"
errors/broken.xacro:3:1: this is not well-formed XML: expected 'link' tag, not 'robot'
 3 | </robot>
   | ^
  in errors/broken.xacro, included at errors/includes_broken.xacro:2:28
");
    insta::assert_snapshot!(file_message("no_such_file.xacro"), @r#""errors/no_such_file.xacro" cannot be read: there is no such file"#);
    let yaml = |name: &str| {
        let text = format!(
            "<robot xmlns:xacro='http://ros.org/wiki/xacro'>\n<a b='${{xacro.load_yaml(\"{name}\")}}'/></robot>"
        );
        let source = Source::Text { name: "robot.xacro".to_owned(), text, folder: Some(fixtures().join("errors")) };
        without_folders(&expand(&source, &[], &Options::default()).unwrap_err().to_string())
    };
    insta::assert_snapshot!(yaml("broken.yaml"), @r"
errors/broken.yaml:3:4: this is not well-formed YAML: while parsing a block collection, did not find expected '-' indicator
 3 |    b: [2
   |    ^
  in errors/broken.yaml, included at robot.xacro:2:9
");
    insta::assert_snapshot!(yaml("unit.yaml"), @r#"
errors/unit.yaml:1:9: the tag "!furlongs" is not known; the units are !radians, !degrees, !meters, !millimeters, !foot, !inches
 1 | length: !furlongs 3
   |         ^^^^^^^^^^^
  in errors/unit.yaml, included at robot.xacro:2:9
"#);
    insta::assert_snapshot!(yaml("expression.yaml"), @r"
errors/expression.yaml:1:8: the expression ends too early
 1 | angle: !degrees 90 +
   |        ^^^^^^^^^^^^^
  in errors/expression.yaml, included at robot.xacro:2:9
");
    insta::assert_snapshot!(message("<a"), @r"
robot.xacro:3:1: this is not well-formed XML: invalid name token
 3 | </robot>
   | ^
");
    insta::assert_snapshot!(message("<b:c/>"), @r"
robot.xacro:2:2: this is not well-formed XML: an unknown namespace prefix 'b'
 2 | <b:c/>
   |  ^
");
}

#[test]
fn the_way_to_an_error_is_shown() {
    insta::assert_snapshot!(file_message("outer.xacro"), @r#"
errors/macros.xacro:4:20: "axsi" is not defined; did you mean "axis"?
 4 |       <axis xyz="${axsi}"/>
   |                    ^^^^
  in macro "joint" (defined at errors/macros.xacro:2:4), called at errors/macros.xacro:8:6
  in macro "arm" (defined at errors/macros.xacro:7:4), called at errors/chain.xacro:4:4
  in errors/chain.xacro, included at errors/outer.xacro:2:28
"#);
    let error = file_failure("outer.xacro");
    assert_eq!(error.kind, ErrorKind::UndefinedName);
    let steps: Vec<&str> = error
        .stack
        .iter()
        .map(|frame| match frame {
            Frame::Macro { name, .. } => name.as_str(),
            Frame::Include { file, .. } => file.file_name().unwrap().to_str().unwrap(),
            _ => "?",
        })
        .collect();
    assert_eq!(steps, ["joint", "arm", "chain.xacro"]);
    insta::assert_snapshot!(message("<xacro:arg name='n' default='4'/>\n<a b='${$(arg n) / zero}'/>"), @r#"
robot.xacro:3:9: "zero" is not defined
 3 | <a b='${$(arg n) / zero}'/>
   |         ^^^^^^^^^^^^^^^
  in the expression: 4 / zero
"#);
    insta::assert_snapshot!(message("<a b='&lt;&amp;${1 + two}'/>\n"), @r#"
robot.xacro:2:22: "two" is not defined
 2 | <a b='&lt;&amp;${1 + two}'/>
   |                      ^^^
"#);
    insta::assert_snapshot!(message("<a b='ä ö\tü ${1 + two}'/>"), @r#"
robot.xacro:2:19: "two" is not defined
 2 | <a b='ä ö	ü ${1 + two}'/>
   |          	        ^^^
"#);
}

#[test]
fn files_are_read_only_where_they_may_be() {
    let body = format!("<xacro:include filename='{}/errors/macros.xacro'/>", fixtures().display());
    let text = crate::support::robot(&body);
    let source = Source::Text { name: "robot.xacro".to_owned(), text, folder: Some(fixtures().join("features/parts")) };
    let refused = expand(&source, &[], &Options::default()).unwrap_err();
    assert_eq!(refused.kind, ErrorKind::Access);
    // As many carets as the folder's name is long: one stands for them.
    let shown = without_folders(&refused.to_string());
    let carets = shown.chars().filter(|c| *c == '^').count();
    let shown = shown.replace(&"^".repeat(carets), "^");
    insta::assert_snapshot!(shown, @r#"
robot.xacro:2:26: "errors/macros.xacro" is outside the folders that may be read (features/parts); if you trust the document, allow any file, or add the folder to the package path
 2 | <xacro:include filename='errors/macros.xacro'/>
   |                          ^
"#);
    for access in [FileAccess::Any, FileAccess::Below(vec![fixtures().join("errors")])] {
        let options = Options { access, ..Options::default() };
        assert!(expand(&source, &[], &options).is_ok());
    }
    // Up and out of the folder that is open, by dots.
    let body = "<xacro:include filename='../../errors/macros.xacro'/>";
    let text = crate::support::robot(body);
    let source = Source::Text { name: "robot.xacro".to_owned(), text, folder: Some(fixtures().join("features/parts")) };
    assert_eq!(expand(&source, &[], &Options::default()).unwrap_err().kind, ErrorKind::Access);
}
