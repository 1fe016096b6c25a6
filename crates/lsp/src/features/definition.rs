//! Where a name is defined, and where it is used.

use crate::analysis::{Analysis, Spot, real};
use crate::markup::{Spot as Place, scan};
use crate::names::{Kind, Language, Occurrence, occurrences};
use crate::session::Session;
use crate::uri::uri_of;
use denavit_xacro::{Environment, PackagePath};
use gen_lsp_types::{Location, Position, Range};
use std::collections::BTreeSet;
use std::ops::Range as Bytes;
use std::path::{Path, PathBuf};
use std::rc::Rc;

/// The name of a request.
#[derive(Debug)]
pub(crate) struct Target {
    pub occurrence: Occurrence,
    /// Its names in the robots, after evaluation of expressions.
    pub names: Vec<String>,
}

/// A place with the name.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Use {
    pub at: Spot,
    pub defines: bool,
    /// Whether the name is written there literally, not by an expression.
    pub plain: bool,
}

/// The name at a byte of a file.
pub(crate) fn target(session: &Session, path: &Path, at: usize) -> Option<Target> {
    let names = session.files.names(path)?;
    let touching = names.iter().filter(|name| name.range.start <= at && at <= name.range.end);
    let occurrence = touching.min_by_key(|name| name.range.len())?.clone();
    let mut found = vec![occurrence.name.clone()];
    if occurrence.name.contains('$') && is_part_of_tree(occurrence.kind) {
        let at = Spot { file: path.to_path_buf(), range: occurrence.range.clone() };
        found.clear();
        for robot in session.robots_of(path) {
            let values = robot.trace.as_ref().map(|trace| trace.values_of(&robot.urdf, &at));
            found.extend(values.unwrap_or_default().into_iter().map(str::to_owned));
        }
        found.dedup();
    }
    Some(Target { occurrence, names: found })
}

pub(crate) fn is_part_of_tree(kind: Kind) -> bool {
    matches!(kind, Kind::Link | Kind::Joint | Kind::Either)
}

/// Every analysis related to a file: robots that it belongs to, and their SRDF files.
fn about(session: &Session, path: &Path) -> Vec<Rc<Analysis>> {
    let mut robots = session.robots_of(path);
    robots.extend(session.robots_of_srdf(path));
    let names: BTreeSet<String> = robots.iter().filter_map(|robot| Some(robot.robot.as_ref()?.name.clone())).collect();
    let is_srdf = |analysis: &&Rc<Analysis>| {
        analysis.robot.is_none()
            && denavit_compare::lint::srdf::is_srdf(&analysis.file.to_string_lossy(), &analysis.urdf)
            && denavit_compare::lint::srdf::robot_of(&analysis.urdf).is_some_and(|name| names.contains(&name))
    };
    let srdf: Vec<Rc<Analysis>> = session.analyses().filter(is_srdf).cloned().collect();
    let own = session.analyses().filter(|analysis| analysis.files.iter().any(|file| file == path)).cloned();
    let mut all: Vec<Rc<Analysis>> = Vec::new();
    for analysis in robots.into_iter().chain(srdf).chain(own) {
        if !all.iter().any(|known| known.file == analysis.file) {
            all.push(analysis);
        }
    }
    all
}

