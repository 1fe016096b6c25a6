//! Definition and call of macros.

use std::rc::Rc;

use super::directives::text_of;
use super::expander::{Expander, Outcome, Sight};
use super::output::Output;
use super::values::literal;
use crate::error::{ErrorKind, Frame, XacroError, did_you_mean, near};
use crate::expression::Value;
use crate::place::Spot;
use crate::scope::{Entry, Macro, Macros, Parameter, Scope};
use crate::tree::{Call, Element, Node};

impl Expander<'_> {
    pub fn define_macro(&mut self, element: &Rc<Element>, sight: &Sight) -> Outcome<()> {
        let [name] = self.attributes(element, ["name"], &["params"])?;
        let spot = element.spot_of(name);
        let mut name = &*name.value;
        if let Some(short) = name.strip_prefix("xacro:") {
            self.note(&spot, format!("the macro is called \"{short}\": its name needs no \"xacro:\""));
            name = short;
        }
        if name == "call" || name.contains('.') {
            let reason = if name == "call" { "it calls a macro by its name" } else { "\".\" separates namespaces" };
            return Err(XacroError::new(
                ErrorKind::Element,
                format!("\"{name}\" cannot be the name of a macro: {reason}"),
            )
            .at(&spot));
        }
        let parameters = element.attribute("params").map_or_else(Vec::new, |params| parameters(&params.value));
        sight.macros.define(name.into(), Macro { body: Rc::clone(element), parameters });
        Ok(())
    }

    /// `<xacro:call macro="name">`
    pub fn dynamic_call(&mut self, element: &Rc<Element>, sight: &Sight, output: &mut Output) -> Outcome<()> {
        let Some(attribute) = element.attribute("macro").filter(|attribute| !attribute.value.is_empty()) else {
            return Err(Self::wrong(element, "<xacro:call> has no attribute \"macro\"").help("add macro=\"…\""));
        };
        let name = self.words(&attribute.value, &element.spot_of(attribute), &sight.symbols)?;
        let mut call = Element::clone(element);
        call.attributes.retain(|attribute| &*attribute.name != "macro");
        self.call(&Rc::new(call), &name, sight, output)
    }

    /// `<xacro:name …>`
    pub fn call(&mut self, element: &Rc<Element>, name: &str, sight: &Sight, output: &mut Output) -> Outcome<()> {
        let (home, definition) = find(name, sight).ok_or_else(|| unknown(name, element, sight))?;
        let frame = |error: Box<XacroError>| {
            error.within(Frame::Macro {
                name: name.to_owned(),
                defined: definition.body.spot().place(),
                called: element.spot().place(),
            })
        };
        let inner = Sight { macros: Macros::inside(&home.macros), symbols: Scope::inside(&home.symbols) };
        self.bind(element, name, &definition, sight, &inner.symbols)?;
        self.meter.enter().map_err(|error| frame(error.at(&element.spot())))?;
        let mut body = Output::new(definition.body.bare(), false);
        body.element.namespaces.clone_from(&definition.body.namespaces);
        let around = self.call.take();
        self.call = Some(Rc::new(Call {
            name: name.into(),
            defined: definition.body.spot(),
            called: element.spot(),
            around: around.clone(),
        }));
        self.children(&definition.body, &inner, &mut body).map_err(frame)?;
        self.call = around;
        self.meter.leave();
        output.drop_comments();
        self.adopt(body.element, element, output);
        output.close_directive();
        Ok(())
    }

    /// Moves a result's children and namespaces into `output`.
    pub fn adopt(&mut self, produced: Element, element: &Element, output: &mut Output) {
        for name in output.import_namespaces(&produced.namespaces) {
            self.note(
                &element.spot(),
                format!("\"{name}\" is declared again with another meaning: the first one is used"),
            );
        }
        output.extend(produced.children);
    }

    /// Gives the parameters their values in `scope`.
    fn bind(
        &mut self,
        element: &Rc<Element>,
        name: &str,
        definition: &Macro,
        sight: &Sight,
        scope: &Rc<Scope>,
    ) -> Outcome<()> {
        let mut open: Vec<&Parameter> = definition.parameters.iter().collect();
        for attribute in &element.attributes {
            let spot = element.spot_of(attribute);
            let Some(at) = open.iter().position(|parameter| parameter.name == attribute.name) else {
                let spot = Spot::new(&element.file, attribute.name_range.clone());
                return Err(unknown_parameter(name, &attribute.name, definition).at(&spot));
            };
            open.remove(at);
            let value = self.value(&attribute.value, &spot, &sight.symbols)?;
            scope.set(Rc::clone(&attribute.name), Entry::Ready(literal(value)));
        }
        for child in &element.children {
            let (spot, words) = match child {
                Node::Text(text) if !text.value.trim().is_empty() => (text.spot.clone(), text_of(&text.value)),
                Node::Cdata(text) => (element.spot(), text_of(text)),
                _ => continue,
            };
            self.note(&spot, format!("{words} in the call of macro \"{name}\" is not understood: it is ignored"));
        }
        let mut content = Output::new(element.bare(), true);
        self.children(element, sight, &mut content)?;
        let mut blocks = content.element.elements().cloned().collect::<Vec<_>>().into_iter();
        let (wanted, values): (Vec<_>, Vec<_>) =
            open.into_iter().partition(|parameter| parameter.name.starts_with('*'));
        for parameter in wanted {
            let block = blocks.next().ok_or_else(|| {
                Self::wrong(
                    element,
                    format!("the macro \"{name}\" needs a child element for its parameter \"{}\"", parameter.name),
                )
            })?;
            scope.set(Rc::clone(&parameter.name), Entry::Ready(Value::Block(block)));
        }
        if let Some(block) = blocks.next() {
            return Err(Self::wrong(
                &block,
                format!("the macro \"{name}\" has no block parameter for the child <{}>", block.name),
            )
            .help("the parameters for children are written \"*name\""));
        }
        let mut missing = Vec::new();
        for parameter in values {
            let forwarded = if parameter.forwarded {
                self.name(&parameter.name, &element.spot(), &sight.symbols)
                    .map_err(|error| error.at(&element.spot()))?
            } else {
                None
            };
            let value = match (forwarded, &parameter.default) {
                (Some(value), _) => value,
                (None, Some(default)) => {
                    let spot = definition.body.attribute("params").map(|params| {
                        definition.body.spot_of(params).within(&params.value, default_range(&params.value, default))
                    });
                    self.value(default, &spot.unwrap_or_else(|| element.spot()), &sight.symbols)?
                }
                (None, None) if parameter.forwarded => {
                    return Err(Self::wrong(
                        element,
                        format!("there is no property \"{}\" to forward to the macro \"{name}\"", parameter.name),
                    ));
                }
                (None, None) => {
                    missing.push(format!("\"{}\"", parameter.name));
                    continue;
                }
            };
            scope.set(Rc::clone(&parameter.name), Entry::Ready(literal(value)));
        }
        if missing.is_empty() {
            return Ok(());
        }
        Err(Self::wrong(element, format!("the macro \"{name}\" gets no value for {}", missing.join(", "))))
    }
}

