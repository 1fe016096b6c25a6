//! The robots of a repository in two revisions, each as it was and as it is.

use crate::project::FILE_NAME;
use crate::revision::{git, line};
use crate::urdf_text::is_markup;
use crate::{CheckError, LoadError, Options, Project, ProjectRobot, read_text};
use denavit_model::formats::Format;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// A robot in both revisions.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub struct Pair {
    /// Its name in `denavit.toml`, or the path of its file.
    pub name: String,
    /// As it was; `None`: it is new.
    pub before: Option<Described>,
    /// As it is; `None`: it was removed.
    pub after: Option<Described>,
    /// Whether anything changed that it is made from.
    pub is_touched: bool,
}

/// A description and how it is read.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub struct Described {
    /// What to read: a path, or `git:REVISION:PATH`.
    pub source: String,
    /// Its path from the top of the repository.
    pub path: String,
    /// Arguments and packages.
    pub options: Options,
    /// Link that its chain starts at.
    pub base: Option<String>,
    /// Link that its chain ends at.
    pub tip: Option<String>,
}

/// The robots of a repository in two revisions.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub struct Pairs {
    /// Each robot.
    pub robots: Vec<Pair>,
    /// Whether a `denavit.toml` names them; else they are all descriptions that are there.
    pub are_named: bool,
}

/// Endings of what is a description by itself.
const DESCRIPTIONS: [&str; 5] = ["urdf", "xacro", "sdf", "mjcf", "xml"];
/// Endings of files that a description may be made from.
const PARTS: [&str; 12] = ["urdf", "xacro", "sdf", "mjcf", "xml", "yaml", "yml", "csv", "json", "stl", "obj", "msh"];

/// Every robot that the `denavit.toml` of the repository names, or else every description in it, in the revision `before`
/// and in `after`; with `None` in the working tree. A file that was renamed is followed. `options` add packages.
///
/// # Errors
/// Git does not know a revision, or a `denavit.toml` is invalid.
pub fn pairs(before: &str, after: Option<&str>, options: &Options) -> Result<Pairs, CheckError> {
    let here = Tree::at(before, after)?;
    let project = here.project(after)?;
    let robots = match project {
        Some(project) if !project.robots.is_empty() => {
            let old = here.project(Some(before))?;
            return Ok(Pairs { robots: here.named(&project, old.as_ref(), options), are_named: true });
        }
        project => here.found(project.as_ref(), options),
    };
    Ok(Pairs { robots, are_named: false })
}

/// A repository and what changed in it.
struct Tree<'a> {
    before: &'a str,
    after: Option<&'a str>,
    top: PathBuf,
    /// From the working folder to the top: empty, or `../`.
    up: String,
    /// Files of each revision, from the top.
    old: BTreeSet<String>,
    new: BTreeSet<String>,
    /// New names of renamed files, with the old ones.
    renamed: BTreeMap<String, String>,
    changed: BTreeSet<String>,
}