/// Every place with the name of a target, in the order of files and bytes.
pub(crate) fn uses(session: &Session, path: &Path, target: &Target) -> Vec<Use> {
    let kind = target.occurrence.kind;
    let analyses = about(session, path);
    let mut files: BTreeSet<PathBuf> = analyses.iter().flat_map(|analysis| analysis.files.iter().cloned()).collect();
    files.insert(path.to_path_buf());
    let mut found: Vec<Use> = Vec::new();
    let mut add = |made: Use| match found.iter_mut().find(|known| known.at == made.at) {
        Some(known) => known.defines |= made.defines,
        None => found.push(made),
    };
    let home = parameter_home(session, path, &target.occurrence);
    for file in &files {
        let Some(names) = session.files.names(file) else { continue };
        for name in names.iter().filter(|name| kind.may_mean(name.kind) && target.names.contains(&name.name)) {
            let is_there = match (&home, kind) {
                (Some(home), _) => *file == *path && home.start <= name.range.start && name.range.end <= home.end,
                (None, Kind::Property) => parameter_home(session, file, name).is_none(),
                _ => true,
            };
            if is_there {
                let at = Spot { file: file.clone(), range: name.range.clone() };
                add(Use { at, defines: name.defines, plain: !name.name.contains('$') });
            }
        }
    }
    if is_part_of_tree(kind) {
        for analysis in &analyses {
            let Some(traced) = &analysis.trace else { continue };
            let language = Language::of(&analysis.file, &analysis.urdf);
            for name in occurrences(&analysis.urdf, &scan(&analysis.urdf), language) {
                if !kind.may_mean(name.kind) || !target.names.contains(&name.name) {
                    continue;
                }
                let Some(at) = traced.source_of(&name.range) else { continue };
                let text = session.files.text(&at.file);
                let plain = text.and_then(|text| Some(!text.text.get(at.range.clone())?.contains('$')));
                add(Use { at, defines: name.defines, plain: plain == Some(true) });
            }
        }
    }
    found.sort_by(|a, b| (&a.at.file, a.at.range.start).cmp(&(&b.at.file, b.at.range.start)));
    found
}

/// The bytes of the macro whose parameter a property is; `None` if it is not a parameter.
fn parameter_home(session: &Session, path: &Path, name: &Occurrence) -> Option<Bytes<usize>> {
    let tag = macro_of(session, path, name)?;
    let markup = session.files.markup(path)?;
    Some(markup.tags[tag].start.start..markup.tags[tag].end())
}

/// The element of the macro whose parameter a property is.
pub(crate) fn macro_of(session: &Session, path: &Path, name: &Occurrence) -> Option<usize> {
    if name.kind != Kind::Property {
        return None;
    }
    let (text, markup, names) = (session.files.text(path)?, session.files.markup(path)?, session.files.names(path)?);
    let own = std::iter::once(name.tag).chain(markup.around(name.tag));
    let macros = own.filter(|tag| &text.text[markup.tags[*tag].name.clone()] == "xacro:macro");
    macros.into_iter().find(|tag| {
        let declares = |other: &Occurrence| other.tag == *tag && other.defines && other.name == name.name;
        names.iter().any(|other| other.kind == Kind::Property && declares(other))
    })
}

pub(crate) fn location(session: &Session, at: &Spot) -> Location {
    let zero = Position { line: 0, character: 0 };
    let range = session.files.text(&at.file).map_or(Range { start: zero, end: zero }, |text| text.range(&at.range));
    Location { uri: uri_of(&at.file), range }
}

/// The definition of the name at a byte.
pub(crate) fn definition(session: &Session, path: &Path, at: usize) -> Vec<Location> {
    let Some(target) = target(session, path, at) else { return Vec::new() };
    let file = |path: PathBuf| vec![location(session, &Spot { file: real(&path), range: 0..0 })];
    match target.occurrence.kind {
        Kind::Include | Kind::Mesh => {
            // In MJCF a mesh is an asset with a name.
            if let Some(path) = file_of(session, path, &target.occurrence).filter(|path| path.is_file()) {
                return file(path);
            }
        }
        Kind::Package => {
            let folder = packages(session, path).find(&target.occurrence.name);
            return folder.map_or(Vec::new(), |folder| file(folder.join("package.xml")));
        }
        _ => {}
    }
    let uses = uses(session, path, &target);
    uses.iter().filter(|found| found.defines).map(|found| location(session, &found.at)).collect()
}

/// Every use of the name at a byte.
pub(crate) fn references(session: &Session, path: &Path, at: usize, with_definition: bool) -> Vec<Location> {
    let Some(target) = target(session, path, at) else { return Vec::new() };
    let uses = uses(session, path, &target);
    uses.iter().filter(|found| with_definition || !found.defines).map(|found| location(session, &found.at)).collect()
}

