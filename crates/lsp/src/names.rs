//! All definitions and uses of names in a text.

use crate::markup::Markup;
use denavit_edit::{Kind as Named, named_by_attribute, named_by_text};
use denavit_model::formats::root_element;
use std::ops::Range;
use std::path::Path;

/// The language of a text.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Language {
    /// URDF or xacro.
    Urdf,
    Srdf,
    Sdf,
    Mjcf,
}

impl Language {
    pub fn of(path: &Path, text: &str) -> Self {
        let name = path.to_string_lossy().to_ascii_lowercase();
        match root_element(text) {
            Some("mujoco" | "mujocoinclude") => Self::Mjcf,
            Some("sdf" | "gazebo" | "world") => Self::Sdf,
            _ if name.ends_with(".srdf") || name.ends_with(".srdf.xacro") => Self::Srdf,
            _ if name.ends_with(".sdf") || name.ends_with(".world") => Self::Sdf,
            _ if name.ends_with(".mjcf") => Self::Mjcf,
            _ => Self::Urdf,
        }
    }
}

/// What a name refers to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Kind {
    Link,
    Joint,
    /// A link, or a joint if no link has the name.
    Either,
    Material,
    Macro,
    /// A property, or a parameter of a macro.
    Property,
    Argument,
    Include,
    Package,
    Mesh,
    /// A group of an SRDF.
    Group,
}

impl Kind {
    pub fn word(self) -> &'static str {
        match self {
            Self::Link => "link",
            Self::Joint => "joint",
            Self::Either => "link or joint",
            Self::Material => "material",
            Self::Macro => "macro",
            Self::Property => "property",
            Self::Argument => "argument",
            Self::Include => "included file",
            Self::Package => "package",
            Self::Mesh => "mesh",
            Self::Group => "group",
        }
    }

    /// Whether a use of one kind may mean a definition of the other.
    pub fn may_mean(self, other: Self) -> bool {
        self == other
            || (self == Self::Either && matches!(other, Self::Link | Self::Joint))
            || (other == Self::Either && matches!(self, Self::Link | Self::Joint))
    }
}

/// A name in a text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Occurrence {
    pub kind: Kind,
    /// As written, including xacro expressions.
    pub name: String,
    pub range: Range<usize>,
    /// Whether it is a definition.
    pub defines: bool,
    /// The element that it is in.
    pub tag: usize,
}

/// Xacro's own elements.
pub(crate) const XACRO: [&str; 11] =
    ["arg", "attribute", "call", "element", "if", "include", "insert_block", "macro", "property", "unless", "eval"];

/// Every name in a text, in its order.
pub(crate) fn occurrences(text: &str, markup: &Markup, language: Language) -> Vec<Occurrence> {
    let mut found = Vec::new();
    for (index, tag) in markup.tags.iter().enumerate() {
        let full = &text[tag.name.clone()];
        let local = markup.local(text, index);
        let named = |kind, range: Range<usize>, defines| {
            let name = text[range.clone()].to_owned();
            (!name.is_empty()).then_some(Occurrence { kind, name, range, defines, tag: index })
        };
        let xacro = full.strip_prefix("xacro:");
        if let Some(name) = xacro.filter(|name| !XACRO.contains(name)) {
            found.extend(named(Kind::Macro, tag.name.end - name.len()..tag.name.end, false));
        }
        for attribute in &tag.attributes {
            let name = &text[attribute.name.clone()];
            let value = attribute.value.clone();
            match (xacro, name) {
                (Some("macro"), "name") => found.extend(named(Kind::Macro, value.clone(), true)),
                (Some("call"), "macro") => found.extend(named(Kind::Macro, value.clone(), false)),
                (Some("property"), "name") => found.extend(named(Kind::Property, value.clone(), true)),
                (Some("insert_block"), "name") => found.extend(named(Kind::Property, value.clone(), false)),
                (Some("arg"), "name") => found.extend(named(Kind::Argument, value.clone(), true)),
                (Some("include"), "filename") => found.extend(named(Kind::Include, value.clone(), false)),
                (Some("macro"), "params") => {
                    for word in parameters(&text[value.clone()]) {
                        found.extend(named(Kind::Property, value.start + word.start..value.start + word.end, true));
                    }
                }
                (Some(_), _) => {}
                (None, _) => {
                    if let Some((kind, defines)) = of_attribute(text, markup, index, local, name, language) {
                        found.extend(named(kind, value.clone(), defines));
                    }
                }
            }
            in_xacro(text, value, index, &mut found);
        }
        let Some(inside) = tag.inside() else { continue };
        let kind = match language {
            Language::Mjcf => None,
            _ => named_by_text(local, tag.attribute(text, "name")).filter(|_| xacro.is_none()),
        };
        if let Some(kind) = kind {
            for word in words(&text[inside.clone()]) {
                let range = inside.start + word.start..inside.start + word.end;
                let name = text[range.clone()].to_owned();
                found.push(Occurrence { kind: own(kind), name, range, defines: false, tag: index });
            }
        }
        in_xacro(text, inside, index, &mut found);
    }
    found.sort_by_key(|occurrence| (occurrence.range.start, occurrence.range.end));
    found
}