fn default_range(params: &str, default: &str) -> std::ops::Range<usize> {
    let at = params.find(default).unwrap_or(0);
    at..at + default.len()
}

/// The macro of a name, perhaps with namespaces before it, and the scope that it is called in.
fn find(name: &str, sight: &Sight) -> Option<(Sight, Rc<Macro>)> {
    if let Some(found) = sight.macros.find_macro(name) {
        return Some((sight.clone(), found));
    }
    let (namespaces, name) = name.rsplit_once('.')?;
    let mut home = sight.clone();
    for namespace in namespaces.split('.') {
        home.macros = home.macros.find_namespace(namespace)?;
        home.symbols = match home.symbols.find(namespace)? {
            (_, Entry::Ready(Value::Namespace(scope))) => scope,
            _ => return None,
        };
    }
    let found = home.macros.find_macro(name)?;
    Some((home, found))
}

fn unknown(name: &str, element: &Element, sight: &Sight) -> Box<XacroError> {
    let error = XacroError::new(ErrorKind::UndefinedMacro, format!("there is no macro \"{name}\""));
    let names = sight.macros.names();
    match did_you_mean(&near(name, names.iter().map(String::as_str))) {
        Some(question) => error.help(question),
        None => error.help("define it, or include the file that does, before it is called"),
    }
    .at(&element.spot())
}