/// Where packages are looked for from a file.
pub(crate) fn packages(session: &Session, path: &Path) -> PackagePath {
    let named =
        std::env::vars_os().filter_map(|(name, value)| Some((name.into_string().ok()?, value.into_string().ok()?)));
    PackagePath::new(&session.settings.options(path).package_path, &named.collect::<Environment>()).near(path)
}

/// The file that an include or a mesh names; it may be missing.
pub(crate) fn file_of(session: &Session, path: &Path, name: &Occurrence) -> Option<PathBuf> {
    let words = evaluated(session, path, name.range.clone())?;
    if words.contains('$') {
        return None;
    }
    packages(session, path).resolve(&words, Some(path)).ok()
}

/// A part of a file with its expressions and substitutions evaluated, as far as their values are known.
pub(crate) fn evaluated(session: &Session, path: &Path, range: Bytes<usize>) -> Option<String> {
    let text = session.files.text(path)?;
    let written = text.text.get(range.clone())?;
    if !written.contains('$') {
        return Some(written.to_owned());
    }
    let robots = session.robots_of(path);
    let packages = packages(session, path);
    let (mut words, mut at) = (String::new(), 0);
    while let Some(found) = written[at..].find("${").into_iter().chain(written[at..].find("$(")).min() {
        let start = at + found;
        words.push_str(&written[at..start]);
        let close = if written[start..].starts_with("${") { '}' } else { ')' };
        let Some(length) = written[start..].find(close) else { break };
        let inside = &written[start + 2..start + length];
        let known = robots.iter().filter_map(|robot| robot.trace.as_ref());
        let value = known
            .filter_map(|trace| trace.evaluated(path, range.start + start + 2))
            .filter(|(at, _)| *at == (range.start + start + 2..range.start + start + length))
            .find_map(|(_, values)| values.first().map(|value| (*value).to_owned()));
        let package = || Some(packages.find(inside.strip_prefix("find ")?.trim()).ok()?.display().to_string());
        match value.or_else(package) {
            Some(value) => words.push_str(&value),
            None => words.push_str(&written[start..=start + length]),
        }
        at = start + length + 1;
    }
    words.push_str(&written[at..]);
    Some(words)
}

/// The link that a byte of a file refers to: by name, or by the enclosing link or joint.
pub(crate) fn link_at(session: &Session, path: &Path, at: usize) -> Option<String> {
    let (text, markup) = (session.files.text(path)?, session.files.markup(path)?);
    let robots: Vec<Rc<Analysis>> = session.robots_of(path).into_iter().chain(session.robots_of_srdf(path)).collect();
    let link = |names: &[String], is_joint: bool| {
        robots.iter().filter_map(|robot| robot.robot.as_ref()).find_map(|robot| {
            let joint = || names.iter().find_map(|name| robot.joints.iter().find(|joint| joint.name == *name));
            let link = || names.iter().find_map(|name| robot.links.iter().find(|link| link.name == *name));
            let child = || joint().map(|joint| robot.links[joint.child].name.clone());
            let own = || link().map(|link| link.name.clone());
            if is_joint { child() } else { own().or_else(child) }
        })
    };
    if let Some(target) = target(session, path, at).filter(|target| is_part_of_tree(target.occurrence.kind))
        && let Some(found) = link(&target.names, target.occurrence.kind == Kind::Joint)
    {
        return Some(found);
    }
    let tag = match markup.spot(at) {
        Place::Name(tag)
        | Place::AttributeName(tag, _)
        | Place::Value(tag, _)
        | Place::Inside(tag)
        | Place::Text(tag) => tag,
        Place::Elsewhere => return None,
    };
    let own = std::iter::once(tag).chain(markup.around(tag));
    let named = own.into_iter().find_map(|tag| {
        let local = markup.local(&text.text, tag);
        let attribute = markup.tags[tag].attributes.iter().find(|attribute| {
            let name = &text.text[attribute.name.clone()];
            (name == "name" && ["link", "joint", "body"].contains(&local)) || (name == "reference" && local == "gazebo")
        })?;
        Some((attribute.value.start, local == "joint"))
    });
    let (at, is_joint) = named?;
    let target = target(session, path, at)?;
    link(&target.names, is_joint)
}