fn own(kind: Named) -> Kind {
    match kind {
        Named::Link => Kind::Link,
        Named::Joint => Kind::Joint,
        Named::Either => Kind::Either,
    }
}

fn of_attribute(
    text: &str,
    markup: &Markup,
    tag: usize,
    local: &str,
    name: &str,
    language: Language,
) -> Option<(Kind, bool)> {
    let around = || markup.around(tag).map(|tag| &text[markup.tags[tag].name.clone()]);
    let in_robot = || around().find(|name| !name.starts_with("xacro:")).is_none_or(|name| name == "robot");
    match (language, local, name) {
        (Language::Mjcf, "body", "name") | (Language::Sdf, "link", "name") => Some((Kind::Link, true)),
        (Language::Mjcf, "joint" | "freejoint", "name") if around().any(|name| name == "body") => {
            Some((Kind::Joint, true))
        }
        (Language::Mjcf, "mesh" | "material", "name") if around().any(|name| name == "asset") => {
            Some((if local == "mesh" { Kind::Mesh } else { Kind::Material }, true))
        }
        (Language::Mjcf, _, "material") => Some((Kind::Material, false)),
        (Language::Mjcf, "geom", "mesh") => Some((Kind::Mesh, false)),
        (Language::Mjcf, "include", "file") => Some((Kind::Include, false)),
        (Language::Mjcf, _, "joint" | "joint1" | "joint2" | "jointinparent") => Some((Kind::Joint, false)),
        (Language::Mjcf, _, "body" | "body1" | "body2") => Some((Kind::Link, false)),
        (Language::Mjcf, ..) => None,
        (Language::Sdf, "joint", "name") => Some((Kind::Joint, true)),
        (Language::Sdf, _, "relative_to" | "attached_to" | "expressed_in") => Some((Kind::Either, false)),
        (Language::Sdf, ..) => None,
        (Language::Srdf, "group", "name") => Some((Kind::Group, in_robot())),
        (Language::Srdf, "group_state" | "end_effector", "group") | (Language::Srdf, _, "parent_group") => {
            Some((Kind::Group, false))
        }
        (Language::Urdf, "link", "name") => Some((Kind::Link, in_robot())),
        (Language::Urdf, "joint", "name") => Some((Kind::Joint, in_robot())),
        (Language::Urdf, "material", "name") => Some((Kind::Material, markup.tags[tag].has_children)),
        (Language::Urdf, "mesh", "filename") => Some((Kind::Mesh, false)),
        _ => named_by_attribute(local, name).map(|kind| (own(kind), false)),
    }
}

/// Names in `${…}` and `$(…)`, and the package of a `package://`.
fn in_xacro(text: &str, range: Range<usize>, tag: usize, found: &mut Vec<Occurrence>) {
    let value = &text[range.clone()];
    if !value.contains('$') && !value.contains("package://") {
        return;
    }
    let mut add = |kind, at: usize, length: usize| {
        let range = range.start + at..range.start + at + length;
        found.push(Occurrence { kind, name: text[range.clone()].to_owned(), range, defines: false, tag });
    };
    for (at, opens) in value.match_indices("$(") {
        let inner = &value[at + opens.len()..];
        let inner = &inner[..inner.find(')').unwrap_or(inner.len())];
        for (word, kind) in [("arg ", Kind::Argument), ("find ", Kind::Package)] {
            if let Some(rest) = inner.trim_start().strip_prefix(word) {
                let name = rest.trim();
                if !name.is_empty() {
                    add(kind, name.as_ptr() as usize - value.as_ptr() as usize, name.len());
                }
            }
        }
    }
    for (at, opens) in value.match_indices("package://") {
        let rest = &value[at + opens.len()..];
        let end = rest.find('/').unwrap_or(rest.len());
        if end > 0 && !rest[..end].contains('$') {
            add(Kind::Package, at + opens.len(), end);
        }
    }
    for (at, opens) in value.match_indices("${") {
        let start = at + opens.len();
        let inner = &value[start..];
        let inner = &inner[..inner.find('}').unwrap_or(inner.len())];
        for word in identifiers(inner) {
            add(Kind::Property, start + word.start, word.len());
        }
    }
}

/// Words of an expression that may be properties: without attributes, functions, strings and Python keywords.
fn identifiers(expression: &str) -> Vec<Range<usize>> {
    const PYTHON: [&str; 10] = ["and", "or", "not", "if", "else", "in", "True", "False", "None", "for"];
    let bytes = expression.as_bytes();
    let (mut found, mut at) = (Vec::new(), 0);
    while let Some(&byte) = bytes.get(at) {
        if byte == b'\'' || byte == b'"' {
            let rest = bytes[at + 1..].iter().position(|other| *other == byte);
            at = rest.map_or(bytes.len(), |length| at + length + 2);
        } else if byte.is_ascii_alphabetic() || byte == b'_' {
            let ends = |byte: &u8| !(byte.is_ascii_alphanumeric() || *byte == b'_');
            let end = bytes[at..].iter().position(ends).map_or(bytes.len(), |length| at + length);
            let is_part = at > 0 && (bytes[at - 1] == b'.' || bytes[at - 1].is_ascii_digit());
            let is_called = expression[end..].trim_start().starts_with('(');
            if !is_part && !is_called && !PYTHON.contains(&&expression[at..end]) {
                found.push(at..end);
            }
            at = end;
        } else {
            at += 1;
        }
    }
    found
}