impl<'a> Tree<'a> {
    fn at(before: &'a str, after: Option<&'a str>) -> Result<Self, LoadError> {
        let failed = |name: &str, reason: String| LoadError::Read { file: format!("git:{name}"), reason };
        let ask = |folder: &Path, arguments: &[&str]| git(folder, arguments).map_err(|reason| failed(before, reason));
        let top = PathBuf::from(line(&ask(Path::new("."), &["rev-parse", "--show-toplevel"])?));
        let up = line(&ask(Path::new("."), &["rev-parse", "--show-cdup"])?);
        for revision in [Some(before), after].into_iter().flatten() {
            let commit = format!("{revision}^{{tree}}");
            if revision.is_empty()
                || revision.starts_with('-')
                || git(&top, &["rev-parse", "--verify", &commit]).is_err()
            {
                let reason = "this clone has no such revision; fetch it (on a CI server: the whole history)";
                return Err(failed(revision, reason.into()));
            }
        }
        let tree = |revision: &str| ask(&top, &["ls-tree", "-r", "-z", "--name-only", "--full-tree", revision]);
        let (mut changed, mut renamed) = (BTreeSet::new(), BTreeMap::new());
        let mut arguments = vec!["diff", "-z", "-M", "--name-status", before];
        arguments.extend(after);
        arguments.push("--");
        let listed = ask(&top, &arguments)?;
        let mut words = names(&listed);
        while let (Some(kind), Some(old)) = (words.next(), words.next()) {
            if kind.starts_with(['R', 'C']) {
                let Some(new) = words.next() else { break };
                if kind.starts_with('R') {
                    changed.insert(old.clone());
                    renamed.insert(new.clone(), old);
                }
                changed.insert(new);
            } else {
                changed.insert(old);
            }
        }
        let new = if let Some(after) = after {
            names(&tree(after)?).collect()
        } else {
            let own = ["ls-files", "-z", "--others", "--exclude-standard"];
            changed.extend(names(&ask(&top, &own)?));
            let all = ask(&top, &["ls-files", "-z", "--cached", "--others", "--exclude-standard"])?;
            names(&all).filter(|name| top.join(name).is_file()).collect()
        };
        Ok(Self { old: names(&tree(before)?).collect(), new, before, after, top, up, renamed, changed })
    }

    /// The `denavit.toml` that holds in the working folder, as a revision has it.
    fn project(&self, revision: Option<&str>) -> Result<Option<Project>, CheckError> {
        let here = std::path::absolute(".").unwrap_or_else(|_| self.top.clone());
        let here = here.canonicalize().unwrap_or(here);
        let inside = here.strip_prefix(&self.top).unwrap_or(Path::new(""));
        let files = if revision == Some(self.before) { &self.old } else { &self.new };
        for folder in inside.ancestors() {
            let path = slashed(&folder.join(FILE_NAME));
            if files.contains(&path) {
                let source = self.source(revision, &path);
                return Project::open(&source, &self.top.join(folder)).map(Some);
            }
        }
        Ok(None)
    }

    /// What a file of a revision is called.
    fn source(&self, revision: Option<&str>, path: &str) -> String {
        match revision {
            Some(revision) => format!("git:{revision}:{path}"),
            None => format!("{}{path}", self.up),
        }
    }

    fn was_at<'p>(&'p self, path: &'p str) -> Option<&'p str> {
        let old = self.renamed.get(path).map_or(path, String::as_str);
        self.old.contains(old).then_some(old)
    }

    fn options(project: Option<&Project>, options: &Options) -> Options {
        let mut options = Options { arguments_for_another: true, ..options.clone() };
        options.package_path.extend(project.into_iter().flat_map(|project| project.package_path.clone()));
        options
    }

    fn described(&self, robot: &ProjectRobot, path: String, revision: Option<&str>, options: &Options) -> Described {
        Described {
            source: self.source(revision, &path),
            path,
            options: Options { arguments: robot.arguments.clone(), ..options.clone() },
            base: robot.base.clone(),
            tip: robot.tip.clone(),
        }
    }

