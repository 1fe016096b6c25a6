//! Whatever stands in a document is understood, carried into the result, or reported with its place.

use denavit_xacro::{Environment, Options, Source, expand};

use crate::support::{expand_body, robot};

/// Every element of xacro, each expanded, so that nothing in it is out of sight.
const WHOLE: &str = r#"<xacro:arg name="count" default="2"/>
<xacro:property name="length" value="0.5"/>
<xacro:property name="width" default="1"/>
<xacro:property name="block"><inner/></xacro:property>
<xacro:macro name="plain" params="a b:=1"><p a="${a}" b="${b}"/></xacro:macro>
<xacro:macro name="holds" params="*one **more"><q><xacro:insert_block name="one"/><xacro:insert_block name="more"/></q></xacro:macro>
<xacro:plain a="1"/>
<xacro:call macro="plain" a="2"/>
<xacro:holds><origin xyz="0 0 0"/><rest><r/></rest></xacro:holds>
<xacro:if value="true"><s/></xacro:if>
<xacro:unless value="0"><t><u/></t></xacro:unless>
<xacro:element xacro:name="v" w="1"/>
<x><xacro:attribute name="y" value="1"/></x>
<xacro:insert_block name="block"/>
"#;

/// What became of a document with something odd in it.
fn is_accounted_for(text: &str) -> Result<(), String> {
    match expand(&Source::text("robot.xacro", text), &[], &Options::default()) {
        // A name that stands somewhere else than in the result is none that the user sees.
        Ok(expanded) => {
            let noted = expanded.notes.iter().filter(|note| note.place.is_some());
            let mut said = noted.map(ToString::to_string).chain([expanded.urdf]);
            said.any(|text| text.contains("odd")).then_some(()).ok_or_else(|| "nothing is said".to_owned())
        }
        Err(error) => {
            let error = error.to_string();
            let is_placed = error.starts_with("robot.xacro:") && error.contains("odd");
            is_placed.then_some(()).ok_or(error)
        }
    }
}

#[test]
fn something_unknown_in_every_position_is_seen() {
    let whole = robot(WHOLE);
    assert!(expand_body(WHOLE).is_ok());
    let document = roxmltree::Document::parse(&whole).unwrap();
    let mut tried = 0;
    for node in document.descendants().filter(roxmltree::Node::is_element) {
        let range = node.range();
        let start = &whole[range.clone()];
        let name_end = range.start + start.find(|c: char| c.is_whitespace() || c == '/' || c == '>').unwrap();
        let mut odd = Vec::new();
        for attribute in [" odd=\"1\"", " xacro:odd=\"1\""] {
            odd.push(format!("{}{attribute}{}", &whole[..name_end], &whole[name_end..]));
        }
        // As the first child and, where there is no content, as the only one.
        let tag_end = range.start + start.find('>').unwrap();
        let is_empty = whole[..tag_end].ends_with('/');
        let written = &whole[range.start + 1..name_end];
        for child in ["<odd/>", "<xacro:odd/>", "odd words", "<![CDATA[odd]]>", "<!--odd-->"] {
            let (open, close) = if is_empty {
                (&whole[..tag_end - 1], format!(">{child}</{written}>"))
            } else {
                (&whole[..tag_end], format!(">{child}"))
            };
            // A comment right above a xacro element speaks about that, and goes with it, as in the Python tool.
            if child != "<!--odd-->" {
                odd.push(format!("{open}{close}{}", &whole[tag_end + 1..]));
            }
        }
        for text in odd {
            tried += 1;
            if let Err(said) = is_accounted_for(&text) {
                panic!("{said}\n{text}");
            }
        }
    }
    println!("{tried} documents with something unknown, each accounted for");
    assert!(tried > 150, "{tried}");
}

fn notes(body: &str) -> Vec<String> {
    expand_body(body).unwrap().notes.iter().map(ToString::to_string).collect()
}

#[test]
fn any_scope_but_parent_and_global_is_local() {
    let with = |scope: &str| {
        format!(
            "<xacro:property name='p' value='1'/><xacro:macro name='m'><xacro:property name='p' value='2' {scope}/>\
             <link name='in${{p}}'/></xacro:macro><xacro:m/><link name='out${{p}}'/>"
        )
    };
    for scope in ["", "scope='local'", "scope=''", "scope='lcoal'"] {
        let urdf = expand_body(&with(scope)).unwrap().urdf;
        assert!(urdf.contains("in2") && urdf.contains("out1"), "{scope}: {urdf}");
    }
    assert_eq!(notes(&with("scope='local'")), [""; 0]);
    let said = notes(&with("scope='lcoal'"));
    assert_eq!(said.len(), 1, "{said:?}");
    assert!(said[0].contains("the scope \"lcoal\" is not known, so \"local\" is used"), "{said:?}");
    // As the Python tool: evaluated when it is used, as without a scope.
    let lazy = "<xacro:property name='a' value='${b}' scope='local'/><xacro:property name='b' value='7'/><c d='${a}'/>";
    assert!(expand_body(lazy).unwrap().urdf.contains("d=\"7\""));
}

#[test]
fn a_variable_that_is_no_text_is_refused_where_it_is_used_and_only_there() {
    let environment = Environment::default().with_unreadable(["ODD".to_owned()]);
    let options = Options { environment, ..Options::default() };
    let expanded = |body: &str| expand(&Source::text("robot.xacro", robot(body)), &[], &options);
    assert!(expanded("<a/>").is_ok());
    for body in ["<a b='$(env ODD)'/>", "<a b='$(optenv ODD x)'/>"] {
        let error = expanded(body).unwrap_err().to_string();
        assert!(error.contains("the environment variable \"ODD\" is not text in UTF-8; set it to text"), "{error}");
    }
}

#[test]
fn values_nested_without_end_neither_crash_nor_take_for_ever() {
    for step in ["${[p]}", "${dict(a=p)}", "${(p,)}"] {
        let nest = format!("<xacro:property name='p' value='{step}' lazy_eval='false'/>\n").repeat(40_000);
        for end in ["<a/>", "<a b='${p}'/>", "<a b='${p == p}'/>", "<a b='${len(p)}'/>", "<a b='${repr(p)}'/>"] {
            let body = format!("<xacro:property name='p' value='${{1}}'/>{nest}{end}");
            if let Err(error) = expand_body(&body) {
                assert!(error.to_string().len() < 2000, "{error}");
            }
        }
    }
}
