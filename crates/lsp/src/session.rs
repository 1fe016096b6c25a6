//! The open files, and the robots that they belong to.

use crate::analysis::{Analysis, Problem, analyse, real};
use crate::markup::{Markup, scan};
use crate::names::{Language, Occurrence, occurrences};
use crate::settings::Settings;
use crate::text::{Encoding, Text};
use denavit_xacro::files::{self, FileOverlay};
use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::sync::Arc;

/// The current text of a file: an open buffer, or the file on disk.
#[derive(Debug, Clone)]
struct Seen {
    text: Rc<Text>,
    markup: Rc<Markup>,
    names: Rc<Vec<Occurrence>>,
}

/// Every file: open ones as in the editor, others as on disk.
#[derive(Debug, Default)]
pub(crate) struct Files {
    encoding: Encoding,
    open: BTreeMap<PathBuf, Seen>,
    /// Files on disk that were read since the last change.
    read: RefCell<HashMap<PathBuf, Option<Seen>>>,
}

impl Files {
    fn seen(text: Text, path: &Path) -> Seen {
        let markup = scan(&text.text);
        let names = occurrences(&text.text, &markup, Language::of(path, &text.text));
        Seen { text: Rc::new(text), markup: Rc::new(markup), names: Rc::new(names) }
    }

    fn of(&self, path: &Path) -> Option<Seen> {
        if let Some(open) = self.open.get(path) {
            return Some(open.clone());
        }
        if let Some(read) = self.read.borrow().get(path) {
            return read.clone();
        }
        let bytes = std::fs::read(path).ok();
        let seen = bytes.and_then(|bytes| String::from_utf8(bytes).ok()).map(|text| {
            let text = text.strip_prefix('\u{feff}').map(str::to_owned).unwrap_or(text);
            Self::seen(Text::new(text, self.encoding), path)
        });
        self.read.borrow_mut().insert(path.to_path_buf(), seen.clone());
        seen
    }

    pub fn text(&self, path: &Path) -> Option<Rc<Text>> {
        Some(self.of(path)?.text)
    }

    pub fn markup(&self, path: &Path) -> Option<Rc<Markup>> {
        Some(self.of(path)?.markup)
    }

    pub fn names(&self, path: &Path) -> Option<Rc<Vec<Occurrence>>> {
        Some(self.of(path)?.names)
    }

    pub fn is_open(&self, path: &Path) -> bool {
        self.open.contains_key(path)
    }

    /// Runs `work` with open buffers instead of the files on disk.
    pub fn over_the_disk<T>(&self, work: impl FnOnce() -> T) -> T {
        self.with_texts(&BTreeMap::new(), work)
    }

    /// Runs `work` with these texts, and open buffers for other files, instead of the files on disk.
    pub fn with_texts<T>(&self, texts: &BTreeMap<PathBuf, String>, work: impl FnOnce() -> T) -> T {
        let mut held = FileOverlay::over_the_disk();
        for (path, seen) in self.open.iter().filter(|(path, _)| !texts.contains_key(*path)) {
            held.add(path, seen.text.text.clone().into_bytes());
        }
        for (path, text) in texts {
            held.add(path, text.clone().into_bytes());
        }
        files::with(Some(Arc::new(held)), work)
    }
}

/// Folders deeper than this below a package are not searched for robots.
const DEEPEST: usize = 5;
/// Maximum number of files read to find the robots of a part.
const MOST_FILES: usize = 2000;
/// Maximum number of robots in which a part is analysed.
const MOST_ROBOTS: usize = 2;

/// The open files, and the robots that they belong to.
#[derive(Debug, Default)]
pub(crate) struct Session {
    pub files: Files,
    pub settings: Settings,
    /// Whether the editor has its own commands for tables, comparisons and the explorer.
    pub has_commands: bool,
    /// Robots, and parts of robots, by the file that is analysed.
    analyses: BTreeMap<PathBuf, Rc<Analysis>>,
    /// The last analyses with a robot, to complete names while a text is broken.
    last: BTreeMap<PathBuf, Rc<Analysis>>,
    /// Files whose problems the editor shows.
    shown: BTreeSet<PathBuf>,
}

impl Session {
    pub fn new(encoding: Encoding, settings: Settings) -> Self {
        Self { files: Files { encoding, ..Files::default() }, settings, ..Self::default() }
    }

    /// Stores the text of a buffer; returns the files whose problems must be updated.
    pub fn set(&mut self, path: &Path, text: String) {
        let seen = Files::seen(Text::new(text, self.files.encoding), path);
        self.files.open.insert(path.to_path_buf(), seen);
        self.files.read.borrow_mut().clear();
    }

    pub fn close(&mut self, path: &Path) {
        self.files.open.remove(path);
        self.files.read.borrow_mut().clear();
        let is_used = |analysis: &Rc<Analysis>| analysis.files.iter().any(|file| self.files.is_open(file));
        self.analyses.retain(|_, analysis| is_used(analysis));
    }