/// Names of the parameters in `params`, without stars and defaults.
fn parameters(params: &str) -> Vec<Range<usize>> {
    let (mut found, mut at) = (Vec::new(), 0);
    let bytes = params.as_bytes();
    while at < bytes.len() {
        if bytes[at].is_ascii_whitespace() || bytes[at] == b'*' {
            at += 1;
            continue;
        }
        let is_name = |byte: &u8| byte.is_ascii_alphanumeric() || *byte == b'_';
        let end = bytes[at..].iter().position(|byte| !is_name(byte)).map_or(bytes.len(), |length| at + length);
        if end > at {
            found.push(at..end);
        }
        // The default ends at white space outside of quotes and brackets.
        let (mut quote, mut depth) = (None, 0_usize);
        at = end.max(at + 1);
        while at < bytes.len() {
            match (quote, bytes[at]) {
                (Some(open), byte) if byte == open => quote = None,
                (Some(_), _) => {}
                (None, byte @ (b'\'' | b'"')) => quote = Some(byte),
                (None, b'(' | b'{' | b'[') => depth += 1,
                (None, b')' | b'}' | b']') => depth = depth.saturating_sub(1),
                (None, byte) if byte.is_ascii_whitespace() && depth == 0 => break,
                _ => {}
            }
            at += 1;
        }
    }
    found
}

/// Words between white space and commas; the last part of `model::link`.
fn words(text: &str) -> impl Iterator<Item = Range<usize>> + '_ {
    let start = text.as_ptr() as usize;
    let separators = [',', ' ', '\t', '\n', '\r'];
    text.split(separators).filter(|word| !word.is_empty()).map(move |word| {
        let word = word.rsplit("::").next().unwrap_or(word);
        let at = word.as_ptr() as usize - start;
        at..at + word.len()
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::markup::scan;

    fn named(text: &str, language: Language) -> Vec<String> {
        let shown = |occurrence: &Occurrence| {
            assert_eq!(&text[occurrence.range.clone()], occurrence.name);
            let defines = if occurrence.defines { "=" } else { "" };
            format!("{} {}{defines}", occurrence.kind.word(), occurrence.name)
        };
        occurrences(text, &scan(text), language).iter().map(shown).collect()
    }

    #[test]
    fn xacro_names_macros_properties_arguments_packages_and_files() {
        let text = r#"<robot xmlns:xacro="x"><xacro:include filename="$(find tools)/a.xacro"/>
            <xacro:arg name="n" default="1"/><xacro:property name="len" value="$(arg n)"/>
            <xacro:macro name="arm" params="prefix *origin size:=${len * 2} name:='a b'"><link name="${prefix}tip"/></xacro:macro>
            <xacro:arm prefix="${sin(len) + d.x + 'text'}"/></robot>"#;
        let expected = "included file $(find tools)/a.xacro|package tools|argument n=|property len=|argument n|macro arm=|\
            property prefix=|property origin=|property size=|property len|property name=|link ${prefix}tip=|property prefix|\
            macro arm|property len|property d";
        assert_eq!(named(text, Language::Urdf).join("|"), expected);
    }

    #[test]
    fn the_same_word_defines_in_one_place_and_uses_in_another() {
        let text = r#"<robot><link name="a"/><joint name="j" type="fixed"><parent link="a"/></joint><gazebo reference="j"/>
            <transmission><joint name="j"/></transmission><ros2_control><joint name="j"/></ros2_control>
            <plugin><frame_name>a</frame_name></plugin></robot>"#;
        let expected = "link a=|joint j=|link a|link or joint j|joint j|joint j|link a";
        assert_eq!(named(text, Language::Urdf).join("|"), expected);
        let srdf = r#"<robot><group name="g"><link name="a"/></group><group_state group="g"><joint name="j"/></group_state></robot>"#;
        assert_eq!(named(srdf, Language::Srdf).join("|"), "group g=|link a|group g|joint j");
        let mjcf = r#"<mujoco><worldbody><body name="b"><joint name="h"/></body></worldbody><actuator><motor joint="h"/></actuator></mujoco>"#;
        assert_eq!(named(mjcf, Language::Mjcf).join("|"), "link b=|joint h=|joint h");
        let sdf = r#"<sdf><model><link name="b"/><joint name="h"><parent>world</parent><child>m::b</child></joint></model></sdf>"#;
        assert_eq!(named(sdf, Language::Sdf).join("|"), "link b=|joint h=|link world|link b");
    }
}