    fn named(&self, project: &Project, old: Option<&Project>, options: &Options) -> Vec<Pair> {
        let path = |robot: &ProjectRobot| slashed(robot.file.strip_prefix(&self.top).unwrap_or(&robot.file));
        let (now, then) = (Self::options(Some(project), options), Self::options(old.or(Some(project)), options));
        let mut pairs = Vec::new();
        let (mut followed, mut paths) = (BTreeSet::new(), BTreeSet::new());
        for robot in &project.robots {
            let after = self.described(robot, path(robot), self.after, &now);
            // By its name; where the old file does not name it, by the path of its description.
            let named = old.and_then(|old| old.robots.iter().find(|known| known.name == robot.name));
            let before = match named {
                Some(known) => Some(self.described(known, path(known), Some(self.before), &then)),
                None => {
                    self.was_at(&after.path).map(|old| self.described(robot, old.to_owned(), Some(self.before), &then))
                }
            };
            match named {
                Some(known) => followed.insert(known.name.clone()),
                None => before.as_ref().is_some_and(|before| paths.insert(before.path.clone())),
            };
            let as_before = before.as_ref().is_some_and(|before| {
                before.path == after.path && before.options == after.options && !self.touches(&after)
            });
            pairs.push(Pair { name: robot.name.clone(), before, after: Some(after), is_touched: !as_before });
        }
        for robot in old.into_iter().flat_map(|old| &old.robots) {
            if !followed.contains(&robot.name) && !paths.contains(&path(robot)) {
                let before = Some(self.described(robot, path(robot), Some(self.before), &then));
                pairs.push(Pair { name: robot.name.clone(), before, after: None, is_touched: true });
            }
        }
        pairs
    }

    fn found(&self, project: Option<&Project>, options: &Options) -> Vec<Pair> {
        let options = Self::options(project, options);
        let plain = |path: &str, revision| Described {
            source: self.source(revision, path),
            path: path.to_owned(),
            options: options.clone(),
            base: None,
            tip: None,
        };
        let mut pairs = Vec::new();
        for path in self.new.iter().filter(|path| is_one_of(path, &DESCRIPTIONS)) {
            let after = plain(path, self.after);
            let before = self.was_at(path).map(|old| plain(old, Some(self.before)));
            if !is_description(&after) && !before.as_ref().is_some_and(is_description) {
                continue;
            }
            let is_touched = before.is_none() || self.renamed.contains_key(path) || self.touches(&after);
            pairs.push(Pair { name: path.clone(), before, after: Some(after), is_touched });
        }
        let followed: BTreeSet<&str> = self.renamed.values().map(String::as_str).collect();
        for path in self.old.iter().filter(|path| is_one_of(path, &DESCRIPTIONS)) {
            if !self.new.contains(path) && !followed.contains(path.as_str()) {
                let before = plain(path, Some(self.before));
                if is_description(&before) {
                    pairs.push(Pair { name: path.clone(), before: Some(before), after: None, is_touched: true });
                }
            }
        }
        pairs
    }

    /// Whether a file changed that a description is made from, for all that can be known without reading it.
    fn touches(&self, described: &Described) -> bool {
        let stands_alone = is_one_of(&described.path, &["urdf"])
            && read_text(&described.source).is_ok_and(|(_, text)| !text.contains("xacro:"));
        self.changed.contains(&described.path)
            || (!stands_alone && self.changed.iter().any(|path| is_one_of(path, &PARTS)))
    }
}

/// By its ending, or by what it holds where many kinds of file have that ending.
fn is_description(described: &Described) -> bool {
    if !is_one_of(&described.path, &["xml"]) {
        return true;
    }
    let text = read_text(&described.source).map(|(_, text)| text);
    text.is_ok_and(|text| is_markup(&described.path, &text) && Format::of_text(&text).is_some())
}

fn is_one_of(path: &str, endings: &[&str]) -> bool {
    path.rsplit_once('.').is_some_and(|(_, ending)| endings.contains(&&*ending.to_ascii_lowercase()))
}

/// Names that end in NUL.
fn names(listed: &[u8]) -> impl Iterator<Item = String> {
    let names = listed.split(|byte| *byte == 0).filter(|name| !name.is_empty());
    names.map(|name| String::from_utf8_lossy(name).into_owned())
}

/// A path from the top as git writes it.
fn slashed(path: &Path) -> String {
    // `.` and `..` as a person may write them in denavit.toml.
    let mut parts: Vec<String> = Vec::new();
    for part in path.components() {
        match part {
            std::path::Component::ParentDir => drop(parts.pop()),
            std::path::Component::Normal(name) => parts.push(name.to_string_lossy().into_owned()),
            _ => {}
        }
    }
    parts.join("/")
}