    /// Analyses what depends on these files; returns the problems of every file that has or had problems.
    pub fn refresh(&mut self, changed: &BTreeSet<PathBuf>) -> Vec<(PathBuf, Vec<Problem>)> {
        let touched = |analysis: &Rc<Analysis>| analysis.files.iter().any(|file| changed.contains(file));
        let mut stale: BTreeSet<PathBuf> =
            self.analyses.iter().filter(|(_, analysis)| touched(analysis)).map(|(path, _)| path.clone()).collect();
        stale.extend(changed.iter().filter(|path| self.files.is_open(path)).cloned());
        // An SRDF speaks of robots, which come first.
        let (srdf, robots): (Vec<PathBuf>, Vec<PathBuf>) = stale.into_iter().partition(|path| self.is_srdf(path));
        let again: Vec<PathBuf> = self.files.open.keys().filter(|path| self.is_srdf(path)).cloned().collect();
        for path in robots.into_iter().chain(srdf).chain(again).collect::<BTreeSet<_>>() {
            if !self.is_srdf(&path) {
                self.analyse(&path);
            }
        }
        let open: Vec<PathBuf> = self.files.open.keys().cloned().collect();
        for path in &open {
            if self.is_srdf(path) {
                self.analyse(path);
            } else if self.analyses.get(path).is_some_and(|analysis| analysis.is_part) {
                self.find_robots_of(path);
            }
        }
        self.problems()
    }

    /// Analyses everything again after a change of settings or files on disk.
    pub fn refresh_all(&mut self) -> Vec<(PathBuf, Vec<Problem>)> {
        self.files.read.borrow_mut().clear();
        self.analyses.clear();
        let open = self.files.open.keys().cloned().collect();
        self.refresh(&open)
    }

    fn is_srdf(&self, path: &Path) -> bool {
        self.files.text(path).is_some_and(|text| Language::of(path, &text.text) == Language::Srdf)
    }

    fn analyse(&mut self, path: &Path) -> Rc<Analysis> {
        let (files, settings) = (&self.files, &self.settings);
        let known: Vec<Rc<Analysis>> = self.analyses.values().filter(|known| known.robot.is_some()).cloned().collect();
        let mut found = Vec::new();
        let mut robots = |name: &str| {
            let named = |known: &&Rc<Analysis>| known.robot.as_ref().is_some_and(|robot| robot.name == name);
            let open: Vec<Rc<Analysis>> = known.iter().filter(named).cloned().collect();
            if !open.is_empty() {
                return open;
            }
            let near = descriptions_near(path).into_iter().filter(|other| other != path);
            for other in near.filter(|other| files.text(other).is_some_and(|text| text.text.contains(name))) {
                let analysis = Rc::new(analyse(files, &other, settings, &mut |_| Vec::new()));
                if analysis.robot.as_ref().is_some_and(|robot| robot.name == name) {
                    found.push(Rc::clone(&analysis));
                    return vec![analysis];
                }
            }
            Vec::new()
        };
        let mut analysis = analyse(files, path, settings, &mut robots);
        if analysis.robot.is_some() {
            self.last.remove(path);
        } else if let Some(last) = self.analyses.get(path).filter(|last| last.robot.is_some()) {
            self.last.insert(path.to_path_buf(), Rc::clone(last));
        }
        if let Some(last) = self.last.get(path) {
            // What it included it includes, until it can be read again.
            let more: Vec<PathBuf> = last.files.iter().filter(|file| !analysis.files.contains(file)).cloned().collect();
            analysis.files.extend(more);
        }
        let analysis = Rc::new(analysis);
        for robot in found {
            self.analyses.insert(robot.file.clone(), robot);
        }
        self.analyses.insert(path.to_path_buf(), Rc::clone(&analysis));
        analysis
    }

    /// Analyses robots that a part belongs to, where none is known yet.
    fn find_robots_of(&mut self, part: &Path) {
        let uses = |analysis: &Rc<Analysis>| {
            let may_be_robot = !analysis.is_part || (analysis.is_named && analysis.file != part);
            may_be_robot && analysis.files.iter().any(|file| file == part)
        };
        if self.analyses.values().any(uses) {
            return;
        }
        let near = descriptions_near(part);
        let mentions = |file: &Path, part: &Path| {
            let name = part.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
            file != part && self.files.text(file).is_some_and(|text| text.text.contains(&name))
        };
        let mut users = vec![part.to_path_buf()];
        let mut next = 0;
        while next < users.len() {
            let found: Vec<PathBuf> =
                near.iter().filter(|file| !users.contains(file) && mentions(file, &users[next])).cloned().collect();
            users.extend(found);
            next += 1;
        }
        let mut robots = 0;
        // Robots without a reference are farthest from the part.
        for user in users.into_iter().skip(1).rev() {
            // What is open has been analysed.
            if self.files.is_open(&user) {
                continue;
            }
            let analysis = self.analyse(&user);
            if !analysis.is_part && analysis.files.iter().any(|file| file == part) {
                robots += 1;
                if robots == MOST_ROBOTS {
                    return;
                }
            } else {
                self.analyses.remove(&user);
            }
        }
    }

