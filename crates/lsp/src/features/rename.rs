//! Renames a link or joint wherever it is used.

use crate::analysis::{Analysis, Spot};
use crate::features::definition::{Target, is_part_of_tree, target, uses};
use crate::features::passed::passed;
use crate::names::{Kind, Language};
use crate::session::{Session, descriptions_near};
use crate::uri::uri_of;
use denavit_edit::{Operation, Renaming};
use gen_lsp_types::{Range, TextEdit, Uri, WorkspaceEdit};
use std::collections::{BTreeMap, HashMap};
use std::path::{Path, PathBuf};

fn renamed(session: &Session, path: &Path, at: usize) -> Result<Target, String> {
    let target = target(session, path, at).ok_or("no name here; put the cursor on the name of a link or joint")?;
    let kind = target.occurrence.kind;
    if !is_part_of_tree(kind) {
        return Err(format!(
            "only links and joints can be renamed, but \"{}\" names the {}",
            target.occurrence.name,
            kind.word()
        ));
    }
    if target.occurrence.name.contains('$') {
        return Err(format!(
            "{} comes from an expression; rename the property or text in that expression",
            target.occurrence.name
        ));
    }
    Ok(target)
}

/// The bytes of the name that would be renamed.
pub(crate) fn prepare(session: &Session, path: &Path, at: usize) -> Result<Range, String> {
    let target = renamed(session, path, at)?;
    let text = session.files.text(path).ok_or("the file is gone")?;
    Ok(text.range(&target.occurrence.range))
}

/// The edits that rename a link or joint.
pub(crate) fn rename(session: &Session, path: &Path, at: usize, new: &str) -> Result<WorkspaceEdit, String> {
    let mut target = renamed(session, path, at)?;
    if new.trim().is_empty() || new.contains(['<', '>', '"', '\'', '&', '$']) || new.contains(char::is_whitespace) {
        return Err(format!("\"{new}\" cannot be a name; write letters, digits, _, - and /"));
    }
    let old = target.occurrence.name.clone();
    let robots: Vec<_> = session.robots_of(path).into_iter().chain(session.robots_of_srdf(path)).collect();
    for robot in robots.iter().filter_map(|analysis| analysis.robot.as_ref()) {
        let (is_link, is_joint) = (robot.link_index(&old).is_some(), robot.joint_index(&old).is_some());
        if target.occurrence.kind == Kind::Either {
            target.occurrence.kind = if is_link || !is_joint { Kind::Link } else { Kind::Joint };
        }
        let taken = match target.occurrence.kind {
            Kind::Joint => robot.joint_index(new).is_some(),
            _ => robot.link_index(new).is_some(),
        };
        if taken {
            return Err(format!("{}: a {} already has the name \"{new}\"", robot.name, target.occurrence.kind.word()));
        }
    }
    let kind = target.occurrence.kind;
    let mut found = uses(session, path, &target);
    // A reference that may mean either means the link, if there is one.
    let both = robots.iter().filter_map(|analysis| analysis.robot.as_ref());
    let both = both.filter(|robot| robot.link_index(&old).is_some() && robot.joint_index(&old).is_some()).count() > 0;
    if both && kind == Kind::Joint {
        found.retain(|found| {
            let names = session.files.names(&found.at.file);
            let is_either = names.is_some_and(|names| {
                names.iter().any(|name| name.range == found.at.range && name.kind == Kind::Either)
            });
            !is_either
        });
    }
    let mut spots: Vec<Spot> = found.iter().filter(|found| found.plain).map(|found| found.at.clone()).collect();
    let mut handed_on: Vec<Spot> = Vec::new();
    for made in found.iter().filter(|found| !found.plain) {
        let sources = passed(session, &made.at, &old);
        if sources.is_empty() {
            return Err(format!(
                "an expression creates the {} \"{old}\" at {}; rename it there",
                kind.word(),
                place(session, &made.at)
            ));
        }
        handed_on.extend(sources);
    }
    spots.extend(handed_on.iter().cloned());
    spots.sort_by(|a, b| (&a.file, a.range.start).cmp(&(&b.file, b.range.start)));
    spots.dedup();
    if let Some(first) = handed_on.first() {
        let texts = edited(session, &spots, new);
        for robot in robots.iter().filter(|robot| robot.trace.is_some()) {
            prove(session, robot, &texts, (kind, &old, new)).map_err(|why| {
                format!(
                    "\"{old}\" is passed on at {}, and not only the {} uses it ({why}); give the other use its own \
                     parameter",
                    place(session, first),
                    kind.word()
                )
            })?;
        }
    }
    let mut changes: HashMap<Uri, Vec<TextEdit>> = HashMap::new();
    let mut change = |file: &Path, range: std::ops::Range<usize>| {
        if let Some(text) = session.files.text(file) {
            let edits = changes.entry(uri_of(file)).or_default();
            edits.push(TextEdit { range: text.range(&range), new_text: new.to_owned() });
        }
    };
    for spot in &spots {
        change(&spot.file, spot.range.clone());
    }
    // SRDF files near the robot that are not open.
    let names: Vec<&str> = robots.iter().filter_map(|analysis| Some(analysis.robot.as_ref()?.name.as_str())).collect();
    let seen: Vec<&Path> = found.iter().map(|found| found.at.file.as_path()).collect();
    for file in descriptions_near(path).iter().filter(|file| !seen.contains(&file.as_path())) {
        let Some(text) = session.files.text(file) else { continue };
        if Language::of(file, &text.text) != Language::Srdf {
            continue;
        }
        let own = denavit_compare::lint::srdf::robot_of(&text.text).unwrap_or_default();
        let named = session.files.names(file).filter(|_| names.contains(&own.as_str()));
        for name in
            named.iter().flat_map(|names| names.iter()).filter(|name| name.name == old && kind.may_mean(name.kind))
        {
            change(file, name.range.clone());
        }
    }
    Ok(WorkspaceEdit { changes: Some(changes), ..WorkspaceEdit::default() })
}

