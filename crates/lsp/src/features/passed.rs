//! Names passed on by a macro's parameter, a property or an argument.

use crate::analysis::Spot;
use crate::features::definition::macro_of;
use crate::names::Kind;
use crate::session::Session;
use std::path::PathBuf;

/// Where a name is written that reaches `at` only through `${…}` or `$(arg …)`; empty if it is composed otherwise.
pub(crate) fn passed(session: &Session, at: &Spot, name: &str) -> Vec<Spot> {
    let mut files: Vec<PathBuf> = vec![at.file.clone()];
    for analysis in session.analyses().filter(|analysis| analysis.files.contains(&at.file)) {
        files.extend(analysis.files.iter().cloned());
    }
    files.sort();
    files.dedup();
    let mut follower = Follower { session, files, name, seen: Vec::new(), found: Vec::new() };
    follower.follow(at);
    follower.found
}

struct Follower<'a> {
    session: &'a Session,
    files: Vec<PathBuf>,
    name: &'a str,
    seen: Vec<Spot>,
    found: Vec<Spot>,
}

impl Follower<'_> {
    /// Follows a use to the origin of its value.
    fn follow(&mut self, at: &Spot) {
        if self.seen.contains(at) {
            return;
        }
        self.seen.push(at.clone());
        let files = &self.session.files;
        let (Some(text), Some(names)) = (files.text(&at.file), files.names(&at.file)) else { return };
        let Some(written) = text.text.get(at.range.clone()) else { return };
        let inside = |range: &std::ops::Range<usize>| at.range.start <= range.start && range.end <= at.range.end;
        let Some(used) = names.iter().find(|used| {
            inside(&used.range)
                && match used.kind {
                    Kind::Property => written.trim() == format!("${{{}}}", used.name),
                    Kind::Argument => written.trim() == format!("$(arg {})", used.name),
                    _ => false,
                }
        }) else {
            return;
        };
        let home = macro_of(self.session, &at.file, used);
        let name_of_macro = home.and_then(|tag| {
            let markup = files.markup(&at.file)?;
            Some((tag, markup.tags[tag].attribute(&text.text, "name")?.to_owned()))
        });
        match (used.kind, name_of_macro) {
            (Kind::Argument, _) => self.values("arg", &used.name, "default"),
            (_, Some((tag, name))) => {
                self.default_of(at, tag, &used.name);
                self.calls(&name, &used.name);
            }
            _ => self.values("property", &used.name, "value"),
        }
    }

    /// The content of a value: the name itself, or another step towards it.
    fn value(&mut self, at: Spot) {
        let Some(text) = self.session.files.text(&at.file) else { return };
        let Some(written) = text.text.get(at.range.clone()) else { return };
        if written == self.name {
            self.found.push(at);
        } else if written.contains('$') {
            self.follow(&at);
        }
    }

    /// Values of a parameter in the calls of a macro.
    fn calls(&mut self, of: &str, parameter: &str) {
        self.attributes(|full, _| full.strip_prefix("xacro:") == Some(of), parameter);
    }

    /// Values of `<xacro:property>` or `<xacro:arg>` elements of a name.
    fn values(&mut self, tag: &str, name: &str, attribute: &str) {
        self.attributes(|full, own| full.strip_prefix("xacro:") == Some(tag) && own == Some(name), attribute);
    }

    fn attributes(&mut self, is_it: impl Fn(&str, Option<&str>) -> bool, attribute: &str) {
        for file in self.files.clone() {
            let (Some(text), Some(markup)) = (self.session.files.text(&file), self.session.files.markup(&file)) else {
                continue;
            };
            for tag in &markup.tags {
                if !is_it(&text.text[tag.name.clone()], tag.attribute(&text.text, "name")) {
                    continue;
                }
                let own = tag.attributes.iter().find(|own| &text.text[own.name.clone()] == attribute);
                if let Some(own) = own {
                    self.value(Spot { file: file.clone(), range: own.value.clone() });
                }
            }
        }
    }

    /// The default of a parameter, in the macro's `params`.
    fn default_of(&mut self, at: &Spot, tag: usize, parameter: &str) {
        let files = &self.session.files;
        let (Some(text), Some(markup), Some(names)) =
            (files.text(&at.file), files.markup(&at.file), files.names(&at.file))
        else {
            return;
        };
        let declared = names.iter().find(|name| name.tag == tag && name.defines && name.name == parameter);
        let params = markup.tags[tag].attributes.iter().find(|own| &text.text[own.name.clone()] == "params");
        let (Some(declared), Some(params)) = (declared, params) else { return };
        let rest = &text.text[declared.range.end..params.value.end];
        let Some(value) = rest.strip_prefix(":=").or_else(|| rest.strip_prefix('=')) else { return };
        let start = params.value.end - value.len();
        let quoted = value.starts_with(['\'', '"']);
        let ends = |c: char| if quoted { c == '\'' || c == '"' } else { c.is_whitespace() };
        let start = start + usize::from(quoted);
        let length = text.text[start..params.value.end].find(ends).unwrap_or(params.value.end - start);
        self.value(Spot { file: at.file.clone(), range: start..start + length });
    }
}