    fn problems(&mut self) -> Vec<(PathBuf, Vec<Problem>)> {
        let mut by_file: BTreeMap<PathBuf, Vec<Problem>> = BTreeMap::new();
        for path in self.files.open.keys().chain(&self.shown) {
            by_file.entry(path.clone()).or_default();
        }
        for (path, analysis) in &self.analyses {
            // The robots of a part provide what it lacks.
            let is_used = |other: &Rc<Analysis>| other.file != *path && other.files.contains(path);
            if analysis.is_part && (!analysis.is_named || self.analyses.values().any(is_used)) {
                continue;
            }
            for problem in &analysis.problems {
                let of_file = by_file.entry(problem.at.file.clone()).or_default();
                if !of_file.contains(problem) {
                    of_file.push(problem.clone());
                }
            }
        }
        self.shown =
            by_file.iter().filter(|(_, problems)| !problems.is_empty()).map(|(path, _)| path.clone()).collect();
        for problems in by_file.values_mut() {
            problems.sort_by_key(|problem| (problem.at.range.start, problem.code));
        }
        by_file.into_iter().collect()
    }

    /// The problems of one file.
    pub fn problems_of(&self, path: &Path) -> Vec<Problem> {
        let all = self.analyses.values().flat_map(|analysis| &analysis.problems);
        let mut found: Vec<Problem> = Vec::new();
        for problem in all.filter(|problem| problem.at.file == path) {
            if !found.contains(problem) {
                found.push(problem.clone());
            }
        }
        found
    }

    /// The robots that a file belongs to: its own first.
    pub fn robots_of(&self, path: &Path) -> Vec<Rc<Analysis>> {
        let own = self.analyses.get(path).filter(|analysis| analysis.robot.is_some());
        let others = self.analyses.values().filter(|analysis| analysis.robot.is_some() && analysis.file != path);
        let others = others.filter(|analysis| analysis.files.iter().any(|file| file == path));
        own.into_iter().chain(others).cloned().collect()
    }

    /// The robots of a file as they were when it could last be read.
    pub fn last_robots_of(&self, path: &Path) -> Vec<Rc<Analysis>> {
        let now = self.robots_of(path).into_iter().chain(self.robots_of_srdf(path));
        let own = self.srdf_for(path);
        let named = |last: &Rc<Analysis>| own.is_some() && last.robot.as_ref().map(|robot| &robot.name) == own.as_ref();
        let last = self.last.values().filter(|last| named(last) || last.files.iter().any(|file| file == path)).cloned();
        now.chain(last).collect()
    }

    /// The name of the robot that a file is for, where that is an SRDF.
    fn srdf_for(&self, path: &Path) -> Option<String> {
        let text = self.files.text(path).filter(|_| self.is_srdf(path))?;
        Some(denavit_compare::lint::srdf::robot_of(&text.text).unwrap_or_default())
    }

    /// The robots that an SRDF is for.
    pub fn robots_of_srdf(&self, path: &Path) -> Vec<Rc<Analysis>> {
        let Some(name) = self.srdf_for(path) else { return Vec::new() };
        let named = |analysis: &&Rc<Analysis>| analysis.robot.as_ref().is_some_and(|robot| robot.name == name);
        self.analyses.values().filter(named).cloned().collect()
    }

    /// Every analysis.
    pub fn analyses(&self) -> impl Iterator<Item = &Rc<Analysis>> {
        self.analyses.values()
    }
}

/// The folder of the package that a file is in, or its own.
pub(crate) fn home_of(path: &Path) -> PathBuf {
    let package = path.ancestors().skip(1).find(|folder| folder.join("package.xml").is_file());
    package.or(path.parent()).unwrap_or(path).to_path_buf()
}

/// Descriptions of robots in the package that a file is in.
pub(crate) fn descriptions_near(path: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    walk(&home_of(path), DEEPEST, &mut found);
    found.iter().map(|file| real(file)).collect()
}

fn walk(folder: &Path, depth: usize, found: &mut Vec<PathBuf>) {
    let Ok(entries) = std::fs::read_dir(folder) else { return };
    let mut entries: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).collect();
    entries.sort();
    for path in entries {
        if found.len() >= MOST_FILES {
            return;
        }
        let name = path.file_name().map(|name| name.to_string_lossy().to_ascii_lowercase()).unwrap_or_default();
        if path.is_dir() {
            if depth > 0 && !name.starts_with('.') && name != "meshes" && name != "target" && name != "node_modules" {
                walk(&path, depth - 1, found);
            }
        } else if [".xacro", ".urdf", ".srdf"].iter().any(|end| name.ends_with(end)) {
            found.push(path);
        }
    }
}