fn unknown_parameter(name: &str, parameter: &str, definition: &Macro) -> Box<XacroError> {
    let plain: Vec<&str> =
        definition.parameters.iter().map(|known| &*known.name).filter(|known| !known.starts_with('*')).collect();
    let error = XacroError::new(ErrorKind::Element, format!("the macro \"{name}\" has no parameter \"{parameter}\""));
    if plain.contains(&parameter) {
        return error.help("it is given twice");
    }
    match did_you_mean(&near(parameter, plain.iter().copied())) {
        Some(question) => error.help(question),
        None if plain.is_empty() => error.help("it has none"),
        None => error.help(format!("it has {}", plain.join(", "))),
    }
}

/// Takes `params` apart: `name`, `name:=default`, `name=default`, `name:=^`, `name:=^|default`, `*block`, `**blocks`.
pub(super) fn parameters(params: &str) -> Vec<Parameter> {
    let mut found = Vec::new();
    let mut rest = params.trim_start();
    while !rest.is_empty() {
        let (parameter, after) = with_default(rest).unwrap_or_else(|| {
            let end = rest.find(char::is_whitespace).unwrap_or(rest.len());
            (Parameter { name: rest[..end].into(), forwarded: false, default: None }, &rest[end..])
        });
        found.push(parameter);
        rest = after.trim_start();
    }
    found
}

/// A parameter with `:=` or `=`, and what follows it.
fn with_default(text: &str) -> Option<(Parameter, &str)> {
    let end = text.find(|c: char| c.is_whitespace() || c == ':' || c == '=').filter(|&end| end > 0)?;
    let after = text[end..].trim_start();
    let after = after.strip_prefix(":=").or_else(|| after.strip_prefix('='))?.trim_start();
    let (forwarded, after) = match after.strip_prefix('^') {
        Some(after) => (true, after.strip_prefix('|').unwrap_or(after)),
        None => (false, after),
    };
    let length = default_length(after)?;
    let default = (length > 0).then(|| after[..length].into());
    Some((Parameter { name: text[..end].into(), forwarded, default }, &after[length..]))
}

/// The length of a default: an expression or substitution up to a bracket before white space, or words and quoted texts
/// without white space between them. `None` if a quote is not closed.
fn default_length(text: &str) -> Option<usize> {
    let ends = |at: usize| text[at..].chars().next().is_none_or(char::is_whitespace);
    for (open, close) in [("${", '}'), ("$(", ')')] {
        if text.starts_with(open) {
            let line = text.find('\n').unwrap_or(text.len());
            let whole = text[..line].match_indices(close).map(|(at, _)| at + 1).find(|&at| ends(at));
            if whole.is_some() {
                return whole;
            }
        }
    }
    let mut at = 0;
    while !ends(at) {
        let rest = &text[at..];
        let first = rest.chars().next();
        at += match first {
            Some(quote @ ('\'' | '"')) => rest[1..].find(quote)? + 2,
            Some('$') if rest.starts_with("${") => rest.find('}')? + 1,
            Some('$') if rest.starts_with("$(") => rest.find(')')? + 1,
            _ => {
                let first = first.map_or(0, char::len_utf8);
                let stops = |c: char| c.is_whitespace() || "'\"$".contains(c);
                rest[first..].find(stops).map_or(rest.len(), |length| first + length)
            }
        };
    }
    Some(at)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(params: &str, expected: &str) {
        let shown: Vec<String> = parameters(params)
            .iter()
            .map(|parameter| {
                let forwarded = if parameter.forwarded { "^" } else { "" };
                match &parameter.default {
                    Some(default) => format!("{}:={forwarded}<{default}>", parameter.name),
                    None => format!("{}{forwarded}", parameter.name),
                }
            })
            .collect();
        assert_eq!(shown.join(" "), expected, "{params}");
    }

    #[test]
    fn parameters_come_with_defaults_forwards_and_blocks() {
        check("", "");
        check("a b  c", "a b c");
        check("a:=1 b=2 c := 3", "a:=<1> b:=<2> c:=<3>");
        check("*origin **rest a", "*origin **rest a");
        check("a:=^ b:=^|5 c:=^|${x + 1} d", "a^ b:=^<5> c:=^<${x + 1}> d");
        check("a:='two words' b:=\"x y\"z", "a:=<'two words'> b:=<\"x y\"z>");
        check("a:=$(find x)/y b:=${1}_2", "a:=<$(find x)/y> b:=<${1}_2>");
        check("a:='' b:= c", "a:=<''> b:=<c>");
        check("a:=${f(1, 2)}\n  b:=3", "a:=<${f(1, 2)}> b:=<3>");
    }
}
