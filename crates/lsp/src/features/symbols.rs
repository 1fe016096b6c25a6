//! The outline: of a URDF the tree of its links, of other files their elements.

use crate::markup::Markup;
use crate::names::Kind;
use crate::session::Session;
use crate::text::Text;
use denavit_model::Robot;
use gen_lsp_types::{DocumentSymbol, SymbolKind};
use std::path::Path;

/// Trees deeper than this are cut: the editor draws no deeper ones.
const DEEPEST: usize = 400;

pub(crate) fn symbols(session: &Session, path: &Path) -> Vec<DocumentSymbol> {
    let (Some(text), Some(markup)) = (session.files.text(path), session.files.markup(path)) else { return Vec::new() };
    let robots = session.robots_of(path);
    let own = robots.iter().find(|analysis| analysis.file == path && analysis.trace.is_none());
    if let Some(robot) = own.and_then(|analysis| analysis.robot.as_ref())
        && robot.source.translation.is_none()
    {
        return Outline { text: &text, markup: &markup }.link(robot, robot.root, 0).into_iter().collect();
    }
    let names = session.files.names(path);
    let mut found: Vec<(usize, DocumentSymbol)> = Vec::new();
    for name in names.iter().flat_map(|names| names.iter()).filter(|name| name.defines || name.kind == Kind::Include) {
        let tag = &markup.tags[name.tag];
        // A parameter belongs to its macro.
        if name.kind == Kind::Property && &text.text[tag.name.clone()] == "xacro:macro" {
            continue;
        }
        let detail = match name.kind {
            Kind::Joint => tag.attribute(&text.text, "type").map(str::to_owned),
            _ => None,
        };
        let kind = symbol_kind(name.kind);
        let range = text.range(&(tag.start.start..tag.end()));
        let detail = Some(detail.map_or(name.kind.word().to_owned(), |words| format!("joint, {words}")));
        let selection_range = text.range(&name.range);
        #[allow(deprecated)]
        let made = DocumentSymbol {
            name: name.name.clone(),
            detail,
            kind,
            tags: None,
            deprecated: None,
            range,
            selection_range,
            children: None,
        };
        found.push((name.tag, made));
    }
    nested(&markup, found)
}

fn symbol_kind(kind: Kind) -> SymbolKind {
    match kind {
        Kind::Link => SymbolKind::Object,
        Kind::Joint | Kind::Either => SymbolKind::Interface,
        Kind::Macro => SymbolKind::Function,
        Kind::Property => SymbolKind::Constant,
        Kind::Argument => SymbolKind::Variable,
        Kind::Include | Kind::Package | Kind::Mesh => SymbolKind::File,
        Kind::Material => SymbolKind::Struct,
        Kind::Group => SymbolKind::Array,
    }
}

/// Symbols of elements inside of others' become their children.
fn nested(markup: &Markup, found: Vec<(usize, DocumentSymbol)>) -> Vec<DocumentSymbol> {
    let mut top: Vec<DocumentSymbol> = Vec::new();
    // The symbols that are open, with their elements.
    let mut open: Vec<(usize, DocumentSymbol)> = Vec::new();
    let close = |open: &mut Vec<(usize, DocumentSymbol)>, top: &mut Vec<DocumentSymbol>| {
        if let Some((_, done)) = open.pop() {
            match open.last_mut() {
                Some((_, parent)) => parent.children.get_or_insert_default().push(done),
                None => top.push(done),
            }
        }
    };
    for (tag, symbol) in found {
        while open.last().is_some_and(|(parent, _)| !markup.around(tag).any(|around| around == *parent)) {
            close(&mut open, &mut top);
        }
        open.push((tag, symbol));
    }
    while !open.is_empty() {
        close(&mut open, &mut top);
    }
    top
}

struct Outline<'a> {
    text: &'a Text,
    markup: &'a Markup,
}

impl Outline<'_> {
    fn link(&self, robot: &Robot, link: usize, depth: usize) -> Option<DocumentSymbol> {
        let of = &robot.links[link];
        let mass = of
            .inertial
            .as_ref()
            .map(|inertial| format!("link, {} kg", denavit_export::numbers::decimal(inertial.mass, 3)));
        let joints = robot.joints_from(link).filter(|_| depth < DEEPEST);
        let children: Vec<DocumentSymbol> = joints
            .filter_map(|index| {
                let joint = &robot.joints[index];
                let below = self.link(robot, joint.child, depth + 1);
                let detail = format!("joint, {}", joint.kind.word());
                self.symbol(robot, joint.at, &joint.name, detail, SymbolKind::Interface, below.into_iter().collect())
            })
            .collect();
        self.symbol(robot, of.at, &of.name, mass.unwrap_or_else(|| "link".to_owned()), SymbolKind::Object, children)
    }

    /// `at` is a byte of the text that was read, which may have declarations that this one lacks.
    fn symbol(
        &self,
        robot: &Robot,
        at: usize,
        name: &str,
        detail: String,
        kind: SymbolKind,
        children: Vec<DocumentSymbol>,
    ) -> Option<DocumentSymbol> {
        let source = &robot.source;
        let declared = if at >= source.declared.end { source.declared.len() } else { 0 };
        let tag = &self.markup.tags[self.markup.named_at(at + source.dropped_before.len() - declared + 1)?];
        let own = tag.attributes.iter().find(|attribute| &self.text.text[attribute.name.clone()] == "name");
        let selected = own.map_or(tag.name.clone(), |attribute| attribute.value.clone());
        #[allow(deprecated)]
        Some(DocumentSymbol {
            name: name.to_owned(),
            detail: Some(detail),
            kind,
            tags: None,
            deprecated: None,
            range: self.text.range(&(tag.start.start..tag.end())),
            selection_range: self.text.range(&selected),
            children: (!children.is_empty()).then_some(children),
        })
    }
}