/// Where something is, for a message.
fn place(session: &Session, at: &Spot) -> String {
    let line = session.files.text(&at.file).map_or(0, |text| text.line_of(at.range.start) + 1);
    format!("{}:{line}", at.file.display())
}

/// The texts of files with the new name at these bytes, which are in order.
fn edited(session: &Session, spots: &[Spot], new: &str) -> BTreeMap<PathBuf, String> {
    let mut texts: BTreeMap<PathBuf, String> = BTreeMap::new();
    for spot in spots.iter().rev() {
        let Some(text) = session.files.text(&spot.file) else { continue };
        let text = texts.entry(spot.file.clone()).or_insert_with(|| text.text.clone());
        text.replace_range(spot.range.clone(), new);
    }
    texts
}

/// Whether the edited texts expand to the robot with its link or joint renamed, and nothing else changed.
fn prove(
    session: &Session,
    robot: &Analysis,
    texts: &BTreeMap<PathBuf, String>,
    (kind, old, new): (Kind, &str, &str),
) -> Result<(), String> {
    let is_there = robot.robot.as_ref().is_some_and(|own| match kind {
        Kind::Joint => own.joint_index(old).is_some(),
        _ => own.link_index(old).is_some(),
    });
    let named = if kind == Kind::Joint { "joint" } else { "link" };
    let file = robot.file.to_string_lossy();
    let mut expected = robot.urdf.clone();
    if is_there {
        let names = vec![Renaming { kind: Some(named), old: old.into(), new: new.into() }];
        let files = denavit_edit::Files::urdf(&*file, expected.as_str());
        let done = denavit_edit::apply(&files, &[Operation::Rename { names }]).map_err(|error| error.to_string())?;
        expected = done.files.urdf.text;
    }
    let own = session.files.text(&robot.file).ok_or("the file is gone")?;
    let text = texts.get(&robot.file).unwrap_or(&own.text);
    let options = session.settings.options(&robot.file);
    let expanded = session.files.with_texts(texts, || denavit_load::expanded_with_trace(&file, text, &options));
    let made = expanded.map_err(|error| error.to_string())?.urdf;
    let differs = made.lines().zip(expected.lines()).find(|(made, expected)| made != expected);
    match differs {
        Some((made, _)) => Err(format!("it would give {}", made.trim())),
        None if made.len() == expected.len() => Ok(()),
        None => Err("it would give a different robot".to_owned()),
    }
}
